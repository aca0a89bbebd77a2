"""The seal in space: drawn from a results folder, without a display, or said why not."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from around_results import oval_result
from sample_results import rough_result

from fem_seal.cli import app as cli
from fem_seal.errors import DrawingError, InputError, OutputError
from fem_seal.output.pictures import three_d
from fem_seal.output.pictures.style import style
from fem_seal.output.report.page import report

# Without OSMesa's library VTK has no such window, and ends the process.
NOT_HERE = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkOSOpenGLRenderWindow"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("round")
    three_d.write_for_view(rough_result(), folder)
    return folder


@pytest.fixture(scope="module")
def oval(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("oval")
    three_d.write_for_view(oval_result(), folder)
    return folder


@pytest.fixture(scope="module")
def draws(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Skip where VTK cannot draw."""
    pytest.importorskip("pyvista")
    try:
        three_d.view(folder, tmp_path_factory.mktemp("try") / "try.png")
    except DrawingError as error:
        pytest.skip(str(error))


@pytest.fixture
def call(capsys):
    def run(*arguments):
        code = cli.main(["view", *map(str, arguments)])
        out, err = capsys.readouterr()
        return code, out, err

    return run


def read(path: Path) -> np.ndarray:
    """A picture without the scale at the right."""
    from matplotlib.image import imread

    image = imread(path)[..., :3]
    assert image.shape[:2] == three_d._SIZE[::-1]
    return image[:, : int(0.78 * image.shape[1])]


def reddish(image: np.ndarray) -> int:
    """Pixels in the upper colours of the pressure."""
    return int(((image[..., 0] > 0.6) & (image[..., 1] < 0.35) & (image[..., 2] < 0.3)).sum())


def test_png_without_a_display(draws, folder, tmp_path, call, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    png = tmp_path / "seal.png"
    code, out, err = call(folder, "--png", png)
    assert (code, err) == (0, "") and str(png) in out
    image = read(png)
    white = (image == 1).all(axis=2).mean()
    assert 0.3 < white < 0.8
    assert reddish(image) > 50


@pytest.mark.slow
def test_pressure_is_even_on_a_round_seal_and_not_on_an_oval_one(draws, folder, oval, tmp_path):
    """Left and right of the closure the same pressure, but for an oval one, which is loaded most at 0 and 180 deg."""
    halves = {}
    for name, results in (("round", folder), ("oval", oval)):
        three_d.view(results, tmp_path / f"{name}.png", load=1)
        image = read(tmp_path / f"{name}.png")
        left, right = np.split(image, [three_d._SIZE[0] // 2], axis=1)
        # the outer ends of the ring lie at 0 and 270 deg, the inner ones at 90 and 180 deg
        halves[name] = reddish(left), reddish(right)
    assert halves["round"][0] == pytest.approx(halves["round"][1], rel=0.15)
    assert abs(halves["oval"][0] - halves["oval"][1]) > 0.3 * max(halves["oval"])


@pytest.mark.slow
def test_a_result_draws_itself(draws, tmp_path):
    rough_result().view(tmp_path / "first.png", load=1)
    rough_result().view(tmp_path / "last.png")
    first, last = read(tmp_path / "first.png"), read(tmp_path / "last.png")
    assert not np.array_equal(first, last)
    with pytest.raises(InputError, match=r"^load = 4: no such load; the loads are numbered 1 to 3$"):
        rough_result().view(tmp_path / "none.png", load=4)
    with pytest.raises(InputError, match="there is one load"):
        replace(rough_result(), loads=rough_result().loads[:1]).view(tmp_path / "none.png", load=2)


@pytest.mark.slow
def test_closed_sections_of_both_bodies(folder):
    pyvista = pytest.importorskip("pyvista")
    result = rough_result()
    grid = pyvista.read(three_d.loads_in(folder)[0].bodies)
    for number, outline in enumerate(result.seal_mesh.outlines):
        section = three_d._section(grid, number)
        faces, half, _ = three_d._swept(section, (0.0, 180.0))
        assert half.area == pytest.approx(2 * outline.area, rel=2 * result.seal_mesh.quality.area_error)
        # Pappus: volume of half a turn, closed by the two cuts
        corners = section.points[section.faces.reshape(-1, 4)[:, 1:]][..., [0, 2]]
        r = corners[..., 0].mean(axis=1)
        a, b, c = corners.transpose(1, 0, 2)
        (ab_r, ab_z), (ac_r, ac_z) = (b - a).T, (c - a).T
        area = 0.5 * np.abs(ab_r * ac_z - ab_z * ac_r)
        body = faces.merge(half).extract_surface(algorithm="dataset_surface").triangulate()
        volume = body.clean().compute_normals(auto_orient_normals=True).volume
        assert volume == pytest.approx(np.pi * float(area @ r), rel=1e-3)


def test_deformation_is_not_exaggerated(folder):
    pyvista = pytest.importorskip("pyvista")
    files = three_d.loads_in(folder)[-1]
    grid = pyvista.read(files.bodies)
    section = three_d._section(grid, 0)
    moved = section.points[:, [0, 2]] - grid.points[:, :2]
    np.testing.assert_allclose(
        moved[grid.points[:, 0] > 1e-6], grid["displacement_m"][grid.points[:, 0] > 1e-6, :2], atol=1e-12
    )


def test_pressure_in_space_is_that_of_the_files(folder, oval):
    pytest.importorskip("pyvista")
    files = three_d.loads_in(folder)[-1]
    surface, _ = three_d._pressure(files, 0.04)
    profile = rough_result().loads[-1].contact.profile
    assert surface["pressure"].max() == pytest.approx(profile.pressure.max())
    around, times = three_d._pressure(three_d.loads_in(oval)[-1], 0.04)
    pressure, _ = oval_result().loads[-1].around.pressure_and_gap()
    kept = oval_result().loads[-1].around.angle <= 1.5 * np.pi + 1e-9
    np.testing.assert_allclose(around["pressure"], pressure[kept].ravel(), rtol=1e-6)
    # above the face of the seat, and wider around the place of the peak
    middle = profile.x[pressure.max(axis=0).argmax()]
    x = middle + times * (profile.x - middle)
    assert times > 1.0
    assert (around.points[:, 2] > np.tile(oval_result().seal_mesh.contact.height(x), kept.sum())).all()


def test_errors_name_what_is_missing(tmp_path, call, folder, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    code, _, err = call(tmp_path / "nowhere")
    assert code == 2 and "nowhere: no such folder; give the results folder" in err
    (tmp_path / "file").write_text("")
    assert call(tmp_path / "file")[0] == 2
    empty = tmp_path / "empty"
    empty.mkdir()
    code, _, err = call(empty)
    assert code == 2 and "holds no VTK files (contact.pvd)" in err
    (empty / "contact.pvd").write_text("<VTKFile>")
    code, _, err = call(empty)
    assert code == 2 and "contact.pvd: cannot be read" in err
    shutil.copy(folder / "contact.pvd", empty)
    code, _, err = call(empty)
    assert code == 2 and "names contact_000.vtu, which is missing; run the case again" in err
    code, _, err = call(folder, "--load", 7, "--png", tmp_path / "x.png")
    assert code == 2 and "load = 7: no such load; the loads are numbered 1 to 3" in err
    assert not (tmp_path / "x.png").exists()


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="these always have a display")
def test_no_display_is_said_with_the_way_out(folder, call, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    code, _, err = call(folder)
    assert code == 1 and err == (
        "error: there is no display for a window; --png FILE (view(png=...) in Python) draws the seal into a file\n"
    )


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="these always have a display")
def test_a_display_that_does_not_answer_is_none(draws, folder, call, monkeypatch):
    monkeypatch.setenv("DISPLAY", ":4711")
    code, _, err = call(folder)
    assert code == 1 and "there is no display for a window" in err


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_where_vtk_dies_the_program_lives(folder, tmp_path, call, monkeypatch):
    for name, value in NOT_HERE.items():
        monkeypatch.setenv(name, value)
    code, _, err = call(folder, "--png", tmp_path / "x.png")
    if code == 0:
        pytest.skip("OSMesa is installed here")
    assert code == 1 and "VTK cannot draw on this machine" in err
    assert not (tmp_path / "x.png").exists()
    text = report(oval_result(), full=True)
    assert "There is no 3D picture of the seal" in text and 'id="picture-seal"' not in text


def test_report_shows_the_seal(draws):
    text = report(oval_result(), full=True)
    assert 'id="picture-seal"' in text and "There is no 3D picture of the seal" not in text
    with style():
        picture = three_d.seal_picture(oval_result(), three_d.drawn_in_space(oval_result()))
    assert b"contact pressure" in picture.svg and "20 bar" in picture.caption
    assert three_d.seal_picture(oval_result(), None) is None


def test_window_has_a_slider_over_the_loads(draws, folder):
    """Under a virtual display, in a process of its own; the slider is moved by a callback."""
    xvfb = shutil.which("xvfb-run")
    if xvfb is None:
        pytest.skip("no virtual display on this machine")
    script = """
import sys
from pathlib import Path
import pyvista
from fem_seal.output.pictures import three_d
files = three_d.loads_in(Path(sys.argv[1]))
plotter = pyvista.Plotter(window_size=[600, 400])
assert plotter.render_window.GetClassName() not in three_d._WINDOWLESS
three_d._interactive(plotter, files, len(files) - 1)
plotter.show(auto_close=False, interactive=False)
(slider,) = plotter.widgets.slider_widgets if hasattr(plotter, "widgets") else plotter.slider_widgets
text = lambda: plotter.actors["load"].GetInput()
before = text()
slider.GetRepresentation().SetValue(1)
slider.InvokeEvent("EndInteractionEvent")
assert len(plotter.scalar_bars) == 1
print(before, "|", text())
"""
    ready = "the display is up"
    started = ["sh", "-c", f'echo "{ready}" && exec "$@"', "sh", sys.executable, "-c", script, str(folder)]
    done = subprocess.run(
        [xvfb, "-a", "-s", "-screen 0 800x600x24", *started],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    if ready not in done.stdout or "bad X server connection" in done.stderr:
        pytest.skip(f"no virtual display on this machine: {done.stderr.strip()}")
    assert done.returncode == 0, done.stderr
    before, after = done.stdout.strip().splitlines()[-1].split(" | ")
    assert before.startswith("20 bar") and after.startswith("2 bar")


@pytest.mark.usefixtures("unrendered")
def test_a_full_disc_costs_the_picture_and_not_the_report(monkeypatch):
    def full(*arguments):
        raise OutputError("contact_000.vtu: cannot be written (no space left on device)")

    monkeypatch.setattr(three_d, "write_for_view", full)
    assert "There is no 3D picture of the seal" in report(oval_result(), full=True)
