"""A steel ball on a steel cone, and the displacement of its bodies, for tests of several rooms."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import meshes
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.sizing import element_sizes
from fem_seal.loads import contact_force, line_load
from fem_seal.materials import Material

if TYPE_CHECKING:
    from skfem import Basis, MeshTri

STEEL = Material("steel", 210e9, 0.3)


def displacement_basis(mesh: MeshTri) -> Basis:
    """Of the quadratic displacement of a body, with all that scikit-fem knows of it."""
    from skfem import Basis, ElementTriP2, ElementVector

    return Basis(mesh, ElementVector(ElementTriP2()), intorder=4)


def ball_on_cone(
    law: object,
    fluid_pressures: list[float],
    *,
    radius: float = 0.02,
    angle: float = math.radians(45),
    closure: Material = STEEL,
    seat: Material = STEEL,
    refine: float = 1.0,
) -> tuple[ContactModel, list[float]]:
    """Model of a ball on a cone with the default mesh for these loads, and the axial forces of the loads."""
    from fem_seal.materials import effective_modulus

    ball, cone = meshes.Ball(radius), meshes.ConicalSeat.around(angle, meshes.Ball(radius))
    contact = meshes.ContactGeometry.of(ball.outline, cone.outline)
    forces = [contact_force(contact.initial_contact_radius, p) for p in fluid_pressures]
    loads = [line_load(force, contact.initial_contact_radius, angle) for force in forces]
    sizing = element_sizes(law, loads, contact, effective_modulus(closure, seat)).refined(refine)  # type: ignore[arg-type]
    return condense(meshes.build(ball, cone, sizing), {"closure": closure, "seat": seat}), forces


def out_of_plane(n: int, ratio: float = 1.3) -> float:
    """Deflection of a thin ring of radius and E I of one under cos n phi along its axis, with E I/(G J) = ratio.

    From the curvature T/R - w''/R^2 and the twist T'/R + w'/R^2 with the rotation T of the section, which takes no
    torque from the load.
    """
    return (1 + ratio / n**2) / (n**2 - 1) ** 2
