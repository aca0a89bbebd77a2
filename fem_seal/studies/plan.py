"""Plan of a study: case, parameters, designs and formulas, checked before anything runs."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.case.case import Case
from fem_seal.case.fields import show
from fem_seal.case.notation import same_entry
from fem_seal.case.paths import Value
from fem_seal.errors import InputError
from fem_seal.files import problem
from fem_seal.output.columns import COLUMNS, LEAK_COLUMNS, in_full
from fem_seal.sampling import LogNormal, Normal
from fem_seal.seal.scenarios import BESIDE, leak_rate_column
from fem_seal.studies.designs import SENSITIVITY
from fem_seal.studies.expressions import Constraint, Expression, ExpressionError, unknown_name
from fem_seal.studies.tables import (
    Design,
    Optimise,
    Parameter,
    Report,
    Run,
    StudyTables,
    design_text,
    entries,
)

F = TypeVar("F", Expression, Constraint)


class StudyPlan:
    """One case, the entries that vary, the designs, and what is wanted of each; `Study` reads one."""

    file: Path | None
    """Study file, None if made in code."""
    written: dict[str, Any]
    """The tables of the study as they were given."""
    title: str
    design: Design
    run_settings: Run
    report: Report
    keeps_outside: bool
    """Whether designs outside the theory count like any other."""
    optimise: Optimise | None
    parameters: tuple[Parameter, ...]
    points: FloatArray
    """Designs, shape (designs, parameters), as the numbers of `Parameter.value`; none of an optimisation."""
    files: dict[str, str]
    """Files that the designs are made of, with hashes of their contents."""
    derived: dict[str, Expression]
    constraints: dict[str, Constraint]
    goals: dict[str, Expression]
    """What is minimised: the goals of the optimisation, or of the report; large ones with a minus sign."""
    responses: tuple[str, ...]
    """Columns of leak.csv that are calculated."""
    companions: tuple[str, ...]
    """Those of them that only stand beside others: no plot and no index is theirs."""
    case: Case
    """The base case with the study's changes."""

    @property
    def names(self) -> list[str]:
        """Paths of the parameters."""
        return [parameter.name for parameter in self.parameters]

    @property
    def output_names(self) -> list[str]:
        """Names of all columns that follow from a design."""
        return [*self.responses, *self.derived]

    def values(self, point: Sequence[float] | FloatArray) -> dict[str, Value]:
        """Value of each parameter in a design, SI, texts as they are."""
        return {
            parameter.name: parameter.value(number)
            for parameter, number in zip(self.parameters, point, strict=True)
        }

    def case_of(self, point: Sequence[float] | FloatArray) -> Case:
        """The case of a design.

        Raises
        ------
        InputError
            If the design contradicts itself.
        """
        return self.case.replace_written(entries(self.parameters, point))


# Columns of the study's own table.
RESERVED_NAMES = ("number", "status", "reason", "seconds", "key", "validity", "validity_reasons", "verdict")


def read_formulas(
    study: StudyPlan, texts: Mapping[str, str], responses: Sequence[str]
) -> dict[str, Expression]:
    """Derived columns; each may use those above it.

    Raises
    ------
    InputError
    """
    _check_responses(study, responses)
    names = [*study.names, *LEAK_COLUMNS, *RESERVED_NAMES]
    formulas: dict[str, Expression] = {}
    for name, text in texts.items():
        key = f"derived.{name}"
        _check_name(key, name, names)
        formulas[name] = _formula(Expression, key, text, list(formulas), study)
        names.append(name)
    return formulas


def read_constraints(study: StudyPlan, texts: Mapping[str, str]) -> dict[str, Constraint]:
    """Constraints over all columns.

    Raises
    ------
    InputError
    """
    constraints: dict[str, Constraint] = {}
    for name, text in texts.items():
        key = f"constraints.{name}"
        _check_name(key, name, [*study.names, *LEAK_COLUMNS, *RESERVED_NAMES, *study.derived])
        constraints[name] = _formula(Constraint, key, text, study.derived, study)
        _check_units(key, constraints[name], study)
    return constraints


def read_goals(study: StudyPlan, tables: StudyTables) -> dict[str, Expression]:
    """What is to be small, by its label; what is to be large counts with a minus sign.

    Raises
    ------
    InputError
    """
    if tables.optimise is None:
        requests = [(f"report.goals.{name}", name, way == "max") for name, way in tables.report.goals.items()]
    else:
        requests = [
            (f"optimise.{key}", text, key == "maximise")
            for key in ("minimise", "maximise")
            for text in _texts(getattr(tables.optimise, key))
        ]
        if not requests:
            raise InputError(problem("study_goal_missing"))
    if len(requests) > 2:
        raise InputError.at(requests[2][0], "is a third goal; allowed are one or two")
    goals: dict[str, Expression] = {}
    settings = study.case.uncertainty
    for key, words, large in requests:
        # of seals that show the readings of a leak test the inputs as given are none
        has_posterior = settings is not None and settings.posterior is not None
        text = in_full(words, [*study.names, *study.derived])
        text = re.sub(rf"\b{_LEAK_RATE}\b", _MEDIAN, text) if has_posterior else text
        formula = _formula(Expression, key, text, study.derived, study)
        if formula.text in goals:
            raise InputError.at(key, "is a goal already; remove one of them", show(text))
        goals[formula.text] = Expression(f"-({formula.text})") if large else formula
    return goals


# Where scenarios stand beside, a leak rate never stands without theirs.
_LEAK_RATE, _COMPANIONS = "leak_rate_m3_per_s", tuple(map(leak_rate_column, BESIDE))
# The verdict is a word, which stands in the table of the designs wherever its number does.
_VERDICT, _MARGIN = "verdict", "margin"
_MEDIAN = "leak_rate_p50_m3_per_s"
# Columns that are above zero and at most one.
_SHARES = ("pass_probability", "batch_share_p05")


def _missing_sources(study: StudyPlan, column: str) -> list[str]:
    """What no design has of what fills a column."""
    sources = COLUMNS[column].lacking(study.case, study.names)
    return [source for source in sources if source.startswith("[") or not COLUMNS[column].repeats]


def needed_columns(study: StudyPlan, responses: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Columns that are calculated, in the order of leak.csv, and those of them that nobody asked for.

    Asked for are responses and what formulas need; the others are shown beside them and not studied themselves.
    """
    requests = set(responses)
    for formula in (*study.derived.values(), *study.constraints.values(), *study.goals.values()):
        requests.update(formula.names)
    companions = {_MARGIN} if _VERDICT in requests else set()
    if _LEAK_RATE in requests:
        companions.update(name for name in _COMPANIONS if not _missing_sources(study, name))
    columns = tuple(name for name in LEAK_COLUMNS if name in requests | companions)
    return columns, tuple(name for name in columns if name not in requests)


def _texts(value: str | tuple[str, ...] | None) -> tuple[str, ...]:
    if value is None:
        return ()
    return (value,) if isinstance(value, str) else value


def _check_responses(study: StudyPlan, responses: Sequence[str]) -> None:
    for n, name in enumerate(responses):
        if name not in (*LEAK_COLUMNS, _VERDICT):
            unknown = unknown_name(name, list(LEAK_COLUMNS), "no column of leak.csv")
            raise InputError.at("responses", unknown, show(name))
        if name in responses[:n]:
            raise InputError.at("responses", f"names {name} twice; remove one")
        _check_possible("responses", name, study)


def _formula(kind: type[F], key: str, text: str, derived: Iterable[str], study: StudyPlan) -> F:
    """A formula over parameters, columns of leak.csv and derived columns."""
    try:
        formula = kind(in_full(text, [*study.names, *derived]))
    except ExpressionError as error:
        raise InputError.at(key, str(error), show(text)) from None
    columns = [*study.names, *LEAK_COLUMNS, *derived]
    for name in formula.names:
        if name not in columns:
            raise InputError.at(key, unknown_name(name, columns), show(text))
        words = [p for p in study.parameters if p.name == name and not p.numeric]
        if words:
            raise InputError.at(key, f"calculates with {name}, which holds words", show(text))
        _check_possible(key, name, study)
    return formula


def _check_units(key: str, constraint: Constraint, study: StudyPlan) -> None:
    """Two quantities that are compared as they are have to be of one kind."""
    units = {name: column.unit for name, column in COLUMNS.items()}
    units |= {p.name: p.entry.unit for p in study.parameters}
    first, last = (side.unit_of(units) for side in constraint.sides)
    if None not in (first, last) and first != last:
        kinds = " with ".join(f"a quantity in {unit}" if unit else "a plain number" for unit in (first, last))
        raise InputError.at(key, f"compares {kinds}", show(constraint.text))
    for share, bound in (constraint.sides, constraint.sides[::-1]):
        if share.what in _SHARES and not bound.names and bound.number({}) > 1.0:
            number, value = f"{bound.number({}):g}", show(constraint.text)
            raise InputError(problem("study_share", key=key, what=share.what, number=number, value=value))


def _check_possible(key: str, name: str, study: StudyPlan) -> None:
    """InputError if a column stays empty in every design."""
    sources = _missing_sources(study, name) if name in COLUMNS else ()
    if sources:
        raise InputError.at(key, f"{name} needs {sources[0]} in the base case")


def _check_name(key: str, name: str, names: Sequence[str]) -> None:
    if not name.isidentifier() or not name.isascii():
        raise InputError.at(key, "must be a word of letters, digits and underscores")
    if name.lower() in [column.lower() for column in names]:
        raise InputError.at(key, "is the name of another column; choose another one")


# So many designs are built as cases before the study starts; of larger studies the extreme ones and a sample.
_SAMPLE = 300


def check_changes(changes: Mapping[str, Any], paths: Sequence[str]) -> None:
    """InputError if an entry is changed and varied."""
    entries = {same_entry(path) for path in changes}
    duplicates = [path for path in paths if same_entry(path) in entries]
    if duplicates:
        raise InputError(problem("study_changed_and_varied", key=duplicates[0]))


def check_load(case: Case, paths: Collection[str]) -> None:
    """InputError if the case has several loads that no parameter replaces: a design has one."""
    pressures, forces = case.load.fluid_pressure, case.load.applied_force
    several = {}
    force_count = len(forces) if isinstance(forces, tuple) else 1
    # a single pressure stands there once for each force
    is_repeated = force_count > 1 and len(set(pressures)) == 1
    if len(pressures) > 1 and not is_repeated and "load.fluid_pressure" not in paths:
        several['"load.fluid_pressure" = "10 bar"'] = f"{len(pressures)} fluid pressures"
    if force_count > 1 and "load.applied_force" not in paths:
        several['"load.applied_force" = "0 N"'] = f"{force_count} applied forces"
    if several:
        loads, changes = " and ".join(several.values()), " and ".join(several)
        them = "it a parameter" if len(several) == 1 else "them parameters"
        raise InputError(problem("study_several_loads", loads=loads, changes=changes, them=them))


def check_design(design: Design, parameters: Sequence[Parameter], optimise: bool) -> None:
    """InputError if a design cannot be made of its parameters."""
    if not parameters:
        raise InputError(problem("study_no_parameters"))
    if design.file is not None:
        raise InputError(problem("study_file_without_list", file=show(design.file)))
    if optimise:
        _check_searched(parameters)
    elif design.kind == "grid":
        _check_grid(design, parameters)
    else:
        _check_sampled(design, parameters)


def _check_searched(parameters: Sequence[Parameter]) -> None:
    for parameter in parameters:
        if isinstance(parameter.distribution, (Normal, LogNormal)):
            raise InputError(problem("study_search_of_chance", key=parameter.name))


def _check_grid(design: Design, parameters: Sequence[Parameter]) -> None:
    for parameter in parameters:
        if parameter.distribution is not None:
            raise InputError(problem("study_grid_of_distribution", key=parameter.name))
    if design.num is not None:
        raise InputError(problem("study_grid_num"))


def _check_sampled(design: Design, parameters: Sequence[Parameter]) -> None:
    if design.num is None:
        raise InputError(problem("study_num_missing", kind=design.kind))
    if design.kind in SENSITIVITY and design.num < 2:
        raise InputError(problem("study_num_of_sensitivity", kind=design.kind, num=design.num))
    for parameter in parameters:
        if parameter.distribution is None and parameter.numeric:
            low, high = map(parameter.entry.show, parameter.bounds)
            words = problem(
                "study_sample_of_levels", key=parameter.name, kind=design.kind, low=low, high=high
            )
            raise InputError(words)


def check_kept(study: StudyPlan) -> None:
    """InputError if the designs whose complete results are wanted cannot exist."""
    choice = study.run_settings.keep_fields
    if choice == "best" and not study.goals:
        raise InputError(problem("study_best_without_goal", wanted=show(choice)))
    if isinstance(choice, str):
        return
    count = study.optimise.trials if study.optimise else len(study.points)
    for number in choice:
        if not 0 <= number < count:
            raise InputError(problem("study_no_such_design", last=count - 1, number=number))


def check_designs(study: StudyPlan) -> None:
    """InputError if a design is no valid case, unless such designs are to be left out."""
    if study.design.invalid == "skip":
        return
    for number in _extreme_designs(study):
        point = study.points[number]
        try:
            study.case_of(point)
        except InputError as error:
            fault, text = error.problems[0], design_text(study.parameters, point)
            words = problem("study_invalid_design", number=number, listed=text, found=fault)
            raise InputError(words) from None


def _extreme_designs(study: StudyPlan) -> Iterator[int]:
    """Designs that are built before the study starts: all of a small one, else extremes, corners and a sample."""
    points = study.points
    count = len(points)
    if count <= _SAMPLE:
        yield from range(count)
        return
    span = np.ptp(points, axis=0)
    place = (points - points.min(axis=0)) / np.where(span > 0, span, 1.0)
    numbers = {*place.argmin(axis=0).tolist(), *place.argmax(axis=0).tolist()}
    dimensions = min(place.shape[1], 6)
    for corner in np.ndindex(*([2] * dimensions)):
        signs = 2.0 * np.array(corner) - 1.0
        numbers.add(int(np.argmax(place[:, :dimensions] @ signs)))
    numbers.update(np.linspace(0, count - 1, _SAMPLE // 2).astype(int).tolist())
    yield from sorted(numbers)
