"""Half of a ring on its mid-plane against the whole ring, pressed on both of its faces at once."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import splu

import fem_seal
import leak
import meshes
from fem_seal.bodies.elasticity import node_dofs, quadratic_nodes, stiffness_matrix
from fem_seal.contact.sizing import element_sizes
from fem_seal.contact.solution import ContactSolution
from fem_seal.materials import effective_modulus
from meshes.mesh.triangles import Triangles

COPPER = fem_seal.Material("copper", 120e9, 0.34)
STEEL = fem_seal.Material("steel", 210e9, 0.3)
LAW = leak.ExponentialLaw(p_c=2e9, u0=0.4e-6)
FORCE = 6e3


@pytest.fixture(scope="module")
def half() -> ContactSolution:
    """A disc on the upper half of a solid ring of 4 mm on a diameter of 40 mm."""
    ring = meshes.Profile(
        "seat",
        (
            meshes.Segment((0.018, 0.0), (0.022, 0.0), "bottom"),
            meshes.Segment((0.022, 0.0), (0.022, 0.2e-3), "wall"),
            meshes.Segment((0.022, 0.2e-3), (0.020, 2.2e-3), "", centre=(0.020, 0.2e-3)),
            meshes.Segment((0.020, 2.2e-3), (0.018, 0.2e-3), "", centre=(0.020, 0.2e-3)),
            meshes.Segment((0.018, 0.2e-3), (0.018, 0.0), "inner"),
        ),
    )
    contact = meshes.ContactGeometry.of(meshes.Disc.of(0.03).outline, ring.outline)
    line_load = FORCE / (2 * np.pi * contact.initial_contact_radius)
    modulus = effective_modulus(STEEL, COPPER)
    sizing = element_sizes(LAW, [line_load], contact, modulus).refined(0.5)
    model = fem_seal.condense(meshes.build_contact(contact, sizing), {"closure": STEEL, "seat": COPPER})
    return fem_seal.solve(model, LAW, contact_force=FORCE)


def compliance_of_both_faces(contact: ContactSolution) -> np.ndarray:
    """Retreat of the points of the upper and then of the lower face per unit normal force at each [m/N]."""
    held = contact.model.seat.held
    p, t = held.mesh.p, held.mesh.t
    bottom = p[1].min()
    # the lower half is the mirror image, and has the nodes of the mid-plane in common
    middle = np.isclose(p[1], bottom, rtol=0, atol=1e-12)
    number = np.where(middle, np.arange(p.shape[1]), -1)
    number[~middle] = p.shape[1] + np.arange((~middle).sum())
    mirrored = np.array([p[0, ~middle], 2 * bottom - p[1, ~middle]])
    whole = Triangles(
        np.ascontiguousarray(np.hstack([p, mirrored])),
        np.ascontiguousarray(np.hstack([t, number[t[[0, 2, 1]]]])),
    )
    places = quadratic_nodes(whole)[0]
    upper = quadratic_nodes(held.mesh)[0][held.contact_nodes]
    lower = np.column_stack([upper[:, 0], 2 * bottom - upper[:, 1]])
    nodes = [int(np.argmin(np.hypot(*(places - at).T))) for at in (*upper, *lower)]
    dofs = node_dofs(whole)
    # whatever is held against a force alone is held against none where both faces carry the same
    pinned = dofs[1, int(np.argmin(np.hypot(*(places - [0.02, bottom]).T)))]
    free = np.setdiff1d(np.arange(dofs.size), [pinned])
    normal = np.hstack([held.normal, held.normal * [[1.0], [-1.0]]])
    forces = np.zeros((dofs.size, len(nodes)))
    forces[dofs[0, nodes], np.arange(len(nodes))] = normal[0]
    forces[dofs[1, nodes], np.arange(len(nodes))] = normal[1]
    stiffness = stiffness_matrix(whole, COPPER)[free][:, free].tocsc()
    moved = np.zeros_like(forces)
    moved[free] = splu(stiffness).solve(forces[free])
    seen = normal[0][:, None] * moved[dofs[0, nodes]] + normal[1][:, None] * moved[dofs[1, nodes]]
    trace = np.kron(np.eye(2), held.trace.toarray())
    return trace @ seen @ trace.T


def test_half_a_ring_has_the_pressure_of_both_faces_of_the_whole(half: ContactSolution) -> None:
    model, line, m = half.model, half.model.line, len(half.model.line.x)
    closure = model.closure.held.trace @ (model.closure.held.trace @ model.closure.compliance.T).T
    compliance = compliance_of_both_faces(half) + np.kron(np.eye(2), closure)
    weight, n_z = np.tile(line.area_weight, 2), np.tile(line.normal[1], 2)
    faces = np.kron(np.eye(2), line.normal[1])
    gap0 = np.tile(line.initial_gap, 2)
    # from two faces that are as different as can be: the lower one carries its force evenly
    even = np.log(FORCE / (line.normal[1] @ line.area_weight))
    v, d = np.concatenate([half.log_pressure + 0.1, np.full(m, even)]), np.zeros(2)
    for _ in range(60):
        f = weight * np.exp(v)
        gap = gap0 - faces.T @ d + compliance @ f
        decay = LAW.decay_length(v)
        residual, missing = gap - LAW.gap(v), FORCE - faces @ f
        # d(residual) = (C diag(f) + decay) dv - faces^T dd
        matrix = np.block([[compliance * f + np.diag(decay), -faces.T], [faces * f, np.zeros((2, 2))]])
        step = np.linalg.solve(matrix, np.concatenate([-residual, missing]))
        v += np.where(step[:-2] > 0, np.log1p(np.maximum(step[:-2], 0)), step[:-2])
        d += step[-2:]
        if np.abs(step[:-2]).max() < 1e-12:
            break
    peak = half.pressure.max()
    assert np.exp(v[:m]) / peak == pytest.approx(half.pressure / peak, abs=1e-6)
    assert np.exp(v[m:]) / peak == pytest.approx(half.pressure / peak, abs=1e-6)
    assert n_z[m:] @ (weight[m:] * np.exp(v[m:])) == pytest.approx(FORCE, rel=1e-9)
