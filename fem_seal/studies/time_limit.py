"""Watchdog thread with a time limit per design."""

from __future__ import annotations

import _thread
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Self

from fem_seal.units import duration

# After so long it is told who is being calculated, then each time that it has become twice as long [s].
_SLOW = 60.0
# So often a design is told to stop, this far apart [s], until it is taken for stuck.
_TIMES, _INTERVAL = 10, 1.0


class OvertimeError(BaseException):
    """A design has reached its time limit; no `Exception`, so that nothing in it mistakes this for its own."""


@dataclass(eq=False)
class Block:
    """What is looked at while it runs, which may be several times.

    Parameters
    ----------
    slow : callable
        Told how long it has been [s], a few times before the limit.
    stop : callable
        Called at the limit, and now and then after it, with the event that says that the block runs no longer.
    """

    slow: Callable[[float], None]
    stop: Callable[[threading.Event], None]
    tell: float = 0.0
    start: float = 0.0
    duration: float = 0.0
    runs: bool = False
    end: threading.Event | None = None


class Watch:
    """Looks at the clock, from a thread of its own, while one block after the other runs.

    Parameters
    ----------
    limit : float
        Of each block [s].
    """

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._first_notice = min(_SLOW, 0.25 * limit)
        self._pause = min(1.0, 0.05 * limit)
        self._block: Block | None = None
        # held while somebody is told something
        self._tell_lock = threading.Lock()
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True, name="time limit of a design")

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._end.set()
        self._thread.join()

    @contextmanager
    def turn(self, block: Block) -> Iterator[None]:
        """Look at the clock while a block runs for a while: what counts is all of its time, not that of others."""
        block.tell = block.tell or self._first_notice
        block.start = time.monotonic() - block.duration
        block.runs, block.end = True, None
        self._block = block
        try:
            yield
        finally:
            block.runs = False
            if block.end is not None:
                block.end.set()
            with self._tell_lock:
                self._block = None
            block.duration = time.monotonic() - block.start

    def _look(self) -> None:
        while not self._end.wait(self._pause):
            with self._tell_lock:
                block = self._block
                if block is not None and block.runs and time.monotonic() - block.start >= block.tell:
                    self._tell(block)

    def _tell(self, block: Block) -> None:
        """Tell a block how long it has been, or that it has reached its limit."""
        seconds = time.monotonic() - block.start
        if seconds < self._limit:
            block.slow(seconds)
            block.tell = min(2 * seconds, self._limit)
            return
        # only now: it takes longer than many a turn
        block.end = end = threading.Event()
        if not block.runs:
            end.set()
        block.stop(end)
        block.tell = time.monotonic() - block.start + self._first_notice


@contextmanager
def end_after(
    limit: float,
    slow: Callable[[float], None] = lambda seconds: None,
    stuck: Callable[[], None] = lambda: None,
) -> Iterator[None]:
    """End the block in this process when it has taken too long.

    It is interrupted as by Ctrl-C, which works wherever it gets back to Python. That is only possible in the main
    thread; and a library that never comes back to Python can be ended only with its process.

    Parameters
    ----------
    limit : float
        [s]
    slow : callable
        See `Block`.
    stuck : callable
        Called if the block does not stop.

    Raises
    ------
    OvertimeError
        At the limit, from wherever the block is.
    """
    interrupts = is_over = False
    usual: Any = None

    def raise_overtime(number: int, frame: Any) -> None:
        nonlocal interrupts
        if not interrupts:
            if callable(usual):
                usual(number, frame)
            return
        interrupts = False
        if not is_over:
            raise OvertimeError

    def stop(block_ended: threading.Event) -> None:
        nonlocal interrupts
        for _ in range(_TIMES if main else 0):
            interrupts = True
            _interrupt_main_thread()
            if block_ended.wait(_INTERVAL):
                return
        stuck()

    main = threading.current_thread() is threading.main_thread()
    if main:
        usual = signal.signal(signal.SIGINT, raise_overtime)
    try:
        with Watch(limit) as watch, watch.turn(Block(slow, stop)):
            try:
                yield
            finally:
                # what comes too late does not hit anybody else
                is_over = True
    finally:
        if main:
            signal.signal(signal.SIGINT, signal.SIG_DFL if usual is None else usual)


def _interrupt_main_thread() -> None:
    if hasattr(signal, "pthread_kill"):  # ends a wait of the system as well
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


def overtime_reason(limit: float) -> str:
    """What the failed row says."""
    return f"took longer than its time limit of {duration(limit)}; a larger run.time_limit gives it more"


def slow_line(design: str, seconds: float, limit: float) -> str:
    """Progress line about a design that takes its time."""
    return (
        f"still calculating after {duration(seconds)}: the design {design}; "
        f"it fails after {duration(limit)} (run.time_limit)"
    )
