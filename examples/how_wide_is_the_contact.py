"""Roughness widens the contact of a metal seal and lowers its pressure.

The same ball and seat with smooth and with rough surfaces at 20 bar. In between, closed forms: Hertz for
smooth bodies, and for the exponential law the exact crossover, whose variance is the sum of the Gaussian and
the Hertzian one.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import fem_seal
import leak


def closed_forms() -> tuple[leak.HertzLine, leak.CrossoverLine]:
    """Smooth and rough contact at 20 bar."""
    case = fem_seal.load_case(Path(__file__).with_name("ball_cone.toml"))
    rough = case.replace({"load.fluid_pressure": "20 bar"}, interface={"law": "exponential", "gamma": 0.4})
    load = fem_seal.derive(rough).loads[0]
    return load.hertz, load.crossover


def main() -> float:
    """Ratio of the peak pressures of rough and smooth contact at 20 bar, in closed form."""
    smooth, rough = closed_forms()
    return rough.peak_pressure / smooth.peak_pressure


if __name__ == "__main__":
    import matplotlib.pyplot as plt

    print(f"roughness lowers the peak pressure to {main():.3f} of that of smooth bodies")
    x = np.linspace(-0.6e-3, 0.6e-3, 241)
    plt.figure(figsize=(6, 3), layout="constrained")
    for name, line in zip(("smooth (Hertz)", "rough"), closed_forms(), strict=True):
        plt.plot(x * 1e3, line.pressure(x) / 1e6, label=name)
    plt.xlabel("x [mm]")
    plt.ylabel("contact pressure [MPa]")
    plt.legend()
    plt.show()
