"""The case at a glance: both bodies in section, with the dimensions that matter."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fem_seal.pictures import BLUE, FILL, GREY, INK, ORANGE, Picture
from fem_seal.pictures_supports import measures, supports
from fem_seal.pictures_view import View
from fem_seal.readable import number, quantity

if TYPE_CHECKING:
    from fem_seal.results import SealResult
    from meshes import ContactGeometry
    from meshes.outline import Outline, Point

_SEAT_FILL = "#ece7dd"


def sketch(result: SealResult) -> Picture:
    """Section through closure and seat.

    Parameters
    ----------
    result : SealResult
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
    alt = (
        f"Section: closure of shape {case.closure.shape} on a seat of shape {case.seat.shape}; their common normal "
        f"stands {number(math.degrees(theta))} degrees from the axis, touching at radius "
        f"{quantity('length', r0)}; high pressure on the {'outer' if outside else 'inner'} side"
    )
    caption = (
        "Section through the seal, to scale. The angle θ lies between the axis and the common normal of both "
        "surfaces; a cone's half-angle measured from the axis is 90° − θ. Leakage crosses the circle of contact "
        "(dots). Rollers hold a surface along its normal and let it slide; dimensions in grey were chosen, the others "
        "are given."
    )
    return Picture("sketch", view.svg(parts).encode(), alt, caption)


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
