"""What acts on a seal with yielding bodies at one place of its path: given forces, or a spring and a fluid."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, Self

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.held_body import LoadName
from fem_seal.contact.laws import Law
from fem_seal.contact.model import ContactModel
from fem_seal.contact.newton import solve
from fem_seal.contact.other_loads import NO_LOADS, FurtherLoads
from fem_seal.contact.penetration import FluidAndContact, FluidPath, solve_penetration
from fem_seal.contact.solution import ContactSolution


class LoadOnPath(Protocol):
    """A load between which and the next one everything rises or falls evenly."""

    @property
    def apart(self) -> FurtherLoads:
        """What acts on the bodies where they do not touch."""

    def contact(self, model: ContactModel, law: Law, start: ContactSolution | None) -> ContactSolution | None:
        """The contact of linear bodies under this load; None where it leaves them apart.

        Raises
        ------
        OpenSealError
            If a fluid lifts the closure off.
        ConvergenceError
        """

    def between(self, other: Self, way: float) -> Self:
        """The load a share `way` of the way to another one."""

    def change(self, other: Self, touch_radius: float) -> float:
        """How far it is to another one, as a share of the larger; from nothing to a load it is one."""

    def after(self, contacts: Sequence[ContactSolution]) -> Self:
        """The load after some contacts, which its fluid may remember."""

    def rest(self, further: FurtherLoads) -> Self:
        """The same way of loading with nothing that presses, where these loads act."""


@dataclass(frozen=True)
class PathLoad:
    """A contact force and further loads, both given.

    Parameters
    ----------
    contact_force : float
        F_N that the solid contact carries [N]; zero where the bodies are apart.
    further : FurtherLoads
        What else acts on the bodies.
    """

    contact_force: float
    further: FurtherLoads = NO_LOADS

    def __str__(self) -> str:
        return f"{self.contact_force:.6g} N"

    @property
    def apart(self) -> FurtherLoads:
        """What acts on the bodies where they do not touch."""
        return self.further

    def contact(self, model: ContactModel, law: Law, start: ContactSolution | None) -> ContactSolution | None:
        """The contact of linear bodies; None without a force."""
        if not self.contact_force > 0:
            return None
        return solve(model, law, contact_force=self.contact_force, loads=self.further, start=start)

    def between(self, other: PathLoad, way: float) -> PathLoad:
        """The load a share `way` of the way to another one."""
        return PathLoad(
            (1 - way) * self.contact_force + way * other.contact_force,
            _between(self.further, other.further, way),
        )

    def change(self, other: PathLoad, touch_radius: float) -> float:
        """How far it is to another one, as a share of the larger contact force."""
        return _share(self.contact_force, other.contact_force)

    def after(self, contacts: Sequence[ContactSolution]) -> PathLoad:
        """The same: given forces remember nothing."""
        return self

    def rest(self, further: FurtherLoads) -> PathLoad:
        """No contact force, and these loads."""
        return PathLoad(0.0, further)


@dataclass(frozen=True)
class FluidLoad:
    """A spring and a fluid that gets between the surfaces; what the solid contact carries is found with it.

    Parameters
    ----------
    applied_force : float
        Force of spring or actuator [N], positive when it closes.
    fluid_pressure : float
        Pressure difference across the seal [Pa]; nothing acts where both are zero.
    path : FluidPath
        How the fluid gets between the surfaces.
    apart : FurtherLoads
        What acts without spring and fluid, such as a press fit or heat.
    remembers : callable, optional
        Takes the largest pressure that each place has carried [Pa], shape (m,), to the path of a fluid between surfaces
        that remember it; without it they remember nothing.
    """

    applied_force: float
    fluid_pressure: float
    path: FluidPath = field(repr=False)
    apart: FurtherLoads = NO_LOADS
    remembers: Callable[[FloatArray], FluidPath] | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"{self.applied_force:.6g} N at {self.fluid_pressure / 1e5:.6g} bar"

    def contact(self, model: ContactModel, law: Law, start: ContactSolution | None) -> ContactSolution | None:
        """Contact and fluid of linear bodies; None without a load."""
        if self.fluid_pressure == 0.0:
            return PathLoad(self.applied_force, self.apart).contact(model, law, start)
        return solve_penetration(
            FluidAndContact(model, law, self.path, self.apart),
            applied_force=self.applied_force,
            fluid_pressure=self.fluid_pressure,
            start=start,
        )

    def between(self, other: FluidLoad, way: float) -> FluidLoad:
        """The load a share `way` of the way to another one, with that one's fluid."""
        return replace(
            other,
            applied_force=(1 - way) * self.applied_force + way * other.applied_force,
            fluid_pressure=(1 - way) * self.fluid_pressure + way * other.fluid_pressure,
            apart=_between(self.apart, other.apart, way),
        )

    def change(self, other: FluidLoad, touch_radius: float) -> float:
        """How far it is to another one: in the force that is left to the contact, or in spring and fluid together."""
        area = math.pi * touch_radius**2
        forces = [(one.applied_force, area * one.fluid_pressure) for one in (self, other)]
        sign = 1 if self.path.side == "outer" else -1
        left = _share(*(max(spring + sign * fluid, 0.0) for spring, fluid in forces))
        largest = max(abs(spring) + fluid for spring, fluid in forces)
        (spring, fluid), (next_spring, next_fluid) = forces
        together = abs(next_spring - spring) + abs(next_fluid - fluid)
        return min(max(left, together / largest if largest > 0 else 0.0), 1.0)

    def after(self, contacts: Sequence[ContactSolution]) -> FluidLoad:
        """The load after some contacts, where its fluid remembers them."""
        if self.remembers is None or not contacts:
            return self
        return replace(self, path=self.remembers(np.max([one.pressure for one in contacts], axis=0)))

    def rest(self, further: FurtherLoads) -> FluidLoad:
        """Neither spring nor fluid, and these loads."""
        return replace(self, applied_force=0.0, fluid_pressure=0.0, apart=further)


def _share(first: float, second: float) -> float:
    scale = max(abs(first), abs(second))
    return abs(second - first) / scale if scale > 0 else 0.0


def _between(first: FurtherLoads, second: FurtherLoads, way: float) -> FurtherLoads:
    """Loads a share `way` of the way from some to others."""
    shares = [
        share * load.gap_pressure
        for share, load in ((1 - way, first), (way, second))
        if load.gap_pressure is not None
    ]
    return FurtherLoads(
        _mixed(first.closure, second.closure, way),
        _mixed(first.seat, second.seat, way),
        np.sum(shares, axis=0) if shares else None,
        second.temperature or first.temperature,
    )


def _mixed(
    first: Mapping[LoadName, float], second: Mapping[LoadName, float], way: float
) -> dict[LoadName, float]:
    return {
        name: (1 - way) * first.get(name, 0.0) + way * second.get(name, 0.0) for name in {*first, *second}
    }
