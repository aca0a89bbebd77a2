"""Smooth curves as chains of circular arcs: two arcs between every two points, with the given directions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from meshes.arrays import FloatArray
from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve, Segment, as_point

# Halvings of a piece of curve before it is refused.
_DEEPEST = 24
_SAMPLES = 9


def biarc(
    start: FloatArray, start_direction: FloatArray, end: FloatArray, end_direction: FloatArray
) -> list[Segment]:
    """Two arcs (or lines) through two points with their directions, each taking the same control length.

    Parameters
    ----------
    start, end : ndarray, shape (2,)
        Points [m].
    start_direction, end_direction : ndarray, shape (2,)
        Unit tangents there.

    Notes
    -----
    K. M. Bolton, "Biarc curves", Computer-Aided Design 7 (1975) 89-92.
    """
    chord, directions = end - start, start_direction + end_direction
    turn = 2 * (1 - float(start_direction @ end_direction))
    dot, square = float(chord @ directions), float(chord @ chord)
    length = (math.sqrt(dot**2 + turn * square) - dot) / turn if turn > 1e-12 else square / (2 * dot)
    middle = 0.5 * (start + end + length * (start_direction - end_direction))
    return [_arc(start, start_direction, middle), _arc(end, -end_direction, middle).reversed]


def _arc(start: FloatArray, direction: FloatArray, end: FloatArray) -> Segment:
    chord = end - start
    normal = np.array([-direction[1], direction[0]])
    offset = float(chord @ normal)
    if abs(offset) < 1e-9 * math.hypot(*chord):
        return Segment(as_point(start), as_point(end), "")
    radius = float(chord @ chord) / (2 * offset)
    return Segment(as_point(start), as_point(end), "", as_point(start + radius * normal))


def fit_arcs(
    curve: Callable[[float], tuple[FloatArray, FloatArray]],
    start: float,
    end: float,
    tolerance: float,
    depth: int = 0,
) -> list[Segment]:
    """Chain of arcs that follows a smooth curve.

    Parameters
    ----------
    curve : callable
        From the parameter to a point [m] and a tangent of any length.
    start, end : float
        Range of the parameter; no kink inside.
    tolerance : float
        Largest distance between curve and arcs [m].
    depth : int
        How often the curve that is meant was halved to this one.

    Raises
    ------
    GeometryError
        If arcs cannot follow the curve, for example because it has a cusp.
    """
    places = np.linspace(start, end, _SAMPLES)
    points, tangents = zip(*(curve(float(t)) for t in places), strict=True)
    p = np.array(points)
    directions = [t / math.hypot(*t) if math.hypot(*t) > 0 else t for t in tangents]
    # A turn of a right angle is no matter for two arcs, more may be a loop.
    if float(directions[0] @ directions[-1]) > 0:
        arcs = biarc(p[0], directions[0], p[-1], directions[-1])
        chain = Curve(tuple(s for s in arcs if s.start != s.end))
        foot = chain.point(chain.project(p[:, 0], p[:, 1])).T
        if float(np.max(np.hypot(*(foot - p).T))) <= tolerance:
            return list(chain.segments)
    if depth == _DEEPEST:
        raise GeometryError(
            f"a curve near ({mm(p[0, 0])}, {mm(p[0, 1])}) cannot be followed by arcs within {mm(tolerance)}; it "
            "may have a cusp or a damaged number"
        )
    middle = 0.5 * (start + end)
    return [
        *fit_arcs(curve, start, middle, tolerance, depth + 1),
        *fit_arcs(curve, middle, end, tolerance, depth + 1),
    ]


def through(points: FloatArray, name: str, sharpest: float) -> Curve:
    """Smooth chain of arcs through points, with sharp corners kept.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        In order along the curve [m], at least two.
    name : str
        Name of all segments.
    sharpest : float
        Change of direction [rad] between neighbouring chords from which on a point is a corner.

    Notes
    -----
    The direction at a point is that of the circle through it and its neighbours, so that points of a circle give the
    very circle.
    """
    chords = np.diff(points, axis=0)
    lengths = np.hypot(*chords.T)
    units = chords / lengths[:, None]
    turns = np.arctan2(
        units[:-1, 0] * units[1:, 1] - units[:-1, 1] * units[1:, 0], np.sum(units[:-1] * units[1:], axis=1)
    )
    corner = np.concatenate([[True], np.abs(turns) > sharpest, [True]])
    segments: list[Segment] = []
    ends = np.flatnonzero(corner)
    for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        directions = _directions(points[a : b + 1], units[a:b])
        for n in range(a, b):
            segments.extend(biarc(points[n], directions[n - a], points[n + 1], directions[n - a + 1]))
    return Curve(tuple(Segment(s.start, s.end, name, s.centre) for s in segments if s.start != s.end))


def _directions(points: FloatArray, units: FloatArray) -> Sequence[FloatArray]:
    if len(units) == 1:
        return [units[0], units[0]]
    # Tangent and chord enclose the angle that the chord is seen under from a third point of the circle.
    chord, side = points[1:-1] - points[2:], points[:-2] - points[2:]
    angles = np.arctan2(chord[:, 0] * side[:, 1] - chord[:, 1] * side[:, 0], np.sum(chord * side, axis=1))
    inner = [_rotate(u, -t) for u, t in zip(units[:-1], angles, strict=True)]
    return [_mirror_direction(inner[0], units[0]), *inner, _mirror_direction(inner[-1], units[-1])]


def _rotate(u: FloatArray, angle: float) -> FloatArray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([cos * u[0] - sin * u[1], sin * u[0] + cos * u[1]])


def _mirror_direction(direction: FloatArray, chord: FloatArray) -> FloatArray:
    """Direction at the other end of the arc that has this direction at one end of its chord."""
    return 2 * float(direction @ chord) * chord - direction
