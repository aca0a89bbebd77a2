"""Sliders of the page: loads, roughness, hardness, dimensions.

A slider goes over texts as they would stand in the case file, "20.5 bar", so that a file that is written has the very
numbers of the screen.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from fem_seal.case.fields import OneOrRange
from fem_seal.case.notation import same_entry
from fem_seal.case.paths import entry_at, entry_paths, with_open_materials
from fem_seal.case.roughness import read_roughness
from fem_seal.errors import InputError, Problem
from fem_seal.files import own_tables
from fem_seal.units import DIMENSIONS, Display, System, parse_quantity, unit_like

if TYPE_CHECKING:
    from fem_seal.case.case import Case

Group = Literal["load", "surface", "dimension"]
# Stops of a slider, and how far it goes to both sides.
_STOPS = 80
_WIDE, _NARROW = 5.0, 1.5
# Keys of the bodies that are no dimensions to try out.
_FIXED_KEYS = ("interference", "tolerance", "thickness")


@dataclass(frozen=True)
class Factor:
    """One thing that can be moved.

    Parameters
    ----------
    key : str
        Its name in designs, without dots.
    label : str
        For people.
    group : {"load", "surface", "dimension"}
    paths : tuple of str
        Entries of the case that it sets.
    stops : tuple of str
        Values of its slider as they stand in a case file, increasing; the case's own among them.
    base_text : str
        The case's own value.
    dimension : str
        Of the quantity, see `fem_seal.units.DIMENSIONS`.
    note : str
        What else is to be known.
    """

    key: str
    label: str
    group: Group
    paths: tuple[str, ...]
    stops: tuple[str, ...]
    base_text: str
    dimension: str
    note: str = ""

    @property
    def place(self) -> int:
        """Number of the stop that is the case's own value."""
        return self.stops.index(self.base_text)

    def nearest(self, text: str) -> int:
        """Number of the stop next to a value."""
        value = self.value(text)
        return min(range(len(self.stops)), key=lambda n: abs(self.value(self.stops[n]) - value))

    def find_error(self, text: str) -> str:
        """What is wrong with a text: no such quantity, or beyond the ends of the slider; empty if it may stand here."""
        try:
            value = self.value(text)
        except ValueError as error:
            return str(error)
        low, high = (self.value(self.stops[n]) for n in (0, -1))
        if low * (1 - 1e-9) <= value <= high * (1 + 1e-9):
            return ""
        reach = f"{self.stops[0]} to {self.stops[-1]}"
        return f"the slider goes from {reach}; further away start from another case"

    def value(self, text: str) -> float:
        """A value in SI.

        Raises
        ------
        QuantityError
            If the text is no such quantity.
        """
        return parse_quantity(text, self.dimension)


@dataclass(frozen=True)
class Factors:
    """What can be moved, and what cannot.

    Parameters
    ----------
    sliders : tuple of Factor
    notes : tuple of str
        Sentences about what is not offered.
    """

    sliders: tuple[Factor, ...]
    notes: tuple[str, ...]

    @property
    def base_design(self) -> dict[str, str]:
        """The design that is the case itself."""
        return {factor.key: factor.base_text for factor in self.sliders}

    @property
    def labels(self) -> dict[str, str]:
        """What all parts of a design are called, by their keys."""
        return {factor.key: factor.label for factor in self.sliders}

    def factor_key(self, entry: str) -> str:
        """Key of the factor that sets an entry of a case, by its path or its label; empty if none does."""
        for factor in self.sliders:
            if entry == factor.label or same_entry(entry) in map(same_entry, factor.paths):
                return factor.key
        return ""

    def find_errors(self, texts: Mapping[str, str]) -> dict[str, str]:
        """What is wrong with texts, by the keys of their factors.

        Parameters
        ----------
        texts : mapping
            From keys of factors to texts; others are left out.
        """
        messages = {
            factor.key: factor.find_error(texts[factor.key]) for factor in self.sliders if factor.key in texts
        }
        return {key: message for key, message in messages.items() if message}

    def changes(self, case: Case, design: Mapping[str, str]) -> dict[str, Any]:
        """Entries of a case file that make a design of a case; only what differs from it.

        Parameters
        ----------
        case : Case
        design : mapping
            From keys of factors to texts; what is missing stays.

        Raises
        ------
        InputError
            If a text is no such quantity.
        """
        entries: dict[str, Any] = {}
        problems: list[Problem] = []
        for factor in self.sliders:
            text = design.get(factor.key, factor.base_text)
            if text == factor.base_text:
                continue
            if message := factor.find_error(text):
                problems.append(Problem(factor.label, message, f'"{text}"'))
            elif factor.group == "load":
                (path,) = factor.paths
                values = _scale_values(getattr(case.load, path.removeprefix("load.")), factor, text)
                entries[path] = values
                if (
                    factor.key == "fluid_pressure"
                    and case.requirement
                    and (pressures := case.requirement.pressures)
                ):
                    # what is required at a load is required where it goes
                    entries["requirement.fluid_pressure"] = _at_loads(case, pressures, values)
            else:
                entries |= dict.fromkeys(factor.paths, text)
        if problems:
            raise InputError(*problems)
        return entries


def factors_of(case: Case) -> Factors:
    """What can be moved on the page for a case.

    Parameters
    ----------
    case : Case
    """
    items = [
        factor for find in (_pressure, _force, _finishes, _hardness, _dimensions) for factor in find(case)
    ]
    system = case.report.units
    sliders = [
        _convert_texts(factor, system) if system else factor for factor in items if isinstance(factor, Factor)
    ]
    left_out = [factor for factor in items if isinstance(factor, str)]
    return Factors(tuple(sliders), tuple(left_out))


def _convert_texts(factor: Factor, system: System) -> Factor:
    """A factor with its texts in the units of a system; its own value stays the very one of the case."""
    symbol, value = factor.base_text.partition(" ")[2], factor.value(factor.base_text)
    unit = unit_like(symbol, factor.dimension, value or factor.value(factor.stops[-1]), system)
    if unit is None:
        return factor
    stops = [f"{float(f'{unit.of(factor.value(stop)):.3g}'):g}" for stop in factor.stops]
    stops[factor.place] = f"{unit.of(value):.6g}"
    name = unit.name.replace("µ", "u")
    texts = tuple(dict.fromkeys(f"{stop} {name}" for stop in stops))
    return replace(factor, stops=texts, base_text=f"{stops[factor.place]} {name}")


def open_materials(case: Case) -> Case:
    """The case with materials of the library written as tables where a slider moves a part of one."""
    paths = [path for factor in _hardness(case) if isinstance(factor, Factor) for path in factor.paths]
    return with_open_materials(case, paths)


Offers = Sequence[Factor | str]


def _pressure(case: Case) -> Offers:
    return [_of_loads(case, "fluid_pressure", "fluid_pressure", "pressure", case.load.fluid_pressure)]


def _force(case: Case) -> Offers:
    if case.bolts is not None:
        return ["The bolts give the force of the case: it is not offered as a slider."]
    forces = [force for _, force in case.load.points]
    largest = max(forces)
    if largest != min(forces) and min(forces) <= 0:
        return ["The forces of the case have both signs: they are not offered as a slider."]
    if largest < 0:
        return ["The force of the case opens the seal: it is not offered as a slider."]
    # where there is none, to the size of what the fluid does
    reach = 2 * math.pi * case.initial_contact_radius**2 * max(case.load.fluid_pressure)
    stops = None if largest else _space_evenly(0.0, reach)
    return [_of_loads(case, "force", "applied_force", "force", forces, stops)]


def _of_loads(
    case: Case,
    key: str,
    entry: str,
    dimension: str,
    values: Sequence[float],
    stops: list[float] | None = None,
) -> Factor:
    """The factor of an entry of [load]: its largest value, with which the others keep their proportions."""
    words = own_tables("explore/looks.toml")["factors"][key]["several" if len(set(values)) > 1 else "one"]
    text = case.written["load"].get(entry) if stops is None else None
    path, largest = f"load.{entry}", max(values)
    return _factor(key, words["label"], "load", (path,), dimension, largest, text, stops, words["note"])


# What the height of a face is called in its table, the first that is there.
_HEIGHT = OneOrRange("length", "0 m", "1 m")
_HEIGHTS = ("Ra", "Rq", "Rz", "rms_height")


def _finishes(case: Case) -> Offers:
    if case.roughness is None:
        return ["The case has no [roughness]: there is no leak rate, and no finish to choose."]
    # a finish in words is a table like others
    finishes: Any = read_roughness(case.written["roughness"])
    faces = {"": finishes} if any(key in finishes for key in (*_HEIGHTS, "feed")) else {}
    names = {"": "both faces", "spectrum": "both faces"} | {
        face: face for face in ("seat", "closure", "gasket", "along", "across")
    }
    if case.gasket is not None:
        names["seat"] = "lower flange"
    faces |= {key: finishes[key] for key in names if isinstance(finishes.get(key), Mapping)}
    offers: list[Factor | str] = []
    for key, table in faces.items():
        which = next((name for name in _HEIGHTS if name in table), None)
        if "feed" in table:
            offers += _cusps(key, names[key], table)
            continue
        if which is None:
            offers.append(
                f"The roughness of the {names[key]} is measured: its height is not offered as a slider."
            )
            continue
        label = f"{which.replace('_', ' ')}, {names[key]}"
        path = ".".join(filter(None, ["roughness", key, which]))
        offers.append(_finish(key or "all", label, path, table[which]))
    return offers


def _cusps(key: str, face: str, table: Mapping[str, Any]) -> Iterator[Factor]:
    """Feed, nose radius and height of the fine roughness of a turned face."""
    base, which_face = ".".join(filter(None, ["roughness", key])), key or "all"
    for name in ("feed", "nose_radius"):
        entry = table[name]
        label, value = f"{name.replace('_', ' ')}, {face}", _number("length", entry)
        yield _factor(f"{name}_{which_face}", label, "surface", (f"{base}.{name}",), "length", value, entry)
    fine = table["fine"]
    if isinstance(fine, Mapping):
        which = next(name for name in _HEIGHTS if name in fine)
        label = f"{which.replace('_', ' ')} on the crests, {face}"
        yield _finish(which_face, label, f"{base}.fine.{which}", fine[which])


def _finish(key: str, label: str, path: str, entry: object) -> Factor:
    ends = _HEIGHT.read(entry) if isinstance(entry, (str, list)) else _number("length", entry)
    if isinstance(ends, tuple):
        # the usual surface
        entry = f"{1e6 * math.sqrt(ends[0] * ends[1]):.3g} um"
    value = _number("length", entry)
    return _factor(f"finish_{key}", label, "surface", (path,), "length", value, entry)


def _hardness(case: Case) -> Offers:
    if case.roughness is None:
        return []
    hardness = case.hardness
    if hardness is None or not case.leak.plasticity:
        return ["The asperities of the case do not yield: hardness would change nothing and is not offered."]
    bodies = ("closure", case.key_of("seat"))
    body = min(
        (body for body in bodies if getattr(case, body).material.hardness is not None),
        key=lambda body: getattr(case, body).material.hardness,
    )
    note = "of the softer body; beyond that of the other one it changes nothing"
    label, paths = f"hardness, {body}", (f"{body}.material.hardness",)
    values = _space_geometrically(hardness, 3.0)
    return [_factor("hardness", label, "surface", paths, "pressure", hardness, values=values, note=note)]


def _dimensions(case: Case) -> Offers:
    """Every angle and length of the bodies that stands in the case; equal angles of both are one."""
    paths_of_case = set(entry_paths(case))
    entries: list[tuple[str, str, str, object]] = []
    for body in ("closure", case.key_of("seat")):
        for key, text in case.written.get(body, {}).items():
            # the drawing's word for what the case keeps as an angle to the axis or a radius
            path = same_entry(f"{body}.{key}")
            if key in _FIXED_KEYS or path not in paths_of_case:
                continue
            dimension = getattr(entry_at(case, path).marker, "dimension", "")
            if dimension in ("angle", "length"):
                entries.append((body, key, dimension, text))
    angles = [entry for entry in entries if entry[1] in ("angle", "included_angle")]
    values = [_number("angle", text) for *_, text in angles]
    is_linked = len(angles) == 2 and abs(values[0] - values[1]) < 1e-12
    offers: list[Factor | str] = []
    for entry in entries:
        body, key, dimension, text = entry
        paths: tuple[str, ...] = (f"{body}.{key}",)
        face = body
        if is_linked and entry in angles:
            if body == "seat":
                continue
            paths, face = tuple(f"{body}.{key}" for body, key, *_ in angles), "both faces"
        label = f"{key.replace('_', ' ')}, {face}"
        offers += _of_dimension(dimension, f"{body}_{key}", label, text, paths)
    profiles = [body for body in ("closure", case.key_of("seat")) if getattr(case, body).shape == "profile"]
    offers += [f"The {body} comes from a drawing: its dimensions are not offered." for body in profiles]
    return sorted(offers, key=lambda entry: isinstance(entry, Factor) and "angle" not in entry.key)


def _number(dimension: str, entry: object) -> float:
    """A quantity in SI, whatever of it the case keeps."""
    return parse_quantity(entry, dimension) if isinstance(entry, str) else float(str(entry))


def _of_dimension(dimension: str, key: str, label: str, text: object, paths: tuple[str, ...]) -> Offers:
    """The factor of an angle or a length; none where there is no room to move it."""
    value = _number(dimension, text)
    if dimension == "length":
        values, room = _space_geometrically(value, _NARROW), value > 0
    else:
        degrees = math.degrees(value)
        full = 180.0 if key.endswith("included_angle") else 90.0
        low, high = max(0.02 * full, degrees - full / 6), min(0.97 * full, degrees + full / 6)
        values, room = [*_space_evenly(math.radians(low), math.radians(high)), value], low < degrees < high
        text = None
    return [_factor(key, label, "dimension", paths, dimension, value, text, values)] if room else []


def _space_geometrically(value: float, width: float) -> list[float]:
    """Values that grow by the same share, as far to both sides of one."""
    ratio = 2 * math.log(width) / _STOPS
    return [value * math.exp(ratio * n) for n in range(-_STOPS // 2, _STOPS // 2 + 1)]


def _space_evenly(low: float, high: float) -> list[float]:
    return [low + (high - low) * n / _STOPS for n in range(_STOPS + 1)]


def _factor(
    key: str,
    label: str,
    group: Group,
    paths: tuple[str, ...],
    dimension: str,
    value: float,
    text: object = None,
    values: list[float] | None = None,
    note: str = "",
) -> Factor:
    """A factor whose stops have three significant digits, but for its own value, which is as the case has it."""
    values = _space_geometrically(value, _WIDE) if values is None else values
    unit, size = _unit(dimension, value or max(values), text)
    texts = {}
    for stop in sorted(values):
        number = float(f"{stop / size:.3g}")
        texts[number] = f"{number:g} {unit}"
    own_text = text.strip() if isinstance(text, str) else f"{float(f'{value / size:.12g}')!r} {unit}"
    base = value / size
    texts = {number: text for number, text in texts.items() if abs(number - base) > 1e-6 * abs(base or 1.0)}
    texts[base] = re.sub(r"\.0 ", " ", own_text)
    stops = tuple(texts[number] for number in sorted(texts))
    return Factor(key, label, group, paths, stops, texts[base], dimension, note)


def _unit(dimension: str, value: float, text: object) -> tuple[str, float]:
    """Unit in which the case gives the value, or that suits it, and its size."""
    if isinstance(text, str):
        match = re.fullmatch(r"\s*[-+0-9.eE]+\s*(\S.*?)\s*", text)
        if match:
            return match[1], parse_quantity(f"1 {match[1]}", dimension)
    if dimension == "angle":
        return "deg", math.radians(1.0)
    if dimension == "pressure":
        dimension = "contact pressure" if value >= 5e8 else "fluid pressure"
    unit = Display().unit_for(dimension, value)
    return unit.name.replace("µ", "u"), unit.size


def _scale_values(values: float | Sequence[float], factor: Factor, text: str) -> str | list[str]:
    """Values of a list in their old proportions, the largest as it stands in a text; the text for one alone."""
    if isinstance(values, float) or len(values) == 1:
        return text
    largest, share = max(values), factor.value(text) / factor.value(factor.base_text)
    unit = DIMENSIONS[factor.dimension].si_unit
    return [text if value == largest else f"{float(f'{value * share:.6g}')!r} {unit}" for value in values]


def _at_loads(case: Case, pressures: Sequence[float], new_values: str | list[str]) -> list[str]:
    """Pressures of loads after they have been moved."""
    texts = [new_values] if isinstance(new_values, str) else new_values
    # of one pressure under several forces there is one text
    loads = list(zip(case.load.fluid_pressure, texts, strict=False))
    return [
        text for pressure in pressures for old, text in loads if math.isclose(pressure, old, rel_tol=1e-9)
    ][: len(loads)]
