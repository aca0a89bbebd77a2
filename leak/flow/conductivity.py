"""Flow conductivity of a rough interface as a table over the pressure, for liquids and gases.

Asperities that have yielded do not come back. A place that carries p and has once carried p_max is tighter than one
that is loaded for the first time; it lets as much through as one that is loaded for the first time with a pressure p*
between p and p_max. Whatever is known of first loading, of liquids and of gases, then holds at p*.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import ConductivityError, positive
from leak.flow.rarefied import log_flow_factor
from leak.numerics.curves import CubicSurface, MonotoneCurve, cubic_spline_slopes, spline_slopes

METHODS = ("bruggeman", "critical-junction", "threshold-law")
# ... of them those that know no direction of the roughness.
WITHOUT_DIRECTION = ("critical-junction", "threshold-law")


@runtime_checkable
class RemembersLoad(Protocol):
    """What a rough contact, or its conductivity, remembers of its largest pressure.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9, hardness=2e9)
    >>> isinstance(surface.conductivity_table(1e6, 1e8, num=8), leak.RemembersLoad)
    True
    """

    def first_loading(self, log_pressure: ArrayLike, log_largest: ArrayLike) -> FloatArray:
        """ln p* of first loading that lets as much through as p after p_max, all in ln(p/Pa)."""


# u_eff falls to exp(-C/(1 - p/p_seal)) just below the sealing pressure, where 1/u_eff^3 is no number any more. What
# flows through less than this, 1e-160 m^3/s, is nothing, and no fluid and no sum of resistances overflows above it [m].
_SMALLEST_SEPARATION = 1e-60

# Weight of 1/(1 - p/p_seal) beside ln p in the variable of the table.
_SEALING_WEIGHT = 0.5


def table_abscissa(
    log_pressure: FloatArray, log_sealing_pressure: float, method: str = "bruggeman"
) -> FloatArray:
    """Variable in which ln u_eff is smooth: ln p at low pressure, 1/(1 - p/p_seal) toward sealing.

    The last open paths are at the smallest scales, where u1 vanishes like exp(-a^2/Y^2), so that ln u_eff goes like
    -1/(1 - p/p_seal). The closed law of the threshold falls with a power of 1 - p/p_seal instead: its logarithm.
    """
    to_sealing = -np.expm1(log_pressure - log_sealing_pressure)
    return log_pressure + (-np.log(to_sealing) if method == "threshold-law" else _SEALING_WEIGHT / to_sealing)


def logarithmic(ratio: FloatArray) -> FloatArray:
    """Linear in a large ratio and logarithmic in a small one, as u depends on the abscissa; -inf at zero."""
    with np.errstate(divide="ignore"):
        return ratio + np.log(-np.expm1(-ratio))


@dataclass(frozen=True)
class Conductivity:
    """sigma_eff(p) for one fluid: call it with pressures [Pa] to get m^3/(Pa s).

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> sigma = surface.conductivity_table(1e6, 1e8).at(viscosity=1e-3)
    >>> bool(sigma(2e7) < sigma(1e7))
    True
    """

    table: ConductivityTable
    viscosity: float

    def __call__(self, pressure: ArrayLike) -> FloatArray | float:
        """sigma_eff at nominal pressure p [m^3/(Pa s)]; infinite at p = 0."""
        return self.table.conductivity(pressure, self.viscosity)

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """sigma_eff at ln(p/Pa), where p itself may be too small for a floating-point number."""
        u = self.table.at_log_pressure(log_pressure)
        return u * u * u / (12.0 * self.viscosity)

    def first_loading(self, log_pressure: ArrayLike, log_largest: ArrayLike) -> FloatArray:
        """See `ConductivityTable.first_loading`."""
        return self.table.first_loading(log_pressure, log_largest)


@dataclass(frozen=True, eq=False)
class ConductivityTable:
    """u_eff = (12 eta sigma_eff)^(1/3) of one surface over ln p: independent of the fluid and of the geometry.

    Parameters
    ----------
    pressure : ndarray
        Nominal pressures, increasing, shape (n,) [Pa].
    separation : ndarray
        u_eff there, positive and falling, shape (n,) [m].
    sealing_pressure : float
        From here on nothing flows; infinite if the surface never seals [Pa].
    p_max : float
        Largest pressure that may be asked for [Pa].
    method : str
        "bruggeman", "critical-junction" or "threshold-law".
    memory : LoadMemory or None
        What the surface remembers of larger pressures, see `leak.flow.conductivity`; None where nothing is known of it.
    acts_at : callable or None
        ln of the pressure that acts at ln p, of a surface whose gaps are those of another one at another pressure:
        all pressures of the table are that one's. None where they are the surface's own.

    Notes
    -----
    A cubic spline over `table_abscissa`. Below the first pressure u_eff goes on linearly in ln p, the low-pressure law
    of the theory; between the last one and the sealing pressure it falls like exp(-C/(1 - p/p_seal)).

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> table = surface.conductivity_table(1e6, 1e8)
    >>> water, oil = table.at(viscosity=1e-3), table.at(viscosity=0.046)
    >>> round(float(water(1e7) / oil(1e7)), 6)
    46.0
    """

    pressure: FloatArray
    separation: FloatArray
    sealing_pressure: float
    p_max: float
    method: str = "bruggeman"
    memory: RemembersLoad | None = field(default=None, repr=False)
    acts_at: Callable[[FloatArray], FloatArray] | None = field(default=None, repr=False)

    @cached_property
    def _curve(self) -> MonotoneCurve:
        x = table_abscissa(np.log(self.pressure), self._log_sealing, self.method)
        y = logarithmic(self.separation / self._decay_length)
        return MonotoneCurve(x, y, spline_slopes(x, y))

    @cached_property
    def _decay_length(self) -> float:
        """-du_eff/dlnp at the low end [m]."""
        return float((self.separation[0] - self.separation[1]) / np.log(self.pressure[1] / self.pressure[0]))

    @property
    def liquid(self) -> ConductivityTable:
        """Itself: what a `GasConductivityTable` has beside the rarefaction."""
        return self

    def with_liquid(self, liquid: ConductivityTable) -> ConductivityTable:
        """The other table: what `GasConductivityTable.with_liquid` gives of a liquid."""
        return liquid

    @property
    def _log_sealing(self) -> float:
        return math.log(self.sealing_pressure)

    def of_surface(
        self, surface: YieldingContact, acts_at: Callable[[FloatArray], FloatArray] | None = None
    ) -> ConductivityTable:
        """The same table, with what larger pressures leave behind on a surface.

        Parameters
        ----------
        surface : RoughContact
        acts_at : callable, optional
            From nominal pressures to those at which the table is asked, both as logarithms.
        """
        return replace(self, memory=LoadMemory(surface), acts_at=acts_at)

    def scaled(
        self,
        height: float,
        pressure: float,
        surface: YieldingContact | None = None,
        acts_at: Callable[[FloatArray], FloatArray] | None = None,
    ) -> ConductivityTable:
        """The table of a surface with all heights times `height` that is asked for pressures times `pressure`.

        Parameters
        ----------
        height, pressure : float
            Ratios [-].
        surface : RoughContact, optional
            That surface, which knows what larger pressures leave behind.
        acts_at : callable, optional
            Of that surface.
        """
        table = ConductivityTable(
            self.pressure * pressure,
            self.separation * height,
            self.sealing_pressure * pressure,
            self.p_max * pressure,
            self.method,
            None if surface is None else LoadMemory(surface),
            acts_at,
        )
        curve = MonotoneCurve(self._curve.x + math.log(pressure), self._curve.y, self._curve.slope)
        vars(table).update(_curve=curve, _decay_length=self._decay_length * height)
        return table

    def effective_separation(self, pressure: ArrayLike) -> FloatArray | float:
        """u_eff(p) [m]; infinite at p = 0, zero from the sealing pressure on.

        Raises
        ------
        ConductivityError
            A pressure is negative, not a number, or above the table although the surface still leaks there.
        """
        p = np.asarray(pressure, dtype=float)
        if not np.all(p >= 0.0):
            raise ConductivityError(f"pressure = {p[~(p >= 0.0)].flat[0]}: must not be negative [Pa]")
        with np.errstate(divide="ignore"):
            u = self.at_log_pressure(np.log(p))
        return float(u) if u.ndim == 0 else u

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """u_eff at ln(p/Pa) [m]; zero below 1e-60 m, just before the sealing pressure."""
        x = self.table_log_p(np.asarray(log_pressure, dtype=float))
        sealing, log_p_max = self._log_sealing, math.log(self.p_max) + 1e-9
        top = x.max(initial=-np.inf)
        if top > log_p_max and (too_high := (x > log_p_max) & (x < sealing)).any():
            pressure = float(np.exp(x[too_high].max()))
            raise ConductivityError(
                f"pressure = {pressure:.6g} Pa is above the table's p_max = {self.p_max:.6g} Pa: make the table wider"
            )
        # mostly all of the contact leaks
        is_sealed = x >= sealing if top >= sealing else False
        below_sealing = x if is_sealed is False else np.where(is_sealed, sealing - 1.0, x)
        abscissa = table_abscissa(below_sealing, sealing, self.method)
        y = self._curve.value(abscissa)
        # ln(1 + exp(y))
        u = self._decay_length * (np.maximum(y, 0.0) + np.log1p(np.exp(-np.abs(y))))
        return np.where(is_sealed | (u < _SMALLEST_SEPARATION), 0.0, u)

    def table_log_p(self, log_pressure: FloatArray) -> FloatArray:
        """ln of the pressure at which the table is asked, of the nominal one at ln(p/Pa)."""
        return log_pressure if self.acts_at is None else self.acts_at(log_pressure)

    def conductivity(self, pressure: ArrayLike, viscosity: float) -> FloatArray | float:
        """sigma_eff = u_eff^3/(12 eta) [m^3/(Pa s)]."""
        eta = positive(ConductivityError, "viscosity", viscosity, "Pa s")
        u = np.asarray(self.effective_separation(pressure))
        sigma = u**3 / (12.0 * eta)
        return float(sigma) if sigma.ndim == 0 else sigma

    def first_loading(self, log_pressure: ArrayLike, log_largest: ArrayLike) -> FloatArray:
        """ln p* of first loading that lets as much through as p after p_max, all in ln(p/Pa).

        Raises
        ------
        ConductivityError
            If nothing is known of what the surface remembers.
        """
        if self.memory is None:
            raise ConductivityError(
                "memory = None: this conductivity says nothing of a contact that was pressed harder before; leave the "
                "largest pressure out, or take the table of a RoughContact"
            )
        return self.memory.first_loading(log_pressure, log_largest)

    def at(self, viscosity: float) -> Conductivity:
        """The conductivity for one fluid viscosity [Pa s], a function of pressure."""
        return Conductivity(self, positive(ConductivityError, "viscosity", viscosity, "Pa s"))


@dataclass(frozen=True, eq=False)
class AlikeTables:
    """Tables at the same fractions of their sealing pressures, between which one can interpolate.

    Parameters
    ----------
    over_sealing : ndarray, shape (n,)
        Pressures over the sealing pressure.
    rows : ndarray, shape (tables, 2 + 3 n)
        Of each what is interpolated: ln of the sealing pressure, decay length, ln u_eff, and of the curve over the
        pressure its values and slopes.
    method : str
    """

    over_sealing: FloatArray
    rows: FloatArray
    method: str

    @classmethod
    def of(cls, tables: Sequence[ConductivityTable]) -> AlikeTables:
        """Of tables whose last points before sealing may be missing where u_eff rounds to zero."""
        count = min(len(table.pressure) for table in tables)
        first = tables[0]
        rows = [
            [
                table._log_sealing,
                table._decay_length,
                *np.log(table.separation[:count]),
                *table._curve.y[:count],
                *table._curve.slope[:count],
            ]
            for table in tables
        ]
        return cls(first.pressure[:count] / first.sealing_pressure, np.array(rows), first.method)

    def combine(self, weights: Sequence[float], sealing_pressure: float | None = None) -> ConductivityTable:
        """The table with such weights of each, whose sum is one; with its own sealing pressure where that is known."""
        row, n = np.asarray(weights) @ self.rows, self.over_sealing.size
        if sealing_pressure is not None:
            row[0] = math.log(sealing_pressure)
        sealing, at = math.exp(row[0]), 2 + n
        table = ConductivityTable(
            self.over_sealing * sealing, np.exp(row[2:at]), sealing, math.inf, self.method
        )
        curve = MonotoneCurve(self._abscissa + row[0], row[at : at + n], row[at + n :])
        vars(table).update(_curve=curve, _decay_length=float(row[1]))
        return table

    @cached_property
    def _abscissa(self) -> FloatArray:
        """Over which the curves run, at a sealing pressure of one [Pa]."""
        return table_abscissa(np.log(self.over_sealing), 0.0, self.method)


@runtime_checkable
class GasConductivity(Protocol):
    """A gap between surfaces that lets a gas through.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> table = leak.gas_conductivity_table(surface, 1e6, 1e8, num=8)
    >>> hasattr(table, "at_log_pressure"), hasattr(table, "rarefaction")
    (True, True)
    """

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """u_eff at ln(p/Pa), p the contact pressure [m]."""

    def rarefaction(self, log_pressure: ArrayLike, log_inverse_knudsen: ArrayLike) -> FloatArray:
        """Flow of the gas over that through a uniform gap u_eff, at D = p_f u_eff/(eta v0) [-]."""


def log_rarefied_flow(table: GasConductivity, log_pressure: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """ln of f R at given contact pressures, a function of ln D_eff: sigma_eff of a gas over u_eff^3/(12 eta).

    Parameters
    ----------
    table : GasConductivity
    log_pressure : ndarray
        ln(p/Pa), of a shape that broadcasts to that of ln D_eff.
    """
    if isinstance(table, GasConductivityTable):
        return table.log_flow_at(log_pressure)

    def log_flow(log_D: FloatArray) -> FloatArray:
        R = table.rarefaction(np.broadcast_to(log_pressure, log_D.shape), log_D)
        return log_flow_factor(log_D) + np.log(R)

    return log_flow


# Differences of this order between neighbouring points show the joins of f and little else.
_KINKS = 5


@dataclass(frozen=True, eq=False)
class GasConductivityTable:
    """Gas flow through one surface over contact pressure and Knudsen number; serves every gas and geometry.

    A uniform gap u lets sigma = u^3 f(D)/(12 eta) through, D = p_f u/(eta v0), f = 6 Q_P(D)/D. The effective medium
    over P(u) with this local sigma gives sigma_eff = u_eff^3 f(D_eff) R/(12 eta), with u_eff of the liquid and
    D_eff = p_f u_eff/(eta v0). R(p_c, D_eff) is one in the continuum and stays within a factor of the order of one:
    it is what the table holds. Contact lets nothing through; so a gas percolates at the same contact area as a liquid.

    Parameters
    ----------
    liquid : ConductivityTable
        u_eff over contact pressure.
    log_rarefaction : ndarray
        ln R at the pressures of `liquid` and at `log_inverse_knudsen`, shape (n, m).
    log_inverse_knudsen : ndarray
        ln D_eff, in steps that change little from one to the next, shape (m,), m >= 6.

    Notes
    -----
    f has joins, which unequal gaps average away: f R has none where ln R has all of them, and the other way round in
    a uniform gap. A bicubic spline runs through ln R + c ln f, with the c(p) that leaves the fewest kinks.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> table = leak.gas_conductivity_table(surface, 1e6, 1e8, num=8)
    >>> table.log_rarefaction.shape[0] == len(table.liquid.pressure)
    True
    """

    liquid: ConductivityTable
    log_rarefaction: FloatArray
    log_inverse_knudsen: FloatArray

    def __post_init__(self) -> None:
        if self.log_inverse_knudsen.size <= _KINKS:
            raise ConductivityError(
                f"log_inverse_knudsen: has {self.log_inverse_knudsen.size} values, must have {_KINKS + 1} at least"
            )

    @cached_property
    def _spline(self) -> CubicSurface:
        """ln R + c ln f."""
        log_f = log_flow_factor(self.log_inverse_knudsen)
        smooth = self.log_rarefaction + self._share.y[:, None] * log_f
        return CubicSurface(self._share.x, self.log_inverse_knudsen, smooth)

    @property
    def _share(self) -> MonotoneCurve:
        """c over the pressure."""
        x = self._abscissa(np.log(self.liquid.pressure))
        joins = np.diff(log_flow_factor(self.log_inverse_knudsen), _KINKS)
        share = -np.diff(self.log_rarefaction, _KINKS, axis=1) @ joins / (joins @ joins)
        return MonotoneCurve(x, share, cubic_spline_slopes(x, share))

    def with_liquid(self, liquid: ConductivityTable) -> GasConductivityTable:
        """The same rarefaction beside another u_eff, at as many of its pressures as that has.

        Parameters
        ----------
        liquid : ConductivityTable
        """
        return replace(self, liquid=liquid, log_rarefaction=self.log_rarefaction[: len(liquid.pressure)])

    def _abscissa(self, log_pressure: FloatArray) -> FloatArray:
        return table_abscissa(log_pressure, float(np.log(self.liquid.sealing_pressure)), self.liquid.method)

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """u_eff at ln(p/Pa) [m]; zero from the sealing pressure on."""
        return self.liquid.at_log_pressure(log_pressure)

    def first_loading(self, log_pressure: ArrayLike, log_largest: ArrayLike) -> FloatArray:
        """See `ConductivityTable.first_loading`."""
        return self.liquid.first_loading(log_pressure, log_largest)

    def rarefaction(self, log_pressure: ArrayLike, log_inverse_knudsen: ArrayLike) -> FloatArray:
        """R at contact pressure p and inverse Knudsen number D_eff; beyond the table R - 1 falls like 1/D_eff."""
        return np.exp(self.log_rarefaction_at(log_pressure)(np.asarray(log_inverse_knudsen, dtype=float)))

    def log_rarefaction_at(self, log_pressure: ArrayLike) -> Callable[[FloatArray], FloatArray]:
        """ln of `rarefaction` at given contact pressures, a function of ln D_eff, for many pressures of the gas.

        Parameters
        ----------
        log_pressure : array_like
            ln(p/Pa).
        """
        log_flow = self.log_flow_at(log_pressure)
        return lambda log_D: log_flow(log_D) - log_flow_factor(log_D)

    def log_flow_at(self, log_pressure: ArrayLike) -> Callable[[FloatArray], FloatArray]:
        """ln of f R, what a flow is made of, as `log_rarefaction_at` has ln R.

        Parameters
        ----------
        log_pressure : array_like
            ln(p/Pa).
        """
        low, high = np.log(self.liquid.pressure[[0, -1]])
        log_p = self.liquid.table_log_p(np.asarray(log_pressure, dtype=float))
        x = self._abscissa(np.minimum(np.maximum(log_p, low), high))
        log_rarefaction, share = self._spline.at(x), self._share.value(x)
        first, last = ends = self.log_inverse_knudsen[[0, -1]]
        log_f_first, log_f_last = log_flow_factor(ends)

        def log_flow(log_D: FloatArray) -> FloatArray:
            log_f = log_flow_factor(log_D)
            # f falls: between the ends of the table it is what it is at the nearest D there
            log_R = log_rarefaction(np.minimum(np.maximum(log_D, first), last))
            log_R -= share * np.minimum(np.maximum(log_f, log_f_last), log_f_first)
            if log_D.max(initial=-np.inf) > last:
                log_R *= np.exp(-np.maximum(log_D - last, 0.0))
            return log_R + log_f

        return log_flow


AnyTable = ConductivityTable | GasConductivityTable


# -------------------------------------------------------------------- memory of a larger pressure

# Nodes of ln(p*/p): ln of p_max over the hardness, and ln(p_max/p). Beyond the last fall ln p* is a straight line, as
# the theory is at low pressure.
_LOG_SHARES = np.concatenate([np.arange(-14.0, -2.01, 0.25), np.arange(-2.0, -0.01, 0.04), [-1e-4]])
_FALLS = np.concatenate([[0.0, 0.02, 0.05], 0.1 * 1.25 ** np.arange(29.0)])
# From this share of the hardness on a place is pressed flat for good.
_FLAT = 1.0 - 1e-6


class YieldingContact(Protocol):
    """What a memory is made of, see `leak.RoughContact`."""

    @property
    def hardness(self) -> float | None:
        """[Pa]; None for elastic asperities, which remember nothing."""

    def equivalent_first_loading_pressure(self, pressure: ArrayLike, largest: ArrayLike) -> FloatArray:
        """p* of p after p_max [Pa]."""


@dataclass(frozen=True, eq=False)
class LoadMemory:
    """What a rough contact remembers of its largest pressure.

    Parameters
    ----------
    surface : RoughContact

    Notes
    -----
    ln(p*/p) is tabulated over p_max and ln(p_max/p).

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9, hardness=2e9, yielding="capped")
    >>> memory = surface.conductivity_table(1e5, 1e8, num=8).memory
    >>> bool(1e7 < np.exp(memory.first_loading(np.log(1e7), np.log(4e7))) < 4e7)
    True
    """

    surface: YieldingContact

    def first_loading(self, log_pressure: ArrayLike, log_largest: ArrayLike) -> FloatArray:
        """ln p* of first loading that lets as much through as p after p_max.

        Parameters
        ----------
        log_pressure, log_largest : array_like
            ln(p/Pa) and ln(p_max/Pa); a p_max that is not above p is p itself.

        Returns
        -------
        ndarray
            ln(p*/Pa), between both.
        """
        x, top = np.broadcast_arrays(
            np.asarray(log_pressure, dtype=float), np.asarray(log_largest, dtype=float)
        )
        equivalent = np.array(x)
        if self.surface.hardness is None:
            return equivalent
        # what carries nothing is open, whatever it carried before
        harder = (top > x) & np.isfinite(x)
        log_hardness = np.log(self.surface.hardness)
        # a place that was pressed flat once stays so
        flat = harder & (top >= log_hardness + np.log(_FLAT))
        equivalent[flat] = top[flat]
        remembers = harder & ~flat
        if np.any(remembers):
            p, top_p = x[remembers], top[remembers]
            equivalent[remembers] = np.clip(p + self._rise(top_p - log_hardness, top_p - p), p, top_p)
        return equivalent

    def _rise(self, log_share: FloatArray, fall: FloatArray) -> FloatArray:
        """ln(p*/p) over p_max/hardness and ln(p_max/p)."""
        share = np.clip(log_share, *_LOG_SHARES[[0, -1]])
        deepest = np.full(fall.shape, _FALLS[-1])
        rise = self._spline.at(share)(np.minimum(fall, deepest))
        is_beyond = fall > deepest
        if np.any(is_beyond):
            slope = self._spline.at(share[is_beyond], slope=True)(deepest[is_beyond])
            rise[is_beyond] += (fall - deepest)[is_beyond] * slope
        return rise

    @cached_property
    def _spline(self) -> CubicSurface:
        assert self.surface.hardness is not None  # elastic asperities do not get here
        largest = self.surface.hardness * np.exp(_LOG_SHARES)[:, None]
        pressure = largest * np.exp(-_FALLS)
        equivalent = self.surface.equivalent_first_loading_pressure(pressure, largest)
        return CubicSurface(_LOG_SHARES, _FALLS, np.log(equivalent / pressure))
