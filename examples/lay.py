"""The same roughness leaks less when its lay runs along the circumference, and more when it crosses the seal.

The seat of Fischer et al. (2020) at 20 bar, a Gaussian pressure profile of 0.139 mm standard deviation, with
its roughness stretched fivefold: a seat ground around (lay across the flow), a sandblasted one (isotropic), and
scratches from one side of the seal to the other. Contact area and mean gap are the same in all three.
"""

from __future__ import annotations

import numpy as np

import leak


def leak_rates(stretches: tuple[float, ...]) -> list[float]:
    """Leak rate for each Tripp number, correlation length along the flow over across [m^3/s]."""
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.14159e6
    )
    line = leak.gaussian_line(line_load=20e3, radius=20e-3, u0=0.139e-3**2 / 20e-3)
    x = np.linspace(-4, 4, 201) * line.std
    viscosity = leak.liquid("water").viscosity
    rates = []
    for stretch in stretches:
        surface = leak.RoughContact(spectrum, effective_modulus=115.38e9, hardness=3.5e9, peklenik=stretch)
        sigma = surface.conductivity_table(1e3, 1e8).at(viscosity)
        rates.append(leak.leak_rate(x, line.pressure(x), sigma, pressure_drop=20e5, radius=14.142e-3))
    return rates


def main() -> float:
    """Leak rate of the scratched seat over that of the ground one."""
    ground, scratched = leak_rates((0.2, 5.0))
    return scratched / ground


if __name__ == "__main__":
    import matplotlib.pyplot as plt

    names, rates = ("ground", "sandblasted", "scratched"), leak_rates((0.2, 1.0, 5.0))
    for name, rate in zip(names, rates, strict=True):
        print(f"{name:12s} {rate * 1e9:6.0f} mm^3/s")
    plt.figure(figsize=(6, 3), layout="constrained")
    plt.bar(names, [rate * 1e9 for rate in rates], width=0.5)
    plt.ylabel("leak rate [mm³/s]")
    plt.show()
