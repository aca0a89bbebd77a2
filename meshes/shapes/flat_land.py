"""A raised flat ring as seat."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.geometry.outline import Outline, chain
from meshes.shapes.shape import (
    NamedFace,
    Partner,
    Shape,
    check_exceeds,
    check_length,
    check_positive,
    housing,
    straight_part,
)


@dataclass(frozen=True)
class FlatLand:
    """Flat ring with rounded edges around a bore, raised above the top of a cylindrical housing.

    A flat disc touches it along the whole ring between the roundings, from land_inner_radius + edge_radius to
    land_outer_radius - edge_radius unless the disc ends before (R_rel = inf); a rim of circular section at its lowest
    circle (R_rel = its radius).

    Parameters
    ----------
    land_inner_radius, land_outer_radius : float
        Radii of the edges of the ring before rounding [m]; the former is that of the bore.
    edge_radius : float
        Of the rounding of both edges [m].
    land_height : float
        From the top of the housing around the ring to the ring [m].
    outer_radius : float
        Radius of the housing [m].
    height : float
        From the ring to the bottom of the housing [m].

    Raises
    ------
    GeometryError
        If a dimension is impossible, or the roundings do not fit.

    Examples
    --------
    >>> import meshes
    >>> land = meshes.FlatLand.on(0.025, 0.029, meshes.Disc.of(0.03))
    >>> land.land_inner_radius, land.land_outer_radius
    (0.025, 0.029)
    """

    land_inner_radius: float
    land_outer_radius: float
    edge_radius: float
    land_height: float
    outer_radius: float
    height: float

    def __post_init__(self) -> None:
        check_positive(
            "seat",
            land_inner_radius=self.land_inner_radius,
            edge_radius=self.edge_radius,
            land_height=self.land_height,
            height=self.height,
        )
        _check_land(self.land_inner_radius, self.land_outer_radius)
        width = self.land_outer_radius - self.land_inner_radius
        edge, must = self.edge_radius, "must be at least edge_radius = {}"
        all_round = (
            "the roundings of both edges leave nothing flat of a land {} wide; allowed is below half of it"
        )
        check_length("seat", "edge_radius", edge, 2 * edge < width, all_round, width)
        check_length("seat", "land_height", self.land_height, self.land_height >= edge, must, edge)
        fits = math.isfinite(self.outer_radius) and self.outer_radius >= self.land_outer_radius
        must = "must be at least land_outer_radius = {}"
        check_length("seat", "outer_radius", self.outer_radius, fits, must, self.land_outer_radius)

    @classmethod
    def on(
        cls,
        land_inner_radius: float,
        land_outer_radius: float,
        closure: Shape,
        *,
        edge_radius: float | None = None,
        land_height: float | None = None,
        outer_radius: float | None = None,
        height: float | None = None,
    ) -> FlatLand:
        """Land for a closure, with the dimensions that are not given in proportion.

        Parameters
        ----------
        land_inner_radius, land_outer_radius : float
            As of the class [m].
        closure : Shape
        edge_radius : float, optional
            A twentieth of the land's width unless given [m].
        land_height : float, optional
            Half the land's width unless given [m].
        outer_radius, height : float, optional
            Middle of the land + 1.5 L and 1.5 L unless given [m], with L the radius of the closure.
        """
        check_positive("seat", land_inner_radius=land_inner_radius, land_outer_radius=land_outer_radius)
        _check_land(land_inner_radius, land_outer_radius)
        width = land_outer_radius - land_inner_radius
        partner = Partner(closure.outline)
        edge = 0.05 * width if edge_radius is None else edge_radius
        rise = max(0.5 * width, edge) if land_height is None else land_height
        middle = 0.5 * (land_inner_radius + land_outer_radius)
        outer, high = partner.housing(middle, land_outer_radius, outer_radius, height)
        # the wall stands on the bottom, whatever the land's height
        high = max(high, 2 * rise) if height is None else height
        return cls(land_inner_radius, land_outer_radius, edge, rise, outer, high)

    @property
    def outline(self) -> Outline:
        """Section with the ring at z = 0."""
        bottom = -self.land_height - self.land_outer_radius
        corners = [
            (self.land_inner_radius, bottom),
            (self.land_inner_radius, 0.0),
            (self.land_outer_radius, 0.0),
            (self.land_outer_radius, bottom),
        ]
        face = chain(corners, "seat_face", self.edge_radius).without_first().without_last()
        start, end = face.segments[0].start, face.segments[-1].end
        return housing(face, self.outer_radius, self.height + start[1], self.land_height + end[1])

    @property
    def named_face(self) -> NamedFace:
        """The land between its rounded edges."""
        return straight_part("land", self.outline, 0.0)


def _check_land(inner_radius: float, outer_radius: float) -> None:
    check_exceeds("seat", "land_outer_radius", outer_radius, inner_radius, "land_inner_radius =")
