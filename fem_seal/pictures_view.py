"""From a section in metres to a drawing."""

from __future__ import annotations

import math

from fem_seal.pictures import INK, ORANGE
from meshes.outline import Outline, Point

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
