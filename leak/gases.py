"""Gases with sourced properties."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from leak.errors import FluidError, positive
from leak.fluid_names import ROOM_TEMPERATURE, checked_temperature, known_name

GAS_CONSTANT = 8.314462618
"""R [J/(mol K)], exact in the SI of 2019."""


@dataclass(frozen=True)
class Gas:
    """A dilute ideal gas at one temperature.

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

    Raises
    ------
    FluidError
        A property is not positive.

    Examples
    --------
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
        """Rho = p/(R_s T) [kg/m^3]."""
        return pressure / (self.specific_gas_constant * self.temperature)

    def mean_free_path(self, pressure: float) -> float:
        """Mean free path lambda = (eta/p) sqrt(pi R_s T/2) [m]."""
        return 0.5 * float(np.sqrt(np.pi)) * self.viscosity * self.molecular_speed / pressure


@dataclass(frozen=True)
class _Entry:
    """One gas of the library: eta = scale sqrt(T)/exp(sum b_i ln(T/T_e)^i) at zero density."""

    name: str
    molar_mass: float
    scale: float
    energy: float
    collision: tuple[float, ...]
    low: float
    high: float
    dilute_pressure: float
    source: str

    def at(self, temperature: float) -> Gas:
        T = checked_temperature(self.name, temperature, self.low, self.high)
        log_integral = np.polynomial.polynomial.polyval(np.log(T / self.energy), self.collision)
        viscosity = self.scale * np.sqrt(T) * np.exp(-log_integral)
        return Gas(self.name, self.molar_mass, float(viscosity), T, self.source, self.dilute_pressure)


# Collision integral of Lemmon & Jacobsen (2004).
_LEMMON = (0.431, -0.4623, 0.08406, 0.005341, -0.00331)
_AIR_PAPER = (
    "E. W. Lemmon, R. T Jacobsen, Int. J. Thermophys. 25, 21 (2004), dilute gas, uncertainty 1 to 2 %"
)
_DILUTE = "; molar mass: IUPAC 2021"


def _chapman_enskog(
    name: str, molar_mass: float, diameter: float, energy: float, dilute_pressure: float, source: str
) -> _Entry:
    """Molar mass in g/mol, diameter in nm, energy over k in K, as in the papers."""
    scale = 0.0266958e-6 * np.sqrt(molar_mass) / diameter**2
    return _Entry(
        name,
        molar_mass * 1e-3,
        float(scale),
        energy,
        _LEMMON,
        200.0,
        1000.0,
        dilute_pressure,
        source + _DILUTE,
    )


_GASES = (
    _Entry(
        "helium",
        4.002602e-3,
        19.825e-6 / np.sqrt(298.15),
        298.15,
        # eta ~ T^0.69
        (0.0, -0.19),
        200.0,
        600.0,
        100e5,
        "J. J. Hurly, J. B. Mehl, J. Res. NIST 112, 75 (2007), 19.825 uPa s at 298.15 K from first principles; "
        "eta ~ T^0.69 holds to 0.6 % from 200 to 600 K" + _DILUTE,
    ),
    _Entry(
        "hydrogen",
        2.01588e-3,
        0.021357e-6 * np.sqrt(2.01588) / 0.297**2,
        30.41,
        (2.0963e-1, -4.55274e-1, 1.43602e-1, -3.35325e-2, 2.76981e-3),
        200.0,
        1000.0,
        80e5,
        "C. D. Muzny, M. L. Huber, A. F. Kazakov, J. Chem. Eng. Data 58, 969 (2013), dilute-gas viscosity, "
        "uncertainty 2 %" + _DILUTE,
    ),
    _chapman_enskog("nitrogen", 28.0134, 0.3656, 98.94, 50e5, _AIR_PAPER),
    _chapman_enskog("oxygen", 31.9988, 0.3428, 118.5, 44e5, _AIR_PAPER),
    _chapman_enskog("argon", 39.948, 0.335, 143.2, 48e5, _AIR_PAPER),
    _chapman_enskog("air", 28.9586, 0.360, 103.3, 49e5, _AIR_PAPER + "; dry air"),
    _chapman_enskog(
        "methane",
        16.0428,
        0.3758,
        148.6,
        27e5,
        "Lennard-Jones parameters of R. A. Svehla, NASA TR R-132 (1962), in B. E. Poling et al., The Properties of "
        "Gases and Liquids, 5th ed., App. B; collision integral of Lemmon & Jacobsen (2004); within 1 % of the "
        "reference correlation from 200 to 600 K",
    ),
    _Entry(
        "carbon dioxide",
        44.0095e-3,
        1.00697e-6,
        251.196,
        (0.235156, -0.491266, 5.211155e-2, 5.347906e-2, -1.537102e-2),
        220.0,
        1000.0,
        9e5,
        "A. Fenghour, W. A. Wakeham, V. Vesovic, J. Phys. Chem. Ref. Data 27, 31 (1998), dilute-gas viscosity, "
        "uncertainty 0.3 % near 300 K" + _DILUTE,
    ),
)
_LIBRARY = {entry.name: entry for entry in _GASES}
_SHORT = {
    "he": "helium",
    "h2": "hydrogen",
    "n2": "nitrogen",
    "o2": "oxygen",
    "ar": "argon",
    "ch4": "methane",
    "co2": "carbon dioxide",
}


def gas(name: str, temperature: float = ROOM_TEMPERATURE) -> Gas:
    """Gas of that name from the library `GASES`, at a temperature.

    Parameters
    ----------
    name : str
        A name of `GASES` or its formula ("He"); "CoolProp:..." takes a fluid of the optional package CoolProp.
    temperature : float
        [K]; 20 degC unless given.

    Raises
    ------
    FluidError
        No such name, or a temperature outside the range of its correlation.

    Examples
    --------
    >>> f"{gas('nitrogen', temperature=300.0).viscosity * 1e6:.2f} uPa s"
    '17.88 uPa s'
    """
    if str(name).startswith("CoolProp:"):
        from leak.coolprop_fluids import coolprop_gas

        return coolprop_gas(str(name), temperature)
    return _LIBRARY[known_name(name, _LIBRARY, _SHORT)].at(temperature)


def is_gas(name: str) -> bool:
    """Whether `gas` has an entry of that name."""
    key = str(name).strip().lower()
    return key in _LIBRARY or key in _SHORT


GASES = MappingProxyType({entry.name: entry.at(ROOM_TEMPERATURE) for entry in _GASES})
"""The library at 20 degC: name -> Gas, read-only."""
