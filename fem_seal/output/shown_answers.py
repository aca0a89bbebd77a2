"""Contributions of all answers to files, report and terminal."""

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
from fem_seal.output.shown import Shown

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
