"""Water at pressures up to 1000 bar and beyond: viscosity and density of the industrial formulations of the IAPWS."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.fluids.pressure_law import PressureTable
from leak.standards import STANDARD_PRESSURE

# Beyond this pressure the formulation of the density would go wild [Pa]; number of values up to it.
_HIGHEST, _PRESSURES = 2e8, 65
# Rows I, J, n of equation (7) of IAPWS R7-97(2012), those with I > 0: the others do not enter the volume.
_REGION_1 = np.array(
    [
        (1, -9, 0.28319080123804e-3),
        (1, -7, -0.60706301565874e-3),
        (1, -1, -0.18990068218419e-1),
        (1, 0, -0.32529748770505e-1),
        (1, 1, -0.21841717175414e-1),
        (1, 3, -0.52838357969930e-4),
        (2, -3, -0.47184321073267e-3),
        (2, 0, -0.30001780793026e-3),
        (2, 1, 0.47661393906987e-4),
        (2, 3, -0.44141845330846e-5),
        (2, 17, -0.72694996297594e-15),
        (3, -4, -0.31679644845054e-4),
        (3, 0, -0.28270797985312e-5),
        (3, 6, -0.85205128120103e-9),
        (4, -5, -0.22425281908000e-5),
        (4, -2, -0.65171222895601e-6),
        (4, 10, -0.14341729937924e-12),
        (5, -8, -0.40516996860117e-6),
        (8, -11, -0.12734301741641e-8),
        (8, -6, -0.17424871230634e-9),
        (21, -29, -0.68762131295531e-18),
        (23, -31, 0.14478307828521e-19),
        (29, -38, 0.26335781662795e-22),
        (30, -39, -0.11947622640071e-22),
        (31, -40, 0.18228094581404e-23),
        (32, -41, -0.93537087292458e-25),
    ]
)
_GAS_CONSTANT = 461.526
# Table 2 of IAPWS R12-08: rows i, columns j of H_ij.
_H = np.array(
    [
        [5.20094e-1, 2.22531e-1, -2.81378e-1, 1.61913e-1, -3.25372e-2, 0.0, 0.0],
        [8.50895e-2, 9.99115e-1, -9.06851e-1, 2.57399e-1, 0.0, 0.0, 0.0],
        [-1.08374, 1.88797, -7.72479e-1, 0.0, 0.0, 0.0, 0.0],
        [-2.89555e-1, 1.26613, -4.89837e-1, 0.0, 6.98452e-2, 0.0, -4.35673e-3],
        [0.0, 0.0, -2.57040e-1, 0.0, 0.0, 8.72102e-3, 0.0],
        [0.0, 1.20573e-1, 0.0, 0.0, 0.0, 0.0, -5.93264e-4],
    ]
)


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
