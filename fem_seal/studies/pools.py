"""Where chunks of designs are calculated: in this process, or on a dask cluster."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol

from fem_seal.errors import InputError, Problem
from fem_seal.studies.work import Chunk, Recipe, calculate, failed_row

if TYPE_CHECKING:
    from dask.distributed import Client

    from fem_seal.studies.store import Row

# Chunks on the way per worker: enough that none waits for the next one, few enough that memory stays flat.
_AHEAD = 3


class Pool(Protocol):
    """Something that calculates chunks."""

    def results(self, recipe: Recipe, chunks: Iterable[Chunk]) -> Iterator[list[Row]]:
        """Rows of each chunk, in any order."""
        ...


class OwnProcess:
    """Calculates here, one design after the other."""

    def results(self, recipe: Recipe, chunks: Iterable[Chunk]) -> Iterator[list[Row]]:
        """See `Pool`."""
        for chunk in chunks:
            for point in chunk.points:
                yield calculate(recipe, Chunk(point[None]))


class Cluster:
    """Calculates on the workers of a dask cluster.

    Parameters
    ----------
    client : dask.distributed.Client
    retries : int
        How often designs are tried again after their worker died.
    """

    def __init__(self, client: Client, retries: int) -> None:
        self._client = client
        self._retries = retries

    def results(self, recipe: Recipe, chunks: Iterable[Chunk]) -> Iterator[list[Row]]:
        """See `Pool`.

        Only a few chunks per worker are on the way at a time. When workers die, dask gives their chunks to others. If
        it gives up on a chunk, its designs are tried one by one, so that one design that kills every worker costs
        nothing but itself.
        """
        from dask.distributed import as_completed
        from distributed.scheduler import KilledWorker

        parts = _parts(list(chunks), max(len(self._client.nthreads()), 1))
        on_the_way: dict[Any, tuple[Chunk, int, int]] = {}
        finished = as_completed()

        def send(chunk: Chunk, part: int, attempt: int = 0) -> None:
            addresses = sorted(self._client.nthreads())
            near = [addresses[part % len(addresses)]] if addresses else None
            future = self._client.submit(
                calculate, recipe, chunk, pure=False, workers=near, allow_other_workers=True
            )
            on_the_way[future] = (chunk, part, attempt)
            finished.add(future)

        def send_next(part: int) -> None:
            chunk = _next(parts, part)
            if chunk is not None:
                send(chunk, part)

        for part in range(len(parts)):
            for _ in range(_AHEAD):
                send_next(part)
        while on_the_way:
            future = next(finished)
            chunk, part, attempt = on_the_way.pop(future)
            if future.status == "finished":
                yield future.result()
            elif attempt >= self._retries or not _lost(future, KilledWorker):
                reason = _why(future)
                yield [failed_row(recipe, point, reason) for point in chunk.points]
            else:
                for point in chunk.points:
                    send(Chunk(point[None]), part, attempt + 1 if len(chunk.points) == 1 else attempt)
            future.release()
            send_next(part)


def _parts(chunks: list[Chunk], workers: int) -> list[deque[Chunk]]:
    """Neighbouring chunks for each worker: what one of them has worked out the others need not work out again."""
    ends = [len(chunks) * n // workers for n in range(workers + 1)]
    return [deque(chunks[start:end]) for start, end in pairwise(ends)]


def _next(parts: list[deque[Chunk]], part: int) -> Chunk | None:
    """The next chunk of a part; when it is used up, the last one of the part that has most left."""
    if parts[part]:
        return parts[part].popleft()
    longest = max(parts, key=len)
    return longest.pop() if longest else None


def _lost(future: Any, killed: type[Exception]) -> bool:
    """Whether the worker and not the calculation failed."""
    return future.status in ("lost", "cancelled") or isinstance(future.exception(), killed)


def _why(future: Any) -> str:
    if future.status == "error":
        from distributed.scheduler import KilledWorker

        error = future.exception()
        if isinstance(error, KilledWorker):
            return "every worker that calculated it died; it may need more memory than a worker has"
        return f"{type(error).__name__}: {error}"
    return f"its calculation was {future.status}"


@contextmanager
def pool(client: Client | None, workers: int | None, scheduler: str | None, retries: int) -> Iterator[Pool]:
    """The pool asked for; a cluster or a connection made for it is closed at the end.

    Parameters
    ----------
    client : dask.distributed.Client, optional
        The user's own.
    workers : int, optional
        Processes of a local cluster, one per core unless given; 0 for this process.
    scheduler : str, optional
        Address of a running scheduler, ``tcp://...``.
    retries : int
        See `Cluster`.

    Raises
    ------
    InputError
        If there is no scheduler at the address, or dask is not installed.
    """
    if client is not None:
        yield Cluster(client, retries)
    elif workers == 0 and scheduler is None:
        yield OwnProcess()
    else:
        with _own_client(workers, scheduler, retries) as own:
            yield Cluster(own, retries)


@contextmanager
def _own_client(workers: int | None, scheduler: str | None, retries: int) -> Iterator[Client]:
    try:
        from dask.distributed import Client
    except ImportError as error:
        raise InputError(
            Problem("study", f'needs dask ({error}); install it with: pip install "fem-seal[studies]"')
        ) from None
    if scheduler is None:
        with local_client(workers or _cores(), retries=retries) as own:
            yield own
        return
    try:
        connected = Client(scheduler, timeout=20)
    except (OSError, ValueError, TimeoutError) as error:
        message = f"there is no dask scheduler ({error}); start one with: dask scheduler"
        raise InputError(Problem("--scheduler", message, scheduler)) from None
    with connected:
        yield connected


@contextmanager
def local_client(workers: int, *, retries: int) -> Iterator[Client]:
    """A cluster of processes on this machine.

    Parameters
    ----------
    workers : int
        Processes, one thread each.
    retries : int
        How many workers may die on a chunk before dask gives it back.
    """
    import dask
    from dask.distributed import Client, LocalCluster

    settings = {
        "distributed.scheduler.allowed-failures": retries,
        "distributed.comm.timeouts.connect": "60s",
        # dask makes workers give back memory at once, which costs a third of their time with arrays of this size
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 2**28,
        "distributed.nanny.pre-spawn-environ.MALLOC_MMAP_THRESHOLD_": 2**28,
        # the death of a worker is told in the table and not in the terminal
        "logging.distributed": "error",
    }
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            dashboard_address=None,
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster) as own,
    ):
        yield own


def _cores() -> int:
    import os

    # what this process may use, which in a container or under a job scheduler is less than the machine has
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
