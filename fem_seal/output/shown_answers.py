"""What all answers add to files, report and terminal."""

from fem_seal.output.answers import (
    form,
    particles,
    sensitivities,
    target,
    theories,
    uncertainty,
    variants,
    verdict,
)
from fem_seal.output.shown import Shown

# In the order in which they are told.
_TOLD = target, form, particles, theories, variants, uncertainty, verdict, sensitivities
SHOWN: tuple[Shown, ...] = tuple(one.SHOWN for one in _TOLD)
