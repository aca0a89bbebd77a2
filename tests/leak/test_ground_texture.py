"""Ground faces to be simulated: the statistics of their grooves, scaling, and numbers of an independent simulation."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import leak
from leak.direct import TexturePatch, simulate_texture

STEEL = {"effective_modulus": 115e9, "hardness": 3.5e9}


def self_affine(rms, rolloff, shortest, longest=4e-4):
    return leak.PowerSpectrum.self_affine(
        rms_height=rms,
        hurst=0.8,
        q_low=2.0 * math.pi / longest,
        q_rolloff=2.0 * math.pi / rolloff,
        q_high=2.0 * math.pi / shortest,
    )


def ground(fine=1e-7, scale=1.0, length=math.inf, shortest=3.2e-6):
    waves = [(3e-7, 60e-6), (fine, 25e-6)]
    grooves, roughness = (
        self_affine(rms * scale, rolloff * scale, shortest * scale, 4e-4 * scale) for rms, rolloff in waves
    )
    return leak.GroundTexture(grooves, roughness, length * scale)


def test_a_line_across_has_the_spectrum_of_the_grooves():
    face = ground(fine=1e-12)
    heights = [face.heights(points=256, crests=2, seed=seed) for seed in range(60)]
    # endless grooves
    assert max(float(np.ptp(h, axis=1).max()) for h in heights) < 1e-10
    size = 2.0 * face.period
    waves = np.mean([np.abs(np.fft.fft(h[:, 0])) ** 2 for h in heights], axis=0) / 256**2
    q = 2.0 * math.pi / size * np.arange(1, 60)
    density = waves[1:60] * size / (2.0 * math.pi)
    expected = np.asarray(leak.profile_density(face.grooves, q))
    # each wave of sixty maps is known to 13 %
    assert np.mean(density / expected) == pytest.approx(1.0, abs=0.06)
    assert np.abs(np.log(density / expected)).max() < 0.6


def test_correlation_along_a_groove_falls_to_1_over_e_over_its_length():
    face = ground(fine=1e-12, length=1e-4)
    heights = np.array([face.heights(points=128, crests=2, seed=seed) for seed in range(60)])
    heights = heights - heights.mean(axis=1, keepdims=True)
    step = 2.0 * face.period / 128
    lag = round(1e-4 / step)
    correlation = np.mean(heights * np.roll(heights, lag, axis=2)) / np.mean(heights**2)
    assert correlation == pytest.approx(math.exp(-((lag * step / 1e-4) ** 2)), abs=0.05)


def test_half_the_size_conducts_an_eighth():
    whole, half = (
        simulate_texture(ground(scale=scale), **STEEL, pressures=[20e6, 50e6], points=64, seeds=[1])
        for scale in (1.0, 0.5)
    )
    assert whole.k_across[0] > 0.0
    assert half.k_across == pytest.approx(whole.k_across / 8.0, rel=1e-3)


def test_what_the_grid_does_not_hold_is_cut_of_both():
    face = ground()
    patch = TexturePatch(face, 64)
    highest = 2.0 * math.pi / patch.shortest_wavelength * (1.0 + 1e-9)
    never = replace(face, grooves=face.grooves.between(0.0, highest), fine=face.fine.between(0.0, highest))
    held = patch.heights(1)
    assert held == pytest.approx(never.heights(points=64, crests=2, seed=1), abs=1e-12)


def test_short_grooves_leak_around_their_ends():
    pressures = [50e6]
    long, short = (
        simulate_texture(ground(length=length), **STEEL, pressures=pressures, points=128, seeds=(1, 2, 3))
        for length in (math.inf, 1e-4)
    )
    assert short.k_across[0] > 2.0 * long.k_across[0]


@pytest.mark.parametrize(
    ("about", "words"),
    [({"length": -1.0}, "length"), ({"grooves": 3.0}, "grooves"), ({"fine": None}, "fine")],
)
def test_what_makes_no_sense_is_refused(about, words):
    with pytest.raises(leak.SurfaceError, match=words):
        replace(ground(), **about)


@pytest.mark.slow
def test_numbers_of_an_independent_simulation():
    """Steel of 3.5 GPa, two seeds on 512 points: mean conductivity across of each pressure, within a factor of two.

    With fine roughness of 0.03 um instead it has 1e-25 to 6e-24 m^3 at 20 MPa and is sealed from 50 MPa on.
    """
    pressures = [20e6, 50e6, 100e6, 200e6]
    found = simulate_texture(ground(), **STEEL, pressures=pressures, points=256, seeds=(1, 2, 3, 4))
    ratio = found.k_across / [1.2e-20, 2.6e-21, 5.5e-22, 3.9e-23]
    assert ratio.min() > 0.5 and ratio.max() < 2.0
    smoother = simulate_texture(
        ground(3e-8), **STEEL, pressures=pressures[:2], points=256, seeds=(1, 2, 3, 4)
    )
    assert smoother.k_across[0] < 6e-24 and smoother.k_across[1] == 0.0
