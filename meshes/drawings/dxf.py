"""Lines, arcs and curves of a DXF drawing."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from meshes.arrays import FloatArray
from meshes.errors import GeometryError
from meshes.geometry.biarcs import fitted
from meshes.geometry.segment import Segment, arc_pieces

# $INSUNITS of the header, in metres; 0 is "no unit". Those of landscapes and stars are left out.
_UNITS = {
    0: 1e-3,
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
) -> tuple[list[Segment], float]:
    """All pieces of a drawing's model space in (r, z) [m], in any order, and the length of its unit [m].

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
    unit = length_unit or _UNITS.get(drawing.units)
    if unit is None:
        raise GeometryError(
            f"{path.name}: its unit ($INSUNITS = {drawing.units}) is not known; give length_unit"
        )
    columns = np.array([1, 0] if axis == "x" else [0, 1])
    off, frozen = (
        {one.dxf.name.lower() for one in drawing.layers if hides(one)}
        for hides in (Layer.is_off, Layer.is_frozen)
    )

    def wanted(layers: tuple[str, ...]) -> bool:
        within = [one.lower() for one in layers]
        if layer is not None:
            return within[-1] == layer.lower()
        # A frozen block hides all that it holds, one that is switched off only what is on its own layer.
        return within[-1] not in off and frozen.isdisjoint(within)

    curves = [one for one in _simple(drawing.modelspace(), ()) if one[1].dxftype() in _CURVES]
    chosen = [entity for layers, entity in curves if wanted(layers)]
    if curves and not chosen:
        wrong = "all layers are switched off or frozen" if layer is None else f'layer = "{layer}": is empty'
        names = ", ".join(sorted({layers[-1] for layers, _ in curves}))
        raise GeometryError(f"{path.name}: {wrong}; layers with drawing are {names}")
    return [s for entity in chosen for s in _pieces(entity, unit, columns, tolerance)], unit


def _simple(entities: Iterable[Any], around: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Entities, polylines and blocks taken apart, with their layers from that of the outermost block inwards.

    What a block holds on layer "0" is on the layer of the block.
    """
    for entity in entities:
        own = entity.dxf.layer
        layers = (*around, around[-1] if around and own == "0" else own)
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
