"""JSON Schema of the case file, arranged so that an editor gives one message for one mistake.

The models are the only source. Where several forms of a table are possible, pydantic lists them as alternatives, and an
editor then says of one misspelt word that none of them fits, once for every key in the table. Here the word that tells
the forms apart is a choice, and each form follows from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fem_seal.case.case import Case
from fem_seal.case.fields import NUMBER_WITH_UNIT, Table
from fem_seal.case.notation import tables_of, words_of

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
# Where another part of the schema says which keys there are: tombi takes silence for a no.
_OPEN = {"additionalProperties": True}
# The kind of a table that does not say it, where there is one, and that of one with a key.
_DEFAULT_KINDS, _KINDS_OF_KEYS = {"kind": "finish"}, {"feed": "turned"}


def case_schema() -> dict[str, Any]:
    """JSON Schema of what may stand in a case file.

    Returns
    -------
    dict
        Draft 2020-12. Ranges of quantities and contradictions between entries are beyond a schema; `load_case`
        checks them.

    Examples
    --------
    >>> sorted(case_schema()["required"])
    ['closure', 'load']
    """
    schema = Case.model_json_schema(mode="validation")
    # a gasket has no seat
    schema["anyOf"] = [{"required": ["seat"]}, {"required": ["gasket"]}]
    for body in ("closure", "seat", "gasket"):
        for table in tables_of(Case.model_fields[body]):
            _add_words(schema["$defs"][table.__name__], table)
    schema["description"] = 'One seal with its loads; quantities are texts with units, such as "20 mm".'
    case_file = as_schema("fem-seal case", schema)
    _add_finishes(case_file["properties"], ("roughness",))
    _add_finishes(case_file["$defs"]["Roughness"]["properties"], ("spectrum", "seat", "closure", "gasket"))
    for body in ("closure", "seat"):
        # given contacts need no shapes
        case_file["properties"][body]["required"] = ["material"]
    _share_material(case_file["$defs"])
    return case_file


def _share_material(defs: dict[str, Any]) -> None:
    """Say what a material is once, for all shapes of both bodies."""
    for table in [entry for entry in defs.values() if "material" in entry.get("properties", {})]:
        entry = table["properties"]["material"]
        defs.setdefault("Material", {"allOf": entry["allOf"]})
        table["properties"]["material"] = {**entry, "allOf": [{"$ref": "#/$defs/Material"}]}


def _add_finishes(properties: dict[str, Any], keys: tuple[str, ...]) -> None:
    """A finish in words beside the table that it stands for."""
    words = {
        "type": "string",
        "pattern": r"\bR[aqz]\b",
        "description": 'a finish in words, such as "lapped Ra 0.2 um"',
        "examples": ["lapped Ra 0.2 um"],
    }
    for key in keys:
        table = properties[key]
        properties[key] = {
            "type": ["string", "object"],
            **_OPEN,
            **({"description": table["description"]} if "description" in table else {}),
            "allOf": [{"if": {"type": "string"}, "then": words}, {"if": {"type": "object"}, "then": table}],
        }


def as_schema(title: str, schema: Mapping[str, Any]) -> dict[str, Any]:
    """Schema of a file from that of its model.

    Parameters
    ----------
    title : str
        What the file is.
    schema : mapping
        As pydantic makes it.
    """
    file_schema = _file_schema(schema, schema.get("$defs", {}))
    for definition in file_schema.get("$defs", {}).values():
        for word, kind in _DEFAULT_KINDS.items():
            kinds, required = (kind, *_KINDS_OF_KEYS.values()), definition.get("required", [])
            if definition.get("properties", {}).get(word, {}).get("const") in kinds and word in required:
                required.remove(word)
    return {"$schema": _DIALECT, "title": title, **file_schema}


def _add_words(schema: dict[str, Any], table: type[Table]) -> None:
    """Diameters and included angles beside the keys that they stand for."""
    for word in words_of(table).values():
        schema["properties"][word.name] = {
            "type": "string",
            "pattern": NUMBER_WITH_UNIT,
            "description": f"instead of {word.key}: {word.meaning}",
            "examples": [word.example],
        }
        if word.key in schema.get("required", []):
            schema["required"].remove(word.key)
            key_without_word = {"if": {"not": {"required": [word.name]}}, "then": {"required": [word.key]}}
            schema.setdefault("allOf", []).append(key_without_word)


def _file_schema(schema: Mapping[str, Any], defs: Mapping[str, Any]) -> dict[str, Any]:
    """Schema of the file instead of the models: TOML has no null, and titles would only repeat the keys."""
    new: dict[str, Any] = {}
    for key, value in schema.items():
        if key == "title" and isinstance(value, str):
            continue
        if key == "default" and (value is None or isinstance(value, dict)):
            continue
        if isinstance(value, dict):
            new[key] = _file_schema(value, defs)
        elif isinstance(value, list):
            new[key] = [_file_schema(entry, defs) if isinstance(entry, dict) else entry for entry in value]
        else:
            new[key] = value
    if "discriminator" in new:
        return _chosen_by_word(new, defs)
    if "anyOf" in new:
        return _alternatives(new)
    return new


def _alternatives(schema: dict[str, Any]) -> dict[str, Any]:
    """One form follows from the type of what stands there, or from which key is missing."""
    choices = [choice for choice in schema.pop("anyOf") if choice != {"type": "null"}]
    if len(choices) == 1:
        return {**choices[0], **schema}
    by_type: dict[Any, list[dict[str, Any]]] = {}
    for choice in choices:
        by_type.setdefault(choice.get("type"), []).append(choice)
    if None not in by_type and len(by_type) > 1:
        each = [
            {"if": {"type": kind}, "then": same[0] if len(same) == 1 else {"anyOf": same}}
            for kind, same in by_type.items()
        ]
        return {"type": list(by_type), **(_OPEN if "object" in by_type else {}), "allOf": each, **schema}
    if all(set(choice) == {"required"} for choice in choices):
        *others, otherwise = choices
        condition = {"not": {"anyOf": others}} if len(others) > 1 else {"not": others[0]}
        return {**schema, "allOf": [*schema.get("allOf", []), {"if": condition, "then": otherwise}]}
    return {"anyOf": choices, **schema}


def _chosen_by_word(schema: dict[str, Any], defs: Mapping[str, Any]) -> dict[str, Any]:
    """One form follows from `shape` or `kind`."""
    discriminator = schema.pop("discriminator")
    schema.pop("oneOf")
    word, forms = discriminator["propertyName"], discriminator["mapping"]
    default_form = forms.get(_DEFAULT_KINDS.get(word))
    table: dict[str, Any] = {
        "properties": {
            word: {"enum": list(forms), "description": f"{word}: one of {', '.join(forms)}"},
            **_describe_keys(word, [defs[place.rpartition("/")[2]] for place in forms.values()]),
        },
        **_OPEN,
        "required": [] if default_form else [word],
        "allOf": [
            {"if": {"properties": {word: {"const": name}}, "required": [word]}, "then": {"$ref": place}}
            for name, place in forms.items()
        ],
    }
    if not default_form:
        return {"type": "object", **table, **schema}
    said = [{"required": [key]} for key in (word, *_KINDS_OF_KEYS)]
    table["allOf"].append({"if": {"not": {"anyOf": said}}, "then": {"$ref": default_form}})
    for key, name in _KINDS_OF_KEYS.items():
        condition = {"not": {"required": [word]}, "required": [key]}
        table["allOf"].append({"if": condition, "then": {"$ref": forms[name]}})
    return {
        "type": ["object", "string"],
        **_OPEN,
        "allOf": [{"if": {"type": "object"}, "then": table}],
        **schema,
    }


def _describe_keys(word: str, tables: list[Mapping[str, Any]]) -> dict[str, Any]:
    """Keys of all forms with what they are, for completion before the form is chosen; the form itself checks them."""
    keys: dict[str, Any] = {}
    for table in tables:
        for key, entry in table["properties"].items():
            if key != word:
                texts = {name: entry[name] for name in ("description", "examples") if name in entry}
                keys.setdefault(key, {**texts, **({} if entry.get("type") == "string" else _OPEN)})
    return keys
