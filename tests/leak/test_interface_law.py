"""Interface laws: consistency of gap, slope and inverse; the rough-surface law follows the theory everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from paper_surface import HARDNESS, surface

import leak


def laws() -> dict[str, object]:
    u = np.linspace(-1e-6, 4e-6, 40)
    return {
        "exponential": leak.ExponentialLaw(p_c=5e9, u0=1.1e-6),
        "tabulated": leak.TabulatedLaw(u, 1e9 * np.exp(-u / 6e-7 - 0.1 * (u / 1e-6) ** 2)),
        "elastic": surface(hardness=HARDNESS).interface_law(),
        "plastic": surface(hardness=HARDNESS).interface_law(plastic=True),
    }


@pytest.mark.parametrize("name", ["exponential", "tabulated", "elastic", "plastic"])
def test_slope_inverse_and_range(name):
    law = laws()[name]
    log_p = np.concatenate([[-1e5, -1e3, -100.0], np.linspace(-20, 24, 400)])
    u, decay = law.gap(log_p), law.decay_length(log_p)
    assert u.shape == decay.shape == log_p.shape
    assert np.all(np.isfinite(u))
    assert np.all(decay > 0)
    assert np.all(np.diff(u) < 0)
    usual = log_p > -600
    np.testing.assert_allclose(np.log(law.pressure(u[usual])), log_p[usual], rtol=1e-11, atol=1e-11)
    assert law.pressure(u[0]) == 0.0  # underflows, without a warning
    # The slope is the derivative of the gap, continuously: central differences across every node.
    x = np.linspace(-20, 21.5, 5001)
    h = 1e-5
    slope = (law.gap(x - h) - law.gap(x + h)) / (2 * h)
    np.testing.assert_allclose(
        law.decay_length(x), slope, rtol=1e-4
    )  # C1: curvature jumps within h of a node


def test_elastic_law_follows_the_theory():
    contact = surface()
    law = contact.interface_law()
    log_p = np.linspace(np.log(1e-4), np.log(2e10), 173)
    np.testing.assert_allclose(law.gap(log_p), contact.mean_separation(np.exp(log_p)), rtol=1e-7)
    far = np.array([-80.0, -500.0, -1e5])
    np.testing.assert_allclose(law.gap(far), contact.u0 * (np.log(contact.p_c) - far), rtol=1e-6)
    assert law.u0 == pytest.approx(contact.u0, rel=1e-6)
    assert law.p_c == pytest.approx(contact.p_c, rel=1e-5)


def test_plastic_law_follows_the_theory():
    contact = surface(hardness=HARDNESS)
    law = contact.interface_law(plastic=True)
    p = np.concatenate([np.geomspace(1e-4, 3e9, 101), HARDNESS * np.array([0.88, 0.9, 0.93])])
    np.testing.assert_allclose(law.gap(np.log(p)), contact.mean_separation(p), rtol=2e-5)
    assert law.u0 < contact.interface_law().u0  # plastic flow takes the short waves away: softer no more


def test_law_ratios_of_the_paper():
    """u0/h_rms 0.60 elastic and 0.38 plastic for the paper's surface."""
    assert surface(hardness=HARDNESS).interface_law().u0 / 1.9e-6 == pytest.approx(0.596, abs=2e-3)
    assert surface(hardness=HARDNESS).interface_law(plastic=True).u0 / 1.9e-6 == pytest.approx(0.38, abs=5e-3)


def test_law_goes_on_toward_full_contact():
    law = surface().interface_law()
    log_p = np.log(np.array([1e11, 1e12, 1e14, 1e20]))
    u = law.gap(log_p)
    assert np.all(u >= 0)
    assert np.all(np.diff(u) <= 0)
    assert law.pressure(0.0) == np.inf
    assert law.pressure(-1e-6) == np.inf
    assert law.pressure(np.inf) == 0.0


def test_pressure_is_the_inverse_of_mean_separation():
    for contact in (surface(hardness=HARDNESS), surface()):
        p = np.array([1e2, 1e6, 5e8])
        np.testing.assert_allclose(contact.pressure(contact.mean_separation(p)), p, rtol=1e-4)
        assert isinstance(contact.pressure(1e-6), float)


def test_law_is_made_once():
    assert surface(hardness=HARDNESS).interface_law() is surface().interface_law()
    with pytest.raises(leak.SurfaceError, match="hardness"):
        surface().interface_law(plastic=True)


def test_tabulated_law_of_the_reference(greenwood_williamson):
    law = greenwood_williamson
    u, p = law.table_gap, law.table_pressure
    np.testing.assert_allclose(law.pressure(u), p, rtol=1e-12)
    np.testing.assert_allclose(law.gap(np.log(p)), u, atol=1e-15)
    between = 0.5 * (u[1:] + u[:-1])
    inside = law.pressure(between)
    assert np.all((inside < p[:-1]) & (inside > p[1:]))
    # Beyond both ends ln p is straight.
    for start, step in ((u[0], -1e-7), (u[-1], 1e-7)):
        log_p = np.log(law.pressure(start + step * np.arange(4)))
        np.testing.assert_allclose(np.diff(log_p), np.diff(log_p)[0], rtol=1e-9)


def test_tabulated_exponential_is_exponential():
    exact = leak.ExponentialLaw(p_c=1e9, u0=0.8e-6)
    u = np.sort(np.random.default_rng(3).uniform(0, 8e-6, 30))
    law = leak.TabulatedLaw(u, exact.pressure(u))
    log_p = np.linspace(-1e3, 25, 50)
    np.testing.assert_allclose(law.gap(log_p), exact.gap(log_p), rtol=1e-11, atol=1e-16)
    np.testing.assert_allclose(law.decay_length(log_p), 0.8e-6, rtol=1e-10)


@pytest.mark.parametrize(
    ("u", "p", "says"),
    [
        ([0.0], [1.0], "at least 2"),
        ([0.0, 1e-6], [1.0], "shape"),
        ([1e-6, 0.0], [1e6, 1e5], "gap"),
        ([0.0, 1e-6], [1e5, 1e6], "pressure"),
        ([0.0, 1e-6], [1e5, 0.0], "pressure"),
        ([0.0, np.nan], [1e6, 1e5], "gap"),
        (["a", "b"], [1e6, 1e5], "numbers"),
    ],
)
def test_wrong_table(u, p, says):
    with pytest.raises(leak.LawError, match=says):
        leak.TabulatedLaw(u, p)


def test_wrong_exponential():
    with pytest.raises(leak.LawError, match="u0"):
        leak.ExponentialLaw(p_c=1e9, u0=0.0)
    with pytest.raises(leak.LawError, match="p_c"):
        leak.ExponentialLaw(p_c=-1e9, u0=1e-6)
