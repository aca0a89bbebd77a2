"""A body condensed on its contact line: its compliance there, and its answers to all other loads.

`fem_seal.contact.model` says how two of them make a contact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.constrained_body import ConstrainedBody, LoadName
from fem_seal.bodies.elasticity import node_dofs
from fem_seal.bodies.stress_recovery import StressRecovery
from fem_seal.materials import Material


@dataclass(frozen=True)
class BoundaryLoad:
    """Answer of a body to a unit load away from the contact line, balanced on the closure by its closing load.

    Parameters
    ----------
    axial_force : float
        Axial force that the load exerts on the body [N per unit], positive upwards.
    opening : ndarray, shape (m,)
        How far the body's surface moves away from the other body at the points of the contact line [m per unit].
    response : ndarray, shape (dofs,)
        Displacement of the whole body [m per unit].
    free_strain : ndarray, shape (nodes,), or float
        Strain, the same in all directions, that takes no stress: of a heated body [per unit].
    """

    axial_force: float
    opening: FloatArray
    response: FloatArray
    free_strain: FloatArray | float = 0.0


@dataclass(frozen=True)
class CondensedBody:
    """One elastic body seen from its contact line.

    Parameters
    ----------
    held : ConstrainedBody
        The body with its contact line and supports.
    compliance : ndarray, shape (n, n)
        Normal displacement of the trace nodes under unit forces at them along the normal [m/N].
    find_loads : callable or None
        Gives `loads`, found when the first of them is asked for: many contacts ask for none. 0, 1: a fluid pressure of
        1 Pa on the wetted surface inside and outside the contact line, the top of the closure being outside; of a seat
        with fixed wall also "wall": the wall moved inwards by 1 m; of the closure also "expansion": all of it grown by
        a strain of 1 beyond that of the seat. None of a body that was pickled, with which its loads went.
    solve : callable or None
        From nodal forces (dofs,) [N] to displacements [m]; None where only the contact line matters.
    """

    held: ConstrainedBody
    compliance: FloatArray
    find_loads: Callable[[], Mapping[LoadName, BoundaryLoad]] | None
    solve: Callable[[FloatArray], FloatArray] | None

    def __getstate__(self) -> dict[str, object]:
        """For pickle, which knows no factorisation: what is known goes with it, the way to more does not."""
        return {**vars(self), "loads": self.loads, "find_loads": None, "solve": None}

    @cached_property
    def loads(self) -> Mapping[LoadName, BoundaryLoad]:
        """Answers to unit loads by their names."""
        assert self.find_loads is not None  # of a body that was not pickled
        return self.find_loads()

    def with_loads(self, loads: Mapping[LoadName, BoundaryLoad]) -> CondensedBody:
        """The same body with other answers to its loads."""
        return replace(self, find_loads=lambda: loads)

    @property
    def line_alone(self) -> CondensedBody:
        """The same body without a way to displacements inside it, which takes most of the memory."""
        return replace(self.with_loads(self.loads), solve=None)

    @property
    def material(self) -> Material:
        """Material of the body."""
        return self.held.material

    @cached_property
    def recovery(self) -> StressRecovery:
        """From displacements to the stress at the nodes."""
        return StressRecovery(self.held.mesh, self.material)

    def displacement(self, point_forces: FloatArray) -> FloatArray:
        """Displacement dofs [m] under normal forces [N] at the points of the contact line.

        Parameters
        ----------
        point_forces : ndarray, shape (m,) or (m, k)
            Several loads at once take far less time than one after the other.

        Raises
        ------
        ValueError
            If the body was condensed for its contact line alone.
        """
        if self.solve is None:
            raise ValueError(f"the {self.held.name} was condensed for its contact line alone")
        return self.held.counted(self.solve(self.held.nodal_forces(point_forces)))


def condense_body(
    held: ConstrainedBody,
    seen: tuple[FloatArray, Callable[[FloatArray], FloatArray]],
    forces: Mapping[str, FloatArray] | None = None,
) -> CondensedBody:
    """A body whose stiffness is factorised, with all that loads it.

    Parameters
    ----------
    seen : tuple
        Compliance of its contact nodes, and from forces on its free dofs to their displacements, see
        `DissectedBody.elastic`.
    forces : mapping of ndarray, shape (dofs,), optional
        Nodal forces of loads beside those of the held body [N per unit]; "wall", of a body whose wall can be moved,
        while the wall alone is moved outwards by 1 m.
    """
    compliance, solve_free = seen

    def solve(nodal: FloatArray) -> FloatArray:
        displacement = np.zeros_like(nodal)
        displacement[held.free] = solve_free(nodal[held.free])
        return displacement

    named = dict(held.further)
    named.update(forces or {})

    def answers() -> Iterator[tuple[LoadName, BoundaryLoad]]:
        # all at once, which takes hardly longer than one of them
        responses = solve(np.stack([held.balanced(force) for force in named.values()], axis=1))
        for (name, force), response in zip(named.items(), responses.T, strict=True):
            counted = held.counted(response)
            if name == "wall":
                counted[held.wall] = -1.0
            axial = float(force[node_dofs(held.mesh)[1]].sum())
            yield name, BoundaryLoad(axial, held.trace @ held.normal_displacement(counted), counted)

    if held.balance.any():
        compliance = held.floating(compliance, solve(held.balance))
    return CondensedBody(held, compliance, lambda: dict(answers()), solve)
