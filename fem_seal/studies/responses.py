"""From one design to its responses, as fast as the physics allows: nothing is written and nothing drawn.

Every number of a row depends on that design alone - never on the designs calculated before it in the same process -,
so that a study gives the same table in whatever order and on however many workers it runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from fem_seal import result as seal_result
from fem_seal.answers.opening import with_margins
from fem_seal.answers.verdict import judged
from fem_seal.case.case import Case
from fem_seal.contact.laws import Law
from fem_seal.contact.newton import Pressing
from fem_seal.contact.refit import fitted
from fem_seal.contact.solution import ContactSolution
from fem_seal.output.columns import COLUMNS, Row
from fem_seal.output.tables import rows_of
from fem_seal.seal.conductivity_tables import family_law, family_table
from fem_seal.seal.findings import Validity
from fem_seal.seal.judgement import Verdict
from fem_seal.seal.leak_model import Conductivity, Flow, RoughFlow
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.seal.problem import SealProblem, expected_contacts, expected_forces, sizing
from fem_seal.seal.results import LoadResult
from fem_seal.seal.shared_bodies import TabulatedSurface, shared_model
from fem_seal.studies.complete_runs import takes_complete_run
from fem_seal.studies.together import Steps, alone
from fem_seal.validity.checks import load_validity
from leak import ConductivityTable, GasConductivityTable, RoughContact
from meshes import Sizing

# A margin counts up to here: a sealed design, whose margin is infinite, can be compared with others.
LARGEST_MARGIN = 1e6
_OTHER_READING = "leak_rate_capped_m3_per_s"
# What takes the interval of the leak rate, and with it what the calculation may be off by.
_INTERVAL = frozenset({"leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s", "margin"})
# u_eff [m] above which u_c, which is of its size, need not be compared with molecules of half a nanometre.
_NARROW = 20e-9


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
    return alone(evaluation(case, columns, interpolate=interpolate))


def evaluation(case: Case, columns: Sequence[str], *, interpolate: bool = True) -> Steps[Evaluation]:
    """The steps of `evaluate`."""
    if takes_complete_run(case, columns):
        return _complete_run(case, columns)
    can_yield = any(body.material.yield_stress for body in (case.closure, case.seat))
    problem = SealProblem.of(case)
    yield None
    stress = can_yield or "max_von_mises_Pa" in columns
    load = yield from _load(problem, stress=stress, interpolate=interpolate)
    yield None
    # for the checks alone the table would take too long
    leaks = any(column.startswith(("leak_rate", "lift_off", "margin")) for column in columns)
    of_usual = replace(problem, usual_only=True) if leaks and problem.of_finish else problem
    if leaks:
        for _ in _leaks(load, other="margin" in columns or _OTHER_READING in columns):
            yield None
    validity = _validity(of_usual, load, tabulated=leaks and interpolate)
    yield None
    load = load.knowing(validity=validity)
    if "margin" in columns:
        load = load.knowing(judgement=judged(case, load))
        yield None
    values = _read(Row(load), columns)
    return Evaluation(values, validity, load.verdict)


def _leaks(load: LoadResult, *, other: bool) -> Iterator[object]:
    """The leak rate of a load, and that of the other reading of yielding asperities, each kind of work by itself."""
    readings = (load.conserved, load.capped) if other and load.yields else (load,)
    for one in readings:
        yield one.rough and one.rough.table
    yield load.contact.profile.contact
    yield load.contact.profile.contact.panels
    for one in readings:
        yield one.leak


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
    stress = "max_von_mises_Pa" in columns
    load = alone(_load(SealProblem.of(case), stress=stress, interpolate=interpolate))
    return _read(Row(load), columns)


def _read(row: Row, columns: Sequence[str]) -> dict[str, float]:
    found = {column: COLUMNS[column].number(row) for column in columns}
    return found | {"margin": min(found["margin"], LARGEST_MARGIN)} if "margin" in found else found


def _complete_run(case: Case, columns: Sequence[str]) -> Evaluation:
    asked = "force_for_verdict_N" in columns
    result = seal_result.run(case, levers=False, verdict_force=asked)
    row, *_ = rows_of(result)
    load = row.load
    cautions = load.validity.without("mesh").cautions
    if any(name.startswith("force_for_target") for name in columns) and load.target_validity is not None:
        # here the force is what the design is judged by
        cautions += load.target_validity.cautions
    return Evaluation(_read(row, columns), Validity.of(cautions), load.verdict)


def _load(problem: SealProblem, *, stress: bool, interpolate: bool) -> Steps[LoadResult]:
    """The only load of a problem, with what designs share: bodies, law and flow conductivity."""
    load = yield from _bare_load(problem, stress)
    rough = RoughFlow.of(problem.surface, problem.flow, load.contacts)
    if rough is not None and interpolate:
        rough = replace(rough, make=partial(_shared_table, load.contacts[-1]))
    solver, inner = LoadSolver(problem, load.contact.model), problem.loads.pressure_side == "inner"
    opens = solver.blow_off_pressure(load.applied_force) if inner else None
    (load,) = with_margins(solver, [load.knowing(rough=rough, blow_off_pressure=opens)])
    return load


def _bare_load(problem: SealProblem, stress: bool) -> Steps[LoadResult]:
    """The contact of the only load, around the axis if the seal is not round."""
    point, force, law = problem.loads.points[0], expected_forces(problem)[0], _law(problem)
    found: list[LoadResult] = []

    def solve_on(sizing: Sizing) -> Steps[Sequence[ContactSolution]]:
        model = shared_model(problem, sizing, stress=stress)
        contact: ContactSolution = yield Pressing(model, law, force, problem.at_rest(model))
        found.append(LoadResult(*point, contact, formed=problem.around(contact, law)))
        return found[-1].contacts

    size_given = problem.contact_size is not None
    widths = yield expected_contacts(problem, law)
    expected = sizing(problem, law, widths=widths)
    yield None
    yield from fitted(expected, problem.contact, solve_on, size_given=size_given)
    return found[-1]


def _law(problem: SealProblem) -> Law:
    interface, surface = problem.interface, problem.surface
    if interface.law == "spectrum" and not interface.plastic and surface is not None:
        return family_law(surface)
    return problem.law


def _shared_table(contact: ContactSolution, flow: Flow, surface: RoughContact) -> Conductivity:
    return family_table(flow, surface) or flow.table_of(surface, [contact])


def _validity(problem: SealProblem, load: LoadResult, *, tabulated: bool) -> Validity:
    """By the checks of a load; its table, if it has one, spares the search for what takes longer than a design."""
    table = load.rough.table if tabulated and load.rough is not None else None
    # a gas percolates where a liquid does
    table = table.liquid if isinstance(table, GasConductivityTable) else table
    if problem.surface is None or not isinstance(table, ConductivityTable) or table.acting is not None:
        return load_validity(problem, load, problem.surface)
    # u_eff falls over the pressure: that of the next one in the table is a bound
    beyond = table.separation[table.pressure.searchsorted(load.contact.profile.peak_pressure) :]
    if len(beyond) and beyond[0] >= _NARROW:
        load = load.knowing(critical_separation=None)
    return load_validity(problem, load, TabulatedSurface(problem.surface, table.sealing_pressure))
