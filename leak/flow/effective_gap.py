"""The two equivalent gaps of a rough interface: of the effective medium, and at the critical junction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.flow.medium import DirectionalGap, anisotropic_medium, effective_medium_of_logarithms
from leak.flow.rarefied import log_flow_factor
from leak.surfaces.spectrum import PowerSpectrum
from leak.theory.persson import ElasticRoughness, RoughnessSeen, separations
from leak.theory.separation import LostArea, SeparationGrid, density

_GRID_POINTS = 256
# A distribution narrower than this share of its mean falls between the points of a grid even in ln u.
_NARROW = 0.25


def effective_gap(
    lost: LostArea,
    mean_separation: FloatArray,
    rms_height: float,
    n: float,
    aspect: float | FloatArray = 1.0,
    *,
    refinement: int = 1,
) -> FloatArray:
    """u_eff of Bruggeman's effective medium over P(u), shape (P,) [m].

    See `leak.flow.medium.effective_medium` and, for inclusions of an aspect other than one, one number or shape (P,),
    `leak.flow.medium.anisotropic_medium`.

    References
    ----------
    B. Lorenz, B. N. J. Persson, Eur. Phys. J. E 31, 159 (2010); W. B. Dapp et al., Phys. Rev. Lett. 108, 244301
    (2012).
    """
    return anisotropic_medium(*_gaps(lost, mean_separation, rms_height, refinement), n, aspect).along


def effective_gas_gap(
    lost: LostArea,
    mean_separation: FloatArray,
    rms_height: float,
    n: float,
    aspect: float | FloatArray,
    flight: FloatArray,
) -> FloatArray:
    """u of the uniform gap without rarefaction that lets as much of a rarefied gas through as P(u), shape (P, m) [m].

    The effective medium over the local conductivity u^3 f(u/l), f of `leak.flow.rarefied.flow_factor`, at m lengths
    l = eta v0/p_f for each pressure, shape (P, m) [m].
    """
    gaps = _gaps(lost, mean_separation, rms_height, 1)
    out = np.empty(flight.shape)
    log_u, smallest = np.log(gaps.separation), gaps.separation[:, 0]
    near: FloatArray | None = None
    both: DirectionalGap | None = None
    # from the lowest Knudsen number to the highest, each beginning with the answer of the one before
    for j in np.argsort(flight.mean(axis=0)):
        log_wider = log_u + log_flow_factor(log_u - np.log(flight[:, j, None])) / 3.0
        if isinstance(aspect, float) and aspect == 1.0:
            rest = (gaps.weight, gaps.contact, gaps.wide_open)
            out[:, j] = effective_medium_of_logarithms(log_wider, *rest, n, near)
            near = np.where(out[:, j] > 0.0, out[:, j], smallest)
        else:
            wider = gaps._replace(separation=np.exp(log_wider))
            both = anisotropic_medium(*wider, n, aspect, both)
            out[:, j] = both.along
            both = DirectionalGap(*(np.where(gap > 0.0, gap, smallest) for gap in both))
    return out


class _Gaps(NamedTuple):
    """P(u) on a grid: arrays (pressures, separations), and the shares without a separation (pressures,)."""

    separation: FloatArray
    weight: FloatArray
    contact: FloatArray
    wide_open: FloatArray


def _gaps(lost: LostArea, mean_separation: FloatArray, rms_height: float, refinement: int) -> _Gaps:
    height = _grid_height(lost, mean_separation, rms_height)
    grid = SeparationGrid.around(mean_separation, height, count=_GRID_POINTS * refinement)
    weight = density(lost, grid.separation) * grid.weight
    # What the grid misses is wide open above it; below it is too narrow to matter and counts as contact.
    beyond = folded_above(lost, grid.separation[:, -1])
    contact = np.maximum(1.0 - weight.sum(axis=1) - beyond, 0.0)
    return _Gaps(grid.separation, weight, contact, beyond)


def _grid_height(lost: LostArea, mean: FloatArray, rms_height: float) -> FloatArray:
    """Height that decides where the grid is fine, shape (P,) [m].

    The rms height of the whole spectrum, but where little of it is left after plastic smoothing, twice the spread of
    P(u): steps of the grid that are small against the former would not see so narrow a distribution.
    """
    share = np.maximum(lost.weight.sum(axis=1), 1e-300)
    first = (lost.weight * lost.separation).sum(axis=1) / share
    second = (lost.weight * (lost.separation**2 + lost.width**2)).sum(axis=1) / share
    spread = np.sqrt(np.maximum(second - first**2, 0.0))
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
    whole = seen.moment(np.full((target.size, 1), seen.end))[:, 0]
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
    low, high = np.log(remaining), np.full(remaining.shape, np.log(seen.end))
    for _ in range(60):
        middle = 0.5 * (low + high)
        below = seen.moment(np.exp(middle)[:, None])[:, 0] < remaining
        low, high = np.where(below, middle, low), np.where(below, high, middle)
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
