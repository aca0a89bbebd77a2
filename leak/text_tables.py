"""Tables of numbers in text files, as people, instruments and finite-element programs write them."""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from leak.arrays import FloatArray
from leak.errors import TableError

# In the order in which they win if they read the same table; None stands for blanks. Between decimal commas stands a
# comma with a blank.
_SEPARATORS = (";", "\t", ",", ", ", None)
# Between the names of columns, in the order in which they are tried: names may hold spaces, and commas in brackets.
_BETWEEN_NAMES = (r";", r"\t", r",(?![^\[(]*[\])])", r"\s{2,}", r"(?<=[\])])\s+", r"\s+(?![\[(/])")
# With which a line begins that is no row.
COMMENTS = ("#", "%", "!", "//")
# What programs write under a table, "Minimum", and under the names of its columns, "@Loc 1".
_FOOTER = re.compile(r"(minimum|maximum|total|at node|mean|average|sum)\b", re.IGNORECASE)
_RULE = re.compile(r"[\W_]*$|.*@Loc\b")
_UNIT_LINE = re.compile(
    r"[\[(]?\s*(deg|°|rad|1/0|m|cm|mm|[uµμ]m|nm|k?pa|mpa|gpa|n/mm\^?[2²]|psi|bar)\s*[\])]?$", re.IGNORECASE
)
# What stands where there is no number.
_EMPTY_WORDS = ("n/a", "#n/a", "na", "bad", "invalid", "null", "nodata", "no data", "nan")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+(?:e[+-]?\d+)?", re.IGNORECASE)
_FORTRAN = re.compile(r"[+-]?\d*\.?\d+\.?D[+-]?\d+", re.IGNORECASE)
# Characters of a row of a table with a few columns, and lines in which its layout and its header are looked for.
_LONGEST_ROW, _SAMPLE, _HEADER = 5000, 1000, 6
# Control characters other than tab, line feed, form feed and carriage return do not occur in text.
_CONTROL = re.compile("[\x00-\x08\x0b\x0e-\x1b\x7f]")


@dataclass(frozen=True, eq=False)
class TextTable:
    """Numbers of a text file.

    Parameters
    ----------
    header : tuple of str
        Names of the columns with their units, "x [mm]"; empty if the file has none.
    values : ndarray, shape (rows, columns)
        The numbers, as they stand there; NaN where there is none.
    lines : tuple of int
        Line of the file in which each row stands.
    lines_above : tuple of (int, str)
        Lines between the table before, or the beginning of the file, and the first row, comments too, with their
        numbers.
    rows : tuple of str
        The lines themselves.
    separator : str or None
        Between the cells of a row; None for blanks.
    stray : tuple of int and str, or None
        The first line below that holds numbers and is no row of it, with its number in the file.
    """

    header: tuple[str, ...]
    values: FloatArray
    lines: tuple[int, ...]
    lines_above: tuple[tuple[int, str], ...] = ()
    rows: tuple[str, ...] = ()
    separator: str | None = None
    stray: tuple[int, str] | None = None

    def texts(self, column: int) -> list[str]:
        """The cells of a column as they stand there.

        Parameters
        ----------
        column : int
        """
        rows = (cells_of(row, self.separator) for row in self.rows)
        return [row[column] if column < len(row) else "" for row in rows]


def decode(content: bytes) -> str:
    r"""Text in UTF-8 or UTF-16, with or without a byte order mark, or in Latin-1; lines end with a line feed.

    Parameters
    ----------
    content : bytes

    Raises
    ------
    TableError
        If it is empty or no text.

    Examples
    --------
    >>> decode("x [µm]\r\n0,5".encode("utf-16"))
    'x [µm]\n0,5'
    """
    if not content.strip(b"\x00 \t\r\n"):
        raise TableError("is empty; a table of numbers is needed")
    try:
        text = content.decode(_find_encoding(content[:1000]))
    except UnicodeDecodeError:
        # every sequence of bytes is Latin-1; in it instruments write the micro and the degree sign
        text = content.decode("latin-1")
    if _CONTROL.search(text):
        raise TableError("is not a text file; a table of numbers is needed")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _find_encoding(begin: bytes) -> str:
    if begin[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    # without a mark, every other byte of what a keyboard writes is zero
    for first, name in ((1, "utf-16-le"), (0, "utf-16-be")):
        zeros, others = begin[first::2], begin[1 - first :: 2]
        if zeros.count(0) > 0.9 * len(zeros) and 0 not in others:
            return name
    return "utf-8-sig"


def cells_of(line: str, separator: str | None) -> list[str]:
    """Cells of a line without the blanks and quotes around them.

    Parameters
    ----------
    line : str
    separator : str or None
        None for blanks.

    Examples
    --------
    >>> cells_of('0.5, "seat, part 1", 20', ",")
    ['0.5', 'seat, part 1', '20']
    """
    if '"' in line:
        blank = separator is None
        line = " ".join(line.split()) if blank else line
        row = next(csv.reader([line], delimiter=(separator or " ")[0], skipinitialspace=True), [])
        return [cell.strip().strip('"') for cell in row]
    return line.split() if separator is None else [cell.strip() for cell in line.split(separator)]


def _may_be_decimal(line: str, separator: str | None) -> bool:
    """Whether a comma in a cell is a decimal one: between others it stands in quotes."""
    return separator != "," or '"' in line


def number_of(cell: str, *, commas: bool = False) -> float | None:
    """Number of a cell; NaN where it is empty or a word for nothing; None if something else stands there.

    Parameters
    ----------
    cell : str
    commas : bool, optional
        Whether a comma is a decimal one.

    Examples
    --------
    >>> number_of("0,5", commas=True), number_of("1.0D-03"), number_of("n/a"), number_of("five")
    (0.5, 0.001, nan, None)
    """
    try:
        number = float(cell)
    except ValueError:
        if commas and _DECIMAL_COMMA.fullmatch(cell):
            return number_of(cell.replace(",", "."))
        if _FORTRAN.fullmatch(cell):
            return number_of(re.sub("[dD]", "e", cell))
        is_empty = not any(sign.isalnum() for sign in cell) or cell.lower() in _EMPTY_WORDS
        return math.nan if is_empty else None
    if "_" in cell:
        return None
    return number if math.isfinite(number) else math.nan


@dataclass(frozen=True)
class _Layout:
    """How the rows of a file are made: columns, and which of them hold numbers."""

    separator: str | None
    columns: int
    numeric: tuple[int, ...]

    def row(self, line: str, in_table: bool) -> list[float] | None:
        """Numbers of a line, NaN for texts; None if it is no row. One that ends early lacks its last numbers."""
        if line.startswith(COMMENTS):
            return None
        cells = cells_of(line, self.separator)
        if len(cells) > self.columns and not any(cells[self.columns :]):
            cells = cells[: self.columns]
        if len(cells) > self.columns or (len(cells) < self.columns and not in_table):
            return None
        row, commas = [math.nan] * self.columns, _may_be_decimal(line, self.separator)
        for place in self.numeric:
            if place >= len(cells):
                break
            number = number_of(cells[place], commas=commas)
            if number is None:
                return None
            row[place] = number
        # what begins with nothing is no row, but of one column
        return None if math.isnan(row[self.numeric[0]]) and not (in_table and self._is_lost(row)) else row

    def _is_lost(self, row: Sequence[float]) -> bool:
        return self.columns == 1 or not all(map(math.isnan, row))


def read_tables(text: str) -> tuple[TextTable, ...]:
    r"""The tables of a text, in their order; a heading between rows begins another one.

    Columns are separated by semicolons, tabs, commas or blanks, whatever gives the most rows; unless they are commas,
    numbers may have decimal commas. Columns of texts may stand between those of numbers. The names of the columns are
    the last line above the rows that has as many, also as a comment (#, %, !, //); units may stand in a line of their
    own below the names.

    Parameters
    ----------
    text : str
        See `decode`.

    Raises
    ------
    TableError
        If there is no row of numbers, or a line is longer than any of a table with a few columns.

    Examples
    --------
    >>> (table,) = read_tables("seat 7\nx [mm]; p [MPa]\n0,1; 200,5\n0,2; 210,5")
    >>> table.header, table.values.tolist()
    (('x [mm]', 'p [MPa]'), [[0.1, 200.5], [0.2, 210.5]])
    """
    lines = [(number, line.strip(" \n\r")) for number, line in enumerate(text.splitlines(), start=1)]
    lines = [(number, line) for number, line in lines if line.strip()]
    for number, line in lines:
        if len(line) > _LONGEST_ROW:
            raise TableError(f"line {number} has {len(line)} characters; a table of numbers is needed")
    if not lines:
        raise TableError("is empty; a table of numbers is needed")
    sample = [line for _, line in lines[:_SAMPLE]]
    layouts = _layouts(sample)
    if not layouts:
        header = any(len(cells_of(line, separator)) > 1 for line in sample[-1:] for separator in _SEPARATORS)
        raise TableError("has a header but no rows of numbers" if header else "holds no columns of numbers")
    tables = _split_tables(lines, max(layouts, key=lambda way: _rank(_split_tables(lines[:_SAMPLE], way))))
    if not tables:
        raise TableError("holds no columns of numbers")
    return tables


def only_table(tables: Sequence[TextTable]) -> TextTable:
    """The table of a text that holds one, with a number in every cell.

    Parameters
    ----------
    tables : sequence of TextTable
        See `read_tables`.

    Raises
    ------
    TableError
        If a line below the first row is no such row; NaN and infinity are no numbers.
    """
    table, *others = tables
    bad_rows = np.flatnonzero(~np.isfinite(table.values).all(axis=1))
    if bad_rows.size:
        fault = table.lines[bad_rows[0]], table.rows[bad_rows[0]]
    elif table.stray or others:
        fault = table.stray or others[0].lines_above[-1]
    else:
        return table
    columns, first = table.values.shape[1], table.lines[0]
    like = "" if fault[0] == first else f", like line {first}"
    raise TableError(f'line {fault[0]} ("{fault[1][:40]}"): must hold {columns} finite numbers{like}')


def _rank(tables: Sequence[TextTable]) -> tuple[int, int, bool, int]:
    """Of several readings of a text that with the most rows; then fewest texts, with names, most columns."""
    if not tables:
        return 0, 0, False, 0
    largest = max(tables, key=lambda table: len(table.rows))
    columns = largest.values.shape[1]
    texts = int(np.isnan(largest.values).all(axis=0).sum())
    return len(largest.rows), -texts, bool(largest.header), columns


def _layouts(sample: Sequence[str]) -> list[_Layout]:
    """The likeliest layout for each separator."""
    layouts = []
    for separator in _SEPARATORS:
        numbers = [
            [number_of(cell, commas=_may_be_decimal(line, separator)) for cell in cells_of(line, separator)]
            for line in sample
            if not line.startswith(COMMENTS)
        ]
        counts = Counter(len(row) for row in numbers if any(x is not None and not math.isnan(x) for x in row))
        if not counts:
            continue
        columns = max(counts, key=lambda n: (counts[n], n))
        same = [
            row
            for row in numbers
            if len(row) == columns and any(x is not None and not math.isnan(x) for x in row)
        ]
        half = len(same) / 2
        numeric = tuple(
            place
            for place in range(columns)
            if sum(row[place] is not None for row in same) > half
            and any(row[place] is not None and not math.isnan(row[place] or 0.0) for row in same)
        )
        if numeric:
            layouts.append(_Layout(separator, columns, numeric))
    return layouts


def _split_tables(lines: Sequence[tuple[int, str]], layout: _Layout) -> tuple[TextTable, ...]:
    """Tables of a layout: rows that follow each other, but for comments and what stands under a table."""
    tables, others = list[TextTable](), list[tuple[int, str]]()
    rows, row_lines, heading = list[list[float]](), list[tuple[int, str]](), list[tuple[int, str]]()

    def close(last: bool = False) -> None:
        if rows:
            header = _header([line for _, line in heading], layout.columns)
            values = np.array(rows)
            numbers, texts = zip(*row_lines, strict=True)
            # over a next table stands whatever its program has to say
            tells_stray = last or not _header([line for _, line in others], layout.columns)
            stray = _stray(others, layout.separator) if tells_stray else None
            tables.append(TextTable(header, values, numbers, tuple(heading), texts, layout.separator, stray))

    for number, line in lines:
        row = layout.row(line, bool(rows) and not others)
        if row is None:
            # a comment between rows parts nothing
            if not (rows and line.startswith(COMMENTS)) or others:
                others.append((number, line))
            continue
        if others or not rows:
            close()
            rows, row_lines, heading, others = [], [], others, []
        rows.append(row)
        row_lines.append((number, line))
    close(last=True)
    return tuple(_without_empty(table) for table in tables)


def _stray(lines: Sequence[tuple[int, str]], separator: str | None) -> tuple[int, str] | None:
    """The first line that looks like a broken row, with a number in it."""
    for number, line in lines:
        if line.startswith(COMMENTS) or _FOOTER.match(line):
            continue
        numbers = [number_of(cell, commas=True) for cell in cells_of(line, separator)]
        if any(value is not None and not math.isnan(value) for value in numbers):
            return number, line
    return None


def _without_empty(table: TextTable) -> TextTable:
    """Without last columns that nothing stands in: every row ends with a separator."""
    columns = table.values.shape[1]
    while columns > 1 and np.isnan(table.values[:, columns - 1]).all() and not any(table.texts(columns - 1)):
        columns -= 1
    if columns == table.values.shape[1]:
        return table
    # the line of names ends with a separator, too, or names the empty columns
    header = _header([line for _, line in table.lines_above], columns) or table.header[:columns]
    return replace(table, header=header, values=table.values[:, :columns])


def _header(lines_above: Sequence[str], columns: int) -> tuple[str, ...]:
    """Names of the columns with their units; empty where no line above the rows has as many."""
    lines = [line for line in lines_above if not _RULE.match(line)][-_HEADER:]
    for place in range(len(lines) - 1, -1, -1):
        names = _names(lines[place], columns)
        if not names:
            continue
        top = _names(lines[place - 1], columns) if place else ()
        if top and all(_UNIT_LINE.match(name) for name in names if name):
            return tuple(f"{name} [{unit.strip('[]() ')}]" for name, unit in zip(top, names, strict=True))
        return names
    return ()


def _names(line: str, columns: int) -> tuple[str, ...]:
    """Names of a line that has so many, however they are separated, and does not begin with a number; else none."""
    text = line.strip().lstrip("".join(COMMENTS)).strip()
    single = [[text]] if columns == 1 and not re.search(r"[;\t]", text) else []
    for way in (*single, *(re.split(separator, text.rstrip(";,\t ")) for separator in _BETWEEN_NAMES)):
        first = number_of(way[0].strip())
        if len(way) == columns and (first is None or math.isnan(first)):
            return tuple(cell.strip().strip('"').strip() for cell in way)
    return ()
