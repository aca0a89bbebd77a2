"""Contact of bodies that yield: Newton on the bodies and the contact line together.

Every iteration linearises the bodies about their last displacement and condenses their tangents on the contact line,
as `fem_seal.condensation` does with elastic bodies. What is left is a contact of linear bodies with another
compliance and another gap at rest; `fem_seal.contact` solves it for any interface law, hard contact included. This is
Newton's method for a generalised equation (Josephy), with quadratic convergence.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fem_seal.condensation import ContactModel
from fem_seal.contact import solve
from fem_seal.contact_solution import ContactSolution
from fem_seal.elastoplastic_body import BodyState, ElastoplasticBody
from fem_seal.elastoplastic_fields import elastoplastic_field
from fem_seal.errors import ConvergenceError
from fem_seal.further_loads import NO_LOADS, FurtherLoads
from fem_seal.held_body import HeldBody
from fem_seal.laws import Law
from fem_seal.plastic_flow import Flow
from fem_seal.stress import BodyField, body_fields

FloatArray = NDArray[np.float64]


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


@dataclass(frozen=True, kw_only=True)
class ElastoplasticContact(ContactSolution):
    """State of the contact line and of the yielding bodies under one axial force of a path.

    Parameters
    ----------
    bodies : mapping
        The bodies that yield, by name.
    states : mapping
        Their states, by name.
    equilibrium_residuals : tuple of float
        Largest nodal force out of balance over the largest that the elements put on a node, one per Newton iteration
        of the last load step.
    load_steps : int
        Steps since the load before.
    """

    bodies: Mapping[str, YieldingBody] = field(repr=False)
    states: Mapping[str, BodyState] = field(repr=False)
    equilibrium_residuals: tuple[float, ...] = field(repr=False)
    load_steps: int = 1

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Displacement and stress of "closure" and "seat"; of bodies that yield with their plastic strain."""
        return body_fields(self) | {
            name: elastoplastic_field(body.held, body.solid, self.states[name], self.profile)
            for name, body in self.bodies.items()
        }


@dataclass(frozen=True)
class Equilibrium:
    """Bodies and contact line in balance."""

    states: dict[str, BodyState]
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

    Returns
    -------
    Equilibrium

    Raises
    ------
    ConvergenceError
        If the iteration does not reach the tolerance.
    """
    loads, settings = loads or NO_LOADS, settings or PlasticSettings()
    others = FurtherLoads(
        **{name: {} if name in bodies else getattr(loads, name) for name in ("closure", "seat")},
        gap_pressure=loads.gap_pressure,
    )
    in_gap = model.line.area_weight * (0.0 if loads.gap_pressure is None else loads.gap_pressure)
    elastic = _elastic_compliance(model, bodies)
    further = {name: _further_forces(body.held, getattr(loads, name)) for name, body in bodies.items()}
    states = {
        name: _moved(
            body, before[name], _with_wall(body.held, before[name].displacement, getattr(loads, name))
        )
        for name, body in bodies.items()
    }
    contact, forces, residuals = start, in_gap, list[float]()
    for _ in range(settings.max_iterations):
        tangents = {name: _Tangent.of(body, states[name], further[name]) for name, body in bodies.items()}
        if axial_force > 0:
            contact = _solve_from(_linearised(model, elastic, tangents), law, axial_force, others, contact)
            forces = contact.point_forces + in_gap
        states = {
            name: _moved(body, before[name], tangents[name].displacement(forces))
            for name, body in bodies.items()
        }
        residuals.append(
            max(
                _imbalance(body, before[name], states[name], body.held.nodal_forces(forces) + further[name])
                for name, body in bodies.items()
            )
        )
        if residuals[-1] < settings.tolerance:
            # The contact was solved with linearised bodies; it is one of the true ones.
            contact = replace(contact, model=model, loads=loads) if contact and axial_force > 0 else None
            return Equilibrium(
                {name: state.reached for name, state in states.items()}, contact, tuple(residuals)
            )
    raise ConvergenceError(
        f"the forces in the bodies are out of balance by {residuals[-1]:.2g} of the largest after "
        f"{settings.max_iterations} iterations"
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
    forces = (size * held.further[name] for name, size in magnitudes.items() if name != "wall")
    return held.balanced(sum(forces, np.zeros(held.basis.N)))


def _with_wall(held: HeldBody, displacement: FloatArray, magnitudes: Mapping[str, float]) -> FloatArray:
    """The displacement with the wall where a press fit puts it."""
    moved = displacement.copy()
    moved[held.wall] = -magnitudes.get("wall", 0.0)
    return moved


@dataclass(frozen=True)
class _Iterate:
    """A displacement, and the material's answer to it."""

    displacement: FloatArray
    flow: Flow

    @property
    def reached(self) -> BodyState:
        return BodyState(self.displacement, self.flow.stress, self.flow.state)


def _moved(body: YieldingBody, before: BodyState, displacement: FloatArray) -> _Iterate:
    return _Iterate(displacement, body.solid.respond(displacement, before))


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
class _Tangent:
    """A body linearised about a displacement, seen from the contact line.

    Parameters
    ----------
    body : YieldingBody
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
    def of(cls, body: YieldingBody, at: _Iterate, further: FloatArray) -> _Tangent:
        compliance, solve = body.held.condensed(body.solid.stiffness(at.flow.tangent))
        unbalanced = further - body.solid.internal_forces(at.flow.stress)
        return cls(body, at.displacement + solve(unbalanced), compliance, solve)

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


def _imbalance(body: YieldingBody, before: BodyState, at: _Iterate, forces: FloatArray) -> float:
    """Largest free nodal force out of balance over the largest force that the elements put on a node in the step."""
    internal = body.solid.internal_forces
    unbalanced = (internal(at.flow.stress) - forces)[body.held.free]
    scale = max(float(np.abs(internal(np.abs(stress))).max()) for stress in (before.stress, at.flow.stress))
    return float(np.abs(unbalanced).max()) / scale if scale > 0 else 0.0
