"""The VTK files hold the numbers of the result, and VTK reads them without complaint."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from sample_results import gasket_result, rough_result, smooth_result
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from fem_seal.contact.solution import body_fields
from fem_seal.output.vtk import write_contact, write_contact_line, write_unloaded
from fem_seal.result import SealResult


@pytest.fixture(scope="module")
def result() -> SealResult:
    return rough_result()


@pytest.fixture(scope="module")
def folder(result: SealResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("vtk")
    write_contact(result, folder)
    write_contact_line(result, folder)
    return folder


@pytest.fixture
def complaints():
    """What VTK has to say while it reads."""
    core = pytest.importorskip("vtkmodules.vtkCommonCore")
    window, before = core.vtkStringOutputWindow(), core.vtkOutputWindow.GetInstance()
    core.vtkOutputWindow.SetInstance(window)
    yield window
    core.vtkOutputWindow.SetInstance(before)


def read(path: Path):
    pyvista = pytest.importorskip("pyvista")
    return pyvista.read(path)


def test_fields_come_back_bit_by_bit(result, folder, complaints):
    for n, load in enumerate(result.loads):
        grid = read(folder / f"contact_{n:03}.vtu")
        fields = body_fields(load.contact)
        bodies = [fields["closure"], fields["seat"]]
        points = np.concatenate([body.points for body in bodies])
        np.testing.assert_array_equal(grid.points[:, :2], points)
        np.testing.assert_array_equal(grid.points[:, 2], 0.0)
        stress = np.concatenate([body.stress for body in bodies])
        # r is x, z is y, hoop is z: XX YY ZZ XY YZ XZ
        np.testing.assert_array_equal(grid["stress_Pa"][:, :4], stress)
        np.testing.assert_array_equal(grid["stress_Pa"][:, 4:], 0.0)
        np.testing.assert_array_equal(
            grid["von_mises_Pa"], np.concatenate([body.von_mises for body in bodies])
        )
        pressure = np.concatenate([body.contact_pressure for body in bodies])
        np.testing.assert_array_equal(grid["contact_pressure_Pa"], pressure)
        assert grid.field_data["fluid_pressure_Pa"][0] == load.fluid_pressure
        assert grid.field_data["contact_force_N"][0] == load.contact_force
    assert complaints.GetOutput() == ""


def test_von_mises_follows_from_the_stress_tensor(folder):
    grid = read(folder / "contact_002.vtu")
    xx, yy, zz, xy, yz, xz = grid["stress_Pa"].T
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1)
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    np.testing.assert_allclose(np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2))), grid["von_mises_Pa"], rtol=1e-9)


def test_cells_are_quadratic_triangles_of_two_bodies(result, folder):
    grid = read(folder / "contact_000.vtu")
    assert set(grid.celltypes) == {22}
    assert grid.n_cells == result.seal_mesh.quality.elements
    # Pappus: area of the section of each body from the cells alone, against the mesh
    area = grid.compute_cell_sizes(length=False, volume=False)["Area"]
    for number, outline in enumerate(result.seal_mesh.outlines):
        assert area[grid["body"] == number].sum() == pytest.approx(
            outline.area, rel=2 * result.seal_mesh.quality.area_error
        )
    # mid-side nodes lie on straight edges: wrong node order would put them elsewhere
    cells = grid.cells.reshape(-1, 7)[:, 1:]
    for middle, (a, b) in zip((3, 4, 5), ((0, 1), (1, 2), (2, 0)), strict=True):
        expected = 0.5 * (grid.points[cells[:, a]] + grid.points[cells[:, b]])
        np.testing.assert_allclose(grid.points[cells[:, middle]], expected, atol=1e-12)


def test_meshio_reads_the_bodies_as_vtk_does(folder):
    file = folder / "contact_001.vtu"
    ours, theirs = read(file), meshio.read(file)
    np.testing.assert_array_equal(theirs.points, ours.points)
    np.testing.assert_array_equal(theirs.cells_dict["triangle6"], ours.cells.reshape(-1, 7)[:, 1:])
    np.testing.assert_array_equal(theirs.cell_data["body"][0].ravel(), ours["body"])
    for name in ours.point_data:
        np.testing.assert_array_equal(theirs.point_data[name].reshape(ours[name].shape), ours[name])


def test_displaced_bodies_leave_the_gap_of_the_solution(result, folder):
    """g0 + (u_closure - u_seat).n, all from the file, is the gap that the contact solver found."""
    contact = result.seal_mesh.contact
    for n, load in enumerate(result.loads):
        displacement = read(folder / f"contact_{n:03}.vtu")["displacement_m"]
        fields = body_fields(load.contact)
        closure, seat = fields["closure"], fields["seat"]
        x = seat.contact_x
        opening = displacement[closure.contact_nodes] - displacement[len(closure.points) + seat.contact_nodes]
        gap = contact.gap(x) + (opening[:, :2] * contact.normal(x).T).sum(axis=1)
        line = read(folder / f"contact_line_{n:03}.vtp")
        inside = np.abs(x) < 3 * load.contact.profile.std
        expected = CubicSpline(line["x_m"], line["gap_m"])(x)
        # interpolation between the points is the only difference; the gap is some micrometres
        np.testing.assert_allclose(gap[inside], expected[inside], atol=1e-11)


def test_contact_line_holds_the_profile(result, folder, complaints):
    for n, load in enumerate(result.loads):
        line, profile = read(folder / f"contact_line_{n:03}.vtp"), load.contact.profile
        assert line.n_lines == 1
        np.testing.assert_array_equal(line["x_m"], profile.x)
        np.testing.assert_array_equal(line["contact_pressure_Pa"], profile.pressure)
        np.testing.assert_array_equal(line["gap_m"], profile.gap)
        np.testing.assert_array_equal(line["fluid_pressure_in_gap_Pa"], load.leak.fluid_pressure)
        np.testing.assert_array_equal(line.points[:, 0], profile.radius)
        # the points lie as far apart in space as x says
        steps = np.linalg.norm(np.diff(line.points, axis=0), axis=1)
        np.testing.assert_allclose(steps, np.diff(profile.x), rtol=1e-9)
    assert complaints.GetOutput() == ""


def test_series_names_files_that_exist_with_the_pressures_as_time(result, folder, complaints):
    pyvista = pytest.importorskip("pyvista")
    for name in ("contact", "contact_line"):
        entries = ET.parse(folder / f"{name}.pvd").getroot().findall("Collection/DataSet")
        assert all((folder / entry.get("file")).is_file() for entry in entries)
        reader = pyvista.get_reader(str(folder / f"{name}.pvd"))
        assert reader.time_values == [load.fluid_pressure for load in result.loads]
        reader.set_active_time_value(reader.time_values[-1])
        assert reader.read()[0].field_data["fluid_pressure_Pa"][0] == result.loads[-1].fluid_pressure
    assert complaints.GetOutput() == ""


def test_pressures_that_do_not_rise_are_numbered_instead(result, tmp_path):
    turned = replace(result, loads=result.loads[::-1])
    write_contact_line(turned, tmp_path)
    entries = ET.parse(tmp_path / "contact_line.pvd").getroot().findall("Collection/DataSet")
    assert [float(entry.get("timestep")) for entry in entries] == [0.0, 1.0, 2.0]


def test_files_of_an_earlier_run_with_more_loads_go_and_others_stay(result, tmp_path):
    write_contact(result, tmp_path)
    write_contact_line(result, tmp_path)
    other = tmp_path / "contact_sketch.vtu"
    other.write_text("mine")
    fewer = replace(result, loads=result.loads[:1])
    write_contact(fewer, tmp_path)
    write_contact_line(fewer, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "contact.pvd",
        "contact_000.vtu",
        "contact_line.pvd",
        "contact_line_000.vtp",
        "contact_sketch.vtu",
    ]
    assert other.read_text() == "mine"


def test_without_a_leak_rate_there_is_no_fluid_pressure(tmp_path):
    write_contact_line(smooth_result(), tmp_path)
    assert "fluid_pressure_in_gap_Pa" not in read(tmp_path / "contact_line_000.vtp").point_data


@pytest.mark.slow
def test_a_gasket_is_whole(tmp_path):
    """Symmetric about the mid-plane; the faces press as hard, and the section is twice that of the half."""
    result = gasket_result()
    for write in (write_contact, write_contact_line):
        write(result, tmp_path)
    assert write_unloaded(result, tmp_path) is not None
    level = result.seal_mesh.contact.seat.extent[1][0]
    for name in ("contact_000.vtu", "contact_001.vtu", "unloaded.vtu"):
        grid = read(tmp_path / name)
        points, nodes = np.array(grid.points), cKDTree(grid.points)
        # the other half of each point, of the body of the other half
        body = np.zeros(len(points), dtype=int)
        body[grid.cells.reshape(-1, 7)[:, 1:].ravel()] = np.repeat(grid["body"], 6)
        twin = np.full(len(points), -1)
        image = points * [1, -1, 1] + [0, 2 * level, 0]
        for own, other in ((0, 2), (1, 1), (2, 0)):
            mine, theirs = np.flatnonzero(body == own), np.flatnonzero(body == other)
            far, found = cKDTree(points[theirs]).query(image[mine])
            assert far.max() < 1e-12
            twin[mine] = theirs[found]
        assert len(nodes.data) == grid.n_points and (twin[twin] == np.arange(len(points))).all()
        np.testing.assert_array_equal(grid["displacement_m"][twin], grid["displacement_m"] * [1, -1, 1])
        for tensor in ("stress_Pa", "plastic_strain"):
            np.testing.assert_array_equal(grid[tensor][twin], grid[tensor] * [1, 1, 1, -1, 1, 1])
        for scalar in ("von_mises_Pa", "contact_pressure_Pa", "accumulated_plastic_strain"):
            np.testing.assert_array_equal(grid[scalar][twin], grid[scalar])
        # nothing keeps the halves of the gasket apart
        on_plane = np.abs(points[:, 1] - level) < 1e-10
        assert on_plane.sum() == len(np.unique(points[on_plane, 0])) > 2
        assert (grid["displacement_m"][on_plane, 1] == 0.0).all()
        cells = grid.cells.reshape(-1, 7)[:, 1:]
        a, b, c = (points[cells[:, corner]] for corner in range(3))
        twice = np.abs(np.cross(b - a, c - a)[:, 2])
        volume = np.pi * twice * (a + b + c)[:, 0] / 3
        calculated = result.seal_mesh.outlines
        slack = 2 * result.seal_mesh.quality.area_error
        for number, outline, times in ((0, calculated[0], 1), (1, calculated[1], 2), (2, calculated[0], 1)):
            area = 0.5 * twice[grid["body"] == number].sum()
            assert area == pytest.approx(times * outline.area, rel=slack)
        assert volume[grid["body"] == 0].sum() == pytest.approx(volume[grid["body"] == 2].sum(), rel=1e-12)
    for n, load in enumerate(result.loads):
        line = read(tmp_path / f"contact_line_{n:03}.vtp")
        assert line.n_lines == 2
        half = line.n_points // 2
        forces = []
        for part in (slice(half), slice(half, None)):
            r, z = line.points[part, 0], line.points[part, 1] - level
            slope = np.gradient(z, line["x_m"][part])
            pressure = line["contact_pressure_Pa"][part] * np.sqrt(1 - slope**2)
            forces.append(-np.sign(z[0]) * np.trapezoid(2 * np.pi * r * pressure, line["x_m"][part]))
        assert forces[0] == pytest.approx(-load.contact_force, rel=2e-3)
        assert sum(forces) == pytest.approx(0.0, abs=1e-9 * load.contact_force)
        # flanges come together
        moved = read(tmp_path / f"contact_{n:03}.vtu")
        upper, lower = (
            moved["displacement_m"][moved.cells.reshape(-1, 7)[moved["body"] == number, 1:], 1].mean()
            for number in (0, 2)
        )
        assert upper == -lower < 0
