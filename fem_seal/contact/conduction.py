"""Steady heat conduction in both bodies of a seal, on the meshes of its contact.

div(k grad T) = 0 with quadratic elements, as of the displacement. A face takes up h (T_fluid - T) per area, has
a temperature, or is insulated; the axis is. Where the bodies touch, heat crosses the contact line at its quadrature
points, in proportion to the difference of both temperatures there; beside that, the line belongs to the wetted faces.
What leaves one body enters the other or the fluid to round-off.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import block_diag, bmat, coo_matrix, csc_matrix, csr_matrix

from fem_seal.arrays import FloatArray
from fem_seal.bodies.constrained_body import trace_matrix
from fem_seal.bodies.elasticity import (
    assemble_elements,
    at_quadrature_points,
    boundary_nodes,
    edge_shapes,
    quadratic_nodes,
    quadrature,
    ring_volume,
    shape_gradients,
)
from fem_seal.errors import ConvergenceError, InputError
from fem_seal.files import problem
from fem_seal.materials import Material
from fem_seal.processes import single_threaded
from leak.numerics.integrals import gauss

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from skfem import MeshTri

    from meshes import SealMesh

BODIES = ("closure", "seat")
# Conductance of a perfect contact in conductivities over the size of its elements: what is left of a step in
# temperature is that share of the change over an element.
_PERFECT = 1e3
# Conductivities that depend on the temperature: change of the field between two solutions [K].
_SAME, _MOST_STEPS = 1e-8, 50


@dataclass(frozen=True)
class Face:
    """What a face of the seal is in touch with.

    Parameters
    ----------
    temperature : float
        Of the fluid, or of the face itself [K].
    heat_transfer : float or None
        Heat transfer coefficient [W/(m^2 K)]; None where the face itself has the temperature.
    """

    temperature: float
    heat_transfer: float | None = None


@dataclass(frozen=True)
class Surroundings:
    """What warms and cools a seal.

    Parameters
    ----------
    faces : mapping of Face
        "inner", "outer", "top", "bottom", "wall": those that are missing are insulated. At least one.
    conductance : float or None
        Of the contact [W/(m^2 K)]; None where it is perfect, both faces having the same temperature.
    contact_range : tuple of float
        Arc lengths from first touch between which the bodies touch [m].
    """

    faces: Mapping[str, Face]
    conductance: float | None
    contact_range: tuple[float, float]


@dataclass(frozen=True)
class TemperatureField:
    """Temperatures of a seal and the heat that flows through it.

    Parameters
    ----------
    nodes : mapping of ndarray, shape (n,)
        Temperature of "closure" and "seat" at their quadratic nodes [K].
    faces : mapping
        Temperature of the faces of both where they touch, in the mean [K].
    heat : mapping
        Heat that flows into the seal through each face [W].
    contact_heat : float
        Heat that flows from closure to seat where they touch [W].
    """

    nodes: Mapping[str, FloatArray] = field(repr=False)
    faces: Mapping[str, float]
    heat: Mapping[str, float]
    contact_heat: float


@dataclass(frozen=True)
class _Body:
    """Triangles of a body, whose temperature is quadratic, and its part of the contact line."""

    name: str
    mesh: MeshTri
    material: Material
    trace: csr_matrix

    @classmethod
    def of(cls, name: str, seal_mesh: SealMesh, material: Material, x: FloatArray) -> _Body:
        mesh: MeshTri = getattr(seal_mesh, name)
        nodes, trace, _ = trace_matrix(mesh, f"{name}_contact", seal_mesh.contact.coordinate, x)
        size = mesh.nvertices + mesh.nfacets
        on_nodes = coo_matrix((np.ones(len(nodes)), (np.arange(len(nodes)), nodes)), shape=(len(nodes), size))
        return cls(name, mesh, material, (trace @ on_nodes).tocsr())

    @property
    def size(self) -> int:
        """Number of nodes."""
        return int(self.trace.shape[1])

    def conduction(self, temperature: FloatArray) -> csr_matrix:
        """int 2 pi r k grad T . grad v [W/K] with the conductivity at a temperature (nodes,) [K]."""
        try:
            conductivity = self.material.conductivity(at_quadrature_points(self.mesh, temperature))
        except InputError as error:
            raise InputError(
                *(replace(problem, key=f"{self.name}: {problem.key}") for problem in error.problems)
            ) from None
        slopes = shape_gradients(self.mesh, quadrature()[0])
        weight = conductivity * ring_volume(self.mesh)
        local = np.einsum("eq,eqid,eqjd->eij", weight, slopes, slopes, optimize=True)
        return assemble_elements(local, quadratic_nodes(self.mesh)[1], self.size)

    def film(self, face: str) -> csr_matrix:
        """int 2 pi r T v over a face [m^2]; zero where the body has no such face."""
        facets = (self.mesh.boundaries or {}).get(f"{self.name}_{face}", np.zeros(0, dtype=np.int64))
        (start, end), p = self.mesh.facets[:, facets], self.mesh.p
        shares, weights = 0.5 + 0.5 * gauss(3)[0], 0.5 * gauss(3)[1]
        shapes = edge_shapes(shares)
        radius = p[0, start, None] + (p[0, end] - p[0, start])[:, None] * shares
        area = 2 * np.pi * radius * np.hypot(*(p[:, end] - p[:, start]))[:, None] * weights
        local = np.einsum("eq,iq,jq->eij", area, shapes, shapes)
        return assemble_elements(
            local, np.stack([start, end, self.mesh.nvertices + facets], axis=1), self.size
        )

    def nodes(self, face: str) -> NDArray[np.int64]:
        """Of a face, if the body has it."""
        has_face = f"{self.name}_{face}" in (self.mesh.boundaries or {})
        return boundary_nodes(self.mesh, f"{self.name}_{face}") if has_face else np.zeros(0, dtype=np.int64)


@single_threaded
def conduct(
    seal_mesh: SealMesh,
    materials: Mapping[str, Material],
    surroundings: Surroundings,
    x: FloatArray,
    area_weight: FloatArray,
) -> TemperatureField:
    """Steady temperature of both bodies of a seal.

    Parameters
    ----------
    materials : mapping
        Of "closure" and "seat", with their thermal conductivities.
    surroundings : Surroundings
    x : ndarray, shape (m,)
        Points of the contact line, arc length from first touch [m].
    area_weight : ndarray, shape (m,)
        Area of the seat that each of them stands for [m^2].

    Raises
    ------
    InputError
        If a conductivity is not known, or not at a temperature that is reached.
    ConvergenceError
        If conductivities that depend on the temperature leave no steady one.
    """
    system = _System.of(seal_mesh, materials, surroundings, x, area_weight)
    temperature = np.full(system.size, np.mean([face.temperature for face in surroundings.faces.values()]))
    tables = [material.table("thermal_conductivity") for material in materials.values()]
    steps = _MOST_STEPS if any(table is not None and table.changes for table in tables) else 1
    for _ in range(steps):
        last_temperature, temperature = temperature, system.solve(temperature)
        if steps == 1 or np.abs(temperature - last_temperature).max() < _SAME:
            return system.field(temperature, last_temperature)
    raise ConvergenceError(problem("heat_conduction"))


@dataclass(frozen=True)
class _System:
    """Equations of both bodies together: what a node conducts away is what enters there from outside."""

    bodies: tuple[_Body, _Body]
    surroundings: Surroundings
    films: Mapping[str, csc_matrix]
    contact: csc_matrix
    contact_weight: FloatArray
    fixed_nodes: Mapping[str, NDArray[np.int64]]

    @classmethod
    def of(
        cls,
        seal_mesh: SealMesh,
        materials: Mapping[str, Material],
        surroundings: Surroundings,
        x: FloatArray,
        area_weight: FloatArray,
    ) -> _System:
        closure, seat = (_Body.of(name, seal_mesh, materials[name], x) for name in BODIES)
        bodies = closure, seat
        begin, end = surroundings.contact_range
        touches = (x > begin) & (x < end)
        # a contact narrower than an element is at least the point next to first touch
        touches |= np.abs(x) == np.abs(x).min()
        weight = np.where(touches, area_weight, 0.0)
        # beside the contact the line is a wetted face of either side
        sides = {"inner": (x < 0) & ~touches, "outer": (x > 0) & ~touches}
        films = {
            name: _film(bodies, name, np.where(sides[name], area_weight, 0.0) if name in sides else None)
            for name in surroundings.faces
        }
        conductance = surroundings.conductance
        if conductance is None:
            size = np.diff(np.sort(x)).min()
            conductance = _PERFECT * max(solid.largest_conductivity for solid in materials.values()) / size
        jump = bmat([[closure.trace, -seat.trace]]).tocsr()
        contact = csc_matrix(conductance * (jump.T @ jump.multiply(weight[:, None])))
        return cls(bodies, surroundings, films, contact, weight, _nodes_at_temperature(bodies, surroundings))

    @property
    def size(self) -> int:
        return sum(body.size for body in self.bodies)

    def split(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        count = self.bodies[0].size
        return values[:count], values[count:]

    def conduction(self, temperature: FloatArray) -> csc_matrix:
        parts = [body.conduction(T) for body, T in zip(self.bodies, self.split(temperature), strict=True)]
        return csc_matrix(block_diag(parts) + self.contact)

    def entering_heat(self, name: str, temperature: FloatArray) -> FloatArray:
        """Heat that enters each node through a face with a heat transfer coefficient [W]."""
        face = self.surroundings.faces[name]
        film = self.films[name] * (face.heat_transfer or 0.0)
        return np.asarray(film @ (face.temperature - temperature))

    def solve(self, temperature: FloatArray) -> FloatArray:
        """Temperature of every node with the conductivities at another one."""
        from scipy.sparse.linalg import splu

        matrix = self.conduction(temperature)
        rhs = np.zeros(self.size)
        solution, free = np.zeros(self.size), np.ones(self.size, dtype=bool)
        for name, face in self.surroundings.faces.items():
            film = self.films[name] * (face.heat_transfer or 0.0)
            matrix = csc_matrix(matrix + film)
            rhs += film @ np.full(self.size, face.temperature)
            if name in self.fixed_nodes:
                solution[self.fixed_nodes[name]], free[self.fixed_nodes[name]] = face.temperature, False
        factor = splu(csc_matrix(matrix)[free][:, free].tocsc())
        # A perfect contact conducts ten thousand times better than the bodies; refinement wins the digits back.
        for _ in range(3):
            solution[free] += factor.solve((rhs - matrix @ solution)[free])
        return solution

    def field(self, temperature: FloatArray, last_temperature: FloatArray) -> TemperatureField:
        parts = self.split(temperature)
        heat = {name: float(self.entering_heat(name, temperature).sum()) for name in self.surroundings.faces}
        # what the held faces take up is what is missing in the balance of their nodes
        surplus = self.conduction(last_temperature) @ temperature - sum(
            self.entering_heat(name, temperature) for name in self.surroundings.faces
        )
        for name, dofs in self.fixed_nodes.items():
            heat[name] += float(surplus[dofs].sum())
        share = self.contact_weight / self.contact_weight.sum()
        across = float(self.split(self.contact @ temperature)[0].sum())
        return TemperatureField(
            dict(zip(BODIES, parts, strict=True)),
            {
                name: float(share @ (body.trace @ T))
                for name, body, T in zip(BODIES, self.bodies, parts, strict=True)
            },
            heat,
            across,
        )


def _film(bodies: tuple[_Body, _Body], face: str, line_area: FloatArray | None) -> csc_matrix:
    """int 2 pi r T v over a face of both bodies and the part of the contact line beside it, areas (m,) [m^2]."""
    parts = [body.film(face) for body in bodies]
    if line_area is not None:
        lines = [body.trace.T @ body.trace.multiply(line_area[:, None]) for body in bodies]
        parts = [part + line for part, line in zip(parts, lines, strict=True)]
    return csc_matrix(block_diag(parts))


def _nodes_at_temperature(
    bodies: tuple[_Body, _Body], surroundings: Surroundings
) -> dict[str, NDArray[np.int64]]:
    """Nodes of each face that has a temperature itself; a corner between two such faces is one of the first."""
    face_nodes: dict[str, NDArray[np.int64]] = {}
    closure, seat = bodies
    for name, face in surroundings.faces.items():
        if face.heat_transfer is None:
            nodes = np.concatenate([closure.nodes(name), closure.size + seat.nodes(name)])
            face_nodes[name] = np.setdiff1d(
                nodes, [node for others in face_nodes.values() for node in others]
            )
    return face_nodes
