"""The gas library against published values and, where installed, CoolProp's reference correlations."""

from __future__ import annotations

import math

import pytest

import leak


@pytest.mark.parametrize(
    ("name", "temperature", "viscosity", "tolerance"),
    [
        # E. W. Lemmon, R. T Jacobsen (2004), tables of check values at zero density, exact to their digits
        ("nitrogen", 300.0, 17.8771e-6, 1e-5),
        ("argon", 300.0, 22.7241e-6, 1e-5),
        ("oxygen", 300.0, 20.6307e-6, 1e-5),
        ("air", 300.0, 18.5230e-6, 1e-5),
        # CRC Handbook of Chemistry and Physics, viscosity of gases, 300 K
        ("helium", 300.0, 20.0e-6, 0.01),
        ("hydrogen", 300.0, 9.0e-6, 0.01),
        ("methane", 300.0, 11.2e-6, 0.015),
        ("carbon dioxide", 300.0, 15.0e-6, 0.01),
        ("air", 300.0, 18.6e-6, 0.01),
        ("nitrogen", 400.0, 22.2e-6, 0.01),
        ("helium", 400.0, 24.4e-6, 0.01),
    ],
)
def test_published_viscosities(name, temperature, viscosity, tolerance):
    assert leak.gas(name, temperature).viscosity == pytest.approx(viscosity, rel=tolerance)


@pytest.mark.parametrize(
    ("name", "coolprop"),
    [
        ("helium", "Helium"),
        ("hydrogen", "Hydrogen"),
        ("nitrogen", "Nitrogen"),
        ("oxygen", "Oxygen"),
        ("argon", "Argon"),
        ("air", "Air"),
        ("methane", "Methane"),
        ("carbon dioxide", "CarbonDioxide"),
    ],
)
def test_against_coolprop(name, coolprop):
    """One per cent from 220 to 600 K; density and viscosity within 5 % up to `dilute_pressure`."""
    CoolProp = pytest.importorskip("CoolProp.CoolProp", reason="CoolProp is optional")
    for T in (220.0, 293.15, 400.0, 600.0):
        gas = leak.gas(name, T)
        assert gas.viscosity == pytest.approx(CoolProp.PropsSI("V", "T", T, "P", 1e3, coolprop), rel=0.01)
        # the composition of dry air differs between the papers by 2.4e-4
        assert gas.molar_mass == pytest.approx(CoolProp.PropsSI("M", coolprop), rel=3e-4)
    gas = leak.gas(name)
    assert gas.density(1e3) == pytest.approx(CoolProp.PropsSI("D", "T", 293.15, "P", 1e3, coolprop), rel=1e-3)
    for key, dilute in (("D", gas.density(gas.dilute_pressure)), ("V", gas.viscosity)):
        real = CoolProp.PropsSI(key, "T", 293.15, "P", gas.dilute_pressure, coolprop)
        assert real == pytest.approx(dilute, rel=0.055)


def test_mean_free_path():
    """Air at 1 atm and 20 degC: 65.4 nm (S. G. Jennings, J. Aerosol Sci. 19, 159 (1988))."""
    assert leak.gas("air").mean_free_path(101325.0) == pytest.approx(65.4e-9, rel=0.01)


def test_mean_free_path_is_its_formula():
    """(eta/p) sqrt(pi R T/(2 M)) with round numbers."""
    made = leak.Gas("made", 0.004, 2e-5, 300.0, "")
    exact = 2e-5 / 1e5 * math.sqrt(math.pi * 8.31446261815324 * 300.0 / (2 * 0.004))
    assert made.mean_free_path(1e5) == pytest.approx(exact, rel=1e-9)
    assert made.density(1e5) == pytest.approx(1e5 * 0.004 / (8.31446261815324 * 300.0), rel=1e-9)


@pytest.mark.parametrize("name", list(leak.GASES))
def test_every_gas(name):
    gas = leak.gas(name)
    assert gas == leak.GASES[name]
    assert len(gas.source) > 40
    assert leak.gas(name, 400.0).viscosity > gas.viscosity
    assert gas.molecular_speed == pytest.approx(math.sqrt(2 * 8.314462618 * 293.15 / gas.molar_mass))
    assert leak.is_gas(name)


def test_formulas_are_names_too():
    assert leak.gas("He").name == leak.gas(" HELIUM ").name == "helium"
    assert leak.is_gas("CH4")
    assert not leak.is_gas("water")


def test_wrong_gas():
    with pytest.raises(leak.FluidError, match="helium"):
        leak.gas("heluim")
    with pytest.raises(leak.FluidError, match=r"temperature = 100 K.*200 to 600 K"):
        leak.gas("helium", 100.0)
    with pytest.raises(leak.FluidError, match="molar_mass"):
        leak.Gas("x", 0.0, 1e-5, 300.0, "nowhere")
    with pytest.raises(leak.FluidError, match="dilute_pressure"):
        leak.Gas("x", 0.03, 1e-5, 300.0, "nowhere", 0.0)


def test_coolprop_when_asked():
    pytest.importorskip("CoolProp.CoolProp", reason="CoolProp is optional")
    assert leak.gas("CoolProp:Helium", 300.0).viscosity == pytest.approx(
        leak.gas("helium", 300.0).viscosity, rel=2e-3
    )
    with pytest.raises(leak.FluidError, match="Unobtainium"):
        leak.gas("CoolProp:Unobtainium", 300.0)
    with pytest.raises(leak.FluidError, match="not a gas"):
        leak.gas("CoolProp:Water", 250.0 + 30.0)
