"""The chain from a case to its results: geometry, mesh, contact, profile, leak."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.afterwards import Afterwards
from fem_seal.case_flow import expected_forces
from fem_seal.caution import Caution, Level, Validity, worst_first
from fem_seal.condensation import ContactModel
from fem_seal.contact import solve
from fem_seal.contact_size import element_sizes
from fem_seal.contact_solution import ContactSolution
from fem_seal.contact_zone import rounded, solve_fitted
from fem_seal.discretisation import NOT_ESTIMATED, discretisation_error, on_coarser_mesh
from fem_seal.errors import ConvergenceError, InputError, NoLoadLeftError
from fem_seal.far_field import FarFieldChange, far_field
from fem_seal.fluid_flow import flow_table, leak_of_profile
from fem_seal.interface import exponential_law, rough_contact
from fem_seal.inverse_questions import with_answers
from fem_seal.laws import HardContact, Law
from fem_seal.left_out import left_out
from fem_seal.load_limits import refused_loads
from fem_seal.load_solver import LoadSolver, condensed
from fem_seal.loads import line_load
from fem_seal.opening import with_margins
from fem_seal.plastic_width import curves, for_yielding
from fem_seal.readable import given
from fem_seal.results import InterfaceVariant, LoadResult, SealResult, strongest_load
from fem_seal.solved_loads import SolvedLoads, solve_load, solve_loads
from fem_seal.validity import contact_cautions, load_validity
from meshes import SealMesh, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.case import Case
    from leak import ConductivityTable, GasConductivityTable, LeakResult, RoughContact

Progress = Callable[[str], None]

# Of a load whose checks failed: what was not checked is not simply valid.
_UNCHECKED = Validity.of(
    [Caution("checks", Level.DOUBTFUL, "the checks of what the theory allows failed", "the checks failed")]
)
# Where the stress could not be calculated.
_NO_STRESS = math.nan, ("closure", math.nan, math.nan)


def run(case: Case, progress: Progress | None = None) -> SealResult:
    """Solve every load of a case.

    Parameters
    ----------
    case : Case
    progress : callable, optional
        Told in words what is being done.

    Returns
    -------
    SealResult
        Loads that cannot be calculated - they open the seal, strain the bodies too much or do not converge - are left
        out, with a warning that names them. So is what comes after contact and leak and fails: stress, error
        estimate, answers, variants, interval.

    Raises
    ------
    NoLoadLeftError
        If no load can be calculated.
    GeometryError
        If the bodies do not fit together.
    MeshingError
        If gmsh cannot be loaded or fails.
    ConvergenceError
        If no contact converges.
    """
    clock = Clock(progress or (lambda text: None))
    with clock.step("interface", "roughness and interface law"):
        surface = rough_contact(case)
        law = interface_law(case, surface)
    whole, refused = case, refused_loads(case)
    case = _without(case, refused)
    seal_mesh, model, solved = model_and_contacts(case, law, clock)
    case, contacts, after = _without(case, solved.failures), solved.contacts, Afterwards()
    kept = [number for number in range(len(whole.load.points)) if number not in refused]
    unsolved = {kept[number]: problem for number, problem in solved.problems.items()}
    remarks = tuple(left_out(whole.load, refused | unsolved))
    if solved.not_unloaded is not None:
        after.name("residual stress and imprint", solved.not_unloaded)
    with clock.step("leak", "flow conductivity and leak rates"):
        flows = _leak_rates(case, surface, contacts, after)
    with clock.step("stress", "stress in both bodies"):
        separations = _critical_separations(surface, contacts, after)
        loads = tuple(
            _load_result(after, *item)
            for item in zip(case.load.points, contacts, *flows, *separations, strict=True)
        )
    solver, coarser, error = LoadSolver(case, law, model), None, NOT_ESTIMATED
    with clock.step("error", "estimating the discretisation error"), after.going_on("discretisation error"):
        strongest = strongest_load(loads)
        coarser = on_coarser_mesh(case, law, seal_mesh.sizing, strongest)
        error = discretisation_error(contacts[strongest], coarser, seal_mesh.sizing)
    far: tuple[FarFieldChange, ...] = ()
    if coarser is not None:
        with clock.step("far field", "comparing sizes and supports far from the contact"):
            far = after.get("influence of the far field", partial(far_field, coarser), ())
    with clock.step("questions", "blow-off and force for the target leak rate"):
        loads, of_answers = with_answers(solver, loads, after)
        loads = after.get("margin to opening", partial(with_margins, solver, loads), loads)
    with clock.step("variants", "comparing elastic and plastic interface law"):
        compare = partial(_interface_variants, solver, surface, loads)
        variants = after.get("comparison of elastic and plastic interface law", compare, ())
    check = partial(contact_cautions, case, model, loads, error, surface)
    found = (*remarks, *after.get("checks of what the theory allows", check, ()), *of_answers)
    result = SealResult(
        case,
        seal_mesh,
        model,
        surface,
        tuple(
            replace(
                load,
                validity=after.get(
                    "validity", partial(load_validity, case, load, surface, error), _UNCHECKED
                ),
            )
            for load in loads
        ),
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


def _with_theory_variants(result: SealResult, clock: Clock, after: Afterwards) -> SealResult:
    if not result.case.leak.variants:
        return result
    from fem_seal.theory_variants import theory_variants

    with clock.step("theory", "leak rates with every reading of the theory"):
        variants = after.get(
            "leak rates with every reading of the theory", partial(theory_variants, result), ()
        )
        return replace(result, theory_variants=variants)


def _with_uncertainty(result: SealResult, clock: Clock, after: Afterwards) -> SealResult:
    if result.case.uncertainty is None:
        return result
    from fem_seal.uncertainty import leak_interval

    with clock.step("uncertainty", "leak rates of uncertain inputs"):
        calculate = partial(leak_interval, result, progress=clock.progress)
        return replace(result, uncertainty=after.get("interval of the leak rates", calculate, None))


def build_mesh(case: Case) -> SealMesh:
    """Mesh of a case, sized for all its loads.

    Parameters
    ----------
    case : Case

    Raises
    ------
    GeometryError, MeshingError
    """
    return build_contact(case.contact, sizing(case, interface_law(case, rough_contact(case))))


def interface_law(case: Case, surface: RoughContact | None) -> Law:
    """The law between contact pressure and gap that the case asks for.

    Parameters
    ----------
    case : Case
    surface : RoughContact or None
        The case's rough contact.
    """
    from leak import ExponentialLaw

    if case.interface.law == "smooth":
        return HardContact()
    if case.interface.law == "persson":
        assert surface is not None  # the case's own checks demand a roughness
        return surface.interface_law(plastic=case.interface.plastic)
    u0, p_c = exponential_law(case, surface)
    assert u0 is not None and p_c is not None
    return ExponentialLaw(p_c=p_c, u0=u0)


def axial_forces(case: Case) -> list[float]:
    """Force F_N that the solid contact carries at each load, with closing = "penetration" its estimate [N]."""
    return expected_forces(case)


@dataclass(frozen=True)
class Clock:
    """Says what is being done and keeps how long it took.

    Parameters
    ----------
    progress : callable
        Told in words what is being done.
    timings : dict
        Wall time [s] by name of the step.
    """

    progress: Progress
    timings: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def step(self, name: str, text: str) -> Iterator[None]:
        """Time what happens inside; a step that comes again adds to its time."""
        self.progress(text)
        start = time.perf_counter()
        yield
        self.timings[name] = self.timings.get(name, 0.0) + time.perf_counter() - start


def sizing(case: Case, law: Law) -> Sizing:
    """Element sizes and contact zone for all loads of a case.

    Parameters
    ----------
    case : Case
    law : Law
        See `interface_law`.

    Raises
    ------
    InputError
        If [mesh] contact_size is out of range for this contact.
    """
    return sizing_for(case, law, axial_forces(case))


def sizing_for(case: Case, law: Law, forces: Sequence[float]) -> Sizing:
    """The same for other forces F_N than those of the case [N]."""
    contact = case.contact
    line_loads = [line_load(force, contact.touch_radius, contact.angle) for force in forces]
    size = case.mesh.contact_size
    try:
        elastic = element_sizes(law, line_loads, contact, case.effective_modulus, size)
    except InputError as error:
        raise error.in_file(case.file) from None
    size_given = size is not None
    found = for_yielding(elastic, case, line_loads, size_given=size_given) if curves(case) else elastic
    return rounded(found, contact, size_given=size_given)


def model_and_contacts(
    case: Case, law: Law, clock: Clock | None = None
) -> tuple[SealMesh, ContactModel, SolvedLoads]:
    """All loads of a case on a mesh whose zone and element sizes fit what was found on it.

    Parameters
    ----------
    case : Case
    law : Law
        See `interface_law`.
    clock : Clock, optional
        Told what is being done.

    Raises
    ------
    NoLoadLeftError
        If no load has a contact.
    GeometryError, MeshingError, ConvergenceError
    """
    clock = clock or Clock(lambda text: None)
    size_given = case.mesh.contact_size is not None
    meshes: list[SealMesh] = []
    solved: list[SolvedLoads] = []
    # a load that does not converge is tried on a finer mesh once, before the others go on without it
    finer_may_help = not (size_given or case.contact.has_ready_mesh)

    def solve_on(sizing: Sizing) -> Sequence[ContactSolution]:
        nonlocal finer_may_help
        with clock.step("mesh", "meshing closure and seat"):
            meshes.append(build_contact(case.contact, sizing))
        with clock.step("condense", "condensing both bodies on the contact line"):
            solver = LoadSolver(case, law, condensed(case, meshes[-1]))
        along = ", one after the other in load steps, and unloading" if solver.yields else ""
        with clock.step("contact", f"solving {len(case.load.fluid_pressure)} contacts{along}"):
            found = solve_loads(solver)
        unconverged = [error for error in found.failures.values() if isinstance(error, ConvergenceError)]
        if unconverged and finer_may_help:
            finer_may_help = False
            raise unconverged[0]
        if not found.contacts:
            raise _no_load_left(case, found)
        solved.append(found)
        return found.contacts

    contacts = solve_fitted(sizing(case, law), case.contact, solve_on, size_given=size_given)
    return meshes[-1], contacts[0].model, solved[-1]


def _no_load_left(case: Case, solved: SolvedLoads) -> Exception:
    """The error of a case without a contact at any of its loads."""
    errors = list(solved.failures.values())
    if all(isinstance(error, ConvergenceError) for error in errors):
        return errors[0]
    problems = {problem.kind: problem for problem in reversed(solved.problems.values())}
    return NoLoadLeftError(*problems.values(), file=case.file)


def _without(case: Case, numbers: Collection[int]) -> Case:
    """The case without some of its loads."""
    return case.model_copy(update={"load": case.load.without(numbers)}) if numbers else case


def condensed_on(case: Case, sizing: Sizing) -> ContactModel:
    """The bodies of a case, meshed with a sizing and condensed."""
    return condensed(case, build_contact(case.contact, sizing))


def _leak_rates(
    case: Case, surface: RoughContact | None, contacts: Sequence[ContactSolution], after: Afterwards
) -> tuple[list[LeakResult | None], list[LeakResult | None]]:
    """Leak of each contact with the case's surface and with the same surface kept elastic."""
    nothing: list[LeakResult | None] = [None] * len(contacts)
    if surface is None or case.fluid is None:
        return nothing, nothing

    def of(surface: RoughContact, name: str) -> list[LeakResult | None]:
        table = after.get(
            f"flow conductivity{name}", partial(conductivity_table, case, surface, contacts), None
        )
        if table is None:
            return nothing
        return [
            after.get(
                f"leak rate{name} at {given('fluid pressure', pressure)}",
                partial(leak_of_contact, case, table, contact, pressure),
                None,
            )
            for contact, pressure in zip(contacts, case.load.fluid_pressure, strict=True)
        ]

    found = of(surface, "")
    return found, found if surface.hardness is None else of(surface.elastic, " of elastic asperities")


def conductivity_table(
    case: Case, surface: RoughContact, contacts: Sequence[ContactSolution], num: int = 80
) -> ConductivityTable | GasConductivityTable:
    """Flow conductivity of a surface over all pressures that occur in the contacts.

    The range reaches six decades below the smallest peak, where the table goes on by the low-pressure law. It is
    rounded out to whole decades, so that neighbouring contacts share one table.
    """
    peaks = [math.log10(contact.pressure.max()) for contact in contacts]
    low, high = math.floor(min(peaks) - 6), math.ceil(max(peaks) + 0.3)
    return flow_table(case, surface, 10.0**low, 10.0**high, num)


def leak_of_contact(
    case: Case,
    table: ConductivityTable | GasConductivityTable,
    contact: ContactSolution,
    fluid_pressure: float,
) -> LeakResult:
    """Leak of one contact with the case's fluid.

    Parameters
    ----------
    case : Case
    table : ConductivityTable or GasConductivityTable
        From `conductivity_table`, for all pressures of the contact.
    contact : ContactSolution
    fluid_pressure : float
        Pressure difference [Pa].
    """
    profile = contact.profile
    return leak_of_profile(
        case, table, profile.x, profile.pressure, fluid_pressure, profile.radius, profile.ends
    )


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


def _interface_variants(
    solver: LoadSolver, surface: RoughContact | None, loads: Sequence[LoadResult]
) -> tuple[InterfaceVariant, ...]:
    """The load with the largest closing force with p(u) of the elastic and of the plastically smoothed surface."""
    case = solver.case
    if surface is None or surface.hardness is None or case.interface.law != "persson":
        return ()
    strongest = strongest_load(loads)
    load, variants = loads[strongest], []
    for name, plastic in (("elastic p(u)", False), ("plastic p(u)", True)):
        contact = load.contact
        if plastic != case.interface.plastic:
            law = surface.interface_law(plastic=plastic)
            if solver.yields:
                contact = solve_load(replace(solver, law=law), strongest)
            else:
                # what the fluid does between the surfaces stays as it is
                contact = solve(solver.model, law, axial_force=load.axial_force, loads=contact.loads)
        leak = None
        if case.fluid is not None:
            table = conductivity_table(case, surface, [contact])
            leak = leak_of_contact(case, table, contact, load.fluid_pressure).leak_rate
        profile = contact.profile
        variants.append(InterfaceVariant(name, profile.peak_pressure, profile.fwhm, profile.std, leak))
    return tuple(variants)
