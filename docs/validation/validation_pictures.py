"""Pictures of the validation page: predicted over measured, and a leak rate over the pressure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from validation_page import INSIDE, ML_PER_MIN, NAMES, NOT_DECIDABLE, Curve, Ends, Row

_COLOURS = {"corrected": "tab:blue", "paper": "tab:green", "turned": "tab:orange"}
# Decades that are shown.
_LEAST, _MOST = -3.0, 6.7
# On the axis of a leak rate [ml/min].
_RATES = (1, 2, 5, 10, 20, 50, 100)


def draw_verdicts(rows: Sequence[Row], path: Path) -> None:
    """Bars of predicted over measured, in decades.

    Parameters
    ----------
    rows : sequence of Row
        Those that cannot be decided are left out.
    path : Path
        SVG.
    """
    rows = [row for row in rows if row.word != NOT_DECIDABLE]
    figure = Figure(figsize=(9.6, 0.36 * len(rows) + 1.2), layout="constrained")
    axes = figure.subplots()
    labels = []
    for at, row in enumerate(rows):
        low, high, least, most = (
            *_ends(row.observed.low, row.observed.high),
            *_ends(row.prediction.low, row.prediction.high),
        )
        # of a one-sided measurement the upper end is the reference
        middle = 0.5 * (low + high) if low > -math.inf else high
        axes.barh(at, high - max(low, middle + _LEAST), left=max(low, middle + _LEAST) - middle, color="0.85")
        start = max(least - middle, _LEAST)
        colour = _COLOURS[row.theory]
        axes.barh(at, max(most - middle - start, 0.03), left=start, height=0.4, color=colour)
        if least - middle < _LEAST:
            axes.plot(_LEAST, at, marker="<", color=colour, clip_on=False)
        labels.append(f"{row.experiment.title}\n{row.observed.what}, {NAMES[row.theory]}")
        axes.text(
            _MOST,
            at,
            row.word,
            ha="right",
            va="center",
            fontsize=7,
            color="0.3" if row.word == INSIDE else "red",
        )
    axes.set_yticks(range(len(rows)), labels, fontsize=6)
    axes.set_xlim(_LEAST, _MOST)
    axes.axvline(0.0, color="0.4", linewidth=0.8)
    axes.set_xlabel("predicted over measured [decades]")
    names = {NAMES[row.theory]: _COLOURS[row.theory] for row in rows}
    handles = [Patch(color=colour, label=name) for name, colour in names.items()]
    axes.legend(
        handles=[Patch(color="0.85", label="measured"), *handles], fontsize=7, loc="upper center", ncols=4
    )
    axes.set_ylim(len(rows) - 0.4, -1.6)
    _save(figure, path)


def draw_curve(curve: Curve, lines: Sequence[Sequence[Ends]], path: Path) -> None:
    """The leak rate over the fluid pressure, a band for each line.

    Parameters
    ----------
    curve : Curve
    lines : sequence
        Least and largest leak rate at each pressure [m^3/s], of each line.
    path : Path
        SVG.
    """
    figure = Figure(figsize=(7.2, 4.4), layout="constrained")
    axes = figure.subplots()
    pressures = [float(text.removesuffix(" bar")) for text in curve.fluid_pressure]
    for line, ends in zip(curve.lines, lines, strict=True):
        low, high = ([ML_PER_MIN * both[end] for both in ends] for end in (0, 1))
        axes.fill_between(pressures, low, high, alpha=0.4, label=line.name)
        axes.plot(pressures, [math.sqrt(a * b) for a, b in zip(low, high, strict=True)])
    axes.set(xscale="log", yscale="log", xlabel="fluid pressure [bar]", ylabel="leak rate [ml/min]")
    axes.set_xticks(pressures, [f"{one:g}" for one in pressures])
    axes.set_yticks(_RATES, [f"{one:g}" for one in _RATES])
    axes.legend(fontsize=8)
    _save(figure, path)


def _ends(low: float | None, high: float | None) -> tuple[float, float]:
    assert low is not None and high is not None  # of what is decided
    return (math.log10(low) if low > 0.0 else -math.inf), math.log10(high)


def _save(figure: Figure, path: Path) -> None:
    with matplotlib.rc_context({"svg.hashsalt": path.stem, "svg.fonttype": "none"}):
        figure.savefig(path, metadata={"Date": None, "Creator": None})
