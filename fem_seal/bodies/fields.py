"""Displacement, stress and plastic strain of a body at the nodes of its triangles."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fem_seal.arrays import FloatArray, IntArray
from fem_seal.bodies.constrained_body import ConstrainedBody
from fem_seal.bodies.elasticity import node_dofs
from fem_seal.bodies.elastoplastic import BodyState, ElastoplasticBody
from fem_seal.profile import PressureProfile


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
        sigma_rr, sigma_zz, sigma_tt (hoop), sigma_rz [Pa], recovered from the triangles around each node: of an elastic
        body see `fem_seal.bodies.elasticity`, of one that yields their mean.
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
    triangles6: IntArray
    displacement: FloatArray
    stress: FloatArray
    contact_nodes: IntArray
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


def body_field(
    body: ConstrainedBody,
    displacement: FloatArray,
    stress: FloatArray,
    contact: PressureProfile | None = None,
    temperature: FloatArray | float | None = None,
) -> BodyField:
    """Nodal values of a body.

    Parameters
    ----------
    displacement : ndarray, shape (dofs,)
        [m]
    stress : ndarray, shape (n, 4)
        [Pa]
    contact : PressureProfile, optional
        What presses on it.
    temperature : ndarray, shape (n,), or float, optional
        At the nodes, or all over [K].
    """
    points, triangles = body.nodes
    pressure = np.zeros(len(points))
    if contact is not None:
        with np.errstate(under="ignore"):
            pressure[body.contact_nodes] = np.interp(body.contact_x, contact.x, contact.pressure)
    return BodyField(
        body.name,
        points,
        triangles,
        displacement[node_dofs(body.mesh)].T,
        stress,
        body.contact_nodes,
        body.contact_x,
        pressure,
        temperature=None if temperature is None else np.broadcast_to(temperature, len(points)),
    )


def elastoplastic_field(
    body: ConstrainedBody,
    solid: ElastoplasticBody,
    state: BodyState,
    contact: PressureProfile | None = None,
    temperature: FloatArray | float | None = None,
) -> ElastoplasticField:
    """Nodal values of a body's state.

    Parameters
    ----------
    contact, temperature
        See `body_field`.
    """

    def at_nodes(values: FloatArray) -> FloatArray:
        """Nodal values that do not leave the range of those at the quadrature points, as a linear fit may."""
        return np.clip(solid.nodal_average @ values.ravel(), values.min(), values.max())

    stress = solid.nodal_average @ state.stress.reshape(-1, 4)
    return ElastoplasticField(
        **vars(body_field(body, body.remove_rigid_motion(state.displacement), stress, contact, temperature)),
        equivalent_stress=at_nodes(von_mises(state.stress)),
        plastic_strain=solid.nodal_average @ state.plastic.strain.reshape(-1, 4),
        accumulated_plastic_strain=at_nodes(state.plastic.accumulated_strain),
    )
