"""A study on a cluster as it is started by hand, one worker lost and one added: python benchmarks/bench_cluster.py [N].

Scheduler and workers are processes of their own that speak TCP. At a third of the designs one worker is killed, at half
of them another one is started. The table must be that of the same designs in this process, bit for bit: parameters,
results, validity with its reasons, reasons of failure. `--compare` says how many designs are calculated here as well,
every k-th in the order of the study (2500 unless given; N for all). How far it is, how fast and how long it will
still take stands on standard error every ten seconds.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

CASE = Path(__file__).parent.parent / "examples" / "ball_cone.toml"
# dask gives back memory after every solve unless it is told not to (guide/studies in the manual)
ENVIRONMENT = {"MALLOC_TRIM_THRESHOLD_": str(2**28), "MALLOC_MMAP_THRESHOLD_": str(2**28)}


def study(designs: int):
    """Height of the roughness and fluid pressure, every combination."""
    from fem_seal import Study

    # exactly so many, on a grid that is as square as can be
    side = next(count for count in range(int(designs**0.5), 0, -1) if designs % count == 0)
    return Study(
        CASE,
        responses=["peak_pressure_Pa", "fwhm_m", "leak_rate_m3_per_s"],
        parameters={
            "roughness.spectrum.rms_height": {"start": "0.5 um", "stop": "5 um", "num": side},
            "load.fluid_pressure": {"start": "1 bar", "stop": "50 bar", "num": designs // side},
        },
    )


def dask(*command: str) -> subprocess.Popen[bytes]:
    """A process of dask, as a terminal starts it."""
    return subprocess.Popen(
        [sys.executable, "-m", "dask", *command],
        env={**os.environ, **ENVIRONMENT},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def end_process(process: subprocess.Popen[bytes]) -> None:
    """Kill a process with all that it has started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def cluster(workers: int):
    """Address of a scheduler with workers, their processes (the scheduler first), and how to start one more."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "scheduler.json"
        processes = [dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                          "--scheduler-file", str(place))]  # fmt: skip

        def add() -> subprocess.Popen[bytes]:
            processes.append(dask("worker", "--scheduler-file", str(place), "--nthreads", "1", "--no-dashboard",
                                  "--local-directory", folder))  # fmt: skip
            return processes[-1]

        try:
            while not place.exists():
                time.sleep(0.1)
            for _ in range(workers):
                add()
            yield json.loads(place.read_text())["address"], processes, add
        finally:
            for process in reversed(processes):
                end_process(process)


def count_done(folder: Path) -> int:
    """How many designs stand in the folder of a study that runs."""
    try:
        with sqlite3.connect(f"file:{folder / 'study.sqlite'}?mode=ro", uri=True) as file:
            return int(file.execute("SELECT count(*) FROM point").fetchone()[0])
    except sqlite3.Error:
        return 0


@dataclass(frozen=True)
class Cost:
    """What the study took.

    Parameters
    ----------
    designs, failed, compared : int
        All of them, those that failed, those that were calculated here as well.
    wall : float
        From the first to the last design [s].
    cost : float
        Time of a design in its worker [s].
    overhead : float
        Time of the workers, while they were there, beyond what their designs took, over the latter. What the killed
        worker had not handed over, and the start of its successor, are among it.
    memory, growth : float
        Of the process that hands out the designs and keeps the table, at the end, and since a tenth of them was done
        [MB].
    """

    designs: int
    failed: int
    compared: int
    wall: float
    cost: float
    overhead: float
    memory: float
    growth: float


@dataclass
class Watch:
    """Kills a worker and adds one when their time has come, and sees how large the processes are meanwhile."""

    folder: Path
    count: int
    processes: list[subprocess.Popen[bytes]]
    add: Callable[[], object]
    end: threading.Event = field(default_factory=threading.Event)
    samples: list[tuple[int, float, float]] = field(default_factory=list)
    missing_workers: list[float] = field(default_factory=list)

    def __call__(self) -> None:
        """Until it is over."""
        for share, act in ((1 / 3, self._lose), (1 / 2, self._gain), (1.0, lambda: None)):
            while (count_now := count_done(self.folder)) < share * self.count and not self.end.wait(0.5):
                self.samples.append((count_now, resident(os.getpid()), resident(self.processes[0].pid)))
            act()

    def _lose(self) -> None:
        end_process(self.processes[1])
        self.missing_workers.append(time.perf_counter())
        print(f"  {count_done(self.folder)} designs: one worker killed", flush=True)

    def _gain(self) -> None:
        self.add()
        self.missing_workers.append(time.perf_counter())
        print(f"  {count_done(self.folder)} designs: one worker added", flush=True)

    def memory(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Of this process and of the scheduler [MB], at a tenth of the designs and at the end."""
        late = [(own, scheduler) for count, own, scheduler in self.samples if count >= self.count / 10] or [
            (0.0, 0.0)
        ]
        return late[0], late[-1]


def resident(process: int) -> float:
    """Resident memory of a process [MB]."""
    with suppress(OSError):
        return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20
    return 0.0


def run(designs: int, workers: int = 2, compare: int = 2500) -> Cost:
    """Run the study on the cluster and part of it here; prints what was measured, and ends if the tables differ."""
    from dask.distributed import Client

    from fem_seal.studies.progress import Lines

    study_of_designs = study(designs)
    count = len(study_of_designs.points)
    with tempfile.TemporaryDirectory() as top, cluster(workers) as (address, processes, add):
        watch = Watch(Path(top) / "cluster", count, processes, add)
        with Client(address) as client:
            client.wait_for_workers(workers, timeout=120)
            client.run(exec, "import fem_seal.studies.responses")
            watcher = threading.Thread(target=watch)
            watcher.start()
            start = time.perf_counter()
            try:
                result = study_of_designs.run(client, folder=watch.folder, progress=Lines())
                wall = time.perf_counter() - start
            finally:
                watch.end.set()
                watcher.join()
        seconds, failures, first, late = result.solve_seconds, result.counts["failed"], *watch.memory()
        cost = seconds / count
        workers_lost, workers_gained = watch.missing_workers
        overhead = (wall * workers - (workers_gained - workers_lost)) / seconds - 1
        print(
            f"{count} designs on {workers} workers over {address.split(':')[0]}: {wall:.0f} s, {1e3 * cost:.2f} ms per "
            f"design in its worker, overhead {100 * overhead:.0f} % of the workers that were there, one missing for "
            f"{workers_gained - workers_lost:.0f} s; failed {failures}, load {os.getloadavg()[0]:.1f}\n"
            f"memory at a tenth and at the end: this process {first[0]:.0f} and {late[0]:.0f} MB, scheduler "
            f"{first[1]:.0f} and {late[1]:.0f} MB",
            flush=True,
        )
        count_compared = compare_here(study_of_designs, Path(top), max(count // compare, 1))
    return Cost(count, failures, count_compared, wall, cost, overhead, late[0], late[0] - first[0])


def compare_here(plan, top: Path, every: int) -> int:
    """Calculate every k-th design in this process, and say how many they are; all must be those of the cluster."""
    from fem_seal.studies.session import _column_types
    from fem_seal.studies.store import create
    from fem_seal.studies.work import DesignSpec, calculate, chunks

    spec, start = DesignSpec.of(plan), time.perf_counter()
    store = create(top / "here" / "study.sqlite", _column_types(plan), plan.output_names)
    with closing(store):
        for chunk in chunks(spec, plan.points[::every]):
            store.write(calculate(spec, chunk))
    with closing(sqlite3.connect(store.path)) as file:
        file.execute("ATTACH ? AS far", (str(top / "cluster" / "study.sqlite"),))
        columns = [row[1] for row in file.execute("PRAGMA table_info(point)") if row[1] != "seconds"]
        equal = " AND ".join(f'one."{name}" IS other."{name}"' for name in columns)
        (count,) = file.execute("SELECT count(*) FROM main.point").fetchone()
        query = (
            f"SELECT count(*) FROM main.point one JOIN far.point other ON one.key = other.key WHERE {equal}"
        )
        (same,) = file.execute(query).fetchone()
    print(
        f"{same} of {count} designs calculated here as well, in {time.perf_counter() - start:.0f} s, are equal in all "
        f"{len(columns)} columns, to the last bit",
        flush=True,
    )
    if same != count:
        raise RuntimeError(f"the tables differ in {count - same} designs")
    return int(count)


def main() -> None:
    """Ask for the numbers."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("designs", type=int, nargs="?", default=2500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--compare", type=int, default=2500, help="designs that are calculated here as well")
    options = parser.parse_args()
    run(options.designs, options.workers, options.compare)


if __name__ == "__main__":
    main()
