"""A fluid between surfaces of bodies that yield: against elastic bodies, mechanics, and the path without fluid."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from contact_models import STEEL
from plastic_solids import HARDENING, LAW, YIELD, E, seal

import fem_seal
import leak
from fem_seal.answers.case_load import SolvedSeal, case_loads
from fem_seal.answers.samples import Samples
from fem_seal.bodies.elasticity import boundary_dofs, node_dofs
from fem_seal.bodies.supports import Supports
from fem_seal.case.tables import Spread, Uncertainty
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.load_path import ElastoplasticContact, LoadPath, load_path
from fem_seal.contact.model import BodyLoads, ContactModel
from fem_seal.contact.newton import solve
from fem_seal.contact.penetration import (
    CoupledContact,
    FluidAtContact,
    FluidPath,
    PenetratingFluid,
    blow_off_pressure,
    effective_radius,
    solve_penetration,
)
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings
from fem_seal.contact.solution import largest_before
from fem_seal.loads import PressureSide
from fem_seal.materials import HardeningCurve
from fem_seal.profile import PressureProfile
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import LoadSolver, SolvedLoads, solve_linearised
from fem_seal.seal.problem import SealFlow, SealProblem
from fem_seal.studies.responses import evaluate_design

STRONG = replace(STEEL, hardening=HardeningCurve((0.0,), (50e9,)))
FIT = BodyLoads.press_fit(2e-6)


def flowing(side: PressureSide) -> PenetratingFluid:
    """A liquid through sigma ~ 1/p; its pressure does not depend on the factor."""

    def along(profile, fluid_pressure):  # type: ignore[no-untyped-def]
        return leak.leak_flow(
            profile.x,
            profile.pressure,
            lambda p: 1 / p,
            fluid_pressure,
            profile.radius,
            pressure_side=side,
        ).fluid_pressure

    return PenetratingFluid(along, math.inf, side)


@cache
def soft() -> tuple[ContactModel, float]:
    """A seat that yields, and a force that coins it: the elastic peak would be twice its yield stress."""
    return seal(LAW, 6e7, seat=HARDENING, refine=0.35, wider=2.0)


SPRING_FIRST = 8


@cache
def relief(steps: int = SPRING_FIRST) -> LoadPath:
    """The spring closes; then the pressure in the bore rises, falls, and rises beyond what the spring holds."""
    model, spring = soft()
    fluid = flowing("inner")
    pressures = (0.0, 200e5, 500e5, 200e5, 800e5, 100e5)
    loads = [PathLoad(spring, path=fluid, fluid_pressure=pressure) for pressure in pressures]
    return load_path(model, LAW, loads, settings=PlasticSettings(steps=steps), unload=False)


def test_the_fluid_flows_over_metal_as_the_path_has_strained_it() -> None:
    """In the last load step the flow sees the strain of the contact at its end, plastic strain included."""
    model, spring = soft()
    seen = []

    def remember(profile: PressureProfile) -> PressureProfile:
        seen.append(profile.strain)
        return profile

    fluid = replace(flowing("inner"), at_rest=remember)
    loads = [PathLoad(spring, path=fluid, fluid_pressure=pressure) for pressure in (0.0, 200e5)]
    path = load_path(model, LAW, loads, settings=PlasticSettings(steps=SPRING_FIRST), unload=False)
    strain = path.contacts[-1].strain
    assert strain is not None and np.abs(strain).max() > YIELD / E
    assert seen[-1] == pytest.approx(strain, abs=1e-3 * np.abs(strain).max())
    assert path.contacts[-1].unloading_model.path_strain == pytest.approx(strain, rel=1e-12)


# ---------------------------------------------------------------- limits


@pytest.mark.parametrize(
    ("law", "path"),
    [
        (LAW, flowing("inner")),
        (LAW, flowing("outer")),
        (LAW, FluidAtContact("inner")),
        (HardContact(), FluidAtContact("outer")),
    ],
    ids=["bore", "outside", "held", "hard"],
)
def test_bodies_that_never_yield_are_elastic_ones(law: Law, path: FluidPath) -> None:
    """One load step with both bodies able to yield, a held wall and a press fit: the elastic coupling, to round-off.

    The fluid's fixed point is found to 1e-9 of its pressure, a held fluid's front to 1e-5 of an element.
    """
    model, force = seal(law, 2e6, closure=STRONG, seat=STRONG, refine=0.35, supports=Supports(wall="fixed"))
    spring, pressure = (force, 5e5) if path.side == "inner" else (0.0, 2e6)
    elastic = solve_penetration(
        CoupledContact(model, law, path, FIT), applied_force=spring, fluid_pressure=pressure
    )
    whole = load_path(
        model,
        law,
        [PathLoad(spring, FIT, path=path, fluid_pressure=pressure)],
        at_rest=FIT,
        settings=PlasticSettings(steps=1),
    )
    (contact,) = whole.contacts
    assert contact.pressure == pytest.approx(elastic.pressure, rel=1e-7, abs=1e-8 * elastic.pressure.max())
    assert contact.loads.gap_pressure == pytest.approx(elastic.loads.gap_pressure, abs=1e-7 * pressure)
    assert contact.contact_force == pytest.approx(elastic.contact_force, rel=1e-8)
    assert len(contact.equilibrium_residuals) == 1
    for name, field in elastic.fields.items():
        moved = contact.fields[name].displacement
        assert moved == pytest.approx(field.displacement, abs=1e-8 * np.abs(field.displacement).max())
    assert whole.unloaded_bodies is not None and whole.unloaded_bodies.imprints == {}


def test_a_fluid_of_next_to_no_pressure_changes_nothing() -> None:
    """1 Pa lifts with 2e-8 of the spring's force."""
    model, spring = soft()
    few = PlasticSettings(steps=4)
    (dry,) = load_path(model, LAW, [PathLoad(spring)], settings=few, unload=False).contacts
    (wet,) = load_path(
        model, LAW, [PathLoad(spring, path=flowing("inner"), fluid_pressure=1.0)], settings=few, unload=False
    ).contacts
    assert wet.pressure == pytest.approx(dry.pressure, rel=1e-6)
    assert dry.states["seat"].plastic.accumulated_strain.max() > 1e-3
    assert wet.states["seat"].plastic.accumulated_strain == pytest.approx(
        dry.states["seat"].plastic.accumulated_strain, abs=1e-8
    )


def test_given_loads_are_those_that_the_fluid_was_found_with() -> None:
    """The path's last step once more, its fluid put on the bodies as a given load: the same contact."""
    model, spring = soft()
    one = PlasticSettings(steps=1)
    (found,) = load_path(
        model,
        LAW,
        [PathLoad(spring, path=flowing("inner"), fluid_pressure=100e5)],
        settings=one,
        unload=False,
    ).contacts
    (given,) = load_path(
        model, LAW, [PathLoad(found.contact_force, found.loads)], settings=one, unload=False
    ).contacts
    # both are balanced to 1e-9 of the largest nodal force
    assert given.pressure == pytest.approx(found.pressure, rel=1e-6, abs=1e-6 * found.pressure.max())


def test_even_pressure_all_around_makes_nothing_yield() -> None:
    """J2: fluid all around both bodies, four times their yield stress, and a wall that gives way as they shrink.

    What is left is the strain of 2e-3 itself, by which the faces come closer where they are a gap apart.
    """
    model, force = seal(
        LAW, 3e7, closure=HARDENING, seat=HARDENING, refine=0.35, wider=1.5, supports=Supports(wall="fixed")
    )
    p = 4 * YIELD
    seat = model.seat.fem
    places = seat.nodes[0][seat.wall_nodes, 0]
    strain = p * (1 - 2 * STEEL.poissons_ratio) / E
    tight = BodyLoads.press_fit(strain * float(places.max()))
    fluid = BodyLoads.of_fluid((p, p), np.full_like(model.line.x, p), tight)
    few = PlasticSettings(steps=2)
    alone, wet = (
        load_path(model, LAW, [PathLoad(force, loads)], settings=few, unload=False).contacts[0]
        for loads in (BodyLoads(), fluid)
    )
    free = load_path(
        model, LAW, [PathLoad(1e-6 * force, fluid)], settings=PlasticSettings(steps=1), unload=False
    )
    assert alone.states["seat"].plastic.accumulated_strain.max() > 5e-4
    yielded = free.contacts[0].states["seat"].plastic.accumulated_strain
    assert yielded.max() < 1e-3 * strain
    assert wet.profile.peak_pressure == pytest.approx(alone.profile.peak_pressure, rel=strain)
    assert wet.profile.std == pytest.approx(alone.profile.std, rel=strain)


# ---------------------------------------------------------------- balance


@pytest.mark.slow
def test_spring_fluid_and_contact_are_in_balance_at_every_load() -> None:
    model, spring = soft()
    line = model.line
    for contact in relief().contacts:
        # contact and fluid on the ring, the fluid on the closure inside of it, by hand
        loads = contact.loads
        pressure = loads.closure.get(0, 0.0)
        gap = np.zeros_like(line.x) if loads.gap_pressure is None else loads.gap_pressure
        ring = 2 * math.pi * float(line.arc_weight @ (line.radius * (contact.pressure + gap)))
        inner = 0.02 * math.sin(math.radians(45)) + line.vertices[0] * math.cos(math.radians(45))
        total = ring * math.cos(math.radians(45)) + math.pi * inner**2 * pressure
        assert total == pytest.approx(spring, rel=1e-10)
        assert abs(contact.force_error) < 1e-12
        # what the elements of the seat put on its bottom, from their stress
        body = contact.bodies["seat"]
        internal = body.solid.internal_forces(contact.states["seat"].stress)
        bottom = boundary_dofs(body.fem.mesh, "seat_bottom", 1)
        on_faces = pressure * body.fem.further[0][node_dofs(body.fem.mesh)[1]].sum()
        carried = contact.contact_force + float(line.normal[1] @ (line.area_weight * gap)) - on_faces
        assert internal[bottom].sum() == pytest.approx(carried, rel=1e-7)


def test_the_fluid_is_the_one_that_flows_through_the_contact_it_leaves() -> None:
    for contact in relief().contacts[1:]:
        pressure = contact.loads.closure[0]
        again = flowing("inner").unknowns_of(contact.profile, pressure)
        assert contact.loads.gap_pressure / pressure == pytest.approx(again, abs=2e-9)


# ---------------------------------------------------------------- order of loading


def test_the_same_pressure_on_the_way_up_and_down() -> None:
    """A coined seat that is unloaded further and comes back yields no more: the same contact, but for reverse yield."""
    _, up, high, down, _ = relief().contacts
    assert high.contact_force < 0.3 * up.contact_force
    assert down.contact_force == pytest.approx(up.contact_force, rel=1e-4)
    assert down.profile.std == pytest.approx(up.profile.std, rel=1e-2)


def test_a_spring_that_closes_first_leaves_another_seat_than_one_that_comes_with_the_pressure() -> None:
    model, spring = soft()
    together = load_path(
        model,
        LAW,
        [PathLoad(spring, path=flowing("inner"), fluid_pressure=500e5)],
        settings=PlasticSettings(steps=SPRING_FIRST),
        unload=False,
    ).contacts[0]
    after = relief().contacts[2]
    assert after.contact_force == pytest.approx(together.contact_force, rel=0.03)
    # coined by six times the force, the seat fits the ball
    assert after.profile.std > 1.1 * together.profile.std
    assert after.profile.peak_pressure < 0.9 * together.profile.peak_pressure


@pytest.mark.slow
def test_more_steps_change_little() -> None:
    """Implicit Euler, of first order: the width changes by less than a per cent."""
    for few, many in zip(relief(4).contacts, relief().contacts, strict=True):
        assert few.contact_force == pytest.approx(many.contact_force, rel=2e-3)
        assert few.profile.std == pytest.approx(many.profile.std, rel=1e-2)


# ---------------------------------------------------------------- opening


def test_an_open_seal_leaves_no_trace() -> None:
    path = relief()
    assert list(path.open_loads) == [4] and len(path.contacts) == 5
    assert "the fluid lifts the closure off" in str(path.open_loads[4].error)
    model, _ = soft()
    # the spring's force on a circle inside the contact
    radius = math.sqrt(soft()[1] / (math.pi * path.open_loads[4].error.blow_off_pressure))
    assert abs(radius - model.initial_contact_radius) < 3 * path.contacts[0].profile.std
    assert path.contacts[-1].contact_force > path.contacts[1].contact_force


@pytest.mark.slow
@pytest.mark.parametrize("fluid", [flowing("inner"), FluidAtContact("inner")], ids=["flowing", "held"])
def test_blow_off_of_a_coined_seat_is_where_its_path_ends(fluid: FluidPath) -> None:
    """Foretold from the unloading of the coined bodies, and met by the path."""
    model, spring = soft()
    few = PlasticSettings(steps=4)
    coined = load_path(
        model, LAW, [PathLoad(spring, path=fluid, fluid_pressure=0.0)], settings=few, unload=False
    ).contacts[0]
    assert isinstance(coined, ElastoplasticContact)
    opens = blow_off_pressure(CoupledContact(coined.unloading_model, LAW, fluid), applied_force=spring)
    pressures = (0.0, 0.995 * opens, 1.005 * opens)
    path = load_path(
        model,
        LAW,
        [PathLoad(spring, path=fluid, fluid_pressure=one) for one in pressures],
        settings=few,
        unload=False,
    )
    assert list(path.open_loads) == [2]
    closed = path.contacts[1]
    # a held fluid gets through while there still is a contact
    assert 0 < closed.contact_force < (0.03 if isinstance(fluid, PenetratingFluid) else 0.1) * spring
    radius = effective_radius(closed, pressures[1])
    assert radius == pytest.approx(model.initial_contact_radius, abs=3 * coined.profile.std)


def test_bodies_answer_to_unloading_as_their_path_does() -> None:
    """The linear model of a coined seat at a smaller force is the contact that the path finds there."""
    model, spring = soft()
    few = PlasticSettings(steps=4)
    coined, less = load_path(
        model, LAW, [PathLoad(spring), PathLoad(0.7 * spring)], settings=few, unload=False
    ).contacts
    foretold = solve(coined.unloading_model, LAW, contact_force=0.7 * spring)
    assert less.pressure == pytest.approx(foretold.pressure, rel=1e-3, abs=1e-3 * less.pressure.max())


# ---------------------------------------------------------------- from the case file

VALVE = {
    "closure": {"shape": "ball", "radius": "10 mm", "material": "tungsten carbide"},
    "seat": {
        "shape": "cone",
        "angle": "45 deg",
        "material": {
            "youngs_modulus": "210 GPa",
            "poissons_ratio": 0.3,
            "hardness": "1.5 GPa",
            "stress_strain": {"plastic_strain": [0, 0.05], "stress": ["250 MPa", "350 MPa"]},
        },
    },
    "roughness": {
        "spectrum": {
            "kind": "self-affine",
            "rms_height": "1 um",
            "hurst": 0.8,
            "q_low": "5e3 1/m",
            "q_rolloff": "5e4 1/m",
            "q_high": "2e6 1/m",
        }
    },
    "fluid": {"name": "water"},
    "load": {
        "pressure_side": "inner",
        "closing": "penetration",
        "applied_force": "6 kN",
        "largest_earlier_force": "6 kN",
        "fluid_pressure": ["100 bar", "350 bar", "450 bar", "100 bar"],
    },
    "mesh": {"contact_size": "50 um"},
}


def valve(**load: object) -> fem_seal.Case:
    return fem_seal.Case(**{**VALVE, "load": {**VALVE["load"], **load}})  # type: ignore[arg-type]


@cache
def valve_run() -> tuple[SealProblem, ContactModel, SolvedLoads]:
    problem = SealProblem.of(valve())
    evaluated = evaluate(problem)
    model, solved = evaluated.model, evaluated.solved_loads
    return problem, model, solved


@pytest.mark.slow
def test_a_relief_valve_from_its_case() -> None:
    problem, model, solved = valve_run()
    # 450 bar is more than the spring holds on a radius of 7.07 mm; the loads after it go on
    assert list(solved.failures) == [2]
    assert "give an applied_force above" in solved.problems[2].message
    assert [contact.loads.closure[0] for contact in solved.contacts] == [100e5, 350e5, 100e5]
    assert solved.unloaded_bodies is not None and "seat" in solved.unloaded_bodies.imprints
    assert [one.contact_force for one in largest_before(solved.contacts)] == [6000.0]
    # the path of the case is that of the solver called by hand
    solver = LoadSolver(problem, model)
    path = load_path(
        model, problem.law, [solver.on_path(0.0, 6000.0), solver.on_path(100e5, 6000.0)], unload=False
    )
    assert path.contacts[1].pressure == pytest.approx(solved.contacts[0].pressure, rel=1e-9)
    opens = solver.blow_off_pressure(6000.0, solved.contacts[0])
    assert opens == pytest.approx(6000 / (math.pi * problem.initial_contact_radius**2), rel=0.02)
    # after a larger load less leaks than through surfaces that remember nothing
    flow = SealFlow.of(problem)
    assert flow is not None
    first, high, again = solved.contacts
    assert flow.leak_of(high, 350e5).leak_rate > 3.5 * flow.leak_of(first, 100e5).leak_rate
    assert flow.leak_of(again, 100e5).leak_rate == pytest.approx(
        flow.leak_of(first, 100e5).leak_rate, rel=0.02
    )


@pytest.mark.slow
@pytest.mark.parametrize("closing", ["penetration", "sealed-area"])
def test_the_force_for_a_target_leaks_the_target_as_a_case_of_its_own(closing: str) -> None:
    asked = valve(closing=closing, fluid_pressure="100 bar", applied_force="3 kN", largest_earlier_force=None)
    target = 0.5 * leak_of(asked)
    (force,) = fem_seal.applied_force_for_leak(asked, target)
    # another mesh, sized for another force
    assert leak_of(asked.replace({"load.applied_force": f"{force:.12g} N"})) == pytest.approx(
        target, rel=1e-2
    )


def leak_of(case: fem_seal.Case) -> float:
    problem = SealProblem.of(case)
    solved = evaluate(problem).solved_loads
    flow = SealFlow.of(problem)
    assert flow is not None
    return flow.leak_of(solved.contacts[-1], problem.loads.points[-1][0]).leak_rate


# ---------------------------------------------------------------- uncertain inputs


@pytest.mark.slow
def test_samples_of_a_surface_linearise_bodies_that_yield() -> None:
    """Against a path of its own for every sample: off by less than 6 % of what the sample changes ln Q by, or 1e-3."""
    problem, result = sampled()
    settings = Uncertainty(rms_height=Spread(relative=0.1), hardness=Spread(relative=0.1))
    assert result.contact[0].states["seat"].plastic.accumulated_strain.max() > 1e-3  # type: ignore[attr-defined]
    (same,) = solve_linearised(result.contact, problem.law)
    assert same.pressure == pytest.approx(result.contact[0].pressure, rel=1e-6)
    samples = Samples.of(result, settings)
    assert not samples.follow_paths
    linear, whole = (samples.leak_rates(range(2), whole_paths=each) for each in (False, True))
    changed = np.abs(np.log(whole / samples.of_case))
    assert (changed > 0.02).all()
    assert (np.abs(np.log(linear / whole)) < np.maximum(0.06 * changed, 1e-3)).all()


@pytest.mark.slow
def test_a_sample_of_the_modulus_has_its_own_path() -> None:
    _, result = sampled()
    samples = Samples.of(result, Uncertainty(youngs_modulus=Spread(relative=0.07)))
    assert samples.follow_paths
    (rates,) = samples.leak_rates([0])
    factor = samples.values["youngs_modulus"][0, 0]
    assert abs(math.log(factor)) > 0.02
    # as a case of its own, on a mesh of its own
    moduli = {f"{body}.material.youngs_modulus": f"{factor * size:.9g} Pa" for body, size in MODULI.items()}
    assert rates[0, 0] == pytest.approx(leak_of(result.case.replace(moduli)), rel=5e-3)
    assert abs(rates[0, 0] / samples.of_case[0, 0] - 1) > 0.02


MODULI = {"closure": 600e9, "seat": 210e9}


@cache
def sampled() -> tuple[SealProblem, SolvedSeal]:
    """One load of the valve as a result."""
    case = valve(fluid_pressure="50 bar", applied_force="4 kN", largest_earlier_force=None).replace(
        {
            "roughness.spectrum.rms_height": "2 um",
            "seat.material.stress_strain": {"plastic_strain": [0, 0.05], "stress": ["120 MPa", "180 MPa"]},
            "closure.material": {"youngs_modulus": "600 GPa", "poissons_ratio": 0.22},
        }
    )
    problem = SealProblem.of(case)
    evaluated = evaluate(problem)
    mesh, model, solved = evaluated.seal_mesh, evaluated.model, evaluated.solved_loads
    (contact,) = solved.contacts
    rough = LeakModel.of(problem.surface, problem.flow, [contact])
    load = LoadResult(*problem.loads.points[0], contact).with_values(rough=rough)
    return problem, SolvedSeal(case, problem, mesh, model, tuple(case_loads(problem, [load])))


@pytest.mark.slow
def test_a_design_of_a_study_runs_its_own_path() -> None:
    asked = valve(fluid_pressure="350 bar")
    columns = [
        "applied_force_N",
        "contact_force_N",
        "effective_seal_radius_m",
        "leak_rate_m3_per_s",
        "load_steps",
    ]
    found = evaluate_design(asked, [*columns, "max_accumulated_plastic_strain", "opening_margin_N"]).values
    _, _, solved = valve_run()
    # there it comes after 100 bar, here straight from the spring: nearly the same path
    assert found["contact_force_N"] == pytest.approx(solved.contacts[1].contact_force, rel=1e-2)
    fluid = math.pi * found["effective_seal_radius_m"] ** 2 * 350e5
    assert found["contact_force_N"] == pytest.approx(found["applied_force_N"] - fluid, rel=1e-9)
    assert found["max_accumulated_plastic_strain"] > 1e-3 and found["leak_rate_m3_per_s"] > 0
    assert 0 < found["opening_margin_N"] < found["contact_force_N"] * 1.1
