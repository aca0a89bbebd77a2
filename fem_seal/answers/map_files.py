"""Maps of the contact pressure in files of any finite-element program: triangles with a pressure at each node."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.point_surface import triangles_over
from fem_seal.answers.profile_files import (
    check_rows,
    column_roles,
    fluid_pressures,
    is_of_program,
    labelled_rows,
    load_in,
    on_one_curve,
    role_of,
)
from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.errors import InputError, QuantityError, TextTableError
from fem_seal.files import (
    MOST_BYTES_OF_SCAN,
    UnreadableFileError,
    check_file,
    column,
    drop_extremes,
    name_and_unit,
    problem,
    read_any_text,
)
from fem_seal.units import parse_quantity
from fem_seal.wording import Quantity, join_names
from leak.errors import TableError

if TYPE_CHECKING:
    from leak.text_tables import TextTable

# What VTK reads, and what meshio does.
_OF_VTK = (".vtu", ".vtp", ".vtk", ".vts", ".vtm", ".pvtu", ".pvd", ".vtkhdf", ".e", ".exo", ".ex2")
_OF_MESHIO = {".msh": "gmsh", ".med": "med", ".rmed": "med", ".xdmf": "xdmf"}
_OF_CALCULIX = ".frd"
_GAP = re.compile(r"(contact_?)?(gap|opening)(?![a-z])|copen|jeu(?![a-z])")
# What tells load steps apart at the end of a field's name.
_STEP = re.compile(
    r"([\W_]+((load_?)?(step|case)|frame|inc(rement)?|time|at|t)?[\W_]*\d[\d.]*(e[+-]?\d+)?[\W_]*(bar|[km]?pa|psi|s)?)+"
    r"[\W_]*$",
    re.IGNORECASE,
)
_BETWEEN_NAMES = re.compile(r",(?![^\[(]*[\])])")
# Shares: of the face, within which points are one; of the peak, tension that is rounding and scatter at one point.
_SAME_PLACE, _SLIGHT, _SAME_PRESSURE = 1e-7, 0.05, 0.2
# Values of a field that tells parts, at most; cosine between faces that go on with each other, 30 degrees.
_MOST_VALUES, _GOES_ON = 50, 0.866
# Nothing touches below [Pa]; sizes of a face [m]; times the hardness.
_LOWEST_PRESSURE, _SMALLEST, _LARGEST, _HARD = 1e-3, 1e-6, 1e4, 100.0
_USUAL = {"pressure": "MPa", "length": "mm"}


@dataclass(frozen=True)
class MapOptions:
    """What is said of a map beside its file.

    Parameters
    ----------
    field, gap : str, optional
        Names of the contact pressure and of the gap; found unless given.
    columns : str, optional
        Names and units of the columns of a table: of all in their order, or of some by their names in the file.
    pressure_unit, length_unit : str, optional
        Where the file has none.
    axis : {"x", "y", "z"}, optional
        Around which points of a table are unrolled; found unless given.
    """

    field: str | None = None
    gap: str | None = None
    columns: str | None = None
    pressure_unit: str | None = None
    length_unit: str | None = None
    axis: str | None = None


@dataclass(frozen=True, eq=False)
class PressureMap:
    """The contact pressure over a face, in load steps that share its triangles.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Nodes [m].
    triangles : ndarray, shape (t, 3)
        Nodes of each; sides that belong to one triangle are the edge of the face.
    pressure : ndarray, shape (steps, n)
        Contact pressure [Pa], not negative.
    gap : ndarray, shape (steps, n), or None
        Between the faces [m], not negative; None if the file has no such field.
    steps : tuple of str
        What the file calls the load steps.
    fluid_pressures : tuple of (float or None)
        That belong to them [Pa]; None where the file does not say.
    parts : mapping of str to ndarray, shape (n,)
        Nodes of named parts, "inlet", and of fields of whole numbers, "side = 2".
    remark : str
        What the file was taken for, a sentence.
    """

    points: FloatArray
    triangles: IntArray
    pressure: FloatArray
    gap: FloatArray | None
    steps: tuple[str, ...]
    fluid_pressures: tuple[float | None, ...]
    parts: Mapping[str, BoolArray] = field(default_factory=dict)
    remark: str = ""

    def of_nodes(self, nodes: IntArray, count: int, triangles: IntArray) -> PressureMap:
        """The same with other nodes: each of the old ones becomes part of one of them, or of none (-1)."""
        kept = nodes >= 0
        shares = np.bincount(nodes[kept], minlength=count)
        points = np.column_stack([np.bincount(nodes[kept], each[kept], count) for each in self.points.T])
        parts = {name: np.bincount(nodes[kept], mask[kept], count) > 0 for name, mask in self.parts.items()}
        return replace(
            self,
            points=points / shares[:, None],
            triangles=triangles,
            pressure=_mean_at(nodes, self.pressure, count),
            gap=None if self.gap is None else _mean_at(nodes, self.gap, count),
            parts={name: mask for name, mask in parts.items() if mask.any()},
        )


def is_map(file: str | Path, columns: str | None = None) -> bool:
    """Whether a file holds points over a surface, rather than along one meridian; one that cannot be read does not.

    Parameters
    ----------
    file : path
    columns : str, optional
        See `MapOptions`.

    Examples
    --------
    >>> is_map("wedge.vtu"), is_map("no such file.csv")
    (True, False)
    """
    from leak.text_tables import read_tables

    if Path(file).suffix.lower() in (*_OF_VTK, *_OF_MESHIO, _OF_CALCULIX):
        return True
    try:
        table = _with_names(read_tables(read_any_text(file))[0], columns)
        roles = column_roles(table)
    except (TableError, TextTableError):
        return False
    if any(np.ptp(table.values[:, place]) > 0.0 for place in roles.get("angle", ())):
        return True
    coords = [table.values[:, roles[role][0]] for role in ("x", "y", "z") if role in roles]
    if len(coords) < 2 or "arc" in roles or "radius" in roles:
        return False
    # some programs call compression negative
    pressure = np.abs(table.values[:, roles["pressure"]]).max(axis=1)
    mask = pressure > 1e-3 * pressure.max()
    return not on_one_curve(*(coord[mask] for coord in coords))


def read_map(
    file: str | Path, options: MapOptions | None = None, hardness: float | None = None
) -> PressureMap:
    """The map of a contact pressure in a mesh or a table of points.

    Parameters
    ----------
    file : path
        A mesh with the field on its points or cells, or a table with a header, see `leak.text_tables.read_tables`.
        Quadratic and four-sided cells become triangles. Of a volume mesh its faces in contact are taken: where all
        points have the field, or, of fields that are zero beside the contact, where it is not zero in any step, and the
        faces beside these that go on with them without an edge.
    options : MapOptions, optional
    hardness : float, optional
        Of the softer body [Pa]; a pressure above 100 times of it is one in another unit.

    Raises
    ------
    InputError
        If the file holds no such map, or does not say its units.
    """
    options = options or MapOptions()
    try:
        check_file(file, MOST_BYTES_OF_SCAN)
        is_mesh = Path(file).suffix.lower() in (*_OF_VTK, *_OF_MESHIO, _OF_CALCULIX)
        found = _of_mesh(Path(file), options) if is_mesh else _of_tables(file, options)
        return _checked(found, hardness)
    except (TableError, TextTableError, QuantityError, UnreadableFileError) as error:
        raise InputError.at("", str(error), file=file) from None


# --- any map ------------------------------------------------------------------------------------------------


def _checked(found: PressureMap, hardness: float | None) -> PressureMap:
    """Without tension and places that have no pressure in a step; TextTableError if the numbers cannot be right."""
    size = float(np.ptp(found.points, axis=0).max())
    if not _SMALLEST < size < _LARGEST:
        raise TextTableError(problem("map_size", size=str(Quantity(size, ".4g mm"))))
    pressure, remark = np.nan_to_num(found.pressure, nan=0.0), found.remark
    if pressure.max() <= 0.0 > pressure.min():
        pressure, remark = -pressure, f"{remark}; compression is negative there"
    if not pressure.max() > _LOWEST_PRESSURE:
        raise TextTableError(problem("map_no_contact"))
    worst = -float(pressure.min()) / float(pressure.max())
    if worst > _SLIGHT:
        raise TextTableError(problem("map_tension", lowest=float(pressure.min()), peak=float(pressure.max())))
    if worst > 0.0:
        count = int((pressure < 0.0).any(axis=0).sum())
        remark += f"; {count} points with tension, up to {worst:.2g} of the peak, set to zero"
    if hardness is not None and pressure.max() > _HARD * hardness:
        raise TextTableError(problem("map_hardness", peak=float(pressure.max()), hardness=hardness))
    gap = None if found.gap is None else np.maximum(np.nan_to_num(found.gap, nan=0.0), 0.0)
    return replace(found, pressure=np.maximum(pressure, 0.0), gap=gap, remark=remark)


def _only(found: PressureMap, triangles: IntArray) -> PressureMap:
    """With these triangles, and the nodes that they have."""
    used, corners = np.unique(triangles, return_inverse=True)
    nodes = np.full(len(found.points), -1)
    nodes[used] = np.arange(len(used))
    return found.of_nodes(nodes, len(used), corners.reshape(triangles.shape))


def _mean_at(nodes: IntArray, values: FloatArray, count: int) -> FloatArray:
    """Means of values, of which NaN is none, at the nodes that they belong to."""
    is_given = np.isfinite(values) & (nodes >= 0)
    sums = [np.bincount(nodes[mask], row[mask], count) for row, mask in zip(values, is_given, strict=True)]
    counts = np.array([np.bincount(nodes[mask], minlength=count) for mask in is_given])
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)


def _places(points: FloatArray) -> tuple[IntArray, int]:
    """The number of each point's place, at which others may lie, too, and how many places there are."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    a, b = cKDTree(points).query_pairs(_reach(points), output_type="ndarray").T
    links = coo_array((np.ones(len(a)), (a, b)), shape=(len(points),) * 2)
    count, places = connected_components(links, directed=False)
    return places.astype(np.int64), int(count)


def _reach(points: FloatArray) -> float:
    """Within which points are one [m]."""
    return _SAME_PLACE * float(np.ptp(points, axis=0).max() + np.abs(points).max())


def _unit_in(name: str) -> str:
    """The unit in the name of a column or a field; a fluid pressure at its end is none of it."""
    word, unit = name_and_unit(name)
    return "" if not re.search(r"[\])]\s*$", name) and re.search(r"\d$", word) else unit


@dataclass(frozen=True, eq=False)
class _Field:
    """Numbers on the points or cells of a mesh or in a column, as they stand in the file."""

    name: str
    on_cells: bool
    values: FloatArray
    time: str = ""

    @property
    def stem(self) -> str:
        """The name without its unit and what tells load steps apart, in lower case."""
        word = name_and_unit(self.name)[0] if _unit_in(self.name) else self.name.lower()
        return _STEP.sub("", word) or word

    @property
    def word(self) -> str:
        """Of a component its own name."""
        return self.stem.rpartition(":")[2]

    @property
    def label(self) -> str:
        """With what it lies on, as two may have one name."""
        return f"{self.name} on {'cells' if self.on_cells else 'points'}"


def _with_units(names: Sequence[str], kinds: Mapping[int, str], options: MapOptions) -> list[str]:
    """Names with the units that the file does not say, of those that hold lengths and pressures."""
    units = {"pressure": options.pressure_unit, "length": options.length_unit}
    bare = {place: kind for place, kind in kinds.items() if not _unit_in(names[place])}
    if missing := {kind for kind in bare.values() if not units[kind]}:
        listed = [names[place] for place, kind in bare.items() if kind in missing]
        wanted = [f"--{kind}-unit {unit}" for kind, unit in _USUAL.items() if kind in missing]
        raise TextTableError(problem("map_units", names=join_names(listed, 5), options=" ".join(wanted)))
    for kind, unit in units.items():
        own = sorted({_unit_in(names[place]) for place in kinds if kinds[place] == kind})
        if unit and "" not in own and unit not in own:
            raise TextTableError(problem("map_own_units", kind=kind, own=join_names(own, 5), unit=unit))
    return [f"{name} [{units[bare[place]]}]" if place in bare else name for place, name in enumerate(names)]


def _chosen(fields: Sequence[_Field], options: MapOptions) -> tuple[list[_Field], list[_Field]]:
    """The contact pressure and the gap in all steps."""
    pressures, gaps = _named(fields, options.field, "field"), _named(fields, options.gap, "gap")
    if len(gaps) not in (0, 1, len(pressures)):
        raise TextTableError(problem("map_gaps", gaps=len(gaps), pressures=len(pressures)))
    return pressures, gaps * (len(pressures) // max(len(gaps), 1))


def _named(fields: Sequence[_Field], wanted: str | None, option: str) -> list[_Field]:
    """The field of a name in its steps; TextTableError unless there is one, but for a gap that nobody asked for."""
    if wanted is not None:
        stem = _Field(wanted, False, np.zeros(0)).stem
        exact = [one for one in fields if one.name == wanted]
        found = exact or [one for one in fields if stem in (one.stem, one.word)]
    elif option == "gap":
        found = [one for one in fields if _GAP.match(one.word)]
    else:
        known = [one for one in fields if role_of(one.word) == "pressure"]
        found = [one for one in known if is_of_program(one.word)] or known
    if len({(one.stem, one.on_cells) for one in found}) > 1:
        labels = dict.fromkeys(one.label for one in found)
        raise TextTableError(problem("map_two_fields", option=option, names=", ".join(labels)))
    if not found and (wanted is not None or option == "field"):
        names = join_names(list(dict.fromkeys(one.name for one in fields)), 20)
        raise TextTableError(problem("map_field", wanted=wanted, names=names))
    return found


# --- tables of points ---------------------------------------------------------------------------------------


def _of_tables(file: str | Path, options: MapOptions) -> PressureMap:
    from leak.text_tables import read_tables

    tables = [_with_names(table, options.columns) for table in read_tables(read_any_text(file))]
    steps = [step for number, table in enumerate(tables, start=1) for step in _steps(table, number, options)]
    places, count = _places(steps[0].points)
    alike = [step.of_nodes(_nodes(step, steps[0].points, places), count, step.triangles) for step in steps]
    axis = None if options.axis is None else np.eye(3)["xyz".index(options.axis.lower())]
    whole = replace(
        alike[0],
        pressure=np.concatenate([step.pressure for step in alike]),
        gap=None if alike[0].gap is None else np.concatenate([step.gap for step in alike]),
        steps=tuple(step.steps[0] for step in steps),
        fluid_pressures=tuple(step.fluid_pressures[0] for step in steps),
    )
    found = _only(whole, triangles_over(whole.points, axis))
    if (lost := count - len(found.points)) > 0:
        found = replace(found, remark=f"{found.remark}; {lost} points far from the others left out")
    return found


def _nodes(step: PressureMap, points: FloatArray, places: IntArray) -> IntArray:
    """The place of each point of a step among those of the first one."""
    from scipy.spatial import cKDTree

    distance, nearest = map(np.asarray, cKDTree(points).query(step.points))
    nodes, count = places[nearest], places.max() + 1
    if distance.max() > 10.0 * _reach(points) or len(np.unique(nodes)) < count:
        raise TextTableError(problem("map_other_points", step=step.steps[0]))
    highest, lowest = np.full(count, -np.inf), np.full(count, np.inf)
    np.maximum.at(highest, nodes, step.pressure[0])
    np.minimum.at(lowest, nodes, step.pressure[0])
    worst = int(np.argmax(highest - lowest))
    if highest[worst] - lowest[worst] > _SAME_PRESSURE * np.abs(step.pressure).max():
        raise TextTableError(problem("map_twice", low=float(lowest[worst]), high=float(highest[worst])))
    return nodes


def _with_names(table: TextTable, columns: str | None) -> TextTable:
    """A table with other names of its columns."""
    if columns is None:
        return table
    names, count = [name.strip() for name in _BETWEEN_NAMES.split(columns)], table.values.shape[1]
    if len(names) == count:
        return replace(table, header=tuple(names))
    words = {name_and_unit(name)[0]: name for name in names}
    header = tuple(words.pop(name_and_unit(name)[0], name) for name in table.header)
    if words:
        given = ", ".join(words.values())
        raise TextTableError(problem("map_columns", given=given, columns=count, names=table.header))
    return replace(table, header=header)


def _steps(table: TextTable, number: int, options: MapOptions) -> Iterator[PressureMap]:
    """The load steps of a table, without triangles."""
    fields = [_Field(name, False, table.values[:, n]) for n, name in enumerate(table.header)]
    pressures, gaps = ([fields.index(one) for one in each] for each in _chosen(fields, options))
    roles = _roles(table)
    polar = roles.keys() >= {"radius", "angle"} and not roles.keys() >= {"x", "y"}
    coords = [roles[one][0] for one in (("radius", "z") if polar else ("x", "y", "z")) if one in roles]
    if len(coords) + polar < 2:
        raise TextTableError(problem("map_no_points", names=", ".join(table.header)))
    check_rows(table, roles | {"pressure": pressures})
    kinds = dict.fromkeys((*coords, *gaps), "length") | dict.fromkeys(pressures, "pressure")
    header = _with_units(table.header, kinds, options)
    table = drop_extremes(replace(table, header=tuple(header)))
    points = np.zeros((len(table.rows), 3))
    for axis, place in enumerate(coords):
        points[:, axis] = column(table, place, "length")
    if polar:
        (r, z, _), angle = points.T, column(table, roles["angle"][0], "angle")
        points = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    loads = fluid_pressures(table, roles)
    for order, place in enumerate(pressures):
        pressure = column(table, place, "pressure")
        gap = column(table, gaps[order], "length") if gaps else None
        for label, rows in labelled_rows(table, roles, loads).items():
            yield PressureMap(
                points[rows],
                np.zeros((0, 3), dtype=np.int64),
                pressure[None, rows],
                None if gap is None else gap[None, rows],
                (" ".join(label) or (table.header[place] if len(pressures) > 1 else str(number)),),
                (load_in(table.header[place]) if loads is None else float(loads[rows[0]]),),
                remark=f"the columns {', '.join(header)} were taken for points over a surface",
            )


def _roles(table: TextTable) -> dict[str, list[int]]:
    """Places of the columns by what they hold; parts of a model are no load steps."""
    roles: dict[str, list[int]] = {}
    for place, name in enumerate(table.header):
        word = name_and_unit(name)[0]
        if (role := role_of(word)) is not None and "instance" not in word:
            roles.setdefault(role, []).append(place)
    return roles


# --- meshes -------------------------------------------------------------------------------------------------


# A mesh as pyvista has it, its fields in all steps, and the points of its named parts.
_Mesh = tuple[Any, list[_Field], dict[str, BoolArray]]


def _of_mesh(file: Path, options: MapOptions) -> PressureMap:
    if file.suffix.lower() == _OF_CALCULIX:
        return _of_calculix(file, options)
    grid, fields, parts = _read_mesh(file)
    pressures, gaps = _chosen(fields, options)
    both = [*pressures, *gaps]
    kinds = dict(enumerate(["length"] + ["pressure"] * len(pressures) + ["length"] * len(gaps)))
    names = _with_units(["coordinates", *(one.name for one in both)], kinds, options)
    metres, *factors = (parse_quantity(f"1 {_unit_in(name)}", kinds[n]) for n, name in enumerate(names))
    points = np.asarray(grid.points, dtype=np.float64) * metres
    values = np.array([one.values * factor for one, factor in zip(both, factors, strict=True)])
    if not np.isfinite(points).all() or np.isinf(values).any():
        raise TextTableError(problem("map_infinite"))
    pressure, gap = values[: len(pressures)], values[len(pressures) :]
    triangles, cells, is_volume = _surface(grid, pressure if pressures[0].on_cells else None)
    if pressures[0].on_cells:
        pressure = _on_nodes(pressure, points, triangles, cells)
    if gaps and gaps[0].on_cells:
        gap = _on_nodes(gap, points, triangles, cells)
    listed = join_names(list(dict.fromkeys(names[1:])), 5)
    # of all steps the first
    once = {one.label: one for one in reversed(fields) if one not in both}
    masks = {f"{one.name} = {value:g}": mask for one in once.values() for value, mask in _whole(one, grid)}
    whole = PressureMap(
        points,
        triangles,
        pressure,
        gap if gaps else None,
        tuple(one.time or one.name for one in pressures),
        tuple(load_in(one.name) for one in pressures),
        masks | parts,
        f"{listed} on {names[0]} was taken for the contact pressure{' and the gap' if gaps else ''}",
    )
    found = _only(whole, _in_contact(whole, is_volume))
    places, count = _places(found.points)
    if (lost := len(places) - count) > 0:
        corners = places[found.triangles]
        ordered, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
        corners = corners[first[(np.diff(ordered, axis=1) > 0).all(axis=1)]]
        found = replace(found, remark=f"{found.remark}; {lost} points at the place of others")
        found = found.of_nodes(places, count, corners)
    return found


def _of_calculix(file: Path, options: MapOptions) -> PressureMap:
    """By the package ccx2paraview, which writes its files beside the one that it reads."""
    from importlib import import_module
    from shutil import copyfile

    try:
        converter = import_module("ccx2paraview").Converter
    except ImportError:
        raise TextTableError(problem("map_calculix", name=file.name)) from None
    with TemporaryDirectory() as folder:
        copy = Path(folder, "map.frd")
        copyfile(file, copy)
        converter(str(copy), ["vtu"]).run()
        series = copy.with_suffix(".pvd")
        return _of_mesh(series if series.exists() else copy.with_suffix(".vtu"), options)


def _whole(one: _Field, grid: Any) -> Iterator[tuple[float, BoolArray]]:
    """Points at each value of a field of a few whole numbers."""
    values = one.values[np.isfinite(one.values)]
    if not values.size or (values != np.round(values)).any() or np.ptp(values) == 0.0:
        return
    distinct = np.unique(values)
    for value in distinct if len(distinct) <= _MOST_VALUES else ():
        mask = one.values == value
        yield float(value), _points_of(grid, mask) if one.on_cells else mask


def _points_of(grid: Any, cells: BoolArray) -> BoolArray:
    """Points of some of the cells."""
    import pyvista

    mask = np.zeros(grid.n_points, dtype=bool)
    starts = pyvista.convert_array(grid.GetCells().GetOffsetsArray())
    mask[grid.cell_connectivity[np.repeat(cells, np.diff(starts))]] = True
    return mask


def _surface(grid: Any, on_cells: FloatArray | None) -> tuple[IntArray, IntArray, bool]:
    """Triangles of the faces that may carry a field, the cell of each, and whether cells are bodies."""
    import pyvista
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    _, first, which = np.unique(grid.celltypes, return_index=True, return_inverse=True)
    dimensions = np.array([grid.get_cell(int(cell)).dimension for cell in first], dtype=int)[which]
    carries = np.ones(grid.n_cells, dtype=bool)
    if on_cells is not None:
        carries = np.isfinite(on_cells).any(axis=0) & (np.nan_to_num(on_cells) != 0.0).any(axis=0)
    highest = int(dimensions[carries].max(initial=0))
    if highest < 2:
        raise TextTableError(problem("map_no_faces"))
    if highest == 3 and on_cells is not None:
        raise TextTableError(problem("map_on_bodies"))
    bare = grid.copy()
    bare.clear_data()
    bare.point_data["point"], bare.cell_data["cell"] = np.arange(grid.n_points), np.arange(grid.n_cells)
    # quadratic faces are divided at the nodes that they have
    skin = vtkDataSetSurfaceFilter()
    skin.SetNonlinearSubdivisionLevel(1)
    skin.SetInputData(bare.extract_cells(dimensions == highest))
    skin.Update()
    faces = pyvista.wrap(skin.GetOutput()).triangulate()
    triangles = np.asarray(faces.point_data["point"])[faces.faces.reshape(-1, 4)[:, 1:]]
    return triangles.astype(np.int64), np.asarray(faces.cell_data["cell"]), highest == 3


def _normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Normals of triangles, as long as two of their areas."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def _on_nodes(values: FloatArray, points: FloatArray, triangles: IntArray, cells: IntArray) -> FloatArray:
    """Means over the cells around each node, by their areas; NaN where none has a value."""
    areas = np.bincount(cells, np.linalg.norm(_normals(points, triangles), axis=1), values.shape[1])
    pairs = np.unique(np.column_stack([triangles.ravel(), np.repeat(cells, 3)]), axis=0)
    means = np.full((len(values), len(points)), np.nan)
    for mean, row in zip(means, values, strict=True):
        node, cell = pairs[np.isfinite(row[pairs[:, 1]])].T
        sums, total = (np.bincount(node, areas[cell] * each, len(points)) for each in (row[cell], 1.0))
        np.divide(sums, total, out=mean, where=total > 0.0)
    return means


def _in_contact(whole: PressureMap, is_volume: bool) -> IntArray:
    """Triangles with the field."""
    triangles = whole.triangles
    is_given = np.isfinite(whole.pressure).sum(axis=0) > 0
    core = is_given[triangles].all(axis=1)
    sides = np.sort(triangles[core][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    # the whole skin of a body is no face in contact
    if is_volume and (np.unique(sides, axis=0, return_counts=True)[1] == 2).all():
        fields = [np.nan_to_num(one) for one in (whole.pressure, whole.gap) if one is not None]
        is_given = np.abs(np.concatenate(fields)).sum(axis=0) > 0.0
        core = is_given[triangles].all(axis=1)
        normals = _normals(whole.points, triangles)
        lengths = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        at_nodes = np.zeros_like(whole.points)
        np.add.at(at_nodes, triangles[core].ravel(), np.repeat(normals[core], 3, axis=0))
        towards = at_nodes[triangles].sum(axis=1)
        along = (normals / lengths * towards).sum(axis=1)
        core |= along > _GOES_ON * np.linalg.norm(towards, axis=1)
    if not core.any():
        raise TextTableError(problem("map_no_contact"))
    return triangles[core]


def _read_mesh(file: Path) -> _Mesh:
    """A mesh as pyvista has it, its fields in all steps, and the points of its named parts."""
    try:
        if (kind := _OF_MESHIO.get(file.suffix.lower())) is not None:
            return _by_meshio(file, kind)
        return _by_vtk(file)
    except ModuleNotFoundError as error:
        raise TextTableError(problem("map_package", name=error.name)) from None
    except TextTableError:
        raise
    # readers of damaged files fail in any way
    except Exception as error:
        reason = str(error)[:200] or type(error).__name__
        raise TextTableError(problem("map_damaged", reason=reason)) from None


def _by_meshio(file: Path, kind: str) -> _Mesh:
    import meshio
    import pyvista

    # the readers themselves: `meshio.read` writes to the terminal and leaves the program
    mesh, steps = _series_of_xdmf(file) if kind == "xdmf" else (getattr(meshio, kind).read(file), ())
    bare = pyvista.from_meshio(meshio.Mesh(mesh.points, mesh.cells))
    # a MED file names the components of each field once for all steps
    names = (name for name in (*mesh.point_data, *mesh.cell_data) if not name.endswith("_tags"))
    stems = dict.fromkeys(name.partition("[")[0] for name in names)
    components = dict(zip(stems, mesh.field_data.get("med:nom", ()), strict=False))
    fields = [
        _Field(label, bool(on_cells), values, time)
        for time, *both in steps or [("", mesh.point_data, mesh.cell_data)]
        for on_cells, data in enumerate(both)
        for name, array in data.items()
        for label, values in _scalars(
            name, np.concatenate(array) if on_cells else array, components.get(name.partition("[")[0], ())
        )
    ]
    tags = {one.name: one.values for one in fields if one.on_cells}
    dimensions = np.repeat([block.dim for block in mesh.cells], [len(block.data) for block in mesh.cells])
    groups = mesh.field_data.items() if kind == "gmsh" else ()
    named = [(name, (tags["gmsh:physical"] == tag) & (dimensions == dim)) for name, (tag, dim) in groups]
    families = getattr(mesh, "cell_tags", {}).items()
    named += [(name, tags["cell_tags"] == tag) for tag, several in families for name in several]
    families = getattr(mesh, "point_tags", {}).items()
    parts = {name: mesh.point_data["point_tags"] == tag for tag, several in families for name in several}
    for name, cells in named:
        parts[name] = parts.get(name, np.zeros(bare.n_points, dtype=bool)) | _points_of(bare, cells)
    return bare, fields, parts


def _series_of_xdmf(file: Path) -> tuple[Any, list[tuple[str, Any, Any]]]:
    """The mesh of an XDMF file, and of each of its times the fields on points and on cells."""
    from meshio import Mesh, ReadError, xdmf

    try:
        series = xdmf.TimeSeriesReader(file)
    except ReadError:
        return xdmf.read(file), []
    with series:
        points, cells = series.read_points_cells()
        data = [series.read_data(number) for number in range(series.num_steps)]
    return Mesh(points, cells), [(f"t = {time:g}", *both) for time, *both in data]


def _by_vtk(file: Path) -> _Mesh:
    import pyvista
    from vtkmodules.vtkCommonCore import vtkObject

    # of a damaged file VTK says on the terminal what it cannot read, and goes on
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.SetGlobalWarningDisplay(0)
    steps: list[tuple[str, list[tuple[str, Any]]]] = []
    try:
        with warnings.catch_warnings(action="ignore"):
            reader = pyvista.get_reader(str(file))
            times = list(getattr(reader, "time_values", None) or ())
            for time in times or [None]:
                if time is not None:
                    reader.set_active_time_value(time)
                label = f"t = {time:g}" if len(times) > 1 else ""
                steps.append((label, list(_blocks(reader.read(), ""))))
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    blocks = steps[0][1]
    if not blocks:
        raise TextTableError(problem("map_damaged", reason="no points were found"))
    grid = pyvista.MultiBlock([block.copy() for _, block in blocks]).combine()
    for label, others in steps:
        if [block.n_points for _, block in others] != [block.n_points for _, block in blocks]:
            raise TextTableError(problem("map_other_points", step=label))
    fields = [one for label, others in steps for one in _fields_of([block for _, block in others], label)]
    cell_counts, parts = [block.n_cells for _, block in blocks], dict[str, BoolArray]()
    for number, (name, _) in enumerate(blocks if len(blocks) > 1 else ()):
        cells = np.repeat(np.arange(len(blocks)) == number, cell_counts)
        parts[name] = parts.get(name, False) | _points_of(grid, cells)
    return grid, fields, parts


def _blocks(data: Any, name: str) -> Iterator[tuple[str, Any]]:
    """The meshes in what VTK has read, with their names."""
    import pyvista

    if isinstance(data, pyvista.MultiBlock):
        for key, block in zip(data.keys(), data, strict=True):
            yield from _blocks(block, key)
    elif data is not None and data.n_points:
        yield name, data.cast_to_unstructured_grid()


def _fields_of(blocks: Sequence[Any], time: str) -> Iterator[_Field]:
    """Fields of several meshes as those of one; NaN where a mesh has none of this name."""
    for on_cells in (False, True):
        arrays = [
            {
                label: values
                for name, array in (block.cell_data if on_cells else block.point_data).items()
                for label, values in _scalars(name, np.asarray(array), _components(array))
            }
            for block in blocks
        ]
        sizes = [block.n_cells if on_cells else block.n_points for block in blocks]
        for label in dict.fromkeys(label for one in arrays for label in one):
            parts = [one.get(label, np.full(size, np.nan)) for one, size in zip(arrays, sizes, strict=True)]
            yield _Field(label, on_cells, np.concatenate(parts), time)


def _components(array: Any) -> list[str]:
    """Names of the components of an array of VTK."""
    names = [array.VTKObject.GetComponentName(n) for n in range(array.VTKObject.GetNumberOfComponents())]
    return [name or str(n) for n, name in enumerate(names)]


def _scalars(name: str, array: Any, components: Sequence[str]) -> Iterator[tuple[str, FloatArray]]:
    """An array of numbers by its components, "CONTACT:CPRESS"."""
    if array.dtype.kind not in "iufb" or array.ndim > 2:
        return
    if array.ndim == 1:
        yield name, array.astype(np.float64)
        return
    labels = components if len(components) == array.shape[1] else range(array.shape[1])
    for label, values in zip(labels, array.T, strict=True):
        yield f"{name}:{label}", values.astype(np.float64)
