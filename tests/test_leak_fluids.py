"""The liquid library."""

from __future__ import annotations

import pytest

import leak


def test_water():
    water = leak.liquid("Water")
    assert water.viscosity == pytest.approx(1.0016e-3)
    assert water.temperature == pytest.approx(293.15)
    assert "IAPWS" in water.source


@pytest.mark.parametrize("name", list(leak.FLUIDS))
def test_every_liquid_has_a_source_and_sane_numbers(name):
    liquid = leak.liquid(name)
    assert liquid.name == name
    assert 1e-4 < liquid.viscosity < 10
    assert 500 < liquid.density < 2000
    assert 250 < liquid.temperature < 450
    assert len(liquid.source) > 20


def test_unknown_liquid_names_the_nearest():
    with pytest.raises(leak.FluidError, match="water"):
        leak.liquid("watr")


def test_library_cannot_be_changed():
    with pytest.raises(TypeError):
        leak.FLUIDS["water"] = None  # type: ignore[index]


def test_wrong_liquid():
    with pytest.raises(leak.FluidError, match="viscosity"):
        leak.Liquid("x", -1.0, 1000.0, 293.0, "nowhere")
