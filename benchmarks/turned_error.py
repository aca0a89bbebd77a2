"""Error of `leak.TurnedContact` against direct simulations of turned faces: the numbers of its `flow_error`.

    python benchmarks/turned_error.py             from benchmarks/turned_direct.csv
    python benchmarks/turned_error.py --simulate  once more with the same cells

Cells are two feeds wide and long, or four. It prints ln(direct/theory) by the decades that the conductivity has fallen
since the first touch, the scatter of single cells over them, and the mean where crests are half lost in the fine
roughness. Conductivities are 12 eta sigma [m^3].
"""

from __future__ import annotations

import csv
import math
import sys
from itertools import groupby, pairwise
from pathlib import Path

import numpy as np

import leak

TABLE = Path(__file__).with_name("turned_direct.csv")
DECADES = (0.0, 1.5, 2.0, 3.0, math.inf)
# Rms height over the height of the crests between which these are lost.
LOST = (0.13, 0.39)


def spectrum(row: dict[str, str]) -> leak.PowerSpectrum:
    """Of the fine roughness of a row."""
    return leak.PowerSpectrum.self_affine(
        rms_height=float(row["fine_rms_m"]),
        hurst=float(row["hurst"]),
        q_low=math.pi / float(row["feed_m"]),
        q_rolloff=2.0 * math.pi / float(row["rolloff_m"]),
        q_high=2.0 * math.pi / float(row["shortest_m"]),
    )


def face(row: dict[str, str]) -> leak.TurnedContact:
    """Of a row of the table."""
    return leak.TurnedContact(
        feed=float(row["feed_m"]),
        nose_radius=float(row["nose_radius_m"]),
        fine=spectrum(row),
        effective_modulus=float(row["E_star_Pa"]),
        hardness=float(row["hardness_Pa"]) if row["hardness_Pa"] else None,
    )


def simulate(row: dict[str, str]) -> float:
    """Conductivity across the crests of the cell of a row."""
    of, feeds = face(row), int(row["feeds"])
    heights = of.texture.heights(points=256 * feeds, crests=feeds, seed=int(row["seed"]))
    metal = {"effective_modulus": of.effective_modulus, "hardness": of.hardness}
    result = leak.direct.simulate(
        heights, feeds * of.feed, [float(row["pressure_Pa"])], periodic=True, **metal
    )
    return float(result.gap_cubed_along[0])


def main() -> None:
    """Print the numbers."""
    rows = list(csv.DictReader(TABLE.open(encoding="utf-8")))
    states = []
    for _, group in groupby(rows, key=lambda row: (row["face"], row["feeds"], row["pressure_Pa"])):
        cells = list(group)
        of, pressure = face(cells[0]), float(cells[0]["pressure_Pa"])
        across = [simulate(row) if "--simulate" in sys.argv else float(row["k_across_m3"]) for row in cells]
        if not any(across):  # sealed: nothing to compare
            continue
        first = of.conductivity_table(1.0, 1e12).separation[0] ** 3
        theory = float(of.flow_conductivity(pressure, 1.0 / 12.0))
        scatter = np.std(np.log(across), ddof=1) if min(across) > 0.0 else math.nan
        waves = float(cells[0]["feeds"]) ** 2 * of.feed * of.fine.median_wavenumber / (2.0 * math.pi)
        fallen, error = math.log10(first / theory), math.log(np.mean(across) / theory)
        small = cells[0]["feeds"] == "2"
        states.append((fallen, error, scatter, waves, of.fine.rms_height / of.texture.crest_height, small))
        print(f"{cells[0]['face']:14} {pressure / 1e6:5.1f} MPa " + " ".join(f"{x:7.2f}" for x in states[-1]))
    fallen, error, scatter, waves, height, small = np.array(states).T
    small = small == 1.0
    turned, crossing = height < LOST[0], (height > LOST[0]) & (height < LOST[1])
    for cells, of_size in (("two feeds", small), ("four feeds", ~small)):
        for low, high in pairwise(DECADES):
            part = error[turned & of_size & (fallen >= low) & (fallen < high)]
            if part.size:
                rms = math.sqrt(np.mean(part**2))
                print(
                    f"cells of {cells}, {low:.1f} to {high:.1f} decades: {part.size} states, "
                    f"rms {rms:.2f}, mean {part.mean():.2f}, median {np.median(part):.2f}"
                )
    usual = turned & small & (fallen < DECADES[-2])
    slope, start = np.polyfit(fallen[usual], np.log10(scatter * np.sqrt(waves))[usual], 1)
    print(f"scatter of a median wave of crest: {10.0**start:.2f} times 10^({slope:.2f} decades)")
    share = np.log(height[crossing] / LOST[0]) / math.log(LOST[1] / LOST[0])
    of_share = np.mean(error[crossing] / (4.0 * share * (1.0 - share)))
    print(f"crests half lost in the roughness: mean {of_share:.2f}")


if __name__ == "__main__":
    main()
