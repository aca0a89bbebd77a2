"""Scratches across a seat and the spiral lay of a turned one: what flows along them beside the rough contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.errors import ProfileError, positive
from leak.flow.conductivity import GasConductivity
from leak.flow.contact_profile import (
    SMALLEST_LOG_PRESSURE,
    ContactProfile,
    Panels,
    checked_profile,
    profile_after,
)
from leak.flow.groove_section import EllipticGroove, GrooveSection
from leak.flow.leak_rate import (
    GasPermeant,
    LiquidPermeant,
    LogConductivity,
    Permeant,
    SigmaOfPressure,
    gap_of,
    gas_table,
    potential_ends,
)
from leak.flow.leak_result import GasLeakResult, LeakResult
from leak.flow.network import Line, network_flow
from leak.flow.rough_contact import RoughContact
from leak.fluids.properties import Gas, PressureLaw
from leak.numerics.integrals import gauss
from leak.numerics.roots import root_between

# The fluid pressure bends even where the contact pressure does not.
_CELLS = 100
# Depths between which a scratch is looked for [m].
_SHALLOWEST, _DEEPEST = 1e-9, 1.0


@runtime_checkable
class Groove(Protocol):
    """A way through the contact that is open where the faces touch.

    Examples
    --------
    >>> import leak
    >>> isinstance(leak.Scratch(1e-6, 20e-6), leak.Groove)
    True
    """

    @property
    def section(self) -> GrooveSection:
        """Across it."""

    def path(self, radius: FloatArray) -> FloatArray:
        """Length along the groove over the length straight across the face [-]."""


@dataclass(frozen=True)
class Scratch:
    """A scratch across the face, of elliptic section; see `EllipticGroove` for how it closes.

    Parameters
    ----------
    depth : float
        d0, without load [m].
    width : float
        Full width 2a [m].
    angle : float
        Between the scratch and the shortest way across the face, below a quarter turn [rad].

    Raises
    ------
    ProfileError
        A number has no meaning.

    Examples
    --------
    >>> scratch = Scratch(depth=5e-6, width=30e-6)
    >>> f"{scratch.section.closing_pressure(115e9) / 1e9:.1f} GPa"
    '19.2 GPa'
    """

    depth: float
    width: float
    angle: float = 0.0

    def __post_init__(self) -> None:
        _ = self.section
        if not (isinstance(self.angle, int | float) and abs(self.angle) < 0.5 * np.pi):
            raise ProfileError(
                f"angle = {self.angle!r}: must be between -pi/2 and pi/2, 0 straight across the face [rad]"
            )

    @property
    def section(self) -> EllipticGroove:
        """The ellipse."""
        return EllipticGroove(self.depth, self.width)

    def path(self, radius: FloatArray) -> FloatArray:
        """1/cos(angle) at every radius."""
        return np.full(np.shape(radius), 1.0 / np.cos(self.angle))


@dataclass(frozen=True)
class SpiralLay:
    """The one groove of a turned seat, which winds through the contact like the thread of a screw.

    Parameters
    ----------
    pitch : float
        Feed per turn P, the way across the face that a turn takes [m].
    section : GrooveSection
        `EllipticGroove` or `SinusoidalGroove`; not wider than the pitch.

    Raises
    ------
    ProfileError
        A number has no meaning.

    Notes
    -----
    A turn is sqrt(P^2 + (2 pi r)^2) long. Beside the radial flow over the ridges it carries
    Q = Delta p P/(2 pi r0 int dx/K(p(x))). The roughness of the faces for the radial flow must not hold the lay again.

    References
    ----------
    Y. Matsuzaki, I. Nitta et al., Toraibarojisuto (Tribologist) 51, 308 (2006): turned flanges on copper gaskets leak
    along the groove alone above some 50 MPa; S. Geoffroy, M. Prat, J. Fluids Eng. 126, 48 (2004).

    Examples
    --------
    >>> import leak
    >>> lay = SpiralLay(pitch=100e-6, section=leak.SinusoidalGroove(height=2e-6, wavelength=100e-6))
    >>> f"{float(lay.path(0.0141421)):.1f}"
    '888.6'
    """

    pitch: float
    section: GrooveSection

    def __post_init__(self) -> None:
        pitch = positive(ProfileError, "pitch", self.pitch, "m")
        if not isinstance(self.section, GrooveSection):
            raise ProfileError(f"section = {self.section!r}: must be an EllipticGroove or a SinusoidalGroove")
        if self.section.width > pitch * (1.0 + 1e-9):
            raise ProfileError(
                f"width = {self.section.width}: a groove must not be wider than its pitch = {pitch} [m]"
            )

    def path(self, radius: FloatArray) -> FloatArray:
        """Length of a turn over the pitch."""
        return np.hypot(1.0, 2.0 * np.pi * np.asarray(radius) / self.pitch)


_Flow = TypeVar("_Flow", LeakResult, GasLeakResult)


@dataclass(frozen=True, eq=False)
class LeakBounds(Generic[_Flow]):
    """Flow through a contact with scratches, between two bounds.

    Examples
    --------
    >>> import numpy as np
    >>> import leak
    >>> x = np.linspace(-0.45e-3, 0.45e-3, 201)
    >>> p = 53e6 * np.exp(-0.5 * (x / 0.15e-3) ** 2)
    >>> found = leak.scratch_flow(
    ...     x, p, leak.Scratch(5e-6, 30e-6), None, 2e6, 0.0141421, viscosity=1e-3, effective_modulus=115e9
    ... )
    >>> f"{found.lower.leak_rate * 6e7:.4f} ml/min"
    '0.0238 ml/min'
    """

    without: _Flow
    """The rough contact alone."""
    upper: _Flow
    """Fluid passes freely: at each x one fluid pressure all around."""
    _cut_off: Callable[[], _Flow]

    @cached_property
    def lower(self) -> _Flow:
        """No fluid passes between scratch and roughness, as far as the scratch is deeper than the rough gap is wide.

        Calculated when it is asked for.
        """
        return self._cut_off()

    @property
    def extra(self) -> tuple[float, float]:
        """Least and largest leak rate that the scratches add [m^3/s]."""
        return self.lower.leak_rate - self.without.leak_rate, self.largest_extra

    @property
    def largest_extra(self) -> float:
        """Largest leak rate that the scratches add [m^3/s]."""
        return self.upper.leak_rate - self.without.leak_rate

    def __getstate__(self) -> dict[str, object]:
        # what makes the lower bound cannot be pickled
        return {name: getattr(self, name) for name in ("without", "upper", "lower")}


def scratch_flow(
    x: ArrayLike,
    p: ArrayLike,
    scratches: Groove | Sequence[Groove],
    conductivity: SigmaOfPressure | LogConductivity | None,
    pressure_drop: float,
    radius: ArrayLike,
    *,
    viscosity: float,
    effective_modulus: float,
    pressure_side: str = "outer",
    ends: tuple[float | None, float | None] | None = None,
    largest_pressure: ArrayLike | None = None,
    pressure_law: PressureLaw | None = None,
) -> LeakBounds[LeakResult]:
    """Flow of a liquid through a contact with scratches or a spiral lay.

    Parameters
    ----------
    x, p, pressure_drop, radius, pressure_side, ends, largest_pressure
        See `leak.leak_flow`; p is the pressure far from the scratch, which closes elastically and remembers nothing.
    scratches : Groove or sequence of Groove
        `Scratch`, `SpiralLay`, or several; what they add adds up.
    conductivity : callable or None
        sigma_eff(p) of the roughness, see `leak.leak_flow`. None: nothing flows but along the scratches, from the
        first to the last point of the profile, where p > 0.
    viscosity : float
        At atmospheric pressure [Pa s].
    effective_modulus : float
        E* of both bodies [Pa].
    pressure_law : PressureLaw, optional
        How the liquid thickens and is compressed, see `leak.leak_flow`.

    Returns
    -------
    LeakBounds
        Of `LeakResult`. Fluid pressures are those in the roughness.

    Raises
    ------
    ProfileError
        The profile or another input cannot be used; the message says which value.

    Notes
    -----
    The fluid pressure p_f in the scratch, above that of the low side, holds it open: K is taken at p - p_f, and

        Q = [2 pi r sigma_eff(p) + sum of K(p - p_f) dx/ds] m(p_f) dp_f/dx

    is solved for p_f (upper bound; s runs along the scratch, and m = (rho/rho0)(eta0/eta) is one without
    `pressure_law`), with its potential psi = int m dp_f as the unknown. For the lower bound
    every scratch has a p_f of its own where it is deeper than the rough gap, u_eff = (12 eta sigma_eff)^(1/3);
    elsewhere the gap is so wide that the scratch is lost in it. A network whose links are cut carries less: the lower
    bound never exceeds the upper one.

    Examples
    --------
    Without load and roughness a scratch is an elliptic duct:

    >>> flat, p = [0.0, 5e-4, 1e-3], [1.0, 1.0, 1.0]
    >>> scratch = Scratch(depth=20e-6, width=100e-6)
    >>> found = scratch_flow(flat, p, scratch, None, 2e6, 0.014, viscosity=1e-3, effective_modulus=115e9)
    >>> duct = np.pi * (50e-6 * 10e-6) ** 3 / (4 * 1e-3 * (50e-6**2 + 10e-6**2)) * 2e6 / 1e-3
    >>> round(found.upper.leak_rate / duct, 6)
    1.0
    """
    if not (conductivity is None or callable(conductivity) or isinstance(conductivity, LogConductivity)):
        raise ProfileError(
            f"conductivity = {conductivity!r}: must be a function of p [m^3/(Pa s)], or None where only the "
            "scratches leak"
        )
    points = checked_profile(x, p, radius)
    profile = profile_after(*points, ends, largest_pressure, conductivity)
    liquid = LiquidPermeant.of(conductivity, pressure_drop, pressure_law, viscosity)
    return flow_along(profile, *points[:2], scratches, liquid, effective_modulus, pressure_side)


def gas_scratch_flow(
    x: ArrayLike,
    p: ArrayLike,
    scratches: Groove | Sequence[Groove],
    surface: RoughContact | GasConductivity | None,
    gas: Gas,
    inlet_pressure: float,
    outlet_pressure: float,
    radius: ArrayLike,
    *,
    effective_modulus: float,
    pressure_side: str = "outer",
    method: str = "bruggeman",
    ends: tuple[float | None, float | None] | None = None,
    largest_pressure: ArrayLike | None = None,
) -> LeakBounds[GasLeakResult]:
    """Mass flow of a gas through a contact with scratches or a spiral lay.

    Parameters
    ----------
    x, p, gas, inlet_pressure, outlet_pressure, radius, pressure_side, method, ends, largest_pressure
        See `leak.gas_leak_flow`.
    scratches, effective_modulus
        See `scratch_flow`.
    surface : RoughContact, GasConductivity or None
        The rough interface, or its table; None: nothing flows but along the scratches.

    Returns
    -------
    LeakBounds
        Of `GasLeakResult`, mass flow [kg/s] and leak rate [m^3/s]. Without a surface the Knudsen number is that of the
        deepest scratch.

    Raises
    ------
    ProfileError
        The profile or another input cannot be used; the message says which value.

    Notes
    -----
    As `scratch_flow`, for the mass flow: every conductance carries the density p_f/(R_s T), or that of a real gas, and
    the factor of the rarefied gas, in a scratch that of a slit as wide as each place of the section is deep. p_f less
    the outlet pressure holds the scratch open. The unknown is w of `leak.gas_leak_flow`, in which the roughness hardly
    depends on p_f.

    Examples
    --------
    >>> import leak
    >>> x, p = np.linspace(-1e-3, 1e-3, 41), np.full(41, 30e6)
    >>> scratch = Scratch(depth=1e-6, width=20e-6)
    >>> found = gas_scratch_flow(
    ...     x, p, scratch, None, leak.gas("helium"), 2e5, 1e5, 0.0141421, effective_modulus=115e9
    ... )
    >>> f"{found.upper.leak_rate * 6e7:.1e} ml/min"
    '4.6e-04 ml/min'
    """
    points = checked_profile(x, p, radius)
    table = None if surface is None else gas_table(surface, points[1], largest_pressure, method)
    profile = profile_after(*points, ends, largest_pressure, table)
    permeant = GasPermeant.of(table, gas, inlet_pressure, outlet_pressure)
    return flow_along(profile, *points[:2], scratches, permeant, effective_modulus, pressure_side)


def flow_along(
    profile: ContactProfile,
    x: FloatArray,
    p: FloatArray,
    scratches: Groove | Sequence[Groove],
    permeant: Permeant,
    effective_modulus: float,
    pressure_side: str = "outer",
) -> LeakBounds[Any]:
    """Flow through a profile with scratches, of any fluid.

    Parameters
    ----------
    profile, x, p, permeant, pressure_side
        See `leak.flow.leak_rate.flow_through`.
    scratches, effective_modulus
        See `scratch_flow`.
    """
    modulus = positive(ProfileError, "effective_modulus", effective_modulus, "Pa")
    grooves = _checked_grooves(scratches)
    contact, deeper = _Contact.through(profile, permeant).divide(grooves, modulus)
    peak = int(np.argmax(p))
    if permeant.conductivity is None:
        gap = max(float(groove.section.open_depth(p[peak], modulus)) for groove in grooves)
    else:
        gap = float(gap_of(permeant, permeant.sigma(profile.log_equivalent(x[peak], np.log(p[peak])))))
    permeant = permeant.at_narrowest(gap)
    networks = _Networks(contact, permeant, modulus, grooves, deeper)

    def flow_of(*lines: Line) -> LeakResult | GasLeakResult:
        flow = network_flow(lines, *potential_ends(permeant, pressure_side))
        potential = np.interp(x, contact.x, flow.potential[contact.nodes])
        return permeant.result(flow.flow, permeant.potential.pressure(potential), peak, gap)

    everywhere = tuple(np.ones_like(mask) for mask in deeper)
    return LeakBounds(
        flow_of(networks.main(everywhere)),
        flow_of(networks.main(tuple(~mask for mask in everywhere))),
        lambda: flow_of(networks.main(deeper), *networks.separate_lines()),
    )


def deepest_scratch(
    leak_rate_of: Callable[[Scratch], float],
    allowed: float,
    *,
    width: float | None = None,
    width_over_depth: float | None = None,
    angle: float = 0.0,
) -> Scratch | None:
    """The deepest scratch with which a seal does not leak more than allowed.

    Parameters
    ----------
    leak_rate_of : callable
        Leak rate of the seal with one scratch, rising with its depth; `upper` is on the safe side: for example
        ``lambda scratch: leak.scratch_flow(x, p, scratch, ...).upper.leak_rate``.
    allowed : float
        In the unit of `leak_rate_of`, such as a `LeakageLimit`'s rate [m^3/s].
    width : float, optional
        Full width of the scratch [m]; the depth is looked for up to this width.
    width_over_depth : float, optional
        Ratio of both instead; exactly one of the two must be given [-].
    angle : float
        See `Scratch` [rad].

    Returns
    -------
    Scratch or None
        Its depth to 1e-6. None if the seal leaks more than allowed even with a scratch of 1 nm. A scratch as deep as
        `width` if even that leaks no more than allowed: deeper ones are none.

    Raises
    ------
    ProfileError
        An argument has no meaning.

    Examples
    --------
    The scratch of 100 um width that lets 0.1 ml/min of water at 20 bar through a smooth seat:

    >>> x = np.linspace(-0.45e-3, 0.45e-3, 101)
    >>> p = 53e6 * np.exp(-0.5 * (x / 0.15e-3) ** 2)
    >>> def rate(scratch):
    ...     found = scratch_flow(x, p, scratch, None, 2e6, 0.014, viscosity=1e-3, effective_modulus=115e9)
    ...     return found.upper.leak_rate
    >>> f"{deepest_scratch(rate, 0.1e-6 / 60, width=100e-6).depth * 1e6:.2f} um"
    '5.37 um'
    """
    allowed = positive(ProfileError, "allowed", allowed, "m^3/s")
    if (width is None) == (width_over_depth is None):
        raise ProfileError("give either width [m] or width_over_depth [-], not both and not neither")
    if width is not None:
        full = positive(ProfileError, "width", width, "m")
        deepest = full
    else:
        ratio = positive(ProfileError, "width_over_depth", width_over_depth or 0.0, "-")
        deepest = _DEEPEST

    def of(log_depth: float) -> Scratch:
        depth = float(np.exp(log_depth))
        return Scratch(depth, full if width is not None else ratio * depth, angle)

    def excess(log_depth: float) -> float:
        rate = float(leak_rate_of(of(log_depth)))
        return float(np.log(max(rate, 1e-300) / allowed))

    low, high = float(np.log(min(_SHALLOWEST, 0.1 * deepest))), float(np.log(deepest))
    if excess(low) > 0.0:
        return None
    if excess(high) <= 0.0:
        return of(high)
    # A decade at a time: far from the answer a closed scratch leaks nothing and says nothing.
    for step in np.arange(low + np.log(10.0), high, np.log(10.0)):
        if excess(float(step)) > 0.0:
            high = float(step)
            break
        low = float(step)
    return of(root_between(excess, low, high, xtol=1e-6))


# -------------------------------------------------------------------- the contact in slices


@dataclass(frozen=True, eq=False)
class _Contact:
    """The quadrature points of a profile in the order of x: slices, each with one contact pressure."""

    log_pressure: FloatArray
    """ln(p/Pa), shape (n,)."""
    log_equivalent: FloatArray
    """ln p* of first loading at which the roughness lets as much through, shape (n,)."""
    radius: FloatArray
    length: FloatArray
    """That a slice stands for, shape (n,) [m]."""
    gap: FloatArray
    """u_eff of the roughness, zero where it lets nothing through, shape (n,) [m]."""
    x: FloatArray
    """Places where the fluid pressure is known, shape (m,) [m]."""
    nodes: IntArray
    """Number of slices before them, shape (m,)."""

    @classmethod
    def through(cls, profile: ContactProfile, permeant: Permeant) -> _Contact:
        """Slices of a profile; without roughness only between its points, where a groove would have no end."""
        profile = profile.with_cells(_CELLS)
        inner, cells, outer = profile.panels
        if permeant.conductivity is None:
            inner = outer = None
        parts = [part for part in (inner, cells, outer) if part is not None]
        offset = 0 if inner is None else inner.log_pressure.size
        count, per_cell = cells.log_pressure.shape
        log_p = np.concatenate([part.log_pressure.ravel() for part in parts])
        equivalent = np.concatenate([part.log_equivalent.ravel() for part in parts])
        contact = cls(
            log_p,
            equivalent,
            np.concatenate([part.radius.ravel() for part in parts]),
            np.concatenate([_lengths(part).ravel() for part in parts]),
            gap_of(permeant, permeant.sigma(equivalent)),
            profile.x,
            offset + per_cell * np.arange(count + 1),
        )
        # the gap is open where there is no contact
        return contact.select(
            np.isfinite(contact.gap) & ((contact.gap > 0.0) | (log_p > SMALLEST_LOG_PRESSURE))
        )

    @property
    def pressure(self) -> FloatArray:
        """p at the slices [Pa]."""
        return np.exp(self.log_pressure)

    def select(self, resists: BoolArray) -> _Contact:
        """Without the slices that resist nothing."""
        count = np.concatenate([[0], np.cumsum(resists)])
        return self._of(np.flatnonzero(resists), self.length[resists], count[self.nodes])

    def divide(self, grooves: tuple[Groove, ...], modulus: float) -> tuple[_Contact, tuple[BoolArray, ...]]:
        """Slices, and for each groove where it is deeper than the rough gap is wide, shape (n,).

        Slices are cut in two where that begins or ends: no bound jumps as a groove becomes deeper.
        """
        edges = np.concatenate([[0.0], np.cumsum(self.length)])
        middle = 0.5 * (edges[:-1] + edges[1:])
        deeper, places = [], []
        for groove in grooves:
            depth = groove.section.open_depth(self.pressure, modulus)
            total = depth + self.gap
            excess = np.where(total > 0.0, (depth - self.gap) / np.where(total > 0.0, total, 1.0), -1.0)
            is_deep = excess > 0.0
            k = np.flatnonzero(is_deep[:-1] != is_deep[1:])
            share = excess[k] / (excess[k] - excess[k + 1])
            deeper.append(bool(is_deep[0]) if is_deep.size else False)
            places.append(middle[k] + share * (middle[k + 1] - middle[k]))
        new_edges = np.unique(np.concatenate([edges, *places]))
        at = 0.5 * (new_edges[:-1] + new_edges[1:])
        slice_of = np.searchsorted(edges, at) - 1
        is_whole = np.bincount(slice_of, minlength=self.length.size)[slice_of] == 1
        length = np.where(is_whole, self.length[slice_of], np.diff(new_edges))
        # a groove changes sides at each of its places
        masks = tuple(
            (np.searchsorted(place, at) % 2 == 1) != first
            for first, place in zip(deeper, places, strict=True)
        )
        return self._of(slice_of, length, np.searchsorted(new_edges, edges)[self.nodes]), masks

    def _of(self, slices: IntArray, length: FloatArray, nodes: IntArray) -> _Contact:
        log_p, first = self.log_pressure[slices], self.log_equivalent[slices]
        return _Contact(log_p, first, self.radius[slices], length, self.gap[slices], self.x, nodes)


def _lengths(part: Panels) -> FloatArray:
    weights = 0.5 * gauss(part.log_pressure.shape[1])[1]
    return np.broadcast_to(part.stretch, part.log_pressure.shape) * weights


@dataclass(frozen=True, eq=False)
class _Networks:
    """Three networks of slices: roughness alone, with scratches cut off from it, and joined to it."""

    contact: _Contact
    permeant: Permeant
    modulus: float
    """E* [Pa]."""
    grooves: tuple[Groove, ...]
    deeper: tuple[BoolArray, ...]
    """Where each groove is deeper than the rough gap is wide, shape (n,)."""

    @cached_property
    def _rough(self) -> Callable[[FloatArray], FloatArray]:
        """Mobility of the roughness, flow over the slope of the potential, over the flow pressure (k, n)."""
        fluid, contact = self.permeant, self.contact
        gain = fluid.gain(contact.log_equivalent, contact.gap)
        sigma = contact.gap**3 / (12.0 * fluid.viscosity)
        rough = 2.0 * np.pi * contact.radius * sigma * fluid.per_potential
        return lambda flow_pressure: rough * gain(flow_pressure)

    def _mobility_along(self, n: int, at: slice, fluid: FloatArray, flow_pressure: FloatArray) -> FloatArray:
        """Mobility along a groove at fluid pressures and flow pressures (k, n)."""
        groove, permeant = self.grooves[n], self.permeant
        contact_pressure = self.contact.pressure[at] - (fluid - permeant.low)
        K = permeant.groove_conductance(groove.section, contact_pressure, self.modulus, flow_pressure)
        return K * permeant.per_potential / self._paths[n][at]

    @cached_property
    def _paths(self) -> list[FloatArray]:
        return [groove.path(self.contact.radius) for groove in self.grooves]

    @cached_property
    def _opens(self) -> list[FloatArray]:
        """Potential from which on each groove is open, shape (n,)."""
        low, high = self.permeant.low, self.permeant.high
        pressures = (groove.section.closing_pressure(self.modulus) for groove in self.grooves)
        return [
            self.permeant.potential(np.clip(low + self.contact.pressure - p, 0.0, high)) for p in pressures
        ]

    def main(self, masks: tuple[BoolArray, ...]) -> Line:
        """The roughness, and in it the grooves where they are not apart."""

        def mobility(potential: FloatArray) -> FloatArray:
            fluid, q = self.permeant.potential.pressure(potential), self.permeant.flow_pressure(potential)
            total = self._rough(q)
            for n, mask in enumerate(masks):
                if not mask.all():
                    mobility_along = self._mobility_along(n, slice(None), fluid, q)
                    total = total + (np.where(mask, 0.0, mobility_along) if mask.any() else mobility_along)
            return total

        count = self.contact.length.size
        opens = [np.where(mask, np.inf, at) for at, mask in zip(self._opens, masks, strict=True)]
        first = np.minimum.reduce(opens)
        return Line(
            np.arange(count + 1), self.contact.length, mobility, np.where(np.isinf(first), -np.inf, first)
        )

    def separate_lines(self) -> list[Line]:
        """The stretches of the grooves that are apart, with nodes of their own between the ends."""
        lines, next_node = [], self.contact.length.size + 1
        for n, (mask, opens) in enumerate(zip(self.deeper, self._opens, strict=True)):
            turns = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
            for begin, end in zip(turns[::2], turns[1::2], strict=True):
                nodes = np.concatenate([[begin], next_node + np.arange(end - begin - 1), [end]])
                next_node += end - begin - 1
                at = slice(int(begin), int(end))
                lines.append(Line(nodes, self.contact.length[at], self._mobility_within(n, at), opens[at]))
        return lines

    def _mobility_within(self, n: int, at: slice) -> Callable[[FloatArray], FloatArray]:
        fluid = self.permeant
        return lambda psi: self._mobility_along(
            n, at, fluid.potential.pressure(psi), fluid.flow_pressure(psi)
        )


def _checked_grooves(scratches: Groove | Sequence[Groove]) -> tuple[Groove, ...]:
    grooves = (scratches,) if isinstance(scratches, Groove) else tuple(scratches)
    if not grooves:
        raise ProfileError("scratches is empty: give at least one Scratch or SpiralLay")
    for groove in grooves:
        if not isinstance(groove, Groove):
            raise ProfileError(f"scratches holds {groove!r}: must be a Scratch or a SpiralLay")
    return grooves
