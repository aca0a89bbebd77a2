"""Water at pressures up to 1000 bar and beyond: viscosity and density of the industrial formulations of the IAPWS."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.files import own_tables
from leak.fluids.pressure_law import PressureTable
from leak.standards import STANDARD_PRESSURE

# Beyond this pressure the formulation of the density would go wild [Pa]; number of values up to it.
_HIGHEST, _PRESSURES = 2e8, 65
_DATA = own_tables("leak.fluids", "water.toml")
_REGION_1, _H = np.array(_DATA["region_1"]), np.array(_DATA["viscosity"])
_GAS_CONSTANT = 461.526


def water_density(temperature: float, pressure: ArrayLike) -> FloatArray:
    """Density of liquid water [kg/m^3].

    Parameters
    ----------
    temperature : float
        273.15 to 623.15 K [K].
    pressure : array_like
        Absolute; up to 100 MPa it is the standard, up to 200 MPa within 0.05 % of IAPWS-95 [Pa].

    References
    ----------
    IAPWS R7-97(2012), region 1.

    Examples
    --------
    >>> f"{1.0 / float(water_density(300.0, 80e6)):.9e}"
    '9.711808940e-04'
    """
    i, j, n = _REGION_1.T
    pi, tau = np.asarray(pressure, dtype=float)[..., None] / 16.53e6, 1386.0 / temperature
    by_pi = -(n * i * (7.1 - pi) ** (i - 1.0) * (tau - 1.222) ** j).sum(axis=-1)
    return np.asarray(16.53e6 / (_GAS_CONSTANT * temperature * by_pi))


def water_viscosity(temperature: float, density: ArrayLike) -> FloatArray:
    """Viscosity of water without its rise at the critical point [Pa s].

    Parameters
    ----------
    temperature : float
        [K]
    density : array_like
        [kg/m^3]

    References
    ----------
    IAPWS R12-08.

    Examples
    --------
    >>> f"{float(water_viscosity(298.15, 998.0)) * 1e6:.6f} uPa s"
    '889.735100 uPa s'
    """
    T, rho = temperature / 647.096, np.asarray(density, dtype=float) / 322.0
    dilute = (
        100.0
        * np.sqrt(T)
        / np.polynomial.polynomial.polyval(1.0 / T, (1.67752, 2.20462, 0.6366564, -0.241605))
    )
    over_density = np.polynomial.polynomial.polyval(1.0 / T - 1.0, _H)
    inner = np.polynomial.polynomial.polyval(rho - 1.0, over_density)
    return np.asarray(1e-6 * dilute * np.exp(rho * inner))


@lru_cache(maxsize=64)
def water_law(temperature: float) -> PressureTable:
    """What pressure makes of liquid water, up to 2000 bar: below 30 degC it first becomes thinner.

    Within 0.1 % of IAPWS-95. A table, since a leak asks thousands of times: its error is below 1e-9.

    Parameters
    ----------
    temperature : float
        [K]; below 0 degC the ratios of 0 degC hold.

    References
    ----------
    IAPWS R12-08 (viscosity) at the density of IAPWS R7-97(2012).

    Examples
    --------
    >>> f"{float(water_law(293.15).viscosity_ratio(100e6)):.3f}"
    '0.992'
    """
    T, p = max(temperature, 273.15), np.linspace(0.0, _HIGHEST, _PRESSURES)
    density = water_density(T, STANDARD_PRESSURE + p)
    viscosity = water_viscosity(T, density)
    eta, rho = (tuple((values / values[0]).tolist()) for values in (viscosity, density))
    return PressureTable(tuple(p.tolist()), eta, rho)
