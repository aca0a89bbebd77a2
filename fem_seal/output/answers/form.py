"""What a form error means, in words and tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.limits import OF_LEAK_RATE
from fem_seal.answers.solution import SealSolution
from fem_seal.output.answers.around import around_in_words
from fem_seal.output.prose import other_reading, said
from fem_seal.output.readable import ReadableTable
from fem_seal.output.shown import Section, Shown, by_reading
from fem_seal.seal.bounds import Bounds
from fem_seal.seal.load_names import load_name
from fem_seal.seal.load_result import LoadResult
from fem_seal.units import given, leak_range_text, number, percent, quantity

if TYPE_CHECKING:
    from fem_seal.answers.form import Allowed, FormAnswers, FormPoint, WaveAlone
    from leak import Reading


_DIRECTIONS = {"radial": "roundness", "axial": "flatness"}


def form_in_words(result: SealSolution) -> list[str]:
    """What an engineer asks of a form error, a sentence or two for each question; empty for a round seal."""
    answers = result.form
    return [] if answers is None else [text for text in _said(result, answers) if text]


def _said(result: SealSolution, answers: FormAnswers) -> Iterator[str]:
    load = result.highest
    at = load_name(load, result.loads)
    if load.leak is not None and load.leak_round is not None:
        own, as_round = (
            [leak.leak_rate for leak in leaks if leak is not None]
            for leaks in zip(*((one.leak, one.leak_round) for one in load.readings.values()), strict=True)
        )
        yield said(
            "form.leak",
            "round",
            load=at,
            rate=_rate(load, *own, beside=(*own, *as_round)),
            round=_rate(load, *as_round, beside=(*own, *as_round)),
        )
        if state := volume_of(result.case).state:
            yield said("form.leak", "volume", state=state)
    if answers.tolerance_waves is not None:
        yield said("form.tolerance", "worst", waves=answers.tolerance_waves)
    if len(answers.waves) > 1:
        worst = answers.waves[0]
        yield said(
            "form.waves", "worst", waves=worst.waves, least=percent(worst.line_load_min_over_mean), load=at
        )
    yield from _closing(answers, load)
    if answers.allowed is not None and not load.validity.outside:
        yield from _allowed(answers.allowed, answers.allowed_others, load)
    yield from _scratches(answers, load)
    if answers.goes_round is not None:
        yield said("form.round", "share", share=percent(answers.goes_round), load=at)


def _rate(load: LoadResult, *rates: float | None, beside: Sequence[float] = ()) -> str:
    """One leak rate, or the ends of several, in the unit of what stands beside them."""
    ends = Bounds.of(rate for rate in rates if rate is not None)
    return leak_range_text(
        ends if ends.apart else ends.low, load.leak_digits, claimed=not load.validity.outside, beside=beside
    )


def _closing(answers: FormAnswers, load: LoadResult) -> Iterator[str]:
    formed = load.formed
    if formed is None or not formed.form.felt:
        return
    # no other result needs that module
    from fem_seal.answers.form import CLOSED

    closed = percent(CLOSED)
    if answers.closing_force is None:
        yield said("form.closing", "never", closed=closed)
        return
    enough = answers.closing_force <= load.applied_force
    yield said(
        "form.closing",
        "enough" if enough else "force",
        force=quantity("force", answers.closing_force, 3),
        applied=given("force", load.applied_force),
        closed=closed,
        pressure=given("fluid pressure", load.fluid_pressure),
    )


def _allowed(allowed: Allowed, others: Mapping[Reading, Allowed], load: LoadResult) -> Iterator[str]:
    """How large the form error may be, and directly behind it what other readings of yielding asperities say."""
    limit, rate = allowed.limit, given("flow", allowed.leak_rate)
    limit = {"target": "target", OF_LEAK_RATE: "required leak rate"}.get(limit, f"limit of {limit}")
    if allowed.factor is None:
        yield said("form.allowed", "round_leaks_more", limit=limit, rate=rate)
        return
    if math.isfinite(allowed.factor):
        yield said(
            "form.allowed",
            "larger" if allowed.factor > 1 else "smaller",
            factor=number(_down(allowed.factor), 2),
            limit=limit,
            rate=rate,
        )
    for reading, other in others.items():
        if other.factor is None:
            yield other_reading(reading, "even the round seal leaks more")
        elif math.isfinite(other.factor):
            first, told = (number(_down(one), 2) for one in (allowed.factor, other.factor))
            if first != told:
                yield other_reading(reading, f"the form error may be {told} times as large")
    if load.around is not None and load.around.scratches is not None:
        yield said("form.allowed", "aside")
    if allowed.zone == 0:
        yield said("form.allowed", "no_zone", kind=_DIRECTIONS[allowed.direction], limit=limit)
    elif allowed.zone is not None and math.isfinite(allowed.zone):
        yield said(
            "form.allowed",
            "drawing",
            kind=_DIRECTIONS[allowed.direction],
            zone=quantity("length", _down(allowed.zone), 2),
            waves=allowed.waves,
            limit=limit,
        )
    for reading, other in others.items():
        if other.zone is not None and math.isfinite(other.zone):
            first, told = (quantity("length", _down(one or 0.0), 2) for one in (allowed.zone, other.zone))
            if first != told:
                yield other_reading(reading, f"the tolerance is {told}")


def _scratches(answers: FormAnswers, load: LoadResult) -> Iterator[str]:
    added = [one.around.scratches for one in load.readings.values() if one.around is not None]
    known = [bounds for bounds in added if bounds is not None]
    if not known:
        return
    every = [end for ends in known for end in ends]
    low, high = (_rate(load, *ends, beside=every) for ends in zip(*known, strict=True))
    yield said("form.scratches", "both", low=low, high=high)
    if answers.deepest_scratch is not None:
        depth, width = answers.deepest_scratch
        yield said(
            "form.scratches",
            "deepest",
            depth=quantity("length", _down(depth), 2),
            width=quantity("length", _down(width), 2),
        )
        if len(known) > 1:
            yield said("form.scratches", "both_readings")


def _down(value: float) -> float:
    """What is allowed, with two digits and no more of it than there is."""
    if not 0 < value < math.inf:
        return value
    unit = 10.0 ** (math.floor(math.log10(value) + 1e-12) - 1)
    return math.floor(value / unit + 1e-9) * unit


def _of_point(load: LoadResult, point: FormPoint | WaveAlone) -> str:
    return "–" if point.leak_rate is None else _rate(load, point.leak_rate, *point.others.values())


def curve_table(result: SealSolution) -> ReadableTable:
    """Leak rate over the size of the form error; no rows for a round seal."""
    answers, load = result.form, result.highest
    if answers is None or load.formed is None or not load.formed.form.felt:
        return ReadableTable((), ())
    leaks = any(point.leak_rate is not None for point in answers.curve)
    rows = [
        (
            number(point.factor, 3),
            quantity("length", point.height, 3),
            percent(point.line_load_min_over_mean),
            *((_of_point(load, point),) if leaks else ()),
        )
        for point in answers.curve
    ]
    headings = ("times the form error", "change of the gap", "least line load over mean")
    return ReadableTable((*headings, "leak rate") if leaks else headings, tuple(rows))


def waves_table(result: SealSolution) -> ReadableTable:
    """Each wave of the form error alone, the one that hurts most first; no rows where there is but one."""
    answers, load = result.form, result.highest
    if answers is None or len(answers.waves) < 2:
        return ReadableTable((), ())
    rows = [
        (
            str(wave.waves),
            quantity("length", wave.amplitude, 3),
            percent(wave.line_load_min_over_mean),
            _of_point(load, wave),
        )
        for wave in answers.waves
    ]
    return ReadableTable(
        ("waves per turn", "amplitude of the gap", "least line load over mean", "leak rate of it alone"),
        tuple(rows),
    )


def _section(result: SealSolution) -> Section | None:
    sentences = [*around_in_words(result), *form_in_words(result)]
    at = load_name(result.highest, result.loads)
    if not sentences:
        return None
    return Section(
        "around",
        "Around the axis",
        "Around the axis",
        sentences,
        ("line_load_around", "unrolled", "leak_around"),
        (
            (
                curve_table(result),
                f"The same form error, smaller and larger, at {at}, without scratches and lay.",
            ),
            (waves_table(result), "Each wave of the form error alone."),
        ),
        ("around.csv", "around.pvd (ParaView)"),
    )


SHOWN = Shown(
    summary=lambda result: {"form": None if result.form is None else by_reading(asdict(result.form))},
    section=_section,
    lines=form_in_words,
)
