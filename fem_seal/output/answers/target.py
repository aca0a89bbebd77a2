"""Opening of the seal, and the force for the target leak rate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.target import TARGET
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Tile, decisive, worded_section
from fem_seal.output.columns import SHOWN_COLUMNS, ReadableTable, columns_table, filled_columns
from fem_seal.units import format_digits, range_text
from fem_seal.wording import say

if TYPE_CHECKING:
    from fem_seal.units import Display

_DIGITS = 4


OPENS, TARGET_FORCE = "Opens at", "Force for the target leak rate"


def opens_at(display: Display, load: CaseLoad) -> str | None:
    """The fluid pressure that lifts the closure off; None if none does, or if not calculated."""
    pressure = load.blow_off_pressure
    if pressure is None or math.isinf(pressure):
        return None
    return display.quantity(pressure, f"fluid pressure {_DIGITS}")


def tiles(result: SealSolution, display: Display, load: CaseLoad) -> Iterator[Tile]:
    """The pressure that opens the seal and the force for the target leak rate.

    Parameters
    ----------
    result : SealSolution
    display : Display
    load : CaseLoad
    """
    if opens := opens_at(display, load):
        remark = say(display, "target", "opens", load=load)
        yield Tile(OPENS, opens, remark, 30, load.validity.of_contact.level)
    target, forces = result.case.load.target_leak_rate, [*_target_forces(load).values()]
    if target is not None and forces:
        low, high = (_target_force(display, load, end) for end in (forces[0], forces[-1]))
        remark = say(display, "target", "force", target=target_text(result, target), both=low != high)
        level = (load.target_validity or load.validity).level
        yield Tile(TARGET_FORCE, range_text(low, high), remark, 45, level)


def _why(display: Display, load: CaseLoad) -> Iterator[str]:
    if opens := opens_at(display, load):
        assert load.blow_off_pressure is not None
        share = load.fluid_pressure / load.blow_off_pressure
        digits = 2 if load.digits == 4 else 4
        yield say(display, "target", "opening", opens=opens, share=share, digits=digits, load=load)


def target_in_brief(result: SealSolution, display: Display) -> str:
    """The force for the target leak rate at the load that needs most, or why there is none; empty without a target.

    Parameters
    ----------
    result : SealSolution
    display : Display
    """
    target = result.case.load.target_leak_rate
    if target is None or result.highest.preload_for_target is not None:
        return ""
    forces = [(max(some.values()), n) for n, some in enumerate(map(_target_forces, result.loads)) if some]
    if not forces:
        answer = TARGET.of(result.answers)
        return say(display, "target", "unmet", why=answer.remarks[0]) if answer and answer.remarks else ""
    # a fluid that closes the seal leaves most to the spring at its lowest pressure
    force, number = max(forces)
    load = result.loads[number]
    contact = load.contact_force_for_target
    return say(
        display,
        "target",
        "brief",
        target=target_text(result, target),
        force="" if force <= 0.0 else _target_force(display, load, force),
        # another reading moves the force of the contact by as much as that of the spring
        contact=None if contact is None else contact + force - (load.force_for_target or 0.0),
        load=load,
    )


def _target_forces(load: CaseLoad) -> dict[str, float]:
    """Force for the target in the scenario of the case and in those beside, where one is found [N]."""
    forces = {name: scenario.force_for_target for name, scenario in {"": load, **load.others}.items()}
    known_forces = {name: force for name, force in forces.items() if force is not None}
    return {} if load.force_for_target is None else known_forces


def target_text(result: SealSolution, leak_rate: float) -> str:
    """The target leak rate as it was written, of a gas with its state.

    Parameters
    ----------
    result : SealSolution
    leak_rate : float
        [m^3/s]
    """
    display = result.display
    state, rate = display.state_of(volume_of(result.case)), display.quantity(leak_rate, "given flow")
    return f"{rate} at {state}" if state else rate


def _target_force(display: Display, load: CaseLoad, force: float) -> str:
    unit = display.unit_for("force", force)
    return f"{format_digits(unit.of(force), load.digits_of('force_for_target'))} {unit.name}"


def valve_table(result: SealSolution) -> ReadableTable:
    """Opening and target force at each load; no rows if not calculated."""
    given, asked = (
        filled_columns(result.case, SHOWN_COLUMNS[key], result.loads) for key in ("given", "asked")
    )
    # the pressure that lifts the closure off, also where leak.csv has the one that lifts the surfaces apart
    pressures = (load.blow_off_pressure for load in result.loads)
    opens = [None if pressure is None or math.isinf(pressure) else pressure for pressure in pressures]
    asked = [
        replace(column, values=opens) if column.column.name == "blow_off_pressure_Pa" else column
        for column in asked
    ]
    if not any(column.some for column in asked):
        return ReadableTable((), ())
    return columns_table([*given, *asked])


def _page(result: SealSolution, display: Display) -> AnswerPage:
    load, first = decisive(result), target_in_brief(result, display)
    return AnswerPage(
        first=[first] if first else (),
        tiles=[*tiles(result, display, load)],
        why=[*_why(display, load)],
        section=worded_section(display, "target", (), valve_table(result)),
    )


OUTPUT = AnswerOutput(
    lambda result: (
        result.case.load.target_leak_rate is not None or any(load.blow_off_pressure for load in result.loads)
    ),
    page=_page,
)
