"""What a leak test says about a seal: against closed forms, over many synthetic tests, and through files."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from places import EXAMPLES
from sample_results import tiles_of

import fem_seal
from fem_seal.answers.calibration import (
    LearnedInput,
    _group,
    _Joint,
    _pass_chance,
    calibrate,
    percentiles,
    weights_of,
)
from fem_seal.answers.conflict import Data, conflict_of, data_p_value
from fem_seal.answers.measurements import TRUTHS, Draws, weighted_quantiles
from fem_seal.answers.posterior import Posterior
from fem_seal.answers.samples import drawn_values, uncertain_inputs
from fem_seal.case.measured import read_measured, read_measured_text
from fem_seal.cli.app import main
from fem_seal.output import calibration as module
from fem_seal.output.answers.error_shares import input_name
from fem_seal.output.answers.leak import leakage_lines
from fem_seal.output.answers.uncertainty import interval_notes, interval_table
from fem_seal.output.answers.verdict import verdict_sentences
from fem_seal.output.calibration import _input_row, lines, write_calibration
from fem_seal.output.pictures.leak import leak_picture
from fem_seal.output.pictures.style import style
from fem_seal.sampling import sobol_points
from fem_seal.seal.findings import Bounds
from fem_seal.studies.responses import evaluate_design
from fem_seal.units import Display
from leak import error_correlation

HEADER = "fluid_pressure [bar], leak_rate [ml/min], uncertainty [%], below\n"


def seal(**changes):
    case = fem_seal.load_case(EXAMPLES / "ball_cone.toml")
    return case.replace(
        {
            "leak.theory": "corrected",
            "load.fluid_pressure": ["5 bar", "20 bar"],
            "load.applied_force": "1 kN",
            "uncertainty": {"hardness": {"relative": 0.1}, "rms_height": {"relative": 0.2}},
            **{key.replace("__", "."): value for key, value in changes.items()},
        }
    )


def table(folder, *rows, header=HEADER):
    path = folder / "measured.csv"
    path.write_text(header + "".join(f"{row}\n" for row in rows), encoding="utf-8")
    return path


# -------------------------------------------------------------------- Bayes' rule


def linear(draws=2**15, seed=0):
    """ln Q of three loads, linear in two normal inputs, the first two measured."""
    x = np.random.default_rng(seed).standard_normal((draws, 2))
    slopes = np.array([[0.8, 0.1], [0.6, -0.3], [0.7, 0.4]])
    return x, slopes, x @ slopes.T


def test_the_linear_gaussian_case_is_that_of_its_closed_form():
    x, slopes, y = linear(2**18)
    data = Data(np.array([0.5, 0.2]), np.array([0.3, 0.2]), np.array([False, False]))
    weights = weights_of(data.log_likelihood(y[:, :2]))
    A, noise = slopes[:2], np.diag(data.spread**2)
    gain = A.T @ np.linalg.inv(A @ A.T + noise)
    mean, covariance = gain @ data.y, np.eye(2) - gain @ A
    low, middle, high = percentiles(y[:, 2], weights)
    expected = float(slopes[2] @ mean), 1.645 * math.sqrt(float(slopes[2] @ covariance @ slopes[2]))
    assert middle == pytest.approx(expected[0], abs=0.01 * expected[1])
    assert 0.5 * (high - low) == pytest.approx(expected[1], rel=0.01)
    for n in range(2):
        low, _, high = percentiles(x[:, n], weights)
        assert 0.5 * (high - low) == pytest.approx(1.645 * math.sqrt(covariance[n, n]), rel=0.01)


def check_coverage(y, seed):
    """200 truths of the prior, the first two loads measured to 10 %, the third predicted."""
    before = percentiles(y[:, 2], np.full(len(y), 1.0 / len(y)))
    random = np.random.default_rng(seed)
    held, shares = 0, []
    for truth in random.choice(len(y), 200, replace=False):
        seen = y[truth, :2] + 0.1 * random.standard_normal(2)
        data = Data(seen, np.full(2, 0.1), np.zeros(2, dtype=bool))
        low, _, high = percentiles(y[:, 2], weights_of(data.log_likelihood(y[:, :2])))
        held += low <= y[truth, 2] <= high
        shares.append((high - low) / (before[2] - before[0]))
    assert 170 <= held <= 190
    assert sum(share < 1.0 for share in shares) >= 190
    assert max(shares) < 1.1


@pytest.mark.slow
def test_intervals_of_synthetic_tests_hold_the_truth_as_often_as_they_say():
    """200 truths of the prior, readings with noise: 90 % intervals, narrower than those of the prior."""
    _, _, y = linear()
    error = (
        np.random.default_rng(5).standard_normal((len(y), 3))
        @ np.linalg.cholesky(error_correlation([7.0, 7.3, 7.8]) + 1e-9 * np.eye(3)).T
    )
    y = y + 0.1 * error
    check_coverage(y, seed=7)


def test_a_leak_of_ten_times_the_end_of_the_prior_is_a_conflict_and_data_of_the_prior_are_none():
    _, _, y = linear()
    spread, below = np.full(2, 0.1), np.zeros(2, dtype=bool)
    end = np.array([percentiles(one, np.full(len(y), 1.0 / len(y)))[2] for one in y[:, :2].T])
    assert data_p_value(y[:, :2], Data(end + math.log(10.0), spread, below), 1) < 0.02
    random = np.random.default_rng(3)
    found = [
        data_p_value(y[:, :2], Data(y[n, :2] + spread * random.standard_normal(2), spread, below), 1)
        for n in random.choice(len(y), 100, replace=False)
    ]
    assert sum(p < 0.02 for p in found) <= 5
    assert np.mean(found) == pytest.approx(0.5, abs=0.1)
    # one that the instrument does not see although every draw leaks far more
    unseen = Data(y[:, :2].min(axis=0) - 5.0, spread, np.ones(2, dtype=bool))
    assert data_p_value(y[:, :2], unseen, 1) < 0.02


def test_readings_below_the_limit_leave_the_draws_that_leak_less():
    _, _, y = linear()
    data = Data(np.array([0.0]), np.array([0.01]), np.array([True]))
    weights = weights_of(data.log_likelihood(y[:, :1]))
    assert weighted_quantiles(y[:, 0], weights, (0.999,) * 3)[0] < 0.02
    assert weights[y[:, 0] < -0.1].sum() == pytest.approx(1.0 - weights[y[:, 0] >= -0.1].sum())


def force_test(leak_rates, uncertainty=0.05, level=0.5):
    """Readings at four forces, of a seal whose leak rate falls as theirs does; the level is open."""
    away = level * np.random.default_rng(1).standard_normal((2000, 1))
    spread = np.full(4, uncertainty)
    data = Data(np.log(leak_rates), spread, np.zeros(4, dtype=bool))
    return conflict_of(EXPECTED + away, data, np.full(4, 1e6))


EXPECTED = np.log([8e-9, 3e-9, 9e-10, 2e-10])


@pytest.mark.parametrize("share", [0.3, 1.0, 3.0, 30.0])
def test_a_leak_that_no_force_closes_is_found_with_its_leak_rate(share):
    """Theory: a scratch adds as much at each force; also where it hides among the leak rates that are expected."""
    scratch = share * 1e-9
    found = force_test(np.exp(EXPECTED) + scratch)
    assert found.likeliest.name == "path"
    assert found.likeliest.size == pytest.approx(scratch, rel=0.1)
    first, second, *_ = found.probabilities.values()
    assert sum(found.probabilities.values()) == pytest.approx(1.0)
    assert first / second > 3.0


@pytest.mark.parametrize(
    ("leak_rates", "name", "size", "readings"),
    [
        (30.0 * np.exp(EXPECTED), "factor", 30.0, ()),
        (np.exp(EXPECTED) / 30.0, "factor", 1.0 / 30.0, ()),
        (np.exp(EXPECTED)[[0, 2, 1, 3]], "order", 2.0, (1, 2)),
        (np.exp(EXPECTED)[::-1], "order", 4.0, (0, 1, 2, 3)),
        (np.exp(EXPECTED) * [1.0, 1000.0**0.5, 1.0, 1.0], "reading", 1000.0**0.5, (1,)),
        (np.exp(EXPECTED.mean() + 1.3 * (EXPECTED - EXPECTED.mean())), "slope", 1.3, ()),
    ],
)
def test_each_explanation_is_named_where_it_is_true(leak_rates, name, size, readings):
    found = force_test(leak_rates)
    assert found.likeliest.name == name
    assert found.likeliest.size == pytest.approx(size, rel=0.15)
    assert found.likeliest.readings == readings
    assert found.probabilities[name] > 0.8


def test_readings_of_one_load_that_contradict_each_other_are_told():
    random = np.random.default_rng(3)
    one = 0.2 * random.standard_normal(40000)
    y = np.stack([one, one, one + 1.0, one + 1.0], axis=1)
    away = np.array([0.3, -0.3, 0.2, -0.2])
    data = Data(y.mean(axis=0) + away, np.full(4, 0.05), np.zeros(4, dtype=bool))
    found = conflict_of(y, data, np.ones(4))
    # by hand: the likelihood of a variance v is greatest where 0.26/v^2 = 3/v + 1/(v + 4 0.2^2)
    variance = np.linspace(0.05, 0.12, 20001)
    best = variance[np.argmin(0.26 / variance + 3 * np.log(variance) + np.log(variance + 0.16))]
    assert found.likeliest.name == "scatter"
    assert found.likeliest.size == pytest.approx(math.sqrt(best), rel=0.02)


def test_one_reading_alone_knows_a_factor_and_a_sealed_draw_costs_nothing():
    y = np.full((500, 1), -1e3)
    found = conflict_of(y, Data(np.array([-20.0]), np.array([0.1]), np.array([False])), np.ones(1))
    assert [one.name for one in found.explanations] == ["factor"]
    assert math.isfinite(found.factor) and found.factor > 1e6


def test_the_expected_width_is_that_of_the_closed_form():
    _, slopes, y = linear(4096)
    noise = np.random.default_rng(1).standard_normal((TRUTHS, 1))
    draws = Draws(0.9, {}, y.T[None], np.zeros(len(y)), noise)
    found = draws.width(draws.log_rate[:, 2], draws.weigh_test(0, 0.2, Bounds(1.0, 1.0)))
    a, b = slopes[0], slopes[2]
    left = b @ b - (a @ b) ** 2 / (a @ a + 0.2**2)
    assert found == pytest.approx(3.29 * math.sqrt(left), rel=0.05)


def test_draws_go_through_their_file(tmp_path):
    random = np.random.default_rng(2)
    draws = Posterior({"hardness": random.random(64)}, np.array([7.0, 8.0]), random.standard_normal((64, 2)))
    read = Posterior.read(draws.write(tmp_path / "posterior.csv"))
    assert read.of_inputs(["hardness"])[:, 0] == pytest.approx(draws.uniform["hardness"], rel=1e-8)
    # what is known stays, between both it follows from both, far away it is free
    there = read.error_at(np.array([7.0, 7.5, 12.0]), 1)
    assert there[0] == pytest.approx(draws.error[:, 0], abs=0.01)
    assert abs(np.corrcoef(there[2], draws.error[:, 1])[0, 1]) < 0.35
    assert np.corrcoef(there[1], draws.error.sum(axis=1))[0, 1] > 0.9
    with pytest.raises(fem_seal.InputError, match="has no draws of rms_height"):
        read.of_inputs(["rms_height"])


# -------------------------------------------------------------------- readings


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_readings_in_any_encoding(tmp_path, encoding):
    path = tmp_path / "test.csv"
    text = "% Prüfstand 7\nfluid_pressure [bar];leak_rate [µl/min];uncertainty\n5;1,2;5 %\n"
    path.write_bytes(text.replace("\n", "\r\n").encode(encoding))
    (found,) = read_measured(seal(), path)
    assert (found.fluid_pressure, found.uncertainty, found.line) == pytest.approx((5e5, 0.05, 3))
    assert found.leak_rate == pytest.approx(1.2e-9 / 60.0)


def test_readings_in_any_unit(tmp_path):
    case = seal()
    path = table(tmp_path, "5; 1,2; 5; no", "10; 3 cm^3/h; ; yes", header=HEADER.replace(",", ";"))
    first, second = read_measured(case, path)
    assert first.fluid_pressure == pytest.approx(5e5)
    assert first.leak_rate == pytest.approx(1.2e-6 / 60.0)
    assert (first.uncertainty, first.is_below) == (0.05, False)
    assert second.leak_rate == pytest.approx(3e-6 / 3600.0)
    assert (second.uncertainty, second.is_below) == (0.1, True)
    assert first.applied_force == second.applied_force == 1000.0
    frame = pd.DataFrame({"fluid_pressure_Pa": [5e5], "leak_rate_m3_per_s": [2e-8], "fluid": ["nitrogen"]})
    (gas,) = read_measured_text(case, frame.to_csv(index=False))
    assert gas.case.fluid.name == "nitrogen"
    assert gas.leak_rate == pytest.approx(2e-8)


@pytest.mark.parametrize(
    ("rows", "header", "words"),
    [
        (["5, x, 5, no"], HEADER, r"line 2, column leak_rate"),
        (["5, 1, 5, no", "-1, 1, 5, no"], HEADER, r"line 3, column fluid_pressure"),
        (["5, 1, 5, perhaps"], HEADER, r'line 2, column below = "perhaps"'),
        (["5, 1, 0, no"], HEADER, r'line 2, column uncertainty = "0"'),
        (
            ["5, 0.0, 5, no"],
            HEADER,
            r'line 2, column leak_rate = "0.0": .* write "<" and the smallest leak rate',
        ),
        (["5, 1, 5, no", "9, , 5, no"], HEADER, r"line 3, column leak_rate: is empty"),
        (["5, , 5, no"], HEADER, r"leak_rate: is empty in all 1 rows: nothing is measured yet"),
        (["5, 1, 5"], HEADER, r"line 2: has 3 cells, the header has 4"),
        (["5, 1"], "fluid_pressure, leak_rate [ml/min]\n", r"line 2, column fluid_pressure"),
        (["5, 1"], "fluid_pressure [bar], temperature [degC]\n", r"temperature: no known column"),
        (["5"], "fluid_pressure [bar]\n", r"leak_rate: the table has no such column"),
        (["5, 1, beer"], "fluid_pressure [bar], leak_rate [ml/min], fluid\n", r"line 2, column fluid"),
        ([], HEADER, r"holds no reading"),
    ],
)
def test_a_wrong_row_is_named_by_line_and_column(tmp_path, rows, header, words):
    with pytest.raises(fem_seal.InputError, match=words):
        read_measured(seal(), table(tmp_path, *rows, header=header))


# -------------------------------------------------------------------- whole calibrations


@pytest.mark.slow
def test_a_test_narrows_the_prediction_and_the_calibrated_case_has_it(tmp_path, capsys):
    """A rougher seal is measured at three pressures; the case that comes out gives its interval."""
    rougher = seal(load__fluid_pressure=["5 bar", "10 bar", "15 bar", "20 bar"], uncertainty=None)
    rougher = rougher.replace({"roughness.spectrum.rms_height": "2.2 um"})
    *shown, truth = [load.leak.leak_rate * 6e7 for load in fem_seal.run(rougher).loads]
    path = table(tmp_path, *(f"{p}, {q:.4g}, 5, no" for p, q in zip((5, 10, 15), shown, strict=True)))
    case = tmp_path / "seal.toml"
    from fem_seal.case.case import case_text

    case.write_text(case_text(seal().written, tmp_path), encoding="utf-8")
    assert main(["calibrate", str(case), str(path), "--quiet"]) == 0
    folder = tmp_path / "seal.calibrated"
    names = {"calibrated.toml", "inputs.csv", "next_tests.csv", "posterior.csv", "predictions.csv"}
    assert {one.name for one in folder.iterdir() if one.is_file()} >= names | {"report.html", "summary.json"}
    last = pd.read_csv(folder / "predictions.csv").iloc[-1] * 6e7
    low, high = last["leak_rate_p05_m3_per_s"], last["leak_rate_p95_m3_per_s"]
    assert low < truth < high
    assert (
        high / low < 1.5 < 4.0 < last["prior_leak_rate_p95_m3_per_s"] / last["prior_leak_rate_p05_m3_per_s"]
    )
    inputs = pd.read_csv(folder / "inputs.csv", index_col="input")
    assert inputs.learned["rms_height"] > 0.7 > 0.2 > inputs.learned["hardness"]
    assert inputs.p05["rms_height"] < 2.2 / 1.9 < inputs.p95["rms_height"]
    told = json.loads((folder / "summary.json").read_text("utf-8"))
    assert told["conflict"] is None
    assert told["p_value"] > 0.05
    assert sum(told["alternatives"].values()) == pytest.approx(1.0)
    # a case whose draws are gone is no case
    with pytest.raises(fem_seal.InputError, match=r"uncertainty\.posterior.*no such file"):
        fem_seal.load_case(folder / "calibrated.toml").replace({"uncertainty.posterior": "gone.csv"})
    # every other command takes the case
    interval = fem_seal.run(folder / "calibrated.toml").uncertainty
    assert interval.samples == 512
    assert interval.low[-1] * 6e7 == pytest.approx(low, rel=0.03)
    assert interval.high[-1] * 6e7 == pytest.approx(high, rel=0.03)
    # the seal as it was given is not among those that show the readings
    judged = fem_seal.run(
        fem_seal.load_case(folder / "calibrated.toml").replace(
            {"requirement.leak_rate": 0.5 * (interval.low[-1] + interval.high[-1])}
        )
    )
    assert judged.highest.leak_interval.low == pytest.approx(interval.low[-1], rel=0.01)
    assert 0.05 < judged.highest.chance.share < 0.95


@pytest.mark.slow
def test_intervals_of_a_real_seal_hold_the_truth_as_often_as_they_say():
    """200 seals of the prior of a case, with the theory's error, readings at 5 and 10 bar, 20 bar predicted."""
    case = seal(load__fluid_pressure=["5 bar", "10 bar", "20 bar"])
    case = case.replace({"uncertainty": {"viscosity": {"relative": 0.05}, "q_high": {"relative": 0.3}}})
    inputs = uncertain_inputs(case, case.uncertainty)
    drawn = drawn_values(inputs, sobol_points(2**15, len(inputs), 1))
    values = {one.name: one.reported_values(drawn[one.name]) for one in inputs}
    joint = _Joint.of([_group(case, case.uncertainty, values, lambda text: None)], seed=3)
    check_coverage(joint.y, seed=11)


@pytest.mark.slow
def test_a_seal_that_leaks_a_hundred_times_more_is_a_conflict(tmp_path):
    case = seal(uncertainty={"hardness": {"relative": 0.1}})
    found = calibrate(case, read_measured(case, table(tmp_path, "5, 2000, 10, no", "20, 5000, 10, no")))
    assert found.p_value < 0.02
    assert found.conflict is not None
    assert found.conflict.factor > 10.0
    (line,) = lines(found)
    assert line.startswith("Conflict: ")
    assert "line 3 is farthest off" in line or "line 2 is farthest off" in line
    assert f"The factor is {found.conflict.likeliest.size:.0f}" in line
    write_calibration(found, tmp_path)
    # nothing that others could take for known
    assert not list(tmp_path.glob("calibrated.toml"))
    assert not found.is_usable


@pytest.mark.slow
def test_a_seal_tighter_than_it_can_be_is_a_conflict_too(tmp_path):
    case = seal(uncertainty={"hardness": {"relative": 0.1}})
    path = table(tmp_path, "5, 1e-4, 10, yes", "20, 1e-4, 10, yes")
    found = calibrate(case, read_measured(case, path))
    assert found.conflict is not None
    assert found.conflict.factor < 1e-3
    assert any("less leaks than expected" in line for line in lines(found))


def test_a_conflict_is_told_quietly_too_and_takes_an_earlier_calibrated_case_away(
    tmp_path, capsys, monkeypatch
):
    for name in ("calibrated.toml", "posterior.csv", "own.csv"):
        (tmp_path / name).write_text("of an earlier test\n", encoding="utf-8")
    monkeypatch.setattr(fem_seal, "calibrate", lambda *_: SimpleNamespace(is_usable=False), raising=False)
    monkeypatch.setattr(module, "lines", lambda _: iter(["Conflict: the readings contradict the inputs."]))
    monkeypatch.setattr(module, "write_calibration", lambda _, draft: (draft / "summary.json").touch())
    words = ["calibrate", str(EXAMPLES / "ball_cone.toml"), "measured.csv", "-o", str(tmp_path), "-q"]
    assert main(words) == 0
    assert "warning: Conflict: the readings contradict the inputs." in capsys.readouterr().err
    assert {path.name for path in tmp_path.iterdir()} == {"own.csv", "summary.json"}


def test_without_a_leak_rate_nothing_is_calibrated(tmp_path):
    case = seal(fluid=None, uncertainty=None, load__target_leak_rate=None)
    with pytest.raises(fem_seal.InputError, match=r"needs \[roughness\], \[fluid\]"):
        calibrate(case, ())


def test_bolts_are_told_apart_from_a_force(tmp_path):
    bolts = {"number": 4, "size": "M6", "length": "34 mm", "material": "steel", "preload": "800 N"}
    case = seal(load__applied_force=None, bolts=bolts)
    with pytest.raises(fem_seal.InputError, match=r"applied_force in place of \[bolts\]"):
        fem_seal.calibrate(case, table(tmp_path, "5, 1, 10, no"))


# -------------------------------------------------------------------- after the test


@pytest.fixture(scope="module")
def after(tmp_path_factory):
    """A calibration of a seal that is rougher than given, with a requirement that its true leak rate just meets."""
    rougher = seal(load__fluid_pressure=["5 bar", "10 bar", "15 bar", "20 bar"], uncertainty=None)
    rougher = rougher.replace({"roughness.spectrum.rms_height": "2.2 um"})
    *shown, truth = [load.leak.leak_rate for load in fem_seal.run(rougher).loads]
    rows = [f"{p}, {q * 6e7:.4g}, 5, no" for p, q in zip((5, 10, 15), shown, strict=True)]
    case = seal(requirement={"leak_rate": f"{1.02 * truth!r} m^3/s", "fluid_pressure": "20 bar"})
    folder = tmp_path_factory.mktemp("after")
    found = calibrate(case, read_measured(case, table(folder, *rows, "10, <40, , ")))
    write_calibration(found, folder)
    return found, folder, fem_seal.run(folder / "calibrated.toml")


@pytest.mark.slow
def test_the_median_after_the_test_leads(after):
    found, _, run = after
    load, told = run.highest, leakage_lines(run.case, run.highest, run.loads)
    assert load.leak_rate_p50 == pytest.approx(found.predictions[-1].posterior[1], rel=0.03)
    assert load.leak_rate_p50 == pytest.approx(run.uncertainty.median[-1])
    assert run.table["leak_rate_p50_m3_per_s"].tolist() == pytest.approx(run.uncertainty.median.tolist())
    # the calculated one keeps its meaning, and lies below all that the test has left
    assert run.table["leak_rate_m3_per_s"].iloc[-1] == load.leak.leak_rate < run.uncertainty.low[-1]
    middle = Display().leak_range(load.leak_rate_p50, 2, beside=load.leak_interval)
    assert told[0].startswith(f"Leak rate at 20 bar after the leak test: {middle} (")
    assert "Before the leak test, with the inputs as stated, it was" in "".join(told)
    assert tiles_of(run)["Leak rate"].value.startswith(f"{middle} (")
    first, share, *_ = verdict_sentences(run)
    assert first.startswith("Inconclusive at 20 bar after the leak test: ")
    assert "of seals that show the measured leak rates" in share


@pytest.mark.slow
def test_calibrate_gives_the_verdict_that_the_calibrated_case_gives(after):
    found, folder, run = after
    assert found.solution.verdict == run.verdict == "inconclusive"
    assert found.solution.margin == pytest.approx(run.margin, rel=0.03)
    assert found.solution.highest.chance.share == pytest.approx(run.highest.chance.share, abs=0.06)
    told = json.loads((folder / "summary.json").read_text("utf-8"))["requirement"]
    assert (told["verdict"], told["fluid_pressure_Pa"]) == ("inconclusive", 2e6)
    assert told["pass_probability"] == found.solution.highest.chance.share
    # by hand: the share of the draws in the table that keep the limit
    sure = [one for one in lines(found) if one.startswith("Inconclusive at 20 bar after the leak test")]
    assert len(sure) == 1 and "Inconclusive at 20" in (folder / "report.html").read_text("utf-8")
    easy = found.case.replace({"requirement.leak_rate": 2.0 * found.predictions[-1].posterior[2]})
    assert _pass_chance(easy, found.solution.highest, *normal_draws(found)).share == pytest.approx(1.0)
    assert (
        _pass_chance(found.case.replace({"requirement": None}), found.solution.highest, *normal_draws(found))
        is None
    )


def normal_draws(found):
    low, middle, high = np.log(found.predictions[-1].posterior)
    y = middle + (high - low) / 3.29 * np.random.default_rng(1).standard_normal(4000)
    return y, np.full(4000, 1.0 / 4000)


@pytest.mark.slow
def test_shares_after_a_test_are_what_it_has_left_open(after):
    _, _, run = after
    shares = run.error_shares[-1].of_width
    assert not {"inputs together", "hardness", "rms_height"} & set(shares)
    assert shares["left by test"] > 0.0
    assert input_name("left by test") == "what the leak test has left open"
    headings, rows = interval_table(run).headings, interval_table(run).rows
    assert headings[-2].startswith("median [")
    assert headings[-1] == "what the leak test has left open [%]"
    assert len(rows[-1]) == len(headings)
    assert float(rows[-1][-1]) == pytest.approx(100.0 * shares["left by test"], abs=0.5)
    notes = " ".join(interval_notes(run, run.case.display))
    assert "no input has a share of its own" in notes and "interactions" not in notes
    assert b"median after the leak test" in leak_picture(run).svg


@pytest.mark.slow
def test_goals_of_a_study_over_the_calibrated_case_use_the_median(after):
    _, folder, run = after
    study = fem_seal.Study(
        fem_seal.load_case(folder / "calibrated.toml"),
        responses=["leak_rate_m3_per_s"],
        parameters={"load.fluid_pressure": ["20 bar"], "load.applied_force": ["1 kN", "1.2 kN"]},
        report={"goals": {"leak_rate_m3_per_s": "min"}},
    )
    assert list(study.goals) == ["leak_rate_p50_m3_per_s"]
    values = evaluate_design(study.case_of([2e6, 1000.0]), ["leak_rate_p50_m3_per_s"]).values
    assert values["leak_rate_p50_m3_per_s"] == pytest.approx(run.highest.leak_rate_p50, rel=0.01)
    plain = fem_seal.Study(
        seal(),
        responses=["leak_rate_m3_per_s"],
        parameters={"load.fluid_pressure": ["20 bar"]},
        report={"goals": {"leak_rate_m3_per_s": "min"}},
    )
    assert list(plain.goals) == ["leak_rate_m3_per_s"]


@pytest.mark.slow
def test_lines_and_table_say_how_the_seat_differs(after):
    found, folder, _ = after
    last = found.predictions[-1]
    ratio = f" {last.posterior[1] / last.prior[1]:.2g} times what was expected"
    (direction,) = (line for line in lines(found) if ratio in line)
    assert "its interval narrowed from a factor of" in direction
    units = pd.read_csv(folder / "inputs.csv", index_col="input").unit
    assert units.to_dict() == {"hardness": "factor", "rms_height": "factor", "theory": "factor"}
    # of a finish values have units, and waves are told by their length
    row = _input_row(Display(), LearnedInput("q_rolloff", (1e5, 3e5, 6e5), (2e5, 3e5, 4e5), "1/m"))
    assert row == ["roll-off [µm]", "10.5", "20.9", "62.8", "15.7", "20.9", "31.4", "61 %"]
    assert _input_row(Display(), LearnedInput("Ra", (2e-7, 3e-7, 4e-7), (2e-7, 3e-7, 4e-7), "m"))[:3] == [
        "Ra in its range [µm]",
        "0.200",
        "0.300",
    ]


@pytest.mark.slow
def test_each_other_theory_and_history_is_told_against_that_of_the_case(after):
    found = replace(after[0], alternatives={"corrected": 0.49, "paper": 0.5, "first loading": 0.01})
    told = [one for one in lines(found) if "as likely by" in one or "do not decide" in one]
    assert told == [
        "The readings do not decide between the paper's theory and the corrected theory.",
        "The readings are 49.0 times as likely by a seal with the earlier load as stated as by a seal that was never "
        "closed harder.",
    ]


@pytest.mark.slow
def test_the_picture_has_bands_through_the_readings_and_an_arrow_at_a_limit(after, monkeypatch):
    found, _, _ = after
    drawn = {}
    monkeypatch.setattr(module, "captioned", lambda display, figure, *_: drawn.update(axes=figure.axes[0]))
    with style():
        module.calibration_picture(found)
    before, posterior = (one.get_paths()[0].vertices for one in drawn["axes"].collections[:2])
    assert sorted(set(before[:, 0])) == pytest.approx([5.0, 10.0, 15.0, 20.0])
    assert np.ptp(np.log(posterior[posterior[:, 0] == 20.0, 1])) < np.ptp(
        np.log(before[before[:, 0] == 20.0, 1])
    )
    names = drawn["axes"].get_legend_handles_labels()[1]
    assert {"before the test", "after it", "measured", "measured: less than this"} == set(names)


@pytest.mark.parametrize(("cell", "below"), [("<0.3", ""), ("< 0.3", "yes"), ("0.3", "yes")])
def test_less_than_a_limit_is_written_in_either_way(tmp_path, cell, below):
    (one,) = read_measured(seal(), table(tmp_path, f"5, {cell}, 10, {below}"))
    assert one.is_below
    assert one.leak_rate == pytest.approx(0.3e-6 / 60.0)


def test_less_than_a_limit_that_is_none_is_an_error(tmp_path):
    with pytest.raises(fem_seal.InputError, match=r'line 2, column below = "no".*less does'):
        read_measured(seal(), table(tmp_path, "5, <0.3, 10, no"))


@pytest.mark.slow
def test_a_calibrated_case_is_not_calibrated_again(after):
    found, folder, _ = after
    with pytest.raises(fem_seal.InputError, match=r"uncertainty.posterior.*both tests in one table"):
        calibrate(fem_seal.load_case(folder / "calibrated.toml"), found.readings)
