"""Closed pressure profiles of a line contact: smooth (Hertz), rigid and rough (Gaussian), and what lies between.

A cylinder of radius R is pressed on a half-space by a line load f_N. They judge a computed contact and serve
the leak integral without one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray
from leak.errors import ProfileError, positive
from leak.numerics.integrals import gauss
from leak.numerics.roots import bisect_roots

_BISECTIONS = 28
# A window in which the integrand stays above exp(-40) of its peak, cut into Gauss panels.
_DROP = 40.0
_PANELS = 10
_PANEL_NODES = 32


@dataclass(frozen=True)
class HertzLine:
    """Elastic line contact of smooth bodies, p = p0 sqrt(1 - (x/a)^2); use `hertz_line`.

    Examples
    --------
    >>> import leak
    >>> print(f"{leak.hertz_line(20e3, 0.02, 115e9).half_width * 1e6:.1f} um")
    66.5 um
    """

    line_load: float
    radius: float
    effective_modulus: float

    @property
    def peak_pressure(self) -> float:
        """p0 = sqrt(E* f_N/(pi R)) [Pa]."""
        return float(np.sqrt(self.effective_modulus * self.line_load / (np.pi * self.radius)))

    @property
    def half_width(self) -> float:
        """a = sqrt(4 f_N R/(pi E*)) [m]."""
        return float(np.sqrt(4.0 * self.line_load * self.radius / (np.pi * self.effective_modulus)))

    @property
    def fwhm(self) -> float:
        """Full width at half maximum, sqrt(3) a [m]."""
        return float(np.sqrt(3.0)) * self.half_width

    @property
    def std(self) -> float:
        """Standard deviation of p over x, a/2 [m]."""
        return 0.5 * self.half_width

    def pressure(self, x: ArrayLike) -> FloatArray:
        """p(x) [Pa]; zero outside the contact."""
        y = np.asarray(x, dtype=float) / self.half_width
        return self.peak_pressure * np.sqrt(np.maximum(1.0 - y**2, 0.0))


@dataclass(frozen=True)
class GaussianLine:
    """Rigid bodies with the interface law p = p_c exp(-u/u0), p = p0 exp(-x^2/2s^2); use `gaussian_line`.

    Examples
    --------
    >>> import leak
    >>> round(leak.gaussian_line(20e3, 0.02, 1e-6).std * 1e6, 1)
    141.4
    """

    line_load: float
    radius: float
    u0: float

    @property
    def std(self) -> float:
        """s = sqrt(R u0) [m]."""
        return float(np.sqrt(self.radius * self.u0))

    @property
    def peak_pressure(self) -> float:
        """p0 = f_N/(s sqrt(2 pi)) [Pa]."""
        return self.line_load / (self.std * float(np.sqrt(2.0 * np.pi)))

    @property
    def fwhm(self) -> float:
        """Full width at half maximum, 2 sqrt(2 ln 2) s [m]."""
        return 2.0 * float(np.sqrt(2.0 * np.log(2.0))) * self.std

    def log_pressure(self, x: ArrayLike) -> FloatArray:
        """ln(p/Pa) at x."""
        return np.log(self.peak_pressure) - 0.5 * (np.asarray(x, dtype=float) / self.std) ** 2

    def pressure(self, x: ArrayLike) -> FloatArray:
        """p(x) [Pa]."""
        return np.exp(self.log_pressure(x))


@dataclass(frozen=True)
class CrossoverLine:
    """Elastic half-space with the interface law p = p_c exp(-u/u0); use `crossover_line`.

    With c = f_N/(pi E* u0), s^2 = R u0, X = x/s: p = (f_N/s)/(sqrt(2 pi) Gamma(1+c) abs(D_{-c}(iX))^2), D the parabolic
    cylinder function. N = Gamma(c) abs(D_{-c}(iX))^2 obeys N''' = (X^2 + 2 - 4c) N' + X N, which has the positive
    integral used here, N = int_0^1 k^(-1/2) (1-k)^(c-1) (1+k)^(-c) exp(k X^2/2) dk.

    Examples
    --------
    >>> import leak
    >>> line = leak.crossover_line(20e3, 0.02, 115e9, 1e-6)
    >>> round(line.hertzian_share, 4)
    0.0554
    """

    line_load: float
    radius: float
    effective_modulus: float
    u0: float

    @property
    def hertzian_share(self) -> float:
        """c = f_N/(pi E* u0): small for a Gaussian, large for a Hertzian contact [-]."""
        return self.line_load / (np.pi * self.effective_modulus * self.u0)

    @property
    def _s(self) -> float:
        return float(np.sqrt(self.radius * self.u0))

    @property
    def peak_pressure(self) -> float:
        """p0 = (f_N/s) Gamma((1+c)/2)/(sqrt(2) pi Gamma(1+c/2)) [Pa]."""
        ratio = np.exp(_log_gamma_ratio(0.5 * self.hertzian_share))
        return float(self.line_load / self._s * ratio / (np.sqrt(2.0) * np.pi))

    @property
    def std(self) -> float:
        """Standard deviation of p over x, s sqrt(1+c): the Gaussian and the Hertzian variance add [m]."""
        return self._s * float(np.sqrt(1.0 + self.hertzian_share))

    @property
    def fwhm(self) -> float:
        """Full width at half maximum [m]."""
        return float(crossover_widths([self])[0])

    def log_pressure(self, x: ArrayLike) -> FloatArray:
        """ln(p/Pa) at x, also where p is too small for a floating-point number."""
        X = np.abs(np.asarray(x, dtype=float)) / self._s
        c = np.array([self.hertzian_share])
        fall = _log_N(c, X.ravel())[0] - _log_N(c, np.zeros(1))[0]
        return np.log(self.peak_pressure) - fall.reshape(X.shape)

    def pressure(self, x: ArrayLike) -> FloatArray:
        """p(x) [Pa]."""
        return np.exp(self.log_pressure(x))


LineProfile = HertzLine | GaussianLine | CrossoverLine


def hertz_line(line_load: float, radius: float, effective_modulus: float) -> HertzLine:
    """Hertz line contact.

    Parameters
    ----------
    line_load : float
        f_N [N/m].
    radius : float
        Relative radius of curvature R, 1/R = 1/R1 + 1/R2 [m].
    effective_modulus : float
        E* [Pa].

    References
    ----------
    K. L. Johnson, Contact Mechanics (1985), section 4.2; Fischer et al., "Fluid leakage in metallic seals", (2)-(5).

    Examples
    --------
    >>> hertz = hertz_line(20e3, 0.02, 115.385e9)
    >>> print(f"{hertz.peak_pressure / 1e6:.1f} MPa, a = {hertz.half_width * 1e3:.4f} mm")
    191.6 MPa, a = 0.0664 mm
    """
    return HertzLine(*_valid(line_load=line_load, radius=radius, effective_modulus=effective_modulus))


def gaussian_line(line_load: float, radius: float, u0: float) -> GaussianLine:
    """Gaussian profile of rigid rough bodies with the law p = p_c exp(-u/u0), s^2 = R u0.

    Parameters
    ----------
    line_load : float
        f_N [N/m].
    radius : float
        Relative radius of curvature R [m].
    u0 : float
        Decay length of the law [m]. For a wanted standard deviation s it is s^2/R.

    References
    ----------
    Fischer et al., "Fluid leakage in metallic seals", (8)-(10). Its (11) is misprinted: with the line load
    of (1), p0 = R p_fluid tan(theta)/(2 s sqrt(2 pi)).

    Examples
    --------
    >>> import leak
    >>> line = leak.gaussian_line(line_load=20e3, radius=0.02, u0=1e-6)
    >>> print(f"{line.peak_pressure / 1e6:.1f} MPa")
    56.4 MPa
    """
    return GaussianLine(*_valid(line_load=line_load, radius=radius, u0=u0))


def crossover_line(line_load: float, radius: float, effective_modulus: float, u0: float) -> CrossoverLine:
    """Exact profile between Gaussian and Hertz: elastic half-space with the law p = p_c exp(-u/u0).

    It does not depend on p_c, which only shifts the approach of the bodies. Relative accuracy 1e-11 in p(x).

    Parameters
    ----------
    line_load : float
        f_N [N/m].
    radius : float
        Relative radius of curvature R [m].
    effective_modulus : float
        E* [Pa].
    u0 : float
        Decay length of the law [m].

    Examples
    --------
    >>> line = crossover_line(20e3, 0.02, 210e9 / 1.82, 0.76e-6)
    >>> print(f"{line.peak_pressure / 1e6:.4f} MPa, {line.fwhm * 1e3:.6f} mm, {line.std * 1e3:.6f} mm")
    61.6678 MPa, 0.307040 mm, 0.127685 mm
    """
    return CrossoverLine(
        *_valid(line_load=line_load, radius=radius, effective_modulus=effective_modulus, u0=u0)
    )


def crossover_widths(lines: Sequence[CrossoverLine]) -> FloatArray:
    """Full widths at half maximum of several crossover profiles, looked for together: as fast as of one.

    Parameters
    ----------
    lines : sequence of CrossoverLine

    Returns
    -------
    ndarray, shape (lines,)
        [m]

    Examples
    --------
    >>> import leak
    >>> lines = [leak.crossover_line(f, 0.02, 210e9 / 1.82, 0.76e-6) for f in (10e3, 20e3)]
    >>> [f"{1e3 * width:.4f} mm" for width in leak.crossover_widths(lines)]
    ['0.2987 mm', '0.3070 mm']
    """
    half = _half_heights(tuple(line.hertzian_share for line in lines))
    return 2.0 * np.array([line._s for line in lines]) * half


_UNITS = {"line_load": "N/m", "radius": "m", "effective_modulus": "Pa", "u0": "m"}


def _valid(**values: float) -> list[float]:
    return [positive(ProfileError, name, value, _UNITS[name]) for name, value in values.items()]


def _log_gamma_ratio(z: float) -> float:
    """ln(Gamma(z + 1/2)/Gamma(z + 1)); by its asymptotic series where the two logarithms would cancel."""
    if z < 50.0:
        return math.lgamma(z + 0.5) - math.lgamma(z + 1.0)
    y = 1.0 / (z + 0.25)  # Gamma(z+1/2)/Gamma(z+1) in powers of 1/(z + 1/4): only even corrections
    return float(-0.5 * np.log(z + 0.25) + np.log1p(y**2 * (-1.0 / 64.0 + 21.0 / 8192.0 * y**2)))


@lru_cache(maxsize=256)
def _half_heights(shares: tuple[float, ...]) -> FloatArray:
    """X at which the profiles have fallen to one half, by Newton's method in ln p."""
    c = np.array(shares)
    target = _log_N(c, np.zeros_like(c))[0] + np.log(2.0)
    X = 1.1774 * np.sqrt(1.0 + 0.54 * c / (1.0 + 0.1 / (0.1 + c)))
    left = np.arange(len(c))
    for _ in range(50):
        value, slope = _log_N(c[left], X[left])
        step = (target[left] - value) / slope
        X[left] += np.clip(step, -0.3 * X[left], 0.3 * X[left])
        left = left[np.abs(step) >= 1e-12 * X[left]]
        if not len(left):
            break
    return X


def _log_N(share: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """ln N(X) and its derivative, of one c or of one for each X; k = tanh(tau), tau = e^w.

    The integral runs over the window of w in which it counts.
    N = int (tanh tau)^(-1/2) (1 + tanh tau) exp(-2 c tau + tanh(tau) X^2/2) dtau; times tau it has one peak in w.
    """
    half = 0.5 * X[:, None] ** 2
    c = share[:, None]

    def log_integrand(w: FloatArray) -> FloatArray:
        tau = np.exp(w)
        k = np.tanh(tau)
        # The peak of the exponential is taken out: half (tanh - 1), which is never positive.
        return (
            w
            - 0.5 * np.log(k)
            + np.log1p(k)
            - 2.0 * c * tau
            - half * (2.0 / (1.0 + np.exp(np.minimum(2.0 * tau, 700.0))))
        )

    def is_rising(w: FloatArray) -> BoolArray:
        tau = np.exp(w)
        k = np.tanh(tau)
        sech2 = 1.0 / np.cosh(np.minimum(tau, 300.0)) ** 2
        return 1.0 + tau * (sech2 * (-0.5 / k + 1.0 / (1.0 + k) + half) - 2.0 * c) > 0.0

    outer = np.log(60.0 / np.minimum(c, 1.0))
    low, high = np.full(half.shape, -100.0), np.maximum(outer, 6.0) + 0.0 * half
    peak = _bisect(is_rising, low, high)
    floor = log_integrand(peak) - _DROP
    left = _bisect(lambda w: log_integrand(w) < floor, low, peak)
    right = _bisect(lambda w: log_integrand(w) > floor, peak, high)
    t, weight = gauss(_PANEL_NODES)
    panel = ((np.arange(_PANELS)[:, None] + 0.5 * (1.0 + t)) / _PANELS).ravel()
    # Both flanks of the peak separately: they may differ in width by orders of magnitude.
    w = np.concatenate([left + (peak - left) * panel, peak + (right - peak) * panel], axis=1)
    dw = np.tile(weight, _PANELS) * (0.5 / _PANELS)
    measure = np.concatenate([(peak - left) * dw, (right - peak) * dw], axis=1)
    values = measure * np.exp(log_integrand(w) - log_integrand(peak))
    total = values.sum(axis=1)
    mean_k = (values * np.tanh(np.exp(w))).sum(axis=1) / total
    return log_integrand(peak)[:, 0] + half[:, 0] + np.log(total), X * mean_k


def _bisect(is_below: Callable[[FloatArray], BoolArray], low: FloatArray, high: FloatArray) -> FloatArray:
    """Where `is_below` turns from true to false between `low` and `high`."""
    low, high = bisect_roots(is_below, low, high, _BISECTIONS)
    return 0.5 * (low + high)
