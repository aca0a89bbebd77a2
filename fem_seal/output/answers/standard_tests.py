"""A valve in the tests of its standard, and a relief valve up to its set pressure: words, tables and a picture."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fem_seal.answers.judgement import worst_of
from fem_seal.answers.leakage_class import volume_of
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, worded_section, worded_table
from fem_seal.output.answers.verdict import verdict_words
from fem_seal.output.columns import ReadableTable
from fem_seal.output.pictures.colours import BLUE, GREY, ORANGE
from fem_seal.output.pictures.style import Picture, captioned, label, panels
from fem_seal.output.tables import SET_PRESSURE_COLUMNS, STANDARD_TEST_COLUMNS
from fem_seal.units import LIQUID
from fem_seal.wording import say
from leak.standards import STANDARDS

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.answers.standard_tests import SetPressure, TestedLoad
    from fem_seal.units import Display


def in_words(result: SealSolution) -> list[str]:
    """What the tests of the standard say, and spring and opening of a relief valve; empty without them."""
    return [*_of_tests(result), *filter(None, [spring_in_words(result)])]


def standard_in_brief(result: SealSolution) -> str:
    """The verdict of all tests of the standard in one line, with the test that decides it; empty without them."""
    worst, required = worst_of(result.standard_tests), result.case.requirement
    if not worst or required is None or required.standard_and_class is None:
        return ""
    decisive_test = next(test for test in result.standard_tests if _verdict(test) == worst)
    sentence = "" if worst == "pass" or not math.isfinite(decisive_test.leak_rate) else "but"
    return say(
        result.display,
        "standard_tests",
        f"brief_{sentence or 'alone'}",
        standard=required.standard_and_class[0],
        verdict=verdict_words(worst),
        load=decisive_test,
        rate=_rate(result.display, decisive_test),
        limit=_limit(result.display, decisive_test),
    )


def _of_tests(result: SealSolution) -> Iterator[str]:
    tests, required = result.standard_tests, result.case.requirement
    wanted = None if required is None else required.standard_and_class
    if wanted is None:
        return
    for test in tests:
        how = {math.inf: "open"}.get(test.leak_rate, "unknown" if math.isnan(test.leak_rate) else "test")
        limit = _limit(result.display, test)
        verdict = "" if test.judgement is None else verdict_words(test.judgement.verdict)
        name = test.test[0].upper() + test.test[1:]
        yield say(
            result.display,
            "standard_tests",
            f"says_{how}",
            name=name,
            load=test,
            rate=_rate(result.display, test),
            limit=limit,
            verdict=verdict,
        )
    memory = STANDARDS[wanted[0]].from_memory
    if tests and memory:
        yield say(result.display, "standard_tests", "says_memory", standard=wanted[0], memory=memory)


def spring_in_words(result: SealSolution) -> str:
    """Force of the spring of a relief valve, and where the valve opens; empty unless the valve is one."""
    relief = result.set_pressure
    if relief is None:
        return ""
    opens = relief.opens is not None and not math.isinf(relief.opens)
    return say(result.display, "standard_tests", "says_spring", relief=relief, opens=opens)


def allowed(load: TestedLoad) -> float:
    """Largest allowed leak rate in the fluid of the load [m^3/s]; NaN if there is none."""
    limit = None if load.judgement is None else load.judgement.limit
    return math.nan if limit is None else limit.leak_rate / limit.ratio[1]


def _limit(display: Display, load: TestedLoad) -> str:
    limit = allowed(load)
    if load.judgement is not None and load.judgement.limit.visible:
        return "none visible"
    return "–" if math.isnan(limit) else display.leak_range(limit, 2, beside=load.ends)


def _rate(display: Display, load: TestedLoad) -> str:
    if not math.isfinite(load.leak_rate):
        return "open" if math.isinf(load.leak_rate) else "–"
    return display.leak_range(load.ends, 2, beside=(load.leak_rate, allowed(load)))


def tests_table(result: SealSolution) -> ReadableTable:
    """The tests of the standard; no rows without them, nor of a relief valve, whose one test the sentences say."""
    loads = result.standard_tests if result.set_pressure is None else ()
    return worded_table(result.display, "standard_tests", [_cells(result.display, load) for load in loads])


def set_pressure_table(result: SealSolution) -> ReadableTable:
    """Leak rate up to the set pressure; no rows unless the valve is a relief valve."""
    relief = result.set_pressure
    shares = {} if relief is None else {load.fluid_pressure / relief.pressure: load for load in relief.loads}
    rows = [{"share": share, **_cells(result.display, load)} for share, load in shares.items()]
    return worded_table(result.display, "set_pressure", rows)


def _cells(display: Display, load: TestedLoad) -> dict[str, object]:
    return {
        "load": load,
        "rate": _rate(display, load),
        "limit": _limit(display, load),
        "verdict": _verdict(load),
    }


def _verdict(load: TestedLoad) -> str:
    has_limit = load.judgement is not None and not math.isnan(load.judgement.limit.leak_rate)
    return str(load.judgement.verdict) if has_limit and load.judgement is not None else "–"


def _row(load: TestedLoad) -> tuple[float | str, ...]:
    inputs = load.medium, load.fluid_pressure, load.applied_force
    return (*inputs, load.leak_rate, *load.ends, allowed(load), _verdict(load))


def _test_row(load: TestedLoad) -> tuple[float | str, ...]:
    return load.test, *_row(load)


def _share_row(relief: SetPressure, load: TestedLoad) -> tuple[float | str, ...]:
    return load.fluid_pressure / relief.pressure, *_row(load)


def set_pressure_picture(result: SealSolution) -> Picture | None:
    """Leak rate over the share of the set pressure; None unless the valve is a relief valve."""
    relief = result.set_pressure
    leaking = [] if relief is None else [load for load in relief.loads if 0 < load.leak_rate < math.inf]
    if relief is None or len(leaking) < 2:
        return None
    shares = [load.fluid_pressure / relief.pressure for load in leaking]
    unit = result.display.unit_for("flow", max(load.leak_rate for load in leaking))
    volume = volume_of(result.case)
    unit = unit if volume is LIQUID else result.display.name_unit(unit, volume)
    figure, (axes,) = panels(1)
    low, high = ([unit.of(load.ends[end]) for load in leaking] for end in (0, 1))
    axes.fill_between(shares, low, high, color=BLUE, alpha=0.15, linewidth=0)
    axes.plot(
        shares, [unit.of(load.leak_rate) for load in leaking], "o-", color=BLUE, ms=3.2, label="leak rate"
    )
    limit = allowed(leaking[0])
    if limit > 0:
        axes.axhline(unit.of(limit), color=ORANGE, linestyle="--", label="allowed by API 527")
    if relief.opens is not None and math.isfinite(relief.opens):
        axes.axvline(relief.opens / relief.pressure, color=GREY, label="opens")
    share, rate = "fluid pressure over set pressure", f"leak rate  [{unit.name}]"
    label(axes, "Leak up to the set pressure", share, rate, log="y", legend="upper left")
    return captioned(result.display, figure, "set_pressure", "all", relief=relief)


def _summary(result: SealSolution) -> dict[str, Any]:
    tests, relief = map(_test_row, result.standard_tests), result.set_pressure
    return {
        "standard_tests": [dict(zip(STANDARD_TEST_COLUMNS, row, strict=True)) for row in tests] or None,
        "standard_verdict": worst_of(result.standard_tests) or None,
        "set_pressure": None if relief is None else _in_summary(relief),
    }


def _in_summary(relief: SetPressure) -> dict[str, Any]:
    rows = (_share_row(relief, load) for load in relief.loads)
    return {
        "set_pressure_Pa": relief.pressure,
        "contact_radius_m": relief.radius,
        "spring_force_N": relief.force,
        "blow_off_pressure_Pa": relief.opens,
        "loads": [dict(zip(SET_PRESSURE_COLUMNS, row, strict=True)) for row in rows],
    }


def _page(result: SealSolution, display: Display) -> AnswerPage:
    words = in_words(result)
    return AnswerPage(
        first=[*filter(None, (standard_in_brief(result), spring_in_words(result)))],
        section=worded_section(
            display, "standard_tests", words, tests_table(result), set_pressure_table(result)
        ),
        details=words,
    )


OUTPUT = AnswerOutput(
    lambda result: result.standard_tests or result.set_pressure,
    summary=_summary,
    absent=dict.fromkeys(("standard_tests", "standard_verdict", "set_pressure")),
    tables={
        "standard_tests.csv": lambda result: (
            STANDARD_TEST_COLUMNS,
            [_test_row(test) for test in result.standard_tests],
        ),
        "set_pressure.csv": lambda result: (
            SET_PRESSURE_COLUMNS,
            [
                _share_row(relief, load)
                for relief in filter(None, [result.set_pressure])
                for load in relief.loads
            ],
        ),
    },
    pictures=lambda result: (set_pressure_picture(result),),
    page=_page,
)
