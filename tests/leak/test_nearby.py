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


SHARES = np.array([0.003, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9])


def resistance(u_at, peak):
    """Of a contact whose pressure falls like a Gaussian from its peak."""
    p = peak * np.exp(-0.5 * np.linspace(0.0, 5.0, 60) ** 2)
    return np.sum(np.asarray(u_at(p), dtype=float) ** -3)


@pytest.mark.parametrize("reading", ["conserved", "capped"])
@pytest.mark.parametrize("pair", PAIRS)
def test_leak_rates_of_nearby_surfaces(pair, reading):
    """Over all peak pressures, of one contact and of several that share a table: what the manual says of leak rates."""
    known, other = (getattr(one, reading) for one in PAIRS[pair])
    own = other.conductivity_table(1e-9 * other.sealing_pressure, other.sealing_pressure)
    near, peaks = NearbyTables(known), SHARES * other.sealing_pressure
    for highest in ([0.5], [0.7], [0.9], SHARES[[0, 3, 6]], SHARES[[1, 5, 9]], SHARES):
        table = near.table(other, np.multiply(highest, other.sealing_pressure))
        off = [
            abs(resistance(table.effective_separation, peak) / resistance(own.effective_separation, peak) - 1)
            for peak, share in zip(peaks, SHARES, strict=True)
            if share in highest
        ]
        allowed = np.where(SHARES[np.isin(SHARES, highest)] < 0.65, 8e-3, 2e-2)
        assert np.all(np.array(off) < allowed)


@pytest.mark.parametrize("pair", PAIRS)
def test_next_to_sealing_the_flanks_of_a_contact_have_their_gaps(pair):
    """The last two per cent of the pressure are most of the abscissa; what lies below was carried on from there.

    Samples whose peak was within 4 % of sealing leaked up to ten thousand times too much.
    """
    known, other = PAIRS[pair]
    p = other.sealing_pressure * np.array([0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.94])
    for share in (0.96, 0.98, 0.999):
        table = NearbyTables(known).table(other, share * other.sealing_pressure)
        assert table.effective_separation(p) == pytest.approx(other.effective_separation(p), rel=0.03)


def test_of_contacts_that_are_all_sealed_nothing_is_calculated():
    known, other = PAIRS["harder"]
    near = NearbyTables(known)
    table = near.table(other, [1.01 * other.sealing_pressure, 2.0 * other.sealing_pressure])
    assert table.effective_separation(1.001 * other.sealing_pressure) == 0.0
    assert not near._known_values


@pytest.mark.parametrize("of_gas", [False, True], ids=["liquid", "gas"])
def test_of_contacts_that_all_but_seal_there_is_next_to_nothing(of_gas):
    """Their gaps are too small for a number, which gave tables of gaps that were none; warnings are errors here."""
    known, other = (
        surface(hardness, 0.2, hurst=hurst, q_rolloff=3.7268e4).conserved
        for hardness, hurst in ((3.5e9, 0.8), (4e9, 0.86))
    )
    sealing = other.sealing_pressure
    for share in (0.97, 0.98, 0.9999):
        table = NearbyTables(known, of_gas=of_gas).table(other, share * sealing)
        log_p = np.log(sealing * np.array([0.1, 0.5, 0.9, share]))
        u = table.at_log_pressure(log_p)
        assert np.all(np.diff(u) < 0) and np.all(u >= 0) and u[-1] < 1e-16


@pytest.mark.parametrize("pieces", [4, 14])
def test_a_coarse_spectrum_keeps_heights_slopes_and_steps(pieces):
    many = kinked(3)
    few = many.coarse(pieces)
    assert few.break_moments.size < 0.7 * many.break_moments.size
    assert few.q_low == many.q_low and few.q_high == many.q_high
    assert few.rms_height == pytest.approx(many.rms_height, rel=1e-9)
    assert few.rms_slope == pytest.approx(many.rms_slope, rel=1e-9)
    ends = few.wavenumber[::2]
    assert few.slope_moment(ends) == pytest.approx(many.slope_moment(ends), rel=1e-7)
    assert few.height_variance_above(ends) == pytest.approx(many.height_variance_above(ends), rel=1e-7)
    # where the scan ends
    assert np.abs(np.log(ends / 2e6)).min() < 1e-12


def test_a_coarse_spectrum_between_which_there_is_nothing():
    """Two spectra that do not meet: nothing is left of differences of their moments."""
    low = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e3, q_rolloff=1e3, q_high=1e4)
    both = low + PowerSpectrum.self_affine(rms_height=1e-9, hurst=0.8, q_low=1e6, q_rolloff=1e6, q_high=1e7)
    few = both.coarse(14)
    assert few.rms_height == pytest.approx(both.rms_height, rel=1e-9)
    assert few.rms_slope == pytest.approx(both.rms_slope, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("of_gas", [False, True], ids=["liquid", "gas"])
@pytest.mark.parametrize("reading", ["conserved", "capped", "elastic"])
def test_surfaces_of_one_shape_share_what_is_calculated(reading, of_gas):
    """Over height, modulus and hardness: elastic ones are the known one in other units, yielding ones interpolated."""
    known = replace(surface(), spectrum=kinked(1))
    near, spectrum = NearbyTables(getattr(known, reading), of_gas), known.spectrum
    log_D = np.array([-9.0, -3.0, 0.0, 3.0, 7.0])
    changes = ((1.3, 1.0, 1.0), (0.75, 1.2, 1.0), (1.0, 0.8, 1.37), (1.1, 1.1, 0.66))
    for height, modulus, hardness in changes[2 * of_gas :]:
        other = RoughContact(
            PowerSpectrum(spectrum.wavenumber, spectrum.density * height**2),
            effective_modulus=modulus * known.effective_modulus,
            hardness=None if reading == "elastic" else hardness * known.hardness,
            yielding="capped" if reading == "capped" else "conserved",
        )
        peaks = other.sealing_pressure * np.array([0.01, 0.1, 0.3, 0.6])
        calculated = NearbyTables(getattr(known, reading), of_gas)
        vars(calculated)["_of"] = calculated._at
        if reading == "capped":
            vars(calculated)["_elastic"] = NearbyTables(known.elastic, of_gas)
            vars(calculated._elastic)["_of"] = calculated._elastic._at
        table, own = near.table(other, peaks), calculated.table(other, peaks)
        log_p = np.log(np.outer([0.02, 0.3, 1.0], peaks).ravel())
        assert table.at_log_pressure(log_p) == pytest.approx(own.at_log_pressure(log_p), rel=3e-4)
        if of_gas:
            at = np.broadcast_arrays(log_p[:, None], log_D)
            assert table.rarefaction(*at) == pytest.approx(own.rarefaction(*at), rel=3e-4)
    elastic = near._equivalent_elastic_tables if reading == "capped" else near
    assert (len(elastic._known_values) == 1) == (reading != "conserved")


@pytest.mark.parametrize("of_gas", [False, True], ids=["liquid", "gas"])
@pytest.mark.parametrize("reading", ["conserved", "capped"])
def test_a_known_table_that_ends_early_serves_up_to_its_end(reading, of_gas):
    """And above it one that goes on to sealing; where the nodes of both lie is worth a ten-thousandth."""
    known, other = (getattr(one, reading) for one in PAIRS["another shape"])
    sealing = known.sealing_pressure
    near = NearbyTables(known, of_gas, within=(1e-7 * sealing, 0.4 * sealing))
    for share, above in ((0.1, False), (0.8, True)):
        p = share * other.sealing_pressure * np.array([0.01, 0.3, 0.7, 1.0])
        table, whole = (one.table(other, p[-1]) for one in (near, NearbyTables(known, of_gas)))
        assert table.at_log_pressure(np.log(p)) == pytest.approx(whole.at_log_pressure(np.log(p)), rel=3e-4)
        used = near._equivalent_elastic_tables if reading == "capped" else near
        assert ("_unlimited" in vars(used)) is above


@pytest.mark.parametrize("share", [0.9, 0.3])
def test_far_below_its_lowest_place_a_nearby_table_keeps_the_law_at_low_pressure(share):
    """With the slope at which a spline ended gaps were 10 % off, and of some samples the narrower the less pressed."""
    known = RoughContact(PowerSpectrum.self_affine(**SHAPE), effective_modulus=115e9)
    other = RoughContact(PowerSpectrum.self_affine(**{**SHAPE, "q_high": 1e7}), effective_modulus=115e9)
    table = NearbyTables(known).table(other, share * other.sealing_pressure)
    p = other.sealing_pressure * np.array([1e-30, 1e-12, 1e-8, 1e-6])
    own = other.conductivity_table(1e-10 * other.sealing_pressure, other.sealing_pressure)
    assert table.effective_separation(p) == pytest.approx(own.effective_separation(p), rel=1e-3)
