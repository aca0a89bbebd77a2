"""Interface laws of a contact: compliant, or hard."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

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
    height : float
        Ratio of the heights.
    log_pressure : float
        Logarithm of the ratio of the products of modulus and height.
    """

    law: InterfaceLaw
    height: float
    log_pressure: float

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""
        return self.height * self.law.gap(log_pressure - self.log_pressure)

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""
        return self.height * self.law.decay_length(log_pressure - self.log_pressure)
