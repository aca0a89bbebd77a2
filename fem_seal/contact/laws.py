"""What a contact can be solved with: a compliant interface law, or hard contact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fem_seal.arrays import FloatArray


class InterfaceLaw(Protocol):
    """p(u) of two rough surfaces, as separation over the logarithm of the pressure."""

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""


@dataclass(frozen=True)
class HardContact:
    """Smooth surfaces: p >= 0, gap >= 0, p gap = 0.

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.HardContact()
    HardContact()
    """


Law = InterfaceLaw | HardContact


@dataclass(frozen=True)
class ScaledLaw:
    """The law of one surface from that of another one of the same shape.

    Parameters
    ----------
    law : InterfaceLaw
        Which answers for each pressure of an array alone, as that of a rough surface does.
    height : float
        Ratio of the heights.
    pressure : float
        Ratio of the products of modulus and height.
    """

    law: InterfaceLaw
    height: float
    pressure: float

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""
        return self.height * self.law.gap(log_pressure - math.log(self.pressure))

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""
        return self.height * self.law.decay_length(log_pressure - math.log(self.pressure))


@dataclass(frozen=True)
class LawOfRows:
    """Laws of the same shape, the n-th for the n-th row of an array of pressures.

    Parameters
    ----------
    law : InterfaceLaw
    height, log_pressure : ndarray, shape (laws, 1)
        Ratios as of a `ScaledLaw`, of the second one its logarithm. Of shape (laws,) the n-th law is that of the n-th
        column.
    """

    law: InterfaceLaw
    height: FloatArray
    log_pressure: FloatArray

    @classmethod
    def of(cls, laws: Sequence[InterfaceLaw]) -> LawOfRows:
        """Of one law, or of several `alike`."""
        ratios = np.array(
            [
                (one.height, math.log(one.pressure)) if isinstance(one, ScaledLaw) else (1.0, 0.0)
                for one in laws
            ]
        )
        return cls(shape_of(laws[0]), ratios[:, :1], ratios[:, 1:])

    @property
    def each(self) -> LawOfRows:
        """The same laws, each for a column."""
        return LawOfRows(self.law, self.height[:, 0], self.log_pressure[:, 0])

    def rows(self, chosen: NDArray[np.bool_]) -> LawOfRows:
        """Of some of the rows."""
        return LawOfRows(self.law, self.height[chosen], self.log_pressure[chosen])

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""
        return self.height * self.law.gap(log_pressure - self.log_pressure)

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""
        return self.height * self.law.decay_length(log_pressure - self.log_pressure)


def shape_of(law: InterfaceLaw) -> InterfaceLaw:
    """The law of which a law is a scaled one; itself if it is none."""
    return law.law if isinstance(law, ScaledLaw) else law
