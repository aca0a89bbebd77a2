"""A flat seat with a bore."""

from __future__ import annotations

from meshes.errors import GeometryError
from meshes.shapes.shape import NamedFace, Partner, Shape, straight_part
from meshes.shapes.sharp_edge import SharpEdge


class FlatSeat(SharpEdge):
    """Flat top of a cylindrical housing around a bore with a rounded edge: a `SharpEdge` whose top is touched.

    A toroidal edge touches it at its lowest circle, r0 = centre_radius, R_rel = its radius; a flat disc along the whole
    common ring, R_rel = inf.

    Examples
    --------
    >>> import meshes
    >>> meshes.FlatSeat(0.01, 1e-3, 0.0, 0.03, 0.02).bore_radius
    0.01
    """

    @classmethod
    def on(
        cls,
        closure: Shape,
        *,
        bore_radius: float | None = None,
        edge_radius: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> FlatSeat:
        """Flat seat for a closure, with the dimensions that are not given in proportion to it.

        Parameters
        ----------
        closure : Shape
        bore_radius : float, optional
            Half the radius of first touch on a plane unless given [m].
        edge_radius : float, optional
            A hundredth of the bore's radius unless given [m].
        outer_radius, height : float, optional
            First touch + 1.5 L and 1.5 L unless given [m], with L the radius of the closure.

        Raises
        ------
        GeometryError
            If `bore_radius` is not given and the closure touches a plane on the axis.
        """
        partner = Partner(closure.outline)
        touch = partner.touch_on_cone(0.0)
        if bore_radius is None and not touch > 0:
            raise GeometryError(
                "seat bore_radius is missing: this closure touches a plane on the axis, so that the bore decides where "
                "contact is; give it"
            )
        bore = 0.5 * touch if bore_radius is None else bore_radius
        edge = 0.01 * bore if edge_radius is None else edge_radius
        return cls(bore, edge, 0.0, *partner.housing(touch, 1.1 * bore, outer_radius, height))

    @property
    def named_face(self) -> NamedFace:
        """The flat face around the rounded edge of the bore."""
        return straight_part("flat face", self.outline, 0.0)
