"""Forked processes, a single BLAS thread, memory returned to the system."""

from __future__ import annotations

import ctypes
import gc
import math
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, ParamSpec, TypeVar

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkProcess

    from threadpoolctl import ThreadpoolController

T = TypeVar("T")
R = TypeVar("R")
P = ParamSpec("P")


def usable_cores() -> int:
    """What this process may use: in a container or under a job scheduler that is less than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def usable_memory() -> float:
    """What this machine, or the container around this process, has [bytes]; infinite where it is not known."""
    limits = [math.inf]
    with suppress(AttributeError, ValueError, OSError):
        limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for file in _MEMORY_OF_CONTAINER:
        with suppress(ValueError, OSError):
            limits.append(int(Path(file).read_text()))
    return min(limits)


_MEMORY_OF_CONTAINER = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def peak_memory() -> float:
    """What this process has taken at most [bytes]; zero on Windows, which does not say it."""
    try:
        import resource
    except ImportError:
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024.0 * peak


def fork_map(function: Callable[[T], R], items: Sequence[T], processes: int | None = None) -> list[R]:
    """What a function makes of each item, in their order.

    Of n processes each takes every n-th item: this one, and copies of it that begin with all that it knows. What a copy
    finds out beside its results is lost.

    Parameters
    ----------
    function : callable
        Changes nothing outside, and its results can be pickled.
    items : sequence
    processes : int, optional
        By default one for every core that may be used, at most eight; this one alone where copies cannot be trusted
        (`can_copy`).

    Raises
    ------
    Exception
        What the function raises of the first item for which it does.

    Examples
    --------
    >>> fork_map(abs, [-1, 2, -3], processes=2)
    [1, 2, 3]
    """
    if processes is None:
        processes = min(usable_cores(), _MOST) if can_copy() else 1
    count = max(min(processes, len(items)), 1)
    shares = [items[k::count] for k in range(count)]
    copies: list[_Copy] = []
    try:
        copies += [_Copy.of(function, share) for share in shares[1:]]
        outcomes = [_outcome(function, shares[0]), *(copy.outcome() for copy in copies)]
    finally:
        for copy in copies:
            copy.end()
    failed = [(len(one.results) * count + k, one.error) for k, one in enumerate(outcomes) if one.error]
    if failed:
        raise min(failed, key=lambda one: one[0])[1]
    return [outcomes[n % count].results[n // count] for n in range(len(items))]


# More gain little beside what one process makes before and after.
_MOST = 8


def can_copy() -> bool:
    """Whether this process may be forked, and has the cores for it.

    Not on macOS and Windows. Not beside other threads, whose locks a fork could wait for without end, except the
    progress spinner's thread. Not in a worker, which shares the cores with other workers.
    """
    if sys.platform != "linux" or any(_calculates(one) for one in threading.enumerate()):
        return False
    from multiprocessing import parent_process

    return parent_process() is None


def _calculates(thread: threading.Thread) -> bool:
    return thread is not threading.current_thread() and not type(thread).__module__.startswith("rich.")


class _Outcome(NamedTuple):
    results: list[Any]
    """Of the items before the one that failed, if any did."""
    error: Exception | None


def _outcome(function: Callable[[T], R], share: Sequence[T]) -> _Outcome:
    found: list[R] = []
    try:
        # several processes with several threads each would wait for each other
        single_threaded(lambda: found.extend(map(function, share)))()
    except Exception as error:
        return _Outcome(found, error)
    return _Outcome(found, None)


@dataclass(frozen=True)
class _Copy:
    """A process with a share of the items. It ends when that is done, even if nobody asks for it any more."""

    function: Callable[[Any], Any]
    share: Sequence[Any]
    process: ForkProcess
    reader: Connection

    @classmethod
    def of(cls, function: Callable[[T], R], share: Sequence[T]) -> _Copy:
        from multiprocessing import get_context

        context = get_context("fork")
        reader, writer = context.Pipe(duplex=False)
        process = context.Process(target=_answer, args=(function, share, writer), daemon=True)
        with warnings.catch_warnings():
            # of threads in libraries, as OpenBLAS has them, which knows how to be copied
            warnings.simplefilter("ignore", DeprecationWarning)
            process.start()
        writer.close()
        return cls(function, share, process, reader)

    def outcome(self) -> _Outcome:
        """What it has found; calculated here if it has died, for want of memory."""
        try:
            found: _Outcome = self.reader.recv()
        except EOFError:
            return _outcome(self.function, self.share)
        return found

    def end(self) -> None:
        self.reader.close()
        self.process.terminate()
        self.process.join()


def _answer(function: Callable[[T], R], share: Sequence[T], writer: Connection) -> None:
    # a terminal interrupts all processes; it is the first one that ends the others
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # what is there already is not looked through for rubbish, which would make it a copy in memory, too
    gc.freeze()
    writer.send(_outcome(function, share))


def single_threaded(function: Callable[P, T]) -> Callable[P, T]:
    """Let a function have one BLAS thread.

    A contact has a few hundred unknowns: threads gain nothing there, and on a busy machine their waiting for each
    other makes a solve a hundred times slower.
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> T:
        controller = _controller()
        if all(one.num_threads == 1 for one in controller.lib_controllers if one.user_api == "blas"):
            return function(*args, **kwargs)
        with controller.limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited


@cache
def _controller() -> ThreadpoolController:
    """Looks once for the BLAS libraries of the process; numpy and scipy bring one each."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


@contextmanager
def given_back() -> Iterator[None]:
    """Give back at the end what was used in between and is free again.

    The C library of Linux keeps it in reserve, hundreds of megabytes after a large case; others have no such function
    and need none. It takes some milliseconds.
    """
    try:
        yield
    finally:
        trim = _trim()
        if trim is not None:
            trim(0)


@cache
def _trim() -> Any:
    try:
        return ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError, TypeError):  # Windows has no library without a name
        return None
