"""What flows where nothing seals, against limits and balances that do not come from it."""

import math

import numpy as np
import pytest

import leak
from leak.flow.leak_rate import gas_through_bore, liquid_through_bore

AREA = math.pi * 1e-6


def test_a_small_pressure_drop_takes_a_gas_for_a_liquid():
    gas, high, drop = leak.gas("nitrogen"), 1e6, 1e2
    liquid = liquid_through_bore(1e-3, drop, gas.density(high))
    assert gas_through_bore(1e-3, gas, high, high - drop) / gas.density(high) == pytest.approx(
        liquid, rel=1e-3
    )


@pytest.mark.parametrize("name", ["helium", "nitrogen"])
def test_a_choked_gas_leaves_at_the_speed_of_sound(name):
    """Energy: c_p T0 = c_p T + a^2/2 with a^2 = kappa R T, and an isentropic density."""
    from leak.fluids.library import heat_capacity_ratio

    gas, high, kappa = leak.gas(name), 5e6, heat_capacity_ratio(name)
    temperature = gas.temperature / (1.0 + 0.5 * (kappa - 1.0))
    speed = math.sqrt(kappa * gas.specific_gas_constant * temperature)
    density = gas.density(high) * (temperature / gas.temperature) ** (1.0 / (kappa - 1.0))
    for low in (1e3, 1e5, 2e6):
        assert gas_through_bore(1e-3, gas, high, low) == pytest.approx(AREA * density * speed, rel=1e-9)


def test_less_pressure_behind_it_lets_no_less_through():
    gas = leak.gas("air")
    flows = [gas_through_bore(1e-3, gas, 1e6, low) for low in np.linspace(0.99e6, 1e4, 60)]
    assert np.all(np.diff(flows) >= 0.0)


@pytest.mark.parametrize(("gap", "high", "low"), [(1e-6, 1e5, 0.0), (1e-8, 2e5, 1e3), (1e-4, 5e6, 1e5)])
def test_gas_in_a_gap_is_the_integral_over_its_pressure(gap: float, high: float, low: float) -> None:
    from scipy.integrate import quad

    from leak.flow.leak_rate import gas_through_gap
    from leak.flow.rarefied import flow_factor

    helium = leak.gas("helium")

    def flow(p: float) -> float:
        path = helium.mean_free_path(max(p, 1e-6 * high))
        return float(helium.flow_pressure(np.array(p)) * flow_factor(0.5 * np.sqrt(np.pi) * gap / path))

    exact = quad(flow, low, high, limit=500, epsrel=1e-8)[0] / (helium.viscosity * 1e15 * 101325.0)
    assert gas_through_gap(1e15, gap, helium, high, low) == pytest.approx(exact, rel=1e-3)
