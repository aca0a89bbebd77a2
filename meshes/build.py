"""From outlines and sizes to a mesh."""

from __future__ import annotations

import math
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshes.ball import Ball
from meshes.conical_seat import ConicalSeat
from meshes.contact_geometry import BallOnCone
from meshes.errors import GeometryError, MeshingError
from meshes.gmsh_session import gmsh_session
from meshes.outline import Outline
from meshes.seal_mesh import SealMesh
from meshes.sizing import Sizing

if TYPE_CHECKING:
    from skfem import MeshTri


def build(closure: Ball, seat: ConicalSeat, sizing: Sizing) -> SealMesh:
    """Mesh a ball in a conical seat.

    Parameters
    ----------
    closure : Ball
    seat : ConicalSeat
    sizing : Sizing

    Returns
    -------
    SealMesh

    Raises
    ------
    GeometryError
        If the ball does not touch the seat's face, or the zone does not fit on it.
    MeshingError
        If gmsh cannot be loaded or fails.
    """
    contact = BallOnCone(closure, seat.angle)
    _check_touch(contact, seat, sizing)
    x = sizing.contact_vertices
    outlines = (
        closure.outline(contact.centre_height, contact.polar_angle(x)),
        seat.outline(contact.touch_radius, x),
    )
    return SealMesh(
        triangulate(outlines, (contact.touch_radius, 0.0), contact.angle, sizing, closure.radius),
        contact,
        sizing,
        outlines,
    )


def _check_touch(contact: BallOnCone, seat: ConicalSeat, sizing: Sizing) -> None:
    r0 = contact.touch_radius
    if not seat.bore_radius < r0 < seat.face_radius:
        raise GeometryError(
            f"the ball of radius {contact.ball.radius:.6g} m would touch the cone at r = {r0:.6g} m, but the "
            f"seat's face reaches from {seat.bore_radius:.6g} m to {seat.face_radius:.6g} m only; change the "
            "radius, the angle or the bore and face radii"
        )
    r_start, r_end = contact.radius(np.array(sizing.zone))
    slack = 1e-9 * r0
    if (
        r_start < seat.bore_radius - slack
        or r_end > seat.face_radius + slack
        or sizing.zone[1] > contact.reach[1]
    ):
        raise GeometryError(
            f"the contact zone from r = {r_start:.6g} m to {r_end:.6g} m does not fit on the seat's face "
            f"({seat.bore_radius:.6g} m to {seat.face_radius:.6g} m) below the ball"
        )


def triangulate(
    outlines: tuple[Outline, ...], touch: tuple[float, float], angle: float, sizing: Sizing, scale: float
) -> MeshTri:
    """Mesh the outlines with straight triangles, graded from the contact line outwards.

    Parameters
    ----------
    outlines : tuple of Outline
        Sections of the bodies [m]; they share no node, even where they touch.
    touch : tuple of float
        Point (r, z) [m] around which the elements are small.
    angle : float
        Angle of the common tangent at `touch` from the r axis [rad].
    sizing : Sizing
    scale : float
        Length [m] that gmsh sees as 1, so that its absolute tolerances mean the same for every size of seal.

    Raises
    ------
    MeshingError
        If gmsh fails.
    """
    with gmsh_session("seal") as gmsh:
        groups = [_add_body(gmsh, outline, scale) for outline in outlines]
        _set_sizes(gmsh, touch, angle, sizing, scale)
        try:
            gmsh.model.mesh.generate(2)
        except Exception as error:  # gmsh raises plain Exception
            raise MeshingError(f"gmsh could not mesh the bodies: {error}") from error
        return _to_skfem(gmsh, outlines, groups, scale)


def _add_body(gmsh: ModuleType, outline: Outline, scale: float) -> dict[str, list[int]]:
    """Add one body; return the curve tags of each boundary, and the surface tag under the body's name."""
    geo = gmsh.model.geo
    points: dict[tuple[float, float], int] = {}

    def point(p: tuple[float, float]) -> int:
        if p not in points:
            points[p] = geo.addPoint(p[0] / scale, p[1] / scale, 0.0)
        return points[p]

    curves: dict[str, list[int]] = {}
    loop = []
    for s in outline.segments:
        start, end = point(s.start), point(s.end)
        curve = geo.addLine(start, end) if s.centre is None else geo.addCircleArc(start, point(s.centre), end)
        curves.setdefault(s.name, []).append(curve)
        loop.append(curve)
    surface = geo.addPlaneSurface([geo.addCurveLoop(loop)])
    geo.synchronize()
    for curve in curves[f"{outline.name}_contact"]:
        gmsh.model.mesh.setTransfiniteCurve(curve, 2)
    return {**curves, outline.name: [surface]}


def _set_sizes(
    gmsh: ModuleType, touch: tuple[float, float], angle: float, sizing: Sizing, scale: float
) -> None:
    dr, dz = f"(x-({touch[0] / scale:.17g}))", f"(y-({touch[1] / scale:.17g}))"
    cos, sin = f"({math.cos(angle):.17g})", f"({math.sin(angle):.17g})"
    along, deep = f"Fabs({dr}*{cos}+{dz}*{sin})", f"Fabs({dz}*{cos}-{dr}*{sin})"
    size = (
        f"{sizing.contact_size / scale:.17g}"
        f"+{sizing.growth_along:.17g}*Max(0,{along}-{sizing.core / scale:.17g})+{sizing.growth_deep:.17g}*{deep}"
    )
    grading = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(grading, "F", f"Min({size},{sizing.far_size / scale:.17g})")
    gmsh.model.mesh.field.setAsBackgroundMesh(grading)


def _to_skfem(
    gmsh: ModuleType, outlines: tuple[Outline, ...], groups: list[dict[str, list[int]]], scale: float
) -> MeshTri:
    from skfem import MeshTri

    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    index = np.full(int(tags.max()) + 1, -1)
    points = scale * coordinates.reshape(-1, 3)[:, :2]
    triangles, subdomains, lines = [], {}, {}
    count = 0
    for outline, entities in zip(outlines, groups, strict=True):
        for name, curves in entities.items():
            if name == outline.name:
                cells = _connectivity(gmsh, 2, curves)
                triangles.append(cells)
                subdomains[name] = np.arange(count, count + len(cells))
                count += len(cells)
            else:
                lines[name] = _connectivity(gmsh, 1, curves)
    used = np.unique(np.vstack(triangles))
    order = {int(tag): i for i, tag in enumerate(tags)}
    rows = np.array([order[int(tag)] for tag in used])
    index[used] = np.arange(len(used))
    mesh = MeshTri(np.ascontiguousarray(points[rows].T), np.ascontiguousarray(index[np.vstack(triangles)].T))
    facets = {tuple(sorted(pair)): i for i, pair in enumerate(mesh.facets.T.tolist())}
    boundaries = {
        name: np.array([facets[tuple(sorted(pair))] for pair in index[pairs].tolist()])
        for name, pairs in lines.items()
    }
    return mesh.with_boundaries(boundaries).with_subdomains(subdomains)


def _connectivity(gmsh: ModuleType, dimension: int, entities: list[int]) -> NDArray[np.int64]:
    parts = [gmsh.model.mesh.getElements(dimension, tag)[2][0] for tag in entities]
    return np.concatenate(parts).astype(np.int64).reshape(-1, dimension + 1)
