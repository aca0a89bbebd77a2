"""Edges of a STEP file: a plane section, or a solid that is cut through its axis."""

from __future__ import annotations

import math
from pathlib import Path
from types import ModuleType

import numpy as np

from meshes.arrays import FloatArray
from meshes.drawings.profile import section_columns
from meshes.errors import GeometryError
from meshes.geometry.biarcs import fitted
from meshes.geometry.segment import Segment, arc_pieces
from meshes.gmsh_session import gmsh_session

_AXES = "xyz"

# A STEP file says its unit, and OpenCASCADE converts it to millimetres.
_UNIT = 1e-3


def read_step(path: Path, axis: str, tolerance: float) -> list[Segment]:
    """All edges of the section in (r, z) [m], in any order; see `meshes.drawings.section.read_section`.

    A solid is cut by the half-plane through the axis; faces and edges must lie in a plane through it.

    Raises
    ------
    GeometryError
        If the file is no STEP, or its section does not lie in a plane through the axis.
    Exception
        Whatever gmsh raises where OpenCASCADE cannot read the file; it may hang or crash as well.
    """
    text = path.read_bytes().lstrip()
    if not (text.startswith(b"ISO-10303-21") and b"END-ISO-10303-21" in text):
        raise GeometryError(
            f"{path.name}: cannot be read as STEP (it must begin with ISO-10303-21 and end with END-ISO-10303-21)"
        )
    with gmsh_session("step") as gmsh:
        shapes = gmsh.model.occ.importShapes(str(path))
        gmsh.model.occ.synchronize()
        if not shapes:
            raise GeometryError(f"{path.name}: holds no shapes")
        if max(dimension for dimension, _ in shapes) == 3:
            shapes = _cut(gmsh, shapes, axis)
        faces = [shape for shape in shapes if shape[0] == 2]
        curves = gmsh.model.getBoundary(faces, combined=True, oriented=False) if faces else shapes
        tags = [abs(tag) for dimension, tag in curves if dimension == 1]
        if not tags:
            raise GeometryError(f"{path.name}: holds no edges; a face or solid in it may be damaged")
        box = np.abs([gmsh.model.getBoundingBox(1, tag) for tag in tags]).max(axis=0)
        columns = section_columns(np.maximum(box[:3], box[3:]).tolist(), axis, path)
        return [s for tag in tags for s in _pieces(gmsh, tag, columns, tolerance)]


def _cut(gmsh: ModuleType, solids: list[tuple[int, int]], axis: str) -> list[tuple[int, int]]:
    """Section of solids with the half-plane through the axis."""
    occ = gmsh.model.occ
    box = np.array([gmsh.model.getBoundingBox(*solid) for solid in solids])
    low, high = box[:, :3].min(axis=0), box[:, 3:].max(axis=0)
    z = _AXES.index(axis)
    r = 1 if z == 0 else 0
    corners = np.zeros((4, 3))
    corners[:, z] = [low[z] - 1, high[z] + 1, high[z] + 1, low[z] - 1]
    corners[2:, r] = np.abs([low[r], high[r]]).max() + 1
    points = [occ.addPoint(*p) for p in corners.tolist()]
    lines = [occ.addLine(points[n], points[(n + 1) % 4]) for n in range(4)]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    section, _ = occ.intersect([(2, face)], solids)
    occ.synchronize()
    return [shape for shape in section if shape[0] == 2]


def _pieces(gmsh: ModuleType, tag: int, columns: list[int], tolerance: float) -> list[Segment]:
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, tag)

    def at(t: float) -> tuple[FloatArray, FloatArray]:
        point = np.array(gmsh.model.getValue(1, tag, [t]))
        return _UNIT * point[columns], np.array(gmsh.model.getDerivative(1, tag, [t]))[columns]

    (start, direction), (end, _) = at(low), at(high)
    kind = gmsh.model.getType(1, tag)
    if kind == "Line":
        return [Segment((float(start[0]), float(start[1])), (float(end[0]), float(end[1])), "")]
    if kind == "Circle":
        # The parameter is the angle; derivative and curvature lead to the centre.
        (curvature,) = gmsh.model.getCurvature(1, tag, [low])
        radius = _UNIT / curvature
        tangent = direction / math.hypot(*direction)
        normal = np.array([-tangent[1], tangent[0]])
        side = math.copysign(1.0, float(normal @ (at(low + 1e-3 * (high - low))[0] - start)))
        centre = start + side * radius * normal
        first = math.atan2(*(start - centre)[::-1])
        return arc_pieces((float(centre[0]), float(centre[1])), radius, first, side * (high - low))
    return fitted(at, low, high, tolerance)
