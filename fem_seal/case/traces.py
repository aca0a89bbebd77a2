"""Roundness, flatness and waviness traces from text files, also as measuring instruments write them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.errors import QuantityError, TextTableError
from fem_seal.files import UnreadableFileError, read_text
from fem_seal.form import Trace
from fem_seal.units import parse_quantity

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fem_seal.arrays import FloatArray

# Rows of numbers that make a trace; an instrument's list of results has fewer.
_FEWEST_ROWS = 8
_ANGLES = ("angle", "phi", "theta", "winkel", "degree", "deg", "position", "azimuth", "c")
_SEPARATORS = (";", "\t", ",", None)
_UNIT = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]|_([A-Za-zµμ]+)$|\bin\s+([A-Za-zµμ°]+)$")
_ANGLE_UNITS = {"°": "deg", "grad": "deg", "degree": "deg", "degrees": "deg"}


def read_trace(file: str | Path, unit: str | None = None) -> Trace:
    """A trace of one turn.

    Lines before the numbers are skipped but for the last, which names the columns if it has as many words. Columns are
    separated by semicolons, tabs, commas or spaces; with semicolons and tabs numbers may have decimal commas. A file of
    one column holds deviations at uniform angles around the whole turn. Rows without a number, where the probe lost the
    surface, are left out.

    Parameters
    ----------
    file : path
    unit : str, optional
        Of the deviation, where the header has none.

    Raises
    ------
    TextTableError
        If there is no such trace in it, or nobody says in which unit.
    """
    import numpy as np

    lines = _lines(file)
    separator, start, rows = _longest_block(lines)
    if len(rows) < _FEWEST_ROWS:
        raise TextTableError(
            f"has no {_FEWEST_ROWS} rows of numbers one after the other; a trace has the columns angle and deviation"
        )
    values = np.array(rows)
    header = _header(lines[:start], separator, values.shape[1])
    if values.shape[1] == 1:
        deviation, at = values[:, 0], 0
        angle = 2 * np.pi * np.arange(len(values)) / len(values)
        kept = np.isfinite(deviation)
    else:
        place = _angle_column(header)
        at = next(n for n in range(values.shape[1]) if n != place)
        angle = values[:, place] * _angle_factor(header[place] if header else "", values[:, place])
        deviation = values[:, at]
        kept = np.isfinite(angle) & np.isfinite(deviation)
    found = unit or _unit_in(header[at] if header else "")
    if found is None:
        raise TextTableError(
            'does not say the unit of the deviation; write it into the header, such as "angle [deg], deviation [um]", '
            'or give unit = "um" beside file'
        )
    try:
        factor = parse_quantity(f"1 {found}", "length")
    except QuantityError as error:
        raise TextTableError(f"has a deviation whose {error}") from None
    angle, deviation = angle[kept], factor * deviation[kept]
    if len(angle) < _FEWEST_ROWS:
        raise TextTableError(f"has no more than {len(angle)} points with a number")
    turn = float(np.ptp(angle))
    if turn > 2 * np.pi * 1.001 + 1e-9:
        raise TextTableError(f"goes {turn / (2 * np.pi):.3g} times around the axis; keep one turn")
    largest = float(np.ptp(deviation))
    if largest > 1e-2:
        raise TextTableError(f"has deviations over {1e3 * largest:.3g} mm; check their unit")
    return Trace(angle, deviation)


def _lines(file: str | Path) -> list[str]:
    try:
        return read_text(Path(file)).splitlines()
    except UnicodeDecodeError:
        raise TextTableError(
            "is not a text file; export the trace as text with angle and deviation"
        ) from None
    except UnreadableFileError as error:
        raise TextTableError(str(error)) from None


def _longest_block(lines: Sequence[str]) -> tuple[str | None, int, list[list[float]]]:
    """Separator, first line and numbers of the longest run of rows with equally many columns."""
    best: tuple[str | None, int, list[list[float]]] = (None, 0, [])
    for separator in _SEPARATORS:
        start, rows = 0, list[list[float]]()
        for number, line in enumerate(lines):
            row = _numbers(line, separator)
            if row and (not rows or len(row) == len(rows[0])):
                start = start if rows else number
                rows.append(row)
            else:
                start, rows = number, [row] if row else []
            wide = len(rows[0]) if rows else 0
            if (len(rows), wide) > (len(best[2]), len(best[2][0]) if best[2] else 0):
                best = separator, start, list(rows)
    return best


def _numbers(line: str, separator: str | None) -> list[float]:
    """Numbers of a line; NaN where a cell after the first is empty or a word for nothing; empty if it is no row."""
    cells = [cell.strip().strip('"') for cell in line.strip().rstrip(separator or "").split(separator)]
    if separator in (";", "\t"):
        cells = [cell.replace(",", ".") for cell in cells]
    found = list[float]()
    for place, cell in enumerate(cells):
        try:
            number = float(cell)
        except ValueError:
            if place == 0 or cell.lower() not in ("", "-", "--", "---", "n/a", "na", "bad", "*"):
                return []
            number = float("nan")
        found.append(number if abs(number) < float("inf") else float("nan"))
    return found


def _header(before: Sequence[str], separator: str | None, columns: int) -> list[str]:
    """Names of the columns; empty where the line before the numbers is none."""
    named = [line for line in before if line.strip()]
    if not named:
        return []
    cells = [cell.strip().strip('"') for cell in named[-1].lstrip("#").strip().split(separator)]
    return cells if len(cells) == columns else []


def _angle_column(header: Sequence[str]) -> int:
    words = [re.sub(r"[^a-zµμ].*", "", name.lower()) for name in header]
    return next((n for n, word in enumerate(words) if word in _ANGLES), 0)


def _unit_in(name: str) -> str | None:
    found = _UNIT.search(name)
    return next((group for group in found.groups() if group), None) if found else None


def _angle_factor(name: str, values: FloatArray) -> float:
    """From the column's numbers to radian."""
    import numpy as np

    unit = _unit_in(name)
    if unit is None:
        # a turn in degrees has numbers that none in radian has
        unit = "deg" if float(np.nanmax(np.abs(values))) > 2 * np.pi * 1.01 else None
    if unit is None:
        raise TextTableError(
            'does not say the unit of the angle; write it into the header, such as "angle [deg]"'
        )
    try:
        return parse_quantity(f"1 {_ANGLE_UNITS.get(unit.lower(), unit)}", "angle")
    except QuantityError as error:
        raise TextTableError(f"has an angle whose {error}") from None
