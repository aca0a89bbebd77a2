"""Liquids and gases by their name, with sourced properties at the temperature of use, and more about them."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from importlib.util import find_spec
from types import MappingProxyType
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import FluidError, positive
from leak.extras import command
from leak.files import own_tables
from leak.fluids.properties import (
    GAS_CONSTANT,
    Barus,
    Gas,
    Liquid,
    PressureLaw,
    PressureTable,
    RealGas,
    Roelands,
    Tait,
)
from leak.standards import STANDARD_PRESSURE

# -------------------------------------------------------------------- water under pressure

# Beyond this pressure the formulation of the density would go wild [Pa]; number of values up to it.
_WATER_HIGHEST, _WATER_PRESSURES = 2e8, 65
_WATER = own_tables("leak.fluids", "water.toml")
_REGION_1, _WATER_VISCOSITY = np.array(_WATER["region_1"]), np.array(_WATER["viscosity"])
_WATER_CONSTANT = 461.526


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
    return np.asarray(16.53e6 / (_WATER_CONSTANT * temperature * by_pi))


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
    over_density = np.polynomial.polynomial.polyval(1.0 / T - 1.0, _WATER_VISCOSITY)
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
    T, p = max(temperature, 273.15), np.linspace(0.0, _WATER_HIGHEST, _WATER_PRESSURES)
    density = water_density(T, STANDARD_PRESSURE + p)
    viscosity = water_viscosity(T, density)
    eta, rho = (tuple((values / values[0]).tolist()) for values in (viscosity, density))
    return PressureTable(tuple(p.tolist()), eta, rho)


# -------------------------------------------------------------------- names and ranges

ROOM_TEMPERATURE = 293.15
"""20 degC [K]."""

_DATA = own_tables("leak.fluids", "library.toml")
_SOURCES: dict[str, str] = _DATA["sources"]


def known_name(name: str, library: Collection[str], synonyms: Mapping[str, str]) -> str:
    """Entry of `library` that is meant, whatever its capitals; FluidError with the nearest names if there is none."""
    key = str(name).strip().lower()
    by_key = {entry.lower(): entry for entry in library} | dict(synonyms)
    if key in by_key:
        return by_key[key]
    close = get_close_matches(key, list(by_key), n=2)
    hint = f" - did you mean {' or '.join(close)}?" if close else ""
    raise FluidError(f"fluid = {name!r}: must be one of {', '.join(library)}{hint}")


def checked_temperature(name: str, temperature: float, low: float, high: float) -> float:
    """`temperature` as a float, or FluidError outside the range [K] in which the correlation of a fluid holds."""
    T = positive(FluidError, "temperature", temperature, "K")
    # A round number of degrees must not fail by the last bit of its kelvins.
    if not low - 1e-6 <= T <= high + 1e-6:
        raise FluidError(
            f"temperature = {T:.6g} K ({T - 273.15:.6g} degC): the properties of {name} are known from {low:g} to "
            f"{high:g} K ({low - 273.15:.4g} to {high - 273.15:.4g} degC){_elsewhere(name)}"
        )
    return T


_Fluid = TypeVar("_Fluid", Liquid, Gas)


@dataclass(frozen=True)
class _Entry(Generic[_Fluid]):
    """One fluid of the library: where its properties are known [K], from whom, and what they are there."""

    name: str
    low: float
    high: float
    source: str
    properties: Callable[[float], _Fluid]

    def at(self, temperature: float) -> _Fluid:
        return self.properties(checked_temperature(self.name, temperature, self.low, self.high))


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


def _mineral_oil(points: list[list[float]], density: Callable[[float], float]) -> Callable[[float], float]:
    """Viscosity from the kinematic one [mm^2/s] at two temperatures [degC]."""
    first, second = ((t + 273.15, nu * 1e-6) for t, nu in points)
    return lambda T: walther(T, first, second) * density(T)


def _interpolate_viscosity(points: tuple[tuple[float, float], ...]) -> Callable[[float], float]:
    """Viscosity from a table (degC, mPa s): ln eta as a polynomial of 1/T through all points."""
    T = np.array([t + 273.15 for t, _ in points])
    log_eta = np.log([eta * 1e-3 for _, eta in points])
    exponent = np.polynomial.Polynomial.fit(1.0 / T, log_eta, T.size - 1)
    return lambda T: float(np.exp(exponent(1.0 / T)))


# -------------------------------------------------------------------- laws of pressure


def _petroleum_law(bulk_modulus: float, highest: float) -> Callable[[float, float], PressureLaw]:
    """Roelands' law with one exponent over the viscosity, from mineral oil to alkanes as thin as petrol.

    Z = 0.67 is a mineral oil of 40 mPa s and 22/GPa; the second part follows decane and dodecane from 20 to 80 degC
    within 7 % of the viscosity up to 1000 bar. The bulk modulus at 20 degC falls by 0.7 % per kelvin, as theirs does.
    """

    def law(T: float, viscosity: float) -> PressureLaw:
        exponent = 0.67 + 0.047 * (1e-3 / viscosity) ** 2
        compression = Tait.of_bulk_modulus(bulk_modulus * float(np.exp(-0.0070 * (T - ROOM_TEMPERATURE))))
        return Roelands(exponent, viscosity, compression, highest, 0.15)

    return law


def _known_law(data: Mapping[str, Any]) -> Callable[[float, float], PressureLaw] | None:
    """Barus' or Roelands' law with the numbers of the liquid's own table; None where it has none."""
    if "bulk_modulus" not in data:
        return None
    (modulus, fall), highest, uncertainty = (
        data[key] for key in ("bulk_modulus", "highest_pressure", "uncertainty")
    )

    def law(T: float, viscosity: float) -> PressureLaw:
        compression = Tait.of_bulk_modulus(modulus * float(np.exp(-fall * (T - ROOM_TEMPERATURE))))
        if "pressure_viscosity" in data:
            return Barus(data["pressure_viscosity"], compression, highest, uncertainty)
        exponent = _polynomial(*data["roelands_z"])(T)
        return Roelands(exponent, viscosity, compression, highest, uncertainty)

    return law


# -------------------------------------------------------------------- the library


def _liquid_entry(name: str, data: Mapping[str, Any]) -> _Entry[Liquid]:
    """Entry of the library from its table in library.toml."""
    source = data["source"].format(**_SOURCES)
    viscosity: Callable[[float], float]
    law: Callable[[float, float], PressureLaw] | None
    if "kinematic_viscosity" in data:
        density, modulus = _thermal_expansion(*data["density"]), data["bulk_modulus"]
        source += (
            f"; {_SOURCES['thickens']}; density by the Tait equation of {_SOURCES['dymond']}, typical bulk modulus "
            f"{modulus / 1e9:g} GPa at 20 degC"
        )
        viscosity = _mineral_oil(data["kinematic_viscosity"], density)
        law = _petroleum_law(modulus, data["highest_pressure"])
    elif name == "water":
        viscosity, density, law = _water_viscosity, _water_density, lambda T, viscosity: water_law(T)
    else:
        is_formula, density = "log_viscosity" in data, _polynomial(*data["density"])
        viscosity = (
            _exponential(*data["log_viscosity"]) if is_formula else _interpolate_viscosity(data["viscosity"])
        )
        law = _known_law(data)

    def at(T: float) -> Liquid:
        eta = float(viscosity(T))
        return Liquid(name, eta, float(density(T)), T, source, None if law is None else law(T, eta))

    low, high = data["temperature"]
    return _Entry(name, low, high, source, at)


LIQUID_ENTRIES = tuple(_liquid_entry(name, data) for name, data in _DATA["liquids"].items())


FLUIDS = MappingProxyType({entry.name: entry.at(ROOM_TEMPERATURE) for entry in LIQUID_ENTRIES})
"""The library at 20 degC: name -> Liquid, read-only."""


# Collision integral of Lemmon & Jacobsen (2004), and where it holds [K].
_LEMMON, _LEMMON_RANGE = (0.431, -0.4623, 0.08406, 0.005341, -0.00331), (200.0, 1000.0)


def _gas_entry(name: str, data: Mapping[str, Any]) -> _Entry[Gas]:
    """Entry of the library from its table in library.toml.

    At zero density eta = scale sqrt(T)/exp(sum b_i ln(T/T_e)^i), with the scale of Chapman and Enskog where a diameter
    is known.
    """
    scale, source = data.get("scale"), data["source"].format(**_SOURCES)
    if scale is None:
        scale = 0.0266958 * np.sqrt(data["molar_mass"]) / data["diameter"] ** 2

    def at(T: float) -> Gas:
        log_T = np.log(T / data["energy"])
        log_integral = np.polynomial.polynomial.polyval(log_T, data.get("collision", _LEMMON))
        viscosity = float(float(scale) * 1e-6 * np.sqrt(T) * np.exp(-log_integral))
        return Gas(name, data["molar_mass"] / 1e3, viscosity, T, source, data["dilute_pressure"] * 1e5)

    low, high = data.get("temperature", _LEMMON_RANGE)
    return _Entry(name, low, high, source, at)


GAS_ENTRIES = tuple(_gas_entry(name, data) for name, data in _DATA["gases"].items())
ENTRIES: tuple[_Entry[Liquid] | _Entry[Gas], ...] = (*LIQUID_ENTRIES, *GAS_ENTRIES)


GASES = MappingProxyType({entry.name: entry.at(ROOM_TEMPERATURE) for entry in GAS_ENTRIES})
"""The library at 20 degC: name -> Gas, read-only."""


# -------------------------------------------------------------------- by name

_LIQUIDS = {entry.name: entry for entry in LIQUID_ENTRIES}
_SYNONYMS = {word: name for name, data in _DATA["liquids"].items() for word in data.get("synonyms", ())}


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
        from leak.fluids.coolprop import coolprop_liquid

        return coolprop_liquid(str(name), temperature)
    return _LIQUIDS[known_name(name, _LIQUIDS, _SYNONYMS)].at(temperature)


def is_liquid(name: str) -> bool:
    """Whether `liquid` has an entry of that name.

    Examples
    --------
    >>> import leak
    >>> leak.is_liquid("water"), leak.is_liquid("helium")
    (True, False)
    """
    key = str(name).strip().lower()
    return key in _SYNONYMS or any(key == entry.lower() for entry in _LIQUIDS)


_GASES = {entry.name: entry for entry in GAS_ENTRIES}
_SHORT_NAMES = {word: name for name, data in _DATA["gases"].items() for word in data.get("synonyms", ())}


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
        from leak.fluids.coolprop import coolprop_gas

        return coolprop_gas(str(name), temperature)
    return _GASES[known_name(name, _GASES, _SHORT_NAMES)].at(temperature)


def is_gas(name: str) -> bool:
    """Whether `gas` has an entry of that name.

    Examples
    --------
    >>> import leak
    >>> leak.is_gas("helium"), leak.is_gas("water")
    (True, False)
    """
    key = str(name).strip().lower()
    return key in _GASES or key in _SHORT_NAMES


# -------------------------------------------------------------------- what else is known

CRITICAL = MappingProxyType({name: tuple(data["critical"]) for name, data in _DATA["gases"].items()})
"""Name of a gas -> critical temperature [K], pressure [bar], acentric factor [-] and molar volume [cm^3/mol]."""
HEAT_CAPACITIES = MappingProxyType({name: data["heat_capacity"] for name, data in _DATA["gases"].items()})
"""Name of a gas -> molar heat capacity at constant pressure of the ideal gas at 25 degC [J/(mol K)], read-only."""


def heat_capacity_ratio(name: str) -> float | None:
    """Kappa = c_p/(c_p - R) of a gas of the library at 25 degC; None for any other name.

    Parameters
    ----------
    name : str
        Of `leak.GASES`, or "CoolProp:..." with the optional package CoolProp.

    Examples
    --------
    >>> round(heat_capacity_ratio("nitrogen"), 3), round(heat_capacity_ratio("helium"), 3)
    (1.4, 1.667)
    """
    if name.startswith("CoolProp:"):
        from leak.fluids.coolprop import coolprop_heat_capacity

        heat_capacity: float | None = coolprop_heat_capacity(name)
    else:
        heat_capacity = HEAT_CAPACITIES.get(name)
    return None if heat_capacity is None else heat_capacity / (heat_capacity - GAS_CONSTANT)


ACCOMMODATION = MappingProxyType(
    {name: data["accommodation"] for name, data in _DATA["gases"].items() if "accommodation" in data}
)
"""Name of a gas -> measured thermal accommodation coefficient of metals in air [-], read-only."""


def thermal_conductivity(name: str, temperature: float) -> float | None:
    """Of a fluid at atmospheric pressure, of a gas when dilute [W/(m K)]; None where it is not known.

    Parameters
    ----------
    name : str
        Of the library, or "CoolProp:..." with the optional package CoolProp.
    temperature : float
        [K]

    Examples
    --------
    >>> [round(thermal_conductivity(name, 293.15), 3) for name in ("water", "nitrogen")]
    [0.597, 0.025]
    """
    if name.startswith("CoolProp:"):
        from leak.fluids.coolprop import coolprop_thermal_conductivity

        return coolprop_thermal_conductivity(name, temperature)
    coefficients = {**_DATA["liquids"], **_DATA["gases"]}.get(name, {}).get("thermal_conductivity")
    return None if coefficients is None else _polynomial(*coefficients)(temperature)


# The optional package CoolProp has these entries, too.
_IN_COOLPROP = frozenset(GASES) | {"water", "ethanol"}


def coolprop_name(name: str) -> str | None:
    """The same fluid of the optional package CoolProp, as a case file asks for it; None if it has no such fluid.

    Parameters
    ----------
    name : str
        Of the library.

    Examples
    --------
    >>> coolprop_name("hydrogen")
    'CoolProp:Hydrogen'
    """
    return f"CoolProp:{name.title().replace(' ', '')}" if name in _IN_COOLPROP else None


def _elsewhere(name: str) -> str:
    other = coolprop_name(name)
    if other is None:
        return ""
    hint = "" if find_spec("CoolProp") else f" ({command('coolprop')})"
    return f'; "{other}" of the optional package CoolProp{hint} knows more'


MOLECULAR_SIZES = MappingProxyType({word: size * 1e-9 for word, size in _DATA["molecular_sizes"].items()})
"""Word in a fluid's name -> smallest channel that it passes [m], read-only."""


def molecular_size(fluid: str) -> float:
    """Kinetic diameter of a fluid's molecules [m]; of a mixture with water that of water, which passes first.

    Parameters
    ----------
    fluid : str
        Name of the fluid; of one that is not known the smallest size of all is returned, helium's.

    Examples
    --------
    >>> molecular_size("hydraulic oil ISO VG 32")
    4.3e-10
    """
    name = fluid.strip().lower()
    sizes = [size for word, size in MOLECULAR_SIZES.items() if word in name]
    return min(sizes, default=min(MOLECULAR_SIZES.values()))


# -------------------------------------------------------------------- dense gases, for warnings


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
    away from condensation. The largest root is taken: that a gas condenses is for `condensation_pressure` to say.

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
    reduced_density = pressures * critical.volume / (Z * GAS_CONSTANT * gas.temperature)
    ratios = 1.0 + _dense_viscosity(critical, gas.molar_mass, reduced_density) / gas.viscosity
    return RealGas(tuple(pressures.tolist()), tuple(Z.tolist()), tuple(ratios.tolist()))


def condensation_pressure(gas: Gas) -> float:
    """Pressure above which a library gas is a liquid [Pa], within 1 % of carbon dioxide; infinite where it is none.

    Parameters
    ----------
    gas : Gas

    References
    ----------
    G. M. Wilson, AIChE 65th National Meeting, Cleveland (1968), paper 15C: vapour pressure from critical constants.

    Examples
    --------
    >>> import leak
    >>> f"{condensation_pressure(leak.gas('carbon dioxide')) / 1e5:.0f} bar"
    '58 bar'
    """
    temperature, pressure, acentric, _ = CRITICAL.get(gas.name, (0.0, 0.0, 0.0, 0.0))
    if gas.temperature >= temperature:
        return math.inf
    return pressure * 1e5 * math.exp(5.373 * (1.0 + acentric) * (1.0 - temperature / gas.temperature))


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
