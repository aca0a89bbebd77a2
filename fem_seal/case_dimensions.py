"""The dimensions of both bodies with what was sized from the problem in place of what the case leaves open."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fem_seal.case import Case

# Lengths that are no dimensions of the body.
_NOT_A_DIMENSION = ("interference", "tolerance")


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
