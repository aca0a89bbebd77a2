"""A closure or seat given by its outline: the boundaries are named, and the face is found, by what lies where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np

from meshes.errors import GeometryError, mm
from meshes.geometry.contact_geometry import looks
from meshes.geometry.curve import Curve, Point, Segment
from meshes.geometry.outline import Outline

# Names that a piece of a profile may be given, besides those found automatically.
PARTS = {
    "closure": ("face", "inner", "outer", "top", "axis", "cavity"),
    "seat": ("face", "chamber", "inner", "outer", "wall", "bottom"),
}

# A larger change of direction between two pieces [rad] is a corner and not a fillet of coarse facets.
CORNER = math.radians(40)

# Relative to the size of the outline: points closer than this are one.
_CLOSED_GAP = 1e-6


@dataclass(frozen=True)
class Profile:
    """Body with any outline of lines and arcs.

    Boundaries without a name get one from their place. Closure: "axis" at r = 0, "top" (where the closing force acts)
    the highest piece that looks upwards with all that continue it upwards-looking and without a corner, "cavity"
    between two pieces of the axis, "inner" and "outer" the surface from the axis to the top. Seat: "bottom" the lowest
    horizontal line, "wall" the pieces at the largest radius, "inner" from the bottom's inner end upwards, "outer" from
    the wall inwards. The face, where contact may happen, is the chain around first touch that runs outwards; it is
    found when both bodies are known, unless pieces are named "face".

    Parameters
    ----------
    name : str
        "closure" or "seat".
    pieces : tuple of Segment
        Closed, in either sense; names among `PARTS`, or empty. No arc may span 180 degrees or more.
    file_unit : float, optional
        Length of the unit of the drawing that it comes from [m], for what is told about it.
    walled : bool, optional
        Whether a seat ends in a straight wall, as a housing does and half a gasket does not.
    joined : float
        Widest gap between two ends of the drawing that was closed [m], for what is told about it.

    Raises
    ------
    GeometryError
        If the outline is open, crosses itself or the axis, or lacks a part that the body needs.

    Examples
    --------
    >>> import meshes
    >>> corners = [(0.0, 0.0), (0.01, 0.005), (0.01, 0.02), (0.0, 0.02)]
    >>> sides = zip(corners, [*corners[1:], corners[0]], ["face", "outer", "top", "axis"], strict=True)
    >>> plug = meshes.Profile("closure", tuple(meshes.Segment(start, end, name) for start, end, name in sides))
    >>> print(f"{plug.outline.area * 1e6:.0f} mm^2 of section")
    175 mm^2 of section
    """

    name: str
    pieces: tuple[Segment, ...]
    file_unit: float | None = None
    walled: bool = True
    joined: float = 0.0

    def __post_init__(self) -> None:
        self.outline  # noqa: B018  refuse what cannot be a body when it is made

    @cached_property
    def outline(self) -> Outline:
        """Section; pieces of the face and of the surface beside it may still wait for the face, see `with_faces`."""
        pieces = _close_pieces(self.name, [s for s in self.pieces if s.start != s.end])
        _check_crossings(self.name, pieces)
        pieces = [part for s in pieces for part in _upright_parts(s)]
        outline = Outline(self.name, tuple(pieces))
        if outline.area < 0:
            outline = Outline(self.name, tuple(s.reversed for s in reversed(pieces)))
        return _name_pieces(outline, has_wall=self.walled)


def _size(pieces: Sequence[Segment]) -> float:
    return max(max(abs(c) for c in s.start) for s in pieces)


def _close_pieces(name: str, pieces: list[Segment]) -> list[Segment]:
    """The pieces with ends that meet exactly."""
    if len(pieces) < 3:
        raise GeometryError(f"{name} outline: has {len(pieces)} pieces; a closed outline needs at least 3")
    size = max(math.dist(a, b) for a in (s.start for s in pieces) for b in (pieces[0].start,))
    loop = []
    for s, second in zip(pieces, [*pieces[1:], pieces[0]], strict=True):
        gap = math.dist(s.end, second.start)
        if gap > _CLOSED_GAP * size:
            raise GeometryError(
                f"{name} outline: is open, {mm(gap)} are missing between {_place(s.end)} and {_place(second.start)}"
            )
        loop.append(replace(s, end=second.start))
    # Points on the axis are exactly there, so that the mesh's are.
    on_axis = {p: (0.0, p[1]) for s in loop for p in (s.start,) if abs(p[0]) <= _CLOSED_GAP * size}
    parts = [replace(s, start=on_axis.get(s.start, s.start), end=on_axis.get(s.end, s.end)) for s in loop]
    for s in parts:
        lowest = min(s.start[0], s.end[0], *(p[0] for p in _upright_points(s)))
        if lowest < -_CLOSED_GAP * size:
            raise GeometryError(
                f"{name} outline: crosses the axis near {_place(s.start)}, down to r = {mm(lowest)}; draw the half "
                "at r >= 0 alone"
            )
    return parts


def _place(p: Point) -> str:
    return f"(r, z) = ({mm(p[0])}, {mm(p[1])})"


def _check_crossings(name: str, pieces: list[Segment]) -> None:
    """Refuse an outline that meets itself, seen on chords that follow arcs to a hundredth of their radius."""
    points, owner = [], []
    for n, s in enumerate(pieces):
        count = 1 + math.ceil(abs(s.sweep) / 0.2)
        curve = Curve((s,))
        points.extend(curve.point(np.linspace(0, curve.length, count + 1)[:-1]).T.tolist())
        owner.extend([n] * count)
    p = np.array(points)
    q = np.roll(p, -1, axis=0)
    count = len(p)

    def side(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (
            c[..., 0] - a[..., 0]
        )

    # One chord against all that follow, but its neighbours: all pairs at once would fill the memory.
    for i in range(count - 2):
        others = slice(i + 2, count - 1 if i == 0 else count)
        a, b, c, d = p[i], q[i], p[others], q[others]
        crosses = (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)
        if crosses.any():
            j = i + 2 + int(np.argmax(crosses))
            raise GeometryError(
                f"{name} outline: crosses itself near {_place((float(p[i, 0]), float(p[i, 1])))}, pieces "
                f"{owner[i] + 1} and {owner[j] + 1}"
            )


def _upright_points(s: Segment) -> list[Point]:
    """Places inside an arc where it runs parallel to the axis."""
    if s.centre is None:
        return []
    radius, curve = math.dist(s.start, s.centre), Curve((s,))
    places = []
    for side in (-1, 1):
        p = (s.centre[0] + side * radius, s.centre[1])
        foot = float(curve.project(np.array(p[0]), np.array(p[1])))
        is_inner = 1e-9 * curve.length < foot < (1 - 1e-9) * curve.length
        if is_inner and math.dist(curve.point(np.array(foot)), p) < 1e-9 * radius:
            places.append((foot, p))
    return [p for _, p in sorted(places)]


def _upright_parts(s: Segment) -> list[Segment]:
    """An arc cut where it turns back towards the axis, so that a face can begin or end there."""
    cuts = [s.start, *_upright_points(s), s.end]
    return [Segment(a, b, s.name, s.centre) for a, b in pairwise(cuts)]


def _name_pieces(outline: Outline, *, has_wall: bool) -> Outline:
    """Every piece with the full name of its boundary; "" where only the face will tell."""
    name = outline.name
    pieces = [replace(s, name=f"{name}_{s.name}" if s.name else "") for s in outline.segments]
    parts = _named_closure(pieces) if name == "closure" else _named_seat(pieces, has_wall=has_wall)
    return Outline(name, tuple(parts))


def _named_closure(pieces: list[Segment]) -> list[Segment]:
    pieces = [replace(s, name="closure_axis") if s.start[0] == s.end[0] == 0.0 else s for s in pieces]
    if not any(s.name == "closure_axis" for s in pieces):
        raise GeometryError(
            "closure outline: must have a straight piece on the axis, r = 0; a body with a hole cannot hold the "
            "pressure"
        )
    if not any(s.name == "closure_top" for s in pieces):
        top = _top(pieces)
        pieces = [replace(s, name="closure_top") if n in top else s for n, s in enumerate(pieces)]
    # Counter-clockwise from the lowest point of the axis: surface, axis, and perhaps a cavity and more of the axis.
    start = min(
        (n for n, s in enumerate(pieces) if s.name != "closure_axis" and s.start[0] == 0.0),
        key=lambda n: pieces[n].start[1],
    )
    pieces = [*pieces[start:], *pieces[:start]]
    surface = next(n for n, s in enumerate(pieces) if s.name == "closure_axis")
    return [
        *pieces[:surface],
        *(s if s.name else replace(s, name="closure_cavity") for s in pieces[surface:]),
    ]


def _top(pieces: list[Segment]) -> set[int]:
    """The highest piece that looks upwards and all that continue it, up to a corner or the widest place."""
    upwards = {n for n, s in enumerate(pieces) if not s.name and looks(s) > 0}
    if not upwards:
        raise GeometryError('closure outline: nothing looks upwards; name the piece that is pushed "top"')
    highest = max(upwards, key=lambda n: max(pieces[n].start[1], pieces[n].end[1]))
    top = {highest}
    for step in (1, -1):
        n, neighbour = highest, (highest + step) % len(pieces)
        while neighbour in upwards and _smooth(*(pieces[n], pieces[neighbour])[::step]):
            top.add(neighbour)
            n, neighbour = neighbour, (neighbour + step) % len(pieces)
    return top


def _smooth(s: Segment, t: Segment) -> bool:
    """Whether there is no corner where one piece ends and the next begins."""
    first = Curve((s,))
    a, b = first.tangent(np.array(first.length)), Curve((t,)).tangent(np.array(0.0))
    return float(a @ b) > math.cos(CORNER)


def _named_seat(pieces: list[Segment], *, has_wall: bool) -> list[Segment]:
    if any(min(s.start[0], s.end[0]) <= 0.0 for s in pieces):
        raise GeometryError("seat outline: touches the axis, r = 0; the fluid needs a bore")
    size = _size(pieces)
    lowest, widest = min(s.start[1] for s in pieces), max(s.start[0] for s in pieces)

    def level(s: Segment, axis: int, value: float) -> bool:
        return s.centre is None and all(abs(p[axis] - value) <= _CLOSED_GAP * size for p in (s.start, s.end))

    for part, axis, value in (("bottom", 1, lowest), ("wall", 0, widest))[: 2 if has_wall else 1]:
        if not any(s.name == f"seat_{part}" for s in pieces):
            pieces = [
                replace(s, name=f"seat_{part}") if not s.name and level(s, axis, value) else s for s in pieces
            ]
        if not any(s.name == f"seat_{part}" for s in pieces):
            where = (
                "a horizontal line at its lowest"
                if part == "bottom"
                else "a straight wall at its largest radius"
            )
            raise GeometryError(f'seat outline: has no {part}: give it {where}, or name a piece "{part}"')
    # Counter-clockwise from the bottom: wall, then the wetted surface down to the bottom again.
    start = next(
        n for n, s in enumerate(pieces) if s.name == "seat_bottom" and pieces[n - 1].name != "seat_bottom"
    )
    pieces = [*pieces[start:], *pieces[:start]]
    wall = max((n for n, s in enumerate(pieces) if s.name == "seat_wall"), default=0)
    return [*(s if s.name else replace(s, name="seat_wall") for s in pieces[:wall]), *pieces[wall:]]


def section_columns(reach: Sequence[float], axis: str, path: Path) -> list[int]:
    """Which coordinates of a section in space are r and z.

    Parameters
    ----------
    reach : sequence of float, length 3
        Largest absolute value of each coordinate.
    axis : {"x", "y", "z"}
        Coordinate along the axis of the seal.
    path : pathlib.Path
        File, for the message.

    Raises
    ------
    GeometryError
        If the section does not lie in a plane through the axis.
    """
    names = "xyz"
    z = names.index(axis)
    others = [n for n in range(3) if n != z]
    # The bounding boxes of OpenCASCADE are larger by its tolerance.
    flat_columns = [n for n in others if reach[n] >= 1e-4 * max(reach)]
    if len(flat_columns) != 1:
        raise GeometryError(
            f'{path.name}: axis = "{axis}": the section must lie in a plane through this axis, but it reaches '
            f"{', '.join(f'{reach[n]:.4g} along {names[n]}' for n in others)}"
        )
    return [*flat_columns, z]
