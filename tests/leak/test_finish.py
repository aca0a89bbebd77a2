"""From a drawing's finish to a spectrum and back: filters, processes, roughness parameters."""

import math

import numpy as np
import pytest

import leak
from leak.surfaces.finish import PROCESSES, Finish, process_named
from leak.surfaces.profile_parameters import (
    ProfileFilter,
    expected_roughness,
    filtered_profile,
    implied_filter,
    roughness_parameters,
)
from leak.surfaces.turned import TurnedRoughness

UM = 1e-6


def profile(spectrum, *, spacing, points, seed):
    """Periodic Gaussian profile, with the one-dimensional spectrum of an isotropic surface interpolated."""
    q = 2 * np.pi * np.fft.rfftfreq(points, spacing)[1:-1]
    nodes = np.geomspace(q[0], min(q[-1], spectrum.q_high * 0.999), 400)
    density = np.exp(
        np.interp(np.log(q), np.log(nodes), np.log(leak.profile_density(spectrum, nodes)), right=-np.inf)
    )
    random = np.random.default_rng(seed).standard_normal((q.size, 2)) @ [1, 1j]
    amplitude = np.zeros(points // 2 + 1, dtype=complex)
    amplitude[1:-1] = np.sqrt(density * q[0]) * random * points / math.sqrt(2)
    return np.fft.irfft(amplitude, points)


def profile_of(face, *, spacing, points, seed):
    """Of a face, of a turned one fine roughness on cusps of a whole number in the profile."""
    heights = profile(face.across, spacing=spacing, points=points, seed=seed)
    if face.texture is None:
        return heights
    feed = points * spacing / round(points * spacing / face.texture.feed)
    place = np.arange(points) * spacing % feed
    depth = face.texture.depth_at(np.minimum(place, feed - place) * face.texture.feed / feed)
    return heights - depth + depth.mean()


def filtered_by_fourier(heights, spacing, band):
    """The filter on a periodic profile, wave by wave: nothing in common with a convolution."""
    wave = np.fft.rfftfreq(heights.size, spacing)
    passed = (1 - 0.5 ** ((band.lambda_c * wave) ** 2)) * 0.5 ** ((band.lambda_s * wave) ** 2)
    return np.fft.irfft(passed * np.fft.rfft(heights), heights.size)


# every process at a usual value, and one from the finest to the coarsest
CASES = [(name, min(max(0.4 * UM, one.Ra[0]), one.Ra[1])) for name, one in PROCESSES.items()] + [
    ("ground", value * UM) for value in (0.02, 0.1, 1.6, 6.3)
]


@pytest.mark.parametrize(("name", "value"), CASES)
def test_ra_in_is_ra_out(name, value):
    finish = Finish("Ra", value, process_named(name))
    band = finish.band
    spacing = max(band.lambda_s, 1e-6) / 4
    points = 2 ** math.ceil(math.log2(250 * band.lambda_c / spacing))
    heights = profile_of(finish.surface(), spacing=spacing, points=min(points, 2**18), seed=3)
    by_fourier = filtered_by_fourier(heights, spacing, band)
    by_convolution = filtered_profile(heights, spacing, band)
    for one in (by_fourier, by_convolution):
        assert np.mean(np.abs(one)) == pytest.approx(value, rel=0.03)
    # the ends apart both are the same filter, but for four points in the cutoff lambda_s
    inside = slice(int(2 * band.lambda_c / spacing), -int(2 * band.lambda_c / spacing))
    assert np.abs(by_convolution[inside] - by_fourier[inside]).max() < 0.02 * value


def test_a_short_evaluation_gives_the_same_ra_on_average():
    finish = Finish("Ra", 0.4 * UM, process_named("lapped"))
    spacing = 0.5 * UM
    x, h = leak.random_line_scan(finish.surface().across, length=0.06, points=120_000, seed=5)
    pieces = h.reshape(12, -1)
    found = [roughness_parameters([leak.line_scan(x[: one.size], one)]) for one in pieces]
    assert all(one.sections == 5 and one.filter == finish.band for one in found)
    assert spacing == pytest.approx(x[1])
    assert np.mean([one.Ra for one in found]) == pytest.approx(0.4 * UM, rel=0.03)
    # maxima: the formula for many waves in a section is good to some per cent
    assert np.mean([one.Rz for one in found]) == pytest.approx(finish.surface().expected.Rz, rel=0.05)


@pytest.mark.parametrize("parameter", ["Ra", "Rq", "Rz"])
@pytest.mark.parametrize(
    ("name", "shares"),
    [
        ("lapped", {}),
        ("reamed", {}),
        ("sandblasted", {}),
        ("turned", {}),
        ("turned", {"fine_height": 0.0, "nose_radius": 1.0}),
        ("turned", {"fine_height": 1.0, "nose_radius": 0.0}),
    ],
)
def test_each_parameter_comes_back(parameter, name, shares):
    value = {"Ra": 0.8, "Rq": 1.0, "Rz": 5.0}[parameter] * UM
    finish = Finish(parameter, value, process_named(name))
    spacing, section = 0.6 * UM, finish.band.lambda_c
    heights = profile_of(finish.surface(shares), spacing=spacing, points=2**19, seed=11)
    filtered = filtered_by_fourier(heights, spacing, finish.band)
    count = int(section / spacing)
    parts = filtered[: filtered.size // count * count].reshape(-1, count)
    found = {
        "Ra": np.mean(np.abs(filtered)),
        "Rq": np.sqrt(np.mean(filtered**2)),
        "Rz": np.mean(parts.max(axis=1) - parts.min(axis=1)),
    }
    # Rz rests on a formula for the maxima of many independent waves
    assert found[parameter] == pytest.approx(value, rel=0.06 if parameter == "Rz" else 0.03)


def test_a_map_with_a_lay_has_the_value_across_it():
    finish = Finish("Ra", 0.8 * UM, process_named("reamed"), q_high=2 * np.pi / (8 * UM))
    face = finish.surface()
    root = math.sqrt(face.aspect)
    before = leak.PowerSpectrum(face.across.wavenumber / root, face.across.density * face.aspect)
    size, points = 3.2e-3, 1024
    found = []
    for seed in range(3):
        heights = leak.random_map(before, size=size, points=points, seed=seed, peklenik=1 / face.aspect)
        across = [filtered_by_fourier(line, size / points, finish.band) for line in heights.T[::8]]
        along = [filtered_by_fourier(line, size / points, finish.band) for line in heights[::8]]
        found.append((np.mean(np.abs(across)), np.mean(np.abs(along))))
    across, along = np.mean(found, axis=0)
    assert across == pytest.approx(0.8 * UM, rel=0.03)
    assert along < 0.95 * across


def test_transmission_of_the_filters():
    band = ProfileFilter(0.8e-3, 2.5e-6)
    half = band.transmission(2 * np.pi / np.array([0.8e-3, 2.5e-6]))
    assert half == pytest.approx([0.5, 0.5], abs=1e-5)
    assert band.transmission(2 * np.pi / 50e-6) == pytest.approx(1.0, abs=0.003)
    # of a third of the cutoff 1 - 2^-9
    assert ProfileFilter(0.9e-3).transmission(2 * np.pi / 0.3e-3) == pytest.approx(1 - 2.0**-9)


def test_moments_are_those_of_the_profile_spectrum():
    face = Finish("Ra", 0.4 * UM, process_named("ground")).surface()
    q = np.geomspace(1e-3 * face.across.q_low, face.across.q_high, 6000)
    weight = np.asarray(leak.profile_density(face.across, q)) * face.expected.filter.transmission(q) ** 2
    assert np.sqrt(2 * np.trapezoid(weight, q)) == pytest.approx(face.expected.Rq, rel=1e-4)
    waves = np.sqrt(np.trapezoid(weight * q**2, q) / np.trapezoid(weight, q)) / (2 * np.pi)
    assert waves * face.expected.filter.lambda_c == pytest.approx(face.expected.waves, rel=1e-4)


def test_what_a_value_implies():
    classes = [
        (0.02, 0.08, 2.5),
        (0.1, 0.25, 2.5),
        (0.11, 0.8, 2.5),
        (2.0, 0.8, 2.5),
        (10.0, 2.5, 8.0),
        (11.0, 8.0, 25.0),
    ]
    for value, lambda_c, lambda_s in classes:
        found = implied_filter("Ra", value * UM)
        assert (found.lambda_c, found.lambda_s) == pytest.approx((lambda_c * 1e-3, lambda_s * UM))
    assert implied_filter("Rz", 16 * UM).lambda_c == 0.8e-3
    assert implied_filter("Rq", 1.2533 * 0.1 * UM * 0.999).lambda_c == 0.25e-3


def test_scaling_and_monotony():
    def face(value, factor=1.0, **known):
        band = ProfileFilter(0.8e-3 * factor, 2.5e-6 * factor)
        return Finish("Ra", value, process_named("lapped"), band, **known).surface()

    known = {"q_rolloff": 2e5, "q_high": 1e7}
    one, twice = face(0.2 * UM, **known), face(0.4 * UM, **known)
    assert twice.spectrum.rms_height == pytest.approx(2 * one.spectrum.rms_height)
    # all lengths ten times as long
    scaled = face(2 * UM, 10.0, q_rolloff=2e4, q_high=1e6)
    assert scaled.spectrum.rms_height == pytest.approx(10 * one.spectrum.rms_height)
    assert scaled.spectrum.rms_slope == pytest.approx(one.spectrum.rms_slope)
    # a shorter lambda_c takes height away, so that the same value stands for a rougher surface
    short = Finish("Ra", 0.2 * UM, process_named("ground"), ProfileFilter(0.25e-3, 2.5e-6)).surface()
    long = Finish(
        "Ra", 0.2 * UM, process_named("ground"), ProfileFilter(0.8e-3, 2.5e-6), q_low=short.across.q_low
    )
    assert short.spectrum.rms_height > long.surface().spectrum.rms_height


@pytest.mark.parametrize("name", PROCESSES)
@pytest.mark.parametrize("value", [0.02 * UM, 0.4 * UM, 6.3 * UM])
def test_all_ranges_can_be_made(name, value):
    for parameter in ("Ra", "Rq", "Rz"):
        finish = Finish(parameter, value, process_named(name))
        spreads = finish.spreads
        assert all(one.low <= one.usual <= one.high for one in spreads.values())
        for share in (0.0, 0.5, 1.0):
            face = finish.surface(dict.fromkeys(spreads, share))
            height = float(spreads["rms_height"].at(share)) if "rms_height" in spreads else 1.0
            assert face.expected.value(parameter) == pytest.approx(value * height)
            assert face.across.q_low <= face.q_rolloff <= face.across.q_high


@pytest.mark.parametrize("aspect", [1.2, 2.0, 5.0, 10.0])
def test_the_average_of_a_lay_is_that_of_all_its_nodes(aspect):
    face = Finish("Ra", 0.4 * UM, process_named("ground"), aspect=aspect).surface()
    root = math.sqrt(aspect)
    before = leak.PowerSpectrum(face.across.wavenumber / root, face.across.density * aspect)
    whole = leak.stretched_spectrum(before, aspect)
    assert face.spectrum.rms_height == pytest.approx(whole.rms_height)
    assert face.spectrum.rms_slope == pytest.approx(whole.rms_slope, rel=0.02)
    few, many = (
        leak.RoughContact(one, effective_modulus=115e9, peklenik=1 / aspect).effective_separation(30e6)
        for one in (face.spectrum, whole)
    )
    assert (few / many) ** 3 == pytest.approx(1.0, rel=0.01)


def test_a_turned_face_has_the_feed_of_its_value_and_its_tool():
    turned = process_named("turned")
    usual, known = (
        Finish("Ra", 0.4 * UM, turned, nose_radius=radius).surface().texture for radius in (None, 0.4e-3)
    )
    assert (usual.nose_radius, known.nose_radius) == pytest.approx((0.8e-3, 0.4e-3))
    assert usual.feed / known.feed == pytest.approx(math.sqrt(2.0))
    for texture in (usual, known):
        assert texture.feed**2 / (8 * texture.nose_radius) == pytest.approx(texture.crest_height)
        # without the filter lambda_s the fine roughness is a little higher
        assert texture.Ra == pytest.approx(0.4 * UM, rel=0.01)
        assert texture.fine.q_low == pytest.approx(math.pi / texture.feed)
    # twice as high on the drawing: everything twice as high, but for the filter
    higher = Finish("Ra", 0.8 * UM, turned).surface().texture
    assert higher.crest_height == pytest.approx(2 * usual.crest_height, rel=1e-3)
    assert higher.feed == pytest.approx(math.sqrt(2.0) * usual.feed, rel=1e-3)
    assert "nose_radius" not in Finish("Ra", 0.4 * UM, turned, nose_radius=0.4e-3).spreads


def test_tools_are_fed_by_half_of_their_nose_at_most():
    for value in (3.2 * UM, 25 * UM):
        finish = Finish("Ra", value, process_named("turned"))
        for share in (0.0, 0.5, 1.0):
            texture = finish.surface({"nose_radius": share}).texture
            assert texture.feed <= 0.5001 * min(texture.nose_radius, finish.band.lambda_c)
    with pytest.raises(leak.SpectrumError, match="lambda_c = 8e-05 m: cusps of this Ra"):
        Finish("Ra", 0.8 * UM, process_named("turned"), ProfileFilter(0.08e-3)).surface()


def test_roughness_of_cusps_that_vanish_is_that_of_the_fine_part():
    fine = leak.ExpectedRoughness(UM, 100.0, ProfileFilter(0.8e-3))
    flat, high = TurnedRoughness(1e-4 * UM, fine), TurnedRoughness(1e4 * UM, fine)
    for name in ("Ra", "Rq", "Rz"):
        assert flat.value(name) == pytest.approx(fine.value(name), rel=0.01)
    ratios = 4 / (9 * math.sqrt(3)), math.sqrt(4 / 45), 1.0
    for name, ratio in zip(("Ra", "Rq", "Rz"), ratios, strict=True):
        assert high.value(name) == pytest.approx(ratio * 1e4 * UM, rel=1e-3)


def test_parameters_of_a_sine():
    x = np.arange(20_000) * 0.5 * UM
    wave = leak.line_scan(x, 2 * UM * np.sin(2 * np.pi * x / (100 * UM)))
    found = roughness_parameters([wave], ProfileFilter(0.8e-3))
    assert found.Ra == pytest.approx(2 * 2 * UM / np.pi, rel=1e-4)
    assert found.Rq == pytest.approx(2 * UM / math.sqrt(2), rel=1e-4)
    assert found.Rz == pytest.approx(4 * UM, rel=1e-4)
    assert found.Rku == pytest.approx(1.5, rel=1e-4)
    assert found.Rsk == pytest.approx(0.0, abs=1e-6)
    # a wave as long as the cutoff keeps half of its height
    long = leak.line_scan(x, 2 * UM * np.sin(2 * np.pi * x / (800 * UM)))
    half = roughness_parameters([long], ProfileFilter(0.8e-3))
    assert half.Rq == pytest.approx(UM / math.sqrt(2), rel=0.01)


def test_the_cutoff_is_that_of_the_class_of_the_value():
    for height, lambda_c in ((0.01, 0.08), (0.1, 0.25), (1.0, 0.8), (8.0, 2.5)):
        x = np.arange(40_000) * UM
        wave = leak.line_scan(x, height * UM * np.sin(2 * np.pi * x / (20 * UM)))
        assert roughness_parameters([wave]).filter.lambda_c == lambda_c * 1e-3


def test_short_and_coarse_scans_say_what_is_missing():
    x = np.arange(1000) * UM
    wave = UM * np.sin(2 * np.pi * x / (50 * UM))
    short = roughness_parameters([leak.line_scan(x, wave)])
    assert short.sections == 0
    assert "too short for one section of 0.8 mm" in short.remarks[0]
    few = roughness_parameters([leak.line_scan(np.arange(3000) * UM, UM * np.sin(np.arange(3000) / 8))])
    assert few.sections == 2
    assert "2 of the 5 sections" in few.remarks[0]
    coarse = roughness_parameters(
        [leak.line_scan(np.arange(3000) * 4 * UM, UM * np.sin(np.arange(3000) / 3))]
    )
    assert coarse.filter.lambda_s == 0.0
    assert "too far for the filter lambda_s" in coarse.remarks[0]


def test_profiles_of_a_map_are_those_across_its_lay():
    x = np.arange(4000) * UM
    heights = np.repeat(UM * np.sin(2 * np.pi * x / (100 * UM))[:, None], 32, axis=1)
    for turned in (heights, heights.T):
        found = roughness_parameters([leak.height_map(turned, (UM, UM))], ProfileFilter(0.8e-3))
        assert found.Ra == pytest.approx(2 * UM / np.pi, rel=1e-3)
        assert found.profiles == 32


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: process_named("laped"), "must be one of lapped, polished"),
        (lambda: Finish("Ra", -1.0, process_named("lapped")), "Ra = -1.0: must be a positive"),
        (lambda: ProfileFilter(1e-6, 2e-6), "must be shorter than lambda_c"),
        (lambda: roughness_parameters([]), "no scan"),
    ],
)
def test_errors_name_what_is_wrong(make, says):
    with pytest.raises(leak.LeakError, match=says):
        make()


def test_expected_roughness_of_a_wide_band_is_the_surface():
    surface = leak.PowerSpectrum.self_affine(rms_height=UM, hurst=0.6, q_low=1e4, q_rolloff=5e4, q_high=3e6)
    assert expected_roughness(surface, ProfileFilter(10.0)).Rq == pytest.approx(UM, rel=1e-3)
