"""P(u), Bruggeman's medium, the critical junction and the conductivity table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import HARDNESS, E, spectrum, surface
from scipy import special

import leak
from leak.flow.medium import folded_above
from leak.theory.separation import density, magnification_nodes

# ------------------------------------------------------------------ reference numbers


@pytest.fixture(scope="module")
def rough_contact(reference):
    return reference("rough_contact_paper.csv")


def test_elastic_columns(rough_contact):
    p, elastic = rough_contact["pressure_Pa"], surface()
    for values, column, tolerance in (
        (elastic.contact_area(p), "area_elastic_only", 1e-6),
        (elastic.mean_separation(p), "mean_separation_m", 1e-6),
        (elastic.critical_separation(p), "critical_separation_m", 1e-6),
        (elastic.effective_separation(p), "u_eff_m", 2e-5),
        (surface(separation_width="plain").effective_separation(p), "u_eff_plain_m", 2e-5),
        (surface(percolation_threshold=0.5).effective_separation(p), "u_eff_threshold_half_m", 2e-5),
    ):
        np.testing.assert_allclose(values, rough_contact[column], rtol=tolerance, err_msg=column)


def test_plastic_columns(rough_contact):
    p, plastic = rough_contact["pressure_Pa"], surface(hardness=HARDNESS)
    for values, column, tolerance in (
        (plastic.elastic_area(p), "elastic_area", 1e-5),
        (plastic.plastic_area(p), "plastic_area", 1e-6),
        (plastic.mean_separation(p), "mean_separation_plastic_m", 5e-5),
        # At 1.3 GPa, 11 % below sealing, five digits of the reference are fewer: u_c is a hundredth of its usual size.
        (plastic.critical_separation(p), "critical_separation_plastic_m", 1e-3),
        (plastic.effective_separation(p), "u_eff_plastic_m", 1e-3),
    ):
        np.testing.assert_allclose(values, rough_contact[column], rtol=tolerance, err_msg=column)
    usual = p < 1e9
    np.testing.assert_allclose(
        plastic.effective_separation(p[usual]), rough_contact["u_eff_plastic_m"][usual], rtol=1e-4
    )


def test_conductivity_is_the_gap_of_the_reference_cubed_over_12_eta(rough_contact):
    """Poiseuille flow in a slit: 12 and nothing else, by every way to ask for it."""
    p, u, eta = rough_contact["pressure_Pa"], rough_contact["u_eff_m"], 1.3e-3
    flows = u > 0
    p, sigma = p[flows], u[flows] ** 3 / 12 / eta
    elastic = surface()
    table = elastic.conductivity_table(float(p.min()), float(p.max()))
    of_fluid = table.at(eta)
    for found in (
        elastic.flow_conductivity(p, eta),
        table.conductivity(p, eta),
        of_fluid(p),
        of_fluid.at_log_pressure(np.log(p)),
    ):
        np.testing.assert_allclose(found, sigma, rtol=1e-4)


def test_separation_distribution_at_50_MPa(reference):
    table = reference("separation_distribution_at_50MPa_paper.csv")
    u = table["separation_m"]
    _, P = surface().separation_distribution(50e6, u)
    core = (u > 1.5e-8) & (u < 1.2e-5)
    np.testing.assert_allclose(P[core], table["density_per_m"][core], rtol=2e-5)
    # Below 10 nm the reference wiggles by 0.5 % about a smooth curve; above 12 um less than 1e-4 of the area is left.
    np.testing.assert_allclose(P, table["density_per_m"], rtol=7e-3)


# ------------------------------------------------------------------ P(u)


@pytest.mark.parametrize("hardness", [None, HARDNESS])
def test_distribution_has_weight_one(hardness):
    contact = surface(hardness=hardness)
    u, P = contact.separation_distribution(57e6)
    lost = contact.lost_area(np.array([57e6]))
    assert lost.weight.sum() + lost.contact[0] == pytest.approx(1.0, abs=1e-7)
    # At the shortest waves contact is lost at separations far below any grid; with C_pl that is 3e-4 of the area.
    assert np.trapezoid(P, u) + lost.contact[0] == pytest.approx(1.0, abs=5e-4)


def test_area_above_a_separation_is_the_rest_of_the_distribution():
    contact = surface()
    lost = contact.lost_area(np.array([57e6]))
    u = np.linspace(3e-6, 25e-6, 4001)
    rest = np.trapezoid(density(lost, u[None, :])[0], u)
    # beyond 25 um, 13 rms heights, nothing is left
    assert folded_above(lost, u[:1])[0] == pytest.approx(rest, rel=1e-5)


def test_height_of_what_has_not_yielded():
    """2 pi int q C_pl dq above a magnification, by brute force on the spectrum that the areas give."""
    contact, p = surface(hardness=HARDNESS), 57e6
    lost = replace(contact, separation_width="plain").lost_area(np.array([p]))
    smoothed = contact.plastic_spectrum(p)
    whole = float(np.sqrt(2 * np.pi * smoothed.moment(1)))
    # at the smallest magnification all of it
    assert lost.width[0].max() == pytest.approx(whole, rel=2e-4)


def test_panels_follow_asperities_that_have_yielded():
    """Where C_pl falls like exp(-pi^2 t), panels over wavenumber alone would leave four times this error."""
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=0.3e-6, hurst=0.3, q_low=1e3, q_rolloff=2e4, q_high=1e7
    )
    soft = leak.RoughContact(spectrum, effective_modulus=115e9, hardness=1e9)
    p = np.geomspace(1e5, 0.5e9, 9)
    fine = soft.effective_separation(p, refinement=4.0)
    np.testing.assert_allclose(soft.effective_separation(p), fine, rtol=6e-6)


def mean_lost_separation(lost):
    """<u> of P(u), each folded Gaussian in closed form, shape (P,) [m]."""
    h, u1 = lost.width, lost.separation
    x = u1 / (np.sqrt(2.0) * h)
    mean = h * np.sqrt(2.0 / np.pi) * np.exp(-(x**2)) + u1 * special.erf(x)
    return np.where(lost.weight > 0.0, lost.weight * mean, 0.0).sum(axis=1)


def test_mean_of_the_distribution_is_the_mean_separation():
    """0.1 % at 57 MPa, growing towards full contact: the two come from different steps of the theory."""
    contact = surface()
    p = np.array([57e6, 1e9])
    lost = contact.lost_area(p)
    difference = mean_lost_separation(lost) / contact.mean_separation(p) - 1
    assert abs(difference[0]) < 1.5e-3
    assert 1.5e-3 < difference[1] < 0.05
    u, P = contact.separation_distribution(57e6)
    assert np.trapezoid(u * P, u) == pytest.approx(
        float(mean_lost_separation(lost)[0]), rel=5e-4
    )  # grid ends


# ------------------------------------------------------------------ effective medium


def medium(u, weight, contact=0.0, wide_open=0.0, n=2.0):
    u, weight = np.atleast_2d(u), np.atleast_2d(weight)
    return float(leak.effective_medium(u, weight, np.array([contact]), np.array([wide_open]), n)[0])


@settings(max_examples=60, deadline=None)
@given(a=st.floats(0.0, 0.9), threshold=st.floats(0.05, 0.95))
def test_uniform_gap_with_contact(a, threshold):
    """Conductivity 1 - a n/(n-1) of the open gap, zero from a = threshold on."""
    n = leak.dimension_number(threshold)
    sigma = medium([1e-6], [1 - a], contact=a, n=n) ** 3 / 1e-18
    assert sigma == pytest.approx(max(1 - a * n / (n - 1), 0.0), abs=1e-9)


def test_lognormal_conductivity_with_n_2_is_the_geometric_mean():
    x = np.linspace(-9, 9, 401)
    weight = np.exp(-0.5 * x**2) * (x[1] - x[0]) / np.sqrt(2 * np.pi)
    u = 1e-6 * np.exp(1.3 * x / 3)
    assert medium(u, weight) == pytest.approx(1e-6, rel=1e-10)


def test_limits_of_n_are_the_harmonic_and_arithmetic_mean():
    u, weight = np.array([1e-6, 2e-6, 5e-6]), np.array([0.2, 0.5, 0.3])
    assert medium(u, weight, n=1 + 1e-9) ** 3 == pytest.approx(1 / np.sum(weight / u**3), rel=1e-7)
    assert medium(u, weight, n=1e9) ** 3 == pytest.approx(np.sum(weight * u**3), rel=1e-7)


def test_uniform_scaling_and_wide_open_area():
    u, weight = np.array([1e-6, 3e-6]), np.array([0.6, 0.4])
    assert medium(10 * u, weight) == pytest.approx(10 * medium(u, weight), rel=1e-10)
    assert medium(u, 0.9 * weight, wide_open=0.1) > medium(u, weight)


def test_threshold_is_that_of_the_area():
    contact = surface()
    assert contact.contact_area(contact.sealing_pressure) == pytest.approx(0.42, rel=1e-12)
    assert surface(percolation_threshold=0.5).sealing_pressure > contact.sealing_pressure
    p = contact.sealing_pressure * np.array([0.5, 0.9, 1.0, 1.1, 5.0])
    u, u_c = contact.effective_separation(p), contact.critical_separation(p)
    assert np.all(u[:2] > 0)
    assert np.all(u[2:] == 0)
    assert np.all(u_c[2:] == 0)
    assert contact.flow_conductivity(p[-1], 1e-3) == 0.0


@pytest.mark.parametrize("softness", [3e2, 3e3, 4e4])
def test_what_plastic_flow_leaves_of_a_soft_surface_is_resolved(softness):
    """Where little roughness is left, P(u) is far narrower than the rms height: u_eff is the mean separation."""
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=61e-6, hurst=0.93, q_low=87.0, q_rolloff=7.1e3, q_high=1.45e4
    )
    surface = leak.RoughContact(spectrum, effective_modulus=16e9, hardness=16e9 / softness)
    p = surface.hardness * np.geomspace(1e-45, 1e-2, 40)
    u, mean = surface.effective_separation(p), surface.mean_separation(p)
    assert np.all(np.diff(u) < 0.0)
    # the narrower P(u), the nearer: its spread falls from 0.4 of the mean at 0.01 of the hardness to 0.03 at 1e-45
    assert np.all(np.abs(u / mean - 1.0) < 0.13)
    assert abs(u[0] / mean[0] - 1.0) < 1e-3
    np.testing.assert_allclose(surface.effective_separation(p, refinement=4), u, rtol=1e-4)
    table = surface.conductivity_table(1e-9 * surface.hardness, 0.1 * surface.hardness)
    assert np.all(np.diff(table.separation) < 0.0)


def test_sealing_pressure_of_a_plastic_surface_is_below_the_hardness():
    contact = surface(hardness=HARDNESS)
    assert 0.419 * HARDNESS < contact.sealing_pressure < 0.42 * HARDNESS
    assert contact.effective_separation(contact.sealing_pressure * 1.001) == 0.0
    assert contact.effective_separation(contact.sealing_pressure * 0.85) > 1e-9


# ------------------------------------------------------------------ convergence of every internal grid

SPECTRA = {
    "paper": spectrum(),
    "no roll-off": spectrum(hurst=0.8, q_low=1e4, q_rolloff=1e4, q_high=1e8),
    "H 0.2": spectrum(hurst=0.2),
    "H 0.99, 8 decades": spectrum(hurst=0.99, q_low=1e2, q_rolloff=1e3, q_high=1e10),
    "H 0.5, 8 decades": spectrum(hurst=0.5, q_low=1e2, q_rolloff=1e4, q_high=1e10),
    "half a decade": spectrum(q_low=1e4, q_rolloff=1e4, q_high=3e4),
    "flat": spectrum(q_rolloff=3141592.6),
    "steep": leak.PowerSpectrum.from_table([1e3, 1e4, 1e5, 1e6], [1e-22, 1e-22, 1e-29, 1e-36]),
    "rugged table": leak.PowerSpectrum.from_table(
        np.geomspace(1e3, 3e6, 25),
        1e-22 / (1 + (np.geomspace(1e3, 3e6, 25) / 3e4) ** 3.4) * np.exp(0.3 * np.sin(np.arange(25.0) ** 2)),
    ),
    "sum": spectrum() + spectrum(rms_height=0.8e-6, hurst=0.8, q_low=2e3, q_rolloff=1e5, q_high=2e6),
}


@pytest.mark.parametrize("hardness_over_slope", [None, 0.05, 0.3])
@pytest.mark.parametrize("name", list(SPECTRA))
def test_doubling_every_grid_changes_less_than_1e_4(name, hardness_over_slope):
    C = SPECTRA[name]
    hardness = hardness_over_slope and hardness_over_slope * E * C.rms_slope
    contact = leak.RoughContact(C, effective_modulus=E, hardness=hardness)
    p = contact.sealing_pressure * np.array([1e-12, 1e-8, 1e-5, 1e-3, 0.01, 0.1, 0.2, 0.3])
    coarse, fine = contact.effective_separation(p), contact.effective_separation(p, refinement=2)
    np.testing.assert_allclose(coarse, fine, rtol=1e-4)


@pytest.mark.parametrize(("hurst", "octaves"), [(0.5, 1.6), (0.8, 1.6), (0.8, 3.3), (1.0, 3.3)])
def test_what_remains_above_each_magnification_of_a_soft_surface_is_resolved(hurst, octaves):
    """C_pl falls like exp(-pi^2 t), t = kappa M: its integral to the end is known in closed form."""
    soft = spectrum(hurst=hurst, q_low=1e4, q_rolloff=1e4, q_high=1e4 * 2**octaves)
    contact = leak.RoughContact(soft, effective_modulus=E, hardness=0.1 * E * soft.rms_slope)
    p = np.array([1e-3 * contact.hardness])
    seen = contact._roughness_at(p)
    nodes = magnification_nodes(soft, seen, p / E)
    rate = np.pi**2 * seen.kappa
    found = (nodes.to_end @ (nodes.moment_weight * np.exp(-rate * nodes.M)).T)[:, 0]
    M = nodes.M[0]
    exact = (np.exp(-rate * M) - np.exp(-rate * seen.last_loss)) / rate
    # up to 15 e-folds; the points below the first yielding are coarser, whatever yields
    at = seen.kappa * M < 1.5
    assert rate * M[at].max() > 13.0
    np.testing.assert_allclose(found[at], exact[at], rtol=3e-4)


@pytest.mark.parametrize("p", [1e5, 50e6, 8e8])
def test_a_plastic_surface_is_an_elastic_one_with_the_smoothed_spectrum(p):
    """Two ways to the moments of C_pl: the table of R(t), and exact power-law pieces of the sampled spectrum."""
    contact = surface(hardness=HARDNESS)
    smoothed = leak.RoughContact(contact.plastic_spectrum(p, spacing=0.002), effective_modulus=E)
    assert contact.mean_separation(p) == pytest.approx(smoothed.mean_separation(p), rel=2e-5)
    assert contact.critical_separation(p) == pytest.approx(smoothed.critical_separation(p), rel=1e-4)
    assert contact.effective_separation(p) == pytest.approx(smoothed.effective_separation(p), rel=1e-4)


# ------------------------------------------------------------------ table


@pytest.mark.parametrize("method", ["bruggeman", "critical-junction"])
@pytest.mark.parametrize("hardness", [None, HARDNESS])
def test_table_gives_what_the_surface_gives(hardness, method):
    contact = surface(hardness=hardness)
    table = contact.conductivity_table(1e4, 5e8, method=method)
    p = np.geomspace(1e4, 5e8, 41)
    np.testing.assert_allclose(
        table.effective_separation(p), contact.effective_separation(p, method), rtol=5e-5
    )
    low = np.geomspace(1e-30, 1e4, 25)  # below the table
    np.testing.assert_allclose(
        table.effective_separation(low), contact.effective_separation(low, method), rtol=2e-4
    )


@pytest.mark.parametrize("hardness", [None, HARDNESS])
def test_table_up_to_sealing(hardness):
    contact = surface(hardness=hardness)
    table = contact.conductivity_table(1e4, 1e12)
    p = contact.sealing_pressure * np.linspace(0.1, 0.9, 9)
    np.testing.assert_allclose(table.effective_separation(p), contact.effective_separation(p), rtol=1e-3)
    assert np.all(
        np.asarray(table.effective_separation(contact.sealing_pressure * np.array([1.0, 1.3, 9.0]))) == 0.0
    )


def test_table_entirely_above_sealing_is_sealed():
    contact = surface(hardness=HARDNESS)
    table = contact.conductivity_table(2e9, 3e9)
    assert np.all(np.asarray(table.effective_separation([2e9, 2.5e9, 3e9])) == 0.0)


@pytest.mark.parametrize("yielding", ["elastic", "conserved", "capped"])
def test_pressures_of_a_table_follow_from_its_error(yielding):
    """As good as what is stated, with fewer pressures than an even table of the same error would need."""
    contact = {
        "elastic": surface(),
        "conserved": surface(hardness=HARDNESS),
        "capped": surface(hardness=HARDNESS).capped,
    }[yielding]
    p = np.geomspace(3e2, 1e8, 31)
    exact = np.asarray(contact.effective_separation(p))
    table = contact.conductivity_table(1e2, 1e8)
    np.testing.assert_allclose(table.effective_separation(p), exact, rtol=1e-5)
    assert table.pressure.size < 45
    # the closer to sealing, the closer they stand
    near = contact.conductivity_table(1e2, 1e12)
    left = np.log1p(-near.pressure[near.pressure > 0.5 * near.sealing_pressure] / near.sealing_pressure)
    assert left.size > 10
    below = near.sealing_pressure * np.array([0.5, 0.7, 0.85])
    np.testing.assert_allclose(
        near.effective_separation(below), contact.effective_separation(below), rtol=3e-4
    )


def test_table_is_made_once_and_serves_every_fluid():
    table = surface(hardness=HARDNESS).conductivity_table(1e4, 1e8)
    assert surface(hardness=HARDNESS).conductivity_table(1e4, 1e8) is table
    assert table.at(2e-3)(1e6) == pytest.approx(0.5 * table.at(1e-3)(1e6), rel=1e-14)
    assert table.conductivity(1e6, 1e-3) == pytest.approx(
        table.effective_separation(1e6) ** 3 / 12e-3, rel=1e-14
    )
    assert table.effective_separation(0.0) == np.inf
    log_p = np.array([-1e4, np.log(1e6)])
    assert table.at_log_pressure(log_p)[0] > 1e3 * table.at_log_pressure(log_p)[1]


def test_table_says_what_it_does_not_hold():
    table = surface().conductivity_table(1e4, 1e8)
    with pytest.raises(leak.ConductivityError, match="p_max"):
        table.effective_separation(2e8)
    with pytest.raises(leak.ConductivityError, match="negative"):
        table.effective_separation([1e6, -1.0])
    for bad in ({"p_min": 0.0}, {"p_max": 1.0}, {"num": 3}, {"method": "percolation"}):
        arguments = {"p_min": 1e4, "p_max": 1e8, "num": 64, "method": "bruggeman"} | bad
        with pytest.raises(leak.ConductivityError, match=next(iter(bad))):
            surface().conductivity_table(**arguments)


# ------------------------------------------------------------------ the surface


@settings(max_examples=15, deadline=None)
@given(
    hurst=st.floats(0.1, 1.0),
    decades=st.floats(0.2, 6.0),
    hard=st.none() | st.floats(0.02, 3.0),
    low=st.floats(1e-9, 0.3),
)
def test_separations_fall_with_pressure(hurst, decades, hard, low):
    C = spectrum(hurst=hurst, q_rolloff=1e3 * 10 ** (decades / 3), q_high=1e3 * 10**decades)
    contact = leak.RoughContact(C, effective_modulus=E, hardness=hard and hard * E * C.rms_slope)
    p = contact.sealing_pressure * low * np.array([1.0, 1.5, 2.5])
    for values in (
        contact.mean_separation(p),
        contact.effective_separation(p),
        contact.critical_separation(p),
    ):
        assert np.all(np.diff(values) < 0)
        assert np.all(np.asarray(values) > 0)


def test_scalars_stay_scalars_and_shapes_are_kept():
    contact = surface(hardness=HARDNESS)
    for function in (
        contact.mean_separation,
        contact.effective_separation,
        contact.critical_separation,
        contact.contact_area,
        contact.plastic_area,
    ):
        assert isinstance(function(1e6), float)
        assert function(np.full((2, 3), 1e6)).shape == (2, 3)
    elastic = contact.elastic
    assert elastic.elastic is elastic
    assert contact.elastic.plastic_area(1e6) == 0.0
    assert contact.elastic == surface()
    assert hash(contact) == hash(surface(hardness=HARDNESS))


@pytest.mark.parametrize(
    "bad",
    [
        {"effective_modulus": 0.0},
        {"hardness": -1.0},
        {"percolation_threshold": 1.0},
        {"gamma": 0.0},
        {"separation_width": "narrow"},
    ],
)
def test_wrong_surface(bad):
    with pytest.raises(leak.LeakError, match=next(iter(bad))):
        leak.RoughContact(spectrum(), **({"effective_modulus": E} | bad))
    with pytest.raises(leak.SurfaceError, match="spectrum"):
        leak.RoughContact(3.0, effective_modulus=E)


@pytest.mark.parametrize("p", [-1.0, np.nan, np.inf])
def test_wrong_pressure(p):
    with pytest.raises(leak.SurfaceError, match="pressure"):
        surface().mean_separation(p)


def test_against_direct_numerical_solutions(reference):
    """Not this theory: boundary elements and Reynolds flow on random surfaces. How good the theory is, not the code."""
    rows = reference("direct_numerical.csv")
    for name in ("A", "B"):
        part = rows[rows["surface_set"] == name]
        q = (
            2
            * np.pi
            * np.array([1.0, part["rolloff_wavelengths_per_box"][0], part["cutoff_wavelengths_per_box"][0]])
        )
        C = leak.PowerSpectrum.self_affine(
            rms_height=1.0, hurst=float(part["hurst"][0]), q_low=q[0], q_rolloff=q[1], q_high=q[2]
        )
        C = leak.PowerSpectrum(C.wavenumber, C.density / C.rms_slope**2)
        contact = leak.RoughContact(C, effective_modulus=1.0)
        gap = contact.mean_separation(part["pressure_over_modulus_and_rms_slope"]) / C.rms_height
        assert np.all(np.abs(gap / part["mean_gap_over_rms_height"] - 1) < 0.12)
        flow = (contact.effective_separation(part["pressure_over_modulus_and_rms_slope"]) / C.rms_height) ** 3
        low = part["contact_area"] < 0.19
        assert np.all(np.abs(np.log(flow / part["conductivity_over_rms_height_cubed"]))[low] < np.log(1.35))


def test_a_table_of_scaled_heights_and_pressures_is_that_of_the_scaled_surface():
    """u_eff = h f(p/(E* h)): three times the heights at a fifth of the modulus, its curve taken along."""
    one = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    other = leak.PowerSpectrum(one.wavenumber, 9 * one.density)
    first = leak.RoughContact(one, effective_modulus=115e9).conductivity_table(1e5, 1e8)
    second = leak.RoughContact(other, effective_modulus=23e9).conductivity_table(0.6e5, 0.6e8)
    scaled = first.scaled(3.0, 0.6)
    p = np.geomspace(1e4, 0.99 * min(scaled.p_max, scaled.sealing_pressure), 60)
    # 6e-4 of sigma, the accuracy of either table, is 2e-4 of its cube root
    np.testing.assert_allclose(scaled.effective_separation(p), second.effective_separation(p), rtol=2e-4)
    # the curve that was taken along is the one that the scaled points have
    own = leak.ConductivityTable(
        scaled.pressure, scaled.separation, scaled.sealing_pressure, scaled.p_max, scaled.method
    )
    np.testing.assert_allclose(scaled.effective_separation(p), own.effective_separation(p), rtol=1e-12)
