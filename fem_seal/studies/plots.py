"""The interactive plots of a study's page, one function each; None where there is nothing to show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.studies.analysis import LEAK_RATE, Designs, pareto_front
from fem_seal.studies.display import Display
from fem_seal.studies.sensitivity import Sensitivity

if TYPE_CHECKING:
    import pandas as pd
    from plotly.graph_objects import Figure

# More points than these make a page slow and its plots a blot; a regular part of the designs is drawn then.
MOST_POINTS = 5000
_BLUE, _ORANGE, _GREY = "#0969da", "#bc4c00", "#8c959f"
_LAYOUT: dict[str, Any] = {
    "template": "plotly_white",
    "margin": {"l": 70, "r": 20, "t": 30, "b": 60},
    "height": 460,
}


def drawn(table: pd.DataFrame) -> pd.DataFrame:
    """The designs that are drawn: all, or a regular part of many."""
    step = -(-len(table) // MOST_POINTS)
    return table if step <= 1 else table.iloc[::step]


def response_plot(designs: Designs) -> Figure | None:
    """Any output over any parameter, chosen with menus."""
    from plotly.graph_objects import Figure, Scattergl

    table, display = drawn(designs.done), Display(designs)
    parameters = [one["name"] for one in designs.about["parameters"]]
    outputs = [name for name in designs.outputs if table[name].notna().any()]
    if table.empty or not outputs:
        return None
    first = _preferred(outputs)
    figure = Figure(
        Scattergl(
            x=display.values(table, parameters[0]),
            y=display.values(table, first),
            mode="markers",
            text=_labels(display, table, parameters),
            hoverinfo="text+y",
            marker={"size": 6, "color": _BLUE, "opacity": 0.7},
        )
    )
    across = [
        _choice(
            display.label(name),
            {"x": [display.values(table, name)]},
            {"xaxis.title.text": display.label(name), "xaxis.type": _axis(table[name])},
        )
        for name in parameters
    ]
    up = [
        _choice(
            display.label(name),
            {"y": [display.values(table, name)]},
            {"yaxis.title.text": display.label(name), "yaxis.type": _axis(table[name])},
        )
        for name in outputs
    ]
    figure.update_layout(
        **{**_LAYOUT, "margin": {**_LAYOUT["margin"], "t": 80}},
        xaxis={"title": {"text": display.label(parameters[0])}, "type": _axis(table[parameters[0]])},
        yaxis={"title": {"text": display.label(first)}, "type": _axis(table[first])},
        updatemenus=[
            {"buttons": up, "x": 0.0, "xanchor": "left", "y": 1.16, "active": outputs.index(first)},
            {"buttons": across, "x": 1.0, "xanchor": "right", "y": 1.16},
        ],
    )
    return figure


def map_plot(designs: Designs) -> Figure | None:
    """The main output over the two parameters of a complete grid of two numeric ones."""
    from plotly.graph_objects import Contour, Figure

    names, about = designs.numeric_parameters, designs.about
    if len(about["parameters"]) != 2 or len(names) != 2:
        return None
    if about["design"]["kind"] != "grid" or about["design"]["optimise"]:
        return None
    output, display = _preferred(designs.outputs), Display(designs)
    table = designs.done.drop_duplicates(names).pivot(index=names[1], columns=names[0], values=output)
    if min(table.shape) < 2 or table.size > 200_000 or not np.isfinite(table.to_numpy(dtype=float)).any():
        return None
    values = table.to_numpy(dtype=float) / display.unit(output).size
    logarithmic = _axis(values) == "log"
    shown = np.log10(values) if logarithmic else values
    bar: dict[str, Any] = {"title": {"text": display.label(output), "side": "right"}}
    if logarithmic:
        ticks = np.linspace(np.nanmin(shown), np.nanmax(shown), 7)
        bar |= {"tickvals": ticks.tolist(), "ticktext": [f"{10**tick:.3g}" for tick in ticks]}
    figure = Figure(
        Contour(
            x=(table.columns.to_numpy(dtype=float) / display.unit(names[0]).size).tolist(),
            y=(table.index.to_numpy(dtype=float) / display.unit(names[1]).size).tolist(),
            z=_nulls(shown),
            customdata=_nulls(values),
            hovertemplate="%{x:.4g}, %{y:.4g}: %{customdata:.4g}<extra></extra>",
            colorscale="Viridis",
            colorbar=bar,
        )
    )
    figure.update_layout(
        **_LAYOUT,
        xaxis={"title": {"text": display.label(names[0])}, "type": _axis(designs.done[names[0]])},
        yaxis={"title": {"text": display.label(names[1])}, "type": _axis(designs.done[names[1]])},
    )
    return figure


def parallel_plot(designs: Designs) -> Figure | None:
    """All numeric columns side by side, one line per design."""
    from plotly.graph_objects import Figure, Parcoords

    table = drawn(designs.done)
    columns = [*designs.numeric_parameters, *(name for name in designs.outputs if table[name].notna().any())]
    if len(table) < 2 or len(columns) < 2:
        return None
    table = table.dropna(subset=columns)
    if len(table) < 2:
        return None
    display = Display(designs)
    dimensions = [_dimension(display, table, name) for name in columns]
    colour = dimensions[columns.index(_preferred([name for name in designs.outputs if name in columns]))]
    figure = Figure(
        Parcoords(
            dimensions=dimensions,
            line={
                "color": colour["values"],
                "colorscale": "Viridis",
                "showscale": True,
                "colorbar": {
                    "title": {"text": colour["label"], "side": "right"},
                    "tickvals": colour["tickvals"],
                    "ticktext": colour["ticktext"],
                },
            },
            labelangle=-12,
            labelfont={"size": 13},
            # the ends stand at the axis as ticks
            rangefont={"size": 1, "color": "rgba(0,0,0,0)"},
        )
    )
    figure.update_layout(**{**_LAYOUT, "margin": {"l": 150, "r": 40, "t": 110, "b": 30}})
    return figure


def _dimension(display: Display, table: pd.DataFrame, name: str) -> dict[str, Any]:
    """One axis of parallel coordinates; of values that span a factor of ten the logarithm, with their ticks."""
    values = table[name].to_numpy(dtype=float) / display.unit(name).size
    if _axis(values) == "log":
        values = np.log10(values)
        ticks = np.linspace(values.min(), values.max(), 6)
        text = [f"{10**tick:.3g}" for tick in ticks]
    else:
        ticks = np.linspace(values.min(), values.max(), 6)
        text = [f"{tick:.3g}" for tick in ticks]
    return {
        "label": display.label(name),
        "values": values.tolist(),
        "tickvals": ticks.tolist(),
        "ticktext": text,
    }


def pareto_plot(designs: Designs) -> Figure | None:
    """Two goals against each other, with the designs that no other surpasses."""
    from plotly.graph_objects import Figure, Scatter, Scattergl

    if designs.goals.shape[1] != 2 or designs.goals.empty:
        return None
    names, display = list(designs.goals.columns), Display(designs)
    sizes = np.array([display.unit(name).size for name in names])
    # what is to be large was counted with a minus sign
    signs = [-1.0 if designs.about["goals"][name] != name else 1.0 for name in names]
    goals = designs.goals.to_numpy() * signs / sizes
    on_front = pareto_front(designs.goals.to_numpy())
    parameters = [one["name"] for one in designs.about["parameters"]]
    front = np.flatnonzero(on_front)
    front = front[np.argsort(goals[front, 0])]
    others = np.flatnonzero(~on_front)
    others = others[:: max(1, -(-len(others) // MOST_POINTS))]
    text = np.array(_labels(display, designs.feasible.loc[designs.goals.index], parameters))
    figure = Figure(
        [
            Scattergl(
                x=goals[others, 0].tolist(),
                y=goals[others, 1].tolist(),
                mode="markers",
                name="other designs",
                text=text[others].tolist(),
                hoverinfo="text",
                marker={"size": 6, "color": _GREY, "opacity": 0.8},
            ),
            Scatter(
                x=goals[front, 0].tolist(),
                y=goals[front, 1].tolist(),
                mode="lines+markers",
                name="Pareto front",
                text=text[front].tolist(),
                hoverinfo="text",
                line={"color": _ORANGE, "shape": "hv"},
                marker={"size": 8, "color": _ORANGE},
            ),
        ]
    )
    figure.update_layout(
        **_LAYOUT,
        xaxis={"title": {"text": display.label(names[0])}, "type": _axis(goals[:, 0])},
        yaxis={"title": {"text": display.label(names[1])}, "type": _axis(goals[:, 1])},
    )
    return figure


def distribution_plot(designs: Designs) -> Figure | None:
    """How often which leak rate occurs, and the share of the designs that leak less."""
    from plotly.graph_objects import Bar, Figure, Scatter

    if LEAK_RATE not in designs.done or designs.done[LEAK_RATE].dropna().empty:
        return None
    display = Display(designs)
    leak_rate = np.sort(designs.done[LEAK_RATE].dropna().to_numpy()) / display.unit(LEAK_RATE).size
    share = np.arange(1, len(leak_rate) + 1) / len(leak_rate)
    step = max(1, len(leak_rate) // 1000)
    picked = np.unique(np.append(np.arange(0, len(leak_rate), step), len(leak_rate) - 1))
    axis = _axis(leak_rate)
    bins = min(max(int(np.sqrt(len(leak_rate))), 5), 40)
    edges = np.histogram_bin_edges(np.log(leak_rate) if axis == "log" else leak_rate, bins)
    edges = np.exp(edges) if axis == "log" else edges
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
                marker={"color": _GREY, "opacity": 0.5},
            ),
            Scatter(
                x=leak_rate[picked].tolist(),
                y=share[picked].tolist(),
                mode="lines",
                name="share below",
                line={"color": _BLUE, "shape": "hv"},
            ),
        ]
    )
    figure.update_layout(
        **_LAYOUT,
        xaxis={"title": {"text": display.label(LEAK_RATE)}, "type": axis},
        yaxis={"title": {"text": "share of the designs"}, "range": [0, 1.02]},
    )
    return figure


def history_plot(designs: Designs) -> Figure | None:
    """The goal of every trial of an optimisation, and the best one so far."""
    from plotly.graph_objects import Figure, Scatter

    if not designs.about["design"]["optimise"] or designs.goals.shape[1] != 1 or designs.goals.empty:
        return None
    name, display = designs.goals.columns[0], Display(designs)
    sign = -1.0 if designs.about["goals"][name] != name else 1.0
    sign /= display.unit(name).size
    values = designs.goals[name].sort_index()
    best = np.minimum.accumulate(values.to_numpy())
    number = values.index.tolist()
    figure = Figure(
        [
            Scatter(
                x=number, y=(sign * values).tolist(), mode="markers", name="trial", marker={"color": _GREY}
            ),
            Scatter(
                x=number,
                y=(sign * best).tolist(),
                mode="lines",
                name="best so far",
                line={"color": _ORANGE, "shape": "hv"},
            ),
        ]
    )
    figure.update_layout(
        **_LAYOUT,
        xaxis={"title": {"text": "trial that meets the constraints"}},
        yaxis={"title": {"text": display.label(name)}, "type": _axis(sign * values)},
    )
    return figure


def sensitivity_plot(found: Sensitivity) -> Figure:
    """Bars of both indices of every parameter."""
    from plotly.graph_objects import Bar, Figure

    names = (
        ("first order", "total")
        if found.method == "sobol-sensitivity"
        else ("mean absolute effect", "its spread")
    )
    both = zip(
        names,
        (_BLUE, _ORANGE),
        (found.first, found.total),
        (found.first_error, found.total_error),
        strict=True,
    )
    figure = Figure(
        [
            Bar(
                x=list(found.parameters),
                y=values.tolist(),
                name=name,
                marker={"color": colour},
                error_y={"type": "data", "array": errors.tolist(), "visible": bool(np.any(errors > 0))},
            )
            for name, colour, values, errors in both
        ]
    )
    figure.update_layout(**_LAYOUT, barmode="group")
    return figure


def _choice(name: str, data: dict[str, Any], layout: dict[str, Any]) -> dict[str, Any]:
    return {"label": name, "method": "update", "args": [data, layout]}


def _preferred(outputs: list[str]) -> str:
    return LEAK_RATE if LEAK_RATE in outputs else outputs[0]


def _labels(display: Display, table: pd.DataFrame, parameters: list[str]) -> list[str]:
    columns = [
        [f"{display.label(name)} = {_short(value)}" for value in display.values(table, name)]
        for name in parameters
    ]
    return [
        "<br>".join((f"design {n}", *lines)) for n, *lines in zip(table.index.tolist(), *columns, strict=True)
    ]


def _short(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value).replace("<", "&lt;")


def _axis(values: Any) -> str:
    """Logarithmic where all values are positive and span a factor of ten; words have an axis of their own."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        return "category"
    finite = array[np.isfinite(array)]
    return "log" if finite.size and finite.min() > 0 and finite.max() > 10 * finite.min() else "linear"


def _nulls(values: Any) -> Any:
    """Lists with null in place of NaN, which JSON does not know."""
    array = np.asarray(values, dtype=object)
    array[~np.isfinite(np.asarray(values, dtype=float))] = None
    return array.tolist()
