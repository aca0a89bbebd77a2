"""Maps of the contact pressure as programs export them: the same face with the same pressure, or a reason why not."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
import pyvista
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from vtkmodules.vtkIOExodus import vtkExodusIIWriter

from fem_seal.answers.map_files import MapOptions, PressureMap, is_map, read_map
from fem_seal.answers.point_surface import triangles_over
from fem_seal.errors import InputError, TextTableError

MM_MPA = MapOptions(pressure_unit="MPa", length_unit="mm")
MIXED = np.random.default_rng(3)
# A ring of 12 by 60 nodes [mm], with a pressure that nothing else repeats [MPa], and its quadrangles.
ROWS, TURNS = 12, 60
R, PHI = (
    each.ravel() for each in np.meshgrid(np.linspace(10.0, 12.0, ROWS), np.arange(TURNS) * 2 * np.pi / TURNS)
)
P = 50.0 + 20.0 * np.cos(PHI) + (R - 10.0)
XYZ = np.column_stack([R * np.cos(PHI), R * np.sin(PHI), 0.0 * R])
NODE = np.arange(ROWS * TURNS).reshape(TURNS, ROWS)
NEXT = np.roll(NODE, -1, axis=0)
QUADS = np.stack([NODE[:, :-1], NODE[:, 1:], NEXT[:, 1:], NEXT[:, :-1]], axis=-1).reshape(-1, 4)
# ... whose sides are chords
AREA = 0.5 * TURNS * math.sin(2 * np.pi / TURNS) * (12.0**2 - 10.0**2) * 1e-6


def area(points: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = points[triangles].transpose(1, 0, 2)
    return 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def loops(triangles: np.ndarray) -> int:
    """Closed lines of sides that belong to one triangle; none belongs to three."""
    sides = np.sort(np.vstack([triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))]), axis=1)
    sides, counts = np.unique(sides, axis=0, return_counts=True)
    assert counts.max() == 2
    edge = sides[counts == 1]
    links = coo_array((np.ones(len(edge)), tuple(edge.T)), shape=(triangles.max() + 1,) * 2)
    return len(np.unique(connected_components(links, directed=False)[1][edge[:, 0]]))


def check_ring(found: PressureMap, factor: float = 1.0) -> None:
    """The ring above, whatever its nodes are called."""
    assert loops(found.triangles) == 2
    assert area(found.points, found.triangles) == pytest.approx(AREA, rel=1e-6)
    x, y, _ = found.points.T * 1e3
    wanted = (50.0 + 20.0 * np.cos(np.arctan2(y, x)) + np.hypot(x, y) - 10.0) * 1e6 * factor
    assert found.pressure[-1] == pytest.approx(wanted, rel=1e-5)


def ring(**fields: np.ndarray) -> pyvista.UnstructuredGrid:
    grid = pyvista.UnstructuredGrid({pyvista.CellType.QUAD: QUADS}, XYZ)
    grid.point_data.update(fields or {"CPRESS": P})
    return grid


def table(header: str, *columns: np.ndarray, mixed: bool = True) -> str:
    rows = np.column_stack(columns)
    rows = MIXED.permutation(rows) if mixed else rows
    return "\n".join([header, *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n"


HEADER = "x [mm],y [mm],z [mm],pressure [MPa]"
CARTESIAN = (*XYZ.T, P)

# --- points over a surface


def polar(count: int, inner: float, outer: float) -> tuple[np.ndarray, np.ndarray]:
    """Radius and angle of points of a ring, as far from each other along it as across it."""
    rows = round(math.sqrt(count * (outer - inner) / (math.pi * (inner + outer))))
    angles = np.arange(round(count / rows)) * 2 * np.pi / round(count / rows)
    r, phi = np.meshgrid(np.linspace(inner, outer, rows), angles)
    return r.ravel(), phi.ravel()


def surface(r: np.ndarray, phi: np.ndarray, z: np.ndarray | float = 0.0, squeeze: float = 1.0) -> np.ndarray:
    return np.column_stack([r * np.cos(phi), squeeze * r * np.sin(phi), z + 0.0 * r])


A, B = polar(5000, 10.0, 14.0)
AT_RANDOM = np.sqrt(MIXED.uniform(100.0, 196.0, 5000)), MIXED.uniform(0.0, 2 * np.pi, 5000)
FLAT = np.column_stack(
    [each.ravel() for each in np.meshgrid(np.linspace(-5, 5, 81), np.linspace(-4, 4, 65), [0.0])]
)
LAND = FLAT[(np.abs(FLAT[:, 0]) > 2.99) | (np.abs(FLAT[:, 1]) > 1.99)]
RING_AREA = math.pi * 96.0
PIE = (0.75 * np.pi - 0.01) / np.pi


def cone_area(slope: float) -> float:
    return RING_AREA * math.hypot(1.0, slope)


# Points, loops and area; an oval cone's area by its own elements.
SURFACES = {
    "ring": (surface(A, B), 2, RING_AREA),
    "cone": (surface(A, B, A), 2, cone_area(1.0)),
    "steep cone": (surface(A, B, 6.0 * A), 2, cone_area(6.0)),
    "cylinder": (surface(0.0 * A + 10.0, B, A), 2, 2 * np.pi * 10.0 * 4.0),
    "oval": (surface(A, B, squeeze=0.6), 2, 0.6 * RING_AREA),
    "narrow": (
        surface(*(x.ravel() for x in np.meshgrid(np.linspace(14, 14.1, 20), np.arange(240) * np.pi / 120))),
        2,
        math.pi * 2.81,
    ),
    "coarse": (
        surface(*(x.ravel() for x in np.meshgrid(np.linspace(10, 14, 5), np.arange(24) * np.pi / 12))),
        2,
        12.0 * math.sin(np.pi / 12) * 96.0,
    ),
    "wedge land": (LAND, 2, 80.0 - 24.0),
    "patch": (FLAT, 1, 80.0),
    "bent patch": (FLAT * 0.1 + np.outer(0.01 * FLAT[:, 0] ** 2, [0, 0, 1]), 1, None),
    "at random": (surface(*AT_RANDOM, AT_RANDOM[0]), 2, None),
}


@pytest.mark.parametrize("name", SURFACES)
def test_points_in_any_order_and_place_close_to_a_surface(name: str) -> None:
    points, count, wanted = SURFACES[name]
    turn = np.linalg.qr(MIXED.normal(size=(3, 3)))[0]
    moved = MIXED.permutation(points @ turn.T + [3.0, -20.0, 100.0])
    triangles = triangles_over(moved)
    assert loops(triangles) == count
    assert len(np.unique(triangles)) == len(points)
    if wanted is not None:
        assert area(moved, triangles) == pytest.approx(wanted, rel=0.01)


def test_an_oval_cone_and_half_a_cone_around_a_given_axis() -> None:
    oval = surface(A, B, A, 0.7)
    # of dr by dphi: r sqrt(0.49 + sin^2 + 0.49 cos^2), by 2000 angles
    angle = (np.arange(2000) + 0.5) * np.pi / 1000
    wanted = 48.0 * float(np.sqrt(0.49 + 0.49 * np.cos(angle) ** 2 + np.sin(angle) ** 2).mean()) * 2 * np.pi
    triangles = triangles_over(oval)
    assert loops(triangles) == 2
    assert area(oval, triangles) == pytest.approx(wanted, rel=0.01)
    half = surface(A, B, 4.0 * A)[np.pi + 1e-9 > B]
    triangles = triangles_over(half, np.array([0.0, 0.0, 1.0]))
    assert loops(triangles) == 1
    assert area(half, triangles) == pytest.approx(0.5 * cone_area(4.0), rel=0.01)


def test_points_that_are_no_surface() -> None:
    line = np.outer(np.linspace(0.0, 1.0, 50), [1.0, 2.0, 3.0])
    with pytest.raises(TextTableError, match="lie on a line"):
        triangles_over(line)
    with pytest.raises(TextTableError, match="no surface that can be laid on a plane"):
        triangles_over(MIXED.normal(size=(2000, 3)))


# --- files


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str, object], Path]:
    def written(name: str, content: object) -> Path:
        path = tmp_path / name
        if isinstance(content, str):
            path.write_text(content)
        elif path.suffix == ".e":
            writer = vtkExodusIIWriter()
            writer.SetFileName(str(path))
            writer.SetInputData(content)
            writer.Write()
        elif isinstance(content, meshio.Mesh):
            content.write(path, **({"file_format": "gmsh22"} if path.suffix == ".msh" else {}))
        else:
            content.save(path)
        return path

    return written


TRIANGLES = np.vstack([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
BY_MESHIO = meshio.Mesh(XYZ, [("quad", QUADS)], point_data={"CPRESS": P})
SAME = {
    "map.vtu": ring(),
    "map.vtp": ring().extract_surface(algorithm="dataset_surface"),
    "map.vtk": ring(),
    "map.msh": meshio.Mesh(XYZ, [("triangle", TRIANGLES)], point_data={"CPRESS": P}),
    "map.med": BY_MESHIO,
    "map.rmed": BY_MESHIO,
    "map.e": ring(),
    "other.vtu": ring(CPRESS=P, S11=2 * P, fluid_pressure_Pa=3 * P),
    "component.vtu": ring(CONTACT=np.column_stack([0.0 * P, P])),
    "map.csv": table(HEADER, *CARTESIAN),
    "plane.csv": table("X,Y,CPRESS", *XYZ.T[:2], P),
    "map.rpt": table(
        "Node Label  COORD.COOR1  COORD.COOR2  COORD.COOR3  CPRESS", NODE.ravel(order="C") * 1.0, *CARTESIAN
    ).replace(",", "  "),
    "ansys.txt": table(
        "Node Number\tX Location (mm)\tY Location (mm)\tZ Location (mm)\tPressure (MPa)", P, *CARTESIAN
    ).replace(",", "\t"),
    "polar.csv": table("r [mm],theta [rad],z [mm],CPRESS [MPa]", R, PHI, 0.0 * R, P),
    "columns.csv": table("a,b,c,d", *CARTESIAN),
}


@pytest.mark.parametrize("name", SAME)
def test_the_same_face_in_any_file(name: str, write) -> None:
    content = SAME[name]
    if name == "map.rmed":
        path = write("map.med", content).rename(write("empty.txt", "").with_name(name))
    elif name == "component.vtu":
        content.point_data["CONTACT"].VTKObject.SetComponentName(0, "COPEN")
        content.point_data["CONTACT"].VTKObject.SetComponentName(1, "CPRESS")
        path = write(name, content)
    else:
        path = write(name, content)
    columns = "x [mm],y [mm],z [mm],CPRESS [MPa]" if name == "columns.csv" else None
    found = read_map(path, MapOptions(pressure_unit="MPa", length_unit="mm", columns=columns))
    check_ring(found)
    assert (found.gap is not None) == (name == "component.vtu")
    assert is_map(path, columns)


def test_cells_are_averaged_and_divided(write) -> None:
    grid = ring()
    grid.clear_data()
    centres = grid.cell_centers().points
    grid.cell_data["contact_pressure_Pa"] = 1e6 * (50.0 + centres[:, 0])
    grid.cell_data["side"] = np.where(
        np.hypot(*centres.T[:2]) < 10.2, 1, np.where(np.hypot(*centres.T[:2]) > 11.8, 2, 0)
    )
    found = read_map(write("cells.vtu", grid), MapOptions(length_unit="mm"))
    assert loops(found.triangles) == 2
    # between neighbours is half of the way, and at the edge only half of them
    assert found.pressure[0] == pytest.approx(1e6 * (50.0 + 1e3 * found.points[:, 0]), abs=0.15e6)
    r = np.hypot(*found.points.T[:2])
    assert found.parts["side = 1"].sum() == 2 * TURNS and r[found.parts["side = 1"]].max() < 0.0102
    assert found.parts["side = 2"].sum() == 2 * TURNS and r[found.parts["side = 2"]].min() > 0.0118


def test_named_parts_of_gmsh_and_med(write) -> None:
    inner = np.column_stack([NODE[:, 0], NEXT[:, 0]])
    mesh = meshio.Mesh(
        XYZ,
        [("triangle", TRIANGLES), ("line", inner)],
        point_data={"CPRESS": P},
        cell_data={
            tag: [np.full(len(TRIANGLES), 1), np.full(len(inner), 2)]
            for tag in ("gmsh:physical", "gmsh:geometrical")
        },
        field_data={"face": np.array([1, 2]), "inlet": np.array([2, 1])},
    )
    found = read_map(write("map.msh", mesh), MM_MPA)
    assert np.hypot(*found.points[found.parts["inlet"]].T[:2]) == pytest.approx(np.full(TURNS, 0.01))
    assert found.parts["face"].all()
    tags = np.where(np.hypot(*XYZ.T[:2]) < 10.01, 7, 0)
    mesh = meshio.Mesh(XYZ, [("quad", QUADS)], point_data={"CPRESS": P, "point_tags": tags})
    mesh.point_tags, mesh.cell_tags = {7: ["bore", "inlet"]}, {}
    found = read_map(write("map.med", mesh), MM_MPA)
    assert np.hypot(*found.points[found.parts["inlet"]].T[:2]) == pytest.approx(np.full(TURNS, 0.01))


def block(quadratic: bool = False) -> meshio.Mesh:
    """A cube of 6 by 6 by 2 cells [mm] whose upper side is in contact but for its rim."""
    x, y, z = np.meshgrid(np.arange(7.0), np.arange(7.0), np.arange(3.0), indexing="ij")
    grid = pyvista.StructuredGrid(x, y, z).cast_to_unstructured_grid()
    cells = grid.cells.reshape(-1, 9)[:, 1:]
    if not quadratic:
        return meshio.Mesh(grid.points, [("hexahedron", cells)])
    pairs = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
    corners = grid.points[cells]
    middles = np.stack([corners[:, list(pair)].mean(axis=1) for pair in pairs], axis=1)
    points, cells = np.unique(
        np.concatenate([corners, middles], axis=1).reshape(-1, 3), axis=0, return_inverse=True
    )
    return meshio.Mesh(points, [("hexahedron20", cells.reshape(-1, 20))])


@pytest.mark.parametrize("quadratic", [False, True])
@pytest.mark.parametrize("beside", [0.0, np.nan])
def test_the_contact_face_of_a_body(quadratic: bool, beside: float, write) -> None:
    mesh = block(quadratic)
    x, y, z = mesh.points.T
    on_top = (z == 2.0) & (np.isnan(beside) | ((x > 0) & (x < 6) & (y > 0) & (y < 6)))
    mesh.point_data["CPRESS"] = np.where(on_top, 1.0 + x, beside)
    found = read_map(write("body.vtu", mesh), MM_MPA)
    # without the sides, with the rim on which nothing touches
    assert found.points[:, 2] == pytest.approx(np.full(len(found.points), 0.002))
    # a corner of the rim, all of whose points carry nothing, may be missing
    assert 34.9e-6 < area(found.points, found.triangles) < 36.000001e-6
    assert loops(found.triangles) == 1


def test_one_of_several_bodies_has_the_field(tmp_path: Path) -> None:
    mesh = block()
    x, y, z = mesh.points.T
    mesh.point_data["CPRESS"] = np.where((z == 2.0) & (x > 0) & (x < 6) & (y > 0) & (y < 6), 1.0 + x, 0.0)
    seat = pyvista.from_meshio(mesh)
    plug = pyvista.from_meshio(block()).translate((0.0, 0.0, 2.0))
    pyvista.MultiBlock({"seat": seat, "plug": plug}).save(tmp_path / "both.vtm")
    found = read_map(tmp_path / "both.vtm", MM_MPA)
    assert found.points[:, 2] == pytest.approx(np.full(len(found.points), 0.002))
    assert set(found.parts) == {"seat"} and loops(found.triangles) == 1


def test_points_without_a_field_are_not_of_the_face(write) -> None:
    found = read_map(write("map.vtu", ring(CPRESS=np.where(R > 11.9, np.nan, P))), MM_MPA)
    assert len(found.points) == (ROWS - 1) * TURNS
    assert loops(found.triangles) == 2


def test_cells_that_do_not_share_their_points(write) -> None:
    apart = ring().extract_surface(algorithm="dataset_surface").triangulate()
    soup = pyvista.PolyData(
        apart.points[apart.faces.reshape(-1, 4)[:, 1:]].reshape(-1, 3),
        faces=np.insert(np.arange(3 * apart.n_cells).reshape(-1, 3), 0, 3, axis=1),
    )
    soup.point_data["CPRESS"] = np.asarray(apart["CPRESS"])[apart.faces.reshape(-1, 4)[:, 1:].ravel()]
    found = read_map(write("soup.vtp", soup), MM_MPA)
    check_ring(found)
    assert len(found.points) == ROWS * TURNS


# --- steps


def test_several_load_steps(write, tmp_path: Path) -> None:
    names = ("CPRESS at 20 bar [MPa]", "CPRESS at 40 bar [MPa]")
    gaps = {"COPEN_1": 0.1 * P - 5.0, "COPEN_2": 0.0 * P}
    found = read_map(write("fields.vtu", ring(**{names[0]: 2 * P, names[1]: P}, **gaps)), MM_MPA)
    check_ring(found)
    assert found.pressure[0] == pytest.approx(2 * found.pressure[1])
    assert found.steps == names and found.fluid_pressures == (20e5, 40e5)
    assert found.gap is not None and found.gap.min() == 0.0
    assert found.gap[0].max() == pytest.approx((0.1 * P.max() - 5.0) * 1e-3)

    for number in (1, 2):
        ring(CPRESS=P * (3 - number)).save(tmp_path / f"step{number}.vtu")
    files = "".join(f'<DataSet timestep="{n}" part="0" file="step{n}.vtu"/>' for n in (1, 2))
    series = write("series.pvd", f'<VTKFile type="Collection"><Collection>{files}</Collection></VTKFile>')
    found = read_map(series, MM_MPA)
    check_ring(found)
    assert found.pressure[0] == pytest.approx(2 * found.pressure[1]) and found.steps == ("t = 1", "t = 2")
    with meshio.xdmf.TimeSeriesWriter(tmp_path / "series.xdmf", data_format="XML") as writer:
        writer.write_points_cells(XYZ, [("quad", QUADS)])
        for time in (0.5, 1.0):
            writer.write_data(time, point_data={"CPRESS": P / time})
    found = read_map(tmp_path / "series.xdmf", MM_MPA)
    check_ring(found)
    assert found.pressure[0] == pytest.approx(2 * found.pressure[1])

    rows = [np.concatenate([column, column]) for column in CARTESIAN[:3]]
    for extra, loads in (("fluid_pressure [bar]", (20.0, 40.0)), ("step", (1.0, 2.0))):
        last = np.repeat(loads, len(P))
        text = table(f"{HEADER},{extra}", *rows, np.concatenate([2 * P, P]), last, mixed=False)
        lines = text.splitlines()
        found = read_map(write("steps.csv", "\n".join([*lines[: len(P) + 1], *lines[: len(P) : -1]])), MM_MPA)
        check_ring(found)
        assert found.pressure[0] == pytest.approx(2 * found.pressure[1])
        assert found.fluid_pressures == ((20e5, 40e5) if "bar" in extra else (None, None))
    beside = table(
        "x [mm],y [mm],z [mm],CPRESS at 20 bar [MPa],CPRESS at 40 bar [MPa],COPEN [um]",
        *XYZ.T,
        2 * P,
        P,
        0.0 * P,
    )
    found = read_map(write("beside.csv", beside), MM_MPA)
    assert found.fluid_pressures == (20e5, 40e5) and found.gap is not None and found.gap.shape == (2, len(P))


# --- what is refused


REFUSED = {
    "no.vtu": (
        ring(),
        MapOptions(),
        "does not say the unit of coordinates, CPRESS; give --pressure-unit MPa --length-unit mm",
    ),
    "length.vtu": (
        ring(contact_pressure_Pa=P),
        MapOptions(),
        "the unit of coordinates; give --length-unit mm",
    ),
    "units.csv": (
        table("x,y,z,CPRESS", *CARTESIAN),
        MapOptions(length_unit="mm"),
        "the unit of CPRESS; give --pressure-unit MPa",
    ),
    "own.csv": (
        table(HEADER, *XYZ.T, P),
        MapOptions(length_unit="furlong"),
        r"states its length unit itself \(mm\); leave --length-unit furlong out",
    ),
    "wrong.vtu": (ring(), MapOptions(pressure_unit="mm", length_unit="mm"), 'unit "mm" does not fit'),
    "two.vtu": (
        ring(CPRESS=P, CONT_PRES=P),
        MM_MPA,
        "several fields .*: CPRESS on points, CONT_PRES on points; .*--field",
    ),
    "none.vtu": (
        ring(S11=P, U1=P),
        MM_MPA,
        "no field that is known as contact pressure; its fields are S11, U1",
    ),
    "named.vtu": (
        ring(),
        MapOptions(field="CSTR", pressure_unit="MPa", length_unit="mm"),
        "no field CSTR; its fields are CPRESS",
    ),
    "nan.vtu": (ring(CPRESS=np.nan * P), MM_MPA, "the bodies do not touch"),
    "zero.vtu": (ring(CPRESS=0.0 * P), MM_MPA, "the bodies do not touch"),
    "infinite.vtu": (ring(CPRESS=np.where(R > 11.9, np.inf, P)), MM_MPA, "no finite numbers"),
    "pulled.vtu": (ring(CPRESS=P - 60.0), MM_MPA, "faces that touch are not pulled"),
    "hard.vtu": (
        ring(),
        MapOptions(pressure_unit="GPa", length_unit="mm"),
        "more than 100 times the hardness",
    ),
    "small.vtu": (ring(), MapOptions(pressure_unit="MPa", length_unit="nm"), "is the length unit right"),
    "large.vtu": (ring(), MapOptions(pressure_unit="MPa", length_unit="km"), "is the length unit right"),
    "lines.vtp": (ring().extract_all_edges(), MM_MPA, "no faces with a contact pressure"),
    "damaged.vtu": ("<nonsense", MM_MPA, "cannot be read as a mesh"),
    "damaged.msh": ("nonsense", MM_MPA, "cannot be read as a mesh"),
    "nan.csv": (table(HEADER, *XYZ.T, np.where(P[7] == P, np.nan, P)), MM_MPA, "must hold 4 finite numbers"),
    "line.csv": (table(HEADER, NODE.ravel(), NODE.ravel(), NODE.ravel(), P), MM_MPA, "lie on a line"),
    "cloud.csv": (table(HEADER, *MIXED.normal(size=(3, len(P))), P), MM_MPA, "no surface that can be laid"),
    "flat.csv": (table("x [mm],p [MPa],a,b", R, P, P, P), MM_MPA, "no columns x, y and z"),
    "names.csv": (
        table(HEADER, *CARTESIAN),
        MapOptions(columns="X [mm],CPRESS [MPa]"),
        "columns CPRESS \\[MPa\\] are not there; it has 4",
    ),
    "twice.csv": (
        table(HEADER, *(np.tile(each, 2) for each in XYZ.T), np.concatenate([P, 2 * P])),
        MM_MPA,
        "at one point .* step",
    ),
    "other.csv": (
        table(f"{HEADER},step", *XYZ.T, P, 1.0 + (R > 11.9)),
        MM_MPA,
        "has other points than the first",
    ),
    "map.frd": (
        "    1C\n",
        MM_MPA,
        "needs the package ccx2paraview.*convert the file: ccx2paraview map.frd vtu",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_map_that_cannot_be_right_is_told_in_a_sentence(name: str, write, monkeypatch) -> None:
    content, options, message = REFUSED[name]
    monkeypatch.setitem(sys.modules, "ccx2paraview", None)
    path = write(name, content)
    with pytest.raises(InputError, match=message) as caught:
        read_map(path, options, hardness=0.2e9)
    assert str(caught.value).startswith(str(path)) and "\n" not in str(caught.value)


def test_bodies_with_a_pressure_on_their_cells(write) -> None:
    mesh = block()
    mesh.cell_data["CPRESS"] = [np.where(np.arange(72) > 35, 1.0, 0.0)]
    with pytest.raises(InputError, match="does not tell their faces"):
        read_map(write("cells.vtu", mesh), MM_MPA)


def test_small_tension_and_the_other_sign(write) -> None:
    found = read_map(write("tension.vtu", ring(CPRESS=np.where(R > 11.9, -0.5, P))), MM_MPA)
    assert found.pressure.min() == 0.0
    assert f"{TURNS} points with tension, up to 0.0" in found.remark
    found = read_map(write("sign.vtu", ring(LAGS_C=-P)), MM_MPA)
    check_ring(found)
    assert "compression is negative" in found.remark


def test_what_reads_med_may_be_missing(write, monkeypatch) -> None:
    path = write("map.med", BY_MESHIO)
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(
        InputError, match="needs the package h5py to be read; install it with: pip install h5py"
    ):
        read_map(path, MM_MPA)


def test_results_of_calculix_by_its_converter(write, monkeypatch) -> None:
    class Converter:
        """Writes as ccx2paraview does: beside the file, zero where there is no contact."""

        def __init__(self, name: str, kinds: list[str]) -> None:
            self.name = name
            assert kinds == ["vtu"]

        def run(self) -> None:
            ring().save(Path(self.name).with_suffix(".vtu"))

    monkeypatch.setitem(sys.modules, "ccx2paraview", SimpleNamespace(Converter=Converter))
    check_ring(read_map(write("map.frd", "    1C\n"), MM_MPA))


def test_a_meridian_is_no_map(write) -> None:
    across = np.linspace(0.0, 1.0, 40)
    assert not is_map(write("p.csv", table(HEADER, 10 + across, 0 * across, across, across)))
    assert not is_map(write("q.csv", table("x [mm],p [MPa]", across, across)))
    assert not is_map(write("s.csv", table("s [mm],x [mm],y [mm],p [MPa]", across, *XYZ.T[:2, :40], across)))
    assert not is_map(write("t.csv", "nothing"))
    assert is_map(write("u.csv", table("r [mm],theta [deg],p [MPa]", R, PHI, P)))
    assert is_map(write("v.csv", table(HEADER, *XYZ.T, -P)))
    assert is_map("x.vtu") and is_map("x.frd")
