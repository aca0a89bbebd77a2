"""The band in which a roughness value is measured: Gaussian profile filters, and the cutoffs that a value implies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import SpectrumError, positive
from leak.files import own_tables
from leak.numerics.gauss import gauss
from leak.numerics.sampling import divided
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
_EULER = 0.5772156649015329


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
    found = next(one for one in _CLASSES if size * scale <= one[limit] * _ON_THE_LIMIT)
    return ProfileFilter(found["lambda_c"], found["lambda_s"])


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
        far = math.sqrt(2.0 * math.log(max(self.waves, 2.0)))
        return 2.0 * self.Rq * (far + _EULER / far)

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
        C of the surface.
    band : ProfileFilter

    Examples
    --------
    >>> surface = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> whole = expected_roughness(surface, ProfileFilter(1.0))
    >>> print(f"{whole.Rq / surface.rms_height:.4f}")
    1.0000
    """
    ends = divided(np.log(np.unique(spectrum.wavenumber)), _PIECE)
    t, w = gauss(_NODES)
    half = 0.5 * np.diff(ends)[:, None]
    q = np.exp(ends[:-1, None] + half * (1.0 + t)).ravel()
    weight = (half * w).ravel()
    share = (np.arange(_ANGLES) + 0.5) / _ANGLES
    along = q[:, None] * np.cos(0.5 * np.pi * share)
    power = band.transmission(along) ** 2
    heights = 2.0 * np.pi * np.asarray(spectrum(q)) * q**2 * weight
    variance = float(heights @ power.mean(axis=1))
    slope2 = float(heights @ (power * along**2).mean(axis=1))
    waves = math.sqrt(slope2 / variance) / (2.0 * math.pi) * band.lambda_c if variance > 0.0 else 0.0
    return ExpectedRoughness(math.sqrt(variance), waves, band)
