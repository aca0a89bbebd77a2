"""Solve all loads of a problem on its condensed bodies, coupled to the flow where fluid is in the gap."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.bolts import Bolts, held_force
from fem_seal.contact.load_path import (
    ElastoplasticContact,
    FirstLoading,
    Leave,
    LoadPath,
    OpenLoad,
    PlaceOnPath,
    UnloadedBodies,
    load_path,
)
from fem_seal.contact.newton import ContactProblem, solve, solve_many
from fem_seal.contact.penetration import (
    CoupledContact,
    FluidAtContact,
    FluidInChambers,
    FluidPath,
    PenetratingFluid,
    blow_off_pressure,
    least_applied_force,
    solve_at_contact_force,
    solve_penetration,
)
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings, TightenedBolts
from fem_seal.contact.solution import (
    DEFAULT_SETTINGS,
    ContactSettings,
    ContactSolution,
    largest_before,
    strain_together,
)
from fem_seal.errors import (
    ConvergenceError,
    InputError,
    LimitLoadError,
    OpenSealError,
    Problem,
    SealError,
    error_text,
)
from fem_seal.files import problem
from fem_seal.loads import blow_off_of_sealed_area, contact_force
from fem_seal.profile import PressureProfile
from fem_seal.seal.cost import about
from fem_seal.seal.load_result import LoadResult, load_results
from fem_seal.seal.problem import SealFlow, SealProblem, condense_bodies
from fem_seal.wording import Quantity
from meshes import Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.contact.laws import Law
    from fem_seal.contact.model import ContactModel
    from fem_seal.seal.circumference import Circumference
    from fem_seal.seal.leak_model import Conductivity, FlowModel
    from leak.flow.turned_contact import FaceContact


@dataclass(frozen=True)
class LoadSolver:
    """Solves loads of a problem on one model.

    Parameters
    ----------
    problem : SealProblem
    model : ContactModel
    settings : ContactSettings
        Of loads without a path.
    """

    problem: SealProblem
    model: ContactModel
    settings: ContactSettings = DEFAULT_SETTINGS

    @classmethod
    def on_mesh(cls, problem: SealProblem, sizing: Sizing) -> LoadSolver:
        """On a mesh made with these sizes."""
        return cls(problem, condense_bodies(problem, build_contact(problem.contact, sizing)))

    def solve(
        self, fluid_pressure: float, applied_force: float, start: ContactSolution | None = None
    ) -> ContactSolution:
        """Contact under a fluid pressure [Pa] and the force of spring or actuator [N].

        It remembers the largest load before the loads of the problem.

        Raises
        ------
        InputError
            If these leave the seal open.
        ConvergenceError
        """
        return self._solve_without_memory(fluid_pressure, applied_force, start).after(self.earlier)

    def _solve_without_memory(
        self,
        fluid_pressure: float,
        applied_force: float,
        start: ContactSolution | None,
        *,
        first: bool = False,
    ) -> ContactSolution:
        """`solve` without memory; as the first load of all, or after the largest one before those of the problem."""
        if fluid_pressure == 0.0 or self.problem.on_sealed_area:
            return self._solve_sealed_area(applied_force + self.fluid_force(fluid_pressure), start)
        seal = self._first_seal if first else self.seal
        try:
            return solve_penetration(
                seal, applied_force=applied_force, fluid_pressure=fluid_pressure, start=start
            )
        except OpenSealError as error:
            raise self._open_seal(seal, fluid_pressure, applied_force, error) from error

    def pressings(self) -> dict[int, ContactProblem]:
        """What is to be pressed of each load, where each is a question of its own: no path, no way of the fluid."""
        if self.yields or not self.problem.on_sealed_area or self.problem.loads.unsolved_bolts is not None:
            return {}
        at_rest = self.problem.at_rest.body_loads(self.model)
        forces = [force + self.fluid_force(pressure) for pressure, force in self.problem.loads.points]
        # what is no force says so where its load is solved
        return {
            number: ContactProblem(self.model, self.problem.law, force, at_rest, self.settings)
            for number, force in enumerate(forces)
            if 0 < force < math.inf
        }

    def solve_pressed(self, number: int, outcome: ContactSolution | Exception | None) -> ContactSolution:
        """`solve` of one of the problem's loads, of which may be known already what its pressing gave."""
        if outcome is None:
            return self.solve(*self.problem.loads.points[number])
        if isinstance(outcome, Exception):
            raise outcome
        return outcome.after(self.earlier)

    def solve_bolts(self, number: int, bolts: Bolts) -> tuple[tuple[float, float], ContactSolution]:
        """Fluid pressure [Pa] and force of the bolts [N] under one of the problem's loads, and its contact.

        Parameters
        ----------
        number : int
        bolts : Bolts

        Raises
        ------
        InputError
            If the load leaves the seal open.
        ConvergenceError
        """
        pressure, preload = self.problem.loads.points[number]
        at_preload = self.solve(0.0, preload)
        contact = at_preload

        def approach(force: float) -> float:
            nonlocal contact
            contact = self.solve(pressure, force, contact)
            return contact.approach

        force = held_force(bolts, preload, approach, at_preload.approach)
        return (pressure, force), self.solve(pressure, force, contact)

    @cached_property
    def earlier(self) -> ContactSolution | None:
        """Contact under the largest load before those of the problem; None where none is known.

        Raises
        ------
        InputError
            If it leaves the seal open.
        ConvergenceError
        """
        point = self.problem.loads.earlier
        if point is None:
            return None
        try:
            return self._solve_without_memory(*point, None, first=True)
        except ConvergenceError as error:
            raise ConvergenceError(problem("earlier_load", why=error.args[0])) from error

    def open_on_path(self, point: tuple[float, float], open_load: OpenLoad) -> InputError:
        """What is said of a load that opens the seal on the path of bodies that yield."""
        return self._open_seal(replace(self.seal, model=open_load.model), *point, open_load.error)

    def _open_seal(
        self, seal: CoupledContact, fluid_pressure: float, applied_force: float, error: OpenSealError
    ) -> InputError:
        """What is said of a load that opens a seal."""
        least = least_applied_force(seal, fluid_pressure)
        says = problem("opened", pressure=fluid_pressure, why=error.args[0], least=least)
        force = Quantity(applied_force, ".6g N")
        return InputError.at("load.applied_force", says, force, file=self.problem.file)

    def on_path(self, fluid_pressure: float, applied_force: float, bolts: Bolts | None = None) -> PathLoad:
        """A load of the problem as one on the path of bodies that yield, by its way of closing.

        With bolts the applied force is their preload.
        """
        at_rest = self.problem.at_rest.body_loads(self.model)
        end_force = self.fluid_force(fluid_pressure) if self.problem.on_sealed_area else 0.0
        tightened_bolts = None if bolts is None else TightenedBolts(bolts, applied_force, end_force)
        if self.problem.on_sealed_area:
            return PathLoad(applied_force + end_force, at_rest, bolts=tightened_bolts)
        return PathLoad(
            applied_force, at_rest, path=self._path, fluid_pressure=fluid_pressure, bolts=tightened_bolts
        )

    def point_of(self, fluid_pressure: float, contact: ContactSolution) -> tuple[float, float]:
        """A fluid pressure [Pa], and the applied force of a contact under it [N]."""
        return fluid_pressure, self.problem.applied_force(contact, fluid_pressure)

    def at_contact_force(
        self,
        fluid_pressure: float,
        contact_force: float,
        start: ContactSolution | None = None,
        progress: Progress | None = None,
    ) -> tuple[ContactSolution, float]:
        """Contact that carries a force F_N [N] at a fluid pressure [Pa], and the applied force that this takes [N].

        Bodies that yield begin as new ones, or after the largest load before those of the problem, and go to this load
        alone; what the first loading of several forces has in common is walked once, see `FirstLoading`. With the fluid
        between the surfaces F_N is then what is left of the applied force by the circle of first touch, near to what
        they carry. `progress` is told now and then how far their path is.

        With bolts F_N is what the fluid would leave of their preload if they were infinitely soft: the contact is the
        one under the force that they have, after it has carried the preload.

        Raises
        ------
        InputError
            If bodies that yield are open there.
        ConvergenceError
        """
        preload = contact_force - self.fluid_force(fluid_pressure)
        if self.problem.loads.unsolved_bolts is not None and preload > 0.0:
            return self._solve_tightened(fluid_pressure, preload, progress)
        if self.yields:
            return _end_of_path(
                self, [(fluid_pressure, preload)], progress=progress, first=self.first_loading
            ), preload
        if self.problem.on_sealed_area:
            return self._solve_sealed_area(contact_force, start).after(self.earlier), preload
        contact = solve_at_contact_force(
            self.seal, contact_force=contact_force, fluid_pressure=fluid_pressure, start=start
        ).after(self.earlier)
        return contact, contact.applied_force

    def load_at_contact_force(
        self,
        fluid_pressure: float,
        contact_force: float,
        start: LoadResult | None = None,
        progress: Progress | None = None,
    ) -> LoadResult:
        """The load of `at_contact_force`, with its leak rate.

        Raises
        ------
        OpenSealError
            If nothing is left for the contact.
        InputError, ConvergenceError
        """
        if not contact_force > 0.0:
            raise OpenSealError("nothing is left for the solid contact")
        contact, circumference = (None, None) if start is None else (start.contact, start.circumference)
        contact, force = self.at_contact_force(fluid_pressure, contact_force, contact, progress)
        circumference = self.problem.circumference(contact, fluid_pressure, circumference)
        return load_results(self.problem, [(fluid_pressure, force)], [contact], [circumference])[0]

    def after_force(self, load: LoadResult, force: float) -> LoadResult:
        """A load of elastic bodies after one without fluid that has pressed them harder.

        Parameters
        ----------
        load : LoadResult
        force : float
            F_N of the earlier load [N].

        Raises
        ------
        ConvergenceError
        """
        contact = load.contact.after(self.solve(0.0, force))
        circumference = self.problem.circumference(contact, load.fluid_pressure, load.circumference)
        return replace(load, contact=contact, circumference=circumference)

    def _solve_tightened(
        self, fluid_pressure: float, preload: float, progress: Progress | None
    ) -> tuple[ContactSolution, float]:
        """Contact at a fluid pressure [Pa] after a preload of all bolts [N], and their force [N]."""
        loads = self.problem.loads
        point = fluid_pressure, preload
        one_load = loads.after_tightening(*point)
        solver = replace(self, problem=replace(self.problem, loads=one_load))
        if not self.yields:
            bolts = loads.unsolved_bolts
            assert bolts is not None  # of all who ask
            (_, force), contact = solver.solve_bolts(0, bolts)
            return contact, force
        end = _end_of_path(solver, [point], progress=progress, first=self.first_loading)
        return end, self.point_of(fluid_pressure, end)[1]

    @cached_property
    def first_loading(self) -> FirstLoading:
        """Of bodies that yield, under one force each."""
        return FirstLoading(self.model, self.problem.law, self.problem.at_rest.body_loads(self.model))

    def highest_force(self, fluid_pressure: float) -> float | None:
        """Largest force F_N of `at_contact_force` to which first loading came [N]; None if it is not asked there."""
        highest, bolts = self.first_loading.highest_force, self.problem.loads.unsolved_bolts
        return highest if highest is None or bolts is None else highest + self.fluid_force(fluid_pressure)

    def blow_off_pressure(self, applied_force: float, contact: ContactSolution | None = None) -> float:
        """Fluid pressure at which the fluid lifts the closure off [Pa], infinite if it does not.

        Parameters
        ----------
        applied_force : float
            Of spring or actuator [N].
        contact : ContactSolution, optional
            From which the pressure rises, the force staying as it is: bodies that yield keep what they have gone
            through. Without it they are as new.
        """
        if not self.problem.on_sealed_area:
            return blow_off_pressure(self._seal_after(contact), applied_force=applied_force)
        return blow_off_of_sealed_area(
            self.problem.initial_contact_radius, applied_force, self.problem.loads.pressure_side
        )

    def opening_force(self, fluid_pressure: float, contact: ContactSolution | None = None) -> float | None:
        """Force of spring or actuator [N] below which the seal is open at a fluid pressure [Pa]; None if not found.

        `contact` as in `blow_off_pressure`.
        """
        if not self.problem.on_sealed_area:
            return least_applied_force(self._seal_after(contact), fluid_pressure)
        return -self.fluid_force(fluid_pressure)

    def _seal_after(self, contact: ContactSolution | None) -> CoupledContact:
        """The seal with bodies that have gone through the loads up to a contact."""
        if not isinstance(contact, ElastoplasticContact):
            return self.seal
        largest = contact.pressure
        if contact.largest is not None:
            largest = np.maximum(largest, contact.largest)
        return replace(self.seal, model=contact.unloading_model, path=self._path.after_load(largest))

    @property
    def yields(self) -> bool:
        """Whether a body of the seal yields, so that its loads are no questions of their own but a path."""
        return self.problem.follows_path or self.model.yields

    @property
    def asperities_remember(self) -> bool:
        """Whether asperities yield and are known to stay tighter where they were pressed harder before."""
        surface = self.problem.surface
        return surface is not None and surface.hardness is not None

    @cached_property
    def flow(self) -> SealFlow | None:
        """Flow through the contacts; None without roughness or fluid."""
        return SealFlow.of(self.problem)

    @cached_property
    def seal(self) -> CoupledContact:
        """What stays the same at every load."""
        earlier = None if self.yields else self.earlier
        if earlier is None:
            return self._first_seal
        return replace(self._first_seal, path=self._path.after_load(earlier.pressure))

    @property
    def _first_seal(self) -> CoupledContact:
        """The same before any load."""
        at_rest = self.problem.at_rest.body_loads(self.model)
        return CoupledContact(self.model, self.problem.law, self._path, at_rest, self.settings)

    @cached_property
    def _path(self) -> FluidPath:
        side, flow = self.problem.loads.pressure_side, self.flow
        equivalent = flow.equivalent if flow is not None and self.asperities_remember else None
        if self.problem.loads.closing == "sealed-area":
            area = math.pi * self.problem.initial_contact_radius**2
            return FluidInChambers(self._pressure_drops, area, side, equivalent)
        if flow is None:
            return FluidAtContact(side)
        return PenetratingFluid(
            lambda profile, pressure: flow.leak(profile, pressure).fluid_pressure,
            flow.surface.sealing_pressure,
            side,
            highest=math.inf if any(flow.flow.chambers) else 1.0,
            equivalent=equivalent,
            at_rest=lambda profile: profile.at_rest(flow.surface),
        )

    def _pressure_drops(self, profile: PressureProfile, fluid_pressure: float) -> list[float]:
        """Pressure on the inner side of each land less that on its outer side [Pa]; without a flow it falls evenly."""
        from_inside = self.problem.loads.pressure_side == "inner"
        inner, outer = (fluid_pressure, 0.0) if from_inside else (0.0, fluid_pressure)
        if self.flow is not None:
            lands = self.flow.leak(profile, fluid_pressure).lands
        else:
            from leak import LeakResult
            from leak.flow.series import SeriesContact, in_series

            closed_lands = [
                SeriesContact(
                    (lambda a, b: LeakResult(0.0, math.inf, np.zeros(1))) if land.touches else None, 1
                )
                for land in profile.lands
            ]
            lands = in_series(closed_lands, inner, outer, [None] * (len(closed_lands) - 1)).lands
        return [start - end for start, end, _ in lands] or [inner - outer]

    def _solve_sealed_area(self, force: float, start: ContactSolution | None) -> ContactSolution:
        at_rest = self.problem.at_rest.body_loads(self.model)
        return solve(self.model, self.problem.law, contact_force=force, loads=at_rest, start=start)

    def fluid_force(self, fluid_pressure: float) -> float:
        """Force with which a fluid pressure [Pa] on the circle of first touch closes the seal [N]."""
        return contact_force(
            self.problem.initial_contact_radius, fluid_pressure, 0.0, self.problem.loads.pressure_side
        )


# What keeps one load from being solved: it opens the seal, does not converge, or its numbers leave their range.
_NO_SOLUTION = (SealError, ValueError, RuntimeError, ArithmeticError)


@dataclass(frozen=True)
class SolvedLoads:
    """Contacts of all loads under which the seal is closed, and what is left after the last.

    Parameters
    ----------
    contacts : sequence of ContactSolution
        In the order of the case.
    unloaded_bodies : UnloadedBodies or None
        None where no body yields: elastic bodies come back.
    failures : mapping
        Number of each load without a contact, with the error that says why.
    not_unloaded : ConvergenceError or None
        Why it is not known what is left after the last load, though a body yields.
    circumferences : sequence of Circumference
        Each contact around the axis; empty for a round seal.
    points : mapping
        Fluid pressure [Pa] and force [N] of loads by their numbers, where bolts give the force.
    was_left : bool
        Whether a path of bodies that yield was left before its end.
    """

    contacts: Sequence[ContactSolution]
    unloaded_bodies: UnloadedBodies | None = None
    failures: Mapping[int, Exception] = field(default_factory=dict)
    not_unloaded: ConvergenceError | None = None
    circumferences: Sequence[Circumference] = ()
    points: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    was_left: bool = False

    def results(
        self,
        problem: SealProblem,
        points: Iterable[tuple[float, float]],
        table: Callable[[FlowModel, FaceContact, Sequence[float]], Conductivity] | None = None,
    ) -> tuple[LoadResult, ...]:
        """What leaks through the contacts, see `load_results`.

        Parameters
        ----------
        problem, points, table
            See there.
        """
        circumferences: Sequence[Circumference | None] = self.circumferences or [None] * len(self.contacts)
        return load_results(problem, points, self.contacts, circumferences, table)

    @property
    def all_contacts(self) -> list[ContactSolution]:
        """Contacts that the mesh has to fit: of all loads, all around the axis, and of the largest before them."""
        extremes = [contact for circumference in self.circumferences for contact in circumference.extremes]
        return [*self.contacts, *extremes, *largest_before(self.contacts)]

    @property
    def problems(self) -> dict[int, Problem]:
        """Number of each load without a contact, with the reason."""
        return {number: _load_problem(error) for number, error in self.failures.items()}


def solve_loads(
    solver: LoadSolver,
    progress: Progress | None = None,
    pressed_contacts: Mapping[int, ContactSolution | Exception] | None = None,
    contacts_only: bool = False,
    leave: Leave | None = None,
) -> SolvedLoads:
    """Solve all loads of a problem on a model; those that cannot be solved do not keep the others from it.

    Parameters
    ----------
    solver : LoadSolver
    progress : callable, optional
        Told now and then how far the path of bodies that yield is.
    pressed_contacts : mapping, optional
        By number of the load what is known already of `LoadSolver.pressings`.
    contacts_only : bool
        Whether nothing is asked of what is left of bodies that yield after the last load.
    leave : callable, optional
        Whether to leave the path of bodies that yield, see `fem_seal.contact.load_path.load_path`.
    """
    points = solver.problem.loads.points
    if solver.yields:
        return _solved_path(solver, progress, unload=not contacts_only, leave=leave)
    failures: dict[int, Exception] = {}
    problem = solver.problem
    # the number of waves that hurts most is one for all loads, that of the highest fluid pressure; a load that comes
    # again finds elastic bodies as they were
    solutions: dict[int, tuple[ContactSolution, Circumference | None]] = {}
    bolts, bolt_loads = problem.loads.unsolved_bolts, dict[int, tuple[float, float]]()
    for point in sorted(set(points), reverse=True):
        numbers = [number for number, other in enumerate(points) if other == point]
        try:
            if bolts is None:
                contact = solver.solve_pressed(numbers[0], (pressed_contacts or {}).get(numbers[0]))
            else:
                bolt_point, contact = solver.solve_bolts(numbers[0], bolts)
                bolt_loads.update(dict.fromkeys(numbers, bolt_point))
            circumference = problem.circumference(contact, point[0])
        except _NO_SOLUTION as error:
            failures.update(dict.fromkeys(numbers, error))
            continue
        if circumference is not None:
            problem = replace(problem, form=circumference.form)
        solutions.update(dict.fromkeys(numbers, (contact, circumference)))
    contacts = [solutions[number][0] for number in sorted(solutions)]
    strain_together(contacts)
    circumferences = [x for number in sorted(solutions) if (x := solutions[number][1]) is not None]
    failures = dict(sorted(failures.items()))
    return SolvedLoads(contacts, failures=failures, circumferences=circumferences, points=bolt_loads)


def _solved_path(
    solver: LoadSolver, progress: Progress | None, *, unload: bool, leave: Leave | None
) -> SolvedLoads:
    """Loads up to the first that cannot be solved: what it would leave behind is not known to those after it."""
    points = solver.problem.loads.points
    path = _walk_path(solver, points, unload=unload, progress=progress, leave=leave)
    failures: dict[int, Exception] = {
        number: solver.open_on_path(points[number], opened) for number, opened in path.open_loads.items()
    }
    closed_loads = [number for number in range(len(points)) if number not in failures]
    unsolved_loads = closed_loads[len(path.contacts) :]
    if path.failure is not None and unsolved_loads:
        failures.update(_failures_after(unsolved_loads, points, path.failure))
    not_unloaded = None if unsolved_loads or path.unloaded_bodies is not None else path.failure
    bolt_loads = {}
    if solver.problem.loads.unsolved_bolts is not None:
        pairs = zip(closed_loads, path.contacts, strict=False)
        bolt_loads = {number: solver.point_of(points[number][0], contact) for number, contact in pairs}
    failures = dict(sorted(failures.items()))
    rest = path.unloaded_bodies
    return SolvedLoads(path.contacts, rest, failures, not_unloaded, points=bolt_loads, was_left=path.was_left)


def _failures_after(
    numbers: Sequence[int], points: Sequence[tuple[float, float]], error: Exception
) -> dict[int, Exception]:
    """Why loads from the one at which a path ended have no contact."""
    first, *others = numbers
    pressure, force = points[first]
    load_name = problem("load_with_force", pressure=pressure, force=force)
    refusal = problem("after_a_load", load=load_name)
    return {first: error} | {number: InputError(refusal) for number in others}


def _load_problem(error: Exception) -> Problem:
    if isinstance(error, InputError):
        return replace(error.problems[0], kind=error.problems[0].kind or "open")
    if isinstance(error, LimitLoadError):
        return Problem("load", error.args[0], kind="limit", body=error.body)
    # not the error: it holds what was reached, and a problem is stored
    why = error.args[0] if isinstance(error, SealError) else error_text(error)
    return Problem("load", why, kind="solution")


def solve_load(
    solver: LoadSolver, number: int, *, steps: int | None = None, start: ContactSolution | None = None
) -> ContactSolution:
    """One load of a problem; the bodies that yield go through those before it.

    Parameters
    ----------
    solver : LoadSolver
    number : int
        Which of the loads.
    steps : int, optional
        Load steps from zero to a load with bodies that yield; those of `PlasticSettings` unless given.
    start : ContactSolution, optional
        To start from, if no body yields.

    Raises
    ------
    InputError
        If the load leaves the seal open.
    ConvergenceError
    """
    if not solver.yields:
        return solver.solve(*solver.problem.loads.points[number], start=start)
    return _end_of_path(solver, solver.problem.loads.points[: number + 1], steps)


def _end_of_path(
    solver: LoadSolver,
    points: Sequence[tuple[float, float]],
    steps: int | None = None,
    progress: Progress | None = None,
    first: FirstLoading | None = None,
) -> ElastoplasticContact:
    path = _walk_path(solver, points, steps, unload=False, progress=progress, first=first)
    last = len(points) - 1
    if last in path.open_loads:
        raise solver.open_on_path(points[last], path.open_loads[last])
    if path.failure is not None:
        raise path.failure
    return path.contacts[-1]


def _walk_path(
    solver: LoadSolver,
    points: Sequence[tuple[float, float]],
    steps: int | None = None,
    *,
    unload: bool = True,
    progress: Progress | None = None,
    first: FirstLoading | None = None,
    leave: Leave | None = None,
) -> LoadPath:
    """Fluid pressures [Pa] and applied forces [N] one after the other; the largest load before them is the first.

    Contacts know it: of several times that bolts were tightened the largest. Where asperities yield each contact
    remembers all those before it. `first` and `leave` as in `load_path`.
    """
    problem, settings = solver.problem, PlasticSettings()
    way = list(problem.loads.path(points))
    places = [place for place, (number, _) in enumerate(way) if number is None]
    loads = [
        solver.on_path(*point, bolts=None if number is None else problem.loads.unsolved_bolts)
        for number, point in way
    ]
    if steps is not None:
        settings = replace(settings, steps=steps)
    tell = (
        None
        if progress is None
        else _progress_teller(progress, way, problem.loads.preparation, len(points), unload=unload)
    )
    try:
        path = load_path(
            solver.model,
            problem.law,
            loads,
            at_rest=problem.at_rest.body_loads(solver.model),
            settings=settings,
            partial=True,
            unload=unload,
            progress=tell,
            first_loading=first,
            elastic=True,
            leave=leave,
        )
    except ConvergenceError as error:
        if not isinstance(error.partial, LoadPath):
            raise
        path = error.partial
    surface = problem.surface
    if surface is not None and surface.hardness is not None:
        sunk = (contact.over_strained_metal(surface, problem.law) for contact in path.contacts)
        path = replace(path, contacts=tuple(sunk))
        # each with the largest pressures before it
        path = replace(
            path, contacts=tuple(accumulate(path.contacts, lambda last, contact: contact.after(last)))
        )
    if not places:
        return path
    if 0 in path.open_loads:
        raise solver.open_on_path(way[0][1], path.open_loads[0])
    if not path.contacts:
        return replace(path, failure=ConvergenceError(f"{problem.loads.preparation}: {path.failure}"))
    closed_loads = [number for place, (number, _) in enumerate(way) if place not in path.open_loads]
    pairs = list(zip(closed_loads, path.contacts, strict=False))
    if not solver.asperities_remember:
        largest = pairs[0][1]
        for place, (number, contact) in enumerate(pairs):
            if number is None and contact.contact_force > largest.contact_force:
                largest = contact
            pairs[place] = number, replace(contact, earlier=largest)
    contacts = tuple(contact for number, contact in pairs if number is not None)
    open_loads = {n: load for place, load in path.open_loads.items() if (n := way[place][0]) is not None}
    return replace(path, contacts=contacts, open_loads=open_loads)


# So often it is said how far a path is [s].
_TOLD_EVERY = 5.0


def _progress_teller(
    progress: Progress,
    way: Sequence[tuple[int | None, tuple[float, float]]],
    first_part: str,
    count: int,
    *,
    unload: bool,
) -> Callable[[PlaceOnPath], None]:
    """Tells how far a path of `count` loads is, with those before them, and how much time is left at this pace."""
    start = last = time.monotonic()

    def tell(place: PlaceOnPath) -> None:
        nonlocal last
        if time.monotonic() - last < _TOLD_EVERY:
            return
        last = time.monotonic()
        share = (place.number + place.way) / (len(way) + unload)
        remaining = f"; {about((last - start) * (1 / share - 1))} left on this mesh" if share > 0 else ""
        number = way[place.number][0] if place.number < len(way) else count
        part = first_part if number is None else f"load {number + 1} of {count}"
        part = "unloading" if number == count else part
        progress(
            f"{part}: {100 * place.way:.3g} % of the way after {place.steps} load steps, now in steps of "
            f"{100 * place.step:.2g} %{remaining}"
        )

    return tell


def solve_path(solver: LoadSolver) -> list[ContactSolution]:
    """All loads of a problem on the path of bodies that yield, without what is left after the last.

    Parameters
    ----------
    solver : LoadSolver

    Raises
    ------
    ConvergenceError
        If a load opens the seal or does not converge.
    """
    points = solver.problem.loads.points
    path = _walk_path(solver, points, unload=False)
    if len(path.contacts) < len(points):
        messages = [str(load.error) for load in path.open_loads.values()]
        raise ConvergenceError(messages[0] if messages else str(path.failure))
    return list(path.contacts)


# What the solution of a contact says of it.
_SOLVED_FOR = ("contact_force", "stop_force", "approach", "log_pressure", "gap", "iterations", "residuals")


def solve_linearised(contacts: Sequence[ContactSolution], law: Law) -> list[ContactSolution]:
    """The same loads of bodies that yield with another law, the bodies linearised where they are.

    What they would have yielded otherwise on the way to the last load step of each load is left out.

    Parameters
    ----------
    contacts : sequence of ElastoplasticContact
        All or some of a path. Those that they remember are solved again, too.
    law : InterfaceLaw or HardContact

    Raises
    ------
    ConvergenceError
    """
    solutions: dict[int, ContactSolution] = {}
    for contact in contacts:
        history = () if contact.largest is None else contact.history
        for member in reversed([member for member in (contact, *history) if id(member) not in solutions]):
            assert isinstance(member, ElastoplasticContact) and member.linear is not None
            force = member.pressing_force
            solution = solve(member.linear, law, contact_force=force, loads=member.loads, start=member)
            # a contact of the true bodies, in the states that they are in
            contact_again = replace(member, **{name: getattr(solution, name) for name in _SOLVED_FOR})
            solutions[id(member)] = contact_again.after(solutions.get(id(member.earlier)))
    return [solutions[id(contact)] for contact in contacts]


def solve_again(contacts: Sequence[ContactSolution], model: ContactModel, law: Law) -> list[ContactSolution]:
    """The same loads on other bodies or with another law; what the fluid does between the surfaces stays as it is.

    Parameters
    ----------
    contacts : sequence of ContactSolution
        Of bodies that do not yield. Those that they remember are solved again, too.
    model : ContactModel
    law : InterfaceLaw or HardContact

    Raises
    ------
    ConvergenceError
    """
    earlier_contacts = {id(earlier): earlier for contact in contacts for earlier in contact.history}
    outcomes = solve_many(
        [
            ContactProblem(model, law, load.pressing_force, load.loads, DEFAULT_SETTINGS, start=load)
            for load in (*earlier_contacts.values(), *contacts)
        ]
    )
    for outcome in outcomes:
        if isinstance(outcome, ConvergenceError):
            raise outcome
    solutions = [outcome for outcome in outcomes if not isinstance(outcome, ConvergenceError)]
    earlier = dict(zip(earlier_contacts, solutions, strict=False))
    new = zip(contacts, solutions[len(earlier_contacts) :], strict=True)
    return [contact.after(earlier.get(id(old.earlier))) for old, contact in new]


Progress = Callable[[str], None]


@dataclass(frozen=True)
class Clock:
    """Says what is being done and keeps how long it took.

    Parameters
    ----------
    progress : callable
        Called with a status message before each step.
    timings : dict
        Wall time [s] by name of the step.
    """

    progress: Progress
    timings: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def step(self, name: str, text: str) -> Iterator[None]:
        """Time what happens inside, told in words unless these are empty; a step that comes again adds to its time."""
        if text:
            self.progress(text)
        start = time.perf_counter()
        try:
            yield
        finally:
            self.timings[name] = self.timings.get(name, 0.0) + time.perf_counter() - start
