"""The largest load before the loads of a case: its contact, what asperities and bodies remember, and the report."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from places import EXAMPLES
from sample_results import SPECTRUM, STEEL, case, cone

import fem_seal
import leak
from fem_seal.answers.accuracy import NOT_ESTIMATED
from fem_seal.answers.case_load import CaseLoad, case_loads
from fem_seal.answers.profile_leak import leak_of_profiles
from fem_seal.answers.target import contacts_at_target
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.contact.solution import largest_before
from fem_seal.errors import InputError
from fem_seal.output.answers.contact import history
from fem_seal.output.pictures.leak import memory_picture
from fem_seal.output.pictures.style import style
from fem_seal.output.report.page import report
from fem_seal.result import SealResult
from fem_seal.seal.circumference import LeakCurve
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import solve_again, solve_linearised
from fem_seal.seal.problem import SealProblem
from fem_seal.validity.checks import load_validity
from leak import Reading

FORCES = ("300 N", "1 kN", "2 kN")


def steps(
    forces: Any = FORCES, earlier: str | None = None, load: dict[str, Any] | None = None, **tables: Any
) -> fem_seal.Case:
    steps = {"fluid_pressure": "5 bar", "applied_force": list(forces), **(load or {})}
    return case(load=steps if earlier is None else {**steps, "largest_earlier_force": earlier}, **tables)


def solved(asked: fem_seal.Case) -> list[CaseLoad]:
    """Loads with their leak, without all that a run adds."""
    problem = SealProblem.of(asked)
    found = evaluate(problem).solved_loads
    assert not found.failures
    rough = LeakModel.of(problem.surface, problem.flow, found.contacts)
    points = problem.loads.points
    bare = [LoadResult(*point, contact, rough) for point, contact in zip(points, found.contacts, strict=True)]
    return case_loads(problem, bare)


def first_loading(load: CaseLoad) -> CaseLoad:
    """A load as if no place had carried more; itself where none has."""
    return load.scenarios.get("first loading", load)


def rates(loads: list[CaseLoad]) -> np.ndarray:
    """Leak rates, shape (loads, 2): C_pl and capped."""
    return np.array([[one.leak.leak_rate for one in (load, *load.others.values())] for load in loads])  # type: ignore[union-attr]


@cache
def after(earlier: str) -> list[CaseLoad]:
    return solved(steps(earlier=earlier))


# ------------------------------------------------------------------ bodies that come back


def test_leaks_less_than_on_first_loading_and_the_less_the_harder_it_was_closed() -> None:
    first, proof, harder = rates(solved(steps())), rates(after("3 kN")), rates(after("5 kN"))
    assert np.all(proof < first) and np.all(harder < proof)
    # and still less under more force
    assert np.all(np.diff(harder, axis=0) < 0)
    # elastic contact is the same: only what leaks differs
    of_first = rates([first_loading(load) for load in after("3 kN")])
    np.testing.assert_allclose(of_first, first, rtol=2e-3)  # another mesh, wide enough for the earlier load


def test_is_first_loading_where_the_earlier_load_was_not_larger() -> None:
    asked = case(load={"fluid_pressure": ["5 bar", "20 bar"], "largest_earlier_pressure": "20 bar"})
    low, high = solved(asked)
    assert low.leak.leak_rate < first_loading(low).leak.leak_rate  # type: ignore[union-attr]
    assert high.leak.leak_rate == pytest.approx(first_loading(high).leak.leak_rate, rel=1e-12)  # type: ignore[union-attr]
    smaller = solved(steps(earlier="100 N"))
    firsts = [first_loading(load) for load in smaller]
    np.testing.assert_allclose(rates(smaller), rates(firsts), rtol=1e-9)


def test_the_loads_of_the_list_leave_nothing_to_each_other() -> None:
    backwards = rates(solved(steps(FORCES[::-1], "3 kN")))[::-1]
    np.testing.assert_allclose(backwards, rates(after("3 kN")), rtol=1e-12)


def test_the_earlier_load_acts_without_fluid() -> None:
    problem = SealProblem.of(steps(earlier="3 kN"))
    evaluated = evaluate(problem)
    model, found = evaluated.model, evaluated.solved_loads
    (earlier,) = largest_before(found.contacts)
    assert earlier.contact_force == 3e3
    assert earlier.largest is None
    for contact in found.contacts:
        np.testing.assert_array_equal(contact.largest, earlier.pressure)
    again = solve_again(found.contacts, model, problem.law)
    for one, other in zip(again, found.contacts, strict=True):
        assert one.largest == pytest.approx(other.largest, rel=1e-8, abs=1.0)


def test_gaps_that_the_bodies_open_are_not_remembered() -> None:
    smooth = {**SPECTRUM, "rms_height": "0.1 um"}
    (load,) = solved(steps(("300 N",), "5 kN", roughness={"spectrum": smooth}))
    profile, before = load.contact.profile, load.contact.largest
    assert before is not None and profile.largest is not None
    over = before.max() / profile.pressure.max()
    # Hertz contact: the earlier one was wider
    beside = np.flatnonzero(profile.pressure > 1e-6 * profile.pressure.max())[[0, -1]]
    assert np.all(before[beside] > 10 * over * profile.pressure[beside])
    np.testing.assert_allclose(profile.largest[beside], over * profile.pressure[beside], rtol=1e-12)
    # at the peak nothing is taken away
    peak = int(np.argmax(profile.pressure))
    assert profile.largest[peak] == pytest.approx(before.max(), rel=1e-3)


def test_critical_separation_and_table_know_it() -> None:
    load = after("5 kN")[0]
    assert load.rough is not None
    profile = load.contact.profile
    assert profile.highest > profile.pressure.max()
    surface, (x, peak) = load.rough.surface, profile.peak
    largest = float(np.interp(x, profile.x, profile.largest))  # type: ignore[arg-type]
    assert load.critical_separation == surface.critical_separation(peak, largest=largest)
    assert (
        load.scenarios[Reading.CAPPED].critical_separation
        < first_loading(load).scenarios[Reading.CAPPED].critical_separation
    )  # type: ignore[operator]


def test_fluid_between_the_surfaces_follows_what_they_remember() -> None:
    more = {"closing": "penetration", "pressure_side": "inner"}
    first, proof = (solved(steps(("1.2 kN",), earlier, more))[0] for earlier in (None, "3 kN"))
    for load in (first, proof):
        assert load.contact.applied_force == pytest.approx(1200.0, rel=1e-9)
    assert rates([proof])[0, 1] < 0.9 * rates([first])[0, 1]
    # the fluid pressure with which the contact was solved is the one that its leak has
    found = proof.leak.fluid_pressure / proof.fluid_pressure  # type: ignore[union-attr]
    assert np.abs(proof.contact.loads.gap_pressure / 5e5 - found).max() < 2e-3  # type: ignore[operator]


def test_less_force_meets_a_target_after_a_proof_load() -> None:
    target = 3e-8
    forces = []
    for earlier in (None, "6 kN"):
        problem = SealProblem.of(steps(("1 kN",), earlier, {"target_leak_rate": "0.03 cm^3/s"}))
        (found,) = contacts_at_target([problem], target)
        assert found.leak is not None
        assert found.leak.leak_rate == pytest.approx(target, rel=1e-4)
        forces.append(found.applied_force)
    assert forces[1] < forces[0]


def test_a_body_that_would_have_yielded_under_the_earlier_load_is_doubtful_at_every_load() -> None:
    soft = {**STEEL, "yield_stress": "60 MPa"}
    problem = SealProblem.of(steps(("300 N",), "5 kN", seat=cone(soft)))
    found = evaluate(problem).solved_loads
    load = LoadResult(*problem.loads.points[0], found.contacts[0], mesh_error=NOT_ESTIMATED)
    new = load.with_values(contact=replace(load.contact, earlier=None))
    assert not [one for one in load_validity(problem, new).cautions if one.kind == "yield stress"]
    validity = load_validity(problem, load)
    (caution,) = [one for one in validity.cautions if one.kind == "yield stress"]
    assert caution.reason().startswith("largest earlier load: seat: von Mises stress")
    assert validity.level == caution.level


def test_a_zero_that_an_earlier_load_has_left_is_as_doubtful_as_its_own() -> None:
    """Pressed to half of the hardness once, the seal stays shut: what was doubtful then is said of the later load."""
    earlier = "1 MN"
    problem = SealProblem.of(steps(("300 N",), earlier))
    (load,) = solved(steps(("300 N",), earlier))
    assert load.leak is not None
    assert load.leak.leak_rate == 0.0
    assert load.contact.profile.peak_pressure < 0.1 * problem.hardness
    validity = load_validity(problem, load)
    assert validity.level.name in ("DOUBTFUL", "OUTSIDE")
    assert any(reason.startswith("largest earlier pressure") for reason in validity.reasons)
    assert any(reason.startswith("sealed by the percolation threshold") for reason in validity.reasons)


def test_the_fluid_pressure_that_once_closed_it_acts_between_the_surfaces_too() -> None:
    load = {
        "fluid_pressure": ["5 bar", "30 bar"],
        "closing": "penetration",
        "largest_earlier_pressure": "30 bar",
    }
    problem = SealProblem.of(case(load=load))
    found = evaluate(problem).solved_loads
    low, high = found.contacts
    (earlier,) = largest_before(found.contacts)
    # first loading at the pressure itself, although it was solved as a contact that remembers
    np.testing.assert_allclose(high.pressure, earlier.pressure, rtol=1e-6, atol=10.0)
    assert low.profile.largest is not None and low.profile.highest > 3 * low.pressure.max()


# ------------------------------------------------------------------ seals that are not round

OVAL = {"seat": {"direction": "radial", "harmonics": [{"waves": 2, "amplitude": "0.6 um"}]}}


@cache
def oval() -> CaseLoad:
    problem = SealProblem.of(steps(("300 N",), "3 kN", form=OVAL))
    found = evaluate(problem).solved_loads
    (contact,), (circumference,) = found.contacts, found.circumferences
    bare = LoadResult(*problem.loads.points[0], contact, circumference=circumference)
    rough = LeakModel.of(problem.surface, problem.flow, bare.contacts)
    return case_loads(problem, [bare.with_values(rough=rough)])[0]


def test_every_place_of_the_circumference_remembers_its_own_load() -> None:
    load = oval().scenarios[Reading.CAPPED]
    assert load.rough is not None and load.circumference is not None and load.around is not None
    # the earlier load was more even around the axis
    assert load.circumference.before is not None
    assert load.circumference.before.least_over_mean > load.circumference.least_over_mean
    # every angle by itself, instead of the lattice in both line loads
    flow = load.rough.at(load.fluid_pressure)
    assert flow is not None and load.around.leak_rate is not None
    step = len(load.circumference.angle) // 16
    each = np.array([flow.leak(profile).leak_rate for profile in load.circumference.profiles(step)])
    np.testing.assert_allclose(2 * np.pi * load.around.leak_rate[::step], each, rtol=3e-3)
    first = first_loading(oval()).scenarios[Reading.CAPPED]
    assert load.leak.leak_rate < 0.8 * first.leak.leak_rate  # type: ignore[union-attr]
    assert first.circumference is not None and first.circumference.before is None


def test_an_earlier_load_as_large_as_the_present_one_is_first_loading_at_every_angle() -> None:
    load = oval().scenarios[Reading.CAPPED]
    assert load.rough is not None and load.circumference is not None and load.circumference.before is not None
    before, flow = load.circumference.before, load.rough.at(load.fluid_pressure)
    assert flow is not None
    curve = LeakCurve(before.local, flow)
    first, _ = curve.leak_rates(before.line_load)
    after, _ = curve.leak_rates(before.line_load, before)
    np.testing.assert_allclose(after, first, rtol=1e-9)


def test_scratches_lie_in_a_contact_that_remembers() -> None:
    load = oval().scenarios[Reading.CAPPED]
    assert load.rough is not None and load.circumference is not None
    flow = load.rough.at(load.fluid_pressure)
    assert flow is not None
    scratch = [leak.Scratch(depth=2e-6, width=40e-6)]
    after, first = (
        flow.bounds(one.circumference.profile_at(0.3), scratch)  # type: ignore[union-attr]
        for one in (load, first_loading(oval()).scenarios[Reading.CAPPED])
    )
    own = flow.leak(load.circumference.profile_at(0.3)).leak_rate
    assert after.without.leak_rate == pytest.approx(own, rel=1e-3)
    assert after.without.leak_rate < first.without.leak_rate
    # along the scratch itself, which closes elastically, as much flows as before
    assert after.extra[0] == pytest.approx(first.extra[0], rel=0.2)


# ------------------------------------------------------------------ bodies that yield

SOFT = {
    "name": "soft steel",
    "youngs_modulus": "210 GPa",
    "poissons_ratio": 0.3,
    "hardness": "1.2 GPa",
    "stress_strain": {"plastic_strain": [0, 0.2], "stress": ["300 MPa", "500 MPa"]},
}


def yielding(forces: list[str], earlier: str | None = None) -> list[CaseLoad]:
    return solved(steps(forces, earlier, seat=cone(SOFT), mesh={"contact_size": "80 um"}))


def test_is_the_first_load_of_the_path_of_a_body_that_yields() -> None:
    area = np.pi * case().initial_contact_radius ** 2
    explicit = yielding([f"{4e3 - 5e5 * area} N", "1 kN", "3 kN"])
    proof = yielding(["1 kN", "3 kN"], "4 kN")
    for one, other in zip(proof, explicit[1:], strict=True):
        np.testing.assert_allclose(one.contact.pressure, other.contact.pressure, rtol=1e-9, atol=1.0)
        np.testing.assert_allclose(one.contact.largest, other.contact.largest, rtol=1e-9, atol=1.0)
    first, second = (one.contact for one in proof)
    assert first.largest == pytest.approx(explicit[0].contact.pressure, rel=1e-9, abs=1.0)
    np.testing.assert_array_equal(second.largest, np.maximum(first.pressure, first.largest))
    np.testing.assert_allclose(rates(proof), rates(explicit[1:]), rtol=1e-9)
    assert np.all(rates(proof)[:, 1] < 0.95 * rates([first_loading(load) for load in proof])[:, 1])


# the copper ring between flanges: bodies yield under every load
COPPER = {
    "youngs_modulus": "120 GPa",
    "poissons_ratio": 0.34,
    "hardness": "0.8 GPa",
    "stress_strain": {
        "plastic_strain": [0, 0.02, 0.1, 0.3],
        "stress": ["60 MPa", "120 MPa", "220 MPa", "300 MPa"],
    },
}
RING = [
    {"to": ["18 mm", "0 mm"]},
    {"to": ["22 mm", "0 mm"]},
    {"to": ["22 mm", "0.2 mm"]},
    {"to": ["20 mm", "2.2 mm"], "centre": ["20 mm", "0.2 mm"]},
    {"to": ["18 mm", "0.2 mm"], "centre": ["20 mm", "0.2 mm"]},
    {"to": ["18 mm", "0 mm"], "name": "inner"},
]
FINE = {**SPECTRUM, "rms_height": "0.5 um", "hurst": 0.8, "q_low": "5e3 1/m", "q_rolloff": "5e4 1/m"}


def ring(forces: list[str], earlier: str | None = None, **tables: Any) -> list[CaseLoad]:
    """Loads of the ring with a thousandth of a bar of helium, so that each presses with its own force."""
    more = {} if earlier is None else {"largest_earlier_force": earlier}
    standard: dict[str, Any] = {
        "closure": {
            "shape": "disc",
            "radius": "30 mm",
            "material": {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3},
        },
        "seat": {"shape": "profile", "wall": "free", "outline": RING, "material": COPPER},
        "roughness": {"spectrum": FINE},
        "fluid": {"name": "helium"},
        "load": {"fluid_pressure": "1 mbar", "pressure_side": "inner", "applied_force": forces, **more},
        "mesh": {"contact_size": "12 um"},
    }
    return solved(case(**{**standard, **tables}))


@pytest.mark.slow
def test_what_a_path_has_carried_is_what_the_key_would_say() -> None:
    up, most, down = path = ring(["3 kN", "10 kN", "3 kN"])
    _, straight = ring(["10 kN", "3 kN"])
    (key,) = ring(["3 kN"], "10 kN")
    # 1 mbar takes 0.1 N of 10 kN off
    np.testing.assert_allclose(rates([straight]), rates([key]), rtol=1e-4)
    # with a load on the way the ring yields in more steps, which are of first order
    np.testing.assert_allclose(rates([down]), rates([key]), rtol=0.03)
    # coined faces and flattened asperities are tighter than new ones, in both readings
    assert np.all(rates([down]) < rates([up]))
    for load in path:
        assert np.all(rates([load]) <= rates([first_loading(load)]))
    # a larger load before the path still acts, a smaller one says nothing new
    (_, larger), (_, smaller) = ring(["10 kN", "3 kN"], "12 kN"), ring(["10 kN", "3 kN"], "2 kN")
    assert np.all(rates([larger]) < rates([straight]))
    np.testing.assert_allclose(rates([smaller]), rates([straight]), rtol=0.03)
    # the first load has nothing before it
    (alone,) = ring(["3 kN"])
    assert up.contact.largest is None and alone.contact.largest is None
    assert most.contact.largest is not None


@pytest.mark.slow
@settings(max_examples=4, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.integers(4, 60), min_size=2, max_size=5))
def test_a_place_of_a_path_remembers_the_most_it_has_carried(hundreds: list[int]) -> None:
    """On the way down nothing leaks more than the same contact would if it were the first one."""
    soft = {**SOFT, "stress_strain": {"plastic_strain": [0, 0.2], "stress": ["60 MPa", "150 MPa"]}}
    loads = solved(
        steps([f"{100 * n} N" for n in hundreds], seat=cone(soft), mesh={"contact_size": "0.1 mm"})
    )
    carried = np.array([load.contact.pressure for load in loads])
    for number, load in enumerate(loads[1:], start=1):
        np.testing.assert_array_equal(load.contact.largest, carried[:number].max(axis=0))
        assert np.all(rates([load]) <= rates([first_loading(load)]))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["relief_valve_350_bar", "elastoplastic_seat", "hot_coined_seat"])
def test_no_example_that_yields_leaks_more_than_on_first_loading(name: str) -> None:
    loads = solved(fem_seal.load_case(EXAMPLES / f"{name}.toml"))
    assert all(isinstance(load.contact, ElastoplasticContact) for load in loads)
    for load in loads:
        assert np.all(rates([load]) <= rates([first_loading(load)]))


def test_elastic_asperities_of_a_path_remember_nothing() -> None:
    loads = solved(
        steps(["2 kN", "1 kN"], seat=cone(SOFT), leak={"plasticity": False}, mesh={"contact_size": "80 um"})
    )
    assert all(load.contact.largest is None and not load.remembers for load in loads)


def test_samples_of_some_loads_remember_the_others() -> None:
    problem = SealProblem.of(steps(["1 kN", "3 kN", "2 kN"], seat=cone(SOFT), mesh={"contact_size": "80 um"}))
    found = evaluate(problem).solved_loads
    every = solve_linearised(found.contacts, problem.law)
    (last,) = solve_linearised(found.contacts[2:], problem.law)
    np.testing.assert_array_equal(last.largest, every[2].largest)
    np.testing.assert_allclose(last.largest, found.contacts[2].largest, rtol=1e-6, atol=10.0)


def test_a_path_refuses_what_says_nothing_of_a_larger_load() -> None:
    tables: dict[str, Any] = {"seat": cone(SOFT), "leak": {"fluid_in_gap": "local"}}
    said = "penetration"
    with pytest.raises(
        InputError, match=f"stress_strain with several loads.*{said}|{said}.*stress_strain with"
    ):
        steps(["1 kN", "2 kN"], **tables)
    steps(["1 kN"], **tables)
    steps(["1 kN", "2 kN"], **{**tables, "seat": cone()})


@cache
def loop() -> SealResult:
    soft = {**SOFT, "stress_strain": {"plastic_strain": [0, 0.2], "stress": ["80 MPa", "150 MPa"]}}
    return fem_seal.run(steps(["3 kN", "1 kN"], seat=cone(soft), mesh={"contact_size": "0.1 mm"}))


@pytest.mark.slow
def test_a_run_of_a_path_says_that_it_remembers() -> None:
    up, down = loop().loads
    assert down.remembers and not up.remembers
    (said,) = history(loop(), loop().case.display)
    assert "in the order of the list" in said
    with style():
        picture = memory_picture(loop())
    assert picture is not None and ">after the loads before it<" in picture.svg.decode()
    assert "asperities that yielded under a larger load before" in report(loop(), full=True)
    # the table's row of each load is its own
    np.testing.assert_array_equal(
        loop().table.leak_rate_capped_m3_per_s,
        [load.scenarios[Reading.CAPPED].leak.leak_rate for load in loop().loads],  # type: ignore[union-attr]
    )


# ------------------------------------------------------------------ what is refused


FORCE, PRESSURE = "load.largest_earlier_force", "load.largest_earlier_pressure"


def load(**more: Any) -> dict[str, Any]:
    return {"load": {"fluid_pressure": "5 bar", "applied_force": "1 kN", **more}}


def after_3_kN(**tables: Any) -> dict[str, Any]:
    return {**load(largest_earlier_force="3 kN"), **tables}


@pytest.mark.parametrize(
    ("tables", "key", "said"),
    [
        (load(largest_earlier_force="3 kN", largest_earlier_pressure="9 bar"), PRESSURE, "one of them"),
        (load(largest_earlier_pressure="9 bar", pressure_side="inner"), PRESSURE, "lifts"),
        (load(largest_earlier_pressure="9 bar", applied_force=["1 kN", "2 kN"]), PRESSURE, "several values"),
        (load(largest_earlier_pressure="1 bar", applied_force="-200 N"), PRESSURE, "open"),
        (load(largest_earlier_force="9e7 N"), FORCE, "no contact on these faces carries it"),
        (load(largest_earlier_force="-1 N"), FORCE, "out of range"),
        (after_3_kN(leak={"fluid_in_gap": "local"}), "leak.fluid_in_gap", "penetration"),
        (after_3_kN(leak={"plasticity": False}), FORCE, "has no effect"),
        (after_3_kN(fluid=None), FORCE, "has no effect"),
    ],
)
def test_refuses_what_cannot_be_said(tables: dict[str, Any], key: str, said: str) -> None:
    with pytest.raises(InputError) as raised:
        case(**tables)
    (problem,) = [one for one in raised.value.problems if one.key == key]
    assert said in problem.message


def test_says_nothing_of_profiles_from_elsewhere() -> None:
    asked = steps(("1 kN",), "3 kN")
    with pytest.raises(InputError, match="largest_earlier"):
        leak_of_profiles(SealProblem.of(asked), [])


# ------------------------------------------------------------------ the whole case


@cache
def result() -> SealResult:
    return fem_seal.run(steps(("300 N", "2 kN"), "3 kN"), full=True)


def test_a_run_knows_it_everywhere() -> None:
    loads = list(result().loads)
    np.testing.assert_allclose(rates(loads), rates(after("3 kN"))[[0, 2]], rtol=2e-3)
    # other interface laws are compared on contacts that remember, too
    elastic, plastic = result().interface_variants
    assert elastic.leak_rate == pytest.approx(loads[1].leak.leak_rate, rel=1e-9)  # type: ignore[union-attr]
    assert plastic.leak_rate is not None


@pytest.mark.slow
def test_the_report_shows_the_loop_and_names_the_load() -> None:
    with style():
        picture = memory_picture(result())
    assert picture is not None
    text = picture.svg.decode()
    assert ">after a load of 3000 N<" in text and ">first loading<" in text
    assert "a load of 3000 N" in history(result(), result().case.display)[0]
    page = report(result(), full=True)
    assert 'id="picture-memory"' in page
    assert "largest earlier load" in page
    first = tuple(first_loading(load) for load in result().loads)
    assert memory_picture(replace(result(), loads=first)) is None


def test_words_say_whether_anything_is_remembered() -> None:
    (said,) = history(result(), result().case.display)
    assert "its plastic deformation remains" in said and all(load.remembers for load in result().loads)
    first = tuple(first_loading(load) for load in result().loads)
    assert not any(load.remembers for load in first)
    # as if the earlier load had been the smaller one
    (said,) = history(replace(result(), loads=first), result().case.display)
    assert "first loading counts" in said


def test_an_earlier_load_below_all_others_is_not_remembered() -> None:
    assert not any(load.remembers for load in after("10 N"))
    np.testing.assert_allclose(rates(after("10 N")), rates(solved(steps())), rtol=2e-3)
