"""Sentences of the report: result, reasons, definitions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.case_load import CaseLoad, rate_of
from fem_seal.answers.leakage_class import class_size, is_flange, leakage_classes, test_of, volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.contact.solution import PlasticZone, yielding_of
from fem_seal.output.answers.lands import hardest_land
from fem_seal.output.answers.leak import (
    has_finish,
    has_two_numbers,
    leakage_text,
    narrowest_point,
    uncertain_in_words,
    usual_rate_of,
    yielding_factor,
)
from fem_seal.output.answers.target import TARGET_FORCE, opening_reasons, opens_at, valve_facts
from fem_seal.output.answers.uncertainty import told_after_test
from fem_seal.output.answers.variants import told_in_headline
from fem_seal.output.case_words import earlier_load, state_in_words
from fem_seal.output.columns import in_words
from fem_seal.output.prose import phrase
from fem_seal.seal.findings import Bounds, Level, Validity
from fem_seal.seal.load_result import highest_load, load_name, load_values
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.units import (
    LIQUID,
    LeakVolume,
    format_digits,
    format_value,
    leak_range_text,
    percent,
    quantity_worth,
    range_text,
    round_digits,
    unit_for,
)
from fem_seal.validity.checks import FLUID_OPENS
from leak import CoupledLeakResult

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.closed_forms import Derived
    from fem_seal.case.case import Case
    from leak import LeakageClass
    from leak.theory.line_contact import HertzLine


PEAK = "Peak contact pressure"
# Part of the pressure drop whose strip of the contact does the sealing: its middle 80 %.
_MIDDLE = (0.1, 0.9)
# Peak over Hertz's peak above which mesh and curved faces do not explain the difference.
_ABOVE_HERTZ = 1.05
# Relative changes below this get no number.
_LEAST = 1e-5


@dataclass(frozen=True)
class Fact:
    """A number with its name, as the report shows it at the top.

    Parameters
    ----------
    name, value, remark : str
    level : Level
        How far the number can be trusted.
    """

    name: str
    value: str
    remark: str = ""
    level: Level = Level.VALID


def facts(result: SealSolution, load: CaseLoad | None = None) -> list[Fact]:
    """The main numbers at a load, the highest unless given, each with the level of its validity."""
    load = load or result.highest
    return [replace(fact, level=validity.level) for fact, validity in _facts(result, load)]


def _facts(result: SealSolution, load: CaseLoad) -> Iterator[tuple[Fact, Validity]]:
    """Each with the validity that it has."""
    leaks, contact = load.validity, load.validity.of_contact
    if result.uncertainty is not None:
        yield _interval_fact(result, load), leaks
    of_leak = [] if load.leak is None else list(_leak_facts(result.case, load))
    # the interval comes first; the other units follow it
    yield from ((one, leaks) for one in (of_leak if load.sampled is None else reversed(of_leak)))
    of_target = load.target_validity or leaks
    yield from (
        (Fact(*fact), of_target if fact[0] == TARGET_FORCE else contact) for fact in valve_facts(result, load)
    )
    land = hardest_land(load) if len(load.profiles) > 1 else ""
    uneven = load.circumference is not None and load.circumference.form.felt
    if uneven:
        remark = f"around the axis; {_peak(load)} at the mean line load"
        yield Fact(PEAK, in_words(load, "peak_pressure_max_Pa"), remark), contact
    else:
        yield Fact(PEAK, _peak(load), land), contact
    width = in_words(load, "fwhm_m")
    remarks = ["full width at half of the peak pressure", land]
    yield Fact("Width of the contact", width, ", ".join(filter(None, remarks))), contact
    if load.critical_separation is not None:
        yield Fact("Narrowest point of the leak path", *narrowest_point(load)), leaks
    if not load.of_profile:
        where = f"von Mises, in the {result.case.label_of(load.max_von_mises_at[0])}"
        where += ", at the mean line load" if uneven else ""
        yield Fact("Largest stress in the bodies", in_words(load, "max_von_mises_Pa"), where), contact
    if imprint := imprint_in_words(result):
        yield Fact("Permanent imprint", *imprint), contact
    if load.leak is not None:
        yield _class_fact(result.case, load), leaks


def _leak_facts(case: Case, load: CaseLoad) -> Iterator[Fact]:
    """The leak rate, in one unit and in other units."""
    assert load.leak is not None
    volume, sampled = volume_of(case), load.sampled is not None
    rate = usual_rate_of(load) if sampled else rate_of(load)
    remarks = [
        state_in_words(volume),
        _least_in_words(load)
        or (per_day(rate, load.leak_digits, volume) if volume.state == volume.gas else ""),
        scenarios_in_words(load, volume),
        *([] if sampled else accuracy_in_words(load)),
    ]
    which = "tested" if load.tested else "finish" if has_finish(case) else "inputs"
    name = phrase("interval.fact", which if sampled else "only")
    text = leak_range_text(rate, load.leak_digits, claimed=not load.validity.outside, volume=volume)
    yield Fact(name, text, "; ".join(filter(None, remarks)))
    if load.leak.leak_rate > 0:
        # the first of these units may be that of the first fact
        lead = leak_range_text(rate_of(load), load.leak_digits, volume=volume)
        others = [part for part in leakage_text(load, volume).split(" = ") if part.split(" (")[0] != lead]
        if others:
            yield Fact("In other units", others[0], " = ".join(others[1:]))


def _least_in_words(load: CaseLoad) -> str:
    """Lower bound of a leak rate with scratches, which is the upper of two bounds; empty without scratches."""
    if load.leak is None or load.around is None or load.around.scratches is None:
        return ""
    ends = Bounds.of(map(least_with_scratches, (load, *load.others.values())))
    text = leak_range_text(
        ends if ends.apart else least_with_scratches(load),
        load.leak_digits,
        claimed=not load.validity.outside,
    )
    return f"with the upper bound of the leak through scratches; the lower one gives {text}"


def least_with_scratches(load: CaseLoad) -> float:
    """Leak rate of one reading with the lower bound of what scratches add [m^3/s]."""
    if load.leak is None or load.around is None or load.around.scratches is None:
        return math.nan
    low, high = load.around.scratches
    return load.leak.leak_rate - (high - low)


def volume_notes(volume: LeakVolume, units: Sequence[str], *, unmeasured: bool) -> list[str]:
    """Notes below a table of leak rates.

    Parameters
    ----------
    volume : LeakVolume
    units : sequence of str
        Units of the volumes in it.
    unmeasured : bool
        Whether some of them are too small to be measured.
    """
    found = [phrase("interval.volume", "least", least=volume.least_name)] if unmeasured else []
    if volume.gas:
        # pressure times volume, two words, has no state
        volumes = [unit for unit in dict.fromkeys(units) if " " not in unit]
        found += [phrase("interval.volume", "column", unit=unit, state=volume.gas) for unit in volumes]
    return found


def volumes_of_gas(gas: bool) -> str:
    """State of gas volumes where the temperature differs from row to row, " (...)"; empty for a liquid."""
    return f" ({phrase('interval.volume', 'heading')})" if gas else ""


def scenarios_in_words(load: CaseLoad, volume: LeakVolume = LIQUID) -> str:
    """Leak rate in each reading of yielding asperities; empty with only one reading."""
    if not load.others or load.leak_range is None:
        return ""
    if not has_two_numbers(load):
        return phrase("interval.load", "same")
    digits, claimed = min(load.leak_digits, 2), not load.validity.outside
    every_one = {load.names[0]: load, **load.others}
    rates = {name: one.leak.leak_rate for name, one in every_one.items() if one.leak is not None}
    every = tuple(rates.values())
    return ", ".join(
        f"{leak_range_text(rate, digits, claimed=claimed, beside=every, volume=volume)} {SCENARIOS[name].condition}"
        for name, rate in rates.items()
    )


def _class_fact(case: Case, load: CaseLoad) -> Fact:
    """The best class, or that none can be claimed."""
    (short, size), classes = class_size(case), leakage_classes(case, load)
    name = f"Leakage class, {short}"
    if not classes:
        return Fact(name, "not claimed", "leak rate outside the theory")
    best = next((one for one in classes if one.name), classes[0])
    remarks = (classes_in_words(classes), size, judged_as(case, load))
    return Fact(name, str(best), "; ".join(filter(None, remarks)))


def _interval_fact(result: SealSolution, load: CaseLoad) -> Fact:
    assert result.uncertainty is not None
    volume = volume_of(result.case)
    remarks = [
        state_in_words(volume),
        phrase("facts.remark", uncertain_in_words(result.case, load))
        + (", in both readings of asperities that yield" if load.others else ""),
        *accuracy_in_words(load),
    ]
    outside = load.validity.outside
    text = leak_range_text(rate_of(load), load.leak_digits, claimed=not outside, volume=volume)
    return Fact(
        f"{percent(result.uncertainty.confidence)} interval of the leak rate",
        told_after_test(load, volume) if load.tested and not outside else text,
        "; ".join(filter(None, remarks)),
    )


# Volume of a day below which it is called less than that [m^3].
_LEAST_PER_DAY = 1e-9


def per_day(leak_rate: float | tuple[float, float], digits: int = 2, volume: LeakVolume = LIQUID) -> str:
    """A leak rate, or both ends of its interval, as volume per day, with two digits at most."""
    ends = leak_rate if isinstance(leak_rate, tuple) else (leak_rate,)
    volumes = [volume.measurable(rate) * 86400 for rate in ends]
    if volumes[-1] < _LEAST_PER_DAY:
        return "" if volumes[-1] == 0 else f"less than {format_value(_LEAST_PER_DAY, 'volume 1')} per day"
    unit = unit_for("volume", volumes[-1])
    texts = [format_digits(unit.of(one), min(digits, 2)) for one in volumes]
    return f"{range_text(texts[0], texts[-1])} {'litres' if unit.name == 'l' else unit.name} per day"


def headline(result: SealSolution) -> str:
    """The result in one or two sentences."""
    opens = {opens_at(load) for load in result.loads}
    (only,) = opens if len(opens) == 1 else (None,)
    opening = f" It opens at {only}." if only else ""
    beside = told_in_headline(result)
    more = " ".join(["", *([beside] if beside else []), *load_notes(result)])
    return _leak_sentence(result) + opening + more + _validity_sentence(result)


def load_notes(result: SealSolution) -> list[str]:
    """Sentence about the load history of the results; empty without one."""
    earlier = earlier_load(result.case.load)
    remembers = any(load.remembers for load in result.loads)
    if not earlier:
        if result.bolts is not None and result.problem.loads.earlier is not None:
            return [phrase("notes.headline", "tightened")] if remembers else []
        return [phrase("notes.headline", "path")] if remembers else []
    return [
        phrase("notes.headline", "remembers" if remembers or result.unloaded else "forgets", earlier=earlier)
    ]


def _validity_sentence(result: SealSolution) -> str:
    """Sentence of the headline about loads that are outside the theory or doubtful; empty if all are valid."""
    clauses = []
    doubted = [load for load in result.loads if load.validity.doubts]
    what = "result" if any(load.validity.of_contact.doubts for load in doubted) else "leak rate"
    for level in (Level.OUTSIDE, Level.DOUBTFUL):
        found = [load for load in result.loads if load.validity.level is level]
        if found:
            highest = found[highest_load(found)]
            at = "" if len(result.loads) == 1 else f" at {_names_of_loads(found, result.loads)}"
            clauses.append(f"{level}{at} ({_worst_reason(highest.validity)})")
    return f" The {what} is {', '.join(clauses)}." if clauses else ""


def _names_of_loads(loads: Sequence[CaseLoad], among: Sequence[CaseLoad]) -> str:
    """Names of a few loads, or the number of many."""
    if len(loads) == len(among):
        return "every load"
    if len(loads) > 3:
        return f"{len(loads)} of {len(among)} loads"
    return ", ".join(load_values(load, among) for load in loads)


def _worst_reason(validity: Validity) -> str:
    """The worst reason, and the number of further ones."""
    others = len(validity.reasons) - 1
    more = f" and {others} more {'reason' if others == 1 else 'reasons'}" if others else ""
    return validity.reasons[0] + more


def _leak_sentence(result: SealSolution) -> str:
    loads = result.loads
    highest = result.highest
    last = loads[-1]
    # a body that yields is changed by the highest load
    changed = result.unloaded is not None and last.point != highest.point
    lowest = min(loads[: loads.index(highest) + 1] if changed else loads, key=lambda load: load.point)
    shown = [highest] if lowest is highest else [lowest, highest]
    if changed:
        shown.append(last)
    span = load_values(highest, loads)
    rates = [rate_of(load) for load in shown if load.leak is not None]
    if not rates:
        after = f"; after {span}, {_contact(last)} at {load_values(last, loads)}" if changed else ""
        return contact_alone(result, after)
    if all(load.validity.outside for load in shown):
        return phrase("notes.headline", "not_claimed", load=span)
    if all(load.leak and rate_of(load) in (0, (0, 0)) and not load.validity.outside for load in loads):
        return phrase("notes.headline", "sealed", load=span)
    ends = [end for rate in rates for end in (rate if isinstance(rate, tuple) else (rate,))]
    volume = volume_of(result.case)
    leaks = [
        (
            "at an unknown rate"
            if load.validity.outside
            else "nothing"
            if rate in (0, (0, 0))
            else told_after_test(load, volume)
            if load.tested
            else leak_range_text(rate, load.leak_digits, beside=ends, volume=volume)
        )
        + f" at {load_values(load, loads)}"
        for rate, load in zip(rates, shown, strict=True)
    ]
    then = f"; after {span}, {leaks.pop()}" if changed else ""
    # the longest remark on the interval covers all rates in the sentence; its numbers are those of the last, as below
    known = [load for load in shown if not load.validity.outside]
    held = max((held_in_words(result.case, load) for load in reversed(known)), key=len)
    state = f" ({state_in_words(volume)})" if volume.state else ""
    who = phrase("notes.headline", "tested" if highest.tested else "leaks")
    return " ".join([f"{who} {' and '.join(leaks)}{then}{state}.", *held])


def given_in_words(result: SealSolution) -> list[str]:
    """What the columns of a file with given contacts were taken for; empty where the contacts are solved.

    Parameters
    ----------
    result : SealSolution
    """
    return list(dict.fromkeys(one.understood for one in result.answers.get("profiles", ()) if one.understood))


def contact_alone(result: SealSolution, after: str = "") -> str:
    """Width and peak pressure of the contact of a case without a leak rate, and why it has none.

    Parameters
    ----------
    result : SealSolution
    after : str
        The contact at another load.
    """
    missing, load = "roughness" if result.surface is None else "fluid", result.highest
    at, contact = load_values(load, result.every_load), _contact(load) + after
    return phrase("notes.headline", "contact", load=at, contact=contact, missing=missing)


def held_in_words(case: Case, load: CaseLoad) -> list[str]:
    """Sentences about the coverage of the interval of a leak rate; none for a single number.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    """
    ends = rate_of(load)
    if not isinstance(ends, tuple) or not volume_of(case).measurable(ends[1]):
        return []
    if load.sampled is not None:
        held = [_samples_in_words(case, load)]
    elif load.leak_range is not None and (not load.others or has_two_numbers(load)):
        held = [phrase("interval.ends", "what" if load.others else "simulated")]
    else:
        held = []
    off = accuracy_in_words(load)
    return [*held, *(phrase("interval.accuracy", "also" if held else "alone", off=one) for one in off)]


# Error factors that are not seen in two digits.
_NOTICED_IN_ENDS = 1.05


def accuracy_in_words(load: CaseLoad) -> list[str]:
    """The error of the calculation, if it widens the interval noticeably; none or one.

    Parameters
    ----------
    load : CaseLoad
    """
    least, most = load.leak_validity.leak_factor
    ways = [
        (f"{round_digits(factor, 2):g} {'more' if more else 'less'}", load.leak_validity.widens(more=more))
        for more, factor in ((True, most), (False, 1.0 / least))
        if factor > _NOTICED_IN_ENDS
    ]
    reasons = list(dict.fromkeys(one.reason for _, found in ways for one in found))
    together = f"together a factor {' or '.join(factor for factor, _ in ways)}: " if len(reasons) > 1 else ""
    return [phrase("interval.accuracy", "what", reason=together + "; ".join(reasons))] if reasons else []


def _samples_in_words(case: Case, load: CaseLoad) -> str:
    """Sentence about the interval of a leak rate with uncertain inputs."""
    assert case.sampled is not None
    what = uncertain_in_words(case, load)
    also = "_both" if load.others else "" if load.flow_error is None else "_own"
    return phrase("interval.sampled", what + also, share=case.sampled.confidence)


def far_field_sentence(result: SealSolution) -> str:
    """The influence of the far field in one sentence; empty if nothing was compared."""
    if not result.far_field:
        return ""
    changes = "; ".join(
        phrase(
            "notes.far_field",
            "peak" if change.leak_rate is None else "both",
            change=change.name,
            peak=_change_in_words(change.peak_pressure),
            leak_rate="" if change.leak_rate is None else _change_in_words(change.leak_rate),
        )
        for change in result.far_field
    )
    which = "one" if len(result.loads) == 1 else "strongest"
    load = load_name(result.strongest, result.loads)
    return phrase("notes.far_field", which, load=load, changes=changes)


def _change_in_words(change: float) -> str:
    return f"{100 * change:+.2g} %" if abs(change) >= _LEAST else f"less than {100 * _LEAST:g} %"


def _contact(load: CaseLoad) -> str:
    return f"{in_words(load, 'fwhm_m')} wide under {_peak(load)} peak pressure"


def _peak(load: CaseLoad) -> str:
    return in_words(load, "peak_pressure_Pa")


def reasons(result: SealSolution, derived: Derived) -> list[str]:
    """Reasons for the result: what determines the contact and what throttles the flow."""
    load = result.highest
    return [
        *_width_reasons(result, derived, load),
        *yielding_reasons(result, load),
        *opening_reasons(result, load),
        *_flow_reasons(load),
        *_asperity_reasons(result, load),
    ]


def _width_reasons(result: SealSolution, derived: Derived, load: CaseLoad) -> Iterator[str]:
    hertz = derived.loads[result.loads.index(load)].hertz
    if hertz is None:
        yield phrase("reasons.width", "conforming", contact=_contact(load))
        return
    smooth = result.case.interface.law == "smooth"
    bulk = min((hertz.std / load.std) ** 2, 1.0)
    if any(isinstance(zone, PlasticZone) for zone in yielding_of(load.contact).values()):
        parts = ["yielding" if smooth else "rough_yielding"]
    elif _leaves_curvature(result, hertz, load.peak_pressure):
        parts = ["other_curvature"]
    elif smooth:
        parts = ["smooth"]
    else:
        dominant = "roughness" if bulk < 0.25 else "elasticity" if bulk > 0.75 else "both"
        parts = [dominant, "rough"]
    yield phrase("reasons.width", *parts, hertz=hertz, peak=_peak(load), width=in_words(load, "fwhm_m"))


def _leaves_curvature(result: SealSolution, hertz: HertzLine, peak: float) -> bool:
    """Whether Hertz does not apply: the contact exceeds the constant curvature, or its peak that of any roughness."""
    breaks = np.abs(result.case.contact.breaks)
    return bool((breaks < 2 * hertz.std).any()) or peak > _ABOVE_HERTZ * hertz.peak_pressure


def _flow_reasons(load: CaseLoad) -> Iterator[str]:
    if load.leak is None or load.leak.leak_rate == 0:
        return
    if not math.isfinite(load.leak.leak_rate):
        yield phrase("reasons.fluid", "forced_open")
        return
    x, share = load.whole.x, load.leak.fluid_pressure / load.fluid_pressure
    rising = share if share[-1] > share[0] else 1 - share
    ends = np.interp(_MIDDLE, rising, x)
    width, middle = float(ends[1] - ends[0]), _MIDDLE[1] - _MIDDLE[0]
    # with the accuracy of the width of the contact
    yield phrase("reasons.fluid", "middle", share=middle, width=width, digits=load.digits_of("fwhm"))
    ratio = load.fluid_pressure / load.peak_pressure
    if isinstance(load.leak, CoupledLeakResult):
        effect = "local"
    elif load.effective_radius is not None:
        effect = "penetration"
    else:
        effect = "opens" if ratio > FLUID_OPENS else "neglected"
    yield phrase("reasons.fluid", "ratio", effect, ratio=ratio)


def _asperity_reasons(result: SealSolution, load: CaseLoad) -> Iterator[str]:
    surface = result.surface
    if surface is None:
        return
    peak = load.peak_pressure
    if surface.hardness is None:
        if load.leak is not None:
            yield phrase("reasons.asperities", "elastic")
        return
    area = float(surface.contact_area(peak))
    yielded = float(surface.plastic_area(peak)) / area
    share = "nearly all" if yielded > 0.999 else "next to nothing" if yielded < 1e-3 else percent(yielded)
    factor, effect = yielding_factor(load)
    yield phrase("reasons.asperities", "yielded", effect, area=area, share=share, factor=factor)
    if load.others and has_two_numbers(load):
        yield phrase("interval.load", "why", scenarios=scenarios_in_words(load))


def classes_in_words(classes: Sequence[LeakageClass]) -> str:
    """The classes: "ISO 5208 B, FCI 70-2 V; API 598: no class met"; "not claimed" outside the theory."""
    if not classes:
        return "not claimed"
    met = [str(one) for one in classes if one.name]
    missed = [str(one) for one in classes if not one.name]
    return "; ".join([*([", ".join(met)] if met else []), *missed])


def judged_as(case: Case, load: CaseLoad) -> str:
    """Note that the classes hold for the fluid of the standards' test; empty if it is the fluid of the case.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    """
    assert case.fluid is not None
    if is_flange(case):
        return ""
    fluid, ratio = test_of(case.fluid, load.fluid_pressure, load)
    return phrase("interval.classes", "test_fluid", fluid=fluid, ratio=tuple(sorted(ratio))) if fluid else ""


def leakage_lines(case: Case, load: CaseLoad, loads: Sequence[CaseLoad]) -> list[str]:
    """Lines for the terminal about one load; none without a leak rate.

    Parameters
    ----------
    case : Case
    load : CaseLoad
    loads : sequence
        All of them.
    """
    if load.leak is None:
        return []
    found = load.validity
    doubt = f" ({found.level}: {found.reasons[0]})" if found.reasons else ""
    why = ", because the leak rate is outside the theory" if found.outside else ""
    tested = "" if found.outside else judged_as(case, load)
    classes, volume = classes_in_words(leakage_classes(case, load)), volume_of(case)
    at, told = load_values(load, loads), leakage_text(load, volume)
    if load.tested and not found.outside:
        at, told = f"{at} after the leak test", told_after_test(load, volume, told)
    return [
        f"Leak rate at {at}: {told}{doubt}",
        *(f"  {one}" for one in held_in_words(case, load)),
        *([f"  {_as_given(case, load)}"] if load.sampled is not None else []),
        f"Leakage class for {class_size(case)[1]}: {classes}{why}",
        *([f"  {tested[0].upper()}{tested[1:]}"] if tested else []),
    ]


def _as_given(case: Case, load: CaseLoad) -> str:
    """The leak rate with the inputs as given, in both readings of yielding asperities."""
    # in the unit of the line above
    rate = leakage_text(load, volume_of(case), usual_rate_of(load)).split(" = ")[0]
    finish, inputs = ("tested_finish", "tested_inputs") if load.tested else ("finish", "inputs")
    return phrase("interval.as_given", finish if has_finish(case) else inputs, rate=rate)


def imprint_in_words(result: SealSolution) -> tuple[str, str] | None:
    """Depth of the deepest imprint, and its body and width; None if nothing has yielded."""
    imprints = result.imprints
    if not imprints:
        return None
    name, imprint = max(imprints.items(), key=lambda item: item[1].deepest)
    digits = result.strongest.digits_of("fwhm")  # with the accuracy of the width of the contact
    where = phrase("facts.remark", "imprint", imprint=imprint, body=result.case.label_of(name), digits=digits)
    return quantity_worth("length", imprint.deepest, digits), where


def yielding_reasons(result: SealSolution, load: CaseLoad) -> Iterator[str]:
    """How far the bodies have yielded at a load that was solved as elastoplastic."""
    if result.unloaded is None:
        return
    zones = {name: zone for name, zone in load.zones.items() if isinstance(zone, PlasticZone)}
    if not zones:
        yield phrase("reasons.yielding", "none")
    for name, zone in zones.items():
        values = {"body": result.case.label_of(name), "zone": zone, "digits": load.digits_of("fwhm")}
        yield phrase("reasons.yielding", "zone", **values)
