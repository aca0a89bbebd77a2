"""Two different flange faces in all that takes the leak rate of a load: studies, sensitivities, forces, live page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from flanges import BOTH, COARSE, CONE, DISC, FINE, surface, tables

from fem_seal import Case, SealResult, run
from fem_seal.answers.pass_probability import pass_probabilities
from fem_seal.answers.sensitivities import sensitivities
from fem_seal.output.columns import COLUMNS
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.load_result import SolvedSeal
from fem_seal.seal.problem import SealProblem
from fem_seal.studies.responses import evaluate_design

CLOSE = {"hardness": {"relative": 0.1}, "samples": 64}


def case(closure: Mapping[str, Any], rough: Mapping[str, Any], **others: Any) -> Case:
    return Case(**tables(dict(closure), dict(rough), **{"requirement": None, "uncertainty": None, **others}))


UPPER, LOWER = case(DISC, FINE), case(CONE, COARSE)
UNLIKE = case(DISC, BOTH, seat=CONE)
SWAPPED = case(CONE, {"closure": BOTH["seat"], "seat": BOTH["closure"]}, seat=DISC)


def of_two_equal_faces(one: Case) -> SealProblem:
    """The problem of alike flanges on the way of different ones."""
    problem = SealProblem.of(one)
    return replace(problem, lower_half=problem)


@cache
def seal_of(one: Case) -> SolvedSeal:
    return evaluate(SealProblem.of(one)).seal(one)


def rates(seal: SolvedSeal) -> list[float]:
    return [one.leak.leak_rate for load in seal.loads for one in load.readings.values() if one.leak]


def test_two_equal_faces_leak_as_alike_ones() -> None:
    (load,) = evaluate(of_two_equal_faces(UPPER)).loads
    (alike,) = seal_of(UPPER).loads
    assert load.of_faces is not None and alike.of_faces is None
    for reading, one in load.readings.items():
        assert one.leak is not None and alike.reading(reading).leak is not None
        assert one.leak.leak_rate == pytest.approx(alike.reading(reading).leak.leak_rate, rel=1e-9)


def test_faces_may_be_swapped() -> None:
    assert rates(seal_of(UNLIKE)) == pytest.approx(rates(seal_of(SWAPPED)), rel=1e-9)


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
