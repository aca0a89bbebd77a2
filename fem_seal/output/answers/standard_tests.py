"""A valve in the tests of its standard, and a relief valve up to its set pressure: words, tables and a picture."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fem_seal.answers.judgement import worst_of
from fem_seal.answers.leakage_class import volume_of
from fem_seal.output.answers.verdict import verdict_words
from fem_seal.output.columns import ReadableTable
from fem_seal.output.pictures.colours import BLUE, GREY, ORANGE
from fem_seal.output.pictures.style import Picture, captioned, label, panels
from fem_seal.output.shown import AnswerPage, Shown, worded_section, worded_table
from fem_seal.output.tables import SET_PRESSURE_COLUMNS, STANDARD_TEST_COLUMNS
from fem_seal.units import LIQUID, leak_range_text, unit_for
from fem_seal.wording import phrase
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
    one = next(test for test in result.standard_tests if _verdict(test) == worst)
    known = "" if worst == "pass" or not math.isfinite(one.leak_rate) else "but"
    return phrase(
        "standard_tests.brief",
        known or "alone",
        standard=required.standard_and_class[0],
        verdict=verdict_words(worst),
        one=one,
        rate=_rate(one),
        limit=_limit(one),
    )


def _of_tests(result: SealSolution) -> Iterator[str]:
    tests, required = result.standard_tests, result.case.requirement
    wanted = None if required is None else required.standard_and_class
    if wanted is None:
        return
    for one in tests:
        how = {math.inf: "open"}.get(one.leak_rate, "unknown" if math.isnan(one.leak_rate) else "test")
        limit, verdict = _limit(one), "" if one.judgement is None else verdict_words(one.judgement.verdict)
        name = one.test[0].upper() + one.test[1:]
        yield phrase(
            "standard_tests.says", how, name=name, one=one, rate=_rate(one), limit=limit, verdict=verdict
        )
    memory = STANDARDS[wanted[0]].from_memory
    if tests and memory:
        yield phrase("standard_tests.says", "memory", standard=wanted[0], memory=memory)


def spring_in_words(result: SealSolution) -> str:
    """Force of the spring of a relief valve, and where the valve opens; empty unless the valve is one."""
    found = result.set_pressure
    if found is None:
        return ""
    opens = "" if found.opens is None or math.isinf(found.opens) else "opens"
    return phrase("standard_tests.says", "spring", opens, found=found, diameter=2.0 * found.radius)


def allowed(load: TestedLoad) -> float:
    """Largest allowed leak rate in the fluid of the load [m^3/s]; NaN if there is none."""
    limit = None if load.judgement is None else load.judgement.limit
    return math.nan if limit is None else limit.leak_rate / limit.ratio[1]


def _limit(load: TestedLoad) -> str:
    limit = allowed(load)
    if load.judgement is not None and load.judgement.limit.visible:
        return "none visible"
    return "–" if math.isnan(limit) else leak_range_text(limit, 2, beside=load.ends)


def _rate(load: TestedLoad) -> str:
    if not math.isfinite(load.leak_rate):
        return "open" if math.isinf(load.leak_rate) else "–"
    return leak_range_text(load.ends, 2, beside=(load.leak_rate, allowed(load)))


def tests_table(result: SealSolution) -> ReadableTable:
    """The tests of the standard; no rows without them, nor of a relief valve, whose one test the sentences say."""
    loads = result.standard_tests if result.set_pressure is None else ()
    return worded_table("standard_tests", map(_cells, loads))


def set_pressure_table(result: SealSolution) -> ReadableTable:
    """Leak rate up to the set pressure; no rows unless the valve is a relief valve."""
    found = result.set_pressure
    shares = {} if found is None else {one.fluid_pressure / found.pressure: one for one in found.loads}
    rows = [{"share": share, **_cells(one)} for share, one in shares.items()]
    return worded_table("set_pressure", rows)


def _cells(load: TestedLoad) -> dict[str, object]:
    return {"one": load, "rate": _rate(load), "limit": _limit(load), "verdict": _verdict(load)}


def _verdict(load: TestedLoad) -> str:
    known = load.judgement is not None and not math.isnan(load.judgement.limit.leak_rate)
    return str(load.judgement.verdict) if known and load.judgement is not None else "–"


def _row(one: TestedLoad) -> tuple[float | str, ...]:
    load = one.medium, one.fluid_pressure, one.applied_force, one.leak_rate
    return (*load, *one.ends, allowed(one), _verdict(one))


def _test_row(one: TestedLoad) -> tuple[float | str, ...]:
    return one.test, *_row(one)


def _share_row(found: SetPressure, one: TestedLoad) -> tuple[float | str, ...]:
    return one.fluid_pressure / found.pressure, *_row(one)


def set_pressure_picture(result: SealSolution) -> Picture | None:
    """Leak rate over the share of the set pressure; None unless the valve is a relief valve."""
    found = result.set_pressure
    known = [] if found is None else [one for one in found.loads if 0 < one.leak_rate < math.inf]
    if found is None or len(known) < 2:
        return None
    shares = [one.fluid_pressure / found.pressure for one in known]
    unit = unit_for("flow", max(one.leak_rate for one in known))
    volume = volume_of(result.case)
    unit = unit if volume is LIQUID else volume.name_unit(unit)
    figure, (axes,) = panels(1)
    low, high = ([unit.of(one.ends[end]) for one in known] for end in (0, 1))
    axes.fill_between(shares, low, high, color=BLUE, alpha=0.15, linewidth=0)
    axes.plot(shares, [unit.of(one.leak_rate) for one in known], "o-", color=BLUE, ms=3.2, label="leak rate")
    limit = allowed(known[0])
    if limit > 0:
        axes.axhline(unit.of(limit), color=ORANGE, linestyle="--", label="allowed by API 527")
    if found.opens is not None and math.isfinite(found.opens):
        axes.axvline(found.opens / found.pressure, color=GREY, label="opens")
    share, rate = "fluid pressure over set pressure", f"leak rate  [{unit.name}]"
    label(axes, "Leak up to the set pressure", share, rate, log="y", legend="upper left")
    return captioned(figure, "set_pressure", "all", found=found)


def _summary(result: SealSolution) -> dict[str, Any]:
    tests, found = map(_test_row, result.standard_tests), result.set_pressure
    return {
        "standard_tests": [dict(zip(STANDARD_TEST_COLUMNS, row, strict=True)) for row in tests] or None,
        "standard_verdict": worst_of(result.standard_tests) or None,
        "set_pressure": None if found is None else _in_summary(found),
    }


def _in_summary(found: SetPressure) -> dict[str, Any]:
    rows = (_share_row(found, one) for one in found.loads)
    return {
        "set_pressure_Pa": found.pressure,
        "contact_radius_m": found.radius,
        "spring_force_N": found.force,
        "blow_off_pressure_Pa": found.opens,
        "loads": [dict(zip(SET_PRESSURE_COLUMNS, row, strict=True)) for row in rows],
    }


def _page(result: SealSolution, display: Display) -> AnswerPage:
    words = in_words(result)
    return AnswerPage(
        first=[*filter(None, (standard_in_brief(result), spring_in_words(result)))],
        section=worded_section("standard_tests", words, tests_table(result), set_pressure_table(result)),
        details=words,
    )


SHOWN = Shown(
    lambda result: result.standard_tests or result.set_pressure,
    summary=_summary,
    absent=dict.fromkeys(("standard_tests", "standard_verdict", "set_pressure")),
    tables={
        "standard_tests.csv": lambda result: (
            STANDARD_TEST_COLUMNS,
            [_test_row(one) for one in result.standard_tests],
        ),
        "set_pressure.csv": lambda result: (
            SET_PRESSURE_COLUMNS,
            [_share_row(found, one) for found in filter(None, [result.set_pressure]) for one in found.loads],
        ),
    },
    pictures=lambda result: (set_pressure_picture(result),),
    page=_page,
)
