"""Leak rate of a given pressure profile: the second half of a case, without its contact calculation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem_seal.errors import InputError, Problem
from fem_seal.fluid_flow import flow_table, leak_of_profile
from fem_seal.interface import rough_contact
from fem_seal.leakage import leakage
from fem_seal.profile import PressureProfile
from fem_seal.results import GivenContact, GivenLoad
from fem_seal.tables import VALIDITY_COLUMNS, validity_entries, with_text, write_rows_csv
from fem_seal.validity import profile_validity

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.profile_file import ImportedProfile
    from leak import ConductivityTable, GasConductivityTable, LeakResult, RoughContact

FloatArray = NDArray[np.float64]

COLUMNS = (
    "fluid_pressure_Pa",
    "peak_pressure_Pa",
    "leak_rate_m3_per_s",
    "leak_rate_elastic_m3_per_s",
    "critical_separation_m",
    "critical_separation_elastic_m",
    "leak_rate_kg_per_s",
    "leak_rate_Pa_m3_per_s",
)
# Radii of a profile that this program wrote are those of its seat up to the digits of the file.
_SAME_RADIUS = 1e-7


def leak_of_profiles(case: Case, profiles: Sequence[ImportedProfile]) -> list[dict[str, Any]]:
    """Leak rates of imported pressure profiles with the surface and the fluid of a case.

    Parameters
    ----------
    case : Case
        Its roughness, fluid and leak tables are used, and its seat where a profile has no radius.
    profiles : sequence of ImportedProfile
        A profile with its own fluid pressure gives one row, one without gives a row for each fluid pressure
        of the case.

    Returns
    -------
    list of dict
        Rows with `COLUMNS`, as in leak.csv, and their validity, as far as a profile without its bodies tells it.

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
        _row(case, surface, profile, (plastic, elastic), fluid_pressure)
        for profile in profiles
        for fluid_pressure in (
            [profile.fluid_pressure] if profile.fluid_pressure else dict.fromkeys(case.load.fluid_pressure)
        )
    ]


def _row(
    case: Case,
    surface: RoughContact,
    profile: ImportedProfile,
    tables: Sequence[ConductivityTable | GasConductivityTable],
    fluid_pressure: float,
) -> dict[str, Any]:
    peak = float(profile.pressure.max())
    leak, elastic = (_leak(case, profile, table, fluid_pressure) for table in tables)
    found = leakage(case, fluid_pressure, float(leak.leak_rate))
    separation = float(surface.critical_separation(peak))
    load = GivenLoad(fluid_pressure, GivenContact(_profile(case, profile)), leak, separation)
    values = (
        fluid_pressure,
        peak,
        float(leak.leak_rate),
        float(elastic.leak_rate),
        separation,
        float(surface.elastic.critical_separation(peak)),
        *(math.nan if value is None else value for value in (found.mass_flow, found.throughput)),
    )
    row = dict[str, Any](zip(COLUMNS, values, strict=True))
    return row | validity_entries(profile_validity(case, surface, load))


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


def write_rows(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write rows as a CSV file; OutputError if it cannot be written."""
    write_rows_csv(path, (*COLUMNS, *VALIDITY_COLUMNS), [list(with_text(row).values()) for row in rows])
