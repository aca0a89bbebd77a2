"""Where a result leaves the range in which its theory holds: one sentence each, with the number behind it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.condensation import ContactModel
    from fem_seal.results import DiscretisationError, LoadResult

# Pressure at the ends of the contact zone over the peak pressure above which contact is cut off.
_CUT_OFF = 1e-6
_LARGEST_ERROR = 2e-3
# Beyond this share of the ball's radius the contact is no narrow line any more.
_NARROW = 0.2


def contact_warnings(
    case: Case, model: ContactModel, loads: Sequence[LoadResult], error: DiscretisationError
) -> tuple[str, ...]:
    """Everything that a user should know before believing the result.

    Parameters
    ----------
    case : Case
    model : ContactModel
    loads : sequence of LoadResult
    error : DiscretisationError
    """
    return tuple(
        text for check in (_yielding, _cut_off, _wide, _above_hardness) for text in check(case, model, loads)
    ) + tuple(_coarse(model, error))


def _yielding(case: Case, model: ContactModel, loads: Sequence[LoadResult]) -> Iterator[str]:
    for name, material in (("closure", case.closure.material), ("seat", case.seat.material)):
        limit = material.yield_stress
        if limit is None:
            continue
        worst = [
            (load, float(load.contact.fields[name].von_mises.max()))
            for load in loads
            if load.max_von_mises > limit
        ]
        over = [(load, stress) for load, stress in worst if stress > limit]
        if over:
            load, stress = max(over, key=lambda item: item[1])
            first = min(load.fluid_pressure for load, _ in over)
            yield (
                f"{name}: von Mises stress {stress / 1e6:.4g} MPa at {load.fluid_pressure / 1e5:.4g} bar exceeds the "
                f"yield stress {limit / 1e6:.4g} MPa (from {first / 1e5:.4g} bar on); the bodies are solved as "
                "elastic, the true contact is wider and its peak pressure lower"
            )


def _cut_off(case: Case, model: ContactModel, loads: Sequence[LoadResult]) -> Iterator[str]:
    for end, side in ((0, "bore"), (-1, "outer")):
        shares = [float(load.contact.pressure[end]) / load.contact.profile.peak_pressure for load in loads]
        if max(shares) > _CUT_OFF:
            load = loads[shares.index(max(shares))]
            yield (
                f"at {load.fluid_pressure / 1e5:.4g} bar the contact reaches the {side} end of the seat's face with "
                f"{max(shares):.2g} of its peak pressure (x = {model.line.x[end] * 1e3:.4g} mm); it is cut off there"
            )


def _wide(case: Case, model: ContactModel, loads: Sequence[LoadResult]) -> Iterator[str]:
    load = max(loads, key=lambda load: load.contact.profile.std)
    share = 2 * load.contact.profile.std / model.touch_radius
    if share > _NARROW:
        yield (
            f"the contact is wide: two standard deviations are {share:.2g} of its radius at "
            f"{load.fluid_pressure / 1e5:.4g} bar; line loads and closed-form profiles assume a narrow line"
        )


def _above_hardness(case: Case, model: ContactModel, loads: Sequence[LoadResult]) -> Iterator[str]:
    hardness = case.hardness if case.leak.plasticity and case.roughness is not None else None
    load = max(loads, key=lambda load: load.contact.profile.peak_pressure)
    peak = load.contact.profile.peak_pressure
    if hardness is not None and peak > 0.3 * hardness:
        yield (
            f"peak pressure {peak / 1e6:.4g} MPa at {load.fluid_pressure / 1e5:.4g} bar is {peak / hardness:.2g} of "
            "the hardness; the theory of yielding asperities holds far below it"
        )


def _coarse(model: ContactModel, error: DiscretisationError) -> Iterator[str]:
    worst = max(error.peak_pressure, error.std, error.leak_rate or 0.0)
    if worst > _LARGEST_ERROR:
        size = float(np.diff(model.line.vertices).min())
        yield (
            f"the estimated discretisation error is {100 * worst:.2g} %; a [mesh] contact_size below the present "
            f"{1e6 * size:.3g} um reduces it"
        )
