"""Workers of a study on this machine."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager, suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from threading import Thread
from typing import Any

from fem_seal.arrays import FloatArray
from fem_seal.errors import ClusterError
from fem_seal.files import problem
from fem_seal.processes import Processes, usable_memory
from fem_seal.studies.store import Row
from fem_seal.studies.work import DesignSpec, calculate_watched
from fem_seal.studies.worker_pool import Workers

# Of its share of the memory a process may take this.
_SHARE = 0.95
_PRELOAD = ["fem_seal.studies.machine", "fem_seal.studies.responses"]


class LocalWorkers(Workers):
    """Processes of this machine; one that dies has a successor.

    Each has chunks of its own, and dies alone.

    Parameters
    ----------
    count : int
    """

    def __init__(self, count: int) -> None:
        self._put: Callable[[Any], None] = lambda event: None
        self._processes: dict[str, Processes | None] = {str(n): None for n in range(count)}
        self._memory = _SHARE * usable_memory() / count
        self._has_started = False

    def names(self) -> list[str]:
        """See `Workers`."""
        return list(self._processes)

    @contextmanager
    def listen(self, report: Callable[[Any], None]) -> Iterator[None]:
        """See `Workers`."""
        self._put = report
        yield

    def submit(self, worker: str | None, spec: DesignSpec, chunk: FloatArray) -> Future[list[Row]]:
        """See `Workers`."""
        return self.call(worker or next(iter(self._processes)), _calculate, spec, chunk)

    def call(self, worker: str, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """Have a function called by a worker."""
        process = self._processes[worker]
        if process is not None:
            with suppress(BrokenProcessPool):
                return process.submit(function, *arguments)
        mine, theirs = Pipe()
        with closing(theirs):
            process = Processes(1, _begin, theirs, memory=self._memory, preload=_PRELOAD)
            self._processes[worker] = process
            # starts it, and then it has its end of the connection
            future = process.submit(function, *arguments)
        Thread(target=self._listen, args=(mine,), daemon=True).start()
        return future

    def _listen(self, worker: Connection) -> None:
        with closing(worker), suppress(EOFError, OSError):
            while True:
                message = worker.recv()
                self._has_started = True
                if message is not None:
                    self._put(message)

    def rows(self, future: Future[list[Row]]) -> list[Row] | None:
        """See `Workers`."""
        try:
            return future.result()
        except BrokenProcessPool as error:
            if not self._has_started:
                raise ClusterError(problem("study_no_workers", error=error)) from None
            return None

    def close(self) -> None:
        """End the processes, whatever they are doing."""
        for process in filter(None, self._processes.values()):
            process.end()


# Of a process that calculates: to the one that started it.
_coordinator: Connection | None = None


def _begin(coordinator: Connection) -> None:
    global _coordinator
    _coordinator = coordinator
    gc.freeze()
    # it is there
    coordinator.send(None)


def _calculate(spec: DesignSpec, chunk: FloatArray) -> list[Row]:
    assert _coordinator is not None
    return calculate_watched(spec, chunk, _coordinator.send)
