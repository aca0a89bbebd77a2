"""The edge between a bore and a flat or sloping top as seat."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.geometry.outline import Outline, chain
from meshes.shapes.shape import (
    NamedFace,
    Partner,
    Shape,
    check_angle,
    check_exceeds,
    check_positive,
    housing,
    round_part,
)


@dataclass(frozen=True)
class SharpEdge:
    """Edge with a small fillet between a bore and the top of a cylindrical housing.

    The fillet is an arc around the circle c = bore_radius + edge_radius: a ball of radius R touches it at
    sin(angle) = c/(R + edge_radius), r0 = R sin(angle), 1/R_rel = 1/R + 1/edge_radius; a cone of inclination theta at
    r0 = c - edge_radius sin(theta), R_rel = edge_radius.

    Parameters
    ----------
    bore_radius : float
        Radius of the bore [m].
    edge_radius : float
        Radius of the fillet [m].
    top_angle : float
        Inclination of the top to the horizontal plane [rad], positive where it rises outwards.
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the edge before rounding to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible, or the fillet does not fit.

    Examples
    --------
    >>> import meshes
    >>> meshes.SharpEdge.around(0.01, meshes.Ball(0.02)).bore_radius
    0.01
    """

    bore_radius: float
    edge_radius: float
    top_angle: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        check_positive("seat", bore_radius=self.bore_radius, edge_radius=self.edge_radius, height=self.height)
        check_angle("seat", "top_angle", self.top_angle, -math.pi / 2)
        check_exceeds("seat", "outer_radius", self.outer_radius, self.bore_radius, "bore_radius =")

    @classmethod
    def around(
        cls,
        bore_radius: float,
        closure: Shape,
        *,
        edge_radius: float | None = None,
        top_angle: float = 0.0,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> SharpEdge:
        """Edge for a closure, with the dimensions that are not given in proportion to it.

        Parameters
        ----------
        bore_radius : float
            Radius of the bore [m].
        closure : Shape
        edge_radius : float, optional
            A hundredth of the bore's radius unless given [m].
        top_angle : float
            As of the class.
        outer_radius, height : float, optional
            Bore + 1.5 L and 1.5 L unless given [m], with L the radius of the closure.
        """
        check_positive("seat", bore_radius=bore_radius)
        partner = Partner(closure.outline)
        outer, high = partner.housing(bore_radius, bore_radius, outer_radius, height)
        # A top that falls outwards needs a housing below it.
        fall = (outer - bore_radius) * max(-math.tan(top_angle), 0.0) if height is None else 0.0
        edge = 0.01 * bore_radius if edge_radius is None else edge_radius
        return cls(bore_radius, edge, top_angle, outer, high + fall)

    @property
    def outline(self) -> Outline:
        """Section with the edge before rounding at z = 0."""
        r, outer = self.bore_radius, self.outer_radius
        corners = [(r, -self.height - outer), (r, 0.0), (outer, (outer - r) * math.tan(self.top_angle))]
        face = chain(corners, "seat_face", self.edge_radius).without_first()
        return housing(face, self.outer_radius, self.height + face.segments[0].start[1])

    @property
    def named_face(self) -> NamedFace:
        """The fillet between bore and top."""
        return round_part("rounded edge", self.outline, self.edge_radius)
