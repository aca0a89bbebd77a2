"""How the bodies are held and how large they are, drawn into the sketch of the case."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.case_dimensions import chosen_dimensions
from fem_seal.pictures import GREY, INK, ORANGE
from fem_seal.readable import quantity

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.pictures_view import View
    from meshes.outline import Outline, Point

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
    for row, (key, radius) in enumerate((("bore_radius", min(radii)), ("outer_radius", max(radii)))):
        colour = GREY if key in chosen else INK
        x, y = view.at((radius, 0.0))[0], floor + 24 + 20 * row
        yield _line((x0, y), (x, y), colour, 1.0)
        yield _line((x, y - 4), (x, y + 4), colour, 1.0)
        yield _text(x0 - 6, y + 5, f"{key.replace('_', ' ')} {quantity('length', radius)}", colour, "end")
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
