"""Pictures of the leak rate: over the loads, on first loading and after larger loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.contact.solution import largest_before
from fem_seal.output.case_words import earlier_load
from fem_seal.output.pictures.colours import BLUE, GREEN, GREY, INK, ORANGE
from fem_seal.output.pictures.style import (
    NARROW,
    Picture,
    captioned,
    label,
    number_dots,
    panels,
    positive,
    scale_over_loads,
    svg,
)
from fem_seal.seal.load_result import load_axis, load_name
from fem_seal.seal.scenarios import FIRST_LOADING, SCENARIOS
from fem_seal.units import format_digits, percent
from fem_seal.wording import say

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.arrays import FloatArray


def leak_picture(result: SealSolution) -> Picture | None:
    """Leak rate of every load with its interval, and of elastic asperities; None if none was calculated.

    Parameters
    ----------
    result : SealSolution
    """
    loads, _ = leaking_loads(result)
    if not loads:
        return None
    if len(loads) == 1:
        return _single_leak(result, loads[0])
    over = load_axis(loads, result.display)
    figure, (axes,) = panels(1, height=3.5, width=NARROW)
    draw_leak(axes, result, with_scenarios=True)
    both = "plastic_both" if any(load.others for load in loads) else ""
    return captioned(result.display, figure, "leak", "all", over.order, both, over=over.name)


def draw_leak(axes: Axes, result: SealSolution, *, with_scenarios: bool = False) -> bool:
    """The leak rate over the loads with its interval and what is allowed.

    Parameters
    ----------
    axes : Axes
    result : SealSolution
    with_scenarios : bool
        With the other readings of the asperities.

    Returns
    -------
    bool
        False, and nothing drawn, if no leak rate was calculated.
    """
    display = result.display
    loads, ends = leaking_loads(result)
    if not loads:
        return False
    over, rates = load_axis(loads, display), leak_rates(loads)
    outside = np.array([load.validity.outside_theory for load in loads])
    curves = _curves(result, loads)
    visible = np.concatenate([values for _, values, _, _ in curves if with_scenarios] or [rates])
    volume = volume_of(result.case)
    unit = display.shared_flow_unit((*rates, *ends.flat) if rates.any() else (*visible,))
    for name, values, colour, width in curves if with_scenarios else curves[:1]:
        how: dict[str, Any] = {"color": colour, "linewidth": 0.8 if over.order_matters else width}
        axes.plot(over.numbers, positive(values) / unit.size, "o-", ms=3.8, label=name, **how)
    _mark_outside(axes, over.numbers, positive(rates) / unit.size, outside)
    if np.isfinite(ends).any():
        sampled, (low, high) = result.uncertainty, ends.T / unit.size
        name = "interval" if sampled is None else f"{percent(sampled.confidence)} interval of the result"
        edge = 6.0 if len(loads) == 1 else 0.0  # one load has no area
        axes.fill_between(over.numbers, low, high, color=BLUE, alpha=0.15, linewidth=edge, label=name)
    _mark_at_foot(axes, over.numbers[(rates == 0) & ~outside], "sealed: nothing leaks", INK)
    required = result.case.requirement
    if required is not None and required.leak_rate is not None:
        visible = np.append(visible, required.leak_rate)
        axes.axhline(required.leak_rate / unit.size, color=ORANGE, linestyle="--", label="allowed")
    scale_over_loads(axes, over, visible)
    least, most = axes.get_ylim()
    # space for the legend above the curves, and above the bar of one load, which "best" does not see
    if axes.get_yscale() == "log":
        axes.set_ylim(least, most * (most / least) ** (0.5 if len(loads) == 1 else 0.3))
    elif len(loads) == 1:
        axes.set_ylim(least, most + 0.5 * (most - least))
    if over.returns:
        number_dots(axes, over.numbers, rates / unit.size, [result.loads.index(load) + 1 for load in loads])
    place = "upper right" if len(loads) == 1 else "best"
    label(axes, "Leak rate", over.label, f"leak rate  [{display.name_unit(unit, volume).name}]", legend=place)
    return True


def _curves(result: SealSolution, loads: Sequence[CaseLoad]) -> list[tuple[str, FloatArray, str, float]]:
    """Names, leak rates [m^3/s], colours and widths of the result, first, and of what is compared with it."""
    rates = leak_rates(loads)
    yielded = SCENARIOS[loads[0].names[0]].curve
    curves = [(f"{yielded} (result)", rates, BLUE, 2.2)]
    if loads[0].after_test:
        medians = np.array([load.leak_rate_p50 or 0.0 for load in loads])
        curves = [
            ("median after the leak test", medians, BLUE, 2.2),
            (f"{yielded} (before it)", rates, GREY, 1.5),
        ]
    curves += [(SCENARIOS[name].curve, values, GREEN, 1.5) for name, values in _rates_of_scenarios(loads)]
    for name in loads[0].scenarios:
        words = SCENARIOS[name]
        values = leak_rates([load.scenarios[name] for load in loads])
        if words.curve and not words.condition and np.isfinite(values).any():
            curves.append((f"{words.curve}, for comparison", values, ORANGE, 1.5))
    return curves


def _rates_of_scenarios(loads: Sequence[CaseLoad]) -> list[tuple[str, FloatArray]]:
    """The scenarios beside, with their leak rates [m^3/s]."""
    pairs = [
        (scenario, leak_rates([load.scenarios[scenario] for load in loads])) for scenario in loads[0].others
    ]
    return [(scenario, values) for scenario, values in pairs if np.isfinite(values).any()]


def leaking_loads(result: SealSolution) -> tuple[list[CaseLoad], FloatArray]:
    """Loads in the order in which they are drawn, and both ends of their leak rates [m^3/s], NaN where none are known.

    A seal that the fluid has lifted open has no finite rate to draw.
    """
    pairs = [
        (load, ends or (np.nan, np.nan))
        for load, ends in zip(result.loads, result.leak_ranges, strict=True)
        if load.leak and np.isfinite(load.leak.leak_rate)
    ]
    # in their order where a body yields: the leak at the same pressure differs before and after a higher one
    if not result.unloaded_bodies:
        pairs.sort(key=lambda pair: pair[0].point)
    return [load for load, _ in pairs], np.array([ends for _, ends in pairs])


def leak_rates(loads: Sequence[CaseLoad]) -> FloatArray:
    """The leak rate of each load, NaN where none was calculated [m^3/s]."""
    return np.array([load.leak.leak_rate if load.leak else np.nan for load in loads])


def _single_leak(result: SealSolution, load: CaseLoad) -> Picture:
    """Bars for a case with one load."""
    outside = load.validity.outside_theory
    at = load_name(load, result.loads, result.display) + (", outside the theory" if outside else "")
    zero, digits = "zero" if outside else "sealed", load.leak_digits
    series = [(name, float(values[0]), colour) for name, values, colour, _ in _curves(result, [load])]
    volume = volume_of(result.case)
    assert load.leak is not None  # only such loads are drawn
    unit = result.display.shared_flow_unit(
        (*_ends([load]).flat,) if load.leak.leak_rate else [rate for _, rate, _ in series]
    )
    figure, (axes,) = panels(1, height=1.1 + 0.42 * len(series), width=7.2)
    names = [name for name, _, _ in series]
    values = [unit.of(rate) for _, rate, _ in series]
    bars = axes.barh(range(len(series)), values, color=[colour for _, _, colour in series], height=0.55)
    texts = [f"{format_digits(value, min(digits, 3))} {unit.name}" if value else zero for value in values]
    axes.bar_label(bars, texts, padding=4)
    axes.set_xlim(0.0, 1.25 * max(*values, 1e-30))
    axes.set_yticks([])
    for n, name in enumerate(names):
        axes.text(0.004, n - 0.31, name, transform=axes.get_yaxis_transform(), va="bottom")
    axes.set_ylim(len(series) - 0.6, -0.8)
    label(axes, f"Leak rate at {at}", f"leak rate  [{result.display.name_unit(unit, volume).name}]", "")
    return Picture(
        "leak",
        svg(figure),
        f"Leak rate at {at}: "
        + ", ".join(f"{name} {heading}" for name, heading in zip(names, texts, strict=True)),
        say(result.display, "captions", "leak_single"),
    )


def _mark_at_foot(axes: Axes, x: FloatArray, name: str | None, fill: str) -> None:
    """Mark loads without leak at the foot of a logarithmic axis, which cannot show zero."""
    if x.size:
        foot = {"transform": axes.get_xaxis_transform(), "clip_on": False}
        axes.plot(x, np.full(x.shape, 0.02), "v", ms=6, mec=INK, mfc=fill, label=name, **cast("Any", foot))


def _mark_outside(axes: Axes, x: FloatArray, rates: FloatArray, outside: NDArray[np.bool_]) -> None:
    """Mark loads outside the theory by hollow dots; those with a calculated zero are at the foot."""
    name = "outside the theory: nothing to claim"
    marked = outside & np.isfinite(rates)
    if marked.any():
        axes.plot(x[marked], rates[marked], "o", ms=5, mec=BLUE, mfc="white", zorder=4, label=name)
    _mark_at_foot(axes, x[outside & ~marked], None if marked.any() else name, "white")


# Depth of a band below the smallest leak rate where its lower end is a sealed contact.
_FOOT = 0.1


def memory_picture(result: SealSolution) -> Picture | None:
    """Leak rate of every load on first loading and after the loads before it; None without a load history.

    Parameters
    ----------
    result : SealSolution
    """
    display = result.display
    if result.surface is None or result.surface.hardness is None:
        return None
    loads = [load for load in result.loads if load.leak is not None]
    contacts = [contact for load in result.loads for contact in load.contacts]
    if not loads or not (largest_before(contacts) or any(load.remembers for load in loads)):
        return None
    if result.unloaded_bodies is None:
        loads.sort(key=lambda load: load.point)
    over = load_axis(loads, display)
    earlier = earlier_load(display, result.case.load) or "the loads before it"
    first, after = _ends([load.scenarios.get(FIRST_LOADING, load) for load in loads]), _ends(loads)
    unit = display.name_unit(display.shared_flow_unit((*first.flat, *after.flat)), volume_of(result.case))
    figure, (axes,) = panels(1, height=3.6, width=NARROW)
    for name, ends, colour in (("first loading", first, ORANGE), (f"after {earlier}", after, BLUE)):
        _band(axes, over.numbers, ends / unit.size, colour, name)
    scale_over_loads(axes, over, np.concatenate([first, after]), 0.7)
    if over.returns:
        numbers = [result.loads.index(load) + 1 for load in loads]
        number_dots(axes, over.numbers, after[:, 1] / unit.size, numbers)
    title = "Leak rate on first loading and after a larger load"
    label(axes, title, over.label, f"leak rate  [{unit.name}]", legend="best")
    both = "both" if any(load.others for load in loads) else ""
    bodies = "bodies" if result.unloaded_bodies else ""
    return captioned(display, figure, "memory", "rates", both, bodies, over=over.name, earlier=earlier)


def _ends(loads: Sequence[CaseLoad]) -> FloatArray:
    """Smaller and larger leak rate of the readings of yielding asperities, shape (loads, 2) [m^3/s]."""
    return np.array([load.leak_range or (load.leak.leak_rate,) * 2 for load in loads if load.leak])


def _band(axes: Axes, x: FloatArray, ends: FloatArray, colour: str, name: str) -> None:
    """The interval of the readings at each load, down to the foot where one of them is sealed."""
    leaks = ends[ends > 0]
    foot = _FOOT * float(leaks.min()) if leaks.size else 0.0
    low, high = np.where(ends > 0, ends, foot).T
    axes.fill_between(x, low, high, color=colour, alpha=0.18, linewidth=0)
    axes.vlines(x, low, high, color=colour, linewidth=1.0, alpha=0.6)
    for values, legend_entry in zip(ends.T, (None, name), strict=True):
        axes.plot(x, positive(values), "o-", color=colour, linewidth=1.3, ms=3.4, label=legend_entry)
