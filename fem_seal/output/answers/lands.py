"""What each of several lands carries and lets through, in words and a table."""

from __future__ import annotations

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.two_flanges import GasketLoad
from fem_seal.output.prose import phrase
from fem_seal.output.shown import Section, Shown, worded_section, worded_table
from fem_seal.output.tables import contact_rows
from fem_seal.seal.load_result import load_name
from fem_seal.units import fixed_unit

# What the contacts of two different flange faces are called in the report.
_FACES = {"closure": "upper", "seat": "lower"}


def lands_in_words(result: SealSolution) -> list[str]:
    """Line loads of several lands and the pressures between them under the highest load.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    if isinstance(load, GasketLoad):
        share = load.upper_share()
        return [phrase("faces.result", "share", upper=share, lower=1.0 - share)]
    unit = fixed_unit("N/mm")
    carried = ", ".join(f"{unit.of(one.moment(0)):.3g}" for one in load.profiles) + f" {unit.name}"
    told = [phrase("lands.result", "carry", load=load_name(load, result.loads), carried=carried)]
    if load.leak is not None:
        flow = None if load.rough is None else load.rough.flow
        given = (None if flow is None else flow.chambers) or (None,) * (len(load.profiles) - 1)
        for number, (held, land) in enumerate(zip(given, load.leak.lands[:-1], strict=True), start=1):
            kind = "flow" if held is None else "port" if held else "vented"
            pressure = land.outer_pressure
            told.append(phrase("lands.result", kind, inner=number, outer=number + 1, pressure=pressure))
    return told


def hardest_land(load: CaseLoad) -> str:
    """Which of several lands is pressed hardest, whose peak pressure and width are those of the load.

    Parameters
    ----------
    load : CaseLoad
    """
    peaks = [land.peak_pressure for land in load.profiles]
    return phrase("lands.result", "hardest", number=peaks.index(max(peaks)) + 1)


def _section(result: SealSolution) -> Section | None:
    sentences = lands_in_words(result)
    alike, (columns, contacts) = not isinstance(result.highest, GasketLoad), contact_rows(result)
    rows = [dict(zip(columns, row, strict=True)) for row in contacts]
    for row in rows:
        name = str(row["contact"])
        row["contact"] = result.case.label_of(name) if alike else _FACES.get(name, name)
    table = worded_table("lands", rows)
    if alike:
        return worded_section("lands", [*sentences, phrase("lands.result", "meaning")], table)
    return worded_section("faces", [*sentences, phrase("faces.result", "meaning")], table)


SHOWN = Shown(
    lambda result: max(len(result.highest.profiles), len(result.highest.parts)) > 1,
    section=_section,
    lines=lands_in_words,
)
