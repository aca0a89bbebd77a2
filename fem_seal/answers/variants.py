"""The same loads in the scenarios whose contacts are their own, and with another interface law, on the same bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.answer import Answer, Request, at_pressure
from fem_seal.answers.case_load import CaseLoad, SolvedSeal, case_loads
from fem_seal.contact.newton import solve_many
from fem_seal.seal.load_result import highest_load, load_results, strongest_load
from fem_seal.seal.load_solver import (
    LoadSolver,
    SolvedLoads,
    solve_again,
    solve_linearised,
    solve_load,
    solve_loads,
)
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.scenarios import SCENARIOS, with_own_contacts
from leak import RoughContact


@dataclass(frozen=True)
class OtherContacts:
    """The loads in the scenarios with contacts of their own.

    Parameters
    ----------
    loads : mapping
        By scenario, in the order of the result; None where it has no contact or no leak rate.
    same_contact : mapping
        Leak rate by scenario through the very contact of the highest load [m^3/s].
    """

    loads: Mapping[str, Sequence[CaseLoad | None]] = field(default_factory=dict)
    same_contact: Mapping[str, float] = field(default_factory=dict)


def loads_in(problem: SealProblem, seal: SolvedSeal) -> list[CaseLoad | None]:
    """The loads of a seal in the scenario of another problem, on the same bodies; None where it has no contact.

    Where a body yields it is linearised at each load; what it would have yielded otherwise on the way is left out.

    Parameters
    ----------
    problem : SealProblem
    seal : SolvedSeal
    """
    numbers = list(range(len(seal.loads)))
    if problem.follows_path:
        outcome = SolvedLoads(solve_linearised(seal.contact, problem.law))
    else:
        solver = LoadSolver(problem, seal.model)
        starts = solver.pressings()
        contacts = dict(zip(starts, solve_many([*starts.values()]), strict=True))
        outcome = solve_loads(solver, pressed_contacts=contacts)
        numbers = [number for number in numbers if number not in outcome.failures]
    loads = [seal.loads[number] for number in numbers]
    results = outcome.results(problem, [load.point for load in loads])
    ready_loads = [
        load.with_values(mesh_error=nominal.mesh_error, opening=nominal.opening)
        for load, nominal in zip(results, loads, strict=True)
    ]
    by_number = dict(zip(numbers, case_loads(problem, ready_loads), strict=True))
    return [by_number.get(number) for number in range(len(seal.loads))]


def _compute(seal: SolvedSeal, request: Request) -> OtherContacts:
    highest = highest_load(seal.loads)

    def compute_leak(load: CaseLoad, subject: str) -> CaseLoad:
        return request.steps.compute_values(load, {"leak": at_pressure(subject, load)})

    def compute_load(name: str, number: int, load: CaseLoad) -> CaseLoad | None:
        subject = f"leak rate by {SCENARIOS[name].title}"
        load = compute_leak(load, subject)
        if load.leak is None:
            return None
        if number != highest or not request.full:
            return load
        # of what yielding makes of it the full report tells one load
        compared_loads = {
            other: compute_leak(load.scenarios[other], f"{subject} of {words.asperities}")
            for other, words in SCENARIOS.items()
            if words.asperities and not words.in_interval and other in load.scenarios
        }
        return load.with_scenarios(compared_loads)

    contacts = {
        scenario.name: [
            None if load is None else compute_load(scenario.name, number, load)
            for number, load in enumerate(loads_in(scenario.problem, seal))
        ]
        for scenario in with_own_contacts(seal.problem)
    }
    same_contact = {}
    for name, loads in contacts.items() if request.full else ():
        other = loads[highest]
        leak = None if other is None else replace(seal.loads[highest], rough=other.rough).leak
        if leak is not None:
            same_contact[name] = leak.leak_rate
    return OtherContacts(contacts, same_contact)


def _of_load(load: CaseLoad, number: int, answer: OtherContacts) -> CaseLoad:
    return load.with_scenarios({name: x for name, row in answer.loads.items() if (x := row[number])})


OWN_CONTACTS = Answer[OtherContacts](
    "theories",
    "leak rates by the other theory",
    _compute,
    OtherContacts(),
    lambda seal, request: any(with_own_contacts(seal.problem)),
    _of_load,
    "contacts and leak rates by the other theory",
    of_part=True,
)


def interface_variants(solver: LoadSolver, loads: Sequence[CaseLoad]) -> tuple[Comparison, ...]:
    """The load with the largest closing force with p(u) of the elastic and of the plastically smoothed surface."""
    problem = solver.problem
    surface = problem.surface
    if not isinstance(surface, RoughContact) or not surface.smoothed:
        return ()
    if problem.interface.law != "spectrum":
        return ()
    strongest = strongest_load(loads)
    load, variants = loads[strongest], []
    # pressures over which the loads have their tables: the same ones serve this contact
    table_contacts = [contact for load in loads for contact in load.contacts]
    for name, plastic in (("elastic p(u)", False), ("plastic p(u)", True)):
        contact, result = load.contact, load
        if plastic != problem.interface.plastic:
            variant = replace(problem, interface=problem.interface.model_copy(update={"plastic": plastic}))
            if solver.yields:
                contact = solve_load(replace(solver, problem=variant), strongest)
            else:
                (contact,) = solve_again([contact], solver.model, variant.law)
            circumference = variant.circumference(contact, load.fluid_pressure)
            bare = load_results(variant, [load.point], [contact], [circumference], others=table_contacts)
            (result,) = case_loads(variant, bare)
        others = {name: x.leak.leak_rate for name, x in result.others.items() if x.leak is not None}
        variants.append(replace(Comparison.of(name, contact, result.leak), others=others))
    return tuple(variants)


INTERFACE_VARIANTS = Answer[tuple[Comparison, ...]](
    "interface_variants",
    "comparison of elastic and plastic interface law",
    lambda seal, request: interface_variants(request.solver, seal.loads),
    (),
    status="comparing elastic and plastic interface law",
    clock="variants",
    of_part=True,
)


def shown_in_full(seal: SolvedSeal) -> tuple[str, ...]:
    """Names of the answers here that only the full report shows.

    The other theory may change a verdict, and beside the paper's theory the corrected one has its column.

    Parameters
    ----------
    seal : SolvedSeal
    """
    surface = seal.problem.surface
    by_paper = isinstance(surface, RoughContact) and surface.theory == "paper"
    if by_paper or seal.case.requirement is not None:
        return (INTERFACE_VARIANTS.name,)
    return INTERFACE_VARIANTS.name, OWN_CONTACTS.name
