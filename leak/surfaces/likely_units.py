"""Units of length of a scan, and whether it can be one in the units that it is said to have."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import TypeVar

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ScanError
from leak.files import own_tables
from leak.surfaces.scans import HeightMap, LineScan, Topography

LENGTH_UNITS: dict[str, float] = own_tables("leak.surfaces", "length_units.toml")

# No stylus climbs a slope of 3 and no lens sees it; a scan is no longer than a part on the table of an instrument and
# no shorter than some of its points, and roughness with its form is flat.
_STEEPEST, _SHORTEST, _LONGEST, _HIGHEST = 3.0, 5e-6, 1.0, 0.2
# A usual scan: length and height [m] and slope. Of several units that could be the one that comes nearest is told.
_USUAL = (5e-3, 1e-6, 0.1)
Scan = TypeVar("Scan", bound=LineScan | HeightMap)
_COMMON = ("m", "mm", "um", "nm")


def check_likely(scan: Scan, units: Sequence[float]) -> Scan:
    """The scan, if a surface can be so.

    Parameters
    ----------
    scan : LineScan or HeightMap
    units : sequence of two floats
        Units in which its file has x and height [m], of which one may be wrong.

    Raises
    ------
    ScanError
        If its slope (root mean square) is above 3, its length above 1 m or below 5 um, or its heights reach over more
        than a fifth of its length. The message names the units that are likely.

    Examples
    --------
    >>> import numpy as np, leak
    >>> x = np.arange(200) * 1e-6
    >>> check_likely(leak.line_scan(x, 1e-7 * np.sin(1e5 * x)), (1e-6, 1e-6)).spacing
    1e-06
    """
    _check(*_measures(scan), units)
    return scan


def check_length(x: FloatArray, h: FloatArray, units: Sequence[float]) -> None:
    """ScanError as of `likely` if points lie over more than 1 m, before anything is calculated with them.

    Parameters
    ----------
    x, h : ndarray, shape (n,)
        [m]
    units : sequence of two floats
    """
    length = float(np.ptp(x))
    if _LONGEST < length < math.inf and len(h) > 1:
        height = float(np.ptp(h))
        # the square of an absurd height is no number
        slope = height * float(np.sqrt(np.mean((np.diff(h) / (height or 1.0)) ** 2))) * (len(h) - 1) / length
        _check(length, height, slope, units)


def _check(length: float, height: float, slope: float, units: Sequence[float]) -> None:
    if fault := _say_unlikely(length, height, slope):
        likely_units = _likely_units(length, height, slope, units)
        hint = f"; is {likely_units}?" if likely_units else "; are its units and columns right?"
        raise ScanError(f"{fault}, which is no measured surface{hint}")


def _measures(scan: Topography) -> tuple[float, float, float]:
    """Length and largest difference of heights [m], and root-mean-square slope, without tilt."""
    heights = scan.without_form("tilt").heights
    spacing = (scan.spacing,) if isinstance(scan.spacing, float) else scan.spacing
    steps = [np.diff(heights, axis=axis) / step for axis, step in enumerate(spacing)]
    return scan.length, float(np.ptp(heights)), max(float(np.sqrt(np.mean(step**2))) for step in steps)


def _say_unlikely(length: float, height: float, slope: float) -> str:
    if length > _LONGEST or length < _SHORTEST:
        return f"is {_text(length)} long"
    if slope > _STEEPEST:
        return f"has heights over {_text(height)} on a length of {_text(length)}, a mean slope of {slope:.2g}"
    if height > _HIGHEST * length:
        return f"has heights over {_text(height)} on a length of {_text(length)}"
    return ""


def _likely_units(length: float, height: float, slope: float, units: Sequence[float]) -> str:
    """Which unit x or height, or both of them, are likely in; empty if none makes a surface of it."""
    guesses = []
    for in_x, in_h in product(_COMMON, repeat=2):
        x, h = LENGTH_UNITS[in_x] / units[0], LENGTH_UNITS[in_h] / units[1]
        differ = [not math.isclose(factor, 1.0) for factor in (x, h)]
        measures = (x * length, h * height, h / x * slope)
        if any(differ) and not _say_unlikely(*measures):
            distance = sum(
                math.log10(m / usual) ** 2 for m, usual in zip(measures, _USUAL, strict=True) if m > 0
            )
            same = in_x == in_h and all(differ)
            words = (
                f"its unit {in_x}"
                if same
                else " and ".join(
                    f"the unit of {column} {name}"
                    for column, name, differs in zip(("x", "height"), (in_x, in_h), differ, strict=True)
                    if differs
                )
            )
            # one slip is likelier than two
            guesses.append((distance + 2 * (sum(differ) - 1) * (not same), words))
    return min(guesses, default=(0.0, ""))[1]


def _text(length: float) -> str:
    size, name = next(
        (unit for unit in ((1.0, "m"), (1e-3, "mm"), (1e-6, "um")) if length >= unit[0]), (1e-9, "nm")
    )
    return f"{length / size:.3g} {name}"
