"""Exact geometry: areas, first touch, gap."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import Ball, ConicalSeat, ContactGeometry, GeometryError, Outline, Segment, Sizing

angles = st.floats(math.radians(5), math.radians(85))
radii = st.floats(1e-3, 0.5)


def ball_on_cone(radius: float, angle: float) -> ContactGeometry:
    ball = Ball(radius)
    return ContactGeometry.of(ball.outline, ConicalSeat.around(angle, ball).outline)


def centre_height(radius: float, angle: float) -> float:
    """Height of the ball's centre above first touch: an own formula, not the product's."""
    return radius * math.cos(angle)


@given(radii, angles)
def test_touch_circle_lies_on_both_surfaces_and_they_share_the_normal(radius: float, angle: float) -> None:
    contact = ball_on_cone(radius, angle)
    r0 = contact.initial_contact_radius
    assert r0 == pytest.approx(radius * math.sin(angle), rel=1e-12)
    assert contact.angle == pytest.approx(angle, rel=1e-12)
    assert contact.relative_radius == pytest.approx(radius, rel=1e-9)
    centre = np.array([0.0, centre_height(radius, angle)])
    touch = np.array([r0, 0.0])
    normal = contact.normal(np.zeros(1))[:, 0]
    # The ball's normal at first touch points from its centre to the touch point: against the seat's normal.
    assert normal == pytest.approx((centre - touch) / radius, abs=1e-12)
    assert contact.gap(np.zeros(1))[0] == pytest.approx(0.0, abs=4e-15 * radius)


@given(radii, angles, st.floats(0.01, 0.99))
def test_gap_reaches_from_the_face_to_the_ball_along_the_normal(
    radius: float, angle: float, share: float
) -> None:
    contact = ball_on_cone(radius, angle)
    start, end = contact.reach
    x = np.array([start + share * (end - start)])
    foot = np.array([contact.radius(x)[0], contact.height(x)[0]])
    tip = foot + contact.gap(x)[0] * contact.normal(x)[:, 0]
    assert math.hypot(*(tip - [0, centre_height(radius, angle)])) == pytest.approx(radius, rel=1e-12)
    assert contact.coordinate(*tip) == pytest.approx(x[0], abs=1e-12 * radius)
    on_ball = contact.closure_face.point(contact.closure_arc(x))[:, 0]
    assert tip == pytest.approx(on_ball, abs=1e-12 * radius + 1e-15)


def test_gap_near_first_touch_is_the_parabola_without_cancellation() -> None:
    contact = ball_on_cone(0.02, math.radians(45))
    x = np.array([1e-7, 1e-6, 1e-5])
    # 1e-17 m: the round-off of coordinates of some centimetres, a hundred-millionth of an atom
    assert contact.gap(x) == pytest.approx(x**2 / (2 * 0.02), rel=1e-6, abs=1e-17)


@given(radii, angles)
def test_outline_areas_are_exact(radius: float, angle: float) -> None:
    ball = Ball(radius)
    assert ball.outline.area == pytest.approx(0.5 * math.pi * radius**2, rel=1e-12)
    hollow = Ball(radius, 0.7 * radius)
    assert hollow.outline.area == pytest.approx(0.5 * math.pi * radius**2 * (1 - 0.49), rel=1e-12)
    seat = ConicalSeat.around(angle, ball)
    lower, upper = seat.bore_radius, seat.face_radius
    rise = (upper - lower) * math.tan(angle)
    expected = (seat.outer_radius - lower) * (seat.height + rise) - 0.5 * (upper - lower) * rise
    assert seat.outline.area == pytest.approx(expected, rel=1e-10)


def test_area_of_a_plain_circle_sector() -> None:
    sector = Outline(
        "sector",
        (Segment((0, 0), (1, 0), "a"), Segment((1, 0), (0, 1), "b", (0, 0)), Segment((0, 1), (0, 0), "c")),
    )
    assert sector.area == pytest.approx(math.pi / 4, rel=1e-14)


@pytest.mark.parametrize("angle", [0.0, -0.1, math.pi / 2, 2.0, math.nan])
def test_impossible_angles_are_refused(angle: float) -> None:
    with pytest.raises(GeometryError, match="between 0 and 90 deg"):
        ConicalSeat(angle, 0.01, 0.02, 0.04, 0.03)
    with pytest.raises(GeometryError, match="between 0 and 90 deg"):
        ConicalSeat.around(angle, Ball(0.02))


@pytest.mark.parametrize("radius", [0.0, -1.0, math.inf, math.nan])
def test_impossible_radii_are_refused(radius: float) -> None:
    with pytest.raises(GeometryError, match="radius"):
        Ball(radius)


def test_seat_radii_must_increase() -> None:
    with pytest.raises(GeometryError, match="increase"):
        ConicalSeat(math.radians(45), 0.02, 0.01, 0.03, 0.03)


def test_sizing_refuses_nonsense() -> None:
    good = {
        "contact_size": 1e-5,
        "core": 1e-4,
        "zone": (-1e-3, 1e-3),
        "growth_along": 0.1,
        "growth_deep": 0.2,
    }
    with pytest.raises(GeometryError, match="contact_size"):
        Sizing(**{**good, "contact_size": -1.0}, far_size=1e-3)  # type: ignore[arg-type]
    with pytest.raises(GeometryError, match="zone"):
        Sizing(**{**good, "zone": (1e-4, 1e-3)}, far_size=1e-3)  # type: ignore[arg-type]
    with pytest.raises(GeometryError, match="far_size"):
        Sizing(**good, far_size=1e-6)  # type: ignore[arg-type]


@given(st.floats(1e-6, 1e-4), st.floats(0, 10), st.floats(0.02, 0.5), st.floats(3, 100), st.floats(3, 100))
def test_contact_vertices_enclose_the_zone_and_respect_the_size(
    size: float, core: float, growth: float, left: float, right: float
) -> None:
    sizing = Sizing(size, core * size, (-left * size, right * size), growth, 0.2, 1.0)
    x = sizing.contact_vertices()
    assert x[0] == -left * size
    assert x[-1] == right * size
    assert 0.0 in x
    length = np.diff(x)
    assert np.all(length > 0)
    far_end = np.maximum(np.abs(x[1:]), np.abs(x[:-1]))
    assert np.all(length <= (size + growth * np.maximum(0, far_end - core * size)) * (1 + 1e-9))
