"""Answers to a seal: what follows from one contact is asked of each of two different flanges by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

from fem_seal.answers.accuracy import ACCURACY
from fem_seal.answers.answer import Answer, OptionalSteps, Request
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.answers.findings import FINDINGS
from fem_seal.answers.opening import OPENING
from fem_seal.answers.variants import INTERFACE_VARIANTS, OWN_CONTACTS
from fem_seal.seal.load_solver import LoadSolver
from fem_seal.validity.words import sentence

Seal = TypeVar("Seal", bound=SolvedSeal)

# Asked of one contact, before the whole seal; of the two flanges the answer of the upper one is kept.
_OF_CONTACT = {answer.name for answer in (ACCURACY, OPENING, OWN_CONTACTS, INTERFACE_VARIANTS, FINDINGS)}


def answered(seal: Seal, request: Request, answers: Sequence[Answer[Any]]) -> Seal:
    """A solved seal with what answers know of its loads; they themselves are kept by the request.

    Parameters
    ----------
    seal : SolvedSeal
    request : Request
    answers : sequence of Answer
        In their order.
    """
    of_contact = [answer for answer in answers if answer.name in _OF_CONTACT]
    upper, *others = seal.faces
    if not (of_contact and others):
        return _answered(seal, request, answers)
    (lower,) = others
    below = replace(
        request,
        solver=LoadSolver(lower.problem, lower.model),
        steps=OptionalSteps(),
        answers={},
        samples={},
        remarks=[],
    )
    seal = seal.with_faces(_answered(upper, request, of_contact), _answered(lower, below, of_contact))
    known, texts = ([one.text for one in FINDINGS.of(asked.answers).cautions] for asked in (request, below))
    said = [*(text for text in texts if text not in known), *below.steps.failures]
    request.remarks.extend(sentence("lower_flange", said=text) for text in said)
    return _answered(seal, request, [answer for answer in answers if answer.name not in _OF_CONTACT])


def _answered(seal: Seal, request: Request, answers: Sequence[Answer[Any]]) -> Seal:
    for answer in answers:
        if not answer.is_asked_of(seal, request):
            request.answers[answer.name] = answer.otherwise
            continue
        request.answers[answer.name] = found = answer.found(seal, request)
        seal = seal.with_loads([answer.of_load(load, n, found) for n, load in enumerate(seal.loads)])
    return seal
