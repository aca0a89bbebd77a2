"""Properties that hold for every surface, pressure and profile: scaling, monotony, balances, symmetries.

Tolerances: what is the same arithmetic on scaled numbers agrees to 1e-9 (bisections and interpolations end at
slightly different places); quadratures of this theory are good to some 1e-5 each.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import HARDNESS, surface

import leak
from leak.theory.line_contact import crossover_line, gaussian_line

QUICK = settings(max_examples=12, deadline=None)
MANY = settings(max_examples=60, deadline=None)


@st.composite
def spectra(draw) -> leak.PowerSpectrum:
    """Self-affine spectra with rms slopes between 0.01 and 1 over one to four decades."""
    q_low = 10 ** draw(st.floats(2, 5))
    rolloff = q_low * 10 ** draw(st.floats(0, 1.5))
    q_high = rolloff * 10 ** draw(st.floats(0.7, 2.5))
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1e-6,
        hurst=draw(st.floats(0.3, 1.0)),
        q_low=q_low,
        q_rolloff=rolloff,
        q_high=q_high,
    )
    slope = 10 ** draw(st.floats(-2, 0))
    return leak.PowerSpectrum(spectrum.wavenumber, spectrum.density * (slope / spectrum.rms_slope) ** 2)


@st.composite
def surfaces(draw, plastic: bool | None = None) -> leak.RoughContact:
    """Rough contacts, elastic or with a hardness of 0.05 to 1 of E* h'."""
    spectrum = draw(spectra())
    E = 10 ** draw(st.floats(8, 12))
    hardness = None
    if plastic or (plastic is None and draw(st.booleans())):
        hardness = E * spectrum.rms_slope * 10 ** draw(st.floats(-1.3, 0))
    width = draw(st.sampled_from(["effective", "plain"]))
    return leak.RoughContact(spectrum, effective_modulus=E, hardness=hardness, separation_width=width)


# pressure over E* h' of a contact that leaks
loads = st.floats(-5, -1.3).map(lambda exponent: 10**exponent)
factors = st.floats(-3, 3).map(lambda exponent: 10**exponent)


def pressure(surface: leak.RoughContact, load: float) -> float:
    """Pressure of a relative load, kept well below the hardness."""
    p = load * surface.effective_modulus * surface.spectrum.rms_slope
    return p if surface.hardness is None else min(p, 0.3 * surface.hardness)


def everything(surface: leak.RoughContact, p: float) -> dict[str, float]:
    """All numbers that a pressure gives: areas [-] and lengths [m]."""
    q = np.sqrt(surface.spectrum.q_low * surface.spectrum.q_high)
    return {
        "contact_area": float(surface.contact_area(p)),
        "plastic_area": float(surface.plastic_area(p, q)),
        "mean_separation": float(surface.mean_separation(p)),
        "critical_separation": float(surface.critical_separation(p)),
        "effective_separation": float(surface.effective_separation(p)),
    }


LENGTHS = ("mean_separation", "critical_separation", "effective_separation")


def assert_scaled(
    found: dict[str, float], expected: dict[str, float], length: float, area: float = 1.0
) -> None:
    for name, value in expected.items():
        scale = length if name in LENGTHS else area
        # separations near sealing are differences of larger ones
        assert found[name] == pytest.approx(scale * value, rel=1e-7, abs=1e-14 * scale), name


# -------------------------------------------------------------------- scaling


@QUICK
@given(surface=surfaces(), load=loads, factor=factors)
def test_only_pressures_over_the_modulus_count(surface, load, factor):
    p = pressure(surface, load)
    stiffer = replace(
        surface,
        effective_modulus=factor * surface.effective_modulus,
        hardness=None if surface.hardness is None else factor * surface.hardness,
    )
    assert_scaled(everything(stiffer, factor * p), everything(surface, p), 1.0)
    assert stiffer.u0 == pytest.approx(surface.u0, rel=1e-12)
    assert stiffer.p_c == pytest.approx(factor * surface.p_c, rel=1e-12)
    # the hardness enters by bisection
    assert stiffer.sealing_pressure == pytest.approx(factor * surface.sealing_pressure, rel=1e-9)


@QUICK
@given(surface=surfaces(), load=loads, factor=factors)
def test_separations_scale_with_all_lengths(surface, load, factor):
    """x and h times a factor: q over it, C = <h^2> per q^2 times its fourth power; slopes and pressures stay."""
    p = pressure(surface, load)
    spectrum = surface.spectrum
    larger = replace(
        surface,
        spectrum=leak.PowerSpectrum(spectrum.wavenumber / factor, spectrum.density * factor**4),
    )
    assert larger.spectrum.rms_slope == pytest.approx(spectrum.rms_slope, rel=1e-12)
    assert larger.spectrum.rms_height == pytest.approx(factor * spectrum.rms_height, rel=1e-12)
    assert_scaled(everything(larger, p), everything(surface, p), factor)


@QUICK
@given(surface=surfaces(), load=loads, factor=st.floats(0.2, 5))
def test_heights_scale_like_the_modulus(surface, load, factor):
    """Only E* h counts: heights times a factor do the same as E* times it, but that separations grow with them."""
    p = pressure(surface, load)
    higher = replace(
        surface,
        spectrum=leak.PowerSpectrum(surface.spectrum.wavenumber, surface.spectrum.density * factor**2),
    )
    stiffer = replace(surface, effective_modulus=factor * surface.effective_modulus)
    assert_scaled(everything(higher, p), everything(stiffer, p), factor)


# -------------------------------------------------------------------- monotony and limits


@QUICK
@given(surface=surfaces(), load=loads, more=st.floats(1.05, 3))
def test_more_pressure_closes_the_gap(surface, load, more):
    p = pressure(surface, load)
    before, after = everything(surface, p), everything(surface, more * p)
    assert after["contact_area"] > before["contact_area"]
    for name in LENGTHS:
        # sealed stays sealed
        assert after[name] < before[name] or after[name] == before[name] == 0.0, name


@QUICK
@given(surface=surfaces(plastic=True), load=loads)
def test_yielding_closes_the_gap(surface, load):
    p = pressure(surface, load)
    plastic, elastic = everything(surface, p), everything(surface.elastic, p)
    for name in LENGTHS:
        # where hardly anything yields the two are the same within the quadrature
        assert plastic[name] <= elastic[name] * (1 + 1e-4), name


@QUICK
@given(surface=surfaces(plastic=False), load=loads)
def test_a_very_hard_surface_is_elastic(surface, load):
    p = pressure(surface, load)
    hard = replace(surface, hardness=1e4 * surface.effective_modulus * surface.spectrum.rms_slope)
    for name, value in everything(surface, p).items():
        if name != "plastic_area":
            # two quadratures of the same integrals
            assert everything(hard, p)[name] == pytest.approx(value, rel=1e-3, abs=1e-12), name


@QUICK
@given(surface=surfaces(), load=loads, threshold=st.floats(0.2, 0.7))
def test_a_higher_threshold_lets_more_through(surface, load, threshold):
    p = pressure(surface, load)
    low, high = (replace(surface, percolation_threshold=value) for value in (threshold, threshold + 0.1))
    for name in ("critical_separation", "effective_separation"):
        assert everything(high, p)[name] >= everything(low, p)[name]
    assert high.sealing_pressure > low.sealing_pressure


# -------------------------------------------------------------------- balances


@MANY
@given(s=st.floats(0, 1), log_t=st.floats(-12, 3))
def test_area_splits_into_elastic_plastic_and_open(s, log_t):
    parts = leak.area_fractions(s, 10**log_t)
    assert float(sum(parts)) == pytest.approx(1.0, abs=1e-14)
    # each is a sum of terms of size one
    assert min(float(part) for part in parts) >= -1e-15


@MANY
@given(surface=surfaces(plastic=True), load=loads, share=st.floats(0, 1))
def test_contact_area_is_elastic_and_plastic_area(surface, load, share):
    p = pressure(surface, load)
    spectrum = surface.spectrum
    q = spectrum.q_low ** (1 - share) * spectrum.q_high**share
    parts = float(surface.elastic_area(p, q)) + float(surface.plastic_area(p, q))
    assert parts == pytest.approx(float(surface.contact_area(p, q)), rel=1e-12)
    assert 0 <= float(surface.plastic_area(p, q)) <= p / surface.hardness * (1 + 1e-12)
    assert parts <= 1 + 1e-12


@QUICK
@given(surface=surfaces(plastic=False), load=loads)
def test_separations_and_contact_fill_the_whole_area(surface, load):
    p = pressure(surface, load)
    u, density = surface.separation_distribution(p)
    # trapezoidal rule on 1024 points in ln u, and the little below the smallest of them
    open_area = np.trapezoid(density * u, np.log(u)) + density[0] * u[0]
    missing = 1.0 - open_area - float(surface.contact_area(p))
    # With the effective width some area has a separation that vanishes like exp(-1/(q1 - q)) toward the end of the
    # spectrum: below any grid, as good as contact.
    below_the_grid = 2e-3 if surface.separation_width == "effective" else 0.0
    assert -2e-4 < missing < 2e-4 + below_the_grid
    assert density.min() >= 0


@QUICK
@given(surface=surfaces(), load=loads)
def test_pressure_and_mean_separation_are_inverse(surface, load):
    p = pressure(surface, load)
    u = float(surface.mean_separation(p))
    # a table of the law, interpolated
    assert float(surface.pressure(u)) == pytest.approx(p, rel=1e-3)


@QUICK
@given(surface=surfaces(), load=loads)
def test_effective_medium_is_between_nothing_and_the_widest_gap(surface, load):
    p = pressure(surface, load)
    widest = float(surface.mean_separation(p)) + 8 * surface.spectrum.rms_height
    assert 0 <= float(surface.effective_separation(p)) < widest


# -------------------------------------------------------------------- spectra


@MANY
@given(a=spectra(), b=spectra(), share=st.floats(0, 1))
def test_spectra_add_in_any_order(a, b, share):
    low, high = min(a.q_low, b.q_low), max(a.q_high, b.q_high)
    q = low ** (1 - share) * high**share
    assert (a + b)(q) == pytest.approx((b + a)(q), rel=1e-9)
    for moment in (1, 2, 3):
        total = a.moment(moment) + b.moment(moment)
        # the sum of two power laws is log-log linear only between close points
        assert (a + b).moment(moment) == pytest.approx(total, rel=2e-3)
        assert (b + a).moment(moment) == pytest.approx((a + b).moment(moment), rel=1e-9)


@MANY
@given(spectrum=spectra(), share=st.floats(0, 1))
def test_moments_of_two_ranges_add(spectrum, share):
    q = spectrum.q_low ** (1 - share) * spectrum.q_high**share
    for order in (1, 3):
        parts = spectrum.moment(order, q_to=q) + spectrum.moment(order, q_from=q)
        assert parts == pytest.approx(spectrum.moment(order), rel=1e-12)
    assert spectrum.height_variance_above(spectrum.q_low) == pytest.approx(spectrum.rms_height**2, rel=1e-12)


# -------------------------------------------------------------------- leak rate

TABLE = surface(hardness=HARDNESS).conductivity_table(1e2, 1e9)


@st.composite
def profiles(draw) -> tuple[np.ndarray, np.ndarray]:
    """Lopsided pressure profiles with one or two peaks, falling outward at both ends."""
    s, peak = 10 ** draw(st.floats(-5, -3)), 10 ** draw(st.floats(5, 8.5))
    x = np.linspace(-5, 5, 121)
    second, at = draw(st.floats(0, 0.9)), draw(st.floats(-1.5, 1.5))
    stretch = np.where(x > 0, draw(st.floats(0.6, 1.6)), 1.0)
    p = np.exp(-((x * stretch) ** 2) / 2) + second * np.exp(-((x - at) ** 2))
    return s * x, peak * p / p.max()


def rate(x, p, viscosity=1e-3, drop=1e5, radius=0.014, **settings):
    return leak.leak_flow(x, p, TABLE.at(viscosity), drop, radius, **settings).leak_rate


@MANY
@given(profile=profiles(), thicker=factors, more=factors)
def test_leak_rate_is_proportional_to_pressure_drop_over_viscosity(profile, thicker, more):
    Q = rate(*profile)
    assert rate(*profile, viscosity=1e-3 * thicker, drop=1e5 * more) == pytest.approx(
        Q * more / thicker, rel=1e-12
    )


@MANY
@given(profile=profiles(), factor=st.floats(0.1, 10))
def test_leak_rate_scales_with_circumference_and_width(profile, factor):
    x, p = profile
    Q = rate(x, p)
    assert rate(x, p, radius=0.014 * factor) == pytest.approx(factor * Q, rel=1e-12)
    assert rate(factor * x, p) == pytest.approx(Q / factor, rel=1e-9)


@MANY
@given(profile=profiles(), slope=st.floats(-1, 1))
def test_mirrored_profile_leaks_as_much(profile, slope):
    x, p = profile
    radius = 0.014 + slope * x
    mirrored = rate(-x[::-1], p[::-1], radius=radius[::-1])
    # sums in another order
    assert mirrored == pytest.approx(rate(x, p, radius=radius), rel=1e-9)
    assert rate(x, p, radius=radius, pressure_side="inner") == pytest.approx(mirrored, rel=1e-12)


@MANY
@given(profile=profiles(), shift=st.floats(-1e-2, 1e-2))
def test_leak_rate_does_not_know_where_x_begins(profile, shift):
    x, p = profile
    # differences of x lose digits
    assert rate(x + shift, p) == pytest.approx(rate(x, p), rel=1e-6)


@MANY
@given(profile=profiles(), more=st.floats(1.01, 3))
def test_more_contact_pressure_leaks_less(profile, more):
    x, p = profile
    assert rate(x, more * p) < rate(x, p)


@MANY
@given(profile=profiles())
def test_fluid_pressure_falls_from_the_high_to_the_low_side(profile):
    x, p = profile
    outer = leak.leak_flow(x, p, TABLE.at(1e-3), 1e5, 0.014)
    inner = leak.leak_flow(x, p, TABLE.at(1e-3), 1e5, 0.014, pressure_side="inner")
    assert (np.diff(outer.fluid_pressure) >= 0).all()
    assert outer.fluid_pressure.min() >= 0
    assert outer.fluid_pressure.max() <= 1e5
    np.testing.assert_allclose(outer.fluid_pressure + inner.fluid_pressure, 1e5, rtol=1e-9)
    assert outer.leak_rate * outer.resistance == pytest.approx(1e5, rel=1e-12)


@MANY
@given(load=st.floats(-3, 3), factor=st.floats(0.1, 10))
def test_closed_profiles_carry_their_load_and_keep_their_variance(load, factor):
    """Variances of the Gaussian and of Hertz add in the crossover; all lengths and pressures scale together."""
    f, R, E, u0 = 10**load * 1e4, 0.02, 115e9, 0.76e-6
    line, hertz, gauss = (
        crossover_line(f, R, E, u0),
        leak.hertz_line(f, R, E),
        gaussian_line(f, R, u0),
    )
    assert line.std**2 == pytest.approx(hertz.std**2 + gauss.std**2, rel=1e-12)
    larger = crossover_line(f * factor, R * factor, E, u0 * factor)
    # adaptive quadratures of the same integral
    assert larger.peak_pressure == pytest.approx(line.peak_pressure, rel=1e-7)
    assert larger.std == pytest.approx(factor * line.std, rel=1e-12)
    assert line.peak_pressure < min(hertz.peak_pressure, gauss.peak_pressure)


# -------------------------------------------------------------------- no number outside the numbers


def wide(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log10(low), np.log10(high)).map(lambda exponent: float(10.0**exponent))


@settings(max_examples=5, deadline=None)
@given(
    heights=wide(1e-11, 1e-3),
    wavenumbers=st.tuples(wide(1.0, 1e9), wide(1.0, 1e9), wide(1.0, 1e9)).map(sorted),
    hurst=st.floats(0.01, 1.0),
    E=wide(1e6, 2e12),
    softness=st.none() | wide(1.0, 1e5),
    threshold=st.floats(0.05, 0.95),
    load=st.floats(1e-6, 1.01),
    inlet=wide(1.0, 1e9),
    outlet=st.just(0.0) | st.floats(0.0, 0.999),
    gas=st.sampled_from([*leak.GASES]),
)
def test_all_that_a_case_file_allows_stays_finite(
    heights, wavenumbers, hurst, E, softness, threshold, load, inlet, outlet, gas
):
    """Numpy's warnings are errors in these tests: there is no overflow, no invalid power and no division by zero."""
    low, rolloff, high = wavenumbers
    if not high > 1.001 * low:
        return
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=heights, hurst=hurst, q_low=low, q_rolloff=rolloff, q_high=high
    )
    surface = leak.RoughContact(
        spectrum, effective_modulus=E, hardness=softness and E / softness, percolation_threshold=threshold
    )
    top = min(surface.sealing_pressure, surface.hardness or np.inf)
    p = np.concatenate([[1e-300, 1e-30], np.geomspace(1e-12, 0.999, 7)]) * top
    for separation in (surface.mean_separation, surface.effective_separation, surface.critical_separation):
        u = separation(p)
        assert np.all(np.isfinite(u) & (u >= 0.0))
    x = 1e-3 * np.linspace(-1.5, 1.5, 31)
    profile = load * top * np.exp(-((x / 1e-3) ** 2))
    found = leak.gas_leak_flow(x, profile, surface, leak.gas(gas), inlet, outlet * inlet, 0.02)
    table = surface.conductivity_table(1e-9 * load * top, 1.01 * load * top)
    liquid = leak.leak_rate(x, profile, table.at(1e-3), inlet, 0.02)
    assert np.all(np.isfinite([found.mass_flow, liquid, *found.fluid_pressure]))
    assert (found.mass_flow > 0.0) == (liquid > 0.0)
