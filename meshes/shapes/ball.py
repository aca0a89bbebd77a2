"""A ball as closure."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.geometry.curve import Point, Segment
from meshes.geometry.outline import Outline
from meshes.shapes.shape import check_length, check_positive

# The closing force acts above this angle from the downward axis, so that it does not bend the surface near the
# contact, which lies below 90 degrees.
_TOP = 2 * math.pi / 3


@dataclass(frozen=True)
class Ball:
    """Ball of radius `radius` [m], solid unless `cavity_radius` [m] makes it a hollow sphere.

    Its face is the lower half; the closing force acts on the surface above 120 degrees from the downward axis.

    Raises
    ------
    GeometryError
        If the radius is not positive and finite, or the cavity not smaller than the ball.

    Examples
    --------
    >>> import meshes
    >>> print(f"{meshes.Ball(0.02).outline.area * 1e6:.0f} mm^2 of section")
    628 mm^2 of section
    """

    radius: float
    cavity_radius: float = 0.0

    def __post_init__(self) -> None:
        check_positive("closure", radius=self.radius)
        hollow, must = 0 <= self.cavity_radius < self.radius, "must be below the radius {}"
        check_length("closure", "cavity_radius", self.cavity_radius, hollow, must, self.radius)

    @property
    def outline(self) -> Outline:
        """Section with the centre at the origin."""
        centre, hole = (0.0, 0.0), self.cavity_radius

        def at(angle: float, radius: float = self.radius) -> Point:
            return radius * math.sin(angle), -radius * math.cos(angle)

        bottom, side, shoulder, top = (0.0, -self.radius), (self.radius, 0.0), at(_TOP), (0.0, self.radius)
        shell = (
            Segment(bottom, side, "closure_face", centre),
            Segment(side, shoulder, "closure_outer", centre),
            Segment(shoulder, top, "closure_top", centre),
        )
        if not hole:
            return Outline("closure", (*shell, Segment(top, bottom, "closure_axis")))
        axis_side = (
            Segment(top, (0.0, hole), "closure_axis"),
            Segment((0.0, hole), (hole, 0.0), "closure_cavity", centre),
            Segment((hole, 0.0), (0.0, -hole), "closure_cavity", centre),
            Segment((0.0, -hole), bottom, "closure_axis"),
        )
        return Outline("closure", (*shell, *axis_side))
