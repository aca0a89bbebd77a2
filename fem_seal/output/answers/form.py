"""Effects of a form error in words and tables; line load and leak around the axis."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.leakage_class import OF_LEAK_RATE, volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.columns import ReadableTable
from fem_seal.output.prose import in_scenario, phrase
from fem_seal.output.shown import AnswerPage, Section, Shown, by_scenario, worded_section, worded_table
from fem_seal.output.tables import AROUND_COLUMNS
from fem_seal.seal.findings import Bounds
from fem_seal.seal.load_result import load_name
from fem_seal.seal.scenarios import BESIDE
from fem_seal.units import leak_range_text, number, quantity

if TYPE_CHECKING:
    from fem_seal.answers.form import Allowed, FormAnswers, FormPoint, WaveAlone
    from fem_seal.arrays import FloatArray
    from fem_seal.output.tables import CsvTable
    from fem_seal.seal.circumference import Circumference


# Share of the leak whose part of the circumference is reported.
_MOST = 0.8
# Places count as least loaded within this share of the mean line load; largest number of places that are named.
_AS_LITTLE, _NAMED = 0.005, 4
_DIRECTIONS = {"radial": "roundness", "axial": "flatness"}


def form_in_words(result: SealSolution) -> list[str]:
    """Answers about a form error, a sentence or two for each; empty for a round seal."""
    answers = result.form
    return [] if answers is None else [text for text in _sentences(result, answers) if text]


def form_in_brief(result: SealSolution) -> str:
    """The tolerance that a drawing needs, in one line; empty without a form error, or where the case has no limit.

    Parameters
    ----------
    result : SealSolution
    """
    found, case = None if result.form is None else result.form.allowed, result.case
    asked = case.requirement is not None or case.load.target_leak_rate is not None
    if found is None or not asked or result.highest.validity.outside:
        return ""
    aside = phrase("form.allowed", "aside")
    told = [one for one in _allowed_in_words(found, {}, result.highest) if one != aside]
    return told[-1].rstrip(".") if told else ""


def _sentences(result: SealSolution, answers: FormAnswers) -> Iterator[str]:
    load = result.highest
    at = load_name(load, result.loads)
    if load.leak is not None and load.leak_round is not None:
        own, as_round = (
            [leak.leak_rate for leak in leaks if leak is not None]
            for leaks in zip(
                *((one.leak, one.leak_round) for one in (load, *load.others.values())), strict=True
            )
        )
        yield phrase(
            "form.leak",
            "round",
            load=at,
            rate=_rate(load, *own, beside=(*own, *as_round)),
            round=_rate(load, *as_round, beside=(*own, *as_round)),
        )
        if state := volume_of(result.case).state:
            yield phrase("form.leak", "volume", state=state)
    if answers.tolerance_waves is not None:
        yield phrase("form.tolerance", "worst", waves=answers.tolerance_waves)
    if len(answers.waves) > 1:
        yield phrase("form.waves", "worst", worst=answers.waves[0], load=at)
    yield from _closing(answers, load)
    if answers.allowed is not None and not load.validity.outside:
        yield from _allowed_in_words(answers.allowed, answers.allowed_others, load)
    yield from _scratches(answers, load)
    if answers.goes_round is not None:
        yield phrase("form.round", "share", share=answers.goes_round, load=at)


def _rate(load: CaseLoad, *rates: float | None, beside: Sequence[float] = ()) -> str:
    """One leak rate, or the ends of several, in the common unit with `beside`."""
    ends = Bounds.of(rate for rate in rates if rate is not None)
    return leak_range_text(
        ends if ends.apart else ends.low, load.leak_digits, claimed=not load.validity.outside, beside=beside
    )


def _closing(answers: FormAnswers, load: CaseLoad) -> Iterator[str]:
    circumference = load.circumference
    if circumference is None or not circumference.form.felt:
        return
    # only results with a form error need this module
    from fem_seal.answers.form import CLOSED

    force = answers.closing_force
    kind = "never" if force is None else "enough" if force <= load.applied_force else "force"
    yield phrase("form.closing", kind, force=force, load=load, closed=CLOSED)


def _allowed_in_words(allowed: Allowed, others: Mapping[str, Allowed], load: CaseLoad) -> Iterator[str]:
    """Allowed size of the form error, each followed by that of the other readings of yielding asperities."""
    names = {"target": "target", OF_LEAK_RATE: "required leak rate"}
    limit = names.get(allowed.limit, f"limit of {allowed.limit}")
    if allowed.factor is None:
        yield phrase("form.allowed", "round_leaks_more", limit=limit, rate=allowed.leak_rate)
        return
    if math.isfinite(allowed.factor):
        kind, factor = "larger" if allowed.factor > 1 else "smaller", _down(allowed.factor)
        yield phrase("form.allowed", kind, factor=factor, limit=limit, rate=allowed.leak_rate)
    for scenario, other in others.items():
        if other.factor is None:
            yield in_scenario(scenario, load.names[0], "even the round seal leaks more")
        elif math.isfinite(other.factor):
            first, second = (number(_down(one), 2) for one in (allowed.factor, other.factor))
            if first != second:
                yield in_scenario(scenario, load.names[0], f"the form error may be {second} times as large")
    if load.around is not None and load.around.scratches is not None:
        yield phrase("form.allowed", "aside")
    if allowed.zone is not None and math.isfinite(allowed.zone):
        kind, zone = _DIRECTIONS[allowed.direction], _down(allowed.zone)
        which = "drawing" if zone else "no_zone"
        assert load.circumference is not None  # of a form error
        normal = load.contact.model.touch_normal_z
        share = normal if allowed.direction == "axial" else math.sqrt(1.0 - normal**2)
        now = float(np.ptp(load.circumference.gap_change)) / share
        yield phrase("form.allowed", which, kind=kind, zone=zone, waves=allowed.waves, limit=limit, now=now)
    for scenario, other in others.items():
        if other.zone is not None and math.isfinite(other.zone):
            first, second = (quantity("length", _down(one or 0.0), 2) for one in (allowed.zone, other.zone))
            if first != second:
                yield in_scenario(scenario, load.names[0], f"the tolerance is {second}")


def _scratches(answers: FormAnswers, load: CaseLoad) -> Iterator[str]:
    added = [one.around.scratches for one in (load, *load.others.values()) if one.around is not None]
    known = [bounds for bounds in added if bounds is not None]
    if not known:
        return
    every = [end for ends in known for end in ends]
    low, high = (_rate(load, *ends, beside=every) for ends in zip(*known, strict=True))
    yield phrase("form.scratches", "both", low=low, high=high)
    if answers.deepest_scratch is not None:
        depth, width = map(_down, answers.deepest_scratch)
        yield phrase("form.scratches", "deepest", depth=depth, width=width)
        if len(known) > 1:
            yield phrase("form.scratches", "in_all")


def _down(value: float) -> float:
    """An allowed value, rounded down to two digits."""
    if not 0 < value < math.inf:
        return value
    unit = 10.0 ** (math.floor(math.log10(value) + 1e-12) - 1)
    return math.floor(value / unit + 1e-9) * unit


def _of_point(load: CaseLoad, point: FormPoint | WaveAlone) -> str:
    return "–" if point.leak_rate is None else _rate(load, point.leak_rate, *point.others.values())


def curve_table(result: SealSolution) -> ReadableTable:
    """Leak rate over the size of the form error; no rows for a round seal."""
    answers, load = result.form, result.highest
    felt = answers is not None and load.circumference is not None and load.circumference.form.felt
    points = answers.curve if answers is not None and felt else ()
    return worded_table(
        "form_curve",
        [{"point": point, "leak_rate": _of_point(load, point)} for point in points],
        without=() if any(point.leak_rate is not None for point in points) else ("leak rate",),
    )


def waves_table(result: SealSolution) -> ReadableTable:
    """Each wave of the form error alone, the worst first; no rows for a single wave."""
    waves = () if result.form is None else result.form.waves
    rows = [{"wave": wave, "leak_rate": _of_point(result.highest, wave)} for wave in waves]
    return worded_table("form_waves", rows if len(rows) > 1 else ())


def _section(result: SealSolution) -> Section | None:
    sentences, load = (
        [*around_in_words(result), *form_in_words(result)],
        load_name(result.highest, result.loads),
    )
    return worded_section("around", sentences, curve_table(result), waves_table(result), load=load)


def around_in_words(result: SealSolution) -> list[str]:
    """Unevenness of line load and leak, a text for each shown load; empty if only scratches are uneven.

    Shown are the load with the highest fluid pressure, and that with the smallest line load, which the form error
    affects most.

    Parameters
    ----------
    result : SealSolution
    """
    known = [load for load in result.loads if load.around is not None and load.around.form.felt]
    if not known:
        return []
    weakest = min(known, key=lambda load: load.line_load)
    shown = dict.fromkeys([result.highest, weakest] if result.highest in known else [weakest])
    return [" ".join(_of_load(load, result)) for load in shown]


def _of_load(load: CaseLoad, result: SealSolution) -> Iterator[str]:
    around, name = load.around, load_name(load, result.loads)
    assert around is not None
    angles, width = least_loaded(around)
    at = _angles_text(angles)
    if around.line_load.min() == 0:
        yield phrase("notes.around", "parted", load=name, at=at, width=_degrees(width))
    else:
        yield phrase("notes.around", "falls", load=name, at=at, around=around)
    turn = None if around.leak_rate is None else turn_that_leaks(around.leak_rate, _MOST)
    if turn is not None:
        yield phrase("notes.around", "leak", share=_MOST, turn=_degrees(turn))


def least_loaded(around: Circumference) -> tuple[list[float], float]:
    """Middles of the places with the least line load, and their total extent [rad].

    Parameters
    ----------
    around : Circumference
    """
    f = around.line_load
    low = f <= f.min() + _AS_LITTLE * f.mean()
    step = 2 * math.pi / len(f)
    if low.all():
        return [], 2 * math.pi
    # starts at the beginning of a place, so that none is cut
    start = int(np.flatnonzero(low & ~np.roll(low, 1))[0])
    edges = np.diff(np.roll(low, -start).astype(int), prepend=0, append=0)
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    middles = (start + 0.5 * (first + last)) % len(f) * step
    return sorted(middles.tolist()), float((last - first + 1).sum()) * step


def turn_that_leaks(leak_rate: FloatArray, share: float) -> float | None:
    """Smallest part of the turn through which a share of the leak passes [rad]; None if the leak is zero or infinite.

    Parameters
    ----------
    leak_rate : ndarray, shape (m,)
        At uniform angles.
    share : float
    """
    total = float(leak_rate.sum())
    if not (math.isfinite(total) and total > 0):
        return None
    passed = np.concatenate([[0.0], np.cumsum(np.sort(leak_rate)[::-1]) / total])
    return float(np.interp(share, passed, np.arange(len(passed)))) * 2 * math.pi / len(leak_rate)


def _angles_text(angles: list[float]) -> str:
    """The angles, "90° and 270°", or the number of many."""
    if not angles:
        return "every angle"
    if len(angles) > _NAMED:
        return f"{len(angles)} places around the axis"
    texts = [_degrees(angle) for angle in angles]
    return " and ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.0f}°"


def around_rows(result: SealSolution) -> CsvTable:
    """Headings and rows of around.csv, one for each angle of each load; none of a round seal."""
    return AROUND_COLUMNS, [row for load in result.loads for row in _angles_of(load)]


def _angles_of(load: CaseLoad) -> list[tuple[float | str, ...]]:
    """Rows of a load with `AROUND_COLUMNS`, one for each angle; none for a round seal.

    Parameters
    ----------
    load : CaseLoad
    """
    around = load.around
    if around is None:
        return []
    angles = len(around.angle)
    read = (around, *(load.others[one].around if one in load.others else None for one in BESIDE))
    leaks = [
        [""] * angles if one is None or one.leak_rate is None else one.leak_rate.tolist() for one in read
    ]
    peak = np.where(around.line_load > 0, around.peak_pressure, 0.0)
    numbers = np.column_stack([around.angle, around.line_load, peak, around.fwhm]).tolist()
    both = load.fluid_pressure, load.applied_force
    return [(*both, *row, *rates) for row, *rates in zip(numbers, *leaks, strict=True)]


SHOWN = Shown(
    lambda result: result.form,
    summary=lambda result: {"form": None if result.form is None else by_scenario(asdict(result.form))},
    absent={"form": None},
    tables={"around.csv": around_rows},
    section=_section,
    lines=form_in_words,
    page=lambda result, display: AnswerPage(first=[*filter(None, [form_in_brief(result)])]),
)
