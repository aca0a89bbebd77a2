"""What the report says of a valve: when the fluid opens it, and which force of spring or actuator it needs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.readable import given, percent, quantity, quantity_worth
from fem_seal.report_tables import Column, ReadableTable, columns_table

if TYPE_CHECKING:
    from fem_seal.results import LoadResult, SealResult

_DIGITS = 4
TARGET_FORCE = "Force for the target leak rate"


def opens_at(load: LoadResult) -> str | None:
    """The fluid pressure that lifts the closure off; None if none does, or if nobody asked."""
    pressure = load.blow_off_pressure
    return None if pressure is None or math.isinf(pressure) else quantity("fluid pressure", pressure, _DIGITS)


def valve_facts(result: SealResult, load: LoadResult) -> Iterator[tuple[str, str, str]]:
    """Name, value and remark of the pressure that opens the seal and of the force for the target leak rate."""
    if opens := opens_at(load):
        yield "Opens at", opens, f"fluid pressure, under {given('force', load.applied_force)} of the spring"
    target = result.case.load.target_leak_rate
    if target is not None and load.force_for_target is not None:
        force = quantity("force", load.force_for_target, _DIGITS)
        yield (
            TARGET_FORCE,
            force,
            f"of spring or actuator, to leak {given('flow', target)}",
        )


def what_opens(result: SealResult, load: LoadResult) -> Iterator[str]:
    """How far a load is from opening the seal, and from the target leak rate."""
    if opens := opens_at(load):
        assert load.blow_off_pressure is not None
        share = load.fluid_pressure / load.blow_off_pressure
        carried = quantity_worth("force", load.axial_force, load.digits)
        yield (
            f"The fluid acts against the spring and opens the seal at {opens}. At "
            f"{percent(share, 2 if load.digits == 4 else 4)} of this pressure the contact still carries "
            f"{carried} of the spring's {given('force', load.applied_force)}."
        )
    target, force = result.case.load.target_leak_rate, load.force_for_target
    if target is None or force is None:
        return
    pressure, acting = given("fluid pressure", load.fluid_pressure), load.applied_force
    compared = (
        "none acts now"
        if acting == 0
        else f"{quantity('force', abs(force - acting))} {'more' if force > acting else 'less'} than the "
        f"{given('force', acting)} that act now"
    )
    alone = "; the fluid alone closes more than is needed" if force < 0 else ""
    yield (
        f"The leak rate falls to the target of {given('flow', target)} at {pressure} with a force of spring or "
        f"actuator of {quantity('force', force, _DIGITS)}: {compared}{alone}."
    )


def valve_table(result: SealResult) -> ReadableTable:
    """What fluid and spring do at each load; no rows if nobody asked."""
    loads, digits = result.loads, [load.digits for load in result.loads]
    asked = [
        Column("radius of the fluid's force", "length", [load.effective_radius for load in loads]),
        Column("opens at", "fluid pressure", [_finite(load.blow_off_pressure) for load in loads]),
        Column("force to opening", "force", [_of(load, "force") for load in loads], digits=digits),
        Column(
            "pressure to opening", "fluid pressure", [_of(load, "pressure") for load in loads], digits=digits
        ),
        Column("spring force for the target", "force", [load.force_for_target for load in loads]),
    ]
    if not any(column.filled for column in asked):
        return ReadableTable((), ())
    given_loads = [
        Column("fluid pressure", "fluid pressure", [load.fluid_pressure for load in loads]),
        Column("spring force", "force", [load.applied_force for load in loads]),
        Column("closing force", "force", [load.axial_force for load in loads], digits=digits),
    ]
    return columns_table([*given_loads, *asked])


def _of(load: LoadResult, name: str) -> float | None:
    return None if load.opening is None else float(getattr(load.opening, name))


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
