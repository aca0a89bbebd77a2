"""Drawn gaskets: of a section that is its own mirror image about the mid-plane, half is left."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from meshes.drawings.profile import Profile
from meshes.errors import GeometryError
from meshes.geometry.curve import Curve, Point, Segment, as_point


def profile_of(
    name: str, pieces: Sequence[Segment], file_unit: float | None = None, rounding: float = 0.0
) -> Profile:
    """A body as it is drawn; of a gasket the upper half, which is the "seat" of a contact.

    Parameters
    ----------
    name : str
        "closure", "seat" or "gasket".
    pieces, file_unit
        As of `Profile`.
    rounding : float
        How far two points that are one may lie apart in the drawing [m].

    Raises
    ------
    GeometryError
        If they are no such body.
    """
    if name == "gasket":
        return Profile("seat", tuple(upper_half(pieces, rounding)), file_unit, walled=False)
    return Profile(name, tuple(pieces), file_unit)


def upper_half(pieces: Sequence[Segment], rounding: float = 0.0) -> list[Segment]:
    """Of a section that is its own mirror image the part above the mid-plane, which closes it; any other as it is.

    Parameters
    ----------
    pieces : sequence of Segment
        Closed, in order; those of the half that is left keep their names.
    rounding : float
        How far a corner may lie from the image of another one [m].

    Raises
    ------
    GeometryError
        If the mid-plane cuts the section into more than one piece: the gasket is hollow or has legs.

    Examples
    --------
    >>> corners = [(0.01, -1e-3), (0.02, -1e-3), (0.02, 1e-3), (0.01, 1e-3)]
    >>> whole = [Segment(a, b, "") for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]
    >>> [s.name for s in upper_half(whole)]
    ['', '', '', 'bottom']
    """
    heights = [c[1] for s in pieces for c in s.corners]
    level, size = 0.5 * (min(heights) + max(heights)), max(heights) - min(heights)
    slack = max(rounding, 1e-6 * size)
    if not _is_mirrored(pieces, level, slack):
        return list(pieces)
    parts = [part for s in pieces for part in _cut_piece(s, level, slack)]
    is_upper = [0.5 * (s.start[1] + s.end[1]) > level + 1e-7 * size for s in parts]
    starts = [n for n, is_here in enumerate(is_upper) if is_here and not is_upper[n - 1]]
    if len(starts) != 1:
        raise GeometryError(
            f"gasket outline: its mid-plane cuts it into {len(starts)} pieces; a solid section has one"
        )
    half = [*parts[starts[0] :], *parts[: starts[0]]][: sum(is_upper)]
    return [*half, Segment(half[-1].end, half[0].start, "bottom")]


def _is_mirrored(pieces: Sequence[Segment], level: float, slack: float) -> bool:
    """Whether the image of every corner is a corner as well, and that of the middle of every arc one of an arc."""
    corners = [s.start for s in pieces]
    arcs = [Curve((s,)) for s in pieces if s.centre is not None]
    middles = [as_point(arc.point(np.array(0.5 * arc.length))) for arc in arcs]

    def has_image(point: Point, among: list[Point]) -> bool:
        image = point[0], 2 * level - point[1]
        return any(math.dist(image, point) <= slack for point in among)

    # a corner on the mid-plane is its own image, and so is the end of an arc that crosses it
    return all(has_image(p, corners) for p in corners) and all(has_image(p, middles) for p in middles)


def _cut_piece(s: Segment, level: float, slack: float) -> list[Segment]:
    """A piece in two where it crosses a height [m]."""
    (r, z), (end_r, end_z) = s.start, s.end
    if min(z, end_z) > level - slack or max(z, end_z) < level + slack:
        return [s]
    if s.centre is None:
        cut_r = r + (level - z) / (end_z - z) * (end_r - r)
    else:
        reach = math.sqrt(math.dist(s.start, s.centre) ** 2 - (level - s.centre[1]) ** 2)
        radii = (s.centre[0] - reach, s.centre[0] + reach)
        # an arc of less than half a turn lies on one side of its chord
        cut_r = min(radii, key=lambda radius: abs(radius - 0.5 * (r + end_r)))
    point = (cut_r, level)
    return [Segment(s.start, point, s.name, s.centre), Segment(point, s.end, s.name, s.centre)]
