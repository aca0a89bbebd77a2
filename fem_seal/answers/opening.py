"""The fluid pressure that opens the seal, and how far a load is from it, in force and in pressure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from fem_seal.answers.answer import Answer, Request
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.arrays import FloatArray
from fem_seal.contact.penetration import effective_radius
from fem_seal.loads import PressureSide, blow_off_of_sealed_area
from fem_seal.seal.load_result import OpeningMargin
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.seal.problem import SealProblem, size_mesh


@dataclass(frozen=True)
class Opening:
    """What opens the seal at one load; each as the attribute of `CaseLoad` of its name.

    Parameters
    ----------
    effective_radius, blow_off_pressure : float or None
        [m], [Pa]
    opening : OpeningMargin or None
    """

    effective_radius: float | None
    blow_off_pressure: float | None
    opening: OpeningMargin | None


def _compute(seal: SolvedSeal, request: Request) -> tuple[Opening, ...]:
    solver, of = request.solver, seal.problem.loads
    penetrates = of.closing == "penetration"

    def key(load: CaseLoad) -> tuple[float, int | None]:
        """What the pressure depends on: the applied force, and of bodies that yield the contact."""
        return load.applied_force, id(load.contact) if solver.yields else None

    with request.clock.step("questions", "blow-off and force for the target leak rate"):
        # elastic bodies are the same after every load
        different = {key(load): load for load in reversed(seal.loads)} if of.fluid_may_open else {}
        opens = {
            state: request.steps.compute(
                f"pressure that opens the seal under {load.applied_force:.6g} N",
                partial(solver.blow_off_pressure, load.applied_force, load.contact),
                None,
            )
            for state, load in different.items()
        }
        loads = tuple(
            load.with_values(
                effective_radius=effective_radius(load.contact, load.fluid_pressure) if penetrates else None,
                blow_off_pressure=opens.get(key(load)),
            )
            for load in seal.loads
        )
        loads = request.steps.compute(OPENING.subject, partial(with_margins, solver, loads), loads)
    return tuple(Opening(load.effective_radius, load.blow_off_pressure, load.opening) for load in loads)


OPENING = Answer[tuple[Opening, ...]](
    "opening",
    "margin to opening",
    _compute,
    (),
    of_load=lambda load, number, openings: load.with_values(**vars(openings[number])) if openings else load,
    needs=("problem.loads.may_open",),
    of_part=True,
)


def blow_off_pressures(problem: SealProblem) -> FloatArray:
    """Fluid pressure at which the seal opens under the force of spring or actuator of each load [Pa], shape (loads,).

    Infinite where the fluid does not lift the closure.

    Parameters
    ----------
    problem : SealProblem
        Its fluid pressures only size the mesh.

    Raises
    ------
    ConvergenceError
    """
    applied_forces = [force for _, force in problem.loads.points]
    forces = [share * abs(force) for force in applied_forces for share in (1.0, 0.1) if force]
    if problem.on_sealed_area or not forces:
        radius, side = problem.initial_contact_radius, problem.loads.pressure_side
        return np.array([blow_off_of_sealed_area(radius, force, side) for force in applied_forces])
    solver = LoadSolver.on_mesh(problem, size_mesh(problem, forces))
    pressures = {force: solver.blow_off_pressure(force) for force in dict.fromkeys(applied_forces)}
    return np.array([pressures[force] for force in applied_forces])


def with_margins(solver: LoadSolver, loads: Sequence[CaseLoad]) -> tuple[CaseLoad, ...]:
    """Loads with their distance from opening; without one where neither fluid nor applied force opens the seal.

    Parameters
    ----------
    solver : LoadSolver
    loads : sequence of CaseLoad
        With the pressure that opens the seal.
    """
    side, results = solver.problem.loads.pressure_side, []
    for load in loads:
        pressure, applied_force = load.fluid_pressure, load.applied_force
        edge = solver.opening_force(pressure, load.contact) if side == "outer" and applied_force < 0 else None
        margin = opening_margin(pressure, applied_force, side, opens=load.blow_off_pressure, edge=edge)
        results.append(load.with_values(opening=margin))
    return tuple(results)


def opening_margin(
    fluid_pressure: float,
    applied_force: float,
    pressure_side: PressureSide,
    *,
    opens: float | None = None,
    edge: float | None = None,
) -> OpeningMargin | None:
    """Distance from opening the seal; None where neither fluid nor applied force opens it.

    Parameters
    ----------
    fluid_pressure : float
        [Pa]
    applied_force : float
        Of spring or actuator [N], positive where it closes.
    pressure_side : {"outer", "inner"}
    opens : float, optional
        With the pressure inside, the one that opens the seal under this force [Pa].
    edge : float, optional
        With the pressure outside, the negative force that opens the seal at this pressure [N].

    Examples
    --------
    A spring of 1 kN that holds 64 bar, at 63 bar:

    >>> margin = opening_margin(63e5, 1e3, "inner", opens=64e5)
    >>> print(f"{margin.force:.3f} N, {margin.pressure:.0f} Pa, {margin.share:.4f}, {margin.digits} digits")
    15.625 N, 100000 Pa, 0.0156, 2 digits
    """
    if pressure_side == "inner":
        if opens is None or not math.isfinite(opens):
            return None
        share = 1 - fluid_pressure / opens
        return OpeningMargin(share * applied_force, opens - fluid_pressure, share)
    # the spring lifts, and the fluid has to hold it
    if applied_force >= 0 or edge is None or not edge < 0:
        return None
    share = 1 - applied_force / edge
    return OpeningMargin(applied_force - edge, share * fluid_pressure, share)
