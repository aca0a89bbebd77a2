"""P(u), the probability distribution of interfacial separations, from the area lost at each magnification."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from leak.arrays import LARGEST_LOG, FloatArray, IntArray
from leak.numerics.integrals import gauss, integrals_up_to_nodes
from leak.surfaces.spectrum import PowerSpectrum
from leak.theory.persson import FULL_CONTACT, area_argument, moment_of_all, separations
from leak.theory.plasticity import Roughness

# The first magnifications are taken in ln M, so that any small pressure is resolved: up to this step in ln q from
# q_low, this fraction of the whole moment, and before anything yields.
_FIRST_STEP, _FIRST_FRACTION, _FIRST_YIELD = 0.05, 0.01, 0.01
# ln M over which contact is followed there: the area left at its end is exp(-19), whatever the pressure.
# Short panels come first, where A falls from one like erf.
_FIRST_RANGE = 38.0
_FIRST_PANELS = np.array([3.0, 4.0, 6.0, 9.0, 16.0]) / 38.0
_FIRST_NODES = 5
# Panels elsewhere are at most this long in `_detail`, with about this many Gauss points per unit length.
_PANEL, _PANEL_POINTS = 1.3, 4.6
# Steps in ln M, and as many in ln q, between neighbouring kinks, over which the detail is looked at.
_FINE = 128
# Magnifications between neighbouring kinks are treated at once up to about so many nodes: a call costs more than a few.
_GROUP = 30
_SMALLEST_WIDTH = 1e-12
# Area so small that no value of P(u) that matters notices it.
_LEAST_WEIGHT = 1e-13
# Magnifications whose Gaussians are added up together, and how many sqrt(2) widths from its centre one is followed: to
# 1e-16 of its height.
_NEIGHBOURS, _REACH = 48, 6.07


class MagnificationNodes(NamedTuple):
    """Gauss points over magnification; arrays (pressures, magnifications)."""

    M: FloatArray
    """Elastic slope moment [-]."""
    wavenumber: FloatArray
    """zeta q0 [1/m]."""
    moment_weight: FloatArray
    """Weight of int dM [-]."""
    groups: tuple[slice, ...]
    """Magnifications between the same kinks of the spectrum, or few nodes between several."""
    to_end: FloatArray
    """Matrix that takes weighted values at the nodes to their integral from each node to the end."""


class LostArea(NamedTuple):
    """Where contact is lost: the ingredients of P(u), arrays (pressures, magnifications)."""

    weight: FloatArray
    """Nominal area lost at each node, da = -A'(zeta) dzeta/A0 [-]."""
    separation: FloatArray
    """u1 [m]."""
    width: FloatArray
    """Width h of the Gaussian around it [m]."""
    contact: FloatArray
    """Area still in contact at full magnification A(zeta_1)/A0, shape (pressures,) [-]."""

    @property
    def mean_separation(self) -> FloatArray:
        """int u1 da: the mean separation to some 2 %, shape (pressures,) [m]; it says where P(u) is wanted."""
        return (self.weight * self.separation).sum(axis=1)


def magnification_nodes(
    spectrum: PowerSpectrum, roughness: Roughness, relative_pressure: FloatArray, *, refinement: float = 1.0
) -> MagnificationNodes:
    """Quadrature over magnification, from where the first contact is lost to where the last is."""
    first, upper = _panels(spectrum, roughness.last_loss, roughness.kappa, refinement)
    # For pressures whose first loss lies above the first panel, the range of the p-dependent nodes is empty.
    top = np.log(first)
    bottom = np.minimum(2.0 * np.log(relative_pressure) - np.log(np.pi * FULL_CONTACT**2), top)
    length = np.minimum(top - bottom, _FIRST_RANGE)
    t, w = gauss(round(_FIRST_NODES * refinement))
    start = np.cumsum(_FIRST_PANELS) - _FIRST_PANELS
    u = (start[:, None] + 0.5 * _FIRST_PANELS[:, None] * (1.0 + t)).ravel()
    M = np.exp(bottom[:, None] + length[:, None] * u)
    weight = M * length[:, None] * (0.5 * _FIRST_PANELS[:, None] * w).ravel()
    q = np.exp(spectrum.at_slope_moment(M).log_wavenumber)

    def join(lower: FloatArray, upper: FloatArray) -> FloatArray:
        return np.concatenate([lower, np.broadcast_to(upper, (M.shape[0], upper.size))], axis=1)

    count = u.size
    groups = (slice(0, count), *(slice(g.start + count, g.stop + count) for g in upper.groups))
    return MagnificationNodes(
        join(M, upper.M), join(q, upper.wavenumber), join(weight, upper.moment_weight), groups, upper.to_end
    )


@lru_cache(maxsize=16)
def _panels(
    spectrum: PowerSpectrum, end: float, kappa: float, refinement: float
) -> tuple[float, MagnificationNodes]:
    """Where the first magnifications end, and nodes from there to `end`, split at kinks: the same at every pressure."""
    breaks = spectrum.break_moments
    first = min(
        float(spectrum.slope_moment(spectrum.q_low * np.exp(_FIRST_STEP))),
        _FIRST_FRACTION * float(min(end, breaks[1])),
        _FIRST_YIELD / kappa if kappa else np.inf,
    )
    stops = np.concatenate([[first], breaks[(breaks > first) & (breaks < end)], [end]])
    ends, detail, count = _panel_ends(spectrum, stops, kappa)
    sizes = np.ceil(refinement * np.ceil(1.6 + _PANEL_POINTS * detail)).astype(np.intp).repeat(count)
    M, q, weight = _panel_nodes(spectrum, ends, sizes)
    groups: list[slice] = []
    for stop in sizes.cumsum()[count.cumsum() - 1].tolist():
        start = groups[-1].stop if groups else 0
        if groups and groups[-1].stop - groups[-1].start < _GROUP:
            start = groups.pop().start
        groups.append(slice(start, stop))
    to_end = _integral_to_end(
        [round(_FIRST_NODES * refinement)] * _FIRST_PANELS.size + sizes.tolist() if kappa else []
    )
    return first, MagnificationNodes(M, q, weight, tuple(groups), to_end)


def _panel_ends(
    spectrum: PowerSpectrum, stops: FloatArray, kappa: float
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Ends in M of panels of equal detail between neighbouring stops; between which, that detail and their number."""
    share = np.arange(_FINE + 1) / _FINE
    low, high = stops[:-1, None], stops[1:, None]
    log_q = spectrum.at_slope_moment(stops).log_wavenumber
    even_in_M, even_in_q = (
        np.exp(ends[:-1, None] + share * (ends[1:] - ends[:-1])[:, None]) for ends in (np.log(stops), log_q)
    )
    fine = np.concatenate([low, even_in_M[:, 1:-1], spectrum.slope_moment(even_in_q[:, 1:-1]), high], axis=1)
    fine = np.sort(np.minimum(np.maximum(fine, low), high), axis=1)
    detail = _detail(spectrum, fine, kappa)
    rise = detail[:, -1] - detail[:, 0]
    count = np.maximum(np.ceil(rise / _PANEL), 1.0).astype(np.intp)
    size = rise / count
    of = np.arange(count.size).repeat(count)
    nth = np.arange(of.size) - (count.cumsum() - count)[of]
    ends = np.interp(detail[of, 0] + nth * size[of], detail.ravel(), fine.ravel())
    ends[nth == 0] = stops[:-1]
    return np.append(ends, stops[-1]), size, count


def _detail(spectrum: PowerSpectrum, M: FloatArray, kappa: float) -> FloatArray:
    """How many e-folds things change by up to M: wavenumber, area, what remains to the end, plastic smoothing."""
    to_end = 1.0 - M / float(spectrum.break_moments[-1])
    detail = spectrum.at_slope_moment(M).log_wavenumber + 0.5 * np.log(M) - np.log(to_end + 0.001)
    if kappa:
        t = kappa * M
        # C_pl falls like exp(-pi^2 t) once yielding has begun at t = 0.02 or so.
        yielding = np.log(np.minimum(np.maximum(t / 0.02, 1.0), 85.0))
        detail = detail + yielding + 0.6 * np.pi**2 * np.minimum(t, 1.7)
    return detail


def _panel_nodes(
    spectrum: PowerSpectrum, ends: FloatArray, sizes: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """M, q and weights of int dM of panels between neighbouring ends: in ln M close to q_low, in ln q elsewhere."""
    log_M, log_q = np.log(ends), spectrum.at_slope_moment(ends).log_wavenumber
    length_M, length_q = log_M[1:] - log_M[:-1], log_q[1:] - log_q[:-1]
    in_M = length_M > 6.0 * length_q
    start, half = np.where(in_M, log_M[:-1], log_q[:-1]), 0.5 * np.where(in_M, length_M, length_q)
    t, w = np.concatenate([gauss(size) for size in sizes.tolist()], axis=1)
    of = np.arange(sizes.size).repeat(sizes)
    in_M, half = in_M[of], half[of]
    node = np.exp(start[of] + half * (1.0 + t))
    M = np.minimum(np.maximum(spectrum.slope_moment(node), ends[of]), ends[of + 1])
    M = np.where(in_M, node, M)
    point = spectrum.at_slope_moment(M)
    q = np.where(in_M, np.exp(point.log_wavenumber), node)
    return M, q, np.where(in_M, M, q**4 * np.exp(point.log_density)) * half * w


def _integral_to_end(sizes: list[int]) -> FloatArray:
    """Matrix of spectral integration from each node to the end, panel by panel."""
    panel = np.arange(len(sizes)).repeat(sizes)
    matrix = (panel[:, None] < panel).astype(float)
    start = 0
    for size in sizes:
        matrix[start : start + size, start : start + size] = 1.0 - integrals_up_to_nodes(size)
        start += size
    return matrix


def lost_area(
    spectrum: PowerSpectrum,
    roughness: Roughness,
    relative_pressure: FloatArray,
    gamma: float,
    separation_width: str,
    *,
    refinement: float = 1.0,
) -> LostArea:
    """Area lost, u1 and Gaussian width over all magnifications.

    The width is h_rms(zeta) = (2 pi int_{q > zeta q0} q C dq)^(1/2) for "plain" (Lorenz & Persson, Eur. Phys. J. E
    31, 159 (2010)) and 1/h^2 = 1/h_rms^2(zeta) + 1/u1^2 for "effective" (Dapp et al., Phys. Rev. Lett. 108, 244301
    (2012)).
    """
    nodes = magnification_nodes(spectrum, roughness, relative_pressure, refinement=refinement)
    factor, moment = roughness.factor(nodes.M), roughness.moment(nodes.M)
    z = area_argument(relative_pressure[:, None], moment)
    fall = np.where(z < FULL_CONTACT, z * np.exp(-(np.minimum(z, FULL_CONTACT) ** 2)), 0.0)
    weight = nodes.moment_weight * factor * fall / (np.sqrt(np.pi) * moment)
    u1 = np.zeros(weight.shape)
    for group in nodes.groups:
        # at high pressures nothing is lost at low magnification
        rows = np.flatnonzero((weight[:, group] > _LEAST_WEIGHT).any(axis=1))
        if rows.size:
            p, M = relative_pressure[rows], nodes.M[rows, group]
            at_rows = separations(spectrum, roughness.at_some(rows), p, M, gamma, refinement=refinement)
            u1[rows, group] = at_rows.lost_separation
    variance = _height_variance_above(spectrum, nodes, factor)
    if separation_width == "effective":
        variance = variance * u1**2 / np.maximum(variance + u1**2, 1e-300)
    from scipy.special import erf

    # At the end of the spectrum u1 and h vanish together; the floor keeps the Gaussian a function.
    width = np.maximum(np.sqrt(variance), _SMALLEST_WIDTH * spectrum.rms_height)
    return LostArea(
        weight, u1, width, erf(area_argument(relative_pressure, moment_of_all(roughness, len(weight))))
    )


def _height_variance_above(
    spectrum: PowerSpectrum, nodes: MagnificationNodes, factor: FloatArray
) -> FloatArray:
    """2 pi int_{q > zeta q0} q C dq of the roughness that remains, dM = q^3 C dq."""
    if factor.min() == 1.0:
        return spectrum.height_variance_above(nodes.wavenumber)
    rate = 2.0 * np.pi * nodes.moment_weight * factor / nodes.wavenumber**2
    return np.maximum(rate @ nodes.to_end.T, 0.0)


def density(loss: LostArea, separation: FloatArray) -> FloatArray:
    """P(u) without its delta at contact.

    P(u) = int da (2 pi h^2)^(-1/2) [exp(-(u-u1)^2/2h^2) + exp(-(u+u1)^2/2h^2)].

    Parameters
    ----------
    loss : LostArea
        Where contact is lost, arrays (P, Z).
    separation : ndarray
        u >= 0, increasing, shape (P, U) or (1, U) [m].

    Returns
    -------
    ndarray
        P(u), shape (P, U) [1/m].

    References
    ----------
    A. Almqvist et al., J. Mech. Phys. Solids 59, 2355 (2011).
    """
    inverse = np.sqrt(0.5) / loss.width
    counts = loss.weight > _LEAST_WEIGHT
    amplitude = np.where(counts, loss.weight * inverse * np.sqrt(1.0 / np.pi), 0.0)
    centre, reach = loss.separation * inverse, _REACH / inverse
    # Gaussians of neighbouring magnifications lie close to each other: where none of them is, nothing is added up.
    starts = np.arange(0, counts.shape[1], _NEIGHBOURS)
    lowest = np.minimum.reduceat(np.where(counts, loss.separation - reach, np.inf), starts, axis=1)
    highest, mirror_end = (
        np.maximum.reduceat(np.where(counts, reach + sign * loss.separation, -np.inf), starts, axis=1)
        for sign in (1.0, -1.0)
    )
    values = np.zeros((counts.shape[0], separation.shape[1]))
    for k, (u, row) in enumerate(zip(np.broadcast_to(separation, values.shape), values, strict=True)):
        places = (u.searchsorted(ends[k]).tolist() for ends in (lowest, highest, mirror_end))
        for start, first, last, count in zip(starts.tolist(), *places, strict=True):
            block = k, slice(start, start + _NEIGHBOURS)
            if last > first:
                row[first:last] += (
                    _gaussian(u[first:last, None] * inverse[block] - centre[block]) @ amplitude[block]
                )
            if count:
                row[:count] += _gaussian(u[:count, None] * inverse[block] + centre[block]) @ amplitude[block]
    return values


def _gaussian(x: FloatArray) -> FloatArray:
    """exp(-x^2); numbers that are next to none are slow."""
    return np.exp(-np.minimum(x * x, LARGEST_LOG))


@dataclass(frozen=True)
class SeparationGrid:
    """Points u for integrals over P(u), shape (P, U): even in ln u near zero, even in u above h_rms."""

    separation: FloatArray
    """u [m]."""
    weight: FloatArray
    """Trapezoidal weight of int du [m]."""

    @classmethod
    def of(cls, mean: FloatArray, rms_height: float | FloatArray, *, count: int) -> SeparationGrid:
        """Grid that covers distributions of mean separation `mean`, shape (P,), on a roughness of `rms_height` [m].

        Mass outside counts as contact below and as wide open above. Below mean - 14 h there is
        less than exp(-20) of it, because area is lost at a rate of one decay length (about h/2) per e-fold.
        """
        L = 0.5 * np.broadcast_to(rms_height, mean.shape)
        lower = np.maximum(_soft_inverse(np.maximum(mean - 14.0 * rms_height, 0.0) / L), -22.0)
        upper = _soft_inverse((mean + 9.0 * rms_height) / L)
        step = (upper - lower) / (count - 1)
        x = lower[:, None] + step[:, None] * np.arange(count)
        return cls(L[:, None] * np.logaddexp(0.0, x), (L * step)[:, None] / (1.0 + np.exp(-x)))


def _soft_inverse(y: FloatArray) -> FloatArray:
    """x with ln(1 + e^x) = y."""
    with np.errstate(divide="ignore"):
        return y + np.log(-np.expm1(-y))
