"""Random inputs: distributions and Sobol' points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fem_seal.arrays import FloatArray

# Normal and lognormal inputs of a study are not drawn further out than this many standard deviations: a hardness has
# no tail down to zero.
CUT_OFF = 4.0


@dataclass(frozen=True)
class _BoundedSpread:
    """Values between two bounds.

    Parameters
    ----------
    low, high : float
        Bounds, low < high [SI]; positive for `LogUniform`.
    """

    low: float
    high: float

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest value."""
        return self.low, self.high


class Uniform(_BoundedSpread):
    """Every value between two bounds alike."""

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return self.low + (self.high - self.low) * share


class LogUniform(_BoundedSpread):
    """Every ratio between two positive bounds alike."""

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return np.clip(self.low * np.exp(math.log(self.high / self.low) * share), self.low, self.high)


@dataclass(frozen=True)
class Normal:
    """Gauss's distribution without its tails.

    Parameters
    ----------
    mean, std : float
        [SI].
    cut_off : float
        Where it is cut off, in standard deviations.
    """

    mean: float
    std: float
    cut_off: float = CUT_OFF

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return self.mean + self.std * _scores(share, self.cut_off)

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest value."""
        return self.mean - self.cut_off * self.std, self.mean + self.cut_off * self.std


@dataclass(frozen=True)
class LogNormal:
    """The logarithm is normal without its tails.

    Parameters
    ----------
    median : float
        [SI].
    relative : float
        Standard deviation of the logarithm; for small ones the relative standard deviation [-].
    cut_off : float
        Where it is cut off, in standard deviations of the logarithm.
    """

    median: float
    relative: float
    cut_off: float = CUT_OFF

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return self.median * np.exp(self.relative * _scores(share, self.cut_off))

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest value."""
        factor = math.exp(self.cut_off * self.relative)
        return self.median / factor, self.median * factor


Distribution = Uniform | LogUniform | Normal | LogNormal


def _scores(share: FloatArray, cut_off: float) -> FloatArray:
    from scipy.special import ndtri

    return np.clip(ndtri(np.clip(share, 0.0, 1.0)), -cut_off, cut_off)


# A normal factor of an interval is cut off here, in standard deviations.
_NORMAL_END = 3.0


@dataclass(frozen=True)
class UncertainInput:
    """One input that varies by a random factor.

    Parameters
    ----------
    name : str
        Key in [uncertainty].
    distribution : {"lognormal", "normal", "uniform"}
    relative : float
        Width, see `fem_seal.case.tables.Spread`.
    """

    name: str
    distribution: str
    relative: float

    dimensions: ClassVar[int] = 1
    """Number of random numbers that it takes."""

    def values(self, uniform: FloatArray) -> FloatArray:
        """Factors from numbers between 0 and 1, shape (n, 1) to (n, 1)."""
        if self.distribution == "uniform":
            return Uniform(1.0 - self.relative, 1.0 + self.relative).quantile(uniform)
        if self.distribution == "lognormal":
            return LogNormal(1.0, self.relative, cut_off=math.inf).quantile(uniform)
        from scipy.special import ndtr

        # cut off where the factor would become negative, if that comes first; what is outside is drawn anew
        end = min(_NORMAL_END, 0.99 / self.relative)
        tail = ndtr(-end)
        return Normal(1.0, self.relative, cut_off=end).quantile(tail + uniform * (1.0 - 2.0 * tail))

    def reported_values(self, values: FloatArray) -> FloatArray:
        """The factors, shape (n,)."""
        return values[:, 0]


def sobol_points(samples: int, dimensions: int, seed: int) -> FloatArray:
    """Scrambled Sobol points inside the unit cube, shape (samples, dimensions)."""
    import warnings

    from scipy.stats.qmc import Sobol

    with warnings.catch_warnings():
        # another number than a power of two is balanced less well, but is what the user asked for
        warnings.simplefilter("ignore", UserWarning)
        points = Sobol(dimensions, scramble=True, seed=seed).random(samples)
    return np.clip(points, 1e-9, 1 - 1e-9)
