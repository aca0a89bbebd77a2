"""What is shown of designs, calculated in two processes: one follows the sliders, one makes complete runs and reports.

A process that dies or hangs is replaced, and what it was doing is done once more. A run is left at its next step when
another one is asked for; both processes end with the page.
"""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import islice
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from threading import Lock, RLock, Thread
from typing import TYPE_CHECKING, Any, TypeAlias

from fem_seal.errors import InputError, SealError, defect_text, errors_in
from fem_seal.explore.screen import Screen, lost_words, screen_of, sensitivity_words, without_interval
from fem_seal.explore.session import WRONG, Calculate, Session
from fem_seal.processes import can_copy
from fem_seal.seal.keyed_store import KeyedStore

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.result import SealResult
    from fem_seal.seal.load_solver import Progress

_SCREENS = 256
# For so long a design of the sliders is calculated, and a run that is left goes on, before it is taken to hang [s].
_PATIENCE = 60.0
# For so long the page says that a process was replaced [s].
_NOTICE_TIME = 60.0
# Designs with another surface that are calculated ahead while the sliders rest: their conductivities take longest.
_NEIGHBOURS = 40


@dataclass(frozen=True)
class Calculation:
    """A design to calculate.

    Parameters
    ----------
    case : Case
        Of the design.
    design : dict
    folder : str
        Where the report of a complete run is to be written; empty for no report.
    """

    case: Case = field(compare=False, repr=False)
    design: dict[str, str]
    folder: str = ""


# What a process makes of a calculation, piece by piece; it can ask whether it is to leave it.
Work: TypeAlias = "Callable[[Calculation, Callable[[], bool]], Iterator[Screen]]"


class LostError(SealError):
    """Two processes have ended over the same calculation, or one has taken too long."""


class LeftError(BaseException):
    """Another run is asked for: this one is left."""


class Calculator:
    """A process that makes one calculation after the other.

    Parameters
    ----------
    work : callable
        Makes in the process what calculates: `live_work` or `complete_work`.
    notify : callable
        Told in words when a process has ended that was not to.
    """

    def __init__(self, work: Callable[[], Work], notify: Callable[[str], None]) -> None:
        self._work, self._notify = work, notify
        self._turn, self._lock = Lock(), RLock()
        self._connection: Connection | None = None
        self._process: BaseProcess | None = None
        self._current: Calculation | None = None
        self._deadline = math.inf
        self._is_closed = False

    def start(self) -> None:
        """Start the process, if there is none: a copy of this one, where that may be."""
        with self._lock:
            if self._is_closed:
                raise LostError
            if self._connection is None:
                context = get_context("fork" if can_copy() else "spawn")
                mine, theirs = context.Pipe()
                ends = (self._work, theirs, mine)
                process = context.Process(target=_serve, args=ends, daemon=True)  # type: ignore[attr-defined]
                process.start()
                theirs.close()
                self._connection, self._process = mine, process

    def screens(self, calculation: Calculation, limit: float = math.inf) -> Iterator[Screen]:
        """What a calculation gives, piece by piece.

        Parameters
        ----------
        calculation : Calculation
        limit : float
            Time after which the process is taken to hang [s].

        Raises
        ------
        LostError
            If two processes have ended over it, or one has taken too long.
        LeftError
            If it was left.
        """
        with self._turn:
            for is_last in (False, True):
                try:
                    self.start()
                    self._send(calculation, limit)
                    while (got := self._receive()) is not None:
                        if isinstance(got, BaseException):
                            raise got
                        yield got
                    return
                except (EOFError, OSError):
                    self._say_end(is_last=is_last or time.monotonic() > self._deadline)
                finally:
                    self._current = None

    def leave(self) -> None:
        """Leave a run that is going on, unless a report depends on it."""
        if self._current is not None and not self._current.folder:
            with suppress(OSError):
                self._send(None, _PATIENCE)

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._is_closed = True
            if self._process is not None:
                self._process.kill()
                self._process.join(2.0)

    def _send(self, calculation: Calculation | None, limit: float) -> None:
        with self._lock:
            self._deadline = time.monotonic() + limit
            self._current = calculation or self._current
            if self._connection is not None:
                self._connection.send(calculation)

    def _receive(self) -> Any:
        assert self._connection is not None and self._process is not None
        while not self._connection.poll(1.0):
            if time.monotonic() > self._deadline:
                self._process.kill()
        return self._connection.recv()

    def _say_end(self, *, is_last: bool) -> None:
        """Say that the process has ended, and after the last one raise it."""
        with self._lock:
            if self._is_closed or self._connection is None or self._process is None:
                raise LostError("There is no process to calculate with.")
            self._connection.close()
            self._connection = None
            self._process.join()
            has_hung = time.monotonic() > self._deadline
            message = lost_words(None if has_hung else self._process.exitcode or 0, has_successor=not is_last)
        self._notify(message)
        if is_last:
            raise LostError(message)


def _serve(work: Callable[[], Work], mine: Connection, theirs: Connection) -> None:
    """Calculate in a process that knows when the page has ended: no copy of its end of the connection stays."""
    theirs.close()
    # Ctrl-C is for the page, which ends its processes
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(EOFError, OSError):
        calculate = work()
        while True:
            if (calculation := mine.recv()) is None:
                # what was to be left is done
                continue
            try:
                for screen in calculate(calculation, mine.poll):
                    mine.send(screen)
            except (InputError, LeftError) as error:
                mine.send(error)
            except Exception as error:
                # others may hold what cannot be sent
                mine.send(SealError(_error_text(error)))
            else:
                mine.send(None)


def _error_text(error: Exception) -> str:
    return str(error) if isinstance(error, (*WRONG, OSError)) else defect_text(error)


def live_work() -> Work:
    """What calculates the designs of the sliders."""
    from fem_seal.explore.live import live_screen

    def calculate(calculation: Calculation, _: Callable[[], bool]) -> Iterator[Screen]:
        with errors_in(calculation.case.display):
            yield live_screen(calculation.case, calculation.design)

    return calculate


def complete_work() -> Work:
    """What makes complete runs, as `fem-seal run` does, and writes reports."""
    from fem_seal.result import run

    results: dict[str, SealResult] = {}

    def calculate(calculation: Calculation, is_abandoned: Callable[[], bool]) -> Iterator[Screen]:
        def progress(_: str) -> None:
            if not calculation.folder and is_abandoned():
                raise LeftError

        design, name = calculation.design, str(calculation.design)
        try:
            if name not in results:
                results.clear()
                results[name] = run(calculation.case, progress, sensitivities=False)
            # of a path of loads they take too long
            follow = results[name].problem.leaks and not results[name].problem.follows_path
            yield complete_screen(design, results[name], follow=follow)
            if follow:
                results[name] = with_sensitivities(results[name], progress)
                yield complete_screen(design, results[name])
            if calculation.folder:
                results[name].write(calculation.folder)
        except Exception as error:
            if calculation.folder:
                raise
            yield Screen(design, complete=True, problem=_error_text(error))

    return calculate


def with_sensitivities(result: SealResult, progress: Progress) -> SealResult:
    """A result with its sensitivities, which whoever waits for its numbers has not waited for.

    Parameters
    ----------
    result : SealResult
    progress : callable
        Called before each.
    """
    from fem_seal.answers.answer import Request
    from fem_seal.answers.sensitivities import SENSITIVITIES
    from fem_seal.seal.load_solver import Clock, LoadSolver

    request = Request(
        LoadSolver(result.problem, result.model),
        Clock(progress),
        sensitivities=True,
        answers=dict(result.answers),
    )
    return result.with_answers(sensitivities=SENSITIVITIES.compute_or_fall_back(result, request))


def complete_screen(design: Mapping[str, str], result: SealResult, *, follow: bool = False) -> Screen:
    """What is shown of a complete run.

    Parameters
    ----------
    design : mapping
    result : SealResult
    follow : bool
        Whether its sensitivities are still being calculated.
    """
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
        Of the case with which the page was opened.
    calculate : callable, optional
        Calculates designs of the sliders; in a process of its own unless given.
    """

    def __init__(self, session: Session, calculate: Calculate | None = None) -> None:
        # that of the command, and that with which a page begins that is opened again
        self.session = self.newest = session
        self._sessions = {"": session}
        self._calculate = calculate or self._calculate_apart
        self._live, self._complete = KeyedStore(_SCREENS), KeyedStore(_SCREENS)
        self._lock, self._answer_lock = RLock(), RLock()
        # the newest question of each page; grows with everything that a page may be waiting for
        self._newest: dict[str, int] = {}
        self.news = 0
        # the design whose run has begun, and those whose runs ended their process, with the reason
        self._run_design: dict[str, str] = {}
        self._given_up: dict[tuple[tuple[str, str], ...], str] = {}
        # reports that are done: why there is none, or nothing
        self._report_problems: dict[str, str] = {}
        self._loss, self._lost_at = "", -math.inf
        self._designs, self._runs = Calculator(live_work, self._say), Calculator(complete_work, self._say)
        self._first_thread = Thread(target=self.screen, args=({},), daemon=True)
        self._queue = ThreadPoolExecutor(1)
        self._is_closed = False

    def of(self, design: Mapping[str, str]) -> Session:
        """The session of the case that a design belongs to.

        Raises
        ------
        KeyError
            If the page has no such case.
        """
        return self._sessions[design.get("case", "")]

    def open_case(self, case: Case) -> Session:
        """The session of another case."""
        with self._lock:
            name = str(len(self._sessions))
            session = self._sessions[name] = Session(case, name)
            return session

    def knows_case(self, design: Mapping[str, str]) -> bool:
        """Whether the case that a design belongs to is one of this page."""
        return design.get("case", "") in self._sessions

    def begin(self) -> None:
        """Calculate the first numbers in another process, while this one loads what the page needs."""
        self._designs.start()
        self._first_thread.start()

    def first_screen(self, limit: float) -> Screen | None:
        """The first numbers, for a page that begins with the case's own design; None if they take longer.

        Parameters
        ----------
        limit : float
            [s]
        """
        if self.newest is not self.session or self._first_thread.ident is None:
            return None
        self._first_thread.join(limit)
        first = self._live.find(_name(self.session.design({})))
        return None if first is None else self._with_run(first)

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
        with self._lock:
            self._newest[page] = max(number, self._newest.get(page, 0))
        with self._answer_lock:
            return self.screen(design) if number >= self._newest[page] else None

    def screen(self, design: Mapping[str, str]) -> Screen:
        """What is shown of a design."""
        session = self.of(design)
        design = session.design(design)
        with self._answer_lock:
            live: Screen | None = self._live.find(_name(design))
            if live is None:
                live = session.answer(design, self._calculate)
                if not live.problem:
                    self._live.put(_name(design), live)
        return self._with_run(live)

    def work_ahead(self, design: Mapping[str, str], page: str, number: int) -> None:
        """Begin with the complete run of a design and calculate its neighbours, until the page asks for another one.

        Parameters
        ----------
        design, page, number
            See `answer`.
        """
        if self._is_at_rest(page, number):
            self.settle(design)
        for neighbour in islice(self.of(design).neighbours(design), _NEIGHBOURS):
            if not self._is_at_rest(page, number) or self.screen(neighbour).delay:
                break

    def settle(self, design: Mapping[str, str]) -> None:
        """Begin with the complete run of a design."""
        session = self.of(design)
        design = session.design(design)
        with self._lock:
            if design == self._run_design or self.complete(design) or self.failure_reason(design):
                return
            self._run_design = design
        self._begin(Calculation(session.case(design), design))

    def report(self, design: Mapping[str, str], folder: Path) -> None:
        """Begin with the report of a design."""
        session = self.of(design)
        self._begin(Calculation(session.case(design), session.design(design), str(folder)))

    def report_problem(self, folder: Path) -> str | None:
        """Why there is no report of those that were asked for; empty if there is one, None while it is made."""
        return self._report_problems.get(str(folder))

    def complete(self, design: Mapping[str, str]) -> Screen | None:
        """The screen of a design's complete run, if it is there."""
        screen: Screen | None = self._complete.find(_name(self.of(design).design(design)))
        return screen

    def failure_reason(self, design: Mapping[str, str]) -> str:
        """Why no complete run of a design follows; empty if one may."""
        return self._given_up.get(_name(self.of(design).design(design)), "")

    @property
    def loss_message(self) -> str:
        """What became of a process that ended a short while ago; empty if none did."""
        return self._loss if time.monotonic() - self._lost_at < _NOTICE_TIME else ""

    def close(self) -> None:
        """End the processes."""
        self._is_closed = True
        self._queue.shutdown(wait=False, cancel_futures=True)
        self._designs.close()
        self._runs.close()

    def _is_at_rest(self, page: str, number: int) -> bool:
        """Whether a page has asked for nothing newer."""
        return not self._is_closed and number >= self._newest.get(page, 0)

    def _calculate_apart(self, case: Case, design: Mapping[str, str]) -> Screen:
        (screen,) = self._designs.screens(Calculation(case, dict(design)), _PATIENCE)
        return screen

    def _with_run(self, live: Screen) -> Screen:
        complete = self.complete(live.design)
        if complete is None:
            return live
        # beside an interval that has been widened, that of the readings alone is none
        curve = tuple(map(without_interval, live.curve_loads)) if live.widens else live.curve_loads
        return replace(complete, curve_loads=curve)

    def _begin(self, calculation: Calculation) -> None:
        """Run a design after what is going on, which is left unless it is a report."""
        self._runs.leave()
        if not self._is_closed:
            self._queue.submit(self._run, calculation)

    def _run(self, calculation: Calculation) -> None:
        if not calculation.folder and calculation.design != self._run_design:
            return
        name, problem = _name(calculation.design), ""
        try:
            for screen in self._runs.screens(calculation):
                self._complete.put(name, screen)
                self._given_up.pop(name, None)
                self.news += 1
        except LeftError:
            # for a report, unless for another design
            self._begin(calculation)
            return
        except SealError as error:
            problem = str(error)
            if not calculation.folder:
                self._given_up[name] = problem
        if calculation.folder:
            self._report_problems[calculation.folder] = problem
        elif self._run_design == calculation.design:
            self._run_design = {}
        self.news += 1

    def _say(self, message: str) -> None:
        self._loss, self._lost_at = message, time.monotonic()
        self.news += 1


def _name(design: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    return tuple(sorted(design.items()))
