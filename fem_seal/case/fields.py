"""Types of the entries of a case file: quantities, numbers and lists of pressures, each with its range.

Each is a marker inside `typing.Annotated`: it reads what the user wrote, checks the range and returns SI
floats, and it describes itself in the JSON Schema of the case file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, NamedTuple, get_args

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, core_schema

from fem_seal.errors import QuantityError, printable
from fem_seal.files import own_tables, problem
from fem_seal.units import DIMENSIONS, NUMBER, parse_quantity, short_text
from leak.standards import BUBBLE_VOLUME, DROP_VOLUME, STANDARD_PRESSURE, STANDARD_TEMPERATURE

# Pattern of a quantity, for schemas.
NUMBER_WITH_UNIT = rf"^\s*{NUMBER}(\s+\S|[^\s\d.eE]).*$"

# More loads than this in one case are a slip (num = 20000): a study is made of several cases.
MOST_PRESSURES = 1000
# Names of the forms in which an entry may be given; the messages leave them out.
FORMS = ("a table", "a name")


class Entry:
    """Base of the markers: how pydantic reads an entry and describes it."""

    def read(self, value: Any) -> Any:
        """Value in SI; ValueError if it is none of those that are allowed."""
        raise NotImplementedError

    def read_part(self, value: object, name: str) -> Any:
        """Value of one entry of a list or table; ValueError names it."""
        try:
            return self.read(value)
        except ValueError as error:
            raise ValueError(f"{name}, {show(value)}, {error}") from None

    @property
    def _schema(self) -> dict[str, Any]:
        """What stands about it in the JSON Schema of the case file."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return self._schema


@dataclass(frozen=True)
class Quantity(Entry):
    """A quantity with unit; `low` and `high` bound it, written as the user would, both allowed.

    Parameters
    ----------
    dimension : str
        One of `units.DIMENSIONS`.
    low, high : str
        Smallest and largest physical value.
    """

    dimension: str
    low: str
    high: str
    exclusive: bool = False

    @property
    def range(self) -> str:
        """Allowed range, for messages and docs."""
        return (
            f"above {self.low} and below {self.high}" if self.exclusive else f"from {self.low} to {self.high}"
        )

    def read(self, text: object) -> float:
        """Value in SI; ValueError if it is no such quantity or outside the range."""
        value = parse_quantity(text, self.dimension)
        low, high = _limits(self)
        is_inside = low < value < high if self.exclusive else low <= value <= high
        if not is_inside:
            raise ValueError(f"out of range; allowed is {self.range}")
        return value

    @property
    def _schema(self) -> dict[str, Any]:
        dimension = DIMENSIONS[self.dimension]
        return {"type": "string", "pattern": NUMBER_WITH_UNIT, "examples": [*dimension.examples]}


@cache
def _limits(quantity: Quantity) -> tuple[float, float]:
    """Both ends of its range, in SI."""
    return parse_quantity(quantity.low, quantity.dimension), parse_quantity(quantity.high, quantity.dimension)


@dataclass(frozen=True)
class AbsolutePressure(Quantity):
    """A pressure above vacuum."""

    def read(self, text: object) -> float:
        """Pressure in Pa; ValueError that says what a negative one is meant to be."""
        if (value := parse_quantity(text, self.dimension)) < 0:
            absolute = value + STANDARD_PRESSURE
            hint = f'; below the atmosphere it is "{absolute / 1e5:.6g} bar"' if absolute >= 0 else ""
            raise ValueError(f'is absolute: vacuum is "0 bar", the atmosphere "1.01325 bar"{hint}')
        return super().read(text)


@dataclass(frozen=True)
class OneOrMany(Quantity):
    """A quantity, or a list of quantities; a float or a tuple of floats in SI."""

    def read(self, value: object) -> float | tuple[float, ...]:  # type: ignore[override]
        """Value or values in SI in the user's order; ValueError names the entry that is wrong."""
        if not isinstance(value, (list, tuple)):
            return super().read(value)
        _check_count(value)
        return _read_each(self.element, value)

    @property
    def element(self) -> Quantity:
        """What each of them is."""
        return Quantity(self.dimension, self.low, self.high, self.exclusive)

    @property
    def _schema(self) -> dict[str, Any]:
        return {"anyOf": [self.element._schema, _list_of(self.element)]}


class OneOrRange(OneOrMany):
    """A quantity, or a range between two, "0.2 um to 0.4 um" or a list of both; a float or both ends, in SI."""

    def read(self, value: object) -> float | tuple[float, ...]:  # type: ignore[override]
        """Value, or lower and upper end, in SI; ValueError names what is wrong."""
        match = _RANGE.fullmatch(short_text(value, self.dimension)) if isinstance(value, str) else None
        entry = [f"{match[1]} {match[2] or match[4]}", f"{match[3]} {match[4]}"] if match else value
        ends = super().read(entry)
        if isinstance(ends, tuple) and isinstance(entry, (list, tuple)):
            low, high = ends if len(ends) == 2 else (1.0, 0.0)
            if not low < high <= _WIDEST * low:
                texts = [show(end) for end in entry]
                name = "wide_range" if low < high else "no_range"
                raise ValueError(problem(name, ends=" to ".join(texts), widest=_WIDEST))
        return ends


# "0.2 um to 0.4 um" and "0.2 to 0.4 um"; largest over smallest value.
_RANGE = re.compile(rf"\s*({NUMBER})\s*(\S*)\s+to\s+({NUMBER})\s*([^\s\d.]\S*)\s*")
_WIDEST = 20.0


class Chamber(Quantity):
    """Pressure of a chamber: a pressure, "vented" (zero) or "sealed" (None)."""

    def read(self, text: object) -> float | None:  # type: ignore[override]
        """Pressure in SI; ValueError if it is neither."""
        if isinstance(text, str) and text in _CHAMBERS:
            return _CHAMBERS[text]
        try:
            return super().read(text)
        except ValueError as error:
            raise ValueError(f'{error}; or write "vented" or "sealed"') from None

    @property
    def _schema(self) -> dict[str, Any]:
        return {"type": "string", "examples": ["vented", "3 bar"]}


_CHAMBERS: dict[str, float | None] = {"vented": 0.0, "sealed": None}


@dataclass(frozen=True)
class NominalSizeEntry(Quantity):
    """A nominal pipe size, "DN 25" or "NPS 1", or a length."""

    @property
    def range(self) -> str:
        """Allowed range, for messages and docs."""
        return f'"DN 25", "NPS 1" or a length {super().range}'

    def read(self, text: object) -> float:
        """Size in metres; ValueError if it is neither."""
        from leak.standards import read_nominal_size

        size = read_nominal_size(short_text(text, self.dimension)) if isinstance(text, str) else None
        if size is None and re.match(r"\s*(DN|NPS)\b", str(text), flags=re.IGNORECASE):
            raise ValueError(problem("nominal_size"))
        return super().read(text) if size is None else size

    @property
    def _schema(self) -> dict[str, Any]:
        return {
            "type": "string",
            "pattern": rf"^\s*({NUMBER}\s*\S.*|[dD][nN]\s*\d+|[nN][pP][sS]\s*\d.*)\s*$",
            "examples": ["DN 25", "NPS 1", "26.5 mm"],
        }


@dataclass(frozen=True)
class Number(Entry):
    """A number without unit between `low` and `high`, both allowed unless `exclusive_low`."""

    low: float
    high: float
    exclusive_low: bool = False

    @property
    def range(self) -> str:
        """Allowed range, for messages and docs."""
        return f"{'above' if self.exclusive_low else 'from'} {self.low:g} to {self.high:g}"

    def read(self, value: object) -> float:
        """Value as float; ValueError if it is no number or outside the range."""
        remedy = f"write a number {self.range}, without quotes and without unit"
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ValueError(f"is not a number; {remedy}")
        # compared before the conversion: an integer of 400 digits is no float
        is_inside = self.low < value <= self.high if self.exclusive_low else self.low <= value <= self.high
        if not is_inside:
            wrong_number = "out of range" if value == value else "is not a finite number"
            raise ValueError(f"{wrong_number}; {remedy}")
        return float(value)

    @property
    def _schema(self) -> dict[str, Any]:
        return {
            "type": "number",
            "exclusiveMinimum" if self.exclusive_low else "minimum": self.low,
            "maximum": self.high,
        }


@dataclass(frozen=True)
class Numbers(Entry):
    """A list of numbers, each within the range of `number`; a tuple after reading."""

    number: Number

    def read(self, value: object) -> tuple[float, ...]:
        """The numbers; ValueError names the entry that is wrong."""
        if not isinstance(value, (list, tuple)) or not 0 < len(value) <= MOST_PRESSURES:
            raise ValueError(f"must be a list of 1 to {MOST_PRESSURES} numbers, such as [0, 0.1]")
        return _read_each(self.number, value)

    @property
    def _schema(self) -> dict[str, Any]:
        return _list_of(self.number)


@dataclass(frozen=True)
class Place(Entry):
    """A point [r, z] of a section, two lengths; a tuple [m]."""

    element: Quantity

    @property
    def range(self) -> str:
        """Allowed range, for messages and docs."""
        return f"[r, z], each {self.element.range}"

    def read(self, value: object) -> tuple[float, float]:
        """The point; ValueError names the coordinate that is wrong."""
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            raise ValueError('must be [r, z], such as ["12 mm", "0 mm"]')
        r, z = (self.element.read_part(entry, name) for entry, name in zip(value, ("r", "z"), strict=True))
        return r, z

    @property
    def _schema(self) -> dict[str, Any]:
        return _list_of(self.element, 2, 2)


@dataclass(frozen=True)
class Several(Entry):
    """One value or a list of values; a tuple after reading."""

    element: Entry

    def read(self, value: object) -> tuple[Any, ...]:
        """Values in SI in the user's order; ValueError names the entry that is wrong."""
        entries = value if isinstance(value, (list, tuple)) else [value]
        _check_count(entries)
        return (self.element.read(entries[0]),) if len(entries) == 1 else _read_each(self.element, entries)

    @property
    def _schema(self) -> dict[str, Any]:
        return {"anyOf": [self.element._schema, _list_of(self.element)]}


class Pressures(Several):
    """One pressure, a list of pressures, or a range ``{ start, stop, num, spacing }``; a tuple [Pa]."""

    def read(self, value: object) -> tuple[float, ...]:
        """Pressures [Pa] in the user's order; ValueError names the entry that is wrong."""
        return self._read_range(value) if isinstance(value, dict) else super().read(value)

    def _read_range(self, table: dict[Any, Any]) -> tuple[float, ...]:
        keys = ("start", "stop", "num", "spacing")
        unknown = [show(key) for key in table if key not in keys]
        missing_keys = [key for key in keys[:3] if key not in table]
        if unknown or missing_keys:
            what = f"unknown key {unknown[0]}" if unknown else f"{missing_keys[0]} is missing"
            raise ValueError(f'{what}; write a range as {{ start = "1 bar", stop = "20 bar", num = 20 }}')
        start, stop = (self.element.read_part(table[key], key) for key in ("start", "stop"))
        num, spacing = table["num"], table.get("spacing", "linear")
        if not isinstance(num, int) or isinstance(num, bool) or not 2 <= num <= MOST_PRESSURES:
            raise ValueError(f"num, {show(num)}, must be a whole number from 2 to {MOST_PRESSURES}")
        if spacing not in ("linear", "log"):
            raise ValueError(f'spacing, {show(spacing)}, must be "linear" or "log"')
        if start >= stop:
            raise ValueError(problem("falling_range", start=show(table["start"]), stop=show(table["stop"])))
        if spacing == "log" and not start:
            raise ValueError(f"start, {show(table['start'])}, out of range of a logarithmic spacing")
        if spacing == "linear":
            return (*(start + (stop - start) * n / (num - 1) for n in range(num - 1)), stop)
        return (start, *(start * (stop / start) ** (n / (num - 1)) for n in range(1, num - 1)), stop)

    @property
    def _schema(self) -> dict[str, Any]:
        element = self.element._schema
        range_schema = {
            "type": "object",
            "properties": {
                "start": element,
                "stop": element,
                "num": {"type": "integer", "minimum": 2, "maximum": MOST_PRESSURES},
                "spacing": {"enum": ["linear", "log"], "default": "linear"},
            },
            "required": ["start", "stop", "num"],
            "additionalProperties": False,
        }
        return {"anyOf": [*super()._schema["anyOf"], range_schema]}


@dataclass(frozen=True)
class OverTemperatureTable(Entry):
    """A number of a material, or a table ``{ temperature, value }`` of it; a float or the pair of both as tuples.

    Parameters
    ----------
    element : Quantity or Number
        What each value is.
    """

    element: Quantity | Number

    @property
    def range(self) -> str:
        """Allowed range, for messages and docs."""
        return self.element.range

    def read(self, value: object) -> float | tuple[tuple[float, ...], tuple[float, ...]]:
        """The number, or temperatures [K] and values; ValueError names the entry that is wrong."""
        if not isinstance(value, Mapping):
            return self.element.read(value)
        if set(value) != {"temperature", "value"} or not all(
            isinstance(column, (list, tuple)) and column for column in value.values()
        ):
            raise ValueError(problem("over_temperature"))
        return (
            _read_each(TEMPERATURE, value["temperature"], "temperature"),
            _read_each(self.element, value["value"], "value"),
        )

    @property
    def _schema(self) -> dict[str, Any]:
        # in short: it stands at every number of every material
        columns = {"temperature": {"type": "array"}, "value": {"type": "array"}}
        table = {"type": "object", "properties": columns, "required": [*columns]}
        return {"anyOf": [self.element._schema, table]}


# Of a table over temperature.
TEMPERATURE = Quantity("temperature", "0 K", "3000 K")


def _check_count(entries: Sequence[object]) -> None:
    if not 0 < len(entries) <= MOST_PRESSURES:
        raise ValueError(f"has {len(entries)} entries; allowed are 1 to {MOST_PRESSURES}")


def _read_each(element: Entry, entries: Iterable[object], name: str = "entry") -> tuple[Any, ...]:
    return tuple(element.read_part(entry, f"{name} {n}") for n, entry in enumerate(entries, start=1))


def _list_of(element: Entry, fewest: int = 1, most: int = MOST_PRESSURES) -> dict[str, Any]:
    return {"type": "array", "items": element._schema, "minItems": fewest, "maxItems": most}


def show(value: object) -> str:
    """A value as the user would recognise it from the file, cut to one short line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        text = '"' + printable(value[:60]) + '"'
    elif isinstance(value, float) and math.isfinite(value):
        text = f"{value:g}"
    elif isinstance(value, int) and abs(value) > 10**18:
        return "a number of more than 18 digits"
    elif isinstance(value, dict):
        return "{ ... }"
    elif isinstance(value, (list, tuple)) and len(value) <= 3:
        text = "[" + ", ".join(map(show, value)) + "]"
    else:
        text = repr(value)
    return text if len(text) <= 60 else text[:56] + " ..."


class Table(BaseModel):
    """Base of all tables: frozen, unknown keys refused, nothing converted silently."""

    # built when it is first read: what stands in other tables is built with those, and not twice
    model_config: ClassVar[ConfigDict] = ConfigDict(
        extra="forbid", frozen=True, strict=True, validate_default=False, defer_build=True
    )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        reference = handler(schema)
        properties = handler.resolve_ref_schema(reference)
        properties.setdefault("description", about(cls))
        for name, entry in properties.get("properties", {}).items():
            key = key_of(cls, name)
            entries_of_key = {"description": key.meaning, "examples": key.examples, "default": key.default}
            entry.update({word: value for word, value in entries_of_key.items() if value})
        return reference


class Key(NamedTuple):
    """What is said of a key of a table.

    Parameters
    ----------
    meaning : str
        Empty where it is a table of its own.
    example : object
        None where it has none.
    default : str
        Default of a quantity as it is written; empty for all others.
    """

    meaning: str = ""
    example: Any = None
    default: str = ""

    @property
    def examples(self) -> list[Any]:
        """The example in a list; an empty one without."""
        return [] if self.example is None else [self.example]


def key_of(table: type[BaseModel], name: str) -> Key:
    """What a key of a table means: the entry of the table in templates/keys.toml, or of one that it is made from.

    Parameters
    ----------
    table : type
    name : str
    """
    keys = own_tables("keys.toml")
    return next(
        (Key(*keys[t.__name__][name]) for t in table.__mro__ if name in keys.get(t.__name__, ())), Key()
    )


def about(table: type[BaseModel]) -> str:
    """What a table is: its docstring; of a shape, which is made of its maker, its entry in templates/keys.toml.

    Parameters
    ----------
    table : type
    """
    return table.__doc__ or own_tables("keys.toml")["shapes"][table.__name__]


class WholeNumber(Number):
    """A whole number between `low` and `high`."""

    @property
    def range(self) -> str:
        """Allowed range, for messages and docs."""
        return f"from {int(self.low)} to {int(self.high)}"

    def read(self, value: object) -> int:
        """Value as int; ValueError if it is no whole number in the range."""
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError(problem("no_whole_number", range=self.range))
        super().read(value)
        return value

    @property
    def _schema(self) -> dict[str, Any]:
        return {"type": "integer", "minimum": int(self.low), "maximum": int(self.high)}


def quantities_of(field: FieldInfo) -> Iterator[Quantity]:
    """Quantities that may stand at a field, also at one that may be left open."""
    return (value for value in values_of(field) if isinstance(value, Quantity))


def values_of(field: FieldInfo) -> Iterator[Quantity | Number]:
    """What one value at a field may be: of several pressures, a place or a table over temperature each of them."""
    for marker in (*field.metadata, *_markers(field.annotation)):
        value = getattr(marker, "element", marker)
        if isinstance(value, (Quantity, Number)):
            yield value


def _markers(annotation: Any) -> Iterator[Any]:
    yield from getattr(annotation, "__metadata__", ())
    for member in get_args(annotation):
        yield from _markers(member)


class Throughput(float):
    """A leak rate [m^3/s] that was written as pressure times volume over time, which is said of gases only."""

    @property
    def pressure_volume(self) -> float:
        """As it was written [Pa m^3/s]."""
        return self * STANDARD_PRESSURE


class Drops(float):
    """A leak rate [m^3/s] that was counted in drops, which liquids fall in."""


class NormalVolume(float):
    """A leak rate [m^3/s] of a gas that was written at 0 degC, and has the gas's own temperature in a case."""

    normal: float
    """As it was written, at 0 degC and 101325 Pa [m^3/s]."""

    @classmethod
    def at(cls, normal: float, temperature: float = STANDARD_TEMPERATURE) -> NormalVolume:
        """The same amount of gas at a temperature [K]."""
        rate = cls(normal * temperature / STANDARD_TEMPERATURE)
        rate.normal = normal
        return rate


class Bubbles(float):
    """A leak rate [m^3/s] that was counted in bubbles, which have a volume in a case."""

    count: float
    """As it was written [1/s]."""

    @classmethod
    def of(cls, count: float, volume: float) -> Bubbles:
        """So many bubbles [1/s] of this volume [m^3]."""
        rate = cls(count * volume)
        rate.count = count
        return rate

    @property
    def volume(self) -> float:
        """Of one bubble [m^3]."""
        return self / self.count


_DROPS_OR_BUBBLES = re.compile(rf"({NUMBER})\s*(drop|bubble)s?\s*/\s*(s|min|h)")
# N in a leak rate is normal; that of a force has no litres behind it.
_NORMAL_VOLUME = re.compile(rf"({NUMBER})\s*(?:N\s?|normal |standard )([^/\s]+\s*/\s*(?:s|min|h))")
_NORMAL_WORD = re.compile(rf"({NUMBER})\s*(sccm|sccs|slm|slpm)", re.IGNORECASE)
_WORDS = {"sccm": "cm^3/min", "sccs": "cm^3/s", "slm": "l/min", "slpm": "l/min"}


@dataclass(frozen=True)
class LeakRate(Quantity):
    """A leak rate: a volume over time, drops of a liquid; of a gas bubbles, normal volume, or pressure times volume."""

    def read(self, text: object) -> float:
        """Volume over time [m^3/s], one of the classes above where that was written; ValueError as of a quantity."""
        if not isinstance(text, str):
            return super().read(text)
        plain = " ".join(short_text(text, self.dimension).split())
        if match := _DROPS_OR_BUBBLES.fullmatch(plain):
            return self._read_count(float(match[1]), match[2], match[3])
        normal = _NORMAL_VOLUME.fullmatch(plain) or _NORMAL_WORD.fullmatch(plain)
        if normal:
            return NormalVolume.at(super().read(f"{normal[1]} {_WORDS.get(normal[2].lower(), normal[2])}"))
        try:
            throughput = parse_quantity(plain, "throughput")
        except QuantityError:
            return super().read(text)
        return Throughput(super().read(f"{throughput / STANDARD_PRESSURE!r} m^3/s"))

    def _read_count(self, number: float, what: str, time: str) -> float:
        volume = BUBBLE_VOLUME if what == "bubble" else DROP_VOLUME
        rate = super().read(f"{number * volume!r} m^3/{time}")
        return Drops(rate) if what == "drop" else Bubbles.of(rate / volume, volume)


# Where leak rates stand in a case.
RATES = (("load", "target_leak_rate"), ("requirement", "leak_rate"), ("requirement", "rated_capacity"))
OF_LIQUIDS: dict[type, str] = {Drops: "is counted in drops"}
OF_GASES: dict[type, str] = {
    Throughput: "is pressure times volume over time, the leak rate of a gas",
    NormalVolume: "is a normal volume over time, the leak rate of a gas",
    Bubbles: "is counted in bubbles",
}
