"""The force that keeps the leak rate below a target."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from fem_seal.answers.answer import Answer, Inquiry, Loads
from fem_seal.answers.expected_force import expected_contact_force, log_excess, target_problem
from fem_seal.contact.refit import solve_fitted
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import InputError
from fem_seal.seal.findings import Caution, Level, Validity
from fem_seal.seal.leak_model import RoughFlow
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.seal.problem import SealProblem, condensed, largest_force, sizing
from fem_seal.seal.readings import WORDS
from fem_seal.seal.seal_flow import SealFlow
from fem_seal.seal.solved_seal import SolvedSeal
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


@dataclass(frozen=True)
class TargetForces:
    """Forces for the target leak rate, one for each load, and what to know before believing them.

    Parameters
    ----------
    force : sequence of float or None
        See `LoadResult.force_for_target` [N].
    validity : sequence of Validity or None
    others : mapping
        The forces in the other readings of yielding asperities.
    remarks : tuple of Caution
    """

    force: Sequence[float | None]
    validity: Sequence[Validity | None]
    others: Mapping[Reading, Sequence[float | None]]
    remarks: tuple[Caution, ...] = ()


def _compute(seal: SolvedSeal, ask: Inquiry) -> TargetForces:
    none: Forces = [None] * len(seal.loads)
    unknown = none, [None] * len(none), ()
    with ask.step("questions"):
        forces, validity, remarks = ask.steps.compute(TARGET.what, partial(_forces, seal), unknown)
        read = {
            reading: ask.steps.compute(
                f"{TARGET.what} of {WORDS[reading].asperities}",
                partial(_forces_read, seal, reading),
                (none, ()),
            )
            for reading in seal.loads[0].others
        }
    others = {reading: one for reading, (one, _) in read.items()}
    return TargetForces(
        forces, validity, others, (*remarks, *(remark for _, more in read.values() for remark in more))
    )


Forces = Sequence[float | None]


def _forces(seal: SolvedSeal) -> tuple[Forces, Sequence[Validity | None], tuple[Caution, ...]]:
    """Force for the target leak rate at each load and how good it is, and what to know before believing it."""
    problem, none = seal.problem, [None] * len(seal.loads)
    try:
        found = contacts_at_target(problem)
    except InputError as error:
        return none, none, _refused(error)
    surface = problem.surface
    assert surface is not None  # of a target
    validity = [target_validity(problem, surface, one) for one in found]
    return [one.applied_force for one in found], validity, tuple(target_cautions(problem, surface, found))


def _forces_read(seal: SolvedSeal, reading: Reading) -> tuple[Forces, tuple[Caution, ...]]:
    """The same forces in another reading of yielding asperities."""
    try:
        return [one.applied_force for one in contacts_at_target(seal.problem, reading=reading)], ()
    except InputError as error:
        return [None] * len(seal.loads), _refused(error, f"{WORDS[reading].condition}: ")


def _refused(error: InputError, when: str = "") -> tuple[Caution, ...]:
    texts = [f"{when}{one}" for one in error.problems]
    return tuple(Caution("target", Level.DOUBTFUL, text, text) for text in texts)


def _told(loads: Loads, found: TargetForces | None) -> Loads:
    if found is None:
        return loads
    return [
        load.knowing(force_for_target=found.force[n], target_validity=found.validity[n]).with_readings(
            {
                reading: load.reading(reading).knowing(force_for_target=forces[n])
                for reading, forces in found.others.items()
            }
        )
        for n, load in enumerate(loads)
    ]


TARGET = Answer[TargetForces | None](
    "target",
    "force for the target leak rate",
    _compute,
    None,
    lambda seal, wanted: seal.problem.loads.target_leak_rate is not None and seal.problem.leaks,
    _told,
)


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
