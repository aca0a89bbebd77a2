"""Write docs/verification/strips.md: strips of whole seals, simulated, beside the chain.

Run: python docs/verification/strips.py [number of strips of each]
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import fem_seal
from fem_seal.seal.direct_seal import SealRow

FILE = Path(__file__).with_suffix(".md")
EXAMPLES = Path(__file__).parents[2] / "examples"
POINTS = 256
LAPPED = {
    "roughness.spectrum.rms_height": "0.12 um",
    "roughness.spectrum.hurst": 0.8,
    "roughness.spectrum.q_low": "1e4 1/m",
    "roughness.spectrum.q_rolloff": "1e5 1/m",
    "roughness.spectrum.q_high": "2e6 1/m",
    "load.fluid_pressure": "20 bar",
}


def cases() -> Iterator[tuple[str, fem_seal.Case]]:
    """Names and cases, all in the corrected theory."""
    direct = {"leak.theory": "corrected", "direct.points": POINTS}
    ball = fem_seal.load_case(EXAMPLES / "ball_cone.toml").replace(direct)
    yield "the paper's ball on cone", ball.replace({"load.fluid_pressure": ["1 bar", "20 bar"]})
    yield "a lapped ball on cone", ball.replace(LAPPED)
    edge = fem_seal.load_case(EXAMPLES / "toroidal_edge_on_flat.toml").replace(direct)
    yield "a rounded edge of 0.2 mm on a flat", edge
    yield "an oval seat", fem_seal.load_case(EXAMPLES / "oval_seat.toml").replace(direct)


def line(name: str, row: SealRow) -> str:
    """One row of the page's table."""
    place, count = row.place, len(row.leak_rates)
    error = row.deviation / math.sqrt(count) / row.leak_rate if row.leak_rate > 0.0 else math.nan
    cells = (
        f"{name}, {place.fluid_pressure / 1e5:.3g} bar"
        + ("" if place.name == "round" else f", {place.name} side"),
        row.asperities,
        f"{place.line_load / (math.sqrt(2.0 * math.pi) * place.profile.std) / 1e6:.3g}",
        f"{row.measures[0] / 1e6:.3g}",
        f"{2.0 * math.sqrt(2.0 * math.log(2.0)) * place.profile.std * 1e6:.0f}",
        f"{row.measures[1] * 1e6:.0f}",
        f"{row.contact_area:.2g}",
        f"{row.leak_rate * 6e7:.3g}",
        f"{row.chain_held * 6e7:.3g}",
        f"{row.chain_held / row.leak_rate:.2f}" if row.leak_rate > 0.0 else "-",
        f"{error:.2f}",
    )
    return "| " + " | ".join(cells) + " |"


COLUMNS = (
    "seal", "strips", "peak MPa, chain", "strips", "FWHM um, chain", "strips", "A/A0 at the centre", "ml/min, strips",
    "chain", "chain over strips", "standard error",
)  # fmt: skip
HEAD = """# Strips of whole seals

Written by `docs/verification/strips.py`. Strips of the seal itself ([direct simulation](../guide/direct.md)) beside
the chain with `[leak] theory = "corrected"`: {samples} of {across} x {along} points in each row. Both hold the waves
that the grid holds. Elastic strips stand beside the chain without yielding; capped ones, whose pressure stays below
the hardness, beside the chain whose asperities yield by von Mises: metal that flows below the surface gives way less
than a cap on the pressure, and leaks more.

Standard errors are those of the strips, as a share. Pressures and widths are of the Gaussian with the line load and the
standard deviation of the mean pressure. Under low loads a strip rests on few summits, and scatters.

"""


def rows(samples: int) -> Iterator[tuple[str, SealRow]]:
    """Of all cases: elastic strips beside an elastic chain, capped ones beside the case as it stands."""
    for name, case in cases():
        for kind, yields in (("elastic", False), ("capped", True)):
            direct = {"leak.plasticity": yields, "direct.asperities": kind, "direct.samples": samples}
            yield from ((name, row) for row in fem_seal.direct_seal(case.replace(direct)))


def main(samples: int) -> None:
    """Simulate and write the page."""
    head = HEAD.format(samples=samples, across=2 * POINTS, along=POINTS)
    lines = ["| " + " | ".join(COLUMNS) + " |", "|---" * len(COLUMNS) + "|"]
    lines += [line(name, row) for name, row in rows(samples)]
    FILE.write_text(head + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
