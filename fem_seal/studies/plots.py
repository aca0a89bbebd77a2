"""Interactive plots of a study's page, None where there is nothing to show, and the picture of a notebook."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fem_seal.arrays import BoolArray, FloatArray
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
from fem_seal.studies.display import (
    BLUE,
    FEW,
    GREY,
    LOOKS,
    RED,
    Display,
    lift_zeros,
    short_number,
    spans_a_decade,
)

if TYPE_CHECKING:
    import pandas as pd
    from plotly.graph_objects import Figure

# More points than these make a page slow and its plots a blot; a regular part of the designs is drawn then.
MOST_POINTS = 5000
_LINE = {"color": RED, "dash": "dash", "width": 1.5}
# Part of the colours that stands for designs that do not count.
_GREY_SHARE = 0.08


def thin_designs(table: pd.DataFrame) -> pd.DataFrame:
    """The designs that are drawn: all, or a regular part of many."""
    step = -(-len(table) // MOST_POINTS)
    return table if step <= 1 else table.iloc[::step]


def _figure(traces: Iterable[dict[str, Any]], look: str, **layout: Any) -> Figure:
    from plotly.graph_objects import Figure

    looks = own_tables(LOOKS)
    return Figure(list(traces), {**looks["layout"], **looks["layouts"][look], **layout})


def _trace(look: str, **data: Any) -> dict[str, Any]:
    return {**own_tables(LOOKS)["traces"][look], **data}


def _points(display: Display, rows: pd.Index, x: str, y: str, names: Iterable[str]) -> dict[str, Any]:
    """Data of a trace with a point for each design, which shows columns when pointed at."""
    return {
        "x": display.axis_values(rows, x),
        "y": display.axis_values(rows, y),
        "text": display.hover(rows, list(names)),
    }


def _lines(display: Display, x: str = "", y: str = "") -> list[dict[str, Any]]:
    """Lines at what may leak, and at how often the requirement is to be kept, across a plot of these columns."""
    lines = []
    for side, other, name in (("x", "y", x), ("y", "x", y)):
        of_leak = name.startswith("leak_rate") and name.endswith("_m3_per_s")
        limit = (
            display.designs.limit if of_leak else display.designs.asked_confidence if name == PASSES else None
        )
        if limit is not None:
            at = float(display.convert(name, limit))
            ends = {f"{other}0": 0, f"{other}1": 1, f"{side}0": at, f"{side}1": at}
            lines.append({"type": "line", "line": _LINE, f"{other}ref": "paper", **ends})
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


def response_plot(display: Display) -> Figure | None:
    """Any output over any parameter, chosen with menus; designs that do not count hollow."""
    designs = display.designs
    rows = thin_designs(designs.successes).index
    outputs = [name for name in designs.outputs if designs.successes[name].notna().any()]
    if not len(rows) or not outputs:
        return None
    x, y, groups = designs.parameters[0], _main_output(outputs), _groups(designs, rows)
    # numbers as they are: what is drawn of a sealed design is a place, no leak rate
    details = [*designs.parameters, *outputs[:FEW]]

    def menu(side: str, names: list[str], **place: Any) -> dict[str, Any]:
        buttons = [
            {
                "label": display.label(name),
                "method": "update",
                "args": [
                    {side: [display.axis_values(group, name) for _, group, _ in groups]},
                    {f"{side}axis.{key}": value for key, value in display.axis(name).items()}
                    | ({"shapes": _lines(display, y=name)} if side == "y" else {}),
                ],
            }
            for name in names
        ]
        return {"buttons": buttons, "y": 1.2, **place}

    traces = [
        _trace(look, **_points(display, group, x, y, details), name=name) for name, group, look in groups
    ]
    return _figure(
        [{**trace, "type": "scattergl", "hoverinfo": "text"} for trace in traces],
        "responses",
        xaxis=display.axis(x),
        yaxis=display.axis(y),
        showlegend=designs.has_ineligible,
        shapes=_lines(display, y=y),
        updatemenus=[
            menu("y", outputs, x=0.0, xanchor="left", active=outputs.index(y)),
            menu("x", designs.parameters, x=1.0, xanchor="right"),
        ],
    )


def map_plot(display: Display) -> Figure | None:
    """The main output over the two parameters of a complete grid of two numeric ones."""
    designs, names = display.designs, display.designs.numeric_parameters
    if designs.kind != "grid" or len(designs.parameters) != 2 or len(names) != 2:
        return None
    output = _main_output(designs.outputs)
    grid = designs.successes.drop_duplicates(names)
    table = grid.pivot(index=names[1], columns=names[0], values=output)
    if min(table.shape) < 2 or table.size > 200_000 or not np.isfinite(table.to_numpy(dtype=float)).any():
        return None
    values = display.convert(output, table)
    logarithmic = spans_a_decade(values)
    z = np.log10(lift_zeros(values)) if logarithmic else values
    bar: dict[str, Any] = {"title": {"text": display.label(output), "side": "right"}}
    steps: dict[str, float] = {}
    if logarithmic:
        ticks = np.linspace(np.nanmin(z), np.nanmax(z), 9)
        bar |= {"tickvals": ticks.tolist(), "ticktext": _ticks(10**ticks, values)}
        steps = {"start": float(ticks[1]), "end": float(ticks[-2]), "size": float(ticks[1] - ticks[0])}
    contour = _trace(
        "map",
        x=display.convert(names[0], table.columns).tolist(),
        y=display.convert(names[1], table.index).tolist(),
        z=_replace_nan(z),
        customdata=_replace_nan(values),
        colorbar=bar,
        contours=steps,
    )
    # a usual surface within the limit says little where it is known how often all of them keep it
    chances = PASSES in designs.successes
    of_line = grid.pivot(index=names[1], columns=names[0], values=PASSES).to_numpy() if chances else z
    levels = [line["y0"] for line in _lines(display, y=output)]
    levels = [designs.confidence] if chances else [math.log10(y) if logarithmic else y for y in levels]
    limits = [
        {
            **contour,
            "z": _replace_nan(of_line),
            "contours": {"start": at, "end": at, "size": 1.0, "coloring": "none"},
            "line": _LINE,
            "showscale": False,
            "showlegend": False,
        }
        for at in levels
    ]
    crosses = [
        _trace("crosses", **_points(display, rows, names[0], names[1], [*names, output]), name=name)
        for name, rows, look in _groups(designs, designs.successes.index)
        if look == "not_counting"
    ]
    return _figure(
        [contour, *limits, *crosses], "map", xaxis=display.axis(names[0]), yaxis=display.axis(names[1])
    )


def parallel_plot(display: Display) -> Figure | None:
    """What varies side by side, one line per design; designs that do not count grey."""
    designs = display.designs
    table = thin_designs(designs.successes)
    inputs = [name for name in designs.parameters if table[name].nunique() > 1]
    outputs = designs.informative_outputs
    rows = complete_rows(table, outputs)
    if len(rows) < 2 or len(inputs) + len(outputs) < 2:
        return None
    dimensions = [_dimension(display, rows, name) for name in [*inputs, *outputs]]
    main = dimensions[len(inputs) + outputs.index(_main_output(outputs))] if outputs else dimensions[0]
    meets = designs.eligible.loc[rows].to_numpy()
    if designs.has_ineligible:
        label = "counts" if designs.left_out else "meets the constraints"
        dimensions.append(_words_axis(label, ["no", "yes"], meets.astype(int).tolist()))
    lines = _trace("parallel", dimensions=dimensions, line=_colours(main, meets))
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


def _ticks(numbers: ArrayLike, values: ArrayLike) -> list[str]:
    """Texts of ticks: the lowest is zero where that is the smallest value."""
    texts = [short_number(number, 3) for number in np.asarray(numbers, dtype=float).tolist()]
    return ["0", *texts[1:]] if np.nanmin(np.asarray(values, dtype=float)) == 0 else texts


def _dimension(display: Display, rows: pd.Index, name: str) -> dict[str, Any]:
    """One axis of parallel coordinates: words, or numbers or their logarithms with a few ticks."""
    places = display.axis_values(rows, name)
    if isinstance(places[0], str):
        # the description of a study lists the first words of very many only
        words = list(dict.fromkeys([*display.levels(name), *places]))
        return _words_axis(display.label(name), words, [words.index(word) for word in places])
    scale = np.log10 if display.logarithmic(name) else np.asarray
    values = scale(np.array(places, dtype=float))
    ticks = np.linspace(values.min(), values.max(), 6)
    numbers = (10**ticks if display.logarithmic(name) else ticks).tolist()
    places_once = scale(np.array(sorted(set(places))))
    # as far apart as their texts are high
    has_room = np.diff(places_once).min(initial=np.inf) >= 0.05 * np.ptp(places_once)
    if name in display.designs.parameters and len(places_once) <= FEW and has_room:
        numbers, ticks = sorted(set(places)), places_once
    return {
        "label": display.label(name),
        "values": values.tolist(),
        "tickvals": ticks.tolist(),
        "ticktext": _ticks(numbers, display.values(rows, name)),
    }


def _colours(dimension: dict[str, Any], meets: BoolArray) -> dict[str, Any]:
    """Colours of lines by one axis; grey, below its smallest value, for designs that do not count."""
    from plotly.colors import sequential

    values = np.array(dimension["values"], dtype=float)
    low, high = float(values.min()), float(values.max())
    ticks, text = list(dimension["tickvals"]), list(dimension["ticktext"])
    start, floor = 0.0, low
    scale: list[list[Any]] = []
    if not meets.all():
        start, floor = _GREY_SHARE, low - (high - low or 1.0) * _GREY_SHARE / (1 - _GREY_SHARE)
        values = np.where(meets, values, floor)
        scale = [[0.0, GREY], [start, GREY]]
        ticks, text = [0.5 * (floor + low), *ticks], ["does not count", *text]
    shares = np.linspace(start, 1.0, len(sequential.Viridis)).tolist()
    scale += [[share, colour] for share, colour in zip(shares, sequential.Viridis, strict=True)]
    title = {"text": dimension["label"], "side": "right"}
    return {
        "color": values.tolist(),
        "cmin": floor,
        "cmax": high,
        "colorscale": scale,
        "showscale": True,
        "colorbar": {"title": title, "tickvals": ticks, "ticktext": text},
    }


def _main_output(outputs: list[str]) -> str:
    return LEAK_RATE if LEAK_RATE in outputs else outputs[0]


def _replace_nan(values: Any) -> Any:
    """Lists with null in place of NaN, which JSON does not know."""
    array = np.asarray(values, dtype=object)
    array[~np.isfinite(np.asarray(values, dtype=float))] = None
    return array.tolist()


def pareto_plot(display: Display) -> Figure | None:
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
        _trace(look, **_points(display, rows, names[0], names[1], details)) for look, rows in groups.items()
    ]
    axes = {"xaxis": display.axis(names[0]), "yaxis": display.axis(names[1])}
    return _figure(traces, "pareto", shapes=_lines(display, *names), **axes)


def search_plot(display: Display) -> Figure | None:
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
        traces.append(_trace("best_so_far", x=best.index.tolist(), y=so_far))
        for trace in traces:
            figure.add_trace({**trace, "showlegend": place == 1}, row=place, col=1)
        figure.update_yaxes(display.axis(name), row=place, col=1)
        for line in _lines(display, y=name):
            figure.add_hline(line["y0"], line=line["line"], row=place, col=1)
    figure.update_xaxes({"title": {"text": "trial"}}, row=len(names), col=1)
    figure.update_layout({**own_tables(LOOKS)["layout"], "height": 160 + 300 * len(names)})
    return figure


def distribution_plot(display: Display) -> Figure | None:
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
        "share_between",
        x=(0.5 * (edges[1:] + edges[:-1])).tolist(),
        y=(counts / len(leak_rate)).tolist(),
        width=np.diff(edges).tolist(),
    )
    others = [
        # in the unit of the other curve
        _trace(
            "share_below_beside",
            **cumulative_shares(np.sort(display.convert(LEAK_RATE, rates))),
            name=f"share below, surface {SCENARIOS[name].title}",
        )
        for name, rates in other_leak_rates(display.designs).items()
    ]
    curve = _trace("share_below", **cumulative_shares(leak_rate))
    axis = display.axis(LEAK_RATE)
    return _figure([bars, curve, *others], "distribution", xaxis=axis, shapes=_lines(display, x=LEAK_RATE))


def sensitivity_plot(display: Display, indices: Sensitivity) -> Figure:
    """Bars of both indices of every parameter, the one that matters most above."""
    of, size, unit = scale(display, indices)
    words, places = own_tables(LOOKS)["sensitivity"][indices.method], indices.order

    def bars(look: str, name: str, values: FloatArray, errors: FloatArray) -> dict[str, Any]:
        ends = {
            "type": "data",
            "array": (errors[places] / size).tolist(),
            "visible": bool((errors > 0).any()),
        }
        titles = [display.title(indices.parameters[n]) for n in places]
        return _trace(look, y=titles, x=(values[places] / size).tolist(), name=name, error_x=ends)

    return _figure(
        [
            bars("first_index", words["bars"][0], indices.first, indices.first_error),
            bars("second_index", words["bars"][1], indices.total, indices.total_error),
        ],
        "sensitivity",
        height=170 + 55 * len(indices.parameters),
        xaxis={"title": {"text": words["axis"].format(of=of, unit=unit)}},
    )


def scale(display: Display, indices: Sensitivity) -> tuple[str, float, str]:
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

    display = Display(designs)
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
