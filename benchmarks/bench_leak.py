"""Speed of the leak package: `pytest benchmarks/bench_leak.py`; each figure beside its goal.

A table is made once per surface and cached by content, so every round gets a surface of its own (a modulus that
differs in the ninth digit).
"""

from __future__ import annotations

import sys
from itertools import count

import numpy as np
import pytest
from measured_process import measure_process

import leak

_NUMBER = count()


def new_surface(hardness: float | None) -> leak.RoughContact:
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.1415926e6
    )
    return leak.RoughContact(
        spectrum, effective_modulus=115e9 * (1 + 1e-9 * next(_NUMBER)), hardness=hardness
    )


@pytest.mark.parametrize(("hardness", "goal"), [(None, 0.05), (3.5e9, 0.15)], ids=["elastic", "plastic"])
def test_conductivity_table(benchmark, hardness, goal):
    benchmark.extra_info["goal_s"] = goal
    table = benchmark.pedantic(
        lambda surface: surface.conductivity_table(1e4, 5e8),
        setup=lambda: ((new_surface(hardness),), {}),
        rounds=7,
        warmup_rounds=1,
    )
    assert table.effective_separation(50e6) > 1e-6


@pytest.mark.parametrize(("hardness", "goal"), [(None, 0.15), (3.5e9, 0.35)], ids=["elastic", "plastic"])
def test_gas_conductivity_table(benchmark, hardness, goal):
    benchmark.extra_info["goal_s"] = goal
    table = benchmark.pedantic(
        lambda surface: leak.gas_conductivity_table(surface, 1e4, 5e8),
        setup=lambda: ((new_surface(hardness),), {}),
        rounds=5,
        warmup_rounds=1,
    )
    assert table.liquid.effective_separation(50e6) > 1e-6


def test_gas_flow_of_a_profile(benchmark):
    benchmark.extra_info["goal_s"] = 0.02
    table = leak.gas_conductivity_table(new_surface(3.5e9), 1e3, 1e8)
    line = leak.gaussian_line(20e3, 0.02, 0.139e-3**2 / 0.02)
    x = np.linspace(-3.5, 3.5, 200) * line.std
    helium = leak.gas("helium")
    result = benchmark(leak.gas_leak_flow, x, line.pressure(x), table, helium, 2e5, 1e5, 0.0141421)
    assert result.mass_flow > 0


@pytest.mark.parametrize("plastic", [False, True], ids=["elastic", "plastic"])
def test_interface_law(benchmark, plastic):
    law = benchmark.pedantic(
        lambda surface: surface.interface_law(plastic=plastic),
        setup=lambda: ((new_surface(3.5e9),), {}),
        rounds=5,
        warmup_rounds=1,
    )
    assert law.u0 > 0


def test_law_on_a_contact_line(benchmark):
    law = new_surface(None).interface_law()
    log_p = np.linspace(-500, 19, 200)
    benchmark(lambda: (law.gap(log_p), law.decay_length(log_p)))


def test_leak_rate_of_a_profile(benchmark):
    conductivity = new_surface(3.5e9).conductivity_table(1e3, 1e8).at(1e-3)
    line = leak.gaussian_line(20e3, 0.02, 0.139e-3**2 / 0.02)
    x = np.linspace(-3.5, 3.5, 200) * line.std
    Q = benchmark(leak.leak_rate, x, line.pressure(x), conductivity, 2e6, 0.0141421)
    assert Q > 0


def test_crossover_profile(benchmark):
    line = leak.crossover_line(20e3, 0.02, 115e9, 1.1e-6)
    x = np.linspace(-4, 4, 200) * line.std
    benchmark(line.pressure, x)


def test_import_of_the_package_leak(benchmark, tmp_path):
    """A process that imports what a leak rate needs, its processor time: names are loaded when they are first used."""
    costs = []
    benchmark.pedantic(
        lambda: costs.append(
            measure_process([sys.executable, "-c", "from leak import RoughContact, leak_rate"], tmp_path)
        ),
        rounds=5,
        warmup_rounds=1,
    )
    benchmark.extra_info.update(goal_s=0.25, figure_s=min(cost.processor for cost in costs))
