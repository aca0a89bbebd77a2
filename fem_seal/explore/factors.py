"""Sliders of the page: loads, roughness, hardness, dimensions.

A slider goes over texts as they would stand in the case file, "20.5 bar", so that a file that is written has the very
numbers of the screen.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from fem_seal.case.fields import OneOrRange
from fem_seal.case.notation import same_entry
from fem_seal.case.paths import entry_at, entry_paths, with_open_materials
from fem_seal.case.roughness import read_roughness
from fem_seal.errors import InputError, Problem
from fem_seal.files import own_tables
from fem_seal.units import DIMENSIONS, System, parse_quantity, unit_for, unit_like

if TYPE_CHECKING:
    from fem_seal.case.case import Case

Group = Literal["load", "surface", "dimension"]
# Stops of a slider, and how far it goes to both sides.
_STOPS = 80
_WIDE, _NARROW = 5.0, 1.5
# Keys of the bodies that are no dimensions to try out.
_LEFT_ALONE = ("interference", "tolerance", "thickness")


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
    given : str
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
    given: str
    dimension: str
    note: str = ""

    @property
    def place(self) -> int:
        """Number of the stop that is the case's own value."""
        return self.stops.index(self.given)

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
    left_out : tuple of str
        Sentences about what is not offered.
    """

    sliders: tuple[Factor, ...]
    left_out: tuple[str, ...]

    @property
    def base_design(self) -> dict[str, str]:
        """The design that is the case itself."""
        return {factor.key: factor.given for factor in self.sliders}

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
        found = {
            factor.key: factor.find_error(texts[factor.key]) for factor in self.sliders if factor.key in texts
        }
        return {key: message for key, message in found.items() if message}

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
        found: dict[str, Any] = {}
        problems: list[Problem] = []
        for factor in self.sliders:
            text = design.get(factor.key, factor.given)
            if text == factor.given:
                continue
            if message := factor.find_error(text):
                problems.append(Problem(factor.label, message, f'"{text}"'))
            elif factor.group == "load":
                (path,) = factor.paths
                moved = _scale_values(getattr(case.load, path.removeprefix("load.")), factor, text)
                found[path] = moved
                if (
                    factor.key == "fluid_pressure"
                    and case.requirement
                    and (required := case.requirement.pressures)
                ):
                    # what is required at a load is required where it goes
                    found["requirement.fluid_pressure"] = _at_loads(case, required, moved)
            else:
                found |= dict.fromkeys(factor.paths, text)
        if problems:
            raise InputError(*problems)
        return found


def factors_of(case: Case) -> Factors:
    """What can be moved on the page for a case.

    Parameters
    ----------
    case : Case
    """
    found = [
        factor for find in (_pressure, _force, _finishes, _hardness, _dimensions) for factor in find(case)
    ]
    system = case.report.units
    sliders = [
        _convert_texts(factor, system) if system else factor for factor in found if isinstance(factor, Factor)
    ]
    left_out = [factor for factor in found if isinstance(factor, str)]
    return Factors(tuple(sliders), tuple(left_out))


def _convert_texts(factor: Factor, system: System) -> Factor:
    """A factor with its texts in the units of a system; its own value stays the very one of the case."""
    written, value = factor.given.partition(" ")[2], factor.value(factor.given)
    unit = unit_like(written, factor.dimension, value or factor.value(factor.stops[-1]), system)
    if unit is None:
        return factor
    stops = [f"{float(f'{unit.of(factor.value(stop)):.3g}'):g}" for stop in factor.stops]
    stops[factor.place] = f"{unit.of(value):.6g}"
    name = unit.name.replace("µ", "u")
    texts = tuple(dict.fromkeys(f"{stop} {name}" for stop in stops))
    return replace(factor, stops=texts, given=f"{stops[factor.place]} {name}")


def open_materials(case: Case) -> Case:
    """The case with materials of the library written as tables where a slider moves a part of one."""
    paths = [path for factor in _hardness(case) if isinstance(factor, Factor) for path in factor.paths]
    return with_open_materials(case, paths)


Found = Sequence[Factor | str]


def _pressure(case: Case) -> Found:
    return [_of_loads(case, "fluid_pressure", "fluid_pressure", "pressure", case.load.fluid_pressure)]


def _force(case: Case) -> Found:
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
    words = own_tables("explore.toml")["factors"][key]["several" if len(set(values)) > 1 else "one"]
    written = case.written["load"].get(entry) if stops is None else None
    path, largest = f"load.{entry}", max(values)
    return _factor(key, words["label"], "load", (path,), dimension, largest, written, stops, words["note"])


# What the height of a face is called in its table, the first that is there.
_HEIGHT = OneOrRange("length", "0 m", "1 m")
_HEIGHTS = ("Ra", "Rq", "Rz", "rms_height")


def _finishes(case: Case) -> Found:
    if case.roughness is None:
        return ["The case has no [roughness]: there is no leak rate, and no finish to choose."]
    # a finish in words is a table like others
    written: Any = read_roughness(case.written["roughness"])
    faces = {"": written} if any(key in written for key in _HEIGHTS) else {}
    names = {"spectrum": "both faces"} | {
        face: face for face in ("seat", "closure", "gasket", "along", "across")
    }
    if case.gasket is not None:
        names["seat"] = "lower flange"
    faces |= {key: written[key] for key in names if isinstance(written.get(key), Mapping)}
    found: list[Factor | str] = []
    for key, table in faces.items():
        which = next((name for name in _HEIGHTS if name in table), None)
        if which is None:
            found.append(
                f"The roughness of the {names[key]} is measured: its height is not offered as a slider."
            )
            continue
        label = f"{which.replace('_', ' ')}, {names.get(key, 'both faces')}"
        path = ".".join(filter(None, ["roughness", key, which]))
        found.append(_finish(key or "all", label, path, table[which]))
    return found


def _finish(key: str, label: str, path: str, written: object) -> Factor:
    ends = _HEIGHT.read(written) if isinstance(written, (str, list)) else _number("length", written)
    if isinstance(ends, tuple):
        # the usual surface
        written = f"{1e6 * math.sqrt(ends[0] * ends[1]):.3g} um"
    value = _number("length", written)
    return _factor(f"finish_{key}", label, "surface", (path,), "length", value, written)


def _hardness(case: Case) -> Found:
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


def _dimensions(case: Case) -> Found:
    """Every angle and length of the bodies that stands in the case; equal angles of both are one."""
    known = set(entry_paths(case))
    entries: list[tuple[str, str, str, object]] = []
    for body in ("closure", case.key_of("seat")):
        for key, written in case.written.get(body, {}).items():
            # the drawing's word for what the case keeps as an angle to the axis or a radius
            kept = same_entry(f"{body}.{key}")
            if key in _LEFT_ALONE or kept not in known:
                continue
            dimension = getattr(entry_at(case, kept).marker, "dimension", "")
            if dimension in ("angle", "length"):
                entries.append((body, key, dimension, written))
    angles = [entry for entry in entries if entry[1] in ("angle", "included_angle")]
    values = [_number("angle", written) for *_, written in angles]
    linked = len(angles) == 2 and abs(values[0] - values[1]) < 1e-12
    found: list[Factor | str] = []
    for entry in entries:
        body, key, dimension, written = entry
        paths: tuple[str, ...] = (f"{body}.{key}",)
        face = body
        if linked and entry in angles:
            if body == "seat":
                continue
            paths, face = tuple(f"{body}.{key}" for body, key, *_ in angles), "both faces"
        label = f"{key.replace('_', ' ')}, {face}"
        found += _of_dimension(dimension, f"{body}_{key}", label, written, paths)
    drawn = [body for body in ("closure", case.key_of("seat")) if getattr(case, body).shape == "profile"]
    found += [f"The {body} comes from a drawing: its dimensions are not offered." for body in drawn]
    return sorted(found, key=lambda entry: isinstance(entry, Factor) and "angle" not in entry.key)


def _number(dimension: str, written: object) -> float:
    """A quantity in SI, whatever of it the case keeps."""
    return parse_quantity(written, dimension) if isinstance(written, str) else float(str(written))


def _of_dimension(dimension: str, key: str, label: str, written: object, paths: tuple[str, ...]) -> Found:
    """The factor of an angle or a length; none where there is no room to move it."""
    value = _number(dimension, written)
    if dimension == "length":
        values, room = _space_geometrically(value, _NARROW), value > 0
    else:
        degrees = math.degrees(value)
        full = 180.0 if key.endswith("included_angle") else 90.0
        low, high = max(0.02 * full, degrees - full / 6), min(0.97 * full, degrees + full / 6)
        values, room = [*_space_evenly(math.radians(low), math.radians(high)), value], low < degrees < high
        written = None
    return [_factor(key, label, "dimension", paths, dimension, value, written, values)] if room else []


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
    given = text.strip() if isinstance(text, str) else f"{float(f'{value / size:.12g}')!r} {unit}"
    own = value / size
    texts = {number: shown for number, shown in texts.items() if abs(number - own) > 1e-6 * abs(own or 1.0)}
    texts[own] = re.sub(r"\.0 ", " ", given)
    stops = tuple(texts[number] for number in sorted(texts))
    return Factor(key, label, group, paths, stops, texts[own], dimension, note)


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
    unit = unit_for(dimension, value)
    return unit.name.replace("µ", "u"), unit.size


def _scale_values(values: float | Sequence[float], factor: Factor, text: str) -> str | list[str]:
    """Values of a list in their old proportions, the largest as it stands in a text; the text for one alone."""
    if isinstance(values, float) or len(values) == 1:
        return text
    largest, share = max(values), factor.value(text) / factor.value(factor.given)
    unit = DIMENSIONS[factor.dimension].si_unit
    return [text if value == largest else f"{float(f'{value * share:.6g}')!r} {unit}" for value in values]


def _at_loads(case: Case, required: Sequence[float], moved: str | list[str]) -> list[str]:
    """Pressures of loads after they have been moved."""
    texts = [moved] if isinstance(moved, str) else moved
    # of one pressure under several forces there is one text
    loads = list(zip(case.load.fluid_pressure, texts, strict=False))
    return [
        text for pressure in required for known, text in loads if math.isclose(pressure, known, rel_tol=1e-9)
    ][: len(loads)]
