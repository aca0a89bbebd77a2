"""The section of a case as a drawing: both bodies, the dimensions that an engineer looks for, and the contact enlarged.

`fem-seal check --picture` draws it before anything is calculated. All lengths in it are millimetres, as on a drawing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fem_seal.errors import InputError, Problem
from fem_seal.output.case_words import chosen_dimensions, listed_dimensions, section, section_text
from fem_seal.output.pictures.style import BLUE, FILL, GREY, INK, ORANGE, outside_text, style
from fem_seal.units import rounded, trimmed
from meshes.geometry.curve import Curve
from meshes.geometry.segment import Segment

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_seal.arrays import FloatArray
    from fem_seal.case.case import Case
    from meshes import ContactGeometry, Outline

FORMATS = (".png", ".svg", ".pdf")
_SEAT_FILL = "#ece7dd"
_WIDTH, _HEIGHT = 11.0, 6.6
# Share of the figure's width that the section takes, and height of a row of dimensions [inch].
_SHARE, _ROW = 0.60, 0.27
_SMALL, _CHARACTER = 8.5, 0.078
# Chords of a quarter of a circle, in the section and where the contact is enlarged.
_CHORDS, _FINE_CHORDS = 60, 2000


def write_section(case: Case, path: Path) -> Path:
    """Draw the section of a case into a file.

    Parameters
    ----------
    case : Case
    path : pathlib.Path
        Ending with .png, .svg or .pdf; replaced if it exists.

    Raises
    ------
    InputError
        If the name ends otherwise, or nothing can be written there.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(Problem("--picture", f"must end with {', '.join(FORMATS)}", str(path)))
    kept = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}.get(path.suffix.lower(), {})
    with style():
        figure = section_figure(case)
        try:
            figure.savefig(path, dpi=150, metadata=kept)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError(Problem("--picture", f"cannot be written ({reason})", str(path))) from None
    return path


def section_figure(case: Case) -> Figure:
    """The drawing: the section with its dimensions, the contact enlarged, all dimensions of both bodies.

    Parameters
    ----------
    case : Case
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH, _HEIGHT))
    figure.suptitle(outside_text(case.title), x=0.02, y=0.975, ha="left", fontsize=11, weight="bold")
    whole = figure.add_axes((0.01, 0.03, _SHARE, 0.89))
    detail = figure.add_axes((_SHARE + 0.045, 0.45, 0.94 - _SHARE, 0.46))
    listed = figure.add_axes((_SHARE + 0.045, 0.03, 0.94 - _SHARE, 0.37))
    _draw_whole(whole, case)
    _draw_detail(detail, case)
    _list(listed, case)
    figure.text(
        0.02,
        0.015,
        "dimensions in mm; grey: left open by the case, chosen by the program",
        color=GREY,
        fontsize=8,
    )
    return figure


@dataclass(frozen=True)
class _Diameter:
    """A diameter to be drawn: radius [mm], what it is, height of the feature [mm], colour."""

    radius: float
    name: str
    z: float
    colour: str


def _draw_whole(axes: Axes, case: Case) -> None:
    contact = case.contact
    _bodies(axes, contact, mirrored=True)
    seat_low, top = 1e3 * _lowest(contact.seat), 1e3 * _highest(contact.closure)
    widest = 1e3 * max(contact.closure.largest_radius, contact.seat.largest_radius)
    highest = max(top, 1e3 * _highest(contact.seat))
    below = sorted(_seat_diameters(case), key=lambda one: one.radius)
    width, height = _WIDTH * _SHARE, 0.89 * _HEIGHT
    # millimetres per inch, so that the rows of dimensions above and below have their room
    rows = len(below) + 1.6
    scale = max(2.1 * widest / width, (highest - seat_low) / (height - _ROW * (rows + 1.4)))
    axes.set_xlim(-0.5 * width * scale, 0.5 * width * scale)
    middle = 0.5 * (highest + seat_low) + 0.5 * _ROW * scale * (1.2 - rows)
    axes.set_ylim(middle - 0.5 * height * scale, middle + 0.5 * height * scale)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.plot(
        [0, 0],
        [seat_low - _ROW * scale * 0.5, highest + _ROW * scale * 0.5],
        color=INK,
        lw=0.8,
        ls=(0, (12, 3, 2, 3)),
    )
    for row, one in enumerate(below, start=1):
        _diameter(axes, one, seat_low - _ROW * scale * row, scale)
    size = 1e3 * contact.closure.largest_radius
    at = max((s.start for s in contact.closure.segments), key=lambda p: (p[0], p[1]))
    _diameter(axes, _Diameter(size, "closure", 1e3 * at[1], INK), highest + _ROW * scale * 0.9, scale)
    for side in (-1, 1):
        axes.plot(side * 1e3 * contact.touch_radius, 0, "o", color=ORANGE, ms=4.5, zorder=6)
    if hasattr(case.seat, "angle"):
        _included_angle(axes, contact, float(case.seat.angle), scale)
    name: dict[str, Any] = {
        "color": INK,
        "fontsize": 9,
        "ha": "center",
        "va": "center",
        "zorder": 5,
        "bbox": {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.8},
    }
    axes.text(-0.5 * 1e3 * contact.closure.largest_radius, 0.7 * top, "closure", **name)
    inner, outer = 1e3 * _smallest(contact.seat), 1e3 * contact.seat.largest_radius
    axes.text(-0.5 * (inner + outer), 0.75 * seat_low, "seat", **name)
    _pressures(axes, case, highest, seat_low, 0.97 * widest)


def _seat_diameters(case: Case) -> Iterator[_Diameter]:
    """Bore, contact circle, ends of the face and housing."""
    contact, chosen = case.contact, chosen_dimensions(case, "seat")
    low = 1e3 * _lowest(contact.seat)

    def colour(*keys: str) -> str:
        return GREY if set(keys) & set(chosen) else INK

    def height(radius: float) -> float:
        face = contact.seat_face
        ends = face.point(np.array([0.0, face.length]))[0]
        s = face.project_radius(min(max(radius, ends[0]), ends[1]))
        return 1e3 * float(face.point(np.asarray(s))[1])

    inner, outer = _smallest(contact.seat), contact.seat.largest_radius
    yield _Diameter(1e3 * inner, "bore", low, colour("bore_radius", "land_radius"))
    r0 = contact.touch_radius
    yield _Diameter(1e3 * r0, "contact", 0.0, ORANGE)
    body = case.bodies[1]
    ends = {"face_radius": "face", "land_end": "land", "land_outer_radius": "land", "centre_radius": "ring"}
    for key, name in ends.items():
        radius = getattr(body, key, None)
        if radius:
            yield _Diameter(1e3 * radius, name, height(radius), colour(key, "land_radius"))
    yield _Diameter(1e3 * outer, "housing", low, colour("outer_radius"))


def _diameter(axes: Axes, one: _Diameter, z: float, scale: float) -> None:
    """A dimension line across the axis with its extension lines; the text beside it where it has no room inside."""
    for side in (-1, 1):
        axes.plot([side * one.radius] * 2, [one.z, z], color=one.colour, lw=0.5, zorder=4, alpha=0.7)
    axes.annotate(
        "",
        (-one.radius, z),
        (one.radius, z),
        arrowprops={
            "arrowstyle": "<|-|>",
            "color": one.colour,
            "lw": 0.8,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 9,
        },
    )
    text = f"{one.name} ⌀{trimmed(rounded(2 * one.radius, 4))}"
    fits = 2 * one.radius / scale > _CHARACTER * len(text) + 0.35
    axes.text(
        0 if fits else one.radius + 0.08 * scale,
        z,
        text,
        ha="center" if fits else "left",
        va="center",
        color=one.colour,
        fontsize=_SMALL,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
        zorder=7,
    )


def _included_angle(axes: Axes, contact: ContactGeometry, angle: float, scale: float) -> None:
    """The faces of a conical seat continued to the apex, and the angle between them."""
    r0, slope = 1e3 * contact.touch_radius, math.tan(angle)
    apex = (0.0, -r0 * slope)
    out = 1.12 * r0
    for side in (-1, 1):
        axes.plot(
            [0, side * out],
            [apex[1], apex[1] + out * slope],
            color=BLUE,
            lw=0.8,
            ls=(0, (6, 2, 1, 2)),
            zorder=5,
        )
    radius = min(0.62 * r0 / math.cos(angle), 0.75 * scale)
    turn = np.linspace(angle, math.pi - angle, 60)
    axes.plot(radius * np.cos(turn), apex[1] + radius * np.sin(turn), color=BLUE, lw=1.0, zorder=6)
    axes.text(
        0,
        apex[1] + radius,
        f"{trimmed(180 - 2 * math.degrees(angle))}°",
        ha="center",
        va="center",
        color=BLUE,
        fontsize=_SMALL,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.9},
        zorder=7,
    )


def _pressures(axes: Axes, case: Case, high: float, low: float, wide: float) -> None:
    outside = case.load.pressure_side == "outer"
    words = ("high pressure", "low pressure") if outside else ("low pressure", "high pressure")
    colours = (BLUE, GREY) if outside else (GREY, BLUE)
    axes.text(wide, high, words[0], ha="right", va="center", color=colours[0], fontsize=_SMALL)
    axes.text(
        0,
        low,
        words[1].replace(" ", "\n"),
        ha="center",
        va="bottom",
        color=colours[1],
        fontsize=_SMALL,
        zorder=7,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
    )


def _draw_detail(axes: Axes, case: Case) -> None:
    """Where the faces touch, enlarged, with the contact normal and its angle to the axis."""
    contact = case.contact
    _bodies(axes, contact, mirrored=False)
    r0, theta, half = 1e3 * contact.touch_radius, contact.angle, 1e3 * _window(case)
    axes.set_xlim(r0 - 1.45 * half, r0 + 1.45 * half)
    axes.set_ylim(-half, half)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title(f"contact, enlarged; picture {trimmed(rounded(2.9 * half, 2))} mm wide", fontsize=9)
    axes.plot(r0, 0, "o", color=ORANGE, ms=5, zorder=6)
    normal = 0.75 * half
    axes.plot(
        [r0, r0 - normal * math.sin(theta)], [0, normal * math.cos(theta)], color=BLUE, lw=1.2, zorder=5
    )
    axes.plot([r0, r0], [0, normal], color=INK, lw=0.8, ls=(0, (8, 3, 2, 3)), zorder=5)
    if abs(theta) > math.radians(3):
        turn = np.linspace(0, theta, 40)
        axes.plot(r0 - 0.55 * half * np.sin(turn), 0.55 * half * np.cos(turn), color=INK, lw=0.9, zorder=6)
    note = {"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.85}
    axes.text(
        0.02,
        0.97,
        f"angle θ = {trimmed(rounded(math.degrees(theta), 4))}°\nbetween axis and normal",
        transform=axes.transAxes,
        fontsize=_SMALL,
        va="top",
        bbox=note,
        zorder=7,
    )
    radius = contact.relative_radius
    bend = (
        "faces conform: contact along a stretch"
        if math.isinf(radius)
        else f"relative curvature R {trimmed(rounded(1e3 * radius, 4))}"
    )
    axes.text(
        0.98,
        0.03,
        bend,
        transform=axes.transAxes,
        ha="right",
        fontsize=_SMALL,
        color=INK,
        bbox=note,
        zorder=7,
    )


def _window(case: Case) -> float:
    """Half the height of the enlarged picture [m]: the contact with its edges, where they are near."""
    contact, seat = case.contact, cast(Any, case.bodies[1])
    width = getattr(seat, "land_width", None)
    if hasattr(seat, "land_outer_radius"):
        width = seat.land_outer_radius - seat.land_inner_radius
    if width is None and math.isinf(contact.relative_radius):
        low, high = contact.reach
        width = high - low
    if width is None:
        width = 0.5 * min(contact.relative_radius, contact.touch_radius)
    return min(max(0.6 * width, 0.01 * contact.touch_radius), contact.touch_radius)


def _list(axes: Axes, case: Case) -> None:
    """All dimensions of both bodies below each other."""
    axes.axis("off")
    lines: list[tuple[str, str, str]] = []
    for name in ("closure", "seat"):
        body = getattr(case, name)
        lines.append((name, f"{body.shape}, {outside_text(body.material.name)}", "title"))
        drawn = section(case, name)
        for key, text in (section_text(drawn) if drawn else {}).items():
            for row, part in enumerate(text.split(", ")):
                lines.append((key if row == 0 else "", part, INK))
        for key, (value, chosen) in listed_dimensions(case, name).items():
            size = math.degrees(value) if key.endswith("angle") else 1e3 * value
            text = trimmed(rounded(size, 4) if chosen else size) + ("°" if key.endswith("angle") else "")
            mark = "⌀" if key.endswith("diameter") else "R " if key.endswith("radius") else ""
            lines.append((key.replace("_", " "), mark + text, GREY if chosen else INK))
    step = min(0.075, 1.0 / max(len(lines), 1))
    type_size = min(_SMALL, 130 * step)
    for row, (what, text, colour) in enumerate(lines):
        y = 1 - step * (row + 0.5)
        bold = "bold" if colour == "title" else "normal"
        ink = INK if colour == "title" else colour
        axes.text(
            0.0 if colour == "title" else 0.03,
            y,
            what,
            color=ink,
            fontsize=type_size,
            weight=bold,
            va="center",
        )
        axes.text(0.45, y, text, color=ink, fontsize=type_size, va="center")


def _bodies(axes: Axes, contact: ContactGeometry, mirrored: bool) -> None:
    from matplotlib.patches import Polygon

    sides = (1, -1) if mirrored else (1,)
    for outline, fill, hatch in ((contact.seat, _SEAT_FILL, "////"), (contact.closure, FILL, "\\\\\\\\")):
        pieces = list(_pieces(outline, _CHORDS if mirrored else _FINE_CHORDS))
        r, z = np.hstack([points for _, points in pieces])
        for side in sides:
            section = Polygon(
                np.column_stack([side * r, z]),
                facecolor=fill,
                edgecolor="#c3c9d2",
                hatch=hatch,
                lw=0,
                zorder=2,
            )
            # the axes reach as far as the lines around it: `add_patch` would look at each of its chords in Python
            axes.add_artist(section)
        for s, points in pieces:
            # beyond the axis the body goes on
            if not s.start[0] == s.end[0] == 0.0:
                for side in sides:
                    axes.plot(
                        side * points[0], points[1], color=INK, lw=1.2, zorder=3, solid_capstyle="round"
                    )


def _pieces(outline: Outline, chords: int) -> Iterator[tuple[Segment, FloatArray]]:
    """Lines and arcs of the section, and their points [mm]."""
    for s in outline.segments:
        curve = Curve((s,))
        count = 2 + math.ceil(chords * abs(s.sweep) / (0.5 * math.pi))
        yield s, 1e3 * curve.point(np.linspace(0, curve.length, 2 if s.centre is None else count))


def _lowest(outline: Outline) -> float:
    return outline.extent[1][0]


def _highest(outline: Outline) -> float:
    return outline.extent[1][1]


def _smallest(outline: Outline) -> float:
    return outline.extent[0][0]
