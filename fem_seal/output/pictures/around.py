"""Pictures of a seal that is not round: contact pressure, line load and leak around the axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.leakage_class import volume_of
from fem_seal.arrays import FloatArray
from fem_seal.output.pictures import style
from fem_seal.output.pictures.colours import GREY, INK, ORANGE
from fem_seal.output.pictures.contact import SCALE_ROOM, even_levels, scale_of_colours
from fem_seal.seal.circumference import Circumference
from fem_seal.seal.load_result import distinct_loads, load_axis, load_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display

# Pressures below this share of the largest stay white.
_FAINT = 0.02
# Largest number of angles of a map, and its reach to both sides of the contact in standard deviations.
_ANGLES, _REACH = 360, 3.4
# More lines than this in one picture cannot be told apart.
_LINES = 4
_DEGREE = math.pi / 180


def unrolled_picture(result: SealSolution) -> style.Picture | None:
    """The contact pressure at the highest load, unrolled; None for a round seal, even with scratches.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    if load.around is None or not load.around.form.uneven:
        return None
    around, name = load.around, load_name(load, result.loads, result.display)
    step = math.ceil(len(around.angle) / _ANGLES)
    angle, (pressure, _) = around.angle[::step], around.pressure_and_gap(step)
    profile = around.local.mean.profiles[0]
    strongest = replace(profile, pressure=pressure[int(np.argmax(pressure.max(axis=1)))])
    reach = min(_REACH * strongest.std + abs(strongest.centroid), float(np.abs(profile.x).max()))
    length = result.display.unit_for("length", reach)
    unit = result.display.unit_for("contact pressure", float(pressure.max()))
    figure, (axes,) = style.panels(1, height=3.5, side=SCALE_ROOM)
    largest = unit.of(float(pressure.max()))
    whole_turn = np.append(angle, 2 * math.pi) / _DEGREE
    bands = axes.contourf(
        whole_turn,
        profile.x / length.size,
        unit.of(1.0) * np.vstack([pressure, pressure[:1]]).T,
        levels=[_FAINT * largest, *even_levels(0.0, largest)[1:]],
        cmap="YlOrRd",
    )
    # a profile without pressure has no peak
    peaks = [replace(profile, pressure=p).peak[0] if p.max() > 0 else math.nan for p in pressure]
    axes.plot(whole_turn, np.append(peaks, peaks[:1]) / length.size, color=INK, linewidth=1.0, label="peak")
    axes.set_ylim(-reach / length.size, reach / length.size)
    axes.legend(loc="upper right", handlelength=1.4)
    _label_turn(axes, f"Contact pressure at {name}", f"x  [{length.name}]")
    scale_of_colours([axes], bands, f"contact pressure  [{unit.name}]", lowest="0")
    parted = bool(np.isnan(peaks).any())
    return style.captioned(result.display, figure, "unrolled", "map", "parted" if parted else "", load=name)


def line_load_picture(result: SealSolution) -> style.Picture | None:
    """Line load of some loads around the axis, and the form error; None for a round seal, even with scratches.

    Parameters
    ----------
    result : SealSolution
    """
    chosen_loads = _choose_loads(result)
    if not chosen_loads:
        return None
    figure, (loads, form) = _round_panels()
    over, colour = load_axis(result.loads, result.display), style.load_colours(len(chosen_loads))
    mean = np.ones(361)
    circle = np.linspace(0.0, 2 * math.pi, 361)
    loads.plot(circle, mean, color=GREY, linewidth=1.0, linestyle=(0, (4, 2)), label="mean")
    for n, (load, around) in enumerate(chosen_loads):
        share = around.line_load / around.line_load.mean()
        loads.plot(
            *_close_turn(around.angle, share), color=colour(n), label=over.names[result.loads.index(load)]
        )
    most = max(around.most_over_mean for _, around in chosen_loads)
    loads.set_ylim(0.0, 1.08 * most)
    _round_label(loads, "Line load over its mean")
    loads.legend(title=over.name, loc="center left", bbox_to_anchor=(1.14, 0.5), handlelength=1.4)
    around = chosen_loads[-1][1]
    _form_error(result.display, form, around, circle)
    return style.captioned(
        result.display,
        figure,
        "line_load_around",
        "both",
        "bolts" if around.form.bolts else "",
        "" if around.form.guided or around.tilt else "free",
        **result.case.labels,
    )


def _form_error(display: Display, axes: Axes, around: Circumference, circle: FloatArray) -> None:
    """The change of the gap, drawn as a roundness chart."""
    gap = around.moved_gap
    largest = float(np.abs(gap).max())
    unit = display.unit_for("length", largest)
    heights, base = gap / unit.size, 2.2 * largest / unit.size or 1.0
    axes.plot(circle, np.full_like(circle, base), color=GREY, linewidth=1.0, linestyle=(0, (4, 2)))
    axes.plot(*_close_turn(around.angle, base + heights), color=ORANGE)
    step = _even_step(largest / unit.size)
    axes.set_ylim(0.0, base + 1.25 * largest / unit.size)
    ticks = [-step, 0.0, step] if step else [0.0]
    axes.set_yticks([base + tick for tick in ticks], labels=[_signed(tick) for tick in ticks])
    pressed, tilted = around.bolts_gap is not None, around.tilt is not None
    has_form = bool(around.form.felt_waves) or not (pressed or tilted)
    parts = (pressed, "bolts"), (tilted, "tilt"), (has_form, "form error")
    *before, last = (name for is_part, name in parts if is_part)
    what = f"{', '.join(before)} and {last}" if before else last
    title = f"{what.capitalize()}: change of the gap  [{unit.name}]"
    _round_label(axes, title, own_ticks=True)


def _signed(value: float) -> str:
    return f"{value:+.3g}".replace("-", "−") if value else "0"


def _even_step(largest: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `largest`; 0 for 0."""
    if largest <= 0:
        return 0.0
    power = 10.0 ** math.floor(math.log10(largest * (1 + 1e-9)))
    return power * max(factor for factor in (1.0, 2.0, 5.0) if factor * power <= largest * (1 + 1e-9))


def draw_line_load(axes: Axes, result: SealSolution) -> bool:
    """Line load over its mean around the axis, at some loads.

    Parameters
    ----------
    axes : Axes
    result : SealSolution

    Returns
    -------
    bool
        Whether there is any: not of a round seal.
    """
    chosen_loads, over = _choose_loads(result), load_axis(result.loads, result.display)
    colour = style.load_colours(len(chosen_loads))
    for n, (load, around) in enumerate(chosen_loads):
        share = around.line_load / around.line_load.mean()
        turn, closed = _close_turn(around.angle / _DEGREE, share, 360.0)
        axes.plot(turn, closed, color=colour(n), label=over.names[result.loads.index(load)])
    if chosen_loads:
        axes.set_ylim(0.0)
        axes.legend(title=over.name, loc="best", handlelength=1.4)
        _label_turn(axes, "Line load around the axis", "line load over its mean")
    return bool(chosen_loads)


def leak_around_picture(result: SealSolution) -> style.Picture | None:
    """Leak per degree around the axis at some loads; None where nothing leaks, and for a round seal with scratches.

    Parameters
    ----------
    result : SealSolution
    """
    curves = _leaking_around(result)
    if not curves:
        return None
    figure, (axes,) = style.panels(1, height=3.3)
    draw_leak_around(axes, result)
    rates = [rate for load, _, rates in curves for rate in (rates, *_in_others(load))]
    scratched = any(around.scratches is not None for _, around in _choose_loads(result))
    return style.captioned(
        result.display,
        figure,
        "leak_around",
        "lines",
        "others" if any(_in_others(load) for load, _, _ in curves) else "",
        "sealed" if any((rate == 0).any() for rate in rates) else "",
        "scratches" if scratched else "",
    )


def draw_leak_around(axes: Axes, result: SealSolution) -> bool:
    """Leak per degree around the axis, at some loads.

    Parameters
    ----------
    axes : Axes
    result : SealSolution

    Returns
    -------
    bool
        Whether there is any.
    """
    display = result.display
    curves = _leaking_around(result)
    if not curves:
        return False
    over, colour = load_axis(result.loads, display), style.load_colours(len(curves))
    rates = np.concatenate([rate for _, _, rate in curves])
    unit = display.name_unit(display.unit_for("flow", float(rates.max())), volume_of(result.case))
    for n, (load, angle, rate) in enumerate(curves):
        name = over.names[result.loads.index(load)]
        others, dashed = _in_others(load), {"linestyle": "--", "linewidth": 1.0}
        lines: list[tuple[FloatArray, dict[str, Any]]] = [(rate, {"label": name})]
        lines += [(other, dashed) for other in others]
        for values, how in lines:
            turn, closed = _close_turn(angle / _DEGREE, values / unit.size, 360.0)
            axes.plot(turn, style.positive(closed), color=colour(n), **how)
        rates = np.concatenate([rates, *others])
    if style.spans_decades(rates):
        style.logarithmic(axes, "y")
    else:
        axes.set_ylim(0.0, 1.12 * float(rates.max()) / unit.size)
    axes.legend(title=over.name, loc="best", handlelength=1.4)
    _label_turn(axes, "Leak around the axis", f"leak rate per degree  [{unit.name}]")
    return True


def _leaking_around(result: SealSolution) -> list[tuple[CaseLoad, FloatArray, FloatArray]]:
    """The loads of `_choose_loads` that leak, with their angles [rad] and leak [m^3/s per degree]."""
    return [
        (load, around.angle, around.leak_rate * _DEGREE)
        for load, around in _choose_loads(result)
        if around.leak_rate is not None and np.isfinite(around.leak_rate).all() and around.leak_rate.any()
    ]


def _in_others(load: CaseLoad) -> list[FloatArray]:
    """Leak around the axis in the other readings of yielding asperities [m^3/s per degree]."""
    return [
        scenario.around.leak_rate * _DEGREE
        for scenario in load.others.values()
        if scenario.around and scenario.around.leak_rate is not None
    ]


def _choose_loads(result: SealSolution) -> list[tuple[CaseLoad, Circumference]]:
    """A few loads with their results around the axis, in order of the line load."""
    loads = [result.loads[n] for n in distinct_loads(result.loads)]
    uneven = [(load, load.around) for load in loads if load.around and load.around.form.uneven]
    return [uneven[n] for n in style.few(len(uneven), _LINES)] if uneven else []


def _close_turn(
    angle: FloatArray, values: FloatArray, turn: float = 2 * math.pi
) -> tuple[FloatArray, FloatArray]:
    """Values over a whole turn, with the first repeated at the end."""
    return np.append(angle, turn), np.append(values, values[0])


def _label_turn(axes: Axes, title: str, y: str) -> None:
    """A whole turn on the x axis, in degrees."""
    from matplotlib.ticker import FixedLocator

    style.label(axes, title, "angle around the axis  [°]", y)
    axes.set_xlim(0.0, 360.0)
    axes.xaxis.set_major_locator(FixedLocator(range(0, 361, 45)))


def _round_panels() -> tuple[Figure, Sequence[Axes]]:
    """Two polar axes side by side, with room for a legend between them."""
    from matplotlib.figure import Figure

    height, width, size, right = 3.9, style.WIDTH, 2.85, 0.75
    figure = Figure(figsize=(width, height))
    axes = [
        figure.add_axes((left / width, 0.38 / height, size / width, size / height), projection="polar")
        for left in (0.45, width - size - right)
    ]
    return figure, axes


def _round_label(axes: Axes, title: str, *, own_ticks: bool = False) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.set_title(title, pad=20.0, x=-0.12)
    axes.set_xticks([n * math.pi / 4 for n in range(8)], labels=[f"{45 * n}°" for n in range(8)])
    if not own_ticks:
        axes.yaxis.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 5, 10]))
    axes.tick_params(axis="x", pad=1.0)
    axes.tick_params(axis="y", labelsize=8.0)
    axes.set_rlabel_position(22.5)  # type: ignore[attr-defined]
    for text in axes.get_yticklabels():
        text.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6})
    axes.spines["polar"].set_visible(False)
