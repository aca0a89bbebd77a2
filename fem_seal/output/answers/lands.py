"""What each of several lands carries and lets through, in words and a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.two_flanges import GasketLoad
from fem_seal.output.answer_output import AnswerOutput, AnswerPage, worded_section, worded_table
from fem_seal.output.tables import contact_rows
from fem_seal.seal.load_result import load_name
from fem_seal.wording import say, say_all

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.units import Display

# What the contacts of two different flange faces are called in the report.
_FACES = {"closure": "upper", "seat": "lower"}


def _sentences(result: SealSolution, display: Display) -> list[str]:
    """Line loads of several lands and the pressures between them under the highest load."""
    load = result.highest
    if isinstance(load, GasketLoad):
        share = load.upper_share()
        return [say(display, "lands", "faces", upper=share, lower=1.0 - share)]
    unit, at = display.fixed_unit("N/mm"), load_name(load, result.loads, display)
    carried = [f"{unit.of(land.moment(0)):.3g}" for land in load.profiles]
    sentences = [say(display, "lands", "carry", loads=carried, unit=unit.name, load=at)]
    if load.leak is not None:
        flow = None if load.rough is None else load.rough.flow
        given = (None if flow is None else flow.chambers) or (None,) * (len(load.profiles) - 1)
        for number, (held, land) in enumerate(zip(given, load.leak.lands[:-1], strict=True), start=1):
            pressure = land.outer_pressure
            sentences.append(say(display, "lands", "chamber", held=held, inner=number, pressure=pressure))
    return sentences


def hardest_land(load: CaseLoad, display: Display) -> str:
    """Which of several lands is pressed hardest, whose peak pressure and width are those of the load.

    Parameters
    ----------
    load : CaseLoad
    display : Display
    """
    peaks = [land.peak_pressure for land in load.profiles]
    return say(display, "lands", "hardest", number=peaks.index(max(peaks)) + 1)


def _page(result: SealSolution, display: Display) -> AnswerPage:
    sentences = _sentences(result, display)
    alike, (columns, contacts) = not isinstance(result.highest, GasketLoad), contact_rows(result)
    rows = [dict(zip(columns, row, strict=True)) for row in contacts]
    for row in rows:
        name = str(row["contact"])
        row["contact"] = result.case.label_of(name) if alike else _FACES.get(name, name)
    meaning = say_all(display, "lands", "meaning_of_lands" if alike else "meaning_of_faces")
    details, table = [*sentences, *meaning], worded_table(display, "lands", rows)
    section = (
        worded_section(display, "lands", details, table)
        if alike
        else worded_section(display, "faces", details, table)
    )
    return AnswerPage(why=sentences[:2], section=section, details=sentences)


OUTPUT = AnswerOutput(
    lambda result: max(len(result.highest.profiles), len(result.highest.parts)) > 1, page=_page
)
