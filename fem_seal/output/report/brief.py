"""A result in brief, with which terminal and report begin: verdict, what decides it, and a table of six columns."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from fem_seal.answers.case_load import AnyLoad, CaseLoad, rate_of
from fem_seal.answers.findings import FINDINGS, all_cautions
from fem_seal.answers.judgement import Verdict
from fem_seal.answers.leakage_class import leakage_classes, volume_of
from fem_seal.answers.target import TARGET
from fem_seal.loads import LARGEST_TURNING
from fem_seal.output.answer_output import AnswerPage, decisive
from fem_seal.output.answers import verdict
from fem_seal.output.answers.error_shares import largest_share, measurement_in_brief
from fem_seal.output.answers.sensitivities import change_in_brief
from fem_seal.output.answers.uncertainty import told_after_test
from fem_seal.output.answers.variants import beside_in_brief, has_one_number, supported_by
from fem_seal.output.columns import (
    MOST_COLUMNS,
    SHOWN_COLUMNS,
    ReadableTable,
    ReportColumn,
    columns_table,
    filled_columns,
    in_words,
)
from fem_seal.output.pictures.style import few
from fem_seal.seal.findings import YIELD_STRESS, Level
from fem_seal.seal.load_result import MissingLoad, highest_load, load_axis, load_name, load_values
from fem_seal.units import Display
from fem_seal.wording import join_names, say

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case

# Rows of the table, those of one that is shortened, and digits.
_ROWS, _FEW_ROWS, _DIGITS = 8, 4, 3


def first_line(result: SealSolution) -> str:
    """The verdict in one line; without a requirement the leak rate and its class.

    Parameters
    ----------
    result : SealSolution
    """
    if result.highest.leak is None and result.judgement is None:
        return f"{_contact_alone(result)}{missing_in_brief(result)}"
    line = verdict.verdict_in_brief(result) or leak_in_brief(result.case, result.highest, result.every_load)
    return f"{line}{missing_in_brief(result)}"


def given_in_words(result: SealSolution) -> list[str]:
    """What the columns of a file with given contacts were taken for; empty where the contacts are solved.

    Parameters
    ----------
    result : SealSolution
    """
    return list(dict.fromkeys(leak.remark for leak in result.answers.get("profiles", ()) if leak.remark))


def _contact_alone(result: SealSolution) -> str:
    """Width and peak pressure of the contact of a case without a leak rate, and why it has none."""
    missing, load = "roughness" if result.surface is None else "fluid", result.highest
    at = load_values(load, result.every_load, result.display)
    width, peak = (in_words(result.display, load, name) for name in ("fwhm_m", "peak_pressure_Pa"))
    words = {"width": width, "peak": peak, "missing": missing, "dry": result.case.load.is_dry}
    return say(result.display, "brief", "first_contact", load=at, **words)


def lines_in_brief(result: SealSolution, pages: Sequence[AnswerPage]) -> list[str]:
    """The verdict, what the case asks for in so many words, and what would decide, a line each.

    Parameters
    ----------
    result : SealSolution
    pages : sequence of AnswerPage
        Of all answers.
    """
    asked, support = (line for page in pages for line in page.first), supported_by(result)
    lines = (first_line(result), *beside_in_brief(result), *asked, second_line(result), *support)
    return list(filter(None, lines))


def missing_in_brief(result: SealSolution) -> str:
    """Which loads could not be calculated, as the end of a sentence; empty if all could.

    Parameters
    ----------
    result : SealSolution
    """
    display = result.display
    missing, judgement = result.missing_loads, result.judgement
    # one that decides the verdict is named with it
    if not missing or (judgement is not None and judgement.number is None and len(missing) == 1):
        return ""
    names = load_axis(result.every_load, display).names
    return say(display, "brief", "first_missing", names=join_names([names[load.number] for load in missing]))


def leak_in_brief(case: Case, load: CaseLoad, loads: Sequence[AnyLoad]) -> str:
    """Leak rate of a load with its interval, and its classes.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    loads : sequence of CaseLoad or MissingLoad
        All of them.
    """
    at, validity, volume = load_values(load, loads, case.display), load.validity, volume_of(case)
    if load.leak is None:
        return say(case.display, "brief", "first_none", load=at)
    if validity.outside_theory:
        reason, *_ = validity.reasons_in(case.display)
        return say(case.display, "brief", "first_outside", load=at, reason=reason)
    one_number = has_one_number(load)
    told_rate, digits = (
        (load.leak.leak_rate, min(load.leak_digits, 2)) if one_number else (rate_of(load), load.leak_digits)
    )
    rate = case.display.leak_range(told_rate, digits, volume=volume)
    sealed = not volume.measurable(max(load.leak_interval or (load.leak.leak_rate,)))
    return say(
        case.display,
        "brief",
        "first_leak",
        kind="tested" if load.after_test else "sealed" if sealed else "published" if one_number else "",
        load=at,
        doubt=validity.level is Level.DOUBTFUL,
        rate=told_after_test(case.display, load, volume, rate) if load.after_test else rate,
        classes=[str(grade) for grade in leakage_classes(case, load) if grade.name],
    )


def second_line(result: SealSolution) -> str:
    """What would decide the verdict, or helps most, in one line; empty where nothing is known to.

    Parameters
    ----------
    result : SealSolution
    """
    load = decisive(result)
    lines = (_ADVICE[key](result, load) for key in _ORDER[result.verdict])
    return next(filter(None, lines), "")


def _force(result: SealSolution, load: CaseLoad) -> str:
    display = result.display
    judged_loads = [entry for entry in result.loads if entry.judgement is not None] or [load]
    forces = {entry: entry.verdict_force.force for entry in judged_loads if entry.verdict_force is not None}
    known_forces = {entry: force for entry, force in forces.items() if force is not None}
    if len(known_forces) < len(judged_loads):
        return ""
    where = max(known_forces, key=known_forces.__getitem__)
    force = verdict.force_to_pass(display, known_forces[where])
    return say(display, "brief", "second_force", load=where, force=force)


def _curve(result: SealSolution, load: CaseLoad) -> str:
    worst = load.validity.cautions[:1]
    yields = load.validity.outside_theory and worst[0].kind == YIELD_STRESS
    if not yields:
        return ""
    # the strip that carries the line load with Prandtl's pressure, some three times the yield stress
    strengths = [metal.yield_stress for metal in result.problem.materials.values() if metal.yield_stress]
    width = load.line_load / (3.0 * min(strengths))
    coins = width / 2.0 > LARGEST_TURNING * load.contact.model.relative_radius and not result.case.gasket
    return say(result.display, "brief", f"second_{'land' if coins else 'curve_needed'}", width=width)


def _strength(result: SealSolution, load: CaseLoad) -> str:
    unknown = any(material.yield_stress is None for material in result.problem.materials.values())
    yields = any(caution.kind == YIELD_STRESS for caution in load.validity.cautions)
    return say(result.display, "brief", "second_strength") if unknown and yields else ""


def _stop(result: SealSolution, load: CaseLoad) -> str:
    return say(result.display, "brief", "second_stop", load=load) if load.stop_force else ""


def _share(result: SealSolution, load: CaseLoad) -> str:
    display = result.display
    largest = largest_share(result, result.loads.index(load))
    if largest is None:
        return ""
    name, share = largest
    return say(
        display, "brief", "second_share", name=name, share=share, at=load_name(load, result.loads, display)
    )


def _use_in_words(result: SealSolution, load: CaseLoad) -> str:
    used = "" if result.judgement is None else verdict.used_in_words(result, result.judgement.shares)
    return say(result.display, "verdict", "used_all", used=used).rstrip(".")


_ADVICE: dict[str, Callable[[SealSolution, CaseLoad], str]] = {
    "profile": lambda result, load: verdict.would_pass(result),
    "measure": lambda result, load: (
        measurement_in_brief(result, result.loads.index(load))
        if any(shares.is_telling for shares in result.error_shares)
        else ""
    ),
    "helps": lambda result, load: change_in_brief(result, load) if result.sensitivities else "",
    "force": _force,
    "curve": _curve,
    "stop": _stop,
    "strength": _strength,
    "class": lambda result, load: verdict.next_class_in_words(result.case, load),
    "share": lambda result, load: (
        _share(result, load) if any(shares.is_telling for shares in result.error_shares) else ""
    ),
    "used": _use_in_words,
    "none": lambda result, load: say(
        result.display,
        "brief",
        f"second_{'contact' if load.leak is None else 'none'}",
        dry=result.case.load.is_dry,
    ),
    "ask": lambda result, load: "" if result.sensitivities else say(result.display, "brief", "second_ask"),
}
# What is told after each verdict, the first that is known.
_FAILS = ("helps", "force", "stop", "measure", "ask", "used")
_OPEN = ("curve", "profile", "measure", "helps", "force", "stop", "share", "used")
_ORDER: dict[Verdict | None, Sequence[str]] = {
    Verdict.PASS: ("strength", "share", "used"),
    Verdict.PASS_UNLESS: _OPEN,
    Verdict.INCONCLUSIVE: _OPEN,
    Verdict.FAIL_UNLESS: _FAILS,
    Verdict.FAIL: _FAILS,
    None: ("curve", "helps", "measure", "class", "stop", "share", "force", "none"),
}


def loads_in_brief(case: Case, loads: Sequence[AnyLoad]) -> tuple[ReadableTable, int]:
    """The loads with the columns that matter most, at most six, and the number of loads that are left out.

    Of many loads the first, the last and the one with the highest fluid pressure or the smallest margin are among those
    that are kept.

    Parameters
    ----------
    case : Case
    loads : sequence of CaseLoad or MissingLoad
    """
    kept = list(range(len(loads)))
    if len(loads) > _ROWS:
        margins = [load.margin if isinstance(load, CaseLoad) else None for load in loads]
        with_margin = [n for n in kept if margins[n] is not None and not math.isnan(margins[n] or 0.0)]
        worst = min(with_margin, key=lambda n: margins[n] or 0.0) if with_margin else highest_load(loads)
        kept = sorted({*few(len(loads), _FEW_ROWS), worst})
    kept_loads = [loads[n] for n in kept]
    columns = _most_telling(case, kept_loads)
    table = columns_table(columns, none="none")
    numbered = load_axis(loads, case.display).returns
    marks = ["" if isinstance(load, MissingLoad) else load.validity.level.mark for load in kept_loads]
    rows = (
        (f"{mark} {n + 1}: {first}" if numbered else f"{mark} {first}".lstrip(), *others)
        for n, mark, (first, *others) in zip(kept, marks, table.rows, strict=True)
    )
    return ReadableTable(table.headings, tuple(rows)), len(loads) - len(kept)


def _most_telling(case: Case, loads: Sequence[AnyLoad]) -> list[ReportColumn]:
    """Columns that have a value and tell something of their own, without those that are spared first."""
    results = [load for load in loads if isinstance(load, CaseLoad)]
    without = {"leak_rate_m3_per_s" if any(load.after_test for load in results) else "leak_rate_p50_m3_per_s"}
    if len({load.applied_force for load in loads}) == 1:
        without.add("applied_force_N")
    names = [name for name in SHOWN_COLUMNS["brief"] if name not in without]
    filled = filled_columns(case, names, loads)
    telling = (
        column
        for column in (_clear_unclaimed(_finite(column), case, loads) for column in filled)
        if column.some and (any(column.values) or column.column.kind == "flow")
    )
    columns = list(_leaks_in_one_unit(case.display, telling))
    ends = [column.values for column in columns if column.column.name in _ENDS]
    columns = [
        column
        for column in columns
        if column.column.name in _ENDS or not any(_repeats_end(column, end) for end in ends)
    ]
    for name in SHOWN_COLUMNS["spared"]:
        if len(columns) > MOST_COLUMNS:
            columns = [column for column in columns if column.column.name != name]
    return columns


_ENDS = ("leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s")


def _finite(column: ReportColumn) -> ReportColumn:
    values = [value if value is not None and math.isfinite(value) else None for value in column.values]
    return replace(column, values=values, digits=[min(digits, _DIGITS) for digits in column.digits])


def _clear_unclaimed(column: ReportColumn, case: Case, loads: Sequence[AnyLoad]) -> ReportColumn:
    """Outside the theory without leak rates of zero, which read as a tight seal, and intervals without samples."""
    name, values = column.column.name, list(column.values)
    for n, load in enumerate(loads):
        if isinstance(load, MissingLoad):
            continue
        open_inputs = case.sampling is not None and load.sample_ends is None
        tight = column.column.kind == "flow" and not values[n]
        if load.validity.outside_theory and (tight or (open_inputs and name in (*_ENDS, "margin"))):
            values[n] = None
    return replace(column, values=values)


def _repeats_end(column: ReportColumn, end: Sequence[float | None]) -> bool:
    """Whether a column repeats an end of the interval."""
    pairs = zip(column.values, end, strict=True)
    return all(
        a == b or (a is not None and b is not None and math.isclose(a, b, rel_tol=1e-3)) for a, b in pairs
    )


def _leaks_in_one_unit(display: Display, columns: Iterable[ReportColumn]) -> Iterator[ReportColumn]:
    """Columns whose leak rates share the unit of the sentences."""
    all_columns = list(columns)
    flows = [column.values for column in all_columns if column.column.kind == "flow"]
    unit = display.shared_flow_unit([rate for rates in flows for rate in rates if rate is not None])
    for column in all_columns:
        yield replace(column, given_unit=unit) if column.column.kind == "flow" else column


def remarks_in_brief(result: SealSolution) -> dict[str, str]:
    """The warnings as clauses, the worst first, with where they are, what they mean and what helps; that once.

    Of the force for a target not what is said of the loads already.

    Parameters
    ----------
    result : SealSolution
    """
    display = result.display
    caution_of = {caution.text(display): caution for caution in all_cautions(result.answers)}
    kinds = {caution.kind for caution in FINDINGS.of(result.answers).cautions}
    target, entries = TARGET.of(result.answers), set[str]()
    again = {remark.text(display) for remark in target.remarks if remark.kind in kinds} if target else set()
    clauses: dict[str, str] = {}
    for text in result.warnings:
        if text in caution_of and text not in again:
            caution = caution_of[text]
            place, remedy = caution.place(display), caution.remedy(display, again=caution.entry in entries)
            clauses.setdefault(
                caution.reason(display), ". ".join(filter(None, (f"{place[:1].upper()}{place[1:]}", remedy)))
            )
            entries.add(caution.entry)
        elif text not in again:
            clauses.setdefault(text, "")
    return clauses
