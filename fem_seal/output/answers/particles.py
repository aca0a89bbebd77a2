"""Effect of particles in the fluid on the leak, in words and a table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.particles import KEPT_SHARE, ParticleAnswers, answers_of
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Tile, worded_section, worded_table
from fem_seal.output.columns import ReadableTable
from fem_seal.output.pictures.colours import BLUE, FILL, GREY, ORANGE
from fem_seal.output.pictures.style import NARROW, Picture, captioned, label, panels
from fem_seal.output.tables import PARTICLE_COLUMNS
from fem_seal.seal.load_result import load_name
from fem_seal.wording import say, say_all

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display

_PER_ML = 1e-6


def _sentences(result: SealSolution, answers: ParticleAnswers, display: Display) -> Iterator[str]:
    """Estimated effect of particles at the highest load."""
    yield _narrow(result, answers, display)
    keeping = answers.keeping_filter or ()
    two = len({display.quantity(size, "length 2") for size in keeping}) > 1
    yield from say_all(display, "particles", "filters", answers=answers, lost=1.0 - KEPT_SHARE, two=two)
    fluid = result.case.fluid
    assert fluid is not None and fluid.particles is not None  # the answers are about them
    size, narrowest = fluid.particles.counts.sizes[0], answers.narrowest[0]
    count = tuple(number * _PER_ML for number in answers.stopped)
    yield from say_all(display, "particles", "stopped", count=count, size=size, narrowest=narrowest)
    if math.isfinite(answers.half_volume[0]):
        yield say(display, "particles", "decay", answers=answers)
    around = result.highest.around
    scratches = around is not None and around.scratches is not None
    yield from say_all(display, "particles", "estimate", scratches=scratches)


def _narrow(result: SealSolution, answers: ParticleAnswers, display: Display) -> str:
    at = load_name(result.highest, result.loads, display)
    return say(display, "particles", "narrow", load=at, sizes=answers.narrowest)


def particle_table(result: SealSolution) -> ReadableTable:
    """Leak rate over the size of the gaps that are shut; no rows without particles.

    Parameters
    ----------
    result : SealSolution
    """
    display, answers = result.display, answers_of(result.highest, result.particles)
    state = display.state_of(volume_of(result.case))
    return worded_table(
        display,
        "particles",
        [
            {"point": point, "per_ml": tuple(count * _PER_ML for count in point.particles)}
            for point in (answers.curve if answers is not None else ())
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
        (*load, point.size, *point.gaps_below, *point.leak_rate, *point.remaining, *point.particles)
        for point in answers.curve
    ]


def particle_picture(result: SealSolution) -> Picture | None:
    """Remaining leak over the size of the gaps that are shut; None without particles.

    Parameters
    ----------
    result : SealSolution
    """
    answers = answers_of(result.highest, result.particles)
    if answers is None:
        return None
    sizes = np.array([point.size for point in answers.curve])
    left = np.array([point.remaining for point in answers.curve]).T
    below = np.array([point.gaps_below for point in answers.curve]).T
    unit = result.display.unit_for("length", float(sizes.max()))
    figure, (share,) = panels(1, height=3.5, width=NARROW)
    share.axvspan(
        *(size / unit.size for size in answers.narrowest), color=FILL, label="too large to pass from here on"
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
    share.set_xlim(0.9 * sizes[0] / unit.size, 1.1 * sizes[-1] / unit.size)
    size = f"particle size  [{unit.name}]"
    label(share, "Leak with narrower gaps shut (estimate)", size, "share  [%]", log="x", legend="center left")
    at = load_name(result.highest, result.loads, result.display)
    return captioned(result.display, figure, "particles", "all", load=at)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    answers, load = (
        answers_of(result.highest, result.particles),
        load_name(result.highest, result.loads, display),
    )
    if answers is None:
        return AnswerPage()
    sentences, tiles = list(_sentences(result, answers, display)), []
    if answers.keeping_filter is not None:
        size = display.quantity(answers.keeping_filter, "length 2")
        tiles.append(Tile("Filter", size, say(display, "particles", "keeping", lost=1.0 - KEPT_SHARE), 50))
    return AnswerPage(
        tiles=tiles,
        why=[_narrow(result, answers, display)],
        section=worded_section(display, "particles", sentences, particle_table(result), load=load),
        details=sentences,
    )


OUTPUT = AnswerOutput(
    lambda result: result.particles,
    summary=lambda result: {"particles": [asdict(answers) for answers in result.particles]},
    absent={"particles": []},
    tables={
        "particles.csv": lambda result: (
            PARTICLE_COLUMNS,
            [row for answers in result.particles for row in _rows(answers)],
        )
    },
    pictures=lambda result: (particle_picture(result),),
    page=_page,
)
