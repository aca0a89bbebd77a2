"""Heat across a rough contact: through the spots that touch, and through the fluid in the gap between them.

Notation: k = 2 k1 k2/(k1 + k2) conductivity of both bodies, k_f that of the fluid, u gap at a place, ubar in the mean,
P(u) its distribution, M the temperature jump of a gas at both walls as a length of gas.

Steady heat in a half-space obeys the equations of its normal displacement. Spots that stay as they are conduct (k/E*)
times the stiffness dp/du at which they press (Barber), and where the mean gap closes by d ubar, a place closes by
v d ubar, v the share of the temperature step that is left there, beside a spot none. To first order in k_f/k

    h = (k/E*) dp/du + k_f int v^2 P(u)/(u + M) du,   v P = d/d ubar int_u^inf P du',

the latter because all that closes beyond u passes it. No constant is fitted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import SurfaceError, positive
from leak.flow.rough_contact import RoughContact
from leak.fluids.coolprop import PREFIX, coolprop_is_gas
from leak.fluids.library import ACCOMMODATION, gas, heat_capacity_ratio, is_gas, thermal_conductivity
from leak.theory.separation import SeparationGrid, density

# Change of the pressure from which that of P(u) is taken, points of its grid, and how many times more magnifications.
_CHANGE, _POINTS, _REFINEMENT = 0.1, 256, 2.0
# Steps in ln(dp/du) between which the conductance of the gap is interpolated: it goes on evenly where the gap closes.
_STEP = 0.5
# P(u) times h_rms below which it is lost in the error of its quadrature, and carries nothing.
_LEAST = 1e-4


@dataclass(frozen=True)
class GapFluid:
    """How a fluid in the gap conducts heat.

    Parameters
    ----------
    conductivity : float
        k_f [W/(m K)].
    jump : float
        M p of a gas, p its pressure; zero for a liquid [m Pa].

    Raises
    ------
    SurfaceError
        A conductivity that is not positive, or a negative jump.

    Examples
    --------
    >>> helium = GapFluid.of("helium", 293.15)
    >>> print(f"{helium.conductivity:.3f} W/(m K), {1e6 * float(helium.jump_length(101325.0)):.2f} um")
    0.153 W/(m K), 2.46 um
    """

    conductivity: float
    jump: float = 0.0

    def __post_init__(self) -> None:
        positive(SurfaceError, "conductivity", self.conductivity, "W/(m K)")
        if not self.jump >= 0.0:
            raise SurfaceError(f"jump = {self.jump}: must not be negative [m Pa]")

    @classmethod
    def of(cls, name: str, temperature: float) -> GapFluid | None:
        """A fluid of the library or of CoolProp at a temperature [K]; None where its conductivity is not known.

        M = 2 (2 - a)/a 2 kappa/(kappa + 1) lambda/Pr of two walls, a the accommodation coefficient (Smoluchowski):
        for a = 1 the conductance k_f/(u + M) goes over into that of free molecules.

        Parameters
        ----------
        name : str
            Such as "helium", "water", "CoolProp:R134a".
        temperature : float
            [K]
        """
        conductivity = thermal_conductivity(name, temperature)
        if conductivity is None:
            return None
        if not (coolprop_is_gas(name, temperature) if name.startswith(PREFIX) else is_gas(name)):
            return cls(conductivity)
        kappa = heat_capacity_ratio(name)
        assert kappa is not None  # of every gas
        molecules, a = gas(name, temperature), ACCOMMODATION.get(name, 1.0)
        heat_capacity = kappa / (kappa - 1.0) * molecules.specific_gas_constant
        prandtl = molecules.viscosity * heat_capacity / conductivity
        # lambda p of the dilute gas, which hardly depends on p
        path = 0.5 * np.sqrt(np.pi) * molecules.viscosity * molecules.molecular_speed
        return cls(conductivity, float((2.0 - a) / a * 4.0 * kappa / (kappa + 1.0) * path / prandtl))

    def jump_length(self, pressure: ArrayLike) -> FloatArray:
        """M at absolute pressures, infinite in vacuum [m].

        Parameters
        ----------
        pressure : array_like
            [Pa]
        """
        p = np.asarray(pressure, dtype=float)
        if not self.jump:
            return np.zeros(p.shape)
        return np.divide(self.jump, p, out=np.full(p.shape, np.inf), where=p > 0.0)


def joint_conductance(
    surface: RoughContact,
    pressure: ArrayLike,
    conductivity: float,
    fluid: GapFluid | None = None,
    *,
    fluid_pressure: ArrayLike = 0.0,
    largest: ArrayLike | None = None,
) -> FloatArray:
    """Heat flux across a rough contact over the step in temperature, of spots and gap side by side.

    Within 6 % of direct simulation for gases between elastic faces, 10 % for liquids; 20 % where asperities yield, and
    up to 40 % less where they carried ten times as much before (theory/heat in the manual).

    Parameters
    ----------
    surface : RoughContact
    pressure : array_like
        Nominal contact pressure [Pa].
    conductivity : float
        k, harmonic mean of both bodies, 2 k1 k2/(k1 + k2) [W/(m K)].
    fluid : GapFluid, optional
        In the gap; none in vacuum.
    fluid_pressure : array_like
        Absolute, which decides how rarefied a gas is; of the shape of the pressure or one number [Pa].
    largest : array_like, optional
        Largest nominal pressure that the place has carried, see `RoughContact.effective_separation` [Pa].

    Returns
    -------
    ndarray
        Of the shape of the pressure; zero where it is zero, infinite from the hardness on [W/(m^2 K)].

    References
    ----------
    J. R. Barber, Proc. R. Soc. A 459, 53 (2003); B. N. J. Persson, B. Lorenz, A. I. Volokitin, Eur. Phys. J. E 31, 3
    (2010).

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> face = leak.RoughContact(spectrum, effective_modulus=115e9, hardness=3.5e9, theory="corrected")
    >>> in_helium = leak.joint_conductance(face, 1e7, 16.0, leak.GapFluid.of("helium", 293.15), fluid_pressure=1e5)
    >>> bool(in_helium > leak.joint_conductance(face, 1e7, 16.0))
    True
    """
    k = positive(SurfaceError, "conductivity", conductivity, "W/(m K)")
    h = np.asarray(k / surface.effective_modulus * surface.contact_stiffness(pressure, largest=largest))
    if fluid is None:
        return h
    top = pressure if largest is None else largest
    # the metal beside the narrowest spots conducts no better than half a wave of it
    jump = fluid.jump_length(fluid_pressure) + 2.0 * fluid.conductivity / (k * surface.spectrum.q_high)
    p, jump, h = np.broadcast_arrays(surface.equivalent_first_loading_pressure(pressure, top), jump, h)
    is_gap = (p > 0.0) & np.isfinite(h) & np.isfinite(jump)
    gap = np.zeros(h.shape)
    if np.any(is_gap):
        gap[is_gap] = fluid.conductivity * _gap_integral(surface, p[is_gap], jump[is_gap])
    return np.asarray(h + gap)


def _gap_integral(surface: RoughContact, pressure: FloatArray, jump: FloatArray) -> FloatArray:
    """Int v^2 P(u)/(u + M) du at pressures of first loading and lengths M, shape (n,) [1/m]."""
    stiffness = np.log(surface.contact_stiffness(pressure))
    order, count = np.argsort(stiffness), int(np.ceil(np.ptp(stiffness) / _STEP)) + 1
    places = np.linspace(stiffness.min(), stiffness.max(), count)
    at_nodes = np.exp(np.interp(places, stiffness[order], np.log(pressure[order])))
    separation, weight = _heat_distribution(surface, at_nodes)
    nodes = np.log(surface.contact_stiffness(at_nodes))
    cell = np.clip(np.searchsorted(nodes, stiffness, side="right") - 1, 0, max(count - 2, 0))
    following = np.minimum(cell + 1, count - 1)
    sums = (np.sum(weight[n] / (separation[n] + jump[:, None]), axis=1) for n in (cell, following))
    low, high = (np.log(value + np.finfo(float).tiny) for value in sums)
    step = np.where(following > cell, nodes[following] - nodes[cell], 1.0)
    return np.exp(low + (stiffness - nodes[cell]) / step * (high - low))


def _heat_distribution(surface: RoughContact, pressure: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gaps u [m] and v^2 P(u) du [-] at nominal pressures, shape (P, U)."""
    losses = [
        surface.lost_area(pressure, _REFINEMENT, factor)
        for factor in (1.0 / (1.0 + _CHANGE), 1.0, 1.0 + _CHANGE)
    ]
    grid = SeparationGrid.of(losses[1].mean_separation, surface.spectrum.rms_height, count=_POINTS)
    before, at, after = (density(loss, grid.separation) for loss in losses)
    closed = (before - after) * grid.weight
    beyond = np.cumsum(closed[:, ::-1], axis=1)[:, ::-1] - 0.5 * closed
    total = np.sum(closed * grid.separation, axis=1)[:, None]
    passing = np.divide(beyond, total, out=np.zeros(beyond.shape), where=total > 0.0)
    share = np.divide(passing**2, at, out=np.zeros(at.shape), where=at * surface.spectrum.rms_height > _LEAST)
    return grid.separation, share * grid.weight
