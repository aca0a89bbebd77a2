"""A permeant, liquid or gas: flow potential, its inverse, conductance of a gap.

Of a liquid the potential is psi (`leak.FlowPotential`), and what flows is counted as volume at atmospheric pressure. Of
a gas it is w (`leak.GasPotential`), and what flows is mass. A gap conducts sigma in the continuum; flow over the slope
of the potential is sigma times the gain, which depends on the pressure of a rarefied gas, times a constant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray, as_arrays
from leak.errors import ProfileError, positive
from leak.flow.conductivity import GasConductivity, log_rarefied_flow
from leak.flow.contact_profile import SMALLEST_LOG_PRESSURE, checked_side
from leak.flow.groove_section import GrooveSection
from leak.flow.leak_result import GasLeakResult, LeakResult
from leak.flow.rarefied import log_flow_factor
from leak.flow.rough_contact import RoughContact, gas_conductivity_table
from leak.fluids.pressure_law import FlowPotential, PressureLaw
from leak.fluids.properties import Gas
from leak.fluids.real_gas import GasPotential
from leak.numerics.curves import MonotoneCurve, spline_slopes

# First-order slip of `poiseuille_flow_rate`.
_SLIP = 1.0162
# Of the slip pressure in the potential of a gas, over its highest pressure: where no gap is left w is linear in p_f.
_MOST_SLIP = 1e3
# Contact pressures this far below the peak add less than 1e-6 of the flow resistance.
_TABLE_DECADES = 9.0
# Of a perfect vacuum: density times conductance of free molecules does not depend on the pressure any more [Pa].
_VACUUM = 1e-9
# ln of what counts as a gap times the pressure of the gas where there is none.
_SHUT = -200.0


@runtime_checkable
class LogConductivity(Protocol):
    """A conductivity that can also be asked by ln p, where p underflows."""

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """sigma_eff at ln(p/Pa) [m^3/(Pa s)]."""


SigmaOfPressure = Callable[[FloatArray], ArrayLike]
Function = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class LiquidPermeant:
    """A liquid between the pressures of both sides.

    Parameters
    ----------
    high : float
        Pressure above the low side [Pa].
    conductivity : callable or None
        sigma_eff at ln(p/Pa) [m^3/(Pa s)]; None where the rough contact lets nothing through.
    potential : FlowPotential
        Zero at a pressure of zero.
    viscosity : float
        At atmospheric pressure [Pa s]; who does not ask for a gap need not know it.
    density : float or None
        At atmospheric pressure [kg/m^3]; None where it is not known.
    """

    high: float
    conductivity: Function | None
    potential: FlowPotential
    viscosity: float = 1.0
    density: float | None = None

    # least number that a profile must have
    cells = 1
    # whether the gain depends on the fluid pressure, so that both are found in turn
    sweeps = False
    low = 0.0
    # flow over sigma, the gain and the slope of the potential
    per_potential = 1.0

    @classmethod
    def of(
        cls,
        conductivity: SigmaOfPressure | LogConductivity | None,
        pressure_drop: float,
        law: PressureLaw | None = None,
        viscosity: float = 1.0,
        density: float | None = None,
    ) -> LiquidPermeant:
        """A liquid that a drop of its pressure drives through a contact."""
        drop = positive(ProfileError, "pressure_drop", pressure_drop, "Pa")
        eta = positive(ProfileError, "viscosity", viscosity, "Pa s")
        sigma = None if conductivity is None else by_log_pressure(conductivity)
        return cls(drop, sigma, FlowPotential(law, drop), eta, density)

    def sigma(self, log_pressure: FloatArray) -> FloatArray:
        """Of the rough contact in the continuum, at ln(p/Pa) of first loading [m^3/(Pa s)]."""
        return np.zeros(log_pressure.shape) if self.conductivity is None else self.conductivity(log_pressure)

    def flow_pressure(self, potential: FloatArray) -> FloatArray:
        """What the gain depends on, at values of the potential: here on nothing."""
        return potential

    def gain(self, log_pressure: FloatArray, gap: FloatArray) -> Function:
        """Of gaps at ln(p/Pa) of first loading, over the flow pressure: one."""
        return np.ones_like

    def along(
        self, section: GrooveSection, pressure: FloatArray, modulus: float, flow_pressure: FloatArray
    ) -> FloatArray:
        """K of a groove times its gain, at contact pressures less what the fluid takes off them [m^4/(Pa s)]."""
        return section.liquid_conductance(pressure, modulus, self.viscosity)

    def at_narrowest(self, gap: float) -> LiquidPermeant:
        """With the potential that suits a contact whose narrowest place is so wide [m]: psi suits all of them."""
        return self

    def result(self, flow: float, pressure: FloatArray, peak: int, gap: float) -> LeakResult:
        """A flow, with fluid pressures [Pa], and the gap at the peak of the contact pressure, zero if sealed [m]."""
        resistance = self.high / flow if flow > 0.0 else float("inf")
        return LeakResult(flow, resistance, pressure).with_density(self.density)


@dataclass(frozen=True, eq=False)
class GasPermeant:
    """A gas, which is rarefied where its path is long against the gap; its members are those of a `LiquidPermeant`.

    Parameters
    ----------
    low, high : float
        Absolute [Pa].
    conductivity : GasConductivity or None
        None where the rough contact lets nothing through.
    gas : Gas
    slip : float
        In the potential, see `leak.GasPotential` [Pa].
    """

    low: float
    high: float
    conductivity: GasConductivity | None
    gas: Gas
    slip: float = 0.0

    # Fluid pressures bend even where contact pressures do not: 1e-6 of the flow with so many.
    cells = 100
    sweeps = True

    @classmethod
    def of(
        cls, table: GasConductivity | None, gas: Gas, inlet_pressure: float, outlet_pressure: float
    ) -> GasPermeant:
        """A gas between two absolute pressures [Pa], that of the outlet at least zero and below the other."""
        p_in = positive(ProfileError, "inlet_pressure", inlet_pressure, "Pa")
        try:
            p_out = float(outlet_pressure)
        except (TypeError, ValueError):
            p_out = float("nan")
        if not 0.0 <= p_out < p_in:
            raise ProfileError(
                f"outlet_pressure = {outlet_pressure!r}: must be at least 0 (vacuum) and below the inlet_pressure = "
                f"{p_in} [Pa], both absolute"
            )
        return cls(p_out, p_in, table, gas)

    @property
    def viscosity(self) -> float:
        """Of the dilute gas [Pa s]."""
        return self.gas.viscosity

    @cached_property
    def potential(self) -> GasPotential:
        """w."""
        return GasPotential(self.gas.real, self.high, self.slip)

    @property
    def per_potential(self) -> float:
        """1/(2 R_s T), of w [s^2/m^2]."""
        return 0.5 / (self.gas.specific_gas_constant * self.gas.temperature)

    def sigma(self, log_pressure: FloatArray) -> FloatArray:
        """Of the rough contact in the continuum [m^3/(Pa s)]."""
        if self.conductivity is None:
            return np.zeros(log_pressure.shape)
        return np.asarray(self.conductivity.at_log_pressure(log_pressure)) ** 3 / (12.0 * self.viscosity)

    def flow_pressure(self, potential: FloatArray) -> FloatArray:
        """q at values of w [Pa]."""
        return np.maximum(self.potential.flow_pressure(potential), _VACUUM)

    def gain(self, log_pressure: FloatArray, gap: FloatArray) -> Function:
        """q F/(q + c), F = 12 eta sigma_eff/u_eff^3, over q."""
        with np.errstate(divide="ignore"):
            log_width = np.maximum(np.log(gap / (self.viscosity * self.gas.molecular_speed)), _SHUT)
        table = self.conductivity
        log_flow = log_flow_factor if table is None else log_rarefied_flow(table, log_pressure)

        def gain(q: FloatArray) -> FloatArray:
            log_q = np.log(q)
            # next to a vacuum q and F are no numbers on their own
            return np.asarray(np.exp(log_q + log_flow(log_q + log_width)) / (q + self.slip))

        return gain

    def along(
        self, section: GrooveSection, pressure: FloatArray, modulus: float, flow_pressure: FloatArray
    ) -> FloatArray:
        """K of a groove times its gain [m^4/(Pa s)]."""
        K = section.gas_conductance(pressure, modulus, self.gas, flow_pressure)
        return np.asarray(K * (flow_pressure / (flow_pressure + self.slip)))

    def at_narrowest(self, gap: float) -> GasPermeant:
        """With c = 6 (1.0162) eta v0/u, at which slip carries as much through this gap as viscous flow does."""
        slip = 6.0 * _SLIP * self.viscosity * self.gas.molecular_speed / max(gap, 1e-300)
        return replace(self, slip=min(slip, _MOST_SLIP * self.high))

    def result(self, flow: float, pressure: FloatArray, peak: int, gap: float) -> GasLeakResult:
        """A mass flow, with absolute pressures."""
        free_path = self.gas.mean_free_path(max(float(pressure[peak]), 1e-300))
        # next to sealing u_eff may be too small for a floating-point number where the flow still is not
        knudsen = free_path / gap if gap > 0.0 else float("inf")
        return GasLeakResult(self.gas, self.high, self.low, flow, pressure, knudsen)


Permeant = LiquidPermeant | GasPermeant


def gap_of(permeant: Permeant, sigma: FloatArray) -> FloatArray:
    """u_eff = (12 eta sigma)^(1/3) [m]."""
    return np.cbrt(12.0 * permeant.viscosity * sigma)


def potential_ends(permeant: Permeant, pressure_side: str) -> tuple[float, float]:
    """Potential at small and at large x, for the side of the high pressure."""
    checked_side(pressure_side)
    low = float(permeant.potential(permeant.low)) if permeant.low else 0.0
    ends = low, permeant.potential.whole
    return ends if pressure_side == "outer" else ends[::-1]


def gas_table(
    surface: RoughContact | GasConductivity, p: FloatArray, largest: ArrayLike | None, method: str
) -> GasConductivity:
    """Conductivity of a surface for a profile, or its table itself.

    Over whole decades, so that neighbouring profiles share one table, up to the largest pressure that is remembered.
    """
    if not isinstance(surface, RoughContact):
        return surface
    highest = p if largest is None else np.append(p, np.max(np.asarray(largest, dtype=float)))
    decade = np.log10(highest.max())
    low, high = np.floor(decade - _TABLE_DECADES), np.ceil(decade + 1e-3)
    return gas_conductivity_table(surface, 10.0**low, 10.0**high, method=method)


def by_log_pressure(conductivity: SigmaOfPressure | LogConductivity) -> Function:
    """sigma_eff as a function of ln p; infinite where p underflows and the callable only knows p."""
    # to look at all of the protocol takes longer than a profile
    if hasattr(conductivity, "at_log_pressure"):
        return cast(LogConductivity, conductivity).at_log_pressure
    of_pressure = conductivity

    def sigma(log_p: FloatArray) -> FloatArray:
        usual = log_p > SMALLEST_LOG_PRESSURE
        p = np.exp(np.where(usual, log_p, 0.0))
        # In the tails p is tiny: a power law in it may overflow to infinity, which is what it should be.
        with np.errstate(over="ignore", divide="ignore"):
            values = np.broadcast_to(np.asarray(of_pressure(p), dtype=float), p.shape)
        wrong = usual & ~(values >= 0.0)
        if np.any(wrong):
            raise ProfileError(
                f"conductivity({p[wrong].flat[0]}) = {values[wrong].flat[0]}: must not be negative [m^3/(Pa s)]"
            )
        return np.where(usual, values, np.inf)

    return sigma


def through_values(p: FloatArray, conductivity: ArrayLike) -> SigmaOfPressure:
    """sigma_eff(p) through its values at the points: sigma^(1/3), nearly straight over ln p, is interpolated."""
    (values,) = as_arrays(ProfileError, "conductivity must be a function of p or numbers", conductivity)
    if values.shape != p.shape:
        raise ProfileError(
            f"conductivity has shape {values.shape}: must be a function of p, or {p.shape} like p [m^3/(Pa s)]"
        )
    wrong = ~(values >= 0.0)
    if wrong.any():
        raise ProfileError(f"conductivity = {values[wrong][0]}: must not be negative")
    there = (p > np.exp(SMALLEST_LOG_PRESSURE)) & np.isfinite(values)
    # Both flanks pass the same pressures, up to round-off.
    log_p, order = np.unique(np.round(np.log(p[there]), 9), return_index=True)
    width = np.cbrt(values[there][order])
    if log_p.size < 3:
        raise ProfileError(
            "conductivity: at least 3 different pressures are needed; give a function of p instead"
        )
    curve = MonotoneCurve(log_p, width, spline_slopes(log_p, width))
    return lambda pressure: np.maximum(curve.value(np.log(pressure)), 0.0) ** 3
