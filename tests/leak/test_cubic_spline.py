"""What stands in for scipy where importing it would take longer than the work: its numbers are scipy's."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.optimize
import scipy.special
from scipy.interpolate import CubicSpline, RectBivariateSpline

from leak.numerics.curves import CubicSurface, cubic_spline_slopes
from leak.numerics.roots import root_of_rising
from leak.theory.persson import erf


@pytest.mark.parametrize("n", [3, 4, 5, 60])
def test_slopes_are_those_of_scipy(n: int) -> None:
    rng = np.random.default_rng(n)
    x, y = np.cumsum(rng.uniform(0.01, 1.0, n)), rng.normal(size=n)
    assert cubic_spline_slopes(x, y) == pytest.approx(CubicSpline(x, y)(x, 1), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("count", [1, 100, 1000])
def test_error_function_of_few_and_of_many_is_that_of_scipy(count: int) -> None:
    """The C library's and cephes' agree to the last digits."""
    x = np.linspace(-6.0, 6.0, count).reshape(-1, 1)
    found = erf(x)
    assert found.shape == x.shape
    np.testing.assert_allclose(found, scipy.special.erf(x), rtol=1e-14, atol=1e-300)
    assert float(erf(0.5)) == pytest.approx(math.erf(0.5), rel=1e-15)


def test_of_two_variables():
    """scipy's spline without smoothing, which is not-a-knot too; and that of several columns at once."""
    rng = np.random.default_rng(2)
    x, y = np.cumsum(rng.uniform(0.1, 1.0, 12)), np.cumsum(rng.uniform(0.1, 1.0, 7))
    z = rng.normal(size=(12, 7))
    ours, theirs = CubicSurface(x, y, z), RectBivariateSpline(x, y, z)
    at = rng.uniform(x[0], x[-1], 200), rng.uniform(y[0], y[-1], 200)
    assert ours.at(at[0])(at[1]) == pytest.approx(theirs.ev(*at), rel=1e-9, abs=1e-9)
    slopes = theirs.ev(*at, dy=1)
    assert ours.at(at[0], slope=True)(at[1]) == pytest.approx(slopes, rel=1e-9, abs=1e-8)
    grid_x, grid_y = np.meshgrid(x, y, indexing="ij")
    assert ours.at(grid_x)(grid_y) == pytest.approx(z, abs=1e-10)
    assert cubic_spline_slopes(x, z)[:, 3] == pytest.approx(cubic_spline_slopes(x, z[:, 3]), rel=1e-12)


@pytest.mark.parametrize("root", [-38.0, -0.3, 2.5])
@pytest.mark.parametrize("start", [-40.0, -1.0, 0.0, 3.0])
def test_root_of_rising_is_found_from_anywhere_and_else_the_end_next_to_it(root, start):
    asked = []

    def function(x):
        asked.append(x)
        return math.expm1(0.7 * min(x - root, 1.0)) if x < root + 1.0 else math.expm1(0.7) + x - root - 1.0

    found = root_of_rising(function, -40.0, 3.0, start, 1e-10)
    assert found == pytest.approx(scipy.optimize.brentq(function, -40.0, 3.0, xtol=1e-13), abs=1e-9)
    assert min(asked) >= -40.0 and max(asked) <= 3.0
    assert root_of_rising(lambda x: x - 4.0, -40.0, 3.0, start) == 3.0
    assert root_of_rising(lambda x: x + 41.0, -40.0, 3.0, start) == -40.0
