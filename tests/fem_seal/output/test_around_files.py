"""What a seal that is not round leaves in the results folder: around.csv and the surfaces around the axis."""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from around_results import oval_result, smooth_oval_result
from sample_results import single_result

from fem_seal.output import files, vtk
from fem_seal.output.answers.form import around_rows
from fem_seal.output.files import write
from fem_seal.output.tables import write_rows_csv
from fem_seal.output.vtk import write_around
from leak import Reading

COLUMNS = [
    "fluid_pressure_Pa",
    "applied_force_N",
    "angle_rad",
    "line_load_N_per_m",
    "peak_pressure_Pa",
    "fwhm_m",
    "leak_rate_m3_per_s_per_rad",
    "leak_rate_capped_m3_per_s_per_rad",
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("around")
    write_around(oval_result(), folder)
    return folder


def read(path: Path):
    pyvista = pytest.importorskip("pyvista")
    return pyvista.read(path)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="ascii") as file:
        return list(csv.DictReader(file))


def test_csv_has_every_angle_of_every_load(tmp_path):
    result = oval_result()
    written = rows(write_rows_csv(tmp_path / "around.csv", *around_rows(result)))
    assert list(written[0]) == COLUMNS
    assert len(written) == sum(len(load.around.angle) for load in result.loads)
    angles = len(result.loads[0].around.angle)
    for n, load in enumerate(result.loads):
        own = written[n * angles : (n + 1) * angles]
        assert {float(row["fluid_pressure_Pa"]) for row in own} == {load.fluid_pressure}
        assert {float(row["applied_force_N"]) for row in own} == {load.applied_force}
        around = load.around
        for name, values in (
            ("angle_rad", around.angle),
            ("line_load_N_per_m", around.line_load),
            ("peak_pressure_Pa", around.peak_pressure),
            ("fwhm_m", around.fwhm),
            ("leak_rate_m3_per_s_per_rad", around.leak_rate),
            ("leak_rate_capped_m3_per_s_per_rad", load.scenarios[Reading.CAPPED].around.leak_rate),
        ):
            np.testing.assert_allclose([float(row[name]) for row in own], values, rtol=1e-9, atol=1e-300)


def test_csv_columns_are_those_of_the_contact_at_each_line_load():
    """The pressure itself, integrated across and around, against the columns and the force."""
    for load in oval_result().loads:
        around = load.around
        pressure, _ = around.pressure_and_gap()
        line = around.local.mean.model.line
        np.testing.assert_allclose(pressure.max(axis=1), around.peak_pressure, rtol=2e-3)
        axial = np.mean(pressure @ (line.area_weight * line.normal[1]))
        # between rungs of line loads the logarithm of the pressure is interpolated
        assert axial == pytest.approx(load.contact_force, rel=2e-5)


def test_leak_is_empty_where_there_is_none_and_no_row_for_a_round_seal(tmp_path):
    file = write_rows_csv(tmp_path / "around.csv", *around_rows(smooth_oval_result()))
    assert {row["leak_rate_m3_per_s_per_rad"] for row in rows(file)} == {""}
    apart = [row for row in rows(file) if float(row["line_load_N_per_m"]) == 0]
    assert apart and {float(row["peak_pressure_Pa"]) for row in apart} == {0.0}
    assert around_rows(single_result())[1] == []


def test_surface_is_closed_around_the_axis_and_as_large_as_the_face(folder):
    result = oval_result()
    line = result.model.line
    surface = read(folder / "around_000.vtp")
    angles = len(result.loads[0].around.angle)
    # nothing is open but the two edges of the face
    assert surface.n_open_edges == 2 * angles
    # 2 pi int r dx between the outermost points; the face of a cone is straight, r is linear over x
    exact = np.pi * (line.radius[0] + line.radius[-1]) * (line.x[-1] - line.x[0])
    assert surface.area == pytest.approx(exact, rel=3e-4)
    # the quadrilaterals are flat between neighbouring angles: chords instead of arcs, and a little steeper
    n_r, half = line.normal[0, 0], np.pi / angles
    flat = np.sinc(1 / angles) * np.hypot(np.sqrt(1 - n_r**2) * np.cos(half), n_r)
    assert surface.area == pytest.approx(flat * exact, rel=1e-6)
    np.testing.assert_allclose(np.hypot(*surface.points[:, :2].T), np.tile(line.radius, angles), rtol=1e-6)


def test_quadrilaterals_face_the_closure(folder):
    surface = read(folder / "around_000.vtp")
    assert surface.face_normals[:, 2].min() > 0.5


def test_pressure_on_the_surface_carries_the_force(folder):
    """The file alone: pressure times the vertical share of each quadrilateral's area."""
    for n, load in enumerate(oval_result().loads):
        surface = read(folder / f"around_{n:03}.vtp")
        corners = surface.faces.reshape(-1, 5)[:, 1:]
        a, b, c, d = (surface.points.astype(float)[corners[:, k]] for k in range(4))
        upwards = 0.5 * np.cross(c - a, d - b)[:, 2]
        force = surface["contact_pressure_Pa"][corners].mean(axis=1) @ upwards
        # trapezoids over the points of the contact line, and chords of the circle
        assert force == pytest.approx(load.contact_force, rel=2e-3)
        assert force == pytest.approx(surface.field_data["contact_force_N"][0], rel=2e-3)


def test_point_data_is_what_is_known_around_the_axis(folder):
    result = oval_result()
    for n, load in enumerate(result.loads):
        surface, around = read(folder / f"around_{n:03}.vtp"), load.around
        pressure, gap = around.pressure_and_gap()
        points = len(result.model.line.x)
        np.testing.assert_allclose(surface["contact_pressure_Pa"], pressure.ravel(), rtol=1e-6, atol=1e-30)
        np.testing.assert_allclose(surface["gap_m"], gap.ravel(), rtol=1e-6)
        for name, values in (
            ("angle_rad", around.angle),
            ("gap_change_m", around.gap_change),
            ("local_line_load_N_per_m", around.line_load),
            ("leak_rate_m3_per_s_per_rad", around.leak_rate),
        ):
            np.testing.assert_allclose(surface[name], np.repeat(values, points), rtol=1e-6)
        angle = np.arctan2(surface.points[:, 1], surface.points[:, 0]) % (2 * np.pi)
        np.testing.assert_allclose(angle, surface["angle_rad"], atol=1e-6)
        assert surface.field_data["fluid_pressure_Pa"][0] == load.fluid_pressure


def test_without_a_leak_rate_there_is_no_leak_on_the_surface(tmp_path):
    write_around(smooth_oval_result(), tmp_path)
    surface = read(tmp_path / "around_000.vtp")
    assert "leak_rate_m3_per_s_per_rad" not in surface.point_data
    # open where the ring parts
    assert surface["contact_pressure_Pa"].min() == 0 and surface["gap_m"].max() > 1e-6


def test_many_angles_are_thinned_and_still_closed(tmp_path, monkeypatch):
    monkeypatch.setattr(vtk, "_ANGLES", 50)
    result = replace(oval_result(), loads=oval_result().loads[:1])
    write_around(result, tmp_path)
    surface = read(tmp_path / "around_000.vtp")
    # every third of 128
    assert surface.n_open_edges == 2 * 43
    assert surface.n_points == 43 * len(result.model.line.x)


def test_series_and_stale_files(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    result = oval_result()
    written = write_around(result, tmp_path)
    entries = ET.parse(tmp_path / "around.pvd").getroot().findall("Collection/DataSet")
    assert [entry.get("file") for entry in entries] == [path.name for path in written[1:]]
    reader = pyvista.get_reader(str(tmp_path / "around.pvd"))
    assert reader.time_values == [load.fluid_pressure for load in result.loads]
    write_around(replace(result, loads=result.loads[:1]), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["around.pvd", "around_000.vtp"]
    assert write_around(single_result(), tmp_path) == []
    assert list(tmp_path.iterdir()) == []


def test_a_results_folder_has_the_files_until_a_round_seal_takes_it(tmp_path, monkeypatch):
    # the files on their own; reports of oval seals are drawn elsewhere
    monkeypatch.setattr(files, "write_report", lambda result, path, **how: path.write_text("drawn"))
    names = {"around.csv", "around.pvd", "around_000.vtp"}
    assert write(oval_result(), tmp_path) == ()
    assert names <= {path.name for path in tmp_path.iterdir()}
    assert write(single_result(), tmp_path) == ()
    assert not names & {path.name for path in tmp_path.iterdir()}


@pytest.mark.slow
def test_paraview_itself_reads_the_series(folder):
    pvbatch = shutil.which("pvbatch")
    if pvbatch is None:
        pytest.skip("no ParaView on this machine")
    script = Path(__file__).with_name("read_in_paraview.py")
    command = [pvbatch, str(script), str(folder / "around.pvd")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    found, result = json.loads(done.stdout), oval_result()
    assert found["times"] == [load.fluid_pressure for load in result.loads]
    last = result.loads[-1].around
    pressure, _ = last.pressure_and_gap()
    assert found["ranges"]["contact_pressure_Pa"][1] == pytest.approx(pressure.max(), rel=1e-6)
    assert found["ranges"]["leak_rate_m3_per_s_per_rad"] == pytest.approx(
        [last.leak_rate.min(), last.leak_rate.max()], rel=1e-6
    )
    line = result.model.line
    exact = np.pi * (line.radius[0] + line.radius[-1]) * (line.x[-1] - line.x[0])
    assert found["area"] == pytest.approx(exact, rel=3e-4)
