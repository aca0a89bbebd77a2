"""Verdict on the requirement, of each load and of all together, and the force at which it passes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from fem_seal.answers.accuracy import discretisation_error, on_coarser_mesh
from fem_seal.answers.answer import Answer, Request, loads_of, with_scenarios
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.force_search import End, Trials, Zero, find_zero, search_forces, sensible_forces
from fem_seal.answers.judgement import (
    LoadVerdict,
    SealVerdict,
    Utilisation,
    Verdict,
    VerdictForce,
    VerdictReason,
    severity,
)
from fem_seal.answers.leakage_class import limit_of_rate, limits
from fem_seal.answers.two_flanges import load_of_parts
from fem_seal.answers.uncertainty import UNCERTAINTY, leak_interval
from fem_seal.case.case import Case
from fem_seal.errors import ConvergenceError, InputError, OpenSealError, Problem
from fem_seal.seal.evaluate import evaluate_seal
from fem_seal.seal.findings import sentence
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import Clock, Progress
from fem_seal.seal.problem import SealProblem, under_loads
from fem_seal.seal.scenarios import with_own_contacts
from fem_seal.validity.checks import load_validity
from fem_seal.wording import Quantity, Words


def load_verdict(case: Case, load: CaseLoad, *, complete: bool = True) -> LoadVerdict | None:
    """What is said of one load; None without a requirement for it.

    Parameters
    ----------
    case : Case
    load : CaseLoad
        With its validity, what its mesh leaves uncertain and its samples.
    complete : bool
        Whether the interval holds what the inputs leave open.
    """
    requirement = case.requirement
    if requirement is None or not requirement.judges(load.fluid_pressure):
        return None
    return max(limit_verdicts(case, load, complete=complete), key=severity, default=None)


def limit_verdicts(case: Case, load: CaseLoad, *, complete: bool = True) -> list[LoadVerdict]:
    """What is said of one load against each limit; where nothing is required of it the target leak rate is the limit.

    Parameters
    ----------
    case, load, complete
        See `load_verdict`.
    """
    requirement, target = case.requirement, case.load.target_leak_rate
    if requirement is not None and requirement.judges(load.fluid_pressure):
        case_limits = limits(case, load.fluid_pressure, load)
    else:
        case_limits = () if target is None else (limit_of_rate(target),)
    ends = load.leak_interval or (math.nan, math.nan)
    validity, core = load.leak_validity, load.calculated_ends
    return [LoadVerdict.of(limit, ends, validity, complete=complete, core=core) for limit in case_limits]


def with_verdicts(case: Case, loads: Sequence[CaseLoad], *, complete: bool = True) -> tuple[CaseLoad, ...]:
    """Loads with what is said of them.

    Parameters
    ----------
    case : Case
    loads : sequence of CaseLoad
    complete : bool
        See `load_verdict`.
    """
    return tuple(load.with_values(judgement=load_verdict(case, load, complete=complete)) for load in loads)


def seal_verdict(
    case: Case,
    loads: Sequence[CaseLoad],
    load_problems: Mapping[tuple[float, float], Problem],
    hardness: float | None = None,
) -> SealVerdict | None:
    """What is said of the seal; None without a requirement.

    Parameters
    ----------
    case : Case
    loads : sequence of CaseLoad
        With their verdicts.
    load_problems : mapping
        Fluid pressure [Pa] and applied force [N] of each load without a result, with the reason.
    hardness : float, optional
        Of the softer body, of several parts that of the first [Pa].
    """
    requirement = case.requirement
    if requirement is None:
        return None
    judged_loads: list[tuple[int, tuple[float, float], LoadVerdict]] = [
        (number, load.point, load.judgement) for number, load in enumerate(loads) if load.judgement
    ]
    left_out = [
        (None, point, missing_verdict(case, point, problem))
        for point, problem in load_problems.items()
        if requirement.judges(point[0])
    ]
    rows = [*judged_loads, *left_out]
    if not rows:
        return None
    number, point, worst = max(rows, key=lambda row: severity(row[2]))
    numbers = tuple(number for number, _, _ in judged_loads)
    hard = (hardness, *(part.hardness for part in case.parts[1:]))
    shares = _shares([loads[n] for n in numbers], hard)
    return SealVerdict(worst, *point, number, numbers, len(left_out), shares)


def missing_verdict(case: Case, point: tuple[float, float], problem: Problem) -> LoadVerdict:
    """What is said of a load that has no result.

    Parameters
    ----------
    case : Case
        With a requirement.
    point : tuple of float
        Fluid pressure [Pa] and applied force [N].
    problem : Problem
        Why it has none.
    """
    limit = limits(case, point[0])[0]
    if problem.kind == "open":
        return LoadVerdict(Verdict.FAIL, 0.0, VerdictReason.OPEN, limit)
    why = Words("{{ problem.message_in(display) }}", {"problem": problem})
    return LoadVerdict(Verdict.INCONCLUSIVE, math.nan, VerdictReason.UNKNOWN, limit, reason=why)


def _crest(load: LoadResult) -> float:
    """Largest peak pressure around the axis over that at the mean line load; a stress follows it, as in the checks."""
    return (
        1.0
        if load.circumference is None
        else float(load.circumference.peak_pressure.max()) / load.peak_pressure
    )


def _shares(loads: Sequence[CaseLoad], hardness: Sequence[float | None]) -> Utilisation:
    """The largest of all loads and their parts, each of which has a hardness."""
    stresses = [
        (_crest(load) * float(load.contact.fields[name].von_mises.max()) / limit, body)
        for whole_load in loads
        for body, (number, name) in whole_load.named_bodies.items()
        # without a look at the stress, which a model without displacements does not hold
        if not (load := whole_load.parts[number]).of_profile
        and (limit := getattr(load.contact.model, name).material.yield_stress) is not None
    ]
    stress, body = max(stresses, default=(None, ""))
    openings = [load.opening.share for load in loads if load.opening is not None]
    peaks = [
        _crest(load) * load.peak_pressure / hard
        for whole_load in loads
        for load, hard in zip(whole_load.parts, hardness, strict=False)
        if hard is not None
    ]
    return Utilisation(stress, body, max(peaks, default=None), min(openings, default=None))


@dataclass(frozen=True)
class Verdicts:
    """What is said of a seal and of each of its loads.

    Parameters
    ----------
    seal : SealVerdict or None
    of_loads : tuple of LoadVerdict or None
    of_scenarios : mapping
        Number and judgement of the load that would decide in a scenario with contacts of its own, and the verdict in
        the nominal one, both with the inputs as given; where these verdicts differ.
    """

    seal: SealVerdict | None = None
    of_loads: tuple[LoadVerdict | None, ...] = ()
    of_scenarios: Mapping[str, tuple[int, LoadVerdict, Verdict]] = field(default_factory=dict)


def _compute(seal: SolvedSeal, request: Request) -> Verdicts:
    open_inputs = seal.problem.origin.usual_only or seal.case.sampling is not None
    complete = UNCERTAINTY.of(request.answers) is not None or not open_inputs
    loads = with_verdicts(seal.case, seal.loads, complete=complete)
    verdict = seal_verdict(seal.case, loads, seal.load_problems, seal.problem.hardness)
    return Verdicts(verdict, tuple(load.judgement for load in loads), _in_scenarios(seal))


def _in_scenarios(seal: SolvedSeal) -> dict[str, tuple[int, LoadVerdict, Verdict]]:
    nominal = _worst_verdict(seal.case, [load.with_values(sample_ends=None) for load in seal.loads])
    verdicts = {}
    for scenario in with_own_contacts(seal.problem):
        other = _worst_verdict(seal.case, [load.scenarios.get(scenario.name) for load in seal.loads])
        if nominal is not None and other is not None and nominal[1].verdict is not other[1].verdict:
            verdicts[scenario.name] = (*other, nominal[1].verdict)
    return verdicts


def _worst_verdict(case: Case, loads: Sequence[CaseLoad | None]) -> tuple[int, LoadVerdict] | None:
    verdicts = [
        (number, verdict)
        for number, load in enumerate(loads)
        if load is not None and (verdict := load_verdict(case, load)) is not None
    ]
    return max(verdicts, key=lambda pair: severity(pair[1]), default=None)


VERDICT = Answer[Verdicts](
    "verdict",
    "verdict on the requirement",
    _compute,
    Verdicts(),
    of_load=lambda load, n, value: load.with_values(judgement=value.of_loads[n]) if value.of_loads else load,
    needs=("case.requirement",),
)


# ln of the upper end over the limit is kept within this: sealed and open are something, too.
_LARGEST_EXCESS = 20.0
# The force that is told passes, this much less in ln F (three per cent) does not, and it stands so far above the root.
_FORCE_STEP, _ABOVE_ROOT = 0.0304, 0.01
# Accuracy of a root in ln F.
_ACCURACY = 2e-3
# Change over ln F of what samples and mesh add, at most.
_STEEPEST = 3.0
_MOST_RUNS = 8

Alone = Callable[[float, float], CaseLoad]
# ln of a contact force, and what samples and mesh add there to ln of the upper end.
Addition = tuple[float, float]


def forces_for_verdict(
    result: SolvedSeal, alone: Alone, *, progress: Progress = lambda text: None
) -> list[VerdictForce]:
    """The smallest force of spring or actuator with which the verdict passes, for each load's fluid pressure.

    The verdict is that on the requirement of the case; where there is none at a pressure, on its target leak rate.

    Parameters
    ----------
    result : SolvedSeal
        With a leak rate and the target that asks for the force.
    alone : callable
        The same seal under one fluid pressure [Pa] and applied force [N] alone, as a run of such a case gives it: with
        validity, mesh error and samples.
    progress : callable
        Called with a status message before each trial.

    Notes
    -----
    The upper end of both readings of asperities that yield, with the factors that count there, is looked for as the
    force for a target leak rate is. What samples and mesh add is taken from runs with the force that was found, and the
    root looked for again with that, until such a run passes and one with 3 % less force would not.
    """
    problem, case = result.problem, result.case
    by_pressure = {load.fluid_pressure: load for load in reversed(result.loads)}
    sampled_loads = {
        pressure: load
        for pressure, load in by_pressure.items()
        if not (problem.origin.usual_only or (case.sampling is not None and load.sample_ends is None))
    }
    lowest, highest = sensible_forces(result.problems)
    starts = {
        pressure: min(
            max(load.contact_force_for_target or load.contact_force, math.exp(lowest)), math.exp(highest)
        )
        for pressure, load in sampled_loads.items()
    }
    searches: dict[float, _Search] = {}

    def find(trials: Trials, start: float) -> Zero | None:
        search = _Search(result, sampled_loads[trials.fluid_pressure], trials, alone, progress)
        searches[trials.fluid_pressure] = search
        return search.zero(start, [search.added_at_first()])

    ends = search_forces(result.problems, starts, find, progress) if starts else {}
    forces = {pressure: searches[pressure].force(zero) for pressure, (_, zero) in ends.items()}
    no_interval = VerdictForce(None, sentence("verdict_force", "no_interval"))
    begins = _begins(problem)
    return [replace(forces.get(load.fluid_pressure, no_interval), begins=begins) for load in result.loads]


@dataclass(frozen=True)
class _Search:
    """The search at the fluid pressure of one load.

    Parameters
    ----------
    result : SolvedSeal
    load : CaseLoad
    trials : Trials
    alone : callable
        See `forces_for_verdict`.
    progress : callable
        Told each force that is tried.
    """

    result: SolvedSeal
    load: CaseLoad
    trials: Trials
    alone: Alone
    progress: Progress
    outcomes: dict[float, CaseLoad | None] = field(default_factory=dict)
    """Loads by ln of their contact force, without samples and mesh error; None of what cannot be solved."""

    def force(self, zero: Zero | None) -> VerdictForce:
        """The smallest force that passes, or why there is none, from where the search without samples ended."""
        if zero is None:
            return VerdictForce(None, self._outside_everywhere())
        additions, low, high = [self.added_at_first()], -math.inf, math.inf
        passes: CaseLoad | None = None
        for _ in range(_MOST_RUNS):
            if zero is None or zero.end is not None:
                return VerdictForce(None, self._why_none(zero)) if passes is None else _force_of(passes)
            at = min(zero.place + _ABOVE_ROOT, high - _FORCE_STEP)
            at = at if low < at else 0.5 * (low + high) if math.isfinite(high) else low + _ABOVE_ROOT
            run = self._run_alone(at)
            value = _LARGEST_EXCESS if run is None or run.validity.outside_theory else self._excess(run)
            if run is not None and value <= 0.0:
                high, passes = at, run
            else:
                low = at
            nominal = self._value(at)
            additions.append((at, value - (_LARGEST_EXCESS if nominal is None else nominal)))
            # one that is tried already spares the trial of the smallest that counts
            places = [*(place for place in self.outcomes if at - _FORCE_STEP < place < at), at - _FORCE_STEP]
            fails = (self._value_with(additions, place) for place in places)
            if passes is not None and (
                high - low <= 1.01 * _FORCE_STEP
                or (high == at and any(excess is None or excess > 0.0 for excess in fails))
            ):
                return _force_of(passes)
            zero = self.zero(at, additions)
        if passes is None:
            return VerdictForce(None, sentence("verdict_force", "not_found"))
        return _force_of(passes)

    def zero(self, start: float, additions: Sequence[Addition]) -> Zero | None:
        """Where the upper end comes down to the limit with what samples and mesh add."""
        lowest, highest = sensible_forces(self.result.problems)
        return find_zero(
            partial(self._value_with, additions), start, lowest=lowest, highest=highest, accuracy=_ACCURACY
        )

    def _run_alone(self, at: float) -> CaseLoad | None:
        load = self._load(at)
        if load is None:
            return None
        self._tell("the whole run with {{ force | quantity('short force') }} applied", load.applied_force)
        try:
            return self.alone(load.fluid_pressure, load.applied_force)
        except (ConvergenceError, InputError):
            return None

    def added_at_first(self) -> Addition:
        """What the samples add at the load of the case."""
        at = math.log(max(self.load.contact_force, math.exp(sensible_forces(self.result.problems)[0])))
        samples, leak_range = self.load.sample_ends, self.load.leak_range
        rate = math.nan if self.load.leak is None else self.load.leak.leak_rate
        largest = self.load.theory_error.high * (rate if leak_range is None else leak_range[1])
        if samples is None or not (0.0 < largest < math.inf and 0.0 < samples[1] < math.inf):
            return at, 0.0
        return at, max(math.log(samples[1] / largest), 0.0)

    def _excess(self, load: CaseLoad) -> float:
        """ln of the upper end over the limit, of several limits the largest; positive unless the verdict passes."""
        return max(map(_excess, limit_verdicts(self.result.case, load)))

    def _value(self, at: float) -> float | None:
        """The same at ln of a contact force, without samples and mesh error; None where nothing is known."""
        load = self._load(at)
        return None if load is None or load.validity.outside_theory else self._excess(load)

    def _value_with(self, additions: Sequence[Addition], at: float) -> float | None:
        value = self._value(at)
        return None if value is None else min(value + _extrapolate(additions, at), _LARGEST_EXCESS)

    def _load(self, at: float) -> CaseLoad | None:
        if at not in self.outcomes:
            self._tell("a contact force of {{ force | quantity('short force') }}", math.exp(at))
            try:
                load = with_scenarios(self.result.problems, self.trials.load(at))
            except (ConvergenceError, InputError, OpenSealError):
                self.outcomes[at] = None
            else:
                self.outcomes[at] = load_of_parts([*map(_with_validity, self.result.problems, load.parts)])
        return self.outcomes[at]

    def _tell(self, trial: str, force: float) -> None:
        at = "force with which the verdict passes at {{ pressure | quantity('short fluid pressure') }}: trying "
        values = {"pressure": self.load.fluid_pressure, "force": force}
        self.progress(Words(f"{at}{trial}", values).text(self.result.case.display))

    def _why_none(self, zero: Zero | None) -> Words:
        if zero is None:
            return self._outside_everywhere()
        if zero.end is End.LOWEST:
            return sentence("verdict_force", "any")
        highest = sensible_forces(self.result.problems)[1]
        load, next_load = self._load(zero.place), self._load(min(zero.place + _ACCURACY, highest))
        stop_force = 0.0 if load is None else load.contact.stop_force
        force = "that" if load is None else Quantity(load.applied_force - stop_force, "short force")
        is_outside = next_load is not None and next_load.validity.outside_theory
        kind = "stopped" if stop_force else "outside" if is_outside else "strains"
        ends = sentence("verdict_force", kind, load=next_load)
        why = "" if load is None else load.leak_validity.leak_clause(more=True)
        doubt = sentence("verdict_force", "off", why=why) if why else ""
        return sentence("verdict_force", "more_leaks", force=force, off=doubt, ends=ends)

    def _outside_everywhere(self) -> Words:
        reasons = [
            x.validity.doubts[0].in_clause for x in self.outcomes.values() if x and x.validity.outside_theory
        ]
        return sentence("verdict_force", "nowhere", why=reasons[0] if reasons else "no contact converges")


def _force_of(load: CaseLoad) -> VerdictForce:
    return VerdictForce(load.applied_force)


def _with_validity(problem: SealProblem, load: CaseLoad) -> CaseLoad:
    return load.with_values(validity=load_validity(problem, load))


def _begins(problem: SealProblem) -> str | Words:
    """What every force meets that is tried, where loads leave something behind."""
    if problem.loads.preparation:
        return f"after {problem.loads.preparation}"
    return sentence("verdict_force", "on_new") if problem.follows_path else ""


def _extrapolate(additions: Sequence[Addition], at: float) -> float:
    """What samples and mesh add at ln of a force, on a line through the last two that are known."""
    last, value = additions[-1]
    if len(additions) < 2 or abs(last - additions[-2][0]) < _ABOVE_ROOT:
        return value
    slope = (value - additions[-2][1]) / (last - additions[-2][0])
    return value + min(max(slope, -_STEEPEST), _STEEPEST) * (at - last)


def _excess(claim: LoadVerdict) -> float:
    if claim.verdict is Verdict.PASS:
        return -min(math.log(claim.margin), _LARGEST_EXCESS) if claim.margin < math.inf else -_LARGEST_EXCESS
    if not 0.0 < claim.margin < 1.0:
        # of what must not be seen there is no margin
        return 1.0 if math.isnan(claim.margin) else _LARGEST_EXCESS
    return min(-math.log(claim.margin), _LARGEST_EXCESS)


def _forces(seal: SolvedSeal, request: Request) -> Sequence[VerdictForce]:
    if request.verdict_force is None and seal.problem.follows_path:
        # where a body yields the force takes minutes
        return [VerdictForce(None, sentence("verdict_force", "too_dear"), looked_for=False)] * len(seal.loads)
    progress = request.clock.progress
    with request.clock.step("verdict force", VERDICT_FORCE.subject):
        return forces_for_verdict(seal, partial(_alone, seal, progress), progress=progress)


def _alone(seal: SolvedSeal, progress: Progress, fluid_pressure: float, applied_force: float) -> CaseLoad:
    """One load of a case that has no other, with validity, mesh error and samples."""
    point = fluid_pressure, applied_force
    loads = replace(seal.problem.loads, points=(point,), refusals={}, target_leak_rate=None)
    clock = Clock(progress)
    evaluations = evaluate_seal(under_loads(seal.problems, loads), clock=clock)
    alone = SolvedSeal.of(evaluations, seal.case, loads_of(evaluations))

    def with_accuracy(part: SolvedSeal) -> CaseLoad:
        problem, sizing, (load,) = part.problem, part.seal_mesh.sizing, part.loads
        with clock.step("error", "estimating the discretisation error"):
            error = discretisation_error(load.contact, on_coarser_mesh(problem, sizing, 0), sizing)
        return _with_validity(problem, load.with_values(mesh_error=error))

    load = load_of_parts([*map(with_accuracy, alone.parts)])
    if seal.case.sampling is None or load.validity.outside_theory:
        return load
    return leak_interval(alone.with_loads([load]), progress=progress).of_load(load, 0)


VERDICT_FORCE = Answer[Sequence[VerdictForce]](
    "verdict_force",
    "force with which the verdict passes",
    _forces,
    (),
    # with bolts the force is none that somebody applies
    lambda seal, request: seal.case.bolts is None,
    lambda load, number, forces: load.with_values(verdict_force=forces[number]) if forces else load,
    needs=("case.load.target_leak_rate", "problem.leaks"),
    request_field="verdict_force",
)
