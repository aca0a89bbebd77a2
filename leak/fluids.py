"""Liquids with sourced properties at the temperature of use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from leak.errors import FluidError, positive
from leak.fluid_names import ROOM_TEMPERATURE, checked_temperature, known_name


@dataclass(frozen=True)
class Liquid:
    """A Newtonian, incompressible liquid at one temperature.

    Parameters
    ----------
    name : str
        What it is.
    viscosity : float
        Dynamic viscosity [Pa s].
    density : float
        [kg/m^3]
    temperature : float
        At which both hold [K].
    source : str
        Where the numbers come from.

    Raises
    ------
    FluidError
        A property is not positive and finite.
    """

    name: str
    viscosity: float
    density: float
    temperature: float
    source: str

    def __post_init__(self) -> None:
        for key, unit in (("viscosity", "Pa s"), ("density", "kg/m^3"), ("temperature", "K")):
            positive(FluidError, key, getattr(self, key), unit)


@dataclass(frozen=True)
class _Entry:
    """One liquid of the library, its properties as functions of the temperature [K]."""

    name: str
    viscosity: Callable[[float], float]
    density: Callable[[float], float]
    low: float
    high: float
    source: str

    def at(self, temperature: float) -> Liquid:
        T = checked_temperature(self.name, temperature, self.low, self.high)
        return Liquid(self.name, float(self.viscosity(T)), float(self.density(T)), T, self.source)


# -------------------------------------------------------------------- laws of temperature


def _water_viscosity(T: float) -> float:
    """IAPWS SR6-08(2011), eq. for the viscosity of liquid water at 0.1 MPa."""
    t = T / 300.0
    return 1e-6 * (280.68 * t**-1.9 + 511.45 * t**-7.7 + 61.131 * t**-19.6 + 0.45903 * t**-40.0)


def _water_density(T: float) -> float:
    """G. S. Kell, J. Chem. Eng. Data 20, 97 (1975)."""
    t = T - 273.15
    c = (999.83952, 16.945176, -7.9870401e-3, -46.170461e-6, 105.56302e-9, -280.54253e-12)
    return float(np.polynomial.polynomial.polyval(t, c)) / (1.0 + 16.879850e-3 * t)


def _polynomial(*coefficients: float) -> Callable[[float], float]:
    """Polynomial of T - 293.15 K, lowest power first."""
    return lambda T: float(np.polynomial.polynomial.polyval(T - ROOM_TEMPERATURE, coefficients))


def _exponential(*coefficients: float) -> Callable[[float], float]:
    """Exponential of a polynomial of T - 293.15 K, lowest power first."""
    exponent = _polynomial(*coefficients)
    return lambda T: float(np.exp(exponent(T)))


def _thermal_expansion(density_at_15: float, slope: float) -> Callable[[float], float]:
    return lambda T: density_at_15 - slope * (T - 288.15)


def walther(T: float, first: tuple[float, float], second: tuple[float, float]) -> float:
    """Kinematic viscosity of a mineral oil [m^2/s] from that at two other temperatures.

    log10 log10(nu + 0.7) = A - B log10 T, nu in mm^2/s.

    Parameters
    ----------
    T : float
        [K]
    first, second : tuple of float
        Temperature [K] and kinematic viscosity [m^2/s].

    References
    ----------
    ASTM D341 (Walther's equation).

    Examples
    --------
    >>> round(walther(313.15, (313.15, 46e-6), (373.15, 6.76e-6)) * 1e6, 9)
    46.0
    """
    (T1, W1), (T2, W2) = ((t, np.log10(np.log10(nu * 1e6 + 0.7))) for t, nu in (first, second))
    W = W1 + (W2 - W1) * np.log10(T / T1) / np.log10(T2 / T1)
    return float(10.0 ** (10.0**W) - 0.7) * 1e-6


def _interpolated(points: tuple[tuple[float, float], ...]) -> Callable[[float], float]:
    """Viscosity from a table (degC, mPa s): ln eta as a polynomial of 1/T through all points."""
    T = np.array([t + 273.15 for t, _ in points])
    log_eta = np.log([eta * 1e-3 for _, eta in points])
    exponent = np.polynomial.Polynomial.fit(1.0 / T, log_eta, T.size - 1)
    return lambda T: float(np.exp(exponent(1.0 / T)))


# -------------------------------------------------------------------- the library


def _petroleum(
    name: str,
    points: tuple[tuple[float, float], tuple[float, float]],
    density_at_15: float,
    slope: float,
    low: float,
    high: float,
    source: str,
) -> _Entry:
    """Points: (degC, mm^2/s)."""
    first, second = ((t + 273.15, nu * 1e-6) for t, nu in points)
    density = _thermal_expansion(density_at_15, slope)

    def viscosity(T: float) -> float:
        return walther(T, first, second) * density(T)

    return _Entry(name, viscosity, density, low, high, source)


_OIL = (
    "ISO 3448: kinematic viscosity at 40 degC, the midpoint of the class, tolerance 10 %; at 100 degC that of "
    "viscosity index 100 (ISO 2909), typical of mineral hydraulic oil; ASTM D341 between; density of a typical "
    "mineral oil, 870 kg/m^3 at 15 degC less 0.65 kg/m^3 per kelvin"
)
_CRC = "CRC Handbook of Chemistry and Physics, 97th ed., viscosity of liquids at 0 to 100 degC"

_LIQUIDS = (
    _Entry(
        "water",
        _water_viscosity,
        _water_density,
        253.15,
        383.15,
        "viscosity: IAPWS SR6-08(2011), liquid water at 0.1 MPa, uncertainty 1 %; density: G. S. Kell, J. Chem. Eng. "
        "Data 20, 97 (1975)",
    ),
    _petroleum("hydraulic oil ISO VG 32", ((40.0, 32.0), (100.0, 5.362)), 870.0, 0.65, 253.15, 393.15, _OIL),
    _petroleum("hydraulic oil ISO VG 46", ((40.0, 46.0), (100.0, 6.762)), 870.0, 0.65, 253.15, 393.15, _OIL),
    _petroleum(
        "diesel",
        ((40.0, 3.0), (100.0, 1.281)),
        833.0,
        0.70,
        258.15,
        373.15,
        "typical of EN 590, which allows 2.0 to 4.5 mm^2/s at 40 degC and 820 to 845 kg/m^3 at 15 degC; fall of the "
        "viscosity with temperature: that of cetane, ASTM D341",
    ),
    _petroleum(
        "kerosene",
        ((-20.0, 4.1), (40.0, 1.282)),
        799.0,
        0.73,
        233.15,
        373.15,
        "typical certificate of Jet A-1, whose specification (Def Stan 91-091) allows up to 8 mm^2/s at -20 degC and "
        "775 to 840 kg/m^3 at 15 degC; fall of the viscosity with temperature: that of dodecane, ASTM D341",
    ),
    _Entry(
        "glycol/water 50/50",
        _exponential(-5.60125889, -3.26511829e-2, 2.51412728e-4, -1.31742016e-6),
        _polynomial(1064.928663, -0.5323217, -2.241185e-03, 6.876436e-06),
        243.15,
        373.15,
        "ethylene glycol and water, equal masses without inhibitors: A. Melinder, Properties of Secondary Working "
        "Fluids for Indirect Systems, IIR (2010)",
    ),
    _Entry(
        "ethanol",
        _interpolated(((0.0, 1.786), (25.0, 1.074), (50.0, 0.694), (75.0, 0.476))),
        _polynomial(789.3, -0.85),
        273.15,
        348.15,
        f"{_CRC}; density 789.3 kg/m^3 at 20 degC",
    ),
    _Entry(
        "ethylene glycol",
        _interpolated(((25.0, 16.1), (50.0, 6.554), (75.0, 3.340), (100.0, 1.975))),
        _polynomial(1113.5, -0.70),
        283.15,
        373.15,
        f"{_CRC}; density 1113.5 kg/m^3 at 20 degC",
    ),
)
_LIBRARY = {entry.name: entry for entry in _LIQUIDS}
_SYNONYMS = {
    "iso vg 32": "hydraulic oil ISO VG 32",
    "iso vg 46": "hydraulic oil ISO VG 46",
    "jet a-1": "kerosene",
    "glycol/water": "glycol/water 50/50",
}


def liquid(name: str, temperature: float = ROOM_TEMPERATURE) -> Liquid:
    """Liquid of that name from the library `FLUIDS`, at a temperature and atmospheric pressure.

    Parameters
    ----------
    name : str
        A name of `FLUIDS`; "CoolProp:..." takes a fluid of the optional package CoolProp.
    temperature : float
        [K]; 20 degC unless given.

    Raises
    ------
    FluidError
        No such name (the message names the nearest ones), or a temperature outside the range of its correlation.

    Examples
    --------
    >>> f"{liquid('water').viscosity * 1e3:.4f} mPa s"
    '1.0016 mPa s'
    """
    if str(name).startswith("CoolProp:"):
        from leak.coolprop_fluids import coolprop_liquid

        return coolprop_liquid(str(name), temperature)
    return _LIBRARY[known_name(name, _LIBRARY, _SYNONYMS)].at(temperature)


def is_liquid(name: str) -> bool:
    """Whether `liquid` has an entry of that name."""
    key = str(name).strip().lower()
    return key in _SYNONYMS or any(key == known.lower() for known in _LIBRARY)


FLUIDS = MappingProxyType({entry.name: entry.at(ROOM_TEMPERATURE) for entry in _LIQUIDS})
"""The library at 20 degC: name -> Liquid, read-only."""
