"""The leak integral: how much fluid a pressure profile lets through, a liquid or a gas at one temperature."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.flow.conductivity import GasConductivity
from leak.flow.contact_profile import ContactProfile, checked_profile, profile_after
from leak.flow.leak_result import GasLeakResult, LeakResult
from leak.flow.permeant import (
    Function,
    GasPermeant,
    LiquidPermeant,
    LogConductivity,
    Permeant,
    SigmaOfPressure,
    gap_of,
    gas_table,
    potential_ends,
    through_values,
)
from leak.flow.rough_contact import RoughContact
from leak.fluids.pressure_law import PressureLaw
from leak.fluids.properties import Gas
from leak.numerics.gauss import integrals_up_to_nodes

# Eight are usual, with a vacuum ahead of wide gaps thirty.
_MOST_SWEEPS = 200
_CONVERGED = 1e-11
# So many sweeps before the last are mixed with it; plain ones would swing with a vacuum ahead of wide gaps.
_MIXED = 4


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
    profile: ContactProfile,
    x: FloatArray,
    p: FloatArray,
    permeant: Permeant,
    pressure_side: str = "outer",
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
    profile = profile.refined(permeant.cells)
    asked, weight, begin = profile.quadrature
    sigma = permeant.sigma(asked)
    # Next to nothing gets through where the contact all but seals: the resistance is infinite there, too.
    with np.errstate(divide="ignore", over="ignore"):
        resistance = weight / sigma
        whole = np.add.reduceat(resistance, begin)
    sealed = math.isinf(whole.sum())
    peak, at_peak = int(np.argmax(p)), 0.0
    if sealed:
        # it drops there alone
        whole = np.isinf(whole).astype(float)
    elif permeant.sweeps:
        gap = gap_of(permeant, sigma)
        permeant = permeant.at_narrowest(float(gap.min()))
        ends = potential_ends(permeant, pressure_side)
        whole = _settled(profile, resistance, permeant, permeant.gain(asked, gap), ends)
        at_peak = float(gap_of(permeant, permeant.sigma(profile.first_loading(x[peak], np.log(p[peak])))))
    first, last = potential_ends(permeant, pressure_side)
    before, cells = int(profile.panels[0] is not None), profile.x.size - 1
    passed = np.cumsum(np.concatenate([[0.0], whole]))
    share = np.interp(x, profile.x, passed[before : before + cells + 1] / passed[-1])
    flow = 0.0 if sealed else abs(last - first) * permeant.per_potential / float(whole.sum())
    return flow, permeant.potential.pressure(first * (1.0 - share) + last * share), peak, at_peak


def _settled(
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

    def potentials(values: FloatArray, whole: FloatArray) -> FloatArray:
        parts = zip(panels, np.split(values, cuts), strict=True)
        within = np.concatenate(
            [
                (part.reshape(one.stretch.shape) @ integrals_up_to_nodes(one.stretch.shape[1]).T).ravel()
                for one, part in parts
            ]
        )
        # counted from the end with the lower pressure, so that vacuum stays exact there
        if ends[0] < ends[1]:
            share = np.repeat(np.cumsum(whole) - whole, points) + within
        else:
            share = np.repeat(np.cumsum(whole[::-1])[::-1], points) - within
        return low + (high - low) * (np.maximum(share, 0.0) / whole.sum())

    potential = potentials(resistance, np.add.reduceat(resistance, begin))
    before, found, steps = math.inf, np.empty((0, potential.size)), np.empty((0, potential.size))
    for _ in range(_MOST_SWEEPS):
        now = resistance / gain(permeant.flow_pressure(potential))
        whole = np.add.reduceat(now, begin)
        total = float(whole.sum())
        if abs(total / before - 1.0) < _CONVERGED:
            break
        before = total
        root = np.sqrt(potentials(now, whole))
        found = np.concatenate([found[-_MIXED:], [root]])
        steps = np.concatenate([steps[-_MIXED:], [root - np.sqrt(potential)]])
        potential = np.minimum(np.maximum(_mixed(found, steps) ** 2, low), high)
    return whole


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
