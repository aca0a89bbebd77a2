"""Elastic theory: areas, mean separation and u1 against quadrature of the published formulas and energy balance."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import E, spectrum, surface
from scipy.integrate import quad
from scipy.special import erf, exp1

import leak
from leak.theory.persson import kernel, low_pressure_law, separations
from leak.theory.plasticity import Roughness

GAMMA = 0.45


def F_by_quadrature(x: float) -> float:
    """The pressure integral of the mean separation, as printed."""
    value, _ = quad(
        lambda y: (GAMMA + 3 * (1 - GAMMA) * erf(np.exp(y)) ** 2) * np.exp(-np.exp(2 * y)),
        np.log(x),
        np.log(8.0),
        epsabs=1e-15,
        epsrel=1e-12,
        limit=200,
    )
    return value


@pytest.mark.parametrize("x", [1e-3, 0.01, 0.1, 0.5, 1.0, 2.0, 4.0])
def test_kernel_against_quadrature(x):
    F, f = kernel(GAMMA)(np.array([np.log(x)]))
    assert F[0] == pytest.approx(F_by_quadrature(x), rel=2e-7, abs=2e-9)
    # The table is linear in ln x; values below 1e-3 of F(0.1) never decide anything.
    assert f[0] == pytest.approx(
        (GAMMA + 3 * (1 - GAMMA) * erf(x) ** 2) * np.exp(-(x**2)), rel=1e-6, abs=2e-9
    )


def test_kernel_goes_on_as_its_logarithm():
    K0, _ = quad(lambda t: erf(t) ** 2 * np.exp(-(t**2)) / t, 0, 8, epsabs=1e-14)
    assert pytest.approx(K0, rel=1e-9) == kernel(GAMMA).K0
    x = 1e-30
    F, _ = kernel(GAMMA)(np.array([np.log(x)]))
    assert F[0] == pytest.approx(0.5 * GAMMA * exp1(x**2) + 3 * (1 - GAMMA) * K0, rel=1e-7)


def mean_separation_by_quadrature(contact: leak.RoughContact, p: float) -> float:
    """ubar = sqrt(pi) int q^2 C w F(w p/E*) dq by brute force in q: nothing shared with the package."""
    C, q0 = contact.spectrum, contact.spectrum.q_low
    t, weight = np.polynomial.legendre.leggauss(20)
    total = 0.0
    for a, b in pairwise(C.wavenumber):
        # q - q0 = e^y resolves the square-root singularity of w at q0.
        edges = np.linspace(np.log(max(a - q0, 1e-14 * q0)), np.log(b - q0), 51)
        half = 0.5 * np.diff(edges)[:, None]
        y = (edges[:-1, None] + half * (1 + t)).ravel()
        q = q0 + np.exp(y)
        w = np.array([1 / np.sqrt(np.pi * slope_moment_exact(C, value)) for value in q])
        F = np.array([F_fast(x) for x in w * p / E])
        total += np.sum((half * weight).ravel() * q**2 * C(np.minimum(q, C.q_high)) * w * F * np.exp(y))
    return np.sqrt(np.pi) * total


def slope_moment_exact(C: leak.PowerSpectrum, q: float) -> float:
    """int q^3 C dq of a flat part and one power law, written out, without cancellation close to q_low."""
    C0, H = (
        float(C(C.q_low)),
        0.5 * (np.log(C(C.q_high) / C(C.q_low)) / -np.log(C.q_high / C.wavenumber[-2])) - 1,
    )
    q0, qr = C.q_low, C.wavenumber[-2]
    flat = min(q, qr)
    d = flat - q0
    M = C0 * d * (q0**3 + 1.5 * q0**2 * d + q0 * d**2 + d**3 / 4)
    if q > qr:
        M += C0 * qr ** (2 + 2 * H) * (q ** (2 - 2 * H) - qr ** (2 - 2 * H)) / (2 - 2 * H)
    return M


def F_fast(x: float) -> float:
    """F with its K by quadrature only where it is not settled."""
    if x > 7:
        return 0.0
    K, _ = quad(lambda t: erf(t) ** 2 * np.exp(-(t**2)) / t, x, 8, epsabs=1e-12)
    return 0.5 * GAMMA * exp1(x**2) + 3 * (1 - GAMMA) * K


@pytest.mark.parametrize("p", [1e4, 50e6, 2e9])
def test_mean_separation_against_quadrature(p):
    contact = leak.RoughContact(spectrum(hurst=0.8, q_rolloff=2e4), effective_modulus=E)
    assert contact.mean_separation(p) == pytest.approx(mean_separation_by_quadrature(contact, p), rel=1e-7)


@pytest.mark.parametrize("p", [1e5, 50e6, 3e9])
def test_lost_separation_is_the_derivative_of_separation_times_area(p):
    C = spectrum()
    roughness = Roughness(float(C.break_moments[-1]))
    for fraction in (0.6, 0.2, 0.02):
        M = (p / E) ** 2 / (np.pi * 0.3**2) if fraction == 0.6 else fraction * roughness.end
        step = 1e-4
        sides = separations(
            C,
            roughness,
            np.array([p / E]),
            np.array([[M * (1 - step), M, M * (1 + step)]]),
            GAMMA,
            refinement=4,
        )
        product = sides.mean[0] * sides.area[0]
        slope = (product[2] - product[0]) / (sides.area[0, 2] - sides.area[0, 0])
        # Second-order difference of values good to 1e-8 over a step of 1e-4.
        assert sides.lost_separation[0, 1] == pytest.approx(slope, rel=3e-4)


def test_pressure_times_separation_change_is_the_elastic_energy():
    """p dubar = -dU with U = (pi/2) E* int q^2 C [gamma P + (1-gamma) P^3] dq, P = A/A0 (Yang & Persson 2008)."""
    contact = surface()
    C = contact.spectrum

    def energy(p: float) -> float:
        def integrand(y: float) -> float:
            q = np.exp(y)
            P = erf(p / E / np.sqrt(np.pi * max(slope_moment_exact(C, q), 1e-300)))
            return q**3 * float(C(min(q, C.q_high))) * (GAMMA * P + (1 - GAMMA) * P**3)

        parts = (
            quad(integrand, np.log(a), np.log(b), epsrel=1e-10, limit=300)[0]
            for a, b in ((1e3, 3.7268e4), (3.7268e4, C.q_high))
        )
        return 0.5 * np.pi * E * sum(parts)

    p1, p2 = 1e6, 5e9
    t, w = np.polynomial.legendre.leggauss(60)
    half = 0.5 * np.log(p2 / p1)
    p = p1 * np.exp(half * (1 + t))
    work = (
        contact.mean_separation(p1) * p1
        - contact.mean_separation(p2) * p2
        + np.sum(w * half * p * contact.mean_separation(p))
    )
    assert work == pytest.approx(energy(p2) - energy(p1), rel=1e-6)  # table of the kernel


def test_separation_vanishes_at_large_pressure():
    contact = surface()
    assert contact.mean_separation(1e12) < 1e-3 * contact.u0
    assert contact.mean_separation(0.0) == np.inf


def test_low_pressure_law(reference):
    contact = surface()
    row = reference("spectra.csv")
    assert contact.u0 == pytest.approx(float(row["u0_m"]), rel=2e-7)
    assert contact.p_c == pytest.approx(float(row["p_c_Pa"]), rel=2e-6)
    p = contact.p_c * np.exp(-np.array([25.0, 40.0]))
    np.testing.assert_allclose(contact.mean_separation(p), contact.u0 * np.log(contact.p_c / p), rtol=1e-7)


def test_flat_spectrum_has_the_closed_decay_length():
    flat = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1.0, q_rolloff=1e6, q_high=1e6)
    assert low_pressure_law(flat, GAMMA).u0 / flat.rms_height == pytest.approx(
        2 * GAMMA / np.sqrt(np.pi), rel=1e-5
    )


def test_area_limits():
    contact = surface()
    slope = contact.spectrum.rms_slope
    assert contact.contact_area(1e3) == pytest.approx(np.sqrt(8 / np.pi) * 1e3 / (E * slope), rel=1e-9)
    assert contact.contact_area(1e13) == pytest.approx(1.0)
    assert contact.contact_area(50e6, 1e3) == 1.0  # no roughness seen yet
    assert contact.contact_area(0.0) == 0.0
    assert contact.contact_area(np.full((3, 1), 1e6), np.full(4, 1e5)).shape == (3, 4)


@settings(max_examples=15, deadline=None)
@given(scale=st.floats(0.01, 100.0), ratio=st.floats(1e-6, 0.1))
def test_only_pressure_over_modulus_counts(scale, ratio):
    one = surface()
    other = leak.RoughContact(spectrum(), effective_modulus=E * scale)
    assert other.mean_separation(ratio * E * scale) == pytest.approx(one.mean_separation(ratio * E), rel=1e-9)
    assert other.effective_separation(ratio * E * scale) == pytest.approx(
        one.effective_separation(ratio * E), rel=1e-9
    )


@settings(max_examples=10, deadline=None)
@given(factor=st.floats(0.01, 100.0))
def test_separations_scale_with_lengths(factor):
    """Lengths times f at equal slopes: C times f^4, q over f."""
    C = spectrum()
    grown = leak.PowerSpectrum(C.wavenumber / factor, C.density * factor**4)
    p = np.array([1e5, 1e8])
    a, b = leak.RoughContact(C, effective_modulus=E), leak.RoughContact(grown, effective_modulus=E)
    np.testing.assert_allclose(b.mean_separation(p), factor * a.mean_separation(p), rtol=1e-9)
    np.testing.assert_allclose(b.effective_separation(p), factor * a.effective_separation(p), rtol=1e-8)


def test_critical_junction_where_the_spectrum_ends():
    """A threshold that is just about reached with all of the roughness; the magnification is found by its logarithm."""
    C = leak.PowerSpectrum.self_affine(
        rms_height=6.857935293219154e-09,
        hurst=0.752861025903752,
        q_low=16.083304160952988,
        q_rolloff=535.4925876123971,
        q_high=12063.713241572561,
    )
    contact = leak.RoughContact(
        C,
        effective_modulus=58460697.83072194,
        hardness=46832786.017071,
        percolation_threshold=0.9154914742974081,
    )
    p = np.concatenate([[1e-30], np.geomspace(1e-3, 0.999 * 46832786.017071, 9)])
    u = contact.critical_separation(p)
    sealed = p >= contact.sealing_pressure
    assert sealed.any()
    assert np.all(u[sealed] == 0.0)
    assert np.all(np.diff(u[~sealed]) < 0.0)
    # elastic asperities are the limit of hard ones, to whom nothing happens
    np.testing.assert_allclose(u[~sealed], contact.elastic.critical_separation(p[~sealed]), rtol=1e-6)
