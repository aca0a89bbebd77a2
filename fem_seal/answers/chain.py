"""The chain from a case to its results: geometry, mesh, contact, profile, leak."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.answer import Answer, OptionalSteps, Request, at_pressure, loads_of
from fem_seal.answers.bolts import BOLTS
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.closed_forms import foresee_findings
from fem_seal.answers.compression import COMPRESSION
from fem_seal.answers.error_shares import ERROR_SHARES
from fem_seal.answers.findings import FINDINGS, all_cautions, findings_of_profiles
from fem_seal.answers.form import FORM
from fem_seal.answers.map_files import PressureMap
from fem_seal.answers.map_leak import face_of, leak_of_map, remarks_of_map, with_lay
from fem_seal.answers.opening import OPENING
from fem_seal.answers.particles import PARTICLES
from fem_seal.answers.pass_probability import PASS_PROBABILITY
from fem_seal.answers.profile_files import ImportedProfile
from fem_seal.answers.profile_leak import leak_of_profiles, ring_of
from fem_seal.answers.sensitivities import SENSITIVITIES
from fem_seal.answers.solution import SealSolution, answer_parts
from fem_seal.answers.standard_tests import SET_PRESSURE, STANDARD_TESTS
from fem_seal.answers.target import TARGET
from fem_seal.answers.uncertainty import UNCERTAINTY
from fem_seal.answers.variants import INTERFACE_VARIANTS, OWN_CONTACTS, shown_in_full
from fem_seal.answers.verdict import VERDICT, VERDICT_FORCE
from fem_seal.case.case import Case
from fem_seal.contact.solution import move_together
from fem_seal.errors import Text, write
from fem_seal.seal.evaluate import evaluate_seal
from fem_seal.seal.findings import not_calculated
from fem_seal.seal.heating import with_contact_temperatures
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import MissingLoad
from fem_seal.seal.load_solver import Clock, LoadSolver, Progress
from fem_seal.seal.problem import SealProblem, problems_of, under_loads
from fem_seal.seal.scenarios import SCENARIOS
from fem_seal.wording import Quantity
from leak import LeakError, RoughContact

# All that is asked of a solved seal, each after those whose answers it uses.
ANSWERS: tuple[Answer[Any], ...] = (
    ACCURACY,
    COMPRESSION,
    OPENING,
    TARGET,
    BOLTS,
    FORM,
    PARTICLES,
    OWN_CONTACTS,
    INTERFACE_VARIANTS,
    FINDINGS,
    UNCERTAINTY,
    ERROR_SHARES,
    PASS_PROBABILITY,
    VERDICT_FORCE,
    VERDICT,
    STANDARD_TESTS,
    SET_PRESSURE,
    SENSITIVITIES,
)

# What is worked out of each load, and what stands there where the stress could not be calculated.
_LEAK = {"leak": "leak rate"}
_BY_ANGLE = {"leak_round": "leak rate of the round seal", "around": "leak around the axis"}
_SEPARATION = {"critical_separation": "critical separation"}
_STRESS = {"largest_stress": "stress"}
_NO_STRESS = math.nan, ("closure", math.nan, math.nan)


def _simulate(problem: SealProblem, clock: Clock) -> None:
    """Simulate the surface if its conductivity comes from there, before the bodies: it asks nothing of them.

    What is wrong with its map or its pressures is then said before minutes are spent on anything else.
    """
    surface = problem.surface
    simulated = None if problem.flow is None else problem.flow.direct
    if simulated is None or surface is None:
        return
    with clock.step("direct", "direct simulation of the surface"):
        _ = simulated.table(surface, progress=clock.progress).range
        if simulated.elastic is not simulated and isinstance(surface, RoughContact):
            clock.progress("direct simulation of elastic asperities, to compare with")
            # what is shown beside a result is no reason for having none
            with suppress(LeakError):
                simulated.elastic.table(surface.elastic, progress=clock.progress)


def solve(
    case: Case,
    progress: Progress | None = None,
    *,
    sensitivities: bool | None = None,
    verdict_force: bool | None = None,
    full: bool = False,
    answers: Sequence[Answer[Any]] | None = None,
) -> SealSolution:
    """Solve every load of a case and answer all that is asked of it; `fem_seal.run` says what can go wrong.

    Parameters
    ----------
    case : Case
    progress : callable, optional
        Called with a status message before each step.
    sensitivities, verdict_force : bool, optional
        Whether they are asked for; see `fem_seal.run`.
    full : bool
        Whether those are asked for, too, that only the full report shows.
    answers : sequence of Answer, optional
        In their order; all that are asked for unless given.
    """
    case.check_shapes()
    clock, steps = Clock(progress or (lambda text: None)), OptionalSteps(case.display)
    seal = _solve_loads(case, clock, steps, tells=progress is not None)
    solver = LoadSolver(seal.problem, seal.model)
    request = Request(solver, clock, sensitivities, verdict_force, full, steps, solve=solve)
    others = () if full else shown_in_full(seal)
    all_answers = [answer for answer in ANSWERS if answer.name not in others]
    return _answer_all(seal, request, all_answers if answers is None else answers)


# What is asked of given contacts: all that needs no bodies.
_OF_PROFILES: tuple[Answer[Any], ...] = (
    replace(FINDINGS, compute=lambda seal, request: findings_of_profiles(seal)),
    UNCERTAINTY,
    ERROR_SHARES,
    PASS_PROBABILITY,
    VERDICT,
)


def solve_profiles(
    case: Case, profiles: Sequence[ImportedProfile], progress: Progress | None = None
) -> SealSolution:
    """Leak rates of given contacts, and all that needs no bodies: interval, shares, verdict.

    Parameters
    ----------
    case : Case
        Whose closure and seat need no shapes where the profiles have radii.
    profiles : sequence of ImportedProfile
    progress : callable, optional
        Called with a status message before each step.

    Raises
    ------
    InputError
        As of `leak_of_profiles`.
    """
    clock, steps = Clock(progress or (lambda text: None)), OptionalSteps(case.display)
    if not case.has_shapes:
        case = case.over_ring(*ring_of(profiles))
    problem = SealProblem.of(case)
    _simulate(problem, clock)
    with clock.step("leak", "flow conductivity and leak rates"):
        loads = leak_of_profiles(problem, profiles)
    return _of_given(case, problem, loads, clock, steps, profiles)


def solve_map(case: Case, found: PressureMap, progress: Progress | None = None) -> SealSolution:
    """Leak rates of a map of contact pressure, and all that needs no bodies.

    Parameters
    ----------
    case : Case
        Whose closure and seat need no shapes.
    found : PressureMap
    progress : callable, optional
        Called with a status message before each step.

    Raises
    ------
    InputError
        As of `face_of` and `leak_of_map`.
    """
    clock, steps = Clock(progress or (lambda text: None)), OptionalSteps(case.display)
    face = face_of(found, case)
    case = case.over_ring(*face.ring)
    problem = SealProblem.of(case)
    face = with_lay(face, problem.surface, case)
    _simulate(problem, clock)
    with clock.step("leak", "flow conductivity and leak rates"):
        loads, remarks = leak_of_map(problem, found, face)
    remarks += remarks_of_map(found, face, case)
    means = (
        "peak pressure, width and profile are means across the face, of the places where most flows; the highest "
        f"pressure of the map is {Quantity(float(found.pressure.max()), 'contact pressure')}"
    )
    found = replace(found, remark="; ".join(filter(None, (found.remark, means))))
    return _of_given(case, problem, loads, clock, steps, [found], remarks)


def _of_given(
    case: Case,
    problem: SealProblem,
    loads: Sequence[CaseLoad],
    clock: Clock,
    steps: OptionalSteps,
    contacts: Sequence[ImportedProfile | PressureMap],
    remarks: Sequence[Text] = (),
) -> SealSolution:
    """A case on given contacts with all that is asked of it."""
    loads = [_add_values(steps, _compute(steps, load, _LEAK), _SEPARATION) for load in loads]
    no_bodies: Any = None  # of what has no bodies
    seal = SolvedSeal(case, problem, no_bodies, no_bodies, tuple(loads))
    answers = {"profiles": tuple(contacts)}
    request = Request(no_bodies, clock, steps=steps, answers=answers, remarks=[*remarks])
    return _answer_all(seal, request, _OF_PROFILES)


def _answer_all(seal: SolvedSeal, request: Request, answers: Sequence[Answer[Any]]) -> SealSolution:
    seal = answer_parts(seal, request, answers)
    said = (*all_cautions(request.answers), *request.remarks, *request.steps.failures)
    warnings = tuple(write(text, seal.case.display) for text in said)
    return SealSolution(
        **vars(seal), answers=request.answers, warnings=warnings, timings=request.clock.timings
    )


def _solve_loads(case: Case, clock: Clock, steps: OptionalSteps, *, tells: bool = False) -> SolvedSeal:
    """The loads of a case, without any answer."""
    with clock.step("interface", "roughness and interface law"):
        case = with_contact_temperatures(case) if case.conducts_heat else case
        problems = problems_of(case)
        first = problems[0]
        _ = first.law  # made once for each surface, and here, where it is timed
    for text in foresee_findings(first) if tells else ():
        clock.progress(text.text(case.display))
    _simulate(first, clock)
    refused_loads = first.loads.refusals
    if refused_loads:  # else the problems keep their laws
        problems = under_loads(problems, first.loads.without_loads(refused_loads))
    parts = evaluate_seal(problems, clock=clock)
    numbers = [number for number in range(len(first.loads.points)) if number not in refused_loads]
    unsolved_loads = {numbers[number]: why for number, why in parts[0].solved_loads.problems.items()}
    causes = {**refused_loads, **unsolved_loads}
    for error in [part.solved_loads.not_unloaded for part in parts if part.solved_loads.not_unloaded][:1]:
        steps.name_failure("residual stress and imprint", error)
    with clock.step("leak", "flow conductivity and leak rates"):
        loads = tuple(
            _add_values(steps, _compute(steps, load, {} if load.circumference is None else _BY_ANGLE), _LEAK)
            for load in loads_of(parts, partial(_with_table, steps))
        )
    with clock.step("stress", "stress in both bodies"):
        with suppress(MemoryError):  # one after the other they may fit
            for same in zip(*(load.parts for load in loads), strict=True):
                move_together([load.contact for load in same])
        loads = tuple(
            _compute(steps, _add_values(steps, load, _SEPARATION), _STRESS, _NO_STRESS) for load in loads
        )
    return replace(
        SolvedSeal.of(parts, case.without_loads(causes), loads),
        missing_loads=tuple(
            MissingLoad(number, *first.loads.points[number], causes[number], first.loads.bolts is not None)
            for number in sorted(causes)
        ),
        missing_load_findings=tuple(not_calculated(first.loads, causes)),
    )


def _with_table(steps: OptionalSteps, name: str, model: LeakModel) -> LeakModel:
    """Surfaces and fluid whose flow conductivity is worked out; of scenarios beside only where it is told of them."""
    asperities = SCENARIOS[name].asperities if name else ""
    if name and not asperities:
        return model
    with steps.attempt("flow conductivity" + (f" of {asperities}" if name else "")):
        _ = model.table
        return model
    return replace(model, make=_no_table)


def _no_table(flow: object, surface: object) -> None:
    """In place of a flow conductivity that could not be calculated."""


def _add_values(steps: OptionalSteps, load: CaseLoad, values: Mapping[str, str]) -> CaseLoad:
    """A load with some values worked out, of the scenarios that are told of asperities as well."""
    load = _compute(steps, load, values)
    return load.with_scenarios(
        {
            name: _compute(steps, other, {value: f"{text} of {asperities}" for value, text in values.items()})
            for name, other in load.scenarios.items()
            if (asperities := SCENARIOS[name].asperities)
        }
    )


def _compute(
    steps: OptionalSteps, load: CaseLoad, values: Mapping[str, str], fallback: object = None
) -> CaseLoad:
    subjects = {name: at_pressure(text, load) for name, text in values.items()}
    return steps.compute_values(load, subjects, fallback)
