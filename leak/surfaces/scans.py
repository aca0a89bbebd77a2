"""Measured heights in metres, a line scan or a map on an even grid: form, outliers, and how they become a spectrum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from itertools import product
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray
from leak.errors import ScanError, as_arrays, check_each, positive, um

Detrend = Literal["mean", "tilt", "curvature"]
DETRENDS: tuple[str, ...] = get_args(Detrend)
Window = Literal["hann", "none"]
WINDOWS: tuple[str, ...] = get_args(Window)

FEWEST_POINTS = 16
# A range of wavenumbers of less than two octaves is none.
LEAST_RANGE = 4.0
# Bridged by straight lines, gaps in up to this share of a scan hardly change its spectrum; from the larger share
# on there is no scan.
_NARROW, _WIDE = 0.05, 0.2
# What no instrument measures, far smaller than an atom or longer than a room, is a slip or damage [m].
_SMALLEST, _LARGEST = 1e-15, 100.0
# Positions closer than this share of the length are the same place.
_CLOSE = 1e-12
# Positions this far off an even grid, in units of its spacing, move no height.
_EVEN_OFFSET = 1e-3


@dataclass(frozen=True, eq=False)
class LineScan:
    """Heights at evenly spaced points along a line.

    Parameters
    ----------
    heights : ndarray, shape (n,)
        Heights [m].
    spacing : float
        Distance of neighbouring points [m].
    resolution : float
        Distance of neighbouring points of the measurement, where that is larger than `spacing` [m].
    tip_radius : float or None
        Radius of the stylus tip, if the file says so [m].
    name : str
        What messages call it.
    remarks : tuple of str
        What was done to the data.

    Examples
    --------
    >>> import numpy as np, leak
    >>> x = np.arange(200) * 1e-6
    >>> leak.line_scan(x, 1e-7 * np.sin(1e5 * x)).spacing
    1e-06
    """

    heights: FloatArray
    spacing: float
    resolution: float
    tip_radius: float | None = None
    name: str = ""
    remarks: tuple[str, ...] = ()

    @property
    def length(self) -> float:
        """Number of points times spacing [m]."""
        return self.heights.size * self.spacing

    def without_form(self, detrend: Detrend) -> LineScan:
        """The scan without its mean, its mean line or its mean parabola (least squares)."""
        return replace(self, heights=_without_polynomial(self.heights, DETRENDS.index(detrend)))


@dataclass(frozen=True, eq=False)
class HeightMap:
    """Heights on an even rectangular grid.

    Parameters
    ----------
    heights : ndarray, shape (nx, ny)
        Heights [m], index 0 along x.
    spacing : tuple of float
        Distance of neighbouring points along x and y [m].
    tip_radius : float or None
        Radius of the stylus tip, if the file says so [m].
    name : str
        What messages call it.
    remarks : tuple of str
        What was done to the data.

    Examples
    --------
    >>> import numpy as np, leak
    >>> heights = 1e-6 * np.random.default_rng(1).standard_normal((64, 64))
    >>> leak.height_map(heights, (1e-6, 1e-6)).spacing
    (1e-06, 1e-06)
    """

    heights: FloatArray
    spacing: tuple[float, float]
    tip_radius: float | None = None
    name: str = ""
    remarks: tuple[str, ...] = ()

    @property
    def size(self) -> tuple[float, float]:
        """Number of points times spacing along x and y [m]."""
        (nx, ny), (dx, dy) = self.heights.shape, self.spacing
        return nx * dx, ny * dy

    @property
    def length(self) -> float:
        """The longer side [m]."""
        return max(self.size)

    @property
    def resolution(self) -> float:
        """The coarser of both spacings [m]."""
        return max(self.spacing)

    def without_form(self, detrend: Detrend) -> HeightMap:
        """The map without its mean, its mean plane or its mean paraboloid (least squares)."""
        return replace(self, heights=_without_polynomial(self.heights, DETRENDS.index(detrend)))


Topography = LineScan | HeightMap


def line_scan(x: ArrayLike, h: ArrayLike, *, name: str = "", tip_radius: float | None = None) -> LineScan:
    """Line scan from positions and heights.

    Points that are even but for the rounding of x, or to 0.1 % of their spacing, stay as they are; others are
    interpolated linearly on an even grid of their median spacing.

    Parameters
    ----------
    x, h : array_like, shape (n,)
        Position, strictly increasing or strictly decreasing, and height [m].
    name : str
        What messages call it.
    tip_radius : float, optional
        Radius of the stylus tip [m].

    Raises
    ------
    ScanError
        Different lengths, fewer than 16 points, NaN or infinity, x not monotonic, all heights equal, or a gap of more
        than a fifth of the length.

    Examples
    --------
    >>> import numpy as np, leak
    >>> x = np.arange(200) * 1e-6
    >>> scan = leak.line_scan(x, 1e-7 * np.sin(1e5 * x), tip_radius=2e-6)
    >>> len(scan.heights), scan.tip_radius
    (200, 2e-06)
    """
    x, h = _check_scan(x, h)
    n, length = x.size, float(x[-1] - x[0])
    steps = np.diff(x)
    if steps.min() < _CLOSE * length:
        raise ScanError(
            f"two positions x lie only {um(steps.min())} apart in a length of {um(length)}: that is round-off, no "
            "step of a scan"
        )
    # the widest gaps left aside, as long as they are a small part of the length
    widest = np.sort(steps)[::-1]
    length_so_far = np.cumsum(widest)
    resolution = float(widest[np.searchsorted(length_so_far, _NARROW * length)])
    if widest[0] > _WIDE * length:
        raise ScanError(
            f"x has a gap of {um(widest[0])} in a length of {um(length)}: allowed is a fifth of it"
        )
    spacing = length / (n - 1)
    if _is_even(x, spacing):
        return LineScan(h, spacing, spacing, tip_radius, name)
    spacing = min(float(np.median(steps)), spacing)
    count = round(length / spacing) + 1
    if count > 20 * n:
        raise ScanError(
            f"x is too uneven: half of its steps are below {um(spacing)}, their mean is {um(length / n)}"
        )
    grid = np.linspace(x[0], x[-1], count)
    remark = (
        f"x is not evenly spaced (up to {um(widest[0])}): interpolated on {count} points {um(spacing)} apart"
    )
    return LineScan(
        np.interp(grid, x, h), length / (count - 1), max(resolution, spacing), tip_radius, name, (remark,)
    )


def height_map(
    heights: ArrayLike, spacing: tuple[float, float], *, name: str = "", tip_radius: float | None = None
) -> HeightMap:
    """Height map from an array; points that are missing (NaN) are filled from their neighbours.

    Parameters
    ----------
    heights : array_like, shape (nx, ny)
        Heights [m], index 0 along x, at least 16 points along each side.
    spacing : tuple of float
        Distance of neighbouring points along x and y [m].
    name : str
        What messages call it.
    tip_radius : float, optional
        Radius of the stylus tip [m].

    Raises
    ------
    ScanError
        Not two-dimensional or too small, spacing not positive, all heights equal, or more than 5 % missing.

    Examples
    --------
    >>> import numpy as np, leak
    >>> heights = 1e-6 * np.random.default_rng(1).standard_normal((64, 64))
    >>> leak.height_map(heights, (1e-6, 1e-6), name="seat").name
    'seat'
    """
    h = np.array(heights, dtype=float)
    if h.ndim != 2 or min(h.shape) < FEWEST_POINTS:
        raise ScanError(
            f"map of shape {h.shape}: needs two dimensions and at least {FEWEST_POINTS} points a side"
        )
    if not all(_SMALLEST <= step <= _LARGEST for step in spacing):
        raise ScanError(f"spacing = {spacing}: must be two lengths from {_SMALLEST:g} to {_LARGEST:g} m")
    gaps = ~np.isfinite(h)
    share = float(gaps.mean())
    if share > _NARROW:
        raise ScanError(
            f"{share:.1%} of the map is missing: allowed is {_NARROW:.0%}; measure again or cut a piece out"
        )
    remarks: tuple[str, ...] = ()
    if share > 0.0:
        h = fill_missing(h, gaps)
        remarks = (
            f"{int(gaps.sum())} missing points ({share:.2%}) are filled with the height of the nearest one",
        )
    _not_flat(h)
    return HeightMap(h, (float(spacing[0]), float(spacing[1])), tip_radius, name, remarks)


def _check_scan(x: ArrayLike, h: ArrayLike) -> tuple[FloatArray, FloatArray]:
    x, h = map(np.array, as_arrays(ScanError, "x and h must be arrays of numbers", x, h))
    if x.ndim != 1 or x.shape != h.shape:
        raise ScanError(f"x has shape {x.shape}, h {h.shape}: both need one dimension and the same length")
    if x.size < FEWEST_POINTS:
        raise ScanError(f"a scan of {x.size} point{'s' * (x.size != 1)}: needs at least {FEWEST_POINTS}")
    for name, values in (("x", x), ("h", h)):
        check_each(ScanError, name, values, np.isfinite(values), "must be a finite number [m]")
    if x[-1] < x[0]:
        x, h = x[::-1], h[::-1]
    largest = float(np.abs(x).max())
    if largest > _LARGEST:
        raise ScanError(f"x up to {largest:.3g} m: no length of a scan; check its unit")
    backwards = np.flatnonzero(np.diff(x) <= 0.0)
    if backwards.size:
        i = int(backwards[0])
        raise ScanError(f"x is not monotonic: {um(x[i], 9)} and {um(x[i + 1], 9)} follow each other")
    if np.ptp(x) < x.size * _SMALLEST:
        raise ScanError(f"x over {np.ptp(x):.3g} m: no length of a scan; check its unit")
    _not_flat(h)
    return x, h


def _not_flat(h: FloatArray) -> None:
    largest = float(np.nanmax(np.abs(h)))
    if largest > _LARGEST or np.ptp(h) <= max(1e-14 * largest, _SMALLEST):
        raise ScanError(f"heights from {um(h.min())} to {um(h.max())}: no roughness to make a spectrum of")


def _is_even(x: FloatArray, spacing: float) -> bool:
    n = x.size
    i = np.arange(n) - 0.5 * (n - 1)
    slope = float(i @ x / (i @ i))
    deviation = float(np.abs(x - x.mean() - slope * i).max())
    return deviation <= _EVEN_OFFSET * spacing or deviation <= 0.6 * _find_rounding(x, 0.9 * spacing)


def _find_rounding(x: FloatArray, limit: float) -> float:
    """Largest power of ten, up to `limit`, of which all positions are multiples: the last digit they were given in."""
    first = int(np.floor(np.log10(limit)))
    digits = [10.0**exponent for exponent in range(first, first - 4, -1)]
    return next((digit for digit in digits if np.all(np.abs(x / digit - np.round(x / digit)) < 1e-6)), 0.0)


def fill_missing(h: FloatArray, gaps: BoolArray) -> FloatArray:
    """Heights with those missing replaced by the nearest one, shape (nx, ny) [m]."""
    from scipy.ndimage import distance_transform_edt

    neighbours = distance_transform_edt(gaps, return_distances=False, return_indices=True)
    return np.asarray(h[tuple(neighbours)])


def _without_polynomial(heights: FloatArray, degree: int) -> FloatArray:
    """Heights less the polynomial of a degree, in one or two variables, that is nearest to them (least squares)."""
    legendre = [np.polynomial.legendre.legvander(np.linspace(-1, 1, n), degree) for n in heights.shape]
    orders = (powers for powers in product(range(degree + 1), repeat=heights.ndim) if sum(powers) <= degree)
    terms = [
        reduce(np.multiply.outer, [P[:, k] for P, k in zip(legendre, order, strict=True)]).ravel()
        for order in orders
    ]
    basis, h = np.stack(terms, axis=1), heights.ravel()
    # twice: the mean height of a scan can be a thousand times its roughness
    for _ in range(2):
        h = h - basis @ np.linalg.lstsq(basis, h, rcond=None)[0]
    return h.reshape(heights.shape)


# -------------------------------------------------------------------- outliers


Outliers = Literal["keep", "remove"]
OUTLIERS: tuple[str, ...] = get_args(Outliers)

# A point is compared with those at these distances to both sides, in points: an outlier may be as wide.
_DISTANCES = (1, 2, 4, 8)
# Standard deviations of such steps from which on a point stands alone.
_LONE_STEP = 6.0
# More than this share of all points is not an outlier but the surface.
_MOST_OUTLIERS = 0.01


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

    excess = np.zeros(scan.heights.shape)
    for distance in _DISTANCES:
        sides = [_height_over_both(scan.heights, distance, axis) for axis in range(scan.heights.ndim)]
        least = np.min(np.abs(sides), axis=0)
        excess = np.where(least > np.abs(excess), np.copysign(least, sides[0]), excess)
    points = excess != 0.0
    if points.mean() > _MOST_OUTLIERS:
        points[...], excess[...] = False, 0.0
    places, count = label(points, np.ones((3,) * points.ndim, bool))
    pits = np.unique(places[points & (excess < 0.0)]).size
    return FoundOutliers(points, int(count), int(pits), float(np.abs(excess).max()))


def without_outliers(scan: Topography, outliers: FoundOutliers) -> Topography:
    """The scan with its outliers, and the points beside them, replaced by what surrounds them."""
    from scipy.ndimage import binary_dilation

    if not outliers.count:
        return scan
    gaps = binary_dilation(outliers.points, np.ones((3,) * outliers.points.ndim, bool))
    if isinstance(scan, LineScan):
        x = np.arange(scan.heights.size)
        heights = np.interp(x, x[~gaps], scan.heights[~gaps])
    else:
        heights = fill_missing(scan.heights, gaps)
    return replace(scan, heights=heights)


def _height_over_both(heights: FloatArray, distance: int, axis: int) -> FloatArray:
    """How far each point lies above, or below, both points at a distance [m].

    Zero where it lies above one and below the other, at the ends, and where that is no more than chance.
    """
    h = np.moveaxis(heights, axis, 0)
    excess = np.zeros_like(h)
    if h.shape[0] > 2 * distance:
        steps = h[distance:] - h[:-distance]
        # 0.6745: median of the absolute value of a normal variable
        deviation = float(np.median(np.abs(steps))) / 0.6745
        step_in, step_out = steps[:-distance], -steps[distance:]
        nearer = np.where(np.abs(step_in) < np.abs(step_out), step_in, step_out)
        alone = (step_in * step_out > 0.0) & (np.abs(nearer) > _LONE_STEP * deviation) & (deviation > 0.0)
        excess[distance:-distance] = np.where(alone, nearer, 0.0)
    return np.moveaxis(excess, 0, axis)


# -------------------------------------------------------------------- settings


@dataclass(frozen=True)
class SelfAffineContinuation:
    """C ~ q^(-2 (1 + H)) outside the reliable range of a scan: an assumption, not a measurement.

    Parameters
    ----------
    hurst : float
        Hurst exponent H, between 0 and 1 [-].
    q_low, q_high : float, optional
        Where the continued spectrum begins and ends; None: the end of the reliable range [1/m].

    Raises
    ------
    ScanError
        A value is outside its range, or neither end is given.

    Examples
    --------
    >>> import leak
    >>> leak.SelfAffineContinuation(hurst=0.8, q_high=1e8).hurst
    0.8
    """

    hurst: float
    q_low: float | None = None
    q_high: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < positive(ScanError, "hurst", self.hurst, "-") <= 1.0:
            raise ScanError(f"hurst = {self.hurst}: must lie in (0, 1]")
        for name, value in (("q_low", self.q_low), ("q_high", self.q_high)):
            if value is not None:
                positive(ScanError, name, value, "1/m")
        if self.q_low is None and self.q_high is None:
            raise ScanError(
                "q_low and q_high are both missing: say where the continued spectrum begins or ends [1/m]"
            )


@dataclass(frozen=True)
class ScanSettings:
    """How scans become a spectrum.

    Parameters
    ----------
    detrend : {"tilt", "mean", "curvature"}
        What is taken off each scan first: its mean line or plane, its mean only, or its mean parabola or paraboloid
        (for scans over a ball, a cone or another curved part).
    window : {"hann", "none"}
        Weight of the heights along the scan. "none" is for periodic, calculated surfaces only.
    tip_radius : float, optional
        Radius of the stylus tip; the file's, if it states one, unless given [m].
    shortest_wavelength : float, optional
        What the instrument resolves (optical resolution, filter); two points unless given [m].
    extrapolation : "cut" or SelfAffineContinuation
        What lies outside the reliable range: nothing, or a continuation.
    outliers : {"keep", "remove"}
        Points that stand alone (`leak.surfaces.scans.find_outliers`): kept, or replaced by what surrounds them.

    Raises
    ------
    ScanError
        A value is none of these.

    Examples
    --------
    >>> import leak
    >>> leak.ScanSettings(detrend="curvature", tip_radius=2e-6).window
    'hann'
    """

    detrend: Detrend = "tilt"
    window: Window = "hann"
    tip_radius: float | None = None
    shortest_wavelength: float | None = None
    extrapolation: Literal["cut"] | SelfAffineContinuation = "cut"
    outliers: Outliers = "keep"

    def __post_init__(self) -> None:
        for name, value, words in (
            ("detrend", self.detrend, DETRENDS),
            ("window", self.window, WINDOWS),
            ("outliers", self.outliers, OUTLIERS),
        ):
            if value not in words:
                raise ScanError(f"{name} = {value!r}: must be " + " or ".join(f'"{word}"' for word in words))
        for name, length in (
            ("tip_radius", self.tip_radius),
            ("shortest_wavelength", self.shortest_wavelength),
        ):
            if length is not None:
                positive(ScanError, name, length, "m")
        if self.extrapolation != "cut" and not isinstance(self.extrapolation, SelfAffineContinuation):
            raise ScanError(
                f'extrapolation = {self.extrapolation!r}: must be "cut" or a SelfAffineContinuation'
            )
