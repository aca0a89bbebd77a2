"""Error of the corrected theory's conductivity against direct simulation, as a distribution.

Notation: k conductivity, p nominal pressure, A/A0 contact area, A_c/A0 the area at which nothing flows. Towards sealing
ln k goes as t ln(A_c - A), so that an area wrong by a share e changes it by -t e X, X = A/(A_c - A); bias and spread go
with X. A finite seal is a sample: its variance falls with its waves. Its long waves are few whatever the load, at low
load few summits touch, and towards sealing few channels are left, X again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ConductivityError

# `docs/research/own_error_fit.py` finds them: bias and spread where the contact is open and per X, and the standard
# deviation of one roll-off wave always, per (p/(E* h'))^(-1/4) and per X.
OPEN_BIAS, CLOSING_BIAS = 0.067, -0.14
OPEN_SPREAD, CLOSING_SPREAD = 0.022, 0.045
LONG_WAVES, SUMMITS, CHANNELS = 0.40, 0.15, 1.3
# Of contacts that yield all over: 0.13 by what the equivalent pressure misses on direct simulations of single maps
# (`docs/research/direct_yielding.py`), and 0.08 by Poisson's ratio (0.3 to 0.45) and hardening (none to 2 % of E).
YIELDING_SPREAD = 0.15
# Decades of pressure over which the errors of one surface belong together: among 35 surfaces of the same rows, errors
# half a decade apart have a correlation of 0.77, one apart 0.47, 1.5 apart 0.18 and two apart none.
BELONG_TOGETHER = 0.77
# A_c/A0 of direct simulation, and the largest share of it that the rows fitted to reach.
_THRESHOLD, _CLOSEST_AREA = 0.42, 0.9


@dataclass(frozen=True, eq=False)
class FlowError:
    """Normal distribution of ln(direct conductivity / theory).

    Parameters
    ----------
    bias : ndarray
        Mean [-].
    spread : ndarray
        Standard deviation [-].
    parts : mapping of ndarray
        Its square by source [-].

    Examples
    --------
    >>> print(f"{FlowError(np.array(-0.2), np.array(0.1)).factor(0.5):.2f}")
    0.82
    """

    bias: FloatArray
    spread: FloatArray
    parts: Mapping[str, FloatArray] = field(default_factory=dict)

    def factor(self, quantile: ArrayLike) -> FloatArray:
        """Factor on the conductivity that this share of contacts stays below.

        Parameters
        ----------
        quantile : array_like
            Between 0 and 1, broadcast against `bias`; evenly spread random numbers give a sample [-].
        """
        from scipy.special import ndtri

        share = np.asarray(quantile, dtype=float)
        if not np.all((share > 0.0) & (share < 1.0)):
            raise ConductivityError(f"quantile = {quantile!r}: must lie between 0 and 1")
        return self.factor_at(ndtri(share))

    def factor_at(self, score: ArrayLike) -> FloatArray:
        """Factor on the conductivity that is so many standard deviations from the mean of ln.

        Parameters
        ----------
        score : array_like
            Broadcast against `bias` [-].
        """
        return np.asarray(np.exp(self.bias + self.spread * np.asarray(score, dtype=float)))

    def share_below(self, factor: ArrayLike) -> FloatArray:
        """Share of contacts whose factor on the conductivity is not above this one, the inverse of `factor`.

        Parameters
        ----------
        factor : array_like
            From zero to infinity, broadcast against `bias` [-].
        """
        from scipy.special import ndtr

        with np.errstate(divide="ignore"):
            return np.asarray(ndtr((np.log(factor) - self.bias) / self.spread))


def closing_ratio(contact_area: ArrayLike) -> FloatArray:
    """X = A/(A_c - A), as far as there are direct simulations."""
    share = np.clip(np.asarray(contact_area, dtype=float) / _THRESHOLD, 0.0, _CLOSEST_AREA)
    return np.asarray(share / (1.0 - share))


def flow_error(
    pressure_over_Eh: ArrayLike, contact_area: ArrayLike, *, waves: float = math.inf, yielded: ArrayLike = 0.0
) -> FlowError:
    """Error of the corrected theory's conductivity, fitted to direct simulation of isotropic elastic surfaces.

    Metal that flows has the same bias and spread at its own, larger contact area, and what yielding adds.

    Parameters
    ----------
    pressure_over_Eh : array_like
        p/(E* h'), h' the rms slope, positive; fitted from 3e-5 to 0.1 [-].
    contact_area : array_like
        A/A0, as by `RoughContact.corrected_contact_area` or, of metal that flows, `RoughContact.contact_area` [-].
    waves : float
        Roll-off wave lengths squared that the sealing area holds; without end, the error of the theory alone [-].
    yielded : array_like
        1 - p/p_eq, p_eq the elastic pressure that stands for the one that yields, 0 for elastic contact [-].

    Examples
    --------
    >>> error = flow_error(1e-3, 0.002, waves=400)
    >>> print(*(f"{factor:.2f}" for factor in error.factor([0.05, 0.5, 0.95])))
    0.98 1.07 1.16
    """
    p, area = np.asarray(pressure_over_Eh, dtype=float), np.asarray(contact_area, dtype=float)
    if not np.all(p > 0.0):
        raise ConductivityError(f"pressure_over_Eh = {pressure_over_Eh!r}: must be positive [-]")
    if not np.all((area >= 0.0) & (area <= 1.0)):
        raise ConductivityError(f"contact_area = {contact_area!r}: must lie between 0 and 1 [-]")
    if not waves > 0.0:
        raise ConductivityError(f"waves = {waves}: must be positive [-]")
    X = closing_ratio(area)
    sample = (LONG_WAVES**2 + SUMMITS**2 / np.sqrt(p) + (CHANNELS * X) ** 2) / waves
    metal = (YIELDING_SPREAD * np.asarray(yielded, dtype=float)) ** 2
    bias = OPEN_BIAS + CLOSING_BIAS * X
    parts = {"gap law": OPEN_SPREAD**2 + (CLOSING_SPREAD * X) ** 2, "few waves": sample, "yielding": metal}
    bias, spread = np.broadcast_arrays(bias, np.sqrt(np.sum(np.broadcast_arrays(*parts.values()), axis=0)))
    return FlowError(bias, spread, parts)


def error_correlation(log_pressure: ArrayLike, other: ArrayLike | None = None) -> FloatArray:
    """Correlation of the error of one seal at some pressures with its error at others, exp(-d^2/(2 d_0^2)).

    d is the distance in decades of the pressure, d_0 = 0.77 is found by `docs/research/own_error_fit.py`.

    Parameters
    ----------
    log_pressure, other : array_like, shapes (n,) and (m,)
        Decimal logarithms of the peak pressures [Pa]; the same ones unless given.

    Returns
    -------
    ndarray, shape (n, m)

    Examples
    --------
    >>> error_correlation([6.0, 6.5, 8.0]).round(2)[0].tolist()
    [1.0, 0.81, 0.03]
    """
    x = np.asarray(log_pressure, dtype=float)
    y = x if other is None else np.asarray(other, dtype=float)
    distance = (x[:, None] - y) / BELONG_TOGETHER
    return np.asarray(np.exp(-0.5 * distance**2))
