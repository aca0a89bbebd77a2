"""Types of arrays for annotations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
