"""Gaussian surfaces of a given spectrum: the spectrum of their line scans, and scans and maps with a stated seed."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from leak.arrays import FloatArray
from leak.errors import ScanError, positive
from leak.numerics.curves import divide_stretches
from leak.surfaces.periodogram import edge_distance
from leak.surfaces.spectrum import PowerSpectrum

# Pieces of constant C, this long in ln q, stand for a power law; C_1D is good to 2e-4 for C ~ q^-4.
_PIECE = 0.005


def profile_density(spectrum: PowerSpectrum, wavenumber: ArrayLike) -> FloatArray | float:
    """One-dimensional spectrum C_1D of a line scan across an isotropic surface.

    C_1D(q) = 2 int_q^inf C(k) k dk / sqrt(k^2 - q^2), with <h^2> = int_{-inf}^{inf} C_1D dq.

    Parameters
    ----------
    spectrum : PowerSpectrum
        C(q) of the surface.
    wavenumber : array_like
        q, any shape, not negative [1/m].

    Returns
    -------
    ndarray or float
        C_1D, the shape of `wavenumber` [m^3]. Other conventions differ by factors: the one-sided density over
        q is twice this, the one-sided density over 1/wavelength 4 pi times.

    References
    ----------
    F. J. Fischer, K. Schmitz, A. Tiwari, B. N. J. Persson, Tribol. Lett. 68, 125 (2020).

    Examples
    --------
    >>> flat = PowerSpectrum([1.0, 100.0], [1.0, 1.0])
    >>> bool(abs(profile_density(flat, 60.0) - 160.0) < 1e-9)    # 2 sqrt(100^2 - 60^2)
    True
    """
    q = np.atleast_1d(np.asarray(wavenumber, dtype=float))
    edges = np.exp(divide_stretches(np.log(np.unique(spectrum.wavenumber)), _PIECE))
    C = np.asarray(spectrum(np.sqrt(edges[1:] * edges[:-1])))
    # `abel_weights` @ C, summed by what C falls by at each edge
    falls = -2.0 * np.diff(C, prepend=0.0, append=0.0)

    def of(part: FloatArray) -> FloatArray:
        # edges below all of q add nothing
        first = np.searchsorted(edges, part.min(initial=np.inf))
        return edge_distance(part, edges[first:]) @ falls[first:]

    density = np.concatenate([of(part) for part in np.array_split(q.ravel(), q.size // 2000 + 1)])
    return float(density[0]) if np.ndim(wavenumber) == 0 else density.reshape(q.shape)


# Wavenumbers over which the square of a profile's spectrum is summed.
_SUM_NODES = 2000


def height_scatter(spectrum: PowerSpectrum, length: float) -> float:
    """Standard deviation of ln of the rms height that line scans of a surface have [-].

    Of Gaussian heights, for scans much longer than the longest waves that matter: of n independent pieces of them
    (2 n)^(-1/2), n = length (int C_1D dq)^2/(2 pi int C_1D^2 dq).

    Parameters
    ----------
    spectrum : PowerSpectrum
        Of the isotropic surface.
    length : float
        Of one scan [m].

    References
    ----------
    J. S. Bendat, A. G. Piersol, Random Data (2010), eq. (8.54).

    Examples
    --------
    >>> rough = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e3, q_rolloff=1e5, q_high=4e6)
    >>> short, long = height_scatter(rough, 1e-3), height_scatter(rough, 4e-3)
    >>> round(short, 3), round(short / long, 9)
    (0.093, 2.0)
    """
    q = np.concatenate([[0.0], np.geomspace(1e-2 * spectrum.q_low, spectrum.q_high, _SUM_NODES)])
    C = np.asarray(profile_density(spectrum, q))
    return math.sqrt(math.pi / (2.0 * length) * np.trapezoid(C**2, q)) / float(np.trapezoid(C, q))


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
    n, m = (_count("points", count) for count in (points if isinstance(points, tuple) else (points, points)))
    q, q_y = 2.0 * np.pi * np.fft.fftfreq(n, L / n), 2.0 * np.pi * np.fft.rfftfreq(m, L / n)
    C = np.asarray(spectrum(np.hypot(q[:, None] * stretch, q_y[None, :] / stretch)))
    white = _white_noise(n, m, seed)
    if amplitudes == "exact":
        white = white * (np.sqrt(n * m) / np.abs(white))
    elif amplitudes != "gaussian":
        raise ScanError(f"amplitudes = {amplitudes!r}: must be 'gaussian' or 'exact'")
    return np.fft.irfft2(white * np.sqrt(C) * (2.0 * np.pi / L) * n, (n, m))


# many spectra with one seed
@lru_cache(maxsize=1)
def _white_noise(n: int, m: int, seed: int) -> NDArray[np.complex128]:
    """Waves of random numbers, in the form of `rfft2`."""
    return np.fft.rfft2(np.random.default_rng(seed).standard_normal((n, m)))


def _count(name: str, value: int) -> int:
    if value != int(value) or value < 2:
        raise ScanError(f"{name} = {value!r}: must be a whole number from 2 on")
    return int(value)
