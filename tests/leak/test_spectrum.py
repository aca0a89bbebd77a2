"""Power spectra: moments against closed forms and quadrature, round trips, wrong input."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import spectrum as paper
from scipy.integrate import quad

import leak


def test_self_affine_agrees_with_the_reference_numbers(reference):
    row = reference("spectra.csv")
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=float(row["rms_height_m"]),
        hurst=float(row["hurst"]),
        q_low=float(row["q_low"]),
        q_rolloff=float(row["q_rolloff"]),
        q_high=float(row["q_high"]),
    )
    assert spectrum.rms_height == pytest.approx(1.9e-6, rel=1e-13)  # closed form both ways
    assert spectrum.rms_slope == pytest.approx(float(row["rms_slope"]), rel=1e-7)  # digits of the file


@pytest.mark.parametrize("hurst", [0.2, 0.5, 0.8, 0.99, 1.0])
@pytest.mark.parametrize("rolloff", [1e3, 2e4, 1e7])
def test_moments_against_quadrature(hurst, rolloff):
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=hurst, q_low=1e3, q_rolloff=rolloff, q_high=1e7
    )
    for order, value in ((1, spectrum.rms_height**2), (3, spectrum.rms_slope**2)):
        expected = 0.0
        for a, b in ((1e3, rolloff), (rolloff, 1e7)):
            if b > a:
                expected += quad(
                    lambda y, n=order: np.exp((n + 1) * y) * spectrum(np.exp(y)), np.log(a), np.log(b)
                )[0]
        assert value == pytest.approx(2 * np.pi * expected, rel=1e-8)  # quad's own tolerance


def test_spectrum_is_zero_outside_and_scalar_for_scalars():
    spectrum = paper()
    assert spectrum(999.0) == 0.0
    assert spectrum(3.2e6) == 0.0
    assert isinstance(spectrum(1e4), float)
    assert spectrum(np.array([1e3, 1e4])).shape == (2,)
    assert spectrum(1e3) == pytest.approx(spectrum(1e4), rel=1e-14)  # flat below the roll-off


def test_table_of_a_power_law_is_exact():
    q = np.geomspace(1e3, 1e6, 7)
    spectrum = leak.PowerSpectrum.from_table(q, 1e-10 * q**-3.2)
    assert spectrum(2.345e4) == pytest.approx(1e-10 * 2.345e4**-3.2, rel=1e-12)
    exact = 1e-10 * (1e6**0.8 - 1e3**0.8) / 0.8
    assert spectrum.moment(3) == pytest.approx(exact, rel=1e-12)
    assert spectrum.moment(3, 1e4, 1e5) == pytest.approx(1e-10 * (1e5**0.8 - 1e4**0.8) / 0.8, rel=1e-12)


def test_slope_moment_and_its_inverse():
    spectrum = paper()
    q = np.geomspace(1.0001e3, 3.14e6, 200)
    back = np.exp(spectrum.at_slope_moment(spectrum.slope_moment(q)).log_wavenumber)
    np.testing.assert_allclose(back, q, rtol=1e-11)  # M - M(q_low) has lost a few digits close to q_low
    assert 2 * np.pi * spectrum.slope_moment(spectrum.q_high) == pytest.approx(
        spectrum.rms_slope**2, rel=1e-13
    )


def test_height_variance_above_ends():
    spectrum = paper()
    assert np.sqrt(spectrum.height_variance_above(0.0)) == pytest.approx(1.9e-6, rel=1e-13)
    assert spectrum.height_variance_above(1e9) == 0.0


def test_sum_adds_variances_and_values():
    a = paper()
    b = leak.PowerSpectrum.self_affine(rms_height=0.8e-6, hurst=0.8, q_low=2e3, q_rolloff=1e5, q_high=2e6)
    both = a + b
    q = np.geomspace(1.01e3, 3.1e6, 500)
    np.testing.assert_allclose(both(q), a(q) + b(q), rtol=2e-5)  # stated log-log interpolation error of a sum
    assert both.rms_height**2 == pytest.approx(a.rms_height**2 + b.rms_height**2, rel=2e-5)
    assert both.rms_slope**2 == pytest.approx(a.rms_slope**2 + b.rms_slope**2, rel=2e-5)
    assert both.q_low == 1e3
    assert both.q_high == a.q_high


def test_sum_of_spectra_that_do_not_meet():
    low = leak.PowerSpectrum.from_table([1e3, 1e4], [1e-22, 1e-22])
    high = leak.PowerSpectrum.from_table([1e5, 1e6], [1e-25, 1e-27])
    both = low + high
    assert both.rms_height**2 == pytest.approx(low.rms_height**2 + high.rms_height**2, rel=1e-8)
    assert both(3e4) < 1e-11 * high(1e6) * 1e2


def test_equal_content_is_equal_and_hashes_alike():
    assert paper() == paper()
    assert hash(paper()) == hash(paper())
    assert paper() != paper() + paper()
    with pytest.raises(ValueError, match="read-only"):
        paper().density[0] = 1.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"rms_height": 0.0}, "rms_height"),
        ({"hurst": 1.2}, "hurst"),
        ({"hurst": -0.1}, "hurst"),
        ({"q_low": 1e7}, "q_low"),
        ({"q_rolloff": 10.0}, "q_rolloff"),
        ({"q_high": np.inf}, "q_high"),
        ({"q_low": "ten"}, "q_low"),
    ],
)
def test_wrong_self_affine_input_names_the_key(change, says):
    good = {"rms_height": 1e-6, "hurst": 0.8, "q_low": 1e3, "q_rolloff": 1e4, "q_high": 1e6}
    with pytest.raises(leak.SpectrumError, match=says):
        leak.PowerSpectrum.self_affine(**(good | change))


@pytest.mark.parametrize(
    ("q", "C"),
    [
        ([1e3], [1e-22]),
        ([1e3, 1e4], [1e-22]),
        ([1e3, 1e4], [1e-22, -1.0]),
        ([1e3, 1e4], [1e-22, np.nan]),
        ([1e4, 1e3], [1e-22, 1e-22]),
        ([1e3, 1e3, 1e4], [1e-22, 1e-23, 1e-24]),
        ([0.0, 1e3], [1e-22, 1e-22]),
    ],
)
def test_wrong_table(q, C):
    with pytest.raises(leak.SpectrumError):
        leak.PowerSpectrum.from_table(q, C)


@settings(max_examples=30, deadline=None)
@given(
    hurst=st.floats(0.05, 1.0),
    scale=st.floats(1e-3, 1e3),
    decades=st.floats(0.1, 8.0),
)
def test_moments_scale_with_length(hurst, scale, decades):
    low = 1e3

    def make(factor: float) -> leak.PowerSpectrum:
        return leak.PowerSpectrum.self_affine(
            rms_height=1e-6 * factor,
            hurst=hurst,
            q_low=low / factor,
            q_rolloff=low / factor * 10 ** (decades / 3),
            q_high=low / factor * 10**decades,
        )

    assert make(scale).rms_slope == pytest.approx(make(1.0).rms_slope, rel=1e-10)
