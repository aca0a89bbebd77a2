"""Closed outlines of axisymmetric bodies: straight lines and circular arcs in the (r, z) half-plane."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve
from meshes.geometry.segment import Segment

if TYPE_CHECKING:
    from skfem import MeshTri

    from meshes.arrays import BoolArray, FloatArray


@dataclass(frozen=True)
class Outline:
    """Closed outline of one body, counter-clockwise, each segment starting where the one before ends.

    Parameters
    ----------
    name : str
        Name of the body ("closure", "seat"), with which the names of its segments begin.
    segments : tuple of Segment
    label : str, optional
        What errors and sentences call the body, such as "lower flange"; its name unless given.

    Examples
    --------
    >>> import meshes
    >>> outline = meshes.Ball(0.02).outline
    >>> print(f"{outline.area * 1e6:.1f} mm^2")
    628.3 mm^2
    """

    name: str
    segments: tuple[Segment, ...]
    label: str = field(default="", kw_only=True, compare=False)

    def __post_init__(self) -> None:
        if not self.label:
            # set during construction, before the outline is shared
            object.__setattr__(self, "label", self.name)

    @property
    def ready_mesh(self) -> MeshTri | None:
        """The mesh of a body that comes as one [m]; None for a drawn outline."""
        return None

    def halved(self) -> Outline:
        """The outline as it is; one that comes as a mesh has every triangle cut into four."""
        return self

    @property
    def area(self) -> float:
        """Exact area of the section in the (r, z) half-plane [m^2], arcs included (Green's theorem)."""
        return sum(_chord_area(s) + _bulge_area(s) for s in self.segments)

    @property
    def face(self) -> Curve:
        """The surface on which contact can happen, run from smaller to larger radius.

        It is made of the segments named "<body>_face", and "<body>_chamber" between them.

        Raises
        ------
        GeometryError
            If there is no such segment, or they are not one chain.
        """
        at = self._of_face
        if not at:
            raise GeometryError(f'{self.name} outline: no piece has the name "face"')
        others = [self.segments[n] for n in range(at[0], at[-1]) if n not in at]
        if others:
            ends = [
                f"({mm(s.start[0])}, {mm(s.start[1])}) to ({mm(s.end[0])}, {mm(s.end[1])})" for s in others
            ]
            more = f" and {len(ends) - 2} more" if len(ends) > 2 else ""
            raise GeometryError(
                f"{self.name} outline: {', '.join(ends[:2])}{more} in (r, z) lie between pieces of the face and are no "
                'part of it; give them the name "face", as the flanks of a land, or "chamber", as what is between lands'
            )
        face = Curve(self.segments[at[0] : at[-1] + 1])
        # Counter-clockwise, the lower side of the closure runs outwards and the upper side of the seat inwards.
        return face if face.segments[0].start[0] < face.segments[-1].end[0] else face.reversed

    @property
    def _of_face(self) -> list[int]:
        names = (f"{self.name}_face", f"{self.name}_chamber")
        return [n for n, s in enumerate(self.segments) if s.name in names]

    def with_face(self, pieces: tuple[Segment, ...]) -> Outline:
        """The outline with its face replaced by `pieces`, which run from smaller to larger radius."""
        at = self._of_face
        before, after = self.segments[: at[0]], self.segments[at[-1] + 1 :]
        outwards = self.segments[at[0]].start[0] < self.segments[at[-1]].end[0]
        if not outwards:
            pieces = tuple(s.reversed for s in reversed(pieces))
        # The very corners of the outline: a rounded-off copy of them would leave it open.
        first = replace(pieces[0], start=self.segments[at[0]].start)
        last = replace(pieces[-1], end=self.segments[at[-1]].end)
        inner = (first, *pieces[1:-1], last) if len(pieces) > 1 else (replace(first, end=last.end),)
        return Outline(self.name, (*before, *inner, *after), label=self.label)

    def shifted(self, dz: float) -> Outline:
        """The outline moved by dz [m] along the axis."""
        return replace(self, segments=tuple(s.shifted(dz) for s in self.segments))

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Smallest and largest r and z [m], arcs included."""
        r, z = zip(*(p for s in self.segments for p in s.corners), strict=True)
        return (min(r), max(r)), (min(z), max(z))

    def holds(self, points: FloatArray) -> BoolArray:
        """Which of some points (r, z) [m], shape (2, n), lie inside, arcs being followed by chords."""
        along = [Curve((s,)) for s in self.segments]
        corners = np.hstack([one.point(np.linspace(0.0, one.length, 33)[:-1]) for one in along])
        (r, z), (next_r, next_z) = corners[..., None], np.roll(corners, -1, axis=1)[..., None]
        # a ray outwards leaves more often than it enters
        with np.errstate(divide="ignore", invalid="ignore"):
            passes = points[0] < r + (points[1] - z) / (next_z - z) * (next_r - r)
        return np.asarray(np.sum(((z > points[1]) != (next_z > points[1])) & passes, axis=0) % 2 == 1)

    @property
    def largest_radius(self) -> float:
        """Largest distance of the segments' end points from the axis [m]."""
        return max(s.start[0] for s in self.segments)

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
    return 0.5 * math.dist(s.start, s.centre) ** 2 * (s.sweep - math.sin(s.sweep))
