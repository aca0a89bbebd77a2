"""The validation page: verdicts on made-up numbers, files that can be read, and a page that is up to date with them."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace

import pytest
import validation
from validation_page import (
    INSIDE,
    NOT_DECIDABLE,
    OUTSIDE,
    Experiment,
    Observed,
    Prediction,
    judged,
    page,
    verdict,
)

import fem_seal
from fem_seal.output.columns import COLUMNS
from fem_seal.studies.expressions import Expression

ALL_FILES = [*validation.files(), validation.FOLDER / validation.TEMPLATE]


def observed(**given):
    return Observed("leak", "leak_rate_m3_per_s_at_1", **given)


# ---------------------------------------------------------------- verdicts


@pytest.mark.parametrize(
    ("low", "high", "word"),
    [
        (1.0, 2.0, INSIDE),  # the same
        (0.5, 5.0, INSIDE),  # holds the measurement
        (1.2, 1.4, INSIDE),  # is held by it
        (0.1, 1.0, INSIDE),  # touches
        (2.0, 9.0, INSIDE),
        (0.1, 0.999, OUTSIDE),
        (2.001, 9.0, OUTSIDE),
        (0.0, 0.0, OUTSIDE),
    ],
)
def test_inside_is_what_overlaps(low, high, word):
    assert verdict(observed(low=1.0, high=2.0), Prediction(low, high))[0] == word


def test_outside_says_by_how_much():
    measured = observed(low=1.0, high=2.0)
    assert "a factor 3 too large" in verdict(measured, Prediction(6.0, 9.0))[1]
    assert "a factor 4 too small" in verdict(measured, Prediction(0.1, 0.25))[1]
    # of a seal that is predicted tight and leaks no factor can be given
    assert verdict(measured, Prediction(0.0, 0.0)) == (
        OUTSIDE,
        "the most that is predicted is by any factor too small",
    )


def test_a_wide_prediction_is_said_to_say_little():
    measured = observed(low=1.0, high=2.0)
    assert "says little" not in verdict(measured, Prediction(0.5, 4.9))[1]
    assert "spans a factor 100 and says little" in verdict(measured, Prediction(0.1, 10.0))[1]
    assert "down to zero and says little" in verdict(measured, Prediction(0.0, 10.0))[1]


def test_what_is_missing_or_refused_is_not_decidable_whatever_is_predicted():
    nowhere = observed(missing="the report has no number")
    assert verdict(nowhere, Prediction(1.0, 2.0)) == (NOT_DECIDABLE, "the report has no number")
    measured = observed(low=1.0, high=2.0)
    assert verdict(measured, Prediction(1.0, 2.0, "outside the theory")) == (
        NOT_DECIDABLE,
        "outside the theory",
    )
    for none in (Prediction(None, None), Prediction(math.nan, math.nan)):
        assert verdict(measured, none)[0] == NOT_DECIDABLE
    # a theory is not judged by numbers that are its own
    by_paper = observed(low=1.0, high=2.0, known_by="paper")
    assert verdict(by_paper, Prediction(1.0, 2.0), "paper")[0] == NOT_DECIDABLE
    assert verdict(by_paper, Prediction(1.0, 2.0), "corrected")[0] == INSIDE
    # what the report lacks comes first
    assert verdict(nowhere, Prediction(None, None, "refused"))[1] == "the report has no number"


@pytest.mark.parametrize(
    "given", [{}, {"low": 1.0}, {"low": 1.0, "high": 2.0, "missing": "x"}, {"low": 2.0, "high": 1.0}]
)
def test_an_observation_has_a_number_or_a_reason(given):
    with pytest.raises(ValueError, match=r"missing|lies above"):
        observed(**given)
    with pytest.raises(ValueError, match="give the value"):
        Observed("leak", low=1.0, high=2.0)


# ---------------------------------------------------------------- predictions


def experiment(**changed):
    tables = {
        "experiment": {"title": "t", "source": "s", "reported": "r", "not_reported": "n"},
        "scenarios": [{"a.b": [1, 2], "c": [3, 4]}, {"c": 5}],
        "observed": [{"what": "w", "value": "sealing_pressure_Pa", "low": 1.0, "high": 2.0}],
        "case": {},
    }
    return Experiment.of("t.toml", {**tables, **changed})


def test_corners_are_all_combinations_within_a_table():
    assert experiment().corners() == [
        {"a.b": 1, "c": 3},
        {"a.b": 1, "c": 4},
        {"a.b": 2, "c": 3},
        {"a.b": 2, "c": 4},
        {"c": 5},
    ]
    assert experiment(scenarios=[]).corners() == [{}]
    assert experiment(scenarios=[{"a": ["none", 1]}]).corners() == [{"a": None}, {"a": 1}]


def test_a_prediction_is_the_envelope_of_corners_and_readings(monkeypatch):
    given = iter([{"x": 3.0}, {"x": 7.0}, {"x": 2.0}, {"x": 4.0}])
    monkeypatch.setattr(validation, "Case", lambda **tables: type("C", (), {"replace": lambda s, c: s})())
    monkeypatch.setattr(validation, "_numbers", lambda *of: ([next(given), next(given)], ""))
    one = {"what": "w", "value": "2 * x", "low": 1.0, "high": 2.0}
    (found,) = validation.predict(experiment(scenarios=[{"a": [1, 2]}], observed=[one]), "paper")
    assert found == Prediction(4.0, 14.0)


def test_a_corner_outside_the_theory_refuses_the_prediction(monkeypatch):
    told = iter(["", "the seat yields", ""])
    monkeypatch.setattr(validation, "Case", lambda **tables: type("C", (), {"replace": lambda s, c: s})())
    monkeypatch.setattr(validation, "_numbers", lambda *of: ([{"x": 1.0}], next(told)))
    one = {"what": "w", "value": "x", "low": 1.0, "high": 2.0}
    (found,) = validation.predict(experiment(scenarios=[{"a": [1, 2, 3]}], observed=[one]), "paper")
    assert found.refused == "outside the theory with a = 2: the seat yields"
    assert verdict(observed(low=1.0, high=2.0), found)[0] == NOT_DECIDABLE


def test_a_number_that_one_corner_has_not_is_none(monkeypatch):
    given = iter([{"x": 1.0}, {"x": math.nan}])
    monkeypatch.setattr(validation, "Case", lambda **tables: type("C", (), {"replace": lambda s, c: s})())
    monkeypatch.setattr(validation, "_numbers", lambda *of: ([next(given)], ""))
    one = {"what": "w", "value": "x", "low": 1.0, "high": 2.0}
    (found,) = validation.predict(experiment(scenarios=[{"a": [1, 2]}], observed=[one]), "paper")
    assert (found.low, found.high) == (None, None)


def test_the_papers_seat_with_both_histories():
    """A line of the curve is the envelope of its corners; the larger load before leaves less leakage in all of them."""
    found = validation.read(validation.FOLDER / "fischer_2020_sandblasted_seat.toml")
    new, pressed, papers = found.curve.lines
    assert (
        len(found.corners_of(new)) == len(found.corners_of(pressed)) == 6
        and len(found.corners_of(papers)) == 3
    )
    stored = validation.stored()[found.name]["curve"]
    assert all(high < low for (low, _), (_, high) in zip(stored[0], stored[1], strict=True))
    short = replace(found.curve, fluid_pressure=("20 bar",), lines=(pressed,))
    corners = found.scenarios[1:2]
    (((low, high),),) = validation.curve(replace(found, curve=short, scenarios=corners))
    case = fem_seal.Case(**found.case).replace(
        {**found.corners_of(pressed)[2], "load.fluid_pressure": "20 bar"}
    )
    rate = fem_seal.run(case.replace({"load.applied_force": "0 N"})).loads[0].leak.leak_rate
    assert low <= rate <= high and stored[1][-1][0] <= low <= high <= stored[1][-1][1]


def test_each_reading_has_its_own_leak_rate():
    """Of one load: the numbers are those of the columns of both readings, and a ratio is taken within each."""
    tables = tomllib.loads((validation.FOLDER / validation.TEMPLATE).read_text(encoding="utf-8"))["case"]
    case = fem_seal.Case(**tables).replace({"load.fluid_pressure": "20 bar", "leak.theory": "paper"})
    names = ("leak_rate_m3_per_s_at_1", "leak_rate_elastic_m3_per_s_at_1")
    both, refused = validation._numbers(case, [Expression(name) for name in names], False)
    row = validation.evaluate_design(
        case, ["leak_rate_conserved_m3_per_s", "leak_rate_capped_m3_per_s"], interpolate=False
    )
    assert refused == ""
    assert [one[names[0]] for one in both] == pytest.approx(list(row.values.values()), rel=1e-12)
    assert both[0][names[0]] < both[1][names[0]] < both[0][names[1]] == both[1][names[1]]
    only, _ = validation._numbers(case.replace({"leak.theory": "corrected"}), [Expression(names[0])], False)
    assert len(only) == 1 and both[0][names[0]] < only[0][names[0]] < both[1][names[0]]


# ---------------------------------------------------------------- the files and the page


@pytest.mark.parametrize("path", ALL_FILES, ids=lambda path: path.name)
def test_every_file_asks_for_what_there_is(path):
    found = validation.read(path)
    assert found.observed and found.source and found.reported and found.not_reported
    loads = 0
    for corner in found.corners():
        loads = len(fem_seal.Case(**found.case).replace(corner).load.points)
    for one in found.observed:
        for name in Expression(one.value).names if one.value else ():
            column, _, number = name.rpartition("_at_")
            if found.surface_only:
                assert name in ("sealing_pressure_Pa", "hardness_Pa", "yield_stress_Pa")
            else:
                assert column in COLUMNS and 1 <= int(number) <= loads


def test_the_page_is_up_to_date_with_its_files():
    """What was predicted belongs to the files as they are, and the page to both."""
    known = validation.stored()
    assert {name: entry["sha256"] for name, entry in known.items()} == {
        path.name: validation.digest(path) for path in validation.files()
    }, "run python docs/validation/validation.py"
    assert validation.FILE.read_text(encoding="utf-8") == validation.rendered(known)


def test_stored_predictions_are_those_of_this_version():
    """Of the files that need no contact: where they differ, docs/validation/validation.py --all is to be run again."""
    known = validation.stored()
    quick = [found for path in validation.files() if (found := validation.read(path)).surface_only]
    assert len(quick) >= 2
    for found in quick:
        for theory, stored in known[found.name]["predictions"].items():
            for one, entry in zip(validation.predict(found, theory), stored, strict=True):
                if entry["low"] is None:
                    assert one.low is None
                    continue
                assert (one.low, one.high) == pytest.approx((entry["low"], entry["high"]), rel=1e-3)


def test_turned_faces_have_one_theory_of_their_own():
    face = {"process": "turned", "feed": "50 um", "nose_radius": "0.2 mm"}
    found = experiment(
        case={"roughness": {"seat": face, "closure": "lapped Ra 0.1 um"}},
        observed=[{"what": "one", "value": "x", "low": 1.0, "high": 2.0}],
    )
    assert experiment().theories == ("corrected", "paper") and found.theories == ("turned",)
    text = page([found], {"t.toml": {"turned": [Prediction(0.0, 1.5)]}})
    assert "| one | 1 to 2 | crests of turned faces | 0 to 1.5 | **inside** |" in text
    assert "paper's theory |" not in text


def test_the_turned_flange_seals_across_its_grooves_and_leaks_along_them():
    """At 50 MPa in the corner of a coarse groove, fine roughness and annealed copper; nothing is fitted to it."""
    found = validation.read(validation.FOLDER / "matsuzaki_2006_turned_flange.toml")
    share, radial = found.observed[:2]
    (corner,) = [
        one
        for one in found.corners()
        if {"0.2 mm", "0.2 um"} <= {value for value in one.values() if isinstance(value, str)}
        and one["closure.material"]["hardness"] == "0.5 GPa"
    ]
    case = fem_seal.Case(**found.case).replace(corner)
    # the depth of the groove is that of the corner
    (face,) = case.roughness.turned_faces.values()
    texture = face.texture()
    assert texture.crest_height == pytest.approx(10e-6, rel=1e-9)
    values = [Expression(one.value) for one in (share, radial)]
    ((numbers,), refused) = validation._numbers(case, values, False)
    across, total = numbers["leak_rate_crests_m3_per_s_at_2"], numbers["leak_rate_m3_per_s_at_2"]
    assert refused == "" and across < radial.high < total and across < share.high * total


def test_the_page_has_every_verdict():
    found = experiment(
        observed=[
            {"what": "one", "value": "x", "low": 1.0, "high": 2.0},
            {"what": "two", "value": "x", "low": 1.0, "high": 2.0, "taken": "as it stood"},
            {"what": "three", "value": "x", "missing": "no number"},
        ]
    )
    paper = [Prediction(1.0, 1.5), Prediction(3.0, 4.0), Prediction(5.0, 5.0)]
    corrected = [Prediction(1.0, 1.5), Prediction(1.5, 4.0), Prediction(6.0, 6.0)]
    text = page([found], {"t.toml": {"paper": paper, "corrected": corrected}})
    decided, below = text.split("## Measured, but not decidable")
    assert "| **[t](#t)** | | | | | |" in decided and "### t" in below
    assert "| one | 1 to 2 | paper's theory | 1 to 1.5 | **inside** |" in decided
    assert "| two | 1 to 2 | paper's theory | 3 to 4 | **outside** |" in decided
    assert "| two | 1 to 2 | corrected theory | 1.5 to 4 | **inside** |" in decided
    assert "three" not in decided
    assert "- [t](#t), three: no number. Predicted: corrected theory 6, paper's theory 5." in below
    assert "- two: as it stood." in below


def test_the_pictures_show_what_is_decided(tmp_path):
    known = validation.stored()
    rows = judged([validation.read(path) for path in validation.files()], validation._predictions(known))
    validation.draw_verdicts(rows, tmp_path / "bars.svg")
    drawn = (tmp_path / "bars.svg").read_text(encoding="utf-8")
    decided = [row for row in rows if row.word != NOT_DECIDABLE]
    assert [drawn.count(f">{word}<") for word in (INSIDE, OUTSIDE)] == [
        sum(row.word == word for row in decided) for word in (INSIDE, OUTSIDE)
    ]
    assert len(decided) > 10
