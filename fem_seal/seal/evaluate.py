"""The evaluator: solve the loads of problems, for runs, studies and the live page alike.

They differ in where condensed bodies and flow conductivities come from (`fem_seal.seal.sources`). Several problems are
solved side by side: one kind of work for all of them, then the next.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, TypeAlias, TypeVar

from fem_seal.contact.load_path import Leave
from fem_seal.contact.model import ContactModel
from fem_seal.contact.newton import ContactProblem, solve_many
from fem_seal.contact.sizing import MeshFit, fit_meshes
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError, LimitLoadError, LoadProblem, LongPathError, NoLoadLeftError
from fem_seal.seal.cost import about, path_seconds
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import Clock, LoadSolver, SolvedLoads, solve_loads
from fem_seal.seal.problem import Loads, SealProblem, sizing
from fem_seal.seal.sources import EXACT, NearSolved, Source
from meshes import MeshingError, SealMesh

if TYPE_CHECKING:
    pass

T = TypeVar("T")
Asked = TypeVar("Asked")

# What a body does not bear it does not bear on a finer mesh, where load steps are no longer either.
_ON_ANY_MESH = (LimitLoadError, LongPathError)

# Entered while work is done for the design of that number, None for what is done for several at once.
Turn: TypeAlias = Callable[[int | None], AbstractContextManager[None]]


def untimed(number: int | None) -> AbstractContextManager[None]:
    """No-op: no time limit."""
    return nullcontext()


@dataclass
class Batch:
    """Designs by number: how long each has taken, and which of them failed.

    Parameters
    ----------
    turn : callable
        Entered with the number of a design while work is done for it.

    Examples
    --------
    >>> batch = Batch()
    >>> batch.each([0, 1, 2], lambda number: 1 / number)
    {1: 1.0, 2: 0.5}
    >>> batch.failed
    {0: ZeroDivisionError('division by zero')}
    """

    turn: Turn = untimed
    seconds: dict[int, float] = field(default_factory=dict)
    failed: dict[int, Exception] = field(default_factory=dict)

    def each(self, numbers: Iterable[int], step: Callable[[int], T]) -> dict[int, T]:
        """What a step finds for each design that has not failed; one that fails now is left out from here on.

        Parameters
        ----------
        numbers : iterable of int
        step : callable
            Given the number of a design.
        """
        found: dict[int, T] = {}
        for number in numbers:
            if number in self.failed:
                continue
            start = time.perf_counter()
            with self.turn(number):
                try:
                    found[number] = step(number)
                except Exception as error:  # its own affair: the others go on
                    self.failed[number] = error
            self._spent(number, time.perf_counter() - start)
        return found

    def at_once(
        self, asked: Mapping[int, Asked], answers: Callable[[Sequence[Asked]], Sequence[T | Exception]]
    ) -> dict[int, T | Exception]:
        """Answers to what designs ask, found for all of them at once; an error is the answer of the one it belongs to.

        Parameters
        ----------
        asked : mapping
            By the number of the design.
        answers : callable
            Given all that is asked.
        """
        if not asked:
            return {}
        start = time.perf_counter()
        with self.turn(next(iter(asked)) if len(asked) == 1 else None):
            found = _answers(list(asked.values()), answers)
        for number in asked:
            self._spent(number, (time.perf_counter() - start) / len(asked))
        return dict(zip(asked, found, strict=True))

    def _spent(self, number: int, seconds: float) -> None:
        self.seconds[number] = self.seconds.get(number, 0.0) + seconds


def _answers(
    asked: Sequence[Asked], answers: Callable[[Sequence[Asked]], Sequence[T | Exception]]
) -> list[T | Exception]:
    try:
        return list(answers(asked))
    except Exception as error:
        return [error] if len(asked) == 1 else [found for one in asked for found in _answers([one], answers)]


def _but(every: Sequence[T], gone: Collection[int]) -> Sequence[T]:
    return [one for place, one in enumerate(every) if place not in gone]


# Tells nobody what is being done.
SILENT = Clock(lambda text: None)


@dataclass(frozen=True, eq=False)
class Evaluation:
    """A problem with its loads solved, which work out what they are asked for.

    Parameters
    ----------
    problem : SealProblem
        Without the loads that could not be solved; its form error knows how many waves its tolerance holds.
    solved : SolvedLoads
        Contacts of its loads, and why others have none.
    model : ContactModel
    seal_mesh : SealMesh or None
        None where the bodies are shared.
    source : Source
        Where bodies and flow conductivities come from.
    asked : Loads
        Of the problem before any was left out.
    """

    problem: SealProblem
    solved: SolvedLoads
    model: ContactModel
    seal_mesh: SealMesh | None
    source: Source
    asked: Loads

    @cached_property
    def solver(self) -> LoadSolver:
        """Of further loads on the same bodies."""
        return LoadSolver(self.problem, self.model, settings=self.source.settings)

    @property
    def missing(self) -> dict[tuple[float, float], LoadProblem]:
        """Fluid pressure [Pa] and applied force [N] of each load without a contact, with the reason."""
        return {self.asked.points[number]: one for number, one in self.solved.problems.items()}

    @cached_property
    def loads(self) -> tuple[LoadResult, ...]:
        """Each load with the contact that was found."""
        return self.solved.results(self.problem, self.problem.loads.points, self.source.table)

    def without(self, failures: Mapping[int, Exception]) -> Evaluation:
        """Without some more of the loads that were asked for, by their numbers."""
        found = [number for number in range(len(self.asked.points)) if number not in self.solved.failures]
        gone = {place for place, number in enumerate(found) if number in failures}
        if not gone:
            return self
        solved = replace(
            self.solved,
            contacts=_but(self.solved.contacts, gone),
            circumferences=_but(self.solved.circumferences, gone),
            failures=dict(sorted({**failures, **self.solved.failures}.items())),
        )
        if not solved.contacts:
            raise _no_load_left(self.problem, solved)
        return replace(
            self, problem=replace(self.problem, loads=self.problem.loads.without(gone)), solved=solved
        )


def evaluate(problem: SealProblem, source: Source = EXACT, clock: Clock = SILENT) -> Evaluation:
    """Solve all loads of a problem on a mesh whose zone and element sizes fit what was found on it.

    Parameters
    ----------
    problem : SealProblem
    source : Source
    clock : Clock
        Told what is being done.

    Raises
    ------
    NoLoadLeftError
        If no load has a contact.
    GeometryError, MeshingError, ConvergenceError

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> (load,) = evaluate(SealProblem.of(case)).loads
    >>> print(f"{load.contact.profile.peak_pressure / 1e6:.0f} MPa")
    192 MPa
    """
    (found,) = evaluate_seal((problem,), source, clock)
    return found


def evaluate_seal(
    problems: Sequence[SealProblem], source: Source = EXACT, clock: Clock = SILENT
) -> tuple[Evaluation, ...]:
    """`evaluate` of all problems of one seal, see `fem_seal.seal.problem.problems_of`, under the loads that all carry.

    Parameters
    ----------
    problems, source, clock
        See `evaluate`.
    """
    batch = Batch()
    found = evaluate_many({0: problems}, {0: (source,) * len(problems)}, batch, clock)
    for error in batch.failed.values():
        raise error
    return found[0]


def evaluate_many(
    problems: Mapping[int, Sequence[SealProblem]],
    sources: Mapping[int, Sequence[Source]],
    batch: Batch,
    clock: Clock = SILENT,
) -> dict[int, tuple[Evaluation, ...]]:
    """`evaluate_seal` of several seals, to the same bits; without those that fail.

    Parameters
    ----------
    problems, sources : mapping
        Of each seal, by its number: its problems, and the source of each of them.
    batch : Batch
        Keeps time and failures of each.
    clock : Clock
        Told what is being done.
    """
    found: dict[int, list[Evaluation]] = {n: [] for n in problems}
    for place in range(max(map(len, problems.values()), default=0)):
        due = [n for n in problems if place < len(problems[n]) and n not in batch.failed]
        if place and due:
            label = problems[due[0]][place].contact.label_of("closure")
            clock.progress(f"the contact of the {label}")
        own = {n: sources[n][place] for n in due}
        for n, evaluation in _evaluated({n: problems[n][place] for n in due}, own, batch, clock).items():
            found[n].append(evaluation)
    return batch.each(found, lambda n: _under_common_loads(found[n]))


def _under_common_loads(evaluations: Sequence[Evaluation]) -> tuple[Evaluation, ...]:
    """Evaluations of one seal under the loads that all of them can carry."""
    failures = {n: error for each in evaluations for n, error in each.solved.failures.items()}
    return tuple(evaluation.without(failures) for evaluation in evaluations)


def _evaluated(
    problems: Mapping[int, SealProblem], sources: Mapping[int, Source], batch: Batch, clock: Clock
) -> dict[int, Evaluation]:
    near = {n: source for n in problems if isinstance(source := sources[n], NearSolved)}
    others = {n: problem for n, problem in problems.items() if n not in near}
    found = _near_solved({n: problems[n] for n in near}, near, batch) if near else {}
    return found | (_on_own_meshes(others, sources, batch, clock) if others else {})


def _near_solved(
    problems: Mapping[int, SealProblem], sources: Mapping[int, NearSolved], batch: Batch
) -> dict[int, Evaluation]:
    """On the bodies of the solved seal, and from its contacts: all that move are pressed together."""
    problems = batch.each(problems, lambda n: sources[n].problem(problems[n]))
    models = batch.each(problems, lambda n: sources[n].model(problems[n]))
    pressed = _pressed(batch.each(models, lambda n: sources[n].pressings(problems[n], models[n])), batch)

    def solved(number: int) -> Evaluation:
        problem, source, model = problems[number], sources[number], models[number]
        loads = source.solve(problem, model, pressed.get(number, {}))
        every = range(len(problem.loads.points))
        asked = replace(problem, loads=problem.loads.without(set(every) - set(source.numbers)))
        return Evaluation(_solved_part(asked, loads), loads, model, None, source, asked.loads)

    return batch.each(models, solved)


def _on_own_meshes(
    problems: Mapping[int, SealProblem], sources: Mapping[int, Source], batch: Batch, clock: Clock
) -> dict[int, Evaluation]:
    sources = {number: sources[number].suited(problem) for number, problem in problems.items()}
    problems = batch.each(problems, lambda n: sources[n].problem(problems[n]))

    def begun(number: int) -> MeshFit:
        problem = problems[number]
        size_given = problem.contact_size is not None
        return MeshFit.begin(sizing(problem), problem.contact, size_given=size_given)

    done: dict[int, Evaluation] = {}

    def with_bodies(number: int, fit: MeshFit) -> tuple[LoadSolver, SealMesh | None] | MeshingError:
        problem = problems[number]
        assert fit.sizing is not None  # of those that want a mesh
        try:
            seal_mesh, model = sources[number].bodies(problem, fit.sizing, clock)
        except MeshingError as error:
            return error
        return LoadSolver(problem, model, settings=sources[number].settings), seal_mesh

    # what is left to be found on a mesh of which is known already that another one is wanted
    put_off: dict[int, Callable[[], MeshFit]] = {}

    def looked_at(
        number: int, fit: MeshFit, made: tuple[LoadSolver, SealMesh | None] | MeshingError, known: Pressed
    ) -> MeshFit:
        if isinstance(made, MeshingError):
            return put_off.pop(number)() if number in put_off else fit.with_outcome(made)
        find = partial(found_on, number, fit, made, known)
        round_ones = [one for one in known.values() if isinstance(one, ContactSolution)]
        if problems[number].form is not None and round_ones and len(round_ones) == len(known):
            after = fit.with_outcome(round_ones)
            if after.sizing is not None:
                put_off[number] = find
                return after
        put_off.pop(number, None)
        return find(leave=partial(_in_vain, fit))

    def found_on(
        number: int,
        fit: MeshFit,
        made: tuple[LoadSolver, SealMesh | None],
        known: Pressed,
        leave: Leave | None = None,
    ) -> MeshFit:
        solver, seal_mesh = made
        solved = solve_loads(solver, clock.progress, known, leave=leave)
        unconverged = [
            error
            for error in solved.failures.values()
            if isinstance(error, ConvergenceError) and not isinstance(error, _ON_ANY_MESH)
        ]
        if unconverged and not (fit.is_refined or fit.size_given):
            # a load that does not converge is tried on a finer mesh once, before the others go on without it
            clock.progress(
                _ANEW.format(why="a load does not converge on this mesh", how="half the element size")
            )
            return fit.with_outcome(unconverged[0])
        after = fit.with_outcome(solved.all_contacts) if solved.all_contacts else fit
        if solver.yields and after.sizing is not None and solved.contacts:
            clock.progress(_ANEW.format(why="the contact found does not fit this mesh", how="other sizes"))
        if solved.left:
            put_off[number] = partial(found_on, number, fit, made, known)
            return after
        if not solved.contacts:
            raise _no_load_left(solver.problem, solved)
        done[number] = Evaluation(
            _solved_part(solver.problem, solved),
            solved,
            solver.model,
            seal_mesh,
            sources[number],
            solver.problem.loads,
        )
        return after

    def solve_on(wanted: Mapping[int, MeshFit]) -> dict[int, MeshFit]:
        on_bodies = batch.each(wanted, lambda n: with_bodies(n, wanted[n]))
        solvers = {n: made[0] for n, made in on_bodies.items() if not isinstance(made, MeshingError)}
        with clock.step("contact", _solving(solvers.values())):
            pressed = _pressed({n: one.pressings() for n, one in solvers.items()}, batch)
            return batch.each(on_bodies, lambda n: looked_at(n, wanted[n], on_bodies[n], pressed.get(n, {})))

    fits = fit_meshes(batch.each(problems, begun), solve_on)
    return {number: done[number] for number in sorted(fits)}


# Said where loads of bodies that yield, which take their time, begin anew.
_ANEW = "{why}: another one with {how}, and from the first load on"


def _in_vain(fit: MeshFit, contacts: Sequence[ContactSolution], error: ConvergenceError | None) -> bool:
    """Whether another mesh is wanted after the loads so far, so that the others are solved on that one alone."""
    if error is not None:
        return not (fit.is_refined or fit.size_given or isinstance(error, _ON_ANY_MESH))
    return fit.with_outcome(contacts).sizing is not None


def _solving(solvers: Collection[LoadSolver]) -> str:
    count = sum(len(one.problem.loads.points) for one in solvers)
    paths = [one for one in solvers if one.yields]
    seconds = sum(
        path_seconds(len(one.model.line.vertices) - 1, len(one.problem.loads.points)) for one in paths
    )
    along = f", one after the other in load steps, and unloading: {about(seconds)}" if paths else ""
    return f"solving {count} contacts{along}"


Pressed = Mapping[int, ContactSolution | Exception]


def _pressed(asked: Mapping[int, Mapping[int, ContactProblem]], batch: Batch) -> dict[int, Pressed]:
    """Contacts of loads that are questions of their own, by problem and load: all at once, in half the time."""
    asked = {number: loads for number, loads in asked.items() if loads}

    def together(several: Sequence[Mapping[int, ContactProblem]]) -> list[Pressed]:
        every = iter(solve_many([one for loads in several for one in loads.values()]))
        return [{number: next(every) for number in loads} for loads in several]

    return {
        number: dict.fromkeys(asked[number], one) if isinstance(one, Exception) else one
        for number, one in batch.at_once(asked, together).items()
    }


def _solved_part(problem: SealProblem, solved: SolvedLoads) -> SealProblem:
    """The problem of the loads that have a contact."""
    loads = problem.loads
    if loads.unsolved_bolts is not None:
        loads = loads.with_forces(solved.points)
    if solved.failures:
        loads = loads.without(solved.failures)
    if loads is not problem.loads:
        problem = replace(problem, loads=loads)
    return replace(problem, form=solved.circumferences[0].form) if solved.circumferences else problem


def _no_load_left(problem: SealProblem, solved: SolvedLoads) -> Exception:
    """The error of a problem without a contact at any of its loads."""
    errors = list(solved.failures.values())
    if all(isinstance(error, ConvergenceError) for error in errors):
        return errors[0]
    problems = {one.kind: one for one in reversed(solved.problems.values())}
    return NoLoadLeftError(*problems.values(), file=problem.file)
