"""Flow of a case's fluid through any contact pressure of the case, with a table that grows with the pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.contact_size import Opening, contact_width
from fem_seal.fluid_flow import flow_table, leak_of_profile
from fem_seal.interface import rough_contact
from fem_seal.laws import Law
from fem_seal.load_limits import refused_loads
from fem_seal.loads import expected_force, line_load
from fem_seal.profile import PressureProfile

if TYPE_CHECKING:
    from fem_seal.case import Case
    from leak import LeakResult, RoughContact

# Points of a Gaussian profile, and how far it reaches in standard deviations.
_POINTS, _REACH = 121, 5.0
_TABLE_POINTS = 80
# Decades between the highest pressure and the end of the table.
_MARGIN = 0.3


def expected_forces(case: Case) -> list[float]:
    """Force F_N that the solid contact is expected to carry at each load that can be calculated [N].

    With closing "sealed-area" it is the force, with "penetration" an estimate.

    Parameters
    ----------
    case : Case
    """
    load, refused = case.load, refused_loads(case)
    return [
        expected_force(case.touch_radius, pressure, spring, load.pressure_side, load.closing)
        for number, (pressure, spring) in enumerate(load.points)
        if number not in refused
    ]


@dataclass(frozen=True)
class CaseFlow:
    """Leak rates of contacts of a case with roughness and fluid.

    Parameters
    ----------
    case : Case
    law : Law
        Between contact pressure and gap.
    """

    case: Case
    law: Law

    def leak(self, profile: PressureProfile, fluid_pressure: float) -> LeakResult:
        """Flow through a contact at a pressure difference [Pa]."""
        low, high = self._expected_peaks
        # Whole decades, so that neighbouring contacts share one table; below it the low-pressure law goes on, above it
        # two more decades at a time.
        top, peak = math.ceil(high + _MARGIN), math.log10(profile.pressure.max()) + _MARGIN
        p_min, p_max = 10.0 ** math.floor(low - 6), 10.0 ** (top + 2 * max(0, math.ceil((peak - top) / 2)))
        table = flow_table(self.case, self.surface, p_min, p_max, _TABLE_POINTS)
        return leak_of_profile(
            self.case, table, profile.x, profile.pressure, fluid_pressure, profile.radius, profile.ends
        )

    @cached_property
    def surface(self) -> RoughContact:
        """The rough contact of the case."""
        surface = rough_contact(self.case)
        assert surface is not None
        return surface

    def expected_profile(self, contact_force: float) -> PressureProfile:
        """Gaussian with the line load and the expected width of a contact that carries a force F_N [N]."""
        contact = self.case.contact
        f = line_load(contact_force, contact.touch_radius, contact.angle)
        std = contact_width(self.law, f, self._opening, self.case.effective_modulus).std
        x = std * np.linspace(-_REACH, _REACH, _POINTS)
        pressure = f / (math.sqrt(2 * math.pi) * std) * np.exp(-0.5 * (x / std) ** 2)
        radius = np.maximum(contact.touch_radius + x * math.cos(contact.angle), 0.1 * contact.touch_radius)
        return PressureProfile(x, radius, pressure, np.full_like(x, np.nan), np.gradient(x))

    @cached_property
    def _opening(self) -> Opening:
        return Opening.of(self.case.contact)

    @cached_property
    def _expected_peaks(self) -> tuple[float, float]:
        """Decimal logarithms of the smallest and the largest peak pressure that is expected [Pa]."""
        peaks = [
            math.log10(self.expected_profile(force).pressure.max()) for force in expected_forces(self.case)
        ]
        return min(peaks), max(peaks)
