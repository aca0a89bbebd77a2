"""Flow along lines that meet in nodes, with a mobility that depends on the fluid pressure itself.

Pressure is here what drives the flow: that of the fluid or a potential of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from leak.arrays import BoolArray, FloatArray, IntArray
from leak.errors import ProfileError
from leak.numerics.roots import MOST_STEPS

# Simpson's rule is exact for the third power of a depth that is linear in the fluid pressure, and knows both ends.
_PLACES, _WEIGHTS = np.array([[0.0], [0.5], [1.0]]), np.array([1.0, 4.0, 1.0]) / 6.0
# Newton's method has arrived when neither flow nor pressures change any more; a step below the last is not taken.
_FLOW_TOLERANCE, _STEP_TOLERANCE, _LEAST_STEP = 1e-11, 1e-7, 1e-10
# Of the best conductance: less than this is none, but the equations stay solvable.
_LEAST_SHARE, _NO_SHARE = 1e-60, 1e-50
# From one stage to the next, where a little flow everywhere helps to find the way.
_REDUCTION, _MOST_LESS = 0.1, 0.98


@dataclass(frozen=True, eq=False)
class Line:
    """Slices one behind the other, from node to node."""

    nodes: IntArray
    """Numbers of the nodes at the ends of the slices, shape (n + 1,)."""
    length: FloatArray
    """Of each slice, shape (n,) [m]."""
    mobility: Callable[[FloatArray], FloatArray]
    """m >= 0 at pressures (k, n), one column per slice, shape (k, n): flow = m dp_f/dx."""
    opens: FloatArray
    """Pressure from which on the fluid holds a slice open, where m has a kink, shape (n,) [Pa]; -inf for none."""


@dataclass(frozen=True, eq=False)
class NetworkFlow:
    """Flow through a network."""

    flow: float
    """Between the ends of the first line, not negative; zero where no way is open."""
    potential: FloatArray
    """What drives it, in the nodes, shape (nodes,)."""


def network_flow(lines: Sequence[Line], first: float, last: float) -> NetworkFlow:
    """Flow from end to end of the first line, whose pressures are given.

    Parameters
    ----------
    lines : sequence of Line
        The first one begins and ends at the ends of the network.
    first, last : float
        Pressure at its first and its last node, not equal [Pa].

    Returns
    -------
    NetworkFlow

    Raises
    ------
    ProfileError
        No solution was found.

    Notes
    -----
    In each slice the place is one, and the equation integrates exactly: flow times length = int m dp_f between the
    pressures at its ends. What flows into a node flows out of it. Newton's method, from the state in which every slice
    is as open as the higher of both pressures makes it.

    The flow is the dissipation over the pressure drop, the sum of all slices' flow times drop: errors of the
    pressures enter squared, and wide open slices, where the drop is all round-off, weigh nothing.
    """
    network = _Network(tuple(lines))
    low, high = min(first, last), max(first, last)
    open_state = np.full((1, network.length.size), high)
    conductance = network.conductance(open_state)[0]
    start = np.full(network.count, high)
    start[[lines[0].nodes[0], lines[0].nodes[-1]]] = first, last
    best = max(float(conductance.max()), 1e-200)
    p = network.linear(conductance + _LEAST_SHARE * best, start)
    if not network.is_connected(conductance > _NO_SHARE * best):
        return NetworkFlow(0.0, np.clip(p, low, high))
    is_found, p, flow = network.newton(np.clip(p, low, high), _LEAST_SHARE * best)
    if not is_found:
        # Just before the fluid opens a closed place Newton's method loses its way: begin with a little flow everywhere,
        # and take it away in steps that it can follow.
        p, share, reduction = start, 1.0, _REDUCTION
        while not is_found and share > _LEAST_SHARE and reduction < _MOST_LESS:
            close, new_p, _ = network.newton(p, share * reduction * best)
            if not close:
                reduction = reduction**0.5
                continue
            p, share, reduction = new_p, share * reduction, max(reduction**1.5, _REDUCTION)
            if share * best * (high - low) < network.flow(network.conductances(p)[0], p):
                is_found, new_p, flow = network.newton(p, _LEAST_SHARE * best)
                p = new_p if is_found else p
    if not is_found:
        raise ProfileError("the flow along the groove was not found: the groove all but closes")
    return NetworkFlow(flow, p)


@dataclass(frozen=True, eq=False)
class _Network:
    lines: tuple[Line, ...]

    @cached_property
    def tail(self) -> IntArray:
        return np.concatenate([line.nodes[:-1] for line in self.lines])

    @cached_property
    def head(self) -> IntArray:
        return np.concatenate([line.nodes[1:] for line in self.lines])

    @cached_property
    def length(self) -> FloatArray:
        return np.concatenate([line.length for line in self.lines])

    @cached_property
    def count(self) -> int:
        return int(max(line.nodes.max() for line in self.lines)) + 1

    @cached_property
    def inner(self) -> BoolArray:
        inner = np.ones(self.count, dtype=bool)
        inner[self.lines[0].nodes[[0, -1]]] = False
        return inner

    def conductance(self, pressure: FloatArray) -> FloatArray:
        """m over the length of all slices at pressures (k, slices)."""
        splits = np.cumsum([line.length.size for line in self.lines])[:-1]
        parts = np.split(pressure, splits, axis=1)
        values = [line.mobility(part) for line, part in zip(self.lines, parts, strict=True)]
        return np.concatenate(values, axis=1) / self.length

    @cached_property
    def opens(self) -> FloatArray:
        return np.concatenate([line.opens for line in self.lines])

    def conductances(self, p: FloatArray) -> FloatArray:
        """Of each slice flow over drop, and m over its length at its tail and its head, shape (3, slices)."""
        start, end = p[self.tail], p[self.head]
        kink = np.clip(self.opens, np.minimum(start, end), np.maximum(start, end))
        first = np.abs(kink - start) / np.where(end == start, 1.0, np.abs(end - start))
        if not np.any((first > 0.0) & (first < 1.0)):
            c = self.conductance(start + _PLACES * (end - start))
            return np.stack([_WEIGHTS @ c, c[0], c[-1]])
        parts = [low + _PLACES * (high - low) for low, high in ((start, kink), (kink, end))]
        c = self.conductance(np.concatenate(parts))
        upper, lower = np.split(c, 2)
        return np.stack([first * (_WEIGHTS @ upper) + (1.0 - first) * (_WEIGHTS @ lower), c[0], c[-1]])

    def drops(self, p: FloatArray) -> FloatArray:
        """From tail to head of each slice."""
        return p[self.head] - p[self.tail]

    def divergence(self, flows: FloatArray) -> FloatArray:
        """What flows out of each node, flows counted from head to tail."""
        inflow, outflow = (np.bincount(ends, flows, self.count) for ends in (self.head, self.tail))
        return np.asarray(inflow - outflow, dtype=float)

    def is_connected(self, open_slices: BoolArray) -> bool:
        """Whether some way through open slices leads from end to end."""
        if open_slices.all():
            return True
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        tail, head = self.tail[open_slices], self.head[open_slices]
        graph = coo_array((np.ones(tail.size), (tail, head)), shape=(self.count, self.count))
        part = connected_components(graph, directed=False)[1]
        first, last = self.lines[0].nodes[[0, -1]]
        return bool(part[first] == part[last])

    def flow(self, c: FloatArray, p: FloatArray) -> float:
        """Dissipation over the pressure drop between the ends."""
        ends = p[self.lines[0].nodes[[0, -1]]]
        return float(np.sum(c * self.drops(p) ** 2) / abs(ends[1] - ends[0]))

    def linear(self, c: FloatArray, end_pressures: FloatArray) -> FloatArray:
        """Pressures for given conductances; those of the ends are in `end_pressures`."""
        p = np.where(self.inner, 0.0, end_pressures)
        # twice: where slices are 1e18 times as open as others, the first solution leaves 1e-11 of the drop to wide open
        # ones, and that would count in the flow
        for _ in range(2):
            p = p + self.solve(c, c, -self.divergence(c * self.drops(p)))
        return p

    def newton(self, p: FloatArray, least: float) -> tuple[bool, FloatArray, float]:
        """Whether it converges from p, pressures and flow, with a smallest conductance of all slices."""
        ends = p[self.lines[0].nodes[[0, -1]]]
        low, high = float(ends.min()), float(ends.max())
        c = self.conductances(p)
        flow = self.flow(c[0] + least, p)
        for _ in range(MOST_STEPS):
            mean, tail, head = c + least
            step = self.solve(tail, head, -self.divergence(mean * self.drops(p)))
            new = np.clip(p + step, low, high)
            change, last_flow = float(np.abs(new - p).max()), flow
            if change <= _LEAST_STEP * (high - low):
                break
            p = new
            c = self.conductances(p)
            flow = self.flow(c[0] + least, p)
            if change <= _STEP_TOLERANCE * (high - low) and abs(flow - last_flow) <= _FLOW_TOLERANCE * flow:
                break
        else:
            return False, p, self.flow(c[0], p)
        return True, p, self.flow(c[0], p)

    def solve(self, tail: FloatArray, head: FloatArray, rhs: FloatArray) -> FloatArray:
        """Change of the inner pressures whose flows head dp_head - tail dp_tail bring `rhs` out of each node."""
        from scipy.linalg.lapack import dgbsv

        order, width, is_kept, place = self._band
        change = np.zeros(self.count)
        if order.size:
            value = np.concatenate([head, -tail, -head, tail])[is_kept]
            # LAPACK wants as many rows more as there are diagonals below
            rows = 3 * width + 1
            band = np.bincount(place, value, rows * order.size).reshape(rows, order.size)
            _, _, change[order], singular = dgbsv(width, width, band, rhs[order])
            if singular:
                raise ProfileError("the flow along the groove was not found: its way is cut")
        return change

    @cached_property
    def _band(self) -> tuple[IntArray, int, BoolArray, IntArray]:
        """The inner nodes in an order in which neighbours are near, how near, which values are kept, and where."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        number = np.cumsum(self.inner) - 1
        i = np.concatenate([self.head, self.head, self.tail, self.tail])
        j = np.concatenate([self.head, self.tail, self.head, self.tail])
        is_kept = self.inner[i] & self.inner[j]
        i, j, nodes = number[i[is_kept]], number[j[is_kept]], np.flatnonzero(self.inner)
        if not nodes.size:
            return nodes, 0, is_kept, i
        if len(self.lines) > 1:
            graph = coo_array((np.ones(i.size), (i, j)), shape=(nodes.size, nodes.size)).tocsr()
            order = np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.intp)
            turn = np.argsort(order)
            i, j, nodes = turn[i], turn[j], nodes[order]
        width = int(np.abs(i - j).max())
        return nodes, width, is_kept, (2 * width + i - j) * nodes.size + j
