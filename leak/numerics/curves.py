"""Curves through points, and where to put the points.

Strictly monotone curves with an inverse, and the not-a-knot cubic spline of one and two variables: exactly
those of `scipy.interpolate.CubicSpline` and `RectBivariateSpline` (tests say so), without importing scipy.interpolate:
that alone takes as long as all leak rates of a case. The spline of two variables is three times
faster than FITPACK's at many single points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.numerics.roots import newton_between

# No interval is longer than this many times its neighbour.
_WIDEST = 3.5


def divide_stretches(ends: FloatArray, longest: float, slack: float = 0.0) -> FloatArray:
    """The ends of stretches, and between them points that cut each into as many equal parts as it needs.

    Parameters
    ----------
    ends : ndarray, shape (n,)
        Not decreasing.
    longest : float
        Part that is allowed.
    slack : float
        By this share of `longest` a part may be longer.

    Examples
    --------
    >>> divide_stretches(np.array([0.0, 1.0, 1.5]), 0.5).tolist()
    [0.0, 0.5, 1.0, 1.5]
    """
    counts = np.maximum(np.ceil(np.diff(ends) / longest - slack), 1).astype(int)
    parts = [
        np.linspace(left, right, count, endpoint=False)
        for left, right, count in zip(ends[:-1], ends[1:], counts, strict=True)
    ]
    return np.concatenate([*parts, ends[-1:]])


def sample_curve(
    function: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    allowed: Callable[[FloatArray], FloatArray],
    *,
    closest: float,
) -> tuple[FloatArray, FloatArray]:
    """Points of smooth functions through which cubics predict them to a tolerance, and the values there.

    Every interval is halved until the value in its middle is what the cubic through the four points around it
    predicted. A cubic spline through all points, the middles included, is then about a hundred times better than the
    prediction: its error is a tenth of that cubic's, and falls to a sixteenth by the halving.

    Parameters
    ----------
    function : callable
        Values at points of shape (n,), shape (n, m); not finite where it has none, and those points are left out.
    start : ndarray
        First points, increasing, shape (n,), n >= 4.
    allowed : callable
        Largest error of a prediction for given values, both of shape (n, m).
    closest : float
        No interval is halved that is not longer than this.

    Returns
    -------
    x : ndarray
        Points, increasing, shape (k,).
    y : ndarray
        Values, shape (k, m).

    Examples
    --------
    >>> bell, allowed = lambda x: np.exp(-(x**2))[:, None], lambda y: np.full(y.shape, 1e-3)
    >>> x, y = sample_curve(bell, np.linspace(-8.0, 8.0, 9), allowed, closest=0.01)
    >>> steps = np.diff(x)
    >>> bool(steps.max() > 3.0 * steps.min())
    True
    """
    x, y = start, function(start)
    is_open: BoolArray = np.ones(x.size - 1, dtype=bool)
    while True:
        is_open = is_open & (np.diff(x) > closest)
        is_open |= _far_wider_than_a_neighbour(x) & (np.diff(x) > closest)
        # beside a point without a value only the place where the values end is looked for
        has = _has_value(y)
        is_open = is_open & (has[:-1] | has[1:])
        at: IntArray = np.flatnonzero(is_open)
        if not at.size:
            break
        middle = 0.5 * (x[at] + x[at + 1])
        values = function(middle)
        with np.errstate(invalid="ignore"):
            is_good = (np.abs(values - _predict_values(x, y, at, middle)) <= allowed(values)).all(axis=1)
        np.put(is_open, at, ~is_good)
        x, y = np.insert(x, at + 1, middle), np.insert(y, at + 1, values, axis=0)
        # both halves of a bad interval are bad, both of a good one good
        is_open = np.insert(is_open, at + 1, ~is_good)
    has = _has_value(y)
    return x[has], y[has]


def _far_wider_than_a_neighbour(x: FloatArray) -> BoolArray:
    """A prediction may be right by chance; where the next interval had to be halved twice it was."""
    length = np.diff(x)
    ends = np.concatenate([[np.inf], length, [np.inf]])
    return np.asarray(length > _WIDEST * np.minimum(ends[:-2], ends[2:]))


def _has_value(y: FloatArray) -> BoolArray:
    return np.asarray(np.isfinite(y).all(axis=1))


def _predict_values(x: FloatArray, y: FloatArray, cell: IntArray, at: FloatArray) -> FloatArray:
    """Values at `at`, in the intervals `cell`, of the cubics through the four points around them."""
    first = np.clip(cell - 1, 0, x.size - 4)
    nodes = [x[first + n] for n in range(4)]
    weights = [np.prod([(at - b) / (a - b) for b in nodes if b is not a], axis=0) for a in nodes]
    with np.errstate(invalid="ignore"):
        return np.asarray(sum(weight[:, None] * y[first + n] for n, weight in enumerate(weights)))


@dataclass(frozen=True, eq=False)
class MonotoneCurve:
    """Cubic Hermite curve y(x), continuously differentiable, continued by its end tangents.

    Parameters
    ----------
    x : ndarray
        Increasing, shape (n,).
    y : ndarray
        Strictly monotone, shape (n,).
    slope : ndarray
        dy/dx, of one sign and at most three times the neighbouring secants (Fritsch & Carlson, SIAM J. Numer.
        Anal. 17, 238 (1980)), shape (n,).
    """

    x: FloatArray
    y: FloatArray
    slope: FloatArray

    def value(self, x: FloatArray) -> FloatArray:
        """y at x."""
        x = np.asarray(x, dtype=float)
        x_in = np.minimum(np.maximum(x, self.x[0]), self.x[-1])
        k = self.x[1:-1].searchsorted(x_in, side="right")
        c0, c1, c2, c3 = self._cubics.take(k, axis=1)
        s = x_in - self.x[k]
        y = c0 + s * (c1 + s * (c2 + c3 * s))
        overshoot = x - x_in
        if overshoot.any():
            y += np.where(overshoot < 0.0, self.slope[0], self.slope[-1]) * overshoot
        return y

    def value_and_derivative(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """y and dy/dx at x."""
        x = np.asarray(x, dtype=float)
        undershoot, overshoot = np.minimum(x - self.x[0], 0.0), np.maximum(x - self.x[-1], 0.0)
        k = self.x[1:-1].searchsorted(x, side="right")
        y, slope = self._cell(k, np.minimum(np.maximum(x, self.x[0]), self.x[-1]) - self.x[k])
        return y + (undershoot * self.slope[0] + overshoot * self.slope[-1]), slope

    def value_and_slope(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """y and dy/dx at x, none of which lies beyond the ends."""
        k = self.x[1:-1].searchsorted(x, side="right")
        return self._cell(k, x - self.x[k])

    @cached_property
    def _cubics(self) -> FloatArray:
        """Coefficients of the powers 0 to 3 of the distance from the left end of each cell, shape (4, n - 1)."""
        return cell_cubics(self.x[1:] - self.x[:-1], self.y, self.slope)

    def _cell(self, k: IntArray, s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """y and dy/dx in the cells k at the distances s from their left ends."""
        c0, c1, c2, c3 = self._cubics.take(k, axis=1)
        cubic = c3 * s
        return c0 + s * (c1 + s * (c2 + cubic)), c1 + s * (2.0 * c2 + 3.0 * cubic)

    def inverse(self, y: FloatArray) -> FloatArray:
        """x at which the curve has the value y."""
        y = np.asarray(y, dtype=float)
        sign = np.sign(self.y[-1] - self.y[0])
        k = np.clip(np.searchsorted(sign * self.y, sign * y, side="right") - 1, 0, self.x.size - 2)
        h = self.x[k + 1] - self.x[k]
        target = np.clip(sign * y, sign * self.y[0], sign * self.y[-1]) * sign

        def excess(t: FloatArray) -> tuple[FloatArray, FloatArray]:
            value, slope = self._cell(k, h * t)
            return sign * (value - target), sign * (slope * h)

        guess = (target - self.y[k]) / (self.y[k + 1] - self.y[k])
        # in about 6 steps, and more in cells in which one end is almost flat
        t = newton_between(excess, guess, np.zeros(y.shape), np.ones(y.shape), 1e-14)
        x = self.x[k] + h * t
        end = np.where(sign * y > sign * self.y[-1], -1, 0)
        return x + (y - target) / self.slope[end]


def shape_preserving_slopes(x: FloatArray, y: FloatArray) -> FloatArray:
    """Slopes of the monotone cubic of Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984) ("pchip")."""
    h, secant = np.diff(x), np.diff(y) / np.diff(x)
    if x.size == 2:
        return np.repeat(secant, 2)
    w1, w2 = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    inner = (w1 + w2) / (w1 / secant[:-1] + w2 / secant[1:])
    ends = [_end_slope(h[0], h[1], secant[0], secant[1]), _end_slope(h[-1], h[-2], secant[-1], secant[-2])]
    return np.concatenate([[ends[0]], inner, [ends[1]]])


def _end_slope(h0: float, h1: float, secant0: float, secant1: float) -> float:
    """One-sided three-point slope, kept of the sign of the first secant and never flat."""
    slope = ((2.0 * h0 + h1) * secant0 - h0 * secant1) / (h0 + h1)
    return float(np.clip(slope / secant0, 1e-3, 3.0) * secant0)


def spline_slopes(x: FloatArray, y: FloatArray) -> FloatArray:
    """Slopes of the not-a-knot cubic spline through monotone points, limited so that the curve stays monotone."""
    secant = (y[1:] - y[:-1]) / (x[1:] - x[:-1])
    left, right = np.concatenate([secant[:1], secant]), np.concatenate([secant, secant[-1:]])
    gentlest = np.where(np.abs(left) < np.abs(right), left, right)
    slope = cubic_spline_slopes(x, y) / np.where(gentlest == 0.0, 1.0, gentlest)
    return np.minimum(np.maximum(slope, 0.0), 3.0) * gentlest


def cubic_spline_slopes(x: FloatArray, y: FloatArray) -> FloatArray:
    """Slopes dy/dx of the not-a-knot cubic spline at its points.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Points, strictly increasing, n >= 3.
    y : ndarray, shape (n, ...)
        Values.

    References
    ----------
    C. de Boor, A Practical Guide to Splines (2001), chapter IV.
    """
    from scipy.linalg.lapack import dgtsv

    values = y.reshape(x.size, -1)
    h = x[1:] - x[:-1]
    secant = (values[1:] - values[:-1]) / h[:, None]
    if x.size == 3:  # a parabola
        bend = (secant[1] - secant[0]) / (h[0] + h[1])
        slopes = np.array([secant[0] - bend * h[0], secant[0] + bend * h[0], secant[1] + bend * h[1]])
        return np.asarray(slopes.reshape(y.shape))
    upper, main, lower = np.empty(x.size - 1), np.empty(x.size), np.empty(x.size - 1)
    main[1:-1], upper[1:], lower[:-1] = 2.0 * (h[:-1] + h[1:]), h[:-1], h[1:]
    right = np.empty(values.shape)
    right[1:-1] = 3.0 * (h[1:, None] * secant[:-1] + h[:-1, None] * secant[1:])
    # Not-a-knot: the third derivative is continuous at the second and at the last but one point.
    for end, (a, b), (s, t) in ((0, h[:2], secant[:2]), (-1, h[:-3:-1], secant[:-3:-1])):
        main[end], right[end] = b, ((a + 2.0 * (a + b)) * b * s + a**2 * t) / (a + b)
    upper[0], lower[-1] = h[0] + h[1], h[-1] + h[-2]
    return np.asarray(dgtsv(lower, main, upper, right, 1, 1, 1, 1)[3].reshape(y.shape))


@dataclass(frozen=True, eq=False)
class CubicSurface:
    """Not-a-knot cubic spline z(x, y) through values on a grid.

    Parameters
    ----------
    x, y : ndarray
        Increasing, shapes (n,) and (m,), at least four each.
    z : ndarray
        Values, shape (n, m).
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray

    def at(self, x: FloatArray, *, slope: bool = False) -> Callable[[FloatArray], FloatArray]:
        """z, or dz/dy, at given x as a function of y."""
        k = self.x[1:-1].searchsorted(x, side="right")
        row, s = k * (self.y.size - 1), x - self.x[k]

        def value(y: FloatArray) -> FloatArray:
            j = self.y[1:-1].searchsorted(y, side="right")
            c, t = self._bicubics.take(row + j, axis=-1), y - self.y[j]
            in_y = c[0] + s * (c[1] + s * (c[2] + s * c[3]))
            if slope:
                return np.asarray(in_y[1] + t * (2.0 * in_y[2] + t * 3.0 * in_y[3]))
            return np.asarray(in_y[0] + t * (in_y[1] + t * (in_y[2] + t * in_y[3])))

        return value

    @cached_property
    def _bicubics(self) -> FloatArray:
        """Coefficients of the powers of the distances from the corner of each cell, shape (4, 4, (n-1)(m-1))."""
        in_y = _cubics(self.y, self.z.T)
        in_both = _cubics(self.x, in_y.reshape(-1, self.x.size).T)
        return in_both.reshape(4, self.x.size - 1, 4, -1).swapaxes(1, 2).reshape(4, 4, -1)


def _cubics(x: FloatArray, y: FloatArray) -> FloatArray:
    """Coefficients of the powers 0 to 3 in the cells of splines, shape (n, m) to (4, n - 1, m)."""
    return cell_cubics(np.diff(x)[:, None], y, cubic_spline_slopes(x, y))


def cell_cubics(h: FloatArray, y: FloatArray, slope: FloatArray) -> FloatArray:
    """Coefficients of the powers 0 to 3 of the distance from the left end of each cell, shape (4, n - 1, ...).

    Parameters
    ----------
    h : ndarray
        Lengths of the cells, broadcast against them.
    y, slope : ndarray, shape (n, ...)
        Values and slopes at their ends.
    """
    secant, left, right = (y[1:] - y[:-1]) / h, slope[:-1], slope[1:]
    return np.array(
        [y[:-1], left, (3.0 * secant - 2.0 * left - right) / h, (left + right - 2.0 * secant) / h**2]
    )


def lagrange(t: float) -> tuple[float, float, float, float]:
    """Weights of the cubic through the values at 0, 1, 2, 3."""
    return (
        -(t - 1) * (t - 2) * (t - 3) / 6,
        t * (t - 2) * (t - 3) / 2,
        -t * (t - 1) * (t - 3) / 2,
        t * (t - 1) * (t - 2) / 6,
    )
