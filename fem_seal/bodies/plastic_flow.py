"""J2 plasticity with isotropic hardening: radial return and its consistent tangent at many points at once.

Strain and stress have the four components of the axisymmetric state, (rr, zz, tt, rz), along the last axis; the
shear strain is the engineering one, g_rz = 2 e_rz. Strains are small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_seal.arrays import FloatArray
from fem_seal.bodies.elasticity import elasticity_matrix, lame_parameters
from fem_seal.materials import HardeningCurve, HardeningField, Material

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
    accumulated : ndarray, shape (...)
        int sqrt(2/3 de_p : de_p) [-], never falling.
    """

    strain: FloatArray
    accumulated: FloatArray

    @classmethod
    def virgin(cls, *shape: int) -> PlasticState:
        """No plastic strain yet, at points of an array of this shape."""
        return cls(np.zeros((*shape, 4)), np.zeros(shape))


@dataclass(frozen=True)
class Flow:
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
    yielding: NDArray[np.bool_]


def radial_return(
    strain: FloatArray, before: PlasticState, material: Material, hardening: HardeningCurve | HardeningField
) -> Flow:
    """Stress after a step from `before` to a given strain, by one implicit Euler step (radial return).

    Parameters
    ----------
    strain : ndarray, shape (..., 4)
        Whole strain at the end of the step.
    before : PlasticState
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
    lam, mu = lame_parameters(material)
    bulk = lam + 2 * mu / 3
    trial = (strain - before.strain) @ elasticity_matrix(material)
    mean = trial @ _UNIT / 3
    deviator = trial - mean[..., None] * _UNIT
    q = np.sqrt(1.5 * (deviator**2 @ _DOUBLE))
    yielding = q > (1 + _ROUND_OFF) * hardening.flow_stress(before.accumulated)
    p = np.where(
        yielding, hardening.plastic_strain_at(q + 3 * mu * before.accumulated, 3 * mu), before.accumulated
    )
    # most points of a body stay elastic: the rest is for those that flow
    flowing = np.asarray(yielding)
    increment, size = np.asarray(p - before.accumulated)[flowing], np.asarray(q)[flowing]
    deviator = deviator[flowing]
    normal = deviator / (np.sqrt(2 / 3) * size)[:, None]  # unit tensor along the flow
    shrink = 3 * mu * increment / size
    stress, plastic = trial, before.strain.copy()
    stress[flowing] -= shrink[:, None] * deviator
    plastic[flowing] += np.sqrt(1.5) * increment[:, None] * normal / _TENSOR

    deviatoric = np.diag(_TENSOR) - np.outer(_UNIT, _UNIT) / 3
    along = 2 * mu * (3 * mu / (3 * mu + np.asarray(hardening.slope(p))[flowing]) - shrink)
    tangent = np.broadcast_to(elasticity_matrix(material), (*flowing.shape, 4, 4)).copy()
    tangent[flowing] = (
        bulk * np.outer(_UNIT, _UNIT)
        + (2 * mu * (1 - shrink))[:, None, None] * deviatoric
        - along[:, None, None] * normal[:, :, None] * normal[:, None, :]
    )
    return Flow(stress, tangent, PlasticState(plastic, p), yielding)
