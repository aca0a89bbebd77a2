"""A convex ring of circular section as seat."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.geometry.curve import Curve, Segment
from meshes.geometry.outline import Outline
from meshes.shapes.shape import (
    NamedFace,
    Partner,
    Shape,
    check_exceeds,
    check_length,
    check_positive,
    housing,
    round_part,
)


@dataclass(frozen=True)
class ToroidalSeat:
    """Ring of circular section on the flat top of a cylindrical housing.

    A ball of radius R touches it where its normal points to both centres: sin(angle) = centre_radius/(R + radius),
    r0 = R sin(angle), 1/R_rel = 1/R + 1/radius. A cone of inclination theta touches at
    r0 = centre_radius - radius sin(theta), R_rel = radius.

    Parameters
    ----------
    centre_radius : float
        Distance of the section's centre from the axis [m].
    radius : float
        Radius of the section [m].
    bore_radius : float
        Radius of the bore [m], from centre_radius - radius, where the ring goes over into it smoothly, to below
        centre_radius.
    recess : float
        Depth of the flat outside the ring below its crest [m]; zero lets the top go on from the crest.
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the lower end of the ring to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible.

    Examples
    --------
    >>> import meshes
    >>> print(f"{meshes.ToroidalSeat(0.016, 2e-3, 0.015, 0.0, 0.03, 0.02).outline.area * 1e6:.0f} mm^2 of section")
    304 mm^2 of section
    """

    centre_radius: float
    radius: float
    bore_radius: float
    recess: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        check_positive(
            "seat",
            centre_radius=self.centre_radius,
            radius=self.radius,
            bore_radius=self.bore_radius,
            height=self.height,
        )
        lowest = self.centre_radius - self.radius
        bore, centre = self.bore_radius, self.centre_radius
        fits = lowest * (1 - 1e-12) <= bore < centre
        must = "must lie between {}, the innermost circle of the ring, and its centre_radius = {}"
        check_length("seat", "bore_radius", bore, fits, must, max(lowest, 0), centre)
        must = "must be at least 0 and below the radius of the ring, {}"
        check_length("seat", "recess", self.recess, 0 <= self.recess < self.radius, must, self.radius)
        check_exceeds("seat", "outer_radius", self.outer_radius, self.ring_end, "the outer end of the ring,")

    @classmethod
    def around(
        cls,
        centre_radius: float,
        radius: float,
        closure: Shape,
        *,
        bore_radius: float | None = None,
        recess: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> ToroidalSeat:
        """Ring for a closure, with the dimensions that are not given in proportion to it.

        Parameters
        ----------
        centre_radius, radius : float
            As of the class [m].
        closure : Shape
        bore_radius : float, optional
            Where the ring goes over into the bore, but at least half the centre radius, unless given [m].
        recess : float, optional
            Half the ring's radius unless given [m].
        outer_radius, height : float, optional
            Outer end of the ring + 1.5 L and 1.5 L unless given [m], with L the radius of the closure.
        """
        check_positive("seat", centre_radius=centre_radius, radius=radius)
        partner = Partner(closure.outline)
        depth = radius / 2 if recess is None else recess
        end = centre_radius + math.sqrt(max(depth * (2 * radius - depth), 0.0))
        bore = max(centre_radius - radius, centre_radius / 2) if bore_radius is None else bore_radius
        housing_size = partner.housing(end, 1.1 * end, outer_radius, height)
        return cls(centre_radius, radius, bore, depth, *housing_size)

    @property
    def ring_end(self) -> float:
        """Radius at which the ring ends on its outer side [m]."""
        return self.centre_radius + math.sqrt(max(self.recess * (2 * self.radius - self.recess), 0.0))

    @property
    def outline(self) -> Outline:
        """Section with the crest of the ring at z = 0."""
        centre, crest = (self.centre_radius, -self.radius), (self.centre_radius, 0.0)
        reach = min(self.centre_radius - self.bore_radius, self.radius)
        inner = (self.centre_radius - reach, math.sqrt(self.radius**2 - reach**2) - self.radius)
        arc, depth = Segment(inner, crest, "seat_face", centre), self.recess
        end, bend = ((self.ring_end, -depth), centre) if depth > 0 else ((self.outer_radius, 0.0), None)
        slope = Segment(crest, end, "seat_face", bend)
        return housing(Curve((arc, slope)), self.outer_radius, self.height)

    @property
    def named_face(self) -> NamedFace:
        """The ring of circular section."""
        return round_part("ring", self.outline, self.radius)
