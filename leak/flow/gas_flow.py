"""Isothermal flow of a gas through a contact pressure profile, from the continuum to free molecules."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from leak.arrays import FloatArray
from leak.errors import ProfileError, positive
from leak.flow.conductivity import GasConductivity, log_rarefied_flow
from leak.flow.contact_profile import (
    ContactProfile,
    Panels,
    after_largest,
    checked_ends,
    checked_profile,
    checked_side,
)
from leak.flow.leak_rate import LeakResult
from leak.flow.rough_contact import RoughContact, gas_conductivity_table
from leak.fluids.properties import Gas
from leak.fluids.real_gas import GasPotential
from leak.standards import STANDARD_PRESSURE, STANDARD_TEMPERATURE

# Eight are usual, with a vacuum ahead of wide gaps thirty.
_MOST_ITERATIONS = 200
_CONVERGED = 1e-11
# So many iterations before the last are mixed with it; plain ones would swing with a vacuum ahead of wide gaps.
_MIXED = 4
# First-order slip of `poiseuille_flow_rate`.
_SLIP = 1.0162
# The gas pressure bends even where the contact pressure does not: 1e-6 of the flow with so many cells.
_CELLS = 100
# Contact pressures this far below the peak add less than 1e-6 of the flow resistance.
_TABLE_DECADES = 9.0


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
    p_in = positive(ProfileError, "inlet_pressure", inlet_pressure, "Pa")
    p_out = checked_outlet(p_in, outlet_pressure)
    checked_side(pressure_side)
    if isinstance(surface, RoughContact):
        table: GasConductivity = gas_table(surface, highest_pressures(ps, largest_pressure), method)
    else:
        table = surface
    places = checked_ends(ends)
    profile = ContactProfile.through(xs, ps, rs, places)
    profile = after_largest(profile, xs, rs, largest_pressure, places, table)
    return gas_leak_through(profile, xs, ps, table, gas, p_in, p_out, pressure_side=pressure_side)


def gas_leak_through(
    profile: ContactProfile,
    x: FloatArray,
    p: FloatArray,
    table: GasConductivity,
    gas: Gas,
    inlet_pressure: float,
    outlet_pressure: float,
    *,
    pressure_side: str = "outer",
) -> GasLeakResult:
    """`gas_leak_flow` through a profile between and beyond its points, of which several tables may make use.

    Parameters
    ----------
    profile : ContactProfile
    x, p : ndarray, shape (n,)
        Its points [m], where the gas pressure is wanted, and the contact pressure there [Pa].
    table, gas, inlet_pressure, outlet_pressure, pressure_side
        See `gas_leak_flow`.
    """
    checked_side(pressure_side)
    p_in = positive(ProfileError, "inlet_pressure", inlet_pressure, "Pa")
    p_out = checked_outlet(p_in, outlet_pressure)
    profile = profile.refined(_CELLS)
    path = _Path.along(profile, table, gas)
    if not np.isfinite(path.total):
        fraction = path.sealed_fraction()
        below, above = (p_out, p_in) if pressure_side == "outer" else (p_in, p_out)
        pressure = np.where(fraction < 0.5, below, above)
        return GasLeakResult(gas, p_in, p_out, 0.0, np.interp(x, profile.x, pressure), float("inf"))
    flow, pressure = path.flow(*((p_out, p_in) if pressure_side == "outer" else (p_in, p_out)))
    at_points = np.interp(x, profile.x, pressure)
    peak = int(np.argmax(p))
    at_peak = profile.first_loading(x[peak], np.log(p[peak]))
    narrowest = float(table.at_log_pressure(at_peak))
    free_path = gas.mean_free_path(max(float(at_points[peak]), 1e-300))
    # next to sealing u_eff may be too small for a floating-point number where the flow still is not
    knudsen = free_path / narrowest if narrowest > 0.0 else float("inf")
    return GasLeakResult(gas, p_in, p_out, flow, at_points, knudsen)


def checked_outlet(inlet_pressure: float, outlet_pressure: float) -> float:
    """Outlet pressure below that of the inlet, or a `ProfileError`."""
    try:
        p_out = float(outlet_pressure)
    except (TypeError, ValueError):
        p_out = float("nan")
    if not 0.0 <= p_out < inlet_pressure:
        raise ProfileError(
            f"outlet_pressure = {outlet_pressure!r}: must be at least 0 (vacuum) and below the inlet_pressure = "
            f"{inlet_pressure} [Pa], both absolute"
        )
    return p_out


def highest_pressures(p: FloatArray, largest: ArrayLike | None) -> FloatArray:
    """Pressures for which a table must hold: those of the contact, and the largest that it remembers [Pa]."""
    return p if largest is None else np.append(p, np.max(np.asarray(largest, dtype=float)))


def gas_table(surface: RoughContact, p: FloatArray, method: str) -> GasConductivity:
    """Conductivity for a profile, over whole decades, so that neighbouring profiles share one table."""
    decade = np.log10(p.max())
    low, high = np.floor(decade - _TABLE_DECADES), np.ceil(decade + 1e-3)
    return gas_conductivity_table(surface, 10.0**low, 10.0**high, method=method)


def slip_pressure(gas: Gas, gap: float) -> float:
    """Pressure c = 6 (1.0162) eta v0/u at which slip carries as much through a gap [m] as viscous flow does [Pa]."""
    return 6.0 * _SLIP * gas.viscosity * gas.molecular_speed / gap


@dataclass(frozen=True, eq=False)
class _Path:
    """The way through the contact, in stretches; what a uniform gap u_eff without rarefaction would resist.

    Arrays hold the points of all stretches, one after the other.
    """

    used: tuple[Panels, ...]
    cells: slice
    """Which of the stretches are no tails."""
    table: GasConductivity
    gas: Gas
    log_contact: FloatArray
    """ln p* of first loading."""
    separation: FloatArray
    """u_eff [m]."""
    resistance: FloatArray
    """Length of the stretch times 1/(2 pi r u_eff^3) [1/m^3]."""

    @classmethod
    def along(cls, profile: ContactProfile, table: GasConductivity, gas: Gas) -> _Path:
        used = tuple(part for part in profile.panels if part is not None)
        log_contact = np.concatenate([part.first_loading.ravel() for part in used])
        u = np.asarray(table.at_log_pressure(log_contact))
        length = np.concatenate([(part.stretch / part.radius).ravel() for part in used])
        # Next to nothing gets through where the contact all but seals: the resistance is infinite there, too.
        with np.errstate(divide="ignore", over="ignore"):
            resistance = length / (2.0 * np.pi * u**3)
        first = 0 if profile.panels[0] is None else 1
        cells = slice(first, first + profile.panels[1].stretch.shape[0])
        return cls(used, cells, table, gas, log_contact, u, resistance)

    @property
    def flight_pressure(self) -> float:
        """Eta v0, the pressure times gap at which D is one [Pa m]."""
        return self.gas.viscosity * self.gas.molecular_speed

    @cached_property
    def slip_pressure(self) -> float:
        """c at the narrowest place [Pa]."""
        return slip_pressure(self.gas, float(self.separation.min()))

    @property
    def total(self) -> float:
        return float(self._whole(self.resistance).sum())

    def sealed_fraction(self) -> FloatArray:
        """0 before and 1 behind the middle of what is sealed, at the edges of the cells."""
        sealed = np.isinf(self._whole(self.resistance))
        return self._at_edges(sealed / sealed.sum())

    def flow(self, first: float, last: float) -> tuple[float, FloatArray]:
        """Mass flow, and the gas pressure at the edges of the cells, for the pressures at both ends."""
        of = GasPotential(self.gas.real, max(first, last), self.slip_pressure)
        ends = float(of(first)), float(of(last))
        _, share = self._shares(self.resistance, ends[0] < ends[1])
        potential = min(ends) + abs(ends[1] - ends[0]) * share
        before, found, steps = np.inf, np.empty((0, potential.size)), np.empty((0, potential.size))
        for _ in range(_MOST_ITERATIONS):
            resistance = self.resistance / self._gain(of.flow_pressure(potential))
            whole, share = self._shares(resistance, ends[0] < ends[1])
            total = float(whole.sum())
            if abs(total / before - 1.0) < _CONVERGED:
                break
            before = total
            root = np.sqrt(min(ends) + abs(ends[1] - ends[0]) * share)
            found = np.concatenate([found[-_MIXED:], [root]])
            steps = np.concatenate([steps[-_MIXED:], [root - np.sqrt(potential)]])
            potential = np.minimum(np.maximum(_mixed(found, steps) ** 2, min(ends)), max(ends))
        eta, speed = self.gas.viscosity, self.gas.molecular_speed
        # 24 eta R_s T = 12 eta v0^2
        flow = abs(ends[1] - ends[0]) / (12.0 * eta * speed**2 * total)
        at_edges = self._at_edges(whole / total)
        return flow, of.pressure(ends[0] * (1.0 - at_edges) + ends[1] * at_edges)

    def _whole(self, values: FloatArray) -> FloatArray:
        """Integrals over the share of each stretch; infinite with a value in it."""
        parts = zip(self.used, self._by_stretch(values), strict=True)
        return np.concatenate([one @ part.quadrature[:, -1] for part, one in parts])

    def _shares(self, values: FloatArray, rising: bool) -> tuple[FloatArray, FloatArray]:
        """Integrals over each stretch, and at each point the share of what lies toward the lower gas pressure."""
        within, whole = self._integrals(values)
        # counted from the end with the lower pressure, so that vacuum stays exact there
        if rising:
            share = np.repeat(np.cumsum(whole) - whole, self._points) + within
        else:
            share = np.repeat(np.cumsum(whole[::-1])[::-1], self._points) - within
        return whole, np.maximum(share, 0.0) / whole.sum()

    def _integrals(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Integrals of finite values over the share of each stretch: up to each of its points, and over all of it."""
        parts = zip(self.used, self._by_stretch(values), strict=True)
        found = [one @ part.quadrature for part, one in parts]
        return np.concatenate([one[:, :-1].ravel() for one in found]), np.concatenate(
            [one[:, -1] for one in found]
        )

    def _by_stretch(self, values: FloatArray) -> list[FloatArray]:
        ends = np.cumsum([part.stretch.size for part in self.used]).tolist()
        return [
            values[end - part.stretch.size : end].reshape(part.stretch.shape)
            for part, end in zip(self.used, ends, strict=True)
        ]

    @cached_property
    def _points(self) -> NDArray[np.intp]:
        """Number of points in each stretch."""
        return np.concatenate([np.full(*part.stretch.shape) for part in self.used])

    def _at_edges(self, shares: FloatArray) -> FloatArray:
        """Sums of what the stretches have, up to the edges of the cells."""
        along = np.concatenate([[0.0], np.cumsum(shares)])
        return along[self.cells.start : self.cells.stop + 1]

    def _gain(self, q: FloatArray) -> FloatArray:
        """q F/(q + c), F = 12 eta sigma_eff/u_eff^3."""
        log_q = np.log(np.maximum(q, 1e-300))
        log_D = log_q + self._log_width
        # q and the factor of free molecules, 1/q, are no numbers on their own in a perfect vacuum
        return np.exp(log_q + self._log_flow(log_D)) / (q + self.slip_pressure)

    @cached_property
    def _log_flow(self) -> Callable[[FloatArray], FloatArray]:
        """ln F over ln D_eff."""
        return log_rarefied_flow(self.table, self.log_contact)

    @cached_property
    def _log_width(self) -> FloatArray:
        """ln(u_eff/(eta v0))."""
        return np.log(self.separation) - np.log(self.flight_pressure)


def _mixed(found: FloatArray, steps: FloatArray) -> FloatArray:
    """Where an iteration goes from several results, shape (n, points), and the steps that led there.

    D. G. Anderson, J. ACM 12, 547 (1965).
    """
    from scipy.linalg.lapack import dgelss

    if len(found) == 1:
        return found[0]
    change = steps[-1] - steps[:-1]
    share = dgelss(change @ change.T, change @ steps[-1], cond=1e-12)[1]
    return np.asarray(found[-1] - share @ (found[-1] - found[:-1]))
