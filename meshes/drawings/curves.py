"""Lines, arcs and curves of a DXF drawing, and of a STEP file: a plane section, or a solid cut through its axis."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from meshes.arrays import FloatArray
from meshes.drawings.profile import section_columns
from meshes.errors import GeometryError
from meshes.geometry.biarcs import fit_arcs
from meshes.geometry.curve import Segment, arc_pieces
from meshes.gmsh_session import gmsh_session

# $INSUNITS of the header, in metres; 0 is "no unit". Those of landscapes and stars are left out.
_UNITS = {
    1: 0.0254,
    2: 0.3048,
    4: 1e-3,
    5: 1e-2,
    6: 1.0,
    7: 1e3,
    8: 2.54e-8,
    9: 2.54e-5,
    10: 0.9144,
    11: 1e-10,
    12: 1e-9,
    13: 1e-6,
    14: 0.1,
    15: 10.0,
    16: 100.0,
    21: 1200 / 3937,
    22: 100 / 3937,
    23: 3600 / 3937,
}

_CURVES = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE")


def read_dxf(
    path: Path, axis: str, length_unit: float | None, layer: str | None, tolerance: float
) -> tuple[list[Segment], float, float]:
    """All pieces of a drawing's model space in (r, z) [m], in any order, the length of its unit [m] and of a joint [m].

    A joint is as far as two ends that were one point may lie apart after the numbers of the file were rounded.

    LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE, ELLIPSE, SPLINE and INSERT are read; POINT, texts, dimensions and hatches
    are passed over. Without `layer`, so is what lies on layers that are switched off or frozen. For the parameters see
    `meshes.drawings.section.read_section`.

    Raises
    ------
    GeometryError
        If ezdxf is not installed or cannot read the file, or the unit of the file is not known.
    """
    try:
        import ezdxf
        from ezdxf import bbox
        from ezdxf.entities import Layer
        from ezdxf.lldxf.const import DXFError
    except ImportError as error:
        raise GeometryError(
            f"{path.name}: reading DXF needs the package ezdxf, which is not installed"
        ) from error
    try:
        drawing = ezdxf.readfile(path)
    except (OSError, DXFError) as error:
        raise GeometryError(f"{path.name}: cannot be read as DXF ({error})") from error
    if axis not in ("x", "y"):
        raise GeometryError(f'{path.name}: axis = "{axis}": a DXF section is drawn in x and y')
    columns = np.array([1, 0] if axis == "x" else [0, 1])
    off_layers, frozen_layers = (
        {entry.dxf.name.lower() for entry in drawing.layers if hides(entry)}
        for hides in (Layer.is_off, Layer.is_frozen)
    )

    def is_drawn(layers: tuple[str, ...]) -> bool:
        names = [name.lower() for name in layers]
        if layer is not None:
            return names[-1] == layer.lower()
        # A frozen block hides all that it holds, one that is switched off only what is on its own layer.
        return names[-1] not in off_layers and frozen_layers.isdisjoint(names)

    curves = [item for item in _simple(drawing.modelspace(), ()) if item[1].dxftype() in _CURVES]
    entities = [entity for layers, entity in curves if is_drawn(layers)]
    if curves and not entities:
        fault = "all layers are switched off or frozen" if layer is None else f'layer = "{layer}": is empty'
        names = ", ".join(sorted({layers[-1] for layers, _ in curves}))
        raise GeometryError(f"{path.name}: {fault}; layers with drawing are {names}")
    unit = length_unit or _UNITS.get(drawing.units)
    if unit is None:
        size = bbox.extents(entities, fast=True).size if entities else (0.0, 0.0)
        raise GeometryError(
            f"{path.name}: does not say its unit ($INSUNITS = {drawing.units}); the section is {size[0]:.4g} wide and "
            f'{size[1]:.4g} high: give length_unit, such as "mm" or "in"'
        )
    pieces = [s for entity in entities for s in _pieces(entity, unit, columns, tolerance)]
    return pieces, unit, unit * _find_rounding(drawing.entitydb.values())


def _find_rounding(entities: Iterable[Any]) -> float:
    """Largest distance of two ends of lines or arcs, in units of the file, that were one point before it was written.

    A program writes all numbers with as many digits, so that the longest ones tell how many.
    """
    numbers, angles, largest = [0.0], [0.0], 0.0
    for entity in entities:
        kind = entity.dxftype()
        if kind == "LINE":
            numbers += [*entity.dxf.start, *entity.dxf.end]
        elif kind in ("ARC", "CIRCLE"):
            numbers += [*entity.dxf.center, entity.dxf.radius]
            if kind == "ARC":
                angles += [entity.dxf.start_angle, entity.dxf.end_angle]
                largest = max(largest, entity.dxf.radius)
        elif kind == "LWPOLYLINE":
            numbers += [c for vertex in entity.vertices() for c in vertex]
        elif kind == "VERTEX":
            numbers += [*entity.dxf.location]
        elif kind == "SPLINE":
            numbers += [c for point in entity.control_points for c in point]
    # Half a digit of both coordinates of a centre and of the radius, for each of the two ends.
    return (1 + math.sqrt(2)) * _last_digit(numbers) + largest * math.radians(_last_digit(angles))


def _last_digit(numbers: Iterable[float]) -> float:
    exponents = (Decimal(repr(float(number))).as_tuple().exponent for number in numbers)
    return float(10.0 ** min(exponent for exponent in exponents if isinstance(exponent, int)))


def _simple(entities: Iterable[Any], outer_layers: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Entities, polylines and blocks taken apart, with their layers from that of the outermost block inwards.

    What a block holds on layer "0" is on the layer of the block.
    """
    for entity in entities:
        layer = entity.dxf.layer
        layers = (*outer_layers, outer_layers[-1] if outer_layers and layer == "0" else layer)
        if entity.dxftype() in ("LWPOLYLINE", "POLYLINE", "INSERT"):
            yield from _simple(entity.virtual_entities(), layers)
        else:
            yield layers, entity


def _pieces(entity: Any, unit: float, columns: Any, tolerance: float) -> list[Segment]:
    kind = entity.dxftype()

    def place(p: Any) -> tuple[float, float]:
        r, z = (unit * np.array([p[0], p[1]]))[columns].tolist()
        return r, z

    if kind == "LINE":
        start, end = place(entity.dxf.start), place(entity.dxf.end)
        return [Segment(start, end, "")] if start != end else []
    if kind in ("ARC", "CIRCLE"):
        # A drawing seen from below has its own coordinates; ocs() leads back.
        frame = entity.ocs()
        first = entity.dxf.start_angle if kind == "ARC" else 0.0
        sweep = (entity.dxf.end_angle - first) % 360 if kind == "ARC" else 360.0
        arcs = arc_pieces(
            (entity.dxf.center.x, entity.dxf.center.y),
            entity.dxf.radius,
            math.radians(first),
            math.radians(sweep or 360.0),
        )

        def world(p: tuple[float, float]) -> tuple[float, float]:
            return place(frame.to_wcs((p[0], p[1], entity.dxf.center.z)))

        return [Segment(world(s.start), world(s.end), "", world(s.centre)) for s in arcs if s.centre]
    return _curve(entity, unit, columns, tolerance)


def _curve(entity: Any, unit: float, columns: Any, tolerance: float) -> list[Segment]:
    from ezdxf.math import BSpline

    tool = entity.construction_tool()
    spline = BSpline.from_ellipse(tool) if entity.dxftype() == "ELLIPSE" else tool

    def at(t: float) -> tuple[FloatArray, FloatArray]:
        point, tangent = next(iter(spline.derivatives([t], 1)))
        return (unit * np.array([point.x, point.y])[columns], np.array([tangent.x, tangent.y])[columns])

    knots = np.unique(np.round(np.array(spline.knots()), 12))
    inner_knots = knots[(knots >= 0) & (knots <= spline.max_t)]
    # A derivative at a knot belongs to what follows it: keep off by a hair at the end of each piece.
    hair = 1e-12 * spline.max_t
    return [
        s
        for a, b in pairwise(inner_knots.tolist())
        if b - a > 1e-9 * spline.max_t
        for s in fit_arcs(at, a, b - hair if b == inner_knots[-1] else b, tolerance)
    ]


_AXES = "xyz"

# A STEP file says its unit, and OpenCASCADE converts it to millimetres.
_STEP_UNIT = 1e-3


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
            shapes = _cut_solids(gmsh, shapes, axis)
        faces = [shape for shape in shapes if shape[0] == 2]
        curves = gmsh.model.getBoundary(faces, combined=True, oriented=False) if faces else shapes
        tags = [abs(tag) for dimension, tag in curves if dimension == 1]
        if not tags:
            raise GeometryError(f"{path.name}: holds no edges; a face or solid in it may be damaged")
        box = np.abs([gmsh.model.getBoundingBox(1, tag) for tag in tags]).max(axis=0)
        columns = section_columns(np.maximum(box[:3], box[3:]).tolist(), axis, path)
        return [s for tag in tags for s in _edge(gmsh, tag, columns, tolerance)]


def _cut_solids(gmsh: ModuleType, solids: list[tuple[int, int]], axis: str) -> list[tuple[int, int]]:
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


def _edge(gmsh: ModuleType, tag: int, columns: list[int], tolerance: float) -> list[Segment]:
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, tag)

    def at(t: float) -> tuple[FloatArray, FloatArray]:
        point = np.array(gmsh.model.getValue(1, tag, [t]))
        return _STEP_UNIT * point[columns], np.array(gmsh.model.getDerivative(1, tag, [t]))[columns]

    (start, direction), (end, _) = at(low), at(high)
    kind = gmsh.model.getType(1, tag)
    if kind == "Line":
        return [Segment((float(start[0]), float(start[1])), (float(end[0]), float(end[1])), "")]
    if kind == "Circle":
        # The parameter is the angle; derivative and curvature lead to the centre.
        (curvature,) = gmsh.model.getCurvature(1, tag, [low])
        radius = _STEP_UNIT / curvature
        tangent = direction / math.hypot(*direction)
        normal = np.array([-tangent[1], tangent[0]])
        side = math.copysign(1.0, float(normal @ (at(low + 1e-3 * (high - low))[0] - start)))
        centre = start + side * radius * normal
        first = math.atan2(*(start - centre)[::-1])
        return arc_pieces((float(centre[0]), float(centre[1])), radius, first, side * (high - low))
    return fit_arcs(at, low, high, tolerance)
