"""Conductance of pressed maps by direct simulation: heat through spots and gap, writes joint_conductance.csv.

Run: python docs/research/joint_conductance.py, some 20 minutes on one core; with "metal" it prints the theories beside
the curves that measured joints of steel and nickel follow, some 5 minutes. Periodic maps of rms slope one on a
half-space of E* = 1, elastic or flowing by von Mises' criterion, are pressed along a path of loading and unloading; the
harmonic mean of both conductivities is one. Means over the maps.
"""

from __future__ import annotations

import csv
import math
import sys
from itertools import product
from pathlib import Path

import numpy as np
from scipy.special import erfcinv

import leak
from leak.direct import PeriodicHalfSpace, patch_conductance, press, press_elastoplastic

POINTS, SEEDS, NU = 128, range(4), 0.3
SHARES, STEP = (0.05, 0.1, 0.2), 0.025
ELASTIC_PRESSURES, HARDNESSES = (0.003, 0.01, 0.03, 0.06), (0.05, 0.1, 0.3)
# k_f/k and M over h_rms: two gases, and a liquid
FLUIDS = {"gas_wide": (0.01, 0.3), "gas_dense": (0.01, 0.03), "liquid": (0.04, 0.0)}
SPECTRUM = leak.PowerSpectrum.self_affine(
    rms_height=1.0, hurst=0.8, q_low=2 * math.pi, q_rolloff=8 * math.pi, q_high=32 * math.pi
)
SPECTRUM = SPECTRUM.scaled(1.0 / SPECTRUM.rms_slope)


def conductances(pressure: np.ndarray, gap: np.ndarray) -> list[float]:
    """Of the spots, and of the joint with each of the fluids."""
    gap = np.where(pressure > 0.0, 0.0, np.maximum(gap, np.finfo(float).tiny))
    return [
        patch_conductance(gap, 1.0, 1.0, fluid_conductivity=k, jump=M * SPECTRUM.rms_height)
        for k, M in ((0.0, 0.0), *FLUIDS.values())
    ]


def rows() -> list[dict[str, float | str]]:
    """Means over the maps."""
    body, found = (
        PeriodicHalfSpace(POINTS, 1.0, 1.0),
        dict[tuple[str, float, float, float], list[list[float]]](),
    )
    for seed in SEEDS:
        heights = leak.random_map(SPECTRUM, size=1.0, points=POINTS, seed=seed, amplitudes="exact")
        for p in ELASTIC_PRESSURES:
            state = press(body, heights, p, tolerance=1e-6)
            values = [float((state.pressure > 0).mean()), float(state.gap.mean())]
            found.setdefault(("elastic", math.inf, p, p), []).append(
                values + conductances(state.pressure, state.gap)
            )
        for H in HARDNESSES:
            loading = H * STEP * np.arange(1, round(SHARES[-1] / STEP) + 1)
            back = H * SHARES[-1] * np.array([0.975, 0.5, 0.1])
            path = np.concatenate([loading, back])
            states = press_elastoplastic(body, heights, path, yield_stress=H / 2.9, poissons_ratio=NU)
            for p, largest, plastic in zip(path, np.maximum.accumulate(path), states, strict=True):
                values = [plastic.contact_area, float(plastic.gap.mean())]
                found.setdefault(("von-mises", H, p, largest), []).append(
                    values + conductances(plastic.pressure, plastic.gap)
                )
    return [
        {
            **dict(zip(("model", "hardness", "pressure", "largest_pressure"), key, strict=True)),
            **dict(zip(("area", "gap", "spots", *FLUIDS), np.mean(values, axis=0).tolist(), strict=True)),
            "spots_scatter": float(np.std([value[2] for value in values], ddof=1)),
        }
        for key, values in found.items()
    ]


# Conductivity [W/(m K)], E* on a like metal and hardness [Pa].
METALS = {"304": (16.2, 110e9, 3.5e9), "nickel 200": (70.0, 111e9, 2.5e9)}
THEORIES = {"corrected": ("corrected", ""), "C_pl": ("paper", "conserved"), "capped": ("paper", "capped")}
LOADS = np.array([1e-4, 1e-3, 1e-2])


def gaussian_gap(separation: float, height: float, jump: float) -> float:
    """Int phi(t)/(Y - sigma t + M) dt over Gaussian heights below the separation (Yovanovich) [1/m]."""
    t = np.linspace(-8.0, separation / height, 20001)
    values = np.exp(-0.5 * t**2) / (math.sqrt(2 * math.pi) * (separation - height * t + jump))
    return float(np.trapezoid(values, t))


def measured_metal(theory: str) -> list[np.ndarray]:
    """Mean gap over Y, spots over Yovanovich's, and the gap's conductance in three gases over both of his formulas."""
    found = []
    choices = product(METALS.values(), (2e-6, 10e-6), (0.6, 0.9), (4.0, 20.0, 100.0), (0.1, 0.2))
    for (k, modulus, hardness), height, hurst, cutoff, slope in choices:
        shape = leak.PowerSpectrum.self_affine(
            rms_height=height, hurst=hurst, q_low=0.25, q_rolloff=1.0, q_high=cutoff
        )
        # of a Gaussian profile the mean absolute slope is the rms slope of the surface over sqrt(pi)
        q = slope * math.sqrt(math.pi) / shape.rms_slope
        spectrum = leak.PowerSpectrum(q * shape.wavenumber, shape.density / q**2)
        kind, yielding = THEORIES[theory]
        face = leak.RoughContact(
            spectrum, effective_modulus=modulus, hardness=hardness, theory=kind, yielding=yielding
        )
        P, Y = LOADS * hardness, math.sqrt(2.0) * height * erfcinv(2.0 * LOADS)
        spots = leak.joint_conductance(face, P, k)
        row = [face.mean_separation(P) / Y, spots / (1.25 * k * slope / height * LOADS**0.95)]
        for gas in ("helium", "argon", "nitrogen"):
            fluid = leak.GapFluid.of(gas, 293.15)
            M, k_f = float(fluid.jump_length(101325.0)), fluid.conductivity
            gap = leak.joint_conductance(face, P, k, fluid, fluid_pressure=101325.0) - spots
            row += [gap / k_f / [gaussian_gap(y, height, M) for y in Y], gap / k_f * (Y + M)]
        found.append(np.array(row))
    return found


if __name__ == "__main__" and sys.argv[1:] == ["metal"]:
    for name in THEORIES:
        values = np.array(measured_metal(name))
        names = [
            "gap",
            "spots",
            *(f"{gas}, {over}" for gas in ("He", "Ar", "N2") for over in ("Gauss", "Y + M")),
        ]
        for number, what in enumerate(names):
            low, high = values[:, number].min(), values[:, number].max()
            print(f"{name:10} {what:12} {low:.2f} to {high:.2f}")
elif __name__ == "__main__":
    table = rows()
    with (Path(__file__).with_suffix(".csv")).open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        for row in table:
            writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})
