"""Sources of condensed bodies and conductivity tables: exact for one problem, or shared by similar ones.

The default mesh follows from roughness and load, so that hardly two problems would have the same. Where bodies are
shared its element sizes are rounded to powers of a root of two, to the finer and to the wider side. A problem's mesh
still depends on that problem alone and not on its neighbours or their order, but equal geometries share a few meshes.
Surfaces of one family share tables, see `fem_seal.seal.conductivity_tables`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Self

from fem_seal.bodies.supports import Supports
from fem_seal.contact.model import ContactModel, condense, with_stress_bound
from fem_seal.contact.solution import DEFAULT_SETTINGS, ContactSettings
from fem_seal.materials import Material
from fem_seal.seal.conductivity_tables import family_law, family_table
from fem_seal.seal.kept import Kept
from fem_seal.seal.leak_model import Conductivity, FlowModel
from fem_seal.seal.load_solver import Clock
from fem_seal.seal.problem import SealProblem, condensed, with_stop
from leak import RoughContact
from meshes import ContactGeometry, SealMesh, Sizing, build_contact

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
        interface, surface = problem.interface, problem.surface
        if interface.law == "spectrum" and not interface.plastic and surface is not None:
            return replace(problem, given_law=family_law(surface))
        return problem

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
