"""The interactive plots of a study's page, one function each; None where there is nothing to show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.studies.analysis import LEAK_RATE, Designs, pareto_front
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

    table = drawn(designs.done)
    parameters = [one["name"] for one in designs.about["parameters"]]
    outputs = [name for name in designs.outputs if table[name].notna().any()]
    if table.empty or not outputs:
        return None
    first = _preferred(outputs)
    text = _labels(table, parameters)
    figure = Figure(
        Scattergl(
            x=table[parameters[0]],
            y=table[first],
            mode="markers",
            text=text,
            hoverinfo="text+y",
            marker={"size": 6, "color": _BLUE, "opacity": 0.7},
        )
    )
    across = [
        _choice(
            name,
            {"x": [table[name].tolist()]},
            {"xaxis.title.text": with_unit(designs, name), "xaxis.type": "-"},
        )
        for name in parameters
    ]
    up = [
        _choice(
            name, {"y": [_plain(table[name])]}, {"yaxis.title.text": name, "yaxis.type": _axis(table[name])}
        )
        for name in outputs
    ]
    figure.update_layout(
        **{**_LAYOUT, "margin": {**_LAYOUT["margin"], "t": 80}},
        xaxis={"title": {"text": with_unit(designs, parameters[0])}},
        yaxis={"title": {"text": first}, "type": _axis(table[first])},
        updatemenus=[
            {"buttons": up, "x": 0.0, "xanchor": "left", "y": 1.16, "active": outputs.index(first)},
            {"buttons": across, "x": 1.0, "xanchor": "right", "y": 1.16},
        ],
    )
    return figure


def map_plot(designs: Designs) -> Figure | None:
    """The main output over the two parameters of a complete grid of two numeric ones."""
    from plotly.graph_objects import Contour, Figure

    names = designs.numeric_parameters
    if len(designs.about["parameters"]) != 2 or len(names) != 2 or designs.about["design"]["kind"] != "grid":
        return None
    output = _preferred(designs.outputs)
    table = designs.done.drop_duplicates(names).pivot(index=names[1], columns=names[0], values=output)
    if min(table.shape) < 2 or table.size > 200_000:
        return None
    values = table.to_numpy(dtype=float)
    logarithmic = bool(np.nanmin(values) > 0 and np.nanmax(values) > 10 * np.nanmin(values))
    shown = np.log10(values) if logarithmic else values
    figure = Figure(
        Contour(
            x=table.columns.tolist(),
            y=table.index.tolist(),
            z=_nulls(shown),
            colorscale="Viridis",
            colorbar={"title": {"text": f"log10 {output}" if logarithmic else output, "side": "right"}},
        )
    )
    figure.update_layout(
        **_LAYOUT,
        xaxis={"title": {"text": with_unit(designs, names[0])}, "type": _axis(designs.done[names[0]])},
        yaxis={"title": {"text": with_unit(designs, names[1])}, "type": _axis(designs.done[names[1]])},
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
    dimensions = []
    for name in columns:
        logarithmic = _axis(table[name]) == "log"
        values = (
            np.log10(table[name].to_numpy(dtype=float)) if logarithmic else table[name].to_numpy(dtype=float)
        )
        dimensions.append({"label": f"log10 {name}" if logarithmic else name, "values": values.tolist()})
    colour = dimensions[columns.index(_preferred([name for name in designs.outputs if name in columns]))]
    figure = Figure(
        Parcoords(
            dimensions=dimensions,
            line={
                "color": colour["values"],
                "colorscale": "Viridis",
                "showscale": True,
                "colorbar": {"title": {"text": colour["label"], "side": "right"}},
            },
            labelangle=-12,
            labelside="bottom",
        )
    )
    figure.update_layout(**{**_LAYOUT, "margin": {"l": 80, "r": 40, "t": 30, "b": 110}})
    return figure


def pareto_plot(designs: Designs) -> Figure | None:
    """Two goals against each other, with the designs that no other surpasses."""
    from plotly.graph_objects import Figure, Scatter, Scattergl

    if designs.goals.shape[1] != 2 or designs.goals.empty:
        return None
    names = list(designs.goals.columns)
    # what is to be large was counted with a minus sign
    signs = [-1.0 if designs.about["goals"][name] != name else 1.0 for name in names]
    goals = designs.goals.to_numpy() * signs
    on_front = pareto_front(designs.goals.to_numpy())
    parameters = [one["name"] for one in designs.about["parameters"]]
    front = np.flatnonzero(on_front)
    front = front[np.argsort(goals[front, 0])]
    others = np.flatnonzero(~on_front)
    others = others[:: max(1, -(-len(others) // MOST_POINTS))]
    text = np.array(_labels(designs.feasible.loc[designs.goals.index], parameters))
    figure = Figure(
        [
            Scattergl(
                x=goals[others, 0].tolist(),
                y=goals[others, 1].tolist(),
                mode="markers",
                name="other designs",
                text=text[others].tolist(),
                hoverinfo="text",
                marker={"size": 5, "color": _GREY, "opacity": 0.5},
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
        xaxis={"title": {"text": names[0]}, "type": _axis(goals[:, 0])},
        yaxis={"title": {"text": names[1]}, "type": _axis(goals[:, 1])},
    )
    return figure


def distribution_plot(designs: Designs) -> Figure | None:
    """Share of the designs that leak less than a leak rate."""
    from plotly.graph_objects import Figure, Scatter

    if LEAK_RATE not in designs.done or designs.done[LEAK_RATE].dropna().empty:
        return None
    leak_rate = np.sort(designs.done[LEAK_RATE].dropna().to_numpy())
    share = np.arange(1, len(leak_rate) + 1) / len(leak_rate)
    step = max(1, len(leak_rate) // 1000)
    picked = np.unique(np.append(np.arange(0, len(leak_rate), step), len(leak_rate) - 1))
    figure = Figure(
        Scatter(
            x=leak_rate[picked].tolist(),
            y=share[picked].tolist(),
            mode="lines",
            line={"color": _BLUE, "shape": "hv"},
        )
    )
    figure.update_layout(
        **_LAYOUT,
        xaxis={"title": {"text": "leak rate [m³/s]"}, "type": _axis(leak_rate)},
        yaxis={"title": {"text": "share of the designs below"}, "range": [0, 1.02]},
    )
    return figure


def history_plot(designs: Designs) -> Figure | None:
    """The goal of every trial of an optimisation, and the best one so far."""
    from plotly.graph_objects import Figure, Scatter

    if not designs.about["design"]["optimise"] or designs.goals.shape[1] != 1 or designs.goals.empty:
        return None
    name = designs.goals.columns[0]
    sign = -1.0 if designs.about["goals"][name] != name else 1.0
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
        **_LAYOUT, xaxis={"title": {"text": "trial"}}, yaxis={"title": {"text": name}, "type": _axis(values)}
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


def with_unit(designs: Designs, name: str) -> str:
    """Column with the unit of a parameter; responses have theirs in their names."""
    unit = next((one["unit"] for one in designs.about["parameters"] if one["name"] == name), "")
    return f"{name} [{unit}]" if unit else name


def _labels(table: pd.DataFrame, parameters: list[str]) -> list[str]:
    columns = [[f"{name} = {_short(value)}" for value in table[name].tolist()] for name in parameters]
    return [
        "<br>".join((f"design {n}", *lines)) for n, *lines in zip(table.index.tolist(), *columns, strict=True)
    ]


def _short(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value).replace("<", "&lt;")


def _axis(values: Any) -> str:
    """Logarithmic where all values are positive and span a factor of ten."""
    finite = np.asarray(values, dtype=float)
    finite = finite[np.isfinite(finite)]
    return "log" if finite.size and finite.min() > 0 and finite.max() > 10 * finite.min() else "linear"


def _plain(column: pd.Series) -> list[float | None]:
    return _nulls(column.to_numpy(dtype=float))


def _nulls(values: Any) -> Any:
    """Lists with null in place of NaN, which JSON does not know."""
    array = np.asarray(values, dtype=object)
    array[~np.isfinite(np.asarray(values, dtype=float))] = None
    return array.tolist()
