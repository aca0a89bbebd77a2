"""Effective media: flow through a gap of random height, with and without a preferred direction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ConductivityError

# ln u_eff^3 may lie this far outside the separations given; what comes as close to the lower end of that is sealed.
_BELOW_ALL, _SEALED = 60.0, 0.6
_INNER_STEPS, _OUTER_STEPS = 120, 60
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
    return directional_medium_of_logarithms(np.log(separation), weight, contact, wide_open, n, peklenik, near)


def directional_medium_of_logarithms(
    log_separation: FloatArray,
    weight: FloatArray,
    contact: FloatArray,
    wide_open: FloatArray,
    n: float,
    peklenik: float | FloatArray,
    near: DirectionalGap | None = None,
) -> DirectionalGap:
    """`anisotropic_medium` of ln u.

    Parameters
    ----------
    log_separation : ndarray
        ln(u/m), increasing along the last axis, shape (P, U).
    weight, contact, wide_open, n, peklenik, near
        See `anisotropic_medium`.
    """
    gamma = np.asarray(peklenik, dtype=float)
    if np.any(gamma < 1.0):
        if np.any(gamma > 1.0):
            raise ConductivityError(f"peklenik = {peklenik}: must lie on one side of 1 at all pressures [-]")
        turned = None if near is None else DirectionalGap(near.across, near.along)
        across, along = directional_medium_of_logarithms(
            log_separation, weight, contact, wide_open, n, 1.0 / gamma, turned
        )
        return DirectionalGap(along, across)
    medium, k, log_gamma = _Medium.of(log_separation, weight, contact, wide_open), n - 1.0, np.log(gamma)
    if np.all(gamma == 1.0):
        guess = medium.middle if near is None else 3.0 * np.log(near.along) - medium.log_unit
        log_s, _ = medium.solve(np.full(contact.shape, k), guess)
        percolated = weight.sum(axis=-1) + wide_open <= contact / k
        same = np.where(percolated | (log_s < medium.lowest + _SEALED), 0.0, medium.gap(log_s))
        return DirectionalGap(same, same)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # s_y is positive below this ln m, s_x above its negative; no room between them is percolation.
        room = np.log(k * (weight.sum(axis=-1) + wide_open) / contact)
    low, high = np.zeros(contact.shape), np.clip(room, 0.0, log_gamma)
    if near is None:
        log_m = 0.5 * high
        isotropic, rise = medium.solve(np.full(contact.shape, k), medium.middle)
        x, y = isotropic + rise * log_m, isotropic - rise * log_m
    else:
        x, y = (3.0 * np.log(gap) - medium.log_unit for gap in near)
        log_m = log_gamma + 0.5 * (y - x)
        log_m = np.where((log_m > low) & (log_m < high), log_m, 0.5 * high)
    close = _FIRST_CLOSE
    for _ in range(_OUTER_STEPS):
        # s_x and s_y as well as the step of ln m deserves: in the end all three take one step of Newton's method each
        x, rise_x = medium.solve(k * np.exp(log_m), x, close)
        y, rise_y = medium.solve(k * np.exp(-log_m), y, close)
        excess = log_m - log_gamma - 0.5 * (y - x)
        low, high = np.where(excess < -close, log_m, low), np.where(excess > close, log_m, high)
        newton = log_m - excess / (1.0 + 0.5 * (rise_x + rise_y))
        following = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
        step, log_m = following - log_m, following
        step_x, step_y = rise_x * step, -rise_y * step
        x, y = x + step_x, y + step_y
        largest = float(np.abs([step, step_x, step_y]).max())
        if max(largest, close) <= _CLOSE:
            break
        close = min(max(_WORTH * largest, _CLOSE), _FIRST_CLOSE)
    sealed = ~(room > 0.0)
    return DirectionalGap(
        *(np.where(sealed | (s < medium.lowest + _SEALED), 0.0, medium.gap(s)) for s in (x, y))
    )


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

    flowing: FloatArray
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

    def solve(self, k: FloatArray, guess: FloatArray, close: float = _CLOSE) -> tuple[FloatArray, FloatArray]:
        """Root ln s of int P (sigma - s)/(sigma + k s) = 0, and its derivative with respect to ln k.

        With B = int P sigma/(sigma + k s) and A = int P k s/(sigma + k s) the balance is A/B = target. The logarithm of
        A/B rises with ln s, by exactly ln s for a single sigma and never faster: Newton's method needs a few steps from
        anywhere, the last of which is shorter than `close`. Where the contact has percolated the root is the lower end.
        """
        low, high, weight, flowing = self.lowest, self.highest, self.weight, self.flowing
        all_weight = weight.sum(axis=-1)
        most, beyond = k * (all_weight + self.wide_open), k * self.wide_open
        passing, rest = most - self.contact, np.maximum(all_weight + self.contact - beyond, 1e-300)
        open_row = passing > 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            target = np.log(passing / rest)
            guess = np.where(open_row, np.minimum(np.maximum(guess, low), high), low)
            for _ in range(_INNER_STEPS):
                ks = k * np.exp(guess)
                inverse = self.sigma + ks[:, None]
                np.reciprocal(inverse, out=inverse)
                A, B = ks * np.vecdot(weight, inverse), np.vecdot(flowing, inverse)
                X = ks * np.vecdot(flowing, np.square(inverse, out=inverse))
                excess, slope = np.log(A / B) - target, X * (1.0 / A + 1.0 / B)
                newton = guess - excess / slope
                low, high = np.where(excess < 0.0, guess, low), np.where(excess < 0.0, high, guess)
                following = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
                following = np.where(open_row, following, guess)
                moved = np.abs(following - guess).max()
                guess = following
                if moved <= close:
                    break
            # the logarithm of A/B rises with ln k as with ln s, the target by this
            by_log_k = most / passing + beyond / rest
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
    separation: FloatArray,
    weight: FloatArray,
    contact: FloatArray,
    wide_open: FloatArray,
    n: float,
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
