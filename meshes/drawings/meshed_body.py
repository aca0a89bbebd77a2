"""A body that comes as a mesh: used as it is, with a smooth face through its boundary nodes."""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meshes.drawings.profile import CORNER, PARTS, Profile, section_columns
from meshes.errors import GeometryError
from meshes.geometry.biarcs import through
from meshes.geometry.contact_geometry import ContactGeometry, named_beside
from meshes.geometry.curve import Segment
from meshes.geometry.outline import Outline
from meshes.own_process import OwnProcessError, TimeLimitError, run_in_subprocess

if TYPE_CHECKING:
    from skfem import MeshTri

    from meshes.arrays import FloatArray, IntArray

# Largest coordinate of a node in the unit of its file, micrometres perhaps; what is larger is a damaged number.
_FARTHEST = 1e8


@dataclass(frozen=True, eq=False)
class MeshedOutline(Outline):
    """Outline of a body whose mesh exists already.

    Parameters
    ----------
    name, segments
        As of `Outline`; the face is a chain of arcs through the nodes, every other piece a straight facet.
    mesh : skfem.MeshTri
        Of this body alone [m], with its boundaries under their full names.
    """

    mesh: MeshTri

    def __eq__(self, other: object) -> bool:
        return super().__eq__(other) and isinstance(other, MeshedOutline) and self.mesh is other.mesh

    def __hash__(self) -> int:
        return super().__hash__()

    @property
    def ready_mesh(self) -> MeshTri:
        """The mesh of the body [m]."""
        return self.mesh

    def shift(self, dz: float) -> MeshedOutline:
        """The outline and its mesh moved by dz [m] along the axis."""
        mesh = self.mesh.translated((0.0, dz))
        return replace(self, segments=tuple(s.shift(dz) for s in self.segments), mesh=mesh)

    def halve_triangles(self) -> MeshedOutline:
        """The same outline with every triangle cut into four."""
        return replace(self, mesh=self.mesh.refined())

    def widen_zone(self, contact: ContactGeometry, zone: tuple[float, float]) -> tuple[float, float]:
        """The zone [m] widened to whole facets of the face, as far as the faces stand in front of each other."""
        x = self._face_x(contact)
        low, high = contact.reach
        x = x[(x >= low) & (x <= high)]
        inner, outer = x[x <= zone[0]], x[x >= zone[1]]
        return float(inner[-1] if len(inner) else x[0]), float(outer[0] if len(outer) else x[-1])

    def _face_x(self, contact: ContactGeometry) -> FloatArray:
        facets = self.mesh.facets[:, (self.mesh.boundaries or {})[f"{self.name}_face"]]
        return np.sort(contact.coordinate(*self.mesh.p[:, np.unique(facets)]))

    def with_contact(self, contact: ContactGeometry, zone: tuple[float, float]) -> MeshTri:
        """The mesh with its face cut into inner part, contact line and outer part.

        Parameters
        ----------
        contact : ContactGeometry
        zone : tuple of float
            Ends of the contact line [m]; facets that reach into it belong to it.
        """
        boundaries = dict(self.mesh.boundaries or {})
        face = np.asarray(boundaries.pop(f"{self.name}_face"))
        ends = np.sort(
            contact.coordinate(*self.mesh.p[:, self.mesh.facets[:, face].ravel()]).reshape(2, -1), axis=0
        )
        slack = 1e-9 * (zone[1] - zone[0])
        inner, outer = ends[1] <= zone[0] + slack, ends[0] >= zone[1] - slack
        for part, belongs in (("inner", inner), ("contact", ~inner & ~outer), ("outer", outer)):
            facets = boundaries.get(f"{self.name}_{part}", np.zeros(0, dtype=int))
            boundaries[f"{self.name}_{part}"] = np.concatenate([facets, face[belongs]])
        parts = {part: facets for part, facets in boundaries.items() if len(facets)}
        return type(self.mesh)(self.mesh.p, self.mesh.t).with_boundaries(parts)


@dataclass(frozen=True)
class MeshedBody:
    """Closure or seat read from a gmsh file, see `MeshedBody.read`; `file_unit` is the length of its unit [m].

    Examples
    --------
    >>> import meshes
    >>> body = meshes.read_section("closure.msh", "closure")     # doctest: +SKIP
    """

    outline: MeshedOutline
    file_unit: float

    @classmethod
    def read(
        cls, path: Path, name: str, *, axis: str = "y", length_unit: float = 1.0, time_limit: float = 20.0
    ) -> MeshedBody:
        """Read the triangles and named boundaries of one body; the file in a process of its own, as drawings are.

        Parameters
        ----------
        path : pathlib.Path
            gmsh file. Physical groups of lines are called after the body and its parts, such as "seat_face" or plainly
            "face", see `meshes.drawings.profile.PARTS`; "face" is needed, the others are found by their place where
            they are missing. If there is a physical surface of the body's name, it alone is read.
        name : str
            "closure" or "seat".
        axis : {"x", "y", "z"}
            Coordinate along the axis of the seal; r is the other one of the plane in which the mesh lies.
        length_unit : float
            Length of the file's unit [m].
        time_limit : float
            Longest time that reading the file may take [s].

        Raises
        ------
        GeometryError
            If the file cannot be read, or not in time, or the mesh is not that of a body.
        """
        try:
            points, triangles, lines = run_in_subprocess(time_limit, _read_body, path, name)
        except OwnProcessError as error:
            longer = "; allow a longer time_limit" if isinstance(error, TimeLimitError) else ""
            raise GeometryError(f"{path.name}: cannot be read as gmsh mesh ({error}){longer}") from error
        nodes, t = np.unique(triangles, return_inverse=True)
        columns = section_columns(np.abs(points[nodes]).max(axis=0).tolist(), axis, path)
        p = length_unit * points[:, columns].T
        where = np.full(len(points), -1)
        where[nodes] = np.arange(len(nodes))
        outline = _outline(name, path, p[:, nodes], t.reshape(triangles.shape).T, where, lines)
        return cls(outline, length_unit)


def _read_body(path: Path, name: str) -> tuple[FloatArray, IntArray, dict[str, IntArray]]:
    """Points, the body's triangles, and the lines of each of its parts."""
    from meshio import ReadError, gmsh

    try:
        # The reader itself: `meshio.read` writes to the terminal and leaves the program.
        mesh = gmsh.read(path)
    except (OSError, ReadError, ValueError, LookupError, AssertionError, struct.error) as error:
        reason = str(error) or "it is damaged or of another kind"
        raise GeometryError(f"{path.name}: cannot be read as gmsh mesh ({reason})") from error
    groups = {key: (int(tag), int(dimension)) for key, (tag, dimension) in mesh.field_data.items()}
    physical = mesh.cell_data.get("gmsh:physical", [np.zeros(len(block.data)) for block in mesh.cells])
    body = groups.get(name, (None, 2))[0]
    triangles: list[IntArray] = []
    lines: dict[str, list[IntArray]] = {}
    for block, tags in zip(mesh.cells, physical, strict=True):
        if block.type.startswith("triangle"):
            triangles.append(block.data[:, :3][slice(None) if body is None else tags == body])
        elif block.type.startswith("line"):
            for key, (tag, dimension) in groups.items():
                part = key.removeprefix(f"{name}_")
                part = "face" if part == "contact" else part
                if dimension == 1 and part in PARTS[name] and np.any(tags == tag):
                    lines.setdefault(part, []).append(block.data[:, :2][tags == tag])
    if not triangles or not sum(map(len, triangles)):
        kinds = sorted({block.type for block in mesh.cells})
        hint = (
            f'; gmsh saves physical groups alone: make the surface one, "{name}", or set Mesh.SaveAll = 1'
            if all(kind.startswith(("line", "vertex")) for kind in kinds)
            else ""
        )
        raise GeometryError(
            f"{path.name}: holds no triangles of the {name} but {', '.join(kinds) or 'nothing'}{hint}"
        )
    if "face" not in lines:
        group_names = ", ".join(key for key, (_, dimension) in groups.items() if dimension == 1) or "none"
        raise GeometryError(
            f'{path.name}: needs a physical group of lines "{name}_face", where contact may happen; its groups are '
            f"{group_names}"
        )
    for corners, blocks in ((3, triangles), *((2, blocks) for blocks in lines.values())):
        for nodes in blocks:
            if nodes.shape[1] != corners or not np.all((nodes >= 0) & (nodes < len(mesh.points))):
                raise GeometryError(f"{path.name}: holds elements whose nodes are not there; it is damaged")
    if not np.abs(mesh.points).max() < _FARTHEST:
        raise GeometryError(
            f"{path.name}: holds a node further from the origin than {_FARTHEST:g}, or at no place at all; a number of "
            "the file is damaged"
        )
    return mesh.points, np.vstack(triangles), {part: np.vstack(blocks) for part, blocks in lines.items()}


def _outline(
    name: str, path: Path, p: FloatArray, t: IntArray, where: IntArray, lines: dict[str, IntArray]
) -> MeshedOutline:
    from skfem import MeshTri

    mesh = MeshTri(np.ascontiguousarray(p), np.ascontiguousarray(t))
    loop = _loop(mesh, path)
    part_of = {tuple(sorted(pair)): part for part, pairs in lines.items() for pair in where[pairs].tolist()}
    at = [tuple(p[:, n].tolist()) for n in loop]
    edges = [tuple(sorted(pair)) for pair in pairwise([*loop, loop[0]])]
    pieces = [
        Segment(a, b, part_of.get(edge, ""))
        for (a, b), edge in zip(pairwise([*at, at[0]]), edges, strict=True)
    ]
    profile = named_beside(Profile(name, tuple(pieces)).outline)
    facets = {tuple(sorted(pair)): n for n, pair in enumerate(mesh.facets.T.tolist())}
    index = {point: n for point, n in zip(at, loop, strict=True)}
    axis = {(0.0, z): n for (r, z), n in index.items() if abs(r) < 1e-6 * max(p[0])}
    index |= axis
    boundaries: dict[str, list[int]] = {}
    for s in profile.segments:
        pair = tuple(sorted((index[s.start], index[s.end])))
        boundaries.setdefault(s.name, []).append(facets[pair])
    # Nodes of the axis are exactly there.
    points = mesh.p.copy()
    points[0, list(axis.values())] = 0.0
    body_mesh = MeshTri(points, mesh.t).with_boundaries(
        {key: np.array(numbers) for key, numbers in boundaries.items()}
    )
    face = profile.face
    nodes = np.array([*(s.start for s in face.segments), face.segments[-1].end])
    smooth = profile.with_face(through(nodes, f"{name}_face", CORNER).segments)
    return MeshedOutline(name, smooth.segments, body_mesh)


def _loop(mesh: MeshTri, path: Path) -> list[int]:
    """Boundary nodes in order, once around."""
    neighbours: dict[int, list[int]] = {}
    for a, b in mesh.facets[:, mesh.boundary_facets()].T.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    if any(len(nodes) != 2 for nodes in neighbours.values()):
        raise GeometryError(f"{path.name}: the boundary of the mesh meets itself in a point")
    start = next(iter(neighbours))
    loop, last = [start], -1
    while True:
        a, b = neighbours[loop[-1]]
        new = b if a == last else a
        if new == start:
            break
        last = loop[-1]
        loop.append(new)
    if len(loop) != len(neighbours):
        raise GeometryError(
            f"{path.name}: the mesh has more than one boundary; holes away from the axis are not possible"
        )
    return loop
