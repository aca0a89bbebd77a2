"""Direct simulation beside the table of another one.

Run: python benchmarks/direct_reference.py tests/reference/plastic_direct.csv [points [samples]]

Own surfaces with the table's spectrum P5 (Hurst 0.8, roll-off at 8 and cutoff at 64 waves per side); 512 points and
three samples take some six minutes on one core.
"""

from __future__ import annotations

import csv
import sys
import time

import numpy as np

import leak

Row = dict[str, str]


def surface(points: int, seed: int) -> np.ndarray:
    """Map of rms slope one on the unit square."""
    q = 2.0 * np.pi
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.0, hurst=0.8, q_low=0.9 * q, q_rolloff=8 * q, q_high=64.000001 * q
    )
    h = leak.random_map(spectrum, size=1.0, points=points, seed=seed, amplitudes="exact")
    wave = q * np.fft.fftfreq(points, 1.0 / points)
    power = np.abs(np.fft.fft2(h) / points**2) ** 2
    return h / np.sqrt(np.sum(power * (wave[:, None] ** 2 + wave[None, :] ** 2)))


def columns(branch: leak.direct.DirectBranch, h_rms: float) -> np.ndarray:
    sigma = 12.0 * branch.flow_conductivity(1.0) / h_rms**3
    return np.array([branch.contact_area, branch.yielded_area, branch.mean_gap / h_rms, np.log(sigma)])


def compare(load: list[Row], unload: list[Row], points: int, samples: int) -> None:
    H = float(load[0]["hardness_over_Eh"]) if load[0]["hardness_over_Eh"] else None
    tables = []
    for seed in range(samples):
        h = surface(points, seed)
        result = leak.direct.simulate(
            h,
            1.0,
            [float(row["p_over_Eh"]) for row in load],
            effective_modulus=1.0,
            hardness=H,
            unload=[float(row["p_over_Eh"]) for row in unload] or None,
        )
        branches = [result, *([result.unloaded] if result.unloaded is not None else [])]
        tables.append(np.concatenate([columns(branch, h.std()) for branch in branches], axis=1))
    mean, scatter = np.mean(tables, axis=0), np.std(tables, axis=0, ddof=min(1, samples - 1))
    for n, row in enumerate([*load, *unload]):
        area, gap, sigma = (float(row[key]) for key in ("contact_area", "mean_gap_over_hrms", "conductivity"))
        print(
            f"H {row['hardness_over_Eh'] or '-':>5} {row['branch']:6} p {row['p_over_Eh']:>7} of "
            f"{row['p_max_over_Eh']:>7}: area {mean[0, n]:.4f} ({mean[0, n] / area - 1:+.1%}), "
            f"gap {mean[2, n]:.4f} ({mean[2, n] / gap - 1:+.1%}), "
            f"conductivity {np.exp(mean[3, n]):.4g} (factor {np.exp(mean[3, n]) / sigma:.3f}, scatter of ln "
            f"{scatter[3, n]:.3f}, there {row['conductivity_log_scatter']})",
            flush=True,
        )


def main(file: str, points: int = 512, samples: int = 3) -> None:
    with open(file, encoding="utf-8") as table:
        rows = [row for row in csv.DictReader(table) if row["set"] == "P5"]
    start = time.process_time()
    for H in sorted({row["hardness_over_Eh"] for row in rows}):
        mine = [row for row in rows if row["hardness_over_Eh"] == H]
        load = [row for row in mine if row["branch"] == "load"]
        largest_pressures = {row["p_max_over_Eh"] for row in mine if row["branch"] == "unload"}
        for largest in sorted(largest_pressures, key=float):
            unload = [row for row in mine if row["branch"] == "unload" and row["p_max_over_Eh"] == largest]
            compare([row for row in load if row["p_over_Eh"] == largest], unload, points, samples)
        compare([row for row in load if row["p_over_Eh"] not in largest_pressures], [], points, samples)
    print(f"{time.process_time() - start:.0f} s of processor time")


if __name__ == "__main__":
    main(sys.argv[1], *(int(argument) for argument in sys.argv[2:]))
