"""Flow of a gas through a narrow slit, from the continuum to free molecules: one factor of the Knudsen number.

Notation: u the gap, p the gas pressure, eta the viscosity, v0 = sqrt(2 R_s T) the most probable molecular speed with
R_s = R/M; the inverse Knudsen number is D = p u/(eta v0). With the mean free path
lambda = (eta/p) sqrt(pi R_s T/2) it is D = (sqrt(pi)/2) u/lambda.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.fluids.properties import Gas
from leak.numerics.curves import cell_cubics, cubic_spline_slopes

SMALLEST_INVERSE_KNUDSEN = 0.01
"""End of the published range of D. Below it the flow rate is held: see `poiseuille_flow_rate`."""

# Fukui & Kaneko (1990): Q = a D + b + c/D + d/D^2 in three ranges of D, meeting at these two values.
_RANGES = (
    (-2.22919, 2.10673, 0.01653, -0.0000694),
    (0.13852, 1.25087, 0.15653, -0.00969),
    (1.0 / 6.0, 1.0162, 1.0653, -2.1354),
)
_MEET = (0.15, 5.0)
# The fits miss each other by 0.27 % and 0.14 % where they meet; they are joined over this distance in ln D.
_JOIN = 0.3


def poiseuille_flow_rate(inverse_knudsen: ArrayLike) -> FloatArray:
    """Dimensionless flow rate Q_P(D) of a rarefied gas between parallel plates.

    The mass flow per width is -(u^2/v0) Q_P(D) dp/dx. Q_P -> D/6 (continuum), D/6 + 1.0162 (first-order slip),
    and rises like -ln(D)/sqrt(pi) for free molecules.

    Parameters
    ----------
    inverse_knudsen : array_like
        D = p u/(eta v0) >= 0 [-].

    Notes
    -----
    The fits follow the linearised Boltzmann equation (BGK model, diffuse reflection) within 0.7 %. The logarithm
    belongs to plates of unlimited extent, between which molecules fly along the gap for ever. A channel of length L
    ends it: free molecules give (ln(2L/u) + 1/2)/sqrt(pi). Q_P is held at its value at D = 0.01, the end of the
    published range and what a channel some 60 gaps long gives. The choice matters for free molecules only: ten times
    longer channels would carry 43 % more.

    References
    ----------
    S. Fukui, R. Kaneko, "A database for interpolation of Poiseuille flow rates for high Knudsen number lubrication
    problems", J. Tribol. 112, 78 (1990); C. Cercignani, A. Daneri, J. Appl. Phys. 34, 3509 (1963).

    Examples
    --------
    >>> [round(float(q), 3) for q in poiseuille_flow_rate([0.01, 1.0, 100.0])]
    [3.043, 1.536, 17.693]
    """
    D = np.maximum(np.asarray(inverse_knudsen, dtype=float), 0.5 * SMALLEST_INVERSE_KNUDSEN)
    low, middle, high = (_fit(D, coefficients) for coefficients in _RANGES)
    limit = _fit(np.float64(SMALLEST_INVERSE_KNUDSEN), _RANGES[0])
    begin, first, second = (_rise(np.log(D / meet) / _JOIN) for meet in (SMALLEST_INVERSE_KNUDSEN, *_MEET))
    return limit + begin * (low - limit) + first * (middle - low) + second * (high - middle)


def flow_factor(inverse_knudsen: ArrayLike) -> FloatArray:
    """Flow of a rarefied gas over that of a continuum of the same viscosity, 6 Q_P(D)/D; one for D -> infinity.

    From a table that is good to 1e-7.
    """
    return np.exp(log_flow_factor(np.log(np.asarray(inverse_knudsen, dtype=float))))


def log_flow_factor(log_inverse_knudsen: FloatArray) -> FloatArray:
    """ln of `flow_factor` at ln D, from a table that is good to 1e-7: for many points at once.

    Parameters
    ----------
    log_inverse_knudsen : ndarray
        ln D, any shape.
    """
    first, cubics = _log_factors()
    # below the table the flow rate is held and the factor goes like 1/D, above it ln f goes to zero like 1/D
    cells = cubics.shape[0]
    t = (log_inverse_knudsen - first) * (1.0 / _TABLE_STEP)
    t_in = np.minimum(np.maximum(t, 0.0), cells)
    cell = np.minimum(t_in, cells - 1.0).astype(np.intp)
    c, s = cubics.take(cell, axis=0), t_in - cell
    log_f = c[..., 0] + s * (c[..., 1] + s * (c[..., 2] + s * c[..., 3])) - np.minimum(t, 0.0) * _TABLE_STEP
    t_out = np.maximum(t - cells, 0.0)
    return np.asarray(log_f * np.exp(-_TABLE_STEP * t_out) if t_out.any() else log_f)


def flow_ratio_range(gas: Gas, other: Gas) -> tuple[float, float]:
    """Volume flow of one gas over that of another through the same gaps between the same pressures, least and most.

    Volumes at equal pressure and each gas's own temperature, v0 Q_P(D) in a gap. The ratio runs from that of the
    viscosities (continuum) to that of the molecular speeds (free molecules), and between them beyond both: Q_P has
    a minimum near D = 1, through which the two gases go one after the other. What holds in every gap holds for the
    flow through all of them.

    Parameters
    ----------
    gas, other : Gas
        The ratio is that of `gas` to `other`.

    Examples
    --------
    >>> from leak import gas
    >>> print("{:.2f} {:.2f}".format(*flow_ratio_range(gas("air"), gas("helium"))))
    0.31 1.08
    """
    D = np.geomspace(1e-4, 1e6, 2000)
    step = other.viscosity * other.molecular_speed / (gas.viscosity * gas.molecular_speed)
    rates = poiseuille_flow_rate(step * D) / poiseuille_flow_rate(D)
    ratios = rates * (gas.molecular_speed / other.molecular_speed)
    return float(ratios.min()), float(ratios.max())


# Step and last value of ln D of the table of ln f: there f is 1 + 6e-10.
_TABLE_STEP, _TABLE_END = 2e-3, np.log(1e10)


@lru_cache(maxsize=1)
def _log_factors() -> tuple[float, FloatArray]:
    """First ln D, and of ln f in even steps from there the coefficients of cubics in shares of a step, shape (n, 4)."""
    first = float(np.log(0.4 * SMALLEST_INVERSE_KNUDSEN))
    steps = int(np.ceil((_TABLE_END - first) / _TABLE_STEP))
    log_D: FloatArray = first + _TABLE_STEP * np.arange(steps + 1, dtype=float)
    log_f = np.log(6.0 * poiseuille_flow_rate(np.exp(log_D))) - log_D
    slope = _TABLE_STEP * cubic_spline_slopes(log_D, log_f)
    return first, np.ascontiguousarray(cell_cubics(np.ones(1), log_f, slope).T)


def _fit(D: FloatArray | np.float64, coefficients: tuple[float, ...]) -> FloatArray:
    a, b, c, d = coefficients
    return np.asarray(a * D + b + (c + d / D) / D)


def _rise(s: FloatArray) -> FloatArray:
    """From 0 at s = -1 to 1 at s = 1, with continuous slope."""
    t = np.clip(0.5 * (1.0 + s), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
