"""A calibration as files: predictions, inputs, next tests, draws, a case file that has them, report."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import astuple
from pathlib import Path
from typing import Any

import numpy as np

from fem_seal.answers.calibration import Calibration, LearnedInput, NextTest, Percentiles, Prediction
from fem_seal.answers.conflict import Conflict
from fem_seal.answers.leakage_class import volume_of
from fem_seal.case.case import case_text
from fem_seal.files import as_json, write_text
from fem_seal.output.answers.error_shares import input_name
from fem_seal.output.answers.verdict import verdict_numbers, verdict_sentences
from fem_seal.output.pictures.colours import BLUE, GREY, ORANGE
from fem_seal.output.pictures.style import Picture, captioned, label, panels, style
from fem_seal.output.tables import write_rows_csv
from fem_seal.units import Display, number, percent
from fem_seal.version import __version__
from fem_seal.wording import say, say_all, template

POSTERIOR, CASE = "posterior.csv", "calibrated.toml"
PREDICTION_COLUMNS = (
    "fluid_pressure_Pa",
    "applied_force_N",
    *(f"{when}leak_rate_{share}_m3_per_s" for when in ("prior_", "") for share in ("p05", "p50", "p95")),
)
INPUT_COLUMNS = ("input", "prior_p05", "prior_p50", "prior_p95", "p05", "p50", "p95", "learned", "unit")
TEST_COLUMNS = (
    "test",
    "fluid",
    "fluid_pressure_Pa",
    "applied_force_N",
    "largest_earlier_force_N",
    "width",
    "expected_width",
    "narrowing",
)
# An input of whose width less than this has gone is one that the readings say little about, and a theory that is this
# many times as likely as another is preferred.
_CLEAR, _PREFERRED = 0.1, 3.0
# Odds beyond which their number says no more.
_MOST_ODDS = 1000


def write_calibration(calibration: Calibration, folder: Path) -> None:
    """Write all files of a calibration.

    Parameters
    ----------
    calibration : Calibration
    folder : Path
    """
    # a conflict teaches nothing
    taught, nothing = calibration.conflict is None, (math.nan,) * 3
    predictions = [
        (*astuple(prediction)[:2], *prediction.prior, *(prediction.posterior if taught else nothing))
        for prediction in calibration.predictions
    ]
    write_rows_csv(folder / "predictions.csv", PREDICTION_COLUMNS, predictions)
    inputs = [
        (
            learned_input.name,
            *learned_input.prior,
            *((*learned_input.posterior, learned_input.narrowing) if taught else (*nothing, math.nan)),
            learned_input.unit,
        )
        for learned_input in calibration.inputs
    ]
    write_rows_csv(folder / "inputs.csv", INPUT_COLUMNS, inputs)
    tests = [(*astuple(test), test.narrowing) for test in calibration.next_tests if taught]
    write_rows_csv(folder / "next_tests.csv", TEST_COLUMNS, tests)
    if calibration.is_usable:
        _write_case(calibration, folder)
    write_text(folder / "summary.json", as_json(summary(calibration)))
    write_text(folder / "report.html", report(calibration))


def _write_case(calibration: Calibration, folder: Path) -> None:
    display = calibration.case.display
    path = calibration.posterior.write(folder / POSTERIOR)
    changed = calibration.case.replace({"uncertainty.posterior": str(path.absolute())})
    write_text(
        folder / CASE,
        case_text(changed.written, folder.absolute(), say(display, "calibration", "files_case")),
    )


def summary(calibration: Calibration) -> dict[str, Any]:
    """What summary.json holds of a calibration.

    Parameters
    ----------
    calibration : Calibration
    """
    taught = calibration.conflict is None
    return {
        "title": calibration.case.title,
        "readings": len(calibration.readings),
        "p_value": calibration.p_value,
        "conflict": None
        if calibration.conflict is None
        else {
            "factor": calibration.conflict.factor,
            "culprit": calibration.conflict.likeliest.name,
            "explanations": dict(calibration.conflict.probabilities),
        },
        "alternatives": dict(calibration.alternatives) if taught else {},
        "effective_draws": calibration.effective_draws,
        "learned": {entry.name: entry.narrowing for entry in calibration.inputs} if taught else {},
        "spread_of_ln_Q": {
            "prior": _spread(calibration, "prior"),
            "posterior": _spread(calibration, "posterior") if taught else None,
        },
        "requirement": None if calibration.solution is None else verdict_numbers(calibration.solution),
        "next_test": calibration.next_tests[0].name if calibration.next_tests and taught else None,
    }


def _spread(calibration: Calibration, which: str) -> float | None:
    """Standard deviation of ln Q at the last load: a 3.29th of what lies between 5 and 95 %."""
    low, _, high = getattr(calibration.predictions[-1], which)
    return math.log(high / low) / 3.29 if low > 0.0 else None


def lines(calibration: Calibration) -> Iterator[str]:
    """What a calibration says, in sentences.

    Parameters
    ----------
    calibration : Calibration
    """
    display, case = calibration.case.display, calibration.case
    if calibration.conflict is not None:
        yield _conflict(calibration, calibration.conflict)
        return
    last, volume = calibration.predictions[-1], volume_of(case)
    yield say(display, "calibration", "sentences_prediction", last=last, volume=volume)
    if calibration.solution is not None:
        yield from verdict_sentences(calibration.solution)
    inputs = [
        (input_name(entry.name), entry.narrowing, *_texts(display, entry)) for entry in calibration.inputs
    ]
    given, *others = calibration.alternatives.items()
    pairs = [
        sorted(
            (("as given", given[1]) if other[0] == "first loading" else given, other),
            key=lambda pair: -pair[1],
        )
        for other in others
    ]
    yield from say_all(
        display,
        "calibration",
        "sentences_learned",
        last=last,
        learned=[entry for entry in inputs if entry[1] >= _CLEAR],
        silent=[entry[0] for entry in inputs if not entry[1] >= _CLEAR],
        pairs=pairs,
        preferred=_PREFERRED,
    )
    for test in calibration.next_tests[:1]:
        words = test_in_words(display, test)
        yield say(display, "calibration", "sentences_next", test=words, narrowing=max(test.narrowing, 0.0))
    if not calibration.is_usable:
        yield say(display, "calibration", "sentences_thin", draws=calibration.effective_draws)


def _conflict(calibration: Calibration, conflict: Conflict) -> str:
    """That the readings contradict the inputs, and the likeliest explanation with its odds."""
    first, *others = conflict.probabilities.values()
    return say(
        calibration.case.display,
        "calibration",
        "sentences_conflict",
        conflict=conflict,
        p=calibration.p_value,
        lines=[reading.line for reading in calibration.readings],
        odds=min(first / others[0] if others[0] else math.inf, _MOST_ODDS) if others else None,
        most_odds=_MOST_ODDS,
        volume=volume_of(calibration.case),
    )


def _range(calibration: Calibration, rates: Percentiles) -> str:
    return calibration.case.display.leak_range((rates[0], rates[2]), volume=volume_of(calibration.case))


def _median(calibration: Calibration, prediction: Prediction) -> str:
    display = calibration.case.display
    _, middle, _ = prediction.posterior
    return display.leak_range(middle, 2, beside=prediction.posterior, volume=volume_of(calibration.case))


def files_line(calibration: Calibration, folder: Path) -> str:
    """Where the files are.

    Parameters
    ----------
    calibration : Calibration
    folder : Path
    """
    values = {"folder": folder, "case": folder / CASE if calibration.is_usable else None}
    return say(calibration.case.display, "calibration", "sentences_files", **values)


def test_in_words(display: Display, test: NextTest) -> str:
    """A next test: "a leak test with nitrogen at 20 bar".

    Parameters
    ----------
    display : Display
    test : NextTest
    """
    return say(display, "calibration", f"tests_{test.name}", test=test)


def prediction_rows(calibration: Calibration) -> list[list[str]]:
    """Cells of the table of predictions: pressure, force, before and after.

    Parameters
    ----------
    calibration : Calibration
    """
    return [
        [
            calibration.case.display.quantity(prediction.fluid_pressure, "given fluid pressure"),
            calibration.case.display.quantity(prediction.applied_force, "given force"),
            _range(calibration, prediction.prior),
            _range(calibration, prediction.posterior) if calibration.conflict is None else "–",
            _median(calibration, prediction) if calibration.conflict is None else "–",
        ]
        for prediction in calibration.predictions
    ]


PREDICTION_HEADINGS = ("fluid pressure", "force", "expected before", "after the test", "median after")


def report(calibration: Calibration) -> str:
    """The calibration as one HTML page.

    Parameters
    ----------
    calibration : Calibration
    """
    display = calibration.case.display
    with style():
        picture = calibration_picture(calibration)
    tests = () if calibration.conflict is not None else calibration.next_tests
    return template(display, "calibration.html.j2").render(
        title=calibration.case.title or "fem-seal",
        version=__version__,
        lines=list(lines(calibration)),
        picture=picture,
        predictions=prediction_rows(calibration),
        prediction_headings=PREDICTION_HEADINGS,
        readings=zip(calibration.readings, calibration.prior_rates, strict=True),
        volume=volume_of(calibration.case),
        inputs=[_input_row(display, learned_input) for learned_input in calibration.inputs],
        tests=[(test_in_words(display, test), test) for test in tests],
        calibration=calibration,
    )


def _texts(display: Display, learned_input: LearnedInput) -> tuple[str, list[str]]:
    """Unit of an input, and its values before and after the test; of a wavenumber its wavelength."""
    values: list[tuple[float, ...]] = [learned_input.prior, learned_input.posterior]
    unit = learned_input.unit
    if unit == "1/m":
        # the short waves have the large wavenumbers
        values, unit = [tuple(2.0 * math.pi / x for x in reversed(three)) for three in values], "m"
    if unit == "m":
        length = display.unit_for("length", values[0][1])
        values, unit = [tuple(length.of(x) for x in three) for three in values], length.name
    return unit, [number(x, 3) for three in values for x in three]


def _input_row(display: Display, learned_input: LearnedInput) -> list[str]:
    unit, texts = _texts(display, learned_input)
    return [f"{input_name(learned_input.name)} [{unit}]", *texts, percent(max(learned_input.narrowing, 0.0))]


def calibration_picture(calibration: Calibration) -> Picture:
    """Leak rates over the fluid pressure: bands of what is expected before and after the test, and the readings.

    Loads and readings with the same fluid, force and memory share a band; one that is alone has a bar.
    """
    display = calibration.case.display
    figure, (axes,) = panels(1, height=3.8)
    rates = [reading.leak_rate for reading in calibration.readings] + [
        reading.prior[1] for reading in calibration.predictions
    ]
    unit = display.unit_for("flow", float(np.median(rates)))
    pressure = display.unit_for("fluid pressure", max(p.fluid_pressure for p in calibration.predictions))
    groups: dict[Any, dict[float, Any]] = {}
    loads = [(calibration.case, load.applied_force, load) for load in calibration.predictions]
    readings = [
        (reading.case, reading.applied_force, Prediction(*reading.case.load.points[0], before, after))
        for reading, before, after in zip(
            calibration.readings, calibration.prior_rates, calibration.posterior_rates, strict=True
        )
    ]
    for case, force, expected in (*loads, *readings):
        assert case.fluid is not None
        key = case.fluid.name, display.quantity(force, "given force"), case.load.earlier
        groups.setdefault(key, {})[expected.fluid_pressure / pressure.size] = expected
    bands = (("prior", GREY, "before the test"), ("posterior", BLUE, "after it"))
    for which, colour, name in bands if calibration.conflict is None else bands[:1]:
        for (fluid, force, _), group in groups.items():
            p = np.array(sorted(group))
            low, middle, high = (np.array([getattr(group[x], which) for x in p]) / unit.size).T
            label_text = f"{name}, {fluid}, {force}" if len(groups) > 1 else name
            if len(p) > 1:
                axes.fill_between(p, low, high, color=colour, alpha=0.25, linewidth=0, label=label_text)
                axes.plot(p, middle, color=colour)
            else:
                bars = np.array([middle - low, high - middle])
                axes.errorbar(p, middle, bars, fmt="o", color=colour, capsize=4, ms=4, label=label_text)
    for below, marker, name in ((False, "D", "measured"), (True, "_", "measured: less than this")):
        some = [reading for reading in calibration.readings if reading.is_below is below]
        if some:
            x = [reading.fluid_pressure / pressure.size for reading in some]
            y = np.array([reading.leak_rate for reading in some]) / unit.size
            bars = 0.35 * y if below else y * np.array([reading.uncertainty for reading in some])
            axes.errorbar(x, y, bars, fmt=marker, color=ORANGE, capsize=3, ms=5, uplims=below, label=name)
    names = f"fluid pressure  [{pressure.name}]", f"leak rate  [{unit.name}]"
    label(axes, "Leak rate", *names, log="y", legend="best")
    return captioned(display, figure, "calibration", "all")
