"""The liquid library against the values of its sources."""

from __future__ import annotations

import sys

import pytest

import leak
from leak.fluids.library import walther


def test_water():
    water = leak.liquid("Water")
    assert water.viscosity == pytest.approx(1.0016e-3, rel=1e-4)
    assert water.temperature == pytest.approx(293.15)
    assert "IAPWS" in water.source


@pytest.mark.parametrize(
    ("temperature", "viscosity", "density"),
    [
        # IAPWS SR6-08(2011), its check value of the viscosity at 298.15 K; elsewhere IAPWS 2008 and IAPWS-95
        (298.15, 0.889996773679e-3, 997.047),
        (277.13, None, 999.975),
        (353.15, 0.35404e-3, 971.79),
    ],
)
def test_water_over_temperature(temperature, viscosity, density):
    water = leak.liquid("water", temperature)
    if viscosity:
        assert water.viscosity == pytest.approx(viscosity, rel=1e-3)
    if density:
        assert water.density == pytest.approx(density, rel=2e-5)


@pytest.mark.parametrize("name", list(leak.FLUIDS))
def test_every_liquid_has_a_source_and_sane_numbers(name):
    liquid = leak.liquid(name)
    assert liquid == leak.FLUIDS[name]
    assert liquid.name == name
    assert 1e-4 < liquid.viscosity < 10
    assert 500 < liquid.density < 2000
    assert len(liquid.source) > 20
    warm = leak.liquid(name, 333.15)
    assert warm.viscosity < liquid.viscosity
    assert warm.density < liquid.density


@pytest.mark.parametrize(("grade", "middle"), [(32, 32e-6), (46, 46e-6)])
def test_hydraulic_oil(grade, middle):
    """40 degC is the class's midpoint (ISO 3448), and the viscosity index is 100 (ISO 2909 / ASTM D2270)."""
    name = f"hydraulic oil ISO VG {grade}"
    at_40, at_100 = (leak.liquid(name, t + 273.15) for t in (40.0, 100.0))
    assert at_40.viscosity / at_40.density == pytest.approx(middle, rel=1e-12)
    Y = at_100.viscosity / at_100.density * 1e6
    # ASTM D2270, appendix: L = a Y^2 + b Y + c and H = d Y^2 + e Y + f for 5.0 < Y < 6.4 and 6.4 < Y < 7.0
    a, b, c, d, e, f = (
        (0.10100, 16.6350, -45.469, 0.04985, 9.1613, -18.557)
        if Y < 6.4
        else (3.35714, -23.5643, 78.466, 0.22619, 7.7369, -16.656)
    )
    L, H = a * Y**2 + b * Y + c, d * Y**2 + e * Y + f
    assert 100 * (L - middle * 1e6) / (L - H) == pytest.approx(100.0, abs=0.5)


def test_walther_between_its_points():
    """A hydraulic oil ISO VG 46 with 46 and 6.76 mm^2/s has about 130 mm^2/s at 20 degC, as data sheets say."""
    assert walther(293.15, (313.15, 46e-6), (373.15, 6.762e-6)) == pytest.approx(132e-6, rel=0.05)


@pytest.mark.parametrize(
    ("name", "celsius", "viscosity", "tolerance"),
    [
        ("ethanol", 25.0, 1.074e-3, 1e-9),
        ("ethanol", 20.0, 1.19e-3, 0.02),
        ("ethylene glycol", 50.0, 6.554e-3, 1e-9),
        ("ethylene glycol", 20.0, 19.9e-3, 0.05),
        # typical kinematic viscosity times density: diesel 4.5 mm^2/s and kerosene 1.8 mm^2/s at 20 degC
        ("diesel", 20.0, 4.5e-6 * 829.5, 0.1),
        ("kerosene", 20.0, 1.8e-6 * 795.0, 0.1),
        # Melinder (2010), 50 % ethylene glycol by mass
        ("glycol/water 50/50", 20.0, 3.693e-3, 1e-3),
        ("glycol/water 50/50", -20.0, 22.18e-3, 1e-3),
        ("glycol/water 50/50", 80.0, 0.9685e-3, 1e-3),
    ],
)
def test_published_viscosities(name, celsius, viscosity, tolerance):
    assert leak.liquid(name, celsius + 273.15).viscosity == pytest.approx(viscosity, rel=tolerance)


@pytest.mark.parametrize(
    ("name", "coolprop"), [("water", "Water"), ("glycol/water 50/50", "INCOMP::MEG[0.5]")]
)
def test_against_coolprop(name, coolprop):
    pytest.importorskip("CoolProp.CoolProp", reason="CoolProp is optional")
    for celsius in (5.0, 20.0, 60.0, 95.0):
        ours, theirs = (
            leak.liquid(name, celsius + 273.15),
            leak.liquid(f"CoolProp:{coolprop}", celsius + 273.15),
        )
        assert ours.viscosity == pytest.approx(theirs.viscosity, rel=1e-3)
        assert ours.density == pytest.approx(theirs.density, rel=1e-3)
        assert "CoolProp" in theirs.source


def test_coolprop_says_what_is_wrong(monkeypatch):
    pytest.importorskip("CoolProp.CoolProp", reason="CoolProp is optional")
    with pytest.raises(leak.FluidError, match="not a liquid"):
        leak.liquid("CoolProp:Nitrogen")
    with pytest.raises(leak.FluidError, match="Nonsense"):
        leak.liquid("CoolProp:Nonsense")


def test_coolprop_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "CoolProp", None)
    with pytest.raises(leak.FluidError, match=r"needs CoolProp, .* install it with: .*\[coolprop\]"):
        leak.liquid("CoolProp:Water")


def test_unknown_liquid_names_the_nearest():
    with pytest.raises(leak.FluidError, match="water"):
        leak.liquid("watr")


@pytest.mark.parametrize("temperature", [-1.0, 0.0, float("nan"), "warm", 500.0])
def test_temperature_out_of_range(temperature):
    with pytest.raises(leak.FluidError, match="temperature"):
        leak.liquid("water", temperature)


def test_library_cannot_be_changed():
    with pytest.raises(TypeError):
        leak.FLUIDS["water"] = None  # type: ignore[index]


def test_wrong_liquid():
    with pytest.raises(leak.FluidError, match="viscosity"):
        leak.Liquid("x", -1.0, 1000.0, 293.0, "nowhere")
