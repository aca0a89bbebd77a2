"""A conical seat in a cylindrical housing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from meshes.errors import GeometryError
from meshes.outline import Outline, Point, Segment

FloatArray = NDArray[np.float64]


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
    """

    angle: float
    bore_radius: float
    face_radius: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        if not 0 < self.angle < math.pi / 2:
            raise GeometryError(
                f"seat angle = {math.degrees(self.angle):.6g} deg: must lie between 0 and 90 deg"
            )
        if not 0 < self.bore_radius < self.face_radius <= self.outer_radius:
            raise GeometryError(
                "seat radii must increase from the bore over the upper edge of the face to the housing, got "
                f"{self.bore_radius:.6g} m, {self.face_radius:.6g} m, {self.outer_radius:.6g} m"
            )
        if not (math.isfinite(self.height) and self.height > 0):
            raise GeometryError(f"seat height = {self.height!r} m: must be positive and finite")

    @classmethod
    def around(
        cls,
        angle: float,
        ball_radius: float,
        *,
        bore_radius: float | None = None,
        face_radius: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> ConicalSeat:
        """Seat for a ball, with the dimensions that are not given in proportion to the ball.

        The bore has half the radius of first touch, the face ends 0.6 ball radii (along the face) beyond first
        touch, the housing is 1.5 ball radii wider than first touch and 1.5 ball radii high below the face: far
        enough from the contact to change the pressure profile of a narrow contact by some 1e-5.

        Parameters
        ----------
        angle : float
            theta [rad].
        ball_radius : float
            R [m].
        bore_radius, face_radius, outer_radius, height : float, optional
            As of the class [m].
        """
        if not 0 < angle < math.pi / 2:
            raise GeometryError(f"seat angle = {math.degrees(angle):.6g} deg: must lie between 0 and 90 deg")
        touch = ball_radius * math.sin(angle)
        face = face_radius or touch + 0.6 * ball_radius * math.cos(angle)
        if outer_radius is not None and face_radius is None:
            face = min(face, outer_radius)
        return cls(
            angle,
            bore_radius or 0.5 * touch,
            face,
            outer_radius or max(touch + 1.5 * ball_radius, face),
            height or 1.5 * ball_radius,
        )

    def face_reach(self, touch_radius: float) -> tuple[float, float]:
        """Arc lengths [m] from first touch at `touch_radius` [m] to the lower and upper edge of the face."""
        cos = math.cos(self.angle)
        return (self.bore_radius - touch_radius) / cos, (self.face_radius - touch_radius) / cos

    def outline(self, touch_radius: float, x: FloatArray) -> Outline:
        """Section with the face through (touch_radius, 0), carrying the given vertices of the contact line.

        Parameters
        ----------
        touch_radius : float
            Radius of first touch [m].
        x : ndarray
            Vertices of the contact line as arc length from first touch [m], increasing.
        """
        cos, sin = math.cos(self.angle), math.sin(self.angle)

        def at(x: float) -> Point:
            return touch_radius + x * cos, x * sin

        lower, upper = (at(x) for x in self.face_reach(touch_radius))
        bottom = lower[1] - self.height
        line = [at(x) for x in reversed(x.tolist())]
        corners = [
            *((a, b, "seat_contact") for a, b in pairwise(line)),
            (line[-1], lower, "seat_inner"),
            (lower, (lower[0], bottom), "seat_inner"),
            ((lower[0], bottom), (self.outer_radius, bottom), "seat_bottom"),
            ((self.outer_radius, bottom), (self.outer_radius, upper[1]), "seat_wall"),
            ((self.outer_radius, upper[1]), upper, "seat_outer"),
            (upper, line[0], "seat_outer"),
        ]
        return Outline("seat", tuple(Segment(a, b, name) for a, b, name in corners if math.dist(a, b) > 0))
