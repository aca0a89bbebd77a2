"""Bodies that yield and loads beyond small strains, told before anything is solved."""

from __future__ import annotations

import json
import math

import pytest
from places import EXAMPLES
from sample_results import ball, cone, smooth_case

import fem_seal
from fem_seal.answers.closed_forms import bearable_pressure, foresee_findings, run_seconds
from fem_seal.case.checks import MOST_TURNED, refused_loads, turning_angle
from fem_seal.cli.app import main
from fem_seal.contact.solution import yielding_of
from fem_seal.errors import InputError
from fem_seal.loads import line_load, plastic_half_width
from fem_seal.output.case_words import temperature_rows
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem
from fem_seal.validity.materials import material_cautions

SOFT = {
    "name": "copper Cu-ETP R220",
    "stress_strain": {
        "plastic_strain": [0, 0.02, 0.1, 0.3],
        "stress": ["60 MPa", "120 MPa", "220 MPa", "300 MPa"],
    },
}


def knife(force, edge_radius="0.1 mm", gasket=SOFT):
    """A knife edge of a vacuum flange in copper."""
    return fem_seal.Case(
        closure={"shape": "disc", "diameter": "82 mm", "height": "2 mm", "material": gasket},
        seat={
            "shape": "sharp-edge",
            "bore_diameter": "77 mm",
            "top_angle": "-20 deg",
            "edge_radius": edge_radius,
            "material": "316L",
        },
        interface={"law": "smooth"},
        load={"fluid_pressure": "1.01325 bar", "applied_force": force, "pressure_side": "outer"},
    )


def test_a_hot_gasket_is_named_by_its_own_words_and_keys():
    case = fem_seal.load_case(EXAMPLES / "copper_ring.toml").replace(
        {"gasket.material": SOFT["name"], "temperature.uniform": "140 degC"}
    )
    rows = dict(temperature_rows(case, SealProblem.of(case)))
    assert {"temperature of the flange", "temperature of the gasket", "flange grows more than gasket"} <= {
        *rows
    }
    problem = SealProblem.of(case)
    told = [one.text() for one in material_cautions(problem)]
    assert any("gasket.material.hardness: " in one for one in told)
    assert not any("seat" in one for one in told)


def test_a_stress_just_above_yield_is_more_than_once_the_yield_stress():
    # Hertz' stress over its own value, which the first case says with two digits
    (text,) = map(str, foresee_findings(SealProblem.of(seal("0.1 GPa"))))
    highest = 0.1 * float(text.split("up to ")[1].split(" times")[0])
    found = [
        float(text.split("up to ")[1].split(" times")[0])
        for share in (0.90, 0.95, 0.96, 0.97, 0.98, 0.99, 1.0, 1.01)
        for text in map(str, foresee_findings(SealProblem.of(seal(f"{share * highest} GPa"))))
    ]
    assert len(found) > 2 and min(found) > 1.0


def seal(yield_stress, force="1 kN", **material):
    body = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "yield_stress": yield_stress, **material}
    return smooth_case(
        closure=ball(body), seat=cone(body), load={"fluid_pressure": "20 bar", "applied_force": force}
    )


# ---------------------------------------------------------------- beyond small strains


def test_faces_turn_by_the_half_width_over_the_radius_and_not_at_all_on_a_flat():
    contact = fem_seal.load_case(EXAMPLES / "ball_cone.toml").contact
    for share in (0.001, 0.01, 0.05):
        # a/R, of the tangent of an angle of share: to its square
        assert turning_angle(contact, share * contact.relative_radius) == pytest.approx(share, rel=0.01)
    flat = fem_seal.load_case(EXAMPLES / "ring_joint.toml").contact
    start, end = flat.reach
    assert turning_angle(flat, 0.05 * (end - start)) == pytest.approx(0.0, abs=1e-6)
    # no contact is as wide as that
    assert turning_angle(flat, 0.6 * (end - start)) == 0.0


def test_a_knife_edge_that_no_load_step_ends_is_refused_with_the_force_that_small_strains_hold():
    with pytest.raises(InputError, match="beyond small strains: not calculated") as told:
        knife("25 kN")
    # by hand: a = f/(2 2.97 300 MPa), f = 25.47 kN/(2 pi 38.6 mm)
    assert "until they touch over 0.118 mm" in str(told.value)
    allowed = float(str(told.value).split("at a contact force of ")[1].split(" kN")[0]) * 1e3
    contact = knife("1 kN").contact
    f = allowed / (2 * math.pi * contact.initial_contact_radius)
    assert turning_angle(contact, plastic_half_width(f, 300e6)) == pytest.approx(0.25, rel=0.01)
    # the same edge ten times as blunt
    assert not refused_loads(knife("25 kN", edge_radius="1 mm"))


def test_what_comes_after_such_a_load_is_refused_and_what_is_before_it_is_not():
    # half-width over radius from 0.02 to 0.5, and back
    path = knife(["1 kN", "21 kN", "1 kN"])
    assert {n: one.kind for n, one in refused_loads(path).items()} == {1: "strain", 2: "path"}
    said = list(map(str, foresee_findings(SealProblem.of(path))))
    assert "At 1.01325 bar with 21 kN: beyond small strains" in said[0]
    assert "depends on its load history" in said[1]
    assert run_seconds(SealProblem.of(path)) == pytest.approx(
        run_seconds(SealProblem.of(knife("1 kN"))), rel=0.5
    )


def test_elastic_bodies_are_calculated_whatever_they_turn():
    elastic = {key: value for key, value in SOFT.items() if key == "name"}
    assert not refused_loads(knife("25 kN", gasket=elastic))


# ---------------------------------------------------------------- bodies that yield


@pytest.mark.parametrize("share", [0.95, 1.2, 3.0])
def test_the_stress_that_is_foreseen_is_that_of_the_run(share):
    chosen = seal("1 GPa")
    contact = evaluate(SealProblem.of(chosen)).solved_loads.contacts[0]
    stress = yielding_of(
        contact, {name: one for name, one in SealProblem.of(seal("1 MPa")).materials.items()}
    )
    highest = max(zone.von_mises for zone in stress.values())
    found = list(map(str, foresee_findings(SealProblem.of(seal(float(highest / share))))))
    assert bool(found) == (share > 1.0)
    if found:
        (text,) = found
        assert text.startswith("closure and seat: ")
        excess = float(text.split("up to ")[1].split(" times")[0])
        # Hertz, and two digits
        assert excess == pytest.approx(share, rel=0.04, abs=0.05)
        assert ("outside the theory" in text) == (share > 1.5)


def test_where_between_two_loads_a_body_begins_to_yield_is_not_claimed():
    """Of loads that are far apart the smallest that yields is no threshold: both sides of it are told."""
    loads = {"fluid_pressure": "1 Pa", "applied_force": ["1 N", "100 N", "200 kN"]}
    (text,) = map(str, foresee_findings(SealProblem.of(seal("1 GPa").replace(load=loads))))
    assert "under a contact force of 200 kN, and not yet under 100 N:" in text


def test_a_body_bears_the_flow_stress_of_its_strain():
    perfect = {**SOFT, "stress_strain": {"plastic_strain": [0], "stress": ["100 MPa"]}}
    assert bearable_pressure(SealProblem.of(knife("1 kN", gasket=perfect)), 1e4) == pytest.approx(
        2.97 * 100e6
    )
    hardening = SealProblem.of(knife("1 kN"))
    # by hand: a = 3e-3 R at 2 2.97 a sigma = f, 0.2 a/R = 6e-4, sigma = 60 + 1.8 MPa
    f = 5.94 * 3e-3 * 0.1e-3 * 61.8e6
    assert bearable_pressure(hardening, f) == pytest.approx(2.97 * 61.8e6, rel=1e-3)
    assert bearable_pressure(SealProblem.of(knife("1 kN", gasket="copper")), 1e4) == math.inf


@pytest.mark.slow
def test_what_a_body_that_yields_bears_is_the_peak_of_the_run():
    """A ball of 10 mm in mild steel at 150 N/mm: the mean pressure of full plasticity is not quite reached."""
    problem = SealProblem.of(fem_seal.load_case(EXAMPLES / "elastoplastic_seat.toml"))
    first = evaluate(problem).solved_loads.contacts[0]
    f = line_load(first.contact_force, problem.initial_contact_radius, problem.contact.angle)
    most = bearable_pressure(problem, f)
    assert 0.75 * most < first.profile.peak_pressure < 1.02 * most


def test_hardness_stands_for_a_yield_stress_that_is_not_known():
    (text,) = map(str, foresee_findings(SealProblem.of(seal(None, hardness="0.1 GPa"))))
    assert "a third of its hardness 34.5 MPa" in text and "above its hardness 0.1 GPa" in text


def test_a_curve_of_the_library_is_offered_with_its_time():
    chosen = smooth_case(
        closure=ball("440C"), seat=cone("316L"), load={"fluid_pressure": "20 bar", "applied_force": "5 kN"}
    )
    (text,) = map(str, foresee_findings(SealProblem.of(chosen)))
    assert (
        text.startswith("seat: 316L yields") and 'with stress_strain = "library" the load steps take' in text
    )
    yielding = chosen.replace({"seat.material": {"name": "316L", "stress_strain": "library"}})
    assert run_seconds(SealProblem.of(chosen)) is None
    assert 0.5 < run_seconds(SealProblem.of(yielding)) < 30.0
    # the ball is harder than what the seat lets through
    assert list(map(str, foresee_findings(SealProblem.of(yielding)))) == []


def test_a_sharp_edge_would_not_be_calculated_with_a_curve_either():
    (text,) = [
        one
        for one in map(str, foresee_findings(SealProblem.of(knife("25 kN", "0.03 mm", "316L"))))
        if one.startswith("closure")
    ]
    assert "beyond small strains: not calculated" in text
    assert float(text.split("against each other by ")[1].split(" rad")[0]) > MOST_TURNED


def test_check_says_how_long_a_run_takes(tmp_path, capsys):
    path = tmp_path / "seal.toml"
    text = (EXAMPLES / "elastoplastic_seat.toml").read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    assert main(["check", str(path)]) == 0
    assert "time of a run                 some seconds, in load steps" in capsys.readouterr().out
    assert main(["check", str(path), "--json"]) == 0
    alone = json.loads(capsys.readouterr().out)["run_time_s"]
    assert alone < 10.0
    # samples of a finish and the force for a target are further paths
    spectrum = next(line for line in text.splitlines() if line.startswith("spectrum"))
    text = text.replace(spectrum, 'Ra = "0.2 um"\nprocess = "lapped"')
    text = text.replace("[load]\n", '[load]\ntarget_leak_rate = "1e-9 m^3/s"\n')
    path.write_text(text, encoding="utf-8")
    assert main(["check", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["run_time_s"] > 3.0 * alone
