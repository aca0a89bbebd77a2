"""Columns of a text table that are found by their names and read in the units of their headers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from fem_seal.errors import QuantityError
from fem_seal.text_table import TextTable, TextTableError
from fem_seal.units import parse_quantity

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# What a column may be called, and its dimension: one of `fem_seal.units.DIMENSIONS`, or "strain".
Names = Mapping[str, tuple[str, tuple[str, ...]]]

# A strain is a plain number unless its header says otherwise.
_STRAINS = {"": 1.0, "-": 1.0, "1": 1.0, "%": 0.01, "percent": 0.01}


def find_columns(table: TextTable, names: Names, example: str) -> dict[str, int]:
    """Place of each known column in a table.

    Parameters
    ----------
    table : TextTable
    names : mapping
        For each role the dimension and the names that a column may have.
    example : str
        A header that would do, for the message where there is none.

    Raises
    ------
    TextTableError
        If the table has no header, or one of another length than its rows.
    """
    if not table.header:
        raise TextTableError(f"has no header; name the columns and their units, {example}")
    if len(table.header) != table.values.shape[1]:
        raise TextTableError(
            f"has {len(table.header)} column names over {table.values.shape[1]} columns; name every column, and write "
            "numbers with a decimal point, not a comma"
        )
    words = [name_and_unit(header)[0] for header in table.header]
    places = {
        role: next((n for n, word in enumerate(words) if word in known), None)
        for role, (_, known) in names.items()
    }
    return {role: place for role, place in places.items() if place is not None}


def column(table: TextTable, place: int, dimension: str) -> NDArray[np.float64]:
    """Column of a table in SI.

    Raises
    ------
    TextTableError
        If its header has no unit of this dimension.
    """
    header, values = table.header[place], table.values[:, place]
    unit = name_and_unit(header)[1]
    if dimension == "strain":
        if unit.lower() not in _STRAINS:
            raise TextTableError(
                f'column "{header}": unit "{unit}" does not fit a strain; write a plain number without unit, 0.1, or '
                "per cent, [%]"
            )
        return values * _STRAINS[unit.lower()]
    if not unit:
        example = "mm" if dimension == "length" else "MPa"
        raise TextTableError(
            f'column "{header}" has no unit; write it as "{header}_{example}" or "{header} [{example}]"'
        )
    try:
        return values * parse_quantity(f"1 {unit}", dimension)
    except QuantityError as error:
        raise TextTableError(f'column "{header}": {error}') from None


def name_and_unit(header: str) -> tuple[str, str]:
    """``"x_m"``, ``"x [mm]"``, ``"Contact pressure (MPa)"`` as word and unit; unit empty if there is none."""
    bracketed = re.fullmatch(r"(.*?)[\s_]*[\[(]\s*([^\])]+?)\s*[\])]", header)
    suffixed = re.fullmatch(r"(.+)[\s_]([^\s_]+)", header)
    for match in (bracketed, suffixed):
        if match and (match is bracketed or _is_unit(match[2])):
            return re.sub(r"\s+", "_", match[1].lower()), match[2]
    return re.sub(r"\s+", "_", header.lower()), ""


def _is_unit(text: str) -> bool:
    if text.lower() in ("%", "percent"):
        return True
    for dimension in ("length", "pressure"):
        try:
            parse_quantity(f"1 {text}", dimension)
        except QuantityError:
            continue
        return True
    return False
