"""gmsh files with named physical groups."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from skfem import MeshTri


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
