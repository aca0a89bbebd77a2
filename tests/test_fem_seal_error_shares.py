"""What makes an interval as wide as it is, checked by leaving the sources out."""

from __future__ import annotations

import json
import math
from functools import cache

import numpy as np
import pytest
from sample_results import SPECTRUM, case, run_loads

import fem_seal
from fem_seal.answers.error_shares import ErrorShares, error_shares
from fem_seal.output.answers.uncertainty import error_sentence, error_shares_of
from fem_seal.output.summary import write_summary
from fem_seal.seal.bounds import Bounds

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


@pytest.mark.parametrize("without", list(SPREADS))
def test_what_is_known_exactly_leaves_the_factor_that_is_told(without):
    told, ends = shares_of(result()), result(without).loads[0].leak_interval
    assert math.log(told.left[without]) == pytest.approx(math.log(ends.high / ends.low), rel=0.05)


def test_shares_are_of_the_whole_and_the_largest_stands_first():
    found = shares_of(result())
    shares = list(found.of_width.values())
    assert shares == sorted(shares, reverse=True) and sum(shares) == pytest.approx(1.0, rel=1e-9)
    ends = result().loads[0].leak_interval
    assert found.factor == pytest.approx(ends.high / ends.low, rel=1e-12)
    assert set(found.of_width) >= {*SPREADS, "gap law", "few waves", "yielding"}
    assert max(found.of_width["gap law"], found.of_width["few waves"]) < 0.1 < found.of_width["rms_height"]


def test_own_error_and_inputs_add_their_variances():
    """The interval of both is narrower than the product of their intervals, and wider than either."""
    both, inputs, own = result().loads[0], result().uncertainty, result(*SPREADS).loads[0]
    ends = np.quantile(inputs.leak_rate[0], (0.05, 0.95))
    widths = [math.log(high / low) for low, high in (both.leak_interval, ends, own.theory_error)]
    assert widths[0] == pytest.approx(math.hypot(*widths[1:]), rel=0.03)
    assert own.theory_error.apart and both.leak_validity.leak_factor == (1.0, 1.0)


def test_samples_without_any_spread_have_the_error_of_the_theory():
    narrow = case(
        load={"fluid_pressure": "20 bar"}, leak=CORRECTED, uncertainty={"viscosity": {"relative": 1e-6}}
    )
    (load,) = run_loads(narrow, interval=True).loads
    told = Bounds(*(one / load.leak.leak_rate for one in load.sampled))
    assert told == pytest.approx(load.flow_error.factor([0.05, 0.95]), rel=5e-3)


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


def test_the_sentence_and_the_summary_have_them(tmp_path):
    told = error_sentence(result())
    assert "spans a factor of" in told and "rms height" in told and "known exactly a factor of" in told
    close = run_loads(case(load={"fluid_pressure": "20 bar"}, roughness=FEW, leak=CORRECTED))
    assert "Without the doubt of long waves a factor of" in error_sentence(close)
    assert error_sentence(result(*SPREADS, theory="paper")) == ""
    summary = json.loads(write_summary(result(), tmp_path / "summary.json").read_text(encoding="utf-8"))
    (entry,) = summary["error_shares"]
    assert entry["of_width"] == pytest.approx(dict(error_shares_of(result())[0].of_width))
