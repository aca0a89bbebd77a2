"""What the page says of a screen: numbers with units and no more digits than they are worth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fem_seal.analysis.caution import Level
from fem_seal.explore.screen import Screen, ShownLoad
from fem_seal.output.report.words import state_in_words
from fem_seal.units import LIQUID, LeakVolume, given, leak_range_text, leak_rate_text, quantity_worth

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


def leak_words(load: ShownLoad, volume: LeakVolume = LIQUID) -> str:
    """The leak rate of a load, an interval where there is one."""
    rate, low, high = (load.values[f"leak_rate_{end}m3_per_s"] for end in ("", "low_", "high_"))
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

    wider = "; what is not known widens it when the sliders rest" if screen.widens else ""
    wider = "; that of the round seal until the sliders rest" + wider if screen.round else wider
    at = given("fluid pressure", values["fluid_pressure_Pa"])
    state = state_in_words(screen.volume)
    wider = f"; {state}{wider}" if state else wider
    leak = (
        leak_words(load, screen.volume)
        if math.isfinite(values["leak_rate_m3_per_s"]) or not screen.waiting
        else "calculating ..."
    )
    found = [
        Number("leak", "leak rate", leak, f"at {at}{wider}", values["leak_rate_m3_per_s"]),
        number("peak", "peak contact pressure", "contact pressure", "peak_pressure_Pa"),
        number("width", "contact width (FWHM)", "length", "fwhm_m"),
        number("force", "force on the seat", "force", "contact_force_N", "of spring and fluid together"),
        number("line", "line load", "line load", "line_load_N_per_m"),
    ]
    if load.classes:
        found.append(Number("classes", "leakage class", load.classes[0], ", ".join(load.classes[1:])))
    return found


def changed(factors: Factors, design: dict[str, str], others: Sequence[dict[str, str]]) -> list[str]:
    """Keys of factors in which some designs differ."""
    keys = [*(one.key for one in factors.sliders), "fluid"]
    return [key for key in keys if len({one.get(key) for one in (design, *others)}) > 1]


def validity_words(load: ShownLoad, as_round: bool = False) -> tuple[str, str]:
    """How far a load can be trusted: the class of its colour, and the words.

    Parameters
    ----------
    load : ShownLoad
    as_round : bool
        Whether its form error is not known yet; then nothing is called good.
    """
    colour = {str(Level.VALID): "good", str(Level.DOUBTFUL): "warn"}.get(load.level, "bad")
    if as_round and colour == "good":
        return "", "within the theory as a round seal; its form error follows"
    return colour, {"good": "within the theory"}.get(colour, load.level)
