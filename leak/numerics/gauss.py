"""Gauss-Legendre rules and the integrals of what they interpolate, each computed once."""

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
