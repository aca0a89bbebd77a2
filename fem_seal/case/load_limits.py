"""Loads that cannot be calculated: they leave the seal open, or the faces cannot carry them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fem_seal.case.tables import CaseTables, curves
from fem_seal.case.words import load_problem
from fem_seal.errors import LoadProblem
from fem_seal.loads import CONSTRAINT, LARGEST_TURNING, contact_force, line_load, plastic_half_width
from fem_seal.units import briefly
from meshes import ContactGeometry
from meshes.errors import mm

# Pressure over effective modulus that the whole face would have to carry in the mean, above which the contact runs over
# the ends of the faces whatever their shape: even of an edge pressed flat over all of its radius it is less.
_CRUSHED = 0.25
# Angle by which the faces of a body that yields turn [rad] above which load steps shrink until they end: a knife edge
# that would turn copper by 0.5 stops at a sixth of its load.
MOST_TURNED = 0.4


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
    # Where fluid gets to between surfaces or lands is a result: only what no contact can hold is known before.
    penetrates = not case.on_sealed_area
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
        **case.labels,
        how=f"lifts the {case.label_of('closure')} with" if lifts else "closes with",
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
    if not hardened or any(len(curve.stress) == 1 for curve in curves(case)):
        # what a body bears that does not harden is found on the way to the load
        return None
    # a narrower contact cannot carry the load, whatever else yields
    half_width = plastic_half_width(f, min(hardened))
    turned = turning(contact, half_width)
    if turned <= MOST_TURNED:
        return None
    share = _share_within(lambda share: turning(contact, share * half_width) <= LARGEST_TURNING)
    said = {"force": briefly("force", force), "most": briefly("force", force * share)}
    limits_of = {"turned": turned, "largest": LARGEST_TURNING}
    return load_problem("turned", "strain", **said, **limits_of, width=2 * half_width, lower=lower)


# Places of each side at which the gap is looked at, and halvings until the force is known to two digits.
_PLACES, _HALVINGS = 201, 12


def turning(contact: ContactGeometry, half_width: float) -> float:
    """Angle by which faces turn that are pressed into each other over a width [rad]; a/R on a parabola.

    The width is taken where the undeformed faces are closest. Where they open more slowly further in, as on a flat land
    with rounded edges, the mean angle counts, and where they open as a cone their own.

    Parameters
    ----------
    contact : ContactGeometry
    half_width : float
        a [m]; zero is the answer where the faces are shorter.
    """
    x = np.linspace(0.0, 2.0 * half_width, _PLACES)
    inner, outer = (
        np.maximum.accumulate(
            np.where(x <= abs(end), np.maximum(contact.gap(math.copysign(1.0, end) * x), 0.0), np.inf)
        )
        for end in contact.reach
    )
    widest = np.maximum(inner, outer[::-1])
    at = int(np.argmin(widest))
    if not math.isfinite(widest[at]):
        return 0.0
    ends = [(one, place) for one, place in ((inner, at), (outer, _PLACES - 1 - at)) if place > 0]
    slope = max(float(one[place] - one[place - 1]) / float(x[1]) for one, place in ends)
    return min(2.0 * float(widest[at]) / half_width, slope)


def _share_within(holds: Callable[[float], bool]) -> float:
    """Largest share below one that holds, to two digits."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
