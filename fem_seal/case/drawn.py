"""The shape "profile" of closure, seat and gasket: an outline in the case file, a drawing, or a mesh."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from fem_seal.case.fields import Place, Quantity, Table
from fem_seal.case.material_table import MaterialField
from fem_seal.case.shapes import Body, Closure, Gasket, HeldSeat
from fem_seal.errors import Problem
from fem_seal.files import MOST_BYTES_OF_DRAWING, UnreadableFileError, check_file, problem
from leak.extras import say_missing
from meshes import GeometryError, MeshedBody, Profile, Segment, Shape, read_section
from meshes.drawings.half_section import profile_of
from meshes.errors import mm
from meshes.geometry.curve import Point

_PLACE = Place(Quantity("length", "-10 m", "10 m"))
_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254}
_DRAWINGS, _MESHES = (".dxf", ".step", ".stp"), (".msh",)


class Piece(Table):
    """A line or an arc of an outline, from the end of the one before to here."""

    to: Annotated[tuple[float, float], _PLACE]
    centre: Annotated[tuple[float, float], _PLACE] | None = None
    radius: Annotated[float, Quantity("length", "-10 m", "10 m")] | None = None
    name: Literal["face", "chamber", "inner", "outer", "top", "axis", "cavity", "wall", "bottom"] | None = (
        None
    )


class ProfileSource(Body):
    """A body whose outline is written out or comes from a file, in place of one that is made from its dimensions."""

    part: ClassVar[str]
    """Its table: "closure", "seat" or "gasket"."""
    outline: list[Piece] | None = None
    file: str | None = None
    axis: Literal["x", "y", "z"] = "y"
    length_unit: Literal["m", "cm", "mm", "um", "in"] | None = None
    layer: str | None = None
    tolerance: Annotated[float, Quantity("length", "0.1 nm", "1 mm")] | None = None
    joint_gap: Annotated[float, Quantity("length", "0.1 nm", "10 mm")] | None = None
    time_limit: Annotated[float, Quantity("time", "1 s", "1 h")] | None = None

    def problems(self) -> Iterator[Problem]:
        """What is wrong with the support or the source of the outline."""
        yield from super().problems()
        name = self.part
        if (self.outline is None) == (self.file is None):
            which = "neither is given" if self.file is None else "both are given"
            yield Problem(f"{name}.outline", f"outline or file is needed, but {which}")
            return
        if self.file is None:
            return
        kind = Path(self.file).suffix.lower()
        kinds = _DRAWINGS if name == "gasket" else (*_DRAWINGS, *_MESHES)
        if kind not in kinds:
            endings = ", ".join(kinds)
            yield Problem(f"{name}.file", f"must end with {endings}", f'"{Path(self.file).name}"')
        else:
            try:
                check_file(self.file, MOST_BYTES_OF_DRAWING)
            except UnreadableFileError as error:
                yield Problem(f"{name}.file", str(error), f'"{self.file}"')
        if self.layer is not None and kind != ".dxf":
            yield Problem(f"{name}.layer", "only for a .dxf; remove it", f'"{self.layer}"')
        for key in ("tolerance", "joint_gap"):
            if getattr(self, key) is not None and kind in _MESHES:
                yield problem("key_of_curves", body=name, key=key, value=1e9 * getattr(self, key))
        if self.length_unit is not None and kind in (".step", ".stp"):
            yield Problem(f"{name}.length_unit", "a .step says its unit; remove it", f'"{self.length_unit}"')

    def make_shape(self, **neighbours: Shape) -> Shape:
        """The body that is meshed, or is a mesh already."""
        if self.outline is not None:
            return _build_outline(self.part, self.outline)
        assert self.file is not None  # `problems` has looked
        name, path = self.part, Path(self.file)
        unit = _UNITS[self.length_unit] if self.length_unit else None
        curve = {"layer": self.layer, "tolerance": self.tolerance or 1e-8, "joint_gap": self.joint_gap}
        both = {"axis": self.axis, "length_unit": unit, "time_limit": self.time_limit or 20.0}
        shape = _read(path, path.stat().st_mtime_ns, name, **both, **curve)
        if isinstance(shape, GeometryError):
            raise shape
        return shape


# A file that cannot be read is kept as well: every design of a study would wait for its time limit anew.
@lru_cache(maxsize=16)
def _read(
    path: Path,
    time_of_change: int,
    name: str,
    *,
    axis: Any,
    length_unit: float | None,
    time_limit: float,
    **curve: Any,
) -> Shape | GeometryError:
    if path.suffix.lower() == ".dxf" and find_spec("ezdxf") is None:
        remedy = say_missing("drawings", ImportError(name="ezdxf"))
        return GeometryError(f'{name} file = "{path.name}": reading it {remedy}')
    try:
        both: dict[str, Any] = {"axis": axis, "time_limit": time_limit}
        if path.suffix.lower() in _MESHES:
            return MeshedBody.read(path, name, length_unit=length_unit or 1.0, **both)
        return read_section(path, name, length_unit=length_unit, **curve, **both)
    except GeometryError as error:
        # at the key of the file, where the message begins with the file's name
        _, name_of_file, what = str(error).partition(f"{path.name}: ")
        return GeometryError(f'{name} file = "{path.name}": {what}') if name_of_file else error


def _build_outline(name: str, pieces: list[Piece]) -> Profile:
    segments = []
    for n, (previous, piece) in enumerate(pairwise(pieces), start=2):
        entry = f"{name} outline: entry {n}"
        if previous.to == piece.to:
            raise GeometryError(f"{entry} ends where it begins")
        centre = piece.centre
        if piece.radius is not None:
            if centre is not None:
                raise GeometryError(f"{entry} has centre and radius; remove one of them")
            centre = _centre(entry, previous.to, piece.to, piece.radius)
        if centre is not None:
            start_radius, end_radius = math.dist(centre, previous.to), math.dist(centre, piece.to)
            if abs(start_radius - end_radius) > 1e-6 * max(start_radius, end_radius):
                ends = f"begins {mm(start_radius)} from its centre, but ends {mm(end_radius)} from it"
                raise GeometryError(f"{entry} {ends}")
        segments.append(Segment(previous.to, piece.to, piece.name or "", centre))
    return profile_of(name, segments)


def _centre(entry: str, start: Point, end: Point, radius: float) -> Point:
    """Centre of an arc between two points."""
    chord = math.dist(start, end)
    if abs(radius) <= 0.5 * chord:
        raise GeometryError(
            f"{entry} has radius = {mm(radius)}, but an arc of less than 180 deg between "
            f"points {mm(chord)} apart has more than {mm(0.5 * chord)}"
        )
    height = math.copysign(math.sqrt(radius**2 - 0.25 * chord**2), radius)
    normal = (start[1] - end[1]) / chord, (end[0] - start[0]) / chord
    return 0.5 * (start[0] + end[0]) + height * normal[0], 0.5 * (start[1] + end[1]) + height * normal[1]


class ClosureProfile(ProfileSource, Closure):
    """[closure] shape = "profile": a closure with any outline of lines and arcs."""

    part: ClassVar[str] = "closure"
    shape: Literal["profile"]
    material: MaterialField


class SeatProfile(ProfileSource, HeldSeat):
    """[seat] shape = "profile": a seat with any outline of lines and arcs."""

    part: ClassVar[str] = "seat"
    shape: Literal["profile"]


class GasketProfile(ProfileSource, Gasket):
    """[gasket] shape = "profile": a gasket with any symmetric section of lines and arcs, whole or its upper half."""

    part: ClassVar[str] = "gasket"
    shape: Literal["profile"]
    material: MaterialField
