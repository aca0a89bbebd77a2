"""Triangle meshes with named boundaries, made fast."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from skfem import MeshTri

from meshes.arrays import BoolArray, FloatArray, IntArray
from meshes.errors import MeshingError

# Rounds of smoothing: the second one makes far fewer poor triangles, a third one hardly any difference.
_ROUNDS = 2
# Shape of a triangle, see `triangle_shape`, that smoothing may make worse.
_GOOD_SHAPE = 0.6


def triangle_shape(p: FloatArray, t: IntArray) -> FloatArray:
    """Return 2 r_in/r_circ of every triangle: 1 equilateral, 0 degenerate."""
    a, b, c = (np.hypot(*(p[:, t[i]] - p[:, t[j]])) for i, j in ((0, 1), (1, 2), (2, 0)))
    return (b + c - a) * (c + a - b) * (a + b - c) / (a * b * c)


def doubled_area(p: FloatArray, t: IntArray) -> FloatArray:
    """Twice the area of every triangle [m^2], negative where its vertices go round clockwise."""
    e, f = p[:, t[1]] - p[:, t[0]], p[:, t[2]] - p[:, t[0]]
    return e[0] * f[1] - e[1] * f[0]


def section_area(mesh: MeshTri) -> float:
    """Area of the meshed section [m^2]."""
    return float(0.5 * np.abs(doubled_area(mesh.p, mesh.t)).sum())


class Triangles(MeshTri):
    """scikit-fem's triangles, whose edges are found among whole numbers: a tenth of the time."""

    @staticmethod
    def build_entities(
        t: IntArray, indices: Sequence[Sequence[int]], sort: bool = True
    ) -> tuple[IntArray, IntArray]:
        """Vertices of all edges, sorted, and the edges of every triangle; as scikit-fem numbers them."""
        ends = np.sort(np.hstack([t[pair] for pair in indices]), axis=0)
        stride = np.int64(ends.max(initial=0)) + 1
        numbers, edge = np.unique(ends[0] * stride + ends[1], return_inverse=True)
        pairs = np.stack([numbers // stride, numbers % stride]).astype(t.dtype)
        return pairs, edge.reshape(len(indices), t.shape[1])


def facets_between(mesh: MeshTri, lines: Mapping[str, IntArray]) -> dict[str, IntArray]:
    """The facets of some lines.

    Parameters
    ----------
    mesh : skfem.MeshTri
    lines : mapping of ndarray of int, shape (n, 2)
        Pairs of vertices.

    Raises
    ------
    MeshingError
        If there is no facet between a pair.
    """

    def numbers(pairs: IntArray) -> IntArray:
        return pairs.min(axis=1) * np.int64(mesh.nvertices) + pairs.max(axis=1)

    # scikit-fem sorts the facets by their vertices, and so are these numbers.
    facet_numbers = numbers(mesh.facets.T)
    facets = {name: np.searchsorted(facet_numbers, numbers(pairs)) for name, pairs in lines.items()}
    for name, pairs in lines.items():
        if not np.array_equal(facet_numbers.take(facets[name], mode="clip"), numbers(pairs)):
            raise MeshingError(
                "gmsh merged neighbouring vertices of a boundary; the elements asked for there are too small against "
                "the bodies, use a larger contact size or edge radius"
            )
    return facets


def smooth_triangles(mesh: Triangles) -> Triangles:
    """Vertices moved to the mean of their neighbours, where that harms no triangle; those of the boundary stay.

    Parameters
    ----------
    mesh : Triangles
    """
    p, (start, end) = mesh.p, mesh.facets
    neighbours = np.bincount(mesh.facets.ravel())
    on_edge = np.zeros(p.shape[1], dtype=bool)
    on_edge[mesh.facets[:, np.bincount(mesh.t2f.ravel()) == 1]] = True
    measures = _measure_triangles(p, mesh.t)
    for _ in range(_ROUNDS):
        total = [np.bincount(start, c[end], len(c)) + np.bincount(end, c[start], len(c)) for c in p]
        new_p = np.where(on_edge, p, np.stack(total) / neighbours)
        # a vertex that stays may be the next one's trouble
        while np.any(worse := _harmed_triangles(measures, new := _measure_triangles(new_p, mesh.t))):
            new_p[:, mesh.t[:, worse]] = p[:, mesh.t[:, worse]]
        p, measures = new_p, new
    return replace(mesh, doflocs=p)


def _measure_triangles(p: FloatArray, t: IntArray) -> tuple[FloatArray, FloatArray]:
    """Shape and doubled area of triangles."""
    return triangle_shape(p, t), doubled_area(p, t)


def _harmed_triangles(
    measures: tuple[FloatArray, FloatArray], new_measures: tuple[FloatArray, FloatArray]
) -> BoolArray:
    """Triangles that are turned over, or worse than before and poor."""
    (shape, area), (new_shape, new_area) = measures, new_measures
    return (np.sign(area) != np.sign(new_area)) | ((new_shape < shape) & (new_shape < _GOOD_SHAPE))
