"""A narrow conical face with rounded edges as seat."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.errors import GeometryError
from meshes.geometry.outline import Outline, chain
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
    straight_part,
)


@dataclass(frozen=True)
class ConicalLand:
    """Conical land of finite width between a bore and a relief, both edges rounded.

    A ball of radius R touches it at r0 = R sin(angle), with R_rel = R, as long as that lies on the land. A cone of the
    same angle fits it: it touches first in the middle of the common stretch, with R_rel = inf.

    Parameters
    ----------
    angle : float
        Angle theta between the axis and the contact normal, the inclination of the land to the horizontal plane [rad].
    land_radius : float
        Radius of the middle of the land [m].
    land_width : float
        Width of the land along its slope, between the edges before rounding [m].
    edge_radius : float
        Radius of the rounding of both edges [m]; zero keeps them sharp.
    relief_angle : float
        Inclination of the surface outside the land to the horizontal plane [rad]; zero is a flat top.
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the lower edge of the land to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible, or the rounding does not fit.

    Examples
    --------
    >>> import meshes
    >>> land = meshes.ConicalLand.around(0.785, meshes.Ball(0.02), land_width=1e-3)
    >>> land.land_width
    0.001
    """

    angle: float
    land_radius: float
    land_width: float
    edge_radius: float
    relief_angle: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        check_angle("seat", "angle", self.angle)
        check_positive("seat", land_radius=self.land_radius, land_width=self.land_width, height=self.height)
        check_not_negative("seat", "edge_radius", self.edge_radius)
        if not 0 <= self.relief_angle < self.angle:
            raise GeometryError(
                f"seat relief_angle = {math.degrees(self.relief_angle):.6g} deg: must be at least 0 and below the "
                f"angle of the land, {math.degrees(self.angle):.6g} deg"
            )
        widest = 2 * self.land_radius / math.cos(self.angle)
        must = "the land around r = {} would reach to the axis; allowed is below {}"
        check_length(
            "seat", "land_width", self.land_width, self.bore_radius > 0, must, self.land_radius, widest
        )
        upper_edge = "the radius of the upper edge of the land,"
        check_exceeds("seat", "outer_radius", self.outer_radius, self.land_end, upper_edge)

    @classmethod
    def around(
        cls,
        angle: float,
        closure: Shape,
        *,
        land_width: float | None = None,
        land_radius: float | None = None,
        edge_radius: float | None = None,
        relief_angle: float = 0.0,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> ConicalLand:
        """Land for a closure, with the dimensions that are not given in proportion to it.

        Parameters
        ----------
        angle : float
            theta [rad].
        closure : Shape
        land_width : float, optional
            A tenth of the radius of first touch unless given [m].
        land_radius : float, optional
            Radius of first touch on a cone without ends unless given [m]: the land is centred on it.
        edge_radius : float, optional
            A tenth of the land's width unless given [m].
        relief_angle : float
            As of the class.
        outer_radius, height : float, optional
            First touch + 1.5 L and 1.5 L unless given [m], with L the radius of the closure.
        """
        check_angle("seat", "angle", angle)
        partner = Partner(closure.outline)
        touch = partner.touch_on_cone(angle)
        radius = touch if land_radius is None else land_radius
        width = 0.1 * radius if land_width is None else land_width
        end = radius + 0.5 * width * math.cos(angle)
        edge = 0.1 * width if edge_radius is None else edge_radius
        housing_size = partner.housing(touch, 1.1 * end, outer_radius, height)
        return cls(angle, radius, width, edge, relief_angle, *housing_size)

    @property
    def bore_radius(self) -> float:
        """Radius of the bore, where the land begins [m]."""
        return self.land_radius - 0.5 * self.land_width * math.cos(self.angle)

    @property
    def land_end(self) -> float:
        """Radius of the upper edge of the land before rounding [m]."""
        return self.land_radius + 0.5 * self.land_width * math.cos(self.angle)

    @property
    def outline(self) -> Outline:
        """Section with the lower edge of the land before rounding at z = 0."""
        rise = self.land_width * math.sin(self.angle)
        top = rise + (self.outer_radius - self.land_end) * math.tan(self.relief_angle)
        bore = (self.bore_radius, -self.height - self.outer_radius)
        corners = [bore, (self.bore_radius, 0.0), (self.land_end, rise), (self.outer_radius, top)]
        face = chain(corners, "seat_face", self.edge_radius).without_first()
        return housing(face, self.outer_radius, self.height + face.segments[0].start[1])

    @property
    def named_face(self) -> NamedFace:
        """The land between its rounded edges."""
        return straight_part("land", self.outline, self.angle)
