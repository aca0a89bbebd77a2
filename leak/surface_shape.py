"""Key figures of a measured surface beyond its spectrum: moments of the heights, lay, roll-off, and what to warn of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from leak.periodogram import Periodogram
from leak.spectrum import PowerSpectrum
from leak.topography import Detrend, Topography

if TYPE_CHECKING:
    from leak.measured_surface import ReliableRange

FloatArray = NDArray[np.float64]

# Heights further than this from a Gaussian distribution are far from it: the theory is for Gaussian surfaces.
_SKEWED, _FLAT_TOPPED, _PEAKED = 1.0, 2.0, 5.0
# A parabola that carries more than this share of the variance is form, not roughness.
_FORM = 0.5
# A single wave with more than this share of the variance, and at least this many periods in the scan, is a lay.
_ONE_WAVE, _PERIODS = 0.5, 4
# Below this anisotropy a map of a few hundred waves cannot be told from an isotropic one.
_LAY = 1.5
# A variance cut away that engineers would see in the rms height.
_CUT = 0.01
# The lay is the mean over bins of q this wide [decades] with at least this many modes each.
_BIN, _FEWEST_MODES = 0.2, 30


@dataclass(frozen=True)
class Lay:
    """Anisotropy: Peklenik number (>= 1) [-] and direction of the long waves' crests from the x-axis [rad]."""

    ratio: float
    angle: float


@dataclass(frozen=True)
class RollOff:
    """Broken power law through a spectrum: constant up to `wavenumber`, then q^(-2 (1 + hurst)).

    Parameters
    ----------
    wavenumber : float or None
        Roll-off [1/m]; None if the spectrum falls over the whole range.
    hurst : float
        Hurst exponent; outside (0, 1) the surface is not self-affine [-].
    hurst_error : float
        Standard deviation from the scatter about the power law [-].
    """

    wavenumber: float | None
    hurst: float
    hurst_error: float


def shape_moments(scans: Sequence[Topography]) -> tuple[float, float]:
    """Skewness and kurtosis of the heights of scans without form, moments averaged over the scans."""
    second, third, fourth = (np.mean([np.mean(scan.heights**k) for scan in scans]) for k in (2, 3, 4))
    return float(third / second**1.5), float(fourth / second**2)


def anisotropy(modes: Sequence[Periodogram], ranges: Sequence[ReliableRange]) -> Lay | None:
    """Mean lay of the maps among some scans, None without a map.

    For C(q_x, q_y) constant on ellipses of half-axes a and b the mean of (q_x/q)^2, weighted with C, is a/(a+b): the
    ratio of the eigenvalues of <q q^T/q^2> is the Peklenik number whatever C is. Each bin of q counts the same.
    """
    tensors = []
    for one, reliable in zip(modes, ranges, strict=True):
        if one.dimension == 2:
            tensors += _direction_tensors(one, reliable)
    if not tensors:
        return None
    values, vectors = np.linalg.eigh(np.mean(tensors, axis=0))
    across = vectors[:, 1]
    angle = float(np.arctan2(across[1], across[0]) + 0.5 * np.pi)
    return Lay(float(values[1] / values[0]), angle % np.pi)


def _direction_tensors(modes: Periodogram, reliable: ReliableRange) -> list[FloatArray]:
    # below the first wave along the shorter side some directions have no modes
    low = max(reliable.q_low, float(modes.step.max()))
    high = min(reliable.q_high, float(np.abs(modes.vector).max(axis=0).min()))
    bins = np.floor(np.log10(np.maximum(modes.wavenumber, 1e-300) / low) / _BIN).astype(int)
    tensors = []
    for k in range(max(int(np.log10(high / low) / _BIN), 0)):
        here = bins == k
        if np.count_nonzero(here) >= _FEWEST_MODES:
            direction = modes.vector[here] / modes.wavenumber[here, None]
            tensors.append(np.einsum("n,ni,nj->ij", modes.power[here], direction, direction) / modes.power[here].sum())
    return tensors


def fit_rolloff(spectrum: PowerSpectrum, log_error: FloatArray) -> RollOff:
    """Roll-off and Hurst exponent of a measured spectrum, by weighted least squares in ln C over ln q."""
    x, y = np.log(spectrum.wavenumber), np.log(spectrum.density)
    # the ends, where scans know least, and a floor of noise at the upper one must not turn the slope
    weight = 1.0 / np.maximum(log_error, 0.05)
    candidates = [_broken_line(x, y, weight, x0) for x0 in np.linspace(x[0], x[-4], 60 if x.size > 4 else 1)]
    best = min(candidates, key=lambda one: one[0])
    _, x0, slope, error = best
    # a flat part of less than a third of a decade is not one
    wavenumber = float(np.exp(x0)) if x0 - x[0] > np.log(2.0) else None
    if wavenumber is None:
        _, _, slope, error = candidates[0]
    return RollOff(wavenumber, -0.5 * slope - 1.0, 0.5 * error)


def _broken_line(x: FloatArray, y: FloatArray, weight: FloatArray, x0: float) -> tuple[float, float, float, float]:
    """Misfit, corner, slope and its standard deviation of a line that is constant up to a given corner."""
    basis = np.stack([np.ones_like(x), np.maximum(x - x0, 0.0)], axis=1)
    coefficients, *_ = np.linalg.lstsq(basis * weight[:, None], y * weight, rcond=None)
    misfit = float(np.sum((weight * (y - basis @ coefficients)) ** 2))
    normal = (basis * weight[:, None] ** 2).T @ basis
    scatter = misfit / max(x.size - 3, 1)
    return misfit, x0, float(coefficients[1]), float(np.sqrt(scatter * np.linalg.inv(normal)[1, 1]))


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
        together = np.where(one.wavenumber >= _PERIODS * one.step.min(), together, 0.0)
        strongest = int(np.argmax(together))
        if together[strongest] > _ONE_WAVE:
            remarks.append(
                f"{scan.name or 'scan'}: one wave of {2 * np.pi / one.wavenumber[strongest]:.3g} m carries "
                f"{together[strongest]:.0%} of the variance: a turned or ground lay, not an isotropic surface"
            )
    if lay is not None and lay.ratio > _LAY:
        remarks.append(
            f"anisotropic: correlation length along the lay {lay.ratio:.2g} times the one across it; the spectrum is "
            "the angular average"
        )
    if height_above > _CUT:
        remarks.append(f"{height_above:.1%} of the variance lies in waves shorter than the reliable range and is cut")
    return tuple(remarks)


def _parabola_share(scan: Topography) -> float:
    """Share of the variance that goes with the curvature."""
    return 1.0 - float(np.mean(scan.without_form("curvature").heights ** 2) / np.mean(scan.heights**2))
