"""Asperities that yield only where they touch: limits, order, memory, and direct simulation.

The direct results are those of boundary elements with the pressure capped at the hardness (docs/theory/yielding.md): a
campaign whose one half the constants were fitted to, and independent averages that took no part in the fit.
"""

from __future__ import annotations

import numpy as np
import pytest
from direct_numerical import periodic_spectrum, worst_factor
from direct_yielding import (
    capped,
    conserved,
    fit,
    halves,
    held_out,
    misfit,
    picture,
    read_averages,
    read_campaign,
    read_von_mises,
)
from direct_yielding_campaign import THRESHOLD_FILE
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import HARDNESS, surface
from scipy import special

import leak
from leak.theory.plasticity import (
    BEARING_GAP,
    CAPPED,
    VON_MISES,
    YIELDING_THRESHOLD,
    equivalent_pressure,
    percolation_threshold,
)

# pressures and hardness in units of E* h', from far below what any seal carries to far above the softest metal
RELATIVE = st.floats(-9.0, 0.5).map(lambda e: 10.0**e)
HARD = st.floats(-2.5, 2.0).map(lambda e: 10.0**e)
BEARING = st.floats(0.01, 0.1)
SEALING = st.floats(0.1, 0.4)


def equivalent(p, hardness, bearing=0.055, sealing=0.215, largest=None):
    return equivalent_pressure(
        p,
        hardness=hardness,
        effective_modulus=1.0,
        rms_slope=1.0,
        bearing_pressure=bearing,
        sealing_pressure=sealing,
        largest=largest,
    )


# -------------------------------------------------------------------- limits and order


@given(p=RELATIVE, bearing=BEARING, sealing=SEALING)
def test_a_hard_surface_is_elastic_whatever_it_has_carried(p, bearing, sealing):
    """Of an elastic contact's area exp(-2 H^2) bears more than the hardness: nothing from H = 20 E* h' on."""
    assert float(equivalent(p, 100.0, bearing, sealing)) == pytest.approx(p, rel=1e-12)
    loaded = equivalent(p, 100.0, bearing, sealing, largest=20.0 * p)
    # the spring-back is straight in ln p to the ratio of the powers, 1e-9
    assert float(loaded) == pytest.approx(p, rel=1e-8)


@given(area=st.floats(1e-6, 0.5), bearing=BEARING, sealing=SEALING)
def test_a_soft_surface_depends_on_the_area_alone(area, bearing, sealing):
    """The surface cut off over a = p/H: its elastic equivalent no longer knows the modulus that p is compared to."""
    soft, softer = (
        equivalent(area * 1e-6, 1e-6, bearing, sealing),
        equivalent(area * 1e-9, 1e-9, bearing, sealing),
    )
    # what is left of the elastic part: (H/c)^n/n
    assert float(soft) == pytest.approx(float(softer), rel=2e-6)


def test_a_soft_surface_seals_at_the_yielding_threshold():
    at = float(equivalent(YIELDING_THRESHOLD * 1e-8, 1e-8))
    assert at == pytest.approx(0.215, rel=1e-6)


@settings(max_examples=300, deadline=None)
@given(p=RELATIVE, more=st.floats(1.001, 100.0), hardness=HARD, bearing=BEARING, sealing=SEALING)
def test_it_rises_with_pressure_and_falls_with_hardness(p, more, hardness, bearing, sealing):
    first = float(equivalent(p, hardness, bearing, sealing))
    assert first >= p
    if p >= hardness:
        assert first == np.inf
    else:
        higher = float(equivalent(more * p, hardness, bearing, sealing))
        # the factor over p never falls with p: what memory relies on
        assert higher >= more * first * (1.0 - 1e-12)
    assert float(equivalent(p, more * hardness, bearing, sealing)) <= first * (1.0 + 1e-12)


@settings(max_examples=300, deadline=None)
@given(
    p=RELATIVE,
    x=st.floats(-6.0, 0.0).map(lambda e: 10.0**e),
    more=st.floats(1.001, 100.0),
    hardness=HARD,
    bearing=BEARING,
    sealing=SEALING,
)
def test_memory_is_ordered_and_gains_no_energy(p, x, more, hardness, bearing, sealing):
    """After a larger load the same pressure finds a smaller gap everywhere: the loop is run through with a loss."""
    after = float(equivalent(x * p, hardness, bearing, sealing, largest=p))
    first = float(equivalent(x * p, hardness, bearing, sealing))
    assert after >= first * (1.0 - 1e-12)
    assert after <= float(equivalent(p, hardness, bearing, sealing))
    assert float(equivalent(x * p, hardness, bearing, sealing, largest=more * p)) >= after * (1.0 - 1e-12)
    if np.isfinite(after) and x * more <= 1.0:
        assert float(equivalent(x * more * p, hardness, bearing, sealing, largest=p)) > after
    assert float(equivalent(p, hardness, bearing, sealing, largest=x * p)) == float(
        equivalent(p, hardness, bearing, sealing)
    )


def test_loaded_and_back_to_nothing_the_flattened_surface_still_touches():
    left = equivalent([0.0, 1e-12], 0.1, largest=0.02)
    assert 0.0 < left[0] < left[1] < float(equivalent(0.02, 0.1))
    np.testing.assert_allclose(left[1], left[0], rtol=0.01)
    assert float(equivalent(0.0, 0.1)) == 0.0
    assert float(equivalent(0.0, 0.1, largest=0.0)) == 0.0


def test_units_do_not_matter():
    p = np.geomspace(1e-4, 0.09, 9)
    scaled = equivalent_pressure(
        p * 5e10,
        hardness=0.1 * 5e10,
        effective_modulus=1e11,
        rms_slope=0.5,
        bearing_pressure=0.055 * 5e10,
        sealing_pressure=0.215 * 5e10,
    )
    np.testing.assert_allclose(scaled / 5e10, equivalent(p, 0.1), rtol=1e-12)


def test_bearing_gap_is_that_of_a_gaussian_surface_cut_off_over_a_quarter():
    # heights at evenly spaced quantiles
    h = special.ndtri((np.arange(200_000) + 0.5) / 200_000)
    gap = np.maximum(special.ndtri(0.75) - h, 0.0).mean()
    assert pytest.approx(BEARING_GAP, rel=1e-5) == gap


# -------------------------------------------------------------------- as a reading of a surface


@pytest.fixture(scope="module")
def seat() -> leak.RoughContact:
    return surface(hardness=HARDNESS).capped


def test_capped_surface_lies_between_elastic_and_conserved(seat):
    p = np.array([1e6, 1e7, 5.7e7, 3e8])
    for of in (leak.RoughContact.mean_separation, leak.RoughContact.effective_separation):
        open_, capped_, filled = (np.asarray(of(s, p)) for s in (seat.elastic, seat, seat.conserved))
        assert (open_ > capped_).all()
        assert (capped_ > filled).all()


def test_the_papers_seat_at_57_megapascals_as_simulated():
    """One direct simulation of a surface with the paper's numbers leaks 1.7 times less than elastic, C_pl 20 times."""
    box = leak.RoughContact(periodic_spectrum(4, 128, 0.6), effective_modulus=1.0, hardness=0.076)
    u = [float(s.effective_separation(0.00125)) for s in (box.elastic, box.capped, box)]
    assert (u[0] / u[1]) ** 3 == pytest.approx(1.7, rel=0.1)
    assert (u[0] / u[2]) ** 3 == pytest.approx(20.0, rel=0.05)


def test_capped_surface_seals_where_half_of_it_has_yielded(seat):
    assert seat.sealing_pressure / HARDNESS == pytest.approx(YIELDING_THRESHOLD, rel=0.02)
    assert float(seat.effective_separation(0.98 * seat.sealing_pressure)) > 0.0
    assert float(seat.effective_separation(1.001 * seat.sealing_pressure)) == 0.0


# -------------------------------------------------------------------- direct simulation


@pytest.fixture(scope="module")
def campaign():
    return read_campaign()


@pytest.fixture(scope="module")
def averages(reference_folder):
    return read_averages(reference_folder)


def test_constants_are_those_of_the_fit_to_one_half(campaign):
    seen, unseen = halves(campaign)
    assert len(seen) >= 6
    assert len(unseen) >= 4
    # the constants in use are rounded
    np.testing.assert_allclose(fit(seen), CAPPED, rtol=0.03)


@pytest.mark.parametrize(("unloading", "factor", "rms"), [(False, 1.2, 1.05), (True, 1.35, 1.07)])
def test_equivalent_pressure_on_the_surfaces_that_were_not_fitted(campaign, unloading, factor, rms):
    _, unseen = halves(campaign)
    off = misfit(unseen, CAPPED, unloading=unloading)
    assert off.size > 100
    assert worst_factor(np.exp(off)) < factor
    assert np.exp(np.sqrt(np.mean(off**2))) < rms


def test_one_equivalent_pressure_serves_gap_and_flow(campaign):
    for one in campaign:
        gap, flow = one.equivalent
        ratio = flow[one.yields & (one.area < 0.3)] / gap[one.yields & (one.area < 0.3)]
        assert worst_factor(ratio[np.isfinite(ratio)]) < 1.15


def test_independent_averages_are_met_as_well_as_the_elastic_ones(averages):
    """Elastic theory against direct results: 1.3 below A/A0 = 0.19, 1.7 up to 0.25 (test_verification_direct.py)."""
    for one in averages:
        gap, flow = capped(one)
        loading = one.yields & ~one.unloading
        assert worst_factor((gap / one.gap)[one.yields]) < 1.16
        assert worst_factor((flow / one.conductivity)[loading & (one.area < 0.35)]) < 1.5
        # two samples at A/A0 = 0.41 differ by more than a factor 1.5 themselves
        assert worst_factor((flow / one.conductivity)[loading]) < 1.8
        assert worst_factor((flow / one.conductivity)[one.unloading]) < 1.35


def test_conserved_reading_is_far_below_the_direct_one(averages):
    """What the interval between both readings is for: C_pl closes valleys that stay open here."""
    for one in averages:
        flow = conserved(one)[1] / one.conductivity
        loading = one.yields & ~one.unloading
        assert (flow[loading] < 0.35).all()
        assert (flow[loading] < capped(one)[1][loading] / one.conductivity[loading]).all()


def test_threshold_over_the_share_that_has_yielded():
    table = np.genfromtxt(THRESHOLD_FILE, delimiter=",", names=True)
    hardness = np.nan_to_num(table["hardness_over_Eh"], nan=np.inf)
    for h in np.unique(hardness):
        at = hardness == h
        share = (table["yielded_area"] / table["contact_area"])[at].mean()
        area = table["contact_area"][at]
        # twice the standard error of the mean over surfaces, two directions each
        error = 2.0 * area.std() / np.sqrt(area.size / 2)
        assert float(percolation_threshold(share)) == pytest.approx(area.mean(), abs=error)


def test_picture_is_drawn(averages, tmp_path):
    path = picture(averages[1:], tmp_path / "images" / "yielding.svg")
    assert "<svg" in path.read_text(encoding="utf-8")[:2000]


def test_acting_pressure_as_logarithms_goes_on_where_a_pressure_underflows():
    one = leak.RoughContact(surface().spectrum, effective_modulus=115e9, hardness=HARDNESS, yielding="capped")
    log_p = np.linspace(-300.0, np.log(0.9 * HARDNESS), 50)
    np.testing.assert_allclose(
        one.log_equivalent_pressure(log_p), np.log(one.equivalent_pressure(np.exp(log_p))), rtol=1e-13
    )
    near, *far, nothing = one.log_equivalent_pressure(np.array([-500.0, -800.0, -5000.0, -np.inf]))
    np.testing.assert_allclose([far[0] + 800.0, far[1] + 5000.0], near + 500.0)
    assert nothing == -np.inf


# ---------------------------------------------------------------- metal that flows


@pytest.fixture(scope="module")
def flowing():
    return read_von_mises()


def test_constants_of_von_mises_are_those_of_the_fit(flowing):
    seen, unseen = held_out(flowing)
    assert len(seen) >= 5
    assert len(unseen) >= 3
    np.testing.assert_allclose(fit(seen, VON_MISES), VON_MISES, rtol=0.03)


@pytest.mark.parametrize(("unloading", "factor", "rms"), [(False, 1.4, 1.08), (True, 1.4, 1.12)])
def test_equivalent_pressure_of_metal_that_flows_on_surfaces_that_were_not_fitted(
    flowing, unloading, factor, rms
):
    off = misfit(held_out(flowing)[1], VON_MISES, unloading=unloading)
    assert off.size > 20
    assert worst_factor(np.exp(off)) < factor
    assert np.exp(np.sqrt(np.mean(off**2))) < rms


def test_one_elastic_pressure_serves_gap_and_flow_where_metal_flows(flowing):
    off = []
    for one in flowing:
        gap, flow = one.equivalent
        ratio = np.log(flow / gap)[one.yields & (one.area < 0.3)]
        off.append(ratio[np.isfinite(ratio)])
    assert np.sqrt(np.mean(np.concatenate(off) ** 2)) < 0.08


def test_leakage_through_metal_that_flows_on_surfaces_that_were_not_fitted(flowing):
    """Conductivity below A/A0 = 0.3: rms of ln 0.2 with each map's own elastic results, 0.3 in closed form."""
    from scipy.interpolate import make_interp_spline

    by_map, closed = [], []
    for one in held_out(flowing)[1]:
        elastic = ~one.yields & (one.conductivity > 0.0)
        log_p = np.log(one.pressure[elastic])
        log_k = make_interp_spline(log_p, np.log(one.conductivity[elastic]), k=3)
        at = one.yields & ~one.unloading & (one.conductivity > 0.0) & (one.area < 0.3)
        acting = np.log(one.predicted(VON_MISES, 0.215)[at])
        by_map.append((log_k(acting) - np.log(one.conductivity[at]))[acting < log_p[-1]])
        for hardness in np.unique(one.hardness[at]):
            states = at & (one.hardness == hardness)
            surface_ = leak.RoughContact(
                one.spectrum, effective_modulus=1.0, hardness=float(hardness), theory="corrected"
            )
            u = np.asarray(surface_.effective_separation(one.pressure[states])) / one.spectrum.rms_height
            closed.append(3.0 * np.log(u) - np.log(one.conductivity[states]))
    assert np.concatenate(by_map).size > 50
    assert np.sqrt(np.mean(np.concatenate(by_map) ** 2)) < 0.2
    assert np.sqrt(np.mean(np.concatenate(closed) ** 2)) < 0.3
