"""Faces over metal that is strained elastically while they are pressed: `leak.theory.bulk_flow.softer`, and its error.

    python benchmarks/bulk_stress.py                  from benchmarks/bulk_stress.csv
    python benchmarks/bulk_stress.py --simulate FILE  simulate all paths once more, in some 15 minutes

Pressure and strain rise together, to half of the yield strain and more. Random faces are those of `bulk_flow.py`, of 4
to 16 waves per box, turned ones the cells of `turned_bulk.py`, strained across the crests (x) or along them (y).
"""

from __future__ import annotations

import csv
import math
import sys
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
import turned_bulk
from bulk_flow import MODES, POINTS, face, spectrum, table

import leak
from leak.direct import PeriodicHalfSpace, patch_flow, press_elastoplastic
from leak.theory.bulk_flow import BULK_FLOW, BulkFlow, BulkFlowConstants, BulkStrain

TABLE = Path(__file__).with_name("bulk_stress.csv")
COLUMNS = (
    "face",
    "hardness_over_modulus",
    "mode",
    "seed",
    "pressure_over_hardness",
    "strain",
    "area",
    "k_along",
    "k_across",
)
WAVES = (1.0, 16.0, 0.8, 4.0)
FINE = 0.08
# Highest pressure of a path over the hardness, its steps, and every how many are kept; strain there, over H/E*.
PATHS = {"random": (0.2, 16, 4), "turned": (0.03, 10, 2)}
STRAIN = 0.19
# Less than this lets nothing through that a grid can tell.
OPEN = 1e-6
JOBS = [
    *(("random", h, mode) for h in (0.05, 0.1, 0.2) for mode in ("0", "x", "-x", "-xy")),
    ("random", 0.1, "xy"),
    *(("turned", h, mode) for h in (0.05, 0.2) for mode in ("0", "x", "-x", "y", "-y")),
]


class State(NamedTuple):
    """A path at one pressure, mean of its maps; of turned faces flow across the crests."""

    face: str
    hardness: float
    mode: str
    share: float
    strain: float
    change: float
    """ln of the conductivity over that without strain."""
    steepness: float
    """-d ln k/d ln p of the simulation without strain."""


def states() -> list[State]:
    """Of the table."""
    of: dict[tuple[str, float, str], dict[float, list[list[float]]]] = defaultdict(lambda: defaultdict(list))
    with TABLE.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            across = float(row["k_across"])
            k = 0.5 * (across + float(row["k_along"])) if row["face"] == "random" else across
            path = of[row["face"], float(row["hardness_over_modulus"]), row["mode"]]
            path[float(row["pressure_over_hardness"])].append([float(row["strain"]), k])
    found = []
    for (kind, hardness, mode), path in of.items():
        rest = {share: np.mean(maps, axis=0)[1] for share, maps in of[kind, hardness, "0"].items()}
        open_shares = [share for share in sorted(rest) if rest[share] > OPEN]
        if mode == "0" or len(open_shares) < 2:
            continue
        steepness = -np.gradient(np.log([rest[share] for share in open_shares]), np.log(open_shares))
        for share, steep in zip(open_shares, steepness, strict=True):
            strain, k = np.mean(path[share], axis=0)
            if k > OPEN:
                found.append(
                    State(kind, hardness, mode, share, strain, math.log(k / rest[share]), float(steep))
                )
    return found


def theory(state: State, constants: BulkFlowConstants = BULK_FLOW) -> float:
    """ln of the conductivity of a random face over that without strain; half of the strain flattens."""
    rest, logs = face(*WAVES, state.hardness), []
    p = state.share * state.hardness
    area = float(np.asarray(rest.contact_area(p)))
    ways = [sign * state.strain for sign in MODES[state.mode]]
    for way in (ways, ways[::-1]):
        bulk = BulkFlow.of(
            BulkStrain(*(0.5 * strain for strain in way), elastic=sum(ways)),
            rms_slope=rest.spectrum.rms_slope,
            hardness=state.hardness,
            effective_modulus=rest.effective_modulus,
            constants=constants,
        )
        u = np.asarray(table(rest).effective_separation([p, float(bulk.pressure(area, p))]))
        logs.append(float((u[1] / u[0]) ** 3))
    return math.log(np.mean(logs))


def softening(state: State) -> float:
    """By which share of the yield stress, of strain times E*, the pressure that acts rises: `tension`, measured."""
    ways = sum(MODES[state.mode]) * state.strain
    return -state.change / state.steepness / (2.9 * ways / state.hardness)


def simulate(job: tuple[str, float, str], seed: int) -> list[list[object]]:
    """Rows of one path."""
    kind, hardness, mode = job
    last, steps, kept = PATHS[kind]
    if kind == "random":
        points = POINTS
        heights = leak.random_map(
            spectrum(*WAVES), size=1.0, points=points, seed=seed, peklenik=1.0, amplitudes="exact"
        )
    else:
        points, of = 64, turned_bulk.face(hardness, FINE)
        heights = of.texture.heights(points=points, crests=1, seed=seed) / turned_bulk.slope(of)
    scale = heights.std() if kind == "random" else 1.0
    body, state, rows = PeriodicHalfSpace(points, 1.0, 1.0), None, []
    for number in range(1, steps + 1):
        share, strain = last * number / steps, STRAIN * hardness * number / steps
        # metal of turned cells flows in bulk at much less than its hardness
        both = [[sign * strain for sign in MODES[mode]]] if mode != "0" else [[turned_bulk.LITTLE, 0.0]]
        (state,) = press_elastoplastic(
            body, heights, [share * hardness], start=state, yield_stress=hardness / 2.9, strain=both
        )
        if number % kept == 0:
            k = [
                patch_flow(np.ascontiguousarray(gap)).gap_cubed / scale**3 for gap in (state.gap, state.gap.T)
            ]
            if kind == "turned":
                k.reverse()
            values = (f"{value:.5g}" for value in (share, strain * (mode != "0"), state.contact_area, *k))
            rows.append([kind, hardness, mode, seed, *values])
    return rows


def main() -> None:
    """Print the numbers."""
    if "--simulate" in sys.argv:
        with Path(sys.argv[-1]).open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(COLUMNS)
            for job in JOBS:
                for seed in (1, 2, 3) if job[0] == "random" else (1, 2):
                    writer.writerows(simulate(job, seed))
        return
    of = [state for state in states() if state.face == "random"]
    for name, constants in (("without", BULK_FLOW._replace(tension=0.0)), ("with", BULK_FLOW)):
        misses = np.array([theory(state, constants) - state.change for state in of])
        print(f"random faces, {name} stress: {len(of)} states, rms of ln {np.sqrt(np.mean(misses**2)):.3f}")
    for kind, mode in dict.fromkeys((state.face, state.mode) for state in states()):
        found = [softening(state) for state in states() if (state.face, state.mode) == (kind, mode)]
        print(f"{kind} {mode}: softer by {min(found):.2f} to {max(found):.2f} at the yield stress")


if __name__ == "__main__":
    main()
