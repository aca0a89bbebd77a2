"""A study on a cluster as it is started by hand, one worker lost and one added: python benchmarks/bench_cluster.py [N].

Scheduler and workers are processes of their own that speak TCP. At a third of the designs one worker is killed, at half
of them another one is started. The table must be that of the same study in this process, bit for bit.
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
from contextlib import contextmanager, suppress
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

CASE = Path(__file__).parent.parent / "examples" / "ball_cone.toml"
# dask gives back memory after every solve unless it is told not to (guide/studies in the manual)
ENVIRONMENT = {"MALLOC_TRIM_THRESHOLD_": str(2**28), "MALLOC_MMAP_THRESHOLD_": str(2**28)}


def study(designs: int):
    """Height of the roughness and fluid pressure, every combination."""
    from fem_seal import Study

    side = round(designs**0.5)
    return Study(
        CASE,
        responses=["peak_pressure_Pa", "fwhm_m", "leak_rate_m3_per_s"],
        parameters={
            "roughness.spectrum.rms_height": {"start": "0.5 um", "stop": "5 um", "num": side},
            "load.fluid_pressure": {"start": "1 bar", "stop": "50 bar", "num": round(designs / side)},
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
    """Address of a scheduler with workers, and how to start one more."""
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
            yield json.loads(told.read_text())["address"], processes[1], add
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


def main() -> None:
    """Run the study on the cluster and here, and compare."""
    from dask.distributed import Client

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("designs", type=int, nargs="?", default=2500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--compare", type=int, default=2500, help="designs that are calculated here as well")
    given = parser.parse_args()
    asked = study(given.designs)
    count = len(asked.points)
    with tempfile.TemporaryDirectory() as top, cluster(given.workers) as (address, victim, add):
        folder, over = Path(top) / "cluster", threading.Event()

        def trouble() -> None:
            while done(folder) < count / 3 and not over.wait(0.2):
                pass
            ended(victim)
            print(f"  {done(folder)} designs: one worker killed", flush=True)
            while done(folder) < count / 2 and not over.wait(0.2):
                pass
            add()
            print(f"  {done(folder)} designs: one worker added", flush=True)

        with Client(address) as client:
            client.wait_for_workers(given.workers, timeout=120)
            watcher = threading.Thread(target=trouble)
            watcher.start()
            start = time.perf_counter()
            result = asked.run(client, folder=folder)
            wall = time.perf_counter() - start
            over.set()
            watcher.join()
        table, designs = result.table, result.solve_seconds
        overhead = wall * given.workers / designs - 1
        print(
            f"{count} designs on {given.workers} workers over {address.split(':')[0]}: {wall:.0f} s, "
            f"{1e3 * designs / count:.1f} ms per design in its worker, overhead {100 * overhead:.0f} % "
            f"(the lost worker's share among it), failed {result.counts['failed']}, load {os.getloadavg()[0]:.1f}"
        )
        every = max(count // given.compare, 1)
        from fem_seal.studies.work import Chunk, Recipe, calculate

        recipe = Recipe.of(asked)
        names = list(asked.responses)
        here = {row.inputs: row.outputs for row in calculate(recipe, Chunk(asked.points[::every]))}
        inputs = [one.name for one in asked.parameters]
        there = {
            tuple(map(float, row[: len(inputs)])): tuple(map(float, row[len(inputs) :]))
            for row in table[[*inputs, *names]].to_numpy().tolist()
        }
        same = sum(there[key] == values[: len(names)] for key, values in here.items())
        print(f"{same} of {len(here)} designs calculated here as well are equal to the last digit")
        if same != len(here):
            sys.exit("the tables differ")


if __name__ == "__main__":
    main()
