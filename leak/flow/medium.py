"""Equivalent gap of a rough interface: effective medium, critical junction, closed law of the threshold.

The aspect of the medium's inclusions and the touching pressure of a surface with a lay were fitted to direct
simulations of stretched surfaces, pressed elastically, and judged by others (theory/anisotropy in the manual). Both are
one for an isotropic surface.

Persson's contact area is 15 to 30 % too small, and Bruggeman's medium too tight where few channels are left: two errors
that cancel in part. The closed law near the percolation threshold takes each for itself, for isotropic surfaces.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ConductivityError
from leak.flow.rarefied import log_flow_factor
from leak.numerics.curves import MonotoneCurve
from leak.numerics.integrals import gauss_panels
from leak.numerics.roots import MOST_STEPS, bisect_roots
from leak.surfaces.spectrum import PowerSpectrum
from leak.theory.persson import moment_of_all, separations
from leak.theory.plasticity import Roughness
from leak.theory.separation import LostArea, SeparationGrid, density

# ln u_eff^3 may lie this far outside the separations given; what comes as close to the lower end of that is sealed.
_BELOW_ALL, _SEALED_MARGIN = 60.0, 0.6
# Newton's error squares with each step: after a step this small it is some 1e-14.
_CLOSE, _FIRST_CLOSE, _WORTH = 1e-7, 0.1, 0.1


class DirectionalGap(NamedTuple):
    """Effective separations of an anisotropic interface, each shape (P,) [m].

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> contact = leak.RoughContact(spectrum, effective_modulus=115e9, peklenik=4.0)
    >>> contact.peklenik
    4.0
    """

    along: FloatArray
    """u_eff for flow along x, the direction in which gamma_T stretches the roughness."""
    across: FloatArray
    """u_eff for flow along y."""


def anisotropic_medium(
    separation: FloatArray,
    weight: FloatArray,
    contact: FloatArray,
    wide_open: FloatArray,
    n: float,
    peklenik: float | FloatArray,
    near: DirectionalGap | None = None,
) -> DirectionalGap:
    """Separations of the uniform gaps that let as much through as P(u) in the two principal directions.

    Solves int dsigma P(sigma) (sigma - s_x)/(s_x + n_x (sigma - s_x)) = 0 and the same for y, sigma ~ u^3, with

        n_x = 1/(1 + k gamma_T sqrt(s_y/s_x)),   n_y = 1/(1 + (k/gamma_T) sqrt(s_x/s_y)),   k = n - 1 = a_c/(1 - a_c).

    Theory, for k = 1: every place of the interface is an elliptic inclusion of axes gamma_T : 1 in a medium that
    conducts s_x along x and s_y along y; in coordinates scaled by sqrt(s_x) and sqrt(s_y) the medium is isotropic and
    n_x, n_y = 1 - n_x are the depolarisation factors of an ellipse. Heuristic: k != 1, which moves the percolation
    threshold from A/A0 = 0.5 to a_c in both directions, as in `effective_medium`.

    Parameters
    ----------
    separation, weight, contact, wide_open, n
        See `leak.flow.medium.effective_medium`.
    peklenik : float or ndarray
        gamma_T, length of the inclusions along x over that along y, one number or shape (P,), all of them on the same
        side of one: the Tripp (Peklenik) number of a field, `inclusion_aspect` where surfaces touch [-].
    near : DirectionalGap, optional
        About what the gaps are, positive: where the iteration begins [m].

    Returns
    -------
    DirectionalGap
        Both zero where the contact has percolated.

    Notes
    -----
    gamma_T = 1 is `effective_medium` itself. With m = gamma_T sqrt(s_y/s_x) the two equations are isotropic ones with
    n - 1 = k m and k/m; s_x rises and s_y falls with m, so ln m - ln(gamma_T) - ln(s_y/s_x)/2 has exactly one root.
    Both conductivities vanish at A/A0 = a_c, whatever gamma_T, with s_x/s_y -> gamma_T^2. For gamma_T -> infinity the
    medium gives the arithmetic mean along and the harmonic mean across if the latter is not zero; with a fraction a
    in contact it is zero, m stays below k (1-a)/a, and s_x is what n_x = a/(a + k^2 (1-a)) gives: less than the
    arithmetic mean, since even long ridges leave no open path beyond the threshold.

    References
    ----------
    B. N. J. Persson, Eur. Phys. J. E 43, 25 (2020), arXiv:2003.02007; A. Wang, M. H. Mueser, Tribol. Lett. 69, 1
    (2021), arXiv:2010.13470.

    Examples
    --------
    A gap of 1 um with narrow scratches of 2 um, run through and then crossed by the fluid:

    >>> u, share = np.array([[1e-6, 2e-6]]), np.array([[0.7, 0.3]])
    >>> none = np.zeros(1)
    >>> through, crossed = anisotropic_medium(u, share, none, none, 2.0, 1e6)
    >>> print(f"{through[0] ** 3 * 1e18:.4f} {crossed[0] ** 3 * 1e18:.4f}")
    3.1000 1.3559
    """
    return _Medium.of(np.log(separation), weight, contact, wide_open).gaps(n, peklenik, near)


class _Medium(NamedTuple):
    """P(sigma) of P pressures in a unit of its own for each, and Bruggeman's balance over it."""

    log_unit: FloatArray
    """ln of the unit of u^3, shape (P,)."""
    sigma: FloatArray
    """u^3 in that unit, shape (P, U)."""
    weight: FloatArray
    contact: FloatArray
    wide_open: FloatArray
    lowest: FloatArray
    highest: FloatArray
    """Where ln s is looked for, shape (P,)."""

    flow_weight: FloatArray
    """Weight times u^3 in that unit, shape (P, U)."""

    @classmethod
    def of(
        cls, log_separation: FloatArray, weight: FloatArray, contact: FloatArray, wide_open: FloatArray
    ) -> _Medium:
        log_u3 = 3.0 * log_separation
        unit = log_u3[:, -1]
        highest = np.where(wide_open > 0.0, _BELOW_ALL, 0.0)
        sigma = np.exp(log_u3 - unit[:, None])
        lowest = log_u3[:, 0] - unit - _BELOW_ALL
        return cls(unit, sigma, weight, contact, wide_open, lowest, highest, weight * sigma)

    @property
    def middle(self) -> FloatArray:
        return 0.5 * (self.lowest + _BELOW_ALL)

    def gap(self, log_s: FloatArray) -> FloatArray:
        return np.exp((log_s + self.log_unit) / 3.0)

    def gaps(
        self, n: float, peklenik: float | FloatArray, near: DirectionalGap | None = None
    ) -> DirectionalGap:
        """See `anisotropic_medium`."""
        gamma = np.asarray(peklenik, dtype=float)
        if np.any(gamma < 1.0):
            if np.any(gamma > 1.0):
                raise ConductivityError(
                    f"peklenik = {peklenik}: must lie on one side of 1 at all pressures [-]"
                )
            turned_guess = None if near is None else DirectionalGap(near.across, near.along)
            across, along = self.gaps(n, 1.0 / gamma, turned_guess)
            return DirectionalGap(along, across)
        k, log_gamma, contact, shape = n - 1.0, np.log(gamma), self.contact, self.contact.shape
        open_area = self.weight.sum(axis=-1) + self.wide_open
        if np.all(gamma == 1.0):
            guess = self.middle if near is None else 3.0 * np.log(near.along) - self.log_unit
            log_s, _ = self.solve(np.full(shape, k), guess)
            is_sealed = open_area <= contact / k
            same = np.where(is_sealed | (log_s < self.lowest + _SEALED_MARGIN), 0.0, self.gap(log_s))
            return DirectionalGap(same, same)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            # s_y is positive below this ln m, s_x above its negative; no room between them is percolation.
            room = np.log(k * open_area / contact)
        low, high = np.zeros(shape), np.clip(room, 0.0, log_gamma)
        if near is None:
            log_m = 0.5 * high
            isotropic, rise = self.solve(np.full(shape, k), self.middle)
            x, y = isotropic + rise * log_m, isotropic - rise * log_m
        else:
            x, y = (3.0 * np.log(gap) - self.log_unit for gap in near)
            log_m = log_gamma + 0.5 * (y - x)
            log_m = np.where((log_m > low) & (log_m < high), log_m, 0.5 * high)
        close = _FIRST_CLOSE
        for _ in range(MOST_STEPS):
            # s_x and s_y as well as the step of ln m deserves: in the end all three take one step of Newton's method
            x, rise_x = self.solve(k * np.exp(log_m), x, close)
            y, rise_y = self.solve(k * np.exp(-log_m), y, close)
            excess = log_m - log_gamma - 0.5 * (y - x)
            low, high = np.where(excess < -close, log_m, low), np.where(excess > close, log_m, high)
            newton = log_m - excess / (1.0 + 0.5 * (rise_x + rise_y))
            next_log_m = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
            step, log_m = next_log_m - log_m, next_log_m
            step_x, step_y = rise_x * step, -rise_y * step
            x, y = x + step_x, y + step_y
            largest = float(np.abs([step, step_x, step_y]).max())
            if max(largest, close) <= _CLOSE:
                break
            close = min(max(_WORTH * largest, _CLOSE), _FIRST_CLOSE)
        is_sealed = ~(room > 0.0)
        return DirectionalGap(
            *(np.where(is_sealed | (s < self.lowest + _SEALED_MARGIN), 0.0, self.gap(s)) for s in (x, y))
        )

    def solve(self, k: FloatArray, guess: FloatArray, close: float = _CLOSE) -> tuple[FloatArray, FloatArray]:
        """Root ln s of int P (sigma - s)/(sigma + k s) = 0, and its derivative with respect to ln k.

        With B = int P sigma/(sigma + k s) and A = int P k s/(sigma + k s) the balance is A/B = target. The logarithm of
        A/B rises with ln s, by exactly ln s for a single sigma and never faster: Newton's method needs a few steps from
        anywhere, the last of which is shorter than `close`. Where the contact has percolated the root is the lower end.
        """
        low, high, weight, flow_weight = self.lowest, self.highest, self.weight, self.flow_weight
        all_weight = weight.sum(axis=-1)
        most_open, wide_k = k * (all_weight + self.wide_open), k * self.wide_open
        flow_area = most_open - self.contact
        block_area = np.maximum(all_weight + self.contact - wide_k, 1e-300)
        open_row = flow_area > 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            target = np.log(flow_area / block_area)
            guess = np.where(open_row, np.minimum(np.maximum(guess, low), high), low)
            for _ in range(MOST_STEPS):
                ks = k * np.exp(guess)
                inverse = self.sigma + ks[:, None]
                np.reciprocal(inverse, out=inverse)
                A, B = ks * np.vecdot(weight, inverse), np.vecdot(flow_weight, inverse)
                X = ks * np.vecdot(flow_weight, np.square(inverse, out=inverse))
                excess, slope = np.log(A / B) - target, X * (1.0 / A + 1.0 / B)
                newton = guess - excess / slope
                low, high = np.where(excess < 0.0, guess, low), np.where(excess < 0.0, high, guess)
                next_guess = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
                next_guess = np.where(open_row, next_guess, guess)
                step = np.abs(next_guess - guess).max()
                guess = next_guess
                if step <= close:
                    break
            # the logarithm of A/B rises with ln k as with ln s, the target by this
            by_log_k = most_open / flow_area + wide_k / block_area
            return guess, np.where(open_row, np.maximum(by_log_k / slope - 1.0, 0.0), 0.0)


def dimension_number(percolation_threshold: float) -> float:
    """n = 1/(1 - a_c): the number in Bruggeman's formula that makes the open area percolate at A/A0 = a_c.

    n = 2 is the textbook value with a_c = 0.5; a_c = 0.42 (n = 1.724) agrees with direct numerical results.

    Parameters
    ----------
    percolation_threshold : float
        a_c, relative contact area above which no channel is open, below 1 [-].

    References
    ----------
    W. B. Dapp et al., Phys. Rev. Lett. 108, 244301 (2012).

    Examples
    --------
    >>> import leak
    >>> leak.dimension_number(0.5)
    2.0
    """
    if not 0.0 < percolation_threshold < 1.0:
        raise ConductivityError(
            f"percolation_threshold = {percolation_threshold}: must lie between 0 and 1 [-]"
        )
    return 1.0 / (1.0 - percolation_threshold)


def effective_medium(
    separation: FloatArray, weight: FloatArray, contact: FloatArray, wide_open: FloatArray, n: float
) -> FloatArray:
    """Separation u_eff of the uniform gap that lets as much through as the distribution P(u).

    Solves int dsigma P(sigma) (sigma - s)/(sigma + (n-1) s) = 0 with sigma ~ u^3 and s ~ u_eff^3, contact included
    at sigma = 0.

    Parameters
    ----------
    separation : ndarray
        u > 0, increasing along the last axis, shape (P, U) [m].
    weight : ndarray
        Area with that separation, P(u) du, shape (P, U) [-].
    contact : ndarray
        Area that lets nothing through, shape (P,) [-].
    wide_open : ndarray
        Area with a separation beyond all of `separation`, shape (P,) [-].
    n : float
        See `dimension_number` [-].

    Returns
    -------
    ndarray
        u_eff, shape (P,); zero where the contact has percolated [m].

    References
    ----------
    D. A. G. Bruggeman, Ann. Phys. 416, 636 (1935); W. B. Dapp et al., Phys. Rev. Lett. 108, 244301 (2012).

    Examples
    --------
    A uniform gap with a fraction a in contact conducts 1 - a n/(n-1) of the open gap:

    >>> u = effective_medium(np.array([[1e-6]]), np.array([[0.8]]), np.array([0.2]), np.array([0.0]), 2.0)
    >>> round(float(u[0] ** 3 / 1e-18), 9)
    0.6
    """
    return anisotropic_medium(separation, weight, contact, wide_open, n, 1.0).along


_GRID_POINTS = 256
# A distribution narrower than this share of its mean falls between the points of a grid even in ln u.
_NARROW_SHARE = 0.25
# Lengths of flight are treated so many at a time: arrays stay in the processor's cache.
_BATCH = 8


def effective_gap(
    loss: LostArea, rms_height: float, n: float, aspect: float | FloatArray = 1.0, *, refinement: float = 1.0
) -> FloatArray:
    """u_eff of Bruggeman's effective medium over P(u), shape (P,) [m].

    See `leak.flow.medium.effective_medium` and, for inclusions of an aspect other than one, one number or shape (P,),
    `leak.flow.medium.anisotropic_medium`.

    References
    ----------
    B. Lorenz, B. N. J. Persson, Eur. Phys. J. E 31, 159 (2010); W. B. Dapp et al., Phys. Rev. Lett. 108, 244301
    (2012).
    """
    return anisotropic_medium(*_gaps(loss, rms_height, refinement), n, aspect).along


def effective_gaps(
    loss: LostArea,
    rms_height: float,
    n: float,
    aspect: float | FloatArray,
    inverse_knudsen: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """`effective_gap`, shape (P,), and of a rarefied gas at given D = u_eff/l, of shape (m,), shape (P, m) [m].

    The latter is the uniform gap that would let as much through without rarefaction: the effective medium over the
    local conductivity u^3 f(u/l), f of `leak.flow.rarefied.flow_factor`, at lengths of flight l = eta v0/p_f.
    """
    gaps = _gaps(loss, rms_height, 1.0)
    continuum = anisotropic_medium(*gaps, n, aspect)
    flight = np.maximum(continuum.along, gaps.separation[:, 0])[:, None] / inverse_knudsen
    # about as much is let through as through the gap of the continuum alone, and as much more along as across
    along, across = (np.log(np.maximum(gap, gaps.separation[:, 0])) for gap in continuum)
    result = np.empty(flight.shape)
    for start in range(0, flight.shape[1], _BATCH):
        log_flight = np.log(flight[:, start : start + _BATCH])
        rows, lengths = log_flight.shape

        def wider(log_gap: FloatArray, log_flight: FloatArray = log_flight) -> FloatArray:
            by_flight = log_flight.reshape(*log_flight.shape, *(1,) * (log_gap.ndim - 1))
            log_gap = log_gap[:, None]
            return (log_gap + log_flow_factor(log_gap - by_flight) / 3.0).reshape(-1, *log_gap.shape[2:])

        about = wider(along)
        medium = _Medium.of(
            wider(np.log(gaps.separation)),
            gaps.weight.repeat(lengths, axis=0),
            gaps.contact.repeat(lengths),
            gaps.wide_open.repeat(lengths),
        )
        gas_gaps = medium.gaps(
            n,
            aspect.repeat(lengths) if isinstance(aspect, np.ndarray) else aspect,
            DirectionalGap(np.exp(about), np.exp(about + (across - along).repeat(lengths))),
        )
        result[:, start : start + lengths] = gas_gaps.along.reshape(rows, lengths)
    return continuum.along, result


class _Gaps(NamedTuple):
    """P(u) on a grid: arrays (pressures, separations), and the shares without a separation (pressures,)."""

    separation: FloatArray
    weight: FloatArray
    contact: FloatArray
    wide_open: FloatArray


def _gaps(loss: LostArea, rms_height: float, refinement: float) -> _Gaps:
    height = _grid_height(loss, rms_height)
    grid = SeparationGrid.of(loss.mean_separation, height, count=round(_GRID_POINTS * refinement))
    weight = density(loss, grid.separation) * grid.weight
    # What the grid misses is wide open above it; below it is too narrow to matter and counts as contact.
    wide_open = folded_above(loss, grid.separation[:, -1])
    contact = np.maximum(1.0 - weight.sum(axis=1) - wide_open, 0.0)
    return _Gaps(grid.separation, weight, contact, wide_open)


def _grid_height(loss: LostArea, rms_height: float) -> FloatArray:
    """Height that decides where the grid is fine, shape (P,) [m].

    The rms height of the whole spectrum, but where little of it is left after plastic smoothing, twice the spread of
    P(u): steps of the grid that are small against the former would not see so narrow a distribution.
    """
    share = np.maximum(loss.weight.sum(axis=1), 1e-300)
    mean = loss.mean_separation
    second = (loss.weight * (loss.separation**2 + loss.width**2)).sum(axis=1) / share
    std = np.sqrt(np.maximum(second - (mean / share) ** 2, 0.0))
    is_narrow = (std > 0.0) & (std < _NARROW_SHARE * np.minimum(mean, rms_height))
    return np.where(is_narrow, 2.0 * std, rms_height)


def critical_gap(
    spectrum: PowerSpectrum,
    roughness: Roughness,
    relative_pressure: FloatArray,
    gamma: float,
    percolation_threshold: float,
) -> FloatArray:
    """u_c = u1 where A(zeta_c)/A0 is the percolation threshold, shape (P,) [m]; zero where no zeta reaches it.

    References
    ----------
    Fischer et al., "Fluid leakage in metallic seals", eq. (12) and the text above it.
    """
    target = relative_pressure**2 / (np.pi * area_argument_at(percolation_threshold) ** 2)
    total = moment_of_all(roughness, target.size)
    M = _elastic_moment(roughness, np.minimum(target, total))
    junction = separations(spectrum, roughness, relative_pressure, M[:, None], gamma, refinement=2)
    return np.where(target < total, junction.lost_separation[:, 0], 0.0)


def area_argument_at(relative_area: float) -> float:
    """z with erf(z) = A/A0."""
    from scipy.special import erfinv

    return float(erfinv(relative_area))


def _elastic_moment(roughness: Roughness, moment: FloatArray) -> FloatArray:
    """Elastic moment M at which the remaining moment has a given value, by bisection in ln M (it rises with M)."""
    if not roughness.kappa:
        return moment
    ends = np.log(moment), np.full(moment.shape, np.log(roughness.end))
    low, high = bisect_roots(lambda log_M: roughness.moment(np.exp(log_M)[:, None])[:, 0] < moment, *ends)
    # the exponential of a logarithm may lie above the end by a rounding, where there is no spectrum
    return np.minimum(np.exp(0.5 * (low + high)), roughness.end)


def folded_above(loss: LostArea, u: FloatArray) -> FloatArray:
    """Area with a separation above u, shape (P,)."""
    from scipy.special import erfc

    scale = np.sqrt(0.5) / loss.width
    shares = 0.5 * (
        erfc((u[:, None] - loss.separation) * scale) + erfc((u[:, None] + loss.separation) * scale)
    )
    return (loss.weight * shares).sum(axis=1)


# Fitted to half of the direct results: how much more of endless ridges touches where little does. The fit gives an
# exponent of the aspect of 1 + 1.05 sqrt(A/(A0 a_c)).
_MORE_CONTACT = 0.35


def inclusion_aspect(peklenik: float, share: ArrayLike) -> FloatArray:
    """Length along x over that along y of the inclusions of the effective medium.

    gamma^(1 + sqrt(A/(A0 a_c))). Without contact they are as long as the roughness, for which Tripp's result is exact;
    patches of contact are longer: gamma^(4/3), like ellipses of Hertz, at A/A0 = 0.05, gamma^2 where they percolate.

    Parameters
    ----------
    peklenik : float
        gamma_T of the heights [-].
    share : array_like
        Contact area over that at which no path is open, A/(A0 a_c), 0 to 1 [-].

    Examples
    --------
    >>> [round(float(aspect), 2) for aspect in inclusion_aspect(5.0, [0.0, 0.1, 1.0])]
    [5.0, 8.32, 25.0]
    """
    return np.asarray(float(peklenik) ** (1.0 + np.sqrt(np.clip(share, 0.0, 1.0))))


def touching_pressure(peklenik: float, share: ArrayLike) -> FloatArray:
    """Factor on the pressure at which an isotropic surface of the same spectrum touches as much as a stretched one.

    1 + 0.35 ((gamma - 1)/(gamma + 1))^2 [1 - (A/(A0 a_c))^2]: long patches carry less pressure. It falls to one where
    no path is open, so that the theory's sealing pressure does not depend on the lay, and p times it rises with p.

    Parameters
    ----------
    peklenik, share
        See `inclusion_aspect`.

    Examples
    --------
    >>> [round(float(factor), 3) for factor in touching_pressure(0.2, [0.0, 0.5, 1.0])]
    [1.156, 1.117, 1.0]
    """
    return np.asarray(1.0 + _MORE_CONTACT * _stretch(peklenik) * (1.0 - np.clip(share, 0.0, 1.0) ** 2))


def touching_pressure_at_equal_gap(peklenik: float, share: ArrayLike) -> FloatArray:
    """`touching_pressure` where the mean gap is that of `leak.theory.interface_law`.

    1 + 1.4 ((gamma - 1)/(gamma + 1))^2 s (1 - s), s = A/(A0 a_c): the same height at the middle, and one where little
    touches, where the gap is that of the heights, which know no lay.

    Parameters
    ----------
    peklenik, share
        See `inclusion_aspect`.

    Examples
    --------
    >>> [round(float(factor), 3) for factor in touching_pressure_at_equal_gap(0.2, [0.0, 0.5, 1.0])]
    [1.0, 1.156, 1.0]
    """
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(1.0 + 4.0 * _MORE_CONTACT * _stretch(peklenik) * s * (1.0 - s))


def _stretch(peklenik: float) -> float:
    return ((peklenik - 1.0) / (peklenik + 1.0)) ** 2


# g in dG -> [g + (1 - g) A^2] dG: at small pressure the area is 1/sqrt(g) times Persson's.
_G = 5.0 / 9.0
# Prefactor and exponent of the closed law: fitted to the sets A512, A and B of direct results, and judged by others
# (docs/verification/verification.md).
_PREFACTOR, _EXPONENT = 0.80, 2.85
# Corrected A/A0 over which the effective medium goes over into the closed law.
_FROM, _TO = 0.15, 0.25
# ln of the most that the closed law may lie above the effective medium. Direct results reach a factor 3; where the
# waves span three decades it would be 50, and going over into it would rise with the pressure.
_MOST_ABOVE = np.log(5.0)
# ln of the variance G/p^2 over which the corrected one is tabulated: full contact below, proportional above.
_TABLE = np.linspace(-5.0, 25.0, 601)


def corrected_area(argument: ArrayLike) -> FloatArray:
    """A/A0 with the stress variance broadened by less where little touches.

    Parameters
    ----------
    argument : array_like
        z = p/(2 sqrt(G)) of `leak.theory.persson.area_argument`, not negative [-].

    Notes
    -----
    A/A0 = erf(p/(2 sqrt(G'))) with dG' = [g + (1 - g) (A/A0)^2] dG and g = 5/9. With G in units of p^2 it is one curve
    for all surfaces, erf(z) at full contact and erf(z/sqrt(g)) where little touches.

    References
    ----------
    A. Wang, M. H. Mueser, Tribol. Lett. 69, 1 (2021), arXiv:2010.13470.

    Examples
    --------
    >>> [round(float(area), 3) for area in corrected_area([0.01, 0.3, 3.0])]
    [0.015, 0.386, 1.0]
    """
    from scipy.special import erf

    z = np.maximum(np.asarray(argument, dtype=float), 1e-150)
    with np.errstate(over="ignore"):
        log_variance = -np.log(4.0) - 2.0 * np.log(z)
    return np.asarray(erf(0.5 * np.exp(-0.5 * _variance().value(log_variance))))


def argument_at(area: float) -> float:
    """z at which the corrected A/A0 has a value between 0 and 1 [-]."""
    from scipy.special import erfinv

    log_variance = -np.log(4.0) - 2.0 * np.log(float(erfinv(area)))
    return float(0.5 * np.exp(-0.5 * _variance().inverse(np.asarray(log_variance))))


@lru_cache(maxsize=1)
def _variance() -> MonotoneCurve:
    """ln(G'/p^2) over ln(G/p^2)."""
    nodes, weight = gauss_panels(_TABLE, 6)
    cells = (weight * np.exp(nodes) / _broaden_variance(nodes)).sum(axis=1)
    G = np.exp(_TABLE[0]) + np.concatenate([[0.0], np.cumsum(cells)])
    return MonotoneCurve(np.log(G), _TABLE, G * _broaden_variance(_TABLE) * np.exp(-_TABLE))


def _broaden_variance(log_variance: FloatArray) -> FloatArray:
    """dG'/dG at ln(G'/p^2)."""
    from scipy.special import erf

    return _G + (1.0 - _G) * erf(0.5 * np.exp(-0.5 * log_variance)) ** 2


def closed_share(area: ArrayLike) -> FloatArray:
    """Weight of the closed law beside the effective medium at a corrected A/A0: 0 to 0.15, 1 from 0.25 on."""
    t = np.clip((np.asarray(area, dtype=float) - _FROM) / (_TO - _FROM), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def near_threshold(
    effective: FloatArray, mean_separation: FloatArray, area: FloatArray, percolation_threshold: float
) -> FloatArray:
    """u_eff of the effective medium that goes over into the closed law, shape (P,) [m].

    u_eff^3 = 0.80 ubar^3 (1 - A/(A0 a_c))^2.85 with the corrected area from A/A0 = 0.25 on, the effective medium to
    0.15, and between them ln u_eff with a smooth weight.

    Parameters
    ----------
    effective : ndarray
        u_eff of the effective medium, shape (P,) [m].
    mean_separation : ndarray
        ubar, shape (P,) [m].
    area : ndarray
        A/A0, shape (P,) [-].
    percolation_threshold : float
        a_c [-].
    """
    open_share = np.maximum(1.0 - area / percolation_threshold, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_closed = (np.log(_PREFACTOR) + _EXPONENT * np.log(open_share)) / 3.0 + np.log(mean_separation)
        log_ratio = 3.0 * (log_closed - np.log(effective))
        log_limited = np.where(log_ratio > 0.0, _MOST_ABOVE * np.tanh(log_ratio / _MOST_ABOVE), log_ratio)
        u = effective * np.exp(closed_share(area) * log_limited / 3.0)
    return np.where(open_share > 0.0, u, 0.0)
