"""The leak rate by the other theory of the rough contact, and why the two differ."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.prose import said
from fem_seal.output.shown import Section, Shown
from fem_seal.seal.load_names import load_name
from fem_seal.seal.load_result import LoadResult
from fem_seal.units import LeakVolume, leak_range_text, number, percent, quantity_worth
from leak import Reading
from leak.theory.reading import READINGS

_NAMES = {"paper": "the paper's theory", "corrected": "the corrected theory"}
# Factors closer to one are told as none.
_NOTICED = 1.02


def _rate(load: LoadResult) -> float:
    return 0.0 if load.leak is None else load.leak.leak_rate


def _told(load: LoadResult, digits: int, volume: LeakVolume) -> str:
    """A leak rate with its interval, as far as that is two numbers."""
    ends = load.leak_interval
    return leak_range_text(
        ends if ends is not None and ends.apart else _rate(load), min(digits, 2), volume=volume
    )


def corrected_beside(result: SealSolution) -> str:
    """What the corrected theory gives beside the paper's at the highest load; empty for any other.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    other = load.in_theory("corrected")
    if load.in_theory("paper") is not load or other is None:
        return ""
    rate = _told(other, load.leak_digits, volume_of(result.case)) if _rate(other) else "nothing"
    return said("theories.beside", "headline", rate=rate, load=load_name(load, result.loads))


def theories_in_words(result: SealSolution) -> list[str]:
    """How much leaks by the other theory at the highest load, and where the difference comes from.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    others = load.by_theory or {}
    if not others:
        return []
    found = [_compared(result, load, theory, other) for theory, other in others.items()]
    if len(others) == 1:
        ((theory, other),) = others.items()
        found += [*_contact(load, theory, other), *_yielding(load, theory, other)]
    return [*found, said("theories.why", "simulated")]


def _compared(result: SealSolution, load: LoadResult, theory: str, other: LoadResult) -> str:
    own, rate = _rate(load), _rate(other)
    kind = "tight" if not rate else "compared" if own else "leaks"
    return said(
        "theories.beside",
        kind,
        theory=_NAMES[theory],
        load=load_name(load, result.loads),
        rate=_told(other, load.leak_digits, volume_of(result.case)) if rate else "",
        factor=number(rate / own, 2) if own else "",
        own=leak_range_text(own, min(load.leak_digits, 2), volume=volume_of(result.case)) if own else "",
    )


def _contact(load: LoadResult, theory: str, other: LoadResult) -> Iterator[str]:
    """How much of the difference the contact makes, and how much what leaks through one and the same."""
    on_its_own = replace(load, rough=other.rough)
    shares = _rate(load), _rate(on_its_own), _rate(other)
    if not all(shares) or max(other.peak_pressure, load.peak_pressure) < _NOTICED * min(
        other.peak_pressure, load.peak_pressure
    ):
        return
    own, same, rate = shares
    yield said(
        "theories.why",
        "contact",
        theory=_NAMES[theory],
        gaps=number(same / own, 2),
        contact=number(rate / same, 2),
        peak=quantity_worth("contact pressure", other.peak_pressure, min(3, load.pressure_digits)),
        own_peak=quantity_worth("contact pressure", load.peak_pressure, min(3, load.pressure_digits)),
    )


def _yielding(load: LoadResult, theory: str, other: LoadResult) -> Iterator[str]:
    """What asperities that yield leave of the elastic leak rate in each theory."""
    left = {}
    for name, one in ((theory, other), (next(known for known in READINGS if known != theory), load)):
        elastic = _rate(one.reading(Reading.ELASTIC))
        if not elastic or one.reading(Reading.ELASTIC) is one:
            return
        left[name] = percent(_rate(one) / elastic)
    yield said("theories.why", "yielding", **left)


def _section(result: SealSolution) -> Section | None:
    sentences = theories_in_words(result)
    if not sentences:
        return None
    return Section("theories", "By both theories", "Theories", sentences)


SHOWN = Shown(
    summary=lambda result: {"theories": theories_in_words(result)},
    section=_section,
    lines=lambda result: [f"  {one}" for one in [corrected_beside(result)] if one],
)
