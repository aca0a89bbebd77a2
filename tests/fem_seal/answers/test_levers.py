"""Levers: the steps against complete runs with changed inputs, the exponents against what dimensions demand."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest
from places import EXAMPLES
from sample_results import case, run_loads, smooth_result

import fem_seal
from fem_seal.answers.chain import solve
from fem_seal.answers.sensitivities import _round_step, levers
from fem_seal.output.answers.sensitivities import lever_lines, ratio_in_words, step_in_words, strongest_levers
from fem_seal.output.files import summary
from leak import Reading

LOAD = {"fluid_pressure": "20 bar"}


@cache
def found():
    result = fem_seal.run(case(load=LOAD), levers=True)
    return result, {one.key: one for one in result.levers}


def rates(result):
    load = result.loads[0]
    return load.leak.leak_rate, load.reading(Reading.CAPPED).leak.leak_rate


@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("rms_height", {"roughness.spectrum.rms_height": "0.95 um"}),
        ("closure.radius", {"closure.radius": "21 mm"}),
    ],
)
def test_a_step_does_what_a_run_with_the_changed_input_does(key, changes):
    result, known = found()
    run = run_loads(result.case.replace(changes))
    ratios = [after / before for before, after in zip(rates(result), rates(run), strict=True)]
    # tables of conductivity to 1e-5, meshes of their own to a few 1e-4
    assert known[key].ratio == pytest.approx(ratios, rel=1e-3)


def test_half_of_a_drawing_s_value_is_that_of_a_run_with_it():
    # Ra of Gaussian heights 0.16 and 0.08 um: lambda_c is 0.8 mm and 0.25 mm
    known = {"process": "lapped", "hurst": 0.8, "q_rolloff": "3e5 1/m", "q_high": "1e7 1/m"}
    result = run_loads(case(load=LOAD, roughness={"Rq": "0.2 um", **known}))
    run = run_loads(result.case.replace({"roughness.Rq": "0.1 um"}))
    ratios = [after / before for before, after in zip(rates(result), rates(run), strict=True)]
    (lever,) = (one for one in levers(result) if one.key == "rms_height")
    assert step_in_words(result.case, lever) == "halve Rq"
    assert lever.ratio == pytest.approx(ratios, rel=1e-3)
    # longer waves alone would be left over
    longer = run_loads(result.case.replace({"roughness.Rq": "0.1 um", "roughness.lambda_c": "0.8 mm"}))
    assert rates(longer)[0] < 0.97 * rates(run)[0]


def test_a_tenth_more_force_is_that_of_the_contact_where_nothing_else_closes():
    result, known = found()
    force = known["force"]
    assert force.after == pytest.approx(0.1 * result.loads[0].contact_force, rel=1e-12)
    run = run_loads(result.case.replace({"load.applied_force": force.after}))
    ratios = [after / before for before, after in zip(rates(result), rates(run), strict=True)]
    assert force.ratio == pytest.approx(ratios, rel=1e-3)
    assert force.straight and step_in_words(result.case, force) == "126 N more closing force"


def test_modulus_hardness_and_force_together_leave_the_contact_as_it_is():
    # all pressures of the bodies times one factor: no length changes, and the fluid drives as before
    _, known = found()
    for reading in (0, 1):
        total = sum(known[key].exponents[reading] for key in ("youngs_modulus", "hardness", "force"))
        # exponents over steps of 2 and 1 per cent, of which the largest is 2
        assert total == pytest.approx(0.0, abs=0.03)


def test_strongest_levers_are_told_with_both_readings():
    result, known = found()
    strengths = [one.strength for one in result.levers]
    assert strengths == sorted(strengths, reverse=True)
    assert strongest_levers(result)[0].key == "rms_height"
    told = known["rms_height"]
    assert told.factor == 0.5 and told.ratio[1] < told.ratio[0] < 0.3
    text = lever_lines(result)
    assert text[0] == "Strongest levers at 20 bar:" and len(text) == 4
    assert text[1].startswith("  half the roughness heights: leak × ")
    assert summary(result)["levers"][0]["says"] in text[1]


def test_a_lever_that_seals_is_no_exponent():
    result, known = found()
    sealing = replace(known["rms_height"], ratio=(0.0, 0.0), exponents=(math.nan, math.nan))
    assert sealing.strength == math.inf and not sealing.straight
    assert ratio_in_words(sealing) == "seals"
    contradicting = replace(known["hardness"], ratio=(0.8, 1.3))
    assert contradicting.strength == 0.0
    assert replace(known["force"], ratio=(0.5, 0.5)).straight is False
    assert step_in_words(result.case, replace(known["force"], before=100.0, factor=1.1)) == (
        "10 % more force of spring or actuator"
    )


def test_there_are_no_levers_without_a_leak():
    assert levers(smooth_result()) == ()
    assert lever_lines(smooth_result()) == []


def test_steps_of_lengths_are_round():
    assert [_round_step(one) for one in (0.02, 0.1e-3, 1e-3)] == pytest.approx([1e-3, 5e-6, 5e-5])


@cache
def coined():
    examples = EXAMPLES
    case = fem_seal.load_case(examples / "elastoplastic_seat.toml")
    changes = {
        "load.fluid_pressure": ["200 bar", "50 bar"],
        "load.applied_force": "100 N",
        "mesh.contact_size": "40 um",
    }
    return run_loads(case.replace(changes))


@pytest.mark.slow
def test_levers_of_a_body_that_yields_are_paths_of_their_own(monkeypatch):
    # each lever takes two paths: one dimension and none of the shape of the spectrum stand for the others
    monkeypatch.setattr("fem_seal.answers.sensitivities._MOST_DIMENSIONS", 1)
    monkeypatch.setattr("fem_seal.answers.sensitivities.self_affine_part", lambda roughness: None)
    result = coined()
    assert result.levers == ()
    found = {one.key: one for one in levers(result, 1)}
    assert {"force", "rms_height", "youngs_modulus", "closure.radius"} <= found.keys()
    before = result.loads[1].leak.leak_rate
    changes = {
        "force": {"load.applied_force": ["100 N", "110 N"]},
        "rms_height": {"roughness.spectrum.rms_height": "0.5 um"},
    }
    for key, change in changes.items():
        again = run_loads(result.case.replace(change)).loads[1].leak.leak_rate
        # the same path; tables of conductivity to 1e-4, elements that are chosen for the rougher or smoother surface
        assert found[key].ratio[0] == pytest.approx(again / before, rel=1e-3), key


def test_levers_of_a_path_are_not_looked_for_unless_asked(monkeypatch):
    monkeypatch.setattr("fem_seal.answers.sensitivities.levers", lambda result: pytest.fail("looked for"))
    asked = coined().case.replace({"load.fluid_pressure": "50 bar", "requirement": {"leak_rate": "1 ml/min"}})
    assert solve(asked).levers == ()
