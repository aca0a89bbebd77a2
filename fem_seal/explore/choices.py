"""Choices of the page that make another case: shapes by picture, materials, finish, requirement, form, units."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, get_args

from fem_seal.case.case import Case, load_case
from fem_seal.case.material_table import ALIASES, LIBRARY
from fem_seal.case.new_case import required_class
from fem_seal.case.roughness import HEIGHTS, ProcessName, read_roughness
from fem_seal.errors import InputError, NoLoadLeftError, SealError
from fem_seal.explore.screen import section_of
from fem_seal.files import own_tables
from fem_seal.units import System
from meshes import MeshesError

if TYPE_CHECKING:
    from fem_seal.explore.screen import CrossSection

_SHAPES = own_tables("shapes.toml")
# Bodies of the case by the rows of pictures.
ROWS = {"closure": "Closure", "seat": "Seat", "gasket": "Gasket"}
NONE, LEAK_RATE = "none", "leak rate"
# What a rated flow is given for, unless another class is chosen: the usual one of control valves with metal seats.
_OF_RATED_FLOW = "FCI 70-2 IV"


@dataclass(frozen=True)
class Choice:
    """A choice of the page.

    Parameters
    ----------
    key : str
        Unique on the page.
    label : str
        For people.
    value : str
        What the case has; empty for nothing.
    options : sequence of dict
        To choose from: label, value and words that are searched; empty where a text is typed.
    hint : str
        An example of what may be typed.
    """

    key: str
    label: str
    value: str
    options: Sequence[Mapping[str, str]] = field(default=())
    hint: str = ""


@dataclass(frozen=True)
class Picture:
    """A shape to choose: its key, name, picture, and whether the case has it."""

    key: str
    name: str
    source: str
    is_chosen: bool


def pictures_of(case: Case) -> dict[str, list[Picture]]:
    """Shapes to choose from, in rows.

    Parameters
    ----------
    case : Case
    """
    has = {"closure": case.closure.shape, case.key_of("seat"): case.lower.shape}
    return {
        row: [
            Picture(f"{row}.{shape}", words["name"], _draw_shape(row, shape), has.get(row) == shape)
            for shape, words in _SHAPES[row].items()
        ]
        for row in ROWS
    }


def choices_of(case: Case) -> dict[str, list[Choice]]:
    """All other choices by the heading that they stand under.

    Parameters
    ----------
    case : Case
    """
    lower = case.key_of("seat")
    materials = [
        Choice(f"{body}.material", f"material, {body}", name, _materials(name))
        for body, name in (("closure", case.closure.material.name), (lower, case.lower.material.name))
    ]
    system: list[dict[str, str]] = _options(System.__args__)  # type: ignore[attr-defined]
    return {
        "units": [Choice("report.units", "units", case.report.units or "field", system)],
        "surface": [*materials, *_fluid(case), *_finishes(case)],
        "demand": [*_requirement(case), *_form(case, lower)],
    }


def apply_choice(case: Case, key: str, value: str) -> Case:
    """The case after a choice.

    Parameters
    ----------
    case : Case
    key : str
        Of a `Choice` or a `Picture`.
    value : str
        Chosen or typed.

    Raises
    ------
    InputError
        If there is no such case; it says why.
    """
    row, _, shape = key.partition(".")
    if row in ROWS and shape in _SHAPES[row]:
        return _set_shape(case, row, shape)
    offers = {choice.key: choice for several in choices_of(case).values() for choice in several}
    if key not in offers or (offers[key].options and value not in {o["value"] for o in offers[key].options}):
        raise InputError.at(key, "is no choice of the page")
    if key == "requirement":
        return _set_requirement(case, value)
    if key == "requirement.rated_capacity" and not (case.requirement and case.requirement.standard):
        return case.replace_written({**required_class(str(case), _OF_RATED_FLOW), key: value.strip() or None})
    if key == "fluid.name":
        return _set_fluid(case, value)
    if key.endswith(" height"):
        path = key.removesuffix(" height")
        table = _face(case, path)
        height = next(height for height in HEIGHTS if height in table)
        return case.replace_written({f"{path}.{height}": None, f"{path}.{value}": table[height]})
    return case.replace_written({key: value.strip() or None})


def _options(values: Sequence[str]) -> list[dict[str, str]]:
    return [{"label": value, "value": value, "search": value} for value in values]


def _materials(name_of_case: str) -> list[dict[str, str]]:
    """The library with the words by which `fem-seal materials` finds them, and the case's own if it has another."""
    words: dict[str, list[str]] = {}
    for word, name in ALIASES.items():
        words.setdefault(name, []).append(word)
    options = [
        {"label": name, "value": name, "search": " ".join([name, material.condition, *words.get(name, ())])}
        for name, material in LIBRARY.items()
    ]
    return options if name_of_case in LIBRARY else [*_options([name_of_case]), *options]


def _fluid(case: Case) -> Iterator[Choice]:
    from leak import FLUIDS, GASES

    if case.fluid is not None and case.roughness is not None:
        name = case.fluid.name
        yield Choice("fluid.name", "fluid", name, _options(list(dict.fromkeys([name, *FLUIDS, *GASES]))))


def _set_fluid(case: Case, name: str) -> Case:
    """The case with another fluid of the library, at the temperature of its own."""
    from leak import is_gas

    entries = case.written.get("fluid", {})
    stays = ("temperature", "particles", *(("outlet_pressure",) if is_gas(name) else ()))
    table = dict.fromkeys(entries) | {"name": name} | {key: entries[key] for key in stays if key in entries}
    return case.replace_written({f"fluid.{key}": value for key, value in table.items()})


def _face(case: Case, path: str) -> Mapping[str, Any]:
    """The finish at a path of [roughness], as keys."""
    finish: Any = read_roughness(case.written["roughness"])
    for part in path.split(".")[1:]:
        finish = finish[part]
    return finish if isinstance(finish, Mapping) else {}


def _finishes(case: Case) -> Iterator[Choice]:
    """Height and process of each face whose finish is that of a drawing."""
    if case.roughness is None:
        return
    finishes: Any = read_roughness(case.written["roughness"])
    lower = "seat" if case.gasket is None else "lower flange"
    names = {"": "both faces", "seat": lower, "closure": "closure", "gasket": "gasket"}
    for key, name in names.items():
        table = finishes if not key else finishes.get(key)
        height = next((word for word in HEIGHTS if isinstance(table, Mapping) and word in table), None)
        if height is None:
            continue
        path = f"roughness.{key}".rstrip(".")
        yield Choice(f"{path} height", f"finish, {name}", height, _options(HEIGHTS))
        process, processes = table.get("process", "unspecified"), _options(get_args(ProcessName))
        yield Choice(f"{path}.process", f"process, {name}", process, processes)


def _requirement(case: Case) -> Iterator[Choice]:
    from leak.standards import STANDARDS, classes_of

    if case.roughness is None or case.fluid is None:
        return
    gas, rule = case.fluid.gas is not None, case.requirement
    classes = [f"{standard} {word}" for standard in STANDARDS for word in classes_of(standard, gas=gas)]
    class_name = " ".join(rule.standard_and_class) if rule and rule.standard_and_class else None
    value = NONE if rule is None else class_name or LEAK_RATE
    yield Choice("requirement", "requirement", value, _options(list(dict.fromkeys([NONE, value, *classes]))))
    entries = case.written.get("requirement", {})
    yield Choice(
        "requirement.leak_rate", "allowed leak rate", str(entries.get("leak_rate", "")), hint="1 ml/min"
    )
    flow = str(entries.get("rated_capacity", ""))
    yield Choice(
        "requirement.rated_capacity", "rated flow, for FCI\u00a070\u20112 II to IV", flow, hint="40 m^3/h"
    )


def _set_requirement(case: Case, value: str) -> Case:
    if value == NONE:
        return case.replace_written({"requirement": None})
    if value == LEAK_RATE:
        return case
    return case.replace_written({**required_class(str(case), value), "requirement.leak_rate": None})


def _form(case: Case, lower: str) -> Iterator[Choice]:
    """Roundness of both faces, where the case has nothing else there."""
    if lower == "gasket":
        return
    form = case.written.get("form", {})
    for body in ("closure", "seat"):
        table = form.get(body, {})
        if not table or "tolerance" in table:
            tolerance = str(table.get("tolerance", ""))
            yield Choice(f"form.{body}.tolerance", f"roundness, {body}", tolerance, hint="round")


def _scale_lengths(entry: Any, factor: float) -> Any:
    """Lengths of a table times a factor, as they would be written."""
    if isinstance(entry, Mapping):
        return {key: _scale_lengths(part, factor) for key, part in entry.items()}
    if isinstance(entry, list):
        return [_scale_lengths(part, factor) for part in entry]
    number, _, unit = str(entry).partition(" ")
    return f"{float(number) * factor:.4g} mm" if unit == "mm" else entry


def _tables(row: str, shape: str, factor: float = 1.0) -> dict[str, dict[str, Any]]:
    """Both bodies of a shape and of the one that it is shown with."""
    words = _SHAPES[row][shape]
    table, partner = {"shape": shape, **words["table"]}, words["with"]
    if row == "gasket":
        tables = {"closure": _SHAPES["flange"][partner], "gasket": table}
    else:
        opposite = "seat" if row == "closure" else "closure"
        tables = {row: table, opposite: {"shape": partner, **_SHAPES[opposite][partner]["table"]}}
    return {body: _scale_lengths(table, factor) for body, table in tables.items()}


@cache
def _case_of_shape(row: str, shape: str) -> Case:
    """A case with a shape, of usual dimensions."""
    inner = {"load": {"fluid_pressure": "1 bar", "applied_force": "10 kN", "pressure_side": "inner"}}
    tables = {body: {**table, "material": "steel"} for body, table in _tables(row, shape).items()}
    return load_case({**tables, "interface": {"law": "smooth"}, **inner})


def _set_shape(case: Case, row: str, shape: str) -> Case:
    """The case with another shape: the other body stays if they fit together, else both have usual dimensions.

    The circle of first touch, loads, materials and surfaces stay; a force that would not close the seal is doubled to
    what does.
    """
    lower = case.key_of("seat")
    materials = {
        body: case.written[key]["material"]
        for body, key in (("closure", "closure"), ("seat", lower), ("gasket", lower))
    }
    both = _tables(
        row, shape, case.initial_contact_radius / _case_of_shape(row, shape).initial_contact_radius
    )
    new = {body: {**table, "material": materials[body]} for body, table in both.items()}
    change = {row: new[row]}
    fits = row == lower or (row == "closure" and lower == "seat")
    failure: Exception | None = None
    for tables in (change, new) if fits else (new,):
        removals = {
            body: None for body in ("seat", "gasket") if body not in {lower, *tables} or _ends(body, tables)
        }
        try:
            return _close_seal(case, {**removals, **tables})
        except (SealError, MeshesError, ValueError) as error:
            failure = error
    raise failure if isinstance(failure, InputError) else InputError.at(row, str(failure))


def _ends(body: str, tables: Mapping[str, Any]) -> bool:
    return {"seat": "gasket", "gasket": "seat"}[body] in tables


def _close_seal(case: Case, tables: Mapping[str, Any]) -> Case:
    """The case with other bodies, and with a force that closes them."""
    bodies = dict(tables)
    if "gasket" in bodies and bodies["gasket"] is not None:
        bodies |= {"load.pressure_side": "inner", "load.closing": None}
    roughness = case.written.get("roughness")
    part, other = ("gasket", "seat") if bodies.get("gasket") else ("seat", "gasket")
    if isinstance(roughness, Mapping) and other in roughness and other in tables and tables[other] is None:
        bodies |= {f"roughness.{other}": None, f"roughness.{part}": roughness[other]}
    try:
        sealed_case = case.replace_written(bodies)
    except NoLoadLeftError:
        area = math.pi * case.initial_contact_radius**2
        bodies["load.applied_force"] = f"{2 * area * max(case.load.fluid_pressure):.3g} N"
        sealed_case = case.replace_written(bodies)
    _ = sealed_case.contact
    return sealed_case


# Colours of the pictures, fit for light and dark.
_CLOSURE, _SEAT, _LINE = "#8fb4dd", "#d3b98c", "#5b6675"


@cache
def _draw_shape(row: str, shape: str) -> str:
    """A small section of a shape with its partner, as the source of an image."""
    case = _case_of_shape(row, shape)
    section: CrossSection = section_of(case)
    r0 = section.initial_contact_radius
    wide, high = 1.5 * r0, 1.0 * r0
    colours = (_CLOSURE, _SEAT) if row == "closure" else (_CLOSURE + "66", _SEAT)
    bodies = "".join(
        f'<path d="{_path(ring, side)}" fill="{colour}" stroke="{_LINE}" stroke-width="{0.03 * r0:.3g}"/>'
        for colour, rings in zip(colours, section.rings, strict=True)
        for ring in rings
        for side in (1, -1)
    )
    box = f"{-wide:.5g} {-high - (section.middle or 0.0):.5g} {2 * wide:.5g} {2 * high:.5g}"
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">{bodies}</svg>'
    return f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"


def _path(ring: Sequence[tuple[float, float]], side: int) -> str:
    return "M" + "L".join(f"{side * r:.5g},{-z:.5g}" for r, z in ring) + "Z"
