"""A gasket whose flanges meet: what it carries and lets through at the stop, what goes past it, and the way back."""

from __future__ import annotations

import csv
import json
import math
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from fem_seal import Case, run
from fem_seal.answers.target import contacts_at_target
from fem_seal.case.case import load_case
from fem_seal.case.tightening import bolts_of
from fem_seal.contact.newton import ContactProblem, solve
from fem_seal.contact.newton import _solve_from_soft as solve_from_soft
from fem_seal.contact.solution import ContactSettings, ContactSolution
from fem_seal.errors import InputError
from fem_seal.output.answers.compression import OUTPUT
from fem_seal.seal.evaluate import Evaluation, evaluate
from fem_seal.seal.load_solver import solve_again, solve_linearised
from fem_seal.seal.problem import SealProblem
from fem_seal.studies.study import Study

CASE = """
[closure]
shape = "disc"
diameter = "60 mm"
material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, hardness = "3 GPa" }
[gasket]
shape = "ring"
mean_diameter = "40 mm"
section_diameter = "4 mm"
stop = "4 um"
material = { youngs_modulus = "120 GPa", poissons_ratio = 0.34, hardness = "3 GPa" }
[roughness]
spectrum = { kind = "self-affine", rms_height = "1 um", hurst = 0.8, q_low = "5e3 1/m", q_rolloff = "5e4 1/m", \
q_high = "3e6 1/m" }
[fluid]
name = "helium"
[load]
fluid_pressure = "1 bar"
applied_force = ["2 kN", "12 kN", "20 kN"]
pressure_side = "inner"
[mesh]
contact_size = "12 um"
"""
SMOOTH = {"interface__law": "smooth", "mesh__contact_size": None}
STOP, AREA = 4e-6, math.pi * 0.02**2
CURVE = {"plastic_strain": [0, 0.02, 0.1], "stress": ["60 MPa", "120 MPa", "220 MPa"]}
YIELDING = {"gasket__material__stress_strain": CURVE, "roughness__spectrum__rms_height": "0.5 um"}
YIELDING |= {"mesh__contact_size": "16 um"}


@cache
def ring() -> Case:
    return load_case(tomllib.loads(CASE))


def solved(**changes: Any) -> Evaluation:
    """The case with other entries, their paths written with "__" for each dot."""
    entries = {key.replace("__", "."): value for key, value in changes.items()}
    return evaluate(SealProblem.of(ring().replace(entries)))


@cache
def elastic() -> Evaluation:
    return solved()


@cache
def yielding() -> Evaluation:
    """Up to the stop, far beyond it, and back."""
    forces = ["1.5 kN", "6 kN", "20 kN", "6 kN", "1.5 kN"]
    return solved(**YIELDING, load__applied_force=forces)


@pytest.mark.parametrize("law", ["spectrum", "smooth"])
def test_gasket_stop_and_fluid_carry_the_applied_force(law: str) -> None:
    found = elastic() if law == "spectrum" else solved(**SMOOTH)
    for load, at_stop in zip(found.loads, (False, True, True), strict=True):
        assert math.isfinite(load.contact.model.stop)
        fluid = AREA * load.fluid_pressure
        assert load.contact_force + load.contact.stop_force + fluid == pytest.approx(
            load.applied_force, rel=1e-9
        )
        assert load.contact.force_error == pytest.approx(0.0, abs=1e-9)
        assert (load.contact.stop_force > 0) == at_stop
        assert (2 * load.contact.approach == STOP) == at_stop


@pytest.mark.parametrize("law", ["spectrum", "smooth"])
def test_the_gasket_is_that_of_the_force_which_presses_it_to_the_stop(law: str) -> None:
    """The same bodies without a stop, under the force that the gasket has."""
    found = elastic() if law == "spectrum" else solved(**SMOOTH)
    _, at, beyond = found.loads
    free = solve(at.contact.without_stop.model, found.problem.law, contact_force=at.contact_force)
    assert 2 * free.approach == pytest.approx(STOP, rel=1e-7)
    assert free.pressure == pytest.approx(at.contact.pressure, rel=1e-5, abs=1.0)
    # what presses beyond the stop does not reach the gasket
    assert beyond.contact_force == pytest.approx(at.contact_force, rel=1e-12)
    assert beyond.leak.leak_rate == pytest.approx(at.leak.leak_rate, rel=1e-9)


def test_a_case_without_a_stop_and_that_force_is_the_same_seal() -> None:
    at = elastic().loads[-1]
    alone = f"{at.contact_force + AREA * at.fluid_pressure!r} N"
    (free,) = solved(gasket__stop=None, load__applied_force=[alone]).loads
    # on a mesh of its own
    assert 2 * free.contact.approach == pytest.approx(STOP, rel=1e-4)
    assert free.leak.leak_rate == pytest.approx(at.leak.leak_rate, rel=1e-4)
    assert math.isinf(free.contact.model.stop)


def test_more_force_than_any_gasket_carries_is_solved() -> None:
    """2 MN, with sizes of its own mesh: without a stop the faces could not carry it."""
    far = solved(load__applied_force=["2 MN"], mesh__contact_size=None).loads[0]
    assert far.contact_force == pytest.approx(elastic().loads[-1].contact_force, rel=2e-3)


def test_the_force_at_the_stop_does_not_depend_on_the_mesh() -> None:
    fine = solved(mesh__contact_size="6 um").loads[-1]
    assert fine.contact_force == pytest.approx(elastic().loads[-1].contact_force, rel=1e-3)


def test_compression_and_force_of_the_stop_are_written(tmp_path: Path) -> None:
    file = tmp_path / "ring.toml"
    file.write_text(CASE)
    result = run(load_case(file))
    result.write(tmp_path)
    tables = [list(csv.DictReader((tmp_path / name).open())) for name in ("compression.csv", "leak.csv")]
    for row in (row for table in tables for row in table):
        assert (float(row["stop_force_N"]) > 0) == (float(row["applied_force_N"]) > 10e3)
    assert [float(row["compression_m"]) for row in tables[0]][1:] == [STOP, STOP]
    # the closed forms beside the result are those of the force that the gasket has
    closed = json.loads((tmp_path / "summary.json").read_text())["derived"]["loads"]
    for one, row in zip(closed, tables[1], strict=True):
        assert one["contact_force_N"] == pytest.approx(float(row["contact_force_N"]), rel=1e-9)
    said = " ".join(OUTPUT.page_of(result, result.case.display).details)
    assert "The flanges meet at 4.00" in said and "presses the gasket no harder" in said
    assert "The flanges meet at 4.00" in (tmp_path / "report.html").read_text()


def test_a_stop_that_no_load_reaches_changes_nothing() -> None:
    few = ["2 kN", "3 kN"]
    far = solved(gasket__stop="0.5 mm", load__applied_force=few)
    without = solved(gasket__stop=None, load__applied_force=few)
    for one, two in zip(far.loads, without.loads, strict=True):
        assert one.contact.stop_force == 0.0 and math.isinf(two.contact.model.stop)
        assert one.contact.log_pressure.tobytes() == two.contact.log_pressure.tobytes()


# ---------------------------------------------------------------- bodies that yield


@pytest.mark.slow
def test_a_yielding_ring_stays_at_the_stop_until_that_is_relieved() -> None:
    first, at, beyond, again, back = yielding().loads
    assert first.contact.stop_force == 0.0
    for load in (at, beyond, again):
        assert 2 * load.contact.approach == STOP
        assert load.contact_force == at.contact_force
        assert load.leak.leak_rate == at.leak.leak_rate
        assert load.contact_force + load.contact.stop_force + AREA * 1e5 == pytest.approx(
            load.applied_force, rel=1e-9
        )
    assert back.contact.stop_force == 0.0
    # it springs back along its own way, not that of the force that pressed the flanges
    assert first.contact.approach < back.contact.approach < at.contact.approach
    assert back.leak.leak_rate < first.leak.leak_rate


@pytest.mark.slow
def test_a_yielding_ring_without_a_stop_goes_the_same_way_under_its_own_force() -> None:
    at, back = yielding().loads[1], yielding().loads[-1]
    alone = f"{at.contact_force + AREA * 1e5!r} N"
    without = solved(**YIELDING, gasket__stop=None, load__applied_force=["1.5 kN", alone, "1.5 kN"]).loads
    # the load steps are others
    assert 2 * without[1].contact.approach == pytest.approx(STOP, rel=5e-3)
    assert without[1].leak.leak_rate == pytest.approx(at.leak.leak_rate, rel=5e-3)
    assert without[2].contact.approach == pytest.approx(back.contact.approach, rel=5e-3)
    assert without[2].leak.leak_rate == pytest.approx(back.leak.leak_rate, rel=5e-3)


def warm(growth: tuple[float, float], **changes: Any) -> tuple[list[float], Evaluation]:
    """Compressions [m] at 140 degC, flange and gasket growing by 1e-6/K each."""
    flange, gasket = (f"{one}e-6 1/K" for one in growth)
    expands = {"closure__material__thermal_expansion": flange, "gasket__material__thermal_expansion": gasket}
    found = solved(**expands, temperature={"uniform": "140 degC"}, **changes)
    return [2 * load.contact.face_approach for load in found.loads], found


@pytest.mark.parametrize(("growth", "stop"), [((17, 17), 4.0), ((12, 17), 6.3976), ((17, 12), 1.6024)])
def test_a_warm_ring_is_the_cold_one_at_the_stop_that_both_leave(
    growth: tuple[float, float], stop: float
) -> None:
    """Ring and groove, of 4 mm and 3.996 mm, grow each by its own expansion over 120 K."""
    flange, gasket = growth
    assert stop == pytest.approx(4.0 + 120e-6 * (4000 * gasket - 3996 * flange) - 4.0 * 120e-6 * gasket)
    hot, found = warm(growth)
    cold = solved(gasket__stop=f"{stop} um")
    for one, two, compression in zip(found.loads, cold.loads, hot, strict=True):
        assert one.contact_force == pytest.approx(two.contact_force, rel=1e-6)
        assert one.contact.stop_force == pytest.approx(two.contact.stop_force, rel=1e-6)
        assert one.peak_pressure == pytest.approx(two.peak_pressure, rel=1e-6)
        assert compression == pytest.approx(2 * two.contact.approach, abs=1e-12)


def test_a_ring_that_grows_between_rigid_flanges_is_pressed_by_all_of_it() -> None:
    """Flanges that do not grow stay where they are: the ring of 4 mm grows by 17e-6/K into them."""
    _, found = warm((0, 17), gasket__stop="1 um", closure__material__youngs_modulus="2 TPa")
    cold = solved(gasket__stop="9.16 um", closure__material__youngs_modulus="2 TPa")
    # to first order in the strain of 2e-3
    assert found.loads[-1].contact_force == pytest.approx(cold.loads[-1].contact_force, rel=5e-3)


def test_warm_flanges_are_of_any_height() -> None:
    heights = {height: {"closure__height": height} for height in ("15 mm", "45 mm")}
    cold, hot = (
        [temperature(**changes) for changes in heights.values()]
        for temperature in (
            lambda **changes: [2 * one.contact.face_approach for one in solved(**changes).loads[:1]],
            lambda **changes: warm((12, 17), **changes)[0][:1],
        )
    )
    assert hot == [pytest.approx(one, abs=1e-12) for one in cold]


def test_a_stop_that_heat_closes_is_refused() -> None:
    with pytest.raises(InputError, match="before they touch") as error:
        warm((32, 17))
    assert error.value.problems[0].key == "gasket.stop"


@pytest.mark.slow
def test_a_warm_ring_that_yields_springs_back_as_the_cold_one() -> None:
    """The loads of a path begin where warm faces touch."""
    forces = ["1.5 kN", "20 kN", "1 kN"]
    _, hot = warm((12, 17), **YIELDING, load__applied_force=forces, gasket__stop="5 um")
    cold = solved(**YIELDING, load__applied_force=forces, gasket__stop="7.397 um")
    for one, two in zip(hot.loads, cold.loads, strict=True):
        assert one.contact.face_approach == pytest.approx(two.contact.face_approach, abs=2e-9)
        assert one.peak_pressure == pytest.approx(two.peak_pressure, rel=1e-3)


@pytest.mark.slow
def test_the_way_to_the_stop_does_not_depend_on_the_force_behind_it() -> None:
    """Load steps that 50 kN would take are longer than the whole way to the stop."""
    near, far = (solved(**YIELDING, load__applied_force=[one]).loads[0] for one in ("6 kN", "50 kN"))
    assert near.contact.stop_force > 0
    assert far.contact_force == pytest.approx(near.contact_force, rel=5e-3)


# ---------------------------------------------------------------- solved again


@pytest.mark.slow
def test_with_other_surfaces_the_gasket_keeps_its_compression() -> None:
    """Higher asperities take more of it, and the ring is pressed harder."""
    for found in (elastic(), yielding()):
        at = found.loads[-1 if found is elastic() else 2].contact
        surface = found.problem.surface
        assert surface is not None
        rougher = replace(surface, spectrum=surface.spectrum.scaled(1.1)).interface_law()
        if found is elastic():
            (again,) = solve_again([at], at.model, rougher)
        else:
            (again,) = solve_linearised([at], rougher)
        assert again.approach == at.approach
        assert again.pressing_force == pytest.approx(at.pressing_force, rel=1e-12)
        assert again.contact_force > at.contact_force


# ---------------------------------------------------------------- bolts, fluid, target


@pytest.mark.parametrize("bodies", ["elastic", pytest.param("yielding", marks=pytest.mark.slow)])
def test_the_fluid_relieves_the_stop_before_the_gasket(bodies: str) -> None:
    """Bolts keep their preload, and the gasket its force, up to the pressure that takes all of the stop's force."""
    bolts = {"number": 4, "size": "M8", "length": "40 mm", "youngs_modulus": "210 GPa", "preload": "3 kN"}
    pressures = ["1 bar", "20 bar", "90 bar"]
    load = {"fluid_pressure": pressures, "pressure_side": "inner"}
    bolted = load_case({**tomllib.loads(CASE), "load": load, "bolts": bolts})
    if bodies == "yielding":
        bolted = bolted.replace({key.replace("__", "."): value for key, value in YIELDING.items()})
    low, middle, high = evaluate(SealProblem.of(bolted)).loads
    for load in (low, middle):
        assert load.applied_force == pytest.approx(12e3, rel=1e-9)
        assert load.contact_force == pytest.approx(low.contact_force, rel=1e-9)
        assert load.contact_force + load.contact.stop_force + AREA * load.fluid_pressure == pytest.approx(
            12e3, rel=1e-9
        )
    assert high.contact.stop_force == 0.0 and high.contact_force < low.contact_force
    # from there on gasket and bolts are two springs
    held = bolts_of(bolted)
    assert held is not None
    longer = STOP - 2 * high.contact.approach
    assert high.applied_force == pytest.approx(12e3 + held.stiffness * longer, rel=1e-6)


def test_fluid_between_the_surfaces_keeps_the_stop() -> None:
    found = solved(load__closing="penetration", load__fluid_pressure="5 bar")
    for load in found.loads:
        assert load.contact.applied_force == pytest.approx(load.applied_force, rel=1e-9)
    assert [2 * load.contact.approach == STOP for load in found.loads] == [False, True, True]


def test_no_force_meets_a_target_beyond_the_stop() -> None:
    at = elastic().loads[-1]
    rate = at.leak.leak_rate
    loose, tight = (
        replace(elastic().problem, loads=replace(elastic().problem.loads, target_leak_rate=share * rate))
        for share in (2.0, 0.5)
    )
    found = contacts_at_target([loose])[0]
    assert found.contact_force < at.contact_force
    with pytest.raises(InputError, match="before the flanges meet"):
        contacts_at_target([tight])


def test_a_scratch_leaks_at_the_stop_as_under_the_force_of_the_gasket() -> None:
    scratch = {"scratches": [{"depth": "2 um", "width": "40 um"}]}
    at = solved(form=scratch).loads[-1]
    alone = f"{at.contact_force + AREA * 1e5!r} N"
    free = solved(form=scratch, gasket__stop=None, load__applied_force=[alone]).loads[0]
    assert at.leak.leak_rate == pytest.approx(free.leak.leak_rate, rel=1e-3)


@pytest.mark.slow
def test_a_study_compares_stops() -> None:
    tables = {
        "parameters": {"gasket.stop": ["2 um", "3 um", "4 um"]},
        "changes": {"load.applied_force": "20 kN"},
    }
    wanted = ["leak_rate_m3_per_s", "stop_force_N"]
    rows = Study(ring(), responses=wanted, **tables).run(workers=1).table
    for name in wanted:
        found = [float(one) for one in rows[name]]
        assert found == sorted(found, reverse=True) and found[0] > 1.1 * found[-1]


# ---------------------------------------------------------------- input


def test_a_stop_beyond_half_of_the_section_is_refused() -> None:
    with pytest.raises(InputError, match="more than half the height of the gasket, which is 4"):
        ring().replace({"gasket.stop": "2.5 mm"})


def test_a_stop_between_different_flanges_is_refused() -> None:
    seat = {"shape": "conical-face", "angle": "20 deg", "bore_diameter": "34 mm", "face_diameter": "48 mm"}
    seat["material"] = "316L"
    with pytest.raises(InputError, match=r"gasket\.stop"):
        ring().replace(seat=seat)


@pytest.mark.parametrize("force", [2e3, 4e3, 2e4, 2e6])
def test_from_a_soft_interface_the_same_contact_is_found(force: float) -> None:
    one = elastic().loads[0].contact
    pressing = ContactProblem(
        one.model, elastic().problem.law, force, settings=ContactSettings(max_iterations=40)
    )
    direct, softened = solve(one.model, pressing.law, contact_force=force), solve_from_soft(pressing)
    assert isinstance(softened, ContactSolution)
    assert softened.approach == pytest.approx(direct.approach, rel=1e-9)
    assert softened.stop_force == pytest.approx(direct.stop_force, rel=1e-8, abs=1e-6)
