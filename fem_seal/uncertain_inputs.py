"""The inputs of a case that are not known exactly: their random values, and the surface that belongs to them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.case_uncertainty import Spread
    from leak import PowerSpectrum, RoughContact
    from leak.self_affine_fit import TrueHeight

FloatArray = NDArray[np.float64]

# A normal distribution is cut off here, in standard deviations.
_NORMAL_END = 3.0
# The long waves of a measured surface end at eight times its roll-off, in ln q; their ln C changes by this at most.
_TRANSITION, _MOST_CHANGED = float(np.log(8.0)), 12.0
# A scatter of ln height that no leak rate shows.
_SMALLEST = 0.01
# Keys of a self-affine spectrum that change its shape.
SHAPE = ("hurst", "q_rolloff", "q_high")


@dataclass(frozen=True)
class UncertainInput:
    """One input that varies by a random factor.

    Parameters
    ----------
    name : str
        Key in [uncertainty].
    distribution : {"lognormal", "normal", "uniform"}
    relative : float
        Width, see `fem_seal.case_uncertainty.Spread`.
    """

    name: str
    distribution: str
    relative: float

    @classmethod
    def of(cls, name: str, spread: Spread) -> UncertainInput:
        """The input of a table entry."""
        return cls(name, spread.distribution, spread.relative)

    @property
    def dimensions(self) -> int:
        """Number of random numbers that it takes."""
        return 1

    def values(self, uniform: FloatArray) -> FloatArray:
        """Factors from numbers between 0 and 1, shape (n, 1) to (n, 1)."""
        from scipy.special import ndtr, ndtri

        if self.distribution == "uniform":
            return 1.0 + self.relative * (2.0 * uniform - 1.0)
        if self.distribution == "lognormal":
            return np.exp(self.relative * ndtri(uniform))
        # cut off where the factor would become negative, if that comes first
        end = min(_NORMAL_END, 0.99 / self.relative)
        outside = ndtr(-end)
        return 1.0 + self.relative * ndtri(outside + uniform * (1.0 - 2.0 * outside))

    def scores(self, values: FloatArray) -> FloatArray:
        """Variable in which a leak rate is a smooth function: ln of the factor."""
        return np.log(values)


@dataclass(frozen=True)
class UncertainScans:
    """The spectrum, from the differences between n scans: their mean with random weights.

    The weights are uniform over all sets of n positive numbers with sum one (Bayesian bootstrap): what else the mean
    of n scans could have been.

    Parameters
    ----------
    name : {"spectrum", "seat", "closure"}
        Which spectrum of the case it is.
    scans : tuple of PowerSpectrum
        One of each scan; two or more.

    References
    ----------
    D. B. Rubin, Ann. Stat. 9, 130 (1981).
    """

    name: str
    scans: tuple[PowerSpectrum, ...]

    @property
    def dimensions(self) -> int:
        """Number of random numbers that it takes."""
        return len(self.scans) - 1

    def values(self, uniform: FloatArray) -> FloatArray:
        """Weights from numbers between 0 and 1, by breaking a stick; shape (n, scans - 1) to (n, scans)."""
        left = len(self.scans) - 1 - np.arange(self.dimensions)
        rest = (1.0 - uniform) ** (1.0 / left)
        before = np.cumprod(np.column_stack([np.ones(len(uniform)), rest]), axis=1)
        return np.asarray(before * np.column_stack([1.0 - rest, np.ones(len(uniform))]), dtype=float)

    def scores(self, values: FloatArray) -> FloatArray:
        """Variables in which a leak rate is a smooth function: all weights but the last."""
        return values[:, :-1]

    def spectrum(self, weights: FloatArray) -> PowerSpectrum:
        """Mean spectrum with weights, shape (scans,)."""
        return weighted_mean(self.scans, weights)


@dataclass(frozen=True, eq=False)
class UncertainHeight:
    """The long waves of a measured surface, of which scans of finite length hold a random number.

    Parameters
    ----------
    key : {"spectrum", "seat", "closure", "along", "across"}
        Which spectrum of the case it is.
    name : str
    height : leak.self_affine_fit.TrueHeight
        Rms height of the surface over that of its scans.
    rolloff : float
        Waves down to this wavenumber make the difference; those shorter than an eighth of its wave none [1/m].
    share : float
        Share of the variance of ln height that the differences between the scans do not show already.
    """

    key: str
    name: str
    height: TrueHeight
    rolloff: float
    share: float = 1.0

    @property
    def dimensions(self) -> int:
        """Number of random numbers that it takes."""
        return 1

    def values(self, uniform: FloatArray) -> FloatArray:
        """Factors on the rms height from numbers between 0 and 1, shape (n, 1) to (n, 1)."""
        middle = float(np.log(self.height.quantile([0.5])[0]))
        return np.exp(middle + np.sqrt(self.share) * (np.log(self.height.quantile(uniform)) - middle))

    def scores(self, values: FloatArray) -> FloatArray:
        """Variable in which a leak rate is a smooth function: ln of the factor."""
        return np.log(values)

    def spectrum(self, measured: PowerSpectrum, factor: float) -> PowerSpectrum:
        """The measured spectrum with its long waves changed so that the rms height is `factor` times what it was."""
        from scipy.optimize import brentq

        from leak import PowerSpectrum

        q = np.union1d(measured.wavenumber, np.geomspace(measured.q_low, measured.q_high, 60)[1:-1])
        C = np.asarray(measured(q))
        long_waves = np.clip(1.0 - np.log(q / self.rolloff) / _TRANSITION, 0.0, 1.0)

        def changed(log_C: float) -> PowerSpectrum:
            return PowerSpectrum(q, C * np.exp(log_C * long_waves))

        def off(log_C: float) -> float:
            return float(np.log(changed(log_C).rms_height / measured.rms_height / factor))

        end = _MOST_CHANGED * float(np.sign(np.log(factor)))
        if end == 0.0:
            return measured
        # what the short waves alone have is the least
        return changed(float(brentq(off, 0.0, end, rtol=1e-9)) if off(0.0) * off(end) < 0.0 else end)


def weighted_mean(spectra: Sequence[PowerSpectrum], weights: FloatArray) -> PowerSpectrum:
    """Weighted mean of spectra.

    Parameters
    ----------
    spectra : sequence of PowerSpectrum
    weights : ndarray
        One for each; those of 1e-6 or less are left out.
    """
    parts = [
        scaled(one, float(np.sqrt(weight)))
        for one, weight in zip(spectra, weights, strict=True)
        if weight > 1e-6
    ]
    return reduce(lambda total, one: total + one, parts)


def scaled(spectrum: PowerSpectrum, factor: float) -> PowerSpectrum:
    """Spectrum of a surface with all heights times a factor."""
    from leak import PowerSpectrum

    return spectrum if factor == 1 else PowerSpectrum(spectrum.wavenumber, spectrum.density * factor**2)


AnyInput = UncertainInput | UncertainScans | UncertainHeight


def uncertain_inputs(case: Case) -> tuple[AnyInput, ...]:
    """The uncertain inputs of a case, in the order of its table, and last what its scans are too short to show.

    Parameters
    ----------
    case : Case
        With a table [uncertainty].
    """
    assert case.uncertainty is not None
    inputs: list[AnyInput] = [
        UncertainInput.of(name, spread) for name, spread in case.uncertainty.spreads.items()
    ]
    if case.uncertainty.spectrum is not None:
        inputs += [UncertainScans(key, scans) for key, scans in scan_spectra(case).items()]
    return (*inputs, *uncertain_heights(case))


def uncertain_heights(case: Case) -> Iterator[UncertainHeight]:
    """What the length of the scans leaves open, for each measured spectrum of the case.

    Parameters
    ----------
    case : Case
    """
    from fem_seal.case_roughness import Measured

    parts = {} if case.roughness is None else case.roughness.parts
    measured = {key: one for key, one in parts.items() if isinstance(one, Measured)}
    between_scans = case.uncertainty is not None and case.uncertainty.spectrum is not None
    for key, one in measured.items():
        surface = one.measured()
        low, high = surface.rolloff.height.interval
        if np.log(high / low) < _SMALLEST:
            continue
        # random weights scatter the mean of n scans by (n-1)/(n+1) of its true variance
        count = len(one.paths)
        yield UncertainHeight(
            key,
            "scan_length" if len(measured) == 1 else f"scan_length_{key}",
            surface.rolloff.height,
            surface.rolloff.wavenumber or surface.q_low,
            2.0 / (count + 1.0) if between_scans else 1.0,
        )


def scan_spectra(case: Case) -> dict[str, tuple[PowerSpectrum, ...]]:
    """Spectra of the single scans, for each spectrum of the case that is the mean of two or more.

    Parameters
    ----------
    case : Case
    """
    from fem_seal.case_roughness import Measured

    parts = {} if case.roughness is None else case.roughness.parts
    return {
        key: one.scan_spectra()
        for key, one in parts.items()
        if isinstance(one, Measured) and len(one.paths) > 1
    }


def self_affine_part(case: Case) -> str | None:
    """Key of the case's self-affine spectrum; None if there is none, or one for each surface."""
    from fem_seal.case_roughness import SelfAffine

    parts = {} if case.roughness is None else case.roughness.parts
    found = [key for key, one in parts.items() if isinstance(one, SelfAffine)]
    return found[0] if len(found) == 1 else None


def changed_surface(
    case: Case,
    surface: RoughContact,
    factors: Mapping[str, float],
    means: Mapping[str, PowerSpectrum] | None = None,
) -> RoughContact:
    """The rough contact with some of its inputs changed.

    Parameters
    ----------
    case : Case
    surface : RoughContact
        The case's own.
    factors : mapping
        Factor of each uncertain input by its key.
    means : mapping, optional
        Spectra that stand instead of the case's own, by their key in [roughness].
    """
    means = dict(means or {})
    if any(key in factors for key in SHAPE):
        key = self_affine_part(case)
        assert key is not None
        means[key] = _reshaped(case, key, factors)
    spectrum, peklenik = surface.spectrum, surface.peklenik
    if means:
        assert case.roughness is not None
        spectrum, peklenik = case.roughness.combined(means)
    hardness = surface.hardness
    return replace(
        surface,
        spectrum=scaled(spectrum, factors.get("rms_height", 1.0)),
        effective_modulus=surface.effective_modulus * factors.get("youngs_modulus", 1.0),
        hardness=None if hardness is None else hardness * factors.get("hardness", 1.0),
        peklenik=peklenik,
    )


def _reshaped(case: Case, key: str, factors: Mapping[str, float]) -> PowerSpectrum:
    """Self-affine spectrum with other exponent or ends and the same rms height."""
    from fem_seal.case_roughness import SelfAffine
    from leak import PowerSpectrum

    assert case.roughness is not None
    given = case.roughness.parts[key]
    assert isinstance(given, SelfAffine)
    q_high = given.q_high * factors.get("q_high", 1.0)
    q_high = max(q_high, given.q_rolloff, 1.001 * given.q_low)
    return PowerSpectrum.self_affine(
        rms_height=given.rms_height,
        hurst=min(max(given.hurst * factors.get("hurst", 1.0), 0.01), 1.0),
        q_low=given.q_low,
        q_rolloff=min(max(given.q_rolloff * factors.get("q_rolloff", 1.0), given.q_low), q_high),
        q_high=q_high,
    )
