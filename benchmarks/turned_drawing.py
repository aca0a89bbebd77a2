"""Interval of a drawing that says "turned Ra 0.4 um" against direct simulations of eight faces that fit it.

    python benchmarks/turned_drawing.py             from benchmarks/turned_drawing.csv
    python benchmarks/turned_drawing.py --simulate  simulates once more, two seeds for each face, and writes that file

The faces have this Ra, the nose radii of usual inserts, and fine roughness from smooth to coarse. It prints for each
face and pressure the conductivity k = 12 eta sigma across the crests [m^3] and the interval, from the samples that a
case takes with the error of the theory, and how many intervals hold.
"""

from __future__ import annotations

import csv
import math
import sys
from functools import cache
from itertools import groupby
from pathlib import Path

import numpy as np
from scipy.stats import qmc

import leak
from leak.numerics.roots import root_between
from leak.surfaces.finish import Finish, process_named

TABLE = Path(__file__).with_name("turned_drawing.csv")
RA, METAL = 0.4e-6, {"effective_modulus": 115e9, "hardness": 3.5e9}
PRESSURES = (10e6, 30e6, 80e6)
# Nose radius [m], rms height of the fine roughness [m], its Hurst exponent and its roll-off [m].
FACES = {
    "usual tool": (0.8e-3, 0.10e-6, 0.8, 25e-6),
    "small nose, smooth": (0.4e-3, 0.07e-6, 0.8, 20e-6),
    "large nose": (1.2e-3, 0.13e-6, 0.7, 30e-6),
    "smallest nose, rough": (0.2e-3, 0.20e-6, 0.8, 15e-6),
    "largest nose, smooth": (1.6e-3, 0.08e-6, 0.9, 40e-6),
    "smooth": (0.8e-3, 0.055e-6, 0.6, 25e-6),
    "small nose, rough": (0.4e-3, 0.22e-6, 0.75, 25e-6),
    "roughest": (0.8e-3, 0.26e-6, 0.8, 50e-6),
}
SHORTEST = 1.0e-6
COLUMNS = ["face", "feed_m", "nose_radius_m", "fine_rms_m", "hurst", "rolloff_m"]
COLUMNS += ["pressure_Pa", "k_across_m3", "k_error_m3"]
SAMPLES, CONFIDENCE = 128, 0.9


def texture(nose_radius: float, rms_height: float, hurst: float, rolloff: float) -> leak.TurnedTexture:
    """The face of this Ra."""

    def of_feed(feed: float) -> leak.TurnedTexture:
        q = {
            "q_low": math.pi / feed,
            "q_rolloff": 2.0 * math.pi / rolloff,
            "q_high": 2.0 * math.pi / SHORTEST,
        }
        fine = leak.PowerSpectrum.self_affine(rms_height=rms_height, hurst=hurst, **q)
        return leak.TurnedTexture(feed, nose_radius, fine)

    return of_feed(
        root_between(lambda feed: of_feed(feed).Ra - RA, 0.4 * rolloff + 1e-5, 0.5 * nose_radius, rtol=1e-6)
    )


def simulate() -> None:
    """Write the table."""
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        write = csv.writer(file, lineterminator="\n")
        write.writerow(
            [
                "face",
                "feed_m",
                "nose_radius_m",
                "fine_rms_m",
                "hurst",
                "rolloff_m",
                "pressure_Pa",
                "k_across_m3",
                "k_error_m3",
            ]
        )
        for name, (nose_radius, rms_height, hurst, rolloff) in FACES.items():
            of = texture(nose_radius, rms_height, hurst, rolloff)
            found = leak.direct.simulate_texture(of, pressures=PRESSURES, seeds=(1, 2), **METAL)
            for state in zip(found.pressure, found.k_across, found.k_across_error, strict=True):
                numbers = of.feed, nose_radius, rms_height, hurst, rolloff, *state
                write.writerow([name, *(f"{number:.5g}" for number in numbers)])
            file.flush()
            print(f"{name}: feed {of.feed * 1e6:.0f} um, {found.k_across}", flush=True)


@cache
def interval(samples: int = SAMPLES) -> np.ndarray:
    """Low, middle and high k at each pressure, with the error of the theory, shape (pressures, 3)."""
    finish = Finish("Ra", RA, process_named("turned"))
    names = list(finish.spreads)
    uniform = qmc.Sobol(len(names), seed=1).random(samples)
    places = (np.arange(32) + 0.5) / 32
    rates = []
    for row in uniform:
        crests = finish.surface(dict(zip(names, row, strict=True))).texture
        assert crests is not None
        of = leak.TurnedContact(feed=crests.feed, nose_radius=crests.nose_radius, fine=crests.fine, **METAL)
        k = [float(of.flow_conductivity(p, 1.0 / 12.0)) * of.flow_error(p).factor(places) for p in PRESSURES]
        rates.append(k)
    tail = 0.5 - 0.5 * CONFIDENCE
    return np.quantile(
        np.moveaxis(rates, 0, 1).reshape(len(PRESSURES), -1), [tail, 0.5, 1.0 - tail], axis=1
    ).T


def held(samples: int = SAMPLES) -> list[tuple[str, float, float, float, float]]:
    """Face, pressure [Pa], k, lower and upper end of each state of the table."""
    rows = csv.DictReader(TABLE.open(encoding="utf-8"))
    return [
        (row["face"], p, float(row["k_across_m3"]), *interval(samples)[PRESSURES.index(p), ::2])
        for row in rows
        if (p := float(row["pressure_Pa"])) in PRESSURES
    ]


def main() -> None:
    """Simulate if asked to, and print."""
    if "--simulate" in sys.argv:
        simulate()
    for name, states in groupby(held(), key=lambda state: state[0]):
        for _, p, k, low, high in states:
            inside = "inside" if low <= k <= high else "outside"
            print(f"{name:22} {p / 1e6:4.0f} MPa: {k:.1e}, {low:.1e} to {high:.1e}, {inside}")
    for p in PRESSURES:
        at = [low <= k <= high for _, pressure, k, low, high in held() if pressure == p]
        low, middle, high = interval()[PRESSURES.index(p)]
        print(
            f"{p / 1e6:.0f} MPa: {sum(at)} of {len(at)} inside, middle {middle:.1e}, factor {high / low:.0f}"
        )


if __name__ == "__main__":
    main()
