"""What particles in the fluid do to a leak: which gaps stop them, what still leaks, how fast it clogs. An estimate."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from fem_seal.analysis.flow import RoughFlow
from fem_seal.analysis.results import LoadResult, ParticleAnswers, SealSolution, ShutGaps
from leak import (
    GapDistribution,
    GasConductivityTable,
    ParticleCounts,
    cloggings,
    parallel_paths,
    shut_conductivity,
    stopped,
    throttling_length,
)

# Sizes at which the leak is looked at, over one, two, ... tens of nanometres: the series E12, 12 to the decade.
_SERIES = (1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.3, 3.9, 4.7, 5.6, 6.8, 8.2)
_DECADES = range(-9, -3)
# Below this share of the narrowest place particles pass: they would shut some ten-thousandths of the leak.
_PASSING = 0.2
# Less of the leak than this is none; so many sizes beyond the narrowest place are looked at until there.
_NOTHING, _MOST_BEYOND = 1e-3, 30
_NEVER = (math.inf, math.inf)
# Share of the leak that a filter is to keep.
KEPT = 0.9

Shut = Callable[[float], RoughFlow]


def particle_answers(loads: Sequence[LoadResult], counts: ParticleCounts) -> tuple[ParticleAnswers, ...]:
    """Answers for all loads that leak.

    Parameters
    ----------
    loads : sequence of LoadResult
        Of one case.
    counts : ParticleCounts
        Particles in its fluid.
    """
    rough = next((load.rough for load in loads if load.rough is not None), None)
    if rough is None:
        return ()
    shut = _shut(rough)
    return tuple(
        _answers(load, counts, shut) for load in loads if load.leak is not None and load.leak.leak_rate > 0
    )


def answers_of_highest(result: SealSolution) -> ParticleAnswers | None:
    """Those of the load with the highest fluid pressure; None if it does not leak or lies outside the theory.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    if load.validity.outside:
        return None
    return next(
        (one for one in result.particles if (one.fluid_pressure, one.applied_force) == load.point), None
    )


def _shut(rough: RoughFlow) -> Shut:
    """The rough surfaces with all gaps below a size shut, made once for each size."""

    @cache
    def shut(size: float) -> RoughFlow:
        table = rough.table
        assert table is not None  # the loads leak
        return replace(rough, make=lambda flow, surface: shut_conductivity(table, surface, size))

    return shut


def _answers(load: LoadResult, counts: ParticleCounts, shut: Shut) -> ParticleAnswers:
    assert load.leak is not None and load.rough is not None
    whole, peak = load.leak.leak_rate, load.contact.profile.peak_pressure
    gaps = GapDistribution.of(load.rough.surface, [peak])
    medium, junction = float(gaps.largest_passing[0]), load.critical_separation or 0.0
    rates: dict[float, float] = {}
    for size in _sizes(_PASSING * medium):
        if rates and (rates[max(rates)] < _NOTHING * whole or len(rates) > _MOST_BEYOND):
            break
        rates[size] = _leak_rate(load, shut, size)
    # a few parts in a million of interpolation may not make a leak grow
    rate = np.minimum.accumulate(np.minimum(list(rates.values()), whole))
    share, sizes = rate / whole, np.array(list(rates))
    particles = counts.at_least(sizes)
    found = stopped(counts, sizes, share)
    places = parallel_paths(2.0 * math.pi * load.contact.model.touch_radius, _length(load), medium)
    slow, fast = cloggings(whole, found, places)
    contact = float(gaps.contact[0])
    filter_size = counts.largest if math.isfinite(counts.largest) else None
    left = None if filter_size is None else min(_leak_rate(load, shut, filter_size) / whole, 1.0)
    # a scratch stays open, whatever is shut beside it
    halved = max(left or 0.0, share[-1]) < 0.5
    return ParticleAnswers(
        load.fluid_pressure,
        load.applied_force,
        whole,
        (min(medium, junction), max(medium, junction)),
        tuple(
            ShutGaps(
                float(size),
                float((gaps.below(float(size))[0] - contact) / (1.0 - contact)),
                float(left),
                (float(few), float(many)),
            )
            for size, left, few, many in zip(sizes, rate, particles.low, particles.high, strict=True)
        ),
        (float(found.low[0]), float(found.high[0])),
        (places.fewest, places.most),
        (fast.volume_to(0.5), slow.volume_to(0.5)) if halved else _NEVER,
        (fast.time_to(0.5), slow.time_to(0.5)) if halved else _NEVER,
        _size_that_leaves(KEPT, sizes, share),
        filter_size,
        left,
    )


def _sizes(smallest: float) -> list[float]:
    """Round sizes from a smallest one on [m]."""
    return [
        float(f"{one}e{decade}")
        for decade in _DECADES
        for one in _SERIES
        if float(f"{one}e{decade}") >= smallest
    ]


def _leak_rate(load: LoadResult, shut: Shut, size: float) -> float:
    found = replace(load, rough=shut(size)).leak
    assert found is not None  # that of the open surfaces is there
    return found.leak_rate


def _length(load: LoadResult) -> float:
    """Of the contact along the flow [m]."""
    assert load.rough is not None and load.rough.table is not None
    table = load.rough.table
    liquid = table.liquid if isinstance(table, GasConductivityTable) else table
    return throttling_length(load.contact.profile.x, load.contact.profile.pressure, liquid)


def _size_that_leaves(kept: float, sizes: np.ndarray, share: np.ndarray) -> float | None:
    """Size below which gaps may be shut for a share of the leak; None if it is not among them."""
    lost = 1.0 - share
    if not lost[0] < 1.0 - kept < lost[-1]:
        return None
    # what is lost goes like the fourth power of the size
    k = int(np.searchsorted(lost, 1.0 - kept))
    at = np.interp(
        math.log(1.0 - kept), np.log(np.maximum(lost[k - 1 : k + 1], 1e-9)), np.log(sizes[k - 1 : k + 1])
    )
    return math.exp(float(at))
