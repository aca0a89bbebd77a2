"""Cases to begin with: commented templates, and changed entries that leave the comments as they are."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Mapping, Sequence
from collections.abc import Set as AbstractSet
from contextlib import suppress
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from fem_seal.case.case import Case, load_case
from fem_seal.case.fields import show
from fem_seal.case.messages import nearest
from fem_seal.case.notation import partner, without_reference
from fem_seal.errors import InputError, QuantityError
from fem_seal.files import TomlError, own_tables, parse_toml, problem
from fem_seal.units import DECIMAL_COMMA, parse_quantity, split_quantities

TEMPLATES = (
    "ball-valve",
    "check-valve",
    "relief-valve",
    "needle",
    "flat-seat",
    "knife-edge",
    "flange",
    "gasket",
)
SCHEMA_FILE = "fem-seal.schema.json"

_ENTRY = re.compile(r"(?P<key>[\w.]+) = (?P<value>.*?)(?P<comment>\s+#.*)?")
_SCHEMA_LINE = "#:schema "
# Keys of names, which may be numbers and have commas.
_TEXTS = re.compile(r"(^|\.)(title|material|name|process)$")


@dataclass(frozen=True)
class Question:
    """What a new case is asked for.

    Parameters
    ----------
    name : str
        Name of its option on the command line.
    paths : sequence of str
        Where the answer may stand; the first that a template has is meant.
    words : str
        What is asked.
    """

    name: str
    paths: Sequence[str]
    words: str


QUESTIONS = tuple(Question(name, **entry) for name, entry in own_tables("questions.toml").items())


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
        likely = nearest(name, TEMPLATES)
        hint = f"; do you mean {likely}?" if likely else ""
        names = {"names": ", ".join(TEMPLATES[:-1]), "last": TEMPLATES[-1]}
        raise InputError(problem("template", **names, hint=hint, value=show(name)))
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


def find_questions(text: str) -> list[tuple[Question, str, str]]:
    """Questions that a text has an entry for, with path and present value of it as it is answered."""
    values = {path: _plain(entry["value"]) for path, entry in _entries(text).items()}
    places = [(each, next((path for path in each.paths if path in values), None)) for each in QUESTIONS]
    return [(question, path, values[path]) for question, path in places if path is not None]


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
        lines_by_path = _entries("\n".join(lines))
        partner_path = f"{table}.{partner(key)}".lstrip(".") if partner(key) else None
        at = lines_by_path.get(path) or lines_by_path.get(partner_path or "")
        if at is not None:
            comment = at["comment"] or ""
            new_line = f"{key} = {_toml(path, value)}"
            if comment:
                # the comments stay below each other where there is room
                column = len(lines[at["line"]]) - len(comment.lstrip())
                new_line = f"{new_line:<{max(column - 2, 0)}}  {comment.lstrip()}"
            lines[at["line"]] = new_line
            continue
        ends = [entry["line"] for name, entry in lines_by_path.items() if name.rpartition(".")[0] == table]
        if ends:
            lines.insert(max(ends) + 1, f"{key} = {_toml(path, value)}")
        else:
            lines += ["", f"[{table}]", f"{key} = {_toml(path, value)}"]
    return "\n".join(lines) + ("\n" if text.endswith("\n") else "")


_FINISH = re.compile(r"^\[roughness\][^\n]*\n(.*?)(?=^\[|\Z)", re.MULTILINE | re.DOTALL)


def with_own_finish(text: str, entries: Mapping[str, str]) -> tuple[str, dict[str, str]]:
    r"""A case and what changes in it, with a table for the finish of each face where one of them gets its own.

    Parameters
    ----------
    text : str
    entries : mapping
        See `with_entries`.

    Examples
    --------
    >>> text, entries = with_own_finish('[roughness]\nRa = "0.1 um"\n', {"roughness.seat.Ra": "0.4 um"})
    >>> print(with_entries(text, entries))
    [roughness.seat]
    Ra = "0.4 um"
    <BLANKLINE>
    [roughness.closure]
    Ra = "0.1 um"
    <BLANKLINE>
    """
    block, new_entries = _FINISH.search(text), dict(entries)
    faces = ("roughness.gasket" if "\n[gasket]" in text else "roughness.seat", "roughness.closure")
    if block is None or not any(path.rpartition(".")[0] in faces for path in entries):
        return text, new_entries
    for path in [entry_path for entry_path in entries if entry_path.rpartition(".")[0] == "roughness"]:
        value = new_entries.pop(path)
        for face in faces:
            new_entries.setdefault(f"{face}.{path.rpartition('.')[2]}", value)
    tables = "\n\n".join(f"[{face}]\n{block[1].rstrip()}" for face in faces)
    head, tail = text[: block.start()], text[block.end() :]
    return head + tables + ("\n\n" if tail else "\n") + tail, new_entries


# What grows with a valve: its lengths, and the force with the area that the fluid pressure acts on.
_LENGTHS = re.compile(r"(closure|seat|gasket)\.\w*(diameter|radius|width|height|recess)|leak\.nominal_size")
_FORCE = "load.applied_force"
# Number and unit.
_QUANTITY = re.compile(r"([-+\d.]+(?:[eE][-+]?\d+)?)\s*(.+)")


def scale_case(text: str, path: str, value: str, fixed_paths: Collection[str] = ()) -> str:
    r"""The text of a case with all dimensions in proportion to one of them.

    Forces grow with the square, so that they are to the fluid's force what they were.

    Parameters
    ----------
    text : str
    path : str
        Of the dimension that is given.
    value : str
        What it becomes, such as ``"8 mm"``; one that is no length changes nothing, and the check of the case says so.
    fixed_paths : collection of str
        Paths that stay as they are.

    Examples
    --------
    >>> print(scale_case('[seat]\nbore_diameter = "4 mm"\nedge_radius = "0.5 mm"', "seat.bore_diameter", "6 mm"))
    [seat]
    bore_diameter = "4 mm"
    edge_radius = "0.75 mm"
    """
    entries = {name: entry["value"] for name, entry in _entries(text).items()}
    if path not in entries or not _LENGTHS.fullmatch(path):
        return text
    try:
        factor = _length(value) / _length(_plain(entries[path]))
    except QuantityError:
        return text
    if not 0 < factor < math.inf or factor == 1.0:
        return text
    changes = {
        name: _times(_plain(text_value), factor if name != _FORCE else factor**2)
        for name, text_value in entries.items()
        if (_LENGTHS.fullmatch(name) or name == _FORCE) and name not in (path, *fixed_paths)
    }
    return with_entries(text, changes)


def for_angle(text: str, new_angle: str) -> str:
    """The text of a case whose ball, if it has one, touches a cone of another included angle on the circle of before.

    Parameters
    ----------
    text : str
    new_angle : str
        Included angle of the seat.
    """
    entries = {name: _plain(entry["value"]) for name, entry in _entries(text).items()}
    path, old_angle = "closure.diameter", entries.get("seat.included_angle")
    if entries.get("closure.shape") != "ball" or old_angle is None:
        return text
    try:
        old, new = (math.cos(0.5 * parse_quantity(angle, "angle")) for angle in (old_angle, new_angle))
    except QuantityError:
        return text
    return with_entries(text, {path: _times(entries[path], old / new)}) if new > 0 else text


def _length(text: str) -> float:
    from leak.standards import read_nominal_size

    return read_nominal_size(text) or parse_quantity(text, "length")


def _times(quantity: str, factor: float) -> str:
    """A text with a unit, times a factor, as it would be written."""
    value, unit = _QUANTITY.fullmatch(quantity.strip()).groups()  # type: ignore[union-attr]  # it has been read
    return f"{float(f'{float(value) * factor:.4g}'):.12g} {unit}"


def up_to(set_pressure: str) -> str | None:
    """Half, eight and nine tenths of a set pressure, for `with_entries`; None of what is no pressure.

    Parameters
    ----------
    set_pressure : str

    Examples
    --------
    >>> up_to("350 barg")
    '175 barg, 280 barg, 315 barg'
    """
    try:
        parse_quantity(without_reference(set_pressure), "pressure")
    except QuantityError:
        return None
    return ", ".join(_times(set_pressure, share) for share in (0.5, 0.8, 0.9))


def required_class(text: str, class_words: str) -> dict[str, str]:
    """Entries of [requirement] for a class that is given with or without its standard: "B", "FCI 70-2 V", "API 598".

    Parameters
    ----------
    text : str
        Of the case: its fluid and standard decide which classes there are.
    class_words : str

    Raises
    ------
    InputError
        If no standard has such a class for the fluid; it lists those that are.
    """
    from leak.standards import STANDARDS, classes_of, standard_named

    # what is required is what is asked for here
    tables = {name: table for name, table in _parse_tables(text).items() if name != "requirement"}
    fluid = load_case(tables).fluid
    gas = fluid is not None and fluid.gas is not None
    by_standard = {standard: classes_of(standard, gas=gas) for standard in STANDARDS}
    entry = _entries(text).get("requirement.standard")
    first = standard_named(_plain(entry["value"])) if entry else None
    words = class_words.strip()
    words_left = " ".join(re.sub(r"\b(class|rate)\b", "", words.lower()).split())
    for standard in sorted(by_standard, key=lambda standard: standard != first):
        for name in by_standard[standard]:
            rest = f" {words_left}".removesuffix(f" {name.lower()}").strip()
            if rest != words_left and (not rest or standard_named(rest) == standard):
                return {"requirement.standard": standard, "requirement.class": name}
        if standard_named(words) == standard:
            if len(by_standard[standard]) == 1:
                return {"requirement.standard": standard, "requirement.class": by_standard[standard][0]}
            classes = ", ".join(by_standard[standard])
            words_of = {"standard": standard, "classes": classes}
            raise InputError(problem("class_of_standard", **words_of, value=show(class_words)))
    listing = "; ".join(f"{standard}: {', '.join(names)}" for standard, names in by_standard.items() if names)
    words_of = {"fluid": "a gas" if gas else "a liquid", "listing": listing}
    raise InputError(problem("class_of_fluid", **words_of, value=show(class_words)))


def for_fluid(text: str, fixed: AbstractSet[str]) -> dict[str, str | None]:
    """Entries that follow from another fluid than the template's; None for one that goes.

    A temperature that is not given becomes that of the room, and a requirement that there is not for the fluid a leak
    rate: pressure times volume for a liquid, a class of a standard for gases alone.

    Parameters
    ----------
    text : str
        Of the case, with the fluid.
    fixed : set of str
        Paths that stay as they are.
    """
    changes: dict[str, str | None] = {}
    entries = _entries(text)
    if "fluid.temperature" in entries.keys() - fixed:
        changes["fluid.temperature"] = "20 degC"
    try:
        read_text_case(text)
    except InputError as error:
        if all(fault.key.startswith("requirement.") for fault in error.problems):
            changes |= dict.fromkeys(entries.keys() & {"requirement.standard", "requirement.class"} - fixed)
            if "requirement.leak_rate" not in fixed:
                changes["requirement.leak_rate"] = "0.1 ml/min"
    return {path: value for path, value in changes.items() if value is None or value != _value(entries, path)}


def _value(entries: Mapping[str, dict[str, Any]], path: str) -> str | None:
    return _plain(entries[path]["value"]) if path in entries else None


def without_entry(text: str, path: str) -> str:
    """The text of a case without the line of an entry."""
    at = _entries(text).get(path)
    lines = text.splitlines()
    return text if at is None else "\n".join(lines[: at["line"]] + lines[at["line"] + 1 :]) + "\n"


def with_options(
    text: str, name: str, options: Mapping[str, str], entries: Collection[str] = ()
) -> tuple[str, str]:
    """The text of a template with what was asked for, and what was changed beside it, in words.

    Parameters
    ----------
    text : str
    name : str
        Of the template.
    options : mapping
        From names of `QUESTIONS` to answers.
    entries : collection of str
        Other entries, ``KEY=VALUE``.

    Raises
    ------
    InputError
        If the template has no such entry, or an entry is none.
    """
    paths = {question.name: path for question, path, _ in find_questions(text)}
    # a template with a class also takes a leak rate; in one with a leak rate a class replaces it
    paths.setdefault("leak-rate", "requirement.leak_rate")
    paths.setdefault("class", "requirement.class")
    if "set-pressure" in paths:
        # a force in its place
        paths["applied-force"] = "load.applied_force"
    unknown = [key for key in options if key not in paths]
    if unknown:
        option_names = ", ".join(f"--{item.name}" for item in QUESTIONS if item.name in paths)
        raise InputError(problem("new_not_in_template", key=unknown[0], name=name, known=option_names))
    for key, value in options.items():
        if re.search(r"\d,\d", value) and not _TEXTS.search(paths[key]):
            raise InputError.at(f"--{key}", DECIMAL_COMMA, value)
    changes = {paths[key]: value for key, value in options.items() if key != "class"}
    for entry in entries:
        key, equals, value = entry.partition("=")
        if not (equals and key.strip() and value.strip()):
            raise InputError.at("--set", 'must be KEY=VALUE, such as seat.land_width="1 mm"', entry)
        changes[key.strip()] = value.strip()
    pressures = up_to(options.get("set-pressure", ""))
    if pressures is not None:
        # those of the template may be above it, or far below
        changes.setdefault("load.fluid_pressure", pressures)
    # the bore is scaled first; the closure may then get its own size
    size_path = next((paths[key] for key in ("bore", "diameter") if paths.get(key) in changes), None)
    if size_path is not None:
        text = scale_case(text, size_path, changes[size_path], fixed_paths=tuple(changes))
    if "included-angle" in options and "diameter" not in options:
        text = for_angle(text, options["included-angle"])
    old_values = {path: value for _, path, value in find_questions(text)}
    text, changes = with_own_finish(text, changes)
    text, told = with_entries(text, changes), ""
    if options.get("fluid") not in (None, old_values.get("fluid.name")):
        fixed = {*changes, *(("requirement.standard", "requirement.class") if "class" in options else ())}
        text, told = with_fluid_entries(text, fixed)
    if "class" in options:
        text = with_entries(text, required_class(text, options["class"]))
        if "leak-rate" not in options:
            text = without_entry(text, "requirement.leak_rate")
    return text, told


def with_fluid_entries(text: str, fixed: AbstractSet[str]) -> tuple[str, str]:
    """The text with what follows from its fluid, and that in words.

    Parameters
    ----------
    text : str
    fixed : set of str
        Paths that stay as they are.
    """
    follows = for_fluid(text, fixed)
    entries = {path: value for path, value in follows.items() if value is not None}
    told = ", ".join(f"{path} = {value}" for path, value in entries.items())
    text = with_entries(text, entries)
    for path in follows.keys() - entries.keys():
        text = without_entry(text, path)
    return text, f"With the fluid: {told}" if told else ""


def read_text_case(text: str) -> Case:
    """The case in a text, checked.

    Raises
    ------
    InputError
        It lists every problem.
    """
    return load_case(_parse_tables(text))


def _parse_tables(text: str) -> dict[str, Any]:
    try:
        return parse_toml(text)
    except TomlError as error:
        raise InputError.at("", str(error)) from None


def _entries(text: str) -> dict[str, dict[str, Any]]:
    """Entries by their path: value and comment as they are written, and the number of the line."""
    entries: dict[str, dict[str, Any]] = {}
    table = ""
    for number, line in enumerate(text.splitlines()):
        heading = re.match(r"\[([\w.]+)\]", line)
        entry = _ENTRY.fullmatch(line)
        if heading:
            table = heading[1]
        elif entry:
            path = f"{table}.{entry['key']}".lstrip(".")
            entries[path] = {"value": entry["value"], "comment": entry["comment"], "line": number}
    return entries


def _plain(value: str) -> str:
    """A value as people answer: texts without quotes, a list of them with commas."""
    content = parse_toml(f"value = {value}")["value"]
    if isinstance(content, list) and all(isinstance(item, str) for item in content):
        return ", ".join(content)
    return content if isinstance(content, str) else value


def _toml(path: str, value: str) -> str:
    """A value as TOML: itself if it is, several quantities as a list, any other text and names in quotes."""
    is_text = _TEXTS.search(path)
    with suppress(TomlError):
        content = parse_toml(f"value = {value}")["value"]
        if not is_text or isinstance(content, (str, dict)):
            return value
    parts = [value] if is_text else split_quantities(value)
    texts = [json.dumps(part, ensure_ascii=False) for part in parts]
    return f"[{', '.join(texts)}]" if len(parts) > 1 else texts[0]
