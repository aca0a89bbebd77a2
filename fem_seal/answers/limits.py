"""The largest leak rates that a requirement allows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fem_seal.answers.judgement import Limit
from fem_seal.answers.leakage_class import nominal_size, test_of
from fem_seal.case.leak_rate import Bubbles

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.case.fluid import Fluid
    from fem_seal.case.requirement import Requirement
    from fem_seal.seal.load_result import LoadResult


OF_LEAK_RATE = "leak rate"


def limits(case: Case, fluid_pressure: float, load: LoadResult | None = None) -> tuple[Limit, ...]:
    """The limits that a case's requirement sets at a fluid pressure; empty without a requirement.

    Parameters
    ----------
    case : Case
    fluid_pressure : float
        [Pa]
    load : LoadResult, optional
        The load that is judged, whose contact says what a test with another fluid would find; without it the limits
        hold for any gap.
    """
    required = case.requirement
    if required is None or case.fluid is None:
        return ()
    own = () if required.leak_rate is None else (limit_of_rate(required.leak_rate),)
    of_class = _of_class(case, required, case.fluid, fluid_pressure, load)
    return own if of_class is None else (*own, of_class)


def limit_of_rate(leak_rate: float) -> Limit:
    """A largest leak rate [m^3/s] as it was written."""
    volume = leak_rate.volume if isinstance(leak_rate, Bubbles) else None
    return Limit(OF_LEAK_RATE, leak_rate, bubble_volume=volume)


def _of_class(
    case: Case, required: Requirement, fluid: Fluid, fluid_pressure: float, load: LoadResult | None
) -> Limit | None:
    from leak.standards import STANDARDS, leakage_limits, visible_leak_rate

    wanted = required.standard_and_class
    if wanted is None:
        return None
    size, gas = nominal_size(case), fluid.gas is not None
    known = leakage_limits(
        size.size,
        gas=gas,
        pressure_drop=fluid_pressure,
        seat_diameter=size.diameter,
        rated_capacity=required.rated_capacity,
        bubble_volume=required.bubble_volume,
    )
    found = [one.leak_rate for one in known if (one.standard, one.name) == wanted]
    name = " ".join(wanted)
    test_fluid, ratio = test_of(fluid, fluid_pressure, load)
    if not found:
        # class VI of FCI 70-2 ends at a diameter
        return Limit(name, math.nan, 0.0, test_fluid, ratio)
    visible = 0.0 if found[0] else visible_leak_rate(gas=gas, bubble_volume=required.bubble_volume)
    bubble = required.bubble_volume or STANDARDS[wanted[0]].bubble_volume
    counts_bubbles = gas and (visible > 0.0 or wanted[0] == "API 598")
    return Limit(name, found[0], visible, test_fluid, ratio, bubble if counts_bubbles else None)
