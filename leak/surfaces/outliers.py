"""Outliers of a scan: spikes of the instrument, dust, pits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from leak.arrays import FloatArray
from leak.surfaces.scans import LineScan, Topography, filled

BoolArray = NDArray[np.bool_]

Outliers = Literal["keep", "remove"]
OUTLIERS: tuple[str, ...] = get_args(Outliers)

# A point is compared with those at these distances to both sides, in points: an outlier may be as wide.
_DISTANCES = (1, 2, 4, 8)
# Standard deviations of such steps from which on a point stands alone.
_ALONE = 6.0
# More than this share of all points is not an outlier but the surface.
_MOST = 0.01


@dataclass(frozen=True, eq=False)
class FoundOutliers:
    """Outliers of one scan.

    Parameters
    ----------
    points : ndarray of bool
        Which points, shaped as the heights.
    count : int
        Number of places.
    pits : int
        How many of them lie below their surroundings.
    height : float
        Largest distance from the surroundings [m].
    """

    points: BoolArray
    count: int
    pits: int
    height: float


def find_outliers(scan: Topography) -> FoundOutliers:
    """Points that stand alone by more than a Gaussian surface allows.

    Each height is compared with both at some distance; it must lie above both, or below both, by more than the steps
    over this distance scatter. Their standard deviation is taken from their median, which outliers hardly move. In a
    map a point must stand out along both sides: a ridge or a groove is none.
    """
    from scipy.ndimage import label

    away = np.zeros(scan.heights.shape)
    for distance in _DISTANCES:
        sides = [_height_over_both(scan.heights, distance, axis) for axis in range(scan.heights.ndim)]
        least = np.min(np.abs(sides), axis=0)
        away = np.where(least > np.abs(away), np.copysign(least, sides[0]), away)
    points = away != 0.0
    if points.mean() > _MOST:
        points[...], away[...] = False, 0.0
    places, count = label(points, np.ones((3,) * points.ndim, bool))
    pits = np.unique(places[points & (away < 0.0)]).size
    return FoundOutliers(points, int(count), int(pits), float(np.abs(away).max()))


def without_outliers(scan: Topography, found: FoundOutliers) -> Topography:
    """The scan with its outliers, and the points beside them, replaced by what surrounds them."""
    from scipy.ndimage import binary_dilation

    if not found.count:
        return scan
    replaced = binary_dilation(found.points, np.ones((3,) * found.points.ndim, bool))
    if isinstance(scan, LineScan):
        x = np.arange(scan.heights.size)
        heights = np.interp(x, x[~replaced], scan.heights[~replaced])
    else:
        heights = filled(scan.heights, replaced)
    return replace(scan, heights=heights)


def _height_over_both(heights: FloatArray, distance: int, axis: int) -> FloatArray:
    """How far each point lies above, or below, both points at a distance [m].

    Zero where it lies above one and below the other, at the ends, and where that is no more than chance.
    """
    h = np.moveaxis(heights, axis, 0)
    out = np.zeros_like(h)
    if h.shape[0] > 2 * distance:
        steps = h[distance:] - h[:-distance]
        # 0.6745: median of the absolute value of a normal variable
        deviation = float(np.median(np.abs(steps))) / 0.6745
        before, after = steps[:-distance], -steps[distance:]
        nearer = np.where(np.abs(before) < np.abs(after), before, after)
        alone = (before * after > 0.0) & (np.abs(nearer) > _ALONE * deviation) & (deviation > 0.0)
        out[distance:-distance] = np.where(alone, nearer, 0.0)
    return np.moveaxis(out, 0, axis)
