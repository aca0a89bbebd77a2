"""Questions asked backwards: the force that keeps the leak rate below a target, the pressure that opens the seal."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.analysis.afterwards import Afterwards
from fem_seal.analysis.caution import Caution, Level, Validity
from fem_seal.analysis.closed_forms import expected_contact_force, largest_force, log_excess, target_problem
from fem_seal.analysis.flow import CaseFlow
from fem_seal.analysis.load_solver import LoadSolver
from fem_seal.analysis.problem import condensed_on, interface_law, rough_contact, sizing_for
from fem_seal.analysis.results import LoadResult, TargetContact
from fem_seal.analysis.warnings import target_cautions, target_validity
from fem_seal.arrays import FloatArray
from fem_seal.case.tables import curves
from fem_seal.contact.penetration import effective_radius
from fem_seal.contact.refit import solve_fitted
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import InputError
from fem_seal.loads import blow_off_of_sealed_area
from meshes import Sizing

if TYPE_CHECKING:
    from fem_seal.case.case import Case

# Relative accuracy of the force.
_ACCURACY = 1e-6
# Forces for which the mesh is sized, in units of the one that is expected.
_MARGIN = (0.7, 1.4)


def axial_force_for_leak(case: Case, target_leak_rate: float | None = None) -> FloatArray:
    """Smallest force of spring or actuator for which the leak rate stays below a target, at each fluid pressure.

    Parameters
    ----------
    case : Case
        With roughness and fluid.
    target_leak_rate : float, optional
        [m^3/s], of a gas at 101325 Pa and its temperature; the case's own target unless given.

    Returns
    -------
    ndarray, shape (loads,)
        [N], positive where it closes. Negative where the fluid alone closes more than is needed.

    Raises
    ------
    InputError
        If the case has no leak rate or no target, if even the largest force that keeps strains small leaks more, or if
        hardly any force is needed.
    ConvergenceError

    Notes
    -----
    The leak rate falls with the force on the solid contact; ln Q over ln F_N is bracketed around what a Gaussian
    profile says and its root found on a mesh sized for it, one contact of the condensed bodies per step.

    Examples
    --------
    >>> fem_seal.axial_force_for_leak(case, 1e-9)     # doctest: +SKIP
    array([312.6])
    """
    return np.array([found.applied_force for found in _contacts_at_target(case, target_leak_rate)])


def _contacts_at_target(case: Case, target_leak_rate: float | None = None) -> list[TargetContact]:
    """Contact and force for which the leak rate is the target, at each fluid pressure; see `axial_force_for_leak`."""
    target = case.load.target_leak_rate if target_leak_rate is None else target_leak_rate
    if target is None or not target > 0:
        raise target_problem(case, "needed is a target leak rate above zero", target)
    if case.roughness is None or case.fluid is None:
        raise target_problem(
            case, "needs [roughness] and [fluid]: without them there is no leak rate", target
        )
    if curves(case):
        raise target_problem(
            case, "is for elastic bodies, and one has a stress_strain curve; leave it out", target
        )
    law = interface_law(case, rough_contact(case))
    # up and down again, or under several forces, a pressure may come more than once
    pressures = dict.fromkeys(case.load.fluid_pressure)
    expected = {pressure: expected_contact_force(case, law, pressure, target) for pressure in pressures}
    found: dict[float, TargetContact] = {}

    def solve_on(sizing: Sizing) -> Sequence[ContactSolution]:
        solver = LoadSolver(case, law, condensed_on(case, sizing))
        for pressure, force in expected.items():
            found[pressure] = _on_model(solver, pressure, force, target)
        return [one.contact for one in found.values()]

    forces = [share * force for force in expected.values() for share in _MARGIN]
    size_given = case.mesh.contact_size is not None
    solve_fitted(sizing_for(case, law, forces), case.contact, solve_on, size_given=size_given)
    return [found[pressure] for pressure in case.load.fluid_pressure]


def blow_off_pressures(case: Case) -> FloatArray:
    """Fluid pressure at which the seal opens under the force of spring or actuator of each load [Pa], shape (loads,).

    Infinite where the fluid does not lift the closure. With closing = "sealed-area" this is the force over the area of
    the circle of first touch; with "penetration" the fluid's own way between the surfaces decides.

    Parameters
    ----------
    case : Case
        Its fluid pressures only size the mesh.

    Raises
    ------
    ConvergenceError

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> against = case.replace({"load.pressure_side": "inner", "load.axial_force": 2000.0})
    >>> print(f"{fem_seal.blow_off_pressures(against)[0] / 1e5:.1f} bar")
    31.8 bar
    """
    law = interface_law(case, rough_contact(case))
    springs = [spring for _, spring in case.load.points]
    forces = [share * abs(spring) for spring in springs for share in (1.0, 0.1) if spring]
    if case.load.closing == "sealed-area" or not forces:
        radius, side = case.touch_radius, case.load.pressure_side
        return np.array([blow_off_of_sealed_area(radius, spring, side) for spring in springs])
    solver = LoadSolver(case, law, condensed_on(case, sizing_for(case, law, forces)))
    known = {spring: solver.blow_off_pressure(spring) for spring in dict.fromkeys(springs)}
    return np.array([known[spring] for spring in springs])


def with_answers(
    solver: LoadSolver, loads: Sequence[LoadResult], after: Afterwards
) -> tuple[tuple[LoadResult, ...], tuple[Caution, ...]]:
    """Loads with effective radius, blow-off pressure and force for the target, and what to know before believing them.

    Parameters
    ----------
    solver : LoadSolver
        Of the model on which the loads were solved.
    loads : sequence of LoadResult
    after : Afterwards
        Told which question found no answer.
    """
    case = solver.case
    penetrates = case.load.closing == "penetration"
    asked = penetrates or case.load.pressure_side == "inner"
    forces, verdicts, remarks = after.get(
        "force for the target leak rate",
        lambda: _forces_for_target(solver, len(loads)),
        _no_forces(len(loads)),
    )
    springs = dict.fromkeys(load.applied_force for load in loads) if asked else ()
    opens = {
        spring: after.get(
            f"pressure that opens the seal under {spring:.6g} N",
            partial(solver.blow_off_pressure, spring),
            None,
        )
        for spring in springs
    }
    return tuple(
        replace(
            load,
            effective_radius=effective_radius(load.contact, load.fluid_pressure) if penetrates else None,
            blow_off_pressure=opens.get(load.applied_force),
            force_for_target=force,
            target_validity=verdict,
        )
        for load, force, verdict in zip(loads, forces, verdicts, strict=True)
    ), remarks


Forces = tuple[list[float | None], list[Validity | None], tuple[Caution, ...]]


def _no_forces(count: int) -> Forces:
    return [None] * count, [None] * count, ()


def _forces_for_target(solver: LoadSolver, count: int) -> Forces:
    """Force for the target leak rate at each load and how good it is, and what to know before believing it."""
    case = solver.case
    if case.load.target_leak_rate is None:
        return _no_forces(count)
    try:
        found = _contacts_at_target(case)
    except InputError as error:
        return *_no_forces(count)[:2], tuple(
            Caution("target", Level.DOUBTFUL, str(one), str(one)) for one in error.problems
        )
    surface = _flow(solver).surface
    forces: list[float | None] = [one.applied_force for one in found]
    verdicts: list[Validity | None] = [target_validity(case, surface, one) for one in found]
    return forces, verdicts, tuple(target_cautions(case, surface, found))


def _on_model(solver: LoadSolver, fluid_pressure: float, expected: float, target: float) -> TargetContact:
    """Contact that leaks as much as the target."""
    flow = _flow(solver)
    known: dict[float, tuple[ContactSolution, float]] = {}

    def excess(log_force: float) -> float:
        start = next(reversed(known.values()))[0] if known else None
        contact, spring = solver.at_contact_force(fluid_pressure, math.exp(log_force), start)
        known[log_force] = contact, spring
        return log_excess(flow.leak(contact.profile, fluid_pressure).leak_rate, target)

    root = _root_near(excess, math.log(expected))
    if root is None:
        raise target_problem(
            solver.case,
            f"no contact force up to {largest_force(solver.case):.4g} N leaks as little at "
            f"{fluid_pressure / 1e5:.4g} bar",
            target,
        )
    if root not in known:
        excess(root)
    contact, spring = known[root]
    separation = float(flow.surface.critical_separation(contact.profile.peak_pressure))
    return TargetContact(fluid_pressure, spring, contact, separation)


def _flow(solver: LoadSolver) -> CaseFlow:
    assert solver.flow is not None  # a target needs roughness and fluid
    return solver.flow


def _root_near(excess: Callable[[float], float], expected: float) -> float | None:
    """Place where a falling function is zero, looked for from an expected place outwards."""
    from scipy.optimize import brentq

    at, value = expected, excess(expected)
    step = 0.1 * math.copysign(1.0, value)
    for _ in range(12):
        ahead = at + step
        beyond = excess(ahead)
        if beyond * value <= 0:
            return float(brentq(excess, at, ahead, xtol=_ACCURACY))
        at, value, step = ahead, beyond, 2 * step
    return None
