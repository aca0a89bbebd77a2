"""The section of a body from a drawing: DXF, or STEP through OpenCASCADE."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from meshes.drawings.half_section import profile_of
from meshes.drawings.profile import Profile
from meshes.errors import GeometryError, mm
from meshes.geometry.curve import Curve, Point, Segment, as_point
from meshes.own_process import OwnProcessError, TimeLimitError, run_in_subprocess

# Ends this close, relative to the size of the drawing, are one point; those further apart than the second are none,
# however few digits the numbers have.
_JOINT, _WIDEST_JOINT = 1e-5, 3e-3

# More lines and arcs than this are no section of one body: every two of them are compared.
_MOST_PIECES = 5000
# Largest distance of a point from the origin [m]; what lies further away is a damaged number.
_FARTHEST = 1e4

_FORMATS = {".dxf": "DXF", ".step": "STEP", ".stp": "STEP"}


def read_section(
    path: Path,
    name: str,
    *,
    axis: str = "y",
    length_unit: float | None = None,
    layer: str | None = None,
    tolerance: float = 1e-8,
    joint_gap: float | None = None,
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
        Length of a DXF's unit [m]; what the file says unless given. STEP always says it.
    layer : str, optional
        Layer of a DXF that holds the outline; unless given, all layers that are not switched off or frozen.
    tolerance : float
        Largest distance between splines or ellipses and the arcs that stand for them [m].
    joint_gap : float, optional
        Largest gap between the ends of two pieces that is closed [m]; unless given, what the rounding of the numbers in
        a DXF leaves, at least 1e-5 of the drawing's size.
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
        return run_in_subprocess(
            time_limit, _section, path, name, axis, length_unit, layer, tolerance, joint_gap
        )
    except OwnProcessError as error:
        longer = ", or allow a longer time_limit" if isinstance(error, TimeLimitError) else ""
        raise GeometryError(
            f"{path.name}: cannot be read as {kind} ({error}); open it in a CAD program and export it anew{longer}"
        ) from error


def _section(
    path: Path,
    name: str,
    axis: str,
    length_unit: float | None,
    layer: str | None,
    tolerance: float,
    joint_gap: float | None,
) -> Profile:
    """What `read_section` returns, by this process."""
    unit, rounding = None, 0.0
    try:
        from meshes.drawings.curves import read_dxf, read_step

        if path.suffix.lower() == ".dxf":
            pieces, unit, rounding = read_dxf(path, axis, length_unit, layer, tolerance)
        else:
            pieces = read_step(path, axis, tolerance)
    except GeometryError as error:
        # a curve does not know the file that it is from
        raise error if str(error).startswith(path.name) else GeometryError(f"{path.name}: {error}") from error
    _check_pieces(pieces, path)
    size = max(max(abs(c) for p in (s.start, s.end) for c in p) for s in pieces)
    reach = joint_gap or max(_JOINT * size, min(rounding, _WIDEST_JOINT * size))
    loop = _loop(_drop_duplicates(pieces, _JOINT * size), reach, path)
    gaps = [math.dist(first.end, second.start) for first, second in _joints(loop)]
    widest = max((gap for gap in gaps if gap <= reach), default=0.0)
    return replace(profile_of(name, _join_pieces(loop, reach), unit, reach), joined=widest)


def _check_pieces(pieces: list[Segment], path: Path) -> None:
    """Refuse what no drawing of a body holds, before anything is calculated with it."""
    if all(s.start == s.end for s in pieces):
        raise GeometryError(f"{path.name}: holds no lines, arcs or curves")
    if len(pieces) > _MOST_PIECES:
        raise GeometryError(
            f"{path.name}: holds {len(pieces)} lines and arcs, allowed are {_MOST_PIECES}; draw the section of one "
            "body alone, or allow a larger tolerance for its splines"
        )
    for s in pieces:
        for r, z in (s.start, s.end, s.centre or s.start):
            # not a number is not smaller, either
            if not math.hypot(r, z) < _FARTHEST:
                raise GeometryError(
                    f"{path.name}: holds a point at ({mm(r)}, {mm(z)}), which is no place of a seal; a number of the "
                    "file is damaged, or its unit is wrong"
                )


def _loop(pieces: list[Segment], reach: float, path: Path) -> list[Segment]:
    """The pieces in order, each starting within a distance [m] of where the one before ends."""
    first, *others = pieces
    loop = [first]
    while others:
        at = loop[-1].end
        near = min(others, key=lambda s: min(math.dist(at, s.start), math.dist(at, s.end)))
        gap = min(math.dist(at, near.start), math.dist(at, near.end))
        if gap > reach:
            if math.dist(at, loop[0].start) <= reach:
                raise GeometryError(
                    f"{path.name}: holds more than one outline, {len(others)} pieces are left beside the first; draw "
                    "one body alone, on a layer of its own"
                )
            raise GeometryError(
                f"{path.name}: the outline is open at (r, z) = ({mm(at[0])}, {mm(at[1])}): the nearest end is "
                f"{mm(gap)} away, and ends are joined up to {mm(reach)}; close it in the drawing, or give a larger "
                "joint_gap"
            )
        others.remove(near)
        loop.append(near if math.dist(at, near.start) <= math.dist(at, near.end) else near.reversed)
    return loop


def _joints(loop: list[Segment]) -> Iterator[tuple[Segment, Segment]]:
    """Every piece with the one that follows it, the first one following the last."""
    return pairwise([*loop, loop[0]])


def _join_pieces(loop: list[Segment], reach: float) -> list[Segment]:
    """The pieces with ends that meet where they lie within a distance [m] of each other; arcs remain arcs."""
    meets = [
        _meeting_point(first, second, reach) if math.dist(first.end, second.start) <= reach else None
        for first, second in _joints(loop)
    ]
    return [
        _fit_piece(s, start or s.start, end or s.end)
        for s, start, end in zip(loop, [meets[-1], *meets[:-1]], meets, strict=True)
    ]


def _meeting_point(first: Segment, second: Segment, reach: float) -> Point:
    """Where two pieces meet: lines stay on their line, and their ends are nearer to the truth than those of arcs."""
    if first.end == second.start:
        return first.end
    if first.centre is None and second.centre is None:
        (r, z), (dr, dz) = first.end, np.subtract(first.end, first.start)
        next_dr, next_dz = np.subtract(second.end, second.start)
        cross = dr * next_dz - dz * next_dr
        if cross != 0:
            way = ((second.start[0] - r) * next_dz - (second.start[1] - z) * next_dr) / cross
            corner = (float(r + way * dr), float(z + way * dz))
            if max(math.dist(corner, first.end), math.dist(corner, second.start)) <= reach:
                return corner
    weight = 0.5 * (1 + (second.centre is None) - (first.centre is None))
    return as_point((1 - weight) * np.array(first.end) + weight * np.array(second.start))


def _fit_piece(s: Segment, start: Point, end: Point) -> Segment:
    """A piece turned and stretched so that it runs between two points."""
    if s.centre is None or (start, end) == (s.start, s.end):
        return replace(s, start=start, end=end)
    first, last, centre, new_first, new_last = (complex(*p) for p in (s.start, s.end, s.centre, start, end))
    new_centre = new_first + (centre - first) * (new_last - new_first) / (last - first)
    return replace(s, start=start, end=end, centre=(new_centre.real, new_centre.imag))


def _drop_duplicates(pieces: list[Segment], slack: float) -> list[Segment]:
    """The pieces without mere points and without those that lie on one before, both of which drawings hold unseen."""
    unique: list[tuple[Segment, Point]] = []
    for s in (s for s in pieces if s.start != s.end):
        curve = Curve((s,))
        r, z = curve.point(np.array(0.5 * curve.length)).tolist()
        if not any(
            math.dist(middle, (r, z)) <= slack and max(map(math.dist, ends, (s.start, s.end))) <= slack
            for other, middle in unique
            for ends in ((other.start, other.end), (other.end, other.start))
        ):
            unique.append((s, (r, z)))
    return [s for s, _ in unique]
