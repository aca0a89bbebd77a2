"""A rough patch loaded and unloaded: contact area, gap and conductivity over the pressure.

Studies repeat the simulation with another grid, cutoff or size of the patch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray, IntArray
from leak.direct.contact import ContactState, PeriodicHalfSpace, checked_heights, checked_pressures, press
from leak.direct.flow import patch_flow, periodic_flow, rarefied_gap
from leak.direct.patch import Patch, refined, smoothed
from leak.errors import DirectError, positive


class PressedPatch(NamedTuple):
    """Numbers of one pressed map.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import PeriodicHalfSpace, PressedPatch, press
    >>> state = press(PeriodicHalfSpace(8, 1e-3, 100e9), np.zeros((8, 8)), 1e6)
    >>> PressedPatch.of(state).contact_area
    1.0
    """

    contact_area: float
    """Fraction of the points with p > 0 [-]."""
    yielded_area: float
    """Fraction of the points at the hardness [-]."""
    mean_gap: float
    """Over the whole patch [m]."""
    gap_cubed_along: float
    """u_eff^3 along axis 0 [m^3]."""
    gap_cubed_across: float
    """u_eff^3 along axis 1 [m^3]."""

    @classmethod
    def of(
        cls,
        state: ContactState,
        *,
        hardness: float | None = None,
        periodic: bool = False,
        flight: float | None = None,
    ) -> PressedPatch:
        """Areas, gap and the flow in both directions.

        Parameters
        ----------
        state : ContactState
            From `press`.
        hardness : float or None
            With which it was pressed [Pa].
        periodic, flight
            See `simulate`.
        """
        flow = periodic_flow if periodic else patch_flow
        p, gap = state.pressure, state.gap
        wide_gap = gap if flight is None else rarefied_gap(gap, flight)
        plastic_share = 0.0 if hardness is None else float(np.mean(p >= hardness))
        flow_x, flow_y = flow(wide_gap).gap_cubed, flow(np.ascontiguousarray(wide_gap.T)).gap_cubed
        return cls(float(np.mean(p > 0.0)), plastic_share, float(gap.mean()), flow_x, flow_y)


@dataclass(frozen=True, eq=False)
class DirectBranch:
    """What a patch does at each pressure of a path; all arrays have shape (P,).

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import simulate
    >>> flat = simulate(np.zeros((8, 8)), 1e-3, [1e6], effective_modulus=100e9)
    >>> float(flat.contact_area[0]), float(flat.flow_conductivity(1e-3)[0])
    (1.0, 0.0)
    """

    pressure: FloatArray
    """Mean pressure [Pa]."""
    contact_area: FloatArray
    """Fraction of the points with p > 0 [-]."""
    yielded_area: FloatArray
    """Fraction of the points at the hardness [-]."""
    mean_gap: FloatArray
    """Mean over the whole patch, zero in contact [m]."""
    gap_cubed_along: FloatArray
    """u_eff^3 = 12 eta times the conductivity for flow along axis 0 [m^3]."""
    gap_cubed_across: FloatArray
    """The same along axis 1 [m^3]."""

    def flow_conductivity(self, viscosity: float) -> FloatArray:
        """Flow per width over the pressure drop per length, mean of both directions [m^3/(Pa s)].

        Parameters
        ----------
        viscosity : float
            eta [Pa s].
        """
        eta = positive(DirectError, "viscosity", viscosity, "Pa s")
        return 0.5 * (self.gap_cubed_along + self.gap_cubed_across) / (12.0 * eta)


@dataclass(frozen=True, eq=False)
class DirectResult(DirectBranch):
    """First loading of a patch and, if asked for, unloading from the largest pressure.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import simulate
    >>> x = np.arange(32) / 32
    >>> bumps = 1e-6 * np.cos(2 * np.pi * x)[:, None] * np.cos(2 * np.pi * x)[None, :]
    >>> result = simulate(bumps, 1e-3, [2e7, 1e8], effective_modulus=100e9, hardness=1e9, unload=[2e7])
    >>> bool(result.unloaded.mean_gap[0] < result.mean_gap[0])
    True
    """

    unloaded: DirectBranch | None
    """The pressures of `unload`, after the largest of the path; None without them."""


def simulate(
    heights: ArrayLike,
    size: float,
    pressures: ArrayLike,
    *,
    effective_modulus: float,
    hardness: float | None = None,
    unload: ArrayLike | None = None,
    periodic: bool = False,
    flight: float | None = None,
    tolerance: float = 1e-4,
) -> DirectResult:
    """Press a periodic rough square against a rigid flat and let a fluid flow through what stays open.

    Parameters
    ----------
    heights : array_like, shape (n, n)
        Combined heights of both surfaces [m], upwards out of the body; periodic.
    size : float
        Side of the square [m].
    pressures : float or array_like, shape (P,)
        Mean pressures in any order [Pa]; each is a point of one path of rising load.
    effective_modulus : float
        E* of both bodies together [Pa].
    hardness : float or None
        Largest pressure the softer body bears [Pa]. Where it is reached the surfaces overlap, and the overlap is
        what has yielded: it is taken off the heights.
    unload : float, array_like or None
        Pressures [Pa] below the largest of the path, after it; the map is then the one with the overlap of the
        largest pressure taken off.
    periodic : bool
        Flow through the cell that repeats in both directions under a mean gradient, instead of from edge to edge.
    flight : float or None
        Of a gas, eta v0/p_f [m], see `rarefied_gap`: the conductivities are those of the gas at the pressure p_f, slip
        and free molecules included. None for a liquid.
    tolerance : float
        Of the contact, see `press`.

    Returns
    -------
    DirectResult
        Arrays in the order of `pressures`.

    Raises
    ------
    DirectError
        The map is not square or not finite, a pressure is not positive or reaches the hardness, an unloading
        pressure is not below the largest, or the contact does not converge.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=4e5)
    >>> heights = leak.random_map(spectrum, size=6e-4, points=64, seed=1)
    >>> result = leak.direct.simulate(heights, 6e-4, [5e6, 2e7], effective_modulus=100e9)
    >>> bool(result.contact_area[1] > result.contact_area[0] > 0.0)
    True
    """
    h, L = _map(heights), positive(DirectError, "size", size, "m")
    E = positive(DirectError, "effective_modulus", effective_modulus, "Pa")
    H = None if hardness is None else positive(DirectError, "hardness", hardness, "Pa")
    length = None if flight is None else positive(DirectError, "flight", flight, "m")
    path = checked_pressures("pressures", pressures)
    if H is not None and path.max() >= H:
        raise DirectError(
            f"pressures = {path.max():g} and hardness = {H:g}: a mean pressure must stay below the hardness [Pa]"
        )
    back_path = None if unload is None else checked_pressures("unload", unload)
    if back_path is not None and back_path.max() >= path.max():
        raise DirectError(
            f"unload = {back_path.max():g}: must lie below the largest pressure, {path.max():g} [Pa]"
        )
    body = PeriodicHalfSpace(h.shape[0], L, E)

    p: FloatArray | None = None
    overlap = np.zeros_like(h)

    def branch(heights: FloatArray, pressures: FloatArray, order: IntArray) -> DirectBranch:
        nonlocal p, overlap
        rows: dict[int, PressedPatch] = {}
        for i in order:
            state = press(body, heights, pressures[i], hardness=H, start=p, tolerance=tolerance)
            p, overlap = state.pressure, state.overlap
            rows[int(i)] = PressedPatch.of(state, hardness=H, periodic=periodic, flight=length)
        return DirectBranch(pressures, *np.array([rows[i] for i in range(pressures.size)]).T)

    loading = branch(h, path, np.argsort(path))
    unloading = None if back_path is None else branch(h - overlap, back_path, np.argsort(back_path)[::-1])
    return DirectResult(**vars(loading), unloaded=unloading)


def _map(heights: ArrayLike) -> FloatArray:
    if np.ma.is_masked(heights):
        raise DirectError("heights: some are masked; fill them, every height must be finite [m]")
    h = checked_heights(heights, "(n, n)")
    if h.ndim != 2 or h.shape[0] != h.shape[1] or h.shape[0] < 2:
        raise DirectError(f"heights has shape {h.shape}: must be (n, n), n at least 2")
    return h


def grid_study(
    heights: FloatArray, size: float, pressures: ArrayLike, points: Sequence[int], *, effective_modulus: float
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
        One for each grid: gaps [m], conductivities [m^3].

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
    patch: Patch, pressures: ArrayLike, factors: Sequence[float], *, seed: int, effective_modulus: float
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
        One for each size, gaps [m] and conductivities [m^3]; they are other samples, so that their scatter is part of
        what differs.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e7)
    >>> patch = leak.direct.Patch.of(spectrum, points=64)
    >>> half, whole = leak.direct.size_study(patch, [1e7], [0.5, 1.0], seed=1, effective_modulus=100e9)
    >>> bool(0.5 < half.mean_gap[0] / whole.mean_gap[0] < 2.0)
    True
    """
    pieces = (
        replace(patch, points=round(factor * patch.points), size=factor * patch.size) for factor in factors
    )
    return [
        simulate(piece.heights(seed), piece.size, pressures, effective_modulus=effective_modulus)
        for piece in pieces
    ]
