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
from typing import TypeAlias, TypeVar

from fem_seal.contact.load_path import Leave
from fem_seal.contact.model import ContactModel
from fem_seal.contact.newton import ContactProblem, solve_many
from fem_seal.contact.sizing import MeshFit, fit_meshes
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError, LimitLoadError, LongPathError, NoLoadLeftError
from fem_seal.seal.cost import about, path_seconds
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import Clock, LoadSolver, SolvedLoads, solve_loads
from fem_seal.seal.problem import Loads, SealProblem, size_mesh
from fem_seal.seal.sources import OWN_BODIES, NeighbourSource, Source
from meshes import MeshingError, SealMesh

T = TypeVar("T")
Q = TypeVar("Q")

# What a body does not bear it does not bear on a finer mesh, where load steps are no longer either.
_ON_ANY_MESH = (LimitLoadError, LongPathError)

# Entered while work is done for the design of that number, None for what is done for several at once.
Turn: TypeAlias = Callable[[int | None], AbstractContextManager[None]]


def without_time_limit(number: int | None) -> AbstractContextManager[None]:
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
    >>> batch.map([0, 1, 2], lambda number: 1 / number)
    {1: 1.0, 2: 0.5}
    >>> batch.failed
    {0: ZeroDivisionError('division by zero')}
    """

    turn: Turn = without_time_limit
    seconds: dict[int, float] = field(default_factory=dict)
    failed: dict[int, Exception] = field(default_factory=dict)

    def map(self, numbers: Iterable[int], step: Callable[[int], T]) -> dict[int, T]:
        """What a step finds for each design that has not failed; one that fails now is left out from here on.

        Parameters
        ----------
        numbers : iterable of int
        step : callable
            Given the number of a design.
        """
        results: dict[int, T] = {}
        for number in numbers:
            if number in self.failed:
                continue
            start = time.perf_counter()
            with self.turn(number):
                try:
                    results[number] = step(number)
                except Exception as error:  # its own affair: the others go on
                    self.failed[number] = error
            self._add_time(number, time.perf_counter() - start)
        return results

    def answer_together(
        self, questions: Mapping[int, Q], answer: Callable[[Sequence[Q]], Sequence[T | Exception]]
    ) -> dict[int, T | Exception]:
        """Answers to what designs ask, found for all of them at once; an error is the answer of the one it belongs to.

        Parameters
        ----------
        questions : mapping
            By the number of the design.
        answer : callable
            Given all that is asked.
        """
        if not questions:
            return {}
        start = time.perf_counter()
        with self.turn(next(iter(questions)) if len(questions) == 1 else None):
            results = _answer(list(questions.values()), answer)
        for number in questions:
            self._add_time(number, (time.perf_counter() - start) / len(questions))
        return dict(zip(questions, results, strict=True))

    def _add_time(self, number: int, seconds: float) -> None:
        self.seconds[number] = self.seconds.get(number, 0.0) + seconds


def _answer(
    questions: Sequence[Q], answer: Callable[[Sequence[Q]], Sequence[T | Exception]]
) -> list[T | Exception]:
    try:
        return list(answer(questions))
    except Exception as error:
        return [error] if len(questions) == 1 else [r for q in questions for r in _answer([q], answer)]


def _leave_out(items: Sequence[T], places: Collection[int]) -> Sequence[T]:
    return [item for place, item in enumerate(items) if place not in places]


# Tells nobody what is being done.
SILENT = Clock(lambda text: None)


@dataclass(frozen=True, eq=False)
class Evaluation:
    """A problem with its loads solved, which work out what they are asked for.

    Parameters
    ----------
    problem : SealProblem
        Without the loads that could not be solved; its form error knows how many waves its tolerance holds.
    solved_loads : SolvedLoads
        Contacts of its loads, and why others have none.
    model : ContactModel
    seal_mesh : SealMesh or None
        None where the bodies are shared.
    source : Source
        Where bodies and flow conductivities come from.
    all_loads : Loads
        Of the problem before any was left out.
    """

    problem: SealProblem
    solved_loads: SolvedLoads
    model: ContactModel
    seal_mesh: SealMesh | None
    source: Source
    all_loads: Loads

    @cached_property
    def solver(self) -> LoadSolver:
        """Of further loads on the same bodies."""
        return LoadSolver(self.problem, self.model, settings=self.source.settings)

    @cached_property
    def loads(self) -> tuple[LoadResult, ...]:
        """Each load with the contact that was found."""
        return self.solved_loads.results(self.problem, self.problem.loads.points, self.source.table)

    def without_failures(self, failures: Mapping[int, Exception]) -> Evaluation:
        """Without some more of the loads that were asked for, by their numbers."""
        numbers = [n for n in range(len(self.all_loads.points)) if n not in self.solved_loads.failures]
        places = {place for place, n in enumerate(numbers) if n in failures}
        if not places:
            return self
        loads = replace(
            self.solved_loads,
            contacts=_leave_out(self.solved_loads.contacts, places),
            circumferences=_leave_out(self.solved_loads.circumferences, places),
            failures=dict(sorted({**failures, **self.solved_loads.failures}.items())),
        )
        if not loads.contacts:
            raise _no_load_error(self.problem, loads)
        problem = replace(self.problem, loads=self.problem.loads.without_loads(places))
        return replace(self, problem=problem, solved_loads=loads)


def evaluate(problem: SealProblem, source: Source = OWN_BODIES, clock: Clock = SILENT) -> Evaluation:
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
    (evaluation,) = evaluate_seal((problem,), source, clock)
    return evaluation


def evaluate_seal(
    problems: Sequence[SealProblem], source: Source = OWN_BODIES, clock: Clock = SILENT
) -> tuple[Evaluation, ...]:
    """`evaluate` of all problems of one seal, see `fem_seal.seal.problem.problems_of`, under the loads that all carry.

    Parameters
    ----------
    problems, source, clock
        See `evaluate`.
    """
    batch = Batch()
    evaluations = evaluate_many({0: problems}, {0: (source,) * len(problems)}, batch, clock)
    for error in batch.failed.values():
        raise error
    return evaluations[0]


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
    evaluations: dict[int, list[Evaluation]] = {n: [] for n in problems}
    for place in range(max(map(len, problems.values()), default=0)):
        due = [n for n in problems if place < len(problems[n]) and n not in batch.failed]
        if place and due:
            label = problems[due[0]][place].contact.label_of("closure")
            clock.progress(f"the contact of the {label}")
        seal_sources = {n: sources[n][place] for n in due}
        seal_problems = {n: problems[n][place] for n in due}
        for n, evaluation in _evaluate_problems(seal_problems, seal_sources, batch, clock).items():
            evaluations[n].append(evaluation)
    return batch.map(evaluations, lambda n: _restrict_to_common_loads(evaluations[n]))


def _restrict_to_common_loads(evaluations: Sequence[Evaluation]) -> tuple[Evaluation, ...]:
    """Evaluations of one seal under the loads that all of them can carry."""
    failures = {n: error for part in evaluations for n, error in part.solved_loads.failures.items()}
    return tuple(evaluation.without_failures(failures) for evaluation in evaluations)


def _evaluate_problems(
    problems: Mapping[int, SealProblem], sources: Mapping[int, Source], batch: Batch, clock: Clock
) -> dict[int, Evaluation]:
    neighbours = {n: source for n in problems if isinstance(source := sources[n], NeighbourSource)}
    others = {n: problem for n, problem in problems.items() if n not in neighbours}
    problems_near = {n: problems[n] for n in neighbours}
    evaluations = _evaluate_near_solved(problems_near, neighbours, batch) if problems_near else {}
    return evaluations | (_evaluate_on_own_meshes(others, sources, batch, clock) if others else {})


def _evaluate_near_solved(
    problems: Mapping[int, SealProblem], sources: Mapping[int, NeighbourSource], batch: Batch
) -> dict[int, Evaluation]:
    """On the bodies of the solved seal, and from its contacts: all that move are pressed together."""
    problems = batch.map(problems, lambda n: sources[n].problem(problems[n]))
    models = batch.map(problems, lambda n: sources[n].model(problems[n]))
    pressings = batch.map(models, lambda n: sources[n].pressings(problems[n], models[n]))
    contacts = _press(pressings, batch)

    def evaluate_near(number: int) -> Evaluation:
        problem, source, model = problems[number], sources[number], models[number]
        loads = source.solve(problem, model, contacts.get(number, {}))
        numbers = range(len(problem.loads.points))
        problem_near = replace(problem, loads=problem.loads.without_loads(set(numbers) - set(source.numbers)))
        return Evaluation(_solved_part(problem_near, loads), loads, model, None, source, problem_near.loads)

    return batch.map(models, evaluate_near)


def _evaluate_on_own_meshes(
    problems: Mapping[int, SealProblem], sources: Mapping[int, Source], batch: Batch, clock: Clock
) -> dict[int, Evaluation]:
    sources = {number: sources[number].source_for(problem) for number, problem in problems.items()}
    problems = batch.map(problems, lambda n: sources[n].problem(problems[n]))

    def begin_fit(number: int) -> MeshFit:
        problem = problems[number]
        return MeshFit.begin(size_mesh(problem), problem.contact, size_given=problem.contact_size is not None)

    evaluations: dict[int, Evaluation] = {}

    def make_bodies(number: int, fit: MeshFit) -> tuple[LoadSolver, SealMesh | None] | MeshingError:
        problem = problems[number]
        assert fit.sizing is not None  # of those that want a mesh
        try:
            seal_mesh, model = sources[number].bodies(problem, fit.sizing, clock)
        except MeshingError as error:
            return error
        return LoadSolver(problem, model, settings=sources[number].settings), seal_mesh

    # what is left to solve on a mesh that is known already to be followed by another one
    postponed_fits: dict[int, Callable[[], MeshFit]] = {}

    def finish_fit(
        number: int,
        fit: MeshFit,
        bodies: tuple[LoadSolver, SealMesh | None] | MeshingError,
        contacts: Contacts,
    ) -> MeshFit:
        if isinstance(bodies, MeshingError):
            return postponed_fits.pop(number)() if number in postponed_fits else fit.with_outcome(bodies)
        solve = partial(solve_on_mesh, number, fit, bodies, contacts)
        round_contacts = [contact for contact in contacts.values() if isinstance(contact, ContactSolution)]
        if problems[number].form is not None and round_contacts and len(round_contacts) == len(contacts):
            next_fit = fit.with_outcome(round_contacts)
            if next_fit.sizing is not None:
                postponed_fits[number] = solve
                return next_fit
        # not put there by what it calls: a function that knows itself is a cycle, and keeps the bodies
        postponed_fits[number] = solve
        return solve(leave=partial(_needs_fit, fit))

    def solve_on_mesh(
        number: int,
        fit: MeshFit,
        bodies: tuple[LoadSolver, SealMesh | None],
        contacts: Contacts,
        leave: Leave | None = None,
    ) -> MeshFit:
        solver, seal_mesh = bodies
        loads = solve_loads(solver, clock.progress, contacts, leave=leave)
        errors = [
            error
            for error in loads.failures.values()
            if isinstance(error, ConvergenceError) and not isinstance(error, _ON_ANY_MESH)
        ]
        if errors and not (fit.is_refined or fit.size_given):
            # a load that does not converge is tried on a finer mesh once, before the others go on without it
            clock.progress(
                _ANEW.format(why="a load does not converge on this mesh", how="half the element size")
            )
            postponed_fits.pop(number, None)
            return fit.with_outcome(errors[0])
        next_fit = fit.with_outcome(loads.all_contacts) if loads.all_contacts else fit
        if solver.yields and next_fit.sizing is not None and loads.contacts:
            clock.progress(_ANEW.format(why="the contact found does not fit this mesh", how="other sizes"))
        if loads.was_left:
            return next_fit
        postponed_fits.pop(number, None)
        if not loads.contacts:
            raise _no_load_error(solver.problem, loads)
        evaluations[number] = Evaluation(
            _solved_part(solver.problem, loads),
            loads,
            solver.model,
            seal_mesh,
            sources[number],
            solver.problem.loads,
        )
        return next_fit

    def solve_fits(fits: Mapping[int, MeshFit]) -> dict[int, MeshFit]:
        bodies_of = batch.map(fits, lambda n: make_bodies(n, fits[n]))
        solvers = {n: bodies[0] for n, bodies in bodies_of.items() if not isinstance(bodies, MeshingError)}
        with clock.step("contact", _solving_text(solvers.values())):
            contacts = _press({n: solver.pressings() for n, solver in solvers.items()}, batch)
            return batch.map(bodies_of, lambda n: finish_fit(n, fits[n], bodies_of[n], contacts.get(n, {})))

    fits = fit_meshes(batch.map(problems, begin_fit), solve_fits)
    return {number: evaluations[number] for number in sorted(fits)}


# Said where loads of bodies that yield, which take their time, begin anew.
_ANEW = "{why}: another one with {how}, and from the first load on"


def _needs_fit(fit: MeshFit, contacts: Sequence[ContactSolution], error: ConvergenceError | None) -> bool:
    """Whether another mesh is wanted after the loads so far, so that the others are solved on that one alone."""
    if error is not None:
        return not (fit.is_refined or fit.size_given or isinstance(error, _ON_ANY_MESH))
    return fit.with_outcome(contacts).sizing is not None


def _solving_text(solvers: Collection[LoadSolver]) -> str:
    count = sum(len(solver.problem.loads.points) for solver in solvers)
    paths = [solver for solver in solvers if solver.yields]
    seconds = sum(
        path_seconds(len(path.model.line.vertices) - 1, len(path.problem.loads.points)) for path in paths
    )
    path_text = f", one after the other in load steps, and unloading: {about(seconds)}" if paths else ""
    return f"solving {count} contacts{path_text}"


Contacts = Mapping[int, ContactSolution | Exception]


def _press(pressings: Mapping[int, Mapping[int, ContactProblem]], batch: Batch) -> dict[int, Contacts]:
    """Contacts of loads that are questions of their own, by problem and load: all at once, in half the time."""
    pressings = {number: loads for number, loads in pressings.items() if loads}

    def press_all(groups: Sequence[Mapping[int, ContactProblem]]) -> list[Contacts]:
        contacts = iter(solve_many([pressing for loads in groups for pressing in loads.values()]))
        return [{number: next(contacts) for number in loads} for loads in groups]

    return {
        number: dict.fromkeys(pressings[number], contacts) if isinstance(contacts, Exception) else contacts
        for number, contacts in batch.answer_together(pressings, press_all).items()
    }


def _solved_part(problem: SealProblem, outcome: SolvedLoads) -> SealProblem:
    """The problem of the loads that have a contact."""
    loads = problem.loads
    if loads.unsolved_bolts is not None:
        loads = loads.with_forces(outcome.points)
    if outcome.failures:
        loads = loads.without_loads(outcome.failures)
    if loads is not problem.loads:
        problem = replace(problem, loads=loads)
    return replace(problem, form=outcome.circumferences[0].form) if outcome.circumferences else problem


def _no_load_error(problem: SealProblem, outcome: SolvedLoads) -> Exception:
    """The error of a problem without a contact at any of its loads."""
    errors = list(outcome.failures.values())
    if all(isinstance(error, ConvergenceError) for error in errors):
        return errors[0]
    problems = {problem.kind: problem for problem in reversed(outcome.problems.values())}
    return NoLoadLeftError(*problems.values(), file=problem.file)
