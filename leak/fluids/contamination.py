"""Solid particles in a fluid: how many of them there are of each size."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import FluidError

# ISO 4406:2021, table 1: upper end of the range of each scale number from 0 on, particles per ml. The lower end is
# the upper one of the number before; that of 0 is nought, for which half of the upper end stands, as in all others.
_UP_TO = (
    *(0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64, 1.3, 2.5, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0, 640.0),
    *(1300.0, 2500.0, 5e3, 1e4, 2e4, 4e4, 8e4, 1.6e5, 3.2e5, 6.4e5, 1.3e6, 2.5e6),
)
# Sizes that the three scale numbers count, at least so large: by an automatic counter [m].
_COUNTER = (4e-6, 6e-6, 14e-6)
# The same under a microscope, where the first one is a dash.
_MICROSCOPE = (5e-6, 15e-6)
_PER_ML = 1e6
# So far below the first size the line is continued: a decade, over which dusts are known to follow it.
_REACH = 10.0


class Concentration(NamedTuple):
    """Particles per volume of fluid, each shape (n,) [1/m^3].

    Examples
    --------
    >>> import leak
    >>> print(f"{leak.ParticleCounts.of_iso_4406('18/16/13').at_least(4e-6).low[0]:.3g}")
    1.3e+09
    """

    low: FloatArray
    """As few as the numbers allow."""
    likely: FloatArray
    """Geometric mean of both ends."""
    high: FloatArray
    """As many as they allow."""


@dataclass(frozen=True)
class ParticleCounts:
    """Number of particles at least as large as some sizes, as an interval.

    ln N is linear in ln d between the sizes: the cumulative counts of dusts and worn-off particles are close to power
    laws over the range of a counter. Beyond both ends the line goes on with the slope between first and last size,
    that of the interval's ends with the steepest or flattest line that the counts allow: an extrapolation, which says
    less the further it goes. Below a tenth of the first size nothing is said.

    Parameters
    ----------
    sizes : tuple of float
        d, increasing [m].
    low, high : tuple of float
        Particles per volume at least as large, positive and nowhere rising with the size [1/m^3].
    largest : float, optional
        Size above which an absolute filter has taken all particles [m]; none unless given.

    Raises
    ------
    FluidError

    Examples
    --------
    >>> import leak
    >>> dust = leak.ParticleCounts.of_counts([2e-6, 10e-6], [5e9, 1e8])
    >>> [f"{number:.3g}" for number in dust.at_least([1e-6, 4e-6, 20e-6]).likely]
    ['2.7e+10', '9.27e+08', '1.85e+07']
    """

    sizes: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    largest: float = np.inf

    def __post_init__(self) -> None:
        sizes, low, high = map(np.asarray, (self.sizes, self.low, self.high))
        if not (len(sizes) == len(low) == len(high) >= 2):
            raise FluidError(
                f"{len(sizes)} sizes, {len(low)} and {len(high)} counts: needs as many, at least 2"
            )
        if not (np.all(sizes > 0) and np.all(np.diff(sizes) > 0) and np.all(np.isfinite(sizes))):
            raise FluidError(f"sizes = {self.sizes}: must be positive and increase [m]")
        if not (np.all(low > 0) and np.all(low <= high) and np.all(np.isfinite(high))):
            raise FluidError(f"counts from {self.low} to {self.high}: must be positive and finite [1/m^3]")
        if np.any(np.diff(low) > 0) or np.any(np.diff(high) > 0):
            raise FluidError(
                "counts rise with the size: those at least as large as a size include all larger ones"
            )
        if not self.largest > 0:
            raise FluidError(f"largest = {self.largest}: must be positive [m]")

    @classmethod
    def of_counts(cls, sizes: ArrayLike, counts: ArrayLike, largest: float = np.inf) -> ParticleCounts:
        """Counts without an interval.

        Parameters
        ----------
        sizes, counts : array_like, shape (n,)
            Sizes [m], and particles at least as large per volume [1/m^3].
        largest : float, optional
            See `ParticleCounts`.
        """
        at, number = (tuple(np.atleast_1d(np.asarray(x, dtype=float)).tolist()) for x in (sizes, counts))
        return cls(at, number, number, largest)

    @classmethod
    def of_iso_4406(cls, code: str, largest: float = np.inf) -> ParticleCounts:
        """Counts behind a code of ISO 4406.

        Parameters
        ----------
        code : str
            "18/16/13": scale numbers of the particles of at least 4, 6 and 14 um per ml, by an automatic counter;
            "-/16/13": of at least 5 and 15 um, by a microscope.
        largest : float, optional
            See `ParticleCounts`.

        References
        ----------
        ISO 4406:2021, Hydraulic fluid power - Fluids - Method for coding the level of contamination by solid
        particles.

        Examples
        --------
        >>> import leak
        >>> leak.ParticleCounts.of_iso_4406("-/16/13").sizes
        (5e-06, 1.5e-05)
        """
        match = re.fullmatch(r"\s*(\d{1,2}|-)\s*/\s*(\d{1,2})\s*/\s*(\d{1,2})\s*", code)
        if match is None:
            raise FluidError(f'ISO 4406 code = {code!r}: must be three scale numbers such as "18/16/13"')
        numbers = [int(group) for group in match.groups() if group != "-"]
        if max(numbers) >= len(_UP_TO):
            raise FluidError(f"ISO 4406 code = {code!r}: scale numbers go from 0 to {len(_UP_TO) - 1}")
        if any(larger > smaller for smaller, larger in pairwise(numbers)):
            raise FluidError(
                f"ISO 4406 code = {code!r}: no scale number may exceed the one before; "
                "larger particles are among the smaller ones"
            )
        sizes = _COUNTER if len(numbers) == 3 else _MICROSCOPE
        ranges = [(_UP_TO[n - 1] if n else 0.5 * _UP_TO[0], _UP_TO[n]) for n in numbers]
        low, high = (tuple(_PER_ML * number for number in ends) for ends in zip(*ranges, strict=True))
        return cls(sizes, low, high, largest)

    @property
    def smallest(self) -> float:
        """Size down to which the counts are continued [m]."""
        return self.sizes[0] / _REACH

    def at_least(self, size: ArrayLike) -> Concentration:
        """Particles of at least some sizes.

        Parameters
        ----------
        size : array_like, shape (n,)
            Positive [m].

        Returns
        -------
        Concentration
            NaN below `smallest`.
        """
        d = np.atleast_1d(np.asarray(size, dtype=float))
        low, high = (np.where(d < self.smallest * (1.0 - 1e-9), np.nan, count) for count in self._bounds(d))
        if np.isfinite(self.largest):
            cuts = self._bounds(np.array([self.largest]))
            # what the filter takes is as uncertain as what it leaves: the same counts, low or high
            low, high = (np.maximum(n - cut, 0.0) for n, cut in zip((low, high), cuts, strict=True))
        return Concentration(low, np.sqrt(low * high), high)

    def _bounds(self, d: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Both ends without a filter."""
        x, at = np.log(self.sizes), np.log(d)
        low, high = np.log(self.low), np.log(self.high)
        width = x[-1] - x[0]
        flattest, steepest = max((low[0] - high[-1]) / width, 0.0), (high[0] - low[-1]) / width
        undershoot, overshoot = np.minimum(at - x[0], 0.0), np.maximum(at - x[-1], 0.0)
        return (
            np.exp(np.interp(at, x, low) - flattest * undershoot - steepest * overshoot),
            np.exp(np.interp(at, x, high) - steepest * undershoot - flattest * overshoot),
        )
