"""What backs an interval: its parts by sources, what is in none of them, and a larger load before."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import pytest
from around_results import oval_result
from places import EXAMPLES

import fem_seal
from fem_seal.answers.error_shares import ErrorShares
from fem_seal.output.answers.error_shares import backing_in_brief
from fem_seal.output.files import write_summary
from fem_seal.output.report.page import write_report


@cache
def ball(**changes):
    case = fem_seal.load_case(EXAMPLES / "ball_cone.toml")
    loads = {"leak.theory": "corrected", "load.fluid_pressure": ["5 bar", "20 bar"]}
    return fem_seal.run(case.replace({**loads, **{key.replace("__", "."): x for key, x in changes.items()}}))


def test_the_scenario_is_a_case_with_that_earlier_load():
    found = ball().error_shares[-1].earlier_load
    assert found.force == pytest.approx(2.0 * ball().highest.contact_force, rel=1e-12)
    after = ball(load__largest_earlier_force=found.force)
    share = after.highest.leak.leak_rate / ball().highest.leak.leak_rate
    assert found.share == pytest.approx(share, rel=1e-3) and 0.5 < share < 0.9
    # a case that says so has no such scenario, nor has one that does not yield
    assert after.error_shares[-1].earlier_load is None
    assert ball(leak__plasticity=False).error_shares[-1].earlier_load is None


BOLTS = {"bolts.number": 4, "bolts.size": "M6", "bolts.length": "34 mm", "bolts.material": "steel"}


@pytest.mark.parametrize("scatter", [0.0, 0.3])
def test_of_bolts_the_larger_load_is_twice_what_presses_under_the_fluid(scatter):
    """As a case has it that gives the force of the bolts, and that load before."""
    bolts = {**BOLTS, "bolts.preload": "500 N", "bolts.torque_scatter": scatter}
    one = {"load.fluid_pressure": "20 bar"}
    bolted = (
        ball(**{**bolts, **one})
        if not scatter
        else ball(**{**bolts, **one, "bolts.preload": None, "bolts.torque": "0.6 N m"})
    )
    found = bolted.error_shares[-1].earlier_load
    assert found.force == pytest.approx(2.0 * bolted.highest.contact_force, rel=1e-12)
    after = ball(
        **one, load__applied_force=bolted.highest.applied_force, load__largest_earlier_force=found.force
    )
    assert found.share == pytest.approx(
        after.highest.leak.leak_rate / bolted.highest.leak.leak_rate, rel=1e-3
    )
    assert f"{100 * found.share:.0f} % of the leak rate at 20 bar is left" in backing_in_brief(bolted)[-1]


def test_around_the_axis_it_is_told_too():
    """The slow test has it beside a case with that load."""
    found = oval_result().error_shares[-1].earlier_load
    assert found.force == pytest.approx(2.0 * oval_result().highest.contact_force, rel=1e-12)
    assert 0.5 < found.share < 0.9
    assert f"{100 * found.share:.0f} % of the leak rate" in backing_in_brief(oval_result())[-1]


@pytest.mark.slow
def test_around_the_axis_the_scenario_is_that_case_too():
    oval = {"direction": "normal", "harmonics": [{"waves": 2, "amplitude": "1 um"}]}
    one = {"form.seat": oval, "load.fluid_pressure": "20 bar"}
    new = ball.__wrapped__(**one)
    found = new.error_shares[-1].earlier_load
    after = ball.__wrapped__(**one, load__largest_earlier_force=found.force)
    share = after.highest.leak.leak_rate / new.highest.leak.leak_rate
    assert found.share == pytest.approx(share, rel=2e-3)
    # and not that of the round seal
    assert found.share != pytest.approx(ball().error_shares[-1].earlier_load.share, rel=0.02)


@cache
def yielding(earlier_force=None):
    case = fem_seal.load_case(EXAMPLES / "elastoplastic_seat.toml")
    return fem_seal.run(
        case.replace({"load.fluid_pressure": "300 bar", "load.largest_earlier_force": earlier_force})
    )


def test_bodies_that_yield_are_told_that_the_load_matters_but_not_how_much():
    assert yielding().error_shares[-1].earlier_load.share is None
    assert backing_in_brief(yielding())[-1] == (
        "Validity: no earlier load is given; one twice as high (9425 N) would have formed the bodies further, and less "
        "or more than the leak rate at 300 bar is left then (load.largest_earlier_force tells how much)"
    )


@pytest.mark.slow
def test_bodies_that_a_larger_load_has_formed_may_leak_more():
    """A wider contact under less pressure."""
    after = yielding(yielding().error_shares[-1].earlier_load.force)
    assert 1.03 < after.highest.leak.leak_rate / yielding().highest.leak.leak_rate < 1.1
    assert not any("no earlier load" in line for line in backing_in_brief(after))


def test_the_parts_are_sums_of_the_sources():
    shares = ball().error_shares[-1]
    assert shares.parts == pytest.approx({"inputs": 0.0, "theory": 1.0, "doubts": 0.0}, abs=1e-12)
    # of a simulated theory every source of its error is known by name
    assert set(ball().highest.flow_error.parts) == set(shares.of_width)
    mixed = ErrorShares({"hurst": 0.3, "inputs together": 0.1, "gap law": 0.4, "accuracy: long waves": 0.2})
    assert mixed.parts == pytest.approx({"inputs": 0.4, "theory": 0.4, "doubts": 0.2})
    assert ErrorShares().parts == {}


def test_report_and_summary_say_what_backs_the_interval_once(tmp_path):
    result = ball()
    parts, earlier = backing_in_brief(result)
    assert parts == (
        "The interval at 20 bar: inputs as given 0 %, theory against simulation 100 %, mesh and doubts 0 %; not in it, "
        "as no one has measured them: earlier loads, sliding on closing, texture, particles"
    )
    assert earlier.startswith("Validity: no earlier load is given; after one twice as high (2513 N) ")
    assert f"{100 * result.error_shares[-1].earlier_load.share:.0f} % of the leak rate" in earlier
    write_report(result, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    assert page.count(parts) == page.count("no earlier load is given") == 1
    summary = json.loads(write_summary(result, tmp_path / "summary.json").read_text(encoding="utf-8"))
    first, last = summary["error_shares"]
    assert last["parts"] == pytest.approx(result.error_shares[-1].parts) and first["earlier_load"] is None
    assert last["not_measured"] == ["earlier loads", "sliding on closing", "texture", "particles"]
    assert last["earlier_load"] == pytest.approx(vars(result.error_shares[-1].earlier_load))


def test_what_a_case_tells_is_not_said_to_be_missing():
    told = backing_in_brief(ball(load__largest_earlier_force="3 kN"))
    assert len(told) == 1 and "them: sliding on closing, texture, particles" in told[0]
    tested = replace(ball(), loads=tuple(load.with_values(after_test=True) for load in ball().loads))
    assert backing_in_brief(tested)[0].startswith("The interval at 20 bar: what the leak test has left 0 %")
    assert "measured" not in backing_in_brief(tested)[0]
