"""Tables of a study file: parameters with their levels or distribution, all other keys, and the JSON Schema."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from fem_seal.arrays import FloatArray
from fem_seal.case.fields import Quantity, Table, WholeNumber, show
from fem_seal.case.paths import Entry, Value
from fem_seal.case.schema import as_schema
from fem_seal.errors import InputError
from fem_seal.files import problem
from fem_seal.output.columns import LEAK_COLUMNS
from fem_seal.sampling import Distribution, LogNormal, LogUniform, Normal, Uniform
from fem_seal.units import parse_quantity

_MOST_LEVELS = 100_000
RANGE_KEYS = ("start", "stop", "num", "spacing")


@dataclass(frozen=True)
class Parameter:
    """One entry of the case and what it may become.

    Parameters
    ----------
    entry : Entry
    levels : tuple, optional
        Its values in SI, texts or truth values, in the user's order.
    distribution : Distribution, optional
        Instead of levels.
    """

    entry: Entry
    levels: tuple[Value, ...] = ()
    distribution: Distribution | None = None

    @property
    def name(self) -> str:
        """Path of the entry, the name of its column."""
        return self.entry.path

    @property
    def numeric(self) -> bool:
        """Whether its values are numbers."""
        return self.entry.numeric

    def values(self, share: FloatArray) -> FloatArray:
        """Numbers that stand for the values, see `value`, at shares between 0 and 1 of the distribution."""
        if self.distribution is not None:
            return self.distribution.quantile(share)
        index = np.minimum((share * len(self.levels)).astype(int), len(self.levels) - 1)
        return self.numbers[index]

    @property
    def numbers(self) -> FloatArray:
        """The levels as numbers: themselves, or their places in the list for texts."""
        if self.numeric:
            return np.array(self.levels, dtype=float)
        return np.arange(len(self.levels), dtype=float)

    def value(self, number: float) -> Value:
        """Value that a number stands for."""
        return float(number) if self.numeric else self.levels[int(number)]

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest number."""
        if self.distribution is not None:
            return self.distribution.bounds
        return float(self.numbers.min()), float(self.numbers.max())


def entries(parameters: Sequence[Parameter], point: Sequence[float] | FloatArray) -> dict[str, Any]:
    """Entries of the case in a design, as they would be written in a case file.

    Parameters
    ----------
    parameters : sequence of Parameter
    point : sequence of float
        Number of each, see `Parameter.value`.
    """
    return {
        parameter.name: parameter.entry.write(parameter.value(number))
        for parameter, number in zip(parameters, point, strict=True)
    }


def design_text(parameters: Sequence[Parameter], point: Sequence[float] | FloatArray) -> str:
    """A design for people: the values of its parameters, see `entries`."""
    values = zip(parameters, point, strict=True)
    return ", ".join(
        f"{parameter.name} = {parameter.entry.show(parameter.value(number))}" for parameter, number in values
    )


def read_parameter(entry: Entry, values: object) -> Parameter:
    """The parameter that stands in a study file.

    Parameters
    ----------
    entry : Entry
    values : list or dict
        Levels, a range, or a distribution.

    Raises
    ------
    InputError
    """
    key = f"parameters.{entry.path}"
    if isinstance(values, (list, tuple)):
        return Parameter(entry, _levels(entry, key, list(values)))
    if isinstance(values, Mapping) and "distribution" in values:
        return Parameter(entry, distribution=_distribution(entry, key, values))
    if isinstance(values, Mapping):
        return Parameter(entry, _range(entry, key, values))
    raise InputError(problem("study_parameter", path=entry.path, given=show(values)))


def _levels(entry: Entry, key: str, entries: list[object]) -> tuple[Value, ...]:
    if not 0 < len(entries) <= _MOST_LEVELS:
        raise InputError.at(key, f"has {len(entries)} values; allowed are 1 to {_MOST_LEVELS}")
    values = tuple(_read(entry, key, value) for value in entries)
    doubles = [level for n, level in enumerate(values) if level in values[:n]] if len(values) < 1000 else []
    if doubles:
        raise InputError.at(key, f"names {show(entries[values.index(doubles[0])])} twice; remove one")
    return values


def _read(entry: Entry, key: str, value: object) -> Value:
    try:
        return entry.read(value)
    except ValueError as error:
        raise InputError.at(key, str(error), show(value)) from None


def _range(entry: Entry, key: str, table: Mapping[str, Any]) -> tuple[Value, ...]:
    example = '{ start = "30 deg", stop = "60 deg", num = 7, spacing = "linear" or "log" }'
    _check_keys(key, table, RANGE_KEYS, RANGE_KEYS[:3], example)
    if not entry.numeric:
        raise InputError.at(key, "holds words, which have no range; write a list")
    start, stop = (float(_read(entry, f"{key}.{name}", table[name])) for name in ("start", "stop"))
    num, spacing = table["num"], table.get("spacing", "linear")
    if isinstance(num, bool) or not isinstance(num, int) or not 2 <= num <= _MOST_LEVELS:
        raise InputError.at(f"{key}.num", f"must be a whole number from 2 to {_MOST_LEVELS}", show(num))
    if spacing not in ("linear", "log"):
        raise InputError.at(f"{key}.spacing", 'must be "linear" or "log"', show(spacing))
    if not start < stop:
        raise InputError.at(f"{key}.start", "must be below stop", show(table["start"]))
    if spacing == "log" and start <= 0:
        raise InputError.at(f"{key}.start", 'must be above zero with spacing = "log"', show(table["start"]))
    shares = [n / (num - 1) for n in range(1, num - 1)]
    inner = [
        start + (stop - start) * t if spacing == "linear" else start * math.exp(math.log(stop / start) * t)
        for t in shares
    ]
    return (start, *inner, stop)


def _distribution(entry: Entry, key: str, table: Mapping[str, Any]) -> Distribution:
    kind = table["distribution"]
    if kind not in DISTRIBUTIONS:
        kinds = ", ".join(f'"{name}"' for name in DISTRIBUTIONS)
        raise InputError.at(f"{key}.distribution", f"must be one of {kinds}", show(kind))
    if not entry.numeric:
        raise InputError.at(key, "holds words, which have no distribution; write a list")
    numbers, make = DISTRIBUTIONS[kind]
    example = "{ " + ", ".join([f'distribution = "{kind}"', *(f"{name} = ..." for name in numbers)]) + " }"
    _check_keys(key, table, ("distribution", *numbers), numbers, example)
    distribution = make(entry, key, table)
    for limit in distribution.bounds:
        try:
            entry.check(limit)
        except ValueError as error:
            raise InputError.at(key, f"reaches {entry.show(limit)}, which is {error}") from None
    return distribution


def _uniform(entry: Entry, key: str, table: Mapping[str, Any]) -> Distribution:
    low, high = (float(_read(entry, f"{key}.{name}", table[name])) for name in ("low", "high"))
    if not low < high:
        raise InputError.at(f"{key}.low", "must be below high", show(table["low"]))
    if table["distribution"] == "uniform":
        return Uniform(low, high)
    if low <= 0:
        raise InputError.at(f"{key}.low", "must be above zero", show(table["low"]))
    return LogUniform(low, high)


def _normal(entry: Entry, key: str, table: Mapping[str, Any]) -> Distribution:
    mean = float(_read(entry, f"{key}.mean", table["mean"]))
    return Normal(mean, _width(entry, f"{key}.std", table["std"]))


def _lognormal(entry: Entry, key: str, table: Mapping[str, Any]) -> Distribution:
    median = float(_read(entry, f"{key}.median", table["median"]))
    relative = table["relative"]
    if isinstance(relative, bool) or not isinstance(relative, (int, float)) or not 0 < relative <= 1:
        raise InputError(problem("study_relative_width", key=f"{key}.relative", given=show(relative)))
    if median <= 0:
        raise InputError.at(f"{key}.median", "must be above zero", show(table["median"]))
    return LogNormal(median, float(relative))


# Keys of each distribution, and what makes it of them.
DISTRIBUTIONS: dict[str, tuple[tuple[str, ...], Callable[[Entry, str, Mapping[str, Any]], Distribution]]] = {
    "uniform": (("low", "high"), _uniform),
    "log-uniform": (("low", "high"), _uniform),
    "normal": (("mean", "std"), _normal),
    "lognormal": (("median", "relative"), _lognormal),
}


def _width(entry: Entry, key: str, value: object) -> float:
    """A standard deviation: of the entry's dimension, but not inside its range."""
    try:
        if isinstance(entry.marker, Quantity):
            width = parse_quantity(value, entry.marker.dimension)
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            width = float(value)
        else:
            raise ValueError("is not a number")
    except ValueError as error:
        raise InputError.at(key, str(error), show(value)) from None
    if not (math.isfinite(width) and width > 0):
        raise InputError.at(key, "must be above zero", show(value))
    return width


def _check_keys(
    key: str, table: Mapping[str, Any], keys: tuple[str, ...], required_keys: tuple[str, ...], example: str
) -> None:
    unknown = [name for name in table if name not in keys]
    missing_keys = [name for name in required_keys if name not in table]
    if unknown or missing_keys:
        fault = f"has an unknown key {show(unknown[0])}" if unknown else f"lacks {missing_keys[0]}"
        raise InputError.at(key, f"{fault}; write {example}")


MOST_POINTS = 10_000_000


Kind = Literal["grid", "list", "latin-hypercube", "sobol", "sobol-sensitivity", "morris"]


class Design(Table):
    """[design]: which designs are calculated."""

    kind: Kind = "grid"
    file: str | None = None
    num: Annotated[int, WholeNumber(1, MOST_POINTS)] | None = None
    seed: Annotated[int, WholeNumber(0, 2**31 - 1)] = 1
    invalid: Literal["refuse", "skip"] = "refuse"


class Run(Table):
    """[run]: how the designs are calculated."""

    interpolate_surfaces: bool = True
    retries: Annotated[int, WholeNumber(0, 20)] = 3
    time_limit: Annotated[float, Quantity("time", "1 s", "1000 h")] = 1800.0
    keep_fields: tuple[int, ...] | Literal["none", "best"] = "none"


class Report(Table):
    """[report]: what the page shows."""

    goals: dict[str, Literal["min", "max"]] = Field(default_factory=dict)
    standard: Literal["ISO 5208", "API 598", "FCI 70-2"] = "ISO 5208"


class Optimise(Table):
    """[optimise]: look for the best design instead of calculating a given set."""

    minimise: str | tuple[str, ...] | None = None
    maximise: str | tuple[str, ...] | None = None
    trials: Annotated[int, WholeNumber(1, 1_000_000)] = 100
    batch: Annotated[int, WholeNumber(1, 1000)] = 4
    seed: Annotated[int, WholeNumber(0, 2**31 - 1)] = 1


class StudyTables(Table):
    """A study: one case turned into many."""

    title: str = ""
    base: str
    changes: dict[str, Any] = Field(default_factory=dict)
    parameters: dict[str, Any] = Field(default_factory=dict)
    design: Design = Design()
    responses: tuple[str, ...] = ("peak_pressure_Pa", "fwhm_m", "leak_rate_m3_per_s")
    derived: dict[str, str] = Field(default_factory=dict)
    constraints: dict[str, str] = Field(default_factory=dict)
    outside_theory: Literal["leave out", "keep"] = "leave out"
    run: Run = Run()
    report: Report = Report()
    optimise: Optimise | None = None


def study_schema() -> dict[str, Any]:
    """JSON Schema of what may stand in a study file.

    Returns
    -------
    dict
        Draft 2020-12. Which entries a case has, and what may stand there, is beyond a schema; `load_study` checks it.

    Examples
    --------
    >>> study_schema()["required"]
    ['base']
    """
    schema = StudyTables.model_json_schema(mode="validation")
    schema["description"] = (
        "One case turned into many; entries of the case are named by their path, seat.angle."
    )
    schema["properties"]["parameters"]["additionalProperties"] = _parameter()
    schema["properties"]["responses"]["items"] = {"enum": list(LEAK_COLUMNS)}
    return as_schema("fem-seal study", schema)


def _parameter() -> dict[str, Any]:
    """A list of levels; as a table a range, a distribution, or the paths below the one that is its key."""
    limits = {"num": {"type": "integer", "minimum": 2}, "spacing": {"enum": ["linear", "log"]}}
    one_of_them = [
        {
            "if": {"properties": {"distribution": {"const": name}}},
            "then": _object_schema({key: {} for key in ("distribution", *keys)}, keys),
        }
        for name, (keys, _) in DISTRIBUTIONS.items()
    ]
    distribution = {"properties": {"distribution": {"enum": list(DISTRIBUTIONS)}}, "allOf": one_of_them}
    return {
        "type": ["array", "object"],
        "additionalProperties": True,
        "allOf": [
            {"if": {"type": "object", "required": ["distribution"]}, "then": distribution},
            {
                "if": {"type": "object", "required": ["start"]},
                "then": _object_schema({key: limits.get(key, {}) for key in RANGE_KEYS}, RANGE_KEYS[:3]),
            },
        ],
    }


def _object_schema(properties: dict[str, Any], keys: Sequence[str]) -> dict[str, Any]:
    return {"properties": properties, "required": list(keys), "additionalProperties": False}
