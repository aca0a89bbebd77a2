"""Flow across and around a ring: exact two-dimensional solutions, order of convergence, sealed places, gases."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import leak

S, DROP = 1e-15, 2e6


def angles(k: int) -> np.ndarray:
    return 2 * np.pi * np.arange(k) / k


def self_dual(m: int, k: int, a: float, stretch: float = 0.0, flat: bool = False):
    """x, r, sigma on a ring whose half is a square, sigma -> 1/sigma when it is turned by a right angle.

    In two dimensions C_x(sigma) C_y(1/sigma) = 1 (J. B. Keller, J. Math. Phys. 5, 548 (1964)): the conductance of the
    half is S exactly, that of the ring 2 S. On a flat ring x = r the same holds over ln r, which maps it conformally.
    """
    t = np.linspace(0.0, 1.0, m)
    t = t + stretch * np.sin(2 * np.pi * t) / (2 * np.pi)
    sigma = S * np.exp(a * np.cos(np.pi * t)[:, None] * np.cos(angles(k) + 0.3))
    if flat:
        r = 1e-3 * np.exp(np.pi * t)
        return r, r, sigma
    return 0.01 * np.pi * t, 0.01, sigma


@pytest.mark.parametrize("stretch", [0.0, 0.6])
@pytest.mark.parametrize("flat", [False, True])
def test_second_order_towards_the_exact_dual_solution(stretch, flat):
    errors = []
    for m, k in [(21, 40), (41, 80), (81, 160)]:
        x, r, sigma = self_dual(m, k, 2.0, stretch, flat)
        errors.append(leak.around_flow(x, r, sigma, DROP).leak_rate / (2 * S * DROP) - 1.0)
    orders = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert abs(errors[-1]) < 3e-3
    assert orders == pytest.approx(2.0, abs=0.15)


def test_exact_over_thirty_decades():
    """Nearly all of the flow goes round; the error still is that of second order."""
    errors = []
    for m, k in [(81, 160), (161, 320)]:
        x, r, sigma = self_dual(m, k, 0.5 * np.log(1e30))
        found = leak.around_flow(x, r, sigma, DROP)
        assert found.radial_leak_rate < 0.05 * found.leak_rate
        errors.append(found.leak_rate / (2 * S * DROP) - 1.0)
    assert abs(errors[1]) < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("side", ["outer", "inner"])
def test_what_flows_in_flows_out(side):
    x, r, sigma = self_dual(41, 60, 5.0, 0.4)
    found = leak.around_flow(x, r, sigma, DROP, pressure_side=side)
    step = 2 * np.pi / 60
    assert found.inlet_flow.sum() * step == pytest.approx(found.leak_rate, rel=1e-12)
    assert found.outlet_flow.sum() * step == pytest.approx(found.leak_rate, rel=1e-12)
    high, low = (-1, 0) if side == "outer" else (0, -1)
    np.testing.assert_array_equal(found.fluid_pressure[high], DROP)
    np.testing.assert_array_equal(found.fluid_pressure[low], 0.0)


def test_the_same_all_around_is_the_leak_integral():
    s, r0 = 0.139e-3, 0.0141421
    x = np.linspace(-3.5, 3.5, 1401) * s
    p = 50e6 * np.exp(-0.5 * (x / s) ** 2)
    radius = r0 + 0.7 * x
    line = leak.leak_flow(x, p, lambda p: 1e-9 / p, DROP, radius, ends=(x[0], x[-1]))
    found = leak.around_flow(x, radius, np.tile((1e-9 / p)[:, None], 6), DROP)
    assert found.leak_rate == pytest.approx(line.leak_rate, rel=2e-5)  # trapezoidal rule, 1400 steps
    assert found.detour == pytest.approx(0.0, abs=1e-12 * found.leak_rate)
    np.testing.assert_allclose(found.fluid_pressure[:, 3], line.fluid_pressure, atol=2e-5 * DROP)


def test_sigma_of_the_angle_alone_averages():
    """Nothing goes round: the pressure is linear in x everywhere."""
    sigma = S * np.exp(8 * np.cos(angles(24)))
    found = leak.around_flow(np.linspace(0, 1e-3, 30), 0.01, np.tile(sigma, (30, 1)), DROP)
    assert found.leak_rate == pytest.approx(2 * np.pi * 0.01 * sigma.mean() * DROP / 1e-3, rel=1e-12)
    np.testing.assert_allclose(found.inlet_flow, 0.01 * sigma * DROP / 1e-3, rtol=1e-11)
    np.testing.assert_allclose(found.radial_flow, found.outlet_flow, rtol=1e-11)


def test_separable_conductivity_of_x_and_angle_does_not_go_round():
    """sigma = f(x) g(phi): p(x) alone solves the equation."""
    x = np.linspace(0, 1e-3, 40)
    f, g = np.exp(20 * np.cos(3e3 * x)), 1.0 + 0.9 * np.sin(angles(16))
    found = leak.around_flow(x, 0.01, S * f[:, None] * g, DROP)
    # 17 decades over x: what is wide open counts as 1e9 times the whole, 39 steps of it
    np.testing.assert_allclose(found.radial_flow, found.inlet_flow, rtol=4e-8)
    assert found.leak_rate == pytest.approx(found.radial_leak_rate, rel=4e-8)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6), decades=st.floats(0.0, 30.0), zeros=st.floats(0.0, 0.6), k=st.integers(1, 12)
)
def test_fluid_that_may_go_round_leaks_at_least_as_much(seed, decades, zeros, k):
    rng = np.random.default_rng(seed)
    m = 9
    x = np.cumsum(rng.uniform(0.1, 1.0, m)) * 1e-4
    sigma = 10.0 ** rng.uniform(-12 - decades, -12, (m, k)) * (rng.uniform(size=(m, k)) >= zeros)
    found = leak.around_flow(x, 0.01 + x, sigma, DROP)
    assert np.isfinite(found.leak_rate)
    assert found.leak_rate >= found.radial_leak_rate * (1 - 1e-7)
    known = found.fluid_pressure[~np.isnan(found.fluid_pressure)]
    assert np.all((known >= 0.0) & (known <= DROP))
    mixed = 1.0 / np.sum(1.0 / np.maximum(_links(x, 0.01 + x, sigma).sum(axis=1), 1e-300))
    assert found.leak_rate <= mixed * DROP * 2 * np.pi / k * (1 + 1e-7)
    turned = leak.around_flow(x, 0.01 + x, np.roll(sigma, 3, axis=1), DROP)
    assert turned.leak_rate == pytest.approx(found.leak_rate, rel=1e-6)
    step = 2 * np.pi / k
    for edge in (found.inlet_flow, found.outlet_flow):
        assert edge.sum() * step == pytest.approx(found.leak_rate, rel=1e-6)


def _links(x: np.ndarray, r: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        resistance = 1.0 / (r[:, None] * sigma)
    return 2.0 / (resistance[1:] + resistance[:-1]) / np.diff(x)[:, None]


def test_two_seal_lines_with_an_open_groove_between():
    """The gap between opens 20 decades: its pressure is one, and each line is a mean over its own angles."""
    m, k = 61, 16
    x = np.linspace(0.0, 1e-3, m)
    inner, outer = S * (1 + 0.9 * np.cos(angles(k))), 3 * S * (1 + 0.9 * np.cos(angles(k) - 2.0))
    sigma = np.full((m, k), 1e20 * S)
    sigma[10:15], sigma[40:50] = inner, outer
    found = leak.around_flow(x, 0.01, sigma, DROP)
    h = x[1] - x[0]
    # a tight row reaches half a step beyond its points, and the open neighbour takes none
    resistance = 5 * h / inner.mean() + 10 * h / outer.mean()
    assert found.leak_rate == pytest.approx(2 * np.pi * 0.01 * DROP / resistance, rel=1e-6)
    assert np.ptp(found.fluid_pressure[20:38]) < 1e-6 * DROP


def test_sealed_sector_and_sealed_ring():
    x = np.linspace(0.0, 1e-3, 31)
    sigma = np.full((31, 40), S)
    sigma[10:20, 5:15] = 0.0
    found = leak.around_flow(x, 0.01, sigma, DROP)
    assert np.all(found.radial_flow[5:15] == 0.0)
    assert found.detour > 0.0  # fluid closes in behind the sealed sector
    assert np.isnan(found.fluid_pressure[15, 10])
    sigma[15] = 0.0
    sealed = leak.around_flow(x, 0.01, sigma, DROP)
    assert sealed.leak_rate == 0.0 and sealed.radial_leak_rate == 0.0
    assert np.all(sealed.inlet_flow == 0.0) and np.all(sealed.outlet_flow == 0.0)
    np.testing.assert_array_equal(sealed.fluid_pressure[25], DROP)


def test_open_only_by_going_round():
    """Every angle is sealed at some x, the labyrinth is not: the exact resistance of a chain of places."""
    x = np.linspace(0.0, 3e-3, 4)
    sigma = np.zeros((4, 4))
    sigma[0, 0] = sigma[1, 0] = sigma[1, 1] = sigma[2, 1] = sigma[3, 1] = S
    found = leak.around_flow(x, 0.01, sigma, DROP)
    step = np.pi / 2
    across, around = 0.01 * S * step / 1e-3, S * 1e-3 / (0.01 * step)
    assert found.radial_leak_rate == 0.0
    assert found.leak_rate == pytest.approx(DROP / (3 / across + 1 / around), rel=1e-9)


# -------------------------------------------------------------------- gases

NITROGEN = leak.gas("nitrogen")


def test_gas_without_slip_follows_the_square_of_the_pressure():
    x, r, sigma = self_dual(41, 60, 3.0)
    gas = leak.gas_around_flow(x, r, sigma, NITROGEN, 3e5, 1e5)
    liquid = leak.around_flow(x, r, sigma, DROP)
    per_density = NITROGEN.specific_gas_constant * NITROGEN.temperature
    ratio = 0.5 * (3e5**2 - 1e5**2) / per_density / DROP
    assert gas.mass_flow == pytest.approx(liquid.leak_rate * ratio, rel=1e-12)
    np.testing.assert_allclose(gas.inlet_flow, liquid.inlet_flow * ratio, rtol=1e-12)
    squares = 1e10 + (9e10 - 1e10) * liquid.fluid_pressure / DROP
    np.testing.assert_allclose(gas.fluid_pressure, np.sqrt(squares), rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("outlet", [0.0, 1e5])
def test_gas_with_the_same_slip_everywhere(outlet):
    """w = p^2/2 + c p makes it linear, with the flow of the liquid's conductivity."""
    x, r, sigma = self_dual(81, 60, 2.0)
    c = 4e4
    gas = leak.gas_around_flow(x, r, lambda p: sigma * (1 + c / p), NITROGEN, 3e5, outlet)
    liquid = leak.around_flow(x, r, sigma, DROP)
    per_density = NITROGEN.specific_gas_constant * NITROGEN.temperature
    w = 0.5 * (3e5**2 - outlet**2) + c * (3e5 - outlet)
    assert gas.mass_flow == pytest.approx(liquid.leak_rate * w / per_density / DROP, rel=2e-3)
    assert gas.inlet_flow.sum() * 2 * np.pi / 60 == pytest.approx(gas.mass_flow, rel=1e-9)
    assert gas.mass_flow >= gas.radial_mass_flow


def test_gas_all_around_the_same_is_the_gas_flow_of_a_profile():
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=0.3e-6, hurst=0.8, q_low=1e4, q_rolloff=1e5, q_high=1e7
    )
    table = leak.gas_conductivity_table(
        leak.RoughContact(spectrum, effective_modulus=115e9), 1e2, 1e8, num=24
    )
    x = np.linspace(-1e-3, 1e-3, 401)
    p = 30e6 * np.exp(-0.5 * (x / 0.4e-3) ** 2)
    u = table.at_log_pressure(np.log(p))[:, None]

    def sigma(p_f: np.ndarray) -> np.ndarray:
        D = p_f * u / (NITROGEN.viscosity * NITROGEN.molecular_speed)
        from leak.flow.rarefied import flow_factor

        R = table.rarefaction(np.broadcast_to(np.log(p)[:, None], D.shape), np.log(D))
        return u**3 * flow_factor(D) * R / (12 * NITROGEN.viscosity) * np.ones((1, 3))

    line = leak.gas_leak_flow(x, p, table, NITROGEN, 2e5, 1e5, 0.014, ends=(x[0], x[-1]))
    found = leak.gas_around_flow(x, 0.014, sigma, NITROGEN, 2e5, 1e5)
    assert found.mass_flow == pytest.approx(line.mass_flow, rel=2e-4)


# -------------------------------------------------------------------- wrong input


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"conductivity": np.ones((3, 2))}, r"conductivity has shape \(3, 2\): must be \(4, k\)"),
        ({"conductivity": -np.ones((4, 2))}, "must not be negative"),
        ({"conductivity": np.full((4, 2), np.nan)}, "must not be negative"),
        ({"conductivity": np.full((4, 2), np.inf)}, "there is no contact"),
        ({"conductivity": [["a"] * 2] * 4}, "must be an array of numbers"),
        ({"pressure_drop": 0.0}, "pressure_drop"),
        ({"x": [0.0, 1.0, 1.0, 2.0]}, "must strictly increase"),
        ({"radius": -1.0}, "radius"),
        ({"pressure_side": "left"}, "pressure_side"),
    ],
)
def test_wrong_input_is_named(change, message):
    right = {"x": np.arange(4.0), "radius": 1.0, "conductivity": np.ones((4, 2)), "pressure_drop": 1e5}
    with pytest.raises(leak.LeakError, match=message):
        leak.around_flow(**(right | change))


def test_wrong_gas_pressures_are_named():
    with pytest.raises(leak.ProfileError, match="outlet_pressure"):
        leak.gas_around_flow(np.arange(4.0), 1.0, np.ones((4, 2)), NITROGEN, 1e5, 2e5)
