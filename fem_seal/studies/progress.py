"""Progress of a study: a bar on a terminal, lines elsewhere."""

from __future__ import annotations

import sys
import time
from typing import Any

from fem_seal.errors import printable
from fem_seal.units import duration

# Seconds between two lines where there is no terminal.
_PAUSE = 10.0


class Progress:
    """What a running study tells; this one says nothing."""

    total: int = 0
    done_count: int = 0
    failed_count: int = 0
    done_before: int = 0
    """Designs of the study; those that are done, those of them that failed in this run, and those done before it."""
    _start = 0.0

    def begin(self, total: int, done_before: int) -> None:
        """So many designs, of which so many are calculated already."""
        self.total, self.done_count, self.failed_count, self.done_before = total, done_before, 0, done_before
        self._start = time.monotonic()

    def advance(self, done_count: int, failed_count: int) -> None:
        """So many more are done, so many of them failed."""
        self.done_count += done_count
        self.failed_count += failed_count

    def note(self, text: str) -> None:
        """Something to know meanwhile."""

    def end(self) -> None:
        """Nothing more will come."""

    @property
    def rate(self) -> float:
        """Designs of this run in a second."""
        return (self.done_count - self.done_before) / max(time.monotonic() - self._start, 1e-9)


class Lines(Progress):
    """A line on standard error now and then, with rate and remaining time."""

    _last_line = 0.0
    _done_in_line = 0

    def begin(self, total: int, done_before: int) -> None:
        """See `Progress`."""
        super().begin(total, done_before)
        self._last_line = time.monotonic()
        if done_before:
            self.note(f"{done_before} of {total} designs are calculated already")

    def advance(self, done_count: int, failed_count: int) -> None:
        """See `Progress`."""
        super().advance(done_count, failed_count)
        if time.monotonic() - self._last_line > _PAUSE:
            self._last_line, self._done_in_line = time.monotonic(), self.done_count
            self.note(self._state())

    def note(self, text: str) -> None:
        """See `Progress`."""
        sys.stderr.write(printable(text) + "\n")
        sys.stderr.flush()

    def end(self) -> None:
        """See `Progress`."""
        if self._done_in_line < self.done_count and self.done_before < self.done_count:
            self.note(self._state())

    def _state(self) -> str:
        rate = self.rate
        time_left = duration((self.total - self.done_count) / rate) if rate > 0 else "unknown time"
        failures = f", {self.failed_count} failed" if self.failed_count else ""
        return f"{self.done_count} of {self.total} designs{failures}, {rate:.3g}/s, {time_left} left"


class Bar(Progress):
    """A bar on the terminal."""

    def __init__(self) -> None:
        from rich import progress
        from rich.console import Console

        self._bar = progress.Progress(
            progress.TextColumn("designs"),
            progress.BarColumn(),
            progress.MofNCompleteColumn(),
            progress.TextColumn("{task.fields[rate]}"),
            progress.TimeElapsedColumn(),
            progress.TextColumn("left"),
            progress.TimeRemainingColumn(elapsed_when_finished=False),
            progress.TextColumn("{task.fields[failed]}"),
            console=Console(stderr=True),
        )
        self._task: Any = None

    def begin(self, total: int, done_before: int) -> None:
        """See `Progress`."""
        super().begin(total, done_before)
        self._bar.start()
        self._task = self._bar.add_task("designs", total=total, completed=done_before, rate="", failed="")

    def advance(self, done_count: int, failed_count: int) -> None:
        """See `Progress`."""
        super().advance(done_count, failed_count)
        failures = f"{self.failed_count} failed" if self.failed_count else ""
        self._bar.update(self._task, advance=done_count, rate=f"{self.rate:.3g}/s", failed=failures)

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
