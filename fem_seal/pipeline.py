"""The chain from a case to its results: geometry, mesh, contact, profile, leak."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.case_flow import expected_forces
from fem_seal.caution import worst_first
from fem_seal.condensation import ContactModel
from fem_seal.contact import solve
from fem_seal.contact_size import element_sizes
from fem_seal.contact_solution import ContactSolution
from fem_seal.contact_zone import solve_fitted
from fem_seal.discretisation import discretisation_error, on_coarser_mesh
from fem_seal.errors import InputError
from fem_seal.far_field import far_field
from fem_seal.fluid_flow import flow_table, leak_of_profile
from fem_seal.interface import exponential_law, rough_contact
from fem_seal.inverse_questions import with_answers
from fem_seal.laws import HardContact, Law
from fem_seal.load_solver import LoadSolver, condensed
from fem_seal.loads import line_load
from fem_seal.plastic_width import curves, for_yielding
from fem_seal.results import InterfaceVariant, LoadResult, SealResult, strongest_load
from fem_seal.solved_loads import SolvedLoads, solve_load, solve_loads
from fem_seal.validity import contact_cautions, left_out, load_validity
from meshes import SealMesh, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.case import Case
    from leak import ConductivityTable, GasConductivityTable, LeakResult, RoughContact

Progress = Callable[[str], None]


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
        Loads at which the fluid opens the seal are left out, with a warning each.

    Raises
    ------
    InputError
        If the fluid opens the seal at every load.
    GeometryError
        If the bodies do not fit together.
    MeshingError
        If gmsh cannot be loaded or fails.
    ConvergenceError
        If a contact does not converge.
    """
    clock = Clock(progress or (lambda text: None))
    with clock.step("interface", "roughness and interface law"):
        surface = rough_contact(case)
        law = interface_law(case, surface)
    seal_mesh, model, solved = model_and_contacts(case, law, clock)
    contacts, remarks = solved.contacts, tuple(left_out(case.load, solved.open_loads))
    case = _closed_loads(case, solved)
    with clock.step("leak", "flow conductivity and leak rates"):
        flows = _leak_rates(case, surface, contacts)
    with clock.step("stress", "stress in both bodies"):
        separations = _critical_separations(surface, contacts)
        loads = tuple(
            _load_result(*item) for item in zip(case.load.points, contacts, *flows, *separations, strict=True)
        )
    with clock.step("error", "estimating the discretisation error"):
        strongest = strongest_load(loads)
        coarser = on_coarser_mesh(case, law, seal_mesh.sizing, strongest)
        error = discretisation_error(contacts[strongest], coarser, seal_mesh.sizing)
    with clock.step("far field", "comparing sizes and supports far from the contact"):
        far = far_field(coarser)
    with clock.step("questions", "blow-off and force for the target leak rate"):
        loads, of_answers = with_answers(LoadSolver(case, law, model), loads)
    with clock.step("variants", "comparing elastic and plastic interface law"):
        variants = _interface_variants(LoadSolver(case, law, model), surface, loads)
    found = (*remarks, *contact_cautions(case, model, loads, error, surface), *of_answers)
    result = SealResult(
        case,
        seal_mesh,
        model,
        surface,
        tuple(replace(load, validity=load_validity(case, load, surface, error)) for load in loads),
        error,
        variants,
        tuple(caution.text for caution in worst_first(found)),
        clock.timings,
        far_field=far,
        unloaded=solved.unloaded,
    )
    return _with_uncertainty(_with_theory_variants(result, clock), clock)


def _with_theory_variants(result: SealResult, clock: Clock) -> SealResult:
    if not result.case.leak.variants:
        return result
    from fem_seal.theory_variants import theory_variants

    with clock.step("theory", "leak rates with every reading of the theory"):
        return replace(result, theory_variants=theory_variants(result))


def _with_uncertainty(result: SealResult, clock: Clock) -> SealResult:
    if result.case.uncertainty is None:
        return result
    from fem_seal.uncertainty import leak_interval

    with clock.step("uncertainty", "leak rates of uncertain inputs"):
        return replace(result, uncertainty=leak_interval(result, progress=clock.progress))


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
    return for_yielding(elastic, case, line_loads, size_given=size is not None) if curves(case) else elastic


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
    GeometryError, MeshingError, ConvergenceError
    """
    clock = clock or Clock(lambda text: None)
    meshes: list[SealMesh] = []
    solved: list[SolvedLoads] = []

    def solve_on(sizing: Sizing) -> Sequence[ContactSolution]:
        with clock.step("mesh", "meshing closure and seat"):
            meshes.append(build_contact(case.contact, sizing))
        with clock.step("condense", "condensing both bodies on the contact line"):
            solver = LoadSolver(case, law, condensed(case, meshes[-1]))
        along = ", one after the other in load steps, and unloading" if solver.yields else ""
        with clock.step("contact", f"solving {len(case.load.fluid_pressure)} contacts{along}"):
            solved.append(solve_loads(solver))
        return solved[-1].contacts

    size_given = case.mesh.contact_size is not None
    contacts = solve_fitted(sizing(case, law), case.contact, solve_on, size_given=size_given)
    return meshes[-1], contacts[0].model, solved[-1]


def _closed_loads(case: Case, solved: SolvedLoads) -> Case:
    """The case without the loads at which its seal is open."""
    if not solved.open_loads:
        return case
    return case.model_copy(update={"load": case.load.without(solved.open_loads)})


def condensed_on(case: Case, sizing: Sizing) -> ContactModel:
    """The bodies of a case, meshed with a sizing and condensed."""
    return condensed(case, build_contact(case.contact, sizing))


def _leak_rates(
    case: Case, surface: RoughContact | None, contacts: Sequence[ContactSolution]
) -> tuple[list[LeakResult | None], list[LeakResult | None]]:
    """Leak of each contact with the case's surface and with the same surface kept elastic."""
    if surface is None or case.fluid is None:
        nothing: list[LeakResult | None] = [None] * len(contacts)
        return nothing, nothing
    plastic = conductivity_table(case, surface, contacts)
    elastic = plastic if surface.hardness is None else conductivity_table(case, surface.elastic, contacts)
    return (
        [
            leak_of_contact(case, plastic, c, p)
            for c, p in zip(contacts, case.load.fluid_pressure, strict=True)
        ],
        [
            leak_of_contact(case, elastic, c, p)
            for c, p in zip(contacts, case.load.fluid_pressure, strict=True)
        ],
    )


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
    return leak_of_profile(case, table, profile.x, profile.pressure, fluid_pressure, profile.radius)


def _critical_separations(
    surface: RoughContact | None, contacts: Sequence[ContactSolution]
) -> tuple[list[float | None], list[float | None]]:
    """u_c at the peak of every contact with the case's surface and with the same surface kept elastic [m]."""
    if surface is None:
        nothing: list[float | None] = [None] * len(contacts)
        return nothing, nothing
    peaks = np.array([contact.profile.peak_pressure for contact in contacts])
    return (
        np.asarray(surface.critical_separation(peaks)).tolist(),
        np.asarray(surface.elastic.critical_separation(peaks)).tolist(),
    )


def _load_result(
    point: tuple[float, float],
    contact: ContactSolution,
    leak: LeakResult | None,
    leak_elastic: LeakResult | None,
    critical_separation: float | None,
    critical_separation_elastic: float | None,
) -> LoadResult:
    stress, place = _largest_stress(contact)
    fluid_pressure, applied_force = point
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
