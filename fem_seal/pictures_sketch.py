"""The case at a glance: both bodies in section, with the dimensions that matter."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fem_seal.pictures import BLUE, FILL, GREY, INK, ORANGE, Picture
from fem_seal.readable import number, quantity

if TYPE_CHECKING:
    from fem_seal.results import SealResult
    from meshes import ContactGeometry
    from meshes.outline import Outline, Point

_WIDTH, _MARGIN = 480.0, 14.0
_SEAT_FILL = "#ece7dd"
_FLUID_FILL = "#eaf4fb"


def sketch(result: SealResult) -> Picture:
    """Section through closure and seat.

    Parameters
    ----------
    result : SealResult
    """
    case, contact = result.case, result.seal_mesh.contact
    closure, seat = result.seal_mesh.outlines
    view = _View.around(result.seal_mesh.outlines)
    r0, theta = contact.touch_radius, contact.angle
    touch = (r0, 0.0)
    radius = _closure_radius(contact)
    # The normal is drawn to the centre of the closure's curvature where that lies in the picture.
    arm = radius if radius < 1.01 * closure.largest_radius else 0.5 * closure.largest_radius
    centre = (r0 - arm * math.sin(theta), arm * math.cos(theta))
    outside = case.load.pressure_side == "outer"
    parts = [
        view.fluids(r0, outside),
        view.body(seat, _SEAT_FILL),
        view.body(closure, FILL),
        view.line((0.0, view.low + 48 / view.scale), (0.0, view.high), GREY, "7 3 1.5 3", 1.0),
        view.line(centre, touch, BLUE, "", 1.4),
        view.arc(centre, theta, 0.36 * math.dist(centre, touch)),
        view.line((-r0, 0.0), touch, ORANGE, "3 3", 1.1),
        view.dot(touch),
        view.dot((-r0, 0.0)),
        *([view.text((0.5 * (centre[0] + r0), 0.5 * centre[1]), 8, -6, "R", BLUE)] if arm == radius else []),
        view.text(_between(centre, touch, theta), 0, 5, "θ", INK, "middle"),
        view.text((-0.55 * r0, 0.0), 0, -6, "r₀", ORANGE, "middle"),
        view.text(_inside_closure(closure), 0, 0, "closure", INK, "middle"),
        view.text(_inside_seat(seat), 0, 0, "seat", INK, "middle"),
        *_fluid(view, seat, outside),
    ]
    alt = (
        f"Section: closure of shape {case.closure.shape} on a seat of shape {case.seat.shape}; their common normal "
        f"stands {number(math.degrees(theta))} degrees from the axis, touching at radius "
        f"{quantity('length', r0)}; high pressure on the {'outer' if outside else 'inner'} side"
    )
    caption = (
        "Section through the seal, to scale. The angle θ lies between the axis and the common normal of both "
        "surfaces; a cone's half-angle measured from the axis is 90° − θ. Leakage crosses the circle of contact "
        "(dots)."
    )
    return Picture("sketch", view.svg(parts).encode(), alt, caption)


class _View:
    """From metres to the pixels of the drawing, which shows the section and its mirror image."""

    def __init__(self, radius: float, low: float, high: float) -> None:
        self.scale = (_WIDTH - 2 * _MARGIN) / (2 * radius)
        self.radius, self.low, self.high = radius, low, high
        self.height = (high - low) * self.scale + 2 * _MARGIN

    @classmethod
    def around(cls, outlines: tuple[Outline, ...]) -> _View:
        points = [s.start for outline in outlines for s in outline.segments]
        heights = [z for _, z in points]
        return cls(max(r for r, _ in points), min(heights), max(heights))

    def at(self, point: Point, side: int = 1) -> tuple[float, float]:
        return _WIDTH / 2 + side * point[0] * self.scale, _MARGIN + (self.high - point[1]) * self.scale

    def body(self, outline: Outline, fill: str) -> str:
        paths = "".join(f'<path d="{self._outline(outline, side)}"/>' for side in (1, -1))
        return f'<g fill="{fill}" stroke="{INK}" stroke-width="1.3" stroke-linejoin="round">{paths}</g>'

    def _outline(self, outline: Outline, side: int) -> str:
        steps = []
        for n, s in enumerate(outline.segments):
            x, y = self.at(s.end, side)
            on_axis = s.start[0] == s.end[0] == 0.0
            if n == 0:
                steps.append("M{:.2f} {:.2f}".format(*self.at(s.start, side)))
            if s.centre is None:
                # The axis is no edge of the body: its mirror image continues there.
                steps.append(f"{'M' if on_axis else 'L'}{x:.2f} {y:.2f}")
            else:
                radius = math.dist(s.start, s.centre) * self.scale
                steps.append(f"A{radius:.2f} {radius:.2f} 0 0 {0 if side > 0 else 1} {x:.2f} {y:.2f}")
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
        (x1, y1), (x2, y2) = self.at(a), self.at(b)
        return (
            f'<line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}" stroke="{colour}" '
            f'stroke-width="{width}" stroke-dasharray="{dashes or "none"}"/>'
        )

    def arc(self, centre: Point, angle: float, radius: float) -> str:
        x1, y1 = self.at((centre[0], centre[1] - radius))
        x2, y2 = self.at((centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle)))
        r = radius * self.scale
        return f'<path d="M{x1:.2f} {y1:.2f}A{r:.2f} {r:.2f} 0 0 0 {x2:.2f} {y2:.2f}" fill="none" stroke="{INK}"/>'

    def dot(self, point: Point) -> str:
        x, y = self.at(point)
        return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="3.6" fill="{ORANGE}"/>'

    def text(self, point: Point, dx: float, dy: float, text: str, colour: str, anchor: str = "start") -> str:
        x, y = self.at(point)
        return f'<text x="{x + dx:.2f}" y="{y + dy:.2f}" fill="{colour}" text-anchor="{anchor}">{text}</text>'

    def svg(self, parts: list[str]) -> str:
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {self.height:.1f}" '
            f'width="{_WIDTH:g}" height="{self.height:.1f}" font-size="14" '
            "font-family=\"Verdana, 'DejaVu Sans', Arial, sans-serif\">" + "".join(parts) + "</svg>"
        )


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


def _fluid(view: _View, seat: Outline, outside: bool) -> list[str]:
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
