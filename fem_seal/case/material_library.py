"""Library of materials: properties with source and condition from templates/materials.toml, and their aliases."""

from __future__ import annotations

import difflib
import math
import re
from types import MappingProxyType
from typing import Any, NamedTuple

from fem_seal.errors import InputError
from fem_seal.files import own_tables
from fem_seal.materials import ROOM_TEMPERATURE, HardeningCurve, Material, OverTemperature, in_degrees

# Half the angle between opposite faces of the Vickers pyramid, 136 degrees.
_VICKERS_HALF_ANGLE = math.radians(68)
_STANDARD_GRAVITY = 9.80665
_ROOM = ROOM_TEMPERATURE - 273.15


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


class LibraryCurve(NamedTuple):
    """A stress-strain curve of the library, at 20 degC.

    Parameters
    ----------
    hardening : HardeningCurve
    source : str
    """

    hardening: HardeningCurve
    source: str


def _read() -> tuple[dict[str, Material], dict[str, LibraryCurve], dict[str, str]]:
    tables = dict(own_tables("materials.toml"))
    sources, aliases = tables.pop("sources"), tables.pop("aliases")
    found = {name: _material(name, entry, sources) for name, entry in tables.items()}
    curves = {name: _curve(entry["curve"], sources) for name, entry in tables.items() if "curve" in entry}
    return found, curves, aliases


def _curve(entry: dict[str, Any], sources: dict[str, str]) -> LibraryCurve:
    stress = tuple(float(f"{one}e6") for one in entry["stress"])
    return LibraryCurve(HardeningCurve(tuple(entry["strain"]), stress), entry["source"].format(**sources))


# Number of a material -> its key in the file, the power of ten of its unit there, what it is called among the sources.
_KEYS = {
    "youngs_modulus": ("E", 9, "E"),
    "hardness": ("hardness", 9, "hardness"),
    "yield_stress": ("yield", 6, "yield strength"),
    "thermal_expansion": ("expansion", -6, "expansion"),
    "thermal_conductivity": ("conductivity", 0, "conductivity"),
}
# Up to where a mean expansion from 20 degC on holds unless its entry says [degC].
_EXPANSION_TO = 100


def _material(name: str, entry: dict[str, Any], sources: dict[str, str]) -> Material:
    tables = tuple(table for key in _KEYS if (table := _over_temperature(key, entry, sources)) is not None)
    beside = [f"{_KEYS[table.key][2]}: {table.source}" for table in tables if table.source]
    source = entry["source"].format(**sources)
    return Material(
        name,
        poissons_ratio=entry["nu"],
        source=f"{source}. Over temperature: {'; '.join(beside)}" if beside else source,
        condition=entry["condition"],
        creeps=entry.get("creeps", False),
        over_temperature=tables,
        **{table.key: table.value[0] for table in tables},  # type: ignore[arg-type]
    )


def _over_temperature(key: str, entry: dict[str, Any], sources: dict[str, str]) -> OverTemperature | None:
    """What the file says of a number: from 20 degC on, where its first value holds; None if nothing."""
    word, exponent, _ = _KEYS[key]
    table = entry.get("over", {}).get(word, {})
    # of the decimal fraction the float beside it: 129.8 * 1e9 is another one
    warm = [float(f"{one}e{exponent}") for one in table.get("value", ())]
    if key == "hardness" and "HV" in entry:
        # three digits: no hardness is known better
        first = float(f"{vickers_pressure(entry['HV']):.3g}")
    elif word in entry:
        first = float(f"{entry[word]}e{exponent}")
    elif warm:
        first = warm[0]
    else:
        return None
    if table.get("scaled"):
        warm = [float(f"{first * one / warm[0]:.6g}") for one in warm]
    at = [float(one) for one in table.get("C", ())]
    if key == "thermal_expansion" and not at:
        at, warm = [float(entry.get("expansion_to", _EXPANSION_TO))], [first]
    if not at or at[0] > _ROOM:
        at, warm = [_ROOM, *at], [first, *warm]
    return OverTemperature(
        key,
        (ROOM_TEMPERATURE, *(round(one + 273.15, 6) for one in at[1:])),
        (first, *warm[1:]),
        nearest=True,
        source=table.get("source", "").format(**sources),
    )


def suggestion(name: str, key: str, unit: str) -> str:
    """What to write for a number that a case needs and does not have.

    Parameters
    ----------
    name : str
        Of the material, as the case has it.
    key : str
        Of the number.
    unit : str

    Examples
    --------
    >>> suggestion("AISI 316L", "thermal_conductivity", "W/(m K)")
    'give it, in W/(m K); the library has "14.3 W/(m K)" for 316L at 20 degC'
    >>> suggestion("my steel", "thermal_conductivity", "W/(m K)")
    'give it, in W/(m K), from the data sheet of the material'
    """
    known = library_name(name)
    number = None if known is None else getattr(LIBRARY[known], key)
    if number is None:
        return f"give it, in {unit}, from the data sheet of the material"
    return f'give it, in {unit}; the library has "{number:.4g} {unit}" for {known} at {in_degrees(ROOM_TEMPERATURE)}'


_MATERIALS, _CURVES, _ALIASES = _read()

LIBRARY = MappingProxyType(_MATERIALS)
"""Name -> material, read-only."""

CURVES = MappingProxyType(_CURVES)
"""Name in `LIBRARY` -> its stress-strain curve, of those that have one; read-only."""

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
        raise InputError.at("material", f"not in the library; {hint}known are {listed}", repr(name))
    return LIBRARY[known]


def library_curve(name: str) -> LibraryCurve:
    """Stress-strain curve of a material of the library.

    Parameters
    ----------
    name : str
        See `material`.

    Raises
    ------
    InputError
        If the library has none of it; the message names those that have one.

    Examples
    --------
    >>> library_curve("1.4404").hardening.yield_stress / 1e6
    200.0
    """
    found = CURVES.get(library_name(name) or "")
    if found is None:
        listed = ", ".join(f'"{one}"' for one in CURVES)
        raise InputError.at(
            "stress_strain",
            f"the library has no curve of {name or 'a material without a name'}, only of {listed}; write one out, "
            'such as { plastic_strain = [0, 0.1], stress = ["250 MPa", "350 MPa"] }',
            '"library"',
        )
    return found
