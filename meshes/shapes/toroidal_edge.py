"""A disc or plunger whose rim is a circular arc, as closure."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.geometry.curve import Curve, Segment
from meshes.geometry.outline import Outline
from meshes.shapes.shape import NamedFace, check_length, check_positive, plunger, round_part


@dataclass(frozen=True)
class ToroidalEdge:
    """Plunger with a rim of circular section around the circle (centre_radius, radius above the lowest point).

    On a straight seat of inclination beta it touches at r0 = centre_radius + radius sin(beta), with R_rel = radius;
    on a seat with an arc of radius rho around the circle c (convex) the normal stands at sin(beta) =
    (c - centre_radius)/(radius + rho) and 1/R_rel = 1/radius + 1/rho.

    Parameters
    ----------
    centre_radius : float
        Distance a of the arc's centre from the axis [m].
    radius : float
        Radius of the arc [m]; the plunger's own radius is centre_radius + radius.
    recess : float
        Depth of the flat inside the rim above the rim's lowest point [m]; zero makes the closure a flat disc with
        rounded rim.
    height : float
        From the widest circle of the rim to the top [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible.

    Examples
    --------
    >>> import meshes
    >>> print(f"{meshes.ToroidalEdge(0.014, 2e-3, 0.0, 0.01).outline.area * 1e6:.0f} mm^2 of section")
    191 mm^2 of section
    """

    centre_radius: float
    radius: float
    recess: float
    height: float

    def __post_init__(self) -> None:
        check_positive("closure", centre_radius=self.centre_radius, radius=self.radius, height=self.height)
        most = self.deepest_recess(self.centre_radius, self.radius)
        must = "must lie between 0 and {}, where the rim reaches the axis or stands upright"
        check_length("closure", "recess", self.recess, 0 <= self.recess <= most * (1 + 1e-12), must, most)

    @classmethod
    def of(
        cls, centre_radius: float, radius: float, *, recess: float | None = None, height: float | None = None
    ) -> ToroidalEdge:
        """Rim with the dimensions that are not given in proportion.

        Parameters
        ----------
        centre_radius, radius : float
            As of the class [m].
        recess : float, optional
            Half the arc's radius, less where the rim would otherwise begin within half the centre radius [m].
        height : float, optional
            The plunger's radius unless given [m].
        """
        check_positive("closure", centre_radius=centre_radius, radius=radius)
        if recess is None:
            recess = min(radius / 2, cls.deepest_recess(centre_radius / 2, radius))
        return cls(centre_radius, radius, recess, centre_radius + radius if height is None else height)

    @staticmethod
    def deepest_recess(width: float, radius: float) -> float:
        """Depth of the flat at which the arc begins `width` inside its centre [m]."""
        return radius if width >= radius else radius - math.sqrt(radius**2 - width**2)

    @property
    def outline(self) -> Outline:
        """Section with the lowest point of the rim at z = 0."""
        a, rho = self.centre_radius, self.radius
        centre = (a, rho)
        inner = (a - math.sqrt(max(self.recess * (2 * rho - self.recess), 0.0)), self.recess)
        arc = Segment((a, 0.0), (a + rho, rho), "closure_face", centre)
        start, bend = (inner, centre) if self.recess > 0 else ((0.0, 0.0), None)
        return plunger(Curve((Segment(start, (a, 0.0), "closure_face", bend), arc)), self.height)

    @property
    def named_face(self) -> NamedFace:
        """The rim of circular section."""
        return round_part("round rim", self.outline, self.radius)
