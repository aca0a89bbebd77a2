"""Gauss-Legendre rules, each computed once, and integrals over C(q) that is a power law between nodes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from leak.arrays import FloatArray


@lru_cache(maxsize=256)
def gauss(count: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of `count` points on (-1, 1)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes.astype(np.float64, copy=False), weights.astype(np.float64, copy=False)


def gauss_panels(ends: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of `count` points between each of some places and the next, shape (len(ends) - 1, count)."""
    nodes, weights = gauss(count)
    half = 0.5 * np.diff(ends)[:, None]
    return ends[:-1, None] + half * (1.0 + nodes), half * weights


@lru_cache(maxsize=64)
def integrals_up_to_nodes(count: int) -> FloatArray:
    """Matrix from values at the nodes times their weights to the integral of the interpolant from -1 to each node."""
    legendre = np.polynomial.legendre
    t, degree = gauss(count)[0], np.arange(count)
    P = legendre.legvander(t, count)
    antiderivative = np.empty((count, count))
    antiderivative[:, 0] = t + 1.0
    for k in range(1, count):
        antiderivative[:, k] = (P[:, k + 1] - P[:, k - 1]) / (2 * k + 1)
    return np.asarray(antiderivative @ ((degree + 0.5)[:, None] * P[:, :-1].T))


def slopes(log_q: FloatArray, log_C: FloatArray) -> FloatArray:
    """Exponent of each piece, zero at a step."""
    rise, length = np.diff(log_C), np.diff(log_q)
    return np.divide(rise, length, out=np.zeros_like(rise), where=length > 0.0)


def power_law_moment(
    order: float, log_q: FloatArray, log_C: FloatArray, slope: FloatArray, low: float, high: float
) -> float:
    """int q^order C dq from ln q = low to high, both within the nodes."""
    x = np.minimum(np.maximum(log_q, low), high)
    left, right = x[:-1], x[1:]
    start = log_C[:-1] + slope * (left - log_q[:-1]) + (order + 1.0) * left
    return float(np.sum(np.exp(start) * power_integral(order + 1.0 + slope, right - left)))


def power_integral(exponent: FloatArray, length: FloatArray) -> FloatArray:
    """int_0^length exp(exponent t) dt, without cancellation when the exponent vanishes."""
    exponent = not_zero(exponent)
    return np.asarray(np.expm1(exponent * length) / exponent)


def not_zero(exponent: FloatArray) -> FloatArray:
    """An exponent that divides: one of 1e-15 changes nothing that a floating-point number can show."""
    return np.where(np.abs(exponent) < 1e-15, 1e-15, exponent)


def sorted_unique(values: FloatArray) -> FloatArray:
    """Finite numbers in increasing order, each once: numpy.unique loads numpy.ma, which takes longer than all its work.

    Parameters
    ----------
    values : ndarray
        Of one dimension.

    Examples
    --------
    >>> sorted_unique(np.array([2.0, 1.0, 2.0])).tolist()
    [1.0, 2.0]
    """
    numbers = np.sort(values)
    return numbers[np.diff(numbers, prepend=-np.inf) > 0]
