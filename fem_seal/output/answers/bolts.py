"""What the bolts of a seal carry: facts on the terminal, section and table of the report."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from fem_seal.answers.leakage_class import is_flange, seal_length, volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.output.answers.target import target_text
from fem_seal.output.columns import SHOWN_COLUMNS, ReadableTable, columns_table, filled_columns
from fem_seal.output.prose import phrase
from fem_seal.output.shown import Section, Shown, worded_section
from fem_seal.seal.load_result import load_name
from fem_seal.units import leak_range_text


def bolts_in_words(result: SealSolution) -> list[str]:
    """The bolts at the load with the highest fluid pressure; empty without bolts.

    Parameters
    ----------
    result : SealSolution
    """
    return [] if result.bolts is None or result.highest.bolts is None else list(_sentences(result))


def _sentences(result: SealSolution) -> Iterator[str]:
    load, found = result.highest, result.bolts
    state, at = load.bolts, load_name(load, result.loads)
    assert found is not None and state is not None  # of all who ask
    yield phrase(
        "bolts.state",
        "preload",
        "torque" if state.torque is not None else "",
        "force",
        "heat" if found.bolts.thermal_force else "",
        "stress",
        "" if state.utilisation is None else "yields" if state.utilisation > 1.0 else "strength",
        load=at,
        bolts=found.bolts,
        state=state,
        heat=found.bolts.thermal_force / found.bolts.number,
    )
    if load.at_preload_ends is not None:
        kind = "scatter" if load.at_preload_ends[1] < float("inf") else "scatter_opens"
        volume = volume_of(result.case)
        gas = f" (gas at {volume.state})" if volume.state else ""
        told = leak_range_text(load.at_preload_ends, 2, volume=volume)
        yield phrase("bolts.leak", kind, load=at, share=found.bolts.scatter, ends=told, gas=gas)
    if is_flange(result.case) and load.leak_interval is not None:
        assert load.leak is not None and load.leak.mass_flow is not None  # of a gas
        density = load.leak.mass_flow / load.leak.leak_rate if load.leak.leak_rate > 0 else 0.0
        ends = tuple(density * one / seal_length(result.case) for one in load.leak_interval)
        if density > 0:
            yield phrase("bolts.leak", "per_length", load=at, ends=ends)
    yield from _target(result)


def _target(result: SealSolution) -> Iterator[str]:
    load, target = result.highest, result.case.load.target_leak_rate
    state, force = load.bolts, load.contact_force_for_target
    if target is None or force is None or state is None or state.preload_for_target is None:
        return
    yield phrase(
        "bolts.target",
        "preload",
        "torque" if state.torque_for_target is not None else "",
        "stress" if state.stress_for_target is not None else "",
        target=target_text(result, target),
        load=load_name(load, result.loads),
        state=state,
    )


def bolt_table(result: SealSolution) -> ReadableTable:
    """Bolts at each load; no rows without them."""
    if result.bolts is None:
        return ReadableTable((), ())
    return columns_table(filled_columns(result.case, SHOWN_COLUMNS["bolts"], result.loads))


def _numbers(result: SealSolution) -> dict[str, Any] | None:
    found = result.bolts
    if found is None:
        return None
    return {**asdict(found.bolts), "loads": [asdict(one) for one in found.loads]}


def _section(result: SealSolution) -> Section | None:
    return worded_section("bolts", bolts_in_words(result), bolt_table(result))


SHOWN = Shown(
    lambda result: result.bolts,
    summary=lambda result: {"bolts": _numbers(result)},
    section=_section,
    lines=bolts_in_words,
)
