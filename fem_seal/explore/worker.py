"""Worker processes of the page: one prepares the next moves of the sliders, one runs complete cases.

They only see the newest design: what was asked before it and has not begun is dropped, and a run is left at its next
step. Both end with the page; one that ends before it (killed, out of memory) is replaced, and what it was doing is done
once more.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Hashable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Event, RLock, Thread
from typing import TYPE_CHECKING, Any

from fem_seal.errors import unexpected
from fem_seal.explore.screen import Screen, lost_words, screen_of, sensitivity_words, without_interval
from fem_seal.explore.session import WRONG, Session
from fem_seal.processes import can_copy
from fem_seal.seal.kept import Kept
from fem_seal.units import shown_in

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.result import SealResult
    from fem_seal.seal.load_solver import Progress

_SCREENS = 64
# Processes that may end over the same work.
_MOST_DEATHS = 2
# For so long the page says that a process was replaced [s].
_TOLD_FOR = 60.0
# For so long what the first numbers were made with waits for a browser that shows them [s].
_SHOWN_WITHIN = 10.0


@dataclass(frozen=True)
class Ask:
    """A design to work for.

    Parameters
    ----------
    design : dict
    folder : str
        Where the report of a complete run is to be written; empty for no report.
    first : bool
        Whether the page waits for its live numbers, too: its own process does not calculate yet.
    case : Case, optional
        That the design belongs to; that of the process unless given.
    """

    design: dict[str, str]
    folder: str = ""
    first: bool = False
    case: Case | None = field(default=None, compare=False, repr=False)

    def session(self, last: Session) -> Session:
        """The session of its case, another one than the last where the case is."""
        name = self.design.get("case", "")
        return last if self.case is None or name == last.name else Session(self.case, name=name, like=last)


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


@dataclass(frozen=True)
class Lost:
    """A process has ended that was not to; another one has its work, or nobody has.

    Parameters
    ----------
    code : int
        With which it ended; minus the number of the signal that killed it.
    again : tuple of Ask
        What the other one does again.
    left : tuple of Ask
        What is not tried again.
    """

    code: int
    again: tuple[Ask, ...] = ()
    left: tuple[Ask, ...] = ()


class Worker:
    """A process that works for the newest design; where it ends before its time, another one takes its place.

    Parameters
    ----------
    case : Case
    work : callable
        `make_ahead` or `run_to_the_end`.
    told : callable
        Gets what the process gives and what becomes of it, from a thread of its own.
    """

    def __init__(
        self, case: Case, work: Callable[[Connection, Case], None], told: Callable[[Any], None]
    ) -> None:
        self._case, self._work, self._told = case, work, told
        self._lock = RLock()
        self._mine: Connection | None = None
        self._process: BaseProcess | None = None
        # what it has not answered, and how many processes have ended over it
        self._open: list[tuple[Ask, int]] = []
        # whether the process has proved that it can work
        self._proved, self._closed = False, False

    def ask(self, ask: Ask) -> None:
        """Work for a design from now on; the first time the process is started."""
        with self._lock:
            if self._closed or any(one == ask for one, _ in self._open):
                return
            # of designs the newest is left, of reports all
            self._open = [one for one in self._open if ask.folder or one[0].folder] + [(ask, 0)]
            if self._mine is None:
                self._start()
            else:
                self._send(ask)

    def _start(self) -> None:
        """Start a process and give it all that is open: a copy of this one, where that may be, knows the case."""
        context = get_context("fork" if can_copy() else "spawn")
        mine, theirs = context.Pipe()
        given = (self._work, mine, theirs, self._case)
        self._process = context.Process(target=_begun, args=given, daemon=True)  # type: ignore[attr-defined]
        self._process.start()
        theirs.close()
        self._mine, self._proved = mine, False
        Thread(target=self._listen, args=(mine, self._process), daemon=True).start()
        for ask, _ in self._open:
            self._send(ask)

    def _send(self, ask: Ask) -> None:
        assert self._mine is not None
        # where it has ended just now, who listens to it gives the work to another one
        with suppress(OSError, ValueError):
            self._mine.send(ask)

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._closed = True
            if self._process is not None:
                self._process.terminate()
                self._process.join(2.0)

    def _listen(self, mine: Connection, process: BaseProcess) -> None:
        while True:
            try:
                got = mine.recv()
            except (EOFError, OSError):
                break
            with self._lock:
                self._proved = True
                self._open = [one for one in self._open if not _answers(got, one[0])]
            self._told(got)
        process.join()
        with self._lock:
            if not self._closed:
                self._replace(process.exitcode or 0)

    def _replace(self, code: int) -> None:
        """Another process for one that has ended, with what it left undone but for what has ended several."""
        mine, self._mine = self._mine, None
        if mine is not None:
            mine.close()
        counted = [(ask, deaths + 1) for ask, deaths in self._open]
        self._open = [one for one in counted if one[1] < _MOST_DEATHS]
        left = tuple(ask for ask, deaths in counted if deaths >= _MOST_DEATHS)
        again = tuple(ask for ask, _ in self._open)
        # one that could do nothing at all is not started for nothing
        try:
            if again or self._proved:
                self._start()
        except OSError:
            again, left, self._open = (), (*again, *left), []
        self._told(Lost(code, again, left))


def _begun(
    work: Callable[[Connection, Case], None], theirs: Connection, mine: Connection, case: Case
) -> None:
    """Work in a process that knows when the page has ended: no copy of its end of the connection stays."""
    theirs.close()
    work(mine, case)


def _answers(got: object, ask: Ask) -> bool:
    """Whether something given by a process is what was asked for."""
    if isinstance(got, Written):
        return got.folder == ask.folder
    return isinstance(got, Screen) and not ask.folder and got.design == ask.design


def _next(conn: Connection, waiting: list[Ask]) -> Ask:
    """What is to be done next of what waits and what was asked since: reports in their order, then the newest design.

    It stays among what waits.
    """
    while not waiting or conn.poll():
        got: Ask = conn.recv()
        waiting[:] = [one for one in waiting if got.folder or one.folder] + [got]
    return next((one for one in waiting if one.folder), waiting[-1])


def make_ahead(conn: Connection, case: Case) -> None:
    """Make what the newest design needs and then its neighbours.

    Parameters
    ----------
    conn : Connection
    case : Case
    """
    # Ctrl-C is for the page, which ends its workers
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    session = Session(case)
    try:
        while True:
            ask = _next(conn, [])
            session = ask.session(session)
            if ask.first:
                made = [Made(name, session.make(name)) for name in session.needs(ask.design)]
                for what in (session.answer(ask.design), *made):
                    conn.send(what)
            for name in chain.from_iterable(map(session.needs, session.neighbours(ask.design))):
                if conn.poll():
                    break
                try:
                    what = Made(name, session.make(name))
                except Exception:
                    # what goes wrong here does so again, and is said, where it is asked for
                    continue
                conn.send(what)
    except (EOFError, OSError, KeyboardInterrupt):
        return


def run_to_the_end(conn: Connection, case: Case) -> None:
    """Run the newest design as `fem-seal run` does, and write its report where one is asked for.

    Parameters
    ----------
    conn : Connection
    case : Case
    """
    from fem_seal.result import run

    # Ctrl-C is for the page, which ends its workers
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    session = Session(case)
    last: tuple[dict[str, str], SealResult] | None = None
    waiting: list[Ask] = []
    try:
        while True:
            ask = _next(conn, waiting)
            session = ask.session(session)

            def aside(_: str, ask: Ask = ask) -> None:
                if not ask.folder and conn.poll():
                    raise _NewerAskedForError

            try:
                if last is None or last[0] != ask.design:
                    last = None
                    last = ask.design, run(session.case(ask.design), aside, sensitivities=False)
                # of a path of loads they take too long
                follow = last[1].problem.leaks and not last[1].problem.follows_path
                conn.send(complete_screen(*last, follow=follow))
                if follow:
                    last = ask.design, with_sensitivities(last[1], aside)
                    conn.send(complete_screen(*last))
                if ask.folder:
                    last[1].write(ask.folder)
                    conn.send(Written(ask.folder))
            except _NewerAskedForError:
                continue
            except Exception as error:
                why = str(error) if isinstance(error, (*WRONG, OSError)) else unexpected(error)
                failed = Screen(ask.design, complete=True, problem=why)
                conn.send(Written(ask.folder, why) if ask.folder else failed)
            waiting.remove(ask)
    except (EOFError, OSError, KeyboardInterrupt):
        return


def with_sensitivities(result: SealResult, progress: Progress) -> SealResult:
    """A result with its sensitivities, which whoever waits for its numbers has not waited for.

    Parameters
    ----------
    result : SealResult
    progress : callable
        Called before each.
    """
    from fem_seal.answers.answer import Inquiry, Wanted
    from fem_seal.answers.sensitivities import SENSITIVITIES
    from fem_seal.seal.load_solver import Clock, LoadSolver

    ask = Inquiry(
        LoadSolver(result.problem, result.model),
        Clock(progress),
        Wanted(sensitivities=True),
        answers=dict(result.answers),
    )
    return result.answered(sensitivities=SENSITIVITIES.found(result, ask))


def complete_screen(design: Mapping[str, str], result: SealResult, *, follow: bool = False) -> Screen:
    """What is shown of a complete run.

    Parameters
    ----------
    design : mapping
    result : SealResult
    follow : bool
        Whether its sensitivities are still being calculated.
    """
    with shown_in(*result.case.shown):
        return screen_of(
            result,
            design,
            complete=True,
            warnings=result.warnings,
            sensitivities=sensitivity_words(result, follow=follow),
        )


class Answers:
    """The newest screens of designs: live at once, complete when they are there.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        self.session = self.newest = session
        self._sessions = {"": session}
        self._complete, self._pinned = Kept(_SCREENS), Kept(_SCREENS)
        self._written: dict[str, Written] = {}
        self._lock, self._answering = RLock(), RLock()
        self._newest: dict[str, int] = {}
        # grows with everything that the page may be waiting for
        self.news = 0
        self._waits = False
        # the first numbers come from another process, which calculates while this one makes the page
        self._awaited: dict[str, str] | None = None
        self._first: Screen | None = None
        self._first_there, self._first_shown = Event(), Event()
        session.waits = False
        # designs whose runs ended their process, and why; what the page says of it, and when it happened
        self._given_up: dict[tuple[tuple[str, str], ...], str] = {}
        self._lost, self._lost_at = "", 0.0
        self._ahead = Worker(session.given, make_ahead, self._told_ahead)
        self._runner = Worker(session.given, run_to_the_end, self._receive)

    def of(self, design: Mapping[str, str]) -> Session:
        """The session of the case that a design belongs to.

        Raises
        ------
        KeyError
            If the page has no such case.
        """
        return self._sessions[design.get("case", "")]

    def opened(self, case: Case) -> Session:
        """The session of another case."""
        with self._lock:
            name = str(len(self._sessions))
            made = self._sessions[name] = Session(case, name=name, like=self.session)
            return made

    def has(self, design: Mapping[str, str]) -> bool:
        """Whether the case that a design belongs to is one of this page."""
        return design.get("case", "") in self._sessions

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
        session = self.of(design)
        design = session.design(design)
        with self._lock:
            # with which a page begins that is opened again
            self.newest = session
            self._newest[page] = max(number, self._newest.get(page, 0))
        if design == self._awaited:
            return self._first_answer(design)
        with self._answering:
            if number < self._newest[page]:
                return None
            live = self.of(design).answer(design)
            self._waits = bool(live.waiting)
        self._make_ahead(design)
        return self._with_run(live)

    def _first_answer(self, design: dict[str, str]) -> Screen:
        """What the other process has found of the case's own design; until then its section."""
        if self._first is None:
            return self.session.answer(design, waiting="the first numbers")
        self._first_shown.set()
        return self._with_run(self._first)

    def first(self, within: float) -> Screen | None:
        """The first numbers, for a page that begins with the case's own design; None if they take longer.

        Parameters
        ----------
        within : float
            [s]
        """
        if self._awaited is None or self.newest is not self.session:
            return None
        self._first_there.wait(within)
        return None if self._first is None else self._with_run(self._first)

    def screen(self, design: Mapping[str, str]) -> Screen:
        """What is shown of a design that no slider moves, such as a pinned one."""
        design = self.of(design).design(design)
        live = self._pinned.known(_name(design))
        if live is None:
            with self._answering:
                live = self.of(design).answer(design)
            if not live.waiting:
                self._pinned.put(_name(design), live)
        return self._with_run(live)

    def _make_ahead(self, design: dict[str, str]) -> None:
        self._ahead.ask(Ask(design, case=self.of(design).given))

    def is_newest(self, page: str, number: int) -> bool:
        """Whether a page has asked for nothing newer."""
        with self._lock:
            return number >= self._newest.get(page, 0)

    def given_up(self, design: Mapping[str, str]) -> str:
        """Why no complete run of a design follows; empty if one may."""
        with self._lock:
            return self._given_up.get(_name(self.of(design).design(design)), "")

    @property
    def lost(self) -> str:
        """What became of a process that ended a short while ago; empty if none did."""
        with self._lock:
            return self._lost if time.monotonic() - self._lost_at < _TOLD_FOR else ""

    def begin(self) -> None:
        """Calculate the first numbers in another process, while this one loads what the page needs."""
        own = self.session.design({})
        with suppress(*WRONG):
            if not self.session.slow(self.session.case(own)):
                self._awaited = own
                self._ahead.ask(Ask(own, first=True))

    def settle(self, design: Mapping[str, str]) -> None:
        """Begin with the complete run of a design."""
        design = self.of(design).design(design)
        if self.complete(design) is None and not self.given_up(design):
            self._runner.ask(Ask(design, case=self.of(design).given))

    def complete(self, design: Mapping[str, str]) -> Screen | None:
        """The screen of a design's complete run, if it is there."""
        found: Screen | None = self._complete.known(_name(self.of(design).design(design)))
        return found

    def report(self, design: Mapping[str, str], folder: Path) -> None:
        """Begin with the report of a design."""
        session = self.of(design)
        self._runner.ask(Ask(session.design(design), str(folder), case=session.given))

    def written(self, folder: Path) -> Written | None:
        """A report that was asked for, if it is there."""
        with self._lock:
            return self._written.get(str(folder))

    def close(self) -> None:
        """End the processes."""
        self._ahead.close()
        self._runner.close()

    def _with_run(self, live: Screen) -> Screen:
        complete = self.complete(live.design)
        if complete is None:
            return live
        # beside an interval that has been widened, that of the readings alone is none
        between = tuple(map(without_interval, live.between)) if live.widens else live.between
        return replace(complete, between=between)

    def _receive(self, got: object) -> None:
        with self._lock:
            if isinstance(got, Written):
                self._written[got.folder] = got
            elif isinstance(got, Screen):
                self.news += 1
                name = _name(got.design)
                self._complete.put(name, got)
                self._given_up.pop(name, None)
            elif isinstance(got, Lost):
                self._say_lost(got)
                for ask in got.left:
                    if ask.folder:
                        self._written[ask.folder] = Written(ask.folder, self._lost)
                    else:
                        self._given_up[_name(ask.design)] = self._lost

    def _told_ahead(self, got: object) -> None:
        with self._lock:
            if isinstance(got, Made):
                self.news += self._waits
                self.session.live.keep(got.name, got.what)
            elif isinstance(got, Screen):
                self._first = got
                self._first_there.set()
                self.news += 1
            elif isinstance(got, Lost):
                self._say_lost(got)
                if any(ask.first for ask in got.left):
                    # it is this process's turn
                    self._awaited, self.session.waits = None, True
                    self._first_there.set()
        if isinstance(got, Screen):
            # what follows loads what calculates: not before the numbers are on their way
            self._first_shown.wait(_SHOWN_WITHIN)
            self.settle(got.design)

    def _say_lost(self, lost: Lost) -> None:
        self._lost = lost_words(lost.code, bool(lost.again), bool(lost.left))
        self._lost_at = time.monotonic()
        self.news += 1


def _name(design: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    return tuple(sorted(design.items()))
