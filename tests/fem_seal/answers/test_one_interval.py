"""One interval of the leak rate: every place that tells it tells the same ends, of which the verdict is made."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_results import case, rough_result, run_loads, single_result, tiles_of, with_new_verdicts

import fem_seal
from fem_seal.answers.judgement import VerdictReason
from fem_seal.answers.leakage_class import fluid_of_test, in_the_test
from fem_seal.answers.leakage_class import test_of as ratios_of
from fem_seal.output.answers.leak import leakage_lines
from fem_seal.output.answers.uncertainty import interval_table
from fem_seal.output.answers.verdict import verdict_sentences
from fem_seal.output.files import summary
from fem_seal.output.report.page import report
from fem_seal.output.tables import leak_rows
from fem_seal.seal.findings import Bounds, Level, Validity, remark
from fem_seal.units import Display, format_digits, range_text
from leak import Reading, millilitres_per_minute

LOW, HIGH = "leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s"
AGREE = 1.005


@cache
def sampled_result():
    """A case with an uncertain hardness, in both readings."""
    return fem_seal.run(case(uncertainty={"samples": 64, "hardness": {"relative": 0.1}}))


RESULTS = {"two readings": rough_result, "one reading": single_result, "sampled": sampled_result}


def known_as(result, factor, level, limit):
    """A solved result whose loads are known as well as that, judged as the chain does."""
    validity = Validity.of([remark("x", level, "few channels", factor)])
    loads = tuple(load.with_values(validity=validity) for load in result.loads)
    of = result.case.replace({"requirement": {"leak_rate": f"{limit!r} m^3/s"}})
    return with_new_verdicts(replace(result, case=of, loads=loads))


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize("name", RESULTS)
@settings(max_examples=25, deadline=None)
@given(
    factor=st.sampled_from([(1.0, 1.0), Bounds.factor_bounds(1.7), (0.4, 1.0), (1.0, 2.5), (0.0, math.inf)]),
    level=st.sampled_from(list(Level)),
    limit=st.floats(-11.0, -3.0).map(lambda one: float(10.0**one)),
)
def test_every_place_tells_the_same_ends(name, factor, level, limit):
    result = known_as(RESULTS[name](), factor, level, limit)
    ends = [load.leak_interval for load in result.loads]
    # what is known of a number that stands alone is told by its digits
    apart = result.loads[0].others or factor != (1.0, 1.0)
    assert result.leak_ranges == (tuple(ends) if apart else (None,) * len(ends))
    in_files = ends if apart else [(pytest.approx(math.nan, nan_ok=True),) * 2] * len(ends)
    # files
    assert [(row[LOW], row[HIGH]) for row in leak_rows(result)] == in_files
    told = summary(result)
    if result.uncertainty is not None:
        assert list(zip(told["uncertainty"][LOW], told["uncertainty"][HIGH], strict=True)) == ends
        assert len(interval_table(result).rows) == len(ends)
    # verdict
    judged = result.judgement
    assert judged.worst.ends == ends[judged.number]
    assert (told["requirement"][LOW], told["requirement"][HIGH]) == ends[judged.number]
    # sentence, tile, and the page that moves
    load = result.highest
    low, high = widest = ends[result.loads.index(load)]
    as_one, claimed = high <= AGREE * low, level is not Level.OUTSIDE
    digits = min(load.leak_digits, 3 if as_one else 2)
    line = leakage_lines(result.case, load, result.loads)[0]
    shown = (load.leak.leak_rate,) * 2 if as_one else widest
    assert (
        f": {range_text(*(format_digits(millilitres_per_minute(one), digits) for one in shown))} ml/min = "
        in line
    )
    tile = tiles_of(result)["Leak rate"]
    rate = shown[0] if as_one else widest
    if claimed and name == "two readings":
        # by the paper's theory its number, and beside it the upper bound
        digits = min(load.leak_digits, 2)
        assert tile.value == Display().leak_range(load.leak.leak_rate, digits, beside=load.leak_range)
        assert Display().leak_range(load.leak_range.high, digits, beside=load.leak_range) in tile.remark
    else:
        assert tile.value == Display().leak_range(rate, load.leak_digits, claimed=claimed)
    assert tile.value in report(result, full=True).replace("\xa0", " ")


def test_what_widens_the_interval_is_said_beside_it():
    few = known_as(rough_result(), Bounds.factor_bounds(3.3), Level.DOUBTFUL, 1e-3)
    load = few.highest
    held = leakage_lines(few.case, load, few.loads)[1]
    assert held.startswith("  The two ends are the bounds of yielding") and held.endswith(
        ", with the model error."
    )
    alone = known_as(single_result(), Bounds.factor_bounds(3.3), Level.DOUBTFUL, 1e-3)
    assert "  The interval is the model error." in leakage_lines(alone.case, alone.highest, alone.loads)
    plain = known_as(rough_result(), (1.0, 1.0), Level.VALID, 1e-3)
    assert not any("model error" in one for one in leakage_lines(plain.case, plain.highest, plain.loads))


def test_a_verdict_that_only_the_accuracy_decides_says_so_with_the_same_ends():
    solved = rough_result()
    _, high = solved.highest.leak_range
    few = known_as(solved, Bounds.factor_bounds(3.3), Level.DOUBTFUL, 2 * high)
    worst = few.judgement.worst
    assert worst.why is VerdictReason.ACCURACY and worst.ends[0] < 2 * high < worst.ends[1]
    assert few.margin == pytest.approx(2 * high / few.leak_ranges[-1][1], rel=1e-12)
    # the upper end is 3.3 times as high, and the limit twice as high
    assert few.verdict == "pass unless" and worst.off == pytest.approx(2.0)
    assert "unless the model error is larger than a factor 2.0" in verdict_sentences(few)[0]


# -------------------------------------------------------------------- the gas of the test

FINE = {"kind": "self-affine", "rms_height": "0.1 um", "hurst": 0.8, "q_low": "1e4 1/m"}
CLASS = {"standard": "ISO 5208", "class": "D"}


def through(gas, rms_height, load, **fluid):
    """Loads of a gas through a seat."""
    spectrum = {**FINE, "rms_height": rms_height, "q_rolloff": "1e5 1/m", "q_high": "1e7 1/m"}
    tables = {"roughness": {"spectrum": spectrum}, "fluid": {"name": gas, **fluid}, "load": load}
    return run_loads(case(requirement=CLASS, **tables))


VACUUM = {"outlet_pressure": "0 Pa"}


# At most the gas chokes in the gap without load, as sqrt(gamma/M) (2/(gamma + 1))^((gamma + 1)/(2 gamma - 2)) with
# gamma = 1.4 of air and 5/3 of helium.
CHOKED = math.sqrt(4.0026 / 28.97) * 0.6847 / 0.7262


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rms_height", "load", "fluid", "ratio"),
    [
        # free molecules: their speeds, the root of 4.0026 over 28.97 g/mol
        (
            "0.1 um",
            {"fluid_pressure": "0.1 mbar", "applied_force": "1 kN"},
            VACUUM,
            (math.sqrt(4.0026 / 28.97),) * 2,
        ),
        # wide gaps at a high pressure: the viscosities, 19.6 over 18.2 uPa s
        ("40 um", {"fluid_pressure": "100 bar", "applied_force": "1 kN"}, {}, (19.6 / 18.2, CHOKED)),
    ],
    ids=["molecular", "viscous"],
)
def test_air_over_helium_has_its_limits(rms_height, load, fluid, ratio):
    result = through("helium", rms_height, load, **fluid)
    name, found = ratios_of(result.case.fluid, result.highest.fluid_pressure, result.highest)
    assert name == "air"
    assert found == pytest.approx(ratio, rel=0.01)
    # before anything is calculated it may be anything between and beyond
    least, most = fluid_of_test(result.case.fluid, 1e5)[1]
    assert least < 0.31 and most > 1.07


@pytest.mark.slow
@pytest.mark.parametrize("pressure", ["0.1 bar", "1 bar", "10 bar"])
def test_what_helium_is_converted_to_is_what_air_leaks(pressure):
    load = {"fluid_pressure": pressure, "applied_force": "1 kN"}
    helium, air = (through(gas, "0.2 um", load) for gas in ("helium", "air"))
    # another molecule is no other contact
    assert in_the_test(helium.case, helium.highest) == pytest.approx(air.highest.leak_interval, rel=1e-9)
    assert in_the_test(air.case, air.highest) == air.highest.leak_interval
    assert helium.highest.judgement.ends == pytest.approx(air.highest.leak_interval, rel=1e-9)
    assert helium.highest.margin == pytest.approx(air.highest.margin, rel=1e-9)


@pytest.mark.slow
def test_samples_of_helium_are_converted_one_by_one():
    """The ends of what a drawing leaves open are those of a run with air, whose gaps are other ones at each end."""
    tables = {
        "roughness": {"Ra": "0.2 um", "process": "lapped"},
        "load": {"fluid_pressure": "2 bar", "applied_force": "1 kN"},
        "requirement": CLASS,
    }
    helium, air = (run_loads(case(fluid={"name": gas}, **tables), interval=True) for gas in ("helium", "air"))
    least, most = ratios_of(helium.case.fluid, 2e5, helium.highest)[1]
    # not one factor for both
    assert least < 0.97 * most
    # samples that are calculated anew at the ends are other ones, where a polynomial stands for them
    assert in_the_test(helium.case, helium.highest) == pytest.approx(air.highest.leak_interval, rel=0.02)
    assert (
        helium.uncertainty.in_test.others[Reading.CAPPED].shape
        == helium.uncertainty.others[Reading.CAPPED].shape
    )
    assert air.uncertainty.in_test is None
