"""What the bolts of a seal carry: facts on the terminal, section and table of the report."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from fem_seal.answers.leakage_class import is_flange, seal_length, volume_of
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, Tile, worded_section
from fem_seal.output.answers.target import target_text
from fem_seal.output.columns import SHOWN_COLUMNS, ReadableTable, columns_table, filled_columns
from fem_seal.seal.load_result import load_name
from fem_seal.wording import say, say_all

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display


def _sentences(result: SealSolution, display: Display) -> Iterator[str]:
    """The bolts at the load with the highest fluid pressure."""
    load, bolts = result.highest, result.bolts
    state, at = load.bolts, load_name(load, result.loads, display)
    assert bolts is not None and state is not None  # of all who ask
    heat = bolts.bolts.thermal_force / bolts.bolts.equivalent_number
    yield from say_all(display, "bolts", "state", load=at, bolts=bolts.bolts, state=state, heat=heat)
    if load.at_preload_ends is not None:
        volume = volume_of(result.case)
        ends = display.leak_range(load.at_preload_ends, 2, volume=volume)
        scatter = {"share": bolts.bolts.scatter, "opens": math.isinf(load.at_preload_ends[1])}
        yield say(display, "bolts", "scatter", load=at, ends=ends, gas=display.state_of(volume), **scatter)
    if is_flange(result.case) and load.leak_interval is not None:
        assert load.leak is not None and load.leak.mass_flow is not None  # of a gas
        density = load.leak.mass_flow / load.leak.leak_rate if load.leak.leak_rate > 0 else 0.0
        ends_per_length = tuple(density * end / seal_length(result.case) for end in load.leak_interval)
        if density > 0:
            yield say(display, "bolts", "per_length", load=at, ends=ends_per_length)
    target = result.case.load.target_leak_rate
    if (
        target is not None
        and load.contact_force_for_target is not None
        and state.preload_for_target is not None
    ):
        of_target = target_text(result, target)
        words = {"target": of_target, "load": at, "bolts": bolts.bolts, "state": state}
        yield from say_all(display, "bolts", "target", **words)


def bolt_table(result: SealSolution) -> ReadableTable:
    """Bolts at each load; no rows without them."""
    if result.bolts is None:
        return ReadableTable((), ())
    return columns_table(filled_columns(result.case, SHOWN_COLUMNS["bolts"], result.loads))


def _numbers(result: SealSolution) -> dict[str, Any] | None:
    bolts = result.bolts
    if bolts is None:
        return None
    return {**asdict(bolts.bolts), "loads": [asdict(load) for load in bolts.loads]}


def _page(result: SealSolution, display: Display) -> AnswerPage:
    load, bolts = result.highest, result.bolts
    if load.bolts is None or bolts is None:
        return AnswerPage()
    sentences = list(_sentences(result, display))
    preload = display.quantity(load.bolts.preload, "force 3")
    at = load_name(load, result.loads, display)
    return AnswerPage(
        tiles=[Tile("Preload of the bolts", preload, say(display, "bolts", "torque", state=load.bolts), 25)],
        why=[say(display, "bolts", "carried", load=at, bolts=bolts.bolts, state=load.bolts)],
        section=worded_section(display, "bolts", sentences, bolt_table(result)),
        details=sentences,
    )


OUTPUT = AnswerOutput(
    lambda result: result.bolts, summary=lambda result: {"bolts": _numbers(result)}, page=_page
)
