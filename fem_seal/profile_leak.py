"""Leak rate of a given pressure profile: the second half of a case, without its contact calculation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.atomic_files import write_text
from fem_seal.errors import InputError, Problem
from fem_seal.fluid_flow import flow_table, leak_of_profile
from fem_seal.interface import rough_contact
from fem_seal.leakage import leakage

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.profile_file import ImportedProfile
    from leak import ConductivityTable, GasConductivityTable, RoughContact

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


def leak_of_profiles(case: Case, profiles: Sequence[ImportedProfile]) -> list[dict[str, float]]:
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
        Rows with `COLUMNS`, as in leak.csv.

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
) -> dict[str, float]:
    peak = float(profile.pressure.max())
    leak_rate, elastic = (_leak_rate(case, profile, table, fluid_pressure) for table in tables)
    found = leakage(case, fluid_pressure, leak_rate)
    values = (
        fluid_pressure,
        peak,
        leak_rate,
        elastic,
        float(surface.critical_separation(peak)),
        float(surface.elastic.critical_separation(peak)),
        *(math.nan if value is None else value for value in (found.mass_flow, found.throughput)),
    )
    return dict(zip(COLUMNS, values, strict=True))


def _conductivity(
    case: Case, surface: RoughContact, peaks: Sequence[float]
) -> ConductivityTable | GasConductivityTable:
    """Flow conductivity over all pressures of the profiles."""
    # nine decades below the peak the resistance is less than one part in a million of the whole
    return flow_table(case, surface, 1e-9 * min(peaks), 1.01 * max(peaks))


def _leak_rate(
    case: Case,
    profile: ImportedProfile,
    table: ConductivityTable | GasConductivityTable,
    fluid_pressure: float,
) -> float:
    x, radius = profile.x, profile.radius
    if radius is None:
        radius = case.contact.radius(x)
    ends = _ends(case, profile)
    return float(leak_of_profile(case, table, x, profile.pressure, fluid_pressure, radius, ends).leak_rate)


def _ends(case: Case, profile: ImportedProfile) -> tuple[float, float] | None:
    """Where the faces of the case end, if the profile is one on its seat: with the x of this program, or its radii."""
    ends, x = case.contact.reach, profile.x
    if not ends[0] <= x[0] < x[-1] <= ends[1]:
        return None
    if profile.radius is None:
        return ends
    same = np.allclose(profile.radius, case.contact.radius(x), rtol=_SAME_RADIUS, atol=0.0)
    return ends if same else None


def write_rows(rows: Sequence[dict[str, float]], path: Path) -> None:
    """Write rows as a CSV file; OutputError if it cannot be written."""
    lines = [",".join(COLUMNS), *(",".join(repr(row[column]) for column in COLUMNS) for row in rows)]
    write_text(path, "\n".join(lines) + "\n")
