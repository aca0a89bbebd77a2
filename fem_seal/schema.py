"""JSON Schema of the case file."""

from __future__ import annotations

from typing import Any


def case_schema() -> dict[str, Any]:
    """JSON Schema of what may stand in a case file.

    Returns
    -------
    dict
        Draft 2020-12. Ranges of quantities and contradictions between tables are beyond a schema; `load_case`
        checks them.

    Examples
    --------
    >>> sorted(case_schema()["required"])
    ['closure', 'load', 'seat']
    """
    from fem_seal.case import Case

    schema = _as_written(Case.model_json_schema(mode="validation"))
    schema["description"] = 'One seal with its loads; quantities are texts with units, such as "20 mm".'
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "fem-seal case", **schema}


def _as_written(schema: dict[str, Any]) -> dict[str, Any]:
    """Schema of the file instead of the models: TOML has no null, and titles would only repeat the keys."""
    cleaned: dict[str, Any] = {}
    for key, value in schema.items():
        if key == "title" and isinstance(value, str):
            continue
        if key == "default" and (value is None or isinstance(value, dict)):
            continue
        if isinstance(value, dict):
            cleaned[key] = _as_written(value)
        elif isinstance(value, list):
            cleaned[key] = [_as_written(one) if isinstance(one, dict) else one for one in value]
        else:
            cleaned[key] = value
    choices = [one for one in cleaned.get("anyOf", []) if one != {"type": "null"}]
    if len(choices) == 1:
        del cleaned["anyOf"]
        return {**choices[0], **cleaned}
    return cleaned
