"""A surface in contact, of triangles: its edges, the closed lines of its boundary, where fluid stands, finer ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.errors import ProfileError, as_arrays, check_each
from leak.flow.contact_profile import checked_side

# Area of a triangle over the square of its longest side, and distance of two places over the size of the surface.
_NOTHING = 1e-9
# Points of parts that are eliminated as a whole.
_WHOLE = 30


class Edges(NamedTuple):
    """Edges of the triangles.

    Examples
    --------
    >>> ContactSurface([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).edges.ends.tolist()
    [[0, 1], [0, 2], [1, 2]]
    """

    ends: IntArray
    """Points, the lower number first, shape (e, 2)."""
    of_triangle: IntArray
    """Edges opposite to the corners, shape (t, 3)."""
    on_boundary: BoolArray
    """Whether an edge belongs to one triangle only, shape (e,)."""


@dataclass(frozen=True, eq=False)
class ContactSurface:
    """A surface in contact, of flat triangles; what several steps of a load share is calculated once.

    Parameters
    ----------
    points : array_like
        Shape (n, 3), or (n, 2) in a plane [m]. Points of no triangle are left out.
    triangles : array_like
        Numbers of their corners, in any direction around, shape (t, 3).

    Raises
    ------
    ProfileError
        The points lie on a line, a triangle has no area, an edge belongs to three triangles, two points of the boundary
        lie at the same place (a crack), or the numbers cannot be used.

    Examples
    --------
    >>> square = ContactSurface([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]])
    >>> float(square.areas.sum()), [loop.tolist() for loop in square.loops]
    (1.0, [[0, 1, 2, 3]])
    """

    points: FloatArray
    triangles: IntArray

    def __post_init__(self) -> None:
        (points,) = as_arrays(ProfileError, "points must be numbers", self.points)
        corners = np.asarray(self.triangles)
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            raise ProfileError(f"points has shape {points.shape}: must be (n, 3), or (n, 2) in a plane [m]")
        if corners.ndim != 2 or corners.shape[1] != 3 or not corners.size or corners.dtype.kind not in "iu":
            raise ProfileError(f"triangles has shape {corners.shape}: must be (t, 3) numbers of points")
        if corners.min() < 0 or corners.max() >= len(points):
            raise ProfileError(f"triangles: must be numbers of points from 0 to {len(points) - 1}")
        finite = np.isfinite(points).all(axis=1) | ~mask_of(corners, len(points))
        check_each(ProfileError, "points", points, finite, "must be finite [m]")
        points = np.column_stack([points, np.zeros(len(points))])[:, :3]
        # fields of a frozen class, as the methods expect them
        vars(self).update(points=points, triangles=corners.astype(np.int64))
        self._check_shape()

    def _check_shape(self) -> None:
        ends, of_triangle, on_boundary = self.edges
        is_flat = self.areas <= _NOTHING * self.lengths[of_triangle].max(axis=1) ** 2
        if is_flat.all():
            raise ProfileError(
                "points: all lie on a line; a surface is needed, or the functions of a profile"
            )
        if is_flat.any():
            at = int(np.argmax(is_flat))
            raise ProfileError(f"triangles[{at}] = {self.triangles[at].tolist()}: has no area")
        uses = np.bincount(of_triangle.ravel())
        if uses.max() > 2:
            i, j = ends[np.argmax(uses)]
            raise ProfileError(
                f"triangles: {uses.max()} share the edge between points {i} and {j}; at most 2 can"
            )
        rim = np.unique(ends[on_boundary])
        if not rim.size:
            return
        places = np.round(
            self.points[rim] / (_NOTHING * np.ptp(self.points[self.triangles], axis=(0, 1)).max())
        )
        order = np.lexsort(places.T)
        same = (np.diff(places[order], axis=0) == 0.0).all(axis=1)
        if same.any():
            i, j = sorted(rim[order[np.argmax(same) : np.argmax(same) + 2]])
            raise ProfileError(
                f"points {i} and {j} lie at the same place and belong to different triangles: nothing flows across "
                f"such a crack ({same.sum()} pairs of points); give them one number"
            )

    @cached_property
    def edges(self) -> Edges:
        """Edges of the triangles."""
        n = len(self.points)
        pairs = np.sort(self.triangles[:, [[1, 2], [2, 0], [0, 1]]], axis=2)
        codes, places, uses = np.unique(
            pairs[..., 0] * n + pairs[..., 1], return_inverse=True, return_counts=True
        )
        return Edges(np.column_stack(np.divmod(codes, n)), places.reshape(-1, 3), uses == 1)

    @cached_property
    def lengths(self) -> FloatArray:
        """Of the edges, shape (e,) [m]."""
        i, j = self.edges.ends.T
        return np.asarray(np.linalg.norm(self.points[j] - self.points[i], axis=1))

    @cached_property
    def normals(self) -> FloatArray:
        """Of the triangles, as long as their area, shape (t, 3) [m^2]."""
        first, second, third = self.points[self.triangles].swapaxes(0, 1)
        return 0.5 * np.cross(second - first, third - first)

    @cached_property
    def areas(self) -> FloatArray:
        """Of the triangles, shape (t,) [m^2]."""
        return np.asarray(np.linalg.norm(self.normals, axis=1))

    @cached_property
    def slopes(self) -> FloatArray:
        """Gradient in each triangle of what is one at a corner and zero at the others, shape (t, 3, 3) [1/m]."""
        places = self.points[self.triangles]
        opposite = np.roll(places, 1, axis=1) - np.roll(places, -1, axis=1)
        return np.cross(self.normals[:, None], opposite) / (2.0 * self.areas**2)[:, None, None]

    @cached_property
    def loops(self) -> tuple[IntArray, ...]:
        """Points along each closed line of the boundary, the longest line first."""
        ways: dict[int, list[int]] = {}
        for i, j in self.edges.ends[self.edges.on_boundary].tolist():
            ways.setdefault(i, []).append(j)
            ways.setdefault(j, []).append(i)
        found = []
        for start in sorted(ways):
            loop = [start]
            while ways[loop[-1]]:
                point = ways[loop[-1]].pop(0)
                ways[point].remove(loop[-1])
                loop.append(point)
            if len(loop) > 1:
                found.append(np.array(loop[:-1]))
        return tuple(sorted(found, key=self._length, reverse=True))

    def _length(self, loop: IntArray) -> float:
        return float(np.linalg.norm(self.points[np.roll(loop, -1)] - self.points[loop], axis=1).sum())

    @cached_property
    def order(self) -> IntArray:
        """Points as they are eliminated with little fill: halves of the surface before the line that parts them.

        Nested dissection (A. George, SIAM J. Numer. Anal. 10, 345 (1973)) across the longest extents.
        """
        points, ends, n = self.points, self.edges.ends, len(self.points)
        levels = max(math.ceil(math.log2(n / _WHOLE)), 0)
        part, level = np.zeros(n, dtype=np.int64), np.full(n, levels)
        for at in range(levels):
            inner = np.flatnonzero(level == levels)
            inner = inner[np.argsort(part[inner], kind="stable")]
            first = np.flatnonzero(np.diff(part[inner], prepend=-1))
            extent = np.maximum.reduceat(points[inner], first) - np.minimum.reduceat(points[inner], first)
            count = np.diff(first, append=inner.size)
            group = np.repeat(np.arange(first.size), count)
            inner = inner[np.lexsort((points[inner, extent.argmax(axis=1)[group]], group))]
            half = np.full(n, -1)
            half[inner] = 2 * part[inner] + (2 * (np.arange(inner.size) - first[group]) >= count[group])
            a, b = half[ends].T
            cut = (a >= 0) & (b >= 0) & (a != b)
            line = np.where(a[cut] < b[cut], *ends[cut].T)
            half[line], level[line] = -1, at
            part = np.where(half >= 0, half, part)
        return np.lexsort((-level, (part + 1) << (levels - level)))

    def open_edges(self, side: BoolArray) -> IntArray:
        """Numbers of the edges of the boundary between two points of a side.

        Parameters
        ----------
        side : ndarray, shape (n,)
            Mask of points.
        """
        return np.flatnonzero(self.edges.on_boundary & side[self.edges.ends].all(axis=1))

    def sides(
        self, high: ArrayLike | None = None, low: ArrayLike | None = None, pressure_side: str = "outer"
    ) -> tuple[BoolArray, BoolArray]:
        """Points of the boundary at which the high and the low fluid pressure stand.

        Parameters
        ----------
        high, low : array_like, optional
            Numbers of points, or a mask, shape (n,): an edge of the boundary between two of them is open to the fluid;
            all other edges of the boundary are walls. Both None: the two loops of a ring.
        pressure_side : {"outer", "inner"}
            Of a ring: whether the high pressure stands at the longer loop.

        Returns
        -------
        high, low : ndarray, shape (n,)
            Masks.

        Raises
        ------
        ProfileError
            There is no such edge, both share a point, or the surface is no ring.

        Examples
        --------
        >>> square = ContactSurface([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]])
        >>> [np.flatnonzero(side).tolist() for side in square.sides(high=[0, 1], low=[2, 3])]
        [[0, 1], [2, 3]]
        """
        if high is None and low is None:
            checked_side(pressure_side)
            lengths = [self._length(loop) for loop in self.loops]
            if len(lengths) != 2 or lengths[1] > (1.0 - 1e-6) * lengths[0]:
                raise ProfileError(
                    f"the boundary of the surface has {len(lengths)} closed lines, and only the longer and the shorter "
                    "one of a ring tell where fluid stands: give high and low, points of the boundary"
                )
            high, low = self.loops if pressure_side == "outer" else self.loops[::-1]
        sides = self._side("high", high), self._side("low", low)
        if (sides[0] & sides[1]).any():
            at = int(np.argmax(sides[0] & sides[1]))
            raise ProfileError(f"point {at} belongs to high and to low: there fluid flows past the contact")
        return sides

    def _side(self, name: str, given: ArrayLike | None) -> BoolArray:
        n, values = len(self.points), np.asarray(() if given is None else given)
        values = values if values.size else values.astype(np.int64)
        is_mask = values.dtype == bool and values.shape == (n,)
        if not is_mask and (values.dtype.kind not in "iu" or not ((values >= 0) & (values < n)).all()):
            raise ProfileError(
                f"{name}: must be numbers of points from 0 to {n - 1}, or a mask of shape ({n},)"
            )
        edges = self.open_edges(values if is_mask else mask_of(values, n))
        if not edges.size:
            raise ProfileError(f"{name}: no two of its points are neighbours on the boundary of the surface")
        return mask_of(self.edges.ends[edges], n)

    def refined(self, chosen: IntArray) -> tuple[ContactSurface, IntArray, IntArray, FloatArray]:
        """With triangles cut in four, and those around them in two or three, always across the longest side (Rivara).

        Parameters
        ----------
        chosen : ndarray
            Numbers of the triangles.

        Returns
        -------
        surface, halved, parent, weights
            The points are followed by the middles of the halved edges, shape (k,); each new triangle lies in a parent,
            shape (t,), of whose corners its corners have such weights, shape (t, 3, 3).
        """
        ends, of_triangle, _ = self.edges
        cut = mask_of(of_triangle[chosen], len(ends))
        longest = self.lengths[of_triangle].argmax(axis=1)
        at_longest = of_triangle[np.arange(len(longest)), longest]
        while (missing := cut[of_triangle].any(axis=1) & ~cut[at_longest]).any():
            cut[at_longest[missing]] = True
        number = np.where(cut, len(self.points) + np.cumsum(cut) - 1, -1)
        turn = (longest[:, None] + np.arange(3)) % 3
        corners, middles = (
            np.take_along_axis(values, turn, axis=1) for values in (self.triangles, number[of_triangle])
        )
        triangles, parent, weights = _bisected(corners, middles, np.arange(len(turn)), np.eye(3)[turn])
        points = np.concatenate([self.points, self.points[ends[cut]].mean(axis=1)])
        return ContactSurface(points, triangles), np.flatnonzero(cut), parent, weights


def _bisected(
    corners: IntArray, middles: IntArray, parent: IntArray, weights: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Triangles cut from the first corner to the middle of the opposite edge, over and over; -1: no middle."""
    cut = middles[:, 0] >= 0
    if not cut.any():
        return corners, parent, weights
    kept = corners[~cut], parent[~cut], weights[~cut]
    corners, middles, parent, weights = corners[cut], middles[cut], parent[cut], weights[cut]
    none, half = np.full(len(parent), -1), weights[:, 1:].mean(axis=1)
    halves = (
        _bisected(
            np.column_stack([middles[:, 0], corners[:, i], corners[:, j]]),
            np.column_stack([middles[:, opposite], none, none]),
            parent,
            np.stack([half, weights[:, i], weights[:, j]], axis=1),
        )
        for i, j, opposite in ((0, 1, 2), (2, 0, 1))
    )
    first, second, third = zip(kept, *halves, strict=True)
    return np.concatenate(first), np.concatenate(second), np.concatenate(third)


def mask_of(numbers: ArrayLike, size: int) -> BoolArray:
    """Which of so many numbers are among those given.

    Parameters
    ----------
    numbers : array_like
    size : int

    Examples
    --------
    >>> mask_of([0, 2], 3).tolist()
    [True, False, True]
    """
    mask = np.zeros(size, dtype=bool)
    mask[np.asarray(numbers, dtype=np.int64)] = True
    return mask
