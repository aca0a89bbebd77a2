"""Opening of the seal, and the force for the target leak rate: facts, reasons, table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.target import TARGET
from fem_seal.output.answers.verdict import force_to_pass, verdict_force_sentences
from fem_seal.output.columns import SHOWN_COLUMNS, ReadableTable, columns_table, filled_columns
from fem_seal.output.prose import in_scenario, phrase
from fem_seal.output.shown import Shown
from fem_seal.units import format_digits, format_quantity, quantity, range_text, unit_for

_DIGITS = 4


OPENS, TARGET_FORCE = "Opens at", "Force for the target leak rate"


def opens_at(load: CaseLoad) -> str | None:
    """The fluid pressure that lifts the closure off; None if none does, or if not calculated."""
    pressure = load.blow_off_pressure
    return None if pressure is None or math.isinf(pressure) else quantity("fluid pressure", pressure, _DIGITS)


def valve_facts(result: SealSolution, load: CaseLoad) -> Iterator[tuple[str, str, str]]:
    """Name, value and remark of the pressure that opens the seal and of the force for the target leak rate."""
    if opens := opens_at(load):
        yield OPENS, opens, phrase("facts.remark", "opens", load=load)
    target = result.case.load.target_leak_rate
    if target is not None and load.force_for_target is not None:
        every = (load.force_for_target, *_other_forces(load).values())
        low, high = (_target_force(load, force) for force in (every[0], every[-1]))
        both = "target" if low == high else "target_both"
        yield (
            TARGET_FORCE,
            range_text(low, high),
            phrase("facts.remark", both, target=target_text(result, target)),
        )
    if found := load.verdict_force:
        none = "none" if found.looked_for else "not calculated"
        begins = f" {found.begins}" if found.begins else ""
        yield (
            "Force for a pass",
            none if found.force is None else force_to_pass(found.force),
            found.why_none or phrase("facts.remark", "pass", begins=begins),
        )


def opening_reasons(result: SealSolution, load: CaseLoad) -> Iterator[str]:
    """Distance of a load from opening the seal, and from the target leak rate."""
    if opens := opens_at(load):
        assert load.blow_off_pressure is not None
        share = load.fluid_pressure / load.blow_off_pressure
        digits = 2 if load.digits == 4 else 4
        yield phrase("reasons.opening", "all", opens=opens, share=share, share_digits=digits, load=load)
    yield from _target_reasons(result, load)
    yield from verdict_force_sentences([load])


def _target_reasons(result: SealSolution, load: CaseLoad) -> Iterator[str]:
    target, force = result.case.load.target_leak_rate, load.force_for_target
    if target is None or force is None:
        return
    acting, contact = load.applied_force, load.contact_force_for_target
    bolted = load.preload_for_target is not None
    sentence = phrase(
        "reasons.target",
        "bolted" if bolted else "force",
        "" if bolted else ("more" if force > acting else "less") if acting else "none",
        "fluid" if force < 0 else "",
        "" if contact is None else "line",
        contact=contact,
        line_load=None if contact is None else _line_load(load, contact),
        target=target_text(result, target),
        force=_target_force(load, force),
        difference=abs(force - acting),
        digits=load.digits_of("force_for_target"),
        load=load,
    )
    others = [
        in_scenario(name, load.names[0], f"{_target_force(load, one)} are needed")
        for name, one in _other_forces(load).items()
    ]
    yield " ".join([sentence, *others])


def target_in_brief(result: SealSolution) -> str:
    """The force for the target leak rate at the load that needs most, or why there is none; empty without a target.

    Parameters
    ----------
    result : SealSolution
    """
    target = result.case.load.target_leak_rate
    if target is None or result.highest.preload_for_target is not None:
        return ""
    known = [
        (_most_force(load), n) for n, load in enumerate(result.loads) if load.force_for_target is not None
    ]
    if not known:
        found = TARGET.of(result.answers)
        why = (
            found.remarks[0].text.removeprefix("load.target_leak_rate = ") if found and found.remarks else ""
        )
        return phrase("brief.target", "none", why=why) if why else ""
    # a fluid that closes the seal leaves most to the spring at its lowest pressure
    force, number = max(known)
    load = result.loads[number]
    contact, validity = load.contact_force_for_target, load.target_validity
    doubt = "" if validity is None or not validity.doubts else "outside" if validity.outside else "doubt"
    return phrase(
        "brief.target",
        "alone" if force <= 0.0 else "force" if contact is None else "line",
        doubt,
        target=target_text(result, target),
        force=_target_force(load, force),
        # another reading moves the force of the contact by as much as that of the spring
        line_load=_line_load(load, (contact or 0.0) + force - (load.force_for_target or 0.0)),
        load=load,
        reason=validity.reasons[0] if doubt and validity else "",
    )


def _most_force(load: CaseLoad) -> float:
    """Force for the target in the reading of yielding asperities that needs most [N]."""
    assert load.force_for_target is not None  # one is found
    return max([load.force_for_target, *_other_forces(load).values()])


def _line_load(load: CaseLoad, contact_force: float) -> float:
    """Per length of the circle of first touch, normal to the contact [N/m]."""
    return load.contact.model.line_load(contact_force)


def _other_forces(load: CaseLoad) -> dict[str, float]:
    """Force for the target in the scenarios beside, where one is found [N]."""
    found = {name: one.force_for_target for name, one in load.others.items()}
    return {name: force for name, force in found.items() if force is not None}


def target_text(result: SealSolution, leak_rate: float) -> str:
    """The target leak rate as it was written, of a gas with its state.

    Parameters
    ----------
    result : SealSolution
    leak_rate : float
        [m^3/s]
    """
    state = volume_of(result.case).state
    return f"{format_quantity('flow', leak_rate)} at {state}" if state else format_quantity("flow", leak_rate)


def _target_force(load: CaseLoad, force: float) -> str:
    unit = unit_for("force", force)
    return f"{format_digits(unit.of(force), load.digits_of('force_for_target'))} {unit.name}"


def valve_table(result: SealSolution) -> ReadableTable:
    """Opening and target force at each load; no rows if not calculated."""
    given, asked = (
        filled_columns(result.case, SHOWN_COLUMNS[key], result.loads) for key in ("given", "asked")
    )
    # the pressure that lifts the closure off, also where leak.csv has the one that lifts the surfaces apart
    opens = [_finite(load.blow_off_pressure) for load in result.loads]
    asked = [
        replace(column, values=opens) if column.column.name == "blow_off_pressure_Pa" else column
        for column in asked
    ]
    if not any(column.some for column in asked):
        return ReadableTable((), ())
    return columns_table([*given, *asked])


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


SHOWN = Shown(words={"valve": valve_table})
