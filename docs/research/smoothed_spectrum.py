"""A surface with a plastically smoothed spectrum, pressed elastically, beside the capped surface that it stands for.

    python docs/research/smoothed_spectrum.py        simulate once more, in some minutes

Prints the table of docs/theory/yielding.md: gap and conductivity of the smoothed surface over those of boundary
elements whose pressure is capped at the hardness, by the same phases; means of some maps. Once with the spectrum C_pl,
once with one that is smoothed just so much that the theory has the mean gap of the capped surface.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

import leak
from leak.direct import simulate

FloatArray = NDArray[np.float64]

POINTS, ROLLOFF, CUTOFF, HURST = 256, 4, 32, 0.8
HARDNESSES, PRESSURES, SEEDS = (0.1, 0.2), (0.005, 0.01, 0.02, 0.04), (1, 2, 3)
_WAVE = 2.0 * np.pi


def spectrum() -> leak.PowerSpectrum:
    """Of rms slope one on the unit square."""
    one = leak.PowerSpectrum.self_affine(
        rms_height=1.0,
        hurst=HURST,
        q_low=0.9 * _WAVE,
        q_rolloff=ROLLOFF * _WAVE,
        q_high=CUTOFF * 1.0001 * _WAVE,
    )
    return one.scaled(1.0 / one.rms_slope)


def remains(wavenumber: FloatArray, pressure: float, hardness: float, extent: float = 1.0) -> FloatArray:
    """What smoothing leaves of the spectrum at each wavenumber, (C_pl/C)^extent, E* = 1."""
    # G = pi/4 int q^3 C dq over all longer waves
    variance = 0.25 * np.pi * spectrum().slope_moment(wavenumber) / hardness**2
    return np.maximum(leak.remaining_fraction(pressure / hardness, variance), 1e-30) ** extent


def theory_gap(pressure: float, hardness: float, extent: float) -> float:
    """Mean gap of the smoothed surface by Persson's theory."""
    q = np.geomspace(spectrum().q_low, spectrum().q_high, 2000)
    left = leak.PowerSpectrum.from_table(q, spectrum()(q) * remains(q, pressure, hardness, extent))
    return float(leak.RoughContact(left, effective_modulus=1.0).mean_separation(pressure))


def extent_of_equal_gap(pressure: float, hardness: float) -> float:
    """With which the theory has the mean gap of the capped surface."""
    surface = leak.RoughContact(spectrum(), effective_modulus=1.0, hardness=hardness)
    gap = surface.capped.mean_separation(pressure)
    return float(brentq(lambda extent: theory_gap(pressure, hardness, extent) - gap, 0.0, 1.0, xtol=1e-3))


def numbers(heights: FloatArray, pressure: float, hardness: float | None = None) -> FloatArray:
    """Contact area, mean gap and conductivity by simulation."""
    found = simulate(heights, 1.0, [pressure], effective_modulus=1.0, hardness=hardness)
    return np.array([found.contact_area[0], found.mean_gap[0], found.flow_conductivity(1.0)[0]])


def ratios(pressure: float, hardness: float, extent: float, seeds: tuple[int, ...] = SEEDS) -> FloatArray:
    """`numbers` of the smoothed surfaces over those of the capped ones."""
    q = _WAVE * np.fft.fftfreq(POINTS, 1.0 / POINTS)
    factor = np.sqrt(remains(np.hypot(q[:, None], q), pressure, hardness, extent))
    smooth, capped = np.zeros(3), np.zeros(3)
    for seed in seeds:
        heights = leak.random_map(spectrum(), size=1.0, points=POINTS, seed=seed, amplitudes="exact")
        smooth += numbers(np.fft.ifft2(np.fft.fft2(heights) * factor).real, pressure)
        capped += numbers(heights, pressure, hardness)
    return smooth / capped


def main() -> None:
    print(
        "| H | p/hardness | C_pl: area | mean gap | conductivity | extent | area | mean gap | conductivity |"
    )
    print("|" + 9 * "---|")
    for hardness in HARDNESSES:
        for pressure in PRESSURES:
            extent = extent_of_equal_gap(pressure, hardness)
            area, gap, flow = ratios(pressure, hardness, 1.0)
            row = f"| {hardness} | {pressure / hardness:g} | {area:.2f} | {gap:.2f} | {flow:.2g} | {extent:.2f} |"
            area, gap, flow = ratios(pressure, hardness, extent)
            print(f"{row} {area:.2f} | {gap:.2f} | {flow:.2f} |", flush=True)


if __name__ == "__main__":
    main()
