"""The table [closure] of the case file: one model for each shape."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

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
from fem_seal.case.fields import optional, required
from fem_seal.errors import Problem
from meshes import Shape


class Closure(Body):
    """A closure of any shape."""

    def body(self) -> Shape:
        """The closure that is meshed."""
        return self.made()


class Ball(Closure):
    """[closure] shape = "ball": a ball, solid or hollow."""

    makes = meshes.Ball

    shape: Literal["ball"] = required("shape of the closure", "ball")
    radius: Length = required("radius R of the ball", "20 mm")
    cavity_radius: Length | None = optional(
        "radius of the cavity of a hollow ball; solid unless given", "15 mm"
    )
    material: MaterialField = material_field()


class RoundedCone(Closure):
    """[closure] shape = "cone": a poppet, a conical face with rounded edges between a flat nose and a stem."""

    makes = meshes.RoundedCone.of

    shape: Literal["cone"] = required("shape of the closure", "cone")
    angle: Inclination = required(
        "inclination of the conical face to the horizontal plane, the angle between the axis and its "
        "normal (as seat.angle); the half-angle of the cone is 90 deg minus this",
        "45 deg",
    )
    outer_radius: Length | None = optional(
        "radius of the upper edge of the face before rounding, and of the stem; one or two of outer_radius, "
        "inner_radius and mean_radius are needed; twice the inner radius unless given",
        "20 mm",
    )
    inner_radius: Length | None = optional(
        "radius of the lower edge of the face before rounding; half the outer radius unless given", "10 mm"
    )
    mean_radius: Length | None = optional(
        "radius of the middle of the face; the mean of the other two", "15 mm"
    )
    edge_radius: SmallLength | None = optional(
        "rounding of both edges; a tenth of the length of the face unless given, less for a narrow nose",
        "1 mm",
    )
    height: Length | None = optional(
        "length of the stem above the face; the outer radius unless given", "20 mm"
    )
    material: MaterialField = material_field()

    def problems(self) -> Iterator[Problem]:
        """What is wrong with the radii together."""
        known = [key for key in ("outer_radius", "inner_radius", "mean_radius") if getattr(self, key)]
        if not 1 <= len(known) <= 2:
            which = "none is given" if not known else "all three are given"
            yield Problem(
                "closure.outer_radius",
                f"one or two of outer_radius, inner_radius and mean_radius are needed, but {which}",
            )


class ToroidalEdge(Closure):
    """[closure] shape = "torus": a plunger whose rim has a circular section."""

    makes = meshes.ToroidalEdge.of

    shape: Literal["torus"] = required("shape of the closure", "torus")
    centre_radius: Length = required("distance of the centre of the rim's section from the axis", "15 mm")
    radius: Length = required(
        "radius of the rim's section; the plunger's own radius is centre_radius + radius", "3 mm"
    )
    recess: SmallLength | None = optional(
        "how far the flat inside the rim lies above the rim's lowest circle; half the radius unless given, less where "
        "the rim would begin within half the centre_radius",
        "1 mm",
    )
    height: Length | None = optional(
        "from the widest circle of the rim to the top; the plunger's radius unless given", "10 mm"
    )
    material: MaterialField = material_field()


class SphericalTip(Closure):
    """[closure] shape = "spherical-tip": a rod whose end is a spherical cap of larger radius."""

    makes = meshes.SphericalTip.of

    shape: Literal["spherical-tip"] = required("shape of the closure", "spherical-tip")
    radius: Length = required("radius of the cap", "30 mm")
    stem_radius: Length = required("radius of the rod, below that of the cap", "20 mm")
    edge_radius: SmallLength | None = optional(
        "rounding between cap and rod; a twentieth of stem_radius unless given", "1 mm"
    )
    height: Length | None = optional("length of the rod above the cap; stem_radius unless given", "20 mm")
    material: MaterialField = material_field()


class Disc(Closure):
    """[closure] shape = "disc": a flat disc with a rounded rim."""

    makes = meshes.Disc.of

    shape: Literal["disc"] = required("shape of the closure", "disc")
    radius: Length = required("radius of the disc", "20 mm")
    edge_radius: Rounding | None = optional(
        "rounding of the lower rim; a twentieth of the radius, at most a quarter of the height, unless given",
        "1 mm",
    )
    height: Length | None = optional("thickness of the disc; half its radius unless given", "10 mm")
    material: MaterialField = material_field()
