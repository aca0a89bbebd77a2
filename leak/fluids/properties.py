"""Properties of liquids and gases that a leak rate needs, and how they change with pressure.

Liquids: p the pressure above atmospheric, eta0 and rho0 at atmospheric pressure. A steady flow carries mass,
rho u^3/(12 eta) dp/dx = const, so that m(p) = (rho/rho0) (eta0/eta) counts and psi(p) = int_0^p m dp' (Kirchhoff's
transformation) obeys the equation of a liquid that does not thicken.

Gases that are neither ideal nor dilute: p the absolute pressure, Z = p/(rho R_s T), eta0 the viscosity of the dilute
gas. The mass flow through a gap is carried by rho/eta; q(p) = (p/Z)(eta0/eta) is the pressure at which an ideal gas
would carry as much ("flow pressure"). It also makes the inverse Knudsen number, D = q u/(eta0 v0), since the mean free
path goes like eta/rho.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Protocol, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import LARGEST_LOG, FloatArray
from leak.errors import FluidError, positive
from leak.numerics.curves import MonotoneCurve, cubic_spline_slopes
from leak.numerics.integrals import gauss, gauss_panels
from leak.numerics.roots import newton_between


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
_GAS_PANELS, _GAS_POINTS = 1000, 4


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
        p_in = np.clip(p, 0.0, self.highest)
        return _gas_panels(self.real, self.highest)[0].value(p_in) + 2.0 * c * p_in

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

    @property
    def at_highest(self) -> float:
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
        dense, bends = _gas_panels(self.real, self.highest)
        ideal, q = self._ideal(dense.y + 2.0 * self.slip * dense.x), 0.5 * dense.slope
        # 2 (p_ideal + c) dp_ideal = dw = 2 (q + c) dp
        rise = np.divide(ideal + self.slip, q + self.slip, out=np.ones(q.shape), where=q + self.slip > 0.0)
        return MonotoneCurve(ideal, dense.x, rise), MonotoneCurve(ideal, q, bends * rise)


@lru_cache(maxsize=64)
def _gas_panels(real: RealGas, highest: float) -> tuple[MonotoneCurve, FloatArray]:
    """w without c, whose slope is 2 q, between the ends of the panels, and there the slope of q."""
    at = highest * np.linspace(0.0, 1.0, _GAS_PANELS + 1) ** 2
    p_in, weight = gauss_panels(at, _GAS_POINTS)
    dense = np.concatenate([[0.0], np.cumsum(2.0 * np.vecdot(real.flow_pressure(p_in), weight))])
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


@runtime_checkable
class PressureLaw(Protocol):
    """Viscosity and density of a liquid over pressure, at one temperature.

    Examples
    --------
    >>> import leak
    >>> isinstance(leak.Barus(20e-9), leak.PressureLaw)
    True
    """

    @property
    def highest_pressure(self) -> float:
        """Up to here the law is known to hold; it goes on beyond [Pa]."""

    @property
    def uncertainty(self) -> float:
        """Of the logarithm of the viscosity ratio, as a share of it [-]."""

    def viscosity_ratio(self, pressure: ArrayLike) -> FloatArray:
        """eta/eta0 at pressures above atmospheric [Pa], any shape."""

    def density_ratio(self, pressure: ArrayLike) -> FloatArray:
        """rho/rho0 at pressures above atmospheric [Pa], any shape."""


@dataclass(frozen=True)
class Tait:
    """Density under pressure, rho0/rho = 1 - C log10(1 + p/B).

    Parameters
    ----------
    pressure : float
        B [Pa].
    share : float
        C [-]; 0.2 holds for nearly all hydrocarbons.

    References
    ----------
    J. H. Dymond, R. Malhotra, Int. J. Thermophys. 9, 941 (1988).

    Examples
    --------
    >>> f"{float(Tait(91.6e6).density_ratio(100e6)):.3f}"
    '1.068'
    """

    pressure: float
    share: float = 0.2

    def __post_init__(self) -> None:
        positive(FluidError, "pressure", self.pressure, "Pa")
        positive(FluidError, "share", self.share, "-")

    @classmethod
    def of_bulk_modulus(cls, bulk_modulus: float) -> Tait:
        """With the isothermal bulk modulus at atmospheric pressure, B ln(10)/C.

        Parameters
        ----------
        bulk_modulus : float
            [Pa]

        Examples
        --------
        >>> law = Tait.of_bulk_modulus(1.6e9)
        >>> f"{1e4 / (float(law.density_ratio(1e4)) - 1.0):.3g}"
        '1.6e+09'
        """
        modulus = positive(FluidError, "bulk_modulus", bulk_modulus, "Pa")
        return cls(0.2 * modulus / float(np.log(10.0)))

    def density_ratio(self, pressure: ArrayLike) -> FloatArray:
        """rho/rho0 at pressures above atmospheric [Pa]."""
        p = np.asarray(pressure, dtype=float)
        return 1.0 / (1.0 - self.share * np.log10(1.0 + p / self.pressure))


@dataclass(frozen=True)
class Barus:
    """Viscosity eta = eta0 exp(alpha p).

    Parameters
    ----------
    coefficient : float
        alpha [1/Pa].
    compression : Tait or None
        None for a liquid of constant density.
    highest_pressure : float
        Up to which the law is known to hold [Pa].
    uncertainty : float
        Of alpha, as a share of it [-].

    Raises
    ------
    FluidError
        The coefficient is not a finite number, or negative.

    References
    ----------
    C. Barus, Am. J. Sci. 45, 87 (1893).

    Examples
    --------
    >>> f"{float(Barus(20e-9).viscosity_ratio(100e6)):.2f}"
    '7.39'
    """

    coefficient: float
    compression: Tait | None = None
    highest_pressure: float = float("inf")
    uncertainty: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.coefficient < float("inf"):
            raise FluidError(f"coefficient = {self.coefficient!r}: must not be negative [1/Pa]")

    def viscosity_ratio(self, pressure: ArrayLike) -> FloatArray:
        """eta/eta0 at pressures above atmospheric [Pa]."""
        return _exponential(self.coefficient * np.asarray(pressure, dtype=float))

    def density_ratio(self, pressure: ArrayLike) -> FloatArray:
        """rho/rho0 at pressures above atmospheric [Pa]."""
        return _density_ratio(self.compression, pressure)


# Roelands' limits for all liquids: the viscosity at the pole of his chart and the pressure that belongs to it.
_LEAST_LOG_VISCOSITY = -9.67
_ROELANDS_PRESSURE = 1.0 / 5.1e-9


@dataclass(frozen=True)
class Roelands:
    """Viscosity ln(eta/eta0) = (ln(eta0/(Pa s)) + 9.67) [(1 + 5.1e-9 p/Pa)^Z - 1].

    Parameters
    ----------
    exponent : float
        Z, 0.5 to 0.8 for most oils and fuels [-].
    viscosity : float
        eta0 [Pa s].
    compression, highest_pressure, uncertainty
        See `Barus`; the law was found to hold up to some 3000 bar.

    Raises
    ------
    FluidError
        A value is impossible: of a liquid thinner than 0.063 mPa s the law says nothing.

    References
    ----------
    C. J. A. Roelands, J. C. Vlugter, H. I. Waterman, J. Basic Eng. 85, 601 (1963); C. J. A. Roelands, thesis, Delft
    (1966).

    Examples
    --------
    A mineral oil of 40 mPa s has a pressure-viscosity coefficient of 22/GPa:

    >>> oil = Roelands(0.67, viscosity=0.04)
    >>> f"{oil.coefficient * 1e9:.1f} 1/GPa, {float(oil.viscosity_ratio(100e6)):.2f} times at 1000 bar"
    '22.0 1/GPa, 7.78 times at 1000 bar'
    """

    exponent: float
    viscosity: float
    compression: Tait | None = None
    highest_pressure: float = 3e8
    uncertainty: float = 0.0

    def __post_init__(self) -> None:
        positive(FluidError, "exponent", self.exponent, "-")
        positive(FluidError, "viscosity", self.viscosity, "Pa s")
        if self._height <= 0.0:
            raise FluidError(
                f"viscosity = {self.viscosity!r}: Roelands' law holds above 0.063 mPa s only; use Barus'"
            )

    @property
    def _height(self) -> float:
        return float(np.log(self.viscosity)) - _LEAST_LOG_VISCOSITY

    @property
    def coefficient(self) -> float:
        """alpha = d ln(eta)/dp at atmospheric pressure [1/Pa]."""
        return self.exponent * self._height / _ROELANDS_PRESSURE

    def viscosity_ratio(self, pressure: ArrayLike) -> FloatArray:
        """eta/eta0 at pressures above atmospheric [Pa]."""
        p = np.asarray(pressure, dtype=float) / _ROELANDS_PRESSURE
        return _exponential(self._height * np.expm1(self.exponent * np.log1p(p)))

    def density_ratio(self, pressure: ArrayLike) -> FloatArray:
        """rho/rho0 at pressures above atmospheric [Pa]."""
        return _density_ratio(self.compression, pressure)


def _exponential(log_ratio: FloatArray) -> FloatArray:
    return np.asarray(np.exp(np.minimum(log_ratio, LARGEST_LOG)))


def _density_ratio(compression: Tait | None, pressure: ArrayLike) -> FloatArray:
    p = np.asarray(pressure, dtype=float)
    return np.ones(p.shape) if compression is None else compression.density_ratio(p)


# -------------------------------------------------------------------- the flow potential

# Panels between zero and the highest pressure, and Gauss points in each: 1e-13 of psi for thickening by e^40. They
# reach up to a power of two to this step, so that neighbouring pressures share them.
_PANELS, _POINTS, _STEP = 112, 6, 0.25
# Newton's method doubles the digits: a step of this share of the highest pressure leaves round-off.
_NEWTON_CLOSE, _EXACT_SHARE = 1e-9, 1e-14
# A liquid 1e9 times as viscous is a solid. Held there, pressures whose psi differs by round-off alone stay apart, and
# psi is too large by no more than 1e-9 of the pressure.
_LEAST_MOBILITY = 1e-9


@dataclass(frozen=True, eq=False)
class FlowPotential:
    """psi(p) = int_0^p (rho/rho0)(eta0/eta) dp', from zero to a highest pressure; beyond it psi goes on straight.

    Parameters
    ----------
    law : PressureLaw or None
        None for a liquid that pressure does not change: psi = p.
    highest : float
        [Pa]

    Examples
    --------
    Barus' law has a closed form, psi = (1 - exp(-alpha p))/alpha:

    >>> potential = FlowPotential(Barus(20e-9), 100e6)
    >>> f"{float(potential(100e6)):.9g} {(1 - np.exp(-2.0)) / 20e-9:.9g}"
    '43233235.8 43233235.8'
    >>> f"{float(potential.pressure(potential(30e6))):.9g}"
    '30000000'
    """

    law: PressureLaw | None
    highest: float

    @classmethod
    def of(cls, law: PressureLaw | None, highest: float) -> FlowPotential:
        """The potential of a law up to a pressure, of equal ones the same, which has its ends already.

        Parameters
        ----------
        law, highest
            As of the class.
        """
        try:
            return _potential(cast(Hashable, law), highest)
        except TypeError:
            # somebody's own law, of which equal ones are not known
            return cls(law, highest)

    def __call__(self, pressure: ArrayLike) -> FloatArray:
        """psi at pressures [Pa], shape kept [Pa]."""
        p = np.asarray(pressure, dtype=float)
        if self.law is None:
            return p
        psi, at = self._panels[0].x, self._panels[0].y
        p_in = np.minimum(np.maximum(p, 0.0), self.highest)
        k = np.minimum(at.searchsorted(p_in, side="right") - 1, _PANELS - 1)
        nodes, weights = gauss(_POINTS)
        half = 0.5 * (p_in - at[k])
        mobility = self.mobility(at[k][..., None] + half[..., None] * (1.0 + nodes))
        first, last = self._ends
        straight = np.maximum(p - self.highest, 0.0) * last + np.minimum(p, 0.0) * first
        return np.asarray(psi[k] + half * (mobility @ weights) + straight)

    def pressure(self, potential: ArrayLike) -> FloatArray:
        """p at values of psi [Pa], shape kept [Pa]."""
        target = np.asarray(potential, dtype=float)
        if self.law is None:
            return target
        inverse, is_exact = self._panels
        psi, at, psi_end = inverse.x, inverse.y, self.at_highest
        psi_in = np.minimum(np.maximum(target, 0.0), psi_end)
        p = np.minimum(np.maximum(inverse.value(psi_in), 0.0), self.highest)
        if not is_exact:
            k = np.minimum(psi.searchsorted(psi_in, side="right") - 1, _PANELS - 1)
            low, high = np.minimum(at[k], self.highest), np.minimum(at[k + 1], self.highest)
            p = newton_between(
                lambda p: (self(p) - psi_in, self.mobility(p)),
                np.minimum(np.maximum(p, low), high),
                low,
                high,
                _NEWTON_CLOSE * self.highest,
            )
        first, last = self._ends
        return np.asarray(p + np.maximum(target - psi_end, 0.0) / last + np.minimum(target, 0.0) / first)

    def mobility(self, pressure: ArrayLike) -> FloatArray:
        """m = dpsi/dp = (rho/rho0)(eta0/eta) at pressures [Pa], shape kept [-]."""
        p = np.asarray(pressure, dtype=float)
        if self.law is None:
            return np.ones(p.shape)
        return _mobility(self.law, np.minimum(np.maximum(p, 0.0), self.highest))

    @property
    def _panels(self) -> tuple[MonotoneCurve, bool]:
        assert self.law is not None
        highest = 2.0 ** (_STEP * math.ceil(math.log2(self.highest) / _STEP))
        try:
            return _panels(cast(Hashable, self.law), highest)
        except TypeError:
            # somebody's own law, of which equal ones are not known
            return _panels.__wrapped__(self.law, highest)

    @cached_property
    def at_highest(self) -> float:
        """psi at the highest pressure [Pa]."""
        return float(self(self.highest))

    @cached_property
    def _ends(self) -> tuple[float, float]:
        first, last = self.mobility(np.array([0.0, self.highest]))
        return float(first), float(last)


_potential = lru_cache(FlowPotential)


@lru_cache(maxsize=64)
def _panels(law: PressureLaw, highest: float) -> tuple[MonotoneCurve, bool]:
    """p over psi at the ends of the panels, and whether the curve between them is as good as it gets."""
    at = np.linspace(0.0, highest, _PANELS + 1)
    p, weight = gauss_panels(at, _POINTS)
    psi = np.concatenate([[0.0], np.cumsum(np.vecdot(_mobility(law, p), weight))])
    inverse = MonotoneCurve(psi, at, 1.0 / _mobility(law, at))
    # at the middle of a panel the cubic is farthest off
    middle = 0.5 * (at[:-1] + at[1:])
    first_half = 0.5 * (at[:-1, None] + p)
    psi_middle = psi[:-1] + 0.5 * np.vecdot(_mobility(law, first_half), weight)
    is_exact = bool(np.abs(inverse.value(psi_middle) - middle).max() < _EXACT_SHARE * highest)
    return inverse, is_exact


def _mobility(law: PressureLaw, pressure: FloatArray) -> FloatArray:
    return np.maximum(law.density_ratio(pressure) / law.viscosity_ratio(pressure), _LEAST_MOBILITY)


def effective_viscosity_ratio(law: PressureLaw | None, pressure_drop: float) -> float:
    """Viscosity over eta0 of a liquid that does not change and lets as much through, Delta P/psi(Delta P) [-].

    Parameters
    ----------
    law : PressureLaw or None
    pressure_drop : float
        From Delta P above atmospheric pressure to atmospheric pressure [Pa].

    Examples
    --------
    >>> f"{effective_viscosity_ratio(Barus(20e-9), 50e6):.4f}"
    '1.5820'
    """
    drop = positive(FluidError, "pressure_drop", pressure_drop, "Pa")
    return drop / FlowPotential.of(law, drop).at_highest


# -------------------------------------------------------------------- tables


@dataclass(frozen=True)
class PressureTable:
    """Viscosity and density over pressure from values; between them their logarithms are cubic splines.

    Parameters
    ----------
    pressures : tuple of float
        Above atmospheric pressure, increasing from zero, at least four [Pa].
    viscosity_ratios, density_ratios : tuple of float
        eta/eta0 and rho/rho0 there [-].
    uncertainty : float
        See `Barus`.

    Raises
    ------
    FluidError
        The values cannot be used.

    Examples
    --------
    >>> law = PressureTable((0.0, 1e7, 2e7, 3e7), (1.0, 1.1, 1.21, 1.331), (1.0, 1.0, 1.0, 1.0))
    >>> f"{float(law.viscosity_ratio(1.5e7)):.5f}"
    '1.15369'
    """

    pressures: tuple[float, ...]
    viscosity_ratios: tuple[float, ...]
    density_ratios: tuple[float, ...]
    uncertainty: float = 0.0

    def __post_init__(self) -> None:
        columns = {"viscosity_ratios": self.viscosity_ratios, "density_ratios": self.density_ratios}
        check_table(self.pressures, columns)

    @property
    def highest_pressure(self) -> float:
        """Last pressure of the table [Pa]."""
        return self.pressures[-1]

    def viscosity_ratio(self, pressure: ArrayLike) -> FloatArray:
        """eta/eta0 at pressures above atmospheric [Pa]."""
        return cubic_of_logarithms(self.pressures, self.viscosity_ratios, pressure)

    def density_ratio(self, pressure: ArrayLike) -> FloatArray:
        """rho/rho0 at pressures above atmospheric [Pa]."""
        return cubic_of_logarithms(self.pressures, self.density_ratios, pressure)


def check_table(pressures: tuple[float, ...], columns: Mapping[str, tuple[float, ...]]) -> None:
    """FluidError unless pressures [Pa] increase from zero, and each column has a positive number for each of them."""
    if len(pressures) < 4 or pressures[0] != 0.0 or any(b <= a for a, b in pairwise(pressures)):
        raise FluidError(f"pressures = {pressures!r}: must be at least four, increasing from zero [Pa]")
    for name, values in columns.items():
        if len(values) != len(pressures) or not all(0.0 < value < float("inf") for value in values):
            raise FluidError(
                f"{name} = {values!r}: must be {len(pressures)} positive numbers, one for each pressure"
            )


def cubic_of_logarithms(at: tuple[float, ...], ratios: tuple[float, ...], pressure: ArrayLike) -> FloatArray:
    """Ratios at other pressures: their logarithms are cubic splines, and go on straight beyond their ends.

    Parameters
    ----------
    at, ratios : tuple of float
        Pressures, increasing [Pa], and positive values there.
    pressure : array_like
        [Pa]
    """
    return np.exp(_curve(at, ratios).value(np.asarray(pressure, dtype=float)))


@lru_cache(maxsize=32)
def _curve(at: tuple[float, ...], ratios: tuple[float, ...]) -> MonotoneCurve:
    """The cubic spline of the logarithms; only a curve that is asked for its inverse need be monotone."""
    pressures, logarithms = np.array(at), np.log(ratios)
    return MonotoneCurve(pressures, logarithms, cubic_spline_slopes(pressures, logarithms))


@dataclass(frozen=True)
class Liquid:
    """A Newtonian liquid at one temperature.

    Parameters
    ----------
    name : str
        What it is.
    viscosity : float
        Dynamic viscosity at atmospheric pressure [Pa s].
    density : float
        At atmospheric pressure [kg/m^3].
    temperature : float
        At which both hold [K].
    source : str
        Where the numbers come from.
    pressure_law : PressureLaw or None
        Viscosity and density over pressure; None where nothing is known of them.

    Raises
    ------
    FluidError
        A property is not positive and finite.

    Examples
    --------
    >>> import leak
    >>> leak.Liquid("oil", viscosity=0.046, density=870.0, temperature=313.15, source="data sheet").viscosity
    0.046
    """

    name: str
    viscosity: float
    density: float
    temperature: float
    source: str
    pressure_law: PressureLaw | None = None

    def __post_init__(self) -> None:
        for key, unit in (("viscosity", "Pa s"), ("density", "kg/m^3"), ("temperature", "K")):
            positive(FluidError, key, getattr(self, key), unit)


GAS_CONSTANT = 8.314462618
"""R [J/(mol K)], exact in the SI of 2019."""


@dataclass(frozen=True)
class Gas:
    """A gas at one temperature, dilute and ideal unless more is known of it.

    Parameters
    ----------
    name : str
        What it is.
    molar_mass : float
        M [kg/mol].
    viscosity : float
        Dynamic viscosity [Pa s]; that of a dilute gas does not depend on its pressure.
    temperature : float
        At which the viscosity holds, and at which the gas flows [K].
    source : str
        Where the numbers come from.
    dilute_pressure : float
        Up to this pressure density and viscosity are those of the dilute ideal gas within 5 % [Pa].
    real : RealGas or None
        What pressure makes of density and viscosity; None for an ideal dilute gas.

    Raises
    ------
    FluidError
        A property is not positive.

    Examples
    --------
    >>> from leak import gas
    >>> helium = gas("helium")
    >>> f"{helium.mean_free_path(101325.0) * 1e9:.0f} nm"
    '189 nm'
    """

    name: str
    molar_mass: float
    viscosity: float
    temperature: float
    source: str
    dilute_pressure: float = float("inf")
    real: RealGas | None = None

    def __post_init__(self) -> None:
        for key, unit in (("molar_mass", "kg/mol"), ("viscosity", "Pa s"), ("temperature", "K")):
            positive(FluidError, key, getattr(self, key), unit)
        if not self.dilute_pressure > 0.0:
            raise FluidError(f"dilute_pressure = {self.dilute_pressure!r}: must be positive [Pa]")

    @property
    def specific_gas_constant(self) -> float:
        """R_s = R/M [J/(kg K)]."""
        return GAS_CONSTANT / self.molar_mass

    @property
    def molecular_speed(self) -> float:
        """Most probable speed v0 = sqrt(2 R_s T) [m/s]."""
        return float(np.sqrt(2.0 * self.specific_gas_constant * self.temperature))

    def density(self, pressure: float) -> float:
        """Rho = p/(R_s T) of the ideal gas, in which leak rates are counted [kg/m^3]."""
        return pressure / (self.specific_gas_constant * self.temperature)

    def flow_pressure(self, pressure: ArrayLike) -> FloatArray:
        """Pressure at which the ideal dilute gas has the same rho/eta; p itself of such a gas [Pa]."""
        p = np.asarray(pressure, dtype=float)
        return p if self.real is None else self.real.flow_pressure(p)

    def mean_free_path(self, pressure: float) -> float:
        """Mean free path lambda = (eta/rho) sqrt(pi/(2 R_s T)), of an ideal gas (eta/p) sqrt(pi R_s T/2) [m]."""
        q = float(self.flow_pressure(pressure))
        return 0.5 * float(np.sqrt(np.pi)) * self.viscosity * self.molecular_speed / q
