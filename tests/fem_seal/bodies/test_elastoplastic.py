"""Materials and seals that yield: hardening curve, radial return, contact, unloading, case file."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from contact_models import STEEL
from hypothesis import given, settings
from hypothesis import strategies as st
from plastic_solids import CURVE, HARDENING, LAW, NU, PERFECT, YIELD, E, ring_solid, seal

from fem_seal.bodies.elasticity import (
    boundary_dofs,
    elasticity_matrix,
    node_dofs,
    quadratic_nodes,
    stiffness_matrix,
)
from fem_seal.bodies.elastoplastic import ElastoplasticBody, PlasticState, radial_return
from fem_seal.bodies.fields import BodyField, von_mises
from fem_seal.bodies.supports import Supports
from fem_seal.case.case import load_case
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.load_path import ElastoplasticContact, FirstLoading, Imprint, LoadPath, load_path
from fem_seal.contact.model import BodyLoads
from fem_seal.contact.newton import solve
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings
from fem_seal.contact.solution import yielded_zone
from fem_seal.errors import ConvergenceError, InputError, LongPathError
from fem_seal.materials import HardeningCurve, Material

STRONG = replace(STEEL, hardening=HardeningCurve((0.0,), (50e9,)))


# hardening curve ------------------------------------------------------------------------------------------------


def test_curve_is_linear_between_its_points_and_level_behind_them() -> None:
    strain = np.array([0.0, 0.001, 0.002, 0.026, 0.05, 0.5])
    assert CURVE.flow_stress(strain) / YIELD == pytest.approx([1, 1.15, 1.3, 1.45, 1.6, 1.6])
    assert CURVE.slope(strain) == pytest.approx([150 * YIELD, 150 * YIELD, 6.25 * YIELD, 6.25 * YIELD, 0, 0])
    assert (CURVE.yield_stress, CURVE.last_strain) == (YIELD, 0.05)
    assert math.isinf(HardeningCurve((0.0,), (YIELD,)).last_strain)


@given(p=st.floats(0, 1), stiffness=st.floats(1e6, 1e12))
def test_inverse_of_the_return(p: float, stiffness: float) -> None:
    trial = CURVE.flow_stress(np.array(p)) + stiffness * p
    found = CURVE.plastic_strain_at(trial, stiffness)
    assert CURVE.flow_stress(found) + stiffness * found == pytest.approx(float(trial), rel=1e-12)


def test_table_of_total_strain_loses_its_elastic_part() -> None:
    stress = (250e6, 300e6, 330e6)
    total = [0.0, 250e6 / E + 4e-6, 0.02, 0.1]
    curve = HardeningCurve.from_total_strain(total, (0.0, *stress), E)
    assert curve.stress == stress
    assert curve.plastic_strain == pytest.approx((0, 0.02 - 300e6 / E, 0.1 - 330e6 / E))


@pytest.mark.parametrize(
    ("strain", "stress", "message"),
    [
        ((0.001, 0.1), (250e6, 300e6), r"row 1 .*yield point, its plastic strain must be 0"),
        ((0.0, 0.1), (250e6, 200e6), r"row 2 \(strain 0.1, stress 200 MPa\): .*must not fall"),
        ((0.0, 0.1, 0.1), (1e8, 2e8, 3e8), r"row 3 .*must increase"),
        ((0.0, math.nan), (250e6, 300e6), r"row 2 .*finite"),
        ((0.0, 10.0), (250e6, 300e6), r"row 2 .*strain is a number, 0\.1 is 10 %; allowed is at most 2"),
        ((0.0,), (-1.0,), r"row 1 .*positive"),
        ((0.0, 0.1), (250e6,), r"as many stresses as strains"),
        ((), (), r"at least one"),
    ],
)
def test_wrong_tables_name_the_row(strain: tuple, stress: tuple, message: str) -> None:
    with pytest.raises(InputError, match=message):
        HardeningCurve(strain, stress)


def test_total_strain_must_begin_at_the_yield_point() -> None:
    with pytest.raises(InputError, match=r"strain = stress/E = 0\.00119048; .*youngs_modulus = 210 GPa"):
        HardeningCurve.from_total_strain((0.002, 0.1), (250e6, 300e6), E)


def test_rows_of_total_strain_are_those_of_the_table() -> None:
    """A row (0, 0) is counted, and the strain that is shown is the one that stands there."""
    with pytest.raises(
        InputError, match=r"row 2 \(strain 0\.002, stress 250 MPa\): this row must be the yield"
    ):
        HardeningCurve.from_total_strain((0.0, 0.002, 0.1), (0.0, 250e6, 300e6), E)
    with pytest.raises(InputError, match=r"row 3 \(strain 0\.1, stress 200 MPa\): the stress must not fall"):
        HardeningCurve.from_total_strain((0.0, 250e6 / E, 0.1), (0.0, 250e6, 200e6), E)


def test_material_yields_where_its_curve_begins() -> None:
    assert HARDENING.yield_stress == YIELD
    with pytest.raises(InputError, match=r"yield_stress = 300 MPa: contradicts stress_strain"):
        Material("m", E, NU, yield_stress=300e6, hardening=CURVE)


# radial return --------------------------------------------------------------------------------------------------

strains = st.lists(st.floats(-0.02, 0.02), min_size=4, max_size=4).map(np.array)


@settings(max_examples=60, deadline=None)
@given(path=st.lists(strains, min_size=1, max_size=5))
def test_return_keeps_the_laws_of_plastic_flow(path: list[np.ndarray]) -> None:
    """On any path: on or inside the yield surface, no plastic volume, no negative dissipation."""
    state = PlasticState.virgin()
    for strain in path:
        answer = radial_return(strain, state, HARDENING, CURVE)
        increment = answer.state.strain - state.strain
        grown = answer.state.accumulated_strain - state.accumulated_strain
        limit = CURVE.flow_stress(answer.state.accumulated_strain)
        assert von_mises(answer.stress) <= limit * (1 + 1e-9)
        assert abs(increment[:3].sum()) < 1e-15
        tensor = increment * [1, 1, 1, 0.5]
        norm = np.sqrt(tensor[:3] @ tensor[:3] + 2 * tensor[3] ** 2)
        assert grown == pytest.approx(np.sqrt(2 / 3) * norm, rel=1e-9, abs=1e-16)
        # the engineering shear strain makes the scalar product the work
        assert answer.stress @ increment == pytest.approx(limit * grown, rel=1e-6, abs=1e-6)
        if not answer.yielding:
            assert answer.stress == pytest.approx(
                elasticity_matrix(HARDENING) @ (strain - state.strain), rel=1e-12, abs=1e-3
            )
        state = answer.state


def test_pure_shear_flows_at_the_shear_yield_stress() -> None:
    answer = radial_return(np.array([0, 0, 0, 0.01]), PlasticState.virgin(), PERFECT, PERFECT.hardening)
    assert answer.stress == pytest.approx([0, 0, 0, YIELD / np.sqrt(3)], abs=1e-6 * YIELD)


def test_tangent_is_the_derivative_of_the_stress() -> None:
    rng = np.random.default_rng(7)
    strain = rng.uniform(-4e-3, 4e-3, (40, 4))
    before = PlasticState(rng.uniform(-1e-3, 1e-3, (40, 4)) * [1, 1, 1, 1], rng.uniform(0, 4e-3, 40))
    answer = radial_return(strain, before, HARDENING, CURVE)
    assert 5 < answer.yielding.sum() <= 40
    assert np.abs(answer.tangent - np.swapaxes(answer.tangent, -1, -2)).max() < 1e-9 * E
    step = 1e-8
    for k in range(4):
        up, down = (
            radial_return(strain + s * step * np.eye(4)[k], before, HARDENING, CURVE) for s in (1, -1)
        )
        same = up.yielding == down.yielding
        slope = (up.stress - down.stress) / (2 * step)
        assert slope[same] == pytest.approx(answer.tangent[same, :, k], abs=1e-6 * E)


# elements -------------------------------------------------------------------------------------------------------


def test_elastic_stiffness_is_that_of_the_elastic_body() -> None:
    body = ring_solid(4)
    elastic = np.broadcast_to(elasticity_matrix(PERFECT), (*body.weight.shape, 4, 4))
    expected = stiffness_matrix(body.mesh, PERFECT)[body.free][:, body.free]
    assert abs(body.stiffness(elastic) - expected).max() < 1e-13 * abs(expected).max()


def test_stiffness_is_the_derivative_of_the_internal_forces() -> None:
    body, rng = ring_solid(4, HARDENING), np.random.default_rng(3)
    u, direction = np.zeros(body.basis.N), np.zeros(body.basis.N)
    u[body.free], direction[body.free] = (rng.uniform(-1, 1, len(body.free)) * 2e-6 for _ in "ab")
    at = body.respond(u, body.virgin)
    assert 0.2 < at.yielding.mean() < 0.95
    step = 1e-5
    up, down = (
        body.internal_forces(body.respond(u + s * step * direction, body.virgin).stress) for s in (1, -1)
    )
    slope = ((up - down) / (2 * step))[body.free]
    assert slope == pytest.approx(
        body.stiffness(at.tangent) @ direction[body.free], abs=1e-5 * np.abs(slope).max()
    )


def test_nodal_average_keeps_linear_fields() -> None:
    body = ring_solid(5)
    points, _ = quadratic_nodes(body.basis.mesh)
    r, z = np.asarray(body.basis.global_coordinates())
    assert body.nodal_average @ (3 * r - 2 * z + 1).ravel() == pytest.approx(
        3 * points[:, 0] - 2 * points[:, 1] + 1
    )


def test_a_body_without_curve_does_not_yield() -> None:
    body = ring_solid(1)
    with pytest.raises(ValueError, match="has no hardening curve"):
        ElastoplasticBody(body.mesh, STEEL)


# contact --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [LAW, HardContact()], ids=["exponential", "hard"])
def test_below_the_yield_stress_the_result_is_the_elastic_one(law: Law) -> None:
    """Both bodies as yielding ones that never yield, under fluid on all surfaces and with a fixed, moved wall."""
    model, force = seal(law, 2e6, closure=STRONG, seat=STRONG, supports=Supports(wall="fixed"))
    fluid = BodyLoads.of_fluid((2e6, 1e5), np.full(len(model.line.x), 5e5), BodyLoads.press_fit(2e-6))
    elastic = solve(model, law, contact_force=force, loads=fluid)
    fit = BodyLoads.press_fit(2e-6)
    path = load_path(model, law, [PathLoad(force, fluid)], at_rest=fit, settings=PlasticSettings(steps=1))
    (contact,) = path.contacts
    assert contact.pressure == pytest.approx(elastic.pressure, rel=1e-8, abs=1e-8 * elastic.pressure.max())
    assert contact.approach == pytest.approx(elastic.approach, rel=1e-9)
    assert contact.applied_force == pytest.approx(elastic.applied_force, rel=1e-12)
    assert len(contact.equilibrium_residuals) == 1
    for name, field in elastic.fields.items():
        moved = contact.fields[name].displacement
        assert moved == pytest.approx(field.displacement, abs=1e-9 * np.abs(field.displacement).max())
        # one is fitted to patches, the other continued to the nodes: on large elements the hoop stress differs, and
        # where hard contact ends, the pressure that falls by half its peak within an element
        p = field.contact_pressure[field.contact_nodes]
        away = np.ones(len(field.stress), dtype=bool)
        away[field.contact_nodes] = np.abs(np.gradient(p)) < 0.1 * p.max()
        assert contact.fields[name].stress[away] == pytest.approx(
            field.stress[away], abs=0.05 * np.abs(field.stress).max()
        )
    assert path.unloaded_bodies.imprints == {}


@pytest.fixture(scope="module")
def pressed() -> tuple[LoadPath, float]:
    """A perfectly plastic seat far in the fully plastic range: E* a/(R Y) = 25."""
    model, force = seal(LAW, 6e7, seat=PERFECT, wider=2.0)
    loads = [PathLoad(force), PathLoad(0.4 * force), PathLoad(force)]
    return load_path(model, LAW, loads), force


def test_contact_carries_the_force(pressed: tuple[LoadPath, float]) -> None:
    path, force = pressed
    for contact, share in zip(path.contacts, (1, 0.4, 1), strict=True):
        assert contact.contact_force == share * force
        assert abs(contact.force_error) < 1e-12
        # and so does the seat's bottom: reactions of the elements' stress
        body = contact.bodies["seat"]
        internal = body.solid.internal_forces(contact.states["seat"].stress)
        bottom = boundary_dofs(body.fem.mesh, "seat_bottom", 1)
        assert internal[bottom].sum() == pytest.approx(contact.contact_force, rel=1e-8)


def test_newton_on_the_contact_converges_quadratically(pressed: tuple[LoadPath, float]) -> None:
    residuals = pressed[0].contacts[0].equilibrium_residuals
    assert len(residuals) <= 12
    near = [(a, b) for a, b in pairwise(residuals) if a < 1e-3]
    assert len(near) >= 2
    assert all(b < max(20 * a**2, 1e-11) for a, b in near)  # down to round-off


def test_full_plasticity_tends_to_the_pressure_of_prandtl(pressed: tuple[LoadPath, float]) -> None:
    """Prandtl's strip carries (2 + pi)/sqrt(3) Y = 2.97 Y; a cylinder, whose flow begins inside, a little less.

    The elastic peak would be 4.9 Y.
    """
    profile = pressed[0].contacts[0].profile
    inner = np.abs(profile.x - profile.centroid) < 0.6 * profile.std
    mean = np.average(profile.pressure[inner], weights=profile.arc_weight[inner])
    assert 2.5 < mean / YIELD < 2.97
    assert profile.pressure[inner] == pytest.approx(mean, rel=0.05)  # a plateau


def test_nothing_is_stressed_beyond_its_curve(pressed: tuple[LoadPath, float]) -> None:
    contact = pressed[0].contacts[0]
    state, field = contact.states["seat"], contact.fields["seat"]
    assert von_mises(state.stress).max() <= YIELD * (1 + 1e-9)
    assert field.von_mises.max() == pytest.approx(YIELD, rel=1e-9)
    assert field.accumulated_plastic_strain.max() > 0.005  # type: ignore[attr-defined]
    assert contact.fields["closure"].von_mises.max() > YIELD  # the ball is elastic


def test_loading_again_is_elastic(pressed: tuple[LoadPath, float]) -> None:
    first, low, again = pressed[0].contacts
    before, after = (c.states["seat"].plastic.accumulated_strain for c in (first, again))
    assert np.all(after >= before)
    assert (after - before).max() < 0.01 * before.max()
    assert again.profile.std == pytest.approx(first.profile.std, rel=1e-3)
    # pressed out once, the seat fits the ball: the contact narrows less than the elastic one on the way down
    assert low.profile.fwhm > 0.7 * first.profile.fwhm


def test_residual_stress_balances_itself(pressed: tuple[LoadPath, float]) -> None:
    path, force = pressed
    state, body = path.unloaded_bodies.states["seat"], path.contacts[0].bodies["seat"]
    mesh = body.fem.mesh
    internal = body.solid.internal_forces(state.stress)
    # the force across every level section, from the stress of the elements below it
    axial = node_dofs(mesh)[1]
    z = quadratic_nodes(mesh)[0][:, 1]
    for level in np.quantile(z, (0.2, 0.5, 0.8)):
        assert abs(internal[axial[z > level]].sum()) < 1e-6 * force
    # the mean of a stress that nothing holds is zero: int sigma_zz dV = 0, while its modulus is not
    zz, weight = state.stress[..., 1], body.solid.weight
    assert abs(np.sum(weight * zz)) < 1e-6 * np.sum(weight * np.abs(zz))
    assert von_mises(state.stress).max() > 0.3 * YIELD


def test_imprint_stays(pressed: tuple[LoadPath, float]) -> None:
    path, _ = pressed
    imprint, width = path.unloaded_bodies.imprints["seat"], path.contacts[0].profile.fwhm
    # the ball was pressed a^2/2R deep into it; what springs back and what piles up share the rest
    assert 0.5 < imprint.deepest / ((width / 2) ** 2 / (2 * 0.02)) < 1.5
    assert 0.5 * width < imprint.width < width
    assert 0 < imprint.rim < 0.2 * imprint.deepest
    field = path.unloaded_bodies.fields["seat"]
    assert field.contact_pressure.max() == 0
    nodes = field.contact_nodes
    normal = np.array([-np.sqrt(0.5), np.sqrt(0.5)])
    assert -(field.displacement[nodes] @ normal) == pytest.approx(imprint.depth)


def test_smaller_steps_change_little_and_in_proportion() -> None:
    model, force = seal(LAW, 3e7, seat=HARDENING, refine=0.35, wider=1.5)
    std = [
        load_path(model, LAW, [PathLoad(force)], settings=PlasticSettings(steps=steps), unload=False)
        .contacts[0]
        .profile.std
        for steps in (4, 8, 16)
    ]
    assert (std[0] - std[1]) / (std[1] - std[2]) == pytest.approx(2, abs=0.7)
    assert std[1] == pytest.approx(std[2], rel=0.01)


def test_long_steps_through_what_stays_elastic_change_nothing() -> None:
    """The same as a list of loads that stops at every eighth of the force, up, down and up again."""
    model, force = seal(LAW, 3e7, seat=HARDENING, refine=0.35, wider=1.5)

    def pressed(eighths: list[int], steps: int) -> LoadPath:
        loads = [PathLoad(n * force / 8) for n in eighths]
        return load_path(model, LAW, loads, settings=PlasticSettings(steps=steps), unload=False)

    few = pressed([8, 1, 8], 8).contacts
    every = pressed([*range(1, 9), *range(7, 0, -1), *range(2, 9)], 1).contacts
    for contact, other in zip(few, (every[7], every[14], every[21]), strict=True):
        assert contact.pressure == pytest.approx(other.pressure, abs=1e-8 * other.pressure.max())
        strain = other.states["seat"].plastic.accumulated_strain
        assert strain.max() > 5e-4
        assert contact.states["seat"].plastic.accumulated_strain == pytest.approx(
            strain, abs=1e-8 * strain.max()
        )
    assert all(contact.load_steps < steps for contact, steps in zip(few, (8, 7, 7), strict=True))


@pytest.mark.slow
def test_first_loading_of_several_forces_is_one_path() -> None:
    """Reached from other forces or directly, a force differs by no more than half as many steps do."""
    model, force = seal(LAW, 3e7, seat=HARDENING, refine=0.35, wider=1.5)

    def direct(share: float, steps: int = 16) -> ElastoplasticContact:
        few = PlasticSettings(steps=steps)
        return load_path(model, LAW, [PathLoad(share * force)], settings=few, unload=False).contacts[0]

    def shared(share: float) -> ElastoplasticContact:
        return load_path(model, LAW, [PathLoad(share * force)], first_loading=first, unload=False).contacts[0]

    first = FirstLoading(model, LAW)
    assert first.highest_force is None
    begun = shared(0.7)
    alone = direct(0.7)
    assert begun.pressure == pytest.approx(alone.pressure, rel=1e-12)
    # up, down, and below the half of the first
    for share in (1.0, 0.83, 0.3):
        found, own, coarse = shared(share), direct(share), direct(share, 8)
        again = shared(share)
        # from one step further on, and as well balanced
        assert again.pressure == pytest.approx(found.pressure, rel=PlasticSettings().tolerance)
        # linearised one iteration before the last
        assert again.linear.compliance == pytest.approx(found.linear.compliance, rel=1e-4)
        assert found.contact_force == pytest.approx(own.contact_force, rel=1e-12)
        assert abs(found.profile.std - own.profile.std) <= abs(coarse.profile.std - own.profile.std)
        assert found.load_steps <= begun.load_steps + 6
        strain, its = (one.states["seat"].plastic.accumulated_strain.max() for one in (found, own))
        assert strain == pytest.approx(its, rel=0.01)
    assert first.highest_force == 0.3 * force
    # a load after the first goes on from there
    loads = [PathLoad(0.3 * force), PathLoad(0.1 * force)]
    back, own = (
        load_path(model, LAW, loads, first_loading=one, unload=False).contacts[1] for one in (first, None)
    )
    assert back.pressure == pytest.approx(own.pressure, abs=1e-9 * own.pressure.max())


def test_hard_contact_on_a_yielding_seat() -> None:
    model, force = seal(HardContact(), 3e7, seat=HARDENING, refine=0.35, wider=1.5)
    (contact,) = load_path(
        model, HardContact(), [PathLoad(force)], settings=PlasticSettings(steps=8), unload=False
    ).contacts
    elastic = solve(model, HardContact(), contact_force=force)
    assert contact.profile.pressure.min() >= 0
    assert abs(contact.force_error) < 1e-10
    assert contact.profile.std > 1.05 * elastic.profile.std
    assert contact.gap.min() > -1e-9


def test_steps_are_halved_before_giving_up() -> None:
    model, force = seal(LAW, 6e7, seat=PERFECT, refine=0.35, wider=2.0)
    few = PlasticSettings(steps=1, max_iterations=5)
    (contact,) = load_path(model, LAW, [PathLoad(force)], settings=few, unload=False).contacts
    assert contact.load_steps > 1
    assert abs(contact.force_error) < 1e-12
    loads = [PathLoad(0.02 * force), PathLoad(force)]
    with pytest.raises(
        ConvergenceError, match=r"load step from .* N to .* N .*out of balance by .*lower the load"
    ) as caught:
        load_path(model, LAW, loads, settings=replace(few, max_iterations=1, smallest_step=0.1))
    assert [contact.contact_force for contact in caught.value.partial.contacts] == [0.02 * force]
    path = load_path(
        model, LAW, loads, settings=replace(few, max_iterations=1, smallest_step=0.1), partial=True
    )
    assert [contact.contact_force for contact in path.contacts] == [0.02 * force]
    assert "load step from" in str(path.failure)
    assert path.unloaded_bodies.imprints == {}


def test_a_way_that_takes_too_many_steps_ends_with_the_load_that_was_reached() -> None:
    """Steps of a perfectly plastic edge shrank to 0.05 % of the way, and the path went on for ever."""
    model, force = seal(LAW, 6e7, seat=PERFECT, refine=0.35, wider=2.0)
    loads = [PathLoad(0.02 * force), PathLoad(force)]
    never = PlasticSettings(steps=1, max_iterations=1, smallest_step=0.0, most_steps=30)
    with pytest.raises(ConvergenceError) as caught:
        load_path(model, LAW, loads, settings=never)
    assert isinstance(caught.value.partial.failure, LongPathError)
    assert [contact.contact_force for contact in caught.value.partial.contacts] == [0.02 * force]
    said = r"([\d.]+) N of 37.7 kN are reached after (\d+) load steps that were tried, (\d+) % of the way"
    found = re.match(said, str(caught.value))
    assert found is not None
    reached, tried, way = map(float, found.groups())
    assert reached == pytest.approx(0.02 * force + 0.01 * way * 0.98 * force, rel=0.03)
    # as large a part of all steps as of the way
    assert tried == pytest.approx(30 * max(0.2, 0.01 * way), abs=1)
    # what takes as many as it may is not given up
    (contact,) = load_path(
        model, LAW, [PathLoad(force)], settings=PlasticSettings(steps=1, max_iterations=6), unload=False
    ).contacts
    assert contact.contact_force == pytest.approx(force)


@pytest.mark.parametrize("force", [0.0, -1.0, math.nan])
def test_forces_of_a_path_must_close_the_seal(force: float) -> None:
    model, _ = seal(LAW, 2e6, seat=PERFECT, refine=0.3)
    with pytest.raises(ValueError, match="contact_force"):
        load_path(model, LAW, [PathLoad(force)])


def test_an_elastic_seal_has_no_path() -> None:
    model, force = seal(LAW, 2e6, refine=0.3)
    with pytest.raises(ValueError, match="no material has a hardening curve"):
        load_path(model, LAW, [PathLoad(force)])


# imprint and yielded zone ---------------------------------------------------------------------------------------


def test_measures_of_an_imprint() -> None:
    x = np.linspace(-1e-3, 1e-3, 401)
    imprint = Imprint(x, 5e-6 * (1 - (x / 4e-4) ** 2) * np.exp(-((x / 4e-4) ** 2)))
    assert imprint.deepest == pytest.approx(5e-6)
    assert imprint.deepest_at == pytest.approx(0, abs=1e-12)
    # s = (x/4e-4)^2: lowest of (1 - s) e^-s at s = 2, half at s = 0.3149
    assert imprint.rim == pytest.approx(5e-6 * np.exp(-2), rel=1e-4)
    assert imprint.width == pytest.approx(2 * 4e-4 * np.sqrt(0.314923), rel=1e-3)
    raised = Imprint(x, -1e-6 * np.ones_like(x))
    assert (raised.deepest, raised.width, raised.rim) == (0.0, 0.0, 1e-6)


def test_yielded_zone_says_where_how_much_and_how_deep() -> None:
    points = np.array([[1.0, 0.0], [2.0, 1.0], [2.0, -1.0], [3.0, -2.0], [5.0, -9.0]])
    stress = np.zeros((5, 4))
    stress[:, 1] = [100e6, 200e6, 400e6, 300e6, 50e6]
    field = BodyField(
        "seat", points, np.zeros((0, 6), int), 0 * points, stress, np.array([0, 1]), np.zeros(2), np.zeros(5)
    )
    zone = yielded_zone(field, 250e6)
    assert zone is not None
    assert (zone.body, zone.von_mises, zone.excess, zone.place) == ("seat", 400e6, 1.6, (2.0, -1.0))
    # perpendicular to the line from (1, 0) to (2, 1)
    assert (zone.depth, zone.deepest) == pytest.approx((np.sqrt(2), 2 * np.sqrt(2)))
    assert yielded_zone(field, 500e6) is None


# case file ------------------------------------------------------------------------------------------------------

CASE = """
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"
[seat]
shape = "cone"
angle = "45 deg"
material = {{ youngs_modulus = "210 GPa", poissons_ratio = 0.3, stress_strain = {0} }}
[interface]
law = "smooth"
[load]
fluid_pressure = "20 bar"
"""


def seat_material(folder: Path, stress_strain: str) -> Material:
    path = folder / "case.toml"
    path.write_text(CASE.format(stress_strain))
    return load_case(path).seat.material


def test_stress_strain_in_the_case_file(tmp_path: Path) -> None:
    written = seat_material(tmp_path, '{ plastic_strain = [0, 0.05], stress = ["250 MPa", "310 MPa"] }')
    assert written.hardening == HardeningCurve((0.0, 0.05), (250e6, 310e6))
    assert written.yield_stress == 250e6
    (tmp_path / "curve.csv").write_text("plastic strain, stress [MPa]\n0, 250\n0.05, 310\n")
    assert seat_material(tmp_path, '{ file = "curve.csv" }') == written
    (tmp_path / "curve.csv").write_text(
        f"strain, stress_GPa\n{0.25e9 / E}, 0.25\n{0.05 + 0.31e9 / E}, 0.31\n"
    )
    total = seat_material(tmp_path, '{ file = "curve.csv" }').hardening
    assert total is not None
    assert total.plastic_strain == pytest.approx((0, 0.05))


@pytest.mark.parametrize(
    ("header", "written"),
    [
        ("plastic strain [%]", 5),
        ("plastic_strain (percent)", 5),
        ("plastic_strain_percent", 5),
        ("plastic_strain %", 5),
        ("plastic_strain [-]", 0.05),
        ("plastic_strain", 0.05),
    ],
)
def test_strain_is_a_number_or_per_cent(tmp_path: Path, header: str, written: float) -> None:
    (tmp_path / "curve.csv").write_text(f"{header}, stress_MPa\n0, 250\n{written}, 310\n")
    curve = seat_material(tmp_path, '{ file = "curve.csv" }').hardening
    assert curve is not None
    assert curve.plastic_strain == pytest.approx((0, 0.05), rel=1e-15)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('{ stress = ["250 MPa"] }', r"seat\.material\.stress_strain: needs file"),
        ('{ file = "a.csv", plastic_strain = [0] }', r"needs file"),
        ('{ file = "none.csv" }', r"none\.csv cannot be read"),
        ('{ plastic_strain = [0, 10], stress = ["1 GPa", "2 GPa"] }', r"row 2 .*0\.1 is 10 %"),
        ('{ plastic_strain = [0, "2 %"], stress = ["1 GPa", "2 GPa"] }', r'entry 2, "2 %", is not a number'),
        ('{ plastic_strain = [0], stress = ["250"] }', r"has no unit"),
        ('{ plastic_strain = [0, 0.1], stress = ["2 GPa", "1 GPa"] }', r"row 2 .*must not fall"),
        ('{ strain = [0, 0.1], stress = ["1 GPa", "2 GPa"] }', r"stress/E = 0\.0047619"),
    ],
)
def test_wrong_stress_strain_in_the_case_file(tmp_path: Path, table: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        seat_material(tmp_path, table)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0, 250\n0.1, 300\n", r'has no header; .*"plastic_strain, stress_MPa"'),
        ("plastic_strain, stress\n0, 250\n", r'column "stress" has no unit'),
        ("depth_mm, stress_MPa\n0, 250\n", r"either a column plastic_strain or a column strain"),
        ("plastic_strain [mm], stress_MPa\n0, 250\n", r'"mm" does not fit a strain; write a plain number'),
        ("plastic_strain_mm, stress_MPa\n0, 250\n", r'"mm" does not fit a strain'),
        ("plastic_strain, stress_MPa\n0, 250\n10, 300\n", r"row 2 .*0\.1 is 10 %"),
        (
            "plastic_strain, stress_MPa\n0,05,210,5\n",
            r"4 columns of numbers, and no line above .*decimal commas by semicolons",
        ),
    ],
)
def test_wrong_stress_strain_files(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "curve.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        seat_material(tmp_path, '{ file = "curve.csv" }')
