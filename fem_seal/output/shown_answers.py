"""What all answers add to files, report and terminal."""

from fem_seal.output.answers import (
    accuracy,
    findings,
    form,
    particles,
    sensitivities,
    target,
    uncertainty,
    variants,
    verdict,
)
from fem_seal.output.shown import Shown

# In the order in which they are told.
SHOWN: tuple[Shown, ...] = (
    accuracy.SHOWN,
    target.SHOWN,
    form.SHOWN,
    particles.SHOWN,
    variants.SHOWN,
    findings.SHOWN,
    uncertainty.SHOWN,
    verdict.SHOWN,
    sensitivities.SHOWN,
)
