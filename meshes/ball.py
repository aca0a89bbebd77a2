"""A ball as closure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from meshes.errors import GeometryError
from meshes.outline import Outline, Point, Segment

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Ball:
    """Solid ball of radius `radius` [m].

    Raises
    ------
    GeometryError
        If the radius is not positive and finite.
    """

    radius: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.radius) and self.radius > 0):
            raise GeometryError(f"closure radius = {self.radius!r} m: must be positive and finite")

    def outline(self, centre_z: float, polar: FloatArray) -> Outline:
        """Half-disc whose arc carries the given vertices of the contact line.

        Parameters
        ----------
        centre_z : float
            Height of the centre [m].
        polar : ndarray
            Angles of the contact line's vertices from the downward axis [rad], increasing.
        """
        R, centre = self.radius, (0.0, centre_z)

        def at(angle: float) -> Point:
            return R * math.sin(angle), centre_z - R * math.cos(angle)

        bottom, top = (0.0, centre_z - R), (0.0, centre_z + R)
        line = [at(angle) for angle in polar.tolist()]
        # The closing force acts on the upper part, so that it does not bend the surface near the contact.
        middle = at(0.5 * (float(polar[-1]) + math.pi))
        return Outline(
            "closure",
            (
                Segment(bottom, line[0], "closure_inner", centre),
                *(Segment(a, b, "closure_contact", centre) for a, b in pairwise(line)),
                Segment(line[-1], middle, "closure_outer", centre),
                Segment(middle, top, "closure_top", centre),
                Segment(top, bottom, "closure_axis"),
            ),
        )
