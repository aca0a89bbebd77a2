"""Gaskets and flange faces: areas, heights and first touch against closed forms."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import meshes
from meshes import ContactGeometry, GeometryError, Outline, Segment
from meshes.drawings.half_section import profile_of, upper_half

BETA = math.radians(20)
FLAT = meshes.FlangeFace.flat(0.010, 0.04)
CONE = meshes.FlangeFace.conical(BETA, 0.012, 0.03)


def closed(outline: Outline) -> bool:
    ends = zip(outline.segments, [*outline.segments[1:], outline.segments[0]], strict=True)
    return all(math.dist(one.end, after.start) < 1e-15 for one, after in ends)


GASKETS = {
    # half a disc
    "ring": (meshes.SolidRing(0.02, 2e-3), 0.5 * math.pi * 4e-6),
    # trapezium below the rim, and a piece of the sphere: int sqrt(R^2 - r^2) dr
    "lens": (
        meshes.LensRing(0.06, 0.014, 0.025, 8e-3),
        4e-3 * 0.011
        + 0.5 * (0.025 * math.sqrt(0.06**2 - 0.025**2) - 0.014 * math.sqrt(0.06**2 - 0.014**2))
        + 0.5 * 0.06**2 * (math.asin(0.025 / 0.06) - math.asin(0.014 / 0.06))
        - 0.011 * math.sqrt(0.06**2 - 0.025**2),
    ),
    # a right triangle less what the rounding of its corner, of 30 deg, takes: R^2 (cot 15 - (pi - pi/6)/2)
    "delta": (
        meshes.DeltaRing(0.02, 8e-3, math.radians(60), 2e-4),
        0.5 * 4e-3 * 4e-3 / math.tan(math.radians(60))
        - 4e-8 * (1 / math.tan(math.radians(15)) - math.radians(75)),
    ),
    "double-cone": (
        meshes.DoubleConeRing(0.02, 0.03, 0.02, 0.01, math.radians(60), 0.0),
        0.01 * 5e-3 + 5e-3 * (0.01 - 0.5 * 5e-3 / math.tan(math.radians(60))),
    ),
    # a rectangle less two corners
    "octagonal": (
        meshes.OctagonalRing(0.0476, 11e-3, 16e-3, 8e-3),
        11e-3 * 8e-3 - 1.5e-3 * 1.5e-3 * math.tan(math.radians(67)),
    ),
}


@pytest.mark.parametrize("name", GASKETS)
def test_half_sections_have_the_area_of_their_formula(name: str) -> None:
    gasket, area = GASKETS[name]
    assert closed(gasket.outline)
    assert gasket.outline.area == pytest.approx(area, rel=1e-12)
    bottom = [s for s in gasket.outline.segments if s.name == "seat_bottom"]
    assert all(p[1] == 0.0 for s in bottom for p in (s.start, s.end))


def test_a_lens_touches_a_conical_flange_on_its_normal() -> None:
    contact = ContactGeometry.of(CONE.outline, meshes.LensRing(0.06, 0.014, 0.028, 8e-3).outline)
    assert contact.initial_contact_radius == pytest.approx(0.06 * math.sin(BETA), rel=1e-12)
    assert contact.angle == pytest.approx(-BETA, rel=1e-12)
    assert contact.relative_radius == pytest.approx(0.06, rel=1e-12)


def test_a_double_cone_fits_a_flange_of_its_angle() -> None:
    angle = math.radians(60)
    ring = meshes.DoubleConeRing(0.02, 0.03, 0.02, 0.01, angle, 2e-4)
    contact = ContactGeometry.of(meshes.FlangeFace.conical(angle, 0.024, 0.032).outline, ring.outline)
    assert math.isinf(contact.relative_radius)
    assert contact.angle == pytest.approx(-angle, rel=1e-9)
    assert ring.end_radius < contact.initial_contact_radius < 0.03


def test_an_octagonal_ring_touches_both_walls_of_its_groove_along_their_normals() -> None:
    beta = math.radians(67)
    ring = meshes.OctagonalRing(0.0476, 11e-3, 16e-3, 8e-3, edge_radius=1e-3)
    groove = meshes.FlangeFace.grooved(0.02, 0.0476, 12e-3, 8e-3, bottom_edge_radius=5e-4)
    contact = ContactGeometry.of(groove.outline, ring.outline)
    assert closed(groove.outline)
    assert contact.angle == pytest.approx(beta, rel=1e-9) and math.isinf(contact.relative_radius)
    # the chamber lies in the middle of the ring, and the flanks are images of each other about it
    (chamber,) = contact.chambers
    assert contact.radius(np.array(chamber)) == pytest.approx(0.0476, rel=1e-12)
    x = np.linspace(0.0, chamber - contact.reach[0] - 1e-6, 101)[1:]
    assert contact.gap(chamber + x) == pytest.approx(contact.gap(chamber - x), abs=1e-15)
    inner, outer = contact.normal(np.array([0.0, 2 * chamber])).T
    assert inner == pytest.approx([-math.sin(beta), math.cos(beta)], abs=1e-12)
    assert outer == pytest.approx([math.sin(beta), math.cos(beta)], abs=1e-12)
    # between the roundings each flank touches all along: no ray misses, and none meets another one
    flat = contact.gap(np.linspace(-1e-4, 1e-4, 11))
    assert flat == pytest.approx(0.0, abs=1e-15)
    arc = contact.closure_arc(np.linspace(*contact.reach, 401))
    assert np.all(np.diff(arc) > 0)


@pytest.mark.parametrize("flange", [FLAT, meshes.FlangeFace.raised(0.01, 0.04)])
def test_flat_flanges_touch_the_crest(flange: meshes.FlangeFace) -> None:
    assert closed(flange.outline)
    assert not [s for s in flange.outline.segments if s.name == "closure_axis"]
    for gasket, radius in ((meshes.SolidRing(0.02, 2e-3), 0.02), (GASKETS["delta"][0], 0.0202)):
        contact = ContactGeometry.of(flange.outline, gasket.outline)
        assert contact.initial_contact_radius == pytest.approx(radius, rel=1e-12)


def test_whole_and_half_drawings_give_the_same_half() -> None:
    r, a = 0.02, 2e-3
    corners = [(r, -a), (r + a, 0.0), (r, a), (r - a, 0.0)]
    whole = [Segment(p, q, "", (r, 0.0)) for p, q in zip(corners, [*corners[1:], corners[0]], strict=True)]
    ring = meshes.SolidRing(r, a).outline
    for pieces in (whole, upper_half(whole)):
        drawn = profile_of("gasket", pieces).outline
        assert drawn.area == pytest.approx(ring.area, rel=1e-12)
    # an arc that crosses the mid-plane is cut there
    side = Segment((0.022, -1e-3), (0.022, 1e-3), "", (0.0215, 0.0))
    others = [(0.022, 1e-3), (0.018, 1e-3), (0.018, -1e-3), (0.022, -1e-3)]
    oblong = [side, *(Segment(p, q, "") for p, q in pairwise(others))]
    half = upper_half(oblong)
    assert max(s.start[0] for s in half) == pytest.approx(0.0215 + math.hypot(5e-4, 1e-3), rel=1e-12)
    assert half[-1].name == "bottom"


def test_only_an_image_of_itself_is_halved() -> None:
    corners = [(0.01, -2e-3), (0.014, -2e-3), (0.014, 2e-3), (0.01, 2e-3), (0.01, 1e-3)]
    corners += [(0.012, 1e-3), (0.012, -1e-3), (0.01, -1e-3)]
    legs = [Segment(p, q, "") for p, q in zip(corners, [*corners[1:], corners[0]], strict=True)]
    assert upper_half(legs)[-1].name == "bottom"
    hollow = [(0.01, -2e-3), (0.02, -2e-3), (0.02, 2e-3), (0.018, 2e-3), (0.018, -1e-3), (0.012, -1e-3)]
    hollow += [(0.012, 2e-3), (0.01, 2e-3)]
    # not its own image, so taken as a half as it is drawn
    pieces = [Segment(p, q, "") for p, q in zip(hollow, [*hollow[1:], hollow[0]], strict=True)]
    assert upper_half(pieces) == pieces


def test_impossible_rings_are_refused() -> None:
    for wrong, words in (
        (lambda: meshes.SolidRing(0.002, 0.003), "gasket section_radius"),
        (lambda: meshes.LensRing(0.02, 0.01, 0.03, 0.01), "gasket spherical_radius"),
        (lambda: meshes.DoubleConeRing(0.029, 0.03, 0.02, 0.01, math.radians(60), 0.0), "gasket height"),
        (lambda: meshes.DeltaRing(0.02, 8e-3, 0.0, 2e-4), "gasket angle"),
    ):
        with pytest.raises(GeometryError, match=words):
            wrong()
