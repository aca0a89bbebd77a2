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
from fem_seal.output.shown import AnswerPage, decisive
from fem_seal.seal.findings import YIELD_STRESS, Level
from fem_seal.seal.load_result import MissingLoad, highest_load, load_axis, load_name, load_values
from fem_seal.units import leak_range_text, shared_flow_unit
from fem_seal.wording import join_names, phrase

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
    told = verdict.verdict_in_brief(result) or leak_in_brief(result.case, result.highest, result.every_load)
    return f"{told}{missing_in_brief(result)}"


def given_in_words(result: SealSolution) -> list[str]:
    """What the columns of a file with given contacts were taken for; empty where the contacts are solved.

    Parameters
    ----------
    result : SealSolution
    """
    return list(dict.fromkeys(one.remark for one in result.answers.get("profiles", ()) if one.remark))


def _contact_alone(result: SealSolution) -> str:
    """Width and peak pressure of the contact of a case without a leak rate, and why it has none."""
    missing, load = "roughness" if result.surface is None else "fluid", result.highest
    at, contact = load_values(load, result.every_load), _contact(load)
    return phrase("brief.first", "contact", load=at, contact=contact, missing=missing)


def _contact(load: CaseLoad) -> str:
    return f"{in_words(load, 'fwhm_m')} wide under {in_words(load, 'peak_pressure_Pa')} peak pressure"


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
    missing, found = result.missing_loads, result.judgement
    # one that decides the verdict is named with it
    if not missing or (found is not None and found.number is None and len(missing) == 1):
        return ""
    names = load_axis(result.every_load).names
    return phrase("brief.first", "missing", names=join_names([names[one.number] for one in missing]))


def leak_in_brief(case: Case, load: CaseLoad, loads: Sequence[AnyLoad]) -> str:
    """Leak rate of a load with its interval, and its classes.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    loads : sequence of CaseLoad or MissingLoad
        All of them.
    """
    at, found, volume = load_values(load, loads), load.validity, volume_of(case)
    if load.leak is None:
        return phrase("brief.first", "none", load=at)
    if found.outside_theory:
        return phrase("brief.first", "outside", load=at, reason=found.reasons[0])
    one_number = has_one_number(load)
    told_rate, digits = (
        (load.leak.leak_rate, min(load.leak_digits, 2)) if one_number else (rate_of(load), load.leak_digits)
    )
    rate = leak_range_text(told_rate, digits, volume=volume)
    classes = leakage_classes(case, load)
    met = ", ".join(str(one) for one in classes if one.name)
    ends = load.leak_interval or (load.leak.leak_rate,)
    sealed = not volume.measurable(max(ends))
    key = "tested" if load.after_test else "tight" if sealed else "leaks_published" if one_number else "leaks"
    told = phrase(
        "brief.first",
        key,
        load=f"{at}, with doubt" if found.level is Level.DOUBTFUL else at,
        rate=told_after_test(load, volume, rate) if load.after_test else rate,
    )
    return f"{told}; " + phrase("brief.first", "classes" if met else "no_class", met=met)


def second_line(result: SealSolution) -> str:
    """What would decide the verdict, or helps most, in one line; empty where nothing is known to.

    Parameters
    ----------
    result : SealSolution
    """
    load = decisive(result)
    told = (_ADVICE[key](result, load) for key in _ORDER[result.verdict])
    return next(filter(None, told), "")


def _force(result: SealSolution, load: CaseLoad) -> str:
    judged = [one for one in result.loads if one.judgement is not None] or [load]
    found = {one: None if one.verdict_force is None else one.verdict_force.force for one in judged}
    forces = [(force, one) for one, force in found.items() if force is not None]
    if len(forces) < len(found):
        return ""
    force, where = max(forces, key=lambda one: one[0])
    return phrase("brief.second", "force", load=where, force=verdict.force_to_pass(force))


def _curve(result: SealSolution, load: CaseLoad) -> str:
    worst = load.validity.cautions[:1]
    yields = load.validity.outside_theory and worst[0].kind == YIELD_STRESS
    if not yields:
        return ""
    # the strip that carries the line load with Prandtl's pressure, some three times the yield stress
    strengths = [one.yield_stress for one in result.problem.materials.values() if one.yield_stress]
    width = load.line_load / (3.0 * min(strengths))
    coins = width / 2.0 > LARGEST_TURNING * load.contact.model.relative_radius and not result.case.gasket
    return phrase("brief.second", "land" if coins else "curve_needed", width=width)


def _strength(result: SealSolution, load: CaseLoad) -> str:
    unknown = any(one.yield_stress is None for one in result.problem.materials.values())
    yields = any(one.kind == YIELD_STRESS for one in load.validity.cautions)
    return phrase("brief.second", "strength") if unknown and yields else ""


def _stop(result: SealSolution, load: CaseLoad) -> str:
    return phrase("brief.second", "stop", load=load) if load.stop_force else ""


def _share(result: SealSolution, load: CaseLoad) -> str:
    found = largest_share(result, result.loads.index(load))
    if found is None:
        return ""
    return phrase("brief.second", "share", name=found[0], share=found[1], at=load_name(load, result.loads))


def _use_in_words(result: SealSolution, load: CaseLoad) -> str:
    used = "" if result.judgement is None else verdict.used_in_words(result, result.judgement.shares)
    return phrase("brief.second", "used", used=used) if used else ""


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
    "none": lambda result, load: phrase("brief.second", "contact" if load.leak is None else "none"),
    "ask": lambda result, load: "" if result.sensitivities else phrase("brief.second", "ask"),
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
        known = [n for n in kept if margins[n] is not None and not math.isnan(margins[n] or 0.0)]
        worst = min(known, key=lambda n: margins[n] or 0.0) if known else highest_load(loads)
        kept = sorted({*few(len(loads), _FEW_ROWS), worst})
    shown = [loads[n] for n in kept]
    columns = _most_telling(case, shown)
    table = columns_table(columns, none="none")
    numbered = load_axis(loads).returns
    marks = ["" if isinstance(load, MissingLoad) else load.validity.level.mark for load in shown]
    rows = (
        (f"{mark} {n + 1}: {first}" if numbered else f"{mark} {first}".lstrip(), *others)
        for n, mark, (first, *others) in zip(kept, marks, table.rows, strict=True)
    )
    return ReadableTable(table.headings, tuple(rows)), len(loads) - len(kept)


def _most_telling(case: Case, loads: Sequence[AnyLoad]) -> list[ReportColumn]:
    """Columns that have a value and tell something of their own, without those that are spared first."""
    found = [load for load in loads if isinstance(load, CaseLoad)]
    without = {"leak_rate_m3_per_s" if any(load.after_test for load in found) else "leak_rate_p50_m3_per_s"}
    if len({load.applied_force for load in loads}) == 1:
        without.add("applied_force_N")
    names = [name for name in SHOWN_COLUMNS["brief"] if name not in without]
    filled = filled_columns(case, names, loads)
    told = (
        one
        for one in (_clear_unclaimed(_finite(one), case, loads) for one in filled)
        if one.some and (any(one.values) or one.column.kind == "flow")
    )
    columns = list(_leaks_in_one_unit(told))
    ends = [one.values for one in columns if one.column.name in _ENDS]
    columns = [
        one for one in columns if one.column.name in _ENDS or not any(_repeats_end(one, end) for end in ends)
    ]
    for name in SHOWN_COLUMNS["spared"]:
        if len(columns) > MOST_COLUMNS:
            columns = [one for one in columns if one.column.name != name]
    return columns


_ENDS = ("leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s")


def _finite(column: ReportColumn) -> ReportColumn:
    values = [value if value is not None and math.isfinite(value) else None for value in column.values]
    return replace(column, values=values, digits=[min(one, _DIGITS) for one in column.digits])


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


def _leaks_in_one_unit(columns: Iterable[ReportColumn]) -> Iterator[ReportColumn]:
    """Columns whose leak rates share the unit of the sentences."""
    known = list(columns)
    rates = [rate for one in known if one.column.kind == "flow" for rate in one.values if rate is not None]
    unit = shared_flow_unit(rates)
    for one in known:
        yield replace(one, given_unit=unit) if one.column.kind == "flow" else one


def remarks_in_brief(result: SealSolution) -> dict[str, str]:
    """The warnings as clauses, the worst first, with where they are, what they mean and what helps.

    Of the force for a target not what is said of the loads already.

    Parameters
    ----------
    result : SealSolution
    """
    display = result.case.display
    known = {one.text(display): one for one in all_cautions(result.answers)}
    kinds, target = {one.kind for one in FINDINGS.of(result.answers).cautions}, TARGET.of(result.answers)
    again = {one.text(display) for one in target.remarks if one.kind in kinds} if target else set()
    told: dict[str, str] = {}
    for text in result.warnings:
        if text in known and text not in again:
            found = known[text]
            place = found.place(display)
            texts = (f"{place[:1].upper()}{place[1:]}", found.remedy(display))
            told.setdefault(found.reason(display), ". ".join(filter(None, texts)))
        elif text not in again:
            told.setdefault(text, "")
    return told
