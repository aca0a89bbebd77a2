"""report.html: one self-contained page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.answers.closed_forms import Derived, Sizes, derive_beside, profile_sizes
from fem_seal.answers.leakage_class import volume_of
from fem_seal.case.tables import curves
from fem_seal.contact.laws import HardContact
from fem_seal.files import write_text
from fem_seal.output import case_words, shown_answers
from fem_seal.output.answers import verdict
from fem_seal.output.pictures.contact import contact_picture, profile_picture, size_picture
from fem_seal.output.pictures.fields import imprint_picture, mesh_picture, stress_picture, temperature_picture
from fem_seal.output.pictures.leak import leak_picture, memory_picture
from fem_seal.output.pictures.section import sketch
from fem_seal.output.pictures.style import Picture, style
from fem_seal.output.pictures.surface import law_picture, separation_picture, surface_picture
from fem_seal.output.prose import phrase, prose, template
from fem_seal.output.report import brief, tables, words
from fem_seal.output.sources import sources
from fem_seal.seal.load_result import in_order
from fem_seal.seal.problem import exponential_law
from fem_seal.units import unbroken
from fem_seal.version import __version__

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution


def write_report(result: SealSolution, path: Path) -> Path:
    """Write the report, atomically.

    Parameters
    ----------
    result : SealSolution
    path : pathlib.Path
    """
    return write_text(path, report(result))


def report(result: SealSolution) -> str:
    """The report as one HTML page without scripts and without files from elsewhere.

    Parameters
    ----------
    result : SealSolution
    """
    derived = derive_beside(result)
    sizes = profile_sizes(result, derived)
    return template("report.html.j2").render(
        title=result.case.title or "fem-seal",
        in_css=_in_css,
        version=__version__,
        created=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        picture={picture.name: _unbroken(picture) for picture in pictures(result, derived, sizes)},
        sources=sources(result),
        result=result,
        **_of_case(result),
        **_unbroken(_words(result, derived, sizes)),
        words=prose(),
    )


def _unbroken(said: Any) -> Any:
    """Everything that is said with whole units: texts, and whatever they are in."""
    if type(said) is str:
        return unbroken(said)
    if isinstance(said, dict):
        return {key: _unbroken(text) for key, text in said.items()}
    if isinstance(said, (list, tuple)):
        found = [_unbroken(text) for text in said]
        # of named tuples the same
        return type(said)(*found) if hasattr(said, "_fields") else type(said)(found)
    if is_dataclass(said) and not isinstance(said, type):
        texts = {one.name: getattr(said, one.name) for one in fields(said) if one.init}
        return replace(said, **{name: _unbroken(text) for name, text in texts.items()})
    return said


def _in_css(text: str) -> str:
    r"""A text for the foot of printed pages, with all letters escaped that have a meaning in CSS or HTML.

    Examples
    --------
    >>> _in_css('Ball & "cone"')
    'Ball \\26  \\22 cone\\22 '
    """
    return "".join(one if one.isalnum() or one in " ,.-" else f"\\{ord(one):x} " for one in text)


def pictures(result: SealSolution, derived: Derived, sizes: Mapping[str, Sizes]) -> list[Picture]:
    """All pictures of a result.

    Parameters
    ----------
    result : SealSolution
    derived : Derived
        Closed forms of the case.
    sizes : mapping
        From `fem_seal.answers.closed_forms.profile_sizes`.
    """
    with style():
        return [sketch(result), *filter(None, _drawn(result, derived, sizes))]


def _drawn(result: SealSolution, derived: Derived, sizes: Mapping[str, Sizes]) -> Iterator[Picture | None]:
    top = result.highest
    if not result.of_profile:
        yield contact_picture(result, brief.decisive(result))
        yield mesh_picture(result, top)
    yield profile_picture(result, derived)
    yield size_picture(result, sizes)
    yield law_picture(result)
    yield leak_picture(result)
    yield memory_picture(result)
    yield from _around(result)
    yield separation_picture(result)
    yield surface_picture(result, top)
    yield from _simulated(result)
    if not result.of_profile:
        yield stress_picture(result, max(result.loads, key=lambda load: load.max_von_mises))
        yield temperature_picture(result, top)
        yield imprint_picture(result)
    for shown in shown_answers.shown_of(result):
        yield from shown.pictures(result)


def _around(result: SealSolution) -> tuple[Picture | None, ...]:
    """Pictures of a seal that is not round; for a round one its section shows everything."""
    if not any(load.circumference is not None and load.circumference.form.felt for load in result.loads):
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


def _simulated(result: SealSolution) -> tuple[Picture, ...]:
    """Pictures of a direct simulation; none without one."""
    flow, surface = result.problem.flow, result.surface
    if flow is None or flow.simulated is None or surface is None:
        return ()
    from fem_seal.output.pictures.direct import simulation_pictures

    return simulation_pictures(flow.simulated.table(surface), result.highest.peak_pressure)


def _of_case(result: SealSolution) -> dict[str, Any]:
    """Texts of the groups of the case that the result does not contain in this form."""
    case, problem = result.case, result.problem
    drawn = {name: case_words.section(case, name) for name in case_words.BODIES}
    heating = problem.at_rest.heating
    field = (
        None if heating is None or result.of_profile else heating.field(result.seal_mesh, problem.materials)
    )
    decay_length, law_pressure = exponential_law(case.interface, result.surface)
    at_peak = None
    if case.interface.law == "spectrum" and decay_length is None and not isinstance(problem.law, HardContact):
        peak = max(load.peak_pressure for load in result.loads)
        at_peak = float(problem.law.decay_length(np.array([math.log(peak)]))[0])
    points = in_order(case.load.points, result.not_calculated, lambda load: load.point)
    return {
        "drawn_sections": {name: case_words.section_text(one) if one else {} for name, one in drawn.items()},
        "dimensions": {name: case_words.listed_dimensions(case, name) for name in case_words.BODIES},
        # for bodies that yield the order of the loads matters
        "points_in_order": points if curves(case) else sorted(points),
        "largest_earlier_load": case_words.earlier_load(case.load),
        "gas_state": volume_of(case).state,
        "temperature_rows": list(case_words.temperature_rows(case, problem, field)),
        "finish_rows": case_words.finish_rows(case),
        "decay_length": decay_length,
        "law_pressure": law_pressure,
        "decay_length_at_peak": at_peak,
        "in_degrees": case_words.in_degrees,
        "curve_in_words": tables.curve_in_words,
    }


def _words(result: SealSolution, derived: Derived, sizes: Mapping[str, Sizes]) -> dict[str, Any]:
    load, (in_brief, left_out) = brief.decisive(result), brief.loads_in_brief(result.case, result.every_load)
    lines = brief.first_line, *brief.ANSWERS, brief.second_line
    caption = phrase("brief.table", "some" if left_out else "all", left_out=left_out)
    return {
        "given": words.given_in_words(result),
        "first_lines": [told for line in lines if (told := line(result))],
        "three_numbers": brief.three_numbers(result),
        "loads_in_brief": in_brief,
        "brief_caption": "; ".join(filter(None, [caption, verdict.allowed_in_words(result.loads)])),
        "assumed": [*words.held_in_words(result.case, load), *brief.remarks_in_brief(result)],
        "headline": words.headline(result),
        "facts": words.facts(result),
        "reasons": [] if result.of_profile else words.reasons(result, derived),
        "far_field": words.far_field_sentence(result),
        "loads": tables.load_table(result),
        "marks": tables.marks_in_words(result),
        "validity": tables.validity_table(result),
        "comparison_note": tables.comparison_note(result),
        "comparison": tables.comparison_table(result, sizes),
        "yielding": tables.yielding_table(result),
        "sections": list(filter(None, (shown.section(result) for shown in shown_answers.shown_of(result)))),
        **{name: value for shown in shown_answers.SHOWN for name, value in shown.words_of(result).items()},
    }
