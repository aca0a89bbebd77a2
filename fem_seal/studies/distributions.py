"""Distributions of parameters: from evenly spread numbers between 0 and 1 to values."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

FloatArray = NDArray[np.float64]

# Normal and lognormal values further out than this many standard deviations are not drawn: a hardness has no
# tail down to zero.
CUT_OFF = 4.0


@dataclass(frozen=True)
class Uniform:
    """Every value between two bounds alike.

    Parameters
    ----------
    low, high : float
        Bounds, low < high [SI].
    """

    low: float
    high: float

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return self.low + (self.high - self.low) * share

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest value."""
        return self.low, self.high


@dataclass(frozen=True)
class LogUniform:
    """Every ratio between two positive bounds alike.

    Parameters
    ----------
    low, high : float
        Bounds, 0 < low < high [SI].
    """

    low: float
    high: float

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return np.clip(self.low * np.exp(math.log(self.high / self.low) * share), self.low, self.high)

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest value."""
        return self.low, self.high


@dataclass(frozen=True)
class Normal:
    """Gauss's distribution, cut off at four standard deviations.

    Parameters
    ----------
    mean, std : float
        [SI].
    """

    mean: float
    std: float

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return self.mean + self.std * _scores(share)

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest value."""
        return self.mean - CUT_OFF * self.std, self.mean + CUT_OFF * self.std


@dataclass(frozen=True)
class LogNormal:
    """The logarithm is normal, cut off at four standard deviations.

    Parameters
    ----------
    median : float
        [SI].
    relative : float
        Standard deviation of the logarithm; for small ones the relative standard deviation [-].
    """

    median: float
    relative: float

    def quantile(self, share: FloatArray) -> FloatArray:
        """Value that a share of all values stays below."""
        return self.median * np.exp(self.relative * _scores(share))

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest value."""
        factor = math.exp(CUT_OFF * self.relative)
        return self.median / factor, self.median * factor


Distribution = Uniform | LogUniform | Normal | LogNormal


def _scores(share: FloatArray) -> FloatArray:
    return np.clip(ndtri(np.clip(share, 0.0, 1.0)), -CUT_OFF, CUT_OFF)
