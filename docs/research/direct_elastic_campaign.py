"""Direct simulations of elastic rough contacts that the effective media are fitted to and judged by.

Isotropic surfaces of several Hurst exponents, roll-offs and bandwidths, and stretched ones: A/A0, mean gap and flow
conductivity over pressure, one row per surface and pressure. Boundary elements and Reynolds flow of `leak.direct`.

Run: python docs/research/direct_elastic_campaign.py   (a quarter of an hour of one core; goes on where it stopped)
     python docs/research/direct_elastic_campaign.py low-load   (half an hour: from the loads at which seats work)
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from leak.direct import patch_flow, periodic_flow, press

FloatArray = NDArray[np.float64]

FILE = Path(__file__).with_name("direct_elastic.csv")
LOW_LOAD_FILE = Path(__file__).with_name("direct_low_load.csv")
COLUMNS = (
    "peklenik",
    "hurst",
    "rolloff_waves",
    "cutoff_waves",
    "grid_points",
    "seed",
    "p_over_Eh",
    "contact_area",
    "mean_gap_over_hrms",
    "conductivity_along",
    "conductivity_across",
)
# Excess: how much higher the height that twice the contact area exceeds is than that of Gaussian heights; few summits
# touch at low load, and a small patch lacks the highest of them.
LOW_LOAD_COLUMNS = (
    *COLUMNS[:-2],
    "excess_height_over_hrms",
    "periodic_conductivity_along",
    "periodic_conductivity_across",
)
_PRESSURES = (0.01, 0.03, 0.06, 0.09, 0.12, 0.15, 0.18)
_PRESSURES_STRETCHED = (0.01, 0.03, 0.06, 0.1)
_PRESSURES_LOW = (3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3)


@dataclass(frozen=True)
class Patch:
    """A random periodic patch; each side holds as many correlation lengths, whatever the lay.

    Parameters
    ----------
    peklenik : float
        Length of the patch along x over that along y, like the correlation lengths of its roughness.
    hurst : float
    rolloff, cutoff : int
        Waves per side.
    points : int
        Grid points along the shorter side, y; the cells are square.
    seed : int
    """

    peklenik: float
    hurst: float
    rolloff: int
    cutoff: int
    points: int
    seed: int

    @property
    def sides(self) -> tuple[float, float]:
        """Lengths along x and y; their product is one."""
        return self.peklenik**0.5, self.peklenik**-0.5

    def heights(self) -> FloatArray:
        """Gaussian heights of rms slope one, shape (peklenik * points, points); the same on every grid."""
        waves = np.arange(-self.cutoff, self.cutoff + 1)
        i, j = np.meshgrid(waves, waves, indexing="ij")
        q = np.hypot(i, j)
        C = np.where(
            q < self.rolloff, 1.0, (np.maximum(q, 1.0) / self.rolloff) ** (-2.0 * (1.0 + self.hurst))
        )
        C[(q == 0) | (q > self.cutoff)] = 0.0
        random = np.random.default_rng(self.seed)
        amplitude = np.sqrt(C) * (random.standard_normal(q.shape) + 1j * random.standard_normal(q.shape))
        # the real part of the sum over all waves is a real field of the same spectrum
        amplitude = 0.5 * (amplitude + amplitude[::-1, ::-1].conj())
        (long, short), (n, m) = self.sides, (round(self.peklenik * self.points), self.points)
        slope = np.sqrt(
            np.sum(np.abs(amplitude) ** 2 * (2.0 * np.pi) ** 2 * ((i / long) ** 2 + (j / short) ** 2))
        )
        field = np.zeros((n, m), dtype=complex)
        field[i, j] = amplitude / slope
        return np.fft.ifft2(field).real * n * m


@dataclass(frozen=True, eq=False)
class RectangularHalfSpace:
    """`leak.direct.PeriodicHalfSpace` of a cell whose sides differ, E* = 1.

    Parameters
    ----------
    shape : tuple of int
    sides : tuple of float
    """

    shape: tuple[int, int]
    sides: tuple[float, float]

    def displacement(self, pressure: FloatArray) -> FloatArray:
        """u(q) = 2 p(q)/(E* q)."""
        q = [2.0 * np.pi * np.fft.fftfreq(n, L / n) for n, L in zip(self.shape, self.sides, strict=True)]
        both = np.hypot(q[0][:, None], np.abs(q[1][: self.shape[1] // 2 + 1]))
        both[0, 0] = np.inf
        return np.fft.irfft2(np.fft.rfft2(pressure) * (2.0 / both), s=self.shape)


def patches() -> Iterator[tuple[Patch, tuple[float, ...]]]:
    """The patches and the pressures over E* h' at which each is pressed."""
    for seed in range(3):
        for hurst in (0.5, 0.7, 0.9):
            for rolloff in (4, 8):
                yield Patch(1.0, hurst, rolloff, 32, 256, seed), _PRESSURES
        if seed < 2:
            for hurst in (0.5, 0.8):
                for peklenik in (1.0, 2.0, 5.0):
                    yield Patch(peklenik, hurst, 6, 24, 192, seed), _PRESSURES_STRETCHED
            yield Patch(3.0, 0.6, 6, 24, 192, seed), _PRESSURES_STRETCHED
            yield Patch(10.0, 0.6, 4, 16, 128, seed), _PRESSURES_STRETCHED
    # more waves on a grid of four points per shortest wave (area 6 % too large, conductivity 10 % too small); the first
    # of them also on a finer grid
    for seed in range(4):
        for hurst in (0.5, 0.9):
            yield Patch(1.0, hurst, 4, 64, 256, seed), _PRESSURES
            if seed < 2:
                yield Patch(1.0, hurst, 16, 64, 256, seed), _PRESSURES
    for hurst in (0.5, 0.9):
        yield Patch(1.0, hurst, 4, 64, 512, 0), _PRESSURES
    yield Patch(1.0, 0.7, 4, 128, 512, 0), _PRESSURES


def low_load_patches() -> Iterator[tuple[Patch, tuple[float, ...]]]:
    """Isotropic patches to press from low load on, four points per shortest wave, and their pressures over E* h'."""
    # Hurst exponents, roll-off, cutoff, seeds
    groups = (
        ((0.3, 0.8), 16, 64, range(10, 13)),
        ((0.3, 0.5, 0.8), 8, 64, range(20, 24)),
        ((0.4, 0.7), 4, 128, range(40, 46)),
        ((0.5, 0.8), 8, 128, range(30, 32)),
        ((0.8,), 4, 256, range(50, 51)),
    )
    for hursts, rolloff, cutoff, seeds in groups:
        for seed in seeds:
            for hurst in hursts:
                yield Patch(1.0, hurst, rolloff, cutoff, 4 * cutoff, seed), _PRESSURES_LOW


def held_out(rolloff: float, cutoff: float) -> bool:
    """Whether low-load rows with so many waves per side judge, and enter no fit: the widest bands."""
    return cutoff >= 32 * rolloff


def pressed_from_low_load(patch: Patch, pressures: tuple[float, ...]) -> Iterator[tuple[float, ...]]:
    """The columns of `LOW_LOAD_COLUMNS` from the pressure on: flow of the periodic cell, which has no open edges."""
    h = patch.heights()
    body, rms, start = RectangularHalfSpace(h.shape, patch.sides), float(h.std()), None
    highest = np.sort(h, axis=None)[::-1] / rms
    for p in pressures:
        state = press(body, h, p, start=start)
        start = state.pressure
        touching = int(np.count_nonzero(start > 0.0))
        # Hertz: a contact is half as large as what lies above the flat
        above = min(2 * touching, h.size - 1)
        excess = 0.5 * (highest[above - 1] + highest[above]) + ndtri(above / h.size)
        flows = [
            periodic_flow(np.ascontiguousarray(gap)).gap_cubed / rms**3 for gap in (state.gap, state.gap.T)
        ]
        yield p, touching / h.size, float(state.gap.mean()) / rms, float(excess), *flows


def pressed(patch: Patch, pressures: tuple[float, ...]) -> Iterator[tuple[float, ...]]:
    """Pressure, A/A0, mean gap over rms height, 12 eta sigma over rms height cubed along x and along y."""
    h = patch.heights()
    body, rms, start = RectangularHalfSpace(h.shape, patch.sides), float(h.std()), None
    for p in pressures:
        state = press(body, h, p, start=start)
        start = state.pressure
        flows = [patch_flow(np.ascontiguousarray(gap)).gap_cubed / rms**3 for gap in (state.gap, state.gap.T)]
        yield p, float(np.mean(state.pressure > 0.0)), float(state.gap.mean()) / rms, *flows


def main(low_load: bool) -> None:
    """Write the table; patches that stand in it already are not calculated again."""
    file = LOW_LOAD_FILE if low_load else FILE
    known: list[list[str]] = []
    if file.exists():
        with file.open(encoding="utf-8") as old:
            known = list(csv.reader(old))[1:]
    with file.open("w", newline="", encoding="utf-8") as out:
        write = csv.writer(out, lineterminator="\n").writerow
        write(LOW_LOAD_COLUMNS if low_load else COLUMNS)
        calculated = pressed_from_low_load if low_load else pressed
        for patch, pressures in low_load_patches() if low_load else patches():
            numbers = (patch.peklenik, patch.hurst, patch.rolloff, patch.cutoff, patch.points, patch.seed)
            case = [f"{number:g}" for number in numbers]
            done = [row for row in known if row[: len(case)] == case]
            new = len(done) < len(pressures)
            rows = ([*case, *(f"{value:.5g}" for value in row)] for row in calculated(patch, pressures))
            for row in rows if new else done:
                write(row)
                out.flush()


if __name__ == "__main__":
    main(low_load="low-load" in sys.argv[1:])
