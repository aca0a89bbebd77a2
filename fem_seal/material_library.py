"""Materials by their name: numbers with source and condition from templates/materials.toml, and words for them."""

from __future__ import annotations

import difflib
import math
import re
import tomllib
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from fem_seal.errors import InputError, Problem
from fem_seal.materials import Material

# Half the angle between opposite faces of the Vickers pyramid, 136 degrees.
_VICKERS_HALF_ANGLE = math.radians(68)
_STANDARD_GRAVITY = 9.80665


def vickers_pressure(vickers: float) -> float:
    """Penetration hardness of a Vickers hardness [Pa], the mean pressure on the projected area of the indent.

    HV is the load in kgf over the area of the facets in mm^2, which is larger than the projected area by 1/sin 68
    degrees = 1/0.927: H = HV 9.80665 MPa/0.927.

    Parameters
    ----------
    vickers : float
        HV.

    References
    ----------
    ISO 6507-1 (definition of HV); Tabor, The Hardness of Metals (1951).

    Examples
    --------
    >>> import fem_seal
    >>> f"{fem_seal.vickers_pressure(331) / 1e9:.2f} GPa"
    '3.50 GPa'
    """
    return vickers * _STANDARD_GRAVITY * 1e6 / math.sin(_VICKERS_HALF_ANGLE)


# In front of a name, what says no more than which list it is from.
_LISTS = re.compile(r"^(aisi|astm|sae|din|en|uns|jis|wnr|werkstoff|grade|alloy|material)")


def _key(name: str) -> str:
    """What is compared of a name: letters and digits only, small, without the list it is from."""
    plain = re.sub(r"[^a-z0-9]", "", name.casefold())
    while (shorter := _LISTS.sub("", plain)) not in (plain, ""):
        plain = shorter
    return plain


def _read() -> tuple[dict[str, Material], dict[str, str]]:
    text = files("fem_seal").joinpath("templates", "materials.toml").read_text(encoding="utf-8")
    tables: dict[str, Any] = tomllib.loads(text)
    sources, aliases = tables.pop("sources"), tables.pop("aliases")
    return {name: _material(name, entry, sources) for name, entry in tables.items()}, aliases


def _material(name: str, entry: dict[str, Any], sources: dict[str, str]) -> Material:
    def si(key: str, exponent: int) -> float | None:
        # of the decimal fraction the float beside it: 129.8 * 1e9 is another one
        return float(f"{entry[key]}e{exponent}") if key in entry else None

    # three digits: no hardness is known better
    hardness = float(f"{vickers_pressure(entry['HV']):.3g}") if "HV" in entry else si("hardness", 9)
    return Material(
        name,
        youngs_modulus=float(f"{entry['E']}e9"),
        poissons_ratio=entry["nu"],
        hardness=hardness,
        yield_stress=si("yield", 6),
        source=entry["source"].format(**sources),
        thermal_expansion=si("expansion", -6),
        condition=entry["condition"],
        creeps=entry.get("creeps", False),
    )


_MATERIALS, _ALIASES = _read()

LIBRARY = MappingProxyType(_MATERIALS)
"""Name -> material, read-only."""

ALIASES = MappingProxyType(_ALIASES)
"""Other word -> name in `LIBRARY`, read-only."""

_KNOWN = {_key(word): name for word, name in (*ALIASES.items(), *((name, name) for name in LIBRARY))}


def library_name(name: str) -> str | None:
    """Name in `LIBRARY` of the material that is meant, None if none is.

    Parameters
    ----------
    name : str
        Capitals, spaces and signs do not count.

    Examples
    --------
    >>> library_name("AISI 316L"), library_name("1.4404"), library_name("unobtainium")
    ('316L', '316L', None)
    """
    return _KNOWN.get(_key(name))


def similar_names(name: str) -> list[str]:
    """Names in `LIBRARY` that are spelled like one that it does not have, the nearest first; three at most.

    Parameters
    ----------
    name : str

    Examples
    --------
    >>> similar_names("stelite")
    ['stellite 6']
    """
    key = _key(name)
    near = difflib.get_close_matches(key, _KNOWN, n=6, cutoff=0.76)
    inside = [known for known in _KNOWN if len(key) > 3 and key in known]
    return list(dict.fromkeys(_KNOWN[known] for known in (*near, *inside)))[:3]


def material(name: str) -> Material:
    """Material of the library.

    Parameters
    ----------
    name : str
        A name of `LIBRARY`, for example "steel", or another word for one ("1.4404", "AISI 316L"); capitals do not
        count.

    Raises
    ------
    InputError
        If the library does not have it; the message names the nearest ones.

    Examples
    --------
    >>> import fem_seal
    >>> seat = fem_seal.material("Stellite 6")
    >>> print(f"{seat.youngs_modulus / 1e9:.0f} GPa, {seat.hardness / 1e9:.1f} GPa: {seat.condition[:4]}")
    209 GPa, 4.6 GPa: cast
    """
    known = library_name(name)
    if known is None:
        near = similar_names(name)
        hint = f"do you mean {' or '.join(repr(one) for one in near)}? ".replace("'", '"') if near else ""
        listed = ", ".join(f'"{one}"' for one in LIBRARY)
        raise InputError(Problem("material", f"not in the library; {hint}known are {listed}", repr(name)))
    return LIBRARY[known]
