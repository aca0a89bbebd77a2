"""Turned faces: cusps between the grooves of a tool, with fine roughness on them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.errors import SurfaceError, positive
from leak.surfaces.profile_parameters import ExpectedRoughness, ProfileFilter
from leak.surfaces.random import random_map
from leak.surfaces.spectrum import PowerSpectrum

# Crests of two faces of unlike feeds that stand for all of them, about; places at which a feed is looked at.
_CRESTS, _PER_FEED = 16, 2048
# Beside a higher one an edge is a crest if it is farther away than the rms height over the slope of the sides. It has a
# valley before it, so many rms heights deep, or is so many times that way apart; lower than so many rms heights it
# needs so deep a valley.
_VALLEY, _APART, _LOWER, _DEEP_VALLEY = 0.01, 4.0, 3.0, 0.1
# Depth below a crest over the height of the crests, from there to the middle of a groove; heights of a probability.
_FALL = 1.0 - np.linspace(1.0, 0.0, 1025)[1::2] ** 2
_HEIGHTS = np.linspace(0.0, 8.0, 400)


class Cusps(NamedTuple):
    """What the tool leaves of a turned face without its fine roughness.

    Parameters
    ----------
    feed : float
        Distance of the crests [m].
    nose_radius : float
        Of the tool [m].

    Examples
    --------
    >>> from leak import Cusps
    >>> print(f"{Cusps(feed=1e-4, nose_radius=8e-4).height * 1e6:.2f} um")
    1.56 um
    """

    feed: float
    nose_radius: float

    @property
    def height(self) -> float:
        """R_t = f^2/(8 r), from the bottom of a groove to a crest [m]."""
        return self.feed**2 / (8.0 * self.nose_radius)

    @property
    def side_slope(self) -> float:
        """m = f/(2 r), of both sides at the crest [-]."""
        return self.feed / (2.0 * self.nose_radius)

    def depth_at(self, distance: FloatArray) -> FloatArray:
        """Depth below the crests [m].

        Parameters
        ----------
        distance : ndarray
            From the nearest crest, up to half of the feed [m].
        """
        return self.side_slope * distance - distance**2 / (2.0 * self.nose_radius)


class Crest(NamedTuple):
    """One of those that repeat: place, height beside the highest, ways to its valleys, mean slope, the next valley."""

    place: float
    height: float
    valleys: tuple[float, float]
    slope: float
    next_valley: float


@dataclass(frozen=True)
class TurnedRoughness:
    """Roughness values expected of a turned face, right across its grooves.

    Cusps and fine roughness are independent parts of one profile. The cusps are counted whole: a cutoff lambda_c of two
    feeds takes 6 % off their first wave, one of four nothing.

    Parameters
    ----------
    crest_height : float
        R_t, from the bottom of a groove to a crest [m].
    fine : ExpectedRoughness
        Of the fine roughness alone.

    Examples
    --------
    >>> fine = ExpectedRoughness(1e-7, 100.0, ProfileFilter(0.8e-3, 2.5e-6))
    >>> of_face = TurnedRoughness(1.5625e-6, fine)
    >>> print(f"Ra {of_face.Ra * 1e6:.2f}, Rq {of_face.Rq * 1e6:.2f}, Rz {of_face.Rz * 1e6:.1f} um")
    Ra 0.41, Rq 0.48, Rz 2.0 um
    """

    crest_height: float
    fine: ExpectedRoughness

    @property
    def filter(self) -> ProfileFilter:
        """With which it is measured."""
        return self.fine.filter

    @property
    def Ra(self) -> float:
        """Mean deviation, of parabolas 4/(9 sqrt 3) R_t [m]."""
        return _mean_deviation(self.crest_height * _FALL, self.fine.Rq)

    @property
    def Rq(self) -> float:
        """Root of the mean square, of parabolas R_t times the root of 4/45 [m]."""
        return math.hypot(math.sqrt(4.0 / 45.0) * self.crest_height, self.fine.Rq)

    @property
    def Rz(self) -> float:
        """Highest peak plus deepest valley of a sampling length, on average [m].

        Each wave of the fine roughness has a peak of Rayleigh's distribution, at its own place of a cusp.
        """
        return self.crest_height + self._reach(_FALL) + self._reach(1.0 - _FALL)

    def _reach(self, depth: FloatArray) -> float:
        """How far the highest peak rises above the end of the cusps, at places whose depths are evenly likely [m]."""
        s, waves = self.fine.Rq, max(self.fine.waves, 2.0)
        lift = _HEIGHTS[:, None] + self.crest_height / s * depth
        all_below = np.exp(-waves * np.exp(-0.5 * lift**2).mean(axis=1))
        return float(s * np.trapezoid(1.0 - all_below, _HEIGHTS))

    def value(self, parameter: str) -> float:
        """One of them by its name, "Ra", "Rq" or "Rz" [m]."""
        return {"Ra": self.Ra, "Rq": self.Rq, "Rz": self.Rz}[parameter]


def _mean_deviation(depths: FloatArray, s: float) -> float:
    """Of heights at evenly spaced places with Gaussian ones on them [m]."""
    from scipy.special import erf

    deviation = depths - depths.mean()
    # mean of the magnitude of d + z over a Gaussian z
    rest = math.sqrt(2.0 / math.pi) * s * np.exp(-0.5 * (deviation / s) ** 2)
    return float(np.mean(rest + deviation * erf(deviation / (math.sqrt(2.0) * s))))


@dataclass(frozen=True)
class TurnedTexture:
    """A face as a tool of round nose leaves it, which is fed by the same way each turn, or two of them together.

    Two faces count as one that lies on a flat: their depths add. Their crests repeat after so many feeds of both that
    their lengths are about equal, some 16 crests at most; feeds that are nearer to each other than that are equal.

    Parameters
    ----------
    feed : float
        Distance of the crests [m].
    nose_radius : float
        Of the tool [m].
    fine : PowerSpectrum
        Isotropic roughness of the grooves: tool edge, built-up edge, material; of both faces.
    other : Cusps, optional
        Of a turned face that lies on this one.
    phase : float
        Way from a crest of this face to one of the other, over that after which both lie alike: a feed, if the feeds
        are equal [-].

    Raises
    ------
    SurfaceError
        A value is not positive, or the feed is more than the nose of the tool spans.

    Examples
    --------
    >>> import leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
    >>> texture = leak.TurnedTexture(feed=1e-4, nose_radius=8e-4, fine=fine)
    >>> print(f"{texture.crest_height * 1e6:.2f} um, slope {texture.side_slope:.3f}, Ra {texture.Ra * 1e6:.2f} um")
    1.56 um, slope 0.062, Ra 0.41 um
    """

    feed: float
    nose_radius: float
    fine: PowerSpectrum
    other: Cusps | None = None
    phase: float = 0.5

    def __post_init__(self) -> None:
        _checked_cusps("", self.own)
        if not isinstance(self.fine, PowerSpectrum):
            raise SurfaceError(f"fine = {self.fine!r}: must be a PowerSpectrum")
        if self.other is not None:
            _checked_cusps("other.", self.other)
        if not 0.0 <= self.phase <= 1.0:
            raise SurfaceError(f"phase = {self.phase!r}: must be 0 to 1 [-]")

    @property
    def cusp_parameters(self) -> tuple[float, ...]:
        """Feed and nose radius [m]; of two faces also those of the other one [m], and the phase [-]."""
        return tuple(self.own) if self.other is None else (*self.own, *self.other, self.phase)

    @property
    def own(self) -> Cusps:
        """Of this face alone."""
        return Cusps(self.feed, self.nose_radius)

    @cached_property
    def _combs(self) -> tuple[tuple[Cusps, int, float], ...]:
        """Cusps, number of their crests until all lie alike, and place of one of them [m].

        The higher ones come first, so that it does not matter which face is called the other one.
        """
        if self.other is None:
            return ((self.own, 1, 0.0),)
        high, low = sorted((self.own, self.other), key=lambda cusps: (cusps.height, cusps.feed), reverse=True)
        number, of_low = _whole_numbers(low.feed / high.feed)
        return (high, number, 0.0), (low, of_low, min(self.phase, 1.0 - self.phase) * high.feed / of_low)

    @property
    def period(self) -> float:
        """Way across the crests after which they repeat: the feed of one face [m]."""
        cusps, number, _ = self._combs[0]
        return number * cusps.feed

    def _depth(self, place: FloatArray) -> FloatArray:
        """Below crests that coincide [m]."""
        depth = np.zeros(place.shape)
        for cusps, number, first in self._combs:
            # of a feed that is fitted into the period
            feeds = (place - first) * (number * cusps.feed / self.period)
            depth += cusps.depth_at(np.abs((feeds + 0.5 * cusps.feed) % cusps.feed - 0.5 * cusps.feed))
        return depth

    @property
    def _edges(self) -> FloatArray:
        """Places of the crests of both faces [m]."""
        places = [first + np.arange(number) * (self.period / number) for _, number, first in self._combs]
        return np.concatenate(places)

    @cached_property
    def _highest(self) -> float:
        """Depth of the highest crest below crests that coincide [m]."""
        return 0.0 if self.other is None else float(self._depth(self._edges).min())

    def depth_below(self, place: FloatArray) -> FloatArray:
        """Depth of the smooth faces together below the highest of their crests [m].

        Parameters
        ----------
        place : ndarray
            Across the crests, from one of the higher ones [m].
        """
        return self._depth(place) - self._highest

    @cached_property
    def crest_height(self) -> float:
        """From the bottom of a groove to a crest, R_t = f^2/(8 r); of two faces the deepest and the highest [m]."""
        if self.other is None:
            return self.own.height
        return float(self.depths.max())

    @property
    def mean_depth(self) -> float:
        """Below the highest crest [m]: 2/3 R_t of one face."""
        return 2.0 / 3.0 * sum(cusps.height for cusps, _, _ in self._combs) - self._highest

    @property
    def side_slope(self) -> float:
        """m = f/(2 r), of both sides at the crest of this face [-]."""
        return self.own.side_slope

    @cached_property
    def depths(self) -> FloatArray:
        """Below the highest crest, at evenly spaced places of what repeats; of one face of half a feed [m]."""
        if self.other is None:
            return self.depth_at(np.linspace(0.0, 0.5 * self.feed, 513)[1::2])
        number = _PER_FEED * self._combs[0][1]
        return self.depth_below(np.asarray((np.arange(number) + 0.5) * (self.period / number)))

    @property
    def Ra(self) -> float:
        """Mean deviation of a profile across the grooves [m]: of parabolas 4/(9 sqrt 3) R_t, with the fine roughness.

        Cusp and fine roughness are added as independent parts of one profile.
        """
        return _mean_deviation(self.depths, self.fine.rms_height)

    def depth_at(self, distance: FloatArray) -> FloatArray:
        """Depth of this smooth face alone below its crests [m].

        Parameters
        ----------
        distance : ndarray
            From the nearest crest, up to half of the feed [m].
        """
        return self.own.depth_at(distance)

    @property
    def mean_feed(self) -> float:
        """Way of the thread toward the inside in a turn [m]; of two faces the mean, weighted by their heights."""
        if self.other is None:
            return self.feed
        return sum(cusps.feed * cusps.height for cusps, _, _ in self._combs) / sum(
            cusps.height for cusps, _, _ in self._combs
        )

    def gap_at(self, share: FloatArray) -> FloatArray:
        """Mean gap below a flat that cuts off all that stands above it [m].

        Parameters
        ----------
        share : ndarray
            Of the face that is cut off, from the highest crest on [-].
        """
        if self.other is not None:
            depth = np.append(0.0, np.sort(self.depths))
            places = np.append(0.0, (np.arange(depth.size - 1) + 0.5) / (depth.size - 1))
            edges = np.linspace(0.0, 1.0, depth.size)
            lower = (depth.sum() - np.cumsum(depth)) / (depth.size - 1)
            return np.interp(share, edges, lower) - np.interp(share, places, depth) * (1.0 - share)
        half, r = 0.5 * self.feed * share, self.nose_radius
        below = 0.5 * self.side_slope * half**2 - half**3 / (6.0 * r)
        rest = self.crest_height * self.feed / 3.0 - below - self.depth_at(half) * (0.5 * self.feed - half)
        return rest / (0.5 * self.feed)

    def crests(self, roughness: float) -> tuple[Crest, ...]:
        """Those of what repeats, as far as fine roughness tells them from each other.

        Parameters
        ----------
        roughness : float
            Its rms height [m].
        """
        if self.other is None:
            return (Crest(0.0, 0.0, (0.5 * self.feed, 0.5 * self.feed), self.side_slope, self.crest_height),)
        within = roughness / max(cusps.side_slope for cusps, _, _ in self._combs)
        edges, depth = self._edges, self.depth_below(self._edges)
        kept: list[float] = []
        for place, own in sorted(zip(edges.tolist(), depth.tolist(), strict=True), key=lambda edge: edge[1]):
            if all(self._stands_alone(place, own, higher, roughness, within) for higher in kept):
                kept.append(place)
        kept.sort()
        ends = [
            self._valley(one, two, 0.5 * min(_APART * within, two - one))
            for one, two in pairwise([*kept, kept[0] + self.period])
        ]
        tops, deep = self.depth_below(np.array(kept)), self.depth_below(np.array(ends))
        valleys = deep - np.minimum(tops, np.roll(tops, -1))
        # edges so near to each other that roughness bridges them make one crest
        sides = [self.depth_below(np.array(kept) + way) for way in (-within, within)]
        slopes = (0.5 * sum(sides) - tops) / within + 0.5 * self.curvature * within
        ways = zip(kept - np.roll(ends, 1), ends - np.array(kept), strict=True)
        ways_down = [(before % self.period, after) for before, after in ways]
        return tuple(map(Crest, kept, (-tops).tolist(), ways_down, slopes.tolist(), valleys.tolist()))

    @property
    def curvature(self) -> float:
        """Of the sides between crests, 1/r; of two faces their sum [1/m]."""
        return sum(
            (number * cusps.feed / self.period) ** 2 / cusps.nose_radius for cusps, number, _ in self._combs
        )

    def _between(self, one: float, two: float) -> FloatArray:
        return np.linspace(one, two, _PER_FEED + 1)

    def _stands_alone(
        self, place: float, depth: float, higher: float, roughness: float, within: float
    ) -> bool:
        """Whether an edge is a crest beside a higher one, and no part of its sides."""
        two = higher + self.period * round((place - higher) / self.period)
        valley = float(self.depth_below(self._between(place, two)).max()) - depth
        if depth - float(self.depth_below(np.array([higher]))[0]) > _LOWER * roughness:
            return valley > _DEEP_VALLEY * roughness
        apart = abs(place - two) / within
        return apart > 1.0 and (apart >= _APART or valley > _VALLEY * roughness)

    def _valley(self, one: float, two: float, least: float) -> float:
        """Deepest place between crests, a way from both of them at least [m]."""
        places = self._between(one, two)
        return float(np.clip(places[np.argmax(self.depth_below(places))], one + least, two - least))

    def heights(self, *, points: int, crests: int, seed: int) -> FloatArray:
        """A periodic square piece of the face, as `leak.direct.simulate` takes it.

        Parameters
        ----------
        points : int
            Along each side.
        crests : int
            So many feeds are its side; of two faces so many times what repeats.
        seed : int
            Of the fine roughness.

        Returns
        -------
        ndarray, shape (points, points)
            Heights [m]; crests run along the second axis, so that the fluid crosses them along the first.
        """
        size = crests * self.period
        place: FloatArray = np.asarray(np.arange(points) * (size / points))
        fine = random_map(self.fine, size=size, points=points, seed=seed)
        return np.asarray(fine - self.depth_below(place)[:, None])


def _whole_numbers(ratio: float) -> tuple[int, int]:
    """Of about this ratio and without a common divisor, whose sum is not large where both are more than one."""
    larger = max(ratio, 1.0 / ratio)
    share = Fraction(larger).limit_denominator(max(int(_CRESTS / (1.0 + larger)), 1))
    return (share.numerator, share.denominator) if ratio > 1.0 else (share.denominator, share.numerator)


def _checked_cusps(where: str, cusps: Cusps) -> None:
    f = positive(SurfaceError, f"{where}feed", cusps.feed, "m")
    r = positive(SurfaceError, f"{where}nose_radius", cusps.nose_radius, "m")
    if f >= r:
        raise SurfaceError(
            f"{where}feed = {f:g} m: must be below the nose radius, {r:g} m; "
            "take a shorter feed or a rounder nose"
        )
