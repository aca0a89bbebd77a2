"""From the spectrum of an isotropic surface to the one of a line scan across it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
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
    nodes = np.log(np.unique(spectrum.wavenumber))
    counts = np.maximum(np.ceil(np.diff(nodes) / _PIECE).astype(int), 1)
    steps = [
        np.linspace(left, right, count, endpoint=False)
        for left, right, count in zip(nodes[:-1], nodes[1:], counts, strict=True)
    ]
    edges = np.exp(np.concatenate([*steps, nodes[-1:]]))
    C = np.asarray(spectrum(np.sqrt(edges[1:] * edges[:-1])))
    # `abel_weights` @ C, summed by what C falls by at each edge
    falls = -2.0 * np.diff(C, prepend=0.0, append=0.0)

    def of(part: FloatArray) -> FloatArray:
        # edges below all of q add nothing
        first = np.searchsorted(edges, part.min(initial=np.inf))
        return beyond(part, edges[first:]) @ falls[first:]

    found = np.concatenate([of(part) for part in np.array_split(q.ravel(), q.size // 2000 + 1)])
    return float(found[0]) if np.ndim(wavenumber) == 0 else found.reshape(q.shape)
