"""Error of `leak.TurnedContact` against direct simulations of turned faces: the numbers of its `flow_error`.

    python benchmarks/turned_error.py             from turned_direct.csv, on a flat, and turned_pairs.csv, on each other
    python benchmarks/turned_error.py --simulate  once more with the same cells
    python benchmarks/turned_error.py --unloaded  after a larger load, from benchmarks/turned_unloaded.csv

Cells are two feeds wide and long, or four. It prints ln(direct/theory) by the decades that the conductivity has fallen
since the first touch, the scatter of single cells over them, and the mean where crests are half lost in the fine
roughness. Conductivities are 12 eta sigma [m^3].
"""

from __future__ import annotations

import csv
import math
import sys
from itertools import groupby, pairwise
from operator import itemgetter
from pathlib import Path

import numpy as np

import leak

TABLES = [Path(__file__).with_name(name) for name in ("turned_direct.csv", "turned_pairs.csv")]
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
        **other(row),
    )


def other(row: dict[str, str]) -> dict[str, object]:
    """Face on that of a row."""
    if "phase" not in row:
        return {}
    cusps = leak.Cusps(float(row["other_feed_m"]), float(row["other_nose_radius_m"]))
    return {"other": cusps, "phase": float(row["phase"])}


def simulate(row: dict[str, str]) -> float:
    """Conductivity across the crests of the cell of a row."""
    of, feeds = face(row), int(row["feeds"])
    size = feeds * of.feed
    # the shortest wave has four points
    points, crests = round(4.0 * size / float(row["shortest_m"])), round(size / of.texture.period)
    heights = of.texture.heights(points=points, crests=crests, seed=int(row["seed"]))
    metal = {"effective_modulus": of.effective_modulus, "hardness": of.hardness}
    result = leak.direct.simulate(heights, size, [float(row["pressure_Pa"])], periodic=True, **metal)
    return float(result.gap_cubed_along[0])


def unloaded() -> None:
    """Print ln(direct/theory) of each state after a larger load, with its own spread."""
    rows = list(csv.DictReader(TABLES[0].with_name("turned_unloaded.csv").open(encoding="utf-8")))
    key = itemgetter("face", "model", "largest_Pa", "pressure_Pa")
    for (name, model, *_), group in groupby(rows, key=key):
        cells = list(group)
        of, pressure, largest = face(cells[0]), float(cells[0]["pressure_Pa"]), float(cells[0]["largest_Pa"])
        across = np.array([float(row["k_across_m3"]) for row in cells])
        theory = float(of.flow_conductivity(pressure, 1.0 / 12.0, largest=largest))
        error = of.flow_error(pressure, largest=largest)
        ratio = math.log(across.mean() / theory) - float(error.bias)
        print(
            f"{name:14} {model:10} {largest / 1e6:5.1f} {pressure / 1e6:5.1f} MPa {ratio:6.2f} {error.spread:5.2f}"
        )


def states(table: Path) -> np.ndarray:
    """Of each state decades fallen, ln(direct/theory), scatter, waves of crest, rms height over theirs, feeds."""
    rows = list(csv.DictReader(table.open(encoding="utf-8")))
    found = []
    for _, group in groupby(rows, key=lambda row: (row["face"], row["feeds"], row["pressure_Pa"])):
        cells = list(group)
        of, pressure = face(cells[0]), float(cells[0]["pressure_Pa"])
        across = [simulate(row) if "--simulate" in sys.argv else float(row["k_across_m3"]) for row in cells]
        if not any(across):  # sealed: nothing to compare
            continue
        first = of.conductivity_table(1.0, 1e12).separation[0] ** 3
        theory = float(of.flow_conductivity(pressure, 1.0 / 12.0))
        scatter = np.std(np.log(across), ddof=1) if min(across) > 0.0 else math.nan
        feeds = float(cells[0]["feeds"])
        waves = feeds**2 * of.feed * of.fine.median_wavenumber / (2.0 * math.pi)
        fallen, error = math.log10(first / theory), math.log(np.mean(across) / theory)
        found.append((fallen, error, scatter, waves, of.fine.rms_height / of.texture.crest_height, feeds))
        print(f"{cells[0]['face']:14} {pressure / 1e6:5.1f} MPa " + " ".join(f"{x:7.2f}" for x in found[-1]))
    return np.array(found).T


def print_errors(of_what: str, fallen: np.ndarray, error: np.ndarray) -> None:
    """Rms and mean of ln(direct/theory) by decades."""
    for low, high in pairwise(DECADES):
        part = error[(fallen >= low) & (fallen < high)]
        if part.size:
            print(
                f"{of_what}, {low:.1f} to {high:.1f} decades: {part.size} states, "
                f"rms {math.sqrt(np.mean(part**2)):.2f}, mean {part.mean():.2f}, median {np.median(part):.2f}"
            )


def main() -> None:
    """Print the numbers."""
    if "--unloaded" in sys.argv:
        unloaded()
        return
    fallen, error, scatter, waves, height, feeds = states(TABLES[0])
    turned, crossing, small = height < LOST[0], (height > LOST[0]) & (height < LOST[1]), feeds == 2.0
    print_errors("cells of two feeds", fallen[turned & small], error[turned & small])
    print_errors("cells of four feeds", fallen[turned & ~small], error[turned & ~small])
    usual = turned & small & (fallen < DECADES[-2])
    slope, start = np.polyfit(fallen[usual], np.log10(scatter * np.sqrt(waves))[usual], 1)
    print(f"scatter of a median wave of crest: {10.0**start:.2f} times 10^({slope:.2f} decades)")
    share = np.log(height[crossing] / LOST[0]) / math.log(LOST[1] / LOST[0])
    of_share = np.mean(error[crossing] / (4.0 * share * (1.0 - share)))
    print(f"crests half lost in the roughness: mean {of_share:.2f}")
    fallen, error, _, _, height, _ = states(TABLES[1])
    print_errors("two turned faces on each other", fallen[height < LOST[0]], error[height < LOST[0]])


if __name__ == "__main__":
    main()
