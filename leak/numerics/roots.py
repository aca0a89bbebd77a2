"""Roots of functions of one number."""

from __future__ import annotations

from collections.abc import Callable

_MOST_STEPS = 100


def root_of_rising(
    function: Callable[[float], float], low: float, high: float, tolerance: float = 1e-14
) -> float:
    """Root of a rising function between two ends, or the end next to it.

    The Illinois method: straight lines through both ends of a bracket, the value at an end that stays being halved.

    Parameters
    ----------
    function : callable
        Rising.
    low, high : float
        Ends, low < high.
    tolerance : float
        Of the place.

    References
    ----------
    M. Dowell, P. Jarratt, BIT 11, 168 (1971).

    Examples
    --------
    >>> round(root_of_rising(lambda x: x**3 - 2.0, 0.0, 4.0), 12)
    1.259921049895
    """
    at_low, at_high = function(low), function(high)
    if at_low >= 0.0:
        return low
    if at_high <= 0.0:
        return high
    stayed, before = 0, low
    for _ in range(_MOST_STEPS):
        middle = high - at_high * (high - low) / (at_high - at_low)
        if not low < middle < high:
            return min(max(middle, low), high)
        value = function(middle)
        if value == 0.0 or abs(middle - before) <= tolerance:
            return middle
        before = middle
        if value > 0.0:
            high, at_high = middle, value
            at_low *= 0.5 if stayed > 0 else 1.0
            stayed = 1
        else:
            low, at_low = middle, value
            at_high *= 0.5 if stayed < 0 else 1.0
            stayed = -1
    return before
