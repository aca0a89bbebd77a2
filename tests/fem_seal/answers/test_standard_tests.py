"""Tests of a standard and the leak up to the set pressure: each row is that of a run of its own."""

from __future__ import annotations

import csv
import json
import math

import pytest
from places import EXAMPLES

import fem_seal
from fem_seal import InputError, load_case
from fem_seal.answers.judgement import worst_of
from fem_seal.answers.standard_tests import under_test
from fem_seal.output.answers.standard_tests import in_words, spring_in_words, standard_in_brief
from fem_seal.output.report.brief import loads_in_brief
from fem_seal.output.tables import SET_PRESSURE_COLUMNS, STANDARD_TEST_COLUMNS
from leak.standards import STANDARDS

VALVE = {
    "closure": {"shape": "ball", "radius": "5 mm", "material": "steel"},
    "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
    "roughness": {
        "spectrum": {
            "kind": "self-affine",
            "rms_height": "0.05 um",
            "hurst": 0.8,
            "q_low": "1e4 1/m",
            "q_rolloff": "1e5 1/m",
            "q_high": "6e6 1/m",
        }
    },
    "fluid": {"viscosity": "32 mPa s"},
    "load": {"fluid_pressure": ["10 bar", "40 bar"], "applied_force": ["300 N", "500 N"]},
    "leak": {"plasticity": False},
    "requirement": {"standard": "ISO 5208", "class": "C", "test": "standard", "rated_pressure": "40 bar"},
}
RELIEF = {
    **VALVE,
    "load": {"fluid_pressure": "30 bar", "set_pressure": "60 bar", "pressure_side": "inner"},
    "requirement": {"standard": "API 527", "test": "standard"},
}
RADIUS = 5e-3 / math.sqrt(2.0)


@pytest.fixture(scope="module")
def tested():
    return fem_seal.run(VALVE, sensitivities=False)


@pytest.fixture(scope="module")
def relief():
    return fem_seal.run(RELIEF, sensitivities=False)


@pytest.mark.slow
def test_a_standard_tests_with_its_own_fluids_and_pressures(tested) -> None:
    liquid, gas = tested.standard_tests
    assert (liquid.medium, gas.medium) == ("water", "air")
    assert liquid.fluid_pressure == pytest.approx(44e5) and gas.fluid_pressure == pytest.approx(6e5)
    # of the load with the nearest fluid pressure
    assert (liquid.applied_force, gas.applied_force) == (500.0, 300.0)
    for one, of_gas in ((liquid, False), (gas, True)):
        # 0.03 and 3 mm^3/s per mm of DN; the bore is estimated as DN 8
        assert one.judgement.limit.leak_rate == pytest.approx((3.0 if of_gas else 0.03) * 8e-9)
        assert one.judgement.limit.test_fluid == ""
        assert one.ends.low <= one.leak_rate <= one.ends.high
    assert worst_of(tested.standard_tests) is not None
    # the loads of the case stay those of the case
    assert [load.fluid_pressure for load in tested.loads] == [10e5, 40e5]


@pytest.mark.slow
def test_a_test_is_a_run_of_its_own(tested) -> None:
    for one, test in zip(tested.standard_tests, STANDARDS["ISO 5208"].tests, strict=True):
        (load,) = fem_seal.run(under_test(tested.case, test), sensitivities=False).loads
        assert load.leak.leak_rate == one.leak_rate
        assert tuple(load.leak_interval) == tuple(one.ends)
        assert load.judgement == one.judgement


@pytest.mark.parametrize("closing", ["sealed-area", "penetration"])
def test_a_test_that_opens_the_valve_fails_it(closing) -> None:
    """A spring of 50 bar, tested with water at 66 bar and with air at 6 bar, in service at 30 bar."""
    load = {"fluid_pressure": "30 bar", "applied_force": f"{math.pi * RADIUS**2 * 50e5} N"}
    case = load_case(
        {
            **VALVE,
            "load": {**load, "pressure_side": "inner", "closing": closing},
            "requirement": {**VALVE["requirement"], "rated_pressure": "60 bar", "class": "G"},
        }
    )
    found = fem_seal.run(case, sensitivities=False)
    water, air = found.standard_tests
    assert (water.fluid_pressure, water.leak_rate) == (pytest.approx(66e5), math.inf)
    assert water.judgement.verdict == "fail" and water.judgement.margin == 0.0
    assert water.judgement.limit.leak_rate == pytest.approx(8 * 2e-9)
    assert math.isfinite(air.leak_rate) and worst_of(found.standard_tests) == "fail"
    assert "the seal is open: fail" in " ".join(in_words(found))


def test_a_test_that_cannot_be_calculated_leaves_the_verdict_open() -> None:
    """Fluid in the gap is calculated for liquids alone: nothing is known of the test with air."""
    found = fem_seal.run({**VALVE, "leak": {**VALVE["leak"], "fluid_in_gap": "local"}}, sensitivities=False)
    water, air = found.standard_tests
    assert math.isfinite(water.leak_rate) and math.isnan(air.leak_rate)
    assert air.judgement.verdict == "inconclusive" and air.medium == "air"
    assert worst_of(found.standard_tests) == "inconclusive"
    assert "no leak rate is known: inconclusive" in " ".join(in_words(found))


def test_spring_and_set_pressure_are_force_over_area(relief) -> None:
    found = relief.set_pressure
    assert found.radius == pytest.approx(RADIUS)
    assert found.force == pytest.approx(math.pi * RADIUS**2 * 60e5)
    assert found.opens == pytest.approx(60e5)
    back = load_case(RELIEF).replace({"load.applied_force": found.force})
    assert back.load.set_pressure is None and back.set_pressure == pytest.approx(60e5)
    larger = load_case(RELIEF).replace({"closure.radius": "10 mm"})
    assert larger.load.applied_force == pytest.approx(4.0 * found.force)
    assert load_case(VALVE).set_pressure is None


@pytest.mark.slow
def test_a_seat_that_yields_opens_where_the_table_says() -> None:
    case = load_case(EXAMPLES / "relief_valve_350_bar.toml")
    found = fem_seal.run(case.replace_written({"load.applied_force": None, "load.set_pressure": "450 bar"}))
    assert found.set_pressure.opens == found.loads[-1].blow_off_pressure
    opens = f"{found.set_pressure.opens / 1e5:.3g} bar"
    assert f"the valve opens at {opens}." in spring_in_words(found)
    assert opens.split()[0] in " ".join(loads_in_brief(found.case, found.every_load)[0].rows[-1])


def test_the_leak_grows_up_to_the_set_pressure(relief) -> None:
    loads = relief.set_pressure.loads
    shares = [one.fluid_pressure / 60e5 for one in loads]
    assert shares == pytest.approx([0.5, 0.7, 0.8, 0.9, 0.95, 0.98])
    rates = [one.leak_rate for one in loads]
    assert rates == sorted(rates) and rates[0] > 0.0
    assert relief.loads[0].leak.leak_rate == pytest.approx(rates[0], rel=1e-2)
    (test,) = relief.standard_tests
    assert test.fluid_pressure == pytest.approx(54e5) and test.medium == "water"
    assert test.judgement.limit.leak_rate * 3600e6 == pytest.approx(10.0)


@pytest.mark.slow
def test_files_and_words_have_them(tested, relief, tmp_path) -> None:
    relief.write(tmp_path / "relief")
    tested.write(tmp_path / "tested")
    for name, count in (
        ("relief/standard_tests", 1),
        ("relief/set_pressure", 6),
        ("tested/standard_tests", 2),
    ):
        with (tmp_path / f"{name}.csv").open() as file:
            assert len(list(csv.DictReader(file))) == count
    assert not (tmp_path / "tested" / "set_pressure.csv").exists()
    summary = json.loads((tmp_path / "tested" / "summary.json").read_text())
    assert [one["test"] for one in summary["standard_tests"]] == [one.test for one in tested.standard_tests]
    assert all(tuple(one) == STANDARD_TEST_COLUMNS for one in summary["standard_tests"])
    assert summary["standard_verdict"] == worst_of(tested.standard_tests)
    assert summary["verdict_force"] is None and summary["set_pressure"] is None
    told = json.loads((tmp_path / "relief" / "summary.json").read_text())["set_pressure"]
    assert told["set_pressure_Pa"] == 60e5 and all(
        tuple(one) == SET_PRESSURE_COLUMNS for one in told["loads"]
    )
    report = relief.report(tmp_path / "full.html", full=True).read_text().replace("\xa0", " ")
    assert "Tests of the standard and set pressure" in report and "one bubble of 0.3 ml" in report
    worst = worst_of(tested.standard_tests)
    assert standard_in_brief(tested).startswith(f"Tests of ISO 5208: {worst}")
    assert standard_in_brief(fem_seal.run({**VALVE, "requirement": None}, sensitivities=False)) == ""


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"requirement": {**VALVE["requirement"], "rated_pressure": None}}, "rated_pressure: is missing"),
        (
            {**RELIEF, "load": {**RELIEF["load"], "fluid_pressure": "0.1 bar", "set_pressure": "0.2 bar"}},
            "tests 5 psi below the set pressure at least, and this is 0.2 bar",
        ),
        ({"requirement": {**VALVE["requirement"], "test": "service"}}, "gives the pressures of the tests"),
        ({"requirement": {"leak_rate": "1 ml/min", "test": "standard"}}, "needs a standard of valves"),
        ({"requirement": {"standard": "API 527"}}, "by its set pressure"),
        ({"load": {**VALVE["load"], "set_pressure": "60 bar", "pressure_side": "inner"}}, "remove one"),
        ({"load": {"fluid_pressure": "1 bar", "set_pressure": "60 bar"}}, 'pressure_side = "inner"'),
        ({**RELIEF, "requirement": {**RELIEF["requirement"], "rated_pressure": "1 bar"}}, "is not used"),
    ],
)
def test_what_does_not_go_together_is_said(changes, said) -> None:
    tables = {name: {k: v for k, v in table.items() if v is not None} for name, table in changes.items()}
    with pytest.raises(InputError, match=said):
        load_case({**VALVE, **tables})
