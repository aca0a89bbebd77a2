"""Element sizes: fine along the contact line around first touch, growing along it and faster into the depth."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshes.arrays import FloatArray
from meshes.errors import GeometryError, MeshingError, mm

# Far more than any contact that can be solved.
_MOST = 100_000


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
    spots : tuple of (float, float)
        Further places on the contact line, such as rounded edges: arc length from first touch and the element size
        there [m]; the size grows from them along the contact line and into the depth as it does from first touch.

    Raises
    ------
    GeometryError
        If a size is not positive or the zone does not enclose first touch.

    Examples
    --------
    >>> import meshes
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> sizing.refined(2.0).contact_size
    1e-05
    """

    contact_size: float
    core: float
    zone: tuple[float, float]
    growth_along: float
    growth_deep: float
    far_size: float
    spots: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        for key in ("contact_size", "growth_along", "growth_deep", "far_size"):
            value = getattr(self, key)
            if not (math.isfinite(value) and value > 0):
                raise GeometryError(f"mesh {key} = {mm(value)}: must be positive and finite")
        if not self.zone[0] < 0 < self.zone[1]:
            raise GeometryError(
                f"mesh zone = {mm(self.zone[0])} to {mm(self.zone[1])}: must start below and end above zero"
            )
        if self.contact_size > self.far_size:
            raise GeometryError(
                f"mesh contact_size = {mm(self.contact_size)}: must not exceed far_size = {mm(self.far_size)}"
            )

    def contact_vertices(self, breaks: FloatArray | None = None) -> FloatArray:
        """Arc lengths of the contact line's vertices [m], zero among them, the same for both bodies.

        Each stretch is divided evenly in int dx / size(x), so that no element is larger than asked for.

        Parameters
        ----------
        breaks : ndarray, optional
            More places that must be vertices [m]; those outside the zone are left out.
        """
        start, end = self.zone
        fixed = np.array([start, 0.0, end])
        if breaks is not None:
            # A break closer to a vertex than half an element would leave a sliver.
            near = np.min(np.abs(np.subtract.outer(breaks, fixed)), axis=1, initial=np.inf)
            inside = (breaks > start) & (breaks < end) & (near > 0.5 * self.size(breaks))
            fixed = np.unique(np.concatenate([fixed, breaks[inside]]))
        return np.concatenate([[start], *(self._divided(a, b) for a, b in pairwise(fixed.tolist()))])

    def size(self, x: FloatArray) -> FloatArray:
        """Element size on the contact line at x [m]."""
        x = np.asarray(x, dtype=float)
        size = self.contact_size + self.growth_along * np.maximum(0.0, np.abs(x) - self.core)
        for place, smallest in self.spots:
            size = np.minimum(size, smallest + self.growth_along * np.abs(x - place))
        return np.minimum(size, self.far_size)

    def _divided(self, a: float, b: float) -> FloatArray:
        """Vertices in (a, b], b the last."""
        # Away from the small elements the size grows in proportion to the distance: so do the steps.
        steps = np.concatenate([[0.0], np.geomspace(1e-3, 1e3, 600)])
        centres = [(-self.core, self.contact_size), (self.core, self.contact_size), *self.spots]
        near = [
            place + side * size / self.growth_along * steps for place, size in centres for side in (-1, 1)
        ]
        x = np.unique(np.clip(np.concatenate([np.linspace(a, b, 401), *near]), a, b))
        middle = 0.5 * (x[1:] + x[:-1])
        density, between = 1 / self.size(x), 1 / self.size(middle)
        count = np.concatenate(
            [[0.0], np.cumsum(np.diff(x) * (density[:-1] + 4 * between + density[1:]) / 6)]
        )
        elements = max(1, math.ceil(count[-1] * (1 - 1e-9)))
        if elements > _MOST:
            raise MeshingError(
                f"the contact line would need more than {_MOST} elements; use a larger contact size or edge radius"
            )
        inner = np.interp(np.arange(1, elements) * count[-1] / elements, count, x)
        return np.append(inner, b)

    def rounded(self, fixed: Collection[float], *, exact_size: bool = False) -> Sizing:
        """The same with three digits, so that round-off of the input, such as other units, leaves the mesh as it is.

        Parameters
        ----------
        fixed : collection of float
            Places on the contact line that stay, such as edges and ends of the faces: arc lengths [m].
        exact_size : bool
            Whether `contact_size` is given by somebody and stays.
        """
        spots = {
            (place if place in fixed else _three(size) * round(place / _three(size)), _three(size))
            for place, size in self.spots
        }
        start, end = (x if x in fixed else _three(x) for x in self.zone)
        return replace(
            self,
            contact_size=self.contact_size if exact_size else min(_three(self.contact_size), self.far_size),
            core=_three(self.core),
            zone=(max(start, min(fixed, default=start)), min(end, max(fixed, default=end))),
            growth_along=_three(self.growth_along),
            growth_deep=_three(self.growth_deep),
            spots=tuple(sorted(spots)),
        )

    def refined(self, factor: float) -> Sizing:
        """Same grading with every element size divided by `factor`; below 1 it coarsens."""
        return replace(
            self,
            contact_size=self.contact_size / factor,
            growth_along=self.growth_along / factor,
            growth_deep=self.growth_deep / factor,
            far_size=self.far_size / factor,
            spots=tuple((x, size / factor) for x, size in self.spots),
        )


def _three(size: float) -> float:
    """A number with three significant digits."""
    return float(f"{size:.2e}")
