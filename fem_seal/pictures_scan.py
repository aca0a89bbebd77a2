"""Picture of a measured surface: its heights and its power spectrum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fem_seal.pictures import BLUE, FILL, GREY, ORANGE, Picture, label, logarithmic, panels, svg
from fem_seal.pictures_surface import wavelength_axis
from fem_seal.readable import number, unit_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from leak import HeightMap, LineScan, MeasuredSurface

FloatArray = NDArray[np.float64]

# More points than this cannot be told apart on paper.
_MOST_POINTS = 3000
_MOST_PIXELS = 400


def scan_picture(surface: MeasuredSurface) -> Picture:
    """Heights of the first scan without form, and the spectrum of all with its error and its fitted power law.

    Parameters
    ----------
    surface : MeasuredSurface
    """
    from leak import LineScan

    figure, (heights, spectrum) = panels(2, height=4.1, head=0.85, ratios=(1.0, 1.15))
    first = surface.scans[0]
    if isinstance(first, LineScan):
        _profile(heights, first)
    else:
        _map(heights, first)
    _spectrum(spectrum, surface)
    wavelength_axis(spectrum, 1.0)
    count = len(surface.scans)
    return Picture(
        "surface",
        svg(figure),
        "Heights of a measured surface without form, and its isotropic power spectrum",
        f"Left: {'the first of ' + str(count) + ' scans' if count > 1 else 'the scan'} without its "
        f"{surface.settings.detrend}. Right: isotropic power spectrum C(q); the band is one standard deviation.",
    )


def _profile(axes: Axes, scan: LineScan) -> None:
    every = max(scan.heights.size // _MOST_POINTS, 1)
    x, h = np.arange(scan.heights.size)[::every] * scan.spacing, scan.heights[::every]
    across, up = unit_for("length", scan.length), unit_for("length", 2 * float(np.abs(h).max()))
    axes.plot(x / across.size, h / up.size, color=BLUE, lw=0.7)
    label(axes, scan.name or "scan", f"x  [{across.name}]", f"height  [{up.name}]")


def _map(axes: Axes, scan: HeightMap) -> None:
    every = max(max(scan.heights.shape) // _MOST_PIXELS, 1)
    h = scan.heights[::every, ::every]
    across, up = unit_for("length", scan.length), unit_for("length", 2 * float(np.abs(h).max()))
    reach = 3.0 * float(h.std()) / up.size
    width, height = (side / across.size for side in scan.size)
    image = axes.imshow(
        h.T / up.size, extent=(0, width, 0, height), origin="lower", cmap="viridis", vmin=-reach, vmax=reach
    )
    axes.grid(False)
    figure = axes.get_figure(root=True)
    assert figure is not None
    figure.colorbar(image, ax=axes, shrink=0.75, label=f"height  [{up.name}]")
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
    logarithmic(axes, "x", "y")
    axes.legend(loc="lower left")
    label(axes, "Power spectrum", "wavenumber q  [1/m]", "C  [m⁴]", above=0.55)
