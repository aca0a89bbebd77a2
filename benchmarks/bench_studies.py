"""Speed, sharing and memory of design studies: python benchmarks/bench_studies.py [--quick]."""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

CASE = Path(__file__).parent.parent / "examples" / "ball_cone.toml"


@dataclass(frozen=True)
class Cost:
    """What a study took.

    Parameters
    ----------
    designs : int
    wall : float
        Time without the start of the workers [s].
    processor : float
        Processor time of the workers and of the process that gives them their work, divided by the number of workers
        [s]: on a busy machine, where the wall time says little, what it would be if nothing else ran.
    """

    designs: int
    wall: float
    processor: float


def run(name, workers, goal=None, **tables):
    """The cost of a study; prints all that was measured."""
    from fem_seal import Study
    from fem_seal.studies.machine import LocalWorkers
    from fem_seal.studies.session import run_study

    study = Study(CASE, **tables)
    with tempfile.TemporaryDirectory() as folder, closing(LocalWorkers(workers)) as processes:
        for worker in processes.names():
            processes.call(worker, ready).result()
        time_before, own_time = processor_time(processes), time.process_time()
        start = time.perf_counter()
        result = run_study(study, processes, folder=folder)
        wall, own_time = time.perf_counter() - start, time.process_time() - own_time
        worker_time = processor_time(processes) - time_before
        count, designs, failures = len(study.points), result.solve_seconds, result.counts["failed"]
    # what the designs took holds the building of their cases, which is the study's own business
    building = case_time(study) * count * designs / worker_time
    overhead = (wall * workers - designs + building) / (designs - building)
    print(
        f"{name:38s} {workers} workers {count:6d} designs {wall:6.1f} s"
        f"{f' (goal {goal:.0f} s)' if goal else '':14s} {count / wall:5.1f}/s  "
        f"processor {(worker_time + own_time) / workers:6.1f} s  "
        f"overhead {100 * overhead:4.1f} %, of it cases {100 * building / (designs - building):4.1f} %  "
        f"failed {failures}  load {os.getloadavg()[0]:.1f}",
        flush=True,
    )
    return Cost(count, wall, (worker_time + own_time) / workers)


def processor_time(processes):
    """Of all workers [s]."""
    return sum(processes.call(worker, time.process_time).result() for worker in processes.names())


def case_time(study, sample=500):
    """Processor time that the case of a design takes [s]."""
    points = study.points[:: max(len(study.points) // sample, 1)]
    start = time.process_time()
    for point in points:
        study.case_of(point)
    return (time.process_time() - start) / len(points)


def ready():
    """Load in a worker what the designs need."""
    import gmsh  # noqa: F401

    import fem_seal.studies.responses  # noqa: F401


def memory(points):
    """Of the coordinating process, while rows stream through it, with workers that solve nothing.

    Growth of its resident memory over the last nine tenths [MB], and its processor time per design [s].
    """
    from fem_seal import Study
    from fem_seal.studies import progress, session, work
    from fem_seal.studies import store as studies_store
    from fem_seal.studies.store import Row

    class Instant:
        """A pool whose designs take no time."""

        def results(self, spec, chunks):
            for n, chunk in enumerate(chunks):
                if n % 50 == 0:
                    samples.append(resident())
                yield [Row(spec.key(p), spec.inputs(p), outputs, None, 0.0) for p in chunk]

    samples = []
    study = Study(CASE, **latin(points))
    spec, outputs = work.DesignSpec.of(study), (1.0,) * len(study.output_names)
    with tempfile.TemporaryDirectory() as folder:
        store = studies_store.create(
            Path(folder) / "study.sqlite", session._column_types(study), study.output_names
        )
        store.set_design(spec.key(point) for point in study.points)
        start = time.process_time()
        session._fill(spec, store, Instant(), study, progress.Progress())
        seconds = time.process_time() - start
        store.close()
    rest = samples[len(samples) // 10 :]
    print(
        f"coordinator, {points} designs: resident {rest[0]:.0f} MB after a tenth, {rest[-1]:.0f} MB at the end; "
        f"{1e6 * seconds / points:.0f} us per design for hashing, ordering and storing"
    )
    return rest[-1] - rest[0], seconds / points


def resident():
    """Resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def latin(num):
    """Roughness and pressure, every design another surface."""
    return {
        "parameters": {
            "roughness.spectrum.rms_height": {"distribution": "log-uniform", "low": "0.5 um", "high": "5 um"},
            "load.fluid_pressure": {"distribution": "log-uniform", "low": "1 bar", "high": "50 bar"},
        },
        "design": {"kind": "latin-hypercube", "num": num},
    }


def grid(side):
    """Roughness and pressure, every combination."""
    return {
        "parameters": {
            "roughness.spectrum.rms_height": {"start": "0.5 um", "stop": "5 um", "num": side},
            "load.fluid_pressure": {"start": "1 bar", "stop": "50 bar", "num": side},
        }
    }


def geometries(num):
    """Every design another pair of bodies."""
    return {
        "changes": {"load.fluid_pressure": "10 bar"},
        "parameters": {
            "seat.angle": {"distribution": "uniform", "low": "30 deg", "high": "60 deg"},
            "closure.radius": {"distribution": "uniform", "low": "10 mm", "high": "30 mm"},
        },
        "design": {"kind": "latin-hypercube", "num": num},
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="a tenth of the designs")
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    options = parser.parse_args()
    part = 10 if options.quick else 1
    costs = {}
    for workers in options.workers:
        side = int((10000 // part) ** 0.5)
        costs[workers] = [
            run("roughness and pressure, grid", workers, 15 / part, **grid(side)),
            run("geometries", workers, None, **geometries(200 // part)),
        ]
    least, *_, top = options.workers
    for name, few, many in zip(("one geometry", "geometries"), costs[least], costs[top], strict=True):
        wall, processor = few.wall / many.wall, few.processor / many.processor
        print(
            f"scaling from {least} to {top} workers, {name}: {wall:.2f} by wall time, {processor:.2f} by processor time"
        )
    run("roughness and pressure, latin hypercube", top, 15 / part, **latin(10000 // part))
    run("geometries", top, 90 / part, **geometries(1000 // part))
    memory(100_000)


if __name__ == "__main__":
    main()
