"""Interactive plots of what all designs together say: how the leak rate is distributed, which parameters matter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.seal.readings import WORDS
from fem_seal.studies.designs_table import LEAK_RATE, Sensitivity, other_leak_rates
from fem_seal.studies.page.display import BLUE, GREY, LAYOUT, ORANGE, Display

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


def distribution_plot(display: Display) -> Figure | None:
    """How often which leak rate occurs, and the share of the designs that leak less."""
    from plotly.graph_objects import Bar, Figure, Scatter

    done = display.designs.done
    if LEAK_RATE not in done or done[LEAK_RATE].dropna().empty:
        return None
    leak_rate = np.sort(display.shown(LEAK_RATE, done[LEAK_RATE].dropna()))
    step = max(1, len(leak_rate) // 1000)

    def below(values: FloatArray, name: str = "share below", **line: str) -> Scatter:
        picked = np.unique(np.append(np.arange(0, len(values), step), len(values) - 1))
        return Scatter(
            x=values[picked].tolist(),
            y=((picked + 1) / len(values)).tolist(),
            mode="lines",
            name=name,
            line={"color": BLUE, "shape": "hv", **line},
        )

    logarithmic = display.logarithmic(LEAK_RATE)
    bins = min(max(int(np.sqrt(len(leak_rate))), 5), 40)
    edges = np.histogram_bin_edges(np.log(leak_rate) if logarithmic else leak_rate, bins)
    edges = np.exp(edges) if logarithmic else edges
    # round-off at the ends must not lose a design
    edges[0], edges[-1] = min(edges[0], leak_rate[0]), max(edges[-1], leak_rate[-1])
    counts, _ = np.histogram(leak_rate, edges)
    figure = Figure(
        [
            Bar(
                x=(0.5 * (edges[1:] + edges[:-1])).tolist(),
                y=(counts / len(leak_rate)).tolist(),
                width=np.diff(edges).tolist(),
                name="share between two leak rates",
                marker={"color": GREY, "opacity": 0.5},
            ),
            below(leak_rate),
        ]
    )
    for reading, rates in other_leak_rates(display.designs).items():
        # in the unit of the other curve
        values = np.sort(display.shown(LEAK_RATE, rates))
        figure.add_trace(below(values, f"share below, surface {WORDS[reading].title}", dash="dash"))
    figure.update_layout(
        **{**LAYOUT, "margin": {**LAYOUT["margin"], "t": 90}},
        xaxis=display.axis(LEAK_RATE),
        yaxis={"title": {"text": "share of the designs"}, "range": [0, 1.02]},
        # above the plot, where it takes no room from it on a phone
        legend={"orientation": "h", "x": 0.0, "y": 1.02, "yanchor": "bottom"},
    )
    return figure


def sensitivity_plot(display: Display, found: Sensitivity) -> Figure:
    """Bars of both indices of every parameter, the one that matters most above."""
    from plotly.graph_objects import Bar, Figure

    of, size, unit = scale(display, found)
    if found.method == "morris":
        names, title = ("mean absolute effect", "its spread"), f"effect on {of}{unit}"
    else:
        names, title = ("first order", "total"), f"share of the variance of {of}"
    both = zip(
        names,
        (BLUE, ORANGE),
        (found.first, found.total),
        (found.first_error, found.total_error),
        strict=True,
    )
    figure = Figure(
        [
            Bar(
                y=[display.title(found.parameters[n]) for n in order(found)],
                x=(values[order(found)] / size).tolist(),
                orientation="h",
                name=name,
                marker={"color": colour},
                error_x={
                    "type": "data",
                    "array": (errors[order(found)] / size).tolist(),
                    "visible": bool(np.any(errors > 0)),
                },
            )
            for name, colour, values, errors in both
        ]
    )
    figure.update_layout(
        **{**LAYOUT, "height": 170 + 55 * len(found.parameters)},
        barmode="group",
        xaxis={"title": {"text": title}},
        yaxis={"automargin": True, "autorange": "reversed"},
    )
    return figure


def order(found: Sensitivity) -> list[int]:
    """Places of the parameters, the one that matters most first."""
    matters = found.first if found.method == "morris" else found.total
    return [int(n) for n in np.argsort(-matters, kind="stable")]


def scale(display: Display, found: Sensitivity) -> tuple[str, float, str]:
    """What was analysed in words, the size of its unit, and the unit in brackets; indices and logarithms have none."""
    title = display.title(found.output)
    if found.logarithmic:
        return f"ln({title})", 1.0, ""
    if found.method != "morris":
        return title, 1.0, ""
    unit = display.unit(found.output)
    return title, unit.size, f" [{unit.name}]" if unit.name else ""
