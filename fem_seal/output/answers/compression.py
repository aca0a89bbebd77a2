"""Compression of a gasket along its loads, in words, a table and a picture."""

from __future__ import annotations

from dataclasses import asdict, astuple
from typing import TYPE_CHECKING

from fem_seal.answers.compression import COMPRESSION, Compression
from fem_seal.output.pictures.colours import BLUE, GREY
from fem_seal.output.pictures.style import NARROW, Picture, captioned, label, number_dots, panels
from fem_seal.output.shown import AnswerPage, Shown, Tile, worded_section, worded_table
from fem_seal.output.tables import COMPRESSION_COLUMNS
from fem_seal.units import fixed_unit, unit_for
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
    found = COMPRESSION.of(result.answers)
    if found is None:
        return None
    unit = unit_for("length", found.largest_step.compression)
    per_length = fixed_unit("N/mm")
    over = [step.compression / unit.size for step in found.steps]
    loads = [per_length.of(step.line_load) for step in found.steps]
    figure, (axes,) = panels(1, height=3.5, width=NARROW)
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


def _page(result: SealSolution, display: Display) -> AnswerPage:
    found = COMPRESSION.of(result.answers)
    if found is None:
        return AnswerPage()
    most, back, left = found.largest_step, found.springback, found.left or 0.0
    after = "unknown" if back is None else "springs" if result.problem.follows_path else "elastic"
    values = {"most": most, "after": after, "back": back or 0.0, "left": left, "stop": found.stop}
    sentences = say_all(display, "compression", "result", **values)
    without = () if found.stop is not None else ("force of the stop",)
    table = worded_table("compression", [{"step": step} for step in found.steps], without=without)
    remark = say(display, "compression", "left", after=after, left=left)
    return AnswerPage(
        tiles=[Tile("Compression", display.quantity(most.compression, "length 3"), remark, 50)],
        why=[say(display, "compression", "meet", most=most, stop=found.stop)] if most.stop_force else (),
        section=worded_section(
            "compression", [*sentences, *say_all(display, "compression", "meaning")], table
        ),
        details=sentences,
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
    pictures=lambda result: (compression_picture(result),),
    page=_page,
)
