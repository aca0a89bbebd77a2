"""Published benchmarks, each found once more: the page `docs/verification/published.md`.

    python benchmarks/published/published.py             the page from found.csv
    python benchmarks/published/published.py --measure   find all numbers once more, in some minutes

`sources.toml` has the published numbers and why ours differ, `found.csv` what is found; cases are the files beside.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import csv
import sys
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import punch_elements
import slip_lines
from scipy.special import erf

import fem_seal
import leak
from leak.direct import PeriodicHalfSpace, press, press_elastoplastic
from leak.flow.rarefied import poiseuille_flow_rate

HERE = Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "docs" / "verification" / "published.md"
FOUND = HERE / "found.csv"
Numbers = dict[str, float]


@dataclass(frozen=True)
class Row:
    """One published number and what is found for it."""

    what: str
    found: float
    published: float
    differs: float
    why: str

    @property
    def difference(self) -> float:
        """Relative."""
        return self.found / self.published - 1.0

    @property
    def is_explained(self) -> bool:
        """Whether the difference is no larger than the source, or what is said of it, allows."""
        return abs(self.difference) <= self.differs


def sources() -> dict[str, Any]:
    """Benchmarks by name, with their published numbers."""
    return tomllib.loads((HERE / "sources.toml").read_text(encoding="utf-8"))


def rows(name: str, found: Mapping[str, float]) -> list[Row]:
    """All numbers of a benchmark."""
    return [Row(**{**row, "found": found[row["found"]]}) for row in sources()[name]["rows"]]


def nafems_1() -> Numbers:
    case = fem_seal.load_case(HERE / "nafems_1.toml")
    force = case.load.applied_force
    profiles = [
        fem_seal.run(case.replace({"load.applied_force": part * force})).loads[0].contact.profile
        for part in (1.0, 0.1)
    ]
    # of Hertz's ellipse
    half_width = profiles[0].fwhm / np.sqrt(3.0)
    return {
        "peak": profiles[0].peak_pressure / 1e6,
        "peak of a tenth": profiles[1].peak_pressure / 1e6,
        "half-width": half_width * 1e3,
    }


def nafems_2() -> Numbers:
    (load,) = fem_seal.run(HERE / "nafems_2.toml").loads
    contact, field = load.contact, load.contact.fields["seat"]
    innermost = field.contact_nodes[np.argmin(field.points[field.contact_nodes, 0])]
    area = contact.model.line.area_weight
    middle = np.cumsum(area) < np.pi * 10e-3**2
    return {
        "settlement": -field.displacement[innermost, 1] * 1e3,
        "middle": contact.point_forces[middle].sum() / area[middle].sum() / 1e6,
        "coarse settlement": -punch_elements.settlement(5.0)[0],
    }


def knudsen() -> Numbers:
    D = np.geomspace(0.1, 10.0, 4001)
    Q = poiseuille_flow_rate(D)
    few, more = poiseuille_flow_rate([0.01, 0.02])
    return {
        "minimum": Q.min(),
        "place of the minimum": D[Q.argmin()],
        "slip": poiseuille_flow_rate(1e3) - 1e3 / 6.0,
        "continuum": 6.0 * poiseuille_flow_rate(1e5) / 1e5,
        "rise": (few - more) / np.log(2.0),
    }


def wedge() -> Numbers:
    def hardness(angle: int) -> float:
        case = fem_seal.load_case(HERE / f"wedge_{angle}.toml")
        contact = fem_seal.run(case).loads[0].contact
        line, touches = contact.model.line, contact.pressure > 0.0
        area = 2.0 * np.pi * case.contact.initial_contact_radius * line.arc_weight[touches].sum()
        return contact.contact_force / area / 200e6

    steep, blunt = hardness(80), hardness(85)
    return {"80 deg": steep, "85 deg": blunt, "flat": 2.0 * blunt - steep}


def limit_loads() -> Numbers:
    """With the difference that is left at half the size of the elements, which is in proportion to it, taken off.

    Metal that slips along a line is held up by the elements on it. How the surface flows is that of the finer ones.
    """
    wedges = {f"pressed {angle}": slip_lines.pressed(np.radians(angle)) for angle in (15, 30, 45, 60)}
    wedges |= {f"crushed {angle}": slip_lines.crushed(np.radians(angle)) for angle in (30, 45, 60)}
    cut = {"cut 60": slip_lines.crushed(np.radians(60), fan=np.radians(60))}
    found: Numbers = {}
    for name, wedge in (wedges | cut).items():
        coarse, fine = (slip_lines.limit_pressure(wedge, finer) for finer in (1.0, 2.0))
        found |= {name: 2.0 * fine - coarse, f"{name}, fine": fine, f"{name}, coarse": coarse}
    flows = {name: slip_lines.flow(wedge, 2.0, found[f"{name}, fine"]) for name, wedge in wedges.items()}
    lips = [flows[name].middle / wedge.growth for name, wedge in wedges.items()]
    # beyond the corner, which no mesh keeps sharp
    rest = max(float(np.abs(flow.rest[flow.rest[:, 0] > 0.05, 1]).max()) for flow in flows.values())
    return found | {"slowest lip": min(lips), "fastest lip": max(lips), "rest": rest}


def sphere() -> Numbers:
    n, radius, yield_stress, widest = 64, 4.0, 5e-5, 0.14
    x = np.arange(n) / n - 0.5
    heights = -(x[:, None] ** 2 + x[None, :] ** 2) / (2.0 * radius)
    forces = np.pi * widest**2 * 2.85 * yield_stress * np.linspace(1 / 12, 1.0, 12)
    states = press_elastoplastic(
        PeriodicHalfSpace(n, 1.0, 1.0), heights, forces, yield_stress=yield_stress, tolerance=3e-4, layers=24
    )[-4:]
    # of the middle below the corner, where the surface is that of the block at rest
    depths = [float(np.ptp((one.gap + heights)[[0, n // 2], [0, n // 2]])) for one in states]
    hardness = [one.pressure.mean() / one.contact_area / yield_stress for one in states]
    # the last steps, over which a contact on a grid grows in leaps
    factor = np.mean(forces[-4:] / (2.0 * np.pi * radius * yield_stress * np.array(depths)))
    return {
        "force": factor * 0.5 * 50e6 * 20e-3 / 1e6,
        "hardness": np.mean(hardness),
        "raised": factor / np.mean(hardness),
    }


def challenge() -> Numbers:
    n, wave, pressure = 512, 2.0 * np.pi, 0.01
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.0, hurst=0.8, q_low=0.99 * wave, q_rolloff=5 * wave, q_high=64.01 * wave
    )
    slope, body = spectrum.rms_slope, PeriodicHalfSpace(n, 1.0, 1.0)
    shares = []
    for seed in range(8):
        heights = leak.random_map(spectrum, size=1.0, points=n, seed=seed, amplitudes="exact") / slope
        touches = press(body, heights, pressure, tolerance=1e-4).pressure > 0.0
        edges = sum(np.count_nonzero(touches != np.roll(touches, 1, axis)) for axis in (0, 1))
        # Yastrebov, Anciaux and Molinari (2017): a grid counts too much along the edges
        shares.append((np.count_nonzero(touches) - (np.pi - 1.0 + np.log(2.0)) / 24.0 * edges) / n**2)
    return {"area": np.mean(shares), "theory": erf(np.sqrt(2.0) * pressure)}


MEASURES: dict[str, Callable[[], Numbers]] = {
    "nafems_1": nafems_1,
    "nafems_2": nafems_2,
    "limit_loads": limit_loads,
    "wedge": wedge,
    "knudsen": knudsen,
    "sphere": sphere,
    "challenge": challenge,
}


def read() -> dict[str, Numbers]:
    """What was found, by benchmark."""
    found: dict[str, Numbers] = {name: {} for name in MEASURES}
    with FOUND.open(encoding="utf-8") as file:
        for name, what, value in csv.reader(file):
            found[name][what] = float(value)
    return found


def write(found: Mapping[str, Numbers]) -> None:
    """Keep what was found."""
    with FOUND.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerows(
            (name, what, f"{v:.6g}") for name, numbers in found.items() for what, v in numbers.items()
        )


def page(found: Mapping[str, Numbers]) -> str:
    """The page as Markdown."""
    parts = [
        "# Published benchmarks",
        "Written by `benchmarks/published/published.py`. What others publish, what is found here, and where the two "
        "differ, which is right. Cases: `benchmarks/published/`; the tests find the numbers once more.",
    ]
    for name, source in sources().items():
        table = "\n".join(
            f"| {row.what} | {row.found:.5g} | {row.published:g} | {100 * row.difference:+.2g} % | {row.why} |"
            for row in rows(name, found[name])
        )
        head = "| | found | published | difference | why |\n|---|---|---|---|---|"
        parts += [f"## {source['title']}", source["text"], f"{head}\n{table}", f"Source: {source['source']}."]
    return "\n\n".join(parts) + "\n"


def main(*arguments: str) -> None:
    if "--measure" in arguments:
        write({name: measure() for name, measure in MEASURES.items()})
    PAGE.write_text(page(read()), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
