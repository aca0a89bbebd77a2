"""Triangles over the points of a surface that a program lists without its elements."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.errors import TextTableError
from fem_seal.files import problem

if TYPE_CHECKING:
    from scipy.spatial import Delaunay

# Harmonics of the line around which a surface that is not round is unrolled, and the widest gap between points around
# an axis that they close [rad].
_HARMONICS, _WIDEST_GAP = 4, np.pi / 6
# Neighbours of a point on a chart, points whose neighbours are looked at, and how unlike their distances may have been
# stretched: so little that no other chart is looked for, and at most.
_NEIGHBOURS, _SAMPLE, _HARDLY, _STRETCHED = 8, 4000, 2.0, 20.0
# A triangle so much wider than those around it may lie in a hole, and the widest one of a hole is; beyond the first
# such step of the sizes, or the last number, they do.
_WIDER, _HOLE, _STEP, _WIDEST, _PASSES = 2.0, 4.0, 1.3, 8.0, 3


def triangles_over(points: FloatArray, axis: FloatArray | None = None) -> IntArray:
    """Triangles that join neighbours on a surface: a patch, or a ring that closes around an axis.

    The points are laid on a plane: along the direction in which they are thinnest, or unrolled around an axis, as the
    distances between neighbours are changed least. What spans holes and bays is left out: triangles whose
    circumscribed circles are much larger than those around them.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Any unit, in any order, each place once.
    axis : ndarray, shape (3,), optional
        Direction of the axis around which they are unrolled; found unless given.

    Returns
    -------
    ndarray, shape (t, 3)

    Raises
    ------
    TextTableError
        If the points lie on a line, or on no surface that can be laid on a plane.

    Examples
    --------
    >>> corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]])
    >>> len(triangles_over(corners))
    2
    """
    from scipy.spatial import Delaunay, QhullError

    centred = points - points.mean(axis=0)
    _, spread, directions = np.linalg.svd(centred, full_matrices=False)
    if len(points) < 3 or not spread[1] > 1e-6 * spread[0]:
        raise TextTableError(problem("map_on_a_line"))
    best, least = None, _STRETCHED
    for chart in _charts(points, centred, directions, axis):
        stretched = _stretch(points, chart)
        if stretched < least:
            best, least = chart, stretched
        if least < _HARDLY:
            break
    try:
        mesh = None if best is None else Delaunay(best)
    except QhullError:
        mesh = None
    if mesh is None:
        raise TextTableError(problem("map_not_unrolled"))
    return mesh.simplices[~_in_holes(mesh)].astype(np.int64)


def _charts(
    points: FloatArray, centred: FloatArray, directions: FloatArray, axis: FloatArray | None
) -> Iterator[FloatArray]:
    """Ways of laying the points on a plane."""
    if axis is None:
        yield centred @ directions[:2].T
    for direction in [*directions[::-1], *np.eye(3)] if axis is None else [axis / np.linalg.norm(axis)]:
        for start in (centred, points):
            yield _unrolled(start, direction)


def _unrolled(points: FloatArray, axis: FloatArray) -> FloatArray:
    """Points around an axis through the origin on a ring in the plane, with their angles as distances along a line."""
    across = np.linalg.svd(axis[None])[2][1:]
    z, (x, y) = points @ axis, across @ points.T
    r, turn = np.hypot(x, y), np.arctan2(y, x)
    ordered = np.sort(turn)
    closes = np.diff(ordered, append=ordered[0] + 2 * np.pi).max() < _WIDEST_GAP
    orders = np.arange(1, _HARMONICS + 1 if closes else 1)

    def waves(angle: FloatArray) -> FloatArray:
        return np.column_stack(
            [np.ones_like(angle), np.cos(np.outer(angle, orders)), np.sin(np.outer(angle, orders))]
        )

    # the line in the middle of the surface
    section = np.column_stack([r, z])
    line = np.linalg.lstsq(waves(turn), section, rcond=None)[0]
    away = section - waves(turn) @ line
    # and how far from it a point lies along the meridian
    s = away @ np.linalg.svd(away, full_matrices=False)[2][0]
    angle = np.linspace(-np.pi, np.pi, 721)
    r_line, z_line = (waves(angle) @ line).T
    steps = np.diff(np.column_stack([r_line * np.cos(angle), r_line * np.sin(angle), z_line]), axis=0)
    length = np.append(0.0, np.cumsum(np.linalg.norm(steps, axis=1))) * (2 * np.pi)
    whole = length[-1] / (2 * np.pi)
    if not whole > 0.0:
        return np.zeros((len(points), 2))
    phi, rho = np.interp(turn, angle, length / whole), np.exp(np.clip(2 * np.pi * s / whole, -30.0, 30.0))
    return np.column_stack([rho * np.cos(phi), rho * np.sin(phi)])


def _stretch(points: FloatArray, chart: FloatArray) -> float:
    """How unlike the distances from a point to its neighbours on a chart were stretched, of nearly the worst point."""
    from scipy.spatial import cKDTree

    sample = np.arange(0, len(points), max(len(points) // _SAMPLE, 1))
    count = min(_NEIGHBOURS, len(points) - 1)
    flat, neighbours = map(np.asarray, cKDTree(chart).query(chart[sample], count + 1))
    distances = np.linalg.norm(points[neighbours[:, 1:]] - points[sample, None], axis=2)
    ratio = distances / np.maximum(flat[:, 1:], 1e-12 * np.ptp(chart) + 1e-300)
    highest = ratio.max(axis=1)
    return float(np.quantile(highest / np.maximum(ratio.min(axis=1), 1e-9 * highest), 0.99))


def _in_holes(mesh: Delaunay) -> BoolArray:
    """Which triangles span a hole or a bay."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    triangles = mesh.simplices
    a, b, c = (mesh.points[triangles[:, n]] for n in range(3))
    sides = [np.linalg.norm(side, axis=1) for side in (b - a, c - b, a - c)]
    area = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    # of the circumscribed circles, over the smallest ones at the corners
    radius = sides[0] * sides[1] * sides[2] / np.maximum(4.0 * area, 1e-12 * sides[0] * sides[1])
    smallest = np.full(len(mesh.points), np.inf)
    np.minimum.at(smallest, triangles.ravel(), np.repeat(radius, 3))
    # which are alike from point to point only on the average where points lie at random
    usual, sharing = np.log(smallest), np.bincount(triangles.ravel(), minlength=len(smallest))
    for _ in range(_PASSES):
        around = np.repeat(usual[triangles].mean(axis=1), 3)
        usual = np.bincount(triangles.ravel(), around, len(usual)) / np.maximum(sharing, 1)
    width = radius / np.exp(np.median(usual[triangles], axis=1))
    rising = np.unique(np.clip(width, _WIDER, _WIDEST))
    rising = np.append(rising, np.inf)
    is_wide = width > rising[int(np.argmax(np.diff(rising) > (_STEP - 1.0) * rising[:-1]))]
    # one triangle that is a little wider than those around it is no hole
    one, side = np.nonzero((mesh.neighbors >= 0) & is_wide[:, None] & is_wide[mesh.neighbors])
    links = coo_array((np.ones(len(one)), (one, mesh.neighbors[one, side])), shape=(len(width),) * 2)
    hole = connected_components(links, directed=False)[1]
    widest = np.zeros(len(width))
    np.maximum.at(widest, hole, width)
    return is_wide & (widest[hole] > _HOLE)
