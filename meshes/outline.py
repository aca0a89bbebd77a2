"""Closed outlines of axisymmetric bodies: straight lines and circular arcs in the (r, z) half-plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

Point = tuple[float, float]


@dataclass(frozen=True)
class Segment:
    """One piece of an outline, from `start` to `end`, straight unless `centre` makes it an arc.

    Parameters
    ----------
    start, end : tuple of float
        End points (r, z) [m].
    name : str
        Boundary that the piece belongs to; several pieces may share one name.
    centre : tuple of float, optional
        Centre (r, z) [m] of a circular arc. The arc spans less than 180 degrees and runs the short way.
    """

    start: Point
    end: Point
    name: str
    centre: Point | None = None


@dataclass(frozen=True)
class Outline:
    """Closed outline of one body, counter-clockwise, each segment starting where the one before ends.

    Parameters
    ----------
    name : str
        Name of the body ("closure", "seat").
    segments : tuple of Segment
    """

    name: str
    segments: tuple[Segment, ...]

    @property
    def area(self) -> float:
        """Exact area of the section in the (r, z) half-plane [m^2], arcs included (Green's theorem)."""
        return sum(_chord_area(s) + _bulge_area(s) for s in self.segments)

    @property
    def height(self) -> float:
        """Extent of the segments' end points along z [m]."""
        z = [s.start[1] for s in self.segments]
        return max(z) - min(z)


def _chord_area(s: Segment) -> float:
    (r0, z0), (r1, z1) = s.start, s.end
    return 0.5 * (r0 * z1 - r1 * z0)


def _bulge_area(s: Segment) -> float:
    if s.centre is None:
        return 0.0
    a, b = np.subtract(s.start, s.centre), np.subtract(s.end, s.centre)
    sweep = math.atan2(a[0] * b[1] - a[1] * b[0], a @ b)
    return float(0.5 * (a @ a) * (sweep - math.sin(sweep)))
