"""Strain of the bodies that lets asperities sink, along a path of loads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import fem_seal
import meshes
from fem_seal.bodies.elasticity import node_dofs
from fem_seal.bodies.elastoplastic import BodyState, PlasticState
from fem_seal.contact.load_path import load_path
from fem_seal.contact.plastic_step import Flattening, PathLoad, PlasticSettings, YieldingBody, strain_size
from fem_seal.materials import HardeningCurve
from leak import ExponentialLaw

STEEL = fem_seal.Material("steel", 210e9, 0.3)
BALL = meshes.Ball(0.02)
CONE = meshes.ConicalSeat.around(0.785, BALL)
SIZING = meshes.Sizing(4e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
LAW = ExponentialLaw(p_c=1e9, u0=0.4e-6)


def model_of(yield_stress: float) -> fem_seal.ContactModel:
    curve = HardeningCurve(plastic_strain=(0.0, 1.0), stress=(yield_stress, 2.0 * yield_stress))
    materials = {"closure": STEEL, "seat": replace(STEEL, hardening=curve)}
    return fem_seal.condense(meshes.build(BALL, CONE, SIZING), materials)


def walk(steps: list[tuple[float, float, float]]) -> Flattening:
    """Through pressure, plastic and elastic strain along the face of one place."""
    flattening = Flattening.none(1)
    for pressure, plastic, elastic in steps:
        flattening = flattening.until(
            np.array([[plastic, 0.0]]), np.array([[elastic, 0.0]]), np.array([pressure])
        )
    return flattening


def test_strain_at_one_pressure_counts_whole_and_with_the_pressure_half() -> None:
    pressed_before = walk([(1e8, 0.0, 0.0), (1e8, 0.02, 0.0)])
    assert pressed_before.strain[0] == pytest.approx([0.02, 0.0])
    together = walk([(1e8 * share, 0.02 * share, 0.0) for share in np.linspace(0.1, 1.0, 10)])
    assert together.strain[0] == pytest.approx([0.01, 0.0])
    before_touch = walk([(0.0, 0.02, 0.0), (1e8, 0.02, 0.0)])
    assert before_touch.strain[0] == pytest.approx([0.0, 0.0])


def test_elastic_strain_counts_half_and_comes_back_without_a_trace() -> None:
    there = walk([(0.5e8, 0.0, -0.001), (1e8, 0.0, -0.002)])
    back = walk([(0.5e8, 0.0, -0.001), (1e8, 0.0, -0.002), (0.5e8, 0.0, -0.001), (1e8, 0.0, -0.002)])
    assert there.strain[0] == pytest.approx([-0.001, 0.0])
    assert np.array_equal(there.strain, back.strain)


def test_what_was_flattened_stays_whichever_way_the_metal_goes() -> None:
    way = [(1e8, 0.0, 0.0), (1e8, 0.02, 0.0), (1e8, -0.01, 0.0), (0.2e8, -0.012, 0.0), (2e8, -0.012, 0.0)]
    done = [walk(way[:count]) for count in range(1, len(way) + 1)]
    flattened = [float(strain_size(f.strain)[0] * f.highest[0]) for f in done]
    assert flattened == sorted(flattened)
    assert strain_size(done[2].strain)[0] == pytest.approx(0.05)
    # at twice the pressure half of the strain flattens as much
    assert strain_size(done[-1].strain)[0] == pytest.approx(0.5 * strain_size(done[-2].strain)[0])


def test_a_place_without_pressure_has_no_strain() -> None:
    assert walk([(0.0, 0.1, 0.01)]).strain.tolist() == [[0.0, 0.0]]


def test_strains_of_an_evenly_strained_body_are_found_on_its_face() -> None:
    """Stretched by a along r (and so around the axis) and by b along z; a cone of 45 degrees has the mean along it."""
    body = YieldingBody(model_of(1e12).seat.fem)
    places = body.fem.nodes[0]
    a, b = 2e-3, -1e-3
    displacement = np.zeros(body.fem.size)
    r_dofs, z_dofs = node_dofs(body.fem.mesh)
    displacement[r_dofs], displacement[z_dofs] = a * places[:, 0], b * places[:, 1]
    flow = body.solid.respond(displacement, body.solid.virgin)
    plastic = PlasticState(np.full_like(flow.state.strain, 0.0), flow.state.accumulated_strain)
    plastic.strain[..., 0], plastic.strain[..., 1] = 3e-3, -3e-3
    along, elastic = body.face_strains(BodyState(displacement, flow.stress, plastic))
    assert elastic[:, 0] == pytest.approx(0.5 * (a + b), abs=2e-6)
    assert elastic[:, 1] == pytest.approx(a, abs=2e-6)
    assert along[:, 0] == pytest.approx(0.0, abs=6e-6)
    assert along[:, 1] == pytest.approx(0.0, abs=1e-9)


def test_elastic_strain_is_that_of_a_half_space_under_a_line_contact() -> None:
    """-(1 + nu)(1 - 2 nu) p/E along the face (K. L. Johnson, Contact Mechanics, sec. 2.5), of which half counts."""
    contact = load_path(model_of(5e10), LAW, [PathLoad(20e3)], unload=False).contacts[0]
    found = contact.flattening["seat"].strain
    formula = -0.5 * 1.3 * 0.4 / 210e9 * contact.pressure
    pressed = contact.pressure > 0.5 * contact.pressure.max()
    assert found[pressed, 0] == pytest.approx(formula[pressed], rel=0.08)
    # the seat as a ring is stretched a little
    assert np.all(np.abs(found[pressed, 1]) < 0.25 * np.abs(found[pressed, 0]))
    assert contact.profile.strain is not None
    assert np.array_equal(contact.profile.strain[:, :2], found)


def test_strain_does_not_depend_on_the_load_steps() -> None:
    model = model_of(4e8)
    strains = []
    for steps in (16, 32, 64):
        path = load_path(model, LAW, [PathLoad(20e3)], unload=False, settings=PlasticSettings(steps=steps))
        contact = path.contacts[0]
        pressed = contact.pressure > 0.5 * contact.pressure.max()
        strains.append(float(strain_size(contact.strain)[pressed].mean()))
    assert abs(strains[2] / strains[1] - 1.0) < 0.05
    assert abs(strains[2] / strains[1] - 1.0) < abs(strains[1] / strains[0] - 1.0) + 0.01
