"""All loads of a case on one model: each on its own or, if a body yields, one after the other along their path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from fem_seal.contact_solution import ContactSolution
from fem_seal.elastoplastic_contact import PlasticSettings
from fem_seal.elastoplastic_path import LoadPath, PathLoad, Unloaded, load_path
from fem_seal.errors import InputError
from fem_seal.further_loads import FurtherLoads
from fem_seal.load_solver import LoadSolver, interference
from fem_seal.loads import closing_force


@dataclass(frozen=True)
class SolvedLoads:
    """Contacts of all loads under which the seal is closed, and what is left after the last.

    Parameters
    ----------
    contacts : sequence of ContactSolution
        In the order of the case.
    unloaded : Unloaded or None
        None where no body yields: elastic bodies come back.
    open_loads : mapping
        Number of each load that the fluid opens the seal at, with the reason.
    """

    contacts: Sequence[ContactSolution]
    unloaded: Unloaded | None = None
    open_loads: Mapping[int, str] = field(default_factory=dict)


def solve_loads(solver: LoadSolver) -> SolvedLoads:
    """Solve all loads of a case on a model.

    Parameters
    ----------
    solver : LoadSolver

    Raises
    ------
    InputError
        If every load leaves the seal open.
    ConvergenceError
    """
    if solver.yields:
        path = _path(solver, len(solver.case.load.points))
        return SolvedLoads(path.contacts, path.unloaded)
    contacts: list[ContactSolution] = []
    opened: dict[int, InputError] = {}
    for number, point in enumerate(solver.case.load.points):
        try:
            contacts.append(solver.solve(*point))
        except InputError as error:
            opened[number] = error
    if not contacts:
        raise opened[0]
    return SolvedLoads(contacts, open_loads={n: error.allowed for n, error in opened.items()})


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
        return _path(solver, number + 1, steps).contacts[-1]
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
    return load_path(solver.model, solver.law, loads, at_rest=fit, settings=settings)
