"""Flow of a fluid through a rough contact, for any pressure profile."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from numpy.typing import ArrayLike

from fem_seal.loads import PressureSide
from fem_seal.profile import PressureProfile
from leak import (
    ConductivityTable,
    Gas,
    GasConductivityTable,
    LeakResult,
    RoughContact,
    coupled_leak_flow,
    gas_conductivity_table,
    gas_leak_flow,
    leak_flow,
)

if TYPE_CHECKING:
    from fem_seal.contact.solution import ContactSolution

_ATMOSPHERE = 101325.0
_NORMAL_TEMPERATURE = 273.15


@dataclass(frozen=True)
class Flow:
    """A liquid or a gas, and how its way between rough surfaces is calculated.

    Parameters
    ----------
    fluid : str
        Its name.
    viscosity : float
        [Pa s]
    density : float or None
        Of a gas at 101325 Pa [kg/m^3]; None if unknown.
    gas : Gas or None
        None for a liquid.
    outlet_pressure : float
        Of a gas: absolute pressure on the low side [Pa].
    conductivity : {"bruggeman", "critical-junction"}
        Effective medium of all channels, or the narrowest junction alone.
    fluid_in_gap : {"uncoupled", "local"}
        Whether the pressure of a liquid is taken off the load of the asperities, place by place.
    pressure_side : {"outer", "inner"}
        Side of the high pressure.
    """

    fluid: str
    viscosity: float
    density: float | None = None
    gas: Gas | None = None
    outlet_pressure: float = 0.0
    conductivity: Literal["bruggeman", "critical-junction"] = "bruggeman"
    fluid_in_gap: Literal["uncoupled", "local"] = "uncoupled"
    pressure_side: PressureSide = "outer"

    def table(
        self, surface: RoughContact, p_min: float, p_max: float, num: int = 64
    ) -> ConductivityTable | GasConductivityTable:
        """Flow conductivity of a surface over a range of contact pressures.

        Parameters
        ----------
        surface : RoughContact
        p_min, p_max : float
            [Pa]
        num : int
            Number of pressures.
        """
        if self.gas is not None:
            return gas_conductivity_table(surface, p_min, p_max, num, self.conductivity)
        return surface.conductivity_table(p_min, p_max, num, method=self.conductivity)

    def table_of(
        self, surface: RoughContact, contacts: Sequence[ContactSolution], num: int = 80
    ) -> ConductivityTable | GasConductivityTable:
        """Flow conductivity of a surface over all pressures that occur in some contacts.

        The range reaches six decades below the smallest peak, where the table goes on by the low-pressure law. It is
        rounded out to whole decades, so that neighbouring contacts share one table.

        Parameters
        ----------
        surface : RoughContact
        contacts : sequence of ContactSolution
        num : int
            Number of pressures.
        """
        peaks = [math.log10(contact.pressure.max()) for contact in contacts]
        low, high = math.floor(min(peaks) - 6), math.ceil(max(peaks) + 0.3)
        return self.table(surface, 10.0**low, 10.0**high, num)

    def leak(
        self,
        table: ConductivityTable | GasConductivityTable,
        x: ArrayLike,
        pressure: ArrayLike,
        fluid_pressure: float,
        radius: ArrayLike,
        ends: tuple[float | None, float | None] | None = None,
    ) -> LeakResult:
        """Leak of a pressure profile.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
            From `table`.
        x, pressure : array_like
            Arc length [m] and contact pressure [Pa].
        fluid_pressure : float
            Pressure difference [Pa].
        radius : float or array_like
            [m]
        ends : tuple of float or None, optional
            x at which the faces end, see `leak.leak_flow` [m].

        Returns
        -------
        LeakResult
            A `leak.CoupledLeakResult` for fluid_in_gap = "local".
        """
        side = self.pressure_side
        if isinstance(table, ConductivityTable):
            flow = coupled_leak_flow if self.fluid_in_gap == "local" else leak_flow
            sigma = table.at(self.viscosity)
            found = flow(x, pressure, sigma, fluid_pressure, radius, pressure_side=side, ends=ends)
            return found.with_density(self.density)
        gas, outlet = self.gas, self.outlet_pressure
        assert gas is not None  # the table is one of a gas
        inlet = outlet + fluid_pressure
        return gas_leak_flow(
            x, pressure, table, gas, inlet, outlet, radius, pressure_side=side, ends=ends
        ).above_outlet

    def leak_of(
        self,
        table: ConductivityTable | GasConductivityTable,
        profile: PressureProfile,
        fluid_pressure: float,
    ) -> LeakResult:
        """Leak of one contact.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
            For all pressures of the contact.
        profile : PressureProfile
        fluid_pressure : float
            Pressure difference [Pa].
        """
        return self.leak(table, profile.x, profile.pressure, fluid_pressure, profile.radius, profile.ends)

    def mass_flow(self, leak_rate: float) -> float | None:
        """Mass flow [kg/s] of a leak rate [m^3/s]; None if the density is unknown."""
        return None if self.density is None else leak_rate * self.density

    def throughput(self, leak_rate: float) -> float | None:
        """Flow pV of a gas [Pa m^3/s]; None for a liquid."""
        return None if self.gas is None else leak_rate * _ATMOSPHERE

    def standard_leak_rate(self, leak_rate: float) -> float | None:
        """Volume flow of a gas at 0 degC and 101325 Pa [m^3/s]; None for a liquid."""
        return None if self.gas is None else leak_rate * _NORMAL_TEMPERATURE / self.gas.temperature
