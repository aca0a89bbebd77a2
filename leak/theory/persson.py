"""Persson's theory of elastic rough contact: contact area, mean separation, separation where contact is lost.

The coordinate of magnification is M = int_{q0}^{zeta q0} q^3 C dq, see `PowerSpectrum.at_slope_moment`. With
y^2 = M(q) - M(zeta), dM = q^3 C dq and a = p(zeta)/(sqrt(pi) E*), the weight of the theory is w = 1/(sqrt(pi) y)
and every integral becomes one over v = (elastic M(q) - M(zeta))^(1/2) of smooth functions of a/y.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from leak.arrays import FloatArray, different
from leak.numerics.gauss import gauss
from leak.numerics.special import erf
from leak.surfaces.spectrum import PowerSpectrum
from leak.theory.kernel import KERNEL_END, kernel

# Below this fraction of the local slope the integrand v F contributes less than 1e-8 of the separation.
_SMALLEST_STEP = 1e-9
# Gauss points of a part over which things change by L e-folds: 1 + this times L^0.7, found by doubling them.
_POINTS = 3.0
# G/sigma_P^2 where C_pl begins to leave C and where it has nearly gone.
_YIELDING = (0.03, 0.3, 1.2)
_LOWEST_LOG = -300.0
# erf(z) is 1 to the last digit here; nothing of the contact is lost at lower magnification.
FULL_CONTACT = 6.0


class RoughnessSeen(Protocol):
    """The slope moments of a surface at given pressures, as a function of the elastic moment M.

    Arrays start with the axis of the pressures. An elastic surface is the same at every pressure; asperity
    plasticity (`leak.theory.plasticity`) takes short waves away as the pressure rises.
    """

    @property
    def end(self) -> float:
        """Elastic moment above which nothing is left, at most that of the whole spectrum [-]."""

    @property
    def last_loss(self) -> float:
        """Elastic moment above which the contact loses less than 1e-9 of its area, at most `end` [-]."""

    @property
    def kappa(self) -> float:
        """(pi/4) (E*/sigma_P)^2: kappa M = G/sigma_P^2, zero if nothing yields [-]."""

    def moment(self, M: FloatArray) -> FloatArray:
        """Slope moment that remains up to the elastic moment M [-]."""

    def factor(self, M: FloatArray) -> FloatArray:
        """Fraction of C that remains at the elastic moment M [-]."""

    def step(self, M: FloatArray, rise: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Remaining moment between M and M + rise, and the factor at M + rise; no cancellation."""


@dataclass(frozen=True)
class ElasticRoughness:
    """The spectrum as it is."""

    end: float

    @property
    def last_loss(self) -> float:
        """The end of the spectrum."""
        return self.end

    @property
    def kappa(self) -> float:
        """Nothing yields."""
        return 0.0

    def moment(self, M: FloatArray) -> FloatArray:
        """M itself."""
        return M

    def factor(self, M: FloatArray) -> FloatArray:
        """One everywhere."""
        return np.ones_like(M)

    def step(self, M: FloatArray, rise: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The rise itself."""
        return rise, np.ones((1,) * rise.ndim)


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
    lost: FloatArray
    """u1 = d(ubar A)/dA, separation where contact is lost just above this magnification [m]."""
    area: FloatArray
    """A/A0 at this magnification [-]."""


def separations(
    spectrum: PowerSpectrum,
    seen: RoughnessSeen,
    relative_pressure: FloatArray,
    M: FloatArray,
    gamma: float,
    *,
    refinement: int = 1,
) -> Separations:
    """Mean separation and separation where contact is lost, at given magnifications.

    ubar(zeta) = sqrt(pi) int_{zeta q0}^{q1} q^2 C w F(w p(zeta)/E*) dq and u1 = d(ubar A)/dA. With the boundary
    term taken into the integral, every term of u1 is positive:
    u1 = ubar - dubar/dlnp + (A/|dA/dM|) int_{zeta q0}^inf F/(y q^2) dq.

    Parameters
    ----------
    spectrum : PowerSpectrum
        Roughness before plastic deformation.
    seen : RoughnessSeen
        What of it remains at each pressure.
    relative_pressure : ndarray
        p/E*, shape (P,), positive [-].
    M : ndarray
        Elastic slope moment of each magnification, shape (P, Z), zero for "no roughness seen" [-].
    gamma : float
        Yang and Persson's factor, 0.45 [-].
    refinement : int
        Factor on the number of quadrature points.

    References
    ----------
    C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008).
    """
    remaining = seen.moment(M)
    z = area_argument(relative_pressure[:, None], remaining)
    A = erf(z)
    log_a = np.log(relative_pressure[:, None] / (np.sqrt(np.pi) * A))
    log_v, weight, piece = _steps(spectrum, seen, M, log_a, refinement)
    v2 = np.exp(2.0 * log_v)
    log_q, log_C = _point(spectrum, piece, M[..., None] + v2)
    y2, factor = seen.step(M[..., None], v2)
    if y2 is v2:
        log_y = log_v
        common = np.exp(log_v - log_q)
    else:
        y2 = np.maximum(y2, 1e-300)
        log_y = 0.5 * np.log(y2)
        common = v2 * np.exp(-log_q - log_y)
    F, f = kernel(gamma)(log_a[..., None] - log_y)
    common *= weight
    common *= 2.0
    F *= common
    f *= common
    slope = np.exp(-4.0 * log_q - log_C)
    slope *= F
    tail = slope.sum(axis=-1)
    if factor.size > 1:
        F *= factor
        f *= factor
    mean, decay = F.sum(axis=-1), f.sum(axis=-1)
    return Separations(
        mean, decay, mean + decay + _lost(spectrum, seen, M, remaining, z, A, log_a, tail, gamma), A
    )


def _lost(
    spectrum: PowerSpectrum,
    seen: RoughnessSeen,
    M: FloatArray,
    remaining: FloatArray,
    z: FloatArray,
    A: FloatArray,
    log_a: FloatArray,
    tail: FloatArray,
    gamma: float,
) -> FloatArray:
    """(A/|dA/dM|) int F/(y q^2) dq, with the part beyond the end of the spectrum in closed form."""
    to_end, _ = seen.step(M[..., None], (seen.end - M)[..., None])
    Y = np.sqrt(np.maximum(to_end[..., 0], 1e-300))
    q_end = np.exp(spectrum.at_slope_moment(np.asarray(seen.end)).log_wavenumber)
    beyond = kernel(gamma)(log_a - np.log(Y))[0] / (Y * q_end)
    z_safe = np.minimum(z, FULL_CONTACT)
    per_moment = A * np.sqrt(np.pi) * remaining * np.exp(z_safe**2) / z_safe
    return per_moment * (tail + beyond)


def _point(
    spectrum: PowerSpectrum, piece: NDArray[np.intp] | None, M: FloatArray
) -> tuple[FloatArray, FloatArray]:
    return spectrum.at_slope_moment(M) if piece is None else spectrum.on_piece(piece, M)


def _steps(
    spectrum: PowerSpectrum, seen: RoughnessSeen, M: FloatArray, log_a: FloatArray, refinement: int
) -> tuple[FloatArray, FloatArray, NDArray[np.intp] | None]:
    """Gauss points in ln v between the smallest step that counts and the end.

    The range is split where the spectrum kinks and where plastic smoothing sets in and ends; each part gets as many
    points as its longest instance needs.
    """
    end = seen.end
    breaks = spectrum.break_moments
    yielding = np.array(_YIELDING) / seen.kappa if seen.kappa else breaks[:0]
    inner = different(np.concatenate([breaks, yielding]))
    inner = inner[(inner > M.min()) & (inner < end)]
    point = spectrum.at_slope_moment(np.minimum(M, end))
    local = 0.5 * (point.log_density + 4.0 * point.log_wavenumber)
    with np.errstate(divide="ignore"):
        top = 0.5 * np.log(np.maximum(end - M, 0.0))
        edges = 0.5 * np.log(np.maximum(inner - M[..., None], 0.0))
    top = np.maximum(top, _LOWEST_LOG)
    bottom = np.maximum(log_a - np.log(KERNEL_END), np.log(_SMALLEST_STEP) + np.minimum(local, top))
    bottom = np.minimum(bottom, top)[..., None]
    bounds = np.concatenate([bottom, np.clip(edges, bottom, top[..., None]), top[..., None]], axis=-1)
    length = np.diff(bounds, axis=-1)
    longest = length.reshape(-1, length.shape[-1]).max(axis=0)
    ends = np.concatenate([[M.min()], inner, [end]])
    fall = np.minimum(_POINTS * seen.kappa * np.diff(ends), 3.0)
    detail = longest + 0.5 * np.diff(spectrum.at_slope_moment(ends).log_wavenumber) + fall
    counts = np.where(longest > 0.0, np.ceil(refinement * (1.0 + _POINTS * detail**0.7)), 0).astype(int)
    rules = [gauss(int(count)) for count in counts if count]
    t = np.concatenate([rule[0] for rule in rules]) if rules else np.zeros(1)
    w = np.concatenate([rule[1] for rule in rules]) if rules else np.zeros(1)
    part = np.repeat(np.arange(counts.size), counts) if rules else np.zeros(1, dtype=np.intp)
    half = 0.5 * length[..., part]
    log_v = bounds[..., part] + half * (1.0 + t)
    piece = None
    if spectrum.break_pieces is not None:
        lower = np.concatenate([[M.min()], inner])
        interval = np.searchsorted(breaks[1:-1], lower, side="right")
        piece = spectrum.break_pieces[interval][part]
    return log_v, half * w, piece


# -------------------------------------------------------------------- low-pressure law


class LowPressureLaw(NamedTuple):
    """p = p_c exp(-ubar/u0)."""

    u0: float
    """Decay length [m]."""
    relative_p_c: float
    """p_c/E* [-]."""


def low_pressure_law(
    spectrum: PowerSpectrum, gamma: float, seen: RoughnessSeen | None = None
) -> LowPressureLaw:
    """The exponential law that the mean separation follows at low pressure.

    u0 = sqrt(pi) gamma int q^2 C w dq, ln(p_c/E*) = <ln(1/w)> - gamma_Euler/2 + 3 (1-gamma) K(0)/gamma with the
    weight q^2 C w; `seen` is the roughness at vanishing pressure, shape (1,).

    References
    ----------
    C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008); B. N. J. Persson, Phys. Rev. Lett. 99,
    125502 (2007).
    """
    seen = seen or ElasticRoughness(spectrum.last_moment)
    M = np.zeros((1, 1))
    log_v, weight, piece = _steps(spectrum, seen, M, np.full((1, 1), -1e3), 3)
    v2 = np.exp(2.0 * log_v)
    log_q, _ = _point(spectrum, piece, v2)
    y2, factor = seen.step(M[..., None], v2)
    y = np.sqrt(np.maximum(y2, 1e-300))
    measure = 2.0 * weight * v2 / y * factor * np.exp(-log_q)
    total = float(measure.sum())
    mean_log = float((measure * np.log(np.sqrt(np.pi) * y)).sum()) / total
    log_p_c = mean_log - 0.5 * np.euler_gamma + 3.0 * (1.0 - gamma) * kernel(gamma).K0 / gamma
    return LowPressureLaw(gamma * total, float(np.exp(log_p_c)))
