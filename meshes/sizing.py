"""Element sizes: fine along the contact line around first touch, growing along it and faster into the depth."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from meshes.errors import GeometryError

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Sizing:
    """Element size as a function of place.

    size = contact_size + growth_along max(0, abs(x) - core) + growth_deep abs(y), at most far_size, where x runs
    along the common tangent and y along the common normal from first touch. What happens at depth y varies over
    a length of the order of y, so the elements may grow with it without loss.

    Parameters
    ----------
    contact_size : float
        Element size at first touch [m].
    core : float
        Distance along the contact line over which `contact_size` is kept [m].
    zone : tuple of float
        Ends (x_start, x_end) of the zone in which contact is looked for, arc length from first touch [m].
    growth_along, growth_deep : float
        Growth of the element size per distance along the contact line and into the depth.
    far_size : float
        Largest element size [m].

    Raises
    ------
    GeometryError
        If a size is not positive or the zone does not enclose first touch.
    """

    contact_size: float
    core: float
    zone: tuple[float, float]
    growth_along: float
    growth_deep: float
    far_size: float

    def __post_init__(self) -> None:
        for key in ("contact_size", "growth_along", "growth_deep", "far_size"):
            value = getattr(self, key)
            if not (math.isfinite(value) and value > 0):
                raise GeometryError(f"mesh {key} = {value!r}: must be positive and finite")
        if not self.zone[0] < 0 < self.zone[1]:
            raise GeometryError(f"mesh zone = {self.zone!r} m: must start below and end above zero")
        if self.contact_size > self.far_size:
            raise GeometryError(
                f"mesh contact_size = {self.contact_size:.4g} m: must not exceed far_size = {self.far_size:.4g} m"
            )

    @property
    def contact_vertices(self) -> FloatArray:
        """Arc lengths of the contact line's vertices [m], zero among them, the same for both bodies.

        Each side is divided evenly in int dx / size(x), so that no element is larger than asked for.
        """
        start, end = self.zone
        return np.concatenate([-self._side(-start)[:0:-1], self._side(end)])

    def _side(self, length: float) -> FloatArray:
        h, g, core = self.contact_size, self.growth_along, min(self.core, length)
        count = core / h + math.log1p(g * (length - core) / h) / g
        n = np.linspace(0.0, count, math.ceil(count * (1 - 1e-12)) + 1)
        x = np.where(n * h <= core, n * h, core + h / g * np.expm1(g * np.maximum(n - core / h, 0.0)))
        x[-1] = length
        return x

    def refined(self, factor: float) -> Sizing:
        """Same grading with every element size divided by `factor`; below 1 it coarsens."""
        return replace(
            self,
            contact_size=self.contact_size / factor,
            growth_along=self.growth_along / factor,
            growth_deep=self.growth_deep / factor,
            far_size=self.far_size / factor,
        )
