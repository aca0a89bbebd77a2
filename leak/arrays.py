"""Types and checks of arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def different(values: FloatArray) -> FloatArray:
    """Finite numbers in increasing order, each once: numpy.unique loads numpy.ma, which takes longer than all its work.

    Parameters
    ----------
    values : ndarray
        Of one dimension.

    Examples
    --------
    >>> different(np.array([2.0, 1.0, 2.0])).tolist()
    [1.0, 2.0]
    """
    increasing = np.sort(values)
    return increasing[np.diff(increasing, prepend=-np.inf) > 0]


def as_arrays(error: type[ValueError], must: str, *values: ArrayLike) -> list[FloatArray]:
    """Arrays of numbers, or `error` with what the values must be and why one of them is not."""
    try:
        return [np.asarray(one, dtype=float) for one in values]
    except (TypeError, ValueError) as reason:
        raise error(f"{must}: {reason}") from None


def check_each(error: type[ValueError], name: str, values: FloatArray, right: BoolArray, must: str) -> None:
    """Raise `error` with the first of several values that is not right, "p[3] = -1.0: must not be negative [Pa]"."""
    wrong = (~right).nonzero()[0]
    if wrong.size:
        raise error(f"{name}[{wrong[0]}] = {values[wrong[0]]}: {must}")


def check_order(
    error: type[ValueError], name: str, values: FloatArray, must: str, *, equal: bool = False
) -> None:
    """Raise `error` with the first of several values that is below the one before, or as large unless it may be."""
    before, after = values[:-1], values[1:]
    back = (after < before if equal else after <= before).nonzero()[0]
    if back.size:
        i = int(back[0])
        raise error(f"{name}[{i + 1}] = {values[i + 1]} follows {values[i]}: {must}")
