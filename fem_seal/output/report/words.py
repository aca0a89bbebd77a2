"""Sentences of the report: result, reasons, definitions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fem_seal.answers.case_load import CaseLoad, rate_of
from fem_seal.answers.leakage_class import class_size, is_flange, leakage_classes, test_of, volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.answers import variants
from fem_seal.output.answers.leak import (
    has_finish,
    has_two_numbers,
    leakage_text,
    uncertain_in_words,
    usual_rate_of,
)
from fem_seal.output.answers.target import opens_at
from fem_seal.output.answers.uncertainty import told_after_test
from fem_seal.output.case_words import earlier_load, state_in_words
from fem_seal.output.columns import in_words
from fem_seal.output.prose import phrase
from fem_seal.seal.findings import Level, Validity
from fem_seal.seal.load_result import highest_load, load_name, load_values
from fem_seal.units import (
    LeakVolume,
    leak_range_text,
    round_digits,
)

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.case.case import Case
    from leak import LeakageClass


# Relative changes below this get no number.
_LEAST = 1e-5


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


def headline(result: SealSolution) -> str:
    """The result in one or two sentences."""
    opens = {opens_at(load) for load in result.loads}
    (only,) = opens if len(opens) == 1 else (None,)
    opening = f" It opens at {only}." if only else ""
    beside = variants.headline(result, result.case.display)
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
