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


def ended(process: subprocess.Popen[bytes]) -> None:
    """Kill a process with all that it has started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def cluster(workers: int):
    """Address of a scheduler with workers, their processes (the scheduler first), and how to start one more."""
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder) / "scheduler.json"
        processes = [dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                          "--scheduler-file", str(told))]  # fmt: skip

        def add() -> subprocess.Popen[bytes]:
            processes.append(dask("worker", "--scheduler-file", str(told), "--nthreads", "1", "--no-dashboard",
                                  "--local-directory", folder))  # fmt: skip
            return processes[-1]

        try:
            while not told.exists():
                time.sleep(0.1)
            for _ in range(workers):
                add()
            yield json.loads(told.read_text())["address"], processes, add
        finally:
            for process in reversed(processes):
                ended(process)


def done(folder: Path) -> int:
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
    over: threading.Event = field(default_factory=threading.Event)
    seen: list[tuple[int, float, float]] = field(default_factory=list)
    missing: list[float] = field(default_factory=list)

    def __call__(self) -> None:
        """Until it is over."""
        for share, act in ((1 / 3, self._lose), (1 / 2, self._gain), (1.0, lambda: None)):
            while (now := done(self.folder)) < share * self.count and not self.over.wait(0.5):
                self.seen.append((now, resident(os.getpid()), resident(self.processes[0].pid)))
            act()

    def _lose(self) -> None:
        ended(self.processes[1])
        self.missing.append(time.perf_counter())
        print(f"  {done(self.folder)} designs: one worker killed", flush=True)

    def _gain(self) -> None:
        self.add()
        self.missing.append(time.perf_counter())
        print(f"  {done(self.folder)} designs: one worker added", flush=True)

    def memory(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Of this process and of the scheduler [MB], at a tenth of the designs and at the end."""
        late = [(own, scheduler) for now, own, scheduler in self.seen if now >= self.count / 10] or [
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

    asked = study(designs)
    count = len(asked.points)
    with tempfile.TemporaryDirectory() as top, cluster(workers) as (address, processes, add):
        watch = Watch(Path(top) / "cluster", count, processes, add)
        with Client(address) as client:
            client.wait_for_workers(workers, timeout=120)
            client.run(exec, "import fem_seal.studies.responses")
            watcher = threading.Thread(target=watch)
            watcher.start()
            start = time.perf_counter()
            try:
                result = asked.run(client, folder=watch.folder, progress=Lines())
                wall = time.perf_counter() - start
            finally:
                watch.over.set()
                watcher.join()
        spent, failed, early, late = result.solve_seconds, result.counts["failed"], *watch.memory()
        cost = spent / count
        lost, gained = watch.missing
        overhead = (wall * workers - (gained - lost)) / spent - 1
        print(
            f"{count} designs on {workers} workers over {address.split(':')[0]}: {wall:.0f} s, {1e3 * cost:.2f} ms per "
            f"design in its worker, overhead {100 * overhead:.0f} % of the workers that were there, one missing for "
            f"{gained - lost:.0f} s; failed {failed}, load {os.getloadavg()[0]:.1f}\n"
            f"memory at a tenth and at the end: this process {early[0]:.0f} and {late[0]:.0f} MB, scheduler "
            f"{early[1]:.0f} and {late[1]:.0f} MB",
            flush=True,
        )
        compared = compare_here(asked, Path(top), max(count // compare, 1))
    return Cost(count, failed, compared, wall, cost, overhead, late[0], late[0] - early[0])


def compare_here(asked, top: Path, every: int) -> int:
    """Calculate every k-th design in this process, and say how many they are; all must be those of the cluster."""
    from fem_seal.studies.session import _column_types
    from fem_seal.studies.store import create
    from fem_seal.studies.work import DesignSpec, calculate, chunks

    spec, start = DesignSpec.of(asked), time.perf_counter()
    store = create(top / "here" / "study.sqlite", _column_types(asked), asked.output_names)
    with closing(store):
        for chunk in chunks(spec, asked.points[::every]):
            store.write(calculate(spec, chunk))
    with closing(sqlite3.connect(store.path)) as file:
        file.execute("ATTACH ? AS far", (str(top / "cluster" / "study.sqlite"),))
        columns = [row[1] for row in file.execute("PRAGMA table_info(point)") if row[1] != "seconds"]
        equal = " AND ".join(f'one."{name}" IS other."{name}"' for name in columns)
        (here,) = file.execute("SELECT count(*) FROM main.point").fetchone()
        query = (
            f"SELECT count(*) FROM main.point one JOIN far.point other ON one.key = other.key WHERE {equal}"
        )
        (same,) = file.execute(query).fetchone()
    print(
        f"{same} of {here} designs calculated here as well, in {time.perf_counter() - start:.0f} s, are equal in all "
        f"{len(columns)} columns, to the last bit",
        flush=True,
    )
    if same != here:
        raise RuntimeError(f"the tables differ in {here - same} designs")
    return int(here)


def main() -> None:
    """Ask for the numbers."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("designs", type=int, nargs="?", default=2500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--compare", type=int, default=2500, help="designs that are calculated here as well")
    given = parser.parse_args()
    run(given.designs, given.workers, given.compare)


if __name__ == "__main__":
    main()
