"""A hollow spherical seat, as turned or lapped with a ball."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve, Segment
from meshes.geometry.outline import Outline, rounded
from meshes.shapes.shape import (
    NamedFace,
    Partner,
    Shape,
    check_angle,
    check_exceeds,
    check_length,
    check_not_negative,
    check_positive,
    housing,
    round_part,
)


@dataclass(frozen=True)
class SphericalSeat:
    """Hollow face of circular section between a bore and the flat top of a cylindrical housing, edges rounded.

    A ball of radius R < radius touches it where its normal points to both centres: at r0 = R sin(angle) with
    sin(angle) = -centre_offset/(radius - R), and 1/R_rel = 1/R - 1/radius. With the centre on the axis a smaller ball
    touches the edge of the bore and a larger ball the upper edge.

    Parameters
    ----------
    radius : float
        Radius of the section [m].
    centre_offset : float
        Distance of the section's centre from the axis [m]; zero for a sphere, negative where the centre lies beyond
        the axis (a ring that a ball fits around one circle).
    bore_radius, face_radius : float
        Radii of the lower and of the upper edge of the face before rounding [m].
    edge_radius : float
        Radius of the rounding of both edges [m]; zero keeps them sharp.
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the lower edge of the face to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible, or the rounding does not fit.

    Examples
    --------
    >>> import meshes
    >>> seat = meshes.SphericalSeat.around(0.0205, meshes.Ball(0.02), contact_angle=0.785)
    >>> seat.radius
    0.0205
    """

    radius: float
    centre_offset: float
    bore_radius: float
    face_radius: float
    edge_radius: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        check_positive("seat", radius=self.radius, bore_radius=self.bore_radius, height=self.height)
        check_not_negative("seat", "edge_radius", self.edge_radius)
        widest = self.radius + self.centre_offset
        face, bore, lowest = self.face_radius, self.bore_radius, self.centre_offset
        must = "must lie between bore_radius = {} and {}, where the hollow face of radius {} stands upright"
        fits = max(bore, lowest) < face < widest
        check_length("seat", "face_radius", face, fits, must, bore, widest, self.radius)
        must = "must not be below {}, where the hollow face is lowest"
        check_length("seat", "bore_radius", bore, bore >= lowest, must, lowest)
        check_exceeds("seat", "outer_radius", self.outer_radius, self.face_radius, "face_radius =")

    @classmethod
    def around(
        cls,
        radius: float,
        closure: Shape,
        *,
        contact_angle: float | None = None,
        bore_radius: float | None = None,
        face_radius: float | None = None,
        edge_radius: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> SphericalSeat:
        """Seat for a closure, with the dimensions that are not given in proportion to it.

        Parameters
        ----------
        radius : float
            Radius of the section [m].
        closure : Shape
        contact_angle : float, optional
            Angle theta of the contact normal at which the closure shall touch, as if the seat had been lapped around
            that circle [rad]: the centre then lies (radius - R) sin(theta) beyond the axis, with R the radius of a
            ball. Without it the centre lies on the axis.
        bore_radius, face_radius : float, optional
            Half and 1.35 times the radius of first touch unless given (the upper edge at most where the face is
            inclined by 75 degrees) [m]; with the centre on the axis half and nine tenths of the closure's radius.
        edge_radius : float, optional
            A twentieth of the face's width unless given [m].
        outer_radius, height : float, optional
            First touch + 1.5 L and 1.5 L unless given [m], with L the radius of the closure.

        Raises
        ------
        GeometryError
            If no seat of this radius touches the closure at `contact_angle`.
        """
        check_positive("seat", radius=radius)
        partner = Partner(closure.outline)
        offset, touch = 0.0, 0.7 * min(partner.size, radius)
        bore, face = 0.5 * min(partner.size, radius), 0.9 * min(partner.size, radius)
        if contact_angle is not None:
            check_angle("seat", "contact_angle", contact_angle)
            # The closure's point of this inclination does not depend on what it stands on.
            touch = partner.touch_on_cone(contact_angle)
            offset = touch - radius * math.sin(contact_angle)
            bore, face = 0.5 * touch, 1.35 * touch
        steepest = offset + radius * math.sin(math.radians(75))
        face = min(face, steepest) if face_radius is None else face_radius
        bore = min(bore, 0.9 * face) if bore_radius is None else bore_radius
        edge = 0.05 * (face - bore) if edge_radius is None else edge_radius
        housing_size = partner.housing(touch, 1.1 * face, outer_radius, height)
        seat = cls(radius, offset, bore, face, edge, *housing_size)
        if contact_angle is not None:
            seat._check_touch(partner, touch, f"seat contact_angle = {math.degrees(contact_angle):.6g} deg")
        return seat

    def _check_touch(self, partner: Partner, touch: float, keys: str) -> None:
        """Refuse a face on which the closure first touches anywhere else than at r = `touch`."""
        face = self.outline.face
        radius = partner.touch_on(face)
        if math.isclose(radius, touch, rel_tol=1e-6):
            return
        if math.isclose(self.radius * partner.curvature_on(face), 1, rel_tol=1e-6):
            same_centre = abs(self.centre_offset) < 1e-6 * self.radius
            remedy = "leave contact_angle out, or make" if same_centre else "make"
            raise GeometryError(
                f"{keys}: the closure has the radius of the face, {mm(self.radius)}, so that they fit each other "
                f"and touch nowhere first; {remedy} the radius of the seat larger"
            )
        raise GeometryError(
            f"{keys}: at that angle, r = {mm(touch)}, the closure does not touch the face of radius "
            f"{mm(self.radius)} first, but at r = {mm(radius)}; make the radius of the seat larger than that of "
            "the closure there, or the face wider"
        )

    @property
    def outline(self) -> Outline:
        """Section with the lower edge of the face before rounding at z = 0."""
        depth, end = (
            math.sqrt(self.radius**2 - (r - self.centre_offset) ** 2)
            for r in (self.bore_radius, self.face_radius)
        )
        centre, top = (self.centre_offset, depth), depth - end
        lower, upper = (self.bore_radius, 0.0), (self.face_radius, top)
        sharp = (
            Segment((self.bore_radius, -self.height - self.outer_radius), lower, "seat_face"),
            Segment(lower, upper, "seat_face", centre),
            Segment(upper, (self.outer_radius, top), "seat_face"),
        )
        face = rounded(Curve(sharp), self.edge_radius).without_first()
        return housing(face, self.outer_radius, self.height + face.segments[0].start[1])

    @property
    def named_face(self) -> NamedFace:
        """The hollow face between its rounded edges."""
        return round_part("spherical face", self.outline, self.radius)
