"""A flat disc with a rounded rim as closure."""

from __future__ import annotations

from dataclasses import dataclass

from meshes.geometry.outline import Outline
from meshes.shapes.shape import NamedFace, check_length, check_positive, straight_part
from meshes.shapes.toroidal_edge import ToroidalEdge


@dataclass(frozen=True)
class Disc:
    """Flat disc, its lower rim rounded: a `ToroidalEdge` without recess.

    It touches a flat seat along the whole common ring (R_rel = inf) and a ring or an edge with a section of radius rho
    on the ring's crest (R_rel = rho); on a straight seat of inclination beta its rim touches at
    r0 = radius - edge_radius (1 - sin(beta)), with R_rel = edge_radius.

    Parameters
    ----------
    radius : float
        Of the disc [m].
    edge_radius : float
        Of the rounding of the lower rim [m].
    height : float
        Thickness of the disc [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible.

    Examples
    --------
    >>> import meshes
    >>> print(f"{meshes.Disc(radius=0.02, edge_radius=1e-3, height=0.01).outline.area * 1e6:.0f} mm^2 of section")
    200 mm^2 of section
    """

    radius: float
    edge_radius: float
    height: float

    def __post_init__(self) -> None:
        check_positive("closure", radius=self.radius, edge_radius=self.edge_radius, height=self.height)
        for key, size in (("radius", self.radius), ("height", self.height)):
            must = f"must be below the disc's {key} = {{}}"
            check_length("closure", "edge_radius", self.edge_radius, self.edge_radius < size, must, size)

    @classmethod
    def of(cls, radius: float, *, edge_radius: float | None = None, height: float | None = None) -> Disc:
        """Disc with the dimensions that are not given in proportion.

        Parameters
        ----------
        radius : float
            As of the class [m].
        edge_radius : float, optional
            A twentieth of the radius, at most a quarter of the height, unless given [m].
        height : float, optional
            Half the radius unless given [m].
        """
        check_positive("closure", radius=radius)
        height = 0.5 * radius if height is None else height
        return cls(radius, min(0.05 * radius, 0.25 * height) if edge_radius is None else edge_radius, height)

    @property
    def outline(self) -> Outline:
        """Section with the lower side at z = 0."""
        rim = ToroidalEdge(
            self.radius - self.edge_radius, self.edge_radius, 0.0, self.height - self.edge_radius
        )
        return rim.outline

    @property
    def named_face(self) -> NamedFace:
        """The flat face inside its rounded rim."""
        return straight_part("flat face", self.outline, 0.0)
