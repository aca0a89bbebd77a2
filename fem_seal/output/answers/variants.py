"""The results by the other theory of the rough contact, and with the other interface law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

from fem_seal import units
from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.case_load import CaseLoad, rate_of
from fem_seal.answers.leakage_class import volume_of
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, by_scenario, worded_section, worded_table
from fem_seal.output.columns import ReadableTable
from fem_seal.seal.findings import EXACT, Bounds
from fem_seal.seal.load_result import load_name
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.wording import say

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display

# Factors closer to one count as no difference.
_NOTICED = 1.02
# Share of the leak rate of elastic asperities that the paper measured, and how near a result is told to be like it.
_MEASURED, _NEAR = 1 / 8, 0.1


def _rate(load: CaseLoad) -> float:
    return 0.0 if load.leak is None else load.leak.leak_rate


def _rate_text(result: SealSolution, display: Display, load: CaseLoad) -> str:
    return display.leak_range(
        rate_of(load), min(result.highest.leak_digits, 2), volume=volume_of(result.case)
    )


def has_one_number(load: CaseLoad) -> bool:
    """Whether a leak rate is told as one number, which is the paper's, and not as its interval.

    Parameters
    ----------
    load : CaseLoad
    """
    # one that is sealed alone is told with its upper bound
    claimed = load.leak is not None and load.leak.leak_rate > 0.0 and not load.validity.outside_theory
    return claimed and "paper" in load.names and load.sample_ends is None


def beside_in_brief(result: SealSolution) -> Iterator[str]:
    """What the leak rate by the paper's theory means, and that of the default theory; nothing by that one.

    Parameters
    ----------
    result : SealSolution
    """
    case, load = result.case, result.highest
    if not has_one_number(load) or load.leak is None:
        return
    volume = volume_of(case)
    elastic, upper = load.scenario("elastic"), load.leak_range
    if elastic is not None and elastic.leak is not None and elastic.leak.leak_rate > 0.0:
        share = load.leak.leak_rate / elastic.leak.leak_rate
        if abs(share / _MEASURED - 1.0) < _NEAR and upper is not None:
            bound = case.display.leak_range(upper.high, 2, beside=(upper.low,), volume=volume)
            yield say(case.display, "theories", "measured", bound=bound)
    default = load.scenario("corrected")
    if default is not None and default.leak is not None:
        rate = case.display.leak_range(rate_of(default), 2, volume=volume)
        yield say(case.display, "theories", "default", rate=rate)


def supported_by(result: SealSolution) -> list[str]:
    """The line that names simulation and measurements; none where no leak rate is claimed.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    if load.leak is None or load.validity.outside_theory:
        return []
    theories = [name for name in ("paper", "corrected") if name in load.names]
    flow = result.problem.flow
    of_no_theory = "turned" if flow is None or flow.direct is None else "direct"
    support = "test" if load.after_test else theories[0] if theories else of_no_theory
    return [say(result.display, "theories", f"supported_{support}")]


def headline(result: SealSolution, display: Display) -> str:
    """Sentence of the headline with the leak rate in a scenario beside; empty unless one belongs there.

    Parameters
    ----------
    result : SealSolution
    display : Display
    """
    load = result.highest
    others = [name for name in load.scenarios if SCENARIOS[name].own_contact]
    # a simulated flow has two beside it, and neither in its headline
    if len(others) != 1 or not SCENARIOS[others[0]].in_headline:
        return ""
    other, at = load.scenarios[others[0]], load_name(load, result.loads, display)
    rate = _rate_text(result, display, other) if _rate(other) else "nothing"
    return say(display, "theories", "headline", rate=rate, load=at, sampled=load.sample_ends is not None)


def _sentences(result: SealSolution, display: Display) -> Iterator[str]:
    """Leak rate by the other theory at the highest load, and the reasons of the difference."""
    load = result.highest
    others = {name: other for name, other in load.scenarios.items() if SCENARIOS[name].own_contact}
    for name, other in others.items():
        yield _compare_rates(result, display, name, other)
    if not others:
        return
    if len(others) == 1:
        ((name, other),) = others.items()
        yield from _share_of_contact(result, display, name, other)
        yield from _share_of_yielding(load, display, name, other)
    corrected = load.scenario("corrected")
    if corrected is not None and corrected.theory_error != EXACT:
        yield say(display, "theories", "simulated", error=corrected.theory_error)
    yield say(display, "theories", "believe")


def _compare_rates(result: SealSolution, display: Display, name: str, other: CaseLoad) -> str:
    load, rate = result.highest, _rate_text(result, display, other) if _rate(other) else ""
    return say(
        display,
        "theories",
        "rate",
        theory=SCENARIOS[name].title,
        load=load_name(load, result.loads, display),
        sampled=load.sample_ends is not None,
        rate=rate,
        rates=(_rate(other), _rate(load)),
        digits=min(load.leak_digits, 2),
        volume=volume_of(result.case),
    )


def _share_of_contact(result: SealSolution, display: Display, name: str, other: CaseLoad) -> Iterator[str]:
    """Shares of the difference from the contact, and from the leak through the same contact."""
    load = result.highest
    present, same, rate = _rate(load), result.theories.same_contact.get(name, 0.0), _rate(other)
    peaks = Bounds.of([load.peak_pressure, other.peak_pressure])
    if all((present, same, rate)) and peaks.high >= _NOTICED * peaks.low:
        shares = {"gaps": same / present, "contact": rate / same, "theory": SCENARIOS[name].title}
        digits = min(3, load.pressure_digits)
        yield say(display, "theories", "contact", other=other, present=load, digits=digits, **shares)


def _share_of_yielding(load: CaseLoad, display: Display, name: str, other: CaseLoad) -> Iterator[str]:
    """Share of the elastic leak rate that remains with yielding asperities in each theory."""
    left = {}
    for theory, of_theory in ((name, other), (load.names[-1], load)):
        elastic = of_theory.scenarios.get("elastic")
        if elastic is None or not _rate(elastic):
            return
        left[theory] = _rate(of_theory) / _rate(elastic)
    yield say(display, "theories", "yielding", **left)


def variant_table(result: SealSolution) -> ReadableTable:
    """Results with either interface law at the load with the largest contact force; no rows without a choice."""
    ends = [
        rate
        for variant in result.interface_variants
        for rate in (variant.leak_rate, *variant.others.values())
    ]
    rates = [rate for rate in ends if rate is not None]
    volume = volume_of(result.case)
    unit = result.display.name_unit(result.display.shared_flow_unit(rates), volume)
    load = result.strongest
    rows = [
        {"variant": variant, "leak_rate": _rates_of(result.display, variant, unit, load, volume)}
        for variant in result.interface_variants
    ]
    plastic, name = result.case.interface.plastic, unit.name if rates else ""
    return worded_table(result.display, "interface_laws", rows, plastic=plastic, unit=name, load=load)


def _rates_of(
    display: Display, variant: Comparison, unit: units.Unit, load: CaseLoad, volume: units.LeakVolume
) -> str:
    """The leak rate in all scenarios that stand beside each other, or the only one."""
    claimed = not load.validity.outside_theory
    if variant.leak_rate is None:
        return "–"
    ends = Bounds.of([variant.leak_rate, *variant.others.values()])
    digits = min(load.leak_digits, 2 if ends.is_range else 3)
    texts = [
        units.format_digits(unit.of(end), digits) if end else display.leak_rate(0.0, claimed=claimed)
        for end in map(volume.measurable, ends)
    ]
    return units.range_text(*texts)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    first, sentences = headline(result, display), list(_sentences(result, display))
    return AnswerPage(
        section=worded_section(display, "theories", sentences), details=[first] if first else ()
    )


OUTPUT = AnswerOutput(
    summary=lambda result: {
        "theories": list(_sentences(result, result.display)) or None,
        "interface_variants": [by_scenario(asdict(variant)) for variant in result.interface_variants] or None,
    },
    page=_page,
)
