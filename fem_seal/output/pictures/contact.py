"""Pictures of the contact and of the bodies: contact enlarged, pressure profiles and gap; mesh, stress, imprint."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem_seal.bodies.fields import BodyField, ElastoplasticField
from fem_seal.contact.solution import plastic_zone
from fem_seal.output.columns import in_words
from fem_seal.output.pictures import style
from fem_seal.output.pictures.colours import BLUE, GREEN, GREY, INK, ORANGE
from fem_seal.output.pictures.style import Picture, captioned, label, panels
from fem_seal.seal.load_result import LoadAxis, distinct_loads, load_axis, load_name
from fem_seal.seal.surface_profile import SurfaceProfile
from fem_seal.units import Unit
from fem_seal.wording import say

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet

    from fem_seal.answers.case_load import CaseLoad, SolvedSeal
    from fem_seal.answers.closed_forms import ClosedForm, ClosedForms, Sizes
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.contact.load_path import UnloadedBodies
    from fem_seal.units import Display
    from meshes import ContactGeometry, SealMesh


# More lines than this get a colour scale instead of names.
_NAMED_LOADS = 6
# Size of a picture with one panel [inch].
_NARROW = 6.4
# More lines than this cannot be told apart.
_DRAWN_LOADS = 40
# Size of the picture of the enlarged contact [inch]; height of its section over the gap, of one contact and of lands;
# share of the peak pressure from which on a land presses; colours of the bodies.
_ENLARGED, _HEADROOM, _PRESSED = (style.NARROW, 3.6), (1.3, 4.0), 0.01
_FACES = {"closure": "#c9dcf0", "seat": "#e6dcc6"}
_ON_FLUID = {"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 1.5}
_CLOSED_FORMS = {
    "hertz": ("Hertz", GREY, (0, (1, 1.2))),
    "gaussian": ("Gaussian", GREEN, (0, (5, 1.5, 1, 1.5))),
    "crossover": ("crossover", ORANGE, (0, (4, 2))),
}


def profile_picture(result: SealSolution, derived: ClosedForms) -> style.Picture:
    """Pressure profiles of all loads, and the lowest and highest load compared with the closed forms.

    Parameters
    ----------
    result : SealSolution
    derived : ClosedForms
        Closed forms of the case.
    """
    display = result.display
    loads = result.loads
    order = distinct_loads(loads)
    closed = not result.of_profile and not math.isinf(result.model.relative_radius)
    singles = ([order[-1]] if len(order) == 1 else [order[0], order[-1]]) if closed else []
    together = len(order) > 1 or not closed
    figure, axes = style.panels(len(singles) + together, height=3.7, width=style.WIDTH if closed else _NARROW)
    length = display.unit_for("length", _reach(loads))
    if together:
        all_profiles(display, axes[0], loads, order, length)
    for view, n in zip(axes[len(axes) - len(singles) :], singles, strict=True):
        _against_closed_forms(
            display, view, loads[n], load_name(loads[n], loads, display), derived.loads[n], length
        )
    of_map = isinstance(result.highest.whole_profile, SurfaceProfile)
    start = "across" if of_map else "start" if result.case.has_shapes else "centre"
    words = [start, "mean" if result.highest.circumference is not None else ""]
    if not closed:
        words += [] if result.of_profile else ["conforming"]
    else:
        words += ["hertz", "gaussian" if result.case.interface.law != "smooth" else ""]
    return style.captioned(display, figure, "profiles", *words, closed=closed)


def all_profiles(
    display: Display, axes: Axes, loads: Sequence[CaseLoad], order: Sequence[int], length: Unit
) -> None:
    """The pressure profiles of all different loads.

    Parameters
    ----------
    display : Display
    axes : Axes
    loads : sequence of CaseLoad
    order : sequence of int
        Numbers of those that are drawn, from `fem_seal.seal.load_result.distinct_loads`.
    length : Unit
        Of x.
    """
    pressure = display.unit_for("contact pressure", max(load.peak_pressure for load in loads))
    colour = style.load_colours(len(order))
    over = load_axis(loads, display)
    numbers = style.few(len(order), _DRAWN_LOADS)
    named = [numbers[n] for n in style.few(len(numbers), _NAMED_LOADS if len(numbers) <= _NAMED_LOADS else 4)]
    for n in numbers:
        name = over.names[order[n]] if n in named else None
        _plot_profiles(
            axes, loads[order[n]], "pressure", length, pressure, name, color=colour(n), linewidth=1.2
        )
    axes.set_xlim(*(end / length.size for end in _range_in_view(loads)))
    axes.set_ylim(0.0)
    axes.legend(title=over.name, loc="upper right", handlelength=1.2, borderpad=0.1)
    title = (
        f"All {len(loads)} loads" if len(order) <= _DRAWN_LOADS else f"{_DRAWN_LOADS} of {len(order)} loads"
    )
    if len(order) == 1:
        title = load_name(loads[order[0]], loads, display)
    style.label(axes, title, f"x  [{length.name}]", f"contact pressure  [{pressure.name}]")


def draw_profiles(axes: Axes, result: SealSolution) -> None:
    """The pressure profiles of all different loads, with what they are as the title.

    Parameters
    ----------
    axes : Axes
    result : SealSolution
    """
    loads = result.loads
    length = result.display.unit_for(
        "length", max(float(np.ptp(profile.x)) for load in loads for profile in load.profiles) / 4
    )
    all_profiles(result.display, axes, loads, distinct_loads(loads), length)
    axes.set_title("Contact pressure")


def _plot_profiles(
    axes: Axes, load: CaseLoad, measure: str, length: Unit, unit: Unit, name: str | None, **how: Any
) -> None:
    """Pressure or gap of a load across its contact lines, which have one name in the legend."""
    for number, profile in enumerate(load.profiles):
        x, y = profile.x / length.size, getattr(profile, measure) / unit.size
        axes.plot(x, y, label=None if number else name, **how)


def _against_closed_forms(
    display: Display, axes: Axes, load: CaseLoad, name: str, closed: ClosedForm, length: Unit
) -> None:
    reach = _reach([load])
    # Hertz may be many times higher; in full height it would flatten all other curves.
    top = 1.75 * load.peak_pressure
    pressure = display.unit_for("contact pressure", top)
    for key, (form_name, colour, dashes) in _CLOSED_FORMS.items():
        form = getattr(closed, key)
        if form is not None:
            # all are even functions; the crossover is smooth and needs an integral for each point
            half = np.linspace(0.0, reach, 61 if key == "crossover" else 181)
            right = np.asarray(form.pressure(half)) / pressure.size
            x, y = np.append(-half[:0:-1], half), np.append(right[:0:-1], right)
            cut = form.peak_pressure > top
            peak = f", peak {display.quantity(form.peak_pressure, 'contact pressure')}" if cut else ""
            how: dict[str, Any] = {"color": colour, "linestyle": dashes, "linewidth": 1.4, "zorder": 3}
            axes.plot(x / length.size, y, label=form_name + peak, **how)
    _plot_profiles(axes, load, "pressure", length, pressure, "calculated", color=BLUE, linewidth=2.4)
    axes.set_xlim(-reach / length.size, reach / length.size)
    axes.set_ylim(0.0, top / pressure.size)
    axes.legend(loc="upper right", handlelength=1.9, borderpad=0.1)
    style.label(axes, f"{name}, closed forms", f"x  [{length.name}]", f"contact pressure  [{pressure.name}]")


def size_picture(result: SealSolution, sizes: Mapping[str, Sizes]) -> style.Picture | None:
    """Peak pressure and width at every load, compared with the closed forms; None if there is only one.

    Parameters
    ----------
    result : SealSolution
    sizes : mapping
        From `fem_seal.answers.closed_forms.profile_sizes`.
    """
    display = result.display
    if len(result.loads) == 1:
        return None
    over = load_axis(result.loads, display)
    figure, axes = style.panels(2, height=3.3)
    peak = _draw_sizes(display, axes[0], over, sizes, "peak_pressure", "contact pressure")
    style.label(axes[0], "Peak contact pressure", over.label, f"peak pressure  [{peak.name}]")
    width = _draw_sizes(display, axes[1], over, sizes, "fwhm", "length")
    style.label(axes[1], "Width of the contact", over.label, f"full width at half maximum  [{width.name}]")
    lands = "lands" if len(result.highest.profiles) > 1 else ""
    gaussian = "gaussian" if "gaussian" in sizes else ""
    return style.captioned(display, figure, "sizes", "all", lands, gaussian, over.order, over=over.name)


def _draw_sizes(
    display: Display, axes: Axes, over: LoadAxis, sizes: Mapping[str, Sizes], measure: str, kind: str
) -> Unit:
    """One measure of the profiles over the loads; returns its unit."""
    x, order = over.numbers, np.argsort(over.values)
    calculated = getattr(sizes["calculated"], measure)
    unit = display.unit_for(kind, float(calculated.max()))
    for name, (text, colour, dashes) in _CLOSED_FORMS.items():
        if name in sizes:
            y = getattr(sizes[name], measure)[order] / unit.size
            axes.plot(x[order], y, color=colour, linestyle=dashes, label=text)
    dots = "o-" if over.order_matters else "o"
    axes.plot(x, calculated / unit.size, dots, color=BLUE, linewidth=0.8, ms=4.5, label="calculated")
    scales = ["x"] if x.min() > 0 and style.spans_decades(x) else []
    if measure == "peak_pressure" and style.spans_decades(calculated):
        scales.append("y")
    else:
        # A closed form far outside its range must not flatten the other curves.
        # points on the frame cannot be read
        highest = max(axes.get_ylim()[1], 1.15 * float(calculated.max()) / unit.size)
        axes.set_ylim(0.0, min(highest, 5 * float(calculated.max()) / unit.size))
    style.logarithmic(axes, *scales)
    if over.returns:
        style.number_dots(axes, x, calculated / unit.size, range(1, len(x) + 1))
    if len(axes.lines) > 1:
        axes.legend(loc="best")
    return unit


def draw_gap(axes: Axes, result: SealSolution) -> None:
    """The mean gap between the surfaces at a few loads.

    Parameters
    ----------
    axes : Axes
    result : SealSolution
    """
    display = result.display
    chosen, (low, high) = _few_loads(result.loads, display), _range_in_view(result.loads)
    widest = max(_widest_gap(load, low, high, 0.0) for load, _, _ in chosen)
    gap, length = display.unit_for("length", widest), display.unit_for("length", max(-low, high))
    for load, name, colour in chosen:
        _plot_profiles(axes, load, "gap", length, gap, name, color=colour)
    axes.set_ylim(0.0, 1.08 * widest / gap.size or 1.0)
    style.label(axes, "Mean gap between the surfaces", f"x  [{length.name}]", f"gap  [{gap.name}]")
    axes.set_xlim(low / length.size, high / length.size)
    axes.legend(title=load_axis(result.loads, display).name, loc="best", handlelength=1.4)


def _few_loads(loads: Sequence[CaseLoad], display: Display) -> list[tuple[CaseLoad, str, Any]]:
    """A few different loads with their names and colours."""
    order, names = distinct_loads(loads), load_axis(loads, display).names
    chosen = [order[n] for n in style.few(len(order), 4)]
    colour = style.load_colours(len(chosen))
    return [(loads[n], names[n], colour(place)) for place, n in enumerate(chosen)]


def contact_picture(result: SealSolution, load: CaseLoad) -> style.Picture:
    """The contact enlarged: its pressure, and below it the section with the gap through which the fluid leaks.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        The load that is shown.
    """
    display = result.display
    from matplotlib.figure import Figure

    figure = Figure(figsize=_ENLARGED)
    above, below = figure.subplots(
        2, 1, gridspec_kw={"left": 0.125, "right": 0.985, "bottom": 0.14, "top": 0.97, "hspace": 0.0}
    )
    whole, (low, high) = load.whole_profile, _range_in_view([load])
    low, high = max(low, float(whole.x[0])), min(high, float(whole.x[-1]))
    length = display.unit_for("length", max(-low, high))
    pressure = display.unit_for("contact pressure", load.peak_pressure)
    top = _HEADROOM[len(load.profiles) > 1] * _widest_gap(load, low, high, _PRESSED) or 1e-6
    gap, flows = display.unit_for("length", top), load.leak is not None and 0 < load.leak.leak_rate < np.inf
    share = np.zeros(whole.x.size)
    if flows and load.leak is not None:
        share = load.leak.fluid_pressure / max(float(load.leak.fluid_pressure.max()), 1e-300)
    x, u = whole.x / length.size, np.minimum(whole.gap, 2.0 * top) / gap.size
    above.fill_between(x, whole.pressure / pressure.size, color=ORANGE, alpha=0.35, linewidth=0)
    above.plot(x, whole.pressure / pressure.size, color=ORANGE)
    below.fill_between(x, -top / gap.size, 0.0, color=_FACES["seat"], linewidth=0)
    below.fill_between(x, u, 2.0 * top / gap.size, color=_FACES["closure"], linewidth=0)
    # one colour between two points
    filled = below.pcolormesh(
        np.stack([x, x]), np.stack([0.0 * u, u]), share[None, 1:], cmap="Blues", vmin=-0.1, vmax=1.3
    )
    filled.set_rasterized(True)
    below.plot(x, u, color=INK, linewidth=0.8)
    below.plot(x, 0.0 * x, color=INK, linewidth=0.8)
    above.set_xlim(low / length.size, high / length.size)
    above.set_xticks([])
    above.set_ylim(0.0, 1.08 * load.peak_pressure / pressure.size)
    below.set_xlim(low / length.size, high / length.size)
    below.set_ylim(-0.3 * top / gap.size, top / gap.size)
    # one at the upper end would stand on the zero of the pressure
    below.set_yticks([tick for tick in below.get_yticks() if 0.0 <= tick <= 0.88 * top / gap.size])
    width, height = style.inches(below)
    times = (high - low) / width / (1.3 * top / height)
    how: dict[str, Any] = {"transform": below.transAxes, "va": "center", "bbox": _ON_FLUID}
    # where the bodies touch: between lands the closure is far above
    pressed = load.tightest.x[load.tightest.pressure > 0.5 * load.peak_pressure]
    middle = (float(pressed.mean()) - low) / (high - low)
    for at, name in ((0.93, "closure"), (0.06, "seat")):
        below.text(middle, at, result.case.label_of(name), ha="center", color=INK, **how)
    if flows:
        name = display.quantity(load.fluid_pressure, "given fluid pressure")
        inside = share[0] > share[-1]
        at, text, side = (0.01, f"{name} →", "left") if inside else (0.99, f"← {name}", "right")
        below.text(at, 0.93, text, ha=side, color=BLUE, **how)
        drop = "pressure drop\n0 to 100 %"
        over = {**how, "transform": above.transAxes, "zorder": 3}
        above.text(at, 0.68, drop, ha=side, color=BLUE, **over)
        # from zero to the peak, which is the whole drop
        above.plot(x, share * load.peak_pressure / pressure.size, color=BLUE, linestyle="--")
    style.label(above, "", "", f"contact pressure  [{pressure.name}]")
    style.label(below, "", f"x  [{length.name}]", f"gap  [{gap.name}]")
    name = load_name(load, result.loads, display)
    how_much = "alike" if 0.95 < times < 1.05 else "heights" if times > 1.0 else "widths"
    enlarged = say(display, "captions", f"contact_{how_much}", times=times, less=1.0 / times)
    values = {"load": name, "enlarged": enlarged, **result.case.labels}
    return style.captioned(display, figure, "contact", "all", "flow" if flows else "", **values)


def _widest_gap(load: CaseLoad, low: float, high: float, pressed: float) -> float:
    """Widest gap in view [m]; of lands only where more than a share of the peak presses: between is a chamber."""
    parts = [
        p.gap[
            p.pressure > pressed * load.peak_pressure if load.profiles[1:] else (p.x >= low) & (p.x <= high)
        ]
        for p in load.profiles
    ]
    return max(float(part.max(initial=0.0)) for part in parts)


def _range_in_view(loads: Sequence[CaseLoad]) -> tuple[float, float]:
    """x between which the profiles are shown [m]: around first touch, or all lands, or what does not lie there."""
    if all(len(load.profiles) == 1 and abs(load.tightest.centroid) < load.tightest.std for load in loads):
        return -_reach(loads), _reach(loads)
    pressed = np.concatenate(
        [
            profile.x[profile.pressure > 1e-3 * load.peak_pressure]
            for load in loads
            for profile in load.profiles
        ]
    )
    border = 0.1 * float(np.ptp(pressed))
    return float(pressed.min()) - border, float(pressed.max()) + border


def _reach(loads: Sequence[CaseLoad]) -> float:
    """Largest distance from first touch that the profiles show [m]."""
    profiles = [profile for load in loads for profile in load.profiles]
    return float(min(3.8 * max(p.std for p in profiles), max(np.abs(p.x).max() for p in profiles)))


IntArray = NDArray[np.int64]

# A quadratic triangle as four linear ones.
QUARTERS = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]
_BANDS = 12
_MOST_LINES = 10_000
# Space for the numbers and the name of a colour scale [inch].
SCALE_ROOM = 0.8
# Height of a view of the contact zone, over its width.
HEIGHT = 0.8


def mesh_picture(result: SealSolution, load: CaseLoad) -> Picture:
    """The whole mesh, and the contact zone.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        Its width sets how much of the contact zone is shown.
    """
    seal_mesh, quality, size = result.seal_mesh, result.seal_mesh.quality, result.display.fixed_unit("mm")
    mesh, contact = seal_mesh.mesh, seal_mesh.contact
    figure, (whole, zone) = panels(2, height=4.4, ratios=(1.0, 1.35))
    for name, colour in (("closure", BLUE), ("seat", "#8a6d3b")):
        edges = _edges(mesh.t[:, (mesh.subdomains or {})[name]])
        # an image: a drawing of so many lines is larger
        many = edges.shape[1] > _MOST_LINES
        whole.plot(*_polyline(mesh.p / size.size, edges), color=colour, linewidth=0.25, rasterized=many)
        place = turned(seal_mesh, mesh.p.T).T
        half = half_width(load)
        close = (np.abs(place[:, edges]).min(axis=1) < 1.8 * half).all(axis=0)
        unit = result.display.unit_for("length", 2 * half)
        zone.plot(*_polyline(place / unit.size, edges[:, close]), color=colour, linewidth=0.55)
    whole.set_aspect("equal")
    label(whole, "Both bodies", f"r  [{size.name}]", f"z  [{size.name}]")
    whole.plot(contact.initial_contact_radius / size.size, 0.0, "o", mfc="none", mec=ORANGE, ms=9, mew=1.6)
    frame_zone(zone, half / unit.size, unit.name, "Contact zone, turned so that the contact lies flat")
    smallest = float(np.diff(result.model.line.vertices).min())
    return captioned(
        result.display,
        figure,
        "mesh",
        "all",
        quality=quality,
        unknowns=sum(body.fem.size for body in result.model.bodies.values()),
        size=smallest,
    )


def stress_picture(result: SealSolution, load: CaseLoad) -> Picture:
    """von Mises stress under the contact, in two magnifications.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        The load to show.
    """
    display = result.display
    figure, axes = panels(2, height=4.3, side=SCALE_ROOM)
    fields = load.contact.fields
    unit = display.unit_for("contact pressure", load.max_von_mises)
    half = half_width(load)
    levels = even_levels(0.0, unit.of(load.max_von_mises))
    stresses = {name: unit.of(1.0) * field.von_mises for name, field in fields.items()}
    _draw_zone(axes[0], result, fields, stresses, levels, 4.0 * half, "Around the contact")
    bands = _draw_zone(axes[1], result, fields, stresses, levels, half, "Under the contact")
    scale_of_colours(axes, bands, f"von Mises stress  [{unit.name}]")
    body, r, z = load.max_von_mises_at
    largest_at = turned(result.seal_mesh, np.array([[r, z]]))[0]
    # of several lands the enlarged one need not have it
    for view, reach in zip(axes, (4.0 * half, half), strict=True):
        if np.all(np.abs(largest_at) < reach):
            view.plot(
                *(largest_at / display.unit_for("length", 2 * reach).size), "x", color=INK, ms=6, mew=1.2
            )
    depth = float(largest_at[1])
    return captioned(
        display,
        figure,
        "stress",
        "all",
        largest=in_words(display, load, "max_von_mises_Pa"),
        body=result.case.label_of(body),
        **result.case.labels,
        load=load_name(load, result.loads, display),
        depth=abs(depth),
        digits=load.digits_of("fwhm"),
        side="below" if depth < 0 else "above",
    )


def temperature_picture(result: SealSolution, load: CaseLoad) -> Picture | None:
    """Temperature of both bodies, the whole section and around the contact; None unless it was calculated.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        Its width sets how much of the contact zone is shown.
    """
    fields = load.contact.fields
    size, degree = result.display.fixed_unit("mm"), result.display.unit_for("temperature", 300.0)
    degrees = {
        name: (f.temperature - degree.zero) / degree.size
        for name, f in fields.items()
        if f.temperature is not None
    }
    if result.problem.at_rest.heating is None or len(degrees) < len(fields):
        return None
    low, high = (end(float(end(values)) for values in degrees.values()) for end in (min, max))
    # a uniform temperature has one colour
    levels = even_levels(low, max(high, low + 1e-3))
    figure, axes = panels(2, height=4.4, side=SCALE_ROOM)
    for name, field in fields.items():
        _fill_bands(axes[0], field.points / size.size, field, degrees[name], levels, "inferno")
    axes[0].set_aspect("equal")
    label(axes[0], "Both bodies", f"r  [{size.name}]", f"z  [{size.name}]")
    reach = 8.0 * half_width(load)
    bands = _draw_zone(axes[1], result, fields, degrees, levels, reach, "Around the contact", "inferno")
    scale_of_colours(axes, bands, f"temperature  [{degree.name}]")
    contact = load.contact_temperature
    assert contact is not None  # both fields are known
    low, high = low + 273.15, high + 273.15
    return captioned(result.display, figure, "temperature", "all", low=low, high=high, contact=contact)


def half_width(load: CaseLoad) -> float:
    """Half the width of the enlarged views along the contact [m]."""
    return 4.2 * load.std


def turned(seal_mesh: SealMesh, points: FloatArray) -> FloatArray:
    """(r, z) in the frame of the contact: along the tangent, along the normal; shape (n, 2) [m]."""
    contact = seal_mesh.contact
    n_r, n_z = contact.normal(np.zeros(1))[:, 0]
    r, z = points[:, 0] - contact.initial_contact_radius, points[:, 1]
    return np.column_stack([r * n_z - z * n_r, r * n_r + z * n_z])


def near(place: FloatArray, triangles: IntArray, reach: float) -> IntArray:
    """Triangles of which a part may lie within `reach` of first touch."""
    # the triangles on the last axis are compared all at once
    corners = place.T[:, triangles.T]
    low, high = corners.min(axis=1), corners.max(axis=1)
    inside = (low < reach) & (high > -reach)
    return np.asarray(triangles[inside.all(axis=0)])


def even_levels(low: float, high: float, count: int = _BANDS) -> FloatArray:
    """Ends of about `count` bands of colours at round numbers, from `low` to beyond `high`."""
    from matplotlib.ticker import MaxNLocator

    return np.asarray(MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))


def _fill_bands(
    axes: Axes,
    place: FloatArray,
    field: BodyField,
    values: FloatArray,
    levels: ArrayLike,
    colours: str,
    reach: float = math.inf,
) -> ContourSet:
    """Values in the points of a body as bands of colours, where it lies within `reach` of first touch."""
    from matplotlib.tri import Triangulation

    triangles = near(place, field.triangles6[:, QUARTERS].reshape(-1, 3), reach)
    return axes.tricontourf(
        Triangulation(place[:, 0], place[:, 1], triangles), values, levels=levels, cmap=colours
    )


def _draw_zone(
    axes: Axes,
    result: SolvedSeal,
    fields: Mapping[str, BodyField],
    values: Mapping[str, FloatArray],
    levels: ArrayLike,
    reach: float,
    title: str,
    colours: str = "YlOrRd",
) -> ContourSet:
    """Both bodies within `reach` of first touch [m], with bands of colours where a body has values."""
    length, bands = result.display.unit_for("length", 2 * reach), []
    for name, field in fields.items():
        place = turned(result.seal_mesh, field.points) / length.size
        if name in values:
            bands.append(_fill_bands(axes, place, field, values[name], levels, colours, reach / length.size))
        axes.plot(*place[field.contact_nodes].T, color=INK, linewidth=0.8)
    frame_zone(axes, reach / length.size, length.name, title)
    return bands[-1]


def scale_of_colours(axes: Sequence[Axes], bands: ContourSet, text: str, *, lowest: str = "") -> None:
    """The colour scale next to the last of the axes, in `SCALE_ROOM`; `lowest` replaces its first number."""
    bar = style.figure_of(axes[0]).colorbar(
        bands, ax=axes, fraction=0.03, pad=0.015, aspect=28, format="%.3g"
    )
    if lowest:
        ticks = bar.get_ticks().tolist()
        bar.set_ticks(ticks, labels=[lowest, *(f"{tick:.3g}" for tick in ticks[1:])])
    bar.set_label(text)
    bar.outline.set_linewidth(0.5)


def frame_zone(axes: Axes, reach: float, unit: str, title: str) -> None:
    """Limits and labels of a view of the contact zone."""
    axes.set_aspect("equal")
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-HEIGHT * reach, HEIGHT * reach)
    label(axes, title, f"along the contact, outwards  [{unit}]", f"along the normal  [{unit}]")


def _edges(triangles: IntArray) -> IntArray:
    """Edges of triangles, each of them once, shape (2, n)."""
    first, second = np.sort(np.hstack([triangles[[0, 1]], triangles[[1, 2]], triangles[[2, 0]]]), axis=0)
    # one number for both ends: a search for unique rows is much slower
    count = int(triangles.max()) + 1
    return np.stack(np.divmod(np.unique(first.astype(np.int64) * count + second), count))


def _polyline(points: FloatArray, edges: IntArray) -> FloatArray:
    """x and y of all edges in one broken line."""
    ends = points[:, edges]
    gaps = np.full((2, 1, edges.shape[1]), np.nan)
    return np.concatenate([ends, gaps], axis=1).transpose(0, 2, 1).reshape(2, -1)


_COLOURS = {"seat": BLUE, "closure": ORANGE}
# Shown width to each side in widths of the imprint, and shown height in depths of the yielded zone.
_WIDTHS, _DEPTHS = 1.6, 1.5
_STRAIN_BANDS = 10


def imprint_picture(result: SealSolution) -> Picture | None:
    """The permanent imprint, and the plastic strain below it; None if nothing has yielded.

    Parameters
    ----------
    result : SealSolution
    """
    yielded = [part for part in result.parts if part.unloaded_bodies and part.unloaded_bodies.imprints]
    if not yielded:
        return None
    # of several the first one that has yielded
    part, unloaded = yielded[0], yielded[0].unloaded_bodies
    assert unloaded is not None
    figure, (depth, strain) = panels(2, height=4.0, side=SCALE_ROOM)
    _imprints(result.display, depth, unloaded, part.problem.contact)
    _strains(strain, part, unloaded)
    digits = result.strongest.digits_of("fwhm")
    imprints = "; ".join(
        say(
            result.display,
            "captions",
            "imprint_one",
            body=part.problem.contact.label_of(name),
            imprint=imprint,
            digits=digits,
        )
        for name, imprint in unloaded.imprints.items()
    )
    return captioned(result.display, figure, "imprint", "all", imprints=imprints)


def _imprints(display: Display, axes: Axes, unloaded: UnloadedBodies, contact: ContactGeometry) -> None:
    imprints = unloaded.imprints
    reach = max(_WIDTHS * imprint.width + abs(imprint.deepest_at) for imprint in imprints.values())
    length = display.unit_for("length", reach)
    height = display.unit_for("length", max(imprint.deepest for imprint in imprints.values()))
    for name, imprint in imprints.items():
        label_of = contact.label_of(name)
        axes.plot(imprint.x / length.size, imprint.depth / height.size, color=_COLOURS[name], label=label_of)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_xlim(-reach / length.size, reach / length.size)
    axes.invert_yaxis()
    label(axes, "Permanent imprint", f"x  [{length.name}]", f"depth  [{height.name}]", legend="best")


def _strains(axes: Axes, result: SolvedSeal, unloaded: UnloadedBodies) -> None:
    """Plastic strain of all bodies that yield."""
    fields = {n: field for n, field in unloaded.fields.items() if isinstance(field, ElastoplasticField)}
    materials = result.problem.materials
    plastic_zones = {name: plastic_zone(field, materials[name]) for name, field in fields.items()}
    zones = {name: zone for name, zone in plastic_zones.items() if zone is not None}
    widest = max(imprint.width for imprint in unloaded.imprints.values())
    reach = max(_WIDTHS * widest, *(_DEPTHS / HEIGHT * zone.deepest for zone in zones.values()))
    largest = max(float(field.accumulated_plastic_strain.max()) for field in fields.values())
    # few digits, so that the numbers of the scale fit
    size, unit = (1e-2, "%") if largest > 1e-3 else (1e-6, "10⁻⁶")
    largest /= size
    # elastic zones stay white
    levels = [largest / 100, *even_levels(0.0, largest, _STRAIN_BANDS)[1:]]
    strains = {name: field.accumulated_plastic_strain / size for name, field in fields.items()}
    bands = _draw_zone(axes, result, unloaded.fields, strains, levels, reach, "Plastic strain")
    scale_of_colours([axes], bands, f"accumulated plastic strain  [{unit}]", lowest="0")
