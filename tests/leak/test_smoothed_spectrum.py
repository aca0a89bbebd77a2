"""A spectrum that is smoothed by yielding, against the capped surface: what the page on yielding says of it."""

from __future__ import annotations

import pytest
import smoothed_spectrum as smoothing

import leak


def test_what_is_left_of_the_spectrum_is_that_of_the_theory() -> None:
    """Mean gap of the conserved reading, which the product calculates another way."""
    surface = leak.RoughContact(smoothing.spectrum(), effective_modulus=1.0, hardness=0.1)
    assert smoothing.theory_gap(0.01, 0.1, 1.0) == pytest.approx(
        surface.conserved.mean_separation(0.01), rel=1e-3
    )
    assert smoothing.theory_gap(0.01, 0.1, 0.0) == pytest.approx(
        surface.elastic.mean_separation(0.01), rel=1e-3
    )


@pytest.mark.slow
def test_the_gap_decides_whether_the_conductivity_is_right() -> None:
    """C_pl has neither; a spectrum smoothed to the right mean gap has both."""
    _, gap, flow = smoothing.ratios(0.01, 0.1, 1.0, seeds=(1,))
    # the theory has the gap of the smoothed surface right: it is the smoothing that is wrong
    surface = leak.RoughContact(smoothing.spectrum(), effective_modulus=1.0, hardness=0.1)
    told = surface.conserved.mean_separation(0.01) / surface.capped.mean_separation(0.01)
    assert gap == pytest.approx(told, rel=0.1)
    assert flow < 0.1
    extent = smoothing.extent_of_equal_gap(0.01, 0.1)
    assert 0.0 < extent < 0.1
    _, gap, flow = smoothing.ratios(0.01, 0.1, extent, seeds=(1,))
    assert gap == pytest.approx(1.0, abs=0.05)
    assert flow == pytest.approx(1.0, abs=0.25)
