"""The mesh of closure and seat with its names, quality and files."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meshes.geometry.contact_geometry import ContactGeometry
from meshes.geometry.outline import Outline
from meshes.mesh.measures import section_area, triangle_shape
from meshes.mesh.sizing import Sizing

if TYPE_CHECKING:
    from skfem import MeshTri


@dataclass(frozen=True)
class Quality:
    """How good the triangles are.

    Parameters
    ----------
    smallest : float
        Worst value of 2 (inscribed radius)/(circumscribed radius): 1 equilateral, 0 degenerate.
    mean : float
        Its mean.
    elements, vertices : int
    area_error : float
        Largest relative difference between a body's meshed and exact section area.

    Examples
    --------
    >>> import fem_seal, meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> quality = meshes.build(ball, cone, sizing).quality
    >>> bool(quality.smallest > 0.3), bool(quality.area_error < 0.01)
    (True, True)
    """

    smallest: float
    mean: float
    elements: int
    vertices: int
    area_error: float


@dataclass(frozen=True)
class SealMesh:
    """Straight triangles of both bodies with named boundaries and subdomains.

    Parameters
    ----------
    closure, seat : skfem.MeshTri
        Each body alone, coordinates (r, z) [m], with the boundaries "closure_contact", "closure_inner",
        "closure_outer", "closure_axis" or "seat_contact", "seat_inner", "seat_outer", "seat_wall", "seat_bottom".
    contact : ContactGeometry
        Exact geometry of the contact line.
    sizing : Sizing
    outlines : tuple of Outline
        Exact sections of closure and seat.

    Examples
    --------
    >>> import meshes
    >>> ball = meshes.Ball(0.02)
    >>> cone = meshes.ConicalSeat.around(0.785, ball)
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> mesh = meshes.build(ball, cone, sizing)
    >>> sorted(mesh.mesh.subdomains)
    ['closure', 'seat']
    """

    closure: MeshTri
    seat: MeshTri
    contact: ContactGeometry
    sizing: Sizing
    outlines: tuple[Outline, ...]

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.mesh.nelements} triangles, {self.mesh.nvertices} vertices>"

    @cached_property
    def mesh(self) -> MeshTri:
        """Both bodies, not connected, with all boundaries and the subdomains "closure" and "seat"."""
        return joined([("closure", self.closure), ("seat", self.seat)])

    @cached_property
    def quality(self) -> Quality:
        """Shape of the elements and error of the areas."""
        shape = triangle_shape(self.mesh.p, self.mesh.t)
        errors = [abs(section_area(getattr(self, o.name)) / o.area - 1) for o in self.outlines]
        return Quality(
            float(shape.min()), float(shape.mean()), self.mesh.nelements, self.mesh.nvertices, max(errors)
        )

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the mesh as gmsh file (format 2.2) with named physical groups, atomically.

        Returns
        -------
        pathlib.Path
            The file written.
        """
        return write_msh(self.mesh, Path(path))


def write_msh(mesh: MeshTri, path: Path) -> Path:
    """Write `mesh` with its boundaries and subdomains as physical groups, replacing `path` in one step.

    Parameters
    ----------
    mesh : skfem.MeshTri
        Coordinates (r, z) [m], written as (x, y, 0).
    path : pathlib.Path
        File to write, format gmsh 2.2, the one that every reader knows.

    Raises
    ------
    OSError
        If it cannot be written; nothing is left behind.
    """
    import meshio

    lines, line_tags, names = [], [], {}
    for tag, (name, facets) in enumerate(sorted((mesh.boundaries or {}).items()), start=1):
        lines.append(mesh.facets[:, np.asarray(facets)].T)
        line_tags.append(np.full(lines[-1].shape[0], tag))
        names[name] = np.array([tag, 1])
    cell_tags = np.zeros(mesh.nelements, dtype=int)
    for tag, (name, elements) in enumerate(sorted((mesh.subdomains or {}).items()), start=len(names) + 1):
        cell_tags[elements] = tag
        names[name] = np.array([tag, 2])
    tags = [np.concatenate(line_tags), cell_tags]
    part = meshio.Mesh(
        np.column_stack([mesh.p.T, np.zeros(mesh.nvertices)]),
        [("line", np.vstack(lines)), ("triangle", mesh.t.T)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=names,
    )
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        meshio.write(temporary, part, file_format="gmsh22", binary=False)
        os.replace(temporary, path)
    except OSError as error:
        # of the file that was asked for, not of the draft
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
    return path


def joined(bodies: list[tuple[str, MeshTri]]) -> MeshTri:
    """One mesh of several bodies that share no node, with a subdomain for each.

    Parameters
    ----------
    bodies : list of (name, skfem.MeshTri)
        With their boundaries.
    """
    from meshes.mesh.triangles import Triangles, facets_between

    offsets = np.cumsum([0, *(mesh.p.shape[1] for _, mesh in bodies)])
    counts = np.cumsum([0, *(mesh.nelements for _, mesh in bodies)])
    lines = {
        name: mesh.facets[:, facets].T + offset
        for (_, mesh), offset in zip(bodies, offsets, strict=False)
        for name, facets in (mesh.boundaries or {}).items()
    }
    p = np.hstack([body.p for _, body in bodies])
    t = np.hstack([body.t + offset for (_, body), offset in zip(bodies, offsets, strict=False)])
    mesh = Triangles(np.ascontiguousarray(p), np.ascontiguousarray(t))
    subdomains = {name: np.arange(counts[n], counts[n + 1]) for n, (name, _) in enumerate(bodies)}
    return mesh.with_boundaries(facets_between(mesh, lines)).with_subdomains(subdomains)
