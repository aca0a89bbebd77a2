"""Flow through the contacts of a seal while their force is still looked for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.contact.sizing import Opening, contact_widths
from fem_seal.loads import line_load, plastic_half_width
from fem_seal.profile import PressureProfile, remembered
from fem_seal.seal.leak_model import MARGIN, Conductivity, Flow, ProfileFlow, as_first_loaded
from fem_seal.seal.problem import expected_forces

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.seal.problem import SealProblem
    from leak import LeakResult, RoughContact

# Points of a Gaussian profile, and how far it reaches in standard deviations.
_POINTS, _REACH = 121, 5.0


@dataclass(frozen=True)
class SealFlow:
    """Leak rates of any contacts of a seal, by tables over the range in which its loads are expected.

    Parameters
    ----------
    problem : SealProblem
        Of which the expected contacts are.
    surface : RoughContact
    flow : Flow
    """

    problem: SealProblem
    surface: RoughContact
    flow: Flow

    @classmethod
    def of(cls, problem: SealProblem) -> SealFlow | None:
        """The flow of a problem; None without roughness or fluid.

        Parameters
        ----------
        problem : SealProblem
        """
        if problem.surface is None or problem.flow is None:
            return None
        return cls(problem, problem.surface, problem.flow)

    def leak(self, profile: PressureProfile, fluid_pressure: float) -> LeakResult:
        """Flow through a contact at a pressure difference [Pa]."""
        return self.flow.leak_of(self._table(profile), self.surface, profile, fluid_pressure)

    def as_first_loaded(self, profile: PressureProfile, largest: FloatArray) -> PressureProfile:
        """Profile of first loading that lets as much through as a contact that was pressed harder before.

        Parameters
        ----------
        profile : PressureProfile
        largest : ndarray, shape (m,)
            Largest pressure that each place has carried before [Pa].
        """
        after = replace(profile, largest=remembered(profile.pressure, largest))
        return as_first_loaded(self._table(after), after)

    def leak_of(self, contact: ContactSolution, fluid_pressure: float) -> LeakResult:
        """Flow through a contact with the form error of the seal, at a pressure difference [Pa]."""
        from fem_seal.seal.circumference import LeakCurve

        formed = self.problem.around(contact)
        if formed is None:
            return self.leak(contact.profile, fluid_pressure)
        flow = ProfileFlow(
            lambda profile: self.leak(profile, fluid_pressure),
            lambda profile, grooves: self.flow.bounds(
                self._table(profile), self.surface, profile, fluid_pressure, grooves
            ),
            lambda pressure: self.flow.conductivity_at(
                self._table(formed.most_loaded.profile), pressure, fluid_pressure
            ),
        )
        found = formed.with_leak(LeakCurve(formed.local, flow)).leak
        assert found is not None  # it was asked for
        return found

    def _table(self, profile: PressureProfile) -> Conductivity:
        low, high = self._expected_peaks
        # below the range the low-pressure law goes on, above it two more decades at a time
        top, peak = math.ceil(high + MARGIN), math.log10(profile.highest) + MARGIN
        above = 2 * max(0, math.ceil((peak - top) / 2))
        return self.flow.table_around(self.surface, (low, high + above))

    def expected_profile(self, contact_force: float) -> PressureProfile:
        """Gaussian with the line load and the expected width of a contact that carries a force F_N [N].

        A body that yields is coined over the width of full plasticity at least.
        """
        contact = self.problem.contact
        ((std, peak),) = self._expected([contact_force])
        x = std * np.linspace(-_REACH, _REACH, _POINTS)
        pressure = peak * np.exp(-0.5 * (x / std) ** 2)
        radius = np.maximum(contact.touch_radius + x * math.cos(contact.angle), 0.1 * contact.touch_radius)
        return PressureProfile(x, radius, pressure, np.full_like(x, np.nan), np.gradient(x))

    def _expected(self, contact_forces: Sequence[float]) -> list[tuple[float, float]]:
        """Standard deviation [m] and peak [Pa] of the pressure of contacts that carry forces F_N [N]."""
        problem, contact = self.problem, self.problem.contact
        line_loads = [line_load(force, contact.touch_radius, contact.angle) for force in contact_forces]
        widths = contact_widths(problem.law, line_loads, Opening.of(contact), problem.effective_modulus)
        stds = [width.std for width in widths]
        if problem.curves:
            softest = min(curve.yield_stress for curve in problem.curves)
            # an even pressure over 2 a has the standard deviation a/sqrt(3)
            stds = [
                max(std, plastic_half_width(f, softest) / math.sqrt(3))
                for std, f in zip(stds, line_loads, strict=True)
            ]
        return [(std, f / (math.sqrt(2 * math.pi) * std)) for std, f in zip(stds, line_loads, strict=True)]

    @cached_property
    def _expected_peaks(self) -> tuple[float, float]:
        """Decimal logarithms of the smallest and the largest peak pressure that is expected [Pa]."""
        peaks = [math.log10(peak) for _, peak in self._expected(expected_forces(self.problem))]
        return min(peaks), max(peaks)
