"""Hurst exponent, roll-off and height of scans: intervals that contain the truth as often as they say."""

from functools import cache

import numpy as np
import pytest
from scipy.stats import binom

import leak

POINTS, SPACING = 4000, 1e-6
LENGTH = POINTS * SPACING
COUNT = 40


class Scans:
    """Line scans through a Gaussian isotropic surface of rms height 1 um, synthesised here from its C_1D.

    The corner of the roll-off is sharp, or smooth like (1 + (q/q_r)^2)^-(1+H).
    """

    def __init__(self, wavelength, hurst, smooth=False, longer=8):
        q_r, q_high = 2 * np.pi / wavelength, 0.98 * np.pi / SPACING
        k = np.geomspace(1e-4 * q_r, q_high, 6000)
        fall = -2 * (1 + hurst)

        def C(q):
            shape = (1 + (q / q_r) ** 2) ** (fall / 2) if smooth else np.maximum(q / q_r, 1.0) ** fall
            return np.where(q <= q_high, shape, 0.0)

        variance = 2 * np.pi * np.trapezoid(C(k) * k**2, np.log(k))
        # C_1D(q) = 2 int C(sqrt(q^2 + t^2)) dt
        t = np.concatenate([[0.0], np.geomspace(1e-5 * q_r, q_high, 3000)])
        coarse = np.geomspace(1e-3 * q_r, q_high, 300)
        C_1D = np.array([2 * np.trapezoid(C(np.hypot(q, t)), t) for q in coarse]) / variance
        self.total = longer * POINTS
        step = 2 * np.pi / (longer * LENGTH)
        q = step * np.arange(1, self.total // 2)
        self.amplitude = np.sqrt(2 * step * np.interp(q, coarse, C_1D, right=0.0)) * self.total * 1e-6

    def __call__(self, seed):
        random = np.random.default_rng(seed)
        waves = np.zeros(self.total // 2 + 1, complex)
        waves[1:-1] = self.amplitude * (
            random.standard_normal((self.amplitude.size, 2)) @ np.array([0.5, 0.5j])
        )
        return leak.line_scan(SPACING * np.arange(POINTS), np.fft.irfft(waves, self.total)[:POINTS])


scans = cache(Scans)


@cache
def measured(wavelength, hurst, smooth, seed):
    return leak.measure(scans(wavelength, hurst, smooth)(seed))


def surfaces(wavelength, hurst, smooth=False, count=COUNT):
    return [measured(wavelength, hurst, smooth, seed) for seed in range(count)]


def covers(intervals, truth):
    return sum(low <= truth <= high for low, high in intervals)


def fewest(count, confidence=0.9):
    """So few of the intervals contain the truth by chance in one of a thousand sets."""
    return binom.ppf(1e-3, count, confidence)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wavelength", "hurst", "smooth"),
    [
        (0.2e-3, 0.8, False),
        (0.2e-3, 0.5, True),
        (0.1e-3, 0.8, True),
        (0.8e-3, 0.6, False),
        (0.2e-3, 0.3, False),
    ],
)
def test_the_hurst_exponent_is_in_its_interval(wavelength, hurst, smooth):
    found = [one.rolloff for one in surfaces(wavelength, hurst, smooth)]
    known = [one for one in found if one.hurst is not None]
    assert len(known) >= 0.9 * COUNT
    assert covers([one.hurst_interval for one in known], hurst) >= fewest(len(known))
    # an interval that says something; and nowhere near the 0.01 to 0.88 of a fit that takes the shoulder for the slope
    assert np.median([np.ptp(one.hurst_interval) for one in known]) < 0.2
    assert max(abs(one.hurst - hurst) for one in known) < 0.2
    assert max(abs(one.hurst - hurst) / one.hurst_error for one in known) < 4.0


@pytest.mark.slow
@pytest.mark.parametrize(("waves", "hurst"), [(20, 0.8), (5, 0.6), (2, 0.8), (1, 0.6)])
def test_the_height_of_the_surface_is_in_its_interval(waves, hurst):
    found = surfaces(LENGTH / waves, hurst)
    heights = [[one.rms_height * end for end in one.rolloff.height.interval] for one in found]
    assert covers(heights, 1e-6) >= fewest(COUNT)
    warned = sum("too short for its roll-off" in " ".join(one.warnings) for one in found)
    if waves <= 2:
        assert warned >= 0.9 * COUNT
    if waves >= 20:
        assert warned <= 0.05 * COUNT


@pytest.mark.slow
def test_the_leak_rate_of_the_true_surface_is_in_the_interval_of_two_wavelengths():
    """The effective gap cubed, at a fiftieth of the area in contact, elastic."""
    from fem_seal.case.roughness import UncertainHeight

    def flow(spectrum):
        contact = leak.RoughContact(spectrum, effective_modulus=115e9)
        return float(contact.effective_separation(20e6)) ** 3

    wavelength, inside, measured = LENGTH / 2, 0, []
    q_r = 2 * np.pi / wavelength
    true = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.8, q_low=q_r / 100, q_rolloff=q_r, q_high=np.pi / SPACING
    )
    truth = flow(true)
    for surface in surfaces(wavelength, 0.8, count=20):
        of_length = UncertainHeight(
            "seat", "scan_length", surface.rolloff.height, surface.rolloff.wavenumber or surface.q_low
        )
        factors = of_length.values(np.array([[0.05], [0.95]]))[:, 0]
        low, high = (flow(of_length.spectrum(surface.measured, factor)) for factor in factors)
        inside += low <= truth <= high
        measured.append(flow(surface.measured))
    assert np.median(measured) < 0.75 * truth  # what such a scan alone would say, on the unsafe side
    assert inside >= fewest(20)


def test_long_waves_are_changed_and_short_ones_stay():
    from fem_seal.case.roughness import UncertainHeight

    surface = measured(0.2e-3, 0.8, False, 0)
    q_r = surface.rolloff.wavenumber
    of_length = UncertainHeight("seat", "scan_length", surface.rolloff.height, q_r)
    for factor in (0.7, 1.0, 1.8):
        changed = of_length.spectrum(surface.measured, factor)
        assert changed.rms_height == pytest.approx(factor * surface.measured.rms_height, rel=1e-6)
        assert changed(10 * q_r) == pytest.approx(surface.measured(10 * q_r), rel=1e-9)
    # below what the short waves alone have there is nothing to take away
    least = of_length.spectrum(surface.measured, 1e-3)
    assert least.rms_height < 0.7 * surface.measured.rms_height


def test_many_scans_narrow_the_intervals():
    scan = scans(0.2e-3, 0.6)
    one, many = leak.measure(scan(0)), leak.measure([scan(seed) for seed in range(16)])
    for name in ("hurst_interval",):
        assert np.ptp(getattr(many.rolloff, name)) < 0.6 * np.ptp(getattr(one.rolloff, name))
    assert np.ptp(many.rolloff.height.interval) < 0.5 * np.ptp(one.rolloff.height.interval)
    assert many.rolloff.wavenumber == pytest.approx(2 * np.pi / 0.2e-3, rel=0.3)


@pytest.mark.parametrize("kind", ["white", "wave", "short"])
def test_what_is_not_self_affine_has_no_hurst_exponent(kind):
    random = np.random.default_rng(0)
    points = 24 if kind == "short" else 3000
    x = 1e-6 * np.arange(points)
    h = random.standard_normal(points)
    if kind == "wave":
        h = 0.1 * h + 5 * np.sin(x / 1e-5)
    rolloff = leak.measure(leak.line_scan(x, 1e-6 * h)).rolloff
    assert rolloff.hurst is None and rolloff.hurst_error is None and rolloff.hurst_interval is None
    low, high = rolloff.height.interval
    assert low < 1.0 < high
