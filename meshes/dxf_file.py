"""Lines, arcs and curves of a DXF drawing."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from meshes.biarcs import FloatArray, fitted
from meshes.errors import GeometryError
from meshes.outline import Segment
from meshes.section_file import arc_pieces

# $INSUNITS of the header, in metres; 0 is "no unit".
_UNITS = {1: 0.0254, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0, 8: 2.54e-8, 9: 2.54e-5, 13: 1e-6, 14: 0.1}


def read_dxf(
    path: Path, axis: str, length_unit: float | None, layer: str | None, tolerance: float
) -> list[Segment]:
    """All pieces of a drawing's model space in (r, z) [m], in any order; see `meshes.section_file.read_section`.

    LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE, ELLIPSE, SPLINE and INSERT are read; POINT, texts, dimensions and hatches
    are passed over.

    Raises
    ------
    GeometryError
        If ezdxf is not installed or cannot read the file.
    """
    try:
        import ezdxf
        from ezdxf.lldxf.const import DXFError
    except ImportError as error:
        raise GeometryError(
            f"{path.name}: reading DXF needs ezdxf; install it with: pip install 'fem-seal[drawings]'"
        ) from error
    try:
        drawing = ezdxf.readfile(path)
    except (OSError, DXFError) as error:
        raise GeometryError(f"{path.name}: cannot be read as DXF ({error})") from error
    if axis not in ("x", "y"):
        raise GeometryError(f'{path.name}: axis = "{axis}": a DXF section is drawn in x and y')
    unit = length_unit or _UNITS.get(drawing.units, 1e-3)
    columns = np.array([1, 0] if axis == "x" else [0, 1])
    pieces: list[Segment] = []
    for entity in _simple(drawing.modelspace()):
        if layer is None or entity.dxf.layer.lower() == layer.lower():
            pieces.extend(_pieces(entity, unit, columns, tolerance))
    if not pieces and layer is not None:
        names = sorted({e.dxf.layer for e in drawing.modelspace()})
        raise GeometryError(
            f'{path.name}: layer = "{layer}": is empty; layers with drawing are {", ".join(names)}'
        )
    return pieces


def _simple(entities: Iterable[Any]) -> Iterator[Any]:
    """Entities with polylines and blocks taken apart."""
    for entity in entities:
        if entity.dxftype() in ("LWPOLYLINE", "POLYLINE", "INSERT"):
            yield from _simple(entity.virtual_entities())
        else:
            yield entity


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
    if kind in ("ELLIPSE", "SPLINE"):
        return _curve(entity, unit, columns, tolerance)
    return []


def _curve(entity: Any, unit: float, columns: Any, tolerance: float) -> list[Segment]:
    from ezdxf.math import BSpline

    tool = entity.construction_tool()
    spline = BSpline.from_ellipse(tool) if entity.dxftype() == "ELLIPSE" else tool

    def at(t: float) -> tuple[FloatArray, FloatArray]:
        point, tangent = next(iter(spline.derivatives([t], 1)))
        return (
            unit * np.array([point.x, point.y])[columns],
            np.array([tangent.x, tangent.y])[columns],
        )

    knots = np.unique(np.round(np.array(spline.knots()), 12))
    inside = knots[(knots >= 0) & (knots <= spline.max_t)]
    # A derivative at a knot belongs to what follows it: keep off by a hair at the end of each piece.
    hair = 1e-12 * spline.max_t
    return [
        s
        for a, b in pairwise(inside.tolist())
        if b - a > 1e-9 * spline.max_t
        for s in fitted(at, a, b - hair if b == inside[-1] else b, tolerance)
    ]
