"""From the spectrum of an isotropic surface to the one of a line scan across it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.numerics.sampling import divided
from leak.surfaces.periodogram import beyond
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
    edges = np.exp(divided(np.log(np.unique(spectrum.wavenumber)), _PIECE))
    C = np.asarray(spectrum(np.sqrt(edges[1:] * edges[:-1])))
    # `abel_weights` @ C, summed by what C falls by at each edge
    falls = -2.0 * np.diff(C, prepend=0.0, append=0.0)

    def of(part: FloatArray) -> FloatArray:
        # edges below all of q add nothing
        first = np.searchsorted(edges, part.min(initial=np.inf))
        return beyond(part, edges[first:]) @ falls[first:]

    found = np.concatenate([of(part) for part in np.array_split(q.ravel(), q.size // 2000 + 1)])
    return float(found[0]) if np.ndim(wavenumber) == 0 else found.reshape(q.shape)


# Wavenumbers over which the square of a profile's spectrum is summed.
_SUMMED = 2000


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
    q = np.concatenate([[0.0], np.geomspace(1e-2 * spectrum.q_low, spectrum.q_high, _SUMMED)])
    C = np.asarray(profile_density(spectrum, q))
    return math.sqrt(math.pi / (2.0 * length) * np.trapezoid(C**2, q)) / float(np.trapezoid(C, q))
