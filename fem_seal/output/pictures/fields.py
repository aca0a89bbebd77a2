"""Pictures of the bodies: mesh, stress under the contact, imprint and plastic strain."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem_seal.bodies.fields import BodyField, ElastoplasticField
from fem_seal.contact.solution import plastic_zone
from fem_seal.output.columns import in_words
from fem_seal.output.pictures.colours import BLUE, INK, ORANGE
from fem_seal.output.pictures.style import Picture, captioned, label, panels
from fem_seal.output.prose import phrase
from fem_seal.seal.load_names import load_name
from fem_seal.units import fixed_unit, unit_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet

    from fem_seal.answers.case_load import CaseLoad, SolvedSeal
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.contact.load_path import Unloaded
    from meshes import ContactGeometry, SealMesh

IntArray = NDArray[np.int64]

# A quadratic triangle as four linear ones.
QUARTERS = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]
_BANDS = 12
_MOST_LINES = 10_000
# Space for the numbers and the name of a colour scale [inch].
SCALE_ROOM = 0.8
# Height of a view of the contact zone, over its width.
HEIGHT = 0.8


def mesh_picture(result: SealSolution, load: CaseLoad) -> Picture:
    """The whole mesh, and the contact zone.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        Its width sets how much of the contact zone is shown.
    """
    seal_mesh, quality, size = result.seal_mesh, result.seal_mesh.quality, fixed_unit("mm")
    mesh, contact = seal_mesh.mesh, seal_mesh.contact
    figure, (whole, zone) = panels(2, height=4.4, ratios=(1.0, 1.35))
    for name, colour in (("closure", BLUE), ("seat", "#8a6d3b")):
        edges = _edges(mesh.t[:, (mesh.subdomains or {})[name]])
        # an image: a drawing of so many lines is larger
        many = edges.shape[1] > _MOST_LINES
        whole.plot(*_polyline(mesh.p / size.size, edges), color=colour, linewidth=0.25, rasterized=many)
        place = turned(seal_mesh, mesh.p.T).T
        half = half_width(load)
        close = (np.abs(place[:, edges]).min(axis=1) < 1.8 * half).all(axis=0)
        unit = unit_for("length", 2 * half)
        zone.plot(*_polyline(place / unit.size, edges[:, close]), color=colour, linewidth=0.55)
    whole.set_aspect("equal")
    label(whole, "Both bodies", f"r  [{size.name}]", f"z  [{size.name}]")
    whole.plot(contact.initial_contact_radius / size.size, 0.0, "o", mfc="none", mec=ORANGE, ms=9, mew=1.6)
    frame_zone(zone, half / unit.size, unit.name, "Contact zone, turned so that the contact lies flat")
    smallest = float(np.diff(result.model.line.vertices).min())
    return captioned(
        figure,
        "mesh",
        "all",
        quality=quality,
        unknowns=sum(body.held.size for body in result.model.bodies.values()),
        size=smallest,
    )


def stress_picture(result: SealSolution, load: CaseLoad) -> Picture:
    """von Mises stress under the contact, in two magnifications.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        The load to show.
    """
    figure, axes = panels(2, height=4.3, side=SCALE_ROOM)
    fields = load.contact.fields
    unit = unit_for("contact pressure", load.max_von_mises)
    half = half_width(load)
    levels = even_levels(0.0, unit.of(load.max_von_mises))
    stresses = {name: unit.of(1.0) * field.von_mises for name, field in fields.items()}
    _draw_zone(axes[0], result, fields, stresses, levels, 4.0 * half, "Around the contact")
    bands = _draw_zone(axes[1], result, fields, stresses, levels, half, "Under the contact")
    scale_of_colours(axes, bands, f"von Mises stress  [{unit.name}]")
    body, r, z = load.max_von_mises_at
    largest_at = turned(result.seal_mesh, np.array([[r, z]]))[0]
    # of several lands the enlarged one need not have it
    for view, reach in zip(axes, (4.0 * half, half), strict=True):
        if np.all(np.abs(largest_at) < reach):
            view.plot(*(largest_at / unit_for("length", 2 * reach).size), "x", color=INK, ms=6, mew=1.2)
    depth = float(largest_at[1])
    return captioned(
        figure,
        "stress",
        "all",
        largest=in_words(load, "max_von_mises_Pa"),
        body=result.case.label_of(body),
        **result.case.labels,
        load=load_name(load, result.loads),
        depth=abs(depth),
        digits=load.digits_of("fwhm"),
        side="below" if depth < 0 else "above",
    )


def temperature_picture(result: SealSolution, load: CaseLoad) -> Picture | None:
    """Temperature of both bodies, the whole section and around the contact; None unless it was calculated.

    Parameters
    ----------
    result : SealSolution
    load : CaseLoad
        Its width sets how much of the contact zone is shown.
    """
    fields = load.contact.fields
    size, degree = fixed_unit("mm"), unit_for("temperature", 300.0)
    degrees = {
        name: (f.temperature - degree.zero) / degree.size
        for name, f in fields.items()
        if f.temperature is not None
    }
    if result.problem.at_rest.heating is None or len(degrees) < len(fields):
        return None
    low, high = (end(float(end(values)) for values in degrees.values()) for end in (min, max))
    # a uniform temperature has one colour
    levels = even_levels(low, max(high, low + 1e-3))
    figure, axes = panels(2, height=4.4, side=SCALE_ROOM)
    for name, field in fields.items():
        _fill_bands(axes[0], field.points / size.size, field, degrees[name], levels, "inferno")
    axes[0].set_aspect("equal")
    label(axes[0], "Both bodies", f"r  [{size.name}]", f"z  [{size.name}]")
    reach = 8.0 * half_width(load)
    bands = _draw_zone(axes[1], result, fields, degrees, levels, reach, "Around the contact", "inferno")
    scale_of_colours(axes, bands, f"temperature  [{degree.name}]")
    contact = load.contact_temperature
    assert contact is not None  # both fields are known
    low, high = low + 273.15, high + 273.15
    return captioned(figure, "temperature", "all", low=low, high=high, contact=contact)


def half_width(load: CaseLoad) -> float:
    """Half the width of the enlarged views along the contact [m]."""
    return 4.2 * load.std


def turned(seal_mesh: SealMesh, points: FloatArray) -> FloatArray:
    """(r, z) in the frame of the contact: along the tangent, along the normal; shape (n, 2) [m]."""
    contact = seal_mesh.contact
    n_r, n_z = contact.normal(np.zeros(1))[:, 0]
    r, z = points[:, 0] - contact.initial_contact_radius, points[:, 1]
    return np.column_stack([r * n_z - z * n_r, r * n_r + z * n_z])


def near(place: FloatArray, triangles: IntArray, reach: float) -> IntArray:
    """Triangles of which a part may lie within `reach` of first touch."""
    # the triangles on the last axis are compared all at once
    corners = place.T[:, triangles.T]
    low, high = corners.min(axis=1), corners.max(axis=1)
    inside = (low < reach) & (high > -reach)
    return np.asarray(triangles[inside.all(axis=0)])


def even_levels(low: float, high: float, count: int = _BANDS) -> FloatArray:
    """Ends of about `count` bands of colours at round numbers, from `low` to beyond `high`."""
    from matplotlib.ticker import MaxNLocator

    return np.asarray(MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))


def _fill_bands(
    axes: Axes,
    place: FloatArray,
    field: BodyField,
    values: FloatArray,
    levels: ArrayLike,
    colours: str,
    reach: float = math.inf,
) -> ContourSet:
    """Values in the points of a body as bands of colours, where it lies within `reach` of first touch."""
    from matplotlib.tri import Triangulation

    triangles = near(place, field.triangles6[:, QUARTERS].reshape(-1, 3), reach)
    return axes.tricontourf(
        Triangulation(place[:, 0], place[:, 1], triangles), values, levels=levels, cmap=colours
    )


def _draw_zone(
    axes: Axes,
    result: SolvedSeal,
    fields: Mapping[str, BodyField],
    values: Mapping[str, FloatArray],
    levels: ArrayLike,
    reach: float,
    title: str,
    colours: str = "YlOrRd",
) -> ContourSet:
    """Both bodies within `reach` of first touch [m], with bands of colours where a body has values."""
    length, bands = unit_for("length", 2 * reach), []
    for name, field in fields.items():
        place = turned(result.seal_mesh, field.points) / length.size
        if name in values:
            bands.append(_fill_bands(axes, place, field, values[name], levels, colours, reach / length.size))
        axes.plot(*place[field.contact_nodes].T, color=INK, linewidth=0.8)
    frame_zone(axes, reach / length.size, length.name, title)
    return bands[-1]


def scale_of_colours(axes: Sequence[Axes], bands: ContourSet, text: str, *, lowest: str = "") -> None:
    """The colour scale next to the last of the axes, in `SCALE_ROOM`; `lowest` replaces its first number."""
    figure = axes[0].get_figure(root=True)
    assert figure is not None
    bar = figure.colorbar(bands, ax=axes, fraction=0.03, pad=0.015, aspect=28, format="%.3g")
    if lowest:
        ticks = bar.get_ticks().tolist()
        bar.set_ticks(ticks, labels=[lowest, *(f"{tick:.3g}" for tick in ticks[1:])])
    bar.set_label(text)
    bar.outline.set_linewidth(0.5)


def frame_zone(axes: Axes, reach: float, unit: str, title: str) -> None:
    """Limits and labels of a view of the contact zone."""
    axes.set_aspect("equal")
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-HEIGHT * reach, HEIGHT * reach)
    label(axes, title, f"along the contact, outwards  [{unit}]", f"along the normal  [{unit}]")


def _edges(triangles: IntArray) -> IntArray:
    """Edges of triangles, each of them once, shape (2, n)."""
    first, second = np.sort(np.hstack([triangles[[0, 1]], triangles[[1, 2]], triangles[[2, 0]]]), axis=0)
    # one number for both ends: a search for unique rows is much slower
    count = int(triangles.max()) + 1
    return np.stack(np.divmod(np.unique(first.astype(np.int64) * count + second), count))


def _polyline(points: FloatArray, edges: IntArray) -> FloatArray:
    """x and y of all edges in one broken line."""
    ends = points[:, edges]
    gaps = np.full((2, 1, edges.shape[1]), np.nan)
    return np.concatenate([ends, gaps], axis=1).transpose(0, 2, 1).reshape(2, -1)


_COLOURS = {"seat": BLUE, "closure": ORANGE}
# Shown width to each side in widths of the imprint, and shown height in depths of the yielded zone.
_WIDTHS, _DEPTHS = 1.6, 1.5
_STRAIN_BANDS = 10


def imprint_picture(result: SealSolution) -> Picture | None:
    """The permanent imprint, and the plastic strain below it; None if nothing has yielded.

    Parameters
    ----------
    result : SealSolution
    """
    faces = [one for one in result.faces if one.unloaded is not None and one.unloaded.imprints]
    if not faces:
        return None
    # of two different flanges the upper one, if it has yielded
    face, unloaded = faces[0], faces[0].unloaded
    assert unloaded is not None
    figure, (depth, strain) = panels(2, height=4.0, side=SCALE_ROOM)
    _imprints(depth, unloaded, face.problem.contact)
    strains = _strains(strain, face, unloaded)
    digits = result.strongest.digits_of("fwhm")
    imprints = "; ".join(
        phrase(
            "captions.imprint",
            "one",
            body=face.problem.contact.label_of(name),
            imprint=imprint,
            digits=digits,
        )
        for name, imprint in unloaded.imprints.items()
    )
    return captioned(
        figure, "imprint", "all", imprints=imprints, strains=strains, **face.problem.contact.labels
    )


def _imprints(axes: Axes, unloaded: Unloaded, contact: ContactGeometry) -> None:
    imprints = unloaded.imprints
    reach = max(_WIDTHS * imprint.width + abs(imprint.deepest_at) for imprint in imprints.values())
    length = unit_for("length", reach)
    height = unit_for("length", max(imprint.deepest for imprint in imprints.values()))
    for name, imprint in imprints.items():
        label_of = contact.label_of(name)
        axes.plot(imprint.x / length.size, imprint.depth / height.size, color=_COLOURS[name], label=label_of)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_xlim(-reach / length.size, reach / length.size)
    axes.invert_yaxis()
    label(axes, "Permanent imprint", f"x  [{length.name}]", f"depth  [{height.name}]", legend="best")


def _strains(axes: Axes, result: SolvedSeal, unloaded: Unloaded) -> str:
    """Plastic strain of all bodies that yield; returns its reach."""
    fields = {n: field for n, field in unloaded.fields.items() if isinstance(field, ElastoplasticField)}
    materials = result.problem.materials
    found = {name: plastic_zone(field, materials[name]) for name, field in fields.items()}
    zones = {name: zone for name, zone in found.items() if zone is not None}
    widest = max(imprint.width for imprint in unloaded.imprints.values())
    reach = max(_WIDTHS * widest, *(_DEPTHS / HEIGHT * zone.deepest for zone in zones.values()))
    largest = max(float(field.accumulated_plastic_strain.max()) for field in fields.values())
    # few digits, so that the numbers of the scale fit
    size, unit = (1e-2, "%") if largest > 1e-3 else (1e-6, "10⁻⁶")
    largest /= size
    # elastic zones stay white
    levels = [largest / 100, *even_levels(0.0, largest, _STRAIN_BANDS)[1:]]
    strains = {name: field.accumulated_plastic_strain / size for name, field in fields.items()}
    bands = _draw_zone(axes, result, unloaded.fields, strains, levels, reach, "Plastic strain")
    scale_of_colours([axes], bands, f"accumulated plastic strain  [{unit}]", lowest="0")
    digits = result.strongest.digits_of("fwhm")
    return " ".join(
        phrase(
            "captions.imprint", "zone", body=result.problem.contact.label_of(name), zone=zone, digits=digits
        )
        for name, zone in zones.items()
    )
