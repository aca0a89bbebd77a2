"""One load step of a seal with yielding bodies: Newton on the bodies and the contact line together.

Every iteration linearises the bodies about their last displacement and condenses their tangents on the contact line,
as `fem_seal.contact.model` does with elastic bodies. What is left is a contact of linear bodies with another
compliance and another gap at rest; `fem_seal.contact.newton` solves it for any interface law, hard contact included.
This is Newton's method for a generalised equation (Josephy), with quadratic convergence.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.elasticity import at_quadrature_points
from fem_seal.bodies.elastoplastic import BodyState, ElastoplasticBody
from fem_seal.bodies.held_body import HeldBody
from fem_seal.bodies.plastic_flow import Flow
from fem_seal.contact.laws import Law
from fem_seal.contact.model import ContactModel
from fem_seal.contact.newton import solve
from fem_seal.contact.other_loads import NO_LOADS, FurtherLoads
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError

# Shares of a Newton step that are tried where the whole of it makes the bodies less balanced than they were.
_SHARES = (1.0, 0.6, 0.35, 0.2)


@dataclass(frozen=True)
class Equilibrium:
    """Bodies and contact line in balance.

    Parameters
    ----------
    states : mapping of BodyState
        Of the bodies that yield, by name.
    contact : ContactSolution or None
        None where the bodies do not touch.
    residuals : tuple of float
        Largest nodal force out of balance over the largest that the elements put on a node, one per iteration.
    """

    states: Mapping[str, BodyState]
    contact: ContactSolution | None
    residuals: tuple[float, ...]


def press(
    model: ContactModel,
    bodies: Mapping[str, YieldingBody],
    law: Law,
    axial_force: float,
    before: Mapping[str, BodyState],
    *,
    loads: FurtherLoads | None = None,
    settings: PlasticSettings | None = None,
    start: ContactSolution | None = None,
) -> Equilibrium:
    """Balance of bodies and contact line under an axial force, one load step away from a known state.

    Parameters
    ----------
    model : ContactModel
        Of the elastic bodies.
    bodies : mapping
        Those that yield, by name.
    law : InterfaceLaw or HardContact
    axial_force : float
        F_N [N]; the bodies do not touch if it is zero.
    before : mapping
        States of the yielding bodies at the beginning of the step.
    loads : FurtherLoads, optional
        What else acts on the bodies at the end of the step.
    settings : PlasticSettings, optional
    start : ContactSolution, optional
        To start from.

    Raises
    ------
    ConvergenceError
        If the iteration does not reach the tolerance.
    """
    loads, settings = loads or NO_LOADS, settings or PlasticSettings()
    magnitudes = {name: getattr(loads, name) for name in bodies}
    others = FurtherLoads(
        {} if "closure" in bodies else loads.closure,
        {} if "seat" in bodies else loads.seat,
        loads.gap_pressure,
    )
    in_gap = model.line.area_weight * (0.0 if loads.gap_pressure is None else loads.gap_pressure)
    elastic = _elastic_compliance(model, bodies)
    step = _Step(
        bodies,
        before,
        {name: _further_forces(body.held, magnitudes[name]) for name, body in bodies.items()},
        {name: _free_strain(body.held, magnitudes[name]) for name, body in bodies.items()},
    )
    at = step.at(
        {
            name: _with_wall(body.held, before[name].displacement, magnitudes[name])
            for name, body in bodies.items()
        },
        in_gap if start is None else start.point_forces + in_gap,
    )
    contact, forces, allowed, residuals = start, in_gap, np.inf, list[float]()
    for _ in range(settings.max_iterations):
        tangents = step.tangents(at)
        if axial_force > 0:
            contact = _solve_from(_linearised(model, elastic, tangents), law, axial_force, others, contact)
            forces = contact.point_forces + in_gap
        whole = step.at({name: tangent.displacement(forces) for name, tangent in tangents.items()}, forces)
        residuals.append(whole.imbalance)
        if whole.imbalance < settings.tolerance:
            # The contact was solved with linearised bodies; it is one of the true ones.
            contact = replace(contact, model=model, loads=loads) if contact and axial_force > 0 else None
            return Equilibrium(whole.states, contact, tuple(residuals))
        at = whole if whole.imbalance < allowed else step.shortened(at, whole)
        allowed = at.imbalance
    raise ConvergenceError(
        f"the forces in the bodies are out of balance by {residuals[-1]:.2g} of the largest after "
        f"{settings.max_iterations} iterations"
    )


@dataclass(frozen=True)
class _Iterate:
    """Displacements, the materials' answers to them, and the forces at the points of the contact line."""

    displacements: Mapping[str, FloatArray]
    flows: Mapping[str, Flow]
    forces: FloatArray
    imbalance: float

    @property
    def states(self) -> dict[str, BodyState]:
        return {
            name: BodyState(self.displacements[name], flow.stress, flow.state)
            for name, flow in self.flows.items()
        }


@dataclass(frozen=True)
class _Step:
    """What does not change within a load step."""

    bodies: Mapping[str, YieldingBody]
    before: Mapping[str, BodyState]
    further: Mapping[str, FloatArray]
    free_strain: Mapping[str, FloatArray | float]

    def at(self, displacements: Mapping[str, FloatArray], forces: FloatArray) -> _Iterate:
        flows = {
            name: body.solid.respond(displacements[name], self.before[name], self.free_strain[name])
            for name, body in self.bodies.items()
        }
        return _Iterate(
            displacements, flows, forces, max(self._imbalance(name, flows[name], forces) for name in flows)
        )

    def shortened(self, at: _Iterate, whole: _Iterate) -> _Iterate:
        """The best balanced place on the way from one iterate to another.

        The next contact is linearised there; that it has solved the contact itself is not asked of an iterate.
        """
        candidates = (
            self.at(
                {
                    name: (1 - share) * at.displacements[name] + share * whole.displacements[name]
                    for name in self.bodies
                },
                (1 - share) * at.forces + share * whole.forces,
            )
            for share in _SHARES
        )
        return min(candidates, key=lambda iterate: iterate.imbalance)

    def tangents(self, at: _Iterate) -> dict[str, _Tangent]:
        return {
            name: _Tangent.of(body, at.displacements[name], at.flows[name], self.further[name])
            for name, body in self.bodies.items()
        }

    def _imbalance(self, name: str, flow: Flow, forces: FloatArray) -> float:
        """Largest free nodal force out of balance over the largest that the elements put on a node in the step."""
        body, internal = self.bodies[name], self.bodies[name].solid.internal_forces
        unbalanced = internal(flow.stress) - body.held.nodal_forces(forces) - self.further[name]
        stresses = (self.before[name].stress, flow.stress)
        scale = max(float(np.abs(internal(np.abs(stress))).max()) for stress in stresses)
        # what grows freely has no stress to measure by, only the one that would keep it from growing
        scale = max(scale, float(np.abs(internal(body.solid.hindered(self.free_strain[name]))).max()))
        return float(np.abs(unbalanced[body.held.free]).max()) / scale if scale > 0 else 0.0


@dataclass(frozen=True)
class _Tangent:
    """A body linearised about a displacement, seen from the contact line.

    Parameters
    ----------
    at_rest : ndarray, shape (dofs,)
        Displacement [m] where the line carries nothing.
    compliance : ndarray, shape (n, n)
        Retreat of the contact nodes per unit normal force at each [m/N].
    solve : callable
        From nodal forces (dofs,) to the displacement that they add.
    """

    body: YieldingBody
    at_rest: FloatArray
    compliance: FloatArray
    solve: Callable[[FloatArray], FloatArray]

    @classmethod
    def of(cls, body: YieldingBody, displacement: FloatArray, flow: Flow, further: FloatArray) -> _Tangent:
        compliance, solve = body.held.condensed(body.solid.stiffness(flow.tangent))
        unbalanced = further - body.solid.internal_forces(flow.stress)
        return cls(body, displacement + solve(unbalanced), compliance, solve)

    @property
    def line_opening(self) -> FloatArray:
        """What the body adds to the gap at rest, at the points of the line [m]; shape (m,)."""
        return self.body.held.trace @ self.body.held.retreat(self.at_rest)

    @property
    def line_compliance(self) -> FloatArray:
        """What it adds to the gap per unit normal force at these points [m/N]; shape (m, m)."""
        trace = self.body.held.trace
        return trace @ (trace @ self.compliance.T).T

    def displacement(self, point_forces: FloatArray) -> FloatArray:
        """Displacement (dofs,) [m] under normal forces at the points of the line [N]."""
        return self.at_rest + self.solve(self.body.held.nodal_forces(point_forces))


def _linearised(model: ContactModel, elastic: FloatArray, tangents: Mapping[str, _Tangent]) -> ContactModel:
    """The contact of the linearised bodies."""
    compliance = elastic + sum(tangent.line_compliance for tangent in tangents.values())
    gap = model.line.initial_gap + sum(tangent.line_opening for tangent in tangents.values())
    return replace(
        model, line=replace(model.line, initial_gap=gap), compliance=0.5 * (compliance + compliance.T)
    )


def _elastic_compliance(model: ContactModel, bodies: Mapping[str, YieldingBody]) -> FloatArray:
    """What the bodies that do not yield add to the gap per unit force at the points of the line [m/N]."""
    compliance = np.zeros_like(model.compliance)
    for name, body in (("closure", model.closure), ("seat", model.seat)):
        if name not in bodies:
            compliance += body.trace @ (body.trace @ body.compliance.T).T
    return compliance


def _further_forces(held: HeldBody, magnitudes: Mapping[str, float]) -> FloatArray:
    """Balanced nodal forces of loads away from the contact line."""
    forces = (size * held.further[name] for name, size in magnitudes.items() if name in held.further)
    return held.balanced(sum(forces, np.zeros(held.basis.N)))


def _free_strain(held: HeldBody, magnitudes: Mapping[str, float]) -> FloatArray | float:
    """Strain at the quadrature points that takes no stress."""
    heated = [size * held.free_strain[name] for name, size in magnitudes.items() if name in held.free_strain]
    return at_quadrature_points(held.basis, np.sum(heated, axis=0)) if heated else 0.0


def _with_wall(held: HeldBody, displacement: FloatArray, magnitudes: Mapping[str, float]) -> FloatArray:
    """The displacement with the wall where a press fit puts it."""
    moved = displacement.copy()
    moved[held.wall] = -magnitudes.get("wall", 0.0)
    return moved


def _solve_from(
    model: ContactModel, law: Law, axial_force: float, loads: FurtherLoads, start: ContactSolution | None
) -> ContactSolution:
    """Start from a neighbouring contact; if it lies too far away, from scratch."""
    try:
        return solve(model, law, axial_force=axial_force, loads=loads, start=start)
    except ConvergenceError:
        if start is None:
            raise
    return solve(model, law, axial_force=axial_force, loads=loads)


@dataclass(frozen=True)
class PlasticSettings:
    """When the Newton iteration of a load step stops, and how small a step may become.

    Parameters
    ----------
    tolerance : float
        Largest nodal force out of balance over the largest that the elements put on a node.
    max_iterations : int
        A step that needs more is halved.
    steps : int
        Load steps from zero to a load; between two loads in proportion to the larger one.
    smallest_step : float
        Smallest load step, as a share of the larger load, before the path is given up.
    """

    tolerance: float = 1e-9
    max_iterations: int = 20
    steps: int = 16
    smallest_step: float = 1e-4


@dataclass(frozen=True)
class YieldingBody:
    """A body of the seal that yields: where it is touched and held, and its solid."""

    held: HeldBody

    @cached_property
    def solid(self) -> ElastoplasticBody:
        """The elastoplastic solid."""
        return ElastoplasticBody(self.held.basis, self.held.material, self.held.free)
