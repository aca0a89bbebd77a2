"""Flow near the percolation threshold: a closed law of the mean gap and of a corrected contact area.

Persson's contact area is 15 to 30 % too small, and Bruggeman's medium too tight where few channels are left: two errors
that cancel in part. Here each is taken for itself. All of it is for isotropic surfaces.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.numerics.curves import MonotoneCurve
from leak.numerics.gauss import gauss

# g in dG -> [g + (1 - g) A^2] dG: at small pressure the area is 1/sqrt(g) times Persson's.
_G = 5.0 / 9.0
# Prefactor and exponent of the closed law: fitted to the sets A512, A and B of direct results, and judged by others
# (docs/verification/verification.md).
_PREFACTOR, _EXPONENT = 0.80, 2.85
# Corrected A/A0 over which the effective medium goes over into the closed law.
_FROM, _TO = 0.15, 0.25
# ln of the most that the closed law may lie above the effective medium. Direct results reach a factor 3; where the
# waves span three decades it would be 50, and going over into it would rise with the pressure.
_MOST_ABOVE = np.log(5.0)
# ln of the variance G/p^2 over which the corrected one is tabulated: full contact below, proportional above.
_TABLE = np.linspace(-5.0, 25.0, 601)


def corrected_area(argument: ArrayLike) -> FloatArray:
    """A/A0 with the stress variance broadened by less where little touches.

    Parameters
    ----------
    argument : array_like
        z = p/(2 sqrt(G)) of `leak.theory.persson.area_argument`, not negative [-].

    Notes
    -----
    A/A0 = erf(p/(2 sqrt(G'))) with dG' = [g + (1 - g) (A/A0)^2] dG and g = 5/9. With G in units of p^2 it is one curve
    for all surfaces, erf(z) at full contact and erf(z/sqrt(g)) where little touches.

    References
    ----------
    A. Wang, M. H. Mueser, Tribol. Lett. 69, 1 (2021), arXiv:2010.13470.

    Examples
    --------
    >>> [round(float(area), 3) for area in corrected_area([0.01, 0.3, 3.0])]
    [0.015, 0.386, 1.0]
    """
    from scipy.special import erf

    z = np.maximum(np.asarray(argument, dtype=float), 1e-150)
    with np.errstate(over="ignore"):
        log_variance = -np.log(4.0) - 2.0 * np.log(z)
    return np.asarray(erf(0.5 * np.exp(-0.5 * _variance().value(log_variance))))


def argument_at(corrected: float) -> float:
    """z at which the corrected A/A0 has a value between 0 and 1 [-]."""
    from scipy.special import erfinv

    log_variance = -np.log(4.0) - 2.0 * np.log(float(erfinv(corrected)))
    return float(0.5 * np.exp(-0.5 * _variance().inverse(np.asarray(log_variance))))


@lru_cache(maxsize=1)
def _variance() -> MonotoneCurve:
    """ln(G'/p^2) over ln(G/p^2)."""
    t, w = gauss(6)
    half = 0.5 * np.diff(_TABLE)[:, None]
    inside = 0.5 * (_TABLE[1:] + _TABLE[:-1])[:, None] + half * t
    cells = (half * w * np.exp(inside) / _broadening(inside)).sum(axis=1)
    G = np.exp(_TABLE[0]) + np.concatenate([[0.0], np.cumsum(cells)])
    return MonotoneCurve(np.log(G), _TABLE, G * _broadening(_TABLE) * np.exp(-_TABLE))


def _broadening(log_variance: FloatArray) -> FloatArray:
    """dG'/dG at ln(G'/p^2)."""
    from scipy.special import erf

    return _G + (1.0 - _G) * erf(0.5 * np.exp(-0.5 * log_variance)) ** 2


def closed_share(corrected: ArrayLike) -> FloatArray:
    """Weight of the closed law beside the effective medium at a corrected A/A0: 0 to 0.15, 1 from 0.25 on."""
    t = np.clip((np.asarray(corrected, dtype=float) - _FROM) / (_TO - _FROM), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def near_threshold(
    effective: FloatArray, mean_separation: FloatArray, corrected: FloatArray, percolation_threshold: float
) -> FloatArray:
    """u_eff of the effective medium that goes over into the closed law, shape (P,) [m].

    u_eff^3 = 0.80 ubar^3 (1 - A/(A0 a_c))^2.85 with the corrected area from A/A0 = 0.25 on, the effective medium to
    0.15, and between them ln u_eff with a smooth weight.

    Parameters
    ----------
    effective : ndarray
        u_eff of the effective medium, shape (P,) [m].
    mean_separation : ndarray
        ubar, shape (P,) [m].
    corrected : ndarray
        A/A0, shape (P,) [-].
    percolation_threshold : float
        a_c [-].
    """
    open_share = np.maximum(1.0 - corrected / percolation_threshold, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_closed = (np.log(_PREFACTOR) + _EXPONENT * np.log(open_share)) / 3.0 + np.log(mean_separation)
        above = 3.0 * (log_closed - np.log(effective))
        bounded = np.where(above > 0.0, _MOST_ABOVE * np.tanh(above / _MOST_ABOVE), above)
        u = effective * np.exp(closed_share(corrected) * bounded / 3.0)
    return np.where(open_share > 0.0, u, 0.0)
