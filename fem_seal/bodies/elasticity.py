"""Axisymmetric linear elasticity on a straight-sided triangle mesh with quadratic displacement.

Stress at the nodes is recovered from patches of triangles (Zienkiewicz and Zhu). The strain of quadratic triangles
is best inside them, and at their corners too large or too small by the same on all sides, so that no mean over the
triangles around a node heals it. Here a quadratic function is fitted to the strains inside the triangles around each
vertex (superconvergent patch recovery: Zienkiewicz and Zhu, Int. J. Numer. Methods Eng. 33, 1331 (1992)): its value is
the strain at the vertex, and its slopes give those on the edges between.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix

from fem_seal.materials import Material

if TYPE_CHECKING:
    from skfem import MeshTri

    from fem_seal.arrays import FloatArray, IntArray


# Corners, then the middles of the edges 01, 12, 20, in the reference triangle: the order of `quadratic_nodes`.
NODES = np.array([[0, 1, 0, 0.5, 0.5, 0], [0, 0, 1, 0, 0.5, 0.5]])
# A point is on the axis that is this near to it, as a share of the body's radius.
AXIS = 1e-12


def lame_parameters(material: Material) -> tuple[float, float]:
    """Return lambda and mu [Pa] of an isotropic solid."""
    E, nu = material.youngs_modulus, material.poissons_ratio
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


def elasticity_matrix(material: Material) -> FloatArray:
    """D of sigma = D epsilon over (rr, zz, tt, rz), the shear strain being g_rz = 2 e_rz [Pa]; shape (4, 4)."""
    lam, mu = lame_parameters(material)
    D = np.diag([2 * mu, 2 * mu, 2 * mu, mu])
    D[:3, :3] += lam
    return D


def without_free_strain(
    stress: FloatArray, material: Material, free_strain: FloatArray | float
) -> FloatArray:
    """Stress (nodes, 4) [Pa] without that of the part of the strain, the same in all directions, that takes none."""
    if not np.any(free_strain):
        return stress
    lam, mu = lame_parameters(material)
    restraint = (3 * lam + 2 * mu) * np.broadcast_to(free_strain, len(stress))
    return stress - restraint[:, None] * [1.0, 1.0, 1.0, 0.0]


def quadrature() -> tuple[FloatArray, FloatArray]:
    """Points (2, q) and weights (q,) in the reference triangle, exact for constant strain times r."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    return get_quadrature(RefTri, 4)


def quadrature_radius(mesh: MeshTri) -> FloatArray:
    """Distance of the quadrature points from the axis [m]; shape (elements, points)."""
    return np.asarray(mesh.mapping().F(quadrature()[0])[0])


def ring_volume(mesh: MeshTri) -> FloatArray:
    """Volume that each quadrature point stands for, 2 pi r dr dz [m^3]; shape (elements, points)."""
    points, weights = quadrature()
    return 2 * np.pi * quadrature_radius(mesh) * (np.abs(mesh.mapping().detDF(points)) * weights)


def shape_functions(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The six quadratic shape functions of the reference triangle and their gradients.

    Parameters
    ----------
    points : ndarray, shape (2, q)
        In the reference triangle.

    Returns
    -------
    values : ndarray, shape (q, 6)
        In the order of `quadratic_nodes`.
    gradients : ndarray, shape (q, 6, 2)
    """
    corner = np.stack([1 - points[0] - points[1], *points], axis=1)
    slope = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    first, second = np.array([0, 1, 2]), np.array([1, 2, 0])
    values = np.hstack([corner * (2 * corner - 1), 4 * corner[:, first] * corner[:, second]])
    at_corners = (4 * corner - 1)[..., None] * slope
    on_edges = 4 * (corner[:, first, None] * slope[second] + corner[:, second, None] * slope[first])
    return values, np.concatenate([at_corners, on_edges], axis=1)


def edge_shapes(t: FloatArray) -> FloatArray:
    """Quadratic shape functions of start, end and middle of an edge at shares `t` of the way along it; shape (3, n)."""
    return np.stack([(1 - t) * (1 - 2 * t), t * (2 * t - 1), 4 * t * (1 - t)])


def edge_slopes(t: FloatArray) -> FloatArray:
    """Derivatives of `edge_shapes` over t, shape (3, n)."""
    return np.stack([4 * t - 3, 4 * t - 1, 4 - 8 * t])


def shape_gradients(mesh: MeshTri, points: FloatArray) -> FloatArray:
    """Gradients (d/dr, d/dz) of the quadratic shape functions [1/m]; shape (elements, points, 6, 2).

    Parameters
    ----------
    points : ndarray, shape (2, q)
        In the reference triangle.
    """
    _, gradients = shape_functions(points)
    if not mesh.affine:
        # curved triangles, each point with a map of its own
        return np.asarray(np.einsum("qsi,ijeq->eqsj", gradients, mesh.mapping().invDF(points)))
    (a, b), (c, d) = mesh.p[:, mesh.t[1:]] - mesh.p[:, mesh.t[:1]]  # dr/ds, dr/dt, dz/ds, dz/dt
    inverse = np.moveaxis(np.array([[d, -b], [-c, a]]) / (a * d - b * c), -1, 0)
    return (gradients.reshape(-1, 2) @ inverse).reshape(len(inverse), *gradients.shape)


def strain_matrix(mesh: MeshTri) -> FloatArray:
    """Strains of each shape function at the quadrature points [1/m]; shape (elements, points, 4, shapes).

    e_rr = du_r/dr, e_zz = du_z/dz, e_tt = u_r/r, g_rz = du_r/dz + du_z/dr. On the axis u_r/r is its limit du_r/dr.
    """
    r, points = quadrature_radius(mesh), quadrature()[0]
    on_axis = r < AXIS * mesh.p[0].max()
    gradients = shape_gradients(mesh, points)
    along_r, along_z = gradients[..., 0], gradients[..., 1]
    B = np.zeros((*r.shape, 4, 12))
    B[..., 0, ::2] = B[..., 3, 1::2] = along_r
    B[..., 1, 1::2] = B[..., 3, ::2] = along_z
    over_r = shape_functions(points)[0] / np.where(on_axis, 1.0, r)[..., None]
    B[..., 2, ::2] = np.where(on_axis[..., None], along_r, over_r)
    return B


def element_stiffness(mesh: MeshTri, material: Material) -> FloatArray:
    """Stiffness int 2 pi r sigma(u) : epsilon(v) dr dz of every element [N/m]; shape (elements, shapes, shapes)."""
    B = strain_matrix(mesh)
    return contract(B, ring_volume(mesh)[..., None, None] * (elasticity_matrix(material) @ B))


def contract(strain: FloatArray, stress: FloatArray) -> FloatArray:
    """Sum of stress : strain over the points of each element, both (elements, points, components, shapes)."""
    flat = (len(strain), -1, strain.shape[-1])
    return np.asarray(strain.reshape(flat).transpose(0, 2, 1) @ stress.reshape(flat))


def stiffness_matrix(mesh: MeshTri, material: Material) -> csr_matrix:
    """Assembled `element_stiffness` [N/m]."""
    return assemble_elements(element_stiffness(mesh, material), element_dofs(mesh), node_dofs(mesh).size)


def assemble_elements(local: FloatArray, dofs: IntArray, size: int) -> csr_matrix:
    """Sum of element matrices (elements, k, k) over the dofs of their shapes (elements, k); shape (size, size)."""
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    return csr_matrix((local.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))


def pressure_load(mesh: MeshTri, boundary: str) -> FloatArray:
    """Nodal forces [N] of a unit pressure (1 Pa, pushing into the body) on a named boundary; none if it is missing.

    Over a straight edge r times a quadratic shape function is integrated exactly by Simpson's rule.
    """
    forces = np.zeros(node_dofs(mesh).size)
    if boundary not in (mesh.boundaries or {}):
        # A contact line that reaches to the end of its face leaves nothing wetted beside it.
        return forces
    facets = np.asarray((mesh.boundaries or {})[boundary])
    start, end = mesh.facets[:, facets]
    edge = mesh.p[:, end] - mesh.p[:, start]
    triangle = np.empty(mesh.facets.shape[1], dtype=np.int64)
    triangle[mesh.t2f] = np.arange(mesh.t.shape[1])
    into = mesh.p[:, mesh.t[:, triangle[facets]].sum(axis=0) - start - end] - mesh.p[:, start]
    normal = np.stack([-edge[1], edge[0]])
    normal *= np.sign((normal * into).sum(axis=0))  # as long as the edge
    r = mesh.p[0]
    for nodes, radius, weight in (
        (start, r[start], 1 / 6),
        (end, r[end], 1 / 6),
        (mesh.p.shape[1] + facets, 0.5 * (r[start] + r[end]), 4 / 6),
    ):
        np.add.at(forces, node_dofs(mesh)[:, nodes], 2 * np.pi * weight * radius * normal)
    return forces


def at_quadrature_points(mesh: MeshTri, nodal: FloatArray) -> FloatArray:
    """Values at the quadrature points of a quadratic field given at the nodes (n,); shape (elements, points)."""
    _, triangles = quadratic_nodes(mesh)
    return np.asarray(nodal[triangles] @ shape_functions(quadrature()[0])[0].T)


def grown_by_one(mesh: MeshTri) -> FloatArray:
    """Displacement of a body that grows by a strain of 1 in all directions: its own coordinates [m]; shape (dofs,)."""
    return quadratic_nodes(mesh)[0].ravel()


def thermal_load(mesh: MeshTri, material: Material, strain: FloatArray) -> FloatArray:
    """Nodal forces [N] of a free strain e the same in all directions: int 2 pi r D (e, e, e, 0) : epsilon(v) dr dz.

    Parameters
    ----------
    strain : ndarray, shape (elements, points) or (1, 1)
        At the quadrature points [-].
    """
    lam, mu = lame_parameters(material)
    dilatation = strain_matrix(mesh)[..., :3, :].sum(axis=2)  # relative volume of each shape function
    weight = (3 * lam + 2 * mu) * strain * ring_volume(mesh)
    local = np.einsum("eqs,eq->se", dilatation, weight)
    return np.asarray(np.bincount(element_dofs(mesh).T.ravel(), local.ravel()), dtype=np.float64)


def quadratic_nodes(mesh: MeshTri) -> tuple[FloatArray, IntArray]:
    """Corner and mid-edge points (n, 2) [m] and the triangles (m, 6) over them, in VTK's order."""
    points = np.hstack([mesh.p, mesh.p[:, mesh.facets].mean(axis=1)]).T
    return points, np.vstack([mesh.t, mesh.nvertices + mesh.t2f]).T


def node_dofs(mesh: MeshTri) -> IntArray:
    """Radial and axial dof of every quadratic node, shape (2, n)."""
    return np.arange(2 * (mesh.nvertices + mesh.nfacets)).reshape(-1, 2).T


def element_dofs(mesh: MeshTri) -> IntArray:
    """Dofs of the shapes of every triangle, radial and axial by turns; shape (elements, 12)."""
    _, triangles = quadratic_nodes(mesh)
    return np.stack([2 * triangles, 2 * triangles + 1], axis=-1).reshape(len(triangles), 12)


def boundary_dofs(mesh: MeshTri, boundary: str, component: int) -> IntArray:
    """Radial (0) or axial (1) dofs of the nodes on a named boundary."""
    return node_dofs(mesh)[component, boundary_nodes(mesh, boundary)]


def boundary_nodes(mesh: MeshTri, boundary: str) -> IntArray:
    """Quadratic nodes on a named boundary."""
    facets = np.asarray((mesh.boundaries or {})[boundary])
    return np.unique([*mesh.facets[:, facets], mesh.nvertices + facets])


def node_shares(mesh: MeshTri) -> FloatArray:
    """Share of each triangle in the mean over those that meet at its nodes, by area; shape (m, 6)."""
    _, triangles = quadratic_nodes(mesh)
    (a, b), (c, d) = mesh.p[:, mesh.t[1:]].transpose(1, 0, 2) - mesh.p[:, mesh.t[0]]
    area = 0.5 * np.abs(a * d - b * c)
    return area[:, None] / np.bincount(triangles.ravel(), np.repeat(area, 6))[triangles]


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
        nodal = displacement.reshape(len(points), 2, -1)
        strains = self._strain_matrices @ nodal[triangles].reshape(len(triangles), 12, -1)
        nodal_strains = self._at_nodes(strains.reshape(3 * len(triangles), -1))
        on_axis = points[:, 0] < AXIS * points[:, 0].max()
        radius = np.where(on_axis, 1.0, points[:, 0])[:, None]
        hoop = np.where(on_axis[:, None], nodal_strains[:, 0], nodal[:, 0] / radius)
        strain = np.stack([nodal_strains[:, 0], nodal_strains[:, 1], hoop, nodal_strains[:, 2]], axis=1)
        stress = elasticity_matrix(self.material) @ strain
        return np.asarray(stress.reshape(len(points), 4, *displacement.shape[1:]))

    @cached_property
    def _nodes(self) -> tuple[FloatArray, IntArray]:
        return quadratic_nodes(self.mesh)

    @cached_property
    def _strain_matrices(self) -> FloatArray:
        """Strains (rr, zz, g_rz) at the points of every triangle from what moves its nodes [1/m]; (elements, 9, 12)."""
        along_r, along_z = np.moveaxis(shape_gradients(self.mesh, _POINTS), 3, 0)
        strains = np.zeros((*along_r.shape[:2], 3, 6, 2))
        strains[:, :, 0, :, 0] = strains[:, :, 2, :, 1] = along_r
        strains[:, :, 1, :, 1] = strains[:, :, 2, :, 0] = along_z
        return strains.reshape(len(strains), 9, 12)

    def _at_nodes(self, strains: FloatArray) -> FloatArray:
        """Values at the nodes, shape (nodes, 3, k), from those at the points, shape (points, 3 k)."""
        mesh = self.mesh
        value, along_r, along_z = (self._fit @ strains).reshape(3, mesh.p.shape[1], -1)
        start, end = mesh.facets
        length_r, length_z = (mesh.p[:, end] - mesh.p[:, start])[..., None]
        # a cubic function with these values and slopes at both ends, in the middle
        curvature = length_r * (along_r[start] - along_r[end]) + length_z * (along_z[start] - along_z[end])
        nodes = np.concatenate([value, 0.5 * (value[start] + value[end]) + curvature / 8])
        return nodes.reshape(len(nodes), 3, -1)

    @cached_property
    def _fit(self) -> csr_matrix:
        """Value and slopes [1/m] at every vertex from what stands at the points; (3 vertices, 3 triangles)."""
        mesh = self.mesh
        vertex, element = _patches(mesh)
        begin = np.searchsorted(vertex, np.arange(mesh.p.shape[1]))
        corners = np.stack([1 - _POINTS[0] - _POINTS[1], *_POINTS], axis=1)
        places = corners @ mesh.p[:, mesh.t]  # (2, points, elements)
        # take, unlike an index, leaves the many pairs of vertex and triangle side by side in memory
        offset = places.take(element, axis=2) - mesh.p.take(vertex, axis=1)[:, None]
        size = np.sqrt(np.maximum.reduceat((offset**2).sum(axis=0).max(axis=0), begin))
        x, y = offset / size[vertex]
        # all x^i y^j up to the fourth degree, summed over each patch, are the entries of its normal equations
        of_x, of_y = (np.stack([np.ones_like(a), a, a * a, a * a * a, a * a * a * a]) for a in (x, y))
        powers = of_x[_POWERS[0]] * of_y[_POWERS[1]]
        normal = np.add.reduceat(powers.sum(axis=1), begin, axis=1)[_PRODUCTS].transpose(2, 0, 1)
        normal[:, [3, 4, 5], [3, 4, 5]] += _LINEAR * normal[:, :1, 0]
        weights = np.linalg.solve(normal, np.broadcast_to(np.eye(6)[:, :3], (len(normal), 6, 3))).T
        weights[1:] /= size
        shares = np.einsum("atp,tqp->apq", weights.take(vertex, axis=2), powers[:6])
        columns = 3 * element[:, None] + np.arange(3)
        starts = np.append(3 * begin, columns.size)
        return csr_matrix(
            (
                shares.ravel(),
                np.tile(columns.ravel(), 3),
                np.concatenate([[0], *(starts[1:] + n * columns.size for n in range(3))]),
            ),
            shape=(3 * len(begin), 3 * mesh.nelements),
        )


def _patches(mesh: MeshTri) -> tuple[IntArray, IntArray]:
    """Vertices, increasing, and the triangles around each; on the boundary those next to them as well."""
    elements, corner, side = mesh.nelements, mesh.t.ravel(), mesh.t2f.ravel()
    order = np.argsort(corner, kind="stable")
    vertex, triangle = corner[order].astype(np.int64), order % elements
    # both triangles of every edge; on the boundary -1 instead of the second
    by_side = np.argsort(side, kind="stable")
    second = np.append(False, np.diff(side[by_side]) == 0)
    pair = np.full((2, mesh.facets.shape[1]), -1)
    pair[second.astype(int), side[by_side]] = by_side % elements
    edge = np.zeros(mesh.p.shape[1], dtype=bool)
    edge[mesh.facets[:, pair[1] < 0]] = True
    outer = edge[vertex]
    neighbours = pair[:, mesh.t2f[:, triangle[outer]]]
    wider = (vertex[outer] * elements + neighbours)[neighbours >= 0]
    pairs = np.concatenate([vertex[~outer] * elements + triangle[~outer], np.unique(wider)])
    pairs.sort()
    return pairs // elements, pairs % elements


def strain_size(strain: FloatArray) -> FloatArray:
    """Size (...) of strains (..., 2) in the plane of a face, that of metal that keeps its volume but for a factor."""
    return np.sqrt((strain**2).sum(axis=-1) + strain.prod(axis=-1))


def larger_strain(first: FloatArray, second: FloatArray) -> FloatArray:
    """At each place the larger one of two strains (..., 2) in the plane of a face."""
    return np.where((strain_size(second) > strain_size(first))[..., None], second, first)


def over_pressure(strain: FloatArray, pressure: FloatArray) -> FloatArray:
    """Strains times a pressure (m, 2) over a pressure (m,); zero where there is none."""
    # one over less than this is no number
    inverse = np.divide(1.0, pressure, out=np.zeros_like(pressure), where=pressure > 1e-100)
    return strain * inverse[:, None]
