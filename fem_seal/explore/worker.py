"""Processes beside the page: one makes ahead what the next move of a slider will need, one runs cases to the end.

They only see the newest design: what was asked before it and has not begun is dropped, and a run is left at its next
step. Both end with the page.
"""

from __future__ import annotations

import signal
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Event, RLock, Thread
from typing import TYPE_CHECKING, Any

from fem_seal.explore.live import WRONG, Session
from fem_seal.explore.screen import Screen, screen_of, without_interval

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.result import SealResult

_SCREENS = 64


@dataclass(frozen=True)
class Ask:
    """A design to work for.

    Parameters
    ----------
    design : dict
    folder : str
        Where the report of a complete run is to be written; empty for no report.
    """

    design: dict[str, str]
    folder: str = ""


@dataclass(frozen=True)
class Made:
    """Something made ahead, with its name."""

    name: Hashable
    what: Any


@dataclass(frozen=True)
class Written:
    """A report, or why there is none."""

    folder: str
    problem: str = ""


class _NewerAskedForError(BaseException):
    """A newer design is waiting: the run of the old one is left."""


class Worker:
    """A process that works for the newest design.

    Parameters
    ----------
    case : Case
    work : callable
        `make_ahead` or `run_to_the_end`.
    told : callable
        Gets what the process gives, from a thread of its own.
    """

    def __init__(
        self,
        case: Case,
        work: Callable[[Connection, Case], None],
        told: Callable[[Any], None],
    ) -> None:
        self._case, self._work, self._told = case, work, told
        self._lock = RLock()
        self._ended = Event()
        self._mine: Connection | None = None
        self._process: BaseProcess | None = None

    def ask(self, ask: Ask) -> None:
        """Work for a design from now on; the first time the process is started."""
        with self._lock:
            if not self.works:
                return
            if self._mine is None:
                self._mine = self._started()
            try:
                self._mine.send(ask)
            except (OSError, ValueError):
                self._ended.set()

    def _started(self) -> Connection:
        context = get_context("spawn")
        mine, theirs = context.Pipe()
        self._process = context.Process(target=self._work, args=(theirs, self._case), daemon=True)
        self._process.start()
        theirs.close()
        Thread(target=self._listen, args=(mine,), daemon=True).start()
        return mine

    @property
    def works(self) -> bool:
        """Whether the process is there."""
        return not self._ended.is_set()

    def close(self) -> None:
        """End the process."""
        self._ended.set()
        with self._lock:
            if self._process is not None:
                self._process.terminate()
                self._process.join(2.0)

    def _listen(self, mine: Connection) -> None:
        while not self._ended.is_set():
            try:
                got = mine.recv()
            except (EOFError, OSError):
                break
            self._told(got)
        self._ended.set()


def _of_the_page() -> None:
    """Ctrl-C is for the page, which ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _newest(conn: Connection, ask: Ask | None) -> Ask | None:
    """The last of what was asked; waits for it if there is nothing to do. Reports are never dropped."""
    while ask is None or (not ask.folder and conn.poll()):
        ask = conn.recv()
    return ask


def make_ahead(conn: Connection, case: Case) -> None:
    """Make what the newest design needs and then its neighbours.

    Parameters
    ----------
    conn : Connection
    case : Case
    """
    _of_the_page()
    session = Session(case)
    try:
        while True:
            ask = _newest(conn, None)
            assert ask is not None
            for name, design in _wanted(session, ask.design):
                if conn.poll():
                    break
                try:
                    conn.send(Made(name, session.make(name, design)))
                except WRONG:
                    continue
    except (EOFError, OSError, KeyboardInterrupt):
        return


def _wanted(session: Session, design: Mapping[str, str]) -> Iterator[tuple[Hashable, Mapping[str, str]]]:
    for other in session.neighbours(design):
        for name in session.needs(other):
            yield name, other


def run_to_the_end(conn: Connection, case: Case) -> None:
    """Run the newest design as `fem-seal run` does, and write its report where one is asked for.

    Parameters
    ----------
    conn : Connection
    case : Case
    """
    _of_the_page()
    session = Session(case)
    last: tuple[dict[str, str], SealResult] | None = None
    ask: Ask | None = None
    try:
        while True:
            ask = _newest(conn, ask)
            assert ask is not None

            def aside(_: str, ask: Ask = ask) -> None:
                if not ask.folder and conn.poll():
                    raise _NewerAskedForError

            try:
                if last is None or last[0] != ask.design:
                    last = None
                    last = ask.design, run_of(session, ask.design, aside)
                conn.send(complete_screen(ask.design, last[1]))
                if ask.folder:
                    last[1].write(ask.folder)
                    conn.send(Written(ask.folder))
            except _NewerAskedForError:
                pass
            except WRONG as error:
                conn.send(Written(ask.folder, str(error)) if ask.folder else _failed(ask, error))
            ask = None
    except (EOFError, OSError, KeyboardInterrupt):
        return


def _failed(ask: Ask, error: Exception) -> Screen:
    return Screen(ask.design, complete=True, problem=str(error))


def run_of(session: Session, design: Mapping[str, str], progress: Callable[[str], None]) -> SealResult:
    """What `fem-seal run` gives of a design.

    Parameters
    ----------
    session : Session
    design : mapping
    progress : callable
        Told in words what is being done.
    """
    from fem_seal import result

    return result.run(session.case(design), progress)


def complete_screen(design: Mapping[str, str], result: SealResult) -> Screen:
    """What is shown of a complete run.

    Parameters
    ----------
    design : mapping
    result : SealResult
    """
    return screen_of(
        result.case,
        design,
        result.loads,
        result.leak_ranges,
        result.judgement,
        complete=True,
        warnings=result.warnings,
    )


class Answers:
    """The newest screens of designs: live at once, complete when they are there.

    Parameters
    ----------
    session : Session
    alone : bool
        Whether there are no processes beside it; then nothing becomes complete.
    """

    def __init__(self, session: Session, *, alone: bool = False) -> None:
        self.session = session
        self._complete: OrderedDict[tuple[tuple[str, str], ...], Screen] = OrderedDict()
        self._pinned: OrderedDict[tuple[tuple[str, str], ...], Screen] = OrderedDict()
        self._written: OrderedDict[str, Written] = OrderedDict()
        self._lock, self._answering = RLock(), RLock()
        self._newest: dict[str, int] = {}
        self._news, self._waits = 0, False
        # until then the page makes what the case itself needs
        self._warm = False
        self._asked_ahead: dict[str, str] = {}
        session.waits = alone
        self._ahead = None if alone else Worker(session.given, make_ahead, self._told)
        self._runner = None if alone else Worker(session.given, run_to_the_end, self._told)

    def answer(self, design: Mapping[str, str], page: str = "", number: int = 0) -> Screen | None:
        """What is shown of a design; None if the page has asked for a newer one.

        Parameters
        ----------
        design : mapping
        page : str
            Name of the page that asks.
        number : int
            Of its question, counted up.
        """
        design = self.session.design(design)
        with self._lock:
            self._newest[page] = max(number, self._newest.get(page, 0))
        with self._answering:
            if number < self._newest[page]:
                return None
            live = self.session.answer(design)
            self._waits = bool(live.waiting)
        if self._warm:
            self._make_ahead(design)
        return self._with_run(live)

    def screen(self, design: Mapping[str, str]) -> Screen:
        """What is shown of a design that no slider moves, such as a pinned one."""
        design = self.session.design(design)
        with self._lock:
            live = self._pinned.get(_name(design))
        if live is None:
            with self._answering:
                live = self.session.answer(design)
            if not live.waiting:
                with self._lock:
                    self._pinned[_name(design)] = live
                    while len(self._pinned) > _SCREENS:
                        self._pinned.popitem(last=False)
        return self._with_run(live)

    def _make_ahead(self, design: dict[str, str]) -> None:
        self._warm = True
        if self._ahead is not None and design != self._asked_ahead:
            self._asked_ahead = design
            self._ahead.ask(Ask(design))

    @property
    def news(self) -> int:
        """Grows with everything that the page may be waiting for."""
        return self._news

    def is_newest(self, page: str, number: int) -> bool:
        """Whether a page has asked for nothing newer."""
        with self._lock:
            return number >= self._newest.get(page, 0)

    @property
    def works(self) -> bool:
        """Whether complete runs can follow."""
        return self._runner is not None and self._runner.works

    def warm_up(self) -> None:
        """Make what the case itself needs, while the browser opens."""

        def make() -> None:
            try:
                own = self.session.design({})
                for name in self.session.needs(own):
                    self.session.make(name, own)
                self._news += 1
                self.settle(own)
                self._make_ahead(own)
            except WRONG:
                return

        Thread(target=make, daemon=True).start()

    def settle(self, design: Mapping[str, str]) -> None:
        """Begin with the complete run of a design."""
        design = self.session.design(design)
        if self._runner is not None and self.complete(design) is None:
            self._runner.ask(Ask(design))

    def complete(self, design: Mapping[str, str]) -> Screen | None:
        """The screen of a design's complete run, if it is there."""
        with self._lock:
            return self._complete.get(_name(self.session.design(design)))

    def report(self, design: Mapping[str, str], folder: Path) -> None:
        """Begin with the report of a design."""
        assert self._runner is not None
        self._runner.ask(Ask(self.session.design(design), str(folder)))

    def written(self, folder: Path) -> Written | None:
        """A report that was asked for, if it is there."""
        with self._lock:
            return self._written.get(str(folder))

    def close(self) -> None:
        """End the processes."""
        for worker in (self._ahead, self._runner):
            if worker is not None:
                worker.close()

    def _with_run(self, live: Screen) -> Screen:
        complete = self.complete(live.design)
        if complete is None:
            return live
        # beside an interval that has been widened, that of the readings alone is none
        between = tuple(map(without_interval, live.between)) if live.widens else live.between
        return replace(complete, between=between)

    def _told(self, got: object) -> None:
        with self._lock:
            if isinstance(got, Made):
                self._news += self._waits
                self.session.kept.put(got.name, got.what)
            elif isinstance(got, Written):
                self._written[got.folder] = got
            elif isinstance(got, Screen):
                self._news += 1
                self._complete[_name(got.design)] = got
                while len(self._complete) > _SCREENS:
                    self._complete.popitem(last=False)


def _name(design: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    return tuple(sorted(design.items()))
