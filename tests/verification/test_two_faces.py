"""Half of a ring on its mid-plane against the whole ring, pressed on both of its faces at once, alike or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import block_diag, lil_matrix
from scipy.sparse.linalg import splu

import fem_seal
import leak
import meshes
from fem_seal.bodies.elasticity import node_dofs, quadratic_nodes, stiffness_matrix
from fem_seal.contact.sizing import element_sizes
from fem_seal.contact.solution import ContactSolution
from fem_seal.materials import effective_modulus

COPPER = fem_seal.Material("copper", 120e9, 0.34)
STEEL = fem_seal.Material("steel", 210e9, 0.3)
LAW = leak.ExponentialLaw(p_c=2e9, u0=0.4e-6)
FORCE = 6e3


def half_ring(face: meshes.Disc | meshes.FlangeFace, law: leak.ExponentialLaw) -> ContactSolution:
    """A flange face on the upper half of a solid ring of 4 mm on a diameter of 40 mm."""
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
    contact = meshes.ContactGeometry.of(face.outline, ring.outline)
    line_load = FORCE / (2 * np.pi * contact.initial_contact_radius * np.cos(contact.angle))
    modulus = effective_modulus(STEEL, COPPER)
    sizing = element_sizes(law, [line_load], contact, modulus).refined(0.5)
    model = fem_seal.condense(meshes.build_contact(contact, sizing), {"closure": STEEL, "seat": COPPER})
    return fem_seal.solve(model, law, contact_force=FORCE)


@pytest.fixture(scope="module")
def half() -> ContactSolution:
    return half_ring(meshes.Disc.of(0.03), LAW)


def tied(inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
    """Displacement of quadratic nodes on a line that follow those of other elements, by their places on it."""
    follow = np.zeros((len(outer), len(inner)))
    for row, at in zip(follow, outer, strict=True):
        first = min(2 * int(np.searchsorted(inner[2::2], at)), len(inner) - 3)
        a, b, c = inner[first : first + 3]
        row[first : first + 3] = (
            (at - b) * (at - c) / ((a - b) * (a - c)),
            (at - a) * (at - c) / ((b - a) * (b - c)),
            (at - a) * (at - b) / ((c - a) * (c - b)),
        )
    return follow


def compliance_of_both_faces(upper: ContactSolution, lower: ContactSolution) -> np.ndarray:
    """Retreat of the points of the upper and then of the lower face per unit normal force at each [m/N]."""
    halves = [upper.model.seat.fem, lower.model.seat.fem]
    blocks, places, offsets, forces, trace = [], [], [0], [], []
    for held, way in zip(halves, (1.0, -1.0), strict=True):
        dofs, at = node_dofs(held.mesh), quadratic_nodes(held.mesh)[0]
        blocks.append(stiffness_matrix(held.mesh, COPPER))
        places.append((dofs + offsets[-1], at[:, 0], at[:, 1] - held.mesh.p[1].min()))
        # the lower half is solved as its mirror image: the way of its nodes along the axis has the other sign
        forces.append((dofs[:, held.contact_nodes] + offsets[-1], held.normal, way))
        offsets.append(offsets[-1] + dofs.size)
        trace.append(held.trace)
    whole = block_diag(blocks).tocsc()
    # the mid-plane nodes of the lower half follow those of the upper one, mirrored
    (dofs, r, z), (slaves, r_slave, z_slave) = places
    middle, below = (np.flatnonzero(np.isclose(one, 0.0, rtol=0, atol=1e-12)) for one in (z, z_slave))
    middle, below = middle[np.argsort(r[middle])], below[np.argsort(r_slave[below])]
    follow = tied(r[middle], r_slave[below])
    own = np.setdiff1d(np.arange(whole.shape[0]), slaves[:, below].ravel())
    column = np.full(whole.shape[0], -1)
    column[own] = np.arange(len(own))
    tie = lil_matrix((whole.shape[0], len(own)))
    tie[own, column[own]] = 1.0
    for component, sign in ((0, 1.0), (1, -1.0)):
        for row, weights in zip(slaves[component, below], follow, strict=True):
            for master, weight in zip(dofs[component, middle], weights, strict=True):
                if weight:
                    tie[row, column[master]] = sign * weight
    tie = tie.tocsc()
    count = [len(nodes[0]) for nodes, _, _ in forces]
    loads = np.zeros((whole.shape[0], sum(count)))
    for first, (nodes, normal, _) in zip((0, count[0]), forces, strict=True):
        for component in range(2):
            loads[nodes[component], first + np.arange(nodes.shape[1])] = normal[component]
    # whatever is held against a force alone is held against none where both faces carry the same
    held_one = column[dofs[1, middle[len(middle) // 2]]]
    free = np.setdiff1d(np.arange(len(own)), [held_one])
    moved = np.zeros((len(own), loads.shape[1]))
    moved[free] = splu((tie.T @ whole @ tie)[free][:, free].tocsc()).solve((tie.T @ loads)[free])
    seen = loads.T @ (tie @ moved)
    kept = block_diag(trace).toarray()
    return kept @ seen @ kept.T


def pressures_of_both_faces(
    upper: ContactSolution, lower: ContactSolution, laws: tuple[leak.ExponentialLaw, leak.ExponentialLaw]
) -> tuple[np.ndarray, np.ndarray]:
    """Contact pressures of the whole ring, from a lower face that carries its force evenly at first."""
    both, lines = (upper, lower), [one.model.line for one in (upper, lower)]
    closures = [
        one.model.closure.fem.trace @ (one.model.closure.fem.trace @ one.model.closure.compliance.T).T
        for one in both
    ]
    compliance = compliance_of_both_faces(upper, lower) + block_diag(closures).toarray()
    weight = np.concatenate([line.area_weight for line in lines])
    faces = block_diag([line.normal[1][None] for line in lines]).toarray()
    gap0 = np.concatenate([line.initial_gap for line in lines])
    m = len(lines[0].x)
    even = np.log(FORCE / (lines[1].normal[1] @ lines[1].area_weight))
    v, d = np.concatenate([upper.log_pressure + 0.1, np.full(len(lines[1].x), even)]), np.zeros(2)
    for _ in range(80):
        f = weight * np.exp(v)
        parts = (slice(None, m), slice(m, None))
        decay = np.concatenate([law.decay_length(v[one]) for law, one in zip(laws, parts, strict=True)])
        law_gap = np.concatenate([law.gap(v[one]) for law, one in zip(laws, parts, strict=True)])
        residual, missing = gap0 - faces.T @ d + compliance @ f - law_gap, FORCE - faces @ f
        # d(residual) = (C diag(f) + decay) dv - faces^T dd
        matrix = np.block([[compliance * f + np.diag(decay), -faces.T], [faces * f, np.zeros((2, 2))]])
        step = np.linalg.solve(matrix, np.concatenate([-residual, missing]))
        v += np.where(step[:-2] > 0, np.log1p(np.maximum(step[:-2], 0)), step[:-2])
        d += step[-2:]
        if np.abs(step[:-2]).max() < 1e-12:
            break
    assert faces @ (weight * np.exp(v)) == pytest.approx([FORCE, FORCE], rel=1e-9)
    return np.exp(v[:m]), np.exp(v[m:])


def test_half_a_ring_has_the_pressure_of_both_faces_of_the_whole(half: ContactSolution) -> None:
    peak = half.pressure.max()
    for found in pressures_of_both_faces(half, half, (LAW, LAW)):
        assert found / peak == pytest.approx(half.pressure / peak, abs=1e-6)


SOFT = leak.ExponentialLaw(p_c=2e9, u0=1.6e-6)


@pytest.mark.parametrize(
    ("face", "law"),
    [
        (meshes.Disc.of(0.03), SOFT),
        (meshes.FlangeFace.conical(np.radians(20), 0.017, 0.024), LAW),
    ],
    ids=["rougher", "conical"],
)
def test_two_different_faces_hardly_feel_each_other(
    half: ContactSolution, face: meshes.Disc | meshes.FlangeFace, law: leak.ExponentialLaw
) -> None:
    """The conical one turns the section of the ring: its contacts move, with the same pressure."""
    lower = half_ring(face, law)
    found = pressures_of_both_faces(half, lower, (LAW, law))
    for pressure, alone in zip(found, (half, lower), strict=True):
        assert pressure.max() == pytest.approx(alone.pressure.max(), rel=1e-3)
        profile = replace(alone.profile, pressure=pressure)
        assert profile.std == pytest.approx(alone.profile.std, rel=1e-3)
