"""Slopes of the not-a-knot cubic spline.

Exactly those of `scipy.interpolate.CubicSpline` (a test says so), without importing scipy.interpolate: that alone
takes as long as all leak rates of a case.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def cubic_spline_slopes(x: FloatArray, y: FloatArray) -> FloatArray:
    """Slopes dy/dx of the not-a-knot cubic spline at its points.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Points, strictly increasing, n >= 3.
    y : ndarray, shape (n,)
        Values.

    References
    ----------
    C. de Boor, A Practical Guide to Splines (2001), chapter IV.
    """
    from scipy.linalg import solve_banded

    h, secant = np.diff(x), np.diff(y) / np.diff(x)
    if x.size == 3:  # a parabola
        bend = (secant[1] - secant[0]) / (h[0] + h[1])
        return np.array([secant[0] - bend * h[0], secant[0] + bend * h[0], secant[1] + bend * h[1]])
    # The unused corners of the band must be finite: solve_banded looks at them.
    upper, main, lower = np.zeros((3, x.size))
    main[1:-1], upper[2:], lower[:-2] = 2.0 * (h[:-1] + h[1:]), h[:-1], h[1:]
    right = np.empty(x.size)
    right[1:-1] = 3.0 * (h[1:] * secant[:-1] + h[:-1] * secant[1:])
    # Not-a-knot: the third derivative is continuous at the second and at the last but one point.
    for end, (a, b), (s, t) in ((0, h[:2], secant[:2]), (-1, h[:-3:-1], secant[:-3:-1])):
        main[end], right[end] = b, ((a + 2.0 * (a + b)) * b * s + a**2 * t) / (a + b)
    upper[1], lower[-2] = h[0] + h[1], h[-1] + h[-2]
    return solve_banded((1, 1), np.stack([upper, main, lower]), right)
