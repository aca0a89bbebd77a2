"""A planned leak test: its readings against runs of their own, and its table through `calibrate`."""

from __future__ import annotations

import json
import math

import pytest
from places import EXAMPLES

import fem_seal
from fem_seal.answers.testplan import plan_leak_test
from fem_seal.case.measured import read_measured
from fem_seal.cli.app import main
from fem_seal.output.testplan import PROTOCOL, TABLE, lines, write_testplan

BALL = {"leak.theory": "corrected", "load.fluid_pressure": ["10 bar", "20 bar"], "load.applied_force": "1 kN"}


def ball(**changes):
    case = fem_seal.load_case(EXAMPLES / "ball_cone.toml")
    return case.replace({**BALL, **{key.replace("__", "."): value for key, value in changes.items()}})


@pytest.fixture(scope="module")
def plan():
    return plan_leak_test(ball())


def test_each_reading_is_what_a_run_of_its_load_leaks(plan):
    assert [reading.question for reading in plan.readings] == [
        *["new"] * 3,
        *["again"] * 2,
        "held",
        *["pressed"] * 3,
        "gas",
    ]
    new, back = plan.of("new"), plan.of("pressed")
    assert [reading.load.point for reading in new] == [(5e5, 250.0), (1e6, 500.0), (2e6, 1000.0)]
    # twice the force that presses at the largest load, the fluid's included
    assert back[0].largest_earlier_force == pytest.approx(2.0 * new[-1].load.contact_force, rel=1e-12)
    single = ball(load__fluid_pressure="5 bar", load__applied_force="250 N")
    run = fem_seal.run(single.replace({"load.largest_earlier_force": back[0].largest_earlier_force})).loads[0]
    assert back[-1].load.leak.leak_rate == pytest.approx(run.leak.leak_rate, rel=2e-3)
    without = fem_seal.run(single).loads[0]
    assert back[-1].others["first loading"] == pytest.approx(without.leak.leak_rate, rel=2e-3)
    assert new[0].load.leak.leak_rate == pytest.approx(without.leak.leak_rate, rel=2e-3)
    paper = fem_seal.run(single.replace({"leak.theory": "paper"})).loads[0]
    assert new[0].others == pytest.approx({"paper": paper.leak.leak_rate}, rel=2e-3)
    assert "first loading" not in new[0].others and plan.readings[-1].fluid == "nitrogen"


def test_what_leaves_no_trace_or_does_not_clog_is_not_asked(tmp_path):
    found = plan_leak_test(ball(seat__material="steel", leak__plasticity=False, fluid={"name": "nitrogen"}))
    assert found.case.hardness is None
    assert {reading.question for reading in found.readings} == {"new", "again", "gas"}
    assert all(math.isnan(reading.largest_earlier_force) for reading in found.readings)
    assert found.readings[-1].fluid == "helium"
    assert not any("remember" in line for line in lines(found))
    # table and protocol are in the same units
    write_testplan(found, tmp_path, "seal.toml")
    first, row, *_ = (tmp_path / TABLE).read_text(encoding="utf-8").split("\n")
    assert first.startswith("fluid_pressure [bar],applied_force [N],") and ",leak_rate [mbar l/s]," in first
    assert row == "5,250,,nitrogen,,10"
    assert " mbar l/s | " in (tmp_path / PROTOCOL).read_text(encoding="utf-8")


def test_calibrate_says_that_the_table_is_empty_and_reads_it_once_filled(tmp_path, capsys):
    file, folder = tmp_path / "seal.toml", tmp_path / "seal.testplan"
    file.write_text((EXAMPLES / "ball_cone.toml").read_text(encoding="utf-8"), encoding="utf-8")
    assert main(["testplan", str(file), "--json"]) == 0
    planned = json.loads(capsys.readouterr().out)["readings"]
    table = (folder / TABLE).read_text(encoding="utf-8")
    assert main(["calibrate", str(file), str(folder / TABLE)]) == 2
    said = capsys.readouterr().err
    assert "leak_rate: is empty in all 10 rows: nothing is measured yet; fill in" in said
    filled = [
        row.replace(",,10", f",{n + 1},10") if n >= 0 else row
        for n, row in enumerate(table.split("\n"), start=-1)
    ]
    (folder / TABLE).write_text("\n".join(filled), encoding="utf-8")
    readings = read_measured(fem_seal.load_case(file), folder / TABLE)
    assert [one.leak_rate * 6e7 for one in readings] == pytest.approx([*range(1, 11)])
    assert [(one.fluid_pressure, one.case.fluid.name) for one in readings] == [
        (one["fluid_pressure_Pa"], one["fluid"]) for one in planned
    ]
    assert readings[7].case.load.earlier == (0.0, pytest.approx(planned[7]["largest_earlier_force_N"]))
    assert main(["testplan", str(file)]) == 2
    assert f"--output = {folder / TABLE}: leak rates are filled in there" in capsys.readouterr().err
    assert (folder / TABLE).read_text(encoding="utf-8") == "\n".join(filled)
    protocol = (folder / PROTOCOL).read_text(encoding="utf-8")
    assert len(protocol.split("\n")) < 90 and "fem-seal calibrate seal.toml readings.csv" in protocol
    assert all(f"| {n} | {one['fluid']} |" in protocol for n, one in enumerate(planned, start=1))
    assert "| 8 | water | 10 bar | 0 N | 2513 N | after the larger force, load falling |" in protocol


@pytest.mark.parametrize(
    ("example", "says"),
    [("bolted_ring", "bolts: a leak test is compared under known forces"), ("smooth", "no leak rate")],
)
def test_a_case_without_known_forces_or_leak_has_no_test(example, says, capsys, tmp_path):
    assert main(["testplan", str(EXAMPLES / f"{example}.toml"), "-o", str(tmp_path / "plan")]) == 2
    assert says in capsys.readouterr().err
