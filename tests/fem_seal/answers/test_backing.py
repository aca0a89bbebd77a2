"""What backs an interval: its parts by sources, what is in none of them, and a larger load before."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import pytest
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
