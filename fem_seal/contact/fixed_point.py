"""Fixed points: of smooth maps by Anderson's acceleration, of one number by steps from its side."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.errors import ConvergenceError
from leak.numerics.anderson import mixing_weights
from leak.numerics.roots import root_between

_MEMORY = 9
# Where the residual grows by more than this the memory misleads: forget it and go half as far.
_GROWTH = 3.0
# A step beyond where the fixed point is expected, so that it comes to lie between two places; at most so far beyond the
# image.
_OVERSHOOT, _FARTHEST = 1.2, 20.0
_MOST_ITERATIONS = 60


def fixed_point(
    image: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    *,
    tolerance: float,
    bounds: tuple[float, float],
    max_iterations: int = _MOST_ITERATIONS,
) -> tuple[FloatArray, tuple[float, ...]]:
    """Find x = image(x).

    Parameters
    ----------
    image : callable
    start : ndarray, shape (n,)
    tolerance : float
        Largest entry of image(x) - x that is left.
    bounds : tuple of float
        Between which every entry of x lies.
    max_iterations : int

    Returns
    -------
    x : ndarray, shape (n,)
        The last place where `image` was asked for.
    residuals : tuple of float
        Largest entry of image(x) - x, one per iteration.

    Raises
    ------
    ConvergenceError
        If the tolerance is not met.

    Notes
    -----
    Accelerated by `leak.numerics.anderson.mixing_weights`.
    """
    x = np.asarray(start, dtype=float)
    images, residuals, largest = list[FloatArray](), list[FloatArray](), list[float]()
    damping = 1.0
    for _ in range(max_iterations):
        images.append(image(x))
        residuals.append(images[-1] - x)
        largest.append(float(np.max(np.abs(residuals[-1]))))
        if largest[-1] <= tolerance:
            return x, tuple(largest)
        if len(largest) > 1 and largest[-1] > _GROWTH * min(largest[:-1]):
            images, residuals, damping = images[-1:], residuals[-1:], 0.5 * damping
        images, residuals = images[-_MEMORY:], residuals[-_MEMORY:]
        weights = mixing_weights(np.array(residuals))
        x = np.clip(weights @ np.array(images) - (1.0 - damping) * (weights @ np.array(residuals)), *bounds)
    raise ConvergenceError(
        f"no fixed point after {max_iterations} iterations; the last residual is {largest[-1]:.2g}, "
        f"{tolerance:.2g} was asked for"
    )


def first_fixed_point(
    image: Callable[[float], float], start: float, *, tolerance: float, jump: float
) -> float:
    """Find the first x = image(x) that is met from `start` on in the direction of its image.

    Parameters
    ----------
    image : callable
        A rising function, steps allowed.
    start : float
    tolerance : float
        How well x is found.
    jump : float
        Largest step of `image` at which its crossing x counts as a fixed point.

    Raises
    ------
    ConvergenceError
        If none is found.
    """
    x, residual, slope = start, image(start) - start, 0.0
    for _ in range(_MOST_ITERATIONS):
        if abs(residual) <= tolerance:
            return x
        # The residual falls to zero after residual/(1 - slope of the image).
        next_x = x + _OVERSHOOT * residual / max(1 - slope, 1 / _FARTHEST)
        next_residual = image(next_x) - next_x
        if next_residual * residual < 0:
            x = root_between(lambda at: image(at) - at, x, next_x, xtol=tolerance)
            residual = image(x) - x
            if abs(residual) <= jump:
                return x
            break
        slope = float(np.clip(1 + (next_residual - residual) / (next_x - x), 0.0, 1.0))
        x, residual = next_x, next_residual
    raise ConvergenceError(f"no fixed point was found; the last residual is {residual:.2g}")
