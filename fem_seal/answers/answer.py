"""What all answers have in common: a name, when they apply, how they are computed, and that they may fail."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

from fem_seal.answers.case_load import CaseLoad, Prepare, SolvedSeal, case_loads, model_as_it_is
from fem_seal.answers.two_flanges import load_of_parts
from fem_seal.errors import OutputError, Text, error_text, write
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.load_solver import Clock, LoadSolver
from fem_seal.units import Display
from fem_seal.wording import Words

if TYPE_CHECKING:
    from fem_seal.seal.evaluate import Evaluation
    from fem_seal.seal.problem import SealProblem

T = TypeVar("T")
Load = TypeVar("Load", bound=LoadResult)
Value = TypeVar("Value")
Fallback = TypeVar("Fallback")


@dataclass(frozen=True)
class OptionalSteps:
    """Steps each of which may fail without harm to the others.

    Parameters
    ----------
    display : Display
        Units of the failures.
    failures : list of str
        A sentence for each step that failed.
    """

    display: Display = field(default_factory=Display)
    failures: list[str] = field(default_factory=list)

    def compute(
        self, subject: str | Text, calculate: Callable[[], Value], fallback: Fallback
    ) -> Value | Fallback:
        """What `calculate` gives or, if it fails, `fallback`.

        Parameters
        ----------
        subject : str
            What the step gives, the subject of the sentence that names its failure.
        calculate : callable
        fallback : object
        """
        with self.attempt(subject):
            return calculate()
        return fallback

    def compute_values(self, load: Load, steps: Mapping[str, str | Text], fallback: object = None) -> Load:
        """A load with some of its values worked out; those that fail are known to be `fallback`.

        Parameters
        ----------
        load : LoadResult
        steps : mapping
            Name of each value, with what it is for `compute`.
        fallback : object
        """
        for name, subject in steps.items():
            load = load.with_values(**{name: self.compute(subject, partial(getattr, load, name), fallback)})
        return load

    @contextmanager
    def attempt(self, subject: str | Text, *, but: type[Exception] = OutputError) -> Iterator[None]:
        """Name what fails inside, and go on after it.

        A file that cannot be written is not told here but to the caller, as is an interruption: the disc or the user
        is the cause then, and both concern the other results as well.

        Parameters
        ----------
        subject : str
            See `compute`.
        but : type of exception
            What stops everything.
        """
        try:
            yield
        except but:
            raise
        except Exception as error:
            # any: what is shown beside a result must never be the reason for having none
            self.name_failure(subject, error)

    def name_failure(self, subject: str | Text, error: Exception) -> None:
        """Name a failure that was met elsewhere."""
        name, why = write(subject, self.display), error_text(error, self.display)
        self.failures.append(f"{name}: could not be calculated ({why}); all else is not affected")


def at_pressure(subject: str, load: LoadResult) -> Words:
    """What a step gives at one load, see `OptionalSteps.compute`.

    Parameters
    ----------
    subject : str
    load : LoadResult
    """
    values = {"subject": subject, "pressure": load.fluid_pressure}
    return Words("{{ subject }} at {{ pressure | quantity('given fluid pressure') }}", values)


def loads_of(evaluations: Sequence[Evaluation], prepare: Prepare = model_as_it_is) -> list[CaseLoad]:
    """Loads of the evaluations of a seal, with the scenarios that share their contacts.

    Parameters
    ----------
    evaluations : sequence of Evaluation
    prepare : callable
        See `case_loads`.
    """
    first, *others = (case_loads(evaluation.problem, evaluation.loads, prepare) for evaluation in evaluations)
    return list(map(load_of_parts, zip(first, *others, strict=True))) if others else first


def with_scenarios(problems: Sequence[SealProblem], load: CaseLoad) -> CaseLoad:
    """A load of a seal with the scenarios that share its contacts.

    Parameters
    ----------
    problems : sequence of SealProblem
        Of its parts.
    load : CaseLoad
    """
    parts = zip(problems, load.parts, strict=True)
    return load_of_parts([case_loads(problem, [part])[0] for problem, part in parts])


@dataclass(frozen=True)
class Request:
    """What an answer may use besides the solved seal.

    Parameters
    ----------
    solver : LoadSolver
        Of the seal's model, shared by all answers.
    clock : Clock
    sensitivities, verdict_force : bool or None
        Whether they are asked for, see `fem_seal.run`; None leaves it to the answer.
    full : bool
        Whether everything that the full report shows is asked for.
    steps : OptionalSteps
        For parts of an answer that may fail by themselves.
    answers : dict
        Those before it, by name.
    solve : callable
        Solves another case, `fem_seal.answers.chain.solve`, as a run of its own would.
    samples : dict
        Leak rates of samples of the uncertain inputs, see `fem_seal.answers.samples`: no answer calculates them again.
    remarks : list of str or Text
        What is said besides the findings of the result.
    """

    solver: LoadSolver
    clock: Clock
    sensitivities: bool | None = None
    verdict_force: bool | None = None
    full: bool = False
    steps: OptionalSteps = field(default_factory=OptionalSteps)
    answers: dict[str, Any] = field(default_factory=dict)
    solve: Callable[..., SolvedSeal] | None = None
    samples: dict[Any, Any] = field(default_factory=dict)
    remarks: list[str | Text] = field(default_factory=list)


@dataclass(frozen=True)
class Answer(Generic[T]):
    """One thing that is asked of a solved seal.

    As an attribute of a class with ``answers`` it is what was found, or `fallback`.

    Parameters
    ----------
    name : str
        Under which it stands in `SealResult.answers`.
    subject : str
        Subject of the sentence where it fails.
    compute : callable
        Gives the answer to a solved seal and an `Request`.
    fallback : object
        The answer where it does not apply or fails.
    applies : callable
        Whether it is asked of a solved seal that has what it needs; always unless given.
    of_load : callable
        Gives a load, of a number, with what the answer knows of it; the same load unless given.
    status : str
        Told while it is computed, and then it is timed; empty where `compute` sees to that with `Request.clock`.
    clock : str
        Name of its time; `name` unless given.
    needs : tuple of str
        Attributes of the solved seal, such as "case.form", none of which may be None or False where it applies.
    request_field : str
        Field of the request that asks for it; empty of an answer that follows from the case alone.
    needs_unrequested : tuple of str
        As `needs`, where that field is None.
    of_part : bool
        Whether it follows from one contact, and is asked of each part of a seal by itself, before all others.
    """

    name: str
    subject: str
    compute: Callable[[SolvedSeal, Request], T]
    fallback: T
    applies: Callable[[SolvedSeal, Request], bool] = lambda seal, request: True
    of_load: Callable[[CaseLoad, int, T], CaseLoad] = lambda load, number, answer: load
    status: str = ""
    clock: str = ""
    needs: tuple[str, ...] = ()
    request_field: str = ""
    needs_unrequested: tuple[str, ...] = ()
    of_part: bool = False

    def is_asked_of(self, seal: SolvedSeal, request: Request) -> bool:
        """Whether it applies to a solved seal.

        Parameters
        ----------
        seal : SolvedSeal
        request : Request
        """
        is_requested = getattr(request, self.request_field) if self.request_field else None
        needs = self.needs if is_requested else (*self.needs, *self.needs_unrequested)
        has_all = is_requested is not False and all(_has(seal, attribute) for attribute in needs)
        return has_all and self.applies(seal, request)

    def compute_or_fall_back(self, seal: SolvedSeal, request: Request) -> T:
        """The answer to a seal of which it is asked; a failure becomes a warning.

        Parameters
        ----------
        seal : SolvedSeal
        request : Request
        """
        with request.clock.step(self.clock or self.name, self.status) if self.status else nullcontext():
            return request.steps.compute(self.subject, partial(self.compute, seal, request), self.fallback)

    def of(self, answers: Mapping[str, Any]) -> T:
        """Itself among the answers of a result."""
        answer: T = answers.get(self.name, self.fallback)
        return answer

    @overload
    def __get__(self, result: None, owner: type[Any]) -> Answer[T]: ...

    @overload
    def __get__(self, result: Any, owner: type[Any]) -> T: ...

    def __get__(self, result: Any, owner: type[Any]) -> T | Answer[T]:
        return self if result is None else self.of(result.answers)


def _has(seal: SolvedSeal, attribute: str) -> bool:
    value: Any = seal
    for name in attribute.split("."):
        value = getattr(value, name)
        if value is None or value is False:
            return False
    return True
