"""Faces of flanges with a bore: seats turned over, so that they look down onto a gasket."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from meshes.geometry.curve import Curve, Point, Segment
from meshes.geometry.outline import Outline, chain
from meshes.shapes.conical_seat import ConicalSeat
from meshes.shapes.flat_land import FlatLand
from meshes.shapes.gaskets import FLANK_ANGLE
from meshes.shapes.shape import check_angle, check_exceeds, check_length, check_positive, housing

# What a boundary of the seat is on the flange.
_NAMES = {
    "seat_face": "closure_face",
    "seat_chamber": "closure_chamber",
    "seat_inner": "closure_inner",
    "seat_outer": "closure_outer",
    "seat_wall": "closure_outer",
    "seat_bottom": "closure_top",
}


def turned_over(seat: Outline) -> Outline:
    """A seat upside down as closure: its bottom is the loaded top, and it has no axis.

    Examples
    --------
    >>> import meshes
    >>> face = meshes.chain([(0.01, 0.0), (0.02, 0.0)], "seat_face")
    >>> turned = turned_over(meshes.housing(face, outer_radius=0.03, height=0.02))
    >>> turned.extent[1], turned.face.segments[0].start
    ((0.0, 0.02), (0.01, 0.0))
    """

    def image(p: Point) -> Point:
        return p[0], 0.0 - p[1]

    pieces = (
        Segment(image(s.end), image(s.start), _NAMES[s.name], None if s.centre is None else image(s.centre))
        for s in reversed(seat.segments)
    )
    return Outline("closure", tuple(pieces))


@dataclass(frozen=True)
class FlangeFace:
    """A flange with a bore, whose face is that of a seat turned over.

    Parameters
    ----------
    outline : Outline
        Section, its face downwards.
    edge_radius, outer_radius, height : float
        Rounding, radius and height, as chosen where they are not given [m].

    Examples
    --------
    >>> import meshes
    >>> flange = meshes.FlangeFace.raised(0.02, 0.03)
    >>> print(f"{flange.outer_radius * 1e3:.0f} mm, {flange.outline.area * 1e6:.0f} mm^2 of section")
    36 mm, 250 mm^2 of section
    """

    outline: Outline
    edge_radius: float
    outer_radius: float
    height: float

    @classmethod
    def flat(
        cls,
        bore_radius: float,
        outer_radius: float,
        *,
        edge_radius: float | None = None,
        height: float | None = None,
    ) -> FlangeFace:
        """Flat from the bore to the outer radius.

        Parameters
        ----------
        bore_radius, outer_radius : float
            [m]
        edge_radius, height : float, optional
            A hundredth of the bore's radius, and the width of the face unless given [m].
        """
        check_positive("closure", bore_radius=bore_radius)
        check_exceeds("closure", "outer_radius", outer_radius, bore_radius, "bore_radius =")
        edge = 0.01 * bore_radius if edge_radius is None else edge_radius
        thickness = outer_radius - bore_radius if height is None else height
        check_positive("closure", height=thickness, edge_radius=edge)
        corners = [(bore_radius, -thickness), (bore_radius, 0.0), (outer_radius, 0.0)]
        face = chain(corners, "seat_face", edge).without_first()
        return cls(turned_over(housing(face, outer_radius, thickness - edge)), edge, outer_radius, thickness)

    @classmethod
    def raised(
        cls,
        land_inner_radius: float,
        land_outer_radius: float,
        *,
        edge_radius: float | None = None,
        land_height: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> FlangeFace:
        """Raised flat ring, its edges rounded.

        Parameters
        ----------
        land_inner_radius, land_outer_radius : float
            [m]; the former is that of the bore.
        edge_radius, land_height, outer_radius, height : float, optional
            A twentieth and a tenth of the ring's width, 1.2 land_outer_radius, the flange's width unless given [m].
        """
        check_positive("closure", land_inner_radius=land_inner_radius)
        check_exceeds(
            "closure", "land_outer_radius", land_outer_radius, land_inner_radius, "land_inner_radius ="
        )
        width = land_outer_radius - land_inner_radius
        edge = 0.05 * width if edge_radius is None else edge_radius
        step = 0.1 * width if land_height is None else land_height
        outer = 1.2 * land_outer_radius if outer_radius is None else outer_radius
        thickness = outer - land_inner_radius if height is None else height
        land = FlatLand(land_inner_radius, land_outer_radius, edge, step, outer, thickness)
        return cls(turned_over(land.outline), edge, outer, thickness)

    @classmethod
    def conical(
        cls,
        angle: float,
        bore_radius: float,
        face_radius: float,
        *,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> FlangeFace:
        """Hollow cone from the bore down to its lower edge, as for lens rings and double-cone rings.

        Parameters
        ----------
        angle : float
            Inclination of the face to the horizontal plane [rad].
        bore_radius, face_radius : float
            Radii between which it lies [m].
        outer_radius, height : float, optional
            Twice face_radius minus bore_radius, and the width of the flange unless given [m].
        """
        outer = 2 * face_radius - bore_radius if outer_radius is None else outer_radius
        thickness = outer - bore_radius if height is None else height
        cone = ConicalSeat(angle, bore_radius, face_radius, outer, thickness)
        return cls(turned_over(cone.outline), 0.0, outer, thickness)

    @classmethod
    def grooved(
        cls,
        bore_radius: float,
        groove_mean_radius: float,
        groove_width: float,
        groove_depth: float,
        *,
        angle: float = FLANK_ANGLE,
        bottom_edge_radius: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> FlangeFace:
        """Flat with a trapezoidal groove for a ring joint, whose bottom is a chamber between its two flanks.

        Parameters
        ----------
        bore_radius, groove_mean_radius : float
            Of the bore, and of the middle of the groove, half the pitch diameter [m].
        groove_width, groove_depth : float
            Width at the face of the flange, and depth [m].
        angle : float
            Inclination of the flanks to the horizontal plane [rad]: 67 deg, 23 deg to the axis.
        bottom_edge_radius, outer_radius, height : float, optional
            A tenth of the depth, the groove's outer edge and as much again as the face inside the groove, five times
            the depth unless given [m].

        Raises
        ------
        GeometryError
            If a dimension is not positive, the groove does not lie between bore and outer radius, or its flanks meet
            above its bottom.
        """
        r, half = groove_mean_radius, 0.5 * groove_width
        check_positive(
            "closure", bore_radius=bore_radius, groove_width=groove_width, groove_depth=groove_depth
        )
        check_angle("closure", "angle", angle)
        check_exceeds(
            "closure", "groove_mean_radius", r, bore_radius + half, "bore_radius + half groove_width,"
        )
        bottom = half - groove_depth / math.tan(angle)
        must = "the flanks meet at {}; make the groove wider or less deep"
        check_length("closure", "groove_depth", groove_depth, bottom > 0, must, half * math.tan(angle))
        outer = 2 * r - bore_radius if outer_radius is None else outer_radius
        thickness = 5 * groove_depth if height is None else height
        check_exceeds("closure", "outer_radius", outer, r + half, "the outer edge of the groove,")
        rounding = 0.1 * groove_depth if bottom_edge_radius is None else bottom_edge_radius
        corners = [
            (bore_radius, 0.0),
            (r - half, 0.0),
            (r - bottom, -groove_depth),
            (r + bottom, -groove_depth),
        ]
        corners += [(r + half, 0.0), (outer, 0.0)]
        face = chain(corners, "seat_face", lambda n: rounding if n in (2, 3) else 0.0)
        face = Curve(
            tuple(replace(s, name="seat_chamber") if s.start[1] == s.end[1] < 0 else s for s in face.segments)
        )
        return cls(turned_over(housing(face, outer, thickness)), rounding, outer, thickness)
