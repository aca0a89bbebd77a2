"""Persson's theory of elastic rough contact: contact area, mean separation, separation where contact is lost.

The coordinate of magnification is M = int_{q0}^{zeta q0} q^3 C dq, see `PowerSpectrum.at_slope_moment`. With
y^2 = M(q) - M(zeta), dM = q^3 C dq and a = p(zeta)/(sqrt(pi) E*), the weight of the theory is w = 1/(sqrt(pi) y)
and every integral becomes one over v = (elastic M(q) - M(zeta))^(1/2) of smooth functions of a/y.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray, IntArray
from leak.numerics.integrals import gauss, sorted_unique
from leak.surfaces.spectrum import PowerSpectrum
from leak.theory.plasticity import Roughness

# F beyond this x is below 1e-18 of any value that matters.
KERNEL_END = 6.5
_KERNEL_START = 1e-4
_KERNEL_STEP = 5e-4
_LOG_START = float(np.log(_KERNEL_START))


@dataclass(frozen=True)
class Kernel:
    """F(x) = int_x^inf [gamma + 3 (1-gamma) erf^2(t)] exp(-t^2) dt/t and f = -x dF/dx, tabulated over ln x.

    F = (gamma/2) E1(x^2) + 3 (1-gamma) K(x), K(x) = int_x^inf erf^2(t) exp(-t^2) dt/t: the pressure integral of
    the mean separation (Yang & Persson, J. Phys.: Condens. Matter 20, 215214 (2008)). Good to 1e-7.
    """

    gamma: float
    K0: float
    F: FloatArray
    F_rise: FloatArray
    f: FloatArray
    f_rise: FloatArray

    def __call__(self, log_x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """F and f at ln x; below the table F goes on as its logarithm, above it both are zero."""
        last = self.F.size - 1.0
        t = np.minimum((log_x - _LOG_START) * (1.0 / _KERNEL_STEP), last)
        i = np.minimum(np.maximum(t, 0.0), last - 1.0).astype(np.intp)
        t -= i
        F = self.F_rise.take(i) * t + self.F.take(i)
        return F, self.f_rise.take(i) * np.maximum(t, 0.0) + self.f.take(i)


@lru_cache(maxsize=8)
def kernel(gamma: float) -> Kernel:
    """The tabulated kernel for one value of Yang and Persson's gamma."""
    count = int(np.ceil(np.log(KERNEL_END / _KERNEL_START) / _KERNEL_STEP)) + 1
    log_x = np.log(_KERNEL_START) + _KERNEL_STEP * np.arange(count)
    x = np.exp(log_x)
    # by the C library: importing scipy.special takes longer than this table
    erf = np.array([math.erf(number) for number in x.tolist()])
    gauss = np.exp(-(x**2))
    k = erf**2 * gauss
    dk = (4.0 / np.sqrt(np.pi)) * x * erf * gauss**2 - 2.0 * x**2 * k
    K = _integral_above(k, dk)
    F = gamma * _integral_above(gauss, -2.0 * x**2 * gauss) + 3.0 * (1.0 - gamma) * K
    f = gamma * gauss + 3.0 * (1.0 - gamma) * k
    F[-1] = f[-1] = 0.0
    return Kernel(
        gamma, float(K[0] + 2.0 / np.pi * x[0] ** 2), F, np.diff(F, append=0.0), f, np.diff(f, append=0.0)
    )


def _integral_above(k: FloatArray, dk: FloatArray) -> FloatArray:
    """Integral of k over ln x from each point to the end: corrected trapezoids, of fourth order with dk/dln x."""
    cells = 0.5 * _KERNEL_STEP * (k[1:] + k[:-1]) + _KERNEL_STEP**2 / 12.0 * (dk[:-1] - dk[1:])
    return np.concatenate([np.cumsum(cells[::-1])[::-1], [0.0]])


# Up to so many the C library is as fast; importing scipy.special takes as long as reading a whole case.
_FEW_NUMBERS = 128


def erf(x: ArrayLike) -> FloatArray:
    """The error function of each number.

    Parameters
    ----------
    x : array_like
        [-]

    Returns
    -------
    ndarray
        Of the same shape.

    Examples
    --------
    >>> from leak.theory.persson import erf
    >>> erf([0.0, 0.5]).round(6).tolist()
    [0.0, 0.5205]
    """
    numbers = np.asarray(x, dtype=float)
    if numbers.size > _FEW_NUMBERS:
        from scipy.special import erf as erf_of_many

        return np.asarray(erf_of_many(numbers))
    return np.array([math.erf(number) for number in numbers.ravel().tolist()]).reshape(numbers.shape)[()]


# Below this fraction of the local slope the integrand v F contributes less than 1e-8 of the separation.
_SMALLEST_STEP = 1e-9
# Gauss points of a part over which things change by L e-folds: 1 + this times L^0.7, found by doubling them.
_POINTS = 3.0
# G/sigma_P^2 where C_pl begins to leave C and where it has nearly gone.
_YIELD_VARIANCES = (0.03, 0.3, 1.2)
_LOG_KERNEL_END, _LOG_SMALLEST_STEP = float(np.log(KERNEL_END)), float(np.log(_SMALLEST_STEP))
_LOWEST_LOG, _TINY = -300.0, 1e-300
# erf(z) is 1 to the last digit here; nothing of the contact is lost at lower magnification.
FULL_CONTACT = 6.0


def moment_of_all(roughness: Roughness, pressures: int) -> FloatArray:
    """Slope moment of all the roughness that is seen at so many pressures, shape (pressures,) [-]."""
    return roughness.moment(np.full((pressures, 1), roughness.end))[:, 0]


# -------------------------------------------------------------------- contact area


def area_argument(relative_pressure: ArrayLike, slope_moment: ArrayLike) -> FloatArray:
    """z = p/(2 sqrt(G)) with G = (pi/4) E*^2 M, from p/E* and M; infinite before any roughness is seen."""
    p = np.asarray(relative_pressure, dtype=float)
    M = np.asarray(slope_moment, dtype=float)
    with np.errstate(divide="ignore"):
        return np.where(M > 0.0, p / np.sqrt(np.pi * np.maximum(M, 0.0)), np.inf)


def relative_contact_area(
    pressure: ArrayLike, slope_moment: ArrayLike, effective_modulus: float
) -> FloatArray:
    """Relative contact area A/A0 = erf(p/(2 sqrt(G))), G = (pi/4) E*^2 int q^3 C dq.

    Parameters
    ----------
    pressure : array_like
        Nominal pressure p [Pa].
    slope_moment : array_like
        int q^3 C dq up to the magnification looked at, broadcast against `pressure` [-].
    effective_modulus : float
        E* [Pa].

    Returns
    -------
    ndarray
        A/A0, in [0, 1].

    References
    ----------
    B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001).

    Examples
    --------
    >>> import leak
    >>> print(f"{float(leak.relative_contact_area(1e7, 0.01, 115e9)):.2e}")
    5.54e-04
    """
    return erf(area_argument(np.asarray(pressure, dtype=float) / effective_modulus, slope_moment))


# -------------------------------------------------------------------- separations


class Separations(NamedTuple):
    """What the theory says about the gap at one magnification; arrays (pressures, magnifications)."""

    mean: FloatArray
    """Mean separation ubar outside the contact seen at this magnification [m]."""
    decay: FloatArray
    """-d ubar/d ln p at fixed magnification and contact area [m]."""
    lost_separation: FloatArray
    """u1 = d(ubar A)/dA, separation where contact is lost just above this magnification [m]."""
    area: FloatArray
    """A/A0 at this magnification [-]."""


def separations(
    spectrum: PowerSpectrum,
    roughness: Roughness,
    relative_pressure: FloatArray,
    M: FloatArray,
    gamma: float,
    *,
    refinement: float = 1.0,
) -> Separations:
    """Mean separation and separation where contact is lost, at given magnifications.

    ubar(zeta) = sqrt(pi) int_{zeta q0}^{q1} q^2 C w F(w p(zeta)/E*) dq and u1 = d(ubar A)/dA. With the boundary
    term taken into the integral, every term of u1 is positive:
    u1 = ubar - dubar/dlnp + (A/|dA/dM|) int_{zeta q0}^inf F/(y q^2) dq.

    Parameters
    ----------
    spectrum : PowerSpectrum
        Roughness before plastic deformation.
    roughness : Roughness
        What of it remains at each pressure.
    relative_pressure : ndarray
        p/E*, shape (P,), positive [-].
    M : ndarray
        Elastic slope moment of each magnification, shape (P, Z), or (1, Z) if it is the same at all pressures; zero for
        "no roughness seen" [-].
    gamma : float
        Yang and Persson's factor, 0.45 [-].
    refinement : float
        Factor on the number of quadrature points.

    References
    ----------
    C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008).
    """
    moment = roughness.moment(M)
    z = area_argument(relative_pressure[:, None], moment)
    A = erf(z)
    log_a = np.log(relative_pressure[:, None] / (np.sqrt(np.pi) * A))
    parts = _parts(spectrum, roughness.kappa, roughness.end)
    log_v, weight, piece = _steps(spectrum, parts, M, log_a, refinement)
    v2 = np.exp(2.0 * log_v)
    log_q, log_C = _point(spectrum, piece, M[..., None] + v2)
    moment_above = roughness.moments_above(M[..., None])
    y2, factor = moment_above(v2)
    elastic = y2 is v2
    log_y = log_v if elastic else 0.5 * np.log(np.maximum(y2, _TINY))
    # v^2 dv/(q y) of each point
    common = (np.exp(log_v - log_q) if elastic else np.exp(-log_q - log_y) * v2) * (2.0 * weight)
    F, f = (part * common for part in kernel(gamma)(log_a[..., None] - log_y))
    tail = np.vecdot(F, np.exp(-4.0 * log_q - log_C))
    mean, decay = np.vecdot(F, factor), np.vecdot(f, factor)
    # (A/|dA/dM|) int F/(y q^2) dq, with the part beyond the end of the spectrum in closed form
    to_end = np.sqrt(np.maximum(moment_above((roughness.end - M)[..., None])[0][..., 0], _TINY))
    tail_beyond = kernel(gamma)(log_a - np.log(to_end))[0] / (to_end * np.exp(parts.log_wavenumber[-1]))
    z = np.minimum(z, FULL_CONTACT)
    per_moment = A * np.sqrt(np.pi) * moment * np.exp(z**2) / z
    return Separations(mean, decay, mean + decay + per_moment * (tail + tail_beyond), A)


def _point(spectrum: PowerSpectrum, piece: IntArray | None, M: FloatArray) -> tuple[FloatArray, FloatArray]:
    return spectrum.at_slope_moment(M) if piece is None else spectrum.on_piece(piece, M)


class _Parts(NamedTuple):
    """Where integrals over magnification are split: the spectrum kinks, or plastic smoothing sets in or ends."""

    kappa: float
    """See `Roughness`."""
    ends: FloatArray
    """Elastic moments at the end of each part, shape (n,)."""
    log_wavenumber: FloatArray
    """ln q there, shape (n,)."""
    piece: IntArray | None
    """Piece of the spectrum that each part is in, shape (n,); None where parts reach over kinks."""


@lru_cache(maxsize=64)
def _parts(spectrum: PowerSpectrum, kappa: float, end: float) -> _Parts:
    breaks, pieces = spectrum.break_moments, spectrum.break_pieces
    ends = sorted_unique(np.concatenate([breaks, np.array(_YIELD_VARIANCES) / kappa]) if kappa else breaks)
    ends = np.append(ends[(ends > 0.0) & (ends < end)], end)
    if pieces is not None:
        starts = np.concatenate([[0.0], ends[:-1]])
        pieces = pieces[breaks[1:-1].searchsorted(starts, side="right")]
    return _Parts(kappa, ends, spectrum.at_slope_moment(ends).log_wavenumber, pieces)


def _steps(
    spectrum: PowerSpectrum, parts: _Parts, M: FloatArray, log_a: FloatArray, refinement: float
) -> tuple[FloatArray, FloatArray, IntArray | None]:
    """Gauss points in ln v between the smallest step that counts and the end.

    Each part gets as many points as its longest instance needs.
    """
    least = M.min()
    first = int(parts.ends[:-1].searchsorted(least, side="right"))
    ends = parts.ends[first:]
    point = spectrum.at_slope_moment(np.minimum(M, ends[-1]))
    local = 0.5 * point.log_density + 2.0 * point.log_wavenumber
    with np.errstate(divide="ignore"):
        edges = 0.5 * np.log(np.maximum(ends - M[..., None], 0.0))
    top = edges[..., -1] = np.maximum(edges[..., -1], _LOWEST_LOG)
    bottom = np.maximum(log_a - _LOG_KERNEL_END, _LOG_SMALLEST_STEP + np.minimum(local, top))
    bottom = np.minimum(bottom, top)[..., None]
    bounds = np.concatenate([bottom, np.maximum(edges, bottom)], axis=-1)
    swept = np.zeros(ends.shape)
    if len(M) < len(bounds):
        # one set of points for all pressures: from where the first of them begins, as close as the last wants them
        last, bounds = bounds.max(axis=0), bounds.min(axis=0, keepdims=True)
        swept = (np.diff(bounds[0]) - np.diff(last)).max(axis=0)
    length = bounds[..., 1:] - bounds[..., :-1]
    longest = length.reshape(-1, length.shape[-1]).max(axis=0)
    log_q = np.concatenate([[point.log_wavenumber.min()], parts.log_wavenumber[first:]])
    fall = np.minimum(_POINTS * parts.kappa * np.diff(ends, prepend=least), 3.0)
    detail = longest + swept + 0.5 * (log_q[1:] - log_q[:-1]) + fall
    counts = np.where(longest > 0.0, np.ceil(1.0 + refinement * _POINTS * detail**0.7), 0.0).astype(np.intp)
    if not counts.any():
        counts[-1] = 1
    rules = [gauss(count) for count in counts.tolist() if count]
    t, w = np.concatenate(rules, axis=1) if len(rules) > 1 else np.array(rules[0])
    half = 0.5 * length.repeat(counts, axis=-1)
    log_v = bounds[..., :-1].repeat(counts, axis=-1)
    log_v += half * (1.0 + t)
    half *= w
    piece = None if parts.piece is None else parts.piece[first:].repeat(counts)
    return log_v, half, piece


# -------------------------------------------------------------------- low-pressure law


class LowPressureLaw(NamedTuple):
    """p = p_c exp(-ubar/u0)."""

    u0: float
    """Decay length [m]."""
    relative_p_c: float
    """p_c/E* [-]."""


def low_pressure_law(spectrum: PowerSpectrum, gamma: float) -> LowPressureLaw:
    """The exponential law that the mean separation follows at low pressure.

    u0 = sqrt(pi) gamma int q^2 C w dq, ln(p_c/E*) = <ln(1/w)> - gamma_Euler/2 + 3 (1-gamma) K(0)/gamma with the
    weight q^2 C w.

    References
    ----------
    C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008); B. N. J. Persson, Phys. Rev. Lett. 99,
    125502 (2007).
    """
    parts = _parts(spectrum, 0.0, spectrum.last_moment)
    log_y, weight, piece = _steps(spectrum, parts, np.zeros((1, 1)), np.full((1, 1), -1e3), 3)
    y2 = np.exp(2.0 * log_y)
    log_q, _ = _point(spectrum, piece, y2)
    y = np.sqrt(np.maximum(y2, _TINY))
    measure = 2.0 * weight * y2 / y * np.exp(-log_q)
    total = float(measure.sum())
    mean_log = float((measure * np.log(np.sqrt(np.pi) * y)).sum()) / total
    log_p_c = mean_log - 0.5 * np.euler_gamma + 3.0 * (1.0 - gamma) * kernel(gamma).K0 / gamma
    return LowPressureLaw(gamma * total, float(np.exp(log_p_c)))
