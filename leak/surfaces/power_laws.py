"""Integrals over C(q) that is a power law between nodes, straight lines of ln C over ln q."""

from __future__ import annotations

import numpy as np

from leak.arrays import FloatArray


def slopes(log_q: FloatArray, log_C: FloatArray) -> FloatArray:
    """Exponent of each piece, zero at a step."""
    rise, length = np.diff(log_C), np.diff(log_q)
    return np.divide(rise, length, out=np.zeros_like(rise), where=length > 0.0)


def power_law_moment(
    order: float, log_q: FloatArray, log_C: FloatArray, slope: FloatArray, low: float, high: float
) -> float:
    """int q^order C dq from ln q = low to high, both within the nodes."""
    inside = np.minimum(np.maximum(log_q, low), high)
    left, right = inside[:-1], inside[1:]
    start = log_C[:-1] + slope * (left - log_q[:-1]) + (order + 1.0) * left
    return float(np.sum(np.exp(start) * power_integral(order + 1.0 + slope, right - left)))


def power_integral(exponent: FloatArray, length: FloatArray) -> FloatArray:
    """int_0^length exp(exponent t) dt, without cancellation when the exponent vanishes."""
    exponent = not_zero(exponent)
    return np.asarray(np.expm1(exponent * length) / exponent)


def not_zero(exponent: FloatArray) -> FloatArray:
    """An exponent that divides: one of 1e-15 changes nothing that a floating-point number can show."""
    return np.where(np.abs(exponent) < 1e-15, 1e-15, exponent)
