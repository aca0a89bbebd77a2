"""Stiff equations whose Jacobian is tridiagonal, such as diffusion along a line."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from leak.arrays import FloatArray

# So many Euler steps go over each interval; their results are extrapolated to infinitely many, to third order.
_STEPS = (1, 2, 3)


def stiff_steps(
    rate: Callable[[float, FloatArray], FloatArray],
    jacobian: Callable[[float, FloatArray], tuple[FloatArray, FloatArray, FloatArray]],
    places: FloatArray,
    start: FloatArray,
) -> FloatArray:
    """Solution of dv/dt = rate(t, v) at the last of some places, by linearly implicit Euler steps extrapolated.

    The places alone decide the steps, so that equal equations in other units have equal solutions to rounding.

    Parameters
    ----------
    rate : callable
        Of t and v, shape (n,).
    jacobian : callable
        Of t and v: the diagonal below, shape (n - 1,), the diagonal, shape (n,), and the one above.
    places : ndarray, shape (m,)
        Rising t, the first of them that of `start`.
    start : ndarray, shape (n,)
        Of three values or more.

    References
    ----------
    P. Deuflhard, SIAM Rev. 27, 505 (1985).

    Examples
    --------
    >>> import numpy as np
    >>> apart = np.zeros(2)
    >>> falls = lambda t, v: (apart, np.full(3, -1.0), apart)
    >>> v = stiff_steps(lambda t, v: -v, falls, np.linspace(0.0, 1.0, 101), np.ones(3))
    >>> bool(np.allclose(v, np.exp(-1.0), rtol=1e-6))
    True
    """
    from scipy.linalg.lapack import dgttrf, dgttrs

    v = start
    for begin, end in pairwise(places):
        below, own, above = jacobian(end, v)
        found: list[FloatArray] = []
        for number, count in enumerate(_STEPS):
            step = (end - begin) / count
            factors = dgttrf(-step * below, 1.0 - step * own, -step * above)[:5]
            one = v
            for k in range(count):
                one = one + dgttrs(*factors, step * rate(begin + (k + 1) * step, one))[0]
            row = [one]
            for order, coarser in enumerate(found, start=1):
                row.append(row[-1] + (row[-1] - coarser) / (count / _STEPS[number - order] - 1.0))
            found = row
        v = found[-1]
    return v
