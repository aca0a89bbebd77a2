"""Rough faces over a bulk that is strained: the numbers of `leak.theory.bulk_flow`, and how far they are off.

    python benchmarks/bulk_flow.py             from benchmarks/bulk_flow.csv
    python benchmarks/bulk_flow.py --fit       find the numbers once more
    python benchmarks/bulk_flow.py --simulate FILE  simulate all paths once more, in some 20 minutes

Maps of 64^2 points, a roll-off of 4 waves to a side, rms slope 1 and E* = 1 are pressed on von Mises' metal to a part
of the hardness and then strained in their plane at this pressure: along x, in both directions, or in one more and in
the other less. Lengths of the gaps are over the rms height, conductivities over its cube.
"""

from __future__ import annotations

import csv
import math
import sys
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np
from scipy.optimize import least_squares

import leak
from leak.direct import PeriodicHalfSpace, patch_flow, press_elastoplastic
from leak.theory.bulk_flow import BULK_FLOW, BulkFlow, BulkFlowConstants, BulkStrain

TABLE = Path(__file__).with_name("bulk_flow.csv")
MODES = {"x": (1, 0), "-x": (-1, 0), "xy": (1, 1), "x-y": (1, -1), "-xy": (-1, -1)}
WAVE, POINTS, CUT = 2.0 * np.pi, 64, 16
# Ratios of conductivities down to which they are compared.
OPEN, NEARLY_SEALED, TINY = 1e-2, 1e-3, 1e-12
PATH = ("seed", "hurst", "rolloff", "hardness_over_modulus", "pressure_over_hardness", "mode")
STRAINS = np.linspace(0.0, 0.3, 13)
# Of areas and conductivities of single maps, in ln.
SCATTER = (0.06, 0.35)


class State(NamedTuple):
    """A strained face over the one that is not; conductivities along and across x."""

    path: tuple[str, ...]
    surface: leak.RoughContact
    pressure: float
    strains: tuple[float, float]
    area: float
    along: float
    across: float


@cache
def face(hurst: float, rolloff: float, hardness: float) -> leak.RoughContact:
    """Of rms slope 1."""
    ends = {"q_low": 0.999 * rolloff * WAVE, "q_rolloff": rolloff * WAVE, "q_high": CUT * WAVE}
    unit = leak.PowerSpectrum.self_affine(rms_height=1.0, hurst=hurst, **ends)
    return leak.RoughContact(
        unit.scaled(1.0 / unit.rms_slope), effective_modulus=1.0, hardness=hardness, theory="corrected"
    )


@cache
def table(surface: leak.RoughContact) -> leak.ConductivityTable:
    """Of the face over a bulk that is not strained."""
    return surface.conductivity_table(1e-4 * surface.sealing_pressure, surface.sealing_pressure)


def states() -> list[State]:
    """Of the table, each path over its first state."""
    found = []
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for path, group in groupby(rows, key=lambda row: tuple(row[name] for name in PATH)):
        _, hurst, rolloff, hardness, share, mode = path
        first, *rest = group
        surface = face(float(hurst), float(rolloff), float(hardness))
        for row in rest:
            x, y = (sign * float(row["strain"]) for sign in MODES[mode])
            ratios = [float(row[name]) / float(first[name]) for name in ("area", "k_along", "k_across")]
            found.append(State(path, surface, float(share) * float(hardness), (x, y), *ratios))
    return found


def theory(state: State, constants: BulkFlowConstants = BULK_FLOW) -> tuple[float, float, float]:
    """Ratios of area and conductivities along and across x."""
    rest, p = state.surface, state.pressure
    area, ratios = float(np.asarray(rest.contact_area(p))), []
    for strains in (state.strains, state.strains[::-1]):
        bulk = BulkFlow.of(
            BulkStrain(*strains),
            rms_slope=rest.spectrum.rms_slope,
            hardness=rest.hardness,
            effective_modulus=rest.effective_modulus,
            constants=constants,
        )
        u = np.asarray(table(rest).effective_separation([p, float(bulk.pressure(area, p))]))
        ratios.append(float((u[1] / u[0]) ** 3))
    return float(bulk.area(area, p)) / area, *ratios


def fit(of: list[State]) -> BulkFlowConstants:
    """The numbers that meet areas and conductivities best, as far as these are not nearly sealed."""

    def miss(values: np.ndarray) -> np.ndarray:
        misses = []
        for state in of:
            area, *ratios = theory(state, BulkFlowConstants(*values))
            misses.append((math.log(area / state.area)) / SCATTER[0])
            is_open = 0.5 * (state.along + state.across) > 0.2 * OPEN
            for ratio, found in zip(ratios, (state.along, state.across), strict=True):
                error = math.log(max(ratio, TINY) / max(found, TINY))
                misses.append(is_open * min(max(error, -1.5), 1.5) / SCATTER[1])
        return np.array(misses)

    # the spread is read off what is printed
    return BulkFlowConstants(*least_squares(miss, BULK_FLOW[:-1]).x)


def simulate(path: tuple[str, ...], file: TextIO) -> None:
    """Append the states of a path to a table."""
    seed, hurst, rolloff, hardness, share, mode = path
    spectrum = face(float(hurst), float(rolloff), float(hardness)).spectrum
    h = leak.random_map(spectrum, size=1.0, points=POINTS, seed=int(seed), amplitudes="exact")
    body, metal = PeriodicHalfSpace(POINTS, 1.0, 1.0), {"yield_stress": float(hardness) / 2.9}
    pressure, state = float(share) * float(hardness), None
    for p in np.linspace(0.0, pressure, max(round(float(share) / 0.0125), 2) + 1)[1:]:
        (state,) = press_elastoplastic(body, h, [p], start=state, **metal)
    for strain in STRAINS:
        both = [[sign * strain for sign in MODES[mode]]]
        (state,) = press_elastoplastic(body, h, [pressure], start=state, strain=both, **metal)
        k = [
            patch_flow(np.ascontiguousarray(gap)).gap_cubed / h.std() ** 3 for gap in (state.gap, state.gap.T)
        ]
        values = (strain, state.contact_area, state.gap.mean() / h.std(), *k)
        file.write(",".join([*path, *(f"{value:.5g}" for value in values)]) + "\n")


def main() -> None:
    """Print the numbers."""
    if "--simulate" in sys.argv:
        with Path(sys.argv[-1]).open("w", encoding="utf-8") as file:
            file.write(",".join([*PATH, "strain", "area", "gap", "k_along", "k_across"]) + "\n")
            for path in dict.fromkeys(state.path for state in states()):
                simulate(path, file)
        return
    of = states()
    if "--fit" in sys.argv:
        print(fit(of))
    for name in MODES:
        part = [(theory(state), state) for state in of if state.path[-1] == name]
        area = np.array([math.log(found[0] / state.area) for found, state in part])
        k = np.array([[found[1] + found[2], state.along + state.across] for found, state in part])
        print(f"{name}: {len(part)} states, area rms {rms(area):.3f}, worst {abs(area).max():.2f}")
        for low, high in ((OPEN, 2.0), (NEARLY_SEALED, OPEN)):
            ratio = k[(k[:, 1] > 2.0 * low) & (k[:, 1] <= 2.0 * high)]
            error = np.log(np.maximum(ratio[:, 0], TINY) / ratio[:, 1])
            print(
                f"    conductivity above {low:g}: {len(error)}, rms {rms(error):.2f}, mean {error.mean():.2f}"
            )


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


if __name__ == "__main__":
    main()
