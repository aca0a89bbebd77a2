"""Liquids that thicken under pressure, against closed forms, sources and balances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import leak
from leak.fluids.library import _liquid_entry, _petroleum_law, water_density, water_law, water_viscosity

R0, WIDTH, SIGMA = 0.014, 1e-3, 1e-15
X = np.linspace(0.0, WIDTH, 101)
FLAT = np.full(X.shape, 4e8)
OIL = leak.Roelands(0.67, 0.04, leak.Tait.of_bulk_modulus(1.6e9))


def uniform(drop, law, **more):
    return leak.leak_flow(X, FLAT, lambda p: SIGMA + 0.0 * p, drop, R0, pressure_law=law, **more)


# -------------------------------------------------------------------- the laws


@pytest.mark.parametrize(
    ("temperature", "pressure", "volume"),
    # IAPWS R7-97(2012), table 5
    [(300.0, 3e6, 0.100215168e-2), (300.0, 80e6, 0.971180894e-3), (500.0, 3e6, 0.120241800e-2)],
)
def test_density_of_water(temperature, pressure, volume):
    # half of the last digit that is printed
    assert 1.0 / float(water_density(temperature, pressure)) == pytest.approx(volume, abs=0.5e-11)


@pytest.mark.parametrize(
    ("temperature", "density", "viscosity"),
    # IAPWS R12-08, table 4
    [
        (298.15, 998.0, 889.735100e-6),
        (298.15, 1200.0, 1437.649467e-6),
        (373.15, 1000.0, 307.883622e-6),
        (433.15, 1.0, 14.538324e-6),
    ],
)
def test_viscosity_of_water(temperature, density, viscosity):
    assert float(water_viscosity(temperature, density)) == pytest.approx(viscosity, abs=0.5e-12)


@pytest.mark.parametrize("temperature", [274.0, 293.15, 313.15, 353.15, 380.0])
def test_water_against_iapws_95(temperature):
    """The difference of the two formulations of density is below 0.03 % up to 2000 bar."""
    CoolProp = pytest.importorskip("CoolProp.CoolProp")
    water, atmosphere = water_law(temperature), 2e5
    for key, ratio in (("V", water.viscosity_ratio), ("D", water.density_ratio)):
        of = [
            CoolProp.PropsSI(key, "T", temperature, "P", p + atmosphere, "Water") for p in (0.0, 1e8, 1.8e8)
        ]
        np.testing.assert_allclose(ratio([1e8, 1.8e8]), np.array(of[1:]) / of[0], rtol=1e-3)


def test_the_table_of_water_is_its_formulation():
    p = np.linspace(0.0, 2e8, 333)
    for T in (273.15, 300.0, 383.15):
        density = water_density(T, 101325.0 + p)
        viscosity = water_viscosity(T, density)
        np.testing.assert_allclose(water_law(T).density_ratio(p), density / density[0], rtol=1e-9)
        np.testing.assert_allclose(water_law(T).viscosity_ratio(p), viscosity / viscosity[0], rtol=1e-8)


def test_cold_water_first_becomes_thinner_and_its_law_goes_on_beyond_its_range():
    assert float(water_law(283.15).viscosity_ratio(1e8)) < 0.97
    far = water_law(313.15).viscosity_ratio(np.linspace(1.5e8, 1e9, 50))
    assert np.all(np.diff(far) > 0.0)
    assert far[-1] < 3.0


@pytest.mark.parametrize("fluid", ["n-Decane", "n-Dodecane"])
@pytest.mark.parametrize("temperature", [293.15, 313.15, 353.15])
def test_petroleum_against_alkanes(fluid, temperature):
    """The law of fuels and oils within what it promises of pure alkanes: 7 % up to 1000 bar."""
    CoolProp = pytest.importorskip("CoolProp.CoolProp")
    p = np.array([0.0, 2e7, 5e7, 1e8])
    eta, rho = (
        np.array([CoolProp.PropsSI(key, "T", temperature, "P", 101325.0 + one, fluid) for one in p])
        for key in ("V", "D")
    )
    law = _petroleum_law(1.05e9, 2e8)(temperature, eta[0])
    np.testing.assert_allclose(law.viscosity_ratio(p), eta / eta[0], rtol=0.07)
    np.testing.assert_allclose(law.density_ratio(p), rho / rho[0], rtol=0.01)


@pytest.mark.parametrize("name", ["hydraulic oil ISO VG 32", "hydraulic oil ISO VG 46"])
def test_oils_against_the_rule_for_mineral_oils(name):
    """alpha = (0.6 + 0.965 log10(eta/(mPa s))) 10/GPa, L. A. Wooster, quoted to 20 %."""
    for celsius in (25.0, 40.0, 80.0):
        oil = leak.liquid(name, celsius + 273.15)
        rule = (6.0 + 9.65 * np.log10(oil.viscosity * 1e3)) * 1e-9
        assert oil.pressure_law.coefficient == pytest.approx(rule, rel=0.2)


@pytest.mark.parametrize("temperature", [283.15, 313.15, 343.15])
def test_ethanol_against_its_reference_correlation(temperature):
    CoolProp = pytest.importorskip("CoolProp.CoolProp")
    law = leak.liquid("ethanol", temperature).pressure_law
    for p in (2e7, 1e8, 1.9e8):
        eta, first = (CoolProp.PropsSI("V", "T", temperature, "P", one, "Ethanol") for one in (p, 101325.0))
        assert float(law.viscosity_ratio(p)) == pytest.approx(eta / first, rel=0.08)


def test_a_liquid_is_one_table_with_what_pressure_makes_of_it():
    known = {
        "temperature": [273.15, 373.15],
        "viscosity": [[0.0, 0.8], [50.0, 0.4]],
        "density": [867.0, -0.93],
        "source": "a handbook",
    }
    under_pressure = {"bulk_modulus": [1.1e9, 0.007], "highest_pressure": 1e8, "uncertainty": 0.2}
    T, warmer = 313.15, 313.15 - 293.15
    softened = leak.Tait.of_bulk_modulus(1.1e9 * float(np.exp(-0.007 * warmer)))

    def made(**more):
        return _liquid_entry("toluene", known | more).at(T)

    assert made().pressure_law is None
    barus = made(pressure_viscosity=9e-9, **under_pressure)
    assert barus.pressure_law == leak.Barus(9e-9, softened, 1e8, 0.2)
    roelands = made(roelands_z=[0.5, 0.001], **under_pressure)
    expected = leak.Roelands(0.5 + 0.001 * warmer, roelands.viscosity, softened, 1e8, 0.2)
    assert roelands.pressure_law == expected


@pytest.mark.parametrize("name", [name for name in leak.FLUIDS if leak.FLUIDS[name].pressure_law])
def test_every_law_begins_at_one_and_rises(name):
    for celsius in (0.0, 20.0, 75.0):
        if name == "ethanol" or celsius >= 0.0:
            law = leak.liquid(name, celsius + 273.15).pressure_law
            assert law.viscosity_ratio(0.0) == pytest.approx(1.0, abs=1e-12)
            p = np.linspace(0.0, law.highest_pressure, 40)
            assert np.all(np.diff(law.density_ratio(p)) > 0.0)
            if name != "water":
                assert np.all(np.diff(law.viscosity_ratio(p)) > 0.0)


def test_coolprop_liquids_know_their_pressure():
    pytest.importorskip("CoolProp")
    ours, theirs = (leak.liquid(name).pressure_law for name in ("water", "CoolProp:Water"))
    for p in (1e7, 1.13e8, 2e8):
        assert float(theirs.viscosity_ratio(p)) == pytest.approx(float(ours.viscosity_ratio(p)), rel=5e-4)
        assert float(theirs.density_ratio(p)) == pytest.approx(float(ours.density_ratio(p)), rel=5e-4)
    assert leak.liquid("CoolProp:INCOMP::MEG[0.3]").pressure_law is None


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: leak.Barus(-1e-9),
        lambda: leak.Roelands(0.6, 5e-5),
        lambda: leak.Roelands(0.0, 1e-3),
        lambda: leak.Tait(0.0),
        lambda: leak.PressureTable((0.0, 1.0, 2.0), (1.0, 1.0, 1.0), (1.0, 1.0, 1.0)),
        lambda: leak.PressureTable((0.0, 2.0, 1.0, 3.0), (1.0,) * 4, (1.0,) * 4),
        lambda: leak.PressureTable((0.0, 1.0, 2.0, 3.0), (1.0,) * 4, (1.0,) * 3),
    ],
)
def test_impossible_laws(wrong):
    with pytest.raises(leak.FluidError):
        wrong()


# -------------------------------------------------------------------- the potential


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 60e-9), st.floats(1e3, 1e9), st.floats(0.0, 1.0))
def test_potential_of_barus_has_a_closed_form(alpha, highest, share):
    """psi = (1 - exp(-alpha p))/alpha; a rounding error of psi, over its slope, is one of p."""
    potential = leak.FlowPotential(leak.Barus(alpha), highest)
    p = share * highest
    exact = -np.expm1(-alpha * p) / alpha if alpha * p > 1e-12 else p
    # a liquid 1e9 times as viscous thickens no further
    assert float(potential(p)) == pytest.approx(
        exact, rel=1e-11, abs=1e-9 * p if alpha * p > 20.0 else 1e-300
    )
    round_off = 1e-14 * float(potential(highest)) / float(potential.mobility(p))
    assert float(potential.pressure(potential(p))) == pytest.approx(
        p, rel=1e-10, abs=round_off + 1e-13 * highest
    )


@pytest.mark.parametrize("law", [OIL, water_law(283.15), leak.Barus(3e-9, leak.Tait(2e8))])
def test_potential_against_quadrature(law):
    potential = leak.FlowPotential(law, 3e8)
    for p in (1e6, 0.7e8, 3e8):
        exact = quad(
            lambda q: float(law.density_ratio(q) / law.viscosity_ratio(q)), 0.0, p, epsabs=0.0, epsrel=1e-12
        )
        # across the end of water's range its slope has a kink
        assert float(potential(p)) == pytest.approx(exact[0], rel=1e-7 if p > 2e8 else 1e-11)


# -------------------------------------------------------------------- the flow


@pytest.mark.parametrize("alpha_drop", [1e-6, 0.1, 1.0, 5.0, 20.0])
@pytest.mark.parametrize("side", ["outer", "inner"])
def test_uniform_gap_under_barus(alpha_drop, side):
    """Q = Q0 (1 - exp(-alpha dp))/(alpha dp), and p_f = -ln(1 - s (1 - exp(-alpha dp)))/alpha at the share s."""
    drop = 2e8
    alpha = alpha_drop / drop
    plain, thick = (
        uniform(drop, None, pressure_side=side),
        uniform(drop, leak.Barus(alpha), pressure_side=side),
    )
    assert thick.leak_rate / plain.leak_rate == pytest.approx(-np.expm1(-alpha_drop) / alpha_drop, rel=1e-12)
    share = X / WIDTH if side == "outer" else 1.0 - X / WIDTH
    exact = -np.log1p(share * np.expm1(-alpha_drop)) / alpha
    # round-off of the share grows by the thickening
    np.testing.assert_allclose(thick.fluid_pressure, exact, rtol=1e-9, atol=1e-15 * np.exp(alpha_drop) * drop)


def test_no_thickening_is_the_old_path():
    for law in (leak.Barus(0.0), leak.Barus(1e-18)):
        new, old = uniform(5e7, law), uniform(5e7, None)
        assert new.leak_rate == pytest.approx(old.leak_rate, rel=1e-9)
        np.testing.assert_allclose(new.fluid_pressure, old.fluid_pressure, rtol=1e-9)


def test_the_mass_flow_is_the_same_everywhere():
    """rho u^3/(12 eta) 2 pi r dp_f/dx from the profile of p_f: the balance that the potential promises."""
    x = np.linspace(-0.5e-3, 0.5e-3, 2001)
    p = 60e7 * np.exp(-((x / 0.25e-3) ** 2))
    found = leak.leak_flow(x, p, lambda p: 1e-9 / p, 1.5e8, R0, pressure_law=OIL).with_density(850.0)
    middle = 0.5 * (x[1:] + x[:-1])
    p_f = 0.5 * (found.fluid_pressure[1:] + found.fluid_pressure[:-1])
    sigma = 1e-9 / np.interp(middle, x, p)
    density = 850.0 * OIL.density_ratio(p_f)
    flow = (
        2
        * np.pi
        * R0
        * density
        * sigma
        / OIL.viscosity_ratio(p_f)
        * np.diff(found.fluid_pressure)
        / np.diff(x)
    )
    # differences of second order over 0.5 um; where the pressure hardly changes they are round-off
    changing = np.diff(found.fluid_pressure) > 1e-4 * 1.5e8
    np.testing.assert_allclose(flow[changing], found.mass_flow, rtol=2e-3)
    assert changing.sum() > 200


@pytest.mark.parametrize("drop", [1e6, 1e8, 3.9e8])
@pytest.mark.parametrize("alpha", [0.0, 5e-9, 20e-9])
def test_local_flow_in_a_uniform_contact(drop, alpha):
    """sigma = B/(p - p_f): Q = (2 pi r B/W) int exp(-alpha p_f)/(p - p_f) dp_f."""
    found = leak.coupled_leak_flow(
        X[::10], FLAT[::10], lambda p: 1e-9 / p, drop, R0, pressure_law=leak.Barus(alpha)
    )
    exact = quad(lambda q: np.exp(-alpha * q) / (4e8 - q), 0.0, drop, epsabs=0.0, epsrel=1e-11)[0]
    # 400 steps of second order, closer to blow-off the integrand rises without limit
    assert found.leak_rate == pytest.approx(2 * np.pi * R0 * 1e-9 / WIDTH * exact, rel=1e-5)
    assert found.fluid_pressure[-1] == pytest.approx(drop, rel=1e-5)


def test_local_flow_without_thickening_is_the_old_one():
    x = np.linspace(-0.5e-3, 0.5e-3, 101)
    p = 60e6 * np.exp(-((x / 0.2e-3) ** 2))
    old = leak.coupled_leak_flow(x, p, lambda p: 1e-9 / p, 3e7, R0)
    new = leak.coupled_leak_flow(x, p, lambda p: 1e-9 / p, 3e7, R0, pressure_law=leak.Barus(0.0))
    assert new.leak_rate == pytest.approx(old.leak_rate, rel=1e-9)
    np.testing.assert_allclose(new.fluid_pressure, old.fluid_pressure, rtol=1e-6, atol=1e-9 * 3e7)


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(st.floats(1e6, 59e6), st.floats(0.0, 60e-9), st.sampled_from(["inner", "outer"]))
def test_local_flow_lies_below_that_without_thickening_and_above_the_uncoupled_one(drop, alpha, side):
    x = np.linspace(-0.5e-3, 0.5e-3, 61)
    p, law = 60e6 * np.exp(-((x / 0.2e-3) ** 2)), leak.Barus(alpha)
    thick = leak.coupled_leak_flow(x, p, lambda p: 1e-9 / p, drop, R0, pressure_side=side, pressure_law=law)
    plain = leak.coupled_leak_flow(x, p, lambda p: 1e-9 / p, drop, R0, pressure_side=side)
    alone = leak.leak_flow(x, p, lambda p: 1e-9 / p, drop, R0, pressure_side=side, pressure_law=law)
    assert alone.leak_rate * (1 - 1e-3) <= thick.leak_rate <= plain.leak_rate * (1 + 1e-6)
    assert np.all(thick.fluid_pressure <= drop * (1 + 1e-6))


def test_around_the_axis_the_same_all_around():
    found = leak.around_flow(X, R0, np.full((X.size, 8), SIGMA), 1.5e8, pressure_law=OIL)
    along = uniform(1.5e8, OIL)
    assert found.leak_rate == pytest.approx(along.leak_rate, rel=1e-9)
    np.testing.assert_allclose(found.fluid_pressure[:, 3], along.fluid_pressure, rtol=1e-7, atol=1e-3)


def test_around_the_axis_thickening_changes_no_share():
    phi = 2 * np.pi * np.arange(16) / 16
    sigma = SIGMA * np.exp(2.0 * np.cos(phi) * np.cos(np.pi * X / WIDTH)[:, None])
    plain, thick = (leak.around_flow(X, R0, sigma, 1e8, pressure_law=law) for law in (None, OIL))
    assert thick.leak_rate / plain.leak_rate == pytest.approx(
        1.0 / leak.effective_viscosity_ratio(OIL, 1e8), rel=1e-11
    )
    assert thick.inlet_flow.sum() == pytest.approx(thick.outlet_flow.sum(), rel=1e-9)


@pytest.mark.parametrize("drop", [2e7, 1.5e8])
def test_scratch_that_stays_as_it_is(drop):
    """Without roughness and load a scratch is a duct: Q falls by psi(Delta P)/Delta P."""
    scratch = leak.Scratch(depth=20e-6, width=100e-6)
    settings = {"viscosity": 0.04, "effective_modulus": 1e18}
    thick = leak.scratch_flow(X, FLAT, scratch, None, drop, R0, pressure_law=OIL, **settings)
    plain = leak.scratch_flow(X, FLAT, scratch, None, drop, R0, **settings)
    ratio = leak.effective_viscosity_ratio(OIL, drop)
    # three points in each of 800 slices
    assert plain.upper.leak_rate / thick.upper.leak_rate == pytest.approx(ratio, rel=1e-6)


def test_scratched_roughness_alone_is_the_leak_integral():
    thick = leak.scratch_flow(
        X, FLAT, leak.Scratch(1e-6, 20e-6), lambda p: SIGMA + 0 * p, 1.5e8, R0,
        viscosity=0.04, effective_modulus=115e9, pressure_law=OIL,
    )  # fmt: skip
    assert thick.without.leak_rate == pytest.approx(uniform(1.5e8, OIL).leak_rate, rel=1e-6)
    assert thick.without.leak_rate <= thick.lower.leak_rate <= thick.upper.leak_rate


def test_a_law_that_knows_no_equality_works_like_one_that_does():
    class Own:
        """Barus' law of somebody's own making, mutable and so without a hash."""

        highest_pressure, uncertainty = 1e9, 0.0
        __hash__ = None

        def viscosity_ratio(self, pressure):
            return np.exp(20e-9 * np.asarray(pressure, dtype=float))

        def density_ratio(self, pressure):
            return np.ones(np.shape(pressure))

    drop = 60e6
    assert leak.effective_viscosity_ratio(Own(), drop) == pytest.approx(
        leak.effective_viscosity_ratio(leak.Barus(20e-9), drop), rel=1e-14
    )
