"""No interval that physics forbids: the upper end against the open bore and the rough gap without load."""

import math
from dataclasses import replace

import numpy as np
import pytest
from sample_results import case, single_result

import fem_seal
import leak
from fem_seal.seal.findings import NEARLY_SEALED, Bounds, Level, Validity, remark

ANYTHING = Validity.of([remark("fluid opens", Level.DOUBTFUL, "opens", Bounds(0.0, math.inf))])


def test_a_doubt_without_an_end_ends_at_the_rough_gap_without_load():
    load = single_result().loads[0].with_values(validity=ANYTHING)
    ends, leak = load.leak_interval, load.leak.leak_rate
    assert leak < ends.high <= load.most_leak < load.rough.flow.through_open_bore(load.fluid_pressure, 0.1)
    # a parallel gap of five rms heights over the width at half of the peak; it widens to both sides of that
    gap, profile = 5.0 * load.rough.surface.spectrum.rms_height, load.tightest
    around = 2.0 * math.pi * float(np.interp(profile.centroid, profile.x, profile.radius))
    parallel = around * gap**3 / (12.0 * load.rough.flow.viscosity * load.fwhm) * load.fluid_pressure
    assert 0.3 * parallel < load.most_leak < 1.5 * parallel
    # no reading of its asperities, and no load, lets more through
    assert all(one.leak.leak_rate < load.most_leak for one in (load, *load.others.values()))


def test_a_gas_flows_through_the_same_gap_by_its_own_laws():
    load = single_result().loads[0]
    flow, profile = load.rough.flow, load.tightest
    gas = leak.gas("nitrogen")
    of_gas = replace(flow, gas=gas, viscosity=gas.viscosity, outlet_pressure=1e5)
    wide, drop = np.full_like(profile.x, 1e-3), 1e3
    liquid = replace(flow, viscosity=gas.viscosity, pressure_law=None).through_gap(
        profile.x, profile.radius, wide, drop
    )
    # next to incompressible in a wide gap, counted at atmospheric pressure
    found = of_gas.through_gap(profile.x, profile.radius, wide, drop)
    assert found == pytest.approx(liquid * 100500.0 / 101325.0, rel=2e-3)


def test_a_gas_chokes_in_the_gap_before_friction_limits_it():
    """Helium behind 200 bar: the speed of sound at the narrowest ring, by the closed form of a monatomic gas."""
    load = single_result().loads[0]
    gas, high = leak.gas("helium"), 200e5
    thin = replace(load.rough.flow, gas=gas, viscosity=1e-3 * gas.viscosity, outlet_pressure=1e5)
    found = replace(load.rough, flow=thin).leak_without_load(load.whole_profile, high - 1e5)
    (land,) = load.whole_profile.lands
    apart = land.gap - land.gap.min() + 5.0 * load.rough.surface.spectrum.rms_height
    area = 2.0 * math.pi * float((land.radius * apart).min())
    choked = 0.7262 * area * high * math.sqrt(gas.specific_gas_constant * gas.temperature) / 101325.0
    assert found == pytest.approx(choked, rel=1e-3)
    # without pressure to speak of, friction limits it
    slow = replace(thin, viscosity=gas.viscosity)
    by_friction = slow.through_gap(land.x, land.radius, apart, 10.0)
    assert replace(load.rough, flow=slow).leak_without_load(load.whole_profile, 10.0) == by_friction


def test_rougher_samples_let_more_through():
    load = single_result().loads[0]
    rougher = load.with_values(rougher=3.0)
    assert rougher.most_leak == pytest.approx(3.0 * load.most_leak, rel=1e-9)


def test_no_form_error_lets_more_through_than_the_open_bore():
    """What a form error leaves open is no rough gap."""
    load = single_result().loads[0]
    circumference = replace(load, circumference=object())
    radius = min(one.radius.min() for one in load.profiles)
    water = math.pi * radius**2 * math.sqrt(2.0 * load.fluid_pressure / load.rough.flow.density)
    assert circumference.most_leak == pytest.approx(water, rel=1e-9)


def test_the_bound_next_to_sealing_does_not_widen_samples():
    """17 000 times the bound was told where samples leaked more than the surface as given."""
    near = remark(NEARLY_SEALED, Level.DOUBTFUL, "near", Bounds(1e-3, 40.0))
    load = single_result().loads[0]
    leak = load.leak.leak_rate
    known = {
        "validity": Validity.of([near]),
        "leak_before_sealing": 40.0 * leak,
        "unsealed_rates": (math.inf, math.inf),
    }
    for most, expected in ((2.0, 40.0), (90.0, 90.0)):
        found = load.with_values(**known, sample_ends=Bounds(0.5 * leak, most * leak)).leak_interval
        assert found.high == pytest.approx(expected * leak, rel=1e-2)
        assert found.low == pytest.approx(0.5e-3 * leak, rel=1e-2)


@pytest.mark.slow
def test_a_load_that_seals_leaves_the_interval_of_the_others_as_it_is():
    """With one of them all loads had 64 samples."""
    from fem_seal.answers.uncertainty import leak_interval
    from fem_seal.case.tables import Uncertainty

    finish = {"Ra": "0.1 um", "process": "lapped"}
    of = {"leak": {"theory": "corrected"}, "roughness": finish}
    alone, beside = (
        fem_seal.run(case(load={"fluid_pressure": "1 bar", "applied_force": forces}, **of))
        for forces in (["100 N"], ["100 N", "400 kN"])
    )
    assert beside.loads[1].leak.leak_rate == 0.0
    own, both = (leak_interval(one, Uncertainty(samples=128)) for one in (alone, beside))
    assert both.samples == own.samples == 128
    assert both.low[0] == pytest.approx(own.low[0], rel=0.01)
    assert both.high[0] == pytest.approx(own.high[0], rel=0.01)
