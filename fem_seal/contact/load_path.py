"""A seal with yielding bodies along a path of loads, and what is left of it after unloading."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.elastoplastic import BodyState
from fem_seal.bodies.fields import BodyField, elastoplastic_field
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.model import NO_LOADS, BodyLoads, ContactModel
from fem_seal.contact.plastic_step import (
    Equilibrium,
    Flattening,
    LinearModel,
    PathLoad,
    PlasticSettings,
    YieldingBody,
    press,
    strain_on_path,
    strain_size,
    unloading_model,
)
from fem_seal.contact.solution import ContactSolution, body_fields, fields_at_rest
from fem_seal.errors import ConvergenceError, LimitLoadError, LongPathError, OpenSealError
from fem_seal.files import problem

if TYPE_CHECKING:
    from leak.flow.turned_contact import FaceContact


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
        excess = self.depth - 0.5 * self.deepest
        points = np.flatnonzero(excess >= 0)
        return self._find_crossing(excess, points[-1], +1) - self._find_crossing(excess, points[0], -1)

    def _find_crossing(self, excess: FloatArray, point: int, step: int) -> float:
        neighbour = point + step
        if not 0 <= neighbour < len(self.x):
            return float(self.x[point])
        a, b = excess[point], excess[neighbour]
        return float(self.x[point] + (self.x[neighbour] - self.x[point]) * a / (a - b))


@dataclass(frozen=True)
class UnloadedBodies:
    """The bodies with no load on them any more but what was there before the first, such as a press fit.

    Parameters
    ----------
    at_rest : BodyLoads
        What still acts.
    bodies : mapping
        Those that yield, by name.
    initial_states, states : mapping
        Their states before the first and after the last load, by name.
    """

    model: ContactModel = field(repr=False)
    at_rest: BodyLoads
    bodies: Mapping[str, YieldingBody] = field(repr=False)
    initial_states: Mapping[str, BodyState] = field(repr=False)
    states: Mapping[str, BodyState] = field(repr=False)

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Lasting displacement and residual stress of "closure" and "seat"; plastic strain of those that yield."""
        return fields_at_rest(self.model, self.at_rest) | {
            name: elastoplastic_field(
                body.fem, body.solid, self.states[name], temperature=self.at_rest.temperature.get(name)
            )
            for name, body in self.bodies.items()
        }

    @property
    def imprints(self) -> dict[str, Imprint]:
        """Lasting imprint in the contact face of each body that has yielded."""
        return {
            name: Imprint(
                body.fem.contact_x,
                body.fem.normal_displacement(
                    self.states[name].displacement - self.initial_states[name].displacement
                ),
            )
            for name, body in self.bodies.items()
            if self.states[name].plastic.accumulated_strain.any()
        }

    @property
    def closing_approach(self) -> float:
        """Approach by which lasting imprints have moved the faces apart along the axis, until they touch [m]."""
        line = self.model.line
        depth = sum(np.interp(line.x, imprint.x, imprint.depth) for imprint in self.imprints.values())
        gap = line.initial_gap + self.at_rest.opening(self.model) + depth
        return float(np.min(gap / line.normal[1])) - self.model.touch


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
    unloaded_bodies : UnloadedBodies or None
        After the last load has been taken away; None where that does not converge or was not asked for.
    failure : ConvergenceError or None
        Why the path ends before the first load without a contact; None if all have one.
    open_loads : mapping of OpenLoad
        Number of each load that opens the seal. It leaves no trace: the path goes on from the load before it.
    was_left : bool
        Whether it was left before its end, see `load_path`.
    """

    contacts: tuple[ElastoplasticContact, ...]
    unloaded_bodies: UnloadedBodies | None
    failure: ConvergenceError | None = None
    open_loads: Mapping[int, OpenLoad] = field(default_factory=dict)
    was_left: bool = False


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
    first_loading: FirstLoading | None = None,
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
    first_loading : FirstLoading, optional
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
    bodies = yielding_bodies(model) if first_loading is None else first_loading.bodies
    if not (bodies or elastic):
        raise ValueError("no material has a hardening curve; solve the contact with fem_seal.contact.solve")
    for load in loads:
        if load.path is None and not (math.isfinite(load.force) and load.force > 0):
            raise ValueError(f"contact_force = {load.force!r} N: must be positive and finite")
    walk = _Walk(model, bodies, law, settings or PlasticSettings(), progress or _ignore_place)
    rest = loads[0].without_force(at_rest or NO_LOADS)
    contacts: list[ElastoplasticContact] = []
    open_loads: dict[int, OpenLoad] = {}
    failure, bolted_at = None, 0.0
    try:
        balance = walk.begin(rest)
        virgin, last = balance.states, rest
        try:
            for number, load in enumerate(loads):
                try:
                    if number == 0 and first_loading is not None and load.alone:
                        arrival, steps = first_loading.at(load, walk.tell)
                    elif load.bolts is None:
                        arrival, steps = walk.reach(load.after_contacts(contacts), last, balance, number)
                    else:
                        load = load.after_contacts(contacts)
                        load, arrival, steps = walk.hold(load, bolted_at, last, balance, number)
                except _OpenedSeal as opening:
                    open_loads[number] = opening.load
                    continue
                assert arrival.contact is not None  # a load that does not open the seal closes it
                contacts.append(_with_bodies(arrival.contact, bodies, arrival, steps))
                balance, last = arrival, load
                if load.bolts is None:
                    bolted_at = arrival.contact.approach
                if leave is not None and leave(contacts, None):
                    return LoadPath(tuple(contacts), None, None, open_loads, was_left=True)
        except ConvergenceError as error:
            if not (partial and contacts):
                raise
            failure = error
            if leave is not None and leave(contacts, error):
                return LoadPath(tuple(contacts), None, failure, open_loads, was_left=True)
        if not unload:
            return LoadPath(tuple(contacts), None, failure, open_loads)
        balance = walk.unload(rest.after_contacts(contacts), last, balance, len(loads))
    except ConvergenceError as error:
        path = LoadPath(tuple(contacts), None, failure or error, open_loads)
        raise ConvergenceError(error.args[0], partial=path) from error
    unloaded_bodies = UnloadedBodies(model, rest.further, bodies, virgin, balance.states)
    return LoadPath(tuple(contacts), unloaded_bodies, failure, open_loads)


def _with_bodies(
    contact: ContactSolution, bodies: Mapping[str, YieldingBody], balance: Equilibrium, steps: int
) -> ElastoplasticContact:
    return ElastoplasticContact(
        **{entry.name: getattr(contact, entry.name) for entry in fields(contact)},
        bodies=bodies,
        states=balance.states,
        equilibrium_residuals=balance.residuals,
        load_steps=steps,
        linear=balance.linear,
        flattening=balance.flattening,
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
    _steps: list[_LoadStep] = field(default_factory=list, init=False, repr=False)

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
        walk = _Walk(self.model, self.bodies, self.law, PlasticSettings(), progress or _ignore_place)
        # the last step is one that leads there, so that the bodies are linearised as they yield
        steps_below = [step for step in self._steps if step.load.force < load.force]
        if not steps_below:
            self._steps.clear()
        further = len(steps_below) == len(self._steps)
        rest = load.without_force(self.at_rest)
        begin = steps_below[-1] if steps_below else _LoadStep(rest, walk.begin(rest), 0)
        steps: list[_LoadStep] = []

        def keep_step(at: PathLoad, balance: Equilibrium) -> None:
            # linearised bodies take most of the memory, and nothing starts from them
            steps.append(_LoadStep(at, replace(balance, linear=None), begin.steps + len(steps) + 1))

        try:
            balance, added_steps = walk.reach(load, begin.load, begin.balance, 0, keep_step)
        finally:
            if further and steps:
                lowest_force = 0.0 if steps_below else 0.5 * steps[-1].load.force
                self._steps.extend(step for step in steps if step.load.force >= lowest_force)
        return balance, begin.steps + added_steps

    @property
    def highest_force(self) -> float | None:
        """The largest force that has been reached [N]; None before the first."""
        return self._steps[-1].load.force if self._steps else None


@dataclass(frozen=True)
class _LoadStep:
    """A load on the way, the balance under it, and the steps from zero on."""

    load: PathLoad
    balance: Equilibrium
    steps: int


def _ignore_place(place: PlaceOnPath) -> None:
    """Do nothing with the place on a path."""


# Accuracy of the force of bolts, of their preload, and the most ways to it.
_ACCURACY, _WAYS = 1e-6, 12
# A step that takes so many times its part of the way to a stop is halved.
_LEAP = 1.5
# Share of the way to a load from which on the bodies are near enough to those that it would part.
_NEAR_OPENING = 0.02
# Plastic strain of a body that does not harden any more and carries the load by nothing but its small elastic rest.
_COLLAPSE_STRAIN = 10.0
# A little more load brings bodies that yield through so many times as near to each other as elastic ones: beyond what a
# contact in the fully plastic range does, or where so much of a body has yielded.
_GIVES_WAY, _GIVES_WAY_WHOLE, _WHOLE_SHARE = 20.0, 5.0, 0.9
# Steps that unloading takes are longer by this factor.
_UNLOADED_BY = 4
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

    def begin(self, rest: PathLoad) -> Equilibrium:
        """Equilibrium of new bodies under what acts before the first load."""
        flattening = {name: Flattening.none(len(self.model.line.x)) for name in self.bodies}
        states = {name: body.solid.virgin for name, body in self.bodies.items()}
        virgin = Equilibrium(states, None, (), flattening=flattening)
        if rest.further == NO_LOADS:
            return virgin
        return self.reach(rest, rest.without_force(NO_LOADS), virgin)[0]

    def reach(
        self,
        end: PathLoad,
        begin: PathLoad,
        balance: Equilibrium,
        number: int | None = None,
        on_step: Callable[[PathLoad, Equilibrium], None] | None = None,
    ) -> tuple[Equilibrium, int]:
        """Walk from one load to another in steps, halved where they do not converge; also how many.

        Told is how far it is, if the load has a number; `on_step` gets every step.

        With a stop none along which something flows takes more of the way to it than one of all steps would, and from
        there on a larger load changes nothing but the force of the stop.

        While nothing flows, steps become longer: elastic bodies forget how they came. That takes that nothing flows at
        the end of one, nor where it would end if all went on as before; else it is taken back. A step under which the
        fluid lifts the closure off is halved, too: from far away it may do so because the bodies are not yet those of
        the step's end.
        """
        begin = begin.without_stop(balance)
        share = begin.change(end, self.model.initial_contact_radius)
        usual = step = 1 / max(1, math.ceil(share * self.settings.steps * (1 - 1e-9)))
        way, steps, tries, room = 0.0, 0, 0, self._way_to_stop(balance)
        earlier, last_step = None, 1.0
        while way < 1:
            if (at_stop := end.past_stop(balance)) is not None:
                return at_stop, steps
            if tries >= self.settings.most_steps * max(way, self._way_to_stop(balance) - room, _AT_LEAST):
                raise self._too_many_steps(begin.interpolate(end, way), end, balance, way, tries, step)
            tries += 1
            if number is not None:
                self.tell(PlaceOnPath(number, way, steps, step))
            aim = way + step if way + 1.5 * step < 1 else 1.0
            load = begin.interpolate(end, aim)
            guess = None if earlier is None else balance.extrapolate(earlier, (aim - way) / last_step)
            try:
                arrival = self._press(load, balance, guess, elastic=step > usual)
            except _FAILURES as error:
                if step > usual:
                    step = usual
                    continue
                step = (aim - way) / 2
                is_smallest = step < self.settings.smallest_step
                if isinstance(error, OpenSealError) and (is_smallest or step < _NEAR_OPENING):
                    open_load = self._open_load(end, balance, error)
                    if is_smallest or open_load.error is not error:
                        raise _OpenedSeal(open_load, balance) from error
                if not is_smallest:
                    continue
                raise self._failure(begin.interpolate(end, way), load, balance, error) from error
            if arrival.plastic_strain > _COLLAPSE_STRAIN:
                raise self._limit_load(begin.interpolate(end, way), arrival)
            nearer = self._way_to_stop(arrival) - self._way_to_stop(balance)
            if arrival.has_flowed and nearer * self.settings.steps > _LEAP:
                usual = step = (aim - way) / 2
                continue
            earlier, last_step = balance, aim - way
            step = min(2 * step, usual) if arrival.has_flowed else 2 * step
            balance, way, steps = arrival, aim, steps + 1
            if on_step is not None:
                on_step(load, balance)
        return balance, steps

    def _way_to_stop(self, balance: Equilibrium) -> float:
        """How far bodies have come nearer to a stop, as a share of all that they can; 0 without one."""
        room = self.model.stop - self.model.touch
        return 0.0 if balance.contact is None or room <= 0.0 else balance.contact.face_approach / room

    def hold(
        self, load: PathLoad, bolted_at: float, begin: PathLoad, balance: Equilibrium, number: int
    ) -> tuple[PathLoad, Equilibrium, int]:
        """Walk to a load that bolts hold, to the force that the linearised bodies leave them, until this is the same.

        A body that yields more than it does when linearised is corrected by a way of its own, some parts in a thousand
        of the load: what the last ways add to its history is as small.
        """
        steps, last = 0, begin
        for _ in range(_WAYS):
            try:
                aim = load.balance_bolts(balance, self.law, bolted_at)
            except OpenSealError as error:
                raise _OpenedSeal(self._open_load(load, balance, error), balance) from error
            assert load.bolts is not None  # of all who ask
            if last is not begin and abs(aim.force - last.force) <= _ACCURACY * load.bolts.preload:
                return last, balance, steps
            balance, added_steps = self.reach(aim, last, balance, number)
            last, steps = aim, steps + added_steps
        raise ConvergenceError("the force of the bolts and the path of the bodies that yield do not converge")

    def unload(self, rest: PathLoad, last: PathLoad, balance: Equilibrium, number: int) -> Equilibrium:
        """Walk from the last load to where the bodies are apart; at once from where a fluid parts them on the way.

        In longer steps, since hardly anything flows.
        """
        walk = replace(
            self, settings=replace(self.settings, steps=math.ceil(self.settings.steps / _UNLOADED_BY))
        )
        try:
            return walk.reach(rest, last, balance, number)[0]
        except _OpenedSeal as opening:
            return walk.reach(rest, rest, opening.last_touch)[0]

    def _press(
        self, load: PathLoad, balance: Equilibrium, guess: Mapping[str, FloatArray] | None, *, elastic: bool
    ) -> Equilibrium:
        with np.errstate(over="raise", invalid="raise", divide="raise", under="ignore"):
            arrival = press(
                self.model,
                self.bodies,
                self.law,
                load,
                balance.states,
                settings=self.settings,
                start=balance.contact,
                guess=guess,
                strain=strain_on_path(balance.flattening),
                elastic=elastic,
            )
        return balance.flattened_until(arrival, self.bodies)

    def _unloading_model(self, balance: Equilibrium, load: PathLoad) -> LinearModel:
        strain = strain_on_path(balance.flattening)
        return unloading_model(self.model, self.bodies, balance.states, load.further, strain)

    def _open_load(self, load: PathLoad, balance: Equilibrium, error: OpenSealError) -> OpenLoad:
        """Error of a load that opens the bodies as they last touched; the given one if it leaves them closed."""
        model = self._unloading_model(balance, load)
        try:
            load.contact(model, self.law, balance.contact)
        except OpenSealError as of_load:
            return OpenLoad(of_load, model)
        except ConvergenceError:
            pass
        return OpenLoad(error, model)

    def _failure(self, at: PathLoad, aim: PathLoad, state: Equilibrium, error: Exception) -> ConvergenceError:
        """Error of a load step that is as small as can be and not solved."""
        if self._gives_way(at, aim, state):
            return self._limit_load(at, state)
        why = error.args[0] if isinstance(error, ConvergenceError) else "what flows has no stiffness left"
        return ConvergenceError(problem("step_fails", at=str(at), aim=str(aim), why=why))

    def _too_many_steps(
        self, at: PathLoad, end: PathLoad, balance: Equilibrium, way: float, tries: int, step: float
    ) -> ConvergenceError:
        """Error of a way whose load steps have become so short that it would never end."""
        if self._gives_way(at, at.interpolate(end, step), balance):
            return self._limit_load(at, balance)
        strains = {name: state.plastic.accumulated_strain.max() for name, state in balance.states.items()}
        label = self.model.bodies[max(strains, key=strains.__getitem__)].fem.label if strains else ""
        numbers = {"force": at.force, "end": end.force, "tries": tries, "way": 100 * way, "step": 100 * step}
        strain = 100 * balance.plastic_strain
        return LongPathError(problem("long_path", **numbers, label=label, strain=strain))

    def _gives_way(self, at: PathLoad, aim: PathLoad, balance: Equilibrium) -> bool:
        """Whether bodies linearised as they flow come so much nearer in a step that they bear nothing more."""
        if not balance.states or balance.linear is None or balance.contact is None:
            return False
        elastic = self._unloading_model(balance, at)
        try:
            ends = [aim.contact(bodies, self.law, balance.contact) for bodies in (balance.linear, elastic)]
        except _FAILURES:
            return False
        by_flow, by_spring = (0.0 if end is None else end.approach - balance.contact.approach for end in ends)
        is_whole = max(_yielded_share(state) for state in balance.states.values()) > _WHOLE_SHARE
        return by_spring > 0 and by_flow > (_GIVES_WAY_WHOLE if is_whole else _GIVES_WAY) * by_spring

    def _limit_load(self, at: PathLoad, balance: Equilibrium) -> LimitLoadError:
        body = max(balance.states, key=lambda name: _yielded_share(balance.states[name]))
        label = self.model.bodies[body].fem.label
        return LimitLoadError(problem("limit_load", label=label, force=at.force), label)


class _OpenedSeal(Exception):
    """A load opens the seal on the way to it; `last_touch` is where the bodies last touched."""

    def __init__(self, load: OpenLoad, last_touch: Equilibrium) -> None:
        super().__init__(str(load.error))
        self.load = load
        self.last_touch = last_touch


def _yielded_share(state: BodyState) -> float:
    return float((state.plastic.accumulated_strain > 0).mean())


def yielding_bodies(model: ContactModel) -> dict[str, YieldingBody]:
    """Those bodies of a seal whose materials have a hardening curve, by name; empty if the seal is elastic."""
    return {
        name: YieldingBody(body.fem)
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
    flattening : mapping
        Of the bodies that yield by name: what their strain on the way to this load flattens.
    sunk : ndarray, shape (m,), or float
        By how much asperities have sunk into metal that flows [m].
    """

    bodies: Mapping[str, YieldingBody] = field(repr=False)
    states: Mapping[str, BodyState] = field(repr=False)
    equilibrium_residuals: tuple[float, ...] = field(repr=False)
    load_steps: int = 1
    linear: ContactModel | None = field(default=None, repr=False)
    flattening: Mapping[str, Flattening] = field(default_factory=dict, repr=False)
    sunk: FloatArray | float = field(default=0.0, repr=False)

    @property
    def mean_gap(self) -> FloatArray:
        """See `ContactSolution.mean_gap`."""
        return self.gap - self.sunk

    def over_strained_metal(self, surface: FaceContact, law: Law) -> ElastoplasticContact:
        """The same with asperities sunk by what its strain lets them: the gap at rest where as much flows.

        Parameters
        ----------
        surface : RoughContact or TurnedContact
        law : InterfaceLaw or HardContact
            Of faces over metal that is not strained.
        """
        if isinstance(law, HardContact) or self.strain is None:
            return self
        at_rest = surface.pressure_at_rest(self.pressure, *self.strain.T)
        # below 1 Pa nothing sinks
        before, after = (law.gap(np.log(np.maximum(p, 1.0))) for p in (self.pressure, at_rest))
        return replace(self, sunk=before - after)

    @property
    def strain(self) -> FloatArray | None:
        """See `ContactSolution.strain`; that of bodies that yield along the whole path."""
        return strain_on_path(self.flattening)

    @property
    def flowing_body(self) -> str:
        """Name of the body that has flowed most below the highest pressure; empty where none has."""
        at = [int(self.pressure.argmax())]
        sizes = {
            n: float(strain_size(f.strain[at])[0]) for n, f in self.flattening.items() if f.plastic[at].any()
        }
        return max(sizes, key=sizes.__getitem__, default="")

    @cached_property
    def unloading_model(self) -> ContactModel:
        """The bodies as they answer to less load, see `fem_seal.contact.plastic_step.unloading_model`."""
        return unloading_model(self.model, self.bodies, self.states, self.loads, self.strain)

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Displacement and stress of "closure" and "seat"; of bodies that yield with their plastic strain."""
        return body_fields(self) | {
            name: elastoplastic_field(
                body.fem, body.solid, self.states[name], self.profile, self.loads.temperature.get(name)
            )
            for name, body in self.bodies.items()
        }
