"""Which piece of a surface is simulated: the wavelengths that a grid can hold, and what is left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from leak.arrays import FloatArray
from leak.errors import DirectError, positive, um
from leak.surfaces.random import random_map
from leak.surfaces.scans import HeightMap
from leak.surfaces.spectrum import PowerSpectrum


@dataclass(frozen=True)
class Patch:
    """A square of random roughness on a grid.

    It holds the waves of a spectrum from one per side to a number of grid points per wave; everything else is cut.

    Parameters
    ----------
    spectrum : PowerSpectrum
        Of the whole surface.
    points : int
        Grid points along a side.
    size : float
        Side [m].
    points_per_wave : float
        Grid points on the shortest wave, at least 2.
    peklenik : float
        Stretch of the surface, see `leak.random_map`.

    Raises
    ------
    DirectError
        Fewer than eight points, fewer than two per wave, or no wave of the spectrum fits.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e7)
    >>> patch = leak.direct.Patch.of(spectrum, points=256)
    >>> print(f"{1e6 * patch.size:.0f} um, {1e6 * patch.shortest_wavelength:.1f} um")
    931 um, 14.5 um
    >>> print(f"{patch.height_cut:.3f} of the height and {patch.slope_cut:.2f} of the slope are cut")
    0.018 of the height and 0.80 of the slope are cut
    """

    spectrum: PowerSpectrum
    points: int
    size: float
    points_per_wave: float = 4.0
    peklenik: float = 1.0

    def __post_init__(self) -> None:
        if self.points != int(self.points) or self.points < 8:
            raise DirectError(f"points = {self.points!r}: must be a whole number from 8 on")
        if not self.points_per_wave >= 2.0:
            raise DirectError(f"points_per_wave = {self.points_per_wave!r}: must be at least 2")
        positive(DirectError, "size", self.size, "m")
        low, high = self.band
        if not low < high:
            raise DirectError(
                f"size = {um(self.size)} with {self.points} points holds waves of {um(self.shortest_wavelength)} to "
                f"{um(self.size)}; the spectrum has {um(2.0 * np.pi / self.spectrum.q_high)} to "
                f"{um(2.0 * np.pi / self.spectrum.q_low)}"
            )

    @classmethod
    def of(
        cls,
        spectrum: PowerSpectrum,
        *,
        points: int = 512,
        size: float | None = None,
        waves: float = 8.0,
        points_per_wave: float = 4.0,
        peklenik: float = 1.0,
    ) -> Patch:
        """A patch over the waves that make the height, which decide the gap and thereby the leak.

        Parameters
        ----------
        spectrum, points, points_per_wave, peklenik
            See `Patch`.
        size : float or None
            Side [m]; unless given, `waves` of the wavelength above which half of the height variance lies.
        waves : float
            See `size`.
        """
        if size is None:
            size = waves * 2.0 * np.pi / spectrum.median_wavenumber
        return cls(spectrum, points, size, points_per_wave, peklenik)

    @property
    def shortest_wavelength(self) -> float:
        """Shortest wave that the grid holds, or the shortest of the spectrum if that is longer [m]."""
        return max(self.points_per_wave * self.size / self.points, 2.0 * np.pi / self.spectrum.q_high)

    @property
    def band(self) -> tuple[float, float]:
        """Wavenumbers that the patch holds [1/m]; the first wave of the side counts from half of it on."""
        low = np.pi / self.size
        # the last wave on a grid line, q = 2 pi k/L, must not be lost to rounding
        return max(low, self.spectrum.q_low), 2.0 * np.pi / self.shortest_wavelength * (1.0 + 1e-9)

    @property
    def grid_spectrum(self) -> PowerSpectrum:
        """The part of the spectrum that the patch holds."""
        return self.spectrum.between(*self.band)

    @property
    def height_cut(self) -> float:
        """Share of the height variance that is cut, long and short waves together [-]."""
        return float(1.0 - self.grid_spectrum.rms_height**2 / self.spectrum.rms_height**2)

    @property
    def slope_cut(self) -> float:
        """Share of the slope variance that is cut [-]."""
        return float(1.0 - self.grid_spectrum.rms_slope**2 / self.spectrum.rms_slope**2)

    def heights(self, seed: int, amplitudes: Literal["gaussian", "exact"] = "exact") -> FloatArray:
        """A sample, shape (points, points) [m]; see `leak.random_map`."""
        return random_map(
            self.grid_spectrum,
            size=self.size,
            points=self.points,
            seed=seed,
            peklenik=self.peklenik,
            amplitudes=amplitudes,
        )


def refined(heights: FloatArray, points: int) -> FloatArray:
    """The same periodic map on a finer grid, or smoothed onto a coarser one: its waves go on between the points.

    Parameters
    ----------
    heights : ndarray, shape (n, n)
        [m]
    points : int
        Points along a side of the new map. Waves that it cannot hold are cut.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import refined
    >>> wave = np.cos(2.0 * np.pi * np.arange(8) / 8)[:, None] * np.ones(8)
    >>> bool(np.allclose(refined(wave, 16)[::2, ::2], wave))
    True
    """
    n = heights.shape[0]
    count = min(n, points) // 2
    waves, new_waves = np.fft.fft2(heights), np.zeros((points, points), dtype=complex)
    # without the wave of two points, which has no phase
    k = np.arange(-count + 1, count)
    new_waves[np.ix_(k, k)] = waves[np.ix_(k, k)]
    return np.asarray(np.real(np.fft.ifft2(new_waves))) * (points / n) ** 2


def smoothed(heights: FloatArray, size: float, shortest_wavelength: float) -> FloatArray:
    """The same periodic map without its shortest waves: a second cutoff to compare with.

    Parameters
    ----------
    heights : ndarray, shape (n, n)
        [m]
    size : float
        Side [m].
    shortest_wavelength : float
        What is kept [m].

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import smoothed
    >>> wave = np.cos(2.0 * np.pi * np.arange(8) / 8)[:, None] * np.ones(8)
    >>> float(np.abs(smoothed(wave, 1.0, 1.5)).max()) < 1e-12
    True
    """
    n = heights.shape[0]
    k = np.fft.fftfreq(n, 1.0 / n)
    keep = np.hypot(k[:, None], k[None, :]) <= size / shortest_wavelength * (1.0 + 1e-9)
    return np.asarray(np.real(np.fft.ifft2(np.fft.fft2(heights) * keep)))


def periodic_map(
    measured: HeightMap, *, points: int | None = None, continuation: Literal["mirror", "window"] = "mirror"
) -> tuple[FloatArray, float]:
    """A periodic square of a measured map, which ends somewhere and does not fit itself there.

    The largest square in the middle is taken, its mean plane removed.

    Parameters
    ----------
    measured : HeightMap
    points : int or None
        Along a side of the result; those of the map within its square unless given. Fewer points cut the shortest
        waves, more invent nothing.
    continuation : "mirror" or "window"
        "mirror" puts the square's mirror images beside it: all heights count, the side is twice as long with four
        copies of the same asperities, and ridges or valleys may arise where mirrored slopes meet. "window" keeps the
        side and brings a tenth of it at each edge down to the mean: nothing is doubled, but the border is smoother
        than the surface and its asperities are lower; the heights are scaled back to their rms.

    Returns
    -------
    heights : ndarray, shape (n, n)
        [m]
    size : float
        Side [m].

    Raises
    ------
    DirectError
        The square has fewer than eight points along a side, or `continuation` is neither word.

    Examples
    --------
    >>> import numpy as np, leak
    >>> x = np.linspace(0.0, 1.0, 20, endpoint=False)
    >>> bumps = leak.height_map(np.sin(9 * x)[:, None] * np.cos(7 * x), (1e-5, 1e-5))
    >>> heights, size = leak.direct.periodic_map(bumps)
    >>> heights.shape, round(size, 6)
    ((40, 40), 0.0004)
    """
    flat, spacing = measured.without_form("tilt"), measured.spacing
    L = min(measured.size)
    n = int(L / max(spacing) + 1e-9)
    if n < 8:
        raise DirectError(f"a map of {flat.heights.shape} points: its square needs at least 8 along a side")
    h = _square(flat.heights, spacing, L, n)
    h -= h.mean()
    if continuation == "mirror":
        h, L = np.block([[h, h[:, ::-1]], [h[::-1], h[::-1, ::-1]]]), 2.0 * L
    elif continuation == "window":
        rms, edge = h.std(), np.minimum(np.arange(n) + 0.5, n - 0.5 - np.arange(n)) / (0.1 * n)
        weight = np.where(edge < 1.0, 0.5 - 0.5 * np.cos(np.pi * np.minimum(edge, 1.0)), 1.0)
        h = h * weight[:, None] * weight[None, :]
        h -= h.mean()
        h *= rms / h.std()
    else:
        raise DirectError(f"continuation = {continuation!r}: must be 'mirror' or 'window'")
    return (h if points is None else refined(h, points)), L


def _square(heights: FloatArray, spacing: tuple[float, float], L: float, n: int) -> FloatArray:
    """Heights at the centres of n x n cells of the square in the middle, linear between points."""
    h = heights
    for axis in (0, 1):
        count, step = h.shape[axis], spacing[axis]
        start = 0.5 * (count * step - L)
        at = (start + (np.arange(n) + 0.5) * L / n) / step - 0.5
        at = np.clip(at, 0.0, count - 1.0)
        low = np.minimum(at.astype(int), count - 2)
        weight = (at - low).reshape((-1, 1) if axis == 0 else (1, -1))
        h = (1.0 - weight) * np.take(h, low, axis) + weight * np.take(h, low + 1, axis)
    return h
