"""One straight line or circular arc of an outline, and circles as such pieces."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshes.arrays import FloatArray

Point = tuple[float, float]


def as_point(p: FloatArray) -> Point:
    """A point out of an array."""
    return float(p[0]), float(p[1])


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

    Examples
    --------
    >>> import meshes
    >>> arc = meshes.Segment((0.0, -0.02), (0.02, 0.0), "closure_face", centre=(0.0, 0.0))
    >>> arc.centre is None
    False
    """

    start: Point
    end: Point
    name: str
    centre: Point | None = None

    @property
    def sweep(self) -> float:
        """Angle by which an arc turns [rad], positive counter-clockwise; zero for a line."""
        if self.centre is None:
            return 0.0
        a, b = np.subtract(self.start, self.centre), np.subtract(self.end, self.centre)
        return math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))

    @property
    def corners(self) -> list[Point]:
        """Ends, and places inside an arc where it runs along r or z: its extent is theirs."""
        if self.centre is None:
            return [self.start, self.end]
        c, radius = self.centre, math.dist(self.start, self.centre)
        a, b = np.subtract(self.start, c), np.subtract(self.end, c)
        compass = ((1, 0), (0, 1), (-1, 0), (0, -1))
        # On the arc are the directions that are no further from its middle than its ends are.
        inside = [way for way in compass if float((a + b) @ way) * radius > float((a + b) @ a)]
        return [self.start, self.end, *((c[0] + radius * r, c[1] + radius * z) for r, z in inside)]

    @property
    def length(self) -> float:
        """Arc length [m]."""
        if self.centre is None:
            return math.dist(self.start, self.end)
        return abs(self.sweep) * math.dist(self.start, self.centre)

    @property
    def reversed(self) -> Segment:
        """The same piece run from its end to its start."""
        return Segment(self.end, self.start, self.name, self.centre)

    def shifted(self, dz: float) -> Segment:
        """The segment moved by dz [m] along the axis."""

        def move(p: Point) -> Point:
            return p[0], p[1] + dz

        centre = None if self.centre is None else move(self.centre)
        return Segment(move(self.start), move(self.end), self.name, centre)


def arc_pieces(centre: Point, radius: float, start: float, sweep: float) -> list[Segment]:
    """An arc as pieces of at most a right angle.

    Parameters
    ----------
    centre : tuple of float
        [m]
    radius : float
        [m]
    start, sweep : float
        Angle of its first point from the first coordinate, and by how much it turns on [rad].
    """
    count = max(1, math.ceil(abs(sweep) / (0.5 * math.pi) - 1e-9))

    def at(n: int) -> Point:
        angle = start + sweep * n / count
        return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)

    return [Segment(at(n), at(n + 1), "", centre) for n in range(count)]
