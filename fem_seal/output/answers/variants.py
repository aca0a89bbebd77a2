"""The results by the other theory of the rough contact, and with the other interface law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from fem_seal import units
from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.case_load import CaseLoad, rate_of
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.columns import ReadableTable
from fem_seal.output.prose import phrase
from fem_seal.output.shown import Shown, by_scenario, worded_section, worded_table
from fem_seal.seal.findings import EXACT, Bounds
from fem_seal.seal.load_result import load_name
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.units import leak_range_text

# Factors closer to one count as no difference.
_NOTICED = 1.02


def _rate(load: CaseLoad) -> float:
    return 0.0 if load.leak is None else load.leak.leak_rate


def _rate_text(result: SealSolution, load: CaseLoad) -> str:
    return leak_range_text(rate_of(load), min(result.highest.leak_digits, 2), volume=volume_of(result.case))


def _remark_on_inputs(load: CaseLoad) -> str:
    """Remark that the other theory uses the inputs as given: only one theory is sampled."""
    return "" if load.sampled is None else " with the inputs as given"


def told_in_headline(result: SealSolution) -> str:
    """Sentence of the headline with the leak rate in a scenario beside; empty unless one belongs there.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    others = [name for name in load.scenarios if SCENARIOS[name].own_contact]
    # a simulated flow has two beside it, and neither in its headline
    if len(others) != 1 or not SCENARIOS[others[0]].in_headline:
        return ""
    other, at = load.scenarios[others[0]], load_name(load, result.loads)
    rate = _rate_text(result, other) if _rate(other) else "nothing"
    return phrase("theories.rate", "headline", rate=rate, load=at, inputs=_remark_on_inputs(load))


def theories_in_words(result: SealSolution) -> list[str]:
    """Leak rate by the other theory at the highest load, and the reasons of the difference.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    others = {name: one for name, one in load.scenarios.items() if SCENARIOS[name].own_contact}
    if not others:
        return []
    found = [_compare_rates(result, load, theory, other) for theory, other in others.items()]
    if len(others) == 1:
        ((theory, other),) = others.items()
        found += [*_share_of_contact(result, theory, other), *_share_of_yielding(load, theory, other)]
    return [*found, *_error_of_simulation(load), phrase("theories.why", "believe")]


def _compare_rates(result: SealSolution, load: CaseLoad, theory: str, other: CaseLoad) -> str:
    own, rate = _rate(load), _rate(other)
    kind = "tight" if not rate else "compared" if own else "leaks"
    return phrase(
        "theories.rate",
        kind,
        theory=SCENARIOS[theory].title,
        load=load_name(load, result.loads),
        inputs=_remark_on_inputs(load),
        rate=_rate_text(result, other) if rate else "",
        factor=rate / own if own else None,
        own=leak_range_text(own, min(load.leak_digits, 2), volume=volume_of(result.case)) if own else "",
    )


def _share_of_contact(result: SealSolution, theory: str, other: CaseLoad) -> Iterator[str]:
    """Shares of the difference from the contact, and from the leak through the same contact."""
    load = result.highest
    own, same, rate = _rate(load), result.theories.same_contact.get(theory, 0.0), _rate(other)
    peaks = Bounds.of([load.peak_pressure, other.peak_pressure])
    if not all((own, same, rate)) or peaks.high < _NOTICED * peaks.low:
        return
    yield phrase(
        "theories.why",
        "contact",
        theory=SCENARIOS[theory].title,
        gaps=same / own,
        contact=rate / same,
        other=other,
        own=load,
        digits=min(3, load.pressure_digits),
    )


def _share_of_yielding(load: CaseLoad, theory: str, other: CaseLoad) -> Iterator[str]:
    """Share of the elastic leak rate that remains with yielding asperities in each theory."""
    left = {}
    for name, one in ((theory, other), (load.names[-1], load)):
        elastic = one.scenarios.get("elastic")
        if elastic is None or not _rate(elastic):
            return
        left[name] = _rate(one) / _rate(elastic)
    yield phrase("theories.why", "yielding", **left)


def _error_of_simulation(load: CaseLoad) -> Iterator[str]:
    """Error of the corrected theory found by direct simulation."""
    corrected = load.scenario("corrected")
    if corrected is not None and corrected.theory_error != EXACT:
        yield phrase("theories.why", "simulated", error=corrected.theory_error)


def variant_table(result: SealSolution) -> ReadableTable:
    """Results with either interface law at the load with the largest contact force; no rows without a choice."""
    ends = [rate for one in result.interface_variants for rate in (one.leak_rate, *one.others.values())]
    rates = [rate for rate in ends if rate is not None]
    volume = volume_of(result.case)
    unit = volume.name_unit(units.shared_flow_unit(rates))
    load = result.strongest
    used = result.case.interface.plastic
    return worded_table(
        "interface_laws",
        [
            {
                "variant": variant,
                "used": " (used)" if ("plastic" in variant.name) == used else "",
                "leak_rate": _rates_of(variant, unit, load, volume),
            }
            for variant in result.interface_variants
        ],
        unit=f" [{unit.name}]" if rates else "",
        load=load,
        fwhm_digits=load.digits_of("fwhm"),
        std_digits=load.digits_of("std"),
    )


def _rates_of(variant: Comparison, unit: units.Unit, load: CaseLoad, volume: units.LeakVolume) -> str:
    """The leak rate in all scenarios that stand beside each other, or the only one."""
    claimed = not load.validity.outside
    if variant.leak_rate is None:
        return "–"
    ends = Bounds.of([variant.leak_rate, *variant.others.values()])
    digits = min(load.leak_digits, 2 if ends.apart else 3)
    texts = [
        units.format_digits(unit.of(one), digits) if one else units.leak_rate_text(0.0, claimed=claimed)
        for one in map(volume.measurable, ends)
    ]
    return units.range_text(*texts)


SHOWN = Shown(
    summary=lambda result: {
        "theories": theories_in_words(result) or None,
        "interface_variants": [by_scenario(asdict(variant)) for variant in result.interface_variants] or None,
    },
    section=lambda result: worded_section("theories", theories_in_words(result)),
    words={"variants": variant_table},
    lines=lambda result: [f"  {line}" for line in [told_in_headline(result)] if line],
)
