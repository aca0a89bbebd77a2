"""Rough patches on metal that flows by von Mises, loaded and unloaded: what the corrected theory is fitted to.

Run: python docs/research/direct_von_mises_campaign.py, one process, about an hour; what the file holds already is not
calculated again. Box length 1, E* = 1 and rms slope 1, so that pressure and hardness are in units of E* h'; the yield
stress is hardness/2.9. Every patch is pressed elastically and with the pressure capped at the hardness as well. Load
steps are first order: the path is walked in coarse and in half as long steps, so that it can be extrapolated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from direct_yielding_campaign import Calculation, complete, heights

from leak.direct import PeriodicHalfSpace, patch_flow, press, press_elastoplastic

FILE = Path(__file__).with_name("direct_von_mises.csv")
COLUMNS = (
    "grid_points_per_side",
    "rolloff_wavelengths_per_box",
    "cutoff_wavelengths_per_box",
    "hurst",
    "seed",
    "poissons_ratio",
    "hardening",
    "hardness_over_Eh",
    "model",
    "branch",
    "p_over_Eh",
    "p_max_over_Eh",
    "contact_area",
    "mean_gap_over_hrms",
    "conductivity",
)
YIELD_STRESS = 1.0 / 2.9
ELASTIC = tuple(np.geomspace(1e-4, 0.2, 18))
# Pressures over the hardness, and those of them after which it is unloaded to a fifth and a twentieth.
LOADS = (0.003, 0.01, 0.025, 0.05, 0.075, 0.1, 0.125, 0.15, 0.175, 0.2, 0.225, 0.25, 0.275, 0.3, 0.325, 0.35)
UNLOADED = (0.1, 0.25)
LARGEST = 0.14


class Patch(NamedTuple):
    """One surface, and the metals that it is pressed on."""

    grid: int
    rolloff: int
    cutoff: int
    hurst: float
    seed: int
    hardness: tuple[float, ...] = (0.025, 0.05, 0.1, 0.2, 0.4, 0.8)
    metals: tuple[tuple[float, float], ...] = ((0.3, 0.0),)


SOFT, HARD = (0.025, 0.1, 0.4), (0.05, 0.2, 0.8)
PATCHES = (
    Patch(128, 4, 32, 0.8, 101),
    Patch(128, 4, 64, 0.5, 102, SOFT),
    Patch(128, 8, 32, 0.8, 103, HARD),
    Patch(128, 4, 32, 0.3, 104, SOFT),
    Patch(128, 8, 64, 0.6, 105, HARD),
    # held out
    Patch(128, 4, 64, 0.7, 201, (0.035, 0.15, 0.6)),
    Patch(128, 8, 64, 0.4, 202, (0.07, 0.3)),
    # other metals
    Patch(128, 8, 32, 0.5, 107, (0.1, 0.3), ((0.3, 0.0), (0.45, 0.0), (0.3, 0.02))),
    # held out, twice as fine
    Patch(256, 8, 64, 0.8, 203, (0.1,)),
)


class Row(NamedTuple):
    """A state of a patch, over E* h' and the rms height."""

    pressure: float
    largest: float
    area: float
    gap: float
    conductivity: float


def _row(pressure: float, largest: float, touching: np.ndarray, gap: np.ndarray, h_rms: float) -> Row:
    u3 = 0.5 * sum(patch_flow(np.ascontiguousarray(one)).gap_cubed for one in (gap, gap.T))
    return Row(pressure, largest, float(touching.mean()), float(gap.mean()) / h_rms, u3 / h_rms**3)


def elastic(patch: Patch, h: np.ndarray, hardness: float | None) -> Iterator[tuple[str, Row]]:
    """Elastic, or capped at the hardness: the state after each pressure, and of capped ones after unloading."""
    body, h_rms, start = PeriodicHalfSpace(patch.grid, 1.0, 1.0), float(np.std(h)), None
    for p in ELASTIC if hardness is None else path(hardness)[0]:
        state = press(body, h, p, hardness=hardness, start=start)
        start = state.pressure
        yield "load", _row(p, p, start > 0.0, state.gap, h_rms)
        if hardness is not None and any(abs(p / hardness - top) < 1e-9 for top in UNLOADED):
            flattened, back = h - state.overlap, start
            for fraction in (0.2, 0.05):
                state = press(body, flattened, fraction * p, hardness=hardness, start=back)
                back = state.pressure
                yield "unload", _row(fraction * p, p, back > 0.0, state.gap, h_rms)


def path(hardness: float) -> tuple[list[float], list[float]]:
    """Pressures in coarse steps, and with the middle between each two."""
    coarse = [load * hardness for load in LOADS if load * hardness <= LARGEST]
    before = [0.0, *coarse[:-1]]
    return coarse, [p for a, b in zip(before, coarse, strict=True) for p in (0.5 * (a + b), b)]


def von_mises(
    patch: Patch, h: np.ndarray, hardness: float, metal: tuple[float, float], fine: bool
) -> Iterator[tuple[str, Row]]:
    """On metal that flows: the state after each pressure of the coarse steps, and after unloading."""
    body, h_rms, (nu, hardening) = PeriodicHalfSpace(patch.grid, 1.0, 1.0), float(np.std(h)), metal
    coarse, all_steps = path(hardness)
    state, steps = None, 2 if fine else 1
    for n, p in enumerate(coarse):
        wanted = all_steps[2 * n : 2 * n + 2] if fine else [p]
        assert len(wanted) == steps
        settings = {"yield_stress": YIELD_STRESS * hardness, "poissons_ratio": nu, "hardening": hardening}
        state = press_elastoplastic(body, h, wanted, **settings, tolerance=3e-3, start=state, layers=20)[-1]
        yield "load", _row(p, p, state.pressure > 0.0, state.gap, h_rms)
        if not fine and any(abs(p / hardness - top) < 1e-9 for top in UNLOADED):
            back = press_elastoplastic(
                body, h, [0.2 * p, 0.05 * p], **settings, tolerance=3e-3, start=state, layers=20
            )
            for fraction, one in zip((0.2, 0.05), back, strict=True):
                yield "unload", _row(fraction * p, p, one.pressure > 0.0, one.gap, h_rms)


def calculations(patch: Patch) -> Iterator[Calculation]:
    """All of one patch."""
    h = heights(patch)

    def calculation(
        nu: float, hardening: float, hardness: float | None, model: str, states: Iterator[tuple[str, Row]]
    ) -> Calculation:
        numbers = (*patch[:5], nu, hardening, math.nan if hardness is None else hardness)
        label = (*(f"{x:g}" for x in numbers), model)
        return label, ((*label, branch, *(f"{x:.6g}" for x in row)) for branch, row in states)

    yield calculation(0.3, 0.0, None, "elastic", elastic(patch, h, None))
    for hardness in patch.hardness:
        yield calculation(0.3, 0.0, hardness, "capped", elastic(patch, h, hardness))
        for metal in patch.metals:
            for fine in (False, True):
                model = f"von-mises-{'half' if fine else 'whole'}-steps"
                yield calculation(*metal, hardness, model, von_mises(patch, h, hardness, metal, fine))


def main() -> None:
    """Add what is missing."""
    complete(FILE, COLUMNS, (states for patch in PATCHES for states in calculations(patch)))


if __name__ == "__main__":
    main()
