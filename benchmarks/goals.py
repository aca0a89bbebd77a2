"""Every figure that has a goal, beside it: python benchmarks/goals.py [GROUP ...] [--quick] [--record].

Groups are measured one after the other; one that fails is named and the others go on. `--record` puts what was measured
into benchmarks/history.csv, from which the manual makes its page of speed and memory. Times are processor times where
a figure does not say "wall time", so that other programs disturb them little.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import date
from itertools import pairwise
from pathlib import Path
from urllib.parse import urljoin
from urllib.request import HTTPCookieProcessor, build_opener

os.environ["OPENBLAS_NUM_THREADS"] = "1"
# As a user has it: modules are compiled once. Where Python is told to keep none, imports take three times as long.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
os.environ.setdefault("PYTHONPYCACHEPREFIX", str(Path(sys.prefix) / "bytecode"))

import history
from measured_process import Cost, measure_process

HERE = Path(__file__).parent
ROOT = HERE.parent
CASE = ROOT / "examples" / "ball_cone.toml"
IMPORTS = "import numpy, scipy.sparse.linalg, gmsh, skfem"


@dataclass(frozen=True)
class Figure:
    """A number, and the largest that is wanted; times on the machine of the goals."""

    name: str
    value: float
    unit: str
    goal: float | None = None
    note: str = ""


@dataclass(frozen=True)
class Settings:
    """How thoroughly it is measured.

    Parameters
    ----------
    quick : bool
        Fewer repetitions, a tenth of the designs.
    designs : int
        Of the cluster.
    reference : float
        Processor time of the imports [s].
    """

    quick: bool
    designs: int
    reference: float

    @property
    def rounds(self) -> int:
        """How often a short program is run; the fastest counts."""
        return 3 if self.quick else 7


def process(settings: Settings) -> Iterator[Figure]:
    """Commands as whole processes."""
    for command, of_imports, seconds in (("run", 3.0, 1.8), ("check", 1.5, 0.5)):
        with tempfile.TemporaryDirectory() as folder:
            output = ["-o", str(Path(folder) / "out")] if command == "run" else []
            cost = best_of(settings.rounds, ["-m", "fem_seal", command, str(CASE), *output])
        yield Figure(f"{command}: processor time", cost.processor / settings.reference, "imports", of_imports)
        yield Figure(f"{command}: wall time", cost.wall, "s", seconds)
        yield Figure(f"{command}: memory", cost.memory, "MB", 200 if command == "run" else None)


def live(settings: Settings) -> Iterator[Figure]:
    """From the start of the live page to the first numbers in it; the browser that draws them is left out."""
    with tempfile.TemporaryDirectory() as folder:
        seconds = [_first_numbers(folder) for _ in range(settings.rounds + 1)][1:]
    yield Figure("live page: wall time to the first numbers", min(seconds), "s", 6, "without the browser")


def _first_numbers(folder: str) -> float:
    """Wall time from the command to a page that has numbers [s]."""
    command = [sys.executable, "-m", "fem_seal", "explore", str(CASE), "--no-browser", "--port", "0"]
    start = time.perf_counter()
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, text=True, env={**os.environ, **_environment()}
    ) as page:
        try:
            assert page.stdout is not None
            address = page.stdout.readline().split(": ")[-1].split()[0]
            # the address leaves a cookie, by which the page knows who asks
            browser = build_opener(HTTPCookieProcessor())
            browser.open(address).read()
            while b'"value-peak"' not in browser.open(urljoin(address, "_dash-layout")).read():
                time.sleep(0.05)
            return time.perf_counter() - start
        finally:
            page.send_signal(signal.SIGINT)


# Bodies that yield, with the goal of each [s]; the relief valve of the example with a set pressure.
_YIELDING = {"copper_ring": 5, "bolted_ring": 8, "ring_joint": 8, "relief_valve_350_bar": 90}
_SPRING, _SET_PRESSURE = 'applied_force = "2.2 kN"', 'set_pressure = "450 bar"'


def yielding(settings: Settings) -> Iterator[Figure]:
    """Examples with a stress-strain curve as whole processes, without the report."""
    for name, goal in _YIELDING.items():
        text = (CASE.parent / f"{name}.toml").read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            case = Path(folder) / "case.toml"
            case.write_text(text.replace(_SPRING, _SET_PRESSURE), encoding="utf-8")
            cost = best_of(1 if settings.quick else 3, ["-m", "fem_seal", "run", str(case), "--no-report"])
        note = "with set_pressure = 450 bar" if _SPRING in text else ""
        yield Figure(f"{name}: processor time", cost.processor, "s", goal, note)


# A gas through a map: 2000 places around a ring, 100 across, the pressure 30 % higher at one side.
MAP_CASE = """
closure.material = "316L"
seat.material = "316L"
roughness = { kind = "finish", process = "lapped", Ra = "0.2 um" }
fluid.name = "nitrogen"
load.fluid_pressure = "20 bar"
"""


def maps(settings: Settings) -> Iterator[Figure]:
    """A map of contact pressure of 200,000 points, as a whole process."""
    import meshio
    import numpy as np

    r, turn = np.linspace(14.0, 14.6, 100)[:, None], 2.0 * np.pi * np.arange(2000) / 2000
    pressure = 100.0 * np.exp(-0.5 * ((r - 14.3) / 0.08) ** 2) * (1.0 + 0.3 * np.cos(turn))
    points = np.stack([r * np.cos(turn), r * np.sin(turn), 0.0 * pressure], axis=-1).reshape(-1, 3)
    a = np.arange(99 * 2000)
    b = a - a % 2000 + (a + 1) % 2000
    triangles = np.concatenate([np.stack([a, b, a + 2000], 1), np.stack([b, b + 2000, a + 2000], 1)])
    with tempfile.TemporaryDirectory() as folder:
        mesh, case = Path(folder) / "ring.vtu", Path(folder) / "ring.toml"
        meshio.Mesh(points, [("triangle", triangles)], point_data={"CPRESS": pressure.ravel()}).write(mesh)
        case.write_text(MAP_CASE, encoding="utf-8")
        units = ["--length-unit", "mm", "--pressure-unit", "MPa"]
        cost = best_of(1, ["-m", "fem_seal", "leak", str(mesh), str(case), *units])
    yield Figure("map of 200,000 points: processor time", cost.processor, "s", 15)
    yield Figure("map of 200,000 points: memory", cost.memory, "MB", 1000)


def best_of(rounds: int, arguments: list[str]) -> Cost:
    """Least that a Python program takes, after a first time that fills the caches of the system."""
    with tempfile.TemporaryDirectory() as folder:
        costs = [
            measure_process([sys.executable, *arguments], Path(folder), _environment())
            for _ in range(rounds + 1)
        ][1:]
    return Cost(*(min(getattr(cost, name) for cost in costs) for name in ("wall", "processor", "memory")))


def _environment() -> dict[str, str]:
    return {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)}


def geometry(settings: Settings) -> Iterator[Figure]:
    """A geometry that was not there before, in a process that has loaded everything; nothing is written."""
    from fem_seal.case.case import load_case
    from fem_seal.result import run

    case = load_case(CASE)

    def cost(angle: float) -> tuple[float, float]:
        """Processor time of a run, and without what comes after the loads [s]."""
        marks: list[tuple[str, float]] = []
        run(
            case.replace_written({"seat.angle": f"{angle} deg"}),
            lambda text: marks.append((text, time.process_time())),
        )
        marks.append(("end", time.process_time()))
        steps = [(name, end - start) for (name, start), (_, end) in pairwise(marks)]
        return sum(s for _, s in steps), sum(s for name, s in steps if not name.startswith(_AFTERWARDS))

    cost(45.0)
    # three seats that hardly differ, of which the fastest counts
    each = [
        [cost(47 + 0.7 * n + 0.01 * repeat) for repeat in range(3)] for n in range(3 if settings.quick else 9)
    ]
    whole, bare = ([min(run_cost[part] for run_cost in three) for three in each] for part in (0, 1))
    note = f"median of {len(each)}, each the fastest of three, 20 loads"
    yield Figure("new geometry in a warm process", statistics.median(whole), "s", 0.3, note)
    yield Figure(
        "new geometry without stress, error estimate and far field",
        statistics.median(bare),
        "s",
        0.15,
        note,
    )


# What the chain says when it begins these steps.
_AFTERWARDS = ("stress in", "estimating the discretisation error", "comparing sizes and supports")


def theory(settings: Settings) -> Iterator[Figure]:
    """Tables of flow conductivity, interface laws, gas flow, import of the package `leak`."""
    return of_pytest("bench_leak.py", "--benchmark-timer=time.process_time")


def uncertainty(settings: Settings) -> Iterator[Figure]:
    """Samples of every kind of fluid and spectrum: processor time of one, and what a user waits."""
    if settings.quick:
        return of_pytest("bench_uncertainty.py", "-k", "per_sample", SAMPLES="32", ASKED="64")
    return of_pytest("bench_uncertainty.py")


def of_pytest(file: str, *options: str, **environment: str) -> Iterator[Figure]:
    """Benchmarks of a file that say their goal: `goal_s`, of `figure_s` or else of the fastest round."""
    with tempfile.TemporaryDirectory() as folder:
        json_file = Path(folder) / "told.json"
        arguments = [str(HERE / file), f"--benchmark-json={json_file}", *options]
        tests = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments],
            cwd=ROOT,
            env={**os.environ, **_environment(), **environment},
            capture_output=True,
            text=True,
        )
        if not json_file.exists():
            raise RuntimeError(tests.stdout[-2000:] + tests.stderr[-2000:])
        results = json.loads(json_file.read_text())["benchmarks"]
    if tests.returncode != 0:
        print(tests.stdout[-2000:], file=sys.stderr)
    for result in results:
        about = result["extra_info"]
        if "goal_s" in about:
            name = result["name"].removeprefix("test_").replace("[", ": ").rstrip("]").replace("_", " ")
            seconds = about.get("figure_s", result["stats"]["min"])
            yield Figure(name, seconds, "s", about["goal_s"], about.get("note", ""))


def studies(settings: Settings) -> Iterator[Figure]:
    """Designs on one geometry and with one each, on two workers."""
    import bench_studies

    part = 10 if settings.quick else 1
    note = "a tenth of the designs, times ten" if settings.quick else ""
    for name, count, goal, tables in (
        ("10 000 designs, grid", 10000, 15, bench_studies.grid(round((10000 / part) ** 0.5))),
        ("10 000 designs, latin hypercube", 10000, 15, bench_studies.latin(10000 // part)),
        ("1000 geometries", 1000, 90, bench_studies.geometries(1000 // part)),
    ):
        cost = bench_studies.run(name, 2, goal / part, **tables)
        share = count / cost.designs
        yield Figure(f"{name}: wall time", share * cost.wall, "s", goal, note)
        yield Figure(f"{name}: processor time of each worker", share * cost.processor, "s", goal, note)
    growth, each = bench_studies.memory(100_000 // part)
    note = f"{100_000 // part} designs that take no time"
    yield Figure("coordinator: growth of its memory over the last nine tenths", growth, "MB", None, note)
    yield Figure("coordinator: hashing, ordering and storing a design", 1e3 * each, "ms", None, note)


def cluster(settings: Settings) -> Iterator[Figure]:
    """A study on a scheduler and workers that speak TCP, one lost, one added."""
    import bench_cluster

    cost = bench_cluster.run(settings.designs)
    note = f"{cost.designs} designs, {cost.compared} of them calculated here as well, all equal"
    yield Figure("cluster: wall time per design", 1e3 * cost.wall / cost.designs, "ms", None, note)
    yield Figure("cluster: cost of a design in its worker", 1e3 * cost.cost, "ms", None, note)
    yield Figure(
        "cluster: overhead, repeats after the loss of a worker included", 100 * cost.overhead, "%", None, note
    )
    yield Figure("cluster: memory of the coordinating process", cost.memory, "MB", None, note)
    yield Figure("cluster: its growth over the last nine tenths", cost.growth, "MB", None, note)


def tests(settings: Settings) -> Iterator[Figure]:
    """`make test` on two cores."""
    start = time.perf_counter()
    process_result = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-n", "auto", "--dist", "loadfile", "-m", "not slow"],
        cwd=ROOT,
        env={**os.environ, **_environment()},
    )
    note = "" if process_result.returncode == 0 else "some tests failed"
    yield Figure("test suite on two cores: wall time", time.perf_counter() - start, "s", 300, note)


GROUPS: dict[str, Callable[[Settings], Iterator[Figure]]] = {
    group.__name__: group
    for group in (process, live, yielding, maps, geometry, uncertainty, studies, cluster, theory, tests)
}
# Minutes, and nothing else may run meanwhile: only where it is asked for by name.
_ONLY_BY_NAME = ("tests",)


def imports(rounds: int) -> float:
    """Processor time of the imports that the goals are measured by [s]."""
    return best_of(rounds, ["-c", IMPORTS]).processor


def program() -> tuple[str, str]:
    """Version and commit, with a + where files differ from it."""
    from fem_seal.version import __version__

    def git(*arguments: str) -> str:
        return subprocess.run(
            ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True
        ).stdout.strip()

    code = ("fem_seal", "leak", "meshes")
    return __version__, git("rev-parse", "--short", "HEAD") + (
        "+" if git("status", "--short", "--", *code) else ""
    )


def print_row(cells: tuple[str, ...]) -> None:
    """One line of the table."""
    name, *others = cells
    widths = (14, 9, 12, 7, 8)
    print(
        f"{name:58s}" + "".join(f"{cell:>{width}s}" for cell, width in zip(others, widths, strict=True)),
        flush=True,
    )


def main() -> None:
    """Measure, print, record."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "groups", nargs="*", metavar="GROUP", help=f"of {', '.join(GROUPS)}; all but tests unless given"
    )
    parser.add_argument("--quick", action="store_true", help="fewer repetitions, a tenth of the designs")
    parser.add_argument("--record", action="store_true", help="into benchmarks/history.csv")
    parser.add_argument("--designs", type=int, help="of the cluster; 2500, or 1000 with --quick")
    options = parser.parse_args()
    wrong = [name for name in options.groups if name not in GROUPS]
    if wrong:
        parser.error(f"no group {', '.join(wrong)}; there are {', '.join(GROUPS)}")
    designs = options.designs or (1000 if options.quick else 2500)
    version, commit = program()
    old_entries, entries = history.read() if history.FILE.exists() else [], []
    print(f"fem-seal {version} at {commit}, load {os.getloadavg()[0]:.1f}")
    print(f"scaled: a time on a machine whose imports take {history.GOAL_MACHINE} s, for which the goals are")
    print_row(history.HEAD)
    for name in options.groups or [name for name in GROUPS if name not in _ONLY_BY_NAME]:
        # before each group: a machine is not equally fast all the time
        reference = imports(3 if options.quick else 5)
        new = []
        try:
            for row in GROUPS[name](Settings(options.quick, designs, reference)):
                new.append(
                    history.Entry(version, date.today().isoformat(), commit, row.name, row.value, row.unit, row.goal,
                                  reference, row.note)
                )  # fmt: skip
                print_row(history.row(new[-1], history.find_previous(old_entries, new[-1])))
        except Exception:
            traceback.print_exc()
            print(f"{name}: not measured", flush=True)
        entries += new
        if options.record and new:
            history.write(history.with_new(history.read() if history.FILE.exists() else [], new))
    misses = [entry.figure for entry in entries if entry.is_met is False]
    with_goal = [entry for entry in entries if entry.is_met is not None]
    print(f"{len(with_goal) - len(misses)} of {len(with_goal)} goals met" + (", missed:" if misses else ""))
    for figure in misses:
        print(f"  {figure}")


if __name__ == "__main__":
    main()
