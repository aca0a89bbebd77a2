"""JSON Schema of a study file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fem_seal.case.schema import as_schema
from fem_seal.output.columns import LEAK_COLUMNS
from fem_seal.studies.parameters import DISTRIBUTIONS, RANGE_KEYS
from fem_seal.studies.tables import StudyTables


def study_schema() -> dict[str, Any]:
    """JSON Schema of what may stand in a study file.

    Returns
    -------
    dict
        Draft 2020-12. Which entries a case has, and what may stand there, is beyond a schema; `load_study` checks it.

    Examples
    --------
    >>> study_schema()["required"]
    ['base']
    """
    schema = StudyTables.model_json_schema(mode="validation")
    schema["description"] = (
        "One case turned into many; entries of the case are named by their path, seat.angle."
    )
    schema["properties"]["parameters"]["additionalProperties"] = _parameter()
    schema["properties"]["responses"]["items"] = {"enum": list(LEAK_COLUMNS)}
    return as_schema("fem-seal study", schema)


def _parameter() -> dict[str, Any]:
    """A list of levels; as a table a range, a distribution, or the paths below the one that is its key."""
    limits = {"num": {"type": "integer", "minimum": 2}, "spacing": {"enum": ["linear", "log"]}}
    one_of_them = [
        {
            "if": {"properties": {"distribution": {"const": name}}},
            "then": _only({key: {} for key in ("distribution", *keys)}, keys),
        }
        for name, (keys, _) in DISTRIBUTIONS.items()
    ]
    distribution = {"properties": {"distribution": {"enum": list(DISTRIBUTIONS)}}, "allOf": one_of_them}
    return {
        "type": ["array", "object"],
        "additionalProperties": True,
        "allOf": [
            {"if": {"type": "object", "required": ["distribution"]}, "then": distribution},
            {
                "if": {"type": "object", "required": ["start"]},
                "then": _only({key: limits.get(key, {}) for key in RANGE_KEYS}, RANGE_KEYS[:3]),
            },
        ],
    }


def _only(properties: dict[str, Any], required: Sequence[str]) -> dict[str, Any]:
    return {"properties": properties, "required": list(required), "additionalProperties": False}
