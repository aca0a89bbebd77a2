"""Measured leak rates: one row of a table for each reading of a leak test."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fem_seal.case.case import Case
from fem_seal.errors import InputError, TextTableError
from fem_seal.files import name_and_unit, problem, read_any_text
from fem_seal.units import split_unit
from leak.text_tables import COMMENTS, cells_of, number_of

# What stands in a column, and where the case has the same.
_KEYS = {
    "fluid_pressure": "load.fluid_pressure",
    "applied_force": "load.applied_force",
    "largest_earlier_force": "load.largest_earlier_force",
    "leak_rate": "load.target_leak_rate",
}
_COLUMNS = (*_KEYS, "uncertainty", "fluid", "below")
_REQUIRED_COLUMNS = ("fluid_pressure", "leak_rate")
_ANSWERS = {"yes": True, "true": True, "1": True, "no": False, "false": False, "0": False, "": False}
# Of a leak rate: what a flow meter or a bubble count reaches.
USUAL_UNCERTAINTY = 0.1
_MOST_UNCERTAIN, _MOST_ROWS = 3.0, 200


@dataclass(frozen=True)
class MeasuredLeak:
    """One reading of a leak test.

    Parameters
    ----------
    line : int
        Where it stands in its table, the header being line 1.
    case : Case
        The seal under this load, with this fluid and what it remembers.
    leak_rate : float
        As `run` gives it [m^3/s]; of a reading below the instrument's limit that limit.
    uncertainty : float
        Standard deviation of its logarithm: for small ones the relative standard deviation [-].
    is_below : bool
        Whether less than `leak_rate` leaks.
    """

    line: int
    case: Case
    leak_rate: float
    uncertainty: float = USUAL_UNCERTAINTY
    is_below: bool = False

    @property
    def fluid_pressure(self) -> float:
        """[Pa]."""
        return self.case.load.points[0][0]

    @property
    def applied_force(self) -> float:
        """[N]."""
        return self.case.load.points[0][1]


def read_measured(case: Case, file: str | Path) -> tuple[MeasuredLeak, ...]:
    """Readings of a leak test from a CSV file.

    Parameters
    ----------
    case : Case
        The seal; what a row does not say comes from it.
    file : path
        Columns `fluid_pressure` and `leak_rate` and, as they apply, `applied_force`, `uncertainty`, `fluid`,
        `largest_earlier_force` and `below`, with their units in the header ("leak_rate [ml/min]", "fluid_pressure_Pa")
        or in each cell.

    Raises
    ------
    InputError
        With line and column of an entry that is wrong.
    """
    try:
        return read_measured_text(case, read_any_text(file))
    except InputError as error:
        raise error.in_file(file) from None
    except TextTableError as error:
        raise InputError.at("", str(error), file=file) from None


def read_measured_text(case: Case, text: str) -> tuple[MeasuredLeak, ...]:
    """Readings of a leak test in the text of such a file, see `read_measured`.

    Parameters
    ----------
    case : Case
    text : str
    """
    return tuple(_rows(case, text))


def _rows(case: Case, text: str) -> Iterator[MeasuredLeak]:
    if case.bolts is not None:
        raise InputError(problem("measured_bolts"))
    rows, separator = _rows_of(text)
    if len(rows) < 2:
        raise InputError(problem("measured_empty"))
    if len(rows) - 1 > _MOST_ROWS:
        raise InputError(problem("measured_too_many", rows=len(rows) - 1, most=_MOST_ROWS))
    header, *cells = [row for _, row in rows]
    names = [_name_and_unit(cell) for cell in header]
    columns = [name for name, _ in names]
    for name in (
        *(column for column in columns if column not in _COLUMNS),
        *(column for column in _REQUIRED_COLUMNS if column not in columns),
    ):
        which = "measured_column" if name in columns else "measured_missing"
        raise InputError(problem(which, name=name, columns=", ".join(_COLUMNS)))
    if not is_filled(text):
        raise InputError(problem("measured_unfilled", rows=len(cells)))
    for (line, _), row in zip(rows[1:], cells, strict=True):
        if len(row) != len(header):
            raise InputError(problem("measured_row", line=line, cells=len(row), columns=len(header)))
        comma = separator != ","
        entries = {
            name: (cell.replace(",", ".") if comma else cell, unit)
            for (name, unit), cell in zip(names, row, strict=True)
        }
        yield _measured_leak(case, line, entries)


def _rows_of(text: str) -> tuple[list[tuple[int, list[str]]], str]:
    """Cells of each line, the header first, with its number, and what stands between them."""
    lines = [
        (n, line)
        for n, line in enumerate(text.split("\n"), 1)
        if line.strip() and not line.startswith(COMMENTS)
    ]
    separator = next((character for character in ";\t" if lines and character in lines[0][1]), ",")
    return [(n, cells_of(line, separator)) for n, line in lines], separator


def is_filled(text: str) -> bool:
    """Whether a table of readings holds a leak rate.

    Parameters
    ----------
    text : str
    """
    (_, header), *rows = _rows_of(text)[0] or [(0, [])]
    places = [n for n, cell in enumerate(header) if _name_and_unit(cell)[0] == "leak_rate"]
    return any(cell for _, row in rows for n in places for cell in row[n : n + 1])


def _name_and_unit(header: str) -> tuple[str, str]:
    name, unit = name_and_unit(header)
    return (name, unit) if unit else split_unit(name)


def _measured_leak(case: Case, line: int, entries: Mapping[str, tuple[str, str]]) -> MeasuredLeak:
    """A row of the table, by its columns: text and unit of the header."""
    changes: dict[str, Any] = {"requirement": None, "load.target_leak_rate": None}
    less = entries["leak_rate"][0].startswith("<")
    for name, key in _KEYS.items():
        text, unit = entries.get(name, ("", ""))
        text = text.removeprefix("<").strip() if name == "leak_rate" else text
        if name == "leak_rate" and text and number_of(text.split()[0]) == 0.0:
            raise InputError(problem("measured_zero", line=line, value=text))
        if text:
            changes[key] = (
                text if any(c.isalpha() for c in text.lower().replace("e", "")) else f"{text} {unit}"
            )
        elif name in _REQUIRED_COLUMNS:
            raise InputError(problem("measured_cell", line=line, name=name))
        elif name == "applied_force":
            changes[key] = _only_force(case, line)
    fluid = entries.get("fluid", ("", ""))[0]
    try:
        row = with_fluid(case, fluid) if fluid else case
        row = row.replace({key: value for key, value in changes.items() if value is None})
        row = row.replace_written({key: value for key, value in changes.items() if value is not None})
    except InputError as error:
        columns = {key: name for name, key in _KEYS.items()} | {"fluid": "fluid"}
        raise InputError(
            *(
                replace(item, key=f"line {line}, column {columns.get(item.key, item.key)}")
                for item in error.problems
            )
        ) from None
    rate = row.load.target_leak_rate
    assert rate is not None
    answer = entries.get("below", ("", ""))[0]
    below = _ANSWERS.get(answer.lower())
    if below is None:
        raise InputError(problem("measured_below", line=line, value=answer))
    if less and answer and not below:
        raise InputError(problem("measured_twice", line=line, value=answer))
    # a load alone is no search for the force of a target
    return MeasuredLeak(
        line, row.replace({"load.target_leak_rate": None}), rate, _uncertainty(line, entries), below or less
    )


def with_fluid(case: Case, name: str) -> Case:
    """The case with another fluid of the library, at the same temperature.

    Parameters
    ----------
    case : Case
    name : str

    Raises
    ------
    InputError
        If the library has no such fluid.
    """
    if case.fluid is not None and name.lower() == case.fluid.name.lower():
        return case
    keys = () if case.fluid is None else case.fluid.model_fields_set - {"name", "temperature"}
    changes: dict[str, Any] = dict.fromkeys(f"fluid.{key}" for key in sorted(keys))
    if case.uncertainty is not None and case.uncertainty.viscosity is not None:
        changes["uncertainty.viscosity"] = None  # of the other one
        if not case.uncertainty.spreads.keys() - {"viscosity"}:
            changes = {key: value for key, value in changes.items() if not key.startswith("uncertainty")}
            changes["uncertainty"] = None
    return case.replace({**changes, "fluid.name": name})


def _only_force(case: Case, line: int) -> str:
    forces = {force for _, force in case.load.points}
    if len(forces) > 1:
        raise InputError(problem("measured_force", line=line))
    return f"{forces.pop()!r} N"


def _uncertainty(line: int, entries: Mapping[str, tuple[str, str]]) -> float:
    text, unit = entries.get("uncertainty", ("", ""))
    if not text:
        return USUAL_UNCERTAINTY
    try:
        number = float(text.removesuffix("%"))
    except ValueError:
        number = -1.0
    if "%" in text or unit in ("%", "percent"):
        number *= 0.01
    elif not unit:
        raise InputError(problem("measured_uncertainty_unit", line=line, value=text))
    if not 0.0 < number <= _MOST_UNCERTAIN:
        raise InputError(problem("measured_uncertainty", line=line, value=text))
    return number
