"""The page and the picture of the comparison with CalculiX, and the numbers that they show."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from measured_process import Cost

from fem_seal.profile import PressureProfile


@dataclass(frozen=True)
class Accuracy:
    """Relative errors against the exact crossover of a half-space; the largest of all loads, with its sign.

    Parameters
    ----------
    peak : float
        Peak pressure as it stands.
    peak_by_load : float
        Peak pressure over (axial contact force/applied force).
    fwhm, std : float
    force : float
        Axial force of the contact pressure against the applied force.
    typical : float
        Largest of peak_by_load, fwhm and std of a load, the median over the loads.
    """

    peak: float
    peak_by_load: float
    fwhm: float
    std: float
    force: float
    typical: float


@dataclass(frozen=True)
class Side:
    """What one program did at one element size."""

    single: Cost
    sweep: Cost
    accuracy: Accuracy
    profiles: Sequence[PressureProfile]


@dataclass(frozen=True)
class Warm:
    """Processor times of fem-seal inside a process that has done it before [s]."""

    mesh: float
    condense: float
    load: float


@dataclass(frozen=True)
class Row:
    """One element size."""

    size: float
    elements: int
    seal: Side
    warm: Warm
    ccx: Side
    reaction: float

    @property
    def ccx_load(self) -> float:
        """Processor time that CalculiX takes for one more load [s]."""
        return (self.ccx.sweep.processor - self.ccx.single.processor) / (len(self.ccx.profiles) - 1)

    @property
    def peak_difference(self) -> float:
        """Peak pressure of CalculiX, by its load, over that of fem-seal at the highest load, minus one."""
        ours, theirs = (side.profiles[-1] for side in (self.seal, self.ccx))
        return (
            theirs.peak_pressure
            / integrate_pressure(theirs)
            / (ours.peak_pressure / integrate_pressure(ours))
            - 1
        )


@dataclass(frozen=True)
class OtherSeal:
    """A seal beside the ball in the cone: what both programs take, and where they differ."""

    name: str
    seal: Cost
    ccx: Cost
    difference: str


def integrate_pressure(profile: PressureProfile) -> float:
    """int 2 pi r p dx [N], the normal force of a profile."""
    return 2 * np.pi * float(profile.arc_weight @ (profile.radius * profile.pressure))


def write_page(
    file: Path,
    version: str,
    rows: Sequence[Row],
    choices: Iterable[tuple[str, Cost, Accuracy]],
    others: Iterable[OtherSeal],
) -> None:
    """Write the comparison as Markdown; the first row is fem-seal's own element size."""
    highest = rows[0].seal.profiles[-1]
    parts = [
        "# Against CalculiX",
        f"Written by `benchmarks/compare_calculix.py` in one run, CalculiX {version}, {os.cpu_count()} processors "
        f"({platform.machine()}); load of the machine by others at the end of the run: {os.getloadavg()[0]:.1f}.",
        "The case: steel ball of 20 mm in a 45 deg cone, p = p_c exp(-u/u0) with u0 = 0.76 um and p_c = 5 GPa, axial "
        "force of 2 to 20 bar on the sealed area in 10 steps. At 20 bar fem-seal finds "
        f"p0 = {highest.peak_pressure / 1e6:.4f} MPa, FWHM = {highest.fwhm * 1e3:.6f} mm, "
        f"std = {highest.std * 1e3:.6f} mm. Both codes work on the same triangles, graded in the same way from the "
        "element size along the contact line; for CalculiX neighbouring triangles are joined to CAX8R quadrilaterals, "
        "which are its fastest here and as accurate as CAX6 (below), and its contact line is curved.",
        "## Accuracy",
        "Errors against the exact crossover of a half-space, the worst of the 10 loads; the axisymmetric bodies "
        "really differ from it by up to 1e-4. CalculiX's pressure is read at the vertices of the contact line: with "
        "the midside nodes, to which it is extrapolated, all measures are several times worse. It misses the applied "
        'force by the share under "force", though the reaction does not; "p0/force" is the peak '
        'after division by that share. "difference": p0/force of CalculiX against fem-seal at 20 bar.',
        table(
            "element size, triangles, p0, FWHM, std, force, CalculiX p0, p0/force, FWHM, std, force, reaction, "
            "difference",
            (
                (
                    _size(row),
                    row.elements,
                    *(f"{e:+.1e}" for e in _errors(row.seal.accuracy)),
                    f"{row.seal.accuracy.force:+.0e}",
                    f"{row.ccx.accuracy.peak:+.1e}",
                    *(f"{e:+.1e}" for e in _errors(row.ccx.accuracy)),
                    f"{row.ccx.accuracy.force:+.1e}",
                    f"{row.reaction:+.0e}",
                    f"{row.peak_difference:+.1e}",
                )
                for row in rows
            ),
        ),
        "## Whole process",
        "fem-seal from the start of Python through meshing to the profiles; CalculiX from a finished deck on. Wall "
        "time and, in brackets, processor time [s]; the best of several runs (CalculiX with one and with two threads); "
        "peak memory [MB]. The last column is the ratio of both times for the 10 loads.",
        table(
            "element size, one load, ten loads, memory, CalculiX one load, ten loads, memory, ratio",
            (
                (
                    _size(row),
                    *(
                        text
                        for side in (row.seal, row.ccx)
                        for text in (_time(side.single), _time(side.sweep), f"{side.sweep.memory:.0f}")
                    ),
                    f"{row.ccx.sweep.wall / row.seal.sweep.wall:.1f} "
                    f"({row.ccx.sweep.processor / row.seal.sweep.processor:.1f})",
                )
                for row in rows
            ),
        ),
        "## A ring that yields, and an oval seat",
        "As above, whole processes. The ring: copper between steel plates, pressed with 6 kN and released in five "
        "loads, on the same triangles (CAX6), by the same stress-strain curve and in the same load steps "
        "(`benchmarks/calculix_ring.py`). The seat: the ball of above at 20 bar in a cone that lies higher by "
        "A cos(2 phi), by fem-seal around the axis, by CalculiX as a quarter of both bodies in three dimensions "
        "(`benchmarks/three_dimensional_seat.py`). Differences: CalculiX against fem-seal; of the seat the largest of "
        "all angles. The ring's peak is the pressure at one vertex, and up to 3 % off at small loads.",
        table(
            "seal, fem-seal, memory, CalculiX, memory, ratio, largest difference",
            (
                (
                    other.name,
                    *(
                        text
                        for cost in (other.seal, other.ccx)
                        for text in (_time(cost), f"{cost.memory:.0f}")
                    ),
                    f"{other.ccx.wall / other.seal.wall:.1f} ({other.ccx.processor / other.seal.processor:.1f})",
                    other.difference,
                )
                for other in others
            ),
        ),
        "## Inside a warm process",
        "fem-seal: meshing, mesh to profile (condensation and one load), each further load, processor time [ms]. "
        "CalculiX: one load from the deck on, and a ninth of what nine more loads take, processor time [ms].",
        table(
            "element size, mesh, mesh to profile, further load, CalculiX one load, further load, ratio, "
            "ratio of further loads",
            (
                (
                    _size(row),
                    *(
                        f"{1e3 * t:.3g}"
                        for t in (row.warm.mesh, row.warm.condense + row.warm.load, row.warm.load)
                    ),
                    *(f"{1e3 * t:.3g}" for t in (row.ccx.single.processor, row.ccx_load)),
                    f"{row.ccx.single.processor / (row.warm.condense + row.warm.load):.0f}",
                    f"{row.ccx_load / row.warm.load:.0f}",
                )
                for row in rows
            ),
        ),
        "![cost and error](compare_calculix.svg)",
        "## Goals at equal accuracy",
        "The error of a load is the largest of p0/force, FWHM and std, that of a mesh the median over the loads: "
        "CalculiX on its finest meshes is off ten times as far at a load where element edges of both bodies pass each "
        "other, and holding the load does not help.",
        goals(rows),
        "## Other choices in CalculiX",
        f"Ten loads, {_size(rows[0])}, one thread. Wall and processor time [s].",
        table(
            "choice, time, p0, p0/force, FWHM, std",
            (
                (name, _time(c), f"{a.peak:+.1e}", *(f"{e:+.1e}" for e in _errors(a)))
                for name, c, a in choices
            ),
        ),
    ]
    file.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def goals(rows: Sequence[Row]) -> str:
    """Goals and what was reached, each code on its coarsest mesh that is accurate enough."""
    ours = rows[0]
    times = (
        ("new geometry to profile, warm", ours.warm.mesh + ours.warm.condense + ours.warm.load, 0.5),
        ("each further load", ours.warm.load, 5e-3),
    )
    lines = [
        *_goals_at(rows, 5e-4, "0.05 %"),
        *_goals_at(rows, ours.seal.accuracy.typical, "what fem-seal reaches on the mesh that it chooses"),
        f"fem-seal alone, on the mesh that it chooses ({_size(ours)}, error {ours.seal.accuracy.typical:.0e}):",
        "",
        *(
            f"- {name}: {1e3 * t:.3g} ms (goal {1e3 * goal:g} ms){_verdict(t <= goal)}"
            for name, t, goal in times
        ),
        "- cost over number of triangles, exponent of a power law: "
        + ", ".join(f"{name} {slope:.2f}" for name, slope in slopes(rows).items()),
    ]
    return "\n".join(lines)


def _goals_at(rows: Sequence[Row], error: float, name: str) -> list[str]:
    """Ratios at an accuracy that both codes reach."""
    seal = max(
        (row for row in rows if row.seal.accuracy.typical <= error), key=lambda row: row.size, default=rows[0]
    )
    finest = min(rows, key=lambda row: row.size)
    ccx = max(
        (row for row in rows if row.ccx.accuracy.typical <= error), key=lambda row: row.size, default=finest
    )
    figures = (
        ("whole process, ten loads", ccx.ccx.sweep.processor / seal.seal.sweep.processor, 5),
        ("mesh to profile, warm", ccx.ccx.single.processor / (seal.warm.condense + seal.warm.load), 20),
        ("each further load", ccx.ccx_load / seal.warm.load, 500),
    )
    return [
        f"Error not above {name}: fem-seal at {_size(seal)} "
        f"({seal.seal.accuracy.typical:.1e}), CalculiX at {_size(ccx)} ({ccx.ccx.accuracy.typical:.1e}"
        f"{'' if ccx.ccx.accuracy.typical <= error else ', its best'}). By processor time fem-seal is faster",
        "",
        *(
            f"- {what}: {ratio:.3g} times (goal {goal}){_verdict(ratio >= goal)}"
            for what, ratio, goal in figures
        ),
        "",
    ]


def slopes(rows: Sequence[Row]) -> dict[str, float]:
    """Exponents of cost over the number of triangles."""
    n = np.log([row.elements for row in rows])
    costs = {
        "fem-seal, ten loads, warm": [_warm(row) for row in rows],
        "CalculiX, ten loads": [row.ccx.sweep.processor for row in rows],
    }
    return {name: float(np.polyfit(n, np.log(cost), 1)[0]) for name, cost in costs.items()}


def draw(file: Path, rows: Sequence[Row]) -> None:
    """Cost over mesh size, and error over cost."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    rows = sorted(rows, key=lambda row: row.elements)
    curves = (
        ("CalculiX", "C3", "s-", [row.ccx.sweep.processor for row in rows], [row.ccx for row in rows]),
        (
            "fem-seal, whole process",
            "C0",
            "o-",
            [row.seal.sweep.processor for row in rows],
            [row.seal for row in rows],
        ),
        ("fem-seal, warm process", "C0", "o--", [_warm(row) for row in rows], [row.seal for row in rows]),
    )
    style = {"font.size": 9, "svg.hashsalt": "calculix", "axes.spines.top": False, "axes.spines.right": False}
    with mpl.rc_context(style):
        figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.4), layout="constrained")
        for name, colour, line, cost, sides in curves:
            left.loglog([row.elements for row in rows], cost, line, color=colour, ms=4, label=name)
            right.loglog(cost, [side.accuracy.typical for side in sides], line, color=colour, ms=4)
        n = np.array([rows[0].elements, rows[-1].elements])
        left.loglog(n, 0.5 * n / n[0], "k:", lw=1, label="linear")
        left.set(xlabel="triangles", ylabel="processor time for ten loads [s]")
        right.set(xlabel="processor time for ten loads [s]", ylabel="error, median of ten loads")
        left.legend(frameon=False, fontsize=8)
        figure.savefig(file, metadata={"Date": None})
        plt.close(figure)


def table(head: str, rows: Iterable[Sequence[object]]) -> str:
    """A Markdown table; the head's columns are separated by commas."""
    columns = head.split(", ")
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return "\n".join([*lines, *("| " + " | ".join(map(str, row)) + " |" for row in rows)])


def _warm(row: Row) -> float:
    return row.warm.mesh + row.warm.condense + len(row.seal.profiles) * row.warm.load


def _errors(a: Accuracy) -> tuple[float, float, float]:
    return a.peak_by_load, a.fwhm, a.std


def _time(cost: Cost) -> str:
    return f"{cost.wall:.2f} ({cost.processor:.2f})"


def _size(row: Row) -> str:
    return f"{row.size * 1e6:.3g} um"


def _verdict(is_met: bool) -> str:
    return "" if is_met else " **missed**"
