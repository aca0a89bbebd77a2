"""Properties of liquids and gases that a leak rate needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import FluidError, positive
from leak.fluids.pressure_law import PressureLaw
from leak.fluids.real_gas import RealGas


@dataclass(frozen=True)
class Liquid:
    """A Newtonian liquid at one temperature.

    Parameters
    ----------
    name : str
        What it is.
    viscosity : float
        Dynamic viscosity at atmospheric pressure [Pa s].
    density : float
        At atmospheric pressure [kg/m^3].
    temperature : float
        At which both hold [K].
    source : str
        Where the numbers come from.
    pressure_law : PressureLaw or None
        Viscosity and density over pressure; None where nothing is known of them.

    Raises
    ------
    FluidError
        A property is not positive and finite.

    Examples
    --------
    >>> import leak
    >>> leak.Liquid("oil", viscosity=0.046, density=870.0, temperature=313.15, source="data sheet").viscosity
    0.046
    """

    name: str
    viscosity: float
    density: float
    temperature: float
    source: str
    pressure_law: PressureLaw | None = None

    def __post_init__(self) -> None:
        for key, unit in (("viscosity", "Pa s"), ("density", "kg/m^3"), ("temperature", "K")):
            positive(FluidError, key, getattr(self, key), unit)


GAS_CONSTANT = 8.314462618
"""R [J/(mol K)], exact in the SI of 2019."""


@dataclass(frozen=True)
class Gas:
    """A gas at one temperature, dilute and ideal unless more is known of it.

    Parameters
    ----------
    name : str
        What it is.
    molar_mass : float
        M [kg/mol].
    viscosity : float
        Dynamic viscosity [Pa s]; that of a dilute gas does not depend on its pressure.
    temperature : float
        At which the viscosity holds, and at which the gas flows [K].
    source : str
        Where the numbers come from.
    dilute_pressure : float
        Up to this pressure density and viscosity are those of the dilute ideal gas within 5 % [Pa].
    real : RealGas or None
        What pressure makes of density and viscosity; None for an ideal dilute gas.

    Raises
    ------
    FluidError
        A property is not positive.

    Examples
    --------
    >>> from leak import gas
    >>> helium = gas("helium")
    >>> f"{helium.mean_free_path(101325.0) * 1e9:.0f} nm"
    '189 nm'
    """

    name: str
    molar_mass: float
    viscosity: float
    temperature: float
    source: str
    dilute_pressure: float = float("inf")
    real: RealGas | None = None

    def __post_init__(self) -> None:
        for key, unit in (("molar_mass", "kg/mol"), ("viscosity", "Pa s"), ("temperature", "K")):
            positive(FluidError, key, getattr(self, key), unit)
        if not self.dilute_pressure > 0.0:
            raise FluidError(f"dilute_pressure = {self.dilute_pressure!r}: must be positive [Pa]")

    @property
    def specific_gas_constant(self) -> float:
        """R_s = R/M [J/(kg K)]."""
        return GAS_CONSTANT / self.molar_mass

    @property
    def molecular_speed(self) -> float:
        """Most probable speed v0 = sqrt(2 R_s T) [m/s]."""
        return float(np.sqrt(2.0 * self.specific_gas_constant * self.temperature))

    def density(self, pressure: float) -> float:
        """Rho = p/(R_s T) of the ideal gas, in which leak rates are counted [kg/m^3]."""
        return pressure / (self.specific_gas_constant * self.temperature)

    def flow_pressure(self, pressure: ArrayLike) -> FloatArray:
        """Pressure at which the ideal dilute gas has the same rho/eta; p itself of such a gas [Pa]."""
        p = np.asarray(pressure, dtype=float)
        return p if self.real is None else self.real.flow_pressure(p)

    def mean_free_path(self, pressure: float) -> float:
        """Mean free path lambda = (eta/rho) sqrt(pi/(2 R_s T)), of an ideal gas (eta/p) sqrt(pi R_s T/2) [m]."""
        q = float(self.flow_pressure(pressure))
        return 0.5 * float(np.sqrt(np.pi)) * self.viscosity * self.molecular_speed / q
