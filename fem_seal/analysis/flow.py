"""Flow of the case's fluid through a rough contact, for any pressure profile."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fem_seal.analysis.problem import expected_forces, rough_contact
from fem_seal.analysis.results import GivenContact, GivenLoad
from fem_seal.analysis.warnings import profile_validity
from fem_seal.arrays import FloatArray
from fem_seal.contact.laws import Law
from fem_seal.contact.sizing import Opening, contact_width
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import InputError, Problem
from fem_seal.loads import line_load
from fem_seal.profile import PressureProfile
from leak import (
    ConductivityTable,
    GasConductivityTable,
    LeakResult,
    RoughContact,
    coupled_leak_flow,
    gas_conductivity_table,
    gas_leak_flow,
    leak_flow,
)

if TYPE_CHECKING:
    from fem_seal.analysis.profile_file import ImportedProfile
    from fem_seal.case.case import Case


def flow_table(
    case: Case, surface: RoughContact, p_min: float, p_max: float, num: int = 64
) -> ConductivityTable | GasConductivityTable:
    """Flow conductivity of a surface for the case's fluid over a range of contact pressures.

    Parameters
    ----------
    case : Case
        With a fluid.
    surface : RoughContact
    p_min, p_max : float
        [Pa]
    num : int
        Number of pressures.
    """
    method = case.leak.conductivity
    if case.fluid is not None and case.fluid.gas is not None:
        return gas_conductivity_table(surface, p_min, p_max, num, method)
    return surface.conductivity_table(p_min, p_max, num, method=method)


def leak_of_profile(
    case: Case,
    table: ConductivityTable | GasConductivityTable,
    x: ArrayLike,
    pressure: ArrayLike,
    fluid_pressure: float,
    radius: ArrayLike,
    ends: tuple[float | None, float | None] | None = None,
) -> LeakResult:
    """Leak of a pressure profile with the case's fluid.

    Parameters
    ----------
    case : Case
    table : ConductivityTable or GasConductivityTable
        From `flow_table`.
    x, pressure : array_like
        Arc length [m] and contact pressure [Pa].
    fluid_pressure : float
        Pressure difference [Pa].
    radius : float or array_like
        [m]
    ends : tuple of float or None, optional
        x at which the faces end, see `leak.leak_flow` [m].

    Returns
    -------
    LeakResult
        A `leak.CoupledLeakResult` for leak.fluid_in_gap = "local".
    """
    fluid, side = case.fluid, case.load.pressure_side
    assert fluid is not None
    if isinstance(table, ConductivityTable):
        flow = coupled_leak_flow if case.leak.fluid_in_gap == "local" else leak_flow
        sigma = table.at(fluid.viscosity)
        found = flow(x, pressure, sigma, fluid_pressure, radius, pressure_side=side, ends=ends)
        return found.with_density(fluid.density)
    gas, outlet = fluid.gas, fluid.outlet_pressure
    assert gas is not None and outlet is not None
    inlet = outlet + fluid_pressure
    return gas_leak_flow(
        x, pressure, table, gas, inlet, outlet, radius, pressure_side=side, ends=ends
    ).above_outlet


def conductivity_table(
    case: Case, surface: RoughContact, contacts: Sequence[ContactSolution], num: int = 80
) -> ConductivityTable | GasConductivityTable:
    """Flow conductivity of a surface over all pressures that occur in the contacts.

    The range reaches six decades below the smallest peak, where the table goes on by the low-pressure law. It is
    rounded out to whole decades, so that neighbouring contacts share one table.
    """
    peaks = [math.log10(contact.pressure.max()) for contact in contacts]
    low, high = math.floor(min(peaks) - 6), math.ceil(max(peaks) + 0.3)
    return flow_table(case, surface, 10.0**low, 10.0**high, num)


def leak_of_contact(
    case: Case,
    table: ConductivityTable | GasConductivityTable,
    contact: ContactSolution,
    fluid_pressure: float,
) -> LeakResult:
    """Leak of one contact with the case's fluid.

    Parameters
    ----------
    case : Case
    table : ConductivityTable or GasConductivityTable
        From `conductivity_table`, for all pressures of the contact.
    contact : ContactSolution
    fluid_pressure : float
        Pressure difference [Pa].
    """
    profile = contact.profile
    return leak_of_profile(
        case, table, profile.x, profile.pressure, fluid_pressure, profile.radius, profile.ends
    )


# Points of a Gaussian profile, and how far it reaches in standard deviations.
_POINTS, _REACH = 121, 5.0
_TABLE_POINTS = 80
# Decades between the highest pressure and the end of the table.
_MARGIN = 0.3


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


# Radii of a profile that this program wrote are those of its seat up to the digits of the file.
_SAME_RADIUS = 1e-7


def leak_of_profiles(case: Case, profiles: Sequence[ImportedProfile]) -> list[GivenLoad]:
    """Leak of imported pressure profiles with the surface and the fluid of a case.

    Parameters
    ----------
    case : Case
        Its roughness, fluid and leak tables are used, and its seat where a profile has no radius.
    profiles : sequence of ImportedProfile
        A profile with its own fluid pressure gives one load, one without gives a load for each fluid pressure
        of the case.

    Returns
    -------
    list of GivenLoad

    Raises
    ------
    InputError
        If the case has no roughness or no fluid.
    """
    surface = rough_contact(case)
    missing = [
        name for name, table in (("roughness", case.roughness), ("fluid", case.fluid)) if table is None
    ]
    if surface is None or case.fluid is None:
        raise InputError(
            *(Problem(name, f"is missing; a leak rate needs a table [{name}]") for name in missing),
            file=case.file,
        )
    peaks = [float(profile.pressure.max()) for profile in profiles]
    plastic, elastic = (_conductivity(case, one, peaks) for one in (surface, surface.elastic))
    return [
        _given_load(case, surface, profile, (plastic, elastic), fluid_pressure)
        for profile in profiles
        for fluid_pressure in (
            [profile.fluid_pressure] if profile.fluid_pressure else dict.fromkeys(case.load.fluid_pressure)
        )
    ]


def _given_load(
    case: Case,
    surface: RoughContact,
    profile: ImportedProfile,
    tables: Sequence[ConductivityTable | GasConductivityTable],
    fluid_pressure: float,
) -> GivenLoad:
    peak = float(profile.pressure.max())
    leak, elastic = (_leak(case, profile, table, fluid_pressure) for table in tables)
    separation, without = (float(one.critical_separation(peak)) for one in (surface, surface.elastic))
    contact = GivenContact(_profile(case, profile))
    load = GivenLoad(fluid_pressure, contact, leak, elastic, separation, without)
    return replace(load, validity=profile_validity(case, surface, load))


def _conductivity(
    case: Case, surface: RoughContact, peaks: Sequence[float]
) -> ConductivityTable | GasConductivityTable:
    """Flow conductivity over all pressures of the profiles."""
    # nine decades below the peak the resistance is less than one part in a million of the whole
    return flow_table(case, surface, 1e-9 * min(peaks), 1.01 * max(peaks))


def _leak(
    case: Case,
    profile: ImportedProfile,
    table: ConductivityTable | GasConductivityTable,
    fluid_pressure: float,
) -> LeakResult:
    ends = _ends(case, profile)
    radius = _radius(case, profile)
    return leak_of_profile(case, table, profile.x, profile.pressure, fluid_pressure, radius, ends)


def _ends(case: Case, profile: ImportedProfile) -> tuple[float, float] | None:
    """Where the faces of the case end, if the profile is one on its seat: with the x of this program, or its radii."""
    ends, x = case.contact.reach, profile.x
    if not ends[0] <= x[0] < x[-1] <= ends[1]:
        return None
    if profile.radius is None:
        return ends
    same = np.allclose(profile.radius, case.contact.radius(x), rtol=_SAME_RADIUS, atol=0.0)
    return ends if same else None


def _radius(case: Case, profile: ImportedProfile) -> FloatArray:
    return case.contact.radius(profile.x) if profile.radius is None else profile.radius


def _profile(case: Case, profile: ImportedProfile) -> PressureProfile:
    """The profile with weights of the trapezoidal rule; nothing is known of its gap."""
    x, ends = profile.x, np.diff(profile.x, prepend=profile.x[0], append=profile.x[-1])
    return PressureProfile(
        x, _radius(case, profile), profile.pressure, np.full(len(x), math.nan), 0.5 * (ends[1:] + ends[:-1])
    )
