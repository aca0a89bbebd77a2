"""The mesh of closure and seat with its names, quality and files."""

from __future__ import annotations

import errno
import os
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from meshes.geometry.contact_geometry import ContactGeometry
from meshes.geometry.outline import Outline
from meshes.gmsh_session import gmsh_session
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
        from meshes.mesh.triangles import section_area, triangle_shape

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
    MeshingError
        If gmsh cannot be loaded.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(_in_gmsh_format(mesh))
        os.replace(temporary, path)
    except OSError as error:
        # of the file that was asked for, not of the draft
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
    return path


def _in_gmsh_format(mesh: MeshTri) -> bytes:
    """What gmsh writes of a mesh, into a file of its own: it does not say where the disc was full."""
    lines = [(name, mesh.facets[:, np.asarray(at)]) for name, at in sorted((mesh.boundaries or {}).items())]
    faces = [(name, mesh.t[:, np.asarray(at)]) for name, at in sorted((mesh.subdomains or {}).items())]
    points = np.column_stack([mesh.p.T, np.zeros(mesh.nvertices)])
    groups = [(1, *line) for line in lines] + [(2, *face) for face in faces]
    with TemporaryDirectory() as folder, gmsh_session("written") as gmsh:
        model, file = gmsh.model, Path(folder) / "mesh.msh"
        for tag, (dimension, name, _) in enumerate(groups, start=1):
            model.addDiscreteEntity(dimension, tag)
            model.addPhysicalGroup(dimension, [tag], tag, name)
        model.mesh.addNodes(2, len(groups), np.arange(1, mesh.nvertices + 1), points.ravel())
        for tag, (dimension, _, corners) in enumerate(groups, start=1):
            # gmsh's numbers of lines and triangles are 1 and 2
            model.mesh.addElementsByType(tag, dimension, [], corners.T.ravel() + 1)
        gmsh.write(str(file))
        text = file.read_bytes()
    if not text.endswith(b"$EndElements\n"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return text


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
