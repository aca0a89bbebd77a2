"""A contact and the fluid pressure between its surfaces that belong to each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.fixed_point import first_fixed_point, fixed_point
from fem_seal.contact.fluid_path import FluidPath
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.model import ContactModel
from fem_seal.contact.newton import solve
from fem_seal.contact.other_loads import NO_LOADS, FurtherLoads
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError, OpenSealError

# Error of the fluid pressure in units of the pressure difference.
_TOLERANCE = 1e-9
# The same for hard contact: its edge moves by steps in the last element, and the flow resistance with it.
_HARD_TOLERANCE = 2e-3
# Error of the place up to which a held fluid gets in units of the smallest element.
_FRONT = 1e-5


@dataclass(frozen=True)
class FluidAndContact:
    """What stays the same when the loads of a seal change.

    Parameters
    ----------
    path : FluidPath
        How the fluid gets between the surfaces.
    at_rest : FurtherLoads
        What acts without any fluid, such as a press fit or heat.

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> steel = fem_seal.Material("steel", 210e9, 0.3)
    >>> model = fem_seal.condense(meshes.build(ball, cone, sizing), {"closure": steel, "seat": steel})
    >>> seal = fem_seal.Seal(model, fem_seal.HardContact(), fem_seal.HeldFluid("inner"))
    >>> seal.at_rest.seat
    {}
    """

    model: ContactModel
    law: Law
    path: FluidPath
    at_rest: FurtherLoads = NO_LOADS

    @property
    def pressurised(self) -> int:
        """Number of the wetted surface with the high pressure, from the axis outwards."""
        return 0 if self.path.side == "inner" else len(self.model.lines)

    def loads(self, fluid_pressure: float, unknowns: FloatArray) -> FurtherLoads:
        """Fluid on the wetted surfaces and in the gap, and what acts without it."""
        regions = range(len(self.model.lines) + 1)
        wetted = [fluid_pressure if region == self.pressurised else 0.0 for region in regions]
        share = self.path.share(self.model.line, unknowns)
        return FurtherLoads.of_fluid(wetted, fluid_pressure * share, self.at_rest)


# Its public name.
Seal = FluidAndContact

# Takes the lift per unit of fluid pressure [N/Pa] to fluid pressure [Pa] and contact force [N].
Balance = Callable[[float], tuple[float, float]]


def coupled_contact(
    seal: FluidAndContact, balance: Balance, unknowns: FloatArray, start: ContactSolution | None
) -> ContactSolution:
    """Find the unknowns of the fluid that belong to the contact which they leave.

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
    solution = start

    def image(at: FloatArray) -> FloatArray:
        nonlocal solution
        pressure, force = balance(seal.loads(1.0, at).lift(seal.model))
        if not force > 0:
            raise OpenSealError(f"nothing is left for the solid contact at {pressure / 1e5:.6g} bar")
        solution = solve(
            seal.model,
            seal.law,
            contact_force=force,
            loads=seal.loads(pressure, at),
            start=solution,
        )
        return seal.path.found(solution.profile, pressure)

    low, high = seal.path.bounds(seal.model.line)
    tolerance = _TOLERANCE * (high - low)
    try:
        if unknowns.size == 1:
            # The place up to which the fluid gets moves from element to element.
            elements = np.diff(seal.model.line.vertices)
            first_fixed_point(
                lambda place: float(image(np.array([place]))[0]),
                float(unknowns[0]),
                tolerance=_FRONT * float(elements.min()),
                jump=float(elements.max()),
            )
        else:
            _smooth_fixed_point(seal, image, unknowns, tolerance, (low, high))
    except ConvergenceError as error:
        raise ConvergenceError(f"contact and fluid pressure in the gap: {error}", solution) from error
    assert solution is not None
    return solution


def _smooth_fixed_point(
    seal: FluidAndContact,
    image: Callable[[FloatArray], FloatArray],
    unknowns: FloatArray,
    tolerance: float,
    bounds: tuple[float, float],
) -> None:
    try:
        fixed_point(image, unknowns, tolerance=tolerance, bounds=bounds)
    except ConvergenceError:
        if not isinstance(seal.law, HardContact):
            raise
        fixed_point(image, unknowns, tolerance=_HARD_TOLERANCE, bounds=bounds)


def dry_unknowns(
    seal: FluidAndContact, force: float, fluid_pressure: float, start: ContactSolution | None
) -> FloatArray:
    """Unknowns of the fluid that belong to a contact which no fluid opens, under a force F_N [N]."""
    contact = solve(seal.model, seal.law, contact_force=force, loads=seal.at_rest, start=start)
    return seal.path.found(contact.profile, fluid_pressure)
