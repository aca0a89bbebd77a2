"""Asperities that yield only where they touch: the equivalent elastic contact.

Where the pressure reaches the hardness the surface is pressed flat, and it stays as it is elsewhere. Its gaps are
those of the elastic surface at a larger pressure, which serves mean gap and flow alike. Metal that flows by von Mises'
criterion has gaps of the same kind, with other constants: it begins to yield at lower pressures, below the surface,
and carries more than the hardness where its neighbours hinder the flow. Between two limits:

- hard: nothing yields, the equivalent pressure is the pressure itself;
- soft: the area a = p/hardness is cut off the heights and the rest stands as it was. A Gaussian surface of which a
  quarter is cut off has the mean gap `BEARING_GAP` of its rms height; the elastic surface has it at its bearing
  pressure, which the theory gives. From a = `YIELDING_THRESHOLD` on no path is left, and the elastic surface is sealed.

The constants are fitted to direct simulation (theory/yielding in the manual).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray

# Mean of (d - h)+ over a standard normal h, with the height d that a quarter of it exceeds.
_CUT_OFF = 0.25
BEARING_GAP = 0.8236439
"""Mean gap over rms height of a Gaussian surface flattened over a quarter of its area."""
YIELDING_THRESHOLD = 0.52
"""Contact area at which the open area stops percolating where all of it yields."""
_ELASTIC_THRESHOLD = 0.43

# what is still missing to the sealing pressure at the threshold comes in with this power of a/(1 - a)
_CLOSING = 6
_ALMOST_ALL = 1.0 - 1e-12


class YieldingConstants(NamedTuple):
    """What direct simulation says of a surface that yields where it touches; all without unit.

    Examples
    --------
    >>> CAPPED.total > VON_MISES.total
    True
    """

    total: float = 1.38
    """n, the power in which hard and soft limit add up."""
    bearing: float = 0.95
    """Bearing pressure over the theory's."""
    growth: float = 0.75
    """By how much c grows with a/(1 - a)."""
    spring: float = 1.8
    """How fast the spring-back of unloading is lost with the excess of p_eq over p."""
    bend: float = 0.22
    """r, the power of p/p_max in the spring-back."""
    few: float = 0.02
    """Excess from which on yielding bends the spring-back."""


CAPPED = YieldingConstants()
"""The pressure never exceeds the hardness; fitted and judged by `docs/direct_yielding.py`."""
VON_MISES = YieldingConstants(total=0.90, bearing=0.73, growth=0.87, spring=1.75, bend=0.17)
"""Metal that flows by von Mises' criterion without hardening, Poisson's ratio 0.3, hardness 2.9 times its yield stress;
fitted and judged by `docs/direct_yielding.py`."""


def equivalent_pressure(
    pressure: ArrayLike,
    *,
    hardness: float,
    effective_modulus: float,
    rms_slope: float,
    bearing_pressure: float,
    sealing_pressure: float,
    largest: ArrayLike | None = None,
    constants: YieldingConstants = CAPPED,
) -> FloatArray:
    """Nominal pressure at which the elastic surface lets as much through as the one that yields where it touches.

    First loading: p_eq^n = p^n + P_b^n, P_b = s a c(a), a = p/hardness. Of an elastic contact's area the share
    s = exp(-2 H^2), H = hardness/(E* h'), would bear more than the hardness; c(a) rises from the slope that the
    bearing pressure at a = 1/4 fixes to the sealing pressure at the yielding threshold. Unloading from p_max to
    x p_max: p_eq = p_eq(p_max) exp(-k (1 - x^r)/r), which goes from x (elastic, r = 0 and k = 1) to one (rigid
    and plastic, k = 0). It rises with pressure and with `largest`, and is never below that of first loading.

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
    bearing_pressure : float
        Pressure at which the elastic surface has a mean gap of `BEARING_GAP` times its rms height [Pa].
    sealing_pressure : float
        Pressure from which the elastic surface is sealed [Pa].
    largest : array_like, optional
        Largest nominal pressure that the place has carried [Pa]; where it is below `pressure`, and by default, the
        pressure itself.
    constants : YieldingConstants
        `CAPPED` or `VON_MISES`.

    Returns
    -------
    ndarray
        Of the broadcast shape; infinite from the hardness on, for the pressure and for the largest one [Pa].

    References
    ----------
    B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001), for the stress distribution behind s; the rest is fitted, see
    theory/yielding in the manual.

    Examples
    --------
    >>> surface = dict(hardness=3e9, effective_modulus=1e11, rms_slope=0.4, bearing_pressure=2e9, sealing_pressure=1e10)
    >>> loaded = equivalent_pressure([1e6, 1e7], **surface)
    >>> bool((loaded > [1e6, 1e7]).all())
    True
    >>> bool(equivalent_pressure(1e6, largest=1e7, **surface) > loaded[0])
    True
    """
    p = np.asarray(pressure, dtype=float)
    n = constants.total
    share = np.exp(-2.0 * (hardness / (effective_modulus * rms_slope)) ** 2)

    def first_loading(p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Equivalent pressure, and by which factor it is above p."""
        a = np.minimum(p / hardness, _ALMOST_ALL)
        bearing = share / hardness * _bearing(a / (1.0 - a), bearing_pressure, sealing_pressure, constants)
        factor = np.where(p < hardness, (1.0 + bearing**n) ** (1.0 / n), np.inf)
        return p * factor, factor

    if largest is None:
        return np.asarray(first_loading(p)[0])
    most = np.maximum(np.asarray(largest, dtype=float), p)
    after, factor = first_loading(most)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_x = np.where(p < most, np.log(p / most), 0.0)
        return np.asarray(np.where(most > 0.0, after * np.exp(-_spring_back(log_x, factor, constants)), 0.0))


def _bearing(
    odds: FloatArray, bearing_pressure: float, sealing_pressure: float, constants: YieldingConstants
) -> FloatArray:
    """c: elastic pressure with the gap of the cut surface, over the area cut off; over odds = a/(1 - a) [Pa]."""
    growth = constants.growth
    start = constants.bearing * bearing_pressure / (_CUT_OFF * (1.0 + growth * _CUT_OFF / (1.0 - _CUT_OFF)))
    end = YIELDING_THRESHOLD / (1.0 - YIELDING_THRESHOLD)
    missing = max(sealing_pressure / YIELDING_THRESHOLD - start * (1.0 + growth * end), 0.0)
    return start * (1.0 + growth * odds) + missing * (odds / end) ** _CLOSING


def _spring_back(log_x: FloatArray, factor: FloatArray, constants: YieldingConstants) -> FloatArray:
    """-ln(p_eq/p_eq(p_max)) at ln(p/p_max); `factor` is p_eq(p_max)/p_max."""
    excess = np.minimum(factor - 1.0, 1e12)
    start = 1.0 / (1.0 + constants.spring * excess)
    power = constants.bend * excess / (excess + constants.few)
    straight = power < 1e-9
    r = np.where(straight, 1.0, power)
    return np.asarray(start * np.where(straight, -log_x, -np.expm1(r * log_x) / r))


def percolation_threshold(yielded_share: ArrayLike) -> FloatArray:
    """Relative contact area at which a rough contact seals, over the share of its contact area that has yielded.

    From direct simulation: 0.430 where all contact is elastic, 0.455 where 59 % of it has yielded, 0.503 at 91 %, 0.514
    at 97 % and 0.520 at 99 %, each to 0.004. The gap closes beside an elastic contact patch like x^(3/2), beside a
    flattened summit as steeply as the summit was. The areas of Persson's theory are smaller than these.

    Parameters
    ----------
    yielded_share : array_like
        Yielded over total contact area, 0 to 1 [-].

    Returns
    -------
    ndarray
        A/A0 [-].

    Examples
    --------
    >>> float(percolation_threshold(0.0)), float(percolation_threshold(1.0))
    (0.43, 0.52)
    """
    share = np.asarray(yielded_share, dtype=float)
    return np.asarray(_ELASTIC_THRESHOLD + (YIELDING_THRESHOLD - _ELASTIC_THRESHOLD) * share**2.5)
