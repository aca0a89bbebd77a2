"""Bolts that close a seal: two springs in closed form, bodies that yield, heat, scatter and target."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sample_results import ball, case, cone, run_loads, smooth_case

import fem_seal
from fem_seal.answers.case_load import CaseLoad
from fem_seal.bolts import STRESS_AREAS, Bolts, held_force, nominal_diameter, stiffness_of
from fem_seal.case.tightening import bolts_of
from fem_seal.errors import InputError, NoLoadLeftError
from fem_seal.output.answers.bolts import OUTPUT, bolt_table
from fem_seal.output.files import summary
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem
from fem_seal.studies.responses import evaluate_design
from fem_seal.studies.study import Study

INNER = {"fluid_pressure": "10 bar", "pressure_side": "inner"}
# 8 kN in all
BOLTS = {"number": 4, "size": "M8", "length": "40 mm", "youngs_modulus": "210 GPa", "preload": "2 kN"}


def of_area(bolts: dict, **changes: object) -> dict:
    return {key: value for key, value in {**bolts, **changes}.items() if value is not None}


# ---------------------------------------------------------------- springs


@pytest.mark.parametrize("size", STRESS_AREAS)
def test_stress_areas_are_those_of_the_formula_of_iso_898(size):
    """A = pi/4 (d - 0.9382 P)^2, with the pitches of ISO 261."""
    diameter = nominal_diameter(size)
    pitches = {3: 0.5, 4: 0.7, 5: 0.8, 6: 1.0, 7: 1.0, 8: 1.25, 10: 1.5, 12: 1.75, 14: 2.0, 16: 2.0}
    pitches |= {18: 2.5, 20: 2.5, 22: 2.5, 24: 3.0, 27: 3.0, 30: 3.5, 33: 3.5, 36: 4.0, 39: 4.0}
    pitches |= {42: 4.5, 45: 4.5, 48: 5.0, 52: 5.0, 56: 5.5, 60: 5.5, 64: 6.0}
    d = 1e3 * diameter
    area = math.pi / 4 * (d - 0.9382 * pitches[round(d)]) ** 2
    # three digits are printed
    assert STRESS_AREAS[size] * 1e6 == pytest.approx(area, rel=5e-3)


@pytest.mark.parametrize("stiffness", [0.0, 1e6, 1e8, 1e11, 1e15])
@pytest.mark.parametrize("end_force", [-30e3, 0.0, 30e3])
@pytest.mark.parametrize("thermal_force", [0.0, 5e3, -5e3])
def test_two_springs_share_the_end_force(stiffness, end_force, thermal_force):
    """F = F0 + (k_b A p + k_c dF)/(k_b + k_c), contact of k_c and bolts of k_b side by side."""
    of_contact, preload = 3e8, 40e3
    bolts = Bolts(4, 84.3e-6, stiffness, thermal_force)

    def approach(force):
        return (force - end_force) / of_contact

    expected = preload + (stiffness * end_force + of_contact * thermal_force) / (stiffness + of_contact)
    force = held_force(bolts, preload, approach, preload / of_contact)
    assert force == pytest.approx(max(expected, 0.0), rel=1e-9)


def test_bolts_do_not_push():
    bolts = Bolts(4, 84.3e-6, 1e9)
    assert held_force(bolts, 1e3, lambda force: (force + 30e3) / 3e8, 1e3 / 3e8) == pytest.approx(
        0.0, abs=1e-5
    )


def test_flanges_are_in_series_with_the_bolts():
    alone = stiffness_of(4, 210e9, 84.3e-6, 0.04)
    assert stiffness_of(4, 210e9, 84.3e-6, 0.04, alone) == pytest.approx(alone / 2)


# ---------------------------------------------------------------- on elastic bodies


@cache
def smooth():
    return smooth_case(load=INNER, bolts=BOLTS)


def solved(seal):
    return evaluate(SealProblem.of(seal))


def test_the_force_is_that_of_two_springs_for_a_small_pressure():
    """Stiffness of the contact from two runs that know no bolts; a thousandth of the preload leaves it as it is."""
    preload, r0 = 8e3, smooth().initial_contact_radius
    end_force = 1e-4 * preload
    pressure = end_force / (math.pi * r0**2)
    seal = smooth().replace({"load.fluid_pressure": pressure})
    found = solved(seal)
    (load,) = found.loads
    # the same bodies under two forces
    solver, step = found.solver, 0.5e-4 * preload
    ends = [solver.solve(0.0, preload + share * step) for share in (-1.0, 1.0)]
    of_contact = 2 * step / (ends[1].approach - ends[0].approach)
    of_bolts = bolts_of(seal).stiffness
    expected = preload + end_force * of_bolts / (of_bolts + of_contact)
    assert load.applied_force == pytest.approx(expected, rel=1e-8)
    assert load.applied_force - preload == pytest.approx(expected - preload, rel=1e-4)
    assert load.contact.contact_force == pytest.approx(load.applied_force - end_force, rel=1e-12)


@pytest.mark.parametrize("side", ["inner", "outer"])
@pytest.mark.parametrize("length", ["10 m", "1 mm"])
def test_bolts_follow_the_approach(side, length):
    seal = smooth().replace({"bolts.length": length, "load.pressure_side": side})
    found = solved(seal)
    (load,) = found.loads
    tightened = found.solver.solve(0.0, 8e3)
    stretched = bolts_of(seal).stiffness * (tightened.approach - load.contact.approach)
    assert load.applied_force == pytest.approx(8e3 + stretched, rel=1e-7)
    assert (load.applied_force > 8e3) == (side == "inner")


def test_soft_bolts_keep_their_force_and_stiff_ones_the_approach():
    soft = solved(smooth().replace({"bolts.youngs_modulus": "1 GPa", "bolts.length": "10 m"}))
    assert soft.loads[0].applied_force == pytest.approx(8e3, rel=1e-5)
    stiff = solved(
        smooth().replace(
            {"bolts.stress_area": "1e5 mm^2", "bolts.youngs_modulus": "1 TPa", "bolts.length": "1 mm"}
        )
    )
    tightened = stiff.solver.solve(0.0, 8e3)
    assert stiff.loads[0].contact.approach == pytest.approx(tightened.approach, rel=1e-3)
    assert stiff.loads[0].contact.contact_force == pytest.approx(8e3, rel=1e-2)


def test_penetrating_fluid_stretches_the_bolts_too():
    seal = case(load={**INNER, "closing": "penetration"}, bolts=BOLTS, leak={"plasticity": False})
    found = solved(seal)
    (load,) = found.loads
    tightened = found.solver.solve(0.0, 8e3)
    stretched = bolts_of(seal).stiffness * (tightened.approach - load.contact.approach)
    assert load.applied_force == pytest.approx(8e3 + stretched, rel=1e-7)
    assert load.contact.applied_force == pytest.approx(load.applied_force, rel=1e-7)


def test_asperities_remember_that_the_bolts_were_tightened():
    found = solved(case(load=INNER, bolts=BOLTS))
    (load,) = found.loads
    given = case(
        load={**INNER, "applied_force": f"{load.applied_force!r} N", "largest_earlier_force": "8 kN"}
    )
    assert CaseLoad.of(load).remembers
    again = solved(given).loads[0]
    assert load.leak.leak_rate == pytest.approx(again.leak.leak_rate, rel=1e-6)


def test_a_range_of_torques_is_a_range_of_loads():
    torques = [f"{value} N m" for value in (2, 3.2, 4)]
    seal = smooth().replace({"bolts.preload": None, "bolts.torque": torques})
    assert [force for _, force in seal.load.points] == pytest.approx([5e3, 8e3, 10e3])
    loads = run_loads(seal).loads
    (alone,) = solved(smooth()).loads
    assert loads[1].applied_force == pytest.approx(alone.applied_force, rel=1e-4)


# ---------------------------------------------------------------- heat


def test_bolts_that_grow_more_than_the_flanges_lose_preload():
    """dF = k (alpha_c - alpha_b) dT L in series with the contact, which takes nearly all of it from soft bolts."""
    steel = {"name": "steel", "thermal_expansion": "12e-6 1/K"}
    hot = {"uniform": "120 degC", "reference": "20 degC"}
    tables = {"closure": ball(steel), "seat": cone(steel), "temperature": hot, "load": INNER}
    bolts = {**BOLTS, "length": "1 m", "thermal_expansion": "12.5e-6 1/K"}
    seal = smooth_case(**tables, bolts=bolts)
    lost = 4 * STRESS_AREAS["M8"] * 210e9 * (12.5e-6 - 12e-6) * 100.0
    assert bolts_of(seal).thermal_force == pytest.approx(-lost)
    (load,) = solved(seal).loads
    assert load.applied_force == pytest.approx(8e3 - lost, rel=0.01)
    own = smooth_case(**tables, bolts={**bolts, "temperature": "116 degC"})
    # 96 K of the bolts are 100 K of the flanges
    assert bolts_of(own).thermal_force == pytest.approx(0.0, abs=1e-5)
    with pytest.raises(InputError, match="bolts: are loose"):
        smooth_case(**tables, bolts={**bolts, "preload": "10 N"})


# ---------------------------------------------------------------- bodies that yield

SOFT = {
    "name": "copper",
    "youngs_modulus": "120 GPa",
    "poissons_ratio": 0.34,
    "hardness": "0.8 GPa",
    "stress_strain": {"plastic_strain": [0, 0.02, 0.3], "stress": ["60 MPa", "120 MPa", "300 MPa"]},
}
SHORT = {**BOLTS, "length": "5 mm"}


def yielding(**tables):
    load = {**INNER, "fluid_pressure": ["2 bar", "20 bar"], **tables.pop("load", {})}
    return case(seat=cone(SOFT), load=load, bolts={**SHORT, **tables.pop("bolts", {})}, **tables)


@pytest.mark.slow
@pytest.mark.parametrize("side", ["inner", "outer"])
def test_the_path_ends_where_bolts_and_contact_hold_each_other(side):
    seal = yielding(load={"pressure_side": side})
    found = solved(seal)
    tightened, stiffness = found.loads[0].contact.history[-1], bolts_of(seal).stiffness
    assert tightened.contact_force == pytest.approx(8e3)
    for load in found.loads:
        stretched = stiffness * (tightened.approach - load.contact.approach)
        assert load.applied_force == pytest.approx(8e3 + stretched, rel=2e-6)
        assert abs(stretched) > 2.0
    # and it is the path of the forces that were found
    forces = [f"{load.applied_force!r} N" for load in found.loads]
    load = {**INNER, "pressure_side": side, "fluid_pressure": ["2 bar", "20 bar"], "applied_force": forces}
    given = solved(case(seat=cone(SOFT), load={**load, "largest_earlier_force": "8 kN"}))
    for one, other in zip(found.loads, given.loads, strict=True):
        assert one.peak_pressure == pytest.approx(other.peak_pressure, rel=1e-3)
        assert one.contact.approach == pytest.approx(other.contact.approach, rel=1e-3)


@pytest.mark.slow
def test_each_torque_is_tightened_before_its_fluid():
    seal = yielding(load={"fluid_pressure": "10 bar"}, bolts={"preload": ["1 kN", "2 kN"]})
    problem = SealProblem.of(seal)
    assert problem.loads.preloads == (4e3, 8e3) and problem.loads.earlier is None
    small, large = solved(seal).loads
    assert small.applied_force > 4e3 and large.applied_force > 8e3
    # the second is loaded after the first, which it exceeds: the first leaves nothing behind
    (alone,) = solved(yielding(load={"fluid_pressure": "10 bar"})).loads
    assert large.contact.approach == pytest.approx(alone.contact.approach, rel=5e-3)
    assert large.leak.leak_rate == pytest.approx(alone.leak.leak_rate, rel=0.05)


# ---------------------------------------------------------------- answers


@cache
def answered():
    bolts = {**BOLTS, "preload": None, "torque": "3.2 N m", "torque_scatter": 0.25, "material": "steel"}
    load = {**INNER, "target_leak_rate": "0.05 cm^3/s"}
    return fem_seal.run(
        case(load=load, bolts=of_area(bolts, youngs_modulus=None), leak={"theory": "corrected"})
    )


@pytest.mark.slow
def test_columns_have_the_bolts():
    row, (load,) = answered().table.iloc[0], answered().loads
    assert row.bolt_preload_N == pytest.approx(2e3) and row.bolt_torque_N_m == pytest.approx(3.2)
    assert row.bolt_force_N == pytest.approx(row.applied_force_N / 4)
    assert row.bolt_stress_Pa == pytest.approx(row.bolt_force_N / STRESS_AREAS["M8"])
    assert (
        row.leak_rate_largest_preload_m3_per_s < row.leak_rate_m3_per_s < row.leak_rate_least_preload_m3_per_s
    )
    # the ends are what is told of the leak rate
    assert load.leak_interval[1] >= row.leak_rate_least_preload_m3_per_s
    assert load.leak_interval[0] <= row.leak_rate_largest_preload_m3_per_s


@pytest.mark.slow
def test_the_ends_of_the_preload_are_runs_of_their_own():
    row = answered().table.iloc[0]
    for share, name in ((0.75, "least"), (1.25, "largest")):
        alone = answered().case.replace(
            {"bolts.torque": share * 3.2, "bolts.torque_scatter": None, "load.target_leak_rate": None}
        )
        rate = run_loads(alone).loads[0].leak.leak_rate
        assert row[f"leak_rate_{name}_preload_m3_per_s"] == pytest.approx(rate, rel=0.02)


def test_a_study_has_the_ends_of_the_preload_whatever_else_it_asks_for():
    """The force for a verdict takes complete runs, in which the scatter of the torque counts as well."""
    of = case(load=INNER, bolts={**BOLTS, "torque_scatter": 0.25}, requirement={"leak_rate": "1 ml/min"})
    columns = "leak_rate_high_m3_per_s", "leak_rate_least_preload_m3_per_s"
    alone, beside = evaluate_design(of, columns), evaluate_design(of, (*columns, "force_for_verdict_N"))
    for name in columns:
        assert beside.values[name] == pytest.approx(alone.values[name], rel=0.05)
    assert alone.values[columns[0]] >= alone.values[columns[1]] > 0.0


def test_the_torque_for_the_target_leaks_the_target():
    row = answered().table.iloc[0]
    torque = row.bolt_torque_for_target_N_m
    assert row.bolt_preload_for_target_N == pytest.approx(torque / (0.2 * 0.008))
    assert row.bolt_stress_for_target_Pa > row.bolt_preload_for_target_N / STRESS_AREAS["M8"]
    # normal to the contact, as the line load of the loads
    line = row.contact_force_for_target_N / row.contact_force_N * row.line_load_N_per_m
    assert row.line_load_for_target_N_per_m == pytest.approx(line)
    again = answered().case.replace(
        {"bolts.torque": torque, "bolts.torque_scatter": None, "load.target_leak_rate": None}
    )
    (load,) = run_loads(again).loads
    assert load.leak.leak_rate == pytest.approx(0.05e-6, rel=2e-3)
    assert load.applied_force == pytest.approx(row.force_for_target_leak_N, rel=1e-3)


def test_the_leak_rate_per_length():
    row, r0 = answered().table.iloc[0], answered().case.initial_contact_radius
    length = 2 * math.pi * r0
    assert row.leak_rate_per_length_m2_per_s == pytest.approx(row.leak_rate_m3_per_s / length)
    assert row.leak_rate_per_length_kg_per_m_s == pytest.approx(row.leak_rate_kg_per_s / length)
    assert "leak_rate_per_length_Pa_m2_per_s" not in row


def test_sentences_and_tables_have_the_bolts():
    sentences = " ".join(OUTPUT.page_of(answered(), answered().case.display).details)
    for text in (
        "4 bolts are tightened to 2000 N each",
        "3.20 N m",
        "At 10 bar each bolt carries",
        "off by 25 %",
    ):
        assert text in sentences
    assert len(bolt_table(answered()).rows) == 1
    told = summary(answered())["bolts"]
    assert told["number"] == 4 and told["loads"][0]["torque"] == pytest.approx(3.2)
    assert not OUTPUT.answers(replace(answered(), answers={}))


@pytest.mark.slow
def test_the_least_preload_may_open_the_seal():
    bolts = {**BOLTS, "preload": "200 N", "torque_scatter": 0.3}
    seal = case(load={"fluid_pressure": "10 bar", "pressure_side": "inner"}, bolts=bolts)
    (load,) = fem_seal.run(seal).loads
    assert load.at_preload_ends[1] == math.inf and load.leak_interval[1] == math.inf


@pytest.mark.slow
def test_a_study_has_columns_of_the_bolts():
    study = Study(
        smooth(),
        parameters={"bolts.preload": ["2 kN", "3 kN"]},
        responses=("bolt_force_N", "applied_force_N"),
    )
    table = study.run(workers=0).table
    assert (table.bolt_force_N > [2e3, 3e3]).all()
    np.testing.assert_allclose(4 * table.bolt_force_N, table.applied_force_N, rtol=1e-12)


# ---------------------------------------------------------------- the table


def test_preload_below_the_end_force_is_refused():
    with pytest.raises(
        NoLoadLeftError, match="bolts: have a preload below the end force at a fluid pressure of 10 bar"
    ):
        smooth().replace({"bolts.preload": "10 N"})


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"torque": "3 N m"}, "needs either torque or preload"),
        ({"preload": None}, "needs either torque or preload"),
        ({"size": "M13"}, "needs a size of those"),
        ({"size": "1/2 inch"}, "is no metric thread"),
        ({"size": None, "stress_area": "50 mm^2", "preload": None, "torque": "3 N m"}, "add size"),
        ({"youngs_modulus": None}, "needs material or youngs_modulus"),
        ({"preload": ["1 kN", "2 kN", "3 kN"]}, "has 3 entries, but load.fluid_pressure has 2"),
        ({"temperature": "200 degC"}, r"no table \[temperature\]"),
        ({"number": 0}, "bolts.number"),
    ],
)
def test_what_is_wrong_in_the_table_is_said(changes, said):
    load = {**INNER, "fluid_pressure": ["1 bar", "2 bar"]}
    with pytest.raises(InputError, match=said):
        smooth_case(load=load, bolts=of_area(BOLTS, **changes))


@pytest.mark.parametrize("key", ["applied_force", "largest_earlier_force"])
def test_bolts_are_in_place_of_an_applied_force(key):
    with pytest.raises(InputError, match="bolts"):
        case(load={**INNER, key: "3 kN"}, bolts=BOLTS)


def test_bolts_taken_away_leave_no_force_behind():
    outer = smooth().replace({"load.pressure_side": "outer"})
    assert outer.load.applied_force == 8e3
    assert outer.replace({"bolts": None}).load.applied_force == 0.0


def test_a_fine_thread_needs_its_stress_area():
    bolts = {**BOLTS, "size": "M8x1", "stress_area": "39.2 mm^2"}
    assert bolts_of(smooth_case(load=INNER, bolts=bolts)).torque_factor == pytest.approx(0.2 * 0.008)
