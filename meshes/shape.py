"""What every closure and every seat offers, and how a face becomes a body."""

from __future__ import annotations

from itertools import pairwise
from typing import Protocol

from meshes.curve import Curve
from meshes.errors import GeometryError
from meshes.outline import Outline, Point, Segment


class Shape(Protocol):
    """A body that can be meshed."""

    @property
    def outline(self) -> Outline:
        """Section whose contact face is named "closure_face" or "seat_face"; its height is free."""
        ...


def housing(face: Curve, outer_radius: float, height: float) -> Outline:
    """Seat: a face on a cylindrical housing with a bore below its inner end.

    Parameters
    ----------
    face : Curve
        From the bore outwards, segments named "seat_face".
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the inner end of the face to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If the face reaches beyond the housing or below its bottom.
    """
    start, end = face.segments[0].start, face.segments[-1].end
    if not outer_radius >= end[0] * (1 - 1e-12):
        raise GeometryError(
            f"seat outer_radius = {outer_radius:.6g} m: the face reaches to {end[0]:.6g} m, the housing must be wider"
        )
    if not height > 0:
        raise GeometryError(f"seat height = {height:.6g} m: must be positive")
    bottom = start[1] - height
    lowest = min(p[1] for s in face.segments for p in (s.start, s.end))
    if not bottom < lowest:
        raise GeometryError(
            f"seat height = {height:.6g} m: the face goes {start[1] - lowest:.6g} m deep, the housing must be higher"
        )
    around: list[tuple[Point, str]] = [
        (start, "seat_inner"),
        ((start[0], bottom), "seat_bottom"),
        ((outer_radius, bottom), "seat_wall"),
        ((outer_radius, end[1]), "seat_outer"),
        (end, ""),
    ]
    rest = tuple(Segment(a, b, name) for (a, name), (b, _) in pairwise(around) if _apart(a, b))
    return Outline("seat", (*face.reversed.segments, *rest))


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
    """
    start, end = face.segments[0].start, face.segments[-1].end
    top = end[1] + height
    highest = max(p[1] for s in face.segments for p in (s.start, s.end))
    if not top > max(highest, start[1]) + 1e-12 * end[0]:
        raise GeometryError(
            f"closure height: the top would lie {top - highest:.6g} m above the highest point of the face; the closure "
            "must be higher"
        )
    around: list[tuple[Point, str]] = [
        (end, "closure_outer"),
        ((end[0], top), "closure_top"),
        ((0.0, top), "closure_axis"),
        ((0.0, start[1]), "closure_inner"),
        (start, ""),
    ]
    rest = tuple(Segment(a, b, name) for (a, name), (b, _) in pairwise(around) if _apart(a, b))
    return Outline("closure", (*face.segments, *rest))


def _apart(a: Point, b: Point) -> bool:
    return abs(a[0] - b[0]) + abs(a[1] - b[1]) > 1e-12 * (abs(a[0]) + abs(a[1]) + abs(b[0]) + abs(b[1]))
