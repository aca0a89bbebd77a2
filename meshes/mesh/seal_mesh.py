"""The mesh of closure and seat: sizes of its elements, its names, quality and files."""

from __future__ import annotations

import errno
import math
import os
from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from meshes.arrays import FloatArray
from meshes.errors import GeometryError, MeshingError, mm
from meshes.geometry.contact_geometry import ContactGeometry
from meshes.geometry.outline import Outline
from meshes.gmsh_session import gmsh_session

if TYPE_CHECKING:
    from skfem import MeshTri


# Far more than any contact that can be solved.
_TOO_MANY = 100_000


@dataclass(frozen=True)
class Sizing:
    """Element size as a function of place.

    size = contact_size + growth_along max(0, abs(x) - core) + growth_deep abs(y), at most far_size, where x runs
    along the common tangent and y along the common normal from first touch. What happens at depth y varies over
    a length of the order of y, so the elements may grow with it without loss.

    Parameters
    ----------
    contact_size : float
        Element size at first touch [m].
    core : float
        Distance along the contact line over which `contact_size` is kept [m].
    zone : tuple of float
        Ends (x_start, x_end) of the zone in which contact is looked for, arc length from first touch [m].
    growth_along, growth_deep : float
        Growth of the element size per distance along the contact line and into the depth.
    far_size : float
        Largest element size [m].
    spots : tuple of (float, float)
        Further places on the contact line, such as rounded edges: arc length from first touch and the element size
        there [m]; the size grows from them along the contact line and into the depth as it does from first touch.

    Raises
    ------
    GeometryError
        If a size is not positive or the zone does not enclose first touch.

    Examples
    --------
    >>> import meshes
    >>> sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    >>> sizing.refined(2.0).contact_size
    1e-05
    """

    contact_size: float
    core: float
    zone: tuple[float, float]
    growth_along: float
    growth_deep: float
    far_size: float
    spots: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        for key in ("contact_size", "growth_along", "growth_deep", "far_size"):
            value = getattr(self, key)
            if not (math.isfinite(value) and value > 0):
                raise GeometryError(f"mesh {key} = {mm(value)}: must be positive and finite")
        if not self.zone[0] < 0 < self.zone[1]:
            raise GeometryError(
                f"mesh zone = {mm(self.zone[0])} to {mm(self.zone[1])}: must start below and end above zero"
            )
        if self.contact_size > self.far_size:
            raise GeometryError(
                f"mesh contact_size = {mm(self.contact_size)}: must not exceed far_size = {mm(self.far_size)}"
            )

    def contact_vertices(self, breaks: FloatArray | None = None) -> FloatArray:
        """Arc lengths of the contact line's vertices [m], zero among them, the same for both bodies.

        Each stretch is divided evenly in int dx / size(x), so that no element is larger than asked for.

        Parameters
        ----------
        breaks : ndarray, optional
            More places that must be vertices [m]; those outside the zone are left out.
        """
        start, end = self.zone
        stops = np.array([start, 0.0, end])
        if breaks is not None:
            # A break closer to a vertex than half an element would leave a sliver.
            distance = np.min(np.abs(np.subtract.outer(breaks, stops)), axis=1, initial=np.inf)
            is_free = (breaks > start) & (breaks < end) & (distance > 0.5 * self.size(breaks))
            stops = np.unique(np.concatenate([stops, breaks[is_free]]))
        return np.concatenate([[start], *(self._divide_stretch(a, b) for a, b in pairwise(stops.tolist()))])

    def size(self, x: FloatArray) -> FloatArray:
        """Element size on the contact line at x [m]."""
        x = np.asarray(x, dtype=float)
        size = self.contact_size + self.growth_along * np.maximum(0.0, np.abs(x) - self.core)
        for place, smallest in self.spots:
            size = np.minimum(size, smallest + self.growth_along * np.abs(x - place))
        return np.minimum(size, self.far_size)

    def _divide_stretch(self, a: float, b: float) -> FloatArray:
        """Vertices in (a, b], b the last."""
        # Away from the small elements the size grows in proportion to the distance: so do the steps.
        steps = np.concatenate([[0.0], np.geomspace(1e-3, 1e3, 600)])
        centres = [(-self.core, self.contact_size), (self.core, self.contact_size), *self.spots]
        around_spots = [
            place + side * size / self.growth_along * steps for place, size in centres for side in (-1, 1)
        ]
        x = np.unique(np.clip(np.concatenate([np.linspace(a, b, 401), *around_spots]), a, b))
        middle = 0.5 * (x[1:] + x[:-1])
        density, middle_density = 1 / self.size(x), 1 / self.size(middle)
        count = np.concatenate(
            [[0.0], np.cumsum(np.diff(x) * (density[:-1] + 4 * middle_density + density[1:]) / 6)]
        )
        elements = max(1, math.ceil(count[-1] * (1 - 1e-9)))
        if elements > _TOO_MANY:
            raise MeshingError(
                f"the contact line would need more than {_TOO_MANY} elements; use a larger contact size or edge radius"
            )
        inner = np.interp(np.arange(1, elements) * count[-1] / elements, count, x)
        return np.append(inner, b)

    def rounded(self, fixed: Collection[float], *, exact_size: bool = False) -> Sizing:
        """The same with three digits, so that round-off of the input, such as other units, leaves the mesh as it is.

        Parameters
        ----------
        fixed : collection of float
            Places on the contact line that stay, such as edges and ends of the faces: arc lengths [m].
        exact_size : bool
            Whether `contact_size` is given by somebody and stays.
        """
        spots = {
            (place if place in fixed else _three(size) * round(place / _three(size)), _three(size))
            for place, size in self.spots
        }
        start, end = (x if x in fixed else _three(x) for x in self.zone)
        return replace(
            self,
            contact_size=self.contact_size if exact_size else min(_three(self.contact_size), self.far_size),
            core=_three(self.core),
            zone=(max(start, min(fixed, default=start)), min(end, max(fixed, default=end))),
            growth_along=_three(self.growth_along),
            growth_deep=_three(self.growth_deep),
            spots=tuple(sorted(spots)),
        )

    def refined(self, factor: float) -> Sizing:
        """Same grading with every element size divided by `factor`; below 1 it coarsens."""
        return replace(
            self,
            contact_size=self.contact_size / factor,
            growth_along=self.growth_along / factor,
            growth_deep=self.growth_deep / factor,
            far_size=self.far_size / factor,
            spots=tuple((x, size / factor) for x, size in self.spots),
        )


def _three(size: float) -> float:
    """A number with three significant digits."""
    return float(f"{size:.2e}")


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
        return join_bodies([("closure", self.closure), ("seat", self.seat)])

    @property
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


def join_bodies(bodies: list[tuple[str, MeshTri]]) -> MeshTri:
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
