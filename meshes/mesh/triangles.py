"""Triangle meshes with named boundaries, made fast."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from skfem import MeshTri

from meshes.arrays import FloatArray
from meshes.errors import MeshingError
from meshes.mesh.measures import doubled_area, triangle_shape

# Rounds of smoothing: the second one makes far fewer poor triangles, a third one hardly any difference.
_ROUNDS = 2
# Shape of a triangle, see `triangle_shape`, that smoothing may make worse.
_GOOD = 0.6


class Triangles(MeshTri):
    """scikit-fem's triangles, whose edges are found among whole numbers: a tenth of the time."""

    @staticmethod
    def build_entities(t, indices, sort=True):  # type: ignore[no-untyped-def]
        """Vertices of all edges, sorted, and the edges of every triangle; as scikit-fem numbers them."""
        ends = np.sort(np.hstack([t[pair] for pair in indices]), axis=0)
        stride = np.int64(ends.max(initial=0)) + 1
        numbers, edge = np.unique(ends[0] * stride + ends[1], return_inverse=True)
        pairs = np.stack([numbers // stride, numbers % stride]).astype(t.dtype)
        return pairs, edge.reshape(len(indices), t.shape[1])


def facets_between(mesh: MeshTri, lines: Mapping[str, NDArray[np.int64]]) -> dict[str, NDArray[np.int64]]:
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

    def numbers(pairs: NDArray[np.int64]) -> NDArray[np.int64]:
        return pairs.min(axis=1) * np.int64(mesh.nvertices) + pairs.max(axis=1)

    # scikit-fem sorts the facets by their vertices, and so are these numbers.
    known = numbers(mesh.facets.T)
    facets = {name: np.searchsorted(known, numbers(pairs)) for name, pairs in lines.items()}
    for name, pairs in lines.items():
        if not np.array_equal(known.take(facets[name], mode="clip"), numbers(pairs)):
            raise MeshingError(
                "gmsh merged neighbouring vertices of a boundary; the elements asked for there are too small against "
                "the bodies, use a larger contact size or edge radius"
            )
    return facets


def bounded(p: FloatArray, t: NDArray[np.int64], lines: Mapping[str, NDArray[np.int64]]) -> MeshTri:
    """Triangles with named boundaries.

    Parameters
    ----------
    p : ndarray, shape (2, n)
        Vertices [m].
    t : ndarray of int, shape (3, m)
        Their numbers in each triangle.
    lines : mapping of ndarray of int, shape (k, 2)
        Pairs of vertices of each boundary.

    Raises
    ------
    MeshingError
        If there is no edge between a pair.
    """
    mesh = Triangles(np.ascontiguousarray(p), np.ascontiguousarray(t))
    return mesh.with_boundaries(facets_between(mesh, lines))


def smoothed(mesh: MeshTri) -> FloatArray:
    """Vertices moved to the mean of their neighbours [m], where that harms no triangle; those of the boundary stay.

    Parameters
    ----------
    mesh : skfem.MeshTri
    """
    p, (start, end) = mesh.p, mesh.facets
    neighbours = np.bincount(mesh.facets.ravel())
    fixed = np.zeros(p.shape[1], dtype=bool)
    fixed[mesh.facets[:, np.bincount(mesh.t2f.ravel()) == 1]] = True
    for _ in range(_ROUNDS):
        total = [np.bincount(start, c[end], len(c)) + np.bincount(end, c[start], len(c)) for c in p]
        moved = np.where(fixed, p, np.stack(total) / neighbours)
        # a vertex that stays may be the next one's trouble
        while np.any(harmed := _harmed(p, moved, mesh.t)):
            moved[:, mesh.t[:, harmed]] = p[:, mesh.t[:, harmed]]
        p = moved
    return p


def _harmed(p: FloatArray, moved: FloatArray, t: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Triangles that are turned over, or worse than before and poor."""
    before, after = triangle_shape(p, t), triangle_shape(moved, t)
    area, new_area = doubled_area(p, t), doubled_area(moved, t)
    return (np.sign(area) != np.sign(new_area)) | ((after < before) & (after < _GOOD))
