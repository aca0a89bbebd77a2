"""The seal in 3D, cut open, contact pressure and leak paths on the seat's face: drawn by VTK from a results folder.

VTK ends the whole process if it cannot draw. It therefore runs in a separate process, which reads only the files of
the folder.
"""

from __future__ import annotations

import math
import os
import re
import sys
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem_seal.arrays import FloatArray
from fem_seal.errors import DrawingError, InputError
from fem_seal.files import own_tables, problem, write_bytes
from fem_seal.output.pictures.contact import QUARTERS
from fem_seal.output.pictures.style import Picture, captioned
from fem_seal.output.vtk import write_around, write_contact, write_contact_line
from fem_seal.seal.load_result import load_name
from fem_seal.units import Display
from meshes.own_process import OwnProcessError, run_in_subprocess

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display

IntArray = NDArray[np.int64]

# The seat is drawn over three quarters of a turn, the closure over one quarter at the back: left and right of it the
# face of the seat is visible. The lower flange of a gasket is drawn as far as the gasket.
_CLOSURE, _SEAT = (90.0, 180.0), (0.0, 270.0)
_FROM = -45.0, 40.0  # Azimuth and elevation of the camera [deg].
_STEP = 1.0  # Angular step of the surfaces around the axis [deg].
_COLOURS = {"closure": ("#8fb3d9", "#c9dcf0"), "seat": ("#b9a883", "#e6dcc6")}  # face and cut
_INK = "#1c2430"
_COLOUR_MAP = "YlOrRd"
# Leak paths: so many over the seat's face, their radius over the size of the seal, their colours, how far they reach
# beyond the contact, over its width.
_PATHS, _THICK, _FLOW_MAP, _BEYOND = 46, 1.5e-3, "Blues", 0.4
# Pressures below this share of the largest are not shown.
_FAINT = 0.02
# Height of the drawn pressure above the seat's face, over the size of the seal.
_ABOVE = 4e-4
# The contact is drawn so many times wider that it takes this share of the size of the seal, at most so often.
_VISIBLE, _WIDEST = 0.02, 8.0
# A corner of a section gets an edge if the outline turns by more than this [deg].
_CORNER = 25.0
_SIZE = 1200, 820
# Time limit for a picture, and for a window, which a person closes [s].
_SOON, _OPEN = 90.0, 7 * 86400.0
_WINDOWLESS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")


@dataclass(frozen=True)
class LoadFiles:
    """VTK files of a load in a results folder.

    Parameters
    ----------
    bodies, line : pathlib.Path
        Both bodies (.vtu), and the profile across the contact (.vtp).
    around : pathlib.Path or None
        The contact around the axis (.vtp); None of a round seal.
    """

    bodies: Path
    line: Path
    around: Path | None


def loads_in(folder: Path) -> list[LoadFiles]:
    """The loads of a results folder, in their order.

    Parameters
    ----------
    folder : pathlib.Path

    Raises
    ------
    InputError
        If there is no such folder, or it holds no VTK files of a run.
    """
    run = "give the results folder of `fem-seal run`"
    if not folder.is_dir():
        what = "is no folder" if folder.exists() else "no such folder"
        raise InputError.at(str(folder), f"{what}; {run}")
    series = folder / "contact.pvd"
    try:
        entries = ET.parse(series).getroot().findall("Collection/DataSet")
    except FileNotFoundError:
        raise InputError.at(str(folder), f"holds no VTK files (contact.pvd); {run}") from None
    except (OSError, ET.ParseError) as error:
        raise InputError.at(str(series), f"cannot be read ({error}); run the case again") from None
    loads = []
    for entry in entries:
        name = entry.get("file", "")
        match = re.fullmatch(r"contact_(\d+)\.vtu", name)
        number = match[1] if match else ""
        bodies, line, around = (
            folder / file for file in (name, f"contact_line_{number}.vtp", f"around_{number}.vtp")
        )
        for path in (bodies, line):
            if not (number and path.is_file()):
                raise InputError.at(str(series), f"names {path.name}, which is missing; run the case again")
        loads.append(LoadFiles(bodies, line, around if around.is_file() else None))
    if not loads:
        raise InputError.at(str(series), f"names no load; {run}")
    return loads


def view(
    folder: Path, png: Path | None = None, load: int | None = None, display: Display | None = None
) -> None:
    """Show the seal of a results folder in a window, or draw it into a file.

    Parameters
    ----------
    folder : pathlib.Path
    png : pathlib.Path, optional
        Draw into this file and open no window.
    load : int, optional
        Number of the load, from 1; the last one unless given. The window has a slider for the others.
    display : Display, optional
        That of a folder, which says nothing of it, unless given.

    Raises
    ------
    InputError
        If the folder holds no results, or not this load.
    DrawingError
        If there is no display for a window, or VTK cannot draw here at all.
    OutputError
        If the file cannot be written.
    """
    # of the process that draws it would come back as a fault of the machine
    if find_spec("pyvista") is None:
        raise ModuleNotFoundError("no pyvista", name="pyvista")
    files, display = loads_in(folder), display or Display()
    number = len(files) if load is None else load
    if not 1 <= number <= len(files):
        only = "there is one load" if len(files) == 1 else f"the loads are numbered 1 to {len(files)}"
        raise InputError.at("load", f"no such load; {only}", str(load))
    if png is not None:
        write_bytes(png, _draw_in_subprocess(_SOON, _png, display, files[number - 1], True))
        return
    if sys.platform not in ("win32", "darwin") and not os.environ.get("DISPLAY"):
        raise DrawingError(_NO_DISPLAY)
    if not _draw_in_subprocess(_OPEN, _window, display, files, number - 1):
        raise DrawingError(_NO_DISPLAY)


_NO_DISPLAY = (
    "there is no display for a window; --png FILE (view(png=...) in Python) draws the seal into a file"
)


def drawn_in_space(result: SealSolution) -> bytes | None:
    """The highest load of a result as PNG, without a colour scale; None where VTK cannot draw.

    Parameters
    ----------
    result : SealSolution
    """
    try:
        with TemporaryDirectory(prefix="fem-seal-") as name:
            folder = Path(name)
            write_for_view(replace(result, loads=(result.highest,)), folder)
            image: bytes = _draw_in_subprocess(_SOON, _png, result.display, loads_in(folder)[0], False)
            return image
    except (DrawingError, OSError):
        return None


def write_for_view(result: SealSolution, folder: Path) -> None:
    """Write the files that `view` reads.

    Parameters
    ----------
    result : SealSolution
    folder : pathlib.Path
    """
    write_contact(result, folder)
    write_contact_line(result, folder)
    write_around(result, folder)


def seal_picture(result: SealSolution, image: bytes | None) -> Picture | None:
    """The seal in 3D with a colour scale; None without an image.

    Parameters
    ----------
    result : SealSolution
    image : bytes or None
        From `drawn_in_space`.
    """
    if image is None:
        return None
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from matplotlib.image import imread

    load = result.highest
    peak = max(profile.pressure.max() for profile in load.profiles)
    if load.around is not None:
        peak = load.around.pressure_and_gap()[0].max()
    unit = result.display.unit_for("contact pressure", float(peak))
    scene = _without_margins(imread(BytesIO(image)))
    height, scale = 4.4, 1.1
    width = height * scene.shape[1] / scene.shape[0]
    figure = Figure(figsize=(width + scale, height))
    axes = figure.add_axes((0.0, 0.0, width / (width + scale), 1.0))
    axes.imshow(scene, aspect="auto")
    axes.axis("off")
    bar = figure.colorbar(
        ScalarMappable(Normalize(0.0, unit.of(float(peak))), _COLOUR_MAP),
        cax=figure.add_axes(((width + 0.2) / (width + scale), 0.14, 0.16 / (width + scale), 0.72)),
        format="%.3g",
    )
    bar.set_label(f"contact pressure  [{unit.name}]")
    bar.outline.set_linewidth(0.5)
    name = load_name(load, result.loads, result.display)
    return captioned(result.display, figure, "seal", "scene", load=name, **result.case.labels)


def _without_margins(image: FloatArray) -> FloatArray:
    """The part of an image, shape (rows, columns, colours), that is not white."""
    inked = image[..., :3].min(axis=2) < 1.0
    rows, columns = np.flatnonzero(inked.any(axis=1)), np.flatnonzero(inked.any(axis=0))
    return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def _draw_in_subprocess(time_limit: float, function: Any, /, *arguments: object) -> Any:
    try:
        return run_in_subprocess(time_limit, function, *arguments)
    except OwnProcessError as error:
        raise DrawingError(problem("vtk", error=error)) from None


# --- what follows happens in a process of its own ----------------------------------------------------------


def _png(display: Display, files: LoadFiles, scale: bool) -> bytes:
    """The picture of a load; `scale`: with a colour scale and the name of the load."""
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(_SIZE))
    _set_scene(display, plotter, files, scale)
    out = BytesIO()
    plotter.screenshot(out)
    plotter.close()
    return out.getvalue()


def _window(display: Display, files: Sequence[LoadFiles], number: int) -> bool:
    """Show the loads in a window until it is closed; False if there is no display."""
    import pyvista

    plotter = pyvista.Plotter(window_size=list(_SIZE), title="fem-seal")
    if plotter.render_window.GetClassName() in _WINDOWLESS:
        return False
    _interactive(display, plotter, files, number)
    plotter.show()
    return True


def _interactive(display: Display, plotter: Any, files: Sequence[LoadFiles], number: int) -> None:
    """The scene of a load, and a slider for the others if there are any."""
    _set_scene(display, plotter, files[number], True)
    if len(files) > 1:
        plotter.add_slider_widget(
            lambda value: _draw(display, plotter, files[round(value) - 1], True),
            (1, len(files)),
            value=number + 1,
            color=_INK,
            **own_tables("pictures.toml")["in_space"]["slider"],
        )


def _set_scene(display: Display, plotter: Any, files: LoadFiles, scale: bool) -> None:
    """Set background, scene of a load, and camera."""
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    _draw(display, plotter, files, scale)
    azimuth, elevation = np.radians(_FROM)
    across = math.cos(elevation)
    plotter.camera.parallel_projection = False
    way = across * math.cos(azimuth), across * math.sin(azimuth), math.sin(elevation)
    plotter.view_vector(way, viewup=(0.0, 0.0, 1.0))
    # two flanges reach up to where the load is named
    plotter.camera.zoom(1.2 if "lower flange cut" in plotter.actors else 1.4)


def _draw(display: Display, plotter: Any, files: LoadFiles, scale: bool) -> None:
    """Put the scene of a load into a plotter, replacing the present one."""
    import pyvista

    grid, layout = pyvista.read(files.bodies), own_tables("pictures.toml")["in_space"]
    size = float(np.ptp(grid.points[:, :2], axis=0).max())
    bodies = (("closure", _CLOSURE, "closure"), ("seat", _SEAT, "seat"), ("lower flange", _SEAT, "closure"))
    for number, (name, turn, colours) in enumerate(bodies[: 1 + int(grid["body"].max())]):
        face, cut = _COLOURS[colours]
        meshes = _swept(_section(grid, number), turn)
        for what, mesh, colour in zip(("face", "cut", "edges"), meshes, (face, cut, _INK), strict=True):
            plotter.add_mesh(mesh, color=colour, name=f"{name} {what}", render=False, **layout[what])
    surface, times = _pressure(files, size, int(grid["body"].max()))
    unit = display.unit_for("contact pressure", float(surface["pressure"].max()))
    surface["pressure"] = unit.of(1.0) * surface["pressure"]
    highest = float(surface["pressure"].max())
    patch = surface.threshold(_FAINT * highest, scalars="pressure")
    for bar in list(plotter.scalar_bars.keys()):
        plotter.remove_scalar_bar(bar, render=False)
    plotter.add_mesh(
        patch,
        scalars="pressure",
        cmap=_COLOUR_MAP,
        clim=(0.0, highest),
        lighting=False,
        name="pressure",
        render=False,
        show_scalar_bar=scale,
        scalar_bar_args={"title": f"contact pressure [{unit.name}]", "color": _INK, **layout["colours"]},
    )
    leak = _leak_paths(display, plotter, surface, size)
    if scale:
        pressure, force = (
            float(grid.field_data[name][0]) for name in ("fluid_pressure_Pa", "contact_force_N")
        )
        text = f"{display.quantity(pressure, 'given fluid pressure')}, contact force {display.quantity(force, 'force')}"
        text += "" if times == 1.0 else f", contact drawn {times:.2g} times as wide"
        text += (
            leak
            and f"\nblue: where it leaks, the darker the more; at most {leak} for each millimetre around the axis"
        )
        plotter.add_text(
            text, position=(0.02, 0.92), viewport=True, font_size=12, color=_INK, name="load", render=False
        )


def _leak_paths(display: Display, plotter: Any, surface: Any, size: float) -> str:
    """Draw the ways of the fluid across the contact; the largest leak rate per mm, empty where nothing leaks."""
    import pyvista

    plotter.remove_actor("leak", render=False)
    if "leak" not in surface.point_data or not (most := float(surface["leak"].max())) > 0.0:
        return ""
    across, around, _ = surface.dimensions
    points, pressure, leak = (
        np.asarray(values).reshape(around, across, -1)
        for values in (surface.points, surface["pressure"], surface["leak"])
    )
    ways = []
    for n in np.unique(np.linspace(0, around - 1, _PATHS).astype(int)):
        (pressed,) = np.nonzero(pressure[n, :, 0] > _FAINT * pressure.max())
        if len(pressed) and leak[n, 0, 0] > 0.0:
            first, last = pressed[[0, -1]]
            beyond = math.ceil(_BEYOND * (last - first))
            way = pyvista.lines_from_points(points[n, max(first - beyond, 0) : last + beyond + 1])
            way["leak"] = np.full(way.n_points, leak[n, 0, 0])
            ways.append(way)
    tubes = pyvista.merge(ways).extract_surface().tube(_THICK * size, n_sides=8)
    look = {
        "scalars": "leak",
        "cmap": _FLOW_MAP,
        "clim": (0.0, most),
        "show_scalar_bar": False,
        "lighting": False,
    }
    plotter.add_mesh(tubes, name="leak", render=False, **look)
    return display.quantity(1e-3 * most, "flow")


def _section(grid: Any, body: int) -> Any:
    """The section of one body in the grid of all, as triangles at angle 0, displaced by the load."""
    import pyvista

    place = np.array(grid.points + grid.point_data["displacement_m"])[:, [0, 2, 1]]
    place[:, 0] = np.maximum(place[:, 0], 0.0)
    triangles = grid.cells.reshape(-1, 7)[:, 1:][grid["body"] == body][:, QUARTERS].reshape(-1, 3)
    return pyvista.PolyData(place, faces=np.insert(triangles, 0, 3, axis=1))


def _swept(section: Any, turn: tuple[float, float]) -> tuple[Any, Any, Any]:
    """Faces of a body over a part of the turn [deg], the cuts at both ends, and edges: of the cuts and at corners."""
    import pyvista

    alone = {"manifold_edges": False, "non_manifold_edges": False}
    outline = section.extract_feature_edges(feature_edges=False, **alone)
    cut, edges = (pyvista.merge([mesh.rotate_z(end) for end in turn]) for mesh in (section, outline))
    first, last = turn
    steps = round((last - first) / _STEP)
    whole = outline.extrude_rotate(resolution=steps, angle=last - first, capping=False).rotate_z(first)
    # without degenerate triangles on the axis, all with the same orientation
    faces = pyvista.PolyData(whole.points, faces=whole.triangulate().faces).clean()
    faces = pyvista.PolyData(faces.points, faces=faces.faces).compute_normals(split_vertices=False)
    corners = faces.extract_feature_edges(_CORNER, boundary_edges=False, **alone)
    normals = faces.compute_normals(feature_angle=_CORNER, split_vertices=True, cell_normals=False)
    return normals, cut, edges.merge(corners)


def _pressure(files: LoadFiles, size: float, faces: int = 1) -> tuple[Any, float]:
    """The seat's face with its contact pressure, over the drawn part of the turn, a little raised, and drawn wider."""
    import pyvista

    line = pyvista.read(files.line)
    upper = slice(len(line.points) // faces)
    section = np.asarray(line.points[upper, :2])
    if files.around is None:
        first, last = _SEAT
        angles = np.radians(np.linspace(first, last, round((last - first) / _STEP) + 1))
        pressure = np.tile(np.asarray(line.point_data["contact_pressure_Pa"])[upper], (len(angles), 1))
        whole = line.field_data.get("leak_rate_m3_per_s")
        leak = None if whole is None else np.full(len(angles), whole[0] / math.tau)
    else:
        around = pyvista.read(files.around)
        shape = -1, len(section)
        angle, pressure = (
            np.asarray(around.point_data[name]).reshape(shape)
            for name in ("angle_rad", "contact_pressure_Pa")
        )
        kept = angle[:, 0] <= math.radians(_SEAT[1]) * (1 + 1e-6)
        angles, pressure = angle[kept, 0], pressure[kept]
        leak = around.point_data.get("leak_rate_m3_per_s_per_rad")
        leak = None if leak is None else np.asarray(leak).reshape(shape)[kept, 0]
    highest = pressure.max(axis=0)
    width = float(np.linalg.norm(np.ptp(section[highest > 0.5 * highest.max()], axis=0)))
    times = float(np.clip(_VISIBLE * size / max(width, 1e-3 * _VISIBLE * size), 1.0, _WIDEST))
    middle = section[highest.argmax()]
    section = middle + times * (section - middle)
    tangent = section[-1] - section[0]
    up = np.array([-tangent[1], tangent[0]]) / np.linalg.norm(tangent)
    r, z = (section + _ABOVE * size * up).T
    across = np.outer(z, np.ones(len(angles)))
    surface = pyvista.StructuredGrid(np.outer(r, np.cos(angles)), np.outer(r, np.sin(angles)), across)
    surface["pressure"] = pressure.ravel().astype(float)
    if leak is not None:
        surface["leak"] = np.repeat(leak / middle[0], len(section))
    return surface, times
