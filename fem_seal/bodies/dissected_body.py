"""Nested dissection of a body: Schur complements of its parts, reused where the stiffness has not changed.

The elements are halved again and again (nested dissection: George, SIAM J. Numer. Anal. 10, 345 (1973)). From the
smallest parts on, each part eliminates the unknowns that no other part shares, and hands the stiffness of its boundary
to the part that it is half of; what some places feel is left to the last. A part is condensed anew only where one of
its elements has another stiffness than the elastic one: of a body that yields under its contact that is the plastic
zone, found anew each time, and nothing is assumed of the elements around it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix

from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.bodies.constrained_body import ConstrainedBody
from fem_seal.bodies.elasticity import element_dofs, element_stiffness
from fem_seal.bodies.elastoplastic import ElastoplasticBody, StressUpdate

# Elements of the smallest parts: fewer are more steps in Python, more are dense matrices with many zeros.
_SMALLEST_PART = 40


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

    elements: IntArray
    halves: tuple[int, ...]
    inner: IntArray
    outer: IntArray
    places: tuple[IntArray, ...]

    def front_matrix(self, local: FloatArray) -> FloatArray:
        """Stiffness of inner and outer from that of its elements (elements, shapes, shapes), of a smallest part."""
        size, (place,) = len(self.inner) + len(self.outer) + 1, self.places
        index = place[:, :, None] * size + place[:, None, :]
        sums = np.asarray(np.bincount(index.ravel(), local.ravel(), minlength=size * size), dtype=float)
        # symmetric, and turned round in the order that LAPACK takes without a copy of each row
        return sums.reshape(size, size)[:-1, :-1].T

    def join_halves(self, halves: tuple[FloatArray, ...]) -> FloatArray:
        """The same from what the halves hand on."""
        size = len(self.inner) + len(self.outer)
        front = np.zeros((size, size))
        for place, half in zip(self.places, halves, strict=True):
            # columns first: whole rows are added much faster than single numbers
            rows = np.zeros((len(place), size))
            rows[:, place] = half.T
            front[place] += rows
        return front.T


@dataclass(frozen=True, eq=False)
class _Elimination:
    """A part after its elimination: U^T U of the inner stiffness, U^-T times the coupling, and what is handed on.

    Of what is handed on the upper triangle alone: parts have their unknowns in the order of elimination, so that it is
    added to the upper triangle of the next part.
    """

    upper: FloatArray
    coupling: FloatArray
    handed_on: FloatArray

    @classmethod
    def of(cls, front: FloatArray, inner: int) -> _Elimination:
        from scipy.linalg.blas import dsyrk
        from scipy.linalg.lapack import dtrtrs

        upper, coupling, handed_on = (
            _cholesky(front[:inner, :inner]),
            front[:inner, inner:],
            front[inner:, inner:],
        )
        if coupling.size:
            coupling, _ = dtrtrs(upper, coupling, trans=1)
            handed_on = dsyrk(-1.0, coupling, 1.0, handed_on, trans=1)
        return cls(upper, coupling, handed_on)


def _cholesky(matrix: FloatArray) -> FloatArray:
    """U of U^T U, from the upper triangle."""
    from scipy.linalg.lapack import dpotrf

    if not matrix.size:
        return matrix
    upper, info = dpotrf(matrix)
    if info:
        raise RuntimeError("the matrix is not positive definite")
    return np.asarray(upper)


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
    places: IntArray
    size: int
    elastic: FloatArray

    @classmethod
    def of(
        cls,
        unknowns: IntArray,
        coordinates: FloatArray,
        places: ArrayLike,
        size: int,
        elastic: FloatArray,
        nodes: IntArray | None = None,
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
        levels = _halve_elements(unknowns + 1 if nodes is None else nodes, coordinates)
        return cls(_parts(levels, unknowns, places, size), places, size, elastic)

    def condense(
        self, is_changed: BoolArray, stiffness: Callable[[IntArray], FloatArray]
    ) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """Invert K between the places, and return a solver for any right-hand side.

        Parameters
        ----------
        is_changed : ndarray of bool, shape (elements,)
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
        return self._answers(self._eliminate_parts(is_changed, stiffness))

    def condense_elastic(self) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """The same as `condense` where no element has another stiffness than the elastic one."""
        return self._answers(self._elastic)

    def _answers(self, fronts: list[_Elimination]) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        from scipy.linalg.lapack import dpotri

        last_factor = _cholesky(fronts[-1].handed_on)
        inverse, _ = dpotri(last_factor)
        inverse = np.triu(inverse)
        # what a part hands on is not needed any more, and need not be kept
        factors = [(part.upper, part.coupling) for part in fronts if len(part.upper)]

        def solve(rhs: FloatArray) -> FloatArray:
            from scipy.linalg.lapack import dpotrs, dtrtrs

            order, places = self._order
            steps = [(*place, *matrices) for place, matrices in zip(places, factors, strict=True)]
            values = rhs.reshape(len(rhs), -1)[order]
            for span, outer, upper, coupling in steps:
                inner = values[span]
                # forces stand on few parts
                if np.count_nonzero(inner):
                    values[span], _ = dtrtrs(upper, inner, trans=1)
                    values[outer] -= coupling.T @ inner
            tail = values[-len(last_factor) :]
            tail[:], _ = dpotrs(last_factor, tail)
            for span, outer, upper, coupling in reversed(steps):
                values[span], _ = dtrtrs(upper, values[span] - coupling @ values[outer])
            solution = np.empty_like(values)
            solution[order] = values
            return solution.reshape(rhs.shape)

        return inverse + np.triu(inverse, 1).T, solve

    @cached_property
    def _order(self) -> tuple[IntArray, list[tuple[slice, IntArray]]]:
        """Unknowns in the order of their elimination, and where those that a part eliminates and hands on are then."""
        inner_parts = [part for part in self.parts if len(part.inner)]
        order = np.concatenate([*(part.inner for part in inner_parts), self.places])
        place = np.empty_like(order)
        place[order] = np.arange(self.size)
        ends = np.cumsum([0, *(len(part.inner) for part in inner_parts)]).tolist()
        spans = (slice(*ends) for ends in pairwise(ends))
        return order, [(span, place[part.outer]) for span, part in zip(spans, inner_parts, strict=True)]

    @cached_property
    def _elastic(self) -> list[_Elimination]:
        """All parts before anything yields."""
        return self._eliminate_parts(
            np.ones(len(self.elastic), dtype=bool), lambda elements: self.elastic[elements]
        )

    def _eliminate_parts(
        self, is_changed: BoolArray, stiffness: Callable[[IntArray], FloatArray]
    ) -> list[_Elimination]:
        """Every part, anew where an element has changed."""
        fronts: list[_Elimination] = []
        for number, part in enumerate(self.parts):
            if not np.count_nonzero(is_changed[part.elements]):
                fronts.append(self._elastic[number])
                continue
            if part.halves:
                front = part.join_halves(tuple(fronts[half].handed_on for half in part.halves))
            else:
                front = part.front_matrix(stiffness(part.elements))
            fronts.append(_Elimination.of(front, len(part.inner)))
        return fronts


def _halve_elements(nodes: IntArray, coordinates: FloatArray) -> list[IntArray]:
    """In which part each element is: of the whole, of its halves, of theirs and so on, each of shape (elements,).

    The halves of the n-th part are 2n and 2n + 1 of the next level; -1 where a part is not halved again. They lie along
    one of the coordinates, that along which they share fewer nodes.
    """
    part = np.zeros(len(nodes), dtype=np.int64)
    levels, orders = [part], list(np.argsort(coordinates.T, axis=1, kind="stable"))
    # each part counts its nodes anew; in which part each of them is
    node = np.unique(nodes, return_inverse=True)[1].reshape(nodes.shape)
    owner = np.zeros(node.max() + 1, dtype=np.int64)
    while True:
        size = np.bincount(part[part >= 0])
        # and last of what is in none of the parts, whose number is -1
        size = np.append(np.where(size > _SMALLEST_PART, size, 0), 0)
        if not size.any():
            return levels
        # elements by the part that is halved, and in it along each coordinate
        orders = [order[size[part[order]] > 0] for order in orders]
        orders = [order[_sort_parts(part[order])] for order in orders]
        number = part[orders[0]]
        in_second = np.arange(len(number)) - (np.cumsum(size) - size)[number] >= size[number] // 2
        share_counts, halves = [], np.zeros((len(orders), len(part)), dtype=np.int64)
        for half, order in zip(halves, orders, strict=True):
            half[order] = in_second
            have = _have(node[order], half[order], len(owner))
            share_counts.append(np.bincount(owner[have.all(axis=1)], minlength=len(size)))
        order, half = orders[0], halves[np.argmin(share_counts, axis=0)[part], np.arange(len(part))]
        have = _have(node[order], half[order], len(owner))
        node[order] = (np.cumsum(have) - 1)[2 * node[order] + half[order, None]]
        owner = (2 * owner[:, None] + [0, 1])[have]
        part = np.where(size[part] > 0, 2 * part + half, -1)
        levels.append(part)


def _have(node: IntArray, half: IntArray, count: int) -> BoolArray:
    """Which nodes each half has, shape (nodes, 2)."""
    have = np.zeros((count, 2), dtype=bool)
    have[node, half[:, None]] = True
    return have


def _parts(levels: list[IntArray], unknowns: IntArray, places: IntArray, size: int) -> tuple[_Part, ...]:
    """All parts, halves before what they are halves of; `levels` as from `_halve_elements`."""
    level_of, order = _elimination_order(levels, unknowns, places, size)
    rank = np.full(size + 1, -1)
    rank[order] = np.arange(size)
    rank, level_of = rank[unknowns], level_of[order]
    pieces = []
    # what the parts of the level below hand on: which part, and what
    sender, handed_on = np.empty((2, 0), dtype=np.int64)
    part_below = np.full(len(unknowns), -1)
    for level, part in reversed([*enumerate(levels)]):
        count = 1 + int(part.max())
        elements = np.flatnonzero(part >= 0)
        elements = elements[_sort_parts(part[elements])]
        leaves = elements[part_below[elements] < 0]
        free = rank[leaves] >= 0
        own_keys = (part[leaves, None] * size + rank[leaves])[free]
        keys, key = np.unique(np.append(own_keys, sender // 2 * size + handed_on), return_inverse=True)
        owner, unknown = np.divmod(keys, size)
        outer = level_of[unknown] < level
        sizes = np.bincount(owner, minlength=count)
        # in a part what it eliminates comes before what it hands on
        place = np.arange(len(keys)) - (np.cumsum(sizes) - sizes)[owner]
        of_elements = np.repeat(sizes[part[leaves], None], free.shape[1], axis=1)
        of_elements[free] = place[key[: len(own_keys)]]
        of_halves = _split_groups(place[key[len(own_keys) :]], sender, 2 * count)
        pieces.append(
            list(
                zip(
                    _split_groups(elements, part[elements], count),
                    _split_groups(order[unknown[~outer]], owner[~outer], count),
                    _split_groups(order[unknown[outer]], owner[outer], count),
                    _split_groups(of_elements, part[leaves], count),
                    zip(of_halves[::2], of_halves[1::2], strict=True),
                    strict=True,
                )
            )
        )
        sender, handed_on, part_below = owner[outer], unknown[outer], part
    parts: list[_Part] = []
    _add(parts, pieces, len(pieces) - 1, 0)
    return tuple(parts)


def _add(parts: list[_Part], pieces: Sequence[Sequence[Any]], level: int, number: int) -> int:
    """Append a part behind its halves; its place in the list."""
    elements, inner, outer, of_elements, of_halves = pieces[level][number]
    halves = (
        ()
        if len(of_elements)
        else (_add(parts, pieces, level - 1, 2 * number), _add(parts, pieces, level - 1, 2 * number + 1))
    )
    parts.append(_Part(elements, halves, inner, outer, of_halves if halves else (of_elements,)))
    return len(parts) - 1


def _elimination_order(
    levels: list[IntArray], unknowns: IntArray, places: IntArray, size: int
) -> tuple[IntArray, IntArray]:
    """On which level each unknown is eliminated, -1 if it is left to the last, and unknowns in the order of that."""
    # the smallest part that has all elements of an unknown; the held ones come behind all others
    level_of, part_of = np.zeros((2, size + 1), dtype=np.int64)
    for level, part in enumerate(levels):
        last_part = np.empty(size + 1, dtype=np.int64)
        last_part[unknowns] = part[:, None]
        is_whole = last_part >= 0
        is_whole[unknowns[last_part[unknowns] != part[:, None]]] = False
        level_of[is_whole], part_of[is_whole] = level, last_part[is_whole]
    # halves one after the other, and then what they are halves of
    end = (part_of + 1) << (len(levels) - level_of)
    level_of[places] = -1
    order = np.lexsort((-level_of[:-1], end[:-1]))
    return level_of[:-1], np.append(order[level_of[order] >= 0], places)


def _sort_parts(part: IntArray) -> IntArray:
    """Order that sorts numbers of parts; there are few, so that a radix sort is quick."""
    return np.argsort(part.astype(np.min_scalar_type(part.max())), kind="stable")


def _split_groups(values: IntArray, group: IntArray, count: int) -> list[IntArray]:
    """Values of each group; the numbers of the groups do not fall."""
    ends = np.searchsorted(group, np.arange(count + 1)).tolist()
    return [values[begin:end] for begin, end in pairwise(ends)]


@dataclass(frozen=True, eq=False)
class DissectedBody:
    """A held body in parts.

    Parameters
    ----------
    fem : ConstrainedBody
    solid : ElastoplasticBody or None
        The same body with its law, if it yields.

    Notes
    -----
    The contact nodes move along normal and tangent instead of r and z, so that the tangential motion, which no contact
    presses on, is eliminated with all others.
    """

    fem: ConstrainedBody
    solid: ElastoplasticBody | None = None

    def condense(self, flow: StressUpdate) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """Condense the linearised body on its contact line, without balance of a floating body.

        Parameters
        ----------
        flow : StressUpdate
            About which it is linearised.

        Returns
        -------
        compliance : ndarray, shape (n, n)
            Retreat of the contact nodes per unit normal force at each [m/N].
        solve : callable
            Takes forces on the free dofs, shape (k,) or (k, j), to displacements.

        Raises
        ------
        RuntimeError
            If its stiffness is not positive definite.
        """
        return self._normal_compliance(
            *self._dissection.condense(
                np.asarray(flow.yielding.any(axis=1)),
                lambda elements: self._stiffness(elements, flow.tangent[elements]),
            )
        )

    def elastic(self) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """The body before it yields, as `condense` has it.

        Raises
        ------
        RuntimeError
            If its stiffness is not positive definite.
        """
        return self._normal_compliance(*self._dissection.condense_elastic())

    def _normal_compliance(
        self, inverse: FloatArray, solve_turned: Callable[[FloatArray], FloatArray]
    ) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """Compliance along the normals, and a solver without turned nodes, from those of the dissection."""
        turned = self._turned_nodes
        radial, axial = self.fem.free_rows[self.fem.contact_dofs[:, turned]]
        n_r, n_z = self.fem.normal[:, turned][..., None]

        def solve(forces: FloatArray) -> FloatArray:
            local = forces.reshape(len(forces), -1).copy()
            along_r, along_z = local[radial], local[axial]
            local[radial], local[axial] = n_r * along_r + n_z * along_z, n_r * along_z - n_z * along_r
            motion = solve_turned(local)
            normal, tangent = motion[radial], motion[axial]
            motion[radial], motion[axial] = n_r * normal - n_z * tangent, n_z * normal + n_r * tangent
            return motion.reshape(forces.shape)

        _, projection = self._last_rows
        return np.asarray(projection.T @ (projection.T @ inverse).T), solve

    def _stiffness(self, elements: IntArray, tangent: FloatArray) -> FloatArray:
        """Stiffness of elements with turned contact nodes; their tangent has the shape (k, points, 4, 4)."""
        assert self.solid is not None  # only of a body that yields
        return self._add_turned_nodes(elements, self.solid.element_stiffness(elements, tangent))

    def _add_turned_nodes(self, elements: IntArray, local: FloatArray) -> FloatArray:
        has_turned = self._elements_of_turned_nodes[elements]
        turn = self._turn[self._number[elements[has_turned]]]
        local[has_turned] = turn.transpose(0, 2, 1) @ local[has_turned] @ turn
        return local

    @cached_property
    def _turned_nodes(self) -> BoolArray:
        """Which contact nodes can move both ways, shape (n,)."""
        return np.all(self.fem.free_rows[self.fem.contact_dofs] >= 0, axis=0)

    @cached_property
    def _elements_of_turned_nodes(self) -> BoolArray:
        """Which elements have a turned node."""
        turned_dofs = self.fem.contact_dofs[0, self._turned_nodes]
        return np.asarray(np.isin(element_dofs(self.fem.mesh), turned_dofs).any(axis=1))

    @property
    def _number(self) -> IntArray:
        """Number of each element among those with a turned node."""
        return np.cumsum(self._elements_of_turned_nodes) - 1

    @cached_property
    def _turn(self) -> FloatArray:
        """From normal and tangent to r and z, of the shapes of elements with a turned node; (k, shapes, shapes)."""
        radial, axial = self.fem.contact_dofs[:, self._turned_nodes]
        dofs = element_dofs(self.fem.mesh)[self._elements_of_turned_nodes]
        node = np.full(self.fem.size, -1)
        node[radial] = np.arange(len(radial))
        element, shape_r = np.nonzero(node[dofs] >= 0)
        contact_node = node[dofs[element, shape_r]]
        shape_z = np.argmax(dofs[element] == axial[contact_node][:, None], axis=1)
        n_r, n_z = self.fem.normal[:, self._turned_nodes][:, contact_node]
        turn = np.broadcast_to(np.eye(dofs.shape[1]), (*dofs.shape, dofs.shape[1])).copy()
        turn[element, shape_r, shape_r], turn[element, shape_r, shape_z] = n_r, -n_z
        turn[element, shape_z, shape_r], turn[element, shape_z, shape_z] = n_z, n_r
        return turn

    @cached_property
    def _last_rows(self) -> tuple[IntArray, csr_matrix]:
        """Rows eliminated last, and the projection of nodal forces on the contact normals."""
        rows, normal = self.fem.free_rows[self.fem.contact_dofs], self.fem.normal
        node = np.flatnonzero(self._turned_nodes)
        parts = [(rows[0, node], node, np.ones(len(node)))]
        for way in (0, 1):
            node = np.flatnonzero(~self._turned_nodes & (rows[way] >= 0))
            parts.append((rows[way, node], node, normal[way, node]))
        places, nodes, values = (np.concatenate(column) for column in zip(*parts, strict=True))
        shape = (len(places), rows.shape[1])
        return places, csr_matrix((values, (np.arange(len(places)), nodes)), shape=shape)

    @cached_property
    def _dissection(self) -> Dissection:
        body, mesh = self.fem, self.fem.mesh
        everywhere = np.arange(mesh.nelements)
        return Dissection.of(
            body.free_rows[element_dofs(mesh)],
            places_of_elements(body),
            self._last_rows[0],
            len(body.free),
            self._add_turned_nodes(everywhere, element_stiffness(mesh, body.material)),
            mesh.t.T,  # halves that share few vertices share few nodes
        )


def places_of_elements(body: ConstrainedBody) -> FloatArray:
    """By what elements are halved: r and z, and polar ones around the middle of the contact, where they are smallest.

    Returns
    -------
    ndarray, shape (elements, 4)
        From the middle of the contact [m, m, m, rad].
    """
    mesh, nodes = body.mesh, body.contact_nodes
    from_there = mesh.p[:, mesh.t].mean(axis=1).T - body.nodes[0][nodes[len(nodes) // 2]]
    return np.column_stack([from_there, np.hypot(*from_there.T), np.arctan2(*from_there.T)])
