"""Equivalent leakage area: the orifice that leaks as much."""

from __future__ import annotations

import math

from leak.fluids.properties import Gas


def leakage_area_of_liquid(leak_rate: float, pressure_drop: float, density: float) -> float:
    """Area of a sharp orifice without losses through which a liquid flows as fast, A = Q sqrt(rho/(2 dp)) [m^2].

    Bernoulli's equation with a discharge coefficient of one. The flow through a seal is laminar, Q ~ dp: A belongs to
    one pressure drop, and grows with its root.

    Parameters
    ----------
    leak_rate : float
        Q [m^3/s].
    pressure_drop : float
        dp [Pa].
    density : float
        rho [kg/m^3].

    Examples
    --------
    >>> f"{leakage_area_of_liquid(1e-6, 200e5, 1000.0) * 1e6:.3f} mm^2"
    '0.005 mm^2'
    """
    return leak_rate * math.sqrt(density / (2 * pressure_drop))


def leakage_area_of_gas(
    mass_flow: float, inlet_pressure: float, outlet_pressure: float, gas: Gas, heat_capacity_ratio: float
) -> float:
    """Area of an ideal nozzle through which a gas flows as fast [m^2].

    Isentropic flow of an ideal gas from rest, with a discharge coefficient of one (Saint-Venant and Wantzel):
    m = A p1 sqrt(2 k/((k - 1) R_s T) (r^(2/k) - r^((k + 1)/k))), r = p2/p1; below the critical ratio
    r* = (2/(k + 1))^(k/(k - 1)) the nozzle is choked and r* stands for r.

    Parameters
    ----------
    mass_flow : float
        m [kg/s].
    inlet_pressure, outlet_pressure : float
        p1, p2, absolute [Pa].
    gas : Gas
        At the temperature before the nozzle.
    heat_capacity_ratio : float
        k, see `leak.fluids.library.heat_capacity_ratio`.

    References
    ----------
    ISO 9300:2005, eq. for the ideal critical flow; Shapiro, The Dynamics and Thermodynamics of Compressible Fluid Flow
    (1953), ch. 4.

    Examples
    --------
    >>> import leak
    >>> area = leakage_area_of_gas(1e-6, 7e5, 1e5, leak.gas("nitrogen"), 1.4)
    >>> f"{area * 1e12:.0f} um^2"
    '615 um^2'
    """
    k = heat_capacity_ratio
    ratio = max(outlet_pressure / inlet_pressure, (2 / (k + 1)) ** (k / (k - 1)))
    # r^(2/k) - r^((k+1)/k) = r^(2/k) (1 - r^((k-1)/k)), exact also where r is close to one
    room = ratio ** (2 / k) * -math.expm1((k - 1) / k * math.log(ratio))
    speed = math.sqrt(2 * k / ((k - 1) * gas.specific_gas_constant * gas.temperature) * room)
    return mass_flow / (inlet_pressure * speed)
