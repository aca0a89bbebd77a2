"""Deviation of a library gas from ideal and dilute, by corresponding states; for warnings only."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from leak.fluids.library import CRITICAL
from leak.fluids.properties import GAS_CONSTANT, Gas
from leak.fluids.real_gas import RealGas


class Critical(NamedTuple):
    """Critical constants of a gas."""

    temperature: float
    """[K]"""
    pressure: float
    """[Pa]"""
    acentric: float
    """Pitzer's acentric factor [-]."""
    volume: float
    """Molar [m^3/mol]."""


_PRESSURES = 61


def estimated_real_gas(gas: Gas, highest: float) -> RealGas | None:
    """Estimate of a library gas up to a pressure; None of a gas whose critical constants are not known.

    Z by Peng and Robinson, viscosity by Jossi, Stiel and Thodos: together mostly within 15 % of rho/eta up to 700 bar,
    away from condensation. The largest root is taken: a gas that condenses is not noticed.

    Parameters
    ----------
    gas : Gas
    highest : float
        [Pa]

    References
    ----------
    D. Y. Peng, D. B. Robinson, Ind. Eng. Chem. Fundam. 15, 59 (1976); J. A. Jossi, L. I. Stiel, G. Thodos, AIChE J. 8,
    59 (1962).

    Examples
    --------
    >>> import leak
    >>> real = estimated_real_gas(leak.gas("nitrogen"), 7e7)
    >>> f"{float(real.factor(7e7)):.1f}"
    '1.5'
    """
    if gas.name not in CRITICAL:
        return None
    temperature, pressure, acentric, volume = CRITICAL[gas.name]
    critical = Critical(temperature, pressure * 1e5, acentric, volume * 1e-6)
    pressures = np.linspace(0.0, highest, _PRESSURES)
    Z = np.array([_peng_robinson(critical, gas.temperature, p) for p in pressures])
    reduced = pressures * critical.volume / (Z * GAS_CONSTANT * gas.temperature)
    ratios = 1.0 + _dense_viscosity(critical, gas.molar_mass, reduced) / gas.viscosity
    return RealGas(tuple(pressures.tolist()), tuple(Z.tolist()), tuple(ratios.tolist()))


def _peng_robinson(critical: Critical, T: float, p: float) -> float:
    omega = critical.acentric
    m = 0.37464 + 1.54226 * omega - 0.26992 * omega**2
    alpha = (1.0 + m * (1.0 - np.sqrt(T / critical.temperature))) ** 2
    Tr, pr = T / critical.temperature, p / critical.pressure
    A, B = 0.45724 * alpha * pr / Tr**2, 0.07780 * pr / Tr
    roots = np.roots([1.0, B - 1.0, A - 3.0 * B**2 - 2.0 * B, B**3 + B**2 - A * B])
    return float(roots[np.abs(roots.imag) < 1e-9].real.max())


def _dense_viscosity(critical: Critical, molar_mass: float, reduced_density: np.ndarray) -> np.ndarray:
    """eta - eta0 [Pa s]."""
    xi = critical.temperature ** (1 / 6) / (
        np.sqrt(1e3 * molar_mass) * (critical.pressure / 101325.0) ** (2 / 3)
    )
    r = np.minimum(reduced_density, 3.0)
    root = np.polynomial.polynomial.polyval(r, (0.1023, 0.023364, 0.058533, -0.040758, 0.0093324))
    return np.asarray(1e-3 * (root**4 - 0.1023**4) / xi)
