"""The same loads by the other theory of the rough contact, each on a contact of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from fem_seal.answers.answer import Answer, Inquiry
from fem_seal.contact.newton import solve_together
from fem_seal.seal.leak_model import RoughFlow
from fem_seal.seal.load_result import LoadResult, highest_load
from fem_seal.seal.load_solver import LoadSolver, linearised_again, solve_loads
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.solved_seal import SolvedSeal
from fem_seal.units import given
from leak import Reading

# Loads by theory, in the order of the result; None where a theory has no contact.
ByTheory = Mapping[str, Sequence[LoadResult | None]]


@dataclass(frozen=True)
class Theories:
    """The loads by the theories that they are not calculated with.

    Parameters
    ----------
    loads : mapping
        By theory, in the order of the result; None where a theory has no contact or no leak rate.
    same_contact : mapping
        Leak rate by theory through the very contact of the highest load [m^3/s].
    """

    loads: ByTheory = field(default_factory=dict)
    same_contact: Mapping[str, float] = field(default_factory=dict)


def by_theory(seal: SolvedSeal) -> ByTheory:
    """The loads of a seal by each theory that they are not calculated with.

    Where a body yields it is linearised at each load; what it would have yielded otherwise on the way is left out.

    Parameters
    ----------
    seal : SolvedSeal
    """
    problem = seal.problem
    return {theory: _loads(seal, problem.in_theory(theory)) for theory in problem.other_theories}


def _loads(seal: SolvedSeal, problem: SealProblem) -> list[LoadResult | None]:
    found: dict[int, LoadResult] = {}
    if problem.curves:
        for number, contact in enumerate(linearised_again(seal.contact, problem.law)):
            found[number] = LoadResult(*seal.loads[number].point, contact)
    else:
        solver = LoadSolver(problem, seal.model)
        asked = solver.pressings()
        solved = solve_loads(solver, pressed=dict(zip(asked, solve_together([*asked.values()]), strict=True)))
        closed = [number for number in range(len(seal.loads)) if number not in solved.failures]
        for number, contact, around in zip(closed, solved.contacts, solved.around, strict=True):
            found[number] = LoadResult(*seal.loads[number].point, contact, formed=around)
    shown = [contact for load in found.values() for contact in load.contacts]
    rough = RoughFlow.of(problem.surface, problem.flow, shown) if shown else None
    return [
        found[number].knowing(rough=rough, mesh_error=load.mesh_error, opening=load.opening)
        if number in found
        else None
        for number, load in enumerate(seal.loads)
    ]


def _compute(seal: SolvedSeal, ask: Inquiry) -> Theories:
    highest = highest_load(seal.loads)

    def settled(load: LoadResult, what: str) -> LoadResult:
        at = given("fluid pressure", load.fluid_pressure)
        return ask.steps.compute_values(load, {"leak": f"{what} at {at}"})

    def known(theory: str, number: int, load: LoadResult) -> LoadResult | None:
        load = settled(load, f"leak rate by the {theory} theory")
        if load.leak is None:
            return None
        if number != highest or (elastic := load.reading(Reading.ELASTIC)) is load:
            return load
        # of what yielding makes of it one load is told
        what = f"leak rate by the {theory} theory of elastic asperities"
        return load.with_readings({Reading.ELASTIC: settled(elastic, what)})

    found = {
        theory: [None if load is None else known(theory, n, load) for n, load in enumerate(loads)]
        for theory, loads in by_theory(seal).items()
    }
    same_contact = {}
    for theory, loads in found.items():
        other = loads[highest]
        leak = None if other is None else replace(seal.loads[highest], rough=other.rough).leak
        if leak is not None:
            same_contact[theory] = leak.leak_rate
    return Theories(found, same_contact)


def _of_load(load: LoadResult, number: int, found: Theories) -> LoadResult:
    return load.knowing(
        by_theory={theory: one for theory, each in found.loads.items() if (one := each[number])}
    )


THEORIES = Answer[Theories](
    "theories",
    "leak rates by the other theory",
    _compute,
    Theories(),
    lambda seal, wanted: bool(seal.problem.other_theories),
    _of_load,
    "contacts and leak rates by the other theory",
)
