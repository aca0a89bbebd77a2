"""Discretisation error of a load from the same load on larger elements and, where a body yields, larger load steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fem_seal.contact_solution import ContactSolution
from fem_seal.elastoplastic_contact import PlasticSettings
from fem_seal.load_solver import LoadSolver, condensed
from fem_seal.results import DiscretisationError
from fem_seal.solved_loads import solve_load
from meshes import SealMesh, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.laws import Law

# Of a result whose estimate failed.
NOT_ESTIMATED = DiscretisationError(math.nan, math.nan, math.nan, None)
# The coarser mesh of the error estimate has elements this much larger, its path load steps.
COARSER = 2
_STEPS = PlasticSettings().steps


@dataclass(frozen=True)
class CoarserLoad:
    """One load of a case on larger elements than those of the result.

    Parameters
    ----------
    solver : LoadSolver
    mesh : SealMesh
    number : int
        Which of the case's loads it is.
    contact : ContactSolution
    """

    solver: LoadSolver
    mesh: SealMesh
    number: int
    contact: ContactSolution

    @property
    def fluid_pressure(self) -> float:
        """Fluid pressure of the load [Pa]."""
        return self.solver.case.load.fluid_pressure[self.number]

    def solve(self, solver: LoadSolver) -> ContactSolution:
        """The same load and load steps with another solver."""
        return solve_load(solver, self.number, steps=_STEPS // COARSER, start=self.contact)


def on_coarser_mesh(case: Case, law: Law, sizing: Sizing, number: int) -> CoarserLoad:
    """Solve one load of a case on elements larger by `COARSER`.

    Parameters
    ----------
    case : Case
    law : Law
    sizing : Sizing
        Of the result.
    number : int
        Which of the case's loads.
    """
    mesh = build_contact(case.contact, sizing.refined(1 / COARSER))
    solver = LoadSolver(case, law, condensed(case, mesh))
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
    case = coarser.solver.case
    if not case.contact.has_ready_mesh:
        return _compared(coarser, result, coarser.contact)
    # A ready mesh cannot be made coarser, but finer.
    fine_mesh = build_contact(case.contact.with_finer_meshes(), sizing.refined(COARSER))
    solver = LoadSolver(case, coarser.solver.law, condensed(case, fine_mesh))
    fine = solve_load(solver, coarser.number, steps=_STEPS * COARSER)
    return _compared(coarser, fine, result, of_coarse=True)


def _compared(
    load: CoarserLoad, fine: ContactSolution, coarse: ContactSolution, *, of_coarse: bool = False
) -> DiscretisationError:
    """Error of the fine or of the coarse one of two contacts."""
    # Load steps of implicit Euler are of first order; elements of second at least.
    order = 1 if load.solver.yields else 2

    def estimated(fine: float, coarse: float) -> float:
        """Relative error by Richardson's rule."""
        return abs(coarse / fine - 1) / (COARSER**order - 1) * (COARSER**order if of_coarse else 1.0)

    a, b, flow, leak_rate = fine.profile, coarse.profile, load.solver.flow, None
    if flow is not None:
        leaks = flow.leak(a, load.fluid_pressure).leak_rate
        if 0 < leaks < float("inf"):
            leak_rate = estimated(leaks, flow.leak(b, load.fluid_pressure).leak_rate)
    return DiscretisationError(
        estimated(a.peak_pressure, b.peak_pressure),
        estimated(a.fwhm, b.fwhm),
        estimated(a.std, b.std),
        leak_rate,
    )
