"""Sources of condensed bodies and conductivity tables: exact for one problem, shared by similar ones, or near one.

The default mesh follows from roughness and load, so that hardly two problems would have the same. Where bodies are
shared its element sizes are rounded to powers of a root of two, to the finer and to the wider side. A problem's mesh
still depends on that problem alone and not on its neighbours or their order, but equal geometries share a few meshes.
Surfaces of one family share tables, see `fem_seal.seal.conductivity_tables`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count
from typing import TYPE_CHECKING, Self

from fem_seal.bodies.supports import Supports
from fem_seal.contact.model import ContactModel, condense, with_stress_bound
from fem_seal.contact.newton import ContactProblem
from fem_seal.contact.solution import DEFAULT_SETTINGS, ContactSettings, ContactSolution, largest_before
from fem_seal.materials import Material
from fem_seal.seal.conductivity_tables import family_law, family_table, same_family
from fem_seal.seal.keyed_store import KeyedStore
from fem_seal.seal.leak_model import Conductivity, FlowModel
from fem_seal.seal.leak_model import log_peaks as log_peaks_of
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import Clock, LoadSolver, SolvedLoads, solve_linearised, solve_path
from fem_seal.seal.problem import SealProblem, condense_bodies, with_stop
from meshes import ContactGeometry, SealMesh, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.seal.circumference import Circumference
    from leak.flow.turned_contact import FaceContact

# Elements in the core of a soft contact, as most are in a study, and what three digits of their size may add.
_SOFT_CORE = 18.2
# A model with the displacements of its bodies holds some 20 MB, the condensed one a few hundred kB.
_FULL_MODELS, _LIGHT_MODELS = 12, 64
# Loads of one model from which on a quick look at the stress is made: it takes as long as the fields of so many. What
# it lets pass has no field that could say otherwise: the numbers of a design stay those of that design alone.
_WORTH_A_SCREEN = 6
# The residual is that of the state itself and so the relative error of its pressures: a hundredth of what the mesh
# leaves. Mostly Newton's last step falls far below it.
_TOLERANCE = 1e-6


class Source:
    """Bodies on a mesh of the problem's own, and tables over the pressures of its contacts: those of a run."""

    settings = DEFAULT_SETTINGS

    def source_for(self, problem: SealProblem) -> Source:
        """The source for a problem: itself, or that of a run where there is nothing to share."""
        return self

    def problem(self, problem: SealProblem) -> SealProblem:
        """The problem as it is solved with what comes from here."""
        return problem

    def bodies(
        self, problem: SealProblem, sizing: Sizing, clock: Clock
    ) -> tuple[SealMesh | None, ContactModel]:
        """Condensed bodies, with their mesh where it is kept.

        Parameters
        ----------
        problem : SealProblem
        sizing : Sizing
        clock : Clock
            Told what is being done.
        """
        with clock.step("mesh", "meshing closure and seat"):
            seal_mesh = build_contact(problem.contact, sizing)
        with clock.step("condense", "condensing both bodies on the contact line"):
            return seal_mesh, condense_bodies(problem, seal_mesh)

    def table(self, flow: FlowModel, surface: FaceContact, log_peaks: Sequence[float]) -> Conductivity:
        """Flow conductivity of a surface over peak pressures given as decimal logarithms [Pa]."""
        return flow.table_around(surface, log_peaks)


OWN_BODIES = Source()


@dataclass(frozen=True)
class MeshRounding:
    """How far apart rounded sizes are, and how much coarser than a run's the elements are.

    Parameters
    ----------
    step, reach_step : float
        Of the sizes and of the reach, in the logarithm to base 2. A longer reach costs few elements.
    along, deep : float
        Factors on the growth of the elements along the faces and into the bodies.
    touching : float
        Factor on the size where the bodies touch.
    edges : float
        Further factor on sizes and growth along faces with edges, of which a run follows each as if it bore the most.
    """

    step: float = 0.25
    reach_step: float = 1.0
    along: float = 1.0
    deep: float = 1.0
    touching: float = 1.0
    edges: float = 1.0


STUDIES = MeshRounding()


@dataclass(frozen=True)
class Bodies:
    """What condensed elastic bodies follow from; the key under which they are kept."""

    contact: ContactGeometry
    sizing: Sizing
    closure: Material
    seat: Material
    supports: Supports

    @classmethod
    def of(cls, problem: SealProblem, sizing: Sizing, rounding: MeshRounding) -> Self:
        """Those of a problem, their sizes rounded."""
        exact_size = problem.contact_size is not None
        return cls(
            problem.contact,
            round_sizes(sizing, problem.contact, exact_size=exact_size, rounding=rounding),
            _elastic(problem.materials["closure"]),
            _elastic(problem.materials["seat"]),
            problem.supports,
        )

    def condense(self, known: ContactModel | None = None) -> ContactModel:
        """The bodies, condensed; of a model that is known one of them may be the same, see `condense`."""
        seal_mesh = build_contact(self.contact, self.sizing)
        materials = {"closure": self.closure, "seat": self.seat}
        return condense(seal_mesh, materials, self.supports, known=known)


def with_family_law(problem: SealProblem) -> SealProblem:
    """A problem with the elastic law of its surface from that of its shape, where it has such a law."""
    interface, surface = problem.interface, problem.surface
    if interface.law == "spectrum" and not interface.plastic and surface is not None:
        return replace(problem, given_law=family_law(surface))
    return problem


def family_or_own_table(flow: FlowModel, surface: FaceContact, log_peaks: Sequence[float]) -> Conductivity:
    """Flow conductivity of a surface from tables of its family; its own where it is simulated."""
    return family_table(flow, surface) or flow.table_around(surface, log_peaks)


@dataclass(frozen=True, eq=False)
class SharedBodies(Source):
    """Bodies and tables that neighbouring problems share.

    Parameters
    ----------
    rounding : MeshRounding
        Of the sizes of the mesh.
    light : KeyedStore
        Bodies without a way to stresses.
    tables : callable
        See `Source.table`.
    stress : bool
        Whether stresses will be asked for; without them bodies take far less memory.
    """

    rounding: MeshRounding = STUDIES
    light: KeyedStore = field(default_factory=lambda: KeyedStore(_LIGHT_MODELS))
    tables: Callable[[FlowModel, FaceContact, Sequence[float]], Conductivity] = family_or_own_table
    stress: bool = False

    settings = ContactSettings(_TOLERANCE, _TOLERANCE, fluid_tolerance=_TOLERANCE)

    def source_for(self, problem: SealProblem) -> Source:
        """That of a run for bodies that yield, whose path takes longer than their mesh, and for heat of their own."""
        return OWN_BODIES if problem.follows_path or problem.at_rest.heating is not None else self

    def problem(self, problem: SealProblem) -> SealProblem:
        """With the law of its surface's family, made once for all surfaces of one shape."""
        return with_family_law(problem)

    def bodies(
        self, problem: SealProblem, sizing: Sizing, clock: Clock
    ) -> tuple[SealMesh | None, ContactModel]:
        """Those that are kept, of rounded sizes."""
        key = Bodies.of(problem, sizing, self.rounding)
        if not self.stress:
            model = self.light.get(
                key, lambda: key.condense(self.light.latest_value).with_face_strain.line_alone
            )
            return None, with_stop(problem, model)
        can_yield = tuple(name for name, material in problem.materials.items() if material.yield_stress)
        if next(_model_uses.get(key, count)) < _WORTH_A_SCREEN:
            return None, with_stop(problem, _full_models.get(key, key.condense))
        model = _full_models.get(
            (key, can_yield), lambda: with_stress_bound(_full_models.get(key, key.condense), can_yield)
        )
        return None, with_stop(problem, model)

    def table(self, flow: FlowModel, surface: FaceContact, log_peaks: Sequence[float]) -> Conductivity:
        """From tables that are shared."""
        return self.tables(flow, surface, log_peaks)


# What is known of the load before all others, beside the numbers of the loads.
_LOAD_BEFORE = -1


@dataclass(frozen=True, eq=False)
class NeighbourSource(Source):
    """Bodies, contacts and tables for problems close to one that is solved.

    They may differ from it in surface, fluid and form error, and by a factor on both Young's moduli. What the fluid
    does between the surfaces and how many waves fill a tolerance stay as they are.

    Parameters
    ----------
    solved_problem : SealProblem
        What is solved.
    solved_model : ContactModel
        Its bodies.
    seal_mesh : SealMesh
        Their mesh.
    loads : sequence of LoadResult
        Its loads.
    numbers : tuple of int
        Of the loads that are asked for, in their order.
    whole_paths : bool
        Whether bodies that yield go through all their loads, instead of being linearised at each of the known ones;
        they do where their modulus changes.
    """

    solved_problem: SealProblem
    solved_model: ContactModel
    seal_mesh: SealMesh
    loads: Sequence[LoadResult]
    numbers: tuple[int, ...]
    whole_paths: bool = False

    # residual of the contacts, and so the relative error of their pressures
    settings = ContactSettings(1e-4, 1e-4)

    def problem(self, problem: SealProblem) -> SealProblem:
        """With the law of the solved problem where it is the same, so that its contacts are, too."""
        known_problem, interface = self.solved_problem, problem.interface
        assert problem.surface is not None and known_problem.surface is not None  # of all who ask
        elastic = interface.law == "spectrum" and not interface.plastic
        before, after = (s.elastic if elastic else s for s in (known_problem.surface, problem.surface))
        if self._on_given_profiles or before == after:
            return replace(problem, given_law=known_problem.law)
        if elastic and same_family(problem.surface, known_problem.surface):
            return with_family_law(problem)
        same_law = interface.law != "spectrum" and problem.law == known_problem.law
        return replace(problem, given_law=known_problem.law) if same_law else problem

    @property
    def _on_given_profiles(self) -> bool:
        """Whether its contacts are given pressure profiles, which stay as they are."""
        return self.loads[0].of_profile

    def _stiffness(self, problem: SealProblem) -> float:
        """Factor on both Young's moduli."""
        after, before = (seal.materials["seat"].youngs_modulus for seal in (problem, self.solved_problem))
        return after / before

    def _moves(self, problem: SealProblem) -> bool:
        """Whether a contact is not the known one; a given one stays what it is."""
        differs = problem.law is not self.solved_problem.law or self._stiffness(problem) != 1.0
        return differs and not self._on_given_profiles

    def model(self, problem: SealProblem) -> ContactModel:
        """The known bodies, with another modulus where they have one."""
        factor = self._stiffness(problem)
        if factor != 1.0 and problem.follows_path:
            return condense_bodies(problem, self.seal_mesh)
        return self.solved_model if self._on_given_profiles else self.solved_model.stiffer(factor)

    def pressings(self, problem: SealProblem, model: ContactModel) -> dict[int, ContactProblem]:
        """What is to be pressed again, from the known contacts: nothing on a path and where nothing moves."""
        if problem.follows_path or not self._moves(problem):
            return {}
        contacts = {number: self.loads[number].contact for number in self.numbers}
        for earlier in largest_before(list(contacts.values())):
            contacts[_LOAD_BEFORE] = earlier
        return {
            number: ContactProblem(
                model, problem.law, contact.pressing_force, contact.loads, self.settings, start=contact
            )
            for number, contact in contacts.items()
        }

    def contacts(
        self, problem: SealProblem, model: ContactModel, outcomes: Mapping[int, ContactSolution | Exception]
    ) -> list[ContactSolution]:
        """Contact of each of the loads that are asked for.

        Parameters
        ----------
        problem : SealProblem
        model : ContactModel
        outcomes : mapping
            What became of `pressings`.

        Raises
        ------
        ConvergenceError
            If one of them does not converge.
        """
        contacts = [self.loads[number].contact for number in self.numbers]
        if not self._moves(problem):
            return contacts
        if not problem.follows_path:
            for outcome in outcomes.values():
                if isinstance(outcome, Exception):
                    raise outcome
            solutions = {n: contact for n, contact in outcomes.items() if not isinstance(contact, Exception)}
            return [solutions[number].after(solutions.get(_LOAD_BEFORE)) for number in self.numbers]
        if self.whole_paths or self._stiffness(problem) != 1.0:
            path = solve_path(LoadSolver(problem, model))
            return [path[number] for number in self.numbers]
        return solve_linearised(contacts, problem.law)

    def solve(
        self, problem: SealProblem, model: ContactModel, outcomes: Mapping[int, ContactSolution | Exception]
    ) -> SolvedLoads:
        """The loads that are asked for; see `contacts`."""
        contacts = self.contacts(problem, model, outcomes)
        circumferences: list[Circumference] = []
        for number, contact in zip(self.numbers, contacts, strict=True):
            load = self.loads[number]
            same = contact is load.contact and problem.form is self.solved_problem.form
            circumference = (
                load.circumference
                if same
                else problem.circumference(contact, load.fluid_pressure, load.circumference)
            )
            circumferences += [] if circumference is None else [circumference]
        return SolvedLoads(contacts, circumferences=circumferences)

    def table(self, flow: FlowModel, surface: FaceContact, log_peaks: Sequence[float]) -> Conductivity:
        """Of the known surface's family, or a short one for the pressures of the contacts themselves."""
        solved_surface, direct = self.solved_problem.surface, flow.direct
        assert solved_surface is not None  # of all who ask
        if direct is not None and surface not in (solved_surface, solved_surface.elastic):
            table_of = partial(self.table, replace(flow, direct=None), log_peaks=log_peaks)
            of_gas = flow.gas is not None
            return direct.of_neighbour(solved_surface, surface, table_of, end=flow.end, of_gas=of_gas)
        if direct is not None:
            # with the range of the solved seal, as long as it will do, the table's own error is that of all
            solved_peaks = log_peaks_of(
                [contact for load in self.loads for contact in load.contacts], surface
            )
            return flow.table_around(surface, [*solved_peaks, *log_peaks])
        table = family_table(flow, surface) if same_family(surface, solved_surface) else None
        return table or flow.short_table(surface, log_peaks)


# of all studies of this process
_full_models, _model_uses = KeyedStore(2 * _FULL_MODELS), KeyedStore(_LIGHT_MODELS)


def round_sizes(
    sizing: Sizing, contact: ContactGeometry, *, exact_size: bool = False, rounding: MeshRounding = STUDIES
) -> Sizing:
    """Sizing with rounded numbers: never narrower along the contact, nor coarser than the rounding says.

    A spot moves by half an element.

    Parameters
    ----------
    sizing : Sizing
    contact : ContactGeometry
        The zone still ends where one of the faces ends.
    exact_size : bool
        Whether the contact size is the user's own and stays.
    rounding : MeshRounding
    """
    lower, upper = contact.reach
    step = rounding.step
    start, end = (_round_up(abs(x), rounding.reach_step) for x in sizing.zone)
    edges = rounding.edges if sizing.spots else 1.0
    coarser = 1.0 if exact_size else rounding.touching * edges
    size = (
        sizing.contact_size
        if exact_size
        else min(_round_down(coarser * sizing.contact_size, step), sizing.far_size)
    )
    elements = _SOFT_CORE * _round_up(sizing.core / sizing.contact_size / _SOFT_CORE, step)
    return replace(
        sizing,
        contact_size=size,
        # so many of the largest elements that are rounded to this size: it brings no meshes of its own beside theirs
        core=elements * (size if exact_size else 2.0**step * size),
        zone=(max(-start, lower), min(end, upper)),
        growth_along=rounding.along * edges * _round_down(sizing.growth_along, step),
        growth_deep=rounding.deep * sizing.growth_deep,
        spots=_round_spots(sizing, contact, step, coarser),
    )


def _round_spots(
    sizing: Sizing, contact: ContactGeometry, step: float, coarser: float
) -> tuple[tuple[float, float], ...]:
    """Spots with rounded sizes, at multiples of them; edges and ends of the faces stay where they are."""
    lower, upper = contact.reach
    edges = {lower, upper, *contact.breaks.tolist()}
    spots = set()
    for place, spot_size in sizing.spots:
        size = _round_down(coarser * spot_size, step)
        multiple = min(max(size * round(place / size), lower), upper)
        spots.add((place if place in edges else multiple, size))
    return tuple(sorted(spots))


def _elastic(material: Material) -> Material:
    """What stiffness depends on: materials that differ in hardness or name only are the same body."""
    return Material("", material.youngs_modulus, material.poissons_ratio)


def _round_down(size: float, step: float) -> float:
    return float(2.0 ** (step * math.floor(math.log2(size) / step + 1e-9)))


def _round_up(size: float, step: float) -> float:
    return float(2.0 ** (step * math.ceil(math.log2(size) / step - 1e-9)))
