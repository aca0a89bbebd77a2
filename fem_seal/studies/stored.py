"""Whether a study file holds what a study writes: a disc, a network or a hand may have changed it."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from fem_seal.answers.judgement import Verdict
from fem_seal.files import parse_json
from fem_seal.former_names import VERDICTS, in_present_words
from fem_seal.output.columns import COLUMNS
from fem_seal.seal.findings import Level
from fem_seal.studies.designs import SENSITIVITY
from fem_seal.studies.expressions import Constraint, Expression
from fem_seal.studies.tables import Design, Kind

# Beyond this no number means anything, and its square is none: a design has no value then. Below the other one a float
# loses its digits in another unit: it is zero.
LARGEST, SMALLEST = 1e100, 1e-290
# Files of before that may hold any number; a larger one than this has no square, which readers ask for.
_LARGEST_READ = 1e150
# SQLite takes expressions of up to 1000 conditions.
_AT_ONCE = 500
DONE, FAILED = "done", "failed"
TRUTH = "BOOLEAN"
# Columns of a row besides parameters and outputs. Files of before validity or a verdict was told do not have the last
# ones.
ABOUT_ROW = ("key", "status", "reason", "seconds")
TOLD = ("validity", "validity_reasons", "verdict")

_Finite = Annotated[float, Field(ge=-_LARGEST_READ, le=_LARGEST_READ)]


class _Told(BaseModel):
    """Nothing is converted; what other versions say besides is let be."""

    model_config = ConfigDict(strict=True, extra="ignore")


class _Parameter(_Told):
    name: str
    unit: str
    numeric: bool
    levels: list[str | bool | _Finite]
    bounds: list[_Finite]
    distribution: str | None

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.numeric:
            numbers = [one for one in self.levels if isinstance(one, float)]
            low, high = self.bounds
            if len(numbers) < len(self.levels) or not all(low <= one <= high for one in (*numbers, low)):
                raise ValueError("its levels are not within its bounds")
        return self


class _Design(_Told):
    kind: Kind
    optimise: bool


class _Seal(_Told):
    nominal_size: Annotated[float, Field(gt=0, le=_LARGEST_READ)] | None
    gas: bool


class _About(_Told):
    """What readers ask of `fem_seal.studies.session.description`."""

    version: str
    title: str
    inputs: list[str]
    parameters: list[_Parameter]
    responses: list[str]
    beside: list[str] = []
    derived: dict[str, str]
    constraints: dict[str, str]
    goals: dict[str, str]
    design: _Design
    outside_theory: str = ""
    standard: str
    seal: _Seal


class StoredError(ValueError):
    """A study file does not hold what a study writes; the message says what is wrong."""


def read_about(connection: sqlite3.Connection) -> dict[str, Any]:
    """What a file says of its study, in present names.

    Raises
    ------
    StoredError
        If it is not what a study writes there.
    """
    try:
        rows = connection.execute("SELECT name, text FROM about").fetchall()
        about = {str(name): in_present_words(parse_json(text), aloud=False) for name, text in rows}
    except (sqlite3.Error, TypeError, ValueError) as error:
        raise StoredError(f"what it says of the study cannot be read: {error}") from None
    return about


def check_about(about: Mapping[str, Any], columns: Sequence[str]) -> None:
    """StoredError unless all that readers ask is said of a study, and fits its columns.

    Parameters
    ----------
    about : mapping
    columns : sequence of str
        Parameters and outputs of the rows.
    """
    try:
        told = _About(**about)
        if told.design.kind in SENSITIVITY and not told.design.optimise:
            Design(**{key: value for key, value in about["design"].items() if key != "optimise"})
        formulas: list[Expression | Constraint] = [
            Expression(text) for text in (*told.derived.values(), *told.goals.values())
        ]
        formulas += [Constraint(text) for text in told.constraints.values()]
    except ValidationError as error:
        place = ".".join(map(str, error.errors(include_url=False)[0]["loc"]))
        raise StoredError(f"{place or 'design'} of the study is not what a study writes there") from None
    except ValueError as error:
        raise StoredError(f"a formula of the study cannot be read: {error}") from None
    names = [one.name for one in told.parameters]
    if names != told.inputs or [*names, *told.responses, *told.derived] != list(columns):
        raise StoredError("its columns are not those of the study")
    unknown = [name for name in told.responses if name not in COLUMNS]
    unknown += [name for one in formulas for name in one.names if name not in columns]
    if unknown:
        raise StoredError(f"there is no column {unknown[0]}")


def check_rows(connection: sqlite3.Connection, kinds: Mapping[str, str], inputs: int) -> None:
    """StoredError unless every row is one that a study writes.

    Parameters
    ----------
    connection : sqlite3.Connection
    kinds : mapping
        Parameters and outputs as columns of the file, with their types in SQL.
    inputs : int
        So many first ones of them are parameters.
    """
    try:
        there = {row[1] for row in connection.execute("PRAGMA table_info(point)")}
        texts = [name for name in ("key", "status", "reason", *TOLD) if name in there]
        texts += [name for name, kind in list(kinds.items())[:inputs] if kind == "TEXT"]
        conditions = list(_wrong(there, kinds, inputs))
        for start in range(0, len(conditions), _AT_ONCE):
            some = conditions[start : start + _AT_ONCE]
            if _misses(connection, some):
                what = next(one for one in some if _misses(connection, [one]))
                raise StoredError(f"a row holds what no study writes, not {what}")
        # read once, because only reading shows what is no text
        for query in (f"SELECT {', '.join(map(quoted, texts))} FROM point", "SELECT number, key FROM design"):
            for _ in connection.execute(query):
                pass
        if connection.execute(
            "SELECT 1 FROM design WHERE number < 0 OR typeof(key) != 'text' LIMIT 1"
        ).fetchone():
            raise StoredError("a design has no number or no key")
    except (sqlite3.Error, UnicodeDecodeError) as error:
        raise StoredError(str(error)) from None


def _misses(connection: sqlite3.Connection, conditions: Sequence[str]) -> bool:
    """Whether a row misses one of the conditions, by one look at the table."""
    wrong = " OR ".join(f"NOT ({one})" for one in conditions)
    return connection.execute(f"SELECT 1 FROM point WHERE {wrong} LIMIT 1").fetchone() is not None


def _wrong(there: set[str], kinds: Mapping[str, str], inputs: int) -> Iterator[str]:
    """What holds of every row, in SQL."""
    yield "typeof(key) = 'text'"
    yield f"(status = '{DONE}' AND reason IS NULL) OR (status = '{FAILED}' AND typeof(reason) = 'text')"
    yield f"{_number('seconds')} AND seconds >= 0"
    for name, words in (("validity", [*Level]), ("verdict", [*Verdict, *VERDICTS])):
        if name in there:
            listed = ", ".join(f"'{word}'" for word in words)
            yield f"{name} IS NULL OR {name} IN ({listed})"
    if "validity_reasons" in there:
        yield "typeof(validity_reasons) IN ('null', 'text')"
    for place, (name, kind) in enumerate(kinds.items()):
        column = quoted(name)
        if place >= inputs:
            yield f"{column} IS NULL OR ({_number(column)})"
        elif kind == TRUTH:
            yield f"typeof({column}) = 'integer' AND {column} IN (0, 1)"
        else:
            yield f"typeof({column}) = 'text'" if kind == "TEXT" else _number(column)


def _number(column: str) -> str:
    # to SQLite all texts and bytes are larger than any number; to ask for types takes longer
    return f"{column} IS NOT NULL AND +{column} BETWEEN {-_LARGEST_READ!r} AND {_LARGEST_READ!r}"


def storable(value: float) -> float | None:
    """A number as a study keeps it.

    Examples
    --------
    >>> storable(2.0), storable(1e-300), storable(1e200), storable(float("nan"))
    (2.0, 0.0, None, None)
    """
    if not abs(value) <= LARGEST:
        return None
    return value if abs(value) >= SMALLEST else 0.0


def quoted(name: str) -> str:
    """A column as SQL writes it."""
    return '"' + name.replace('"', '""') + '"'
