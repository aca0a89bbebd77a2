"""What can be moved on the page for a case: its loads, its surfaces, its hardness, its dimensions and its fluid.

A slider goes over texts as they would stand in the case file, "20.5 bar", so that a file that is written has the very
numbers of the screen.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from fem_seal.case.drawing_words import same_entry
from fem_seal.case.paths import entry_at, entry_paths, with_open_materials
from fem_seal.errors import InputError, Problem
from fem_seal.units import DIMENSIONS, parse_quantity, unit_for

if TYPE_CHECKING:
    from fem_seal.case.case import Case

Group = Literal["load", "surface", "dimension"]
# Stops of a slider, and how far it goes to both sides.
_STOPS = 80
_WIDE, _NARROW = 5.0, 1.5
# Keys of the bodies that are no dimensions to try out.
_LEFT_ALONE = ("interference", "tolerance", "thickness")
_UNITS = {"length": {"µm": "um"}, "force": {}, "fluid pressure": {}, "contact pressure": {}}


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
    words : str
        What stands in the case around the value, which is "{}" there.
    """

    key: str
    label: str
    group: Group
    paths: tuple[str, ...]
    stops: tuple[str, ...]
    given: str
    dimension: str
    note: str = ""
    words: str = "{}"

    @property
    def place(self) -> int:
        """Number of the stop that is the case's own value."""
        return self.stops.index(self.given)

    def nearest(self, text: str) -> int:
        """Number of the stop next to a value."""
        value = self.value(text)
        return min(range(len(self.stops)), key=lambda n: abs(self.value(self.stops[n]) - value))

    def check(self, text: str) -> None:
        """Whether a text may stand here.

        Raises
        ------
        InputError
            If it is no such quantity, or beyond the ends of the slider.
        """
        try:
            value = self.value(text)
        except ValueError as error:
            raise InputError.at(self.label, str(error), f'"{text}"') from None
        low, high = (self.value(self.stops[n]) for n in (0, -1))
        if not low * (1 - 1e-9) <= value <= high * (1 + 1e-9):
            reach = f"{self.stops[0]} to {self.stops[-1]}"
            raise InputError.at(
                self.label, f"the slider goes from {reach}; further away start from another case", f'"{text}"'
            )

    def wrong(self, text: str) -> str:
        """What is wrong with a text; empty if it may stand here."""
        try:
            self.check(text)
        except InputError as error:
            return error.message
        return ""

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
    fluids : tuple of str
        Names to choose from, that of the case first; empty where the case has no fluid.
    left_out : tuple of str
        Sentences about what is not offered.
    """

    sliders: tuple[Factor, ...]
    fluids: tuple[str, ...]
    left_out: tuple[str, ...]

    def __getitem__(self, key: str) -> Factor:
        return next(one for one in self.sliders if one.key == key)

    @property
    def given(self) -> dict[str, str]:
        """The design that is the case itself."""
        own = {one.key: one.given for one in self.sliders}
        return own | ({"fluid": self.fluids[0]} if self.fluids else {})

    def named(self, entry: str) -> str:
        """Key of the factor that sets an entry of a case, by its path or its label; empty if none does."""
        for one in self.sliders:
            if entry == one.label or same_entry(entry) in map(same_entry, one.paths):
                return one.key
        return "fluid" if entry in ("fluid", "fluid.name") else ""

    def wrong(self, texts: Mapping[str, str]) -> dict[str, str]:
        """What is wrong with texts, by the keys of their factors.

        Parameters
        ----------
        texts : mapping
            From keys of factors to texts; others are left out.
        """
        found = {one.key: one.wrong(texts[one.key]) for one in self.sliders if one.key in texts}
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
        for one in self.sliders:
            text = design.get(one.key, one.given)
            if text == one.given:
                continue
            try:
                one.check(text)
            except InputError as error:
                problems += error.problems
                continue
            if one.key == "fluid_pressure":
                found["load.fluid_pressure"] = _scaled(case.load.fluid_pressure, one, text)
                required = () if case.requirement is None else case.requirement.pressures
                if required:
                    # what is required at a load is required where it goes
                    found["requirement.fluid_pressure"] = _at_loads(
                        case, required, found["load.fluid_pressure"]
                    )
            elif one.key == "force":
                found["load.applied_force"] = _forces(case, one, text)
            else:
                found |= dict.fromkeys(one.paths, one.words.format(text))
        fluid = design.get("fluid", self.fluids[0] if self.fluids else "")
        if self.fluids and fluid != self.fluids[0]:
            found |= _other_fluid(case, fluid)
        if problems:
            raise InputError(*problems)
        return found


def factors_of(case: Case) -> Factors:
    """What can be moved on the page for a case.

    Parameters
    ----------
    case : Case
    """
    found = [one for find in (_pressure, _force, _finishes, _hardness, _dimensions) for one in find(case)]
    sliders = [one for one in found if isinstance(one, Factor)]
    left_out = [one for one in found if isinstance(one, str)]
    return Factors(tuple(sliders), _fluids(case), tuple(left_out))


def opened(case: Case) -> Case:
    """The case with materials of the library written as tables where a slider moves a part of one."""
    paths = [path for one in _hardness(case) if isinstance(one, Factor) for path in one.paths]
    return with_open_materials(case, paths)


Found = Sequence[Factor | str]


def _pressure(case: Case) -> Found:
    highest = max(case.load.fluid_pressure)
    several = len(set(case.load.fluid_pressure)) > 1
    label, note = "fluid pressure", ""
    if several:
        label, note = "highest fluid pressure", "the other pressures of the case keep their share of it"
    text, paths = case.written["load"].get("fluid_pressure"), ("load.fluid_pressure",)
    return [
        _log_factor("fluid_pressure", label, "load", highest, "pressure", text=text, paths=paths, note=note)
    ]


def _force(case: Case) -> Found:
    forces = [force for _, force in case.load.points]
    largest = max(forces)
    if largest != min(forces) and min(forces) <= 0:
        return ["The forces of the case have both signs: they are not offered as a slider."]
    if largest < 0:
        return ["The force of the case opens the seal: it is not offered as a slider."]
    label, note = "force", "of spring or actuator"
    if largest != min(forces):
        label, note = "largest force", "the other forces of the case keep their share of it"
    text, paths = case.written["load"].get("applied_force"), ("load.applied_force",)
    if largest > 0:
        return [_log_factor("force", label, "load", largest, "force", text=text, paths=paths, note=note)]
    # of the size of what the fluid does
    reach = math.pi * case.touch_radius**2 * max(case.load.fluid_pressure)
    return [_linear_factor("force", label, "load", 0.0, "force", 0.0, 2 * reach, paths=paths, note=note)]


# What the height of a face is called in its table, the first that is there.
_WORDS = re.compile(r"\b(Ra|Rq|Rz)\s*=?\s*([0-9.eE+-]+\s*[^\W\d]+)")
_HEIGHTS = ("Ra", "Rq", "Rz", "rms_height")


def _finishes(case: Case) -> Found:
    if case.roughness is None:
        return ["The case has no [roughness]: there is no leak rate, and no finish to choose."]
    written = case.written.get("roughness", {})
    faces = {"": written} if any(key in written for key in _HEIGHTS) else {}
    names = {
        "spectrum": "both faces",
        "seat": "seat",
        "closure": "closure",
        "along": "along",
        "across": "across",
    }
    faces |= {key: written[key] for key in names if isinstance(written.get(key), Mapping)}
    found: list[Factor | str] = []
    for key, words in written.items():
        # a finish in words, "lapped Ra 0.2 um"
        match = _WORDS.search(words) if key in names and isinstance(words, str) else None
        if match is not None:
            given: dict[str, Any] = {"text": match[2], "paths": (f"roughness.{key}",)}
            given["words"] = words[: match.start(2)] + "{}" + words[match.end(2) :]
            label, value = f"{match[1]}, {names[key]}", parse_quantity(match[2], "length")
            found.append(_log_factor(f"finish_{key}", label, "surface", value, "length", **given))
    for key, table in faces.items():
        which = next((name for name in _HEIGHTS if name in table), None)
        if which is None:
            found.append(
                f"The roughness of the {names[key]} is measured: its height is not offered as a slider."
            )
            continue
        given = {"text": table[which], "paths": (".".join(filter(None, ["roughness", key, which])),)}
        label = f"{'rms height' if which == 'rms_height' else which}, {names.get(key, 'both faces')}"
        value = _number("length", table[which])
        found.append(_log_factor(f"finish_{key or 'all'}", label, "surface", value, "length", **given))
    return found


def _hardness(case: Case) -> Found:
    if case.roughness is None:
        return []
    hardness = case.hardness
    if hardness is None or not case.leak.plasticity:
        return ["The asperities of the case do not yield: hardness would change nothing and is not offered."]
    body = min(
        (body for body in ("closure", "seat") if getattr(case, body).material.hardness is not None),
        key=lambda body: getattr(case, body).material.hardness,
    )
    note = "of the softer body; beyond that of the other one it changes nothing"
    given: dict[str, Any] = {"paths": (f"{body}.material.hardness",), "note": note}
    return [_log_factor("hardness", f"hardness, {body}", "surface", hardness, "pressure", width=3.0, **given)]


def _dimensions(case: Case) -> Found:
    """Every angle and length of the bodies that stands in the case; equal angles of both are one."""
    known = set(entry_paths(case))
    entries: list[tuple[str, str, str, object]] = []
    for body in ("closure", "seat"):
        for key, written in case.written.get(body, {}).items():
            # the drawing's word for what the case keeps as an angle to the axis or a radius
            kept = same_entry(f"{body}.{key}")
            if key in _LEFT_ALONE or kept not in known:
                continue
            dimension = getattr(entry_at(case, kept).marker, "dimension", "")
            if dimension in ("angle", "length"):
                entries.append((body, key, dimension, written))
    angles = [one for one in entries if one[1] in ("angle", "included_angle")]
    values = [_number("angle", written) for *_, written in angles]
    linked = len(angles) == 2 and abs(values[0] - values[1]) < 1e-12
    found: list[Factor | str] = []
    for one in entries:
        body, key, dimension, written = one
        paths: tuple[str, ...] = (f"{body}.{key}",)
        face = body
        if linked and one in angles:
            if body == "seat":
                continue
            paths, face = tuple(f"{body}.{key}" for body, key, *_ in angles), "both faces"
        label = f"{key.replace('_', ' ')}, {face}"
        made = _of_dimension(dimension, f"{body}_{key}", label, written, paths)
        found += [] if made is None else [made]
    drawn = [body for body in ("closure", "seat") if getattr(case, body).shape == "profile"]
    found += [f"The {body} comes from a drawing: its dimensions are not offered." for body in drawn]
    return sorted(found, key=lambda one: isinstance(one, Factor) and "angle" not in one.key)


def _number(dimension: str, written: object) -> float:
    """A quantity in SI, whatever of it the case keeps."""
    return parse_quantity(written, dimension) if isinstance(written, str) else float(str(written))


def _of_dimension(
    dimension: str, key: str, label: str, written: object, paths: tuple[str, ...]
) -> Factor | None:
    value = _number(dimension, written)
    if dimension == "angle":
        degrees = math.degrees(value)
        full = 180.0 if key.endswith("included_angle") else 90.0
        low, high = max(0.02 * full, degrees - full / 6), min(0.97 * full, degrees + full / 6)
        if not low < degrees < high:
            return None
        return _linear_factor(
            key, label, "dimension", value, "angle", math.radians(low), math.radians(high), paths=paths
        )
    if value <= 0:
        return None
    return _log_factor(key, label, "dimension", value, "length", width=_NARROW, text=written, paths=paths)


def _log_factor(
    key: str,
    label: str,
    group: Group,
    value: float,
    dimension: str,
    *,
    width: float = _WIDE,
    text: object = None,
    **more: Any,
) -> Factor:
    """Stops that grow by the same share, with three significant digits."""
    ratio = 2 * math.log(width) / _STOPS
    values = [value * math.exp(ratio * n) for n in range(-_STOPS // 2, _STOPS // 2 + 1)]
    return _factor(key, label, group, values, value, dimension, text, **more)


def _linear_factor(
    key: str, label: str, group: Group, value: float, dimension: str, low: float, high: float, **more: Any
) -> Factor:
    values = [low + (high - low) * n / _STOPS for n in range(_STOPS + 1)]
    return _factor(key, label, group, [*values, value], value, dimension, None, **more)


def _factor(
    key: str,
    label: str,
    group: Group,
    values: list[float],
    value: float,
    dimension: str,
    text: object,
    **more: Any,
) -> Factor:
    unit, size = _unit(dimension, value or max(values), text)
    texts = {}
    for one in sorted(values):
        number = float(f"{one / size:.3g}")
        texts[number] = f"{number:g} {unit}"
    given = text.strip() if isinstance(text, str) else f"{float(f'{value / size:.12g}')!r} {unit}"
    own = value / size
    texts = {number: shown for number, shown in texts.items() if abs(number - own) > 1e-6 * abs(own or 1.0)}
    texts[own] = re.sub(r"\.0 ", " ", given)
    stops = tuple(texts[number] for number in sorted(texts))
    return Factor(
        key=key, label=label, group=group, stops=stops, given=texts[own], dimension=dimension, **more
    )


def _unit(dimension: str, value: float, text: object) -> tuple[str, float]:
    """Unit in which the case gives the value, or that suits it, and its size."""
    if isinstance(text, str):
        match = re.fullmatch(r"\s*[-+0-9.eE]+\s*(\S.*?)\s*", text)
        if match:
            return match[1], parse_quantity(f"1 {match[1]}", dimension)
    if dimension == "angle":
        return "deg", math.radians(1.0)
    kind = {"length": "length", "force": "force"}.get(dimension)
    if dimension == "pressure":
        kind = "contact pressure" if value >= 5e8 else "fluid pressure"
    unit = unit_for(kind or dimension, value)
    name = unit.name.replace("µ", "u")
    return name, unit.size


def _scaled(values: Sequence[float], factor: Factor, text: str) -> str | list[str]:
    """Values of a list in their old proportions, the largest as it stands in a text."""
    largest, share = max(values), factor.value(text) / factor.value(factor.given)
    if len(values) == 1:
        return text
    unit = DIMENSIONS[factor.dimension].si_unit
    return [text if one == largest else f"{float(f'{one * share:.6g}')!r} {unit}" for one in values]


def _at_loads(case: Case, required: Sequence[float], moved: str | list[str]) -> list[str]:
    """Pressures of loads after they have been moved."""
    texts = [moved] if isinstance(moved, str) else moved
    # of one pressure under several forces there is one text
    loads = list(zip(case.load.fluid_pressure, texts, strict=False))
    return [text for one in required for known, text in loads if math.isclose(one, known, rel_tol=1e-9)][
        : len(loads)
    ]


def _forces(case: Case, factor: Factor, text: str) -> str | list[str]:
    forces = case.load.applied_force
    return _scaled(forces, factor, text) if isinstance(forces, tuple) else text


def _fluids(case: Case) -> tuple[str, ...]:
    if case.fluid is None or case.roughness is None:
        return ()
    from leak import FLUIDS, GASES

    return tuple(dict.fromkeys([case.fluid.name, *FLUIDS, *GASES]))


def _other_fluid(case: Case, name: str) -> dict[str, Any]:
    """Entries of another fluid of the library in place of the case's own, at its temperature."""
    table = {"name": name}
    kept = case.written.get("fluid", {})
    table |= {key: kept[key] for key in ("temperature", "particles") if key in kept}
    from leak import is_gas

    if is_gas(name) and "outlet_pressure" in kept:
        table["outlet_pressure"] = kept["outlet_pressure"]
    removed = dict.fromkeys(set(kept) - set(table))
    return {f"fluid.{key}": value for key, value in {**removed, **table}.items()}
