"""The tables of the report: one unit per column, only significant digits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.closed_forms import Sizes, closed_form_limits, derive_beside
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.contact.solution import PlasticZone
from fem_seal.output.case_words import law_word
from fem_seal.output.columns import SHOWN_COLUMNS, own_columns
from fem_seal.output.prose import phrase
from fem_seal.output.shown import ReadableTable, columns_table, filled_column, worded_table
from fem_seal.seal.findings import NOT_CALCULATED, Level
from fem_seal.seal.load_names import load_name
from fem_seal.seal.load_result import MissingLoad
from fem_seal.units import format_quantity, percent, quantity_worth, strain_text
from fem_seal.validity.words import why_missing

if TYPE_CHECKING:
    from fem_seal.materials import HardeningCurve


# Number of columns that fit on the page; of more columns these are dropped first. leak.csv has them all.
_WIDEST, _SPARED = 12, ("std_m", "critical_separation_elastic_m")


def load_table(result: SealSolution) -> ReadableTable:
    """All loads, with one unit per column and without empty columns."""
    loads, names = result.every_load, list(SHOWN_COLUMNS["loads"])
    if any(load.applied_force for load in loads):
        names.insert(1, "applied_force_N")
    if result.surface is None or result.surface.hardness is None:
        names = [name for name in names if "_elastic_" not in name]
    twice = own_columns(result.loads)
    names = [name for name in names if name not in twice]
    volume = volume_of(result.case)
    columns = [one for one in (filled_column(name, loads, volume) for name in names) if one.some]
    for name in _SPARED:
        if len(columns) > _WIDEST:
            columns = [one for one in columns if one.column.name != name]
    table = columns_table(columns)
    # a mark instead of a column: the page is full
    rows = (
        (first if isinstance(load, MissingLoad) else f"{first} {load.validity.level.mark}".rstrip(), *others)
        for (first, *others), load in zip(table.rows, loads, strict=True)
    )
    return ReadableTable(table.headings, tuple(rows))


def comparison_table(result: SealSolution, sizes: Mapping[str, Sizes]) -> ReadableTable:
    """How much every load differs from the closed forms, in per cent; no rows where there are none."""
    names = {key: name for key, name in (("crossover", "crossover"), ("hertz", "Hertz")) if key in sizes}
    if not names:
        return ReadableTable((), ())
    measures = {"peak_pressure": "peak", "fwhm": "FWHM", "std": "std. dev."}
    headings = [f"{text} over {name} − 1 [%]" for name in names.values() for text in measures.values()]
    columns = [
        (measure, getattr(sizes["calculated"], measure) / getattr(sizes[key], measure) - 1)
        for key in names
        for measure in measures
    ]
    rows = tuple(
        (load_name(load, result.loads), *(_difference(of[n], load, measure) for measure, of in columns))
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(("load", *headings), rows)


def comparison_note(result: SealSolution) -> str:
    """Explanation of the differences from the closed forms; empty if none is needed."""
    if result.unloaded is not None:
        return phrase("notes.comparison", "yielding")
    if limits := closed_form_limits(result.case, derive_beside(result)):
        return f"{limits[0].upper()}{limits[1:]}."
    return phrase("notes.comparison", law_word(result.case))


def _difference(share: float, load: CaseLoad, measure: str) -> str:
    """In per cent, with decimals according to the mesh error."""
    error = 0.0 if load.mesh_error is None else getattr(load.mesh_error, measure)
    decimals = 3 if abs(share) < 0.1 else 0
    if error > 0:
        decimals = min(decimals, max(0, math.ceil(-math.log10(200 * error))))
    return f"{100 * share:+.{decimals}f}".replace("-", "−")


def imprint_in_words(result: SealSolution) -> tuple[str, str] | None:
    """Depth of the deepest imprint, and its body and width; None if nothing has yielded."""
    imprints = result.imprints
    if not imprints:
        return None
    name, imprint = max(imprints.items(), key=lambda item: item[1].deepest)
    digits = result.strongest.digits_of("fwhm")  # with the accuracy of the width of the contact
    where = phrase("facts.remark", "imprint", imprint=imprint, body=result.case.label_of(name), digits=digits)
    return quantity_worth("length", imprint.deepest, digits), where


def yielding_reasons(result: SealSolution, load: CaseLoad) -> Iterator[str]:
    """How far the bodies have yielded at a load that was solved as elastoplastic."""
    if result.unloaded is None:
        return
    zones = {name: zone for name, zone in load.zones.items() if isinstance(zone, PlasticZone)}
    if not zones:
        yield phrase("reasons.yielding", "none")
    for name, zone in zones.items():
        values = {"body": result.case.label_of(name), "zone": zone, "digits": load.digits_of("fwhm")}
        yield phrase("reasons.yielding", "zone", **values)


def yielding_table(result: SealSolution) -> ReadableTable:
    """Where and how far each body has yielded at each load; no rows if all bodies are elastic."""
    rows: list[dict[str, object]] = []
    loads = result.loads if result.unloaded is not None else ()
    for whole in loads:
        zones = whole.zones
        for body, (load, name) in whole.named_bodies.items():
            assert isinstance(load.contact, ElastoplasticContact)
            if name not in load.contact.bodies:
                continue
            row = {
                "load": load_name(whole, result.loads),
                "body": result.case.label_of(body),
                "steps": load.contact.load_steps,
            }
            zone, digits = zones[body], load.digits_of("fwhm")
            if isinstance(zone, PlasticZone):
                depth = (
                    f"{quantity_worth('length', zone.depth, digits)} depth" if zone.depth else "the surface"
                )
                row |= {"strain": strain_text(zone.strain), "largest": depth, "deepest": zone.deepest}
            rows.append({"strain": "none", "largest": "–", "deepest": None, "digits": digits} | row)
    return worded_table("yielding", rows)


def curve_in_words(curve: HardeningCurve) -> str:
    """A hardening curve in a few words."""
    # four digits: an interpolated curve has no given digits
    first, last = (
        format_quantity("contact pressure", float(f"{one:.4g}"))
        for one in (curve.stress[0], curve.stress[-1])
    )
    if len(curve.stress) == 1:
        return f"{first}, perfectly plastic"
    return f"{first} to {last} at {percent(curve.last_strain)} plastic strain"


def marks_in_words(result: SealSolution) -> str:
    """Meaning of the marks in the table of the loads; empty without any."""
    marks = marks_of(result.loads)
    return f" {', '.join(marks)}." if marks else ""


def marks_of(loads: Sequence[CaseLoad]) -> list[str]:
    """Meaning of each mark of some loads: "? doubtful", "? leak rate doubtful" where all else is valid.

    Parameters
    ----------
    loads : sequence of CaseLoad
    """
    found = []
    for level in Level:
        marked = [load.validity for load in loads if load.validity.level is level and level.mark]
        if marked:
            whole = any(one.of_contact.level is level for one in marked)
            found.append(f"{level.mark} {level}" if whole else f"{level.mark} leak rate {level}")
    return found


def validity_table(result: SealSolution) -> ReadableTable:
    """All reasons why the numbers of a load are not valid; no rows if all are."""
    loads = result.loads
    rows: list[dict[str, object]] = [
        {"load": load_name(load, loads), "level": one.level, "reason": one.reason}
        for load in loads
        for one in load.validity.doubts
    ]
    rows += [
        {
            "load": load_name(load, result.every_load),
            "level": NOT_CALCULATED,
            "reason": why_missing(load.problem),
        }
        for load in result.not_calculated
    ]
    return worded_table("validity", rows)
