"""Memory of an earlier, larger pressure: the pressure of first loading with the same conductivity.

Asperities that have yielded do not come back. A place that carries p and has once carried p_max is tighter than one
that is loaded for the first time; it lets as much through as one that is loaded for the first time with a pressure p*
between p and p_max. Whatever is known of first loading, of liquids and of gases, then holds at p*.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import RectBivariateSpline

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

    def first_loading_pressure(self, pressure: ArrayLike, largest: ArrayLike) -> FloatArray:
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
            found[remembers] = np.clip(p + self._rise(most - log_hardness, most - p), p, most)
        return found

    def _rise(self, log_share: FloatArray, fall: FloatArray) -> FloatArray:
        """ln(p*/p) over p_max/hardness and ln(p_max/p)."""
        inside = np.clip(log_share, *_LOG_SHARES[[0, -1]])
        deepest = np.full(fall.shape, _FALLS[-1])
        found = np.asarray(self._spline.ev(inside, np.minimum(fall, deepest)))
        beyond = fall > deepest
        if np.any(beyond):
            slope = np.asarray(self._spline.ev(inside[beyond], deepest[beyond], dy=1))
            found[beyond] += (fall - deepest)[beyond] * slope
        return found

    @cached_property
    def _spline(self) -> RectBivariateSpline:
        from scipy.interpolate import RectBivariateSpline

        assert self.surface.hardness is not None  # elastic asperities do not get here
        largest = self.surface.hardness * np.exp(_LOG_SHARES)[:, None]
        pressure = largest * np.exp(-_FALLS)
        after = self.surface.first_loading_pressure(pressure, largest)
        return RectBivariateSpline(_LOG_SHARES, _FALLS, np.log(after / pressure))
