"""A study calls best only what its theory covers, says how many designs it left out, and why."""

from __future__ import annotations

import csv
import json
import math
from contextlib import closing
from html import escape

import pytest
from places import EXAMPLES

import fem_seal
from fem_seal import InputError, Study
from fem_seal.cli.app import main
from fem_seal.seal.findings import Level
from fem_seal.studies import responses, store
from fem_seal.studies.optimise import _goals_and_violations
from fem_seal.studies.responses import evaluate_design
from fem_seal.studies.session import run_study
from leak import LeakError

CASE = EXAMPLES / "ball_cone.toml"
# A spring of 5 kN leaks least by crushing the seat: von Mises stress 2.3 times its yield stress.
CHANGES = {
    "load.fluid_pressure": "20 bar",
    "seat.material.yield_stress": "100 MPa",
    "roughness.spectrum.rms_height": "0.1 um",
    "roughness.spectrum.q_rolloff": "1e5 1/m",
}
LEAK_RATE = "leak_rate_m3_per_s"


def springs(**tables):
    given = {
        "changes": CHANGES,
        "parameters": {"load.applied_force": ["0 N", "5 kN"]},
        "responses": [LEAK_RATE],
        "report": {"goals": {LEAK_RATE: "min"}},
    }
    return Study(CASE, **{**given, **tables})


@pytest.fixture(scope="module")
def calculated(tmp_path_factory):
    return run_study(springs(), folder=tmp_path_factory.mktemp("springs"), workers=0)


def test_a_spring_that_crushes_the_seat_is_not_the_best(calculated):
    table = calculated.table
    assert table["validity"].tolist() == ["valid", "outside the theory"]
    assert "seat: von Mises stress 2.3" in table["validity_reasons"][1]
    assert 0 < table[LEAK_RATE][1] < 0.1 * table[LEAK_RATE][0]
    assert calculated.best().index.tolist() == [0]
    assert calculated.left_out == 1


def test_the_key_keeps_them(tmp_path):
    result = run_study(springs(outside_theory="keep"), folder=tmp_path, workers=0)
    assert result.best().index.tolist() == [1, 0]
    assert result.left_out == 0
    # they are still called what they are
    assert result.best()["validity"].tolist() == ["outside the theory", "valid"]
    with pytest.raises(InputError, match="outside_theory"):
        springs(outside_theory="ignore")


def test_page_and_exports_tell(calculated, tmp_path):
    page = calculated.report(tmp_path / "report.html").read_text()
    assert "1 design is outside the theory, where no number is stated; the first is design 1: seat:" in page
    assert "1 design is left out because its numbers are outside the theory" in page
    rows = list(csv.DictReader(calculated.export(tmp_path / "t.csv").open()))
    assert [row["validity"] for row in rows] == ["valid", "outside the theory"]
    assert rows[0]["validity_reasons"] == "" and "yield stress" in rows[1]["validity_reasons"]
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(calculated.export(tmp_path / "t.nc")) as data:
        assert data["validity"].values.ravel().tolist() == ["valid", "outside the theory"]


def test_the_command_says_how_many_it_left_out(tmp_path, capsys):
    study = tmp_path / "springs.toml"
    lines = "".join(f'"{key}" = "{value}"\n' for key, value in CHANGES.items())
    study.write_text(
        f'base = "{CASE}"\nresponses = ["{LEAK_RATE}"]\n[changes]\n{lines}'
        f'[parameters]\n"load.applied_force" = ["0 N", "5 kN"]\n[report]\ngoals = {{ {LEAK_RATE} = "min" }}\n'
    )
    assert main(["study", str(study), "--workers", "0"]) == 0
    told = capsys.readouterr().out
    assert "1 design is left out because its numbers are outside the theory" in told
    (line,) = [line for line in told.splitlines() if line.startswith("applied force")]
    assert line.split()[-1] == "0"
    assert main(["study", str(study), "--workers", "0", "--resume", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["left_out"] == 1
    assert [one["validity"] for one in told["best"]] == ["valid"]


@pytest.mark.slow
def test_a_search_does_not_end_outside_the_theory(tmp_path):
    """Pressed harder it always leaks less; the search has to stop where the seat yields."""

    study = springs(
        parameters={"load.applied_force": {"distribution": "log-uniform", "low": "10 N", "high": "8 kN"}},
        optimise={"minimise": LEAK_RATE, "trials": 10, "batch": 5},
        report={},
    )
    result = run_study(study, folder=tmp_path, workers=0)
    best = result.best(1).iloc[0]
    assert best["validity"] != "outside the theory"
    inside = result.table[result.table["validity"] != "outside the theory"]
    assert best[LEAK_RATE] == inside[LEAK_RATE].min()
    assert 0 < result.left_out == (result.table["validity"] == "outside the theory").sum()
    # told to the sampler as a constraint that is violated
    with closing(store.open_to_read(tmp_path / store.FILE)) as file:
        kept = [_goals_and_violations(study, row)[1] for row in file.rows(file.design).values()]
    assert {one["outside the theory"] for one in kept} == {1.0, -1.0}
    assert "outside the theory" in result.report().read_text()


@pytest.mark.slow
def test_a_row_says_what_the_run_says_but_for_the_mesh():
    case = fem_seal.load_case(CASE).replace({**CHANGES, "load.applied_force": "5 kN"})
    quick = evaluate_design(case, [LEAK_RATE]).validity
    (load,) = fem_seal.run(case).loads
    assert quick.level is load.validity.level is Level.OUTSIDE
    complete = load.validity.without_kinds("mesh")
    assert [one.kind for one in quick.cautions] == [one.kind for one in complete.cautions]


def test_a_design_near_opening_says_so():
    """The margin counts in a study as it does in a run."""
    case = fem_seal.load_case(CASE)
    opens = case.initial_contact_radius**2 * math.pi * 20e5
    load = {"load.fluid_pressure": "20 bar", "load.pressure_side": "inner"}
    near, far = (
        evaluate_design(
            case.replace({**load, "load.applied_force": f"{factor * opens} N"}), ["fwhm_m"]
        ).validity
        for factor in (1.02, 2.0)
    )
    assert "near opening" in [one.kind for one in near.cautions]
    assert "near opening" not in [one.kind for one in far.cautions]


def test_strength_counts_although_bodies_are_shared():
    """Seats that differ in their yield stress alone are one body to the solver, and two to the checks."""
    case = fem_seal.load_case(CASE).replace({"load.fluid_pressure": "20 bar"})
    weak, strong = (
        evaluate_design(case.replace({"seat.material.yield_stress": one}), ["peak_pressure_Pa"])
        for one in ("15 MPa", "1 GPa")
    )
    assert weak.values == strong.values
    assert weak.validity.outside_theory and strong.validity.level is Level.VALID


@pytest.mark.slow
def test_the_page_says_why_designs_are_doubtful(tmp_path):
    """A roughness value that is unusual for its process is doubtful at any load."""
    changes = {"load.fluid_pressure": "20 bar", "roughness": "ground Ra 6.4 um"}
    result = run_study(springs(changes=changes), folder=tmp_path, workers=0)
    assert set(result.table["validity"]) == {"doubtful"}
    page = result.report(tmp_path / "report.html").read_text(encoding="utf-8")
    assert "2 designs are doubtful; the first is design 0: " in page
    first = result.table["validity_reasons"][0].split("; ")[0].rstrip(".")
    assert escape(first, quote=False)[:40] in page


def test_a_response_that_fails_costs_no_other_of_its_design(monkeypatch):
    """Where some samples had no conductivity (waves = nan), the design had failed, its peak pressure with it."""

    def fails(seal):
        raise LeakError("waves = nan: must be positive [-]")

    one = fem_seal.load_case(CASE).replace(
        load={"fluid_pressure": "20 bar"}, requirement={"leak_rate": "1 ml/min"}
    )
    monkeypatch.setattr(responses, "pass_probabilities", fails)
    found = evaluate_design(one, ["peak_pressure_Pa", "pass_probability"])
    assert found.values["peak_pressure_Pa"] > 1e6 and math.isnan(found.values["pass_probability"])
    assert any("pass_probability could not be calculated: waves" in why for why in found.validity.reasons)
    with pytest.raises(LeakError):
        evaluate_design(one, ["pass_probability"])
