"""Rough patches whose pressure is capped at the hardness, loaded and unloaded: what the capped reading is fitted to.

Run: python docs/research/direct_yielding_campaign.py, one process, about half an hour; what the files hold already is
not calculated again. Box length 1, E* = 1 and rms slope 1, so that pressure and hardness are in units of E* h'.
Every surface is pressed elastically too: fitted is the elastic pressure that has the same effect on the same surface.
A second table has the contact area at which nothing flows any more.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

import leak
from leak.direct import PeriodicHalfSpace, patch_flow, press
from leak.direct.contact import ContactState
from leak.direct.flow import find_spanning

FILE = Path(__file__).with_name("direct_yielding.csv")
THRESHOLD_FILE = Path(__file__).with_name("direct_threshold.csv")
COLUMNS = (
    "grid_points_per_side",
    "rolloff_wavelengths_per_box",
    "cutoff_wavelengths_per_box",
    "hurst",
    "seed",
    "hardness_over_Eh",
    "branch",
    "p_over_Eh",
    "p_max_over_Eh",
    "contact_area",
    "yielded_area",
    "mean_gap_over_hrms",
    "conductivity",
)
THRESHOLD_COLUMNS = (*COLUMNS[:6], "direction", "p_over_Eh", "contact_area", "yielded_area")


class Patch(NamedTuple):
    """One surface and the loads it is to carry."""

    grid: int
    rolloff: float
    cutoff: float
    hurst: float
    seed: int
    elastic: tuple[float, ...] = (0.001, 0.002, 0.004, 0.008, 0.016, 0.03, 0.055, 0.09, 0.14, 0.2)
    hardness: tuple[float, ...] = (0.03, 0.08, 0.2, 0.5)
    loads: tuple[float, ...] = (0.001, 0.004, 0.016, 0.06)
    unload: tuple[float, ...] = (0.5, 0.2, 0.05, 0.01)
    flow: bool = True

    @property
    def label(self) -> tuple[str, ...]:
        """The first columns of its rows."""
        return tuple(f"{x:g}" for x in (self.grid, self.rolloff, self.cutoff, self.hurst, self.seed))


def heights(patch: Patch) -> np.ndarray:
    """Random phases, every amplitude as the spectrum says, rms slope 1."""
    q, n = 2.0 * math.pi, patch.grid
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.0,
        hurst=patch.hurst,
        q_low=0.9 * q,
        q_rolloff=patch.rolloff * q,
        q_high=1.000001 * patch.cutoff * q,
    )
    h = leak.random_map(spectrum, size=1.0, points=n, seed=patch.seed, amplitudes="exact")
    wave, power = q * np.fft.fftfreq(n, 1.0 / n), np.abs(np.fft.fft2(h) / n**2) ** 2
    return h / math.sqrt(float(np.sum(power * (wave[:, None] ** 2 + wave[None, :] ** 2))))


def rows(patch: Patch) -> Iterator[tuple[str, ...]]:
    """All states of one patch. The flow is left out of some states of unloading, where gap and area are enough."""
    h = heights(patch)
    body, h_rms = PeriodicHalfSpace(patch.grid, 1.0, 1.0), float(np.std(h))

    def row(
        hardness: float | None, branch: str, p_max: float, p: float, state: ContactState, flow: bool
    ) -> tuple[str, ...]:
        yielded = 0.0 if hardness is None else float(np.mean(state.pressure >= hardness))
        u3 = (
            0.5 * sum(patch_flow(gap).gap_cubed for gap in (state.gap, state.gap.T))
            if patch.flow and flow
            else None
        )
        numbers = (float(np.mean(state.pressure > 0.0)), yielded, float(state.gap.mean()) / h_rms)
        return (
            *patch.label,
            "" if hardness is None else f"{hardness:g}",
            branch,
            f"{p:.6g}",
            f"{p_max:.6g}",
            *(f"{x:.5g}" for x in numbers),
            "" if u3 is None else f"{u3 / h_rms**3:.5g}",
        )

    start = None
    for p in patch.elastic:
        state = press(body, h, p, start=start)
        start = state.pressure
        yield row(None, "load", p, p, state, True)
    for hardness in patch.hardness:
        tops = (0.1 * hardness, 0.25 * hardness) if hardness < 0.3 else (0.02, 0.06)
        near = (0.4 * hardness, 0.46 * hardness) if hardness < 0.3 else (0.12,)
        start = None
        for p in sorted({*(p for p in patch.loads if p < 0.35 * hardness), *tops, *near}):
            state = press(body, h, p, hardness=hardness, start=start)
            start = state.pressure
            yield row(hardness, "load", p, p, state, True)
            if p not in tops:
                continue
            flattened, back = h - state.overlap, state.pressure
            for fraction in patch.unload:
                state = press(body, flattened, fraction * p, hardness=hardness, start=back)
                back = state.pressure
                yield row(hardness, "unload", p, fraction * p, state, fraction == 0.2)


def patches() -> Iterator[Patch]:
    """Hurst exponent by roll-off, two surfaces each; and the spectrum of the paper's seat, on a finer grid."""
    even = [(0.7, 8), (0.5, 4), (0.9, 16), (0.5, 16), (0.9, 4), (0.7, 4), (0.7, 16), (0.5, 8)]
    odd = [(0.7, 8), (0.5, 4), (0.9, 16), (0.9, 8), (0.9, 4), (0.5, 8)]
    for seed, spectra in ((0, even), (1, odd)):
        for hurst, rolloff in spectra:
            yield Patch(256, rolloff, 32, hurst, seed)
    # with the ratio of hardness to E* h' of that seat; contact only
    for seed in (1, 0):
        yield Patch(
            512,
            4,
            128,
            0.6,
            seed,
            elastic=(0.001, 0.002, 0.004, 0.01, 0.025, 0.06, 0.15),
            hardness=(0.076, 0.2),
            loads=(0.00125, 0.004),
            unload=(0.2,),
            flow=False,
        )


def thresholds(patch: Patch) -> Iterator[tuple[str, ...]]:
    """Where the open area stops find_spanning the patch, by bisection in the pressure, for flow along either axis."""
    h = heights(patch)
    body = PeriodicHalfSpace(patch.grid, 1.0, 1.0)
    for hardness in (None, 0.5, 0.2, 0.08, 0.03):
        state = press(body, h, 0.1 if hardness is None else 0.3 * hardness, hardness=hardness)
        for direction in (0, 1):
            low, high = (0.1, 0.32) if hardness is None else (0.3 * hardness, min(0.65 * hardness, 0.25))
            for _ in range(9):
                p = 0.5 * (low + high)
                state = press(body, h, p, hardness=hardness, start=state.pressure)
                opened = state.gap > 0.0
                low, high = (
                    (p, high) if find_spanning(opened if direction == 0 else opened.T).any() else (low, p)
                )
            yielded = 0.0 if hardness is None else float(np.mean(state.pressure >= hardness))
            area = float(np.mean(state.pressure > 0.0))
            numbers = (f"{x:.5g}" for x in (p, area, yielded))
            yield (*patch.label, "" if hardness is None else f"{hardness:g}", str(direction), *numbers)


def main() -> None:
    """Add what is missing to both tables."""
    spectra = [(0.7, 8), (0.5, 16), (0.9, 16), (0.5, 8), (0.9, 8), (0.7, 16)]
    several = [Patch(256, rolloff, 32, hurst, seed) for seed in (0, 1) for hurst, rolloff in spectra]
    complete(FILE, COLUMNS, ((patch.label, rows(patch)) for patch in patches()))
    complete(THRESHOLD_FILE, THRESHOLD_COLUMNS, ((patch.label, thresholds(patch)) for patch in several))


# The first columns of the rows of a calculation, and the rows.
Calculation = tuple[tuple[str, ...], Iterator[tuple[str, ...]]]


def complete(path: Path, columns: tuple[str, ...], calculations: Iterable[Calculation]) -> None:
    """Add the rows of those calculations that a table does not hold."""
    with path.open("a+", newline="", encoding="utf-8") as file:
        file.seek(0)
        known = [tuple(row) for row in csv.reader(file)]
        writer = csv.writer(file, lineterminator="\n")
        if not known:
            writer.writerow(columns)
        for label, states in calculations:
            if any(row[: len(label)] == label for row in known):
                continue
            calculated = list(states)
            writer.writerows(calculated)
            file.flush()
            print(path.name, ", ".join(label), f"{len(calculated)} states", flush=True)


if __name__ == "__main__":
    main()
