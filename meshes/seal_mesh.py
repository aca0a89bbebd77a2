"""The mesh of closure and seat with its names, quality and files."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshes.contact_geometry import ContactGeometry
from meshes.outline import Outline
from meshes.sizing import Sizing

if TYPE_CHECKING:
    from skfem import MeshTri

FloatArray = NDArray[np.float64]


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
    mesh : skfem.MeshTri
        Both bodies, not connected, coordinates (r, z) [m]; subdomains "closure" and "seat"; boundaries
        "closure_contact", "closure_inner", "closure_outer", "closure_axis", "seat_contact", "seat_inner",
        "seat_outer", "seat_wall", "seat_bottom".
    contact : ContactGeometry
        Exact geometry of the contact line.
    sizing : Sizing
    outlines : tuple of Outline
        Exact sections of closure and seat.
    """

    mesh: MeshTri
    contact: ContactGeometry
    sizing: Sizing
    outlines: tuple[Outline, ...]

    @cached_property
    def closure(self) -> MeshTri:
        """The closure alone, with its boundaries."""
        return _body(self.mesh, "closure")

    @cached_property
    def seat(self) -> MeshTri:
        """The seat alone, with its boundaries."""
        return _body(self.mesh, "seat")

    @cached_property
    def quality(self) -> Quality:
        """Shape of the elements and error of the areas."""
        shape = triangle_shape(self.mesh.p, self.mesh.t)
        errors = [abs(section_area(_body(self.mesh, o.name)) / o.area - 1) for o in self.outlines]
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
        from meshes.msh_file import write_msh

        return write_msh(self.mesh, Path(path))


def triangle_shape(p: FloatArray, t: NDArray[np.int64]) -> FloatArray:
    """Return 2 r_in/r_circ of every triangle: 1 equilateral, 0 degenerate."""
    a, b, c = (np.linalg.norm(p[:, t[i]] - p[:, t[j]], axis=0) for i, j in ((0, 1), (1, 2), (2, 0)))
    return (b + c - a) * (c + a - b) * (a + b - c) / (a * b * c)


def section_area(mesh: MeshTri) -> float:
    """Area of the meshed section [m^2]."""
    p, t = mesh.p, mesh.t
    e, f = p[:, t[1]] - p[:, t[0]], p[:, t[2]] - p[:, t[0]]
    return float(0.5 * np.abs(e[0] * f[1] - e[1] * f[0]).sum())


def _body(mesh: MeshTri, name: str) -> MeshTri:
    body = mesh.restrict(name)
    boundaries = {key: facets for key, facets in (body.boundaries or {}).items() if key.startswith(name)}
    return type(body)(body.p, body.t).with_boundaries(boundaries)
