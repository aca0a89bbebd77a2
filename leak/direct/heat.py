"""Heat across a pressed patch: through its spots and the fluid in its gap, by potential theory.

Notation: q flux, S q temperature of both half-spaces at the interface, 2 q/(k |wave vector|) of a wave, r local
resistance, zero in a spot. r q + S q is the same step everywhere; conjugate gradients on all places that conduct.
"""

from __future__ import annotations

import numpy as np

from leak.arrays import FloatArray
from leak.direct.contact import PeriodicHalfSpace
from leak.errors import DirectError, positive

# Of the step, as a share of it.
_TOLERANCE, _MOST_STEPS = 1e-6, 3000
# Resistance of one cell of the grid to the flux of all others, over its side, for preconditioning.
_OF_CELL = 0.6


def patch_conductance(
    gap: FloatArray, size: float, conductivity: float, *, fluid_conductivity: float = 0.0, jump: float = 0.0
) -> float:
    """Mean heat flux across a periodic patch over the step in temperature of the bodies, h [W/(m^2 K)].

    Parameters
    ----------
    gap : ndarray, shape (n, n)
        Zero where the bodies touch [m].
    size : float
        Side of the patch [m].
    conductivity : float
        k, harmonic mean of both bodies, 2 k1 k2/(k1 + k2) [W/(m K)].
    fluid_conductivity : float
        Of what fills the gap; none in vacuum [W/(m K)].
    jump : float
        Temperature jump of a gas at both walls, as a length of gas [m].

    Raises
    ------
    DirectError
        A value outside its meaning, nothing that conducts, or no convergence.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import patch_conductance
    >>> print(f"{patch_conductance(np.full((8, 8), 1e-6), 1e-4, 15.0, fluid_conductivity=0.025):.0f} W/(m2 K)")
    25000 W/(m2 K)
    """
    k = positive(DirectError, "conductivity", conductivity, "W/(m K)")
    touches = np.asarray(gap) <= 0.0
    conducts = touches if fluid_conductivity == 0.0 else np.ones(touches.shape, dtype=bool)
    if not conducts.any():
        raise DirectError("gap: nothing touches, and no fluid conducts")
    r = (
        np.zeros(touches.shape)
        if not fluid_conductivity
        else np.where(touches, 0.0, gap + jump) / fluid_conductivity
    )
    # temperature follows flux as displacement follows pressure
    body = PeriodicHalfSpace((touches.shape[0], touches.shape[1]), size, k)
    weight = conducts / (r + _OF_CELL * body.spacing / k)

    flux = weight
    error = conducts - np.where(conducts, r * flux + body.displacement(flux), 0.0)
    z = direction = weight * error
    product = np.vdot(error, z)
    for _ in range(_MOST_STEPS):
        if np.abs(error).max() < _TOLERANCE:
            return float(flux.mean())
        image = np.where(conducts, r * direction + body.displacement(direction), 0.0)
        length = product / np.vdot(direction, image)
        flux, error = flux + length * direction, error - length * image
        z = weight * error
        last, product = product, np.vdot(error, z)
        direction = z + product / last * direction
    raise DirectError(f"patch_conductance: no convergence, {np.abs(error).max():g} of the step is left")
