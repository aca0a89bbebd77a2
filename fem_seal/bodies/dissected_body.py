"""A body condensed by nested dissection; where it yields, only the parts that yield are condensed again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix

from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.bodies.constrained_body import ConstrainedBody
from fem_seal.bodies.dissection import Dissection
from fem_seal.bodies.elasticity import element_dofs, element_stiffness
from fem_seal.bodies.elastoplastic import ElastoplasticBody, StressUpdate


@dataclass(frozen=True, eq=False)
class DissectedBody:
    """A held body in parts.

    Parameters
    ----------
    held : ConstrainedBody
    solid : ElastoplasticBody or None
        The same body with its law, if it yields.

    Notes
    -----
    The contact nodes move along normal and tangent instead of r and z, so that the tangential motion, which no contact
    presses on, is eliminated with all others.
    """

    held: ConstrainedBody
    solid: ElastoplasticBody | None = None

    def condensed(self, flow: StressUpdate) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """The body linearised, as it is seen from its contact line; nothing is balanced or counted.

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
        return self._seen(
            *self._dissection.condensed(
                np.asarray(flow.yielding.any(axis=1)),
                lambda elements: self._stiffness(elements, flow.tangent[elements]),
            )
        )

    def elastic(self) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """The body before it yields, as `condensed` has it.

        Raises
        ------
        RuntimeError
            If its stiffness is not positive definite.
        """
        return self._seen(*self._dissection.unchanged())

    def _seen(
        self, inverse: FloatArray, solve_turned: Callable[[FloatArray], FloatArray]
    ) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
        """Compliance along the normals, and a solver without turned nodes, from those of the dissection."""
        (radial, axial), (n_r, n_z) = self._turned_rows, self.held.normal[:, self._turned][..., None]

        def solve(forces: FloatArray) -> FloatArray:
            turned = forces.reshape(len(forces), -1).copy()
            along_r, along_z = turned[radial], turned[axial]
            turned[radial], turned[axial] = n_r * along_r + n_z * along_z, n_r * along_z - n_z * along_r
            moved = solve_turned(turned)
            normal, tangent = moved[radial], moved[axial]
            moved[radial], moved[axial] = n_r * normal - n_z * tangent, n_z * normal + n_r * tangent
            return moved.reshape(forces.shape)

        _, along = self._last
        return np.asarray(along.T @ (along.T @ inverse).T), solve

    def _stiffness(self, elements: IntArray, tangent: FloatArray) -> FloatArray:
        """Stiffness of elements with turned contact nodes; their tangent has the shape (k, points, 4, 4)."""
        assert self.solid is not None  # only of a body that yields
        return self._with_turned(elements, self.solid.element_stiffness(elements, tangent))

    def _with_turned(self, elements: IntArray, local: FloatArray) -> FloatArray:
        touched = self._touched[elements]
        turn = self._turn[self._number[elements[touched]]]
        local[touched] = turn.transpose(0, 2, 1) @ local[touched] @ turn
        return local

    @cached_property
    def _turned(self) -> BoolArray:
        """Which contact nodes can move both ways, shape (n,)."""
        return np.all(self.held.free_rows[self.held.contact_dofs] >= 0, axis=0)

    @cached_property
    def _turned_rows(self) -> IntArray:
        """Rows of the free dofs that are turned to normal and tangent, shape (2, turned)."""
        return self.held.free_rows[self.held.contact_dofs[:, self._turned]]

    @cached_property
    def _touched(self) -> BoolArray:
        """Which elements have a turned node."""
        turned = self.held.contact_dofs[0, self._turned]
        return np.asarray(np.isin(element_dofs(self.held.mesh), turned).any(axis=1))

    @cached_property
    def _number(self) -> IntArray:
        """Number of each element among those with a turned node."""
        return np.cumsum(self._touched) - 1

    @cached_property
    def _turn(self) -> FloatArray:
        """From normal and tangent to r and z, of the shapes of elements with a turned node; (k, shapes, shapes)."""
        radial, axial = self.held.contact_dofs[:, self._turned]
        dofs = element_dofs(self.held.mesh)[self._touched]
        node = np.full(self.held.size, -1)
        node[radial] = np.arange(len(radial))
        element, first = np.nonzero(node[dofs] >= 0)
        which = node[dofs[element, first]]
        second = np.argmax(dofs[element] == axial[which][:, None], axis=1)
        n_r, n_z = self.held.normal[:, self._turned][:, which]
        turn = np.broadcast_to(np.eye(dofs.shape[1]), (*dofs.shape, dofs.shape[1])).copy()
        turn[element, first, first], turn[element, first, second] = n_r, -n_z
        turn[element, second, first], turn[element, second, second] = n_z, n_r
        return turn

    @cached_property
    def _last(self) -> tuple[IntArray, csr_matrix]:
        """Rows eliminated last, and the projection of nodal forces on the contact normals."""
        rows, normal = self.held.free_rows[self.held.contact_dofs], self.held.normal
        node = np.flatnonzero(self._turned)
        parts = [(rows[0, node], node, np.ones(len(node)))]
        for way in (0, 1):
            node = np.flatnonzero(~self._turned & (rows[way] >= 0))
            parts.append((rows[way, node], node, normal[way, node]))
        places, nodes, values = (np.concatenate(column) for column in zip(*parts, strict=True))
        shape = (len(places), rows.shape[1])
        return places, csr_matrix((values, (np.arange(len(places)), nodes)), shape=shape)

    @cached_property
    def _dissection(self) -> Dissection:
        held, mesh = self.held, self.held.mesh
        everywhere = np.arange(mesh.nelements)
        return Dissection.of(
            held.free_rows[element_dofs(mesh)],
            places_of_elements(held),
            self._last[0],
            len(held.free),
            self._with_turned(everywhere, element_stiffness(mesh, held.material)),
            mesh.t.T,  # halves that share few vertices share few nodes
        )


def places_of_elements(held: ConstrainedBody) -> FloatArray:
    """By what elements are halved: r and z, and polar ones around the middle of the contact, where they are smallest.

    Returns
    -------
    ndarray, shape (elements, 4)
        From the middle of the contact [m, m, m, rad].
    """
    mesh, nodes = held.mesh, held.contact_nodes
    from_there = mesh.p[:, mesh.t].mean(axis=1).T - held.nodes[0][nodes[len(nodes) // 2]]
    return np.column_stack([from_there, np.hypot(*from_there.T), np.arctan2(*from_there.T)])
