"""Executors for chunks of designs: this process, or a dask cluster."""

from __future__ import annotations

import logging
import os
import signal
import sys
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from itertools import pairwise
from queue import Empty, SimpleQueue
from threading import Event
from typing import TYPE_CHECKING, Any, TypeAlias
from uuid import uuid4

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.case.words import problem, sentence
from fem_seal.errors import ClusterError, InputError
from fem_seal.files import own_tables
from fem_seal.processes import usable_cores
from fem_seal.studies.store import Row
from fem_seal.studies.tables import named
from fem_seal.studies.time_limit import Block, OvertimeError, Watch, ended_after, slow_line
from fem_seal.studies.work import DesignSpec, calculate, failed_row, overtime_row
from fem_seal.units import duration
from leak.extras import needed

if TYPE_CHECKING:
    from dask.distributed import Client, Worker


_HERE = "127.0.0.1"
# Longest wait for a worker [s]: a process that died has its successor in seconds, a batch job waits for its turn.
_OWN_PATIENCE, _FOREIGN_PATIENCE = 120.0, 12 * 3600.0


@dataclass(frozen=True)
class OwnProcess:
    """Calculates here, one design after the other.

    Parameters
    ----------
    note : callable
        Told of designs that take long.
    stuck : callable
        Given the row of a design that reached its time limit and does not stop.
    """

    note: Callable[[str], None]
    stuck: Callable[[Row], None]

    def results(self, recipe: DesignSpec, chunks: Iterable[FloatArray]) -> Iterator[list[Row]]:
        """Rows of the designs, one by one."""
        # the limit is that of designs, not of loading what calculates them
        import fem_seal.studies.responses  # noqa: F401

        for chunk in chunks:
            for point in chunk:
                yield self._rows(recipe, point)

    def _rows(self, recipe: DesignSpec, point: FloatArray) -> list[Row]:
        def slow(seconds: float) -> None:
            self.note(slow_line(named(recipe.parameters, point), seconds, recipe.time_limit))

        try:
            with ended_after(recipe.time_limit, slow, lambda: self.stuck(overtime_row(recipe, point))):
                return calculate(recipe, point[None])
        except OvertimeError:
            return [overtime_row(recipe, point)]


@contextmanager
def pool(
    client: Client | None,
    workers: int | None,
    scheduler: str | None,
    retries: int,
    note: Callable[[str], None],
    stuck: Callable[[Row], None],
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
        See `fem_seal.studies.pools.Cluster`.
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
        raise InputError(problem("study_workers_of_scheduler", workers=workers))
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
        with local_client(workers or usable_cores()) as own:
            yield Cluster(own, retries, _OWN_PATIENCE, note)


def _connected(scheduler: str) -> Client:
    from dask.distributed import Client

    try:
        return Client(scheduler, timeout=20)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(problem("study_no_scheduler", error=error, scheduler=scheduler)) from None


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

    settings = {**own_tables("dask.toml")}
    if _WARM:
        settings["distributed.worker.multiprocessing-method"] = "forkserver"
    with dask.config.set(settings), ExitStack() as opened:
        with _uninterrupted():
            _warm()
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
                raise ClusterError(sentence("study_no_workers", error=error)) from None
            client = opened.enter_context(Client(opened.enter_context(cluster)))
        yield client


# Here every worker is a copy of one process that has loaded what they all need, instead of loading it itself. On macOS
# a copy may crash in the system's own libraries.
_WARM = sys.platform == "linux"


def _warm() -> None:
    """Name what workers find loaded."""
    if _WARM:
        import multiprocessing

        from distributed.utils import get_mp_context

        # names the modules that it wants itself, the first time that it is called
        get_mp_context()
        multiprocessing.set_forkserver_preload(["distributed.nanny", "fem_seal.studies.responses"])


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl-C waits until the end of this; processes that are started here, and their successors, never hear it.

    A terminal sends the signal to all of them, but it is the one that started them that ends them.
    """
    if sys.platform == "win32":  # there the workers complain
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
        raise InputError.at("study", needed("studies", error)) from None


# Chunks on the way per worker: enough that none waits for the next one, few enough that memory stays flat.
_AHEAD = 3
# Longest silence before the cluster is asked whether it still knows the chunks [s].
_HEARTBEAT = 2.0
# Longest wait for one answer of a cluster that is there [s].
_ANSWER = 30.0
# Between the last words of a worker and its end [s].
_FAREWELL = 2.0
KEPT = "the designs that are done are kept, --resume (resume=True) continues"


@dataclass(frozen=True)
class Cluster:
    """Calculates on the workers of a dask cluster.

    Parameters
    ----------
    client : dask.distributed.Client
    retries : int
        How often designs are tried again after their worker died.
    patience : float
        Longest time without any worker [s]; in a queue of batch jobs the first one may take hours.
    note : callable
        Told if there are no workers.
    """

    client: Client
    retries: int
    patience: float
    note: Callable[[str], None] = lambda text: None

    def results(self, recipe: DesignSpec, chunks: Iterable[FloatArray]) -> Iterator[list[Row]]:
        """Rows of each chunk, in any order.

        Only a few chunks per worker are on the way at a time. When workers die, dask gives their chunks to others. The
        designs of a chunk that dask gives up are tried at the end, one by one with nothing else on the way: one design
        that kills every worker then costs nothing but itself. A design that reaches its time limit is known by name: it
        is a failed row, its worker ends itself, and the rest of its chunk is calculated like any other.

        Raises
        ------
        ClusterError
            If the scheduler is gone, no worker comes, or workers cannot calculate at all.
        InputError
            If a file of the designs has changed.
        """
        on_the_way = _Pending(self, recipe)
        try:
            yield from self._results(recipe, list(chunks), on_the_way)
        finally:
            on_the_way.close()

    def _results(
        self, recipe: DesignSpec, chunks: list[FloatArray], on_the_way: _Pending
    ) -> Iterator[list[Row]]:
        shares, suspects = _WorkQueue(chunks, on_the_way.workers()), deque[tuple[FloatArray, int]]()
        while True:
            for sent in on_the_way.stranded():
                shares.give_back(sent.worker, sent.chunk)
            for worker in on_the_way.with_room():
                chunk = shares.next(worker)
                if chunk is None:
                    break
                on_the_way.send(chunk, worker)
            if not on_the_way:
                if not suspects:
                    return
                suspect, attempt = suspects.popleft()
                on_the_way.send(suspect, None, attempt)
            settled = on_the_way.next()
            if settled is None:
                continue
            sent, rows = settled
            if rows is not None:
                yield rows
            elif any(late := on_the_way.late(sent.chunk)):
                yield [overtime_row(recipe, point) for point in sent.chunk[late]]
                if not all(late):
                    shares.give_back(sent.worker, sent.chunk[np.logical_not(late)])
            elif sent.attempt < self.retries or len(sent.chunk) > 1:
                suspects.extend((point[None], sent.attempt + 1) for point in sent.chunk)
            else:
                reason = "every worker that calculated it died; it may need more memory than a worker has"
                yield [failed_row(recipe, point, reason) for point in sent.chunk]


Pool: TypeAlias = OwnProcess | Cluster


@dataclass(frozen=True)
class _Sent:
    """A chunk that is on the way: meant for a worker, after so many attempts."""

    chunk: FloatArray
    worker: str | None
    attempt: int


@dataclass(frozen=True)
class _Rows:
    """Rows of a chunk on their way back as one object: of a list dask would send each entry by itself."""

    rows: list[Row]


def _calculate_watched(recipe: DesignSpec, chunk: FloatArray, topic: str) -> _Rows:
    """What a worker does: `calculate`, and tell the coordinator of designs that take long."""
    from distributed import get_worker

    # the limit is that of designs, not of loading what calculates them
    import fem_seal.studies.responses  # noqa: F401

    worker = get_worker()
    designs = [_watched_design(recipe, point, worker, topic) for point in chunk]

    def several() -> Block:
        # a worker that dies without a word has its designs tried one by one
        return Block(lambda seconds: None, lambda ended: os._exit(1) if worker.nanny is not None else None)

    with Watch(recipe.time_limit) as watch:

        def turn(number: int | None) -> AbstractContextManager[None]:
            return watch.turn(several() if number is None else designs[number])

        return _Rows(calculate(recipe, chunk, turn))


def _watched_design(recipe: DesignSpec, point: FloatArray, worker: Worker, topic: str) -> Block:
    # a worker without a nanny has no successor, and may be a thread of the user's own process
    replaceable = worker.nanny is not None

    def slow(seconds: float) -> None:
        line = slow_line(named(recipe.parameters, point), seconds, recipe.time_limit)
        worker.log_event(topic, {"slow": line})

    def over(ended: Event) -> None:
        said = {"over": point.tolist(), "worker": worker.address, "replaceable": replaceable}
        worker.log_event(topic, said)
        # nothing less ends a design that is deep in a library; first what was told has to reach the coordinator
        if not ended.wait(_FAREWELL) and replaceable:
            os._exit(1)

    return Block(slow, over)


class _Pending:
    """Chunks that workers have been given and have not given back, and which workers are there."""

    def __init__(self, cluster: Cluster, recipe: DesignSpec) -> None:
        self._cluster = cluster
        self._client = cluster.client
        self._recipe = recipe
        self._late = set[tuple[float, ...]]()
        # of this study alone, on a scheduler that may have several
        self._topic = f"fem-seal-{uuid4().hex}"
        self._client.subscribe_topic(self._topic, self._hear)
        self._sent: dict[Any, _Sent] = {}
        # futures, and what workers say of designs that have reached their time limit
        self._settled = SimpleQueue[Any]()
        # chunks that the scheduler did not calculate any more when it was asked last
        self._doubtful = set[str]()
        self._addresses: list[str] = []
        self._last_worker = time.monotonic()
        self._waits = False
        self._next_count = self._next_look = 0.0

    def close(self) -> None:
        """Listen to workers no longer."""
        if self._client.status == "running":
            self._client.unsubscribe_topic(self._topic)

    def __bool__(self) -> bool:
        return bool(self._sent)

    def workers(self) -> list[str]:
        """Addresses of the workers, as they were at most a heartbeat ago.

        Raises
        ------
        ClusterError
            If there has been none for too long.
        """
        now, patience = time.monotonic(), self._cluster.patience
        if now >= self._next_count:
            self._addresses = sorted(self._asked(self._client.scheduler.ncores) or ())
            self._next_count = time.monotonic() + _HEARTBEAT
        if self._addresses:
            self._last_worker, self._waits = now, False
        elif now - self._last_worker > patience:
            raise ClusterError(f"there has been no worker for {patience:.0f} s; {KEPT}")
        elif now - self._last_worker > _ANSWER and not self._waits:
            self._waits = True
            self._cluster.note(f"no worker is there; waiting for one up to {duration(patience)}")
        return self._addresses

    def late(self, chunk: FloatArray) -> list[bool]:
        """Which of its designs have reached their time limit."""
        return [tuple(point) in self._late for point in chunk.tolist()]

    def with_room(self) -> Iterator[str | None]:
        """A worker for each chunk that may be sent; None, for whichever comes, while there is no worker."""
        there = Counter(one.worker for one in self._sent.values())
        addresses: list[str | None] = [*self.workers()] or [None]
        free = _AHEAD * len(addresses) - len(self._sent)
        for worker in addresses:
            for _ in range(min(_AHEAD - there[worker], free)):
                free -= 1
                yield worker

    def send(self, chunk: FloatArray, worker: str | None, attempt: int = 0) -> None:
        """Give a chunk to a worker, or to another one if that is busy or gone."""
        future = self._client.submit(
            _calculate_watched,
            self._recipe,
            chunk,
            self._topic,
            pure=False,
            workers=None if worker is None else [worker],
            allow_other_workers=worker is not None,
        )
        self._sent[future] = _Sent(chunk, worker, attempt)
        future.add_done_callback(self._settled.put)

    def stranded(self) -> list[_Sent]:
        """Chunks that are taken back because dask keeps them for a worker that is gone, though others are there.

        What was meant for the last worker that died waits for that very address, whoever comes after it.
        """
        there = self.workers()
        if not there or time.monotonic() < self._next_look:
            return []
        self._next_look = time.monotonic() + _HEARTBEAT
        meant = [
            one for one, sent in self._sent.items() if sent.worker is not None and sent.worker not in there
        ]
        states = self._states(meant) if meant else {}
        kept = [future for future in meant if states.get(future.key) == "no-worker"]
        for future in kept:
            future.release()
        return [self._sent.pop(future) for future in kept]

    def next(self) -> tuple[_Sent, list[Row] | None] | None:
        """Wait for one: what it was, and its rows, None if its workers died or one of its designs is late.

        After a silence there is none: who has come meanwhile may be given something.
        """
        try:
            future = self._settled.get(timeout=_HEARTBEAT)
        except Empty:
            future = self._fallen()
        if isinstance(future, dict):
            future = self._given_up(tuple(future["over"]), future["worker"], future["replaceable"])
        # what was taken back settles as well
        if future not in self._sent:
            return None
        sent = self._sent.pop(future)
        try:
            return sent, self._rows(future)
        finally:
            future.release()

    def _rows(self, future: Any) -> list[Row] | None:
        from distributed.scheduler import KilledWorker

        if future.status == "finished":
            try:
                calculated: _Rows = future.result(timeout=_ANSWER)
                return calculated.rows
            except Exception:  # calculated, but lost on the way back with the worker that held it
                return None
        error = future.exception(timeout=_ANSWER) if future.status == "error" else None
        if error is None or isinstance(error, KilledWorker):
            return None
        if isinstance(error, InputError):
            raise error
        # a design that fails is a row: what ends up here is the worker's own fault
        message = f"a worker cannot calculate: {type(error).__name__}: {error}"
        raise ClusterError(f"{message}. Install this version of fem-seal where workers run; {KEPT}")

    def _hear(self, event: tuple[float, dict[str, Any]]) -> None:
        """What a worker says; called from the client's own thread."""
        _, said = event
        if "slow" in said:
            self._cluster.note(said["slow"])
        else:
            self._settled.put(said)

    def _given_up(self, point: tuple[float, ...], worker: str, replaceable: bool) -> Any:
        """The chunk of a design that has reached its time limit; None if it is not on the way any more."""
        self._late.add(point)
        meant = [one for one, sent in self._sent.items() if list(point) in sent.chunk.tolist()]
        # or dask would give it to another worker
        self._client.cancel(meant)
        if not replaceable:
            # what it is busy with never ends: it gets nothing more
            self._asked(self._client.scheduler.retire_workers, workers=[worker])
        return meant[0] if meant else None

    def _fallen(self) -> Any:
        """After a silence: a chunk that is not calculated any more although nobody said so; None if all are well."""
        if self._client.status == "closed":
            raise ClusterError(f"the connection to the scheduler is lost; {KEPT}")
        self.workers()
        for future in self._sent:
            if future.status != "pending":
                return future
        states = self._states(self._sent)
        doubtful = {key for key, state in states.items() if state in (None, "forgotten", "memory", "erred")}
        # at the first look its result may just be on the way to us
        fallen = doubtful & self._doubtful
        self._doubtful = doubtful
        return next((future for future in self._sent if future.key in fallen), None)

    def _states(self, futures: Iterable[Any]) -> dict[str, str | None]:
        """What the scheduler does with chunks, by key; empty if it does not answer."""
        keys = [future.key for future in futures]
        return self._asked(self._client.scheduler.get_task_status, keys=keys) or {}

    def _asked(self, what: Any, **about: Any) -> Any:
        """Answer of the scheduler; None if it gives none."""
        try:
            return self._client.sync(what, **about, callback_timeout=_ANSWER)
        except (OSError, TimeoutError):
            return None


class _WorkQueue:
    """Neighbouring chunks for each worker: neighbouring designs share cached bodies."""

    def __init__(self, chunks: list[FloatArray], workers: list[str]) -> None:
        count = max(len(workers), 1)
        ends = [len(chunks) * n // count for n in range(count + 1)]
        # what is left of one share at the end is taken over from the next one: both come to where they meet
        parts = [
            deque(chunks[start:end][:: -1 if n % 2 else 1]) for n, (start, end) in enumerate(pairwise(ends))
        ]
        addresses: list[str | None] = [*workers] or [None]
        self._parts = dict(zip(addresses, parts, strict=True))

    def next(self, worker: str | None) -> FloatArray | None:
        """The next chunk for a worker; who has none left, or is new, takes over half of the largest share."""
        own = self._parts.setdefault(worker, deque())
        if not own:
            largest = max(self._parts.values(), key=len)
            for _ in range(-(-len(largest) // 2)):
                own.append(largest.pop())
        return own.popleft() if own else None

    def give_back(self, worker: str | None, chunk: FloatArray) -> None:
        """A chunk that is to be calculated again, by this worker or another one."""
        self._parts.setdefault(worker, deque()).appendleft(chunk)
