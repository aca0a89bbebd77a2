"""Exact geometry: areas, first touch, gap."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshes import Ball, BallOnCone, ConicalSeat, GeometryError, Outline, Segment, Sizing

angles = st.floats(math.radians(5), math.radians(85))
radii = st.floats(1e-3, 0.5)


@given(radii, angles)
def test_touch_circle_lies_on_both_surfaces_and_they_share_the_normal(radius: float, angle: float) -> None:
    contact = BallOnCone(Ball(radius), angle)
    r0 = contact.touch_radius
    centre = np.array([0.0, contact.centre_height])
    touch = np.array([r0, 0.0])
    assert math.hypot(*(touch - centre)) == pytest.approx(radius, rel=1e-12)
    normal = contact.normal(np.zeros(1))[:, 0]
    # The ball's normal at first touch points from its centre to the touch point: against the seat's normal.
    assert normal == pytest.approx((centre - touch) / radius, abs=1e-12)
    tangent = np.array([math.cos(angle), math.sin(angle)])
    assert normal @ tangent == pytest.approx(0.0, abs=1e-12)


@given(radii, angles, st.floats(-0.5, 0.9))
def test_gap_reaches_from_the_face_to_the_ball_along_the_normal(
    radius: float, angle: float, share: float
) -> None:
    contact = BallOnCone(Ball(radius), angle)
    x = np.array([share * radius])
    foot = np.array([contact.radius(x)[0], contact.height(x)[0]])
    tip = foot + contact.gap(x)[0] * contact.normal(x)[:, 0]
    assert math.hypot(*(tip - [0, contact.centre_height])) == pytest.approx(radius, rel=1e-12)
    polar = contact.polar_angle(x)[0]
    on_ball = [radius * math.sin(polar), contact.centre_height - radius * math.cos(polar)]
    assert tip == pytest.approx(on_ball, abs=1e-12 * radius + 1e-15)
    assert contact.closure_coordinate(*tip) == pytest.approx(x[0], abs=1e-12 * radius)


def test_gap_near_first_touch_is_the_parabola_without_cancellation() -> None:
    contact = BallOnCone(Ball(0.02), math.radians(45))
    x = np.array([1e-9, 1e-7, 1e-5])
    assert contact.gap(x) == pytest.approx(x**2 / (2 * 0.02), rel=1e-6)


@given(radii, angles)
def test_outline_areas_are_exact(radius: float, angle: float) -> None:
    contact = BallOnCone(Ball(radius), angle)
    x = np.linspace(-0.05, 0.05, 7) * radius
    ball = Ball(radius).outline(contact.centre_height, contact.polar_angle(x))
    assert ball.area == pytest.approx(0.5 * math.pi * radius**2, rel=1e-12)
    seat = ConicalSeat.around(angle, radius)
    outline = seat.outline(contact.touch_radius, x)
    lower, upper = seat.bore_radius, seat.face_radius
    rise = (upper - lower) * math.tan(angle)
    expected = (seat.outer_radius - lower) * (seat.height + rise) - 0.5 * (upper - lower) * rise
    assert outline.area == pytest.approx(expected, rel=1e-10)


def test_area_of_a_plain_circle_sector() -> None:
    sector = Outline(
        "sector",
        (Segment((0, 0), (1, 0), "a"), Segment((1, 0), (0, 1), "b", (0, 0)), Segment((0, 1), (0, 0), "c")),
    )
    assert sector.area == pytest.approx(math.pi / 4, rel=1e-14)


@pytest.mark.parametrize("angle", [0.0, -0.1, math.pi / 2, 2.0, math.nan])
def test_impossible_angles_are_refused(angle: float) -> None:
    with pytest.raises(GeometryError, match="between 0 and 90 deg"):
        BallOnCone(Ball(0.02), angle)
    with pytest.raises(GeometryError, match="between 0 and 90 deg"):
        ConicalSeat.around(angle, 0.02)


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
    x = sizing.contact_vertices
    assert x[0] == -left * size
    assert x[-1] == right * size
    assert 0.0 in x
    length = np.diff(x)
    assert np.all(length > 0)
    far_end = np.maximum(np.abs(x[1:]), np.abs(x[:-1]))
    assert np.all(length <= (size + growth * np.maximum(0, far_end - core * size)) * (1 + 1e-9))
