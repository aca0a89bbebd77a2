"""What flows through a contact, and the fluid pressure along it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Self

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
        )


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
