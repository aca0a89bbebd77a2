"""Line scans from text: two columns, position and height, with or without a header that states their units."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from leak.errors import ScanError
from leak.length_units import LENGTH_UNITS, Unit, agreed, two_units
from leak.topography import LineScan, line_scan

_UNIT = "|".join(sorted(map(re.escape, LENGTH_UNITS), key=len, reverse=True))
# "x [mm]", "height (um)", "Lateral um", "x_m"
_IN_HEADING = re.compile(rf"[\[(]\s*({_UNIT})\s*[\])]|(?:^|[\s_/,])({_UNIT})$", re.IGNORECASE)
_TIP = re.compile(rf"(?:stylus|tip)\b.*?radius\D*?(\d+(?:\.\d*)?)\s*({_UNIT})\b", re.IGNORECASE)
# An instrument's header is shorter than this; a longer text without numbers is none.
_LONGEST_HEADER = 300
# Control characters other than tab, line feed, form feed and carriage return do not occur in text.
_CONTROL = re.compile("[\x00-\x08\x0b\x0e-\x1f\x7f]")


class NotColumnsError(ScanError):
    """A file is no text with two columns; another reader may know it."""


@dataclass(frozen=True)
class _Block:
    """Text lines above the numbers, and the lines of numbers with their place in the file."""

    header: tuple[str, ...]
    rows: tuple[tuple[int, str], ...]


def read_text_scan(path: Path, unit: Unit | None = None) -> LineScan:
    """Line scan from a text file.

    Two columns of numbers, position and height, separated by comma, semicolon, tab or spaces; a third column called
    "valid" with 0 for invalid points is honoured. Units are taken from the heading ("x [mm]", "Lateral um") or from
    `unit`. Lines that begin with # count as heading.

    Parameters
    ----------
    path : pathlib.Path
    unit : str or two of them, optional
        Unit of both columns, or of x and height; needed where the file states none.

    Raises
    ------
    NotColumnsError
        No text, or not two columns.
    ScanError
        Empty, a line that is not like the others, NaN, no unit, or what `line_scan` refuses.
    """
    block = _numbers_of(_decoded(path.read_bytes()))
    headings = [_headings(line) for line in block.header[-3:]]
    with_flag = any(len(cells) == 3 and cells[2].lower() == "valid" for cells in headings)
    columns = 3 if with_flag else 2
    values = _table(block, columns)
    # a heading of another number of cells is none, and a unit in it could belong to either column
    headings = [cells for cells in headings if len(cells) == columns]
    stated = [_stated_unit(headings, column) for column in (0, 1)]
    units = [
        agreed(name, one, given)
        for name, one, given in zip(("x", "height"), stated, two_units(unit), strict=True)
    ]
    valid = values[:, 2] != 0.0 if with_flag else np.ones(len(values), dtype=bool)
    x, h = values[valid, 0] * units[0], values[valid, 1] * units[1]
    return line_scan(x, h, name=path.name, tip_radius=_tip_radius(block.header))


def _decoded(content: bytes) -> str:
    if not content.strip(b"\x00 \t\r\n"):
        raise ScanError("is empty")
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = content.decode("utf-16", errors="replace")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("latin-1")
    if _CONTROL.search(text):
        raise NotColumnsError("is not a text file")
    return text


def _numbers_of(text: str) -> _Block:
    lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    numeric = [number for number, (_, line) in enumerate(lines[:_LONGEST_HEADER]) if _row(line) is not None]
    if not numeric:
        raise NotColumnsError("holds no columns of numbers")
    # a number may stand alone in a header
    first = next((n for n in numeric if n + 1 in numeric), numeric[0])
    return _Block(tuple(line for _, line in lines[:first]), tuple(lines[first:]))


def _table(block: _Block, columns: int) -> np.ndarray:
    first = _row(block.rows[0][1]) or []
    if len(first) != columns:
        raise NotColumnsError(
            f"line {block.rows[0][0]} holds {len(first)} column{'s' * (len(first) != 1)}: must hold two, x and height"
        )
    rows = []
    for number, line in block.rows:
        row = _row(line)
        if row is None or len(row) != columns:
            raise ScanError(
                f'line {number} ("{line[:40]}"): must hold {columns} numbers, like line {block.rows[0][0]}'
            )
        rows.append(row)
    values = np.array(rows)
    bad = ~np.isfinite(values).all(axis=1)
    if bad.any():
        number, line = block.rows[int(np.argmax(bad))]
        raise ScanError(f'line {number} ("{line[:40]}"): must hold finite numbers')
    return values


def _row(line: str) -> list[float] | None:
    """The numbers of a line, None if anything else stands in it."""
    try:
        return [float(cell) for cell in _cells(line)]
    except ValueError:
        return None


def _cells(line: str) -> list[str]:
    """Cells of a line without empty ones at its end; decimal commas where no comma separates."""
    if re.search(r"[;\t]", line):
        cells = [cell.strip() for cell in re.split(r"[;\t]", line)]
        cells = [
            cell.replace(",", ".") if re.fullmatch(r"[+-]?\d+,\d+(e[+-]?\d+)?", cell, re.I) else cell
            for cell in cells
        ]
    elif "," in line:
        cells = [cell.strip() for cell in line.split(",")]
    else:
        cells = line.split()
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _headings(line: str) -> list[str]:
    """Cells of a heading, a unit in brackets with what stands before it."""
    return _cells(re.sub(r"\s+([\[(])", r"\1", line.lstrip("# ")))


def _stated_unit(headings: list[list[str]], column: int) -> float | None:
    for cells in reversed(headings):
        found = _IN_HEADING.search(cells[column].strip('"'))
        if found:
            return LENGTH_UNITS[(found[1] or found[2]).lower()]
    return None


def _tip_radius(header: tuple[str, ...]) -> float | None:
    for line in header:
        found = _TIP.search(line)
        if found and float(found[1]) > 0.0:
            return float(found[1]) * LENGTH_UNITS[found[2].lower()]
    return None
