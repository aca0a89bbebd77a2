"""Gauss-Legendre rules, each computed once."""

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
