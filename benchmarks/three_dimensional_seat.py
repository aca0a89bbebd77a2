"""A two-lobed seat in fem-seal and as three-dimensional model in CalculiX.

python benchmarks/three_dimensional_seat.py [--quick] writes docs/verification/benchmark_calculix.md.
Without CalculiX it says so and
does nothing.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import math
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import calculix
import numpy as np
from calculix_deck import LOWEST_PRESSURE, FloatArray
from calculix_page import table
from calculix_solid import SolidSeal, solid_deck
from case_to_line_load import mean_contact
from measured_process import Cost, measure_process
from scipy.interpolate import CubicSpline

import fem_seal
from fem_seal.contact.local_contact import LocalContact
from fem_seal.seal.circumference import Circumference, solve_around
from fem_seal.seal.problem import SealProblem, expected_forces, size_mesh
from meshes import SealMesh, build_contact

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent / "docs" / "verification" / "benchmark_calculix.md"
AMPLITUDES = (0.5e-6, 1e-6, 2e-6)
# Lobes of the seat; CalculiX gets the quarter between two planes of symmetry.
LOBES, QUARTERS = 2, 4
# Relative residual force and correction at which CalculiX stops.
TOLERANCE = 1e-5
# How many times as fast fem-seal should be.
_GOAL = 200
FAR_SIZE = 6e-3

CASE = """
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"
[seat]
shape = "cone"
angle = "45 deg"
material = "steel"
[interface]
law = "exponential"
u0 = "0.76 um"
p_c = "10 GPa"
[load]
fluid_pressure = "20 bar"
[form.seat]
direction = "normal"
harmonics = [{{ waves = {lobes}, amplitude = "{amplitude} um" }}]
"""


@dataclass(frozen=True)
class Solid:
    """A mesh for CalculiX.

    Parameters
    ----------
    contact_size : float
        Element size across the contact [m].
    growth : float
        Of the element size away from it.
    layers : int
        Elements over 90 degrees.
    """

    contact_size: float
    growth: float
    layers: int

    def section(self, problem: SealProblem) -> SealMesh:
        """The triangles that are joined and turned about the axis."""
        sizes = replace(
            size_mesh(problem),
            contact_size=self.contact_size,
            growth_along=self.growth,
            growth_deep=self.growth,
            far_size=FAR_SIZE,
        )
        return build_contact(problem.contact, sizes)

    def __str__(self) -> str:
        return f"{1e6 * self.contact_size:.3g} um, {self.layers} layers"


SOLIDS = (Solid(100e-6, 0.5, 12), Solid(50e-6, 0.4, 16))


@dataclass(frozen=True, eq=False)
class SolidRun:
    """What CalculiX found at one amplitude.

    Parameters
    ----------
    angle : ndarray, shape (m,)
        From 0 to 90 degrees [rad].
    line_load, peak_pressure : ndarray, shape (m,)
        [N/m] and [Pa], as integrated and read.
    nodes : int
    reaction : float
        Of the whole seal over the applied force, minus one.
    cost : Cost
    """

    angle: FloatArray
    line_load: FloatArray
    peak_pressure: FloatArray
    nodes: int
    reaction: float
    cost: Cost

    @cached_property
    def mean(self) -> float:
        """Mean line load [N/m]."""
        return float(np.trapezoid(self.line_load, self.angle) / np.ptp(self.angle))

    @property
    def over_mean(self) -> FloatArray:
        """Line load over its mean."""
        return self.line_load / self.mean


@dataclass(frozen=True)
class Warm:
    """Processor times of fem-seal inside a process that has done it before [s]."""

    mean: float
    first: float
    further: float


def case_of(amplitude: float, folder: Path) -> tuple[fem_seal.Case, Path]:
    """The case with an amplitude [m], and its file."""
    file = folder / f"case_{1e6 * amplitude:g}.toml"
    file.write_text(CASE.format(lobes=LOBES, amplitude=f"{1e6 * amplitude:g}"))
    return fem_seal.load_case(file), file


def run_solid(
    problem: SealProblem, solid: Solid, amplitude: float, expected_peak: float, folder: Path
) -> SolidRun:
    """CalculiX at one amplitude [m].

    Parameters
    ----------
    expected_peak : float
        Highest pressure anywhere [Pa]; the closure starts as deep as it needs where the seat is highest.
    """
    way_down = problem.law.u0 * math.log(1e-6 * expected_peak / LOWEST_PRESSURE) - amplitude
    seal = SolidSeal.of(solid.section(problem), solid.layers, amplitude, way_down)
    force = expected_forces(problem)[-1]
    cost = calculix.run(solid_deck(seal, problem.materials, problem.law, force, TOLERANCE), 1, folder)
    (pressure,) = calculix.contact_pressures(folder / "seal.frd")
    angle, line_load, peak = loads_around(seal, pressure)
    reaction = QUARTERS * float(calculix.total_forces(folder)[-1, 2])
    return SolidRun(angle, line_load, peak, int(seal.seat.number.max()), reaction / force - 1, cost)


def loads_around(seal: SolidSeal, pressure: dict[int, float]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angle, line load and peak pressure on the planes between the layers."""
    contact = seal.closure.section.contact
    points, p = corner_pressures(seal, pressure)
    x = contact.coordinate(*points)
    line_load = np.trapezoid(p * contact.radius(x) / contact.initial_contact_radius, x)
    return seal.closure.angle[::2], line_load, p.max(axis=1)


def corner_pressures(seal: SolidSeal, pressure: dict[int, float]) -> tuple[FloatArray, FloatArray]:
    """Places (r, z) across the closure's face [m], and the pressure there on the planes between the layers [Pa].

    The pressure counts at the elements' corners; at the nodes between them CalculiX extrapolates it.
    """
    mesh, contact = seal.closure.section.mesh, seal.closure.section.contact
    vertices = np.unique(mesh.facets[:, mesh.boundaries["closure_contact"]])
    vertices = vertices[np.argsort(contact.coordinate(*mesh.p[:, vertices]))]
    nodes = seal.closure.number[::2, vertices]
    p = np.array([[pressure.get(node - 1, 0.0) for node in plane] for plane in nodes.tolist()])
    return mesh.p[:, vertices], p


@dataclass(frozen=True, eq=False)
class Comparison:
    """Both programs at all amplitudes; the first, zero, is the round seat."""

    ours: Mapping[float, Circumference]
    theirs: Mapping[Solid, Mapping[float, SolidRun]]
    process: Cost
    warm: Warm

    @property
    def finest(self) -> Solid:
        """The last mesh."""
        return list(self.theirs)[-1]

    def line_load(self, amplitude: float, angle: FloatArray) -> FloatArray:
        """Line load of fem-seal over its mean."""
        circumference = self.ours[amplitude]
        return at_angles(circumference, circumference.line_load / circumference.local.mean.line_load, angle)

    def differences(self, solid: Solid, amplitude: float) -> tuple[float, float]:
        """What CalculiX has more anywhere: of line load over its mean, of peak pressure over the largest one.

        Its pressures are divided by the share of the force that they carry.
        """
        theirs, ours = self.theirs[solid][amplitude], self.ours[amplitude]
        load = theirs.over_mean - self.line_load(amplitude, theirs.angle)
        mine = at_angles(ours, ours.peak_pressure, theirs.angle)
        peak = theirs.peak_pressure * ours.local.mean.line_load / theirs.mean - mine
        return _largest(load), _largest(peak) / float(mine.max())


def at_angles(circumference: Circumference, values: FloatArray, angle: FloatArray) -> FloatArray:
    """Values of fem-seal at other angles."""
    whole = np.append(circumference.angle, 2 * np.pi)
    return np.asarray(CubicSpline(whole, np.append(values, values[0]), bc_type="periodic")(angle))


def _largest(values: FloatArray) -> float:
    """The largest value, with its sign."""
    return float(values[np.argmax(np.abs(values))])


def run_fem_seal(
    amplitudes: Sequence[float], repeat: int, folder: Path
) -> tuple[dict[float, Circumference], Cost, Warm]:
    """fem-seal at all amplitudes, and its cost at one."""
    case, file = case_of(amplitudes[-1], folder)
    problem = SealProblem.of(case)
    command = [sys.executable, str(HERE / "case_to_line_load.py"), str(file), "line_load.csv"]
    costs = [measure_process(command, folder) for _ in range(repeat)]
    process = Cost(*(min(getattr(cost, name) for cost in costs) for name in ("wall", "processor", "memory")))
    steps = []
    for _ in range(repeat):
        start = time.process_time()
        mean = mean_contact(problem)
        time_solved = time.process_time()
        local = LocalContact(mean, problem.law)
        solve_around(problem.form, local)
        time_prepared = time.process_time()
        solve_around(problem.form.scale(0.9), local)
        steps.append((time_solved - start, time_prepared - time_solved, time.process_time() - time_prepared))
    forms = {amplitude: SealProblem.of(case_of(amplitude, folder)[0]).form for amplitude in amplitudes}
    circumferences = {amplitude: solve_around(form, local) for amplitude, form in forms.items()}
    return circumferences, process, Warm(*(min(times) for times in zip(*steps, strict=True)))


def compare(solids: Sequence[Solid], amplitudes: Sequence[float], repeat: int, folder: Path) -> Comparison:
    """Both programs at all amplitudes [m]."""
    ours, process, warm = run_fem_seal(amplitudes, repeat, folder)
    theirs: dict[Solid, dict[float, SolidRun]] = {solid: {} for solid in solids}
    comparison = Comparison(ours, theirs, process, warm)
    for solid in solids:
        for amplitude, circumference in ours.items():
            problem = SealProblem.of(case_of(amplitude, folder)[0])
            run = run_solid(problem, solid, amplitude, float(circumference.peak_pressure.max()), folder)
            theirs[solid][amplitude] = run
            load, peak = comparison.differences(solid, amplitude)
            print(
                f"{1e6 * amplitude:g} um, {solid}: line load {_share(load)}, peak pressure {_share(peak)}; {run.cost}",
                flush=True,
            )
    return comparison


def page(version: str, comparison: Comparison) -> str:
    """The page as Markdown."""
    mean = next(iter(comparison.ours.values())).local.mean
    amplitudes = [amplitude for amplitude in comparison.ours if amplitude]
    parts = [
        "# A two-lobed seat against a three-dimensional model in CalculiX",
        "Written by `benchmarks/three_dimensional_seat.py`.",
        "The case: steel ball of 20 mm in a 45 deg cone, p = p_c exp(-u/u0) with u0 = 0.76 um, axial force of 20 bar "
        f"on the sealed area. The seat's face lies higher along its normal by A cos({LOBES} phi). fem-seal calculates "
        "the line load around the axis by the long-wave equation ([theory of form errors](../theory/form.md)). "
        f"CalculiX {version} knows nothing of that: it gets a quarter of both bodies as solids (C3D20R, a few C3D15) "
        "with the same outlines, supports and closing load, the deviation in the nodes of the seat's face, and its own "
        "exponential contact, surface to surface. The solids are triangles of the section, joined to quadrilaterals "
        "and turned about the axis. Line load and peak pressure are read at the elements' corners; integrated across "
        'the width they miss the applied force by the share under "force", though the reaction does not, and are '
        "divided by it in all comparisons.",
        "## The round seat",
        "What the solids alone are worth: CalculiX should find the same line load everywhere, and the peak pressure of "
        f"the axisymmetric model, {mean.profile.peak_pressure / 1e6:.4g} MPa under {mean.line_load / 1e3:.4g} N/mm. "
        "Peak pressure: the largest difference at any angle.",
        table(
            "size across and layers over 90 deg, nodes, line load least/mean, largest/mean, force, reaction, "
            "peak pressure",
            (
                (
                    solid,
                    runs[0.0].nodes,
                    f"{runs[0.0].over_mean.min():.4f}",
                    f"{runs[0.0].over_mean.max():.4f}",
                    _share(runs[0.0].mean / mean.line_load - 1),
                    f"{runs[0.0].reaction:+.0e}",
                    _share(comparison.differences(solid, 0.0)[1]),
                )
                for solid, runs in comparison.theirs.items()
            ),
        ),
        "## The two-lobed seat",
        "Line loads over their mean. Differences: the largest at any angle, of the line load over the mean (goal 2 %), "
        "of the peak pressure over the highest one. The latter stands on the planes of symmetry, where CalculiX "
        "extrapolates from one side only.",
        table(
            "A, size and layers, least: fem-seal, CalculiX, largest: fem-seal, CalculiX, difference of line load, "
            "of peak pressure, force",
            (row for amplitude in amplitudes for row in _rows(comparison, amplitude)),
        ),
        f"Around the axis, CalculiX with {comparison.finest}:",
        table(
            "phi [deg], " + ", ".join(f"A = {1e6 * a:g} um: fem-seal, CalculiX" for a in amplitudes),
            _around_rows(comparison, amplitudes),
        ),
        "## What CalculiX needs for it",
        "All of the contact in one pair: of pairs that share an edge, one for each layer, CalculiX 2.20 leaves out "
        "some 40 % of the area. And nodes between the layers' corners that lie on the chord on both contact faces: "
        "CalculiX cuts the faces against each other as if their outlines were convex, and on the arc it loses some 2 % "
        "of the area. The law goes on where the surfaces stand apart, CalculiX's contact does not: its law starts at "
        f"{1e6 * LOWEST_PRESSURE:g} Pa, and the closure as much deeper.",
        "## Cost",
        "One processor, beside other work of the machine; CalculiX with one thread, from the finished deck on; "
        "fem-seal at the largest amplitude. Processor time [s], peak memory [MB].",
        table(
            "program, processor time, memory",
            (
                (
                    f"CalculiX, {solid}, A = {1e6 * amplitude:g} um",
                    f"{run.cost.processor:.1f}",
                    f"{run.cost.memory:.0f}",
                )
                for solid, runs in comparison.theirs.items()
                for amplitude, run in runs.items()
            ),
        ),
        _cost(comparison, amplitudes),
        "```{include} ../../benchmarks/calculix_around.md\n:heading-offset: 1\n```",
    ]
    return "\n\n".join(parts) + "\n"


def _rows(comparison: Comparison, amplitude: float) -> Iterator[tuple[object, ...]]:
    ours = comparison.ours[amplitude]
    for solid, runs in comparison.theirs.items():
        theirs = runs[amplitude]
        load, peak = comparison.differences(solid, amplitude)
        yield (
            f"{1e6 * amplitude:g} um",
            solid,
            f"{ours.least_over_mean:.4f}",
            f"{theirs.over_mean.min():.4f}",
            f"{ours.most_over_mean:.4f}",
            f"{theirs.over_mean.max():.4f}",
            _share(load),
            _share(peak),
            _share(theirs.mean / ours.local.mean.line_load - 1),
        )


def _around_rows(comparison: Comparison, amplitudes: Sequence[float]) -> Iterator[tuple[str, ...]]:
    runs = comparison.theirs[comparison.finest]
    angle = runs[0.0].angle
    for k in range(0, len(angle), 2):
        pairs = ((comparison.line_load(a, angle)[k], runs[a].over_mean[k]) for a in amplitudes)
        yield (f"{math.degrees(angle[k]):.4g}", *(f"{value:.4f}" for pair in pairs for value in pair))


def _cost(comparison: Comparison, amplitudes: Sequence[float]) -> str:
    warm, process = comparison.warm, comparison.process
    ways = {
        f"the whole process from the start of Python ({process.processor:.2f} s, {process.memory:.0f} MB)": (
            process.processor,
            None,
        ),
        f"mesh, condensation and contact of the round seat ({1e3 * warm.mean:.0f} ms), harmonics of the bodies, "
        f"contact at other line loads and line load ({1e3 * warm.first:.0f} ms)": (
            warm.mean + warm.first,
            _GOAL,
        ),
        f"line load of a further seat, all else known ({1e3 * warm.further:.2g} ms)": (warm.further, _GOAL),
    }
    lines = ["CalculiX takes as many times as long as fem-seal, on the mean of the two-lobed seats:", ""]
    for name, (seconds, goal) in ways.items():
        ratios = {
            solid: float(np.mean([runs[a].cost.processor for a in amplitudes])) / seconds
            for solid, runs in comparison.theirs.items()
        }
        is_met = (
            ""
            if goal is None
            else f"; goal {goal}" + ("" if min(ratios.values()) >= goal else ", **missed**")
        )
        lines.append(
            f"- {name}: {', '.join(f'{ratio:.3g} ({solid})' for solid, ratio in ratios.items())}{is_met}"
        )
    return "\n".join(lines)


def _share(value: float) -> str:
    return f"{1e2 * value:+.2f} %"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--quick", action="store_true", help="the coarser solids and one amplitude; writes no page"
    )
    options = parser.parse_args()
    try:
        version = calculix.version()
    except FileNotFoundError as error:
        print(f"skipped: {error}")
        return 0
    with tempfile.TemporaryDirectory() as name:
        if options.quick:
            print(page(version, compare(SOLIDS[:1], (0.0, AMPLITUDES[1]), 1, Path(name))))
        else:
            comparison = compare(SOLIDS, (0.0, *AMPLITUDES), 3, Path(name))
            PAGE.write_text(page(version, comparison), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
