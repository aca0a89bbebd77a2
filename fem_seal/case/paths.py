"""Entries of a case by their path, such as ``seat.angle``: what may stand there, and how it is written."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from fem_seal.case.case import Case
from fem_seal.case.fields import Number, Quantity, Table, show, values_of
from fem_seal.case.material_table import MaterialTable, as_table, fill_from_library, library_table
from fem_seal.case.messages import gone_entry
from fem_seal.case.notation import same_entry, tables_of, words_of
from fem_seal.errors import InputError
from fem_seal.materials import Material
from fem_seal.units import DIMENSIONS, Display, Unit, kind_of

Value = float | str | bool

# Tables of a case that say nothing about the seal.
_FIXED_TABLES = ("title", "output", "uncertainty")
# What people give in a unit that suits its size, and a case file reads it back.
_SCALED_KINDS = ("length", "contact pressure", "fluid pressure", "force", "viscosity")
# Entries that decide which others there are, or that hold more than one value.
_NO_VALUE = ("shape", "kind", "outline", "stress_strain", "files", "tolerance_waves")


@dataclass(frozen=True)
class Entry:
    """One place in a case file.

    Parameters
    ----------
    path : str
        Dotted key.
    marker : Quantity, Number or None
        What reads and bounds it; None for words, names and files.
    truth : bool
        Whether it is true or false.
    display : Display
        Units in which people are shown its values.
    """

    path: str
    marker: Quantity | Number | None
    truth: bool = False
    display: Display = field(default_factory=Display, kw_only=True)

    @property
    def unit(self) -> str:
        """SI unit, empty for numbers and words."""
        return DIMENSIONS[self.marker.dimension].si_unit if isinstance(self.marker, Quantity) else ""

    @property
    def numeric(self) -> bool:
        """Whether its values can be ordered and drawn from a distribution."""
        return self.marker is not None

    def read(self, value: object) -> Value:
        """Value in SI of what a user wrote; ValueError if it may not stand here."""
        if self.marker is not None:
            return self.marker.read(value)
        if isinstance(value, (str, bool)) and isinstance(value, bool) == self.truth:
            return value
        raise ValueError("must be true or false" if self.truth else "must be a text in quotes")

    def check(self, value: float) -> None:
        """ValueError if an SI value is outside the range of the entry."""
        self.read(self.write(value))

    def write(self, value: Value) -> object:
        """The value as it is written in a case file; `read` gives exactly the same value back."""
        if isinstance(self.marker, Quantity):
            return f"{value!r} {self.unit}"
        return value

    def show(self, value: Value) -> str:
        """The value for people."""
        if not isinstance(self.marker, Quantity) or not isinstance(value, float):
            return show(value)
        unit = self._usual_unit(value)
        return f'"{unit.of(value):.6g} {unit.name}"'

    def _usual_unit(self, value: float) -> Unit:
        """Unit in which people write a value of this entry."""
        if self.unit == "rad":
            return self.display.fixed_unit("deg")
        kind = kind_of(self.path, self.unit)
        return self.display.unit_for(kind, value) if kind in _SCALED_KINDS else Unit(self.unit, 1.0)


def entry_at(case: Case, path: str) -> Entry:
    """The entry of a case at a path.

    Parameters
    ----------
    case : Case
        Decides which tables stand where: the kind of spectrum, the shape of the seat.
    path : str

    Raises
    ------
    InputError
        If there is no such entry; it names the nearest ones.
    """
    *parents, key = path.split(".")
    if key in _NO_VALUE:
        raise InputError.at(path, "is the same in all designs of a study; make one study for each")
    table: object = case
    for parent in parents:
        table = _inside(table, parent)
    fields, words = _fields(table), words_of(type(table)) if isinstance(table, Table) else {}
    all_paths = list(entry_paths(case))
    if key in words and same_entry(path) in all_paths:
        return Entry(path, words[key].marker, display=case.display)
    if key not in fields or path.split(".")[0] in _FIXED_TABLES or path not in all_paths:
        in_words = [f"{'.'.join(parents)}.{word}" for word in words]
        alike = [entry_path for entry_path in all_paths if entry_path.lower() == path.lower()]
        likely = difflib.get_close_matches(path, [*all_paths, *in_words], n=2, cutoff=0.5)
        ends_alike = [entry_path for entry_path in all_paths if entry_path.split(".")[-1] == key]
        hints = alike or list(dict.fromkeys([*ends_alike[:2], *likely]))[:3]
        suggestion = f"do you mean {' or '.join(hints)}? " if hints else ""
        unknown = f"is no entry of the case; {suggestion}known are {', '.join(all_paths)}"
        raise InputError.at(path, gone_entry(path) or unknown)
    # a design has one load
    return Entry(
        path, next(values_of(fields[key]), None), truth=fields[key].annotation is bool, display=case.display
    )


def _inside(table: object, key: str) -> object:
    """What stands at a key of a table, or in a list of tables at a number."""
    if isinstance(table, tuple):
        return table[int(key)] if key.isdecimal() and int(key) < len(table) else None
    return getattr(table, key, None) if key in _fields(table) else None


# A finish in words, "lapped Ra 0.2 um", is one value that changes them as a whole.
_FINISHES = ("roughness", "roughness.seat", "roughness.closure", "roughness.gasket")


def entry_paths(case: Case) -> Iterator[str]:
    """Paths of all entries of a case that a study can vary."""
    yield from _FINISHES if case.roughness is not None else _FINISHES[:1]
    for name in _fields(case):
        if name not in _FIXED_TABLES:
            yield from _paths_below(name, getattr(case, name), _fields(case)[name])


def with_open_materials(case: Case, paths: list[str]) -> Case:
    """The case with library materials written as tables, where a path changes a part of one."""
    changes = {}
    for body in ("closure", case.key_of("seat")):
        if any(path.startswith(f"{body}.material.") for path in paths):
            entry, material = case.written[body]["material"], getattr(case, body).material
            if isinstance(entry, str):
                changes[f"{body}.material"] = library_table(entry)
            elif isinstance(entry, dict):
                changes[f"{body}.material"] = fill_from_library(entry)
            elif material.hardening is None and not material.over_temperature:
                changes[f"{body}.material"] = as_table(material)
    return case.replace_written(changes) if changes else case


def _paths_below(path: str, value: object, field: Any) -> Iterator[str]:
    if isinstance(value, tuple) and any(_fields(item) for item in value):
        for number, item in enumerate(value):
            yield from _paths_below(f"{path}.{number}", item, field)
        return
    fields = _fields(value)
    if not fields:
        # where a table would stand there has to be one in the base case
        if not tables_of(field):
            yield path
        return
    if isinstance(value, Material):
        # a name from the library may be varied as a whole
        yield path
    for name, subfield in fields.items():
        if name not in _NO_VALUE:
            yield from _paths_below(f"{path}.{name}", getattr(value, name), subfield)


def _fields(table: object) -> dict[str, Any]:
    if isinstance(table, Material):
        # without tables below, which a material keeps in another form
        return {name: field for name, field in MaterialTable.model_fields.items() if hasattr(table, name)}
    model: type[BaseModel] = type(table)  # type: ignore[assignment]
    return dict(getattr(model, "model_fields", {}))
