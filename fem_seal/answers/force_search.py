"""One search for a force: where something that falls with it is zero, on a mesh that fits the contact there.

It serves the force for a target leak rate, that with which the verdict passes, and that which closes a seal
everywhere; they differ in what is judged of a load. Places are logarithms of the force F_N on the solid contact [ln N].
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import cache

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.two_flanges import load_of_parts
from fem_seal.contact.sizing import MeshFit, fit_meshes
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError, SealError
from fem_seal.loads import contact_force
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import LoadSolver, Progress
from fem_seal.seal.problem import SealProblem, largest_force, size_mesh
from leak.numerics.roots import root_between
from meshes import MeshingError

# Steps on the way to a zero are each twice as long as the one before, up to this length.
_LONGEST = 0.8
# Accuracy of the last place at which something is known.
_EDGE = 2e-3
# What is not known below a place that is known counts as this far above zero.
_ABOVE_ZERO = 20.0
# Steps to either side in which a place is looked for at which something is known.
_MOST_STEPS = 7
# Smallest over the largest sensible force.
_FORCE_RATIO = 1e-9
# Forces for which the mesh is sized, over the one that is expected.
_MARGIN = (0.7, 1.4)

FallingFunction = Callable[[float], float | None]


class End(Enum):
    """Where the way to a zero ends without one."""

    LOWEST = auto()
    HIGHEST = auto()
    UNKNOWN = auto()


@dataclass(frozen=True)
class Zero:
    """Where a falling function is zero.

    Parameters
    ----------
    place : float
        Without a zero the last place on the way to one.
    end : End or None
        Why the way ends there; None at a zero.
    """

    place: float
    end: End | None = None


def find_zero(
    function: FallingFunction,
    start: float,
    *,
    lowest: float = -math.inf,
    highest: float = math.inf,
    step: float = 0.1,
    accuracy: float,
) -> Zero | None:
    """Zero of a falling function, looked for outwards from an expected place; None if the function is known nowhere.

    Parameters
    ----------
    function : callable
        None where it is not known; below places where it is known it is then taken to be above zero.
    start : float
    lowest, highest : float
        Ends of the way.
    step : float
        The first one.
    accuracy : float
        Of the place.

    Examples
    --------
    >>> round(find_zero(lambda x: 8.0 - x**3, 1.0, accuracy=1e-9).place, 6)
    2.0
    >>> find_zero(lambda x: 8.0 - x**3, 1.0, highest=1.5, accuracy=1e-9)
    Zero(place=1.5, end=<End.HIGHEST: 2>)
    """
    function = cache(function)

    def value_at(place: float) -> float:
        value = function(place)
        return _ABOVE_ZERO if value is None else value

    places = _outwards(start, lowest, highest, step)
    at = next((place for place in places if function(place) is not None), None)
    if at is None:
        return None
    height = value_at(at)
    limit, end = (highest, End.HIGHEST) if height > 0.0 else (lowest, End.LOWEST)
    step, longest = math.copysign(step, height), max(step, _LONGEST)
    while height and at != limit:
        next_place = min(max(at + step, lowest), highest)
        if height > 0.0 and function(next_place) is None:
            limit, end = _last_known(function, at, next_place), End.UNKNOWN
            next_place = limit
        next_height = value_at(next_place)
        if next_height * height <= 0.0:
            place = root_between(value_at, at, next_place, xtol=accuracy)
            # at the edge of what is known its last place is the answer
            return Zero(place if function(place) is not None else place + 2.0 * accuracy)
        at, height, step = next_place, next_height, math.copysign(min(2.0 * abs(step), longest), step)
    return Zero(at, end if height else None)


def _outwards(start: float, lowest: float, highest: float, step: float) -> Iterator[float]:
    """Downwards first: what is expected to be enough may be more than the bodies bear."""
    start = min(max(start, lowest), highest)
    yield start
    ways = [step * (2**n - 1) for n in range(1, _MOST_STEPS + 1)]
    yield from (start - way for way in ways if start - way >= lowest)
    yield from (start + way for way in ways if start + way <= highest)


def _last_known(function: FallingFunction, low: float, high: float) -> float:
    while high - low > _EDGE:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if function(middle) is None else (middle, high)
    return low


def sensible_forces(problems: Iterable[SealProblem]) -> tuple[float, float]:
    """Logarithms of the smallest and the largest force that a search tries, see `largest_force` [ln N].

    Parameters
    ----------
    problems : iterable of SealProblem
        Of one seal.
    """
    highest = math.log(min(map(largest_force, problems)))
    return highest + math.log(_FORCE_RATIO), highest


@dataclass(frozen=True)
class Trials:
    """Loads of a seal at one fluid pressure, under any force on the same bodies.

    Parameters
    ----------
    solvers : sequence of LoadSolver
        Of each problem of the seal.
    fluid_pressure : float
        [Pa]
    progress : callable, optional
        See `LoadSolver.at_contact_force`.
    """

    solvers: Sequence[LoadSolver]
    fluid_pressure: float
    progress: Progress | None = None
    outcomes: dict[float, tuple[CaseLoad, ...] | SealError] = field(default_factory=dict)
    """Those that were tried, by place and solver, or why they have no contact."""

    def load(self, place: float) -> CaseLoad:
        """The load whose contact, of several parts that of the first, carries a force [ln N].

        Raises
        ------
        InputError, OpenSealError
            If the fluid opens the seal.
        ConvergenceError
        """
        return load_of_parts(self.of_each(place))

    def of_each(self, place: float) -> tuple[CaseLoad, ...]:
        """The same load with each solver; see `load`."""
        if place not in self.outcomes:
            try:
                self.outcomes[place] = self._solved(math.exp(place))
            except SealError as error:
                self.outcomes[place] = error
        outcome = self.outcomes[place]
        if isinstance(outcome, SealError):
            raise outcome
        return outcome

    @property
    def path_error(self) -> ConvergenceError | None:
        """Why load steps of bodies that yield did not reach some force; None if they reached each that was tried."""
        if not any(solver.yields for solver in self.solvers):
            return None
        return next((x for x in self.outcomes.values() if isinstance(x, ConvergenceError)), None)

    def _solved(self, force: float) -> tuple[CaseLoad, ...]:
        pressure, error = self.fluid_pressure, self.path_error
        if error is not None:
            reaches = [solver.highest_force(pressure) for solver in self.solvers]
            if force > min((reach for reach in reaches if reach is not None), default=math.inf):
                raise error
        empty = (None,) * len(self.solvers)
        starts = next((x for x in reversed(self.outcomes.values()) if isinstance(x, tuple)), empty)
        spring = force - self.solvers[0].fluid_force(pressure)
        return tuple(
            CaseLoad.of(
                solver.load_at_contact_force(
                    pressure, spring + solver.fluid_force(pressure), start, self.progress
                )
            )
            for solver, start in zip(self.solvers, starts, strict=True)
        )


def search_forces(
    problems: Sequence[SealProblem],
    starts: Mapping[float, float],
    find: Callable[[Trials, float], Zero | None],
    progress: Progress | None = None,
) -> dict[float, tuple[Trials, Zero | None]]:
    """Trials at each fluid pressure and where their search ends, on a mesh that fits the contacts there.

    Parameters
    ----------
    problems : sequence of SealProblem
        Of one seal.
    starts : mapping
        Expected force F_N by fluid pressure [N], [Pa].
    find : callable
        Searches among trials from an expected place on; see `find_zero`.
    progress : callable, optional
        See `Trials`.

    Raises
    ------
    ConvergenceError, MeshingError
        See `fem_seal.contact.sizing.MeshFit.with_outcome`.
    """
    loads, forces = problems[0].loads, [*starts.values()]
    if loads.unsolved_bolts is not None:
        # before the fluid acts they are as large as the preload
        r0, side = problems[0].initial_contact_radius, loads.pressure_side
        forces += [force - contact_force(r0, at, 0.0, side) for at, force in starts.items()]
    sized_for = [share * force for force in forces if force > 0 for share in _MARGIN]
    begin = {pressure: math.log(force) for pressure, force in starts.items()}
    solvers: dict[int, LoadSolver] = {}
    outcomes: dict[float, tuple[Trials, Zero | None]] = {}

    def solve_on(fits: Mapping[int, MeshFit]) -> dict[int, MeshFit]:
        outcome: Sequence[Sequence[ContactSolution] | Exception]
        try:
            fresh = {n: LoadSolver.on_mesh(problems[n], fit.sizing) for n, fit in fits.items() if fit.sizing}
            solvers.update(fresh)
            outcome = search_all()
        except (MeshingError, ConvergenceError) as error:
            outcome = [error] * len(problems)
        return {n: fit.with_outcome(outcome[n]) for n, fit in fits.items()}

    def search_all() -> list[list[ContactSolution]]:
        all_solvers, ends = [solvers[n] for n in range(len(problems))], list[tuple[CaseLoad, ...]]()
        for pressure, place in begin.items():
            trials = Trials(all_solvers, pressure, progress)
            zero = find(trials, place)
            outcomes[pressure] = trials, zero
            if zero is None:
                continue
            ends.append(trials.of_each(zero.place))
            # on a better mesh it is looked for where it was
            begin[pressure] = zero.place
        return [_contacts(loads) for loads in zip(*ends, strict=True)] if ends else [[]] * len(all_solvers)

    fit_meshes(
        {
            n: MeshFit.begin(
                size_mesh(problem, sized_for), problem.contact, size_given=problem.contact_size is not None
            )
            for n, problem in enumerate(problems)
        },
        solve_on,
    )
    return outcomes


def _contacts(loads: Sequence[LoadResult]) -> list[ContactSolution]:
    """Contacts that the mesh has to fit: of loads, of tightening their bolts, and of the largest load before."""
    contacts = [contact for load in loads for contact in load.contacts]
    return contacts + [earlier for contact in contacts for earlier in contact.history]
