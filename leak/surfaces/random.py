"""Gaussian surfaces of a given spectrum, with a stated seed: line scans and maps to try a method on."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ScanError, positive
from leak.surfaces.line_spectrum import profile_density
from leak.surfaces.spectrum import PowerSpectrum

# A scan is cut out of a periodic one this many times longer, so that its ends know nothing of each other.
_LONGER = 2


def random_line_scan(
    spectrum: PowerSpectrum, *, length: float, points: int, seed: int
) -> tuple[FloatArray, FloatArray]:
    """Heights along a straight line over a Gaussian isotropic surface.

    Parameters
    ----------
    spectrum : PowerSpectrum
        C(q) of the surface. Waves shorter than two points are left out, as a low-pass filter would.
    length : float
        Length of the scan [m].
    points : int
        Number of points.
    seed : int
        Of the random numbers: the same seed gives the same scan.

    Returns
    -------
    x, h : ndarray, shape (points,)
        Position and height [m]; the scan is not periodic.

    Raises
    ------
    ScanError
        `length` is not positive, or there are fewer than two points.

    Examples
    --------
    >>> spectrum = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> x, h = random_line_scan(spectrum, length=0.05, points=20_000, seed=1)
    >>> bool(abs(h.std() / 1e-6 - 1) < 0.02)
    True
    """
    L = positive(ScanError, "length", length, "m")
    n = _count("points", points)
    total = _LONGER * n
    deviation = _deviations(spectrum, _LONGER * L, total // 2)
    random = np.random.default_rng(seed)
    amplitude = np.zeros(total // 2 + 1, dtype=complex)
    amplitude[1:-1] = deviation * (random.standard_normal((deviation.size, 2)) @ [0.5, 0.5j]) * total
    return L / n * np.arange(n, dtype=np.float64), np.fft.irfft(amplitude, total)[:n]


# several scans of one surface differ in their random numbers
@lru_cache(maxsize=4)
def _deviations(spectrum: PowerSpectrum, length: float, count: int) -> FloatArray:
    """Standard deviation [m] of the waves of which 1, 2, ... `count` - 1 fit in a length [m]."""
    q = 2.0 * np.pi * np.arange(1, count) / length
    return np.sqrt(2.0 * np.asarray(profile_density(spectrum, q)) * q[0])


def random_map(
    spectrum: PowerSpectrum,
    *,
    size: float,
    points: int | tuple[int, int],
    seed: int,
    peklenik: float = 1.0,
    amplitudes: Literal["gaussian", "exact"] = "gaussian",
) -> FloatArray:
    """Heights of a rectangular piece of a random surface.

    Parameters
    ----------
    spectrum : PowerSpectrum
        C(q) of the isotropic surface.
    size : float
        First side of the piece [m].
    points : int or tuple of int
        Number of points along a side of a square, or along both sides; they are as far apart in both directions.
    seed : int
        Of the random numbers.
    peklenik : float
        Correlation length along x over the one along y; both change by its square root, so that the mean
        spectrum keeps its place [-].
    amplitudes : "gaussian" or "exact"
        Whether only the mean square of each wave's amplitude follows the spectrum, as of a piece cut out of a
        Gaussian surface, or each amplitude itself, the phases alone being random: then every map has the same rms
        height and slope.

    Returns
    -------
    ndarray, shape (points, points) or points
        Heights [m], index 0 along x; periodic.

    Raises
    ------
    ScanError
        A value is not positive, there are fewer than two points, or `amplitudes` is neither word.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> heights = leak.random_map(spectrum, size=1e-3, points=128, seed=1)
    >>> heights.shape
    (128, 128)
    """
    L = positive(ScanError, "size", size, "m")
    stretch = np.sqrt(positive(ScanError, "peklenik", peklenik, "-"))
    n, m = (_count("points", one) for one in (points if isinstance(points, tuple) else (points, points)))
    q, across = (2.0 * np.pi * np.fft.fftfreq(one, L / n) for one in (n, m))
    C = np.asarray(spectrum(np.hypot(q[:, None] * stretch, across[None, :] / stretch)))
    white = np.fft.fft2(np.random.default_rng(seed).standard_normal((n, m)))
    if amplitudes == "exact":
        white *= np.sqrt(n * m) / np.abs(white)
    elif amplitudes != "gaussian":
        raise ScanError(f"amplitudes = {amplitudes!r}: must be 'gaussian' or 'exact'")
    return np.real(np.fft.ifft2(white * np.sqrt(C) * (2.0 * np.pi / L) * n))


def _count(name: str, value: int) -> int:
    if value != int(value) or value < 2:
        raise ScanError(f"{name} = {value!r}: must be a whole number from 2 on")
    return int(value)
