"""How far a gas of the library is from ideal and dilute, by corresponding states: for warnings, not for results."""

from __future__ import annotations

from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from leak.fluids.properties import Gas
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


# B. E. Poling, J. M. Prausnitz, J. P. O'Connell, The Properties of Gases and Liquids, 5th ed., App. A; helium and
# hydrogen with the effective constants that J. M. Prausnitz gives to quantum gases at room temperature.
CRITICAL = MappingProxyType(
    {
        "helium": Critical(10.47, 6.76e5, 0.0, 37.5e-6),
        "hydrogen": Critical(43.6, 20.5e5, 0.0, 51.5e-6),
        "nitrogen": Critical(126.2, 33.98e5, 0.037, 90.1e-6),
        "oxygen": Critical(154.58, 50.43e5, 0.022, 73.4e-6),
        "argon": Critical(150.86, 48.98e5, -0.002, 74.57e-6),
        "air": Critical(132.5, 37.7e5, 0.035, 87.5e-6),
        "methane": Critical(190.56, 45.99e5, 0.011, 98.6e-6),
        "carbon dioxide": Critical(304.12, 73.74e5, 0.225, 94.07e-6),
    }
)
"""Gas of the library -> its critical constants, read-only."""

_R = 8.314462618
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
    critical = CRITICAL.get(gas.name)
    if critical is None:
        return None
    pressures = np.linspace(0.0, highest, _PRESSURES)
    Z = np.array([_peng_robinson(critical, gas.temperature, p) for p in pressures])
    reduced = pressures * critical.volume / (Z * _R * gas.temperature)
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
