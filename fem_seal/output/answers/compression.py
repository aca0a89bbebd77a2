"""Compression of a gasket along its loads, in words, a table and a picture."""

from __future__ import annotations

from dataclasses import asdict, astuple
from typing import TYPE_CHECKING

from fem_seal.answers.compression import COMPRESSION, Compression
from fem_seal.output.pictures.colours import BLUE, GREY
from fem_seal.output.pictures.style import Picture, captioned, label, number_dots, panels
from fem_seal.output.prose import phrase
from fem_seal.output.shown import Section, Shown, worded_section, worded_table
from fem_seal.output.tables import COMPRESSION_COLUMNS
from fem_seal.units import fixed_unit, unit_for

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.output.tables import CsvTable


def compression_in_words(result: SealSolution) -> list[str]:
    """Line load, largest compression and springback; empty for a valve seat.

    Parameters
    ----------
    result : SealSolution
    """
    found = COMPRESSION.of(result.answers)
    if found is None:
        return []
    most = found.largest
    known = "springs" if result.problem.follows_path else "elastic"
    after = "unknown" if found.springback is None else known
    back, left = found.springback or 0.0, found.left or 0.0
    meet = "" if found.stop is None else "stopped" if most.stop_force else "not_stopped"
    return [
        phrase("compression.result", "most", after, meet, most=most, back=back, left=left, stop=found.stop)
    ]


def compression_picture(result: SealSolution) -> Picture | None:
    """Line load over compression, in the order of the loads; None for a valve seat.

    Parameters
    ----------
    result : SealSolution
    """
    found = COMPRESSION.of(result.answers)
    if found is None:
        return None
    unit = unit_for("length", found.largest.compression)
    per_length = fixed_unit("N/mm")
    over = [step.compression / unit.size for step in found.steps]
    loads = [per_length.of(step.line_load) for step in found.steps]
    figure, (axes,) = panels(1, height=3.5, width=6.4)
    axes.plot(over, loads, "o-", color=BLUE, ms=3.8)
    for place in (0.0,) if found.stop is None else (0.0, found.stop / unit.size):
        axes.axvline(place, color=GREY, linewidth=0.8)
    axes.margins(y=0.12)
    number_dots(axes, over, loads, [step.load_step for step in found.steps])
    over_this = f"compression, both faces  [{unit.name}]"
    label(axes, "Line load over compression", over_this, f"line load  [{per_length.name}]")
    left = len(found.steps) > len(result.loads)
    stop = "" if found.stop is None else "stop"
    return captioned(figure, "compression", "all", "left" if left else "", stop)


def _section(result: SealSolution) -> Section | None:
    found = COMPRESSION.of(result.answers)
    steps = () if found is None else found.steps
    without = () if found is not None and found.stop is not None else ("force of the stop",)
    table = worded_table("compression", [{"step": one} for one in steps], without=without)
    sentences = compression_in_words(result)
    return worded_section(
        "compression", [*sentences, phrase("compression.result", "meaning")] if sentences else [], table
    )


def _rows(result: SealSolution) -> CsvTable:
    found = COMPRESSION.of(result.answers)
    steps = () if found is None else found.steps
    return COMPRESSION_COLUMNS, [astuple(one) for one in steps]


def _numbers(found: Compression | None) -> dict[str, object] | None:
    return None if found is None else {**asdict(found), "springback": found.springback}


SHOWN = Shown(
    lambda result: result.compression,
    summary=lambda result: {"compression": _numbers(COMPRESSION.of(result.answers))},
    absent={"compression": None},
    tables={"compression.csv": _rows},
    section=_section,
    pictures=lambda result: (compression_picture(result),),
    lines=compression_in_words,
)
