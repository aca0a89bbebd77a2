"""Workers of a study on a dask cluster."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from fem_seal.arrays import FloatArray
from fem_seal.errors import ClusterError, InputError
from fem_seal.files import problem
from fem_seal.studies.store import Row
from fem_seal.studies.work import DesignSpec, calculate_watched
from fem_seal.studies.worker_pool import HEARTBEAT, RESUME_HINT, Task, WorkerPool, Workers
from fem_seal.units import duration
from leak.extras import say_missing

if TYPE_CHECKING:
    from dask.distributed import Client

# Longest time without any worker [s]: a batch job waits for its turn.
_PATIENCE = 12 * 3600.0
# Longest wait for one answer of a cluster that is there [s].
_ANSWER = 30.0


@dataclass(frozen=True)
class _Rows:
    """Rows of a chunk on their way back as one object: of a list dask would send each entry by itself."""

    rows: list[Row]


def _calculate(spec: DesignSpec, chunk: FloatArray, topic: str) -> _Rows:
    from distributed import get_worker

    worker = get_worker()

    def tell(message: dict[str, Any]) -> None:
        worker.log_event(topic, message)

    # a worker without a nanny has no successor, and may be a thread of the user's own process
    return _Rows(calculate_watched(spec, chunk, tell, worker.address, replaceable=worker.nanny is not None))


class ClusterWorkers(Workers):
    """The workers of a dask cluster, which come and go.

    Parameters
    ----------
    client : dask.distributed.Client
    patience : float
        Longest time without any worker [s]; in a queue of batch jobs the first one may take hours.
    note : callable
        Told if there are no workers.
    """

    def __init__(
        self, client: Client, patience: float, note: Callable[[str], None] = lambda text: None
    ) -> None:
        self._client, self._patience, self._note = client, patience, note
        # of this study alone, on a scheduler that may have several
        self._topic = f"fem-seal-{uuid4().hex}"
        # chunks that the scheduler did not calculate any more when it was asked last
        self._doubtful = set[str]()
        self._addresses: list[str] = []
        self._last_worker = time.monotonic()
        self._waits = False
        self._next_count = 0.0

    @contextmanager
    def listen(self, report: Callable[[Any], None]) -> Iterator[None]:
        """See `Workers`."""
        self._put = report
        self._client.subscribe_topic(self._topic, lambda event: report(event[1]))
        try:
            yield
        finally:
            if self._client.status == "running":
                self._client.unsubscribe_topic(self._topic)

    def names(self) -> list[str]:
        """Addresses of the workers, as they were at most a heartbeat ago.

        Raises
        ------
        ClusterError
            If there has been none for too long.
        """
        now = time.monotonic()
        if now >= self._next_count:
            self._addresses = sorted(self._answer(self._client.scheduler.ncores) or ())
            self._next_count = time.monotonic() + HEARTBEAT
        if self._addresses:
            self._last_worker, self._waits = now, False
        elif now - self._last_worker > self._patience:
            raise ClusterError(f"there has been no worker for {self._patience:.0f} s; {RESUME_HINT}")
        elif now - self._last_worker > _ANSWER and not self._waits:
            self._waits = True
            self._note(f"no worker is there; waiting for one up to {duration(self._patience)}")
        return self._addresses

    def submit(self, worker: str | None, spec: DesignSpec, chunk: FloatArray) -> Any:
        """See `Workers`; another worker takes the chunk if that one is busy or gone."""
        return self._client.submit(
            _calculate,
            spec,
            chunk,
            self._topic,
            pure=False,
            workers=None if worker is None else [worker],
            allow_other_workers=worker is not None,
        )

    def rows(self, future: Any) -> list[Row] | None:
        """See `Workers`."""
        from distributed.scheduler import KilledWorker

        try:
            if future.status == "finished":
                try:
                    answer: _Rows = future.result(timeout=_ANSWER)
                    return answer.rows
                except Exception:  # calculated, but lost on the way back with the worker that held it
                    return None
            error = future.exception(timeout=_ANSWER) if future.status == "error" else None
        finally:
            future.release()
        if error is None or isinstance(error, KilledWorker):
            return None
        if isinstance(error, InputError):
            raise error
        # a design that fails is a row: what ends up here is the worker's own fault
        message = f"a worker cannot calculate: {type(error).__name__}: {error}"
        raise ClusterError(f"{message}. Install this version of fem-seal where workers run; {RESUME_HINT}")

    def cancel(self, future: Any, worker: str, *, replaceable: bool) -> bool:
        """See `Workers`."""
        # or dask would give it to another worker
        self._client.cancel([future])
        if not replaceable:
            # what it is busy with never ends: it gets nothing more
            self._answer(self._client.scheduler.retire_workers, workers=[worker])
        return True

    def take_back_lost(self, tasks: Mapping[Any, Task]) -> list[Any]:
        """See `Workers`.

        What was meant for the last worker that died dask keeps for that very address, whoever comes after it.

        Raises
        ------
        ClusterError
            If the scheduler is gone.
        """
        if self._client.status == "closed":
            raise ClusterError(f"the connection to the scheduler is lost; {RESUME_HINT}")
        workers = self.names()
        keys = [future.key for future in tasks]
        states = self._answer(self._client.scheduler.get_task_status, keys=keys) or {}
        doubtful = {key for key, state in states.items() if state in (None, "forgotten", "memory", "erred")}
        # at the first look its result may just be on the way to us
        unknown, self._doubtful = doubtful & self._doubtful, doubtful
        lost_chunks = [
            future
            for future, task in tasks.items()
            if future.status == "lost"
            or future.key in unknown
            or (states.get(future.key) == "no-worker" and workers and task.worker not in (None, *workers))
        ]
        for future in lost_chunks:
            future.release()
        return lost_chunks

    def _answer(self, question: Any, **about: Any) -> Any:
        """Answer of the scheduler; None if it gives none."""
        try:
            return self._client.sync(question, **about, callback_timeout=_ANSWER)
        except (OSError, TimeoutError):
            return None


def cluster_pool(
    client: Client, retries: int, note: Callable[[str], None] = lambda text: None, patience: float = _PATIENCE
) -> WorkerPool:
    """The workers of a dask cluster; see `WorkerPool` and `ClusterWorkers`."""
    return WorkerPool(ClusterWorkers(client, patience, note), retries, note)


def connect_client(scheduler: str) -> Client:
    """A client of the scheduler at an address.

    Raises
    ------
    InputError
        If there is none, or dask is not installed.
    """
    try:
        from dask.distributed import Client
    except ImportError as error:
        raise InputError.at("study", say_missing("studies", error)) from None
    try:
        return Client(scheduler, timeout=20)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(problem("study_no_scheduler", error=error, scheduler=scheduler)) from None
