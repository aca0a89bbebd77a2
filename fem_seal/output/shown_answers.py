"""Contributions of all answers to files, report and terminal."""

from fem_seal.answers.solution import SealSolution
from fem_seal.output.answers import (
    bolts,
    compression,
    error_shares,
    form,
    lands,
    particles,
    sensitivities,
    standard_tests,
    target,
    theories,
    uncertainty,
    variants,
    verdict,
)
from fem_seal.output.shown import Shown

# In the order on the terminal.
_ANSWERS = (
    compression,
    lands,
    target,
    bolts,
    form,
    particles,
    theories,
    variants,
    uncertainty,
    error_shares,
    verdict,
    standard_tests,
    sensitivities,
)
SHOWN: tuple[Shown, ...] = tuple(page.SHOWN for page in _ANSWERS)


def shown_of(result: SealSolution) -> list[Shown]:
    """Of the answers that a result has.

    Parameters
    ----------
    result : SealSolution
    """
    return [shown for shown in SHOWN if shown.has_something(result)]
