"""Elastoplastic solids, Newton's method for them without contact, and a seal made of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from contact_models import STEEL, displacement_basis
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, MeshTri, MeshTri2

import meshes
from fem_seal.bodies.elasticity import assemble_elements, element_dofs, node_dofs
from fem_seal.bodies.elastoplastic import BodyState, ElastoplasticBody
from fem_seal.bodies.supports import Supports
from fem_seal.contact.laws import Law
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.sizing import element_sizes
from fem_seal.loads import contact_force, line_load
from fem_seal.materials import HardeningCurve, Material, effective_modulus
from leak import ExponentialLaw

YIELD, E, NU = 250e6, 210e9, 0.3
INNER, OUTER, HEIGHT = 0.01, 0.02, 0.002
PERFECT = Material("perfectly plastic", E, NU, hardening=HardeningCurve((0.0,), (YIELD,)))
CURVE = HardeningCurve((0.0, 0.002, 0.05), (YIELD, 1.3 * YIELD, 1.6 * YIELD))
HARDENING = Material("hardening", E, NU, hardening=CURVE)
LAW = ExponentialLaw(p_c=5e9, u0=0.76e-6)


@dataclass(frozen=True)
class HeldSolid(ElastoplasticBody):
    """A solid some of whose dofs are held."""

    free: np.ndarray = field(kw_only=True)

    @cached_property
    def basis(self) -> Basis:
        """Of its displacement, with all that scikit-fem knows of it."""
        return displacement_basis(self.mesh)

    def stiffness(self, tangent: np.ndarray) -> csc_matrix:
        """Of the free dofs with a given tangent (elements, points, 4, 4) at the quadrature points [N/m]."""
        local = self.element_stiffness(np.arange(len(self.weight)), tangent)
        whole = assemble_elements(local, element_dofs(self.mesh), node_dofs(self.mesh).size)
        return whole[self.free][:, self.free].tocsc()


def ring_solid(
    cells: int, material: Material = PERFECT, *, hold: tuple[str, ...] = ("flat",), inner: float = INNER
) -> HeldSolid:
    """Rectangle in the (r, z) half-plane; "flat" ends are held along z, "inner" and "outer" walls along r."""
    mesh = MeshTri.init_tensor(np.linspace(inner, OUTER, cells + 1), np.linspace(0, HEIGHT, 2))
    mesh = mesh.with_boundaries(
        {
            "inner": lambda x: np.isclose(x[0], inner),
            "outer": lambda x: np.isclose(x[0], OUTER),
            "flat": lambda x: np.isclose(x[1], 0) | np.isclose(x[1], HEIGHT),
            "bottom": lambda x: np.isclose(x[1], 0),
            "top": lambda x: np.isclose(x[1], HEIGHT),
        }
    )
    basis = displacement_basis(mesh)
    dofs = [basis.get_dofs(name).all([f"u^{1 if name in ('inner', 'outer') else 2}"]) for name in hold]
    return HeldSolid(mesh, material, free=np.setdiff1d(np.arange(basis.N), np.concatenate(dofs)))


def shell_solid(cells: int, material: Material = PERFECT) -> HeldSolid:
    """A quarter of a spherical shell's section with curved (quadratic) edges, symmetric to axis and equator."""
    radii, angles = np.linspace(INNER, OUTER, cells + 1), np.linspace(0, np.pi / 2, 2 * cells + 1)
    flat = MeshTri2.from_mesh(MeshTri.init_tensor(radii, angles))
    R, angle = flat.doflocs
    mesh = MeshTri2(R * np.stack([np.sin(angle), np.cos(angle)]), flat.t).with_boundaries(
        {
            "inner": lambda x: np.hypot(*x) < 1.01 * INNER,
            "axis": lambda x: x[0] < 1e-8,
            "equator": lambda x: x[1] < 1e-8,
        }
    )
    basis = displacement_basis(mesh)
    dofs = [basis.get_dofs("axis").all(["u^1"]), basis.get_dofs("equator").all(["u^2"])]
    return HeldSolid(mesh, material, free=np.setdiff1d(np.arange(basis.N), np.concatenate(dofs)))


def find_balance(
    body: HeldSolid,
    old_stress: BodyState,
    forces: np.ndarray | float = 0.0,
    start: np.ndarray | None = None,
    free_strain: np.ndarray | float = 0.0,
) -> tuple[BodyState, list[float]]:
    """State in balance with nodal forces after one step, and the relative residual of each Newton iteration.

    Held dofs stay where `start` puts them.
    """
    displacement = (old_stress.displacement if start is None else start).copy()
    residuals = []
    for _ in range(25):
        flow = body.respond(displacement, old_stress, free_strain)
        residual = (forces - body.internal_forces(flow.stress))[body.free]
        scale = np.abs(body.internal_forces(np.abs(flow.stress))).max() + np.abs(forces).max()
        residuals.append(float(np.abs(residual).max() / scale))
        if residuals[-1] < 1e-10:
            return BodyState(displacement, flow.stress, flow.state), residuals
        displacement[body.free] += spsolve(body.stiffness(flow.tangent), residual)
    raise AssertionError(f"no balance: {residuals}")


def seal(
    law: Law,
    fluid_pressure: float,
    *,
    closure: Material = STEEL,
    seat: Material = STEEL,
    refine: float = 0.5,
    wider: float = 1.0,
    supports: Supports | None = None,
) -> tuple[ContactModel, float]:
    """Ball on a cone: its model and the closing force."""
    ball = meshes.Ball(0.02)
    contact = meshes.ContactGeometry.of(
        ball.outline, meshes.ConicalSeat.around(math.radians(45), ball).outline
    )
    force = contact_force(contact.initial_contact_radius, fluid_pressure)
    load = line_load(force, contact.initial_contact_radius, contact.angle)
    sizing = element_sizes(law, [load], contact, effective_modulus(closure, seat)).refined(refine)
    sizing = replace(sizing, zone=(wider * sizing.zone[0], wider * sizing.zone[1]), core=wider * sizing.core)
    mesh = meshes.build_contact(contact, sizing)
    return condense(mesh, {"closure": closure, "seat": seat}, supports), force
