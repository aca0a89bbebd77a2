"""A gas that is neither ideal nor dilute: compressibility factor and viscosity over pressure, and its flow potential.

Notation: p the absolute pressure, Z = p/(rho R_s T), eta0 the viscosity of the dilute gas. The mass flow through a gap
is carried by rho/eta; q(p) = (p/Z)(eta0/eta) is the pressure at which an ideal gas would carry as much ("flow
pressure"). It also makes the inverse Knudsen number, D = q u/(eta0 v0), since the mean free path goes like eta/rho.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.fluids.pressure_law import check_table, cubic_of_logarithms
from leak.numerics.curves import MonotoneCurve, cubic_spline_slopes
from leak.numerics.gauss import gauss_panels


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

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        # asked for with each flow, and there are hundreds of numbers
        return hash((self.pressures, self.compressibility, self.viscosity_ratios, self.condenses))

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
        return np.asarray(p * np.exp(-self._log_share.value(p)))

    def flow_pressure_slope(self, pressure: FloatArray) -> FloatArray:
        """dq/dp at absolute pressures [-]."""
        log_share, slope = self._log_share.value_and_derivative(pressure)
        return np.asarray(np.exp(-log_share) * (1.0 - pressure * slope))

    @cached_property
    def _log_share(self) -> MonotoneCurve:
        """ln(p/q) over p: the sum of the splines of both logarithms."""
        p = np.array(self.pressures)
        log_share = np.log(self.compressibility) + np.log(self.viscosity_ratios)
        return MonotoneCurve(p, log_share, cubic_spline_slopes(p, log_share))


# Panels over the root of the pressure, between whose ends w, its inverse and q are cubics, and Gauss points in each.
# From w follow p to 1e-10 and q to 1e-9; next to a critical point to 1e-9 and 2e-6.
_PANELS, _POINTS = 1000, 4


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
        inside = np.clip(p, 0.0, self.highest)
        return _panels(self.real, self.highest)[0].value(inside) + 2.0 * c * inside

    def pressure(self, potential: ArrayLike) -> FloatArray:
        """p at values of w [Pa]."""
        ideal = self._ideal(np.maximum(np.asarray(potential, dtype=float), 0.0))
        if self.real is None:
            return ideal
        return np.minimum(self._over_ideal[0].value(ideal), self.highest)

    def flow_pressure(self, potential: ArrayLike) -> FloatArray:
        """q at values of w [Pa]."""
        ideal = self._ideal(np.maximum(np.asarray(potential, dtype=float), 0.0))
        return ideal if self.real is None else self._over_ideal[1].value(ideal)

    @cached_property
    def whole(self) -> float:
        """w at the highest pressure [Pa^2]."""
        return float(self(self.highest))

    def _ideal(self, w: FloatArray) -> FloatArray:
        """Pressure at which an ideal gas has these w >= 0 [Pa]."""
        root = np.sqrt(self.slip**2 + w)
        return np.asarray(w / np.where(root > 0.0, self.slip + root, 1.0))

    @cached_property
    def _over_ideal(self) -> tuple[MonotoneCurve, MonotoneCurve]:
        """p and q over the pressure at which an ideal gas has the same w: smooth down to vacuum, with known slopes."""
        assert self.real is not None  # who asks knows
        dense, bends = _panels(self.real, self.highest)
        ideal, q = self._ideal(dense.y + 2.0 * self.slip * dense.x), 0.5 * dense.slope
        # 2 (p_ideal + c) dp_ideal = dw = 2 (q + c) dp
        rise = np.divide(ideal + self.slip, q + self.slip, out=np.ones(q.shape), where=q + self.slip > 0.0)
        return MonotoneCurve(ideal, dense.x, rise), MonotoneCurve(ideal, q, bends * rise)


@lru_cache(maxsize=64)
def _panels(real: RealGas, highest: float) -> tuple[MonotoneCurve, FloatArray]:
    """w without c, whose slope is 2 q, between the ends of the panels, and there the slope of q."""
    at = highest * np.linspace(0.0, 1.0, _PANELS + 1) ** 2
    inside, weight = gauss_panels(at, _POINTS)
    dense = np.concatenate([[0.0], np.cumsum(2.0 * np.vecdot(real.flow_pressure(inside), weight))])
    return MonotoneCurve(at, dense, 2.0 * real.flow_pressure(at)), real.flow_pressure_slope(at)


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
