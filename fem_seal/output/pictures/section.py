"""The section of a case: for the report, and as a drawing with dimensions.

`fem-seal check --picture` makes the drawing without a calculation. All coordinates are in millimetres.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from fem_seal.errors import InputError
from fem_seal.output.case_words import chosen_dimensions, listed_dimensions, section, section_text
from fem_seal.output.pictures.colours import BLUE, FILL, GREY, INK, ORANGE
from fem_seal.output.pictures.style import INCH, NARROW, Picture, captioned, inches, outside_text, style
from fem_seal.units import number, round_digits, trim_zeros
from meshes.geometry.curve import Curve, Point, Segment

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.case.case import Case
    from fem_seal.units import Display
    from meshes import ContactGeometry, Outline

FORMATS = (".png", ".svg", ".pdf")
_SEAT_FILL, _FLUID_FILL = "#ece7dd", "#eaf4fb"
# An arrow from point to point.
_TO_THE_END = {"shrinkA": 0, "shrinkB": 0}
_WIDTH, _HEIGHT = 11.0, 6.6
# Share of the figure's width that the section takes, and height of a row of dimensions [inch].
_SHARE, _ROW = 0.60, 0.27
_SMALL, _CHARACTER = 8.5, 0.078
# Places on the seat of which the picture of several lands is enlarged.
_PLACES = 401
# Chords of a quarter of a circle, in the section and in the enlarged contact.
_CHORDS, _FINE_CHORDS = 60, 2000
_AXIS_DASHES = (0, (12, 3, 2, 3))
# Height of the report's picture [inch].
_SKETCH = 4.6
# Distance of the rollers, their diameter, and distance of a surface from their middle and from the ground [pt].
_SPACING, _ROLLER, _OFF, _GROUND = 11.0, 5.4, 3.3, 6.6


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
        raise InputError.at("--picture", f"must end with {', '.join(FORMATS)}", str(path))
    kept = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}.get(path.suffix.lower(), {})
    with style():
        figure = section_figure(case)
        try:
            figure.savefig(path, dpi=150, metadata=kept)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError.at("--picture", f"cannot be written ({reason})", str(path)) from None
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
    whole = figure.add_axes((0.01, 0.01, _SHARE, 0.91))
    detail = figure.add_axes((_SHARE + 0.045, 0.45, 0.94 - _SHARE, 0.46))
    listed = figure.add_axes((_SHARE + 0.045, 0.03, 0.94 - _SHARE, 0.37))
    _draw_whole(whole, case)
    _draw_detail(detail, case)
    _list(listed, case)
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
    below_it = _below_mid_plane(case)
    _bodies(axes, contact, mirrored=True, image=below_it)
    low, high = _heights(contact, below_it)
    widest = 1e3 * max(contact.closure.largest_radius, contact.seat.largest_radius)
    below = sorted(_seat_diameters(case), key=lambda diameter: diameter.radius)
    width, height = inches(axes)
    # millimetres per inch, so that the rows of dimensions fit above and below
    rows = len(below) + 1.6
    scale = max(2.1 * widest / width, (high - low) / (height - _ROW * (rows + 1.4)))
    middle = 0.5 * (high + low) + 0.5 * _ROW * scale * (1.2 - rows)
    _frame(axes, 0.5 * width * scale, middle - 0.5 * height * scale, middle + 0.5 * height * scale)
    _fluids(axes, case, widest, low, high)
    if case.gasket is None:
        _supports(axes, case, contact.seat, scale / INCH)
    ends = [low - _ROW * scale * 0.5, high + _ROW * scale * 0.5]
    axes.plot([0, 0], ends, color=INK, lw=0.8, ls=_AXIS_DASHES)
    for row, diameter in enumerate(below, start=1):
        _diameter(case.display, axes, diameter, low - _ROW * scale * row, scale)
    size = 1e3 * contact.closure.largest_radius
    at = max((s.start for s in contact.closure.segments), key=lambda p: (p[0], p[1]))
    widest_of_closure = _Diameter(size, case.label_of("closure"), 1e3 * at[1], INK)
    _diameter(case.display, axes, widest_of_closure, high + _ROW * scale * 0.9, scale)
    angle = getattr(case.seat, "angle", None)
    if angle is not None:
        _included_angle(axes, contact, angle, scale)
    text = f"dimensions in {case.display.fixed_unit('mm').name}; grey: left open by the case, chosen by the program"
    axes.text(0.02, 0.0, text, transform=axes.transAxes, color=GREY, fontsize=8)
    _names(axes, contact)
    _pressures(axes, case, (0.97 * widest, high), (0.0, low), scale)


def _below_mid_plane(case: Case) -> ContactGeometry | None:
    """The contact of a gasket whose image stands below its mid-plane; None of a valve seat."""
    return None if case.gasket is None else case.contacts[-1]


def _heights(contact: ContactGeometry, image: ContactGeometry | None) -> tuple[float, float]:
    """Lowest and highest point of both bodies, and of the image below the mid-plane of a gasket."""
    low, high = zip(contact.closure.extent[1], contact.seat.extent[1], strict=True)
    if image is None:
        return 1e3 * min(low), 1e3 * max(high)
    deep = image.closure.extent[1][1] - _mid_plane(image)
    return 1e3 * (_mid_plane(contact) - deep), 1e3 * max(high)


def _mid_plane(contact: ContactGeometry) -> float:
    """Height of the bottom of the seat, which is the mid-plane of a gasket [m]."""
    return contact.seat.extent[1][0]


def _frame(axes: Axes, reach: float, low: float, high: float) -> None:
    """Set the limits of invisible axes, symmetric about the axis of the seal."""
    axes.set(xlim=(-reach, reach), ylim=(low, high), aspect="equal")
    axes.axis("off")


def _names(axes: Axes, contact: ContactGeometry) -> None:
    """Dots at first touch, and the names of both bodies."""
    r0 = 1e3 * contact.initial_contact_radius
    axes.plot([-r0, r0], [0, 0], "o", color=ORANGE, ms=4.5, zorder=6)
    closure, seat = contact.closure, contact.seat
    inner, outer = seat.extent[0]
    for label, r, z in (
        (closure.label, -0.5 * closure.largest_radius, 0.7 * closure.extent[1][1]),
        (seat.label, -0.5 * (inner + outer), 0.75 * seat.extent[1][0]),
    ):
        place = 1e3 * r, 1e3 * z
        _note(axes, place, label, INK, 1.0, 0.8, fontsize=9.0, ha="center", va="center", zorder=5)


def _seat_diameters(case: Case) -> Iterator[_Diameter]:
    """Bore, contact circle, ends of the face and housing."""
    contact, chosen = case.contact, chosen_dimensions(case, "seat")
    low = 1e3 * contact.seat.extent[1][0]

    def colour(*keys: str) -> str:
        return GREY if set(keys) & set(chosen) else INK

    def height(radius: float) -> float:
        face = contact.seat_face
        ends = face.point(np.array([0.0, face.length]))[0]
        s = face.project_radius(min(max(radius, ends[0]), ends[1]))
        return 1e3 * float(face.point(np.asarray(s))[1])

    inner, outer = contact.seat.extent[0]
    yield _Diameter(1e3 * inner, "bore", low, colour("bore_radius", "land_radius"))
    r0 = contact.initial_contact_radius
    yield _Diameter(1e3 * r0, "contact", 0.0, ORANGE)
    body = case.bodies[1]
    ends = {"face_radius": "face", "land_end": "land", "land_outer_radius": "land", "centre_radius": "ring"}
    for key, name in ends.items():
        radius = getattr(body, key, None)
        if radius:
            yield _Diameter(1e3 * radius, name, height(radius), colour(key, "land_radius"))
    around = "housing" if case.gasket is None else "rim"
    yield _Diameter(1e3 * outer, around, low, colour("outer_radius"))


def _diameter(display: Display, axes: Axes, diameter: _Diameter, z: float, scale: float) -> None:
    """A dimension line across the axis with its extension lines; its text goes outside if it does not fit inside."""
    _on_both_sides(
        axes, [diameter.radius] * 2, [diameter.z, z], color=diameter.colour, lw=0.5, zorder=4, alpha=0.7
    )
    arrow = {"arrowstyle": "<|-|>", "color": diameter.colour, "lw": 0.8, "mutation_scale": 9, **_TO_THE_END}
    axes.annotate("", (-diameter.radius, z), (diameter.radius, z), arrowprops=arrow)
    text = f"{diameter.name} ⌀{_in_unit(display, 2 * diameter.radius)}"
    fits = 2 * diameter.radius / scale > _CHARACTER * len(text) + 0.35
    place = (0.0 if fits else diameter.radius + 0.08 * scale, z)
    _note(axes, place, text, diameter.colour, 0.8, ha="center" if fits else "left", va="center")


def _in_unit(display: Display, size: float, digits: int = 4) -> str:
    """A size [mm] in the unit of the drawing."""
    return trim_zeros(round_digits(display.fixed_unit("mm").of(1e-3 * size), digits))


def _on_both_sides(axes: Axes, r: ArrayLike, z: ArrayLike, **how: Any) -> None:
    """A line and its mirror image."""
    sides = np.array([[1, -1]])
    axes.plot(np.column_stack([r, r]) * sides, np.column_stack([z, z]), **how)


def _note(
    axes: Axes, place: Point, text: str, colour: str, pad: float, alpha: float = 1.0, **how: Any
) -> None:
    """A small text on white."""
    box = {"facecolor": "white", "edgecolor": "none", "pad": pad, "alpha": alpha}
    axes.text(*place, text, **{"color": colour, "fontsize": _SMALL, "bbox": box, "zorder": 7, **how})


def _included_angle(axes: Axes, contact: ContactGeometry, angle: float, scale: float) -> None:
    """The faces of a conical seat continued to the apex, and the angle between them."""
    r0, slope = 1e3 * contact.initial_contact_radius, math.tan(angle)
    apex, out = -r0 * slope, 1.12 * r0
    dashes = (0, (6, 2, 1, 2))
    _on_both_sides(axes, [0, out], [apex, apex + out * slope], color=BLUE, lw=0.8, ls=dashes, zorder=5)
    radius = min(0.62 * r0 / math.cos(angle), 0.75 * scale)
    turn = np.linspace(angle, math.pi - angle, 60)
    axes.plot(radius * np.cos(turn), apex + radius * np.sin(turn), color=BLUE, lw=1.0, zorder=6)
    text = f"{trim_zeros(180 - 2 * math.degrees(angle))}°"
    _note(axes, (0.0, apex + radius), text, BLUE, 0.6, 0.9, ha="center", va="center")


def _pressures(axes: Axes, case: Case, above: Point, below: Point, scale: float) -> None:
    """Names of the two sides: above the seat, and in its bore; of a gasket between the flanges, if there is room."""
    sides = [("low pressure", GREY), ("high pressure", BLUE)]
    (top, top_colour), (bottom, bottom_colour) = sides[:: -1 if case.load.pressure_side == "outer" else 1]
    if case.gasket is None:
        place = above[0], above[1] - 0.1 * scale
        axes.text(*place, top, ha="right", va="top", color=top_colour, fontsize=_SMALL)
        words = bottom.replace(" ", "\n")
        _note(axes, below, words, bottom_colour, 0.6, 0.8, ha="center", va="bottom")
        return
    middle, rim = 1e3 * _mid_plane(case.contact), 1e3 * case.contact.seat.largest_radius
    _note(axes, (0.0, middle), bottom, bottom_colour, 0.6, 0.8, ha="center", va="center")
    if above[0] - rim > scale:
        _note(axes, (above[0], middle), top, top_colour, 0.6, 0.8, ha="right", va="center")
    else:
        axes.text(
            above[0], above[1] + 0.06 * scale, top, ha="right", va="bottom", color=top_colour, fontsize=_SMALL
        )


def _draw_detail(axes: Axes, case: Case) -> None:
    """The contact of the faces, enlarged, with the contact normal and its angle to the axis."""
    contact = case.contact
    _bodies(axes, contact, mirrored=False)
    r0, theta = 1e3 * contact.initial_contact_radius, contact.angle
    r, z, half = (1e3 * end for end in contact_window(case))
    axes.set(xlim=(r - 1.45 * half, r + 1.45 * half), ylim=(z - half, z + half))
    axes.set(aspect="equal", xticks=[], yticks=[])
    axes.set_title(
        f"contact, enlarged; picture {_in_unit(case.display, 2.9 * half, 2)} {case.display.fixed_unit('mm').name} wide",
        fontsize=9,
    )
    axes.plot(r0, 0, "o", color=ORANGE, ms=5, zorder=6)
    normal = 0.75 * half
    end = r0 - normal * math.sin(theta), normal * math.cos(theta)
    axes.plot([r0, end[0]], [0, end[1]], color=BLUE, lw=1.2, zorder=5)
    axes.plot([r0, r0], [0, normal], color=INK, lw=0.8, ls=(0, (8, 3, 2, 3)), zorder=5)
    if abs(theta) > math.radians(3):
        turn = np.linspace(0, theta, 40)
        axes.plot(r0 - 0.55 * half * np.sin(turn), 0.55 * half * np.cos(turn), color=INK, lw=0.9, zorder=6)
    at: dict[str, Any] = {"transform": axes.transAxes}
    angle = f"angle θ = {trim_zeros(round_digits(math.degrees(theta), 4))}°\nbetween axis and normal"
    _note(axes, (0.02, 0.97), angle, INK, 1.5, 0.85, va="top", **at)
    radius = contact.relative_radius
    conform = "faces conform: contact over a finite length"
    bend = conform if math.isinf(radius) else f"relative curvature R {_in_unit(case.display, 1e3 * radius)}"
    _note(axes, (0.98, 0.03), bend, INK, 1.5, 0.85, ha="right", **at)


def contact_window(case: Case) -> tuple[float, float, float]:
    """Middle (r, z) of the enlarged picture and half its height [m]: the contact with its edges if near, all lands.

    Parameters
    ----------
    case : Case
    """
    contact, seat = case.contact, cast("Any", case.bodies[1])
    if contact.chambers:
        places = contact.point(np.linspace(*contact.reach, _PLACES))
        places = places[:, places[0] <= getattr(seat, "land_end", math.inf)]
        low, high = places.min(axis=1), places.max(axis=1)
        return (*(0.5 * (low + high)).tolist(), 0.6 * float((high - low).max()))
    width = getattr(seat, "land_width", None)
    if hasattr(seat, "land_outer_radius"):
        width = seat.land_outer_radius - seat.land_inner_radius
    if width is None and math.isinf(contact.relative_radius):
        low, high = contact.reach
        width = high - low
    if width is None:
        width = 0.5 * min(contact.relative_radius, contact.initial_contact_radius)
    r0 = contact.initial_contact_radius
    return r0, 0.0, min(max(0.6 * width, 0.01 * r0), r0)


def _list(axes: Axes, case: Case) -> None:
    """All dimensions of both bodies below each other."""
    axes.axis("off")
    lines: list[tuple[str, str, str, str]] = []
    for body in case.every_body:
        made_of = f"{body.table.shape}, {outside_text(body.table.material.name)}"
        lines.append((body.label, made_of, INK, "bold"))
        numbers = section(body.case, body.name)
        for key, text in (section_text(case.display, numbers) if numbers else {}).items():
            for row, part in enumerate(text.split(", ")):
                lines.append((key if row == 0 else "", part, INK, "normal"))
        for key, (value, chosen) in listed_dimensions(body.case, body.name).items():
            angle = key.endswith("angle")
            size = case.display.fixed_unit("deg" if angle else "mm").of(value)
            text = trim_zeros(round_digits(size, 4) if chosen else size) + ("°" if angle else "")
            mark = "⌀" if key.endswith("diameter") else "R " if key.endswith("radius") else ""
            lines.append((key.replace("_", " "), mark + text, GREY if chosen else INK, "normal"))
    step = min(0.075, 1.0 / max(len(lines), 1))
    for row, (what, text, colour, weight) in enumerate(lines):
        y = 1 - step * (row + 0.5)
        how: dict[str, Any] = {"color": colour, "fontsize": min(_SMALL, 130 * step), "va": "center"}
        axes.text(0.0 if weight == "bold" else 0.03, y, what, weight=weight, **how)
        axes.text(0.45, y, text, **how)


def _bodies(
    axes: Axes, contact: ContactGeometry, *, mirrored: bool, image: ContactGeometry | None = None
) -> None:
    """Both bodies, on both sides of the axis if `mirrored`; of a gasket also the image below its mid-plane."""
    from matplotlib.patches import Polygon

    sides = (1, -1) if mirrored else (1,)
    # z = level + way z' of the bodies and of their images
    ways = [(contact, 0.0, 1)]
    if image is not None:
        ways.append((image, 1e3 * (_mid_plane(contact) + _mid_plane(image)), -1))
    looks = (("seat", _SEAT_FILL, "////"), ("closure", FILL, "\\\\\\\\"))
    for (name, fill, hatch), (whose, level, way) in product(looks, ways):
        outline: Outline = getattr(whose, name)
        pieces = list(_pieces(outline, _CHORDS if mirrored else _FINE_CHORDS))
        r, z = np.hstack([points for _, points in pieces])
        how: dict[str, Any] = {"facecolor": fill, "edgecolor": "#c3c9d2", "hatch": hatch}
        for side in sides:
            # the limits follow from the lines around it: `add_patch` would check each of its chords in Python
            axes.add_artist(Polygon(np.column_stack([side * r, level + way * z]), lw=0, zorder=2, **how))
        # the body continues beyond the axis
        # nothing ends at the axis, or at the mid-plane of a gasket
        edges = (s for s in pieces if s[0].start[0] or s[0].end[0])
        for r, z in (points for s, points in edges if image is None or s.name != "seat_bottom"):
            edge = np.outer(r, sides), np.outer(level + way * z, np.ones(len(sides)))
            axes.plot(*edge, color=INK, lw=1.2, zorder=3, solid_capstyle="round")


def _pieces(outline: Outline, chords: int) -> Iterator[tuple[Segment, FloatArray]]:
    """Lines and arcs of the section, and their points [mm]."""
    for s in outline.segments:
        curve = Curve((s,))
        count = 2 + math.ceil(chords * abs(s.sweep) / (0.5 * math.pi))
        yield s, 1e3 * curve.point(np.linspace(0, curve.length, 2 if s.centre is None else count))


def sketch(result: SealSolution) -> Picture:
    """The section of the report.

    Parameters
    ----------
    result : SealSolution
    """
    from matplotlib.figure import Figure

    case, contact = result.case, result.case.contact
    figure = Figure(figsize=(NARROW, _SKETCH))
    _draw_whole(figure.add_axes((0.0, 0.02, 1.0, 0.96)), case)
    return captioned(
        result.display,
        figure,
        "sketch",
        "all" if case.gasket is None else "gasket",
        closure=case.closure.shape,
        seat=case.lower.shape,
        angle=number(math.degrees(contact.angle)),
        radius=result.display.quantity(contact.initial_contact_radius, "length"),
        side=case.load.pressure_side,
        **case.labels,
    )


def _fluids(axes: Axes, case: Case, widest: float, low: float, top: float) -> None:
    """Background: the side of the high pressure is tinted; the contact circle separates the two sides."""
    from matplotlib.patches import Rectangle

    fills = ("white", _FLUID_FILL) if case.load.pressure_side == "outer" else (_FLUID_FILL, "white")
    r0 = 1e3 * case.contact.initial_contact_radius
    inner_end = 0.0 if case.gasket is None else top
    for reach, end, fill in ((widest, top, fills[1]), (r0, inner_end, fills[0])):
        axes.add_artist(Rectangle((-reach, low), 2 * reach, end - low, facecolor=fill, lw=0, zorder=1))


def _supports(axes: Axes, case: Case, seat: Outline, scale: float) -> None:
    """Rollers below the bottom of the seat, and along its wall if that is held; arrows where the wall is pressed in."""
    held = {"seat_bottom": (0.0, -scale), "seat_wall": (scale, 0.0)}
    if case.lower.wall != "fixed":
        del held["seat_wall"]
    for s in (s for s in seat.segments if s.name in held):
        start, end = 1e3 * np.array([s.start, s.end])
        count = max(1, round(math.dist(start, end) / scale / _SPACING))
        rollers = start + np.outer((np.arange(count) + 0.5) / count, end - start)
        for side in (1, -1):
            for points, off, how in (
                (rollers, _OFF, {"ls": "none", "marker": "o", "ms": _ROLLER, "mfc": "none", "mew": 0.8}),
                (np.array([start, end]), _GROUND, {"lw": 1.0}),
            ):
                r, z = (points + off * np.array(held[s.name])).T
                axes.plot(side * r, z, color=INK, **cast("Any", how))
    if case.lower.interference:
        wall = 1e3 * np.array([p for s in seat.segments if s.name == "seat_wall" for p in (s.start, s.end)])
        r, z = wall[:, 0].max(), 0.5 * (wall[:, 1].min() + wall[:, 1].max())
        arrow = {"arrowstyle": "-|>", "color": ORANGE, "lw": 1.5, **_TO_THE_END}
        for side in (1, -1):
            axes.annotate("", (side * r, z), (side * (r + 18 * scale), z), arrowprops=arrow)
        text = f"pressed in by {case.display.quantity(case.lower.interference, 'length')}"
        axes.text(r - 4 * scale, z + 6 * scale, text, color=ORANGE, ha="right", fontsize=_SMALL, zorder=5)
