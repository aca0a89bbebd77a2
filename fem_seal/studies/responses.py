"""From one design to its responses, as fast as the physics allows: nothing is written and nothing drawn.

Every number of a row depends on that design alone - never on the designs calculated before it in the same process -,
so that a study gives the same table in whatever order and on however many workers it runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

from fem_seal import result as seal_result
from fem_seal.answers.judgement import JudgedLoad, Verdict
from fem_seal.answers.opening import with_margins
from fem_seal.answers.verdict import judged
from fem_seal.case.case import Case
from fem_seal.contact.newton import Pressing, solve_together
from fem_seal.contact.refit import MeshFit
from fem_seal.contact.sizing import widths_together
from fem_seal.contact.solution import ContactSettings, ContactSolution
from fem_seal.errors import ConvergenceError
from fem_seal.output.columns import COLUMNS, Row
from fem_seal.output.tables import rows_of
from fem_seal.seal.conductivity_tables import family_table
from fem_seal.seal.findings import Validity
from fem_seal.seal.leak_model import Conductivity, Flow, RoughFlow
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.seal.problem import SealProblem, expected_contacts, expected_forces, sizing
from fem_seal.seal.readings import FURTHER, leak_rate_column
from fem_seal.seal.shared_bodies import shared_model, with_shared_law
from fem_seal.studies.batch import Batch
from fem_seal.studies.complete_runs import takes_complete_run
from fem_seal.validity.by_table import validity_by_table
from fem_seal.validity.checks import load_validity
from leak import RoughContact
from meshes import MeshingError

T = TypeVar("T")

# The residual is that of the state itself and so the relative error of its pressures: a hundredth of what the mesh
# leaves. Mostly Newton's last step falls far below it.
_TOLERANCE = 1e-6
# A margin counts up to here: a sealed design, whose margin is infinite, can be compared with others.
LARGEST_MARGIN = 1e6
_OTHER_READINGS = {leak_rate_column(one) for one in FURTHER}
# What takes the interval of the leak rate, and with it what the calculation may be off by.
_INTERVAL = frozenset({"leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s", "margin"})


@dataclass(frozen=True)
class Evaluation:
    """What a design gives.

    Parameters
    ----------
    values : dict
        Columns of leak.csv, SI.
    validity : Validity
        How far they can be trusted, by the checks of the load itself: errors of the mesh and of the far field are
        found once per geometry and are no part of it.
    verdict : Verdict or None
        On the case's requirement; None where its margin is not among the columns.
    """

    values: dict[str, float]
    validity: Validity
    verdict: Verdict | None = None


def evaluate(case: Case, columns: Sequence[str], *, interpolate: bool = True) -> Evaluation:
    """Columns of leak.csv for a case with one load, and their validity.

    Parameters
    ----------
    case, columns, interpolate
        See `responses`. Where the yield stress of a body is known the stresses are calculated, too.

    Raises
    ------
    ConvergenceError, GeometryError, MeshingError
    """
    return _only(lambda batch: evaluate_many(batch, {0: case}, columns, interpolate=interpolate))


def evaluate_many(
    batch: Batch, cases: Mapping[int, Case], columns: Sequence[str], *, interpolate: bool = True
) -> dict[int, Evaluation]:
    """`evaluate` of several cases, which share their contact calculations; without those that fail.

    Parameters
    ----------
    batch : Batch
        Keeps time and failures of each.
    cases : mapping
        By number.
    columns, interpolate
        See `evaluate`.
    """
    found = batch.each(
        [number for number, case in cases.items() if takes_complete_run(case, columns)],
        lambda number: _complete_run(cases[number], columns),
    )
    problems = batch.each([n for n in cases if n not in found], lambda number: design_problem(cases[number]))
    loads = _loads(
        batch,
        problems,
        stress={number: _with_stress(cases[number], columns) for number in problems},
        interpolate=interpolate,
    )
    # for the checks alone the table would take too long
    leaks = any(column.startswith(("leak_rate", "lift_off", "margin")) for column in columns)
    if leaks:
        bare = loads
        for step in _leaks(other="margin" in columns or not _OTHER_READINGS.isdisjoint(columns)):
            batch.each(bare, lambda number: step(bare[number]))  # noqa: B023

    def with_validity(number: int) -> JudgedLoad:
        problem, load = problems[number], loads[number]
        usual = replace(problem, usual_only=True) if leaks and problem.of_finish else problem
        if leaks and interpolate:
            return JudgedLoad.of(load, validity=validity_by_table(usual, load))
        return JudgedLoad.of(load, validity=load_validity(usual, load, usual.surface))

    told = batch.each(loads, with_validity)
    if "margin" in columns:
        told = batch.each(told, lambda n: told[n].knowing(judgement=judged(cases[n], told[n])))
    return found | batch.each(
        told, lambda n: Evaluation(_read(Row(told[n]), columns), told[n].validity, told[n].verdict)
    )


def design_problem(case: Case) -> SealProblem:
    """What is to be solved of a design."""
    return with_shared_law(SealProblem.of(case))


def _only(of_batch: Callable[[Batch], Mapping[int, T]]) -> T:
    """What is found for the only design of a batch, or why nothing is."""
    batch = Batch()
    found = of_batch(batch)
    for error in batch.failed.values():
        raise error
    return found[0]


def _with_stress(case: Case, columns: Sequence[str]) -> bool:
    can_yield = any(body.material.yield_stress for body in (case.closure, case.seat))
    return can_yield or "max_von_mises_Pa" in columns


def _leaks(*, other: bool) -> Iterator[Callable[[LoadResult], object]]:
    """Leak rate of a load, and that of the other reading of yielding asperities, each kind of work by itself."""

    def readings(load: LoadResult) -> tuple[LoadResult, ...]:
        return (load, *(load.others.values() if other else ()))

    yield lambda load: [one.rough and one.rough.table for one in readings(load)]
    yield lambda load: [one.contact for one in load.profiles]
    yield lambda load: [one.contact.panels for one in load.profiles]
    yield lambda load: [one.leak for one in readings(load)]


def responses(case: Case, columns: Sequence[str], *, interpolate: bool = True) -> dict[str, float]:
    """Columns of leak.csv for a case with one load.

    Parameters
    ----------
    case : Case
        With one fluid pressure.
    columns : sequence of str
        Names of `fem_seal.output.columns.LEAK_COLUMNS`. Those in `FAST` of `fem_seal.studies.complete_runs` cost
        milliseconds once geometry and surface are known; any other (knudsen_number, max_accumulated_plastic_strain,
        load_steps and, with [uncertainty] or a finish, leak_rate_low_m3_per_s and leak_rate_high_m3_per_s) takes a
        complete run of the case. So does any column of a case with load.closing = "penetration", load.target_leak_rate,
        load.largest_earlier_force or _pressure, leak.fluid_in_gap = "local", seat.wall = "fixed", a calculated
        temperature or a stress-strain curve.
    interpolate : bool
        Whether flow conductivities of surfaces that differ in height, hardness or modulus alone may be interpolated,
        see `fem_seal.seal.shared_bodies` and `fem_seal.seal.conductivity_tables`.

    Raises
    ------
    ConvergenceError, GeometryError, MeshingError
    """
    if takes_complete_run(case, columns):
        return _complete_run(case, columns).values
    if not _INTERVAL.isdisjoint(columns):
        # which asks for the validity
        return evaluate(case, columns, interpolate=interpolate).values
    stress = {0: "max_von_mises_Pa" in columns}
    problems = {0: design_problem(case)}
    load = _only(lambda batch: _loads(batch, problems, stress=stress, interpolate=interpolate))
    return _read(Row(load), columns)


def _read(row: Row, columns: Sequence[str]) -> dict[str, float]:
    found = {column: COLUMNS[column].number(row) for column in columns}
    return found | {"margin": min(found["margin"], LARGEST_MARGIN)} if "margin" in found else found


def _complete_run(case: Case, columns: Sequence[str]) -> Evaluation:
    asked = "force_for_verdict_N" in columns
    result = seal_result.run(case, levers=False, verdict_force=asked)
    (row, *_), (load, *_) = rows_of(result), result.loads
    cautions = load.validity.without("mesh").cautions
    if any(name.startswith("force_for_target") for name in columns) and load.target_validity is not None:
        # here the force is what the design is judged by
        cautions += load.target_validity.cautions
    return Evaluation(_read(row, columns), Validity.of(cautions), load.verdict)


def _loads(
    batch: Batch, problems: Mapping[int, SealProblem], *, stress: Mapping[int, bool], interpolate: bool
) -> dict[int, LoadResult]:
    """The only load of each problem, with what designs share: bodies, law and flow conductivity."""
    bare = _bare_loads(batch, problems, stress)

    def with_flow(number: int) -> LoadResult:
        problem, load = problems[number], bare[number]
        rough = RoughFlow.of(problem.surface, problem.flow, load.contacts)
        if rough is not None and interpolate:
            rough = replace(rough, make=partial(_shared_table, load.contacts[-1]))
        solver, inner = LoadSolver(problem, load.contact.model), problem.loads.pressure_side == "inner"
        opens = solver.blow_off_pressure(load.applied_force) if inner else None
        (load,) = with_margins(solver, [load.knowing(rough=rough, blow_off_pressure=opens)])
        return load

    return batch.each(bare, with_flow)


def _bare_loads(
    batch: Batch, problems: Mapping[int, SealProblem], stress: Mapping[int, bool]
) -> dict[int, LoadResult]:
    """The contact of the only load of each, around the axis if the seal is not round, on a mesh that fits it."""
    asked = batch.each(problems, lambda number: expected_contacts(problems[number], problems[number].law))
    widths = batch.at_once(asked, widths_together)

    def begun(number: int) -> MeshFit:
        problem, size_given = problems[number], problems[number].contact_size is not None
        wanted = sizing(problem, widths=_found(widths[number]))
        return MeshFit.begun(wanted, problem.contact, size_given=size_given)

    fits = batch.each(widths, begun)
    loads: dict[int, LoadResult] = {}

    def pressed(number: int) -> Pressing | Exception:
        problem, wanted = problems[number], fits[number].sizing
        assert wanted is not None
        try:
            model = shared_model(problem, wanted, stress=stress[number])
            return Pressing(model, problem.law, expected_forces(problem)[0], problem.at_rest(model))
        except MeshingError as error:
            return error

    def looked_at(number: int) -> MeshFit:
        outcome: Sequence[ContactSolution] | Exception
        try:
            contact = _found(contacts[number])
            point, formed = (
                problems[number].loads.points[0],
                problems[number].around(contact, problems[number].law),
            )
            loads[number] = LoadResult(*point, contact, formed=formed)
            outcome = loads[number].contacts
        except (MeshingError, ConvergenceError) as error:
            outcome = error
        return fits[number].after(outcome)

    while left := [number for number, fit in fits.items() if fit.sizing is not None]:
        asking = batch.each(left, pressed)
        contacts: dict[int, ContactSolution | Exception] = batch.at_once(
            {number: one for number, one in asking.items() if isinstance(one, Pressing)}, _pressed_together
        )
        contacts |= {number: one for number, one in asking.items() if isinstance(one, Exception)}
        fits = {number: fit for number, fit in fits.items() if fit.sizing is None} | batch.each(
            contacts, looked_at
        )
    return {number: loads[number] for number in sorted(fits) if number in loads}


def _pressed_together(asked: Sequence[Pressing]) -> Sequence[ContactSolution | ConvergenceError]:
    return solve_together(asked, ContactSettings(_TOLERANCE, _TOLERANCE))


def _found(answer: T | Exception) -> T:
    if isinstance(answer, Exception):
        raise answer
    return answer


def _shared_table(contact: ContactSolution, flow: Flow, surface: RoughContact) -> Conductivity:
    return family_table(flow, surface) or flow.table_of(surface, [contact])
