"""The not-a-knot spline is scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from leak.numerics.curves import cubic_spline_slopes


@pytest.mark.parametrize("n", [3, 4, 5, 60])
def test_slopes_are_those_of_scipy(n: int) -> None:
    rng = np.random.default_rng(n)
    x, y = np.cumsum(rng.uniform(0.01, 1.0, n)), rng.normal(size=n)
    assert cubic_spline_slopes(x, y) == pytest.approx(CubicSpline(x, y)(x, 1), rel=1e-10, abs=1e-10)
