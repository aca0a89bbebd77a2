"""What particles in the fluid do to the leak, in words and a table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.particles import KEPT, answers_of
from fem_seal.output.prose import said
from fem_seal.output.report.tables import ReadableTable
from fem_seal.seal.load_names import load_name
from fem_seal.units import given, number, percent, quantity, quantity_worth, worth

if TYPE_CHECKING:
    from fem_seal.answers.particles import ParticleAnswers
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.fluid import Particles

_PER_ML = 1e-6


def particles_in_words(result: SealSolution) -> list[str]:
    """What is to be expected of particles at the highest load, all of it an estimate; empty without particles.

    Parameters
    ----------
    result : SealSolution
    """
    answers = answers_of(result.highest, result.particles)
    return [] if answers is None else list(_said(result, answers))


def _said(result: SealSolution, answers: ParticleAnswers) -> Iterator[str]:
    at = load_name(result.highest, result.loads)
    sizes = _span(*(quantity("length", one, 2) for one in answers.narrowest))
    yield said("particles.narrow", "from", load=at, sizes=sizes)
    yield _filter(answers)
    yield _stopped(result, answers)
    if math.isfinite(answers.half_volume[0]):
        (least, most), (soon, late) = answers.half_volume, answers.half_time
        yield said(
            "particles.decay",
            "half",
            least=quantity_worth("volume", least, 1),
            most=quantity_worth("volume", most, 1),
            soon=quantity_worth("time", soon, 1),
            late=quantity_worth("time", late, 1),
            fewest=_rough(answers.places[0]),
            places=_rough(answers.places[1]),
        )
    around = result.highest.around
    scratched = around is not None and around.scratches is not None
    yield said("particles.estimate", "all", "scratches" if scratched else "")


def _stopped(result: SealSolution, answers: ParticleAnswers) -> str:
    fluid, (few, many) = result.case.fluid, answers.stopped
    assert fluid is not None and fluid.particles is not None  # the answers are about them
    counted = fluid.particles.counts.sizes[0]
    size = given("length", counted)
    if many == 0:
        return said("particles.stopped", "none")
    if math.isnan(many):
        return said("particles.stopped", "uncounted", size=size)
    return said(
        "particles.stopped",
        "count",
        "extrapolated" if answers.narrowest[0] < counted else "",
        count=_span(_rough(few * _PER_ML), _rough(many * _PER_ML)),
        size=size,
    )


def _filter(answers: ParticleAnswers) -> str:
    known = answers.filter is not None and answers.left is not None
    low, high = answers.keeping_filter or (math.nan, math.nan)
    both = _span(quantity("length", low, 2), quantity("length", high, 2))
    return said(
        "particles.filter",
        "none" if answers.keeping_filter is None else "keeps",
        "safe" if " to " in both else "",
        "given" if known else "",
        size=both,
        lost=percent(1.0 - KEPT),
        filter="" if answers.filter is None else given("length", answers.filter),
        left="" if answers.left is None else _span(*map(percent, answers.left)),
    )


def _span(low: str, high: str) -> str:
    """Both ends of a range, or one where they read alike."""
    return low if low == high else f"{low} to {high}"


def _rough(value: float) -> str:
    """No more than its size."""
    return worth(value, 1)


def particle_table(result: SealSolution) -> ReadableTable:
    """Leak rate over the size of the gaps that are shut; no rows without particles.

    Parameters
    ----------
    result : SealSolution
    """
    answers = answers_of(result.highest, result.particles)
    if answers is None:
        return ReadableTable((), ())
    digits, state = min(result.highest.leak_digits, 2), volume_of(result.case).state
    rows = [
        (
            quantity("length", one.size, 2),
            _span(*(worth(count * _PER_ML, 2) for count in one.particles)),
            _span(*map(percent, one.gaps_below)),
            _span(*(quantity_worth("flow", rate, digits) for rate in one.leak_rate)),
            _span(*map(percent, one.remaining)),
        )
        for one in answers.curve
    ]
    headings = (
        "particle size",
        "particles per ml",
        "gaps narrower",
        f"leak rate with these shut{f' (gas at {state})' if state else ''}",
        "of the leak",
    )
    return ReadableTable(headings, tuple(rows))


def particle_rows(particles: Particles) -> list[tuple[str, str]]:
    """The table [fluid.particles] of a case in readable units.

    Parameters
    ----------
    particles : Particles
    """
    rows = []
    if particles.iso_4406 is not None:
        rows.append(("particles, ISO 4406", particles.iso_4406))
    else:
        counts = particles.counts
        rows += [
            (f"particles of at least {given('length', size)}", f"{number(count * _PER_ML, 3)} per ml")
            for size, count in zip(counts.sizes, counts.low, strict=True)
        ]
    if particles.filter is not None:
        rows.append(("filter", given("length", particles.filter)))
    return rows
