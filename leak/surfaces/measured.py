"""From measured scans to the isotropic power spectrum of a surface, and what else the scans say about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ScanError
from leak.surfaces.fit import VarianceShare, fit_spectrum
from leak.surfaces.outliers import find_outliers, without_outliers
from leak.surfaces.periodogram import Periodogram, evidence, periodogram, pooled
from leak.surfaces.range import ReliableRange, reliable_range, share_above
from leak.surfaces.scans import Topography
from leak.surfaces.self_affine_fit import RollOff, fit_rolloff
from leak.surfaces.settings import ScanSettings, SelfAffineContinuation
from leak.surfaces.shape import anisotropy, remarks_on_range, remarks_on_shape, shape_moments
from leak.surfaces.spectrum import PowerSpectrum

# Nodes of the spectrum per decade of q, and how far the fit looks beyond the shortest wave: oblique waves that are
# shorter show up in a line scan, too.
_PER_DECADE = 10
_BEYOND = 10.0
_FINE = 0.02


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
    given = (scans,) if isinstance(scans, Topography) else tuple(scans)
    if not given:
        raise ScanError("no scan: at least one is needed")
    found = tuple(find_outliers(scan) for scan in given)
    if settings.outliers == "remove":
        given = tuple(without_outliers(scan, one) for scan, one in zip(given, found, strict=True))
    flat = tuple(_without_form(scan, settings) for scan in given)
    modes = [periodogram(scan, settings.window) for scan in flat]
    ranges = [reliable_range(scan, one, settings) for scan, one in zip(flat, modes, strict=True)]
    variances = np.array([float(np.mean(scan.heights**2)) for scan in flat])
    measured, log_error, rolloff = _spectrum(modes, ranges, variances)
    above = [share_above(one, reliable.q_high) for one, reliable in zip(modes, ranges, strict=True)]
    skewness, kurtosis = shape_moments(flat)
    lay = anisotropy(modes, ranges)
    finest = max(ranges, key=lambda one: one.q_high)
    height_above = float(np.average(above, weights=variances))
    spectrum = measured
    if isinstance(settings.extrapolation, SelfAffineContinuation):
        spectrum = _continued(measured, settings.extrapolation)
    return MeasuredSurface(
        spectrum=spectrum,
        measured=measured,
        log_error=log_error,
        rms_height=float(np.sqrt(variances.mean())),
        scan_rms_heights=tuple(float(one) for one in np.sqrt(variances)),
        skewness=skewness,
        kurtosis=kurtosis,
        anisotropy=lay.ratio if lay else None,
        lay_angle=lay.angle if lay else None,
        rolloff=rolloff,
        q_low=measured.q_low,
        q_high=measured.q_high,
        limit=finest.limit,
        tip_radius=settings.tip_radius or flat[0].tip_radius,
        height_above=height_above,
        scans=flat,
        settings=settings,
        warnings=(
            *remarks_on_shape(flat, modes, settings, skewness, kurtosis, found, lay),
            *remarks_on_range(flat, finest, settings, rolloff, height_above),
        ),
    )


def _continued(spectrum: PowerSpectrum, by: SelfAffineContinuation) -> PowerSpectrum:
    """The spectrum with its ends continued."""
    q, C = list(spectrum.wavenumber), list(spectrum.density)
    fall = -2.0 * (1.0 + by.hurst)
    if by.q_low is not None:
        if not by.q_low < q[0]:
            raise ScanError(f"q_low = {by.q_low:.4g} 1/m: must be below the reliable range, {q[0]:.4g} 1/m")
        q, C = [by.q_low, *q], [C[0] * (by.q_low / q[0]) ** fall, *C]
    if by.q_high is not None:
        if not by.q_high > q[-1]:
            raise ScanError(
                f"q_high = {by.q_high:.4g} 1/m: must be above the reliable range, {q[-1]:.4g} 1/m"
            )
        q, C = [*q, by.q_high], [*C, C[-1] * (by.q_high / q[-1]) ** fall]
    return PowerSpectrum(np.array(q), np.array(C))


def _without_form(scan: Topography, settings: ScanSettings) -> Topography:
    flat = scan.without_form(settings.detrend)
    if float(np.abs(flat.heights).max()) <= 1e-12 * float(np.abs(scan.heights).max()):
        raise ScanError(
            f"{scan.name or 'scan'}: nothing is left without its {settings.detrend}; there is no roughness"
        )
    return flat


def _spectrum(
    modes: Sequence[Periodogram], ranges: Sequence[ReliableRange], variances: FloatArray
) -> tuple[PowerSpectrum, FloatArray, RollOff]:
    """C(q) over the range of all scans together, the standard deviation of ln C, and its roll-off."""
    low, high = min(one.q_low for one in ranges), max(one.q_high for one in ranges)
    count = max(round(_PER_DECADE * np.log10(high / low)), 3)
    step = np.log(high / low) / count
    nodes = low * np.exp(step * np.arange(count + 1 + round(np.log(_BEYOND) / step)))
    pieces = max(round(step / _FINE), 1)
    edges = low * np.exp(step / pieces * np.arange(pieces * (nodes.size - 1) + 1))
    seen = [
        evidence(one, _edges_within(nodes[: count + 1], reliable), edges)
        for one, reliable in zip(modes, ranges, strict=True)
    ]
    held = np.array(
        [v * (1.0 - share_above(one, r.q_high)) for v, one, r in zip(variances, modes, ranges, strict=True)]
    )
    within = np.mean([_overlap(edges, reliable) for reliable in ranges], axis=0)
    share = VarianceShare(float(held.mean()), np.sqrt(edges[1:] * edges[:-1]), 2.0 * np.pi * within)
    fit = fit_spectrum(nodes, pooled(seen), share)
    shape = PowerSpectrum(nodes[: count + 1], np.exp(fit.log_density[: count + 1]))
    now = 2.0 * np.pi * np.mean([shape.moment(1, one.q_low, one.q_high) for one in ranges])
    measured = PowerSpectrum(shape.wavenumber, shape.density * held.mean() / now)
    return measured, fit.log_error[: count + 1], fit_rolloff(nodes[: count + 1], seen, float(held.mean()))


def _edges_within(nodes: FloatArray, reliable: ReliableRange) -> FloatArray:
    """Nodes inside the range of one scan, with its ends."""
    inner = nodes[(nodes > reliable.q_low * 1.05) & (nodes < reliable.q_high / 1.05)]
    return np.concatenate([[reliable.q_low], inner, [reliable.q_high]])


def _overlap(edges: FloatArray, reliable: ReliableRange) -> FloatArray:
    """int q dq of each piece within the range of one scan."""
    return np.diff(0.5 * np.clip(edges, reliable.q_low, reliable.q_high) ** 2)
