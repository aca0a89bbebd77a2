"""Interface laws p(u) for a contact calculation: exponential, tabulated, and that of a rough surface.

Each law has `gap(log_pressure)`, `decay_length(log_pressure)` = -du/dlnp > 0 and `pressure(gap)`. The logarithm of
the pressure is the variable because in the tails of a contact p is too small for a floating-point number, while
the gap is not.

Mean gap of an elastic rough surface over the pressure: waves shared out between half-space and interface.
Notation: p nominal pressure, u mean gap, m variance of the heights of all waves above q, y = ln p, u0 = -du/dy. The
surface is built from its shortest waves to its longest. A band of waves of variance dm meets an interface of stiffness
-dp/du = p/u0 on a half-space of stiffness E* q/2, in series; what the half-space takes up of a wave is no longer a
wave of the gap. To second order in its height

    dp/dm = 1/2 d/du [ -1/(1/s + 2/(E* q)) ],   s = -dp/du,

where the bracket is the stiffness in series. With few contacts, s small, this is the diffusion of heights,
p ~ exp(-u^2/2m); at full contact it is Persson's diffusion of the pressure. As a function of ln p, free of tails:

    du/dm = 1/2 (1 + d/dy) 1/(u0 + 2 p/(E* q)).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import LARGEST_LOG, FloatArray
from leak.errors import LawError, SurfaceError, as_arrays, check_each, positive
from leak.numerics.curves import MonotoneCurve, divide_stretches, shape_preserving_slopes, spline_slopes
from leak.surfaces.spectrum import PowerSpectrum

# Places in ln p, relative to E* h', closest at the upper end; fewer and the gap errs by more than 1e-4 h_rms.
_LOWEST, _HIGHEST, _POINTS, _STRETCH = -45.0, 2.5, 320, 3.0
# The first band, as a share of the mean square slope; the hard wall before it is forgotten by 1e-3.
_FIRST_BAND = 1e-5
# Steps in ln q, between kinks, at which m is tabulated; closer toward the shortest waves, where it all begins.
_STEP, _CLOSEST_STEP = 0.02, 1e-7
# A stretch of a whole number of steps has so many, whatever its rounding.
_SLACK = 1e-6
# Longest steps of the integration in ln m and in ln q: the gap errs by 1e-5 h_rms.
_IN_M, _IN_Q = 0.1, 0.2
# A spectrum of more points has no kinks that a step should end at.
_FEW_POINTS = 10
# Far below u^2 is linear in ln p: places there, each this much further than the one before, to gaps of 140 h_rms.
_FURTHER, _FURTHEST = 1.15, 1e4
# Below this gap over h_rms a surface is flat for any purpose.
_CLOSED_GAP = 1e-7


@lru_cache(maxsize=64)
def gap_law(spectrum: PowerSpectrum) -> RoughSurfaceLaw:
    """Mean gap over ln(p/E*), good to 1e-4 of the rms height.

    Without a fitted constant: 128 direct simulations of 16 spectra err by 1 % of it, see theory/gap in the manual.

    Parameters
    ----------
    spectrum : PowerSpectrum
        Of the heights, isotropic or its average over the angles.

    Returns
    -------
    RoughSurfaceLaw
        Of a surface with E* = 1: its pressures are p/E*.

    Raises
    ------
    SurfaceError
        The integration fails.

    Examples
    --------
    >>> spectrum = PowerSpectrum.self_affine(
    ...     rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.1415926e6
    ... )
    >>> print(f"{1e6 * float(gap_law(spectrum).gap(np.log(50e6 / 115e9))):.2f} um")
    4.36 um
    """
    law, height = _of_shape(spectrum.shape), spectrum.rms_height / spectrum.shape.rms_height
    return RoughSurfaceLaw(
        law.log_pressure_nodes + np.log(height), height * law.gap_nodes, height * law.decay_nodes
    )


@lru_cache(maxsize=64)
def _of_shape(spectrum: PowerSpectrum) -> RoughSurfaceLaw:
    """Of one of all surfaces that differ in height alone: gaps and pressures go with it."""
    height, slope = spectrum.rms_height, spectrum.rms_slope
    log_q, log_m = _bands(spectrum)
    y = _places()
    half, step = 0.5 * (y[1:] + y[:-1]), np.diff(y)
    # midpoints, with one more below the lowest place
    middle = np.concatenate([[y[0] - 0.5 * step[0]], half])
    pressure = 2.0 * slope / height * np.exp(middle)
    lower = np.concatenate([[0.5], step[1:] / (step[1:] + step[:-1])])
    gap_to_next = np.diff(middle)

    first, second = 0.5 * (lower - 1.0 / gap_to_next), 0.5 * (1.0 - lower + 1.0 / gap_to_next)
    step_below = np.concatenate([step[:1], step])

    def series(at: float, v: FloatArray) -> tuple[FloatArray, float]:
        """Compliances in series, of v = u/m^(1/2), which is as large for the first band as for the last."""
        decay = -np.diff(v) / step
        share = step[0] * decay[0] / v[0]
        # u^2 is linear in ln p far below
        decay_below = decay[0] * (1.0 - share)
        band = np.exp(np.interp(at, log_m, log_q) + 0.5 * at)
        return 1.0 / (np.concatenate([[decay_below], decay]) + pressure / band), float(share)

    def rate(at: float, v: FloatArray) -> FloatArray:
        """dv/d(ln m)."""
        flow, _ = series(at, v)
        change = -0.5 * v
        change[:-1] += first * flow[:-1] + second * flow[1:]
        return change

    def jacobian(at: float, v: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        flow, share = series(at, v)
        of_own = flow**2 / step_below
        of_next = -of_own[1:]
        of_own[0] *= share * (2.0 - share) - 1.0
        diagonal = np.full(v.size, -0.5)
        diagonal[:-1] += first * of_own[:-1] + second * of_next
        upper = second * of_own[1:]
        upper[0] += first[0] * flow[0] ** 2 / step_below[0] * (1.0 - 2.0 * share)
        return np.append(first[1:] * of_next[:-1], 0.0), diagonal, upper

    # heights over h_rms and pressures over E* h' from here on; the first band closes at about this pressure
    closing = np.exp(log_q[0] + 0.5 * log_m[0] - y) * height / (2.0 * slope)
    u = stiff_steps(rate, jacobian, _places_in_m(spectrum, log_q, log_m), 0.5 * np.log1p(closing))
    if not np.isfinite(u).all():
        raise SurfaceError(f"gap law: no solution (spectrum with h_rms = {height:g} m, slope {slope:g})")
    is_open = u > _CLOSED_GAP
    y, u = y[is_open], u[is_open]
    decay = -spline_slopes(y, u)
    y_below = y[0] * _FURTHER ** np.arange(np.log(_FURTHEST / -y[0]) / np.log(_FURTHER), 0.0, -1.0)
    wide_u = np.sqrt(u[0] ** 2 + 2.0 * u[0] * decay[0] * (y[0] - y_below))
    y, u, decay = (
        np.concatenate(parts) for parts in ((y_below, y), (wide_u, u), (u[0] * decay[0] / wide_u, decay))
    )
    return RoughSurfaceLaw(y + np.log(slope), height * u, height * decay)


def _places() -> FloatArray:
    share = np.linspace(0.0, 1.0, _POINTS)[::-1]
    return np.asarray(_HIGHEST - (_HIGHEST - _LOWEST) * np.sinh(_STRETCH * share) / np.sinh(_STRETCH))


def _places_in_m(spectrum: PowerSpectrum, log_q: FloatArray, log_m: FloatArray) -> FloatArray:
    """ln m at which steps of the integration end: each changes ln m and ln q by little, and some end at kinks."""
    way = np.concatenate([[0.0], np.cumsum(np.diff(log_m) / _IN_M - np.diff(log_q) / _IN_Q)])
    kinks = np.log(spectrum.wavenumber) if spectrum.wavenumber.size <= _FEW_POINTS else np.empty(0)
    ends = np.unique(np.concatenate([way[[0, -1]], np.interp(-kinks, -log_q, way)]))
    return np.unique(np.interp(divide_stretches(ends, 1.0, _SLACK), way, log_m))


def _bands(spectrum: PowerSpectrum) -> tuple[FloatArray, FloatArray]:
    """ln q, falling, and ln(m/h_rms^2) of all waves above it, rising; from the first band on."""
    kinks = np.log(spectrum.wavenumber)
    grid = divide_stretches(kinks, _STEP, _SLACK)
    log_q = np.unique(np.concatenate([grid, kinks[-1] - np.geomspace(_CLOSEST_STEP, _STEP, 30)]))
    log_q = log_q[log_q >= kinks[0]]
    q = np.exp(log_q)
    m = spectrum.height_variance_above(q) / spectrum.rms_height**2
    steep = spectrum.slope_moment(q) / spectrum.whole_moment
    # the last place before less than `_FIRST` of the slope is above
    last = max(int(np.searchsorted(steep, 1.0 - _FIRST_BAND)) - 1, 0)
    log_q, m = log_q[last::-1], m[last::-1]
    is_rising = np.concatenate([[True], np.diff(m) > 0.0])
    return log_q[is_rising], np.log(m[is_rising])


# So many Euler steps go over each interval; their results are extrapolated to infinitely many, to third order.
_STEPS = (1, 2, 3)


def stiff_steps(
    rate: Callable[[float, FloatArray], FloatArray],
    jacobian: Callable[[float, FloatArray], tuple[FloatArray, FloatArray, FloatArray]],
    places: FloatArray,
    start: FloatArray,
) -> FloatArray:
    """Solution of dv/dt = rate(t, v) at the last of some places, by linearly implicit Euler steps extrapolated.

    The places alone decide the steps, so that equal equations in other units have equal solutions to rounding.

    Parameters
    ----------
    rate : callable
        Of t and v, shape (n,).
    jacobian : callable
        Of t and v: the diagonal below, shape (n - 1,), the diagonal, shape (n,), and the one above.
    places : ndarray, shape (m,)
        Rising t, the first of them that of `start`.
    start : ndarray, shape (n,)
        Of three values or more.

    References
    ----------
    P. Deuflhard, SIAM Rev. 27, 505 (1985).

    Examples
    --------
    >>> import numpy as np
    >>> apart = np.zeros(2)
    >>> falls = lambda t, v: (apart, np.full(3, -1.0), apart)
    >>> v = stiff_steps(lambda t, v: -v, falls, np.linspace(0.0, 1.0, 101), np.ones(3))
    >>> bool(np.allclose(v, np.exp(-1.0), rtol=1e-6))
    True
    """
    from scipy.linalg.lapack import dgttrf, dgttrs

    v = start
    for begin, end in pairwise(places):
        lower, diagonal, upper = jacobian(end, v)
        table: list[FloatArray] = []
        for number, count in enumerate(_STEPS):
            step = (end - begin) / count
            factors = dgttrf(-step * lower, 1.0 - step * diagonal, -step * upper)[:5]
            end_v = v
            for k in range(count):
                end_v = end_v + dgttrs(*factors, step * rate(begin + (k + 1) * step, end_v))[0]
            row = [end_v]
            for order, coarser in enumerate(table, start=1):
                row.append(row[-1] + (row[-1] - coarser) / (count / _STEPS[number - order] - 1.0))
            table = row
        v = table[-1]
    return v


@dataclass(frozen=True)
class ExponentialLaw:
    """p = p_c exp(-u/u0), the low-pressure law of randomly rough surfaces.

    Parameters
    ----------
    p_c : float
        Pressure at which the gap closes [Pa].
    u0 : float
        Decay length [m].

    References
    ----------
    B. N. J. Persson, Phys. Rev. Lett. 99, 125502 (2007); Fischer et al., "Fluid leakage in metallic seals", eq. (8).

    Examples
    --------
    >>> law = ExponentialLaw(p_c=5e9, u0=0.76e-6)
    >>> round(float(law.pressure(law.gap(np.log(1e6)))), 6)
    1000000.0
    """

    p_c: float
    u0: float

    def __post_init__(self) -> None:
        positive(LawError, "p_c", self.p_c, "Pa")
        positive(LawError, "u0", self.u0, "m")

    def gap(self, log_pressure: ArrayLike) -> FloatArray:
        """u at ln(p/Pa) [m]."""
        return self.u0 * (np.log(self.p_c) - np.asarray(log_pressure, dtype=float))

    def decay_length(self, log_pressure: ArrayLike) -> FloatArray:
        """-du/dlnp at ln(p/Pa) [m]."""
        return np.full(np.shape(log_pressure), float(self.u0))

    def pressure(self, gap: ArrayLike) -> FloatArray:
        """p at gap u [Pa]."""
        return _exp(np.log(self.p_c) - np.asarray(gap, dtype=float) / self.u0)


@dataclass(frozen=True, eq=False)
class TabulatedLaw:
    """Any falling p(u) given by points: ln p is a monotone cubic of u, continued exponentially at both ends.

    Parameters
    ----------
    table_gap : array_like
        Gaps of the points, strictly increasing, negative values allowed, shape (n,), n >= 2 [m].
    table_pressure : array_like
        Pressures there, positive and strictly decreasing, shape (n,) [Pa].

    Raises
    ------
    LawError
        The points are fewer than two, not finite, or not strictly monotone.

    Examples
    --------
    >>> import numpy as np, leak
    >>> u = np.linspace(0.0, 5e-6, 30)
    >>> law = leak.TabulatedLaw(u, 1e8 * np.exp(-u / 1e-6))
    >>> print(f"{float(law.decay_length(np.log(1e7))):.3g} m")
    1e-06 m
    """

    table_gap: FloatArray
    table_pressure: FloatArray

    def __post_init__(self) -> None:
        must = "gap and pressure must be arrays of numbers"
        u, p = map(np.array, as_arrays(LawError, must, self.table_gap, self.table_pressure))
        if u.ndim != 1 or u.shape != p.shape or u.size < 2:
            raise LawError(
                f"gap has shape {u.shape}, pressure {p.shape}: both need the same length, at least 2"
            )
        if not np.all(np.isfinite(u)):
            raise LawError(f"gap[{np.flatnonzero(~np.isfinite(u))[0]}] is not finite [m]")
        positive_ones = np.isfinite(p) & (p > 0.0)
        check_each(LawError, "pressure", p, positive_ones, "must be positive and finite [Pa]")
        for name, unit, steps, word in (
            ("gap", "m", np.diff(u), "increase"),
            ("pressure", "Pa", -np.diff(np.log(p)), "decrease"),
        ):
            faults = np.flatnonzero(~(steps > 0.0))
            if faults.size:
                raise LawError(
                    f"{name}[{faults[0] + 1}]: {name} must strictly {word} along the table [{unit}]"
                )
        u.flags.writeable = p.flags.writeable = False
        object.__setattr__(self, "table_gap", u)
        object.__setattr__(self, "table_pressure", p)

    @cached_property
    def _curve(self) -> MonotoneCurve:
        u, log_p = self.table_gap, np.log(self.table_pressure)
        return MonotoneCurve(u, log_p, shape_preserving_slopes(u, log_p))

    def gap(self, log_pressure: ArrayLike) -> FloatArray:
        """u at ln(p/Pa) [m]."""
        return self._curve.inverse(np.asarray(log_pressure, dtype=float))

    def decay_length(self, log_pressure: ArrayLike) -> FloatArray:
        """-du/dlnp at ln(p/Pa) [m]."""
        return -1.0 / self._curve.value_and_derivative(self.gap(log_pressure))[1]

    def pressure(self, gap: ArrayLike) -> FloatArray:
        """p at gap u [Pa]."""
        return _exp(self._curve.value(np.asarray(gap, dtype=float)))


@dataclass(frozen=True, eq=False)
class RoughSurfaceLaw:
    """Mean separation of a rough surface over pressure, as `RoughContact.interface_law` makes it.

    ln u is a cubic of ln p through exact values; below the first point the law is exactly exponential. Above the last
    one, where the gap is closed for any purpose, u falls like 1/ln p and never reaches zero, so that an iteration that
    strays there finds its way back.

    Parameters
    ----------
    log_pressure_nodes : ndarray
        ln(p/Pa), increasing, shape (n,).
    gap_nodes : ndarray
        Mean separation there, positive and decreasing, shape (n,) [m].
    decay_nodes : ndarray
        -du/dlnp there, positive, shape (n,) [m].

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> law = surface.interface_law()
    >>> bool(law.gap(10.0) > law.gap(15.0))
    True
    """

    log_pressure_nodes: FloatArray
    gap_nodes: FloatArray
    decay_nodes: FloatArray

    @cached_property
    def _curve(self) -> MonotoneCurve:
        return MonotoneCurve(
            self.log_pressure_nodes, np.log(self.gap_nodes), -self.decay_nodes / self.gap_nodes
        )

    @property
    def u0(self) -> float:
        """Decay length at low pressure [m]."""
        return float(self.decay_nodes[0])

    @property
    def p_c(self) -> float:
        """Prefactor of the low-pressure law p = p_c exp(-u/u0) [Pa]."""
        return float(np.exp(self.log_pressure_nodes[0] + self.gap_nodes[0] / self.decay_nodes[0]))

    def gap(self, log_pressure: ArrayLike) -> FloatArray:
        """u at ln(p/Pa) [m]."""
        x = np.asarray(log_pressure, dtype=float)
        if self._all_inside(x):
            return np.exp(self._curve.value_and_slope(x)[0])
        undershoot, overshoot = self._distance_outside(x)
        core = np.exp(self._curve.value(x - undershoot - overshoot))
        return core / (1.0 + self._last_rate * overshoot) - self.decay_nodes[0] * undershoot

    def decay_length(self, log_pressure: ArrayLike) -> FloatArray:
        """-du/dlnp at ln(p/Pa) [m]."""
        x = np.asarray(log_pressure, dtype=float)
        if self._all_inside(x):
            log_gap, slope = self._curve.value_and_slope(x)
            return -slope * np.exp(log_gap)
        undershoot, overshoot = self._distance_outside(x)
        log_gap, slope = self._curve.value_and_derivative(x - undershoot - overshoot)
        return -slope * np.exp(log_gap) / (1.0 + self._last_rate * overshoot) ** 2

    def pressure(self, gap: ArrayLike) -> FloatArray:
        """p at gap u [Pa]; infinite for u <= 0, full contact."""
        return np.where(np.asarray(gap) > 0.0, _exp(self.log_pressure(gap)), np.inf)

    def log_pressure(self, gap: ArrayLike) -> FloatArray:
        """ln(p/Pa) at gap u [m], also where p is too small for a number; infinite for u <= 0, full contact."""
        u = np.asarray(gap, dtype=float)
        widest, closest = self.gap_nodes[0], self.gap_nodes[-1]
        log_p = self._curve.inverse(np.log(np.clip(u, closest, widest)))
        log_p = log_p - np.maximum(u - widest, 0.0) / self.decay_nodes[0]
        ratio = closest / np.where(u > 0.0, np.minimum(u, closest), closest)
        return np.where(u > 0.0, log_p + (ratio - 1.0) / self._last_rate, np.inf)

    @property
    def _last_rate(self) -> float:
        return float(self.decay_nodes[-1] / self.gap_nodes[-1])

    def _all_inside(self, x: FloatArray) -> bool:
        """Whether all ln p lie between the first and the last point, as they mostly do."""
        nodes = self.log_pressure_nodes
        least, most = np.minimum.reduce, np.maximum.reduce
        return bool(x.size and least(x, axis=None) >= nodes[0] and most(x, axis=None) <= nodes[-1])

    def _distance_outside(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How far ln p lies below the first point (negative) and above the last one (positive)."""
        return np.minimum(x - self.log_pressure_nodes[0], 0.0), np.maximum(
            x - self.log_pressure_nodes[-1], 0.0
        )


def _exp(log_pressure: FloatArray) -> FloatArray:
    """Exponential that saturates instead of overflowing."""
    return np.exp(np.minimum(log_pressure, LARGEST_LOG))
