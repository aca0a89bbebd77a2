"""Workers of a study on this machine: processes of the standard library, one executor each."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager, suppress
from multiprocessing import get_context, resource_tracker, set_forkserver_preload
from multiprocessing.connection import Connection, wait
from threading import Thread
from typing import Any

from fem_seal.arrays import FloatArray
from fem_seal.case.words import sentence
from fem_seal.errors import ClusterError
from fem_seal.processes import peak_memory, usable_memory
from fem_seal.studies.store import Row
from fem_seal.studies.work import DesignSpec, calculate_watched
from fem_seal.studies.worker_pool import Workers

# Of its share of the memory a process may take this; it looks so often [s].
_SHARE, _LOOK = 0.95, 1.0
# A process whose threads have had no turn for so long, since a library keeps them all waiting, is ended [s].
_DEAF = 300.0
# A process is a copy of one that has loaded what they all need, instead of loading it itself. On macOS a copy may crash
# in the system's own libraries.
_START = "forkserver" if sys.platform == "linux" else "spawn"
_LOADED = ["fem_seal.studies.machine", "fem_seal.studies.responses"]


class LocalWorkers(Workers):
    """Processes of this machine; one that dies has a successor.

    Each is an executor of its own: it gets the chunks that are meant for it, and dies alone.

    Parameters
    ----------
    count : int
    """

    def __init__(self, count: int) -> None:
        self._put: Callable[[Any], None] = lambda event: None
        self._executors: dict[str, ProcessPoolExecutor | None] = {str(n): None for n in range(count)}
        self._memory = _SHARE * usable_memory() / count
        self._started = False

    def names(self) -> list[str]:
        """See `Workers`."""
        return list(self._executors)

    @contextmanager
    def listening(self, put: Callable[[Any], None]) -> Iterator[None]:
        """See `Workers`."""
        self._put = put
        yield

    def submit(self, worker: str | None, spec: DesignSpec, chunk: FloatArray) -> Future[list[Row]]:
        """See `Workers`."""
        return self.call(worker or next(iter(self._executors)), _calculate, spec, chunk)

    def call(self, worker: str, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """Have a function called by a worker."""
        executor = self._executors[worker]
        if executor is not None:
            with suppress(BrokenProcessPool):
                return executor.submit(function, *arguments)
        context = get_context(_START)
        mine, theirs = context.Pipe()
        executor = self._executors[worker] = ProcessPoolExecutor(
            1, context, initializer=_begin, initargs=(theirs, self._memory)
        )
        with _undisturbed(), closing(theirs):
            # starts the process, which then has its end of the connection
            future = executor.submit(function, *arguments)
        Thread(target=self._listen, args=(mine,), daemon=True).start()
        return future

    def _listen(self, worker: Connection) -> None:
        with closing(worker), suppress(EOFError, OSError):
            while True:
                message = worker.recv()
                self._started = True
                if message is not None:
                    self._put(message)

    def rows(self, future: Future[list[Row]]) -> list[Row] | None:
        """See `Workers`."""
        try:
            return future.result()
        except BrokenProcessPool as error:
            if not self._started:
                raise ClusterError(sentence("study_no_workers", error=error)) from None
            return None

    def close(self) -> None:
        """End the processes, whatever they are doing."""
        for executor in filter(None, self._executors.values()):
            # Python 3.14 calls this kill_workers
            for process in list((executor._processes or {}).values()):
                process.kill()
            executor.shutdown()


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Processes that are started here have one thread each, and they and their successors never hear Ctrl-C.

    A terminal sends the signal to all of them, but it is the one that started them that ends them.
    """
    set_forkserver_preload(_LOADED)
    environment = dict(os.environ)
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    masks = hasattr(signal, "pthread_sigmask")
    if masks:
        # threads and processes inherit what is blocked, but where Python starts this helper, it is let through again
        resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if masks:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for name in os.environ.keys() - environment.keys():
            del os.environ[name]


# Of a process that calculates: to the one that started it.
_coordinator: Connection | None = None


def _begin(coordinator: Connection, memory: float) -> None:
    """What a process does first."""
    global _coordinator
    _coordinator = coordinator
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.freeze()
    coordinator.send(None)
    Thread(target=_guard, args=(coordinator, memory), daemon=True).start()


def _guard(coordinator: Connection, memory: float) -> None:
    """End this process with the one that started it, or where it takes more than its share of the memory."""
    while peak_memory() <= memory:
        if hasattr(signal, "setitimer"):
            # the system ends the process unless this thread has its turn again
            signal.setitimer(signal.ITIMER_REAL, _DEAF)
        if wait([coordinator], timeout=_LOOK):
            break
    os._exit(1)


def _calculate(spec: DesignSpec, chunk: FloatArray) -> list[Row]:
    assert _coordinator is not None
    return calculate_watched(spec, chunk, _coordinator.send)
