"""From scans to spectra: conventions, surfaces of known spectrum, reliable range, continuation."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import leak
from leak.surfaces.periodogram import periodogram

SANDBLASTED = {"rms_height": 1.9e-6, "q_low": 1e3, "q_rolloff": 3e4, "q_high": 3e6}
LENGTH, POINTS = 0.0125, 12_500


def spectrum(hurst=0.8, **changes):
    return leak.PowerSpectrum.self_affine(hurst=hurst, **{**SANDBLASTED, **changes})


def scans(true, count, first_seed=0):
    pairs = [
        leak.random_line_scan(true, length=LENGTH, points=POINTS, seed=first_seed + k) for k in range(count)
    ]
    return [leak.line_scan(x, h) for x, h in pairs]


def noisy_scan(seed=3, points=2000, spacing=1e-6):
    return spacing * np.arange(points), 1e-6 * np.random.default_rng(seed).standard_normal(points)


# --- conventions: factors of 2 and pi -----------------------------------------------------------------------


@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_profile_density_is_the_abel_transform_with_the_variance_of_the_surface(hurst):
    true = spectrum(hurst)
    q = np.geomspace(1.0, 2.99e6, 5_000)
    one_sided = np.trapezoid(leak.profile_density(true, q), q) + leak.profile_density(true, 1.0) * 1.0
    # both signs of q; trapezoids on 5 000 points and the pieces of constant C are good to 2e-4
    assert 2 * one_sided == pytest.approx(true.rms_height**2, rel=1e-3)
    # the profile slope of an isotropic surface is the full one over sqrt(2)
    slope = 2 * np.trapezoid(q**2 * leak.profile_density(true, q), q)
    assert slope == pytest.approx(true.rms_slope**2 / 2, rel=3e-3)


def test_profile_density_agrees_with_quadrature():
    true, q = spectrum(), 2e4
    # substitution k^2 = q^2 + t^2 takes the singularity away; stop at the roll-off and at the end
    stops = np.sqrt(np.array([3e4, 1e5, 1e6, 3e6]) ** 2 - q**2)
    parts = [
        quad(lambda t: 2 * true(np.hypot(q, t)), a, b, epsabs=0, epsrel=1e-8, limit=200)[0]
        for a, b in zip([0, *stops[:-1]], stops, strict=True)
    ]
    assert leak.profile_density(true, q) == pytest.approx(sum(parts), rel=2e-4)


def test_profile_density_of_a_power_law_in_closed_form():
    # C = q^-n over many decades: C_1D = q^(1-n) sqrt(pi) Gamma((n-1)/2)/Gamma(n/2)
    from scipy.special import gamma

    n = 3.6
    power_law = leak.PowerSpectrum([1.0, 1e6], [1.0, 1e6**-n])
    closed = 10.0 ** (1 - n) * np.sqrt(np.pi) * gamma((n - 1) / 2) / gamma(n / 2)
    assert leak.profile_density(power_law, 10.0) == pytest.approx(closed, rel=5e-4)


def test_one_wave_shows_its_variance_in_the_periodogram():
    x = 1e-6 * np.arange(1000)
    h = 2e-6 * np.cos(2 * np.pi * x / 1e-4)
    for window in ("none", "hann"):
        modes = periodogram(leak.line_scan(x, h), window)
        assert modes.shares.sum() == pytest.approx(0.5 * 2e-6**2, rel=1e-12)
        assert modes.wavenumber[np.argmax(modes.power)] == pytest.approx(2 * np.pi / 1e-4, rel=1e-12)


def test_waves_of_a_map_show_their_variance_and_direction():
    x, y = np.meshgrid(1e-6 * np.arange(120), 2e-6 * np.arange(90), indexing="ij")
    h = 3e-6 * np.cos(2 * np.pi * (3 * x / 120e-6 - 5 * y / 180e-6))
    modes = periodogram(leak.height_map(h, (1e-6, 2e-6)), "none")
    strongest = modes.vector[np.argmax(modes.power)]
    assert modes.shares.sum() == pytest.approx(0.5 * 3e-6**2, rel=1e-12)
    assert np.abs(strongest) == pytest.approx([2 * np.pi * 3 / 120e-6, 2 * np.pi * 5 / 180e-6])


# --- surfaces of known spectrum -----------------------------------------------------------------------------


@pytest.mark.parametrize("hurst", [0.3, 0.6, 0.8])
def test_line_scans_give_the_spectrum_back_within_its_error(hurst):
    true = spectrum(hurst)
    surface = leak.measure(scans(true, 16))
    q = surface.measured.wavenumber
    # waves that the surface has, with their neighbours: a corner in C is rounded over one node to each side
    known = (q > 1.3e3) & (q < 2.9e6)
    off = np.log(surface.measured.density[known] / true(q[known]))
    score = off / surface.log_error[known]
    assert np.sqrt(np.mean(score**2)) < 1.5
    assert np.max(np.abs(score)) < 4.0
    # 16 scans of 60 roll-off wavelengths: 1000 waves, so the variance scatters by some 3 %
    assert surface.spectrum.rms_height == pytest.approx(1.9e-6, rel=0.03)
    assert surface.spectrum.rms_slope == pytest.approx(true.rms_slope, rel=0.05)
    assert surface.rolloff.hurst == pytest.approx(hurst, abs=0.04)
    # one node to each side
    assert surface.rolloff.wavenumber == pytest.approx(3e4, rel=0.3)


@pytest.mark.slow
def test_the_error_of_single_scans_is_what_it_says():
    true = spectrum()
    scores, deviations = [], []
    for scan in scans(true, 12, first_seed=100):
        surface = leak.measure(scan)
        q = surface.measured.wavenumber
        known = (q > 1.3e3) & (q < 2.9e6)
        off = np.log(surface.measured.density[known] / true(q[known]))
        scores.append(off / surface.log_error[known])
        deviations.append(off)
    assert 0.4 < np.sqrt(np.mean(np.square(scores))) < 1.5
    # above the roll-off: no systematic error beyond 10 %
    assert np.abs(np.mean(deviations, axis=0)[q[known] > 6e4]).max() < 0.1


@pytest.mark.parametrize("hurst", [0.5, 0.8])
def test_maps_give_the_spectrum_back(hurst):
    true = spectrum(hurst, q_low=1e4, q_rolloff=6e4, q_high=1e6)
    whole = [leak.random_map(true, size=2e-3, points=1024, seed=seed) for seed in (0, 1)]
    surface = leak.measure([leak.height_map(one[:512, :512], (2e-3 / 1024,) * 2) for one in whole])
    q = surface.measured.wavenumber
    known = (q > 2e4) & (q < 0.99e6)
    off = np.log(surface.measured.density[known] / true(q[known]))
    assert np.sqrt(np.mean((off / surface.log_error[known]) ** 2)) < 1.5
    # two maps of ten roll-off wavelengths squared: the variance scatters by about 7 %
    assert surface.rms_height == pytest.approx(1.9e-6, rel=0.1)
    assert surface.rolloff.hurst == pytest.approx(hurst, abs=0.06)
    assert surface.anisotropy < 1.25
    assert not [remark for remark in surface.warnings if "anisotropic" in remark]


@pytest.mark.slow
def test_line_scans_and_the_map_they_are_taken_from_agree():
    true = spectrum(0.8, q_low=1e4, q_rolloff=6e4, q_high=1e6)
    heights = leak.random_map(true, size=2e-3, points=1024, seed=5)
    step = 2e-3 / 1024
    area = leak.measure(leak.height_map(heights, (step, step)), leak.ScanSettings(window="none"))
    rows = [leak.line_scan(step * np.arange(1024), row) for row in heights[::32]]
    lines = leak.measure(rows, leak.ScanSettings(window="none", detrend="mean"))
    q = np.geomspace(1.2e5, 8e5, 20)
    assert np.log(lines.measured(q) / area.measured(q)) == pytest.approx(np.zeros(20), abs=0.25)
    assert lines.spectrum.rms_slope == pytest.approx(area.spectrum.rms_slope, rel=0.05)


@pytest.mark.slow
def test_the_generator_makes_surfaces_of_the_spectrum_it_is_given():
    true = spectrum(0.8, q_low=1e4, q_rolloff=6e4, q_high=1e6)
    maps = [leak.random_map(true, size=2e-3, points=1024, seed=seed) for seed in range(8)]
    assert np.sqrt(np.mean(np.square(maps))) == pytest.approx(true.rms_height, rel=0.02)
    step = 2e-3 / 1024
    slope = np.mean([np.mean(np.square(np.gradient(one, step)), axis=(1, 2)).sum() for one in maps])
    # central differences see less of the shortest waves: sin(q_x d)/(q_x d) squared, averaged over directions
    q, angle = np.geomspace(1e4, 1e6, 4000), np.linspace(0, np.pi, 181)[:-1]
    filtered = 2 * np.cos(angle) ** 2 * np.sinc(np.multiply.outer(q * step / np.pi, np.cos(angle))) ** 2
    weight = q**3 * true(q)
    seen = np.trapezoid(weight * filtered.mean(axis=1), q) / np.trapezoid(weight, q)
    assert slope / true.rms_slope**2 == pytest.approx(seen, rel=0.05)
    assert np.array_equal(maps[3], leak.random_map(true, size=2e-3, points=1024, seed=3))


def test_the_generator_stretches_along_x():
    true = spectrum(0.8, q_low=1e4, q_rolloff=6e4, q_high=1e6)
    heights = leak.random_map(true, size=4e-3, points=1024, seed=1, peklenik=3.0)
    surface = leak.measure(leak.height_map(heights, (4e-3 / 1024,) * 2))
    # 1000 waves: the ratio scatters by 0.2
    assert surface.anisotropy == pytest.approx(3.0, rel=0.2)
    assert min(surface.lay_angle, np.pi - surface.lay_angle) < np.radians(5)
    said = next(remark for remark in surface.warnings if "anisotropic" in remark)
    across, along = surface.peklenik
    assert (across, along) == pytest.approx((1 / surface.anisotropy, surface.anisotropy))
    assert f"{across:.2g} where the fluid flows across it" in said
    assert f"{along:.2g} where it flows along it" in said


# --- the variance is that of the scan -------------------------------------------------------------------------


@pytest.mark.parametrize("detrend", ["mean", "tilt", "curvature"])
@pytest.mark.parametrize("window", ["hann", "none"])
def test_variance_is_kept_by_every_setting(detrend, window):
    x, h = leak.random_line_scan(spectrum(), length=LENGTH, points=POINTS, seed=7)
    h = h + 2e-4 * x + 0.02 * x**2
    degree = ["mean", "tilt", "curvature"].index(detrend)
    alone = h - np.polynomial.Polynomial.fit(x, h, degree)(x)
    found = leak.PowerSpectrum.from_profile(x, h, detrend=detrend, window=window)
    assert found.rms_height == pytest.approx(np.std(alone), rel=1e-4)


def test_variance_of_several_scans_is_their_mean():
    several = scans(spectrum(), 3)
    surface = leak.measure(several)
    flat = [scan.without_form("tilt").heights for scan in several]
    assert surface.spectrum.rms_height**2 == pytest.approx(np.mean(np.square(flat)), rel=1e-6)
    assert surface.scan_rms_heights == pytest.approx([one.std() for one in flat])


@settings(max_examples=40, deadline=None)
@given(
    st.integers(16, 400),
    st.integers(0, 2**32 - 1),
    st.sampled_from(["white", "walk", "wave", "spike", "step"]),
    st.floats(1e-12, 1e-3),
    st.floats(1e-9, 1e-2),
)
@example(points=17, seed=0, kind="wave", height=1e-3, spacing=0.0078125)
def test_variance_is_kept_for_any_heights(points, seed, kind, height, spacing):
    random = np.random.default_rng(seed)
    h = {
        "white": random.standard_normal(points),
        "walk": np.cumsum(random.standard_normal(points)),
        "wave": np.sin(0.7 * np.arange(points)) + 1e-3 * random.standard_normal(points),
        "spike": 1.0 * (np.arange(points) == points // 3),
        "step": 1.0 * (np.arange(points) > points // 3),
    }[kind]
    x = spacing * np.arange(points)
    alone = h - np.polynomial.Polynomial.fit(x, h, 1)(x)
    try:
        surface = leak.measure(leak.line_scan(x, height * h))
    except leak.ScanError as refused:
        # little but the wave itself, of which fewer than four to six fit in the scan: less than two octaves
        assert kind == "wave" and points < 6 * 2 * np.pi / 0.7
        assert "no shorter waves in the data" in str(refused)
        return
    inside = 1.0 - surface.height_above
    assert surface.spectrum.rms_height**2 == pytest.approx(inside * np.var(height * alone), rel=1e-6)
    assert np.all(np.isfinite(surface.log_error))


def test_lengths_scale():
    x, h = leak.random_line_scan(spectrum(), length=LENGTH, points=2000, seed=2)
    one, larger = (leak.PowerSpectrum.from_profile(k * x, k * h) for k in (1.0, 1000.0))
    assert larger.wavenumber == pytest.approx(one.wavenumber / 1000, rel=1e-9)
    assert larger.density == pytest.approx(one.density * 1000.0**4, rel=1e-6)


def test_direction_of_the_scan_and_sign_of_the_height_do_not_matter():
    x, h = leak.random_line_scan(spectrum(), length=LENGTH, points=2000, seed=2)
    one = leak.PowerSpectrum.from_profile(x, h)
    for other in (
        leak.PowerSpectrum.from_profile(x[::-1], h[::-1]),
        leak.PowerSpectrum.from_profile(x, -h),
        leak.PowerSpectrum.from_profile(x + 5.0, h + 1.0),
    ):
        assert other.density == pytest.approx(one.density, rel=1e-5)


# --- reliable range and what lies outside ---------------------------------------------------------------------


def test_range_begins_at_the_length_and_ends_at_two_points():
    x, h = noisy_scan()
    surface = leak.measure(leak.line_scan(x, h))
    assert (surface.q_low, surface.q_high) == pytest.approx((2 * np.pi / 2e-3, np.pi / 1e-6))
    assert surface.limit == "sampling"
    assert (surface.spectrum.q_low, surface.spectrum.q_high) == (surface.q_low, surface.q_high)


def test_range_ends_at_the_resolution_of_the_instrument():
    x, h = noisy_scan()
    surface = leak.measure(leak.line_scan(x, h), leak.ScanSettings(shortest_wavelength=5e-6))
    assert surface.q_high == pytest.approx(2 * np.pi / 5e-6)
    assert surface.limit == "shortest wavelength"
    # white noise: 3/5 of its variance has waves shorter than 5 of up to 2 points
    assert surface.height_above == pytest.approx(0.6, abs=0.03)
    assert surface.spectrum.rms_height**2 == pytest.approx(
        (1 - surface.height_above) * surface.rms_height**2, rel=1e-6
    )
    assert any("cut" in remark for remark in surface.warnings)


def test_tip_radius_limits_where_the_profile_bends_like_the_tip():
    true = spectrum()
    scan = scans(true, 1)[0]
    radius = 10e-6
    surface = leak.measure(scan, leak.ScanSettings(tip_radius=radius))
    # rms curvature of the profile, (2 int q^4 C_1D dq)^(1/2), by quadrature
    q = np.geomspace(1e2, 2.9e6, 4000)
    density = q**4 * leak.profile_density(true, q)
    bending = np.sqrt(2 * np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(q))]))
    expected = np.interp(0.5 / radius, bending, q)
    assert surface.limit == "tip radius"
    # a spectrum cut there leaks less than the surface; said, with the continuation as it may be copied
    said = next(one for one in surface.warnings if one.startswith("the spectrum ends at a wavelength of"))
    assert "(tip radius)" in said and "too low, which is the unsafe side" in said
    offered = f'extrapolation = "self-affine" with hurst = {surface.rolloff.hurst:.2g} and q_high = "'
    assert offered in said
    q_high = float(said.split(offered)[1].split(" 1/m")[0])
    continued = leak.measure(
        scan,
        leak.ScanSettings(tip_radius=radius, extrapolation=leak.SelfAffineContinuation(0.8, q_high=q_high)),
    )
    assert not any("unsafe" in one for one in continued.warnings)
    whole, cut, again = (
        float(leak.RoughContact(one.spectrum, effective_modulus=115e9).effective_separation(50e6)) ** 3
        for one in (leak.measure(scan), surface, continued)
    )
    assert cut < 0.95 * whole
    assert again == pytest.approx(whole, rel=0.02)
    # one scan: the bending scatters by some per cent, the wavenumber by less
    assert surface.q_high == pytest.approx(expected, rel=0.1)


def test_continuation_is_the_power_law_asked_for():
    x, h = noisy_scan()
    cut = leak.PowerSpectrum.from_profile(x, h)
    how = leak.SelfAffineContinuation(0.7, q_low=1e2, q_high=1e9)
    more = leak.PowerSpectrum.from_profile(x, h, extrapolation=how)
    assert (more.q_low, more.q_high) == (1e2, 1e9)
    q = np.sqrt(cut.q_low * cut.q_high)
    assert more(q) == pytest.approx(cut(q), rel=1e-12)
    for here, end in ((5e8, cut.q_high), (5e2, cut.q_low)):
        assert more(here) / cut(end) == pytest.approx((here / end) ** -3.4, rel=1e-9)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"hurst": 1.5, "q_high": 1e9}, "hurst"),
        ({"hurst": 0.8}, "q_low and q_high"),
        ({"hurst": 0.8, "q_high": -1.0}, "q_high"),
    ],
)
def test_wrong_continuations_are_refused(wrong, named):
    with pytest.raises(leak.ScanError, match=named):
        leak.SelfAffineContinuation(**wrong)


def test_a_continuation_that_does_not_continue_is_refused():
    x, h = noisy_scan()
    with pytest.raises(leak.ScanError, match="must be above the reliable range"):
        leak.PowerSpectrum.from_profile(x, h, extrapolation=leak.SelfAffineContinuation(0.8, q_high=1e5))
    with pytest.raises(leak.ScanError, match="must be below the reliable range"):
        leak.PowerSpectrum.from_profile(x, h, extrapolation=leak.SelfAffineContinuation(0.8, q_low=1e5))


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"detrend": "parabola"}, "detrend = 'parabola': must be \"mean\""),
        ({"window": "hanning"}, "window"),
        ({"tip_radius": 0.0}, "tip_radius"),
        ({"shortest_wavelength": float("nan")}, "shortest_wavelength"),
        ({"extrapolation": "self-affine"}, "extrapolation"),
    ],
)
def test_wrong_settings_are_refused(wrong, named):
    with pytest.raises(leak.ScanError, match=named):
        leak.ScanSettings(**wrong)


# --- heights ----------------------------------------------------------------------------------------------------


def test_rounded_positions_are_taken_as_even():
    x, h = noisy_scan(spacing=0.156e-6)
    scan = leak.line_scan(np.round(x, 7), h)
    assert np.array_equal(scan.heights, h)
    assert scan.spacing == pytest.approx(0.156e-6, rel=1e-3)
    assert scan.remarks == ()


def test_uneven_positions_are_interpolated_and_said():
    true = spectrum(0.8, q_high=3e5)
    x, h = leak.random_line_scan(true, length=LENGTH, points=POINTS, seed=1)
    kept = np.sort(np.random.default_rng(0).choice(POINTS, POINTS - 400, replace=False))
    scan = leak.line_scan(x[kept], h[kept])
    assert "interpolated" in scan.remarks[0]
    assert scan.spacing == pytest.approx(1e-6, rel=1e-3)
    q = np.geomspace(1e4, 2e5, 10)
    whole, part = leak.PowerSpectrum.from_profile(x, h), leak.measure(scan).measured
    # a straight line over one missing point of waves longer than 20 points
    assert np.log(part(q) / whole(q)) == pytest.approx(np.zeros(10), abs=0.05)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda x, h: (x[:1], h[:1]), "a scan of 1 point: needs"),
        (lambda x, h: (x[:0], h[:0]), "a scan of 0 points"),
        (lambda x, h: (x, h[:-1]), "shape"),
        (lambda x, h: (np.where(x == x[7], np.nan, x), h), r"x\[7\] = nan"),
        (lambda x, h: (x, np.where(x == x[9], np.inf, h)), r"h\[9\] = inf"),
        (lambda x, h: (np.where(x == x[50], x[48], x), h), "not monotonic"),
        (lambda x, h: (np.zeros_like(x), h), "not monotonic"),
        (lambda x, h: (x, np.ones_like(h)), "no roughness"),
        (lambda x, h: (x, 3e-3 * x + 1.0), "no roughness"),
        (lambda x, h: (np.where(x > x[1000], x + 1.0, x), h), "gap"),
        (lambda x, h: (["a"], ["b"]), "arrays of numbers"),
        (lambda x, h: (x[:, None], h[:, None]), "one dimension"),
    ],
)
def test_scans_that_are_none_are_refused(change, message):
    with pytest.raises(leak.ScanError, match=message):
        leak.PowerSpectrum.from_profile(*change(*noisy_scan()))


@pytest.mark.parametrize(
    ("heights", "spacing", "message"),
    [
        (np.zeros((20, 20)), (1e-6, 1e-6), "no roughness"),
        (np.zeros(20), (1e-6, 1e-6), "shape"),
        (np.zeros((20, 3)), (1e-6, 1e-6), "shape"),
        (np.eye(20), (0.0, 1e-6), "spacing"),
        (np.where(np.eye(20) + np.eye(20)[::-1], np.nan, np.arange(20.0)), (1e-6, 1e-6), "missing"),
    ],
)
def test_maps_that_are_none_are_refused(heights, spacing, message):
    with pytest.raises(leak.ScanError, match=message):
        leak.measure(leak.height_map(heights, spacing))


def test_a_few_missing_points_of_a_map_are_filled_and_said():
    true = spectrum(0.8, q_low=1e4, q_rolloff=6e4, q_high=3e5)
    heights = leak.random_map(true, size=2e-3, points=512, seed=1)
    holes = heights.copy()
    holes[np.random.default_rng(0).random(heights.shape) < 0.01] = np.nan
    one, other = (leak.measure(leak.height_map(h, (2e-3 / 512,) * 2)) for h in (heights, holes))
    assert other.rms_height == pytest.approx(one.rms_height, rel=2e-3)
    assert any("missing" in remark for remark in other.warnings)


def test_moments_of_the_heights():
    x, h = noisy_scan(points=20_000)
    surface = leak.measure(leak.line_scan(x, h))
    # standard errors sqrt(6/n) and sqrt(24/n)
    assert surface.skewness == pytest.approx(0.0, abs=4 * np.sqrt(6 / 20_000))
    assert surface.kurtosis == pytest.approx(3.0, abs=4 * np.sqrt(24 / 20_000))
    skewed = leak.measure(leak.line_scan(x, np.exp(1e6 * h)))
    assert skewed.skewness > 2
    assert any(remark.startswith("far from Gaussian") for remark in skewed.warnings)


def test_form_left_in_a_scan_is_said():
    x, h = leak.random_line_scan(spectrum(), length=LENGTH, points=POINTS, seed=1)
    surface = leak.measure(leak.line_scan(x, h - x**2 / (2 * 0.5)))
    assert any('use detrend = "curvature"' in remark for remark in surface.warnings)
    clean = leak.measure(leak.line_scan(x, h - x**2 / (2 * 0.5)), leak.ScanSettings(detrend="curvature"))
    alone = h - np.polynomial.Polynomial.fit(x, h, 2)(x)
    assert clean.rms_height == pytest.approx(np.std(alone), rel=1e-6)
    assert clean.warnings == ()


def test_a_turned_surface_is_said():
    x, h = noisy_scan()
    surface = leak.measure(leak.line_scan(x, 0.3 * h + 2e-6 * np.sin(2 * np.pi * x / 1e-4)))
    assert any("one wave of 100 um" in remark for remark in surface.warnings)


def test_nothing_reliable_is_said():
    x, h = noisy_scan()
    with pytest.raises(leak.ScanError, match="nothing reliable"):
        leak.PowerSpectrum.from_profile(x, h, shortest_wavelength=1e-3)
    with pytest.raises(leak.ScanError, match="no scan"):
        leak.measure([])


def test_two_surfaces_add():
    seat, ball = (leak.measure(scan).spectrum for scan in scans(spectrum(), 2))
    both = seat + ball
    assert both.rms_height**2 == pytest.approx(seat.rms_height**2 + ball.rms_height**2, rel=1e-4)
    assert both.rms_slope**2 == pytest.approx(seat.rms_slope**2 + ball.rms_slope**2, rel=1e-4)
