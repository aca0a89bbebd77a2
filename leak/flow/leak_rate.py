"""The leak integral: how much fluid a pressure profile lets through."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Protocol, Self, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ProfileError, positive
from leak.flow.contact_profile import (
    SMALLEST_LOG_PRESSURE,
    ContactProfile,
    after_largest,
    checked_ends,
    checked_profile,
    checked_side,
)
from leak.fluids.pressure_law import PressureLaw, flow_potential
from leak.numerics.curves import MonotoneCurve, spline_slopes


@runtime_checkable
class LogConductivity(Protocol):
    """A conductivity that can also be asked by ln p, where p underflows."""

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """sigma_eff at ln(p/Pa) [m^3/(Pa s)]."""


SigmaOfPressure = Callable[[FloatArray], ArrayLike]


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
        >>> drops = LeakResult(1e-9, 1e15, np.zeros(3))
        >>> f"{drops.with_density(1000.0).mass_flow:.1e}"
        '1.0e-06'
        """
        return self if density is None else replace(self, mass_flow=density * self.leak_rate)

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
        `RoughContact` does (`leak.flow.memory`). None: every place carries more than ever before.
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
    x_all, p_all, r_all = checked_profile(x, p, radius)
    places = checked_ends(ends)
    profile = ContactProfile.through(x_all, p_all, r_all, places)
    profile = after_largest(profile, x_all, r_all, largest_pressure, places, conductivity)
    if not (callable(conductivity) or isinstance(conductivity, LogConductivity)):
        conductivity = _through_values(p_all, conductivity)
    return leak_through(
        profile, x_all, conductivity, pressure_drop, pressure_side=pressure_side, pressure_law=pressure_law
    )


def leak_through(
    profile: ContactProfile,
    x: FloatArray,
    conductivity: SigmaOfPressure | LogConductivity,
    pressure_drop: float,
    *,
    pressure_side: str = "outer",
    pressure_law: PressureLaw | None = None,
) -> LeakResult:
    """`leak_flow` through a profile between and beyond its points, of which several conductivities may make use.

    Parameters
    ----------
    profile : ContactProfile
    x : ndarray, shape (n,)
        Where the fluid pressure is wanted [m].
    conductivity, pressure_drop, pressure_side, pressure_law
        See `leak_flow`.
    """
    drop = positive(ProfileError, "pressure_drop", pressure_drop, "Pa")
    checked_side(pressure_side)
    inner_tail, cells, outer_tail = _resistances(profile, by_log_pressure(conductivity))
    total = inner_tail + float(cells.sum()) + outer_tail
    below = np.concatenate([[0.0], np.cumsum(cells)])
    if np.isinf(total):
        fraction_at_nodes = _sealed_fraction(inner_tail, cells, outer_tail)
    else:
        fraction_at_nodes = (inner_tail + below) / total
    fraction = np.interp(x, profile.x, fraction_at_nodes)
    if pressure_side == "inner":
        fraction = 1.0 - fraction
    potential = flow_potential(pressure_law, drop)
    whole = potential.whole
    rate = 0.0 if np.isinf(total) else whole / total
    return LeakResult(rate, drop / rate if rate > 0.0 else float("inf"), potential.pressure(whole * fraction))


def _resistances(
    profile: ContactProfile, sigma: Callable[[FloatArray], FloatArray]
) -> tuple[float, FloatArray, float]:
    """int dx/(2 pi r sigma_eff) over the inner tail, each cell, and the outer tail [Pa s/m^3]."""
    inner_tail, _, outer_tail = profile.panels
    asked, weight, begin = profile.quadrature
    # Next to nothing gets through where the contact all but seals: the resistance is infinite there, too.
    with np.errstate(divide="ignore", over="ignore"):
        found = np.add.reduceat(weight / sigma(asked), begin)
    inner, outer = (
        0.0 if one is None else float(found[end]) for one, end in ((inner_tail, 0), (outer_tail, -1))
    )
    return inner, found[inner_tail is not None : None if outer_tail is None else -1], outer


def _sealed_fraction(inner_tail: float, cells: FloatArray, outer_tail: float) -> FloatArray:
    """Fraction of the pressure drop at the cell edges when part of the contact is sealed: it drops there alone."""
    parts = np.isinf(np.concatenate([[inner_tail], cells, [outer_tail]])).astype(float)
    return (np.cumsum(parts) / parts.sum())[:-1]


def _through_values(p: FloatArray, conductivity: ArrayLike) -> SigmaOfPressure:
    """sigma_eff(p) through its values at the points: sigma^(1/3), nearly straight over ln p, is interpolated."""
    try:
        values = np.asarray(conductivity, dtype=float)
    except (TypeError, ValueError) as error:
        raise ProfileError(f"conductivity must be a function of p or numbers: {error}") from None
    if values.shape != p.shape:
        raise ProfileError(
            f"conductivity has shape {values.shape}: must be a function of p, or {p.shape} like p [m^3/(Pa s)]"
        )
    if np.any(np.isnan(values) | (values < 0.0)):
        raise ProfileError(
            f"conductivity = {values[np.isnan(values) | (values < 0.0)][0]}: must not be negative"
        )
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


def by_log_pressure(conductivity: SigmaOfPressure | LogConductivity) -> Callable[[FloatArray], FloatArray]:
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
