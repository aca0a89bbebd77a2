"""Effect of particles in the fluid on the leak, in words and a table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict

import numpy as np

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.particles import KEPT, ParticleAnswers, answers_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.columns import ReadableTable
from fem_seal.output.pictures.colours import BLUE, FILL, GREY, ORANGE
from fem_seal.output.pictures.style import Picture, captioned, label, panels
from fem_seal.output.prose import phrase
from fem_seal.output.shown import Section, Shown, worded_section, worded_table
from fem_seal.output.tables import PARTICLE_COLUMNS
from fem_seal.seal.load_result import load_name
from fem_seal.units import quantity, unit_for

_PER_ML = 1e-6


def particles_in_words(result: SealSolution) -> list[str]:
    """Estimated effect of particles at the highest load; empty without particles.

    Parameters
    ----------
    result : SealSolution
    """
    answers = answers_of(result.highest, result.particles)
    return [] if answers is None else list(_sentences(result, answers))


def _sentences(result: SealSolution, answers: ParticleAnswers) -> Iterator[str]:
    at = load_name(result.highest, result.loads)
    yield phrase("particles.narrow", "from", load=at, sizes=answers.narrowest)
    yield _filter(answers)
    yield _stopped_in_words(result, answers)
    if math.isfinite(answers.half_volume[0]):
        yield phrase("particles.decay", "half", found=answers)
    around = result.highest.around
    scratched = around is not None and around.scratches is not None
    yield phrase("particles.estimate", "all", "scratches" if scratched else "")


def _stopped_in_words(result: SealSolution, answers: ParticleAnswers) -> str:
    fluid, (few, many) = result.case.fluid, answers.stopped
    assert fluid is not None and fluid.particles is not None  # the answers are about them
    size = fluid.particles.counts.sizes[0]
    if many == 0:
        return phrase("particles.stopped", "none")
    if math.isnan(many):
        return phrase("particles.stopped", "uncounted", size=size)
    further = "extrapolated" if answers.narrowest[0] < size else ""
    return phrase("particles.stopped", "count", further, count=(few * _PER_ML, many * _PER_ML), size=size)


def _filter(answers: ParticleAnswers) -> str:
    if answers.keeping_filter is None:
        kinds = ["none"]
    else:
        ends = {quantity("length", one, 2) for one in answers.keeping_filter}
        kinds = ["keeps", "safe" if len(ends) > 1 else ""]
    if answers.filter is not None and answers.left is not None:
        kinds.append("given")
    return phrase("particles.filter", *kinds, found=answers, lost=1.0 - KEPT)


def particle_table(result: SealSolution) -> ReadableTable:
    """Leak rate over the size of the gaps that are shut; no rows without particles.

    Parameters
    ----------
    result : SealSolution
    """
    answers, state = answers_of(result.highest, result.particles), volume_of(result.case).state
    return worded_table(
        "particles",
        [
            {"one": one, "per_ml": tuple(count * _PER_ML for count in one.particles)}
            for one in (answers.curve if answers is not None else ())
        ],
        state=f" (gas at {state})" if state else "",
        digits=min(result.highest.leak_digits, 2),
    )


def _rows(answers: ParticleAnswers) -> list[tuple[float, ...]]:
    """Rows of a load with `PARTICLE_COLUMNS`, one for each size.

    Parameters
    ----------
    answers : ParticleAnswers
    """
    load = answers.fluid_pressure, answers.applied_force
    return [
        (*load, one.size, *one.gaps_below, *one.leak_rate, *one.remaining, *one.particles)
        for one in answers.curve
    ]


def particle_picture(result: SealSolution) -> Picture | None:
    """Remaining leak over the size of the gaps that are shut, and number of particles of that size.

    None without particles.

    Parameters
    ----------
    result : SealSolution
    """
    answers = answers_of(result.highest, result.particles)
    if answers is None:
        return None
    sizes = np.array([one.size for one in answers.curve])
    left = np.array([one.remaining for one in answers.curve]).T
    below = np.array([one.gaps_below for one in answers.curve]).T
    unit = unit_for("length", float(sizes.max()))
    figure, (share, counts) = panels(2, height=3.5)
    share.axvspan(
        *(one / unit.size for one in answers.narrowest), color=FILL, label="too large to pass from here on"
    )
    for both, colour, style, name in (
        (left, BLUE, "o-", "leak with narrower gaps shut"),
        (below, ORANGE, "--", "area with narrower gaps"),
    ):
        share.fill_between(sizes / unit.size, *(100 * both), color=colour, alpha=0.15, linewidth=0)
        for n, end in enumerate(both):
            # one entry of the legend for both ends
            label_once = None if n else name
            share.plot(sizes / unit.size, 100 * end, style, color=colour, ms=3.2, label=label_once)
    if answers.filter is not None:
        share.axvline(answers.filter / unit.size, color=GREY, linewidth=1.1, label="filter")
    share.set_ylim(0.0, 105.0)
    few, many = (np.array([one.particles[end] for one in answers.curve]) * 1e-6 for end in (0, 1))
    there = many > 0
    if there.any():
        x, low, high = sizes[there] / unit.size, few[there], many[there]
        counts.fill_between(x, low, high, color=BLUE, alpha=0.15, linewidth=0)
        for ends in (low, high):
            counts.plot(x, ends, color=BLUE)
    for axes in (share, counts):
        axes.set_xlim(0.9 * sizes[0] / unit.size, 1.1 * sizes[-1] / unit.size)
    size, log = f"particle size  [{unit.name}]", "xy" if there.any() else "x"
    label(share, "Leak with narrower gaps shut (estimate)", size, "share  [%]", log="x", legend="center left")
    label(counts, "Particles in the fluid", size, "per ml, at least as large", log=log)
    at = load_name(result.highest, result.loads)
    behind = "behind_filter" if answers.filter is not None else ""
    return captioned(figure, "particles", "all", behind, load=at)


def _section(result: SealSolution) -> Section | None:
    load = load_name(result.highest, result.loads)
    return worded_section("particles", particles_in_words(result), particle_table(result), load=load)


SHOWN = Shown(
    lambda result: result.particles,
    summary=lambda result: {"particles": [asdict(answers) for answers in result.particles]},
    absent={"particles": []},
    tables={
        "particles.csv": lambda result: (
            PARTICLE_COLUMNS,
            [row for answers in result.particles for row in _rows(answers)],
        )
    },
    section=_section,
    pictures=lambda result: (particle_picture(result),),
    lines=particles_in_words,
)
