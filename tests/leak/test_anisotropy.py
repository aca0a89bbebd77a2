"""Flow through stretched roughness: limits, duality, Tripp's perturbation, flow solved on random fields, two scans."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import HARDNESS, spectrum, surface

import leak

NONE = np.zeros(1)


def lognormal(spread: float = 1.3) -> tuple[np.ndarray, np.ndarray]:
    """Separations and shares of a log-normal u^3 of geometric mean (1 um)^3."""
    x = np.linspace(-9, 9, 401)
    weight = np.exp(-0.5 * x**2) * (x[1] - x[0]) / np.sqrt(2 * np.pi)
    return 1e-6 * np.exp(spread * x[None, :] / 3), weight[None, :]


def conductivities(peklenik: float, *, contact: float = 0.0, threshold: float = 0.42) -> tuple[float, float]:
    """s_x and s_y of the log-normal gap with a fraction in contact, in units of its geometric mean."""
    u, weight = lognormal()
    n = leak.dimension_number(threshold)
    gaps = leak.anisotropic_medium(u, (1 - contact) * weight, NONE + contact, NONE, n, peklenik)
    return tuple(float(gap[0] * 1e6) ** 3 for gap in gaps)


# ------------------------------------------------------------------ the medium


@settings(max_examples=40, deadline=None)
@given(log_gamma=st.floats(-6, 6), contact=st.floats(0.0, 0.41), threshold=st.floats(0.42, 0.9))
def test_both_equations_are_met(log_gamma, contact, threshold):
    """s_x and s_y put back into the two equations, as they stand."""
    gamma, k = np.exp(log_gamma), threshold / (1 - threshold)
    s_x, s_y = conductivities(gamma, contact=contact, threshold=threshold)
    u, weight = lognormal()
    sigma, P = np.append(0.0, (u[0] * 1e6) ** 3), np.append(contact, (1 - contact) * weight[0])
    for s, n in (
        (s_x, 1 / (1 + k * gamma * np.sqrt(s_y / s_x))),
        (s_y, 1 / (1 + k / gamma * np.sqrt(s_x / s_y))),
    ):
        terms = P * (sigma - s) / (s + n * (sigma - s))
        # near the threshold s is a small difference of large terms
        assert abs(terms.sum()) < 1e-7 * np.abs(terms).sum()


@settings(max_examples=30, deadline=None)
@given(log_gamma=st.floats(-6, 6), contact=st.floats(0.0, 0.4))
def test_the_other_direction_is_the_inverse_number(log_gamma, contact):
    along, across = conductivities(np.exp(log_gamma), contact=contact)
    swapped = conductivities(np.exp(-log_gamma), contact=contact)
    assert swapped == pytest.approx((across, along), rel=1e-9)
    assert (along >= across) == (log_gamma >= 0) or along == pytest.approx(across, rel=1e-9)


def test_isotropic_limit_is_the_isotropic_medium():
    u, weight = lognormal()
    n = leak.dimension_number(0.42)
    for contact in (0.0, 0.3):
        same = leak.effective_medium(u, (1 - contact) * weight, NONE + contact, NONE, n)
        exact = leak.anisotropic_medium(u, (1 - contact) * weight, NONE + contact, NONE, n, 1.0)
        near = leak.anisotropic_medium(u, (1 - contact) * weight, NONE + contact, NONE, n, 1.0 + 1e-10)
        assert exact.along == same == exact.across
        assert near.along == pytest.approx(same, rel=1e-9)


def test_limits_of_endless_ridges():
    """Arithmetic mean along, harmonic mean across."""
    u, weight = lognormal()
    arithmetic, harmonic = (weight * u**3).sum() * 1e18, 1e18 / (weight / u**3).sum()
    for threshold in (0.42, 0.5):
        along, across = conductivities(1e10, threshold=threshold)
        assert along == pytest.approx(arithmetic, rel=1e-6)
        assert across == pytest.approx(harmonic, rel=1e-6)


def test_endless_ridges_with_contact_keep_the_threshold():
    """The harmonic mean is zero then; along the ridges an isotropic medium with n = 1/n_x = 1 + k^2 (1-a)/a."""
    u, weight = lognormal()
    a = 0.3
    along, across = conductivities(1e6, contact=a)
    limit = leak.effective_medium(u, (1 - a) * weight, NONE + a, NONE, 1 + (0.42 / 0.58) ** 2 * (1 - a) / a)
    assert along == pytest.approx(float(limit[0] * 1e6) ** 3, rel=1e-5)
    assert across < 1e-9


@pytest.mark.parametrize("gamma", [0.2, 1.0, 6.0])
def test_both_directions_percolate_together(gamma):
    below = np.array(conductivities(gamma, contact=0.42 - 1e-6))
    assert np.all(below > 0)
    assert below[0] / below[1] == pytest.approx(gamma**2, rel=1e-4)
    assert conductivities(gamma, contact=0.42 + 1e-9) == (0.0, 0.0)


@pytest.mark.parametrize("gamma", [0.05, 3.0, 40.0])
def test_duality(gamma):
    """Keller and Mendelson: rotating the field of flow by 90 deg turns sigma into 1/sigma; textbook k = 1."""
    along, across = conductivities(gamma, threshold=0.5)
    assert along * across == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("gamma", [1 / 6, 1.0, 2.0, 9.0])
def test_tripps_perturbation(gamma):
    """J. H. Tripp, J. Lubr. Technol. 105, 458 (1983): 1 + 3 (gamma - 2)/(gamma + 1) (h/u)^2 for small roughness."""
    h = 1e-3
    x = np.linspace(-6, 6, 201)
    weight = np.exp(-0.5 * x**2)[None, :] / np.exp(-0.5 * x**2).sum()
    gap = leak.anisotropic_medium(1.0 + h * x[None, :], weight, NONE, NONE, 2.0, gamma).along[0]
    # next term of the order h^2 relative to this one; ln u^3 itself is good to 1e-11 of h^2 = 1e-6
    assert (gap**3 - 1) / h**2 == pytest.approx(3 * (gamma - 2) / (gamma + 1), abs=1e-4)


@pytest.mark.slow
def test_flow_solved_on_random_stretched_fields():
    """Not this theory: Reynolds flow on log-normal fields of elliptic correlation, both directions, k = 1."""
    gamma, spread = 4.0, 1.0
    flows = np.array([_solved(_field(gamma, seed), spread) for seed in range(3)])
    along, across = np.exp(np.log(flows).mean(axis=0))
    u, weight = lognormal(spread)
    gaps = leak.anisotropic_medium(u, weight, NONE, NONE, 2.0, gamma)
    # fields of 16 by 64 correlation cells scatter by some per cent; isotropic flow would be 1 in both directions
    assert along == pytest.approx(float(gaps.along[0] * 1e6) ** 3, rel=0.05)
    assert across == pytest.approx(float(gaps.across[0] * 1e6) ** 3, rel=0.05)
    assert along > 1.25
    assert across < 0.8


def _field(gamma: float, seed: int, n: int = 256) -> np.ndarray:
    """Gaussian field of unit variance, periodic, correlation length along the first axis gamma times the other."""
    q, length = 2 * np.pi * np.fft.fftfreq(n), 5.0
    smooth = np.exp(-0.5 * length**2 * (gamma * q[:, None] ** 2 + q[None, :] ** 2 / gamma))
    noise = np.random.default_rng(seed).standard_normal((n, n))
    field = np.fft.ifft2(np.fft.fft2(noise) * smooth).real
    return (field - field.mean()) / field.std()


def _solved(field: np.ndarray, spread: float) -> tuple[float, float]:
    """Conductivity along and across of sigma = exp(spread * field), finite volumes, no flow through the sides."""
    sigma = np.exp(spread * field)
    return _through(sigma), _through(sigma.T)


def _through(sigma: np.ndarray) -> float:
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    index = np.arange(sigma.size).reshape(sigma.shape)
    rows, columns, values = [], [], []
    for a, b, s, t in (
        (index[:-1], index[1:], sigma[:-1], sigma[1:]),
        (index[:, :-1], index[:, 1:], sigma[:, :-1], sigma[:, 1:]),
    ):
        link = (2 / (1 / s + 1 / t)).ravel()
        a, b = a.ravel(), b.ravel()
        rows += [a, b, a, b]
        columns += [a, b, b, a]
        values += [link, link, -link, -link]
    ends = 2 * np.concatenate([sigma[0], sigma[-1]])
    nodes = np.concatenate([index[0], index[-1]])
    matrix = coo_array(
        (np.concatenate([*values, ends]), (np.concatenate([*rows, nodes]), np.concatenate([*columns, nodes])))
    ).tocsc()
    load = np.zeros(sigma.size)
    load[index[0]] = 2 * sigma[0]
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    p = factors.solve(load)
    return float((2 * sigma[0] * (1 - p[index[0]])).sum())


# ------------------------------------------------------------------ the surface


def test_contact_mechanics_knows_no_direction():
    turned = surface(hardness=HARDNESS, peklenik=0.2)
    plain = surface(hardness=HARDNESS)
    for name in ("contact_area", "mean_separation", "critical_separation"):
        assert getattr(turned, name)(50e6) == getattr(plain, name)(50e6)
    assert turned.sealing_pressure == plain.sealing_pressure


def test_isotropic_surface_is_unchanged_to_the_last_bit():
    p = np.geomspace(1e4, 5e8, 9)
    assert np.array_equal(surface(peklenik=1.0).effective_separation(p), surface().effective_separation(p))
    near = surface(peklenik=1.0 + 1e-12).effective_separation(p)
    np.testing.assert_allclose(near, surface().effective_separation(p), rtol=1e-9)


@pytest.mark.parametrize("hardness", [None, HARDNESS])
def test_more_flows_along_the_lay_than_across(hardness):
    p = surface(hardness=hardness).sealing_pressure * np.array([1e-6, 1e-3, 0.05, 0.25, 0.5, 0.9])
    u = np.array(
        [surface(hardness=hardness, peklenik=g).effective_separation(p) for g in (0.1, 0.5, 1, 2, 10)]
    )
    assert np.all(np.diff(u[:4], axis=0) > 0)
    # more along a longer lay only while little touches: direct results at p/(E* h') = 0.1, a third of the sealing
    # pressure, show less along one of 10 than along one of 3, since more of it touches
    assert np.all(u[4, :4] > u[3, :4])
    assert np.all(u[4] > u[0])
    # from nearly nothing where the gap is wide to gamma^4 where it closes
    ratio = (u[-1] / u[0]) ** 3
    assert np.all(np.diff(ratio) > 0)
    assert 1 < ratio[0] < 1.3
    assert ratio[-1] < 100**4


@settings(max_examples=6, deadline=None)
@given(
    log_gamma=st.floats(-4.5, 4.5),
    hurst=st.floats(0.3, 1.0),
    log_width=st.floats(0.7, 4.6),
    ratio=st.one_of(st.none(), st.floats(0.03, 1.0)),
)
def test_flow_falls_with_pressure_whatever_the_lay(log_gamma, hurst, log_width, ratio):
    rough = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=hurst, q_low=1e4, q_rolloff=3e4, q_high=3e4 * np.exp(log_width)
    )
    hardness = None if ratio is None else ratio * 1e11 * rough.rms_slope
    contact = leak.RoughContact(rough, effective_modulus=1e11, hardness=hardness, peklenik=np.exp(log_gamma))
    p = contact.sealing_pressure * np.array([1e-6, 1e-3, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.88])
    u = np.asarray(contact.effective_separation(p))
    assert np.all(np.diff(u) < 0)
    assert np.all(u > 0)


def test_scale_of_a_stretched_surface_does_not_matter():
    """All lengths times three, and pressures with modulus and hardness times seven."""
    small = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.7, q_low=1e4, q_rolloff=3e4, q_high=1e6)
    large = leak.PowerSpectrum(small.wavenumber / 3, small.density * 3**4)
    first = leak.RoughContact(small, effective_modulus=1e11, hardness=3e9, peklenik=0.2)
    second = leak.RoughContact(large, effective_modulus=7e11, hardness=2.1e10, peklenik=0.2)
    p = np.geomspace(1e5, 1e9, 7)
    np.testing.assert_allclose(
        np.asarray(second.effective_separation(7 * p)),
        3 * np.asarray(first.effective_separation(p)),
        rtol=1e-6,
    )


def test_longer_patches_and_more_of_them():
    from leak.flow.medium import inclusion_aspect, touching_pressure

    for share in (0.0, 0.3, 1.0):
        assert inclusion_aspect(1.0, share) == touching_pressure(1.0, share) == 1.0
        assert inclusion_aspect(0.2, share) * inclusion_aspect(5.0, share) == pytest.approx(1.0, rel=1e-14)
        assert touching_pressure(0.2, share) == pytest.approx(float(touching_pressure(5.0, share)), rel=1e-14)
    # nothing touches: heights alone; nothing is open: the sealing pressure of the theory
    assert inclusion_aspect(7.0, 0.0) == 7.0
    assert touching_pressure(7.0, 1.0) == 1.0


def test_gas_meets_the_same_patches():
    """A gas so dense that its molecules do not matter flows like a liquid."""
    contact, p = surface(peklenik=0.2), np.array([1e7, 1e9])
    u, log_rarefaction = contact.rarefied_separation(p, np.log(np.array([1e9])))
    np.testing.assert_allclose(u, contact.effective_separation(p), rtol=1e-9)
    np.testing.assert_allclose(log_rarefaction, 0.0, atol=1e-6)


@pytest.mark.parametrize("contact", [0.05, 0.3, 0.41])
@pytest.mark.parametrize("gamma", [0.1, 1.0, 30.0])
def test_it_does_not_matter_where_the_iteration_begins(gamma, contact):
    """Above all where little is left open and the start says that much more passes one way than can."""
    u, weight = lognormal()
    medium = u, (1 - contact) * weight, NONE + contact, NONE, 1 / 0.58, gamma
    alone = np.array(leak.anisotropic_medium(*medium))
    for along, across in ((1e-6, 1e-6), (1e-9, 1e-3), (1e-3, 1e-9), (1e-12, 1e-12)):
        near = leak.DirectionalGap(NONE + along, NONE + across)
        np.testing.assert_allclose(leak.anisotropic_medium(*medium, near), alone, rtol=1e-9)


def test_aspects_on_both_sides_of_one_are_refused():
    u, weight = np.vstack([lognormal()[0]] * 2), np.vstack([lognormal()[1]] * 2)
    both = np.array([0.5, 2.0])
    with pytest.raises(leak.ConductivityError, match="one side of 1"):
        leak.anisotropic_medium(u, weight, np.zeros(2), np.zeros(2), 2.0, both)
    # an array is each of its numbers
    found = leak.anisotropic_medium(u, weight, np.zeros(2), np.zeros(2), 2.0, both + 1.0)
    for n, gamma in enumerate(both + 1.0):
        alone = leak.anisotropic_medium(u[:1], weight[:1], NONE, NONE, 2.0, gamma)
        assert found.along[n] == pytest.approx(alone.along[0], rel=1e-9)


@pytest.mark.parametrize("gamma", [0.05, 0.3, 4.0, 100.0])
@pytest.mark.parametrize("hardness", [None, HARDNESS])
def test_table_of_a_stretched_surface(hardness, gamma):
    contact = surface(hardness=hardness, peklenik=gamma)
    table = contact.conductivity_table(1e4, 5e8)
    p = np.geomspace(1e2, 5e8, 31)
    np.testing.assert_allclose(table.effective_separation(p), contact.effective_separation(p), rtol=3e-4)
    assert table.effective_separation(contact.sealing_pressure) == 0.0
    assert table is not surface(hardness=hardness).conductivity_table(1e4, 5e8)


def test_wrong_numbers():
    for wrong in (0.0, -1.0, 1e-4, 1e4, np.nan):
        with pytest.raises(leak.SurfaceError, match="peklenik"):
            surface(peklenik=wrong)
    with pytest.raises(leak.ConductivityError, match="has no direction"):
        surface(peklenik=2.0).effective_separation(1e6, "critical-junction")
    with pytest.raises(leak.ConductivityError, match="has no direction"):
        surface(peklenik=2.0).conductivity_table(1e4, 1e6, method="critical-junction")


# ------------------------------------------------------------------ two directional spectra


def directional(gamma: float) -> tuple[leak.PowerSpectrum, leak.PowerSpectrum]:
    """What scans along and across a stretched surface give, in closed form."""
    C, root = spectrum(), np.sqrt(gamma)
    return (
        leak.PowerSpectrum(C.wavenumber / root, C.density * gamma),
        leak.PowerSpectrum(C.wavenumber * root, C.density / gamma),
    )


@pytest.mark.parametrize("gamma", [0.05, 0.4, 1.0, 3.0, 30.0])
def test_two_scans_of_a_stretched_surface(gamma):
    along, across = directional(gamma)
    found = leak.stretched_roughness(along, across)
    assert found.peklenik == pytest.approx(gamma, rel=1e-6)
    assert found.misfit < 1e-6
    assert found.spectrum.rms_height == pytest.approx(1.9e-6, rel=1e-9)
    assert across.rms_slope / along.rms_slope == pytest.approx(gamma, rel=1e-9)
    # nodes 2 % apart stand for the average of a power law with a sharp end
    slope2 = (spectrum().rms_slope ** 2) * 0.5 * (gamma + 1 / gamma)
    assert found.spectrum.rms_slope**2 == pytest.approx(slope2, rel=1e-3)


def test_scans_of_limited_range_give_the_number_all_the_same():
    along, across = (
        leak.PowerSpectrum.from_table(q, C(q)) for C in directional(5.0) for q in [np.geomspace(3e3, 1e6, 60)]
    )
    assert leak.stretched_roughness(along, across).peklenik == pytest.approx(5.0, rel=0.02)


def test_scans_of_a_random_map():
    """From the profiles of a made map, both ways through it, back to the number it was made with."""
    heights = leak.random_map(
        spectrum(q_low=2e4, q_rolloff=1e5, q_high=1.5e6), size=1e-3, points=512, seed=4, peklenik=4.0
    )
    x = 1e-3 / 512 * np.arange(512)
    settings = leak.ScanSettings(window="none", detrend="mean")
    along, across = (
        leak.measure([leak.line_scan(x, row) for row in rows[::16]], settings).spectrum
        for rows in (heights.T, heights)
    )
    found = leak.stretched_roughness(along, across)
    # 32 profiles in each direction
    assert found.peklenik == pytest.approx(4.0, rel=0.15)
    assert found.spectrum.rms_height == pytest.approx(heights.std(), rel=0.05)


def test_angular_average_of_a_power_law():
    """C_0 ~ q^-4 in the middle of its range: (gamma + 1/gamma)/2 of itself."""
    C = leak.PowerSpectrum.from_table([1e2, 1e8], [1e-10, 1e-34])
    average = leak.stretched_spectrum(C, 3.0)
    assert average(1e5) / C(1e5) == pytest.approx(0.5 * (3 + 1 / 3), rel=1e-3)
    assert leak.stretched_spectrum(C, 1 / 3.0)(1e5) == pytest.approx(average(1e5), rel=1e-12)


def test_scans_without_common_waves():
    low = leak.PowerSpectrum.from_table([1e3, 1e4], [1e-20, 1e-22])
    high = leak.PowerSpectrum.from_table([1.5e4, 1e5], [1e-22, 1e-24])
    with pytest.raises(leak.SpectrumError, match="common wavenumbers"):
        leak.stretched_roughness(low, high)
