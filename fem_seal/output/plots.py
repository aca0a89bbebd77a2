"""What a notebook or a script draws: the figure of a result, and single pictures by their names, in any axes."""

from __future__ import annotations

import math
from collections.abc import Callable
from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fem_seal.case.fields import show as written
from fem_seal.errors import InputError
from fem_seal.output.answers.sensitivities import load_of, shown_sensitivities, step_in_words
from fem_seal.output.pictures.around import draw_leak_around, draw_line_load
from fem_seal.output.pictures.colours import BLUE, INK, ORANGE
from fem_seal.output.pictures.contact import draw_gap, draw_profiles
from fem_seal.output.pictures.leak import draw_leak
from fem_seal.output.pictures.style import label, logarithmic, outside_text, panels, spans_decades, style
from fem_seal.output.pictures.surface import draw_spectrum
from fem_seal.output.pressure_map import draw_map, map_of

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution

# Size of two panels side by side and of one alone, and space for titles above their axes [inch].
_SIZE, _NARROW, _ABOVE = (9.6, 3.6), (5.6, 3.6), 0.09


class ShownFigure(Figure):
    """A figure that a notebook shows once, as the value of its cell, even if pyplot was never imported."""

    def _repr_svg_(self) -> str:
        out = BytesIO()
        self.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
        return out.getvalue().decode()


class ShownAxes(Axes):
    """Axes that a notebook shows with the `ShownFigure` that they are in."""

    def _repr_svg_(self) -> str | None:
        figure = self.get_figure(root=True)
        return figure._repr_svg_() if isinstance(figure, ShownFigure) else None


def result_figure(result: SealSolution, figure: Figure | None = None) -> Figure:
    """Draw leak rate and pressure profiles; without a leak rate only the profiles.

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
            # the space for labels of `panels`, in inches, as shares of a figure of any size
            axes = list(
                figure.subplots(1, 1 + leaks, squeeze=False, gridspec_kw={"bottom": 0.15, "wspace": 0.3})[0]
            )
        for panel in axes:
            panel.grid(True)
        if leaks:
            _draw_leak(axes[0], result)
        (_draw_map if map_of(result.loads[0]) else draw_profiles)(axes[-1], result)
    return figure


def plot(result: SealSolution, name: str | None, axes: Axes | None = None) -> Axes:
    """Draw one picture by its name.

    Parameters
    ----------
    result : SealSolution
    name : str
        One of `PLOTS`.
    axes : Axes, optional
        To draw into; of a new figure unless given.

    Raises
    ------
    InputError
        If there is no such picture, or the result has nothing for it.
    """
    draw = PLOTS.get(name or "")
    if draw is None:
        raise InputError.at("plot", f"there is no such picture; there are {', '.join(PLOTS)}", written(name))
    with style():
        if axes is None:
            _, (axes,) = panels(1, height=_NARROW[1], width=_NARROW[0], kind=ShownFigure, shown_as=ShownAxes)
            axes.grid(True)
        draw(axes, result)
    return axes


def _nothing(name: str, why: str) -> InputError:
    return InputError.at("plot", why, written(name))


def _draw_leak(axes: Axes, result: SealSolution) -> None:
    if not draw_leak(axes, result):
        why = "no leak rate was calculated; that takes [roughness] and [fluid] and a closed seal"
        raise _nothing("leak", why)


def _draw_around(axes: Axes, result: SealSolution) -> None:
    if not (draw_leak_around(axes, result) or draw_line_load(axes, result)):
        raise _nothing(
            "around", "the seal is round, all angles are alike; [form] in the case makes it out of round"
        )


def _draw_map(axes: Axes, result: SealSolution) -> None:
    if map_of(result.loads[0]) is None:
        raise _nothing("map", "the contact is not given as a map; that takes `fem_seal.leak_of_pressure_map`")
    axes.grid(False)
    draw_map(axes, result)


def _draw_surface(axes: Axes, result: SealSolution) -> None:
    if result.surface is None:
        raise _nothing("surface", "the case has no roughness; [roughness] gives it one")
    draw_spectrum(axes, result.surface, result.highest.peak_pressure, above=_ABOVE)


# Largest number of bars, and where steps end that close or open the seal, beyond the longest bar.
_BARS, _BEYOND = 8, 1.6


def _draw_sensitivities(axes: Axes, result: SealSolution) -> None:
    """A bar from the leak rate as it is to that after a step, pale where the readings of yielding asperities differ."""
    sensitivities = shown_sensitivities(result.sensitivities)[:_BARS]
    if not sensitivities:
        why = "nothing that was tried changes the leak rate by 3 % or more"
        raise _nothing(
            "sensitivities",
            why
            if result.sensitivities
            else "they were not calculated; fem_seal.run(case, sensitivities=True) does",
        )
    ratios = [1.0, *(end for step in sensitivities for end in step.ratio if 0.0 < end < math.inf)]
    low, high = min(ratios) / _BEYOND, max(ratios) * _BEYOND
    for n, sensitivity in enumerate(sensitivities):
        near, far = sorted(np.clip(sensitivity.ratio, low, high), key=lambda end: abs(math.log(end)))
        for end, alpha in ((far, 0.35), (near, 1.0)):
            axes.barh(n, end - 1.0, 0.4, left=1.0, color=BLUE if near < 1.0 else ORANGE, alpha=alpha)
        said = outside_text(step_in_words(result.case, sensitivity))
        axes.text(0.01, n - 0.26, said, transform=axes.get_yaxis_transform(), va="bottom", clip_on=True)
    axes.axvline(1.0, color=INK, linewidth=0.8, zorder=0.6)
    axes.set(yticks=[], xlim=(low, high), ylim=(len(sensitivities) - 0.6, -0.8))
    if spans_decades([low, high], 0.8):
        logarithmic(axes, "x")
    label(axes, f"Sensitivities at {load_of(result)}", "leak rate after over before", "", above=_ABOVE)


# What can be drawn, by the names that people give.
PLOTS: dict[str, Callable[[Axes, SealSolution], None]] = {
    "leak": _draw_leak,
    "contact": draw_profiles,
    "gap": draw_gap,
    "around": _draw_around,
    "surface": _draw_surface,
    "sensitivities": _draw_sensitivities,
    "map": _draw_map,
}
