"""The table [seat] of the case file: one model for each shape."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

import meshes
from fem_seal.case.bodies import (
    Body,
    Inclination,
    Length,
    MaterialField,
    Rounding,
    SmallLength,
)
from fem_seal.case.fields import Quantity
from fem_seal.errors import Problem
from meshes import Shape

_NORMAL = (
    "between the axis and the contact normal; the half-angle of the cone, measured from the axis, is 90 deg "
    "minus this"
)


class Held(Body):
    """How a seat is held, whatever its shape."""

    material: MaterialField
    wall: Literal["free", "fixed"] = "free"
    interference: Annotated[float, Quantity("length", "0 um", "10 mm")] | None = None

    def problems(self) -> Iterator[Problem]:
        """A seat can only be pressed into something that holds it."""
        if self.interference and self.wall == "free":
            yield Problem(
                "seat.interference",
                'only with wall = "fixed", but wall = "free"; add wall = "fixed" or remove it',
                f"{1e6 * self.interference:.6g} um",
            )

    def body(self, closure: Shape) -> Shape:
        """The seat that is meshed, with the dimensions that are left open in proportion to the closure."""
        return self.made(closure=closure)


class Housed(Held):
    """A seat that is the top of a cylindrical housing with a bore."""

    outer_radius: Length | None = None
    height: Length | None = None


class ConicalSeat(Housed):
    """[seat] shape = "cone": a conical seat in a cylindrical housing, held at its bottom."""

    makes = meshes.ConicalSeat.around

    shape: Literal["cone"]
    angle: Inclination
    bore_radius: Length | None = None
    face_radius: Length | None = None


class ConicalLand(Housed):
    """[seat] shape = "conical-land": a narrow conical face with rounded edges between bore and top."""

    makes = meshes.ConicalLand.around

    shape: Literal["conical-land"]
    angle: Inclination
    land_width: Length | None = None
    land_radius: Length | None = None
    edge_radius: SmallLength | None = None
    relief_angle: Annotated[float, Quantity("angle", "0 deg", "90 deg")] | None = None


class Sphere(Housed):
    """[seat] shape = "sphere": a hollow spherical seat, or one lapped around a circle with a larger radius."""

    makes = meshes.SphericalSeat.around

    shape: Literal["sphere"]
    radius: Length
    contact_angle: Inclination | None = None
    bore_radius: Length | None = None
    face_radius: Length | None = None
    edge_radius: SmallLength | None = None


class ToroidalSeat(Housed):
    """[seat] shape = "torus": a convex ring of circular section on the top of the housing."""

    makes = meshes.ToroidalSeat.around

    shape: Literal["torus"]
    centre_radius: Length
    radius: Length
    bore_radius: Length | None = None
    recess: SmallLength | None = None


class Flat(Housed):
    """[seat] shape = "flat": a flat seat around a bore with a rounded edge."""

    makes = meshes.FlatSeat.on

    shape: Literal["flat"]
    bore_radius: Length | None = None
    edge_radius: Rounding | None = None


class FlatLand(Housed):
    """[seat] shape = "flat-land": a raised flat ring between an inner and an outer radius, its edges rounded."""

    makes = meshes.FlatLand.on

    shape: Literal["flat-land"]
    land_inner_radius: Length
    land_outer_radius: Length
    edge_radius: Rounding | None = None
    land_height: Length | None = None

    @property
    def bore_radius(self) -> float:
        """Radius of the bore [m]."""
        return self.land_inner_radius


class SharpEdge(Housed):
    """[seat] shape = "sharp-edge": the edge, with a small fillet, between a bore and a flat or sloping top."""

    makes = meshes.SharpEdge.around

    shape: Literal["sharp-edge"]
    bore_radius: Length
    edge_radius: Rounding | None = None
    top_angle: Annotated[float, Quantity("angle", "-90 deg", "90 deg", exclusive=True)] | None = None
