"""Two different flange faces on one gasket: the seal leaks the mean of two that have one of them on both sides."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from flanges import BOTH, COARSE, CONE, DISC, FINE, tables

from fem_seal import Case, SealResult, run
from fem_seal.answers.two_flanges import mean_leak, share_of
from fem_seal.output.report.page import report
from fem_seal.output.tables import contact_rows
from leak import LeakResult


@cache
def both() -> SealResult:
    return run(Case(**tables(DISC, BOTH, seat=CONE)))


@cache
def upper() -> SealResult:
    return run(Case(**tables(DISC, FINE)))


@cache
def lower() -> SealResult:
    return run(Case(**tables(CONE, COARSE)))


@pytest.mark.slow
def test_the_leak_rate_is_the_mean() -> None:
    for load, one, other in zip(both().loads, upper().loads, lower().loads, strict=True):
        assert load.leak.leak_rate == pytest.approx(
            0.5 * (one.leak.leak_rate + other.leak.leak_rate), rel=1e-12
        )
        assert load.leak.mass_flow == pytest.approx(
            0.5 * (one.leak.mass_flow + other.leak.mass_flow), rel=1e-12
        )
        assert {"elastic", "paper"} <= set(load.scenarios)
        for name, found in load.scenarios.items():
            rates = one.scenarios[name].leak.leak_rate, other.scenarios[name].leak.leak_rate
            assert found.leak.leak_rate == pytest.approx(0.5 * sum(rates), rel=1e-12)
        # pressures are those of the upper face
        assert load.peak_pressure == one.peak_pressure


@pytest.mark.slow
def test_the_interval_lies_between_those_of_both_and_the_verdict_follows_it() -> None:
    for load, one, other in zip(both().loads, upper().loads, lower().loads, strict=True):
        low, high = load.leak_interval
        assert low < load.leak.leak_rate < high
        assert min(one.leak_interval.low, other.leak_interval.low) < low
        assert high < max(one.leak_interval.high, other.leak_interval.high)
        assert load.sample_ends.high == pytest.approx(
            0.5 * (one.sample_ends.high + other.sample_ends.high), rel=0.05
        )
        assert load.judgement.ends == pytest.approx(load.leak_interval)


@pytest.mark.slow
def test_each_contact_has_its_row() -> None:
    columns, rows = contact_rows(both())
    rate, peak = columns.index("leak_rate_m3_per_s"), columns.index("peak_pressure_Pa")
    for number, load in enumerate(both().loads):
        above, below = rows[2 * number : 2 * number + 2]
        assert [above[2], below[2]] == ["closure", "seat"]
        assert above[rate] + below[rate] == pytest.approx(load.leak.leak_rate, rel=1e-12)
        assert below[peak] == lower().loads[number].peak_pressure != above[peak]


@pytest.mark.slow
def test_compression_is_half_of_each() -> None:
    ways = [[step.compression for step in one().compression.steps] for one in (both, upper, lower)]
    assert ways[0] == pytest.approx(0.5 * np.add(ways[1], ways[2]), rel=1e-12)


@pytest.mark.slow
def test_the_report_tells_both_faces_apart() -> None:
    page = report(both(), full=True)
    assert "Two different flange faces" in page and "of the leak pass the upper flange face" in page
    assert "lower flange:" in page


@pytest.mark.parametrize(
    ("one", "other"), [(1e-9, 3e-9), (0.0, 2e-9), (2e-9, 0.0), (math.inf, 1e-9), (1e-9, math.inf), (0.0, 0.0)]
)
def test_mean_of_sealed_and_open_faces(one: float, other: float) -> None:
    first, second = (LeakResult(rate, 1e5 / rate if rate else math.inf, np.zeros(3)) for rate in (one, other))
    found = mean_leak(first, second)
    assert found.leak_rate == 0.5 * (one + other)
    assert found.fluid_pressure is first.fluid_pressure
    share = share_of(first, second)
    assert 0.0 <= share <= 1.0 and share_of(second, first) == pytest.approx(1.0 - share)
    if math.isfinite(one + other) and one + other:
        assert share == pytest.approx(one / (one + other))
