"""Line scans and height maps from the files of instruments."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from leak.errors import ScanError
from leak.length_units import LENGTH_UNITS, Unit, agreed, two_units
from leak.topography import Topography, height_map, line_scan
from leak.topography_text import NotColumnsError, read_text_scan

_NO_SIZE = "does not state how long and wide the measured area is; export it in a format that does"
_INSTALL = 'pip install "fem-seal[surfaces]"'


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
    """The same for one file or several scans of one surface."""
    several = [paths] if isinstance(paths, (str, PathLike)) else list(paths)
    return tuple(read_topography(path, unit=unit) for path in several)


def _read_instrument_file(file: Path, unit: Unit | None, why_not_text: str) -> Topography:
    try:
        from SurfaceTopography.IO import open_topography
    except ImportError:
        raise ScanError(
            f"{why_not_text}; other files are read by SurfaceTopography, which is not installed: {_INSTALL}"
        ) from None
    # the readers are others' code for dozens of binary formats, and a damaged file makes them raise anything
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with open_topography(str(file)) as reader:
                given = {} if reader.default_channel.unit is not None or unit is None else {"unit": "m"}
                topography = reader.topography(**given)
                return _converted(
                    topography, unit if given else None, reader.default_channel.unit, unit, file.name
                )
    except ScanError:
        raise
    except Exception as error:
        if "physical_sizes" in str(error):
            raise ScanError(f"{why_not_text}; as a matrix of heights it {_NO_SIZE}") from None
        known = type(error).__name__ not in ("CannotDetectFileFormat", "UnknownFileFormat")
        detail = f" ({' '.join(str(error).split())[:160]})" if known and str(error) else ""
        raise ScanError(f"{why_not_text}, and SurfaceTopography cannot read it{detail}") from None


def _converted(
    topography: Any, given: Unit | None, stated: object, unit: Unit | None, name: str
) -> Topography:
    """Heights and positions in metres."""
    size = LENGTH_UNITS.get(str(stated).strip().lower()) if stated is not None else None
    if stated is not None and size is None:
        raise ScanError(f"its unit, {stated!r}, is not a length")
    in_x, in_h = (
        agreed(column, size, one) for column, one in zip(("x", "height"), two_units(unit), strict=True)
    )
    tip = _tip_radius(topography.info)
    if topography.dim == 1 and not topography.is_uniform:
        x, h = topography.positions_and_heights()
        return line_scan(np.asarray(x) * in_x, np.asarray(h) * in_h, name=name, tip_radius=tip)
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
