"""Constants of `leak.theory.own_error`, from direct simulations of isotropic elastic surfaces.

Run: python docs/research/own_error_fit.py   (prints them, and how they meet the rows held out)

How far the means of the spectra are from the theory, beyond what so few surfaces scatter, gives its bias and spread;
how far single surfaces are from it, beyond that, gives what a finite sample does. Both by maximum likelihood.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np
from direct_elastic_campaign import LOW_LOAD_FILE, held_out
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar

import leak
from leak.theory.own_error import closing_ratio, flow_error

FloatArray = NDArray[np.float64]
REFERENCE = Path(__file__).resolve().parents[2] / "tests" / "reference"
# ln k is larger on endlessly fine grids than on four points per shortest wave, by so much and so much per X: patches
# of three spectra on 4, 8 and 16 points; half of it, which varies with the spectrum, goes into the spread.
GRID = (0.03, 0.08)
# Nearly sealed patches of so few waves differ by decades.
HIGHEST = 0.1
# Up to here few summits touch, and what a sample lacks of them is known.
FEW_TOUCH = 0.1


@lru_cache(maxsize=64)
def surface(hurst: float, rolloff: float, cutoff: float) -> leak.RoughContact:
    """Of the spectrum of waves on a lattice, unit side, height and modulus; its empty cell has radius 0.5642."""
    q = 2.0 * np.pi
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.0, hurst=hurst, q_low=0.5642 * q, q_rolloff=rolloff * q, q_high=cutoff * q
    )
    return leak.RoughContact(spectrum, effective_modulus=1.0, theory="corrected")


def low_load_rows() -> list[dict[str, float]]:
    """Rows to `HIGHEST` with ln(direct/theory), as it is and with the heights that the patch lacks made up for."""
    with LOW_LOAD_FILE.open(encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    rows = [row for row in rows if row["p_over_Eh"] <= HIGHEST]
    for row in rows:
        contact = surface(row["hurst"], row["rolloff_waves"], row["cutoff_waves"])
        p = row["p_over_Eh"] * contact.spectrum.rms_slope
        flow = 0.5 * (row["periodic_conductivity_along"] + row["periodic_conductivity_across"])
        row["area"] = float(contact.corrected_contact_area(p))
        finer = GRID[0] + GRID[1] * float(closing_ratio(row["area"]))
        row["error"] = float(np.log(flow) - 3.0 * np.log(contact.effective_separation(p))) + finer
        lacking = row["excess_height_over_hrms"] if row["contact_area"] < FEW_TOUCH else 0.0
        row["mended"] = row["error"] + 3.0 * float(np.log1p(-lacking / row["mean_gap_over_hrms"]))
    return rows


def groups(rows: list[dict[str, float]]) -> list[list[dict[str, float]]]:
    """Surfaces of one spectrum at one pressure."""
    found: dict[tuple[float, ...], list[dict[str, float]]] = {}
    for row in rows:
        key = tuple(row[name] for name in ("hurst", "rolloff_waves", "cutoff_waves", "p_over_Eh"))
        found.setdefault(key, []).append(row)
    return list(found.values())


class Mean(NamedTuple):
    """Mean error of the surfaces of a spectrum at one pressure, mended."""

    error: float
    surfaces: float
    rolloff: float
    pressure: float
    X: float


def means(parts: list[list[dict[str, float]]]) -> Iterator[Mean]:
    """Of low-load rows, and of those of `gap_direct.csv`, whose flow is brought to the mean gap of more surfaces."""
    for part in parts:
        first = part[0]
        error = float(np.mean([row["mended"] for row in part]))
        yield Mean(
            error, len(part), first["rolloff_waves"], first["p_over_Eh"], float(closing_ratio(first["area"]))
        )
    with (REFERENCE / "gap_direct.csv").open(encoding="utf-8") as file:
        rows = [{name: float(value or "nan") for name, value in row.items()} for row in csv.DictReader(file)]
    for row in rows:
        if not np.isfinite(row["conductivity_over_hrms3"]) or row["p_over_Eh"] > HIGHEST:
            continue
        rolloff = row["rolloff_waves"]
        contact = surface(row["hurst"], rolloff, rolloff * row["cutoff_over_rolloff"])
        p = row["p_over_Eh"] * contact.spectrum.rms_slope
        direct = row["conductivity_over_hrms3"] * (row["mean_gap_over_hrms"] / row["gap_of_flow_seeds"]) ** 3
        X = float(closing_ratio(contact.corrected_contact_area(p)))
        error = float(np.log(direct) - 3.0 * np.log(contact.effective_separation(p))) + GRID[0] + GRID[1] * X
        yield Mean(error, row["seeds_flow"], rolloff, row["p_over_Eh"], X)


def sampling(
    share: FloatArray, squares: FloatArray, freedoms: FloatArray, X: FloatArray, p: FloatArray
) -> FloatArray:
    """Standard deviation of one wave, always, per (p/(E* h'))^(-1/4) and per X.

    Parameters
    ----------
    share : ndarray
        Variance that does not fall with the waves, over that of one wave's, see `squares`.
    squares : ndarray
        Observed variance times the waves of a patch.
    freedoms : ndarray
        Of each variance.
    X, p : ndarray
        Closing and p/(E* h').
    """

    def unlikely(log_constants: FloatArray) -> float:
        always, summits, channels = np.exp(2.0 * log_constants)
        model = share + always + summits * p**-0.5 + channels * X**2
        return float(np.sum(freedoms * (np.log(model) + squares / model)))

    return np.asarray(np.exp(minimize(unlikely, np.log([0.3, 0.1, 0.5]), method="Nelder-Mead").x))


def theory_error(
    parts: list[list[dict[str, float]]],
) -> tuple[float, float, float, float]:
    """Bias and spread where open, and per X; how far few surfaces are from the mean of many, from their scatter."""
    always, summits, channels = sampling(
        *np.array(
            [
                (
                    0.0,
                    np.var([row["mended"] for row in part], ddof=1) * part[0]["rolloff_waves"] ** 2,
                    len(part) - 1,
                    closing_ratio(part[0]["area"]),
                    part[0]["p_over_Eh"],
                )
                for part in parts
                if len(part) > 1
            ]
        ).T
    )
    mean, surfaces, rolloff, p, X = np.array(list(means(parts))).T
    sample = (always**2 + summits**2 * p**-0.5 + (channels * X) ** 2) / (rolloff**2 * surfaces)

    def unlikely(constants: FloatArray) -> float:
        bias, closing_bias, spread, closing_spread = constants
        variance = spread**2 + (closing_spread * X) ** 2 + sample
        return float(np.sum(np.log(variance) + (mean - bias - closing_bias * X) ** 2 / variance))

    found = minimize(unlikely, [0.05, -0.3, 0.03, 0.1], method="Nelder-Mead", options={"maxiter": 4000}).x
    spread, closing_spread = np.hypot(found[2:], 0.5 * np.array(GRID))
    return float(found[0]), float(found[1]), float(spread), float(closing_spread)


def correlations(rows: list[dict[str, float]]) -> list[tuple[float, float, int]]:
    """Decades between two pressures, correlation of a surface's standardised errors there, pairs that show it."""
    surfaces: dict[tuple[float, ...], list[tuple[float, float]]] = {}
    for row in rows:
        error = flow_error(row["p_over_Eh"], row["area"], waves=row["rolloff_waves"] ** 2)
        one = tuple(row[name] for name in ("hurst", "rolloff_waves", "cutoff_waves", "seed"))
        away = (row["error"] - float(error.bias)) / float(error.spread)
        surfaces.setdefault(one, []).append((row["p_over_Eh"], away))
    pairs: dict[float, list[tuple[float, float]]] = {}
    for errors in surfaces.values():
        for (p, one), (other_p, other) in combinations(sorted(errors), 2):
            pairs.setdefault(round(2.0 * np.log10(other_p / p)) / 2.0, []).append((one, other))
    return [(d, float(np.corrcoef(np.array(both).T)[0, 1]), len(both)) for d, both in sorted(pairs.items())]


def belong_together(rows: list[dict[str, float]]) -> float:
    """Decades d_0 of exp(-d^2/(2 d_0^2)), least squares over the correlations at half a decade and more."""
    d, found, count = np.array([one for one in correlations(rows) if one[0] > 0.0]).T
    off = minimize_scalar(
        lambda d_0: float(count @ (found - np.exp(-0.5 * (d / d_0) ** 2)) ** 2),
        bounds=(0.1, 3.0),
        method="bounded",
    )
    return float(off.x)


def main() -> None:
    """Print the constants, and rms of the standardised error and coverage of 90 % intervals of both sets."""
    rows = low_load_rows()
    fitted = [row for row in rows if not held_out(row["rolloff_waves"], row["cutoff_waves"])]
    bias, closing_bias, spread, closing_spread = theory_error(groups(fitted))
    print(f"OPEN_BIAS, CLOSING_BIAS = {bias:.2g}, {closing_bias:.2g}")
    print(f"OPEN_SPREAD, CLOSING_SPREAD = {spread:.2g}, {closing_spread:.2g}")
    error, area, waves, p = np.array(
        [(row["error"], row["area"], row["rolloff_waves"] ** 2, row["p_over_Eh"]) for row in fitted]
    ).T
    X = closing_ratio(area)
    theory = (spread**2 + (closing_spread * X) ** 2) * waves
    constants = sampling(theory, (error - bias - closing_bias * X) ** 2 * waves, np.ones_like(p), X, p)
    print(f"BELONG_TOGETHER = {belong_together(rows):.2g}")
    print("LONG_WAVES, SUMMITS, CHANNELS =", *(f"{constant:.2g}" for constant in constants))
    for name in ("fitted", "held out"):
        part = [
            row for row in rows if held_out(row["rolloff_waves"], row["cutoff_waves"]) == (name != "fitted")
        ]
        found = np.array(
            [
                (row["error"] - error.bias) / error.spread
                for row in part
                for error in [flow_error(row["p_over_Eh"], row["area"], waves=row["rolloff_waves"] ** 2)]
            ]
        )
        print(
            f"{name}: rms {np.sqrt(np.mean(found**2)):.2f}, mean {found.mean():.2f}, "
            f"within {np.mean(np.abs(found) < 1.645):.0%} of {len(found)}"
        )


if __name__ == "__main__":
    main()
