"""Both bodies condensed on the contact line: factorise once, then every load is a small dense problem.

The pressure acts at quadrature points of the contact line along the seat's normal n; the same point forces,
with opposite sign, act on both bodies. A body answers with the normal displacement of its quadratic trace, so
the compliance between quadrature points is T S T^T with T the trace and S the compliance of the trace's
nodes. On a curved line the normal is that of the trace's nodes, interpolated by T like the displacement. The closure
floats: its axial rigid motion is an unknown of the contact problem, and its closing force is a pressure on its top
that balances whatever acts elsewhere. Fluid on the wetted surfaces and a housing pressed into a bore are further
columns of the same factorisation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from fem_seal.elasticity import displacement_basis, pressure_load, stiffness_matrix
from fem_seal.materials import Material, effective_modulus
from fem_seal.single_thread import single_threaded
from fem_seal.stress import node_dofs, quadratic_nodes, stress_operator
from meshes import ContactGeometry, SealMesh

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU
    from skfem import Basis, MeshTri

FloatArray = NDArray[np.float64]

_BLOCK = 4

_GAUSS = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True)
class ContactLine:
    """Quadrature points of the contact line.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Arc length from first touch [m], increasing.
    radius : ndarray, shape (m,)
        r(x) [m].
    arc_weight : ndarray, shape (m,)
        Quadrature weights over x [m].
    normal : ndarray, shape (2, m)
        Unit normal (n_r, n_z) of the seat, towards the closure.
    initial_gap : ndarray, shape (m,)
        Exact gap g0(x) at first touch [m].
    vertices : ndarray
        x of the element ends between which the points lie [m], increasing.
    """

    x: FloatArray
    radius: FloatArray
    arc_weight: FloatArray
    normal: FloatArray
    initial_gap: FloatArray
    vertices: FloatArray

    @property
    def area_weight(self) -> FloatArray:
        """Area that each point stands for, 2 pi r dx [m^2]."""
        return 2 * np.pi * self.radius * self.arc_weight


@dataclass(frozen=True)
class Supports:
    """How the seat is held; its bottom always is, along the axis.

    Parameters
    ----------
    wall : {"free", "fixed"}
        Whether the outer wall of the housing is held radially.
    """

    wall: Literal["free", "fixed"] = "free"


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
    """

    axial_force: float
    opening: FloatArray
    response: FloatArray


@dataclass(frozen=True)
class CondensedBody:
    """One body seen from its contact line.

    Parameters
    ----------
    basis : skfem.Basis
        Displacement basis of the body.
    material : Material
    trace : csr_matrix, shape (m, n)
        From the body's n trace nodes to the m points of the contact line.
    response : ndarray, shape (dofs, n)
        Displacement [m] of the whole body under a unit force [N] at each trace node along the normal,
        the seat held, the closure in equilibrium with its closing load.
    compliance : ndarray, shape (n, n)
        Normal displacement of the trace nodes under the same unit forces [m/N].
    contact_nodes : ndarray of int, shape (n,)
        The trace nodes among the body's quadratic nodes, along increasing x.
    contact_x : ndarray, shape (n,)
        Their arc length from first touch [m].
    loads : mapping of BoundaryLoad
        "inner" and "outer": a fluid pressure of 1 Pa on the wetted surface inside and outside the contact line, the
        top of the closure being outside; of a seat with fixed wall also "wall": the wall moved inwards by 1 m.
    """

    basis: Basis
    material: Material
    trace: csr_matrix
    response: FloatArray
    compliance: FloatArray
    contact_nodes: NDArray[np.int64]
    contact_x: FloatArray
    loads: Mapping[str, BoundaryLoad]

    @cached_property
    def stress_operator(self) -> csr_matrix:
        """From displacement dofs [m] to nodal stress [Pa], see `fem_seal.stress.stress_operator`."""
        return stress_operator(self.basis, self.material)

    def displacement(self, point_forces: FloatArray) -> FloatArray:
        """Displacement dofs [m] under normal forces [N] at the points of the contact line."""
        return self.response @ (self.trace.T @ point_forces)


@dataclass(frozen=True)
class ContactModel:
    """Compliance of both bodies on one contact line; independent of load, roughness and interface law.

    Parameters
    ----------
    line : ContactLine
    closure, seat : CondensedBody
    compliance : ndarray, shape (m, m)
        Opening of the gap at point i per unit normal force at point j [m/N], both bodies together.
    touch_radius : float
        r0 [m].
    touch_normal_z : float
        cos(theta) of the contact normal at first touch.
    relative_radius : float
        R_rel [m].
    """

    line: ContactLine
    closure: CondensedBody
    seat: CondensedBody
    compliance: FloatArray
    touch_radius: float
    touch_normal_z: float
    relative_radius: float

    @property
    def effective_modulus(self) -> float:
        """E* of the pair [Pa]."""
        return effective_modulus(self.closure.material, self.seat.material)

    def line_load(self, axial_force: float) -> float:
        """f_N = F_N / (2 pi r0 cos theta) [N/m] (Fischer et al., above eq. 1)."""
        return axial_force / (2 * np.pi * self.touch_radius * self.touch_normal_z)


@single_threaded
def condense(
    seal_mesh: SealMesh, materials: Mapping[str, Material], supports: Supports | None = None
) -> ContactModel:
    """Factorise both bodies and condense them on the contact line.

    Parameters
    ----------
    seal_mesh : SealMesh
    materials : mapping
        Material of the body "closure" and of the body "seat".
    supports : Supports, optional

    Returns
    -------
    ContactModel

    Raises
    ------
    ValueError
        If the materials are not those of these two bodies.
    """
    if set(materials) != {"closure", "seat"}:
        raise ValueError(f'materials of {sorted(materials)}: needed are those of "closure" and "seat"')
    contact = seal_mesh.contact
    x, weight, vertices = _gauss_points(seal_mesh)
    # SuperLU works without Python's lock, so the two bodies can be condensed side by side.
    with ThreadPoolExecutor(2) as pool:
        closure, seat = pool.map(
            lambda name: _condense_body(
                getattr(seal_mesh, name), name, materials[name], contact, x, supports or Supports()
            ),
            ("closure", "seat"),
        )
    # The normal that the bodies feel, so that the forces on them balance to the last digit.
    normal = np.stack([seat.trace @ component for component in contact.normal(seat.contact_x)])
    line = ContactLine(x, contact.radius(x), weight, normal, contact.gap(x), vertices)
    compliance = sum(body.trace @ (body.trace @ body.compliance.T).T for body in (closure, seat))
    return ContactModel(
        line,
        closure,
        seat,
        0.5 * (compliance + compliance.T),
        contact.touch_radius,
        math.cos(contact.angle),
        contact.relative_radius,
    )


def _gauss_points(seal_mesh: SealMesh) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Three Gauss points on each contact facet of the seat, their weights over x, and the ends of the facets."""
    vertices = np.unique(seal_mesh.contact.coordinate(*_boundary_vertices(seal_mesh.seat, "seat_contact")))
    middle, half = 0.5 * (vertices[1:] + vertices[:-1]), 0.5 * np.diff(vertices)
    points, weights = _GAUSS
    return (middle[:, None] + half[:, None] * points).ravel(), (half[:, None] * weights).ravel(), vertices


def _boundary_vertices(mesh: MeshTri, boundary: str) -> FloatArray:
    return mesh.p[:, np.unique(mesh.facets[:, (mesh.boundaries or {})[boundary]])]


def _condense_body(
    mesh: MeshTri,
    name: str,
    material: Material,
    contact: ContactGeometry,
    x: FloatArray,
    supports: Supports,
) -> CondensedBody:
    from scipy.sparse.linalg import splu

    basis = displacement_basis(mesh)
    nodes, trace = trace_matrix(basis, f"{name}_contact", contact.coordinate, x)
    contact_x = contact.coordinate(*quadratic_nodes(mesh)[0][nodes].T)
    # Towards the body's inside: up into the closure, down into the seat.
    direction = contact.normal(contact_x) * (1.0 if name == "closure" else -1.0)
    forces = np.zeros((basis.N, len(nodes)))
    forces[node_dofs(basis)[:, nodes], np.arange(len(nodes))] = direction
    stiffness = stiffness_matrix(basis, material)
    names, columns, held = _further_loads(basis, name, stiffness, supports)
    if name == "closure":
        # The contact line lies on the seat. Fluid on the closure begins where the line ends, not a gap's width off it:
        # a force at the end of the line makes up for the ring between, and fluid all around lifts nothing.
        areas = np.pi * contact.radius(contact_x[[0, -1]]) ** 2
        for n, end, area in ((0, 0, areas[0]), (1, -1, -areas[1])):
            columns[n] += (area - _axial(basis, columns[n])) / direction[1, end] * forces[:, end]
    right = np.column_stack([forces, *columns])
    axial = _axial(basis, right[:, len(nodes) :])
    if name == "closure":
        closing = pressure_load(basis, "closure_top")
        right -= np.outer(closing / _axial(basis, closing), _axial(basis, right))
    free = np.setdiff1d(np.arange(basis.N), held)
    factor = splu(
        stiffness[free][:, free].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    response = np.zeros_like(right)
    response[free] = _solve_by_blocks(factor, right[free])
    if name == "closure":
        # Motion is counted from the loaded surface: its mean displacement, weighted with the load, is zero.
        response[node_dofs(basis)[1]] -= closing @ response / _axial(basis, closing)
    elif "wall" in names:
        response[_radial_dofs(basis, "seat_wall"), len(nodes) + names.index("wall")] = -1.0
    opening = trace @ (forces.T @ response[:, len(nodes) :])
    return CondensedBody(
        basis,
        material,
        trace,
        response[:, : len(nodes)],
        right[:, : len(nodes)].T @ response[:, : len(nodes)],
        nodes,
        contact_x,
        {
            load: BoundaryLoad(float(axial[n]), opening[:, n], response[:, len(nodes) + n])
            for n, load in enumerate(names)
        },
    )


def _further_loads(
    basis: Basis, name: str, stiffness: csr_matrix, supports: Supports
) -> tuple[list[str], list[FloatArray], NDArray[np.int64]]:
    """Names and forces of the loads away from the contact line, and the dofs that are held."""
    held: NDArray[np.int64]
    if name == "closure":
        outer = pressure_load(basis, "closure_outer") + pressure_load(basis, "closure_top")
        held = np.concatenate([_radial_dofs(basis, "closure_axis"), _axial_dofs(basis, "closure_top")[:1]])
        return ["inner", "outer"], [pressure_load(basis, "closure_inner"), outer], held
    loads = {"inner": pressure_load(basis, "seat_inner"), "outer": pressure_load(basis, "seat_outer")}
    held = _axial_dofs(basis, "seat_bottom")
    if supports.wall == "fixed":
        wall = _radial_dofs(basis, "seat_wall")
        held = np.concatenate([held, wall])
        loads["wall"] = np.asarray(stiffness[:, wall].sum(axis=1), dtype=float).ravel()
    return list(loads), list(loads.values()), held


def _solve_by_blocks(factor: SuperLU, right: FloatArray) -> FloatArray:
    """Solve for many right-hand sides, a few at a time: SuperLU's work array then stays in the cache.

    Twenty times faster than all at once for some hundred columns.
    """
    columns = range(0, right.shape[1], _BLOCK)
    return np.hstack([factor.solve(right[:, start : start + _BLOCK]) for start in columns])


def trace_matrix(
    basis: Basis, boundary: str, coordinate: Callable[[FloatArray, FloatArray], FloatArray], x: FloatArray
) -> tuple[NDArray[np.int64], csr_matrix]:
    """Quadratic trace on a contact line evaluated at the arc lengths `x`.

    Returns
    -------
    nodes : ndarray of int, shape (n,)
        The trace nodes among the body's quadratic nodes, along increasing x.
    trace : csr_matrix, shape (len(x), n)
    """
    mesh = basis.mesh
    facets = np.asarray((mesh.boundaries or {})[boundary])
    ends = coordinate(*mesh.p[:, mesh.facets[:, facets].ravel()]).reshape(2, -1)
    order = np.argsort(ends.mean(axis=0))
    facets, ends = facets[order], ends[:, order]
    first = ends.min(axis=0)
    facet = np.clip(np.searchsorted(first, x, side="right") - 1, 0, len(facets) - 1)
    t = (x - ends[0, facet]) / (ends[1, facet] - ends[0, facet])
    shape = np.stack([(1 - t) * (1 - 2 * t), t * (2 * t - 1), 4 * t * (1 - t)])
    vertex, vertex_index = np.unique(mesh.facets[:, facets], return_inverse=True)
    vertex_index = vertex_index.reshape(2, -1)
    columns = np.stack([vertex_index[0, facet], vertex_index[1, facet], len(vertex) + facet])
    rows = np.tile(np.arange(len(x)), 3)
    trace = csr_matrix((shape.ravel(), (rows, columns.ravel())), shape=(len(x), len(vertex) + len(facets)))
    nodes = np.concatenate([vertex, mesh.nvertices + facets])
    along = np.argsort(coordinate(*quadratic_nodes(mesh)[0][nodes].T))
    return nodes[along], trace[:, along]


def _axial(basis: Basis, forces: FloatArray) -> FloatArray:
    """Sum of the axial components of nodal forces."""
    return forces[node_dofs(basis)[1]].sum(axis=0)


def _radial_dofs(basis: Basis, boundary: str) -> NDArray[np.int64]:
    return np.asarray(basis.get_dofs(boundary).all(["u^1"]))


def _axial_dofs(basis: Basis, boundary: str) -> NDArray[np.int64]:
    return np.asarray(basis.get_dofs(boundary).all(["u^2"]))
