"""A constrained body: its contact line, its supports, its other loads, and its condensation on the contact line.

`fem_seal.contact.model` says how two condensed bodies make a contact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from scipy.sparse import csr_matrix, diags_array, hstack, vstack

from fem_seal.arrays import FloatArray, IntArray
from fem_seal.bodies.elasticity import (
    StressRecovery,
    boundary_dofs,
    edge_shapes,
    edge_slopes,
    node_dofs,
    pressure_load,
    quadratic_nodes,
)
from fem_seal.materials import Material
from meshes import SealMesh

if TYPE_CHECKING:
    from skfem import MeshTri

    from fem_seal.bodies.supports import Supports


LoadName: TypeAlias = str | int
"""A load of a body: the number of a wetted surface, from the axis outwards, or "wall", "expansion", "heat"."""


@dataclass(frozen=True)
class Heat:
    """How warm a body is, and what it would do freely.

    Parameters
    ----------
    temperature : ndarray, shape (nodes,)
        At its quadratic nodes [K].
    strain : ndarray, shape (nodes,)
        Free strain in all directions beyond that of the seat at the contact [-].
    """

    temperature: FloatArray
    strain: FloatArray


@dataclass(frozen=True)
class ConstrainedBody:
    """Discrete body with its contact line, supports and further loads; nothing is said about its material law.

    Parameters
    ----------
    name : str
        "closure" or "seat".
    mesh : skfem.MeshTri
        Its displacement is quadratic, see `fem_seal.bodies.elasticity.node_dofs`.
    contact_nodes : ndarray of int, shape (n,)
        The nodes of the contact line among the body's quadratic nodes, along increasing x.
    contact_x : ndarray, shape (n,)
        Their arc length from first touch [m].
    normal : ndarray, shape (2, n)
        Unit normal (r, z) at these nodes, into the body; along it a contact pressure acts.
    trace, slope : csr_matrix, shape (m, n)
        From these nodes to the m points of the contact line, and to the derivatives there along the element.
    free : ndarray of int
        Dofs that are not held.
    balance : ndarray, shape (dofs,)
        Nodal forces of what holds a floating body, of unit axial sum: the closing load on the closure's top. Motion
        is counted from there, the mean displacement weighted with this load being zero. All zero if supports hold it.
    further : mapping of ndarray, shape (dofs,)
        Nodal forces [N] of a unit of each further load, such as 1 Pa on a wetted surface, by its number from the
        axis outwards; not balanced.
    wall : ndarray of int
        Radial dofs of an outer wall that is held and can be moved.
    free_strain : mapping of ndarray, shape (nodes,)
        Strain at the nodes that takes no stress [-], of a unit of each way to be heated.
    temperature : ndarray, shape (nodes,), or None
        Where it was calculated [K].
    label : str
        What errors call the body.
    """

    name: str
    mesh: MeshTri
    material: Material
    contact_nodes: IntArray
    contact_x: FloatArray
    normal: FloatArray
    trace: csr_matrix
    slope: csr_matrix
    free: IntArray
    balance: FloatArray
    further: Mapping[LoadName, FloatArray]
    wall: IntArray
    free_strain: Mapping[str, FloatArray] = field(default_factory=dict)
    temperature: FloatArray | None = None
    label: str = ""

    @property
    def size(self) -> int:
        """Number of its dofs."""
        return self.balance.size

    @cached_property
    def contact_dofs(self) -> IntArray:
        """Radial and axial dof of the contact nodes, shape (2, n)."""
        return node_dofs(self.mesh)[:, self.contact_nodes]

    @cached_property
    def nodes(self) -> tuple[FloatArray, IntArray]:
        """Places [m] of the quadratic nodes, and the triangles over them, see `quadratic_nodes`."""
        return quadratic_nodes(self.mesh)

    @property
    def wall_nodes(self) -> IntArray:
        """Nodes of a held wall among the quadratic ones."""
        return np.flatnonzero(np.isin(node_dofs(self.mesh)[0], self.wall))

    @cached_property
    def to_face_strain(self) -> csr_matrix:
        """From the radial motion [m] of the contact nodes, and then their axial one, to the strain of the face.

        Shape (2 m, 2 n): along the face at all points of the contact line, then around the axis.
        """
        places = self.nodes[0][self.contact_nodes]
        way = self.slope @ places
        along = [diags_array(part / (way**2).sum(axis=1)) @ self.slope for part in way.T]
        hoop = diags_array(1.0 / (self.trace @ places[:, 0])) @ self.trace
        return csr_matrix(vstack([hstack(along), hstack([hoop, 0.0 * hoop])]))

    def face_strain(self, displacement: FloatArray) -> FloatArray:
        """Strain in the plane of the face, along it and around the axis [-], shape (2, m) or (2, m, k).

        Parameters
        ----------
        displacement : ndarray, shape (dofs,) or (dofs, k)
            [m]
        """
        strain = self.to_face_strain @ displacement[self.contact_dofs.ravel()]
        return np.asarray(strain.reshape(2, -1, *displacement.shape[1:]))

    def nodal_forces(self, point_forces: FloatArray) -> FloatArray:
        """Nodal forces (dofs,) [N] of normal forces at the points of the contact line [N], balanced; or (dofs, k)."""
        forces = np.zeros((self.size, *point_forces.shape[1:]))
        forces[self.contact_dofs] = (self.normal.T * (self.trace.T @ point_forces).T[..., None]).T
        return self.balance_forces(forces)

    def balance_forces(self, forces: FloatArray) -> FloatArray:
        """Nodal forces (dofs,) or (dofs, k) [N] together with the load that balances them on a floating body."""
        return forces - np.multiply.outer(self.balance, forces[node_dofs(self.mesh)[1]].sum(axis=0))

    def remove_rigid_motion(self, displacement: FloatArray) -> FloatArray:
        """Displacement (dofs,) or (dofs, k) [m] without the axial rigid motion of a floating body."""
        relative = displacement.copy()
        relative[node_dofs(self.mesh)[1]] -= self.balance @ displacement
        return relative

    def normal_displacement(self, displacement: FloatArray) -> FloatArray:
        """How far the contact nodes move along the normal into the body [m], shape (n,) or (n, k)."""
        return np.sum((self.normal.T * self.remove_rigid_motion(displacement)[self.contact_dofs].T).T, axis=0)

    def floating_compliance(self, compliance: FloatArray, response: FloatArray) -> FloatArray:
        """Compliance of the contact nodes where what holds a floating body balances the forces on them.

        Parameters
        ----------
        compliance : ndarray, shape (n, n)
            Retreat of the contact nodes per unit normal force at each [m/N].
        response : ndarray, shape (dofs,)
            Displacement under `balance` [m/N].

        Notes
        -----
        (F - c s)^T K^-1 (F - c s) with the unit normal forces F and the shares s of each that the load c balances.
        """
        share = self.normal[1]
        cross = np.outer(np.sum(self.normal * response[self.contact_dofs], axis=0), share)
        return compliance + self.balance @ response * np.outer(share, share) - cross - cross.T

    @property
    def free_rows(self) -> IntArray:
        """Row of every dof among the free ones; -1 where it is held."""
        number = np.full(self.size, -1)
        number[self.free] = np.arange(len(self.free))
        return number


def constrained_body(
    seal_mesh: SealMesh,
    name: str,
    material: Material,
    x: FloatArray,
    area_weight: FloatArray,
    supports: Supports | None = None,
    heat: Heat | None = None,
) -> ConstrainedBody:
    """One body of a seal: the seat stands on its bottom, the closure floats under its closing load.

    Parameters
    ----------
    name : str
        "closure" or "seat".
    x : ndarray, shape (m,)
        Points of the contact line, arc length from first touch [m].
    area_weight : ndarray, shape (m,)
        Area of the seat that each of them stands for [m^2].
    supports : Supports, optional
    heat : Heat, optional
        Of a body whose temperature differs from place to place.
    """
    contact = seal_mesh.contact
    mesh: MeshTri = getattr(seal_mesh, name)
    nodes, trace, slope = trace_matrix(mesh, f"{name}_contact", contact.coordinate, x)
    contact_x = contact.coordinate(*quadratic_nodes(mesh)[0][nodes].T)
    # Towards the body's inside: up into the closure, down into the seat.
    normal = contact.normal(contact_x) * (1.0 if name == "closure" else -1.0)
    balance, wall = np.zeros(node_dofs(mesh).size), np.zeros(0, dtype=np.int64)
    further: dict[LoadName, FloatArray] = {
        region: pressure_load(mesh, f"{name}_{side}") for region, side in enumerate(("inner", "outer"))
    }
    # Between the surfaces fluid acts on both bodies along the contact normal. What a face that leans away from it feels
    # more or less belongs to the fluid at that end of the line, so that fluid all around is even pressure.
    on_line = node_dofs(mesh)[:, nodes]
    lean_load = pressure_load(mesh, f"{name}_contact")[on_line] - normal * (trace.T @ area_weight)
    for region, at_end in enumerate((contact_x < 0, contact_x > 0)):
        further[region][on_line] += np.where(at_end, lean_load, 0.0)
    if name == "closure":
        closing_load = pressure_load(mesh, "closure_top")
        further[1] += closing_load
        axial = node_dofs(mesh)[1]
        balance = closing_load / closing_load[axial].sum()
        # Fluid all around must lift nothing, and that up to first touch acts on the area of its circle. What is left to
        # that is the node there, which stands on both sides, or of a ready mesh its facets across the ends of the line.
        in_gap, sealed_area = area_weight * (trace @ normal[1]), np.pi * contact.initial_contact_radius**2
        middle = int(np.argmin(np.abs(contact_x)))
        solid = "closure_axis" in (mesh.boundaries or {})
        for region, end, area in (
            (0, 0, sealed_area - in_gap[x < 0].sum()),
            (1, -1, -sealed_area - in_gap[x > 0].sum()),
        ):
            remainder = area - further[region][axial].sum()
            if solid:
                further[region][on_line[1, end if contact.has_ready_mesh else middle]] += remainder
            else:
                # what the pipe carries from behind the bore
                further[region] += remainder * balance
    elif supports is not None and supports.wall == "fixed":
        wall = boundary_dofs(mesh, "seat_wall", 0)
    # All of a closure can grow beyond what the seat grows, with which the closure's place and size are compared.
    free_strain = {"expansion": np.ones(len(quadratic_nodes(mesh)[0]))} if name == "closure" else {}
    if heat is not None:
        free_strain["heat"] = heat.strain
    return ConstrainedBody(
        name,
        mesh,
        material,
        nodes,
        contact_x,
        normal,
        trace,
        slope,
        free_dofs(mesh, name, supports),
        balance,
        further,
        wall,
        free_strain,
        None if heat is None else heat.temperature,
        contact.label_of(name),
    )


def free_dofs(mesh: MeshTri, name: str, supports: Supports | None) -> IntArray:
    """Dofs of a body that are not held.

    Parameters
    ----------
    mesh : skfem.MeshTri
    name : str
        "closure" or "seat".
    supports : Supports or None
    """
    boundaries = mesh.boundaries or {}
    if name == "closure":
        held = [boundary_dofs(mesh, "closure_top", 1)[:1]]
        held_radially = {"closure_axis": "closure_axis" in boundaries}
        held_radially["closure_top"] = supports is not None and supports.closure_base == "held"
    else:
        held = [boundary_dofs(mesh, "seat_bottom", 1)]
        held_radially = {"seat_wall": supports is not None and supports.wall == "fixed"}
        held_radially["seat_bottom"] = supports is not None and supports.base == "held"
    held += [boundary_dofs(mesh, side, 0) for side, is_held in held_radially.items() if is_held]
    return np.setdiff1d(np.arange(node_dofs(mesh).size), np.concatenate(held))


def trace_matrix(
    mesh: MeshTri, boundary: str, coordinate: Callable[[FloatArray, FloatArray], FloatArray], x: FloatArray
) -> tuple[IntArray, csr_matrix, csr_matrix]:
    """Quadratic trace on a contact line evaluated at the arc lengths `x`.

    Returns
    -------
    nodes : ndarray of int, shape (n,)
        The trace nodes among the body's quadratic nodes, along increasing x.
    trace, slope : csr_matrix, shape (len(x), n)
        To values, and to derivatives over the share of the way along the facet.
    """
    facets = np.asarray((mesh.boundaries or {})[boundary])
    ends = coordinate(*mesh.p[:, mesh.facets[:, facets].ravel()]).reshape(2, -1)
    order = np.argsort(ends.mean(axis=0))
    facets, ends = facets[order], ends[:, order]
    starts = ends.min(axis=0)
    facet = np.clip(np.searchsorted(starts, x, side="right") - 1, 0, len(facets) - 1)
    t = (x - ends[0, facet]) / (ends[1, facet] - ends[0, facet])
    vertex, vertex_index = np.unique(mesh.facets[:, facets], return_inverse=True)
    vertex_index = vertex_index.reshape(2, -1)
    columns = np.stack([vertex_index[0, facet], vertex_index[1, facet], len(vertex) + facet])
    nodes = np.concatenate([vertex, mesh.p.shape[1] + facets])
    node_order = np.argsort(coordinate(*quadratic_nodes(mesh)[0][nodes].T))
    place = np.argsort(node_order)
    where, size = (np.tile(np.arange(len(x)), 3), place[columns].ravel()), (len(x), len(nodes))
    trace, slope = (csr_matrix((part(t).ravel(), where), shape=size) for part in (edge_shapes, edge_slopes))
    return nodes[node_order], trace, slope


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

    def divided(self, factor: float) -> BoundaryLoad:
        """That of a body which is stiffer by a factor."""
        return replace(self, opening=self.opening / factor, response=self.response / factor)


# Loads of a body that prescribe how far it moves, whatever its stiffness.
_IMPOSED_MOTIONS = ("wall", "expansion", "heat")


@dataclass(frozen=True)
class CondensedBody:
    """One elastic body seen from its contact line.

    Parameters
    ----------
    fem : ConstrainedBody
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
    face_strain : ndarray, shape (2, m, n), or None
        Strain in the plane of the face under unit forces at the trace nodes along the normal, along the face and around
        the axis [1/N]; None where `solve` knows it, and of a body that was linearised where it yields.
    """

    fem: ConstrainedBody
    compliance: FloatArray
    find_loads: Callable[[], Mapping[LoadName, BoundaryLoad]] | None
    solve: Callable[[FloatArray], FloatArray] | None
    face_strain: FloatArray | None = None

    def __getstate__(self) -> dict[str, object]:
        """For pickle, which cannot store a factorisation: the loads are stored, the solver is not."""
        strain = self._strain_of_units
        return {**vars(self), "loads": self.loads, "find_loads": None, "solve": None, "face_strain": strain}

    @cached_property
    def loads(self) -> Mapping[LoadName, BoundaryLoad]:
        """Responses to unit loads by their names."""
        assert self.find_loads is not None  # of a body that was not pickled
        return self.find_loads()

    def with_loads(self, loads: Mapping[LoadName, BoundaryLoad]) -> CondensedBody:
        """The same body with other responses to its loads."""
        return replace(self, find_loads=lambda: loads)

    def stiffer(self, factor: float) -> CondensedBody:
        """The same body with Young's modulus times a factor, but for `compliance` and what is inside."""
        material = replace(self.material, youngs_modulus=self.material.youngs_modulus * factor)
        # the wall of a pressed-in housing and heat move a body as far as before; pressures move a stiffer one less
        loads = {
            name: load if name in _IMPOSED_MOTIONS else load.divided(factor)
            for name, load in self.loads.items()
        }
        strain = None if self._strain_of_units is None else self._strain_of_units / factor
        fem = replace(self.fem, material=material)
        return replace(self.with_loads(loads), fem=fem, face_strain=strain)

    @property
    def line_alone(self) -> CondensedBody:
        """The same body without a way to displacements inside it, which takes most of the memory."""
        return replace(self.with_loads(self.loads), solve=None)

    @property
    def material(self) -> Material:
        """Material of the body."""
        return self.fem.material

    @cached_property
    def recovery(self) -> StressRecovery:
        """From displacements to the stress at the nodes."""
        return StressRecovery(self.fem.mesh, self.material)

    def elastic_strain(
        self, point_forces: FloatArray, loads: Mapping[LoadName, float | FloatArray]
    ) -> FloatArray | None:
        """Strain of the face that takes stress, along it and around the axis [-]; None if not known.

        Parameters
        ----------
        point_forces : ndarray, shape (m,) or (m, k)
            Normal forces at the points of the contact line [N].
        loads : mapping
            Magnitude of each further load, or magnitudes, shape (k,).

        Returns
        -------
        ndarray, shape (m, 2) or (k, m, 2), or None
        """
        if self.face_strain is not None:
            strain = self.face_strain @ (self.fem.trace.T @ point_forces)
        elif self.solve is not None:
            strain = self.fem.face_strain(self.displacement(point_forces))
        else:
            return None
        for name, size in loads.items():
            load, trace = self.loads[name], self.fem.trace
            free = np.broadcast_to(load.free_strain, len(self.fem.nodes[0]))
            held = self.fem.face_strain(load.response) - trace @ free[self.fem.contact_nodes]
            strain = strain + np.multiply.outer(held, size)
        return strain.T

    @property
    def with_face_strain(self) -> CondensedBody:
        """The same body, which knows the strain of its face without what is inside."""
        return replace(self.with_loads(self.loads), face_strain=self._strain_of_units)

    @cached_property
    def _strain_of_units(self) -> FloatArray | None:
        """`face_strain`, which takes as long as many contacts; None if not known."""
        if self.face_strain is not None or self.solve is None:
            return self.face_strain
        fem = self.fem
        forces = np.zeros((fem.size, len(fem.contact_nodes)))
        for dofs, normal in zip(fem.contact_dofs, fem.normal, strict=True):
            forces[dofs, np.arange(len(dofs))] = normal
        return fem.face_strain(self.solve(fem.balance_forces(forces)))

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
            raise ValueError(f"the {self.fem.name} was condensed for its contact line alone")
        return self.fem.remove_rigid_motion(self.solve(self.fem.nodal_forces(point_forces)))


def condense_body(
    body: ConstrainedBody,
    flexibility: tuple[FloatArray, Callable[[FloatArray], FloatArray]],
    forces: Mapping[str, FloatArray] | None = None,
) -> CondensedBody:
    """A body whose stiffness is factorised, with all that loads it.

    Parameters
    ----------
    flexibility : tuple
        Compliance of its contact nodes, and from forces on its free dofs to their displacements, see
        `DissectedBody.elastic`.
    forces : mapping of ndarray, shape (dofs,), optional
        Nodal forces of loads beside those of the held body [N per unit]; "wall", of a body whose wall can be moved,
        while the wall alone is moved outwards by 1 m.
    """
    compliance, solve_free = flexibility

    def solve(nodal: FloatArray) -> FloatArray:
        displacement = np.zeros_like(nodal)
        displacement[body.free] = solve_free(nodal[body.free])
        return displacement

    unit_forces = dict(body.further)
    unit_forces.update(forces or {})

    def answers() -> Iterator[tuple[LoadName, BoundaryLoad]]:
        # all at once, which takes hardly longer than one of them
        responses = solve(np.stack([body.balance_forces(force) for force in unit_forces.values()], axis=1))
        for (name, force), response in zip(unit_forces.items(), responses.T, strict=True):
            motion = body.remove_rigid_motion(response)
            if name == "wall":
                motion[body.wall] = -1.0
            axial = float(force[node_dofs(body.mesh)[1]].sum())
            yield name, BoundaryLoad(axial, body.trace @ body.normal_displacement(motion), motion)

    if body.balance.any():
        compliance = body.floating_compliance(compliance, solve(body.balance))
    return CondensedBody(body, compliance, lambda: dict(answers()), solve)
