"""The one file of a study: SQLite, written by the coordinating process alone, and checked before it is read.

Table `design` says which designs the study has, `point` what came out of each, keyed by a hash of everything that it
depends on, `about` how the columns are to be read. Every batch of rows is one transaction in the write-ahead log: a
process that is killed leaves whole rows or none.
"""

from __future__ import annotations

import json
import shutil
import sqlite3
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from fem_seal.answers.judgement import Verdict
from fem_seal.errors import InputError, OutputError
from fem_seal.files import UnreadableFileError, check_file, parse_json, problem
from fem_seal.output.columns import COLUMNS
from fem_seal.seal.findings import Level
from fem_seal.studies.designs import SENSITIVITY
from fem_seal.studies.expressions import Constraint, Expression
from fem_seal.studies.tables import Design, Kind

if TYPE_CHECKING:
    import pandas as pd

FILE = "study.sqlite"
# Raised when a table changes its meaning.
FORMAT_VERSION = 1
# SQLite takes expressions of up to 1000 conditions.
_AT_ONCE = 500
# Beyond this no number means anything, and its square is none: a design has no value then. Below the other one a float
# loses its digits in another unit: it is zero.
LARGEST, SMALLEST = 1e100, 1e-290
# Files of before that may hold any number; a larger one than this has no square, which readers ask for.
_LARGEST_READ = 1e150
DONE, FAILED = "done", "failed"
TRUTH = "BOOLEAN"
# Columns of a row besides parameters and outputs.
ABOUT_ROW = ("key", "status", "reason", "seconds")
JUDGEMENT = ("validity", "validity_reasons", "verdict")
# Files that were looked through by this process, by device and inode: in which state, and their columns.
_Columns = tuple[tuple[str, ...], tuple[str, ...]]
_checked_files: dict[tuple[int, int], tuple[object, _Columns]] = {}


@dataclass(frozen=True)
class Row:
    """What came out of one design.

    Parameters
    ----------
    key : str
        Hash of its full input.
    inputs : tuple
        Values of the parameters, SI.
    outputs : tuple of float or None
        Responses and derived columns; None where there is none.
    reason : str or None
        Why it failed; None if it did not.
    seconds : float
        What it took.
    validity, validity_reasons : str or None
        How far its numbers can be trusted, and why no further; None if it failed.
    verdict : str or None
        On the requirement of the case; None where it was not asked for.
    """

    key: str
    inputs: tuple[float | str | bool, ...]
    outputs: tuple[float | None, ...]
    reason: str | None
    seconds: float
    validity: str | None = None
    validity_reasons: str | None = None
    verdict: str | None = None

    @property
    def status(self) -> str:
        """Whether it is done or failed."""
        return FAILED if self.reason else DONE


class Store:
    """An open study file.

    Parameters
    ----------
    connection : sqlite3.Connection
    path : Path
    inputs, outputs : tuple of str
        Columns.
    """

    def __init__(
        self, connection: sqlite3.Connection, path: Path, inputs: tuple[str, ...], outputs: tuple[str, ...]
    ) -> None:
        self._connection = connection
        self.path = path
        self.inputs = inputs
        self.outputs = outputs
        status = path.stat()
        self._file = (status.st_dev, status.st_ino)
        types = _columns(connection)
        # SQLite knows numbers and texts only
        self._truths = tuple(types[name] == TRUTH for name in inputs)

    @property
    def about(self) -> dict[str, Any]:
        """What was written with `describe`."""
        return read_about(self._connection)

    def describe(self, **entries: Any) -> None:
        """Keep facts about the study, replacing those of the same names."""
        with self._transaction():
            self._describe(entries)

    def set_design(self, keys: Iterable[str], **about: Any) -> None:
        """Make these the designs of the study, in this order, and describe it; rows of others stay in the file."""
        with self._transaction():
            self._describe(about)
            self._connection.execute("DELETE FROM design")
            self._connection.executemany("INSERT INTO design VALUES (?, ?)", enumerate(keys))

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        """All of what is written inside, or nothing."""
        self.check_place()
        try:
            with self._connection:
                yield
        except sqlite3.Error as error:
            raise _write_error(self.path, error) from error

    def check_place(self) -> None:
        """OutputError if the file is no longer where it was opened: what is written then is lost."""
        try:
            status = self.path.stat()
            is_there = (status.st_dev, status.st_ino) == self._file
        except OSError:
            is_there = False
        if not is_there:
            raise OutputError(problem("study_file_moved", path=self.path))

    def _describe(self, entries: Mapping[str, Any]) -> None:
        self._connection.executemany(
            "INSERT OR REPLACE INTO about VALUES (?, ?)",
            [(name, json.dumps(entry)) for name, entry in entries.items()],
        )

    def append_design(self, first: int, keys: Sequence[str]) -> None:
        """Add designs from a number on, replacing those that have the number already."""
        with self._transaction():
            self._connection.executemany(
                "INSERT OR REPLACE INTO design VALUES (?, ?)", enumerate(keys, start=first)
            )

    @property
    def design(self) -> list[str]:
        """Keys of the designs of the study, in their order."""
        return [key for (key,) in self._connection.execute("SELECT key FROM design ORDER BY number")]

    def stored_keys(self, keys: Sequence[str]) -> set[str]:
        """Those of the keys that have a row."""
        return {key for (key,) in self._select("key", keys)}

    def _select(self, columns: str, keys: Sequence[str]) -> Iterator[tuple[Any, ...]]:
        """Columns of the rows of some keys."""
        for start in range(0, len(keys), _AT_ONCE):
            part = keys[start : start + _AT_ONCE]
            query = f"SELECT {columns} FROM point WHERE key IN ({','.join('?' * len(part))})"
            yield from self._connection.execute(query, part)

    def rows(self, keys: Sequence[str]) -> dict[str, Row]:
        """Rows of some keys."""
        columns = self._query_columns("key", "reason", "seconds", *JUDGEMENT)
        row_of, count = {}, len(self.inputs)
        for key, reason, seconds, level, why, verdict, *values in self._select(columns, keys):
            inputs = tuple(
                bool(value) if truth else value
                for value, truth in zip(values[:count], self._truths, strict=True)
            )
            row_of[key] = Row(key, inputs, tuple(values[count:]), reason, seconds, level, why, verdict)
        return row_of

    def write(self, rows: Sequence[Row]) -> None:
        """Keep rows, all of them or - if the process dies - none."""
        about = attrgetter(*ABOUT_ROW, *JUDGEMENT)
        columns = (*ABOUT_ROW, *JUDGEMENT, *map(quote_column, self.inputs), *map(quote_column, self.outputs))
        values = [(*about(row), *row.inputs, *row.outputs) for row in rows]
        insert = f"INSERT OR IGNORE INTO point ({', '.join(columns)}) VALUES ({','.join('?' * len(columns))})"
        with self._transaction():
            self._connection.executemany(insert, values)

    def forget_failures(self) -> None:
        """Drop the rows of designs that failed."""
        with self._transaction():
            self._connection.execute("DELETE FROM point WHERE status = ?", (FAILED,))

    def key(self, number: int) -> str | None:
        """Key of a design that was calculated without failure, None of any other."""
        query = "SELECT key FROM design JOIN point USING (key) WHERE number = ? AND status = ?"
        row = self._connection.execute(query, (number, DONE)).fetchone()
        return None if row is None else str(row[0])

    @property
    def size(self) -> int:
        """Number of rows, those of other designs than the study's among them."""
        return int(self._connection.execute("SELECT COUNT(*) FROM point").fetchone()[0])

    def counts(self) -> dict[str, int]:
        """Designs of the study that are done, failed and open."""
        query = "SELECT COALESCE(point.status, 'open'), COUNT(*) FROM design LEFT JOIN point USING (key) GROUP BY 1"
        return {DONE: 0, FAILED: 0, "open": 0, **dict(self._connection.execute(query).fetchall())}

    def reasons(self, limit: int = 5) -> list[tuple[str, int]]:
        """Commonest reasons of failure and how often they occur."""
        query = (
            "SELECT reason, COUNT(*) FROM design JOIN point USING (key) WHERE status = 'failed' GROUP BY reason "
            "ORDER BY 2 DESC LIMIT ?"
        )
        return self._connection.execute(query, (limit,)).fetchall()

    def solve_seconds(self) -> float:
        """Time spent on the designs, summed over all workers."""
        return float(self._connection.execute("SELECT TOTAL(seconds) FROM point").fetchone()[0])

    def table(self) -> pd.DataFrame:
        """Designs that have a row, in the order of the study: number, status, reason, validity, parameters, outputs."""
        import pandas as pd

        columns = self._query_columns("number", "status", "reason", *JUDGEMENT)
        query = f"SELECT {columns} FROM design JOIN point USING (key) ORDER BY number"
        table = pd.read_sql_query(query, self._connection)
        outputs = list(self.outputs)
        table[outputs] = table[outputs].astype(float)
        for name, truth in zip(self.inputs, self._truths, strict=True):
            if truth:
                table[name] = table[name].astype(bool)
        return table.set_index("number")

    def _query_columns(self, *first: str) -> str:
        """Columns of a query: the first ones, then parameters and outputs."""
        return ", ".join([*first, *map(quote_column, (*self.inputs, *self.outputs))])

    def close(self) -> None:
        """Fold the write-ahead log into the file and close it."""
        self._connection.close()


def create(path: Path, inputs: Mapping[str, str], outputs: Sequence[str]) -> Store:
    """Make or open a study file for writing.

    Parameters
    ----------
    path : Path
    inputs : mapping
        Column of each parameter and its type in SQL: REAL, TEXT, or `TRUTH` for what is true or false.
    outputs : sequence of str

    Raises
    ------
    InputError
        If the file holds a study with other columns.
    OutputError
        If it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    connection = None
    try:
        connection = _connect(path, "mode=rwc")
        _check_pages(connection, path)
        _lay_out(connection, inputs, outputs)
        names = list(_columns(connection))
        if not _are_columns(names, list(inputs), outputs):
            raise InputError(problem("study_other_columns", path=path, columns=", ".join(names)))
        if any(connection.execute("SELECT 1 FROM about UNION ALL SELECT 1 FROM point LIMIT 1")):
            _check_contents(connection, path)
    except BaseException as error:
        if connection is not None:
            connection.close()
        if isinstance(error, sqlite3.Error):
            raise _write_error(path, error) from error
        if isinstance(error, UnicodeDecodeError):
            raise damage_error(path, error) from None
        raise
    return Store(connection, path, tuple(inputs), tuple(outputs))


def _lay_out(connection: sqlite3.Connection, inputs: Mapping[str, str], outputs: Sequence[str]) -> None:
    """Make the tables that are not there."""
    connection.execute("PRAGMA journal_mode = WAL")
    # In the write-ahead log this is safe against any death of the process; only a power cut costs the last rows.
    connection.execute("PRAGMA synchronous = NORMAL")
    with connection:
        connection.execute("CREATE TABLE IF NOT EXISTS about (name TEXT PRIMARY KEY, text TEXT NOT NULL)")
        connection.execute(
            "CREATE TABLE IF NOT EXISTS design (number INTEGER PRIMARY KEY, key TEXT NOT NULL)"
        )
        definitions = [f"{name} TEXT" for name in JUDGEMENT]
        definitions += [f"{quote_column(name)} {kind}" for name, kind in inputs.items()]
        definitions += [f"{quote_column(name)} REAL" for name in outputs]
        connection.execute(
            "CREATE TABLE IF NOT EXISTS point (key TEXT PRIMARY KEY, status TEXT NOT NULL, reason TEXT, "
            f"seconds REAL NOT NULL, {', '.join(definitions)}) WITHOUT ROWID"
        )


def open_to_read(path: Path) -> Store:
    """Open a study file to read, also while another process writes it.

    Raises
    ------
    InputError
        If there is none.
    """
    try:
        check_file(path, sys.maxsize)
        connection = _open_connection(path)
    except UnicodeDecodeError as error:
        raise damage_error(path, error) from None
    except (sqlite3.Error, UnreadableFileError) as error:
        if getattr(error, "sqlite_errorname", "") == "SQLITE_CORRUPT":
            raise damage_error(path, error) from None
        raise InputError(problem("study_not_there", folder=path.parent, name=path.name)) from None
    try:
        inputs, outputs = _check_cached(connection, path)
    except InputError:
        connection.close()
        raise
    return Store(connection, path, inputs, outputs)


def _open_connection(path: Path) -> sqlite3.Connection:
    """Connection that reads a study file, also one that is being written, and one where nothing can be written."""
    # a reader writes, too: it tells writers what it is reading
    connection = _connect(path, "mode=rw")
    try:
        connection.execute("PRAGMA query_only = ON")
        connection.execute("SELECT COUNT(*) FROM about")
        return connection
    except sqlite3.OperationalError as error:
        connection.close()
        if error.sqlite_errorcode & 0xFF not in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN):
            raise
    # on a read-only disc nobody writes
    log = path.with_name(f"{path.name}-wal")
    if not (log.exists() and log.stat().st_size):
        return _connect(path, "mode=ro&immutable=1")
    # of a study that was interrupted: its last rows are in the log still, which only SQLite can fold into the file
    with TemporaryDirectory(prefix="fem-seal-study-") as place:
        for file in (path, log):
            shutil.copyfile(file, Path(place) / file.name)
        with closing(_connect(Path(place) / path.name, "mode=rw")) as copy:
            connection = sqlite3.connect(":memory:")
            copy.backup(connection)
    return connection


def _check_cached(connection: sqlite3.Connection, path: Path) -> _Columns:
    """Parameters and outputs of a file, which is looked through once for each of its states."""
    file, state = _state(path)
    last_state, columns = _checked_files.get(file, (None, ((), ())))
    if last_state != state:
        _check_pages(connection, path)
        columns = _check_contents(connection, path)
        _checked_files[file] = state, columns
    return columns


def _state(path: Path) -> tuple[tuple[int, int], object]:
    """Device and inode of a file, and what changes when it or its write-ahead log is written."""
    try:
        status = path.stat()
        logs = [log.stat() for log in (path.with_name(f"{path.name}-wal"),) if log.exists()]
    except OSError:
        # a log that ends meanwhile: unlike any other state
        return (0, 0), object()
    # a reader makes an empty log, too
    statuses = [status, *(log for log in logs if log.st_size)]
    state = [(each.st_dev, each.st_ino, each.st_mtime_ns, each.st_size) for each in statuses]
    return (status.st_dev, status.st_ino), state


def _check_pages(connection: sqlite3.Connection, path: Path) -> None:
    """InputError if the file is damaged inside, where reading would come to it sooner or later."""
    try:
        ((answer, *_), *_) = connection.execute("PRAGMA integrity_check(1)")
    except sqlite3.Error as error:
        raise damage_error(path, error) from None
    if answer != "ok":
        raise damage_error(path, answer)


def _check_contents(connection: sqlite3.Connection, path: Path) -> _Columns:
    """Parameters and outputs of a file; InputError unless all that it holds is what a study writes."""
    try:
        kinds = _columns(connection)
        about = read_about(connection)
        columns = tuple(kinds)
        check_about(about, columns)
        inputs = len(about["inputs"])
        check_rows(connection, kinds, inputs)
    except (sqlite3.Error, ValueError) as error:
        raise damage_error(path, error) from None
    return columns[:inputs], columns[inputs:]


def damage_error(path: Path, why: object) -> InputError:
    """What is said of a study file that does not hold what a study writes.

    Parameters
    ----------
    path : Path
    why : object
    """
    return InputError(problem("study_damaged", path=path, reason=" ".join(str(why).split())))


def _write_error(path: Path, error: sqlite3.Error) -> InputError | OutputError:
    """What an error while writing means: a full disc and the like, or a damaged file."""
    if isinstance(error, sqlite3.OperationalError):
        return OutputError(f"{path}: cannot be written ({error})")
    return damage_error(path, error)


def _connect(path: Path, how: str) -> sqlite3.Connection:
    return sqlite3.connect(f"{path.absolute().as_uri()}?{how}", uri=True, timeout=60.0)


def _columns(connection: sqlite3.Connection) -> dict[str, str]:
    """Columns of parameters and outputs, with their types."""
    kinds = {row[1]: row[2] for row in connection.execute("PRAGMA table_info(point)")}
    return {name: kind for name, kind in kinds.items() if name not in (*ABOUT_ROW, *JUDGEMENT)}


_Finite = Annotated[float, Field(ge=-_LARGEST_READ, le=_LARGEST_READ)]


class _Facts(BaseModel):
    """Nothing is converted; what other versions say besides is let be."""

    model_config = ConfigDict(strict=True, extra="ignore")


class _Parameter(_Facts):
    name: str
    unit: str
    numeric: bool
    levels: list[str | bool | _Finite]
    bounds: list[_Finite]
    distribution: str | None

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.numeric:
            numbers = [n for n in self.levels if isinstance(n, float)]
            low, high = self.bounds
            if len(numbers) < len(self.levels) or not all(low <= n <= high for n in (*numbers, low)):
                raise ValueError("its levels are not within its bounds")
        return self


class _Design(_Facts):
    kind: Kind
    optimise: bool


class _Seal(_Facts):
    nominal_size: Annotated[float, Field(gt=0, le=_LARGEST_READ)] | None
    gas: bool


class _About(_Facts):
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
    """What a file says of its study.

    Raises
    ------
    StoredError
        If it is not what a study writes there.
    """
    try:
        rows = connection.execute("SELECT name, text FROM about").fetchall()
        about = {str(name): parse_json(text) for name, text in rows}
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
        study = _About(**about)
        if study.design.kind in SENSITIVITY and not study.design.optimise:
            Design(**{key: value for key, value in about["design"].items() if key != "optimise"})
        formulas: list[Expression | Constraint] = [
            Expression(text) for text in (*study.derived.values(), *study.goals.values())
        ]
        formulas += [Constraint(text) for text in study.constraints.values()]
    except ValidationError as error:
        place = ".".join(map(str, error.errors(include_url=False)[0]["loc"]))
        raise StoredError(f"{place or 'design'} of the study is not what a study writes there") from None
    except ValueError as error:
        raise StoredError(f"a formula of the study cannot be read: {error}") from None
    names = [parameter.name for parameter in study.parameters]
    if names != study.inputs or not _are_columns(columns, names, [*study.responses, *study.derived]):
        raise StoredError("its columns are not those of the study")
    unknown = [name for name in study.responses if name not in COLUMNS]
    unknown += [name for formula in formulas for name in formula.names if name not in columns]
    if unknown:
        raise StoredError(f"there is no column {unknown[0]}")


def _are_columns(columns: Sequence[str], inputs: Sequence[str], outputs: Sequence[str]) -> bool:
    """Whether these are the columns of a file; versions of the program have their outputs in other orders."""
    first, rest = columns[: len(inputs)], columns[len(inputs) :]
    return list(first) == list(inputs) and sorted(rest) == sorted(outputs)


def check_rows(connection: sqlite3.Connection, kinds: Mapping[str, str], inputs: int) -> None:
    """StoredError, or an error of SQLite, unless every row is one that a study writes.

    Parameters
    ----------
    connection : sqlite3.Connection
    kinds : mapping
        Parameters and outputs as columns of the file, with their types in SQL.
    inputs : int
        So many first ones of them are parameters.
    """
    texts = ["key", "status", "reason", *JUDGEMENT]
    texts += [name for name, kind in list(kinds.items())[:inputs] if kind == "TEXT"]
    conditions = list(_violated_conditions(kinds, inputs))
    tests = ", ".join(f"MAX(NOT ({condition}))" for condition in conditions)
    for condition, fails in zip(conditions, *connection.execute(f"SELECT {tests} FROM point"), strict=True):
        if fails:
            raise StoredError(f"a row holds what no study writes, not {condition}")
    # read once, because only reading shows what is no text
    for query in (
        f"SELECT {', '.join(map(quote_column, texts))} FROM point",
        "SELECT number, key FROM design",
    ):
        for _ in connection.execute(query):
            pass
    query = "SELECT 1 FROM design WHERE number < 0 OR typeof(key) != 'text' LIMIT 1"
    if connection.execute(query).fetchone():
        raise StoredError("a design has no number or no key")


def _violated_conditions(kinds: Mapping[str, str], inputs: int) -> Iterator[str]:
    """What holds of every row, in SQL."""
    yield "typeof(key) = 'text'"
    yield f"(status = '{DONE}' AND reason IS NULL) OR (status = '{FAILED}' AND typeof(reason) = 'text')"
    yield f"{_number('seconds')} AND seconds >= 0"
    for name, words in (("validity", [*Level]), ("verdict", [*Verdict])):
        texts = ", ".join(f"'{word}'" for word in words)
        yield f"{name} IS NULL OR {name} IN ({texts})"
    yield "typeof(validity_reasons) IN ('null', 'text')"
    for place, (name, kind) in enumerate(kinds.items()):
        column = quote_column(name)
        if place >= inputs:
            yield f"{column} IS NULL OR ({_number(column)})"
        elif kind == TRUTH:
            yield f"typeof({column}) = 'integer' AND {column} IN (0, 1)"
        else:
            yield f"typeof({column}) = 'text'" if kind == "TEXT" else _number(column)


def _number(column: str) -> str:
    # to SQLite all texts and bytes are larger than any number; to ask for types takes longer
    return f"{column} IS NOT NULL AND +{column} BETWEEN {-_LARGEST_READ!r} AND {_LARGEST_READ!r}"


def stored_number(value: float) -> float | None:
    """A number as a study keeps it.

    Examples
    --------
    >>> stored_number(2.0), stored_number(1e-300), stored_number(1e200), stored_number(float("nan"))
    (2.0, 0.0, None, None)
    """
    if not abs(value) <= LARGEST:
        return None
    return value if abs(value) >= SMALLEST else 0.0


def quote_column(name: str) -> str:
    """A column as SQL writes it."""
    return '"' + name.replace('"', '""') + '"'
