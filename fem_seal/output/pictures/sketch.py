"""The case at a glance: both bodies in section, their dimensions and how they are held."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.output.case_words import chosen_dimensions
from fem_seal.output.pictures.style import BLUE, FILL, GREY, INK, ORANGE, Picture
from fem_seal.output.prose import said
from fem_seal.units import number, quantity

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case
    from meshes import ContactGeometry, Outline
    from meshes.geometry.segment import Point

_SEAT_FILL = "#ece7dd"


def sketch(result: SealSolution) -> Picture:
    """Section through closure and seat.

    Parameters
    ----------
    result : SealSolution
    """
    case, contact = result.case, result.seal_mesh.contact
    closure, seat = result.seal_mesh.outlines
    view = View.around(result.seal_mesh.outlines)
    r0, theta = contact.touch_radius, contact.angle
    touch = (r0, 0.0)
    radius = _closure_radius(contact)
    # The normal is drawn to the centre of the closure's curvature where that lies in the picture and can be seen.
    drawn = 0.15 * closure.largest_radius < radius < 1.01 * closure.largest_radius
    arm = radius if drawn else 0.5 * closure.largest_radius
    centre = (r0 - arm * math.sin(theta), arm * math.cos(theta))
    outside = case.load.pressure_side == "outer"
    parts = [
        view.fluids(r0, outside),
        view.body(seat, _SEAT_FILL),
        view.body(closure, FILL),
        view.line((0.0, view.low + 48 / view.scale), (0.0, view.high), GREY, "7 3 1.5 3", 1.0),
        view.line(centre, touch, BLUE, "", 1.4),
        *_angle(view, centre, touch, theta),
        view.line((-r0, 0.0), touch, ORANGE, "3 3", 1.1),
        view.dot(touch),
        view.dot((-r0, 0.0)),
        *([view.text((0.5 * (centre[0] + r0), 0.5 * centre[1]), 8, -6, "R", BLUE)] if drawn else []),
        view.text((-0.55 * r0, 0.0), 0, -6, "r₀", ORANGE, "middle"),
        view.text(_inside_closure(closure), 0, 0, "closure", INK, "middle"),
        view.text(_inside_seat(seat), 0, 0, "seat", INK, "middle"),
        *_fluid(view, seat, outside),
        *supports(view, case, seat),
        *measures(view, case, seat),
    ]
    alt = said(
        "captions.sketch",
        "alt",
        closure=case.closure.shape,
        seat=case.seat.shape,
        angle=number(math.degrees(theta)),
        radius=quantity("length", r0),
        side=case.load.pressure_side,
    )
    return Picture("sketch", view.svg(parts).encode(), alt, said("captions.sketch", "all"))


def _angle(view: View, centre: Point, touch: Point, theta: float) -> list[str]:
    """Arc and name of the angle between axis and normal, unless it is too small to be seen."""
    if abs(theta) < math.radians(3):
        return []
    return [
        view.arc(centre, theta, 0.36 * math.dist(centre, touch)),
        view.text(_between(centre, touch, theta), 0, 5, "θ", INK, "middle"),
    ]


def _between(centre: Point, touch: Point, angle: float) -> Point:
    """A place between the axis and the contact normal for the name of the angle."""
    reach = 0.48 * math.dist(centre, touch)
    return centre[0] + reach * math.sin(angle / 2), centre[1] - reach * math.cos(angle / 2)


def _closure_radius(contact: ContactGeometry) -> float:
    """Radius of curvature of the closure at first touch [m], inf if it is straight there."""
    face = contact.closure_face
    curvature = face.curvature(face.project_radius(contact.touch_radius))
    return 1 / curvature if curvature > 0 else math.inf


def _inside_closure(closure: Outline) -> Point:
    """A place in the closure's solid for its name, on the left of the picture."""
    heights = [s.start[1] for s in closure.segments]
    return -0.45 * closure.largest_radius, min(heights) + 0.72 * (max(heights) - min(heights))


def _inside_seat(seat: Outline) -> Point:
    """A place in the seat's solid for its name: half-way out, below its face."""
    radii = [s.start[0] for s in seat.segments]
    heights = [s.start[1] for s in seat.segments]
    return 0.5 * (min(radii) + max(radii)), min(heights) + 0.28 * (max(heights) - min(heights))


def _fluid(view: View, seat: Outline, outside: bool) -> list[str]:
    """Names of the high- and the low-pressure side."""
    radii = [s.start[0] for s in seat.segments]
    above: Point = (max(radii), view.high)
    below: Point = (0.0, view.low)
    high, low = ("high pressure", BLUE), ("low pressure", GREY)
    top, bottom = (high, low) if outside else (low, high)
    return [
        view.text(above, -10, 8, top[0], top[1], "end"),
        *(
            view.text(below, 0, dy, word, bottom[1], "middle")
            for word, dy in zip(bottom[0].split(), (-26, -10), strict=True)
        ),
    ]


# Height of the strip below the section that rollers and dimensions take [px].
FOOT = 64.0

_WIDTH, _MARGIN, _SIDE = 520.0, 14.0, 34.0
_FLUID_FILL = "#eaf4fb"


class View:
    """From metres to the pixels of the drawing, which shows the section and its mirror image."""

    def __init__(self, radius: float, low: float, high: float) -> None:
        self.scale = (_WIDTH - 2 * _SIDE) / (2 * radius)
        self.radius, self.low, self.high = radius, low, high
        self.height = (high - low) * self.scale + 2 * _MARGIN + FOOT

    @classmethod
    def around(cls, outlines: tuple[Outline, ...]) -> View:
        """The view of two bodies."""
        points = [s.start for outline in outlines for s in outline.segments]
        heights = [z for _, z in points]
        return cls(max(r for r, _ in points), min(heights), max(heights))

    def at(self, point: Point, side: int = 1) -> tuple[float, float]:
        """Pixels of a point (r, z) [m], on the right or, with side -1, mirrored."""
        return _WIDTH / 2 + side * point[0] * self.scale, _MARGIN + (self.high - point[1]) * self.scale

    def body(self, outline: Outline, fill: str) -> str:
        """A body and its mirror image."""
        solid = "".join(f'<path d="{self._outline(outline, side, "L")}Z"/>' for side in (1, -1))
        # The axis is no edge of the body: its mirror image continues there.
        edges = "".join(f'<path d="{self._outline(outline, side, "M")}"/>' for side in (1, -1))
        pen = f'fill="none" stroke="{INK}" stroke-width="1.3" stroke-linejoin="round"'
        return f'<g fill="{fill}">{solid}</g><g {pen}>{edges}</g>'

    def _outline(self, outline: Outline, side: int, along_axis: str) -> str:
        steps = []
        for n, s in enumerate(outline.segments):
            x, y = self.at(s.end, side)
            on_axis = s.start[0] == s.end[0] == 0.0
            if n == 0:
                steps.append("M{:.2f} {:.2f}".format(*self.at(s.start, side)))
            if s.centre is None:
                steps.append(f"{along_axis if on_axis else 'L'}{x:.2f} {y:.2f}")
            else:
                radius = math.dist(s.start, s.centre) * self.scale
                # The picture's y points down: what turns left in the section turns against the clock's hands here.
                clockwise = int((s.sweep > 0) != (side > 0))
                steps.append(f"A{radius:.2f} {radius:.2f} 0 0 {clockwise} {x:.2f} {y:.2f}")
        return "".join(steps)

    def fluids(self, radius: float, outside: bool) -> str:
        """Background: the high-pressure side tinted; the circle of contact, of this radius, parts the two sides."""
        inner, outer = ("#ffffff", _FLUID_FILL) if outside else (_FLUID_FILL, "#ffffff")
        return self._box(self.radius, self.high, outer, _MARGIN) + self._box(radius, 0.0, inner)

    def _box(self, radius: float, top: float, fill: str, over: float = 0.0) -> str:
        (x1, y1), (x2, y2) = self.at((radius, top), -1), self.at((radius, self.low))
        return (
            f'<rect x="{x1:.2f}" y="{y1 - over:.2f}" width="{x2 - x1:.2f}" height="{y2 - y1 + over:.2f}" '
            f'fill="{fill}"/>'
        )

    def line(self, a: Point, b: Point, colour: str, dashes: str, width: float) -> str:
        """A line between two points [m]."""
        (x1, y1), (x2, y2) = self.at(a), self.at(b)
        return (
            f'<line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}" stroke="{colour}" '
            f'stroke-width="{width}" stroke-dasharray="{dashes or "none"}"/>'
        )

    def arc(self, centre: Point, angle: float, radius: float) -> str:
        """Arc of an angle [rad] from the downward direction around a centre [m], of a radius [m]."""
        x1, y1 = self.at((centre[0], centre[1] - radius))
        x2, y2 = self.at((centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle)))
        r = radius * self.scale
        turn = int(angle < 0)
        path = f"M{x1:.2f} {y1:.2f}A{r:.2f} {r:.2f} 0 0 {turn} {x2:.2f} {y2:.2f}"
        return f'<path d="{path}" fill="none" stroke="{INK}"/>'

    def dot(self, point: Point) -> str:
        """A dot at a point [m]."""
        x, y = self.at(point)
        return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="3.6" fill="{ORANGE}"/>'

    def text(self, point: Point, dx: float, dy: float, text: str, colour: str, anchor: str = "start") -> str:
        """A text at a point [m], moved by (dx, dy) pixels."""
        x, y = self.at(point)
        return f'<text x="{x + dx:.2f}" y="{y + dy:.2f}" fill="{colour}" text-anchor="{anchor}">{text}</text>'

    def svg(self, parts: list[str]) -> str:
        """The whole drawing."""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {self.height:.1f}" '
            f'width="{_WIDTH:g}" height="{self.height:.1f}" font-size="14" '
            "font-family=\"Verdana, 'DejaVu Sans', Arial, sans-serif\">" + "".join(parts) + "</svg>"
        )


_ROLLER = 3.6
_SPACING = 15.0


def supports(view: View, case: Case, seat: Outline) -> Iterator[str]:
    """Rollers below the bottom of the seat, and beside its wall if that is held; arrows where it is pressed in."""
    for s in seat.segments:
        for side in (1, -1):
            if s.name == "seat_bottom":
                yield from _rollers(view.at(s.start, side), view.at(s.end, side), (0.0, 1.0))
            elif s.name == "seat_wall" and case.seat.wall == "fixed":
                yield from _rollers(view.at(s.start, side), view.at(s.end, side), (float(side), 0.0))
    if case.seat.interference:
        wall = [p for s in seat.segments if s.name == "seat_wall" for p in (s.start, s.end)]
        r, z = max(p[0] for p in wall), 0.5 * (min(p[1] for p in wall) + max(p[1] for p in wall))
        for side in (1, -1):
            x, y = view.at((r, z), side)
            yield _line((x + side * 24, y), (x + side * 2, y), ORANGE, 2.0)
            yield f'<path d="M{x:.1f} {y:.1f}l{side * 9} -4l0 8z" fill="{ORANGE}"/>'
        x, y = view.at((r, z))
        yield _text(
            x - 6, y - 8, f"pressed in by {quantity('length', case.seat.interference)}", ORANGE, "end"
        )


def _rollers(a: Point, b: Point, away: Point) -> Iterator[str]:
    """Circles along an edge, and the line on which they roll."""
    length = abs(b[0] - a[0]) + abs(b[1] - a[1])
    count = max(1, round(length / _SPACING))
    off, ground = _ROLLER + 0.8, 2 * _ROLLER + 1.6
    for n in range(count):
        t = (n + 0.5) / count
        x, y = a[0] + t * (b[0] - a[0]) + off * away[0], a[1] + t * (b[1] - a[1]) + off * away[1]
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{_ROLLER}" fill="none" stroke="{INK}"/>'
    yield _line(
        (a[0] + ground * away[0], a[1] + ground * away[1]),
        (b[0] + ground * away[0], b[1] + ground * away[1]),
        INK,
        1.3,
    )


def measures(view: View, case: Case, seat: Outline) -> Iterator[str]:
    """Radii of bore and housing below the section, height of the seat inside its wall."""
    radii = [s.start[0] for s in seat.segments]
    heights = [s.start[1] for s in seat.segments]
    chosen = chosen_dimensions(case, "seat")
    x0, floor = view.at((0.0, min(heights)))
    in_diameters = case.in_diameters("seat")
    for row, (what, radius) in enumerate((("bore", min(radii)), ("outer", max(radii)))):
        colour = GREY if f"{what}_radius" in chosen else INK
        size = (
            f"diameter {quantity('length', 2 * radius)}"
            if in_diameters
            else f"radius {quantity('length', radius)}"
        )
        x, y = view.at((radius, 0.0))[0], floor + 24 + 20 * row
        yield _line((x0, y), (x, y), colour, 1.0)
        yield _line((x, y - 4), (x, y + 4), colour, 1.0)
        yield _text(x0 - 6, y + 5, f"{what} {size}", colour, "end")
    x, top = view.at((max(radii), max(heights)))
    colour = GREY if "height" in chosen else INK
    yield _line((x - 10, top), (x - 10, floor), colour, 1.0)
    yield _text(
        x - 14,
        0.4 * top + 0.6 * floor,
        f"total height {quantity('length', max(heights) - min(heights))}",
        colour,
        "end",
    )


def _line(a: Point, b: Point, colour: str, width: float) -> str:
    return (
        f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" stroke="{colour}" '
        f'stroke-width="{width}"/>'
    )


def _text(x: float, y: float, text: str, colour: str, anchor: str) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="{anchor}" font-size="12">{text}</text>'
    )
