"""Bare SI numbers from Python code, given their unit before validation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from fem_seal.case.drawing_words import words_of
from fem_seal.case.fields import quantities_of
from fem_seal.case.messages import choices, tables_of
from fem_seal.units import DIMENSIONS


def with_units(table: type[BaseModel], entries: Mapping[str, Any]) -> dict[str, Any]:
    """Entries of a table as a case file has them: a bare number where a quantity stands gets its SI unit.

    Everything else stays as it is; what is wrong is for the reading of the table to say.

    Parameters
    ----------
    table : type of a table of the case
    entries : mapping
        From keys to what stands there: texts, numbers, lists or tables.

    Examples
    --------
    >>> from fem_seal.case.tables import Load
    >>> with_units(Load, {"fluid_pressure": [1e5, "20 bar"], "closing": "penetration"})
    {'fluid_pressure': ['100000.0 Pa', '20 bar'], 'closing': 'penetration'}
    """
    fields, words = table.model_fields, words_of(table)
    return {
        key: _written(value, DIMENSIONS[words[key].marker.dimension].si_unit)
        if key in words
        else _entry_with_units(fields[key], value)
        if key in fields
        else value
        for key, value in entries.items()
    }


def _entry_with_units(field: FieldInfo, value: Any) -> Any:
    quantity = next(quantities_of(field), None)
    if quantity is not None:
        return _written(value, DIMENSIONS[quantity.dimension].si_unit)
    if isinstance(value, (list, tuple)):
        return [_entry_with_units(field, one) for one in value]
    if isinstance(value, Mapping):
        fitting = [table for table in tables_of(field) if _is_meant(table, value)]
        # a kind that is not written is known by the keys that go with it
        fitting.sort(key=lambda table: len(set(value) - set(table.model_fields)))
        return with_units(fitting[0], value) if fitting else value
    return value


def _is_meant(table: type[BaseModel], entries: Mapping[str, Any]) -> bool:
    """Whether `shape` or `kind` of the entries is that of the table."""
    return all(
        entries[key] in choices(table, key)
        for key in ("shape", "kind")
        if key in entries and key in table.model_fields
    )


def _written(value: Any, unit: str) -> Any:
    if isinstance(value, bool):
        return value
    if isinstance(value, float) or (isinstance(value, int) and abs(value) < 10**300):
        return f"{float(value)!r} {unit}"
    if hasattr(value, "tolist"):  # an array, or a number out of one
        return _written(value.tolist(), unit)
    if isinstance(value, (list, tuple)):
        return [_written(one, unit) for one in value]
    if isinstance(value, Mapping):  # a range
        return {key: _written(one, unit) if key in ("start", "stop") else one for key, one in value.items()}
    return value
