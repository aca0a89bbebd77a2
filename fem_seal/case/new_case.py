"""Cases to begin with: commented templates, and changed entries that leave the comments as they are."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from fem_seal.case.case import Case, load_case
from fem_seal.case.drawing_words import partner
from fem_seal.case.fields import shown
from fem_seal.case.messages import nearest
from fem_seal.errors import InputError, Problem
from fem_seal.files import TomlError, parse_toml

TEMPLATES = ("ball-valve", "check-valve", "relief-valve", "needle", "flat-seat", "knife-edge")
SCHEMA_FILE = "fem-seal.schema.json"

_ENTRY = re.compile(r"(?P<key>[\w.]+) = (?P<value>.*?)(?P<comment>\s+#.*)?")
_SCHEMA_LINE = "#:schema "


@dataclass(frozen=True)
class Question:
    """What a new case is asked for.

    Parameters
    ----------
    name : str
        Name of its option on the command line.
    paths : tuple of str
        Where the answer may stand; the first that a template has is meant.
    words : str
        What is asked.
    """

    name: str
    paths: tuple[str, ...]
    words: str


QUESTIONS = (
    Question("title", ("title",), "title of the report"),
    Question("diameter", ("closure.diameter", "closure.outer_diameter"), "diameter of the closure"),
    Question("bore", ("seat.bore_diameter", "seat.land_inner_diameter"), "diameter of the bore"),
    Question(
        "included-angle", ("seat.included_angle", "closure.included_angle"), "included angle of the cone"
    ),
    Question("closure-material", ("closure.material",), "material of the closure"),
    Question("seat-material", ("seat.material",), "material of the seat"),
    Question("ra", ("roughness.Ra", "roughness.seat.Ra"), "Ra on the drawing"),
    Question("process", ("roughness.process", "roughness.seat.process"), "process that made the face"),
    Question("fluid", ("fluid.name",), "fluid"),
    Question("pressure", ("load.fluid_pressure",), "fluid pressure, one or several with commas"),
    Question("applied-force", ("load.applied_force",), "closing force of spring or actuator"),
    Question("leak-rate", ("requirement.leak_rate",), "largest allowed leak rate"),
    Question("class", ("requirement.class",), "required leakage class"),
)


def template(name: str) -> str:
    """Text of a template.

    Parameters
    ----------
    name : str
        One of `TEMPLATES`.

    Raises
    ------
    InputError
        If there is none of this name.

    Examples
    --------
    >>> template("ball-valve").splitlines()[0]
    '#:schema ../case.schema.json'
    """
    if name not in TEMPLATES:
        near = nearest(name, TEMPLATES)
        hint = f"; do you mean {near}?" if near else ""
        raise InputError(
            Problem(
                "--template", f"must be {', '.join(TEMPLATES[:-1])} or {TEMPLATES[-1]}{hint}", shown(name)
            )
        )
    return files("fem_seal").joinpath("templates", "cases", f"{name}.toml").read_text(encoding="utf-8")


def about(name: str) -> str:
    """What a template is, in a sentence.

    Examples
    --------
    >>> about("flat-seat")
    'Flat lapped seat: a disc on a raised flat land, as of a gate, globe or safety valve.'
    """
    return template(name).splitlines()[1].removeprefix("# ")


def with_schema(text: str, place: str) -> str:
    r"""The text of a case with the line that tells an editor where the schema is.

    Examples
    --------
    >>> with_schema("title = 'a'", "./fem-seal.schema.json")
    "#:schema ./fem-seal.schema.json\ntitle = 'a'"
    """
    first, _, rest = text.partition("\n")
    return f"{_SCHEMA_LINE}{place}\n" + (rest if first.startswith(_SCHEMA_LINE) else text)


def asked(text: str) -> list[tuple[Question, str, str]]:
    """Questions that a text has an entry for, with path and present value of it as it is answered."""
    known = {path: _plain(entry["value"]) for path, entry in _entries(text).items()}
    found = []
    for question in QUESTIONS:
        path = next((path for path in question.paths if path in known), None)
        if path is not None:
            found.append((question, path, known[path]))
    return found


def with_entries(text: str, entries: Mapping[str, str]) -> str:
    r"""The text of a case with other values at some paths; all comments stay.

    Parameters
    ----------
    text : str
        With one entry on each line.
    entries : mapping
        From dotted paths to values as TOML (``'{ name = "brass" }'``, ``'["1 bar", "2 bar"]'``) or, for a text, without
        its quotes (``'20 bar'``).

    Examples
    --------
    >>> print(with_entries('[load]\nfluid_pressure = "1 bar"   # water', {"load.fluid_pressure": "16 bar"}))
    [load]
    fluid_pressure = "16 bar"  # water
    """
    lines = text.splitlines()
    for path, value in entries.items():
        table, _, key = path.rpartition(".")
        where = _entries("\n".join(lines))
        other = f"{table}.{partner(key)}".lstrip(".") if partner(key) else None
        at = where.get(path) or where.get(other or "")
        if at is not None:
            comment = at["comment"] or ""
            written = f"{key} = {_toml(value)}"
            if comment:
                # the comments stay below each other where there is room
                column = len(lines[at["line"]]) - len(comment.lstrip())
                written = f"{written:<{max(column - 2, 0)}}  {comment.lstrip()}"
            lines[at["line"]] = written
            continue
        ends = [one["line"] for known, one in where.items() if known.rpartition(".")[0] == table]
        if ends:
            lines.insert(max(ends) + 1, f"{key} = {_toml(value)}")
        else:
            lines += ["", f"[{table}]", f"{key} = {_toml(value)}"]
    return "\n".join(lines) + ("\n" if text.endswith("\n") else "")


def read_text_case(text: str) -> Case:
    """The case in a text, checked.

    Raises
    ------
    InputError
        It lists every problem.
    """
    try:
        return load_case(parse_toml(text))
    except TomlError as error:
        raise InputError(Problem("", str(error))) from None


def _entries(text: str) -> dict[str, dict[str, Any]]:
    """Entries by their path: value and comment as they are written, and the number of the line."""
    found: dict[str, dict[str, Any]] = {}
    table = ""
    for number, line in enumerate(text.splitlines()):
        heading = re.match(r"\[([\w.]+)\]", line)
        entry = _ENTRY.fullmatch(line)
        if heading:
            table = heading[1]
        elif entry:
            path = f"{table}.{entry['key']}".lstrip(".")
            found[path] = {"value": entry["value"], "comment": entry["comment"], "line": number}
    return found


def _plain(value: str) -> str:
    """A value as people answer: texts without quotes, a list of them with commas."""
    read = parse_toml(f"value = {value}")["value"]
    if isinstance(read, list) and all(isinstance(one, str) for one in read):
        return ", ".join(read)
    return read if isinstance(read, str) else value


def _toml(value: str) -> str:
    """A value as TOML: itself if it is, several texts as a list, any other text in quotes."""
    try:
        parse_toml(f"value = {value}")
    except TomlError:
        parts = [part.strip() for part in value.split(",")]
        quoted = [_quoted(part) for part in parts]
        return f"[{', '.join(quoted)}]" if len(parts) > 1 else quoted[0]
    return value


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
