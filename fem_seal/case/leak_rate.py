"""Leak rates as the field writes them: volumes, drops, bubbles, normal volumes, pressure times volume."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

from fem_seal.case.fields import Quantity
from fem_seal.case.words import problem
from fem_seal.errors import Problem, QuantityError
from fem_seal.units import NUMBER, parse_quantity, short_text
from leak.standards import (
    BUBBLE_VOLUME,
    DROP_VOLUME,
    STANDARD_PRESSURE,
    STANDARD_TEMPERATURE,
    STANDARDS,
    standard_named,
)


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
        found = cls(normal * temperature / STANDARD_TEMPERATURE)
        found.normal = normal
        return found


class Bubbles(float):
    """A leak rate [m^3/s] that was counted in bubbles, which have a volume in a case."""

    count: float
    """As it was written [1/s]."""

    @classmethod
    def of(cls, count: float, volume: float) -> Bubbles:
        """So many bubbles [1/s] of this volume [m^3]."""
        found = cls(count * volume)
        found.count = count
        return found

    @property
    def volume(self) -> float:
        """Of one bubble [m^3]."""
        return self / self.count


_COUNTED = re.compile(rf"({NUMBER})\s*(drop|bubble)s?\s*/\s*(s|min|h)")
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
        if counted := _COUNTED.fullmatch(plain):
            return self._counted(float(counted[1]), counted[2], counted[3])
        normal = _NORMAL_VOLUME.fullmatch(plain) or _NORMAL_WORD.fullmatch(plain)
        if normal:
            return NormalVolume.at(super().read(f"{normal[1]} {_WORDS.get(normal[2].lower(), normal[2])}"))
        try:
            throughput = parse_quantity(plain, "throughput")
        except QuantityError:
            return super().read(text)
        return Throughput(super().read(f"{throughput / STANDARD_PRESSURE!r} m^3/s"))

    def _counted(self, number: float, what: str, time: str) -> float:
        volume = BUBBLE_VOLUME if what == "bubble" else DROP_VOLUME
        rate = super().read(f"{number * volume!r} m^3/{time}")
        return Drops(rate) if what == "drop" else Bubbles.of(rate / volume, volume)


class Amounts(Protocol):
    """The tables of a case that say something of amounts."""

    @property
    def fluid(self) -> Any:
        """The table [fluid], or None."""

    @property
    def load(self) -> Any:
        """The table [load]."""

    @property
    def requirement(self) -> Any:
        """The table [requirement], or None."""


def of_this_gas(case: Amounts) -> tuple[dict[str, Any], list[Problem]]:
    """Tables of a case whose leak rates have the temperature of its gas and the bubbles that it names.

    Parameters
    ----------
    case : Amounts

    Returns
    -------
    tuple
        Changed tables, as `model_copy` takes them, and what cannot be told of their leak rates.
    """
    if case.fluid is None or case.fluid.gas is None:
        # which is said by those who look at the case as a whole
        return {}, []
    temperature, required = case.fluid.temperature, case.requirement
    limited = required is not None and not (required.leak_rate is None and required.standard is None)
    volume = _bubble_volume(case)
    changed, wrong = dict[str, Any](), list[Problem]()
    for table, key in _RATES:
        entries = changed.get(table, getattr(case, table))
        rate = None if entries is None else getattr(entries, key)
        if isinstance(rate, NormalVolume):
            told: float = NormalVolume.at(rate.normal, temperature)
        elif isinstance(rate, Bubbles) and volume is not None:
            told = Bubbles.of(rate.count, volume)
        elif isinstance(rate, Bubbles):
            wrong.append(problem("no_bubble" if limited else "no_bubble_of_target", key=f"{table}.{key}"))
            continue
        else:
            continue
        changed[table] = entries.model_copy(update={key: told})
    return changed, wrong


_RATES = (("load", "target_leak_rate"), ("requirement", "leak_rate"), ("requirement", "rated_capacity"))


def _bubble_volume(case: Amounts) -> float | None:
    """Of the case, or of the standard that it names [m^3]; None where it names neither."""
    required = case.requirement
    if required is None or required.bubble_volume is not None:
        return None if required is None else required.bubble_volume
    standard = None if required.standard is None else standard_named(required.standard)
    return None if standard is None else STANDARDS[standard].bubble_volume


def problems_with_leak_rates(case: Amounts) -> Iterator[Problem]:
    """What is said of gases only, or of liquids only; and a volume of bubbles that counts for nothing.

    Parameters
    ----------
    case : Amounts
    """
    if case.fluid is None:
        return
    gas = case.fluid.gas is not None
    for table, key in _RATES:
        entries = getattr(case, table)
        rate = None if entries is None else getattr(entries, key)
        wrong = _OF_LIQUIDS if gas else _OF_GASES
        for kind, said in wrong.items():
            if isinstance(rate, kind):
                fluid = "a gas" if gas else "a liquid"
                yield problem("rate_of_fluid", key=f"{table}.{key}", said=said, fluid=fluid)
    required = case.requirement
    if required is None or required.bubble_volume is None:
        return
    if not gas:
        yield Problem("requirement.bubble_volume", "is that of a gas, and the fluid is a liquid; remove it")


_OF_LIQUIDS: dict[type, str] = {Drops: "is counted in drops"}
_OF_GASES: dict[type, str] = {
    Throughput: "is pressure times volume over time, the leak rate of a gas",
    NormalVolume: "is a normal volume over time, the leak rate of a gas",
    Bubbles: "is counted in bubbles",
}
