"""Lower and upper bound of a number."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

# Ratio of leak rates up to which they are told as one number.
AGREE = 1.005


class Bounds(NamedTuple):
    """The ends of an interval.

    Parameters
    ----------
    low, high : float
        In the unit of the number.

    Examples
    --------
    >>> Bounds.of([3.0, 1.0, 2.0]).widened(Bounds.factor_bounds(2.0))
    Bounds(low=0.5, high=6.0)
    """

    low: float
    high: float

    @classmethod
    def of(cls, values: Iterable[float]) -> Bounds:
        """The smallest and the largest of some values; NaN if one of them is.

        Parameters
        ----------
        values : iterable of float
            One at least.
        """
        known = np.array(list(values), dtype=float)
        return cls(float(known.min()), float(known.max()))

    @classmethod
    def factor_bounds(cls, factor: float) -> Bounds:
        """Factors of what may be so many times too large or too small.

        Parameters
        ----------
        factor : float
            One at least.
        """
        return cls(1.0 / factor, factor)

    @property
    def apart(self) -> bool:
        """Whether both ends are read as two numbers."""
        return not self.high <= AGREE * self.low

    def widened(self, by: tuple[float, float]) -> Bounds:
        """Each end times its factor.

        Parameters
        ----------
        by : tuple of float
            Least and most.
        """
        return Bounds(self.low * by[0], self.high * by[1])

    def ratio_to(self, by: tuple[float, float]) -> Bounds:
        """What was widened by these factors.

        Parameters
        ----------
        by : tuple of float
            Least and most.
        """
        return Bounds(self.low / by[0], self.high / by[1])


EXACT = Bounds(1.0, 1.0)
"""Factors of what is off by nothing."""
