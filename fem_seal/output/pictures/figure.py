"""The figure of a result for Python and notebooks: leak rate over the loads, and the pressure profiles."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.pictures.contact import all_profiles
from fem_seal.output.pictures.leak import leak_rates, leaking_loads
from fem_seal.output.pictures.style import (
    BLUE,
    ORANGE,
    label,
    logarithmic,
    panels,
    positive,
    spans_decades,
    style,
)
from fem_seal.seal.load_names import different, load_axis
from fem_seal.units import percent, unit_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Two panels side by side and one alone, and titles above their axes [inch].
_SIZE, _NARROW, _ABOVE = (9.6, 3.6), (5.6, 3.6), 0.09


class ShownFigure(Figure):
    """A figure that a notebook shows once, as the value of its cell, also where pyplot was never imported."""

    def _repr_svg_(self) -> str:
        out = BytesIO()
        self.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
        return out.getvalue().decode()


def result_figure(result: SealSolution, figure: Figure | None = None) -> Figure:
    """Draw leak rate and pressure profiles; of a case without leak rate the profiles alone.

    Parameters
    ----------
    result : SealSolution
    figure : Figure, optional
        To draw into; a new one unless given.
    """
    leaks = any(load.leak and np.isfinite(load.leak.leak_rate) for load in result.loads)
    with style():
        if figure is None:
            width, height = _SIZE if leaks else _NARROW
            figure, axes = panels(1 + leaks, height=height, width=width, kind=ShownFigure)
        else:
            # the room for labels that `panels` leaves in inches, as shares of a figure of any size
            axes = list(
                figure.subplots(1, 1 + leaks, squeeze=False, gridspec_kw={"bottom": 0.15, "wspace": 0.3})[0]
            )
        for one in axes:
            one.grid(True)
        if leaks:
            _draw_leak_rates(axes[0], result)
        loads = result.loads
        length = unit_for("length", max(float(np.ptp(one.x)) for load in loads for one in load.profiles) / 4)
        all_profiles(axes[-1], loads, different(loads), length)
        axes[-1].set_title("Contact pressure", y=1.0, pad=72 * _ABOVE)
    return figure


def _draw_leak_rates(axes: Axes, result: SealSolution) -> None:
    """Leak rate over the loads with its interval; loads at which nothing leaks are named in the title."""
    loads, ends = leaking_loads(result)
    over, rates = load_axis(loads), leak_rates(loads)
    low, high = ends.T
    shown = np.concatenate([rates, low, high])
    unit = volume_of(result.case).named(unit_for("flow", float(np.nanmax(shown))))
    shown_rates = positive(rates) / unit.size
    name = "leak rate, C_pl" if any(load.yields for load in result.loads) else "leak rate"
    axes.plot(over.shown, shown_rates, "o-", color=BLUE, ms=4, label=name)
    outside = np.array([load.validity.outside for load in loads])
    if outside.any():
        axes.plot(
            over.shown[outside],
            shown_rates[outside],
            "x",
            color=ORANGE,
            ms=9,
            mew=1.8,
            label="outside the theory",
        )
    if np.isfinite(low).any():
        sampled = result.uncertainty
        name = "interval" if sampled is None else f"{percent(sampled.confidence)} interval"
        if len(loads) > 1:
            axes.fill_between(
                over.shown, low / unit.size, high / unit.size, color=BLUE, alpha=0.18, linewidth=0, label=name
            )
        else:
            reach = np.array([[rates[0] - low[0]], [high[0] - rates[0]]]) / unit.size
            axes.errorbar(
                over.shown, shown_rates, yerr=reach, color=BLUE, capsize=5, linestyle="none", label=name
            )
    required = result.case.requirement
    if required is not None and required.leak_rate is not None:
        shown = np.append(shown, required.leak_rate)
        axes.axhline(required.leak_rate / unit.size, color=ORANGE, linestyle="--", label="allowed")
    if spans_decades(shown):
        logarithmic(axes, "y")
    else:
        axes.set_ylim(0.0, max(1.1 * float(np.nanmax(shown)) / unit.size, 1e-9))
    axes.legend(loc="best")
    sealed = int(np.count_nonzero((rates == 0) & ~outside))
    title = "Leak rate" if not sealed else f"Leak rate ({sealed} of {len(loads)} loads sealed)"
    label(axes, title, over.label, f"leak rate  [{unit.name}]", above=_ABOVE)
