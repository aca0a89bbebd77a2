"""An answer is added by its two files and its places in two tuples: nothing else has to be touched."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass

import pytest
from sample_results import case, run_loads, smooth_case

from fem_seal.answers import chain
from fem_seal.answers.answer import Answer
from fem_seal.output import answer_outputs
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Section
from fem_seal.output.columns import ReadableTable
from fem_seal.output.pictures.style import Picture, panels, svg
from fem_seal.units import percent

# ---------------------------------------------------------------- as in fem_seal/answers/


@dataclass(frozen=True)
class Indentation:
    """Peak pressure over hardness at one load."""

    fluid_pressure: float
    share: float


def _compute(seal, ask):
    return tuple(
        Indentation(load.fluid_pressure, load.peak_pressure / seal.problem.hardness) for load in seal.loads
    )


INDENTATION = Answer(
    "indentation",
    "share of the hardness",
    _compute,
    (),
    needs=("problem.surface.hardness",),
    status="how near the asperities are to an indentation",
)

# ---------------------------------------------------------------- as in fem_seal/output/answers/


def _rows(result):
    return [(one.fluid_pressure, one.share) for one in INDENTATION.of(result.answers)]


def _picture(result):
    if not _rows(result):
        return None
    figure, (axes,) = panels(1, height=3.0)
    axes.plot(*zip(*_rows(result), strict=True))
    return Picture("indentation", svg(figure), "share over pressure", "Peak pressure over hardness.")


def _section(result):
    if not _rows(result):
        return None
    table = ReadableTable(
        ("load", "share"), tuple((f"{p:g} Pa", percent(share)) for p, share in _rows(result))
    )
    sentence = f"Up to {percent(max(share for _, share in _rows(result)))} of the hardness is used."
    return Section(
        "indentation",
        "How hard the asperities are pressed",
        "Indentation",
        [sentence],
        ("indentation",),
        [(table, "Share of the hardness")],
        ("indentation.csv",),
    )


OUTPUT = AnswerOutput(
    lambda result: result.answers.get("indentation"),
    summary=lambda result: {"indentation": _rows(result)},
    tables={"indentation.csv": lambda result: (("fluid_pressure_Pa", "share_of_hardness"), _rows(result))},
    pictures=lambda result: [_picture(result)],
    page=lambda result, display: AnswerPage(
        section=_section(result),
        details=[f"hardness: {percent(share)}" for _, share in _rows(result)],
    ),
)


@pytest.fixture
def _added(monkeypatch):
    monkeypatch.setattr(chain, "ANSWERS", (*chain.ANSWERS, INDENTATION))
    monkeypatch.setattr(answer_outputs, "OUTPUTS", (*answer_outputs.OUTPUTS, OUTPUT))


@pytest.mark.usefixtures("_added", "unrendered")
def test_an_added_answer_is_in_the_result_and_in_all_its_files(tmp_path):
    result = run_loads(case(load={"fluid_pressure": ["2 bar", "20 bar"]}))
    shares = [load.peak_pressure / 3.5e9 for load in result.loads]
    assert [one.share for one in result.answers["indentation"]] == pytest.approx(shares, rel=1e-12)
    assert result.timings["indentation"] >= 0.0
    result.write(tmp_path, full=True)
    told = json.loads((tmp_path / "summary.json").read_text())["indentation"]
    assert told == [[2e5, pytest.approx(shares[0])], [20e5, pytest.approx(shares[1])]]
    with (tmp_path / "indentation.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["share_of_hardness"]) for row in rows] == pytest.approx(shares, rel=1e-9)
    page = (tmp_path / "report.html").read_text().replace("\xa0", " ")
    assert '<a href="#indentation">Indentation</a>' in page and 'id="picture-indentation"' in page
    assert f"<li>Up to {percent(shares[1])} of the hardness is used.</li>" in page
    assert f"<td>{percent(shares[0])}</td>" in page and "Files: indentation.csv." in page


@pytest.mark.usefixtures("_added", "unrendered")
def test_where_it_does_not_apply_there_is_neither_section_nor_file(tmp_path):
    result = run_loads(smooth_case(load={"fluid_pressure": "20 bar"}))
    assert result.answers["indentation"] == () and "indentation" not in result.timings
    (tmp_path / "indentation.csv").write_text("of an earlier run")
    result.write(tmp_path)
    assert not (tmp_path / "indentation.csv").exists()
    assert "indentation" not in (tmp_path / "report.html").read_text()


def test_an_answer_that_fails_is_a_warning_and_costs_no_other(monkeypatch):
    def failing(seal, ask):
        raise ZeroDivisionError("float division by zero")

    broken = Answer("broken", "what breaks", failing, "nothing")
    monkeypatch.setattr(chain, "ANSWERS", (broken, *chain.ANSWERS))
    result = run_loads(case(load={"fluid_pressure": "20 bar"}))
    assert result.answers["broken"] == "nothing"
    (said,) = [text for text in result.warnings if "could not be calculated" in text]
    assert said.startswith("what breaks: could not be calculated (unexpected ZeroDivisionError")
    assert result.loads[0].leak.leak_rate > 0 and result.loads[0].opening is None
