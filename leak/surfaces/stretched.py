"""A stretched surface from what line scans along and across its lay say: angular average and Tripp number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from leak.arrays import FloatArray
from leak.errors import SpectrumError
from leak.numerics.integrals import gauss
from leak.surfaces.spectrum import PowerSpectrum

# Spacing in ln q of the average, and of the pieces of the angular integral.
_SPACING, _PIECE = 0.02, 0.4
_ANGLE_NODES = 8
# Grooves longer than this, over their width, are as good as endless; above 1e6 rounding would show.
# The two spectra are compared on this many wavenumbers.
MOST_STRETCHED, _COMPARED_NODES = 1000.0, 200
# At least this much of ln q must remain common to both.
_LEAST_OVERLAP = 1.0


@dataclass(frozen=True)
class StretchedRoughness:
    """What two directional spectra say about a surface whose spectrum has elliptic isolines.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> found = leak.stretched_roughness(along=spectrum, across=spectrum)
    >>> found.peklenik
    1.0
    """

    spectrum: PowerSpectrum
    """Angular average of C, for `leak.RoughContact`."""
    peklenik: float
    """Tripp number gamma_T, correlation length along over across [-]."""
    misfit: float
    """Root mean square of ln of the ratio of the two spectra after stretching: 0 for elliptic isolines [-]."""


def stretched_spectrum(spectrum: PowerSpectrum, peklenik: float) -> PowerSpectrum:
    """Angular average of an isotropic roughness stretched by sqrt(gamma_T) along x and squeezed as much along y.

    C_av(q) = (1/2 pi) int C(q sqrt(gamma_T cos^2 phi + sin^2 phi / gamma_T)) dphi; height variance as before, mean
    square slope times (gamma_T + 1/gamma_T)/2.

    Parameters
    ----------
    spectrum : PowerSpectrum
        C of the surface before it is stretched.
    peklenik : float
        gamma_T [-].

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> stretched = leak.stretched_spectrum(spectrum, peklenik=4.0)
    >>> print(f"{stretched.rms_height / spectrum.rms_height:.3f} {(stretched.rms_slope / spectrum.rms_slope) ** 2:.2f}")
    1.000 2.12
    """
    gamma = max(peklenik, 1.0 / peklenik)
    if gamma < 1.0 + 1e-6:
        return spectrum
    q = _average_nodes(spectrum, float(np.sqrt(gamma)))
    pieces = int(np.ceil(np.log(spectrum.q_high / spectrum.q_low) / _PIECE)) + 1
    k = np.union1d(spectrum.wavenumber, np.geomspace(spectrum.q_low, spectrum.q_high, pieces))
    # q_phi/q runs from sqrt(gamma) at phi = 0 down to 1/sqrt(gamma): the angles where it meets the pieces' ends.
    cos2 = np.clip(((k / q[:, None]) ** 2 - 1.0 / gamma) / (gamma - 1.0 / gamma), 0.0, 1.0)
    angle = np.arccos(np.sqrt(cos2[:, ::-1]))
    t, w = gauss(_ANGLE_NODES)
    half = 0.5 * np.diff(angle, axis=1)
    # most pieces are not seen from most wavenumbers
    row, piece = np.nonzero(half)
    half = half[row, piece]
    phi = angle[row, piece][:, None] + half[:, None] * (1.0 + t)
    q_phi = q[row, None] * np.sqrt(gamma * np.cos(phi) ** 2 + np.sin(phi) ** 2 / gamma)
    C = (2.0 / np.pi) * np.bincount(row, half * (np.asarray(spectrum(q_phi)) @ w), q.size).astype(np.float64)
    positive = np.flatnonzero(C / C.max() > 1e-300)
    average = PowerSpectrum(q[positive], C[positive])
    # Between nodes the average is not quite a power law; the height variance is known exactly.
    return PowerSpectrum(
        average.wavenumber, average.density * (spectrum.rms_height / average.rms_height) ** 2
    )


def _average_nodes(spectrum: PowerSpectrum, root: float) -> FloatArray:
    """Wavenumbers for the average, closer together at its kinks, where an end of C_0 comes into view or leaves it."""
    q_low, q_high = spectrum.q_low / root, spectrum.q_high * root
    grid = np.geomspace(q_low, q_high, int(np.ceil(np.log(q_high / q_low) / _SPACING)) + 1)
    steps = _SPACING * 0.5 ** np.arange(12.0)
    kinks = np.array([q_low, spectrum.q_low * root, spectrum.q_high / root, q_high])
    kink_grid = kinks[:, None] * np.exp(np.concatenate([-steps, [0.0], steps]))
    return np.unique(np.clip(np.concatenate([grid, kink_grid.ravel()]), q_low, q_high))


def stretched_roughness(along: PowerSpectrum, across: PowerSpectrum) -> StretchedRoughness:
    """Angular average and Tripp number from two spectra, of line scans along and across the flow.

    Each spectrum is what the usual conversion makes of the scans in its direction as if the surface were isotropic
    (`PowerSpectrum.from_profile`, `PowerSpectrum.from_file`). Approximation: isolines of C(q_x, q_y) are similar
    ellipses, that is, the surface is an isotropic one of spectrum C_0 stretched by sqrt(gamma_T) along x and squeezed
    as much along y. Then C_along(q) = gamma_T C_0(sqrt(gamma_T) q) and C_across(q) = C_0(q/sqrt(gamma_T))/gamma_T, so
    that C_along(q) = gamma_T^2 C_across(gamma_T q): gamma_T is the stretch for which this holds best, least squares of
    ln C over the wavenumbers common to both. It equals the ratio of rms slopes, across over along, if both scans
    resolve all waves.

    Parameters
    ----------
    along, across : PowerSpectrum
        From scans along the flow (x, across the seat's face) and across it (along the circumference) [m^4].

    Returns
    -------
    StretchedRoughness
        A misfit above about 0.5 says that the isolines are not similar ellipses, for example because the lay shows
        in long waves only.

    Raises
    ------
    SpectrumError
        The two have less than a factor e of wavenumbers in common.

    Notes
    -----
    A power law without roll-off leaves gamma_T to the levels alone, C_along/C_across = gamma_T^(-2 H); scans should
    therefore reach the roll-off. C_0 is the geometric mean of both where both are known, else the one that is.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> found = leak.stretched_roughness(along=spectrum, across=spectrum)
    >>> round(found.peklenik, 6), round(found.misfit, 6)
    (1.0, 0.0)
    """
    from scipy.optimize import minimize_scalar

    limit = np.log(MOST_STRETCHED)
    room = min(np.log(along.q_high / across.q_low), np.log(across.q_high / along.q_low)) - _LEAST_OVERLAP
    common = min(along.q_high, across.q_high) / max(along.q_low, across.q_low)
    if not room > 0.0 or np.log(common) < _LEAST_OVERLAP:
        raise SpectrumError(
            f"along from {along.q_low:.4g} to {along.q_high:.4g} 1/m and across from {across.q_low:.4g} to "
            f"{across.q_high:.4g} 1/m: need a factor e of common wavenumbers"
        )
    trials = min(limit, room) * np.linspace(-1.0, 1.0, 201)
    errors = _mismatch(along, across, trials)
    best = int(np.argmin(errors))
    bounds = trials[max(best - 1, 0)], trials[min(best + 1, trials.size - 1)]
    fit = minimize_scalar(
        lambda at: float(_mismatch(along, across, np.array([at]))[0]),
        bounds=bounds,
        method="bounded",
        options={"xatol": 1e-10},
    )
    # equal spectra are exactly isotropic
    log_gamma, error = min((float(trials[best]), errors[best]), (fit.x, fit.fun), key=lambda pair: pair[1])
    gamma = float(np.exp(log_gamma))
    root = np.sqrt(gamma)
    first = PowerSpectrum(along.wavenumber * root, along.density / gamma)
    second = PowerSpectrum(across.wavenumber / root, across.density * gamma)
    average = stretched_spectrum(_join_means(first, second), gamma)
    return StretchedRoughness(average, gamma, float(np.sqrt(error)))


def _mismatch(along: PowerSpectrum, across: PowerSpectrum, log_gamma: FloatArray) -> FloatArray:
    """Mean square of ln[gamma^2 C_across(gamma q)/C_along(q)] over the common wavenumbers, for each ln gamma."""
    gamma = np.exp(log_gamma)
    low, high = np.maximum(along.q_low, across.q_low / gamma), np.minimum(along.q_high, across.q_high / gamma)
    inset = 1e-12 * (high - low)
    log_q = np.linspace(np.log(low + inset), np.log(high - inset), _COMPARED_NODES, axis=-1)
    shift = log_gamma[:, None]
    log_ratio = 2.0 * shift + across.log_density(log_q + shift) - along.log_density(log_q)
    return np.asarray(np.vecdot(log_ratio, log_ratio) / _COMPARED_NODES)


def _join_means(first: PowerSpectrum, second: PowerSpectrum) -> PowerSpectrum:
    """Geometric mean where both are known, else the one that is."""
    q = np.union1d(first.wavenumber, second.wavenumber)
    ranges = [(q >= C.q_low) & (q <= C.q_high) for C in (first, second)]
    logs = [np.log(np.where(holds, C(q), 1.0)) for holds, C in zip(ranges, (first, second), strict=True)]
    return PowerSpectrum(q, np.exp(sum(logs) / (ranges[0].astype(float) + ranges[1])))
