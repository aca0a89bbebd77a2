"""The pictures of the page: section, leak curve, pressure profile and gap of a design beside those that are pinned."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fem_seal.explore.words import preliminary_words
from fem_seal.units import Unit, unit_for

if TYPE_CHECKING:
    from fem_seal.explore.screen import Screen, Section, ShownLoad, ShownProfile

# Of the design on the screen and of those pinned, fit for light and dark, told apart by the colour-blind, too.
LIVE, PINS = "#2f7fd6", ("#e07b39", "#2f9e6e", "#b264c8", "#c9a227")
_FILLS = {False: ("#dfe8f2", "#ece7dd"), True: ("#31445c", "#4a4336")}
_INK = {False: "#1c2430", True: "#e3e8ef"}
_GRID = {False: "#e4e8ee", True: "#39424f"}
# Width of the section around the contact over that of the contact zone.
_NEAR = 1.25
# Of a picture [px].
HEIGHT = 280


class Figure:
    """A picture as plotly.js takes it; plotly's own figures check so much that they take longer than the answer.

    Parameters
    ----------
    layout
        As in plotly.
    """

    def __init__(self, **layout: Any) -> None:
        self.data: list[dict[str, Any]] = []
        self.layout: dict[str, Any] = layout

    def add_scatter(self, **trace: Any) -> None:
        """A line or points."""
        self.data.append({"type": "scatter", **trace})

    def add_annotation(self, **note: Any) -> None:
        """A text."""
        self.layout.setdefault("annotations", []).append(note)

    def add_level(self, y: float, text: str, colour: str) -> None:
        """A dashed line across, at a place of a logarithmic axis, with a text above it."""
        across = {"xref": "paper", "x0": 0, "x1": 1, "y0": y, "y1": y}
        line = {"dash": "dash", "width": 1.4, "color": colour}
        self.layout.setdefault("shapes", []).append({"type": "line", **across, "line": line})
        place = {"xref": "paper", "x": 0, "y": math.log10(y), "xanchor": "left", "yanchor": "bottom"}
        self.add_annotation(**place, text=text, showarrow=False, font={"color": colour, "size": 11})

    def update(self, axis: str, title: str = "", **entries: Any) -> None:
        """Entries of "xaxis" or "yaxis"."""
        if title:
            entries["title"] = {**self.layout[axis].get("title", {}), "text": title}
        self.layout[axis] = {**self.layout[axis], **entries}

    def plain(self) -> dict[str, Any]:
        """As it goes to the page."""
        return {"data": self.data, "layout": self.layout}


def figures(screen: Screen, pins: Sequence[Screen], dark: bool) -> dict[str, Figure]:
    """All pictures, "section", "leak", "profile" and "gap".

    Parameters
    ----------
    screen : Screen
    pins : sequence of Screen
    dark : bool
        For a dark page.
    """
    shown = [(screen, LIVE, "now"), *((pin, PINS[n], chr(ord("A") + n)) for n, pin in enumerate(pins))]
    return {
        "section": section_figure(screen.section, dark),
        "leak": leak_figure(shown, dark),
        "profile": _over_x(shown, dark, "pressure"),
        "gap": _over_x(shown, dark, "gap"),
    }


Shown = Sequence[tuple["Screen", str, str]]


def _empty(dark: bool) -> Figure:
    axis = {
        "gridcolor": _GRID[dark],
        "zeroline": False,
        "linecolor": _GRID[dark],
        "ticks": "outside",
        "tickcolor": _GRID[dark],
        "automargin": True,
        "title": {"standoff": 8},
    }
    return Figure(
        height=HEIGHT,
        margin={"l": 8, "r": 8, "t": 8, "b": 8},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"color": _INK[dark], "size": 12, "family": "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif"},
        xaxis=axis,
        yaxis=dict(axis),
        showlegend=False,
        uirevision="kept",
        hoverlabel={"namelength": -1},
    )


def section_figure(section: Section | None, dark: bool) -> Figure:
    """Closure and seat in section, the circle of first touch and the side of the pressure.

    Parameters
    ----------
    section : Section or None
    dark : bool
    """
    figure = _empty(dark)
    figure.update("xaxis", visible=False, scaleanchor="y", constrain="domain")
    figure.update("yaxis", visible=False)
    if section is None:
        return figure
    closure, seat = _FILLS[dark]
    for name, corners, fill in (("seat", section.seat, seat), ("closure", section.closure, closure)):
        for side in (1, -1):
            ring = [*corners, corners[0]]
            figure.add_scatter(
                x=[1e3 * side * r for r, _ in ring],
                y=[1e3 * z for _, z in ring],
                mode="lines",
                fill="toself",
                fillcolor=fill,
                line={"width": 0.8, "color": _INK[dark]},
                name=name,
                hoverinfo="name",
            )
    low = 1e3 * min(z for _, z in section.seat)
    high = 1e3 * max(z for _, z in section.closure)
    figure.add_scatter(
        x=[0, 0],
        y=[low, high],
        mode="lines",
        line={"dash": "longdashdot", "width": 1, "color": "#7b838f"},
        hoverinfo="skip",
    )
    r0 = 1e3 * section.touch_radius
    figure.add_scatter(
        x=[-r0, r0],
        y=[0, 0],
        mode="lines+markers",
        line={"dash": "dot", "width": 1, "color": PINS[0]},
        marker={"size": 7, "color": PINS[0]},
        hovertemplate=f"circle of first touch, radius {r0:.4g} mm<extra></extra>",
    )
    outer = 1e3 * max(r for r, _ in section.seat)
    above = section.pressure_side == "outer"
    for text, y in (("high pressure", high if above else low), ("low pressure", low if above else high)):
        at_top = y == high
        figure.add_annotation(
            x=outer if at_top else 0,
            y=y,
            text=text,
            showarrow=False,
            font={"color": LIVE if text.startswith("high") else "#7b838f", "size": 12},
            xanchor="right" if at_top else "center",
            yanchor="top" if at_top else "bottom",
        )
    figure.add_annotation(
        x=0,
        y=0,
        text=f"r₀ = {r0:.4g} mm, contact angle {math.degrees(section.angle):.4g}°",
        showarrow=False,
        yshift=10,
        font={"color": PINS[0], "size": 12},
    )
    return figure


def over_force(screen: Screen) -> bool:
    """Whether the loads differ in force rather than in fluid pressure."""
    pressures = {load.values["fluid_pressure_Pa"] for load in screen.loads}
    forces = {load.applied_force for load in screen.loads}
    return len(pressures) == 1 and len(forces) > 1


def leak_figure(shown: Shown, dark: bool) -> Figure:
    """Leak rate over the load, with the interval of each design, on a logarithmic axis.

    Parameters
    ----------
    shown : sequence of tuple
        Screens with colour and name, that of the sliders first.
    dark : bool
    """
    figure = _empty(dark)
    rates = [
        load.values[name]
        for screen, _, _ in shown
        for load in (*screen.loads, *screen.between)
        for name in ("leak_rate_m3_per_s", "leak_rate_high_m3_per_s")
    ]
    rates = [rate for rate in rates if math.isfinite(rate) and rate > 0]
    unit = unit_for("flow", math.exp(sum(map(math.log, rates)) / len(rates)) if rates else 1e-8)
    force = over_force(shown[0][0])
    axis, load_unit = _load_axis(shown[0][0], force)
    for screen, colour, name in reversed(shown):
        _add_leak(figure, screen, colour, name, unit, load_unit, force)
    for name, allowed in shown[0][0].limits:
        if allowed > 0:
            figure.add_level(unit.of(allowed), f"allowed: {name}", "#c8443b")
    figure.update(
        "yaxis",
        type="log",
        title=f"leak rate [{shown[0][0].volume.named(unit).name}]",
        exponentformat="power",
        dtick=1,
    )
    if rates and max(rates) < 100 * min(rates):
        figure.update("yaxis", dtick="D2")
    if rates and max(rates) < 3 * min(rates):
        figure.update("yaxis", dtick=None, nticks=6)
    figure.update("xaxis", title=f"{axis} [{load_unit.name}]", rangemode="tozero")
    preliminary = preliminary_words(shown[0][0])
    if rates and preliminary:
        place = {"xref": "paper", "x": 1, "yref": "paper", "y": 0, "xanchor": "right", "yanchor": "bottom"}
        figure.add_annotation(
            **place, text=preliminary, showarrow=False, font={"color": _INK[dark], "size": 11}
        )
    if not rates:
        _say(figure, (shown[0][0].waiting and "calculating ...") or "no leak rate", dark)
    return figure


def _load_axis(screen: Screen, force: bool) -> tuple[str, Unit]:
    kind = "force" if force else "fluid pressure"
    largest = max((_place(load, force) for load in screen.loads), default=1e5)
    return kind, unit_for(kind, largest)


def _place(load: ShownLoad, force: bool) -> float:
    return load.applied_force if force else load.values["fluid_pressure_Pa"]


def _add_leak(
    figure: Figure, screen: Screen, colour: str, name: str, unit: Unit, load_unit: Unit, force: bool
) -> None:
    chosen = screen.load
    if chosen is None:
        return
    # up and down again is no curve, but several points
    curve = sorted((*screen.loads, *screen.between), key=lambda load: _place(load, force))
    x = [load_unit.of(_place(load, force)) for load in curve]
    ends = [
        [_positive(unit.of(load.values[f"leak_rate_{end}_m3_per_s"])) for load in curve]
        for end in ("low", "high")
    ]
    if any(one is not None for one in ends[0]):
        kept = [n for n in range(len(x)) if ends[0][n] is not None and ends[1][n] is not None]
        for which, fill in ((0, "none"), (1, "tonexty")):
            figure.add_scatter(
                x=[x[n] for n in kept],
                y=[ends[which][n] for n in kept],
                mode="lines",
                fill=fill,
                fillcolor=_faint(colour),
                line={"width": 0.6, "color": colour, "shape": "spline", "smoothing": 0.8},
                hoverinfo="skip",
            )
    figure.add_scatter(
        x=x,
        y=[_positive(unit.of(load.values["leak_rate_m3_per_s"])) for load in curve],
        mode="lines",
        name=name,
        line={"color": colour, "width": 2, "shape": "spline", "smoothing": 0.8},
        hovertemplate=f"{name}: %{{y:.3g}} {unit.name} at %{{x:.4g}} {load_unit.name}<extra></extra>",
    )
    figure.add_scatter(
        x=[load_unit.of(_place(chosen, force))],
        y=[_positive(unit.of(chosen.values["leak_rate_m3_per_s"]))],
        mode="markers",
        marker={"color": colour, "size": 9},
        error_y=_bar(chosen, unit, colour),
        hoverinfo="skip",
    )


def _bar(load: ShownLoad, unit: Unit, colour: str) -> dict[str, Any] | None:
    """From end to end of the interval of one load: a band needs two."""
    rate, low, high = (unit.of(load.values[f"leak_rate_{end}m3_per_s"]) for end in ("", "low_", "high_"))
    if not all(map(math.isfinite, (rate, low, high))):
        return None
    bar = {"type": "data", "symmetric": False, "array": [high - rate], "arrayminus": [rate - low]}
    return {**bar, "color": colour, "thickness": 1.5, "width": 5}


def _positive(value: float) -> float | None:
    """What a logarithmic axis can show."""
    return value if math.isfinite(value) and value > 0 else None


def _over_x(shown: Shown, dark: bool, what: str) -> Figure:
    """Contact pressure or gap across the contact."""
    figure = _empty(dark)
    profiles = [(one.profile, colour, name) for one, colour, name in shown if one.profile is not None]
    if not profiles:
        _say(figure, "nothing to show", dark)
        return figure
    reach = max(abs(x) for profile, _, _ in profiles for x in profile.x)
    x_unit = unit_for("length", reach)
    values = [[y for y in getattr(profile, what) if math.isfinite(y)] for profile, _, _ in profiles]
    kind = "length" if what == "gap" else "contact pressure"
    carried = max(_widest_carrying(profile) for profile, _, _ in profiles)
    unit = unit_for(kind, carried if what == "gap" else max(max(one, default=0.0) for one in values))
    for profile, colour, name in reversed(profiles):
        own = name == "now"
        figure.add_scatter(
            x=[x_unit.of(x) for x in profile.x],
            y=[unit.of(y) if math.isfinite(y) else None for y in getattr(profile, what)],
            mode="lines",
            name=name,
            line={"color": colour, "width": 2},
            fill="tozeroy" if own and what == "pressure" else None,
            fillcolor=_faint(colour),
            hovertemplate=f"{name}: %{{y:.4g}} {unit.name} at %{{x:.4g}} {x_unit.name}<extra></extra>",
        )
        if own and what == "pressure" and profile.fluid:
            figure.add_scatter(
                x=[x_unit.of(x) for x in profile.x],
                y=[unit.of(y) if math.isfinite(y) else None for y in profile.fluid],
                mode="lines",
                name="fluid",
                line={"color": colour, "width": 1.2, "dash": "dash"},
                hovertemplate=f"fluid: %{{y:.4g}} {unit.name}<extra></extra>",
            )
    figure.update("xaxis", title=f"x across the seat [{x_unit.name}]")
    if what == "gap":
        # beside the contact the faces part soon, and far more than they do where they carry
        figure.update("yaxis", range=[0, unit.of(1.5 * carried)], autorange=False)
    title = "mean gap" if what == "gap" else "contact pressure"
    figure.update("yaxis", title=f"{title} [{unit.name}]", rangemode="tozero")
    return figure


def _widest_carrying(profile: ShownProfile) -> float:
    """Largest gap where a thousandth of the peak pressure is carried [m]."""
    least = 1e-3 * max(profile.pressure)
    gaps = (gap for gap, pressure in zip(profile.gap, profile.pressure, strict=True) if pressure > least)
    return max((gap for gap in gaps if math.isfinite(gap)), default=1e-6)


def _say(figure: Figure, text: str, dark: bool) -> None:
    figure.add_annotation(
        x=0.5,
        y=0.5,
        xref="paper",
        yref="paper",
        text=text,
        showarrow=False,
        font={"color": _INK[dark], "size": 14},
    )
    figure.update("xaxis", visible=False)
    figure.update("yaxis", visible=False)


def _faint(colour: str) -> str:
    red, green, blue = (int(colour[n : n + 2], 16) for n in (1, 3, 5))
    return f"rgba({red},{green},{blue},0.16)"
