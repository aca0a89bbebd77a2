"""Key figures of a measured surface beyond its spectrum: moments of the heights, lay, roll-off, and what to warn of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from leak.periodogram import Periodogram
from leak.reliable_range import ReliableRange
from leak.spectrum import PowerSpectrum
from leak.topography import Detrend, Topography

FloatArray = NDArray[np.float64]

# Heights further than this from a Gaussian distribution are far from it: the theory is for Gaussian surfaces.
_SKEWED, _FLAT_TOPPED, _PEAKED = 1.0, 2.0, 5.0
# A parabola that carries more than this share of the variance is form, not roughness.
_FORM = 0.5
# A single wave with more than this share of the variance, and at least this many periods in the scan, is a lay.
_ONE_WAVE, _PERIODS, _FEWEST_WAVES = 0.5, 4, 32
# An isotropic surface shows a Peklenik number of 1 + this over the square root of the number of waves at most (95 %).
_SCATTER = 4.0
# A lay that matters to the flow.
_LAY = 1.5
# A variance cut away that engineers would see in the rms height.
_CUT = 0.01
# Roll-off: the self-affine part has at least this length in ln q and this many nodes; the power law is no better than
# this in ln C; and a shorter flat part than this (ln q) is none.
_SHORTEST, _FEWEST_NODES, _SMALLEST_ERROR, _FLAT_PART = np.log(4.0), 3, 0.05, np.log(1.5)
_LEAST_FALL = -2.0
# One more piece must lower the weighted sum of squares by this, or it only follows the scatter.
_PIECE = 12.0


@dataclass(frozen=True)
class Lay:
    """Direction in which a surface is correlated longest.

    Parameters
    ----------
    ratio : float
        Peklenik number, 1 or more [-].
    angle : float
        Direction of the crests from the x-axis [rad].
    chance : float
        Ratio that an isotropic surface may show in a map of this size [-].
    """

    ratio: float
    angle: float
    chance: float


@dataclass(frozen=True)
class RollOff:
    """Broken power law through a spectrum: constant up to `wavenumber`, then q^(-2 (1 + hurst)) up to `end`.

    Parameters
    ----------
    wavenumber : float or None
        Roll-off [1/m]; None if the spectrum falls over the whole range.
    end : float
        End of the self-affine part [1/m].
    hurst : float
        Hurst exponent; outside (0, 1) the surface is not self-affine [-].
    hurst_error : float
        Standard deviation, from the errors of the spectrum or from its scatter about the power law [-].
    """

    wavenumber: float | None
    end: float
    hurst: float
    hurst_error: float


def shape_moments(scans: Sequence[Topography]) -> tuple[float, float]:
    """Skewness and kurtosis of the heights of scans without form, moments averaged over the scans."""
    second, third, fourth = (np.mean([np.mean(scan.heights**k) for scan in scans]) for k in (2, 3, 4))
    return float(third / second**1.5), float(fourth / second**2)


def anisotropy(modes: Sequence[Periodogram], ranges: Sequence[ReliableRange]) -> Lay | None:
    """Mean lay of the maps among some scans, None without a map.

    For C(q_x, q_y) constant on ellipses of half-axes a and b the mean of (q_x/q)^2, weighted with C, is a/(a+b): the
    ratio of the eigenvalues of <q q^T/q^2> is the Peklenik number whatever the profile of C is.
    """
    tensors, waves = [], 0.0
    for one, reliable in zip(modes, ranges, strict=True):
        # below the first wave along the shorter side, and above the last one along each, directions are missing
        low, high = float(one.step.max()), min(reliable.q_high, float(one.vector.max(axis=0).min()))
        inside = (one.wavenumber > low * (1 - 1e-9)) & (one.wavenumber < high)
        if one.dimension == 2 and np.count_nonzero(inside) > 1:
            direction = one.vector[inside] / one.wavenumber[inside, None]
            share = one.shares[inside] / one.shares[inside].sum()
            tensors.append(np.einsum("n,ni,nj->ij", share, direction, direction))
            waves += 1.0 / float(np.sum(share**2))
    if not tensors:
        return None
    values, vectors = np.linalg.eigh(np.mean(tensors, axis=0))
    across = vectors[:, 1]
    angle = float(np.arctan2(across[1], across[0]) + 0.5 * np.pi)
    # each wave has one direction: the two eigenvalues of n random ones differ by about 1/sqrt(n) of their mean
    return Lay(float(values[1] / max(values[0], 1e-9)), angle % np.pi, 1.0 + _SCATTER / np.sqrt(waves))


def fit_rolloff(spectrum: PowerSpectrum, log_error: FloatArray) -> RollOff:
    """Roll-off and Hurst exponent of a measured spectrum.

    Weighted least squares of ln C over ln q with three straight pieces: constant, self-affine, and whatever comes
    behind (a filter, the noise of the instrument); the first and the last may be missing.
    """
    x, y = np.log(spectrum.wavenumber), np.log(spectrum.density)
    weight = 1.0 / np.maximum(log_error, _SMALLEST_ERROR)
    best = _broken_line(x, y, weight, x[0], x[-1])
    for start in x[:-_FEWEST_NODES]:
        for end in x[x > start + _SHORTEST]:
            line = _broken_line(x, y, weight, start, end)
            # what falls less than any self-affine spectrum is a roll-off or noise
            falls = line.slope < _LEAST_FALL
            if (falls, -line.cost) > (best.slope < _LEAST_FALL, -best.cost):
                best = line
    # nearer to the end of the spectrum than that, a flat part is a matter of chance
    wavenumber = float(np.exp(best.start)) if best.start - x[0] > _FLAT_PART else None
    return RollOff(wavenumber, float(np.exp(best.end)), -0.5 * best.slope - 1.0, 0.5 * best.slope_error)


@dataclass(frozen=True)
class _BrokenLine:
    """Constant up to `start`, `slope` up to `end`, another slope behind, all in ln q."""

    start: float
    end: float
    cost: float
    slope: float
    slope_error: float


def _broken_line(x: FloatArray, y: FloatArray, weight: FloatArray, start: float, end: float) -> _BrokenLine:
    columns = [np.ones_like(x), np.maximum(np.minimum(x, end) - start, 0.0)]
    if end < x[-1]:
        columns.append(np.maximum(x - end, 0.0))
    basis = np.stack(columns, axis=1) * weight[:, None]
    normal = basis.T @ basis
    coefficients = np.linalg.solve(normal, basis.T @ (y * weight))
    misfit = float(np.sum((weight * y - basis @ coefficients) ** 2))
    # smoothing makes neighbouring nodes agree better than their errors say
    scatter = max(misfit / max(x.size - basis.shape[1] - 2, 1), 1.0)
    cost = misfit + _PIECE * (basis.shape[1] + (start > x[0]))
    return _BrokenLine(
        start, end, cost, float(coefficients[1]), float(np.sqrt(scatter * np.linalg.inv(normal)[1, 1]))
    )


def remarks_on_shape(
    scans: Sequence[Topography],
    modes: Sequence[Periodogram],
    detrend: Detrend,
    skewness: float,
    kurtosis: float,
    height_above: float,
    lay: Lay | None,
) -> tuple[str, ...]:
    """What speaks against using the spectrum of these scans as if the surface were Gaussian and isotropic."""
    remarks = [f"{scan.name}: {remark}" if scan.name else remark for scan in scans for remark in scan.remarks]
    if abs(skewness) > _SKEWED or not _FLAT_TOPPED <= kurtosis <= _PEAKED:
        remarks.append(
            f"far from Gaussian: skewness {skewness:.2g}, kurtosis {kurtosis:.2g} (Gaussian: 0 and 3). The theory is "
            "for Gaussian surfaces; valleys or scratches that carry the leakage may be missed"
        )
    form = max(_parabola_share(scan) for scan in scans)
    if detrend != "curvature" and form > _FORM:
        remarks.append(
            f'a parabola carries {form:.0%} of the variance: this is form, not roughness; use detrend = "curvature"'
        )
    for scan, one in zip(scans, modes, strict=True):
        shares = one.shares / one.shares.sum()
        # a window spreads one wave over neighbouring modes
        together = np.convolve(shares, np.ones(3), mode="same") if one.dimension == 1 else shares
        if shares.size < _FEWEST_WAVES:
            continue
        together = np.where(one.wavenumber >= _PERIODS * one.step.min(), together, 0.0)
        strongest = int(np.argmax(together))
        if together[strongest] > _ONE_WAVE:
            remarks.append(
                f"{scan.name or 'scan'}: one wave of {2 * np.pi / one.wavenumber[strongest]:.3g} m carries "
                f"{together[strongest]:.0%} of the variance: a turned or ground lay, not an isotropic surface"
            )
    if lay is not None and lay.ratio > max(_LAY, lay.chance):
        remarks.append(
            f"anisotropic: correlation length along the lay {lay.ratio:.2g} times the one across it; the spectrum is "
            "the angular average"
        )
    if height_above > _CUT:
        remarks.append(
            f"{height_above:.1%} of the variance lies in waves shorter than the reliable range and is cut"
        )
    return tuple(remarks)


def _parabola_share(scan: Topography) -> float:
    """Share of the variance that goes with the curvature."""
    return 1.0 - float(np.mean(scan.without_form("curvature").heights ** 2) / np.mean(scan.heights**2))
