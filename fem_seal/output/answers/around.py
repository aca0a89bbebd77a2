"""What the report says about a seal that is not round, and the rows of around.csv."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.output.columns import AROUND_COLUMNS
from fem_seal.output.prose import said
from fem_seal.seal.load_names import load_name
from fem_seal.seal.readings import FURTHER

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.arrays import FloatArray
    from fem_seal.output.tables import CsvTable
    from fem_seal.seal.circumference import Around
    from fem_seal.seal.load_result import LoadResult


# Share of the leak whose part of the circumference is told.
_MOST = 0.8
# Places whose line load is the least but for this share of the mean, and how many of them are named.
_AS_LITTLE, _NAMED = 0.005, 4


def around_in_words(result: SealSolution) -> list[str]:
    """How uneven line load and leak are, a text for each load that is told; empty if nothing but scratches is uneven.

    The load with the highest fluid pressure, and the least loaded one, which feels the form error most.

    Parameters
    ----------
    result : SealSolution
    """
    known = [load for load in result.loads if load.around is not None and load.around.form.felt]
    if not known:
        return []
    weakest = min(known, key=lambda load: load.line_load)
    told = dict.fromkeys([result.highest, weakest] if result.highest in known else [weakest])
    return [" ".join(_of_load(load, result)) for load in told]


def _of_load(load: LoadResult, result: SealSolution) -> Iterator[str]:
    around, name = load.around, load_name(load, result.loads)
    assert around is not None
    angles, width = least_loaded(around)
    at = _named(angles)
    if around.line_load.min() == 0:
        yield said("notes.around", "parted", load=name, at=at, width=_degrees(width))
    else:
        yield said("notes.around", "falls", load=name, at=at, around=around)
    turn = None if around.leak_rate is None else turn_that_leaks(around.leak_rate, _MOST)
    if turn is not None:
        yield said("notes.around", "leak", share=_MOST, turn=_degrees(turn))


def least_loaded(around: Around) -> tuple[list[float], float]:
    """Middles of the places with the least line load, and how far all of them reach together [rad].

    Parameters
    ----------
    around : Around
    """
    f = around.line_load
    low = f <= f.min() + _AS_LITTLE * f.mean()
    step = 2 * math.pi / len(f)
    if low.all():
        return [], 2 * math.pi
    # begins where one of the places begins, so that none is cut
    start = int(np.flatnonzero(low & ~np.roll(low, 1))[0])
    edges = np.diff(np.roll(low, -start).astype(int), prepend=0, append=0)
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    middles = (start + 0.5 * (first + last)) % len(f) * step
    return sorted(middles.tolist()), float((last - first + 1).sum()) * step


def turn_that_leaks(leak_rate: FloatArray, share: float) -> float | None:
    """Smallest part of the turn through which a share of the leak passes [rad]; None if nothing leaks, or no end.

    Parameters
    ----------
    leak_rate : ndarray, shape (m,)
        At uniform angles.
    share : float
    """
    total = float(leak_rate.sum())
    if not (math.isfinite(total) and total > 0):
        return None
    passed = np.concatenate([[0.0], np.cumsum(np.sort(leak_rate)[::-1]) / total])
    return float(np.interp(share, passed, np.arange(len(passed)))) * 2 * math.pi / len(leak_rate)


def _named(angles: list[float]) -> str:
    """The angles: "90° and 270°"; of many, their number."""
    if not angles:
        return "every angle"
    if len(angles) > _NAMED:
        return f"{len(angles)} places around the axis"
    texts = [_degrees(angle) for angle in angles]
    return " and ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.0f}°"


def around_rows(result: SealSolution) -> CsvTable:
    """Headings and rows of around.csv, one for each angle of each load; none of a round seal."""
    return AROUND_COLUMNS, [row for load in result.loads for row in _angles_of(load)]


def _angles_of(load: LoadResult) -> list[tuple[float | str, ...]]:
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
