"""The one file of a study: SQLite, written by the coordinating process alone.

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
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from fem_seal.errors import InputError, OutputError
from fem_seal.files import UnreadableFileError, check_file
from fem_seal.former_names import VERDICTS, in_present_words
from fem_seal.studies.stored import (
    ABOUT_ROW,
    DONE,
    FAILED,
    TOLD,
    TRUTH,
    check_about,
    check_rows,
    quoted,
    read_about,
)

if TYPE_CHECKING:
    import pandas as pd

FILE = "study.sqlite"
# Raised when a table changes its meaning.
FORMAT_VERSION = 1
_AT_ONCE = 500
# Files that were looked through by this process, by device and inode: in which state, and their columns.
_Columns = tuple[tuple[str, ...], tuple[str, ...]]
_looked_through: dict[tuple[int, int], tuple[object, _Columns]] = {}


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
        # files of before a column was renamed have it under its former name
        self._stored = {in_present_words(name, aloud=False): name for name in _columns(connection)}
        types = _columns(connection)
        # SQLite knows numbers and texts only
        self._truths = tuple(types[self._stored[name]] == TRUTH for name in inputs)

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
            raise _fault(self.path, error) from error

    def check_place(self) -> None:
        """OutputError if the file is no longer where it was opened: what is written then is lost."""
        try:
            status = self.path.stat()
            there = (status.st_dev, status.st_ino) == self._file
        except OSError:
            there = False
        if not there:
            raise OutputError(
                f"{self.path}: was deleted or moved while the study ran, which stops here. If the folder was moved, "
                "--resume (resume=True) with its new place goes on"
            )

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

    def known(self, keys: Sequence[str]) -> set[str]:
        """Those of the keys that have a row."""
        return {key for (key,) in self._selected("key", keys)}

    def _selected(self, columns: str, keys: Sequence[str]) -> Iterator[tuple[Any, ...]]:
        """Columns of the rows of some keys."""
        for start in range(0, len(keys), _AT_ONCE):
            part = keys[start : start + _AT_ONCE]
            query = f"SELECT {columns} FROM point WHERE key IN ({','.join('?' * len(part))})"
            yield from self._connection.execute(query, part)

    def rows(self, keys: Sequence[str]) -> dict[str, Row]:
        """Rows of some keys."""
        columns = ", ".join(
            ["key", "reason", "seconds", *TOLD, *map(self._read, (*self.inputs, *self.outputs))]
        )
        found, split = {}, len(self.inputs)
        for key, reason, seconds, level, why, verdict, *values in self._selected(columns, keys):
            inputs = tuple(
                bool(value) if truth else value
                for value, truth in zip(values[:split], self._truths, strict=True)
            )
            outputs, verdict = tuple(values[split:]), VERDICTS.get(verdict, verdict)
            found[key] = Row(key, inputs, outputs, reason, seconds, level, why, verdict)
        return found

    def write(self, rows: Sequence[Row]) -> None:
        """Keep rows, all of them or - if the process dies - none."""
        columns = (*ABOUT_ROW, *TOLD, *map(quoted, self.inputs), *map(quoted, self.outputs))
        values = [
            (
                row.key,
                FAILED if row.reason else DONE,
                row.reason,
                row.seconds,
                row.validity,
                row.validity_reasons,
                row.verdict,
                *row.inputs,
                *row.outputs,
            )
            for row in rows
        ]
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
        found = self._connection.execute(query, (number, DONE)).fetchone()
        return None if found is None else str(found[0])

    @property
    def size(self) -> int:
        """Number of rows, those of other designs than the study's among them."""
        return int(self._connection.execute("SELECT COUNT(*) FROM point").fetchone()[0])

    def counts(self) -> dict[str, int]:
        """Designs of the study that are done, failed and open."""
        query = "SELECT COALESCE(point.status, 'open'), COUNT(*) FROM design LEFT JOIN point USING (key) GROUP BY 1"
        return {DONE: 0, FAILED: 0, "open": 0, **dict(self._connection.execute(query).fetchall())}

    def reasons(self, most: int = 5) -> list[tuple[str, int]]:
        """Commonest reasons of failure and how often they occur."""
        query = (
            "SELECT reason, COUNT(*) FROM design JOIN point USING (key) WHERE status = 'failed' GROUP BY reason "
            "ORDER BY 2 DESC LIMIT ?"
        )
        return self._connection.execute(query, (most,)).fetchall()

    def solve_seconds(self) -> float:
        """Time spent on the designs, summed over all workers."""
        return float(self._connection.execute("SELECT TOTAL(seconds) FROM point").fetchone()[0])

    def table(self) -> pd.DataFrame:
        """Designs that have a row, in the order of the study: number, status, reason, validity, parameters, outputs."""
        import pandas as pd

        there = {row[1] for row in self._connection.execute("PRAGMA table_info(point)")}
        told = [name for name in TOLD if name in there]
        columns = ", ".join(
            ["number", "status", "reason", *told, *map(self._read, (*self.inputs, *self.outputs))]
        )
        query = f"SELECT {columns} FROM design JOIN point USING (key) ORDER BY number"
        table = pd.read_sql_query(query, self._connection)
        outputs = list(self.outputs)
        table[outputs] = table[outputs].astype(float)
        if "verdict" in table:
            table["verdict"] = table["verdict"].replace(VERDICTS)
        for name, truth in zip(self.inputs, self._truths, strict=True):
            if truth:
                table[name] = table[name].astype(bool)
        return table.set_index("number")

    def _read(self, name: str) -> str:
        """A column of a query by its present name."""
        return f"{quoted(self._stored[name])} AS {quoted(name)}"

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
        there = list(_columns(connection))
        if there != [*inputs, *outputs]:
            wrong = (
                f"holds a study with other columns ({', '.join(there)}); choose another folder, or put the study "
                "back"
            )
            raise InputError.at(str(path), wrong)
        if any(connection.execute("SELECT 1 FROM about UNION ALL SELECT 1 FROM point LIMIT 1")):
            _check_contents(connection, path)
    except BaseException as error:
        if connection is not None:
            connection.close()
        if isinstance(error, sqlite3.Error):
            raise _fault(path, error) from error
        if isinstance(error, UnicodeDecodeError):
            raise damaged(path, error) from None
        raise
    return Store(connection, path, tuple(inputs), tuple(outputs))


def _lay_out(connection: sqlite3.Connection, inputs: Mapping[str, str], outputs: Sequence[str]) -> None:
    """Make the tables that are not there, in present words."""
    connection.execute("PRAGMA journal_mode = WAL")
    # In the write-ahead log this is safe against any death of the process; only a power cut costs the last rows.
    connection.execute("PRAGMA synchronous = NORMAL")
    with connection:
        connection.execute("CREATE TABLE IF NOT EXISTS about (name TEXT PRIMARY KEY, text TEXT NOT NULL)")
        connection.execute(
            "CREATE TABLE IF NOT EXISTS design (number INTEGER PRIMARY KEY, key TEXT NOT NULL)"
        )
        listed = [f"{name} TEXT" for name in TOLD]
        listed += [f"{quoted(name)} {kind}" for name, kind in inputs.items()]
        listed += [f"{quoted(name)} REAL" for name in outputs]
        connection.execute(
            "CREATE TABLE IF NOT EXISTS point (key TEXT PRIMARY KEY, status TEXT NOT NULL, reason TEXT, "
            f"seconds REAL NOT NULL, {', '.join(listed)}) WITHOUT ROWID"
        )
        there_already = {row[1] for row in connection.execute("PRAGMA table_info(point)")}
        for name in TOLD:
            if name not in there_already:
                connection.execute(f"ALTER TABLE point ADD COLUMN {name} TEXT")
        for name in there_already:
            present = in_present_words(name)
            if present != name:
                connection.execute(f"ALTER TABLE point RENAME COLUMN {quoted(name)} TO {quoted(present)}")


def open_to_read(path: Path) -> Store:
    """Open a study file to read, also while another process writes it.

    Raises
    ------
    InputError
        If there is none.
    """
    try:
        check_file(path, sys.maxsize)
        connection = _reading(path)
    except UnicodeDecodeError as error:
        raise damaged(path, error) from None
    except (sqlite3.Error, UnreadableFileError) as error:
        if getattr(error, "sqlite_errorname", "") == "SQLITE_CORRUPT":
            raise damaged(path, error) from None
        raise InputError.at(
            str(path.parent), f"holds no study ({path.name} is missing or no study file)"
        ) from None
    try:
        inputs, outputs = _checked_once(connection, path)
    except InputError:
        connection.close()
        raise
    return Store(connection, path, inputs, outputs)


def _reading(path: Path) -> sqlite3.Connection:
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
        with closing(_connect(Path(place) / path.name, "mode=rw")) as copied:
            connection = sqlite3.connect(":memory:")
            copied.backup(connection)
    return connection


def _checked_once(connection: sqlite3.Connection, path: Path) -> _Columns:
    """Parameters and outputs of a file, which is looked through once for each of its states."""
    file, state = _state(path)
    before, columns = _looked_through.get(file, (None, ((), ())))
    if before != state:
        _check_pages(connection, path)
        columns = _check_contents(connection, path)
        _looked_through[file] = state, columns
    return columns


def _state(path: Path) -> tuple[tuple[int, int], object]:
    """Device and inode of a file, and what changes when it or its write-ahead log is written."""
    try:
        own = path.stat()
        logs = [log.stat() for log in (path.with_name(f"{path.name}-wal"),) if log.exists()]
    except OSError:
        # a log that ends meanwhile: unlike any other state
        return (0, 0), object()
    # a reader makes an empty log, too
    written = [own, *(log for log in logs if log.st_size)]
    state = [(one.st_dev, one.st_ino, one.st_mtime_ns, one.st_size) for one in written]
    return (own.st_dev, own.st_ino), state


def _check_pages(connection: sqlite3.Connection, path: Path) -> None:
    """InputError if the file is damaged inside, where reading would come to it sooner or later."""
    try:
        ((found, *_), *_) = connection.execute("PRAGMA integrity_check(1)")
    except sqlite3.Error as error:
        raise damaged(path, error) from None
    if found != "ok":
        raise damaged(path, found)


def _check_contents(connection: sqlite3.Connection, path: Path) -> _Columns:
    """Parameters and outputs of a file; InputError unless all that it holds is what a study writes."""
    try:
        kinds = _columns(connection)
        about = read_about(connection)
        columns = in_present_words(tuple(kinds), aloud=False)
        check_about(about, columns)
        inputs = len(about["inputs"])
        check_rows(connection, kinds, inputs)
    except (sqlite3.Error, ValueError) as error:
        raise damaged(path, error) from None
    return columns[:inputs], columns[inputs:]


def damaged(path: Path, why: object) -> InputError:
    """What is said of a study file that does not hold what a study writes.

    Parameters
    ----------
    path : Path
    why : object
    """
    reason = " ".join(str(why).split())
    return InputError.at(
        str(path),
        f"is damaged ({reason}); restore it from a copy, or calculate the study into another folder",
    )


def _fault(path: Path, error: sqlite3.Error) -> InputError | OutputError:
    """What an error while writing means: a full disc and the like, or a damaged file."""
    if isinstance(error, sqlite3.OperationalError):
        return OutputError(f"{path}: cannot be written ({error})")
    return damaged(path, error)


def _connect(path: Path, how: str) -> sqlite3.Connection:
    return sqlite3.connect(f"{path.absolute().as_uri()}?{how}", uri=True, timeout=60.0)


def _columns(connection: sqlite3.Connection) -> dict[str, str]:
    """Columns of parameters and outputs, with their types."""
    listed = {row[1]: row[2] for row in connection.execute("PRAGMA table_info(point)")}
    return {name: kind for name, kind in listed.items() if name not in (*ABOUT_ROW, *TOLD)}
