"""Types of arrays, and how large their exponents may be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# exp of numbers up to this size, of either sign, is a floating-point number.
LARGEST_LOG = 700.0
