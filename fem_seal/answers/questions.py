"""Questions asked backwards: the force that keeps the leak rate below a target, the pressure that opens the seal."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from fem_seal.answers.afterwards import Afterwards
from fem_seal.answers.target import expected_contact_force, log_excess, target_problem
from fem_seal.arrays import FloatArray
from fem_seal.contact.penetration import effective_radius
from fem_seal.contact.refit import solve_fitted
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import InputError
from fem_seal.loads import blow_off_of_sealed_area
from fem_seal.seal.findings import Caution, Level, Validity
from fem_seal.seal.leak_model import RoughFlow
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.seal.problem import SealProblem, condensed, largest_force, sizing
from fem_seal.seal.readings import WORDS
from fem_seal.seal.seal_flow import SealFlow
from fem_seal.units import briefly
from fem_seal.validity.checks import target_cautions, target_validity
from leak import Reading
from leak.numerics.roots import root_between
from meshes import Sizing, build_contact

# Relative accuracy of the force.
_ACCURACY = 1e-6
# Forces for which the mesh is sized, in units of the one that is expected.
_MARGIN = (0.7, 1.4)


def contacts_at_target(
    problem: SealProblem, target_leak_rate: float | None = None, *, reading: Reading | None = None
) -> list[LoadResult]:
    """Loads with the smallest force of spring or actuator at which a seal leaks as a target, at each fluid pressure.

    Parameters
    ----------
    problem : SealProblem
        With surface and flow.
    target_leak_rate : float, optional
        [m^3/s], of a gas at 101325 Pa and its temperature; the problem's own target unless given.
    reading : Reading, optional
        Of yielding asperities, on the same contact; that of the problem unless given.

    Returns
    -------
    list of LoadResult
        One per load.

    Raises
    ------
    InputError
        If there is no leak rate or no target, if even the largest force that keeps strains small leaks more, or if
        hardly any force is needed.
    ConvergenceError

    Notes
    -----
    The leak rate falls with the force on the solid contact; ln Q over ln F_N is bracketed around what a Gaussian
    profile says and its root found on a mesh sized for it, one contact of the condensed bodies per step. Where a body
    yields each step is a path of its own from the new seal, or from the largest load before those of the problem, so
    that the force leaks the target in a case that has only this load.
    """
    target = problem.loads.target_leak_rate if target_leak_rate is None else target_leak_rate
    if target is None or not target > 0:
        raise target_problem(problem, "needed is a target leak rate above zero", target)
    flow = SealFlow.of(problem)
    if flow is None:
        raise target_problem(
            problem, "needs [roughness] and [fluid]: without them there is no leak rate", target
        )
    if reading is not None:
        flow = replace(flow, surface=flow.surface.reading(reading))
    # up and down again, or under several forces, a pressure may come more than once
    pressures = dict.fromkeys(problem.loads.fluid_pressure)
    expected = {pressure: expected_contact_force(flow, pressure, target) for pressure in pressures}
    found: dict[float, LoadResult] = {}

    def solve_on(sizing: Sizing) -> Sequence[ContactSolution]:
        solver = LoadSolver(problem, condensed(problem, build_contact(problem.contact, sizing)))
        for pressure, force in expected.items():
            found[pressure] = _on_model(solver, flow, pressure, force, target)
        before = () if solver.earlier is None else (solver.earlier,)
        return [*(contact for one in found.values() for contact in one.contacts), *before]

    forces = [share * force for force in expected.values() for share in _MARGIN]
    size_given = problem.contact_size is not None
    solve_fitted(sizing(problem, forces=forces), problem.contact, solve_on, size_given=size_given)
    return [found[pressure] for pressure in problem.loads.fluid_pressure]


def blow_off_pressures(problem: SealProblem) -> FloatArray:
    """Fluid pressure at which the seal opens under the force of spring or actuator of each load [Pa], shape (loads,).

    Infinite where the fluid does not lift the closure.

    Parameters
    ----------
    problem : SealProblem
        Its fluid pressures only size the mesh.

    Raises
    ------
    ConvergenceError
    """
    applied = [force for _, force in problem.loads.points]
    forces = [share * abs(force) for force in applied for share in (1.0, 0.1) if force]
    if problem.loads.closing == "sealed-area" or not forces:
        radius, side = problem.touch_radius, problem.loads.pressure_side
        return np.array([blow_off_of_sealed_area(radius, force, side) for force in applied])
    mesh = build_contact(problem.contact, sizing(problem, forces=forces))
    solver = LoadSolver(problem, condensed(problem, mesh))
    known = {force: solver.blow_off_pressure(force) for force in dict.fromkeys(applied)}
    return np.array([known[force] for force in applied])


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
    asked_of = solver.problem.loads
    penetrates = asked_of.closing == "penetration"
    asked = penetrates or asked_of.pressure_side == "inner"
    forces, verdicts, remarks = after.get(
        "force for the target leak rate",
        lambda: _forces_for_target(solver, len(loads)),
        _no_forces(len(loads)),
    )
    read = {
        reading: after.get(
            f"force for the target leak rate of {WORDS[reading].asperities}",
            partial(_forces_read, solver, reading, len(loads)),
            ([None] * len(loads), ()),
        )
        for reading in loads[0].others
    }
    # elastic bodies are the same after every load
    different = {_opening_of(solver, load): load for load in reversed(loads)} if asked else {}
    opens = {
        key: after.get(
            f"pressure that opens the seal under {load.applied_force:.6g} N",
            partial(solver.blow_off_pressure, load.applied_force, load.contact),
            None,
        )
        for key, load in different.items()
    }
    return tuple(
        load.knowing(
            effective_radius=effective_radius(load.contact, load.fluid_pressure) if penetrates else None,
            blow_off_pressure=opens.get(_opening_of(solver, load)),
            force_for_target=force,
            target_validity=verdict,
        ).with_readings(
            {
                reading: load.reading(reading).knowing(force_for_target=others[number])
                for reading, (others, _) in read.items()
            }
        )
        for number, (load, force, verdict) in enumerate(zip(loads, forces, verdicts, strict=True))
    ), (*remarks, *(remark for _, more in read.values() for remark in more))


def _opening_of(solver: LoadSolver, load: LoadResult) -> tuple[float, int | None]:
    """What the pressure that opens the seal depends on: the applied force, and of bodies that yield the contact."""
    return load.applied_force, id(load.contact) if solver.yields else None


Forces = tuple[list[float | None], list[Validity | None], tuple[Caution, ...]]


def _no_forces(count: int) -> Forces:
    return [None] * count, [None] * count, ()


def _forces_for_target(solver: LoadSolver, count: int) -> Forces:
    """Force for the target leak rate at each load and how good it is, and what to know before believing it."""
    problem, flow = solver.problem, solver.flow
    if problem.loads.target_leak_rate is None or flow is None:
        return _no_forces(count)
    try:
        found = contacts_at_target(problem)
    except InputError as error:
        return *_no_forces(count)[:2], tuple(
            Caution("target", Level.DOUBTFUL, str(one), str(one)) for one in error.problems
        )
    surface = flow.surface
    forces: list[float | None] = [one.applied_force for one in found]
    verdicts: list[Validity | None] = [target_validity(problem, surface, one) for one in found]
    return forces, verdicts, tuple(target_cautions(problem, surface, found))


def _forces_read(
    solver: LoadSolver, reading: Reading, count: int
) -> tuple[list[float | None], tuple[Caution, ...]]:
    """The same forces in another reading of yielding asperities."""
    if solver.problem.loads.target_leak_rate is None:
        return [None] * count, ()
    try:
        return [one.applied_force for one in contacts_at_target(solver.problem, reading=reading)], ()
    except InputError as error:
        told = (f"{WORDS[reading].condition}: {one}" for one in error.problems)
        return [None] * count, tuple(Caution("target", Level.DOUBTFUL, text, text) for text in told)


def _on_model(
    solver: LoadSolver, flow: SealFlow, fluid_pressure: float, expected: float, target: float
) -> LoadResult:
    """Contact that leaks as much as the target."""
    known: dict[float, tuple[ContactSolution, float]] = {}

    def excess(log_force: float) -> float:
        start = next(reversed(known.values()))[0] if known else None
        try:
            contact, applied_force = solver.at_contact_force(fluid_pressure, math.exp(log_force), start)
        except InputError:
            # open bodies that yield: everything flows
            return log_excess(math.inf, target)
        known[log_force] = contact, applied_force
        return log_excess(flow.leak_of(contact, fluid_pressure).leak_rate, target)

    highest = math.log(largest_force(solver.problem)) if solver.yields else math.inf
    root = _root_near(excess, math.log(expected), highest)
    if root is None:
        raise target_problem(
            solver.problem,
            f"no contact force up to {briefly('force', largest_force(solver.problem))} leaks as little at "
            f"{fluid_pressure / 1e5:.4g} bar",
            target,
        )
    if root not in known:
        excess(root)
    contact, applied_force = known[root]
    load = LoadResult(fluid_pressure, applied_force, contact, formed=solver.problem.around(contact))
    return load.knowing(rough=RoughFlow.of(flow.surface, flow.flow, load.contacts))


def _root_near(excess: Callable[[float], float], expected: float, highest: float = math.inf) -> float | None:
    """Place where a falling function is zero, looked for from an expected place outwards, up to the highest."""
    at = min(expected, highest)
    value = excess(at)
    step = 0.1 * math.copysign(1.0, value)
    for _ in range(12):
        ahead = min(at + step, highest)
        if ahead == at:
            return None
        beyond = excess(ahead)
        if beyond * value <= 0:
            return root_between(excess, at, ahead, xtol=_ACCURACY)
        at, value, step = ahead, beyond, 2 * step
    return None
