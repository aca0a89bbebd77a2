"""From measured scans to the isotropic power spectrum of a surface, and what else the scans say about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from leak.arrays import FloatArray
from leak.surfaces.estimate import estimate
from leak.surfaces.range import share_above
from leak.surfaces.scans import Topography
from leak.surfaces.self_affine_fit import RollOff
from leak.surfaces.settings import ScanSettings
from leak.surfaces.shape import anisotropy, remarks_on_range, remarks_on_shape, shape_moments
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
    found = estimate((scans,) if isinstance(scans, Topography) else tuple(scans), settings)
    flat, waves = found.scans, found.waves
    above = [share_above(one, reliable.q_high) for one, reliable in zip(waves, found.ranges, strict=True)]
    skewness, kurtosis = shape_moments(flat)
    lay = anisotropy(waves, found.ranges)
    finest = max(found.ranges, key=lambda one: one.q_high)
    height_above = float(np.average(above, weights=found.variances))
    measured = PowerSpectrum(*found.measured)
    cut = found.continued is found.measured
    return MeasuredSurface(
        spectrum=measured if cut else PowerSpectrum(*found.continued),
        measured=measured,
        log_error=found.log_error,
        rms_height=float(np.sqrt(found.variances.mean())),
        scan_rms_heights=tuple(float(one) for one in np.sqrt(found.variances)),
        skewness=skewness,
        kurtosis=kurtosis,
        anisotropy=lay.ratio if lay else None,
        lay_angle=lay.angle if lay else None,
        rolloff=found.rolloff,
        q_low=measured.q_low,
        q_high=measured.q_high,
        limit=finest.limit,
        tip_radius=settings.tip_radius or flat[0].tip_radius,
        height_above=height_above,
        scans=flat,
        settings=settings,
        warnings=(
            *remarks_on_shape(flat, waves, settings, skewness, kurtosis, found.outliers, lay),
            *remarks_on_range(flat, finest, settings, found.rolloff, height_above),
        ),
    )
