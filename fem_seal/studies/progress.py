"""How far a study is: a bar on a terminal, a line now and then elsewhere, or nothing."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field
from typing import Any

from fem_seal.printable import printable
from fem_seal.units import duration

# Seconds between two lines where there is no terminal.
_PAUSE = 10.0


class Progress:
    """What a running study tells; this one says nothing."""

    def begin(self, total: int, known: int) -> None:
        """So many designs, of which so many are calculated already."""

    def advance(self, done: int, failed: int) -> None:
        """So many more are done, so many of them failed."""

    def note(self, text: str) -> None:
        """Something to know meanwhile."""

    def end(self) -> None:
        """Nothing more will come."""


@dataclass
class Lines(Progress):
    """A line on standard error now and then, with rate and remaining time."""

    total: int = 0
    done: int = 0
    failed: int = 0
    known: int = 0
    _started: float = field(default=0.0, repr=False)
    _said: float = field(default=0.0, repr=False)
    _told: int = field(default=0, repr=False)

    def begin(self, total: int, known: int) -> None:
        """See `Progress`."""
        self.total, self.known, self.done, self.failed = total, known, known, 0
        self._started = self._said = time.monotonic()
        if known:
            self._say(f"{known} of {total} designs are calculated already")

    def advance(self, done: int, failed: int) -> None:
        """See `Progress`."""
        self.done += done
        self.failed += failed
        if time.monotonic() - self._said > _PAUSE:
            self._said, self._told = time.monotonic(), self.done
            self._say(self._state())

    def note(self, text: str) -> None:
        """See `Progress`."""
        self._say(text)

    def end(self) -> None:
        """See `Progress`."""
        if self._told < self.done and self.known < self.done:
            self._say(self._state())

    def _state(self) -> str:
        seconds = max(time.monotonic() - self._started, 1e-9)
        rate = (self.done - self.known) / seconds
        left = duration((self.total - self.done) / rate) if rate > 0 else "unknown time"
        failed = f", {self.failed} failed" if self.failed else ""
        return f"{self.done} of {self.total} designs{failed}, {rate:.3g}/s, {left} left"

    def _say(self, text: str) -> None:
        sys.stderr.write(printable(text) + "\n")
        sys.stderr.flush()


class Bar(Progress):
    """A bar on the terminal."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )
        from rich.progress import Progress as RichProgress

        self._bar = RichProgress(
            TextColumn("designs"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(elapsed_when_finished=False),
            TextColumn("{task.fields[failed]}"),
            console=Console(stderr=True),
        )
        self._task: Any = None
        self._failed = self._new = 0
        self._started = 0.0

    def begin(self, total: int, known: int) -> None:
        """See `Progress`."""
        self._started = time.monotonic()
        self._bar.start()
        self._task = self._bar.add_task("designs", total=total, completed=known, rate="", failed="")

    def advance(self, done: int, failed: int) -> None:
        """See `Progress`."""
        self._failed += failed
        self._new += done
        rate = self._new / max(time.monotonic() - self._started, 1e-9)
        told = f"{self._failed} failed" if self._failed else ""
        self._bar.update(self._task, advance=done, rate=f"{rate:.3g}/s", failed=told)

    def note(self, text: str) -> None:
        """See `Progress`."""
        self._bar.console.print(printable(text), markup=False, highlight=False)

    def end(self) -> None:
        """See `Progress`."""
        self._bar.stop()


def shown_progress(quiet: bool) -> Progress:
    """What fits standard error."""
    if quiet:
        return Progress()
    return Bar() if sys.stderr.isatty() else Lines()
