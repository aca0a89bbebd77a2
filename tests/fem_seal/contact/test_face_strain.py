"""Elastic strain of the faces in their plane, which makes asperities softer or harder."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import fem_seal
import meshes
from fem_seal.bodies.elasticity import elasticity_matrix, without_free_strain
from fem_seal.bodies.supports import Supports
from fem_seal.contact.load_path import load_path
from fem_seal.contact.model import BodyLoads
from fem_seal.contact.plastic_step import PathLoad
from fem_seal.contact.solution import strain_together
from fem_seal.materials import HardeningCurve
from leak import ExponentialLaw

BALL = meshes.Ball(0.02)
CONE = meshes.ConicalSeat.around(0.785, BALL)
SIZING = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
LAW = ExponentialLaw(p_c=1e9, u0=0.4e-6)


@cache
def model(poissons_ratio: float = 0.3, of_seat: float = 210e9) -> fem_seal.ContactModel:
    steel = fem_seal.Material("steel", 210e9, poissons_ratio)
    materials = {"closure": steel, "seat": replace(steel, youngs_modulus=of_seat)}
    return fem_seal.condense(meshes.build(BALL, CONE, SIZING), materials, Supports(wall="fixed"))


@pytest.mark.parametrize("poissons_ratio", [0.0, 0.15, 0.3, 0.45])
def test_a_line_contact_presses_the_metal_together_along_it(poissons_ratio: float) -> None:
    """On a half-plane under any pressure the stress along the face is the pressure: -(1 + nu)(1 - 2 nu) p/E."""
    of = model(poissons_ratio)
    contact = fem_seal.solve(of, LAW, contact_force=1e4)
    pressure, scale = contact.pressure, contact.pressure.max() / 210e9
    pressed = pressure > 0.5 * pressure.max()
    for body in of.bodies.values():
        along, around = body.elastic_strain(contact.line_forces, {}).T[:, pressed]
        plane = -(1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio) * pressure[pressed] / 210e9
        assert np.abs(along - plane).max() < 0.06 * scale
        assert np.abs(around).max() < 0.15 * scale


@pytest.mark.parametrize(
    ("name", "loads"),
    [
        ("closure", {0: 3e7}),
        ("seat", {0: 3e7, 1: 1e7}),
        ("seat", {"wall": 1e-5}),
        ("closure", {"expansion": 1e-3, 0: 3e7}),
    ],
)
def test_strain_is_that_of_the_stress_inside(name: str, loads: dict[str | int, float]) -> None:
    """Stress recovered at the nodes, by Hooke's law and turned into the face."""
    of, forces = model(), np.zeros(len(model().line.x))
    body = of.bodies[name]
    there = BodyLoads(**{name: loads})
    displacement = there.displacement(body, of)
    stress = without_free_strain(body.recovery.stress(displacement), body.material, there.free_strain(body))
    strain = np.linalg.solve(elasticity_matrix(body.material), stress.T)[:, body.fem.contact_nodes]
    n_r, n_z = body.fem.normal
    in_plane = (
        strain[0] * n_z**2 + strain[1] * n_r**2 - strain[3] * n_r * n_z,
        strain[2],
    )
    found = body.elastic_strain(forces, loads)
    middle = np.abs(of.line.x) < 5e-4
    for part, expected in zip(found.T, in_plane, strict=True):
        inside = (body.fem.trace @ expected)[middle]
        assert part[middle] == pytest.approx(inside, rel=0.05, abs=0.01 * np.abs(inside).max())


def test_metal_that_grows_freely_has_no_elastic_strain() -> None:
    of = model()
    found = of.closure.elastic_strain(np.zeros(len(of.line.x)), {"expansion": 1e-3})
    assert np.abs(found).max() < 1e-12


def test_a_stiffer_body_is_strained_less_but_by_its_wall_as_much() -> None:
    seat, forces = model().seat, np.full(len(model().line.x), 10.0)
    for loads, share in (({0: 1e7}, 0.5), ({"wall": 1e-5}, 1.0)):
        more, less = (body.elastic_strain(0.0 * forces, loads) for body in (seat, seat.stiffer(2.0)))
        assert less == pytest.approx(share * more, rel=1e-12, abs=1e-20)
    assert seat.stiffer(2.0).elastic_strain(forces, {}) == pytest.approx(
        0.5 * seat.elastic_strain(forces, {}), rel=1e-12, abs=1e-20
    )


def test_the_body_that_is_strained_more_counts() -> None:
    contact = fem_seal.solve(model(0.3, 105e9), LAW, contact_force=1e4)
    of_seat = model(0.3, 105e9).seat.elastic_strain(contact.line_forces, {})
    pressed = contact.pressure > 0.5 * contact.pressure.max()
    assert contact.strain is not None
    assert contact.strain[pressed, :2] == pytest.approx(0.5 * of_seat[pressed])
    assert contact.strain[pressed, 2] == pytest.approx(of_seat[pressed].sum(axis=1))


def test_after_a_larger_load_the_strain_is_that_of_the_present_one() -> None:
    """As a fluid between the surfaces finds it, which knows no more of the earlier contact than its pressure."""
    high, low = (fem_seal.solve(model(), LAW, contact_force=force) for force in (2e4, 5e3))
    first, after = low.strain, low.after(high).strain
    assert first is not None and after is not None
    assert np.array_equal(first, after)


def test_strains_of_several_contacts_at_once_are_those_of_each() -> None:
    """Under loads of their own, one without any, and one on other bodies."""
    loads = (BodyLoads(), BodyLoads(closure={0: 3e7}), BodyLoads(closure={0: 1e7}, seat={"wall": 1e-5}))
    models = (model(), model(), model(), model(0.3, 105e9))
    each, together = (
        [
            fem_seal.solve(of, LAW, contact_force=5e3, loads=on_bodies)
            for of, on_bodies in zip(models, (*loads, BodyLoads()), strict=True)
        ]
        for _ in range(2)
    )
    strain_together(together)
    for contact, other in zip(each, together, strict=True):
        assert contact.strain is not None and ("strain" in vars(other)) is (other.model is model())
        scale = np.abs(contact.strain).max()
        assert other.strain == pytest.approx(contact.strain, rel=1e-9, abs=1e-12 * scale)


def test_a_body_below_its_yield_stress_is_strained_like_an_elastic_one() -> None:
    """Along the load path half of the strain counts, as it rises with the pressure."""
    elastic = fem_seal.solve(model(), LAW, contact_force=2e3)
    curve = HardeningCurve(plastic_strain=(0.0, 1.0), stress=(5e9, 6e9))
    materials = {name: replace(body.material, hardening=curve) for name, body in model().bodies.items()}
    of = fem_seal.condense(meshes.build(BALL, CONE, SIZING), materials, Supports(wall="fixed"))
    (contact,) = load_path(of, LAW, [PathLoad(2e3)]).contacts
    pressed = elastic.pressure > 0.1 * elastic.pressure.max()
    assert elastic.strain is not None and contact.strain is not None
    scale = np.abs(elastic.strain[pressed]).max()
    assert np.abs(contact.strain - elastic.strain)[pressed].max() < 0.03 * scale
