"""Speed of an uncertainty analysis: `pytest benchmarks/bench_uncertainty.py`; goal: 10 000 samples in 60 s, 2 cores."""

from __future__ import annotations

from pathlib import Path
from time import process_time

import numpy as np
import pytest

import fem_seal
from fem_seal.analysis.uncertainty import _Study, leak_interval
from fem_seal.case.uncertainty import Spread, Uncertainty

EXAMPLES = Path(__file__).parent.parent / "examples"
STEEL = {
    "youngs_modulus": "210 GPa",
    "poissons_ratio": 0.3,
    "hardness": "3.5 GPa",
}
SPECTRUM = {
    "kind": "self-affine",
    "rms_height": "1.9 um",
    "hurst": 0.6,
    "q_low": "1e3 1/m",
    "q_rolloff": "3.7268e4 1/m",
    "q_high": "3.14159e6 1/m",
}
FOUR = ("viscosity", "hardness", "youngs_modulus", "rms_height")
ALL = (*FOUR, "hurst", "q_rolloff")


@pytest.fixture(scope="module", params=[1, 20], ids=["1 load", "20 loads"])
def result(request):
    return fem_seal.run(
        fem_seal.Case(
            closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
            seat={"shape": "cone", "angle": "45 deg", "material": STEEL},
            roughness={"spectrum": SPECTRUM},
            fluid={"name": "water"},
            load={"fluid_pressure": [f"{20 - n} bar" for n in range(request.param)]},
        )
    )


@pytest.mark.parametrize("inputs", [FOUR, ALL], ids=["4 inputs", "6 inputs"])
def test_ten_thousand_samples(benchmark, result, inputs):
    settings = Uncertainty(samples=10000, **{name: Spread(relative=0.1) for name in inputs})
    interval = benchmark.pedantic(lambda: leak_interval(result, settings), rounds=1)
    benchmark.extra_info.update(goal_s=60, runs=interval.runs, error=interval.error)
    assert interval.leak_rate.shape == (len(result.loads), 10000)
    assert np.all(interval.low < interval.high)
    assert interval.error < 5e-3


# A liquid, one that thickens, gases, and every kind of spectrum.
KINDS = {
    "water": "ball_cone.toml",
    "thickening diesel": "diesel_1800_bar.toml",
    "helium": "helium.toml",
    "measured scan": "measured_seat.toml",
    "turned and lapped": "drawing_finish.toml",
}


@pytest.mark.parametrize("kind", KINDS)
def test_uncertainty_per_sample(benchmark, kind):
    """A sample of hardness and modulus, and of the height where it is an input, the tables of their family included."""
    case = fem_seal.load_case(EXAMPLES / KINDS[kind])
    inputs = {name: Spread(relative=0.1) for name in ("hardness", "youngs_modulus", "rms_height")}
    settings = Uncertainty(samples=64, **inputs)
    study = _Study.of(fem_seal.run(case), settings)
    start = process_time()
    rates = benchmark.pedantic(lambda: study.leak_rates(range(64)), rounds=1)
    benchmark.extra_info.update(goal_s=0.05, figure_s=(process_time() - start) / 64)
    assert np.all(rates > 0)
