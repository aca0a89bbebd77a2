"""A contact of any shape: its pressures over a surface, and the profile across it that stands for them."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.profile import PressureProfile
from leak import LeakResult

if TYPE_CHECKING:
    from leak import ContactSurface, SurfaceFlow
    from leak.flow.leak_rate import Permeant

# Points of a profile across a mesh without rows, and places across that are one.
_MOST_ROWS, _FEWEST_ROWS, _FEWEST_IN_ROW, _SAME_ROW = 200, 5, 8, 1e-6
# Share of the mean flow that counts everywhere, so that every place has a mean.
_LEAST_FLOW = 1e-9


@dataclass(frozen=True, eq=False)
class MapFace:
    """A surface between the sides at which fluid stands; what all steps and fluid pressures share.

    Parameters
    ----------
    surface : ContactSurface
    high, low : ndarray, shape (n,)
        Masks of the points of both sides, see `ContactSurface.sides`.
    outwards : bool
        Whether the low side is the inner one, at which a profile across begins.
    lay : ndarray, shape (3,) or (t, 3), or None
        Direction in which the roughness conducts as it does in its other direction, of each triangle; None: as in all.
    """

    surface: ContactSurface
    high: BoolArray
    low: BoolArray
    outwards: bool = True
    lay: FloatArray | None = None

    @property
    def _ends(self) -> tuple[BoolArray, BoolArray]:
        return (self.low, self.high) if self.outwards else (self.high, self.low)

    @cached_property
    def across(self) -> FloatArray:
        """Way from the inner side over that from side to side, along the edges, shape (n,); nan at points not used."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import dijkstra

        (i, j), n = self.surface.edges.ends.T, len(self.high)
        edges = coo_array((self.surface.lengths, (i, j)), shape=(n, n)).tocsr()
        inner, outer = (
            dijkstra(edges, directed=False, indices=np.flatnonzero(side), min_only=True)
            for side in self._ends
        )
        with np.errstate(invalid="ignore"):
            return np.asarray(inner / (inner + outer))

    @cached_property
    def lengths(self) -> tuple[float, float]:
        """Of the inner and the outer side [m]."""
        inner, outer = (
            float(self.surface.lengths[self.surface.open_edges(side)].sum()) for side in self._ends
        )
        return inner, outer

    @property
    def width(self) -> float:
        """Mean way from side to side: area over length [m]."""
        return float(self.surface.areas.sum()) / (0.5 * sum(self.lengths))

    @property
    def ring(self) -> tuple[float, float]:
        """Radii of a flat ring as long and as wide [m]."""
        middle = sum(self.lengths) / (4.0 * np.pi)
        return max(middle - 0.5 * self.width, 0.01 * middle), middle + 0.5 * self.width

    def at_points(self, of_triangles: FloatArray) -> FloatArray:
        """Sums over the triangles around each point of a third of their values, shape (n,)."""
        corners, thirds = self.surface.triangles.ravel(), np.repeat(of_triangles / 3.0, 3)
        return np.asarray(np.bincount(corners, thirds, len(self.high)), dtype=float)

    @cached_property
    def rows(self) -> tuple[IntArray, int]:
        """The row across of each point, -1 of none, and how many there are: of the mesh, or of as many points each."""
        known = np.isfinite(self.across)
        places, rows = np.round(self.across[known] / _SAME_ROW), np.full(len(known), -1)
        begins = np.unique(places)
        if len(begins) > min(_MOST_ROWS, len(places) / _FEWEST_IN_ROW):
            count = max(min(_MOST_ROWS, len(places) // _FEWEST_IN_ROW), _FEWEST_ROWS)
            begins = np.unique(np.sort(places)[:: math.ceil(len(places) / count)])
        rows[known] = np.searchsorted(begins, places, side="right") - 1
        return rows, len(begins)

    def mean_across(self, values: FloatArray, weights: FloatArray) -> FloatArray:
        """Means over the rows, shape (rows,); nan where none of a row is known."""
        rows, count = self.rows
        known = (rows >= 0) & np.isfinite(values)
        sums, total = (
            np.bincount(rows[known], weights[known] * part, count)
            for part in (values[known], np.ones(known.sum()))
        )
        return np.where(total > 0.0, sums / np.where(total > 0.0, total, 1.0), np.nan)

    def lowest_ridge(self, pressure: FloatArray) -> float:
        """The pressure that any way from side to side must pass somewhere [Pa].

        Parameters
        ----------
        pressure : ndarray, shape (n,)
            Contact pressure [Pa].
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        (i, j), n = self.surface.edges.ends.T, len(pressure)
        of_edges, levels = np.maximum(pressure[i], pressure[j]), np.unique(pressure)

        def leads(level: float) -> bool:
            passed = of_edges <= level
            links = coo_array((np.ones(passed.sum()), (i[passed], j[passed])), shape=(n, n))
            group = connected_components(links, directed=False)[1]
            open_points = pressure <= level
            return bool(np.isin(group[self.high & open_points], group[self.low & open_points]).any())

        low, high = 0, len(levels) - 1
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if leads(levels[middle]) else (middle + 1, high)
        return float(levels[low])


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfaceLeak(LeakResult):
    """What leaks over a surface; the fluid pressures are those of the profile across."""

    over: SurfaceFlow
    """The flow over the surface, with its error and where it leaks."""
    at_points: FloatArray
    """Fluid pressure above that of the low side at the points of the surface, nan where none comes, shape (n,) [Pa]."""


@dataclass(frozen=True, kw_only=True)
class SurfaceProfile(PressureProfile):
    """The profile across a surface that stands for its pressures.

    Parameters
    ----------
    face : MapFace
    field : ndarray, shape (n,)
        Contact pressure at its points [Pa].
    opening : ndarray, shape (n,), or None
        Gap where nothing touches [m].
    share : float or None
        What leaks over the surface over what leaks through the profile, where that was calculated: then the profile
        stands for it. None: the flow over the surface is calculated.
    """

    face: MapFace
    field: FloatArray
    opening: FloatArray | None = None
    share: float | None = None

    @classmethod
    def of(
        cls, face: MapFace, field: FloatArray, opening: FloatArray | None, flux: FloatArray | None = None
    ) -> SurfaceProfile:
        """With means of the pressure along the sides, of places that let more through more.

        Parameters
        ----------
        face, field, opening
            See the class.
        flux : ndarray, shape (t,), optional
            What flows in each triangle for each other one; unless given, and where nothing does, each place counts by
            its area, and no more pressure than any way across must pass.
        """
        areas, sealed = face.surface.areas, flux is None or not flux.any()
        flow = np.ones(len(areas)) if flux is None or sealed else flux
        weights = face.at_points(areas * (flow / np.average(flow, weights=areas) + _LEAST_FLOW))
        pressure = face.mean_across(field, weights)
        if sealed:
            pressure = np.minimum(pressure, face.lowest_ridge(field))
        places = face.mean_across(face.across, weights)
        inner, outer = face.lengths
        x = face.width * places
        steps = np.diff(x, prepend=x[0], append=x[-1])
        radius = ((1.0 - places) * inner + places * outer) / (2.0 * np.pi)
        gap, arc_weight = np.full(len(x), np.nan), 0.5 * (steps[1:] + steps[:-1])
        ends = float(x[0]), float(x[-1])
        return cls(x, radius, pressure, gap, arc_weight, ends, face=face, field=field, opening=opening)

    def with_share(self, share: float | None) -> SurfaceProfile:
        """The same where the profile stands for the surface, with the share of what leaks over it."""
        return replace(self, share=share)

    def _flowing(self, permeant: Permeant, along: Permeant | None) -> tuple[Any, ...]:
        """What a flow over the surface is made of."""
        face, lay = self.face, None if along is None else self.face.lay
        return face.surface, self.field, permeant, (face.high, face.low), self.opening, along, lay

    def flux(self, permeant: Permeant, along: Permeant | None = None) -> FloatArray:
        """About what flows in each triangle for each other one, shape (t,).

        Parameters
        ----------
        permeant, along : LiquidPermeant or GasPermeant
            In the direction of the flow that the roughness is given for and, of one with a lay, in the other one.
        """
        from leak.flow.surface_flow import flux_about

        return flux_about(*self._flowing(permeant, along))

    def leak(self, permeant: Permeant, along: Permeant | None = None) -> SurfaceLeak:
        """What leaks over the surface.

        Parameters
        ----------
        permeant, along : LiquidPermeant or GasPermeant
            See `flux`.
        """
        from leak.flow.surface_flow import flow_over

        found = flow_over(*self._flowing(permeant, along))
        result = found.result.above_outlet
        values = {one.name: getattr(result, one.name) for one in fields(LeakResult)}
        at_points = result.fluid_pressure
        values["fluid_pressure"] = self.face.mean_across(at_points, np.ones(len(at_points)))
        return SurfaceLeak(**values, over=found, at_points=at_points)
