"""A solved seal with the answers to all that is asked of it.

What follows from one contact is asked of each part of the seal by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self, TypeVar

from fem_seal.answers.accuracy import ACCURACY, Comparison
from fem_seal.answers.answer import Answer, OptionalSteps, Request
from fem_seal.answers.bolts import BOLTS
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.compression import COMPRESSION
from fem_seal.answers.error_shares import ERROR_SHARES
from fem_seal.answers.findings import FINDINGS
from fem_seal.answers.form import FORM
from fem_seal.answers.judgement import LoadVerdict, SealVerdict, Verdict
from fem_seal.answers.particles import PARTICLES
from fem_seal.answers.sensitivities import SENSITIVITIES
from fem_seal.answers.standard_tests import SET_PRESSURE, STANDARD_TESTS
from fem_seal.answers.uncertainty import UNCERTAINTY
from fem_seal.answers.variants import INTERFACE_VARIANTS, OWN_CONTACTS
from fem_seal.answers.verdict import VERDICT
from fem_seal.seal.load_result import DiscretisationError
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.wording import Words

Seal = TypeVar("Seal", bound=SolvedSeal)


@dataclass(frozen=True, kw_only=True)
class SealSolution(SolvedSeal):
    """Everything that a case gave, as numbers.

    `SealResult` has its table and its files besides; see there for the answers.
    """

    answers: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    timings: dict[str, float] = field(default_factory=dict)

    accuracy = ACCURACY
    bolts = BOLTS
    compression = COMPRESSION
    form = FORM
    particles = PARTICLES
    interface_variants = INTERFACE_VARIANTS
    theories = OWN_CONTACTS
    uncertainty = UNCERTAINTY
    error_shares = ERROR_SHARES
    standard_tests = STANDARD_TESTS
    set_pressure = SET_PRESSURE
    sensitivities = SENSITIVITIES

    def with_answers(self, **answers: object) -> Self:
        """The same with other answers, by their names."""
        return replace(self, answers={**self.answers, **answers})

    @property
    def discretisation_error(self) -> DiscretisationError:
        """Of the strongest load."""
        return self.accuracy.error

    @property
    def far_field(self) -> tuple[Comparison, ...]:
        """What another housing and another support of its wall do to the strongest load."""
        return self.accuracy.far_field

    @property
    def judgement(self) -> SealVerdict | None:
        """Whether the seal keeps what [requirement] asks of it; None without one."""
        return VERDICT.of(self.answers).seal

    @property
    def judgement_beside(self) -> Mapping[str, tuple[int, LoadVerdict, Verdict]]:
        """What would decide in a scenario that comes to another verdict, see `fem_seal.answers.verdict`."""
        return VERDICT.of(self.answers).of_scenarios

    @property
    def verdict(self) -> Verdict | None:
        """The worst of the loads that are judged; None without a requirement."""
        return None if self.judgement is None else self.judgement.verdict

    @property
    def margin(self) -> float | None:
        """Allowed over calculated leak rate of the load that decides; None without a requirement."""
        return None if self.judgement is None else self.judgement.margin


def answer_parts(seal: Seal, request: Request, answers: Sequence[Answer[Any]]) -> Seal:
    """A solved seal with what answers know of its loads; they themselves, of several parts the first's, are kept.

    Parameters
    ----------
    seal : SolvedSeal
    request : Request
        Keeps the answers, and what is said of further parts alone.
    answers : sequence of Answer
        In their order.
    """
    of_part = [answer for answer in answers if answer.of_part]
    first, *others = seal.parts
    if not (of_part and others):
        return _answer_each(seal, request, answers)
    parts = [_answer_each(first, request, of_part)]
    said_texts = {caution.text() for caution in FINDINGS.of(request.answers).cautions}
    for part in others:
        query = replace(
            request,
            solver=LoadSolver(part.problem, part.model),
            steps=OptionalSteps(request.steps.display),
            answers={},
            samples={},
            remarks=[],
        )
        parts.append(_answer_each(part, query, of_part))
        texts = [x for x in FINDINGS.of(query.answers).cautions if x.text() not in said_texts]
        label = part.problem.contact.label_of("closure")
        request.remarks.extend(
            Words("{{ label }}: {{ text }}", {"label": label, "text": text})
            for text in (*texts, *query.steps.failures)
        )
    return _answer_each(seal.with_parts(parts), request, [answer for answer in answers if not answer.of_part])


def _answer_each(seal: Seal, request: Request, answers: Sequence[Answer[Any]]) -> Seal:
    for answer in answers:
        if not answer.is_asked_of(seal, request):
            request.answers[answer.name] = answer.fallback
            continue
        request.answers[answer.name] = value = answer.compute_or_fall_back(seal, request)
        seal = seal.with_loads([answer.of_load(load, n, value) for n, load in enumerate(seal.loads)])
    return seal
