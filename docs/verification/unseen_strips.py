"""Write docs/verification/unseen_strips.md: printed intervals beside strips of seals that no fit has seen.

Run: python docs/verification/unseen_strips.py [number of strips of each]
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import fem_seal
from fem_seal.seal.direct_seal import SealRow
from leak import LeakError

FILE = Path(__file__).with_suffix(".md")
SEED, SEALS, POINTS = 4, 20, 256
# Beyond this contact area under the peak strips of this grid close the last channels.
LARGEST_AREA = 0.2

HEAD = """# Intervals beside strips of unseen seals

Written by `docs/verification/unseen_strips.py`. {seals} seals drawn at random: ball on cone, ball on a spherical seat
and torus on a flat; self-affine spectra, hardness and fluid pressures from 1 to 200 bar, as far as less than {area:g}
of the area touches under the peak. No constant was fitted to them. Half of them are elastic, half yield; strips of
metal that yields are capped at the hardness. {samples} strips of {across} x {along} points each; both hold the waves
that the grid holds. The printed interval is that of the corrected theory with inputs as given; direct is the mean of
the strips over the chain. Inside: between the ends, give or take one standard error of the strips. Waves across: full
width at half maximum over the wavelength that halves the height variance; where it is small, long waves are a doubt
with a factor, which is from twenty other seals. Seals of which a strip does not converge are left out.

"""


def draw_seals() -> Iterator[fem_seal.Case]:
    """Seals at random, without end."""
    random = np.random.default_rng(SEED)

    def between(low: float, high: float) -> float:
        return float(low * (high / low) ** random.random())

    while True:
        shape, pressure, yields = random.integers(3), between(1.0, 200.0), bool(random.integers(2))
        radius, angle = between(4.0, 30.0), random.uniform(30.0, 60.0)
        hardness = between(1.0, 6.0)
        rolloff, hurst = 2.0 * math.pi / between(15e-6, 120e-6), random.uniform(0.4, 0.9)
        slope, cutoff = between(0.03, 0.4), between(8.0, 24.0)
        metal = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": f"{hardness:.3g} GPa"}
        ball = {"shape": "ball", "radius": f"{radius:.3g} mm", "material": metal}
        closure: dict[str, Any] = ball
        if shape == 0:
            seat: dict[str, Any] = {"shape": "cone", "angle": f"{angle:.3g} deg", "material": metal}
        elif shape == 1:
            seat = {"shape": "sphere", "radius": f"{1.3 * radius:.3g} mm", "material": metal}
            seat |= {"bore_radius": f"{0.6 * radius:.3g} mm"}
        else:
            edge = {
                "centre_radius": f"{radius:.3g} mm",
                "radius": f"{between(0.1, 0.9) * radius / 4.0:.3g} mm",
            }
            closure = {"shape": "torus", **edge, "material": metal}
            seat = {"shape": "flat", "material": metal}
        spectrum = {
            "kind": "self-affine",
            "rms_height": "1 um",
            "hurst": round(hurst, 2),
            "q_low": f"{rolloff / between(1.5, 6.0):.4g} 1/m",
            "q_rolloff": f"{rolloff:.4g} 1/m",
            "q_high": f"{cutoff * rolloff:.4g} 1/m",
        }
        case = fem_seal.Case(
            closure=closure,
            seat=seat,
            roughness={"spectrum": spectrum},
            fluid={"name": "water"},
            load={"fluid_pressure": f"{pressure:.3g} bar"},
            leak={"plasticity": yields},
            direct={"points": POINTS, "asperities": "capped" if yields else "elastic"},
        )
        height = slope / case.roughness.spectrum.build().rms_slope  # type: ignore[union-attr]
        yield case.replace({"roughness.spectrum.rms_height": f"{height:.3g} um"})


@dataclass(frozen=True)
class DrawnSeal:
    """One seal: what direct simulation finds over the chain, and the ends that the chain prints over it."""

    case: fem_seal.Case
    row: SealRow
    ends: tuple[float, float]
    waves: float

    @property
    def direct(self) -> float:
        """Mean of the strips over the chain with the same waves."""
        return self.row.leak_rate / self.row.chain_held

    @property
    def error(self) -> float:
        """Its standard error."""
        return self.row.deviation / math.sqrt(len(self.row.leak_rates)) / self.row.chain_held

    @property
    def is_inside(self) -> bool:
        """Whether the interval holds it."""
        return self.ends[0] - self.error <= self.direct <= self.ends[1] + self.error


def compare_seals(samples: int) -> Iterator[DrawnSeal]:
    """The first seals drawn that are open enough."""
    count = 0
    for case in draw_seals():
        if count == SEALS:
            return
        try:
            (load,) = fem_seal.run(case).loads
        except fem_seal.InputError:
            continue
        area = load.rough.surface.contact_area(load.peak_pressure)
        if area > LARGEST_AREA or load.leak.leak_rate <= 0.0:
            continue
        try:
            (row,) = fem_seal.direct_seal(case.replace({"direct.samples": samples}))
        except LeakError as error:
            print(error, flush=True)
            continue
        count += 1
        ends = load.leak_interval
        waves = load.fwhm / load.rough.surface.wavelength_along_flow
        yield DrawnSeal(case, row, (ends[0] / load.leak.leak_rate, ends[1] / load.leak.leak_rate), waves)


def line(seal: DrawnSeal) -> str:
    """A row of the table."""
    case, spectrum = seal.case, seal.case.roughness.spectrum
    ends, word = f"{seal.ends[0]:.2f} to {seal.ends[1]:.2f}", "yes" if seal.is_inside else "**no**"
    return (
        f"| {case.closure.shape} on {case.lower.shape} | {case.load.fluid_pressure[0] / 1e5:.3g} "
        f"| {spectrum.rms_height * 1e6:.3g} | {spectrum.hurst:g} | {2e6 * math.pi / spectrum.q_rolloff:.0f} "
        f"| {seal.waves:.2g} | {seal.row.asperities} | {seal.row.contact_area:.2g} "
        f"| {seal.row.leak_rate * 6e7:.3g} | {seal.direct:.2f} | {seal.error:.2f} | {ends} | {word} |"
    )


COLUMNS = (
    "seal", "bar", "rms height um", "Hurst", "roll-off um", "waves across", "strips", "A/A0 at the centre",
    "ml/min, strips", "direct over chain", "standard error", "printed interval over chain", "inside",
)  # fmt: skip


def main(samples: int) -> None:
    """Simulate and write the page."""
    head = HEAD.format(seals=SEALS, samples=samples, across=2 * POINTS, along=POINTS, area=LARGEST_AREA)
    lines = ["| " + " | ".join(COLUMNS) + " |", "|---" * len(COLUMNS) + "|"]
    hits = 0
    for seal in compare_seals(samples):
        lines.append(line(seal))
        hits += seal.is_inside
        print(lines[-1], flush=True)
    summary = f"\nThe printed interval holds the direct mean in {hits} of {SEALS} seals.\n"
    FILE.write_text(head + "\n".join(lines) + "\n" + summary, encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
