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
from itertools import count
from typing import TYPE_CHECKING, Self

from fem_seal.bodies.supports import Supports
from fem_seal.contact.model import ContactModel, condense, with_stress_bound
from fem_seal.contact.newton import ContactProblem
from fem_seal.contact.solution import DEFAULT_SETTINGS, ContactSettings, ContactSolution, largest_before
from fem_seal.materials import Material
from fem_seal.seal.conductivity_tables import family_law, family_table, same_family
from fem_seal.seal.kept import Kept
from fem_seal.seal.leak_model import Conductivity, FlowModel
from fem_seal.seal.leak_model import log_peaks as log_peaks_of
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import Clock, LoadSolver, SolvedLoads, linearised_again, path_again
from fem_seal.seal.problem import SealProblem, condensed, with_stop
from leak import RoughContact
from meshes import ContactGeometry, SealMesh, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.seal.circumference import Circumference

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

    def suited(self, problem: SealProblem) -> Source:
        """The source for a problem: itself, or that of a run where there is nothing to share."""
        return self

    def problem(self, problem: SealProblem) -> SealProblem:
        """The problem as it is solved with what comes from here."""
        return problem

    def bodies(
        self, problem: SealProblem, wanted: Sizing, clock: Clock
    ) -> tuple[SealMesh | None, ContactModel]:
        """Condensed bodies, with their mesh where it is kept.

        Parameters
        ----------
        problem : SealProblem
        wanted : Sizing
        clock : Clock
            Told what is being done.
        """
        with clock.step("mesh", "meshing closure and seat"):
            seal_mesh = build_contact(problem.contact, wanted)
        with clock.step("condense", "condensing both bodies on the contact line"):
            return seal_mesh, condensed(problem, seal_mesh)

    def table(self, flow: FlowModel, surface: RoughContact, log_peaks: Sequence[float]) -> Conductivity:
        """Flow conductivity of a surface over peak pressures given as decimal logarithms [Pa]."""
        return flow.table_around(surface, log_peaks)


EXACT = Source()


@dataclass(frozen=True)
class Rounding:
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


OF_STUDIES = Rounding()


@dataclass(frozen=True)
class Bodies:
    """What condensed elastic bodies follow from; their name where they are kept."""

    contact: ContactGeometry
    sizing: Sizing
    closure: Material
    seat: Material
    supports: Supports

    @classmethod
    def of(cls, problem: SealProblem, wanted: Sizing, rounding: Rounding) -> Self:
        """Those of a problem, their sizes rounded."""
        exact = problem.contact_size is not None
        return cls(
            problem.contact,
            rounded(wanted, problem.contact, exact_size=exact, rounding=rounding),
            _elastic(problem.materials["closure"]),
            _elastic(problem.materials["seat"]),
            problem.supports,
        )

    def made(self, known: ContactModel | None = None) -> ContactModel:
        """The bodies, condensed; of a model that is known one of them may be the same, see `condense`."""
        seal_mesh = build_contact(self.contact, self.sizing)
        materials = {"closure": self.closure, "seat": self.seat}
        return condense(seal_mesh, materials, self.supports, known=known)

    def made_light(self, known: ContactModel | None = None) -> ContactModel:
        """The same without the way to stresses inside of them, which takes far more memory."""
        return self.made(known).line_alone


def with_family_law(problem: SealProblem) -> SealProblem:
    """A problem with the elastic law of its surface from that of its shape, where it has such a law."""
    interface, surface = problem.interface, problem.surface
    if interface.law == "spectrum" and not interface.plastic and surface is not None:
        return replace(problem, given_law=family_law(surface))
    return problem


def family_or_own_table(flow: FlowModel, surface: RoughContact, log_peaks: Sequence[float]) -> Conductivity:
    """Flow conductivity of a surface from tables of its family; its own where it is simulated."""
    return family_table(flow, surface) or flow.table_around(surface, log_peaks)


@dataclass(frozen=True, eq=False)
class Shared(Source):
    """Bodies and tables that neighbouring problems share.

    Parameters
    ----------
    rounding : Rounding
        Of the sizes of the mesh.
    light : Kept
        Bodies without a way to stresses.
    tables : callable
        See `Source.table`.
    stress : bool
        Whether stresses will be asked for; without them bodies take far less memory.
    """

    rounding: Rounding = OF_STUDIES
    light: Kept = field(default_factory=lambda: Kept(_LIGHT_MODELS))
    tables: Callable[[FlowModel, RoughContact, Sequence[float]], Conductivity] = family_or_own_table
    stress: bool = False

    settings = ContactSettings(_TOLERANCE, _TOLERANCE, fluid_tolerance=_TOLERANCE)

    def suited(self, problem: SealProblem) -> Source:
        """That of a run for bodies that yield, whose path takes longer than their mesh, and for heat of their own."""
        return EXACT if problem.follows_path or problem.at_rest.heating is not None else self

    def problem(self, problem: SealProblem) -> SealProblem:
        """With the law of its surface's family, made once for all surfaces of one shape."""
        return with_family_law(problem)

    def bodies(
        self, problem: SealProblem, wanted: Sizing, clock: Clock
    ) -> tuple[SealMesh | None, ContactModel]:
        """Those that are kept, of rounded sizes."""
        name = Bodies.of(problem, wanted, self.rounding)
        if not self.stress:
            made = self.light.get(name, lambda: name.made_light(self.light.latest))
            return None, with_stop(problem, made)
        can_yield = tuple(kind for kind, one in problem.materials.items() if one.yield_stress)
        if next(_uses.get(name, count)) < _WORTH_A_SCREEN:
            return None, with_stop(problem, _full.get(name, name.made))
        screened = _full.get(
            (name, can_yield), lambda: with_stress_bound(_full.get(name, name.made), can_yield)
        )
        return None, with_stop(problem, screened)

    def table(self, flow: FlowModel, surface: RoughContact, log_peaks: Sequence[float]) -> Conductivity:
        """From tables that are shared."""
        return self.tables(flow, surface, log_peaks)


# What is known of the load before all others, beside the numbers of the loads.
_BEFORE = -1


@dataclass(frozen=True, eq=False)
class NearSolved(Source):
    """Bodies, contacts and tables for problems close to one that is solved.

    They may differ from it in surface, fluid and form error, and by a factor on both Young's moduli. What the fluid
    does between the surfaces and how many waves fill a tolerance stay as they are.

    Parameters
    ----------
    solved : SealProblem
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

    solved: SealProblem
    solved_model: ContactModel
    seal_mesh: SealMesh
    loads: Sequence[LoadResult]
    numbers: tuple[int, ...]
    whole_paths: bool = False

    # residual of the contacts, and so the relative error of their pressures
    settings = ContactSettings(1e-4, 1e-4)

    def problem(self, problem: SealProblem) -> SealProblem:
        """With the law of the solved problem where it is the same, so that its contacts are, too."""
        known, interface = self.solved, problem.interface
        assert problem.surface is not None and known.surface is not None  # of all who ask
        elastic = interface.law == "spectrum" and not interface.plastic
        before, after = (each.elastic if elastic else each for each in (known.surface, problem.surface))
        if self._given or before == after:
            return replace(problem, given_law=known.law)
        if elastic and same_family(problem.surface, known.surface):
            return with_family_law(problem)
        given = interface.law != "spectrum" and problem.law == known.law
        return replace(problem, given_law=known.law) if given else problem

    @property
    def _given(self) -> bool:
        """Whether its contacts are given pressure profiles, which stay as they are."""
        return self.loads[0].of_profile

    def _stiffness(self, problem: SealProblem) -> float:
        """Factor on both Young's moduli."""
        after, before = (each.materials["seat"].youngs_modulus for each in (problem, self.solved))
        return after / before

    def _moves(self, problem: SealProblem) -> bool:
        """Whether a contact is not the known one; a given one stays what it is."""
        changed = problem.law is not self.solved.law or self._stiffness(problem) != 1.0
        return changed and not self._given

    def model(self, problem: SealProblem) -> ContactModel:
        """The known bodies, with another modulus where they have one."""
        factor = self._stiffness(problem)
        if factor != 1.0 and problem.follows_path:
            return condensed(problem, self.seal_mesh)
        return self.solved_model if self._given else self.solved_model.stiffer(factor)

    def pressings(self, problem: SealProblem, model: ContactModel) -> dict[int, ContactProblem]:
        """What is to be pressed again, from the known contacts: nothing on a path and where nothing moves."""
        if problem.follows_path or not self._moves(problem):
            return {}
        contacts = {number: self.loads[number].contact for number in self.numbers}
        for before in largest_before(list(contacts.values())):
            contacts[_BEFORE] = before
        return {
            number: ContactProblem(
                model, problem.law, known.pressing_force, known.loads, self.settings, start=known
            )
            for number, known in contacts.items()
        }

    def contacts(
        self, problem: SealProblem, model: ContactModel, pressed: Mapping[int, ContactSolution | Exception]
    ) -> list[ContactSolution]:
        """Contact of each of the loads that are asked for.

        Parameters
        ----------
        problem : SealProblem
        model : ContactModel
        pressed : mapping
            What became of `pressings`.

        Raises
        ------
        ConvergenceError
            If one of them does not converge.
        """
        known = [self.loads[number].contact for number in self.numbers]
        if not self._moves(problem):
            return known
        if not problem.follows_path:
            for outcome in pressed.values():
                if isinstance(outcome, Exception):
                    raise outcome
            solved = {number: each for number, each in pressed.items() if not isinstance(each, Exception)}
            return [solved[number].after(solved.get(_BEFORE)) for number in self.numbers]
        if self.whole_paths or self._stiffness(problem) != 1.0:
            contacts = path_again(LoadSolver(problem, model))
            return [contacts[number] for number in self.numbers]
        return linearised_again(known, problem.law)

    def solve(
        self, problem: SealProblem, model: ContactModel, pressed: Mapping[int, ContactSolution | Exception]
    ) -> SolvedLoads:
        """The loads that are asked for; see `contacts`."""
        contacts = self.contacts(problem, model, pressed)
        circumferences: list[Circumference] = []
        for number, contact in zip(self.numbers, contacts, strict=True):
            known = self.loads[number]
            same = contact is known.contact and problem.form is self.solved.form
            around = known.circumference if same else problem.circumference(contact, near=known.circumference)
            circumferences += [] if around is None else [around]
        return SolvedLoads(contacts, circumferences=circumferences)

    def table(self, flow: FlowModel, surface: RoughContact, log_peaks: Sequence[float]) -> Conductivity:
        """Of the known surface's family, or a short one for the pressures of the contacts themselves."""
        if flow.simulated is not None:
            # with the range of the solved seal, as long as it will do, the table's own error is that of all
            known = log_peaks_of([contact for load in self.loads for contact in load.contacts])
            return flow.table_around(surface, [*known, *log_peaks])
        known_surface = self.solved.surface
        assert known_surface is not None  # of all who ask
        table = family_table(flow, surface) if same_family(surface, known_surface) else None
        return table or flow.short_table(surface, log_peaks)


# of all studies of this process
_full, _uses = Kept(2 * _FULL_MODELS), Kept(_LIGHT_MODELS)


def rounded(
    sizing: Sizing, contact: ContactGeometry, *, exact_size: bool = False, rounding: Rounding = OF_STUDIES
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
    rounding : Rounding
    """
    lower, upper = contact.reach
    step = rounding.step
    start, end = (_up(abs(x), rounding.reach_step) for x in sizing.zone)
    edges = rounding.edges if sizing.spots else 1.0
    coarser = 1.0 if exact_size else rounding.touching * edges
    size = (
        sizing.contact_size
        if exact_size
        else min(_down(coarser * sizing.contact_size, step), sizing.far_size)
    )
    elements = _SOFT_CORE * _up(sizing.core / sizing.contact_size / _SOFT_CORE, step)
    return replace(
        sizing,
        contact_size=size,
        # so many of the largest elements that are rounded to this size: it brings no meshes of its own beside theirs
        core=elements * (size if exact_size else 2.0**step * size),
        zone=(max(-start, lower), min(end, upper)),
        growth_along=rounding.along * edges * _down(sizing.growth_along, step),
        growth_deep=rounding.deep * sizing.growth_deep,
        spots=_rounded_spots(sizing, contact, step, coarser),
    )


def _rounded_spots(
    sizing: Sizing, contact: ContactGeometry, step: float, coarser: float
) -> tuple[tuple[float, float], ...]:
    """Spots with rounded sizes, at multiples of them; edges and ends of the faces stay where they are."""
    lower, upper = contact.reach
    edges = {lower, upper, *contact.breaks.tolist()}
    found = set()
    for place, wanted in sizing.spots:
        size = _down(coarser * wanted, step)
        near = min(max(size * round(place / size), lower), upper)
        found.add((place if place in edges else near, size))
    return tuple(sorted(found))


def _elastic(material: Material) -> Material:
    """What stiffness depends on: materials that differ in hardness or name only are the same body."""
    return Material("", material.youngs_modulus, material.poissons_ratio)


def _down(size: float, step: float) -> float:
    return float(2.0 ** (step * math.floor(math.log2(size) / step + 1e-9)))


def _up(size: float, step: float) -> float:
    return float(2.0 ** (step * math.ceil(math.log2(size) / step - 1e-9)))
