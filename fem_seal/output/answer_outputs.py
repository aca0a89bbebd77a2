"""Contributions of all answers to files, report and terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fem_seal.output.answer_output import AnswerOutput, AnswerPage
from fem_seal.output.answers import (
    bolts,
    compression,
    contact,
    error_shares,
    form,
    lands,
    leak,
    particles,
    sensitivities,
    standard_tests,
    target,
    uncertainty,
    variants,
    verdict,
)

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution

# In the order on the terminal.
_ANSWERS = (
    contact,
    leak,
    compression,
    lands,
    target,
    bolts,
    form,
    particles,
    variants,
    uncertainty,
    error_shares,
    verdict,
    standard_tests,
    sensitivities,
)
OUTPUTS: tuple[AnswerOutput, ...] = tuple(page.OUTPUT for page in _ANSWERS)


def pages_of(result: SealSolution) -> list[AnswerPage]:
    """What the answers say of a result, in the units of its case.

    Parameters
    ----------
    result : SealSolution
    """
    return [output.page_of(result, result.display) for output in OUTPUTS]
