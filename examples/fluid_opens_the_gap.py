"""How much more leaks when the fluid in the gap carries part of the load, and when it blows the seal open.

A uniform contact of 40 MPa over 0.3 mm on the surface of Fischer et al. (2020), with rising fluid pressure. In
closed form Q = (2 pi r/W) times the integral of sigma_eff from p - Delta P to p: the script checks itself
against the Gauss-Legendre sum of that integral.
"""

from __future__ import annotations

import math

import numpy as np

import leak

PRESSURE, WIDTH, RADIUS = 40e6, 0.3e-3, 14.142e-3


def conductivity() -> leak.Conductivity:
    """Water between a smooth steel ball and the rough seat."""
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.14159e6
    )
    surface = leak.RoughContact(spectrum, effective_modulus=115.38e9, hardness=3.5e9)
    return surface.conductivity_table(1e2, 1e8).at(leak.liquid("water").viscosity)


def flow(fluid_pressure: float) -> leak.CoupledLeakResult:
    """Flow through the contact at one fluid pressure [Pa]."""
    x = np.array([0.0, 0.5, 1.0]) * WIDTH
    return leak.coupled_leak_flow(x, [PRESSURE] * 3, conductivity(), fluid_pressure, RADIUS)


def main() -> float:
    """Leak rate at 30 MPa over its closed form."""
    drop = 30e6
    nodes, weights = np.polynomial.legendre.leggauss(40)
    w = PRESSURE - 0.5 * drop * (1 + nodes)
    integral = 0.5 * drop * float(weights @ np.asarray(conductivity()(w)))
    return flow(drop).leak_rate / (2 * math.pi * RADIUS / WIDTH * integral)


if __name__ == "__main__":
    import matplotlib.pyplot as plt

    drops, factors = [share * PRESSURE for share in (0.01, 0.1, 0.3, 0.6, 0.9, 0.99)], []
    for drop in drops:
        uncoupled = leak.leak_rate([0, WIDTH / 2, WIDTH], [PRESSURE] * 3, conductivity(), drop, RADIUS)
        factors.append(flow(drop).leak_rate / uncoupled)
        print(f"{drop / 1e5:5.0f} bar  {factors[-1]:6.3f} times the uncoupled leak rate")
    plt.figure(figsize=(6, 3), layout="constrained")
    plt.plot([drop / 1e5 for drop in drops], factors, "o-")
    plt.xlabel("fluid pressure [bar]")
    plt.ylabel("leak rate over the uncoupled one")
    plt.show()
    print(f"blown open from {flow(1e6).blow_off_pressure / 1e5:.0f} bar on")
