"""Asperity plasticity: the stress distribution between zero and the hardness, and the smoothed spectrum C_pl.

dP/dG = d^2P/dsigma^2, absorbing at sigma = 0 and at the hardness sigma_P, P(sigma, 0) = delta(sigma - p).
Everything depends on s = p/sigma_P and t = G/sigma_P^2.

Two readings of such asperities. Where the metal conserves its volume the spectrum is smoothed, as above. Or the surface
is pressed flat where the pressure reaches the hardness, and stays as it is elsewhere. Its gaps are then those of the
elastic surface at a larger, equivalent pressure, which serves mean gap and flow alike. Metal that flows by von Mises'
criterion has gaps of the same kind, with other constants: it begins to yield at lower pressures, below the surface,
and carries more than the hardness where its neighbours hinder the flow. Between two limits:

- hard: nothing yields, the equivalent pressure is the pressure itself;
- soft: the area a = p/hardness is cut off the heights and the rest stands as it was. A Gaussian surface of which a
  quarter is cut off has the mean gap `BEARING_GAP` of its rms height; the elastic surface has it at its bearing
  pressure, which the theory gives. From a = `YIELDING_THRESHOLD` on no path is left, and the elastic surface is sealed.

The constants are fitted to direct simulation (theory/yielding in the manual).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray, IntArray
from leak.numerics.curves import cell_cubics
from leak.numerics.integrals import gauss


class Reading(StrEnum):
    """What becomes of asperities that reach the hardness.

    Examples
    --------
    >>> [str(reading) for reading in READINGS["paper"]]
    ['conserved', 'capped']
    """

    CONSERVED = "conserved"
    """The spectrum C_pl: smoothed everywhere by plastic flow, valleys included (`leak.theory.plasticity`)."""
    CAPPED = "capped"
    """The hardness limits the pressure, and the surface changes only where it touches (`leak.theory.plasticity`)."""
    VON_MISES = "von-mises"
    """Metal that flows by von Mises below the surface (`leak.theory.plasticity`)."""
    ELASTIC = "elastic"
    """Nothing yields."""


READINGS: dict[str, tuple[Reading, ...]] = {
    "paper": (Reading.CONSERVED, Reading.CAPPED),
    "corrected": (Reading.VON_MISES,),
}
"""Those of each theory, its default first."""


# Both series converge here: images need exp(-1/t), eigenfunctions exp(-pi^2 t); at 0.3 the fourth of these is 1e-19 of
# the first.
_CROSSING = 0.3
_IMAGES = 7
_MODES = 4
# An image so many times sqrt(t) away adds less than 1e-17.
_OUT_OF_SIGHT = 12.6
# C_pl/C is below 1e-17 from T_END on, and differs from one by less than 1e-17 up to T_START (1-s)^2.
T_END = 4.5
T_START = 1.0 / 36.0
_T_LAST = 2.6
_TABLE_NODES = 384
# Gauss points in ln t for the whole of C_pl.
_TOTAL_NODES = 64


class AreaFractions(NamedTuple):
    """How the nominal area splits at one magnification; the three add up to one.

    Examples
    --------
    >>> import leak
    >>> found = leak.area_fractions(0.01, 0.0)
    >>> found._fields
    ('elastic', 'plastic', 'open')
    """

    elastic: FloatArray
    """A_el/A0."""
    plastic: FloatArray
    """A_pl/A0."""
    open: FloatArray
    """A_non/A0, contact lost."""


def area_fractions(stress_ratio: ArrayLike, stress_variance: ArrayLike) -> AreaFractions:
    """Elastic, plastic and lost contact area of an elastoplastic rough contact.

    Image sum for small t, eigenfunction sum for large t; each fraction keeps its relative accuracy where it is tiny.

    Parameters
    ----------
    stress_ratio : array_like
        s = p/sigma_P, nominal pressure over hardness; from 1 on all is plastic [-].
    stress_variance : array_like
        t = G/sigma_P^2, broadcast against s [-].

    Returns
    -------
    AreaFractions
        A_el, A_pl and A_non over A0, each of the broadcast shape.

    References
    ----------
    B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001), section on plastic deformation.

    Examples
    --------
    >>> parts = area_fractions(0.5, 0.05)
    >>> bool(abs(sum(parts) - 1.0) < 1e-15)
    True
    """
    s, t = np.broadcast_arrays(
        np.asarray(stress_ratio, dtype=float), np.asarray(stress_variance, dtype=float)
    )
    is_in = s < 1.0
    s_in = np.where(is_in, s, 0.5)
    open_area = np.where(is_in, _lost_area(1.0 - s_in, s_in, t), 0.0)
    plastic = np.where(is_in, _lost_area(s_in, 1.0 - s_in, t), 1.0)
    elastic = np.where(is_in, _elastic_area(s_in, t), 0.0)
    return AreaFractions(elastic, plastic, open_area)


def remaining_fraction(stress_ratio: ArrayLike, stress_variance: ArrayLike) -> FloatArray:
    """C_pl/C = 1 - (A_pl/A_pl0)^6 with A_pl0/A0 = p/sigma_P, accurate where either side is tiny.

    The limit of vanishing pressure, s = 0, is included.

    Parameters
    ----------
    stress_ratio : array_like
        s = p/sigma_P, nominal pressure over hardness [-].
    stress_variance : array_like
        t = G/sigma_P^2, broadcast against s [-].

    Returns
    -------
    ndarray
        Between 0 and 1, of the broadcast shape [-].

    References
    ----------
    Fischer et al., "Fluid leakage in metallic seals", eq. (16); B. N. J. Persson, Tribol. Lett. 63, 42 (2016).

    Examples
    --------
    >>> import leak
    >>> float(leak.remaining_fraction(0.01, 0.0))
    1.0
    """
    s, t = np.broadcast_arrays(
        np.asarray(stress_ratio, dtype=float), np.asarray(stress_variance, dtype=float)
    )
    s_in = np.clip(s, 1e-9, 1.0)  # the limit s -> 0 is reached to 1e-17 here
    not_yielded = np.empty(t.shape)
    early = t < _CROSSING
    not_yielded[early] = 1.0 - _absorbed_by_images(s_in[early], 1.0 - s_in[early], t[early]) / s_in[early]
    late = ~early
    not_yielded[late] = -_mode_sum(s_in[late], t[late], -1.0) / s_in[late]
    d = np.where(s < 1.0, np.clip(not_yielded, 0.0, 1.0), 0.0)
    # 1 - (1-d)^6, expanded so that a small d loses nothing.
    return d * (6.0 - d * (15.0 - d * (20.0 - d * (15.0 - d * (6.0 - d)))))


def _lost_area(s: FloatArray, distance: FloatArray, t: FloatArray) -> FloatArray:
    """Probability absorbed at the boundary at `distance` = 1 - s: A_pl(s); A_non is A_pl(1 - s)."""
    area = np.empty(t.shape)
    early = t < _CROSSING
    if not early.any():
        return np.asarray(s + _mode_sum(s, t, -1.0))
    area[early] = _absorbed_by_images(s[early], distance[early], t[early])
    late = ~early
    area[late] = s[late] + _mode_sum(s[late], t[late], -1.0)
    return area


def _elastic_area(s: FloatArray, t: FloatArray) -> FloatArray:
    """Area neither lost nor yielded."""
    from scipy.special import erf

    area = np.empty(t.shape)
    early = t < _CROSSING
    if not early.any():
        return np.asarray(_mode_sum(s, t, 1.0) - _mode_sum(s, t, -1.0))
    scale = _image_scale(t[early])
    total = erf(s[early] * scale)
    for m in range(1, _IMAGES + 1):
        edge = (m - s[early]) * scale
        total += (-1.0) ** m * _erf_difference(m * scale, s[early] * scale, edge)
    area[early] = total
    late = ~early
    area[late] = _mode_sum(s[late], t[late], 1.0) - _mode_sum(s[late], t[late], -1.0)
    return area


def _absorbed_by_images(s: FloatArray, distance: FloatArray, t: FloatArray) -> FloatArray:
    """sum_k erfc((2k+1-s)/(2 sqrt t)) - erfc((2k+1+s)/(2 sqrt t))."""
    total = np.zeros(t.shape)
    for m in range(1, _IMAGES + 1, 2):
        adds = t >= ((m - 1) / _OUT_OF_SIGHT) ** 2
        scale = _image_scale(t[adds])
        total[adds] += _erf_difference(m * scale, s[adds] * scale, (m - 1 + distance[adds]) * scale)
    return total


def _image_scale(t: FloatArray) -> FloatArray:
    """1/(2 sqrt t), kept finite where no roughness is seen yet."""
    return 0.5 / np.sqrt(np.maximum(t, 1e-200))


def _erf_difference(middle: FloatArray, half: FloatArray, edge: FloatArray) -> FloatArray:
    """erf(middle + half) - erf(near), near = middle - half; by its Taylor series where the two would cancel."""
    from scipy.special import erfc

    values = np.empty(middle.shape)
    is_small = half * (1.0 + middle) < 1e-3
    m2, h2 = np.minimum(middle[is_small], 26.0) ** 2, half[is_small] ** 2
    series = 1.0 + h2 * ((2.0 * m2 - 1.0) / 3.0 + h2 * (4.0 * m2**2 - 12.0 * m2 + 3.0) / 30.0)
    values[is_small] = 4.0 / np.sqrt(np.pi) * np.exp(-m2) * half[is_small] * series
    is_large = ~is_small
    values[is_large] = erfc(edge[is_large]) - erfc(middle[is_large] + half[is_large])
    return values


def _mode_sum(s: FloatArray, t: FloatArray, sign: float) -> FloatArray:
    """sum_n (2/(n pi)) sign^n sin(n pi s) exp(-n^2 pi^2 t)."""
    total = np.zeros(t.shape)
    if t.size == 0:
        return total
    # sin(n pi s) near s = 1 is the sine of the small rest.
    low = s < 0.5
    angle = np.pi * np.where(low, s, 1.0 - s)
    for n in range(1, _MODES + 1):
        sine = np.sin(n * angle) if n % 2 else np.where(low, 1.0, -1.0) * np.sin(n * angle)
        total += sign**n * 2.0 / (n * np.pi) * sine * np.exp(-np.minimum((n * np.pi) ** 2 * t, 740.0))
    return total


# -------------------------------------------------------------------- the spectrum that remains


@dataclass(frozen=True)
class Roughness:
    """The slope moments of a surface at given pressures, as a function of the elastic moment M.

    Arrays start with the axis of the pressures. These are those of an elastic surface, the same at every pressure;
    asperity plasticity takes short waves away as the pressure rises, see `PlasticRoughness`.
    """

    end: float
    """Elastic moment above which nothing is left, at most that of the whole spectrum [-]."""
    kappa: float = field(default=0.0, kw_only=True)
    """t/M = (pi/4) (E*/sigma_P)^2: kappa M = G/sigma_P^2, zero if nothing yields [-]."""

    @property
    def last_loss(self) -> float:
        """Elastic moment above which the contact loses less than 1e-9 of its area, at most `end` [-]."""
        return self.end

    def moment(self, M: FloatArray) -> FloatArray:
        """Slope moment that remains up to the elastic moment M [-]."""
        return M

    def factor(self, M: FloatArray) -> FloatArray:
        """Fraction of C that remains at the elastic moment M [-]."""
        return np.ones_like(M)

    def moments_above(self, M: FloatArray) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
        """Function of a rise: remaining moment between M and M + rise, and the factor there; no cancellation."""
        return lambda rise: (rise, np.ones(rise.shape[-1:]))

    def at_some(self, pressures: IntArray) -> Roughness:
        """The same at some of the pressures, given by their numbers."""
        return self


@dataclass(frozen=True)
class PlasticRoughness(Roughness):
    """Slope moments of C_pl at given pressures.

    R(t) = int_t^inf C_pl/C dt' is tabulated over ln t for each pressure: counted from its far end, the moment that
    remains above a magnification keeps its relative accuracy where the spectrum has nearly vanished.
    """

    start_t: FloatArray
    """Up to this t nothing has yielded, shape (P,)."""
    step_log_t: FloatArray
    """Spacing of the table in ln t, shape (P,)."""
    remainder: FloatArray
    """R in the cells of the table: coefficients of the powers 0 to 3 of the place in each, shape (4, P (N - 1))."""

    @classmethod
    def at(
        cls, stress_ratio: FloatArray, effective_modulus: float, hardness: float, end: float
    ) -> PlasticRoughness:
        """Tabulate for s = p/sigma_P < 1, shape (P,), and the slope moment `end` of the whole spectrum."""
        kappa = 0.25 * np.pi * (effective_modulus / hardness) ** 2
        start = T_START * (1.0 - stress_ratio) ** 2
        step = np.log(T_END / start) / (_TABLE_NODES - 1)
        t = start[:, None] * np.exp(0.5 * step[:, None] * np.arange(2 * _TABLE_NODES - 1))
        integrand = t * remaining_fraction(stress_ratio[:, None], t)
        cells = step[:, None] / 6.0 * (integrand[:, :-2:2] + 4.0 * integrand[:, 1::2] + integrand[:, 2::2])
        remainders = np.zeros((stress_ratio.size, _TABLE_NODES))
        remainders[:, :-1] = np.cumsum(cells[:, ::-1], axis=1)[:, ::-1]
        # Beyond the table only the slowest mode is left: exp(-pi^2 t).
        remainders += (integrand[:, -1] / (T_END * np.pi**2))[:, None]
        # cubic Hermite in ln t: dR/dlnt = -t C_pl/C is known
        slope = -step[:, None] * integrand[:, ::2]
        cubics = cell_cubics(np.ones(1), remainders.T, slope.T).swapaxes(1, 2)
        return cls(min(end, T_END / kappa), start, step, cubics.reshape(4, -1), kappa=kappa)

    @property
    def last_loss(self) -> float:
        """Beyond this elastic moment C_pl/C is below 1e-10."""
        return min(self.end, _T_LAST / self.kappa)

    def moment(self, M: FloatArray) -> FloatArray:
        """Slope moment of C_pl up to the elastic moment M, shape (P, ...) [-]."""
        t = self.kappa * M
        start = _lead(self.start_t, M.ndim)
        R, _ = self._remainder(np.maximum(t, start))
        R_total = start + _lead(self.remainder[0].reshape(self.start_t.size, -1)[:, 0], M.ndim)
        return np.where(t <= start, M, (R_total - R) / self.kappa)

    def factor(self, M: FloatArray) -> FloatArray:
        """C_pl/C at the elastic moment M, shape (P, ...) [-]."""
        t = self.kappa * M
        _, factor = self._remainder(np.maximum(t, _lead(self.start_t, M.ndim)))
        return factor

    def moments_above(self, M: FloatArray) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
        """Function of a rise: moment of C_pl between M and M + rise, and C_pl/C at M + rise."""
        start = _lead(self.start_t, M.ndim)
        t0 = self.kappa * M
        rest0 = self._remainder(np.maximum(t0, start))[0] + np.maximum(start - t0, 0.0)

        def moment_and_factor(rise: FloatArray) -> tuple[FloatArray, FloatArray]:
            t1 = (M + rise) * self.kappa
            rest1, factor = self._remainder(np.maximum(t1, start))
            return np.where(t1 <= start, rise, (rest0 - rest1) * (1.0 / self.kappa)), factor

        return moment_and_factor

    def at_some(self, pressures: IntArray) -> PlasticRoughness:
        """The same at some of the pressures, given by their numbers."""
        if pressures.size == self.start_t.size:
            return self
        remainder = self.remainder.reshape(4, self.start_t.size, -1)[:, pressures].reshape(4, -1)
        return replace(
            self, start_t=self.start_t[pressures], step_log_t=self.step_log_t[pressures], remainder=remainder
        )

    def _remainder(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """R and C_pl/C at t, not below the start of the table."""
        cells = _TABLE_NODES - 1
        h = _lead(self.step_log_t, t.ndim)
        place = (np.log(t) - np.log(_lead(self.start_t, t.ndim))) * (1.0 / h)
        cell = np.minimum(place, cells - 1.0).astype(np.intp)
        x = np.minimum(place - cell, 1.0)
        cell += cells * np.arange(self.start_t.size).reshape(-1, *(1,) * (t.ndim - 1))
        c0, c1, c2, c3 = (coefficients.take(cell) for coefficients in self.remainder)
        cubic = c3 * x
        R = ((cubic + c2) * x + c1) * x + c0
        # -t C_pl/C = dR/dlnt
        slope = (3.0 * cubic + c2 + c2) * x + c1
        return R, np.maximum(slope / t * (-1.0 / h), 0.0)


def remaining_moment(stress_ratio: float, kappa: float, end: float) -> float:
    """Slope moment of all of C_pl at one s = p/sigma_P < 1: what `PlasticRoughness.moment` has at its end.

    Parameters
    ----------
    stress_ratio : float
        s [-].
    kappa, end : float
        See `PlasticRoughness` [-].

    Examples
    --------
    >>> roughness = PlasticRoughness.at(np.array([0.3]), 1e11, 3e9, end=0.01)
    >>> alone = remaining_moment(0.3, roughness.kappa, 0.01)
    >>> bool(abs(alone / roughness.moment(np.array([[roughness.end]]))[0, 0] - 1.0) < 1e-9)
    True
    """
    start, last = T_START * (1.0 - stress_ratio) ** 2, min(kappa * end, T_END)
    if last <= start:
        return last / kappa
    x, w = gauss(_TOTAL_NODES)
    half = 0.5 * np.log(last / start)
    t = start * np.exp(half * (1.0 + x))
    return float(start + half * (w @ (t * remaining_fraction(stress_ratio, t)))) / kappa


def _lead(values: FloatArray, ndim: int) -> FloatArray:
    """Shape (P,) made broadcastable against arrays whose first axis is the pressure."""
    return values.reshape(-1, *(1,) * (ndim - 1))


# -------------------------------------------------------------------- the equivalent elastic contact

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
    small_excess: float = 0.02
    """Excess from which on yielding bends the spring-back."""


CAPPED = YieldingConstants()
"""The pressure never exceeds the hardness; fitted and judged by `docs/research/direct_yielding.py`."""
VON_MISES = YieldingConstants(total=0.90, bearing=0.73, growth=0.87, spring=1.75, bend=0.17)
"""Metal that flows by von Mises' criterion without hardening, Poisson's ratio 0.3, hardness 2.9 times its yield stress;
fitted and judged by `docs/research/direct_yielding.py`."""


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
    p_eq, factor = first_loading(most)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_x = np.where(p < most, np.log(p / most), 0.0)
        return np.asarray(np.where(most > 0.0, p_eq * np.exp(-_spring_back(log_x, factor, constants)), 0.0))


def _bearing(
    odds: FloatArray, bearing_pressure: float, sealing_pressure: float, constants: YieldingConstants
) -> FloatArray:
    """c: elastic pressure with the gap of the cut surface, over the area cut off; over odds = a/(1 - a) [Pa]."""
    growth = constants.growth
    start = constants.bearing * bearing_pressure / (_CUT_OFF * (1.0 + growth * _CUT_OFF / (1.0 - _CUT_OFF)))
    end = YIELDING_THRESHOLD / (1.0 - YIELDING_THRESHOLD)
    rise = max(sealing_pressure / YIELDING_THRESHOLD - start * (1.0 + growth * end), 0.0)
    return start * (1.0 + growth * odds) + rise * (odds / end) ** _CLOSING


def _spring_back(log_x: FloatArray, factor: FloatArray, constants: YieldingConstants) -> FloatArray:
    """-ln(p_eq/p_eq(p_max)) at ln(p/p_max); `factor` is p_eq(p_max)/p_max."""
    excess = np.minimum(factor - 1.0, 1e12)
    start = 1.0 / (1.0 + constants.spring * excess)
    power = constants.bend * excess / (excess + constants.small_excess)
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
