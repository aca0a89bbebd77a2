"""around.csv: line load, pressure and leak around the axis of a seal that is not round."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_seal.output.columns import AROUND_COLUMNS
from fem_seal.seal.readings import FURTHER

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.output.tables import CsvTable
    from fem_seal.seal.load_result import LoadResult


def around_rows(result: SealSolution) -> CsvTable:
    """Headings and rows, one for each angle of each load; none of a round seal."""
    return AROUND_COLUMNS, [row for load in result.loads for row in _rows(load)]


def _rows(load: LoadResult) -> list[tuple[float | str, ...]]:
    """Rows of a load with `AROUND_COLUMNS`, one for each angle; none if it is that of a round seal.

    Parameters
    ----------
    load : LoadResult
    """
    around = load.around
    if around is None:
        return []
    angles = len(around.angle)
    read = (around, *(load.others[one].around if one in load.others else None for one in FURTHER))
    leaks = [
        [""] * angles if one is None or one.leak_rate is None else one.leak_rate.tolist() for one in read
    ]
    return list(
        zip(
            [load.fluid_pressure] * angles,
            [load.applied_force] * angles,
            around.angle.tolist(),
            around.line_load.tolist(),
            np.where(around.line_load > 0, around.peak_pressure, 0.0).tolist(),
            around.fwhm.tolist(),
            *leaks,
            strict=True,
        )
    )
