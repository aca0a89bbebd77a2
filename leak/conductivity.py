"""Flow conductivity of a rough interface: Bruggeman's effective medium and the critical junction."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from leak.errors import ConductivityError, positive
from leak.monotone_curve import MonotoneCurve, spline_slopes

FloatArray = NDArray[np.float64]

METHODS = ("bruggeman", "critical-junction")
_NEWTON_STEPS = 120
# ln u_eff^3 may lie this far outside the separations given; what lies further is sealed.
_BELOW_ALL = 60.0


def dimension_number(percolation_threshold: float) -> float:
    """n = 1/(1 - a_c): the number in Bruggeman's formula that makes the open area percolate at A/A0 = a_c.

    n = 2 is the textbook value with a_c = 0.5; a_c = 0.42 (n = 1.724) agrees with direct numerical results.

    References
    ----------
    W. B. Dapp et al., Phys. Rev. Lett. 108, 244301 (2012).
    """
    if not 0.0 < percolation_threshold < 1.0:
        raise ConductivityError(
            f"percolation_threshold = {percolation_threshold}: must lie between 0 and 1 [-]"
        )
    return 1.0 / (1.0 - percolation_threshold)


def effective_medium(
    separation: FloatArray, weight: FloatArray, contact: FloatArray, wide_open: FloatArray, n: float
) -> FloatArray:
    """Separation u_eff of the uniform gap that lets as much through as the distribution P(u).

    Solves int dsigma P(sigma) (sigma - s)/(sigma + (n-1) s) = 0 with sigma ~ u^3 and s ~ u_eff^3, contact included
    at sigma = 0.

    Parameters
    ----------
    separation : ndarray
        u > 0, increasing along the last axis, shape (P, U) [m].
    weight : ndarray
        Area with that separation, P(u) du, shape (P, U) [-].
    contact : ndarray
        Area that lets nothing through, shape (P,) [-].
    wide_open : ndarray
        Area with a separation beyond all of `separation`, shape (P,) [-].
    n : float
        See `dimension_number` [-].

    Returns
    -------
    ndarray
        u_eff, shape (P,); zero where the contact has percolated [m].

    References
    ----------
    D. A. G. Bruggeman, Ann. Phys. 416, 636 (1935); W. B. Dapp et al., Phys. Rev. Lett. 108, 244301 (2012).

    Examples
    --------
    A uniform gap with a fraction a in contact conducts 1 - a n/(n-1) of the open gap:

    >>> u = effective_medium(np.array([[1e-6]]), np.array([[0.8]]), np.array([0.2]), np.array([0.0]), 2.0)
    >>> round(float(u[0] ** 3 / 1e-18), 9)
    0.6
    """
    log_u3 = 3.0 * np.log(separation)
    blocked = -contact / (n - 1.0) + wide_open
    open_balance = weight.sum(axis=-1) + blocked
    low, high = log_u3[:, 0] - _BELOW_ALL, log_u3[:, -1] + np.where(wide_open > 0.0, _BELOW_ALL, 0.0)
    guess = 0.5 * (log_u3[:, 0] + log_u3[:, -1])
    for _ in range(_NEWTON_STEPS):
        ratio = np.exp(np.minimum(log_u3 - guess[:, None], 300.0))
        inverse = 1.0 / (ratio + (n - 1.0))
        balance = (weight * (ratio - 1.0) * inverse).sum(axis=-1) + blocked
        slope = -(n * weight * ratio * inverse**2).sum(axis=-1)
        low = np.where(balance > 0.0, guess, low)
        high = np.where(balance > 0.0, high, guess)
        newton = guess - balance / np.minimum(slope, -1e-300)
        following = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
        moved = np.abs(following - guess)
        guess = following
        if moved.max() < 1e-11:
            break
    sealed = (open_balance <= 0.0) | (guess < log_u3[:, 0] - 0.99 * _BELOW_ALL)
    return np.where(sealed, 0.0, np.exp(guess / 3.0))


# u_eff falls to exp(-C/(1 - p/p_seal)) just below the sealing pressure, where 1/u_eff^3 is no number any more. What
# flows through less than this, 1e-160 m^3/s, is nothing, and no fluid and no sum of resistances overflows above it [m].
_SMALLEST_SEPARATION = 1e-60

# Weight of 1/(1 - p/p_seal) beside ln p in the variable of the table.
_SEALING_WEIGHT = 0.5


def table_abscissa(log_pressure: FloatArray, log_sealing_pressure: float) -> FloatArray:
    """Variable in which ln u_eff is smooth: ln p at low pressure, 1/(1 - p/p_seal) toward sealing.

    The last open paths are at the smallest scales, where u1 vanishes like exp(-a^2/Y^2), so that ln u_eff goes like
    -1/(1 - p/p_seal).
    """
    return log_pressure + _SEALING_WEIGHT / -np.expm1(log_pressure - log_sealing_pressure)


@dataclass(frozen=True)
class Conductivity:
    """sigma_eff(p) for one fluid: call it with pressures [Pa] to get m^3/(Pa s)."""

    table: ConductivityTable
    viscosity: float

    def __call__(self, pressure: ArrayLike) -> FloatArray | float:
        """sigma_eff at nominal pressure p [m^3/(Pa s)]; infinite at p = 0."""
        return self.table.conductivity(pressure, self.viscosity)

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """sigma_eff at ln(p/Pa), where p itself may be too small for a floating-point number."""
        return self.table.at_log_pressure(log_pressure) ** 3 / (12.0 * self.viscosity)


@dataclass(frozen=True, eq=False)
class ConductivityTable:
    """u_eff = (12 eta sigma_eff)^(1/3) of one surface over ln p: independent of the fluid and of the geometry.

    Parameters
    ----------
    pressure : ndarray
        Nominal pressures, increasing, shape (n,) [Pa].
    separation : ndarray
        u_eff there, positive and falling, shape (n,) [m].
    sealing_pressure : float
        From here on nothing flows; infinite if the surface never seals [Pa].
    p_max : float
        Largest pressure that may be asked for [Pa].
    method : str
        "bruggeman" or "critical-junction".

    Notes
    -----
    A cubic spline over `table_abscissa`. Below the first pressure u_eff goes on linearly in ln p, the low-pressure law
    of the theory; between the last one and the sealing pressure it falls like exp(-C/(1 - p/p_seal)).
    """

    pressure: FloatArray
    separation: FloatArray
    sealing_pressure: float
    p_max: float
    method: str = "bruggeman"

    @cached_property
    def _curve(self) -> MonotoneCurve:
        x = table_abscissa(np.log(self.pressure), self._log_sealing)
        # Linear in u where u is large, logarithmic where it is small: the ways it depends on the abscissa there.
        ratio = self.separation / self._decay_length
        y = ratio + np.log(-np.expm1(-ratio))
        return MonotoneCurve(x, y, spline_slopes(x, y))

    @cached_property
    def _decay_length(self) -> float:
        """-du_eff/dlnp at the low end [m]."""
        return float((self.separation[0] - self.separation[1]) / np.log(self.pressure[1] / self.pressure[0]))

    @property
    def _log_sealing(self) -> float:
        return float(np.log(self.sealing_pressure))

    def effective_separation(self, pressure: ArrayLike) -> FloatArray | float:
        """u_eff(p) [m]; infinite at p = 0, zero from the sealing pressure on.

        Raises
        ------
        ConductivityError
            A pressure is negative, not a number, or above the table although the surface still leaks there.
        """
        p = np.asarray(pressure, dtype=float)
        if not np.all(p >= 0.0):
            raise ConductivityError(f"pressure = {p[~(p >= 0.0)].flat[0]}: must not be negative [Pa]")
        with np.errstate(divide="ignore"):
            u = self.at_log_pressure(np.log(p))
        return float(u) if u.ndim == 0 else u

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """u_eff at ln(p/Pa) [m]; zero below 1e-60 m, just before the sealing pressure."""
        x = np.asarray(log_pressure, dtype=float)
        too_high = (x > np.log(self.p_max) + 1e-9) & (x < self._log_sealing)
        if np.any(too_high):
            worst = float(np.exp(x[too_high].max()))
            raise ConductivityError(
                f"pressure = {worst:.6g} Pa is above the table's p_max = {self.p_max:.6g} Pa: make the table wider"
            )
        sealed = x >= self._log_sealing
        abscissa = table_abscissa(np.where(sealed, -1.0 + self._log_sealing, x), self._log_sealing)
        u = self._decay_length * np.logaddexp(0.0, self._curve.value(abscissa))
        return np.where(sealed | (u < _SMALLEST_SEPARATION), 0.0, u)

    def conductivity(self, pressure: ArrayLike, viscosity: float) -> FloatArray | float:
        """sigma_eff = u_eff^3/(12 eta) [m^3/(Pa s)]."""
        eta = positive(ConductivityError, "viscosity", viscosity, "Pa s")
        u = np.asarray(self.effective_separation(pressure))
        sigma = u**3 / (12.0 * eta)
        return float(sigma) if sigma.ndim == 0 else sigma

    def at(self, viscosity: float) -> Conductivity:
        """The conductivity for one fluid viscosity [Pa s], a function of pressure."""
        return Conductivity(self, positive(ConductivityError, "viscosity", viscosity, "Pa s"))
