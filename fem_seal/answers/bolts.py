"""What the bolts of a seal carry under each load, and the torque that keeps the leak rate below a target."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.judgement import BoltState
from fem_seal.bolts import Bolts
from fem_seal.errors import ConvergenceError
from fem_seal.seal.findings import Bounds
from fem_seal.seal.load_solver import LoadSolver, solve_loads


@dataclass(frozen=True)
class BoltAnswers:
    """Bolts of a seal under its loads.

    Parameters
    ----------
    bolts : Bolts
    loads : tuple of BoltState
        One for each load.
    leak_rates : tuple of Bounds or None
        Leak rate of each load at the ends of the preload's scatter [m^3/s]; None without scatter.
    """

    bolts: Bolts
    loads: tuple[BoltState, ...]
    leak_rates: tuple[Bounds | None, ...]


def _compute(seal: SolvedSeal, request: Request) -> BoltAnswers:
    bolts, preloads = seal.problem.loads.bolts, [force for _, force in seal.case.load.points]
    assert bolts is not None  # of `applies`
    material = None if seal.case.bolts is None else seal.case.bolts.material
    strength = None if material is None else material.yield_stress
    states = tuple(
        _state(bolts, preload, load, strength) for preload, load in zip(preloads, seal.loads, strict=True)
    )
    no_rates = (None,) * len(states)
    ends = (
        no_rates
        if bolts.scatter == 0.0
        else request.steps.compute(
            "leak rate at the ends of the preload", lambda: _leak_at_ends(seal, request, bolts), no_rates
        )
    )
    return BoltAnswers(bolts, states, tuple(ends))


def _state(bolts: Bolts, preload: float, load: CaseLoad, strength: float | None) -> BoltState:
    number, target, force = bolts.equivalent_number, load.preload_for_target, load.force_for_target
    stress = bolts.stress(max(preload, load.applied_force))
    torques = [None if tension is None else bolts.torque(tension) for tension in (preload, target)]
    return BoltState(
        preload / number,
        load.applied_force / number,
        stress,
        None if strength is None else stress / strength,
        torques[0],
        None if target is None else target / number,
        torques[1],
        None if target is None or force is None else bolts.stress(max(target, force)),
    )


def _leak_at_ends(seal: SolvedSeal, request: Request, bolts: Bolts) -> Sequence[Bounds | None]:
    """Leak rate of each load with all bolts at the least and at the largest preload."""
    factors = [1.0 + end * bolts.scatter for end in (-1.0, 1.0)]
    rates = [_leak_rates(seal, request, bolts, factor) for factor in factors]
    return [
        None if math.isnan(low + high) else Bounds.of((low, high)) for low, high in zip(*rates, strict=True)
    ]


def _leak_rates(seal: SolvedSeal, request: Request, bolts: Bolts, factor: float) -> list[float]:
    """Leak rate of each load with another preload, infinite where it opens the seal [m^3/s]; NaN where not found."""
    problem, loads = seal.problem, seal.problem.loads
    preloads = [factor * preload for _, preload in seal.case.load.points]
    loads = loads.with_preloads(bolts, preloads)
    open_loads = [n for n, point in enumerate(loads.points) if not problem.expected_force(*point) > 0]
    if len(open_loads) == len(preloads):
        return [math.inf] * len(preloads)
    closed_loads = [number for number in range(len(preloads)) if number not in open_loads]
    solver = LoadSolver(replace(problem, loads=loads.without_loads(open_loads)), seal.model)
    solved_loads = solve_loads(solver, request.clock.progress, contacts_only=True)
    numbers = [n for n in range(len(closed_loads)) if n not in solved_loads.failures]
    points = [solved_loads.points[number] for number in numbers]
    leaks = [load.leak for load in solved_loads.results(problem, points)]
    rates = dict.fromkeys(open_loads, math.inf)
    for n, leak in zip(numbers, leaks, strict=True):
        rates[closed_loads[n]] = math.nan if leak is None else leak.leak_rate
    for n, error in solved_loads.failures.items():
        # what does not converge says nothing; all else leaves the seal open
        rates[closed_loads[n]] = math.nan if isinstance(error, ConvergenceError) else math.inf
    return [rates[number] for number in sorted(rates)]


def _of_load(load: CaseLoad, number: int, answers: BoltAnswers | None) -> CaseLoad:
    if answers is None:
        return load
    ends = answers.leak_rates[number]
    return load.with_values(bolts=answers.loads[number], at_preload_ends=ends)


BOLTS = Answer[BoltAnswers | None](
    "bolts",
    "force of the bolts",
    _compute,
    None,
    of_load=_of_load,
    status="bolts",
    needs=("problem.loads.bolts",),
)
