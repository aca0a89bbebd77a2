"""What flows where nothing seals: through an open bore, and through the gap of faces that just touch."""

from __future__ import annotations

import math

import numpy as np

from leak.arrays import FloatArray
from leak.flow.rarefied import log_flow_factor
from leak.fluids.library import heat_capacity_ratio
from leak.fluids.properties import GAS_CONSTANT, Gas
from leak.standards import STANDARD_PRESSURE

# Of a gas of which it is not known: that of one atom in a molecule, the largest.
_MONATOMIC = 5.0 / 3.0


def liquid_through_bore(radius: float, pressure_drop: float, density: float) -> float:
    """Volume flow of a liquid through an open bore without friction, A sqrt(2 dp/rho) (Bernoulli, Torricelli) [m^3/s].

    Parameters
    ----------
    radius : float
        Of the bore [m].
    pressure_drop : float
        [Pa]
    density : float
        [kg/m^3]

    Examples
    --------
    >>> f"{liquid_through_bore(5e-3, 1e5, 1000.0) * 6e4:.1f} l/min"
    '66.6 l/min'
    """
    return math.pi * radius**2 * math.sqrt(2.0 * pressure_drop / density)


def gas_through_bore(radius: float, gas: Gas, high: float, low: float) -> float:
    """Mass flow of a gas through an open bore without friction or heat, at most that of choked flow [kg/s].

    Isentropic flow of an ideal gas with the density that the gas has at the high pressure (de Saint-Venant, Wantzel;
    ISO 9300). Where a real gas is as dense as a liquid, it flows some tens of per cent otherwise.

    Parameters
    ----------
    radius : float
        Of the bore [m].
    gas : Gas
    high, low : float
        Absolute pressures [Pa].

    Examples
    --------
    >>> import leak
    >>> f"{gas_through_bore(0.5e-3, leak.gas('nitrogen', 293.15), 1e6, 1e5) * 1e3:.2f} g/s"
    '1.82 g/s'
    """
    kappa = heat_capacity_ratio(gas.name) or _MONATOMIC
    choked = (2.0 / (kappa + 1.0)) ** (kappa / (kappa - 1.0))
    ratio = max(low / high, choked)
    factor = 1.0 if gas.real is None else float(gas.real.factor(high))
    density = high * gas.molar_mass / (factor * GAS_CONSTANT * gas.temperature)
    expansion = ratio ** (2.0 / kappa) - ratio ** ((kappa + 1.0) / kappa)
    return math.pi * radius**2 * math.sqrt(2.0 * kappa / (kappa - 1.0) * high * density * expansion)


def gap_resistance(x: FloatArray, radius: FloatArray, gap: FloatArray) -> float:
    """Resistance of a smooth ring-shaped gap over the viscosity, 12 int dx/(2 pi r gap^3) [1/m^3].

    Parameters
    ----------
    x, radius, gap : ndarray, shape (n,)
        Along the flow, distance from the axis and gap [m].

    Examples
    --------
    >>> x = np.linspace(0.0, 1e-3, 5)
    >>> f"{gap_resistance(x, np.full(5, 1e-2), np.full(5, 1e-5)):.3g}"
    '1.91e+14'
    """
    return float(np.trapezoid(12.0 / (2.0 * math.pi * radius * gap**3), x))


def gas_through_gap(resistance: float, gap: float, gas: Gas, high: float, low: float) -> float:
    """Volume flow of a gas through a gap, at 101325 Pa and its temperature, isothermal and rarefied [m^3/s].

    Parameters
    ----------
    resistance : float
        See `gap_resistance` [1/m^3].
    gap : float
        Where it is narrowest, for what rarefaction adds: the most [m].
    gas : Gas
    high, low : float
        Absolute pressures [Pa].

    Examples
    --------
    >>> import leak
    >>> helium = leak.gas("helium")
    >>> dense, thin = (gas_through_gap(1e15, one, helium, 2e5, 1e5) for one in (1e-4, 1e-6))
    >>> dense < thin < 3.0 * dense
    True
    """
    # even in p^2, in which a flow without rarefaction is
    pressure = np.sqrt(np.linspace(low**2, high**2, 64))
    paths = np.array([gas.mean_free_path(max(one, 1e-6 * high)) for one in pressure])
    more = np.exp(log_flow_factor(np.log(0.5 * math.sqrt(math.pi) * gap / paths)))
    driving = np.trapezoid(gas.flow_pressure(pressure) * more, pressure)
    return float(driving / (gas.viscosity * resistance * STANDARD_PRESSURE))
