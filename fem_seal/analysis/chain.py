"""The chain from a case to its results: geometry, mesh, contact, profile, leak."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.analysis.accuracy import NOT_ESTIMATED, discretisation_error, far_field, on_coarser_mesh
from fem_seal.analysis.afterwards import Afterwards
from fem_seal.analysis.caution import NOT_JUDGED, worst_first
from fem_seal.analysis.left_out import left_out
from fem_seal.analysis.load_solver import Clock, LoadSolver, Progress, model_and_contacts
from fem_seal.analysis.opening import with_margins
from fem_seal.analysis.problem import SealProblem
from fem_seal.analysis.questions import with_answers
from fem_seal.analysis.results import (
    DiscretisationError,
    FarFieldChange,
    LoadResult,
    SealSolution,
    strongest_load,
)
from fem_seal.analysis.variants import interface_variants, theory_variants
from fem_seal.analysis.warnings import contact_cautions, load_validity
from fem_seal.contact.solution import ContactSolution
from fem_seal.units import given
from leak import LeakResult, RoughContact

if TYPE_CHECKING:
    from fem_seal.case.case import Case

# Where the stress could not be calculated.
_NO_STRESS = math.nan, ("closure", math.nan, math.nan)


def solve(case: Case, progress: Progress | None = None) -> SealSolution:
    """Solve every load of a case; `fem_seal.run` says what can go wrong.

    Parameters
    ----------
    case : Case
    progress : callable, optional
        Told in words what is being done.
    """
    clock = Clock(progress or (lambda text: None))
    with clock.step("interface", "roughness and interface law"):
        whole = SealProblem.of(case)
        _ = whole.law  # made once for each surface, and here, where it is timed
    refused = whole.loads.refused
    problem = _without(whole, refused)
    seal_mesh, model, solved = model_and_contacts(problem, clock)
    problem, contacts, after = _without(problem, solved.failures), solved.contacts, Afterwards()
    kept = [number for number in range(len(whole.loads.points)) if number not in refused]
    unsolved = {kept[number]: one for number, one in solved.problems.items()}
    missing = {**refused, **unsolved}
    remarks = tuple(left_out(whole.loads, missing))
    if solved.not_unloaded is not None:
        after.name("residual stress and imprint", solved.not_unloaded)
    with clock.step("leak", "flow conductivity and leak rates"):
        flows = _leak_rates(problem, contacts, after)
    with clock.step("stress", "stress in both bodies"):
        separations = _critical_separations(problem.surface, contacts, after)
        loads = tuple(
            _load_result(after, *item)
            for item in zip(problem.loads.points, contacts, *flows, *separations, strict=True)
        )
    solver, coarser, error = LoadSolver(problem, model), None, NOT_ESTIMATED
    with clock.step("error", "estimating the discretisation error"), after.going_on("discretisation error"):
        strongest = strongest_load(loads)
        coarser = on_coarser_mesh(problem, seal_mesh.sizing, strongest)
        error = discretisation_error(contacts[strongest], coarser, seal_mesh.sizing)
    far: tuple[FarFieldChange, ...] = ()
    if coarser is not None:
        with clock.step("far field", "comparing sizes and supports far from the contact"):
            far = after.get("influence of the far field", partial(far_field, coarser), ())
    with clock.step("questions", "blow-off and force for the target leak rate"):
        loads, of_answers = with_answers(solver, loads, after)
        loads = after.get("margin to opening", partial(with_margins, solver, loads), loads)
    with clock.step("variants", "comparing elastic and plastic interface law"):
        compare = partial(interface_variants, solver, loads)
        variants = after.get("comparison of elastic and plastic interface law", compare, ())
    check = partial(contact_cautions, problem, model, loads, error, problem.surface)
    found = (*remarks, *after.get("checks of what the theory allows", check, ()), *of_answers)
    result = SealSolution(
        case.without_loads(missing),
        problem,
        seal_mesh,
        model,
        problem.surface,
        _judged(after, problem, loads, error),
        error,
        variants,
        tuple(caution.text for caution in worst_first(found)),
        clock.timings,
        far_field=far,
        unloaded=solved.unloaded,
    )
    result = _with_theory_variants(result, clock, after)
    result = _with_uncertainty(result, clock, after)
    return replace(result, warnings=(*result.warnings, *after.failures))


def _judged(
    after: Afterwards, problem: SealProblem, loads: Sequence[LoadResult], error: DiscretisationError
) -> tuple[LoadResult, ...]:
    """Loads with their validity."""
    return tuple(
        replace(
            load,
            validity=after.get(
                f"validity at {given('fluid pressure', load.fluid_pressure)}",
                partial(load_validity, problem, load, problem.surface, error),
                NOT_JUDGED,
            ),
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
    if result.case.uncertainty is None:
        return result
    from fem_seal.analysis.uncertainty import leak_interval

    with clock.step("uncertainty", "leak rates of uncertain inputs"):
        calculate = partial(leak_interval, result, progress=clock.progress)
        return replace(result, uncertainty=after.get("interval of the leak rates", calculate, None))


def _without(problem: SealProblem, numbers: Collection[int]) -> SealProblem:
    return replace(problem, loads=problem.loads.without(numbers)) if numbers else problem


def _leak_rates(
    problem: SealProblem, contacts: Sequence[ContactSolution], after: Afterwards
) -> tuple[list[LeakResult | None], list[LeakResult | None]]:
    """Leak of each contact with the problem's surface and with the same surface kept elastic."""
    nothing: list[LeakResult | None] = [None] * len(contacts)
    surface, flow = problem.surface, problem.flow
    if surface is None or flow is None:
        return nothing, nothing

    def of(surface: RoughContact, name: str) -> list[LeakResult | None]:
        table = after.get(f"flow conductivity{name}", partial(flow.table_of, surface, contacts), None)
        if table is None:
            return nothing
        return [
            after.get(
                f"leak rate{name} at {given('fluid pressure', pressure)}",
                partial(flow.leak_of, table, contact.profile, pressure),
                None,
            )
            for contact, pressure in zip(contacts, problem.loads.fluid_pressure, strict=True)
        ]

    found = of(surface, "")
    return found, found if surface.hardness is None else of(surface.elastic, " of elastic asperities")


def _critical_separations(
    surface: RoughContact | None, contacts: Sequence[ContactSolution], after: Afterwards
) -> tuple[list[float | None], list[float | None]]:
    """u_c at the peak of every contact with the case's surface and with the same surface kept elastic [m]."""
    nothing: list[float | None] = [None] * len(contacts)
    if surface is None:
        return nothing, nothing

    def of(surface: RoughContact) -> list[float | None]:
        peaks = np.array([contact.profile.peak_pressure for contact in contacts])
        return np.asarray(surface.critical_separation(peaks)).tolist()

    found = after.get("critical separation", partial(of, surface), nothing)
    if surface.hardness is None:
        return found, found
    return found, after.get(
        "critical separation of elastic asperities", partial(of, surface.elastic), nothing
    )


def _load_result(
    after: Afterwards,
    point: tuple[float, float],
    contact: ContactSolution,
    leak: LeakResult | None,
    leak_elastic: LeakResult | None,
    critical_separation: float | None,
    critical_separation_elastic: float | None,
) -> LoadResult:
    fluid_pressure, applied_force = point
    stress, place = after.get(
        f"stress at {given('fluid pressure', fluid_pressure)}", partial(_largest_stress, contact), _NO_STRESS
    )
    return LoadResult(
        fluid_pressure,
        contact.axial_force,
        contact.line_load,
        contact,
        leak,
        leak_elastic,
        critical_separation,
        critical_separation_elastic,
        stress,
        place,
        applied_force,
    )


def _largest_stress(contact: ContactSolution) -> tuple[float, tuple[str, float, float]]:
    worst = max(contact.fields.values(), key=lambda field: float(field.von_mises.max()))
    node = int(np.argmax(worst.von_mises))
    r, z = worst.points[node].tolist()
    return float(worst.von_mises[node]), (worst.name, r, z)
