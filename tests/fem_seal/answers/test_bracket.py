"""A plastic leak rate is an interval between two readings: the same one in every place that tells it."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from around_results import oval_result
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import surface
from sample_results import case, rough_result, run_loads, single_result, smooth_result, tiles_of, with_capped

import fem_seal
import leak
from fem_seal.answers.case_load import case_loads
from fem_seal.answers.leakage_class import leakage_classes, nominal_size
from fem_seal.answers.uncertainty import LeakInterval
from fem_seal.cli.terminal import show_leak_table, show_leakage
from fem_seal.output.answers.leak import classes_in_words, has_two_numbers, leakage_lines, leakage_text
from fem_seal.output.report.brief import first_line
from fem_seal.output.report.page import report
from fem_seal.output.tables import leak_rows, leakage_table
from fem_seal.seal.findings import Bounds, Level, Validity, remark
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.studies.responses import evaluate_design
from fem_seal.units import Display
from leak import LeakResult, Reading, leakage_class, leakage_limits

LOW, HIGH = "leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s"
DEFAULT, ELASTIC = "leak_rate_m3_per_s", "leak_rate_elastic_m3_per_s"
CONSERVED, CAPPED = "leak_rate_conserved_m3_per_s", "leak_rate_capped_m3_per_s"
# Two digits of each end.
TWO_DIGITS = 0.051


# -------------------------------------------------------------------- the readings themselves


@settings(max_examples=25, deadline=None)
@given(
    log_pressure=st.floats(5.0, 8.7),
    hardness=st.floats(1e9, 2e10),
    method=st.sampled_from(["bruggeman", "critical-junction"]),
)
def test_the_ends_lie_around_the_default_and_below_the_elastic_surface(log_pressure, hardness, method):
    plastic, p = surface(hardness=hardness), 10.0**log_pressure
    conserved, capped, elastic = (
        float(one.effective_separation(p, method))
        for one in (plastic.conserved, plastic.capped, plastic.elastic)
    )
    default = float(plastic.effective_separation(p, method))
    assert min(conserved, capped) <= default == conserved
    # what yields touches more than what does not, and never less
    assert capped <= elastic * (1 + 1e-9)


@pytest.mark.parametrize("pressure", [1e5, 1e7, 3e8])
def test_asperities_too_hard_to_yield_are_elastic_in_both_readings(pressure):
    hard = surface(hardness=1e14)
    readings = [
        float(one.effective_separation(pressure)) for one in (hard.conserved, hard.capped, hard.elastic)
    ]
    # the mean separation of a smoothed spectrum is interpolated, good to 1e-4
    assert readings == pytest.approx([readings[2]] * 3, rel=1e-3)


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_elastic_asperities_have_one_reading():
    (load,) = single_result().loads
    assert load.leak_range is None and not load.others and load.scenario(Reading.ELASTIC) is load
    (row,) = leak_rows(single_result())
    assert math.isnan(row[LOW]) and math.isnan(row[HIGH]) and not row.keys() & {CONSERVED, CAPPED}
    text = report(single_result(), full=True)
    assert "bounds of yielding" not in text
    for nothing in smooth_result().loads:
        assert nothing.leak is nothing.leak_range is None and not nothing.scenarios


def test_each_reading_is_that_of_its_surface_on_the_same_contact():
    result = rough_result()
    for reading in (Reading.CONSERVED, Reading.CAPPED):
        of = result.surface.reading(reading)
        table = of.conductivity_table(1.0, 1e9, 90).at(result.problem.flow.viscosity)
        for load in result.loads:
            p = load.contact.profile
            law = result.problem.flow.pressure_law
            own = leak.leak_flow(
                p.x, p.pressure, table, load.fluid_pressure, p.radius, ends=p.ends, pressure_law=law
            )
            # another table of the same function
            assert load.scenario(reading).leak.leak_rate == pytest.approx(own.leak_rate, rel=1e-3)


def test_the_table_of_each_reading_is_made_once_for_all_loads(monkeypatch):
    from fem_seal.seal.leak_model import FlowModel

    result, made, table_around = rough_result(), [], FlowModel.table_around
    monkeypatch.setattr(
        FlowModel,
        "table_around",
        lambda flow, surface, log_peaks: (
            made.append(surface.yielding) or table_around(flow, surface, log_peaks)
        ),
    )
    rough = LeakModel.of(result.surface, result.problem.flow, result.contact)
    bare = [LoadResult(*load.point, load.contact, rough) for load in result.loads]
    for load, one in zip(result.loads, case_loads(result.problem, bare), strict=True):
        assert one.leak_range == pytest.approx(load.leak_range, rel=1e-12)
    assert made == ["conserved", "capped"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "tables",
    [
        {"fluid": {"name": "helium"}, "load": {"fluid_pressure": "3 bar"}},
        {"leak": {"fluid_in_gap": "local"}, "load": {"fluid_pressure": "5 bar"}},
        {"load": {"fluid_pressure": "5 bar", "applied_force": "1 kN", "closing": "penetration"}},
    ],
    ids=["gas", "fluid in the gap", "penetration"],
)
def test_both_readings_go_the_same_way(tables):
    """A load whose surface is the capped one has as its leak what the other one has as its capped reading."""
    (load,) = run_loads(case(**tables)).loads
    capped = replace(load.rough, surface=load.rough.surface.capped)
    of_capped = replace(SealProblem.of(case(**tables)), surface=capped.surface)
    bare = LoadResult(*load.point, load.contact, capped, load.circumference)
    (swapped,) = case_loads(of_capped, [bare])
    assert type(load.scenarios[Reading.CAPPED].leak) is type(load.leak) is type(swapped.leak)
    assert swapped.leak.leak_rate == load.scenarios[Reading.CAPPED].leak.leak_rate
    assert swapped.scenarios[Reading.CONSERVED].leak.leak_rate == load.leak.leak_rate
    assert swapped.leak_range == load.leak_range
    assert load.leak_range[0] < load.leak_range[1] < 1.01 * load.scenarios[Reading.ELASTIC].leak.leak_rate


@pytest.mark.slow
def test_a_form_error_and_its_answers_have_both_readings():
    result = oval_result()
    for load in result.loads:
        # the integral over the turn is the leak rate of the seal
        angles = len(load.scenarios[Reading.CAPPED].around.angle)
        total = float(load.scenarios[Reading.CAPPED].around.leak_rate.sum()) * 2 * math.pi / angles
        assert total == pytest.approx(load.scenarios[Reading.CAPPED].leak.leak_rate, rel=1e-9)
        assert load.scenarios[Reading.CAPPED].around.line_load is load.around.line_load
        assert (
            load.scenarios[Reading.CAPPED].leak_round.leak_rate
            < load.scenarios[Reading.CAPPED].leak.leak_rate
        )
    # solved once more, to the accuracy of a line load
    (same,) = [point for point in result.form.curve if point.factor == 1.0]
    highest = result.highest
    assert (same.leak_rate, same.others[Reading.CAPPED]) == pytest.approx(
        (highest.leak.leak_rate, highest.scenarios[Reading.CAPPED].leak.leak_rate), rel=1e-5
    )
    from fem_seal.output.answers.form import around_rows

    columns, lines = around_rows(result)
    rows = [dict(zip(columns, line, strict=True)) for line in lines]
    ratio = float(rows[0]["leak_rate_capped_m3_per_s_per_rad"]) / float(rows[0]["leak_rate_m3_per_s_per_rad"])
    first = result.loads[0]
    assert ratio == pytest.approx(
        first.scenarios[Reading.CAPPED].leak.leak_rate / first.leak.leak_rate, rel=0.05
    )


@pytest.mark.slow
def test_a_target_takes_a_force_in_each_reading():
    """Each force is the one at which its reading leaks the target."""
    load = {"fluid_pressure": "20 bar", "applied_force": "2 kN", "target_leak_rate": "0.2 cm^3/s"}
    result = fem_seal.run(case(load=load))
    (found,) = result.loads
    forces = {DEFAULT: found.force_for_target, CAPPED: found.scenarios[Reading.CAPPED].force_for_target}
    # more stays open where only what touches changes, so it takes more force
    assert forces[CAPPED] > forces[DEFAULT]
    for name, force in forces.items():
        asked = case(load={"fluid_pressure": "20 bar", "applied_force": f"{force:.12g} N"})
        # another mesh
        assert evaluate_design(asked, (name,), interpolate=False).values[name] == pytest.approx(
            0.2e-6, rel=1e-3
        )
    told = tiles_of(result)["Force for the target leak rate"]
    assert " to " in told.value and "both bounds" in told.remark


# -------------------------------------------------------------------- the same number everywhere


def test_file_terminal_report_and_study_tell_the_same_interval(capsys):
    result = rough_result()
    rows, table = leak_rows(result), result.table
    for row, load in zip(rows, result.loads, strict=True):
        assert row[DEFAULT] == row[CONSERVED] == load.leak.leak_rate
        assert row[CAPPED] == load.scenarios[Reading.CAPPED].leak.leak_rate
        assert load.leak_range == (row[CONSERVED], row[CAPPED])
        # and nothing besides, but for what the mesh leaves
        off = 1 + load.mesh_error.leak_rate
        assert (row[LOW], row[HIGH]) == load.leak_interval
        assert (row[LOW], row[HIGH]) == pytest.approx((row[CONSERVED] / off, row[CAPPED] * off), rel=1e-12)
        assert row[LOW] <= row[DEFAULT] <= row[HIGH] <= row[ELASTIC]
    assert table[HIGH].tolist() == [row[HIGH] for row in rows]
    show_leak_table(result.case.display, rows, "", result.loads)
    show_leakage(result.case, result.loads)
    terminal = " ".join(capsys.readouterr().out.split())
    for row in rows:
        assert {f"{row[name] * 1e9:#.4g}".removesuffix(".") for name in (LOW, HIGH)} <= set(terminal.split())
    (ends,) = re.findall(r"Leak rate at 20 bar: ([\d.]+) to ([\d.]+) ml/min", terminal)
    expected = [rows[-1][LOW] * 60e6, rows[-1][HIGH] * 60e6]
    assert [float(one) for one in ends] == pytest.approx(expected, rel=TWO_DIGITS)
    assert "bounds of yielding: volume conserved (C_pl), or pressure limited by the hardness" in terminal
    tile, beside = tiles_of(result)["Leak rate"], (rows[-1][LOW], rows[-1][HIGH])
    assert tile.value == Display().leak_range(rows[-1][LOW], 2, beside=beside)
    assert Display().leak_range(rows[-1][HIGH], 2, beside=beside) in tile.remark
    # another mesh, and a conductivity interpolated between surfaces
    names = (DEFAULT, LOW, HIGH, CONSERVED, CAPPED)
    design = evaluate_design(case(load={"fluid_pressure": "20 bar"}), names).values
    assert [design[name] for name in names] == pytest.approx([rows[-1][name] for name in names], rel=2e-3)
    json.dumps(leakage_table(result))


@pytest.mark.slow
def test_outside_the_theory_no_interval_is_claimed():
    result = fem_seal.run(case(load={"fluid_pressure": "4000 bar"}))
    (load,) = result.loads
    assert load.validity.outside_theory
    assert leakage_classes(result.case, load) == ()
    assert "No leak rate is stated at 4000 bar: outside the theory (" in first_line(result)


def test_the_interval_of_a_gas_is_told_in_its_own_unit():
    result = fem_seal.run(case(fluid={"name": "helium"}, load={"fluid_pressure": "3 bar"}))
    (load,) = result.loads
    line, sentence, _, tested = leakage_lines(result.case, load, result.loads)
    assert "a test with air" in tested
    (ends,) = re.findall(r": ([\d.]+) to ([\d.]+) mbar l/s = ", line)
    low, high = (one.leak.throughput * 10 for one in (load, *load.others.values()))
    assert [float(one) for one in ends] == pytest.approx([low, high], rel=TWO_DIGITS)
    assert re.search(r"to [\d.·⁻⁰-⁹−]+ kg/s", line)
    assert "bounds of yielding" in sentence


def test_readings_that_agree_are_told_as_one_number():
    load = rough_result().loads[0]
    known = with_capped(load, replace(load.leak, leak_rate=1.001 * load.leak.leak_rate))
    line, classes = leakage_lines(rough_result().case, known, [known])
    assert " to " not in line and classes.startswith("Leakage class")


# -------------------------------------------------------------------- uncertain inputs


def interval(conserved, capped) -> LeakInterval:
    """Two loads with a few samples."""
    rates = [np.asarray(one, dtype=float) for one in (conserved, capped)]
    return LeakInterval(("hardness",), 0.5, 1, 5, rates[0], np.ones((2, 1)), None, {Reading.CAPPED: rates[1]})


def test_the_interval_of_samples_reaches_from_the_smaller_reading_to_the_larger():
    samples = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    # the readings change places from one load to the other
    found = interval([samples, 20 * samples], [10 * samples, 2 * samples])
    assert found.low.tolist() == [2.0, 4.0]
    assert found.high.tolist() == [40.0, 80.0]
    assert found.median.tolist() == [3.0, 60.0]


def test_what_is_calculated_lies_inside_the_interval_of_its_samples():
    """Scans that are too short for their longest waves have most samples above: the number itself still counts."""
    result = rough_result()
    low, high = result.loads[0].leak_range
    sampled = interval(np.full((2, 5), high), np.full((2, 5), 1.1 * high))
    loads = tuple(sampled.of_load(load, number) for number, load in enumerate(result.loads[:2]))
    above = replace(result.with_answers(uncertainty=sampled), loads=loads)
    off = 1 + result.discretisation_error.leak_rate
    assert above.leak_ranges[0] == pytest.approx((low / off, 1.1 * high * off), rel=1e-12)
    rows = leak_rows(above)
    assert all(row[LOW] <= row[DEFAULT] <= row[HIGH] for row in rows)
    assert result.leak_ranges == tuple(load.leak_interval for load in result.loads)


# -------------------------------------------------------------------- classes

LIMITS = {one.name: one.leak_rate for one in leakage_limits(0.025, gas=False) if one.standard == "ISO 5208"}


@pytest.mark.parametrize(
    ("low", "high", "name", "at_best", "told"),
    [
        (LIMITS["B"], LIMITS["B"], "B", None, "ISO 5208 B"),
        (0.5 * LIMITS["C"], LIMITS["C"], "C", None, "ISO 5208 C"),
        (LIMITS["B"], np.nextafter(LIMITS["B"], 1), "C", "B", "ISO 5208 between B and C"),
        (LIMITS["AA"], LIMITS["G"], "G", "AA", "ISO 5208 between AA and G"),
        (LIMITS["G"], np.nextafter(LIMITS["G"], 1), None, "G", "ISO 5208 between G and no class"),
        (LIMITS["E"], math.inf, None, "E", "ISO 5208 between E and no class"),
        (0.0, LIMITS["D"], "D", "A", "ISO 5208 between A and D"),
        (0.0, 0.0, "A", None, "ISO 5208 A"),
        (2 * LIMITS["G"], 3 * LIMITS["G"], None, None, "ISO 5208: no class met"),
    ],
)
def test_a_class_is_claimed_only_if_both_ends_meet_it(low, high, name, at_best, told):
    found = leakage_class(low, 0.025, gas=False, highest=high)[0]
    assert (found.name, found.at_best, str(found)) == (name, at_best, told)
    # what is claimed is what the upper end alone would be given
    alone = leakage_class(high, 0.025, gas=False)[0]
    assert (found.name, found.limit) == (alone.name, alone.limit)


def test_an_upper_end_below_the_lower_one_is_refused():
    with pytest.raises(leak.FluidError, match="must not be below"):
        leakage_class(2e-9, 0.025, gas=False, highest=1e-9)


def test_the_class_of_a_load_is_that_of_the_interval_beside_it():
    result = rough_result()
    load, name = result.loads[0], "ISO 5208"
    of_readings = {one.standard: one for one in leakage_classes(result.case, load)}[name]
    sampled = load.with_values(sample_ends=(1e-12, 1.0))
    wide = {one.standard: one for one in leakage_classes(result.case, sampled)}[name]
    assert wide.name is None and wide.at_best == "AA"
    size = nominal_size(result.case).size
    low, high = load.leak_interval
    assert of_readings == leakage_class(low, size, gas=False, highest=high)[0]
    assert "between AA and no class" in classes_in_words([wide])
    for told, one_load in zip(leakage_table(result), result.loads, strict=True):
        classes = leakage_classes(result.case, one_load)
        assert told["classes_at_best"] == {one.standard: one.at_best or one.name for one in classes}


# -------------------------------------------------------------------- words


@pytest.mark.parametrize(
    ("rates", "told"),
    [
        (2e-9, "0.120 ml/min"),
        ((2e-9, 5.61e-9), "0.12 to 0.34 ml/min"),
        ((2e-9, 2.001e-9), "0.12 ml/min"),
        ((0.0, 2e-9), "0 to 0.12 ml/min"),
        ((0.0, 0.0), "none, sealed"),
        ((2e-13, 2e-9), "1.2·10⁻⁵ to 0.12 ml/min"),
        ((2e-9, math.inf), "at least 0.12 ml/min"),
    ],
)
def test_an_interval_in_words(rates, told):
    assert Display().leak_range(rates) == told


def test_an_interval_has_the_unit_of_what_it_stands_beside_as_long_as_it_is_readable():
    assert Display().leak_range((1e-10, 3e-10), beside=(1e-8,)) == "6.0 to 18 µl/min"
    assert Display().leak_range((1e-8, 3e-8), beside=(1e-6,)) == "0.60 to 1.8 ml/min"
    assert Display().leak_range((1e-8, 3e-8), beside=(1e-3,)) == "0.60 to 1.8 ml/min"


@given(rates=st.lists(st.floats(1e-14, 1e-3), min_size=1, max_size=4))
def test_leak_rates_of_a_sentence_have_one_unit_and_all_can_be_read(rates):
    """Unless they lie more than four decades apart; then each has the unit that suits it."""
    told = [Display().leak_range(one, beside=rates) for one in rates]
    units, numbers = {text.split()[1] for text in told}, [float(text.split()[0]) for text in told]
    together = max(rates) <= 0.99e4 * min(rates)
    assert not together or len(units) == 1
    assert all(0.0099 <= one < 1e6 for one in numbers)


@pytest.mark.parametrize("low", [5.6e-3, 6.0e-3, 0.126, 0.1268, 9.6, 96.0])
@pytest.mark.parametrize("over", [1.001, 1.05, 1.2, 2.0])
@pytest.mark.parametrize("fluid", ["water", "helium"])
def test_ends_that_are_one_number_in_the_first_unit_are_one_in_all(low, over, fluid):
    """0.006 ml/min is not 0.09 to 0.1 drops/min."""
    solved = rough_result().highest
    leaks = LeakResult(1.0, 1.0, np.zeros(3)).with_density(1000.0)
    if fluid == "helium":
        leaks = replace(leaks, throughput=1.0, standard_leak_rate=1.0)
    for error in (0.0, 0.7):
        few = Validity.of([remark("few", Level.DOUBTFUL, "few", Bounds.factor_bounds(1 + error))])
        ends = [leaks.scaled(one * 1e-6 / 60) for one in (low, over * low)]
        load = with_capped(solved.with_values(leak=ends[0], validity=few), ends[1])
        first, *others = leakage_text(Display(), load).split(" = ")
        assert " to " in first or not any(" to " in one for one in others)


def test_a_zero_that_may_not_be_claimed_is_not_called_sealed():
    assert (
        Display().leak_range((0.0, 0.0), claimed=False)
        == Display().leak_range(0.0, claimed=False)
        == "zero, as calculated"
    )


def test_a_seal_is_sealed_only_if_it_is_in_both_readings():
    load = rough_result().loads[0]
    tight = load.with_values(leak=replace(load.leak, leak_rate=0.0))
    told = first_line(replace(rough_result(), loads=(tight,)))
    assert "Sealed" not in told and re.search(r"Leaks 0 to [\d.]+ ml/min", told)


def test_readings_that_are_read_as_one_number_are_not_told_as_two():
    """Two digits are what an interval is worth: 0.126 and 0.127 are one."""
    load = rough_result().highest
    for higher, same in ((1.27e-9, True), (1.9e-9, False)):
        one = with_capped(load.with_values(leak=load.leak.scaled(1.26e-9)), load.leak.scaled(higher))
        assert has_two_numbers(one) is not same
