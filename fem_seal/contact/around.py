"""Line load around the axis of a seal whose gap waves along it.

As long as the waves are long against the contact's width, every place of the circumference is in the axisymmetric
contact of its own line load f(phi), and the bodies even out what they can:

    D(f(phi)) + sum_n (c_n - c_0) f_n(phi) + h(phi) = d n_z,    mean of f = f_N,

with D(f) the approach along the normal of the axisymmetric contact, f_n(phi) the n-th harmonic of f, c_n the opening
under a line load that waves n times, and h(phi) what the form error adds to the gap. A closure that is free to shift
and tilt takes no first harmonic of f, and gives way to that of h. See docs/theory_form.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fem_seal.arrays import FloatArray
from fem_seal.errors import ConvergenceError

ComplexArray = NDArray[np.complexfloating]

# What is left of the gap's change, in decay lengths of the approach over ln f, and steps to get there.
_TOLERANCE, _MAX_STEPS = 1e-9, 80
# Shares of the form error in which it is put on where all at once fails.
_SHARES = (0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0)
# Where the line load falls, one step lets it fall by this many e-folds at most.
_FALL = 5.0
# Least line load over the mean that is followed in its logarithm.
_LEAST = 1e-60


class Local(Protocol):
    """The axisymmetric contact at the line load of each place; see `fem_seal.contact.local_contact`."""

    @property
    def opens(self) -> bool:
        """Whether the surfaces part at a definite approach."""
        ...

    def approach(self, line_load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Approach along the normal [m] and its derivative over ln f [m]."""
        ...

    def line_load(self, approach: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Line load [N/m] at an approach [m] and its derivative [N/m^2], of a contact that opens."""
        ...


def line_load_around(
    local: Local,
    stiffening: Callable[[int], float],
    gap: FloatArray,
    mean: float,
    *,
    symmetry: int = 1,
    guided: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Line load and approach at uniform angles of one period of the form error.

    Parameters
    ----------
    local : Local
    stiffening : callable
        c_n - c_0 of harmonic n [m per N/m]; that of the first is asked for only if the closure is guided.
    gap : ndarray, shape (m,)
        What the form error adds to the gap along the normal, at m uniform angles from 0 to 2 pi/symmetry [m].
    mean : float
        f_N [N/m].
    symmetry : int
        How often the form error repeats itself around the axis.
    guided : bool
        Whether the closure takes a lateral force and a moment.

    Returns
    -------
    line_load : ndarray, shape (m,)
        f [N/m]; zero where smooth surfaces part.
    approach : ndarray, shape (m,)
        Along the normal [m].

    Raises
    ------
    ConvergenceError
    """
    ring = _Ring.of(len(gap), stiffening, symmetry, guided)
    ways = (_in_modes,) if local.opens else (_in_logarithms, _in_modes)
    for iterate in ways:
        for shares in ((1.0,), _SHARES):
            f = np.full(len(gap), mean)
            for share in shares:
                found = iterate(local, ring, share * gap, mean, f)
                if found is None:
                    break
                f, approach = found
            else:
                return f, approach
    raise ConvergenceError(
        f"the line load around the axis did not converge in {_MAX_STEPS} steps for a form error of "
        f"{1e6 * float(np.ptp(gap)):.4g} um from the narrowest to the widest gap; make it smaller, or its waves longer"
    )


@dataclass(frozen=True)
class _Ring:
    """What the harmonics of a line load do to the gap, and which of them the closure does not take.

    Parameters
    ----------
    size : int
        Number of angles in a period.
    stiffening : ndarray, shape (2 j + 1,)
        c_n - c_0 of the modes -j to j of a period [m per N/m].
    rigid : ndarray of int
        Places among the modes of those whose share of the line load is given: the mean, and of a free closure the
        first harmonic.
    """

    size: int
    stiffening: FloatArray
    rigid: NDArray[np.int64]

    @classmethod
    def of(cls, size: int, stiffening: Callable[[int], float], symmetry: int, guided: bool) -> _Ring:
        j = (size - 1) // 2
        free = symmetry == 1 and not guided
        half = [0.0, *(0.0 if free and n == 1 else stiffening(symmetry * n) for n in range(1, j + 1))]
        rigid = [j - 1, j, j + 1] if free else [j]
        return cls(size, np.array([*half[:0:-1], *half]), np.array(rigid))

    @property
    def highest(self) -> int:
        return len(self.stiffening) // 2

    def modes(self, values: FloatArray) -> ComplexArray:
        """Fourier coefficients -j to j of real values at the angles."""
        half = np.fft.rfft(values)[: self.highest + 1] / self.size
        return np.concatenate([half[:0:-1].conj(), half])

    def values(self, modes: ComplexArray) -> FloatArray:
        """Real values at the angles of Fourier coefficients."""
        half = np.zeros(self.size // 2 + 1, dtype=complex)
        half[: self.highest + 1] = modes[self.highest :]
        return np.fft.irfft(half * self.size, self.size)

    def given(self, mean: float) -> ComplexArray:
        """The line load's modes that belong to rigid motions: its mean, and nothing of the first harmonic."""
        return np.where(self.rigid == self.highest, mean, 0.0).astype(complex)

    def step(
        self, tangent: FloatArray, right: ComplexArray, missing: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """Change y of the line load's modes and s of the rigid motion: y + T (C y - s) = right, y given where s is not.

        Parameters
        ----------
        tangent : ndarray
            df/dD at the angles, of which T is the product with it, in modes.
        right : ndarray
        missing : ndarray
            y of the rigid modes.
        """
        full = np.fft.fft(tangent) / self.size
        n = np.arange(len(self.stiffening))
        T = full[(n[:, None] - n) % self.size]
        matrix = T * self.stiffening + np.eye(len(T))
        right = right - matrix[:, self.rigid] @ missing
        matrix[:, self.rigid] = -T[:, self.rigid]
        change: ComplexArray = np.linalg.solve(matrix, right)
        motion = np.zeros_like(change)
        motion[self.rigid] = change[self.rigid]
        change[self.rigid] = missing
        return change, motion


def _in_logarithms(
    local: Local, ring: _Ring, gap: FloatArray, mean: float, start: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Newton's method in ln f, for a contact that never opens; None if it does not converge.

    Where the line load rises, a step is taken as log(1 + dv), so that the exponential cannot run away.
    """
    v, given = np.log(start), ring.given(mean)
    motion = np.zeros(len(ring.stiffening), dtype=complex)
    motion[ring.highest] = np.mean(local.approach(start)[0] + gap)
    for _ in range(_MAX_STEPS):
        f = np.exp(v)
        if f.min() < _LEAST * mean:
            return None
        approach, decay = local.approach(f)
        modes = ring.modes(f)
        residual = ring.values(motion - ring.stiffening * modes) - gap - approach
        missing = given - modes[ring.rigid]
        if np.max(np.abs(residual) / decay) < _TOLERANCE and np.max(np.abs(missing)) < _TOLERANCE * mean:
            return f, approach
        tangent = f / decay
        try:
            change, moved = ring.step(tangent, ring.modes(tangent * residual), missing)
        except np.linalg.LinAlgError:
            return None
        step = (residual + ring.values(moved - ring.stiffening * change)) / decay
        if not np.isfinite(step).all():
            return None
        v = v + np.where(step > 0, np.log1p(np.maximum(step, 0.0)), np.maximum(step, -_FALL))
        motion = motion + moved
    return None


def _in_modes(
    local: Local, ring: _Ring, gap: FloatArray, mean: float, start: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Newton's method for the modes of a line load that may be nothing at some places; None if it fails."""
    modes, given = ring.modes(start), ring.given(mean)
    modes[ring.rigid] = given
    motion = np.zeros(len(ring.stiffening), dtype=complex)
    motion[ring.highest] = np.mean(local.approach(start)[0] + gap)
    for _ in range(_MAX_STEPS):
        approach = ring.values(motion - ring.stiffening * modes) - gap
        f, tangent = local.line_load(approach)
        off = ring.modes(f) - modes
        if np.max(np.abs(off)) < _TOLERANCE * mean:
            return f, approach
        try:
            change, moved = ring.step(tangent, off, np.zeros(len(given), dtype=complex))
        except np.linalg.LinAlgError:
            return None
        if not (np.isfinite(change).all() and np.isfinite(moved).all()):
            return None
        modes, motion = modes + change, motion + moved
    return None
