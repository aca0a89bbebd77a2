"""Asperities that flow by von Mises: the elastic contact that lets as much through.

A pressure capped at the hardness (`leak.theory.capped`) is what indentation makes of a contact that yields all over. A
von Mises half-space begins to yield at lower pressures, below the surface, and carries more than the hardness where the
flow is hindered by its neighbours. Both together are a factor on the capped reading's equivalent pressure, over how far
that one is above the pressure itself.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.theory import capped


class VonMisesConstants(NamedTuple):
    """What direct simulation says of metal that flows, beside the capped reading; all without unit.

    Examples
    --------
    >>> VonMisesConstants().early > 0.0
    True
    """

    early: float = 0.17
    """By which share yielding below the surface raises the equivalent pressure."""
    onset: float = 0.02
    """Excess of the capped equivalent pressure over the pressure at which half of that is reached."""
    hindered: float = 0.18
    """Power of the capped factor by which hindered flow lowers it."""


FITTED = VonMisesConstants()
"""From 66 direct simulations of an independent program, H/(E* h') from 0.025 to 0.8 and nu = 0.3, in sample: the
conductivities of those maps are met to 0.12 (rms of ln) where the capped equivalent pressure is simulated, too."""


def equivalent_pressure(
    pressure: ArrayLike,
    *,
    hardness: float,
    effective_modulus: float,
    rms_slope: float,
    bearing_pressure: float,
    sealing_pressure: float,
    largest: ArrayLike | None = None,
    constants: VonMisesConstants = FITTED,
) -> FloatArray:
    """Nominal pressure at which the elastic surface lets as much through as the one that flows by von Mises.

    With e = p_eq/p - 1 of the capped reading, p_eq (1 + c e/(e + e0)) (p_eq/p)^-r on first loading. Unloading keeps
    the capped reading's spring-back, since both come back alike.

    Parameters
    ----------
    pressure, hardness, effective_modulus, rms_slope, bearing_pressure, sealing_pressure, largest
        See `leak.theory.capped.equivalent_pressure`; hardness = 2.9 times the yield stress [Pa].
    constants : VonMisesConstants
        Of the fit.

    Returns
    -------
    ndarray
        Of the broadcast shape; infinite from the hardness on, for the pressure and for the largest one [Pa].

    Examples
    --------
    >>> surface = dict(hardness=3e9, effective_modulus=1e11, rms_slope=0.4, bearing_pressure=2e9, sealing_pressure=1e10)
    >>> loaded = equivalent_pressure([1e6, 1e7], **surface)
    >>> bool((loaded > [1e6, 1e7]).all())
    True
    """
    p = np.asarray(pressure, dtype=float)
    most = p if largest is None else np.maximum(np.asarray(largest, dtype=float), p)
    capped_pressure = partial(
        capped.equivalent_pressure,
        hardness=hardness,
        effective_modulus=effective_modulus,
        rms_slope=rms_slope,
        bearing_pressure=bearing_pressure,
        sealing_pressure=sealing_pressure,
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(most > 0.0, capped_pressure(most) / most, 1.0)
        excess = factor - 1.0
        more = (1.0 + constants.early * excess / (excess + constants.onset)) * factor**-constants.hindered
    return np.asarray(np.where(np.isfinite(factor), more, 1.0) * capped_pressure(p, largest=largest))
