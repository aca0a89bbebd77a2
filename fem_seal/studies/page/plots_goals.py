"""Interactive plots of the goals of a study: two against each other, and the course of a search for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fem_seal.studies.designs_table import pareto_front
from fem_seal.studies.page.display import GREY, LAYOUT, ORANGE, Display, by_verdict, drawn

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


def pareto_plot(display: Display) -> Figure | None:
    """Two goals against each other, with the designs that no other surpasses."""
    from plotly.graph_objects import Figure, Scatter, Scattergl

    goals = display.designs.goals
    if goals.shape[1] != 2 or goals.empty:
        return None
    names = list(goals.columns)
    on_front = pareto_front(goals.to_numpy())
    front = goals[on_front].sort_values(names).index
    others = drawn(goals[~on_front]).index

    def points(rows: Any, **look: Any) -> dict[str, Any]:
        return {
            "x": display.values(rows, names[0]),
            "y": display.values(rows, names[1]),
            "text": display.hover(rows, [*names, *display.designs.parameters]),
            "hoverinfo": "text",
            **look,
        }

    figure = Figure(
        [
            Scattergl(
                points(
                    others,
                    mode="markers",
                    name="other designs",
                    marker={"size": 6, "color": GREY, "opacity": 0.8},
                )
            ),
            Scatter(
                points(
                    front,
                    mode="lines+markers",
                    name="Pareto front",
                    line={"color": ORANGE, "shape": "hv"},
                    marker={"size": 8, "color": ORANGE},
                )
            ),
        ]
    )
    figure.update_layout(**LAYOUT, xaxis=display.axis(names[0]), yaxis=display.axis(names[1]))
    return figure


def search_plot(display: Display) -> Figure | None:
    """Each goal of the trials of an optimisation one above the other, with the best one so far."""
    from plotly.graph_objects import Scatter
    from plotly.subplots import make_subplots

    designs = display.designs
    if designs.kind != "search" or designs.goals.empty:
        return None
    names = list(designs.goals.columns)
    figure = make_subplots(rows=len(names), cols=1, shared_xaxes=True, vertical_spacing=0.06)
    for place, name in enumerate(names, start=1):
        axis, first = display.axis(name), place == 1
        for legend, rows, marker in by_verdict(display, drawn(designs.done).index):
            figure.add_trace(
                Scatter(
                    x=rows.tolist(),
                    y=display.values(rows, name),
                    mode="markers",
                    name=legend,
                    legendgroup=legend,
                    showlegend=first,
                    text=display.hover(rows, [*names, *designs.parameters]),
                    hoverinfo="text",
                    marker=marker,
                ),
                row=place,
                col=1,
            )
        best = designs.goals[name].reindex(designs.done.index).cummin().ffill().dropna()
        figure.add_trace(
            Scatter(
                x=best.index.tolist(),
                y=display.shown(name, designs.sign(name) * best).tolist(),
                mode="lines",
                name="best so far",
                legendgroup="best so far",
                showlegend=first,
                hoverinfo="skip",
                line={"color": ORANGE, "shape": "hv"},
            ),
            row=place,
            col=1,
        )
        figure.update_yaxes(axis, row=place, col=1)
    figure.update_xaxes({"title": {"text": "trial"}}, row=len(names), col=1)
    figure.update_layout(**{**LAYOUT, "height": 160 + 300 * len(names)})
    return figure
