"""Roundness, flatness and waviness traces from text files, also as measuring instruments write them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.arrays import FloatArray
from fem_seal.errors import QuantityError, TextTableError
from fem_seal.files import Names, column, find_columns, problem, read_any_text, read_text_table
from fem_seal.form import Trace
from fem_seal.units import parse_quantity

if TYPE_CHECKING:
    from leak.text_tables import TextTable

# Rows of numbers that make a trace; an instrument's list of results has fewer.
_FEWEST_ROWS = 8
_ANGLES = ("angle", "phi", "theta", "winkel", "degree", "degrees", "deg", "position", "azimuth", "c")
_DEVIATIONS = ("deviation", "dev", "abweichung", "profile", "profil", "height", "residual", "error")
# "deviation [um]", "deviation / um", "deviation in um", "deviation_um", "deviation um"
_UNITS = (r"[\[(]\s*([^\])]+?)\s*[\])]", r"/\s*(\S+)$", r"\bin\s+(\S+)$", r"_([^_\s]+)$", r"\s(\S+)$")
_ANGLE_UNITS = {"°": "deg", "grad": "deg", "degree": "deg", "degrees": "deg", "radians": "rad"}
_LENGTH_UNITS = {"microns": "micron", "µ": "um", "μ": "um", "uinch": "uin", "µinch": "uin"}


def read_trace(file: str | Path, unit: str | None = None) -> Trace:
    """A trace of one turn.

    The longest table of the file, see `leak.text_tables.read_tables`. A file of one column holds deviations at uniform
    angles around the whole turn; a last one that repeats the first closes the turn. Rows without a number, where the
    probe lost the surface, are left out.

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

    table = _longest(file)
    values = table.values
    if values.shape[1] == 1:
        deviation, at = _one_turn(values[:, 0]), 0
        angle = 2 * np.pi * np.arange(len(deviation)) / len(deviation)
    else:
        place, at = _columns(table.header)
        angle, deviation = values[:, place], values[:, at]
        angle = angle * _factor_of(_angle_unit(_name(table, place), angle), "angle")
    is_finite = np.isfinite(angle) & np.isfinite(deviation)
    if is_finite.sum() < _FEWEST_ROWS:
        raise TextTableError(problem("trace_points", number=is_finite.sum(), fewest=_FEWEST_ROWS))
    factor = _factor_of(unit or _unit_in(_name(table, at), "length"), "length")
    angle, deviation = angle[is_finite], deviation[is_finite] * factor
    turn = float(np.ptp(angle))
    if turn > 2 * np.pi * 1.001 + 1e-9:
        raise TextTableError(f"goes {turn / (2 * np.pi):.3g} times around the axis; keep one turn")
    largest = float(np.ptp(deviation))
    if largest > 1e-2:
        raise TextTableError(f"has deviations over {1e3 * largest:.3g} mm; check their unit")
    return Trace(angle, deviation)


def _longest(file: str | Path) -> TextTable:
    """The longest table of a file: instruments write lists of results beside a trace."""
    from leak.errors import TableError
    from leak.text_tables import read_tables

    try:
        table = max(read_tables(read_any_text(file)), key=lambda text_table: len(text_table.rows))
    except TableError as error:
        raise TextTableError(str(error)) from None
    if len(table.rows) < _FEWEST_ROWS:
        raise TextTableError(problem("trace_rows", fewest=_FEWEST_ROWS))
    return table


def _name(table: TextTable, place: int) -> str:
    return table.header[place] if table.header else ""


def _columns(header: Sequence[str]) -> tuple[int, int]:
    """Places of angle and deviation: by their names, by a unit of length, else the first two."""
    words = [re.sub(r"[^a-z].*", "", name.lower()) for name in header]
    angle = next((n for n, word in enumerate(words) if word in _ANGLES), 0)
    others = [n for n in range(len(words)) if n != angle] or [1]
    with_name = [n for n in others if words and words[n] in _DEVIATIONS]
    lengths = [n for n in others if header and _factor(_unit_in(header[n], "length"), "length") is not None]
    return angle, [*with_name, *lengths, *others][0]


def _one_turn(deviation: FloatArray) -> FloatArray:
    """Readings around a turn without the last, where it is the first once more.

    Instruments take an even number of points; with an odd one the point at 360 degrees is among them.
    """
    is_closed = len(deviation) % 2 == 1 and deviation[0] == deviation[-1]
    return deviation[:-1] if is_closed else deviation


def _unit_in(name: str, dimension: str) -> str | None:
    """The unit that a column's name holds: the first that fits, else what stands in brackets."""
    units = [match[1] for match in (re.search(pattern, name) for pattern in _UNITS) if match]
    units_of_dimension = (unit for unit in units if _factor(unit, dimension) is not None)
    return next(units_of_dimension, units[0] if re.search(_UNITS[0], name) else None)


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
        raise TextTableError(problem(f"trace_without_unit_of_{dimension}"))
    try:
        return _in_si(unit, dimension)
    except QuantityError as error:
        raise TextTableError(problem(f"trace_{dimension}", error=error)) from None


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

    def fit_wave(wavenumber: float) -> tuple[float, float]:
        """Amplitude of a wave and the share of the variance that it carries."""
        waves = np.column_stack([np.cos(wavenumber * x), np.sin(wavenumber * x)])
        coefficients = np.linalg.lstsq(waves, z, rcond=None)[0]
        return float(np.hypot(*coefficients)), float(np.var(waves @ coefficients) / np.var(z))

    lowest, highest = 2 * np.pi * _FEWEST_PERIODS / length, 0.5 * np.pi * len(x) / length
    wavenumbers = np.arange(lowest, highest, 0.25 * np.pi / length)
    if not np.ptp(z) > _LOWEST or len(wavenumbers) == 0:
        raise TextTableError("is even, or too short, and shows no lay")
    peak = float(wavenumbers[int(np.argmax([fit_wave(k)[1] for k in wavenumbers]))])
    best = minimize_scalar(
        lambda k: -fit_wave(k)[1], bounds=(peak - np.pi / length, peak + np.pi / length), method="bounded"
    )
    amplitude, share = fit_wave(float(best.x))
    if share < _LEAST_SHARE:
        shares = {"share": 100 * share, "least": 100 * _LEAST_SHARE}
        raise TextTableError(problem("no_lay", length=2e6 * np.pi / best.x, **shares))
    return 2 * np.pi / float(best.x), 2 * amplitude
