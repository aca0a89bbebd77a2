"""Check of viscous gas flow: Mach number, choking."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.fluids.properties import Gas

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
    r, u = (np.broadcast_to(np.asarray(one, dtype=float), p.shape) for one in (radius, gap))
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
