"""Two different flange faces in all that takes the leak rate of a load: studies, sensitivities, forces, live page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
import pytest
from flanges import BOTH, COARSE, CONE, DISC, FINE, STEEL, surface, tables

from fem_seal import Case, SealResult, blow_off_pressures, calibrate, run
from fem_seal.answers.answer import loads_of
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.leakage_class import nominal_size, seal_length
from fem_seal.answers.pass_probability import pass_probabilities
from fem_seal.answers.sensitivities import sensitivities
from fem_seal.answers.target import contacts_at_target
from fem_seal.answers.verdict import seal_verdict, with_verdicts
from fem_seal.explore.factors import factors_of
from fem_seal.explore.live import live_screen
from fem_seal.output.columns import COLUMNS, LEAK_COLUMNS
from fem_seal.seal.evaluate import evaluate_seal
from fem_seal.seal.problem import SealProblem, problems_of
from fem_seal.studies.responses import evaluate_design

CLOSE = {"hardness": {"relative": 0.1}, "samples": 64}


def case(closure: Mapping[str, Any], rough: Mapping[str, Any], **others: Any) -> Case:
    return Case(**tables(dict(closure), dict(rough), **{"requirement": None, "uncertainty": None, **others}))


UPPER, LOWER = case(DISC, FINE), case(CONE, COARSE)
UNLIKE = case(DISC, BOTH, seat=CONE)
SWAPPED = case(CONE, {"closure": BOTH["seat"], "seat": BOTH["closure"]}, seat=DISC)


def of_two_equal_faces(one: Case) -> tuple[SealProblem, ...]:
    """The problems of alike flanges on the way of different ones."""
    return (*problems_of(one), *problems_of(one))


@cache
def seal_of(one: Case) -> SolvedSeal:
    evaluations = evaluate_seal(problems_of(one))
    return SolvedSeal.of(evaluations, one, loads_of(evaluations))


def rates(seal: SolvedSeal) -> list[float]:
    return [one.leak.leak_rate for load in seal.loads for one in (load, *load.others.values()) if one.leak]


def test_two_equal_faces_leak_as_alike_ones() -> None:
    two = of_two_equal_faces(UPPER)
    (load,) = loads_of(evaluate_seal(two))
    (alike,) = seal_of(UPPER).loads
    assert len(load.parts) == 2 and len(alike.parts) == 1
    for one, same in ((load, alike), *((one, alike.scenarios[name]) for name, one in load.scenarios.items())):
        assert one.leak is not None and same.leak is not None
        assert one.leak.leak_rate == pytest.approx(same.leak.leak_rate, rel=1e-9)


def test_faces_may_be_swapped() -> None:
    assert rates(seal_of(UNLIKE)) == pytest.approx(rates(seal_of(SWAPPED)), rel=1e-9)


def test_what_is_told_per_length_or_size_is_the_same_upside_down() -> None:
    """The circles of first touch, 20 mm and 20 mm + 2 mm sin 20 deg, and one bore of 34 mm."""
    mean = 2 * np.pi * (20e-3 + 1e-3 * np.sin(np.radians(20)))
    for one in (UNLIKE, SWAPPED):
        (load,) = seal_of(one).loads
        assert seal_length(one) == pytest.approx(mean, rel=1e-9)
        per_length = COLUMNS["leak_rate_per_length_m2_per_s"].value(load)
        assert load.leak is not None
        assert per_length == pytest.approx(load.leak.leak_rate / mean, rel=1e-9)
        assert nominal_size(one).diameter == pytest.approx(34e-3, rel=1e-12)


def test_the_share_that_is_used_is_that_of_the_face_which_uses_more() -> None:
    """A lower flange of a softer and weaker metal; what is said of it does not depend on which of both is above."""
    weak = {**STEEL, "yield_stress": "50 MPa", "hardness": "1 GPa"}
    below, above = ({**one, "material": weak} for one in (CONE, DISC))
    required = {"requirement": {"leak_rate": "1 mbar l/s"}}
    found = {}
    for name, bodies in {
        "lower": (DISC, below),
        "upper": (below, DISC),
        "neither": (DISC, CONE),
        "both": (above, below),
    }.items():
        of = case(bodies[0], FINE, seat=bodies[1], **required)
        seal = seal_of(of)
        judged = seal_verdict(of, with_verdicts(of, seal.loads), {}, of.hardness)
        assert judged is not None
        found[name] = judged.shares
    assert found["lower"].body == "lower closure" and found["upper"].body == "closure"
    assert found["lower"].yield_stress == pytest.approx(found["upper"].yield_stress, rel=1e-9)
    assert found["lower"].hardness == pytest.approx(found["upper"].hardness, rel=1e-9)
    assert found["lower"].hardness > 2 * found["neither"].hardness and found["neither"].yield_stress is None
    assert found["both"].yield_stress >= found["lower"].yield_stress


def test_a_very_rough_face_decides() -> None:
    rough = surface("20 um")
    both = seal_of(case(DISC, {"closure": FINE["closure"], "seat": rough}))
    assert rates(both) == pytest.approx(
        [0.5 * one for one in rates(seal_of(case(DISC, {"closure": rough})))], rel=1e-3
    )


COLUMNS_ASKED = (
    "leak_rate_m3_per_s",
    "peak_pressure_Pa",
    "fwhm_m",
    "leak_rate_low_m3_per_s",
    "leak_rate_high_m3_per_s",
)


def asked(one: Case) -> Case:
    return one.replace(uncertainty=CLOSE, requirement={"leak_rate": "1 mbar l/s"})


@cache
def whole() -> SealResult:
    return run(asked(UNLIKE), sensitivities=False)


@pytest.mark.slow
def test_a_study_has_the_numbers_of_a_run() -> None:
    """On a mesh of its own, as the samples ask for one."""
    (load,) = whole().loads
    found = evaluate_design(asked(UNLIKE), (*COLUMNS_ASKED, "margin"), interpolate=False)
    for name in COLUMNS_ASKED:
        assert found.values[name] == pytest.approx(COLUMNS[name].number(load), rel=1e-6), name
    assert found.verdict is load.verdict and found.validity.level is load.validity.level
    # without them on the bodies that studies share
    shared = evaluate_design(UNLIKE, COLUMNS_ASKED[:3])
    for name in COLUMNS_ASKED[:3]:
        assert shared.values[name] == pytest.approx(COLUMNS[name].number(load), rel=2e-3), name


@pytest.mark.slow
def test_sensitivities_are_those_of_two_complete_runs() -> None:
    found = {one.key: one for one in sensitivities(seal_of(UNLIKE)) if not one.material}
    dimension = next(one for one in found.values() if one.key == "seat.angle")
    assert dimension.after is not None
    force = found["force"]
    changed = {
        "seat.angle": UNLIKE.replace({"seat.angle": dimension.after}),
        "force": UNLIKE.replace({"load.applied_force": force.after}),
    }
    before = rates(seal_of(UNLIKE))
    for key, other in changed.items():
        assert found[key].ratio[0] == pytest.approx(rates(seal_of(other))[0] / before[0], rel=0.01), key
    halved = UNLIKE.replace(
        {
            f"roughness.{one}.rms_height": f"{1e6 * height} um"
            for one, height in (
                ("closure", found["rms_height"].factor * 0.4e-6),
                ("seat", found["rms_height"].factor * 1.2e-6),
            )
        }
    )
    assert found["rms_height"].ratio[0] == pytest.approx(rates(seal_of(halved))[0] / before[0], rel=0.01)


@pytest.mark.slow
def test_the_share_that_passes_is_that_of_the_mean_of_both_faces() -> None:
    """Half of the samples leak less than the median."""
    (load,) = whole().loads
    assert load.leak_rate_p50 is not None
    median = f"{1e3 * load.leak_rate_p50 * 101325 / 100} mbar l/s"
    (found,) = pass_probabilities(
        replace(whole(), case=asked(UNLIKE).replace(requirement={"leak_rate": median}))
    )
    assert found is not None and found.share == pytest.approx(0.5, abs=0.06)


@pytest.mark.slow
def test_the_force_for_a_target_is_that_of_alike_faces_and_of_the_mean() -> None:
    target = 0.5 * rates(seal_of(UPPER))[0]
    (alike,) = contacts_at_target(problems_of(UPPER), target)
    (equal,) = contacts_at_target(of_two_equal_faces(UPPER), target)
    assert len(equal.parts) == 2
    assert equal.applied_force == pytest.approx(alike.applied_force, rel=1e-9)
    target = 0.8 * rates(seal_of(UNLIKE))[0]
    forces = [contacts_at_target(problems_of(one), target)[0].applied_force for one in (UNLIKE, SWAPPED)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-5)
    found = seal_of(UNLIKE.replace({"load.applied_force": forces[0]}))
    assert rates(found)[0] == pytest.approx(target, rel=1e-3)


@pytest.mark.slow
def test_the_verdict_passes_with_its_force_and_not_with_less() -> None:
    target = f"{1e3 * 1e6 * 0.8 * rates(seal_of(UNLIKE))[0]} mm^3/s"
    asked = UNLIKE.replace({"load.target_leak_rate": target}, requirement={"leak_rate": target})
    (load,) = run(asked, sensitivities=False, verdict_force=True).loads
    assert load.force_for_verdict is not None and load.force_for_target is not None
    assert load.force_for_verdict > load.force_for_target
    for factor, verdict in ((1.0, "pass"), (0.96, "pass unless")):
        force = factor * load.force_for_verdict
        tried = asked.replace({"load.applied_force": force, "load.target_leak_rate": None})
        assert run(tried, sensitivities=False).verdict == verdict


def test_the_live_page_shows_the_leak_of_both_faces() -> None:
    screen = live_screen(UNLIKE, {})
    assert screen.problem == "" and screen.delay == ""
    shown = screen.loads[0].values["leak_rate_m3_per_s"]
    assert shown == pytest.approx(rates(seal_of(UNLIKE))[0], rel=5e-3)
    # the lower flange is the lower one: the conical face ends at its bore, the disc has none
    assert screen.section is not None
    upper, lower = screen.section.rings[0]
    assert min(r for r, _ in upper) == 0.0 and min(r for r, _ in lower) == pytest.approx(0.017)
    assert max(z for _, z in lower) < screen.section.middle < min(z for _, z in upper) + 1e-9
    assert "finish_seat" in {one.key: one for one in factors_of(UNLIKE).sliders}


@pytest.mark.slow
def test_a_leak_test_of_different_faces_is_one_of_their_mean() -> None:
    (load,) = whole().loads
    rate = load.leak.leak_rate
    readings = pd.DataFrame(
        {
            "fluid_pressure [bar]": [1],
            "applied_force [N]": [3000],
            "leak_rate [m^3/s]": [rate],
            "uncertainty [%]": [10],
        }
    )
    found = calibrate(asked(UNLIKE), readings)
    assert found.conflict is None and found.p_value > 0.05
    assert found.predictions[-1].prior[1] == pytest.approx(load.leak_rate_p50, rel=0.03)
    assert found.solution is not None


def test_a_gasket_opens_where_the_first_of_its_faces_does() -> None:
    """A smaller circle of first touch carries more pressure."""
    opens = [blow_off_pressures(one)[0] for one in (UNLIKE, UPPER, LOWER)]
    assert opens[0] == min(opens[1:])


@pytest.mark.parametrize("leak", [{"theory": "paper"}, {"fluid_in_gap": "local"}], ids=["paper", "local"])
def test_other_ways_of_the_flow_are_the_mean_of_both_faces(leak: dict[str, Any]) -> None:
    """Water, which opens the gap by its pressure or does not."""
    others = {"leak": leak, "fluid": {"name": "water"}}
    both, upper, lower = (
        seal_of(case(*one, **others, **more))
        for one, more in (((DISC, BOTH), {"seat": CONE}), ((DISC, FINE), {}), ((CONE, COARSE), {}))
    )
    assert rates(both) == pytest.approx(0.5 * np.add(rates(upper), rates(lower)), rel=1e-9)


YIELDS = {
    **DISC,
    "material": {
        **STEEL,
        "stress_strain": {"plastic_strain": [0, 0.02, 0.1], "stress": ["150 MPa", "200 MPa", "300 MPa"]},
    },
}
# of the upper contact
OF_UPPER = {"contact_radius_m", "peak_pressure_Pa", "fwhm_m", "std_m", "max_von_mises_Pa", "knudsen_number"}
OF_UPPER |= {"critical_separation_m", "critical_separation_elastic_m", "effective_viscosity_Pa_s"}


@pytest.mark.slow
def test_a_seal_of_which_one_flange_yields_is_the_same_upside_down() -> None:
    load = {"fluid_pressure": "1 bar", "applied_force": ["1 kN", "3 kN", "1 kN"], "pressure_side": "inner"}
    low, high = (
        run(case(one, FINE, seat=other, load=load, mesh={"contact_size": "20 um"}), sensitivities=False)
        for one, other in ((DISC, YIELDS), (YIELDS, DISC))
    )
    for one, other in zip(low.loads, high.loads, strict=True):
        for name in set(LEAK_COLUMNS) - OF_UPPER:
            column = COLUMNS[name]
            assert column.number(one) == pytest.approx(column.number(other), rel=1e-9, nan_ok=True), name
    assert COLUMNS["max_accumulated_plastic_strain"].number(low.loads[-1]) > 0
    ways = [[step.compression for step in one.compression.steps] for one in (low, high)]
    assert len(ways[0]) == 4 and ways[0] == pytest.approx(ways[1], rel=1e-9)
    assert low.compression.left == pytest.approx(high.compression.left, rel=1e-9)
    assert list(low.imprints) == ["lower closure"] and list(high.imprints) == ["closure"]
    # both faces remember: they are tighter than on the way up, as far as the elastic half springs back
    for before, after in zip(low.loads[0].parts, low.loads[2].parts, strict=True):
        assert after.leak.leak_rate < before.leak.leak_rate
    alone = seal_of(case(DISC, FINE, load=load, mesh={"contact_size": "20 um"}))
    for one, other in zip(low.loads, alone.loads, strict=True):
        assert one.peak_pressure == pytest.approx(other.peak_pressure, rel=1e-6)
        assert one.contact.approach == pytest.approx(other.contact.approach, rel=1e-6)
