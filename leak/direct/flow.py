"""Reynolds flow through a map of gaps: mean gap^3 conductivity between two edges, or of the periodic cell.

Cell-centred finite volumes: the conductivity of a cell is g^3/(12 eta), that of a face the harmonic mean of its two
cells. Cells in contact conduct nothing. Only what spans from edge to edge is solved: pools between are at rest.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.flow.rarefied import flow_factor


class Flow(NamedTuple):
    """Flow through a patch under a unit pressure drop.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import patch_flow
    >>> flow = patch_flow(np.full((8, 8), 2e-6))
    >>> bool(np.isclose(flow.gap_cubed, 8e-18))
    True
    """

    gap_cubed: float
    """u_eff^3 [m^3]: 12 eta times the flow per width over the pressure drop per length; 0 where nothing spans."""
    pressure: FloatArray
    """From 1 to 0 along axis 0 in what spans, nan elsewhere, shape (n, n); without its mean gradient if periodic."""
    imbalance: float
    """Largest difference of the flow through two cross-sections, over the flow [-]."""


def patch_flow(gap: FloatArray) -> Flow:
    """Flow along axis 0 with pressure 1 and 0 at the outer sides of the first and last row of cells.

    The pressures stand on the edges of the patch, half a cell outside the first and last cell centres, so that
    parallel plates are exact. Sideways (axis 1) the patch is periodic.

    Parameters
    ----------
    gap : ndarray, shape (n, m)
        g >= 0 [m]; zero in contact.

    References
    ----------
    B. N. J. Persson, C. Yang, J. Phys.: Condens. Matter 20, 315011 (2008), for the problem; A. George, SIAM J.
    Numer. Anal. 10, 345 (1973), for the order of elimination.
    """
    scale = float(np.max(gap, initial=0.0))
    spans = find_spanning(gap > 0.0)
    if not spans.any():
        return Flow(0.0, np.full(gap.shape, np.nan), 0.0)
    k = np.where(spans, gap / scale, 0.0) ** 3
    k_along, k_across = _faces(k[:-1], k[1:]), _faces(k, np.roll(k, -1, 1))
    inlet, outlet = 2.0 * k[0], 2.0 * k[-1]
    diagonal = k_across + np.roll(k_across, 1, 1)
    diagonal[:-1] += k_along
    diagonal[1:] += k_along
    diagonal[0] += inlet
    diagonal[-1] += outlet
    load = np.zeros(gap.shape)
    load[0] = inlet
    p = _pressures(spans, k_along, k_across, diagonal, load)
    drop_along, drop_across = -np.diff(p, axis=0), p - np.roll(p, -1, 1)
    # The dissipation is the flow of a unit drop, and an error of the pressures enters it squared only.
    Q = float(
        np.sum(inlet * (1.0 - p[0]) ** 2)
        + np.sum(outlet * p[-1] ** 2)
        + np.sum(k_along * drop_along**2)
        + np.sum(k_across * drop_across**2)
    )
    sections = np.concatenate(
        [[np.sum(inlet * (1.0 - p[0]))], np.sum(k_along * drop_along, axis=1), [np.sum(outlet * p[-1])]]
    )
    n, m = gap.shape
    return Flow(Q * n / m * scale**3, np.where(spans, p, np.nan), float(np.ptp(sections)) / Q)


def periodic_flow(gap: FloatArray) -> Flow:
    """Flow along axis 0 of the cell that repeats in both directions, under a mean gradient of one per side.

    Parameters
    ----------
    gap : ndarray, shape (n, m)
        g >= 0 [m]; zero in contact.
    """
    scale = float(np.max(gap, initial=0.0))
    winds, pins = find_winding(gap > 0.0)
    if not winds.any():
        return Flow(0.0, np.full(gap.shape, np.nan), 0.0)
    n, m = gap.shape
    k = np.where(winds, gap / scale, 0.0) ** 3
    k_along, k_across = _faces(k, np.roll(k, -1, 0)), _faces(k, np.roll(k, -1, 1))
    diagonal = k_along + np.roll(k_along, 1, 0) + k_across + np.roll(k_across, 1, 1)
    # Only differences of pressure count: one cell of each cluster is held by a spring of its own conductance.
    diagonal.ravel()[pins] *= 2.0
    # -div k (1/n + grad p) = 0 with the mean gradient downwards along axis 0
    p = _pressures(winds, k_along, k_across, diagonal, (np.roll(k_along, 1, 0) - k_along) / n)
    drop_along = 1.0 / n + p - np.roll(p, -1, 0)
    drop_across = p - np.roll(p, -1, 1)
    Q = float(np.sum(k_along * drop_along**2) + np.sum(k_across * drop_across**2))
    sections = np.sum(k_along * drop_along, axis=1)
    return Flow(Q * n / m * scale**3, np.where(winds, p, np.nan), float(np.ptp(sections)) / Q)


def rarefied_gap(gap: FloatArray, flight: float) -> FloatArray:
    """Gaps that let as much through without rarefaction as a rarefied gas gets through these ones.

    g f(D)^(1/3) with D = g/flight, f the factor of `leak.flow.rarefied`; contact stays contact. `patch_flow` of it is
    the flow of the gas at this pressure, a local law in each cell.

    Parameters
    ----------
    gap : ndarray
        g >= 0 [m].
    flight : float
        eta v0/p_f of the gas, viscosity times most probable molecular speed over pressure [m].

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import patch_flow, rarefied_gap
    >>> gap = np.full((8, 8), 1e-6)
    >>> bool(patch_flow(rarefied_gap(gap, 1e-7)).gap_cubed > 1.5 * patch_flow(gap).gap_cubed)
    True
    """
    is_open = gap > 0.0
    D = np.where(is_open, gap, flight) / flight
    return np.where(is_open, gap * flow_factor(D) ** (1.0 / 3.0), 0.0)


class Streams(NamedTuple):
    """Where a flow goes and where it loses its pressure, cell by cell; each shape (n, m).

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import patch_flow, streams
    >>> gap = np.full((8, 8), 2e-6)
    >>> found = streams(gap, patch_flow(gap))
    >>> bool(np.allclose(found.flux, 1.0)), round(float(found.loss.sum()), 12)
    (True, 1.0)
    """

    flux: FloatArray
    """Flow per width over its mean [-]."""
    loss: FloatArray
    """Share of the pressure's work that is lost in the cell; the sum is one [-]."""


def streams(gap: FloatArray, flow: Flow) -> Streams:
    """Flux and losses of a flow found by `patch_flow`; zero where nothing flows.

    Parameters
    ----------
    gap : ndarray, shape (n, m)
        Of which `flow` is [m].
    flow : Flow
    """
    if flow.gap_cubed == 0.0:
        return Streams(np.zeros(gap.shape), np.zeros(gap.shape))
    scale, moves = float(np.max(gap)), np.isfinite(flow.pressure)
    k, p = np.where(moves, gap / scale, 0.0) ** 3, np.where(moves, flow.pressure, 0.0)
    # flows through the faces along axis 0, the edges among them, and through those across
    q = np.concatenate(
        [[2.0 * k[0] * (1.0 - p[0])], -_faces(k[:-1], k[1:]) * np.diff(p, axis=0), [2.0 * k[-1] * p[-1]]]
    )
    drop = np.concatenate([[1.0 - p[0]], -np.diff(p, axis=0), [p[-1]]])
    sideways = p - np.roll(p, -1, 1)
    s = _faces(k, np.roll(k, -1, 1)) * sideways
    # what a face loses, its two cells lose in the ratio of their resistances; the half face at an edge is its cell's
    next_k = np.roll(k, -1, 1)
    axial, cross, share, sideways_share = q * drop, s * sideways, _share(k[:-1], k[1:]), _share(k, next_k)
    loss = cross * sideways_share + np.roll(cross * (1.0 - sideways_share), 1, 1)
    loss[0] += axial[0]
    loss[-1] += axial[-1]
    loss[:-1] += axial[1:-1] * share
    loss[1:] += axial[1:-1] * (1.0 - share)
    flux = np.hypot(0.5 * (q[:-1] + q[1:]), 0.5 * (s + np.roll(s, 1, 1)))
    mean = flow.gap_cubed / scale**3 / gap.shape[0]
    return Streams(flux / mean, loss / loss.sum())


def find_spanning(open_cells: BoolArray) -> BoolArray:
    """Open cells joined through faces to both the first and the last row; sides (axis 1) are periodic."""
    label, _ = _clusters(open_cells)
    first_row, last_row = np.unique(label[0]), np.unique(label[-1])
    labels = np.intersect1d(first_row, last_row)
    return np.isin(label, labels[labels > 0])


def find_winding(open_cells: BoolArray) -> tuple[BoolArray, IntArray]:
    """Open cells of clusters that meet themselves one period further along axis 0, and one cell of each cluster."""
    label, count = _clusters(open_cells)
    # Clusters across the seam between the last and the first row, with the number of periods climbed so far.
    neighbours: dict[int, list[tuple[int, int]]] = {}
    for a, b in {(int(a), int(b)) for a, b in zip(label[-1], label[0], strict=True) if a and b}:
        neighbours.setdefault(a, []).append((b, 1))
        neighbours.setdefault(b, []).append((a, -1))
    height: dict[int, int] = {}
    cluster, seeds = np.arange(count + 1), set()
    for seed in neighbours:
        if seed in height:
            continue
        height[seed], todo = 0, [seed]
        while todo:
            a = todo.pop()
            cluster[a] = seed
            for b, climb in neighbours[a]:
                if b not in height:
                    height[b] = height[a] + climb
                    todo.append(b)
                elif height[b] != height[a] + climb:
                    seeds.add(seed)
    seed_of_cell = cluster[label]
    winds = np.isin(seed_of_cell, sorted(seeds))
    pins = [int(np.flatnonzero(seed_of_cell.ravel() == seed)[0]) for seed in sorted(seeds)]
    return winds, np.array(pins, dtype=np.int64)


def _clusters(open_cells: BoolArray) -> tuple[IntArray, int]:
    """Labels of the clusters joined through faces, sides periodic; closed cells are 0."""
    from scipy import ndimage, sparse
    from scipy.sparse import csgraph

    label, count = ndimage.label(open_cells)
    sides = (label[:, -1] > 0) & (label[:, 0] > 0)
    seam = sparse.coo_array(
        (np.ones(np.count_nonzero(sides)), (label[sides, -1], label[sides, 0])), shape=(count + 1, count + 1)
    )
    _, component = csgraph.connected_components(seam, directed=False)
    # the label 0 has no link, hence a component of its own: it is made 0 again
    component = np.where(np.arange(count + 1) == 0, 0, component + 1)
    return component[label].astype(np.int64), int(component.max(initial=0))


def _faces(k: FloatArray, next_k: FloatArray) -> FloatArray:
    """Harmonic means; zero beside a closed cell."""
    total = k + next_k
    return np.divide(2.0 * k * next_k, total, out=np.zeros_like(total), where=total > 0.0)


def _share(k: FloatArray, next_k: FloatArray) -> FloatArray:
    """Share of a face's resistance that is the first cell's."""
    total = k + next_k
    return np.divide(next_k, total, out=np.zeros_like(total), where=total > 0.0)


def _pressures(
    cells: BoolArray, k_along: FloatArray, k_across: FloatArray, diagonal: FloatArray, load: FloatArray
) -> FloatArray:
    """Pressures of the cells that are numbered by nested dissection, zero elsewhere, shape (n, m).

    The matrix of resistors has no pivot to choose; scaled to a diagonal of one, conductances of many decades harm
    it little.

    Parameters
    ----------
    cells : ndarray of bool
        Those with a pressure.
    k_along, k_across : ndarray
        Conductance to the next cell along axis 0, periodic with as many rows as the cells, and along axis 1.
    diagonal, load : ndarray
        Sum of the conductances of each cell, and what flows into it from outside.
    """
    from scipy import sparse
    from scipy.sparse.linalg import splu

    order = np.argsort(_dissection(*cells.shape)[cells])
    inverse = np.argsort(order)
    number = np.zeros(cells.shape, dtype=np.int64)
    number[cells] = inverse
    scale = 1.0 / np.sqrt(diagonal[cells][order])
    rows, columns, values = [inverse], [inverse], [np.ones(inverse.size)]
    for axis, k in enumerate((k_along, k_across)):
        links = np.nonzero(k)
        i, j = number[links], np.roll(number, -1, axis)[links]
        value = -k[links] * scale[i] * scale[j]
        rows += [i, j]
        columns += [j, i]
        values += [value, value]
    matrix = sparse.csc_array(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(inverse.size,) * 2
    )
    factors = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    pressure = np.zeros(cells.shape)
    pressure[cells] = (factors.solve(load[cells][order] * scale) * scale)[inverse]
    return pressure


@lru_cache(maxsize=4)
def _dissection(n: int, m: int) -> IntArray:
    """Nested dissection of the grid: each cell's place in the elimination; the lines that part it come last."""
    rank = np.empty((n, m), dtype=np.int64)
    next_place = n * m

    def give(part: IntArray) -> None:
        nonlocal next_place
        part[...] = np.arange(next_place - part.size, next_place).reshape(part.shape)
        next_place -= part.size

    # both seams of a periodic patch are lines that part it
    give(rank[:, 0])
    give(rank[0, 1:])
    parts = [rank[1:, 1:]]
    while parts:
        part = parts.pop()
        if part.size <= 16:
            give(part)
            continue
        if part.shape[0] < part.shape[1]:
            part = part.T
        middle = part.shape[0] // 2
        give(part[middle])
        parts += [part[middle + 1 :], part[:middle]]
    rank.flags.writeable = False
    return rank
