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

        Only a few chunks per worker are on the way at a time. When workers die, dask gives their chunks to others. The
        designs of a chunk that dask gives up are tried at the end, one by one with nothing else on the way: one design
        that kills every worker then costs nothing but itself.
        """
        parts = _parts(list(chunks), max(len(self._client.nthreads()), 1))
        suspects = deque[tuple[Chunk, int]]()
        on_the_way = _OnTheWay(self._client, recipe)
        for part in range(len(parts)):
            for _ in range(_AHEAD):
                on_the_way.send(_next(parts, part), part)
        while on_the_way or suspects:
            if not on_the_way:
                chunk, attempt = suspects.popleft()
                on_the_way.send(chunk, 0, attempt)
            future, chunk, part, attempt = on_the_way.next()
            if future.status == "finished":
                yield future.result()
            elif _lost(future) and attempt < max(self._retries, 1):
                suspects.extend((Chunk(point[None]), attempt + 1) for point in chunk.points)
            else:
                reason = _why(future)
                yield [failed_row(recipe, point, reason) for point in chunk.points]
            future.release()
            on_the_way.send(_next(parts, part), part)


class _OnTheWay:
    """Chunks that workers have been given and have not given back."""

    def __init__(self, client: Client, recipe: Recipe) -> None:
        from dask.distributed import as_completed

        self._client = client
        self._recipe = recipe
        self._finished = as_completed()
        self._chunks: dict[Any, tuple[Chunk, int, int]] = {}

    def __bool__(self) -> bool:
        return bool(self._chunks)

    def send(self, chunk: Chunk | None, part: int, attempt: int = 0) -> None:
        """Give a chunk to the worker that has its neighbours, or to another one if that is busy."""
        if chunk is None:
            return
        addresses = sorted(self._client.nthreads())
        near = [addresses[part % len(addresses)]] if addresses else None
        future = self._client.submit(
            calculate, self._recipe, chunk, pure=False, workers=near, allow_other_workers=near is not None
        )
        self._chunks[future] = (chunk, part, attempt)
        self._finished.add(future)

    def next(self) -> tuple[Any, Chunk, int, int]:
        """Wait for one: its future, the chunk, its part, and how often it was tried before."""
        future = next(self._finished)
        return (future, *self._chunks.pop(future))


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


def _lost(future: Any) -> bool:
    """Whether the worker and not the calculation failed."""
    from distributed.scheduler import KilledWorker

    return future.status in ("lost", "cancelled") or isinstance(future.exception(), KilledWorker)


def _why(future: Any) -> str:
    if _lost(future):
        return "every worker that calculated it died; it may need more memory than a worker has"
    error = future.exception()
    return f"{type(error).__name__}: {error}"


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
