"""What a scan says about the spectrum: mean Fourier power in bins, and how a spectrum would show up there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, reduce

import numpy as np

from leak.arrays import FloatArray, IntArray
from leak.surfaces.scans import LineScan, Topography, Window

# A mode seen through a Hann window takes these shares of its power from itself and its two neighbours.
_NEIGHBOURS = {"hann": {-1: 1 / 6, 0: 2 / 3, 1: 1 / 6}, "none": {0: 1.0}}
# Sum of the squared correlations of one mode with all others: neighbouring modes of a Hann window are not independent.
_CORRELATION = {"hann": 35.0 / 18.0, "none": 1.0}
# Modes by which a bin with more of them is represented, in a line scan and in a map.
_LINE_SAMPLES, _MAP_SAMPLES = 12, 150
# Fourier power this small against the variance of the scan is rounding.
_ROUNDING = 1e-20


@dataclass(frozen=True, eq=False)
class Periodogram:
    """Fourier modes of one scan or map, those of opposite wavenumber counted once.

    Parameters
    ----------
    wavenumber : ndarray, shape (n,)
        Length q of the wave vectors, increasing [1/m].
    vector : ndarray, shape (n, dim)
        The wave vectors [1/m].
    power : ndarray, shape (n,)
        Density: C_1D of a line scan [m^3], C of a map [m^4].
    cell : ndarray, shape (n,)
        Share of wavenumber space, such that sum(power * cell) is the variance of the windowed heights.
    step : ndarray, shape (dim,)
        Distance of neighbouring modes along each direction [1/m].
    window : str
    """

    wavenumber: FloatArray
    vector: FloatArray
    power: FloatArray
    cell: FloatArray
    step: FloatArray
    window: Window

    @property
    def dimension(self) -> int:
        """1 for a line scan, 2 for a map."""
        return self.step.size

    @property
    def shares(self) -> FloatArray:
        """Contribution of each mode to the variance of the windowed heights, shape (n,) [m^2]."""
        return self.power * self.cell


@dataclass(frozen=True, eq=False)
class Evidence:
    """Binned periodogram with its expectation for a spectrum C: ``weights @ C(samples)``.

    Parameters
    ----------
    wavenumber : ndarray, shape (bins,)
        Mean q of the modes in each bin [1/m].
    density : ndarray, shape (bins,)
        Mean power [m^3] or [m^4].
    freedom : ndarray, shape (bins,)
        Number of independent modes [-].
    samples : ndarray, shape (samples,)
        Wavenumbers at which C is taken [1/m].
    weights : ndarray, shape (bins, samples)
        [1/m] for a line scan, [-] for a map.
    """

    wavenumber: FloatArray
    density: FloatArray
    freedom: FloatArray
    samples: FloatArray
    weights: FloatArray


def periodogram(scan: Topography, window: Window) -> Periodogram:
    """Fourier power of a scan without form, windowed; a window of mean square 1 keeps the variance on average."""
    shape = scan.heights.shape
    weights = reduce(np.multiply.outer, [_window(n, window) for n in shape])
    # no constant part may remain: through the window it would look like the longest wave
    heights = weights * (scan.heights - np.sum(weights * scan.heights) / np.sum(weights))
    step = 2.0 * np.pi / np.array([scan.length] if isinstance(scan, LineScan) else scan.size)
    cell = 2.0 * float(np.prod(step))
    power = np.abs(np.fft.rfftn(heights)) ** 2 / heights.size**2 / np.prod(step)
    numbers = [np.round(np.fft.fftfreq(n) * n) for n in shape[:-1]] + [np.arange(shape[-1] // 2 + 1.0)]
    modes = np.stack(np.meshgrid(*numbers, indexing="ij"), axis=-1)
    # of each pair of opposite modes one; those at the Nyquist wavenumber, which have no sign, are left out
    half = (modes[..., -1] > 0) | ((modes[..., -1] == 0) & (modes[..., 0] > 0))
    half &= (2 * np.abs(modes) < shape).all(axis=-1)
    vector = step * modes[half]
    q = np.hypot.reduce(vector, axis=1)
    order = np.argsort(q, kind="stable")
    power = power[half]
    power = (np.maximum(power, _ROUNDING * np.sum(power)) + np.finfo(float).tiny / cell)[order]
    return Periodogram(q[order], vector[order], power, np.full(q.shape, cell), step, window)


def _window(n: int, window: Window) -> FloatArray:
    if window == "none":
        return np.ones(n)
    return (1.0 - np.cos(2.0 * np.pi * (np.arange(n) + 0.5) / n)) / np.sqrt(1.5)


def evidence(modes: Periodogram, edges: FloatArray, piece_edges: FloatArray) -> Evidence:
    """Bin a periodogram and say what a spectrum would give in each bin.

    Parameters
    ----------
    modes : Periodogram
    edges : ndarray
        Edges of the bins [1/m]; modes outside are left out, bins without modes too.
    piece_edges : ndarray
        Edges of the pieces of C that a line scan sees, over all wavenumbers [1/m].
    """
    places = np.flatnonzero(
        (modes.wavenumber >= edges[0] * (1 - 1e-9)) & (modes.wavenumber <= edges[-1] * (1 + 1e-9))
    )
    bins = np.clip(np.searchsorted(edges, modes.wavenumber[places] * (1 + 1e-9)) - 1, 0, edges.size - 2)
    groups = [places[bins == k] for k in np.unique(bins)]
    count = np.array([group.size for group in groups])
    # correlated only with those modes that are in the same bin
    correlation = (_CORRELATION[modes.window] - 1.0) * (1.0 - 1.0 / count) + 1.0
    build = _line_weights if modes.dimension == 1 else _map_weights
    samples, weights = build(modes, groups, piece_edges)
    return Evidence(
        np.array([modes.wavenumber[group].mean() for group in groups]),
        np.array([modes.power[group].mean() for group in groups]),
        np.maximum(count / correlation**modes.dimension, 1.0),
        samples,
        weights,
    )


def pool_scans(evidence: Sequence[Evidence]) -> list[Evidence]:
    """Scans of the same length and spacing as one scan: as likely for every spectrum, but for a constant."""
    pools: list[Evidence] = []
    for scan in evidence:
        same = (
            n
            for n, pool in enumerate(pools)
            if pool.weights.shape == scan.weights.shape and np.allclose(pool.weights, scan.weights, rtol=1e-9)
        )
        n = next(same, None)
        if n is None:
            pools.append(scan)
            continue
        pool = pools[n]
        freedom = pool.freedom + scan.freedom
        mean = (pool.density * pool.freedom + scan.density * scan.freedom) / freedom
        pools[n] = replace(pool, density=mean, freedom=freedom)
    return pools


def _line_weights(
    modes: Periodogram, groups: list[IntArray], edges: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Expected C_1D of each bin from pieces of constant C, the smearing of the window included."""
    spans = tuple((int(group[0]), int(group[-1]) + 1) for group in groups)
    rows = _rows_of_spans(float(modes.step[0]), modes.window, spans, tuple(edges.tolist()))
    return np.sqrt(edges[1:] * edges[:-1]), rows


# of as many lengths of scans as one surface is measured with
@lru_cache(maxsize=16)
def _rows_of_spans(
    step: float, window: Window, spans: tuple[tuple[int, int], ...], edges: tuple[float, ...]
) -> FloatArray:
    """The same of all scans of one length: bins by the first mode and that behind the last one; not to be changed."""
    shift, share = (np.array(list(column)) for column in zip(*_NEIGHBOURS[window].items(), strict=True))
    rows = []
    for first, stop in spans:
        q = _thin_wavenumbers(step * np.arange(first + 1.0, stop + 1.0), _LINE_SAMPLES)
        q_near, part = q[:, None] + shift * step, np.broadcast_to(share / q.size, (q.size, share.size))
        real = q_near > 0.5 * step
        rows.append(part[real] @ abel_weights(q_near[real], np.array(edges)))
    table = np.array(rows)
    table.flags.writeable = False
    return table


def _thin_wavenumbers(q: FloatArray, most: int) -> FloatArray:
    """Few wavenumbers with the mean of many."""
    if q.size <= most:
        return q
    half = 0.5 * (q[1] - q[0])
    edges = np.linspace(q[0] - half, q[-1] + half, most + 1)
    return 0.5 * (edges[1:] + edges[:-1])


def _map_weights(
    modes: Periodogram, groups: list[IntArray], edges: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Expected C of each bin from C at the modes, the smearing of the window included."""
    shares = _NEIGHBOURS[modes.window]
    shifts = np.array([(i * modes.step[0], j * modes.step[1]) for i in shares for j in shares])
    share = np.array([shares[i] * shares[j] for i in shares for j in shares])
    centres = np.log(np.sqrt(edges[1:] * edges[:-1]))
    rows = np.zeros((len(groups), centres.size))
    for row, group in zip(rows, groups, strict=True):
        part = group[:: 1 + group.size // _MAP_SAMPLES]
        q = np.linalg.norm(modes.vector[part, None, :] + shifts, axis=2)
        # the mean height is taken off, so nothing comes from there
        real = q > 0.25 * modes.step.min()
        piece = np.searchsorted(centres, np.log(np.where(real, q, 1.0)))
        np.add.at(
            row, np.clip(piece, 0, centres.size - 1)[real], np.broadcast_to(share, q.shape)[real] / part.size
        )
    return np.exp(centres), rows


def abel_weights(wavenumber: FloatArray, edges: FloatArray) -> FloatArray:
    """Weights of pieces of constant C in C_1D, shape (len(wavenumber), len(edges) - 1) [1/m].

    C_1D(q) = 2 int_q^inf C(k) k dk / sqrt(k^2 - q^2), exact for a C that is constant between `edges`.
    """
    return 2.0 * np.diff(edge_distance(wavenumber, edges), axis=1)


def edge_distance(wavenumber: FloatArray, edges: FloatArray) -> FloatArray:
    """sqrt(edge^2 - q^2) of each edge beyond q, otherwise 0, shape (len(wavenumber), len(edges)) [1/m]."""
    reach = edges[None, :] ** 2 - wavenumber[:, None] ** 2
    np.maximum(reach, 0.0, out=reach)
    return np.sqrt(reach, out=reach)
