"""particles.csv: what still leaks of each load when gaps below a size are shut."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.output.columns import PARTICLE_COLUMNS
from fem_seal.output.tables import write_rows_csv

if TYPE_CHECKING:
    from fem_seal.answers.particles import ParticleAnswers
    from fem_seal.answers.solution import SealSolution


def write_particles_csv(result: SealSolution, path: Path) -> Path | None:
    """Write particles.csv, atomically; None, and an old one is removed, without particles or leak.

    Parameters
    ----------
    result : SealSolution
    path : pathlib.Path
    """
    rows = [row for answers in result.particles for row in particle_rows(answers)]
    if not rows:
        path.unlink(missing_ok=True)
        return None
    return write_rows_csv(path, PARTICLE_COLUMNS, rows)


def particle_rows(answers: ParticleAnswers) -> list[tuple[float, ...]]:
    """Rows of a load with `PARTICLE_COLUMNS`, one for each size.

    Parameters
    ----------
    answers : ParticleAnswers
    """
    return [
        (
            answers.fluid_pressure,
            answers.applied_force,
            one.size,
            *one.gaps_below,
            *one.leak_rate,
            *one.remaining,
            *one.particles,
        )
        for one in answers.curve
    ]
