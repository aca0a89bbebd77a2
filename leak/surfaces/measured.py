"""A measured surface: isotropic spectrum, moments of the heights, lay, roll-off, and what to warn of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from leak.arrays import FloatArray
from leak.errors import um
from leak.files import own_tables
from leak.surfaces.estimate import ReliableRange, estimate, share_above
from leak.surfaces.periodogram import Periodogram
from leak.surfaces.scans import FoundOutliers, ScanSettings, Topography
from leak.surfaces.self_affine_fit import CONFIDENCE, RollOff
from leak.surfaces.spectrum import PowerSpectrum


@dataclass(frozen=True, eq=False)
class MeasuredSurface:
    """A surface as its scans show it.

    Parameters
    ----------
    spectrum : PowerSpectrum
        C(q) within the reliable range, continued if the settings say so.
    measured : PowerSpectrum
        C(q) within the reliable range.
    log_error : ndarray, shape (nodes of `measured`,)
        Standard deviation of ln C from the number of waves in the scans [-].
    rms_height : float
        Root mean square of the heights without form, mean over the scans; all waves, also those outside the
        reliable range [m].
    scan_rms_heights : tuple of float
        The same of each scan [m].
    skewness, kurtosis : float
        Of all heights, 0 and 3 for a Gaussian surface [-].
    anisotropy : float or None
        Correlation length along the lay over the one across it, 1 or more, mean over the maps; None without a map.
        The Peklenik number of a contact is this where the fluid flows along the lay, and one over it where it flows
        across (see `peklenik`) [-].
    lay_angle : float or None
        Direction of the lay, from the x-axis of the map [rad].
    rolloff : RollOff
        Roll-off, Hurst exponent and what the rms height of the surface may be, with their intervals.
    q_low, q_high : float
        Reliable range [1/m].
    limit : str
        What limits the range at the upper end.
    tip_radius : float or None
        What was used [m].
    height_above : float
        Share of the variance in waves shorter than the reliable range [-].
    scans : tuple of Topography
        The scans without form.
    settings : ScanSettings
    warnings : tuple of str
        What an engineer should know before using the spectrum.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> x, h = leak.random_line_scan(spectrum, length=0.01, points=5_000, seed=1)
    >>> surface = leak.measure(leak.line_scan(x, h))
    >>> surface.q_low < surface.q_high, len(surface.scans)
    (True, 1)
    """

    spectrum: PowerSpectrum
    measured: PowerSpectrum
    log_error: FloatArray
    rms_height: float
    scan_rms_heights: tuple[float, ...]
    skewness: float
    kurtosis: float
    anisotropy: float | None
    lay_angle: float | None
    rolloff: RollOff
    q_low: float
    q_high: float
    limit: str
    tip_radius: float | None
    height_above: float
    scans: tuple[Topography, ...]
    settings: ScanSettings
    warnings: tuple[str, ...] = ()

    @property
    def peklenik(self) -> tuple[float, float] | None:
        """Peklenik number where the fluid flows across the lay (1 or less), and along it; None without a map [-]."""
        return None if self.anisotropy is None else (1.0 / self.anisotropy, self.anisotropy)


def measure(
    scans: Topography | Sequence[Topography], settings: ScanSettings | None = None
) -> MeasuredSurface:
    """Spectrum and key figures of a surface from one or more scans of it.

    Each scan loses its form (`settings.detrend`), is windowed and Fourier transformed; the isotropic C(q) is the
    smooth one that explains the power of all scans best (`fit_spectrum`) and whose variance, 2 pi int q C dq over the
    reliable range, is the mean variance of the scans in that range.

    The reliable range begins at 2 pi / (longest side) and ends at the shortest of: two points (pi / spacing), 2 pi /
    `shortest_wavelength`, and the wavenumber up to which the rms curvature of the profile is 1/(2 tip_radius), where
    twice the rms curvature is the tip's own.

    Parameters
    ----------
    scans : LineScan, HeightMap or a sequence of them
        Scans of one surface.
    settings : ScanSettings, optional
        Tilt removed, Hann window, cut, unless given.

    Returns
    -------
    MeasuredSurface
        C [m^4] over the wavenumber [1/m], heights [m].

    Raises
    ------
    ScanError
        No scan, or one that tells nothing reliable.

    References
    ----------
    T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr.: Metrol. Prop. 5, 013001 (2017); tip radius: A. Sanner et al.,
    Appl. Surf. Sci. Adv. 7, 100190 (2022).

    Examples
    --------
    >>> import leak
    >>> true = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> x, h = leak.random_line_scan(true, length=0.02, points=20_000, seed=1)
    >>> surface = measure(leak.line_scan(x, h))
    >>> bool(abs(surface.rms_height / 1e-6 - 1) < 0.05), bool(abs(surface.rolloff.hurst - 0.8) < 0.1)
    (True, True)
    """
    settings = settings or ScanSettings()
    result = estimate((scans,) if isinstance(scans, Topography) else tuple(scans), settings)
    flat, waves = result.scans, result.waves
    tails = [share_above(modes, r.q_high) for modes, r in zip(waves, result.ranges, strict=True)]
    skewness, kurtosis = shape_moments(flat)
    lay = anisotropy(waves, result.ranges)
    finest = max(result.ranges, key=lambda reliable: reliable.q_high)
    height_above = float(np.average(tails, weights=result.variances))
    measured = PowerSpectrum(*result.measured_nodes)
    is_cut = result.continued_nodes is result.measured_nodes
    return MeasuredSurface(
        spectrum=measured if is_cut else PowerSpectrum(*result.continued_nodes),
        measured=measured,
        log_error=result.log_error,
        rms_height=float(np.sqrt(result.variances.mean())),
        scan_rms_heights=tuple(float(height) for height in np.sqrt(result.variances)),
        skewness=skewness,
        kurtosis=kurtosis,
        anisotropy=lay.ratio if lay else None,
        lay_angle=lay.angle if lay else None,
        rolloff=result.rolloff,
        q_low=measured.q_low,
        q_high=measured.q_high,
        limit=finest.limit,
        tip_radius=settings.tip_radius or flat[0].tip_radius,
        height_above=height_above,
        scans=flat,
        settings=settings,
        warnings=(
            *remarks_on_shape(flat, waves, settings, skewness, kurtosis, result.outliers, lay),
            *remarks_on_range(flat, finest, settings, result.rolloff, height_above),
        ),
    )


# -------------------------------------------------------------------- key figures and remarks

# Heights further than this from a Gaussian distribution are far from it: the theory is for Gaussian surfaces.
_LARGE_SKEWNESS, _LOW_KURTOSIS, _HIGH_KURTOSIS = 1.0, 2.0, 5.0
# A parabola that carries more than this share of the variance is form, not roughness.
_FORM = 0.5
# A single wave with more than this share of the variance, and at least this many periods in the scan, is a lay.
_ONE_WAVE, _PERIODS, _FEWEST_WAVES = 0.5, 4, 32
# An isotropic surface shows a ratio of lengths of 1 + this over the square root of the number of waves at most (95 %).
_SCATTER = 4.0
# A lay that matters to the flow.
_LAY = 1.5
# Scans are too short for their roll-off if the rms height of the surface is not known to this factor from one end of
# its interval to the other, and long enough with so many waves.
_TOO_SHORT, _ENOUGH_WAVES = 1.8, 20
# A variance cut away that engineers would see in the rms height.
_CUT_SHARE = 0.01


@dataclass(frozen=True)
class Lay:
    """Direction in which a surface is correlated longest.

    Parameters
    ----------
    ratio : float
        Correlation length along the lay over that across it, 1 or more [-].
    angle : float
        Direction of the crests from the x-axis [rad].
    chance : float
        Ratio that an isotropic surface may show in a map of this size [-].
    """

    ratio: float
    angle: float
    chance: float


def shape_moments(scans: Sequence[Topography]) -> tuple[float, float]:
    """Skewness and kurtosis of the heights of scans without form, moments averaged over the scans."""
    second, third, fourth = (np.mean([np.mean(scan.heights**k) for scan in scans]) for k in (2, 3, 4))
    return float(third / second**1.5), float(fourth / second**2)


def anisotropy(modes: Sequence[Periodogram], ranges: Sequence[ReliableRange]) -> Lay | None:
    """Mean lay of the maps among some scans, None without a map.

    For C(q_x, q_y) constant on ellipses of half-axes a and b the mean of (q_x/q)^2, weighted with C, is a/(a+b): the
    ratio of the eigenvalues of <q q^T/q^2> is a/b whatever the profile of C is.
    """
    tensors, waves = [], 0.0
    for scan, reliable in zip(modes, ranges, strict=True):
        # below the first wave along the shorter side, and above the last one along each, directions are missing
        low, high = float(scan.step.max()), min(reliable.q_high, float(scan.vector.max(axis=0).min()))
        is_whole = (scan.wavenumber > low * (1 - 1e-9)) & (scan.wavenumber < high)
        if scan.dimension == 2 and np.count_nonzero(is_whole) > 1:
            direction = scan.vector[is_whole] / scan.wavenumber[is_whole, None]
            share = scan.shares[is_whole] / scan.shares[is_whole].sum()
            tensors.append(np.einsum("n,ni,nj->ij", share, direction, direction))
            waves += 1.0 / float(np.sum(share**2))
    if not tensors:
        return None
    values, vectors = np.linalg.eigh(np.mean(tensors, axis=0))
    crests = vectors[:, 1]
    angle = float(np.arctan2(crests[1], crests[0]) + 0.5 * np.pi)
    # each wave has one direction: the two eigenvalues of n random ones differ by about 1/sqrt(n) of their mean
    return Lay(float(values[1] / max(values[0], 1e-9)), angle % np.pi, 1.0 + _SCATTER / np.sqrt(waves))


def remarks_on_shape(
    scans: Sequence[Topography],
    modes: Sequence[Periodogram],
    settings: ScanSettings,
    skewness: float,
    kurtosis: float,
    outliers: Sequence[FoundOutliers],
    lay: Lay | None,
) -> tuple[str, ...]:
    """What speaks against using the spectrum of these scans as if the surface were Gaussian and isotropic."""
    remarks = [f"{scan.name}: {remark}" if scan.name else remark for scan in scans for remark in scan.remarks]
    if abs(skewness) > _LARGE_SKEWNESS or not _LOW_KURTOSIS <= kurtosis <= _HIGH_KURTOSIS:
        remarks.append(_remark("not_gaussian", skewness=skewness, kurtosis=kurtosis))
    remarks += _on_outliers(scans, settings, outliers)
    form = max(_parabola_share(scan) for scan in scans)
    if settings.detrend != "curvature" and form > _FORM:
        remarks.append(_remark("form", share=form))
    for scan, scan_modes in zip(scans, modes, strict=True):
        shares = scan_modes.shares / scan_modes.shares.sum()
        # a window spreads one wave over neighbouring modes
        powers = np.convolve(shares, np.ones(3), mode="same") if scan_modes.dimension == 1 else shares
        if shares.size < _FEWEST_WAVES:
            continue
        powers = np.where(scan_modes.wavenumber >= _PERIODS * scan_modes.step.min(), powers, 0.0)
        strongest = int(np.argmax(powers))
        if powers[strongest] > _ONE_WAVE:
            length = um(2 * np.pi / scan_modes.wavenumber[strongest])
            remarks.append(
                _remark("one_wave", scan=scan.name or "scan", length=length, share=powers[strongest])
            )
    if lay is not None and lay.ratio > max(_LAY, lay.chance):
        remarks.append(_remark("lay", ratio=lay.ratio, across=1.0 / lay.ratio))
    return tuple(remarks)


def _on_outliers(
    scans: Sequence[Topography], settings: ScanSettings, outliers: Sequence[FoundOutliers]
) -> Iterator[str]:
    for scan, spots in zip(scans, outliers, strict=True):
        if not spots.count:
            continue
        several, height = "s" * (spots.count != 1), _length(spots.height)
        remark = _remark(
            "outliers", scan=scan.name or "scan", count=spots.count, s=several, height=height, pits=spots.pits
        )
        yield _remark("removed" if settings.outliers == "remove" else "kept", outliers=remark)


def remarks_on_range(
    scans: Sequence[Topography],
    finest: ReliableRange,
    settings: ScanSettings,
    rolloff: RollOff,
    height_above: float,
) -> tuple[str, ...]:
    """What the scans are too short or too coarse for."""
    remarks = []
    low, high = rolloff.height.interval
    if high > _TOO_SHORT * low:
        length, total = max(scan.length for scan in scans), sum(scan.length for scan in scans)
        if rolloff.wavenumber is None:
            holds, remedy = _remark("no_rolloff"), _remark("longer")
        else:
            wave = 2.0 * np.pi / rolloff.wavenumber
            holds = _remark("few_waves", waves=total / wave, wave=_length(wave))
            remedy = _remark("more_waves", length=_length(_ENOUGH_WAVES * wave))
        remarks.append(
            _remark(
                "too_short",
                length=_length(length),
                holds=holds,
                low=low,
                high=high,
                confidence=CONFIDENCE,
                wanted=remedy,
            )
        )
    if settings.extrapolation == "cut" and finest.limit in ("tip radius", "shortest wavelength"):
        sampling_limit = max(np.pi / scan.resolution for scan in scans)
        end = sampling_limit if sampling_limit > 1.5 * finest.q_high else 4.0 * finest.q_high
        fitted_hurst = rolloff.hurst
        hurst = fitted_hurst if fitted_hurst is not None and 0.0 < fitted_hurst <= 1.0 else 0.8
        shortest = _length(2 * np.pi / finest.q_high)
        remarks.append(_remark("too_coarse", wave=shortest, limit=finest.limit, hurst=hurst, end=end))
    if height_above > _CUT_SHARE:
        remarks.append(_remark("cut", share=height_above))
    return tuple(remarks)


def _remark(name: str, **values: float | str) -> str:
    text: str = own_tables("leak.surfaces", "remarks.toml")[name]
    return text.format(**values)


def _length(value: float) -> str:
    unit, size = next((end for end in (("mm", 1e-3), ("um", 1e-6)) if value >= 0.1 * end[1]), ("nm", 1e-9))
    return f"{value / size:.3g} {unit}"


def _parabola_share(scan: Topography) -> float:
    """Share of the variance that goes with the curvature."""
    return 1.0 - float(np.mean(scan.without_form("curvature").heights ** 2) / np.mean(scan.heights**2))
