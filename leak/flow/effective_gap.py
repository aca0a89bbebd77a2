"""The two equivalent gaps of a rough interface: of the effective medium, and at the critical junction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.flow.medium import DirectionalGap, anisotropic_medium, directional_medium_of_logarithms
from leak.flow.rarefied import log_flow_factor
from leak.numerics.roots import bisected
from leak.surfaces.spectrum import PowerSpectrum
from leak.theory.persson import ElasticRoughness, RoughnessSeen, moment_of_all, separations
from leak.theory.separation import LostArea, SeparationGrid, density

_GRID_POINTS = 256
# A distribution narrower than this share of its mean falls between the points of a grid even in ln u.
_NARROW = 0.25
# Lengths of flight are treated so many at a time: arrays stay in the processor's cache.
_TOGETHER = 8


def effective_gap(
    lost: LostArea,
    rms_height: float,
    n: float,
    aspect: float | FloatArray = 1.0,
    *,
    refinement: float = 1.0,
) -> FloatArray:
    """u_eff of Bruggeman's effective medium over P(u), shape (P,) [m].

    See `leak.flow.medium.effective_medium` and, for inclusions of an aspect other than one, one number or shape (P,),
    `leak.flow.medium.anisotropic_medium`.

    References
    ----------
    B. Lorenz, B. N. J. Persson, Eur. Phys. J. E 31, 159 (2010); W. B. Dapp et al., Phys. Rev. Lett. 108, 244301
    (2012).
    """
    return anisotropic_medium(*_gaps(lost, rms_height, refinement), n, aspect).along


def effective_gaps(
    lost: LostArea,
    rms_height: float,
    n: float,
    aspect: float | FloatArray,
    inverse_knudsen: FloatArray,
    *,
    refinement: float = 1.0,
) -> tuple[FloatArray, FloatArray]:
    """`effective_gap`, shape (P,), and of a rarefied gas at given D = u_eff/l, of shape (m,), shape (P, m) [m].

    The latter is the uniform gap that would let as much through without rarefaction: the effective medium over the
    local conductivity u^3 f(u/l), f of `leak.flow.rarefied.flow_factor`, at lengths of flight l = eta v0/p_f.
    """
    gaps = _gaps(lost, rms_height, refinement)
    continuum = anisotropic_medium(*gaps, n, aspect)
    flight = np.maximum(continuum.along, gaps.separation[:, 0])[:, None] / inverse_knudsen
    return continuum.along, _gas_gap(gaps, continuum, n, aspect, flight)


def _gas_gap(
    gaps: _Gaps, continuum: DirectionalGap, n: float, aspect: float | FloatArray, flight: FloatArray
) -> FloatArray:
    log_u = np.log(gaps.separation)
    # about as much is let through as through the gap of the continuum alone, and as much more along as across
    along, across = (np.log(np.maximum(gap, gaps.separation[:, 0])) for gap in continuum)
    out = np.empty(flight.shape)
    for start in range(0, flight.shape[1], _TOGETHER):
        log_flight = np.log(flight[:, start : start + _TOGETHER])
        rows, lengths = log_flight.shape

        def wider(log_gap: FloatArray, log_flight: FloatArray = log_flight) -> FloatArray:
            by_flight = log_flight.reshape(*log_flight.shape, *(1,) * (log_gap.ndim - 1))
            log_gap = log_gap[:, None]
            return (log_gap + log_flow_factor(log_gap - by_flight) / 3.0).reshape(-1, *log_gap.shape[2:])

        about = wider(along)
        found = directional_medium_of_logarithms(
            wider(log_u),
            gaps.weight.repeat(lengths, axis=0),
            gaps.contact.repeat(lengths),
            gaps.wide_open.repeat(lengths),
            n,
            aspect.repeat(lengths) if isinstance(aspect, np.ndarray) else aspect,
            DirectionalGap(np.exp(about), np.exp(about + (across - along).repeat(lengths))),
        )
        out[:, start : start + lengths] = found.along.reshape(rows, lengths)
    return out


class _Gaps(NamedTuple):
    """P(u) on a grid: arrays (pressures, separations), and the shares without a separation (pressures,)."""

    separation: FloatArray
    weight: FloatArray
    contact: FloatArray
    wide_open: FloatArray


def _gaps(lost: LostArea, rms_height: float, refinement: float) -> _Gaps:
    height = _grid_height(lost, rms_height)
    grid = SeparationGrid.around(lost.mean_separation, height, count=round(_GRID_POINTS * refinement))
    weight = density(lost, grid.separation) * grid.weight
    # What the grid misses is wide open above it; below it is too narrow to matter and counts as contact.
    beyond = folded_above(lost, grid.separation[:, -1])
    contact = np.maximum(1.0 - weight.sum(axis=1) - beyond, 0.0)
    return _Gaps(grid.separation, weight, contact, beyond)


def _grid_height(lost: LostArea, rms_height: float) -> FloatArray:
    """Height that decides where the grid is fine, shape (P,) [m].

    The rms height of the whole spectrum, but where little of it is left after plastic smoothing, twice the spread of
    P(u): steps of the grid that are small against the former would not see so narrow a distribution.
    """
    share = np.maximum(lost.weight.sum(axis=1), 1e-300)
    mean = lost.mean_separation
    second = (lost.weight * (lost.separation**2 + lost.width**2)).sum(axis=1) / share
    spread = np.sqrt(np.maximum(second - (mean / share) ** 2, 0.0))
    narrow = (spread > 0.0) & (spread < _NARROW * np.minimum(mean, rms_height))
    return np.where(narrow, 2.0 * spread, rms_height)


def critical_gap(
    spectrum: PowerSpectrum,
    seen: RoughnessSeen,
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
    whole = moment_of_all(seen, target.size)
    M = _elastic_moment(seen, np.minimum(target, whole))
    found = separations(spectrum, seen, relative_pressure, M[:, None], gamma, refinement=2)
    return np.where(target < whole, found.lost[:, 0], 0.0)


def area_argument_at(relative_area: float) -> float:
    """z with erf(z) = A/A0."""
    from scipy.special import erfinv

    return float(erfinv(relative_area))


def _elastic_moment(seen: RoughnessSeen, remaining: FloatArray) -> FloatArray:
    """Elastic moment M at which the remaining moment has a given value, by bisection in ln M (it rises with M)."""
    if isinstance(seen, ElasticRoughness):
        return remaining
    ends = np.log(remaining), np.full(remaining.shape, np.log(seen.end))
    low, high = bisected(lambda log_M: seen.moment(np.exp(log_M)[:, None])[:, 0] < remaining, *ends)
    # the exponential of a logarithm may lie above the end by a rounding, where there is no spectrum
    return np.minimum(np.exp(0.5 * (low + high)), seen.end)


def folded_above(lost: LostArea, u: FloatArray) -> FloatArray:
    """Area with a separation above u, shape (P,)."""
    from scipy.special import erfc

    scale = np.sqrt(0.5) / lost.width
    above = 0.5 * (
        erfc((u[:, None] - lost.separation) * scale) + erfc((u[:, None] + lost.separation) * scale)
    )
    return (lost.weight * above).sum(axis=1)
