"""What a measurement is expected to leave of an interval: closed forms of lognormal inputs, and by doing it."""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
import pytest
from sample_results import SPECTRUM, case

import leak
from fem_seal.answers.chain import solve
from fem_seal.answers.error_shares import ERROR_SHARES
from fem_seal.answers.measurements import EVEN_WEIGHTS, Draws, accuracies, instruments
from fem_seal.answers.samples import UncertainScans
from fem_seal.answers.uncertainty import UNCERTAINTY, LeakInterval
from fem_seal.output.answer_output import prose
from fem_seal.sampling import UncertainInput, sobol_points
from fem_seal.seal.findings import Bounds
from leak import Reading
from leak.surfaces.random import height_scatter
from leak.theory.own_error import FlowError

# ln Q = sum a x at two loads, of inputs x with these standard deviations, and the theory's own error.
STD = np.array([0.3, 0.2, 0.1])
SLOPES = np.array([[1.0, 2.0, -1.0], [0.5, 2.5, 1.0]])
OWN = np.array([0.1, 0.15])
DOUBT = Bounds(1.0, 1.0)


def interval(values=None, log_rate=None, **more) -> LeakInterval:
    if values is None:
        points = sobol_points(256, 3, 1).T
        values = {
            name: UncertainInput(name, "lognormal", std).values(one[:, None])[:, 0]
            for name, std, one in zip("abc", STD, points, strict=True)
        }
        log_rate = SLOPES @ np.log([*values.values()])
    own = [FlowError(np.array(0.1), np.array(one)) for one in OWN]
    shares = np.full((len(log_rate), len(values)), math.nan)
    told = (tuple(values), 0.9, 1, 256, np.exp(log_rate), shares, None)
    return LeakInterval(*told, own_error=own[: len(log_rate)], values=values, **more)


def width(variance: float) -> float:
    return 2.0 * NormalDist().inv_cdf(0.95) * math.sqrt(variance)


@pytest.mark.parametrize(
    "accuracy", [{}, {"a": 0.1}, {"b": 0.05}, {"c": 0.5}, {"a": 0.1, "b": 0.05, "c": 0.03}]
)
def test_lognormal_inputs_have_a_closed_form(accuracy):
    """What is known of an input before and what an instrument shows add the inverses of their variances."""
    draws = Draws.of(interval())
    for load in (0, 1):
        left = [
            1 / (1 / std**2 + 1 / accuracy.get(name, math.inf) ** 2)
            for name, std in zip("abc", STD, strict=True)
        ]
        known = width(SLOPES[load] ** 2 @ left + OWN[load] ** 2)
        weights = draws.weigh(accuracy) if accuracy else EVEN_WEIGHTS
        assert draws.width(draws.log_rate[:, load], weights) == pytest.approx(known, rel=0.04)


@pytest.mark.parametrize("load", [0, 1])
def test_a_leak_test_at_one_load_tells_of_another_what_both_share(load):
    """Normal distribution of both under the condition of what is measured; the own error is one number of all loads."""
    draws = Draws.of(interval())
    cov = SLOPES @ np.diag(STD**2) @ SLOPES.T + np.outer(OWN, OWN)
    left = cov[load, load] - cov[load, 0] ** 2 / (cov[0, 0] + 0.1**2)
    found = draws.width(draws.log_rate[:, load], draws.weigh_test(0, 0.1, DOUBT))
    assert found == pytest.approx(width(left), rel=0.04)


def test_errors_of_the_theory_far_apart_in_pressure_have_nothing_to_do_with_each_other():
    draws = Draws.of(interval(), np.array([5.0, 8.0]))
    cov = SLOPES @ np.diag(STD**2) @ SLOPES.T + np.diag(OWN**2)
    left = cov[1, 1] - cov[1, 0] ** 2 / (cov[0, 0] + 0.1**2)
    found = draws.width(draws.log_rate[:, 1], draws.weigh_test(0, 0.1, DOUBT))
    assert found == pytest.approx(width(left), rel=0.04)


def test_samples_that_a_leak_test_has_left_stay_together():
    """Two inputs of which only the sum is free: to know the one is to know the other."""
    one, other = sobol_points(512, 2, 1).T
    a, b = (UncertainInput("a", "lognormal", 0.3).values(x[:, None])[:, 0] for x in (one, other))
    found = interval({"a": a, "b": a * b**0.1}, np.log(a * a * b**0.1)[None], error_scores=np.zeros((1, 512)))
    draws = Draws.of(found)
    rest = 1.0 / (1.0 / 0.3**2 + 1.0 / 0.1**2)
    after = draws.width(draws.log_rate[:, 0], draws.weigh({"a": 0.1}))
    assert after == pytest.approx(width(4.0 * rest + 0.03**2), rel=0.05)


def test_a_leak_test_settles_a_doubt_of_all_loads():
    draws, doubt = Draws.of(interval()), Bounds(0.5, 2.0)
    before = draws.width(draws.rates_with_doubt(0, doubt), EVEN_WEIGHTS)
    assert before > 1.1 * draws.width(draws.log_rate[:, 0], EVEN_WEIGHTS)
    after = draws.width(draws.rates_with_doubt(0, doubt), draws.weigh_test(0, 0.1, doubt))
    assert after == pytest.approx(width(0.1**2), rel=0.06)


def test_readings_widen_it_from_the_lower_to_the_upper_one():
    one = interval()
    both = interval(one.values, np.log(one.leak_rate), others={Reading.CAPPED: 1.5 * one.leak_rate})
    alone, draws = Draws.of(one), Draws.of(both)
    for weights in (EVEN_WEIGHTS, draws.weigh({"a": 0.1})):
        wider = draws.width(draws.log_rate[:, 0], weights) - alone.width(alone.log_rate[:, 0], weights)
        assert wider == pytest.approx(math.log(1.5), rel=1e-9)


def test_three_times_as_many_scans_again_leave_half_of_their_scatter():
    weights = UncertainScans("seat", (None,) * 20).values(sobol_points(512, 19, 1))
    effect = 10.0 * (weights @ np.sin(np.arange(20.0)))
    draws = Draws.of(interval({"seat": weights}, effect[None]))
    ((_, accuracy),) = accuracies(draws.values, {})
    left = width(0.25 * effect.var() + OWN[0] ** 2)
    assert draws.width(draws.log_rate[:, 0], draws.weigh(accuracy)) == pytest.approx(left, rel=0.05)


def test_what_the_samples_cannot_tell_is_not_told():
    one = interval()
    rates = np.log(one.leak_rate)
    assert Draws.of(interval(one.values, np.full_like(rates, -math.inf))) is None
    noise = np.random.default_rng(1).standard_normal(rates.shape)
    assert Draws.of(interval(one.values, rates + 3.0 * noise)) is None
    rates[0, :3] = -math.inf
    draws = Draws.of(interval(one.values, rates))
    assert np.isnan(draws.log_rate[:, 0]).all() and np.isfinite(draws.log_rate[:, 1]).all()
    assert draws.width(draws.log_rate[:, 1], draws.weigh({"a": 1e-5})) is None


def test_every_instrument_measures_inputs_and_says_who_told_its_accuracy():
    names = prose()["sources_of_error"]
    for table in instruments().values():
        (measured,) = (table[kind] for kind in ("accuracies", "scatters", "shares") if kind in table)
        assert {*measured} <= {*names} and all(0.0 < one < 10.0 for one in measured.values())
        assert table["instrument"] and table["source"]


SPREADS = {"rms_height": {"relative": 0.15}, "q_rolloff": {"relative": 0.4}, "hardness": {"relative": 0.2}}
UNITS = {"rms_height": "m", "q_rolloff": "1/m"}


def ball(samples=256, heights=SPECTRUM, **spreads):
    table = {"samples": samples, **SPREADS, **spreads}
    spectrum = {"spectrum": heights}
    return case(
        load={"fluid_pressure": "20 bar"}, roughness=spectrum, leak={"theory": "corrected"}, uncertainty=table
    )


def width_of(problem) -> float:
    found = solve(problem, answers=(UNCERTAINTY,)).uncertainty
    return math.log(found.high[0] / found.low[0])


@pytest.mark.slow
@pytest.mark.parametrize(("name", "accuracy"), [("rms_height", 0.06), ("q_rolloff", 0.1)])
def test_measuring_an_input_leaves_what_was_foretold(name, accuracy):
    """By doing it: what an instrument shows of several truths, and the interval calculated anew around it."""
    draws = Draws.of(solve(ball(), answers=(UNCERTAINTY,)).uncertainty)
    told = draws.width(draws.log_rate[:, 0], draws.weigh({name: accuracy}))
    before = SPREADS[name]["relative"]
    rest = 1.0 / (1.0 / before**2 + 1.0 / accuracy**2)
    given = {"rms_height": 1e-6, "q_rolloff": 1e5} | {
        key: getattr(ball().roughness.spectrum, key) for key in UNITS
    }
    widths = []
    for truth, error in ((-1.0, 0.7), (0.0, -1.0), (1.0, 0.3)):
        shows = (before * truth + accuracy * error) * rest / accuracy**2
        heights = SPECTRUM | {name: f"{given[name] * math.exp(shows)} {UNITS[name]}"}
        widths.append(width_of(ball(128, heights, **{name: {"relative": math.sqrt(rest)}})))
    assert told == pytest.approx(np.mean(widths), rel=0.15)


@pytest.mark.slow
def test_measuring_the_rolloff_of_a_finish_leaves_what_was_foretold():
    def turned(**more):
        faces = {"seat": {"Ra": "0.8 um", "process": "turned", **more.pop("seat", {})}}
        faces["closure"] = {"Ra": "0.1 um", "process": "lapped", **more.pop("closure", {})}
        return case(load={"fluid_pressure": "20 bar"}, roughness=faces, leak={"theory": "corrected"}, **more)

    accuracy = 0.1
    found = solve(turned(), answers=(UNCERTAINTY,))
    draws = Draws.of(found.uncertainty)
    told = draws.width(draws.log_rate[:, 0], draws.weigh({"q_rolloff": accuracy}))
    widths = []
    for place in (0.15, 0.5, 0.85):
        known = {
            key: {"q_rolloff": f"{2.0 * math.pi / float(one.finish.spreads['q_rolloff'].at(place))} 1/m"}
            for key, one in found.case.roughness.finishes.items()
        }
        widths.append(width_of(turned(**known, uncertainty={"q_rolloff": {"relative": accuracy}})))
    assert told == pytest.approx(np.mean(widths), rel=0.15)


@pytest.mark.slow
def test_scans_scatter_in_rolloff_and_hurst_exponent_as_the_table_says():
    rough = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7e4, q_high=3.1e6
    )
    fits = []
    for seed in range(40):
        x, h = leak.random_line_scan(rough, length=5.6e-3, points=11_200, seed=seed)
        fits.append(leak.measure(leak.line_scan(x, h)).rolloff)
    table, scatter = instruments()["line_scan"]["scatters"], height_scatter(rough, 5.6e-3)
    # the standard deviation of 40 is known to 11 %
    found = np.std([np.log(one.wavenumber) for one in fits])
    assert found == pytest.approx(table["q_rolloff"] * scatter, rel=0.3)
    assert np.std([np.log(one.hurst) for one in fits]) == pytest.approx(table["hurst"] * scatter, rel=0.3)


def test_a_case_without_uncertain_inputs_has_nothing_to_measure():
    plain = case(load={"fluid_pressure": "20 bar"}, leak={"theory": "corrected"})
    (shares,) = solve(plain, answers=(UNCERTAINTY, ERROR_SHARES)).error_shares
    assert shares.factor > 1.0 and shares.measurements == ()
