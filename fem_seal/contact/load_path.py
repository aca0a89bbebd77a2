"""A seal with yielding bodies along a path of loads, and what is left of it after unloading."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property

import numpy as np

from fem_seal.bodies.elastoplastic import BodyState
from fem_seal.bodies.fields import BodyField, elastoplastic_field
from fem_seal.contact.imprint import Imprint
from fem_seal.contact.laws import Law
from fem_seal.contact.model import ContactModel
from fem_seal.contact.other_loads import NO_LOADS, FurtherLoads
from fem_seal.contact.plastic_step import Equilibrium, PlasticSettings, YieldingBody, press
from fem_seal.contact.solution import ContactSolution, body_fields, fields_at_rest
from fem_seal.errors import ConvergenceError


@dataclass(frozen=True)
class Unloaded:
    """The bodies with no load on them any more but what was there before the first, such as a press fit.

    Parameters
    ----------
    at_rest : FurtherLoads
        What still acts.
    bodies : mapping
        Those that yield, by name.
    before, states : mapping
        Their states before the first and after the last load, by name.
    """

    model: ContactModel = field(repr=False)
    at_rest: FurtherLoads
    bodies: Mapping[str, YieldingBody] = field(repr=False)
    before: Mapping[str, BodyState] = field(repr=False)
    states: Mapping[str, BodyState] = field(repr=False)

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Lasting displacement and residual stress of "closure" and "seat"; plastic strain of those that yield."""
        return fields_at_rest(self.model, self.at_rest) | {
            name: elastoplastic_field(
                body.held, body.solid, self.states[name], temperature=self.at_rest.temperature.get(name)
            )
            for name, body in self.bodies.items()
        }

    @cached_property
    def imprints(self) -> dict[str, Imprint]:
        """Lasting imprint in the contact face of each body that has yielded."""
        return {
            name: Imprint(
                body.held.contact_x,
                body.held.retreat(self.states[name].displacement - self.before[name].displacement),
            )
            for name, body in self.bodies.items()
            if self.states[name].plastic.accumulated.any()
        }


@dataclass(frozen=True)
class LoadPath:
    """Contacts along a path of loads.

    Parameters
    ----------
    contacts : tuple of ElastoplasticContact
        One per load, in the order of the path.
    unloaded : Unloaded
        After the last load has been taken away.
    stopped : ConvergenceError or None
        Why the path ends before the first load without a contact; None if all have one.
    """

    contacts: tuple[ElastoplasticContact, ...]
    unloaded: Unloaded
    stopped: ConvergenceError | None = None


@dataclass(frozen=True)
class PathLoad:
    """What acts on the seal at one place of its path.

    Parameters
    ----------
    axial_force : float
        F_N that the solid contact carries [N].
    further : FurtherLoads
        What else acts on the bodies.
    """

    axial_force: float
    further: FurtherLoads = NO_LOADS


def load_path(
    model: ContactModel,
    law: Law,
    loads: Sequence[PathLoad],
    *,
    at_rest: FurtherLoads | None = None,
    settings: PlasticSettings | None = None,
    partial: bool = False,
) -> LoadPath:
    """Press the closure on the seat with one load after the other, then take the load away.

    Parameters
    ----------
    model : ContactModel
        The material of "closure", "seat" or both has a hardening curve; they yield.
    law : InterfaceLaw or HardContact
    loads : sequence of PathLoad
        In the order in which they act, forces positive; between them everything rises or falls evenly.
    at_rest : FurtherLoads, optional
        What acts before the first and after the last load, such as a press fit.
    settings : PlasticSettings, optional
    partial : bool
        Whether a load that does not converge ends the path, if there is one before it; otherwise it is an error.

    Raises
    ------
    ValueError
        If no body yields, or a force is not positive and finite.
    ConvergenceError
        If the smallest load step does not converge; `partial` holds the contacts solved before.

    Notes
    -----
    Plastic strain depends on the path, so every load is reached in steps. Implicit Euler is of first order in the
    size of the steps.
    """
    bodies = yielding_bodies(model)
    if not bodies:
        raise ValueError("no material has a hardening curve; solve the contact with fem_seal.contact.solve")
    for load in loads:
        if not (math.isfinite(load.axial_force) and load.axial_force > 0):
            raise ValueError(f"axial_force = {load.axial_force!r} N: must be positive and finite")
    walk = _Walk(model, bodies, law, settings or PlasticSettings())
    rest = PathLoad(0.0, at_rest or NO_LOADS)
    contacts: list[ElastoplasticContact] = []
    here = Equilibrium({name: body.solid.virgin for name, body in bodies.items()}, None, ())
    stopped = None
    try:
        here, _ = walk.to(rest, PathLoad(0.0), here)
        virgin, last = here.states, rest
        try:
            for load in loads:
                here, steps = walk.to(load, last, here)
                assert here.contact is not None  # a positive force closes the seal
                contacts.append(_with_bodies(here.contact, bodies, here, steps))
                last = load
        except ConvergenceError as error:
            if not (partial and contacts):
                raise
            stopped = error
        here, _ = walk.to(rest, last, here)
    except ConvergenceError as error:
        raise ConvergenceError(str(error), partial=tuple(contacts)) from error
    return LoadPath(tuple(contacts), Unloaded(model, rest.further, bodies, virgin, here.states), stopped)


def _with_bodies(
    contact: ContactSolution, bodies: Mapping[str, YieldingBody], reached: Equilibrium, steps: int
) -> ElastoplasticContact:
    return ElastoplasticContact(
        **{entry.name: getattr(contact, entry.name) for entry in fields(contact)},
        bodies=bodies,
        states=reached.states,
        equilibrium_residuals=reached.residuals,
        load_steps=steps,
    )


@dataclass(frozen=True)
class _Walk:
    model: ContactModel
    bodies: Mapping[str, YieldingBody]
    law: Law
    settings: PlasticSettings

    def to(self, end: PathLoad, begin: PathLoad, here: Equilibrium) -> tuple[Equilibrium, int]:
        """Walk from one load to another in steps, halved where they do not converge; also their number."""
        scale = max(begin.axial_force, end.axial_force)
        share = abs(end.axial_force - begin.axial_force) / scale if scale > 0 else 0.0
        largest = step = 1 / max(1, math.ceil(share * self.settings.steps * (1 - 1e-9)))
        way, steps = 0.0, 0
        while way < 1:
            aim = way + step if way + 1.5 * step < 1 else 1.0
            load = _between(begin, end, aim)
            try:
                with np.errstate(over="raise", invalid="raise", divide="raise", under="ignore"):
                    here = press(
                        self.model,
                        self.bodies,
                        self.law,
                        load.axial_force,
                        here.states,
                        loads=load.further,
                        settings=self.settings,
                        start=here.contact,
                    )
            except (ConvergenceError, FloatingPointError, RuntimeError, np.linalg.LinAlgError) as error:
                step = (aim - way) / 2
                if step < self.settings.smallest_step:
                    raise ConvergenceError(_gave_up(_between(begin, end, way), load, error)) from error
                continue
            way, steps, step = aim, steps + 1, min(2 * step, largest)
        return here, steps


def _between(begin: PathLoad, end: PathLoad, way: float) -> PathLoad:
    """Load a share `way` of the way from one load to another."""

    def mixed(first: Mapping[str, float], second: Mapping[str, float]) -> dict[str, float]:
        return {
            name: (1 - way) * first.get(name, 0.0) + way * second.get(name, 0.0) for name in {*first, *second}
        }

    a, b = begin.further, end.further
    shares = [
        share * load.gap_pressure for share, load in ((1 - way, a), (way, b)) if load.gap_pressure is not None
    ]
    return PathLoad(
        (1 - way) * begin.axial_force + way * end.axial_force,
        FurtherLoads(
            mixed(a.closure, b.closure),
            mixed(a.seat, b.seat),
            np.sum(shares, axis=0) if shares else None,
            b.temperature or a.temperature,
        ),
    )


def _gave_up(reached: PathLoad, aim: PathLoad, error: Exception) -> str:
    return (
        f"elastoplastic contact: the load step from {reached.axial_force:.6g} N to {aim.axial_force:.6g} N axial force "
        f"does not converge: {error}. The body may be near its limit load: lower the load, give a stress_strain table "
        "that hardens, or take a thicker body; else refine [mesh] contact_size"
    )


def yielding_bodies(model: ContactModel) -> dict[str, YieldingBody]:
    """Those bodies of a seal whose materials have a hardening curve, by name; empty if the seal is elastic."""
    return {
        body.held.name: YieldingBody(body.held)
        for body in (model.closure, model.seat)
        if body.material.hardening is not None
    }


@dataclass(frozen=True, kw_only=True, repr=False)
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
            name: elastoplastic_field(
                body.held, body.solid, self.states[name], self.profile, self.loads.temperature.get(name)
            )
            for name, body in self.bodies.items()
        }
