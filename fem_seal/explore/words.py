"""What the page says of a screen: numbers with units and no more digits than they are worth."""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from fem_seal.explore.screen import LEAK, Screen, ShownLoad
from fem_seal.output.report.words import state_in_words
from fem_seal.seal.findings import Level
from fem_seal.units import LeakVolume, duration, given, leak_range_text, leak_rate_text, quantity_worth

if TYPE_CHECKING:
    from fem_seal.explore.factors import Factors


@dataclass(frozen=True)
class Number:
    """A number of the page.

    Parameters
    ----------
    name : str
        Short, unique on the page.
    what : str
        What it is.
    value : str
        With unit.
    more : str
        A remark below it.
    si : float or None
        The number itself in SI.
    """

    name: str
    what: str
    value: str
    more: str = ""
    si: float | None = None


@dataclass(frozen=True)
class Shown:
    """A design on the page, and what is said of it.

    Parameters
    ----------
    screen : Screen
    name : str
    colour : str
        Of its lines.
    """

    screen: Screen
    name: str
    colour: str

    @cached_property
    def numbers(self) -> dict[str, Number]:
        """Its numbers by their names."""
        return {one.name: one for one in numbers_of(self.screen)}

    @property
    def validity(self) -> tuple[str, str]:
        """See `validity_words`; without a load there is none."""
        return validity_words(self.screen) if self.screen.load else ("", "–")


def leak_words(load: ShownLoad, volume: LeakVolume) -> str:
    """The leak rate of a load, an interval where there is one."""
    rate, low, high = (load.values[name] for name in LEAK)
    if not math.isfinite(rate) and not math.isfinite(low):
        return "–"
    digits, claimed = load.digits["leak_rate_m3_per_s"], load.level != str(Level.OUTSIDE)
    if math.isfinite(low) and math.isfinite(high):
        return leak_range_text((low, high), digits, claimed=claimed, volume=volume)
    return leak_rate_text(rate, digits, claimed=claimed, volume=volume)


def numbers_of(screen: Screen) -> list[Number]:
    """The numbers of the load that is shown.

    Parameters
    ----------
    screen : Screen
    """
    load = screen.load
    if load is None:
        return []
    values = load.values

    def number(name: str, what: str, kind: str, column: str, more: str = "") -> Number:
        return Number(
            name, what, quantity_worth(kind, values[column], load.digits[column]), more, values[column]
        )

    at = f"at {given('fluid pressure', values['fluid_pressure_Pa'])}"
    more = "; ".join(filter(None, [at, state_in_words(screen.volume), preliminary_words(screen)]))
    rate = values["leak_rate_m3_per_s"]
    waits = screen.waiting and not math.isfinite(rate)
    leak = "calculating ..." if waits else leak_words(load, screen.volume)
    found = [
        Number("leak", "leak rate", leak, more, rate),
        number("peak", "peak contact pressure", "contact pressure", "peak_pressure_Pa"),
        number("width", "contact width (FWHM)", "length", "fwhm_m"),
        number("force", "force on the seat", "force", "contact_force_N", "of spring and fluid together"),
        number("line", "line load", "line load", "line_load_N_per_m"),
    ]
    if load.classes and preliminary_words(screen):
        # a class is met by a whole interval or not at all
        found.append(Number("classes", "leakage class", "–", "follows with the range of the leak rate"))
    elif load.classes:
        found.append(Number("classes", "leakage class", load.classes[0], ", ".join(load.classes[1:])))
    return found


def preliminary_words(screen: Screen) -> str:
    """Why the leak rate and its interval are not those of `fem-seal run` yet; empty if they are.

    Parameters
    ----------
    screen : Screen
    """
    return "preliminary, inputs at their nominal values" if screen.widens else ""


def validity_words(screen: Screen) -> tuple[str, str]:
    """How far the shown load can be trusted: the class of its colour, and the words.

    What is preliminary is never called good.

    Parameters
    ----------
    screen : Screen
        With a load.
    """
    assert screen.load is not None
    colour = {str(Level.VALID): "good", str(Level.DOUBTFUL): "warn"}.get(screen.load.level, "bad")
    words = "within the theory" if colour == "good" else screen.load.level
    if preliminary := preliminary_words(screen):
        return "" if colour == "good" else colour, f"{words}; {preliminary}"
    return colour, words


def slow_words(seconds: float) -> str:
    """That a design takes too long to follow the sliders.

    Parameters
    ----------
    seconds : float
        Estimated processor time [s].
    """
    return f"Each change takes about {duration(seconds)}; it is calculated when the sliders rest."


def lost_words(code: int, again: bool, left: bool) -> str:
    """What became of a process of the page.

    Parameters
    ----------
    code : int
        With which it ended; minus the number of the signal that killed it.
    again : bool
        Whether another one does its work again.
    left : bool
        Whether it is not tried again, since it has ended two.
    """
    try:
        how = f"was killed ({signal.Signals(-code).name})" if code < 0 else f"ended with code {code}"
    except ValueError:
        how = f"was killed (signal {-code})"
    perhaps = "; the system does so where memory runs out" if code == -9 else ""
    said = f"At {time.strftime('%H:%M:%S')} a process of this page {how}{perhaps}."
    if left:
        return f"{said} It was the second one over the same work, which is not tried again by itself."
    return f"{said} Another one has taken its place{' and begins its work anew' if again else ''}."


def not_taken_words(factors: Factors, design: Mapping[str, str], wrong: Mapping[str, str]) -> str:
    """That texts stand in fields that are not calculated with, and what is; empty if there are none.

    Parameters
    ----------
    factors : Factors
    design : mapping
        That the numbers belong to.
    wrong : mapping
        From keys of factors to the texts that stand in their fields.
    """
    labels = {key: label for key, label in factors.labels.items() if key in wrong}
    if not labels:
        return ""
    refused = "; ".join(f'{label} = "{wrong[key]}"' for key, label in labels.items())
    return f"Not taken: {refused}. The numbers belong to {_inputs(labels, design)}."


def refused_words(screen: Screen, shown: Mapping[str, str]) -> dict[str, str]:
    """What is said at the fields of a design that cannot be calculated, by the keys of their factors.

    Parameters
    ----------
    screen : Screen
    shown : mapping
        The design that is still shown.
    """
    if not screen.problem:
        return {}
    moved = {
        key: f"What is shown belongs to {shown[key]}."
        for key, text in screen.design.items()
        if key in shown and shown[key] != text
    }
    return moved | screen.wrong


def still_words(factors: Factors, design: Mapping[str, str], shown: Mapping[str, str]) -> str:
    """Which inputs the faded numbers of an earlier design belong to.

    Parameters
    ----------
    factors : Factors
    design : mapping
        That cannot be calculated.
    shown : mapping
        That is still shown.
    """
    other = {
        key: label for key, label in factors.labels.items() if key in shown and shown[key] != design.get(key)
    }
    if not other:
        return ""
    return f"The faded numbers and pictures still belong to {_inputs(other, shown)}."


def _inputs(labels: Mapping[str, str], design: Mapping[str, str]) -> str:
    return "; ".join(f"{label} = {design[key]}" for key, label in labels.items() if key in design)
