"""Turned faces in scans: known cusps are found again, random surfaces and lays are not taken for them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from places import SHARED

import leak

FEED, NOSE = 1e-4, 8e-4


def fine(rms_height: float = 1e-7) -> leak.PowerSpectrum:
    return leak.PowerSpectrum.self_affine(
        rms_height=rms_height, hurst=0.8, q_low=math.pi / FEED, q_rolloff=25.0 / FEED, q_high=400.0 / FEED
    )


def turned_scan(
    feeds: float = 40.0,
    rms_height: float = 1e-7,
    *,
    seed: int = 1,
    crest_scatter: float = 0.0,
    jitter: float = 0.0,
    drift: float = 0.0,
) -> leak.LineScan:
    """Parabolas of the nose at each turn, of which the lowest is left, on fine roughness, with a tilt."""
    rng = np.random.default_rng(seed)
    x, h = leak.random_line_scan(fine(rms_height), length=feeds * FEED, points=round(100 * feeds), seed=seed)
    turn = np.arange(-2, math.ceil(feeds) + 3)
    place = FEED * (turn + 0.37) * (1.0 + drift * turn / feeds) + jitter * FEED * rng.standard_normal(
        turn.size
    )
    # a crest lies between two grooves: its height has half of the sum of their variances
    depth = math.sqrt(2.0) * crest_scatter * rng.standard_normal(turn.size)
    cusps = np.min(depth[:, None] + (x - place[:, None]) ** 2 / (2.0 * NOSE), axis=0)
    return leak.line_scan(x, h + cusps + 1e-3 * x)


def recognised(scan: leak.LineScan | leak.HeightMap) -> leak.TurnedScan:
    found = leak.recognise_texture(scan)
    assert found is not None
    return found


@pytest.mark.parametrize(("feeds", "rms_height"), [(12.5, 5e-8), (12.5, 1e-7), (40.0, 1e-7), (100.0, 2e-7)])
@pytest.mark.parametrize("seed", range(3))
def test_known_cusps_are_found_again(feeds, rms_height, seed):
    found = recognised(turned_scan(feeds, rms_height, seed=seed, crest_scatter=4e-8))
    assert found.feed == pytest.approx(FEED, rel=5e-3)
    assert abs(found.feed - FEED) < 5.0 * found.feed_error
    assert found.nose_radius == pytest.approx(NOSE, rel=0.1)
    assert found.side_slope == pytest.approx(FEED / (2.0 * NOSE), rel=0.1)
    assert found.crest_height == pytest.approx(FEED**2 / (8.0 * NOSE), rel=0.1)
    assert found.fine.rms_height == pytest.approx(rms_height, rel=0.15)
    assert found.texture == leak.TurnedTexture(found.feed, found.nose_radius, found.fine)


def test_strong_fine_roughness_and_few_feeds():
    """Fine roughness of 30 % of the crest height takes many feeds; three feeds take little roughness."""
    rough = recognised(turned_scan(60.0, 0.3 * 1.5625e-6))
    assert rough.feed == pytest.approx(FEED, rel=5e-3)
    assert rough.nose_radius == pytest.approx(NOSE, rel=0.15)
    short = recognised(turned_scan(3.3, 3e-8))
    assert short.feed == pytest.approx(FEED, rel=1e-2)
    assert short.nose_radius == pytest.approx(NOSE, rel=0.1)


def test_scatter_of_the_crests():
    mean = np.mean(
        [recognised(turned_scan(80.0, seed=n, crest_scatter=1e-7)).crest_scatter for n in range(4)]
    )
    assert mean == pytest.approx(1e-7, rel=0.15)


@pytest.mark.parametrize("changes", [{"jitter": 0.02}, {"drift": 0.02}])
def test_feed_that_varies(changes):
    found = recognised(turned_scan(60.0, **changes))
    assert found.feed == pytest.approx(FEED * (1.0 + changes.get("drift", 0.0)), rel=5e-3)
    assert found.nose_radius == pytest.approx(NOSE, rel=0.1)


def test_share_is_that_of_the_variances():
    """Variance of a parabola 4/45 R_t^2."""
    cusps = 4.0 / 45.0 * 1.5625e-6**2
    assert recognised(turned_scan(100.0)).periodic_share == pytest.approx(cusps / (cusps + 1e-14), abs=0.01)


def test_groove_that_is_no_parabola_has_its_slope():
    """R (2 u)^4: a slope of 8 R/f at the crest."""
    x, rough = leak.random_line_scan(fine(5e-8), length=4e-3, points=8_000, seed=2)
    place = 2.0 * ((x / FEED + 0.3) % 1.0) - 1.0
    found = recognised(leak.line_scan(x, 1.5e-6 * place**4 + rough))
    assert found.side_slope == pytest.approx(8.0 * 1.5e-6 / FEED, rel=0.05)
    assert found.parabola_deviation > 0.03
    assert recognised(turned_scan()).parabola_deviation == 0.0


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(
    shift=st.integers(0, 150),
    scale=st.sampled_from([0.1, 0.5, 3.0, 20.0]),
    tilt=st.floats(-5e-3, 5e-3),
    height=st.floats(-1e-3, 1e-3),
    mirrored=st.booleans(),
)
def test_where_and_how_it_lies_does_not_matter(shift, scale, tilt, height, mirrored):
    whole = turned_scan(30.0)
    before = recognised(whole)
    h = whole.heights[shift:][:: -1 if mirrored else 1]
    x = np.arange(h.size) * whole.spacing
    after = recognised(leak.line_scan(x * scale, (h + tilt * x + height) * scale))
    for name in ("feed", "nose_radius", "crest_height"):
        assert getattr(after, name) == pytest.approx(getattr(before, name) * scale, rel=0.03)
    assert after.side_slope == pytest.approx(before.side_slope, rel=0.03)
    assert after.fine.rms_height == pytest.approx(before.fine.rms_height * scale, rel=0.06)


@pytest.mark.parametrize("angle", [0.0, 90.0, 17.0, -33.0])
def test_map_lies_as_it_will(angle):
    step = 5e-6
    rough = leak.random_map(fine(), size=256 * step, points=256, seed=3)[:, :200]
    x, y = np.meshgrid(*(np.arange(n) * step for n in rough.shape), indexing="ij")
    across = x * math.cos(math.radians(angle)) + y * math.sin(math.radians(angle))
    depth = leak.TurnedTexture(FEED, NOSE, fine()).depth_at(np.abs((across + 3e-5) % FEED - 0.5 * FEED))
    found = recognised(leak.height_map(rough - depth + 1e-3 * x, (step, step)))
    assert found.feed == pytest.approx(FEED, rel=5e-3)
    assert found.nose_radius == pytest.approx(NOSE, rel=0.05)
    assert found.fine.rms_height == pytest.approx(1e-7, rel=0.15)


@pytest.mark.slow
def test_random_surfaces_are_not_turned():
    """Self-affine profiles, and waves of narrow spectra from 0.1 to 30 % wide, of which four to eighty fit in."""
    for seed in range(60):
        rng = np.random.default_rng(seed)
        spectrum = leak.PowerSpectrum.self_affine(
            rms_height=1e-6,
            hurst=rng.uniform(0.3, 1.0),
            q_low=1e3,
            q_rolloff=10 ** rng.uniform(3.2, 5),
            q_high=1e6,
        )
        x, h = leak.random_line_scan(spectrum, length=4e-3, points=2_000, seed=seed)
        assert leak.recognise_texture(leak.line_scan(x, h)) is None
        waves = np.arange(16_001) / 16.0 / rng.uniform(4.0, 80.0) - 1.0
        narrow = np.exp(-0.5 * (waves / 10 ** rng.uniform(-3.0, -0.5)) ** 2) + 1e-9
        h = 0.05 * h + np.fft.irfft(narrow * (rng.standard_normal((waves.size, 2)) @ [1e-3, 1e-3j]))[: x.size]
        assert leak.recognise_texture(leak.line_scan(x, h)) is None


@pytest.mark.parametrize("peklenik", [1.0, 8.0, 0.03])
def test_lay_of_random_grooves_is_not_turned(peklenik):
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.8, q_low=5e3, q_rolloff=4e4, q_high=6e5
    )
    for seed in range(6):
        h = leak.random_map(spectrum, size=1.28e-3, points=256, seed=seed, peklenik=peklenik)[:200, :220]
        assert leak.recognise_texture(leak.height_map(h, (5e-6, 5e-6))) is None


def test_sine_and_upside_down_are_not_turned():
    x, rough = leak.random_line_scan(fine(), length=4e-3, points=8_000, seed=2)
    assert leak.recognise_texture(leak.line_scan(x, 1e-6 * np.sin(2.0 * np.pi * x / FEED) + rough)) is None
    scan = turned_scan()
    assert leak.recognise_texture(leak.line_scan(np.arange(scan.heights.size) * 1e-6, -scan.heights)) is None


@pytest.mark.parametrize(
    "name", ["dektak-1.csv", "hfm-1.hfm", "mitutoyo_2_mock.xlsx", "mitutoyo_mock.xlsx", "plu-1.plu"]
)
def test_files_of_instruments_show_no_feed(name):
    path = SHARED / "topography" / name
    if not path.exists():
        pytest.skip(f"{path} is not there")
    if path.suffix in (".xlsx", ".plu"):
        pytest.importorskip("SurfaceTopography")
    for form in ("tilt", "curvature"):
        assert leak.recognise_texture(leak.read_topography(path).without_form(form)) is None
