"""The case: everything that one calculation needs, read from a TOML file or made in code."""

from __future__ import annotations

import copy
import json
import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, is_dataclass, replace
from html import escape
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel, PrivateAttr, ValidationError
from pydantic.fields import FieldInfo

from fem_seal.case import shapes
from fem_seal.case.checks import contradictions, of_unlike_flanges
from fem_seal.case.fields import quantities_of
from fem_seal.case.material_table import as_table, library_table
from fem_seal.case.messages import missing_key, problems
from fem_seal.case.notation import (
    as_differences,
    as_gauge,
    as_written,
    choices,
    in_keys,
    partner,
    said_twice,
    same_entry,
    tables_of,
    words_of,
)
from fem_seal.case.roughness import FinishTable, roughness_like
from fem_seal.case.tables import CaseTables, Uncertainty
from fem_seal.case.temperature import with_film_temperature
from fem_seal.case.tightening import apply_preloads
from fem_seal.errors import InputError, NoLoadLeftError, Problem
from fem_seal.files import problem, read_toml, write_text
from fem_seal.materials import ROOM_TEMPERATURE, Material
from fem_seal.units import DIMENSIONS
from meshes import ContactGeometry, GeometryError, Shape

# Key of a problem with the upper flange, its face, or both bodies: in the lower half that is the lower flange.
_LOWER = re.compile(r"^(roughness\.|)(?:closure(?=\.|$)|gasket$)")
# What stands for the shapes of bodies that have none, of which nothing but the material counts; see `Case.over_ring`.
_RING: dict[str, dict[str, str]] = {
    "closure": {"shape": "disc", "radius": "30 mm"},
    "seat": {"shape": "flat-land", "land_inner_radius": "10 mm", "land_outer_radius": "15 mm"},
}
# Tables that are quickly read, and depend on others: temperature, outlet of the fluid, bolts, circle of first touch.
_DEPENDENT_TABLES = {"fluid", "load", "requirement"}
# What completion offers besides the tables.
_NAMES = {"contact", "effective_modulus", "file", "hardness", "initial_contact_radius", "replace", "written"}


@dataclass(frozen=True)
class CaseBody:
    """A body of a case.

    Parameters
    ----------
    case : Case
        In whose contact it is.
    name : str
        "closure" or "seat" there.
    """

    case: Case
    name: str

    @property
    def label(self) -> str:
        """What it is called."""
        return self.case.label_of(self.name)

    @property
    def key(self) -> str:
        """Name of its table in the case file."""
        return "seat" if self.label == "lower flange" else self.case.key_of(self.name)

    @property
    def table(self) -> shapes.Closure | shapes.HeldSeat | shapes.Gasket:
        """What stands there."""
        return self.case.table_of(self.name)

    @property
    def shape(self) -> Shape:
        """With all its dimensions."""
        return dict(zip(("closure", "seat"), self.case.bodies, strict=True))[self.name]


class Case(CaseTables):
    """One seal with its loads. All numbers are SI floats; angles are in radian.

    Built from the tables of the case file; quantities are texts with a unit, as there, or numbers in SI. ``str(case)``
    is the case file.

    >>> case = Case(
    ...     closure=dict(shape="ball", radius=0.02, material="steel"),
    ...     seat=dict(shape="cone", angle="45 deg", material="steel"),
    ...     interface=dict(law="smooth"),
    ...     load=dict(fluid_pressure=["1 bar", 20e5]),
    ... )
    >>> case.load.fluid_pressure
    (100000.0, 2000000.0)
    >>> round(case.replace({"seat.angle": "60 deg"}).initial_contact_radius, 6)
    0.017321
    >>> print(case)
    [closure]
    shape = "ball"
    radius = "0.02 m"
    material = "steel"
    <BLANKLINE>
    [seat]
    shape = "cone"
    angle = "45 deg"
    material = "steel"
    <BLANKLINE>
    [interface]
    law = "smooth"
    <BLANKLINE>
    [load]
    fluid_pressure = ["1 bar", "2000000.0 Pa"]
    <BLANKLINE>

    Raises
    ------
    InputError
        If anything is wrong; it lists every problem.
    """

    _input: dict[str, Any] = PrivateAttr(default_factory=dict)
    _lower_half: Case | None = PrivateAttr(default=None)

    def __init__(self, /, **tables: Any) -> None:
        self._read_tables(_tables_with_units(tables, of_gasket=tables.get("gasket") is not None))

    def _read_tables(self, tables: dict[str, Any]) -> None:
        self._read(tables, None)
        self._input = copy.deepcopy(tables)

    def __str__(self) -> str:
        folder = Path.cwd() if self._file is None else self._file.absolute().parent
        return case_text(self._input, folder)

    def __repr__(self) -> str:
        pairs = len(self.load.points)
        return f"<Case {self.title or 'without title'}: {pairs} load{'' if pairs == 1 else 's'}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the case file."""
        return f"<pre>{escape(str(self))}</pre>"

    def __dir__(self) -> list[str]:
        return sorted(CaseTables.model_fields.keys() | _NAMES)

    def _read(self, tables: dict[str, Any], like: Case | None) -> None:
        """Read and check tables; those that are the very ones of another case are taken from it as they were read."""
        old_tables = {} if like is None else like._input
        same = {name for name, table in tables.items() if name in old_tables and old_tables[name] is table}
        same -= _DEPENDENT_TABLES
        of_gasket = tables.get("gasket") is not None
        if of_gasket:
            # [seat] is then the lower flange, and no seat; its face stands in [roughness]
            same -= {"seat", "roughness"}
        new, wrong = _in_keys({name: table for name, table in tables.items() if name not in same})
        new, fluid_problems = as_differences(new, tables.get("fluid"))
        wrong += fluid_problems
        bolts, load = tables.get("bolts"), tables.get("load")
        if bolts is not None and isinstance(load, Mapping) and load.get("applied_force") is not None:
            wrong.append(problem("bolts_and_force"))
        if of_gasket:
            # a table of its own is that of another face, see `_lower_half`
            new.pop("seat", None)
            if isinstance(rough := new.get("roughness"), Mapping) and {"closure", "seat"} <= rough.keys():
                new["roughness"] = {key: finish for key, finish in rough.items() if key != "seat"}
        if not of_gasket and tables.get("seat") is None:
            wrong.append(missing_key(CaseTables, "seat"))
        is_bare = not of_gasket and all(_is_bare(tables.get(name)) for name in _RING)
        if is_bare:
            new |= {name: {**new[name], **shape} for name, shape in _RING.items() if name in new}
        if "fluid" in new and tables.get("temperature") is not None:
            new["fluid"] = with_film_temperature(new["fluid"], tables["temperature"])
        try:
            super().__init__(**{**new, **{name: getattr(like, name) for name in same}})
        except ValidationError as error:
            known_keys = {fault.key for fault in wrong}
            faults = (as_gauge(fault, tables) for fault in problems(error, type(self)))
            raise InputError(*wrong, *(fault for fault in faults if fault.key not in known_keys)) from None
        if wrong:
            raise InputError(*wrong)
        self._has_shapes = not is_bare
        if like is not None and ({"closure", self.key_of("seat")} <= same or self._of_the_shape_of(like)):
            self._take_bodies(like)
        if self.bolts is not None:
            # set during construction, before the model is shared
            object.__setattr__(self, "load", apply_preloads(self.load, self.bolts))
        if self.load.set_pressure is not None and not [*self.closure.problems(), *self.lower.problems()]:
            with suppress(GeometryError):  # which the checks say
                object.__setattr__(self, "load", self.load.with_spring(self.initial_contact_radius))
        volumes, volume_faults = self.of_this_gas()
        if volume_faults:
            raise InputError(*volume_faults)
        heat = self.temperature
        warm = [
            ROOM_TEMPERATURE if heat is None else heat.of_body(name) or ROOM_TEMPERATURE
            for name in ("closure", "seat")
        ]
        for name, table in {**volumes, **self.bodies_at(*warm)}.items():
            # set during construction, before the model is shared
            object.__setattr__(self, name, table)
        conflicts = [as_written(conflict, tables) for conflict in contradictions(self)]
        if conflicts:
            none_left = all(conflict.kind for conflict in conflicts)
            raise (NoLoadLeftError if none_left else InputError)(*conflicts)
        # what the user wrote, so that `replace` checks a change exactly as it checks a file
        self._input = tables
        if of_gasket:
            self._lower_half = self._of_lower_flange(tables)

    def check_shapes(self) -> None:
        """InputError if its bodies have no shapes."""
        if not self.has_shapes:
            raise InputError(problem("shapes_missing"), file=self.file)

    def over_ring(self, inner: float, outer: float) -> Case:
        """The case of given contacts with bodies that touch on a ring, where they have no shapes; else itself.

        Parameters
        ----------
        inner, outer : float
            Radii [m].
        """
        if self.has_shapes:
            return self
        radii = {"land_inner_radius": inner, "land_outer_radius": outer}
        case = self.model_copy(
            update={
                "closure": self.closure.model_copy(update={"radius": 2.0 * outer}),
                "seat": self.seat and self.seat.model_copy(update=radii),
            }
        )
        for name in ("bodies", "contact"):
            vars(case).pop(name, None)
        return case

    def _of_lower_flange(self, tables: Mapping[str, Any]) -> Case | None:
        """The case with the lower flange on both faces of the gasket; None where it is like the upper one."""
        flange, rough = tables.get("seat"), tables.get("roughness")
        finish = rough.get("seat") if isinstance(rough, Mapping) else None
        if flange is None and finish is None:
            return None
        # what is required is required of both faces together
        new = {name: table for name, table in tables.items() if name not in ("seat", "requirement")}
        if flange is not None:
            new["closure"] = flange
        if finish is not None and rough is not None:
            new["roughness"] = {**rough, "closure": finish}
            del new["roughness"]["seat"]
        lower = Case.__new__(Case)
        try:
            lower._read_tables(new)
        except InputError as error:
            raise type(error)(
                *(replace(fault, key=_LOWER.sub(r"\1seat", fault.key)) for fault in error.problems)
            ) from None
        if lower.closure == self.closure and lower.roughness == self.roughness:
            return None
        if conflicts := list(of_unlike_flanges(self)):
            raise InputError(*(as_written(conflict, tables) for conflict in conflicts))
        for half, label in ((self, "upper flange"), (lower, "lower flange")):
            half._flange = label
            # it is made anew where it is asked for, with this label
            vars(half).pop("contact", None)
        return lower

    @property
    def parts(self) -> tuple[Case, ...]:
        """The case with each of two different flanges on both faces of the gasket; only itself where they are alike."""
        return (self,) if self._lower_half is None else (self, self._lower_half)

    @property
    def every_body(self) -> tuple[CaseBody, ...]:
        """Its bodies from above: closure and seat, or flange and gasket and a lower flange that differs."""
        first, *others = self.parts
        names = ((first, "closure"), (first, "seat"), *((part, "closure") for part in others))
        return tuple(CaseBody(part, name) for part, name in names)

    @property
    def finishes(self) -> dict[str, FinishTable]:
        """The finish of each face that has one, by its key in [roughness]."""
        found = {}
        for part in self.parts:
            for key, table in ({} if part.roughness is None else part.roughness.finishes).items():
                lower = part is not self and key == "closure" and "seat" in self._input["roughness"]
                found["seat" if lower else key] = table
        return found

    @property
    def contacts(self) -> tuple[ContactGeometry, ...]:
        """Bodies in first touch, of a gasket on each face that differs."""
        return tuple(part.contact for part in self.parts)

    def written_entry(self, key: str) -> object:
        """What stands at a key of the case file, such as "requirement.leak_rate"; None where nothing does."""
        table, name = key.split(".")
        entries = self._input.get(table)
        return entries.get(name) if isinstance(entries, Mapping) else None

    @property
    def sampling(self) -> Uncertainty | None:
        """What is uncertain, of a lower flange of its own as well; None if nothing is."""
        settings = super().sampling
        return settings if settings is not None or self._lower_half is None else self._lower_half.sampling

    def without_loads(self, numbers: Collection[int]) -> Self:
        """The same without some of its loads; at least one must be left."""
        case = super().without_loads(numbers)
        if numbers and self._lower_half is not None:
            case._lower_half = self._lower_half.without_loads(numbers)
        return case

    def in_diameters(self, name: str) -> bool:
        """Whether the case writes dimensions of a body, "closure" or "seat", as diameters."""
        entries = self._input.get(self.key_of(name))
        return isinstance(entries, Mapping) and any(key.endswith("diameter") for key in entries)

    @property
    def written(self) -> dict[str, Any]:
        """A copy of the tables as they were given, texts with units, with all changes."""
        return copy.deepcopy(self._input)

    @property
    def named_files(self) -> tuple[str, ...]:
        """Absolute paths of the files that the tables name."""
        return tuple(dict.fromkeys(str(Path(file).absolute()) for file in _named_files(self._input)))

    def replace(self, changes: Mapping[str, Any] | None = None, /, **tables: Any) -> Case:
        """A changed copy, checked like a new case.

        Parameters
        ----------
        changes : mapping, optional
            Dotted keys with their new entries: ``{"seat.angle": "50 deg"}``. Quantities are texts with a unit, as in a
            case file, or numbers in SI: ``{"closure.radius": 0.02}``, angles in radian, temperatures in kelvin. An
            entry of a list is named by its number from 0 on: ``{"form.seat.harmonics.0.amplitude": "2 um"}``.
            A word of the drawing replaces the key that it stands for, and the reverse: ``"seat.bore_diameter"`` the
            ``bore_radius`` of a case, ``"seat.included_angle"`` its ``angle``.
        **tables
            The same as nested tables: ``seat={"angle": "50 deg"}``. Tables are merged; a table with another
            `shape` or `kind` replaces the old one. None removes an entry.

        Raises
        ------
        InputError
            If the changed case is wrong.

        Examples
        --------
        >>> case = load_case({
        ...     "closure": {"shape": "ball", "radius": "20 mm", "material": "steel"},
        ...     "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
        ...     "interface": {"law": "smooth"},
        ...     "load": {"fluid_pressure": "20 bar"},
        ... })
        >>> case.replace({"closure.radius": 0.025, "load.fluid_pressure": ["1 bar", 5e5]}).load.fluid_pressure
        (100000.0, 500000.0)
        """
        result = _change_tables(self._with(changes or {}), copy.deepcopy(tables))
        new = {name: table for name, table in result.items() if table is not self._input.get(name)}
        of_gasket = result.get("gasket") is not None
        return self._check_tables({**result, **_tables_with_units(new, of_gasket=of_gasket)})

    def replace_written(self, changes: Mapping[str, Any]) -> Case:
        """The same with entries as they stand in a file, where a quantity without a unit is an error.

        Parameters
        ----------
        changes : mapping
            Dotted keys with their new entries.

        Raises
        ------
        InputError
            If the changed case is wrong.
        """
        return self._check_tables(self._with(changes))

    def _with(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """The tables as they were given, with entries changed at dotted keys."""
        new_entries = {key: value for key, value in changes.items() if value is not None}
        duplicates = said_twice(list(new_entries))
        if duplicates:
            raise InputError.at(duplicates[1], f"is {duplicates[0]} in other words; give one of them")
        new_tables = self._input
        entries = {same_entry(str(key)) for key in new_entries}
        # what is set in one word is not removed in the other
        changes = {
            key: value
            for key, value in changes.items()
            if value is not None or same_entry(str(key)) not in entries
        }
        for key, value in copy.deepcopy(dict(changes)).items():
            new_tables = _change_tables(new_tables, _nest_value(new_tables, str(key).split("."), value))
        return new_tables

    def _check_tables(self, tables: dict[str, Any]) -> Case:
        case = Case.__new__(Case)
        try:
            case._read(tables, self)
        except InputError as error:
            raise error.in_file(self._file) from None
        case._file = self._file
        return case


CaseSource = Case | str | os.PathLike[str] | Mapping[str, Any]
"""What public functions take for a case."""


def load_case(source: str | os.PathLike[str] | Mapping[str, Any]) -> Case:
    """Read and check a case, from its file or from a dict of its tables.

    Parameters
    ----------
    source : path or mapping
        TOML file; files named in it are looked for beside it, and the results folder is placed beside it. Or the same
        tables as a mapping, quantities as texts with units; files named there are looked for from the working folder.

    Raises
    ------
    InputError
        If the file cannot be read or anything in it is wrong; it lists every problem.

    Examples
    --------
    >>> case = load_case({
    ...     "closure": {"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     "interface": {"law": "smooth"},
    ...     "load": {"fluid_pressure": ["1 bar", "20 bar"]},
    ... })
    >>> case.load.fluid_pressure
    (100000.0, 2000000.0)
    >>> load_case("examples/ball_cone.toml").seat.angle     # doctest: +SKIP
    0.7853981633974483
    """
    if isinstance(source, Mapping):
        odd = [key for key in source if not isinstance(key, str)]
        if odd:
            raise InputError.at(str(odd[0]), "keys must be words, such as closure, seat, load")
        return _read_case(source)
    path = Path(source)
    folder = path.absolute().parent
    tables = with_files(read_toml(path, "case"), lambda name: str(folder / name))
    tables.setdefault("title", path.stem)
    _place_results(tables, path)
    try:
        case = _read_case(tables)
    except InputError as error:
        raise error.in_file(path) from None
    case._file = path
    return case


def _read_case(tables: Mapping[str, Any]) -> Case:
    """A case of the tables of a file, where a quantity without a unit is an error."""
    case = Case.__new__(Case)
    case._read_tables(dict(tables))
    return case


def case_of(source: CaseSource) -> Case:
    """The case that a public function is given: itself, its file or its tables.

    Parameters
    ----------
    source : Case, path or mapping
        A file or tables as `load_case` takes them.

    Raises
    ------
    InputError
        If it is none of them, or not a sound case.
    """
    if isinstance(source, Case):
        return source
    if isinstance(source, (str, os.PathLike, Mapping)):
        return load_case(source)
    raise InputError(problem("case_source", kind=type(source).__name__))


def _place_results(tables: dict[str, Any], path: Path) -> None:
    """Name the folders of results after the case file, where it names none itself."""
    for name, table in (("output", tables.setdefault("output", {})), ("direct", tables.get("direct"))):
        ending = "out" if name == "output" else name
        if isinstance(table, dict) and isinstance(table.get("folder", ""), str):
            table["folder"] = str(path.absolute().parent / table.get("folder", f"{path.stem}.{ending}"))


def _is_bare(table: object) -> bool:
    """Whether nothing but a material stands in the table of a body, or is to stand there."""
    return isinstance(table, Mapping) and table.keys() <= {"material"}


def _named_files(entry: Any, name: str = "") -> Iterator[str]:
    if isinstance(entry, Mapping):
        for key, value in entry.items():
            yield from _named_files(value, key)
    elif isinstance(entry, (list, tuple)):
        for value in entry:
            yield from _named_files(value, name)
    elif name in FILES and isinstance(entry, str):
        yield entry


def _change_tables(tables: dict[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """All tables of a case with changes merged in."""
    if "roughness" not in new:
        return _merge_tables(tables, new)
    roughness, change = roughness_like(tables.get("roughness"), new["roughness"])
    old_tables = tables if roughness is tables.get("roughness") else {**tables, "roughness": roughness}
    return _merge_tables(old_tables, {**new, "roughness": change})


def _in_keys(tables: Mapping[str, Any]) -> tuple[dict[str, Any], list[Problem]]:
    """Tables with keys in place of the drawing's words, and what is wrong with these."""
    new_tables, wrong = dict(tables), []
    for body in ("closure", "seat", "gasket"):
        if isinstance(entries := tables.get(body), Mapping):
            new_tables[body], faults = _shape_in_keys(body, CaseTables.model_fields[body], entries)
            wrong.extend(faults)
    return new_tables, wrong


def _shape_in_keys(
    path: str, field: FieldInfo, entries: Mapping[str, Any]
) -> tuple[Mapping[str, Any], list[Problem]]:
    """A table with a shape, and the shapes in its lists, such as the lands of a seat."""
    shape_tables = [table for table in tables_of(field) if "shape" in table.model_fields]
    chosen = next((table for table in shape_tables if entries.get("shape") in choices(table, "shape")), None)
    if chosen is None:
        return entries, []
    new_entries, wrong = in_keys(path, chosen, entries)
    for key, value in new_entries.items():
        if key not in chosen.model_fields or not isinstance(value, list | tuple):
            continue
        new_entries[key] = [*value]
        for number, entry in enumerate(value):
            if isinstance(entry, Mapping):
                place = f"{path}.{key}[{number + 1}]"
                new_entries[key][number], faults = _shape_in_keys(place, chosen.model_fields[key], entry)
                wrong += faults
    return new_entries, wrong


def _merge_tables(old: dict[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """A new table; entries without a change are the very ones of the old table."""
    new_table = dict(old)
    for key, value in new.items():
        old_value = new_table.get(key)
        partner_key = partner(key)
        if partner_key is not None and new.get(partner_key) is None:
            new_table.pop(partner_key, None)
        if value is None:
            new_table.pop(key, None)
        elif isinstance(value, Mapping):
            same = isinstance(old_value, dict) and all(
                value.get(k, old_value.get(k)) == old_value.get(k) for k in ("shape", "kind")
            )
            whole = "name" in value or {"youngs_modulus", "poissons_ratio"} <= value.keys()
            if key == "material" and isinstance(old_value, str) and not whole:
                # some numbers of a material that stands there by its name
                old_value, same = library_table(old_value), True
            new_table[key] = _merge_tables(old_value if same and old_value else {}, value)
        else:
            new_table[key] = value
    return new_table


def _nest_value(old: Any, path: Sequence[str], value: Any, parents: tuple[str, ...] = ()) -> Any:
    """A value at a dotted key as nested tables; where the key leads into a list, the list with that entry changed.

    Parameters
    ----------
    old : anything
        What stands there before.
    path : sequence of str
        What is left of the key.
    parents : tuple of str
        The part of the key that led here.

    Raises
    ------
    InputError
        If a list has no such entry, or there is no list.
    """
    if not path:
        return value
    key, *rest = path
    place = ".".join(parents)
    if not isinstance(old, (list, tuple)):
        if key.isdecimal() and parents:
            raise InputError(problem("no_list", place=place, key=key))
        old_value = old.get(key) if isinstance(old, Mapping) else None
        return {key: _nest_value(old_value, rest, value, (*parents, key))}
    if not key.isdecimal() or int(key) >= len(old):
        few = {0: "it is empty", 1: "0 is its only entry"}
        numbers = few.get(len(old), f"it has 0 to {len(old) - 1}")
        raise InputError(problem("entry_of_list", place=place, key=key, numbers=numbers))
    number = int(key)
    entry = _nest_value(old[number], rest, value, (*parents, key))
    if isinstance(entry, Mapping) and isinstance(old[number], dict):
        entry = _merge_tables(old[number], entry)
    return [*old[:number], *([] if entry is None else [entry]), *old[number + 1 :]]


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
        key: _add_unit(value, DIMENSIONS[words[key].marker.dimension].si_unit)
        if key in words
        else _entry_with_units(fields[key], value)
        if key in fields
        else value
        for key, value in entries.items()
    }


def _tables_with_units(tables: Mapping[str, Any], *, of_gasket: bool) -> dict[str, Any]:
    new_tables = with_units(CaseTables, tables)
    if of_gasket and "seat" in new_tables:
        # the lower flange, which has the shapes of the upper one
        new_tables["seat"] = _entry_with_units(CaseTables.model_fields["closure"], tables["seat"])
    return new_tables


def _entry_with_units(field: FieldInfo, value: Any) -> Any:
    quantity = next(quantities_of(field), None)
    if quantity is not None:
        return _add_unit(value, DIMENSIONS[quantity.dimension].si_unit)
    if isinstance(value, (list, tuple)):
        return [_entry_with_units(field, entry) for entry in value]
    if isinstance(value, Mapping):
        kinds = [table for table in tables_of(field) if _is_meant(table, value)]
        # a kind that is not written is known by the keys that go with it
        kinds.sort(key=lambda table: len(set(value) - set(table.model_fields)))
        return with_units(kinds[0], value) if kinds else value
    return value


def _is_meant(table: type[BaseModel], entries: Mapping[str, Any]) -> bool:
    """Whether `shape` or `kind` of the entries is that of the table."""
    return all(
        entries[key] in choices(table, key)
        for key in ("shape", "kind")
        if key in entries and key in table.model_fields
    )


def _add_unit(value: Any, unit: str) -> Any:
    if isinstance(value, bool):
        return value
    if isinstance(value, float) or (isinstance(value, int) and abs(value) < 10**300):
        return f"{float(value)!r} {unit}"
    if hasattr(value, "tolist"):  # an array, or a number out of one
        return _add_unit(value.tolist(), unit)
    if isinstance(value, (list, tuple)):
        return [_add_unit(entry, unit) for entry in value]
    if isinstance(value, Mapping):  # a range
        return {key: _add_unit(end, unit) if key in ("start", "stop") else end for key, end in value.items()}
    return value


def input_tables(case: Case) -> dict[str, Any]:
    """The case as nested tables in SI with all defaults filled in."""
    return {name: _plain(getattr(case, name)) for name in CaseTables.model_fields if name != "title"}


def _plain(value: Any) -> Any:
    if hasattr(value, "model_fields_set"):
        return {name: _plain(entry) for name, entry in value}
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    return [_plain(entry) for entry in value] if isinstance(value, (tuple, list)) else value


# Keys of all tables at which a file is named.
FILES = ("file", "files", "trace", "profile", "posterior")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_NAME = re.compile(r"[\w][\w .+-]*")
_MOST = 1000


def names_files(path: str) -> bool:
    """Whether the entry at a dotted path is a file, or several.

    Parameters
    ----------
    path : str
    """
    return path.split(".")[-1] in FILES


def with_files(entry: Any, change: Callable[[str], str], path: str = "") -> Any:
    """Tables of a case in which each file that they name is replaced by what a function makes of it.

    Parameters
    ----------
    entry : mapping
    change : callable
    path : str
        Of the entry.
    """
    if isinstance(entry, Mapping):
        return {key: with_files(value, change, key) for key, value in entry.items()}
    if isinstance(entry, (list, tuple)):
        return [with_files(value, change, path) for value in entry]
    return change(str(entry)) if isinstance(entry, (str, Path)) and names_files(path) else entry


def case_text(tables: Mapping[str, Any], folder: Path, remark: str = "") -> str:
    """A case file with all entries of a case; files named in it are given from a folder.

    Parameters
    ----------
    tables : mapping
        Of the case, as `Case.written` has them; where the results go is left out.
    folder : Path
        Where the file is to stand.
    remark : str
        First line, a comment.
    """
    tables = {name: table for name, table in tables.items() if name != "output" and table is not None}
    lines = [f"# {line}" for line in remark.splitlines()]
    plain = {key: value for key, value in tables.items() if not isinstance(value, Mapping)}
    lines += [f"{_key(key)} = {_value(value, key, folder)}" for key, value in plain.items()]
    for name, table in tables.items():
        if name in plain:
            continue
        lines += ["", f"[{_key(name)}]"]
        lines += [f"{_key(key)} = {_value(value, key, folder)}" for key, value in _given_entries(table)]
    return "\n".join(lines).lstrip("\n") + "\n"


def _given_entries(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    return ((key, value) for key, value in table.items() if value is not None)


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else json.dumps(key, ensure_ascii=False)


def _value(value: Any, key: str, folder: Path) -> str:
    if isinstance(value, Material):
        value = as_table(value)
    if isinstance(value, Mapping):
        return (
            "{ "
            + ", ".join(f"{_key(k)} = {_value(entry, k, folder)}" for k, entry in _given_entries(value))
            + " }"
        )
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(entry, key, folder) for entry in value) + "]"
    if isinstance(value, (bool, int, float)):
        return json.dumps(value)
    text = str(value)
    if key in FILES and Path(text).is_absolute() and Path(text).is_relative_to(folder):
        text = Path(text).relative_to(folder).as_posix()
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def free_name(folder: Path, name: str, suffix: str) -> Path:
    """A path in a folder that nothing stands at yet: a number is added where the name is taken.

    Parameters
    ----------
    folder : Path
    name : str
        Without folders.
    suffix : str
        Such as ".toml"; added unless the name has it.

    Raises
    ------
    InputError
        If the name is none.
    """
    stem = name.strip().removesuffix(suffix)
    if not _NAME.fullmatch(stem) or stem.endswith("."):
        raise InputError(problem("explore_name", name=name))
    for number in range(1, _MOST):
        path = folder / (f"{stem}{suffix}" if number == 1 else f"{stem}-{number}{suffix}")
        if not path.exists():
            return path
    raise InputError(problem("explore_name_taken", times=_MOST - 1, folder=folder, name=name))


def write_case(tables: Mapping[str, Any], folder: Path, name: str, remark: str = "") -> Path:
    """Write a case into a new file; nothing is written over.

    Parameters
    ----------
    tables : mapping
        Of the case, see `case_text`.
    folder : Path
    name : str
        Of the file, see `free_name`.
    remark : str
        First line, a comment.

    Returns
    -------
    Path
    """
    path = free_name(folder, name, ".toml")
    return write_text(path, case_text(tables, folder.absolute(), remark))
