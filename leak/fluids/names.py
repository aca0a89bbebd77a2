"""What the libraries of liquids and gases share: finding a name, checking a temperature, the size of a molecule."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from difflib import get_close_matches
from importlib.util import find_spec
from types import MappingProxyType

from leak.errors import FluidError, positive
from leak.extras import command

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


# What the optional package CoolProp calls the entries that it has, too.
_COOLPROP = MappingProxyType(
    {
        "water": "Water",
        "ethanol": "Ethanol",
        "helium": "Helium",
        "hydrogen": "Hydrogen",
        "nitrogen": "Nitrogen",
        "oxygen": "Oxygen",
        "argon": "Argon",
        "air": "Air",
        "methane": "Methane",
        "carbon dioxide": "CarbonDioxide",
    }
)


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
    found = _COOLPROP.get(name)
    return None if found is None else f"CoolProp:{found}"


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
