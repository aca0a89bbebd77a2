"""Compression of a gasket along its loads, in words, a table and a picture."""

from __future__ import annotations

from dataclasses import asdict, astuple
from typing import TYPE_CHECKING

from fem_seal.answers.compression import COMPRESSION, Compression
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Tile, worded_section, worded_table
from fem_seal.output.pictures.colours import BLUE, GREY
from fem_seal.output.pictures.style import NARROW, Picture, captioned, label, number_dots, panels
from fem_seal.output.tables import COMPRESSION_COLUMNS
from fem_seal.wording import say, say_all

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.output.tables import CsvTable
    from fem_seal.units import Display


def compression_picture(result: SealSolution) -> Picture | None:
    """Line load over compression, in the order of the loads; None for a valve seat.

    Parameters
    ----------
    result : SealSolution
    """
    compression = COMPRESSION.of(result.answers)
    if compression is None:
        return None
    unit = result.display.unit_for("length", compression.largest_step.compression)
    per_length = result.display.fixed_unit("N/mm")
    over = [step.compression / unit.size for step in compression.steps]
    loads = [per_length.of(step.line_load) for step in compression.steps]
    figure, (axes,) = panels(1, height=3.5, width=NARROW)
    axes.plot(over, loads, "o-", color=BLUE, ms=3.8)
    for place in (0.0,) if compression.stop is None else (0.0, compression.stop / unit.size):
        axes.axvline(place, color=GREY, linewidth=0.8)
    axes.margins(y=0.12)
    number_dots(axes, over, loads, [step.load_step for step in compression.steps])
    over_this = f"compression, both faces  [{unit.name}]"
    label(axes, "Line load over compression", over_this, f"line load  [{per_length.name}]")
    left = len(compression.steps) > len(result.loads)
    stop = "" if compression.stop is None else "stop"
    return captioned(result.display, figure, "compression", "all", "left" if left else "", stop)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    compression = COMPRESSION.of(result.answers)
    if compression is None:
        return AnswerPage()
    most, back, left = compression.largest_step, compression.springback, compression.left or 0.0
    after = "unknown" if back is None else "springs" if result.problem.follows_path else "elastic"
    values = {"most": most, "after": after, "back": back or 0.0, "left": left, "stop": compression.stop}
    sentences = say_all(display, "compression", "result", **values)
    without = () if compression.stop is not None else ("force of the stop",)
    table = worded_table(
        display, "compression", [{"step": step} for step in compression.steps], without=without
    )
    remark = say(display, "compression", "left", after=after, left=left)
    return AnswerPage(
        tiles=[Tile("Compression", display.quantity(most.compression, "length 3"), remark, 50)],
        why=[say(display, "compression", "meet", most=most, stop=compression.stop)]
        if most.stop_force
        else (),
        section=worded_section(
            display, "compression", [*sentences, *say_all(display, "compression", "meaning")], table
        ),
        details=sentences,
    )


def _rows(result: SealSolution) -> CsvTable:
    compression = COMPRESSION.of(result.answers)
    steps = () if compression is None else compression.steps
    return COMPRESSION_COLUMNS, [astuple(step) for step in steps]


def _numbers(compression: Compression | None) -> dict[str, object] | None:
    return None if compression is None else {**asdict(compression), "springback": compression.springback}


OUTPUT = AnswerOutput(
    lambda result: result.compression,
    summary=lambda result: {"compression": _numbers(COMPRESSION.of(result.answers))},
    absent={"compression": None},
    tables={"compression.csv": _rows},
    pictures=lambda result: (compression_picture(result),),
    page=_page,
)
