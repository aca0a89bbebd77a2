"""The leak integral: how much of a permeant a pressure profile lets through, a liquid or a gas at one temperature.

A permeant has a flow potential, its inverse and the conductance of a gap. Of a liquid the potential is psi
(`leak.FlowPotential`), and what flows is counted as volume at atmospheric pressure. Of a gas it is w
(`leak.GasPotential`), and what flows is mass. A gap conducts sigma in the continuum; flow over the slope of the
potential is sigma times the gain, which depends on the pressure of a rarefied gas, times a constant.

What flows where nothing seals stands at the end: through an open bore, and through the gap of faces that just touch.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Protocol, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ConductivityError, ProfileError, as_arrays, positive
from leak.flow.conductivity import GasConductivity, log_rarefied_flow
from leak.flow.contact_profile import (
    SMALLEST_LOG_PRESSURE,
    ContactProfile,
    checked_profile,
    checked_side,
    profile_after,
)
from leak.flow.groove_section import GrooveSection
from leak.flow.leak_result import GasLeakResult, LeakResult
from leak.flow.rarefied import log_flow_factor
from leak.flow.rough_contact import RoughContact, gas_conductivity_table
from leak.fluids.library import heat_capacity_ratio
from leak.fluids.properties import GAS_CONSTANT, FlowPotential, Gas, GasPotential, PressureLaw
from leak.numerics.anderson import mixing_weights
from leak.numerics.curves import MonotoneCurve, spline_slopes
from leak.numerics.integrals import gauss, integrals_up_to_nodes
from leak.numerics.roots import MOST_STEPS
from leak.standards import STANDARD_PRESSURE

# First-order slip of `poiseuille_flow_rate`.
_SLIP = 1.0162
# Of the slip pressure in the potential of a gas, over its highest pressure: where no gap is left w is linear in p_f.
_MOST_SLIP = 1e3
# Contact pressures this far below the peak add less than 1e-6 of the flow resistance.
_TABLE_DECADES = 9.0
# Of a perfect vacuum: density times conductance of free molecules does not depend on the pressure any more [Pa].
_VACUUM = 1e-9
# ln of what counts as a gap times the pressure of the gas where there is none.
_NO_GAP = -200.0


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
    low : float
        Pressure above atmosphere on the other side [Pa].
    """

    high: float
    conductivity: Function | None
    potential: FlowPotential
    viscosity: float = 1.0
    density: float | None = None
    low: float = 0.0

    # least number that a profile must have
    cells = 1
    # whether the gain depends on the fluid pressure, so that both are found in turn
    sweeps = False
    # flow over sigma, the gain and the slope of the potential
    per_potential: ClassVar[float] = 1.0

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
        return cls(drop, sigma, FlowPotential.of(law, drop), eta, density)

    def sigma(self, log_pressure: FloatArray) -> FloatArray:
        """Of the rough contact in the continuum, at ln(p/Pa) of first loading [m^3/(Pa s)]."""
        return np.zeros(log_pressure.shape) if self.conductivity is None else self.conductivity(log_pressure)

    def flow_pressure(self, potential: FloatArray) -> FloatArray:
        """What the gain depends on, at values of the potential: here on nothing."""
        return potential

    def gain(self, log_pressure: FloatArray, gap: FloatArray) -> Function:
        """Of gaps at ln(p/Pa) of first loading, over the flow pressure: one."""
        return np.ones_like

    def groove_conductance(
        self, section: GrooveSection, pressure: FloatArray, modulus: float, flow_pressure: FloatArray
    ) -> FloatArray:
        """K of a groove times its gain, at contact pressures less what the fluid takes off them [m^4/(Pa s)]."""
        return section.liquid_conductance(pressure, modulus, self.viscosity)

    def at_narrowest(self, gap: float) -> LiquidPermeant:
        """With the potential that suits a contact whose narrowest place is so wide [m]: psi suits all of them."""
        return self

    def result(self, flow: float, pressure: FloatArray, peak: int, gap: float) -> LeakResult:
        """A flow, with fluid pressures [Pa], and the gap at the peak of the contact pressure, zero if sealed [m]."""
        resistance = (self.high - self.low) / flow if flow > 0.0 else float("inf")
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
            log_width = np.maximum(np.log(gap / (self.viscosity * self.gas.molecular_speed)), _NO_GAP)
        table = self.conductivity
        log_flow = log_flow_factor if table is None else log_rarefied_flow(table, log_pressure)

        def gain(q: FloatArray) -> FloatArray:
            log_q = np.log(q)
            # next to a vacuum q and F are no numbers on their own
            return np.asarray(np.exp(log_q + log_flow(log_q + log_width)) / (q + self.slip))

        return gain

    def groove_conductance(
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
    ends = low, permeant.potential.at_highest
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
        is_wrong = usual & ~(values >= 0.0)
        if np.any(is_wrong):
            raise ProfileError(
                f"conductivity({p[is_wrong].flat[0]}) = {values[is_wrong].flat[0]}: must not be negative [m^3/(Pa s)]"
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
    is_wrong = ~(values >= 0.0)
    if is_wrong.any():
        raise ProfileError(f"conductivity = {values[is_wrong][0]}: must not be negative")
    is_usable = (p > np.exp(SMALLEST_LOG_PRESSURE)) & np.isfinite(values)
    # Both flanks pass the same pressures, up to round-off.
    log_p, order = np.unique(np.round(np.log(p[is_usable]), 9), return_index=True)
    width = np.cbrt(values[is_usable][order])
    if log_p.size < 3:
        raise ProfileError(
            "conductivity: at least 3 different pressures are needed; give a function of p instead"
        )
    curve = MonotoneCurve(log_p, width, spline_slopes(log_p, width))
    return lambda pressure: np.maximum(curve.value(np.log(pressure)), 0.0) ** 3


_TOLERANCE = 1e-11
# So many sweeps before the last are mixed with it; plain ones would swing with a vacuum ahead of wide gaps.
_HISTORY = 4


def leak_rate(
    x: ArrayLike,
    p: ArrayLike,
    conductivity: SigmaOfPressure | LogConductivity | ArrayLike,
    pressure_drop: float,
    radius: ArrayLike,
) -> float:
    """Volume flow Q = Delta P / int dx/(2 pi r(x) sigma_eff(p(x))) through a contact pressure profile.

    The fluid pressure must be small against the contact pressure. Between the points ln p is a cubic spline; tails
    of p beyond the ends are continued as in `leak_flow`.

    Parameters
    ----------
    x : array_like
        Arc length across the contact, strictly increasing, shape (n,), n >= 3 [m].
    p : array_like
        Nominal contact pressure there, not negative, shape (n,) [Pa].
    conductivity : callable or array_like
        sigma_eff(p) of an array of pressures [m^3/(Pa s)], for example `ConductivityTable.at(viscosity)`; or its
        values at the points, shape (n,).
    pressure_drop : float
        Fluid pressure difference Delta P [Pa].
    radius : float or array_like
        Distance from the axis r, one number or one per point [m].

    Returns
    -------
    float
        Q [m^3/s].

    Raises
    ------
    ProfileError
        The profile or another input cannot be used; the message says which value.

    References
    ----------
    Fischer et al., "Fluid leakage in metallic seals", eqs. (13)-(15).

    Examples
    --------
    A uniform contact of width 1 mm on a ring of radius 14 mm:

    >>> Q = leak_rate([0, 5e-4, 1e-3], [1e6, 1e6, 1e6], lambda p: 1e-15 + 0 * p, 2e6, 0.014)
    >>> print(f"{Q:.4e}")
    1.7593e-07
    """
    return leak_flow(x, p, conductivity, pressure_drop, radius).leak_rate


def leak_flow(
    x: ArrayLike,
    p: ArrayLike,
    conductivity: SigmaOfPressure | LogConductivity | ArrayLike,
    pressure_drop: float,
    radius: ArrayLike,
    *,
    pressure_side: str = "outer",
    ends: tuple[float | None, float | None] | None = None,
    largest_pressure: ArrayLike | None = None,
    pressure_law: PressureLaw | None = None,
) -> LeakResult:
    """Leak rate, flow resistance and fluid pressure along a contact pressure profile.

    Ends of the profile. Where p has reached zero the contact ends like a Hertzian one, p^2 being smooth. Where p
    is still positive and falling outward, ln p is continued by the parabola through the last three points (by the
    tangent, if that parabola bends upward) to infinity, or to where the face ends; both tails are part of the
    resistance. Where p does not fall outward the contact ends with its last point. Where the face ends within half of
    the last three points' distance, as it does in the last element of a mesh, that parabola goes on to its end
    wherever it leads.

    Parameters
    ----------
    x, p, conductivity, pressure_drop, radius
        See `leak_rate`.
    pressure_side : {"outer", "inner"}
        Side of the high fluid pressure: larger or smaller x.
    ends : tuple of float or None, optional
        x at which the faces end, inner and outer, None where they go on: nothing resists beyond [m].
    largest_pressure : array_like, optional
        Largest nominal pressure that each place has carried before, shape (n,) [Pa]; it is interpolated and continued
        like p, and counts where it exceeds p. The conductivity must know what it leaves behind, as that of a
        `RoughContact` does (`leak.flow.conductivity`). None: every place carries more than ever before.
    pressure_law : PressureLaw, optional
        How the liquid thickens and is compressed; the conductivity is that at atmospheric pressure, which is on the
        low side. None: pressure does not change it.

    Notes
    -----
    What is constant along x is the mass flow: Q = psi(Delta P)/int dx/(2 pi r sigma_eff), the volume at atmospheric
    pressure, with psi(p) = int_0^p (rho/rho0)(eta0/eta) dp' (`leak.FlowPotential`). psi(p_f) falls over the contact as
    the pressure of a liquid that does not thicken: p_f itself falls steeply next to the high pressure.

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> x = np.linspace(-0.5e-3, 0.5e-3, 101)
    >>> p = 50e6 * np.exp(-(x / 0.2e-3) ** 2)
    >>> found = leak.leak_flow(x, p, lambda p: 1e-10 / p, 1e5, 0.014)
    >>> print(f"{found.leak_rate:.3g} m^3/s")
    4.96e-11 m^3/s
    >>> found.fluid_pressure.shape
    (101,)

    Asperities that have yielded under twice the pressure:

    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9, hardness=2e9, yielding="capped")
    >>> water = surface.conductivity_table(1e3, 1e9).at(viscosity=1e-3)
    >>> first, after = (leak.leak_flow(x, p, water, 1e5, 0.014, largest_pressure=most) for most in (None, 2 * p))
    >>> after.leak_rate < first.leak_rate
    True

    An oil that thickens by 20/GPa; in closed form Q is (1 - exp(-alpha Delta P))/(alpha Delta P) of that without:

    >>> thin, thick = (leak.leak_flow(x, p, water, 5e7, 0.014, pressure_law=law) for law in (None, leak.Barus(20e-9)))
    >>> f"{thick.leak_rate / thin.leak_rate:.6f} {1.0 - np.exp(-1.0):.6f}"
    '0.632121 0.632121'
    """
    xs, ps, rs = checked_profile(x, p, radius)
    profile = profile_after(xs, ps, rs, ends, largest_pressure, conductivity)
    if not (callable(conductivity) or isinstance(conductivity, LogConductivity)):
        conductivity = through_values(ps, conductivity)
    liquid = LiquidPermeant.of(conductivity, pressure_drop, pressure_law)
    return liquid.result(*flow_through(profile, xs, ps, liquid, pressure_side))


def gas_leak_flow(
    x: ArrayLike,
    p: ArrayLike,
    surface: RoughContact | GasConductivity,
    gas: Gas,
    inlet_pressure: float,
    outlet_pressure: float,
    radius: ArrayLike,
    *,
    pressure_side: str = "outer",
    method: str = "bruggeman",
    ends: tuple[float | None, float | None] | None = None,
    largest_pressure: ArrayLike | None = None,
) -> GasLeakResult:
    """Mass flow of a gas through a contact pressure profile.

    The constant mass flow G obeys dp_f/dx = -G/(2 pi r rho(p_f) sigma_eff(p, p_f)) with rho = p_f/(R_s T), or that of a
    real gas, and sigma_eff of the rarefied gas. The gas pressure must be small against the contact pressure.

    Parameters
    ----------
    x : array_like
        Arc length across the contact, strictly increasing, shape (n,), n >= 3 [m].
    p : array_like
        Nominal contact pressure there, not negative, shape (n,) [Pa].
    surface : RoughContact or GasConductivity
        The rough interface, or its table from `gas_conductivity_table`.
    gas : Gas
        From `leak.gas`.
    inlet_pressure, outlet_pressure : float
        Absolute gas pressures; zero at the outlet is vacuum [Pa].
    radius : float or array_like
        Distance from the axis r, one number or one per point [m].
    pressure_side : {"outer", "inner"}
        Side of the inlet: larger or smaller x.
    method : {"bruggeman", "critical-junction", "threshold-law"}
        See `RoughContact.effective_separation`; for a `RoughContact` only.
    ends : tuple of float or None, optional
        x at which the faces end, see `leak.leak_flow` [m].
    largest_pressure : array_like, optional
        Largest nominal pressure that each place has carried before, see `leak.leak_flow` [Pa].

    Raises
    ------
    ProfileError
        The profile or another input cannot be used; the message says which value.

    Notes
    -----
    With ds = dx/(2 pi r u_eff^3), F = 12 eta sigma_eff/u_eff^3 and w = p_f^2 + 2 c p_f the equation is
    dw/ds = -24 eta R_s T G (p_f + c)/(p_f F). In the continuum F = 1, free molecules have F ~ 1/p_f, and slip
    p_f F = p_f + c with c = 6 (1.0162) eta v0/u: taken at the narrowest place, the right side hardly depends on p_f in
    all three. It is integrated with the last p_f, over and over; a vacuum at the outlet is no special case. A real gas
    has q = (p_f/Z)(eta0/eta) in place of p_f on the right side and in F, and w = int 2 (q + c) dp_f.

    Examples
    --------
    >>> from leak import PowerSpectrum, gas, gaussian_line
    >>> spectrum = PowerSpectrum.self_affine(
    ...     rms_height=0.2e-6, hurst=0.8, q_low=1e4, q_rolloff=1e5, q_high=1e7
    ... )
    >>> surface = RoughContact(spectrum, effective_modulus=115e9)
    >>> line = gaussian_line(line_load=20e3, radius=0.02, u0=0.1e-6)
    >>> x = np.linspace(-4, 4, 201) * line.std
    >>> leak = gas_leak_flow(x, line.pressure(x), surface, gas("helium"), 1e5, 0.0, 0.0141421)
    >>> leak.throughput > 0.0
    True
    """
    xs, ps, rs = checked_profile(x, p, radius)
    table = gas_table(surface, ps, largest_pressure, method)
    permeant = GasPermeant.of(table, gas, inlet_pressure, outlet_pressure)
    profile = profile_after(xs, ps, rs, ends, largest_pressure, table)
    return permeant.result(*flow_through(profile, xs, ps, permeant, pressure_side))


# -------------------------------------------------------------------- of any fluid


def flow_through(
    profile: ContactProfile, x: FloatArray, p: FloatArray, permeant: Permeant, pressure_side: str = "outer"
) -> tuple[float, FloatArray, int, float]:
    """Flow through a profile between and beyond its points, of which several fluids may make use.

    Parameters
    ----------
    profile : ContactProfile
    x, p : ndarray, shape (n,)
        Its points [m], where the fluid pressure is wanted, and the contact pressure there [Pa].
    permeant : LiquidPermeant or GasPermeant
    pressure_side : {"outer", "inner"}
        See `leak_flow`.

    Returns
    -------
    flow, pressure, peak, gap
        What `permeant.result` takes; the gap only of a gas.
    """
    profile = profile.with_cells(permeant.cells)
    log_p, weight, begin = profile.quadrature
    sigma = permeant.sigma(log_p)
    # Next to nothing gets through where the contact all but seals: the resistance is infinite there, too.
    with np.errstate(divide="ignore", over="ignore"):
        resistance = weight / sigma
        stretches = np.add.reduceat(resistance, begin)
    is_sealed = math.isinf(stretches.sum())
    peak, at_peak = int(np.argmax(p)), 0.0
    if is_sealed:
        # it drops there alone
        stretches = np.isinf(stretches).astype(float)
    elif permeant.sweeps:
        gap = gap_of(permeant, sigma)
        permeant = permeant.at_narrowest(float(gap.min()))
        ends = potential_ends(permeant, pressure_side)
        stretches = _resistance_with_gains(profile, resistance, permeant, permeant.gain(log_p, gap), ends)
        at_peak = float(gap_of(permeant, permeant.sigma(profile.log_equivalent(x[peak], np.log(p[peak])))))
    first, last = potential_ends(permeant, pressure_side)
    offset, cells = int(profile.panels[0] is not None), profile.x.size - 1
    sums = np.cumsum(np.concatenate([[0.0], stretches]))
    share = np.interp(x, profile.x, sums[offset : offset + cells + 1] / sums[-1])
    flow = 0.0 if is_sealed else abs(last - first) * permeant.per_potential / float(stretches.sum())
    return flow, permeant.potential.pressure(first * (1.0 - share) + last * share), peak, at_peak


def _resistance_with_gains(
    profile: ContactProfile,
    resistance: FloatArray,
    permeant: Permeant,
    gain: Function,
    ends: tuple[float, float],
) -> FloatArray:
    """Resistance of each stretch with the gains at the fluid pressure that belongs to them.

    Parameters
    ----------
    resistance : ndarray
        At all points of the quadrature, with a gain of one [Pa s/m^3].
    """
    begin = profile.quadrature[2]
    panels = [part for part in profile.panels if part is not None]
    cuts = np.cumsum([part.stretch.size for part in panels])[:-1]
    points = np.diff(np.append(begin, resistance.size))
    low, high = min(ends), max(ends)

    def potentials(values: FloatArray, stretches: FloatArray) -> FloatArray:
        parts = zip(panels, np.split(values, cuts), strict=True)
        inner = np.concatenate(
            [
                (part.reshape(panel.stretch.shape) @ integrals_up_to_nodes(panel.stretch.shape[1]).T).ravel()
                for panel, part in parts
            ]
        )
        # counted from the end with the lower pressure, so that vacuum stays exact there
        if ends[0] < ends[1]:
            share = np.repeat(np.cumsum(stretches) - stretches, points) + inner
        else:
            share = np.repeat(np.cumsum(stretches[::-1])[::-1], points) - inner
        return low + (high - low) * (np.maximum(share, 0.0) / stretches.sum())

    potential = potentials(resistance, np.add.reduceat(resistance, begin))
    last_sum, roots, steps = math.inf, np.empty((0, potential.size)), np.empty((0, potential.size))
    # eight are usual, with a vacuum ahead of wide gaps thirty
    for _ in range(MOST_STEPS):
        over_gain = resistance / gain(permeant.flow_pressure(potential))
        stretches = np.add.reduceat(over_gain, begin)
        total = float(stretches.sum())
        if abs(total / last_sum - 1.0) < _TOLERANCE:
            return stretches
        last_sum = total
        root = np.sqrt(potentials(over_gain, stretches))
        roots = np.concatenate([roots[-_HISTORY:], [root]])
        steps = np.concatenate([steps[-_HISTORY:], [root - np.sqrt(potential)]])
        potential = np.minimum(np.maximum((mixing_weights(steps) @ roots) ** 2, low), high)
    raise ConductivityError(
        f"conductivity of the gas: its pressure in the contact was not found in {MOST_STEPS} iterations; "
        "a gain that falls no faster than 1/p_f has one"
    )


# Of a gas of which it is not known: that of one atom in a molecule, the largest.
_MONATOMIC = 5.0 / 3.0


def liquid_through_bore(radius: float, pressure_drop: float, density: float) -> float:
    """Volume flow of a liquid through an open bore without friction, A sqrt(2 dp/rho) (Bernoulli, Torricelli) [m^3/s].

    Parameters
    ----------
    radius : float
        Of the bore [m].
    pressure_drop : float
        [Pa]
    density : float
        [kg/m^3]

    Examples
    --------
    >>> f"{liquid_through_bore(5e-3, 1e5, 1000.0) * 6e4:.1f} l/min"
    '66.6 l/min'
    """
    return math.pi * radius**2 * math.sqrt(2.0 * pressure_drop / density)


def gas_through_bore(radius: float, gas: Gas, high: float, low: float) -> float:
    """Mass flow of a gas through an open bore without friction or heat, at most that of choked flow [kg/s].

    Isentropic flow of an ideal gas with the density that the gas has at the high pressure (de Saint-Venant, Wantzel;
    ISO 9300). Where a real gas is as dense as a liquid, it flows some tens of per cent otherwise.

    Parameters
    ----------
    radius : float
        Of the bore [m].
    gas : Gas
    high, low : float
        Absolute pressures [Pa].

    Examples
    --------
    >>> import leak
    >>> f"{gas_through_bore(0.5e-3, leak.gas('nitrogen', 293.15), 1e6, 1e5) * 1e3:.2f} g/s"
    '1.82 g/s'
    """
    kappa = heat_capacity_ratio(gas.name) or _MONATOMIC
    choked_ratio = (2.0 / (kappa + 1.0)) ** (kappa / (kappa - 1.0))
    ratio = max(low / high, choked_ratio)
    factor = 1.0 if gas.real is None else float(gas.real.factor(high))
    density = high * gas.molar_mass / (factor * GAS_CONSTANT * gas.temperature)
    expansion = ratio ** (2.0 / kappa) - ratio ** ((kappa + 1.0) / kappa)
    return math.pi * radius**2 * math.sqrt(2.0 * kappa / (kappa - 1.0) * high * density * expansion)


def gap_resistance(x: FloatArray, radius: FloatArray, gap: FloatArray) -> float:
    """Resistance of a smooth ring-shaped gap over the viscosity, 12 int dx/(2 pi r gap^3) [1/m^3].

    Parameters
    ----------
    x, radius, gap : ndarray, shape (n,)
        Along the flow, distance from the axis and gap [m].

    Examples
    --------
    >>> x = np.linspace(0.0, 1e-3, 5)
    >>> f"{gap_resistance(x, np.full(5, 1e-2), np.full(5, 1e-5)):.3g}"
    '1.91e+14'
    """
    return float(np.trapezoid(12.0 / (2.0 * math.pi * radius * gap**3), x))


def gas_through_gap(resistance: float, gap: float, gas: Gas, high: float, low: float) -> float:
    """Volume flow of a gas through a gap, at 101325 Pa and its temperature, isothermal and rarefied [m^3/s].

    Parameters
    ----------
    resistance : float
        See `gap_resistance` [1/m^3].
    gap : float
        Where it is narrowest, for what rarefaction adds: the most [m].
    gas : Gas
    high, low : float
        Absolute pressures [Pa].

    Examples
    --------
    >>> import leak
    >>> helium = leak.gas("helium")
    >>> dense, thin = (gas_through_gap(1e15, u, helium, 2e5, 1e5) for u in (1e-4, 1e-6))
    >>> dense < thin < 3.0 * dense
    True
    """
    at, weights = gauss(64)
    pressure = 0.5 * (high + low) + 0.5 * (high - low) * at
    paths = np.array([gas.mean_free_path(max(p, 1e-6 * high)) for p in pressure])
    gain = np.exp(log_flow_factor(np.log(0.5 * math.sqrt(math.pi) * gap / paths)))
    integral = 0.5 * (high - low) * float(weights @ (gas.flow_pressure(pressure) * gain))
    return integral / (gas.viscosity * resistance * STANDARD_PRESSURE)
