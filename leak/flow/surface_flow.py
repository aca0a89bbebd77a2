"""Flow through a contact of any shape: over a curved surface of triangles, from one part of its boundary to another.

div(sigma grad psi) = 0 is solved twice with linear triangles: for the potential psi, whose dissipation is never below
that of the flow, and for the stream function of the flow, whose dissipation at a given flow is never below it either.
Both enclose the conductance, and what they differ by in each triangle says where to refine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.errors import ConductivityError, ProfileError, as_arrays, check_each, positive
from leak.flow.conductivity import GasConductivity
from leak.flow.contact_profile import SMALLEST_LOG_PRESSURE
from leak.flow.contact_surface import ContactSurface, mask_of
from leak.flow.leak_rate import (
    GasPermeant,
    LiquidPermeant,
    LogConductivity,
    Permeant,
    SigmaOfPressure,
    by_log_pressure,
    gap_of,
    gas_table,
    potential_ends,
)
from leak.flow.leak_result import GasLeakResult, LeakResult
from leak.flow.rough_contact import RoughContact
from leak.fluids.properties import Gas, PressureLaw
from leak.numerics.anderson import mixing_weights
from leak.numerics.roots import MOST_STEPS

# ln sigma this far below or above that of the tightest place of the easiest way counts as sealed or open: 1e-9.
_RANGE = math.log(1e9)
# By which ln sigma of a triangle may leave the range of what it is at its corners and middles: smooth ridges do.
_ROOM = 0.5
# Where the contact ends between two points is not known: ln p at their middle, of p linear and of its root.
_AT_END = 0.5 * math.log(2.0)
# Share of the error in the triangles that are refined next, and of the points that make an end of it.
_WORST_SHARE, _MOST_GROWTH, _FEW_POINTS = 0.7, 4, 50_000
_TOLERANCE = 1e-8
# Of the energy of an unbalanced state, at which it counts as balanced.
_ROUND_OFF = 1e-16
# Sweeps of the gas pressure that are mixed, see `leak.flow.leak_rate`.
_HISTORY = 4

Solver = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class SurfaceFlow:
    """Flow of a liquid or a gas over a surface in contact.

    Examples
    --------
    A strip 2 m wide and 1 m long:

    >>> strip = ContactSurface([[0, 0], [1, 0], [0, 2], [1, 2]], [[0, 1, 2], [1, 2, 3]])
    >>> found = surface_flow(strip, np.full(4, 1e6), lambda p: 1e-9 / p, 1e5, high=[0, 2], low=[1, 3])
    >>> f"{found.leak_rate:.6g} {found.worst_tenth_share:.6g}"
    '2e-10 0.1'
    """

    result: LeakResult | GasLeakResult
    """Leak rate, mass flow and the fluid pressures at the points of the surface, nan where no fluid comes."""
    error: float
    """Relative: the leak rate is within (1 - error) and (1 + error) times this one. Both bounds of the flow, and the
    pressures between the points as far as they are uncertain; not the surface, which is made of flat triangles."""
    flux: FloatArray
    """Flow per width in each triangle, shape (t, 3) [m^2/s], of a gas [kg/(m s)]."""
    worst_tenth_share: float
    """Of the flow, through that tenth of the line with half of the drop of potential that lets most through, 0.1 if it
    is the same everywhere; nan where sealed."""
    points: int
    """Of the mesh with which it was calculated."""

    @property
    def leak_rate(self) -> float:
        """Q at atmospheric pressure [m^3/s]; zero where the contact is sealed all around."""
        return self.result.leak_rate


def surface_flow(
    surface: ContactSurface,
    pressure: ArrayLike,
    conductivity: SigmaOfPressure | LogConductivity,
    pressure_drop: float,
    *,
    high: ArrayLike | None = None,
    low: ArrayLike | None = None,
    pressure_side: str = "outer",
    gap: ArrayLike | None = None,
    viscosity: float | None = None,
    along: SigmaOfPressure | LogConductivity | None = None,
    lay: ArrayLike | None = None,
    pressure_law: PressureLaw | None = None,
    tolerance: float = 0.02,
) -> SurfaceFlow:
    """Flow of a liquid through a contact whose pressure is known at the points of a surface.

    Parameters
    ----------
    surface : ContactSurface
    pressure : array_like
        Nominal contact pressure at its points, zero where nothing touches, shape (n,) [Pa]. After a larger load that of
        first loading which lets as much through, see `ConductivityTable.first_loading`.
    conductivity : callable
        sigma_eff(p), see `leak.leak_flow`; with `lay` that across it. Between the points the pressure may be higher
        than at any of them: a table must reach further, as for a profile.
    pressure_drop, pressure_law
        See `leak.leak_flow`.
    high, low, pressure_side
        Where the fluid stands, see `ContactSurface.sides`.
    gap : array_like, optional
        Between the faces at the points, counts where nothing touches, shape (n,) [m]. None: what does not touch is
        open and resists nothing. Rough faces are not closer than with the least pressure of the map.
    viscosity : float, optional
        At atmospheric pressure, with `gap` [Pa s].
    along : callable, optional
        sigma_eff(p) along the lay.
    lay : array_like, optional
        Its direction, one for all triangles or one for each, shape (3,) or (t, 3).
    tolerance : float
        Triangles are refined until `SurfaceFlow.error` by the bounds is below it.

    Returns
    -------
    SurfaceFlow
        Of a `LeakResult`.

    Raises
    ------
    ProfileError, ConductivityError
        An input cannot be used; the message says which value.

    Notes
    -----
    ln p is quadratic in a triangle whose three points touch, with the curvature that its neighbours agree on; p is
    linear in one with a point that does not. ln sigma is linear in each triangle of the refined mesh.

    Examples
    --------
    >>> turn = 2 * np.pi * np.arange(60) / 60
    >>> points = np.concatenate([r * np.column_stack([np.cos(turn), np.sin(turn)]) for r in (1.0, 1.5, 2.0)])
    >>> a = np.arange(120)
    >>> b = np.where(a % 60 == 59, a - 59, a + 1)
    >>> ring = ContactSurface(points, np.concatenate([np.c_[a, b, a + 60], np.c_[b, b + 60, a + 60]]))
    >>> found = surface_flow(ring, np.full(180, 1e6), lambda p: 1e-9 / p, 1e5)
    >>> f"{found.leak_rate / (1e-10 * 2 * np.pi / np.log(2.0)):.2f} {found.error:.2f}"
    '0.99 0.02'
    """
    eta = 1.0 if viscosity is None else viscosity
    if gap is not None and viscosity is None:
        raise ProfileError("viscosity = None: a gap needs it [Pa s]")
    liquid = LiquidPermeant.of(conductivity, pressure_drop, pressure_law, eta)
    lengthwise = None if along is None else replace(liquid, conductivity=by_log_pressure(along))
    sides = surface.sides(high, low, pressure_side)
    return flow_over(surface, pressure, liquid, sides, gap, lengthwise, lay, tolerance)


def gas_surface_flow(
    surface: ContactSurface,
    pressure: ArrayLike,
    conductivity: RoughContact | GasConductivity,
    gas: Gas,
    inlet_pressure: float,
    outlet_pressure: float,
    *,
    high: ArrayLike | None = None,
    low: ArrayLike | None = None,
    pressure_side: str = "outer",
    gap: ArrayLike | None = None,
    along: RoughContact | GasConductivity | None = None,
    lay: ArrayLike | None = None,
    tolerance: float = 0.02,
) -> SurfaceFlow:
    """Mass flow of a gas through a contact whose pressure is known at the points of a surface.

    Parameters
    ----------
    surface, pressure, high, low, pressure_side, gap, lay, tolerance
        See `surface_flow`.
    conductivity, along : RoughContact or GasConductivity
        The rough interface, or its table from `gas_conductivity_table`; across and along the lay.
    gas, inlet_pressure, outlet_pressure
        See `leak.gas_leak_flow`.

    Returns
    -------
    SurfaceFlow
        Of a `GasLeakResult`.

    Raises
    ------
    ProfileError, ConductivityError
        An input cannot be used, or no solution was found; the message says which value.

    Notes
    -----
    The potential is w of `leak.gas_leak_flow`, in which the conductivity hardly depends on the pressure of the gas.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> strip = ContactSurface([[0, 0], [1, 0], [0, 2], [1, 2]], [[0, 1, 2], [1, 2, 3]])
    >>> flat, helium = np.full(4, 1e7), leak.gas("helium")
    >>> found = gas_surface_flow(strip, flat, surface, helium, 2e5, 1e5, high=[0, 2], low=[1, 3])
    >>> long = leak.gas_leak_flow([0, 0.5, 1], flat[:3], surface, helium, 2e5, 1e5, 1 / np.pi, ends=(0, 1))
    >>> f"{found.result.mass_flow / long.mass_flow:.3f}"
    '1.000'
    """
    ps = _checked_field(surface, "pressure", pressure, "Pa")
    faces = [conductivity] if along is None else [conductivity, along]
    tables = [gas_table(face, np.maximum(ps, 1.0), None, "bruggeman") for face in faces]
    permeant = GasPermeant.of(tables[0], gas, inlet_pressure, outlet_pressure)
    lengthwise = None if along is None else replace(permeant, conductivity=tables[-1])
    sides = surface.sides(high, low, pressure_side)
    return flow_over(surface, ps, permeant, sides, gap, lengthwise, lay, tolerance)


# -------------------------------------------------------------------- of any fluid


def flow_over(
    surface: ContactSurface,
    pressure: ArrayLike,
    permeant: Permeant,
    sides: tuple[BoolArray, BoolArray],
    gap: ArrayLike | None = None,
    along: Permeant | None = None,
    lay: ArrayLike | None = None,
    tolerance: float = 0.02,
) -> SurfaceFlow:
    """Flow over a surface, of any fluid.

    Parameters
    ----------
    surface, pressure, gap, lay, tolerance
        See `surface_flow`.
    permeant, along : LiquidPermeant or GasPermeant
        Across and along the lay.
    sides : tuple of ndarray
        See `ContactSurface.sides`.
    """
    positive(ProfileError, "tolerance", tolerance, "-")
    n, t = len(surface.points), len(surface.triangles)
    mesh = _Mesh.of(surface, pressure, permeant, sides, gap, along, lay)
    contact, ps = mesh.contact, mesh.contact.pressure
    while solved := mesh.solve(tolerance):
        size = len(mesh.surface.points)
        if solved.error <= tolerance or size > max(_MOST_GROWTH * n, _FEW_POINTS):
            break
        mesh = mesh.refined(solved.bounds.excess)
    share, permeant = (solved.share, solved.permeant) if solved else (mesh.still, permeant)
    known = np.isfinite(share[:n])
    low, high = potential_ends(permeant, "outer")
    fluid_pressure = np.full(n, np.nan)
    fluid_pressure[known] = permeant.potential.pressure(low + (high - low) * share[:n][known])
    peak = int(np.argmax(np.where(known, ps, -1.0)))
    if solved is None:
        return SurfaceFlow(
            permeant.result(0.0, fluid_pressure, peak, 0.0), 0.0, np.zeros((t, 3)), math.nan, n
        )
    drive = (high - low) * permeant.per_potential
    at_peak = np.exp(contact.log_sigma(np.log(np.maximum(ps[[peak]], 1e-300)), None))
    narrow = float(gap_of(permeant, at_peak)[0, 0])
    result = permeant.result(drive * solved.conductance, fluid_pressure, peak, narrow)
    moved = [np.bincount(mesh.parent, part, t) for part in (solved.flow * mesh.surface.areas[:, None]).T]
    # what the flow loses in triangles whose sigma falls by its doubt, and what its resistance loses if it rises
    doubt = -np.expm1(-contact.doubt)[mesh.parent]
    lost = max(float(part @ doubt / part.sum()) for part in solved.bounds[:2])
    error = (1.0 + solved.error) / (1.0 - lost) - 1.0
    flux = drive * np.transpose(moved / surface.areas)
    return SurfaceFlow(result, error, flux, solved.worst_tenth_share, size)


def flux_about(
    surface: ContactSurface,
    pressure: ArrayLike,
    permeant: Permeant,
    sides: tuple[BoolArray, BoolArray],
    gap: ArrayLike | None = None,
    along: Permeant | None = None,
    lay: ArrayLike | None = None,
) -> FloatArray:
    """About what flows in each triangle for each other one, by the potential on the given triangles alone, shape (t,).

    Parameters
    ----------
    surface, pressure, permeant, sides, gap, along, lay
        See `flow_over`.

    Returns
    -------
    ndarray, shape (t,)
        Per width; zero where the contact is sealed all around.
    """
    mesh = _Mesh.of(surface, pressure, permeant, sides, gap, along, lay)
    if (scale := mesh.tightest()) == -math.inf:
        return np.zeros(len(surface.triangles))
    share, triangles, _ = mesh.potential(scale)
    return triangles.flow_about(share)


def _checked_field(
    surface: ContactSurface, name: str, values: ArrayLike, unit: str, counts: BoolArray | None = None
) -> FloatArray:
    (field,) = as_arrays(ProfileError, f"{name} must be numbers", values)
    n = len(surface.points)
    if field.shape != (n,):
        raise ProfileError(f"{name} has shape {field.shape}: must be ({n},) like the points [{unit}]")
    used = mask_of(surface.triangles, n) & (True if counts is None else counts)
    good = (field >= 0.0) & (field < np.inf) | ~used
    check_each(ProfileError, name, field, good, f"must be a finite number that is not negative [{unit}]")
    return np.where(used, field, 0.0)


def _checked_lay(surface: ContactSurface, lay: ArrayLike | None, along: Permeant | None) -> FloatArray | None:
    if (along is None) != (lay is None):
        raise ProfileError("along and lay belong together: give both or none")
    if lay is None:
        return None
    (ways,) = as_arrays(ProfileError, "lay must be numbers", lay)
    t = len(surface.triangles)
    if ways.shape not in ((3,), (t, 3)):
        raise ProfileError(f"lay has shape {ways.shape}: must be (3,) or ({t}, 3)")
    normals = surface.normals / surface.areas[:, None]
    ways = ways - np.vecdot(ways, normals)[:, None] * normals
    lengths = np.linalg.norm(ways, axis=1)
    check_each(ProfileError, "lay", lengths, lengths > 0.0, "must not be straight across the triangle")
    return np.asarray(ways / lengths[:, None])


@dataclass(frozen=True, eq=False)
class _Contact:
    """The given pressures and what lies between them."""

    surface: ContactSurface
    pressure: FloatArray
    gap: FloatArray | None
    permeant: Permeant
    along: Permeant | None
    lay: FloatArray | None

    @cached_property
    def _middles(self) -> tuple[FloatArray, FloatArray]:
        """ln p at the middle of each edge, and how far below it may be."""
        s, n = self.surface, len(self.pressure)
        log_p = np.log(np.where(self.pressure > 0.0, self.pressure, 1.0))
        whole = (self.pressure[s.triangles] > 0.0).all(axis=1)
        corners = s.triangles[whole]
        # weights by which a ball has its own normals, and a paraboloid its slopes (Max, J. Graphics Tools 4, 1, 1999)
        squares = s.lengths[s.edges.of_triangle[whole]] ** 2
        weights = (s.areas[whole] / squares.prod(axis=1))[:, None] * squares
        steep = np.einsum("tcx,tc->xt", s.slopes[whole], log_p[corners])
        sums = [_sums(corners, weights * part[:, None], n) for part in (np.ones(len(corners)), *steep)]
        slope = np.stack(sums[1:], axis=1) / np.maximum(sums[0], 1e-300)[:, None]
        i, j = s.edges.ends.T
        way, rise = s.points[j] - s.points[i], log_p[j] - log_p[i]
        # half of the second derivative along the edge, from either end; a kink is seen from one end only
        bends = np.stack([rise - np.vecdot(slope[i], way), np.vecdot(slope[j], way) - rise])
        agree = bends[0] * bends[1] > 0.0
        bend = np.where(agree, 2.0 * bends[0] * bends[1] / np.where(agree, bends.sum(axis=0), 1.0), 0.0)
        touch = np.minimum(self.pressure[i], self.pressure[j]) > 0.0
        with np.errstate(divide="ignore"):
            linear = np.log(0.5 * (self.pressure[i] + self.pressure[j]))
        # twice as much: of a kink amid an edge its neighbours know
        doubt = np.where(touch, 0.5 * np.abs(bends - bend).max(axis=0), _AT_END)
        return np.where(touch, 0.5 * (log_p[i] + log_p[j]) - 0.25 * bend, linear), doubt

    def at(self, parent: IntArray, weights: FloatArray) -> tuple[FloatArray, FloatArray | None]:
        """ln p and gap at places of triangles, the weights of whose corners are given, shape (k, 3)."""
        corners = self.surface.triangles[parent]
        ps = self.pressure[corners]
        touch = (ps > 0.0).all(axis=1)
        with np.errstate(divide="ignore"):
            log_p = np.log(np.vecdot(weights, ps))
        w = weights[touch]
        middles = self._middles[0][self.surface.edges.of_triangle[parent[touch]]]
        opposite = 4.0 * w[:, [1, 2, 0]] * w[:, [2, 0, 1]]
        log_p[touch] = np.vecdot(w * (2.0 * w - 1.0), np.log(ps[touch])) + np.vecdot(opposite, middles)
        return log_p, None if self.gap is None else np.vecdot(weights, self.gap[corners])

    def log_sigma(self, log_p: FloatArray, gap: FloatArray | None) -> FloatArray:
        """ln sigma of the continuum across and along the lay, shape (1 or 2, k); +-infinite where open or sealed."""
        touches = np.isfinite(log_p)
        found = np.full((1 if self.along is None else 2, log_p.size), np.inf)
        with np.errstate(divide="ignore"):
            for values, permeant in zip(found, (self.permeant, self.along), strict=False):
                assert permeant is not None  # there are as many rows
                values[touches] = np.log(permeant.sigma(np.maximum(log_p[touches], SMALLEST_LOG_PRESSURE)))
            if gap is not None:
                found[:, ~touches] = 3.0 * np.log(gap[~touches]) - math.log(12.0 * self.permeant.viscosity)
                if (pressed := self.pressure[self.pressure > 0.0]).size:
                    # rough faces without pressure are not closer than with the least one
                    least = self.log_sigma(np.log(pressed.min(keepdims=True)), None)
                    found[:, ~touches] = np.maximum(found[:, ~touches], least)
        return found

    @property
    def doubt(self) -> FloatArray:
        """Of ln sigma in each triangle, as the pressures between the points are not known, shape (t,)."""
        middle, below = self._middles
        either = self.log_sigma(np.concatenate([middle, middle - below]), None).mean(axis=0).reshape(2, -1)
        with np.errstate(invalid="ignore"):
            change = np.nan_to_num(either[1] - either[0], nan=0.0, posinf=_RANGE)
        return np.asarray(np.minimum(np.abs(change), _RANGE)[self.surface.edges.of_triangle].mean(axis=1))


# -------------------------------------------------------------------- on one mesh


class _Solution(NamedTuple):
    conductance: float
    error: float
    bounds: _Bounds
    share: FloatArray
    """Of the drop of potential, at the points."""
    flow: FloatArray
    """Per width at a drop of one, in each triangle."""
    worst_tenth_share: float
    permeant: Permeant
    """With the potential that suits."""


@dataclass(frozen=True, eq=False)
class _Mesh:
    """A refined surface; each triangle lies in one that was given."""

    contact: _Contact
    surface: ContactSurface
    high: BoolArray
    low: BoolArray
    parent: IntArray
    weights: FloatArray
    """Of the parent's corners, at the corners of each triangle, shape (t, 3, 3)."""

    @classmethod
    def of(
        cls,
        surface: ContactSurface,
        pressure: ArrayLike,
        permeant: Permeant,
        sides: tuple[BoolArray, BoolArray],
        gap: ArrayLike | None,
        along: Permeant | None,
        lay: ArrayLike | None,
    ) -> _Mesh:
        ps, t = _checked_field(surface, "pressure", pressure, "Pa"), len(surface.triangles)
        gaps = None if gap is None else _checked_field(surface, "gap", gap, "m", ps == 0.0)
        contact = _Contact(surface, ps, gaps, permeant, along, _checked_lay(surface, lay, along))
        return cls(contact, surface, *sides, np.arange(t), np.broadcast_to(np.eye(3), (t, 3, 3)))

    def refined(self, excess: FloatArray) -> _Mesh:
        """With the worst triangles cut."""
        order = np.argsort(-excess)
        worst = order[: 1 + int(np.searchsorted(np.cumsum(excess[order]), _WORST_SHARE * excess.sum()))]
        surface, halved, parent, weights = self.surface.refined(worst)
        new = [np.isin(halved, self.surface.open_edges(side)) for side in (self.high, self.low)]
        high, low = np.append(self.high, new[0]), np.append(self.low, new[1])
        return _Mesh(self.contact, surface, high, low, self.parent[parent], weights @ self.weights[parent])

    def _at(self, weights: FloatArray, places: IntArray) -> tuple[FloatArray, FloatArray | None]:
        """ln p and gap at numbered places of the triangles, shape (t, 3), given by weights of the parent's corners."""
        # one of the triangles to which it belongs
        first = np.full(int(places.max()) + 1, -1)
        first[places.ravel()] = np.arange(places.size)
        return self.contact.at(self.parent[first // 3], weights.reshape(-1, 3)[first])

    @cached_property
    def _data(self) -> tuple[FloatArray, FloatArray | None]:
        """ln p and gap at the middle of each edge."""
        middles = 0.5 * (self.weights[:, [1, 2, 0]] + self.weights[:, [2, 0, 1]])
        return self._at(middles, self.surface.edges.of_triangle)

    @cached_property
    def _log_sigma(self) -> FloatArray:
        """At the middle of each edge, across and along the lay, shape (1 or 2, e)."""
        return self.contact.log_sigma(*self._data)

    def _reached(self, least: float) -> tuple[BoolArray, BoolArray]:
        """Points that fluid of the high and the low side comes to, over edges with ln sigma above the least."""
        passes = self._log_sigma.mean(axis=0) > least
        group = _groups(self.surface.edges.ends[passes], len(self.surface.points))
        return np.isin(group, group[self.high]), np.isin(group, group[self.low])

    @property
    def still(self) -> FloatArray:
        """Share of the drop where nothing flows, one half where something does."""
        from_high, from_low = self._reached(-np.inf)
        return np.where(from_high, np.where(from_low, 0.5, 1.0), np.where(from_low, 0.0, np.nan))

    def tightest(self) -> float:
        """ln sigma at the tightest place of the easiest way, to one half; -infinite where none leads across."""

        def leads(least: float) -> bool:
            return bool(np.logical_and(*self._reached(least)).any())

        if not (self._pieces[1].any() and leads(-np.inf)):
            return -math.inf
        values = self._log_sigma[np.isfinite(self._log_sigma)]
        if not values.size or leads(float(values.max())):
            raise ConductivityError("pressure: a way without contact leads from the high to the low side")
        below, above = float(values.min()) - 1.0, float(values.max())
        while above - below > 0.5:
            middle = 0.5 * (below + above)
            below, above = (middle, above) if leads(middle) else (below, middle)
        return below

    def solve(self, tolerance: float) -> _Solution | None:
        """The flow; None where the contact is sealed."""
        scale = self.tightest()
        if scale == -math.inf:
            return None
        share, triangles, permeant = self.potential(scale)
        steps = self._stream_steps(triangles.links(True))
        drops = self._psi.steps(share)
        squares = [float(triangles.links(way) @ values**2) for way, values in ((False, drops), (True, steps))]
        bounds = triangles.bounds(share, steps)
        if bounds.error > tolerance:
            # where ln sigma changes much in a triangle those of the fitted averages are wide: the closest ones
            closest = self._share(triangles.links(False, bound=True))
            bounds = triangles.bounds(closest, self._stream_steps(triangles.links(True, bound=True)))
        conductance = min(max(math.sqrt(squares[0] / squares[1]), bounds.low), bounds.up)
        flow = conductance * math.exp(scale) * triangles.flow(steps)
        still = self.still
        return _Solution(
            conductance * math.exp(scale),
            max(bounds.up / conductance, conductance / bounds.low) - 1.0,
            bounds,
            np.where(still == 0.5, share, still),
            -flow * np.sign(np.vecdot(flow, triangles.slopes(share[self.surface.triangles])))[:, None],
            _worst_tenth(self.surface, share, steps),
            permeant,
        )

    def _triangles(self, log_sigma: FloatArray) -> _Triangles:
        """With linear functions through the middles of the edges, less steep where they would leave the range."""
        of_triangle = self.surface.edges.of_triangle
        values = log_sigma.mean(axis=0)[of_triangle]
        mean = values.mean(axis=1, keepdims=True)
        rise, (below, above) = 2.0 * (mean - values), self._room
        steepest = np.maximum(
            rise.max(axis=1) / (values.max(axis=1) - mean[:, 0] + above),
            -rise.min(axis=1) / (mean[:, 0] - values.min(axis=1) + below),
        )
        corners = mean + rise / np.maximum(steepest, 1.0)[:, None]
        if self.contact.lay is None:
            return _Triangles(self.surface, corners, None)
        ratio = np.exp(0.5 * (log_sigma[1] - log_sigma[0])[of_triangle].mean(axis=1))
        return _Triangles(self.surface, corners, (self.contact.lay[self.parent], ratio))

    @cached_property
    def _room(self) -> FloatArray:
        """By how much ln sigma may fall below and rise above its range at the middles of the edges, shape (2, t)."""
        at_points = self.contact.log_sigma(*self._at(self.weights, self.surface.triangles)).mean(axis=0)
        corners = at_points[self.surface.triangles]
        middles = self._log_sigma.mean(axis=0)[self.surface.edges.of_triangle]
        with np.errstate(invalid="ignore"):
            room = [middles.min(axis=1) - corners.min(axis=1), corners.max(axis=1) - middles.max(axis=1)]
        return np.clip(np.nan_to_num(room), 0.0, _RANGE) + _ROOM

    def potential(self, scale: float) -> tuple[FloatArray, _Triangles, Permeant]:
        """psi, sigma over its scale with the gains of a rarefied gas at its pressures, permeant with its potential."""
        log_sigma, permeant = np.clip(self._log_sigma - scale, -_RANGE, _RANGE), self.contact.permeant
        triangles = self._triangles(log_sigma)
        near = self._psi.solver(triangles.links(False))
        share = self._share(triangles.links(False), near=near)
        if not permeant.sweeps:
            return share, triangles, permeant
        ways = [permeant] if self.contact.along is None else [permeant, self.contact.along]
        ways = [way.at_narrowest(float(gap_of(way, np.exp([scale]))[0])) for way in ways]
        log_p = np.maximum(self._data[0], SMALLEST_LOG_PRESSURE)
        # between faces that do not touch as in a slit
        touches = np.isfinite(self._data[0])
        gains = [
            [each.gain(log_p, gap) for each in (way, replace(way, conductivity=None))]
            for way, gap in zip(ways, gap_of(ways[0], np.exp(log_sigma + scale)), strict=True)
        ]
        low, high = potential_ends(ways[0], "outer")
        roots, changes, last = np.empty((0, share.size)), np.empty((0, share.size)), math.inf
        for _ in range(MOST_STEPS):
            q = ways[0].flow_pressure(low + (high - low) * share[self.surface.edges.ends].mean(axis=1))
            with np.errstate(divide="ignore"):
                gain = np.log([np.where(touches, rough(q), slit(q)) for rough, slit in gains])
            triangles = self._triangles(np.clip(log_sigma + gain, -2.0 * _RANGE, 2.0 * _RANGE))
            links = triangles.links(False)
            new = self._share(links, share, near)
            total = float(links @ self._psi.steps(new) ** 2)
            if abs(total / last - 1.0) < _TOLERANCE:
                return new, triangles, ways[0]
            last, root = total, np.sqrt(low + (high - low) * new)
            roots = np.concatenate([roots[-_HISTORY:], [root]])
            changes = np.concatenate([changes[-_HISTORY:], [root - np.sqrt(low + (high - low) * share)]])
            mixed = (mixing_weights(changes) @ roots) ** 2
            share = np.clip((mixed - low) / (high - low), 0.0, 1.0)
        raise ConductivityError("conductivity of the gas: no flow was found; it may fall like 1/p_f at most")

    @cached_property
    def _pieces(self) -> tuple[IntArray, BoolArray]:
        """Number of the piece of the surface of each point, and whether that reaches from the high to the low side."""
        piece = _groups(self.surface.edges.ends, len(self.surface.points))
        through = np.intersect1d(piece[self.high], piece[self.low])
        if not through.size:
            raise ProfileError("triangles: no piece of the surface reaches from the high to the low side")
        return piece, np.isin(piece, through)

    @cached_property
    def _psi(self) -> _Network:
        unknown = self._pieces[1] & ~self.high & ~self.low
        return _Network(self.surface.edges.ends, _numbered(unknown, self.surface.order))

    def _share(
        self, links: FloatArray, start: FloatArray | None = None, near: Solver | None = None
    ) -> FloatArray:
        """psi at a drop of one; where a start is given with the solver of links that are near."""
        start = (self.high & self._pieces[1]).astype(float) if start is None else start
        return np.clip(start + self._psi.balance(links, self._psi.steps(start), near), 0.0, 1.0)

    @cached_property
    def _stream(self) -> tuple[_Network, FloatArray, FloatArray]:
        """Of the stream function: network, cuts along which it jumps by what flows, whether they lead to the low side.

        All walls of one loop have one value: what flows between them is a cut's.
        """
        (ends, _, on_boundary), n = self.surface.edges, len(self.surface.points)
        piece, flows = self._pieces
        is_wall = on_boundary.copy()
        is_wall[self.surface.open_edges(self.high)] = is_wall[self.surface.open_edges(self.low)] = False
        loop, walls = _groups(ends[on_boundary], n), np.unique(ends[is_wall])
        place = np.arange(n)
        first, same = np.unique(loop[walls], return_index=True, return_inverse=True)[1:]
        place[walls] = walls[first][same]
        unknown = mask_of(place, n) & flows
        # one value of each piece is free
        unknown[place[np.unique(piece, return_index=True)[1]]] = False
        # many points are one on a wall, which comes last
        order = self.surface.order
        order = np.concatenate([order[~mask_of(walls, n)[order]], walls])
        return _Network(ends, _numbered(unknown, order)[place]), *_cuts(
            self.surface, self.high, self.low, np.where(flows, piece, -1)
        )

    def _stream_steps(self, links: FloatArray) -> FloatArray:
        """Steps of the stream function along the edges at a flow of one, with the least dissipation."""
        network, cuts, to_low = self._stream
        near = network.solver(links)
        steps = np.array([cut + network.steps(network.balance(links, cut, near)) for cut in cuts])
        shares = np.linalg.solve((steps * links) @ steps.T, to_low)
        return np.asarray((shares / (shares @ to_low)) @ steps)


# -------------------------------------------------------------------- in one triangle


class _Bounds(NamedTuple):
    """Of the conductance, from the dissipation of a psi at a drop of one and of a flow of one in each triangle."""

    up_parts: FloatArray
    low_parts: FloatArray
    up: float
    low: float
    error: float
    excess: FloatArray
    """Where both differ: their sum is twice the error."""


@dataclass(frozen=True, eq=False)
class _Triangles:
    """Averages of sigma in the triangles, in each of which ln sigma is linear."""

    surface: ContactSurface
    corners: FloatArray
    """ln sigma at the corners, shape (t, 3)."""
    lay: tuple[FloatArray, FloatArray] | None
    """Its direction, and the root of sigma along over sigma across it."""

    @cached_property
    def _means(self) -> tuple[FloatArray, FloatArray]:
        """Of sigma and of 1/sigma."""
        return _mean_exp(self.corners), _mean_exp(-self.corners)

    @cached_property
    def _weights(self) -> tuple[FloatArray, FloatArray]:
        """-A b_i b_j of both corners of each edge, and the part of it in the direction in which sigma changes."""
        b = self.surface.slopes
        if self.lay is not None:
            # in the metric in which sigma has no direction
            way, ratio = self.lay[0][:, None], np.sqrt(self.lay[1])[:, None, None]
            part = np.vecdot(b, way)[..., None] * way
            b = part * ratio + (b - part) / ratio
        g = np.einsum("tcx,tc->tx", b, self.corners - self.corners.mean(axis=1, keepdims=True))
        steep = np.vecdot(b, (g / np.maximum(np.linalg.norm(g, axis=1), 1e-300)[:, None])[:, None])
        i, j = [1, 2, 0], [2, 0, 1]
        areas = self.surface.areas[:, None]
        return -areas * np.vecdot(b[:, i], b[:, j]), -areas * steep[:, i] * steep[:, j]

    def links(self, stream: bool, bound: bool = False) -> FloatArray:
        """Of the edges: what flows from end to end at a difference of one; of the stream function with 1/sigma.

        In the direction in which sigma changes it counts in series, 1/mean(1/sigma), across it in parallel; for a bound
        it is the mean of sigma, or of 1/sigma, in all directions.
        """
        low, high = self.corners.min(axis=1), self.corners.max(axis=1)
        half = np.maximum(0.5 * (high - low), 1e-6)
        middle, spread = np.exp(0.5 * (high + low)), np.sinh(half) / half
        along, across = middle / spread, middle * spread
        if bound:
            along = across = self._means[0] if not stream else 1.0 / self._means[1]
        if stream:
            along, across = 1.0 / across, 1.0 / along
        whole, steep = self._weights
        values = across[:, None] * whole + (along - across)[:, None] * steep
        return _sums(self.surface.edges.of_triangle, values, len(self.surface.edges.ends))

    def slopes(self, values: FloatArray) -> FloatArray:
        """Gradients of values at the corners of the triangles."""
        return np.asarray(np.einsum("tcx,tc->tx", self.surface.slopes, values))

    def flow_about(self, share: FloatArray) -> FloatArray:
        """Size of the flow down a potential, sigma in series."""
        drops = self.slopes(share[self.surface.triangles])
        return np.asarray(np.linalg.norm(drops, axis=1) / self._means[1])

    def flow(self, steps: FloatArray) -> FloatArray:
        """Of a stream function with such steps along the edges, in each triangle, of either sign."""
        normals = self.surface.normals / self.surface.areas[:, None]
        return np.cross(normals, self.slopes(_corners_of_steps(self.surface, steps)))

    def bounds(self, share: FloatArray, steps: FloatArray) -> _Bounds:
        """Of the conductance, from any psi at a drop of one and any flow of one."""
        drops, flow, areas = self.slopes(share[self.surface.triangles]), self.flow(steps), self.surface.areas
        squares = [np.vecdot(vectors, vectors) for vectors in (drops, flow)]
        if self.lay is not None:
            ratio = self.lay[1]
            along = [np.vecdot(vectors, self.lay[0]) ** 2 for vectors in (drops, flow)]
            squares = [
                along[0] * ratio + (squares[0] - along[0]) / ratio,
                along[1] / ratio + (squares[1] - along[1]) * ratio,
            ]
        parts = [square * areas * mean for square, mean in zip(squares, self._means, strict=True)]
        up, low = float(parts[0].sum()), 1.0 / float(parts[1].sum())
        scale, cross = math.sqrt(up * low), areas * np.abs(np.vecdot(drops, flow))
        excess = np.maximum(parts[0] / scale + parts[1] * scale - 2.0 * cross, 0.0)
        return _Bounds(parts[0], parts[1], up, low, math.sqrt(up / low) - 1.0, excess)


def _mean_exp(values: FloatArray) -> FloatArray:
    """Mean over triangles of the exponential of what is linear between such values at the corners, shape (t, 3)."""
    a, b, c = np.sort(values, axis=1).T

    def phi(z: FloatArray) -> FloatArray:
        return np.where(z > 1e-9, np.expm1(z) / np.maximum(z, 1e-9), 1.0 + 0.5 * z)

    # 2 exp(a) times the difference quotient of phi between b - a and c - a, or the slope between them
    z = 0.5 * (b + c) - a
    at = np.maximum(z, 1e-2)
    slope = np.where(z > 1e-2, (np.exp(at) - phi(at)) / at, 0.5 + z / 3.0 + z**2 / 8.0 + z**3 / 30.0)
    near = c - b < 1e-3
    quotient = (phi(c - a) - phi(b - a)) / np.where(near, 1.0, c - b)
    return np.asarray(2.0 * np.exp(a) * np.where(near, slope, quotient))


def _corners_of_steps(surface: ContactSurface, steps: FloatArray) -> FloatArray:
    """Values at the corners of each triangle from steps along the edges, the first one zero."""
    first, *others = surface.triangles.T
    sides = surface.edges.of_triangle[:, [2, 1]].T
    values = (steps[side] * np.sign(other - first) for other, side in zip(others, sides, strict=True))
    return np.stack([np.zeros(len(first)), *values], axis=1)


def _worst_tenth(surface: ContactSurface, share: FloatArray, steps: FloatArray) -> float:
    """Share of the flow through the tenth of the line with half of the drop that lets most through."""
    above = share[surface.triangles] > 0.5
    crossed = above.any(axis=1) & ~above.all(axis=1)
    above, corners = above[crossed], surface.triangles[crossed]
    # place, psi and stream function at the corners
    streams = _corners_of_steps(surface, steps)[crossed]
    values = np.concatenate([surface.points[corners], share[corners][..., None], streams[..., None]], axis=2)
    # the line crosses both edges of the corner that is alone on its side
    alone = np.where((above.sum(axis=1) == 1)[:, None], above, ~above).argmax(axis=1)
    k = np.arange(len(alone))
    tip, feet = values[k, alone], [values[k, (alone + turn) % 3] for turn in (1, 2)]
    one, two = (tip + ((0.5 - tip[:, 3]) / (foot[:, 3] - tip[:, 3]))[:, None] * (foot - tip) for foot in feet)
    length, flow = np.linalg.norm((two - one)[:, :3], axis=1), np.abs((two - one)[:, 4])
    order = np.argsort(-flow / np.maximum(length, 1e-300))
    so_long, so_much = (np.concatenate([[0.0], np.cumsum(values[order])]) for values in (length, flow))
    return float(np.interp(0.1 * so_long[-1], so_long, so_much) / so_much[-1])


# -------------------------------------------------------------------- the equations


def _sums(places: IntArray, values: FloatArray, size: int) -> FloatArray:
    return np.asarray(np.bincount(places.ravel(), values.ravel(), size), dtype=float)


def _numbered(unknown: BoolArray, order: IntArray) -> IntArray:
    """Numbers of unknowns in an order of all, -1 elsewhere."""
    number = np.full(unknown.size, -1)
    number[order[unknown[order]]] = np.arange(np.count_nonzero(unknown))
    return number


def _groups(pairs: IntArray, size: int) -> IntArray:
    """Number of the connected group of each point."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs), dtype=np.int8), tuple(pairs.T)), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


@dataclass(frozen=True, eq=False)
class _Network:
    """The edges as links between unknowns: equal numbers are one unknown, -1 is held."""

    ends: IntArray
    number: IntArray

    def steps(self, values: FloatArray) -> FloatArray:
        """From the first to the second end of each edge."""
        return np.asarray(values[self.ends[:, 1]] - values[self.ends[:, 0]], dtype=float)

    def _into(self, flow: FloatArray) -> FloatArray:
        """Of flows along the edges into the unknowns."""
        first, second = (self.number[self.ends] + 1).T
        size = int(self.number.max(initial=-1)) + 2
        return (_sums(first, flow, size) - _sums(second, flow, size))[1:]

    def balance(self, links: FloatArray, steps: FloatArray, near: Solver | None = None) -> FloatArray:
        """Values at the points by which steps along the edges must change, until nothing is left in any unknown."""
        solve = self.solver(links) if near is None else near
        left = self._into(links * steps)
        way = change = solve(left)
        found, first = np.zeros(left.size), float(left @ change)
        last = first
        # conjugate gradients; after one step with its own solver only round-off is left
        for _ in range(2 if near is None else MOST_STEPS):
            if last <= _ROUND_OFF * first:
                return np.append(found, 0.0)[self.number]
            out = -self._into(links * self.steps(np.append(way, 0.0)[self.number]))
            step = last / float(way @ out)
            found, left = found + step * way, left - step * out
            change = solve(left)
            before, last = last, float(left @ change)
            way = change + last / before * way
        return np.append(found, 0.0)[self.number] if near is None else self.balance(links, steps)

    def solver(self, links: FloatArray) -> Solver:
        """Values of the unknowns from what flows into them."""
        from scipy.sparse import coo_array
        from scipy.sparse.linalg import splu

        first, second = self.number[self.ends].T
        moves = first != second
        i, j = np.concatenate([first[moves], second[moves]]), np.concatenate([second[moves], first[moves]])
        links = np.tile(links[moves], 2)
        i, j, links = i[i >= 0], j[i >= 0], links[i >= 0]
        diagonal = np.bincount(i, links)
        if not diagonal.size:
            return lambda into: into
        scale = 1.0 / np.sqrt(diagonal)
        inner, size = j >= 0, diagonal.size
        rows, columns = (np.concatenate([np.arange(size), values[inner]]) for values in (i, j))
        values = np.concatenate([np.ones(size), (-links * scale[i] * scale[j])[inner]])
        matrix = coo_array((values, (rows, columns)), shape=(size, size)).tocsc()
        factors = splu(matrix, "NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        return lambda into: scale * factors.solve(scale * into)


def _cuts(
    surface: ContactSurface, high: BoolArray, low: BoolArray, piece: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Ways over triangles from one part of the high side to all other parts of both sides, in each piece.

    Returns
    -------
    steps, to_low
        Of a function that is one on the left of a way and zero on its right, along the edges that it crosses, shape
        (ways, e), and whether it leads to the low side.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order

    (ends, of_triangle, _), t = surface.edges, len(surface.triangles)
    order = np.argsort(of_triangle.ravel(), kind="stable")
    twice = np.flatnonzero(np.diff(of_triangle.ravel()[order]) == 0)
    pair = order[twice] // 3, order[twice + 1] // 3
    graph = coo_array((np.ones(twice.size, dtype=np.int8), pair), shape=(t, t)).tocsr()
    triangle_of = np.empty(len(ends), dtype=np.int64)
    triangle_of[of_triangle] = np.arange(t)[:, None]
    parts: dict[int, list[tuple[int, bool]]] = {}
    for side in (high, low):
        edges = surface.open_edges(side & (piece >= 0))
        part = _groups(ends[edges], len(piece))[ends[edges, 0]]
        for edge in edges[np.unique(part, return_index=True)[1]].tolist():
            parts.setdefault(int(piece[ends[edge, 0]]), []).append((edge, side is low))
    cuts, to_low = [], []
    for (first, _), *others in parts.values():
        before = breadth_first_order(graph, triangle_of[first], directed=False)[1]
        for last, is_low in others:
            way = [int(triangle_of[last])]
            while way[0] >= 0 and way[0] != triangle_of[first]:
                way.insert(0, int(before[way[0]]))
            if way[0] < 0:
                # nothing gets through where pieces touch at a point only
                continue
            crossed = [first, *(int(np.intersect1d(*of_triangle[[a, b]])[0]) for a, b in pairwise(way)), last]
            steps, (left, right) = np.zeros(len(ends)), ends[first].tolist()
            for edge in crossed:
                # the way turns around the point that both edges share
                points = ends[edge].tolist()
                left, right = (left, sum(points) - left) if left in points else (sum(points) - right, right)
                steps[edge] = 1.0 if left == points[1] else -1.0
            cuts.append(steps)
            to_low.append(float(is_low))
    if not any(to_low):
        raise ProfileError(
            "triangles: the piece with the high and that with the low side touch at points only"
        )
    return np.array(cuts), np.array(to_low)
