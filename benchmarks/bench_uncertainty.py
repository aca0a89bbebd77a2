"""Speed of an uncertainty analysis: `pytest benchmarks/bench_uncertainty.py`; goal: 10 000 samples in 60 s, 2 cores.

A sample has the goal of 0.05 s twice, for every fluid and every kind of spectrum. Wall time is what a user waits for an
interval on two cores, with copies of the process as a run has them. Processor time is what the samples themselves take,
in one process: where there are no copies - macOS, Windows, a worker of a study - that is what a user waits.

Every sample is calculated: no viscosity is uncertain, which costs nothing, and there are no more samples than runs of
which a polynomial is made.
"""

from __future__ import annotations

import os
from functools import cache
from time import process_time

import numpy as np
import pytest

import fem_seal
from fem_seal import processes
from fem_seal.answers import chain
from fem_seal.answers.samples import Samples
from fem_seal.answers.uncertainty import leak_interval
from fem_seal.case.tables import Scans, Spread, Uncertainty

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


# Loads and the table [fluid]: a liquid, one that thickens, gases from free molecules to real ones.
FLUIDS = {
    "water": (["50 bar", "200 bar"], {"name": "water"}),
    "thickening diesel": (["200 bar", "1800 bar"], {"name": "diesel"}),
    "helium": (["5 bar", "20 bar"], {"name": "helium"}),
    "helium into vacuum": (["0.1 bar", "1 bar"], {"name": "helium", "outlet_pressure": "0 Pa"}),
    "dense hydrogen": (["350 bar", "700 bar"], {"name": "CoolProp:Hydrogen"}),
}
LAPPED = {**SPECTRUM, "rms_height": "0.4 um", "hurst": 0.8, "q_low": "5e3 1/m", "q_high": "5e6 1/m"}
SCANS = 4


@pytest.fixture(scope="module")
def spectra(tmp_path_factory):
    """The table [roughness] of every kind of spectrum."""
    folder, rng = tmp_path_factory.mktemp("spectra"), np.random.default_rng(1)
    q = np.geomspace(5e3, 5e6, 40)
    density = 1e-22 * (1 + (q / 4e4) ** 2) ** -1.8 * np.exp(0.2 * np.sin(3 * np.log(q)))
    np.savetxt(folder / "C.csv", np.column_stack([q, density]), delimiter=",")
    x = 1e-6 * np.arange(4000)
    waves = 2 * np.pi * np.fft.rfftfreq(x.size, 1e-6)
    amplitude = np.where(waves > 0, np.maximum(waves / 5e4, 1.0) ** -1.3, 0.0)
    for n in range(SCANS):
        height = np.fft.irfft(
            amplitude * rng.rayleigh(size=waves.size) * np.exp(2j * np.pi * rng.random(waves.size))
        )
        np.savetxt(
            folder / f"{n}.csv", 1e6 * np.column_stack([x, 0.4e-6 * height / height.std()]), delimiter=","
        )
    files = [str(folder / f"{n}.csv") for n in range(SCANS)]
    scans = {"kind": "profile", "unit": "um"}
    return {
        "self-affine": {"spectrum": LAPPED},
        "table": {"spectrum": {"kind": "table", "file": str(folder / "C.csv")}},
        "scans": {"seat": {**scans, "files": files}, "closure": {**LAPPED, "rms_height": "0.05 um"}},
        "finish": {"seat": "turned Ra 0.4 um", "closure": "lapped Ra 0.1 um"},
        "lay": {"spectrum": LAPPED, "peklenik": 0.2},
        "scans along and across": {
            "along": {**scans, "files": files[:2]},
            "across": {**scans, "files": files[2:]},
        },
    }


# What is uncertain beside hardness, modulus, height, and what finishes and lengths of scans leave open.
BESIDE = {
    "self-affine": ("hurst", "q_rolloff", "q_high"),
    "lay": ("hurst", "q_rolloff", "q_high"),
}
KINDS = ("self-affine", "table", "scans", "finish", "lay", "scans along and across")
FORMS = {
    "oval": {"seat": {"direction": "radial", "harmonics": [{"waves": 2, "amplitude": "0.5 um"}]}},
    "scratched": {"scratches": [{"depth": "2 um", "width": "30 um"}]},
}
CELLS = [
    *((fluid, kind, None) for fluid in FLUIDS for kind in KINDS),
    *((fluid, "self-affine", form) for form in FORMS for fluid in ("water", "helium")),
]
# Calculated in one process, and asked for of an interval, which is the default.
SAMPLES, ASKED = (int(os.environ.get(name, number)) for name, number in (("SAMPLES", "64"), ("ASKED", "256")))
CORES = 2
GOAL = 0.05
of_every_cell = pytest.mark.parametrize(
    ("fluid", "kind", "form"), CELLS, ids=[", ".join(filter(None, word)) for word in CELLS]
)


@pytest.fixture(scope="module")
def solved(spectra):
    """A result with its leak rates, and what is uncertain: two loads, both readings of asperities that yield."""

    @cache
    def of(fluid, kind, form):
        pressures, table = FLUIDS[fluid]
        if table["name"].startswith("CoolProp:"):
            pytest.importorskip("CoolProp")
        case = fem_seal.Case(
            closure={"shape": "ball", "radius": "5 mm", "material": "steel"},
            seat={"shape": "cone", "angle": "45 deg", "material": STEEL},
            roughness=spectra[kind],
            fluid=table,
            load={"fluid_pressure": pressures, "applied_force": "1 kN"},
            **({"form": FORMS[form]} if form else {}),
        )
        names = (*FOUR[1:], *BESIDE.get(kind, ()), *(["form"] if form else []))
        scatter = {"spectrum": Scans(distribution="scans")} if kind.startswith("scans") else {}
        settings = Uncertainty(samples=ASKED, **{name: Spread(relative=0.1) for name in names}, **scatter)
        with pytest.MonkeyPatch.context() as patch:
            # a finish has an interval without being asked; here it is asked for
            patch.setattr(chain, "ANSWERS", [each for each in chain.ANSWERS if each.name != "uncertainty"])
            result = fem_seal.run(case)
        # the case has its own leak rates, and the tables for them, before the first sample
        assert Samples.of(result, settings).of_case.shape[1] == len(pressures)
        return result, settings

    return of


@of_every_cell
def test_uncertainty_per_sample(benchmark, solved, monkeypatch, fluid, kind, form):
    """Processor time of a sample in one process, with what all share beyond the case's own tables."""
    samples, start = Samples.of(*solved(fluid, kind, form)), process_time()
    monkeypatch.setattr(processes, "_MOST_PROCESSES", 1)
    rates = benchmark.pedantic(lambda: samples.leak_rates(range(SAMPLES)), rounds=1)
    benchmark.extra_info.update(
        goal_s=GOAL, figure_s=(process_time() - start) / SAMPLES, note=f"{SAMPLES} samples, all calculated"
    )
    assert np.all(rates >= 0)


@of_every_cell
def test_uncertainty_wall_time_per_sample(benchmark, solved, monkeypatch, fluid, kind, form):
    """What a user waits for an interval, over the number of samples, with those that check the polynomial."""
    monkeypatch.setattr(processes, "_MOST_PROCESSES", CORES)
    result, settings = solved(fluid, kind, form)
    interval = benchmark.pedantic(lambda: leak_interval(result, settings), rounds=1)
    cores = min(processes.usable_cores(), CORES) if processes.can_copy() else 1
    benchmark.extra_info.update(
        goal_s=GOAL,
        figure_s=benchmark.stats.stats.min / ASKED,
        note=f"whole interval of {ASKED} samples, {interval.runs} calculated, on {cores} core{'s' * (cores > 1)}",
    )
    assert np.all(interval.leak_rate >= 0)
