"""Picture of the loop: the leak rate after a larger load, beside that of first loading."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.leakage_class import volume_of
from fem_seal.output.case_words import earlier_load
from fem_seal.output.pictures.style import (
    BLUE,
    ORANGE,
    Picture,
    label,
    logarithmic,
    number_dots,
    panels,
    spans_decades,
    svg,
)
from fem_seal.output.prose import said
from fem_seal.seal.load_names import load_axis
from fem_seal.units import unit_for

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.seal.load_result import LoadResult

# How far below the smallest leak rate a band goes that reaches down to a sealed contact.
_FOOT = 0.1


def memory_picture(result: SealSolution) -> Picture | None:
    """Leak rate of every load on first loading and after the loads before it; None where nothing is remembered.

    Parameters
    ----------
    result : SealSolution
    """
    if result.surface is None or result.surface.hardness is None:
        return None
    loads = [load for load in result.loads if load.leak is not None]
    if not loads or not (result.earlier or any(load.remembers for load in loads)):
        return None
    if result.unloaded is None:
        loads.sort(key=lambda load: load.point)
    over = load_axis(loads)
    earlier = earlier_load(result.case.load) or "the loads before it"
    first, after = _ends([load.first_loading for load in loads]), _ends(loads)
    unit = volume_of(result.case).named(unit_for("flow", float(max(first.max(), after.max()))))
    figure, (axes,) = panels(1, height=3.6, width=6.8)
    for name, ends, colour in (("first loading", first, ORANGE), (f"after {earlier}", after, BLUE)):
        _band(axes, over.shown, ends / unit.size, colour, name)
    everything = np.concatenate([first, after])
    scales = ["x"] if over.values.min() > 0 and spans_decades(over.values) else []
    scales += ["y"] if spans_decades(everything, 0.7) else []
    if "y" not in scales:
        axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1])
    logarithmic(axes, *scales)
    if over.returns:
        numbers = [result.loads.index(load) + 1 for load in loads]
        number_dots(axes, over.shown, after[:, 1] / unit.size, numbers)
    axes.legend(loc="best")
    label(axes, "Leak rate on first loading and after a larger load", over.label, f"leak rate  [{unit.name}]")
    words = ("rates_both", "back_both") if any(load.yields for load in loads) else ("rates", "back")
    return Picture(
        "memory",
        svg(figure),
        said("captions.memory", "alt", over=over.name, earlier=earlier),
        said("captions.memory", *words, "bodies" if result.unloaded else "elastic", earlier=earlier),
    )


def _ends(loads: Sequence[LoadResult]) -> FloatArray:
    """Smaller and larger leak rate of the readings of yielding asperities, shape (loads, 2) [m^3/s]."""
    return np.array([load.leak_range or (load.leak.leak_rate,) * 2 for load in loads if load.leak])


def _band(axes: Axes, x: FloatArray, ends: FloatArray, colour: str, name: str) -> None:
    """The interval of the readings at each load; down to the foot where one of them is sealed."""
    leaks = ends[ends > 0]
    foot = _FOOT * float(leaks.min()) if leaks.size else 0.0
    low, high = np.where(ends > 0, ends, foot).T
    axes.fill_between(x, low, high, color=colour, alpha=0.18, linewidth=0, label=name)
    axes.vlines(x, low, high, color=colour, linewidth=1.0, alpha=0.6)
    for values in ends.T:
        axes.plot(x, np.where(values > 0, values, np.nan), "o-", color=colour, linewidth=1.3, ms=3.4)
