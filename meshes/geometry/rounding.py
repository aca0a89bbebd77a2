"""Corners between lines and arcs, rounded by arcs that touch both."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from itertools import pairwise

import numpy as np

from meshes.arrays import FloatArray
from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve
from meshes.geometry.segment import Point, Segment, as_point

# A smaller change of direction [rad] is no corner.
_SMOOTH = 1e-9


def chain(points: Iterable[Point], name: str, rounding: Callable[[int], float] | float = 0.0) -> Curve:
    """Straight lines through points, their corners rounded.

    Parameters
    ----------
    points : iterable of (r, z)
        Corners [m], at least two.
    name : str
        Name of all segments.
    rounding : float or callable
        Radius [m] of the arc at every inner corner, or a function that gives it for corner number 1, 2, ...

    Raises
    ------
    GeometryError
        If an arc does not fit between the neighbouring corners.

    Examples
    --------
    >>> import meshes
    >>> step = meshes.chain([(0.0, 0.0), (0.01, 0.0), (0.01, 0.01)], "seat_face", 1e-3)
    >>> len(step.segments)
    3
    """
    return rounded(Curve(tuple(Segment(a, b, name) for a, b in pairwise(points))), rounding)


def rounded(curve: Curve, radius: Callable[[int], float] | float) -> Curve:
    """Replace the corners of a curve by arcs.

    Parameters
    ----------
    curve : Curve
    radius : float or callable
        Radius [m] of the arc at every corner, or a function that gives it for corner number 1, 2, ... counted along
        all inner breaks of the curve; zero leaves a corner sharp.

    Raises
    ------
    GeometryError
        If an arc does not fit; it says which radius would.

    Examples
    --------
    >>> import meshes
    >>> step = meshes.chain([(0.0, 0.0), (0.01, 0.0), (0.01, 0.01)], "seat_face")
    >>> len(meshes.rounded(step, 1e-3).segments)
    3
    """
    done = [curve.segments[0]]
    for n, after in enumerate(curve.segments[1:], start=1):
        wanted = radius(n) if callable(radius) else radius
        if wanted > 0:
            done[-1:] = _round_corner(done[-1], after, wanted)
        else:
            done.append(after)
    return Curve(tuple(done))


def _round_corner(before: Segment, after: Segment, radius: float) -> list[Segment]:
    pieces = _with_arc(before, after, radius)
    if pieces is None:
        r, z = before.end
        low, high = 0.0, radius
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if _with_arc(before, after, middle) else (low, middle)
        raise GeometryError(
            f"an edge radius of {mm(radius)} does not fit at the corner r = {mm(r)}, z = {mm(z)}: allowed is up "
            f"to {mm(low)} between the faces beside it; make the edge sharper or the faces wider"
        )
    return pieces


def _with_arc(before: Segment, after: Segment, radius: float) -> list[Segment] | None:
    """What is left of both segments, with the arc between them; None if it does not fit."""
    first, second = Curve((before,)), Curve((after,))
    leaving, entering = first.tangent(np.array(first.length)), second.tangent(np.array(0.0))
    turn = math.atan2(leaving[0] * entering[1] - leaving[1] * entering[0], float(leaving @ entering))
    if abs(turn) < _SMOOTH:
        return [before, after]
    offset = math.copysign(radius, turn)
    centres = _crossings(before, after, offset)
    if not centres:
        return None
    centre = min(centres, key=lambda c: math.dist(c, before.end))
    feet, places = [], []
    for curve in (first, second):
        foot = _foot(curve.segments[0], centre)
        s = float(curve.project(np.array(foot[0]), np.array(foot[1])))
        if math.dist(foot, curve.point(np.array(s))) > 1e-9 * max(radius, curve.length):
            return None
        feet.append(foot)
        places.append(s)
    arc = Segment(feet[0], feet[1], before.name, centre)
    head = first.part(0.0, places[0], before.name)
    tail = second.part(places[1], second.length, after.name)
    # The very same points, so that the chain stays closed to the last digit.
    kept = [Segment(s.start, feet[0], s.name, s.centre) for s in head]
    rest = [Segment(feet[1], s.end, s.name, s.centre) for s in tail]
    return [*kept, arc, *rest]


def _crossings(a: Segment, b: Segment, offset: float) -> list[Point]:
    """Points at a distance `offset` to the left of both segments, each taken as a whole line or circle."""
    if a.centre is not None and b.centre is None:
        a, b = b, a
    if b.centre is None:
        (p, t), (q, u) = _offset_line(a, offset), _offset_line(b, offset)
        cross = t[0] * u[1] - t[1] * u[0]
        along = ((q - p)[0] * u[1] - (q - p)[1] * u[0]) / cross
        return [as_point(p + along * t)]
    circle, size = np.array(b.centre), _offset_radius(b, offset)
    if size <= 0:
        return []
    if a.centre is None:
        p, t = _offset_line(a, offset)
        middle = p + ((circle - p) @ t) * t
        half = size**2 - float((middle - circle) @ (middle - circle))
        return [] if half < 0 else [as_point(middle + s * math.sqrt(half) * t) for s in (-1, 1)]
    other, other_size = np.array(a.centre), _offset_radius(a, offset)
    apart = float(np.hypot(*(circle - other)))
    if other_size <= 0 or apart == 0:
        return []
    axis = (circle - other) / apart
    along = (apart**2 + other_size**2 - size**2) / (2 * apart)
    half = other_size**2 - along**2
    across = np.array([-axis[1], axis[0]])
    return (
        [] if half < 0 else [as_point(other + along * axis + s * math.sqrt(half) * across) for s in (-1, 1)]
    )


def _offset_line(s: Segment, offset: float) -> tuple[FloatArray, FloatArray]:
    tangent = np.subtract(s.end, s.start) / math.dist(s.start, s.end)
    return np.array(s.start) + offset * np.array([-tangent[1], tangent[0]]), tangent


def _offset_radius(s: Segment, offset: float) -> float:
    assert s.centre is not None
    return math.dist(s.start, s.centre) - math.copysign(1.0, s.sweep) * offset


def _foot(s: Segment, p: Point) -> Point:
    """Nearest point of the whole line or circle."""
    if s.centre is None:
        tangent = np.subtract(s.end, s.start) / math.dist(s.start, s.end)
        return as_point(np.array(s.start) + float(np.subtract(p, s.start) @ tangent) * tangent)
    arm = np.subtract(p, s.centre)
    return as_point(np.array(s.centre) + math.dist(s.start, s.centre) / math.hypot(*arm) * arm)
