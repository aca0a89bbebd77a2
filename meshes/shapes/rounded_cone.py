"""A cone with rounded edges as closure: the poppet of a valve."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.errors import GeometryError
from meshes.geometry.outline import Outline, chain
from meshes.shapes.shape import (
    NamedFace,
    check_angle,
    check_exceeds,
    check_not_negative,
    check_positive,
    plunger,
    straight_part,
)


@dataclass(frozen=True)
class RoundedCone:
    """Conical face between a flat nose and a cylindrical stem, both edges rounded.

    On a straight seat of inclination beta it touches with its lower edge where beta < angle and with its upper edge
    where beta > angle, at r0 = (radius of the edge's centre) + edge_radius sin(beta), with R_rel = edge_radius; where
    both angles are equal the whole face touches, R_rel = inf. On a ring (an edge or a torus with a section of radius
    rho around the circle c) the conical face touches at r0 = c - rho sin(angle), with R_rel = rho.

    Parameters
    ----------
    angle : float
        Inclination of the conical face to the horizontal plane, the angle between the axis and its normal [rad].
    inner_radius, outer_radius : float
        Radii of the lower and of the upper edge of the conical face before rounding [m]; the latter is that of the
        stem.
    edge_radius : float
        Radius of the rounding of both edges [m]; zero keeps them sharp.
    height : float
        From the upper edge of the conical face to the top of the closure [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible, or the rounding does not fit.

    Examples
    --------
    >>> import meshes
    >>> print(f"{meshes.RoundedCone(0.785, 0.01, 0.02, 1e-3, 0.02).outline.area * 1e6:.0f} mm^2 of section")
    550 mm^2 of section
    """

    angle: float
    inner_radius: float
    outer_radius: float
    edge_radius: float
    height: float

    def __post_init__(self) -> None:
        check_angle("closure", "angle", self.angle)
        check_positive("closure", inner_radius=self.inner_radius, height=self.height)
        check_exceeds("closure", "outer_radius", self.outer_radius, self.inner_radius, "inner_radius =")
        check_not_negative("closure", "edge_radius", self.edge_radius)

    @classmethod
    def of(
        cls,
        angle: float,
        *,
        outer_radius: float | None = None,
        inner_radius: float | None = None,
        mean_radius: float | None = None,
        edge_radius: float | None = None,
        height: float | None = None,
    ) -> RoundedCone:
        """Cone from two of its radii, or from one and proportions.

        Parameters
        ----------
        angle : float
            As of the class.
        outer_radius, inner_radius, mean_radius : float, optional
            One or two of them [m]; with one, the inner radius is half the outer one.
        edge_radius : float, optional
            A tenth of the length of the conical face, and no more than leaves a flat nose, unless given [m].
        height : float, optional
            The outer radius unless given [m].
        """
        radii = [r for r in (outer_radius, inner_radius, mean_radius) if r is not None]
        if not 1 <= len(radii) <= 2:
            raise GeometryError(
                f"closure outer_radius, inner_radius and mean_radius: {len(radii)} are given; one or two are needed"
            )
        if outer_radius is None:
            if mean_radius is not None:
                outer_radius = 4 / 3 * mean_radius if inner_radius is None else 2 * mean_radius - inner_radius
            else:
                assert inner_radius is not None
                outer_radius = 2 * inner_radius
        if inner_radius is None:
            inner_radius = outer_radius / 2 if mean_radius is None else 2 * mean_radius - outer_radius
        check_angle("closure", "angle", angle)
        face = (outer_radius - inner_radius) / math.cos(angle)
        # the rounding takes edge_radius tan(angle/2) of the nose
        largest_edge = 0.9 * inner_radius / math.tan(0.5 * angle)
        edge = min(0.1 * face, largest_edge) if edge_radius is None else edge_radius
        return cls(angle, inner_radius, outer_radius, edge, outer_radius if height is None else height)

    @property
    def mean_radius(self) -> float:
        """Radius of the middle of the conical face [m]."""
        return 0.5 * (self.inner_radius + self.outer_radius)

    @property
    def outline(self) -> Outline:
        """Section with the nose at z = 0."""
        rise = (self.outer_radius - self.inner_radius) * math.tan(self.angle)
        corners = [(0.0, 0.0), (self.inner_radius, 0.0), (self.outer_radius, rise)]
        # Longer than the stem may be: whether the rounding leaves a stem is the plunger's to say.
        stem = (self.outer_radius, rise + self.height + self.outer_radius)
        face = chain([*corners, stem], "closure_face", self.edge_radius).without_last()
        return plunger(face, rise + self.height - face.segments[-1].end[1])

    @property
    def named_face(self) -> NamedFace:
        """The conical face between its rounded edges."""
        return straight_part("conical face", self.outline, self.angle)
