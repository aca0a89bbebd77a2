"""The force that keeps the leak rate below a target, expected by closed forms and solved."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial, reduce

from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError, InputError
from fem_seal.loads import LARGEST_TURNING, contact_force
from fem_seal.seal.findings import Finding, Level, Validity
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import LoadResult, by_face
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.seal.problem import SealFlow, SealProblem, expected_forces, largest_force
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.units import briefly, format_quantity, quantity
from fem_seal.validity.checks import target_cautions, target_validity
from fem_seal.validity.words import sentence
from leak import Reading
from leak.numerics.roots import root_between

# Step of the force while a target is looked for, and how far down from the largest sensible force.
_STEP = 4.0
_LEAST = 1e-9
# Leak rates are compared within this factor of the target: sealed and blown open have to be something, too.
_FARTHEST = 1e6


def expected_contact_force(flow: SealFlow, fluid_pressure: float, target: float) -> float:
    """Force F_N at which a Gaussian profile of the expected width leaks as much as the target [N].

    Parameters
    ----------
    flow : SealFlow
    fluid_pressure : float
        [Pa]
    target : float
        [m^3/s]

    Raises
    ------
    InputError
        If no sensible force does.
    """
    problem = flow.problem

    def excess(log_force: float) -> float:
        return log_excess(flow.expected_rate(math.exp(log_force), fluid_pressure), target)

    highest = math.log(largest_force(problem))
    area = math.pi * problem.initial_contact_radius**2
    at = min(
        math.log(abs(contact_force(problem.initial_contact_radius, fluid_pressure)) + 1e-12 * area), highest
    )
    step = math.log(_STEP) * (1 if excess(at) > 0 else -1)
    while True:
        ahead = min(at + step, highest)
        if excess(ahead) * step <= 0:
            return math.exp(root_between(excess, at, ahead, xtol=1e-3))
        if ahead == highest:
            least = flow.expected_rate(math.exp(highest), fluid_pressure)
            force = briefly("force", largest_force(problem))
            values = {"force": force, "leaves": _rate(least, target), "pressure": fluid_pressure}
            raise target_problem(problem, "too_small", target, **values)
        if ahead < highest + math.log(_LEAST):
            raise target_problem(problem, "always_met", target, pressure=fluid_pressure)
        at = ahead


def target_remarks(problem: SealProblem) -> tuple[str, ...]:
    """Why the target leak rate of a problem cannot be met, before anything is solved; empty if it can.

    Parameters
    ----------
    problem : SealProblem
    """
    flow, target = SealFlow.of(problem), problem.loads.target_leak_rate
    if flow is None or target is None or problem.follows_path:
        # of bodies that yield the closed form is too rough to say so
        return ()
    remarks = []
    for pressure in dict.fromkeys(problem.loads.fluid_pressure):
        try:
            expected_contact_force(flow, pressure, target)
        except InputError as error:
            remarks.append(str(error))
    return tuple(remarks)


def log_excess(leak_rate: float, target: float) -> float:
    """ln of a leak rate over the target, within bounds: sealed and blown open are something, too."""
    return math.log(min(max(leak_rate / target, 1 / _FARTHEST), _FARTHEST))


def target_problem(problem: SealProblem, name: str, target: float | None, **values: object) -> InputError:
    """What is wrong with a target leak rate, in the words of templates/findings.toml.

    Parameters
    ----------
    problem : SealProblem
    name : str
    target : float or None
        [m^3/s]
    **values
        What the words have in braces.
    """
    shown = None
    if target is not None:
        shown = _rate(target, target) if hasattr(target, _WRITTEN) else format_quantity("flow", target)
    message = sentence("target", name, **values)
    return InputError.at("load.target_leak_rate", message, shown, file=problem.file)


# What a target of a case has that was written as pressure times volume over time [Pa m^3/s].
_WRITTEN = "pressure_volume"


def _rate(rate: float, target: float) -> str:
    """A leak rate [m^3/s] in the kind of unit in which the target was written."""
    written: float | None = getattr(target, _WRITTEN, None)
    return quantity("flow", rate) if written is None else quantity("throughput", rate * written / target)


# Relative accuracy of the force.
_ACCURACY = 1e-6
# Relative accuracy of the largest force that small strains describe.
_NEAR_STRAINS = 0.01
# Forces for which the mesh is sized, in units of the one that is expected.
_MARGIN = (0.7, 1.4)


def contacts_at_target(
    problem: SealProblem, target_leak_rate: float | None = None, *, reading: Reading | None = None
) -> list[CaseLoad]:
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
    list of CaseLoad
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
    yields each step is on the path of first loading of the new seal, or goes on from the largest load before those of
    the problem, so that the force leaks the target in a case that has only this load.
    """
    target = problem.loads.target_leak_rate if target_leak_rate is None else target_leak_rate
    if target is None or not target > 0:
        raise target_problem(problem, "missing", target)
    flow = SealFlow.of(problem)
    if flow is None:
        raise target_problem(problem, "without_leak", target)
    if reading is not None:
        flow = flow.reading(reading)
    # up and down again, or under several forces, a pressure may come more than once
    pressures = dict.fromkeys(problem.loads.fluid_pressure)
    expected = {pressure: _first_guess(flow, pressure, target) for pressure in pressures}
    found: dict[float, CaseLoad] = {}
    near, unmet = dict(expected), dict[float, str]()

    def solve(solver: LoadSolver) -> list[list[ContactSolution]]:
        for pressure, force in near.items():
            found[pressure], at, unmet[pressure] = _on_model(solver, flow, pressure, force, target)
            if solver.yields:
                # on a better mesh it is looked for where it was
                near[pressure] = at
        return [contacts(*one) for one in zip(solver.both, by_face(found.values()), strict=True)]

    def contacts(solver: LoadSolver, loads: Sequence[LoadResult]) -> list[ContactSolution]:
        before = () if solver.earlier is None else (solver.earlier,)
        known = [contact for one in loads for contact in one.contacts]
        bolted = problem.loads.unsolved_bolts is not None
        tight = [one.earlier for one in known if bolted and one.earlier is not None]
        return [*known, *tight, *before]

    forces = [*expected.values()]
    if problem.loads.unsolved_bolts is not None:
        # before the fluid acts they are as large as the preload
        r0, side = problem.initial_contact_radius, problem.loads.pressure_side
        forces += [force - contact_force(r0, pressure, 0.0, side) for pressure, force in expected.items()]
    LoadSolver.fitted(problem, [share * force for force in forces if force > 0 for share in _MARGIN], solve)
    for pressure, why in unmet.items():
        if not why:
            continue
        reached = found[pressure]
        assert reached.leak is not None  # of what flows
        force, leaves = briefly("force", reached.contact_force), _rate(reached.leak.leak_rate, target)
        values = {"force": force, "leaves": leaves, "pressure": pressure}
        raise target_problem(problem, why, target, **values)
    return [found[pressure] for pressure in problem.loads.fluid_pressure]


def _first_guess(flow: SealFlow, fluid_pressure: float, target: float) -> float:
    """Force F_N from which the target is looked for [N].

    It is the expected one; of bodies that yield, where none is expected, the largest, or that of the loads.
    """
    try:
        return expected_contact_force(flow, fluid_pressure, target)
    except InputError:
        if not flow.problem.follows_path:
            raise
        highest = largest_force(flow.problem)
        least = flow.expected_rate(highest, fluid_pressure)
        return highest if least > target else min(max(expected_forces(flow.problem)), highest)


@dataclass(frozen=True)
class TargetForces:
    """Forces for the target leak rate in one reading of yielding asperities, and what to know before believing them.

    Parameters
    ----------
    force : sequence of float or None
        See `LoadResult.force_for_target` [N].
    contact_force, preload : sequence of float or None
        See `LoadResult.contact_force_for_target` and `preload_for_target` [N].
    validity : sequence of Validity or None
        Of the reading of the loads themselves.
    remarks : tuple of Finding
    others : mapping
        The forces in the other readings.
    """

    force: Sequence[float | None]
    contact_force: Sequence[float | None]
    preload: Sequence[float | None]
    validity: Sequence[Validity | None]
    remarks: tuple[Finding, ...] = ()
    others: Mapping[str, Sequence[float | None]] = field(default_factory=dict)


def _compute(seal: SolvedSeal, request: Request) -> TargetForces:
    none = [None] * len(seal.loads)

    def compute(what: str, reading: Reading | None = None) -> TargetForces:
        return request.steps.compute(
            what, partial(_forces, seal, reading), TargetForces(none, none, none, none)
        )

    with request.clock.step("questions", ""):
        own = compute(TARGET.what)
        others = {
            name: compute(f"{TARGET.what} of {SCENARIOS[name].asperities}", Reading(name))
            for name in seal.loads[0].others
        }
    remarks = [remark for one in (own, *others.values()) for remark in one.remarks]
    return replace(
        own, remarks=tuple(remarks), others={reading: one.force for reading, one in others.items()}
    )


def _forces(seal: SolvedSeal, reading: Reading | None) -> TargetForces:
    """Forces in a reading of yielding asperities; how good they are is looked at in that of the problem alone."""
    problem, none = seal.problem, [None] * len(seal.loads)
    if problem.loads.bolts is not None:
        # each force is looked for with its own preload before it
        loads = replace(problem.loads, earlier=None, tightened=(), solved=False)
        problem = replace(problem, loads=loads)
    try:
        found = contacts_at_target(problem, reading=reading)
    except InputError as error:
        when = "" if reading is None else f"{SCENARIOS[reading].condition}: "
        texts = [f"{when}{one}" for one in error.problems]
        return TargetForces(
            none, none, none, none, tuple(Finding("target", Level.DOUBTFUL, one, one) for one in texts)
        )
    forces = TargetForces(
        [one.applied_force for one in found],
        [one.contact_force for one in found],
        [one.preload_for_target for one in found],
        none,
    )
    if reading is not None:
        return forces
    validity = [target_validity(problem, one) for one in found]
    upper, *lower = (list(target_cautions(*one)) for one in zip(problem.halves, by_face(found), strict=True))
    known = {one.text for one in upper}
    remarks = [
        replace(one, text=sentence("lower_flange", said=one.text))
        for half in lower
        for one in half
        if one.text not in known
    ]
    return replace(forces, validity=validity, remarks=(*upper, *remarks))


def _of_load(load: CaseLoad, number: int, found: TargetForces | None) -> CaseLoad:
    if found is None:
        return load
    known = load.with_values(
        force_for_target=found.force[number],
        contact_force_for_target=found.contact_force[number],
        preload_for_target=found.preload[number],
        target_validity=found.validity[number],
    )
    return known.with_scenarios(
        {
            name: load.scenarios[name].with_values(force_for_target=forces[number])
            for name, forces in found.others.items()
        }
    )


TARGET = Answer[TargetForces | None](
    "target",
    "force for the target leak rate",
    _compute,
    None,
    of_load=_of_load,
    needs=("problem.loads.target_leak_rate", "problem.leaks"),
)


class _TooFarError(Exception):
    """Bodies that yield have turned their faces further against each other than small strains describe."""


@dataclass(frozen=True)
class _Trials:
    """Contacts of a seal on one model at one fluid pressure, by ln of their force F_N, and how much they leak.

    Of two different flange faces `below` has those of the lower one, by the forces of the upper.
    """

    solver: LoadSolver
    flow: SealFlow
    fluid_pressure: float
    target: float
    known: dict[float, tuple[ContactSolution, float]] = field(default_factory=dict)
    rates: dict[float, float] = field(default_factory=dict)
    below: tuple[_Trials, ...] = ()

    @classmethod
    def of(cls, solver: LoadSolver, flow: SealFlow, fluid_pressure: float, target: float) -> _Trials:
        """Those of a seal, or of each of its two different faces."""
        each = zip(solver.both, flow.both, strict=True)
        upper, *lower = (cls(*one, fluid_pressure, target) for one in each)
        return replace(upper, below=tuple(lower))

    def halves(self, log_force: float) -> list[tuple[_Trials, float]]:
        """Each face with ln of its own force, under the force of spring or actuator that makes this one above."""
        if not self.below:
            return [(self, log_force)]
        forces = self.solver.at_same_force(self.fluid_pressure, math.exp(log_force))
        logs = [log_force, *(math.log(force) if force > 0 else -math.inf for _, force in forces[1:])]
        return list(zip((self, *self.below), logs, strict=True))

    def contact(self, log_force: float) -> ContactSolution:
        if log_force not in self.known:
            start = next(reversed(self.known.values()))[0] if self.known else None
            found = self.solver.at_contact_force(self.fluid_pressure, math.exp(log_force), start)
            self.known[log_force] = found
        return self.known[log_force][0]

    def excess(self, log_force: float) -> float:
        """ln of the leak rate over the target."""
        rates = [one.rate(at) for one, at in self.halves(log_force)]
        return log_excess(sum(rates) / len(rates), self.target)

    def rate(self, log_force: float) -> float:
        """Leak rate through this face on both sides [m^3/s]."""
        if log_force == -math.inf:
            return math.inf
        try:
            contact = self.contact(log_force)
        except InputError:
            # open bodies that yield: everything flows
            return math.inf
        if self.solver.yields and self._room(log_force) < 0:
            raise _TooFarError
        if log_force not in self.rates:
            self.rates[log_force] = self.flow.leak_of(contact, self.fluid_pressure).leak_rate
        return self.rates[log_force]

    def load(self, log_force: float) -> CaseLoad:
        """The load with this contact, of different faces with both."""
        faces = []
        for one, at in self.halves(log_force):
            one.contact(at)
            contact, applied_force = one.known[at]
            formed = one.solver.problem.around(contact)
            load = LoadResult(self.fluid_pressure, applied_force, contact, formed=formed)
            rough = LeakModel.of(one.flow.surface, one.flow.flow, load.contacts)
            faces.append(CaseLoad.of(load.with_values(rough=rough)))
        return reduce(CaseLoad.beside, faces)

    def farthest(self) -> float:
        """ln of the largest force that small strains describe, less than a contact that they do not."""
        at = max(self.known)
        root = _root_near(self._room, at, at, accuracy=_NEAR_STRAINS)
        return (at if root is None else root) - _NEAR_STRAINS

    def reached(self) -> float | None:
        """ln of the largest force to which the load steps came; None where it is not known."""
        found = [one.solver.reached(self.fluid_pressure) for one in (self, *self.below)]
        known = [force for force in found if force is not None]
        return max(math.log(min(known)), *self.known) if known else None

    def _room(self, log_force: float) -> float:
        turned = max(one.contact(at).turning for one, at in self.halves(log_force) if at > -math.inf)
        return 1.0 - turned / LARGEST_TURNING


def _on_model(
    solver: LoadSolver, flow: SealFlow, fluid_pressure: float, expected: float, target: float
) -> tuple[CaseLoad, float, str]:
    """Contact that leaks as much as the target, and its force F_N [N].

    Or the contact under the largest force, and behind it why there is no larger one.
    """
    trials = _Trials.of(solver, flow, fluid_pressure, target)
    ends = solver.yields or math.isfinite(solver.model.stop)
    highest, why = math.log(largest_force(solver.problem)) if ends else math.inf, "not_met"
    start = min(math.log(expected), highest)
    while True:
        try:
            root = _root_near(trials.excess, start, highest)
            break
        except _TooFarError:
            highest = start = trials.farthest()
        except ConvergenceError:
            reached = trials.reached()
            if reached is None or reached >= highest:
                raise
            highest, why = reached, "not_reached"
            start = highest
    if not trials.known:
        # it says what opens the seal
        trials.contact(start)
    if root is None:
        root = max(trials.rates)
        if trials.excess(root) < 0:
            raise target_problem(solver.problem, "always_met", target, pressure=fluid_pressure)
        why = "stopped" if trials.contact(root).stop_force > 0 else why
    else:
        why = ""
    load = trials.load(root)
    loads, preload = solver.problem.loads, None
    if loads.unsolved_bolts is not None:
        r0 = solver.problem.initial_contact_radius
        preload = max(math.exp(root) - contact_force(r0, fluid_pressure, 0.0, loads.pressure_side), 0.0)
    return load.with_values(preload_for_target=preload), math.exp(root), why


def _root_near(
    excess: Callable[[float], float], expected: float, highest: float = math.inf, accuracy: float = _ACCURACY
) -> float | None:
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
            return root_between(excess, at, ahead, xtol=accuracy)
        at, value, step = ahead, beyond, 2 * step
    return None
