"""Stress of an elastic body at its nodes, recovered from patches of triangles (Zienkiewicz and Zhu).

The strain of quadratic triangles is best inside them, and at their corners too large or too small by the same on all
sides, so that no mean over the triangles around a node heals it. Here a quadratic function is fitted to the strains
inside the triangles around each vertex (superconvergent patch recovery: Zienkiewicz and Zhu, Int. J. Numer. Methods
Eng. 33, 1331 (1992)): its value is the strain at the vertex, and its slopes give those on the edges between.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix

from fem_seal.bodies.elasticity import AXIS, elasticity_matrix, quadratic_nodes, shape_gradients
from fem_seal.materials import Material

if TYPE_CHECKING:
    from skfem import MeshTri

    from fem_seal.arrays import FloatArray, IntArray

# Where the strain of a triangle is taken, in the reference triangle: Gauss' points of the second degree.
_POINTS = np.array([[1, 4, 1], [1, 1, 4]]) / 6
# Weight of the assumption that the strain is linear, which matters only where a patch does not tell.
_LINEAR = 1e-6
# Exponents of x and y in all products of up to the fourth degree, by degree: the first six are the terms of a quadratic
# function. And which of them is the product of two terms.
_POWERS = np.array([(n - j, j) for n in range(5) for j in range(n + 1)]).T
_DEGREES = _POWERS[:, :6, None] + _POWERS[:, None, :6]
_PRODUCTS = _DEGREES.sum(axis=0) * (_DEGREES.sum(axis=0) + 1) // 2 + _DEGREES[1]


@dataclass(frozen=True, eq=False)
class StressRecovery:
    """From displacements of a body to its stress at the nodes.

    Parameters
    ----------
    mesh : skfem.MeshTri
    material : Material
    """

    mesh: MeshTri
    material: Material

    def stress(self, displacement: FloatArray) -> FloatArray:
        """Stress (rr, zz, tt, rz) [Pa] at the quadratic nodes, shape (nodes, 4, ...).

        Parameters
        ----------
        displacement : ndarray, shape (dofs,) or (dofs, k)
            [m]; many at once take far less time than one after the other.
        """
        points, triangles = self._nodes
        # the dofs of node i are 2 i and 2 i + 1
        moved = displacement.reshape(len(points), 2, -1)
        inside = self._inside @ moved[triangles].reshape(len(triangles), 12, -1)
        recovered = self._at_nodes(inside.reshape(3 * len(triangles), -1))
        on_axis = points[:, 0] < AXIS * points[:, 0].max()
        radius = np.where(on_axis, 1.0, points[:, 0])[:, None]
        hoop = np.where(on_axis[:, None], recovered[:, 0], moved[:, 0] / radius)
        strain = np.stack([recovered[:, 0], recovered[:, 1], hoop, recovered[:, 2]], axis=1)
        stress = elasticity_matrix(self.material) @ strain
        return np.asarray(stress.reshape(len(points), 4, *displacement.shape[1:]))

    @cached_property
    def _nodes(self) -> tuple[FloatArray, IntArray]:
        return quadratic_nodes(self.mesh)

    @cached_property
    def _inside(self) -> FloatArray:
        """Strains (rr, zz, g_rz) at the points of every triangle from what moves its nodes [1/m]; (elements, 9, 12)."""
        along_r, along_z = np.moveaxis(shape_gradients(self.mesh, _POINTS), 3, 0)
        strains = np.zeros((*along_r.shape[:2], 3, 6, 2))
        strains[:, :, 0, :, 0] = strains[:, :, 2, :, 1] = along_r
        strains[:, :, 1, :, 1] = strains[:, :, 2, :, 0] = along_z
        return strains.reshape(len(strains), 9, 12)

    def _at_nodes(self, inside: FloatArray) -> FloatArray:
        """Values at the nodes, shape (nodes, 3, k), from those at the points, shape (points, 3 k)."""
        mesh = self.mesh
        value, along_r, along_z = (self._fit @ inside).reshape(3, mesh.p.shape[1], -1)
        start, end = mesh.facets
        length_r, length_z = (mesh.p[:, end] - mesh.p[:, start])[..., None]
        # a cubic function with these values and slopes at both ends, in the middle
        bent = length_r * (along_r[start] - along_r[end]) + length_z * (along_z[start] - along_z[end])
        nodes = np.concatenate([value, 0.5 * (value[start] + value[end]) + bent / 8])
        return nodes.reshape(len(nodes), 3, -1)

    @cached_property
    def _fit(self) -> csr_matrix:
        """Value and slopes [1/m] at every vertex from what stands at the points; (3 vertices, 3 triangles)."""
        mesh = self.mesh
        vertex, element = _patches(mesh)
        first = np.searchsorted(vertex, np.arange(mesh.p.shape[1]))
        corners = np.stack([1 - _POINTS[0] - _POINTS[1], *_POINTS], axis=1)
        places = corners @ mesh.p[:, mesh.t]  # (2, points, elements)
        # take, unlike an index, leaves the many pairs of vertex and triangle side by side in memory
        apart = places.take(element, axis=2) - mesh.p.take(vertex, axis=1)[:, None]
        size = np.sqrt(np.maximum.reduceat((apart**2).sum(axis=0).max(axis=0), first))
        x, y = apart / size[vertex]
        # all x^i y^j up to the fourth degree, summed over each patch, are the entries of its normal equations
        of_x, of_y = (np.stack([np.ones_like(a), a, a * a, a * a * a, a * a * a * a]) for a in (x, y))
        powers = of_x[_POWERS[0]] * of_y[_POWERS[1]]
        normal = np.add.reduceat(powers.sum(axis=1), first, axis=1)[_PRODUCTS].transpose(2, 0, 1)
        normal[:, [3, 4, 5], [3, 4, 5]] += _LINEAR * normal[:, :1, 0]
        weights = np.linalg.solve(normal, np.broadcast_to(np.eye(6)[:, :3], (len(normal), 6, 3))).T
        weights[1:] /= size
        shares = np.einsum("atp,tqp->apq", weights.take(vertex, axis=2), powers[:6])
        columns = 3 * element[:, None] + np.arange(3)
        starts = np.append(3 * first, columns.size)
        return csr_matrix(
            (
                shares.ravel(),
                np.tile(columns.ravel(), 3),
                np.concatenate([[0], *(starts[1:] + n * columns.size for n in range(3))]),
            ),
            shape=(3 * len(first), 3 * mesh.nelements),
        )


def _patches(mesh: MeshTri) -> tuple[IntArray, IntArray]:
    """Vertices, increasing, and the triangles around each; on the boundary those next to them as well."""
    elements, corner, side = mesh.nelements, mesh.t.ravel(), mesh.t2f.ravel()
    order = np.argsort(corner, kind="stable")
    vertex, around = corner[order].astype(np.int64), order % elements
    # both triangles of every edge; on the boundary -1 instead of the second
    by_side = np.argsort(side, kind="stable")
    second = np.append(False, np.diff(side[by_side]) == 0)
    pair = np.full((2, mesh.facets.shape[1]), -1)
    pair[second.astype(int), side[by_side]] = by_side % elements
    edge = np.zeros(mesh.p.shape[1], dtype=bool)
    edge[mesh.facets[:, pair[1] < 0]] = True
    outer = edge[vertex]
    beside = pair[:, mesh.t2f[:, around[outer]]]
    wider = (vertex[outer] * elements + beside)[beside >= 0]
    found = np.concatenate([vertex[~outer] * elements + around[~outer], np.unique(wider)])
    found.sort()
    return found // elements, found % elements
