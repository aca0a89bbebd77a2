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
)
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

    shape: Literal["ball"]
    radius: Length
    cavity_radius: Length | None = None
    material: MaterialField


class RoundedCone(Closure):
    """[closure] shape = "cone": a poppet, a conical face with rounded edges between a flat nose and a stem."""

    makes = meshes.RoundedCone.of

    shape: Literal["cone"]
    angle: Inclination
    outer_radius: Length | None = None
    inner_radius: Length | None = None
    mean_radius: Length | None = None
    edge_radius: SmallLength | None = None
    height: Length | None = None
    material: MaterialField

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

    shape: Literal["torus"]
    centre_radius: Length
    radius: Length
    recess: SmallLength | None = None
    height: Length | None = None
    material: MaterialField


class SphericalTip(Closure):
    """[closure] shape = "spherical-tip": a rod whose end is a spherical cap of larger radius."""

    makes = meshes.SphericalTip.of

    shape: Literal["spherical-tip"]
    radius: Length
    stem_radius: Length
    edge_radius: SmallLength | None = None
    height: Length | None = None
    material: MaterialField


class Disc(Closure):
    """[closure] shape = "disc": a flat disc with a rounded rim."""

    makes = meshes.Disc.of

    shape: Literal["disc"]
    radius: Length
    edge_radius: Rounding | None = None
    height: Length | None = None
    material: MaterialField
