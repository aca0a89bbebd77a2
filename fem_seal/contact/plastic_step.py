"""One load step of a seal with yielding bodies: Newton on the bodies and the contact line together.

Every iteration linearises the bodies about their last displacement and condenses their tangents on the contact line,
as `fem_seal.contact.model` does with elastic bodies. What is left is a `ContactModel` of linear bodies with another
compliance and another gap at rest; whatever solves elastic bodies solves it: `fem_seal.contact.newton` for a given
force and any interface law, hard contact included, `fem_seal.contact.penetration` for a spring and a fluid that gets
between the surfaces. This is Newton's method for a generalised equation (Josephy), with quadratic convergence.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, reduce

import numpy as np
from scipy.sparse import csr_matrix

from fem_seal.arrays import FloatArray
from fem_seal.bodies.constrained_body import (
    BoundaryLoad,
    CondensedBody,
    ConstrainedBody,
    LoadName,
    condense_body,
)
from fem_seal.bodies.dissected_body import DissectedBody
from fem_seal.bodies.elasticity import (
    at_quadrature_points,
    elasticity_matrix,
    larger_strain,
    over_pressure,
    strain_size,
)
from fem_seal.bodies.elastoplastic import BodyState, ElastoplasticBody, StressUpdate
from fem_seal.bolts import Bolts, held_force
from fem_seal.contact.laws import Law
from fem_seal.contact.model import NO_LOADS, BodyLoads, ContactModel, line_compliance
from fem_seal.contact.newton import solve
from fem_seal.contact.penetration import CoupledContact, FluidPath, solve_penetration
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError
from fem_seal.files import problem


@dataclass(frozen=True)
class TightenedBolts:
    """Bolts that were tightened at the last load of a path without them, and give the force of those after it.

    Parameters
    ----------
    bolts : Bolts
    preload : float
        Of all of them [N].
    end_force : float
        Force of the load less that of the bolts: of a fluid that acts on the sealed area [N].
    """

    bolts: Bolts
    preload: float
    end_force: float


@dataclass(frozen=True)
class PathLoad:
    """A load between which and the next one everything rises or falls evenly.

    Parameters
    ----------
    force : float
        F_N that the solid contact carries, zero where the bodies are apart; with a fluid that gets between the surfaces
        that of spring or actuator, positive when it closes [N].
    further : BodyLoads
        What else acts on the bodies, also where they do not touch; without the fluid that gets between the surfaces.
    path : FluidPath or None
        How the fluid gets between the surfaces; what the solid contact carries is found with it.
    fluid_pressure : float
        Pressure difference across the seal [Pa].
    bolts : TightenedBolts, optional
        Bolts whose force stands in place of `force`, which is then the first guess.
    """

    force: float
    further: BodyLoads = NO_LOADS
    path: FluidPath | None = field(default=None, repr=False, kw_only=True)
    fluid_pressure: float = field(default=0.0, kw_only=True)
    bolts: TightenedBolts | None = field(default=None, repr=False, kw_only=True)

    def __str__(self) -> str:
        fluid = "" if self.path is None else f" at {self.fluid_pressure / 1e5:.6g} bar"
        return f"{self.force:.6g} N{fluid}"

    @property
    def alone(self) -> bool:
        """Whether nothing but its force rises from zero to it."""
        return self.path is None or self.fluid_pressure == 0.0

    def contact(self, model: ContactModel, law: Law, start: ContactSolution | None) -> ContactSolution | None:
        """The contact of linear bodies under this load, and its fluid; None where it leaves them apart.

        Raises
        ------
        OpenSealError
            If a fluid lifts the closure off.
        ConvergenceError
        """
        if self.path is not None and self.fluid_pressure != 0.0:
            seal = CoupledContact(model, law, self.path, self.further)
            return solve_penetration(
                seal, applied_force=self.force, fluid_pressure=self.fluid_pressure, start=start
            )
        if not self.force > 0:
            return None
        return solve(model, law, contact_force=self.force, loads=self.further, start=start)

    def interpolate(self, other: PathLoad, way: float) -> PathLoad:
        """The load a share `way` of the way to another one, with that one's fluid."""
        return replace(
            other,
            force=(1 - way) * self.force + way * other.force,
            fluid_pressure=(1 - way) * self.fluid_pressure + way * other.fluid_pressure,
            further=_interpolate_loads(self.further, other.further, way),
        )

    def change(self, other: PathLoad, initial_contact_radius: float) -> float:
        """How far it is to another one, as a share of the larger; from nothing to a load it is one.

        In the force that is left to the contact, or in spring and fluid together.
        """
        area = math.pi * initial_contact_radius**2
        forces = [(load.force, area * load.fluid_pressure) for load in (self, other)]
        sign = -1 if self.path is not None and self.path.side == "inner" else 1
        closing_change = _share(*(max(spring + sign * fluid, 0.0) for spring, fluid in forces))
        largest_force = max(abs(spring) + fluid for spring, fluid in forces)
        (spring, fluid), (next_spring, next_fluid) = forces
        total_change = abs(next_spring - spring) + abs(next_fluid - fluid)
        return min(max(closing_change, total_change / largest_force if largest_force > 0 else 0.0), 1.0)

    def after_contacts(self, contacts: Sequence[ContactSolution]) -> PathLoad:
        """The load after some contacts, whose pressures the fluid between the surfaces feels."""
        if self.path is None or not contacts:
            return self
        largest = np.max([contact.pressure for contact in contacts], axis=0)
        return replace(self, path=self.path.after_load(largest))

    def balance_bolts(self, balance: Equilibrium, law: Law, bolted_at: float) -> PathLoad:
        """The load with the force of its bolts, where the bodies answer as they do when linearised here.

        Parameters
        ----------
        balance : Equilibrium
        law : InterfaceLaw or HardContact
        bolted_at : float
            Approach at which the bolts were tightened [m].

        Raises
        ------
        OpenSealError
            If a fluid lifts the closure off.
        ConvergenceError
        """
        bolts, linear, contact = self.bolts, balance.linear, balance.contact
        assert bolts is not None and linear is not None and contact is not None  # of all who ask

        def approach(force: float) -> float:
            nonlocal contact
            contact = replace(self, force=force + bolts.end_force).contact(linear, law, contact)
            if contact is None:
                raise ConvergenceError(f"bolts with {force:.6g} N leave nothing to the contact")
            return contact.approach

        force = held_force(bolts.bolts, bolts.preload, approach, bolted_at)
        return replace(self, force=force + bolts.end_force)

    def past_stop(self, balance: Equilibrium) -> Equilibrium | None:
        """The balance under this load where it leaves linearised bodies at the stop that are there; else None."""
        contact, unknown = balance.contact, balance.linear is None or self.path is not None
        if unknown or contact is None or not balance.at_stop or self.force < contact.contact_force:
            return None
        return replace(balance, contact=replace(contact, stop_force=self.force - contact.contact_force))

    def without_stop(self, balance: Equilibrium) -> PathLoad:
        """The load under which bodies are in balance, without the force of the stop, which goes first."""
        if not balance.at_stop or balance.contact is None or self.path is not None:
            return self
        return replace(self, force=balance.contact.contact_force)

    def without_force(self, further: BodyLoads) -> PathLoad:
        """The same way of loading with nothing that presses, where these loads act."""
        return replace(self, force=0.0, fluid_pressure=0.0, further=further)


def _share(first: float, second: float) -> float:
    scale = max(abs(first), abs(second))
    return abs(second - first) / scale if scale > 0 else 0.0


def _interpolate_loads(first: BodyLoads, second: BodyLoads, way: float) -> BodyLoads:
    """Loads a share `way` of the way from some to others."""
    shares = [
        share * load.gap_pressure
        for share, load in ((1 - way, first), (way, second))
        if load.gap_pressure is not None
    ]
    return BodyLoads(
        _interpolate_magnitudes(first.closure, second.closure, way),
        _interpolate_magnitudes(first.seat, second.seat, way),
        np.sum(shares, axis=0) if shares else None,
        second.temperature or first.temperature,
    )


def _interpolate_magnitudes(
    first: Mapping[LoadName, float], second: Mapping[LoadName, float], way: float
) -> dict[LoadName, float]:
    return {
        name: (1 - way) * first.get(name, 0.0) + way * second.get(name, 0.0) for name in {*first, *second}
    }


@dataclass(frozen=True, repr=False)
class LinearModel(ContactModel):
    """Bodies linearised about a place on their path.

    Parameters
    ----------
    path_strain : ndarray, shape (m, 3), or None
        What strained the metal under the faces on the way there, see `ContactSolution.strain`: no small change of the
        load knows it.
    """

    path_strain: FloatArray | None = None


# Shares of a Newton step that are tried where the whole of it makes the bodies less balanced than they were.
_SHARES = (1.0, 0.6, 0.35, 0.2)


@dataclass(frozen=True)
class Flattening:
    """What the strain of a body on its path flattens of the asperities on its face, which sink while it flows.

    By `leak.theory.bulk_flow` the area that touches grows with the strain times the pressure under which it comes. All
    plastic strain counts, whichever way it goes; elastic strain comes back, and half of it is added, as it rises with
    the pressure.

    Parameters
    ----------
    plastic : ndarray, shape (m, 2)
        Plastic strain along the face and around the axis [-].
    pressure, highest : ndarray, shape (m,)
        Contact pressure there, and the highest so far [Pa].
    net : ndarray, shape (m, 2)
        int p d(plastic strain) [Pa].
    length : ndarray, shape (m,)
        The same of its size, see `strain_size` [Pa].
    elastic : ndarray, shape (m, 2)
        Half of pressure times elastic strain where this was largest [Pa].
    """

    plastic: FloatArray
    pressure: FloatArray
    highest: FloatArray
    net: FloatArray
    length: FloatArray
    elastic: FloatArray

    @classmethod
    def none(cls, points: int) -> Flattening:
        """Of a body that has not been touched."""
        zero, zeros = np.zeros(points), np.zeros((points, 2))
        return cls(zeros, zero, zero, zeros, zero, zeros)

    def until(self, plastic: FloatArray, elastic: FloatArray, pressure: FloatArray) -> Flattening:
        """After one more load step, with the strains (m, 2) and the pressure (m,) at its end."""
        step = (0.5 * (self.pressure + pressure))[:, None] * (plastic - self.plastic)
        return Flattening(
            plastic,
            pressure,
            np.maximum(self.highest, pressure),
            self.net + step,
            self.length + strain_size(step),
            larger_strain(self.elastic, 0.5 * pressure[:, None] * elastic),
        )

    @property
    def strain(self) -> FloatArray:
        """Strain that flattens as much at the highest pressure, shape (m, 2) [-]."""
        net = self.net + self.elastic
        # whichever way the metal goes, all of its way counts
        size = np.maximum(strain_size(net) + self.length - strain_size(self.net), 0.0)
        return over_pressure(size[:, None] * net, strain_size(net) * self.highest)

    @property
    def elastic_strain(self) -> FloatArray:
        """Elastic strain where pressure times it was largest, over the highest pressure, shape (m, 2) [-]."""
        return over_pressure(2.0 * self.elastic, self.highest)


def strain_on_path(flattening: Mapping[str, Flattening]) -> FloatArray | None:
    """Strain of the faces, see `ContactSolution.strain`, of bodies that yield; None if nobody has followed it."""
    if not flattening:
        return None
    strain, elastic = (
        reduce(larger_strain, strains)
        for strains in zip(*((each.strain, each.elastic_strain) for each in flattening.values()), strict=True)
    )
    return np.column_stack([strain, elastic.sum(axis=1)])


@dataclass(frozen=True)
class Equilibrium:
    """Bodies and contact line in balance.

    Parameters
    ----------
    states : mapping of BodyState
        Of the bodies that yield, by name.
    contact : ContactSolution or None
        With the fluid between the surfaces; None where the bodies do not touch.
    residuals : tuple of float
        Largest nodal force out of balance over the largest that the elements put on a node, one per iteration.
    linear : ContactModel or None
        The bodies linearised there, of which nothing but the contact line is kept; None before the first load.
    has_flowed : bool
        Whether a body has yielded in the step.
    flattening : mapping of Flattening
        Of the faces of the bodies that yield, by name; empty where nobody has followed it.
    """

    states: Mapping[str, BodyState]
    contact: ContactSolution | None
    residuals: tuple[float, ...]
    linear: ContactModel | None = None
    has_flowed: bool = False
    flattening: Mapping[str, Flattening] = field(default_factory=dict)

    def flattened_until(self, arrival: Equilibrium, bodies: Mapping[str, YieldingBody]) -> Equilibrium:
        """Where one more load step leads, with what it flattens."""
        contact = arrival.contact
        flattening = {
            name: before.until(
                *bodies[name].face_strains(arrival.states[name]),
                np.zeros_like(before.pressure) if contact is None else contact.pressure,
            )
            for name, before in self.flattening.items()
        }
        return replace(arrival, flattening=flattening)

    @property
    def plastic_strain(self) -> float:
        """Largest accumulated plastic strain of all bodies [-]."""
        strains = (state.plastic.accumulated_strain for state in self.states.values())
        return max((float(strain.max()) for strain in strains), default=0.0)

    @property
    def at_stop(self) -> bool:
        """Whether a stop carries some of the force."""
        return self.contact is not None and self.contact.stop_force > 0

    def extrapolate(self, start: Equilibrium, share: float) -> dict[str, FloatArray]:
        """Displacements of the bodies that yield, extrapolated by a share of the step from `start` to here [m]."""
        return {
            name: state.displacement + share * (state.displacement - start.states[name].displacement)
            for name, state in self.states.items()
        }


def press(
    model: ContactModel,
    bodies: Mapping[str, YieldingBody],
    law: Law,
    load: PathLoad,
    start_states: Mapping[str, BodyState],
    *,
    settings: PlasticSettings | None = None,
    start: ContactSolution | None = None,
    guess: Mapping[str, FloatArray] | None = None,
    strain: FloatArray | None = None,
    elastic: bool = False,
) -> Equilibrium:
    """Balance of bodies, contact line and fluid under a load, one load step away from a known state.

    Parameters
    ----------
    model : ContactModel
        Of the elastic bodies.
    bodies : mapping
        Those that yield, by name.
    law : InterfaceLaw or HardContact
    load : PathLoad
        What acts at the end of the step.
    start_states : mapping
        States of the yielding bodies at the beginning of the step.
    settings : PlasticSettings, optional
    start : ContactSolution, optional
        To start from.
    guess : mapping, optional
        Displacements of the bodies at the end of the step, about which they are linearised first [m]; those at its
        beginning if it is left out.
    strain : ndarray, shape (m, 3), optional
        Of the faces at the beginning of the step, over which the fluid flows throughout the step.
    elastic : bool
        Whether to give up where something flows, at the guess or at the end of the step.

    Raises
    ------
    OpenSealError
        If a fluid lifts the closure off.
    ConvergenceError
        If the iteration does not reach the tolerance, or something flows that should not.
    """
    settings, step = settings or PlasticSettings(), _Step(model, bodies, start_states, load.further, strain)
    guess = guess or {name: state.displacement for name, state in start_states.items()}
    at = step.at(guess, load.further, None)
    contact, limit, residuals = start, np.inf, list[float]()
    for _ in range(settings.max_iterations):
        if elastic and at.is_flowing:
            raise ConvergenceError("something flows")
        linear, at_rest = step.linear(at)
        contact = _solve_from(linear, law, load, contact)
        loads = load.further if contact is None else contact.loads
        full = step.at(step.find_displacements(linear, at_rest, loads, contact), loads, contact)
        residuals.append(full.imbalance)
        if full.imbalance < settings.tolerance:
            # The contact was solved with linearised bodies; it is one of the true ones.
            solution = None if contact is None else replace(contact, model=model)
            return Equilibrium(full.states, solution, tuple(residuals), linear.line_alone, full.is_flowing)
        at = full if full.imbalance < limit else step.shorten_step(at, full)
        limit = at.imbalance
    numbers = {"residual": residuals[-1], "iterations": settings.max_iterations}
    raise ConvergenceError(problem("out_of_balance", **numbers))


def unloading_model(
    model: ContactModel,
    bodies: Mapping[str, YieldingBody],
    states: Mapping[str, BodyState],
    at_rest: BodyLoads = NO_LOADS,
    strain: FloatArray | None = None,
) -> LinearModel:
    """Contact of the bodies as they answer to less load: elastic, and formed by what they have gone through.

    Parameters
    ----------
    model : ContactModel
        Of the elastic bodies, before their first load.
    bodies : mapping
        Those that yield, by name.
    states : mapping
        Where they are, by name.
    at_rest : BodyLoads
        Heat, under which they are.
    strain : ndarray, shape (m, 3), optional
        Of their faces.

    Notes
    -----
    Exact as long as nothing yields, which a body does anew where it is loaded further, or backwards when nearly all of
    a load far above the yield stress is gone.
    """
    step = _Step(model, bodies, states, at_rest, strain)
    at = step.at({name: state.displacement for name, state in states.items()}, BodyLoads(), None)
    return step.linear(at)[0]


@dataclass(frozen=True)
class _Iterate:
    """Displacements, the materials' answers to them, and what acts on the bodies."""

    displacements: Mapping[str, FloatArray]
    flows: Mapping[str, StressUpdate]
    forces: Mapping[str, FloatArray]
    imbalance: float

    @property
    def is_flowing(self) -> bool:
        """Whether something flows."""
        return any(bool(flow.yielding.any()) for flow in self.flows.values())

    @property
    def states(self) -> dict[str, BodyState]:
        return {
            name: BodyState(self.displacements[name], flow.stress, flow.state)
            for name, flow in self.flows.items()
        }


@dataclass(frozen=True)
class _Step:
    """What does not change within a load step."""

    model: ContactModel
    bodies: Mapping[str, YieldingBody]
    start_states: Mapping[str, BodyState]
    at_rest: BodyLoads
    """Of which heat is the same throughout the step."""
    strain: FloatArray | None

    def at(
        self, displacements: Mapping[str, FloatArray], loads: BodyLoads, contact: ContactSolution | None
    ) -> _Iterate:
        """Iterate at some displacements under some loads."""
        contact_forces = np.zeros_like(self.model.line.x) if contact is None else contact.point_forces
        if loads.gap_pressure is not None:
            contact_forces = contact_forces + self.model.line.area_weight * loads.gap_pressure
        forces = {
            name: body.fem.nodal_forces(contact_forces) + _further_forces(body.fem, loads.on_body(name))
            for name, body in self.bodies.items()
        }
        return self._at(displacements, forces)

    def _at(self, displacements: Mapping[str, FloatArray], forces: Mapping[str, FloatArray]) -> _Iterate:
        flows = {
            name: body.solid.respond(displacements[name], self.start_states[name], self._free_strain[name])
            for name, body in self.bodies.items()
        }
        imbalance = max((self._imbalance(name, flows[name], forces[name]) for name in flows), default=0.0)
        return _Iterate(displacements, flows, forces, imbalance)

    def shorten_step(self, at: _Iterate, full: _Iterate) -> _Iterate:
        """The best balanced place on the way from one iterate to another.

        The next contact is linearised there; that it has solved the contact itself is not asked of an iterate.
        """

        def mix(first: FloatArray, second: FloatArray, share: float) -> FloatArray:
            return (1 - share) * first + share * second

        candidates = (
            self._at(
                {name: mix(at.displacements[name], full.displacements[name], share) for name in self.bodies},
                {name: mix(at.forces[name], full.forces[name], share) for name in self.bodies},
            )
            for share in _SHARES
        )
        return min(candidates, key=lambda iterate: iterate.imbalance)

    def linear(self, at: _Iterate) -> tuple[LinearModel, dict[str, FloatArray]]:
        """The contact of the bodies linearised about an iterate, and their displacements where nothing acts [m]."""
        model, gap, at_rest = self.model, self.model.line.initial_gap, {}
        bodies = model.bodies
        for name, body in self.bodies.items():
            heat = _heat(body.fem, self.at_rest.on_body(name))
            bodies[name], at_rest[name] = body.linear(
                bodies[name], at.displacements[name], at.flows[name], heat
            )
            gap = gap + body.fem.trace @ body.fem.normal_displacement(at_rest[name])
        changes = {
            "line": replace(model.line, initial_gap=gap),
            **bodies,
            "compliance": line_compliance(**bodies),
            "path_strain": self.strain,
        }
        return LinearModel(
            **{each.name: getattr(model, each.name) for each in fields(model)} | changes
        ), at_rest

    def find_displacements(
        self,
        linear: ContactModel,
        at_rest: Mapping[str, FloatArray],
        loads: BodyLoads,
        contact: ContactSolution | None,
    ) -> dict[str, FloatArray]:
        """Displacements of the linearised bodies that yield (dofs,) [m]."""
        displacements = {}
        for name in self.bodies:
            forces = None if contact is None else contact.point_forces
            displacements[name] = at_rest[name] + loads.displacement(linear.bodies[name], linear, forces)
        return displacements

    @property
    def _free_strain(self) -> dict[str, FloatArray | float]:
        """Strain of each body at its quadrature points that takes no stress."""
        strains: dict[str, FloatArray | float] = {}
        for name, body in self.bodies.items():
            fem = body.fem
            heat = _heat(fem, self.at_rest.on_body(name))
            parts = [size * fem.free_strain[way] for way, size in heat.items()]
            strains[name] = at_quadrature_points(fem.mesh, np.sum(parts, axis=0)) if parts else 0.0
        return strains

    def _imbalance(self, name: str, flow: StressUpdate, forces: FloatArray) -> float:
        """Largest free nodal force out of balance over the largest that the elements put on a node in the step."""
        body, internal = self.bodies[name], self.bodies[name].solid.internal_forces
        residual = internal(flow.stress) - forces
        scale = max(self._scales[name], float(np.abs(internal(np.abs(flow.stress))).max()))
        return float(np.abs(residual[body.fem.free]).max()) / scale if scale > 0 else 0.0

    @cached_property
    def _scales(self) -> dict[str, float]:
        """Largest force that the elements of each body put on a node before the step, or would if kept from growing."""
        scales = {}
        for name, body in self.bodies.items():
            # what grows freely has no stress to measure by, only the one that would keep it from growing
            stresses = [
                np.abs(self.start_states[name].stress),
                body.solid.restraint_stress(self._free_strain[name]),
            ]
            scales[name] = max(float(np.abs(body.solid.internal_forces(stress)).max()) for stress in stresses)
        return scales


def _further_forces(body: ConstrainedBody, magnitudes: Mapping[LoadName, float]) -> FloatArray:
    """Balanced nodal forces of loads away from the contact line."""
    forces = (size * body.further[name] for name, size in magnitudes.items() if name in body.further)
    return body.balance_forces(sum(forces, np.zeros(body.size)))


def _heat(body: ConstrainedBody, magnitudes: Mapping[LoadName, float]) -> dict[str, float]:
    """Those of the loads that heat a body."""
    return {name: magnitudes[name] for name in body.free_strain if name in magnitudes}


def _solve_from(
    model: ContactModel, law: Law, load: PathLoad, start: ContactSolution | None
) -> ContactSolution | None:
    """Start from a neighbouring contact; if it lies too far away, from scratch."""
    try:
        return load.contact(model, law, start)
    except ConvergenceError:
        if start is None:
            raise
    return load.contact(model, law, None)


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
    most_steps : int
        Load steps that may be tried on the way to a load before the path is given up, those not solved among them; on a
        part of the way as large a part of them, but a fifth.
    """

    tolerance: float = 1e-6
    max_iterations: int = 20
    steps: int = 16
    smallest_step: float = 1e-4
    most_steps: int = 128


@dataclass(frozen=True)
class YieldingBody:
    """A body of the seal that yields: where it is touched and held, and its solid."""

    fem: ConstrainedBody

    @cached_property
    def solid(self) -> ElastoplasticBody:
        """The elastoplastic solid."""
        nodes, mesh = self.fem.temperature, self.fem.mesh
        warm = None if nodes is None else at_quadrature_points(mesh, nodes)
        return ElastoplasticBody(mesh, self.fem.material, warm)

    @cached_property
    def _to_line(self) -> tuple[csr_matrix, FloatArray]:
        """From values at the quadrature points to the points of the contact line; there the way along the face."""
        fem = self.fem
        way = np.stack([fem.normal[1], -fem.normal[0]], axis=1)
        return fem.trace @ self.solid.nodal_average[fem.contact_nodes], fem.trace @ way

    def face_strains(self, state: BodyState) -> tuple[FloatArray, FloatArray]:
        """Plastic and elastic strain in the plane of the face, along it and around the axis, both (m, 2) [-]."""
        to_line, way = self._to_line
        r, z = way.T
        elastic = np.linalg.solve(elasticity_matrix(self.fem.material), state.stress.reshape(-1, 4).T)
        plastic = state.plastic.strain.reshape(-1, 4).T
        in_plane = []
        for strain in (plastic, elastic):
            rr, zz, hoop, shear = (to_line @ part for part in strain)
            in_plane.append(np.stack([rr * r**2 + zz * z**2 + shear * r * z, hoop], axis=1))
        return in_plane[0], in_plane[1]

    def linear(
        self, elastic: CondensedBody, displacement: FloatArray, flow: StressUpdate, heat: Mapping[str, float]
    ) -> tuple[CondensedBody, FloatArray]:
        """The body linearised about a displacement (dofs,) [m], and its displacement where nothing acts on it.

        Parameters
        ----------
        elastic : CondensedBody
            The same body before it yields, which is what answers where nothing flows.
        displacement : ndarray, shape (dofs,)
            [m]
        flow : StressUpdate
            There, with its heat.
        heat : mapping
            Those loads of the body that heat it.
        """
        internal = self.solid.internal_forces(flow.stress)
        if flow.yielding.any() or elastic.solve is None:
            body = self._condense(flow, internal)
            at_rest = displacement - body.loads["stress"].response
        else:
            body = elastic
            at_rest = displacement - self.fem.remove_rigid_motion(elastic.solve(internal))
        if len(self.fem.wall):
            # back to where no press fit holds it
            at_rest = at_rest + displacement[self.fem.wall[0]] * body.loads["wall"].response
        for name, size in heat.items():
            # back to where it is cold, by the same way on which the contact heats it again
            at_rest = at_rest - size * body.loads[name].response
        return body, at_rest

    def _condense(self, flow: StressUpdate, internal: FloatArray) -> CondensedBody:
        """The body with its tangents, and what it answers to its own internal forces (dofs,) [N] as "stress"."""
        solid, wall, forces = self.solid, self.fem.wall, {"stress": internal}
        if len(wall):
            outwards = np.zeros(self.fem.size)
            outwards[wall] = 1.0
            stress = np.einsum("eqij,eqj->eqi", flow.tangent, solid.strain(outwards))
            forces["wall"] = solid.internal_forces(stress)
        body = condense_body(self.fem, self._dissected_body.condense(flow), forces)
        # how it got where it is with its heat stands in its displacement, from which this way is not counted back
        no_answer = BoundaryLoad(0.0, np.zeros(self.fem.trace.shape[0]), np.zeros(self.fem.size))
        return body.with_loads({**body.loads, **dict.fromkeys(self.fem.free_strain, no_answer)})

    @cached_property
    def _dissected_body(self) -> DissectedBody:
        return DissectedBody(self.fem, self.solid)
