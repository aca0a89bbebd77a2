"""The lasting imprint that a contact leaves in a face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_seal.arrays import FloatArray


@dataclass(frozen=True)
class Imprint:
    """Permanent normal displacement of a contact face after unloading.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Arc length from first touch [m], increasing.
    depth : ndarray, shape (n,)
        How far the face has moved into its body along its normal [m], negative where it is raised.
    """

    x: FloatArray
    depth: FloatArray

    @property
    def deepest(self) -> float:
        """Greatest depth [m]; zero if the face is raised everywhere or nothing yielded."""
        return max(float(self.depth.max()), 0.0)

    @property
    def deepest_at(self) -> float:
        """Arc length of the greatest depth [m]."""
        return float(self.x[np.argmax(self.depth)])

    @property
    def rim(self) -> float:
        """Height of the rim that has been pushed up beside the imprint [m], not negative."""
        return max(-float(self.depth.min()), 0.0)

    @property
    def width(self) -> float:
        """Width at half the greatest depth [m]; zero if there is no imprint."""
        if self.deepest == 0.0:
            return 0.0
        above = self.depth - 0.5 * self.deepest
        inside = np.flatnonzero(above >= 0)
        return self._crossing(above, inside[-1], +1) - self._crossing(above, inside[0], -1)

    def _crossing(self, above: FloatArray, inside: int, step: int) -> float:
        outside = inside + step
        if not 0 <= outside < len(self.x):
            return float(self.x[inside])
        a, b = above[inside], above[outside]
        return float(self.x[inside] + (self.x[outside] - self.x[inside]) * a / (a - b))
