"""What a contact can be solved with: a compliant interface law, or hard contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from fem_seal.arrays import FloatArray


class InterfaceLaw(Protocol):
    """p(u) of two rough surfaces, as separation over the logarithm of the pressure."""

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""
        ...

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""
        ...


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
