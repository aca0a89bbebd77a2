"""Asperity plasticity: the three areas, force balance, and the smoothed spectrum."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import HARDNESS, E, spectrum, surface

import leak
from leak.theory.plasticity import PlasticRoughness


def stress_distribution(sigma: np.ndarray, s: float, t: float) -> np.ndarray:
    """P(sigma) by images, an independent sum."""
    k = np.arange(-30, 31)[:, None]

    def gauss(x):
        return np.exp(-(x**2) / (4 * t)) / np.sqrt(4 * np.pi * t)

    return np.sum(gauss(sigma - s - 2 * k) - gauss(sigma + s - 2 * k), axis=0)


@settings(max_examples=300, deadline=None)
@given(s=st.floats(1e-9, 1 - 1e-9), t=st.floats(0.0, 60.0) | st.floats(-12, 1).map(lambda e: 10.0**e))
def test_the_three_areas_add_up(s, t):
    parts = leak.area_fractions(s, t)
    assert sum(parts) == pytest.approx(1.0, abs=1e-14)
    assert all(part >= -1e-16 for part in parts)


@pytest.mark.parametrize("s", [1e-4, 0.014, 0.5, 0.97])
def test_both_series_agree_where_they_meet(s):
    """Images below t = 0.3, eigenfunctions above: 14 digits on either side."""
    left, right = leak.area_fractions(s, 0.3 * (1 - 1e-15)), leak.area_fractions(s, 0.3)
    np.testing.assert_allclose(left, right, rtol=1e-12)
    assert leak.remaining_fraction(s, 0.3 * (1 - 1e-15)) == pytest.approx(
        float(leak.remaining_fraction(s, 0.3)), rel=1e-11
    )


@pytest.mark.parametrize("s", [0.014, 0.5, 0.9])
@pytest.mark.parametrize("t", [1e-3, 0.05, 0.3, 1.5])
def test_force_balance_and_elastic_area(s, t):
    x, w = np.polynomial.legendre.leggauss(64)
    panels = np.linspace(0, 1, 9)[:-1, None]
    sigma, w = (panels + (1 + x) / 16).ravel(), np.tile(w / 16, 8)
    P = stress_distribution(sigma, s, t)
    parts = leak.area_fractions(s, t)
    assert np.sum(w * sigma * P) + parts.plastic == pytest.approx(s, rel=1e-12)
    assert np.sum(w * P) == pytest.approx(float(parts.elastic), rel=1e-11)


def test_infinite_hardness_is_the_elastic_area():
    p, M = 50e6, np.array([1e-8, 1e-4, 0.02])
    s, t = p / 1e15, 0.25 * np.pi * (E / 1e15) ** 2 * M
    np.testing.assert_allclose(
        leak.area_fractions(s, t).elastic, leak.relative_contact_area(p, M, E), rtol=1e-12
    )


def test_no_roughness_seen_and_full_yield():
    assert leak.area_fractions(0.3, 0.0) == (1.0, 0.0, 0.0)
    np.testing.assert_allclose(leak.area_fractions(0.3, 50.0), (0.0, 0.3, 0.7), atol=1e-15)
    assert leak.area_fractions(1.2, 0.1) == (0.0, 1.0, 0.0)


def test_areas_and_spectrum_at_50_MPa(reference):
    table = reference("areas_at_50MPa_paper.csv")
    contact = surface(hardness=HARDNESS)
    q, p = table["wavenumber_per_m"], 50e6
    # Six digits of the file; where a fraction is below 1e-30 its exponent amplifies the digits of q.
    np.testing.assert_allclose(contact.elastic.contact_area(p, q), table["area_elastic_only"], rtol=1e-6)
    np.testing.assert_allclose(contact.elastic_area(p, q), table["elastic_area"], rtol=1e-5)
    plastic = table["plastic_area"]
    seen = plastic > 1e-40
    np.testing.assert_allclose(np.asarray(contact.plastic_area(p, q))[seen], plastic[seen], rtol=1e-5)
    np.testing.assert_allclose(contact.spectrum(q), table["spectrum_m4"], rtol=1e-6)
    # The file takes 1 - (A_pl/A_pl0)^6 as it stands: zero from 1e-16 on, a few digits lost before.
    kept = table["plastic_spectrum_m4"] > 1e-12 * table["spectrum_m4"]
    C_pl = contact.spectrum(q) * contact.smoothing(p, q)
    np.testing.assert_allclose(C_pl[kept], table["plastic_spectrum_m4"][kept], rtol=1e-4)
    np.testing.assert_allclose(contact.contact_area(p, q), table["elastic_area"] + plastic, rtol=1e-5)


def test_remaining_fraction_keeps_its_digits():
    # Late: only the slowest mode is left, 6 (2/(pi s)) sin(pi s) exp(-pi^2 t).
    s, t = 0.2, 8.0
    expected = 12 / (np.pi * s) * np.sin(np.pi * s) * np.exp(-(np.pi**2) * t)
    assert leak.remaining_fraction(s, t) == pytest.approx(expected, rel=1e-12)
    assert leak.remaining_fraction(0.2, 1e-3) == 1.0
    assert leak.remaining_fraction(0.0, 0.5) == pytest.approx(
        float(leak.remaining_fraction(1e-6, 0.5)), rel=1e-9
    )
    assert leak.remaining_fraction(1.0, 0.1) == 0.0


def test_plastic_spectrum_samples_the_smoothing():
    contact = surface(hardness=HARDNESS)
    C_pl = contact.plastic_spectrum(50e6)
    q = np.geomspace(1e3, C_pl.q_high, 777)
    np.testing.assert_allclose(C_pl(q), contact.spectrum(q) * contact.smoothing(50e6, q), rtol=5e-4)
    assert contact.elastic.plastic_spectrum(50e6) == contact.spectrum


def test_elastic_theory_on_the_smoothed_spectrum_gives_nearly_the_same_area():
    """The idea behind C_pl: within 15 % of A_el + A_pl at any magnification (Persson 2016)."""
    contact = surface(hardness=HARDNESS)
    q = np.geomspace(2e3, 3e6, 60)
    direct = np.asarray(contact.contact_area(50e6, q))
    on_C_pl = leak.RoughContact(contact.plastic_spectrum(50e6), effective_modulus=E).contact_area(50e6, q)
    assert np.max(np.abs(on_C_pl / direct - 1)) < 0.15


def test_moments_of_the_remaining_roughness_are_consistent():
    s = np.array([1e-4, 0.3, 0.95])
    end = float(spectrum().break_moments[-1])
    seen = PlasticRoughness.at(s, E, HARDNESS, end)
    M = np.broadcast_to(np.geomspace(1e-9, 0.99 * seen.end, 60), (3, 60))
    rise, factor = seen.moments_above(M[:, :-1])(np.diff(M, axis=1))
    # Absolute, against the total: moment() counts from below, step() from above.
    np.testing.assert_allclose(np.diff(seen.moment(M), axis=1), rise, atol=1e-12 * end)
    np.testing.assert_allclose(
        factor, leak.remaining_fraction(s[:, None], seen.kappa * M[:, 1:]), rtol=2e-3, atol=1e-7
    )


def test_moment_of_the_remaining_roughness_by_quadrature():
    """int C_pl/C dM with t = (pi/4) (E*/sigma_P)^2 M, nothing of the table."""
    from scipy.integrate import quad

    s, scale = 0.0163, np.pi / 4 * (E / HARDNESS) ** 2
    seen = PlasticRoughness.at(np.array([s]), E, HARDNESS, float(spectrum().break_moments[-1]))
    assert seen.kappa == pytest.approx(scale, rel=1e-14)
    for t in (0.05, 0.3, 1.0):
        cuts = np.array([0.0, 0.02, 0.05, 0.15, 0.3, 1.0])
        exact = sum(
            quad(lambda x: float(leak.remaining_fraction(s, x)), a, min(b, t), epsabs=0, epsrel=1e-9)[0]
            for a, b in pairwise(cuts)
            if a < t
        )
        assert float(seen.moment(np.array([[t / scale]]))[0, 0]) == pytest.approx(exact / scale, rel=2e-5)


def test_hardness_close_to_the_pressure():
    contact = surface(hardness=HARDNESS)
    ratio = np.array([0.9, 0.99, 0.999999, 1.0, 1.5])
    ubar = np.asarray(contact.mean_separation(ratio * HARDNESS))
    assert np.all(np.diff(ubar) <= 0.0)
    assert ubar[3] == ubar[4] == 0.0
    assert np.all(np.asarray(contact.effective_separation(ratio * HARDNESS)) == 0.0)
    assert contact.plastic_area(2 * HARDNESS) == 1.0
    with pytest.raises(leak.SurfaceError, match="hardness"):
        contact.plastic_spectrum(HARDNESS)


def test_hardness_far_above_changes_nothing():
    hard = surface(hardness=1e15)
    p = np.array([1e5, 1e8])
    np.testing.assert_allclose(hard.effective_separation(p), hard.elastic.effective_separation(p), rtol=1e-5)


def test_the_touching_area_is_elastic_and_plastic_area_together():
    hard, p = surface(hardness=2e9), np.array([1e2, 1e6, 6e8, 1.4e9, 1.998e9, 2e9, 4e9])
    for q in (None, hard.spectrum.q_low * 1.001, hard.spectrum.q_high):
        together = np.asarray(hard.elastic_area(p, q)) + np.asarray(hard.plastic_area(p, q))
        np.testing.assert_allclose(hard.contact_area(p, q), together, rtol=1e-14, atol=0)
    assert isinstance(hard.contact_area(4e8), float)


@settings(deadline=None, max_examples=200)
@given(share=st.floats(-8.0, -0.001), hard=st.floats(-3.0, 3.0))
def test_the_quick_bound_is_never_below_the_touching_area(share, hard):
    """Pressures up to the hardness, hardness in units of E* h'."""
    one = leak.RoughContact(spectrum(), effective_modulus=E, hardness=10.0**hard * E * spectrum().rms_slope)
    p = 10.0**share * min(one.hardness, 3.0 * E * spectrum().rms_slope)
    for seen in (one, one.elastic):
        most, area = seen.most_contact_area(p), float(seen.contact_area(p))
        assert area <= most * (1.0 + 1e-12)
        # and where next to nothing touches it is the area itself
        if seen.hardness is None and area < 1e-3:
            assert most == pytest.approx(area, rel=1e-5)
