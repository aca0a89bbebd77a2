"""Hand out designs to workers, processes of this machine or of a cluster, and try again what was lost."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from itertools import pairwise
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.studies.store import Row
from fem_seal.studies.work import DesignSpec, failed_row, overtime_row

# Chunks on the way per worker: enough that none waits for the next one, few enough that memory stays flat.
_AHEAD = 3
# Longest silence before the workers are asked whether they still have the chunks [s].
HEARTBEAT = 2.0
RESUME_HINT = "the designs that are done are kept, --resume (resume=True) continues"


class Task(NamedTuple):
    """A chunk that is on the way: meant for a worker, after so many attempts."""

    chunk: FloatArray
    worker: str | None
    attempt: int


class Workers(ABC):
    """Processes that calculate chunks: of this machine or of a cluster."""

    @abstractmethod
    def names(self) -> list[str]:
        """Workers that are there."""

    @abstractmethod
    def listen(self, report: Callable[[Any], None]) -> AbstractContextManager[None]:
        """Put here what workers say (see `fem_seal.studies.work.calculate_watched`), from other threads."""

    @abstractmethod
    def submit(self, worker: str | None, spec: DesignSpec, chunk: FloatArray) -> Any:
        """Future of a chunk for a worker, None for any."""

    @abstractmethod
    def rows(self, future: Any) -> list[Row] | None:
        """Rows of a future that has settled, None if its worker died.

        Raises
        ------
        ClusterError
            If workers cannot calculate at all.
        InputError
            If a file of the designs has changed.
        """

    def cancel(self, future: Any, worker: str, *, replaceable: bool) -> bool:
        """Whether nobody else calculates a chunk any more whose worker ends itself, or never ends it."""
        return False

    def take_back_lost(self, tasks: Mapping[Any, Task]) -> list[Any]:
        """After a silence: chunks that nobody calculates any more although nobody said so; they are taken back."""
        return []


@dataclass(frozen=True)
class WorkerPool:
    """Calculates chunks by workers.

    Parameters
    ----------
    workers : Workers
    retries : int
        How often designs are tried again after their worker died.
    note : callable
        Told of designs that take long.
    """

    workers: Workers
    retries: int
    note: Callable[[str], None] = lambda text: None

    def results(self, spec: DesignSpec, chunks: Iterable[FloatArray]) -> Iterator[list[Row]]:
        """Rows of each chunk, in any order.

        Only a few chunks per worker are on the way at a time. The designs of a chunk whose worker died are tried at the
        end, one by one with nothing else on the way: one design that kills every worker then costs nothing but itself.
        A design that reaches its time limit is known by name: it is a failed row, its worker ends itself, and the rest
        of its chunk is calculated like any other.

        Raises
        ------
        ClusterError
            If the scheduler is gone, no worker comes, or workers cannot calculate at all.
        InputError
            If a file of the designs has changed.
        """
        course = _Schedule(self, spec, list(chunks))
        with self.workers.listen(course.events.put):
            while course.hand_out():
                if outcome := course.wait_for_chunk():
                    yield from course.rows(*outcome)


class _Schedule:
    """Which chunks workers have been given, and which are left.

    Parameters
    ----------
    pool : WorkerPool
    spec : DesignSpec
    chunks : list of ndarray
    """

    def __init__(self, pool: WorkerPool, spec: DesignSpec, chunks: list[FloatArray]) -> None:
        self._pool, self._workers, self._spec = pool, pool.workers, spec
        # futures that are settled, and what workers say
        self.events = SimpleQueue[Any]()
        self._tasks: dict[Any, Task] = {}
        self._queue = WorkQueue(chunks, self._workers.names())
        self._suspects = deque[Task]()
        self._late = set[tuple[float, ...]]()

    def hand_out(self) -> bool:
        """Give every worker something to do; whether anything is on the way then."""
        counts = Counter(task.worker for task in self._tasks.values())
        # while there is no worker, chunks are for whichever comes
        workers: list[str | None] = [*self._workers.names()] or [None]
        for worker in workers:
            while counts[worker] < _AHEAD and len(self._tasks) < _AHEAD * len(workers):
                chunk = self._queue.take_chunk(worker)
                if chunk is None:
                    break
                counts[worker] += 1
                self._send(Task(chunk, worker, 0))
        if not self._tasks and self._suspects:
            self._send(self._suspects.popleft())
        return bool(self._tasks)

    def _send(self, task: Task) -> None:
        future = self._workers.submit(task.worker, self._spec, task.chunk)
        self._tasks[future] = task
        future.add_done_callback(self.events.put)

    def wait_for_chunk(self) -> tuple[Task, list[Row] | None] | None:
        """Wait for a chunk: its rows, None if its workers died or a design is late. After a silence there is none."""
        try:
            future = self.events.get(timeout=HEARTBEAT)
        except Empty:
            for future in self._workers.take_back_lost(self._tasks):
                task = self._tasks.pop(future)
                self._queue.give_back(task.worker, task.chunk)
            return None
        if isinstance(future, dict):
            future = self._handle_message(**future)
        # what was taken back settles as well
        if future not in self._tasks:
            return None
        return self._tasks.pop(future), self._workers.rows(future)

    def _handle_message(
        self, slow: str = "", late: list[float] | None = None, worker: str = "", replaceable: bool = True
    ) -> Any:
        """What a worker says; the chunk of a design that has reached its time limit if a cluster would repeat it."""
        if late is None:
            self._pool.note(slow)
            return None
        self._late.add(tuple(late))
        for future, task in self._tasks.items():
            if late in task.chunk.tolist() and self._workers.cancel(future, worker, replaceable=replaceable):
                return future
        return None

    def rows(self, task: Task, rows: list[Row] | None) -> Iterator[list[Row]]:
        """Rows of what has settled; what has none is tried again as long as that makes sense."""
        if rows is not None:
            yield rows
            return
        late = np.array([tuple(point) in self._late for point in task.chunk.tolist()])
        if late.any():
            yield [overtime_row(self._spec, point) for point in task.chunk[late]]
            if not late.all():
                self._queue.give_back(task.worker, task.chunk[~late])
        elif task.attempt < self._pool.retries or len(task.chunk) > 1:
            self._suspects.extend(Task(point[None], None, task.attempt + 1) for point in task.chunk)
        else:
            reason = "every worker that calculated it died; it may need more memory than a worker has"
            yield [failed_row(self._spec, point, reason) for point in task.chunk]


class WorkQueue:
    """Neighbouring chunks for each worker: neighbouring designs share cached bodies."""

    def __init__(self, chunks: list[FloatArray], workers: list[str]) -> None:
        count = max(len(workers), 1)
        ends = [len(chunks) * n // count for n in range(count + 1)]
        # what is left of one share at the end is taken over from the next one: both come to where they meet
        parts = [
            deque(chunks[start:end][:: -1 if n % 2 else 1]) for n, (start, end) in enumerate(pairwise(ends))
        ]
        names: list[str | None] = [*workers] or [None]
        self._parts = dict(zip(names, parts, strict=True))

    def take_chunk(self, worker: str | None) -> FloatArray | None:
        """The next chunk for a worker; who has none left, or is new, takes over half of the largest share."""
        part = self._parts.setdefault(worker, deque())
        if not part:
            largest = max(self._parts.values(), key=len)
            for _ in range(-(-len(largest) // 2)):
                part.append(largest.pop())
        return part.popleft() if part else None

    def give_back(self, worker: str | None, chunk: FloatArray) -> None:
        """A chunk that is to be calculated again, by this worker or another one."""
        self._parts.setdefault(worker, deque()).appendleft(chunk)
