"""Picture of what particles in the fluid do to the leak."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.particles import answers_of
from fem_seal.output.pictures.style import BLUE, FILL, GREY, ORANGE, Picture, label, logarithmic, panels, svg
from fem_seal.output.prose import said
from fem_seal.seal.load_names import load_name
from fem_seal.units import unit_for

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution


def particle_picture(result: SealSolution) -> Picture | None:
    """Leak that is left over the size of the gaps that are shut, and how many particles are that large.

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
        *(one / unit.size for one in answers.narrowest), color=FILL, label="no way through from here on"
    )
    for both, colour, style, name in (
        (left, BLUE, "o-", "leak with narrower gaps shut"),
        (below, ORANGE, "--", "area with narrower gaps"),
    ):
        share.fill_between(sizes / unit.size, *(100 * both), color=colour, alpha=0.15, linewidth=0)
        for n, end in enumerate(both):
            # both ends are one line of the legend
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
    logarithmic(share, "x")
    logarithmic(counts, "x", *(["y"] if there.any() else []))
    share.legend(loc="center left")
    label(share, "What the others let through (estimate)", f"particle size  [{unit.name}]", "share  [%]")
    label(counts, "Particles in the fluid", f"particle size  [{unit.name}]", "per ml, at least as large")
    at = load_name(result.highest, result.loads)
    return Picture(
        "particles",
        svg(figure),
        said("captions.particles", "alt", load=at),
        said("captions.particles", "all", "behind_filter" if answers.filter is not None else "", load=at),
    )
