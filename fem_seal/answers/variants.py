"""The same loads by another theory, and with another interface law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import CaseLoad, SolvedSeal, case_loads
from fem_seal.contact.newton import solve_many
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import LoadResult, highest_load, strongest_load
from fem_seal.seal.load_solver import (
    LoadSolver,
    linearised_again,
    solve_load,
    solve_loads,
    solved_again,
)
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.scenarios import theories
from fem_seal.units import format_quantity

# Loads by theory, in the order of the result; None where a theory has no contact.
ByTheory = Mapping[str, Sequence[CaseLoad | None]]


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
    return {scenario.name: _loads_in_theory(seal, scenario.problem) for scenario in theories(problem)}


def _loads_in_theory(seal: SolvedSeal, problem: SealProblem) -> list[CaseLoad | None]:
    found: dict[int, LoadResult] = {}
    if problem.follows_path:
        for number, contact in enumerate(linearised_again(seal.contact, problem.law)):
            found[number] = LoadResult(*seal.loads[number].point, contact)
    else:
        solver = LoadSolver(problem, seal.model)
        asked = solver.pressings()
        solved = solve_loads(solver, pressed=dict(zip(asked, solve_many([*asked.values()]), strict=True)))
        closed = [number for number in range(len(seal.loads)) if number not in solved.failures]
        for number, contact, around in zip(closed, solved.contacts, solved.around, strict=True):
            found[number] = LoadResult(*seal.loads[number].point, contact, formed=around)
    shown = [contact for load in found.values() for contact in load.contacts]
    rough = LeakModel.of(problem.surface, problem.flow, shown) if shown else None
    told = [
        load.with_values(
            rough=rough, mesh_error=seal.loads[number].mesh_error, opening=seal.loads[number].opening
        )
        for number, load in found.items()
    ]
    made = dict(zip(found, case_loads(problem, told), strict=True))
    return [made.get(number) for number in range(len(seal.loads))]


def _compute(seal: SolvedSeal, request: Request) -> Theories:
    highest = highest_load(seal.loads)

    def settled(load: CaseLoad, what: str) -> CaseLoad:
        at = format_quantity("fluid pressure", load.fluid_pressure)
        return request.steps.compute_values(load, {"leak": f"{what} at {at}"})

    def known(theory: str, number: int, load: CaseLoad) -> CaseLoad | None:
        load = settled(load, f"leak rate by the {theory} theory")
        if load.leak is None:
            return None
        if number != highest or (elastic := load.scenarios.get("elastic")) is None:
            return load
        # of what yielding makes of it one load is told
        what = f"leak rate by the {theory} theory of elastic asperities"
        return load.with_scenarios({"elastic": settled(elastic, what)})

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


def _of_load(load: CaseLoad, number: int, found: Theories) -> CaseLoad:
    return load.with_scenarios({theory: one for theory, each in found.loads.items() if (one := each[number])})


THEORIES = Answer[Theories](
    "theories",
    "leak rates by the other theory",
    _compute,
    Theories(),
    lambda seal, request: any(theories(seal.problem)),
    _of_load,
    "contacts and leak rates by the other theory",
    of_face=True,
)


def _with_law(problem: SealProblem, plastic: bool) -> SealProblem:
    return replace(problem, interface=problem.interface.model_copy(update={"plastic": plastic}))


def interface_variants(solver: LoadSolver, loads: Sequence[CaseLoad]) -> tuple[Comparison, ...]:
    """The load with the largest closing force with p(u) of the elastic and of the plastically smoothed surface."""
    problem = solver.problem
    surface = problem.surface
    if surface is None or surface.hardness is None or surface.theory != "paper":
        return ()
    if problem.interface.law != "spectrum":
        return ()
    strongest = strongest_load(loads)
    load, variants = loads[strongest], []
    # pressures over which the loads have their tables: the same ones serve this contact
    shown = [contact for one in loads for contact in one.contacts]
    for name, plastic in (("elastic p(u)", False), ("plastic p(u)", True)):
        contact, told = load.contact, load
        if plastic != problem.interface.plastic:
            changed = _with_law(problem, plastic)
            if solver.yields:
                contact = solve_load(replace(solver, problem=changed), strongest)
            else:
                (contact,) = solved_again([contact], solver.model, changed.law, solver.earlier)
            formed = changed.around(contact)
            bare = LoadResult(*load.point, contact, formed=formed)
            rough = LeakModel.of(surface, problem.flow, (*shown, *bare.contacts))
            (told,) = case_loads(changed, [replace(bare, rough=rough)])
        others = {name: one.leak.leak_rate for name, one in told.others.items() if one.leak is not None}
        variants.append(replace(Comparison.of(name, contact, told.leak), others=others))
    return tuple(variants)


INTERFACE_VARIANTS = Answer[tuple[Comparison, ...]](
    "interface_variants",
    "comparison of elastic and plastic interface law",
    lambda seal, request: interface_variants(request.solver, seal.loads),
    (),
    doing="comparing elastic and plastic interface law",
    clock="variants",
    of_face=True,
)
