"""Fluids by their name."""

from __future__ import annotations

from leak.fluids.library import GAS_ENTRIES, LIQUID_ENTRIES
from leak.fluids.names import ROOM_TEMPERATURE, known_name
from leak.fluids.properties import Gas, Liquid

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
