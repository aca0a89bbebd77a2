"""The quick look at the stress of a body, against the field of its finite elements."""

import numpy as np
import pytest

import fem_seal
import meshes
from fem_seal.bodies.fields import von_mises
from fem_seal.contact.model import BodyLoads, with_stress_bound
from fem_seal.contact.solution import yielding_of

STEEL = fem_seal.Material("steel", 210e9, 0.3, yield_stress=400e6)


@pytest.fixture(scope="module")
def model():
    ball = meshes.Ball(0.02)
    sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    found = fem_seal.condense(
        meshes.build(ball, meshes.ConicalSeat.around(0.785, ball), sizing),
        {"closure": STEEL, "seat": STEEL},
    )
    return with_stress_bound(found, ("closure", "seat"))


def field_maximum(model, name, pressure, loads):
    """Largest von Mises stress of the whole field [Pa]."""
    body = getattr(model, name)
    moved = body.displacement(model.line.area_weight * pressure) + loads.displacement(body, model)
    return von_mises(body.recovery.stress(moved)).max()


def pressures(line):
    x, random = line.x, np.random.default_rng(4)
    smooth = [np.exp(-0.5 * ((x - at) / std) ** 2) for at, std in ((0, 1e-4), (0, 2e-4))]
    sharp = [np.sqrt(np.maximum(1 - (x / 2e-4) ** 2, 0)), (np.abs(x - 1e-4) < 1e-4) * 1.0]
    aside = np.exp(-0.5 * ((x - 2e-4) / 1e-4) ** 2)
    return smooth, [aside, *sharp, random.uniform(size=x.size), random.uniform(size=x.size) ** 8]


@pytest.mark.parametrize("name", ["closure", "seat"])
def test_it_is_never_below_the_field_and_close_to_it_for_smooth_pressures(model, name):
    smooth, others = pressures(model.line)
    for p in (*smooth, *others):
        bound = model.screens[name].highest_von_mises(1e8 * p, {})
        highest = field_maximum(model, name, 1e8 * p, BodyLoads())
        assert bound >= highest
        assert not model.screens[name].stays_below(highest, 1e8 * p, {})
        # the sum of the stresses of all splines alone
        assert model.screens[name].stays_below(30 * bound, 1e8 * p, {})
    # the allowance, five times what the splines leave of a Gaussian: 2 % of its peak where five elements go to a
    # standard deviation
    for p, most in zip(smooth, (1.25, 1.15), strict=True):
        bound = model.screens[name].highest_von_mises(1e8 * p, {})
        assert bound < most * field_maximum(model, name, 1e8 * p, BodyLoads())


@pytest.mark.parametrize("name", ["closure", "seat"])
def test_fluid_on_the_wetted_faces_counts(model, name):
    p, fluid = 1e6 * pressures(model.line)[0][0], {"inner": 0.0, "outer": 3e8}
    loads = BodyLoads(closure=fluid, seat=fluid)
    bound, true = (
        model.screens[name].highest_von_mises(p, loads.closure),
        field_maximum(model, name, p, loads),
    )
    assert true > 10 * field_maximum(model, name, p, BodyLoads())
    assert true <= bound < 1.01 * true


def test_what_it_does_not_know_takes_a_field(model):
    assert model.screens["closure"].highest_von_mises(0 * model.line.x, {"expansion": 1e-3}) == np.inf
    assert model.screens["seat"].highest_von_mises(0 * model.line.x, {"wall": 1e-6}) == np.inf


def test_a_load_is_below_its_yield_stress_only_if_its_field_is(model):
    law = fem_seal.HardContact()
    for force in (2000.0, 8000.0, 30000.0):
        contact = fem_seal.solve(model, law, contact_force=force)
        highest = contact.fields["seat"].von_mises.max()
        assert not contact.stays_below("seat", highest)
        # where hard contact ends the splines leave much
        assert contact.stays_below("seat", 10 * highest)
        assert ("seat" in yielding_of(contact)) == (highest > STEEL.yield_stress)
