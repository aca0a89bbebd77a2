"""Where chunks of designs are calculated: in this process, or on a dask cluster."""

from __future__ import annotations

import logging
import signal
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Protocol

from fem_seal.errors import ClusterError, InputError, Problem
from fem_seal.studies.cluster import Cluster
from fem_seal.studies.time_limit import OvertimeError, ended_after, slow_line
from fem_seal.studies.work import Chunk, Recipe, calculate, overtime_row

if TYPE_CHECKING:
    import numpy as np
    from dask.distributed import Client
    from numpy.typing import NDArray

    from fem_seal.studies.store import Row

    FloatArray = NDArray[np.float64]

_HERE = "127.0.0.1"
# Longest wait for a worker [s]: a process that died has its successor in seconds, a batch job waits for its turn.
_OWN_PATIENCE, _FOREIGN_PATIENCE = 120.0, 12 * 3600.0


class Pool(Protocol):
    """Something that calculates chunks."""

    def results(self, recipe: Recipe, chunks: Iterable[Chunk]) -> Iterator[list[Row]]:
        """Rows of each chunk, in any order."""
        ...


class OwnProcess:
    """Calculates here, one design after the other.

    Parameters
    ----------
    note : callable
        Told of designs that take long.
    stuck : callable
        Given the row of a design that reached its time limit and does not stop.
    """

    def __init__(
        self, note: Callable[[str], None] = lambda text: None, stuck: Callable[[Row], None] = lambda row: None
    ) -> None:
        self._note = note
        self._stuck = stuck

    def results(self, recipe: Recipe, chunks: Iterable[Chunk]) -> Iterator[list[Row]]:
        """See `Pool`."""
        # the limit is that of designs, not of loading what calculates them
        import fem_seal.studies.evaluate  # noqa: F401

        for chunk in chunks:
            for point in chunk.points:
                yield self._rows(recipe, point)

    def _rows(self, recipe: Recipe, point: FloatArray) -> list[Row]:
        def slow(seconds: float) -> None:
            self._note(slow_line(recipe.named(point), seconds, recipe.time_limit))

        def stuck() -> None:
            self._stuck(overtime_row(recipe, point))

        try:
            with ended_after(recipe.time_limit, slow, stuck):
                return calculate(recipe, Chunk(point[None]))
        except OvertimeError:
            return [overtime_row(recipe, point)]


@contextmanager
def pool(
    client: Client | None,
    workers: int | None,
    scheduler: str | None,
    retries: int,
    note: Callable[[str], None] = lambda text: None,
    stuck: Callable[[Row], None] = lambda row: None,
) -> Iterator[Pool]:
    """The pool asked for; a cluster or a connection made for it is closed at the end.

    Parameters
    ----------
    client : dask.distributed.Client, optional
        The user's own.
    workers : int, optional
        Processes of a local cluster, one per core unless given; 0 for this process.
    scheduler : str, optional
        Address of a running scheduler, ``tcp://...``.
    retries, note
        See `fem_seal.studies.cluster.Cluster`.
    stuck
        See `OwnProcess`.

    Raises
    ------
    InputError
        If there is no scheduler at the address, workers are asked of it, or dask is not installed.
    ClusterError
        If the processes do not start.
    """
    if scheduler is not None and workers is not None:
        raise InputError(
            Problem(
                "--workers", "not with --scheduler, which has workers of its own; remove it", str(workers)
            )
        )
    if client is None and (scheduler is not None or workers != 0):
        _check_dask()
    if client is not None:
        yield Cluster(client, retries, _FOREIGN_PATIENCE, note)
    elif scheduler is not None:
        with _connected(scheduler) as own:
            yield Cluster(own, retries, _FOREIGN_PATIENCE, note)
    elif workers == 0:
        yield OwnProcess(note, stuck)
    else:
        with local_client(workers or _cores()) as own:
            yield Cluster(own, retries, _OWN_PATIENCE, note)


@contextmanager
def _connected(scheduler: str) -> Iterator[Client]:
    from dask.distributed import Client

    try:
        client = Client(scheduler, timeout=20)
    except (OSError, ValueError, TimeoutError) as error:
        message = f"there is no dask scheduler ({error}); start one with: dask scheduler"
        raise InputError(Problem("--scheduler", message, scheduler)) from None
    with client:
        yield client


@contextmanager
def local_client(workers: int) -> Iterator[Client]:
    """A cluster of processes on this machine.

    Parameters
    ----------
    workers : int
        Processes, one thread each.

    Raises
    ------
    ClusterError
        If they do not start.
    """
    import dask
    from dask.distributed import Client, LocalCluster

    settings = {
        # whoever was on a worker that died is tried again by itself, see `Cluster`
        "distributed.scheduler.allowed-failures": 0,
        "distributed.comm.timeouts.connect": "60s",
        # a worker that is paused for its memory never goes on if nothing frees it; one that is killed has a successor
        "distributed.worker.memory.pause": False,
        "distributed.worker.memory.spill": False,
        "distributed.worker.profile.enabled": False,
        # dask makes workers give back memory at once, which costs a third of their time with arrays of this size
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 2**28,
        "distributed.nanny.pre-spawn-environ.MALLOC_MMAP_THRESHOLD_": 2**28,
        # the death of a worker is told in the table and not in the terminal
        "logging.distributed": "error",
    }
    with dask.config.set(settings), ExitStack() as opened:
        with _uninterrupted():
            try:
                cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    # whoever reaches a scheduler can have it run anything: nobody but this machine does
                    host=_HERE,
                    dashboard_address=None,
                    # what is left of the dashboard takes a port all the same, and warns if that is not free
                    scheduler_kwargs={"dashboard_address": f"{_HERE}:0"},
                    silence_logs=logging.CRITICAL,
                )
            except RuntimeError as error:
                raise ClusterError(
                    f"the worker processes do not start ({error}). A script that runs a study needs "
                    'if __name__ == "__main__": around it; workers = 0 calculates without them'
                ) from None
            client = opened.enter_context(Client(opened.enter_context(cluster)))
        yield client


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl-C waits until the end of this; processes that are started here, and their successors, never hear it.

    A terminal sends the signal to all of them, but it is the one that started them that ends them.
    """
    if not hasattr(signal, "pthread_sigmask"):  # not on this system: there the workers complain
        yield
        return
    from multiprocessing import resource_tracker

    # threads and processes inherit what is blocked, but where Python starts this helper, it is let through again
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _check_dask() -> None:
    try:
        import dask.distributed  # noqa: F401
    except ImportError as error:
        raise InputError(
            Problem("study", f'needs dask ({error}); install it with: pip install "fem-seal[studies]"')
        ) from None


def _cores() -> int:
    import os

    # what this process may use, which in a container or under a job scheduler is less than the machine has
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
