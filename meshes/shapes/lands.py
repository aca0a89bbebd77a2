"""Several lands one behind the other on one seat, with chambers between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve, Point, Segment
from meshes.geometry.outline import Outline, rounded
from meshes.shapes.conical_land import ConicalLand
from meshes.shapes.flat_land import FlatLand
from meshes.shapes.shape import (
    Partner,
    Shape,
    check_exceeds,
    check_length,
    check_not_negative,
    check_positive,
    housing,
)

# Depth of a chamber in units of the distance of its lands, unless given.
_DEPTH = 0.25
# Inclination of its walls to the line from land to land, and at most to the horizontal plane [rad].
_WALL, _STEEPEST = math.radians(45.0), math.radians(80.0)
# Radial distance of lands that leaves room for the roundings and the chamber.
_ROOM = 2.5


@dataclass(frozen=True)
class Land:
    """One of several lands.

    Parameters
    ----------
    shape : ConicalLand or FlatLand
        Its housing counts for nothing here.
    set_back : float
        How far the closure still has to move along the axis when it touches the foremost land [m].

    Examples
    --------
    >>> import meshes
    >>> ring = meshes.FlatLand.on(0.020, 0.0215, meshes.Disc.of(0.03))
    >>> meshes.Land(ring, set_back=2e-6).ends[1]
    (0.0215, 0.0)
    """

    shape: ConicalLand | FlatLand
    set_back: float = 0.0

    def __post_init__(self) -> None:
        check_not_negative("seat", "set_back", self.set_back)

    @property
    def ends(self) -> tuple[Point, Point]:
        """Edges before rounding, at a height of its own [m]."""
        shape = self.shape
        if isinstance(shape, FlatLand):
            return (shape.land_inner_radius, 0.0), (shape.land_outer_radius, 0.0)
        return (shape.bore_radius, 0.0), (shape.land_end, shape.land_width * math.sin(shape.angle))


@dataclass(frozen=True)
class Lands:
    """Lands one behind the other on a cylindrical housing, from the bore outwards.

    They are made to touch the closure at the same time, as lands are that are machined together with it, unless one is
    set back. Between two of them is a chamber with walls inclined by 45 deg to the line from land to land.

    Parameters
    ----------
    lands : tuple of Land
        From the bore outwards, two at least.
    closure : Shape
        Which touches them.
    chamber_depth : float
        Below the line from land to land [m].
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the inner edge of the first land to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If lands overlap, or one cannot touch the closure.

    Examples
    --------
    >>> import meshes
    >>> disc = meshes.Disc.of(0.03)
    >>> inner, outer = meshes.FlatLand.on(0.020, 0.0215, disc), meshes.FlatLand.on(0.023, 0.0242, disc)
    >>> seat = meshes.Lands.around([meshes.Land(inner), meshes.Land(outer)], disc)
    >>> len(meshes.ContactGeometry.of(disc.outline, seat.outline).chambers)
    1
    """

    lands: tuple[Land, ...]
    closure: Shape
    chamber_depth: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        check_positive("seat", chamber_depth=self.chamber_depth, height=self.height)
        check_exceeds(
            "seat", "outer_radius", self.outer_radius, self.land_end, "the outer edge of the lands,"
        )

    @classmethod
    def around(
        cls,
        lands: Sequence[Land],
        closure: Shape,
        *,
        chamber_depth: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> Lands:
        """Lands for a closure, with the dimensions that are not given in proportion.

        Parameters
        ----------
        lands : sequence of Land
        closure : Shape
        chamber_depth : float, optional
            A quarter of the distance of the two lands that lie closest unless given [m].
        outer_radius, height : float, optional
            Outer edge of the lands + 1.5 L and 1.5 L unless given [m], with L the radius of the closure.
        """
        if len(lands) < 2:
            raise GeometryError(
                f"seat lands: {len(lands)} given; at least 2 are needed, one alone is a seat of its own shape"
            )
        in_order = tuple(sorted(lands, key=lambda land: land.ends[0][0]))
        distances = [outer.ends[0][0] - inner.ends[1][0] for inner, outer in pairwise(in_order)]
        for (inner, outer), distance in zip(pairwise(in_order), distances, strict=True):
            room = _ROOM * max(inner.shape.edge_radius, outer.shape.edge_radius)
            if not distance > room:
                raise GeometryError(
                    f"seat lands: one ends at r = {mm(inner.ends[1][0])}, the next begins at {mm(outer.ends[0][0])}; "
                    f"the roundings need {mm(room)} between them: change a land_width or a radius"
                )
        partner, end = Partner(closure.outline), in_order[-1].ends[1][0]
        depth = _DEPTH * min(distances) if chamber_depth is None else chamber_depth
        return cls(in_order, closure, depth, *partner.housing(end, 1.1 * end, outer_radius, height))

    @property
    def bore_radius(self) -> float:
        """Radius of the bore, where the first land begins [m]."""
        return self.lands[0].ends[0][0]

    @property
    def land_end(self) -> float:
        """Radius of the outer edge of the last land before rounding [m]."""
        return self.lands[-1].ends[1][0]

    @property
    def edges(self) -> tuple[tuple[Point, Point], ...]:
        """Edges of every land before rounding, where the closure touches them [m]; the first land begins at z = 0."""
        partner = Partner(self.closure.outline)
        levels = []
        for land in self.lands:
            try:
                drop = partner.drop_on(Curve((Segment(*land.ends, "seat_face"),)))
            except GeometryError as error:
                raise GeometryError(
                    f"seat lands: the closure cannot touch the land from r = {mm(land.ends[0][0])} to "
                    f"{mm(land.ends[1][0])} together with the others: {error}"
                ) from error
            levels.append(drop - land.set_back)
        return tuple(
            ((start[0], start[1] + level - levels[0]), (end[0], end[1] + level - levels[0]))
            for (start, end), level in zip((land.ends for land in self.lands), levels, strict=True)
        )

    @property
    def outline(self) -> Outline:
        """Section with the lower edge of the first land before rounding at z = 0."""
        edges, last = self.edges, self.lands[-1].shape
        (r, z), (end_r, end_z) = edges[0][0], edges[-1][1]
        pieces = [((r, z - self.outer_radius), "")]
        radii = [0.0]
        for number, ((start, end), land) in enumerate(zip(edges, self.lands, strict=True)):
            if number:
                pieces += [(corner, "seat_chamber") for corner in self._groove(edges[number - 1][1], start)]
                radii += [0.0, 0.0]
            pieces += [(start, "seat_chamber" if number else "seat_face"), (end, "seat_face")]
            radii += [land.shape.edge_radius, land.shape.edge_radius]
        is_flat = isinstance(last, FlatLand)
        step = max(0.5 * (end_r - edges[-1][0][0]), last.edge_radius) if is_flat else 0.0
        pieces.append(
            ((end_r, end_z - self.outer_radius) if is_flat else (self.outer_radius, end_z), "seat_face")
        )
        chain = Curve(tuple(Segment(p, q, name) for (p, _), (q, name) in pairwise(pieces)))
        face = rounded(chain, lambda n: radii[n]).without_first()
        if is_flat:
            face = face.without_last()
        face = Curve(tuple(replace(s, name=s.name or "seat_face") for s in face.segments))
        start = face.segments[0].start
        return housing(face, self.outer_radius, self.height + start[1], step)

    def _groove(self, end: Point, start: Point) -> list[Point]:
        """Corners of the bottom of the chamber between the end of a land and the start of the next."""
        length, slope = math.dist(end, start), math.atan2(start[1] - end[1], start[0] - end[0])
        # a face runs outwards all the way
        falls, rises = max(slope - _WALL, -_STEEPEST), min(slope + _WALL, _STEEPEST)
        fall, rise = (self.chamber_depth / math.sin(abs(wall - slope)) for wall in (falls, rises))
        need = fall * math.cos(falls - slope) + rise * math.cos(rises - slope)
        must = (
            "the walls of the chamber meet before they are so deep; allowed is below {} between these lands"
        )
        depth = self.chamber_depth
        check_length("seat", "chamber_depth", depth, need < length, must, depth * length / need)
        return [
            (end[0] + fall * math.cos(falls), end[1] + fall * math.sin(falls)),
            (start[0] - rise * math.cos(rises), start[1] - rise * math.sin(rises)),
        ]
