"""What the grid, the cutoff and the size of a patch change: the same simulation with one of them altered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.direct.patch import Patch, refined, smoothed
from leak.direct.simulation import DirectResult, simulate


def grid_study(
    heights: FloatArray,
    size: float,
    pressures: ArrayLike,
    points: Sequence[int],
    *,
    effective_modulus: float,
) -> list[DirectResult]:
    """The same waves on grids of different fineness: what the grid itself changes.

    Parameters
    ----------
    heights, size, pressures, effective_modulus
        See `simulate`.
    points : sequence of int
        Points along a side of each grid, enough for all waves of the map.

    Returns
    -------
    list of DirectResult
        One for each grid.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=2e5)
    >>> heights = leak.random_map(spectrum, size=3e-4, points=32, seed=1)
    >>> coarse, fine = leak.direct.grid_study(heights, 3e-4, [1e8], [32, 64], effective_modulus=100e9)
    >>> bool(abs(fine.mean_gap[0] / coarse.mean_gap[0] - 1) < 0.1)
    True
    """
    return [
        simulate(refined(heights, n), size, pressures, effective_modulus=effective_modulus) for n in points
    ]


def cutoff_study(
    heights: FloatArray,
    size: float,
    pressures: ArrayLike,
    shortest_wavelengths: Sequence[float],
    *,
    effective_modulus: float,
) -> list[DirectResult]:
    """The same map without its shortest waves, on the same grid: what the cutoff changes.

    Parameters
    ----------
    heights, size, pressures, effective_modulus
        See `simulate`.
    shortest_wavelengths : sequence of float
        Of each map [m].

    Returns
    -------
    list of DirectResult
        One for each cutoff.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=4e5)
    >>> heights = leak.random_map(spectrum, size=3e-4, points=64, seed=1)
    >>> all_waves, long_waves = leak.direct.cutoff_study(
    ...     heights, 3e-4, [1e8], [1.5e-5, 3e-5], effective_modulus=100e9
    ... )
    >>> bool(long_waves.contact_area[0] > all_waves.contact_area[0])
    True
    """
    return [
        simulate(smoothed(heights, size, shortest), size, pressures, effective_modulus=effective_modulus)
        for shortest in shortest_wavelengths
    ]


def size_study(
    patch: Patch,
    pressures: ArrayLike,
    factors: Sequence[float],
    *,
    seed: int,
    effective_modulus: float,
) -> list[DirectResult]:
    """Samples of patches of different size with the same grid spacing: what longer waves and more asperities change.

    Parameters
    ----------
    patch : Patch
    pressures, effective_modulus
        See `simulate`.
    factors : sequence of float
        Side of each patch over that of `patch`; its points go with it.
    seed : int
        Of the samples.

    Returns
    -------
    list of DirectResult
        One for each size; they are other samples, so that their scatter is part of what differs.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e7)
    >>> patch = leak.direct.Patch.of(spectrum, points=64)
    >>> half, whole = leak.direct.size_study(patch, [1e7], [0.5, 1.0], seed=1, effective_modulus=100e9)
    >>> bool(0.5 < half.mean_gap[0] / whole.mean_gap[0] < 2.0)
    True
    """
    found = []
    for factor in factors:
        piece = replace(patch, points=round(factor * patch.points), size=factor * patch.size)
        found.append(
            simulate(
                piece.heights(seed),
                piece.size,
                pressures,
                effective_modulus=effective_modulus,
            )
        )
    return found
