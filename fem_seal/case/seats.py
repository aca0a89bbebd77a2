"""The table [seat] of the case file: one model for each shape."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

import meshes
from fem_seal.case.bodies import (
    Body,
    Inclination,
    Length,
    MaterialField,
    Rounding,
    SmallLength,
    material_field,
)
from fem_seal.case.fields import Quantity, optional, required
from fem_seal.errors import Problem
from meshes import Shape

_NORMAL = (
    "between the axis and the contact normal; the half-angle of the cone, measured from the axis, is 90 deg "
    "minus this"
)


class Held(Body):
    """How a seat is held, whatever its shape."""

    material: MaterialField = material_field()
    wall: Literal["free", "fixed"] = Field(
        "free",
        description='outer wall of the housing: "free", or "fixed": held radially, free to slide along the axis; the '
        "bottom is always held along the axis",
    )
    interference: Annotated[float, Quantity("length", "0 um", "10 mm")] | None = optional(
        'with wall = "fixed": how far the wall is moved inwards, radial interference of a pressed-in seat, at '
        "most a hundredth of the wall's radius; none unless given",
        "20 um",
    )

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

    outer_radius: Length | None = optional(
        "radius of the housing; 1.5 times the closure's radius beyond the contact unless given", "40 mm"
    )
    height: Length | None = optional(
        "from the lower edge of the face to the bottom of the housing; 1.5 times the closure's radius unless given",
        "40 mm",
    )


class ConicalSeat(Housed):
    """[seat] shape = "cone": a conical seat in a cylindrical housing, held at its bottom."""

    makes = meshes.ConicalSeat.around

    shape: Literal["cone"] = required("shape of the seat", "cone")
    angle: Inclination = required(_NORMAL, "45 deg")
    bore_radius: Length | None = optional(
        "radius of the bore below the conical face; half the radius of first touch unless given", "10 mm"
    )
    face_radius: Length | None = optional(
        "radius of the upper edge of the conical face; the face ends 0.6 times the closure's radius beyond first "
        "touch unless given",
        "18 mm",
    )


class ConicalLand(Housed):
    """[seat] shape = "conical-land": a narrow conical face with rounded edges between bore and top."""

    makes = meshes.ConicalLand.around

    shape: Literal["conical-land"] = required("shape of the seat", "conical-land")
    angle: Inclination = required(_NORMAL, "45 deg")
    land_width: Length | None = optional(
        "width of the land along its slope, between its edges before rounding; a tenth of the radius of first touch "
        "unless given",
        "1 mm",
    )
    land_radius: Length | None = optional(
        "radius of the middle of the land; centred on first touch unless given", "14 mm"
    )
    edge_radius: SmallLength | None = optional(
        "rounding of both edges of the land; a tenth of its width unless given", "0.1 mm"
    )
    relief_angle: Annotated[float, Quantity("angle", "0 deg", "90 deg")] | None = optional(
        "inclination of the surface outside the land to the horizontal plane, below the angle of the land; a flat top, "
        "0 deg, unless given",
        "15 deg",
    )


class Sphere(Housed):
    """[seat] shape = "sphere": a hollow spherical seat, or one lapped around a circle with a larger radius."""

    makes = meshes.SphericalSeat.around

    shape: Literal["sphere"] = required("shape of the seat", "sphere")
    radius: Length = required("radius of the hollow section", "20.02 mm")
    contact_angle: Inclination | None = optional(
        "between the axis and the contact normal at which the closure touches: the centre of the section then lies "
        "(radius - R) sin(contact_angle) beyond the axis, R being the radius of the ball; the centre lies on the axis "
        "unless given",
        "45 deg",
    )
    bore_radius: Length | None = optional(
        "radius of the bore; half the radius of first touch unless given, half the ball's with the centre on the axis",
        "7 mm",
    )
    face_radius: Length | None = optional(
        "radius of the upper edge of the face; 1.35 times the radius of first touch unless given, nine tenths of the "
        "ball's with the centre on the axis; never beyond where the face is inclined by 75 deg",
        "18 mm",
    )
    edge_radius: SmallLength | None = optional(
        "rounding of both edges of the face; a twentieth of its width in r unless given", "0.2 mm"
    )


class ToroidalSeat(Housed):
    """[seat] shape = "torus": a convex ring of circular section on the top of the housing."""

    makes = meshes.ToroidalSeat.around

    shape: Literal["torus"] = required("shape of the seat", "torus")
    centre_radius: Length = required("distance of the centre of the ring's section from the axis", "14 mm")
    radius: Length = required("radius of the ring's section", "3 mm")
    bore_radius: Length | None = optional(
        "radius of the bore; the ring goes over into it smoothly, at centre_radius - radius, unless given, but not "
        "below half of centre_radius",
        "11 mm",
    )
    recess: SmallLength | None = optional(
        "how far the top outside the ring lies below its crest; half the ring's radius unless given", "1 mm"
    )


class Flat(Housed):
    """[seat] shape = "flat": a flat seat around a bore with a rounded edge."""

    makes = meshes.FlatSeat.on

    shape: Literal["flat"] = required("shape of the seat", "flat")
    bore_radius: Length | None = optional(
        "radius of the bore; half the radius of first touch unless given, needed for a closure that is lowest on the "
        "axis",
        "8 mm",
    )
    edge_radius: Rounding | None = optional(
        "rounding of the edge of the bore; a hundredth of the bore's radius unless given", "0.1 mm"
    )


class FlatLand(Housed):
    """[seat] shape = "flat-land": a raised flat ring between an inner and an outer radius, its edges rounded."""

    makes = meshes.FlatLand.on

    shape: Literal["flat-land"] = required("shape of the seat", "flat-land")
    land_inner_radius: Length = required(
        "radius of the inner edge of the land before rounding, and of the bore", "25 mm"
    )
    land_outer_radius: Length = required("radius of the outer edge of the land before rounding", "28 mm")
    edge_radius: Rounding | None = optional(
        "rounding of both edges of the land; a twentieth of its width unless given", "0.1 mm"
    )
    land_height: Length | None = optional(
        "how far the land is raised above the top of the housing around it; half its width unless given",
        "2 mm",
    )

    @property
    def bore_radius(self) -> float:
        """Radius of the bore [m]."""
        return self.land_inner_radius


class SharpEdge(Housed):
    """[seat] shape = "sharp-edge": the edge, with a small fillet, between a bore and a flat or sloping top."""

    makes = meshes.SharpEdge.around

    shape: Literal["sharp-edge"] = required("shape of the seat", "sharp-edge")
    bore_radius: Length = required("radius of the bore", "12 mm")
    edge_radius: Rounding | None = optional(
        "radius of the fillet; a hundredth of the bore's radius unless given", "0.1 mm"
    )
    top_angle: Annotated[float, Quantity("angle", "-90 deg", "90 deg", exclusive=True)] | None = optional(
        "inclination of the top to the horizontal plane, positive where it rises outwards; 0 deg unless given",
        "-30 deg",
    )
