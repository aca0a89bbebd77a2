"""The interval of the leak rate follows the load without a step: a factor fades in before its warning begins."""

from dataclasses import replace

import numpy as np
import pytest
from judged_loads import SURFACE, load
from places import EXAMPLES
from sample_results import case

import fem_seal
from fem_seal.answers.case_load import case_loads
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.findings import Validity
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.sources import SharedBodies
from fem_seal.validity.checks import load_cautions, validity_of
from fem_seal.validity.fluid import opening_factor

CORRECTED = replace(SURFACE, theory="corrected", yielding="")
PROBLEM = SealProblem.of(case())
# A thousandth of an input moves no factor by more than this.
STEP = 0.02


def factors(surface, loads):
    """ln of both factors of each load."""
    problem = replace(PROBLEM, surface=surface)
    return np.array([np.log(Validity.of(load_cautions(problem, [one])).leak_factor) for one in loads])


def largest_step(values, found):
    """Largest change of a factor where an input moves by a thousandth."""
    return np.abs(np.diff(found, axis=0) / np.diff(np.log(values))[:, None]).max() * 1e-3


@pytest.mark.parametrize(
    ("surface", "shares"),
    [
        # short of sealing, where a bound that the three points of these loads do not have takes the place of a factor
        (SURFACE, (0.05, 0.9)),
        (CORRECTED, (0.05, 0.9)),
        (replace(CORRECTED, peklenik=0.3), (0.05, 0.9)),
    ],
    ids=["paper", "corrected", "lay"],
)
def test_over_the_contact_pressure(surface, shares):
    share = np.geomspace(*shares, 240)
    loads = [load(peak=one * SURFACE.sealing_pressure, fluid_pressure=1e5) for one in share]
    found = factors(surface, loads)
    assert np.ptp(found) > 0.01 or surface is CORRECTED
    assert largest_step(share, found) < STEP


def test_over_the_fluid_pressure():
    pressure = np.geomspace(0.01, 0.9, 240) * 50e6
    found = factors(SURFACE, [load(fluid_pressure=one) for one in pressure])
    assert largest_step(pressure, found) < STEP
    # the largest of a warning and of none are neighbours
    assert opening_factor(0.1 + 1e-9) == pytest.approx(opening_factor(0.1 - 1e-9), rel=1e-6)


def test_over_the_width_of_the_contact():
    std = np.geomspace(0.2, 30.0, 240) / SURFACE.spectrum.median_wavenumber
    found = factors(CORRECTED, [load(std=one) for one in std])
    assert found[0, 1] > np.log(1.5) and found[-1, 1] < np.log(1.1)
    assert largest_step(std, found) < STEP


def test_over_the_size_of_the_gap():
    gap = np.geomspace(0.1e-9, 3e-9, 240)
    found = factors(SURFACE, [load(critical_separation=one) for one in gap])
    # tight where a molecule does not pass, a fluid as any other some molecules wider
    assert found[0, 0] == pytest.approx(np.log(1e-3), abs=0.1) and found[-1, 0] > np.log(0.99)
    assert largest_step(gap, found) < STEP


def test_no_path_is_the_narrowest_gap():
    """What leaks nevertheless, as a short contact does, has the factor of a gap in which no molecule passes."""
    narrow, none, sealed = (
        load(critical_separation=gap, leak_rate=rate)
        for gap, rate in ((1e-24, 1e-12), (0.0, 1e-12), (0.0, 0.0))
    )
    found = factors(SURFACE, [narrow, none, sealed])
    assert found[1] == pytest.approx(found[0], abs=1e-9)
    assert found[0, 0] == pytest.approx(np.log(1e-3), abs=1e-9) and found[2, 0] > np.log(0.99)


def test_the_upper_end_goes_through_sealing():
    """Between metals that yield: the contact pressure was compared with a sealing pressure of the acting one."""
    given = fem_seal.load_case(EXAMPLES / "diesel_1800_bar.toml").replace({"load.fluid_pressure": "1800 bar"})

    def pressed(height: float) -> tuple[bool, float]:
        of = given.replace({"roughness.spectrum.rms_height": f"{height:.6g} um"})
        seal = evaluate(SealProblem.of(of), SharedBodies())
        (found,) = case_loads(seal.problem, seal.loads)
        leaks = found.leak.leak_rate > 0.0
        return leaks, found.with_values(validity=validity_of(seal, found)).leak_interval.high

    low, high = 0.11, 0.13
    while high - low > 5e-4:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if pressed(middle)[0] else (middle, high)
    (leaking, before), (sealed, after) = pressed(high), pressed(low)
    assert leaking and not sealed
    assert after == pytest.approx(before, rel=0.05) and 0.0 < after < 1e-13


def test_edges_that_a_contact_is_cut_off_at():
    """Deeper cuts were left out as soon as the first one resisted less than the whole."""
    given = fem_seal.load_case(EXAMPLES / "poppet_on_land.toml").replace({"load.fluid_pressure": "100 bar"})
    found = []
    for height in ("0.0757 um", "0.0758 um"):
        problem = SealProblem.of(given.replace({"roughness.spectrum.rms_height": height}))
        found.append(evaluate(problem, SharedBodies()).loads[0].leak.leak_rate)
    assert 0.0 < np.log(found[1] / found[0]) < STEP


@pytest.mark.parametrize("share", [0.1, 0.3, 0.6, 0.8, 0.9])
def test_the_fluid_opens_no_more_than_is_said(share):
    """Against the liquid between the surfaces that is taken off the load of the asperities, place by place."""
    import leak

    x = np.linspace(-6, 6, 241) * 0.139e-3
    p = 50e6 * np.exp(-0.5 * (x / 0.139e-3) ** 2)
    sigma = SURFACE.conductivity_table(1e3, 1e9).at(1e-3)
    opened = leak.coupled_leak_flow(x, p, sigma, share * 50e6, 0.014).leak_rate
    assert opened < 1.1 * opening_factor(share) * leak.leak_flow(x, p, sigma, share * 50e6, 0.014).leak_rate
