"""Displacement, stress and plastic strain of a body at the nodes of its triangles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from fem_seal.arrays import FloatArray
from fem_seal.bodies.elasticity import lame_parameters, node_dofs, quadratic_nodes
from fem_seal.bodies.elastoplastic import BodyState, ElastoplasticBody
from fem_seal.bodies.held_body import HeldBody
from fem_seal.materials import Material
from fem_seal.profile import PressureProfile

if TYPE_CHECKING:
    from skfem import Basis, MeshTri


_NODES = np.array([[0, 1, 0, 0.5, 0.5, 0], [0, 0, 1, 0, 0.5, 0.5]])


@dataclass(frozen=True)
class BodyField:
    """Displacement and stress of one body at the nodes of its quadratic triangles.

    Parameters
    ----------
    name : str
        "closure" or "seat".
    points : ndarray, shape (n, 2)
        (r, z) [m].
    triangles6 : ndarray of int, shape (m, 6)
        Corners, then the middles of the edges 01, 12, 20 (VTK's order).
    displacement : ndarray, shape (n, 2)
        (u_r, u_z) [m]; the closure's rigid approach is not part of it.
    stress : ndarray, shape (n, 4)
        sigma_rr, sigma_zz, sigma_tt (hoop), sigma_rz [Pa], averaged over the elements that share a node.
    contact_nodes : ndarray of int
        Nodes on the contact line, along increasing x.
    contact_x : ndarray
        Their arc length from first touch [m].
    contact_pressure : ndarray, shape (n,)
        Contact pressure [Pa] at the nodes of the contact line, zero elsewhere.
    """

    name: str
    points: FloatArray
    triangles6: NDArray[np.int64]
    displacement: FloatArray
    stress: FloatArray
    contact_nodes: NDArray[np.int64]
    contact_x: FloatArray
    contact_pressure: FloatArray

    @property
    def von_mises(self) -> FloatArray:
        """von Mises stress at the nodes [Pa]."""
        return von_mises(self.stress)


def von_mises(stress: FloatArray) -> FloatArray:
    """von Mises stress [Pa] of (..., 4) arrays sigma_rr, sigma_zz, sigma_tt, sigma_rz [Pa]."""
    rr, zz, tt, rz = np.moveaxis(stress, -1, 0)
    return np.sqrt(0.5 * ((rr - zz) ** 2 + (zz - tt) ** 2 + (tt - rr) ** 2) + 3 * rz**2)


def stress_operator(basis: Basis, material: Material) -> csr_matrix:
    """Matrix from displacement dofs [m] to nodal stress [Pa], rows 4 i + (rr, zz, tt, rz) of node i.

    The gradient is evaluated at the six nodes of each triangle and averaged over the triangles that share a
    node, weighted by their area. On the axis u_r/r is replaced by its limit du_r/dr.
    """
    mesh = basis.mesh
    points, triangles = quadratic_nodes(mesh)
    dofs = node_dofs(basis)[:, triangles]  # (2, m, 6)
    gradient, area = _nodal_gradients(mesh)  # (m, node 6, shape 6, 2), (m,)
    weight = np.bincount(triangles.ravel(), np.repeat(area, 6), minlength=len(points))
    share = area[:, None] / weight[triangles]
    lam, mu = lame_parameters(material)
    r = points[triangles, 0]
    on_axis = r < 1e-12 * points[:, 0].max()
    d_r, d_z = gradient[..., 0], gradient[..., 1]
    hoop = np.where(on_axis[..., None], d_r, np.eye(6) / np.where(on_axis, 1.0, r)[..., None])
    zero = np.zeros_like(d_r)
    strain_r = np.stack([d_r, zero, hoop, d_z])  # rr, zz, tt, g_rz from u_r
    strain_z = np.stack([zero, d_z, zero, d_r])
    elastic = np.diag([2 * mu, 2 * mu, 2 * mu, mu])
    elastic[:3, :3] += lam
    shape = (4, *triangles.shape, 6)
    rows = np.broadcast_to((4 * triangles + np.arange(4)[:, None, None])[..., None], shape)
    data, columns = [], []
    for strain, dof in zip((strain_r, strain_z), dofs, strict=True):
        data.append(np.einsum("ij,jmab,ma->imab", elastic, strain, share))
        columns.append(np.broadcast_to(dof[None, :, None, :], shape))
    entries = np.stack(data).ravel()
    index = (np.stack([rows, rows]).ravel(), np.stack(columns).ravel())
    return csr_matrix((entries, index), shape=(4 * len(points), basis.N))


def _nodal_gradients(mesh: MeshTri) -> tuple[FloatArray, FloatArray]:
    """Gradients of the six quadratic shape functions at the six nodes, and the areas of the triangles."""
    x, y = _NODES
    l0, one, zero = 1 - x - y, np.ones(6), np.zeros(6)
    reference = (
        np.array(
            [
                [1 - 4 * l0, 1 - 4 * l0],
                [4 * x - 1, zero],
                [zero, 4 * y - 1],
                [4 * (l0 - x), -4 * x],
                [4 * y, 4 * x],
                [-4 * y, 4 * (l0 - y)],
            ]
        )
        * one
    )  # (shape, direction, node)
    p, t = mesh.p, mesh.t
    jacobian = np.stack([p[:, t[1]] - p[:, t[0]], p[:, t[2]] - p[:, t[0]]], axis=1)  # (xy, reference, m)
    inverse = np.linalg.inv(np.moveaxis(jacobian, -1, 0))  # (m, reference, xy)
    return np.einsum("sdn,mdk->mnsk", reference, inverse), 0.5 * np.abs(
        np.linalg.det(np.moveaxis(jacobian, -1, 0))
    )


@dataclass(frozen=True)
class ElastoplasticField(BodyField):
    """A `BodyField` with plastic strain.

    Parameters
    ----------
    equivalent_stress : ndarray, shape (n,)
        von Mises stress [Pa], averaged as such: where the body flows it is the flow stress, which that of the averaged
        `stress` need not be.
    plastic_strain : ndarray, shape (n, 4)
        (rr, zz, tt, g_rz) [-].
    accumulated_plastic_strain : ndarray, shape (n,)
        [-].
    """

    equivalent_stress: FloatArray
    plastic_strain: FloatArray
    accumulated_plastic_strain: FloatArray

    @property
    def von_mises(self) -> FloatArray:
        """von Mises stress at the nodes [Pa]."""
        return self.equivalent_stress


def elastoplastic_field(
    held: HeldBody,
    solid: ElastoplasticBody,
    state: BodyState,
    contact: PressureProfile | None = None,
) -> ElastoplasticField:
    """Nodal values of a body's state.

    Parameters
    ----------
    held : HeldBody
    solid : ElastoplasticBody
    state : BodyState
    contact : PressureProfile, optional
        What presses on it.
    """
    points, triangles = quadratic_nodes(held.basis.mesh)
    pressure = np.zeros(len(points))
    if contact is not None:
        with np.errstate(under="ignore"):
            pressure[held.contact_nodes] = np.interp(held.contact_x, contact.x, contact.pressure)

    def at_nodes(values: FloatArray) -> FloatArray:
        """Nodal values that do not leave the range of those at the quadrature points, as a linear fit may."""
        return np.clip(solid.nodal_average @ values.ravel(), values.min(), values.max())

    return ElastoplasticField(
        held.name,
        points,
        triangles,
        held.counted(state.displacement)[node_dofs(held.basis)].T,
        solid.nodal_average @ state.stress.reshape(-1, 4),
        held.contact_nodes,
        held.contact_x,
        pressure,
        at_nodes(von_mises(state.stress)),
        solid.nodal_average @ state.plastic.strain.reshape(-1, 4),
        at_nodes(state.plastic.accumulated),
    )
