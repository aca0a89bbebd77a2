"""A rough map pressed on a rigid flat, on a half-space of von Mises' metal.

Notation: s deviatoric stress, e plastic strain, k = sigma_Y + H kappa the yield stress, kappa the equivalent plastic
strain. Each pressure of the path is one implicit step from the state before (backward Euler, radial return). Its
plastic strain makes the least of a convex function: stored energy, with the elastic contact solved within it, and
dissipation. The gradient of the first is -s of the elastic half-space, and its curvature at most 2 G, so that the
radial return from that stress is a proximal step of length 1/(2 G); Nesterov's method accelerates it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.direct.contact import ContactState, PeriodicHalfSpace, checked_heights, checked_pressures, press
from leak.direct.layers import LayeredHalfSpace, squared_norm
from leak.errors import DirectError, positive

# Of the contact within a step, over `tolerance`: what is left of it moves the plastic strain next to nothing.
_CONTACT = 0.01
# Steps of a method that needs some twenty.
_MOST_STEPS = 600
# Of the norm of a plastic strain.
_ROUND_OFF = 1e-12
# A layer at the bottom of the grid holds no more than this share of the largest plastic strain.
_BOTTOM = 1e-3


@dataclass(frozen=True, eq=False)
class ElastoplasticState:
    """A map pressed on metal that flows, and what it has left in the metal.

    Parameters
    ----------
    contact : ContactState
        Pressure and gap; its overlap is zero, since the metal itself has moved.
    plastic_displacement : ndarray
        Displacement of the surface by plastic strain, upwards, shape (n, m) [m].
    yielded_points : ndarray
        Where the grid below the surface has flowed, flat indices into (layers, n, m).
    plastic_strain : ndarray
        There, components xx, yy, xy, xz, yz (zz = -xx - yy), shape (5, m) [-].
    equivalent_strain : ndarray
        There, accumulated over the path, shape (m,) [-].
    body : LayeredHalfSpace
        Grid and modulus.
    stretch : tuple of float
        Mean total strain of the body in its plane along both axes of the map [-].

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import PeriodicHalfSpace, press_elastoplastic
    >>> x = np.arange(16) / 16
    >>> bumps = 1e-6 * np.cos(2 * np.pi * x)[:, None] * np.cos(2 * np.pi * x)[None, :]
    >>> body = PeriodicHalfSpace(16, 1e-3, 100e9)
    >>> loaded, unloaded = press_elastoplastic(body, bumps, [5e7, 5e6], yield_stress=2e8)
    >>> bool(unloaded.contact.gap.mean() < loaded.contact.gap.mean() + 1e-6)
    True
    """

    contact: ContactState
    plastic_displacement: FloatArray
    yielded_points: IntArray
    plastic_strain: FloatArray
    equivalent_strain: FloatArray
    body: LayeredHalfSpace
    stretch: tuple[float, float] = (0.0, 0.0)

    @property
    def pressure(self) -> FloatArray:
        """p on the surface, shape (n, m) [Pa]."""
        return self.contact.pressure

    @property
    def gap(self) -> FloatArray:
        """Zero in contact, shape (n, m) [m]."""
        return self.contact.gap

    @property
    def contact_area(self) -> float:
        """Share of the points that touch [-]."""
        return float(np.mean(self.pressure > 0.0))

    @property
    def has_yielded(self) -> BoolArray:
        """Points of the surface below which the metal has flowed, shape (n, m)."""
        flows = np.zeros(self.gap.size, bool)
        flows[self.yielded_points % flows.size] = True
        return flows.reshape(self.gap.shape)

    @property
    def yielded_area(self) -> float:
        """Share of the surface below which the metal has flowed [-]."""
        return float(np.mean(self.has_yielded))

    def field(self) -> FloatArray:
        """Plastic strain on the whole grid, shape (5, layers, n, m) [-]."""
        return self._on_grid(self.plastic_strain)

    def equivalent_field(self) -> FloatArray:
        """Equivalent plastic strain on the whole grid, shape (layers, n, m) [-]."""
        return self._on_grid(self.equivalent_strain)

    def _on_grid(self, values: FloatArray) -> FloatArray:
        shape = self.body.layers, *self.body.surface.shape
        grid = np.zeros((*values.shape[:-1], math.prod(shape)))
        grid[..., self.yielded_points] = values
        return grid.reshape(*values.shape[:-1], *shape)


def press_elastoplastic(
    body: PeriodicHalfSpace,
    heights: ArrayLike,
    pressures: ArrayLike,
    *,
    yield_stress: float,
    poissons_ratio: float = 0.3,
    hardening: float = 0.0,
    tolerance: float = 1e-3,
    start: ElastoplasticState | None = None,
    layers: int = 32,
    strain: ArrayLike | None = None,
) -> list[ElastoplasticState]:
    """Press a map of heights on a rigid flat along a path of mean pressures, with metal that flows below it.

    Small strain, associated flow by von Mises, isotropic linear hardening. A pressure smaller than the one before
    unloads, a larger one loads again. Steps are first order in the pressure: with steps of 0.0125 times three times
    the yield stress conductivities of rough surfaces are 2 to 4 % low.

    Parameters
    ----------
    body : PeriodicHalfSpace
        Grid, side and E*. The flat is rigid: the solid's own E is E*(1 - nu^2).
    heights : array_like, shape (n, m)
        h [m], upwards out of the body; periodic.
    pressures : array_like, shape (P,)
        Mean pressures in the order of the path [Pa].
    yield_stress : float
        sigma_Y in tension [Pa].
    poissons_ratio : float
        nu, from 0 to below 1/2 [-].
    hardening : float
        Growth of the yield stress with equivalent plastic strain, over Young's modulus [-].
    tolerance : float
        Of a step, as the share of its plastic strain that one more iteration would change, and of the contact, see
        `press`. The softer the metal, the smaller it must be: under a sphere with E* a/(R sigma_Y) = 300 (a the radius
        of the contact) 1e-3 is good to 2 % of the force at a depth, with 1600 to 10 %.
    start : ElastoplasticState, optional
        An earlier state of the same body and map, from which the path goes on.
    layers : int
        Of the grid below the surface, down to a third of the side.
    strain : array_like, shape (P, 2), optional
        Mean total strain of the body in its plane along both axes of the map at each pressure, elastic and plastic, as
        its bulk flows; that of `start` unless given, or none [-].

    Returns
    -------
    list of ElastoplasticState
        One for each pressure.

    Raises
    ------
    DirectError
        A value outside its meaning, metal that flows down to the bottom of the grid though its bulk is not strained,
        or no convergence.

    References
    ----------
    J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), for the radial return; A. Beck, M. Teboulle, SIAM J.
    Imaging Sci. 2, 183 (2009), for the acceleration; L. Pei et al., J. Mech. Phys. Solids 53, 2385 (2005), for the
    task.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import PeriodicHalfSpace, press_elastoplastic
    >>> x = np.arange(16) / 16
    >>> bumps = 1e-6 * np.cos(2 * np.pi * x)[:, None] * np.cos(2 * np.pi * x)[None, :]
    >>> body = PeriodicHalfSpace(16, 1e-3, 100e9)
    >>> (state,) = press_elastoplastic(body, bumps, [5e7], yield_stress=2e8)
    >>> bool(state.yielded_area > 0.0 and state.contact_area > 0.1)
    True
    """
    h, path = checked_heights(heights, "(n, m)"), checked_pressures("pressures", pressures)
    if h.shape != body.shape:
        raise DirectError(f"heights has shape {h.shape}: must be that of the body's grid, {body.shape}")
    nu, hard = _checked_number("poissons_ratio", poissons_ratio), _checked_number("hardening", hardening)
    if not 0.0 <= nu < 0.5:
        raise DirectError(f"poissons_ratio = {nu:g}: must be at least 0 and below 0.5 [-]")
    if not hard >= 0.0:
        raise DirectError(f"hardening = {hard:g}: must not be negative [-]")
    if int(layers) != layers or not 4 <= layers <= 1000:
        raise DirectError(f"layers = {layers}: must be a whole number from 4 to 1000")
    solid = LayeredHalfSpace(body, nu, int(layers))
    if start is not None and start.body != solid:
        raise DirectError("start: belongs to another grid, modulus, Poisson's ratio or number of layers")
    indentation = _Indentation(
        solid,
        h,
        positive(DirectError, "yield_stress", yield_stress, "Pa"),
        hard * solid.youngs_modulus,
        positive(DirectError, "tolerance", tolerance, "-"),
    )
    states, grid = [], (solid.layers, *body.shape)
    if start is None:
        plastic, equivalent, p, p_last = np.zeros((5, *grid)), np.zeros(grid), None, 0.0
    else:
        plastic, equivalent, p = start.field(), start.equivalent_field(), start.pressure
        p_last = float(p.mean())
    stretches = _checked_strain(strain, path.size, (0.0, 0.0) if start is None else start.stretch)
    rate, last_step = np.zeros_like(plastic), 0.0
    for pressure, stretch in zip(path.tolist(), stretches, strict=True):
        step = pressure - p_last
        guess = plastic + min(step / last_step, 1.0) * rate if step * last_step > 0.0 else plastic
        new, equivalent, lift, contact = indentation.step(pressure, stretch, plastic, equivalent, guess, p)
        rate, plastic, p, p_last, last_step = new - plastic, new, contact.pressure, pressure, step
        flat = equivalent.reshape(-1)
        points = np.flatnonzero(flat)
        is_stretched = any(stretch) or (start is not None and any(start.stretch))
        # a narrow map leaves the last layers no depth, and what flows there no strain in the very last one
        at_bottom = equivalent[np.cumsum(solid.thickness) > 0.99 * solid.thickness.sum()].max()
        if not is_stretched and at_bottom > _BOTTOM * flat.max(initial=0.0) > 0.0:
            raise DirectError(
                f"at the mean pressure {contact.pressure.mean():g} Pa metal flows down to a third of the side of the "
                "map, the bottom of the grid: take a smaller pressure or a map with more waves"
            )
        at_points = plastic.reshape(5, -1)[:, points], flat[points]
        states.append(ElastoplasticState(contact, lift, points, *at_points, solid, stretch))
    return states


def _checked_strain(
    strain: ArrayLike | None, count: int, last: tuple[float, float]
) -> list[tuple[float, float]]:
    """Of each step, both ways in the plane."""
    if strain is None:
        return [last] * count
    values = np.asarray(strain, dtype=float)
    if values.shape != (count, 2):
        raise DirectError(f"strain has shape {values.shape}: must be (P, 2) with P = {count} pressures")
    if not (np.abs(values) < 1.0).all():
        raise DirectError("strain: must be finite and between -1 and 1 [-]")
    return [(float(x), float(y)) for x, y in values]


def elastoplastic_path(
    body: PeriodicHalfSpace,
    heights: FloatArray,
    pressures: Iterable[float],
    *,
    yield_stress: float,
    longest_step: float,
    poissons_ratio: float = 0.3,
    strain: Callable[[float], tuple[float, float]] | None = None,
) -> Iterator[ElastoplasticState]:
    """The state at each pressure of a path, in load steps of equal length from one pressure to the next.

    Parameters
    ----------
    body, heights, yield_stress, poissons_ratio
        See `press_elastoplastic`.
    pressures : iterable of float
        Mean pressures in the order of the path [Pa].
    longest_step : float
        Of the load [Pa].
    strain : callable, optional
        Of the body in its plane, see `press_elastoplastic`, over the largest pressure so far [Pa]; none unless given.
    """
    state: ElastoplasticState | None = None
    last = largest = 0.0
    for pressure in pressures:
        # step by step: states are large, and only the last one is needed
        for step in np.linspace(last, pressure, math.ceil(abs(pressure - last) / longest_step) + 1)[1:]:
            largest = max(largest, float(step))
            (state,) = press_elastoplastic(
                body,
                heights,
                [step],
                yield_stress=yield_stress,
                poissons_ratio=poissons_ratio,
                start=state,
                strain=None if strain is None else [strain(largest)],
            )
        last = pressure
        assert state is not None  # pressures are above zero
        yield state


@dataclass(frozen=True)
class _Indentation:
    """A map pressed on a solid that flows; yield stress and hardening in Pa."""

    solid: LayeredHalfSpace
    heights: FloatArray
    yield_stress: float
    hardening: float
    tolerance: float

    def step(
        self,
        pressure: float,
        stretch: tuple[float, float],
        strain: FloatArray,
        equivalent: FloatArray,
        guess: FloatArray,
        p: FloatArray | None,
    ) -> tuple[FloatArray, FloatArray, FloatArray, ContactState]:
        """Plastic strain, equivalent strain, displaced surface and contact after one step of the pressure."""
        at, last_strain, momentum = guess, guess, 1.0
        for _ in range(_MOST_STEPS):
            response = self.solid.response(at)
            lift = self.solid.surface_rise(response)
            contact = press(
                self.solid.surface,
                self.heights + lift,
                pressure,
                start=p,
                tolerance=_CONTACT * self.tolerance,
            )
            p = contact.pressure
            new, plastic = self._return_radially(
                self.solid.distortion(response, p, stretch), strain, equivalent
            )
            # nothing has flowed, or no more than rounding
            if _norm(new - at) <= self.tolerance * _norm(new - strain) + _ROUND_OFF * _norm(new):
                return new, plastic, lift, contact
            step = new - last_strain
            if float(np.vdot(at - new, step)) > 0.0:
                momentum = 1.0
            next_momentum = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * momentum**2))
            last_strain, at, momentum = new, new + (momentum - 1.0) / next_momentum * step, next_momentum
        raise DirectError(
            f"plastic flow at the mean pressure {pressure:g} Pa did not converge in {_MOST_STEPS} iterations: take "
            "smaller steps of the pressure, or a larger tolerance"
        )

    def _return_radially(
        self, distortion: FloatArray, strain: FloatArray, equivalent: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Plastic and equivalent strain after a step to a distortion, by radial return; it is overwritten.

        Parameters
        ----------
        distortion : ndarray
            Total strain less its change of volume, shape (5, ...).
        strain, equivalent : ndarray
            Plastic ones before the step, shapes (5, ...) and (...).
        """
        G = self.solid.shear_modulus
        distortion -= strain
        mises = G * np.sqrt(6.0 * squared_norm(distortion))
        excess = np.maximum(mises - self.yield_stress - self.hardening * equivalent, 0.0)
        flow = excess / (3.0 * G + self.hardening)
        distortion *= np.divide(3.0 * G * flow, mises, out=np.zeros_like(mises), where=excess > 0.0)
        distortion += strain
        return distortion, equivalent + flow


def _norm(strain: FloatArray) -> float:
    return math.sqrt(float(squared_norm(strain).sum()))


def _checked_number(name: str, value: float) -> float:
    if not math.isfinite(value):
        raise DirectError(f"{name} = {value}: must be finite [-]")
    return float(value)
