"""Roots of functions of one number."""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np

from leak.arrays import BoolArray, FloatArray

# An iteration that has not ended by then has no solution: those that have one need a tenth.
MOST_STEPS = 200
ROUND_OFF = 4.0 * sys.float_info.epsilon


def root_of_rising(
    function: Callable[[float], float], low: float, high: float, start: float, tolerance: float = 1e-14
) -> float:
    """Root of a rising function between two ends, or the end next to it.

    From the start in ever longer steps until there is a root between two of them, then by straight lines through the
    last two places; by halving where these lead out of the bracket, or steps do not become half as long by twos.

    Parameters
    ----------
    function : callable
        Rising.
    low, high : float
        Ends, low < high.
    start : float
        Between them, some units from where the root may be.
    tolerance : float
        Of the place.

    References
    ----------
    R. P. Brent, Comput. J. 14, 422 (1971), without the parabola.

    Examples
    --------
    >>> round(root_of_rising(lambda x: x**3 - 2.0, 0.0, 4.0, 3.0), 12)
    1.259921049895
    """
    x_before = last = start
    at_before = at_last = function(start)
    step = 1.0 if at_last < 0.0 else -1.0
    while at_before * at_last > 0.0 or x_before == last:
        if at_last == 0.0 or last == (high if step > 0.0 else low):
            return last
        x_before, at_before = last, at_last
        last = min(max(last + step, low), high)
        at_last, step = function(last), 4.0 * step
    left, right = min(x_before, last), max(x_before, last)
    longest = previous = 2.0 * (right - left)
    for _ in range(MOST_STEPS):
        if at_last > 0.0:
            right = last
        else:
            left = last
        rise = at_last - at_before
        trial = last - at_last * (last - x_before) / rise if rise else left
        if not left < trial < right or abs(trial - last) > 0.5 * longest:
            trial = 0.5 * (left + right)
        if at_last == 0.0 or abs(trial - last) <= tolerance:
            return trial if at_last else last
        longest, previous = previous, abs(trial - last)
        x_before, at_before = last, at_last
        last, at_last = trial, function(trial)
    return last


def bisect_roots(
    is_below: Callable[[FloatArray], BoolArray], low: FloatArray, high: FloatArray, halvings: int = 60
) -> tuple[FloatArray, FloatArray]:
    """Ends between which each of many functions changes, `halvings` times as close as two others.

    Parameters
    ----------
    is_below : callable
        Of places: true where the change is above them.
    low, high : ndarray
        Ends to begin with.
    halvings : int

    Examples
    --------
    >>> low, high = bisect_roots(lambda x: x**2 < 2.0, np.zeros(1), np.ones(1) * 2.0)
    >>> (0.5 * (low + high)).round(9).tolist()
    [1.414213562]
    """
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        is_low = is_below(middle)
        low, high = np.where(is_low, middle, low), np.where(is_low, high, middle)
    return low, high


def newton_between(
    function: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    start: FloatArray,
    low: FloatArray,
    high: FloatArray,
    close: float,
) -> FloatArray:
    """Roots of many rising functions, each between two ends, by Newton's method; steps beyond the ends are halvings.

    Parameters
    ----------
    function : callable
        Values and slopes, of the shape of `start`.
    start, low, high : ndarray
        First guesses and ends.
    close : float
        The last step is no longer.
    """
    x = start
    for _ in range(MOST_STEPS):
        value, slope = function(x)
        low, high = np.where(value < 0.0, x, low), np.where(value < 0.0, high, x)
        newton = x - value / slope
        trial = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
        move, x = np.max(np.abs(trial - x), initial=0.0), trial
        if move <= close:
            break
    return x


def root_between(
    function: Callable[[float], float],
    low: float,
    high: float,
    *,
    xtol: float = 2e-12,
    rtol: float = ROUND_OFF,
) -> float:
    """Root of a function that has other signs at two ends, by Brent's method; nothing holds the function afterwards.

    What scipy wraps around it holds itself, and so all that the function knows, until the garbage collector comes.

    Parameters
    ----------
    function : callable
    low, high : float
    xtol, rtol : float
        See `scipy.optimize.brentq`.

    Examples
    --------
    >>> round(root_between(lambda x: x**3 - 2.0, 0.0, 4.0), 9)
    1.25992105
    """
    from scipy.optimize import brentq

    functions = [function]
    try:
        return float(brentq(lambda x: functions[0](x), low, high, xtol=xtol, rtol=rtol))
    finally:
        functions.clear()
