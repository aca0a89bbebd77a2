"""The inputs of a case that are not known exactly: their random values, and the surface that belongs to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.case_uncertainty import Spread
    from leak import PowerSpectrum, RoughContact

FloatArray = NDArray[np.float64]

# A normal distribution is cut off here, in standard deviations.
_NORMAL_END = 3.0
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


def uncertain_inputs(case: Case) -> tuple[UncertainInput | UncertainScans, ...]:
    """The uncertain inputs of a case, in the order of its table.

    Parameters
    ----------
    case : Case
        With a table [uncertainty].
    """
    assert case.uncertainty is not None
    inputs: list[UncertainInput | UncertainScans] = [
        UncertainInput.of(name, spread) for name, spread in case.uncertainty.spreads.items()
    ]
    if case.uncertainty.spectrum is not None:
        inputs += [UncertainScans(key, scans) for key, scans in scan_spectra(case).items()]
    return tuple(inputs)


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
