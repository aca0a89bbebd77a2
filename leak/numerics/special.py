"""The error function of few numbers and of many."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray

# Up to so many the C library is as fast; importing scipy.special takes as long as reading a whole case.
_FEW = 128


def erf(x: ArrayLike) -> FloatArray:
    """The error function of each number.

    Parameters
    ----------
    x : array_like
        [-]

    Returns
    -------
    ndarray
        Of the same shape.

    Examples
    --------
    >>> from leak.numerics.special import erf
    >>> erf([0.0, 0.5]).round(6).tolist()
    [0.0, 0.5205]
    """
    numbers = np.asarray(x, dtype=float)
    if numbers.size > _FEW:
        from scipy.special import erf as erf_of_many

        many: FloatArray = erf_of_many(numbers)
        return many
    few: FloatArray = np.array([math.erf(one) for one in numbers.ravel().tolist()]).reshape(numbers.shape)[()]
    return few
