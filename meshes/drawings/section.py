"""The section of a body from a drawing: DXF, or STEP through OpenCASCADE."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from meshes.drawings.halved import profile_of
from meshes.drawings.profile import Profile
from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve
from meshes.geometry.segment import Point, Segment
from meshes.own_process import OwnProcessError, TimeLimitError, run_in_subprocess

# Ends this close, relative to the size of the drawing, are one point.
_JOINED = 1e-5

# More lines and arcs than this are no section of one body: every two of them are compared.
_MOST_PIECES = 5000
# Largest distance of a point from the origin [m]; what lies further away is a damaged number.
_LARGEST = 1e4

_FORMATS = {".dxf": "DXF", ".step": "STEP", ".stp": "STEP"}


def read_section(
    path: Path,
    name: str,
    *,
    axis: str = "y",
    length_unit: float | None = None,
    layer: str | None = None,
    tolerance: float = 1e-8,
    time_limit: float = 20.0,
) -> Profile:
    """Read the outline of one body, in a process of its own: damaged files make OpenCASCADE hang, crash and print.

    Parameters
    ----------
    path : pathlib.Path
        ".dxf", ".step" or ".stp".
    name : str
        "closure" or "seat"; "gasket": the upper half of a symmetric section, as seat.
    axis : {"x", "y", "z"}
        Coordinate of the drawing along the axis of the seal; the other one of the section is r, and only the half at
        r >= 0 is drawn. "z" is for STEP.
    length_unit : float, optional
        Length of a DXF's unit [m]; what the file says unless given, millimetre if it says nothing. STEP always says it.
    layer : str, optional
        Layer of a DXF that holds the outline; unless given, all layers that are not switched off or frozen.
    tolerance : float
        Largest distance between splines or ellipses and the arcs that stand for them [m].
    time_limit : float
        Longest time that reading may take [s].

    Raises
    ------
    GeometryError
        If the file cannot be read, or not in time, or does not hold one closed outline.
    MeshingError
        If gmsh, which reads STEP, cannot be loaded.

    Examples
    --------
    >>> import meshes
    >>> from pathlib import Path
    >>> seat = meshes.read_section(Path("examples/seat.dxf"), "seat", layer="SEAT")     # doctest: +SKIP
    """
    kind = _FORMATS.get(path.suffix.lower())
    if kind is None:
        raise GeometryError(f"{name} file {path.name}: must end with .dxf, .step, .stp or .msh")
    try:
        return run_in_subprocess(time_limit, _section, path, name, axis, length_unit, layer, tolerance)
    except OwnProcessError as error:
        longer = ", or allow a longer time_limit" if isinstance(error, TimeLimitError) else ""
        raise GeometryError(
            f"{path.name}: cannot be read as {kind} ({error}); open it in a CAD program and export it anew{longer}"
        ) from error


def _section(
    path: Path, name: str, axis: str, length_unit: float | None, layer: str | None, tolerance: float
) -> Profile:
    """What `read_section` returns, by this process."""
    try:
        from meshes.drawings.curves import read_dxf, read_step

        if path.suffix.lower() == ".dxf":
            pieces, unit = read_dxf(path, axis, length_unit, layer, tolerance)
        else:
            pieces, unit = read_step(path, axis, tolerance), None
    except GeometryError as error:
        # a curve does not know the file that it is from
        raise error if str(error).startswith(path.name) else GeometryError(f"{path.name}: {error}") from error
    _check_pieces(pieces, path)
    return profile_of(name, _loop(pieces, path), unit)


def _check_pieces(pieces: list[Segment], path: Path) -> None:
    """Refuse what no drawing of a body holds, before anything is calculated with it."""
    if len(pieces) > _MOST_PIECES:
        raise GeometryError(
            f"{path.name}: holds {len(pieces)} lines and arcs, allowed are {_MOST_PIECES}; draw the section of one "
            "body alone, or allow a larger tolerance for its splines"
        )
    for s in pieces:
        for r, z in (s.start, s.end, s.centre or s.start):
            # not a number is not smaller, either
            if not math.hypot(r, z) < _LARGEST:
                raise GeometryError(
                    f"{path.name}: holds a point at ({mm(r)}, {mm(z)}), which is no place of a seal; a number of the "
                    "file is damaged, or its unit is wrong"
                )


def _loop(pieces: list[Segment], path: Path) -> list[Segment]:
    """The pieces in order, each starting where the one before ends."""
    if all(s.start == s.end for s in pieces):
        raise GeometryError(f"{path.name}: holds no lines, arcs or curves")
    size = max(max(abs(c) for p in (s.start, s.end) for c in p) for s in pieces)
    first, *rest = _once(pieces, _JOINED * size)
    loop = [first]
    while rest:
        at = loop[-1].end
        near = min(rest, key=lambda s: min(math.dist(at, s.start), math.dist(at, s.end)))
        apart = min(math.dist(at, near.start), math.dist(at, near.end))
        if apart > _JOINED * size:
            if math.dist(at, loop[0].start) <= _JOINED * size:
                raise GeometryError(
                    f"{path.name}: holds more than one outline, {len(rest)} pieces are left beside the first; draw one "
                    "body alone, on a layer of its own"
                )
            raise GeometryError(
                f"{path.name}: the outline is open, nothing continues within {mm(_JOINED * size)} of (r, z) = "
                f"({mm(at[0])}, {mm(at[1])})"
            )
        rest.remove(near)
        if math.dist(at, near.start) > math.dist(at, near.end):
            near = near.reversed
        loop.append(replace(near, start=at))
    if math.dist(loop[-1].end, loop[0].start) <= _JOINED * size:
        loop[-1] = replace(loop[-1], end=loop[0].start)
    return loop


def _once(pieces: list[Segment], apart: float) -> list[Segment]:
    """The pieces without mere points and without those that lie on one before, both of which drawings hold unseen."""
    kept: list[tuple[Segment, Point]] = []
    for s in (s for s in pieces if s.start != s.end):
        curve = Curve((s,))
        r, z = curve.point(np.array(0.5 * curve.length)).tolist()
        if not any(
            math.dist(middle, (r, z)) <= apart and max(map(math.dist, ends, (s.start, s.end))) <= apart
            for one, middle in kept
            for ends in ((one.start, one.end), (one.end, one.start))
        ):
            kept.append((s, (r, z)))
    return [s for s, _ in kept]
