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
    from fem_seal.answers.standard_tests import TestedLoad
    from fem_seal.output.tables import CsvTable
    from fem_seal.units import Display


def in_words(result: SealSolution) -> list[str]:
    """What the tests of the standard say, and spring and opening of a relief valve; empty without them."""
    return [*_of_tests(result), *filter(None, [spring_in_words(result)])]


def standard_in_brief(result: SealSolution) -> str:
    """The verdict of all tests of the standard in one line, with the test that decides it; empty without them."""
    worst, required = worst_of(result.standard_tests), result.case.requirement
    if not worst or required is None or required.standard_and_class is None:
        return ""
    load = next(test for test in result.standard_tests if _verdict(test) == worst)
    values = {"standard": required.standard_and_class[0], **_cells(result.display, load)}
    told = worst != "pass" and math.isfinite(load.leak_rate)
    return say(
        result.display, "standard_tests", "brief", told=told, **values | {"verdict": verdict_words(worst)}
    )


def _of_tests(result: SealSolution) -> Iterator[str]:
    tests, required = result.standard_tests, result.case.requirement
    if required is None or required.standard_and_class is None:
        return
    for test in tests:
        verdict = "" if test.judgement is None else verdict_words(test.judgement.verdict)
        values = _cells(result.display, test) | {"verdict": verdict}
        yield say(result.display, "standard_tests", "says_test", **values)
    standard, _ = required.standard_and_class
    memory = STANDARDS[standard].from_memory
    if tests and memory:
        yield say(result.display, "standard_tests", "says_memory", standard=standard, memory=memory)


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


def _row(load: TestedLoad, first: float | str) -> tuple[float | str, ...]:
    inputs = load.medium, load.fluid_pressure, load.applied_force
    return (first, *inputs, load.leak_rate, *load.ends, allowed(load), _verdict(load))


def _test_rows(result: SealSolution) -> CsvTable:
    return STANDARD_TEST_COLUMNS, [_row(test, test.test) for test in result.standard_tests]


def _set_pressure_rows(result: SealSolution) -> CsvTable:
    relief = result.set_pressure
    loads = () if relief is None else relief.loads
    return SET_PRESSURE_COLUMNS, [
        _row(load, load.fluid_pressure / relief.pressure) for load in loads if relief
    ]


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
    relief = result.set_pressure
    tests, loads = (
        [dict(zip(columns, row, strict=True)) for row in rows]
        for columns, rows in (_test_rows(result), _set_pressure_rows(result))
    )
    of_relief = relief and {
        "set_pressure_Pa": relief.pressure,
        "contact_radius_m": relief.radius,
        "spring_force_N": relief.force,
        "blow_off_pressure_Pa": relief.opens,
        "loads": loads,
    }
    verdict = worst_of(result.standard_tests) or None
    return {"standard_tests": tests or None, "standard_verdict": verdict, "set_pressure": of_relief}


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
    tables={"standard_tests.csv": _test_rows, "set_pressure.csv": _set_pressure_rows},
    pictures=lambda result: (set_pressure_picture(result),),
    page=_page,
)
