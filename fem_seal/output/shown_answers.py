"""Contributions of all answers to files, report and terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from fem_seal.output.shown import AnswerPage, Shown

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution

# In the order on the terminal.
_PAGES = (
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
SHOWN: tuple[Shown, ...] = tuple(page.SHOWN for page in _PAGES)


def pages_of(result: SealSolution) -> list[AnswerPage]:
    """What the answers say of a result, in the units of its case.

    Parameters
    ----------
    result : SealSolution
    """
    return [shown.page_of(result, result.case.display) for shown in SHOWN]
