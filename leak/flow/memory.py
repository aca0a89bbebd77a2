"""A rough contact that was pressed harder before: the pressure of first loading at which it lets as much through.

Asperities that have yielded do not come back. A place that carries p and has once carried p_max is tighter than one
that is loaded for the first time; it lets as much through as one that is loaded for the first time with a pressure p*
between p and p_max. Whatever is known of first loading, of liquids and of gases, then holds at p*.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.flow.conductivity import ConductivityTable, table_abscissa
from leak.numerics.curves import MonotoneCurve, spline_slopes

if TYPE_CHECKING:
    from scipy.interpolate import RectBivariateSpline

# Nodes of ln(p*/p): p_max over the hardness, and ln(p_max/p). Below the first p_max nothing changes any more but for
# the square of it with which conserved asperities remember; beyond the last fall ln p* is a straight line, as the
# theory is at low pressure. The capped reading costs nothing; the conserved one takes an effective medium for each
# node, and its memory is small: 1e-4 of u_eff at a twentieth of the hardness.
_CAPPED_SHARES = np.exp(
    np.concatenate([np.arange(-14.0, -2.01, 0.25), np.arange(-2.0, -0.01, 0.04), [-1e-4]])
)
_CAPPED_FALLS = np.concatenate([[0.0, 0.02, 0.05], 0.1 * 1.25 ** np.arange(29.0)])
_CONSERVED_SHARES = np.array([0.1, 0.35, 0.6, 0.8, 1.0])
_CONSERVED_FALLS = np.array([0.0, 0.05, 0.2, 0.5, 1.0, 2.0, 4.5, 9.0])
# Of the largest pressure of the table, or of the hardness, close to which next to nothing is left of a surface.
_CONSERVED_TOP = 0.9
# From this share of the hardness on a place is pressed flat for good.
_FLAT = 1.0 - 1e-6
_INVERSE_NODES = 600
# A narrower gap is none [m].
_NO_GAP = 1e-40


class YieldingContact(Protocol):
    """What a memory is made of, see `leak.RoughContact`."""

    @property
    def hardness(self) -> float | None:
        """[Pa]; None for elastic asperities, which remember nothing."""

    @property
    def yielding(self) -> str:
        """Either "conserved" or "capped"."""

    def acting_pressure(self, pressure: ArrayLike, largest: ArrayLike | None = None) -> FloatArray:
        """Pressure at which the elastic surface lets as much through [Pa]."""

    def effective_separation(
        self, pressure: ArrayLike, method: str = "bruggeman", *, largest: ArrayLike | None = None
    ) -> FloatArray | float:
        """u_eff at p after a larger pressure [m]."""

    def sealing_pressure_after(self, largest: ArrayLike, method: str = "bruggeman") -> FloatArray:
        """From which pressure on nothing flows after a larger one [Pa]."""


@dataclass(frozen=True, eq=False)
class LoadMemory:
    """What a rough contact remembers of its largest pressure.

    Parameters
    ----------
    surface : RoughContact
    first : ConductivityTable
        Its first loading.

    Notes
    -----
    In the capped reading p* has the same equivalent pressure of elastic contact as p after p_max. In the conserved one
    it has the same u_eff as elastic contact at p of the surface smoothed at p_max, ln(p*/p) being tabulated over p_max
    and ln(p_max/p).

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
    first: ConductivityTable

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
        found = np.array(x)
        if self.surface.hardness is None:
            return found
        # what carries nothing is open, whatever it carried before
        harder = (top > x) & np.isfinite(x)
        log_hardness = np.log(self.surface.hardness)
        # a place that was pressed flat once stays so
        flat = harder & (top >= log_hardness + np.log(_FLAT))
        found[flat] = top[flat]
        remembers = harder & ~flat
        if np.any(remembers):
            p, most = x[remembers], top[remembers]
            rise = self._rise.at(most - log_hardness, most - p)
            found[remembers] = np.clip(p + rise, p, most)
        return found

    @cached_property
    def _rise(self) -> _Rise:
        return (
            _capped(self.surface)
            if self.surface.yielding == "capped"
            else _conserved(self.surface, self.first)
        )


@dataclass(frozen=True, eq=False)
class _Rise:
    """ln(p*/p) over p_max/hardness and ln(p_max/p)."""

    shares: FloatArray
    falls: FloatArray
    values: FloatArray
    """Over the power of the share, shape (shares, falls)."""
    power: float

    @cached_property
    def _spline(self) -> RectBivariateSpline:
        from scipy.interpolate import RectBivariateSpline

        return RectBivariateSpline(np.log(self.shares), self.falls, self.values)

    def at(self, log_share: FloatArray, fall: FloatArray) -> FloatArray:
        """ln(p*/p)."""
        inside = np.clip(log_share, *np.log(self.shares[[0, -1]]))
        deepest = np.full(fall.shape, self.falls[-1])
        found = np.asarray(self._spline.ev(inside, np.minimum(fall, deepest)))
        beyond = fall > deepest
        if np.any(beyond):
            slope = np.asarray(self._spline.ev(inside[beyond], deepest[beyond], dy=1))
            found[beyond] += (fall - deepest)[beyond] * slope
        return np.asarray(found * np.exp(self.power * log_share))


def _nodes(shares: FloatArray, falls: FloatArray, hardness: float) -> tuple[FloatArray, FloatArray]:
    """p and p_max at the nodes but those of no fall, where nothing is remembered, shape (shares, falls - 1)."""
    largest = hardness * np.broadcast_to(shares[:, None], (shares.size, falls.size - 1))
    return largest * np.exp(-falls[1:]), largest


def _capped(surface: YieldingContact) -> _Rise:
    assert surface.hardness is not None  # elastic asperities do not get here
    shares, falls = _CAPPED_SHARES, _CAPPED_FALLS
    pressure, largest = _nodes(shares, falls, surface.hardness)
    first = np.log(surface.hardness) + np.append(np.arange(-45.0, -0.02, 0.05), np.log(_FLAT))
    acting = np.log(surface.acting_pressure(np.exp(first)))
    curve = MonotoneCurve(first, acting, spline_slopes(first, acting))
    after = curve.inverse(np.log(surface.acting_pressure(pressure, largest)))
    values = np.zeros((shares.size, falls.size))
    values[:, 1:] = np.clip(after - np.log(pressure), 0.0, falls[1:])
    return _Rise(shares, falls, values, 0.0)


def _conserved(surface: YieldingContact, first: ConductivityTable) -> _Rise:
    assert surface.hardness is not None  # elastic asperities do not get here
    falls, hardness = _CONSERVED_FALLS, surface.hardness
    shares = _CONSERVED_SHARES * min(_CONSERVED_TOP, first.p_max / hardness)
    pressure, largest = _nodes(shares, falls, hardness)
    gap = np.asarray(surface.effective_separation(pressure, first.method, largest=largest))
    # beyond sealing, as far beyond as the surface that is left
    past = np.log(pressure / surface.sealing_pressure_after(largest, first.method))
    flows = gap > _NO_GAP
    after = np.where(
        flows,
        _pressure_of_gap(first)(np.where(flows, gap, first.at_log_pressure(np.log(first.pressure[0])))),
        np.log(first.sealing_pressure) + past,
    )
    values = np.zeros((shares.size, falls.size))
    values[:, 1:] = np.clip(after - np.log(pressure), 0.0, falls[1:]) / shares[:, None] ** 2
    return _Rise(shares, falls, values, 2.0)


def _pressure_of_gap(table: ConductivityTable) -> Callable[[FloatArray], FloatArray]:
    """ln p of first loading over u_eff."""
    low, high = np.log([table.pressure[0], (1.0 - 1e-3) * min(table.sealing_pressure, table.p_max)])
    fine = np.linspace(low, high, 50 * _INVERSE_NODES)
    even = table_abscissa(fine, float(np.log(table.sealing_pressure)), table.method)
    log_p = np.interp(np.linspace(even[0], even[-1], _INVERSE_NODES), even, fine)
    gap = np.asarray(table.at_log_pressure(log_p))
    flows = gap > _NO_GAP
    log_p, log_u = log_p[flows], np.log(gap[flows])
    curve = MonotoneCurve(log_p, log_u, spline_slopes(log_p, log_u))
    return lambda u: curve.inverse(np.log(u))
