"""Displacement, stress and plastic strain of a body that yields, at the nodes of its triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_seal.elastoplastic_body import BodyState, ElastoplasticBody
from fem_seal.held_body import HeldBody
from fem_seal.profile import PressureProfile
from fem_seal.stress import BodyField, node_dofs, quadratic_nodes, von_mises

FloatArray = NDArray[np.float64]


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
