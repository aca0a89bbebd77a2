"""Stress-strain tables from a text file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.named_columns import column, find_columns
from fem_seal.text_table import TextTableError, read_text_table

if TYPE_CHECKING:
    from fem_seal.named_columns import Names
    from fem_seal.text_table import TextTable

_NAMES: Names = {
    "strain": ("strain", ("strain", "total_strain", "true_strain", "epsilon")),
    "plastic_strain": ("strain", ("plastic_strain", "true_plastic_strain", "epsilon_p", "ep")),
    "stress": ("pressure", ("stress", "true_stress", "flow_stress", "sigma")),
}


def read_stress_strain(file: str | Path) -> tuple[str, tuple[float, ...], tuple[float, ...]]:
    """Strain and stress of a table.

    Parameters
    ----------
    file : path
        Text with a header and the columns ``plastic_strain`` or ``strain`` (elastic and plastic together), true, as
        numbers or in ``[%]``, and ``stress_MPa``, true.

    Returns
    -------
    kind : {"plastic_strain", "strain"}
    strain, stress : tuple of float
        [-], [Pa].

    Raises
    ------
    TextTableError
        If the file is not such a table; the message names it.
    """
    try:
        return _read(read_text_table(file))
    except TextTableError as error:
        raise TextTableError(f"{file} {error}") from None


def _read(table: TextTable) -> tuple[str, tuple[float, ...], tuple[float, ...]]:
    places = find_columns(table, _NAMES, 'such as "plastic_strain, stress_MPa"')
    kinds = [kind for kind in ("plastic_strain", "strain") if kind in places]
    if len(kinds) != 1 or "stress" not in places:
        raise TextTableError(
            "must have a column stress with its unit and either a column plastic_strain or a column strain; its "
            f"columns are {', '.join(table.header)}"
        )
    strain, stress = (column(table, places[role], _NAMES[role][0]) for role in (kinds[0], "stress"))
    return kinds[0], tuple(strain.tolist()), tuple(stress.tolist())
