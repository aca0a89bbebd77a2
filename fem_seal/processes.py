"""Processes that calculate for this one, a single BLAS thread, memory returned to the system."""

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
from contextlib import contextmanager, nullcontext, suppress
from functools import cache, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, ParamSpec, Self, TypeVar

if TYPE_CHECKING:
    from concurrent.futures import Future

    from threadpoolctl import ThreadpoolController

T = TypeVar("T")
R = TypeVar("R")
P = ParamSpec("P")


def usable_cores() -> int:
    """What this process may use: in a container or under a job scheduler that is less than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


# How processes begin that are no copies; on macOS the server of forks may crash in the system's own libraries.
START = "forkserver" if sys.platform == "linux" else "spawn"


class Processes:
    """Processes that calculate for this one: Ctrl-C is for this one alone, with which they end.

    They start with the first call. Where one dies, all calls that have no result yet end with BrokenProcessPool.

    Parameters
    ----------
    count : int
    begin : callable
        Called in each of them first.
    *arguments
        Handed to it.
    copies : bool
        Whether they are copies of this process as it is then (see `can_copy`); others load what they need.
    memory : float
        What one of them may take [bytes].
    preload : sequence of str
        Modules that they find loaded on Linux, where they are copies of one process that has loaded them.

    Examples
    --------
    >>> with Processes(1) as processes:
    ...     processes.submit(abs, -3).result()
    3
    """

    def __init__(
        self,
        count: int,
        begin: Callable[..., None] = gc.freeze,
        *arguments: Any,
        copies: bool = False,
        memory: float = math.inf,
        preload: Sequence[str] = (),
    ) -> None:
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        about = (memory, begin, arguments)
        self._executor = ProcessPoolExecutor(count, get_context("fork" if copies else START), _begin, about)
        self._copies, self._preload = copies, preload

    def submit(self, function: Callable[P, T], /, *arguments: P.args, **options: P.kwargs) -> Future[T]:
        """Future of a call by one of them.

        Raises
        ------
        BrokenProcessPool
            If one of them has died.
        """
        with nullcontext() if self._copies else _without_interrupts(self._preload):
            return self._executor.submit(function, *arguments, **options)

    def end(self) -> None:
        """End them, whatever they are doing."""
        # Python 3.14 calls this kill_workers
        for process in list((self._executor._processes or {}).values()):
            process.kill()
        self._executor.shutdown()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()


@contextmanager
def _without_interrupts(preload: Sequence[str]) -> Iterator[None]:
    """Processes that are started here have one thread each for BLAS, and they and their successors never hear Ctrl-C.

    A terminal sends the signal to all of them, but it is the one that started them that ends them.
    """
    from multiprocessing import resource_tracker, set_forkserver_preload

    set_forkserver_preload(list(preload))
    names = [f"{library}_NUM_THREADS" for library in ("OMP", "OPENBLAS", "MKL")]
    unset = [name for name in names if name not in os.environ]
    os.environ.update(dict.fromkeys(unset, "1"))
    if hasattr(signal, "pthread_sigmask"):
        # threads and processes inherit what is blocked, but where Python starts this helper, it is let through again
        resource_tracker.ensure_running()
        old_mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if hasattr(signal, "pthread_sigmask"):
            signal.pthread_sigmask(signal.SIG_SETMASK, old_mask)
        for name in unset:
            del os.environ[name]


def _begin(memory: float, begin: Callable[..., None], arguments: tuple[Any, ...]) -> None:
    """What a process does first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_guard, args=(memory,), daemon=True).start()
    begin(*arguments)


# So often a process looks whether it is to end; where a library lets no thread have its turn for so long it does [s].
_LOOK, DEAF = 1.0, 300.0


def _guard(memory: float) -> None:
    """End this process with the one that started it, or where it takes more than it may."""
    from multiprocessing import parent_process
    from multiprocessing.connection import wait

    parent = parent_process()
    assert parent is not None
    while _peak_memory() <= memory:
        if hasattr(signal, "setitimer"):
            # the system ends the process unless this thread has its turn again
            signal.setitimer(signal.ITIMER_REAL, DEAF)
        if wait([parent.sentinel], timeout=_LOOK):
            break
    os._exit(1)


def usable_memory() -> float:
    """What this machine, or the container around this process, has [bytes]; infinite where it is not known."""
    limits = [math.inf]
    if hasattr(os, "sysconf"):
        with suppress(ValueError, OSError):
            limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for file in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        with suppress(ValueError, OSError):
            limits.append(int(Path(file).read_text(encoding="utf-8")))
    return min(limits)


def _peak_memory() -> float:
    """What this process has taken at most [bytes]; zero on Windows, which does not say it."""
    if sys.platform == "win32":
        return 0.0
    import resource

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
        processes = min(usable_cores(), _MOST_PROCESSES) if can_copy() else 1
    count = max(min(processes, len(items)), 1)
    shares = [items[k::count] for k in range(count)]
    outcomes = _in_copies(function, shares) if count > 1 else [_outcome(function, items)]
    errors = [
        (len(outcome.results) * count + k, outcome.error)
        for k, outcome in enumerate(outcomes)
        if outcome.error
    ]
    if errors:
        raise min(errors, key=lambda error: error[0])[1]
    return [outcomes[n % count].results[n // count] for n in range(len(items))]


# More gain little beside what one process makes before and after.
_MOST_PROCESSES = 8


def can_copy() -> bool:
    """Whether this process may be forked, and has the cores for it.

    Not on macOS and Windows. Not beside other threads, whose locks a fork could wait for without end, except the
    progress spinner's thread. Not in a worker, which shares the cores with other workers.
    """
    if sys.platform != "linux" or any(_calculates(thread) for thread in threading.enumerate()):
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
    results: list[R] = []
    try:
        # several processes with several threads each would wait for each other
        single_threaded(lambda: results.extend(map(function, share)))()
    except Exception as error:
        return _Outcome(results, error)
    return _Outcome(results, None)


def _in_copies(function: Callable[[T], R], shares: Sequence[Sequence[T]]) -> list[_Outcome]:
    """Outcome of each share, the first of them found here."""
    from concurrent.futures.process import BrokenProcessPool

    with Processes(len(shares) - 1, _inherit, function, shares, copies=True) as copies:
        with warnings.catch_warnings():
            # of threads in libraries, as OpenBLAS has them, which knows how to be copied
            warnings.simplefilter("ignore", DeprecationWarning)
            futures = [copies.submit(_inherited_outcome, k) for k in range(1, len(shares))]
        outcomes = [_outcome(function, shares[0])]
        for share, future in zip(shares[1:], futures, strict=True):
            try:
                outcomes.append(future.result())
            except BrokenProcessPool:  # a copy has died, for want of memory
                outcomes.append(_outcome(function, share))
    return outcomes


# Of a copy: a function need not be one that can be pickled.
_job: tuple[Callable[[Any], Any], Sequence[Any]]


def _inherit(function: Callable[[T], R], shares: Sequence[Sequence[T]]) -> None:
    global _job
    _job = function, shares
    # what is there already is not looked through for rubbish, which would make it a copy in memory, too
    gc.freeze()


def _inherited_outcome(share: int) -> _Outcome:
    function, shares = _job
    return _outcome(function, shares[share])


def single_threaded(function: Callable[P, T]) -> Callable[P, T]:
    """Let a function have one BLAS thread.

    A contact has a few hundred unknowns: threads gain nothing there, and on a busy machine their waiting for each
    other makes a solve a hundred times slower.
    """

    @wraps(function)
    def limit_threads(*args: P.args, **kwargs: P.kwargs) -> T:
        controller = _controller()
        if all(
            library.num_threads == 1 for library in controller.lib_controllers if library.user_api == "blas"
        ):
            return function(*args, **kwargs)
        with controller.limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limit_threads


@cache
def _controller() -> ThreadpoolController:
    """Looks once for the BLAS libraries of the process; numpy and scipy bring one each."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


@contextmanager
def returned_memory() -> Iterator[None]:
    """Give back at the end what was used in between and is free again.

    The C library of Linux keeps it in reserve, hundreds of megabytes after a large case; others have no such function
    and need none. It takes some milliseconds.
    """
    try:
        yield
    finally:
        # Windows has no library without a name
        with suppress(OSError, AttributeError, TypeError):
            ctypes.CDLL(None).malloc_trim(0)
