"""Verdict on the requirement: each load against its limits, and all loads together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from fem_seal.answers.answer import Answer, Inquiry
from fem_seal.answers.judgement import JudgedLoad, Judgement, SealJudgement, Shares, Verdict, Why, severity
from fem_seal.answers.leakage_class import limit_of_rate, limits
from fem_seal.answers.uncertainty import UNCERTAINTY
from fem_seal.case.case import Case
from fem_seal.errors import LoadProblem
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.solved_seal import SolvedSeal


def judged(case: Case, load: LoadResult, *, sampled: bool = True) -> Judgement | None:
    """What is said of one load; None without a requirement for it.

    Parameters
    ----------
    case : Case
    load : LoadResult
        With its validity, what its mesh leaves uncertain and its samples.
    sampled : bool
        Whether the interval holds what the inputs leave open.
    """
    required = case.requirement
    if required is None or not required.judges(load.fluid_pressure):
        return None
    return max(judgements(case, load, sampled=sampled), key=severity, default=None)


def judgements(case: Case, load: LoadResult, *, sampled: bool = True) -> list[Judgement]:
    """What is said of one load against each limit; where nothing is required of it the target leak rate is the limit.

    Parameters
    ----------
    case, load, sampled
        See `judged`.
    """
    required, target = case.requirement, case.load.target_leak_rate
    if required is not None and required.judges(load.fluid_pressure):
        against = limits(case, load.fluid_pressure, load)
    else:
        against = () if target is None else (limit_of_rate(target),)
    ends = load.leak_interval or (math.nan, math.nan)
    return [Judgement.of(limit, ends, load.leak_validity, sampled=sampled) for limit in against]


def with_judgements(
    case: Case, loads: Sequence[LoadResult], *, sampled: bool = True
) -> tuple[JudgedLoad, ...]:
    """Loads with what is said of them.

    Parameters
    ----------
    case : Case
    loads : sequence of LoadResult
    sampled : bool
        See `judged`.
    """
    return tuple(JudgedLoad.of(load, judgement=judged(case, load, sampled=sampled)) for load in loads)


def seal_judgement(
    case: Case,
    loads: Sequence[JudgedLoad],
    missing: Mapping[tuple[float, float], LoadProblem],
    hardness: float | None = None,
) -> SealJudgement | None:
    """What is said of the seal; None without a requirement.

    Parameters
    ----------
    case : Case
    loads : sequence of LoadResult
        With their judgements.
    missing : mapping
        Fluid pressure [Pa] and applied force [N] of each load without a result, with the reason.
    hardness : float, optional
        Of the softer body [Pa].
    """
    required = case.requirement
    if required is None:
        return None
    found: list[tuple[int, tuple[float, float], Judgement]] = [
        (number, load.point, load.judgement) for number, load in enumerate(loads) if load.judgement
    ]
    left_out = [
        (None, point, _of_missing(case, point, problem))
        for point, problem in missing.items()
        if required.judges(point[0])
    ]
    every = [*found, *left_out]
    if not every:
        return None
    number, point, worst = max(every, key=lambda one: severity(one[2]))
    numbers = tuple(number for number, _, _ in found)
    shares = _shares([loads[n] for n in numbers], hardness)
    return SealJudgement(worst, *point, number, numbers, len(left_out), shares)


def _of_missing(case: Case, point: tuple[float, float], problem: LoadProblem) -> Judgement:
    limit = limits(case, point[0])[0]
    if problem.kind == "open":
        return Judgement(Verdict.FAIL, 0.0, Why.OPEN, limit)
    return Judgement(Verdict.INCONCLUSIVE, math.nan, Why.UNKNOWN, limit, reason=problem.message)


def _shares(loads: Sequence[LoadResult], hardness: float | None) -> Shares:
    stressed = [
        (float(load.contact.fields[name].von_mises.max()) / limit, name)
        for load in loads
        # without a look at the stress, which a model without displacements does not hold
        for name in ("closure", "seat")
        if (limit := getattr(load.contact.model, name).material.yield_stress) is not None
    ]
    stress, body = max(stressed, default=(None, ""))
    openings = [load.opening.share for load in loads if load.opening is not None]
    peaks = [
        load.peak_pressure if load.formed is None else float(load.formed.peak_pressure.max())
        for load in loads
    ]
    return Shares(
        stress,
        body,
        None if hardness is None or not peaks else max(peaks) / hardness,
        min(openings, default=None),
    )


@dataclass(frozen=True)
class Judgements:
    """What is said of a seal and of each of its loads.

    Parameters
    ----------
    seal : SealJudgement or None
    of_loads : tuple of Judgement or None
    by_theory : mapping
        Number and judgement of the load that would decide by a theory that the loads are not calculated with, and the
        verdict by their own, both with the inputs as given; where these verdicts differ.
    """

    seal: SealJudgement | None = None
    of_loads: tuple[Judgement | None, ...] = ()
    by_theory: Mapping[str, tuple[int, Judgement, Verdict]] = field(default_factory=dict)


def _compute(seal: SolvedSeal, ask: Inquiry) -> Judgements:
    open_inputs = seal.problem.usual_only or seal.case.sampled is not None
    sampled = UNCERTAINTY.of(ask.answers) is not None or not open_inputs
    loads = with_judgements(seal.case, seal.loads, sampled=sampled)
    found = seal_judgement(seal.case, loads, seal.missing, seal.problem.hardness)
    return Judgements(found, tuple(load.judgement for load in loads), _by_theory(seal))


def _by_theory(seal: SolvedSeal) -> dict[str, tuple[int, Judgement, Verdict]]:
    own = _worst(seal.case, [load.knowing(sampled=None) for load in seal.loads])
    found = {}
    for theory in seal.problem.other_theories:
        other = _worst(seal.case, [(load.by_theory or {}).get(theory) for load in seal.loads])
        if own is not None and other is not None and own[1].verdict is not other[1].verdict:
            found[theory] = (*other, own[1].verdict)
    return found


def _worst(case: Case, loads: Sequence[LoadResult | None]) -> tuple[int, Judgement] | None:
    known = [
        (number, one)
        for number, load in enumerate(loads)
        if load is not None and (one := judged(case, load)) is not None
    ]
    return max(known, key=lambda one: severity(one[1]), default=None)


VERDICT = Answer[Judgements](
    "verdict",
    "verdict on the requirement",
    _compute,
    Judgements(),
    lambda seal, wanted: seal.case.requirement is not None,
    lambda load, n, found: load.knowing(judgement=found.of_loads[n]) if found.of_loads else load,
)
