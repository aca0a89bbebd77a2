"""Roughness values of profiles: the filters of ISO 16610-21, and the parameters of ISO 21920-2.

Of a spectrum they are expected, of measured heights calculated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ScanError, SpectrumError, positive
from leak.files import own_tables
from leak.numerics.curves import divide_stretches
from leak.numerics.integrals import gauss_panels
from leak.surfaces.scans import HeightMap, LineScan, Topography
from leak.surfaces.spectrum import PowerSpectrum

_CLASSES: list[dict[str, float]] = own_tables("leak.surfaces", "setting_classes.toml")["classes"]
# Ra over Rq of Gaussian heights.
RA_OVER_RQ = math.sqrt(2.0 / math.pi)
# A value on the limit of a class belongs to it, however its unit was converted.
_ON_THE_LIMIT = 1.0 + 1e-9
# Sampling lengths in an evaluation length.
SECTIONS = 5
# Pieces of ln q, nodes in each, and directions of the quadrature: 1e-4 of the height of any self-affine spectrum.
_PIECE, _NODES, _ANGLES = 0.35, 5, 256


@dataclass(frozen=True)
class ProfileFilter:
    """Gaussian filters of ISO 16610-21 that leave the roughness of a profile: waves between lambda_s and lambda_c.

    Each has the transmission 1/2 at its cutoff.

    Parameters
    ----------
    lambda_c : float
        Longer waves are taken off [m].
    lambda_s : float
        Shorter waves are taken off; 0: none [m].

    Raises
    ------
    SpectrumError
        Unless 0 <= lambda_s < lambda_c.

    Examples
    --------
    >>> band = ProfileFilter(0.8e-3, 2.5e-6)
    >>> print(f"{band.transmission(2 * np.pi / 0.8e-3):.3f} {band.transmission(2 * np.pi / 2.5e-6):.3f}")
    0.500 0.500
    """

    lambda_c: float
    lambda_s: float = 0.0

    def __post_init__(self) -> None:
        positive(SpectrumError, "lambda_c", self.lambda_c, "m")
        if not 0.0 <= self.lambda_s < self.lambda_c:
            raise SpectrumError(
                f"lambda_s = {self.lambda_s}: must be shorter than lambda_c = {self.lambda_c} [m]"
            )

    def transmission(self, wavenumber: ArrayLike) -> FloatArray:
        """Amplitude of a wave after both filters over the one before, G = (1 - 2^-(lambda_c/l)^2) 2^-(lambda_s/l)^2.

        Parameters
        ----------
        wavenumber : array_like
            q = 2 pi/l along the profile [1/m].
        """
        per_length = np.asarray(wavenumber, dtype=float) / (2.0 * np.pi)
        long_waves = -np.expm1(-math.log(2.0) * (self.lambda_c * per_length) ** 2)
        return np.asarray(long_waves * np.exp2(-((self.lambda_s * per_length) ** 2)))


def implied_filter(parameter: str, value: float) -> ProfileFilter:
    """Filter with which a value on a drawing is measured if the drawing does not say more: setting classes by size.

    Parameters
    ----------
    parameter : "Ra", "Rq" or "Rz"
        Rq is taken for the Ra of Gaussian heights, Ra = sqrt(2/pi) Rq.
    value : float
        [m]

    References
    ----------
    ISO 21920-3:2021, default settings for Ra and Rz.

    Examples
    --------
    >>> implied_filter("Ra", 0.4e-6)
    ProfileFilter(lambda_c=0.0008, lambda_s=2.5e-06)
    """
    size = positive(SpectrumError, parameter, value, "m")
    limit, scale = ("Rz", 1.0) if parameter == "Rz" else ("Ra", RA_OVER_RQ if parameter == "Rq" else 1.0)
    row = next(row for row in _CLASSES if size * scale <= row[limit] * _ON_THE_LIMIT)
    return ProfileFilter(row["lambda_c"], row["lambda_s"])


@dataclass(frozen=True)
class ExpectedRoughness:
    """Roughness values expected of a Gaussian surface, right across its lay.

    Parameters
    ----------
    Rq : float
        [m]
    waves : float
        Waves of the filtered profile in a sampling length: mean number of crossings of its mean line upwards [-].
    filter : ProfileFilter

    Examples
    --------
    >>> print(f"{ExpectedRoughness(1e-6, 20.0, ProfileFilter(0.8e-3)).Ra * 1e6:.4f} um")
    0.7979 um
    """

    Rq: float
    waves: float
    filter: ProfileFilter

    @property
    def Ra(self) -> float:
        """sqrt(2/pi) Rq, of Gaussian heights [m]."""
        return RA_OVER_RQ * self.Rq

    @property
    def Rz(self) -> float:
        """Highest peak plus deepest valley of a sampling length, on average [m].

        Maxima of a Gaussian process with N waves are about sqrt(2 ln N) + 0.5772/sqrt(2 ln N) standard deviations high.

        References
        ----------
        A. G. Davenport, Proc. Inst. Civ. Eng. 28, 187 (1964).
        """
        reach = math.sqrt(2.0 * math.log(max(self.waves, 2.0)))
        return 2.0 * self.Rq * (reach + np.euler_gamma / reach)

    def value(self, parameter: str) -> float:
        """One of them by its name, "Ra", "Rq" or "Rz" [m]."""
        return {"Ra": self.Ra, "Rq": self.Rq, "Rz": self.Rz}[parameter]


def expected_roughness(spectrum: PowerSpectrum, band: ProfileFilter) -> ExpectedRoughness:
    """What a filtered profile across an isotropic Gaussian surface has on average.

    Rq^2 = 2 int_0^inf C_1D(q) G(q)^2 dq, here with the integral of C_1D over the other direction done first:
    Rq^2 = int q C(q) int_0^(2 pi) G(q cos phi)^2 dphi dq.

    Parameters
    ----------
    spectrum : PowerSpectrum
        C of the surface [m^4].
    band : ProfileFilter

    Examples
    --------
    >>> surface = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> whole = expected_roughness(surface, ProfileFilter(1.0))
    >>> print(f"{whole.Rq / surface.rms_height:.4f}")
    1.0000
    """
    ends = divide_stretches(np.log(np.unique(spectrum.wavenumber)), _PIECE)
    log_q, weight = (values.ravel() for values in gauss_panels(ends, _NODES))
    q = np.exp(log_q)
    share = (np.arange(_ANGLES) + 0.5) / _ANGLES
    q_along = q[:, None] * np.cos(0.5 * np.pi * share)
    power = band.transmission(q_along) ** 2
    heights = 2.0 * np.pi * np.asarray(spectrum(q)) * q**2 * weight
    variance = float(heights @ power.mean(axis=1))
    slope2 = float(heights @ (power * q_along**2).mean(axis=1))
    waves = math.sqrt(slope2 / variance) / (2.0 * math.pi) * band.lambda_c if variance > 0.0 else 0.0
    return ExpectedRoughness(math.sqrt(variance), waves, band)


# -------------------------------------------------------------------- measured profiles

# alpha of the Gaussian weighting function, for a transmission of 1/2 at the cutoff.
_ALPHA = math.sqrt(math.log(2.0) / math.pi)
# The weighting function ends where it is this small.
_REACH = 1.0
# At each end of a scan this share of lambda_c is left out: there the filter has one side only.
_RUN_IN = 0.5
# Points that the shortest filter must see in its cutoff.
_FEWEST_IN_CUTOFF = 2.0
# Lines of a map that are evaluated at most.
_MOST_LINES = 64


@dataclass(frozen=True)
class RoughnessParameters:
    """Roughness parameters of profiles, means over all profiles of a surface.

    Parameters
    ----------
    Ra, Rq : float
        Arithmetic and root mean square of the heights of the filtered profile, over the evaluation length [m].
    Rz : float
        Highest peak plus deepest valley of a section, mean over the sections [m].
    Rsk, Rku : float
        Skewness and kurtosis of the heights, 0 and 3 for Gaussian ones, 1.5 for a sine [-].
    filter : ProfileFilter
        lambda_s is 0 where the points lie too far apart for it.
    sections : int
        Sections of the length lambda_c in each profile, five by the standard; 0 if the scan is shorter than one, and
        Rz is then that of the whole profile.
    length : float
        That was evaluated of each profile [m].
    profiles : int
    remarks : tuple of str
        What departs from the standard.

    Examples
    --------
    >>> import leak
    >>> x = np.arange(20_000) * 0.5e-6
    >>> wave = leak.line_scan(x, 1e-6 * np.sin(2 * np.pi * x / 40e-6))
    >>> found = roughness_parameters([wave], ProfileFilter(0.8e-3, 2.5e-6))
    >>> print(f"{found.Ra * 1e6:.3f} {found.Rq * 1e6:.3f} {found.Rz * 1e6:.2f} {found.Rku:.2f}")
    0.635 0.705 1.99 1.50
    """

    Ra: float
    Rq: float
    Rz: float
    Rsk: float
    Rku: float
    filter: ProfileFilter
    sections: int
    length: float
    profiles: int
    remarks: tuple[str, ...] = ()


def roughness_parameters(
    scans: Sequence[Topography], band: ProfileFilter | None = None
) -> RoughnessParameters:
    """Parameters of profiles through scans; of a map along x and along y, and the larger Ra counts.

    Parameters
    ----------
    scans : sequence of LineScan or HeightMap
        Without form.
    band : ProfileFilter, optional
        By the size of Ra itself unless given (ISO 21920-3): the filter whose result lies in its own class.

    Raises
    ------
    ScanError
        No scan.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> x, h = leak.random_line_scan(spectrum, length=0.02, points=20_000, seed=1)
    >>> found = leak.roughness_parameters([leak.line_scan(x, h)])
    >>> found.filter.lambda_c, found.sections
    (0.0008, 5)
    """
    if not scans:
        raise ScanError("no scan: give at least one")
    if band is not None:
        return _parameters_across(scans, band)
    # each pass may ask for a longer cutoff; a scan too short for it ends the search
    parameters = _parameters_across(scans, implied_filter("Ra", 1e-9))
    for _ in range(5):
        longer = implied_filter("Ra", max(parameters.Ra, 1e-12))
        if longer.lambda_c <= parameters.filter.lambda_c:
            break
        parameters = _parameters_across(scans, longer)
    return parameters


def _parameters_across(scans: Sequence[Topography], band: ProfileFilter) -> RoughnessParameters:
    """Profiles of each direction on their own; the direction with the larger Ra crosses the lay."""
    directions = [list(_profiles(scans, axis)) for axis in (0, 1)]
    means = [_mean([_evaluate(h, step, band) for h, step in lines]) for lines in directions if lines]
    return max(means, key=lambda parameters: parameters.Ra)


def _profiles(scans: Sequence[Topography], axis: int) -> list[tuple[FloatArray, float]]:
    """Heights and spacing of the profiles along an axis; line scans have one direction, which counts as both."""
    lines: list[tuple[FloatArray, float]] = []
    for scan in scans:
        if isinstance(scan, LineScan):
            lines.append((scan.heights, scan.spacing))
        elif isinstance(scan, HeightMap):
            heights = scan.heights if axis == 0 else scan.heights.T
            stride = -(-heights.shape[1] // _MOST_LINES)
            lines += [(heights[:, n], scan.spacing[axis]) for n in range(0, heights.shape[1], stride)]
    return lines


def _mean(parts: Sequence[RoughnessParameters]) -> RoughnessParameters:
    first = parts[0]
    mean = {
        name: float(np.mean([getattr(part, name) for part in parts]))
        for name in ("Ra", "Rq", "Rz", "Rsk", "Rku")
    }
    shortest = min(parts, key=lambda part: part.length)
    remarks = tuple(dict.fromkeys(text for part in parts for text in part.remarks))
    return RoughnessParameters(
        **mean,
        filter=first.filter,
        sections=min(part.sections for part in parts),
        length=shortest.length,
        profiles=len(parts),
        remarks=remarks,
    )


def _evaluate(heights: FloatArray, step: float, band: ProfileFilter) -> RoughnessParameters:
    remarks = []
    if band.lambda_s > 0.0 and band.lambda_s < _FEWEST_IN_CUTOFF * step:
        remarks.append(
            f"the points lie {step * 1e6:.3g} um apart, too far for the filter lambda_s = "
            f"{band.lambda_s * 1e6:.3g} um, which is left out"
        )
        band = ProfileFilter(band.lambda_c)
    profile = filtered_profile(heights, step, band)
    # where not even two points lie within the cutoff there is no section
    run, section = round(_RUN_IN * band.lambda_c / step), max(round(band.lambda_c / step), 1)
    count = (profile.size - 2 * run) // section
    if count < 1:
        remarks.append(
            f"the scan is {heights.size * step * 1e3:.3g} mm long, too short for one section of "
            f"{band.lambda_c * 1e3:.3g} mm between run-in and run-out: the values are those of the whole scan and too "
            "small"
        )
        heights_used, parts = profile, [profile]
    else:
        count = min(count, SECTIONS)
        start = (profile.size - count * section) // 2
        heights_used = profile[start : start + count * section]
        parts = list(heights_used.reshape(count, section))
        if count < SECTIONS:
            remarks.append(
                f"the scan holds {count} of the {SECTIONS} sections of {band.lambda_c * 1e3:.3g} mm"
            )
    heights_used = heights_used - heights_used.mean()
    Rq = float(np.sqrt(np.mean(heights_used**2)))
    return RoughnessParameters(
        float(np.mean(np.abs(heights_used))),
        Rq,
        float(np.mean([part.max() - part.min() for part in parts])),
        float(np.mean(heights_used**3)) / Rq**3 if Rq > 0.0 else math.nan,
        float(np.mean(heights_used**4)) / Rq**4 if Rq > 0.0 else math.nan,
        band,
        max(count, 0),
        heights_used.size * step,
        1,
        tuple(remarks),
    )


def filtered_profile(heights: FloatArray, spacing: float, band: ProfileFilter) -> FloatArray:
    """The roughness profile: heights smoothed over lambda_s less the same smoothed over lambda_c.

    At both ends the part of the weighting function that lies inside the profile is scaled to one.

    Parameters
    ----------
    heights : ndarray, shape (n,)
        [m]
    spacing : float
        Distance of neighbouring points [m].
    band : ProfileFilter

    Returns
    -------
    ndarray, shape (n,)
        [m]

    References
    ----------
    ISO 16610-21: s(x) = exp(-pi (x/(alpha lambda))^2)/(alpha lambda), alpha = sqrt(ln 2/pi).
    """
    fine = _smooth(heights, spacing, band.lambda_s) if band.lambda_s > 0.0 else np.asarray(heights)
    return np.asarray(fine - _smooth(fine, spacing, band.lambda_c), dtype=np.float64)


def _smooth(heights: FloatArray, spacing: float, cutoff: float) -> FloatArray:
    from scipy.signal import fftconvolve

    if not spacing > 0.0:
        raise SpectrumError(f"spacing = {spacing}: must be positive [m]")
    reach = min(max(int(_REACH * cutoff / spacing), 1), heights.size - 1)
    at = np.arange(-reach, reach + 1) * spacing / (_ALPHA * cutoff)
    weight = np.exp(-np.pi * at**2)
    level = float(np.mean(heights))
    inside_weight = fftconvolve(np.ones(heights.size), weight, mode="same")
    return np.asarray(level + fftconvolve(heights - level, weight, mode="same") / inside_weight)
