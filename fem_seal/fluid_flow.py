"""Flow of the case's fluid through a rough contact: a liquid by its viscosity, a gas with slip and free molecules."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from leak.leak_rate import LeakResult

if TYPE_CHECKING:
    from fem_seal.case import Case
    from leak import ConductivityTable, GasConductivityTable, RoughContact


@dataclass(frozen=True, eq=False)
class GasLeak(LeakResult):
    """Flow of a gas; its leak rate is the volume at 101325 Pa and the temperature of the gas."""

    knudsen_number: float
    """Mean free path over u_eff at the peak of the contact pressure; infinite where sealed."""


def flow_table(
    case: Case, surface: RoughContact, p_min: float, p_max: float, num: int = 64
) -> ConductivityTable | GasConductivityTable:
    """Flow conductivity of a surface for the case's fluid over a range of contact pressures.

    Parameters
    ----------
    case : Case
        With a fluid.
    surface : RoughContact
    p_min, p_max : float
        [Pa]
    num : int
        Number of pressures.
    """
    from leak import gas_conductivity_table

    method = case.leak.conductivity
    if case.fluid is not None and case.fluid.gas is not None:
        return gas_conductivity_table(surface, p_min, p_max, num, method)
    return surface.conductivity_table(p_min, p_max, num, method=method)


def leak_of_profile(
    case: Case,
    table: ConductivityTable | GasConductivityTable,
    x: ArrayLike,
    pressure: ArrayLike,
    fluid_pressure: float,
    radius: ArrayLike,
    ends: tuple[float | None, float | None] | None = None,
) -> LeakResult:
    """Leak of a pressure profile with the case's fluid.

    Parameters
    ----------
    case : Case
    table : ConductivityTable or GasConductivityTable
        From `flow_table`.
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
        For a gas a `GasLeak`; a `leak.CoupledLeakResult` for
        leak.fluid_in_gap = "local".
    """
    from leak import ConductivityTable, coupled_leak_flow, gas_leak_flow, leak_flow

    fluid, side = case.fluid, case.load.pressure_side
    assert fluid is not None
    if isinstance(table, ConductivityTable):
        flow = coupled_leak_flow if case.leak.fluid_in_gap == "local" else leak_flow
        sigma = table.at(fluid.viscosity)
        return flow(x, pressure, sigma, fluid_pressure, radius, pressure_side=side, ends=ends)
    gas, outlet = fluid.gas, fluid.outlet_pressure
    assert gas is not None and outlet is not None
    found = gas_leak_flow(
        x, pressure, table, gas, outlet + fluid_pressure, outlet, radius, pressure_side=side, ends=ends
    )
    resistance = fluid_pressure / found.leak_rate if found.leak_rate > 0.0 else np.inf
    return GasLeak(found.leak_rate, resistance, found.fluid_pressure - outlet, found.knudsen_number)
