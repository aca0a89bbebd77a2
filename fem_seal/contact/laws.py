"""Interface laws of a contact: compliant, or hard."""

from __future__ import annotations

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
    """The law of one surface, or of several, from that of another one of the same shape.

    Parameters
    ----------
    law : InterfaceLaw
        Which answers for each pressure of an array alone, as that of a rough surface does.
    height : float or ndarray, shape (laws,) or (laws, 1)
        Ratio of the heights; of several laws the n-th is that of the n-th column, or row, of an array of pressures.
    log_pressure : float or ndarray
        Logarithm of the ratio of the products of modulus and height.
    """

    law: InterfaceLaw
    height: float | FloatArray
    log_pressure: float | FloatArray

    @classmethod
    def of(cls, laws: Sequence[InterfaceLaw]) -> ScaledLaw:
        """Several laws of one shape, each for a column."""
        ratios = [
            (one.height, one.log_pressure) if isinstance(one, ScaledLaw) else (1.0, 0.0) for one in laws
        ]
        return cls(shape_of(laws[0]), *np.array(ratios).T)

    def rows(self, chosen: NDArray[np.bool_] | slice) -> ScaledLaw:
        """Some of several laws, each for a row."""
        height, log_pressure = (np.reshape(one, (-1, 1))[chosen] for one in (self.height, self.log_pressure))
        return ScaledLaw(self.law, height, log_pressure)

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""
        return self.height * self.law.gap(log_pressure - self.log_pressure)

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""
        return self.height * self.law.decay_length(log_pressure - self.log_pressure)


@dataclass(frozen=True)
class LawOfEach:
    """Several laws of any shape, the n-th for the n-th row of an array of pressures.

    Parameters
    ----------
    laws : sequence of InterfaceLaw
    """

    laws: Sequence[InterfaceLaw]

    def rows(self, chosen: NDArray[np.bool_]) -> LawOfEach:
        """Some of them."""
        return LawOfEach([self.laws[number] for number in chosen.nonzero()[0].tolist()])

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""
        return np.stack([law.gap(row) for law, row in zip(self.laws, log_pressure, strict=True)])

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""
        return np.stack([law.decay_length(row) for law, row in zip(self.laws, log_pressure, strict=True)])


def law_of_rows(laws: Sequence[InterfaceLaw]) -> ScaledLaw | LawOfEach:
    """Several laws, each for a row of an array of pressures; those of one shape are quicker.

    Parameters
    ----------
    laws : sequence of InterfaceLaw
    """
    alike = all(shape_of(law) is shape_of(laws[0]) for law in laws)
    return ScaledLaw.of(laws).rows(slice(None)) if alike else LawOfEach(laws)


def shape_of(law: InterfaceLaw) -> InterfaceLaw:
    """The law of which a law is a scaled one; itself if it is none."""
    return law.law if isinstance(law, ScaledLaw) else law
