"""Every closure on every seat: closed forms of first touch and curvature, areas, brute-force distance and gap."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from meshes import (
    Ball,
    ConicalLand,
    ConicalSeat,
    ContactGeometry,
    Disc,
    FlatLand,
    FlatSeat,
    GeometryError,
    Outline,
    RoundedCone,
    Shape,
    SharpEdge,
    Sizing,
    SphericalSeat,
    SphericalTip,
    ToroidalEdge,
    ToroidalSeat,
    build,
    first_touch,
)

FloatArray = NDArray[np.float64]

MM, DEG = 1e-3, math.pi / 180
BETA = 40 * DEG
BALL = Ball(20 * MM)
CONE = RoundedCone(55 * DEG, 9 * MM, 18 * MM, 1 * MM, 20 * MM)
FITTING = RoundedCone(BETA, 9 * MM, 18 * MM, 1 * MM, 20 * MM)
TORUS = ToroidalEdge(14 * MM, 3 * MM, 1 * MM, 10 * MM)
TIP = SphericalTip(30 * MM, 22 * MM, 1 * MM, 20 * MM)
DISC = Disc(16 * MM, 1 * MM, 8 * MM)
CLOSURES: dict[str, Shape] = {
    "ball": BALL,
    "hollow ball": Ball(20 * MM, 12 * MM),
    "cone": CONE,
    "fitting cone": FITTING,
    "torus": TORUS,
    "tip": TIP,
    "disc": DISC,
}
SEATS: dict[str, Callable[[Shape], Shape]] = {
    "cone": lambda closure: ConicalSeat.around(BETA, closure),
    "land": lambda closure: ConicalLand.around(BETA, closure, land_width=1 * MM),
    "torus": lambda closure: ToroidalSeat.around(13 * MM, 4 * MM, closure),
    "flat": lambda closure: FlatSeat.on(closure, bore_radius=8 * MM, edge_radius=0.5 * MM),
    "flat land": lambda closure: FlatLand.on(13 * MM, 15 * MM, closure, edge_radius=0.2 * MM),
    "edge": lambda closure: SharpEdge.around(12 * MM, closure, edge_radius=0.2 * MM, top_angle=-20 * DEG),
}


def rel(*bends: float) -> float:
    """Relative radius of curvatures [1/mm], in m."""
    return MM / sum(bends)


# r0 and R_rel by hand, section by section (mm). The centre of the rounding between a horizontal and a line of slope a,
# meeting at r, lies at r - e tan(a/2).
NOSE = 9 - 1 * math.tan(55 * DEG / 2)
SIN = math.sin(BETA)
EXPECTED = {
    ("ball", "cone"): (20 * SIN, rel(1 / 20)),
    ("ball", "land"): (20 * SIN, rel(1 / 20)),
    ("ball", "torus"): (20 * 13 / (20 + 4), rel(1 / 20, 1 / 4)),
    ("ball", "flat"): (20 * 8.5 / 20.5, rel(1 / 20, 1 / 0.5)),
    # a fillet tangent to the bore has its centre 0.2 mm outside it
    ("ball", "edge"): (20 * 12.2 / 20.2, rel(1 / 20, 1 / 0.2)),
    ("cone", "cone"): (NOSE + SIN, rel(1 / 1)),
    ("cone", "land"): (NOSE + SIN, rel(1 / 1)),
    ("cone", "torus"): (13 - 4 * math.sin(55 * DEG), rel(1 / 4)),
    ("cone", "edge"): (12.2 - 0.2 * math.sin(55 * DEG), rel(1 / 0.2)),
    ("torus", "cone"): (14 + 3 * SIN, rel(1 / 3)),
    ("torus", "land"): (14 + 3 * SIN, rel(1 / 3)),
    ("torus", "torus"): (14 + 3 * (13 - 14) / (3 + 4), rel(1 / 3, 1 / 4)),
    ("torus", "flat"): (14, rel(1 / 3)),
    ("torus", "flat land"): (14, rel(1 / 3)),
    ("tip", "cone"): (30 * SIN, rel(1 / 30)),
    ("tip", "land"): (30 * SIN, rel(1 / 30)),
    ("tip", "torus"): (30 * 13 / 34, rel(1 / 30, 1 / 4)),
    ("disc", "cone"): (15 + SIN, rel(1 / 1)),
    ("disc", "land"): (15 + SIN, rel(1 / 1)),
    ("disc", "torus"): (13, rel(1 / 4)),
    # along the whole common stretch: its middle counts
    ("disc", "flat"): (0.5 * (8.5 + 15), math.inf),
    # of the land all that is flat, of the disc all that has no rounding, and both end at 15 mm less a rounding
    ("disc", "flat land"): (0.5 * (13.2 + 14.8), math.inf),
    # the inner edge of the land, rounded
    ("ball", "flat land"): (20 * 13.2 / 20.2, rel(1 / 20, 1 / 0.2)),
    # the cone of the same angle: between nose and shoulder of the poppet, whose arcs touch the face
    ("fitting cone", "cone"): (None, math.inf),
    ("fitting cone", "land"): (None, math.inf),
}


@pytest.mark.parametrize(("closure", "seat"), EXPECTED, ids=lambda name: name.replace(" ", "-"))
def test_first_touch_and_relative_curvature_in_closed_form(closure: str, seat: str) -> None:
    contact = contact_of(closure, seat)
    r0, radius = EXPECTED[closure, seat]
    if r0 is not None:
        assert contact.initial_contact_radius == pytest.approx(r0 * MM, rel=1e-10)
    assert contact.relative_radius == pytest.approx(radius, rel=1e-8)


def contact_of(closure: str, seat: str) -> ContactGeometry:
    body = CLOSURES[closure]
    return ContactGeometry.of(body.outline, SEATS[seat](body).outline)


def test_a_fitting_cone_touches_in_the_middle_of_the_common_stretch() -> None:
    contact = contact_of("fitting cone", "cone")
    # both roundings begin e tan(turn/2) before the edges along the slope
    low = 9 * MM + 1 * MM * math.tan(BETA / 2) * math.cos(BETA)
    high = 18 * MM - 1 * MM * math.tan((90 * DEG - BETA) / 2) * math.cos(BETA)
    assert contact.initial_contact_radius == pytest.approx(0.5 * (low + high), rel=1e-9)
    x = np.linspace(-3 * MM, 3 * MM, 7)
    assert np.abs(contact.gap(x)).max() < 1e-15


@pytest.mark.parametrize("share", [1.001, 1.05, 2.0])
@pytest.mark.parametrize("degrees", [20, 45, 65])
def test_lapped_spherical_seat_touches_where_it_is_asked_to(share: float, degrees: float) -> None:
    """Also for a ball whose radius is 0.1 % smaller."""
    seat = SphericalSeat.around(share * 20 * MM, BALL, contact_angle=degrees * DEG)
    contact = ContactGeometry.of(BALL.outline, seat.outline)
    assert contact.initial_contact_radius == pytest.approx(20 * MM * math.sin(degrees * DEG), rel=1e-9)
    assert contact.angle == pytest.approx(degrees * DEG, rel=1e-7)
    # 1/R_rel = 1/R - 1/R_s, all of it cancellation
    assert contact.relative_radius == pytest.approx(20 * MM * share / (share - 1), rel=1e-9 / (share - 1))
    # distance of two circles whose centres are (share - 1) R apart, along the ray from the larger one's centre
    x, R = np.linspace(-1, 1, 7) * MM, 20 * MM
    turn, apart = x / (share * R), (share - 1) * R
    gap = share * R - apart * np.cos(turn) - np.sqrt(R**2 - (apart * np.sin(turn)) ** 2)
    assert contact.gap(x) == pytest.approx(gap, abs=2e-16)


def test_sphere_of_the_balls_own_radius_is_refused_with_the_reason() -> None:
    with pytest.raises(GeometryError, match="radius of the seat larger"):
        SphericalSeat.around(19 * MM, BALL, contact_angle=45 * DEG)


def test_a_sphere_that_fits_the_ball_needs_no_contact_angle() -> None:
    with pytest.raises(GeometryError, match=r"fit each other .* leave contact_angle out") as caught:
        SphericalSeat.around(20 * MM, BALL, contact_angle=45 * DEG)
    assert "at r =" not in str(caught.value)
    fitting = ContactGeometry.of(BALL.outline, SphericalSeat.around(20 * MM, BALL).outline)
    assert math.isinf(fitting.relative_radius)
    # a ring's section has its centre beside the axis: there a seat with its centre on the axis is no way out
    ring = ToroidalEdge.of(14 * MM, 3 * MM)
    with pytest.raises(GeometryError, match=r"fit each other .*; make the radius of the seat larger"):
        SphericalSeat.around(3 * MM, ring, contact_angle=30 * DEG, bore_radius=14.3 * MM)


def areas() -> list[tuple[str, Outline, float]]:
    """Exact areas [mm^2] from triangles, rectangles and what a rounding cuts off: e^2 (tan(t/2) - t/2) at turn t."""

    def cut(e: float, turn: float) -> float:
        return e**2 * (math.tan(turn / 2) - turn / 2)

    rise = 9 * math.tan(55 * DEG)
    cone = 0.5 * (9 + 18) * rise + 18 * 20 - cut(1, 55 * DEG) - cut(1, 35 * DEG)
    # torus: floor at 1 mm, an arc from cos = (3 - 1)/3 inwards to the vertical
    inner = math.sqrt(3**2 - 2**2)
    below = 0.5 * 3**2 * math.asin(inner / 3) - 0.5 * inner * 2
    torus = 17 * 10 + 0.25 * math.pi * 9 + 14 * 3 - (14 - inner) * 1 - (inner * 3 - below - inner * 2)
    cap = 0.5 * 30**2 * math.asin(22 / 30) - 0.5 * 22 * math.sqrt(30**2 - 22**2)
    tip = cap + 22 * 20
    disc = 16 * 8 - (1 - math.pi / 4)
    half = 0.5 * 1 * math.cos(BETA)
    land = ConicalLand(BETA, 12 * MM, 1 * MM, 0.1 * MM, 10 * DEG, 30 * MM, 15 * MM)
    bore, end, up = 12 - half, 12 + half, math.sin(BETA)
    wide = 30 - end
    land_area = (30 - bore) * 15 + half * up + wide * up + 0.5 * wide**2 * math.tan(10 * DEG)
    land_area -= cut(0.1, 90 * DEG - BETA) + cut(0.1, BETA - 10 * DEG)
    edge = SharpEdge(12 * MM, 0.2 * MM, -20 * DEG, 30 * MM, 40 * MM)
    edge_area = 18 * 40 - 0.5 * 18**2 * math.tan(20 * DEG) - cut(0.2, 110 * DEG)
    ring = ToroidalSeat(13 * MM, 4 * MM, 9 * MM, 2 * MM, 30 * MM, 15 * MM)
    out = math.sqrt(4**2 - 2**2)
    # the bottom lies 15 mm below the ring's lower end, which is 4 mm below its crest
    ring_area = (
        0.25 * math.pi * 16 + 4 * 15 + (30 - 13) * (15 + 2) + 0.5 * 16 * math.asin(out / 4) - 0.5 * out * 2
    )
    hollow = SphericalSeat(25 * MM, 0.0, 8 * MM, 15 * MM, 0.0, 30 * MM, 15 * MM)
    z = [math.sqrt(25**2 - r**2) for r in (8, 15)]
    up = z[0] - z[1]
    segment = 0.5 * 25**2 * (math.asin(15 / 25) - math.asin(8 / 25)) - 0.5 * (15 * z[0] - 8 * z[1])
    hollow_area = 22 * 15 + 15 * up + 0.5 * 7 * up - segment
    # 2 mm wide and 1 mm high on a housing whose bottom lies 15 mm below the land
    raised = FlatLand(13 * MM, 15 * MM, 0.2 * MM, 1 * MM, 30 * MM, 15 * MM)
    raised_area = (30 - 13) * 14 + 2 * 1 - 2 * cut(0.2, 90 * DEG)
    return [
        ("flat land", raised.outline, raised_area),
        ("cone", CONE.outline, cone),
        ("torus", TORUS.outline, torus),
        ("tip", SphericalTip(30 * MM, 22 * MM, 0.0, 20 * MM).outline, tip),
        ("disc", DISC.outline, disc),
        ("land", land.outline, land_area),
        ("edge", edge.outline, edge_area),
        ("ring", ring.outline, ring_area),
        ("hollow", hollow.outline, hollow_area),
    ]


@pytest.mark.parametrize(
    ("name", "outline", "area"), areas(), ids=lambda value: value if isinstance(value, str) else ""
)
def test_outline_area_is_exact(name: str, outline: Outline, area: float) -> None:
    assert outline.area == pytest.approx(area * MM**2, rel=1e-12)


def points(outline: Outline, count: int = 4000) -> FloatArray:
    """Dense points of the face, lines and arcs sampled here and not by `Curve`."""
    found = []
    for s in outline.segments:
        if s.name != f"{outline.name}_face":
            continue
        t = np.linspace(0, 1, count)[:, None]
        a, b = np.array(s.start), np.array(s.end)
        if s.centre is None:
            found.append(a + t * (b - a))
        else:
            c = np.array(s.centre)
            u, v = a - c, b - c
            full = math.acos(np.clip(u @ v / (np.linalg.norm(u) * np.linalg.norm(v)), -1, 1))
            found.append(c + (np.sin((1 - t) * full) * u + np.sin(t * full) * v) / math.sin(full))
    p = np.vstack(found)
    return p[np.argsort(p[:, 0], kind="stable")].T


pairs = [(c, s) for c in CLOSURES for s in SEATS]


@pytest.mark.parametrize(("closure", "seat"), pairs, ids=lambda name: name.replace(" ", "-"))
def test_first_touch_is_the_closest_approach_of_dense_samples(closure: str, seat: str) -> None:
    assert_closest(CLOSURES[closure], SEATS[seat](CLOSURES[closure]))


def assert_closest(closure: Shape, seat: Shape) -> None:
    upper, lower = points(closure.outline), points(seat.outline)
    r = np.linspace(max(upper[0, 0], lower[0, 0]), min(upper[0, -1], lower[0, -1]), 40001)
    distance = np.interp(r, *upper) - np.interp(r, *lower)
    touch = first_touch(closure.outline.face, seat.outline.face)
    size = closure.outline.largest_radius
    # Chords of 1/4000 of an arc lie 1e-8 of its radius off it; between samples of r the distance falls further by that
    # spacing squared over the smallest radius.
    assert touch.drop <= distance.min() + 1e-7 * size
    assert touch.drop == pytest.approx(distance.min(), abs=5e-6 * size)
    assert np.interp(touch.radius, r, distance) == pytest.approx(touch.drop, abs=5e-6 * size)


sizes = st.floats(0.3, 3.0)


@settings(max_examples=60)
@given(
    st.sampled_from(["ball", "cone", "torus", "tip", "disc"]),
    st.sampled_from(["cone", "land", "torus", "edge", "flat", "flat land"]),
    st.floats(12, 70),
    st.floats(12, 70),
    sizes,
    st.floats(0.05, 0.3),
)
def test_first_touch_of_random_pairs(
    closure: str, seat: str, one: float, other: float, size: float, small: float
) -> None:
    body: Shape = {
        "ball": Ball(12 * MM * size),
        "cone": RoundedCone.of(one * DEG, mean_radius=10 * MM * size),
        "torus": ToroidalEdge.of(10 * MM * size, 10 * MM * size * small),
        "tip": SphericalTip.of(15 * MM * size, 12 * MM * size),
        "disc": Disc.of(12 * MM * size, edge_radius=3 * MM * size * small),
    }[closure]
    ring = 9 * MM * size
    below = {
        "cone": lambda: ConicalSeat.around(other * DEG, body),
        "land": lambda: ConicalLand.around(other * DEG, body, land_width=small * ring),
        # inside the outermost circle of the thinnest rim and outside its innermost one
        "torus": lambda: ToroidalSeat.around(ring * (10 / 9 - 0.3 * small), small * ring, body),
        "flat land": lambda: FlatLand.on(ring, ring * (1 + small), body, edge_radius=0.1 * small * ring),
        "edge": lambda: SharpEdge.around(ring, body, edge_radius=0.2 * small * ring),
        "flat": lambda: FlatSeat.on(body, bore_radius=ring, edge_radius=0.2 * small * ring),
    }[seat]()
    assert_closest(body, below)


@pytest.mark.parametrize(
    ("closure", "seat"),
    [("ball", "torus"), ("torus", "torus"), ("cone", "edge"), ("fitting cone", "land"), ("disc", "flat")],
)
def test_gap_is_the_first_hit_of_a_ray_on_a_dense_polygon(closure: str, seat: str) -> None:
    contact = contact_of(closure, seat)
    low, high = contact.reach
    x = np.linspace(0.9 * low, 0.9 * high, 15)
    feet, normals = contact.point(x), contact.normal(x)
    p = points(contact.closure, 20000)
    for foot, normal, gap in zip(feet.T, normals.T, contact.gap(x), strict=True):
        away = p - foot[:, None]
        across = away[0] * normal[1] - away[1] * normal[0]
        k = np.flatnonzero((across[1:] <= 0) != (across[:-1] <= 0))
        share = across[k] / (across[k] - across[k + 1])
        along = (away[:, k] + share * (away[:, k + 1] - away[:, k])).T @ normal
        hits = along[along > -1e-9]
        assert gap == pytest.approx(hits.min(), abs=1e-9)


@pytest.mark.parametrize(("closure", "seat"), pairs[::3], ids=lambda name: name.replace(" ", "-"))
def test_every_family_is_meshed_with_good_triangles(closure: str, seat: str) -> None:
    contact = contact_of(closure, seat)
    low, high = contact.reach
    zone = max(0.8 * low, -0.3 * MM), min(0.8 * high, 0.3 * MM)
    mesh = build(
        CLOSURES[closure], SEATS[seat](CLOSURES[closure]), Sizing(20e-6, 0.1 * MM, zone, 0.1, 0.25, 2e-3)
    )
    # One triangle at the far end of a coarse rounding may be thin.
    assert mesh.quality.smallest > 0.1
    assert mesh.quality.mean > 0.85
    assert mesh.quality.area_error < 5e-3


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: RoundedCone(95 * DEG, 1, 2, 0, 1), "angle = 95 deg"),
        (lambda: RoundedCone(45 * DEG, 2, 1, 0, 1), "outer_radius = 1000 mm: must exceed inner_radius"),
        (
            lambda: RoundedCone(45 * DEG, 1, 2, 3, 1).outline,
            r"edge radius of 3000 mm does not fit .* allowed is up",
        ),
        (lambda: RoundedCone.of(45 * DEG), "0 are given"),
        (lambda: ToroidalEdge(1, 0.5, 0.6, 1), "recess = 600 mm"),
        (lambda: SphericalTip(1, 2, 0, 1), "stem_radius = 2000 mm"),
        (lambda: Disc(1, 2, 1), "edge_radius = 2000 mm: must be below the disc's radius"),
        (
            lambda: ConicalLand(45 * DEG, 1, 3, 0.1, 0, 5, 1),
            "land_width = 3000 mm: the land .* reach to the axis",
        ),
        (lambda: ConicalLand(45 * DEG, 1, 0.1, 0.01, 50 * DEG, 5, 1), "relief_angle = 50 deg"),
        (lambda: SphericalSeat(1, 0, 0.5, 1.5, 0, 3, 1), "face_radius = 1500 mm"),
        (lambda: ToroidalSeat(1, 0.5, 0.4, 0.1, 3, 1), "bore_radius = 400 mm"),
        (lambda: SharpEdge(1, -0.1, 0, 3, 1), "edge_radius = -100 mm"),
        (lambda: FlatSeat.on(BALL), "bore_radius is missing"),
        (lambda: SharpEdge(1, 0.1, 0, 0.5, 1), "outer_radius = 500 mm"),
        (
            lambda: FlatLand.on(2, 1, BALL),
            "land_outer_radius = 1000 mm: must exceed land_inner_radius = 2000 mm",
        ),
        (lambda: FlatLand(1, 2, 0.6, 1, 3, 1), "edge_radius = 600 mm: the roundings .* below half"),
        (lambda: FlatLand(1, 2, 0.1, 0.05, 3, 1), "land_height = 50 mm: must be at least edge_radius"),
        (
            lambda: FlatLand(1, 2, 0.1, 0.1, 1.5, 1),
            "outer_radius = 1500 mm: must be at least land_outer_radius",
        ),
        (lambda: FlatLand(1, 2, 0.1, 0.5, 3, 0.4).outline, "height"),
    ],
)
def test_impossible_dimensions_name_key_and_value(make: Callable[[], object], said: str) -> None:
    with pytest.raises(GeometryError, match=said):
        make()


def test_touch_at_a_sharp_corner_is_refused() -> None:
    land = ConicalLand(BETA, 20 * MM * SIN, 1 * MM, 0.0, 0.0, 40 * MM, 30 * MM)
    wide = Ball(18 * MM)
    with pytest.raises(GeometryError, match=r"sharp corner|face of the seat ends"):
        ContactGeometry.of(wide.outline, land.outline)
