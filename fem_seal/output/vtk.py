"""VTK files of bodies and contact line under each load, in metre and pascal.

Numbers are appended as raw bytes, uncompressed: the mantissas of a computed field do not compress. meshio, which reads
these files, writes neither lines and surfaces nor field data, and pyvista takes longer to import than a run may.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fem_seal.bodies.fields import BodyField, ElastoplasticField
from fem_seal.files import write_bytes, write_text

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.seal.circumference import Circumference


BODIES = ("closure", "seat")
# Points of a contact line, how many each of its parts has, and what is known there.
_Line: TypeAlias = "tuple[FloatArray, list[int], dict[str, FloatArray]]"
# Most angles of a surface around the axis.
_ANGLES = 720


def write_contact(result: SealSolution, folder: Path) -> list[Path]:
    """Write contact.pvd and one contact_000.vtu per load: both bodies with displacement and stress.

    Names end in the unit. Point data: ``displacement_m``, the closure's rigid motion since first touch included,
    ``stress_Pa`` as XX YY ZZ XY YZ XZ with x = r, y = z, z = hoop, ``von_mises_Pa``, ``contact_pressure_Pa`` on the
    contact line, zero elsewhere. Where a body yields also ``plastic_strain``, as the stress and as a tensor (XY is half
    the engineering shear strain), and ``accumulated_plastic_strain``, zero in a body that is elastic. Cell data:
    ``body``, 0 for the closure and 1 for the seat. A gasket is whole: both its halves are body 1, and the lower flange
    is body 2.

    Returns
    -------
    list of pathlib.Path
        The files written, contact.pvd first.
    """
    levels = _mid_planes(result)

    def write_load(load: CaseLoad, path: Path) -> Path:
        solved = [(part.contact.fields, part.contact.approach) for part in load.parts]
        return _write_bodies(solved, _load_data(load), levels, path)

    return write_loads(result, folder, "contact", "vtu", write_load)


def write_contact_line(result: SealSolution, folder: Path) -> list[Path]:
    """Write contact_line.pvd and one contact_line_000.vtp per load: the pressure profile as a line.

    Point data: ``x_m``, arc length from first touch, ``contact_pressure_Pa``, ``gap_m``, where it is known
    ``bulk_strain_meridional``, ``bulk_strain_hoop`` and ``elastic_area_strain`` and, where a leak rate was calculated,
    ``fluid_pressure_in_gap_Pa``. Of a gasket the lower half of the points are the line on its lower face.

    Returns
    -------
    list of pathlib.Path
        The files written, contact_line.pvd first.
    """
    heights = [part.seal_mesh.contact.height for part in result.parts]
    levels = _mid_planes(result)

    def line_of(load: CaseLoad, height: Callable[[FloatArray], FloatArray]) -> _Line:
        profiles = load.profiles
        x, radius, pressure, gap = (
            np.concatenate([getattr(profile, name) for profile in profiles])
            for name in ("x", "radius", "pressure", "gap")
        )
        data = {"x_m": x, "contact_pressure_Pa": pressure, "gap_m": gap}
        strain = load.whole_profile.strain
        if strain is not None:
            data |= zip(
                ("bulk_strain_meridional", "bulk_strain_hoop", "elastic_area_strain"), strain.T, strict=True
            )
        if load.gap_pressure is not None:
            data["fluid_pressure_in_gap_Pa"] = load.gap_pressure
        return _in_space(np.column_stack([radius, height(x)])), [len(profile.x) for profile in profiles], data

    def write_load(load: CaseLoad, path: Path) -> Path:
        lines = list(map(line_of, load.parts, heights))
        points, ends, data = lines[0]
        if levels:
            below, ends_below, data_below = lines[-1]
            points, ends = np.concatenate([points, _mirror_points(below, *levels)]), ends + ends_below
            data = {name: np.concatenate([values, data_below[name]]) for name, values in data.items()}
        return write_cells(
            path,
            "Lines",
            points,
            np.arange(len(points)),
            np.cumsum(ends),
            point_data=data,
            field_data=_load_data(load),
        )

    return write_loads(result, folder, "contact_line", "vtp", write_load)


def write_around(result: SealSolution, folder: Path) -> list[Path]:
    """Write around.pvd and one around_000.vtp per load of a seal that is not round: the seat's face around the axis.

    A load has the same number as in the other series.

    x, y, z in space, z the axis; the angle goes from x to y. Point data: ``x_m``, arc length from first touch,
    ``angle_rad``, ``contact_pressure_Pa``, ``gap_m``, ``gap_change_m``, what the form error adds to the gap,
    ``local_line_load_N_per_m`` and, where it is known, ``leak_rate_m3_per_s_per_rad``, with asperities that yield also
    ``leak_rate_capped_m3_per_s_per_rad``, the same all along x. The numbers are in single precision. Of a gasket it is
    the upper face.

    Returns
    -------
    list of pathlib.Path
        The files written, around.pvd first; none, and those of an earlier run are removed, for a round seal.
    """
    height = result.seal_mesh.contact.height

    def write_load(load: CaseLoad, path: Path) -> Path | None:
        if load.around is None:
            return None
        points, quads, data = _around_the_axis(load, load.around, height)
        ends = 4 * np.arange(1, len(quads) + 1)
        return write_cells(
            path, "Polys", points, quads.ravel(), ends, point_data=data, field_data=_load_data(load)
        )

    return write_loads(result, folder, "around", "vtp", write_load)


def write_loads(
    result: SealSolution,
    folder: Path,
    stem: str,
    suffix: str,
    write_load: Callable[[CaseLoad, Path], Path | None],
) -> list[Path]:
    """Write a file for each load that has one, and their series; files of an earlier run are removed.

    A viewer would mix the two runs. The time is the fluid pressure [Pa], or the number of the load where pressure does
    not rise throughout.

    Parameters
    ----------
    result : SealSolution
    folder : pathlib.Path
    stem, suffix : str
        Of the names of the files.
    write_load : callable
        Writes the file of a load to a path; None where it has none.
    """
    loads = result.loads
    pressures = [load.fluid_pressure for load in loads]
    rising = all(a < b for a, b in pairwise(pressures))
    digits = max(3, len(str(len(loads) - 1)))
    written: dict[Path, float] = {}
    for number, load in enumerate(loads):
        path = write_load(load, folder / f"{stem}_{number:0{digits}}.{suffix}")
        if path is not None:
            written[path] = load.fluid_pressure if rising else float(number)
    for path in folder.iterdir():
        if re.fullmatch(rf"{stem}_\d{{3,}}\.{suffix}", path.name) and path not in written:
            path.unlink()
    series = folder / f"{stem}.pvd"
    if not written:
        series.unlink(missing_ok=True)
        return []
    return [write_series(series, [path.name for path in written], list(written.values())), *written]


def _around_the_axis(
    load: CaseLoad, around: Circumference, height: Callable[[FloatArray], FloatArray]
) -> tuple[NDArray[np.float32], NDArray[np.int64], dict[str, NDArray[np.float32]]]:
    """Points, quadrilaterals and point data of the seat's face, closed around the axis."""
    step = math.ceil(len(around.angle) / _ANGLES)
    pressure, gap = around.pressure_and_gap(step)
    line, angle = around.local.mean.model.line, around.angle[::step]
    shape = pressure.shape
    r, z = line.radius, height(line.x)
    points = np.stack(
        [np.outer(np.cos(angle), r), np.outer(np.sin(angle), r), np.broadcast_to(z, shape)], axis=2
    )
    number = np.arange(pressure.size).reshape(shape)
    onwards = np.roll(number, -1, axis=0)
    # corners of each quadrilateral counterclockwise, seen from the closure
    corners = number[:, :-1], number[:, 1:], onwards[:, 1:], onwards[:, :-1]
    data = {"x_m": line.x, "contact_pressure_Pa": pressure, "gap_m": gap}
    of_angle = {
        "angle_rad": angle,
        "gap_change_m": around.gap_change[::step],
        "local_line_load_N_per_m": around.line_load[::step],
    }
    read = {"": load, **{f"_{name}": scenario for name, scenario in load.others.items()}}
    for name, values in read.items():
        if values.around is not None and values.around.leak_rate is not None:
            of_angle[f"leak_rate{name}_m3_per_s_per_rad"] = values.around.leak_rate[::step]
    data |= {name: values[:, None] for name, values in of_angle.items()}
    with np.errstate(under="ignore"):
        single = {
            name: np.broadcast_to(values, shape).astype(np.float32).ravel() for name, values in data.items()
        }
        return points.reshape(-1, 3).astype(np.float32), np.stack(corners, axis=2).reshape(-1, 4), single


def write_unloaded(result: SealSolution, folder: Path) -> Path | None:
    """Write unloaded.vtu: both bodies after the last load, with residual stress and permanent displacement.

    Point data as in `write_contact`, and a gasket whole as there; ``displacement_m`` is the permanent one, including
    that of a press fit. If both bodies are elastic, none is written, and an unloaded.vtu of an earlier run is removed.
    """
    path = folder / "unloaded.vtu"
    unloaded = [part.unloaded_bodies for part in result.parts if part.unloaded_bodies is not None]
    if len(unloaded) < len(result.parts):
        path.unlink(missing_ok=True)
        return None
    return _write_bodies([(after.fields, 0.0) for after in unloaded], {}, _mid_planes(result), path)


def _write_bodies(
    solved: Sequence[tuple[Mapping[str, BodyField], float]],
    load: Mapping[str, NDArray[np.generic]],
    levels: Sequence[float],
    path: Path,
) -> Path:
    """Write both bodies, of a gasket with the images of those of the last part below its mid-plane.

    Of each part its fields and approach [m].
    """
    of_parts = [[_move_to_place(fields[name], approach) for name in BODIES] for fields, approach in solved]
    bodies, numbers, alike = of_parts[0], [0, 1], bool(levels) and len(of_parts) == 1
    if levels:
        if alike:
            bodies = of_parts[0] = [bodies[0], _without_shear(bodies[1], levels[0])]
        bodies = bodies + [_image(body, *levels) for body in of_parts[-1]]
        numbers += [2, 1]
    starts = np.cumsum([0, *(len(body.points) for body in bodies)])
    kept = np.ones(starts[-1], dtype=bool)
    if alike:
        # both halves of the gasket share the points of the mid-plane
        shared = np.flatnonzero(_on_level(bodies[1].points, levels[0]))
        kept[starts[3] + shared] = False
    place = np.cumsum(kept) - 1
    if alike:
        place[starts[3] + shared] = place[starts[1] + shared]
    cells = np.concatenate([body.triangles6 + start for body, start in zip(bodies, starts, strict=False)])

    def all_of(values: Callable[[BodyField], FloatArray]) -> FloatArray:
        return np.concatenate([values(body) for body in bodies])[kept]

    return write_cells(
        path,
        "Cells",
        _in_space(all_of(lambda body: body.points)),
        place[cells].ravel(),
        6 * np.arange(1, len(cells) + 1),
        point_data={
            "displacement_m": _in_space(all_of(lambda body: body.displacement)),
            "stress_Pa": _symmetric_tensor(all_of(lambda body: body.stress)),
            "von_mises_Pa": all_of(lambda body: body.von_mises),
            "contact_pressure_Pa": all_of(lambda body: body.contact_pressure),
            **{name: values[kept] for name, values in (_plastic(bodies) | _temperature(bodies)).items()},
        },
        cell_data={
            "body": np.repeat(np.array(numbers, dtype=np.int32), [len(body.triangles6) for body in bodies])
        },
        field_data=load,
    )


def _mid_planes(result: SealSolution) -> list[float]:
    """Height of the mid-plane of a gasket in its upper and in its lower half [m]; empty of any other seal."""
    if result.problem.faces == 1:
        return []
    planes = [part.seal_mesh.contact.seat.extent[1][0] for part in result.parts]
    return [planes[0], planes[-1]]


def _on_level(points: FloatArray, level: float) -> NDArray[np.bool_]:
    """Which points (n, 2) lie on a level z, but for round-off [m]."""
    return np.abs(points[:, 1] - level) <= 1e-9 * np.abs(points).max()


def _mirror_points(points: FloatArray, level: float, own: float) -> FloatArray:
    """Points (n, 2 or 3) of a half with its mid-plane at its own z, below that of the other half at a level z [m]."""
    image = points.copy()
    image[:, 1] = level + own - image[:, 1]
    return image


# Vectors (r, z) and tensors (rr, zz, tt, rz) below the mid-plane.
_VECTOR, _TENSOR = np.array([1.0, -1.0]), np.array([1.0, 1.0, 1.0, -1.0])


def _scale_stress(body: BodyField, share: FloatArray) -> BodyField:
    """A body with a share of its stress and plastic strain (rr, zz, tt, rz)."""
    changed = replace(body, stress=share * body.stress)
    if isinstance(changed, ElastoplasticField):
        return replace(changed, plastic_strain=share * changed.plastic_strain)
    return changed


def _without_shear(body: BodyField, level: float) -> BodyField:
    """Half of a gasket whose mean with its image is free of shear on the mid-plane, as all of it is."""
    return _scale_stress(body, np.where(_on_level(body.points, level)[:, None], [1.0, 1.0, 1.0, 0.0], 1.0))


def _image(body: BodyField, level: float, own: float) -> BodyField:
    """The mirror image of a body, see `_mirror_points`."""
    return replace(
        _scale_stress(body, _TENSOR),
        points=_mirror_points(body.points, level, own),
        displacement=_VECTOR * body.displacement,
    )


def _temperature(bodies: Sequence[BodyField]) -> dict[str, FloatArray]:
    """Temperature of both bodies; nothing where it is not given."""
    temperatures = [body.temperature for body in bodies if body.temperature is not None]
    return {"temperature_K": np.concatenate(temperatures)} if len(temperatures) == len(bodies) else {}


def _plastic(bodies: Sequence[BodyField]) -> dict[str, FloatArray]:
    """Plastic strain of both bodies; nothing if both are elastic."""
    if not any(isinstance(body, ElastoplasticField) for body in bodies):
        return {}
    flows = [
        (body.plastic_strain, body.accumulated_plastic_strain)
        if isinstance(body, ElastoplasticField)
        else (np.zeros_like(body.stress), np.zeros(len(body.points)))
        for body in bodies
    ]
    strain, accumulated = (np.concatenate(parts) for parts in zip(*flows, strict=True))
    return {
        "plastic_strain": _symmetric_tensor(strain * [1.0, 1.0, 1.0, 0.5]),
        "accumulated_plastic_strain": accumulated,
    }


def _move_to_place(body: BodyField, approach: float) -> BodyField:
    """The body with its displacement to its true position, so that warped bodies show the gap."""
    rigid = -approach if body.name == "closure" else 0.0
    return replace(body, displacement=body.displacement + np.array([0.0, rigid]))


def _symmetric_tensor(stress: FloatArray) -> FloatArray:
    """(rr, zz, hoop, rz) as XX YY ZZ XY YZ XZ; there is no shear out of the (r, z) plane."""
    return np.column_stack([stress, np.zeros((len(stress), 2))])


def _in_space(values: FloatArray) -> FloatArray:
    """(r, z) as (x, y, 0)."""
    return np.column_stack([values, np.zeros(len(values))])


def _load_data(load: CaseLoad) -> dict[str, NDArray[np.generic]]:
    return {
        "fluid_pressure_Pa": np.array([load.fluid_pressure]),
        "contact_force_N": np.array([load.contact_force]),
        "line_load_N_per_m": np.array([load.line_load]),
        **({} if load.leak is None else {"leak_rate_m3_per_s": np.array([load.leak.leak_rate])}),
    }


# VTK's numbers of the cells of a grid.
_TRIANGLE, _QUADRATIC_TRIANGLE = 5, 22

Arrays = Mapping[str, NDArray[np.generic]]


def write_cells(
    path: Path,
    kind: Literal["Cells", "Lines", "Polys"],
    points: NDArray[np.floating],
    connectivity: NDArray[np.integer],
    offsets: NDArray[np.integer],
    *,
    point_data: Arrays,
    field_data: Arrays,
    cell_data: Arrays | None = None,
) -> Path:
    """Write cells of one kind, replacing `path` in one step.

    Parameters
    ----------
    path : pathlib.Path
    kind : {"Cells", "Lines", "Polys"}
        Triangles of a grid, linear or quadratic (.vtu), or lines or polygons (.vtp).
    points : ndarray, shape (n, 3)
        [m]
    connectivity : ndarray of int
        Points of one cell after the other, in VTK's order.
    offsets : ndarray of int, shape (m,)
        Where each cell ends in `connectivity`.
    point_data, field_data, cell_data : mapping of str to ndarray
        Named arrays, shape (n,) or (n, components); six components are a symmetric tensor XX YY ZZ XY YZ XZ.
    """
    chunks: list[bytes] = []

    def section(name: str, arrays: Arrays) -> str:
        """Append the bytes of the arrays; return the section that lists them."""
        tags = []
        for array, values in arrays.items():
            data = values.tobytes()
            number = values.dtype.name.capitalize().replace("Uint", "UInt")
            # a reader needs the number of tuples of an array without points
            tags.append(
                f'<DataArray type="{number}" Name="{array}" NumberOfTuples="{len(values)}" '
                f'NumberOfComponents="{values.shape[1] if values.ndim == 2 else 1}" '
                f'format="appended" offset="{sum(map(len, chunks))}"/>\n'
            )
            chunks.extend([len(data).to_bytes(8, sys.byteorder), data])
        return f"<{name}>\n{''.join(tags)}</{name}>\n"

    cells: dict[str, NDArray[np.generic]] = {
        "connectivity": connectivity.astype(np.int32),
        "offsets": offsets.astype(np.int32),
    }
    if kind == "Cells":
        kind_of_cell = _QUADRATIC_TRIANGLE if offsets[0] > 3 else _TRIANGLE
        cells["types"] = np.full(len(offsets), kind_of_cell, dtype=np.uint8)
    piece = (
        section(kind, cells)
        + section("PointData", point_data)
        + section("CellData", cell_data or {})
        + section("Points", {"Points": points})
    )
    dataset = "UnstructuredGrid" if kind == "Cells" else "PolyData"
    head = (
        f"{_head(dataset)}<{dataset}>\n{section('FieldData', field_data)}"
        f'<Piece NumberOfPoints="{len(points)}" NumberOf{kind}="{len(offsets)}">\n{piece}</Piece>\n'
        f'</{dataset}>\n<AppendedData encoding="raw">\n_'
    )
    return write_bytes(path, [head.encode(), *chunks, b"\n</AppendedData>\n</VTKFile>\n"])


def write_series(path: Path, files: Sequence[str], times: Sequence[float]) -> Path:
    """Write a .pvd that lists one file per time, replacing `path` in one step."""
    entries = "".join(
        f'<DataSet timestep="{time:.12g}" group="" part="0" file="{file}"/>\n'
        for file, time in zip(files, times, strict=True)
    )
    return write_text(path, f"{_head('Collection')}<Collection>\n{entries}</Collection>\n</VTKFile>\n")


def _head(kind: str) -> str:
    order = f"{sys.byteorder.capitalize()}Endian"
    return (
        '<?xml version="1.0"?>\n'
        f'<VTKFile type="{kind}" version="1.0" byte_order="{order}" header_type="UInt64">\n'
    )
