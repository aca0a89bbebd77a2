"""report.html: one self-contained page, and its tables, with one unit per column and only significant digits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.closed_forms import ClosedForms, Sizes, closed_form_limits, derive_beside, profile_sizes
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.case.tables import curves
from fem_seal.contact.laws import HardContact
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.contact.solution import PlasticZone
from fem_seal.errors import write
from fem_seal.files import write_text
from fem_seal.output import answer_outputs, case_words
from fem_seal.output.answer_output import decisive, prose, worded_table
from fem_seal.output.answers import variants, verdict
from fem_seal.output.case_words import law_word
from fem_seal.output.columns import SHOWN_COLUMNS, ReadableTable, columns_table, filled_columns
from fem_seal.output.pictures.contact import (
    contact_picture,
    imprint_picture,
    mesh_picture,
    profile_picture,
    size_picture,
    stress_picture,
    temperature_picture,
)
from fem_seal.output.pictures.leak import leak_picture, memory_picture
from fem_seal.output.pictures.section import sketch
from fem_seal.output.pictures.style import Picture, style
from fem_seal.output.pictures.surface import law_picture, separation_picture, surface_picture
from fem_seal.output.pressure_map import map_of, map_picture
from fem_seal.output.report import brief
from fem_seal.output.sources import sources
from fem_seal.seal.findings import NOT_CALCULATED, Level, why_missing
from fem_seal.seal.load_result import MissingLoad, in_order, load_name
from fem_seal.seal.problem import exponential_law
from fem_seal.units import keep_units_together, percent, strain_text
from fem_seal.version import __version__
from fem_seal.wording import say, template

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.materials import HardeningCurve
    from fem_seal.units import Display


# So much stands on the short page: tiles, reasons, warnings that are not folded, pictures beside contact, leak, case.
_TILES, _WHY, _WARNINGS, _BESIDE = 6, 5, 5, 2
# Pictures that may stand there, by rank.
_RANK = (
    "seal",
    "pressure_map",
    "unrolled",
    "set_pressure",
    "particles",
    "compression",
    "memory",
    "imprint",
    "profiles",
)


def write_report(result: SealSolution, path: Path, *, full: bool = False) -> Path:
    """Write the report, atomically.

    Parameters
    ----------
    result : SealSolution
    path : pathlib.Path
    full : bool
        See `report`.
    """
    return write_text(path, report(result, full=full))


def report(result: SealSolution, *, full: bool = False) -> str:
    """The report as one HTML page without scripts and without files from elsewhere.

    Parameters
    ----------
    result : SealSolution
    full : bool
        With all numbers, pictures and tables; otherwise what decides, on a page that is read in some minutes.
    """
    derived = derive_beside(result)
    drawings = pictures(result, derived) if full else short_pictures(result, derived)
    curves = ("leak", "memory") if full else _shown_beside([picture.name for picture in drawings])
    return template(result.display, "report/page.html.j2").render(
        title=result.case.title or "fem-seal",
        in_css=_escape_for_css,
        load_name=load_name,
        version=__version__,
        created=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        picture={picture.name: _keep_units_whole(picture) for picture in drawings},
        short_pictures=curves,
        sources=list(sources(result)),
        result=result,
        full=full,
        most_warnings=_WARNINGS,
        **_texts_of_case(result),
        **_keep_units_whole((_of_full(result, derived) if full else {}) | _words(result, full=full)),
        words=prose(),
    )


def _shown_beside(names: Sequence[str]) -> list[str]:
    return [name for name in ("leak", *_RANK) if name in names]


def _keep_units_whole(said: Any) -> Any:
    """Everything that is said with whole units: texts, and whatever they are in."""
    if type(said) is str:
        return keep_units_together(said)
    if isinstance(said, dict):
        return {key: _keep_units_whole(text) for key, text in said.items()}
    if isinstance(said, (list, tuple)):
        texts = [_keep_units_whole(text) for text in said]
        # of named tuples the same
        return type(said)(*texts) if hasattr(said, "_fields") else type(said)(texts)
    if is_dataclass(said) and not isinstance(said, type):
        entries = {
            attribute.name: getattr(said, attribute.name) for attribute in fields(said) if attribute.init
        }
        return replace(said, **{name: _keep_units_whole(entry) for name, entry in entries.items()})
    return said


def _escape_for_css(text: str) -> str:
    r"""A text for the foot of printed pages, with all letters escaped that have a meaning in CSS or HTML.

    Examples
    --------
    >>> _escape_for_css('Ball & "cone"')
    'Ball \\26  \\22 cone\\22 '
    """
    return "".join(
        letter if letter.isalnum() or letter in " ,.-" else f"\\{ord(letter):x} " for letter in text
    )


def short_pictures(result: SealSolution, derived: ClosedForms) -> list[Picture]:
    """The pictures of the short page: case, contact, leak, and two more at most.

    Parameters
    ----------
    result : SealSolution
    derived : ClosedForms
        Closed forms of the case.
    """
    with style():
        drawings = _sketches(result)
        if not result.of_profile:
            drawings.append(contact_picture(result, decisive(result)))
        if len(result.loads) > 1:
            drawings += filter(None, [leak_picture(result)])
        others = [*filter(None, _drawn_beside(result, derived))]
        drawings += sorted(others, key=lambda picture: _RANK.index(picture.name))[:_BESIDE]
    return drawings


def _drawn_beside(result: SealSolution, derived: ClosedForms) -> Iterator[Picture | None]:
    """Pictures that answer what the case asks, as far as there are any."""
    around = [
        picture for picture in _pictures_around(result) if picture is not None and picture.name in _RANK
    ]
    yield from around[-1:]
    for output in answer_outputs.OUTPUTS:
        if output.answers(result):
            yield from (
                picture
                for picture in output.pictures(result)
                if picture is not None and picture.name in _RANK
            )
    yield memory_picture(result)
    if result.of_profile:
        yield profile_picture(result, derived)
    elif result.unloaded_bodies is not None:
        yield imprint_picture(result)


def pictures(result: SealSolution, derived: ClosedForms) -> list[Picture]:
    """All pictures of a result.

    Parameters
    ----------
    result : SealSolution
    derived : ClosedForms
        Closed forms of the case.
    """
    sizes = profile_sizes(result, derived)
    with style():
        return [*_sketches(result), *filter(None, _draw_pictures(result, derived, sizes))]


def _sketches(result: SealSolution) -> list[Picture]:
    """The section of bodies that have shapes."""
    return [sketch(result)] if result.case.has_shapes else []


def _draw_pictures(
    result: SealSolution, derived: ClosedForms, sizes: Mapping[str, Sizes]
) -> Iterator[Picture | None]:
    top = result.highest
    if not result.of_profile:
        yield contact_picture(result, decisive(result))
        yield mesh_picture(result, top)
    yield profile_picture(result, derived)
    yield size_picture(result, sizes)
    yield law_picture(result)
    yield leak_picture(result)
    yield memory_picture(result)
    yield from _pictures_around(result)
    yield separation_picture(result)
    yield surface_picture(result, top)
    yield from _pictures_of_simulation(result)
    if not result.of_profile:
        yield stress_picture(result, max(result.loads, key=lambda load: load.max_von_mises))
        yield temperature_picture(result, top)
        yield imprint_picture(result)
    for output in answer_outputs.OUTPUTS:
        if output.answers(result):
            yield from output.pictures(result)


def _pictures_around(result: SealSolution) -> tuple[Picture | None, ...]:
    """Pictures of a seal that is not round; for a round one its section shows everything."""
    if result.of_profile and map_of(result.loads[0]):
        return (map_picture(result),)
    if not any(load.circumference and load.circumference.form.uneven for load in result.loads):
        return ()
    from concurrent.futures import ThreadPoolExecutor

    from fem_seal.output.pictures.around import leak_around_picture, line_load_picture, unrolled_picture
    from fem_seal.output.pictures.three_d import drawn_in_space, seal_picture

    # VTK draws in a separate process at the same time as matplotlib
    with ThreadPoolExecutor(1) as executor:
        image = executor.submit(drawn_in_space, result)
        return (
            unrolled_picture(result),
            line_load_picture(result),
            leak_around_picture(result),
            seal_picture(result, image.result()),
        )


def _pictures_of_simulation(result: SealSolution) -> tuple[Picture, ...]:
    """Pictures of a direct simulation; none without one."""
    flow, surface = result.problem.flow, result.surface
    if flow is None or flow.direct is None or surface is None:
        return ()
    from fem_seal.output.pictures.direct import simulation_pictures

    acting = result.highest.tightest.at_rest(surface).peak_pressure
    return simulation_pictures(result.display, flow.direct.table(surface), acting)


def _texts_of_case(result: SealSolution) -> dict[str, Any]:
    """Texts of the groups of the case that the result does not contain in this form."""
    case, problem = result.case, result.problem
    sections = {name: case_words.section(case, name) for name in case_words.BODIES}
    heating = problem.at_rest.heating
    field = (
        None if heating is None or result.of_profile else heating.field(result.seal_mesh, problem.materials)
    )
    decay_length, law_pressure = exponential_law(case.interface, result.surface)
    at_peak = None
    if case.interface.law == "spectrum" and decay_length is None and not isinstance(problem.law, HardContact):
        peak = max(load.peak_pressure for load in result.loads)
        at_peak = float(problem.law.decay_length(np.array([math.log(peak)]))[0])
    points = in_order(case.load.points, result.missing_loads, lambda load: load.point)
    return {
        "drawn_sections": {
            name: case_words.section_text(result.display, section) if section else {}
            for name, section in sections.items()
        },
        "dimensions": {name: case_words.listed_dimensions(case, name) for name in case_words.BODIES},
        # for bodies that yield the order of the loads matters
        "points_in_order": points if curves(case) else sorted(points),
        "former_load_rows": case_words.former_load_rows(result.display, case.load),
        "gas_state": case.display.state_of(volume_of(case)),
        "temperature_rows": list(case_words.temperature_rows(case, problem, field)),
        "finish_rows": case_words.finish_rows(case),
        "decay_length": decay_length,
        "law_pressure": law_pressure,
        "decay_length_at_peak": at_peak,
        "in_degrees": case_words.in_degrees,
        "curve_in_words": curve_in_words,
    }


def _words(result: SealSolution, *, full: bool) -> dict[str, Any]:
    """What stands on the short page, and at the top of the full one."""
    in_brief, left_out = brief.loads_in_brief(result.case, result.every_load)
    pages = answer_outputs.pages_of(result)
    more = say(result.display, "brief", "table_more", left_out=left_out) if left_out else ""
    allowed = verdict.allowed_in_words(result.display, result.loads)
    lines = brief.lines_in_brief(result, pages)
    decides = [line for page in pages for line in page.decides]
    tiles = sorted((tile for page in pages for tile in page.tiles), key=lambda tile: tile.rank)
    why = [reason for page in pages for reason in page.why]
    if not full:
        tiles, why = tiles[:_TILES], why[:_WHY]
    definitions = prose()["definitions"]
    seen = " ".join([*in_brief.headings, *(tile.name for tile in tiles), *lines, *why])
    return {
        "first_lines": lines,
        "verdict": verdict.worst_verdict(result),
        "shown_tiles": tiles,
        "loads_in_brief": in_brief,
        "brief_caption": "; ".join(filter(None, (allowed, *marks_of(result.loads), more))),
        "why": why,
        "decides": [line for line in decides if line not in lines],
        "backing": [line for page in pages for line in page.backing],
        "sections": [page.section for page in pages if page.section] if full else (),
        "warnings": list(brief.remarks_in_brief(result).items()),
        "given": brief.given_in_words(result),
        "definitions": definitions if full else [term for term in definitions if term["sign"] in seen],
    }


def _of_full(result: SealSolution, derived: ClosedForms) -> dict[str, Any]:
    """What the full page has beside this."""
    return {
        "far_field": far_field_sentence(result),
        "loads": load_table(result),
        "marks": marks_in_words(result),
        "validity": validity_table(result),
        "comparison_note": comparison_note(result),
        "comparison": comparison_table(result, profile_sizes(result, derived)),
        "yielding": yielding_table(result),
        "variants": variants.variant_table(result),
    }


# Relative changes below this get no number.
_LEAST = 1e-5


def far_field_sentence(result: SealSolution) -> str:
    """The influence of the far field in one sentence; empty if nothing was compared."""
    if not result.far_field:
        return ""
    load, several = load_name(result.strongest, result.loads, result.display), len(result.loads) > 1
    values = {"changes": result.far_field, "several": several, "least": _LEAST}
    return say(result.display, "notes", "far_field", load=load, **values)


# Number of columns that fit on the page; of more columns these are dropped first. leak.csv has them all.
_WIDEST, _SPARED = 12, ("std_m", "critical_separation_elastic_m")


def load_table(result: SealSolution) -> ReadableTable:
    """All loads, with one unit per column and without empty columns."""
    loads, names = result.every_load, list(SHOWN_COLUMNS["loads"])
    if any(load.applied_force for load in loads):
        names.insert(1, "applied_force_N")
    columns = [column for column in filled_columns(result.case, names, loads) if column.some]
    for name in _SPARED:
        if len(columns) > _WIDEST:
            columns = [column for column in columns if column.column.name != name]
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
        (
            load_name(load, result.loads, result.display),
            *(_difference(of[n], load, measure) for measure, of in columns),
        )
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(("load", *headings), rows)


def comparison_note(result: SealSolution) -> str:
    """Explanation of the differences from the closed forms; empty if none is needed."""
    if result.unloaded_bodies is not None:
        return say(result.display, "notes", "comparison_yielding")
    if limits := closed_form_limits(result.case, derive_beside(result)):
        text = write(limits, result.display)
        return f"{text[0].upper()}{text[1:]}."
    return say(result.display, "notes", f"comparison_{law_word(result.case)}")


def _difference(share: float, load: CaseLoad, measure: str) -> str:
    """In per cent, with decimals according to the mesh error."""
    error = 0.0 if load.mesh_error is None else getattr(load.mesh_error, measure)
    decimals = 3 if abs(share) < 0.1 else 0
    if error > 0:
        decimals = min(decimals, max(0, math.ceil(-math.log10(200 * error))))
    return f"{100 * share:+.{decimals}f}".replace("-", "−")


def yielding_table(result: SealSolution) -> ReadableTable:
    """Where and how far each body has yielded at each load; no rows if all bodies are elastic."""
    rows: list[dict[str, object]] = []
    loads = result.loads if result.unloaded_bodies is not None else ()
    for whole in loads:
        zones = whole.zones
        for body, (number, name) in whole.named_bodies.items():
            load = whole.parts[number]
            assert isinstance(load.contact, ElastoplasticContact)
            if name not in load.contact.bodies:
                continue
            row = {
                "load": load_name(whole, result.loads, result.display),
                "body": result.case.label_of(body),
                "steps": load.contact.load_steps,
            }
            zone, digits = zones[body], load.digits_of("fwhm")
            if isinstance(zone, PlasticZone):
                depth = (
                    f"{result.display.quantity(zone.depth, f'worth length {digits}')} depth"
                    if zone.depth
                    else "the surface"
                )
                row |= {"strain": strain_text(zone.strain), "largest": depth, "deepest": zone.deepest}
            rows.append({"strain": "none", "largest": "–", "deepest": None, "digits": digits} | row)
    return worded_table(result.display, "yielding", rows)


def curve_in_words(display: Display, curve: HardeningCurve) -> str:
    """A hardening curve in a few words."""
    # four digits: an interpolated curve has no given digits
    first, last = (
        display.quantity(float(f"{stress:.4g}"), "given contact pressure")
        for stress in (curve.stress[0], curve.stress[-1])
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
    marks = []
    for level in Level:
        marked = [load.validity for load in loads if load.validity.level is level and level.mark]
        if marked:
            whole = any(load.of_contact.level is level for load in marked)
            marks.append(f"{level.mark} {level}" if whole else f"{level.mark} leak rate {level}")
    return marks


def validity_table(result: SealSolution) -> ReadableTable:
    """All reasons why the numbers of a load are not valid; no rows if all are."""
    loads = result.loads
    reasons: list[tuple[str, str, str]] = [
        (load_name(load, loads, result.display), doubt.level, doubt.reason(result.display))
        for load in loads
        for doubt in load.validity.doubts
    ]
    reasons += [
        (load_name(load, result.every_load, result.display), NOT_CALCULATED, why_missing(load.problem))
        for load in result.missing_loads
    ]
    rows = [dict(zip(("load", "level", "reason"), reason, strict=True)) for reason in reasons]
    return worded_table(result.display, "validity", rows)
