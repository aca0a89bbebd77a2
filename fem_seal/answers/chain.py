"""The chain from a case to its results: geometry, mesh, contact, profile, leak."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from fem_seal.answers.accuracy import (
    NOT_ESTIMATED,
    Comparison,
    discretisation_error,
    far_field,
    on_coarser_mesh,
)
from fem_seal.answers.afterwards import Afterwards
from fem_seal.answers.judgement import JudgedLoad, VerdictForce
from fem_seal.answers.left_out import left_out
from fem_seal.answers.opening import with_margins
from fem_seal.answers.questions import with_answers
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.variants import interface_variants, theory_variants
from fem_seal.answers.verdict import seal_judgement, with_judgements
from fem_seal.contact.solution import move_together
from fem_seal.seal.findings import NOT_JUDGED, Caution, Validity, worst_first
from fem_seal.seal.heating import warmed
from fem_seal.seal.leak_model import RoughFlow
from fem_seal.seal.load_result import DiscretisationError, LoadResult, highest_load, strongest_load
from fem_seal.seal.load_solver import Clock, LoadSolver, Progress, model_and_contacts
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.readings import WORDS
from fem_seal.seal.solved_seal import SolvedSeal
from fem_seal.units import given
from fem_seal.validity.checks import contact_cautions, earlier_cautions, load_validity
from leak import LeakError, Reading

if TYPE_CHECKING:
    from fem_seal.answers.particles import ParticleAnswers
    from fem_seal.case.case import Case
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.errors import LoadProblem
    from meshes import SealMesh

Read = TypeVar("Read", LoadResult, RoughFlow)

# What is worked out of each load, and what stands there where the stress could not be calculated.
_LEAK = {"leak": "leak rate"}
_AROUND = {"leak_round": "leak rate of the round seal", "around": "leak around the axis"}
_SEPARATION = {"critical_separation": "critical separation"}
_STRESS = {"largest_stress": "stress"}
# Where a body yields the force with which the verdict passes takes minutes: only if it is asked for.
_TOO_DEAR = VerdictForce(
    None,
    "where a body yields every force that is tried is a whole path of loads; in Python "
    "fem_seal.run(case, verdict_force=True) asks for it",
    looked_for=False,
)
_NO_STRESS = math.nan, ("closure", math.nan, math.nan)


def _simulate(problem: SealProblem, clock: Clock) -> None:
    """Simulate the surface if its conductivity comes from there, before the bodies: it asks nothing of them.

    What is wrong with its map or its pressures is then said before minutes are spent on anything else.
    """
    surface = problem.surface
    simulated = None if problem.flow is None else problem.flow.simulated
    if simulated is None or surface is None:
        return
    with clock.step("direct", "direct simulation of the surface"):
        _ = simulated.table(surface, progress=clock.progress).range
        if simulated.elastic is not simulated:
            clock.progress("direct simulation of elastic asperities, to compare with")
            # what is shown beside a result is no reason for having none
            with suppress(LeakError):
                simulated.elastic.table(surface.elastic, progress=clock.progress)


def solve(
    case: Case,
    progress: Progress | None = None,
    *,
    levers: bool | None = None,
    verdict_force: bool | None = None,
) -> SealSolution:
    """Solve every load of a case; `fem_seal.run` says what can go wrong.

    Parameters
    ----------
    case : Case
    progress : callable, optional
        Told in words what is being done.
    levers : bool, optional
        Whether to look for levers; with a requirement unless given, not where a body yields.
    verdict_force : bool, optional
        Whether to look for the force with which the verdict passes, where the case has a target leak rate; not where a
        body yields, unless given.
    """
    clock = Clock(progress or (lambda text: None))
    with clock.step("interface", "roughness and interface law"):
        case = warmed(case)
        whole = SealProblem.of(case)
        _ = whole.law  # made once for each surface, and here, where it is timed
    _simulate(whole, clock)
    refused = whole.loads.refused
    problem = _without(whole, refused)
    seal_mesh, model, solved = model_and_contacts(problem, clock)
    problem, contacts, after = _without(problem, solved.failures), solved.contacts, Afterwards()
    if solved.formed:
        problem = replace(
            problem, form=solved.formed[0].form
        )  # which now knows how many waves its tolerance holds
    kept = [number for number in range(len(whole.loads.points)) if number not in refused]
    unsolved = {kept[number]: one for number, one in solved.problems.items()}
    missing = {**refused, **unsolved}
    remarks = tuple(left_out(whole.loads, missing))
    if solved.not_unloaded is not None:
        after.name("residual stress and imprint", solved.not_unloaded)
    with clock.step("leak", "flow conductivity and leak rates"):
        bare = [
            LoadResult(*point, contact, formed=formed)
            for point, contact, formed in zip(problem.loads.points, contacts, solved.around, strict=True)
        ]
        shown = [contact for load in bare for contact in load.contacts]
        rough = _with_tables(after, RoughFlow.of(problem.surface, problem.flow, shown))
        loads = tuple(
            _read(
                after,
                _settled(after, load.knowing(rough=rough), {} if load.formed is None else _AROUND),
                _LEAK,
            )
            for load in bare
        )
    with clock.step("stress", "stress in both bodies"):
        with suppress(MemoryError):  # one after the other they may fit
            move_together([load.contact for load in loads])
        loads = tuple(_settled(after, _read(after, load, _SEPARATION), _STRESS, _NO_STRESS) for load in loads)
    error, far = _on_coarser_elements(problem, seal_mesh, loads, clock, after)
    loads = tuple(load.knowing(mesh_error=error) for load in loads)
    solver = LoadSolver(problem, model)
    with clock.step("questions", "blow-off and force for the target leak rate"):
        loads, of_answers = with_answers(solver, loads, after)
        loads = after.get("margin to opening", partial(with_margins, solver, loads), loads)
    answers = None
    if whole.form is not None:
        with clock.step("form", "what the form error means"):
            from fem_seal.answers.form import form_answers

            ask = partial(form_answers, solver, case, loads[highest_load(loads)], whole.form)
            answers = after.get("answers about the form error", ask, None)
    particles: tuple[ParticleAnswers, ...] = ()
    if case.fluid is not None and case.fluid.particles is not None:
        with clock.step("particles", "what particles in the fluid do to the leak"):
            from fem_seal.answers.particles import particle_answers

            ask_for = partial(particle_answers, loads, case.fluid.particles.counts)
            particles = after.get("answers about particles in the fluid", ask_for, ())
    with clock.step("variants", "comparing elastic and plastic interface law"):
        compare = partial(interface_variants, solver, loads)
        variants = after.get("comparison of elastic and plastic interface law", compare, ())
    check = partial(contact_cautions, problem, model, loads, error, problem.surface)
    before = after.get(
        "checks of the largest earlier load", partial(_of_earlier, problem, solved.earlier, error), ()
    )
    found = (*remarks, *after.get("checks of what the theory allows", check, ()), *before, *of_answers)
    result = SealSolution(
        case=case.without_loads(missing),
        problem=problem,
        seal_mesh=seal_mesh,
        model=model,
        loads=tuple(map(JudgedLoad.of, _judged(after, problem, loads, error, before))),
        unloaded=solved.unloaded,
        earlier=solved.earlier,
        discretisation_error=error,
        far_field=far,
        form=answers,
        particles=particles,
        interface_variants=variants,
        warnings=tuple(caution.text for caution in worst_first(found)),
        timings=clock.timings,
    )
    result = _with_theory_variants(result, clock, after)
    result = _with_uncertainty(result, clock, after)
    result = _with_verdict_forces(result, clock, after, verdict_force)
    points = {whole.loads.points[number]: problem for number, problem in missing.items()}
    result = after.get("verdict on the requirement", partial(_with_judgement, result, points), result)
    # of a path of loads they take as long as a dozen paths: only if they are asked for
    unasked = case.requirement is not None and not problem.curves
    result = _with_levers(result, clock, after, unasked if levers is None else levers)
    return replace(result, warnings=(*result.warnings, *after.failures))


def _on_coarser_elements(
    problem: SealProblem, seal_mesh: SealMesh, loads: Sequence[LoadResult], clock: Clock, after: Afterwards
) -> tuple[DiscretisationError, tuple[Comparison, ...]]:
    """Discretisation error and influence of the far field, of the strongest load.

    The bodies on coarser elements are gone when this is done.
    """
    coarser, error = None, NOT_ESTIMATED
    with clock.step("error", "estimating the discretisation error"), after.going_on("discretisation error"):
        strongest = strongest_load(loads)
        coarser = on_coarser_mesh(problem, seal_mesh.sizing, strongest)
        error = discretisation_error(loads[strongest].contact, coarser, seal_mesh.sizing)
    if coarser is None:
        return error, ()
    with clock.step("far field", "comparing sizes and supports far from the contact"):
        return error, after.get("influence of the far field", partial(far_field, coarser), ())


def _of_earlier(
    problem: SealProblem, earlier: ContactSolution | None, error: DiscretisationError
) -> tuple[Caution, ...]:
    if earlier is None or problem.loads.earlier is None:
        return ()
    load = LoadResult(*problem.loads.earlier, earlier, mesh_error=error)
    return tuple(earlier_cautions(problem, load))


def _judged(
    after: Afterwards,
    problem: SealProblem,
    loads: Sequence[LoadResult],
    error: DiscretisationError,
    before: Sequence[Caution] = (),
) -> tuple[LoadResult, ...]:
    """Loads with their validity, in which stands what is said against the load before them."""

    def validity(load: LoadResult) -> Validity:
        return Validity.of((*load_validity(problem, load, problem.surface, error).cautions, *before))

    return tuple(
        load.knowing(
            validity=after.get(
                f"validity at {given('fluid pressure', load.fluid_pressure)}",
                partial(validity, load),
                NOT_JUDGED,
            )
        )
        for load in loads
    )


def _with_theory_variants(result: SealSolution, clock: Clock, after: Afterwards) -> SealSolution:
    if not result.case.leak.variants:
        return result

    with clock.step("theory", "leak rates with every reading of the theory"):
        variants = after.get(
            "leak rates with every reading of the theory", partial(theory_variants, result), ()
        )
        return replace(result, theory_variants=variants)


def _with_uncertainty(result: SealSolution, clock: Clock, after: Afterwards) -> SealSolution:
    if result.case.sampled is None:
        return result
    from fem_seal.answers.uncertainty import leak_interval

    with clock.step("uncertainty", "leak rates of uncertain inputs"):
        calculate = partial(leak_interval, result, progress=clock.progress)
        found = after.get("interval of the leak rates", calculate, None)
        loads = result.loads if found is None else found.of(result.loads)
        return replace(result, uncertainty=found, loads=loads)


def _with_verdict_forces(
    result: SealSolution, clock: Clock, after: Afterwards, wanted: bool | None
) -> SealSolution:
    if wanted is False or result.case.load.target_leak_rate is None or not result.problem.leaks:
        return result
    if wanted is None and result.problem.curves:
        loads = [load.knowing(verdict_force=_TOO_DEAR) for load in result.loads]
        return replace(result, loads=tuple(loads))
    from fem_seal.answers.verdict_force import forces_for_verdict

    with clock.step("verdict force", "force with which the verdict passes"):
        ask = partial(
            forces_for_verdict, result, partial(_alone, result, clock.progress), progress=clock.progress
        )
        found = after.get("force with which the verdict passes", ask, None)
    if found is None:
        return result
    loads = [load.knowing(verdict_force=one) for load, one in zip(result.loads, found, strict=True)]
    return replace(result, loads=tuple(loads))


def _alone(result: SolvedSeal, progress: Progress, fluid_pressure: float, applied_force: float) -> LoadResult:
    """One load of a case that has no other, with validity, mesh error and samples."""
    point = fluid_pressure, applied_force
    loads = replace(result.problem.loads, points=(point,), refused={}, target_leak_rate=None)
    problem = replace(result.problem, loads=loads)
    clock = Clock(progress)
    seal_mesh, model, solved = model_and_contacts(problem, clock)
    (formed,) = solved.around
    load = LoadResult(*point, solved.contacts[0], formed=formed)
    load = load.knowing(rough=RoughFlow.of(problem.surface, problem.flow, load.contacts))
    with clock.step("error", "estimating the discretisation error"):
        coarser = on_coarser_mesh(problem, seal_mesh.sizing, 0)
        error = discretisation_error(load.contact, coarser, seal_mesh.sizing)
    before = _of_earlier(problem, solved.earlier, error)
    found = (*load_validity(problem, load, problem.surface, error).cautions, *before)
    load = load.knowing(mesh_error=error, validity=Validity.of(found))
    if result.case.sampled is None or load.validity.outside:
        return load
    from fem_seal.answers.uncertainty import leak_interval

    alone = SolvedSeal(result.case, problem, seal_mesh, model, (load,), earlier=solved.earlier)
    (load,) = leak_interval(alone, progress=progress).of(alone.loads)
    return load


def _with_levers(result: SealSolution, clock: Clock, after: Afterwards, wanted: bool) -> SealSolution:
    if not wanted:
        return result
    from fem_seal.answers.sensitivities import levers

    with clock.step("levers", "what changes the leak rate most"):
        judged = result.judgement
        ask = partial(levers, result, None if judged is None else judged.number)
        return replace(result, levers=after.get("levers on the leak rate", ask, ()))


def _with_judgement(result: SealSolution, missing: Mapping[tuple[float, float], LoadProblem]) -> SealSolution:
    """The result with what is said of its requirement; `missing` are loads without a result."""
    if result.case.requirement is None:
        return result
    open_inputs = result.problem.usual_only or result.case.sampled is not None
    sampled = result.uncertainty is not None or not open_inputs
    loads = with_judgements(result.case, result.loads, sampled=sampled)
    judgement = seal_judgement(result.case, loads, missing, result.problem.hardness)
    return replace(result, loads=loads, judgement=judgement)


def _without(problem: SealProblem, numbers: Collection[int]) -> SealProblem:
    return replace(problem, loads=problem.loads.without(numbers)) if numbers else problem


def _with_tables(after: Afterwards, rough: RoughFlow | None) -> RoughFlow | None:
    if rough is None:
        return None
    rough = after.settled(rough, {"table": "flow conductivity"})
    return rough.with_readings(
        {
            reading: after.settled(other, {"table": f"flow conductivity of {WORDS[reading].asperities}"})
            for reading, other in _others(rough)
        }
    )


def _others(one: Read) -> Iterator[tuple[Reading, Read]]:
    """A load, or its surfaces, in all other readings, with asperities that never yield to compare with."""
    for reading in dict.fromkeys((*one.readings, Reading.ELASTIC)):
        if (other := one.reading(reading)) is not one:
            yield reading, other


def _read(after: Afterwards, load: LoadResult, steps: Mapping[str, str]) -> LoadResult:
    """A load with some of its values worked out in all readings."""
    load = _settled(after, load, steps)
    others = {
        reading: _settled(
            after, one, {name: f"{what} of {WORDS[reading].asperities}" for name, what in steps.items()}
        )
        for reading, one in _others(load)
    }
    return load.with_readings(others)


def _settled(
    after: Afterwards, load: LoadResult, steps: Mapping[str, str], otherwise: object = None
) -> LoadResult:
    at = given("fluid pressure", load.fluid_pressure)
    return after.settled(load, {name: f"{what} at {at}" for name, what in steps.items()}, otherwise)
