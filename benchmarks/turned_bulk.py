"""Turned faces over a bulk that is strained: the numbers of `leak.TurnedContact.pressure_at_rest`, and how far off.

    python benchmarks/turned_bulk.py             from benchmarks/turned_bulk.csv
    python benchmarks/turned_bulk.py --fit       find the numbers once more
    python benchmarks/turned_bulk.py --simulate FILE  simulate all paths once more, in some 40 minutes

Cells of one crest, a feed wide and long, slope m' = 1 across the crest and E* = 1, are pressed on von Mises' metal to a
part of the hardness and then strained at this pressure: across the crests (x), along them (y), or both. Paths "press"
are pressed further instead. Fine roughness has a roll-off of a quarter of the feed and waves down to a sixteenth.
Lengths are over the feed.
"""

from __future__ import annotations

import csv
import math
import sys
from dataclasses import replace
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np
from scipy.optimize import least_squares

import leak
from leak.direct import PeriodicHalfSpace, patch_flow, press_elastoplastic
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS
from leak.theory.crest_flow import CrestFlow

TABLE = Path(__file__).with_name("turned_bulk.csv")
MODES = {
    "x": (1, 0),
    "-x": (-1, 0),
    "y": (0, 1),
    "-y": (0, -1),
    "x-y": (1, -1),
    "xy": (1, 1),
    "-x-y": (-1, -1),
    "2y-x": (-0.5, 1),
}
CELL = ("seed", "hardness_over_modulus", "fine_over_crest", "points")
PATH = (*CELL, "pressure_over_hardness", "mode")
VALUES = ("strain", "area", "gap", "k_across", "k_along")
# What the numbers are fitted to; all else is held out.
FITTED_HARDNESS, FITTED_PRESSURES, FITTED_FINE = (0.05, 0.2), (0.01, 0.02, 0.05, 0.1), 0.08
# Slope of the faces that theory takes, as small as that of real ones; and of metal a step that lets it flow in bulk.
SLOPE, LITTLE = 1e-3, 1e-12
# Flow along the valleys down to which it is compared, over that without strain.
OPEN = 0.05
STRAINS, STEP = np.linspace(0.0, 0.3, 11), 0.0125
PRESSED = (*np.arange(0.0025, 0.03, 0.0025), *np.arange(0.03, 0.13, 0.005))


class State(NamedTuple):
    """Strains over m', areas touched, pressure at rest by pressed cells, flow along the valleys over the first one."""

    path: tuple[str, ...]
    strains: tuple[float, float]
    first: float
    area: float
    at_rest: float | None
    along: float


@cache
def face(hardness: float, fine_over_crest: float) -> leak.TurnedContact:
    """Of a small slope; hardness over E* m'."""
    ends = {"q_low": 0.999 * 2.0 * math.pi, "q_rolloff": 8.0 * math.pi, "q_high": 32.0 * math.pi}
    fine = leak.PowerSpectrum.self_affine(rms_height=0.25 * SLOPE * fine_over_crest, hurst=0.8, **ends)
    elastic = leak.TurnedContact(feed=1.0, nose_radius=0.5 / SLOPE, fine=fine, effective_modulus=1.0)
    return leak.TurnedContact(
        feed=1.0,
        nose_radius=0.5 / SLOPE,
        fine=fine,
        effective_modulus=1.0,
        hardness=2.0 * hardness * elastic.contact_pressure,
    )


def slope(of: leak.TurnedContact) -> float:
    """m' across the crests."""
    return 2.0 * of.elastic.contact_pressure / of.effective_modulus


def states() -> list[State]:
    """Of the table."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    pressed = {
        cell: np.array([[float(row["pressure_over_hardness"]), float(row["k_across"])] for row in group])
        for cell, group in groupby(
            (row for row in rows if row["mode"] == "press"), lambda row: tuple(row[name] for name in CELL)
        )
    }
    found = []
    strained = (row for row in rows if row["mode"] != "press")
    for path, group in groupby(strained, key=lambda row: tuple(row[name] for name in PATH)):
        first, *rest = group
        curve = pressed.get(path[: len(CELL)], np.empty((0, 2)))
        curve = curve[curve[:, 1] > 0.0]
        for row in rest:
            strain, k = float(row["strain"]), float(row["k_across"])
            at_rest = None
            if curve.size and k > curve[-1, 1]:
                at_rest = float(np.exp(np.interp(-math.log(k), *(-np.log(curve[:, 1]), np.log(curve[:, 0])))))
            x, y = (sign * strain for sign in MODES[path[-1]])
            valleys = float(row["k_along"]) / float(first["k_along"])
            found.append(State(path, (x, y), float(first["area"]), float(row["area"]), at_rest, valleys))
    return found


def theory(state: State, law: CrestFlow = CrestFlow()) -> tuple[float, float]:  # noqa: B008
    """Area touched, and pressure at rest over the hardness."""
    _, hardness, fine, _, share, _ = state.path
    of, x = face(float(hardness), float(fine)), float(share)
    rest = float(of.contact_area(x * of.hardness))
    (wider, by_theory), (along, _) = law.widened(
        np.array([state.first, rest]),
        np.full(2, x),
        tuple(np.full(2, e) for e in state.strains),
        slope=1.0,
        hardness=float(hardness),
    )
    closer = law.closing * (1.0 - law.direction * along) * (by_theory - 1.0)
    return state.first * float(wider), x * float(1.0 + closer)


def along(state: State) -> float:
    """Flow along the valleys over that without strain, of a face whose thread lets all through."""
    of = replace(face(float(state.path[1]), float(state.path[2])), thread_radius=1e-3)
    p = float(state.path[4]) * of.hardness
    both = [p, float(of.pressure_at_rest(p, *(e * slope(of) for e in state.strains)))]
    conductivities = np.mean(of.valley_gaps(both) ** 3, axis=1)
    return float(conductivities[1] / conductivities[0])


def misses(of: list[State], law: CrestFlow = CrestFlow()) -> tuple[np.ndarray, np.ndarray]:  # noqa: B008
    """ln(theory/simulated) of areas, and of pressures at rest."""
    both = [(theory(state, law), state) for state in of]
    areas = np.array([math.log(found[0] / state.area) for found, state in both])
    return areas, np.array([math.log(found[1] / state.at_rest) for found, state in both if state.at_rest])


def fit(of: list[State]) -> CrestFlow:
    """Rate, power, flow across, closing and direction; the delay is half a yield strain."""
    names = ("rate", "line", "across", "closing", "direction")

    def law(numbers: np.ndarray) -> CrestFlow:
        return CrestFlow()._replace(**dict(zip(names, numbers, strict=True)))

    start = [getattr(CrestFlow(), name) for name in names]
    return law(least_squares(lambda numbers: np.concatenate(misses(of, law(numbers))), start).x)


def is_fitted(state: State) -> bool:
    """Whether the numbers are found from it."""
    hardness, fine, share = float(state.path[1]), float(state.path[2]), float(state.path[4])
    return hardness in FITTED_HARDNESS and share in FITTED_PRESSURES and fine == FITTED_FINE


def wilson_sheu(state: State) -> float:
    """Area of ridges on rigid plastic metal that is strained across them, from that at rest on.

    W. R. D. Wilson, S. Sheu, Int. J. Mech. Sci. 30, 475 (1988); M. P. F. Sutcliffe, ibid. 847, for the nominal pressure
    p, shear yield stress k and E, strain rate times half the spacing over the velocity of flattening:
    p/(A k) = 2/(f1 E + f2). With sides of slope m the area grows by d(strain)/(E m).
    """
    of, area = face(float(state.path[1]), float(state.path[2])), state.first
    share = float(state.path[4]) * HARDNESS_OVER_YIELD_STRESS * math.sqrt(3.0)
    steps = 2000
    for _ in range(steps):
        f1 = 0.515 + 0.345 * area - 0.86 * area**2
        f2 = 1.0 / (2.571 - area - area * math.log(1.0 - area))
        velocity = f1 / max(2.0 * area / share - f2, 1e-2)
        area += velocity * state.strains[0] * slope(of) / of.texture.side_slope / steps
    return area


def simulate(path: tuple[str, ...], file: TextIO) -> None:
    """Append the states of a path to a table."""
    seed, hardness, fine, points, share, mode = path
    of, n, metal = face(float(hardness), float(fine)), int(points), {"yield_stress": float(hardness) / 2.9}
    heights = of.texture.heights(points=n, crests=1, seed=int(seed)) / slope(of)
    body, state = PeriodicHalfSpace(n, 1.0, 1.0), None
    shares = (
        PRESSED if mode == "press" else np.linspace(0.0, float(share), round(float(share) / STEP) + 4)[1:]
    )

    def write(at: float, strain: float) -> None:
        k = [patch_flow(np.ascontiguousarray(gap)).gap_cubed for gap in (state.gap, state.gap.T)]
        values = (at, strain, state.contact_area, state.gap.mean(), *k)
        where = ",".join([*path[: len(CELL)], f"{at:.4g}", mode])
        file.write(where + "," + ",".join(f"{value:.5g}" for value in values[1:]) + "\n")

    for at in shares:
        p = at * float(hardness)
        (state,) = press_elastoplastic(body, heights, [p], start=state, strain=[[LITTLE, 0.0]], **metal)
        if mode == "press":
            write(at, 0.0)
    for strain in () if mode == "press" else STRAINS:
        both = [[sign * strain for sign in MODES[mode]]]
        (state,) = press_elastoplastic(body, heights, [p], start=state, strain=both, **metal)
        write(float(share), strain)


def paths() -> list[tuple[str, ...]]:
    """Of the table; one for all pressures of a cell that is pressed."""
    with TABLE.open(encoding="utf-8") as file:
        rows = [[row[name] for name in PATH] for row in csv.DictReader(file)]
    return list(dict.fromkeys((*row[:4], "0" if row[5] == "press" else row[4], row[5]) for row in rows))


def main() -> None:
    """Print the numbers."""
    if "--simulate" in sys.argv:
        with Path(sys.argv[-1]).open("w", encoding="utf-8") as file:
            file.write(",".join([*PATH, *VALUES]) + "\n")
            for path in paths():
                simulate(path, file)
        return
    of = states()
    if "--fit" in sys.argv:
        print(fit([state for state in of if is_fitted(state)]))
    for held in (False, True):
        print("held out:" if held else "fitted to:")
        for mode in MODES:
            part = [state for state in of if state.path[-1] == mode and is_fitted(state) != held]
            if not part:
                continue
            areas, rest = misses(part)
            print(f"  {mode}: {areas.size} areas, rms {rms(areas):.3f}, worst {abs(areas).max():.2f}")
            valleys = np.array([math.log(along(state) / state.along) for state in part if state.along > OPEN])
            print(f"    flow along the valleys: rms {rms(valleys):.2f}, mean {valleys.mean():.2f}")
            if rest.size:
                print(f"    {rest.size} pressures at rest, rms {rms(rest):.3f}, mean {rest.mean():.3f}")
    across = [state for state in of if state.path[-1] == "x" and state.strains[0] > 0.1]
    ratios = np.array([math.log(wilson_sheu(state) / state.area) for state in across])
    print(
        f"Wilson and Sheu, strained by more than 0.1 slopes across: rms {rms(ratios):.2f}, mean {ratios.mean():.2f}"
    )


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


if __name__ == "__main__":
    main()
