"""First touch of two faces: which chains are the faces, and where the closure meets the seat."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import groupby, pairwise, product

import numpy as np

from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve
from meshes.geometry.outline import Outline
from meshes.geometry.segment import Segment

# So many straight lines in a row that turn the same way, by less than this at each corner [rad], are a curve that was
# written as lines.
_FACETS, _FACET_TURN = 4, math.radians(20)


@dataclass(frozen=True)
class Touch:
    """First touch.

    Parameters
    ----------
    radius : float
        r0 [m].
    drop : float
        Way of the closure along -z from where it was drawn to first touch [m].
    """

    radius: float
    drop: float


def first_touch(closure: Curve, seat: Curve, labels: tuple[str, str] = ("closure", "seat")) -> Touch:
    """Find the circle on which two faces touch first, in closed form for every pair of segments.

    Along a line or an arc that is run outwards the sine of the inclination is linear in r, so the places where two
    segments are parallel, and their distance along z stationary, solve a linear equation.

    Parameters
    ----------
    closure, seat : Curve
        Faces, run from smaller to larger radius.
    labels : tuple of str, optional
        What an error calls the two bodies.

    Returns
    -------
    Touch
        Faces that touch along a whole stretch (two cones of the same angle) touch first in its middle; of several
        circles that touch at once the innermost counts.

    Raises
    ------
    GeometryError
        If a face turns back towards the axis, or the faces do not lie above each other anywhere.

    Examples
    --------
    >>> import meshes
    >>> ball = meshes.Ball(0.02)
    >>> seat = meshes.ConicalSeat.around(0.785, ball)
    >>> touch = meshes.first_touch(ball.outline.face, seat.outline.face)
    >>> print(f"{touch.radius * 1e3:.2f} mm")
    14.14 mm
    """
    (above, below), upper, lower = labels, _graph(closure, labels[0]), _graph(seat, labels[1])
    places = [(r, c.height(r) - s.height(r)) for c in upper for s in lower for r in _candidates(c, s)]
    if not places:
        raise GeometryError(
            f"{above} and {below} do not meet: the {above}'s face reaches from r = {mm(upper[0].start)} to "
            f"{mm(upper[-1].end)}, the {below}'s from {mm(lower[0].start)} to {mm(lower[-1].end)}; change the radii, "
            "the angle or the bore so that they overlap"
        )
    drop = min(distance for _, distance in places)
    slack = 1e-13 * max(closure.length, seat.length)
    touching = sorted(r for r, distance in places if distance <= drop + slack)
    # Two circles that touch at once have a gap between them; a stretch has none.
    end = touching[0]
    for r in touching[1:]:
        if _distance(upper, lower, 0.5 * (end + r)) > drop + slack:
            break
        end = r
    return Touch(float(0.5 * (touching[0] + end)), float(drop))


def _distance(upper: list[_Graph], lower: list[_Graph], r: float) -> float:
    (c,) = [g for g in upper if g.start <= r <= g.end][:1]
    (s,) = [g for g in lower if g.start <= r <= g.end][:1]
    return c.height(r) - s.height(r)


@dataclass(frozen=True)
class _Graph:
    """A segment as function z(r)."""

    start: float
    end: float
    z: float
    angle: float
    curvature: float

    def sine(self, r: float) -> float:
        return math.sin(self.angle) + self.curvature * (r - self.start)

    def height(self, r: float) -> float:
        angle = math.asin(min(max(self.sine(r), -1.0), 1.0))
        # The chord from the start stands at the mean of both inclinations.
        return self.z + (r - self.start) * math.tan(0.5 * (angle + self.angle))


def _graph(face: Curve, name: str) -> list[_Graph]:
    points, tangents = face.point(face.breaks), face.tangent(face.breaks[:-1])
    pieces = zip(points.T[:-1], points.T[1:], tangents.T, face.curvatures(face.breaks[:-1]), strict=True)
    graphs = []
    for segment, ((start, z), (end, _), (along, up), curvature) in zip(face.segments, pieces, strict=True):
        angle = math.atan2(up, along)
        last = math.sin(angle) + curvature * (end - start)
        if not (end > start and abs(angle) <= math.pi / 2 * (1 + 1e-9) and abs(last) <= 1 + 1e-9):
            raise GeometryError(
                f"the face of the {name} turns back towards the axis between r = {mm(segment.start[0])} and "
                f"{mm(segment.end[0])}; a face must run outwards all the way"
            )
        graphs.append(_Graph(start, end, z, angle, curvature))
    return graphs


def _candidates(c: _Graph, s: _Graph) -> list[float]:
    low, high = max(c.start, s.start), min(c.end, s.end)
    if low > high:
        return []
    bend, slope = c.curvature - s.curvature, c.sine(low) - s.sine(low)
    if abs(bend) * (high - low) < 1e-12 and abs(slope) < 1e-12:
        return [0.5 * (low + high)]
    stationary = low - slope / bend if bend else math.nan
    inside = [stationary] if low < stationary < high else []
    return [*inside, low, high]


def at_a_corner(face: Curve, arc_length: float) -> bool:
    """Whether a face has a sharp corner at an arc length [m]."""
    near = np.abs(face.breaks[1:-1] - arc_length) < 1e-9 * face.length
    for s in face.breaks[1:-1][near]:
        step = 1e-12 * face.length
        before, after = face.tangent(s - step), face.tangent(s + step)
        if float(before @ after) < math.cos(1e-4):
            return True
    return False


def facets_at(face: Curve, radius: float) -> tuple[Segment, ...]:
    """The straight lines in place of a curve to which a face was reduced where it is touched; none where it was not.

    Parameters
    ----------
    face : Curve
    radius : float
        Where the bodies touch first [m].
    """
    turns = [
        0.0 if before.centre or after.centre else _turn(before, after)
        for before, after in pairwise(face.segments)
    ]
    bent = [math.copysign(1, t) if 1e-4 < abs(t) < _FACET_TURN else 0.0 for t in turns]
    start = 0
    for way, run in groupby(bent):
        end = start + len(list(run))
        pieces = face.segments[start : end + 1]
        if way and len(pieces) >= _FACETS and pieces[0].start[0] <= radius <= pieces[-1].end[0]:
            return pieces
        start = end
    return ()


def _turn(before: Segment, after: Segment) -> float:
    """Angle by which a line turns from the one before [rad]."""
    a, b = np.subtract(before.end, before.start), np.subtract(after.end, after.start)
    return math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))


def with_faces(closure: Outline, seat: Outline) -> tuple[Outline, Outline]:
    """Outlines whose faces are named, those that are not yet being found by the closest approach along the axis.

    Parameters
    ----------
    closure, seat : Outline
        A body that does not name its face has pieces without a name, one of which will touch.

    Raises
    ------
    GeometryError
        If there are several chains, and none of one body lies above one of the other.
    """
    chains = list(product(_faces_in(closure), _faces_in(seat)))
    if len(chains) == 1:
        # whether they meet is found by whoever asks for their first touch
        return chains[0]
    pairs = []
    for c, s in chains:
        try:
            pairs.append((first_touch(c.face, s.face, (c.label, s.label)).drop, c, s))
        except GeometryError as error:
            refusal = error
    if not pairs:
        raise refusal
    return min(pairs, key=lambda pair: pair[0])[1:]


def _faces_in(outline: Outline) -> list[Outline]:
    """The outline with each chain that could be its face named so; the outline itself if it names one."""
    if any(s.name == f"{outline.name}_face" for s in outline.segments):
        return [named_beside(outline)]
    way = -1 if outline.name == "closure" else 1
    could_be = [not s.name and looks(s) == way for s in outline.segments]
    chains = [list(run) for it, run in groupby(range(len(could_be)), could_be.__getitem__) if it]
    if not chains:
        side = "downwards" if outline.name == "closure" else "upwards"
        raise GeometryError(f"{outline.name} outline: no piece without another name looks {side}")
    face = f"{outline.name}_face"
    return [named_beside(_renamed(outline, dict.fromkeys(chain, face))) for chain in chains]


def looks(s: Segment) -> int:
    """Whether a piece of a counter-clockwise outline looks upwards, 1, downwards, -1, or to the side, 0."""
    inwards = s.start[0] - s.end[0]
    steep = abs(inwards) <= 1e-9 * (abs(s.end[1] - s.start[1]) + abs(inwards))
    return 0 if steep else 1 if inwards > 0 else -1


def named_beside(outline: Outline) -> Outline:
    """Pieces without a name called after the side of the face on which they lie."""
    if all(s.name for s in outline.segments):
        return outline
    at = [n for n, s in enumerate(outline.segments) if s.name == f"{outline.name}_face"]
    # The surface of the closure begins at the axis, that of the seat at the wall.
    before, after = ("inner", "outer") if outline.name == "closure" else ("outer", "inner")
    unnamed = [n for n, s in enumerate(outline.segments) if not s.name]
    return _renamed(outline, {n: f"{outline.name}_{before if n < at[0] else after}" for n in unnamed})


def _renamed(outline: Outline, names: Mapping[int, str]) -> Outline:
    """The outline with new names of some of its segments, by their numbers."""
    pieces = (replace(s, name=names.get(n, s.name)) for n, s in enumerate(outline.segments))
    return Outline(outline.name, tuple(pieces), label=outline.label)
