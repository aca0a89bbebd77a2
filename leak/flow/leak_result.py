"""What flows through a contact, the fluid pressure along it, and what follows: leakage area, Mach number of a gas."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.fluids.properties import Gas
from leak.standards import STANDARD_PRESSURE, STANDARD_TEMPERATURE


@dataclass(frozen=True, eq=False)
class LeakResult:
    """Flow of a liquid or a gas through a ring-shaped contact.

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> x = np.linspace(-0.5e-3, 0.5e-3, 101)
    >>> p = 50e6 * np.exp(-(x / 0.2e-3) ** 2)
    >>> found = leak.leak_flow(x, p, lambda p: 1e-10 / p, 1e5, 0.014)
    >>> found.resistance * found.leak_rate
    100000.0
    """

    leak_rate: float
    """Q at atmospheric pressure, of a gas at 101325 Pa and its temperature [m^3/s]; zero where sealed."""
    resistance: float
    """Pressure drop over Q [Pa s/m^3]; infinite where sealed."""
    fluid_pressure: FloatArray
    """Fluid pressure above the low side at the points x of the profile, shape (n,) [Pa]."""
    mass_flow: float | None = field(default=None, kw_only=True)
    """[kg/s]; None as long as no density is known, see `with_density`."""
    throughput: float | None = field(default=None, kw_only=True)
    """pV flow of a gas [Pa m^3/s]; None for a liquid."""
    standard_leak_rate: float | None = field(default=None, kw_only=True)
    """Volume flow of a gas at 0 degC and 101325 Pa [m^3/s]; None for a liquid."""
    knudsen_number: float | None = field(default=None, kw_only=True)
    """Of a gas: mean free path over u_eff at the peak contact pressure, infinite where sealed; None for a liquid."""

    lands: tuple[LandFlow, ...] = field(default=(), kw_only=True)
    """Of several contacts in series, from the axis outwards; empty for a single one."""

    def with_density(self, density: float | None) -> Self:
        """The same flow of a liquid with its mass.

        Parameters
        ----------
        density : float or None
            At atmospheric pressure, where the leak rate is counted [kg/m^3]; None leaves the mass unknown.

        Examples
        --------
        >>> import numpy as np
        >>> drops = LeakResult(1e-9, 1e15, np.zeros(3))
        >>> f"{drops.with_density(1000.0).mass_flow:.1e}"
        '1.0e-06'
        """
        return self if density is None else replace(self, mass_flow=density * self.leak_rate)

    @property
    def above_outlet(self) -> LeakResult:
        """Itself, as its fluid pressures are above that of the outlet; see `GasLeakResult.above_outlet`."""
        return self

    def scaled(self, leak_rate: float) -> Self:
        """The same flow with another leak rate; mass and pV flow go with it.

        Parameters
        ----------
        leak_rate : float
            [m^3/s]

        Returns
        -------
        LeakResult
            The same one if the contact is sealed or open: there is nothing to scale.

        Examples
        --------
        >>> import numpy as np
        >>> drops = LeakResult(1e-9, 1e15, np.zeros(3)).with_density(1000.0)
        >>> f"{drops.scaled(2e-9).mass_flow:.1e}"
        '2.0e-06'
        """
        if not 0.0 < self.leak_rate < math.inf:
            return self
        share = leak_rate / self.leak_rate

        def times(value: float | None) -> float | None:
            return None if value is None else share * value

        return replace(
            self,
            leak_rate=leak_rate,
            resistance=self.resistance / share if share else math.inf,
            mass_flow=times(self.mass_flow),
            throughput=times(self.throughput),
            standard_leak_rate=times(self.standard_leak_rate),
            lands=tuple(land._replace(leak_rate=share * land.leak_rate) for land in self.lands),
        )


class LandFlow(NamedTuple):
    """Flow through one of several contacts in series, between two pressures above the low side [Pa].

    Examples
    --------
    >>> LandFlow(inner_pressure=2e5, outer_pressure=0.0, leak_rate=1e-9).leak_rate
    1e-09
    """

    inner_pressure: float
    outer_pressure: float
    leak_rate: float
    """[m^3/s], towards the lower pressure; where the contact is open that of those beside it which touch."""


@dataclass(frozen=True, eq=False)
class GasLeakResult:
    """Flow of a gas through a ring-shaped contact; all pressures are absolute.

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> x = np.linspace(-0.5e-3, 0.5e-3, 101)
    >>> p = 50e6 * np.exp(-(x / 0.2e-3) ** 2)
    >>> helium = leak.gas("helium")
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> found = leak.gas_leak_flow(x, p, surface, helium, 2e5, 1e5, 0.014)
    >>> bool(found.mass_flow > 0), found.fluid_pressure.shape
    (True, (101,))
    """

    gas: Gas
    inlet_pressure: float
    """[Pa]"""
    outlet_pressure: float
    """[Pa]"""
    mass_flow: float
    """[kg/s]; zero where the contact is sealed."""
    fluid_pressure: FloatArray
    """Absolute gas pressure at the points x of the profile, shape (n,) [Pa]."""
    knudsen_number: float
    """Mean free path over u_eff at the peak contact pressure; infinite where sealed [-]."""

    @property
    def throughput(self) -> float:
        """pV flow, p dV/dt = mass flow times R_s T at the temperature of the gas [Pa m^3/s]."""
        return self.mass_flow * self.gas.specific_gas_constant * self.gas.temperature

    @property
    def leak_rate(self) -> float:
        """Volume per time at 101325 Pa and the temperature of the gas [m^3/s].

        This is what a valve test with an outlet open to the atmosphere collects; it has a meaning with a vacuum at
        the outlet too, where the volume at outlet conditions has none.
        """
        return self.throughput / STANDARD_PRESSURE

    @property
    def standard_leak_rate(self) -> float:
        """Volume per time at the standard state of 0 degC and 101325 Pa (DIN 1343, "sccm") [m^3/s]."""
        standard_density = STANDARD_PRESSURE / (self.gas.specific_gas_constant * STANDARD_TEMPERATURE)
        return self.mass_flow / standard_density

    @property
    def above_outlet(self) -> LeakResult:
        """The same flow in the terms of a liquid's: gas pressures above that of the outlet."""
        drop, rate = self.inlet_pressure - self.outlet_pressure, self.leak_rate
        return LeakResult(
            rate,
            drop / rate if rate > 0.0 else float("inf"),
            self.fluid_pressure - self.outlet_pressure,
            mass_flow=self.mass_flow,
            throughput=self.throughput,
            standard_leak_rate=self.standard_leak_rate,
            knudsen_number=self.knudsen_number,
        )


def leakage_area_of_liquid(leak_rate: float, pressure_drop: float, density: float) -> float:
    """Area of a sharp orifice without losses through which a liquid flows as fast, A = Q sqrt(rho/(2 dp)) [m^2].

    Bernoulli's equation with a discharge coefficient of one. The flow through a seal is laminar, Q ~ dp: A belongs to
    one pressure drop, and grows with its root.

    Parameters
    ----------
    leak_rate : float
        Q [m^3/s].
    pressure_drop : float
        dp [Pa].
    density : float
        rho [kg/m^3].

    Examples
    --------
    >>> f"{leakage_area_of_liquid(1e-6, 200e5, 1000.0) * 1e6:.3f} mm^2"
    '0.005 mm^2'
    """
    return leak_rate * math.sqrt(density / (2 * pressure_drop))


def leakage_area_of_gas(
    mass_flow: float, inlet_pressure: float, outlet_pressure: float, gas: Gas, heat_capacity_ratio: float
) -> float:
    """Area of an ideal nozzle through which a gas flows as fast [m^2].

    Isentropic flow of an ideal gas from rest, with a discharge coefficient of one (Saint-Venant and Wantzel):
    m = A p1 sqrt(2 k/((k - 1) R_s T) (r^(2/k) - r^((k + 1)/k))), r = p2/p1; below the critical ratio
    r* = (2/(k + 1))^(k/(k - 1)) the nozzle is choked and r* stands for r.

    Parameters
    ----------
    mass_flow : float
        m [kg/s].
    inlet_pressure, outlet_pressure : float
        p1, p2, absolute [Pa].
    gas : Gas
        At the temperature before the nozzle.
    heat_capacity_ratio : float
        k, see `leak.fluids.library.heat_capacity_ratio`.

    References
    ----------
    ISO 9300:2005, eq. for the ideal critical flow; Shapiro, The Dynamics and Thermodynamics of Compressible Fluid Flow
    (1953), ch. 4.

    Examples
    --------
    >>> import leak
    >>> area = leakage_area_of_gas(1e-6, 7e5, 1e5, leak.gas("nitrogen"), 1.4)
    >>> f"{area * 1e12:.0f} um^2"
    '615 um^2'
    """
    k = heat_capacity_ratio
    ratio = max(outlet_pressure / inlet_pressure, (2 / (k + 1)) ** (k / (k - 1)))
    # r^(2/k) - r^((k+1)/k) = r^(2/k) (1 - r^((k-1)/k)), exact also where r is close to one
    room = ratio ** (2 / k) * -math.expm1((k - 1) / k * math.log(ratio))
    speed = math.sqrt(2 * k / ((k - 1) * gas.specific_gas_constant * gas.temperature) * room)
    return mass_flow / (inlet_pressure * speed)


# Of a parabolic profile: mean of the square over the square of the mean.
_MOMENTUM = 1.2


class GasInertia(NamedTuple):
    """Numbers of a viscous flow that should be small.

    Examples
    --------
    >>> GasInertia(reynolds=10.0, mach=0.1, acceleration=0.01).mach
    0.1
    """

    reynolds: float
    """Largest rho v 2 u/eta = 2 G/(2 pi r eta) [-]."""
    mach: float
    """Largest v/sqrt(kappa R_s T) of the viscous flow; above some 0.8 the gas chokes instead [-]."""
    acceleration: float
    """Share of the flow's driving potential int p dp that would accelerate the gas and is lost to the flow [-]."""


def gas_inertia(
    radius: ArrayLike,
    gap: ArrayLike,
    gas_pressure: ArrayLike,
    mass_flow: float,
    gas: Gas,
    heat_capacity_ratio: float = 1.4,
) -> GasInertia:
    """Reynolds and Mach number of a gas along a contact, with its mean speed v = G/(2 pi r rho u_eff).

    Parameters
    ----------
    radius : array_like
        r at places along the contact, shape (n,) or one number [m].
    gap : array_like
        u_eff there, zero where sealed and infinite where open, shape (n,) [m].
    gas_pressure : array_like
        Absolute pressure there, shape (n,) [Pa].
    mass_flow : float
        G [kg/s].
    gas : Gas
    heat_capacity_ratio : float
        kappa [-].

    Returns
    -------
    GasInertia
        Of the places where the gas is a continuum, D = q u/(eta0 v0) > 1; zeros where it nowhere is.

    Notes
    -----
    Isothermal momentum, dp/dx (1 - beta v^2/(R_s T)) = - friction with beta = 6/5: the viscous flow leaves out the
    second term, and where it reaches one there is no such flow, the gas chokes. The share is the mean of the second
    term over p dp, at most one at any place. It is small where speed is high over a little of the pressure drop only,
    as next to a vacuum.

    References
    ----------
    A. H. Shapiro, The Dynamics and Thermodynamics of Compressible Fluid Flow (1953), ch. 6.

    Examples
    --------
    >>> import leak
    >>> p = np.linspace(1e5, 2e5, 11)
    >>> found = gas_inertia(0.014, np.full(11, 1e-6), p, 1e-7, leak.gas("nitrogen"))
    >>> found.mach < 0.1 and found.acceleration < 0.01
    True
    """
    p = np.asarray(gas_pressure, dtype=float)
    r, u = (np.broadcast_to(np.asarray(values, dtype=float), p.shape) for values in (radius, gap))
    RT = gas.specific_gas_constant * gas.temperature
    D = gas.flow_pressure(p) * u / (gas.viscosity * gas.molecular_speed)
    dense = np.isfinite(u) & (D > 1.0)
    if not dense.any() or not mass_flow > 0.0:
        return GasInertia(0.0, 0.0, 0.0)
    Z = np.ones(p.shape) if gas.real is None else gas.real.factor(p)
    eta = gas.viscosity * (np.ones(p.shape) if gas.real is None else gas.real.viscosity_ratio(p))
    per_width = mass_flow / (2.0 * np.pi * r)
    with np.errstate(divide="ignore", over="ignore"):
        speed = np.where(dense, per_width * Z * RT / (np.maximum(p, 1e-300) * np.where(dense, u, 1.0)), 0.0)
    term = np.minimum(_MOMENTUM * speed**2 / RT, 1.0)
    return GasInertia(
        float((2.0 * per_width / eta)[dense].max()),
        float(speed.max() / np.sqrt(heat_capacity_ratio * RT)),
        _mean_over_potential(term, p),
    )


def _mean_over_potential(values: FloatArray, p: FloatArray) -> float:
    """Mean of values over p dp, by the trapezoidal rule."""
    weights = np.abs(np.diff(p**2))
    total = float(weights.sum())
    return float((0.5 * (values[1:] + values[:-1]) * weights).sum() / total) if total > 0.0 else 0.0
