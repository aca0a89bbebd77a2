"""Displacement of an elastic half-space under a periodic pressure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from leak.arrays import FloatArray


@dataclass(frozen=True)
class PeriodicHalfSpace:
    """Elastic half-space, loaded alike in every cell of a rectangular lattice.

    Normal displacement of the surface, into the half-space, at each wave vector q of the grid:
    u(q) = 2 p(q)/(E* |q|), and u(0) = 0, since the mean displacement is that of the whole body.

    Parameters
    ----------
    points : int or tuple of int
        Grid points along a side of the cell, or along both of them: the grid's own cells are square.
    size : float
        First side of the cell [m].
    effective_modulus : float
        E* [Pa].

    References
    ----------
    K. L. Johnson, Contact Mechanics (1985), section 13.2; H. M. Stanley, T. Kato, J. Tribol. 119, 481 (1997).

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import PeriodicHalfSpace
    >>> wave = np.cos(2.0 * np.pi * np.arange(8) / 8)[:, None] * np.ones(8)
    >>> u = PeriodicHalfSpace(8, 1e-3, 100e9).displacement(1e9 * wave)
    >>> bool(np.allclose(u, 1e9 * 1e-3 / (np.pi * 100e9) * wave))
    True
    """

    points: int | tuple[int, int]
    size: float
    effective_modulus: float

    @property
    def shape(self) -> tuple[int, int]:
        """Grid points along both sides."""
        return self.points if isinstance(self.points, tuple) else (self.points, self.points)

    @property
    def spacing(self) -> float:
        """Of the grid [m]."""
        return self.size / self.shape[0]

    @property
    def cell_area(self) -> float:
        """Of one period [m^2]."""
        n, m = self.shape
        return n * m * self.spacing**2

    @cached_property
    def _compliance(self) -> FloatArray:
        (n, m), spacing = self.shape, self.spacing
        q = 2.0 * np.pi * np.hypot(np.fft.fftfreq(n, spacing)[:, None], np.fft.rfftfreq(m, spacing)[None, :])
        q[0, 0] = np.inf
        return 2.0 / (self.effective_modulus * q)

    def displacement(self, pressure: FloatArray) -> FloatArray:
        """u [m] of a pressure [Pa], both of the grid's shape; the mean of u is zero."""
        from scipy import fft

        waves = fft.rfft2(pressure)
        waves *= self._compliance
        return fft.irfft2(waves, pressure.shape, overwrite_x=True)
