"""A requirement and its verdict: limits against the standards, verdicts against their definition."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from around_results import oval_result
from hypothesis import assume, given
from hypothesis import strategies as st
from sample_results import STEEL, ball, case, cone, rough_result, with_capped, with_new_verdicts

import fem_seal
from fem_seal.answers.judgement import Limit, LoadVerdict, Verdict, VerdictReason, severity
from fem_seal.answers.leakage_class import leakage_classes, limits, next_class
from fem_seal.answers.verdict import _shares, seal_verdict
from fem_seal.cli.terminal import show_leak_table, show_result
from fem_seal.errors import ConvergenceError, InputError, Problem
from fem_seal.output.answers.leak import leakage_lines
from fem_seal.output.answers.verdict import (
    _state,
    basis_lines,
    factor_text,
    next_class_in_words,
    requirement_lines,
    tiles,
    verdict_sentences,
)
from fem_seal.output.files import summary
from fem_seal.output.report.page import report
from fem_seal.output.tables import leak_table
from fem_seal.seal.findings import Bounds, Level, Validity, remark
from fem_seal.seal.load_result import MissingLoad
from fem_seal.studies.responses import LARGEST_MARGIN, evaluate_design
from fem_seal.units import Display
from leak import FluidError
from leak.standards import (
    classes_of,
    invisible_leak_rate,
    leakage_limits,
    standard_named,
    visible_leak_rate,
)

OUTSIDE = Validity.of([remark("yield stress", Level.OUTSIDE, "seat: 3 times its yield stress")])


def widened(ends, doubt):
    """Ends with what the calculation may be off by."""
    least, most = doubt.leak_factor
    return ends[0] * least, ends[1] * most


def with_ends(load, low, high):
    """A load both of whose readings are given, on a mesh that leaves no error."""
    of_low, of_high = (replace(load.leak, leak_rate=end) for end in (low, high))
    return with_capped(load.with_values(leak=of_low, mesh_error=None), of_high)


def with_worst(result, judged):
    """A judged result whose load that decides is judged like that."""
    of = replace(result.judgement, worst=judged)
    return result.with_answers(verdict=replace(result.answers["verdict"], seal=of))


def required(result=None, missing=None, **table):
    """A solved result with a requirement, judged as the chain does."""
    result = rough_result() if result is None else result
    changed = replace(result, case=result.case.replace({"requirement": table}))
    others = enumerate((missing or {}).items(), start=len(changed.loads))
    return with_new_verdicts(
        replace(changed, missing_loads=tuple(MissingLoad(n, *point, one) for n, (point, one) in others))
    )


@pytest.mark.parametrize(
    ("ends", "verdict", "margin"),
    [
        ((0.5, 1.0), "pass", 2.0),
        ((0.5, 2.0), "pass", 1.0),
        ((1.0, 4.0), "inconclusive", 0.5),
        ((2.0, 4.0), "inconclusive", 0.5),
        ((2.001, 4.0), "fail", 0.5),
        ((0.0, 0.0), "pass", math.inf),
        ((0.0, 4.0), "inconclusive", 0.5),
        ((math.inf, math.inf), "fail", 0.0),
        ((1.0, math.inf), "inconclusive", 0.0),
    ],
)
def test_upper_end_within_is_pass_lower_end_above_fail_all_else_inconclusive(ends, verdict, margin):
    judged = LoadVerdict.of(Limit("leak rate", 2.0), ends)
    assert (str(judged.verdict), judged.margin) == (verdict, margin)
    # outside the theory nothing is claimed, except of a seal that is open or leaks too much for any error of it
    outside = LoadVerdict.of(Limit("leak rate", 2.0), ends, OUTSIDE)
    assert outside.verdict == ("fail" if math.isinf(ends[0]) else "inconclusive")
    far = LoadVerdict.of(Limit("leak rate", 2.0), (2001.0, 1e6), OUTSIDE)
    assert (far.verdict, far.why, str(far.reason)) == (Verdict.FAIL, VerdictReason.FAR, OUTSIDE.reasons[0])
    assert LoadVerdict.of(Limit("leak rate", 2.0), (1999.0, 1e6), OUTSIDE).verdict == "inconclusive"
    if math.isinf(margin):
        # of a zero that may not be claimed there is no margin
        assert math.isnan(outside.margin)
    else:
        assert outside.margin == margin


@pytest.mark.parametrize(
    ("factor", "ends", "verdict"),
    [
        # the fluid opens the gap: what leaks too much without it does so with it, what keeps the limit may not
        ((1.0, 9.0), (2.1, 40.0), Verdict.FAIL),
        ((1.0, 9.0), (0.1, 1.9), Verdict.INCONCLUSIVE),
        ((1.0, 9.0), (1.9, 40.0), Verdict.INCONCLUSIVE),
        ((0.5, 9.0), (2.1, 40.0), Verdict.INCONCLUSIVE),
        ((1.0, 1.0), (2.1, 40.0), Verdict.INCONCLUSIVE),
    ],
)
def test_a_theory_that_lets_too_little_leak_leaves_a_fail_a_fail(factor, ends, verdict):
    beyond = Validity.of([remark("fluid opens", Level.OUTSIDE, "opens", Bounds(*factor))])
    assert LoadVerdict.of(Limit("leak rate", 2.0), ends, beyond).verdict is verdict
    with_other = Validity.of([*beyond.cautions, *OUTSIDE.cautions])
    assert LoadVerdict.of(Limit("leak rate", 2.0), ends, with_other).verdict is Verdict.INCONCLUSIVE


@given(
    ends=st.tuples(st.floats(1e-12, 1e-6), st.floats(1.0, 100.0)).map(lambda one: (one[0], one[0] * one[1])),
    limit=st.floats(1e-12, 1e-6),
    factors=st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(1.0, 100.0)), max_size=2),
)
def test_nothing_is_claimed_that_the_calculation_may_be_off_by(ends, limit, factors):
    """Whatever leaks in truth, a seal that passes keeps its limit and one that fails does not."""
    doubt = Validity.of([remark("x", Level.DOUBTFUL, f"by {one}", one) for one in factors])
    # what stands at a limit does so to the last digit or not
    assume(all(abs(limit / end - 1) > 1e-12 for end in ends))
    judged = LoadVerdict.of(Limit("leak rate", limit), widened(ends, doubt), doubt)
    plain = LoadVerdict.of(Limit("leak rate", limit), ends)
    low, high = (end * math.prod(one[n] for one in factors) for n, end in enumerate(ends))
    # three orders of magnitude are all that a calculation is taken to be off by
    low, high = max(low, 1e-3 * ends[0]), min(high, 1e3 * ends[1])
    if judged.verdict == "pass":
        assert high <= limit
    if judged.verdict == "fail":
        assert low > limit
    assert judged.verdict in (plain.verdict, f"{plain.verdict} unless", "inconclusive")
    assert judged.ends == widened(ends, doubt) and judged.margin == limit / judged.ends[1]
    if judged.verdict != plain.verdict:
        assert judged.why is VerdictReason.ACCURACY and any(
            one in str(judged.reason) for one in doubt.reasons
        )
        assert low <= limit < high
        # off by so much it would be at the limit
        assert judged.off == pytest.approx(limit / ends[1] if plain.verdict == "pass" else ends[0] / limit)


@pytest.mark.parametrize(
    ("factor", "ends", "verdict"),
    [
        # a factor of two either way
        (Bounds.factor_bounds(2.0), (0.5, 0.9), "pass"),
        (Bounds.factor_bounds(2.0), (0.5, 1.1), "pass unless"),
        (Bounds.factor_bounds(2.0), (3.9, 9.0), "fail unless"),
        (Bounds.factor_bounds(2.0), (4.1, 9.0), "fail"),
        # only less can leak, or only more
        ((0.0, 1.0), (0.5, 1.9), "pass"),
        ((0.0, 1.0), (3.0, 9.0), "fail unless"),
        ((1.0, math.inf), (3.0, 9.0), "fail"),
        ((1.0, math.inf), (0.5, 0.9), "pass unless"),
        # orders of magnitude are three
        ((0.0, math.inf), (1e-9, 0.0019), "pass"),
        ((0.0, math.inf), (1e-9, 0.0021), "pass unless"),
        # of nothing there is nothing more
        ((0.0, math.inf), (0.0, 0.0), "pass"),
    ],
)
def test_a_factor_that_the_theory_may_be_off_by_has_to_fit_between(factor, ends, verdict):
    few = Validity.of([remark("few channels", Level.DOUBTFUL, "few channels", factor)])
    judged = LoadVerdict.of(Limit("leak rate", 2.0), widened(ends, few), few)
    assert judged.verdict == verdict
    assert (judged.why, str(judged.reason)) == (
        (VerdictReason.ACCURACY, "few channels") if "unless" in verdict else (VerdictReason.LIMIT, "")
    )


@pytest.mark.slow
def test_what_the_mesh_leaves_uncertain_has_to_fit_between_too():
    solved = rough_result()
    error = replace(solved.discretisation_error, leak_rate=0.05)
    coarse = replace(solved, loads=tuple(load.with_values(mesh_error=error) for load in solved.loads))
    low, high = solved.highest.leak_range
    for limit, fine, rough in (
        (1.04 * high, "pass", "pass unless"),
        (1.06 * high, "pass", "pass"),
        (low / 1.04, "fail", "fail unless"),
        (low / 1.06, "fail", "fail"),
    ):
        judged = [required(one, leak_rate=f"{limit!r} m^3/s") for one in (solved, coarse)]
        assert [one.loads[-1].verdict for one in judged] == [fine, rough]
    (told, *_) = verdict_sentences(required(coarse, leak_rate=f"{1.04 * high!r} m^3/s"))
    assert "larger than a factor 1.04 (mesh)" in told
    # nor is a class claimed, of which G allows 2 mm³/s per mm of DN 25
    at_limit = with_ends(solved.highest, 1e-10, 0.96 * 50e-9)
    assert "G" in {one.name for one in leakage_classes(solved.case, at_limit)}
    assert "G" not in {
        one.name for one in leakage_classes(solved.case, at_limit.with_values(mesh_error=error))
    }
    # a mesh error that is small enough makes no load doubtful
    assert coarse.highest.validity == solved.highest.validity


def test_without_a_leak_rate_or_a_limit_nothing_is_decided():
    for limit, ends in ((Limit("leak rate", 2.0), (math.nan, math.nan)), (Limit("x", math.nan), (1.0, 1.0))):
        judged = LoadVerdict.of(limit, ends)
        assert (
            judged.verdict is Verdict.INCONCLUSIVE
            and judged.why is VerdictReason.UNKNOWN
            and math.isnan(judged.margin)
        )


def test_no_visible_leakage_is_met_by_what_nobody_sees_and_failed_by_a_drop_in_the_shortest_test():
    unseen, seen = invisible_leak_rate(gas=False), visible_leak_rate(gas=False)
    limit = Limit("ISO 5208 A", unseen, seen)
    assert LoadVerdict.of(limit, (0.0, 0.0)).verdict == "pass"
    little = LoadVerdict.of(limit, (0.0, 0.5 * unseen))
    assert little.verdict == "pass" and little.margin == pytest.approx(2.0)
    assert LoadVerdict.of(limit, (1.01 * seen, 2 * seen)).verdict == "fail"
    few = LoadVerdict.of(limit, (0.0, 0.5 * seen))
    assert few.verdict == "inconclusive" and few.margin == pytest.approx(2.0 * unseen / seen)
    # 1/16 ml in 15 s
    assert seen == pytest.approx(1e-6 / 16 / 15, rel=1e-12)


def test_the_limit_of_a_class_is_that_of_the_standard_and_the_tighter_of_two_counts():
    result = required(leak_rate="1e-3 m^3/s", standard="iso 5208:2015", **{"class": "g"})
    # 2 mm³/s per mm of DN 25
    assert [(one.name, one.leak_rate) for one in limits(result.case, 20e5)] == [
        ("leak rate", pytest.approx(1e-3)),
        ("ISO 5208 G", pytest.approx(50e-9, rel=1e-12)),
    ]
    assert result.verdict == "fail" and result.judgement.worst.limit.name == "ISO 5208 G"
    assert required(leak_rate="1e-3 m^3/s").verdict == "pass"


def test_a_bubble_has_the_volume_of_its_standard_or_of_the_requirement():
    def limit(**table):
        (found,) = limits(case(fluid={"name": "air"}, requirement=table), 5e5)
        return found

    iso_a = {"standard": "ISO 5208", "class": "A"}
    assert limit(**iso_a).visible == pytest.approx(0.06545e-6 / 15, rel=1e-3)
    assert limit(**iso_a, bubble_volume="0.15 ml").visible == pytest.approx(0.15e-6 / 15)
    # up to DN 50 less than one bubble in 15 s
    assert limit(standard="API 598").leak_rate == pytest.approx(0.01e-6 / 15)
    assert limit(standard="API 598", bubble_volume="0.04 ml").leak_rate == pytest.approx(0.04e-6 / 15)
    assert limit(standard="API 598").bubble_volume == pytest.approx(1e-8)
    assert limit(standard="ISO 5208", **{"class": "B"}).bubble_volume is None
    own = {"leak_rate": "5 bubbles/min", "bubble_volume": "0.15 ml"}
    assert limit(**own).bubble_volume == pytest.approx(0.15e-6)
    counted = "one bubble is 0.15 ml, 5 bubbles/min are allowed"
    assert counted in requirement_lines(case(fluid={"name": "air"}, requirement=own))
    # none that is seen: no count
    told = requirement_lines(case(fluid={"name": "air"}, requirement=iso_a))
    assert "one bubble is 0.065 ml" in told


@pytest.mark.parametrize(("volume", "told"), [(None, "0.3"), ("0.6 ml", "0.6")])
def test_a_relief_valve_is_held_against_so_many_bubbles(volume, told):
    # API 527 up to 1000 psi, orifices above 0.307 in^2: 20 bubbles/min, whatever their volume
    own = {} if volume is None else {"bubble_volume": volume}
    valve = case(
        fluid={"name": "air"},
        load={"fluid_pressure": "54 bar", "set_pressure": "60 bar", "pressure_side": "inner"},
        requirement={"standard": "API 527", **own},
    )
    assert f"one bubble is {told} ml, 20 bubbles/min are allowed" in requirement_lines(valve)


def test_the_limit_of_class_v_follows_the_pressure_of_each_load():
    result = required(standard="ANSI/FCI 70-2", **{"class": "V"})
    low, _, high = (load.judgement.limit.leak_rate for load in result.loads)
    assert high / low == pytest.approx(20e5 / 2e5, rel=1e-12)


def test_margin_is_the_limit_over_the_upper_end_of_both_readings():
    result = required(leak_rate="1e-3 m^3/s")
    for load, (low, high) in zip(result.loads, result.leak_ranges, strict=True):
        assert low < high
        assert load.margin == pytest.approx(1e-3 / high, rel=1e-12)
    low, high = result.leak_ranges[-1]
    between = required(leak_rate=f"{math.sqrt(low * high)} m^3/s", fluid_pressure="2000 kPa")
    assert [load.verdict for load in between.loads] == [None, None, "inconclusive"]
    assert between.verdict == "inconclusive" and between.judgement.worst.why is VerdictReason.INTERVAL
    assert between.margin == pytest.approx(math.sqrt(low / high), rel=1e-9)


def test_the_worst_load_decides_and_a_load_that_opens_fails():
    result = required(leak_rate="1e-3 m^3/s")
    worst = max(result.leak_ranges, key=lambda ends: ends[1])
    assert result.margin == pytest.approx(1e-3 / worst[1], rel=1e-12)
    opened = {(64e5, 0.0): Problem("load.applied_force", "the seal is open", kind="open")}
    unsolved = {(64e5, 0.0): Problem("load", "no convergence", kind="solution")}
    assert required(missing=opened, leak_rate="1e-3 m^3/s").verdict == "fail"
    left = required(missing=unsolved, leak_rate="1e-3 m^3/s")
    assert left.verdict == "inconclusive" and left.judgement.left_out == 1 and math.isnan(left.margin)
    # a failed load is worse than one that is not known
    assert required(missing=unsolved, leak_rate="1e-12 m^3/s").verdict == "fail"


def test_of_loads_that_fail_the_surest_decides():
    """Not the one with the widest interval, whose upper end alone is far above the limit."""
    limit = Limit("leak rate", 1.0)
    sure, wide = LoadVerdict.of(limit, (100.0, 200.0)), LoadVerdict.of(limit, (2.0, 1e6))
    assert wide.margin < sure.margin
    assert max((sure, wide), key=severity) is sure
    opened = LoadVerdict.of(limit, (math.inf, math.inf))
    assert max((sure, opened, wide), key=severity) is opened
    # of those that pass it is still the one with the least margin
    near, far = LoadVerdict.of(limit, (0.1, 0.9)), LoadVerdict.of(limit, (0.01, 0.1))
    assert max((near, far), key=severity) is near
    doubt = Validity.of([remark("lay", Level.VALID, "a lay", Bounds.factor_bounds(3.0))])
    ranked = [
        LoadVerdict.of(limit, ends, doubt)
        for ends in ((0.01, 0.1), (0.1, 2.0), (0.1, 9.0), (0.5, 9.0), (2.0, 9.0))
    ]
    assert [str(one.verdict) for one in ranked] == [*Verdict]
    assert sorted(ranked, key=severity) == ranked


def test_only_the_loads_that_are_asked_for_decide():
    opened = {(64e5, 0.0): Problem("load.applied_force", "the seal is open", kind="open")}
    result = required(missing=opened, leak_rate="1e-3 m^3/s", fluid_pressure=["2 bar", "5 bar"])
    assert result.verdict == "pass" and result.judgement.load_numbers == (0, 1)
    assert result.loads[2].verdict is None and result.loads[2].margin is None
    table = leak_table(result)
    assert table["verdict"].tolist() == ["pass", "pass", "", ""] and math.isnan(table["margin"].iloc[2])


def test_shares_are_those_of_stress_and_peak():
    load = rough_result().loads[-1]
    shares = required(leak_rate="1e-3 m^3/s").judgement.shares
    # the ball has no yield stress, the seat 1 GPa and 3.5 GPa hardness
    assert shares.body == "seat"
    assert shares.yield_stress == pytest.approx(load.contact.fields["seat"].von_mises.max() / 1e9, rel=1e-12)
    assert shares.hardness == pytest.approx(load.contact.profile.peak_pressure / 3.5e9, rel=1e-12)
    assert shares.opening is None


@pytest.mark.parametrize(
    ("fluid", "test_fluid", "ratio"),
    [
        ({"name": "water"}, "", (1.0, 1.0)),
        ({"name": "water", "temperature": "5 degC"}, "", (1.0, 1.0)),
        ({"viscosity": "0.5 mPa s"}, "", (1.0, 1.0)),
        # viscosity of water at 20 °C: 1.0016 mPa s (IAPWS)
        ({"viscosity": "46 mPa s"}, "water", (45.9, 45.9)),
        ({"name": "air"}, "", (1.0, 1.0)),
        ({"name": "nitrogen"}, "", (1.0, 1.0)),
        # thicker than the water of any test
        ({"name": "water", "viscosity": "10 mPa s"}, "water", (9.98, 9.98)),
        # viscous: 19.6 over 18.2 µPa s; molecular: root of 4.003 over 28.97 g/mol = 0.372; but where D = 0.0123 of
        # helium is 0.0357 of air, Fukui & Kaneko give Q_P 2.97 and 2.44: 0.372 x 2.44/2.97
        ({"name": "helium"}, "air", (0.305, 1.077)),
        # hot gas: 26.0 over 18.2 µPa s, 1.27 times as fast; D = 0.0796 and 0.1447: Q_P 2.13 and 1.89, 1.89/2.13/1.27
        ({"name": "air", "temperature": "200 degC"}, "air", (0.701, 1.431)),
        ({"name": "air", "temperature": "40 degC"}, "", (1.0, 1.0)),
    ],
)
def test_a_class_is_judged_for_the_fluid_of_its_test(fluid, test_fluid, ratio):
    tables = {"fluid": fluid, "requirement": {"standard": "ISO 5208", "class": "D"}}
    (limit,) = limits(case(**tables), 5e5)
    assert limit.test_fluid == test_fluid
    assert limit.ratio == pytest.approx(ratio, rel=5e-3)
    (own,) = limits(case(fluid=fluid, requirement={"leak_rate": "1 ml/min"}), 5e5)
    assert own.ratio == (1.0, 1.0)


def test_a_gas_that_is_not_that_of_the_test_widens_the_interval():
    limit = Limit("ISO 5208 D", 1.0, test_fluid="air", ratio=(0.4, 1.1))
    assert LoadVerdict.of(limit, (0.5, 0.9)).verdict == "pass"
    assert LoadVerdict.of(limit, (2.6, 3.0)).verdict == "fail"
    unsure = LoadVerdict.of(limit, (1.5, 2.0))
    assert unsure.verdict == "inconclusive" and unsure.why is VerdictReason.TEST_FLUID
    assert unsure.ends == pytest.approx((0.6, 2.2))


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({}, "requirement"),
        ({"class": "B"}, "requirement.class"),
        ({"standard": "ISO 5208"}, "requirement.class"),
        ({"standard": "ISO 5208", "class": "H"}, "requirement.class"),
        ({"standard": "DIN 1"}, "requirement.standard"),
        ({"standard": "FCI 70-2", "class": "IV"}, "requirement.rated_capacity"),
        ({"standard": "FCI 70-2", "class": "VI"}, "requirement.class"),
        ({"leak_rate": "1 ml/min", "fluid_pressure": "3 bar"}, "requirement.fluid_pressure"),
        ({"leak_rate": "1 ml"}, "requirement.leak_rate"),
        ({"leak_rat": "1 ml/min"}, "requirement.leak_rat"),
    ],
)
def test_what_cannot_be_judged_is_refused_at_its_key(table, key):
    with pytest.raises(InputError) as refused:
        case(requirement=table)
    assert key in [one.key for one in refused.value.problems]


def test_without_surface_or_fluid_there_is_nothing_to_judge():
    with pytest.raises(InputError, match=r"without \[fluid\]"):
        case(requirement={"leak_rate": "1 ml/min"}, fluid=None)


def test_standards_are_found_by_the_names_that_people_give_them():
    for written in ("ISO 5208", "iso5208", "ISO 5208:2015", "ISO 5208-2015"):
        assert standard_named(written) == "ISO 5208"
    assert standard_named("FCI70-2") == "FCI 70-2" and standard_named("EN 12266") is None
    assert case(requirement={"standard": "API 598"}).requirement.standard_and_class == (
        "API 598",
        "metal-seated",
    )
    assert "IV" not in classes_of("FCI 70-2", gas=True, rated_capacity=False)
    with pytest.raises(FluidError):
        leakage_limits(-1.0, gas=True)


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_report_terminal_and_summary_say_the_same_verdict(capsys):
    result = required(leak_rate="1 ml/min")
    first = verdict_sentences(result)[0]
    assert first.startswith("Fail at 20 bar: at least ")
    show_result(result, details=True)
    assert first.removesuffix(".") in " ".join(capsys.readouterr().out.split())
    page = report(result, full=True).replace("\xa0", " ")
    assert first.removesuffix(".") in page and 'class="verdict fail"' in page
    told = json.loads(json.dumps(summary(result)["requirement"]))
    assert told["verdict"] == "fail" and told["says"][0] == first
    assert told["margin"] == result.margin and told["judged_loads"] == 3
    assert [row["verdict"] for row in summary(result)["loads"]] == ["fail"] * 3


def test_each_way_to_a_verdict_has_its_sentence():
    solved = rough_result()
    opened = {(64e5, 10.0): Problem("load.applied_force", "the seal is open", kind="open")}
    unsolved = {(64e5, 0.0): Problem("load", "no convergence", kind="solution")}
    outside = replace(solved, loads=tuple(load.with_values(validity=OUTSIDE) for load in solved.loads))
    few = Validity.of([remark("few channels", Level.DOUBTFUL, "few channels", Bounds.factor_bounds(3.3))])
    doubted = replace(solved, loads=tuple(load.with_values(validity=few) for load in solved.loads))
    low, high = solved.leak_ranges[-1]
    told = {
        "times as much": required(leak_rate="1e-3 m^3/s"),
        "the seal is open.": required(missing=opened, leak_rate="1 ml/min"),
        "no result (no convergence)": required(missing=unsolved, leak_rate="1e-3 m^3/s"),
        "outside the theory (seat: 3 times": required(outside, leak_rate="1 ml/min"),
        "times the allowed ": required(leak_rate=f"{0.5 * (low + high)} m^3/s"),
        "which is visible": required(standard="ISO 5208", **{"class": "A"}),
        "Pass at 20 bar unless the model error is larger than a factor 2.0": required(
            doubted, leak_rate=f"{2 * high} m^3/s"
        ),
    }
    for words, result in told.items():
        assert words in verdict_sentences(result)[0]
    assert basis_lines(solved)[0].startswith("ISO 5208 G would need ")


@pytest.mark.parametrize("over", [1e-4, 0.1, 0.3, 0.8, 0.99, 1.01, 1.2, 3.0, 10.0, 1e3])
def test_limit_and_leak_rate_stand_in_one_unit(over):
    solved = rough_result()
    for end in solved.leak_ranges[-1]:
        sentence = verdict_sentences(required(leak_rate=f"{over * end!r} m^3/s"))[0]
        units = {word for word in sentence.replace(",", " ").split() if word.endswith(("/min", "/h", "³/s"))}
        assert len(units) == 1, sentence


@pytest.mark.parametrize(
    ("over", "told"), [(14.3, "is 10 times as much"), (1 / 143, "100 times the allowed")]
)
def test_a_factor_has_no_more_digits_than_the_leak_rate_it_is_made_of(over, told):
    solved = rough_result()
    few = Validity.of([remark("few channels", Level.DOUBTFUL, "few channels", Bounds.factor_bounds(3.3))])
    doubted = replace(solved, loads=tuple(load.with_values(validity=few) for load in solved.loads))
    low, high = doubted.leak_ranges[-1]
    judged = required(doubted, leak_rate=f"{over * (high if over > 1 else low)!r} m^3/s")
    assert told in verdict_sentences(judged)[0]
    (margin, *_) = (tile.value for tile in tiles(judged) if tile.name == "Margin")
    assert len(margin.split("·")[0].replace("0.", "").strip("0")) == 1


def test_factors_claim_no_more_than_two_digits():
    assert [factor_text(one) for one in (0.0123, 1.05, 12.34, 123.4, 5000.0, 2e6)] == [
        "0.012",
        "1.1",
        "12",
        "120",
        "5000",
        "more than a million",
    ]


def test_next_class_is_the_loosest_one_that_is_missed():
    result = rough_result()
    load = result.highest
    found = next_class(result.case, load)
    # 2 mm³/s per mm of DN 25, which the leak rate and what the mesh leaves uncertain of it have to keep
    highest = load.leak_range[1] * (1 + result.discretisation_error.leak_rate)
    assert (found.name, found.factor) == ("G", pytest.approx(highest / 50e-9, rel=1e-12))
    assert next_class(result.case, with_ends(load, 1e-10, 2.4e-9)).name == "CC"
    assert next_class(result.case, load.with_values(validity=OUTSIDE)) is None
    # a class that the calculated leak rate meets, but not twice as much
    few = load.with_values(
        validity=Validity.of([remark("channels", Level.DOUBTFUL, "few", Bounds.factor_bounds(2.0))])
    )
    for end, name, told in (
        (30e-9, "G", "ISO 5208 G is met as calculated, but by less than the error of the calculation"),
        (65e-9, "G", "ISO 5208 G would need 3 times less leakage"),
    ):
        assert next_class(result.case, with_ends(few, 1e-10, end)).name == name
        assert next_class_in_words(result.case, with_ends(few, 1e-10, end)) == told


@pytest.mark.parametrize(
    ("over", "told"),
    [(1.004, "0.4 % less"), (1.04, "4 % less"), (1.3, "1.3 times less"), (12.34, "12 times less")],
)
def test_what_little_is_missing_to_a_class_is_told_in_per_cent(over, told):
    """Two digits of a factor would say "1.0 times less"."""
    result = rough_result()
    words = next_class_in_words(result.case, with_ends(result.highest, 1e-10, over * 50e-9))
    assert words == f"ISO 5208 G would need {told} leakage"


def test_check_says_what_will_be_judged_and_where():
    told = requirement_lines(
        case(
            fluid={"viscosity": "46 mPa s"},
            requirement={"leak_rate": "0.1 ml/min", "standard": "ISO 5208", "class": "D"},
        )
    )
    assert told[0] == "leak rate: 0.10 ml/min (1.67·10⁻⁹ m³/s) at 2 bar to 20 bar (3 pressures)"
    assert told[1].startswith("ISO 5208 D: 0.15 ml/min (2.50·10⁻⁹ m³/s)")
    assert "tested with water, which leaks 46 times as much" in told[3]


def test_a_design_of_a_study_is_judged_like_a_run():
    one = case(load={"fluid_pressure": "20 bar"}, requirement={"leak_rate": "1e-4 m^3/s"})
    found = evaluate_design(one, ["leak_rate_high_m3_per_s", "margin"])
    assert found.verdict == "pass"
    assert found.values["margin"] == pytest.approx(1e-4 / found.values["leak_rate_high_m3_per_s"], rel=1e-12)
    of_run = required(leak_rate="1e-4 m^3/s")
    assert found.values["margin"] == pytest.approx(of_run.loads[-1].margin, rel=5e-3)
    # nobody asked for it
    assert evaluate_design(one, ["peak_pressure_Pa"]).verdict is None


@pytest.mark.slow
def test_a_sealed_design_has_a_margin_that_can_be_compared():
    soft = {**STEEL, "hardness": "3.5 GPa"}
    smooth = {"kind": "self-affine", "rms_height": "0.01 um", "hurst": 0.8, "q_low": "1e4 1/m"}
    tight = case(
        closure=ball(),
        seat=cone(soft),
        roughness={"spectrum": {**smooth, "q_rolloff": "1e4 1/m", "q_high": "1e6 1/m"}},
        load={"fluid_pressure": "20 bar", "applied_force": "40 kN"},
        requirement={"leak_rate": "1 ml/min"},
    )
    found = evaluate_design(tight, ["leak_rate_m3_per_s", "margin"])
    assert found.values["leak_rate_m3_per_s"] == 0.0
    assert found.values["margin"] == LARGEST_MARGIN


@pytest.mark.slow
def test_a_study_has_the_verdict_beside_its_margin(tmp_path):
    study = fem_seal.Study(
        case(load={"fluid_pressure": "20 bar"}, requirement={"leak_rate": "20 ml/min"}),
        parameters={"roughness.spectrum.rms_height": ["0.5 um", "1.9 um"]},
        responses=["verdict"],
    )
    table = study.run(folder=tmp_path, workers=0).table
    assert table["verdict"].tolist() == ["pass", "fail"]
    assert table["margin"].iloc[0] > 1.0 > table["margin"].iloc[1]
    with pytest.raises(InputError, match=r"\[requirement\]"):
        fem_seal.Study(
            case(load={"fluid_pressure": "20 bar"}),
            parameters={"seat.angle": ["44 deg", "45 deg"]},
            responses=["verdict"],
        )


def test_nothing_is_said_where_nothing_is_required():
    result = rough_result()
    assert result.verdict is None and result.margin is None
    assert seal_verdict(result.case, result.loads, {}) is None
    assert not {"verdict", "margin"} & {*leak_table(result)}
    assert summary(result)["requirement"] is None


@pytest.mark.parametrize("text", ["1.01325 mbar l/s", "0.101325 Pa m^3/s", "1013.25 mbar*cm^3/s"])
def test_a_gas_may_leak_pressure_times_volume(text):
    # one atm cm^3/s, the usual conversion: 1.01325 mbar l/s
    gas = case(fluid={"name": "helium"}, requirement={"leak_rate": text})
    assert gas.requirement.leak_rate == pytest.approx(1e-6, rel=1e-14)
    aimed = gas.replace({"load.target_leak_rate": text})
    assert aimed.load.target_leak_rate == gas.requirement.leak_rate
    assert gas.replace({"requirement.leak_rate": 1e-6}).requirement.leak_rate == 1e-6


@pytest.mark.parametrize(
    ("text", "per_minute"), [("3 drops/min", 3), ("1 drop / h", 1 / 60), (".5 drops/s", 30)]
)
def test_a_limit_may_be_counted_in_drops(text, per_minute):
    limit = case(requirement={"leak_rate": text}).requirement.leak_rate
    # 16 drops are a millilitre
    assert limit == pytest.approx(per_minute / 16 * 1e-6 / 60, rel=1e-14)
    with pytest.raises(InputError, match=r"requirement.leak_rate.*counted in drops, and the fluid is a gas"):
        case(fluid={"name": "helium"}, requirement={"leak_rate": text})


def test_of_a_liquid_pressure_times_volume_is_no_amount():
    with pytest.raises(
        InputError, match=r"requirement.leak_rate.*leak rate of a gas, and the fluid is a liquid"
    ):
        case(requirement={"leak_rate": "1e-3 mbar l/s"})
    with pytest.raises(InputError, match=r'requirement.leak_rate.*unit "mbar" does not fit'):
        case(requirement={"leak_rate": "1e-3 mbar"})


def test_a_class_is_claimed_for_the_fluid_of_its_test_whether_it_is_required_or_not():
    """An oil as thick as 46 times water, which leaks 46 times less, meets the classes that the water meets."""
    solved = rough_result()
    load = solved.highest
    water = solved.case.replace({"fluid": {"viscosity": "1.0016 mPa s"}})
    oil = solved.case.replace({"fluid": {"viscosity": "46.0736 mPa s"}})
    for ends in ((1e-10, 2.4e-9), (1e-12, 1e-11), (1e-9, 1.0)):
        of_oil = with_ends(load, ends[0] / 46, ends[1] / 46)
        assert leakage_classes(oil, of_oil) == leakage_classes(water, with_ends(load, *ends))
    assert next_class(oil, with_ends(load, 1e-10 / 46, 2.4e-9 / 46)).name == "CC"
    assert leakage_lines(oil, load, solved.loads)[-1].startswith(
        "  Classes are for a test with water, which leaks 46"
    )
    assert "Classes are for a test" not in "".join(leakage_lines(water, load, solved.loads))


def test_a_limit_in_mbar_litres_per_second_is_compared_in_them():
    solved = rough_result()
    gas = replace(solved, case=solved.case.replace({"fluid": {"name": "helium"}}))
    _, high = gas.leak_ranges[-1]
    # 1 mbar l/s is 0.1 Pa m³/s, at 101325 Pa
    for limit, told in (
        (high * 101325 / 0.1 / 1000, "times the allowed"),
        (high * 101325 / 0.1 * 1000, "times as much"),
    ):
        judged = required(gas, leak_rate=f"{limit!r} mbar l/s")
        (sentence, *_) = verdict_sentences(judged)
        (announced, *_) = requirement_lines(required(gas, leak_rate="2e-3 mbar l/s").case)
        assert told in sentence and sentence.count("mbar l/s") == 2 and "/min" not in sentence
    assert announced.startswith("leak rate: 0.0020 mbar l/s (1.97·10⁻⁹ m³/s)")


def test_a_verdict_with_doubt_says_so_in_its_first_words():
    doubt = Validity.of([remark("channels", Level.DOUBTFUL, "leak rate up to a factor 3.3 off")])
    solved = rough_result()
    doubted = replace(solved, loads=tuple(load.with_values(validity=doubt) for load in solved.loads))
    low, _ = solved.leak_ranges[-1]
    for limit in ("1e-3 m^3/s", f"{low / 2!r} m^3/s"):
        plain, *_ = verdict_sentences(required(solved, leak_rate=limit))
        first, *others = verdict_sentences(required(doubted, leak_rate=limit))
        assert "with doubt" not in plain
        assert first == plain.replace(" bar:", " bar, with doubt:", 1)
        assert others[0] == "The leak rate at 20 bar is doubtful: leak rate up to a factor 3.3 off."
    # a leak of a million times the limit is one, whatever the doubt
    far = required(doubted, leak_rate=f"{1e-6 * low!r} m^3/s")
    assert far.verdict == "fail" and not any("doubt" in one for one in verdict_sentences(far))


@pytest.mark.parametrize("ends", [(1e-12, 2e-12), (1e-6, 2e-6), (0.0, 0.0)])
def test_without_its_interval_a_leak_rate_decides_nothing(ends):
    judged = LoadVerdict.of(Limit("leak rate", 1e-9), ends, complete=False)
    assert (judged.verdict, judged.why) == (Verdict.INCONCLUSIVE, VerdictReason.UNSAMPLED)
    assert math.isnan(judged.margin)
    far = LoadVerdict.of(Limit("leak rate", 1e-9), (1.01e-6, 1e-3), complete=False)
    assert (far.verdict, far.why) == (Verdict.FAIL, VerdictReason.FAR)
    opened = LoadVerdict.of(Limit("leak rate", 1e-9), (math.inf, math.inf), complete=False)
    assert opened.verdict is Verdict.FAIL


@pytest.mark.slow
def test_an_interval_that_cannot_be_calculated_leaves_the_verdict_inconclusive(monkeypatch):
    def fails(*_, **__):
        raise ConvergenceError("nothing converges")

    monkeypatch.setattr("fem_seal.answers.uncertainty.leak_interval", fails)
    result = fem_seal.run(
        case(
            load={"fluid_pressure": "20 bar"},
            uncertainty={"samples": 16, "hardness": {"relative": 0.1}},
            requirement={"leak_rate": "1 l/min"},
        )
    )
    assert result.judgement.worst.why is VerdictReason.UNSAMPLED
    (told, *_) = verdict_sentences(result)
    assert told.startswith("Inconclusive at 20 bar") and "interval" in told


def test_of_several_doubts_the_sentence_names_all_and_what_they_come_to():
    few, thick = (
        remark("x", Level.DOUBTFUL, reason, factor)
        for reason, factor in (("few channels", Bounds.factor_bounds(1.7)), ("thickens", (0.5, 1.6)))
    )
    doubt = Validity.of([few, thick])
    assert doubt.leak_reason(more=True) == "together a factor 2.7 more: few channels; thickens"
    assert doubt.leak_reason(more=False) == "together a factor 3.4 less: few channels; thickens"
    # what only leaks less takes nothing from an upper end, for classes neither
    less = Validity.of([remark("x", Level.DOUBTFUL, "thickens", (0.4, 0.9))])
    assert less.leak_factor == (0.4, 1.0)
    load, case_ = rough_result().highest, rough_result().case
    assert not any(
        one.name == "G"
        for one in leakage_classes(case_, with_ends(load, 1e-10, 52e-9).with_values(validity=less))
    )


def test_where_nothing_visible_may_leak_the_sentence_compares_with_no_number():
    few = Validity.of([remark("few channels", Level.DOUBTFUL, "few channels", (0.0, math.inf))])
    solved = rough_result()
    doubted = replace(solved, loads=tuple(load.with_values(validity=few) for load in solved.loads))
    (told, *_) = verdict_sentences(required(doubted, standard="ISO 5208", **{"class": "A"}))
    assert told.endswith("(few channels).") and "times" not in told


def test_what_the_interval_holds_is_not_counted_again():
    scatter = Validity.of([remark("direct scatter", Level.DOUBTFUL, "scatter", Bounds.factor_bounds(4.0))])
    load = rough_result().highest.with_values(validity=scatter, mesh_error=None)
    assert load.leak_validity.leak_factor == (1.0, 1.0) and load.leak_digits == 1


def test_less_than_a_molecule_per_hour_is_told_as_none_measurable():
    # k T / p = 1.380649e-23 x 293.15 / 101325 m^3 in 3600 s
    assert case(fluid={"name": "air"}).fluid.volume.least == pytest.approx(1.10957e-29, rel=1e-5)
    assert case(fluid={"name": "water"}).fluid.volume.least == pytest.approx(1e-27 / 3600)
    little = (8e-62, 8e-62)
    assert Display().leak_range(little) == "none measurable, less than a cubic nanometre per hour"
    assert Display().leak_range((8e-62, 1e-9)) == "0 to 60 µl/min"
    gas = case(fluid={"name": "air"}).fluid.volume
    assert Display().leak_range(1.05e-29, volume=gas) == "none measurable, less than a molecule per hour"
    assert "measurable" not in Display().leak_range(1.2e-29, volume=gas)
    judged = LoadVerdict.of(Limit("leak rate", 1e-9), little)
    # the number itself is kept
    assert judged.verdict == "pass" and judged.margin == pytest.approx(1e-9 / 8e-62)
    solved = required(leak_rate="1e-3 m^3/s")
    said = verdict_sentences(with_worst(solved, judged))[0]
    assert said == "Pass at 20 bar: nothing measurable leaks."


def test_the_terminal_shows_no_number_that_nobody_could_measure(capsys):
    rows = [
        {
            "fluid_pressure_Pa": 1e5,
            "leak_rate_m3_per_s": 8e-62,
            "leak_rate_high_m3_per_s": 1e-9,
            "margin": 1e40,
            "validity": "valid",
        },
        {
            "fluid_pressure_Pa": 2e5,
            "leak_rate_m3_per_s": 0.0,
            "leak_rate_high_m3_per_s": 0.0,
            "margin": math.inf,
            "validity": "valid",
        },
    ]
    show_leak_table(
        Display(),
        rows,
        "",
        rough_result().loads[:2],
        case(fluid={"name": "air", "temperature": "200 degC"}).fluid.volume,
    )
    shown = capsys.readouterr().out
    assert "e-" not in shown and "inf" not in shown
    assert ">1e6" in shown and "sealed" in shown
    assert "<: none measurable, less than a molecule per hour" in shown
    assert "mm³/s: volume of the gas at 200 °C and 1.01325 bar" in shown


def test_a_gas_has_one_state_on_its_page_and_a_limit_in_another_says_so():
    warm = {"name": "nitrogen", "temperature": "200 degC"}
    told = requirement_lines(case(fluid=warm, requirement={"leak_rate": "1 Nml/min"}))
    # 1 ml x 473.15/273.15
    assert told[0].startswith("leak rate: 1.7 ml/min")
    assert "volumes are those of the gas at 200 °C and 1.01325 bar" in told
    assert not any("volumes" in one for one in requirement_lines(case(requirement={"leak_rate": "1 ml/min"})))
    limit = Limit("leak rate", case(fluid=warm, requirement={"leak_rate": "1 Nml/min"}).requirement.leak_rate)
    judged = LoadVerdict.of(limit, (1e-9, 2e-9))
    solved = required(leak_rate="1e-3 m^3/s")
    shown = replace(solved, case=solved.case.replace({"fluid": {"name": "nitrogen"}}))
    sentences = verdict_sentences(with_worst(shown, judged))
    assert "(1 Nml/min) is" in sentences[0]
    assert "Volumes are those of the gas at 20 °C and 1.01325 bar." in sentences


def test_volumes_of_a_hot_gas_are_cold_where_the_standard_tests_with_air():
    hot = case(fluid={"name": "nitrogen", "temperature": "200 degC"}, requirement={"leak_rate": "1 ml/min"})
    assert _state(hot, Limit("API 598", 1e-9, test_fluid="air")).startswith("20 °C")
    assert _state(hot, Limit("leak rate", 1e-9)).startswith("200 °C")


def test_the_share_of_the_yield_stress_is_that_of_the_crest():
    """Of a seal that is not round, as that of the hardness is: elastic stress grows with the peak pressure."""
    load = oval_result().highest
    crest = float(load.circumference.peak_pressure.max()) / load.peak_pressure
    shares = _shares([load], (1e9, None))
    assert shares.hardness == pytest.approx(crest * load.peak_pressure / 1e9)
    # the seat yields at 1 GPa
    assert shares.yield_stress == pytest.approx(crest * load.contact.fields["seat"].von_mises.max() / 1e9)
    assert crest > 1.2
