"""The theory against direct numerical results: boundary elements and Reynolds flow, nothing of Persson's theory.

Tolerances are what the reference says about the theory: mean gap within 10 %, conductivity within 30 % for A/A0 < 0.19,
a factor 1.7 up to 0.25 and 3.3 up to 0.38; area 20 to 40 % below the direct one on the grid as it is.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from direct_numerical import (
    Comparison,
    compare,
    low_loads,
    periodic_spectrum,
    picture,
    read_direct,
    worst_factor,
)


@pytest.fixture(scope="module")
def comparisons(reference_folder) -> list[Comparison]:
    return [compare(direct) for direct in read_direct(reference_folder)]


def test_mean_gap_is_within_ten_per_cent(comparisons):
    for comparison in comparisons:
        np.testing.assert_allclose(comparison.gap, 1.0, atol=0.10)


@pytest.mark.parametrize(("area", "factor"), [(0.19, 1.30), (0.255, 1.7), (0.39, 3.3)])
def test_conductivity_is_within_the_known_factor_of_the_theory(comparisons, area, factor):
    for comparison in comparisons:
        assert worst_factor(comparison.default[comparison.direct.area < area]) < factor


def test_at_low_loads_the_theory_is_too_open_by_the_factors_that_the_manual_names(reference_folder):
    found = low_loads(reference_folder)
    assert len(found[1e-4]) == 9
    for pressure, least, most in ((1e-3, 1.55, 1.9), (1e-4, 2.0, 2.7), (3e-5, 2.4, 3.3)):
        assert least < found[pressure].min() < found[pressure].max() < most


def test_area_is_too_small_by_the_known_amount(comparisons):
    for comparison in comparisons:
        share = comparison.area * comparison.direct.area_corrected / comparison.direct.area
        # 0.6 to 0.8, and 0.83 at the largest pressure
        assert share.min() > 0.6
        assert share.max() < 0.83


def test_default_is_the_best_reading_near_the_threshold(comparisons):
    for comparison in comparisons:
        near = comparison.direct.area > 0.3
        factors = {name: worst_factor(ratios[near]) for name, ratios in comparison.conductivity.items()}
        default, *others = factors.values()
        # set B has two surfaces only; the critical junction happens to be as good there
        if comparison.direct.name != "B":
            assert default < min(others)
        assert default < 3.3
        assert max(others) > 6


def test_periodic_spectrum_has_the_moments_of_the_sum_over_the_lattice():
    rolloff, cutoff, hurst = 8, 64, 0.8
    n = np.arange(-cutoff, cutoff + 1)
    waves = np.hypot(*np.meshgrid(n, n))
    inside = (waves > 0) & (waves <= cutoff)
    C = np.where(waves < rolloff, 1.0, (np.maximum(waves, 1) / rolloff) ** (-2 * (1 + hurst))) * inside
    height, slope = math.sqrt(C.sum()), math.sqrt((C * (2 * math.pi * waves) ** 2).sum())
    spectrum = periodic_spectrum(rolloff, cutoff, hurst)
    assert spectrum.rms_slope == pytest.approx(1.0, rel=1e-12)
    # the lattice is coarse against the first waves: 1e-3
    assert spectrum.rms_height == pytest.approx(height / slope, rel=1e-3)


def test_picture_is_drawn(comparisons, tmp_path):
    path = picture([comparison.direct for comparison in comparisons], tmp_path / "images" / "direct.svg")
    assert "<svg" in path.read_text(encoding="utf-8")[:2000]
