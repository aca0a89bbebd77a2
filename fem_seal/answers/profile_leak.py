"""Leak rates of given contact pressure profiles: of this program, or of any finite-element code."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.case_load import CaseLoad, case_loads
from fem_seal.answers.profile_files import ImportedProfile
from fem_seal.errors import InputError
from fem_seal.files import problem as problem_of
from fem_seal.profile import PressureProfile, join_lands
from fem_seal.seal.leak_model import Conductivity, FlowModel, LeakModel
from fem_seal.seal.load_result import GivenContact, LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.scenarios import with_own_contacts
from fem_seal.validity.checks import profile_validity
from meshes import ContactGeometry

if TYPE_CHECKING:
    from leak.flow.turned_contact import FaceContact

# Radii of a profile that this program wrote are those of its seat up to the digits of the file.
_SAME_RADIUS = 1e-7
# Peak contact pressure over fluid pressure below which a profile is refused: units are wrong by 1e-3 or 1e-6 and seals
# press several times harder than their fluid.
_FAR_TOO_WEAK = 1e-2


def leak_of_profiles(problem: SealProblem, profiles: Sequence[ImportedProfile]) -> list[CaseLoad]:
    """Leak rates of imported pressure profiles with the surface and the fluid of a problem.

    Parameters
    ----------
    problem : SealProblem
        Its surface and flow are used, and its contact where a profile has no radius.
    profiles : sequence of ImportedProfile
        A profile with its own fluid pressure gives one load, one without gives a load for each fluid pressure
        of the problem.

    Returns
    -------
    list of CaseLoad
        With their validity, as far as a profile without its bodies tells it.

    Raises
    ------
    InputError
        If the problem has no roughness or no fluid.
    """
    surface, flow = leaking(problem)
    peaks = [float(profile.pressure.max()) for profile in profiles]
    contacts = [_profile(problem.contact, profile) for profile in profiles]
    rough = LeakModel(surface, flow, GivenPressures(tuple(contacts)))
    fluid_pressures = _fluid_pressures(problem, profiles)
    refuse_far_too_weak(problem, peaks, fluid_pressures)
    given_loads = [
        LoadResult(fluid_pressure, 0.0, GivenContact(contact), rough)  # type: ignore[arg-type]
        for contact, pressures in zip(contacts, fluid_pressures, strict=True)
        for fluid_pressure in pressures
    ]
    loads = with_all_scenarios(problem, given_loads)
    return [load.with_values(validity=profile_validity(problem, load)) for load in loads]


def ring_of(profiles: Sequence[ImportedProfile]) -> tuple[float, float]:
    """Radii of a ring where the first profile presses, for a case without shapes [m].

    Parameters
    ----------
    profiles : sequence of ImportedProfile
        With their radii.
    """
    profile = profiles[0]
    radius, pressed = profile.radius, profile.pressure > 1e-3 * profile.pressure.max()
    assert radius is not None  # of profiles without a seat
    middle = float(np.average(radius, weights=profile.pressure))
    half = middle - float(radius[pressed].min()) or 1e-3 * middle
    return middle - half, middle + half


def leaking(problem: SealProblem) -> tuple[FaceContact, FlowModel]:
    """Surface and flow of a problem, for contacts that are given; InputError if it lacks one, or asks for bodies.

    Parameters
    ----------
    problem : SealProblem
    """
    surface, flow = problem.surface, problem.flow
    if surface is None or flow is None:
        names = [name for name, value in (("roughness", surface), ("fluid", flow)) if value is None]
        raise InputError(*(problem_of("profile_without", name=name) for name in names), file=problem.file)
    if problem.loads.preparation:
        raise InputError(problem_of("profile_load_before"), file=problem.file)
    if problem.form is not None:
        key = "load.bending_moment" if problem.form.moment else "form"
        raise InputError(problem_of("profile_form", key=key), file=problem.file)
    return surface, flow


def with_all_scenarios(problem: SealProblem, given_loads: Sequence[LoadResult]) -> list[CaseLoad]:
    """Loads on given contacts with all scenarios beside them.

    Parameters
    ----------
    problem : SealProblem
    given_loads : sequence of LoadResult
    """
    loads = case_loads(problem, given_loads)
    for scenario in with_own_contacts(problem):
        # the force is not known, and the contact the same for all
        others = case_loads(scenario.problem, scenario.on_contacts(given_loads))
        loads = [load.with_scenarios({scenario.name: alt}) for load, alt in zip(loads, others, strict=True)]
    return loads


def _fluid_pressures(problem: SealProblem, profiles: Sequence[ImportedProfile]) -> list[Sequence[float]]:
    """Fluid pressures of each profile: its own, that of the load of the same number, or all of the case [Pa]."""
    of_case = list(dict.fromkeys(problem.loads.fluid_pressure))
    count = sum(profile.fluid_pressure is None for profile in profiles)
    if count == 1 == len(profiles):
        return [of_case]
    if count == len(profiles) == len(of_case):
        return [[pressure] for pressure in of_case]
    if count:
        counts = {"steps": len(profiles), "loads": len(of_case)}
        raise InputError(problem_of("profile_pressures", **counts), file=problem.file)
    return [[profile.fluid_pressure] for profile in profiles if profile.fluid_pressure]


def refuse_far_too_weak(
    problem: SealProblem, peaks: Sequence[float], fluid_pressures: Sequence[Sequence[float]]
) -> None:
    """Refuse contacts none of which comes near its fluid pressure: pascals for megapascals.

    Parameters
    ----------
    problem : SealProblem
    peaks : sequence of float
        Of each contact [Pa].
    fluid_pressures : sequence of sequence of float
        Of each contact [Pa].
    """
    if all(peak < _FAR_TOO_WEAK * min(loads) for peak, loads in zip(peaks, fluid_pressures, strict=True)):
        peak = max(peaks)
        loads = fluid_pressures[peaks.index(peak)]
        raise InputError(problem_of("far_too_weak", peak=peak, pressure=min(loads)), file=problem.file)


@dataclass(frozen=True, eq=False)
class GivenPressures:
    """Flow conductivity over all pressures of given contacts.

    Parameters
    ----------
    contacts : tuple of PressureProfile
    others : tuple of float
        Highest pressures of others, between whose points the pressure may be any up to sealing [Pa].
    """

    contacts: tuple[PressureProfile, ...] = ()
    others: tuple[float, ...] = ()

    def __call__(self, flow: FlowModel, surface: FaceContact) -> Conductivity:
        """The table of a flow and a surface."""
        peaks = [*(float(contact.at_rest(surface).pressure.max()) for contact in self.contacts), *self.others]
        # nine decades below the peak the resistance is less than one part in a million of the whole
        ends = [*peaks, surface.sealing_pressure] if self.others else peaks
        return flow.table(surface, 1e-9 * min(peaks), 1.01 * max(ends))


def _ends(contact: ContactGeometry, profile: ImportedProfile) -> tuple[float | None, float | None]:
    """Where the faces end, if the profile is one on its seat: with the x of this program, or its radii."""
    ends, x = contact.reach, profile.x
    if not ends[0] <= x[0] < x[-1] <= ends[1]:
        return None, None
    if profile.radius is None:
        return ends
    same = np.allclose(profile.radius, contact.radius(x), rtol=_SAME_RADIUS, atol=0.0)
    return ends if same else (None, None)


def _profile(contact: ContactGeometry, profile: ImportedProfile) -> PressureProfile:
    """The profile with weights of the trapezoidal rule, its lands parted by chambers; nothing is known of its gap."""
    x, ends = profile.x, _ends(contact, profile)
    radius = contact.radius(x) if profile.radius is None else profile.radius
    middles = x.searchsorted(contact.chambers)
    parts = [rows for rows in np.split(np.arange(len(x)), middles) if len(rows) > 1]
    lands = []
    for number, rows in enumerate(parts):
        land_x = x[rows]
        steps = np.diff(land_x, prepend=land_x[0], append=land_x[-1])
        outer = ends[0] if number == 0 else None, ends[1] if number == len(parts) - 1 else None
        weight, gap = 0.5 * (steps[1:] + steps[:-1]), np.full(len(rows), math.nan)
        strain = None if profile.strain is None else profile.strain[rows]
        points = land_x, radius[rows], profile.pressure[rows], gap, weight
        lands.append(PressureProfile(*points, outer, strain=strain))
    return join_lands(lands)
