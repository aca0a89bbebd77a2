"""Rough faces over a bulk that is strained: the numbers of `leak.theory.bulk_flow`, and how far they are off.

    python benchmarks/bulk_flow.py             from benchmarks/bulk_flow.csv
    python benchmarks/bulk_flow.py --fit       find the numbers once more, from what is not held out
    python benchmarks/bulk_flow.py --simulate FILE  simulate all paths once more, in some 40 minutes

Maps of 64^2 points, rms slope 1 and E* = 1 are pressed on von Mises' metal to a part of the hardness and then strained
in their plane at this pressure: along x, along y, in both directions, or in one more and in the other less. A lay
stretches the map along x. Lengths of the gaps are over the rms height, conductivities over its cube. Maps that differ
only by their seed count by their means.
"""

from __future__ import annotations

import csv
import math
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np
from scipy.optimize import brentq, least_squares

import leak
from leak.direct import PeriodicHalfSpace, patch_flow, press_elastoplastic
from leak.theory.bulk_flow import BULK_FLOW, BulkFlow, BulkFlowConstants, BulkStrain

TABLE = Path(__file__).with_name("bulk_flow.csv")
MODES = {
    "x": (1, 0),
    "-x": (-1, 0),
    "y": (0, 1),
    "-y": (0, -1),
    "xy": (1, 1),
    "x-y": (1, -1),
    "-xy": (-1, -1),
}
WAVE, POINTS = 2.0 * np.pi, 64
# Ratios of conductivities down to which they are compared.
OPEN, NEARLY_SEALED, TINY = 1e-2, 1e-3, 1e-12
PATH = (
    "lay",
    "cutoff",
    "hurst",
    "rolloff",
    "hardness_over_modulus",
    "pressure_over_hardness",
    "mode",
    "held_out",
)
STRAINS = (0.0, 0.02, 0.04, 0.06, 0.09, 0.12, 0.16, 0.2, 0.26, 0.33, 0.4)
# Of areas, conductivities, those nearly sealed and those of one direction, in ln; and what counts at most.
SCATTER, MOST = (0.06, 0.3, 0.7, 0.5), 3.0
# One yield strain, read off the strains that seal, and off what is printed.
NOT_FITTED = ("delay", "least", "spread")


class State(NamedTuple):
    """A strained face over the one that is not, means of some maps; conductivities along and across x."""

    path: tuple[str, ...]
    maps: int
    at_rest: float
    strain: float
    area: float
    along: float
    across: float
    gap: float

    @property
    def mean(self) -> float:
        """Of both conductivities."""
        return 0.5 * (self.along + self.across)

    @property
    def is_mean(self) -> bool:
        """Whether enough maps of an isotropic face let enough through."""
        # where less is left at rest one map of four carries nearly all
        return self.maps > 3 and self.path[0] == "1" and self.at_rest > 0.03


@cache
def spectrum(lay: float, cutoff: float, hurst: float, rolloff: float) -> leak.PowerSpectrum:
    """That a lay makes one of rms slope 1."""
    ends = {"q_low": 0.999 * rolloff * WAVE, "q_rolloff": rolloff * WAVE, "q_high": cutoff * WAVE}
    unit = leak.PowerSpectrum.self_affine(rms_height=1.0, hurst=hurst, **ends)
    return unit.scaled(1.0 / leak.stretched_spectrum(unit, lay).rms_slope)


@cache
def face(
    lay: float, cutoff: float, hurst: float, rolloff: float, hardness: float, *, turned: bool = False
) -> leak.RoughContact:
    """Of rms slope 1, for flow along x or, turned, across it."""
    return leak.RoughContact(
        leak.stretched_spectrum(spectrum(lay, cutoff, hurst, rolloff), lay),
        effective_modulus=1.0,
        hardness=hardness,
        theory="corrected",
        peklenik=1.0 / lay if turned else lay,
    )


@cache
def table(surface: leak.RoughContact) -> leak.ConductivityTable:
    """Of the face over a bulk that is not strained."""
    return surface.conductivity_table(1e-4 * surface.sealing_pressure, surface.sealing_pressure)


def states() -> list[State]:
    """Of the table, at the strains that all maps of a path know."""
    paths: dict[tuple[str, ...], dict[str, dict[float, list[float]]]] = defaultdict(lambda: defaultdict(dict))
    with TABLE.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            values = [float(row[name]) for name in ("area", "k_along", "k_across", "gap")]
            paths[tuple(row[name] for name in PATH)][row["seed"]][float(row["strain"])] = values
    found = []
    for path, maps in paths.items():
        strains = sorted(set.intersection(*map(set, maps.values())))
        mean = np.mean([[one[strain] for strain in strains] for one in maps.values()], axis=0)
        at_rest = float(mean[0, 1:3].mean())
        found += [
            State(path, len(maps), at_rest, strain, *map(float, values / mean[0]))
            for strain, values in zip(strains[1:], mean[1:], strict=True)
        ]
    return found


def theory(state: State, constants: BulkFlowConstants = BULK_FLOW) -> tuple[float, float, float]:
    """Ratios of area and conductivities along and across x."""
    *shape, share, mode, _ = state.path
    *shape, hardness = map(float, shape)
    p, ratios = float(share) * hardness, []
    strains = tuple(sign * state.strain for sign in MODES[mode])
    for turned in (False, True):
        rest = face(*shape, hardness, turned=turned)
        area = float(np.asarray(rest.contact_area(p)))
        bulk = BulkFlow.of(
            BulkStrain(*(strains[::-1] if turned else strains)),
            rms_slope=rest.spectrum.rms_slope,
            hardness=hardness,
            effective_modulus=rest.effective_modulus,
            peklenik=rest.peklenik,
            constants=constants,
        )
        u = np.asarray(table(rest).effective_separation([p, float(bulk.pressure(area, p))]))
        ratios.append(float((u[1] / u[0]) ** 3))
    return float(bulk.area(area, p)) / area, *ratios


def gap_at_rest(state: State) -> float:
    """Mean gap at rest under the pressure that lets as much through, over that without strain, for flow along x."""
    *shape, share, mode, _ = state.path
    rest, p = face(*map(float, shape)), float(share) * float(shape[-1])
    acts = rest.pressure_at_rest(p, *(sign * state.strain for sign in MODES[mode]))
    gaps = np.asarray(rest.mean_separation(np.append(p, acts)))
    return float(gaps[1] / gaps[0])


def log_misses(state: State, constants: BulkFlowConstants = BULK_FLOW) -> list[float]:
    """ln(theory/direct) of area, mean conductivity, and conductivities along and across x."""
    area, *k = theory(state, constants)
    pairs = [(area, state.area), (0.5 * sum(k), state.mean), (k[0], state.along), (k[1], state.across)]
    return [math.log(max(one, TINY) / max(other, TINY)) for one, other in pairs]


def fit(of: list[State]) -> BulkFlowConstants:
    """The numbers that meet areas and conductivities best, as far as these are not nearly sealed."""
    names = [name for name in BulkFlowConstants._fields if name not in NOT_FITTED]
    start = np.array([getattr(BULK_FLOW, name) for name in names])

    def constants(values: np.ndarray) -> BulkFlowConstants:
        return BULK_FLOW._replace(**dict(zip(names, map(float, values), strict=True)))

    def miss(values: np.ndarray) -> np.ndarray:
        misses = []
        for state in of:
            area, *k = np.clip(log_misses(state, constants(values)), -MOST, MOST)
            is_open, is_left = state.mean > OPEN, state.mean > NEARLY_SEALED
            both = is_left * k[0] / SCATTER[1 if is_open else 2]
            single = [is_open * one / SCATTER[3] for one in k[1:]]
            weight = 0.5 * math.sqrt(min(state.maps, 4))
            misses += [weight * one for one in (area / SCATTER[0], both, *single)]
        return np.array(misses)

    found = least_squares(miss, start, x_scale=np.abs(start), loss="soft_l1", diff_step=1e-4)
    return constants(found.x)


def sealing_strain(of: list[State], level: float) -> float | None:
    """Theory's over the direct one's strain that leaves a part of the conductivity; None where a path ends before."""
    logs = np.log([1.0, *(max(state.mean, TINY) for state in of)])
    if logs[-1] > math.log(level):
        return None
    after = int(np.argmax(logs <= math.log(level)))
    # of what is sealed only that it is
    ends = np.maximum(logs[after - 1 : after + 1], math.log(1e-9))
    strains = [0.0, *(state.strain for state in of)]
    strain = float(np.interp(-math.log(level), -ends, strains[after - 1 : after + 1]))

    def too_open(factor: float) -> float:
        return math.log(max(0.5 * sum(theory(of[0]._replace(strain=factor * strain))[1:]), TINY) / level)

    return float(brentq(too_open, 0.2, 5.0, xtol=1e-3))


def simulate(row: dict[str, str], file: TextIO) -> None:
    """Append the states of a path to a table."""
    shape = [float(row[name]) for name in PATH[:4]]
    hardness, share = float(row["hardness_over_modulus"]), float(row["pressure_over_hardness"])
    h = leak.random_map(
        spectrum(*shape),
        size=1.0,
        points=POINTS,
        seed=int(row["seed"]),
        peklenik=shape[0],
        amplitudes="exact",
    )
    body, metal = PeriodicHalfSpace(POINTS, 1.0, 1.0), {"yield_stress": hardness / 2.9}
    pressure, state = share * hardness, None
    for p in np.linspace(0.0, pressure, max(round(share / 0.0125), 2) + 1)[1:]:
        (state,) = press_elastoplastic(body, h, [p], start=state, **metal)
    for strain in STRAINS:
        both = [[sign * strain for sign in MODES[row["mode"]]]]
        (state,) = press_elastoplastic(body, h, [pressure], start=state, strain=both, **metal)
        k = [
            patch_flow(np.ascontiguousarray(gap)).gap_cubed / h.std() ** 3 for gap in (state.gap, state.gap.T)
        ]
        values = (strain, state.contact_area, state.gap.mean() / h.std(), *k)
        line = [row["seed"], *(row[name] for name in PATH), *(f"{value:.5g}" for value in values)]
        file.write(",".join(line) + "\n")


def main() -> None:
    """Print the numbers."""
    if "--simulate" in sys.argv:
        with TABLE.open(encoding="utf-8") as file:
            rows = {tuple(row[name] for name in ("seed", *PATH)): row for row in csv.DictReader(file)}
        with Path(sys.argv[-1]).open("w", encoding="utf-8") as file:
            file.write(",".join(["seed", *PATH, "strain", "area", "gap", "k_along", "k_across"]) + "\n")
            for row in rows.values():
                simulate(row, file)
        return
    of = states()
    if "--fit" in sys.argv:
        print(fit([state for state in of if state.path[-1] == "0"]))
    means = [state for state in of if state.is_mean]
    print_errors("means of four maps", means)
    print_errors("    of these held out", [state for state in means if state.path[-1] == "1"])
    print_errors("one to three maps", [state for state in of if state.maps < 4])
    with_lay = [state for state in of if state.path[0] != "1"]
    for name in dict.fromkeys(state.path for state in with_lay):
        print_errors(f"lay {name}", [state for state in with_lay if state.path == name])
    for level in (NEARLY_SEALED, 1e-6):
        ratios = [
            sealing_strain([one for one in means if one.path == path], level) for path in paths_of(means)
        ]
        print(f"strain that leaves {level:g}, theory/direct:", sorted(round(one, 2) for one in ratios if one))


def paths_of(of: list[State]) -> list[tuple[str, ...]]:
    """Each path once."""
    return list(dict.fromkeys(state.path for state in of))


def print_errors(name: str, of: list[State]) -> None:
    """Of areas, of conductivities, and of those along and across x."""
    error = np.array([log_misses(state) for state in of])
    left = np.array([[state.mean, state.along, state.across] for state in of])
    sunk = 1.0 - 1.0 / np.array([state.area for state in of])
    area = error[:, 0]
    print(f"{name}: {len(of)} states, area rms {rms(area):.3f}, {area.min():.2f} to {area.max():.2f}")
    for low, high in ((OPEN, 2.0), (NEARLY_SEALED, OPEN), (NEARLY_SEALED, 2.0)):
        parts = (left > low) & (left <= high)
        if parts.any(axis=0).all():
            mean, along, across = (rms(error[part, i]) for i, part in enumerate(parts.T, 1))
            print(
                f"    conductivity {low:g} to {high:g}: {parts[:, 0].sum()}, rms {mean:.2f}, along x {along:.2f},"
                f" across {across:.2f}; over the share of the area from sinking {mean / rms(sunk[parts[:, 0]]):.2f}"
            )


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


if __name__ == "__main__":
    main()
