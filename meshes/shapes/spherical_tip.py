"""A rod with a spherical tip as closure."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.geometry.curve import Curve, Segment
from meshes.geometry.outline import Outline, rounded
from meshes.shapes.shape import (
    NamedFace,
    check_length,
    check_not_negative,
    check_positive,
    plunger,
    round_part,
)


@dataclass(frozen=True)
class SphericalTip:
    """Rod whose end is a spherical cap of larger radius, with a rounded edge.

    On a straight seat of inclination beta it touches at r0 = radius sin(beta), with R_rel = radius, like a ball.

    Parameters
    ----------
    radius : float
        Of the sphere [m].
    stem_radius : float
        Of the rod [m].
    edge_radius : float
        Of the rounding between cap and rod [m]; zero keeps the edge sharp.
    height : float
        From the upper edge of the cap before rounding to the top [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible, or the rounding does not fit.

    Examples
    --------
    >>> import meshes
    >>> print(f"{meshes.SphericalTip(0.03, 0.01, 1e-3, 0.02).outline.area * 1e6:.0f} mm^2 of section")
    211 mm^2 of section
    """

    radius: float
    stem_radius: float
    edge_radius: float
    height: float

    def __post_init__(self) -> None:
        check_positive("closure", radius=self.radius, stem_radius=self.stem_radius, height=self.height)
        stem, must = self.stem_radius, "must be below the radius of the tip, {}; a full half sphere is a ball"
        check_length("closure", "stem_radius", stem, stem < self.radius, must, self.radius)
        check_not_negative("closure", "edge_radius", self.edge_radius)

    @classmethod
    def of(
        cls,
        radius: float,
        stem_radius: float,
        *,
        edge_radius: float | None = None,
        height: float | None = None,
    ) -> SphericalTip:
        """Tip with the dimensions that are not given in proportion.

        Parameters
        ----------
        radius, stem_radius : float
            As of the class [m].
        edge_radius : float, optional
            A twentieth of the stem's radius unless given [m].
        height : float, optional
            The stem's radius unless given [m].
        """
        edge = 0.05 * stem_radius if edge_radius is None else edge_radius
        return cls(radius, stem_radius, edge, stem_radius if height is None else height)

    @property
    def outline(self) -> Outline:
        """Section with the tip at z = 0."""
        rise = self.stem_radius**2 / (self.radius + math.sqrt(self.radius**2 - self.stem_radius**2))
        shoulder, top = (self.stem_radius, rise), rise + self.height
        cap = Segment((0.0, 0.0), shoulder, "closure_face", (0.0, self.radius))
        # Longer than the stem may be: whether the rounding leaves a stem is the plunger's to say.
        side = Segment(shoulder, (self.stem_radius, top + self.stem_radius), "closure_face")
        face = rounded(Curve((cap, side)), self.edge_radius).without_last()
        return plunger(face, top - face.segments[-1].end[1])

    @property
    def named_face(self) -> NamedFace:
        """The spherical cap inside its rounded edge."""
        return round_part("spherical cap", self.outline, self.radius)
