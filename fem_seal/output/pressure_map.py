"""What is written and drawn of a map of contact pressure: numbers of its loads, VTK files, where it leaks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.output.pictures import style
from fem_seal.output.vtk import write_cells, write_loads
from fem_seal.seal.load_result import load_name
from fem_seal.seal.surface_profile import MapFace, SurfaceLeak, SurfaceProfile

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray, IntArray


def map_of(load: CaseLoad) -> tuple[SurfaceProfile, SurfaceLeak] | None:
    """Pressures of a map and what flows over it; None for a load that has no map.

    Parameters
    ----------
    load : CaseLoad
    """
    profile, leak = load.whole_profile, load.leak
    return (profile, leak) if isinstance(profile, SurfaceProfile) and isinstance(leak, SurfaceLeak) else None


def arrays_of(load: CaseLoad) -> tuple[FloatArray, IntArray, dict[str, FloatArray], dict[str, FloatArray]]:
    """Points, triangles, point data and cell data of a load on a map, in SI.

    Parameters
    ----------
    load : CaseLoad
    """
    found = map_of(load)
    assert found is not None  # of all who ask
    (profile, leak), surface = found, found[0].face.surface
    of_points = {"contact_pressure_Pa": profile.field, "fluid_pressure_Pa": leak.at_points}
    if profile.opening is not None:
        of_points["gap_m"] = profile.opening
    unit = "m2_per_s" if leak.throughput is None else "kg_per_m_s"
    return surface.points, surface.triangles, of_points, {f"flux_{unit}": leak.over.flux}


def write_map(result: SealSolution, folder: Path) -> list[Path]:
    """Write map.svg, pressure_map.pvd and one pressure_map_000.vtu per load: where the contact presses and leaks.

    Point data: ``contact_pressure_Pa``, ``fluid_pressure_Pa`` above the low side and, where it is given, ``gap_m``.
    Cell data: ``flux_m2_per_s``, the flow per width, of a gas ``flux_kg_per_m_s``.

    Returns
    -------
    list of pathlib.Path
    """

    def write_load(load: CaseLoad, path: Path) -> Path:
        points, triangles, of_points, of_cells = arrays_of(load)
        ends, numbers = (
            3 * np.arange(1, len(triangles) + 1),
            {"fluid_pressure_Pa": np.array([load.fluid_pressure])},
        )
        data = {"point_data": of_points, "cell_data": of_cells, "field_data": numbers}
        return write_cells(path, "Cells", points, triangles.ravel(), ends, **data)

    picture = folder / "map.svg"
    with style.style():
        picture.write_bytes(map_picture(result).svg)
    return [picture, *write_loads(result, folder, "pressure_map", "vtu", write_load)]


def map_picture(result: SealSolution) -> style.Picture:
    """Contact pressure and flow at the highest load.

    Parameters
    ----------
    result : SealSolution
    """
    figure, axes = style.panels(2, height=3.9)
    for panel, of_flow in zip(axes, (False, True), strict=True):
        draw_map(panel, result, of_flow=of_flow)
    name = load_name(result.highest, result.loads, result.display)
    return style.captioned(result.display, figure, "pressure_map", "both", load=name)


def draw_map(axes: Axes, result: SealSolution, *, of_flow: bool = True) -> None:
    """Draw where the highest load leaks, or presses: unrolled around the axis of a ring, else in its plane.

    Parameters
    ----------
    axes : Axes
    result : SealSolution
    of_flow : bool
        Whether the flow is drawn.
    """
    load = result.highest
    _, triangles, of_points, of_cells = arrays_of(load)
    profile = load.whole_profile
    assert isinstance(profile, SurfaceProfile)  # of all who ask
    face = profile.face
    if of_flow:
        (flux,) = of_cells.values()
        areas, title, name = face.surface.areas, "Where it leaks", "flow per width over its mean"
        # pictures of so many triangles are drawn quickly by values at their points
        values = face.at_points(np.linalg.norm(flux, axis=1) * areas)
        values = values / np.maximum(face.at_points(areas), 1e-300) / (values.sum() / areas.sum() or 1.0)
    else:
        values, title = of_points["contact_pressure_Pa"], "Contact pressure"
        unit = result.display.unit_for("contact pressure", float(values.max()))
        values, name = values / unit.size, f"contact pressure  [{unit.name}]"
    places, names = _in_plane(face, result)
    # those that lead around where the unrolled face begins and ends are not shown
    shown = np.ptp(places[triangles, 0], axis=1) < 0.5 * np.ptp(places[triangles, 0])
    u, v = places.T
    from matplotlib.tri import Triangulation

    grid = Triangulation(u, v, triangles[shown])
    drawn = axes.tripcolor(grid, values, shading="gouraud", cmap="YlOrRd", rasterized=True)
    style.figure_of(axes).colorbar(drawn, ax=axes, pad=0.02).set_label(name)
    style.label(axes, title, *names)


def _in_plane(face: MapFace, result: SealSolution) -> tuple[FloatArray, tuple[str, str]]:
    """Places of the points on the paper, and names of both directions."""
    surface, display = face.surface, result.display
    if len(surface.loops) == 2:
        loop, unit = surface.points[surface.loops[0]], display.unit_for("length", face.width)
        axis = int(np.argmax(np.abs(np.cross(loop, np.roll(loop, -1, axis=0)).sum(axis=0))))
        u, v = ((surface.points - loop.mean(axis=0))[:, (axis + step) % 3] for step in (1, 2))
        angle = np.degrees(np.arctan2(v, u))
        names = f"angle around {'xyz'[axis]}  [°]", f"across  [{unit.name}]"
        return np.column_stack([angle, face.across * face.width / unit.size]), names
    used = surface.points[np.unique(surface.triangles)]
    unit = display.unit_for("length", float(np.ptp(used, axis=0).max()))
    ways = np.linalg.svd(used - used.mean(axis=0), full_matrices=False)[2][:2]
    return (surface.points - used.mean(axis=0)) @ ways.T / unit.size, (
        f"u  [{unit.name}]",
        f"v  [{unit.name}]",
    )
