"""How drawings and data sheets write what a case has in radii, angles and pressure differences.

A drawing has a diameter for every radius of a body, and the included angle for the angle of a cone. A data sheet has
gauge and absolute pressures: barg, psig, bara, psia; a case has pressure differences across the seal, and one absolute
pressure, that at the outlet of a gas. Both belong to the text of a case file.

"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from fem_seal.case.fields import Quantity, Table, quantities_of, show
from fem_seal.case.material_table import MaterialTable
from fem_seal.errors import InputError, Problem, QuantityError
from fem_seal.files import problem
from fem_seal.materials import Material
from fem_seal.units import DIMENSIONS, NUMBER, exact_quantity, parse_quantity
from fem_seal.wording import Words
from leak.standards import STANDARD_PRESSURE

# Other keys that say the same: one takes the place of the other.
_PARTNERS = {"angle": "included_angle", "applied_force": "set_pressure"}
_PARTNERS |= {partner_key: key for key, partner_key in _PARTNERS.items()}
# A rounding has an R on every drawing.
_ROUNDING = "edge_radius"
_BODIES = ("closure", "seat", "gasket")


@dataclass(frozen=True)
class Word:
    """What may stand in a table instead of one of its keys.

    Parameters
    ----------
    name : str
        The word: "bore_diameter", "included_angle".
    key : str
        The key that it stands for: "bore_radius", "angle".
    marker : Quantity
        What reads and bounds it.
    """

    name: str
    key: str
    marker: Quantity

    @property
    def meaning(self) -> str:
        """In words, for schema and documentation."""
        return (
            f"twice {self.key}"
            if self.marker.dimension == "length"
            else f"included angle of the cone, from face to face across the axis: 180 deg minus twice {self.key}"
        )

    @property
    def example(self) -> str:
        """How it is written."""
        return "40 mm" if self.marker.dimension == "length" else "90 deg"

    def in_key(self, text: Any) -> str:
        """What to write at the key instead; ValueError if the text may not stand here.

        Calculated before it is rounded: "40.1 mm" in diameter is exactly "20.05 mm" in radius.
        """
        self.marker.read(text)
        half = exact_quantity(text, self.marker.dimension) / 2
        if self.marker.dimension == "angle":
            half = exact_quantity("90 deg", "angle") - half
        return f"{float(half)!r} {DIMENSIONS[self.marker.dimension].si_unit}"

    def of_key(self, value: float) -> float:
        """Value of the word [SI] where the key has this value."""
        return 2 * value if self.marker.dimension == "length" else math.pi - 2 * value


@cache
def words_of(table: type[BaseModel]) -> Mapping[str, Word]:
    """Words that may stand in a table, by name.

    Parameters
    ----------
    table : type of a table of the case

    Examples
    --------
    >>> from fem_seal.case.shapes import ConicalSeat
    >>> list(words_of(ConicalSeat))
    ['outer_diameter', 'included_angle', 'bore_diameter', 'face_diameter']
    """
    words = {}
    for key, field in table.model_fields.items() if "shape" in table.model_fields else ():
        name, marker = partner(key), next(quantities_of(field), None)
        if name is not None and marker is not None and key != _ROUNDING:
            words[name] = Word(name, key, _double_range(marker))
    return words


def _double_range(marker: Quantity) -> Quantity:
    """Range of a diameter or an included angle; both are twice as wide as that of radius and angle."""
    low, high = (
        f"{2 * float(number):g} {unit}" for number, unit in map(str.split, (marker.low, marker.high))
    )
    return Quantity(marker.dimension, low, high, marker.exclusive)


def partner(key: str) -> str | None:
    """The other word for a dimension: "bore_diameter" of "bore_radius" and the reverse; None if it has no other.

    Examples
    --------
    >>> partner("radius"), partner("included_angle"), partner("height")
    ('diameter', 'angle', None)
    """
    if key in _PARTNERS:
        return _PARTNERS[key]
    stem, _, ending = key.rpartition("_")
    partner_ending = {"radius": "diameter", "diameter": "radius"}.get(ending)
    return None if partner_ending is None else f"{stem}_{partner_ending}" if stem else partner_ending


def same_entry(path: str) -> str:
    """Path of the key for a path that may end in a drawing's word: "seat.bore_radius" for "seat.bore_diameter"."""
    body, _, key = path.rpartition(".")
    if body.split(".")[0] in _BODIES and key.endswith(("diameter", "included_angle")):
        return f"{body}.{partner(key)}"
    return path


def said_twice(paths: Mapping[str, Any] | list[str]) -> tuple[str, str] | None:
    """Two of some paths that are words for the same entry; None if there are none."""
    paths_by_entry: dict[str, str] = {}
    for path in paths:
        entry = same_entry(str(path))
        if entry in paths_by_entry:
            return paths_by_entry[entry], str(path)
        paths_by_entry[entry] = str(path)
    return None


def in_keys(
    body: str, table: type[BaseModel], entries: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Problem]]:
    """Entries of a body with keys in place of the drawing's words, and what is wrong with these.

    Parameters
    ----------
    body : str
        "closure", "seat", "gasket", or a table in a list of one, "seat.lands[1]".
    table : type of the table that reads them
    entries : mapping
        As they stand in the case file.

    Examples
    --------
    >>> from fem_seal.case.shapes import ConicalSeat
    >>> in_keys("seat", ConicalSeat, {"shape": "cone", "included_angle": "90 deg", "bore_diameter": "24 mm"})
    ({'shape': 'cone', 'angle': '0.7853981633974483 rad', 'bore_radius': '0.012 m'}, [])
    """
    words, new_entries, faults = words_of(table), {}, []
    for name, value in entries.items():
        if name not in words:
            new_entries[name] = value
            continue
        word = words[name]
        if word.key in entries:
            values = {"key": f"{body}.{name}", "word": name, "meaning": word.meaning, "value": show(value)}
            faults.append(problem("said_twice", **values, other=word.key, there=show(entries[word.key])))
            continue
        try:
            new_entries[word.key] = word.in_key(value)
        except (QuantityError, ValueError) as error:
            faults.append(Problem(f"{body}.{name}", str(error), show(value)))
            # what stands there is not known, but something does
            new_entries[word.key] = _example_value(table, word.key)
    return new_entries, faults


def as_written(problem: Problem, tables: Mapping[str, Any]) -> Problem:
    """What is wrong with a radius or angle, at the drawing's word if that is what stands in the case.

    Parameters
    ----------
    problem : Problem
        At a key of closure, seat or gasket, or anywhere else.
    tables : mapping
        The case as it was written.
    """
    body, _, key = problem.key.partition(".")
    entries, word = tables.get(body), partner(key)
    if body not in _BODIES or word is None or not isinstance(entries, Mapping) or word not in entries:
        return problem
    in_key = Words("{{ problem }}", {"problem": replace(problem, key=key, remedy="")})
    return replace(problem, key=f"{body}.{word}", says=in_key, given=show(entries[word]))


def _example_value(table: type[BaseModel], key: str) -> str:
    """Something that may stand at a key."""
    marker = next(quantities_of(table.model_fields[key]))
    low, high = (parse_quantity(text, marker.dimension) for text in (marker.low, marker.high))
    return f"{0.5 * (low + high)!r} {DIMENSIONS[marker.dimension].si_unit}"


_PRESSURE_TEXT = re.compile(rf"\s*({NUMBER})\s*(m?bar|psi|[kM]?Pa)\s?(?:\(([ga])\)|([ga]))\s*")
_DIFFERENCES = (
    ("load", "fluid_pressure"),
    ("load", "largest_earlier_pressure"),
    ("load", "set_pressure"),
    ("requirement", "fluid_pressure"),
    ("requirement", "rated_pressure"),
)
# By how much the outlet may differ from one atmosphere for a gauge pressure to be the difference across the seal.
_OUTLET_TOLERANCE = 0.05


def is_said_of_one_side(entry: object) -> bool:
    """Whether a pressure, a list, a range or a table of them is gauge or absolute anywhere.

    Parameters
    ----------
    entry : anything
        As it stands in a case file.

    Examples
    --------
    >>> is_said_of_one_side(["1 bar", "20 barg"]), is_said_of_one_side("20 bar")
    (True, False)
    """
    return any(map(_match, _texts(entry)))


def without_reference(text: str) -> str:
    """A pressure without what it is measured from.

    Examples
    --------
    >>> without_reference("20 barg"), without_reference("20 bar")
    ('20 bar', '20 bar')
    """
    match = _match(text)
    return text if match is None else _plain_text(match)


def as_differences(tables: Mapping[str, Any], fluid: object) -> tuple[dict[str, Any], list[Problem]]:
    """Tables whose pressures are differences across the seal, and what cannot be made one.

    Parameters
    ----------
    tables : mapping
        Tables of a case as they are written.
    fluid : anything
        The table [fluid] as it is written.

    Returns
    -------
    tuple
    """
    new_tables, faults = dict(tables), list[Problem]()
    outlet = fluid.get("outlet_pressure") if isinstance(fluid, Mapping) else None
    if (match := _match(outlet)) and "fluid" in new_tables:
        if _kind(match) == "g":
            faults.append(problem("gauge_outlet", value=show(outlet), remedy=_absolute(match)))
        new_tables["fluid"] = {**new_tables["fluid"], "outlet_pressure": _plain_text(match)}
    for table, key in _DIFFERENCES:
        entries = new_tables.get(table)
        if isinstance(entries, Mapping) and is_said_of_one_side(entries.get(key)):
            converter = _Differences(f"{table}.{key}", fluid)
            new_tables[table] = {**entries, key: converter.of(entries[key])}
            faults += converter.problems
    return new_tables, faults


def as_difference(path: str, entry: Any, fluid: object) -> Any:
    """What varies at an entry of a case, gauge and absolute pressures as differences across the seal.

    Parameters
    ----------
    path : str
        Of the entry, "load.fluid_pressure".
    entry : anything
        A value, a list, a range or a distribution as it is written.
    fluid : anything
        The table [fluid] as it is written.

    Raises
    ------
    InputError
        If a pressure cannot be made one.
    """
    table, _, key = path.partition(".")
    if (table, key) not in _DIFFERENCES or not is_said_of_one_side(entry):
        return entry
    converter = _Differences(f"parameters.{path}", fluid)
    differences = converter.of(entry)
    if converter.problems:
        raise InputError(*converter.problems)
    return differences


def as_gauge(problem: Problem, tables: Mapping[str, Any]) -> Problem:
    """What is wrong with a pressure, with the pressure as it stands in the case.

    Parameters
    ----------
    problem : Problem
    tables : mapping
        The case as it was written.
    """
    table, _, key = problem.key.partition(".")
    entries = tables.get(table)
    entry = entries.get(key) if isinstance(entries, Mapping) else None
    if (table, key) not in _DIFFERENCES or not is_said_of_one_side(entry):
        return problem
    says = problem.message
    for text in _texts(entry):
        if match := _match(text):
            says = says.replace(f'"{_plain_text(match)}"', show(text))
    return replace(problem, says=says, remedy="", given=show(entry))


class _Differences:
    """What pressures of one key become across the seal of this fluid."""

    def __init__(self, key: str, fluid: object) -> None:
        self.key, self.problems = key, list[Problem]()
        self.outlet, self.is_gas = _outlet(fluid)

    def of(self, entry: Any) -> Any:
        if isinstance(entry, Mapping):
            return {name: self.of(value) for name, value in entry.items()}
        if isinstance(entry, (list, tuple)):
            return [self.of(value) for value in entry]
        match = _match(entry)
        return entry if match is None else self._of_text(entry, match)

    def _of_text(self, text: str, match: re.Match[str]) -> str:
        plain, refuse = _plain_text(match), self._refuse
        if _kind(match) == "g":
            far = self.outlet is not None and abs(self.outlet / STANDARD_PRESSURE - 1) > _OUTLET_TOLERANCE
            return refuse("gauge_far_outlet", text, plain) if far else plain
        if not self.is_gas or self.outlet is None:
            return refuse("absolute_without_outlet", text, plain)
        try:
            difference = float(exact_quantity(plain, "pressure")) - self.outlet
        except (QuantityError, OverflowError):
            # which the reading of the table says
            return plain
        return refuse("absolute_below_outlet", text, plain) if difference < 0 else f"{difference!r} Pa"

    def _refuse(self, name: str, text: str, plain: str) -> str:
        """The pressure as it is written, and one problem more."""
        outlet = (self.outlet or 0.0) / 1e5
        self.problems.append(problem(name, key=self.key, outlet=outlet, value=show(text)))
        return plain


def _texts(entry: object) -> Iterator[object]:
    if isinstance(entry, Mapping):
        entry = list(entry.values())
    if isinstance(entry, (list, tuple)):
        for value in entry:
            yield from _texts(value)
    else:
        yield entry


def _match(entry: object) -> re.Match[str] | None:
    return _PRESSURE_TEXT.fullmatch(entry) if isinstance(entry, str) else None


def _kind(match: re.Match[str]) -> str:
    return match[3] or match[4]


def _absolute(match: re.Match[str]) -> str:
    """How a gauge pressure is written as an absolute one."""
    try:
        bar = (float(exact_quantity(_plain_text(match), "pressure")) + STANDARD_PRESSURE) / 1e5
    except (QuantityError, OverflowError):
        bar = math.nan
    return f'write it as "{bar:.6g} bara"' if bar >= 0 else "there is no pressure below 0 bara"


def _plain_text(match: re.Match[str]) -> str:
    """The number and the unit without what it is measured from."""
    return f"{match[1]} {match[2]}"


def _outlet(fluid: object) -> tuple[float | None, bool]:
    """Absolute pressure at the outlet [Pa], None where it is not known; and whether the fluid is a gas."""
    from leak import is_gas

    if not isinstance(fluid, Mapping):
        return None, False
    name, outlet = fluid.get("name"), fluid.get("outlet_pressure")
    # whether a fluid of CoolProp is a gas depends on its temperature; with an outlet there is something to subtract
    gas = isinstance(name, str) and (is_gas(name) or (name.startswith("CoolProp:") and outlet is not None))
    if outlet is None:
        return (STANDARD_PRESSURE if gas else None), gas
    match = _match(outlet)
    try:
        return float(exact_quantity(_plain_text(match) if match else str(outlet), "pressure")), gas
    except (QuantityError, OverflowError):
        # which the reading of the table says
        return None, gas


def tables_of(field: FieldInfo) -> list[type[Table]]:
    """Models that may stand at a field: none for a plain value, several if its shape or kind decides."""
    return list(dict.fromkeys(_tables(field.annotation)))


def choices(table: type[BaseModel], key: str) -> list[str]:
    """Words that may stand at a key, empty if it is not a choice."""
    return [str(word) for word in _words(table.model_fields[key].annotation)]


def _words(annotation: Any) -> tuple[Any, ...]:
    """Words of a choice, also of one that may be left open or is read before it is compared."""
    if get_origin(annotation) is Literal:
        return get_args(annotation)
    return next(filter(None, map(_words, get_args(annotation))), ()) if get_args(annotation) else ()


def _tables(annotation: Any) -> Iterator[type[Table]]:
    if annotation is Material:
        yield MaterialTable
    elif isinstance(annotation, type) and issubclass(annotation, Table):
        yield annotation
    else:
        for member in get_args(annotation):
            yield from _tables(member)
