"""From fluid pressure to the line load of a seal (Fischer et al. 2020, eq. 1)."""

from __future__ import annotations

import math
from typing import Literal

PressureSide = Literal["outer", "inner"]
Closing = Literal["sealed-area", "penetration"]

# Share of spring and fluid force that a contact near blow-off is taken to carry before it is solved.
_LEAST_CARRIED = 1e-3


def initial_contact_radius(ball_radius: float, angle: float) -> float:
    """Radius r0 = R sin(theta) of the circle where a ball touches a conical seat [m].

    Parameters
    ----------
    ball_radius : float
        R [m].
    angle : float
        theta between the axis and the contact normal [rad].
    """
    return ball_radius * math.sin(angle)


def contact_force(
    sealing_radius: float,
    fluid_pressure: float,
    applied_force: float = 0.0,
    pressure_side: PressureSide = "outer",
) -> float:
    """Axial force F_N that presses the closure on the seat [N], with the fluid acting on the sealed area.

    With the pressure outside the sealing circle it presses the closure down,
    F_N = applied_force + pi r0^2 p_fluid; with the pressure inside, in the bore, it lifts the closure,
    F_N = applied_force - pi r0^2 p_fluid.

    Parameters
    ----------
    sealing_radius : float
        Radius r0 of the sealing circle [m].
    fluid_pressure : float
        Pressure difference across the seal [Pa].
    applied_force : float
        Additional force on the closure, positive when it closes [N].
    pressure_side : {"outer", "inner"}
        Side of the high pressure.

    Examples
    --------
    >>> round(contact_force(0.014142, 20e5), 1)
    1256.6
    """
    sealed_area = math.pi * sealing_radius**2
    return applied_force + (sealed_area if pressure_side == "outer" else -sealed_area) * fluid_pressure


def blow_off_of_sealed_area(
    sealing_radius: float, applied_force: float, pressure_side: PressureSide = "inner"
) -> float:
    """Fluid pressure that lifts the closure off a sealing circle [Pa]; infinite if the fluid does not lift it.

    Parameters
    ----------
    sealing_radius, applied_force, pressure_side
        See `contact_force`.

    Examples
    --------
    >>> round(blow_off_of_sealed_area(0.014142, 1256.6) / 1e5, 2)
    20.0
    """
    lifts = pressure_side == "inner" and applied_force > 0
    return applied_force / (math.pi * sealing_radius**2) if lifts else math.inf


def expected_force(
    sealing_radius: float,
    fluid_pressure: float,
    applied_force: float,
    pressure_side: PressureSide,
    closing: Closing,
    least: float = _LEAST_CARRIED,
) -> float:
    """Axial force that the solid contact is expected to carry, before anything is solved [N].

    With closing "sealed-area" this is the force; with "penetration" it is the estimate for which the mesh is sized,
    positive also where the fluid comes close to lifting the closure.

    Parameters
    ----------
    sealing_radius, fluid_pressure, applied_force, pressure_side
        See `contact_force`.
    closing : {"sealed-area", "penetration"}
    least : float
        With "penetration": share of spring and fluid force that the contact is taken to carry at least.
    """
    force = contact_force(sealing_radius, fluid_pressure, applied_force, pressure_side)
    if closing == "sealed-area":
        return force
    return max(force, least * (abs(applied_force) + math.pi * sealing_radius**2 * fluid_pressure))


def line_load(contact_force: float, sealing_radius: float, angle: float) -> float:
    """Force per circumference normal to the contact, f_N = F_N / (2 pi r0 cos(theta)) [N/m].

    Parameters
    ----------
    contact_force : float
        Axial force F_N [N].
    sealing_radius : float
        r0 [m].
    angle : float
        theta between the axis and the contact normal [rad].

    Examples
    --------
    A ball of 20 mm at 45 deg and 20 bar carries 20 kN/m (Fischer et al. 2020, fig. 4):

    >>> r0 = initial_contact_radius(0.02, math.radians(45))
    >>> round(line_load(contact_force(r0, 20e5), r0, math.radians(45)), 6)
    20000.0
    """
    return contact_force / (2 * math.pi * sealing_radius * math.cos(angle))


# Half-width of Hertz's contact over the radius of relative curvature, the angle by which the faces turn against each
# other [rad], where a leak rate by the theory of small strains is some 5 % off, and where 20 %
# (docs/guide/validity.md).
TURNED, LARGEST_TURNING = 0.07, 0.25

# Stress over yield stress of a body solved as elastic, above which its contact is outside the theory.
LARGEST_EXCESS = 1.5

# Prandtl's strip, the most that a narrow contact carries: (2 + pi)/sqrt(3) of the flow stress.
CONSTRAINT = 2.97


def plastic_half_width(line_load: float, flow_stress: float) -> float:
    """Half-width of a contact in the fully plastic range [m].

    Parameters
    ----------
    line_load : float
        f_N [N/m].
    flow_stress : float
        [Pa]
    """
    return line_load / (2 * CONSTRAINT * flow_stress)
