"""Estimate for particles in the fluid: which gaps stop them, what still leaks, how fast the leak clogs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np

import leak
from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.arrays import FloatArray
from fem_seal.profile import PressureProfile
from fem_seal.seal.findings import Bounds
from fem_seal.seal.leak_model import LeakModel

if TYPE_CHECKING:
    from leak import GapDistribution, ParticleCounts, Paths


# Sizes at which the leak is looked at [m]: the series E12, 12 to the decade, from a nanometre to nearly a millimetre.
_SERIES = (1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.3, 3.9, 4.7, 5.6, 6.8, 8.2)
_SIZES = tuple(float(f"{digits}e{decade}") for decade in range(-9, -3) for digits in _SERIES)
# Below this share of the narrowest place particles pass: they would shut some ten-thousandths of the leak.
_FREE_SHARE = 0.2
# More of the leak than one of them is all, and less than the other none; at most so many sizes lie between.
_ALL_OF_LEAK, _NO_LEAK, _MOST_SIZES = 0.99, 1e-3, 40
_NO_CLOGGING = Bounds(math.inf, math.inf)
# Share of the leak that a filter is to keep.
KEPT_SHARE = 0.9

ShutFunction = Callable[[LeakModel, float], LeakModel]


@dataclass(frozen=True)
class ShutGaps:
    """A load whose gaps below a size are shut; the ranges are those of both scenarios of yielding asperities.

    Parameters
    ----------
    size : float
        [m]
    gaps_below : Bounds
        Share of the open area at the peak pressure whose gap is narrower, least and most.
    leak_rate : Bounds
        Of all others, least and most [m^3/s].
    remaining : Bounds
        The same over the leak rate of the clean fluid in the same reading.
    particles : Bounds
        Particles of at least this size per volume, as few and as many as the counts allow [1/m^3]; NaN where they say
        nothing.
    """

    size: float
    gaps_below: Bounds
    leak_rate: Bounds
    remaining: Bounds
    particles: Bounds


@dataclass(frozen=True)
class ParticleAnswers:
    """What particles in the fluid do to the leak of a load, an estimate; least and most of both scenarios everywhere.

    Parameters
    ----------
    fluid_pressure, applied_force : float
        Of the load [Pa], [N].
    leak_rate : Bounds
        Of the clean fluid [m^3/s].
    narrowest : Bounds
        Size from which on a particle finds no way through where the contact pressure is highest [m], by the effective
        medium and by the critical junction.
    curve : tuple of ShutGaps
        Over the size of the particles, increasing.
    stopped : Bounds
        Particles that do not get through, per volume [1/m^3]; NaN, as what follows from it, where they are smaller than
        anything that the counts speak of.
    places : Bounds
        Places side by side that one particle each can shut.
    half_volume : Bounds
        Volume that leaks until half of the leak is left [m^3]; infinite if nothing clogs, and where a filter keeps more
        than half.
    half_time : Bounds
        Time until then [s].
    keeping_filter : Bounds or None
        Largest particles that cannot take more than a tenth of the leak, the rating of an absolute filter [m].
    filter : float or None
        The one that there is [m].
    left : Bounds or None
        Share of the leak that the particles it lets through cannot shut.
    """

    fluid_pressure: float
    applied_force: float
    leak_rate: Bounds
    narrowest: Bounds
    curve: tuple[ShutGaps, ...]
    stopped: Bounds
    places: Bounds
    half_volume: Bounds
    half_time: Bounds
    keeping_filter: Bounds | None
    filter: float | None
    left: Bounds | None


def particle_answers(loads: Sequence[CaseLoad], counts: ParticleCounts) -> tuple[ParticleAnswers, ...]:
    """Answers for all loads that leak.

    Parameters
    ----------
    loads : sequence of CaseLoad
        Of one case.
    counts : ParticleCounts
        Particles in its fluid.
    """
    shut_gaps = _shut_function()
    answers = (_answers(load, counts, shut_gaps) for load in loads)
    return tuple(answer for answer in answers if answer is not None)


def answers_of(load: CaseLoad, answers: Sequence[ParticleAnswers]) -> ParticleAnswers | None:
    """Those of one load; None if it does not leak or lies outside the theory.

    Parameters
    ----------
    load : CaseLoad
    answers : sequence of ParticleAnswers
        Of all loads.
    """
    if load.validity.outside_theory:
        return None
    return next((x for x in answers if (x.fluid_pressure, x.applied_force) == load.point), None)


def _shut_function() -> ShutFunction:
    """Rough surfaces with all gaps below a size shut, made once for each surface and size."""

    @cache
    def shut_gaps(rough: LeakModel, size: float) -> LeakModel:
        table = rough.table
        # the load leaks, and the checks refuse particles beside a turned face
        surface = rough.surface
        assert table is not None and isinstance(surface, leak.RoughContact)
        return replace(rough, make=lambda *_: leak.shut_conductivity(table, surface, size))

    return shut_gaps


@dataclass(frozen=True)
class _Scenario:
    """A load with one reading of its asperities, which leaks."""

    load: CaseLoad
    rough: LeakModel
    leak_rate: float
    shut: ShutFunction

    @classmethod
    def of(cls, load: CaseLoad, shut_gaps: ShutFunction) -> list[_Scenario]:
        """Those of all scenarios that leak."""
        return [
            cls(scenario, scenario.rough, scenario.leak.leak_rate, shut_gaps)
            for scenario in (load, *load.others.values())
            if scenario.rough is not None
            and scenario.leak is not None
            and 0 < scenario.leak.leak_rate < math.inf
        ]

    @property
    def profile(self) -> PressureProfile:
        """At the pressures of first loading that leave the same gaps."""
        assert self.rough.table is not None  # the load leaks
        return self.load.tightest.equivalent(self.rough.table, self.rough.surface)

    @cached_property
    def gaps(self) -> GapDistribution:
        assert isinstance(self.rough.surface, leak.RoughContact)  # of the checks
        return leak.GapDistribution.of(self.rough.surface, [self.profile.peak_pressure])

    @property
    def largest_passing(self) -> float:
        return float(self.gaps.largest_passing[0])

    @property
    def narrowest(self) -> tuple[float, float]:
        return self.largest_passing, self.load.critical_separation or 0.0

    def area_below(self, size: float) -> float:
        """Share of the open area."""
        contact = float(self.gaps.contact[0])
        return (float(self.gaps.area_below(size)[0]) - contact) / (1.0 - contact)

    def remaining_share(self, size: float) -> float:
        """Share of the leak that is left with all gaps below a size shut."""
        result = replace(self.load, rough=self.shut(self.rough, size)).leak
        assert result is not None  # that of the open surfaces is there
        return min(result.leak_rate / self.leak_rate, 1.0)

    def places(self) -> Paths:
        table, profile = self.rough.table, self.profile
        assert table is not None  # the load leaks
        length = leak.throttling_length(profile.x, profile.pressure, table.liquid)
        faces = 1 if self.rough.flow is None else self.rough.flow.faces
        circle = 2.0 * math.pi * self.load.contact.model.initial_contact_radius * faces
        return leak.parallel_paths(circle, length, self.largest_passing)


def _answers(load: CaseLoad, counts: ParticleCounts, shut_gaps: ShutFunction) -> ParticleAnswers | None:
    scenarios = _Scenario.of(load, shut_gaps)
    # a scratch leaks where nothing else does, and is open to particles
    if not scenarios or not all(state.largest_passing > 0.0 for state in scenarios):
        return None
    sizes, shares = _curve(scenarios)
    particles = counts.at_least(sizes)
    stops = [leak.stopped(counts, sizes, share) for share in shares]
    places = [state.places() for state in scenarios]
    decays = [
        leak.cloggings(*terms) for terms in zip((r.leak_rate for r in scenarios), stops, places, strict=True)
    ]
    filter_size = counts.largest if math.isfinite(counts.largest) else None
    residue = None if filter_size is None else Bounds.of(x.remaining_share(filter_size) for x in scenarios)
    # a scratch stays open, whatever is shut beside it
    is_halved = max(0.0 if residue is None else residue[1], *(share[-1] for share in shares)) < 0.5
    filters = [_size_that_leaves(KEPT_SHARE, sizes, share) for share in shares]
    return ParticleAnswers(
        load.fluid_pressure,
        load.applied_force,
        Bounds.of(state.leak_rate for state in scenarios),
        Bounds.of(size for state in scenarios for size in state.narrowest),
        tuple(
            ShutGaps(
                float(size),
                Bounds.of(state.area_below(float(size)) for state in scenarios),
                Bounds.of(state.leak_rate * share[n] for state, share in zip(scenarios, shares, strict=True)),
                Bounds.of(share[n] for share in shares),
                Bounds(float(particles.low[n]), float(particles.high[n])),
            )
            for n, size in enumerate(sizes)
        ),
        Bounds.of(float(end[0]) for stop in stops for end in (stop.low, stop.high)),
        Bounds.of(count for pair in places for count in pair),
        Bounds.of(decay.volume_to(0.5) for both in decays for decay in both) if is_halved else _NO_CLOGGING,
        Bounds.of(decay.time_to(0.5) for both in decays for decay in both) if is_halved else _NO_CLOGGING,
        Bounds.of(size for size in filters if size is not None) if any(filters) else None,
        filter_size,
        residue,
    )


def _curve(scenarios: Sequence[_Scenario]) -> tuple[FloatArray, list[FloatArray]]:
    """Round sizes, and the share of the leak that is left of each reading."""

    def shares(size: float) -> list[float]:
        return [state.remaining_share(size) for state in scenarios]

    estimate = _FREE_SHARE * min(state.largest_passing for state in scenarios)
    first = int(np.searchsorted(_SIZES, estimate))
    curve = {_SIZES[first]: shares(_SIZES[first])}
    # almost sealed, the last paths are lost to particles far below the narrowest place
    for size in reversed(_SIZES[:first]):
        if min(curve[min(curve)]) > _ALL_OF_LEAK:
            break
        curve[size] = shares(size)
    for size in _SIZES[first + 1 :]:
        if max(curve[max(curve)]) < _NO_LEAK or len(curve) > _MOST_SIZES:
            break
        curve[size] = shares(size)
    sizes = sorted(curve)
    # a few parts in a million of interpolation may not make a leak grow
    return np.array(sizes), list(np.minimum.accumulate([curve[size] for size in sizes], axis=0).T)


def _size_that_leaves(target: float, sizes: FloatArray, share: FloatArray) -> float | None:
    """Size below which gaps may be shut for a share of the leak; None if it is not among them."""
    loss = 1.0 - share
    if not loss[0] < 1.0 - target < loss[-1]:
        return None
    # what is lost goes like the fourth power of the size
    k = int(np.searchsorted(loss, 1.0 - target))
    at = np.interp(
        math.log(1.0 - target), np.log(np.maximum(loss[k - 1 : k + 1], 1e-9)), np.log(sizes[k - 1 : k + 1])
    )
    return math.exp(float(at))


def _compute(seal: SolvedSeal, request: Request) -> tuple[ParticleAnswers, ...]:
    fluid = seal.case.fluid
    assert fluid is not None and fluid.particles is not None  # of `applies`
    return particle_answers(seal.loads, fluid.particles.counts)


PARTICLES = Answer[tuple[ParticleAnswers, ...]](
    "particles",
    "answers about particles in the fluid",
    _compute,
    (),
    status="what particles in the fluid do to the leak",
    needs=("case.fluid.particles",),
)
