"""Interactive plots of the designs over their parameters; None where there is nothing to show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem_seal.studies.designs_table import LEAK_RATE
from fem_seal.studies.page.display import (
    FEW,
    GREY,
    LAYOUT,
    VIOLATING,
    Display,
    by_verdict,
    drawn,
    short,
    spans_a_decade,
    verdict,
)

if TYPE_CHECKING:
    import pandas as pd
    from plotly.graph_objects import Figure

# Part of the colours that stands for designs that do not count.
_GREY_SHARE = 0.08


def response_plot(display: Display) -> Figure | None:
    """Any output over any parameter, chosen with menus; designs that do not count hollow."""
    from plotly.graph_objects import Figure, Scattergl

    designs = display.designs
    rows = drawn(designs.done).index
    outputs = [name for name in designs.outputs if designs.done[name].notna().any()]
    if not len(rows) or not outputs:
        return None
    across, up, groups = designs.parameters[0], _preferred(outputs), by_verdict(display, rows)
    figure = Figure(
        [
            Scattergl(
                x=display.values(group, across),
                y=display.values(group, up),
                mode="markers",
                name=name,
                text=display.hover(group, designs.parameters),
                hoverinfo="text+y",
                marker=marker,
            )
            for name, group, marker in groups
        ]
    )

    def menu(side: str, names: list[str], **place: Any) -> dict[str, Any]:
        buttons = [
            {
                "label": display.label(name),
                "method": "update",
                "args": [
                    {side: [display.values(group, name) for _, group, _ in groups]},
                    {f"{side}axis.{key}": value for key, value in display.axis(name).items()},
                ],
            }
            for name in names
        ]
        return {"buttons": buttons, "y": 1.2, **place}

    figure.update_layout(
        **{**LAYOUT, "margin": {**LAYOUT["margin"], "t": 90}},
        xaxis=display.axis(across),
        yaxis=display.axis(up),
        showlegend=designs.some_do_not_count,
        legend={"orientation": "h", "x": 0.5, "xanchor": "center", "y": 1.02, "yanchor": "bottom"},
        updatemenus=[
            menu("y", outputs, x=0.0, xanchor="left", active=outputs.index(up)),
            menu("x", designs.parameters, x=1.0, xanchor="right"),
        ],
    )
    return figure


def map_plot(display: Display) -> Figure | None:
    """The main output over the two parameters of a complete grid of two numeric ones."""
    from plotly.graph_objects import Contour, Figure, Scatter

    designs, names = display.designs, display.designs.numeric_parameters
    if designs.kind != "grid" or len(designs.parameters) != 2 or len(names) != 2:
        return None
    output = _preferred(designs.outputs)
    table = designs.done.drop_duplicates(names).pivot(index=names[1], columns=names[0], values=output)
    if min(table.shape) < 2 or table.size > 200_000 or not np.isfinite(table.to_numpy(dtype=float)).any():
        return None
    values = display.shown(output, table)
    logarithmic = spans_a_decade(values)
    shown = np.log10(values) if logarithmic else values
    bar: dict[str, Any] = {"title": {"text": display.label(output), "side": "right"}}
    steps: dict[str, float] = {}
    if logarithmic:
        ticks = np.linspace(np.nanmin(shown), np.nanmax(shown), 9)
        bar |= {"tickvals": ticks.tolist(), "ticktext": [short(10**tick, 3) for tick in ticks]}
        steps = {"start": float(ticks[1]), "end": float(ticks[-2]), "size": float(ticks[1] - ticks[0])}
    figure = Figure(
        Contour(
            x=display.shown(names[0], table.columns).tolist(),
            y=display.shown(names[1], table.index).tolist(),
            z=_nulls(shown),
            customdata=_nulls(values),
            hovertemplate="%{x:.4~g}, %{y:.4~g}: %{customdata:.4~g}<extra></extra>",
            colorscale="Viridis",
            colorbar=bar,
            contours=steps,
        )
    )
    for _, rows, marker in by_verdict(display, designs.done.index):
        if marker is not VIOLATING:
            continue
        figure.add_trace(
            Scatter(
                x=display.values(rows, names[0]),
                y=display.values(rows, names[1]),
                mode="markers",
                name=verdict(designs),
                text=display.hover(rows, [*names, output]),
                hoverinfo="text",
                marker={"size": 10, "color": "white", "symbol": "x", "line": {"width": 1, "color": "black"}},
                cliponaxis=False,
            )
        )
    figure.update_layout(**LAYOUT, xaxis=display.axis(names[0]), yaxis=display.axis(names[1]))
    return figure


def parallel_plot(display: Display) -> Figure | None:
    """What varies side by side, one line per design; designs that do not count grey."""
    from plotly.graph_objects import Figure, Parcoords

    designs = display.designs
    table = drawn(designs.done)
    inputs = [name for name in designs.parameters if table[name].nunique() > 1]
    outputs = designs.telling_outputs
    rows = complete(table, outputs)
    if len(rows) < 2 or len(inputs) + len(outputs) < 2:
        return None
    dimensions = [_dimension(display, rows, name) for name in [*inputs, *outputs]]
    coloured = dimensions[len(inputs) + outputs.index(_preferred(outputs))] if outputs else dimensions[0]
    meets = designs.counted.loc[rows].to_numpy()
    if designs.some_do_not_count:
        dimensions.append(
            {
                "label": "counts" if designs.left_out else "meets the constraints",
                "values": meets.astype(int).tolist(),
                "range": [0, 1],
                "tickvals": [0, 1],
                "ticktext": ["no", "yes"],
            }
        )
    figure = Figure(
        Parcoords(
            dimensions=dimensions,
            line=_colours(coloured, meets),
            labelangle=-15,
            labelfont={"size": 13},
            # the ends stand at the axis as ticks
            rangefont={"size": 1, "color": "rgba(0,0,0,0)"},
        )
    )
    figure.update_layout(**{**LAYOUT, "margin": {"l": 150, "r": 90, "t": 130, "b": 30}, "height": 500})
    return figure


def complete(table: pd.DataFrame, outputs: list[str]) -> pd.Index:
    """Designs that have a number in all of these columns."""
    return table.index[np.isfinite(table[outputs].to_numpy(dtype=float)).all(axis=1)]


def _dimension(display: Display, rows: pd.Index, name: str) -> dict[str, Any]:
    """One axis of parallel coordinates: words, or numbers or their logarithms with a few ticks."""
    shown = display.values(rows, name)
    if isinstance(shown[0], str):
        # the description of a study lists the first words of very many only
        words = list(dict.fromkeys([*display.levels(name), *shown]))
        return {
            "label": display.label(name),
            "values": [words.index(word) for word in shown],
            "range": [0, max(len(words) - 1, 1)],
            "tickvals": list(range(len(words))),
            "ticktext": words,
        }
    scaled = np.log10 if display.logarithmic(name) else np.asarray
    values = scaled(np.array(shown, dtype=float))
    ticks = np.linspace(values.min(), values.max(), 6)
    numbers = (10**ticks if display.logarithmic(name) else ticks).tolist()
    if name in display.designs.parameters and len(set(shown)) <= FEW:
        numbers = sorted(set(shown))
        ticks = scaled(np.array(numbers))
    return {
        "label": display.label(name),
        "values": values.tolist(),
        "tickvals": ticks.tolist(),
        "ticktext": [short(one, 3) for one in numbers],
    }


def _colours(dimension: dict[str, Any], meets: NDArray[np.bool_]) -> dict[str, Any]:
    """Colours of lines by one axis; grey, below its smallest value, for designs that do not count."""
    from plotly.colors import sequential

    values = np.array(dimension["values"], dtype=float)
    low, high = float(values.min()), float(values.max())
    ticks, text = list(dimension["tickvals"]), list(dimension["ticktext"])
    viridis, floor, scale = sequential.Viridis, low, []
    if not meets.all():
        floor = low - (high - low or 1.0) * _GREY_SHARE / (1 - _GREY_SHARE)
        values = np.where(meets, values, floor)
        scale = [[0.0, GREY], [_GREY_SHARE, GREY]]
        ticks, text = [0.5 * (floor + low), *ticks], ["does not count", *text]
    start = _GREY_SHARE if scale else 0.0
    scale += [
        [share, colour]
        for share, colour in zip(np.linspace(start, 1.0, len(viridis)).tolist(), viridis, strict=True)
    ]
    return {
        "color": values.tolist(),
        "cmin": floor,
        "cmax": high,
        "colorscale": scale,
        "showscale": True,
        "colorbar": {
            "title": {"text": dimension["label"], "side": "right"},
            "tickvals": ticks,
            "ticktext": text,
        },
    }


def _preferred(outputs: list[str]) -> str:
    return LEAK_RATE if LEAK_RATE in outputs else outputs[0]


def _nulls(values: Any) -> Any:
    """Lists with null in place of NaN, which JSON does not know."""
    array = np.asarray(values, dtype=object)
    array[~np.isfinite(np.asarray(values, dtype=float))] = None
    return array.tolist()
