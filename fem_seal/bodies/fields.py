"""Displacement, stress and plastic strain of a body at the nodes of its triangles."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_matrix, csr_matrix

from fem_seal.arrays import FloatArray
from fem_seal.bodies.elasticity import (
    AXIS,
    NODES,
    elasticity_matrix,
    node_dofs,
    node_shares,
    quadratic_nodes,
    shape_gradients,
)
from fem_seal.bodies.elastoplastic import BodyState, ElastoplasticBody
from fem_seal.bodies.held_body import HeldBody
from fem_seal.materials import Material
from fem_seal.profile import PressureProfile

if TYPE_CHECKING:
    from skfem import Basis


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
    temperature : ndarray, shape (n,), or None
        [K]; None where it is not given.
    """

    name: str
    points: FloatArray
    triangles6: NDArray[np.int64]
    displacement: FloatArray
    stress: FloatArray
    contact_nodes: NDArray[np.int64]
    contact_x: FloatArray
    contact_pressure: FloatArray
    temperature: FloatArray | None = field(default=None, kw_only=True)

    @cached_property
    def von_mises(self) -> FloatArray:
        """von Mises stress at the nodes [Pa]."""
        return von_mises(self.stress)


def von_mises(stress: FloatArray) -> FloatArray:
    """von Mises stress [Pa] of (..., 4) arrays sigma_rr, sigma_zz, sigma_tt, sigma_rz [Pa]."""
    rr, zz, tt, rz = np.moveaxis(stress, -1, 0)
    return np.sqrt(0.5 * ((rr - zz) ** 2 + (zz - tt) ** 2 + (tt - rr) ** 2) + 3 * rz**2)


def stress_operator(basis: Basis, material: Material) -> bsr_matrix:
    """Matrix from displacement dofs [m] to nodal stress [Pa], rows 4 i + (rr, zz, tt, rz) of node i.

    The strain is evaluated at the six nodes of each triangle and averaged over the triangles that share a node,
    weighted by their area. Averaged are the gradients: u_r/r at a node is the same in all triangles.
    """
    mesh = basis.mesh
    points, triangles = quadratic_nodes(mesh)
    count = len(points)
    gradients = node_shares(mesh)[..., None, None] * shape_gradients(mesh, NODES)
    rows, columns = np.broadcast_arrays(triangles[:, :, None], triangles[:, None, :])
    # both components at once
    both = gradients[..., 0] + 1j * gradients[..., 1]
    along: csr_matrix = csr_matrix((both.ravel(), (rows.ravel(), columns.ravel())), shape=(count, count))
    over_r, over_z = along.data.real, along.data.imag
    row = np.repeat(np.arange(count), np.diff(along.indptr))
    r = points[row, 0]
    on_axis = r < AXIS * points[:, 0].max()
    hoop = np.where(on_axis, over_r, (row == along.indices) / np.where(on_axis, 1.0, r))
    strain = np.zeros((len(row), 4, 2))
    strain[:, 0, 0] = strain[:, 3, 1] = over_r
    strain[:, 1, 1] = strain[:, 3, 0] = over_z
    strain[:, 2, 0] = hoop
    shape = (4 * count, basis.N)  # node i has the dofs 2 i and 2 i + 1
    return bsr_matrix((elasticity_matrix(material) @ strain, along.indices, along.indptr), shape=shape)


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

    @cached_property
    def von_mises(self) -> FloatArray:
        """von Mises stress at the nodes [Pa]."""
        return self.equivalent_stress


def elastoplastic_field(
    held: HeldBody,
    solid: ElastoplasticBody,
    state: BodyState,
    contact: PressureProfile | None = None,
    temperature: FloatArray | float | None = None,
) -> ElastoplasticField:
    """Nodal values of a body's state.

    Parameters
    ----------
    contact : PressureProfile, optional
        What presses on it.
    temperature : ndarray, shape (n,), or float, optional
        At the nodes, or all over [K].
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
        temperature=None if temperature is None else np.broadcast_to(temperature, len(points)),
    )
