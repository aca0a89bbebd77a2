"""Validation errors of pydantic as messages with key, value and remedy."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from fem_seal.case.fields import FORMS, Table, key_of, show
from fem_seal.case.material_table import CURVE_FORMS
from fem_seal.case.notation import choices, tables_of, words_of
from fem_seal.errors import Problem
from fem_seal.files import own_tables, problem

# What a table with several forms looks like, by the key that tells them apart.
_EXAMPLES = {
    "kind": '{ kind = "table", file = "C.csv" }',
    "shape": '{ shape = "ball", radius = "20 mm", material = "steel" }',
}


def problems(error: ValidationError, case: type[BaseModel]) -> list[Problem]:
    """One `Problem` for each error of the validation of `case`."""
    faults = [_problem(details, case) for details in error.errors(include_url=False)]
    # which keys a table needs depends on its shape: with a wrong shape, nothing else can be said about it
    forms = (".shape", ".kind")
    vague = {item.key.rpartition(".")[0] for item in faults if item.key.endswith(forms)}
    return [item for item in faults if item.key.endswith(forms) or item.key.rpartition(".")[0] not in vague]


def _locate(loc: tuple[int | str, ...], case: type[BaseModel]) -> tuple[list[str], type[BaseModel] | None]:
    """Key path without the names of union members, and the table in which the last key stands."""
    path: list[str] = []
    candidates: list[type[BaseModel]] = [case]
    table: type[BaseModel] | None = case
    for part in loc:
        chosen = [kind for kind in candidates if len(candidates) > 1 and part in _tags(kind).values()]
        if chosen:
            candidates = chosen
            continue
        if part in (*CURVE_FORMS, *FORMS):
            continue
        if isinstance(part, int):
            path[-1] += f"[{part + 1}]"
            continue
        table = candidates[0] if candidates else None
        path.append(str(part))
        field = table.model_fields.get(str(part)) if table else None
        candidates = list(tables_of(field)) if field else []
    return path, table


def _tags(table: type[BaseModel]) -> dict[str, str]:
    """Entries that choose a table of several, 'shape = "ball"', with their words."""
    keys = [key for key in ("shape", "kind") if key in table.model_fields]
    return {f'{key} = "{word}"': word for key in keys for word in choices(table, key)}


def _problem(details: ErrorDetails, case: type[BaseModel]) -> Problem:
    path, table = _locate(details["loc"], case)
    kind, value, ctx = details["type"], details["input"], details.get("ctx", {})
    key, name = ".".join(path), path[-1] if path else ""
    if kind == "missing":
        return Problem(key, missing_key(table, name).message)
    if kind == "extra_forbidden" and (remedy := gone_entry(key)):
        return Problem(key, remedy, show(value))
    if kind == "extra_forbidden":
        return Problem(key, _UnknownKey(path, value, table, case).message)
    if kind == "union_tag_not_found":
        return _without_tag(key, value, tables_of(table.model_fields[name]) if table else [])
    if kind == "union_tag_invalid":
        word = str(ctx["tag"])
        key = f"{key}.{str(ctx['discriminator']).strip(chr(39))}"
        return Problem(key, _choice(word, str(ctx["expected_tags"]).replace("'", "").split(", ")), show(word))
    if kind == "literal_error" and table is not None:
        remedy = gone_entry(f"{key} = {show(value)}") or _choice(value, choices(table, name))
        return Problem(key, remedy, show(value))
    if kind == "value_error":
        return Problem(key, str(ctx["error"]), None if isinstance(value, Mapping) else show(value))
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return Problem(key, _no_table(key, name, table), show(value))
    if kind in ("bool_type", "tuple_type", "list_type", "string_type", "invalid_key"):
        return Problem(key, problem(kind, name=name), show(value))
    return Problem(key, details["msg"][:1].lower() + details["msg"][1:], show(value))


def missing_key(table: type[BaseModel] | None, name: str) -> Problem:
    """What is said where an entry of a table is missing."""
    return Problem(name, f"is missing; {_what_to_write(table, name)}")


def _no_table(key: str, name: str, parent: type[BaseModel] | None) -> str:
    """What to write instead, with all entries that must be there, or with one that may be."""
    field = parent.model_fields.get(name) if parent else None
    tables = tables_of(field) if field else []
    if not tables:
        return "must be a table, { ... }"
    examples = [
        (key_name, entry, description.example)
        for key_name, entry in tables[0].model_fields.items()
        if (description := key_of(tables[0], key_name)).examples
    ]
    required_entries = [each for each in examples if each[1].is_required()] or examples[:1]
    entries = ", ".join(f"{key_name} = {toml(example)}" for key_name, _, example in required_entries) or "..."
    return f"must be a table, [{key}] with its keys below, or {name} = {{ {entries} }}"


def _what_to_write(table: type[BaseModel] | None, name: str) -> str:
    field = table.model_fields.get(name) if table else None
    if table is None or field is None:
        return "add it"
    key = key_of(table, name)
    if tables_of(field) and not key.meaning:
        entries = tables_of(field)[0].model_fields
        keys = [key for key, entry in entries.items() if entry.is_required()] or list(entries)[:1]
        return f"add a table [{name}] with {', '.join(keys)}"
    words = choices(table, name)
    if words:
        return f"write {name} = " + " or ".join(f'"{word}"' for word in words)
    text = f"add {name} = {toml(key.example)}" if key.examples else "add it"
    for word in words_of(table).values():
        if word.key == name:
            text += f" or {word.name} = {toml(word.example)}"
    return f"{text} ({key.meaning})" if key.meaning else text


# What to say of words that the field has for something else, in one table or in all of them.
_OTHER_WORDS = {
    "load.force": "do you mean applied_force?",
    "load.pressure": "do you mean fluid_pressure? pressure belongs in [direct];",
    "fluid.pressure": "do you mean fluid_pressure, which belongs in [load]? pressure belongs in [direct];",
    "line_load": "give applied_force, the line load times the circumference of the seal;",
    "temp": "do you mean temperature?",
    "e": "do you mean youngs_modulus, which belongs in a table of the material?",
    **dict.fromkeys(("bolt_force", "bolt_load"), "give preload, the force of each bolt, in [bolts];"),
    **dict.fromkeys(
        ("roundness", "circularity", "ovality"),
        "give a tolerance, harmonics or a trace in [form.seat] or [form.closure];",
    ),
}
# So many places of a key are named where it has several.
_PLACES = 3


@dataclass(frozen=True)
class _Place:
    """A table that knows a key, by its path; "[[form.scratches]]" is one of a list of tables."""

    path: str
    heading: str
    table: type[BaseModel]


@dataclass(frozen=True)
class _UnknownKey:
    """A key that the table at its path does not have, with its value."""

    path: Sequence[str]
    value: object
    table: type[BaseModel] | None
    case: type[BaseModel]

    @property
    def message(self) -> str:
        keys = _keys(self.table) if self.table else []
        return f"unknown key; {self._hint(keys)}known keys here are {', '.join(keys)}"

    def _hint(self, keys: Sequence[str]) -> str:
        """Where it belongs: the very word in another table counts more than one like it in this table."""
        # "hurts" for "hurst", but also "Radius" and "youngs-modulus"
        name = _plain_word(self.path[-1])
        keys_here, everywhere = {_plain_word(key): key for key in keys}, _places(self.case)
        if name in keys_here:
            return f"do you mean {keys_here[name]}? "
        path = ".".join([*self.path[:-1], name])
        if remedy := _OTHER_WORDS.get(path, _OTHER_WORDS.get(name)):
            return f"{remedy} "
        if name in everywhere:
            key = everywhere[name][0]
            spelling = "" if key == self.path[-1] else f"as {key} "
            return f"it belongs {spelling}{self._belongs(*everywhere[name])}; "
        # "pressure_outlet" for "outlet_pressure"
        reordered = [key for key in keys if sorted(key.split("_")) == sorted(self.path[-1].split("_"))]
        if likely := reordered or difflib.get_close_matches(name, keys_here, n=1, cutoff=0.6):
            return f"do you mean {keys_here[_plain_word(likely[0])]}? "
        if likely := difflib.get_close_matches(name, everywhere, n=1, cutoff=0.8):
            key = everywhere[likely[0]][0]
            return f"do you mean {key}, which belongs {self._belongs(*everywhere[likely[0]])}? "
        return ""

    def _belongs(self, key: str, places: Sequence[_Place]) -> str:
        """In words: the places that take such a value, those nearest to where the key was written."""
        path = [re.sub(r"\[\d+\]$", "", part) for part in self.path[:-1]]
        rest = [p.table for p in places if p.path == ".".join(path) and p.table is not self.table]
        if words := [tag for table in rest for tag in _tags(table)]:
            return f"to {_either(words)}"

        def distance(place: _Place) -> tuple[bool, int, int]:
            field = place.table.model_fields.get(key)
            other_form = bool(field is not None and tables_of(field)) is not isinstance(self.value, Mapping)
            parts = place.path.split(".")
            common = next((n for n, (a, b) in enumerate(zip(parts, path, strict=False)) if a != b), len(path))
            return other_form, -common, len(parts)

        shortest = min(map(distance, places))
        headings = dict.fromkeys(place.heading for place in places if distance(place) == shortest)
        if any(headings):
            return f"in {_either(headings)}"
        tables = tables_of(self.case.model_fields[key])
        return f"in a table of its own, [{key}]" if tables else "above all tables"


def _plain_word(key: str) -> str:
    return key.lower().replace("-", "_")


def _either(words: Iterable[str]) -> str:
    names = [*dict.fromkeys(words)]
    # the last of one more is as short as "1 others"
    if len(names) > _PLACES + 1:
        names = [*names[:_PLACES], f"{len(names) - _PLACES} others"]
    return " or ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def _keys(table: type[BaseModel]) -> list[str]:
    return [*table.model_fields, *words_of(table)]


@cache
def _places(case: type[BaseModel]) -> Mapping[str, tuple[str, Sequence[_Place]]]:
    """Every key of every table as it is written, and where it is known."""
    places: dict[str, tuple[str, list[_Place]]] = {}
    for place in _all_tables(_Place("", "", case)):
        if place.path == "bolts.material":
            # what is said of a material is meant of the bodies
            continue
        for key in _keys(place.table):
            places.setdefault(_plain_word(key), (key, []))[1].append(place)
    return places


def _all_tables(place: _Place) -> Iterator[_Place]:
    yield place
    for key, field in place.table.model_fields.items():
        path = f"{place.path}.{key}".lstrip(".")
        heading = f"[[{path}]]" if _is_list(field.annotation) else f"[{path}]"
        for subtable in tables_of(field):
            yield from _all_tables(_Place(path, heading, subtable))


def _is_list(annotation: Any) -> bool:
    return get_origin(annotation) in (tuple, list) or any(map(_is_list, get_args(annotation)))


def _without_tag(key: str, value: object, tables: list[type[Table]]) -> Problem:
    """A table of which it is not known which of several it is."""
    tag = "shape" if any("shape" in table.model_fields for table in tables) else "kind"
    if not isinstance(value, Mapping):
        return Problem(key, f"must be a table, such as {_EXAMPLES[tag]}", show(value))
    words = " or ".join(f'{tag} = "{word}"' for table in tables for word in choices(table, tag))
    return Problem(f"{key}.{tag}", f"is missing; write {words}")


def nearest(value: object, words: Sequence[str]) -> str | None:
    """The one of some words that a value was most likely meant to be; None if it is like none of them."""
    likely = difflib.get_close_matches(str(value).lower().replace("_", "-"), words, n=1, cutoff=0.5)
    return likely[0] if likely else None


def _choice(value: object, words: list[str]) -> str:
    choices_text = " or ".join(f'"{word}"' for word in words)
    likely = nearest(value, words)
    hint = f'; do you mean "{likely}"?' if likely else ""
    return f"must be {choices_text}{hint}"


def toml(value: object) -> str:
    """An example value as it is written in the case file."""
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(entry)}" for key, entry in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False)


def gone_entry(entry: str) -> str | None:
    """What to write instead of a key, or of a value of a key, that earlier versions had; None if none had it.

    Parameters
    ----------
    entry : str
        "load.axial_force", 'interface.law = "persson"'.
    """
    remedy: str | None = own_tables("problems.toml")["gone"].get(entry)
    return remedy
