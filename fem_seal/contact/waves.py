"""What both bodies answer to a line load that waves around the axis."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.model import ContactModel


@dataclass(frozen=True)
class Stiffening:
    """c_n - c_0: by how much less a contact opens under a line load that waves n times than under an even one.

    c_n is the opening under the line load w(x) cos(n phi), weighted with w(x), the share of the line load that each
    place of the width carries. The axisymmetric compliance is on the same mesh, and the logarithm that makes both
    depend on w cancels.

    Parameters
    ----------
    model : ContactModel
    pressure : ndarray, shape (m,)
        At the points of the contact line; only its shape counts.
    highest : int
        Harmonic beyond which the bodies are taken to answer as half-spaces do, from what they answer to this one.
    """

    model: ContactModel
    pressure: FloatArray = field(repr=False)
    highest: int

    def __call__(self, n: int) -> float:
        """c_n - c_0 [m per N/m]; of n = 1 that of a guided closure.

        Parameters
        ----------
        n : int
        """
        if n > self.highest:
            return self._beyond + self._half_spaces(n)
        return float(self._forces @ self._opening(n)) / self._forces.sum()

    def bend(self, n: int) -> float:
        """By how much a line load that waves n times bends the gap across the width, in (x - x_mean)^2 [1/m per N/m].

        None of it where the bodies answer as half-spaces do: such harmonics are weak.

        Parameters
        ----------
        n : int
        """
        if n > self.highest:
            return 0.0
        share, x = self._forces / self._forces.sum(), self.model.line.x
        parabola = (x - share @ x) ** 2
        parabola = parabola - share @ parabola
        return float((share * parabola) @ self._opening(n) / ((share * parabola) @ parabola))

    def _opening(self, n: int) -> FloatArray:
        """By how much more the gap opens under the n-th harmonic than under an even line load [m per N/m]."""
        model, forces = self.model, self._forces
        opening = -(model.compliance @ forces)
        for harmonic in model.harmonics:
            opening = opening + harmonic.opening(n, forces)
        return np.asarray(opening)

    @cached_property
    def _beyond(self) -> float:
        """By how much the bodies differ from half-spaces at the highest harmonic of their own [m per N/m]."""
        return self(self.highest) - self._half_spaces(self.highest)

    @cached_property
    def _forces(self) -> FloatArray:
        """Forces at the points of the contact line that make a line load of one [N per N/m]."""
        forces = self.model.line.area_weight * self.pressure
        return forces * (2 * math.pi * self.model.touch_radius / forces.sum())

    @cached_property
    def std(self) -> float:
        """Standard deviation of the pressure over x [m]."""
        share, x = self._forces / self._forces.sum(), self.model.line.x
        return math.sqrt(share @ x**2 - (share @ x) ** 2)

    def _half_spaces(self, n: int) -> float:
        """(2/(pi E*)) <K0(n |x - x'|/r0)> of a normal distribution."""
        t = 0.5 * (n * self.std / self.model.touch_radius) ** 2
        from scipy.special import k0e

        return float(k0e(t)) / (math.pi * self.model.effective_modulus)
