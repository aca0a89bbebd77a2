"""A stiffness condensed part by part against the factorised whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contact_models import STEEL
from factorised_whole import contact_compliance
from plastic_solids import HARDENING, LAW, HeldSolid, seal

import meshes
from fem_seal.bodies.constrained_body import ConstrainedBody, constrained_body
from fem_seal.bodies.dissected_body import DissectedBody, Dissection
from fem_seal.bodies.elasticity import stiffness_matrix
from fem_seal.bodies.elastoplastic import ElastoplasticBody, StressUpdate
from fem_seal.contact.load_path import load_path
from fem_seal.contact.model import line_points
from fem_seal.contact.plastic_step import PathLoad


def chain(size: int, springs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Springs in a row between two walls: unknowns and stiffness of each, and the whole matrix."""
    unknowns = np.stack([np.arange(-1, size), np.append(np.arange(size), -1)], axis=1)
    local = springs[:, None, None] * np.array([[1.0, -1.0], [-1.0, 1.0]])
    whole = np.zeros((size + 1, size + 1))
    for pair, one in zip(unknowns, local, strict=True):
        whole[np.ix_(pair, pair)] += one  # held ones are the last row
    return unknowns, local, whole[:-1, :-1]


@pytest.mark.slow
@pytest.mark.parametrize("places", [[0], [170, 3, 88], list(range(200))])
def test_springs_in_a_row(places: list[int]) -> None:
    random = np.random.default_rng(5)
    stiff = random.uniform(1, 2, 201)
    unknowns, elastic, _ = chain(200, stiff)
    at = np.arange(201.0)[:, None]
    dissection = Dissection.of(unknowns, at, places, 200, elastic)
    assert len(dissection.parts) > 3
    for changed in (np.zeros(201, bool), at[:, 0] > 150, random.uniform(size=201) < 0.03, np.ones(201, bool)):
        _, local, whole = chain(200, np.where(changed, 0.2 * stiff, stiff))
        inverse, solve = dissection.condense(changed, lambda numbers, local=local: local[numbers])
        exact = np.linalg.inv(whole)
        # condition number some 1e4
        assert inverse == pytest.approx(exact[np.ix_(places, places)], rel=1e-10)
        right = random.normal(size=(200, 3))
        assert solve(right) == pytest.approx(exact @ right, abs=1e-10 * np.abs(exact @ right).max())
        assert solve(right[:, 0]) == pytest.approx(
            solve(right)[:, 0], abs=1e-12 * np.abs(exact @ right).max()
        )


def test_what_is_not_positive_definite_is_said() -> None:
    unknowns, local, _ = chain(200, np.ones(201))
    local[100:102] *= -1
    with pytest.raises(RuntimeError, match="not positive definite"):
        Dissection.of(unknowns, np.arange(201.0)[:, None], [7], 200, np.abs(local)).condense(
            np.ones(201, bool), lambda numbers: local[numbers]
        )


def body_of(name: str) -> ConstrainedBody:
    ball = meshes.Ball(0.02)
    sizing = meshes.Sizing(4e-5, 1e-4, (-1e-3, 1e-3), 0.3, 0.4, 4e-3)
    mesh = meshes.build(ball, meshes.ConicalSeat.around(0.785, ball), sizing)
    return constrained_body(mesh, name, HARDENING, *line_points(mesh))


def flowing(solid: ElastoplasticBody, share: float) -> StressUpdate:
    """An answer of the material in which some elements flow."""
    random = np.random.default_rng(2)
    displacement = 1e-6 * random.normal(size=solid.virgin.displacement.size)
    displacement[:: max(1, round(1 / share))] *= 30
    return solid.respond(displacement, solid.virgin)


@pytest.mark.parametrize("name", ["closure", "seat"])
def test_a_body_in_parts_is_the_whole_one(name: str) -> None:
    held = body_of(name)
    solid = HeldSolid(held.mesh, HARDENING, free=held.free)
    flow = flowing(solid, 0.01)
    assert 0 < flow.yielding.any(axis=1).mean() < 1
    whole, solve_whole = contact_compliance(held, solid.stiffness(flow.tangent))
    parts, solve_parts = DissectedBody(held, solid).condense(flow)
    assert parts == pytest.approx(whole, abs=1e-10 * np.abs(whole).max())
    forces = np.random.default_rng(1).normal(size=(len(held.free), 2))
    moved = solve_whole(forces)
    assert solve_parts(forces) == pytest.approx(moved, abs=1e-9 * np.abs(moved).max())


@pytest.mark.parametrize("name", ["closure", "seat"])
def test_an_elastic_body_in_parts_is_the_whole_one(name: str) -> None:
    held = body_of(name)
    free = stiffness_matrix(held.mesh, held.material)[held.free][:, held.free].tocsc()
    whole, solve_whole = contact_compliance(held, free)
    parts, solve_parts = DissectedBody(held).elastic()
    assert parts == pytest.approx(whole, abs=1e-12 * np.abs(whole).max())
    forces = np.random.default_rng(1).normal(size=(len(held.free), 3))
    moved = solve_whole(forces)
    assert solve_parts(forces) == pytest.approx(moved, abs=1e-11 * np.abs(moved).max())
    assert solve_parts(forces[:, 1]) == pytest.approx(moved[:, 1], abs=1e-11 * np.abs(moved).max())


def test_nodes_that_are_held_one_way_are_not_turned() -> None:
    held = body_of("seat")
    nodes = held.contact_dofs
    # one that slides along z, one along r, one that stands
    fixed = np.array([nodes[0, 4], nodes[1, 9], *nodes[:, 13]])
    held = replace(held, free=np.setdiff1d(held.free, fixed))
    solid = HeldSolid(held.mesh, HARDENING, free=held.free)
    flow = flowing(solid, 0.01)
    whole, solve_whole = contact_compliance(held, solid.stiffness(flow.tangent))
    parts, solve_parts = DissectedBody(held, solid).condense(flow)
    assert parts == pytest.approx(whole, abs=1e-10 * np.abs(whole).max())
    assert not parts[13].any()
    forces = np.random.default_rng(1).normal(size=len(held.free))
    assert solve_parts(forces) == pytest.approx(
        solve_whole(forces), abs=1e-9 * np.abs(solve_whole(forces)).max()
    )


@pytest.mark.slow
def test_a_path_is_that_of_the_factorised_bodies(monkeypatch: pytest.MonkeyPatch) -> None:
    """Up, beyond where the plastic zone was, and down again."""
    model, force = seal(LAW, 600e5, closure=STEEL, seat=HARDENING, refine=0.7)
    loads = [PathLoad(share * force) for share in (0.5, 1.0, 0.5)]
    parts = load_path(model, LAW, loads, unload=False).contacts

    def whole(body: DissectedBody, flow: StressUpdate) -> object:
        solid = HeldSolid(body.fem.mesh, body.fem.material, free=body.fem.free)
        return contact_compliance(body.fem, solid.stiffness(flow.tangent))

    monkeypatch.setattr(DissectedBody, "condense", whole)
    for one, other in zip(parts, load_path(model, LAW, loads, unload=False).contacts, strict=True):
        assert one.states["seat"].plastic.accumulated_strain.max() > 1e-4
        assert one.pressure == pytest.approx(other.pressure, abs=1e-9 * other.pressure.max())
        accumulated = other.states["seat"].plastic.accumulated_strain
        assert one.states["seat"].plastic.accumulated_strain == pytest.approx(
            accumulated, abs=1e-9 * accumulated.max()
        )
