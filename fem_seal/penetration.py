"""Contact, flow and the fluid pressure between the surfaces, solved together."""

from __future__ import annotations

import math
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from fem_seal.blow_off import contact_near_blow_off, fluid_lifts
from fem_seal.contact_solution import ContactSolution
from fem_seal.coupled_contact import Seal, coupled_contact, dry_unknowns
from fem_seal.errors import ConvergenceError, OpenSealError

FloatArray = NDArray[np.float64]

# Share of spring and fluid force for which the first contact is solved where the fluid comes close to lifting it.
_LEAST_CARRIED = 1e-4
# Shares of the fluid's force that the solid contact carries on the way to an open seal.
_SHARES = (0.5, 0.1, 1e-2, 1e-3, 1e-4)


def solve_penetration(
    seal: Seal, *, closing_force: float, fluid_pressure: float, start: ContactSolution | None = None
) -> ContactSolution:
    """Contact under the force of a spring and a fluid that gets between the surfaces.

    Parameters
    ----------
    seal : Seal
    closing_force : float
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
    """

    def given(lift: float) -> tuple[float, float]:
        return fluid_pressure, closing_force - fluid_pressure * lift

    try:
        return coupled_contact(seal, given, _first(seal, closing_force, fluid_pressure, start), start)
    except (OpenSealError, ConvergenceError):
        if not fluid_lifts(seal, closing_force):
            raise
    return contact_near_blow_off(seal, closing_force, fluid_pressure)


def solve_at_contact_force(
    seal: Seal, *, contact_force: float, fluid_pressure: float, start: ContactSolution | None = None
) -> ContactSolution:
    """The same with the force that the solid contact carries given, and the closing force as a result.

    Parameters
    ----------
    seal : Seal
    contact_force : float
        F_N [N], positive.
    fluid_pressure : float
        [Pa]
    start : ContactSolution, optional
    """
    unknowns = dry_unknowns(seal, contact_force, fluid_pressure, start)
    return coupled_contact(seal, lambda lift: (fluid_pressure, contact_force), unknowns, start)


def least_closing_force(seal: Seal, fluid_pressure: float) -> float | None:
    """Force of spring or actuator above which the seal is closed at a fluid pressure [N]; None if none was found.

    Negative where the fluid itself closes the seal. A flow lets the contact vanish evenly: what holds it while it
    carries 1e-4 of the fluid's force on the circle of first touch is the answer. Where it opens before, its force is
    made less and less, and a closing force above the least that was met on this way holds.

    Parameters
    ----------
    seal : Seal
    fluid_pressure : float
        [Pa]
    """
    fluid_force = math.pi * seal.model.touch_radius**2 * fluid_pressure
    contact, met = None, []
    for shares in (_SHARES[-1:], _SHARES):
        with suppress(OpenSealError, ConvergenceError):
            for share in shares:
                contact = solve_at_contact_force(
                    seal, contact_force=share * fluid_force, fluid_pressure=fluid_pressure, start=contact
                )
                met.append(contact.closing_force)
        if met:
            break
    return min(met, default=None)


def effective_radius(solution: ContactSolution, fluid_pressure: float) -> float:
    """Radius of the circle whose area times the fluid pressure is the axial force of the fluid on the closure [m].

    Parameters
    ----------
    solution : ContactSolution
    fluid_pressure : float
        Pressure difference [Pa].
    """
    return math.sqrt(abs(solution.loads.lift(solution.model)) / (math.pi * fluid_pressure))


def _first(
    seal: Seal, closing_force: float, fluid_pressure: float, start: ContactSolution | None
) -> FloatArray:
    """Unknowns of the fluid in a contact that carries what it will nearly carry."""
    area = math.pi * seal.model.touch_radius**2 * (1 if seal.path.side == "outer" else -1)
    return dry_unknowns(
        seal,
        max(
            closing_force + area * fluid_pressure,
            _LEAST_CARRIED * (abs(closing_force) + abs(area) * fluid_pressure),
        ),
        fluid_pressure,
        start,
    )
