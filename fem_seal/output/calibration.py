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
from fem_seal.units import format_quantity, leak_range_text, number, percent, quantity, unit_for
from fem_seal.version import __version__
from fem_seal.wording import phrase, template

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


def write_calibration(found: Calibration, folder: Path) -> None:
    """Write all files of a calibration.

    Parameters
    ----------
    found : Calibration
    folder : Path
    """
    # a conflict teaches nothing
    taught, nothing = found.conflict is None, (math.nan,) * 3
    predictions = [
        (*astuple(one)[:2], *one.prior, *(one.posterior if taught else nothing)) for one in found.predictions
    ]
    write_rows_csv(folder / "predictions.csv", PREDICTION_COLUMNS, predictions)
    inputs = [
        (
            one.name,
            *one.prior,
            *((*one.posterior, one.narrowing) if taught else (*nothing, math.nan)),
            one.unit,
        )
        for one in found.inputs
    ]
    write_rows_csv(folder / "inputs.csv", INPUT_COLUMNS, inputs)
    tests = [(*astuple(one), one.narrowing) for one in found.next_tests if taught]
    write_rows_csv(folder / "next_tests.csv", TEST_COLUMNS, tests)
    if found.is_usable:
        _write_case(found, folder)
    write_text(folder / "summary.json", as_json(summary(found)))
    write_text(folder / "report.html", report(found))


def _write_case(found: Calibration, folder: Path) -> None:
    path = found.posterior.write(folder / POSTERIOR)
    changed = found.case.replace({"uncertainty.posterior": str(path.absolute())})
    write_text(
        folder / CASE, case_text(changed.written, folder.absolute(), phrase("calibration.files", "case"))
    )


def summary(found: Calibration) -> dict[str, Any]:
    """What summary.json holds of a calibration.

    Parameters
    ----------
    found : Calibration
    """
    taught = found.conflict is None
    return {
        "title": found.case.title,
        "readings": len(found.readings),
        "p_value": found.p_value,
        "conflict": None
        if found.conflict is None
        else {
            "factor": found.conflict.factor,
            "culprit": found.conflict.likeliest.name,
            "explanations": dict(found.conflict.probabilities),
        },
        "alternatives": dict(found.alternatives) if taught else {},
        "effective_draws": found.effective_draws,
        "learned": {one.name: one.narrowing for one in found.inputs} if taught else {},
        "spread_of_ln_Q": {
            "prior": _spread(found, "prior"),
            "posterior": _spread(found, "posterior") if taught else None,
        },
        "requirement": None if found.solution is None else verdict_numbers(found.solution),
        "next_test": found.next_tests[0].name if found.next_tests and taught else None,
    }


def _spread(found: Calibration, which: str) -> float | None:
    """Standard deviation of ln Q at the last load: a 3.29th of what lies between 5 and 95 %."""
    low, _, high = getattr(found.predictions[-1], which)
    return math.log(high / low) / 3.29 if low > 0.0 else None


def lines(found: Calibration) -> Iterator[str]:
    """What a calibration says, in sentences.

    Parameters
    ----------
    found : Calibration
    """
    if found.conflict is not None:
        yield _conflict(found, found.conflict)
        return
    last = found.predictions[-1]
    yield phrase(
        "calibration.sentences",
        "prediction",
        load=format_quantity("fluid pressure", last.fluid_pressure),
        middle=_median(found, last),
        now=_range(found, last.posterior),
        before=_range(found, last.prior),
    )
    if found.solution is not None:
        yield from verdict_sentences(found.solution)
    if last.prior[0] > 0.0 and last.posterior[0] > 0.0:
        before, after = (three[2] / three[0] for three in (last.prior, last.posterior))
        which, ratio = "narrower" if after < before else "wider", last.posterior[1] / last.prior[1]
        yield phrase("calibration.sentences", which, ratio=ratio, before=before, after=after)
    told, silent = ([one for one in found.inputs if (one.narrowing >= _CLEAR) is it] for it in (True, False))
    if told:
        spoken = (
            phrase(
                "calibration.sentences",
                "factor" if unit == "factor" else "input",
                name=input_name(one.name),
                low=texts[3],
                high=texts[5],
                unit=f" {unit}".replace(" -", ""),
                learned=one.narrowing,
            )
            for one in told
            for unit, texts in [_texts(one)]
        )
        yield phrase("calibration.sentences", "learned", inputs=", ".join(spoken))
    if silent:
        yield phrase(
            "calibration.sentences", "silent", inputs=", ".join(input_name(one.name) for one in silent)
        )
    given, *others = found.alternatives.items()
    for other in others:
        own = ("as given", given[1]) if other[0] == "first loading" else given
        (best, share), (second, less) = sorted((own, other), key=lambda one: -one[1])
        ratio = share / less if less > 0.0 else math.inf
        which = "prefers_clearly" if ratio > 100.0 else "prefers" if ratio > _PREFERRED else "no_preference"
        names = {"best": _alternative(best), "second": _alternative(second)}
        yield phrase("calibration.sentences", which, ratio=ratio, **names)
    if found.next_tests:
        first = found.next_tests[0]
        narrowing = max(first.narrowing, 0.0)
        yield phrase("calibration.sentences", "next", test=test_in_words(first), narrowing=narrowing)
    if not found.is_usable:
        yield phrase("calibration.sentences", "thin", draws=found.effective_draws)


def _conflict(found: Calibration, conflict: Conflict) -> str:
    """That the readings contradict the inputs, and the likeliest explanation with its odds."""
    way, best = "more" if conflict.factor > 1 else "less", conflict.likeliest
    lines = [str(one.line) for one in found.readings]
    names = [phrase("calibration.explanations", one.name) for one in conflict.explanations]
    first, *others = conflict.probabilities.values()
    likeliest = ""
    if others:
        odds = number(first / others[0], 2) if first < _MOST_ODDS * others[0] else f"more than {_MOST_ODDS}"
        values = {"count": len(names), "first": names[0], "second": names[1], "odds": odds}
        likeliest = phrase("calibration.sentences", "likeliest", **values)
    either = best.name in ("factor", "slope")
    culprit = phrase(
        "calibration.culprit",
        f"{best.name}_{'more' if best.size > 1.0 else 'less'}" if either else best.name,
        size=best.size,
        rate=leak_range_text(best.size, 2, volume=volume_of(found.case)) if best.name == "path" else "",
        lines=", ".join(lines[n] for n in best.readings),
        line=lines[conflict.farthest],
    )
    factor = number(max(conflict.factor, 1.0 / conflict.factor), 2)
    values = {"p": found.p_value, "line": lines[conflict.farthest], "factor": factor, "way": way}
    return phrase("calibration.sentences", "conflict", likeliest=likeliest, culprit=culprit, **values)


def _range(found: Calibration, rates: Percentiles) -> str:
    return leak_range_text((rates[0], rates[2]), volume=volume_of(found.case))


def _median(found: Calibration, one: Prediction) -> str:
    _, middle, _ = one.posterior
    return leak_range_text(middle, 2, beside=one.posterior, volume=volume_of(found.case))


def files_line(found: Calibration, folder: Path) -> str:
    """Where the files are.

    Parameters
    ----------
    found : Calibration
    folder : Path
    """
    what = "files" if found.is_usable else "no_case"
    return phrase("calibration.sentences", what, folder=folder, case=folder / CASE)


def _alternative(name: str) -> str:
    return phrase("calibration.alternatives", name.replace(" ", "_"))


def test_in_words(test: NextTest) -> str:
    """A next test: "a leak test with nitrogen at 20 bar".

    Parameters
    ----------
    test : NextTest
    """
    return phrase(
        "calibration.tests",
        test.name,
        fluid=test.fluid,
        pressure=format_quantity("fluid pressure", test.fluid_pressure),
        force=format_quantity("force", test.applied_force),
        earlier=format_quantity("force", test.largest_earlier_force),
    )


def prediction_rows(found: Calibration) -> list[list[str]]:
    """Cells of the table of predictions: pressure, force, before and after.

    Parameters
    ----------
    found : Calibration
    """
    return [
        [
            format_quantity("fluid pressure", one.fluid_pressure),
            format_quantity("force", one.applied_force),
            _range(found, one.prior),
            _range(found, one.posterior) if found.conflict is None else "–",
            _median(found, one) if found.conflict is None else "–",
        ]
        for one in found.predictions
    ]


PREDICTION_HEADINGS = ("fluid pressure", "force", "expected before", "after the test", "median after")


def report(found: Calibration) -> str:
    """The calibration as one HTML page.

    Parameters
    ----------
    found : Calibration
    """
    with style():
        picture = calibration_picture(found)
    readings = [
        [
            str(one.line),
            one.case.fluid.name if one.case.fluid is not None else "",
            format_quantity("fluid pressure", one.fluid_pressure),
            format_quantity("force", one.applied_force),
            ("< " if one.is_below else "") + quantity("flow", one.leak_rate, 3),
            percent(one.uncertainty),
            _range(found, expected),
        ]
        for one, expected in zip(found.readings, found.prior_rates, strict=True)
    ]
    tests = [
        [
            test_in_words(one),
            *(number(x, 3) for x in (one.width, one.expected_width)),
            percent(max(one.narrowing, 0.0)),
        ]
        for one in found.next_tests
        if found.conflict is None
    ]
    return template("calibration.html.j2").render(
        title=found.case.title or "fem-seal",
        version=__version__,
        lines=list(lines(found)),
        picture=picture,
        predictions=prediction_rows(found),
        prediction_headings=PREDICTION_HEADINGS,
        readings=readings,
        inputs=list(map(_input_row, found.inputs)),
        tests=tests,
        farther=percent(found.p_value),
        conflict=found.conflict is not None,
    )


def _texts(one: LearnedInput) -> tuple[str, list[str]]:
    """Unit of an input, and its values before and after the test; of a wavenumber its wavelength."""
    values: list[tuple[float, ...]] = [one.prior, one.posterior]
    unit = one.unit
    if unit == "1/m":
        # the short waves have the large wavenumbers
        values, unit = [tuple(2.0 * math.pi / x for x in reversed(three)) for three in values], "m"
    if unit == "m":
        shown = unit_for("length", values[0][1])
        values, unit = [tuple(shown.of(x) for x in three) for three in values], shown.name
    return unit, [number(x, 3) for three in values for x in three]


def _input_row(one: LearnedInput) -> list[str]:
    unit, texts = _texts(one)
    return [f"{input_name(one.name)} [{unit}]", *texts, percent(max(one.narrowing, 0.0))]


def calibration_picture(found: Calibration) -> Picture:
    """Leak rates over the fluid pressure: bands of what is expected before and after the test, and the readings.

    Loads and readings with the same fluid, force and memory share a band; one that is alone has a bar.
    """
    figure, (axes,) = panels(1, height=3.8)
    rates = [one.leak_rate for one in found.readings] + [one.prior[1] for one in found.predictions]
    unit, pressure = (
        unit_for("flow", float(np.median(rates))),
        unit_for("fluid pressure", max(p.fluid_pressure for p in found.predictions)),
    )
    groups: dict[Any, dict[float, Any]] = {}
    loads = [(found.case, one.applied_force, one) for one in found.predictions]
    readings = [
        (one.case, one.applied_force, Prediction(*one.case.load.points[0], before, after))
        for one, before, after in zip(found.readings, found.prior_rates, found.posterior_rates, strict=True)
    ]
    for case, force, one in (*loads, *readings):
        assert case.fluid is not None
        key = case.fluid.name, format_quantity("force", force), case.load.earlier
        groups.setdefault(key, {})[one.fluid_pressure / pressure.size] = one
    known = (("prior", GREY, "before the test"), ("posterior", BLUE, "after it"))
    for which, colour, name in known if found.conflict is None else known[:1]:
        for (fluid, force, _), group in groups.items():
            p = np.array(sorted(group))
            low, middle, high = (np.array([getattr(group[x], which) for x in p]) / unit.size).T
            told = f"{name}, {fluid}, {force}" if len(groups) > 1 else name
            if len(p) > 1:
                axes.fill_between(p, low, high, color=colour, alpha=0.25, linewidth=0, label=told)
                axes.plot(p, middle, color=colour)
            else:
                bars = np.array([middle - low, high - middle])
                axes.errorbar(p, middle, bars, fmt="o", color=colour, capsize=4, ms=4, label=told)
    for below, marker, name in ((False, "D", "measured"), (True, "_", "measured: less than this")):
        some = [one for one in found.readings if one.is_below is below]
        if some:
            x = [one.fluid_pressure / pressure.size for one in some]
            y = np.array([one.leak_rate for one in some]) / unit.size
            bars = 0.35 * y if below else y * np.array([one.uncertainty for one in some])
            axes.errorbar(x, y, bars, fmt=marker, color=ORANGE, capsize=3, ms=5, uplims=below, label=name)
    names = f"fluid pressure  [{pressure.name}]", f"leak rate  [{unit.name}]"
    label(axes, "Leak rate", *names, log="y", legend="best")
    return captioned(figure, "calibration", "all")
