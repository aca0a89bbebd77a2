"""Drawing keys: a diameter for every radius of a body, the included angle for the angle of a cone.

They belong to the text of a case file. Behind it there are radii and angles only.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from pydantic import BaseModel

from fem_seal.case.fields import Quantity, quantities_of, shown
from fem_seal.case.words import problem
from fem_seal.errors import Problem, QuantityError
from fem_seal.units import DIMENSIONS, exact_quantity, parse_quantity

# Other keys that say the same: one takes the place of the other.
_OTHER = {"angle": "included_angle", "applied_force": "set_pressure"}
_OTHER |= {other: key for key, other in _OTHER.items()}
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
            words[name] = Word(name, key, _twice(marker))
    return words


def _twice(marker: Quantity) -> Quantity:
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
    if key in _OTHER:
        return _OTHER[key]
    stem, _, last = key.rpartition("_")
    other = {"radius": "diameter", "diameter": "radius"}.get(last)
    return None if other is None else f"{stem}_{other}" if stem else other


def same_entry(path: str) -> str:
    """Path of the key for a path that may end in a drawing's word: "seat.bore_radius" for "seat.bore_diameter"."""
    body, _, last = path.rpartition(".")
    if body.split(".")[0] in _BODIES and last.endswith(("diameter", "included_angle")):
        return f"{body}.{partner(last)}"
    return path


def said_twice(paths: Mapping[str, Any] | list[str]) -> tuple[str, str] | None:
    """Two of some paths that are words for the same entry; None if there are none."""
    known: dict[str, str] = {}
    for path in paths:
        entry = same_entry(str(path))
        if entry in known:
            return known[entry], str(path)
        known[entry] = str(path)
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
    words, found, wrong = words_of(table), {}, []
    for name, value in entries.items():
        if name not in words:
            found[name] = value
            continue
        word = words[name]
        if word.key in entries:
            values = {"key": f"{body}.{name}", "word": name, "meaning": word.meaning, "value": shown(value)}
            wrong.append(problem("said_twice", **values, other=word.key, there=shown(entries[word.key])))
            continue
        try:
            found[word.key] = word.in_key(value)
        except (QuantityError, ValueError) as error:
            wrong.append(Problem(f"{body}.{name}", str(error), shown(value)))
            # what stands there is not known, but something does
            found[word.key] = _within(table, word.key)
    return found, wrong


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
    value = "" if problem.value is None else f" = {problem.value}"
    return replace(
        problem, key=f"{body}.{word}", message=f"{key}{value}: {problem.message}", value=shown(entries[word])
    )


def _within(table: type[BaseModel], key: str) -> str:
    """Something that may stand at a key."""
    marker = next(quantities_of(table.model_fields[key]))
    low, high = (parse_quantity(text, marker.dimension) for text in (marker.low, marker.high))
    return f"{0.5 * (low + high)!r} {DIMENSIONS[marker.dimension].si_unit}"
