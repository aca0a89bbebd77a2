"""The same seal in fem-seal and in CalculiX, side by side: python benchmarks/compare_calculix.py [--quick].

Writes compare_calculix.md and compare_calculix.svg beside this file.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import calculix
import calculix_ring
import numpy as np
import three_dimensional_seat
from calculix_deck import Choices, deck
from calculix_page import Accuracy, OtherSeal, Row, Side, Warm, draw, write_page
from case_to_profile import mesh_of, model_of, solutions
from measured_process import Cost, measure_process

import fem_seal
import leak
from fem_seal.contact.newton import solve
from fem_seal.profile import PressureProfile
from fem_seal.seal.problem import SealProblem, expected_forces
from meshes import SealMesh

HERE = Path(__file__).resolve().parent
# fem-seal chooses some 20 um itself.
SIZES = [160e-6, 80e-6, 40e-6, 10e-6, 5e-6]
SWEEP = [2e5 * k for k in range(1, 11)]
U0 = 0.76e-6

CASE = """
[closure]
shape = "ball"
radius = "20 mm"
material = {{ youngs_modulus = "210 GPa", poissons_ratio = 0.3 }}
[seat]
shape = "cone"
angle = "45 deg"
material = {{ youngs_modulus = "210 GPa", poissons_ratio = 0.3 }}
[interface]
law = "exponential"
u0 = "0.76 um"
p_c = "5 GPa"
[load]
fluid_pressure = [{loads}]
"""


def accuracy(case: fem_seal.Case, profiles: Sequence[PressureProfile]) -> Accuracy:
    """Judge the profiles of all loads of a case."""
    normal_z = float(np.cos(case.contact.angle))
    errors = []
    for force, profile in zip(expected_forces(SealProblem.of(case)), profiles, strict=True):
        line_load = force / (2 * np.pi * case.initial_contact_radius * normal_z)
        exact = leak.crossover_line(line_load, case.contact.relative_radius, case.effective_modulus, U0)
        is_loaded = (
            2 * np.pi * normal_z * float(profile.arc_weight @ (profile.radius * profile.pressure)) / force
        )
        peak = profile.peak_pressure / exact.peak_pressure
        errors.append(
            (
                peak - 1,
                peak / is_loaded - 1,
                profile.fwhm / exact.fwhm - 1,
                profile.std / exact.std - 1,
                is_loaded - 1,
            )
        )
    columns = np.array(errors).T
    typical = float(np.median(np.abs(columns[1:4]).max(axis=0)))
    return Accuracy(*(float(column[np.argmax(np.abs(column))]) for column in columns), typical)


def case_of(pressures: Sequence[float], folder: Path) -> tuple[fem_seal.Case, Path]:
    """The case, and its file."""
    file = folder / f"case_{len(pressures)}.toml"
    file.write_text(CASE.format(loads=", ".join(f'"{pressure / 1e5:.12g} bar"' for pressure in pressures)))
    return fem_seal.load_case(file), file


def best(repeat: int, job: Callable[[], Cost]) -> Cost:
    """Smallest wall and processor time and peak memory of several runs."""
    costs = [job() for _ in range(repeat)]
    return Cost(*(min(getattr(cost, name) for cost in costs) for name in ("wall", "processor", "memory")))


def seconds(repeat: int, job: Callable[[], object]) -> float:
    """Shortest processor time of several calls [s]."""
    times = []
    for _ in range(repeat):
        start = time.process_time()
        job()
        times.append(time.process_time() - start)
    return min(times)


def run_seal(case: fem_seal.Case, size: float, repeat: int, folder: Path) -> tuple[Side, Warm, SealMesh]:
    """fem-seal as a process of its own, and inside this one."""
    costs = []
    for pressures in (SWEEP[-1:], SWEEP):
        file = case_of(pressures, folder)[1]
        command = [sys.executable, str(HERE / "case_to_profile.py"), str(file), repr(size), "profiles.csv"]
        costs.append(best(repeat, partial(measure_process, command, folder)))
    seal_mesh = mesh_of(case, size)
    model = model_of(case, seal_mesh)
    profiles = [solution.profile for solution in solutions(case, model)]
    problem = SealProblem.of(case)
    law, forces = problem.law, expected_forces(problem)
    warm = Warm(
        seconds(repeat + 1, lambda: mesh_of(case, size)),
        seconds(repeat + 1, lambda: model_of(case, seal_mesh)),
        seconds(3 * repeat, lambda: [solve(model, law, contact_force=f) for f in forces]) / len(forces),
    )
    return Side(costs[0], costs[1], accuracy(case, profiles), profiles), warm, seal_mesh


def run_calculix(
    case: fem_seal.Case, seal_mesh: SealMesh, choices: Choices, folder: Path, threads: Sequence[int] = (1, 2)
) -> tuple[Cost, list[PressureProfile], float]:
    """CalculiX on a mesh; cost, profiles of all loads, and the worst relative error of the reaction."""
    problem = SealProblem.of(case)
    law, forces = problem.law, expected_forces(problem)
    line_load = forces[0] / (2 * np.pi * case.initial_contact_radius * np.cos(case.contact.angle))
    line = leak.crossover_line(
        line_load, case.contact.relative_radius, case.effective_modulus, U0
    ).peak_pressure
    materials = {"closure": case.closure.material, "seat": case.seat.material}
    text = deck(seal_mesh, materials, law, forces, line, choices)
    every = 1 + choices.held_steps
    runs = iter(threads)
    cost = best(len(threads), lambda: calculix.run(text, every * len(forces), folder, next(runs)))
    reaction = calculix.reactions(folder)[every - 1 :: every] / forces - 1
    profiles = calculix.profiles(folder, seal_mesh)[every - 1 :: every]
    return cost, profiles, float(reaction[np.argmax(np.abs(reaction))])


def compare(size: float, repeat: int, folder: Path, threads: Sequence[int]) -> Row:
    """Both programs at one element size."""
    case, _ = case_of(SWEEP, folder)
    seal, warm, seal_mesh = run_seal(case, size, repeat, folder)
    single_cost = run_calculix(case_of(SWEEP[-1:], folder)[0], seal_mesh, Choices(), folder, threads)[0]
    sweep, profiles, reaction = run_calculix(case, seal_mesh, Choices(), folder, threads)
    elements = seal_mesh.mesh.nelements
    ccx = Side(single_cost, sweep, accuracy(case, profiles), profiles)
    return Row(seal_mesh.sizing.contact_size, elements, seal, warm, ccx, reaction)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two element sizes, every time taken once")
    parser.add_argument("--repeat", type=int, default=3, help="how often fem-seal is timed; the best counts")
    options = parser.parse_args()
    try:
        version = calculix.version()
    except FileNotFoundError as error:
        print(error, file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        repeat, threads = (1, [1]) if options.quick else (options.repeat, [1, 2])
        rows = []
        for size in [0.0, 80e-6] if options.quick else [0.0, *SIZES]:
            rows.append(compare(size, repeat, folder, threads))
            print(
                f"{1e6 * rows[-1].size:.3g} um: fem-seal {rows[-1].seal.sweep}, CalculiX {rows[-1].ccx.sweep}",
                flush=True,
            )
        choices = choice_rows(folder)
        others = [yielding_ring(repeat, folder), *oval_seats(repeat, folder, quick=options.quick)]
    write_page(HERE / "compare_calculix.md", version, rows, choices, others)
    draw(HERE / "compare_calculix.svg", rows)
    return 0


def choice_rows(folder: Path) -> list[tuple[str, Cost, Accuracy]]:
    """What CalculiX's other choices cost and bring, on the mesh that fem-seal chooses."""
    case, _ = case_of(SWEEP, folder)
    seal_mesh = mesh_of(case)
    settings = Choices()
    variants = {
        "as in the table: CAX8R, curved contact line, load not held": settings,
        "CAX8": replace(settings, elements="CAX8"),
        "CAX6": replace(settings, elements="CAX6"),
        "straight contact line": replace(settings, curved=False),
        "every load held for one more step": replace(settings, held_steps=1),
    }
    rows = []
    for name, choices in variants.items():
        cost, profiles, _ = run_calculix(case, seal_mesh, choices, folder, [1])
        rows.append((name, cost, accuracy(case, profiles)))
    return rows


def yielding_ring(repeat: int, folder: Path) -> OtherSeal:
    """A copper ring, pressed and released."""
    command = [sys.executable, str(HERE / "calculix_ring.py"), "--own"]
    seal_mesh = calculix_ring.mesh("plastic")
    (theirs, cost), ours = (
        calculix_ring.theirs("plastic", seal_mesh),
        calculix_ring.own_measures("plastic", seal_mesh),
    )
    differences, hardest = theirs / ours - 1, int(np.argmax(calculix_ring.FORCES))
    return OtherSeal(
        f"copper ring, {seal_mesh.mesh.nelements} triangles, {len(calculix_ring.way())} steps",
        best(repeat, partial(measure_process, command, folder)),
        cost,
        f"at 6 kN peak {differences[hardest, 0]:+.2%}, std {differences[hardest, 2]:+.2%}; std of all loads "
        f"{differences[np.abs(differences[:, 2]).argmax(), 2]:+.2%}",
    )


def oval_seats(repeat: int, folder: Path, *, quick: bool) -> Iterator[OtherSeal]:
    """A seat with two lobes, against solids of two sizes."""
    amplitude = three_dimensional_seat.AMPLITUDES[1]
    solids = three_dimensional_seat.SOLIDS[: 1 if quick else None]
    comparison = three_dimensional_seat.compare(solids, (0.0, amplitude), repeat, folder)
    for solid in solids:
        load, peak = comparison.differences(solid, amplitude)
        yield OtherSeal(
            f"oval seat, A = {1e6 * amplitude:g} um, solids of {solid}",
            comparison.process,
            comparison.theirs[solid][amplitude].cost,
            f"line load {load:+.2%}, peak {peak:+.2%}",
        )


if __name__ == "__main__":
    sys.exit(main())
