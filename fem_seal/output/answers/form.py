"""Effects of a form error in words and tables; line load and leak around the axis."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.leakage_class import OF_LEAK_RATE, volume_of
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, by_scenario, worded_section, worded_table
from fem_seal.output.columns import ReadableTable
from fem_seal.output.tables import AROUND_COLUMNS
from fem_seal.seal.findings import Bounds
from fem_seal.seal.load_result import load_name
from fem_seal.seal.scenarios import BESIDE
from fem_seal.wording import say, say_all

if TYPE_CHECKING:
    from fem_seal.answers.form import AllowedForm, FormAnswers, FormPoint, WaveAlone
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.output.tables import CsvTable
    from fem_seal.seal.circumference import Circumference
    from fem_seal.units import Display


# Share of the leak whose part of the circumference is reported.
_MOST = 0.8
# Places count as least loaded within this share of the mean line load; largest number of places that are named.
_AS_LITTLE, _NAMED = 0.005, 4
_DIRECTIONS = {"radial": "roundness", "axial": "flatness"}


def tolerance(result: SealSolution, display: Display) -> str:
    """The tolerance that a drawing needs, in one sentence; empty without a form error, or where the case has no limit.

    Parameters
    ----------
    result : SealSolution
    display : Display
    """
    answers, case = result.form, result.case
    asked = case.requirement is not None or case.load.target_leak_rate is not None
    if answers is None or answers.allowed is None or not asked or result.highest.validity.outside_theory:
        return ""
    return _zone(answers, result.highest, display) or _size(answers, display)


def _sentences(result: SealSolution, answers: FormAnswers, display: Display) -> Iterator[str]:
    load, form = result.highest, result.problem.form
    at = load_name(load, result.loads, display)
    if load.leak is not None and load.leak_round is not None:
        as_calculated, as_round = (
            [leak.leak_rate for leak in leaks if leak is not None]
            for leaks in zip(
                *((read.leak, read.leak_round) for read in (load, *load.others.values())), strict=True
            )
        )
        rate, of_round = (
            _rate(load, display, *rates, compared_rates=(*as_calculated, *as_round))
            for rates in (as_calculated, as_round)
        )
        state = display.state_of(volume_of(result.case))
        without = {"moment": form and form.moment, "bolts": form and form.bolts}
        yield from say_all(
            display, "form", "leak", load=at, rate=rate, round=of_round, state=state, **without
        )
    yield from say_all(display, "form", "worst", answers=answers, load=at)
    if load.circumference is not None and load.circumference.form.uneven:
        # only results with a form error need this module
        from fem_seal.answers.form import CLOSED_SHARE

        yield say(display, "form", "closing", force=answers.closing_force, load=load, closed=CLOSED_SHARE)
    if answers.allowed is not None and not load.validity.outside_theory:
        yield from filter(None, (_size(answers, display), _zone(answers, load, display)))
        if answers.allowed.waves is not None and any(_zones(answers)[:1]):
            scratched = load.around is not None and load.around.scratches is not None
            waves = answers.allowed.waves
            yield from say_all(display, "form", "zone_holds", waves=waves, scratched=scratched)
    yield from _scratches(answers, load, display)
    if answers.goes_round is not None:
        yield say(display, "form", "goes_round", share=answers.goes_round, load=at)


def _rate(
    load: CaseLoad, display: Display, *rates: float | None, compared_rates: Sequence[float] = ()
) -> str:
    """One leak rate, or the ends of several, in the common unit with `compared_rates`."""
    ends, claimed = Bounds.of(rate for rate in rates if rate is not None), not load.validity.outside_theory
    rate = ends if ends.is_range else ends.low
    return display.leak_range(rate, load.leak_digits, claimed=claimed, beside=compared_rates)


def _size(answers: FormAnswers, display: Display) -> str:
    """How large the form error may be, by both bounds of yielding; empty if any size is allowed."""
    allowed = answers.allowed
    assert allowed is not None  # of all who ask
    # of a round seal that leaks too much there is none
    sizes = [allowed_form.factor for allowed_form in (allowed, *answers.allowed_others.values())]
    least, most = sorted((sizes[0], sizes[-1]), key=lambda size: -1.0 if size is None else size)
    if least is not None and math.isinf(least):
        return ""
    factors = [size if size is None or math.isinf(size) else _down(size) for size in (least, most)]
    rate = allowed.leak_rate
    return say(display, "form", "size", factors=factors, limit=_name_of_limit(allowed), rate=rate)


def _name_of_limit(allowed: AllowedForm) -> str:
    names = {"target": "target", OF_LEAK_RATE: "required leak rate"}
    return names.get(allowed.limit, f"limit of {allowed.limit}")


def _zones(answers: FormAnswers) -> list[float]:
    """Tolerance on the drawing by both bounds of yielding, the smaller first [m]; empty if there is no limit for it."""
    zones_of_bounds = [
        zone.zone for zone in (answers.allowed, *answers.allowed_others.values()) if zone is not None
    ]
    zones = sorted(zone for zone in zones_of_bounds if zone is not None)
    # by a bound by which even the round seal leaks too much there is none
    complete = len(zones) == len(zones_of_bounds) > 0
    return [_down(zone) for zone in zones] if complete and math.isfinite(zones[0]) else []


def _zone(answers: FormAnswers, load: CaseLoad, display: Display) -> str:
    allowed, zones = answers.allowed, _zones(answers)
    if allowed is None or not zones:
        return ""
    assert load.circumference is not None  # of a form error
    normal = load.contact.model.touch_normal_z
    share = normal if allowed.direction == "axial" else math.sqrt(1.0 - normal**2)
    now = float(np.ptp(load.circumference.gap_change)) / share
    kind, limit = _DIRECTIONS[allowed.direction], _name_of_limit(allowed)
    ends = [zones[0], zones[-1] if math.isfinite(zones[-1]) else None]
    return say(display, "form", "zone", kind=kind, zones=ends, now=now, limit=limit)


def _scratches(answers: FormAnswers, load: CaseLoad, display: Display) -> list[str]:
    added = [read.around.scratches for read in (load, *load.others.values()) if read.around is not None]
    intervals = [bounds for bounds in added if bounds is not None]
    if not intervals:
        return []
    rates = [end for ends in intervals for end in ends]
    low, high = (_rate(load, display, *ends, compared_rates=rates) for ends in zip(*intervals, strict=True))
    deepest = None if answers.deepest_scratch is None else [*map(_down, answers.deepest_scratch)]
    return say_all(display, "form", "scratches", low=low, high=high, deepest=deepest)


def _down(value: float) -> float:
    """An allowed value, rounded down to two digits."""
    if not 0 < value < math.inf:
        return value
    unit = 10.0 ** (math.floor(math.log10(value) + 1e-12) - 1)
    return math.floor(value / unit + 1e-9) * unit


def _of_point(result: SealSolution, point: FormPoint | WaveAlone) -> str:
    rates, display = (point.leak_rate, *point.others.values()), result.display
    return "–" if point.leak_rate is None else _rate(result.highest, display, *rates)


def curve_table(result: SealSolution) -> ReadableTable:
    """Leak rate over the size of the form error; no rows for a round seal."""
    answers, load = result.form, result.highest
    felt = answers is not None and load.circumference is not None and load.circumference.form.felt_waves
    points = answers.curve if answers is not None and felt else ()
    return worded_table(
        result.display,
        "form_curve",
        [{"point": point, "leak_rate": _of_point(result, point)} for point in points],
        without=() if any(point.leak_rate is not None for point in points) else ("leak rate",),
    )


def waves_table(result: SealSolution) -> ReadableTable:
    """Each wave of the form error alone, the worst first; no rows for a single wave."""
    waves = () if result.form is None else result.form.waves
    rows = [{"wave": wave, "leak_rate": _of_point(result, wave)} for wave in waves]
    return worded_table(result.display, "form_waves", rows if len(rows) > 1 else ())


def _around(result: SealSolution, display: Display) -> list[str]:
    """Unevenness of line load and leak at the shown loads; empty if only scratches are uneven.

    Shown are the load with the highest fluid pressure, and that with the smallest line load, which the form error
    affects most.
    """
    felt = [load for load in result.loads if load.around is not None and load.around.form.uneven]
    if not felt:
        return []
    weakest = min(felt, key=lambda load: load.line_load)
    loads = dict.fromkeys([result.highest, weakest] if result.highest in felt else [weakest])
    return [sentence for load in loads for sentence in _of_load(load, result, display)]


def _of_load(load: CaseLoad, result: SealSolution, display: Display) -> list[str]:
    around = load.around
    assert around is not None
    angles, width = least_loaded(around)
    turn = None if around.leak_rate is None else turn_that_leaks(around.leak_rate, _MOST)
    at, places = load_name(load, result.loads, display), {"angles": angles, "width": width, "turn": turn}
    most = load.contact_force * load.contact.model.initial_contact_radius
    loosest = () if around.form.bolts is None else around.form.bolts.loosest
    words = {"load": at, "around": around, "named": _NAMED, "share": _MOST, "most": most, "loosest": loosest}
    return say_all(display, "form", "around", **words, **places, **result.case.labels)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    answers, load, uneven = result.form, result.highest, _around(result, display)
    if answers is None:
        return AnswerPage()
    first, sentences = tolerance(result, display), list(_sentences(result, answers, display))
    at = load_name(load, result.loads, display)
    details = [*uneven, *sentences]
    section = worded_section(display, "around", details, curve_table(result), waves_table(result), load=at)
    # what a moment or bolts do stands first of what is uneven
    form = result.problem.form
    pressed = form is not None and (form.moment or form.bolts)
    said = [*(uneven[:2] if pressed else ()), *filter(None, [first])]
    return AnswerPage(first=said, why=uneven[:2], section=section, details=sentences)


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
    read = (
        around,
        *(load.others[scenario].around if scenario in load.others else None for scenario in BESIDE),
    )
    leaks = [
        [""] * angles if scenario is None or scenario.leak_rate is None else scenario.leak_rate.tolist()
        for scenario in read
    ]
    peak = np.where(around.line_load > 0, around.peak_pressure, 0.0)
    numbers = np.column_stack([around.angle, around.line_load, peak, around.fwhm]).tolist()
    both = load.fluid_pressure, load.applied_force
    return [(*both, *row, *rates) for row, *rates in zip(numbers, *leaks, strict=True)]


OUTPUT = AnswerOutput(
    lambda result: result.form,
    summary=lambda result: {"form": None if result.form is None else by_scenario(asdict(result.form))},
    absent={"form": None},
    tables={"around.csv": around_rows},
    page=_page,
)
