"""How far each load can be trusted, with the reasons."""

from __future__ import annotations

from fem_seal.answers.solution import SealSolution
from fem_seal.output.readable import ReadableTable, worded_table
from fem_seal.output.shown import Shown
from fem_seal.seal.findings import Level
from fem_seal.seal.load_names import load_name


def marks_in_words(result: SealSolution) -> str:
    """What the marks in the table of the loads mean; empty without any."""
    found = [level for level in Level if any(load.validity.level is level for load in result.loads)]
    told = [f"{level.mark} {level}" for level in found if level.mark]
    return f" {', '.join(told)}." if told else ""


def validity_table(result: SealSolution) -> ReadableTable:
    """Every reason why the numbers of a load are not simply valid; no rows if all are."""
    loads = result.loads
    rows = ({"load": load_name(load, loads), "one": one} for load in loads for one in load.validity.cautions)
    return worded_table("validity", rows)


SHOWN = Shown(words=lambda result: {"marks": marks_in_words(result), "validity": validity_table(result)})
