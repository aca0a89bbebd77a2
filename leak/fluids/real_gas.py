"""A gas that is neither ideal nor dilute: compressibility factor and viscosity over pressure, and its flow potential.

Notation: p the absolute pressure, Z = p/(rho R_s T), eta0 the viscosity of the dilute gas. The mass flow through a gap
is carried by rho/eta; q(p) = (p/Z)(eta0/eta) is the pressure at which an ideal gas would carry as much ("flow
pressure"). It also makes the inverse Knudsen number, D = q u/(eta0 v0), since the mean free path goes like eta/rho.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.fluids.pressure_law import check_table, cubic_of_logarithms
from leak.numerics.gauss import gauss


@dataclass(frozen=True)
class RealGas:
    """Compressibility factor and viscosity of a gas over pressure, at one temperature.

    Between the values their logarithms are cubic splines; beyond the last one they go on straight.

    Parameters
    ----------
    pressures : tuple of float
        Absolute, increasing from zero, at least four [Pa].
    compressibility : tuple of float
        Z there, one at zero [-].
    viscosity_ratios : tuple of float
        eta/eta0 there, one at zero [-].
    condenses : bool
        Whether the gas is a liquid above the last pressure.

    Raises
    ------
    FluidError
        The values cannot be used.

    Examples
    --------
    >>> real = RealGas((0.0, 1e7, 2e7, 3e7), (1.0, 1.1, 1.2, 1.3), (1.0, 1.0, 1.0, 1.0))
    >>> f"{float(real.flow_pressure(2e7)) / 1e7:.4f}"
    '1.6667'
    """

    pressures: tuple[float, ...]
    compressibility: tuple[float, ...]
    viscosity_ratios: tuple[float, ...]
    condenses: bool = False

    def __post_init__(self) -> None:
        columns = {"compressibility": self.compressibility, "viscosity_ratios": self.viscosity_ratios}
        check_table(self.pressures, columns)

    @property
    def highest_pressure(self) -> float:
        """Last pressure of the table [Pa]."""
        return self.pressures[-1]

    def factor(self, pressure: ArrayLike) -> FloatArray:
        """Z at absolute pressures [Pa]."""
        return cubic_of_logarithms(self.pressures, self.compressibility, pressure)

    def viscosity_ratio(self, pressure: ArrayLike) -> FloatArray:
        """eta/eta0 at absolute pressures [Pa]."""
        return cubic_of_logarithms(self.pressures, self.viscosity_ratios, pressure)

    def flow_pressure(self, pressure: ArrayLike) -> FloatArray:
        """q = (p/Z)(eta0/eta) at absolute pressures [Pa]."""
        p = np.asarray(pressure, dtype=float)
        return np.asarray(p / (self.factor(p) * self.viscosity_ratio(p)))


# Panels over the root of the pressure, between whose ends w is a cubic, good to 1e-11, and Gauss points in each.
_PANELS, _POINTS = 1000, 4
_NEWTON_STEPS, _NEWTON_CLOSE, _ROUNDING = 60, 1e-7, 1e-14


@dataclass(frozen=True, eq=False)
class GasPotential:
    """w(p) = int_0^p 2 (q + c) dp', of an ideal gas p^2 + 2 c p, up to a highest pressure.

    Parameters
    ----------
    real : RealGas or None
        None for an ideal gas.
    highest : float
        [Pa]
    slip : float
        c >= 0 [Pa].

    Examples
    --------
    >>> ideal = GasPotential(None, 2e5, 1e4)
    >>> float(ideal(1e5)), round(float(ideal.pressure(ideal(1e5))), 6)
    (12000000000.0, 100000.0)
    """

    real: RealGas | None
    highest: float
    slip: float = 0.0

    def __call__(self, pressure: ArrayLike) -> FloatArray:
        """w at absolute pressures from zero to the highest [Pa^2]."""
        p, c = np.asarray(pressure, dtype=float), self.slip
        if self.real is None:
            return np.asarray(p * (p + 2.0 * c))
        return self._dense(np.clip(p, 0.0, self.highest))[0] + 2.0 * c * np.clip(p, 0.0, self.highest)

    def pressure(self, potential: ArrayLike) -> FloatArray:
        """p at values of w [Pa]."""
        w, c = np.maximum(np.asarray(potential, dtype=float), 0.0), self.slip
        if self.real is None:
            root = np.sqrt(c * c + w)
            return np.asarray(w / np.where(root > 0.0, c + root, 1.0))
        at, dense, _ = self._table
        # from an ideal gas between the ends of the panel, where w is nearly a square of p
        p = np.sqrt(np.interp(w, dense + 2.0 * c * at, at**2))
        for _ in range(_NEWTON_STEPS):
            value, slope = self._dense(p)
            slope = slope + 2.0 * c
            step = (w - value - 2.0 * c * p) / np.where(slope > 0.0, slope, np.inf)
            p = np.clip(p + step, 0.0, self.highest)
            # the error squares with each step
            if not np.any(np.abs(step) > _NEWTON_CLOSE * p + _ROUNDING * self.highest):
                break
        return np.asarray(p)

    def _dense(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """w without c, and its slope: cubic between the ends of the panels, where both are known."""
        at, dense, slopes = self._table
        k = np.clip((_PANELS * np.sqrt(np.nan_to_num(p) / self.highest)).astype(int), 0, _PANELS - 1)
        h = at[k + 1] - at[k]
        t, rise = (p - at[k]) / h, dense[k + 1] - dense[k]
        d0, d1 = h * slopes[k], h * slopes[k + 1]
        c2, c3 = 3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise
        return dense[k] + t * (d0 + t * (c2 + t * c3)), (d0 + t * (2.0 * c2 + 3.0 * t * c3)) / h

    @property
    def _table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        assert self.real is not None  # who asks knows
        return _panels(self.real, self.highest)


@lru_cache(maxsize=64)
def _panels(real: RealGas, highest: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Ends of the panels, and w there without c, with its slope."""
    at = highest * np.linspace(0.0, 1.0, _PANELS + 1) ** 2
    nodes, weights = gauss(_POINTS)
    half = 0.5 * np.diff(at)
    parts = 2.0 * half * (real.flow_pressure(at[:-1, None] + half[:, None] * (1.0 + nodes)) @ weights)
    return at, np.concatenate([[0.0], np.cumsum(parts)]), 2.0 * real.flow_pressure(at)


def real_gas_flow_ratio(real: RealGas | None, inlet_pressure: float, outlet_pressure: float) -> float:
    """Mass flow of a continuum over that of the ideal dilute gas, between two absolute pressures [-].

    Parameters
    ----------
    real : RealGas or None
    inlet_pressure, outlet_pressure : float
        [Pa]

    Examples
    --------
    >>> real_gas_flow_ratio(None, 2e5, 1e5)
    1.0
    """
    w, p = GasPotential(real, inlet_pressure), np.array([outlet_pressure, inlet_pressure])
    return float(np.diff(w(p))[0] / np.diff(p**2)[0])
