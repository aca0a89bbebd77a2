"""Discretisation error and far-field error: each load solved again on coarser elements and on larger bodies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.contact.model import ContactModel
from fem_seal.contact.plastic_step import PlasticSettings
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError, InputError
from fem_seal.profile import tightest_profile
from fem_seal.seal.load_result import DiscretisationError, strongest_load
from fem_seal.seal.load_solver import LoadSolver, solve_load
from fem_seal.seal.problem import SealProblem, condense_bodies, larger_housing
from leak import LeakResult
from meshes import GeometryError, MeshingError, SealMesh, Sizing, build_contact

# Of a result whose estimate failed.
NOT_ESTIMATED = DiscretisationError(math.nan, math.nan, math.nan, None)
# The coarser mesh of the error estimate has elements this much larger, its path load steps.
COARSER = 2
_STEPS = PlasticSettings().steps


@dataclass(frozen=True)
class Comparison:
    """The load with the largest closing force once more, with something changed.

    Parameters
    ----------
    name : str
        What was changed.
    peak_pressure, fwhm, std : float
        [Pa], [m], [m]; relative where it says so.
    leak_rate : float or None
        [m^3/s]; None without one, and relative to one that is zero or infinite.
    others : mapping
        The leak rate in the other readings of yielding asperities, where it was asked for [m^3/s].
    """

    name: str
    peak_pressure: float
    fwhm: float
    std: float
    leak_rate: float | None
    others: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, name: str, contact: ContactSolution, leak: LeakResult | None) -> Comparison:
        """The numbers of a contact that are compared: of the line that is pressed hardest."""
        profile = tightest_profile(contact.profiles)
        rate = None if leak is None else leak.leak_rate
        return cls(name, profile.peak_pressure, profile.fwhm, profile.std, rate)

    def relative_to(self, base: Comparison) -> Comparison:
        """Change of each number relative to that of another contact."""
        rate = None
        if self.leak_rate is not None and base.leak_rate is not None and 0 < base.leak_rate < math.inf:
            rate = self.leak_rate / base.leak_rate - 1
        peak, fwhm = self.peak_pressure / base.peak_pressure - 1, self.fwhm / base.fwhm - 1
        return Comparison(self.name, peak, fwhm, self.std / base.std - 1, rate)


@dataclass(frozen=True)
class CoarserLoad:
    """One load of a problem on larger elements than those of the result.

    Parameters
    ----------
    solver : LoadSolver
    mesh : SealMesh
    number : int
        Which of the loads it is.
    contact : ContactSolution
    """

    solver: LoadSolver
    mesh: SealMesh
    number: int
    contact: ContactSolution

    @cached_property
    def own_comparison(self) -> Comparison:
        """What is compared of this load itself."""
        return self.compare("as it is", self.contact)

    def compare(self, name: str, contact: ContactSolution) -> Comparison:
        """What is compared of this load on some contact."""
        flow = self.solver.flow
        pressure = self.solver.problem.loads.fluid_pressure[self.number]
        return Comparison.of(name, contact, None if flow is None else flow.leak_of(contact, pressure))


def on_coarser_mesh(problem: SealProblem, sizing: Sizing, number: int) -> CoarserLoad:
    """Solve one load of a problem on elements larger by `COARSER`.

    Parameters
    ----------
    problem : SealProblem
    sizing : Sizing
        Of the result.
    number : int
        Which of the loads.
    """
    mesh = build_contact(problem.contact, sizing.refined(1 / COARSER))
    solver = LoadSolver(problem, condense_bodies(problem, mesh))
    return CoarserLoad(solver, mesh, number, solve_load(solver, number, steps=_STEPS // COARSER))


def discretisation_error(
    result: ContactSolution, coarser: CoarserLoad, sizing: Sizing
) -> DiscretisationError:
    """How far a load may be from that on infinitely small elements.

    Parameters
    ----------
    result : ContactSolution
    coarser : CoarserLoad
        The same load on larger elements.
    sizing : Sizing
        Of the result.
    """
    problem, fine, coarse = coarser.solver.problem, result, coarser.own_comparison
    ready = problem.contact.has_ready_mesh
    if ready:
        # a ready mesh cannot be made coarser, but finer
        fine_mesh = build_contact(problem.contact.with_finer_meshes(), sizing.refined(COARSER))
        solver = LoadSolver(problem, condense_bodies(problem, fine_mesh))
        fine = solve_load(solver, coarser.number, steps=_STEPS * COARSER)
        coarse = coarser.compare("coarser", result)
    # Load steps of implicit Euler are of first order; elements of second at least.
    order = 1 if coarser.solver.model.yields else 2
    change = coarse.relative_to(coarser.compare("finer", fine))

    def richardson_error(change: float) -> float:
        """Relative error by Richardson's rule."""
        return abs(change) / (COARSER**order - 1) * (COARSER**order if ready else 1.0)

    rate = None if change.leak_rate is None else richardson_error(change.leak_rate)
    peak, fwhm, std = map(richardson_error, (change.peak_pressure, change.fwhm, change.std))
    return DiscretisationError(peak, fwhm, std, rate)


def far_field(load: CoarserLoad, seal: SolvedSeal) -> tuple[Comparison, ...]:
    """Solve one load with a housing twice as large, and with its wall held if it is free and free if it is held.

    Parameters
    ----------
    load : CoarserLoad
    seal : SolvedSeal
        With the case that has the shape of the housing.
    """

    def change(name: str, model: ContactModel) -> Comparison:
        solver, steps = replace(load.solver, model=model), _STEPS // COARSER
        contact = solve_load(solver, load.number, steps=steps, start=load.contact)
        return load.compare(name, contact).relative_to(load.own_comparison)

    changes = []
    for name, condense in _variations(load.solver, load.mesh, seal):
        # Close to blow-off the seal may open with another support: that is told by the blow-off pressure. The larger
        # housing is no question of this seal if it cannot be built.
        with suppress(InputError, ConvergenceError, GeometryError, MeshingError):
            changes.append(change(name, condense()))
    return tuple(changes)


def _variations(
    solver: LoadSolver, mesh: SealMesh, seal: SolvedSeal
) -> Iterator[tuple[str, Callable[[], ContactModel]]]:
    """Other bodies, made one after the other: each takes as much memory as those of the result."""
    problem, model = solver.problem, solver.model
    if problem.at_rest.interference or problem.faces > 1:
        # another size or support is another fit: that is no question of the far field; a gasket has neither
        return
    with suppress(GeometryError, MeshingError):
        larger = larger_housing(seal.case)
        if larger is not None:
            wider = replace(problem, contact=larger)
            yield (
                "a housing twice as wide and high",
                lambda: condense_bodies(wider, build_contact(larger, mesh.sizing, mesh), model),
            )
    free = problem.supports.wall == "free"
    other_problem = replace(problem, supports=replace(problem.supports, wall="fixed" if free else "free"))
    yield (
        "holding its wall" if free else "leaving its wall free",
        lambda: condense_bodies(other_problem, mesh, model),
    )


@dataclass(frozen=True)
class Accuracy:
    """How far the strongest load can be trusted.

    Parameters
    ----------
    error : DiscretisationError
    far_field : tuple of Comparison
        What another housing and another support of its wall do to it.
    """

    error: DiscretisationError = NOT_ESTIMATED
    far_field: tuple[Comparison, ...] = ()


def _compute(seal: SolvedSeal, request: Request) -> Accuracy:
    # the bodies on coarser elements are gone when this is done
    sizing, strongest = seal.seal_mesh.sizing, strongest_load(seal.loads)
    with request.clock.step("error", "estimating the discretisation error"):
        coarser = on_coarser_mesh(seal.problem, sizing, strongest)
        estimate = partial(discretisation_error, seal.loads[strongest].contact, coarser, sizing)
        error = request.steps.compute(ACCURACY.subject, estimate, NOT_ESTIMATED)
    with request.clock.step("far field", "comparing sizes and supports far from the contact"):
        changes = request.steps.compute("influence of the far field", partial(far_field, coarser, seal), ())
    return Accuracy(error, changes)


ACCURACY = Answer[Accuracy](
    "accuracy",
    "discretisation error",
    _compute,
    Accuracy(),
    of_load=lambda load, number, accuracy: load.with_values(mesh_error=accuracy.error),
    of_part=True,
)
