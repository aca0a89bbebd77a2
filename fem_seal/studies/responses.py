"""Responses of a design; nothing is written or drawn.

Every number of a row depends on that design alone - never on the designs calculated before it in the same process -,
so that a study gives the same table in whatever order and on however many workers it runs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

# the time limit is that of designs, not of loading what some of them need
import scipy.interpolate  # noqa: F401

from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.answer import Answer, Request, loads_of
from fem_seal.answers.bolts import BOLTS
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.chain import solve
from fem_seal.answers.findings import FINDINGS
from fem_seal.answers.judgement import PassProbability, Verdict
from fem_seal.answers.opening import OPENING
from fem_seal.answers.pass_probability import PASS_PROBABILITY, pass_probabilities
from fem_seal.answers.solution import answer_parts
from fem_seal.answers.target import TARGET
from fem_seal.answers.uncertainty import UNCERTAINTY
from fem_seal.answers.variants import OWN_CONTACTS
from fem_seal.answers.verdict import VERDICT, VERDICT_FORCE, load_verdict
from fem_seal.case.case import Case
from fem_seal.errors import SealError, error_text
from fem_seal.output.columns import COLUMNS
from fem_seal.seal.evaluate import SILENT, Batch, Evaluation, evaluate_many
from fem_seal.seal.findings import NOT_JUDGED, Level, Validity, remark
from fem_seal.seal.heating import with_contact_temperatures
from fem_seal.seal.problem import problems_of
from fem_seal.seal.scenarios import BESIDE, SCENARIOS, leak_rate_column
from fem_seal.seal.sources import OWN_BODIES, SharedBodies, Source, family_or_own_table
from fem_seal.studies.cost import FORCE_FOR_VERDICT, INTERVAL, PASS_COLUMNS, is_of_bolts, is_target
from fem_seal.validity.checks import validity_of
from fem_seal.wording import Words
from leak import LeakError
from meshes import GeometryError, MeshingError

# A margin counts up to here: a sealed design, whose margin is infinite, can be compared with others.
LARGEST_MARGIN = 1e6
_OF_SCENARIOS = {"margin", *PASS_COLUMNS, *map(leak_rate_column, BESIDE)}
_OWN_CONTACTS = {leak_rate_column(name) for name, words in SCENARIOS.items() if words.own_contact}
# What keeps one response from being calculated; the others of its design have nothing to do with it.
_FAILURES = (SealError, LeakError, GeometryError, MeshingError, ArithmeticError)
Load = TypeVar("Load", bound=CaseLoad)
Value = TypeVar("Value")
Default = TypeVar("Default")
_FOR_VERDICT = (
    *(ACCURACY, OPENING, TARGET, BOLTS, FINDINGS, UNCERTAINTY, PASS_PROBABILITY, VERDICT_FORCE, VERDICT),
)
_SOURCES = {
    (stress, interpolate): SharedBodies(
        stress=stress, tables=family_or_own_table if interpolate else OWN_BODIES.table
    )
    for stress in (False, True)
    for interpolate in (False, True)
}


@dataclass(frozen=True)
class DesignResult:
    """What a design gives.

    Parameters
    ----------
    values : dict
        Columns of leak.csv, SI.
    validity : Validity
        How far they can be trusted, by the checks of the load itself: errors of the mesh and of the far field are
        found once per geometry and are no part of it.
    verdict : Verdict or None
        On the case's requirement; None where its margin is not among the columns.
    """

    values: dict[str, float]
    validity: Validity
    verdict: Verdict | None = None


def evaluate_design(case: Case, columns: Sequence[str], *, interpolate: bool = True) -> DesignResult:
    """Columns of leak.csv for a case with one load, and their validity.

    Parameters
    ----------
    case : Case
        With one fluid pressure.
    columns : sequence of str
        Names of `fem_seal.output.tables.LEAK_COLUMNS`. Most cost milliseconds once geometry and surface are known;
        `fem_seal.studies.cost` estimates what bodies that yield, heat, a form error and answers such as the interval of
        uncertain inputs take beyond that.
    interpolate : bool
        Whether flow conductivities of surfaces that differ in height, hardness or modulus alone may be interpolated,
        see `fem_seal.seal.conductivity_tables`.

    Raises
    ------
    ConvergenceError, GeometryError, MeshingError
    """
    batch = Batch()
    results = evaluate_designs(batch, {0: case}, columns, interpolate=interpolate)
    for error in batch.failed.values():
        raise error
    return results[0]


def evaluate_designs(
    batch: Batch, cases: Mapping[int, Case], columns: Sequence[str], *, interpolate: bool = True
) -> dict[int, DesignResult]:
    """`evaluate_design` of several cases, which share their contact calculations; without those that fail.

    Parameters
    ----------
    batch : Batch
        Keeps time and failures of each.
    cases : mapping
        By number.
    columns, interpolate
        See `evaluate_design`.
    """
    if FORCE_FOR_VERDICT in columns:
        return batch.map(cases, lambda number: _with_verdict_force(cases[number], columns))
    cases = batch.map(cases, lambda number: with_contact_temperatures(cases[number]))
    problems = batch.map(cases, lambda number: problems_of(cases[number]))
    sources = {n: (_source(cases[n], columns, interpolate),) * len(each) for n, each in problems.items()}
    evaluations = evaluate_many(problems, sources, batch)
    loads = batch.map(evaluations, lambda number: _add_answers(evaluations[number], cases[number], columns))
    # for the checks alone the table would take too long
    with_chance, with_scenarios = not PASS_COLUMNS.isdisjoint(columns), not _OF_SCENARIOS.isdisjoint(columns)
    leaks = with_chance or any(column.startswith(("leak_rate", "lift_off", "margin")) for column in columns)
    if leaks:
        for step in _leaks(with_scenarios=with_scenarios):
            batch.map(loads, lambda number: _calculate_or_default(lambda: step(loads[number]), None))  # noqa: B023
    loads_judged = batch.map(
        loads,
        lambda n: _check_validity(
            evaluations[n], loads[n], cases[n], columns, leaks=leaks, interpolate=interpolate
        ),
    )
    return batch.map(loads_judged, lambda number: _result(loads_judged[number], columns))


def _source(case: Case, columns: Sequence[str], interpolate: bool) -> Source:
    """Where a design's bodies come from: a mesh of its own costs little beside samples of its inputs."""
    if case.sampling is not None and not INTERVAL.isdisjoint(columns):
        return OWN_BODIES
    can_yield = any(body.table.material.yield_stress for body in case.every_body)
    stress = can_yield or not {"max_von_mises_Pa", "max_accumulated_plastic_strain"}.isdisjoint(columns)
    return _SOURCES[stress, interpolate]


def _add_answers(evaluations: Sequence[Evaluation], case: Case, columns: Sequence[str]) -> CaseLoad:
    """The only load of a design with the answers that its columns need."""
    answers: list[Answer[Any]] = [OPENING]
    if any(map(is_target, columns)):
        answers.append(TARGET)
    if any(map(is_of_bolts, columns)):
        answers.append(BOLTS)
    if not _OWN_CONTACTS.isdisjoint(columns):
        answers.append(OWN_CONTACTS)
    if evaluations[0].seal_mesh is not None and not INTERVAL.isdisjoint(columns):
        answers.append(ACCURACY)
    return answer_parts(
        SolvedSeal.of(evaluations, case, loads_of(evaluations)),
        Request(evaluations[0].solver, SILENT),
        answers,
    ).loads[0]


def _check_validity(
    evaluations: Sequence[Evaluation],
    load: CaseLoad,
    case: Case,
    columns: Sequence[str],
    *,
    leaks: bool,
    interpolate: bool,
) -> CaseLoad:
    """A load with its validity, the samples of its inputs and what is said of it, as far as columns ask."""
    with_samples = case.sampling is not None and not INTERVAL.isdisjoint(columns)
    with_chance = not PASS_COLUMNS.isdisjoint(columns)
    usual_only = leaks and not (with_samples or with_chance)
    by_table = partial(validity_of, by_table=leaks and interpolate)
    judge = partial(load.validity_by, partial(by_table, usual_only=usual_only), evaluations)
    load = load.with_values(validity=_calculate_or_default(judge, NOT_JUDGED))
    has_interval = True
    if with_samples:
        request = Request(evaluations[0].solver, SILENT)
        (load,) = answer_parts(SolvedSeal.of(evaluations, case, [load]), request, [UNCERTAINTY]).loads
        has_interval = UNCERTAINTY.of(request.answers) is not None
        if not has_interval:
            judge = partial(load.validity_by, partial(by_table, usual_only=True), evaluations)
            load = load.with_values(validity=_calculate_or_default(judge, NOT_JUDGED))
    judgement = (
        _calculate_or_default(partial(load_verdict, case, load, complete=has_interval), None)
        if "margin" in columns
        else None
    )
    chance: PassProbability | None = None
    if with_chance:
        try:
            (chance,) = pass_probabilities(SolvedSeal.of(evaluations, case, [load]))
        except _FAILURES as error:
            if PASS_COLUMNS.issuperset(columns):
                raise
            load = _drop_column("pass_probability", error, load)
    return load.with_values(judgement=judgement, chance=chance)


def _drop_column(column: str, error: Exception, load: Load) -> Load:
    """A load of which one column could not be calculated."""
    why = error if isinstance(error, SealError) else error_text(error)
    text = Words("{{ column }} could not be calculated: {{ why }}", {"column": column, "why": why})
    cautions = (*load.validity.cautions, remark("not calculated", Level.DOUBTFUL, text))
    return load.with_values(validity=Validity.of(cautions))


def _calculate_or_default(calculate: Callable[[], Value], otherwise: Default) -> Value | Default:
    """What `calculate` gives or, where that cannot be calculated, `otherwise`."""
    with suppress(*_FAILURES):
        return calculate()
    return otherwise


def _validity(load: CaseLoad, columns: Sequence[str]) -> Validity:
    """How far the numbers of a design can be trusted; its mesh and, if it is asked for, its force for the target."""
    cautions = load.validity.without_kinds("mesh").cautions
    if any(map(is_target, columns)) and load.target_validity is not None:
        # here the force is what the design is judged by
        cautions += load.target_validity.cautions
    return Validity.of(cautions)


def _leaks(*, with_scenarios: bool) -> Iterator[Callable[[CaseLoad], object]]:
    """Leak rate of a load, and those of the scenarios beside, each kind of work by itself."""

    def all_scenarios(load: CaseLoad) -> tuple[CaseLoad, ...]:
        return (load, *(load.others.values() if with_scenarios else ()))

    yield lambda load: [scenario.rough and scenario.rough.table for scenario in all_scenarios(load)]
    yield lambda load: [profile_load.contact for profile_load in load.profiles]
    yield lambda load: [profile_load.contact.panels for profile_load in load.profiles]
    yield lambda load: [scenario.leak for scenario in all_scenarios(load)]


def _result(load: CaseLoad, columns: Sequence[str]) -> DesignResult:
    values, errors = dict[str, float](), list[Exception]()
    for column in columns:
        try:
            values[column] = COLUMNS[column].number(load)
        except _FAILURES as error:
            values[column] = math.nan
            errors.append(error)
            load = _drop_column(column, error, load)
    if errors and all(map(math.isnan, values.values())):
        raise errors[0]
    if "margin" in values:
        values["margin"] = min(values["margin"], LARGEST_MARGIN)
    return DesignResult(values, _validity(load, columns), load.verdict)


def _with_verdict_force(case: Case, columns: Sequence[str]) -> DesignResult:
    """Of the force with which the verdict passes every force that is tried takes a run of its own."""
    answers = _FOR_VERDICT if _OWN_CONTACTS.isdisjoint(columns) else (OWN_CONTACTS, *_FOR_VERDICT)
    result = solve(case, verdict_force=True, answers=answers)
    return _result(result.loads[0], columns)
