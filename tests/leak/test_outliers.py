"""Points that stand alone: found where they are, called what they are, and taken out on request."""

import numpy as np
import pytest

import leak
from leak.surfaces.scans import find_outliers, without_outliers

TRUE = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e3, q_rolloff=3e4, q_high=3e6)
PLACES = (300, 900, 1500, 2200, 3100)


def scan(seed=0, spikes=0.0, width=1, places=PLACES):
    x, h = leak.random_line_scan(TRUE, length=4e-3, points=4000, seed=seed)
    for place in places:
        h[place : place + width] += spikes
    return leak.line_scan(x, h, name="seat")


def test_a_clean_surface_has_none():
    for seed in range(20):
        assert find_outliers(scan(seed)).count == 0
    heights = leak.random_map(TRUE, size=1e-3, points=256, seed=0)
    assert find_outliers(leak.height_map(heights, (4e-6, 4e-6))).count == 0


@pytest.mark.parametrize("width", [1, 3, 6])
@pytest.mark.parametrize("height", [10e-6, -10e-6])
def test_five_spikes_are_five_outliers(width, height):
    found = find_outliers(scan(spikes=height, width=width))
    assert found.count == 5
    assert found.pits == (5 if height < 0 else 0)
    # the surface itself goes up and down by a micrometre or two beside a wide one
    assert found.height == pytest.approx(10e-6, rel=0.3)
    wanted = np.zeros(4000, bool)
    for place in PLACES:
        wanted[place : place + width] = True
    assert np.array_equal(found.points, wanted)


def test_without_them_the_surface_is_what_it_was():
    clean, spiked = leak.measure(scan()), leak.measure(scan(spikes=10e-6))
    removed = leak.measure(scan(spikes=10e-6), leak.ScanSettings(outliers="remove"))
    assert spiked.spectrum.rms_slope > 1.15 * clean.spectrum.rms_slope
    assert removed.spectrum.rms_slope == pytest.approx(clean.spectrum.rms_slope, rel=0.01)
    assert removed.rms_height == pytest.approx(clean.rms_height, rel=1e-3)
    # and so does the leak rate of elastic asperities
    flows = [
        float(leak.RoughContact(one.spectrum, effective_modulus=115e9).effective_separation(50e6)) ** 3
        for one in (clean, spiked, removed)
    ]
    assert flows[2] == pytest.approx(flows[0], rel=0.02)


def test_what_is_said_of_them():
    said = " ".join(leak.measure(scan(spikes=10e-6)).warnings)
    assert "seat: 5 outliers, up to" in said
    assert 'outliers = "remove" replaces them' in said
    removed = " ".join(leak.measure(scan(spikes=10e-6), leak.ScanSettings(outliers="remove")).warnings)
    assert "5 outliers" in removed and "are replaced by what surrounds them" in removed
    assert "outlier" not in " ".join(leak.measure(scan()).warnings)


def test_dust_on_a_map_is_an_outlier_and_a_groove_is_none():
    heights = leak.random_map(TRUE, size=1e-3, points=256, seed=0)
    dusty, grooved = heights.copy(), heights.copy()
    dusty[100:102, 60:62] += 10e-6
    grooved[120, :] -= 10e-6
    found = find_outliers(leak.height_map(dusty, (4e-6, 4e-6)))
    assert (found.count, found.pits) == (1, 0)
    cleaned = without_outliers(leak.height_map(dusty, (4e-6, 4e-6)), found)
    assert np.abs(cleaned.heights - heights).max() < 1.5e-6
    assert find_outliers(leak.height_map(grooved, (4e-6, 4e-6))).count == 0


def test_a_surface_of_peaks_has_no_outliers():
    h = np.exp(2 * np.random.default_rng(0).standard_normal(3000))
    assert find_outliers(leak.line_scan(1e-6 * np.arange(3000), 1e-6 * h)).count == 0


def test_a_wrong_setting_is_refused():
    with pytest.raises(leak.ScanError, match="outliers"):
        leak.ScanSettings(outliers="drop")
