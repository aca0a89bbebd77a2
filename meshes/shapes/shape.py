"""What every closure and every seat offers, how a face becomes a body, and what is left open in proportion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

from meshes.errors import GeometryError, mm
from meshes.geometry.contact_geometry import Touch, first_touch, with_faces
from meshes.geometry.curve import Curve, Point, Segment
from meshes.geometry.outline import Outline, chain


def check_length(body: str, key: str, value: float, right: bool, must: str, *others: float) -> None:
    """Refuse a dimension [m] that is not right, and say what it must be.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    key : str
    value : float
        [m]
    right : bool
    must : str
        With {} in place of each other length.
    *others : float
        [m]

    Raises
    ------
    GeometryError
    """
    if not right:
        raise GeometryError(f"{body} {key} = {mm(value)}: {must.format(*map(mm, others))}")


def check_positive(body: str, **lengths: float) -> None:
    """Refuse dimensions that are not positive and finite.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    **lengths : float
        By key [m].

    Raises
    ------
    GeometryError
    """
    for key, value in lengths.items():
        check_length(body, key, value, math.isfinite(value) and value > 0, "must be positive and finite")


def check_not_negative(body: str, key: str, value: float) -> None:
    """Refuse a dimension [m] that is negative or not finite; zero is sharp or flush.

    Raises
    ------
    GeometryError
    """
    check_length(body, key, value, math.isfinite(value) and value >= 0, "must not be negative")


def check_exceeds(body: str, key: str, value: float, limit: float, name: str) -> None:
    """Refuse a dimension [m] that is not finite or not larger than another one.

    Parameters
    ----------
    body : str
        "closure" or "seat".
    key : str
    value, limit : float
        [m]
    name : str
        The other one in words, in front of its value: "bore_radius =".

    Raises
    ------
    GeometryError
    """
    check_length(body, key, value, math.isfinite(value) and value > limit, f"must exceed {name} {{}}", limit)


def check_angle(body: str, key: str, angle: float, low: float = 0.0, high: float = math.pi / 2) -> None:
    """Refuse an angle [rad] outside the open interval (low, high).

    Raises
    ------
    GeometryError
    """
    if not low < angle < high:
        raise GeometryError(
            f"{body} {key} = {math.degrees(angle):.6g} deg: must lie between {math.degrees(low):.6g} and "
            f"{math.degrees(high):.6g} deg"
        )


class Shape(Protocol):
    """A body that can be meshed.

    Examples
    --------
    >>> import meshes
    >>> isinstance(meshes.Ball(0.02).outline, meshes.Outline)
    True
    """

    @property
    def outline(self) -> Outline:
        """Section whose contact face is named "closure_face" or "seat_face"; its height is free."""


@dataclass(frozen=True)
class NamedFace:
    """The part of a face that a shape is named after, on which its contact is meant to lie.

    Parameters
    ----------
    name : str
        "conical face", "land", "rounded edge" ...
    inner, outer : float
        Radii between which it lies [m].

    Examples
    --------
    >>> NamedFace("land", 0.025, 0.028).holds(0.026)
    True
    """

    name: str
    inner: float
    outer: float

    def holds(self, radius: float) -> bool:
        """Whether a circle of first touch of this radius [m] lies on it."""
        slack = 1e-9 * self.outer
        return self.inner - slack <= radius <= self.outer + slack


def named_face(shape: Shape) -> NamedFace | None:
    """The named face of a shape; None of one that has no other face, such as a ball, or no name, such as a drawing.

    Examples
    --------
    >>> import meshes
    >>> disc = meshes.Disc.of(0.02, edge_radius=1e-3)
    >>> face = named_face(disc)
    >>> face.name, round(face.outer, 6)
    ('flat face', 0.019)
    """
    face: NamedFace | None = getattr(shape, "named_face", None)
    return face


def straight_part(name: str, outline: Outline, angle: float) -> NamedFace:
    """The straight part of a face that is inclined by `angle` [rad] to the horizontal plane."""
    return _part(name, [s for s in outline.face.segments if s.centre is None and _incline(s, angle)])


def round_part(name: str, outline: Outline, radius: float) -> NamedFace:
    """The arcs of a face that have a radius [m]."""
    arcs = [s for s in outline.face.segments if s.centre is not None]
    return _part(name, [s for s in arcs if math.isclose(math.dist(s.start, s.centre or s.start), radius)])


def _incline(segment: Segment, angle: float) -> bool:
    (r, z), (end_r, end_z) = segment.start, segment.end
    return abs(math.atan2(end_z - z, end_r - r) - angle) < 1e-9


def _part(name: str, segments: list[Segment]) -> NamedFace:
    radii = [end[0] for s in segments for end in (s.start, s.end)]
    return NamedFace(name, min(radii, default=0.0), max(radii, default=0.0))


def housing(face: Curve, outer_radius: float, height: float, step: float = 0.0) -> Outline:
    """Seat: a face on a cylindrical housing with a bore below its inner end.

    Parameters
    ----------
    face : Curve
        From the bore outwards, segments named "seat_face".
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the inner end of the face to the bottom of the housing [m].
    step : float
        How far the top of the housing lies below the outer end of the face [m]: the face is raised by so much.

    Raises
    ------
    GeometryError
        If the face reaches beyond the housing or below its bottom.

    Examples
    --------
    >>> import meshes
    >>> face = meshes.chain([(0.01, 0.0), (0.02, 0.01)], "seat_face")
    >>> meshes.housing(face, outer_radius=0.03, height=0.02).name
    'seat'
    """
    start, end = face.segments[0].start, face.segments[-1].end
    fits, must = outer_radius >= end[0] * (1 - 1e-12), "the face reaches to {}, the housing must be wider"
    check_length("seat", "outer_radius", outer_radius, fits, must, end[0])
    check_length("seat", "height", height, height > 0, "must be positive")
    bottom = start[1] - height
    top = end[1] - step
    lowest = min(top, *(p[1] for s in face.segments for p in (s.start, s.end)))
    must = "the face goes {} deep, the housing must be higher"
    check_length("seat", "height", height, bottom < lowest, must, start[1] - lowest)
    corners: list[tuple[Point, str]] = [
        (start, "seat_inner"),
        ((start[0], bottom), "seat_bottom"),
        ((outer_radius, bottom), "seat_wall"),
        ((outer_radius, top), "seat_outer"),
        ((end[0], top), "seat_outer"),
        (end, ""),
    ]
    sides = tuple(Segment(a, b, name) for (a, name), (b, _) in pairwise(corners) if _are_distinct(a, b))
    return Outline("seat", (*face.reversed.segments, *sides))


def plunger(face: Curve, height: float) -> Outline:
    """Closure: a face at the lower end of a round bar, flat inside the face.

    Parameters
    ----------
    face : Curve
        From its inner end outwards, segments named "closure_face".
    height : float
        From the outer end of the face to the top of the bar [m].

    Raises
    ------
    GeometryError
        If the bar would have no height.

    Examples
    --------
    >>> import meshes
    >>> face = meshes.chain([(0.0, 0.0), (0.01, 0.0), (0.015, 0.005)], "closure_face")
    >>> meshes.plunger(face, height=0.02).name
    'closure'
    """
    start, end = face.segments[0].start, face.segments[-1].end
    top = end[1] + height
    highest = max(p[1] for s in face.segments for p in (s.start, s.end))
    if not top > max(highest, start[1]) + 1e-12 * end[0]:
        raise GeometryError(
            f"closure height: the top would lie {mm(top - highest)} above the highest point of the face; the closure "
            "must be higher"
        )
    corners: list[tuple[Point, str]] = [
        (end, "closure_outer"),
        ((end[0], top), "closure_top"),
        ((0.0, top), "closure_axis"),
        ((0.0, start[1]), "closure_inner"),
        (start, ""),
    ]
    sides = tuple(Segment(a, b, name) for (a, name), (b, _) in pairwise(corners) if _are_distinct(a, b))
    return Outline("closure", (*face.segments, *sides))


def _are_distinct(a: Point, b: Point) -> bool:
    return abs(a[0] - b[0]) + abs(a[1] - b[1]) > 1e-12 * (abs(a[0]) + abs(a[1]) + abs(b[0]) + abs(b[1]))


@dataclass(frozen=True)
class Partner:
    """What a seat needs to know about its closure to find the dimensions that are left open.

    Parameters
    ----------
    outline : Outline
        Of the closure.
    """

    outline: Outline

    @property
    def size(self) -> float:
        """Radius L of the closure [m], of a ball its own."""
        return self.outline.largest_radius

    def touch_on(self, face: Curve) -> float:
        """Radius of first touch on a seat's face [m]."""
        return self._meeting_point(face)[1].radius

    def drop_on(self, face: Curve) -> float:
        """Way of the closure along -z from where it is drawn to first touch on a seat's face [m]."""
        return self._meeting_point(face)[1].drop

    def touch_on_cone(self, angle: float) -> float:
        """Radius of first touch [m] on a cone without ends, inclined by `angle` [rad] to the horizontal plane."""
        end = 2 * self.size
        return self.touch_on(chain([(0.0, 0.0), (end, end * math.tan(angle))], "seat_face"))

    def curvature_on(self, face: Curve) -> float:
        """Curvature of the closure where it first touches a seat's face [1/m], positive where it bulges."""
        closure, touch = self._meeting_point(face)
        return closure.curvature(closure.project_radius(touch.radius))

    def _meeting_point(self, face: Curve) -> tuple[Curve, Touch]:
        closure, seat = with_faces(self.outline, Outline("seat", face.reversed.segments))
        return closure.face, first_touch(closure.face, seat.face)

    def housing(
        self, touch: float, face_end: float, outer_radius: float | None, height: float | None
    ) -> tuple[float, float]:
        """Radius and height of the housing [m], as given, or 1.5 L wider than first touch and 1.5 L.

        That is far enough to change a narrow contact's pressure by some 1e-5.
        """
        widest = max(touch + 1.5 * self.size, face_end) if outer_radius is None else outer_radius
        return widest, 1.5 * self.size if height is None else height
