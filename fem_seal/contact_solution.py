"""Settings and solution of a contact."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fem_seal.condensation import ContactModel
from fem_seal.further_loads import NO_LOADS, FurtherLoads
from fem_seal.profile import PressureProfile
from fem_seal.stress import BodyField, body_fields

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class ContactSettings:
    """When the Newton iteration stops.

    Parameters
    ----------
    gap_tolerance : float
        Largest residual of the gap in units of the law's decay length; this is also the relative error of p.
    force_tolerance : float
        Relative residual of the axial force.
    max_iterations : int
    """

    gap_tolerance: float = 1e-10
    force_tolerance: float = 1e-12
    max_iterations: int = 60


@dataclass(frozen=True)
class ContactSolution:
    """State of the contact line under one axial force.

    Parameters
    ----------
    model : ContactModel
    axial_force : float
        Force F_N that the solid contact carries [N].
    approach : float
        Axial motion of the closure's loaded surface towards the seat's bottom since first touch of the mean
        planes [m].
    log_pressure : ndarray, shape (m,)
        ln(p/Pa) at the points of the contact line; -inf where hard contact is open.
    gap : ndarray, shape (m,)
        Separation [m].
    iterations : int
    residuals : tuple of float
        Largest gap residual over decay length, before each iteration and at the end.
    loads : FurtherLoads
        What acts on the bodies besides the contact pressure.
    """

    model: ContactModel
    axial_force: float
    approach: float
    log_pressure: FloatArray = field(repr=False)
    gap: FloatArray = field(repr=False)
    iterations: int
    residuals: tuple[float, ...] = field(repr=False)
    loads: FurtherLoads = NO_LOADS

    @property
    def pressure(self) -> FloatArray:
        """Contact pressure at the points of the contact line [Pa]."""
        return np.exp(self.log_pressure)

    @property
    def point_forces(self) -> FloatArray:
        """Normal forces at the points of the contact line [N]."""
        return self.model.line.area_weight * self.pressure

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Displacement and stress of "closure" and "seat"."""
        return body_fields(self)

    @property
    def closing_force(self) -> float:
        """Force of spring or actuator on the top of the closure [N], in balance with contact and further loads."""
        return self.axial_force + self.loads.lift(self.model)

    @property
    def force_error(self) -> float:
        """(axial contact force - F_N) / F_N."""
        return float(self.model.line.normal[1] @ self.point_forces) / self.axial_force - 1

    @property
    def line_load(self) -> float:
        """f_N [N/m]."""
        return self.model.line_load(self.axial_force)

    @property
    def profile(self) -> PressureProfile:
        """Nominal pressure profile."""
        line = self.model.line
        return PressureProfile(line.x, line.radius, self.pressure, self.gap, line.arc_weight, line.reach)
