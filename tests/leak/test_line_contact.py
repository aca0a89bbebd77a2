"""Closed line-contact profiles: reference numbers, special functions, limits, and the contact integral itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import wofz

import leak

E = 210e9 / 1.82
R = 0.02


def with_share(c: float, u0: float = 0.5e-6) -> leak.CrossoverLine:
    """Crossover of a wanted Hertzian share c = f_N/(pi E* u0)."""
    return leak.crossover_line(c * np.pi * E * u0, R, E, u0)


def test_reference_numbers(reference):
    rows = reference("line_contact.csv")
    for row in rows:
        load, radius, modulus = (
            float(row[k]) for k in ("line_load_N_per_m", "ball_radius_m", "effective_modulus_Pa")
        )
        line, hertz = (
            leak.crossover_line(load, radius, modulus, float(row["u0_m"])),
            leak.hertz_line(load, radius, modulus),
        )
        # The file has eight digits.
        assert line.peak_pressure == pytest.approx(float(row["peak_pressure_Pa"]), rel=1e-7)
        assert line.fwhm == pytest.approx(float(row["fwhm_m"]), rel=1e-7)
        assert line.std == pytest.approx(float(row["std_m"]), rel=1e-7)
        assert hertz.peak_pressure == pytest.approx(float(row["hertz_peak_Pa"]), rel=1e-7)
        assert hertz.half_width == pytest.approx(float(row["hertz_half_width_m"]), rel=1e-7)


@pytest.mark.parametrize(
    ("pressure", "peak", "fwhm", "std"),
    [(20e5, 61.6678e6, 0.307040e-3, 0.127685e-3), (2e5, 6.43935e6, 0.292018e-3, 0.123735e-3)],
)
def test_ball_on_cone_numbers(pressure, peak, fwhm, std):
    line = leak.crossover_line(0.5 * R * pressure, R, E, 0.76e-6)
    assert line.peak_pressure == pytest.approx(peak, rel=2e-6)
    assert line.fwhm == pytest.approx(fwhm, rel=2e-6)
    assert line.std == pytest.approx(std, rel=4e-6)


def parabolic_cylinder_squared(c: int, X: np.ndarray) -> np.ndarray:
    """|D_{-c}(iX)|^2 for c = 1, 2, 3 by recurrence from the Faddeeva function."""
    z = 1j * X
    d0 = np.exp(-(z**2) / 4)  # D_0
    d1 = (
        np.sqrt(np.pi / 2) * np.exp(-(z**2) / 4) * wofz(1j * z / np.sqrt(2))
    )  # D_-1 = e^(z^2/4) erfc(z/sqrt 2) ...
    values = [d0, d1]
    for n in (1, 2):
        values.append((values[n - 1] - z * values[n]) / n)  # D_{-n-1} = (D_{-n+1} - z D_{-n})/n
    return np.abs(values[c]) ** 2


@pytest.mark.parametrize("c", [1, 2, 3])
def test_against_the_parabolic_cylinder_function(c):
    from scipy.special import gamma

    line = with_share(float(c))
    s = np.sqrt(R * line.u0)
    X = np.linspace(0.0, 5.0, 41)
    expected = line.line_load / s / (np.sqrt(2 * np.pi) * gamma(1 + c) * parabolic_cylinder_squared(c, X))
    np.testing.assert_allclose(line.pressure(X * s), expected, rtol=1e-11)


@pytest.mark.parametrize("c", [1e-9, 1e-3, 0.03, 0.5, 1.0, 7.3, 60.0, 1e3, 1e4])
def test_load_variance_and_half_height(c):
    line = with_share(c)
    a, s = np.sqrt(4 * c) * np.sqrt(R * line.u0), np.sqrt(R * line.u0)
    edges = np.unique(
        np.concatenate(
            [np.linspace(0, a, 40), a + s * np.linspace(-1, 1, 200), a + s * np.linspace(1, 9, 60)]
        )
    )
    edges = edges[edges >= 0]
    t, w = np.polynomial.legendre.leggauss(10)
    half = 0.5 * np.diff(edges)[:, None]
    x = (edges[:-1, None] + half * (1 + t)).ravel()
    p, w = line.pressure(x), 2 * (half * w).ravel()
    assert np.sum(w * p) == pytest.approx(line.line_load, rel=1e-10)
    assert np.sum(w * p * x**2) / line.line_load == pytest.approx(line.std**2, rel=1e-10)
    assert line.std**2 == pytest.approx(
        R * line.u0 + (0.5 * a) ** 2, rel=1e-12
    )  # Gaussian and Hertzian variance add
    assert line.pressure(0.5 * line.fwhm) == pytest.approx(0.5 * line.peak_pressure, rel=1e-11)
    assert line.pressure(0.0) == pytest.approx(line.peak_pressure, rel=1e-12)


def test_limits():
    for c in (1e-4, 1e-5):
        gauss = leak.gaussian_line(with_share(c).line_load, R, 0.5e-6)
        assert (with_share(c).peak_pressure / gauss.peak_pressure - 1) / -c == pytest.approx(
            np.log(2), rel=30 * c
        )
    for c in (1e3, 1e4):
        hertz = leak.hertz_line(with_share(c).line_load, R, E)
        assert (with_share(c).peak_pressure / hertz.peak_pressure - 1) * -4 * c == pytest.approx(
            1.0, rel=2 / c
        )
    x = np.linspace(0, 0.95, 20) * hertz.half_width
    np.testing.assert_allclose(with_share(1e4).pressure(x), hertz.pressure(x), rtol=1e-3)


@pytest.mark.parametrize("c", [0.1, 1.0, 8.0])
def test_it_solves_the_contact_problem(c):
    """-u0 p'/p = x/R - (2/(pi E*)) PV int p(x')/(x - x') dx': the slope of the half-space under the law."""
    line = with_share(c)
    s, width = np.sqrt(R * line.u0), line.std
    h = 0.02 * s
    source = np.arange(-14 * width, 14 * width, h)
    p = line.pressure(source)
    x = (
        source[len(source) // 2 : len(source) // 2 + 160 : 8] + 0.5 * h
    )  # staggered: the principal value is exact
    hilbert = np.array([np.sum(h * p / (at - source)) for at in x])
    step = 1e-3 * s
    slope = (line.log_pressure(x + step) - line.log_pressure(x - step)) / (2 * step)
    np.testing.assert_allclose(
        -line.u0 * slope, x / R - 2 / (np.pi * E) * hilbert, rtol=2e-5
    )  # error of the difference, step^2/6


def test_tails_where_pressure_underflows():
    line = with_share(0.3)
    s = np.sqrt(R * line.u0)
    x = s * np.array([50.0, 60.0])
    # ln p -> -X^2/2 + 2c ln X in the tails
    fall = line.log_pressure(x[1]) - line.log_pressure(x[0])
    assert fall == pytest.approx(-550.0 + 0.6 * np.log(1.2), abs=1e-3)
    assert line.pressure(x[1]) == 0.0
    assert line.log_pressure(-x[0]) == line.log_pressure(x[0])


def test_hertz_and_gauss_closed_values():
    hertz = leak.hertz_line(20e3, R, E)
    assert hertz.peak_pressure == pytest.approx(191.6e6, rel=5e-4)  # the paper's 181 MPa is a misprint
    assert np.pi / 2 * hertz.half_width * hertz.peak_pressure == pytest.approx(20e3, rel=1e-12)
    assert hertz.pressure(0.5 * hertz.fwhm) == pytest.approx(0.5 * hertz.peak_pressure, rel=1e-12)
    assert hertz.std == pytest.approx(0.5 * hertz.half_width)
    assert hertz.pressure(1.1 * hertz.half_width) == 0.0
    gauss = leak.gaussian_line(20e3, R, 0.139e-3**2 / R)
    assert gauss.std == pytest.approx(0.139e-3, rel=1e-12)
    assert gauss.peak_pressure == pytest.approx(57.4e6, rel=1e-3)
    assert gauss.fwhm == pytest.approx(2.3548 * gauss.std, rel=1e-5)


@pytest.mark.parametrize("key", ["line_load", "radius", "effective_modulus", "u0"])
def test_wrong_input_names_the_key(key):
    arguments = {"line_load": 1e3, "radius": 0.02, "effective_modulus": E, "u0": 1e-6} | {key: -1.0}
    with pytest.raises(leak.ProfileError, match=key):
        leak.crossover_line(**arguments)


def test_widths_found_together_are_those_found_alone():
    """Over all shares of Hertz's contact; each profile is followed until it has converged itself."""
    lines = [with_share(c) for c in np.geomspace(1e-6, 1e6, 25)]
    alone = [line.fwhm for line in lines]
    np.testing.assert_allclose(leak.crossover_widths(lines), alone, rtol=1e-12)
    halves = [
        float(line.pressure(0.5 * width)) / line.peak_pressure
        for line, width in zip(lines, alone, strict=True)
    ]
    np.testing.assert_allclose(halves, 0.5, rtol=1e-9)
