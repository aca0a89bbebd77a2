"""All loads of a case on one model: each on its own or, if a body yields, one after the other along their path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from fem_seal.afterwards import told
from fem_seal.contact_solution import ContactSolution
from fem_seal.elastoplastic_contact import PlasticSettings
from fem_seal.elastoplastic_path import LoadPath, PathLoad, Unloaded, load_path
from fem_seal.errors import ConvergenceError, InputError, LoadProblem, SealError
from fem_seal.further_loads import FurtherLoads
from fem_seal.load_solver import LoadSolver, interference
from fem_seal.loads import closing_force

# What keeps one load from being solved: it opens the seal, does not converge, or its numbers leave their range.
_NO_SOLUTION = (SealError, ValueError, RuntimeError, ArithmeticError)


@dataclass(frozen=True)
class SolvedLoads:
    """Contacts of all loads under which the seal is closed, and what is left after the last.

    Parameters
    ----------
    contacts : sequence of ContactSolution
        In the order of the case.
    unloaded : Unloaded or None
        None where no body yields: elastic bodies come back.
    failures : mapping
        Number of each load without a contact, with the error that says why.
    not_unloaded : ConvergenceError or None
        Why it is not known what is left after the last load, though a body yields.
    """

    contacts: Sequence[ContactSolution]
    unloaded: Unloaded | None = None
    failures: Mapping[int, Exception] = field(default_factory=dict)
    not_unloaded: ConvergenceError | None = None

    @property
    def problems(self) -> dict[int, LoadProblem]:
        """Number of each load without a contact, with the reason."""
        return {number: _problem(error) for number, error in self.failures.items()}


def solve_loads(solver: LoadSolver) -> SolvedLoads:
    """Solve all loads of a case on a model; those that cannot be solved do not keep the others from it.

    Parameters
    ----------
    solver : LoadSolver
    """
    points = solver.case.load.points
    if solver.yields:
        return _solved_path(solver)
    contacts: list[ContactSolution] = []
    failures: dict[int, Exception] = {}
    for number, point in enumerate(points):
        try:
            contacts.append(solver.solve(*point))
        except _NO_SOLUTION as error:
            failures[number] = error
    return SolvedLoads(contacts, failures=failures)


def _solved_path(solver: LoadSolver) -> SolvedLoads:
    """Loads up to the first that cannot be solved: what it would leave behind is not known to those after it."""
    numbers = range(len(solver.case.load.points))
    try:
        path = _path(solver, len(numbers))
    except ConvergenceError as error:
        contacts: tuple[ContactSolution, ...] = error.partial if isinstance(error.partial, tuple) else ()
        failures = {number: error for number in numbers[len(contacts) :]}
        return SolvedLoads(contacts, None, failures, None if failures else error)
    unsolved = {} if path.stopped is None else dict.fromkeys(numbers[len(path.contacts) :], path.stopped)
    return SolvedLoads(path.contacts, path.unloaded, unsolved)


def _problem(error: Exception) -> LoadProblem:
    if isinstance(error, InputError):
        first = error.problems[0]
        return LoadProblem(first.key, first.message, first.value)
    return LoadProblem("load", told(error), kind="solution")


def solve_load(
    solver: LoadSolver, number: int, *, steps: int | None = None, start: ContactSolution | None = None
) -> ContactSolution:
    """One load of a case; the bodies that yield go through those before it.

    Parameters
    ----------
    solver : LoadSolver
    number : int
        Which of the case's loads.
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
    if solver.yields:
        path = _path(solver, number + 1, steps)
        if path.stopped is not None:
            raise path.stopped
        return path.contacts[-1]
    return solver.solve(*solver.case.load.points[number], start=start)


def _path(solver: LoadSolver, count: int, steps: int | None = None) -> LoadPath:
    """The first `count` loads of the case, and the unloading."""
    case, settings = solver.case, PlasticSettings()
    fit = FurtherLoads.press_fit(interference(case))
    loads = [
        PathLoad(closing_force(case.touch_radius, pressure, force, case.load.pressure_side), fit)
        for pressure, force in case.load.points[:count]
    ]
    if steps is not None:
        settings = replace(settings, steps=steps)
    return load_path(solver.model, solver.law, loads, at_rest=fit, settings=settings, partial=True)
