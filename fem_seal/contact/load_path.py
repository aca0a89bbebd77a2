"""A seal with yielding bodies along a path of loads, and what is left of it after unloading."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.elastoplastic import BodyState
from fem_seal.bodies.fields import BodyField, elastoplastic_field
from fem_seal.contact.laws import Law
from fem_seal.contact.model import NO_LOADS, BodyLoads, ContactModel
from fem_seal.contact.plastic_step import (
    Equilibrium,
    PathLoad,
    PlasticSettings,
    YieldingBody,
    press,
    unloading_model,
)
from fem_seal.contact.solution import ContactSolution, body_fields, fields_at_rest
from fem_seal.errors import ConvergenceError, LimitLoadError, LongPathError, OpenSealError
from fem_seal.units import short_quantity


@dataclass(frozen=True)
class Imprint:
    """Permanent normal displacement of a contact face after unloading.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Arc length from first touch [m], increasing.
    depth : ndarray, shape (n,)
        How far the face has moved into its body along its normal [m], negative where it is raised.
    """

    x: FloatArray
    depth: FloatArray

    @property
    def deepest(self) -> float:
        """Greatest depth [m]; zero if the face is raised everywhere or nothing yielded."""
        return max(float(self.depth.max()), 0.0)

    @property
    def deepest_at(self) -> float:
        """Arc length of the greatest depth [m]."""
        return float(self.x[np.argmax(self.depth)])

    @property
    def rim(self) -> float:
        """Height of the rim that has been pushed up beside the imprint [m], not negative."""
        return max(-float(self.depth.min()), 0.0)

    @property
    def width(self) -> float:
        """Width at half the greatest depth [m]; zero if there is no imprint."""
        if self.deepest == 0.0:
            return 0.0
        above = self.depth - 0.5 * self.deepest
        inside = np.flatnonzero(above >= 0)
        return self._crossing(above, inside[-1], +1) - self._crossing(above, inside[0], -1)

    def _crossing(self, above: FloatArray, inside: int, step: int) -> float:
        outside = inside + step
        if not 0 <= outside < len(self.x):
            return float(self.x[inside])
        a, b = above[inside], above[outside]
        return float(self.x[inside] + (self.x[outside] - self.x[inside]) * a / (a - b))


@dataclass(frozen=True)
class Unloaded:
    """The bodies with no load on them any more but what was there before the first, such as a press fit.

    Parameters
    ----------
    at_rest : BodyLoads
        What still acts.
    bodies : mapping
        Those that yield, by name.
    before, states : mapping
        Their states before the first and after the last load, by name.
    """

    model: ContactModel = field(repr=False)
    at_rest: BodyLoads
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

    @property
    def imprints(self) -> dict[str, Imprint]:
        """Lasting imprint in the contact face of each body that has yielded."""
        return {
            name: Imprint(
                body.held.contact_x,
                body.held.normal_displacement(
                    self.states[name].displacement - self.before[name].displacement
                ),
            )
            for name, body in self.bodies.items()
            if self.states[name].plastic.accumulated.any()
        }

    @property
    def closing(self) -> float:
        """Approach by which lasting imprints have moved the faces apart along the axis, until they touch [m]."""
        line = self.model.line
        depth = sum(np.interp(line.x, one.x, one.depth) for one in self.imprints.values())
        apart = line.initial_gap + self.at_rest.opening(self.model) + depth
        return float(np.min(apart / line.normal[1])) - self.model.touch


@dataclass(frozen=True)
class OpenLoad:
    """A load of a path under which a fluid lifts the closure off.

    Parameters
    ----------
    error : OpenSealError
        Which says so.
    model : ContactModel
        Of the bodies as they were on the way to it when they last touched, see `unloading_model`.
    """

    error: OpenSealError
    model: ContactModel = field(repr=False)


@dataclass(frozen=True)
class LoadPath:
    """Contacts along a path of loads.

    Parameters
    ----------
    contacts : tuple of ElastoplasticContact
        One per load that leaves the seal closed, in the order of the path.
    unloaded : Unloaded or None
        After the last load has been taken away; None where that does not converge or was not asked for.
    stopped : ConvergenceError or None
        Why the path ends before the first load without a contact; None if all have one.
    opened : mapping of OpenLoad
        Number of each load that opens the seal. It leaves no trace: the path goes on from the load before it.
    left : bool
        Whether it was left before its end, see `load_path`.
    """

    contacts: tuple[ElastoplasticContact, ...]
    unloaded: Unloaded | None
    stopped: ConvergenceError | None = None
    opened: Mapping[int, OpenLoad] = field(default_factory=dict)
    left: bool = False


# Given the contacts so far, and why the last load has none: whether to leave the path.
Leave = Callable[[Sequence[ContactSolution], ConvergenceError | None], bool]


@dataclass(frozen=True)
class PlaceOnPath:
    """How far a path is.

    Parameters
    ----------
    number : int
        Of the load that is being reached, from 0 on; that of all loads while the last one is taken away.
    way : float
        Share of the way to it.
    steps : int
        Load steps that were taken on this way.
    step : float
        Share of the way that the next one takes.
    """

    number: int
    way: float
    steps: int
    step: float


def load_path(
    model: ContactModel,
    law: Law,
    loads: Sequence[PathLoad],
    *,
    at_rest: BodyLoads | None = None,
    settings: PlasticSettings | None = None,
    partial: bool = False,
    unload: bool = True,
    progress: Callable[[PlaceOnPath], None] | None = None,
    first: FirstLoading | None = None,
    elastic: bool = False,
    leave: Leave | None = None,
) -> LoadPath:
    """Press the closure on the seat with one load after the other, then take the load away.

    Parameters
    ----------
    model : ContactModel
        The material of "closure", "seat" or both has a hardening curve; they yield.
    law : InterfaceLaw or HardContact
    loads : sequence of PathLoad
        In the order in which they act; between them everything rises or falls evenly, and at every step on the way
        fluid and contact belong to each other. Bolts that hold one were tightened at the last one without bolts.
    at_rest : BodyLoads, optional
        What acts before the first and after the last load, such as a press fit.
    settings : PlasticSettings, optional
    partial : bool
        Whether a load that does not converge ends the path, if there is one before it; otherwise it is an error.
    unload : bool
        Whether to ask for what is left after the last load, which is a way like that up.
    progress : callable, optional
        Told after every load step how far the path is.
    first : FirstLoading, optional
        Of the same model, law and `at_rest`: the way to the first load is taken from there if nothing but a force rises
        on it.
    elastic : bool
        Whether none of the bodies need yield: one half of a gasket goes the way of the other one, which does.
    leave : callable, optional
        Asked after each load, and where one does not converge: whether the rest of the path is not worth its time. Then
        it ends there, without what is left after the last load.

    Raises
    ------
    ValueError
        If no body yields unless that is allowed, or a force is not positive and finite.
    ConvergenceError
        If the smallest load step does not converge, or steps become so short that they are too many; `partial` holds
        the path as far as it goes.

    Notes
    -----
    Plastic strain depends on the path, so every load is reached in steps. Implicit Euler is of first order in the
    size of the steps.
    """
    bodies = yielding_bodies(model) if first is None else first.bodies
    if not (bodies or elastic):
        raise ValueError("no material has a hardening curve; solve the contact with fem_seal.contact.solve")
    for load in loads:
        if load.path is None and not (math.isfinite(load.force) and load.force > 0):
            raise ValueError(f"contact_force = {load.force!r} N: must be positive and finite")
    walk = _Walk(model, bodies, law, settings or PlasticSettings(), progress or _untold)
    rest = loads[0].rest(at_rest or NO_LOADS)
    contacts: list[ElastoplasticContact] = []
    opened: dict[int, OpenLoad] = {}
    stopped, tightened = None, 0.0
    try:
        here = walk.begun(rest)
        virgin, last = here.states, rest
        try:
            for number, load in enumerate(loads):
                try:
                    if number == 0 and first is not None and load.alone:
                        reached, steps = first.at(load, walk.tell)
                    elif load.held is None:
                        reached, steps = walk.to(load.after(contacts), last, here, number)
                    else:
                        load, reached, steps = walk.held(load.after(contacts), tightened, last, here, number)
                except _Opened as found:
                    opened[number] = found.load
                    continue
                assert reached.contact is not None  # a load that does not open the seal closes it
                contacts.append(_with_bodies(reached.contact, bodies, reached, steps))
                here, last = reached, load
                if load.held is None:
                    tightened = reached.contact.approach
                if leave is not None and leave(contacts, None):
                    return LoadPath(tuple(contacts), None, None, opened, left=True)
        except ConvergenceError as error:
            if not (partial and contacts):
                raise
            stopped = error
            if leave is not None and leave(contacts, error):
                return LoadPath(tuple(contacts), None, stopped, opened, left=True)
        if not unload:
            return LoadPath(tuple(contacts), None, stopped, opened)
        here = walk.unloaded(rest.after(contacts), last, here, len(loads))
    except ConvergenceError as error:
        path = LoadPath(tuple(contacts), None, stopped or error, opened)
        raise ConvergenceError(str(error), partial=path) from error
    unloaded = Unloaded(model, rest.further, bodies, virgin, here.states)
    return LoadPath(tuple(contacts), unloaded, stopped, opened)


def _with_bodies(
    contact: ContactSolution, bodies: Mapping[str, YieldingBody], reached: Equilibrium, steps: int
) -> ElastoplasticContact:
    return ElastoplasticContact(
        **{entry.name: getattr(contact, entry.name) for entry in fields(contact)},
        bodies=bodies,
        states=reached.states,
        equilibrium_residuals=reached.residuals,
        load_steps=steps,
        linear=reached.linear,
    )


@dataclass(frozen=True)
class FirstLoading:
    """New bodies under any one force, on one path of rising force.

    Parameters
    ----------
    model : ContactModel
    law : InterfaceLaw or HardContact
    at_rest : BodyLoads
        What acts before the first load.

    Notes
    -----
    A path to one force and that to a larger one have the way to the smaller one in common. So the first force is
    reached from zero, and each other one from the nearest step below it, in steps that are as short, as a share of the
    force, as those from zero. Those of the lower half of the first way are too long for that and are forgotten: a
    force below them begins at zero again. Which steps a force has behind it depends on those that were asked before,
    and its contact by as much as on the size of the steps.
    """

    model: ContactModel = field(repr=False)
    law: Law
    at_rest: BodyLoads = NO_LOADS
    _passed: list[_Passed] = field(default_factory=list, init=False, repr=False)

    @cached_property
    def bodies(self) -> dict[str, YieldingBody]:
        """Those that yield, by name."""
        return yielding_bodies(self.model)

    def at(
        self, load: PathLoad, progress: Callable[[PlaceOnPath], None] | None = None
    ) -> tuple[Equilibrium, int]:
        """The balance under one load, and how many steps led to it.

        Parameters
        ----------
        load : PathLoad
            Which is `alone`.
        progress : callable, optional
            Told after every load step how far the way is.

        Raises
        ------
        ConvergenceError
            If the smallest load step does not converge.
        """
        walk = _Walk(self.model, self.bodies, self.law, PlasticSettings(), progress or _untold)
        # the last step is one that leads there, so that the bodies are linearised as they yield
        below = [one for one in self._passed if one.load.force < load.force]
        if not below:
            self._passed.clear()
        further = len(below) == len(self._passed)
        rest = load.rest(self.at_rest)
        begin = below[-1] if below else _Passed(rest, walk.begun(rest), 0)
        steps: list[_Passed] = []

        def passed(at: PathLoad, here: Equilibrium) -> None:
            # linearised bodies take most of the memory, and nothing starts from them
            steps.append(_Passed(at, replace(here, linear=None), begin.steps + len(steps) + 1))

        try:
            here, more = walk.to(load, begin.load, begin.here, 0, passed)
        finally:
            if further and steps:
                lowest = 0.0 if below else 0.5 * steps[-1].load.force
                self._passed.extend(one for one in steps if one.load.force >= lowest)
        return here, begin.steps + more

    @property
    def highest(self) -> float | None:
        """The largest force that has been reached [N]; None before the first."""
        return self._passed[-1].load.force if self._passed else None


@dataclass(frozen=True)
class _Passed:
    """A load on the way, the balance under it, and the steps from zero on."""

    load: PathLoad
    here: Equilibrium
    steps: int


def _untold(place: PlaceOnPath) -> None:
    """Nobody is told how far a path is."""


# Accuracy of the force of bolts, of their preload, and the most ways to it.
_HELD, _WAYS = 1e-6, 12
# A step that takes so many times its part of the way to a stop is halved.
_LEAP = 1.5
# Share of the way to a load from which on the bodies are near enough to those that it would part.
_NEAR_OPENING = 0.02
# Plastic strain of a body that does not harden any more and carries the load by nothing but its small elastic rest.
_COLLAPSED = 10.0
# A little more load brings bodies that yield through so many times as near to each other as elastic ones: beyond what a
# contact in the fully plastic range does, or where so much of a body has yielded.
_GIVES_WAY, _GIVES_WAY_WHOLE, _WHOLE = 20.0, 5.0, 0.9
# Part of the steps of a whole way that its beginning may take.
_AT_LEAST = 0.2
# What keeps a step from being solved; a smaller one may be.
_FAILURES = (ConvergenceError, OpenSealError, FloatingPointError, RuntimeError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class _Walk:
    model: ContactModel
    bodies: Mapping[str, YieldingBody]
    law: Law
    settings: PlasticSettings
    tell: Callable[[PlaceOnPath], None]

    def begun(self, rest: PathLoad) -> Equilibrium:
        """New bodies with what acts on them before the first load."""
        virgin = Equilibrium({name: body.solid.virgin for name, body in self.bodies.items()}, None, ())
        return virgin if rest.further == NO_LOADS else self.to(rest, rest.rest(NO_LOADS), virgin)[0]

    def to(
        self,
        end: PathLoad,
        begin: PathLoad,
        here: Equilibrium,
        number: int | None = None,
        passed: Callable[[PathLoad, Equilibrium], None] | None = None,
    ) -> tuple[Equilibrium, int]:
        """Walk from one load to another in steps, halved where they do not converge; also how many.

        Told is how far it is, if the load has a number; `passed` gets every step.

        With a stop none along which something flows takes more of the way to it than one of all steps would, and from
        there on a larger load changes nothing but the force of the stop.

        While nothing flows, steps become longer: elastic bodies forget how they came. That takes that nothing flows at
        the end of one, nor where it would end if all went on as before; else it is taken back. A step under which the
        fluid lifts the closure off is halved, too: from far away it may do so because the bodies are not yet those of
        the step's end.
        """
        begin = begin.relieved(here)
        share = begin.change(end, self.model.initial_contact_radius)
        usual = step = 1 / max(1, math.ceil(share * self.settings.steps * (1 - 1e-9)))
        way, steps, tried, stood = 0.0, 0, 0, self._way_to_stop(here)
        earlier, taken = None, 1.0
        while way < 1:
            if (beyond := end.past_stop(here)) is not None:
                return beyond, steps
            if tried >= self.settings.most_steps * max(way, self._way_to_stop(here) - stood, _AT_LEAST):
                raise self._takes_too_many(begin.between(end, way), end, here, way, tried, step)
            tried += 1
            if number is not None:
                self.tell(PlaceOnPath(number, way, steps, step))
            aim = way + step if way + 1.5 * step < 1 else 1.0
            load = begin.between(end, aim)
            guess = None if earlier is None else here.ahead(earlier, (aim - way) / taken)
            try:
                reached = self._press(load, here, guess, elastic=step > usual)
            except _FAILURES as error:
                if step > usual:
                    step = usual
                    continue
                step = (aim - way) / 2
                smallest = step < self.settings.smallest_step
                if isinstance(error, OpenSealError) and (smallest or step < _NEAR_OPENING):
                    opened = self._open_load(end, here, error)
                    if smallest or opened.error is not error:
                        raise _Opened(opened, here) from error
                if not smallest:
                    continue
                raise self._gave_up(begin.between(end, way), load, here, error) from error
            if reached.plastic_strain > _COLLAPSED:
                raise self._yielded_through(begin.between(end, way), reached)
            nearer = self._way_to_stop(reached) - self._way_to_stop(here)
            if reached.flowed and nearer * self.settings.steps > _LEAP:
                usual = step = (aim - way) / 2
                continue
            earlier, taken = here, aim - way
            step = min(2 * step, usual) if reached.flowed else 2 * step
            here, way, steps = reached, aim, steps + 1
            if passed is not None:
                passed(load, here)
        return here, steps

    def _way_to_stop(self, here: Equilibrium) -> float:
        """How far bodies have come nearer to a stop, as a share of all that they can; 0 without one."""
        room = self.model.stop - self.model.touch
        return 0.0 if here.contact is None or room <= 0.0 else here.contact.closing / room

    def held(
        self, load: PathLoad, tightened: float, begin: PathLoad, here: Equilibrium, number: int
    ) -> tuple[PathLoad, Equilibrium, int]:
        """Walk to a load that bolts hold, to the force that the linearised bodies leave them, until this is the same.

        A body that yields more than it does when linearised is corrected by a way of its own, some parts in a thousand
        of the load: what the last ways add to its history is as small.
        """
        steps, last = 0, begin
        for _ in range(_WAYS):
            try:
                aim = load.balanced(here, self.law, tightened)
            except OpenSealError as error:
                raise _Opened(self._open_load(load, here, error), here) from error
            assert load.held is not None  # of all who ask
            if last is not begin and abs(aim.force - last.force) <= _HELD * load.held.preload:
                return last, here, steps
            here, more = self.to(aim, last, here, number)
            last, steps = aim, steps + more
        raise ConvergenceError("the force of the bolts and the path of the bodies that yield do not converge")

    def unloaded(self, rest: PathLoad, last: PathLoad, here: Equilibrium, number: int) -> Equilibrium:
        """Walk from the last load to where the bodies are apart; at once from where a fluid parts them on the way."""
        try:
            return self.to(rest, last, here, number)[0]
        except _Opened as opened:
            return self.to(rest, rest, opened.reached)[0]

    def _press(
        self, load: PathLoad, here: Equilibrium, guess: Mapping[str, FloatArray] | None, *, elastic: bool
    ) -> Equilibrium:
        with np.errstate(over="raise", invalid="raise", divide="raise", under="ignore"):
            return press(
                self.model,
                self.bodies,
                self.law,
                load,
                here.states,
                settings=self.settings,
                start=here.contact,
                guess=guess,
                elastic=elastic,
            )

    def _open_load(self, load: PathLoad, reached: Equilibrium, error: OpenSealError) -> OpenLoad:
        """What is said of a load by the bodies as they last touched; what was said on the way if they are closed."""
        model = unloading_model(self.model, self.bodies, reached.states, load.further)
        try:
            load.contact(model, self.law, reached.contact)
        except OpenSealError as of_load:
            return OpenLoad(of_load, model)
        except ConvergenceError:
            pass
        return OpenLoad(error, model)

    def _gave_up(self, at: PathLoad, aim: PathLoad, here: Equilibrium, error: Exception) -> ConvergenceError:
        """What is said of a load step that is as small as can be and not solved."""
        if self._gives_way(at, aim, here):
            return self._yielded_through(at, here)
        why = error if isinstance(error, ConvergenceError) else "what flows has no stiffness left"
        return ConvergenceError(
            f"elastoplastic contact: the load step from {at} to {aim} does not converge: {why}. The body may be "
            "near its limit load: lower the load, give a stress_strain table that hardens, or take a thicker body; "
            "else refine [mesh] contact_size"
        )

    def _takes_too_many(
        self, at: PathLoad, end: PathLoad, here: Equilibrium, way: float, tried: int, step: float
    ) -> ConvergenceError:
        """What is said of a way whose load steps have become so short that it would never end."""
        if self._gives_way(at, at.between(end, step), here):
            return self._yielded_through(at, here)
        flows = ""
        if (strain := here.plastic_strain) > 0:
            body = max(here.states, key=lambda name: float(here.states[name].plastic.accumulated.max()))
            label = self.model.bodies[body].held.label
            flows = f"The {label} flows in one place there, to a plastic strain of {100 * strain:.2g} %. "
        return LongPathError(
            f"{short_quantity('force', at.force)} of {short_quantity('force', end.force)} are reached after "
            f"{tried} load steps that were tried, {100 * way:.2g} % of the way; the next one could be no longer "
            f"than {100 * step:.2g} % of it. "
            f"{flows}Lower the load, round the edge that is pressed in more, or give a stress_strain table that hardens"
        )

    def _gives_way(self, at: PathLoad, aim: PathLoad, here: Equilibrium) -> bool:
        """Whether bodies linearised as they flow come so much nearer in a step that they bear nothing more."""
        if not here.states or here.linear is None or here.contact is None:
            return False
        elastic = unloading_model(self.model, self.bodies, here.states, at.further)
        try:
            ends = [aim.contact(one, self.law, here.contact) for one in (here.linear, elastic)]
        except _FAILURES:
            return False
        flowing, springy = (0.0 if one is None else one.approach - here.contact.approach for one in ends)
        whole = max(_yielded_share(state) for state in here.states.values()) > _WHOLE
        return springy > 0 and flowing > (_GIVES_WAY_WHOLE if whole else _GIVES_WAY) * springy

    def _yielded_through(self, at: PathLoad, here: Equilibrium) -> LimitLoadError:
        body = max(here.states, key=lambda name: _yielded_share(here.states[name]))
        label = self.model.bodies[body].held.label
        return LimitLoadError(
            f"the {label} yields through: it bears {short_quantity('force', at.force)} and flows without "
            "limit under more. Lower the load, give a stress_strain table that hardens, or take a thicker body",
            label,
        )


class _Opened(Exception):
    """A load opens the seal on the way to it; `reached` is where the bodies last touched."""

    def __init__(self, load: OpenLoad, reached: Equilibrium) -> None:
        super().__init__(str(load.error))
        self.load = load
        self.reached = reached


def _yielded_share(state: BodyState) -> float:
    return float((state.plastic.accumulated > 0).mean())


def yielding_bodies(model: ContactModel) -> dict[str, YieldingBody]:
    """Those bodies of a seal whose materials have a hardening curve, by name; empty if the seal is elastic."""
    return {
        name: YieldingBody(body.held)
        for name, body in model.bodies.items()
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
    linear : ContactModel or None
        The bodies linearised at this load: what they answer to a small change of it, or of the interface law.
    """

    bodies: Mapping[str, YieldingBody] = field(repr=False)
    states: Mapping[str, BodyState] = field(repr=False)
    equilibrium_residuals: tuple[float, ...] = field(repr=False)
    load_steps: int = 1
    linear: ContactModel | None = field(default=None, repr=False)

    @cached_property
    def unloading(self) -> ContactModel:
        """The bodies as they answer to less load, see `fem_seal.contact.plastic_step.unloading_model`."""
        return unloading_model(self.model, self.bodies, self.states, self.loads)

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Displacement and stress of "closure" and "seat"; of bodies that yield with their plastic strain."""
        return body_fields(self) | {
            name: elastoplastic_field(
                body.held, body.solid, self.states[name], self.profile, self.loads.temperature.get(name)
            )
            for name, body in self.bodies.items()
        }
