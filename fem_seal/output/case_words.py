"""Dimensions and sections of a case in words."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.case.drawing_words import words_of
from fem_seal.case.drawn import ProfileSource
from fem_seal.units import given, trimmed, unit_for

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.case.fields import Table
    from fem_seal.case.tables import Load

BODIES = ("closure", "seat")
# Lengths that are no dimensions of the body.
_NOT_A_DIMENSION = ("interference", "tolerance")


def law_word(case: Case) -> str:
    """The case's interface law, by the word that its sentences have in words.toml.

    Parameters
    ----------
    case : Case
    """
    law = case.interface.law
    return "corrected" if law == "spectrum" and case.leak.theory == "corrected" else law


def dimensions(case: Case, name: str) -> dict[str, float]:
    """Dimensions of a body by key.

    Parameters
    ----------
    case : Case
    name : str
        "closure" or "seat".

    Returns
    -------
    dict
        Lengths [m] and angles [rad]. Keys of the case that do not apply, such as the cavity of a solid ball, are left
        out.
    """
    given = {
        key: entry
        for key, entry in getattr(case, name)
        if isinstance(entry, float) and key not in _NOT_A_DIMENSION
    }
    return given | chosen_dimensions(case, name)


def listed_dimensions(case: Case, name: str) -> dict[str, tuple[float, bool]]:
    """The `dimensions` in the words of the case, for people.

    Radii are diameters where the case writes diameters; the angle of a cone is followed by its included angle.

    Parameters
    ----------
    case : Case
    name : str
        "closure" or "seat".

    Returns
    -------
    dict
        By key or word: length [m] or angle [rad], and whether it was left open by the case.
    """
    table: type[Table] = type(getattr(case, name))
    words = {word.key: word for word in words_of(table).values()}
    chosen, listed = chosen_dimensions(case, name), {}
    for key, value in dimensions(case, name).items():
        word = words.get(key)
        in_diameters = word is not None and word.marker.dimension == "length" and case.in_diameters(name)
        if word is None or not in_diameters:
            listed[key] = value, key in chosen
        if word is not None and (in_diameters or word.marker.dimension == "angle"):
            listed[word.name] = word.of_key(value), key in chosen
    return listed


def chosen_dimensions(case: Case, name: str) -> dict[str, float]:
    """Those of the `dimensions` that the case leaves open."""
    table = getattr(case, name)
    body = case.bodies[0 if name == "closure" else 1]
    values = {key: getattr(body, key, None) for key, entry in table if entry is None}
    return {
        key: float(value)
        for key, value in values.items()
        if isinstance(value, (int, float)) and value and key not in _NOT_A_DIMENSION
    }


def earlier_load(load: Load) -> str:
    """The largest load before all others in words: "a load of 2 kN", or empty where none is given."""
    if load.largest_earlier_force is not None:
        return f"a load of {given('force', load.largest_earlier_force)}"
    if load.largest_earlier_pressure is not None:
        return f"a load of {given('fluid pressure', load.largest_earlier_pressure)}"
    return ""


def section(case: Case, name: str) -> dict[str, Any]:
    """Source and extent of a body of shape "profile" in SI, empty for the other shapes.

    Parameters
    ----------
    case : Case
    name : str
        "closure" or "seat".

    Returns
    -------
    dict
        "file" and "layer", None where there is none; "length_unit_m", a unit of the file, None for an outline in the
        case and for STEP; "r_m" and "z_m", smallest and largest coordinate as drawn.
    """
    table = getattr(case, name)
    if not isinstance(table, ProfileSource):
        return {}
    body = case.bodies[0 if name == "closure" else 1]
    r, z = body.outline.extent
    return {
        "file": Path(table.file).name if table.file else None,
        "layer": table.layer,
        "length_unit_m": getattr(body, "file_unit", None),
        "r_m": r,
        "z_m": z,
    }


def section_text(section: Mapping[str, Any]) -> dict[str, str]:
    """A `section` for people: its source, if it is a file, and its extent."""
    words = {}
    if section["file"]:
        layer, unit = section["layer"], section["length_unit_m"]
        words["file"] = ", ".join(
            [
                section["file"],
                *([f"layer {layer}"] if layer else []),
                *([f"unit {given('length', unit)}"] if unit else []),
            ]
        )
    unit = unit_for("length", section["r_m"][1])
    words["extent"] = ", ".join(
        f"{c} {trimmed(unit.of(low))} to {trimmed(unit.of(high))} {unit.name}"
        for c, (low, high) in (("r", section["r_m"]), ("z", section["z_m"]))
    )
    return words
