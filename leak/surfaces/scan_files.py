"""Line scans and height maps from the files of instruments, and from text."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ScanError, TableError
from leak.extras import say_missing
from leak.surfaces.likely_units import LENGTH_UNITS, check_length, check_likely
from leak.surfaces.scans import LineScan, Topography, height_map, line_scan
from leak.text_tables import TextTable, decode, only_table, read_tables

_NO_SIZE = "does not state how long and wide the measured area is; export it in a format that does"


def read_topography(path: str | PathLike[str], *, unit: Unit | None = None) -> Topography:
    """Line scan or height map from a file.

    Text of two columns is read directly; all other formats through SurfaceTopography (the extra ``surfaces``).

    Parameters
    ----------
    path : path
        File of an instrument, or text with position and height.
    unit : str or two of them, optional
        Unit of length of x and height ("um"), or of each (("mm", "um")), where the file states none; a unit that
        contradicts the file is refused.

    Returns
    -------
    LineScan or HeightMap
        Positions and heights [m].

    Raises
    ------
    ScanError
        If the file cannot be read, holds no usable scan, or its units are unknown. The message begins with the path.

    Examples
    --------
    >>> read_topography("missing.csv")
    Traceback (most recent call last):
        ...
    leak.errors.ScanError: missing.csv: cannot be read (no such file or directory)
    """
    file = Path(path)
    try:
        try:
            return read_text_scan(file, unit)
        except NotColumnsError as not_columns:
            return _read_instrument_file(file, unit, str(not_columns))
    except (OSError, ValueError) as error:
        reason = str(error)
        if isinstance(error, OSError) or not isinstance(error, ScanError):
            reason = f"cannot be read ({(getattr(error, 'strerror', None) or 'not a file name').lower()})"
        raise ScanError(f"{file}: {reason}") from None


def read_topographies(
    paths: str | PathLike[str] | Sequence[str | PathLike[str]], *, unit: Unit | None = None
) -> tuple[Topography, ...]:
    """One or several scans of one surface, see `read_topography`.

    Parameters
    ----------
    paths : path or sequence of paths
        Files of the scans.
    unit : str or two of them, optional
        Where the files state none, the same for all.

    Raises
    ------
    ScanError
        A file cannot be read; the message names it.

    Examples
    --------
    >>> import leak
    >>> scans = leak.read_topographies(["scan1.csv", "scan2.csv"], unit="um")     # doctest: +SKIP
    """
    several = [paths] if isinstance(paths, (str, PathLike)) else list(paths)
    return tuple(read_topography(path, unit=unit) for path in several)


def _read_instrument_file(file: Path, unit: Unit | None, why_not_text: str) -> Topography:
    try:
        from SurfaceTopography.IO import open_topography
    except ImportError as error:
        raise ScanError(f"{why_not_text}; reading it otherwise {say_missing('surfaces', error)}") from None
    # the readers are others' code for dozens of binary formats, and a damaged file makes them raise anything
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with open_topography(str(file)) as reader:
                options = {} if reader.default_channel.unit is not None or unit is None else {"unit": "m"}
                topography = reader.topography(**options)
                return _convert_units(
                    topography, unit if options else None, reader.default_channel.unit, unit, file.name
                )
    except ScanError:
        raise
    except Exception as error:
        if "physical_sizes" in str(error):
            raise ScanError(f"{why_not_text}; as a matrix of heights it {_NO_SIZE}") from None
        # what a reader says of itself, "list index out of range", helps nobody
        raise ScanError(f"{why_not_text}, and SurfaceTopography cannot read it") from None


def _convert_units(
    topography: Any, given_unit: Unit | None, stated_unit: object, unit: Unit | None, name: str
) -> Topography:
    """Heights and positions in metres."""
    size = LENGTH_UNITS.get(str(stated_unit).strip().lower()) if stated_unit is not None else None
    if stated_unit is not None and size is None:
        raise ScanError(f"its unit, {stated_unit!r}, is not a length")
    in_x, in_h = (
        agree_unit(column, size, to_m) for column, to_m in zip(("x", "height"), two_units(unit), strict=True)
    )
    return check_likely(_in_metres(topography, in_x, in_h, name), (in_x, in_h))


def _in_metres(topography: Any, in_x: float, in_h: float, name: str) -> Topography:
    tip = _tip_radius(topography.info)
    if topography.dim == 1 and not topography.is_uniform:
        x, h = (
            size * np.asarray(values)
            for values, size in zip(topography.positions_and_heights(), (in_x, in_h), strict=True)
        )
        check_length(x, h, (in_x, in_h))
        return line_scan(x, h, name=name, tip_radius=tip)
    if topography.physical_sizes is None:
        raise ScanError(_NO_SIZE)
    heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan) * in_h
    steps = [
        length * in_x / n for length, n in zip(topography.physical_sizes, topography.nb_grid_pts, strict=True)
    ]
    if topography.dim == 1:
        return line_scan(np.arange(heights.size) * steps[0], heights, name=name, tip_radius=tip)
    return height_map(heights, (steps[0], steps[1]), name=name, tip_radius=tip)


def _tip_radius(info: Any) -> float | None:
    try:
        tip = info["instrument"]["parameters"]["tip_radius"]
        radius = float(tip["value"]) * LENGTH_UNITS[str(tip["unit"]).lower()]
    except (KeyError, TypeError, ValueError):
        return None
    return radius if 0.0 < radius < 1.0 else None


_UNIT = "|".join(sorted(map(re.escape, LENGTH_UNITS), key=len, reverse=True))
# "x [mm]", "height (um)", "Lateral um", "x_m"
_IN_HEADING = re.compile(rf"[\[(]\s*({_UNIT})\s*[\])]|(?:^|[\s_/,])({_UNIT})$", re.IGNORECASE)
_ANGLE = re.compile(r"angle\b|.*[\[(]\s*(?:deg|°|rad)", re.IGNORECASE)
_INDEX = re.compile(r"($|#|(index|idx|no|nr|n|i|point|pt|sample|row|id|count|number)\b)", re.IGNORECASE)
_TIP = re.compile(rf"(?:stylus|tip)\b.*?radius\D*?(\d+(?:\.\d*)?)\s*({_UNIT})\b", re.IGNORECASE)
# Characters of a line of an instrument's header that are looked into.
_LONGEST_LINE = 1000


class NotColumnsError(ScanError):
    """A file is no text with two columns; another reader may know it."""


def read_text_scan(path: Path, unit: Unit | None = None) -> LineScan:
    """Line scan from a text file.

    Two columns of numbers, position and height, see `leak.text_tables.read_tables`. A column before them that counts
    the points is passed over, and so is one that is the same everywhere; a last column called "valid" with 0 for
    invalid points is honoured. Units are taken from the heading ("x [mm]", "Lateral um") or from `unit`.

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
    try:
        tables = read_tables(decode(path.read_bytes()))
    except TableError as error:
        raise NotColumnsError(str(error)) from None
    table = tables[0]
    places = _places(table)
    if len(places) != 2:
        columns = table.values.shape[1]
        names = f" ({', '.join(table.header)})" if table.header else ""
        raise NotColumnsError(
            f"line {table.lines[0]} holds {columns} column{'s' * (columns != 1)}{names}: must hold two, x and height"
        )
    try:
        table = only_table(tables)
    except TableError as error:
        raise ScanError(str(error)) from None
    if any(map(_ANGLE.match, table.header[:1])):
        raise ScanError(
            "has an angle in its first column: it is a roundness trace, no scan; give it as the trace of a form error"
        )
    if table.header and _INDEX.match(table.header[places[0]]) and _counts(table.values[:, places[0]]):
        raise ScanError(
            "has numbers of points in place of x: it does not state how far apart the points are; give both columns"
        )
    units = [
        agree_unit(name, _stated_unit(table, column), to_m)
        for column, name, to_m in zip(places, ("x", "height"), two_units(unit), strict=True)
    ]
    flag = _flag(table)
    valid = np.ones(len(table.values), dtype=bool) if flag is None else table.values[:, flag] != 0.0
    x, h = (size * table.values[valid, column] for column, size in zip(places, units, strict=True))
    check_length(x, h, units)
    return check_likely(line_scan(x, h, name=path.name, tip_radius=_stated_tip_radius(table)), units)


def _places(table: TextTable) -> list[int]:
    """Columns that are left of a table without the numbers of its points, a flag, and what is the same everywhere."""
    values, flag = table.values, _flag(table)
    left = [place for place in range(values.shape[1]) if place != flag]
    counts = len(left) > 2 and _counts(values[:, left[0]])
    # without names a column that counts is that of the points only if x comes behind it
    if counts and (_INDEX.match(table.header[0]) if table.header else _runs_on(values[:, left[1]])):
        left = left[1:]
    return left if len(left) == 2 else [place for place in left if np.ptp(values[:, place]) > 0.0]


def _flag(table: TextTable) -> int | None:
    """The last of three or more columns, if it tells which points are valid."""
    last = table.header[-1].split() if len(table.header) > 2 else []
    return len(table.header) - 1 if last and last[0].lower() == "valid" else None


def _counts(numbers: FloatArray) -> bool:
    return len(numbers) > 1 and bool(np.all(np.diff(numbers) == 1.0))


def _runs_on(x: FloatArray) -> bool:
    steps = np.diff(x)
    return bool(np.all(steps > 0.0) or np.all(steps < 0.0))


def _stated_unit(table: TextTable, column: int) -> float | None:
    match = _IN_HEADING.search(table.header[column]) if table.header else None
    return LENGTH_UNITS[(match[1] or match[2]).lower()] if match else None


def _stated_tip_radius(table: TextTable) -> float | None:
    for _, line in table.lines_above:
        match = _TIP.search(line[:_LONGEST_LINE])
        if match and float(match[1]) > 0.0:
            return float(match[1]) * LENGTH_UNITS[match[2].lower()]
    return None


Unit = str | Sequence[str]


def length_unit(name: object) -> float:
    """Size of a unit of length [m]; ScanError if it is none."""
    size = LENGTH_UNITS.get(name.strip().lower()) if isinstance(name, str) else None
    if size is None:
        units = ", ".join(unit for unit in LENGTH_UNITS if unit.isascii())
        raise ScanError(f"unit = {name!r}: must be a unit of length: {units}")
    return size


def two_units(unit: Unit | None) -> tuple[float | None, float | None]:
    """Sizes of the units of x and height, from one unit for both or from two [m]."""
    if unit is None:
        return None, None
    units = [unit, unit] if isinstance(unit, str) else unit
    if len(units) != 2:
        raise ScanError(f'unit = {unit!r}: must be one unit, or two, those of x and height: ["mm", "um"]')
    return length_unit(units[0]), length_unit(units[1])


def agree_unit(column: str, file_unit: float | None, user_unit: float | None) -> float:
    """Unit of a column from what the file states and what the user gives; neither is overruled, none is guessed."""
    if file_unit is None and user_unit is None:
        raise ScanError(
            f'does not state the unit of {column}: give it, unit = "um", or two, unit = ["mm", "um"]'
        )
    if file_unit is not None and user_unit is not None and abs(file_unit - user_unit) > 1e-9 * file_unit:
        raise ScanError(
            f"unit: the file states that {column} is in units of {file_unit:g} m, but {user_unit:g} m is given"
        )
    return float(file_unit if file_unit is not None else user_unit)  # type: ignore[arg-type]
