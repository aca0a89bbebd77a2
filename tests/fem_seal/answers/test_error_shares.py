"""What makes an interval as wide as it is, checked by leaving the sources out."""

from __future__ import annotations

import json
import math
from functools import cache

import numpy as np
import pytest
from sample_results import SPECTRUM, case, run_loads

import fem_seal
import leak
from fem_seal.answers.error_shares import ErrorShares, error_shares, finish_variance
from fem_seal.output.answers.error_shares import (
    _measurements_worth_it,
    measurement_in_brief,
    measurement_table,
    shares_in_brief,
)
from fem_seal.output.answers.verdict import verdict_sentences
from fem_seal.output.files import write_summary
from fem_seal.seal.findings import Bounds
from fem_seal.units import format_digits
from leak.surfaces.random import height_scatter

CORRECTED = {"theory": "corrected"}
# Waves longer than the contact is wide.
FEW = {"spectrum": SPECTRUM | {"rms_height": "1 um", "q_rolloff": "5e3 1/m"}}
SPREADS = {"rms_height": {"relative": 0.15}, "q_rolloff": {"relative": 0.4}, "viscosity": {"relative": 0.05}}


@cache
def result(*without: str, theory: str = "corrected") -> fem_seal.SealResult:
    spreads = {name: one for name, one in SPREADS.items() if name not in without}
    table = {"samples": 512, **spreads} if spreads else None
    made = case(load={"fluid_pressure": "20 bar"}, leak={"theory": theory}, uncertainty=table)
    return run_loads(made, interval=True)


def shares_of(found: fem_seal.SealResult) -> ErrorShares:
    return error_shares(found.loads[0], found.uncertainty, 0)


@pytest.mark.slow
@pytest.mark.parametrize("without", list(SPREADS))
def test_what_is_known_exactly_leaves_the_factor_that_is_told(without):
    told, ends = shares_of(result()), result(without).loads[0].leak_interval
    assert math.log(told.left[without]) == pytest.approx(math.log(ends.high / ends.low), rel=0.05)


@pytest.mark.slow
def test_shares_are_of_the_whole_and_the_largest_stands_first():
    found = shares_of(result())
    shares = list(found.of_width.values())
    assert shares == sorted(shares, reverse=True) and sum(shares) == pytest.approx(1.0, rel=1e-9)
    ends = result().loads[0].leak_interval
    assert found.factor == pytest.approx(ends.high / ends.low, rel=1e-12)
    assert set(found.of_width) >= {*SPREADS, "gap law", "few waves", "yielding"}
    assert max(found.of_width["gap law"], found.of_width["few waves"]) < 0.1 < found.of_width["rms_height"]


@pytest.mark.slow
def test_own_error_and_inputs_add_their_variances():
    """The interval of both is narrower than the product of their intervals, and wider than either."""
    both, inputs, own = result().loads[0], result().uncertainty, result(*SPREADS).loads[0]
    ends = np.quantile(inputs.leak_rate[0], (0.05, 0.95))
    widths = [math.log(high / low) for low, high in (both.leak_interval, ends, own.theory_error)]
    assert widths[0] == pytest.approx(math.hypot(*widths[1:]), rel=0.03)
    assert own.theory_error.is_range and both.leak_validity.leak_factor == (1.0, 1.0)


def test_samples_without_any_spread_have_the_error_of_the_theory():
    narrow = case(
        load={"fluid_pressure": "20 bar"}, leak=CORRECTED, uncertainty={"viscosity": {"relative": 1e-6}}
    )
    (load,) = run_loads(narrow, interval=True).loads
    told = Bounds(*(one / load.leak.leak_rate for one in load.sample_ends))
    assert told == pytest.approx(load.flow_error.factor([0.05, 0.95]), rel=5e-3)


@pytest.mark.slow
def test_the_papers_theory_has_its_readings_and_no_error_of_its_own():
    found = shares_of(result(*SPREADS, theory="paper"))
    assert list(found.of_width) == ["readings"] and found.left["readings"] == pytest.approx(1.0)
    sampled = result(theory="paper")
    assert sampled.uncertainty.own_error == [None]
    assert sampled.uncertainty.high == pytest.approx(
        max(
            np.quantile(one[0], 0.95)
            for one in (sampled.uncertainty.leak_rate, *sampled.uncertainty.others.values())
        )
    )


@pytest.mark.slow
def test_the_sentence_and_the_summary_have_them(tmp_path):
    told = shares_in_brief(result(), 0)
    assert "spans a factor of" in told and "rms height" in told
    measured = measurement_in_brief(result(), 0)
    assert "a leak rate measured to 10 % at 20 bar (to a factor of 1.4 from " in measured
    close = run_loads(case(load={"fluid_pressure": "20 bar"}, roughness=FEW, leak=CORRECTED))
    assert "waves longer than the contact" in shares_in_brief(close, 0)
    assert shares_in_brief(result(*SPREADS, theory="paper"), 0) == ""
    summary = json.loads(write_summary(result(), tmp_path / "summary.json").read_text(encoding="utf-8"))
    (entry,) = summary["error_shares"]
    (shares,) = result().error_shares
    assert entry["of_width"] == pytest.approx(dict(shares.of_width))
    assert [one["left"] for one in entry["measurements"]] == [one.left for one in shares.measurements]
    table = measurement_table(result())
    assert len(table.rows) == len(shares.measurements)
    whats, factors = [row[0] for row in table.rows], [row[3] for row in table.rows]
    assert {"rms height", "roll-off", "viscosity", "leak rate at 20 bar"} < {*whats}
    assert factors == [format_digits(shares.factor, 2)] * len(factors)


LAPPED = {
    "seat": {"Ra": "0.2 um", "process": "lapped"},
    "closure": {"Ra": "0.025 um", "process": "polished"},
}


def measured(problem, folder, seed, height=1.0):
    """The same case after line scans of both faces that show what is usual for the finishes, or other heights."""
    faces = {}
    for number, (key, one) in enumerate(problem.roughness.finishes.items()):
        length = 7.0 * one.finish.band.lambda_c
        x, h = leak.random_line_scan(
            one.surface().across, length=length, points=int(length / 0.5e-6), seed=10 * seed + number
        )
        rows = [f"{1e3 * a:.4f},{1e6 * height * b:.5f}" for a, b in zip(x, h, strict=True)]
        file = folder / f"{key}{seed}.csv"
        file.write_text("\n".join(["x [mm],height [um]", *rows]), encoding="utf-8")
        faces[key] = {"kind": "profile", "file": str(file)}
    return problem.replace({"roughness": faces, "uncertainty": {"samples": 256}})


def finished(**tables):
    return case(load={"fluid_pressure": "20 bar"}, roughness=LAPPED, leak=CORRECTED, **tables)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_a_measured_profile_leaves_what_was_foretold(tmp_path, seed):
    """By doing it: a finish of 0.2 um leaves a factor of 3 before, one line scan of each face 1.4 to 1.6."""
    found = fem_seal.run(finished())
    (shares,) = found.error_shares
    assert shares.factor > 2.5 and shares.by_profiles.length == pytest.approx(5.6e-3)
    profile = "one measured profile of 5.6 mm of each face that has a drawing's finish"
    assert dict(_measurements_worth_it(found, shares))[profile] == shares.by_profiles.left
    (after,) = fem_seal.run(measured(finished(), tmp_path, seed)).error_shares
    assert after.factor == pytest.approx(shares.by_profiles.left, rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize(("height", "verdict"), [(0.92, "pass"), (1.3, "fail")])
def test_an_open_verdict_says_which_heights_would_pass(tmp_path, height, verdict):
    """0.27 ml/min is allowed, and usual heights are all but as high as would pass."""
    required = {"requirement": {"leak_rate": "0.27 ml/min"}}
    found = fem_seal.run(finished(**required))
    assert found.verdict == "inconclusive"
    told = "a measured profile of 5.6 mm of each face shows at most 1.0 times the median heights"
    assert any(told in one for one in verdict_sentences(found))
    assert fem_seal.run(measured(finished(**required), tmp_path, 2, height)).verdict == verdict


def test_line_scans_scatter_in_height_as_foretold():
    rough = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e3, q_rolloff=1e5, q_high=1e6)
    scans = [leak.random_line_scan(rough, length=4e-3, points=4000, seed=seed)[1] for seed in range(300)]
    # the standard deviation of 300 is known to 4 %
    assert np.std([np.log(h.std()) for h in scans]) == pytest.approx(height_scatter(rough, 4e-3), rel=0.12)


def test_faces_that_are_no_finishes_have_no_profile_to_measure():
    assert finish_variance(case()) is None
    by_rq = {face: {"Rq": "0.2 um", "process": "lapped"} for face in ("seat", "closure")}
    assert finish_variance(case(roughness=by_rq)) is None
