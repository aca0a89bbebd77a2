"""How far a load is from opening the seal, in force and in pressure, and how many digits its numbers are worth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fem_seal.loads import PressureSide
from fem_seal.seal.load_result import LoadResult, OpeningMargin

if TYPE_CHECKING:
    from fem_seal.seal.load_solver import LoadSolver


def with_margins(solver: LoadSolver, loads: Sequence[LoadResult]) -> tuple[LoadResult, ...]:
    """Loads with their distance from opening; without one where neither fluid nor applied force opens the seal.

    Parameters
    ----------
    solver : LoadSolver
    loads : sequence of LoadResult
        With the pressure that opens the seal.
    """
    side, found = solver.problem.loads.pressure_side, []
    for load in loads:
        pressure, applied_force = load.fluid_pressure, load.applied_force
        held = solver.opening_force(pressure, load.contact) if side == "outer" and applied_force < 0 else None
        margin = opening_margin(pressure, applied_force, side, opens=load.blow_off_pressure, held=held)
        found.append(load.knowing(opening=margin))
    return tuple(found)


def opening_margin(
    fluid_pressure: float,
    applied_force: float,
    pressure_side: PressureSide,
    *,
    opens: float | None = None,
    held: float | None = None,
) -> OpeningMargin | None:
    """Distance from opening the seal; None where neither fluid nor applied force opens it.

    Parameters
    ----------
    fluid_pressure : float
        [Pa]
    applied_force : float
        Of spring or actuator [N], positive where it closes.
    pressure_side : {"outer", "inner"}
    opens : float, optional
        With the pressure inside, the one that opens the seal under this force [Pa].
    held : float, optional
        With the pressure outside, the negative force that opens the seal at this pressure [N].

    Examples
    --------
    A spring of 1 kN that holds 64 bar, at 63 bar:

    >>> margin = opening_margin(63e5, 1e3, "inner", opens=64e5)
    >>> print(f"{margin.force:.3f} N, {margin.pressure:.0f} Pa, {margin.share:.4f}, {margin.digits} digits")
    15.625 N, 100000 Pa, 0.0156, 2 digits
    """
    if pressure_side == "inner":
        if opens is None or not math.isfinite(opens):
            return None
        share = 1 - fluid_pressure / opens
        return OpeningMargin(share * applied_force, opens - fluid_pressure, share)
    # the spring lifts, and the fluid has to hold it
    if applied_force >= 0 or held is None or not held < 0:
        return None
    share = 1 - applied_force / held
    return OpeningMargin(applied_force - held, share * fluid_pressure, share)
