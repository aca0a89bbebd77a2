"""The force that keeps the leak rate below a target, expected by closed forms and solved."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from fem_seal.answers.answer import Answer, Request, with_scenarios
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.force_search import End, Trials, Zero, find_zero, search_forces, sensible_forces
from fem_seal.answers.two_flanges import mean_rate
from fem_seal.errors import ConvergenceError, InputError, OpenSealError, Text
from fem_seal.loads import LARGEST_TURNING, contact_force
from fem_seal.seal.findings import Finding, Level, Validity, remark, sentence
from fem_seal.seal.problem import SealFlow, SealProblem, expected_forces, under_loads
from fem_seal.seal.scenarios import SCENARIOS, problem_in
from fem_seal.validity.checks import target_cautions, target_validity
from fem_seal.wording import Quantity, Words

# First step from where the fluid closes the seal alone.
_STEP = math.log(4.0)
# Leak rates are compared within this factor of the target: sealed and blown open have to be something, too.
_FARTHEST = 1e6


def flows_of(problems: Iterable[SealProblem], scenario: str = "") -> tuple[SealFlow, ...]:
    """The flow of each problem of a seal; none without roughness or fluid.

    Parameters
    ----------
    problems : iterable of SealProblem
    scenario : str
        Name of one that shares the contacts, whose surface and fluid are meant; those of the problems unless given.
    """
    flows = (
        SealFlow.of(problem, problem_in(problem, scenario) if scenario else None) for problem in problems
    )
    return tuple(flow for flow in flows if flow is not None)


def expected_contact_force(flows: Sequence[SealFlow], fluid_pressure: float, target: float) -> float:
    """Force F_N at which Gaussian profiles of the expected width leak as much as the target [N].

    Parameters
    ----------
    flows : sequence of SealFlow
        Of a seal, see `flows_of`.
    fluid_pressure : float
        [Pa]
    target : float
        [m^3/s]

    Raises
    ------
    InputError
        If no sensible force does.
    """
    problem = flows[0].problem
    lowest, highest = sensible_forces(flow.problem for flow in flows)
    area = math.pi * problem.initial_contact_radius**2
    fluid_force = abs(contact_force(problem.initial_contact_radius, fluid_pressure)) + 1e-12 * area

    def excess(log_force: float) -> float:
        return log_excess(_expected_rate(flows, math.exp(log_force), fluid_pressure), target)

    start = math.log(fluid_force)
    zero = find_zero(excess, start, lowest=lowest, highest=highest, step=_STEP, accuracy=1e-3)
    assert zero is not None  # it is known everywhere
    if zero.end is None:
        return math.exp(zero.place)
    name = "too_small" if zero.end is End.HIGHEST else "always_met"
    largest = math.exp(highest)
    least = _rate(_expected_rate(flows, largest, fluid_pressure), target)
    values = {"force": Quantity(largest, "short force"), "leaves": least, "pressure": fluid_pressure}
    raise target_problem(problem, name, target, **values)


def _expected_rate(flows: Sequence[SealFlow], contact_force: float, fluid_pressure: float) -> float:
    return mean_rate(flow.expected_rate(contact_force, fluid_pressure) for flow in flows)


def target_remarks(problems: Sequence[SealProblem]) -> tuple[Text, ...]:
    """Why the target leak rate of a seal cannot be met, before anything is solved; empty if it can.

    Parameters
    ----------
    problems : sequence of SealProblem
        Of one seal.
    """
    problem, flows = problems[0], flows_of(problems)
    target = problem.loads.target_leak_rate
    if not flows or target is None or problem.follows_path:
        # of bodies that yield the closed form is too rough to say so
        return ()
    remarks: list[Text] = []
    for pressure in dict.fromkeys(problem.loads.fluid_pressure):
        try:
            expected_contact_force(flows, pressure, target)
        except InputError as error:
            remarks.append(error)
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
    text = None
    if target is not None:
        text = _rate(target, target) if hasattr(target, _PV) else Quantity(target, "given flow")
    message = sentence("target", name, **values)
    return InputError.at("load.target_leak_rate", message, text, file=problem.file)


# What a target of a case has that was written as pressure times volume over time [Pa m^3/s].
_PV = "pressure_volume"


def _rate(rate: float, target: float) -> Quantity:
    """A leak rate [m^3/s] in the kind of unit in which the target was written."""
    pv: float | None = getattr(target, _PV, None)
    return Quantity(rate, "flow") if pv is None else Quantity(rate * pv / target, "throughput")


# Relative accuracy of the force.
_ACCURACY = 1e-6


def contacts_at_target(
    problems: Sequence[SealProblem], target_leak_rate: float | None = None, *, scenario: str = ""
) -> list[CaseLoad]:
    """Loads with the smallest force of spring or actuator at which a seal leaks as a target, at each fluid pressure.

    Parameters
    ----------
    problems : sequence of SealProblem
        Of one seal, with surface and flow.
    target_leak_rate : float, optional
        [m^3/s], of a gas at 101325 Pa and its temperature; the problem's own target unless given.
    scenario : str
        Name of one that shares the contacts, whose leak rate is meant; that of the problems unless given.

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
    problem = problems[0]
    target = problem.loads.target_leak_rate if target_leak_rate is None else target_leak_rate
    if target is None or not target > 0:
        raise target_problem(problem, "missing", target)
    flows = flows_of(problems, scenario)
    if not flows:
        raise target_problem(problem, "without_leak", target)
    # up and down again, or under several forces, a pressure may come more than once
    starts = {pressure: _first_guess(flows, pressure, target) for pressure in problem.loads.fluid_pressure}
    lowest, highest = sensible_forces(problems)

    def find(trials: Trials, start: float) -> Zero | None:
        def excess(place: float) -> float | None:
            try:
                load = trials.load(place)
            except (InputError, OpenSealError):
                return log_excess(math.inf, target)
            except ConvergenceError:
                if trials.path_error is None:
                    raise
                return None
            if problem.follows_path and _turning(load) > LARGEST_TURNING:
                return None
            return log_excess(_leak_rate(_leaking(problems, load, scenario)), target)

        return find_zero(excess, start, lowest=lowest, highest=highest, accuracy=_ACCURACY)

    loads = {
        pressure: _at_target(problems, trials, zero, target, scenario)
        for pressure, (trials, zero) in search_forces(problems, starts, find).items()
    }
    return [loads[pressure] for pressure in problem.loads.fluid_pressure]


def _at_target(
    problems: Sequence[SealProblem], trials: Trials, zero: Zero | None, target: float, scenario: str
) -> CaseLoad:
    """The load with the target's leak rate, or why there is none."""
    problem = problems[0]
    if zero is None:
        raise trials.path_error or ConvergenceError("no force was found that keeps the strains small")
    pressure, load = trials.fluid_pressure, _leaking(problems, trials.load(zero.place), scenario)
    if zero.end is not None:
        why = "not_met"
        if zero.end is End.LOWEST:
            why = "always_met"
        elif load.contact.stop_force > 0.0:
            why = "stopped"
        elif trials.path_error is not None:
            why = "not_reached"
        force, leaves = Quantity(load.contact_force, "short force"), _rate(_leak_rate(load), target)
        raise target_problem(problem, why, target, force=force, leaves=leaves, pressure=pressure)
    if problem.loads.unsolved_bolts is None:
        return load
    r0, side = problem.initial_contact_radius, problem.loads.pressure_side
    preload = math.exp(zero.place) - contact_force(r0, pressure, 0.0, side)
    return load.with_values(preload_for_target=max(preload, 0.0))


def _leaking(problems: Sequence[SealProblem], load: CaseLoad, scenario: str) -> CaseLoad:
    return with_scenarios(problems, load).scenarios.get(scenario, load) if scenario else load


def _leak_rate(load: CaseLoad) -> float:
    assert load.leak is not None  # of what flows
    return load.leak.leak_rate


def _turning(load: CaseLoad) -> float:
    return max(part.contact.turning for part in load.parts)


def _first_guess(flows: Sequence[SealFlow], fluid_pressure: float, target: float) -> float:
    """Force F_N from which the target is looked for [N].

    It is the expected one; of bodies that yield, where none is expected, the largest, or that of the loads.
    """
    try:
        return expected_contact_force(flows, fluid_pressure, target)
    except InputError:
        problem = flows[0].problem
        if not problem.follows_path:
            raise
        highest = math.exp(sensible_forces(flow.problem for flow in flows)[1])
        least = _expected_rate(flows, highest, fluid_pressure)
        return highest if least > target else min(max(expected_forces(problem)), highest)


@dataclass(frozen=True)
class TargetForces:
    """Forces for the target leak rate in one scenario, and what to know before believing them.

    Parameters
    ----------
    force : sequence of float or None
        See `LoadResult.force_for_target` [N].
    contact_force, preload : sequence of float or None
        See `LoadResult.contact_force_for_target` and `preload_for_target` [N].
    validity : sequence of Validity or None
        Of the scenario of the loads themselves.
    remarks : tuple of Finding
    others : mapping
        The forces in the scenarios beside.
    """

    force: Sequence[float | None]
    contact_force: Sequence[float | None]
    preload: Sequence[float | None]
    validity: Sequence[Validity | None]
    remarks: tuple[Finding, ...] = ()
    others: Mapping[str, Sequence[float | None]] = field(default_factory=dict)


def _compute(seal: SolvedSeal, request: Request) -> TargetForces:
    none = [None] * len(seal.loads)

    def compute(subject: str, scenario: str = "") -> TargetForces:
        return request.steps.compute(
            subject, partial(_forces, seal, scenario), TargetForces(none, none, none, none)
        )

    with request.clock.step("questions", ""):
        nominal = compute(TARGET.subject)
        others = {
            name: compute(f"{TARGET.subject} of {SCENARIOS[name].asperities}", name)
            for name in seal.loads[0].others
        }
    remarks = [remark for forces in (nominal, *others.values()) for remark in forces.remarks]
    return replace(nominal, remarks=tuple(remarks), others={name: x.force for name, x in others.items()})


def _forces(seal: SolvedSeal, scenario: str) -> TargetForces:
    """Forces in a scenario; how good they are is looked at in that of the problem alone."""
    problems, none = seal.problems, [None] * len(seal.loads)
    if seal.problem.loads.bolts is not None:
        # each force is looked for with its own preload before it
        problems = under_loads(problems, seal.problem.loads.with_loose_bolts)
    try:
        results = contacts_at_target(problems, scenario=scenario)
    except InputError as error:
        when = f"{SCENARIOS[scenario].condition}: " if scenario else ""
        texts = [Words("{{ when }}{{ why }}", {"when": when, "why": why}) for why in error.problems]
        return TargetForces(
            none, none, none, none, tuple(remark("target", Level.DOUBTFUL, text) for text in texts)
        )
    forces = TargetForces(
        [load.applied_force for load in results],
        [load.contact_force for load in results],
        [load.preload_for_target for load in results],
        none,
    )
    if scenario:
        return forces
    validity = [load.validity_by(target_validity, problems) for load in results]
    remarks: list[Finding] = []
    for problem, loads in zip(problems, zip(*(load.parts for load in results), strict=True), strict=True):
        known_texts, label = {finding.text for finding in remarks}, problem.contact.label_of("closure")
        remarks += [
            finding if problem is problems[0] else finding.at_place(label)
            for finding in target_cautions(problem, loads)
            if finding.text not in known_texts
        ]
    return replace(forces, validity=validity, remarks=tuple(remarks))


def _of_load(load: CaseLoad, number: int, targets: TargetForces | None) -> CaseLoad:
    if targets is None:
        return load
    new_load = load.with_values(
        force_for_target=targets.force[number],
        contact_force_for_target=targets.contact_force[number],
        preload_for_target=targets.preload[number],
        target_validity=targets.validity[number],
    )
    return new_load.with_scenarios(
        {
            name: load.scenarios[name].with_values(force_for_target=forces[number])
            for name, forces in targets.others.items()
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
