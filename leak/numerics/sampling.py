"""Points for a spline: close where a function bends, far apart where it does not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from leak.arrays import BoolArray, FloatArray, IntArray

# No interval is longer than this many times its neighbour.
_WIDEST = 3.5


def divided(ends: FloatArray, longest: float, slack: float = 0.0) -> FloatArray:
    """The ends of stretches, and between them points that cut each into as many equal parts as it needs.

    Parameters
    ----------
    ends : ndarray, shape (n,)
        Not decreasing.
    longest : float
        Part that is allowed.
    slack : float
        By this share of `longest` a part may be longer.

    Examples
    --------
    >>> divided(np.array([0.0, 1.0, 1.5]), 0.5).tolist()
    [0.0, 0.5, 1.0, 1.5]
    """
    counts = np.maximum(np.ceil(np.diff(ends) / longest - slack), 1).astype(int)
    parts = [
        np.linspace(left, right, count, endpoint=False)
        for left, right, count in zip(ends[:-1], ends[1:], counts, strict=True)
    ]
    return np.concatenate([*parts, ends[-1:]])


def sampled(
    function: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    allowed: Callable[[FloatArray], FloatArray],
    *,
    closest: float,
) -> tuple[FloatArray, FloatArray]:
    """Points of smooth functions through which cubics predict them to a tolerance, and the values there.

    Every interval is halved until the value in its middle is what the cubic through the four points around it
    predicted. A cubic spline through all points, the middles included, is then about a hundred times better than the
    prediction: its error is a tenth of that cubic's, and falls to a sixteenth by the halving.

    Parameters
    ----------
    function : callable
        Values at points of shape (n,), shape (n, m); not finite where it has none, and those points are left out.
    start : ndarray
        First points, increasing, shape (n,), n >= 4.
    allowed : callable
        Largest error of a prediction for given values, both of shape (n, m).
    closest : float
        No interval is halved that is not longer than this.

    Returns
    -------
    x : ndarray
        Points, increasing, shape (k,).
    y : ndarray
        Values, shape (k, m).

    Examples
    --------
    >>> bell, allowed = lambda x: np.exp(-(x**2))[:, None], lambda y: np.full(y.shape, 1e-3)
    >>> x, y = sampled(bell, np.linspace(-8.0, 8.0, 9), allowed, closest=0.01)
    >>> steps = np.diff(x)
    >>> bool(steps.max() > 3.0 * steps.min())
    True
    """
    x, y = start, function(start)
    open_: BoolArray = np.ones(x.size - 1, dtype=bool)
    while True:
        open_ = open_ & (np.diff(x) > closest)
        open_ |= _far_wider_than_a_neighbour(x) & (np.diff(x) > closest)
        # beside a point without a value only the place where the values end is looked for
        has = _has_value(y)
        open_ = open_ & (has[:-1] | has[1:])
        at: IntArray = np.flatnonzero(open_)
        if not at.size:
            break
        middle = 0.5 * (x[at] + x[at + 1])
        values = function(middle)
        with np.errstate(invalid="ignore"):
            good = (np.abs(values - _predicted(x, y, at, middle)) <= allowed(values)).all(axis=1)
        np.put(open_, at, ~good)
        x, y = np.insert(x, at + 1, middle), np.insert(y, at + 1, values, axis=0)
        # both halves of a bad interval are bad, both of a good one good
        open_ = np.insert(open_, at + 1, ~good)
    has = _has_value(y)
    return x[has], y[has]


def _far_wider_than_a_neighbour(x: FloatArray) -> BoolArray:
    """A prediction may be right by chance; where the next interval had to be halved twice it was."""
    length = np.diff(x)
    ends = np.concatenate([[np.inf], length, [np.inf]])
    return np.asarray(length > _WIDEST * np.minimum(ends[:-2], ends[2:]))


def _has_value(y: FloatArray) -> BoolArray:
    return np.asarray(np.isfinite(y).all(axis=1))


def _predicted(x: FloatArray, y: FloatArray, cell: IntArray, at: FloatArray) -> FloatArray:
    """Values at `at`, in the intervals `cell`, of the cubics through the four points around them."""
    first = np.clip(cell - 1, 0, x.size - 4)
    nodes = [x[first + n] for n in range(4)]
    weights = [np.prod([(at - b) / (a - b) for b in nodes if b is not a], axis=0) for a in nodes]
    with np.errstate(invalid="ignore"):
        return np.asarray(sum(weight[:, None] * y[first + n] for n, weight in enumerate(weights)))
