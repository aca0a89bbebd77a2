"""Checks of form errors."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from fem_seal.form import FormError
from fem_seal.loads import LARGEST_EXCESS
from fem_seal.seal.circumference import Circumference
from fem_seal.seal.findings import Bounds, Finding, Level, caution, fade_in, near_limit, remark
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.units import format_at_limit
from fem_seal.validity.fluid import opening_factor
from fem_seal.wording import Quantity

# Wave number times standard deviation of the contact up to which the long-wave equation is within 0.3 % of the mean
# line load, and beyond which it is void; see docs/theory/form.md.
_LONG, _LONGEST = 0.2, 0.6
# A wave with less than this share of the form error's amplitudes is ignored.
_COUNTS = 0.03
# Line load over its mean below which a place counts as open.
_OPEN = 1e-2
# Fluid pressure over the local peak contact pressure, above which it opens the gap noticeably.
_FLUID_OPENS = 0.5


def form_cautions(form: FormError, problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Cautions about a seal that is not round.

    Parameters
    ----------
    form : FormError
        Of the problem.
    problem : SealProblem
    loads : sequence of LoadResult
        Each caution is about the worst of them.
    """
    for text in form.remarks:
        yield remark("form", Level.DOUBTFUL, text)
    circumferences = [
        (load, load.circumference)
        for load in loads
        if load.circumference is not None and load.circumference.form.uneven
    ]
    if not circumferences:
        return
    yield from _short_waves(loads, circumferences)
    if math.isinf(circumferences[0][0].contact.model.relative_radius):
        yield caution("conforming")
    yield from _open(loads, circumferences)
    yield from _fluid_opens(problem, loads, circumferences)
    yield from _crest(problem, loads, circumferences)


_Circumferences = Sequence[tuple["LoadResult", "Circumference"]]


def _short_waves(loads: Sequence[LoadResult], circumferences: _Circumferences) -> Iterator[Finding]:
    waves_felt = circumferences[0][1].form.felt_waves
    total = sum(abs(wave.amplitude) for wave in waves_felt)
    waves = max((wave.waves for wave in waves_felt if abs(wave.amplitude) > _COUNTS * total), default=1)
    if (of_bolts := circumferences[0][1].bolts_gap) is not None:
        amplitudes = np.abs(np.fft.rfft(of_bolts))
        waves = max(waves, *np.flatnonzero(amplitudes > _COUNTS * amplitudes.sum()).tolist(), 1)
    load, _ = max(circumferences, key=lambda pair: pair[0].std)
    std, r0 = load.std, load.contact.model.initial_contact_radius
    share = waves * std / r0
    if share > _LONG:
        yield caution(
            "short_waves",
            load,
            loads,
            outside=share > _LONGEST,
            times=1 / share,
            waves=waves,
            length=2 * math.pi * r0 / waves,
            std=std,
            share=share,
            long=_LONG,
        )


def _open(loads: Sequence[LoadResult], circumferences: _Circumferences) -> Iterator[Finding]:
    load, circumference = min(circumferences, key=lambda pair: pair[1].least_over_mean)
    if circumference.least_over_mean < _OPEN:
        share = float(np.mean(circumference.line_load < _OPEN * circumference.line_load.mean()))
        yield caution("open_in_part", load, loads, share=share, limit=100 * _OPEN)


def _fluid_opens(
    problem: SealProblem, loads: Sequence[LoadResult], circumferences: _Circumferences
) -> Iterator[Finding]:
    def share(pair: tuple[LoadResult, Circumference]) -> float:
        return pair[0].fluid_pressure / max(float(pair[1].peak_pressure.min()), 1e-300)

    load, circumference = max(circumferences, key=share)
    worst = share((load, circumference))
    if problem.flow is not None and circumference.least_over_mean >= _OPEN:
        # beside what it opens at the mean line load
        factor = opening_factor(worst) / opening_factor(min(load.fluid_pressure / load.peak_pressure, worst))
        yield caution(
            "fluid_opens_in_part",
            load,
            loads,
            leak_factor=fade_in(
                Bounds(1.0, math.inf if math.isnan(factor) else factor), worst / _FLUID_OPENS
            ),
            proven=False,
            is_reported=worst > _FLUID_OPENS,
            worst=worst,
        )


def _crest(
    problem: SealProblem, loads: Sequence[LoadResult], circumferences: _Circumferences
) -> Iterator[Finding]:
    """Stress at the largest line load: that at the mean line load, scaled with the peak pressure."""
    limits = [body.yield_stress for body in problem.materials.values() if body.yield_stress is not None]
    if not (limits and loads[0].contact.model.knows_stress):
        return
    load, circumference = max(circumferences, key=lambda pair: float(pair[1].peak_pressure.max()))
    ratio = float(circumference.peak_pressure.max()) / load.peak_pressure
    stress = ratio * load.largest_stress[0]
    if load.largest_stress[0] <= min(limits) < stress:
        limit = min(limits)
        times = format_at_limit(stress / min(limits), 1.0, min(load.pressure_digits, 2))
        yield caution(
            "yield_stress_in_part",
            load,
            loads,
            outside=stress > LARGEST_EXCESS * min(limits),
            times=times,
            ratio=ratio,
            stress=near_limit(stress, limit, min(load.pressure_digits, 3)),
            limit=Quantity(limit, "fixed MPa"),
        )
