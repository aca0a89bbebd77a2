"""What the program itself knows of its keys, columns and findings: explained by name, and found by words."""

from __future__ import annotations

import difflib
import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from pydantic import BaseModel

from fem_seal.case.case import Case
from fem_seal.case.fields import about, key_of, values_of
from fem_seal.case.material_table import LIBRARY, MaterialTable
from fem_seal.case.messages import toml
from fem_seal.case.new_case import TEMPLATES
from fem_seal.case.new_case import about as about_template
from fem_seal.case.notation import choices, same_entry, tables_of
from fem_seal.errors import InputError
from fem_seal.files import own_tables, problem
from fem_seal.output.columns import COLUMNS
from fem_seal.output.tables import MEANINGS
from fem_seal.seal.findings import Level
from leak import FLUIDS, GASES

# Hits of a search, letters of each, and names that are offered for one that is not known.
_HITS, _LETTERS, _NEAR = 6, 400, 5
# What an assistant can write into a case comes before what results and messages say of it.
_WEIGHTS = {"template": 2.0, "key": 1.5}
_LEVELS = {
    Level.VALID: "the theory covers the load; the interval says how well the leak rate is known",
    Level.DOUBTFUL: "uncertain: the reasons say why, and the interval is wider for them where that is known",
    Level.OUTSIDE: "nothing may be claimed of the leak rate: an assumption of the theory does not hold",
}


@dataclass(frozen=True)
class Entry:
    """One thing that can be looked up.

    Parameters
    ----------
    kind : str
        "key", "column", "validity", "message", "word", "template", "material" or "fluid".
    name, text : str
    """

    kind: str
    name: str
    text: str


def explain(kind: str, name: str) -> list[Entry]:
    """What a key, a column or a statement about validity means.

    Parameters
    ----------
    kind : str
        "key", "column" or "validity".
    name : str
        Of a key its path, or its last word; of a column its name with or without unit; of a statement its words.

    Raises
    ------
    InputError
        If there is none; it names the nearest.
    """
    entries = [entry for entry in _entries() if entry.kind == kind]
    wanted = same_entry(name) if kind == "key" else name
    found = [entry for entry in entries if wanted.lower() == entry.name.lower()]
    if not found and kind != "validity":
        found = [
            entry
            for entry in entries
            if re.search(rf"(^|\.){re.escape(wanted)}(_[A-Za-z0-9_]+)?$", entry.name)
        ]
    if not found and kind == "validity":
        found = _best(entries, name, 1)
    if not found:
        names = [entry.name for entry in entries]
        near = difflib.get_close_matches(name, names, _NEAR, 0.3) or names[:_NEAR]
        raise InputError(problem("mcp_unknown", kind=kind, name=name, near=", ".join(near)))
    return found[:_HITS]


def search(words: str) -> list[Entry]:
    """Entries that fit some words best, the best first, with shortened texts.

    Parameters
    ----------
    words : str
    """
    return [Entry(hit.kind, hit.name, hit.text[:_LETTERS]) for hit in _best(_entries(), words, _HITS)]


def _best(entries: tuple[Entry, ...] | list[Entry], words: str, most: int) -> list[Entry]:
    """Those with the rarest of the words; one in the name counts twice."""
    tokens = set(_tokens(words))
    bags = [(set(_tokens(entry.name)), set(_tokens(entry.text))) for entry in entries]
    counts = Counter(token for name, text in bags for token in tokens & (name | text))
    weights = {token: math.log(1 + len(entries) / count) for token, count in counts.items()}
    scores = [
        _WEIGHTS.get(entry.kind, 1.0)
        * sum(weight * ((token in name) + (token in name | text)) for token, weight in weights.items())
        for entry, (name, text) in zip(entries, bags, strict=True)
    ]
    order = sorted(range(len(entries)), key=lambda n: -scores[n])
    return [entries[n] for n in order[:most] if scores[n] > 0.0]


def _tokens(text: str) -> Iterator[str]:
    for word in re.findall(r"[a-z0-9]{3,}", text.lower()):
        # plurals find singulars
        yield word.removesuffix("s") if len(word) > 3 else word


@cache
def _entries() -> tuple[Entry, ...]:
    return tuple(_all_entries())


def _all_entries() -> Iterator[Entry]:
    texts: dict[str, dict[str, None]] = {}
    for path, text in _keys(Case):
        texts.setdefault(path, {})[text] = None
    yield from (Entry("key", path, "\n".join(filter(None, each))) for path, each in texts.items())
    for name, column in COLUMNS.items():
        where = f" In results of cases with {' and '.join(column.belongs)}." if column.belongs else ""
        yield Entry("column", name, f"{column.meaning.strip()}.{where}")
    for table, meanings in MEANINGS.items():
        yield from (Entry("column", f"{table}.{name}", str(text).strip()) for name, text in meanings.items())
    yield from (Entry("validity", str(level), text) for level, text in _LEVELS.items())
    for kind, file in (("validity", "findings.toml"), ("message", "problems.toml")):
        for name, entry in own_tables(file).items():
            if "says" in entry:
                parts = (entry.get(part, "") for part in ("says", "remedy"))
                title = _without_values(entry.get("label", entry.get("key", name)))
                text = ". ".join(filter(None, map(_without_values, parts)))
                yield Entry(kind, name if "…" in title else title, text)
    yield from (
        Entry("word", each["term"], each["meaning"]) for each in own_tables("words.toml")["definitions"]
    )
    yield from (Entry("template", name, about_template(name)) for name in TEMPLATES)
    yield from (Entry("material", name, "a material of the library, for material = ...") for name in LIBRARY)
    yield from (
        Entry("fluid", name, "a fluid of the library, for fluid.name = ...") for name in (*FLUIDS, *GASES)
    )


def _without_values(text: str) -> str:
    """A text without what is filled in where it is said."""
    return re.sub(r"\{%.*?%\}", "", re.sub(r"\{\{.*?\}\}", "…", text)).strip()


def _keys(table: type[BaseModel], path: str = "") -> Iterator[tuple[str, str]]:
    """Paths of all keys of a case with what they mean; those of the forms of a table below each other."""
    for name, field in table.model_fields.items():
        place, inner = f"{path}.{name}".lstrip("."), tables_of(field)
        yield place, _meaning(table, name, field)
        for each in inner:
            yield place, about(each).partition("\n")[0]
            # a material is the same everywhere
            if each is not MaterialTable or path == "closure":
                yield from _keys(each, place)


def _meaning(table: type[BaseModel], name: str, field: Any) -> str:
    key, words = key_of(table, name), choices(table, name)
    marker = next(values_of(field), None)
    parts = (
        key.meaning,
        f"allowed: {', '.join(words)}" if words else f"allowed: {marker.range}" if marker else "",
        f"default: {key.default}" if key.default else "",
        f"example: {name} = {toml(key.example)}" if key.example is not None else "",
    )
    return "; ".join(filter(None, parts))
