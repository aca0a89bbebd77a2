"""Leak rates of contact pressure profiles from a CSV file: of this program, or of any finite-element code."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from fem_seal.arrays import FloatArray, IntArray
from fem_seal.errors import InputError, Problem, QuantityError, TextTableError
from fem_seal.files import column, find_columns, read_text_table
from fem_seal.profile import PressureProfile
from fem_seal.seal.leak_model import Conductivity, FlowModel, LeakModel
from fem_seal.seal.load_result import GivenContact, GivenLoad
from fem_seal.seal.problem import SealProblem
from fem_seal.units import format_quantity
from fem_seal.validity.checks import profile_validity
from leak import RoughContact
from leak.text_tables import TextTable
from meshes import ContactGeometry

# What a column may be called, and its dimension.
_NAMES = {
    "x": ("length", ("x", "s", "arc_length", "distance")),
    "pressure": ("pressure", ("contact_pressure", "pressure", "p", "cpress")),
    "radius": ("length", ("r", "radius")),
    "fluid_pressure": ("pressure", ("fluid_pressure",)),
}
# A profile with fewer points has no shape to integrate over.
_FEWEST_ROWS = 5
_HIGHEST_PRESSURE = 1e12
# Less than an atom is no width, and less than this no contact [m], [Pa].
_SHORTEST, _LOWEST_PRESSURE = 1e-10, 1e-3


@dataclass(frozen=True)
class ImportedProfile:
    """A contact pressure profile across a seal, from a file.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Arc length across the contact [m], increasing towards larger radius.
    pressure : ndarray, shape (n,)
        Contact pressure [Pa], not negative.
    radius : ndarray, shape (n,), or None
        Distance from the axis [m]; None if the file has no such column.
    fluid_pressure : float or None
        Fluid pressure that belongs to the profile [Pa]; None if the file does not say.
    """

    x: FloatArray
    pressure: FloatArray
    radius: FloatArray | None
    fluid_pressure: float | None


def read_profiles(file: str | Path) -> tuple[ImportedProfile, ...]:
    """Contact pressure profiles of a CSV file.

    Parameters
    ----------
    file : path
        Text file with a header. Columns: arc length (``x_m``, ``x [mm]``, ...) and contact pressure
        (``contact_pressure_Pa``, ``p [MPa]``, ...), or any two columns in this order with their units;
        optionally radius (``r_m``) and fluid pressure (``fluid_pressure_Pa``), one profile for each, and one more
        where a load at the same pressure begins again at the first x.

    Returns
    -------
    tuple of ImportedProfile

    Raises
    ------
    InputError
        If the file is not such a table; the message names column and line.
    """
    try:
        table = read_text_table(file)
        columns = _columns(table)
        return tuple(_profiles(table, columns))
    except (TextTableError, QuantityError) as error:
        raise InputError.at("", str(error), file=file) from None


def _columns(table: TextTable) -> dict[str, FloatArray]:
    """The known columns in SI."""
    places = find_columns(table, _NAMES, 'such as "x_mm, contact_pressure_MPa"')
    if ("x" not in places or "pressure" not in places) and len(table.header) == 2:
        places = {"x": 0, "pressure": 1}
    missing = [role for role in ("x", "pressure") if role not in places]
    if missing:
        wanted = {"x": "x_m (arc length)", "pressure": "contact_pressure_Pa"}[missing[0]]
        raise TextTableError(f"has no column {wanted}; its columns are {', '.join(table.header)}")
    return {role: column(table, place, _NAMES[role][0]) for role, place in places.items()}


def _profiles(table: TextTable, columns: dict[str, FloatArray]) -> Iterator[ImportedProfile]:
    loads = columns.get("fluid_pressure")
    for own in _blocks(columns["x"], loads):
        load = None if loads is None else float(loads[own[0]])
        x, pressure = columns["x"][own], columns["pressure"][own]
        _check(x, pressure, [table.lines[row] for row in own])
        radius = columns["radius"][own] if "radius" in columns else None
        if radius is not None and not (radius > 0).all():
            raise TextTableError(
                f"radius must be positive; line {table.lines[own[int(np.argmin(radius > 0))]]} is not"
            )
        if load is not None and not load > 0:
            raise TextTableError(
                f"fluid pressure must be positive, it holds {format_quantity('fluid pressure', load)}"
            )
        yield ImportedProfile(x, pressure, radius, load)


def _blocks(x: FloatArray, loads: FloatArray | None) -> list[IntArray]:
    """Rows of each profile: one for each fluid pressure, and one more where a pressure begins anew at its first x."""
    rows = np.arange(len(x))
    if loads is None:
        return [rows]
    blocks = []
    for load in dict.fromkeys(loads.tolist()):
        own = rows[loads == load]
        blocks += np.split(own, np.flatnonzero(x[own] <= x[own[0]])[1:])
    return sorted(blocks, key=lambda own: int(own[0]))


def _check(x: FloatArray, pressure: FloatArray, lines: list[int]) -> None:
    if len(x) < _FEWEST_ROWS:
        raise TextTableError(f"a profile needs at least {_FEWEST_ROWS} rows, it has {len(x)}")
    increasing = np.diff(x) > 0
    if not increasing.all():
        line = lines[int(np.argmin(increasing)) + 1]
        raise TextTableError(
            f"arc length x must increase from row to row; line {line} does not. Sort the rows by x"
        )
    if x[-1] - x[0] < _SHORTEST:
        raise TextTableError(f"arc length x goes over {x[-1] - x[0]:.3g} m only; check its unit")
    inside = (pressure >= 0) & (pressure <= _HIGHEST_PRESSURE)
    if not inside.all():
        row = int(np.argmin(inside))
        raise TextTableError(
            f"contact pressure must lie between 0 and 1 TPa (compression is positive); line {lines[row]} has "
            f"{format_quantity('contact pressure', float(pressure[row]))}"
        )
    if not pressure.max() > _LOWEST_PRESSURE:
        raise TextTableError("contact pressure is zero in every row, or below 1 mPa: the bodies do not touch")


# Radii of a profile that this program wrote are those of its seat up to the digits of the file.
_SAME_RADIUS = 1e-7


def leak_of_profiles(problem: SealProblem, profiles: Sequence[ImportedProfile]) -> list[GivenLoad]:
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
    list of GivenLoad
        With their validity, as far as a profile without its bodies tells it.

    Raises
    ------
    InputError
        If the problem has no roughness or no fluid.
    """
    surface, flow = problem.surface, problem.flow
    if surface is None or flow is None:
        missing = [name for name, one in (("roughness", surface), ("fluid", flow)) if one is None]
        raise InputError(
            *(Problem(name, f"is missing; a leak rate needs a table [{name}]") for name in missing),
            file=problem.file,
        )
    if problem.loads.earlier is not None:
        raise InputError.at(
            "load.largest_earlier_force or load.largest_earlier_pressure",
            "the contact of that load is not solved for profiles that come from elsewhere; remove it",
            file=problem.file,
        )
    # samples would need the bodies
    problem = replace(problem, usual_only=problem.of_finish)
    peaks = [float(profile.pressure.max()) for profile in profiles]
    rough = LeakModel(surface, flow, partial(_conductivity, peaks))
    others = {}
    for theory in problem.other_theories:
        other = problem.in_theory(theory)
        assert other.surface is not None  # there is one
        others[theory] = replace(rough, surface=other.surface, flow=other.flow)
    return [
        _given_load(problem, rough, others, profile, fluid_pressure)
        for profile in profiles
        for fluid_pressure in (
            [profile.fluid_pressure]
            if profile.fluid_pressure
            else dict.fromkeys(problem.loads.fluid_pressure)
        )
    ]


def _given_load(
    problem: SealProblem,
    rough: LeakModel,
    others: Mapping[str, LeakModel],
    profile: ImportedProfile,
    fluid_pressure: float,
) -> GivenLoad:
    contact = GivenContact(_profile(problem.contact, profile))
    # the force is not known, and the same for all
    by_theory = {theory: GivenLoad(fluid_pressure, 0.0, contact, one) for theory, one in others.items()}
    load = GivenLoad(fluid_pressure, 0.0, contact, rough, by_theory=by_theory)
    return load.with_values(validity=profile_validity(problem, load))


def _conductivity(peaks: Sequence[float], flow: FlowModel, surface: RoughContact) -> Conductivity:
    """Flow conductivity over all pressures of the profiles."""
    # nine decades below the peak the resistance is less than one part in a million of the whole
    return flow.table(surface, 1e-9 * min(peaks), 1.01 * max(peaks))


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
    """The profile with weights of the trapezoidal rule; nothing is known of its gap."""
    x, steps = profile.x, np.diff(profile.x, prepend=profile.x[0], append=profile.x[-1])
    return PressureProfile(
        x,
        contact.radius(x) if profile.radius is None else profile.radius,
        profile.pressure,
        np.full(len(x), math.nan),
        0.5 * (steps[1:] + steps[:-1]),
        _ends(contact, profile),
    )
