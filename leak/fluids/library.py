"""Liquids and gases by their name, with sourced properties at the temperature of use, and more about them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from importlib.util import find_spec
from types import MappingProxyType

import numpy as np

from leak.errors import FluidError, positive
from leak.extras import command
from leak.fluids.pressure_law import Barus, PressureLaw, Roelands, Tait
from leak.fluids.properties import GAS_CONSTANT, Gas, Liquid
from leak.fluids.water import water_law

ROOM_TEMPERATURE = 293.15
"""20 degC [K]."""


def known_name(name: str, library: Collection[str], synonyms: Mapping[str, str]) -> str:
    """Entry of `library` that is meant, whatever its capitals; FluidError with the nearest names if there is none."""
    key = str(name).strip().lower()
    by_key = {known.lower(): known for known in library} | dict(synonyms)
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


# -------------------------------------------------------------------- liquids


@dataclass(frozen=True)
class _LiquidEntry:
    """One liquid of the library, its properties as functions of the temperature [K]."""

    name: str
    viscosity: Callable[[float], float]
    density: Callable[[float], float]
    low: float
    high: float
    source: str
    under_pressure: Callable[[float, float], PressureLaw] | None = None
    """From temperature [K] and viscosity at atmospheric pressure [Pa s]."""

    def at(self, temperature: float) -> Liquid:
        T = checked_temperature(self.name, temperature, self.low, self.high)
        eta = float(self.viscosity(T))
        law = None if self.under_pressure is None else self.under_pressure(T, eta)
        return Liquid(self.name, eta, float(self.density(T)), T, self.source, law)


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


def _ethanol_law(T: float, viscosity: float) -> PressureLaw:
    """Fitted to the reference correlation at 0 to 75 degC, up to 2000 bar."""
    compression = Tait.of_bulk_modulus(0.886e9 * float(np.exp(-0.0070 * (T - ROOM_TEMPERATURE))))
    return Roelands(0.31 + 0.0033 * (T - ROOM_TEMPERATURE), viscosity, compression, 2e8, 0.1)


def _glycol_law(T: float, viscosity: float) -> PressureLaw:
    """An estimate: glycol thickens by some 4/GPa, water by next to nothing."""
    return Barus(2.5e-9, Tait.of_bulk_modulus(2.8e9), 1.2e8, 0.4)


_THICKENS = (
    "under pressure: law of C. J. A. Roelands et al., J. Basic Eng. 85, 601 (1963), Z = 0.67 + 0.047 (mPa s/eta0)^2 "
    "between the typical mineral oil of C. H. Venner, A. A. Lubrecht, Multilevel Methods in Lubrication (2000), "
    "22/GPa at 40 mPa s, and decane and dodecane, M. L. Huber, A. Laesecke, H. W. Xiang, Fluid Phase Equilib. 224, "
    "263 (2004); 15 % of the logarithm uncertain"
)
_DYMOND = "J. H. Dymond, R. Malhotra, Int. J. Thermophys. 9, 941 (1988)"

# -------------------------------------------------------------------- the library


def _petroleum(
    name: str,
    points: tuple[tuple[float, float], tuple[float, float]],
    density_at_15: float,
    slope: float,
    low: float,
    high: float,
    source: str,
    *,
    bulk_modulus: float,
    highest_pressure: float,
) -> _LiquidEntry:
    """Points: (degC, mm^2/s)."""
    first, second = ((t + 273.15, nu * 1e-6) for t, nu in points)
    density = _thermal_expansion(density_at_15, slope)

    def viscosity(T: float) -> float:
        return walther(T, first, second) * density(T)

    modulus = f"density by the Tait equation of {_DYMOND}, typical bulk modulus {bulk_modulus / 1e9:g} GPa at 20 degC"
    law = _petroleum_law(bulk_modulus, highest_pressure)
    return _LiquidEntry(name, viscosity, density, low, high, f"{source}; {_THICKENS}; {modulus}", law)


_OIL = (
    "ISO 3448: kinematic viscosity at 40 degC, the midpoint of the class, tolerance 10 %; at 100 degC that of "
    "viscosity index 100 (ISO 2909), typical of mineral hydraulic oil; ASTM D341 between; density of a typical "
    "mineral oil, 870 kg/m^3 at 15 degC less 0.65 kg/m^3 per kelvin"
)
_CRC = "CRC Handbook of Chemistry and Physics, 97th ed., viscosity of liquids at 0 to 100 degC"


def _hydraulic_oil(grade: int, hot: float) -> _LiquidEntry:
    """Of a class ISO VG, with its kinematic viscosity at 100 degC [mm^2/s]."""
    name, points = f"hydraulic oil ISO VG {grade}", ((40.0, grade), (100.0, hot))
    return _petroleum(
        name, points, 870.0, 0.65, 253.15, 393.15, _OIL, bulk_modulus=1.65e9, highest_pressure=3e8
    )


LIQUID_ENTRIES = (
    _LiquidEntry(
        "water",
        _water_viscosity,
        _water_density,
        253.15,
        383.15,
        "viscosity: IAPWS SR6-08(2011), liquid water at 0.1 MPa, uncertainty 1 %; density: G. S. Kell, J. Chem. Eng. "
        "Data 20, 97 (1975); under pressure: viscosity IAPWS R12-08, density IAPWS R7-97(2012), region 1",
        lambda T, viscosity: water_law(T),
    ),
    _hydraulic_oil(32, 5.362),
    _hydraulic_oil(46, 6.762),
    _petroleum(
        "diesel",
        ((40.0, 3.0), (100.0, 1.281)),
        833.0,
        0.70,
        258.15,
        373.15,
        "typical of EN 590, which allows 2.0 to 4.5 mm^2/s at 40 degC and 820 to 845 kg/m^3 at 15 degC; fall of the "
        "viscosity with temperature: that of cetane, ASTM D341",
        bulk_modulus=1.35e9,
        highest_pressure=2e8,
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
        bulk_modulus=1.2e9,
        highest_pressure=2e8,
    ),
    _LiquidEntry(
        "glycol/water 50/50",
        _exponential(-5.60125889, -3.26511829e-2, 2.51412728e-4, -1.31742016e-6),
        _polynomial(1064.928663, -0.5323217, -2.241185e-03, 6.876436e-06),
        243.15,
        373.15,
        "ethylene glycol and water, equal masses without inhibitors: A. Melinder, Properties of Secondary Working "
        "Fluids for Indirect Systems, IIR (2010); under pressure: estimate of 2.5/GPa, 40 % uncertain, between water "
        "and the glycol, with the nearly linear rise up to 1200 bar that Y. Tanaka et al., Int. J. Thermophys. 9, 511 "
        f"(1988), measured at 25 and 50 degC; density by the Tait equation of {_DYMOND}, bulk modulus 2.8 GPa",
        _glycol_law,
    ),
    _LiquidEntry(
        "ethanol",
        _interpolated(((0.0, 1.786), (25.0, 1.074), (50.0, 0.694), (75.0, 0.476))),
        _polynomial(789.3, -0.85),
        273.15,
        348.15,
        f"{_CRC}; density 789.3 kg/m^3 at 20 degC; under pressure: fitted with Roelands' law and the Tait equation to "
        "S. B. Kiselev et al., Ind. Eng. Chem. Res. 44, 6916 (2005), and its equation of state in CoolProp",
        _ethanol_law,
    ),
    _LiquidEntry(
        "ethylene glycol",
        _interpolated(((25.0, 16.1), (50.0, 6.554), (75.0, 3.340), (100.0, 1.975))),
        _polynomial(1113.5, -0.70),
        283.15,
        373.15,
        f"{_CRC}; density 1113.5 kg/m^3 at 20 degC",
    ),
)


FLUIDS = MappingProxyType({entry.name: entry.at(ROOM_TEMPERATURE) for entry in LIQUID_ENTRIES})
"""The library at 20 degC: name -> Liquid, read-only."""


@dataclass(frozen=True)
class _GasEntry:
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
) -> _GasEntry:
    """Molar mass in g/mol, diameter in nm, energy over k in K, as in the papers."""
    scale = 0.0266958e-6 * np.sqrt(molar_mass) / diameter**2
    return _GasEntry(
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


GAS_ENTRIES = (
    _GasEntry(
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
    _GasEntry(
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
    _GasEntry(
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


GASES = MappingProxyType({entry.name: entry.at(ROOM_TEMPERATURE) for entry in GAS_ENTRIES})
"""The library at 20 degC: name -> Gas, read-only."""


# -------------------------------------------------------------------- by name

_LIQUIDS = {entry.name: entry for entry in LIQUID_ENTRIES}
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
    return key in _SYNONYMS or any(key == known.lower() for known in _LIQUIDS)


_GASES = {entry.name: entry for entry in GAS_ENTRIES}
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
        from leak.fluids.coolprop import coolprop_gas

        return coolprop_gas(str(name), temperature)
    return _GASES[known_name(name, _GASES, _SHORT)].at(temperature)


def is_gas(name: str) -> bool:
    """Whether `gas` has an entry of that name.

    Examples
    --------
    >>> import leak
    >>> leak.is_gas("helium"), leak.is_gas("water")
    (True, False)
    """
    key = str(name).strip().lower()
    return key in _GASES or key in _SHORT


# -------------------------------------------------------------------- what else is known

_MONATOMIC = 2.5 * GAS_CONSTANT
_NITROGEN, _OXYGEN = 29.124, 29.376

HEAT_CAPACITIES = MappingProxyType(
    {
        "helium": _MONATOMIC,
        "argon": _MONATOMIC,
        "hydrogen": 28.836,
        "nitrogen": _NITROGEN,
        "oxygen": _OXYGEN,
        # dry air by volume
        "air": 0.78084 * _NITROGEN + 0.20946 * _OXYGEN + 0.0097 * _MONATOMIC,
        "methane": 35.639,
        "carbon dioxide": 37.129,
    }
)
"""Name of a gas -> molar heat capacity at constant pressure of the ideal gas at 25 degC [J/(mol K)], read-only.

NIST-JANAF Thermochemical Tables, 4th ed. (1998).
"""


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
    there = "" if find_spec("CoolProp") else f" ({command('coolprop')})"
    return f'; "{other}" of the optional package CoolProp{there} knows more'


# Kinetic diameters: D. W. Breck, Zeolite Molecular Sieves, Wiley (1974), table 8.1 (air: nitrogen's).
# Oils and fuels pass where their chains do sideways: the kinetic diameter of normal butane and longer paraffins.
_PARAFFIN = 0.43e-9
_WATER = 0.265e-9

MOLECULAR_SIZES = MappingProxyType(
    {
        "helium": 0.26e-9,
        "hydrogen": 0.289e-9,
        "nitrogen": 0.364e-9,
        "air": 0.364e-9,
        "oxygen": 0.346e-9,
        "argon": 0.34e-9,
        "carbon dioxide": 0.33e-9,
        "methane": 0.38e-9,
        "water": _WATER,
        "oil": _PARAFFIN,
        "diesel": _PARAFFIN,
        "kerosene": _PARAFFIN,
    }
)
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
    found = [size for word, size in MOLECULAR_SIZES.items() if word in name]
    return min(found, default=min(MOLECULAR_SIZES.values()))
