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

from fem_seal.case.fields import Table, key_of, shown
from fem_seal.case.material_table import CURVE_FORMS
from fem_seal.case.notation import choices, tables_of, words_of
from fem_seal.case.words import gone_entry, sentence
from fem_seal.errors import Problem

# What a table with several forms looks like, by the key that tells them apart.
_EXAMPLES = {
    "kind": '{ kind = "table", file = "C.csv" }',
    "shape": '{ shape = "ball", radius = "20 mm", material = "steel" }',
}


def problems(error: ValidationError, case: type[BaseModel]) -> list[Problem]:
    """One `Problem` for each error of the validation of `case`."""
    found = [_problem(details, case) for details in error.errors(include_url=False)]
    # which keys a table needs depends on its shape: with a wrong shape, nothing else can be said about it
    forms = (".shape", ".kind")
    undecided = {one.key.rpartition(".")[0] for one in found if one.key.endswith(forms)}
    return [one for one in found if one.key.endswith(forms) or one.key.rpartition(".")[0] not in undecided]


def _locate(loc: tuple[int | str, ...], case: type[BaseModel]) -> tuple[list[str], type[BaseModel] | None]:
    """Key path without the names of union members, and the table in which the last key stands."""
    path: list[str] = []
    candidates: list[type[BaseModel]] = [case]
    table: type[BaseModel] | None = case
    for part in loc:
        tagged = [one for one in candidates if len(candidates) > 1 and part in _tags(one).values()]
        if tagged:
            candidates = tagged
            continue
        if part in CURVE_FORMS:
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
        return Problem(key, missing(table, name).message)
    if kind == "extra_forbidden" and (remedy := gone_entry(key)):
        return Problem(key, remedy, shown(value))
    if kind == "extra_forbidden":
        return Problem(key, _UnknownKey(path, value, table, case).message)
    if kind == "union_tag_not_found":
        return _without_tag(key, value, tables_of(table.model_fields[name]) if table else [])
    if kind == "union_tag_invalid":
        word = str(ctx["tag"])
        key = f"{key}.{str(ctx['discriminator']).strip(chr(39))}"
        return Problem(
            key, _choice(word, str(ctx["expected_tags"]).replace("'", "").split(", ")), shown(word)
        )
    if kind == "literal_error" and table is not None:
        remedy = gone_entry(f"{key} = {shown(value)}") or _choice(value, choices(table, name))
        return Problem(key, remedy, shown(value))
    if kind == "value_error":
        return Problem(key, str(ctx["error"]), None if isinstance(value, Mapping) else shown(value))
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return Problem(key, _no_table(key, name, table), shown(value))
    if kind in ("bool_type", "tuple_type", "list_type", "string_type", "invalid_key"):
        return Problem(key, sentence(kind, name=name), shown(value))
    return Problem(key, details["msg"][:1].lower() + details["msg"][1:], shown(value))


def missing(table: type[BaseModel] | None, name: str) -> Problem:
    """What is said where an entry of a table is missing."""
    return Problem(name, f"is missing; {_what_to_write(table, name)}")


def _no_table(key: str, name: str, parent: type[BaseModel] | None) -> str:
    """What to write instead, with all entries that must be there, or with one that may be."""
    field = parent.model_fields.get(name) if parent else None
    tables = tables_of(field) if field else []
    if not tables:
        return "must be a table, { ... }"
    given = [
        (one, entry, told.example)
        for one, entry in tables[0].model_fields.items()
        if (told := key_of(tables[0], one)).examples
    ]
    needed = [each for each in given if each[1].is_required()] or given[:1]
    entries = ", ".join(f"{one} = {toml(example)}" for one, _, example in needed) or "..."
    return f"must be a table, [{key}] with its keys below, or {name} = {{ {entries} }}"


def _what_to_write(table: type[BaseModel] | None, name: str) -> str:
    field = table.model_fields.get(name) if table else None
    if table is None or field is None:
        return "add it"
    key = key_of(table, name)
    if tables_of(field) and not key.meaning:
        needed = [key for key, one in tables_of(field)[0].model_fields.items() if one.is_required()]
        return f"add a table [{name}] with {', '.join(needed)}"
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
        known = _keys(self.table) if self.table else []
        return f"unknown key; {self._hint(known)}known keys here are {', '.join(known)}"

    def _hint(self, known: Sequence[str]) -> str:
        """Where it belongs: the very word in another table counts more than one like it in this table."""
        # "hurts" for "hurst", but also "Radius" and "youngs-modulus"
        name = _plain_word(self.path[-1])
        here, everywhere = {_plain_word(key): key for key in known}, _places(self.case)
        if name in here:
            return f"do you mean {here[name]}? "
        own = ".".join([*self.path[:-1], name])
        if remedy := _OTHER_WORDS.get(own, _OTHER_WORDS.get(name)):
            return f"{remedy} "
        if name in everywhere:
            key = everywhere[name][0]
            again = "" if key == self.path[-1] else f"as {key} "
            return f"it belongs {again}{self._belongs(*everywhere[name])}; "
        # "pressure_outlet" for "outlet_pressure"
        turned = [key for key in known if sorted(key.split("_")) == sorted(self.path[-1].split("_"))]
        if near := turned or difflib.get_close_matches(name, here, n=1, cutoff=0.6):
            return f"do you mean {here[_plain_word(near[0])]}? "
        if near := difflib.get_close_matches(name, everywhere, n=1, cutoff=0.8):
            key = everywhere[near[0]][0]
            return f"do you mean {key}, which belongs {self._belongs(*everywhere[near[0]])}? "
        return ""

    def _belongs(self, key: str, places: Sequence[_Place]) -> str:
        """In words: the places that take such a value, those nearest to where the key was written."""
        here = [re.sub(r"\[\d+\]$", "", part) for part in self.path[:-1]]
        own = [one.table for one in places if one.path == ".".join(here) and one.table is not self.table]
        if words := [tag for one in own for tag in _tags(one)]:
            return f"to {_either(words)}"

        def distance(place: _Place) -> tuple[bool, int, int]:
            field = place.table.model_fields.get(key)
            other_form = bool(field is not None and tables_of(field)) is not isinstance(self.value, Mapping)
            parts = place.path.split(".")
            shared = next((n for n, (a, b) in enumerate(zip(parts, here, strict=False)) if a != b), len(here))
            return other_form, -shared, len(parts)

        least = min(map(distance, places))
        headings = dict.fromkeys(place.heading for place in places if distance(place) == least)
        if any(headings):
            return f"in {_either(headings)}"
        alone = tables_of(self.case.model_fields[key])
        return f"in a table of its own, [{key}]" if alone else "above all tables"


def _plain_word(key: str) -> str:
    return key.lower().replace("-", "_")


def _either(words: Iterable[str]) -> str:
    listed = [*dict.fromkeys(words)]
    # the last of one more is as short as "1 others"
    if len(listed) > _PLACES + 1:
        listed = [*listed[:_PLACES], f"{len(listed) - _PLACES} others"]
    return " or ".join(filter(None, [", ".join(listed[:-1]), listed[-1]]))


def _keys(table: type[BaseModel]) -> list[str]:
    return [*table.model_fields, *words_of(table)]


@cache
def _places(case: type[BaseModel]) -> Mapping[str, tuple[str, Sequence[_Place]]]:
    """Every key of every table as it is written, and where it is known."""
    found: dict[str, tuple[str, list[_Place]]] = {}
    for place in _all_tables(_Place("", "", case)):
        if place.path == "bolts.material":
            # what is said of a material is meant of the bodies
            continue
        for key in _keys(place.table):
            found.setdefault(_plain_word(key), (key, []))[1].append(place)
    return found


def _all_tables(place: _Place) -> Iterator[_Place]:
    yield place
    for key, field in place.table.model_fields.items():
        path = f"{place.path}.{key}".lstrip(".")
        heading = f"[[{path}]]" if _is_list(field.annotation) else f"[{path}]"
        for below in tables_of(field):
            yield from _all_tables(_Place(path, heading, below))


def _is_list(annotation: Any) -> bool:
    return get_origin(annotation) in (tuple, list) or any(map(_is_list, get_args(annotation)))


def _without_tag(key: str, value: object, tables: list[type[Table]]) -> Problem:
    """A table of which it is not known which of several it is."""
    tag = "shape" if any("shape" in table.model_fields for table in tables) else "kind"
    if not isinstance(value, Mapping):
        return Problem(key, f"must be a table, such as {_EXAMPLES[tag]}", shown(value))
    words = " or ".join(f'{tag} = "{word}"' for table in tables for word in choices(table, tag))
    return Problem(f"{key}.{tag}", f"is missing; write {words}")


def nearest(value: object, words: Sequence[str]) -> str | None:
    """The one of some words that a value was most likely meant to be; None if it is like none of them."""
    near = difflib.get_close_matches(str(value).lower().replace("_", "-"), words, n=1, cutoff=0.5)
    return near[0] if near else None


def _choice(value: object, words: list[str]) -> str:
    listed = " or ".join(f'"{word}"' for word in words)
    near = nearest(value, words)
    hint = f'; do you mean "{near}"?' if near else ""
    return f"must be {listed}{hint}"


def toml(value: object) -> str:
    """An example value as it is written in the case file."""
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(entry)}" for key, entry in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False)
