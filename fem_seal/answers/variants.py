"""The load with the largest closing force with another interface law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.answer import Answer
from fem_seal.answers.case_load import CaseLoad, case_loads
from fem_seal.seal.load_result import load_results, strongest_load
from fem_seal.seal.load_solver import (
    LoadSolver,
    solve_load,
    solved_again,
)
from fem_seal.seal.problem import SealProblem


def _with_law(problem: SealProblem, plastic: bool) -> SealProblem:
    return replace(problem, interface=problem.interface.model_copy(update={"plastic": plastic}))


def interface_variants(solver: LoadSolver, loads: Sequence[CaseLoad]) -> tuple[Comparison, ...]:
    """The load with the largest closing force with p(u) of the elastic and of the plastically smoothed surface."""
    problem = solver.problem
    surface = problem.surface
    if surface is None or not surface.smoothed:
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
            around = changed.circumference(contact)
            bare = load_results(changed, [load.point], [contact], [around], alike=shown)
            (told,) = case_loads(changed, bare)
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
