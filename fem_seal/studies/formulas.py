"""Names and formulas of a study: responses, derived columns, constraints and goals, each checked by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from fem_seal.case_fields import shown
from fem_seal.errors import InputError, Problem
from fem_seal.studies.expressions import Constraint, Expression, ExpressionError, unit_of, unknown_name
from fem_seal.tables import LEAK_COLUMNS, split_unit

if TYPE_CHECKING:
    from fem_seal.studies.study import Study
    from fem_seal.studies.study_tables import StudyTables

_INTERVAL = ("leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s")
# Columns of the study's own table.
RESERVED = ("number", "status", "reason", "seconds", "key", "validity", "validity_reasons")


def read_formulas(study: Study, given: Mapping[str, str], responses: Sequence[str]) -> dict[str, Expression]:
    """Derived columns; each may use those above it.

    Raises
    ------
    InputError
    """
    _check_responses(study, responses)
    taken = [*study.names, *LEAK_COLUMNS, *RESERVED]
    found: dict[str, Expression] = {}
    for name, text in given.items():
        key = f"derived.{name}"
        _check_name(key, name, taken)
        try:
            found[name] = Expression(text)
        except ExpressionError as error:
            raise InputError(Problem(key, str(error), shown(text))) from None
        _check_known(key, text, found[name].names, [*study.names, *LEAK_COLUMNS, *list(found)[:-1]], study)
        taken.append(name)
    return found


def read_constraints(study: Study, given: Mapping[str, str]) -> dict[str, Constraint]:
    """Constraints over all columns.

    Raises
    ------
    InputError
    """
    found: dict[str, Constraint] = {}
    for name, text in given.items():
        key = f"constraints.{name}"
        _check_name(key, name, [*study.names, *LEAK_COLUMNS, *RESERVED, *study.derived])
        try:
            found[name] = Constraint(text)
        except ExpressionError as error:
            raise InputError(Problem(key, str(error), shown(text))) from None
        _check_known(key, text, found[name].names, [*study.names, *LEAK_COLUMNS, *study.derived], study)
        _check_units(key, found[name], study)
    return found


def read_goals(study: Study, read: StudyTables) -> dict[str, Expression]:
    """What is to be small, by its label; what is to be large counts with a minus sign.

    Raises
    ------
    InputError
    """
    if read.optimise is None:
        wanted = [(f"report.goals.{name}", name, way == "max") for name, way in read.report.goals.items()]
    else:
        wanted = [
            (f"optimise.{key}", text, key == "maximise")
            for key in ("minimise", "maximise")
            for text in _texts(getattr(read.optimise, key))
        ]
        if not wanted:
            raise InputError(
                Problem("optimise.minimise", 'is missing; name a column, such as "leak_rate_m3_per_s"')
            )
    if len(wanted) > 2:
        raise InputError(Problem(wanted[2][0], "is a third goal; allowed are one or two"))
    goals: dict[str, Expression] = {}
    for key, text, large in wanted:
        try:
            formula = Expression(text)
        except ExpressionError as error:
            raise InputError(Problem(key, str(error), shown(text))) from None
        _check_known(key, text, formula.names, [*study.names, *LEAK_COLUMNS, *study.derived], study)
        if text in goals:
            raise InputError(Problem(key, "is a goal already; remove one of them", shown(text)))
        goals[text] = Expression(f"-({text})") if large else formula
    return goals


def needed_columns(study: Study, responses: Sequence[str]) -> tuple[str, ...]:
    """The responses asked for and those that formulas need, in the order of leak.csv."""
    used = {
        name
        for group in (study.derived, study.constraints, study.goals)
        for one in group.values()
        for name in one.names
    }
    wanted = set(responses) | used
    return tuple(name for name in LEAK_COLUMNS if name in wanted)


def _texts(value: str | tuple[str, ...] | None) -> tuple[str, ...]:
    if value is None:
        return ()
    return (value,) if isinstance(value, str) else value


def _check_responses(study: Study, responses: Sequence[str]) -> None:
    for n, name in enumerate(responses):
        if name not in LEAK_COLUMNS:
            raise InputError(Problem("responses", unknown_column(name), shown(name)))
        if name in responses[:n]:
            raise InputError(Problem("responses", f"names {name} twice; remove one"))
        _check_possible("responses", name, study)


def unknown_column(name: str) -> str:
    """What to say about a name that is no column of leak.csv."""
    return unknown_name(name, list(LEAK_COLUMNS)).replace(
        "neither a column nor a parameter", "no column of leak.csv"
    )


def _check_known(key: str, text: str, names: Iterable[str], known: list[str], study: Study) -> None:
    for name in names:
        if name not in known:
            raise InputError(Problem(key, unknown_name(name, known), shown(text)))
        words = [one for one in study.parameters if one.name == name and not one.numeric]
        if words:
            raise InputError(Problem(key, f"calculates with {name}, which holds words", shown(text)))
        _check_possible(key, name, study)


def _check_units(key: str, constraint: Constraint, study: Study) -> None:
    """Two quantities that are compared as they are have to be of one kind."""
    units = {name: split_unit(name)[1] for name in LEAK_COLUMNS}
    units |= {one.name: one.entry.unit for one in study.parameters}
    left, right = (unit_of(side, units) for side in constraint.sides)
    if None not in (left, right) and left != right:
        kinds = " with ".join(f"a quantity in {unit}" if unit else "a plain number" for unit in (left, right))
        raise InputError(Problem(key, f"compares {kinds}", shown(constraint.text)))


def _check_possible(key: str, name: str, study: Study) -> None:
    """Columns that stay empty in this case."""
    case = study.case
    if name in _INTERVAL and case.uncertainty is None:
        raise InputError(Problem(key, f"{name} needs a table [uncertainty] in the base case"))
    if name.startswith("leak_rate") and (case.roughness is None or case.fluid is None):
        missing = "roughness" if case.roughness is None else "fluid"
        raise InputError(Problem(key, f"{name} needs a table [{missing}] in the base case"))
    if name.startswith("critical_separation") and case.roughness is None:
        raise InputError(Problem(key, f"{name} needs a table [roughness] in the base case"))


def _check_name(key: str, name: str, taken: Sequence[str]) -> None:
    if not name.isidentifier() or not name.isascii():
        raise InputError(Problem(key, "must be a word of letters, digits and underscores"))
    if name.lower() in [one.lower() for one in taken]:
        raise InputError(Problem(key, "is the name of another column; choose another one"))
