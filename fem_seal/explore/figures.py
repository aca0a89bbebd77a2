"""The pictures of the page: section, leak curve, pressure profile and gap of a design beside those that are pinned."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from fem_seal.explore.screen import LEAK, ShownDesign, preliminary_words
from fem_seal.files import own_tables
from fem_seal.units import Display, Unit, number

if TYPE_CHECKING:
    from fem_seal.explore.screen import CrossSection, Screen, ShownLoad, ShownProfile

Values = Sequence[float | None]
# Of the design on the screen and of those pinned, fit for light and dark, told apart by the colour-blind, too.
LIVE, PINS = "#2f7fd6", ("#e07b39", "#2f9e6e", "#b264c8", "#c9a227")
PIN_NAMES = "ABCD"
_GREY, _LIMIT = "#7b838f", "#c8443b"
# What an annotation gives its place in: the whole picture.
_PAPER = {"xref": "paper", "yref": "paper"}


class Figure:
    """A picture as plotly.js takes it; plotly's own figures check so much that they take longer than the answer.

    Parameters
    ----------
    dark : bool
        For a dark page.
    """

    def __init__(self, dark: bool) -> None:
        self.data: list[dict[str, Any]] = []
        look = own_tables("explore/looks.toml")
        self.colours: dict[str, str] = look["dark" if dark else "light"]
        self.ink, grid = self.colours["ink"], self.colours["grid"]
        axis = {**look["axis"], "gridcolor": grid, "linecolor": grid, "tickcolor": grid}
        font = {**look["layout"]["font"], "color": self.ink}
        self.layout: dict[str, Any] = {**look["layout"], "font": font, "xaxis": axis, "yaxis": axis}

    def add(self, look: str, x: Values, y: Values, colour: str, **entries: Any) -> None:
        """A trace that looks as the file of the page says, with further entries."""
        trace = own_tables("explore/looks.toml")["traces"][look]
        parts = {part: {**trace[part], "color": colour} for part in ("line", "marker") if part in trace}
        self.data.append({"type": "scatter", **trace, "x": x, "y": y, **parts, **entries})

    def add_note(self, x: float, y: float, text: str, colour: str, size: int = 12, **entries: Any) -> None:
        """A text."""
        font = {"color": colour, "size": size}
        note = {"x": x, "y": y, "text": text, "showarrow": False, "font": font, **entries}
        self.layout.setdefault("annotations", []).append(note)

    def add_level(self, y: float, text: str, colour: str) -> None:
        """A dashed line across, at a place of a logarithmic axis, with a text above it."""
        ends = {"xref": "paper", "x0": 0, "x1": 1, "y0": y, "y1": y}
        line = {"dash": "dash", "width": 1.4, "color": colour}
        self.layout.setdefault("shapes", []).append({"type": "line", **ends, "line": line})
        self.add_note(0, math.log10(y), text, colour, 11, xref="paper", xanchor="left", yanchor="bottom")

    def update(self, axis: str, title: str = "", **entries: Any) -> None:
        """Entries of "xaxis" or "yaxis"."""
        if title:
            entries["title"] = {**self.layout[axis]["title"], "text": title}
        self.layout[axis] = {**self.layout[axis], **entries}

    def say_alone(self, text: str) -> None:
        """A text in place of the axes."""
        self.add_note(0.5, 0.5, text, self.ink, 14, **_PAPER)
        self.update("xaxis", visible=False)
        self.update("yaxis", visible=False)

    def plain(self) -> dict[str, Any]:
        """As it goes to the page."""
        return {"data": self.data, "layout": self.layout}


def designs_shown(screen: Screen, pins: Sequence[Screen]) -> list[ShownDesign]:
    """The design on the screen and those pinned, with their names and colours.

    Parameters
    ----------
    screen : Screen
    pins : sequence of Screen
    """
    return [ShownDesign(screen, "now", LIVE), *map(ShownDesign, pins, PIN_NAMES, PINS)]


def figures(designs: Sequence[ShownDesign], dark: bool) -> dict[str, Figure]:
    """All pictures, "section", "leak", "profile" and "gap".

    Parameters
    ----------
    designs : sequence of ShownDesign
        That of the sliders first.
    dark : bool
        For a dark page.
    """
    return {
        "section": section_figure(designs[0].screen.section, dark, designs[0].screen.profile),
        "leak": leak_figure(designs, dark),
        "profile": _over_x(designs, dark, "pressure"),
        "gap": _over_x(designs, dark, "gap"),
    }


def section_figure(section: CrossSection | None, dark: bool, profile: ShownProfile | None = None) -> Figure:
    """Closure and seat in section to scale, the circle of first touch and the side of the pressure, and the contact.

    Parameters
    ----------
    section : CrossSection or None
    dark : bool
    profile : ShownProfile, optional
        Pressure of the contact.
    """
    figure = Figure(dark)
    figure.update("xaxis", visible=False, scaleanchor="y", constrain="domain")
    figure.update("yaxis", visible=False)
    if section is None:
        return figure
    unit = Display().fixed_unit("mm")
    whole = list(zip(("closure", "seat"), section.rings, strict=True))[::-1]
    for name, rings in whole:
        for ring, side in product(rings, (1, -1)):
            _outline(figure, name, ring, side, unit)
    heights = [unit.of(z) for _, rings in whole for ring in rings for _, z in ring]
    low, high = min(heights), max(heights)
    figure.add("axis", [0, 0], [low, high], _GREY)
    r0 = unit.of(section.initial_contact_radius)
    hover = f"circle of first touch, radius {r0:.4g} {unit.name}<extra></extra>"
    figure.add("touch", [-r0, r0], [0, 0], PINS[0], hovertemplate=hover)
    outer = unit.of(max(r for r, _ in section.seat))
    # in two lines, which have room beside a closure that is drawn small
    high_side, low_side = ("high<br>pressure", LIVE), ("low<br>pressure", _GREY)
    if section.pressure_side != "outer":
        high_side, low_side = low_side, high_side
    veil: dict[str, Any] = {"bgcolor": figure.colours["veil"], "borderpad": 0}
    if section.middle is None:
        figure.add_note(outer, high, *high_side, xanchor="right", yanchor="top", **veil)
        figure.add_note(0, low, *low_side, xanchor="center", yanchor="bottom", **veil)
    else:
        # the gap between flanges has no room for words
        sides = f"{low_side[0]} inside the ring, {high_side[0]} outside".replace("<br>", " ")
        figure.add_note(0, low, sides, figure.ink, xanchor="center", yanchor="top", yshift=-4)
    touch = f"r₀ = {r0:.4g} {unit.name}, contact angle {math.degrees(section.angle):.4g}°"
    figure.add_note(0, 1, touch, figure.ink, xref="x domain", yref="paper", xanchor="left", yanchor="top")
    _add_detail(figure, section, profile, unit)
    return figure


def _outline(
    figure: Figure, name: str, ring: Sequence[tuple[float, float]], side: int, unit: Unit, **entries: Any
) -> None:
    """A body in section, filled."""
    x, y = ([unit.of(value) for value in values] for values in zip(*ring, ring[0], strict=True))
    figure.add(
        "outline", [side * r for r in x], y, figure.ink, fillcolor=figure.colours[name], name=name, **entries
    )


def _add_detail(figure: Figure, section: CrossSection, profile: ShownProfile | None, unit: Unit) -> None:
    """The contact enlarged, beside the section, with the stretches that carry the load."""
    r, z, half = map(unit.of, section.window)
    axes: dict[str, Any] = {"xaxis": "x2", "yaxis": "y2"}
    _outline(figure, "seat", section.seat, 1, unit, **axes)
    _outline(figure, "closure", section.closure, 1, unit, **axes)
    if profile is not None:
        limit = 1e-3 * max(profile.pressure)
        carries = [p > limit for p in profile.pressure]
        steps = zip(profile.x, profile.x[1:], carries, carries[1:], strict=False)
        width = sum(end - start for start, end, left, right in steps if left and right)
        # no line between lands
        r_carries, z_carries = (
            [unit.of(place) if carried else None for place, carried in zip(axis, carries, strict=True)]
            for axis in profile.places
        )
        hover = f"carries over {unit.of(width):.3g} {unit.name}<extra></extra>"
        figure.add("carries", r_carries, z_carries, PINS[0], hovertemplate=hover, **axes)
    frame = {
        "x0": r - half,
        "x1": r + half,
        "y0": z - half,
        "y1": z + half,
        "line": {"color": PINS[0], "width": 1.2},
    }
    edge = {"x0": 0, "x1": 1, "y0": 0, "y1": 1, "xref": "x2 domain", "yref": "y2 domain"}
    figure.layout["shapes"] = [
        {"type": "rect", **frame},
        {"type": "rect", **edge, "line": {"color": PINS[0], "width": 1.2}},
    ]
    hidden: dict[str, Any] = {"visible": False, "constrain": "domain"}
    figure.update("xaxis", domain=[0, 0.6])
    figure.layout["xaxis2"] = {**hidden, "domain": [0.64, 1], "range": [r - half, r + half], "anchor": "y2"}
    figure.layout["yaxis2"] = {**hidden, "range": [z - half, z + half], "scaleanchor": "x2", "anchor": "x2"}
    figure.update("yaxis", domain=[0, 0.92])
    figure.layout["yaxis2"]["domain"] = [0, 0.92]
    label = f"{2 * half:.2g} {unit.name} wide"
    figure.add_note(0.5, 1, label, figure.ink, 12, xref="x2 domain", yref="paper", yanchor="top")


def _over_force(screen: Screen) -> bool:
    """Whether the loads differ in force rather than in fluid pressure."""
    pressures = {load.values["fluid_pressure_Pa"] for load in screen.loads}
    return len(pressures) == 1 and len({load.applied_force for load in screen.loads}) > 1


def leak_figure(designs: Sequence[ShownDesign], dark: bool) -> Figure:
    """Leak rate over the load, with the interval of each design, on a logarithmic axis.

    Parameters
    ----------
    designs : sequence of ShownDesign
        That of the sliders first.
    dark : bool
    """
    figure, screen = Figure(dark), designs[0].screen
    rates = [
        load.values[name]
        for design in designs
        for load in (*design.screen.loads, *design.screen.curve_loads)
        for name in ("leak_rate_m3_per_s", "leak_rate_high_m3_per_s")
    ]
    rates = [rate for rate in rates if math.isfinite(rate) and rate > 0]
    # that of the number beside the picture
    interval = [] if screen.load is None else [screen.load.values[name] for name in LEAK]
    middle = math.exp(sum(map(math.log, rates)) / len(rates)) if rates else 1e-8
    unit = screen.display.flow_unit(interval) or screen.display.unit_for("flow", middle)
    force = _over_force(screen)
    axis = "force" if force else "fluid pressure"
    load_unit = screen.display.unit_for(
        axis, max((_place(load, force) for load in screen.loads), default=1e5)
    )
    for design in reversed(designs):
        _add_leak(figure, design, unit, load_unit, force)
    for name, limit in screen.limits:
        if limit > 0:
            figure.add_level(unit.of(limit), f"allowed: {name}", _LIMIT)
    ratio = max(rates) / min(rates) if rates else math.inf
    ticks: dict[str, Any] = {"dtick": None, "nticks": 6} if ratio < 3 else {"dtick": 1}
    if 3 <= ratio < 100:
        # plotly itself writes a 5 for 0.5 and for 50
        low, high = (math.floor(math.log10(unit.of(end(rates)))) for end in (min, max))
        # enough of them to see that the axis is logarithmic
        steps = (1, 2, 3, 5, 7) if ratio < 15 else (1, 2, 5)
        marks = [step * 10.0**power for power in range(low - 1, high + 2) for step in steps]
        ticks = {"tickvals": marks, "ticktext": [number(mark, 1) for mark in marks]}
    # in two lines: one is longer than the axis
    state = screen.display.state_of(screen.volume)
    title = f"leak rate [{unit.name}]" + (f"<br>at {state}" if state else "")
    figure.update("yaxis", title, type="log", exponentformat="power", **ticks)
    figure.update("xaxis", f"{axis} [{load_unit.name}]", rangemode="tozero")
    if not rates:
        figure.say_alone("calculating ..." if screen.delay else "no leak rate")
    elif preliminary := preliminary_words(screen):
        figure.add_note(1, 0, preliminary, figure.ink, 11, **_PAPER, xanchor="right", yanchor="bottom")
    return figure


def _place(load: ShownLoad, force: bool) -> float:
    return load.applied_force if force else load.values["fluid_pressure_Pa"]


def _add_leak(figure: Figure, design: ShownDesign, unit: Unit, load_unit: Unit, force: bool) -> None:
    screen, load, colour = design.screen, design.screen.load, design.colour
    if load is None:
        return
    # up and down again is no curve, but several points
    curve = sorted((*screen.loads, *screen.curve_loads), key=lambda load: _place(load, force))
    x = [load_unit.of(_place(load, force)) for load in curve]
    rate, *ends = ([_positive(unit.of(load.values[column])) for load in curve] for column in LEAK)
    band = [(at, low, high) for at, low, high in zip(x, *ends, strict=True) if low and high]
    for which, fill in ((1, "none"), (2, "tonexty")) if any(ends[0]) else ():
        edge = [point[0] for point in band], [point[which] for point in band]
        figure.add("interval", *edge, colour, fill=fill, fillcolor=_faint(colour))
    hover = f"{design.name}: %{{y:.3g}} {unit.name} at %{{x:.4g}} {load_unit.name}<extra></extra>"
    figure.add("leak", x, rate, colour, name=design.name, hovertemplate=hover)
    at, rate_at_load = load_unit.of(_place(load, force)), unit.of(load.values["leak_rate_m3_per_s"])
    figure.add("load", [at], [_positive(rate_at_load)], colour, error_y=_bar(load, unit, colour))


def _bar(load: ShownLoad, unit: Unit, colour: str) -> dict[str, Any] | None:
    """From end to end of the interval of one load: a band needs two."""
    rate, low, high = (unit.of(load.values[column]) for column in LEAK)
    if not all(map(math.isfinite, (rate, low, high))):
        return None
    bar = {"type": "data", "symmetric": False, "array": [high - rate], "arrayminus": [rate - low]}
    return {**bar, "color": colour, "thickness": 1.5, "width": 5}


def _positive(value: float) -> float | None:
    """What a logarithmic axis can show."""
    return value if math.isfinite(value) and value > 0 else None


def _over_x(designs: Sequence[ShownDesign], dark: bool, what: str) -> Figure:
    """Contact pressure or gap across the contact."""
    figure = Figure(dark)
    profiles = [(design.screen.profile, design) for design in designs if design.screen.profile is not None]
    if not profiles:
        figure.say_alone("nothing to show")
        return figure
    display = designs[0].screen.display
    x_unit = display.unit_for("length", max(abs(x) for profile, _ in profiles for x in profile.x))
    if what == "gap":
        gap = max(_widest_carrying(profile) for profile, _ in profiles)
        title, unit = "mean gap", display.unit_for("length", gap)
        # beside the contact the faces part soon, and far more than they do where they carry
        figure.update("yaxis", range=[0, unit.of(1.5 * gap)], autorange=False)
    else:
        peak = max((y for profile, _ in profiles for y in profile.pressure if math.isfinite(y)), default=0.0)
        title, unit = "contact pressure", display.unit_for("contact pressure", peak)
    figure.update("xaxis", f"x across the seat [{x_unit.name}]")
    figure.update("yaxis", f"{title} [{unit.name}]", rangemode="tozero")

    for profile, design in reversed(profiles):
        is_filled = design is designs[0] and what == "pressure"
        lines = [("profile", getattr(profile, what), design.name, f" at %{{x:.4g}} {x_unit.name}")]
        lines += [("fluid", profile.fluid, "fluid", "")] if is_filled and profile.fluid else []
        fill = {"fill": "tozeroy" if is_filled else None, "fillcolor": _faint(design.colour)}
        x = [x_unit.of(place) for place in profile.x]
        for look, values, name, at in lines:
            y = [unit.of(value) if math.isfinite(value) else None for value in values]
            hover = f"{name}: %{{y:.4g}} {unit.name}{at}<extra></extra>"
            options = fill if look == "profile" else {}
            figure.add(look, x, y, design.colour, name=name, hovertemplate=hover, **options)
    return figure


def _widest_carrying(profile: ShownProfile) -> float:
    """Largest gap where a thousandth of the peak pressure is carried [m]."""
    limit = 1e-3 * max(profile.pressure)
    gaps = (gap for gap, pressure in zip(profile.gap, profile.pressure, strict=True) if pressure > limit)
    return max((gap for gap in gaps if math.isfinite(gap)), default=1e-6)


def _faint(colour: str) -> str:
    red, green, blue = (int(colour[n : n + 2], 16) for n in (1, 3, 5))
    return f"rgba({red},{green},{blue},0.16)"
