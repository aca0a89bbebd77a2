"""Elastoplastic body on quadratic triangles: radial return at all points at once, internal forces and stiffness.

Strain and stress have the four components of the axisymmetric state, (rr, zz, tt, rz), along the last axis; the
shear strain is the engineering one, g_rz = 2 e_rz. Strains are small.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix

from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.bodies import elasticity
from fem_seal.materials import HardeningCurve, HardeningField, Material

if TYPE_CHECKING:
    from skfem import MeshTri


_UNIT = np.array([1.0, 1.0, 1.0, 0.0])
# From strain with engineering shear to tensor components, and the weights of a double contraction of tensors.
_TENSOR = np.array([1.0, 1.0, 1.0, 0.5])
_DOUBLE = np.array([1.0, 1.0, 1.0, 2.0])

# A point on the yield surface is not yielding: the first tangent of a step is then the elastic one.
_ROUND_OFF = 1e-12


@dataclass(frozen=True)
class PlasticState:
    """What a point remembers of its loading.

    Parameters
    ----------
    strain : ndarray, shape (..., 4)
        Plastic strain (rr, zz, tt, g_rz) [-]; its trace is zero.
    accumulated_strain : ndarray, shape (...)
        int sqrt(2/3 de_p : de_p) [-], never falling.
    """

    strain: FloatArray
    accumulated_strain: FloatArray

    @classmethod
    def virgin(cls, *shape: int) -> PlasticState:
        """No plastic strain yet, at points of an array of this shape."""
        return cls(np.zeros((*shape, 4)), np.zeros(shape))


@dataclass(frozen=True)
class StressUpdate:
    """Answer of the material to a strain.

    Parameters
    ----------
    stress : ndarray, shape (..., 4)
        (rr, zz, tt, rz) [Pa].
    tangent : ndarray, shape (..., 4, 4)
        d stress/d strain of the whole step [Pa], symmetric.
    state : PlasticState
        At the end of the step.
    yielding : ndarray of bool, shape (...)
        Where plastic strain grew in this step.
    """

    stress: FloatArray
    tangent: FloatArray
    state: PlasticState
    yielding: BoolArray


def radial_return(
    strain: FloatArray, start: PlasticState, material: Material, hardening: HardeningCurve | HardeningField
) -> StressUpdate:
    """Stress after a step from `start` to a given strain, by one implicit Euler step (radial return).

    Parameters
    ----------
    strain : ndarray, shape (..., 4)
        Whole strain at the end of the step.
    start : PlasticState
        At the beginning of the step.
    hardening : HardeningCurve or HardeningField
        One curve for all points, or one for each.

    Notes
    -----
    The flow stress is piecewise linear, so that the return needs no iteration: with the accumulated strain p and
    the trial stress q, q + 3 mu p_before = flow stress(p) + 3 mu p is solved for p by interpolation.

    References
    ----------
    Simo, Taylor, Comput. Methods Appl. Mech. Eng. 48, 101 (1985); de Souza Neto, Peric, Owen, Computational
    Methods for Plasticity (2008), box 7.3 and eq. 7.120.
    """
    lam, mu = elasticity.lame_parameters(material)
    bulk = lam + 2 * mu / 3
    trial = (strain - start.strain) @ elasticity.elasticity_matrix(material)
    mean = trial @ _UNIT / 3
    deviator = trial - mean[..., None] * _UNIT
    q = np.sqrt(1.5 * (deviator**2 @ _DOUBLE))
    strain_before = start.accumulated_strain
    yielding = q > (1 + _ROUND_OFF) * hardening.flow_stress(strain_before)
    p = np.where(yielding, hardening.plastic_strain_at(q + 3 * mu * strain_before, 3 * mu), strain_before)
    # most points of a body stay elastic: the rest is for those that flow
    flows = np.asarray(yielding)
    increment, size = np.asarray(p - strain_before)[flows], np.asarray(q)[flows]
    deviator = deviator[flows]
    normal = deviator / (np.sqrt(2 / 3) * size)[:, None]  # unit tensor along the flow
    shrink = 3 * mu * increment / size
    stress, plastic = trial, start.strain.copy()
    stress[flows] -= shrink[:, None] * deviator
    plastic[flows] += np.sqrt(1.5) * increment[:, None] * normal / _TENSOR

    deviatoric = np.diag(_TENSOR) - np.outer(_UNIT, _UNIT) / 3
    normal_modulus = 2 * mu * (3 * mu / (3 * mu + np.asarray(hardening.slope(p))[flows]) - shrink)
    tangent = np.broadcast_to(elasticity.elasticity_matrix(material), (*flows.shape, 4, 4)).copy()
    tangent[flows] = (
        bulk * np.outer(_UNIT, _UNIT)
        + (2 * mu * (1 - shrink))[:, None, None] * deviatoric
        - normal_modulus[:, None, None] * normal[:, :, None] * normal[:, None, :]
    )
    return StressUpdate(stress, tangent, PlasticState(plastic, p), yielding)


@dataclass(frozen=True)
class BodyState:
    """Where an elastoplastic body is on its path.

    Parameters
    ----------
    displacement : ndarray, shape (dofs,)
        [m].
    stress : ndarray, shape (elements, points, 4)
        (rr, zz, tt, rz) at the quadrature points [Pa].
    plastic : PlasticState
        At the quadrature points.
    """

    displacement: FloatArray
    stress: FloatArray
    plastic: PlasticState


@dataclass(frozen=True)
class ElastoplasticBody:
    """A body of J2 material with isotropic hardening, small strain.

    Parameters
    ----------
    mesh : skfem.MeshTri
    material : Material
        With its hardening curve.
    temperature : ndarray, shape (elements, points), optional
        At the quadrature points [K], where it differs from place to place; of a material whose hardening curve depends
        on it each point then has its own.

    Raises
    ------
    ValueError
        If the material has no hardening curve.
    """

    mesh: MeshTri
    material: Material
    temperature: FloatArray | None = None

    def __post_init__(self) -> None:
        if self.material.hardening is None:
            raise ValueError(f"{self.material.name}: has no hardening curve, it does not yield")

    @cached_property
    def hardening(self) -> HardeningCurve | HardeningField:
        """Flow stress over plastic strain, of all points or of each."""
        assert self.material.hardening is not None  # checked when made
        curves = self.material.hardening_over_temperature
        if curves is None or self.temperature is None:
            return self.material.hardening
        return curves.at_points(self.temperature)

    @property
    def virgin(self) -> BodyState:
        """The body before its first load."""
        shape = self.weight.shape
        return BodyState(
            np.zeros(elasticity.node_dofs(self.mesh).size), np.zeros((*shape, 4)), PlasticState.virgin(*shape)
        )

    @cached_property
    def weight(self) -> FloatArray:
        """Volume that each quadrature point stands for, 2 pi r dr dz [m^3]; shape (elements, points)."""
        return elasticity.ring_volume(self.mesh)

    @cached_property
    def strain_shapes(self) -> FloatArray:
        """Strains (rr, zz, tt, g_rz) of each shape function [1/m]; shape (elements, points, 4, shapes)."""
        return elasticity.strain_matrix(self.mesh)

    def strain(self, displacement: FloatArray) -> FloatArray:
        """Strain at the quadrature points; shape (elements, points, 4)."""
        shapes, local = self.strain_shapes, displacement[self._dofs]
        elements, points, components, size = shapes.shape
        strain = shapes.reshape(elements, points * components, size) @ local[..., None]
        return strain.reshape(elements, points, components)

    def respond(
        self, displacement: FloatArray, start: BodyState, free_strain: FloatArray | float = 0.0
    ) -> StressUpdate:
        """Stress, tangent and state after a step from `start` to a displacement.

        Parameters
        ----------
        displacement : ndarray, shape (dofs,)
            [m]
        start : BodyState
        free_strain : ndarray, shape (elements, points), or float
            Strain in all directions that takes no stress at the end of the step, by heat [-].
        """
        strain = self.strain(displacement)
        strain[..., :3] -= np.broadcast_to(free_strain, strain.shape[:2])[..., None]
        return radial_return(strain, start.plastic, self.material, self.hardening)

    def restraint_stress(self, free_strain: FloatArray | float) -> FloatArray:
        """Stress that would keep the elastic body from a free strain, as a size [Pa]; shape (elements, points, 4)."""
        lam, mu = elasticity.lame_parameters(self.material)
        strain = np.broadcast_to(np.abs(free_strain), self.weight.shape)
        return (3 * lam + 2 * mu) * strain[..., None] * np.array([1.0, 1.0, 1.0, 0.0])

    def internal_forces(self, stress: FloatArray) -> FloatArray:
        """int sigma : epsilon(v) 2 pi r dr dz of every test function [N]; shape (dofs,)."""
        shapes = self.strain_shapes
        volume_stress = (self.weight[..., None] * stress).reshape(len(shapes), 1, -1)
        local = (volume_stress @ shapes.reshape(len(shapes), -1, shapes.shape[-1]))[:, 0]
        return np.asarray(np.bincount(self._dofs.ravel(), local.ravel()), dtype=np.float64)

    def element_stiffness(self, elements: IntArray, tangent: FloatArray) -> FloatArray:
        """Stiffness of some elements [N/m], shape (k, shapes, shapes), with their tangent, (k, points, 4, 4) [Pa]."""
        shapes = self.strain_shapes[elements]
        return elasticity.contract(shapes, (self.weight[elements][..., None, None] * tangent) @ shapes)

    @property
    def nodal_average(self) -> csr_matrix:
        """From values at the quadrature points to the quadratic nodes, shape (nodes, elements * points).

        In each triangle the linear function closest to the values is taken to its nodes; triangles that share a node
        are averaged, weighted by their area.
        """
        points, triangles = elasticity.quadratic_nodes(self.mesh)
        x, weights = elasticity.quadrature()
        linear = np.column_stack([np.ones(len(weights)), *x])
        fit = np.linalg.solve(linear.T @ (weights[:, None] * linear), linear.T * weights)
        extrapolate = np.column_stack([np.ones(6), *elasticity.NODES]) @ fit  # (node, point)
        elements, count = self.weight.shape
        columns = np.arange(elements * count).reshape(elements, 1, count)
        shape = (elements, 6, count)
        entries = (elasticity.node_shares(self.mesh)[..., None] * extrapolate).ravel()
        index = (
            np.broadcast_to(triangles[..., None], shape).ravel(),
            np.broadcast_to(columns, shape).ravel(),
        )
        return csr_matrix((entries, index), shape=(len(points), elements * count))

    @cached_property
    def _dofs(self) -> IntArray:
        return elasticity.element_dofs(self.mesh)
