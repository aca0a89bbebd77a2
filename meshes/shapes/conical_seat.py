"""A conical seat in a cylindrical housing."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.errors import GeometryError, mm
from meshes.geometry.outline import Outline, chain
from meshes.shapes.shape import Partner, Shape, check_angle, check_positive, housing


@dataclass(frozen=True)
class ConicalSeat:
    """Conical seat face between a bore and the flat top of a cylindrical housing.

    Parameters
    ----------
    angle : float
        Angle theta between the axis and the contact normal [rad]; the face is inclined by theta to the
        horizontal plane and its half-angle from the axis is pi/2 - theta.
    bore_radius : float
        Radius of the bore below the face [m].
    face_radius : float
        Radius of the upper edge of the face [m].
    outer_radius : float
        Radius of the housing [m], at least `face_radius`.
    height : float
        Length of the bore, from the lower edge of the face to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If the angle is outside (0, pi/2) or the radii are not increasing.

    Examples
    --------
    >>> import meshes
    >>> seat = meshes.ConicalSeat.around(0.785, meshes.Ball(0.02))
    >>> 0 < seat.bore_radius < seat.face_radius < seat.outer_radius
    True
    """

    angle: float
    bore_radius: float
    face_radius: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        check_angle("seat", "angle", self.angle)
        if not 0 < self.bore_radius < self.face_radius <= self.outer_radius:
            raise GeometryError(
                "seat radii must increase from the bore over the upper edge of the face to the housing, got "
                f"{mm(self.bore_radius)}, {mm(self.face_radius)}, {mm(self.outer_radius)}; make the bore "
                "smaller, or the upper edge or the housing larger (bore_radius, face_radius, outer_radius)"
            )
        check_positive("seat", height=self.height)

    @classmethod
    def around(
        cls,
        angle: float,
        closure: Shape,
        *,
        bore_radius: float | None = None,
        face_radius: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> ConicalSeat:
        """Seat for a closure, with the dimensions that are not given in proportion to it.

        With L the radius of the closure (of a ball its own), the bore has half the radius of first touch, the face
        ends 0.6 L (along the face) beyond first touch, the housing is 1.5 L wider than first touch and 1.5 L high
        below the face: far enough from the contact to change the pressure profile of a narrow contact by some 1e-5.

        Parameters
        ----------
        angle : float
            theta [rad].
        closure : Shape
        bore_radius, face_radius, outer_radius, height : float, optional
            As of the class [m].
        """
        check_angle("seat", "angle", angle)
        partner = Partner(closure.outline)
        touch = partner.touch_on_cone(angle)
        face = face_radius or touch + 0.6 * partner.size * math.cos(angle)
        if outer_radius is not None and face_radius is None:
            face = min(face, outer_radius)
        bore, housing_size = bore_radius or 0.5 * touch, (outer_radius or None, height or None)
        return cls(angle, bore, face, *partner.housing(touch, face, *housing_size))

    @property
    def outline(self) -> Outline:
        """Section with the lower edge of the face at z = 0."""
        rise = (self.face_radius - self.bore_radius) * math.tan(self.angle)
        face = chain([(self.bore_radius, 0.0), (self.face_radius, rise)], "seat_face")
        return housing(face, self.outer_radius, self.height)
