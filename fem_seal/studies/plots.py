"""Interactive plots of a study's page, None where there is nothing to show, and the picture of a notebook."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Sequence
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.files import own_tables
from fem_seal.output.notebook import table_html
from fem_seal.output.pictures.style import style
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.studies.designs_table import (
    LEAK_RATE,
    PASSES,
    Designs,
    Sensitivity,
    other_leak_rates,
    pareto_front,
)
from fem_seal.studies.display import BLUE, FEW, GREY, LOOKS, RED, DesignDisplay, lift_zeros

if TYPE_CHECKING:
    import pandas as pd
    from plotly.graph_objects import Figure

# More points than these make a page slow and its plots a blot; a regular part of the designs is drawn then.
MOST_POINTS = 5000
_LINE = {"color": RED, "dash": "dash", "width": 1.5}


def thin_designs(table: pd.DataFrame, most: int = MOST_POINTS) -> pd.DataFrame:
    """The designs that are drawn: all, or a regular part of many."""
    return table.iloc[:: -(-len(table) // most) or 1]


def main_output(designs: Designs) -> str:
    """The leak rate, or what else stands first."""
    outputs = [name for name in designs.outputs if designs.successes[name].notna().any()]
    return LEAK_RATE if LEAK_RATE in outputs else (outputs or [""])[0]


def by_influence(display: DesignDisplay, names: Sequence[str]) -> list[str]:
    """Parameters with different values, the one first that explains most of the variance of the main output.

    That is the part of the variance between groups of designs with about the same value of the parameter.
    """
    import pandas as pd

    rows, output = display.designs.successes.index, main_output(display.designs)
    column = pd.Series(display.places(output, display.axis_values(rows, output)), index=rows, dtype=float)
    parts = {}
    for name in names:
        values = display.numbers(name)
        if values.nunique() > FEW:
            values = pd.qcut(values, FEW, labels=False, duplicates="drop")
        if values.nunique() > 1:
            parts[name] = column.groupby(values).transform("mean").var()
    return sorted(parts, key=lambda name: -np.nan_to_num(parts[name]))


def _figure(traces: Iterable[dict[str, Any]], look: str, **layout: Any) -> Figure:
    from plotly.graph_objects import Figure

    looks = own_tables(LOOKS)
    return Figure(list(traces), {**looks["layout"], **looks["layouts"].get(look, {}), **layout})


def _trace(display: DesignDisplay, look: str, **data: Any) -> dict[str, Any]:
    """A trace with its look and, in the legend, its name."""
    return {**own_tables(LOOKS)["traces"][look], "name": display.words.legend.get(look, ""), **data}


def _points(display: DesignDisplay, rows: pd.Index, x: str, y: str, names: Iterable[str]) -> dict[str, Any]:
    """Data of a trace with a point for each design, which shows columns when pointed at."""
    return {
        "x": display.axis_values(rows, x),
        "y": display.axis_values(rows, y),
        "text": display.hover(rows, list(names)),
    }


def _lines(display: DesignDisplay, x: str = "", y: str = "") -> list[dict[str, Any]]:
    """Lines at the limits of these columns across a plot of them."""
    lines = []
    for side, other, name in (("x", "y", x), ("y", "x", y)):
        for at in filter(math.isfinite, display.limits(name) if name else ()):
            ends = {f"{other}0": 0, f"{other}1": 1, f"{side}0": at, f"{side}1": at}
            label = {"text": display.words.limit(), "font": {"color": RED}, "textposition": "end"}
            lines.append({"type": "line", "line": _LINE, "label": label, f"{other}ref": "paper", **ends})
    return lines


def _groups(designs: Designs, rows: pd.Index) -> list[tuple[str, pd.Index, str]]:
    """Designs that count and those that do not: legend, designs, look; one group if all do."""
    if not designs.has_ineligible:
        return [("designs", rows, "counting")]
    fails = ~designs.eligible.loc[rows].to_numpy()
    good = "inside the theory" if designs.left_out else "meets the constraints"
    bad = designs.ineligibility.replace("violate", "violates").replace("are outside", "outside")
    groups = [(good, rows[~fails], "counting"), (bad, rows[fails], "not_counting")]
    return [group for group in groups if len(group[1])]


def response_plot(display: DesignDisplay) -> Figure | None:
    """The main output, or another one, over each parameter; designs that do not count hollow."""
    designs, y = display.designs, main_output(display.designs)
    names = by_influence(display, designs.parameters)[:FEW] if y else []
    if not names:
        return None
    outputs = [name for name in designs.outputs if designs.successes[name].notna().any()]
    groups = _groups(designs, thin_designs(designs.successes, MOST_POINTS // len(names)).index)
    # numbers as they are: what is drawn of a sealed design is a place, no leak rate
    details, wide = [*designs.parameters, *outputs[:FEW]], min(len(names), 3)
    ends = ["", *map(str, range(2, len(names) + 1))]

    def of_output(output: str) -> dict[str, Any]:
        axis, lines = display.axis(output), _lines(display, y=output)
        inner = axis | {"title": {"text": ""}, "matches": "y"}
        axes = {
            f"yaxis{end}": inner if n % wide else axis | inner | {"title": axis["title"]}
            for n, end in enumerate(ends)
        }
        shapes = [line | {"xref": f"x{end} domain", "yref": f"y{end}"} for end in ends for line in lines]
        return {**axes, "yaxis": axis, "shapes": shapes}

    traces = [
        _trace(display, look, **_points(display, group, name, y, details))
        | {"xaxis": f"x{end}", "yaxis": f"y{end}", "hoverinfo": "text"}
        | {"name": title, "legendgroup": title, "showlegend": not end}
        for name, end in zip(names, ends, strict=True)
        for title, group, look in groups
    ]
    buttons = [
        {
            "label": display.label(output),
            "method": "update",
            "args": [
                {"y": [display.axis_values(group, output) for _, group, _ in groups] * len(names)},
                of_output(output),
            ],
        }
        for output in outputs
    ]
    menu = own_tables(LOOKS)["menu"] | {"buttons": buttons, "active": outputs.index(y)}
    rows = -(-len(names) // wide)
    return _figure(
        traces,
        "responses",
        **{f"xaxis{end}": display.axis(name) for name, end in zip(names, ends, strict=True)},
        **of_output(y),
        grid={"rows": rows, "columns": wide, "pattern": "independent", "xgap": 0.15, "ygap": 0.3},
        height=150 + 270 * rows,
        showlegend=designs.has_ineligible,
        updatemenus=[menu] if len(outputs) > 1 else [],
    )


def plane(display: DesignDisplay) -> tuple[list[str], pd.Index]:
    """The two numeric parameters that matter most, and the designs that differ in nothing else.

    Of a grid those are the designs with all other parameters as in the best one, of other plans all designs.
    """
    designs, table = display.designs, display.designs.successes
    names = by_influence(display, designs.numeric_parameters)[:2] if main_output(designs) else []
    if len(names) == 2 and designs.kind == "grid":
        names.sort(key=designs.parameters.index)
        fixed = [name for name in designs.parameters if name not in names]
        table = table[(table[fixed] == table.loc[designs.order[0], fixed]).all(axis=1)]
    return names, table.index


def plane_plot(display: DesignDisplay) -> Figure | None:
    """The main output over the two parameters that matter most: contours of a grid, else points in colours."""
    designs, (names, rows) = display.designs, plane(display)
    if len(names) < 2:
        return None
    output, (x, y) = main_output(designs), names
    ticks, texts = display.ticks(output)
    bar = {"title": {"text": display.label(output), "side": "right"}, "ticktext": texts}
    bar["tickvals"] = display.places(output, ticks)
    layout = {"xaxis": display.axis(x), "yaxis": display.axis(y)}
    crosses = [
        _trace(display, "crosses", **_points(display, group, x, y, [*names, output]))
        for _, group, look in _groups(designs, rows)
        if look == "not_counting"
    ]
    grid = designs.successes.loc[rows].drop_duplicates(names)

    def matrix(values: Sequence[Any]) -> list[list[Any]]:
        cells = grid.assign(cell=values).pivot(index=y, columns=x, values="cell").astype(object)
        return cells.where(cells.notna(), None).to_numpy().tolist()

    def heights(which: pd.Index, name: str) -> list[Any]:
        return display.places(name, display.axis_values(which, name))

    if designs.kind != "grid" or min(grid[names].nunique()) < 2 or len(grid) > 200_000:
        rows = thin_designs(designs.successes.loc[rows]).index
        points = _trace(display, "points", **_points(display, rows, x, y, [*names, output]))
        low, high = display.limits(output)
        kept = [value is not None and low <= value <= high for value in display.values(rows, output)]
        line = {"width": 1.5, "color": [GREY if keeps else RED for keeps in kept]}
        points["marker"] = points["marker"] | {"color": heights(rows, output), "colorbar": bar, "line": line}
        return _figure([points, *crosses], "map", **layout)
    contour = _trace(
        display,
        "map",
        x=sorted(set(display.axis_values(grid.index, x))),
        y=sorted(set(display.axis_values(grid.index, y))),
        z=matrix(heights(grid.index, output)),
        customdata=matrix(display.texts(grid.index, output)),
        colorbar=bar,
    )
    # a usual surface within the limit says little where it is known how often all of them keep it
    judged = PASSES if PASSES in designs.successes else output
    limits = [
        {
            **contour,
            "z": matrix(heights(grid.index, judged)),
            "line": {**_LINE, "width": 3},
            "showscale": False,
        }
        | {"contours": {"start": at, "end": at, "size": 1.0, "coloring": "none"}}
        for at in display.places(judged, display.limits(judged))
        if math.isfinite(at)
    ]
    return _figure([contour, *limits, *crosses], "map", **layout)


def parallel_plot(display: DesignDisplay) -> Figure | None:
    """What varies side by side, one line per design; those beyond a limit grey."""
    designs = display.designs
    table = thin_designs(designs.successes)
    inputs = [name for name in designs.parameters if table[name].nunique() > 1]
    outputs = designs.informative_outputs
    rows = complete_rows(table, outputs)
    if len(rows) < 2 or len(inputs) + len(outputs) < 2:
        return None
    names = [*inputs, *outputs]
    dimensions = [_dimension(display, rows, name) for name in names]
    main = dimensions[names.index(main_output(designs)) if main_output(designs) in names else 0]
    if designs.has_ineligible:
        label = "counts" if designs.left_out else "meets the constraints"
        counts = designs.eligible.loc[rows].astype(int).tolist()
        dimensions.append(_words_axis(label, ["no", "yes"], counts) | {"constraintrange": [0.9, 1.1]})
    bar = {key: main[key] for key in ("tickvals", "ticktext")}
    line = {"color": main["values"], "colorbar": bar | {"title": {"text": main["label"], "side": "right"}}}
    look = own_tables(LOOKS)["traces"]["parallel"]
    lines = _trace(display, "parallel", dimensions=dimensions, line={**look["line"], **line})
    return _figure([lines], "parallel")


def complete_rows(table: pd.DataFrame, outputs: list[str]) -> pd.Index:
    """Designs that have a number in all of these columns."""
    return table.index[np.isfinite(table[outputs].to_numpy(dtype=float)).all(axis=1)]


def _words_axis(label: str, words: list[str], values: list[int]) -> dict[str, Any]:
    """An axis of parallel coordinates with a word at each whole number."""
    return {
        "label": label,
        "values": values,
        "range": [0, max(len(words) - 1, 1)],
        "tickvals": list(range(len(words))),
        "ticktext": words,
    }


def _dimension(display: DesignDisplay, rows: pd.Index, name: str) -> dict[str, Any]:
    """One axis of parallel coordinates: words, or numbers or their logarithms, with what is allowed as a range."""
    places = display.axis_values(rows, name)
    if isinstance(places[0], str):
        # the description of a study lists the first words of very many only
        words = list(dict.fromkeys([*display.levels(name), *places]))
        return _words_axis(display.label(name), words, [words.index(word) for word in places])
    values, (ticks, texts) = display.places(name, places), display.ticks(name)
    ends = display.places(name, display.limits(name))
    # where none keeps the limit the axis goes on to it
    first, last = min(*values, ends[1]), max(*values, ends[0])
    low, high = max(ends[0], first), min(ends[1], last)
    step = 1e-6 * (last - first)
    # the range moves to the next marks, what is beyond all of them is cut off, and equal texts fall together
    marks = [
        first,
        last,
        *([low - step, low] if low > first else []),
        *([high, high + step] if high < last else []),
    ]
    texts_at = {mark: "\u200b" * n for n, mark in enumerate(marks, start=1)}
    for place, text in zip(display.places(name, ticks), texts, strict=True):
        texts_at[next((mark for mark in marks if abs(mark - place) < 2.0 * step), place)] = text
    places = sorted(texts_at)
    return {
        "label": display.label(name),
        "values": values,
        "range": [first, last],
        "tickvals": places,
        "ticktext": [texts_at[place] for place in places],
        **({"constraintrange": [low, high]} if len(marks) > 2 else {}),
    }


def pareto_plot(display: DesignDisplay) -> Figure | None:
    """Two goals against each other, with the designs that no other surpasses."""
    goals = display.designs.goals
    if goals.shape[1] != 2 or goals.empty:
        return None
    names = list(goals.columns)
    on_front = pareto_front(goals.to_numpy())
    groups = {
        "others": thin_designs(goals[~on_front]).index,
        "front": goals[on_front].sort_values(names).index,
    }
    details = [*names, *display.designs.parameters]
    traces = [
        _trace(display, look, **_points(display, rows, names[0], names[1], details))
        for look, rows in groups.items()
    ]
    axes = {"xaxis": display.axis(names[0]), "yaxis": display.axis(names[1])}
    return _figure(traces, "pareto", shapes=_lines(display, *names), **axes)


def search_plot(display: DesignDisplay) -> Figure | None:
    """Each goal of the trials of an optimisation one above the other, with the best one so far."""
    from plotly.subplots import make_subplots

    designs = display.designs
    if designs.kind != "search" or designs.goals.empty:
        return None
    names = list(designs.goals.columns)
    figure = make_subplots(rows=len(names), cols=1, shared_xaxes=True, vertical_spacing=0.06)
    for place, name in enumerate(names, start=1):
        traces = [
            _trace(
                display,
                look,
                type="scatter",
                x=rows.tolist(),
                y=display.axis_values(rows, name),
                name=legend,
                legendgroup=legend,
                text=display.hover(rows, [*names, *designs.parameters]),
                hoverinfo="text",
            )
            for legend, rows, look in _groups(designs, thin_designs(designs.successes).index)
        ]
        best = designs.goals[name].reindex(designs.successes.index).cummin().ffill().dropna()
        so_far = display.convert(name, designs.sign(name) * best)
        so_far = (lift_zeros(so_far) if display.logarithmic(name) else so_far).tolist()
        traces.append(_trace(display, "best_so_far", x=best.index.tolist(), y=so_far))
        for trace in traces:
            figure.add_trace({**trace, "showlegend": place == 1}, row=place, col=1)
        figure.update_yaxes(display.axis(name), row=place, col=1)
        for line in _lines(display, y=name):
            figure.add_hline(line["y0"], line=line["line"], row=place, col=1)
    figure.update_xaxes({"title": {"text": "trial"}}, row=len(names), col=1)
    figure.update_layout({**own_tables(LOOKS)["layout"], "height": 160 + 300 * len(names)})
    return figure


def distribution_plot(display: DesignDisplay) -> Figure | None:
    """How often which leak rate occurs, and the share of the designs that leak less."""
    rows_done = display.designs.successes
    if LEAK_RATE not in rows_done or rows_done[LEAK_RATE].dropna().empty:
        return None
    leak_rate = np.sort(display.axis_values(rows_done[LEAK_RATE].dropna().index, LEAK_RATE))
    step = max(1, len(leak_rate) // 1000)

    def cumulative_shares(values: FloatArray) -> dict[str, Any]:
        numbers = np.unique(np.append(np.arange(0, len(values), step), len(values) - 1))
        return {"x": values[numbers].tolist(), "y": ((numbers + 1) / len(values)).tolist()}

    logarithmic = display.logarithmic(LEAK_RATE)
    bins = min(max(int(np.sqrt(len(leak_rate))), 5), 40)
    edges = np.histogram_bin_edges(np.log(leak_rate) if logarithmic else leak_rate, bins)
    edges = np.exp(edges) if logarithmic else edges
    # round-off at the ends must not lose a design
    edges[0], edges[-1] = min(edges[0], leak_rate[0]), max(edges[-1], leak_rate[-1])
    counts, _ = np.histogram(leak_rate, edges)
    bars = _trace(
        display,
        "share_between",
        x=(0.5 * (edges[1:] + edges[:-1])).tolist(),
        y=(counts / len(leak_rate)).tolist(),
        width=np.diff(edges).tolist(),
    )
    others = [
        # in the unit of the other curve
        _trace(
            display,
            "share_below_beside",
            **cumulative_shares(np.sort(display.convert(LEAK_RATE, rates))),
            name=display.words.share_below(SCENARIOS[name].title),
        )
        for name, rates in other_leak_rates(display.designs).items()
    ]
    curve = _trace(display, "share_below", **cumulative_shares(leak_rate))
    axis = display.axis(LEAK_RATE)
    share = display.words.share(display.designs.has_distribution).lower()
    y_axis = own_tables(LOOKS)["layouts"]["distribution"]["yaxis"] | {"title": {"text": share}}
    lines = _lines(display, x=LEAK_RATE)
    return _figure([bars, curve, *others], "distribution", xaxis=axis, yaxis=y_axis, shapes=lines)


def sensitivity_plot(display: DesignDisplay, indices: Sensitivity) -> Figure:
    """Bars of both indices of every parameter, the one that matters most above."""
    of, size, unit = scale(display, indices)
    places, axis = indices.order, display.words.sensitivity_axis(indices.method, of, unit)
    bar_names = display.words.sensitivity_columns(indices.method, "").split(" | ")

    def bars(look: str, name: str, values: FloatArray, errors: FloatArray) -> dict[str, Any]:
        ends = {
            "type": "data",
            "array": (errors[places] / size).tolist(),
            "visible": bool((errors > 0).any()),
        }
        titles = [display.title(indices.parameters[n]) for n in places]
        return _trace(display, look, y=titles, x=(values[places] / size).tolist(), name=name, error_x=ends)

    return _figure(
        [
            bars("first_index", bar_names[0], indices.first, indices.first_error),
            bars("second_index", bar_names[2], indices.total, indices.total_error),
        ],
        "sensitivity",
        height=170 + 55 * len(indices.parameters),
        xaxis={"title": {"text": axis}},
    )


def scale(display: DesignDisplay, indices: Sensitivity) -> tuple[str, float, str]:
    """What was analysed in words, the size of its unit, and the unit in brackets; indices and logarithms have none."""
    title = display.title(indices.output)
    if indices.logarithmic:
        return f"ln({title})", 1.0, ""
    if indices.method != "morris":
        return title, 1.0, ""
    unit = display.unit(indices.output)
    return title, unit.size, f" [{unit.name}]" if unit.name else ""


def preview(designs: Designs) -> str:
    """Table of the designs, in SI, and the first response over the first parameter.

    Parameters
    ----------
    designs : Designs
    """
    picture = _picture(designs) if designs.parameters and designs.outputs and len(designs.successes) else ""
    return f"<p><b>{escape(str(designs.about['title']))}</b></p>{table_html(designs.table)}{picture}"


def _picture(designs: Designs) -> str:
    from matplotlib.figure import Figure

    display = DesignDisplay(designs)
    x, y = designs.parameters[0], designs.outputs[0]
    rows = designs.successes.index
    counts = designs.eligible.loc[rows].to_numpy()
    with style():
        figure = Figure(figsize=(5.5, 3.5), layout="constrained")
        axes = figure.add_subplot()
        axes.grid(True)
        for which, colour in ((~counts, GREY), (counts, BLUE)):
            if which.any():
                axes.scatter(
                    display.axis_values(rows[which], x), display.axis_values(rows[which], y), s=14, c=colour
                )
        axes.set(xlabel=display.label(x), ylabel=display.label(y))
        for name, scale in ((x, axes.set_xscale), (y, axes.set_yscale)):
            if display.logarithmic(name):
                scale("log")
        image = BytesIO()
        figure.savefig(image, format="png", dpi=110)
    alt = f"{display.label(y)} over {display.label(x)}, one dot for each design"
    data = base64.b64encode(image.getvalue()).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" alt="{escape(alt)}" style="max-width: 100%">'
