"""Intervals from uncertain inputs, and the readings of the theory."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
from sample_results import (
    SPECTRUM,
    STEEL,
    ball,
    case,
    cone,
    rough_result,
    run_loads,
    single_result,
    smooth_result,
)
from scipy.stats import norm

import fem_seal
import leak
from fem_seal.answers import uncertainty as module
from fem_seal.answers.response_surface import allowed_difference, fit, largest_difference
from fem_seal.answers.samples import Samples, UncertainScans, uncertain_inputs
from fem_seal.answers.uncertainty import LeakInterval, leak_interval
from fem_seal.case.roughness import UncertainHeight
from fem_seal.case.tables import Spread, Uncertainty
from fem_seal.errors import ConvergenceError, InputError
from fem_seal.output.files import summary
from fem_seal.output.report.page import report
from fem_seal.sampling import LogNormal, Normal, UncertainInput
from fem_seal.seal.conductivity_tables import family_table
from fem_seal.seal.leak_model import FlowModel
from leak import PowerSpectrum, Reading

TEN_PER_CENT = Spread(relative=0.1)


def rates(result):
    return np.array([load.leak.leak_rate for load in result.loads])


def readings(result):
    """Leak rates of all loads in both readings, one after the other, as a sample has them."""
    both = [(load.leak, load.scenarios[Reading.CAPPED].leak) for load in result.loads]
    return np.array([leak.leak_rate for one in zip(*both, strict=True) for leak in one])


# -------------------------------------------------------------------- against closed forms and whole runs


def test_viscosity_alone_is_exact_and_needs_no_run():
    interval = leak_interval(rough_result(), Uncertainty(samples=4096, viscosity=TEN_PER_CENT))
    assert interval.runs == 0
    assert interval.error is None
    # Q ~ 1/eta: the interval of a log-normal; 4096 Sobol samples know its quantiles to 2e-3
    conserved, capped = np.split(readings(rough_result()), 2)
    low, high = np.minimum(conserved, capped), np.maximum(conserved, capped)
    ends = ((interval.low, low, 0.05), (interval.median, conserved, 0.5), (interval.high, high, 0.95))
    for end, nominal, quantile in ends:
        np.testing.assert_allclose(end, nominal * math.exp(0.1 * norm.ppf(quantile)), rtol=2e-3)
    np.testing.assert_allclose(interval.shares, 1.0)


CHANGES = {
    "hardness": 0.9,
    "youngs_modulus": 1.1,
    "rms_height": 1.2,
    "hurst": 1.1,
    "q_rolloff": 0.8,
    "q_high": 0.7,
}


@pytest.mark.slow
def test_a_sample_is_what_a_whole_run_with_its_inputs_gives():
    steel = {**STEEL, "youngs_modulus": "231 GPa", "hardness": f"{3.5 * 0.9} GPa"}
    spectrum = {
        **SPECTRUM,
        "rms_height": f"{1.9 * 1.2} um",
        "hurst": 0.6 * 1.1,
        "q_rolloff": f"{3.7268e4 * 0.8} 1/m",
        "q_high": f"{3.14159e6 * 0.7} 1/m",
    }
    expected = run_loads(
        case(
            closure=ball({**steel, "hardness": "9 GPa"}),
            seat=cone(steel),
            roughness={"spectrum": spectrum},
        )
    )
    inputs = tuple(UncertainInput(name, "uniform", 0.5) for name in CHANGES)
    uniform = np.array(
        [[factor for factor in CHANGES.values()]]
    )  # 1 + 0.5 (2 u - 1) = factor for u = factor - 0.5
    samples = Samples(rough_result(), (inputs,), uniform - 0.5)
    # another mesh, and a conductivity table of few pressures
    np.testing.assert_allclose(samples.leak_rates([0])[0].ravel(), readings(expected), rtol=2e-3)


@pytest.mark.parametrize("reading", ["elastic", "conserved", "capped"])
@pytest.mark.parametrize("fluid", ["water", "helium"])
def test_a_shared_table_is_that_of_the_surface(fluid, reading):
    """Height, modulus and hardness of a sample from the tables of its shape: to 3e-4 of a leak rate."""
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.1415926e6
    )
    # between four points of the lattice, and with other heights than those of the tables
    surface = leak.RoughContact(
        PowerSpectrum(spectrum.wavenumber, 1.3 * spectrum.density), effective_modulus=97e9, hardness=2.83e9
    )
    surface = getattr(surface, reading)
    gas = leak.gas("helium") if fluid == "helium" else None
    flow = FlowModel(fluid, 1e-3, gas=gas)
    shared, own = family_table(flow, surface), flow.table_around(surface, [8.2])
    p = np.geomspace(1e4, 1.5e8, 23)
    np.testing.assert_allclose(shared.at_log_pressure(np.log(p)), own.at_log_pressure(np.log(p)), rtol=3e-5)
    if gas is not None:
        for log_D in (-8.0, -2.0, 0.5, 4.0):
            at = np.log(p), np.full(p.shape, log_D)
            np.testing.assert_allclose(shared.rarefaction(*at), own.rarefaction(*at), rtol=1e-4)


@pytest.mark.slow
def test_hardness_alone_gives_the_leak_rates_of_its_own_quantiles():
    """Q rises with the hardness, so the ends of the interval are the leak rates at the ends of the hardness."""
    result = rough_result()
    interval = leak_interval(result, Uncertainty(samples=2048, hardness=TEN_PER_CENT))
    assert interval.error < 1e-3
    assert interval.runs < 100
    for end, outer, quantile in ((interval.low, np.minimum, 0.05), (interval.high, np.maximum, 0.95)):
        factor = math.exp(0.1 * norm.ppf(quantile))
        uniform = np.array([[0.5 * (1 + (factor - 1) / 0.9)]])
        samples = Samples(result, ((UncertainInput("hardness", "uniform", 0.9),),), uniform)
        # 2048 Sobol samples know the quantile to 1e-3 of its probability
        conserved, capped = samples.leak_rates([0])[0]
        np.testing.assert_allclose(end, outer(conserved, capped), rtol=3e-3)


def test_a_sample_that_does_not_converge_leaves_no_interval_without_a_finish():
    known = {(0, load, False): ConvergenceError("no contact") for load in range(9)}
    with pytest.raises(
        ConvergenceError, match="1 of 16 samples did not converge, the first because no contact"
    ):
        leak_interval(rough_result(), Uncertainty(samples=16, hardness=TEN_PER_CENT), known_rates=known)


@pytest.mark.slow
def test_each_sample_knows_the_values_of_its_inputs():
    settings = Uncertainty(samples=64, viscosity=TEN_PER_CENT, hardness=TEN_PER_CENT)
    found = leak_interval(rough_result(), settings)
    assert set(found.values) == {"viscosity", "hardness"}
    viscosity, hardness = found.values["viscosity"], found.values["hardness"]
    assert viscosity.shape == hardness.shape == (64,)
    # a thicker liquid leaks as much less, a harder surface more
    fluidity = found.leak_rate[0] * viscosity
    assert np.corrcoef(fluidity.argsort().argsort(), hardness.argsort().argsort())[0, 1] > 0.999


@pytest.mark.slow
def test_polynomial_gives_the_samples_that_it_has_not_seen():
    settings = Uncertainty(
        samples=128, seed=3, rms_height=Spread(relative=0.1), youngs_modulus=Spread(relative=0.05)
    )
    result = single_result()
    interval = leak_interval(result, settings)
    assert interval.runs < interval.samples
    unseen = list(range(70, 128, 4))
    calculated = Samples.of(result, settings).leak_rates(unseen)[:, 0]
    np.testing.assert_allclose(interval.leak_rate[:, unseen].T, calculated, rtol=2e-3)
    assert interval.shares.sum() == pytest.approx(1.0, abs=0.01)
    assert interval.error < 2e-3


@pytest.mark.slow
def test_samples_of_a_finish_bend_towards_sealing():
    """A quadratic polynomial of ln Q does not: its upper end was twice that of the samples, all calculated."""
    result = run_loads(
        case(
            closure={
                "shape": "cone",
                "included_angle": "60 deg",
                "inner_diameter": "6 mm",
                "outer_diameter": "12 mm",
                "material": "100Cr6",
            },
            seat={
                "shape": "sharp-edge",
                "bore_diameter": "8 mm",
                "edge_radius": "0.3 mm",
                "material": "100Cr6",
            },
            roughness={
                "closure": {"kind": "finish", "Ra": "0.1 um", "process": "ground"},
                "seat": {"kind": "finish", "Ra": "0.2 um", "process": "ground"},
            },
            fluid={"viscosity": "30 mPa s"},
            load={"fluid_pressure": "50 bar", "applied_force": "100 N"},
            leak={"theory": "corrected"},
        )
    )
    settings = Uncertainty(samples=128, hardness=TEN_PER_CENT)
    found = leak_interval(result, settings)
    assert found.runs < 50
    all_of_them = Samples.of(result, settings).leak_rates(range(128))[:, 0, 0]
    ends, truth = (np.log(np.quantile(one, (0.05, 0.5, 0.95))) for one in (found.leak_rate[0], all_of_them))
    assert ends == pytest.approx(truth, abs=0.25)


def test_seed_decides_the_samples():
    settings = Uncertainty(samples=64, viscosity=TEN_PER_CENT)
    first, again, other = (
        leak_interval(rough_result(), settings.model_copy(update={"seed": seed})) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.leak_rate, again.leak_rate)
    assert not np.array_equal(first.leak_rate, other.leak_rate)
    # two sequences of 64 agree within the error of the quantiles of so few samples
    np.testing.assert_allclose(first.high, other.high, rtol=0.03)


def test_a_wider_input_gives_a_wider_interval_and_more_confidence_too():
    def width(relative, confidence=0.9):
        interval = leak_interval(
            rough_result(),
            Uncertainty(samples=512, confidence=confidence, viscosity=Spread(relative=relative)),
        )
        return float((interval.high / interval.low)[0])

    assert 1 < width(0.05) < width(0.1) < width(0.1, 0.99)


def test_sealed_samples_are_counted_and_not_smoothed_over(monkeypatch):
    result = rough_result()

    def half_sealed(samples, numbers, loads, **_):
        factor = samples.values["hardness"][list(numbers), 0]
        return np.where(factor > 1, 1e-9, 0.0)[:, None, None] * np.ones((2, len(loads)))

    monkeypatch.setattr(Samples, "leak_rates", half_sealed)
    settings = Uncertainty(samples=256, hardness=TEN_PER_CENT, viscosity=TEN_PER_CENT)
    interval = leak_interval(result, settings)
    assert interval.runs == 256
    np.testing.assert_allclose(interval.sealed_share, 0.5, atol=0.01)
    assert (interval.low == 0).all()
    assert (interval.high > 0).all()
    assert np.isnan(interval.shares).all()


SCANNED = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=2e3, q_rolloff=2e4, q_high=6e5)


def scans(folder, heights):
    """Three scans of the same surface, with all heights times a factor, as text files."""
    from leak.surfaces.random import random_line_scan

    x, heights_of_one = random_line_scan(SCANNED, length=4e-3, points=4000, seed=4)
    files = []
    for n, height in enumerate(heights):
        h = height * heights_of_one
        files.append(str(folder / f"scan{n}.csv"))
        np.savetxt(files[-1], np.column_stack([x * 1e6, h * 1e6]), delimiter=",", header="x [um], h [um]")
    return files


@pytest.mark.slow
def test_spectrum_between_scans(tmp_path, monkeypatch):
    """Scans that differ by a factor of all heights: every mean of them is a surface between the extreme ones."""
    files = scans(tmp_path, (0.9, 1.0, 1.1))

    def result(*chosen, **tables):
        spectrum = {"kind": "profile", "files": list(chosen)}
        # asperities that do not yield: one reading instead of two, of which the slower one takes most of the time
        return run_loads(
            case(
                leak={"plasticity": False},
                roughness={"spectrum": spectrum},
                load={"fluid_pressure": "20 bar"},
                **tables,
            ),
            interval=True,
        )

    table = {"samples": 16, "spectrum": {"distribution": "scans"}}
    both = result(*files, uncertainty=table).uncertainty
    with monkeypatch.context() as patch:
        patch.setattr("fem_seal.answers.samples.uncertain_heights", lambda *_, **__: ())
        interval = result(*files, uncertainty=table).uncertainty
    low, high = (rates(result(file))[0] for file in (files[0], files[2]))
    assert low < interval.low[0] < interval.median[0] < interval.high[0] < high
    assert interval.shares[0] == pytest.approx([1.0])
    assert interval.inputs == ("spectrum",)
    # three scans say little of how far their mean may be off
    assert both.inputs == ("spectrum", "scan_length")
    assert both.high[0] / both.low[0] > 1.1 * interval.high[0] / interval.low[0]


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_the_length_of_one_scan_widens_the_interval(tmp_path):
    """Two wavelengths of the roll-off instead of thirteen; no other input is needed."""
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1e-6, hurst=0.8, q_low=2e3, q_rolloff=2e4, q_high=3e6
    )
    ratios, names = [], {"short": 0.63e-3, "long": 12.6e-3}
    for name, length in names.items():
        points = round(length / 1e-6)
        x, h = leak.random_line_scan(spectrum, length=length, points=points, seed=4)
        path = tmp_path / f"{name}.csv"
        np.savetxt(path, np.column_stack([x * 1e6, h * 1e6]), delimiter=",", header="x [um], h [um]")
        found = run_loads(
            case(
                leak={"plasticity": False},
                roughness={"spectrum": {"kind": "profile", "file": str(path)}},
                load={"fluid_pressure": "20 bar"},
                uncertainty={"samples": 16},
            ),
            interval=True,
        )
        warned = any("roughness.spectrum: too short for its roll-off" in one for one in found.warnings)
        assert warned == (name == "short")
        assert found.uncertainty.inputs == ("scan_length",)
        ratios.append(float(found.uncertainty.high[0] / found.uncertainty.low[0]))
        assert "rms height beyond the length of the scans" in report(found, full=True)
    assert ratios[0] > 5 * ratios[1]
    assert ratios[1] > 1.2


def test_scans_show_a_part_of_their_own_scatter():
    """Random weights of n scans scatter their mean by (n-1)/(n+1) of its variance; the rest is added."""
    surface = leak.measure(leak.line_scan(*leak.random_line_scan(SCANNED, length=4e-3, points=4000, seed=1)))
    whole = UncertainHeight("seat", "scan_length", surface.rolloff.height, 2e4)
    part = replace(whole, share=0.5)
    uniform = np.linspace(0.01, 0.99, 99)[:, None]
    assert np.log(part.values(uniform)).std() == pytest.approx(
        math.sqrt(0.5) * np.log(whole.values(uniform)).std(), rel=1e-9
    )
    assert part.values(np.array([[0.5]])) == pytest.approx(whole.values(np.array([[0.5]])), rel=1e-3)


def test_each_surface_has_its_own_scans(tmp_path):
    files = scans(tmp_path, (0.9, 1.0, 1.1))
    rough = {"kind": "profile", "files": files}
    one = case(
        roughness={"seat": rough, "closure": {"kind": "profile", "file": files[1]}},
        uncertainty={"spectrum": {"distribution": "scans"}, "rms_height": {"relative": 0.1}},
    )
    names = [found.name for found in uncertain_inputs(one, one.uncertainty)]
    assert names == ["rms_height", "seat", "scan_length_seat", "scan_length_closure"]
    shares = [
        found.share for found in uncertain_inputs(one, one.uncertainty) if isinstance(found, UncertainHeight)
    ]
    # what three scans do not show of themselves; of the one scan, whose only source this is, all
    assert shares == [0.5, 1.0]
    with pytest.raises(InputError, match="two or more files"):
        one.replace({"roughness.seat.files": files[:1]})


def test_blown_open_samples_make_the_upper_end_infinite(monkeypatch):
    result = rough_result()

    def some_open(samples, numbers, loads, **_):
        factor = samples.values["hardness"][list(numbers), 0]
        return np.where(factor > 1.05, np.inf, 1e-9 * factor)[:, None, None] * np.ones((2, len(loads)))

    monkeypatch.setattr(Samples, "leak_rates", some_open)
    interval = leak_interval(result, Uncertainty(samples=64, hardness=TEN_PER_CENT))
    assert np.isinf(interval.high).all()
    assert np.isfinite(interval.median).all()
    assert np.isnan(interval.shares).all()


# -------------------------------------------------------------------- inputs


@pytest.mark.parametrize("distribution", ["lognormal", "normal", "uniform"])
def test_factors_have_the_distribution_that_they_say(distribution):
    u = (np.arange(20000) + 0.5)[:, None] / 20000
    factor = UncertainInput("hardness", distribution, 0.2).values(u)[:, 0]
    assert np.median(factor) == pytest.approx(1.0, abs=1e-4)
    assert (np.diff(factor) > 0).all()
    if distribution == "lognormal":
        assert np.log(factor).std() == pytest.approx(0.2, rel=1e-3)
    elif distribution == "normal":
        # cut off at three standard deviations, which takes 1.3 % of the standard deviation
        assert factor.std() == pytest.approx(0.2 * 0.98658, rel=1e-3)
        assert factor.min() > 0.4
    else:
        assert (factor.min(), factor.max()) == pytest.approx((0.8, 1.2), abs=1e-4)


@pytest.mark.parametrize("cut_off", [0.5, 3.0, 4.0])
@pytest.mark.parametrize("of", [Normal, LogNormal])
def test_nothing_is_drawn_beyond_the_cut_off(of, cut_off):
    one = of(2.0, 0.1, cut_off=cut_off)
    ends = norm.cdf(-1.01 * cut_off), norm.cdf(1.01 * cut_off)
    assert one.quantile(np.array(ends)) == pytest.approx(one.bounds)
    inside = one.quantile(norm.cdf(0.99 * cut_off))
    assert one.bounds[0] < inside < one.bounds[1]


def test_a_wide_normal_distribution_stays_positive():
    u = np.array([[1e-12], [0.5], [1 - 1e-12]])
    assert (UncertainInput("viscosity", "normal", 0.9).values(u) > 0).all()


def test_weights_of_scans_are_uniform_over_all_sets_with_sum_one():
    from scipy.stats.qmc import Sobol

    spectrum = rough_result().surface.spectrum
    weights = UncertainScans("spectrum", (spectrum,) * 4).values(Sobol(3, seed=1).random(4096))
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-12)
    assert weights.min() >= 0
    # Dirichlet(1, 1, 1, 1): mean 1/4, variance 3/80
    np.testing.assert_allclose(weights.mean(axis=0), 0.25, atol=1e-3)
    np.testing.assert_allclose(weights.var(axis=0), 3 / 80, rtol=1e-2)


def test_mean_spectrum_keeps_the_mean_height_variance():
    a = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e3, q_rolloff=2e4, q_high=1e6)
    b = leak.PowerSpectrum.self_affine(rms_height=2e-6, hurst=0.5, q_low=2e3, q_rolloff=1e4, q_high=3e6)
    mean = UncertainScans("spectrum", (a, b)).mean(np.array([0.25, 0.75]))
    # the log-log interpolant of a sum of power laws is good to 1e-4
    assert mean.rms_height**2 == pytest.approx(0.25e-12 + 0.75 * 4e-12, rel=1e-3)


# -------------------------------------------------------------------- polynomial


def test_samples_that_one_load_seals_count_at_the_others():
    """They may be off by a share of their scatter there; with no scatter at all the smallest bound stands."""
    spread = np.exp(np.linspace(-10.0, 0.0, 101))
    sealed = np.zeros(101)
    # nine tenths of the samples lie within e^9
    assert allowed_difference(np.stack([spread, sealed], axis=1), 0.01, 0.02) == pytest.approx(
        0.18, rel=1e-12
    )
    assert allowed_difference(np.stack([spread, np.where(spread < 1e-2, 0.0, 1.0)], axis=1), 0.01, 0.02) == (
        pytest.approx(0.18, rel=1e-12)
    )
    opened = np.where(spread > 0.5, np.inf, 1e-9)
    for rates in (sealed, opened, np.full(101, np.inf)):
        assert allowed_difference(rates[:, None], 0.01, 0.02) == 0.01


def test_next_to_nothing_is_no_difference():
    """A sample that leaks a billionth of a billionth of the case, whatever the seal's size, and one that is sealed."""
    found = np.array([[2e-23, 1.02, 0.0, np.inf], [1.0, 1.0, 0.0, 5.0]])
    truth = np.array([[1e-23, 1.00, 0.0, np.inf], [1.0, 1.0, 0.0, np.nan]])
    for size in (1e-20, 1e-8, 1.0):
        of_case = np.array([size, size, 0.0, np.inf])
        off = largest_difference(found * size, truth * size, of_case)
        assert off == pytest.approx(0.02, rel=1e-6)
    # what a sealed case does not leak, a sample may
    assert largest_difference(found[:1, :1], truth[:1, :1], np.zeros(1)) == pytest.approx(1.0, rel=1e-6)
    # sealed or not is a difference
    assert largest_difference(np.array([[1e-9]]), np.array([[0.0]]), np.full(1, 1e-9)) > 1e6


def test_response_surface_is_exact_for_a_polynomial_and_knows_its_variances():
    rng = np.random.default_rng(5)
    z = rng.normal(size=(4000, 3))

    def model(z):
        return np.column_stack([2 + 3 * z[:, 0] + z[:, 1] ** 2 + 0.5 * z[:, 0] * z[:, 2], z[:, 2] ** 3])

    surface = fit(z[:120], model(z[:120]), z)
    np.testing.assert_allclose(surface(z), model(z), atol=1e-9)
    assert surface.error.max() < 1e-9
    # variances 9, 2 and 0.25, and 15, of standard normal inputs; 4000 random numbers know them to some per cent
    own = np.array([surface.variance_of([n]) for n in range(3)])
    np.testing.assert_allclose(own[:, 0], [9, 2, 0], rtol=0.15, atol=0.05)
    assert surface.variance_of([0, 2])[0] == pytest.approx(9.25, rel=0.15)
    assert own[2, 1] == pytest.approx(15, rel=0.25)
    assert surface.variance[0] == pytest.approx(11.25, rel=0.15)


def test_response_surface_says_how_wrong_it_is():
    z = np.random.default_rng(6).uniform(-1, 1, size=(500, 1))
    surface = fit(z[:20], np.abs(z[:20]), z)
    true_error = np.sqrt(np.mean((surface(z) - np.abs(z)) ** 2))
    assert 0.3 < surface.error[0] / true_error < 10


# -------------------------------------------------------------------- case file and result files


def uncertain(**table):
    return case(uncertainty=table)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"samples": 64}, "names no sampled input"),
        ({"hardness": {"relative": 0}}, "uncertainty.hardness.relative"),
        ({"hardness": {"relative": 0.1, "distribution": "gauss"}}, "uncertainty.hardness.distribution"),
        ({"hardnes": {"relative": 0.1}}, "do you mean hardness"),
        ({"samples": 256.5, "viscosity": {"relative": 0.1}}, "whole number"),
        ({"samples": True, "viscosity": {"relative": 0.1}}, "whole number"),
        ({"samples": 3, "viscosity": {"relative": 0.1}}, "16 to 100000"),
        ({"confidence": 1.0, "viscosity": {"relative": 0.1}}, "uncertainty.confidence"),
        ({"spectrum": {"distribution": "scans"}}, "two or more files"),
        ({"spectrum": {}}, "uncertainty.spectrum.distribution"),
    ],
)
def test_what_is_wrong_is_named(table, words):
    with pytest.raises(InputError, match=words):
        uncertain(**table)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"fluid": None}, r"table \[fluid\]"),
        ({"leak": {"plasticity": False}, "uncertainty": {"hardness": {"relative": 0.1}}}, "has no effect"),
    ],
)
def test_what_does_not_fit_the_other_tables_is_named(changes, words):
    with pytest.raises(InputError, match=words):
        case(**{"uncertainty": {"viscosity": {"relative": 0.1}}, **changes})


def test_shape_of_a_tabulated_spectrum_is_not_uncertain(tmp_path):
    file = tmp_path / "C.csv"
    file.write_text("1e3 1e-22\n1e5 1e-24\n")
    with pytest.raises(InputError, match="self-affine"):
        case(
            roughness={"spectrum": {"kind": "table", "file": str(file)}},
            uncertainty={"hurst": {"relative": 0.1}},
        )


def test_interval_needs_a_leak_rate():
    with pytest.raises(InputError, match="needs a table"):
        leak_interval(smooth_result(), Uncertainty(viscosity=TEN_PER_CENT))
    with pytest.raises(InputError, match="no sampled input"):
        leak_interval(rough_result(), Uncertainty())


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_result_files_hold_the_interval(tmp_path):
    result = fem_seal.run(
        case(
            leak={"plasticity": False},
            uncertainty={"samples": 64, "viscosity": {"relative": 0.1}},
        )
    )
    assert isinstance(result.uncertainty, LeakInterval)
    folder = result.write(tmp_path / "out")
    table = pd.read_csv(folder / "leak.csv")
    assert (table["leak_rate_low_m3_per_s"] < table["leak_rate_m3_per_s"]).all()
    assert (table["leak_rate_high_m3_per_s"] > table["leak_rate_m3_per_s"]).all()
    off = 1 + result.discretisation_error.leak_rate
    np.testing.assert_allclose(table["leak_rate_low_m3_per_s"], result.uncertainty.low / off, rtol=1e-9)
    words = json.loads((folder / "summary.json").read_text())
    assert words["uncertainty"]["seed"] == 1
    assert words["uncertainty"]["shares_of_variance"] == {"viscosity": [1.0] * 3}
    assert words["input"]["uncertainty"]["viscosity"] == {
        "distribution": "lognormal",
        "relative": 0.1,
        "varies": "unknown",
    }
    page = report(result, full=True).replace("\xa0", " ")
    assert 'id="uncertainty"' in page
    assert "90 %" in page
    assert "Owen" in page
    assert summary(rough_result())["uncertainty"] is None
    assert 'id="uncertainty"' not in report(rough_result(), full=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    "tables",
    [
        {"fluid": {"name": "helium"}},
        {"leak": {"plasticity": False, "fluid_in_gap": "local"}},
    ],
    ids=["gas", "fluid in the gap"],
)
def test_samples_flow_as_the_case_does(tables):
    """A sample with all factors one has the leak rate of the case, whatever flows and however."""
    result = run_loads(case(load={"fluid_pressure": "5 bar"}, **tables))
    samples = Samples(result, ((UncertainInput("rms_height", "uniform", 0.5),),), np.array([[0.5]]))
    expected = readings(result) if result.case.leak.plasticity else rates(result)
    # tables of 24 and 64 pressures
    if "fluid" in tables:
        # and with the gas of the standards' tests
        expected = np.append(
            expected, [one for load in result.loads for one in load.scenarios["test gas"].leak_range]
        )
    np.testing.assert_allclose(samples.leak_rates([0])[0].ravel(), expected, rtol=1e-3)


@pytest.mark.parametrize(
    ("curve", "outside", "asked"), [(True, True, False), (True, False, True), (False, True, True)]
)
def test_a_path_outside_the_theory_is_not_repeated_for_samples(curve, outside, asked):
    """Each sample takes as long as the run, and nothing would be claimed of the interval."""
    hardening = (
        {"stress_strain": {"plastic_strain": [0, 0.1], "stress": ["200 MPa", "400 MPa"]}} if curve else {}
    )
    seat = {"shape": "cone", "angle": "45 deg"}
    metal = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "2 GPa"} | hardening
    one = case(seat=seat | {"material": metal}, uncertainty={"hardness": {"relative": 0.1}})
    seal = Mock(case=one, loads=[Mock(validity=Mock(outside_theory=outside))])
    assert module.UNCERTAINTY.applies(seal, Mock()) is asked
