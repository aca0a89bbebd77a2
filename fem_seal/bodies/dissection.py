"""Stiffness of a body condensed part by part, so that what has not changed need not be condensed again.

The elements are halved again and again (nested dissection: George, SIAM J. Numer. Anal. 10, 345 (1973)). From the
smallest parts on, each part eliminates the unknowns that no other part shares, and hands the stiffness of its boundary
to the part that it is half of; what some places feel is left to the last. A part is condensed anew only where one of
its elements has another stiffness than the elastic one: of a body that yields under its contact that is the plastic
zone, found anew each time, and nothing is assumed of the elements around it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem_seal.arrays import FloatArray

# Elements of the smallest parts: fewer are more steps in Python, more are dense matrices with many zeros.
_SMALLEST = 40


@dataclass(frozen=True, eq=False)
class _Part:
    """Some elements, or two halves, and the unknowns that are eliminated when their stiffnesses are together.

    Parameters
    ----------
    elements : ndarray of int
        All of them, those of the halves included.
    halves : tuple of int
        Numbers of the two parts; empty for the smallest.
    inner, outer : ndarray of int
        Unknowns that are eliminated and those that are handed on.
    places : tuple of ndarray of int
        Place among inner and outer of the unknowns of each element, shape (elements, shapes), held ones behind all
        others; or of what each half hands on.
    """

    elements: NDArray[np.int64]
    halves: tuple[int, ...]
    inner: NDArray[np.int64]
    outer: NDArray[np.int64]
    places: tuple[NDArray[np.int64], ...]

    def front(self, local: FloatArray) -> FloatArray:
        """Stiffness of inner and outer from that of its elements (elements, shapes, shapes), of a smallest part."""
        size, (place,) = len(self.inner) + len(self.outer) + 1, self.places
        index = place[:, :, None] * size + place[:, None, :]
        summed = np.asarray(np.bincount(index.ravel(), local.ravel(), minlength=size * size), dtype=float)
        # symmetric, and turned round in the order that LAPACK takes without a copy of each row
        return summed.reshape(size, size)[:-1, :-1].T

    def joined(self, halves: tuple[FloatArray, ...]) -> FloatArray:
        """The same from what the halves hand on."""
        size = len(self.inner) + len(self.outer)
        front = np.zeros((size, size), order="F")
        (first, second), (one, other) = self.places, halves
        front[first[:, None], first] = one
        front[second[:, None], second] += other
        return front


@dataclass(frozen=True, eq=False)
class _Eliminated:
    """A part after its elimination: L L^T of the inner stiffness, L^-1 times the coupling, and what is handed on."""

    lower: FloatArray
    coupling: FloatArray
    handed_on: FloatArray

    @classmethod
    def of(cls, front: FloatArray, inner: int) -> _Eliminated:
        from scipy.linalg.lapack import dtrtrs

        lower = _cholesky(front[:inner, :inner])
        coupling = front[:inner, inner:]
        if inner and coupling.size:
            coupling, _ = dtrtrs(lower, coupling, lower=1)
        return cls(lower, coupling, front[inner:, inner:] - coupling.T @ coupling)


def _cholesky(matrix: FloatArray) -> FloatArray:
    from scipy.linalg.lapack import dpotrf

    if not matrix.size:
        return matrix
    lower, failed = dpotrf(matrix, lower=1)
    if failed:
        raise RuntimeError("the matrix is not positive definite")
    return np.asarray(lower)


@dataclass(frozen=True, eq=False)
class Dissection:
    """A body's elements in parts.

    Parameters
    ----------
    parts : tuple of _Part
        Halves before what they are halves of; the last one is all of the body.
    places : ndarray of int
        Unknowns that are left to the last.
    size : int
        Number of unknowns.
    elastic : ndarray, shape (elements, shapes, shapes)
        Stiffness of each element where nothing has changed it: before it yields.
    """

    parts: tuple[_Part, ...]
    places: NDArray[np.int64]
    size: int
    elastic: FloatArray

    @classmethod
    def of(
        cls,
        unknowns: NDArray[np.int64],
        coordinates: FloatArray,
        places: ArrayLike,
        size: int,
        elastic: FloatArray,
        nodes: NDArray[np.int64] | None = None,
    ) -> Dissection:
        """Parts of a mesh.

        Parameters
        ----------
        unknowns : ndarray of int, shape (elements, shapes)
            Unknown of each shape function of each element; -1 where it is held.
        coordinates : ndarray, shape (elements, k)
            Coordinates of the elements, by one of which they are halved.
        places : array_like of int
            Unknowns that are left to the last, all different, at least one.
        size : int
            Number of unknowns.
        elastic : ndarray, shape (elements, shapes, shapes)
            Stiffness of each element before it yields.
        nodes : ndarray of int, shape (elements, k), optional
            Nodes of each element, or some of them: halves that share few of them share few unknowns.
        """
        places = np.asarray(places, dtype=np.int64)
        shared = unknowns + 1 if nodes is None else nodes
        dissecting = _Dissecting(unknowns, shared, coordinates, places, size)
        return cls(tuple(dissecting.parts()), places, size, elastic)

    def condensed(
        self, changed: NDArray[np.bool_], stiffness: Callable[[NDArray[np.int64]], FloatArray]
    ) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """(K^-1) between the places, and a solver for any right-hand side.

        Parameters
        ----------
        changed : ndarray of bool, shape (elements,)
            Which elements have another stiffness than the elastic one.
        stiffness : callable
            Takes numbers of elements to their stiffness, shape (k, shapes, shapes).

        Returns
        -------
        inverse : ndarray, shape (m, m)
            In the order of the places.
        solve : callable
            Takes b, shape (n,) or (n, k), to K^-1 b.

        Raises
        ------
        RuntimeError
            If the stiffness is not positive definite.
        """
        return self._answers(self._eliminated(changed, stiffness))

    def unchanged(self) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """The same as `condensed` where no element has another stiffness than the elastic one."""
        return self._answers(self._elastic)

    def _answers(self, found: list[_Eliminated]) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        from scipy.linalg.lapack import dpotri

        last = _cholesky(found[-1].handed_on)
        inverse, _ = dpotri(last, lower=1)
        inverse = np.tril(inverse)
        order, places = self._order
        # what a part hands on is not needed any more, and need not be kept
        kept = [(one.lower, one.coupling) for one in found if len(one.lower)]
        steps = [(*place, *one) for place, one in zip(places, kept, strict=True)]

        def solve(right: FloatArray) -> FloatArray:
            from scipy.linalg.lapack import dpotrs, dtrtrs

            turned = right.reshape(len(right), -1)[order]
            for span, outer, lower, coupling in steps:
                inner = turned[span]
                # forces stand on few parts
                if inner.any():
                    turned[span], _ = dtrtrs(lower, inner, lower=1)
                    turned[outer] -= coupling.T @ inner
            rest = turned[-len(last) :]
            rest[:], _ = dpotrs(last, rest, lower=1)
            for span, outer, lower, coupling in reversed(steps):
                turned[span], _ = dtrtrs(lower, turned[span] - coupling @ turned[outer], lower=1, trans=1)
            solution = np.empty_like(turned)
            solution[order] = turned
            return solution.reshape(right.shape)

        return inverse + np.tril(inverse, -1).T, solve

    @cached_property
    def _order(self) -> tuple[NDArray[np.int64], list[tuple[slice, NDArray[np.int64]]]]:
        """Unknowns in the order of their elimination, and where those that a part eliminates and hands on are then."""
        eliminating = [part for part in self.parts if len(part.inner)]
        order = np.concatenate([*(part.inner for part in eliminating), self.places])
        place = np.empty_like(order)
        place[order] = np.arange(self.size)
        ends = np.cumsum([0, *(len(part.inner) for part in eliminating)]).tolist()
        spans = (slice(*ends) for ends in pairwise(ends))
        return order, [(span, place[part.outer]) for span, part in zip(spans, eliminating, strict=True)]

    @cached_property
    def _elastic(self) -> list[_Eliminated]:
        """All parts before anything yields."""
        return self._eliminated(
            np.ones(len(self.elastic), dtype=bool), lambda elements: self.elastic[elements]
        )

    def _eliminated(
        self,
        changed: NDArray[np.bool_],
        stiffness: Callable[[NDArray[np.int64]], FloatArray],
    ) -> list[_Eliminated]:
        """Every part, anew where an element has changed."""
        found: list[_Eliminated] = []
        for number, part in enumerate(self.parts):
            if not changed[part.elements].any():
                found.append(self._elastic[number])
                continue
            if part.halves:
                front = part.joined(tuple(found[half].handed_on for half in part.halves))
            else:
                front = part.front(stiffness(part.elements))
            found.append(_Eliminated.of(front, len(part.inner)))
        return found


@dataclass(frozen=True, eq=False)
class _Dissecting:
    """How the elements of a mesh are halved."""

    unknowns: NDArray[np.int64]
    nodes: NDArray[np.int64]
    coordinates: FloatArray
    places: NDArray[np.int64]
    size: int

    def parts(self) -> list[_Part]:
        """All parts, halves before what they are halves of."""
        found: list[_Part] = []
        self._add(np.arange(len(self.unknowns)), found)
        *others, last = found
        # what is handed on by the whole is left to the last, in the order in which it is asked for
        return [*others, self._part(last.elements, last.halves, found, self.places)]

    def _add(self, elements: NDArray[np.int64], found: list[_Part]) -> int:
        halves: tuple[int, ...] = ()
        if len(elements) > _SMALLEST:
            halves = tuple(self._add(half, found) for half in self._halves(elements))
        found.append(self._part(elements, halves, found))
        return len(found) - 1

    def _part(
        self,
        elements: NDArray[np.int64],
        halves: tuple[int, ...],
        found: list[_Part],
        outer: NDArray[np.int64] | None = None,
    ) -> _Part:
        here = np.bincount(self.unknowns[elements].ravel() + 1, minlength=self.size + 1)[1:]
        handed = [found[half].outer for half in halves]
        known = np.unique(np.concatenate(handed)) if halves else np.flatnonzero(here)
        whole = (here[known] == self._uses[known]) & ~self._last[known]
        inner = known[whole]
        outer = known[~whole] if outer is None else outer
        place = np.full(self.size + 1, len(inner) + len(outer))
        place[np.concatenate([inner, outer])] = np.arange(len(inner) + len(outer))
        of = [place[one] for one in handed] if halves else [place[self.unknowns[elements]]]
        return _Part(elements, halves, inner, outer, tuple(of))

    def _halves(self, elements: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Two halves along one of the coordinates, that along which they share fewer nodes."""
        order = elements[np.argsort(self.coordinates[elements], axis=0, kind="stable").T]
        halves = order[:, : len(elements) // 2], order[:, len(elements) // 2 :]
        # for each coordinate, which nodes each half has
        have = np.zeros((2, len(order), self._count), dtype=bool)
        for which, half in zip(have, halves, strict=True):
            which[np.arange(len(order))[:, None], self.nodes[half].reshape(len(order), -1)] = True
        best = int(np.argmin(np.count_nonzero(have[0] & have[1], axis=1)))
        return np.sort(halves[0][best]), np.sort(halves[1][best])

    @cached_property
    def _count(self) -> int:
        return int(self.nodes.max()) + 1

    @cached_property
    def _uses(self) -> NDArray[np.int64]:
        """How many elements have each unknown."""
        return np.bincount(self.unknowns.ravel() + 1, minlength=self.size + 1)[1:]

    @cached_property
    def _last(self) -> NDArray[np.bool_]:
        last = np.zeros(self.size, dtype=bool)
        last[self.places] = True
        return last
