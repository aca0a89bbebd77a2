"""Loads that cannot be calculated: they leave the seal open, or the faces cannot carry them."""

from __future__ import annotations

from dataclasses import replace

from fem_seal.case.tables import CaseTables, curves
from fem_seal.case.words import load_problem
from fem_seal.errors import LoadProblem
from fem_seal.loads import CONSTRAINT, contact_force, line_load
from fem_seal.units import briefly
from meshes.errors import mm

# Pressure over effective modulus that the whole face would have to carry in the mean, above which the contact runs over
# the ends of the faces whatever their shape: even of an edge pressed flat over all of its radius it is less.
_CRUSHED = 0.25


def refused_loads(case: CaseTables) -> dict[int, LoadProblem]:
    """Loads of a case of which is known before anything is solved that they cannot be calculated, by their numbers.

    Parameters
    ----------
    case : CaseTables
        Whose tables fit together otherwise.
    """
    refused: dict[int, LoadProblem] = {}
    crushed = None
    for number, (pressure, applied_force) in enumerate(case.load.points):
        problem = _open(case, pressure, applied_force) or _too_large(case, pressure, applied_force)
        if problem is None and crushed is not None:
            problem = load_problem("after_a_load", "path", load=crushed)
        if problem is not None:
            refused[number] = problem
            if problem.kind == "strain" and crushed is None and curves(case):
                crushed = f"that at {pressure / 1e5:.6g} bar"
    return refused


def problems_of_all_loads(case: CaseTables) -> list[LoadProblem]:
    """Why no load of a case can be calculated, one problem of each kind; empty if one can."""
    refused = refused_loads(case)
    if len(refused) < len(case.load.points):
        return []
    force = dict(enumerate(case.expected_force(*point) for point in case.load.points))
    found: dict[str, LoadProblem] = {}
    for number in sorted(refused, key=lambda number: -abs(force[number])):
        # the worst of its kind: what is allowed there is allowed to the others as well
        found.setdefault(refused[number].kind, refused[number])
    return list(found.values())


def problem_of_earlier_load(case: CaseTables) -> LoadProblem | None:
    """Why the largest load before all others cannot be calculated; None if it can or there is none.

    Parameters
    ----------
    case : CaseTables
    """
    if case.load.earlier is None:
        return None
    pressure, force = case.load.earlier
    open_seal, key = None if pressure == 0.0 else _open(case, pressure, force), case.load.earlier_key
    found = open_seal or _too_large(case, pressure, force, key.removeprefix("load."))
    return None if found is None else replace(found, key=key)


def _open(case: CaseTables, fluid_pressure: float, applied_force: float) -> LoadProblem | None:
    """Why a load leaves the seal open, as far as this is known before where the fluid gets to; None if it does not."""
    load, r0 = case.load, case.initial_contact_radius
    lifts = load.pressure_side == "inner"
    needed = -contact_force(r0, fluid_pressure, 0.0, load.pressure_side)
    # Where penetrating fluid gets to is a result: only what no contact can hold is known before.
    penetrates = load.closing == "penetration"
    force = case.expected_force(fluid_pressure, applied_force)
    holds = applied_force > 0 or not lifts if penetrates else force > 0
    if holds:
        return None
    if case.bolts is not None:
        said = {"force": briefly("force", needed), "applied": briefly("force", applied_force)}
        return load_problem("bolts_open", pressure=fluid_pressure, radius=mm(r0), **said)
    return load_problem(
        "lifted" if penetrates else "open",
        pressure=fluid_pressure,
        how="lifts the closure with" if lifts else "closes with",
        force=briefly("force", abs(needed)),
        radius=mm(r0),
        needed=needed,
        applied=applied_force,
    )


def _too_large(
    case: CaseTables,
    fluid_pressure: float,
    applied_force: float,
    lower: str = "fluid_pressure or applied_force",
) -> LoadProblem | None:
    """What a load is that the faces cannot carry over all their length; `lower` is what to lower.

    How large the strains of a smaller load are is said after it is solved (`fem_seal.validity.checks`); what a stop
    leaves to a gasket is known then, too.
    """
    if case.gasket is not None and case.gasket.stop is not None:
        return None
    contact, force = case.contact, case.expected_force(fluid_pressure, applied_force)
    f = line_load(force, contact.initial_contact_radius, contact.angle)
    start, end = contact.reach
    length = end - start
    limits = [("crushed", _CRUSHED, case.effective_modulus)]
    if hardened := [curve.stress[-1] for curve in curves(case)]:
        limits.insert(0, ("fully_plastic", CONSTRAINT, min(hardened)))
    for name, share, strength in limits:
        most = share * strength * length
        if f > most:
            said = {"force": briefly("force", force), "most": briefly("force", force * most / f)}
            return load_problem(name, "strain", **said, length=mm(length), share=share, lower=lower)
    return None
