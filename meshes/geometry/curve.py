"""Straight lines and circular arcs, and chains of them, measured by their arc length."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshes.arrays import FloatArray, IntArray

Point = tuple[float, float]


def as_point(p: FloatArray) -> Point:
    """A point out of an array."""
    return float(p[0]), float(p[1])


@dataclass(frozen=True)
class Segment:
    """One piece of an outline, from `start` to `end`, straight unless `centre` makes it an arc.

    Parameters
    ----------
    start, end : tuple of float
        End points (r, z) [m].
    name : str
        Boundary that the piece belongs to; several pieces may share one name.
    centre : tuple of float, optional
        Centre (r, z) [m] of a circular arc. The arc spans less than 180 degrees and runs the short way.

    Examples
    --------
    >>> import meshes
    >>> arc = meshes.Segment((0.0, -0.02), (0.02, 0.0), "closure_face", centre=(0.0, 0.0))
    >>> arc.centre is None
    False
    """

    start: Point
    end: Point
    name: str
    centre: Point | None = None

    @property
    def sweep(self) -> float:
        """Angle by which an arc turns [rad], positive counter-clockwise; zero for a line."""
        if self.centre is None:
            return 0.0
        a, b = np.subtract(self.start, self.centre), np.subtract(self.end, self.centre)
        return math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))

    @property
    def corners(self) -> list[Point]:
        """Ends, and places inside an arc where it runs along r or z: its extent is theirs."""
        if self.centre is None:
            return [self.start, self.end]
        c, radius = self.centre, math.dist(self.start, self.centre)
        a, b = np.subtract(self.start, c), np.subtract(self.end, c)
        compass = ((1, 0), (0, 1), (-1, 0), (0, -1))
        # On the arc are the directions that are no further from its middle than its ends are.
        ways = [way for way in compass if float((a + b) @ way) * radius > float((a + b) @ a)]
        return [self.start, self.end, *((c[0] + radius * r, c[1] + radius * z) for r, z in ways)]

    @property
    def length(self) -> float:
        """Arc length [m]."""
        if self.centre is None:
            return math.dist(self.start, self.end)
        return abs(self.sweep) * math.dist(self.start, self.centre)

    @property
    def reversed(self) -> Segment:
        """The same piece run from its end to its start."""
        return Segment(self.end, self.start, self.name, self.centre)

    def shift(self, dz: float) -> Segment:
        """The segment moved by dz [m] along the axis."""

        def move(p: Point) -> Point:
            return p[0], p[1] + dz

        centre = None if self.centre is None else move(self.centre)
        return Segment(move(self.start), move(self.end), self.name, centre)


def arc_pieces(centre: Point, radius: float, start: float, sweep: float) -> list[Segment]:
    """An arc as pieces of at most a right angle.

    Parameters
    ----------
    centre : tuple of float
        [m]
    radius : float
        [m]
    start, sweep : float
        Angle of its first point from the first coordinate, and by how much it turns on [rad].
    """
    count = max(1, math.ceil(abs(sweep) / (0.5 * math.pi) - 1e-9))

    def at(n: int) -> Point:
        angle = start + sweep * n / count
        return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)

    return [Segment(at(n), at(n + 1), "", centre) for n in range(count)]


# Change of direction [rad] and relative change of curvature that count in `Curve.bends`.
_CORNER, _JUMP = 1e-4, 0.3


@dataclass(frozen=True)
class Curve:
    """Open chain of segments in the (r, z) half-plane, each starting where the one before ends.

    A line is an arc of curvature zero: with start P, unit tangent t, left normal n and curvature k the point at arc
    length s is P + t sin(ks)/k + n (1 - cos(ks))/k.

    Parameters
    ----------
    segments : tuple of Segment
        Not empty; all of positive length.

    Examples
    --------
    >>> import meshes
    >>> step = meshes.chain([(0.0, 0.0), (0.01, 0.0), (0.01, 0.01)], "seat_face")
    >>> len(step.segments)
    2
    """

    segments: tuple[Segment, ...]

    @property
    def _start(self) -> FloatArray:
        return np.array([s.start for s in self.segments])

    @cached_property
    def _curvature(self) -> FloatArray:
        return np.array([_curvature(s) for s in self.segments])

    @property
    def _lengths(self) -> FloatArray:
        return np.array([s.length for s in self.segments])

    @cached_property
    def _frames(self) -> FloatArray:
        """Unit tangent and left normal at the start of every segment, shape (n, 2, 2)."""
        tangents = np.array([_first_tangent(s) for s in self.segments])
        return np.stack([tangents, np.column_stack([-tangents[:, 1], tangents[:, 0]])], axis=1)

    @cached_property
    def breaks(self) -> FloatArray:
        """Arc lengths at which segments begin and end [m], zero and the whole length included."""
        return np.concatenate([[0.0], np.cumsum(self._lengths)])

    @property
    def bends(self) -> FloatArray:
        """Inner breaks [m] with a corner or a jump of curvature; not the joints of arcs that follow a smooth curve."""
        k, size = self._curvature, self.length
        jump, larger = np.abs(np.diff(k)), np.maximum(np.abs(k[1:]), np.abs(k[:-1]))
        ends = self.tangent(self.breaks[1:-1])
        turn = self._curvature[:-1] * self._lengths[:-1]
        t = self._frames[:-1]
        end_tangent = (np.cos(turn)[:, None] * t[:, 0] + np.sin(turn)[:, None] * t[:, 1]).T
        corner = np.abs(end_tangent[0] * ends[1] - end_tangent[1] * ends[0]) > _CORNER
        return self.breaks[1:-1][corner | ((jump > _JUMP * larger) & (jump * size > 1e-3))]

    @property
    def length(self) -> float:
        """Length of the chain [m]."""
        return float(self.breaks[-1])

    @property
    def is_straight(self) -> bool:
        """Whether the whole chain is one straight line."""
        ends = np.array([self.segments[0].start, self.segments[-1].end])
        turn = self.tangent(self.breaks[:-1]) - ((ends[1] - ends[0]) / math.dist(*ends))[:, None]
        return not self._curvature.any() and bool(np.abs(turn).max() < 1e-12)

    def dense(self, number: int) -> FloatArray:
        """Arc lengths [m] of some `number` points, several on every segment, breaks among them."""
        count = max(4, math.ceil(number / len(self.segments)))
        shares = np.linspace(0.0, 1.0, count, endpoint=False)
        inner = self.breaks[:-1, None] + self._lengths[:, None] * shares
        return np.append(inner.ravel(), self.breaks[-1])

    def _locate(self, s: FloatArray) -> tuple[IntArray, FloatArray]:
        index = np.clip(np.searchsorted(self.breaks, s, side="right") - 1, 0, len(self.segments) - 1)
        return index, s - self.breaks[index]

    def point(self, s: FloatArray) -> FloatArray:
        """Points (r, z) [m] at the arc lengths s [m], shape (2, ...); beyond the ends the end segments go on."""
        index, t = self._locate(np.asarray(s, dtype=float))
        half = 0.5 * self._curvature[index] * t
        chord = t * np.sinc(half / np.pi)
        tangent, normal = self._frames[index, 0], self._frames[index, 1]
        offset = chord * np.cos(half), chord * np.sin(half)
        return np.moveaxis(
            self._start[index] + offset[0][..., None] * tangent + offset[1][..., None] * normal, -1, 0
        )

    def tangent(self, s: FloatArray) -> FloatArray:
        """Unit tangents (t_r, t_z) at the arc lengths s [m], shape (2, ...)."""
        index, t = self._locate(np.asarray(s, dtype=float))
        turn = self._curvature[index] * t
        tangent, normal = self._frames[index, 0], self._frames[index, 1]
        return np.moveaxis(np.cos(turn)[..., None] * tangent + np.sin(turn)[..., None] * normal, -1, 0)

    def normal(self, s: FloatArray) -> FloatArray:
        """Unit normals to the left of the curve at the arc lengths s [m], shape (2, ...)."""
        t = self.tangent(s)
        return np.stack([-t[1], t[0]])

    def curvatures(self, s: FloatArray) -> FloatArray:
        """Curvatures [1/m] at s [m], positive where the curve bends to its left; at a break of what follows it."""
        return self._curvature[self._locate(np.asarray(s, dtype=float))[0]]

    def curvature(self, s: float) -> float:
        """Curvature [1/m] at one place, see `curvatures`."""
        return float(self.curvatures(np.asarray(s)))

    def project(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """Arc length of the nearest point of the curve to every (r, z) [m]; never beyond its ends."""
        r, z = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(z, dtype=float))
        feet, distances = [], []
        for n in range(len(self.segments)):
            a, b = self._local(n, np.stack([r, z], axis=-1))
            k = self._curvature[n]
            foot = np.clip(np.arctan2(k * a, 1 - k * b) / k if k else a, 0.0, self._lengths[n])
            feet.append(self.breaks[n] + foot)
            # The end of one segment is the start of the next: the local point keeps both on their own side.
            half = 0.5 * k * foot
            chord = foot * np.sinc(half / np.pi)
            distances.append(np.hypot(a - chord * np.cos(half), b - chord * np.sin(half)))
        best = np.argmin(distances, axis=0)
        return np.take_along_axis(np.array(feet), best[None], axis=0)[0]

    def project_radius(self, radius: float) -> float:
        """Arc length at which a curve that runs outwards passes a radius [m]; never beyond its ends."""
        ends = self.point(self.breaks)[0]
        n = int(np.clip(np.searchsorted(ends, radius, side="right") - 1, 0, len(self.segments) - 1))
        k, tangent = self._curvature[n], self._frames[n, 0]
        dr = radius - self._start[n, 0]
        if k:
            first = math.atan2(tangent[1], tangent[0])
            # Run outwards, the sine of the inclination is linear in r.
            foot = (math.asin(min(max(math.sin(first) + k * dr, -1.0), 1.0)) - first) / k
        else:
            foot = dr / tangent[0]
        return float(self.breaks[n] + min(max(foot, 0.0), self._lengths[n]))

    def hits(
        self, origin: FloatArray, direction: FloatArray, overhang: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """Where rays first meet the curve.

        Parameters
        ----------
        origin : ndarray, shape (2, m)
            Starting points [m]. A start that lies on the curve, or behind it by round-off, counts as a hit.
        direction : ndarray, shape (2, m)
            Unit vectors.
        overhang : float
            How far the first and the last segment go on beyond the ends of the curve [m].

        Returns
        -------
        distance : ndarray, shape (m,)
            Along the ray [m]; nan where it misses.
        arc_length : ndarray, shape (m,)
            Of the curve's point that is hit [m], at an end also for what lies beyond it; nan where the ray misses.
        """
        slack = 1e-9 * self.length
        low, high = np.full((2, len(self.segments)), slack)
        low[0] += overhang
        high[-1] += overhang
        distance = np.full(origin.shape[1], np.inf)
        arc = np.full(origin.shape[1], np.nan)
        for n, length in enumerate(self._lengths):
            k = self._curvature[n]
            a, b = self._local(n, origin.T)
            da, db = direction.T @ self._frames[n, 0], direction.T @ self._frames[n, 1]
            for t in _circle_roots(k, k * (a * da + b * db) - db, k * (a**2 + b**2) - 2 * b):
                with np.errstate(invalid="ignore"):
                    at, height = a + t * da, b + t * db
                    foot = np.arctan2(k * at, 1 - k * height) / k if k else at
                    is_hit = (t > -slack) & (foot > -low[n]) & (foot < length + high[n]) & (t < distance)
                distance = np.where(is_hit, t, distance)
                arc = np.where(is_hit, self.breaks[n] + np.clip(foot, 0.0, length), arc)
        return np.where(np.isfinite(distance), distance, np.nan), arc

    def _local(self, n: int, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        offset = points - self._start[n]
        return offset @ self._frames[n, 0], offset @ self._frames[n, 1]

    def part(
        self, start: float, end: float, name: str, shortest: tuple[float, float] = (0.0, 0.0)
    ) -> tuple[Segment, ...]:
        """The curve between two arc lengths [m], under a new name; nothing if they are equal.

        A first or last piece shorter than `shortest` [m] becomes one with its neighbour, straight across the break.
        """
        round_off = 1e-10 * self.length
        if not end - start > round_off:
            return ()
        lower, upper = start + max(shortest[0], round_off), end - max(shortest[1], round_off)
        inner = self.breaks[(self.breaks > lower) & (self.breaks < upper)]
        return self.pieces(np.concatenate([[start], inner, [end]]), name)

    def pieces(self, ends: FloatArray, name: str) -> tuple[Segment, ...]:
        """One segment between every two neighbours of the arc lengths `ends` [m]; straight across a break."""
        points = [as_point(p) for p in self.point(ends).T]
        slack = 1e-9 * self.length
        first, last = self._locate(ends[:-1] + slack)[0], self._locate(ends[1:] - slack)[0]
        return tuple(
            Segment(points[i], points[i + 1], name, self.segments[a].centre if a == b else None)
            for i, (a, b) in enumerate(zip(first.tolist(), last.tolist(), strict=True))
        )

    def without_first(self) -> Curve:
        """The curve without its first segment."""
        return Curve(self.segments[1:])

    def without_last(self) -> Curve:
        """The curve without its last segment."""
        return Curve(self.segments[:-1])

    @property
    def reversed(self) -> Curve:
        """The same curve run from its end to its start."""
        return Curve(tuple(s.reversed for s in reversed(self.segments)))


def _unit(v: FloatArray) -> FloatArray:
    return v / math.hypot(*v)


def _circle_roots(A: float, B: FloatArray, C: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Roots of A t^2 + 2 B t + C = 0 without cancellation; nan where there are none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(B**2 - A * C)
        larger = -B - np.copysign(root, B)
        return C / larger, larger / A if A else np.full_like(B, np.nan)


def _first_tangent(s: Segment) -> FloatArray:
    if s.centre is None:
        return _unit(np.subtract(s.end, s.start))
    arm = _unit(np.subtract(s.start, s.centre))
    return math.copysign(1.0, s.sweep) * np.array([-arm[1], arm[0]])


def _curvature(s: Segment) -> float:
    return 0.0 if s.centre is None else math.copysign(1.0 / math.dist(s.start, s.centre), s.sweep)
