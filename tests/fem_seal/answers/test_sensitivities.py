"""Sensitivities: the steps against complete runs with changed inputs, the exponents against what dimensions demand."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import pytest
from places import EXAMPLES
from sample_results import case, cone, rough_result, run_loads, smooth_result, with_new_verdicts

import fem_seal
from fem_seal.answers.chain import solve
from fem_seal.answers.sensitivities import Sensitivity, _ChangedSeal, _round_step, sensitivities
from fem_seal.output.answers.sensitivities import (
    effect_in_words,
    in_words,
    sensitivity_lines,
    shown_sensitivities,
    step_in_words,
    strongest,
)
from fem_seal.output.files import summary
from fem_seal.output.report.brief import second_line
from fem_seal.units import Display
from leak import Reading

LOAD = {"fluid_pressure": "20 bar"}


@cache
def found():
    result = fem_seal.run(case(load=LOAD), sensitivities=True)
    return result, {one.key: one for one in result.sensitivities}


def rates(result):
    load = result.loads[0]
    return load.leak.leak_rate, load.scenarios[Reading.CAPPED].leak.leak_rate


@pytest.mark.slow
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


@pytest.mark.slow
def test_half_of_a_drawing_s_value_is_that_of_a_run_with_it():
    # Ra of Gaussian heights 0.16 and 0.08 um: lambda_c is 0.8 mm and 0.25 mm
    known = {"process": "lapped", "hurst": 0.8, "q_rolloff": "3e5 1/m", "q_high": "1e7 1/m"}
    result = run_loads(case(load=LOAD, roughness={"Rq": "0.2 um", **known}))
    run = run_loads(result.case.replace({"roughness.Rq": "0.1 um"}))
    ratios = [after / before for before, after in zip(rates(result), rates(run), strict=True)]
    (halved,) = (one for one in sensitivities(result) if one.key == "rms_height")
    assert step_in_words(result.case, halved) == "halving Rq"
    assert halved.ratio == pytest.approx(ratios, rel=1e-3)
    # longer waves alone would be left over
    longer = run_loads(result.case.replace({"roughness.Rq": "0.1 um", "roughness.lambda_c": "0.8 mm"}))
    assert rates(longer)[0] < 0.97 * rates(run)[0]


@pytest.mark.slow
def test_a_tenth_more_force_is_that_of_the_contact_where_nothing_else_closes():
    result, known = found()
    force = known["force"]
    assert force.after == pytest.approx(0.1 * result.loads[0].contact_force, rel=1e-12)
    run = run_loads(result.case.replace({"load.applied_force": force.after}))
    ratios = [after / before for before, after in zip(rates(result), rates(run), strict=True)]
    assert force.ratio == pytest.approx(ratios, rel=1e-3)
    assert force.straight and step_in_words(result.case, force) == "126 N more closing force"


@pytest.mark.slow
def test_modulus_hardness_and_force_together_leave_the_contact_as_it_is():
    # all pressures of the bodies times one factor: no length changes, and the fluid drives as before
    _, known = found()
    for reading in (0, 1):
        total = sum(known[key].exponents[reading] for key in ("youngs_modulus", "hardness", "force"))
        # exponents over steps of 2 and 1 per cent, of which the largest is 2
        assert total == pytest.approx(0.0, abs=0.03)


@pytest.mark.slow
def test_strongest_sensitivities_are_told_with_both_readings():
    result, known = found()
    strengths = [one.strength for one in result.sensitivities]
    assert strengths == sorted(strengths, reverse=True)
    assert strongest(result.sensitivities)[0].key == "rms_height"
    told = known["rms_height"]
    assert told.factor == 0.5 and told.ratio[1] < told.ratio[0] < 0.3
    text = sensitivity_lines(result)
    assert len(text) == 3
    assert text[0] == "At 20 bar halving the roughness heights cuts the leak by 75 to 90 %."
    assert summary(result)["levers"][0]["says"] in text[0]
    # of two materials that do the same one is enough, and what no drawing says is not told
    assert sum(one.material != "" for one in strongest(result.sensitivities)) == 1
    assert {"hurst", "q_rolloff", "youngs_modulus"} & {one.key for one in result.sensitivities}
    assert not {"hurst", "q_rolloff", "youngs_modulus"} & {
        one.key for one in shown_sensitivities(result.sensitivities)
    }


@pytest.mark.slow
def test_nothing_below_three_per_cent_is_shown():
    _, known = found()
    one = known["force"]
    shown = {0.96: True, 0.98: False, 1.02: False, 1.04: True, 0.0: True, math.inf: True}
    assert {
        far: bool(shown_sensitivities([replace(one, ratio=(0.5 if far < 1 else 2.0, far))])) for far in shown
    } == shown


@pytest.mark.parametrize(
    ("ratio", "words"),
    [
        ((0.18, 0.11), "cuts the leak by 82 to 89 %"),
        ((0.03, 0.0004), "cuts the leak by 97 to 99.96 %"),
        ((0.4, 0.0), "cuts the leak by 60 to 100 %"),
        ((1.2, 1.04), "raises the leak by 4 to 20 %"),
        ((1.5, 3.0), "makes the leak 1.5 to 3.0 times as large"),
        ((0.8, 1.3), "makes the leak 0.80 to 1.3 times as large"),
        ((math.inf, math.inf), "opens the seal"),
    ],
)
def test_effects_are_told_as_the_field_says_them(ratio, words):
    _, known = found()
    assert effect_in_words(Display(), replace(known["force"], ratio=ratio)) == words


def test_a_change_that_fails_elsewhere_is_not_among_the_strongest():
    halved = Sensitivity("rms_height", None, None, 0.5, (0.2, 0.2), (math.nan, math.nan), helps=False)
    force = Sensitivity("force", 10.0, 11.0, 1.1, (0.8, 0.8), (math.nan, math.nan), helps=True)
    assert strongest([halved, force]) == [force]
    assert shown_sensitivities([halved, force]) == [halved, force]
    assert effect_in_words(Display(), halved).startswith(
        effect_in_words(Display(), replace(halved, helps=None))
    )
    assert effect_in_words(Display(), halved) != effect_in_words(Display(), replace(halved, helps=None))


def test_another_material_stands_beside_the_case_s_own():
    result, _ = found()
    (one,) = (
        one for one in result.sensitivities if (one.key, one.material) == ("seat.material", "stellite 6")
    )
    assert in_words(result.case, one).startswith("seat of stellite 6 instead of steel")
    numbers = {"youngs_modulus": "110 GPa", "poissons_ratio": 0.34, "hardness": "1.2 GPa"}
    unnamed = case(closure={"shape": "ball", "radius": "20 mm", "material": numbers}, seat=cone(numbers))
    assert step_in_words(unnamed, one) == "seat of stellite 6 instead of its own"
    run = run_loads(result.case.replace({"seat.material": "stellite 6"}))
    ratios = [after / before for before, after in zip(rates(result), rates(run), strict=True)]
    assert one.ratio == pytest.approx(ratios, rel=1e-3)


STEEL = {"material": "316L"}
BALL_AND_CONE = {"closure": {"shape": "ball", "radius": "20 mm", **STEEL}, "seat": cone()}


@pytest.mark.parametrize(
    ("bodies", "closure", "seat"),
    [
        (BALL_AND_CONE, {"radius"}, {"angle"}),
        (
            {"seat": {"shape": "conical-land", "angle": "45 deg", "relief_angle": "20 deg", **STEEL}},
            {"radius"},
            {"angle", "land_width", "edge_radius", "relief_angle"},
        ),
        (
            {
                "closure": {"shape": "disc", "radius": "30 mm", "edge_radius": "1 mm", **STEEL},
                "seat": {
                    "shape": "flat-land",
                    "land_inner_radius": "25 mm",
                    "land_outer_radius": "29 mm",
                    "outer_radius": "60 mm",
                    **STEEL,
                },
            },
            {"radius", "edge_radius"},
            {"land_radius", "land_width", "edge_radius"},
        ),
        (
            {
                "closure": {
                    "shape": "cone",
                    "angle": "60 deg",
                    "outer_diameter": "20 mm",
                    "inner_diameter": "10 mm",
                    **STEEL,
                },
                "seat": {"shape": "sharp-edge", "bore_diameter": "16 mm", "edge_radius": "0.1 mm", **STEEL},
            },
            {"angle", "mean_radius", "face_width", "edge_radius"},
            {"bore_radius", "edge_radius"},
        ),
        (
            {"closure": {"shape": "torus", "centre_radius": "15 mm", "radius": "3 mm", **STEEL}},
            {"centre_radius", "radius"},
            {"angle"},
        ),
    ],
)
def test_every_shape_has_the_dimensions_of_its_contact(bodies, closure, seat):
    of = case(**{**BALL_AND_CONE, **bodies})
    changes = _ChangedSeal(SimpleNamespace(case=of), (0,))._dimensions()
    expected = {f"closure.{key}" for key in closure} | {f"seat.{key}" for key in seat}
    assert {one.key for one in changes} == expected


def test_faces_that_fit_each_other_are_turned_together():
    poppet = {"shape": "cone", "angle": "45 deg", "outer_radius": "10 mm", "inner_radius": "6 mm", **STEEL}
    of = case(
        closure=poppet, seat={"shape": "conical-land", "angle": "45 deg", "land_width": "1 mm", **STEEL}
    )
    keys = {one.key for one in _ChangedSeal(SimpleNamespace(case=of), (0,))._dimensions()}
    assert "closure.angle and seat.angle" in keys and not {"closure.angle", "seat.angle"} & keys


def test_faces_that_nearly_fit_are_changed_by_half_of_their_difference():
    """An injector with a needle of 60.5 and a seat of 60 deg is no other injector with one of 70 deg."""
    needle = {
        "shape": "cone",
        "included_angle": "60.5 deg",
        "outer_radius": "0.9 mm",
        "inner_radius": "0.45 mm",
    }
    of = case(closure={**needle, **STEEL}, seat=cone("steel", "60 deg"))
    changes = {one.key: one for one in _ChangedSeal(SimpleNamespace(case=of), (0,))._dimensions()}
    for key in ("closure.angle", "seat.angle"):
        step = changes[key].value_after(changes[key].step) - changes[key].before
        assert math.degrees(step) == pytest.approx(0.125)


@pytest.mark.parametrize(("material", "offered"), [("316L", False), ({"hardness": "3 GPa"}, True)])
def test_the_hardness_of_an_alloy_with_a_name_is_nothing_to_order(material, offered):
    given = {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3, **material} if offered else material
    of = case(closure={"shape": "ball", "radius": "20 mm", "material": given}, seat=cone(given))
    assert ("hardness" not in _ChangedSeal(SimpleNamespace(case=of), (0,))._not_drawn) is offered


def test_what_helps_helps_at_every_load_and_inside_the_theory():
    result = rough_result()
    halved = Sensitivity("rms_height", None, None, 0.5, (0.2, 0.2), (math.nan, math.nan))
    assert _ChangedSeal(result, (0, 2)).helps(halved)
    # a load that hardly leaks now leaks more then
    low = result.loads[0]
    tight = low.with_values(leak=replace(low.leak, leak_rate=1e-3 * low.leak.leak_rate))
    other = replace(result, loads=(tight, *result.loads[1:]))
    assert not _ChangedSeal(other, (0, 2)).helps(halved)
    assert _ChangedSeal(other, (1, 2)).helps(halved)
    # pressed so hard that the seat yields as a whole
    force = Sensitivity("force", 0.0, 1.0, 300.0, (0.2, 0.2), (math.nan, math.nan))
    assert not _ChangedSeal(result, (0, 2)).helps(force)


@pytest.mark.parametrize(("over", "enough"), [(3.0, True), (30.0, False)])
def test_what_helps_and_is_not_enough_is_told_so(over, enough):
    """A leak that is three times the limit passes with a fifth of it, one of thirty times does not."""
    lever = Sensitivity("rms_height", None, None, 0.5, (0.2, 0.3), (math.nan, math.nan), helps=True)
    result = rough_result()
    limit = max(load.leak.leak_rate for load in result.loads) / over
    asked = result.case.replace({"requirement.leak_rate": f"{limit} m^3/s"})
    said = second_line(with_new_verdicts(replace(result, case=asked)).with_answers(sensitivities=(lever,)))
    assert "Largest effect" in said and ("not enough" in said) is not enough


def test_flanges_and_a_gasket_that_fits_them_are_turned_together():
    flange = {"shape": "conical-face", "bore_radius": "94 mm", "face_radius": "103 mm", **STEEL}
    ring = {
        "shape": "double-cone",
        "inner_radius": "85 mm",
        "outer_radius": "100 mm",
        "height": "25 mm",
        **STEEL,
    }
    tables = {
        "closure": {**flange, "angle": "60 deg"},
        "gasket": {**ring, "rim_height": "12 mm", "edge_radius": "0.5 mm", "angle": "60 deg"},
    }
    for more in ({"seat": None}, {"seat": {**flange, "angle": "60 deg", "bore_radius": "93 mm"}}):
        of = case(**tables, **more)
        keys = {one.key for one in _ChangedSeal(SimpleNamespace(case=of), (0,))._dimensions()}
        assert [one for one in keys if "angle" in one] == [
            "closure.angle and gasket.angle" + (" and seat.angle" if more["seat"] else "")
        ]


def test_dimensions_are_told_in_the_words_of_the_case():
    _, known = found()
    one, angle = known["closure.radius"], known["seat.angle"]
    drawn = case(
        closure={"shape": "ball", "diameter": "40 mm", **STEEL},
        seat={"shape": "cone", "included_angle": "90 deg", **STEEL},
    )
    assert step_in_words(case(), one) == "1 mm larger closure radius"
    assert step_in_words(drawn, one) == "2 mm larger closure diameter"
    assert step_in_words(case(), angle) == "5° larger seat angle"
    assert step_in_words(drawn, angle) == "10° smaller seat included angle"
    both = replace(angle, key="closure.angle and seat.angle")
    assert step_in_words(case(), both) == "5° larger angle of both faces"
    width = replace(one, key="seat.land_width", before=1e-3, after=0.95e-3)
    assert step_in_words(drawn, width) == "50 µm smaller seat land width"
    assert step_in_words(case(), replace(one, key="form")) == "halving the deviations from roundness"


def test_a_step_that_seals_is_no_exponent():
    result, known = found()
    sealing = replace(known["rms_height"], ratio=(0.0, 0.0), exponents=(math.nan, math.nan))
    assert sealing.strength == math.inf and not sealing.straight
    assert effect_in_words(result.case.display, sealing) == "closes the leak"
    contradicting = replace(known["hardness"], ratio=(0.8, 1.3))
    assert contradicting.strength == 0.0
    assert replace(known["force"], ratio=(0.5, 0.5)).straight is False
    assert step_in_words(result.case, replace(known["force"], before=100.0, factor=1.1)) == (
        "10 % more force of spring or actuator"
    )


def test_there_are_no_sensitivities_without_a_leak():
    assert sensitivities(smooth_result()) == ()
    assert sensitivity_lines(smooth_result()) == []


def test_steps_of_lengths_are_round():
    assert [_round_step(one) for one in (0.02, 0.1e-3, 1e-3)] == pytest.approx([1e-3, 5e-6, 5e-5])


# Case -> what makes it quick, and for each sensitivity the same change as a user would write it.
RUNS = {
    "ball_cone": (
        {"load.fluid_pressure": ["5 bar", "20 bar"]},
        {
            "hardness": {"seat.material.hardness": "1.75 GPa"},
            "youngs_modulus": {
                "closure.material.youngs_modulus": "105 GPa",
                "seat.material.youngs_modulus": "105 GPa",
            },
            "seat.angle": {"seat.angle": "50 deg"},
        },
    ),
    "ball_on_land": (
        {},
        {
            "seat.land_width": {"seat.land_width": "0.42 mm"},
            "seat.edge_radius": {"seat.edge_radius": "21 um"},
            "seat.material": {"seat.material": "316L"},
        },
    ),
    "poppet_on_land": (
        {},
        {
            "closure.face_width": {"closure.outer_radius": "10.2 mm"},
            "closure.mean_radius": {"closure.inner_radius": "6.5 mm", "closure.outer_radius": "10.5 mm"},
            "closure.angle and seat.angle": {"closure.angle": "50 deg", "seat.angle": "50 deg"},
        },
    ),
    "drawing_finish": (
        {},
        {
            "rms_height": {"roughness.seat.Ra": "0.4 um", "roughness.closure.Ra": "0.05 um"},
            "roughness.seat.Ra": {"roughness.seat.Ra": "0.4 um"},
            "closure.radius": {"closure.radius": "21 mm"},
        },
    ),
    "oval_seat": (
        {"load.fluid_pressure": "20 bar", "load.target_leak_rate": None},
        {
            "form": {"form.seat.harmonics": [{"waves": 2, "amplitude": "1 um"}]},
            "seat.angle": {"seat.angle": "50 deg"},
        },
    ),
    "relief_valve": (
        {"load.fluid_pressure": ["10 bar", "60 bar"], "load.target_leak_rate": None},
        {
            "force": {"load.applied_force": "275 N"},
            "rms_height": {"roughness.spectrum.rms_height": "0.1 um"},
            # which a larger ball would open
            "closure.radius": {"closure.radius": "4.8 mm"},
            "seat.material": {"seat.material": "316L"},
        },
    ),
    "elastoplastic_seat": (
        {"load.fluid_pressure": "100 bar", "mesh.contact_size": "40 um"},
        {
            "rms_height": {"roughness.spectrum.rms_height": "0.5 um"},
            "closure.radius": {"closure.radius": "10.5 mm"},
            "closure.material": {"closure.material": "316L"},
        },
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNS)
def test_a_sensitivity_is_the_ratio_of_two_complete_runs(name):
    quick, changes = RUNS[name]
    result = run_loads(fem_seal.load_case(EXAMPLES / f"{name}.toml").replace(quick))
    number = result.loads.index(result.highest)
    changed = _ChangedSeal(result, (number,))
    known = {one.key: one for one in changed.changes() if one.material in ("", "316L")}
    for key, change in changes.items():
        (found,) = changed.sensitivities([known[key]])
        run = run_loads(result.case.replace(change))
        ratios = [
            after.leak.leak_rate / before.leak.leak_rate
            for before, after in zip(
                (result.highest, *result.highest.others.values()),
                (run.highest, *run.highest.others.values()),
                strict=True,
            )
        ]
        # meshes of studies are those of runs to some 1e-5, a path to its load steps
        assert found.ratio == pytest.approx((ratios[0], ratios[-1]), rel=1e-3), key


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
def test_sensitivities_of_a_body_that_yields_are_paths_of_their_own(monkeypatch):
    # each takes two paths: one dimension and none of the shape of the spectrum stand for the others
    monkeypatch.setattr("fem_seal.answers.sensitivities._AT_CONTACT", {"closure": {"radius"}, "seat": ()})
    monkeypatch.setattr("fem_seal.answers.sensitivities._MATERIALS", ())
    monkeypatch.setattr("fem_seal.answers.sensitivities.self_affine_part", lambda roughness: None)
    result = coined()
    assert result.sensitivities == ()
    found = {one.key: one for one in sensitivities(result, 1)}
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


@pytest.mark.slow
def test_sensitivities_of_a_path_are_not_looked_for_unless_asked(monkeypatch):
    monkeypatch.setattr(
        "fem_seal.answers.sensitivities.sensitivities", lambda result: pytest.fail("looked for")
    )
    asked = coined().case.replace({"load.fluid_pressure": "50 bar", "requirement": {"leak_rate": "1 ml/min"}})
    assert solve(asked).sensitivities == ()
