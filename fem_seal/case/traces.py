"""Roundness, flatness and waviness traces from text files, also as measuring instruments write them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fem_seal.arrays import FloatArray
from fem_seal.case.words import sentence
from fem_seal.errors import QuantityError, TextTableError
from fem_seal.files import (
    Names,
    UnreadableFileError,
    column,
    find_columns,
    lines_of_table,
    read_bytes,
    read_text_table,
)
from fem_seal.form import Trace
from fem_seal.units import parse_quantity

# Rows of numbers that make a trace; an instrument's list of results has fewer.
_FEWEST_ROWS = 8
_ANGLES = ("angle", "phi", "theta", "winkel", "degree", "degrees", "deg", "position", "azimuth", "c")
_DEVIATIONS = ("deviation", "dev", "abweichung", "profile", "profil", "height", "residual", "error")
_SEPARATORS = (";", "\t", ",", None)
# Between the names of columns, in the order in which they are tried: names may hold spaces, and commas in brackets.
_BETWEEN_NAMES = (r";", r"\t", r",(?![^\[(]*[\])])", r"\s{2,}", r"(?<=[\])])\s+", r"\s+(?![\[(])")
# "deviation [um]", "deviation / um", "deviation in um", "deviation_um", "deviation um"
_UNITS = (r"[\[(]\s*([^\])]+?)\s*[\])]", r"/\s*(\S+)$", r"\bin\s+(\S+)$", r"_([^_\s]+)$", r"\s(\S+)$")
# What instruments write where they have no reading.
_NOTHING = ("n/a", "#n/a", "na", "bad", "invalid", "null")
_ANGLE_UNITS = {"°": "deg", "grad": "deg", "degree": "deg", "degrees": "deg", "radians": "rad"}
_LENGTH_UNITS = {"microns": "micron", "µ": "um", "μ": "um", "uinch": "uin", "µinch": "uin"}


def read_trace(file: str | Path, unit: str | None = None) -> Trace:
    """A trace of one turn.

    Lines before the numbers are skipped but for the last, which names the columns if it has as many words; units may
    stand in a line of their own below the names. Columns are separated by semicolons, tabs, commas or spaces; unless
    they are commas, numbers may have decimal commas. A file of one column holds deviations at uniform angles around
    the whole turn; a last one that repeats the first closes the turn. Rows without a number, where the probe lost the
    surface, are left out.

    Parameters
    ----------
    file : path
        Text in UTF-8, UTF-16 or Latin-1.
    unit : str, optional
        Of the deviation, where the header has none.

    Raises
    ------
    TextTableError
        If there is no such trace in it, or nobody says in which unit.
    """
    import numpy as np

    lines = _lines(file)
    table = max((_block(lines, separator) for separator in _SEPARATORS), key=lambda one: one.rank)
    if len(table.rows) < _FEWEST_ROWS:
        raise TextTableError(sentence("trace_rows", fewest=_FEWEST_ROWS))
    values = np.array(table.rows)
    if values.shape[1] == 1:
        deviation, at = _one_turn(values[:, 0]), 0
        angle = 2 * np.pi * np.arange(len(deviation)) / len(deviation)
    else:
        place, at = _columns(table.header)
        angle, deviation = values[:, place], values[:, at]
        angle = angle * _factor_of(_angle_unit(table.name(place), angle), "angle")
    kept = np.isfinite(angle) & np.isfinite(deviation)
    if kept.sum() < _FEWEST_ROWS:
        raise TextTableError(sentence("trace_points", number=kept.sum(), fewest=_FEWEST_ROWS))
    factor = _factor_of(unit or _unit_in(table.name(at), "length"), "length")
    angle, deviation = angle[kept], deviation[kept] * factor
    turn = float(np.ptp(angle))
    if turn > 2 * np.pi * 1.001 + 1e-9:
        raise TextTableError(f"goes {turn / (2 * np.pi):.3g} times around the axis; keep one turn")
    largest = float(np.ptp(deviation))
    if largest > 1e-2:
        raise TextTableError(f"has deviations over {1e3 * largest:.3g} mm; check their unit")
    return Trace(angle, deviation)


@dataclass(frozen=True)
class _Block:
    """A run of rows of numbers, and the names over its columns, empty where there are none."""

    header: tuple[str, ...] = ()
    rows: tuple[tuple[float, ...], ...] = ()

    @property
    def rank(self) -> tuple[int, bool, int]:
        """The longest block is the trace; of equals the one whose columns have names, then that with more columns."""
        return len(self.rows), bool(self.header), len(self.rows[0]) if self.rows else 0

    def name(self, place: int) -> str:
        return self.header[place] if self.header else ""


def _lines(file: str | Path) -> list[str]:
    try:
        content = read_bytes(Path(file))
    except UnreadableFileError as error:
        raise TextTableError(str(error)) from None
    marked = content[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        text = content.decode("utf-16" if marked else "utf-8-sig")
    except UnicodeDecodeError:
        # every sequence of bytes is Latin-1; in it instruments write the micro and the degree sign
        text = content.decode("latin-1")
    if "\0" in text:
        raise TextTableError("is not a text file; export the trace as text with angle and deviation")
    return lines_of_table(text)


def _block(lines: Sequence[str], separator: str | None) -> _Block:
    """The longest run of rows of numbers, if columns are separated so."""
    longest, start, rows = (0, list[list[float]]()), 0, list[list[float]]()
    for number, line in enumerate([*lines, ""]):
        row = _numbers(line, separator)
        # a row that ends early lacks its last numbers
        if row and (not rows or len(row) <= len(rows[0])):
            start = start if rows else number
            rows.append(row)
        else:
            start, rows = number, [row] if row else []
        if len(rows) > len(longest[1]):
            longest = start, rows
    start, rows = longest
    cells = max(map(len, rows), default=0)
    header = _header(lines[:start], cells)
    if not header:
        # what ends with a separator in every row has one column less than cells
        known = (n for row in rows for n, value in enumerate(row, start=1) if not math.isnan(value))
        cells = max(known, default=0)
        header = _header(lines[:start], cells)
    return _Block(header, tuple(tuple((row + [math.nan] * cells)[:cells]) for row in rows))


def _numbers(line: str, separator: str | None) -> list[float]:
    """Numbers of a line; NaN where a cell is empty or a word for nothing; empty if it is no row."""
    if not line.strip():
        return []
    cells = [cell.strip().strip('"') for cell in line.strip(" \r\n").split(separator)]
    found = list[float]()
    for cell in cells:
        number = _number(cell if separator == "," else cell.replace(",", "."))
        if number is None:
            return []
        found.append(number)
    # what begins with a word is no row of a table, but a word alone may be a reading of one column
    return found if len(found) == 1 or not math.isnan(found[0]) else []


def _number(cell: str) -> float | None:
    """A number; NaN for nothing and for a word without letters, or one that says that there is none; else None."""
    try:
        number = float(cell)
    except ValueError:
        nothing = not any(c.isalnum() for c in cell) or cell.lower() in _NOTHING
        return math.nan if nothing else None
    return number if math.isfinite(number) else math.nan


def _header(before: Sequence[str], columns: int) -> tuple[str, ...]:
    """Names of the columns with their units; empty where the line before the numbers has not as many."""
    named = [line for line in before if line.strip()]
    if not named:
        return ()
    last = _cells(named[-1], columns)
    if last and len(named) > 1 and all(_is_unit(cell) for cell in last if cell):
        # no names if the line above has not as many
        pairs = zip(_cells(named[-2], columns), last, strict=False)
        return tuple(f"{name} [{cell.strip('[]() ')}]" for name, cell in pairs)
    return last


def _cells(line: str, columns: int) -> tuple[str, ...]:
    """Names of a line that has so many, however they are separated; else none."""
    text = line.strip().lstrip("#").strip()
    whole = [[text]] if columns == 1 and not re.search(r"[;\t]", text) else []
    for way in (*whole, *(re.split(between, text.rstrip(";,\t ")) for between in _BETWEEN_NAMES)):
        if len(way) == columns:
            return tuple(cell.strip().strip('"') for cell in way)
    return ()


def _is_unit(cell: str) -> bool:
    unit = cell.strip("[]() ")
    return _factor(unit, "length") is not None or _factor(unit, "angle") is not None


def _columns(header: Sequence[str]) -> tuple[int, int]:
    """Places of angle and deviation: by their names, by a unit of length, else the first two."""
    words = [re.sub(r"[^a-z].*", "", name.lower()) for name in header]
    angle = next((n for n, word in enumerate(words) if word in _ANGLES), 0)
    others = [n for n in range(len(words)) if n != angle] or [1]
    named = [n for n in others if words and words[n] in _DEVIATIONS]
    lengths = [n for n in others if header and _factor(_unit_in(header[n], "length"), "length") is not None]
    return angle, [*named, *lengths, *others][0]


def _one_turn(deviation: FloatArray) -> FloatArray:
    """Readings around a turn without the last, where it is the first once more.

    Instruments take an even number of points; with an odd one the point at 360 degrees is among them.
    """
    closed = len(deviation) % 2 == 1 and deviation[0] == deviation[-1]
    return deviation[:-1] if closed else deviation


def _unit_in(name: str, dimension: str) -> str | None:
    """The unit that a column's name holds: the first that fits, else what stands in brackets."""
    found = [match[1] for match in (re.search(pattern, name) for pattern in _UNITS) if match]
    fitting = (unit for unit in found if _factor(unit, dimension) is not None)
    return next(fitting, found[0] if re.search(_UNITS[0], name) else None)


def _factor(unit: str | None, dimension: str) -> float | None:
    """One of the unit in SI; None if it is no unit of the dimension."""
    try:
        return None if unit is None else _in_si(unit, dimension)
    except QuantityError:
        return None


def _in_si(unit: str, dimension: str) -> float:
    spellings = _ANGLE_UNITS if dimension == "angle" else _LENGTH_UNITS
    return parse_quantity(f"1 {spellings.get(unit.lower(), unit)}", dimension)


def _factor_of(unit: str | None, dimension: str) -> float:
    """From the numbers of a column in a unit to SI; TextTableError where there is none of the dimension."""
    if unit is None:
        raise TextTableError(sentence(f"trace_without_unit_of_{dimension}"))
    try:
        return _in_si(unit, dimension)
    except QuantityError as error:
        raise TextTableError(sentence(f"trace_{dimension}", error=error)) from None


def _angle_unit(name: str, values: FloatArray) -> str | None:
    """Unit of a column with angles; a turn in degrees has numbers that none in radian has."""
    import numpy as np

    unit = _unit_in(name, "angle")
    degrees = unit is None and float(np.nanmax(np.abs(values))) > 2 * np.pi * 1.01
    return "deg" if degrees else unit


_PROFILE: Names = {
    "x": ("length", ("x", "s", "position", "distance", "length")),
    "z": ("length", ("z", "y", "height", "profile", "deviation")),
}
# Waves of the strongest period that a profile must hold, and share of its variance that this one must carry.
_FEWEST_PERIODS, _LEAST_SHARE = 3, 0.3
# No profile is shorter, and no lay lower [m].
_SHORTEST, _LOWEST = 1e-9, 1e-14


def read_lay(file: str | Path) -> tuple[float, float]:
    """Pitch and depth [m] of the lay in a profile measured across it: those of its strongest wave.

    Parameters
    ----------
    file : path
        Text with the columns x and z and their units.

    Raises
    ------
    TextTableError
        If it is no such table, too short, or no wave stands out.
    """
    import numpy as np
    from scipy.optimize import minimize_scalar

    table = read_text_table(file)
    places = find_columns(table, _PROFILE, 'such as "x [mm], z [um]"')
    if set(places) != set(_PROFILE):
        raise TextTableError(f"must have columns x and z; its columns are {', '.join(table.header)}")
    x, z = (column(table, places[role], "length") for role in ("x", "z"))
    length = float(np.ptp(x))
    if len(x) < 4 * _FEWEST_PERIODS or not length > _SHORTEST:
        raise TextTableError(f"has {len(x)} points; a lay takes more")
    z = z - np.polyval(np.polyfit(x, z, 2), x)

    def fitted(wavenumber: float) -> tuple[float, float]:
        """Amplitude of a wave and the share of the variance that it carries."""
        waves = np.column_stack([np.cos(wavenumber * x), np.sin(wavenumber * x)])
        found = np.linalg.lstsq(waves, z, rcond=None)[0]
        return float(np.hypot(*found)), float(np.var(waves @ found) / np.var(z))

    first, last = 2 * np.pi * _FEWEST_PERIODS / length, 0.5 * np.pi * len(x) / length
    tried = np.arange(first, last, 0.25 * np.pi / length)
    if not np.ptp(z) > _LOWEST or len(tried) == 0:
        raise TextTableError("is even, or too short, and shows no lay")
    near = float(tried[int(np.argmax([fitted(k)[1] for k in tried]))])
    best = minimize_scalar(
        lambda k: -fitted(k)[1], bounds=(near - np.pi / length, near + np.pi / length), method="bounded"
    )
    amplitude, share = fitted(float(best.x))
    if share < _LEAST_SHARE:
        shares = {"share": 100 * share, "least": 100 * _LEAST_SHARE}
        raise TextTableError(sentence("no_lay", length=2e6 * np.pi / best.x, **shares))
    return 2 * np.pi / float(best.x), 2 * amplitude
