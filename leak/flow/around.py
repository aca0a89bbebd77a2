"""Flow through a ring-shaped contact that is not the same all around: across it, and round its tight places."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray, IntArray
from leak.errors import ConductivityError, as_arrays
from leak.flow.conductivity import GasConductivity
from leak.flow.contact_profile import checked_profile
from leak.flow.leak_rate import GasPermeant, LiquidPermeant, Permeant, gap_of, potential_ends
from leak.fluids.properties import FlowPotential, Gas, GasPotential, PressureLaw
from leak.numerics.roots import MOST_STEPS

# Of the conductance with free flow around: more is no resistance.
_MOST_CONDUCTANCE = 1e9
# Of the flow, all links together: less is no way. Kept, it would leave places whose pressure is nothing but round-off.
_LEAST_SHARE = 1e-9
# The same where every single angle is sealed, of the conductance with free flow around.
_FAINTEST = 1e-24
_REFINEMENTS = 2
_TOLERANCE = 1e-11
# The gas pressure at which a vacuum is taken [Pa].
_VACUUM = 1e-3

GasConductivityField = Callable[[FloatArray], ArrayLike]


@dataclass(frozen=True, eq=False)
class AroundFlow:
    """Flow of a liquid through the ring; angles are those of the conductivity's columns.

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> x, phi = np.linspace(0.0, 1e-3, 21), 2 * np.pi * np.arange(16) / 16
    >>> sigma = 1e-15 * np.exp(3.0 * np.cos(phi) * np.cos(1e3 * np.pi * x)[:, None])
    >>> found = leak.around_flow(x, 0.001, sigma, 2e6)
    >>> found.leak_rate > found.radial_leak_rate
    True
    """

    leak_rate: float
    """Q at atmospheric pressure [m^3/s]; zero where the contact is sealed all around."""
    inlet_flow: FloatArray
    """Across the edge on the high-pressure side, per angle, shape (k,) [m^3/(s rad)]."""
    outlet_flow: FloatArray
    """Across the edge on the low-pressure side, per angle, shape (k,) [m^3/(s rad)]."""
    radial_flow: FloatArray
    """Of fluid that keeps to its angle, Delta P/int dx/(r sigma), per angle, shape (k,) [m^3/(s rad)]."""
    fluid_pressure: FloatArray
    """Above the low side, shape (m, k) [Pa]; nan where no fluid comes from either side."""

    @property
    def radial_leak_rate(self) -> float:
        """Leak rate of fluid that keeps to its angle, a lower bound of Q [m^3/s]."""
        return float(self.radial_flow.mean() * 2.0 * np.pi)

    @property
    def detour(self) -> float:
        """What leaks because fluid goes round tight places, Q less its lower bound [m^3/s]."""
        return self.leak_rate - self.radial_leak_rate


@dataclass(frozen=True, eq=False)
class AroundGasFlow:
    """Flow of a gas through the ring; all pressures are absolute.

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> x, sigma = np.linspace(0.0, 1e-3, 21), np.full((21, 8), 1e-12)
    >>> found = leak.gas_around_flow(x, 0.014, sigma, leak.gas("nitrogen"), 2e5, 1e5)
    >>> round(found.mass_flow / found.radial_mass_flow, 9)
    1.0
    """

    mass_flow: float
    """[kg/s]; zero where the contact is sealed all around."""
    inlet_flow: FloatArray
    """Across the edge on the inlet side, per angle, shape (k,) [kg/(s rad)]."""
    outlet_flow: FloatArray
    """Across the edge on the outlet side, per angle, shape (k,) [kg/(s rad)]."""
    radial_flow: FloatArray
    """Of gas that keeps to its angle, per angle, shape (k,) [kg/(s rad)]."""
    fluid_pressure: FloatArray
    """Shape (m, k) [Pa]; nan where no gas comes from either side."""

    @property
    def radial_mass_flow(self) -> float:
        """Mass flow of gas that keeps to its angle [kg/s]."""
        return float(self.radial_flow.mean() * 2.0 * np.pi)


def around_flow(
    x: ArrayLike,
    radius: ArrayLike,
    conductivity: ArrayLike,
    pressure_drop: float,
    *,
    pressure_side: str = "outer",
    pressure_law: PressureLaw | None = None,
) -> AroundFlow:
    """Solve the Reynolds equation div(sigma grad p_f) = 0 on the ring for a liquid.

    Parameters
    ----------
    x : array_like
        Arc length across the contact, strictly increasing, shape (m,), m >= 3 [m]. The fluid pressure is that of the
        sides at the first and the last x: they must lie where the gap is open against its narrowest place.
    radius : float or array_like
        Distance from the axis r, one number or one per x [m].
    conductivity : array_like
        sigma_eff at the places x and at k equal steps of the angle, shape (m, k) [m^3/(Pa s)]; zero where sealed,
        infinite where open. From a `ConductivityTable`: ``table.at(viscosity)(pressure)``.
    pressure_drop : float
        Delta P [Pa].
    pressure_side : {"outer", "inner"}
        Side of the high fluid pressure: larger or smaller x.
    pressure_law : PressureLaw, optional
        How the liquid thickens and is compressed, see `leak.leak_flow`: the equation is solved for its potential psi.

    Returns
    -------
    AroundFlow

    Raises
    ------
    ProfileError, ConductivityError
        An input cannot be used; the message says which value.

    Notes
    -----
    Finite volumes around the points of (1/r) d/dx(r sigma dp/dx) + (1/r^2) d/dphi(sigma dp/dphi) = 0, periodic in phi,
    with harmonic means of r sigma between neighbours across and of sigma between neighbours around. Second order in
    both steps, uneven steps of x included. What flows into a volume flows out of it. Without the links around the
    contact the same volumes give `radial_flow`; links only add conductance, so that Q is never below it.

    Conductances above 1e9 times that of the whole contact are set to it: that costs no more than 1e-9 of Q per step
    of x.

    Examples
    --------
    The same all around, it is the leak integral of `leak.leak_flow`:

    >>> x = np.linspace(0.0, 1e-3, 11)
    >>> found = around_flow(x, 0.014, np.full((11, 8), 1e-15), 2e6)
    >>> print(f"{found.leak_rate:.4e}")
    1.7593e-07
    """
    liquid = LiquidPermeant.of(None, pressure_drop, pressure_law)
    return AroundFlow(*flow_round(x, radius, conductivity, liquid, pressure_side))


def gas_around_flow(
    x: ArrayLike,
    radius: ArrayLike,
    conductivity: ArrayLike | GasConductivityField,
    gas: Gas,
    inlet_pressure: float,
    outlet_pressure: float,
    *,
    pressure_side: str = "outer",
) -> AroundGasFlow:
    """Mass flow of a gas, div(rho sigma grad p_f) = 0 with rho = p_f/(R_s T) or that of a real gas, isothermal.

    Parameters
    ----------
    x, radius, pressure_side
        See `around_flow`.
    conductivity : callable or array_like
        sigma_eff of the rarefied gas, shape (m, k), at its absolute pressures p_f; falls with p_f no faster than 1/p_f.
        It is asked with p_f of shape (m, 1), the same all around, to learn k, and of shape (m, k). An array is a gas
        without slip. Of a real gas at the viscosity of the dilute one.
    gas : Gas
    inlet_pressure, outlet_pressure : float
        Absolute; the outlet may be a vacuum [Pa].

    Returns
    -------
    AroundGasFlow

    Raises
    ------
    ProfileError, ConductivityError
        An input cannot be used, or no solution was found; the message says which value.

    Notes
    -----
    rho sigma grad p_f = sigma grad(p_f^2)/(2 R_s T): without slip linear in p_f^2, and as exact as `around_flow`. With
    slip sigma is taken at the last p_f, over and over, half of the change at a time; `radial_flow` likewise, with a gas
    pressure of its own. Of a real gas w/2 of `GasPotential` takes the place of
    p_f^2/2. In a vacuum, where sigma is infinite, its value at 1 mPa is used.

    Examples
    --------
    >>> x, slip = np.linspace(0.0, 1e-3, 101), 5e4
    >>> gas = Gas("nitrogen", 28.0134e-3, 17.8e-6, 293.15, "example")
    >>> found = gas_around_flow(x, 0.014, lambda p: 1e-12 * (1 + slip / p) * np.ones((101, 8)), gas, 2e5, 0.0)
    >>> exact = 2 * np.pi * 0.014 * 1e-12 / 1e-3 * (2e5**2 / 2 + slip * 2e5) * 28.0134e-3 / (8.314462618 * 293.15)
    >>> round(found.mass_flow / exact, 2)
    1.0
    """
    permeant = GasPermeant.of(None, gas, inlet_pressure, outlet_pressure)
    return AroundGasFlow(*flow_round(x, radius, conductivity, permeant, pressure_side))


def rarefied_conductivity(
    table: GasConductivity, gas: Gas, log_pressure: ArrayLike
) -> Callable[[FloatArray], FloatArray]:
    """sigma_eff of a rarefied gas at places of a contact, as a function of its pressure there.

    Parameters
    ----------
    table : GasConductivity
        From `leak.gas_conductivity_table`.
    gas : Gas
    log_pressure : array_like
        ln(p/Pa) of the contact pressure, shape (m, k).

    Returns
    -------
    callable
        For `gas_around_flow`: from absolute gas pressures [Pa] to sigma_eff [m^3/(Pa s)].

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(
    ...     rms_height=1e-6, hurst=0.8, q_low=1e3, q_rolloff=1e4, q_high=1e6
    ... )
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> table = leak.gas_conductivity_table(surface, 1e5, 1e8, 8)
    >>> sigma = rarefied_conductivity(table, leak.gas("helium"), np.log([[1e6, 2e6]]))
    >>> bool(sigma(np.array([[1e3]]))[0, 0] > sigma(np.array([[1e6]]))[0, 0])
    True
    """
    contact, permeant = np.asarray(log_pressure, dtype=float), GasPermeant(0.0, np.inf, table, gas)
    continuum = permeant.sigma(contact)
    gain = permeant.gain(contact, gap_of(permeant, continuum))
    return lambda pressure: continuum * gain(gas.flow_pressure(np.maximum(pressure, _VACUUM)))


def flow_round(
    x: ArrayLike,
    radius: ArrayLike,
    conductivity: ArrayLike | GasConductivityField,
    permeant: Permeant,
    pressure_side: str,
) -> tuple[float, FloatArray, FloatArray, FloatArray, FloatArray]:
    """What an `AroundFlow` holds, of any fluid.

    Parameters
    ----------
    x, radius, conductivity, pressure_side
        See `gas_around_flow`.
    permeant : LiquidPermeant or GasPermeant
        Whose own conductivity is not asked.
    """
    xs, _, rs = checked_profile(x, np.ones(np.shape(x)), radius)
    ends = potential_ends(permeant, pressure_side)
    if callable(conductivity):
        radial_only, state = (
            _solve_sweeps(xs, rs, conductivity, ends, permeant.potential, flows_around)
            for flows_around in (False, True)
        )
        radial = 0.5 * (radial_only.first_flow + radial_only.last_flow)
    else:
        ring = _Ring(xs, rs, _checked_conductivity(conductivity, xs.size))
        state, radial = ring.solve(*ends), ring.radial * abs(ends[1] - ends[0])
    flows = state.first_flow, state.last_flow
    high, low = flows[::-1] if pressure_side == "outer" else flows
    c = permeant.per_potential
    return c * state.flow, c * high, c * low, c * radial, permeant.potential.pressure(state.potential)


def _solve_sweeps(
    x: FloatArray,
    radius: FloatArray,
    conductivity: GasConductivityField,
    ends: tuple[float, float],
    potential: FlowPotential | GasPotential,
    flows_around: bool,
) -> _Solution:
    """Solution with the conductivity at the fluid pressure that belongs to it."""
    first, last = ends
    pressure = potential.pressure(first + (last - first) * np.linspace(0.0, 1.0, x.size)[:, None])
    pressure = pressure * np.ones(np.asarray(conductivity(np.full((x.size, 1), pressure.max()))).shape[-1])
    last_flow = np.inf
    for _ in range(MOST_STEPS):
        at = np.maximum(pressure, _VACUUM)
        ring = _Ring(x, radius, _checked_conductivity(conductivity(at), x.size), flows_around)
        state = ring.solve(first, last)
        new_pressure = potential.pressure(state.potential)
        if abs(state.flow - last_flow) <= _TOLERANCE * state.flow:
            return state
        last_flow = state.flow
        pressure = np.where(np.isnan(new_pressure), pressure, 0.5 * (pressure + new_pressure))
    raise ConductivityError("conductivity of the gas: no flow was found; it must fall no faster than 1/p_f")


# -------------------------------------------------------------------- the volumes


@dataclass(frozen=True, eq=False)
class _Solution:
    flow: float
    first_flow: FloatArray
    """Across the edges at the first and the last x, from the high to the low potential, per angle, shape (k,)."""
    last_flow: FloatArray
    potential: FloatArray


@dataclass(frozen=True, eq=False)
class _Ring:
    """Volumes around the points (x, phi)."""

    x: FloatArray
    radius: FloatArray
    conductivity: FloatArray
    flows_around: bool = True

    @cached_property
    def across_links(self) -> FloatArray:
        """Conductance between neighbours in x per angle, shape (m - 1, k) [m^3/(Pa s rad)]."""
        return _harmonic_mean(self.radius[:, None] * self.conductivity) / np.diff(self.x)[:, None]

    @cached_property
    def around_links(self) -> FloatArray:
        """Conductance to the neighbour at the next angle, over that of one angle step, shape (m, k)."""
        if not self.flows_around:
            return np.zeros(self.conductivity.shape)
        step = 2.0 * np.pi / self.conductivity.shape[1]
        edges = np.concatenate([self.x[:1], 0.5 * (self.x[1:] + self.x[:-1]), self.x[-1:]])
        pair = np.stack([self.conductivity, np.roll(self.conductivity, -1, axis=1)])
        return _harmonic_mean(pair)[0] * (np.diff(edges) / self.radius)[:, None] / step**2

    @cached_property
    def radial(self) -> FloatArray:
        """Conductance of every angle alone, shape (k,) [m^3/(Pa s rad)]."""
        with np.errstate(divide="ignore", over="ignore"):
            return 1.0 / np.sum(1.0 / self.across_links, axis=0)

    @cached_property
    def upper_bound(self) -> float:
        """Conductance if fluid went round without resistance: an upper bound [m^3/(Pa s rad)]."""
        with np.errstate(divide="ignore", over="ignore"):
            return float(1.0 / np.sum(1.0 / self.across_links.sum(axis=1)))

    def solve(self, first: float, last: float) -> _Solution:
        """Flow for the potentials at the first and the last x."""
        m, k = self.conductivity.shape
        if not np.isfinite(self.upper_bound):
            raise ConductivityError("conductivity is infinite all the way across: there is no contact")
        count = self.across_links.size + self.around_links.size
        upper = _MOST_CONDUCTANCE * self.upper_bound if self.upper_bound > 0.0 else np.inf
        lower = max(_LEAST_SHARE * float(self.radial.sum()) / count, _FAINTEST * self.upper_bound)
        x_links, phi_links = (
            np.where(links > lower, np.minimum(links, upper), 0.0)
            for links in (self.across_links, self.around_links)
        )
        place = np.arange(m * k).reshape(m, k)
        tail = np.concatenate([place[:-1].ravel(), place.ravel()])
        head = np.concatenate([place[1:].ravel(), np.roll(place, -1, axis=1).ravel()])
        links = np.concatenate([x_links.ravel(), phi_links.ravel()])
        # Share of the drop counted from either side: each is exact next to its own.
        share, outer, sides = _shares(tail, head, links, place)
        is_near = share < 0.5
        drops = np.where(is_near[head] & is_near[tail], share[head] - share[tail], outer[tail] - outer[head])
        drop, step = abs(last - first), 2.0 * np.pi / k
        flow = float(np.sum(links * drops**2)) * step * drop if np.any(sides == 2) else 0.0
        shares = np.where(sides > 0, np.where(is_near, share, 1.0 - outer), np.nan).reshape(m, k)
        return _Solution(
            flow,
            x_links[0] * share.reshape(m, k)[1] * drop,
            x_links[-1] * outer.reshape(m, k)[-2] * drop,
            first + (last - first) * shares,
        )


def _shares(
    tail: IntArray, head: IntArray, links: FloatArray, place: IntArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Share of the drop between the first x and every place, and between it and the last x, shape (m k,) each.

    The third array is from how many of both sides some way leads to the place.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.sparse.linalg import splu

    conducts = links > 0.0
    # the sides are one place each, which must not join the other
    i = np.concatenate([tail[conducts], place[0], place[-1]])
    j = np.concatenate(
        [head[conducts], np.full_like(place[0], place[0, 0]), np.full_like(place[-1], place[-1, 0])]
    )
    graph = coo_array((np.ones(i.size), (i, j)), shape=(place.size, place.size))
    group = connected_components(graph, directed=False)[1]
    from_first, from_last = group == group[place[0, 0]], group == group[place[-1, 0]]
    share, outer = np.where(from_last & ~from_first, 1.0, 0.0), np.where(from_first & ~from_last, 1.0, 0.0)
    share[place[-1]], outer[place[0]] = 1.0, 1.0
    sides = from_first.astype(np.intp) + from_last
    unknown = sides == 2
    unknown[place[[0, -1]].ravel()] = False
    if not unknown.any():
        return share, outer, sides
    number = np.cumsum(unknown) - 1
    i, j = np.concatenate([tail, head]), np.concatenate([head, tail])
    all_links = np.concatenate([links, links])
    diagonal = np.bincount(i, all_links, place.size)[unknown]
    scale = 1.0 / np.sqrt(diagonal)
    is_inner = unknown[i] & unknown[j]
    rows, columns = number[i[is_inner]], number[j[is_inner]]
    numbers = np.arange(diagonal.size)
    values = np.concatenate([np.ones(numbers.size), -all_links[is_inner] * scale[rows] * scale[columns]])
    ends = np.concatenate([numbers, rows]), np.concatenate([numbers, columns])
    matrix = coo_array((values, ends), shape=(numbers.size, numbers.size)).tocsc()
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    for part in (share, outer):
        for _ in range(1 + _REFINEMENTS):
            flows = links * (part[head] - part[tail])
            into = np.bincount(tail, flows, place.size) - np.bincount(head, flows, place.size)
            part[unknown] += scale * factors.solve(scale * into[unknown])
        np.clip(part, 0.0, 1.0, out=part)
    return share, outer, sides


def _harmonic_mean(values: FloatArray) -> FloatArray:
    """Of neighbours along the first axis; zero where one of them is zero."""
    with np.errstate(divide="ignore", over="ignore"):
        return np.asarray(2.0 / (1.0 / values[1:] + 1.0 / values[:-1]))


def _checked_conductivity(conductivity: ArrayLike, rows: int) -> FloatArray:
    (values,) = as_arrays(ConductivityError, "conductivity must be an array of numbers", conductivity)
    if values.ndim != 2 or values.shape[0] != rows or values.shape[1] < 1:
        raise ConductivityError(
            f"conductivity has shape {values.shape}: must be ({rows}, k), a row for each x and a column for each angle"
        )
    is_wrong = ~(values >= 0.0)
    if np.any(is_wrong):
        raise ConductivityError(f"conductivity = {values[is_wrong][0]}: must not be negative [m^3/(Pa s)]")
    return values
