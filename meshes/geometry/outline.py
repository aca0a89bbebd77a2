"""Chains of lines and arcs with rounded corners, and closed outlines of bodies in the (r, z) half-plane."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from meshes.arrays import FloatArray
from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve, Point, Segment, as_point

if TYPE_CHECKING:
    from skfem import MeshTri

    from meshes.arrays import BoolArray


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
    segments = [curve.segments[0]]
    for n, segment in enumerate(curve.segments[1:], start=1):
        corner_radius = radius(n) if callable(radius) else radius
        if corner_radius > 0:
            segments[-1:] = _round_corner(segments[-1], segment, corner_radius)
        else:
            segments.append(segment)
    return Curve(tuple(segments))


def _round_corner(first: Segment, second: Segment, radius: float) -> list[Segment]:
    pieces = _with_arc(first, second, radius)
    if pieces is None:
        r, z = first.end
        low, high = 0.0, radius
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if _with_arc(first, second, middle) else (low, middle)
        raise GeometryError(
            f"an edge radius of {mm(radius)} does not fit at the corner r = {mm(r)}, z = {mm(z)}: allowed is up "
            f"to {mm(low)} between the faces beside it; make the edge sharper or the faces wider"
        )
    return pieces


def _with_arc(a: Segment, b: Segment, radius: float) -> list[Segment] | None:
    """What is left of both segments, with the arc between them; None if it does not fit."""
    first, second = Curve((a,)), Curve((b,))
    u, v = first.tangent(np.array(first.length)), second.tangent(np.array(0.0))
    turn = math.atan2(u[0] * v[1] - u[1] * v[0], float(u @ v))
    if abs(turn) < _SMOOTH:
        return [a, b]
    offset = math.copysign(radius, turn)
    centres = _crossings(a, b, offset)
    if not centres:
        return None
    centre = min(centres, key=lambda c: math.dist(c, a.end))
    feet, places = [], []
    for curve in (first, second):
        foot = _foot(curve.segments[0], centre)
        s = float(curve.project(np.array(foot[0]), np.array(foot[1])))
        if math.dist(foot, curve.point(np.array(s))) > 1e-9 * max(radius, curve.length):
            return None
        feet.append(foot)
        places.append(s)
    arc = Segment(feet[0], feet[1], a.name, centre)
    head = first.part(0.0, places[0], a.name)
    tail = second.part(places[1], second.length, b.name)
    # The very same points, so that the chain stays closed to the last digit.
    head_pieces = [Segment(s.start, feet[0], s.name, s.centre) for s in head]
    tail_pieces = [Segment(feet[1], s.end, s.name, s.centre) for s in tail]
    return [*head_pieces, arc, *tail_pieces]


def _crossings(a: Segment, b: Segment, offset: float) -> list[Point]:
    """Points at a distance `offset` to the left of both segments, each taken as a whole line or circle."""
    if a.centre is not None and b.centre is None:
        a, b = b, a
    if b.centre is None:
        (p, t), (q, u) = _offset_line(a, offset), _offset_line(b, offset)
        cross = t[0] * u[1] - t[1] * u[0]
        foot = ((q - p)[0] * u[1] - (q - p)[1] * u[0]) / cross
        return [as_point(p + foot * t)]
    circle, size = np.array(b.centre), _offset_radius(b, offset)
    if size <= 0:
        return []
    if a.centre is None:
        p, t = _offset_line(a, offset)
        middle = p + ((circle - p) @ t) * t
        half = size**2 - float((middle - circle) @ (middle - circle))
        return [] if half < 0 else [as_point(middle + s * math.sqrt(half) * t) for s in (-1, 1)]
    other, other_size = np.array(a.centre), _offset_radius(a, offset)
    separation = float(np.hypot(*(circle - other)))
    if other_size <= 0 or separation == 0:
        return []
    axis = (circle - other) / separation
    foot = (separation**2 + other_size**2 - size**2) / (2 * separation)
    half = other_size**2 - foot**2
    normal = np.array([-axis[1], axis[0]])
    return [] if half < 0 else [as_point(other + foot * axis + s * math.sqrt(half) * normal) for s in (-1, 1)]


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


@dataclass(frozen=True)
class Outline:
    """Closed outline of one body, counter-clockwise, each segment starting where the one before ends.

    Parameters
    ----------
    name : str
        Name of the body ("closure", "seat"), with which the names of its segments begin.
    segments : tuple of Segment
    label : str, optional
        What errors and sentences call the body, such as "lower flange"; its name unless given.

    Examples
    --------
    >>> import meshes
    >>> outline = meshes.Ball(0.02).outline
    >>> print(f"{outline.area * 1e6:.1f} mm^2")
    628.3 mm^2
    """

    name: str
    segments: tuple[Segment, ...]
    label: str = field(default="", kw_only=True, compare=False)

    def __post_init__(self) -> None:
        if not self.label:
            # set during construction, before the outline is shared
            object.__setattr__(self, "label", self.name)

    @property
    def ready_mesh(self) -> MeshTri | None:
        """The mesh of a body that comes as one [m]; None for a drawn outline."""
        return None

    def halve_triangles(self) -> Outline:
        """The outline as it is; one that comes as a mesh has every triangle cut into four."""
        return self

    @property
    def area(self) -> float:
        """Exact area of the section in the (r, z) half-plane [m^2], arcs included (Green's theorem)."""
        return sum(_chord_area(s) + _bulge_area(s) for s in self.segments)

    @property
    def face(self) -> Curve:
        """The surface on which contact can happen, run from smaller to larger radius.

        It is made of the segments named "<body>_face", and "<body>_chamber" between them.

        Raises
        ------
        GeometryError
            If there is no such segment, or they are not one chain.
        """
        at = self._of_face
        if not at:
            raise GeometryError(f'{self.name} outline: no piece has the name "face"')
        others = [self.segments[n] for n in range(at[0], at[-1]) if n not in at]
        if others:
            ends = [
                f"({mm(s.start[0])}, {mm(s.start[1])}) to ({mm(s.end[0])}, {mm(s.end[1])})" for s in others
            ]
            more = f" and {len(ends) - 2} more" if len(ends) > 2 else ""
            raise GeometryError(
                f"{self.name} outline: {', '.join(ends[:2])}{more} in (r, z) lie between pieces of the face and are no "
                'part of it; give them the name "face", as the flanks of a land, or "chamber", as what is between lands'
            )
        face = Curve(self.segments[at[0] : at[-1] + 1])
        # Counter-clockwise, the lower side of the closure runs outwards and the upper side of the seat inwards.
        return face if face.segments[0].start[0] < face.segments[-1].end[0] else face.reversed

    @property
    def _of_face(self) -> list[int]:
        names = (f"{self.name}_face", f"{self.name}_chamber")
        return [n for n, s in enumerate(self.segments) if s.name in names]

    def with_face(self, pieces: tuple[Segment, ...]) -> Outline:
        """The outline with its face replaced by `pieces`, which run from smaller to larger radius."""
        at = self._of_face
        head, tail = self.segments[: at[0]], self.segments[at[-1] + 1 :]
        outwards = self.segments[at[0]].start[0] < self.segments[at[-1]].end[0]
        if not outwards:
            pieces = tuple(s.reversed for s in reversed(pieces))
        # The very corners of the outline: a rounded-off copy of them would leave it open.
        first = replace(pieces[0], start=self.segments[at[0]].start)
        last = replace(pieces[-1], end=self.segments[at[-1]].end)
        inner = (first, *pieces[1:-1], last) if len(pieces) > 1 else (replace(first, end=last.end),)
        return Outline(self.name, (*head, *inner, *tail), label=self.label)

    def shift(self, dz: float) -> Outline:
        """The outline moved by dz [m] along the axis."""
        return replace(self, segments=tuple(s.shift(dz) for s in self.segments))

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Smallest and largest r and z [m], arcs included."""
        r, z = zip(*(p for s in self.segments for p in s.corners), strict=True)
        return (min(r), max(r)), (min(z), max(z))

    def holds(self, points: FloatArray) -> BoolArray:
        """Which of some points (r, z) [m], shape (2, n), lie inside, arcs being followed by chords."""
        curves = [Curve((s,)) for s in self.segments]
        corners = np.hstack([curve.point(np.linspace(0.0, curve.length, 33)[:-1]) for curve in curves])
        (r, z), (next_r, next_z) = corners[..., None], np.roll(corners, -1, axis=1)[..., None]
        # a ray outwards leaves more often than it enters
        with np.errstate(divide="ignore", invalid="ignore"):
            passes = points[0] < r + (points[1] - z) / (next_z - z) * (next_r - r)
        return np.asarray(np.sum(((z > points[1]) != (next_z > points[1])) & passes, axis=0) % 2 == 1)

    @property
    def largest_radius(self) -> float:
        """Largest distance of the segments' end points from the axis [m]."""
        return max(s.start[0] for s in self.segments)


def _chord_area(s: Segment) -> float:
    (r0, z0), (r1, z1) = s.start, s.end
    return 0.5 * (r0 * z1 - r1 * z0)


def _bulge_area(s: Segment) -> float:
    if s.centre is None:
        return 0.0
    return 0.5 * math.dist(s.start, s.centre) ** 2 * (s.sweep - math.sin(s.sweep))
