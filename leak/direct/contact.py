"""Contact of a rough map with a flat, elastic or with a pressure that nowhere exceeds the hardness.

Notation: p pressure, H hardness, S p displacement of the half-space, h height, gap g = S p - h - alpha with the
approach alpha. Elastic contact: p >= 0, g >= 0, p g = 0, mean p given (Kalker). With the hardness: 0 <= p <= H, and
where p = H the surfaces may overlap, g < 0; the overlap is what yields and is squeezed away.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray
from leak.errors import DirectError


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


# Pressures that displace the surface by more than so many rms heights are no first guess of a contact.
_HILLS = 30.0
# Each is one application of the body to the pressure and one to the direction of descent.
_MOST_ITERATIONS = 3000


class ContactState(NamedTuple):
    """A pressed map.

    Examples
    --------
    >>> import numpy as np
    >>> from leak.direct import PeriodicHalfSpace, press
    >>> state = press(PeriodicHalfSpace(8, 1e-3, 100e9), np.zeros((8, 8)), 1e6)
    >>> float(state.gap.max()), float(state.pressure.min())
    (0.0, 1000000.0)
    """

    pressure: FloatArray
    """p [Pa], shape (n, n)."""
    gap: FloatArray
    """g >= 0 [m], exactly zero in contact."""
    overlap: FloatArray
    """What has yielded [m], >= 0: zero wherever p < H."""
    error: float
    """Largest violation of the conditions, as a gap over the rms height of the map [-]."""
    iterations: int


def press(
    body: PeriodicHalfSpace,
    heights: FloatArray,
    pressure: float,
    *,
    hardness: float | None = None,
    start: FloatArray | None = None,
    tolerance: float = 1e-4,
) -> ContactState:
    """Press a map of heights against a rigid flat to a given mean pressure.

    Conjugate gradients among the points whose pressure is free, 0 < p < H; points join and leave them as the
    conditions demand, and the mean pressure is restored after each step.

    Parameters
    ----------
    body : PeriodicHalfSpace
        The half-space under the map, with the E* of both bodies together.
    heights : ndarray, shape (n, n)
        h [m], upwards out of the body; only differences count.
    pressure : float
        Mean pressure [Pa].
    hardness : float or None
        H [Pa]; without it the contact is elastic.
    start : ndarray or None
        A pressure to start from [Pa], such as that of a neighbouring load.
    tolerance : float
        Largest violation allowed of g = 0, g >= 0 or g <= 0 at any point, over the rms height.

    Raises
    ------
    DirectError
        The mean pressure reaches the hardness, or the iteration does not converge.

    References
    ----------
    I. A. Polonsky, L. M. Keer, Wear 231, 206 (1999) for the elastic iteration; the second bound is treated in the
    same way as the first. F. Almqvist et al., J. Colloid Interface Sci. 300 (2006) for the cap.
    """
    H = np.inf if hardness is None else hardness
    if not pressure < H:
        raise DirectError(
            f"pressure = {pressure:g} and hardness = {H:g}: the mean pressure must stay below it [Pa]"
        )
    # heights over their rms and pressures over the mean pressure keep all numbers of order one
    h, P = np.asarray(heights, dtype=float), pressure
    if float(np.ptp(h)) <= 8.0 * np.finfo(float).eps * float(np.abs(h).max()):
        # flat but for rounding, which is no roughness to measure an error by
        return ContactState(np.full_like(h, P), np.zeros_like(h), np.zeros_like(h), 0.0, 0)
    h_rms = float(np.std(h))
    total = P * h.size
    p = _first_guess(body, h, total, H) if start is None else _with_load(start, start > 0.0, total, H)
    direction, last_norm, restart, step = np.zeros_like(h), 1.0, True, 0.0
    for iteration in range(_MOST_ITERATIONS):
        g = body.displacement(p)
        g -= h
        free, at_cap = (p > 0.0) & (p < H), p >= H
        g -= _approach(g, p, free)
        joins = ((p <= 0.0) & (g < 0.0)) | (at_cap & (g > 0.0))
        error = float(np.abs(g[free | joins]).max(initial=0.0)) / h_rms
        if error < tolerance:
            overlap = np.where(p >= H, np.maximum(-g, 0.0), 0.0)
            return ContactState(p, np.where(p > 0.0, 0.0, np.maximum(g, 0.0)), overlap, error, iteration)
        if np.count_nonzero(free) > 1:
            r = np.where(free, g, 0.0)
            norm = float(np.vdot(r, r))
            direction = r if restart else r + norm / last_norm * np.where(free, direction, 0.0)
            last_norm = norm
            answer = body.displacement(direction)
            answer -= answer[free].mean()
            curvature = float(np.vdot(answer, direction))
            if curvature > 0.0:
                step = float(np.vdot(r, direction)) / curvature
        if step == 0.0:
            step = P / (h_rms * np.sqrt(h.size))
        y = p - step * direction if np.count_nonzero(free) > 1 else p.copy()
        y[joins] -= step * g[joins]
        restart = bool(joins.any())
        # The load that is missing is made up by the points that are free; where they cannot, by all.
        takes = free | joins
        stays = float(np.sum(p[at_cap & ~joins]))
        if stays >= total or (np.isfinite(H) and stays + H * np.count_nonzero(takes) <= total):
            y, takes, stays = p - step * g, np.ones_like(takes), 0.0
        p = np.clip(y, 0.0, H)
        p[takes] = _shift_to_load(y[takes], total - stays, H)
    raise DirectError(
        f"contact at the mean pressure {P:g} Pa did not converge in {_MOST_ITERATIONS} iterations: "
        f"the largest error of the gap is {error:.1e} of the rms height, allowed are {tolerance:.1e}"
    )


def _first_guess(body: PeriodicHalfSpace, h: FloatArray, total: float, H: float) -> FloatArray:
    """The same pressure everywhere, or the hardness on the highest points."""
    same = np.full_like(h, total / h.size)
    if not np.isfinite(H):
        return same
    p = np.zeros(h.size)
    peaks = np.argsort(h, axis=None)[::-1][: int(np.ceil(total / H))]
    p[peaks] = total / peaks.size
    hills = p.reshape(h.shape)
    # A map that is nearly flat for this load touches everywhere, and hills of pressure are far from that.
    return hills if float(np.std(body.displacement(hills))) < _HILLS * float(np.std(h)) else same


def _approach(g: FloatArray, p: FloatArray, free: BoolArray) -> float:
    """The multiplier of the mean pressure: the mean of g where it is to vanish."""
    if free.any():
        return float(g[free].mean())
    touches = p > 0.0
    return 0.5 * float(g[touches].max() + g[~touches].min(initial=float(g[touches].max())))


def _with_load(p: FloatArray, takes: BoolArray, total: float, H: float) -> FloatArray:
    if H * np.count_nonzero(takes) <= total:
        takes = np.ones_like(takes)
    pressure = np.zeros_like(p)
    pressure[takes] = _shift_to_load(p[takes], total, H)
    return pressure


def _shift_to_load(y: FloatArray, total: float, H: float) -> FloatArray:
    """clip(y + c, 0, H) with the c that makes the sum `total`: the nearest pressures of that load."""
    low, high = -float(y.max()), (H if np.isfinite(H) else total) - float(y.min())
    c = 0.0
    for _ in range(200):
        p = np.clip(y + c, 0.0, H)
        excess = float(p.sum()) - total
        if abs(excess) <= 1e-13 * total:
            break
        low, high = (low, c) if excess > 0.0 else (c, high)
        free = np.count_nonzero((p > 0.0) & (p < H))
        newton = c - excess / free if free else np.nan
        c = newton if low < newton < high else 0.5 * (low + high)
    return p


def checked_heights(heights: ArrayLike, shape: str) -> FloatArray:
    """Finite numbers, or a `DirectError`; the shape is what the message calls it."""
    try:
        h = np.asarray(heights, dtype=float)
    except (TypeError, ValueError):
        raise DirectError(f"heights: must be an array of numbers, shape {shape} [m]") from None
    if not np.isfinite(h).all():
        raise DirectError("heights: every height must be finite [m]")
    return h


def checked_pressures(name: str, values: ArrayLike) -> FloatArray:
    """Positive finite pressures of one dimension, a number as one of them, or a `DirectError`."""
    try:
        p = np.array(values, dtype=float, ndmin=1)
    except (TypeError, ValueError):
        p = np.empty(0)
    if p.ndim != 1 or p.size == 0 or not (np.isfinite(p) & (p > 0.0)).all():
        raise DirectError(f"{name} = {values!r}: must be positive finite pressures [Pa]")
    return p
