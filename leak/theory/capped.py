"""Asperities that yield only where they touch: the elastic contact that lets as much through.

Where the pressure reaches the hardness the surface is pressed flat, and stays as it is elsewhere. Such a contact is
tighter than an elastic one because more of it touches; its channels are those of the elastic contact at a larger
pressure.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.theory.plasticity import area_fractions

# Power of the ratio of contact areas by which the pressure counts, and of the share of the load that is left.
_AREA_POWER = 0.7
_MEMORY_POWER = 0.2


def equivalent_pressure(
    pressure: ArrayLike,
    *,
    hardness: float,
    effective_modulus: float,
    rms_slope: float,
    largest: ArrayLike | None = None,
) -> FloatArray:
    """Nominal pressure at which the elastic surface lets as much through as the one that yields where it touches.

    Parameters
    ----------
    pressure : array_like
        Nominal pressure, not negative [Pa].
    hardness : float
        Penetration hardness [Pa].
    effective_modulus : float
        E* [Pa].
    rms_slope : float
        h' of the whole roughness [-].
    largest : array_like, optional
        Largest nominal pressure that the place has carried, at least `pressure` [Pa]; `pressure` itself by default.

    Returns
    -------
    ndarray
        Of the broadcast shape; infinite from the hardness on [Pa].

    Examples
    --------
    >>> p = equivalent_pressure([1e6, 1e7], hardness=3e9, effective_modulus=1e11, rms_slope=0.4)
    >>> bool((p > [1e6, 1e7]).all())
    True
    """
    p = np.asarray(pressure, dtype=float)
    first = _first_loading(p, hardness, effective_modulus, rms_slope)
    if largest is None:
        return first
    most = np.maximum(np.asarray(largest, dtype=float), p)
    with np.errstate(invalid="ignore", divide="ignore"):
        kept = np.where(most > 0.0, (p / most) ** _MEMORY_POWER, 1.0)
        after = _first_loading(most, hardness, effective_modulus, rms_slope) * kept
    return np.asarray(np.where(p < most, np.maximum(after, first), first))


def _first_loading(p: FloatArray, hardness: float, effective_modulus: float, rms_slope: float) -> FloatArray:
    from scipy.special import erf

    s = p / hardness
    # G = (pi/4) E*^2 int q^3 C dq = (E* h')^2/8
    t = 0.125 * (effective_modulus * rms_slope / hardness) ** 2
    inside = np.where(s < 1.0, s, 0.5)
    yielding = area_fractions(inside, t)
    elastic = np.maximum(erf(0.5 * inside / np.sqrt(t)), 1e-300)
    ratio = np.where(inside > 0.0, (yielding.elastic + yielding.plastic) / elastic, 1.0)
    return np.where(s < 1.0, p * np.maximum(ratio, 1.0) ** _AREA_POWER, np.inf)
