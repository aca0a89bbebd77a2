"""Atomic writing of files; reading of TOML and text tables with clear errors.

A pipe that nobody writes to would be waited for without end, and a device such as /dev/zero never ends.
"""

from __future__ import annotations

import json
import math
import os
import re
import stat
import tomllib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.errors import InputError, OutputError, Problem, QuantityError, SealError, TextTableError
from fem_seal.units import parse_quantity
from fem_seal.wording import Words, fill

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.units import Display
    from leak.text_tables import TextTable


def write_bytes(path: str | os.PathLike[str], chunks: bytes | Iterable[bytes]) -> Path:
    """Write a file in one step: readers see the old content or the new one, never a part of it.

    Parameters
    ----------
    path : path
        File to write or replace; its folder is made if it does not exist.
    chunks : bytes or iterable of bytes
        Content.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    OutputError
        If the file cannot be written; nothing is left behind.
    """
    path = Path(path)
    # In the same folder, because a rename is only atomic within one file system.
    draft = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with draft.open("wb") as file:
            file.writelines([chunks] if isinstance(chunks, bytes) else chunks)
        os.replace(draft, path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"{path}: cannot be written ({reason})") from error
    finally:
        # an error that is already on its way says what is wrong with this folder
        with suppress(OSError):
            draft.unlink(missing_ok=True)
    return path


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write a text file (UTF-8, lines ending with a line feed) in one step; see `write_bytes`."""
    return write_bytes(path, text.encode("utf-8"))


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Tables of a file.

    Parameters
    ----------
    path : Path
    kind : str
        What the file is to be: "case" or "study".

    Raises
    ------
    InputError
        If it cannot be read or is no TOML.
    """
    try:
        return parse_toml(read_text(path, _MOST_BYTES_OF_TOML))
    except UnicodeDecodeError:
        message = f"is not a text file; a {kind} file in TOML is needed"
    except (TomlError, UnreadableFileError) as error:
        message = str(error)
    raise InputError.at("", message, file=path)


@cache
def own_tables(name: str) -> dict[str, Any]:
    """Tables of a TOML file in templates/, which are part of the program."""
    return tomllib.loads(files("fem_seal").joinpath("templates", name).read_text(encoding="utf-8"))


def problem(name: str, /, **values: object) -> Problem:
    """One wrong entry, or with no key what is said of an input as a whole.

    Parameters
    ----------
    name : str
        Of its words in templates/problems.toml: says, and where there are some key, remedy, value and kind.
    **values
        What the words have in braces.
    """
    entry = own_tables("problems.toml")[name]
    key, says, remedy, given = (
        Words(entry.get(part, ""), values) for part in ("key", "says", "remedy", "value")
    )
    kind = entry.get("kind", "")
    return Problem(str(key), says, given if "value" in entry else None, remedy=remedy, entry=name, kind=kind)


def worded_rows(display: Display, name: str, /, **values: object) -> list[tuple[str, str]]:
    """Names and texts of a table of words.toml under "rows", in its order; a row with an empty text is left out.

    Parameters
    ----------
    display : Display
    name : str
        Of the table.
    **values
        Values of the {names} in both.
    """
    rows = own_tables("words.toml")["rows"][name]
    texts = {fill(display, key, **values): fill(display, text, **values) for key, text in rows.items()}
    return [row for row in texts.items() if row[1]]


class TomlError(SealError, ValueError):
    """A text is no TOML, or none that a person has written."""


# Far beyond what a person writes. Who reads a text later, or its table, may take the square of its length in time, and
# tomllib of the parts of a key.
_LONGEST_KEY, _LONGEST_TEXT, _DEEPEST = 200, 10_000, 20

_STRING = r"""(?:"(?:\\.|[^"\\\n])*+"?|'[^'\n]*+'?)"""
_PART = rf"(?:[A-Za-z0-9_+-]++|{_STRING})"
_DEEP_KEY = re.compile(
    # texts of several lines and comments are passed over
    r'"""(?:\\[\s\S]|[^\\])*?(?:"""|\Z)|'
    r"'''[\s\S]*?(?:'''|\Z)|#[^\n]*+|"
    rf"(?P<deep>{_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{_DEEPEST}}})|{_PART}"
)


def parse_toml(text: str) -> dict[str, Any]:
    """Tables of a text.

    Parameters
    ----------
    text : str

    Raises
    ------
    TomlError
        If it is no TOML, has keys or texts that are too long, or is nested too deeply.
    """
    if any(match["deep"] for match in _DEEP_KEY.finditer(text)):
        raise TomlError(_TOO_DEEP)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        heading = "declar" in str(error) or "overwrite" in str(error)  # which no quotes mend
        quotes = "" if heading else '. Texts and quantities need quotes: radius = "20 mm"'
        raise TomlError(f"is not valid TOML: {error}{quotes}") from None
    except ValueError:
        raise TomlError("holds a number of thousands of digits; write it shorter, such as 1e9") from None
    except RecursionError:
        raise TomlError(_TOO_DEEP) from None
    _check_entry("", tables, _DEEPEST)
    return tables


_TOO_DEEP = f"is nested too deeply; {_DEEPEST} tables or lists within each other are allowed"


def _check_entry(path: str, entry: Any, levels: int) -> None:
    """TomlError if an entry is nested in more levels, or holds keys or texts that are too long."""
    if not levels:
        raise TomlError(_TOO_DEEP)
    if isinstance(entry, str) and len(entry) > _LONGEST_TEXT:
        raise TomlError(
            problem("long_text", path=path, text=entry[:20], length=len(entry), most=_LONGEST_TEXT)
        )
    if isinstance(entry, list):
        for item in entry:
            _check_entry(path, item, levels - 1)
    elif isinstance(entry, dict):
        for key, value in entry.items():
            if len(key) > _LONGEST_KEY:
                raise TomlError(problem("long_key", key=key[:20], length=len(key), most=_LONGEST_KEY))
            _check_entry(f"{path}.{key}".lstrip("."), value, levels - 1)


def read_text_table(file: str | Path) -> TextTable:
    """The only table of a text file, with a number in every cell; see `leak.text_tables.read_tables`.

    Parameters
    ----------
    file : path

    Raises
    ------
    TextTableError
        If the file is missing, no text, empty, has no row of numbers, or a line is not like the first row.
    """
    from leak.errors import TableError
    from leak.text_tables import only_table, read_tables

    try:
        return drop_extremes(only_table(read_tables(read_any_text(file))))
    except TableError as error:
        raise TextTableError(str(error)) from None


def read_any_text(file: str | Path) -> str:
    """Text of a file in UTF-8, UTF-16 or Latin-1.

    Parameters
    ----------
    file : path

    Raises
    ------
    TextTableError
        If it is missing, empty or no text.
    """
    from leak.errors import TableError
    from leak.text_tables import decode

    try:
        return decode(read_bytes(file))
    except (TableError, UnreadableFileError) as error:
        raise TextTableError(str(error)) from None


def drop_extremes(table: TextTable) -> TextTable:
    """A table without numbers that have no square; TextTableError if one is beyond all measure.

    Parameters
    ----------
    table : TextTable
    """
    import numpy as np

    _check_sizes(table.values, table.lines, _HUGE)
    return replace(table, values=np.where(np.abs(table.values) < 1 / _HUGE, 0.0, table.values))


# Beyond this no number of a table means anything, and beyond these none of its dimension [SI].
_HUGE = 1e100
_PLAUSIBLE = {"length": 1e3, "pressure": 1e15, "strain": 100.0, "temperature": 1e5}
_TINY = 1e-30


def _check_sizes(values: FloatArray, lines: tuple[int, ...], largest: float, what: str = "number") -> None:
    """TextTableError if a row of a table holds a number that is beyond all measure; it names the line."""
    import numpy as np

    places = np.flatnonzero((np.abs(values) > largest).reshape(len(values), -1).any(axis=1))
    if places.size:
        row = values.reshape(len(values), -1)[places[0]]
        number = float(row[int(np.argmax(np.abs(row)))])
        raise TextTableError(problem("beyond_measure", line=lines[int(places[0])], number=number, what=what))


# What a column may be called, and its dimension: one of `fem_seal.units.DIMENSIONS`, or "strain".
Names = Mapping[str, tuple[str, tuple[str, ...]]]

# A strain is a plain number unless its header says otherwise.
_STRAINS = {"": 1.0, "-": 1.0, "1": 1.0, "%": 0.01, "percent": 0.01}


def find_columns(table: TextTable, names: Names, example: str) -> dict[str, int]:
    """Place of each known column in a table.

    Parameters
    ----------
    table : TextTable
    names : mapping
        For each role the dimension and the names that a column may have.
    example : str
        A header that would do, for the message where there is none.

    Raises
    ------
    TextTableError
        If the table has no header, or one of another length than its rows.
    """
    if not table.header:
        columns = table.values.shape[1]
        if table.lines_above:
            raise TextTableError(
                problem("column_names", above=table.lines_above[-1][1][:60], columns=columns, example=example)
            )
        raise TextTableError(f"has no header; name the columns and their units, {example}")
    words = [name_and_unit(header)[0] for header in table.header]
    places = {
        role: next((n for n, word in enumerate(words) if word in role_words), None)
        for role, (_, role_words) in names.items()
    }
    return {role: place for role, place in places.items() if place is not None}


def column(table: TextTable, place: int, dimension: str) -> FloatArray:
    """Column of a table in SI.

    Raises
    ------
    TextTableError
        If its header has no unit of this dimension.
    """
    import numpy as np

    values = _column_in_si(table, place, dimension)
    limit = _PLAUSIBLE.get(dimension, _HUGE)
    _check_sizes(values, table.lines, limit, f'{dimension} of column "{table.header[place]}" (in SI)')
    return np.where(np.abs(values) < _TINY, 0.0, values)


def _column_in_si(table: TextTable, place: int, dimension: str) -> FloatArray:
    import numpy as np

    header, values = table.header[place], table.values[:, place]
    unit = name_and_unit(header)[1]
    if dimension == "strain":
        if unit.lower() not in _STRAINS:
            raise TextTableError(problem("unit_of_strain", header=header, unit=unit))
        return values * _STRAINS[unit.lower()]
    if not unit:
        example = {"length": "mm", "temperature": "degC"}.get(dimension, "MPa")
        raise TextTableError(problem("column_without_unit", header=header, example=example))
    try:
        if dimension == "temperature":
            # whose scales begin at different places
            return np.array([parse_quantity(f"{value!r} {unit}", dimension) for value in values.tolist()])
        return values * parse_quantity(f"1 {unit}", dimension)
    except QuantityError as error:
        raise TextTableError(f'column "{header}": {error}') from None


def name_and_unit(header: str) -> tuple[str, str]:
    """``"x_m"``, ``"x [mm]"``, ``"Contact pressure (MPa)"`` as word and unit; unit empty if there is none."""
    in_brackets = re.fullmatch(r"(.*?)[\s_]*[\[(]\s*([^\])]+?)\s*[\])]", header)
    with_suffix = re.fullmatch(r"(.+)[\s_]([^\s_]+)", header)
    for match in (in_brackets, with_suffix):
        if match and (match is in_brackets or _is_unit(match[2])):
            return re.sub(r"\s+", "_", match[1].lower()), match[2]
    return re.sub(r"\s+", "_", header.lower()), ""


def _is_unit(text: str) -> bool:
    if text.lower() in ("%", "percent"):
        return True
    for dimension in ("length", "pressure", "temperature"):
        try:
            parse_quantity(f"1 {text}", dimension)
        except QuantityError:
            continue
        return True
    return False


def parse_json(text: str | bytes) -> Any:
    """What a text in JSON holds.

    Raises
    ------
    ValueError
        If it is no JSON, or holds more than this program writes.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("is nested too deeply") from None


def as_json(value: object) -> str:
    """JSON of numbers, texts, lists and tables; what is not a number in JSON (NaN, infinity) becomes null."""
    return json.dumps(_replace_nonfinite(value), indent=2, ensure_ascii=False)


def _replace_nonfinite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _replace_nonfinite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_replace_nonfinite(entry) for entry in value]
    if isinstance(value, float) or hasattr(value, "item"):
        number = value.item() if hasattr(value, "item") else value
        return None if isinstance(number, float) and not math.isfinite(number) else number
    return value


# What a person writes, and what instruments and other programs do.
_MOST_BYTES = 64 * 2**20
_MOST_BYTES_OF_TOML = 4 * 2**20
MOST_BYTES_OF_SCAN = MOST_BYTES_OF_DRAWING = 2**30

_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


class UnreadableFileError(SealError, ValueError):
    """A file cannot be read; the message does not repeat its path: "cannot be read (no such file or directory)"."""


def read_bytes(path: str | os.PathLike[str], limit: int = _MOST_BYTES) -> bytes:
    """Content of a regular file.

    Parameters
    ----------
    path : path
    limit : int
        Largest size that is read [bytes].

    Raises
    ------
    UnreadableFileError
        If it is not there, may not be read, is no regular file, or is larger.
    """
    try:
        # Not blocking: to open a pipe would wait for the one who writes it.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        try:
            _check(os.fstat(handle), limit)
            with open(handle, "rb", closefd=False) as file:
                # A file of the system may say that it is empty and have no end.
                content = file.read(limit + 1)
        finally:
            os.close(handle)
    except (OSError, ValueError) as error:
        raise _unreadable_error(error) from None
    if len(content) > limit:
        raise _size_error(limit)
    return content


def read_text(path: str | os.PathLike[str], limit: int = _MOST_BYTES) -> str:
    """The same as text in UTF-8, with or without a byte order mark.

    Raises
    ------
    UnreadableFileError
        As of `read_bytes`.
    UnicodeDecodeError
        If it is no such text.
    """
    text = read_bytes(path, limit).decode("utf-8-sig")
    # as a file opened for text gives it
    return text.replace("\r\n", "\n").replace("\r", "\n")


def check_file(path: str | os.PathLike[str], limit: int = _MOST_BYTES) -> None:
    """Whether `read_bytes` would read it, for those who are given the path and read it themselves.

    Raises
    ------
    UnreadableFileError
        As of `read_bytes`.
    """
    try:
        _check(Path(path).stat(), limit)
        if not os.access(path, os.R_OK):
            raise UnreadableFileError("cannot be read (permission denied)")
    except (OSError, ValueError) as error:
        raise _unreadable_error(error) from None


def _check(status: os.stat_result, limit: int) -> None:
    if not stat.S_ISREG(status.st_mode):
        kind = next((name for is_kind, name in _KINDS if is_kind(status.st_mode)), "no regular file")
        raise UnreadableFileError(f"cannot be read (is {kind}; a regular file is needed)")
    if status.st_size > limit:
        raise _size_error(limit)


def _size_error(limit: int) -> UnreadableFileError:
    return UnreadableFileError(f"cannot be read (is larger than {limit // 2**20} MB)")


def _unreadable_error(error: OSError | ValueError) -> UnreadableFileError:
    if isinstance(error, UnreadableFileError):
        return error
    reason = getattr(error, "strerror", None) or "not a file name"
    return UnreadableFileError(f"cannot be read ({reason.lower()})")
