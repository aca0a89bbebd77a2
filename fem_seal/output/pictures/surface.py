"""Pictures of the rough interface and of its measured scans."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_seal.output.columns import in_words
from fem_seal.output.pictures.colours import BLUE, FILL, GREEN, GREY, ORANGE, PURPLE
from fem_seal.output.pictures.style import (
    Picture,
    captioned,
    draw_marks,
    figure_of,
    inches,
    label,
    panels,
    positive,
)
from fem_seal.seal.findings import AGREE
from fem_seal.seal.load_result import load_name
from fem_seal.seal.problem import exponential_law
from fem_seal.seal.scenarios import SCENARIOS, alternatives_on_contact
from fem_seal.units import number, percent
from leak import RoughContact, TurnedContact

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.units import Display
    from leak import HeightMap, LineScan, MeasuredSurface, TurnedScan

# Fractions below this share of the nominal area are not drawn.
_SMALLEST_AREA = 1e-7


def separation_picture(result: SealSolution) -> Picture | None:
    """Critical separation against contact pressure, with the loads marked; None without roughness.

    Parameters
    ----------
    result : SealSolution
    """
    surface = result.surface
    if surface is None:
        return None
    peaks = np.array([load.peak_pressure for load in result.loads])
    low, high = 0.2 * peaks.min(), 4.0 * peaks.max()
    if surface.hardness is not None:
        high = min(high, max(0.98 * surface.hardness, 1.01 * peaks.max()))
    p = np.geomspace(low, high, 30)
    pressure = result.display.unit_for("contact pressure", float(peaks.max()))
    curves = [(result.loads[0].names[0], surface, ORANGE if surface.hardness is None else BLUE)]
    curves += [
        (scenario.name, scenario.problem.surface or surface, GREEN if words.condition else ORANGE)
        for scenario in alternatives_on_contact(result.problem)
        if (words := SCENARIOS[scenario.name]).curve
    ]
    values = [np.asarray(of.critical_separation(p)) for _, of, _ in curves]
    unit = result.display.unit_for("length", float(max(u.max() for u in values)))
    figure, (axes, shares) = panels(2, height=3.5)
    for (name, _, colour), u in zip(curves, values, strict=True):
        axes.plot(p / pressure.size, positive(u) / unit.size, color=colour, label=SCENARIOS[name].curve)
        dots = [(load.scenario(name) or load).critical_separation for load in result.loads]
        axes.plot(peaks / pressure.size, positive(dots) / unit.size, "o", color=colour, ms=3.8)
    axes.set_ylim(0.0)
    over = f"contact pressure  [{pressure.name}]"
    label(axes, "Critical separation", over, f"u_c  [{unit.name}]", log="x", legend="best")
    _total_areas(shares, surface, p, pressure.size, result.loads)
    label(shares, "Area of real contact", over, "share of the nominal area", log="xy", legend="best")
    return captioned(
        result.display,
        figure,
        "separation",
        "all",
        "beside" if any(_beside_curve(load, surface) for load in result.loads) else "",
        threshold=percent(surface.percolation_threshold) if isinstance(surface, RoughContact) else "",
    )


def _beside_curve(load: CaseLoad, surface: RoughContact | TurnedContact) -> bool:
    """Whether u_c of a load is not that of first loading over unstrained metal."""
    return load.remembers or load.tightest.at_rest(surface).peak_pressure > AGREE * load.peak_pressure


def _total_areas(
    axes: Axes, surface: RoughContact | TurnedContact, p: FloatArray, unit: float, loads: Sequence[CaseLoad]
) -> None:
    axes.plot(
        p / unit,
        np.asarray(surface.contact_area(p)),
        color=BLUE,
        label="with yielding" if surface.hardness else None,
    )
    for load in loads:
        face = load.tightest.surface_at_peak(surface) if isinstance(surface, RoughContact) else surface
        axes.plot(load.peak_pressure / unit, face.contact_area(load.peak_pressure), "o", color=BLUE, ms=3.8)
    if surface.hardness is not None:
        axes.plot(p / unit, np.asarray(surface.elastic.contact_area(p)), color=ORANGE, label="elastic")
    if isinstance(surface, RoughContact):
        threshold = surface.percolation_threshold
        axes.axhline(threshold, color=GREY, linewidth=1.1, linestyle=(0, (4, 2)), label="tight above")


def surface_picture(result: SealSolution, load: CaseLoad) -> Picture | None:
    """Contact area against magnification, and the spectrum before and after yielding; None of a face without them.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        The contact area is that at the peak pressure of this load.
    """
    surface = result.surface
    if not isinstance(surface, RoughContact):
        return None
    peak, surface = load.peak_pressure, load.tightest.surface_at_peak(surface)
    figure, (areas, spectrum) = panels(2, height=4.1, head=0.85)
    _area_curves(areas, surface, peak)
    draw_spectrum(spectrum, surface, peak)
    for view in (areas, spectrum):
        wavelength_axis(result.display, view, 1.0 if view is spectrum else surface.spectrum.q_low)
    plastic = surface.hardness is not None
    share = float(surface.plastic_area(peak)) / float(surface.contact_area(peak)) if plastic else 0.0
    smoothed = surface.smoothed
    return captioned(
        result.display,
        figure,
        "surface",
        "all",
        "plastic" if plastic else "",
        "smoothed" if smoothed else "same",
        load=load_name(load, result.loads, result.display),
        peak=in_words(result.display, load, "peak_pressure_Pa"),
        share="more than 99.9 %" if share > 0.999 else percent(share, 3),
    )


def _area_curves(axes: Axes, surface: RoughContact, peak: float) -> None:
    q = np.geomspace(surface.spectrum.q_low, surface.spectrum.q_high, 120)
    zeta = q / surface.spectrum.q_low
    elastic = np.asarray(surface.elastic_area(peak, q))
    total = elastic
    if surface.hardness is not None:
        plastic = np.asarray(surface.plastic_area(peak, q))
        total = elastic + plastic
        axes.plot(zeta, _hide_small_areas(elastic), color=ORANGE, label="elastic, A_el")
        axes.plot(zeta, _hide_small_areas(plastic), color=PURPLE, label="yielded, A_pl")
        axes.plot(
            zeta,
            np.asarray(surface.elastic.contact_area(peak, q)),
            color=GREY,
            linestyle=(0, (4, 2)),
            linewidth=1.2,
            label="without yielding",
        )
    axes.plot(zeta, total, color=BLUE, linewidth=2.2, label="all contact", zorder=1.9)
    axes.axhline(
        surface.percolation_threshold,
        color=GREY,
        linewidth=1.0,
        linestyle=(0, (1, 1.5)),
        label="first open path",
    )
    axes.set_ylim(max(0.3 * float(total[-1]), _SMALLEST_AREA), 1.6)
    names = "magnification  q/q_low", "share of the nominal area"
    label(axes, "Area in contact", *names, log="xy", legend="lower left", above=0.55)


def _hide_small_areas(area: FloatArray) -> FloatArray:
    return np.where(area > 0.1 * _SMALLEST_AREA, area, np.nan)


def draw_spectrum(
    axes: Axes, surface: RoughContact | TurnedContact, peak: float, above: float = 0.55
) -> None:
    """The power spectrum, and what yielding asperities leave of it under a pressure.

    Parameters
    ----------
    axes : Axes
    surface : RoughContact or TurnedContact
    peak : float
        Pressure [Pa].
    above : float
        Space between axes and title [inch].
    """
    q = _spectrum_points(surface)
    C = np.asarray(surface.spectrum(q))
    axes.plot(q, C, color=BLUE, linewidth=2.0, label="as measured or given")
    bottom = float(C[C > 0].min())
    if (
        isinstance(surface, RoughContact)
        and surface.hardness
        and surface.smoothed
        and peak < surface.hardness
    ):
        smoothed = C * np.asarray(surface.smoothing(peak, q))
        bottom *= 0.05
        axes.plot(q, np.where(smoothed > bottom, smoothed, np.nan), color=PURPLE, label="after yielding")
        axes.legend(loc="lower left")
    axes.set_ylim(0.4 * bottom, 2.5 * float(C.max()))
    names = "wavenumber q  [1/m]", "C(q)  [m⁴]"
    label(axes, "Power spectrum of the roughness", *names, log="xy", above=above)


def _spectrum_points(surface: RoughContact | TurnedContact) -> FloatArray:
    """Wavenumbers that show every kink of the spectrum."""
    spectrum = surface.spectrum
    q = np.geomspace(spectrum.q_low, spectrum.q_high, 160)
    nodes = spectrum.wavenumber if len(spectrum.wavenumber) < 300 else spectrum.wavenumber[::4]
    return np.unique(np.clip(np.concatenate([q, nodes]), spectrum.q_low, spectrum.q_high))


def wavelength_axis(display: Display, axes: Axes, q_low: float) -> None:
    """A second axis at the top with wavelengths."""
    low, high = (x * q_low for x in axes.get_xlim())
    decades = 10.0 ** np.arange(np.ceil(np.log10(2 * np.pi / high)), np.floor(np.log10(2 * np.pi / low)) + 1)
    places = np.column_stack([2 * np.pi / (decades * q_low), np.full(len(decades), axes.get_ylim()[1])])
    shares = (axes.transScale + axes.transLimits).transform(places)[:, 0].tolist()
    draw_marks(axes, shares, [_round_length(display, length) for length in decades], "top")
    axes.spines["top"].set_visible(True)
    _, height = inches(axes)
    axes.text(0.5, 1 + 0.29 / height, "wavelength", transform=axes.transAxes, ha="center", va="bottom")


def _round_length(display: Display, length: float) -> str:
    unit = display.unit_for("length", length)
    return f"{number(round(unit.of(length), 3), 1)} {unit.name}"


def law_picture(result: SealSolution) -> Picture | None:
    """The interface law p(u) that carried the contact; None for a smooth interface.

    Parameters
    ----------
    result : SealSolution
    """
    surface, interface = result.surface, result.case.interface
    peaks = np.array([load.peak_pressure for load in result.loads])
    if interface.law == "smooth":
        return None
    p = np.geomspace(1e-5 * peaks.min(), 8 * peaks.max(), 90)
    if surface is not None and surface.hardness is not None:
        p = p[p < 0.95 * surface.hardness]
    curves: list[tuple[str, FloatArray, str, bool]] = []
    if interface.law == "spectrum" and surface is not None:
        laws = (
            [False, True] if surface.hardness is not None and isinstance(surface, RoughContact) else [False]
        )
        for plastic in laws:
            name = f"p(u) of the {'yielded' if plastic else 'elastic'} surface"
            name = "p(u) of the turned face" if isinstance(surface, TurnedContact) else name
            law = (
                surface.interface_law(surface.hardness is not None)
                if isinstance(surface, TurnedContact)
                else surface.interface_law(plastic)
            )
            gap = np.asarray(law.gap(np.log(p)))
            curves.append((name, gap, PURPLE if plastic else BLUE, plastic == interface.plastic))
        if isinstance(surface, RoughContact) and surface.exponential_at_low_pressure:
            curves.append(("exponential with u₀, p_c", surface.u0 * np.log(surface.p_c / p), GREY, False))
    else:
        u0, p_c = exponential_law(result.case.interface, surface)
        assert u0 is not None and p_c is not None
        curves.append(("exponential", u0 * np.log(p_c / p), BLUE, True))
    unit = result.display.unit_for("length", max(float(gap.max()) for _, gap, _, used in curves if used))
    pressure = result.display.unit_for("contact pressure", float(peaks.max()))
    figure, (axes,) = panels(1, height=3.5, width=5.6)
    for name, gap, colour, used in curves:
        above = gap > 0
        axes.plot(
            gap[above] / unit.size,
            p[above] / pressure.size,
            color=colour,
            linewidth=2.2 if used else 1.3,
            linestyle="-" if used else (0, (4, 2)),
            label=f"{name} (used)" if used and len(curves) > 1 else name,
        )
    axes.axhspan(
        peaks.min() / pressure.size, peaks.max() / pressure.size, color=ORANGE, alpha=0.16, linewidth=0
    )
    if len(peaks) == 1:
        axes.axhline(peaks[0] / pressure.size, color=ORANGE, linewidth=1.0)
    axes.plot([], [], color=ORANGE, alpha=0.3, linewidth=7, label="peak pressures of the loads")
    axes.set_xlim(0.0)
    names = f"mean gap u  [{unit.name}]", f"contact pressure p  [{pressure.name}]"
    label(axes, "Interface law", *names, log="y", legend="upper right")
    return captioned(result.display, figure, "law", "all")


# More points than this cannot be told apart on paper.
_MOST_POINTS = 3000
_MOST_PIXELS = 400


def scan_picture(display: Display, surface: MeasuredSurface) -> Picture:
    """Heights of the first scan without form, and the spectrum of all with its error and its fitted power law.

    Parameters
    ----------
    display : Display
    surface : MeasuredSurface
    """
    from leak import LineScan

    figure, (heights, spectrum) = panels(2, height=4.1, head=0.85, ratios=(1.0, 1.15))
    first = surface.scans[0]
    if isinstance(first, LineScan):
        _profile(display, heights, first)
    else:
        _map(display, heights, first)
    _spectrum(spectrum, surface)
    wavelength_axis(display, spectrum, 1.0)
    count = len(surface.scans)
    return captioned(
        display,
        figure,
        "scan",
        "several" if count > 1 else "one",
        "spectrum",
        count=count,
        form=surface.settings.detrend,
    )


def turned_picture(display: Display, turned: TurnedScan) -> Picture:
    """The first eight feeds of a profile across a turned face, with the mean cusp.

    Parameters
    ----------
    display : Display
    turned : TurnedScan
    """
    figure, (axes,) = panels(1, height=3.5, width=5.6)
    first = turned.position <= 8.0 * turned.feed
    x, h, cusp = turned.position[first], turned.heights[first], turned.cusp[first]
    across, up = display.unit_for("length", float(x[-1])), display.unit_for("length", float(np.ptp(h)))
    axes.plot(x / across.size, h / up.size, color=BLUE, lw=0.7, label="measured")
    axes.plot(x / across.size, cusp / up.size, color=ORANGE, lw=1.6, label="mean cusp")
    names = f"across the lay  [{across.name}]", f"height  [{up.name}]"
    label(axes, "Turned face", *names, legend="best")
    return captioned(display, figure, "turned", "all", feed=turned.feed, share=turned.periodic_share)


def _profile(display: Display, axes: Axes, scan: LineScan) -> None:
    step = max(scan.heights.size // _MOST_POINTS, 1)
    x, h = np.arange(scan.heights.size)[::step] * scan.spacing, scan.heights[::step]
    across = display.unit_for("length", scan.length)
    up = display.unit_for("length", 2 * float(np.abs(h).max()))
    axes.plot(x / across.size, h / up.size, color=BLUE, lw=0.7)
    label(axes, scan.name or "scan", f"x  [{across.name}]", f"height  [{up.name}]")


def _map(display: Display, axes: Axes, scan: HeightMap) -> None:
    step = max(max(scan.heights.shape) // _MOST_PIXELS, 1)
    h = scan.heights[::step, ::step]
    across = display.unit_for("length", scan.length)
    up = display.unit_for("length", 2 * float(np.abs(h).max()))
    reach = 3.0 * float(h.std()) / up.size
    width, height = (side / across.size for side in scan.size)
    image = axes.imshow(
        h.T / up.size, extent=(0, width, 0, height), origin="lower", cmap="viridis", vmin=-reach, vmax=reach
    )
    figure_of(axes).colorbar(image, ax=axes, shrink=0.75, label=f"height  [{up.name}]")
    label(axes, scan.name or "map", f"x  [{across.name}]", f"y  [{across.name}]")


def _spectrum(axes: Axes, surface: MeasuredSurface) -> None:
    q, C = surface.measured.wavenumber, surface.measured.density
    band = np.exp(np.minimum(surface.log_error, 3.0))
    axes.fill_between(q, C / band, C * band, color=FILL, lw=0)
    if surface.spectrum != surface.measured:
        axes.plot(surface.spectrum.wavenumber, surface.spectrum.density, "--", color=GREY, label="continued")
    axes.plot(q, C, color=BLUE, label="measured")
    fit = surface.rolloff
    if fit.hurst is not None and fit.hurst > 0.0:
        ends = np.array([fit.start, fit.end])
        middle = np.sqrt(fit.start * fit.end)
        law = surface.measured(middle) * (ends / middle) ** (-2.0 * (1.0 + fit.hurst))
        axes.plot(ends, law, ":", color=ORANGE, label=f"Hurst exponent {number(fit.hurst, 2)}")
    names = "wavenumber q  [1/m]", "C  [m⁴]"
    label(axes, "Power spectrum", *names, log="xy", legend="lower left", above=0.55)
