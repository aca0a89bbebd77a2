"""Gases that are not ideal, and flows that are not viscous, against quadrature, limits and balances."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import leak
from leak.fluids.library import condensation_pressure, coolprop_name, estimated_real_gas

R0, WIDTH = 0.014, 1e-3
X, P = np.linspace(0.0, WIDTH, 11), np.full(11, 1e9)
# as light and thin as an artificial gas may be: Z and viscosity rise with pressure
MADE = leak.RealGas(
    tuple(np.linspace(0.0, 1e8, 41).tolist()),
    tuple(np.exp(np.linspace(0.0, 0.6, 41)).tolist()),
    tuple(np.exp(np.linspace(0.0, 0.9, 41)).tolist()),
)
REAL = replace(leak.gas("nitrogen"), real=MADE)


class UniformGap:
    """Smooth parallel walls."""

    def __init__(self, gap: float) -> None:
        self.gap = gap

    def at_log_pressure(self, log_pressure):
        return np.full(np.shape(log_pressure), self.gap)

    def rarefaction(self, log_pressure, log_inverse_knudsen):
        return np.ones(np.shape(log_inverse_knudsen))


def uniform(gap, gas, inlet, outlet, **options):
    return leak.gas_leak_flow(X, P, UniformGap(gap), gas, inlet, outlet, R0, **options)


@cache
def coolprop(name, temperature=293.15):
    pytest.importorskip("CoolProp")
    return leak.gas(f"CoolProp:{name}", temperature)


def asked(key, name, pressure, temperature=293.15):
    from CoolProp import CoolProp

    return CoolProp.PropsSI(key, "T", temperature, "P", pressure, name)


# -------------------------------------------------------------------- the potential


@settings(max_examples=30, deadline=None)
@given(st.floats(1e3, 1e8), st.floats(0.0, 1.0), st.sampled_from([0.0, 1e3, 1e7]))
def test_potential_and_its_inverse(highest, share, slip):
    for real in (None, MADE):
        w = leak.GasPotential(real, highest, slip)
        p = share * highest
        assert float(w.pressure(w(p))) == pytest.approx(p, rel=1e-9, abs=1e-7 * highest)
        # w is a square near zero: half of the digits
        assert float(w.pressure(0.0)) == 0.0
        assert float(w.pressure(w(highest))) == pytest.approx(highest, rel=1e-12)


def test_flow_pressure_of_a_potential():
    p = 9e7 * np.concatenate([np.geomspace(1e-12, 1e-3, 50), np.linspace(1e-3, 1.0, 3001)])
    for real in (None, MADE, coolprop("Hydrogen").real):
        for slip in (0.0, 1e4, 1e8):
            w = leak.GasPotential(real, 9e7, slip)
            q = p if real is None else real.flow_pressure(p)
            # cubics over a thousandth of the root of the highest pressure; squares lose digits beside a large slip
            np.testing.assert_allclose(w.flow_pressure(w(p)), q, rtol=1e-9)
            np.testing.assert_allclose(w.pressure(w(p)), p, rtol=1e-9)


def test_slope_of_the_flow_pressure():
    p, step = np.linspace(1e6, 9.9e7, 300), 10.0
    secant = (MADE.flow_pressure(p + step) - MADE.flow_pressure(p - step)) / (2.0 * step)
    np.testing.assert_allclose(MADE.flow_pressure_slope(p), secant, rtol=0.0, atol=1e-8)


def test_potential_against_quadrature():
    w = leak.GasPotential(MADE, 9e7, 1e6)
    for p in (1e5, 3e7, 9e7):
        exact = quad(lambda q: 2.0 * (float(MADE.flow_pressure(q)) + 1e6), 0.0, p, epsabs=0.0, epsrel=1e-12)[
            0
        ]
        assert float(w(p)) == pytest.approx(exact, rel=1e-10)


def test_an_ideal_table_is_the_ideal_path():
    ideal = leak.RealGas((0.0, 1e7, 5e7, 1e8), (1.0,) * 4, (1.0,) * 4)
    gas = leak.gas("helium")
    for gap in (1e-9, 1e-6):
        for outlet in (0.0, 1e5):
            plain, same = (uniform(gap, one, 4e7, outlet) for one in (gas, replace(gas, real=ideal)))
            assert same.mass_flow == pytest.approx(plain.mass_flow, rel=1e-9)
            np.testing.assert_allclose(same.fluid_pressure, plain.fluid_pressure, rtol=1e-7, atol=1.0)


# -------------------------------------------------------------------- the flow


def slip(gas, gap, inlet, outlet):
    """What first-order slip adds to int q dp in a uniform gap, 6 (1.0162) eta0 v0/u times the pressure drop [Pa^2]."""
    return 6.0 * 1.0162 * gas.viscosity * gas.molecular_speed / gap * (inlet - outlet)


def test_dense_gas_in_a_wide_gap():
    """G = (2 pi r u^3/(12 L)) int rho/eta dp."""
    u, a, b = 1e-4, 8e7, 1e5
    result = uniform(u, REAL, a, b)
    exact = quad(lambda p: float(MADE.flow_pressure(p)), b, a, epsabs=0.0, epsrel=1e-12)[0] + slip(
        REAL, u, a, b
    )
    exact *= 2 * np.pi * R0 * u**3 / (12 * REAL.viscosity * REAL.specific_gas_constant * 293.15 * WIDTH)
    # beyond first order the slip goes like 1/D^2
    assert result.mass_flow == pytest.approx(exact, rel=1e-8)


def test_free_molecules_do_not_ask_for_the_viscosity():
    """At low pressure a gas is ideal whatever it does at high pressure."""
    ideal, real = (uniform(1e-9, gas, 200.0, 0.0) for gas in (leak.gas("nitrogen"), REAL))
    assert real.mass_flow == pytest.approx(ideal.mass_flow, rel=1e-5)


def test_the_mass_flow_of_a_dense_gas_is_the_same_everywhere():
    x = np.linspace(-0.5e-3, 0.5e-3, 1001)
    p = 60e7 * np.exp(-((x / 0.3e-3) ** 2))
    found = leak.gas_leak_flow(x, p, UniformGap(5e-6), REAL, 6e7, 1e6, R0)
    p_f = found.fluid_pressure
    middle, gradient = 0.5 * (p_f[1:] + p_f[:-1]), np.diff(p_f) / np.diff(x)
    inside = gradient > 1e-3 * gradient.max()
    density = middle / (MADE.factor(middle) * REAL.specific_gas_constant * 293.15)
    viscosity = REAL.viscosity * MADE.viscosity_ratio(middle)
    flow = 2 * np.pi * R0 * density * 5e-6**3 / (12 * viscosity) * gradient
    # slip adds 6.1 lambda/u, at the outlet 2e-3
    np.testing.assert_allclose(flow[inside], found.mass_flow, rtol=5e-3)


def test_around_the_axis_and_with_a_scratch():
    x, inlet, outlet = np.linspace(0.0, WIDTH, 101), 7e7, 1e5
    sigma = np.full((x.size, 8), 5e-6**3 / (12 * REAL.viscosity))
    around = leak.gas_around_flow(x, R0, sigma, REAL, inlet, outlet)
    exact = 2 * np.pi * R0 * 5e-6**3 / (12 * REAL.viscosity * WIDTH)
    exact *= float(np.diff(leak.GasPotential(MADE, inlet)([outlet, inlet]))[0]) / 2
    exact /= REAL.specific_gas_constant * 293.15
    assert around.mass_flow == pytest.approx(exact, rel=1e-9)
    assert around.inlet_flow.sum() == pytest.approx(around.outlet_flow.sum(), rel=1e-9)
    alone = uniform(5e-6, REAL, inlet, outlet)
    scratched = leak.gas_scratch_flow(
        X, P, leak.Scratch(1e-6, 20e-6), UniformGap(5e-6), REAL, inlet, outlet, R0, effective_modulus=115e9
    )
    # quadrature of three points over the pressure in each of 800 slices
    assert scratched.without.mass_flow == pytest.approx(alone.mass_flow, rel=1e-5)


# -------------------------------------------------------------------- CoolProp


def test_nitrogen_at_700_bar_against_values_of_coolprop():
    gas, u, a, b = coolprop("Nitrogen"), 2e-5, 7e7, 1e5
    exact = quad(lambda p: asked("D", "Nitrogen", p) / asked("V", "Nitrogen", p), b, a, epsrel=1e-8)[0]
    exact += slip(gas, u, a, b) / (gas.specific_gas_constant * 293.15 * gas.viscosity)
    exact *= 2 * np.pi * R0 * u**3 / (12 * WIDTH)
    # 161 values of Z and viscosity up to 3000 bar
    assert uniform(u, gas, a, b).mass_flow == pytest.approx(exact, rel=2e-5)


@pytest.mark.parametrize("name", ["Helium", "Hydrogen", "Nitrogen", "Methane"])
def test_low_pressure_is_the_ideal_gas(name):
    """Z and viscosity differ by their slopes at zero pressure, below 1 % per 5 bar of these gases."""
    gas = coolprop(name)
    ideal = replace(gas, real=None)
    for gap in (1e-8, 1e-5):
        real, same = (uniform(gap, one, 2e3, 1e3).mass_flow for one in (gas, ideal))
        assert real == pytest.approx(same, rel=1e-4)
        real, same = (uniform(gap, one, 2e5, 1e5).mass_flow for one in (gas, ideal))
        assert real == pytest.approx(same, rel=6e-3)


def test_hydrogen_at_700_bar_is_not_ideal():
    gas = coolprop("Hydrogen")
    assert float(gas.real.factor(7e7)) == pytest.approx(1.459, abs=2e-3)
    assert leak.real_gas_flow_ratio(gas.real, 7e7, 1e5) == pytest.approx(0.680, abs=2e-3)


def test_a_gas_that_condenses_knows_where():
    gas = coolprop("CarbonDioxide")
    assert gas.real.condenses
    # vapour pressure of carbon dioxide at 20 degC, R. Span, W. Wagner (1996)
    assert gas.real.highest_pressure == pytest.approx(57.29e5, rel=1e-3)
    assert not coolprop("Nitrogen").real.condenses


@pytest.mark.parametrize(("celsius", "bar"), [(-20.0, 19.70), (0.0, 34.85), (20.0, 57.29), (30.0, 72.14)])
def test_a_gas_of_the_library_knows_where_it_condenses(celsius, bar):
    """Vapour pressures of R. Span, W. Wagner (1996), to 2 %."""
    found = condensation_pressure(leak.gas("carbon dioxide", celsius + 273.15))
    assert found == pytest.approx(1e5 * bar, rel=0.02)
    assert condensation_pressure(leak.gas("carbon dioxide", 310.0)) == np.inf
    assert condensation_pressure(leak.gas("nitrogen", celsius + 273.15)) == np.inf


@pytest.mark.parametrize("name", [name for name in leak.GASES if name != "carbon dioxide"])
@pytest.mark.parametrize("pressure", [1e7, 3e7, 7e7])
def test_the_estimate_of_the_warning(name, pressure):
    """What a library gas would lose, within 7 % of the flow."""
    known = coolprop(coolprop_name(name).removeprefix("CoolProp:"))
    estimate = estimated_real_gas(leak.gas(name), pressure)
    ratio = leak.real_gas_flow_ratio(estimate, pressure, 1e5)
    assert ratio == pytest.approx(leak.real_gas_flow_ratio(known.real, pressure, 1e5), rel=0.07)


def test_temperature_refused_names_coolprop():
    with pytest.raises(leak.FluidError, match='"CoolProp:Hydrogen" of the optional package CoolProp'):
        leak.gas("hydrogen", 77.0)
    with pytest.raises(leak.FluidError) as caught:
        leak.liquid("diesel", 500.0)
    assert "CoolProp" not in str(caught.value)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: leak.RealGas((0.0, 1.0, 2.0), (1.0,) * 3, (1.0,) * 3),
        lambda: leak.RealGas((1.0, 2.0, 3.0, 4.0), (1.0,) * 4, (1.0,) * 4),
        lambda: leak.RealGas((0.0, 1.0, 2.0, 3.0), (1.0,) * 3, (1.0,) * 4),
        lambda: leak.RealGas((0.0, 1.0, 2.0, 3.0), (1.0,) * 4, (1.0, 1.0, 0.0, 1.0)),
    ],
)
def test_impossible_tables(wrong):
    with pytest.raises(leak.FluidError):
        wrong()


# -------------------------------------------------------------------- inertia


def test_inertia_of_a_uniform_gap():
    """Mach G/(2 pi r u p) sqrt(R_s T/kappa) at the outlet; share 2 beta (G/(2 pi r u))^2 R_s T ln(a/b)/(a^2 - b^2)."""
    gas, u, a, b = leak.gas("helium"), 2e-6, 2e6, 5e5
    p = np.sqrt(np.linspace(b**2, a**2, 4001))
    RT = gas.specific_gas_constant * gas.temperature
    G = 2 * np.pi * R0 * u**3 * (a**2 - b**2) / (24 * gas.viscosity * RT * WIDTH)
    found = leak.gas_inertia(R0, np.full(p.shape, u), p, G, gas, 5.0 / 3.0)
    per_gap = G / (2 * np.pi * R0 * u)
    assert found.mach == pytest.approx(per_gap / b * np.sqrt(RT / (5.0 / 3.0)), rel=1e-12)
    assert found.reynolds == pytest.approx(2 * per_gap * u / gas.viscosity, rel=1e-12)
    share = 2 * 1.2 * per_gap**2 * RT * np.log(a / b) / (a**2 - b**2)
    assert 1.2 * per_gap**2 * RT / b**2 < 1.0
    assert found.acceleration == pytest.approx(share, rel=1e-5)


def test_no_inertia_where_there_is_no_continuum_or_no_flow():
    gas, p = leak.gas("helium"), np.linspace(0.0, 1e5, 11)
    nothing = leak.GasInertia(0.0, 0.0, 0.0)
    assert leak.gas_inertia(R0, np.full(11, 1e-9), p, 1e-9, gas) == nothing
    assert leak.gas_inertia(R0, np.full(11, 1e-6), p, 0.0, gas) == nothing
    # a share of the drive is at most all of it, whatever the flow
    assert leak.gas_inertia(R0, np.full(11, 1e-6), p, 1e9, gas).acceleration <= 1.0
