"""Leak rates as the field writes them: volumes, drops, bubbles, normal volumes, pressure times volume."""

from __future__ import annotations

import re
from dataclasses import dataclass

from fem_seal.case.fields import Quantity
from fem_seal.errors import QuantityError
from fem_seal.units import NUMBER, parse_quantity, short_text
from leak.standards import BUBBLE_VOLUME, DROP_VOLUME, STANDARD_PRESSURE, STANDARD_TEMPERATURE


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


# Where leak rates stand in a case.
RATES = (("load", "target_leak_rate"), ("requirement", "leak_rate"), ("requirement", "rated_capacity"))
OF_LIQUIDS: dict[type, str] = {Drops: "is counted in drops"}
OF_GASES: dict[type, str] = {
    Throughput: "is pressure times volume over time, the leak rate of a gas",
    NormalVolume: "is a normal volume over time, the leak rate of a gas",
    Bubbles: "is counted in bubbles",
}
