"""What makes the interval of the leak rate wide, and what to measure to narrow it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from operator import itemgetter
from typing import Any

from fem_seal.answers.error_shares import ErrorShares
from fem_seal.answers.measurements import LEAK_TEST, Measurement, instruments, line_scans
from fem_seal.answers.solution import SealSolution
from fem_seal.output.answer_output import (
    AnswerOutput,
    AnswerPage,
    Tile,
    decisive,
    prose,
    worded_section,
    worded_table,
)
from fem_seal.output.columns import ReadableTable
from fem_seal.seal.load_result import highest_load, load_name
from fem_seal.units import format_digits, percent
from fem_seal.wording import fill, say

# Sources of error are named from this factor of the interval on; their largest number, and smallest share.
_NARROW, _NAMED, _LEAST = 1.25, 4, 0.01
# A measurement that narrows the interval by a smaller factor is not named; largest number of instruments.
_NARROWER, _INSTRUMENTS = 1.1, 2


def input_name(name: str) -> str:
    """An uncertain input in words; one of several measured spectra is called by its key.

    Parameters
    ----------
    name : str
    """
    names: dict[str, str] = prose()["sources_of_error"]
    if name in names or name.startswith("accuracy: "):
        return names.get(name, name.removeprefix("accuracy: "))
    key = name.removeprefix("scan_length_")
    return f"{names['scan_length']} ({key})" if key != name else f"{name} between scans"


def shares_in_brief(result: SealSolution, number: int) -> str:
    """Shares of the width of the interval of a load; empty where it is narrow.

    Parameters
    ----------
    result : SealSolution
    number : int
        Of the load.
    """
    display = result.display
    sources = _of_load(result, number)
    if sources is None or sources.factor < _NARROW or len(sources.of_width) < 2:
        return ""
    shares = {
        input_name(name): share for name, share in [*sources.of_width.items()][:_NAMED] if share >= _LEAST
    }
    at = load_name(result.loads[number], result.loads, display)
    return say(display, "error_shares", "interval_shares", load=at, factor=sources.factor, shares=shares)


def largest_share(result: SealSolution, number: int) -> tuple[str, str] | None:
    """The largest source of error of a load with its share of the interval; None where the interval is narrow.

    Parameters
    ----------
    result : SealSolution
    number : int
        Of the load.
    """
    sources = _of_load(result, number)
    if sources is None or sources.factor < _NARROW or not sources.of_width:
        return None
    name, share = next(iter(sources.of_width.items()))
    return input_name(name), percent(share, 1)


def measurement_in_brief(result: SealSolution, number: int) -> str:
    """The measurement that narrows the interval of a load most; empty without one.

    Parameters
    ----------
    result : SealSolution
    number : int
        Of the load.
    """
    display, sources = result.display, _of_load(result, number)
    worth = [] if sources is None else [*_measurements_worth_it(result, sources)]
    if not worth or sources is None:
        return ""
    what, left = min(worth, key=itemgetter(1))
    at = load_name(result.loads[number], result.loads, display)
    return say(display, "error_shares", "interval_measure", what=what, left=left, now=sources.factor, at=at)


def backing_in_brief(result: SealSolution) -> list[str]:
    """What the interval of the highest load is made of and what it leaves out, and what a larger load before would do.

    Parameters
    ----------
    result : SealSolution
    """
    load, display = result.highest, result.display
    if not load.has_interval or load.validity.outside_theory:
        return []
    sources = _of_load(result, result.loads.index(load))
    given = {"at": load_name(load, result.loads, display), "tested": load.after_test}
    parts = {} if sources is None else sources.parts
    left_out = _not_measured(result)
    lines = [
        *filter(None, [say(display, "error_shares", "backing", parts=parts, left_out=left_out, **given)])
    ]
    if sources is not None and sources.earlier_load is not None:
        given |= {"earlier": sources.earlier_load, "bolted": result.case.bolts is not None}
        lines.append(say(display, "error_shares", "backing_earlier", **given))
    return lines


def _not_measured(result: SealSolution) -> list[str]:
    """What changes leak rates and is in no interval, as far as the case says nothing of it."""
    case, names = result.case, ["sliding on closing", "texture"]
    names += ["particles"] * (case.fluid is None or case.fluid.particles is None)
    return ["earlier loads"] * (case.load.earlier is None) + names


def _of_load(result: SealSolution, number: int) -> ErrorShares | None:
    return result.error_shares[number] if number < len(result.error_shares) else None


def _measurements_worth_it(result: SealSolution, sources: ErrorShares) -> Iterator[tuple[str, float]]:
    """Measurements that are worth it with the factor that each leaves: profiles of a finish first, a leak test last."""
    display = result.display
    worth = [
        method for method in sources.measurements if method.left and method.left * _NARROWER <= sources.factor
    ]
    best: dict[str, Measurement] = {}
    for measurement in worth:
        best.setdefault(measurement.instrument, measurement)
    profiles, test = sources.by_profiles, best.pop(LEAK_TEST, None)
    if profiles is not None:
        best.pop("line_scan", None)
        if profiles.left * _NARROWER <= sources.factor:
            yield say(display, "error_shares", "measurement_profiles", profiles=profiles), profiles.left
    for measurement in list(best.values())[: _INSTRUMENTS - (profiles is not None)]:
        words = _words(result, measurement)
        yield say(display, "error_shares", "measurement_input", **words), float(measurement.left or 0.0)
    # that at a lower load says more than it seems to
    tests = [measurement for measurement in worth if measurement.instrument == LEAK_TEST]
    if test is not None:
        test = min(tests, key=lambda measurement: result.loads[measurement.at or 0].point)
        words = _words(result, test)
        yield say(display, "error_shares", "measurement_leak_test", **words), float(test.left or 0.0)


def _words(result: SealSolution, measurement: Measurement) -> dict[str, str]:
    """A measurement in words: what, with which instrument, how well, and who says so."""
    table = instruments()[measurement.instrument]
    scan = None if result.case.roughness is None else line_scans(result.case.roughness)
    length = {} if scan is None else {"length": scan.length}
    at = None if measurement.at is None else result.loads[measurement.at]
    load = "" if at is None else load_name(at, result.loads, result.display)
    accurate = {input_name(name): percent(value, 1) for name, value in measurement.accuracy.items()}
    first, *others = [f"{name} to {accuracy}" for name, accuracy in accurate.items()]
    return {
        "load": load,
        "what": ", ".join(accurate) + (f" at {load}" if load else ""),
        "measured": " and ".join([first.replace(" to ", " measured to "), *others]),
        "instrument": fill(result.display, table["instrument"], **length),
        "accuracy": ", ".join(accurate.values()),
        "source": table["source"],
        "after": "cannot be told" if measurement.left is None else format_digits(measurement.left, 2),
    }


def measurement_table(result: SealSolution) -> ReadableTable:
    """What can be measured and the factor from end to end of the highest load then; no rows without uncertain inputs.

    Parameters
    ----------
    result : SealSolution
    """
    sources = _of_load(result, highest_load(result.loads))
    rows = [] if sources is None else [_words(result, measurement) for measurement in sources.measurements]
    now = "" if sources is None else format_digits(sources.factor, 2)
    return worded_table(result.display, "measurements", rows, now=now)


def _page(result: SealSolution) -> AnswerPage:
    load = decisive(result)
    number = result.loads.index(load)
    decides = [*filter(None, (shares_in_brief(result, number), measurement_in_brief(result, number)))]
    tiles = [
        Tile("Main uncertainty", share, f"{name}, share of the interval", 35, load.validity.level)
        for name, share in filter(None, [largest_share(result, number)])
    ]
    section = worded_section(result.display, "measurements", (), measurement_table(result))
    return AnswerPage(tiles=tiles, decides=decides, section=section, details=decides)


def _summary(result: SealSolution) -> dict[str, Any]:
    left_out = _not_measured(result)
    shares = result.error_shares
    return {"error_shares": [{**asdict(one), "parts": one.parts, "not_measured": left_out} for one in shares]}


OUTPUT = AnswerOutput(
    lambda result: result.highest.leak is not None,
    summary=_summary,
    absent={"error_shares": []},
    page=lambda result, display: replace(
        _page(result) if any(shares.is_telling for shares in result.error_shares) else AnswerPage(),
        backing=backing_in_brief(result),
    ),
)
