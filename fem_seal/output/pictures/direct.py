"""Pictures of a direct simulation compared with the theory: curves over pressure, maps of contact and flow, seal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.output.pictures.colours import BLUE, FILL, GREEN, GREY, INK, ORANGE, PURPLE
from fem_seal.output.pictures.style import Picture, captioned, label, panels, positive
from fem_seal.seal.direct import DirectTable, PressedMap
from leak.theory.plasticity import READINGS, Reading

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

    from fem_seal.seal.direct_seal import SealRow
    from fem_seal.units import Display

# Largest number of cells along a side in a drawing.
_MOST_CELLS = 512
# Flux below this share of the largest one is drawn as zero.
_FAINT = 1e-3


def simulation_pictures(display: Display, table: DirectTable, pressure: float) -> tuple[Picture, ...]:
    """Curves, and the map at the simulated pressure nearest to a given one.

    Parameters
    ----------
    display : Display
    table : DirectTable
    pressure : float
        [Pa]
    """
    nearest = min(
        table.simulation.settings.pressures, key=lambda simulated: abs(np.log(simulated / pressure))
    )
    return curves_picture(display, table), map_picture(display, table, nearest)


def curves_picture(display: Display, table: DirectTable) -> Picture:
    """Contact area, mean gap and effective gap over pressure, loading and unloading, compared with the theory.

    Parameters
    ----------
    display : Display
    table : DirectTable
    """
    load = [row for row in table.rows if row.branch == "load"]
    back = [row for row in table.rows if row.branch == "unload"]
    pressure = display.unit_for("contact pressure", load[-1].pressure)
    length = display.unit_for("length", max(load[0].mean_gap, load[0].effective_gap))
    figure, (areas, gaps, flow) = panels(3, height=3.6)
    p, q = (np.array([row.pressure for row in rows]) / pressure.size for rows in (load, back))
    theory = [row.theory for row in load if row.theory is not None]

    falling: dict[str, Any] = {"color": GREEN, "ms": 4.2, "label": "unloading" if back else None}

    for axes, name, size in ((areas, "contact_area", 1.0), (gaps, "mean_gap", length.size)):
        mean, scatter, expected, after = (
            np.array([getattr(row, key) for row in rows]) / size
            for key, rows in ((name, load), (f"{name}_scatter", load), (name, theory), (name, back))
        )
        spread = np.nan_to_num(scatter)
        axes.errorbar(p, mean, spread, fmt="o", color=BLUE, ms=3.8, label="simulated", capsize=2)
        axes.plot(p, expected, color=ORANGE, label="theory")
        if axes is areas and any(row.yielded_area > 0.0 for row in load):
            yielded = [row.yielded_area for row in load]
            axes.plot(p, yielded, "s", mfc="none", color=PURPLE, ms=3.8, label="yielded")
        axes.plot(q, after, "v", **falling)
    over = f"pressure  [{pressure.name}]"
    label(areas, "Contact area", over, "share of the nominal area", log="xy", legend="best")
    gaps.set_ylim(0.0)
    label(gaps, "Mean gap", over, f"gap  [{length.name}]", log="x")

    u = np.array([row.effective_gap for row in load]) / length.size
    low, high = np.array([table.ends(row) for row in load]).T / length.size
    flows = u > 0.0
    flow.fill_between(p[flows], low[flows], high[flows], color=FILL, lw=0)
    flow.plot(p[flows], u[flows], "o", color=BLUE, ms=3.8, label="simulated")
    readings = READINGS["paper"] if len(table.simulation.surface.readings) > 1 else (Reading.CAPPED,)
    for reading in readings:
        theory_gaps = np.array([row.gap[reading] for row in theory]) / length.size
        name = f"theory, {reading}" if len(readings) > 1 else "theory"
        colour = PURPLE if reading is Reading.CONSERVED else ORANGE
        flow.plot(p, positive(theory_gaps), "-", color=colour, label=name)
    after = np.array([row.effective_gap for row in back]) / length.size
    flow.plot(q, positive(after), "v", **falling)
    open_ = bool(np.any(flow.dataLim.intervaly > 0.0) and np.isfinite(flow.dataLim.intervaly).all())
    if not open_:
        # all is tight: a logarithmic axis needs positive numbers
        flow.set(xlim=areas.get_xlim(), ylim=(0.0, 1.0))
    label(flow, "Effective gap", over, f"u_eff  [{length.name}]", log="xy" if open_ else "x", legend="best")
    return captioned(display, figure, "direct", "curves")


def map_picture(display: Display, table: DirectTable, pressure: float) -> Picture:
    """Contact, gap and flow of the first sample at a pressure; the fluid flows from left to right.

    The mark is the critical junction, the cell with the largest pressure drop.

    Parameters
    ----------
    display : Display
    table : DirectTable
    pressure : float
        One of those of loading [Pa].
    """
    from matplotlib.colors import ListedColormap, LogNorm

    simulation = table.simulation
    pressed = table.press_sample(pressure)
    if simulation.settings.direction == "y":
        pressed = PressedMap(pressed.gap.T.copy(), pressed.touches.T, pressed.yielded.T)
    gap, touches, yielded = pressed
    flow, paths = pressed.flow()
    size = display.unit_for("length", simulation.patch.size)
    height = display.unit_for("length", float(gap.max()) or 1e-6)
    figure, (left, right) = panels(2, height=5.0, width=10.4, side=0.3)
    side = simulation.patch.size / size.size
    # rows of the array are positions along the flow, which is drawn to the right
    extent = (0.0, side, 0.0, side)

    def show(axes: Axes, values: FloatArray, **how: Any) -> AxesImage:
        step = max(1, values.shape[0] // _MOST_CELLS)
        return axes.imshow(
            values[::step, ::step].T, origin="lower", extent=extent, interpolation="nearest", **how
        )

    image = show(left, np.where(touches, np.nan, gap / height.size), cmap="Blues", vmin=0.0)
    figure.colorbar(image, ax=left, shrink=0.8, label=f"gap  [{height.name}]")
    show(left, np.where(touches, 1.0, np.nan), cmap=ListedColormap([GREY]))
    if simulation.asperities != "elastic":
        show(left, np.where(touches & yielded, 1.0, np.nan), cmap=ListedColormap([ORANGE]))
    show(right, np.where(touches, 1.0, np.nan), cmap=ListedColormap(["#d9dde3"]))
    if flow.gap_cubed > 0.0:
        most = float(paths.flux.max())
        flux = np.where(paths.flux > _FAINT * most, paths.flux, np.nan)
        image = show(right, flux, cmap="viridis", norm=LogNorm(_FAINT * most, most))
        figure.colorbar(image, ax=right, shrink=0.8, label="flow over its mean")
        i, j = np.unravel_index(int(np.argmax(paths.loss)), paths.loss.shape)
        x, y = ((k + 0.5) * side / gap.shape[0] for k in (i, j))
        for axes in (left, right):
            axes.plot(x, y, "o", mfc="none", mec=INK, ms=11, mew=1.6)
    at = display.quantity(pressure, "contact pressure")
    label(left, f"Contact and gap at {at}", f"along the flow  [{size.name}]", f"across  [{size.name}]")
    label(right, "Flow" if flow.gap_cubed > 0.0 else "Tight", f"along the flow  [{size.name}]", "")
    spans = "open" if flow.gap_cubed > 0.0 else "tight"
    return captioned(
        display,
        figure,
        "direct_map",
        "all",
        simulation.asperities,
        spans,
        pressure=at,
    )


_COLOURS = {"elastic": BLUE, "capped": ORANGE, "von-mises": GREEN}


def seal_picture(display: Display, rows: Sequence[SealRow]) -> Picture:
    """Pressure across the contact of the highest load, and leak rates over the fluid pressure.

    Parameters
    ----------
    display : Display
    rows : sequence of SealRow
    """
    highest = max(row.place.fluid_pressure for row in rows)
    strips = [row for row in rows if row.place.fluid_pressure == highest]
    place = strips[0].place
    strips = [row for row in strips if row.place is place]
    figure, (pressures, leaks) = panels(2, height=3.8)
    length = display.unit_for("length", place.strip.width)
    stress = display.unit_for("contact pressure", strips[0].measures[0])
    n = place.strip.points[0]
    x = ((np.arange(n) + 0.5) / n - 0.5) * place.strip.width
    for row in strips:
        pressures.plot(
            x / length.size,
            row.profile / stress.size,
            color=_COLOURS[row.asperities],
            lw=0.8,
            label=row.asperities,
        )
    profile = place.profile
    pressures.plot(
        (profile.x - profile.centroid) / length.size, profile.pressure / stress.size, color=INK, label="chain"
    )
    pressures.set_xlim(x[0] / length.size, x[-1] / length.size)
    title = f"Contact pressure at {display.quantity(highest, 'fluid pressure')}, {place.name}"
    label(pressures, title, f"x  [{length.name}]", f"pressure  [{stress.name}]", legend="best")
    fluid = display.unit_for("fluid pressure", highest)
    flow = display.unit_for("flow", max(row.leak_rate for row in rows))
    for name in dict.fromkeys(row.place.name for row in rows):
        for kind, colour in _COLOURS.items():
            points = [row for row in rows if row.asperities == kind and row.place.name == name]
            if points:
                p = np.array([row.place.fluid_pressure for row in points]) / fluid.size
                rates = np.array([row.leak_rate for row in points]) / flow.size
                error = [
                    2.0 * np.nan_to_num(row.deviation) / len(row.leak_rates) ** 0.5 / flow.size
                    for row in points
                ]
                what = kind if name == "round" else f"{kind}, {name}"
                mark = "s" if name == "most loaded" else "o"
                leaks.errorbar(p, rates, error, fmt=mark, color=colour, ms=3.8, capsize=2, label=what)
    first = [
        row for row in rows if row.asperities == rows[0].asperities and row.place.name == rows[0].place.name
    ]
    p = np.array([row.place.fluid_pressure for row in first]) / fluid.size
    leaks.plot(
        p, np.array([row.chain_held for row in first]) / flow.size, color=INK, label="chain, same waves"
    )
    ends = [row.place.interval for row in first]
    if all(ends):
        low, high = np.array([pair for pair in ends if pair is not None]).T / flow.size
        leaks.fill_between(p, low, high, color=FILL, lw=0, label="chain, interval")
    names = f"fluid pressure  [{fluid.name}]", f"leak rate  [{flow.name}]"
    label(leaks, "Leak rate", *names, log="y", legend="best")
    return captioned(display, figure, "direct_seal", "caption")
