"""Leak rate of a pressure profile that another finite-element code has calculated.

`leak` takes plain arrays in SI: arc length, contact pressure, and the surface they belong to. Here the
profile of Fischer et al. (2020) at 20 bar, a Gaussian of 0.139 mm standard deviation, on their sandblasted
seat. Asperities that yield let the surfaces come closer: the leak rate falls by about 8, as the paper says.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

import leak


def leak_rates(file: Path) -> tuple[float, float]:
    """Leak rate with and without yielding asperities [m^3/s]."""
    x, pressure = np.loadtxt(file, delimiter=",", skiprows=2).T * [[1e-3], [1e6]]
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.14159e6
    )
    surface = leak.RoughContact(spectrum, effective_modulus=115.38e9, hardness=3.5e9)
    water = leak.liquid("water")
    radius = 20e-3 * math.sin(math.radians(45)) + x * math.cos(math.radians(45))
    plastic, elastic = (
        leak.leak_rate(
            x,
            pressure,
            one.conductivity_table(pressure.min(), pressure.max()).at(water.viscosity),
            pressure_drop=20e5,
            radius=radius,
        )
        for one in (surface, surface.elastic)
    )
    return float(plastic), float(elastic)


def main() -> float:
    """Ratio of the leak rates without and with yielding asperities."""
    plastic, elastic = leak_rates(Path(__file__).with_name("profile_from_another_code.csv"))
    return elastic / plastic


if __name__ == "__main__":
    import matplotlib.pyplot as plt

    FILE = Path(__file__).with_name("profile_from_another_code.csv")
    plastic, elastic = leak_rates(FILE)
    print(f"leak rate {plastic * 1e9:.3g} mm^3/s; without yielding asperities {elastic * 1e9:.3g} mm^3/s")
    x, pressure = np.loadtxt(FILE, delimiter=",", skiprows=2).T
    plt.figure(figsize=(6, 3), layout="constrained")
    plt.plot(x, pressure)
    plt.xlabel("x [mm]")
    plt.ylabel("contact pressure [MPa]")
    plt.show()
