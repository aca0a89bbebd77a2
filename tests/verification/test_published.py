"""Published benchmarks: found as the page has them, and no farther from the source than it explains."""

from __future__ import annotations

import math

import published
import punch_elements
import pytest
from scipy.optimize import brentq

import fem_seal

SLOW = {"sphere", "wedge"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in published.MEASURES]
)
def test_numbers_are_found_once_more(name: str) -> None:
    """On another processor meshes of gmsh differ, and numbers by some 1e-4."""
    assert published.MEASURES[name]() == pytest.approx(published.read()[name], rel=1e-3)


@pytest.mark.parametrize("name", list(published.MEASURES))
def test_differences_from_the_sources_are_explained(name: str) -> None:
    rows = published.rows(name, published.read()[name])
    assert {row.what: row.difference for row in rows if not row.is_explained} == {}


def test_page_is_up_to_date() -> None:
    assert published.PAGE.read_text(encoding="utf-8") == published.page(published.read())


@pytest.mark.slow
def test_a_punch_by_elements_of_its_own_settles_as_the_page_says() -> None:
    """The published settlement lies between even meshes of 10 and 5 mm, 2.4 % above that of a fine one."""
    coarse, finer = (punch_elements.settlement(size)[0] for size in (10.0, 5.0))
    assert (coarse, finer) == pytest.approx((-0.12876, -0.13144), rel=1e-4)
    assert -coarse < 0.13073 < -finer
    fine, middle = punch_elements.settlement(2.5, at_edge=0.1)
    assert (fine, middle) == pytest.approx((-0.13394, 88.27), rel=2e-4)
    # and is the same where the edge is resolved half as well
    assert punch_elements.settlement(5.0, at_edge=0.2)[0] == pytest.approx(fine, rel=1e-3)


def test_slip_lines_of_a_crushed_wedge() -> None:
    """Numbers of the page by the formula beside them."""
    for angle, published_pressure in (
        (15, 1.264),
        (30, 1.504),
        (45, 1.818),
        (60, 2.179),
        (80, 2.7004),
        (85, 2.8342),
    ):
        alpha = math.radians(angle)
        psi = brentq(
            lambda psi, a=alpha: psi + math.acos(math.tan(math.pi / 4 - psi / 2)) - 2 * a, 1e-9, math.pi / 2
        )
        assert 2 / math.sqrt(3) * (1 + psi) == pytest.approx(published_pressure, abs=5e-4)


def test_a_wedge_of_60_deg_is_beyond_small_strains() -> None:
    case = fem_seal.load_case(published.HERE / "wedge_80.toml")
    slope, radius = 1.0 / math.tan(math.radians(60.0)), 0.2e-3
    side = radius * math.cos(math.radians(60.0))
    top = 0.03 + (0.02 - side) * slope
    edge = [
        {"to": (4.0 + side, top)},
        {"to": (4.0 - side, top), "centre": (4.0, top - radius * math.sin(math.radians(60.0)))},
    ]
    pieces = [{"to": piece.to} for piece in case.gasket.outline]
    with pytest.raises(fem_seal.InputError, match="beyond small strains: not calculated"):
        fem_seal.run(case.replace({"gasket.outline": [*pieces[:3], *edge, *pieces[5:]]}))
