"""Flow conductivity of a rough interface for a rarefied gas: the effective medium with the gas factor in each gap."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from leak.conductivity import ConductivityTable, table_abscissa
from leak.errors import ConductivityError
from leak.rarefied_flow import flow_factor

if TYPE_CHECKING:
    from scipy.interpolate import RectBivariateSpline

    from leak.rough_contact import RoughContact

FloatArray = NDArray[np.float64]

# Inverse Knudsen numbers of u_eff in the table: beyond both ends the widest and the narrowest gaps that matter are in
# their limits too.
_LOG_D = np.linspace(np.log(1e-5), np.log(1e4), 66)


@runtime_checkable
class GasConductivity(Protocol):
    """A gap between surfaces that lets a gas through."""

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """u_eff at ln(p/Pa), p the contact pressure [m]."""

    def rarefaction(self, log_pressure: ArrayLike, log_inverse_knudsen: ArrayLike) -> FloatArray:
        """Flow of the gas over that through a uniform gap u_eff, at D = p_f u_eff/(eta v0) [-]."""


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
        ln D_eff, shape (m,).
    """

    liquid: ConductivityTable
    log_rarefaction: FloatArray
    log_inverse_knudsen: FloatArray

    @cached_property
    def _spline(self) -> RectBivariateSpline:
        from scipy.interpolate import RectBivariateSpline

        x = self._abscissa(np.log(self.liquid.pressure))
        return RectBivariateSpline(x, self.log_inverse_knudsen, self.log_rarefaction)

    def _abscissa(self, log_pressure: FloatArray) -> FloatArray:
        return table_abscissa(log_pressure, float(np.log(self.liquid.sealing_pressure)))

    def at_log_pressure(self, log_pressure: ArrayLike) -> FloatArray:
        """u_eff at ln(p/Pa) [m]; zero from the sealing pressure on."""
        return self.liquid.at_log_pressure(log_pressure)

    def rarefaction(self, log_pressure: ArrayLike, log_inverse_knudsen: ArrayLike) -> FloatArray:
        """R at contact pressure p and inverse Knudsen number D_eff; beyond the table R - 1 falls like 1/D_eff."""
        low, high = np.log(self.liquid.pressure[[0, -1]])
        log_p = np.clip(np.asarray(log_pressure, dtype=float), low, high)
        beyond = np.maximum(np.asarray(log_inverse_knudsen, dtype=float) - self.log_inverse_knudsen[-1], 0.0)
        log_D = np.clip(
            np.asarray(log_inverse_knudsen, dtype=float),
            self.log_inverse_knudsen[0],
            self.log_inverse_knudsen[-1],
        )
        return np.exp(self._spline.ev(self._abscissa(log_p), log_D) * np.exp(-beyond))


def gas_conductivity_table(
    surface: RoughContact, p_min: float, p_max: float, num: int = 64, method: str = "bruggeman"
) -> GasConductivityTable:
    """Table for all gases, made once per surface and range.

    Parameters
    ----------
    surface : RoughContact
    p_min, p_max : float
        Range of contact pressures [Pa].
    num : int
        Number of pressures in the range, at least 8.
    method : {"bruggeman", "critical-junction"}
        See `RoughContact.effective_separation`.
    """
    return _table(surface, float(p_min), float(p_max), int(num), method)


@lru_cache(maxsize=32)
def _table(surface: RoughContact, p_min: float, p_max: float, num: int, method: str) -> GasConductivityTable:
    liquid = surface.conductivity_table(p_min, p_max, num, method)
    if method == "critical-junction":
        # One junction has one gap: nothing to average over.
        log_R = np.zeros((liquid.pressure.size, _LOG_D.size))
        return GasConductivityTable(liquid, log_R, _LOG_D)
    u, D = liquid.separation[:, None], np.exp(_LOG_D)[None, :]
    gas = surface.effective_gas_separation(liquid.pressure, u / D)
    log_R = 3.0 * np.log(gas / u) - np.log(flow_factor(D))
    if not np.all(np.isfinite(log_R)):
        raise ConductivityError(
            f"p_max = {p_max}: too close to the sealing pressure {liquid.sealing_pressure} [Pa]"
        )
    return GasConductivityTable(liquid, log_R, _LOG_D)
