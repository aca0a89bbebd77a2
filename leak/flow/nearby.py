"""Flow conductivity of surfaces close to one whose table is known, from few pressures."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from leak.arrays import FloatArray
from leak.flow.conductivity import ConductivityTable, GasConductivityTable, table_abscissa
from leak.flow.memory import LoadMemory
from leak.flow.rarefied import log_flow_factor
from leak.flow.rough_contact import RoughContact, gas_conductivity_table
from leak.numerics.curves import MonotoneCurve, cubic_spline_slopes

# A surface is calculated at the highest pressure that occurs and at these places of the abscissa of the tables below:
# close together between low pressures and sealing. Where all are low, at these distances below the highest instead.
_PLACES = np.array(
    [-14.0, -9.0, -6.0, -4.0, -2.8, -1.9, -1.2, -0.6, -0.1, 0.3, 0.7, 1.1, 1.6, 2.2, 3.0, 4.2, 6.0, 9.0, 14.0]
)
_BELOW, _LOW = np.array([14.0, 8.5, 5.5, 3.0, 1.4, 0.0]), -2.5
# The highest pressure is rounded up to a lattice, so that many surfaces share what is needed of the known one.
_LATTICE = 0.25
# Profiles may rise a little above the highest pressure between their points.
_ABOVE = 1.02
# The known table reaches from this share of the sealing pressure; nothing is calculated closer to sealing than this.
_LOWEST, _CLOSEST = 1e-9, 0.98
# Kinks of the spectrum at which quadratures stop.
_MOST_BREAKS = 40
# ln of the inverse Knudsen numbers of a gas at which a surface is calculated.
_LOG_D = np.array([-9.0, -5.5, -3.0, -1.0, 1.0, 3.0, 6.5])
# Molecules fly this share of a gap that is so wide that a gas is a liquid in it.
_CONTINUUM = 1e-20
# A gap over the rms height that is none; a table calls it zero.
_NOTHING = 1e-56
# Pressures of the table of a capped surface.
_OF_CAPPED = 72
_LOG_SHARES = np.concatenate(
    [np.linspace(-60.0, -4.0, 1001), np.log1p(-np.geomspace(1.0 - np.exp(-4.0), 1e-4, 4001))[1:]]
)

AnyTable = ConductivityTable | GasConductivityTable


class _Values(NamedTuple):
    """Of one surface at n pressures."""

    gap: FloatArray
    """u_eff over half the rms height, as the tables are smooth in it, shape (n,)."""
    rise: FloatArray
    """Of a gas: ln R over that of the known surface, at `_LOG_D`, shape (n, 7)."""


@dataclass(frozen=True, eq=False)
class NearbyTables:
    """Tables of surfaces close to one whose table is known.

    Two surfaces that differ little have gaps that differ smoothly at equal p/p_seal. What is interpolated over about
    nine pressures is that difference, of both calculated alike; the known table holds the rest. Quadratures stop at
    forty kinks of a spectrum at most. So it is for what the averaging over unequal gaps adds for a gas. A capped
    surface is the elastic one at another pressure.

    Parameters
    ----------
    surface : RoughContact
        The known one.
    of_gas : bool
        Whether the tables are of a gas, `GasConductivityTable`.
    method : {"bruggeman", "critical-junction", "threshold-law"}
        See `RoughContact.effective_separation`.

    Notes
    -----
    Leak rates are mostly off by less than 0.5 %, by 1 to 2 % where the peak pressure is above some 0.7 of the sealing
    pressure: whoever needs to know compares some with the surfaces' own tables, as `fem_seal`'s intervals do.

    Examples
    --------
    >>> import leak
    >>> shape = dict(rms_height=1e-6, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> known, close = (
    ...     leak.RoughContact(leak.PowerSpectrum.self_affine(hurst=H, **shape), effective_modulus=115e9)
    ...     for H in (0.8, 0.75)
    ... )
    >>> table = leak.NearbyTables(known).table(close, 1e8)
    >>> bool(abs(table.effective_separation(9e7) / close.effective_separation(9e7) - 1) < 1e-3)
    True
    """

    surface: RoughContact
    of_gas: bool = False
    method: str = "bruggeman"
    _known_values: dict[float, _Values] = field(default_factory=dict, repr=False)

    def table(self, surface: RoughContact, p_max: float) -> AnyTable:
        """Conductivity of a surface close to the known one, and of the same reading of yielding.

        Parameters
        ----------
        surface : RoughContact
        p_max : float
            Highest pressure that counts [Pa]. Above it the table goes on to the sealing pressure, for the flanks of
            contacts that are sealed anyway.
        """
        if surface.hardness is not None and surface.yielding == "capped":
            return self._capped(surface, p_max)
        sealing = surface.sealing_pressure_by(self.method)
        top = self._top(_ABOVE * p_max / sealing)
        liquid = _liquid(self._known)
        log_sealing = np.log(liquid.sealing_pressure)
        x = np.log(liquid.pressure) - log_sealing
        x = np.append(x[self._abscissa(x) < top - 1e-3], self._log_share(np.array([top])))
        at, abscissa = _places(top), self._abscissa(x)
        ours, theirs = self._at_few(surface, sealing, top), self._of_known(top)
        known = _logarithmic(liquid.at_log_pressure(x + log_sealing) / _length(self.surface))
        change = ours.gap - theirs.gap
        y = known + MonotoneCurve(at, change, cubic_spline_slopes(at, change)).value(abscissa)
        u = _length(surface) * np.logaddexp(0.0, y)
        found = ConductivityTable(np.exp(x) * sealing, u, sealing, np.inf, self.method, LoadMemory(surface))
        if not isinstance(self._known, GasConductivityTable):
            return found
        gas = _with_gas(found, self._known, x + log_sealing)
        rise = self._interpolated(at, ours.rise - theirs.rise, abscissa, gas.log_inverse_knudsen)
        return replace(gas, log_rarefaction=gas.log_rarefaction + rise)

    def _interpolated(
        self, at: FloatArray, change: FloatArray, abscissa: FloatArray, log_D: FloatArray
    ) -> FloatArray:
        """ln R over pressure and inverse Knudsen number from few of both; beyond both as at the ends."""
        from scipy.interpolate import RectBivariateSpline

        spline = RectBivariateSpline(at, _LOG_D, change)
        return np.asarray(
            spline(np.clip(abscissa, at[0], at[-1]), np.clip(log_D, _LOG_D[0], _LOG_D[-1])), dtype=float
        )

    def _capped(self, surface: RoughContact, p_max: float) -> AnyTable:
        """From the elastic surface, at the pressures at which that one has the gaps of the capped."""
        sealing = surface.sealing_pressure_by(self.method)
        highest = min(_ABOVE * p_max, _CLOSEST * sealing)
        ends = self._abscissa(np.log(np.array([_LOWEST, highest / sealing])))
        p = sealing * np.exp(self._log_share(np.linspace(ends[0], ends[1], _OF_CAPPED)))
        p[-1] = highest
        acting = surface.acting_pressure(p)
        elastic = self._elastic.table(surface.elastic, float(acting[-1]))
        u = np.asarray(_liquid(elastic).effective_separation(acting))
        found = ConductivityTable(p, u, sealing, np.inf, self.method, LoadMemory(surface))
        if not isinstance(elastic, GasConductivityTable):
            return found
        return _with_gas(found, elastic, np.log(acting))

    @cached_property
    def _elastic(self) -> NearbyTables:
        return NearbyTables(self.surface.elastic, self.of_gas, self.method)

    @cached_property
    def _known(self) -> AnyTable:
        sealing = self.surface.sealing_pressure_by(self.method)
        ends = _LOWEST * sealing, sealing
        if self.of_gas:
            return gas_conductivity_table(self.surface, *ends, method=self.method)
        return self.surface.conductivity_table(*ends, method=self.method)

    def _of_known(self, top: float) -> _Values:
        if top not in self._known_values:
            sealing = self.surface.sealing_pressure_by(self.method)
            self._known_values[top] = self._at_few(self.surface, sealing, top)
        return self._known_values[top]

    def _at_few(self, surface: RoughContact, sealing: float, top: float) -> _Values:
        """What is interpolated, with the same few stops in all surfaces."""
        few = replace(surface, spectrum=replace(surface.spectrum, most_breaks=_MOST_BREAKS))
        log_share = self._log_share(_places(top))
        p = sealing * np.exp(log_share)
        if not self.of_gas or self.method != "bruggeman":
            u = np.asarray(few.effective_separation(p, self.method))
            return _Values(_logarithmic(u / _length(surface)), np.zeros((p.size, _LOG_D.size)))
        # lengths of flight from the known gaps: of a continuum, and about those wanted
        liquid = _liquid(self._known)
        about = liquid.at_log_pressure(log_share + np.log(liquid.sealing_pressure))[:, None]
        about = np.maximum(about, _NOTHING * _length(self.surface)) * (
            _length(surface) / _length(self.surface)
        )
        lengths = about * np.concatenate([[_CONTINUUM], np.exp(-_LOG_D)])
        u, *wider = np.maximum(few.effective_gas_separation(p, lengths), _NOTHING * _length(surface)).T
        log_D = np.log(u[:, None] / lengths[:, 1:])
        log_R = 3.0 * np.log(np.transpose(wider) / u[:, None]) - log_flow_factor(log_D)
        assert isinstance(self._known, GasConductivityTable)
        log_p = np.broadcast_to(log_share[:, None] + np.log(liquid.sealing_pressure), log_D.shape)
        rise = log_R - np.log(self._known.rarefaction(log_p, log_D))
        rise[u <= _NOTHING * _length(surface)] = 0.0
        even = [np.interp(_LOG_D, *row) for row in zip(log_D, rise, strict=True)]
        return _Values(_logarithmic(u / _length(surface)), np.stack(even))

    def _top(self, share: float) -> float:
        """Highest abscissa for a highest pressure over that of sealing."""
        wanted = float(self._abscissa(np.log(np.array([min(share, _CLOSEST)])))[0])
        return float(min(_LATTICE * np.ceil(wanted / _LATTICE + 1e-6), self._highest))

    @cached_property
    def _highest(self) -> float:
        return float(self._abscissa(np.log(np.array([_CLOSEST])))[0])

    def _abscissa(self, log_share: FloatArray) -> FloatArray:
        return table_abscissa(log_share, 0.0, self.method)

    def _log_share(self, abscissa: FloatArray) -> FloatArray:
        """ln(p/p_seal), the inverse of `_abscissa`."""
        return np.interp(abscissa, self._even, _LOG_SHARES)

    @cached_property
    def _even(self) -> FloatArray:
        return self._abscissa(_LOG_SHARES)


def _places(top: float) -> FloatArray:
    """Where in the abscissa a surface is calculated."""
    if top < _LOW:
        return np.asarray(top - _BELOW)
    return np.append(_PLACES[top > _PLACES + 0.3], top)


def _with_gas(
    found: ConductivityTable, like: GasConductivityTable, log_pressure: FloatArray
) -> GasConductivityTable:
    """Of a gas, with what another table has at some pressures [ln(p/Pa)]."""
    log_D = like.log_inverse_knudsen
    R = like.rarefaction(*np.broadcast_arrays(log_pressure[:, None], log_D))
    return GasConductivityTable(found, np.log(R), log_D)


def _liquid(table: AnyTable) -> ConductivityTable:
    return table.liquid if isinstance(table, GasConductivityTable) else table


def _length(surface: RoughContact) -> float:
    return 0.5 * surface.spectrum.rms_height


def _logarithmic(ratio: FloatArray) -> FloatArray:
    """Linear in a large ratio and logarithmic in a small one; far below any gap next to sealing."""
    ratio = np.maximum(ratio, _NOTHING)
    return ratio + np.log(-np.expm1(-ratio))
