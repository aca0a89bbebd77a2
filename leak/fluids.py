"""Liquids with sourced properties."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from types import MappingProxyType

from leak.errors import FluidError, positive


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


_ISO_VG = (
    "ISO 3448: kinematic viscosity at the midpoint of the class, at 40 C; density of a typical mineral oil, "
    "870 kg/m^3 at 15 C less 0.65 kg/m^3 per kelvin"
)
_CRC = "CRC Handbook of Chemistry and Physics, 97th ed., viscosity and density of liquids"

_LIQUIDS = (
    Liquid(
        "water",
        1.0016e-3,
        998.21,
        293.15,
        "IAPWS R12-08 (viscosity) and IAPWS-95 (density), 20 C, 0.1 MPa; "
        "Fischer et al., 'Fluid leakage in metallic seals', use 1 mPa s",
    ),
    Liquid("ethanol", 1.074e-3, 785.0, 298.15, f"{_CRC}, 25 C"),
    Liquid("ethylene glycol", 16.1e-3, 1110.0, 298.15, f"{_CRC}, 25 C"),
    Liquid("hydraulic oil ISO VG 32", 32e-6 * 853.75, 853.75, 313.15, _ISO_VG),
    Liquid("hydraulic oil ISO VG 46", 46e-6 * 853.75, 853.75, 313.15, _ISO_VG),
)

FLUIDS = MappingProxyType({entry.name: entry for entry in _LIQUIDS})
"""The library: name -> Liquid, read-only."""


def liquid(name: str) -> Liquid:
    """Liquid of that name from the library `FLUIDS`.

    Raises
    ------
    FluidError
        No such name; the message names the nearest ones.

    Examples
    --------
    >>> liquid("water").viscosity
    0.0010016
    """
    key = str(name).strip().lower()
    for known, entry in FLUIDS.items():
        if known.lower() == key:
            return entry
    close = get_close_matches(key, [known.lower() for known in FLUIDS], n=2)
    hint = f" - did you mean {' or '.join(close)}?" if close else ""
    raise FluidError(f"fluid = {name!r}: must be one of {', '.join(FLUIDS)}{hint}")
