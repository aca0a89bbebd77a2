"""What is told about a body with an outline of its own: the file that it comes from, and how far it reaches."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.case_profiles import ProfileSource
from fem_seal.readable import given, trimmed, unit_for

if TYPE_CHECKING:
    from fem_seal.case import Case


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


def in_words(section: Mapping[str, Any]) -> dict[str, str]:
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
