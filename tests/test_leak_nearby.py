"""Tables of surfaces close to one whose table is known, against their own."""

from dataclasses import replace

import numpy as np
import pytest

from leak import NearbyTables, PowerSpectrum, RoughContact, gas_conductivity_table

SHAPE = {"rms_height": 0.4e-6, "hurst": 0.8, "q_low": 5e3, "q_rolloff": 5e4, "q_high": 5e6}


def surface(hardness=3.5e9, peklenik=1.0, **changes):
    spectrum = PowerSpectrum.self_affine(**{**SHAPE, **changes})
    return RoughContact(spectrum, effective_modulus=115e9, hardness=hardness, peklenik=peklenik)


def kinked(seed):
    """A spectrum as scans have it: many kinks, a step where a scan ends."""
    rng = np.random.default_rng(seed)
    smooth = PowerSpectrum.self_affine(**SHAPE)
    q = np.geomspace(5e3, 2e6, 30)
    scan = PowerSpectrum(q, np.asarray(smooth(q)) * np.exp(0.15 * rng.normal(size=q.size)))
    return scan + PowerSpectrum.self_affine(**{**SHAPE, "rms_height": 0.05e-6})


PAIRS = {
    "harder": (surface(), surface(3.9e9)),
    "another shape": (surface(), surface(hurst=0.74, q_rolloff=6e4, q_high=4e6)),
    "elastic": (surface(None), surface(None, hurst=0.74, q_rolloff=6e4)),
    "lay": (surface(peklenik=0.3), surface(peklenik=0.25, hurst=0.76)),
    "scans": tuple(replace(surface(), spectrum=kinked(seed)) for seed in (1, 2)),
}


# To half the sealing pressure 1 % of a leak rate, whose interval is a factor of 1.5 and more wide; 6 % next to it.
@pytest.mark.parametrize("reading", ["conserved", "capped"])
@pytest.mark.parametrize("pair", PAIRS)
def test_a_nearby_table_is_that_of_the_surface(pair, reading):
    known, other = (getattr(one, reading) for one in PAIRS[pair])
    sealing = other.sealing_pressure
    for share, tolerance in ((0.05, 1e-3), (0.5, 3.3e-3), (0.9, 2e-2)):
        p = share * sealing * np.array([1e-3, 0.1, 0.3, 0.6, 0.9, 1.0])
        table = NearbyTables(known).table(other, p[-1])
        assert table.effective_separation(p) == pytest.approx(other.effective_separation(p), rel=tolerance)
        assert table.effective_separation(1.001 * sealing) == 0.0


@pytest.mark.parametrize("reading", ["conserved", "capped"])
def test_of_a_gas(reading):
    known, other = (getattr(one, reading) for one in PAIRS["another shape"])
    p = 0.4 * other.sealing_pressure * np.array([0.01, 0.1, 0.3, 0.6, 1.0])
    own = gas_conductivity_table(other, 0.01 * p[0], 1.1 * p[-1])
    near = NearbyTables(known, of_gas=True).table(other, p[-1])
    log_p, log_D = np.broadcast_arrays(np.log(p)[:, None], np.array([-12.0, -4.0, -1.0, 0.0, 2.0, 5.0, 9.0]))
    assert near.rarefaction(log_p, log_D) == pytest.approx(own.rarefaction(log_p, log_D), rel=3e-3)
    assert near.at_log_pressure(np.log(p)) == pytest.approx(own.at_log_pressure(np.log(p)), rel=2e-3)


def test_a_surface_is_close_to_itself():
    """Nothing is left of the difference; what is left is between two splines through the same table."""
    one = surface()
    p = 0.3 * one.sealing_pressure * np.geomspace(1e-4, 1.0, 9)
    table = NearbyTables(one).table(one, p[-1])
    assert table.effective_separation(p) == pytest.approx(one.effective_separation(p), rel=3e-4)


def test_few_stops_keep_the_moments_and_the_steps():
    many = kinked(3)
    few = replace(many, most_breaks=6)
    assert few != many
    assert few.rms_height == many.rms_height and few.last_moment == many.last_moment
    assert few.break_moments.size < 0.7 * many.break_moments.size
    assert set(few.break_moments) <= set(many.break_moments)
    assert float(many.slope_moment(2e6)) == pytest.approx(
        few.break_moments[np.argmin(np.abs(few.break_moments - many.slope_moment(2e6)))], rel=1e-12
    )
