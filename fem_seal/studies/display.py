"""How a study's page looks: columns in words and readable units, one style for all plots."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fem_seal.arrays import FloatArray
from fem_seal.output.columns import COLUMNS
from fem_seal.seal.findings import Level
from fem_seal.studies.designs_table import LEAK_RATE, SHARES, Designs
from fem_seal.units import Display, Unit, kind_of, number
from fem_seal.wording import environment

if TYPE_CHECKING:
    import pandas as pd


# File in templates/: looks of the plots.
LOOKS = "study/looks.toml"
_NONE = Unit("", 1.0)
_DISTRIBUTIONS = {"LogUniform": "log-uniform", "LogNormal": "lognormal"}
# So many values can be named one by one.
FEW = 8
# Of designs that count and of those that do not, as in templates/study/looks.toml.
BLUE, GREY, RED = "#2f81f7", "#8c959f", "#b3261e"


@dataclass(frozen=True, eq=False)
class DesignDisplay:
    """How the columns of a study and its goals are shown.

    Parameters
    ----------
    designs : Designs
    """

    designs: Designs

    @property
    def units(self) -> Display:
        """In which units all quantities are shown: those of the base case."""
        about, seal = self.designs.about, self.designs.about["seal"]
        of_flow = Unit(*seal["leak_rate_unit"]) if seal.get("leak_rate_unit") else None
        return Display(about.get("units") or "field", seal.get("throughputs", False), of_flow)

    @property
    def words(self) -> Any:
        """Sentences and names of templates/study/words.j2."""
        return environment(self.units).get_template("study/words.j2").module

    def title(self, name: str) -> str:
        """What a column is called: a parameter or a response in words, without its SI unit; a formula by its name.

        The section of the parameters has their paths beside the words.
        """
        if name in self.designs.about["responses"]:
            return COLUMNS[name].words
        return self._words.get(name, name)

    def label(self, name: str) -> str:
        """What a column is called, with its unit."""
        unit = self.unit(name)
        return f"{self.title(name)} [{unit.name}]" if unit.name else self.title(name)

    def unit(self, name: str) -> Unit:
        """Unit of a column, by the largest value in it; without a name if it has none."""
        return self._units[name]

    def numbers(self, name: str) -> pd.Series:
        """A column of the designs that did not fail, or a goal of theirs, in SI."""
        return (
            self.designs.successes[name] if name in self.designs.successes else self.designs.goal_values[name]
        )

    def convert(self, name: str, values: ArrayLike) -> FloatArray:
        """SI numbers of a column in its unit."""
        unit = self.unit(name)
        return (np.asarray(values, dtype=float) - unit.zero) / unit.size

    def values(self, rows: pd.Index, name: str) -> list[Any]:
        """A column of some designs in its unit, None where there is no number; words as they are, "yes" and "no"."""
        column = self.numbers(name).loc[rows]
        if not self._numeric(name):
            return [_word(value) for value in column.tolist()]
        numbers = self.convert(name, column.to_numpy(dtype=float))
        return [value if math.isfinite(value) else None for value in numbers.tolist()]

    def axis_values(self, rows: pd.Index, name: str) -> list[Any]:
        """The same to be drawn: zeros stand below all other numbers of a logarithmic axis."""
        if not self.logarithmic(name):
            return self.values(rows, name)
        by_row = dict(zip(self.numbers(name).index, self._lifted_values(name).tolist(), strict=True))
        return [by_row[row] if math.isfinite(by_row[row]) else None for row in rows]

    def _lifted_values(self, name: str) -> FloatArray:
        return lift_zeros(self.convert(name, self.numbers(name).to_numpy(dtype=float)))

    def places(self, name: str, values: Iterable[Any]) -> list[Any]:
        """Numbers of a column in its unit as places on an axis that counts decades where it is logarithmic."""
        if not self.logarithmic(name):
            return list(values)
        return [value if value is None else math.log10(value) if value > 0 else -math.inf for value in values]

    def limits(self, name: str) -> tuple[float, float]:
        """Between which values of a column a design keeps the requirement and the constraints, in its unit."""
        low, high = self.convert(name, self.designs.allowed_range(name)).tolist()
        return low, high

    def ticks(self, name: str) -> tuple[list[float], list[str]]:
        """Places of the marks on the axis of a numeric column, as it is drawn, and their texts."""
        logarithmic = self.logarithmic(name)
        column = self._lifted_values(name) if logarithmic else self.convert(name, self.numbers(name))
        column = np.unique(column[np.isfinite(column)])
        if not column.size:
            return [], []
        if name in self.designs.parameters and 1 < len(column) <= FEW and _have_room(column, logarithmic):
            places = column.tolist()
        else:
            places = round_numbers(column[0], column[-1], logarithmic=logarithmic)
        texts = [short_number(place).removeprefix("1·") for place in places]
        if name in SHARES:
            texts = [f"{100.0 * place:g} %" for place in places]
        if not logarithmic or (self.numbers(name) != 0).all():
            return places, texts
        zero = self.words.zero(name.startswith("leak_rate"))
        above = [(place, text) for place, text in zip(places, texts, strict=True) if place > column[0]]
        return [column[0], *(place for place, _ in above)], [zero, *(text for _, text in above)]

    @property
    def sealed_count(self) -> int:
        """How many designs leak nothing, of those whose leak rate may be claimed."""
        if LEAK_RATE not in self.designs.successes:
            return 0
        return int(((self.designs.successes[LEAK_RATE] == 0) & ~self.designs.is_outside).sum())

    def texts(self, rows: pd.Index, name: str) -> list[str]:
        """A column of some designs as it is written."""
        if name in SHARES:
            return list(map(share_text, self.numbers(name).loc[rows].tolist()))
        if not self._numeric(name):
            return self.values(rows, name)
        texts = list(map(short_number, self.values(rows, name)))
        if name.startswith("leak_rate"):
            pairs = zip(texts, self.designs.is_outside.loc[rows], strict=True)
            return [
                self.words.zero(True) if text == "0" and not is_outside else text
                for text, is_outside in pairs
            ]
        return texts

    def levels(self, name: str) -> list[str]:
        """Words that a parameter takes, in the order of the user, as they are written."""
        return [_word(level) for level in self._parameters[name]["levels"]]

    def values_text(self, name: str) -> str:
        """Which values a parameter takes, in its unit."""
        parameter = self._parameters[name]
        if not parameter["numeric"]:
            return ", ".join(self.levels(name)[:FEW])
        low, high = map(short_number, self.convert(name, parameter["bounds"]).tolist())
        if parameter["distribution"]:
            kind = _DISTRIBUTIONS.get(parameter["distribution"], parameter["distribution"].lower())
            return f"{kind} from {low} to {high}"
        if len(parameter["levels"]) <= FEW:
            return ", ".join(map(short_number, self.convert(name, parameter["levels"]).tolist()))
        return f"{len(parameter['levels'])} levels from {low} to {high}"

    def logarithmic(self, name: str) -> bool:
        """Whether a logarithmic axis suits: a parameter by what it was asked to be, anything else by its values."""
        if not self._numeric(name) or self.unit(name).zero or name in SHARES:
            return False
        if name in self._parameters:
            return _varies_by_factors(self._parameters[name])
        return spans_a_decade(self.numbers(name).to_numpy(dtype=float))

    def axis(self, name: str) -> dict[str, Any]:
        """Axis of a plot; always with the same keys, so that one can replace another."""
        kind = ("log" if self.logarithmic(name) else "linear") if self._numeric(name) else "category"
        places, texts = self.ticks(name) if kind == "log" else (None, None)
        return {
            "title": {"text": self.label(name)},
            "automargin": True,
            "type": kind,
            "autorange": True,
            "tickmode": "array" if kind == "log" else "auto",
            "tickvals": places,
            "ticktext": texts,
            "tickformat": "~%" if name in SHARES else "",
            "exponentformat": "power",
            "hoverformat": ".4~g",
            "categoryorder": "array",
            "categoryarray": self.levels(name) if kind == "category" else [],
        }

    def hover(self, rows: pd.Index, names: Sequence[str]) -> list[str]:
        """What is shown of each design when pointed at: its number, some columns, what speaks against it."""
        columns = [[f"{self.label(name)}: {text}" for text in self.texts(rows, name)] for name in names]
        violations = [f"violates {text}" if text else "" for text in self.designs.violations.loc[rows]]
        levels, reasons = self.designs.validity.loc[rows], self.designs.worst_reason.loc[rows]
        doubts = [f"{level}: {why}" if why else "" for level, why in zip(levels, reasons, strict=True)]
        return [
            "<br>".join(line.replace("<", "&lt;") for line in (f"design {n}", *lines) if line)
            for n, *lines in zip(rows.tolist(), *columns, violations, doubts, strict=True)
        ]

    @property
    def columns(self) -> list[str]:
        """Columns of a table of the designs: parameters, responses, derived columns and goals."""
        designs, about = self.designs, self.designs.about
        return list(
            dict.fromkeys([*designs.parameters, *about["responses"], *about["derived"], *about["goals"]])
        )

    def describe(self, numbers: list[int]) -> dict[str, list[str]]:
        """What some designs are, as texts by their labels.

        All columns, the verdict if there is one, and the validity unless all are valid.
        """
        designs = self.designs
        rows = designs.successes.loc[numbers].index
        texts = {self.label(name): self.texts(rows, name) for name in self.columns}
        verdicts = designs.verdict.loc[numbers].tolist()
        texts |= {"verdict": verdicts} if any(verdicts) else {}
        levels = designs.validity.loc[numbers].tolist()
        return texts | ({"validity": levels} if set(levels) - {Level.VALID, ""} else {})

    @cached_property
    def _words(self) -> dict[str, str]:
        """Parameters in words; by their path where two of them would be called the same."""
        words = {name: self._parameter_words(name) for name in self.designs.parameters}
        labels = [*words.values(), *(COLUMNS[name].words for name in self.designs.about["responses"])]
        return {name: name if labels.count(label) > 1 else label for name, label in words.items()}

    @property
    def _parameters(self) -> dict[str, dict[str, Any]]:
        return {parameter["name"]: parameter for parameter in self.designs.about["parameters"]}

    @cached_property
    def _units(self) -> dict[str, Unit]:
        names = dict.fromkeys([*self.designs.successes, *self.designs.goal_values])
        return {name: self._choose_unit(name) for name in names}

    def _parameter_words(self, path: str) -> str:
        """The path of a parameter in words, "seat hardness" of seat.material.hardness."""
        *tables, key = path.split(".")
        # lists are counted from one where people read them
        parts = [
            str(int(table) + 1) if table.isdecimal() else table for table in tables if table not in _UNSAID
        ]
        return " ".join([*parts, self.words.called.get(key, key.replace("_", " "))])

    def _numeric(self, name: str) -> bool:
        return self.numbers(name).dtype.kind in "fiu"

    def _choose_unit(self, name: str) -> Unit:
        if not self._numeric(name):
            return _NONE
        if name in self._parameters:
            si = self._parameters[name]["unit"]
            kind = kind_of(name, si)
        elif name in self.designs.about["responses"]:
            si, kind = COLUMNS[name].unit, COLUMNS[name].kind
        else:
            # nobody wrote what a formula is a quantity of
            si, kind = "" if name in self.designs.successes else "SI", ""
        if not kind:
            return Unit(si, 1.0)
        # leak rates stand beside each other
        responses = self.designs.about["responses"]
        names = [response for response in responses if COLUMNS[response].kind == kind == "flow"] or [name]
        values = np.concatenate([self.numbers(response).to_numpy(dtype=float) for response in names])
        values = np.abs(values[np.isfinite(values)])
        return (
            self.units.shared_flow_unit(values.tolist())
            if kind == "flow"
            else self.units.unit_for(kind, float(values.max(initial=0.0)))
        )


# Parts of a path that say nothing more to a reader.
_UNSAID = ("material", "spectrum", "load", "roughness", "interface", "leak", "mesh")


def short_number(value: float | None, digits: int = 4) -> str:
    """A number with a few digits and without zeros at its end, "–" for none."""
    mantissa, times, power = number(value, digits).partition("·")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return mantissa + times + power


def share_text(share: float) -> str:
    """A share in percent, of which none is told as certain and none as impossible; "–" for none.

    Parameters
    ----------
    share : float
        0 to 1.

    Examples
    --------
    >>> share_text(0.9483), share_text(2.9e-170)
    ('94.8 %', '< 0.1 %')
    """
    if not math.isfinite(share):
        return "–"
    return "< 0.1 %" if share < 0.001 else "> 99.9 %" if share > 0.999 else f"{100.0 * share:.1f} %"


def spans_a_decade(values: FloatArray) -> bool:
    """Whether no number is negative and the largest is ten times the smallest above zero or more."""
    finite = values[np.isfinite(values)]
    positive = finite[finite > 0]
    return bool(positive.size and finite.min() >= 0 and positive.max() > 10 * positive.min())


# So much below the smallest number a zero stands on a logarithmic axis.
_ZERO_STEP = 10**-0.5


def lift_zeros(values: FloatArray) -> FloatArray:
    """Numbers on a logarithmic axis, where a zero, such as the leak rate of a sealed design, has no place of its own.

    Examples
    --------
    >>> lift_zeros(np.array([0.0, 1.0, 20.0])).round(2).tolist()
    [0.32, 1.0, 20.0]
    """
    positive = values[np.isfinite(values) & (values > 0)]
    return np.where(values == 0, _ZERO_STEP * positive.min(), values) if positive.size else values


def round_numbers(low: float, high: float, *, logarithmic: bool) -> list[float]:
    """About five round numbers from `low` to `high` for the marks of an axis, or more on a logarithmic one.

    Examples
    --------
    >>> round_numbers(0.5, 3.2, logarithmic=False)
    [1.0, 2.0, 3.0]
    >>> round_numbers(0.4, 7.0, logarithmic=True), round_numbers(3e-9, 8.0, logarithmic=True)
    ([0.5, 1.0, 2.0, 5.0], [1e-08, 1e-06, 0.0001, 0.01, 1.0])
    """
    if not logarithmic:
        step = (high - low or abs(low) or 1.0) / 5.0
        power = 10.0 ** math.floor(math.log10(step))
        step = power * next(size for size in (1.0, 2.0, 5.0, 10.0) if size * power >= 0.99 * step)
        return [float(f"{step * n:.12g}") for n in range(math.ceil(low / step), math.floor(high / step) + 1)]
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    apart = -(-(last - first) // 8)
    digits = range(1, 10) if high < 5.0 * low else (1, 2, 5) if last - first <= 3 else (1,)
    numbers = [
        float(f"{n}e{power}") for power in range(first, last + 1) if power % apart == 0 for n in digits
    ]
    return [size for size in numbers if 0.999 * low <= size <= 1.001 * high]


def _have_room(places: FloatArray, logarithmic: bool) -> bool:
    """Whether marks at all of these places are as far apart as their texts are high."""
    places = np.log10(places) if logarithmic else places
    return bool(np.diff(places).min() >= 0.05 * np.ptp(places))


def _varies_by_factors(parameter: dict[str, Any]) -> bool:
    """Whether a parameter was meant to vary by factors and not by differences; a zero may stand beside three others."""
    low, high = parameter["bounds"]
    if parameter["distribution"]:
        factor = high / low if low > 0 else 1.0
        return factor > {"LogUniform": 2.0, "LogNormal": 10.0}.get(parameter["distribution"], math.inf)
    levels = np.sort(np.asarray(parameter["levels"], dtype=float))
    positive = levels[levels > 0]
    if low < 0 or not positive.size or (low == 0 and len(positive) < 3):
        return False
    factor = high / positive[0]
    if factor < 2.0 or len(levels) < 3:
        return bool(factor > 10.0)
    return _is_evenly_spaced(np.log(positive)) or bool(factor > 10.0 and not _is_evenly_spaced(levels))


def _is_evenly_spaced(values: FloatArray) -> bool:
    steps = np.diff(values)
    return bool(np.ptp(steps) < 1e-6 * steps.max())


def _word(value: object) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    return str(value)
