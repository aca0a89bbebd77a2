"""Contact, flow and the fluid pressure between the surfaces that belong to each other, up to blow-off."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.fixed_point import first_fixed_point, fixed_point
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.model import NO_LOADS, BodyLoads, ContactLine, ContactModel
from fem_seal.contact.newton import solve
from fem_seal.contact.solution import DEFAULT_SETTINGS, ContactSettings, ContactSolution
from fem_seal.errors import ConvergenceError, OpenSealError
from fem_seal.files import problem
from fem_seal.loads import PressureSide, expected_force
from fem_seal.profile import PressureProfile
from leak.numerics.roots import root_between


class FluidPath(Protocol):
    """What the fluid does, as a function of a few unknowns that follow from the solid contact."""

    @property
    def side(self) -> PressureSide:
        """Side of the high pressure."""

    def bounds(self, line: ContactLine) -> tuple[float, float]:
        """Between which all unknowns lie."""

    def loads(
        self, model: ContactModel, at_rest: BodyLoads, fluid_pressure: float, unknowns: FloatArray
    ) -> BodyLoads:
        """What acts besides the contact, with and without the fluid."""

    def unknowns_of(self, profile: PressureProfile, fluid_pressure: float) -> FloatArray:
        """The unknowns that belong to a profile of the solid contact pressure."""

    def after_load(self, largest: FloatArray) -> FluidPath:
        """The same after the largest pressure that each place has carried before [Pa], shape (m,)."""
        return self


class _BetweenSurfaces(FluidPath, Protocol):
    """A fluid on the wetted surfaces and in the gap, which it opens."""

    def share(self, line: ContactLine, unknowns: FloatArray) -> FloatArray:
        """Fluid pressure over the pressure difference at the points of the line, shape (m,)."""

    def loads(
        self, model: ContactModel, at_rest: BodyLoads, fluid_pressure: float, unknowns: FloatArray
    ) -> BodyLoads:
        """Fluid on both bodies and between them, and what acts without it."""
        pressures = (fluid_pressure, 0.0) if self.side == "inner" else (0.0, fluid_pressure)
        return BodyLoads.of_fluid(pressures, fluid_pressure * self.share(model.line, unknowns), at_rest)


# Takes a profile, and the largest pressure that each place has carried before [Pa], to that of new faces which lets as
# much through.
Equivalent = Callable[[PressureProfile, FloatArray], PressureProfile]


@dataclass(frozen=True)
class PenetratingFluid(_BetweenSurfaces):
    """A fluid that flows through the rough contact; its pressure falls along the flow resistance.

    Parameters
    ----------
    pressure_along : callable
        Takes a `PressureProfile` and the pressure difference [Pa] to the fluid pressure at its points [Pa].
    sealing_pressure : float
        Contact pressure from which on nothing flows [Pa].
    side : {"outer", "inner"}
    highest : float
        Largest share of the pressure difference; infinite where a test port holds a chamber, which may be above it.
    equivalent : callable, optional
        What larger pressures leave behind; nothing without it.
    largest : ndarray, shape (m,), optional
        Largest pressure that each place has carried before [Pa].
    at_rest : callable, optional
        Profile over metal that is not strained which lets as much through; itself without it.

    Notes
    -----
    Where the contact is sealed nothing flows, and what the fluid does between the two ends of the sealed stretch is
    not known: its pressure is taken to fall evenly there. That is also where it falls just before the contact seals.

    Examples
    --------
    >>> import numpy as np, fem_seal
    >>> evenly = lambda profile, drop: drop * np.linspace(0.0, 1.0, len(profile.x))
    >>> fem_seal.PenetratingFluid(evenly, sealing_pressure=1e9).side
    'outer'
    """

    pressure_along: Callable[[PressureProfile, float], FloatArray]
    sealing_pressure: float
    side: PressureSide = "outer"
    highest: float = 1.0
    equivalent: Equivalent | None = field(default=None, repr=False)
    largest: FloatArray | None = field(default=None, repr=False)
    at_rest: Callable[[PressureProfile], PressureProfile] = field(default=lambda profile: profile, repr=False)

    def after_load(self, largest: FloatArray) -> FluidPath:
        """See `FluidPath.after_load`."""
        return replace(self, largest=largest)

    def bounds(self, line: ContactLine) -> tuple[float, float]:
        """Shares of the pressure difference."""
        return 0.0, self.highest

    def share(self, line: ContactLine, unknowns: FloatArray) -> FloatArray:
        """The unknowns are the shares themselves."""
        return unknowns

    def unknowns_of(self, profile: PressureProfile, fluid_pressure: float) -> FloatArray:
        """Fluid pressure over the pressure difference."""
        profile = self.at_rest(_flow_profile(self, profile))
        if profile.parts or profile.pressure.max() < self.sealing_pressure:
            return self.pressure_along(profile, fluid_pressure) / fluid_pressure
        inner, outer = _stretch_above(profile, self.sealing_pressure)
        # Sealed at one point alone the fall would be a step, which no point of the line feels.
        width = max(outer - inner, 1e-3 * float(np.min(np.diff(profile.x))))
        shares = np.clip((profile.x - inner) / width, 0.0, 1.0)
        return shares if self.side == "outer" else 1.0 - shares


@dataclass(frozen=True)
class FluidAtContact(_BetweenSurfaces):
    """A fluid of which no flow is known: it gets in as far as the contact pressure is below its own.

    Full pressure from its side up to the first place where the solid contact presses harder than the fluid, nothing
    beyond. The unknown is this place.

    Parameters
    ----------
    side : {"outer", "inner"}

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.FluidAtContact("inner").side
    'inner'
    """

    side: PressureSide = "outer"

    def bounds(self, line: ContactLine) -> tuple[float, float]:
        """Ends of the contact line [m]."""
        return float(line.vertices[0]), float(line.vertices[-1])

    def share(self, line: ContactLine, unknowns: FloatArray) -> FloatArray:
        """One up to the place, zero beyond; in between it falls within one element, so that it follows the place."""
        front = float(unknowns[0])
        element = int(np.clip(np.searchsorted(line.vertices, front) - 1, 0, len(line.vertices) - 2))
        width = line.vertices[element + 1] - line.vertices[element]
        shares = np.clip(0.5 + (line.x - front) / width, 0.0, 1.0)
        return shares if self.side == "outer" else 1.0 - shares

    def unknowns_of(self, profile: PressureProfile, fluid_pressure: float) -> FloatArray:
        """Where the contact pressure first exceeds that of the fluid, seen from the side of the fluid [m].

        Raises
        ------
        OpenSealError
            If it does so nowhere.
        """
        if profile.pressure.max() <= fluid_pressure:
            pressures = {"peak": float(profile.pressure.max()), "pressure": fluid_pressure}
            raise OpenSealError(problem("gets_through", **pressures))
        return np.array([_stretch_above(profile, fluid_pressure)[1 if self.side == "outer" else 0]])


@dataclass(frozen=True)
class FluidInChambers:
    """A fluid between lands that acts on the closure alone: its pressure falls at one circle of each land.

    The circles are those of the centroids of the contact pressure. Each unknown is what a land holds back, its fall of
    pressure on the area of its circle, over the pressure difference on `area`.

    Parameters
    ----------
    falls : callable
        Takes a `PressureProfile` and the pressure difference [Pa] to the pressure on the inner side of each land less
        that on its outer side [Pa].
    area : float
        Of the circle of first touch [m^2].
    side : {"outer", "inner"}
    equivalent, largest
        See `PenetratingFluid`.

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.contact.penetration.FluidInChambers(lambda profile, drop: [drop], 6e-4, "inner").side
    'inner'
    """

    falls: Callable[[PressureProfile, float], Sequence[float]]
    area: float
    side: PressureSide = "outer"
    equivalent: Equivalent | None = field(default=None, repr=False)
    largest: FloatArray | None = field(default=None, repr=False)

    def after_load(self, largest: FloatArray) -> FluidPath:
        """See `FluidPath.after_load`."""
        return replace(self, largest=largest)

    def bounds(self, line: ContactLine) -> tuple[float, float]:
        """None: test ports may have any pressure."""
        return -math.inf, math.inf

    def loads(
        self, model: ContactModel, at_rest: BodyLoads, fluid_pressure: float, unknowns: FloatArray
    ) -> BodyLoads:
        """The force of the fluid, and what acts without it."""
        return replace(at_rest, lifting=fluid_pressure * self.area * float(unknowns.sum()))

    def unknowns_of(self, profile: PressureProfile, fluid_pressure: float) -> FloatArray:
        """What each land holds back."""
        falls = self.falls(_flow_profile(self, profile), fluid_pressure)
        radii = [float(np.interp(land.centroid, land.x, land.radius)) for land in profile.lands]
        return math.pi * np.square(radii) * np.array(falls) / (self.area * fluid_pressure)


def _flow_profile(path: PenetratingFluid | FluidInChambers, profile: PressureProfile) -> PressureProfile:
    """The profile for which the flow is asked."""
    if path.equivalent is None or path.largest is None:
        return profile
    return path.equivalent(profile, path.largest)


def _stretch_above(profile: PressureProfile, pressure: float) -> tuple[float, float]:
    """First and last place at which a profile is above a pressure [m]."""
    points = np.flatnonzero(profile.pressure >= pressure)
    return _find_crossing(profile, pressure, points[0], -1), _find_crossing(profile, pressure, points[-1], 1)


def _find_crossing(profile: PressureProfile, pressure: float, point: int, step: int) -> float:
    neighbour = point + step
    if not 0 <= neighbour < len(profile.x):
        return float(profile.x[point])
    # Squares: a Hertzian edge falls like a square root, and near its top any profile like a parabola.
    high, low = profile.pressure[point] ** 2, profile.pressure[neighbour] ** 2
    share = (high - pressure**2) / (high - low)
    return float(profile.x[point] + share * (profile.x[neighbour] - profile.x[point]))


# Error of the fluid pressure in units of the pressure difference that is left for hard contact: its edge moves by steps
# in the last element, and the flow resistance with it.
_HARD_TOLERANCE = 2e-3
# Error of the place up to which a held fluid gets in units of the smallest element.
_FRONT = 1e-5


@dataclass(frozen=True)
class CoupledContact:
    """What stays the same when the loads of a seal change.

    Parameters
    ----------
    path : FluidPath
        How the fluid gets between the surfaces.
    at_rest : BodyLoads
        What acts without any fluid, such as a press fit or heat.
    settings : ContactSettings

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> seal = fem_seal.CoupledContact(model, fem_seal.HardContact(), fem_seal.FluidAtContact("inner"))
    >>> seal.at_rest.seat
    {}
    """

    model: ContactModel
    law: Law
    path: FluidPath
    at_rest: BodyLoads = NO_LOADS
    settings: ContactSettings = DEFAULT_SETTINGS

    def loads(self, fluid_pressure: float, unknowns: FloatArray) -> BodyLoads:
        """What acts besides the contact under a fluid pressure."""
        return self.path.loads(self.model, self.at_rest, fluid_pressure, unknowns)


# Takes the lift per unit of fluid pressure [N/Pa] to fluid pressure [Pa] and contact force [N].
Balance = Callable[[float], tuple[float, float]]


def coupled_contact(
    seal: CoupledContact, balance: Balance, unknowns: FloatArray, start: ContactSolution | None
) -> tuple[ContactSolution, FloatArray]:
    """Find the contact, and the unknowns of the fluid that belong to the contact which they leave.

    Parameters
    ----------
    balance : callable
        Takes the lift per unit of fluid pressure [N/Pa] to fluid pressure [Pa] and contact force [N].
    unknowns : ndarray
        Of the fluid path, to start from.
    start : ContactSolution or None
        To start Newton's method from.

    Raises
    ------
    OpenSealError
        If nothing is left for the solid contact, or the fluid gets through.
    ConvergenceError
    """
    solution, next_unknowns = start, unknowns

    def image(at: FloatArray) -> FloatArray:
        nonlocal solution, next_unknowns
        pressure, force = balance(seal.loads(1.0, at).lift(seal.model))
        if not force > 0:
            raise OpenSealError(f"nothing is left for the solid contact at {pressure / 1e5:.6g} bar")
        loads = seal.loads(pressure, at)
        solution = solve(
            seal.model, seal.law, contact_force=force, loads=loads, settings=seal.settings, start=solution
        )
        next_unknowns = seal.path.unknowns_of(solution.whole_profile, pressure)
        return next_unknowns

    low, high = seal.path.bounds(seal.model.line)
    try:
        if isinstance(seal.path, FluidAtContact):
            # The place up to which the fluid gets moves from element to element.
            elements = np.diff(seal.model.line.vertices)
            first_fixed_point(
                lambda place: float(image(np.array([place]))[0]),
                float(unknowns[0]),
                tolerance=_FRONT * float(elements.min()),
                jump=float(elements.max()),
            )
        else:
            try:
                fixed_point(image, unknowns, tolerance=seal.settings.fluid_tolerance, bounds=(low, high))
            except ConvergenceError:
                if not isinstance(seal.law, HardContact):
                    raise
                fixed_point(image, unknowns, tolerance=_HARD_TOLERANCE, bounds=(low, high))
    except ConvergenceError as error:
        raise ConvergenceError(f"contact and fluid pressure in the gap: {error}", solution) from error
    assert solution is not None
    return solution, next_unknowns


def dry_unknowns(
    seal: CoupledContact, force: float, fluid_pressure: float, start: ContactSolution | None
) -> FloatArray:
    """Unknowns of the fluid that belong to a contact which no fluid opens, under a force F_N [N]."""
    contact = solve(seal.model, seal.law, contact_force=force, loads=seal.at_rest, start=start)
    return seal.path.unknowns_of(contact.whole_profile, fluid_pressure)


# Shares of the closing force that the solid contact carries on the way to an open seal.
_SHARES = (0.5, 0.1, 1e-2, 1e-3, 1e-4)


def solve_penetration(
    seal: CoupledContact, *, applied_force: float, fluid_pressure: float, start: ContactSolution | None = None
) -> ContactSolution:
    """Contact under the force of a spring and a fluid that gets between the surfaces.

    Parameters
    ----------
    applied_force : float
        Force of spring or actuator on the closure [N], positive when it closes.
    fluid_pressure : float
        Pressure difference across the seal [Pa], positive.
    start : ContactSolution, optional
        Solution of a neighbouring load to start from.

    Returns
    -------
    ContactSolution
        Its `loads` hold the fluid pressure; spring, fluid and solid contact are in balance to round-off.

    Raises
    ------
    OpenSealError
        If the fluid lifts the closure off; it knows the pressure at which it does.
    ConvergenceError

    Notes
    -----
    Unknowns are the shares of the pressure difference along the contact (or the place up to which the fluid gets). For
    given ones the contact is solved with the solid force that is left, F_N = closing force - lift of the fluid; its
    pressure profile gives the fluid pressure anew. What the fluid opens the flow feels only as far as its pressure
    counts against that of the contact, so that Anderson's acceleration needs a few steps. Where F_N nearly vanishes it
    is F_N that is given instead, and the fluid pressure that follows.

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> seal = fem_seal.CoupledContact(model, fem_seal.HardContact(), fem_seal.FluidAtContact("outer"))
    >>> contact = fem_seal.solve_penetration(seal, applied_force=500.0, fluid_pressure=5e5)
    >>> contact.contact_force > 500.0, round(contact.applied_force)
    (True, 500)
    """
    balance = _fluid_and_force(applied_force, fluid_pressure)
    force = expected_force(
        seal.model.initial_contact_radius,
        fluid_pressure,
        applied_force,
        seal.path.side,
        "penetration",
        _SHARES[-1],
    )
    # the front of a fluid that does not flow is the first that the search meets: it begins without any fluid
    if start is not None and not isinstance(seal.path, FluidAtContact):
        with suppress(OpenSealError, ConvergenceError):
            unknowns = seal.path.unknowns_of(start.whole_profile, fluid_pressure)
            return coupled_contact(seal, balance, unknowns, start)[0]
    try:
        return coupled_contact(seal, balance, dry_unknowns(seal, force, fluid_pressure, start), start)[0]
    except (OpenSealError, ConvergenceError):
        if not fluid_lifts(seal, applied_force):
            raise
    return contact_near_blow_off(seal, applied_force, fluid_pressure)


def solve_at_contact_force(
    seal: CoupledContact, *, contact_force: float, fluid_pressure: float, start: ContactSolution | None = None
) -> ContactSolution:
    """The same with the force that the solid contact carries given, and the closing force as a result.

    Parameters
    ----------
    contact_force : float
        F_N [N], positive.
    fluid_pressure : float
        [Pa]
    start : ContactSolution, optional
    """
    unknowns = dry_unknowns(seal, contact_force, fluid_pressure, start)
    return coupled_contact(seal, lambda lift: (fluid_pressure, contact_force), unknowns, start)[0]


def least_applied_force(seal: CoupledContact, fluid_pressure: float) -> float | None:
    """Force of spring or actuator above which the seal is closed at a fluid pressure [N]; None if none was found.

    Negative where the fluid itself closes the seal. A flow lets the contact vanish evenly: what holds it while it
    carries 1e-4 of the fluid's force on the circle of first touch is the answer. Where it opens before, its force is
    made less and less, and a closing force above the least that was met on this way holds.

    Parameters
    ----------
    fluid_pressure : float
        [Pa]
    """
    fluid_force = math.pi * seal.model.initial_contact_radius**2 * fluid_pressure
    contact, forces = None, []
    for shares in (_SHARES[-1:], _SHARES):
        with suppress(OpenSealError, ConvergenceError):
            for share in shares:
                contact = solve_at_contact_force(
                    seal, contact_force=share * fluid_force, fluid_pressure=fluid_pressure, start=contact
                )
                forces.append(contact.applied_force)
        if forces:
            break
    return min(forces, default=None)


def effective_radius(solution: ContactSolution, fluid_pressure: float) -> float:
    """Radius of the circle whose area times the fluid pressure is the axial force of the fluid on the closure [m].

    Parameters
    ----------
    fluid_pressure : float
        Pressure difference [Pa].
    """
    return math.sqrt(abs(solution.loads.lift(solution.model)) / (math.pi * fluid_pressure))


def _fluid_and_force(applied_force: float, fluid_pressure: float) -> Balance:
    """Fluid pressure, and the force that is left to the solid contact [N] for the fluid's lift [m^2]."""
    return lambda lift: (fluid_pressure, applied_force - fluid_pressure * lift)


# Below this share a hard contact, whose width falls with the root of the force, is narrower than a few elements.
_NARROWEST_HARD = 1e-2
# Relative distance to the force at which the fluid gets through.
_CLOSE = 1e-6


def blow_off_pressure(seal: CoupledContact, *, applied_force: float) -> float:
    """Fluid pressure at which the fluid lifts the closure off [Pa]; infinite if it does not lift it.

    Parameters
    ----------
    applied_force : float
        Force of spring or actuator [N].

    Notes
    -----
    The solid contact carries less and less along the way: its force is the given parameter here, the fluid pressure
    follows. Blow-off is the largest pressure on this way, down to 1e-4 of the closing force; of hard contact down to
    1e-2, with the circle on which the fluid acts then for the rest of the way.

    Raises
    ------
    ConvergenceError

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> seal = fem_seal.CoupledContact(model, fem_seal.HardContact(), fem_seal.FluidAtContact("outer"))
    >>> fem_seal.blow_off_pressure(seal, applied_force=500.0)
    inf
    """
    if not fluid_lifts(seal, applied_force):
        return math.inf
    return _way_to_blow_off(seal, applied_force)[-1].pressure


def fluid_lifts(seal: CoupledContact, applied_force: float) -> bool:
    """Whether there is a fluid pressure that lifts the closure off."""
    return seal.path.side == "inner" and applied_force > 0


@dataclass(frozen=True)
class _Step:
    """A contact on the way to blow-off: which share of the closing force it carries, under which fluid pressure."""

    share: float
    pressure: float
    contact: ContactSolution | None = None
    unknowns: FloatArray | None = None


def _step(seal: CoupledContact, applied_force: float, share: float, last_step: _Step) -> _Step:
    force, pressure = share * applied_force, math.nan

    def balance(lift: float) -> tuple[float, float]:
        nonlocal pressure
        pressure = (applied_force - force) / lift
        return pressure, force

    unknowns = last_step.unknowns
    if unknowns is None:
        expected = (applied_force - force) / (math.pi * seal.model.initial_contact_radius**2)
        unknowns = dry_unknowns(seal, force, expected, None)
    contact, unknowns = coupled_contact(seal, balance, unknowns, last_step.contact)
    return _Step(share, pressure, contact, unknowns)


def _way_to_blow_off(seal: CoupledContact, applied_force: float) -> list[_Step]:
    """Steps of rising fluid pressure, the last at blow-off."""
    way = [_Step(1.0, 0.0)]
    hard = isinstance(seal.law, HardContact)
    for share in _SHARES:
        if hard and share < _NARROWEST_HARD:
            return [*way, _Step(0.0, way[-1].pressure / (1 - way[-1].share))]
        try:
            way.append(_step(seal, applied_force, share, way[-1]))
        except OpenSealError:
            way += _last_step(seal, applied_force, way[-1], share)
            break
        if way[-1].pressure < way[-2].pressure:
            turning_point = _turning_point(seal, applied_force, way[-3:])
            return [*(step for step in way[:-1] if step.share > turning_point.share), turning_point]
    return way


def _last_step(seal: CoupledContact, applied_force: float, step: _Step, open_share: float) -> list[_Step]:
    """The contact just before the fluid gets through, which it does at `open_share`."""
    steps: list[_Step] = []
    while step.share > (1 + _CLOSE) * open_share:
        share = math.sqrt(step.share * open_share)
        try:
            step = _step(seal, applied_force, share, step)
            steps = [step]
        except OpenSealError:
            open_share = share
    return steps


def _turning_point(seal: CoupledContact, applied_force: float, steps: list[_Step]) -> _Step:
    """Where the fluid pressure is largest among three steps, and beyond which less of it lifts more."""
    from scipy.optimize import minimize_scalar

    begin, _, end = steps
    place = minimize_scalar(
        lambda log_share: -_step(seal, applied_force, math.exp(log_share), begin).pressure,
        bounds=(math.log(end.share), math.log(begin.share)),
        method="bounded",
        options={"xatol": 1e-3},
    )
    return _step(seal, applied_force, math.exp(place.x), begin)


def contact_near_blow_off(
    seal: CoupledContact, applied_force: float, fluid_pressure: float
) -> ContactSolution:
    """Contact under a fluid pressure, found by the force that it carries."""
    way = _way_to_blow_off(seal, applied_force)
    if fluid_pressure >= way[-1].pressure:
        loads = {"force": applied_force, "held": way[-1].pressure, "pressure": fluid_pressure}
        raise OpenSealError(
            problem("lifted_off", closure=seal.model.closure.fem.label, **loads), way[-1].pressure
        )
    number = next(n for n, step in enumerate(way) if step.pressure > fluid_pressure)
    if way[number].contact is None:
        pressures = {"pressure": fluid_pressure, "opening": way[-1].pressure}
        raise ConvergenceError(problem("narrow_contact", **pressures, share=way[number - 1].share))
    last_step, steps = way[number - 1], [way[number]]

    def miss(log_share: float) -> float:
        if log_share == 0:
            return -1.0
        steps.append(_step(seal, applied_force, math.exp(log_share), steps[-1]))
        return steps[-1].pressure / fluid_pressure - 1

    root_between(miss, math.log(last_step.share), math.log(way[number].share), xtol=1e-6)
    closest_step = min(steps, key=lambda step: abs(step.pressure / fluid_pressure - 1))
    assert closest_step.unknowns is not None
    balance = _fluid_and_force(applied_force, fluid_pressure)
    return coupled_contact(seal, balance, closest_step.unknowns, closest_step.contact)[0]
