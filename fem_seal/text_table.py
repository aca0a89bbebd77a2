"""Columns of numbers from a text file, as other programs export them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.errors import SealError
from fem_seal.regular_files import UnreadableFileError, read_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class TextTableError(SealError, ValueError):
    """A file is not a table of numbers, or not the one that is wanted."""


@dataclass(frozen=True)
class TextTable:
    """Numbers of a text file.

    Parameters
    ----------
    header : tuple of str
        Column names, empty if the file has none.
    values : ndarray, shape (rows, columns)
        The numbers, as they stand there.
    lines : tuple of int
        Line of the file in which each row stands.
    """

    header: tuple[str, ...]
    values: NDArray[np.float64]
    lines: tuple[int, ...]


def read_text_table(file: str | Path) -> TextTable:
    """Table of a text file with columns separated by comma, semicolon, tab or spaces.

    The first line may be a header. Empty lines and lines that begin with # are skipped.

    Parameters
    ----------
    file : path

    Raises
    ------
    TextTableError
        If the file is missing, no text, empty, or a line does not hold as many numbers as the first; NaN and
        infinity are no numbers.
    """
    import numpy as np

    lines = [(number, line.strip()) for number, line in enumerate(_read_lines(file), start=1)]
    lines = [(number, line) for number, line in lines if line and not line.startswith("#")]
    if not lines:
        raise TextTableError("is empty; a table of numbers is needed")
    header = () if _numbers(lines[0][1]) else _cells(lines[0][1], keep_spaces=True)
    rows = lines[1:] if header else lines
    if not rows:
        raise TextTableError("has a header but no rows of numbers")
    for number, line in rows:
        if _has_decimal_commas(line):
            raise TextTableError(
                f'line {number} ("{line[:40]}") has decimal commas; write decimal points, such as 0.1; 200.5'
            )
    values = [_numbers(line) for _, line in rows]
    columns = len(values[0]) or len(header)
    for (number, line), row in zip(rows, values, strict=True):
        if len(row) != columns:
            found = f"{len(row)}" if row else "something else"
            raise TextTableError(
                f'line {number} ("{line[:40]}") must hold {columns} finite numbers, it holds {found}'
            )
    return TextTable(header, np.array(values), tuple(number for number, _ in rows))


def _read_lines(file: str | Path) -> list[str]:
    try:
        text = read_text(file)
    except UnicodeDecodeError:
        raise TextTableError("is not a text file; a table of numbers is needed") from None
    except UnreadableFileError as error:
        raise TextTableError(str(error)) from None
    if "\0" in text:
        raise TextTableError("is not a text file; a table of numbers is needed")
    return text.splitlines()


def _cells(line: str, *, keep_spaces: bool = False) -> tuple[str, ...]:
    # a header such as "x [m], p [Pa]" has spaces inside its names; numbers never have
    separated = keep_spaces and re.search(r"[,;\t]", line)
    cells = re.split(r"\s*[,;\t]\s*" if separated else r"\s*[,;\t]\s*|\s+", line)
    return tuple(cell.strip().strip('"') for cell in cells)


def _has_decimal_commas(line: str) -> bool:
    """Whether commas stand between digits although something else separates the columns."""
    return bool(re.search(r"\d,\d", line) and re.search(r"\d\s*[;\s]\s*[-+.\d]", line))


def _numbers(line: str) -> list[float]:
    """The numbers of a line; empty if anything else stands in it."""
    try:
        numbers = [float(cell) for cell in _cells(line)]
    except ValueError:
        return []
    return numbers if all(abs(number) < float("inf") for number in numbers) else []
