"""Interface laws p(u) for a contact calculation: exponential, tabulated, and that of a rough surface.

Each law has `gap(log_pressure)`, `decay_length(log_pressure)` = -du/dlnp > 0 and `pressure(gap)`. The logarithm of
the pressure is the variable because in the tails of a contact p is too small for a floating-point number, while
the gap is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray, as_arrays, check_each
from leak.errors import LawError, positive
from leak.numerics.curves import MonotoneCurve, shape_preserving_slopes

_LARGEST_LOG = 709.0


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
            wrong = np.flatnonzero(~(steps > 0.0))
            if wrong.size:
                raise LawError(
                    f"{name}[{wrong[0] + 1}]: {name} must strictly {word} along the table [{unit}]"
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
            return np.exp(self._curve.inside(x)[0])
        below, above = self._outside(x)
        inside = np.exp(self._curve.value(x - below - above))
        return inside / (1.0 + self._last_rate * above) - self.decay_nodes[0] * below

    def decay_length(self, log_pressure: ArrayLike) -> FloatArray:
        """-du/dlnp at ln(p/Pa) [m]."""
        x = np.asarray(log_pressure, dtype=float)
        if self._all_inside(x):
            log_gap, slope = self._curve.inside(x)
            return -slope * np.exp(log_gap)
        below, above = self._outside(x)
        log_gap, slope = self._curve.value_and_derivative(x - below - above)
        return -slope * np.exp(log_gap) / (1.0 + self._last_rate * above) ** 2

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

    def _outside(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How far ln p lies below the first point (negative) and above the last one (positive)."""
        return np.minimum(x - self.log_pressure_nodes[0], 0.0), np.maximum(
            x - self.log_pressure_nodes[-1], 0.0
        )


def _exp(log_pressure: FloatArray) -> FloatArray:
    """Exponential that saturates instead of overflowing."""
    return np.exp(np.minimum(log_pressure, _LARGEST_LOG))
