"""Crests of a turned face on a flat: rough lines that yield where they touch and give as a line contact does.

A tool of nose radius r that is fed by f each turn leaves cusps, f apart, between valleys of depth f^2/(8 r). Their
sides rise by m = f/(2 r), and all load is carried within some micrometres of their tops. What decides is how high each
place along a crest is: the fine roughness that the cusp carries there. A place sinks by its own load and by that of its
neighbours along the crest, as a half-space gives under a band that is as wide as the contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.errors import SurfaceError

# Rms distance between face and flat where they touch, over the rms height of the tops, and change of the band, below
# which both are kept.
_TOLERANCE, _BAND_CHANGE = 0.02, 0.02
# Most steps to the widths, those at which a contact is as wide as what is known, and of conjugate gradients; the square
# of what these leave, and the least part of a step.
_MOST_STEPS, _MOST_WIDE, _MOST_GRADIENTS, _RESIDUAL, _LEAST_SHARE = 100, 15, 60, 1e-2, 1e-3
# Of the fall over a spacing, beside the rms height of the tops.
_OF_FALL = 0.01
# Of the fall of a face toward the edge of a contact.
_LEAST_FALL = 0.1
# Pitches to both sides whose load a place feels.
_NEIGHBOURS = 4


@dataclass(frozen=True, eq=False)
class PressedCrests:
    """Rough crests under a flat; arrays over the places along each crest have shape (crests, places).

    Parameters
    ----------
    pressure : float
        Nominal, over the whole face [Pa].
    level : float
        Of the flat above the mean line of the smooth crests, before they sink [m].
    width : ndarray
        Of the contact at each place, zero where it does not touch [m].
    gap : ndarray
        Between the flat and the highest point of each place, zero where it touches [m].
    overlap : float
        Volume of the crests above the flat, over the nominal area [m].
    """

    pressure: float
    level: float
    width: FloatArray
    gap: FloatArray
    overlap: float


@dataclass(frozen=True, eq=False)
class CrestLines:
    """Pieces of rough crests, periodic along themselves, under one flat.

    Parameters
    ----------
    heights : ndarray, shape (crests, places, points)
        Of the face above the mean line of the highest smooth crests, along each crest and across it [m]; crests of a
        row follow each other.
    spacing : float
        Of the points in both directions [m].
    feed : float
        Distance of the crests, on average [m].
    effective_modulus : float
        E* [Pa].
    contact_pressure : float
        Mean pressure where a crest touches [Pa].
    row : ndarray, shape (n,), optional
        Places across the crests of those n that differ and repeat together, rising [m].
    smooth : ndarray, shape (n,), optional
        Heights of these without the fine roughness, zero of the highest [m].
    """

    heights: FloatArray
    spacing: float
    feed: float
    effective_modulus: float
    contact_pressure: float
    row: FloatArray = field(default_factory=lambda: np.zeros(1))
    smooth: FloatArray = field(default_factory=lambda: np.zeros(1))

    @cached_property
    def tops(self) -> FloatArray:
        """Highest point of each place, shape (crests, places) [m]."""
        return self.heights.max(axis=2)

    @cached_property
    def rough_tops(self) -> FloatArray:
        """Above the smooth crest of each, shape (crests, places) [m]."""
        return self.tops - np.resize(self.smooth, self.heights.shape[0])[:, None]

    @property
    def most_width(self) -> float:
        """What is known of a crest across it [m]."""
        return (self.heights.shape[2] - 2) * self.spacing

    @cached_property
    def _edges(self) -> NDArray[np.float32]:
        """Heights at the edges of contacts that are 0, 1, 2 ... spacings wide, above the mean sinking of each.

        A band that carries p sinks by p times its width over pi E* less at its edge than on average. Where the face is
        so flat that this is nearly all of its fall, the contact is elastic and widens gradually.
        """
        # so many points stand above their heights, half a spacing to each side of them
        points = -np.sort(-np.ascontiguousarray(self.heights, dtype=np.float32), axis=2)
        heights = np.concatenate([points[:, :, :1], 0.5 * (points[:, :, :-1] + points[:, :, 1:])], axis=2)
        heights[:, :, 1] = (points[:, :, 0] + 2.0 * points[:, :, 1]) / 3.0
        less = np.float32(self.contact_pressure * self.spacing / (math.pi * self.effective_modulus))
        fall = heights[:, :, :-1] - heights[:, :, 1:]
        np.maximum(fall - less, _LEAST_FALL * fall, out=fall)
        heights[:, :, 1:] = heights[:, :, :1] - np.cumsum(fall, axis=2)
        return heights

    @cached_property
    def _sections(self) -> NDArray[np.float32]:
        """Integral of the edges' heights over the width [m^2]."""
        edges = self._edges
        sections = np.zeros_like(edges)
        np.cumsum(edges[:, :, 1:] + edges[:, :, :-1], axis=2, out=sections[:, :, 1:])
        return 0.5 * self.spacing * sections

    def _at_width(self, width: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Height of the edges [m], its fall over the width [-], and its integral [m^2]."""
        at = np.minimum(width / self.spacing, self.heights.shape[2] - 1.001)
        index = at.astype(int)
        share = at - index
        index += self._first_index
        edge, following, section = (
            values.ravel().take(places)
            for values, places in (
                (self._edges, index),
                (self._edges, index + 1),
                (self._sections, index),
            )
        )
        fall = edge - following
        section = section + self.spacing * share * (edge - 0.5 * share * fall)
        return edge - share * fall, np.maximum(fall, 1e-6 * self._scale) / self.spacing, section

    @cached_property
    def _first_index(self) -> IntArray:
        """Of each place in the flat array of its edges."""
        crests, places, points = self._edges.shape
        return np.arange(0, crests * places * points, points).reshape(crests, places)

    @cached_property
    def _scale(self) -> float:
        """Rms height of the tops; of smooth crests what they fall by over a spacing [m]."""
        return float(
            np.std(self.rough_tops) + _OF_FALL * np.mean(self._edges[:, :, 0] - self._edges[:, :, 1])
        )

    @cached_property
    def _wavenumbers(self) -> FloatArray:
        return np.asarray(2.0 * np.pi * np.fft.rfftfreq(self.heights.shape[1], self.spacing))

    def _give(self, half_width: FloatArray) -> FloatArray:
        """Sinking over the width of contacts, of waves along the crest, on average over a contact [-].

        Of each crest of the row under the load of each, shape (n, n, waves), for the half widths of their contacts.

        References
        ----------
        K. L. Johnson, Contact mechanics (1985), ch. 3: a line load q cos(k y) moves the surface at a distance x by
        2 q cos(k y) K0(k x)/(pi E*), here averaged over both places in a band; a row of equal lines, f apart, by
        -2 q ln(2 sin(pi x/f))/(pi E*).
        """
        from scipy.special import iti0k0, k1

        k, f, give = self._wavenumbers[1:], self._period, self._coupling.copy()
        for one, of_one in enumerate(half_width):
            x = 2.0 * of_one * k
            give[one, one, 0] = math.log(f / (4.0 * math.pi * of_one)) + 1.5
            give[one, one, 1:] += 2.0 * (x * iti0k0(x)[1] - 1.0 + x * k1(x)) / x**2
        return np.asarray(2.0 * self.contact_pressure / (math.pi * self.effective_modulus) * give)

    def give_under(self, width: FloatArray) -> FloatArray:
        """`_give` under contacts of these widths, shape (crests, places)."""
        return self._give(self._half_width(width))

    @property
    def _period(self) -> float:
        """After which the row repeats [m]."""
        return self.feed * self.row.size

    @cached_property
    def _coupling(self) -> FloatArray:
        """Of `_give` the part of all other crests, without the factor of the pressure, shape (n, n, waves) [-]."""
        from scipy.special import k0

        k, f, n = self._wavenumbers[1:], self._period, self.row.size
        coupling = np.zeros((n, n, k.size + 1))
        coupling[range(n), range(n), 1:] = sum(
            2.0 * k0(k * number * f) for number in range(1, _NEIGHBOURS + 1)
        )
        repeated = f * np.arange(-_NEIGHBOURS, _NEIGHBOURS + 1)
        for one, two in combinations(range(n), 2):
            apart = self.row[two] - self.row[one]
            coupling[one, two, 0] = -math.log(2.0 * math.sin(math.pi * apart / f))
            coupling[one, two, 1:] = k0(k * np.abs(apart + repeated)[:, None]).sum(axis=0)
            coupling[two, one] = coupling[one, two]
        return coupling

    def press(self, level: float, start: FloatArray | None = None) -> PressedCrests:
        """First loading to a level of the flat.

        Parameters
        ----------
        level : float
            Above the mean line of the smooth crests [m].
        start : ndarray, optional
            Widths near those of this level [m].

        Raises
        ------
        SurfaceError
            A contact is as wide as what is known of the crest, or no solution was found.
        """
        width = 0.5 * self.spacing * (self._edges > level).sum(axis=2) if start is None else start
        half_width, at_width = self._half_width(width), self._at_width(width)
        wide = 0
        for _ in range(_MOST_STEPS):
            give = self._give(half_width)
            sinking = sinking_along(give, width)
            edge, fall, section = at_width
            apart = level + sinking - edge
            active = (width > 0.0) | (apart < 0.0)
            last, half_width = half_width, self._half_width(width)
            is_solved = (apart[active] ** 2).sum() <= (_TOLERANCE * self._scale) ** 2 * active.sum()
            if is_solved and np.all(abs(half_width - last) < _BAND_CHANGE * half_width):
                break
            if is_solved:
                continue
            change = conjugate_gradients(give, fall, active, -apart)
            energy, share = _energy(level, width, sinking, section), 1.0
            while share > _LEAST_SHARE:
                trial = np.clip(width + share * change, 0.0, self.most_width)
                at_width = self._at_width(trial)
                if _energy(level, trial, sinking_along(give, trial), at_width[2]) <= energy:
                    break
                share *= 0.5
            width, wide = trial, wide + int(trial.max() >= self.most_width)
            if wide > _MOST_WIDE:
                break
        else:
            raise SurfaceError(f"level = {level:g} m: the contact of the crests does not converge")
        if width.max() >= self.most_width:
            raise SurfaceError(f"level = {level:g} m: contacts are wider than what is known of the crests")
        gap = np.where(width > 0.0, 0.0, np.maximum(level + sinking - self.tops, 0.0))
        overlap = float((section - edge * width).mean()) / self.feed
        return PressedCrests(
            self.contact_pressure * float(width.mean()) / self.feed, level, width, gap, overlap
        )

    def _half_width(self, width: FloatArray) -> FloatArray:
        """Of the contacts of each crest of the row, shape (n,) [m]."""
        touching = [part[part > 0.0] for part in of_each(width, self.row.size)]
        means = [0.5 * float(part.mean()) if part.size else 0.0 for part in touching]
        return np.maximum(means, 0.25 * self.spacing)


def of_each(values: FloatArray, crests: int) -> FloatArray:
    """Values at the places of each crest of a row, shape (crests, all its places)."""
    return values.reshape(-1, crests, values.shape[1]).swapaxes(0, 1).reshape(crests, -1)


def sinking_along(give: FloatArray, width: FloatArray) -> FloatArray:
    """Sinking of each place under the load of all [m]."""
    waves = np.fft.rfft(width, axis=1)
    if give.shape[0] == 1:
        return np.fft.irfft(give[0, 0] * waves, width.shape[1], axis=1)
    rows = waves.reshape(-1, give.shape[0], waves.shape[1])
    return np.fft.irfft(np.einsum("ijk,rjk->rik", give, rows).reshape(waves.shape), width.shape[1], axis=1)


def _energy(level: float, width: FloatArray, sinking: FloatArray, section: FloatArray) -> float:
    """What the widths make least: its gradient over a width is how far the flat is from the edge of the contact."""
    return float((0.5 * width * sinking + level * width - section).sum())


def conjugate_gradients(
    give: FloatArray, fall: FloatArray, active: BoolArray, distance: FloatArray
) -> FloatArray:
    """Change of the widths that closes a distance where the contact is active [m]."""
    change, rest = np.zeros(distance.shape), np.where(active, distance, 0.0)
    own = give.diagonal().mean(axis=0)
    scale = 1.0 / (fall + np.resize(own, fall.shape[0])[:, None])
    direction = scaled = scale * rest
    product = first = float((rest * scaled).sum())
    for _ in range(_MOST_GRADIENTS):
        if product <= _RESIDUAL * first:
            break
        image = np.where(active, sinking_along(give, direction) + fall * direction, 0.0)
        step = product / float((direction * image).sum())
        change, rest = change + step * direction, rest - step * image
        scaled = scale * rest
        product, before = float((rest * scaled).sum()), product
        direction = scaled + product / before * direction
    return change
