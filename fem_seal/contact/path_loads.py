"""Load on the path of a seal with yielding bodies: a given force, or a spring and a fluid."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.held_body import LoadName
from fem_seal.contact.laws import Law
from fem_seal.contact.model import ContactModel
from fem_seal.contact.newton import solve
from fem_seal.contact.other_loads import NO_LOADS, FurtherLoads
from fem_seal.contact.penetration import FluidAndContact, FluidPath, solve_penetration
from fem_seal.contact.solution import ContactSolution


@dataclass(frozen=True)
class PathLoad:
    """A load between which and the next one everything rises or falls evenly.

    Parameters
    ----------
    force : float
        F_N that the solid contact carries, zero where the bodies are apart; with a fluid that gets between the surfaces
        that of spring or actuator, positive when it closes [N].
    further : FurtherLoads
        What else acts on the bodies, also where they do not touch; without the fluid that gets between the surfaces.
    path : FluidPath or None
        How the fluid gets between the surfaces; what the solid contact carries is found with it.
    fluid_pressure : float
        Pressure difference across the seal [Pa].
    remembers : callable, optional
        Takes the largest pressure that each place has carried [Pa], shape (m,), to the path of a fluid between surfaces
        that remember it; without it they remember nothing.
    """

    force: float
    further: FurtherLoads = NO_LOADS
    path: FluidPath | None = field(default=None, repr=False, kw_only=True)
    fluid_pressure: float = field(default=0.0, kw_only=True)
    remembers: Callable[[FloatArray], FluidPath] | None = field(default=None, repr=False, kw_only=True)

    def __str__(self) -> str:
        fluid = "" if self.path is None else f" at {self.fluid_pressure / 1e5:.6g} bar"
        return f"{self.force:.6g} N{fluid}"

    def contact(self, model: ContactModel, law: Law, start: ContactSolution | None) -> ContactSolution | None:
        """The contact of linear bodies under this load, and its fluid; None where it leaves them apart.

        Raises
        ------
        OpenSealError
            If a fluid lifts the closure off.
        ConvergenceError
        """
        if self.path is not None and self.fluid_pressure != 0.0:
            seal = FluidAndContact(model, law, self.path, self.further)
            return solve_penetration(
                seal, applied_force=self.force, fluid_pressure=self.fluid_pressure, start=start
            )
        if not self.force > 0:
            return None
        return solve(model, law, contact_force=self.force, loads=self.further, start=start)

    def between(self, other: PathLoad, way: float) -> PathLoad:
        """The load a share `way` of the way to another one, with that one's fluid."""
        return replace(
            other,
            force=(1 - way) * self.force + way * other.force,
            fluid_pressure=(1 - way) * self.fluid_pressure + way * other.fluid_pressure,
            further=_between(self.further, other.further, way),
        )

    def change(self, other: PathLoad, touch_radius: float) -> float:
        """How far it is to another one, as a share of the larger; from nothing to a load it is one.

        In the force that is left to the contact, or in spring and fluid together.
        """
        area = math.pi * touch_radius**2
        forces = [(one.force, area * one.fluid_pressure) for one in (self, other)]
        sign = -1 if self.path is not None and self.path.side == "inner" else 1
        left = _share(*(max(spring + sign * fluid, 0.0) for spring, fluid in forces))
        largest = max(abs(spring) + fluid for spring, fluid in forces)
        (spring, fluid), (next_spring, next_fluid) = forces
        together = abs(next_spring - spring) + abs(next_fluid - fluid)
        return min(max(left, together / largest if largest > 0 else 0.0), 1.0)

    def after(self, contacts: Sequence[ContactSolution]) -> PathLoad:
        """The load after some contacts, where its fluid remembers them."""
        if self.remembers is None or not contacts:
            return self
        return replace(self, path=self.remembers(np.max([one.pressure for one in contacts], axis=0)))

    def rest(self, further: FurtherLoads) -> PathLoad:
        """The same way of loading with nothing that presses, where these loads act."""
        return replace(self, force=0.0, fluid_pressure=0.0, further=further)


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
