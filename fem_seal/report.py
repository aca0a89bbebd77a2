"""report.html: one page that needs nothing but itself."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal import (
    __version__,
    report_case,
    report_plastic,
    report_tables,
    report_text,
    report_uncertainty,
    report_valve,
)
from fem_seal.atomic_files import write_text
from fem_seal.closed_forms import Sizes, profile_sizes
from fem_seal.derived import Derived, derive
from fem_seal.far_field import far_field_sentence
from fem_seal.load_names import load_name
from fem_seal.pictures import Picture, style
from fem_seal.pictures_contact import gap_picture, profile_picture, size_picture
from fem_seal.pictures_fields import mesh_picture, stress_picture
from fem_seal.pictures_leak import leak_picture
from fem_seal.pictures_plastic import imprint_picture
from fem_seal.pictures_sketch import sketch
from fem_seal.pictures_surface import law_picture, separation_picture, surface_picture
from fem_seal.sources import sources

if TYPE_CHECKING:
    from jinja2 import Template

    from fem_seal.results import SealResult


def write_report(result: SealResult, path: Path) -> Path:
    """Write the report, atomically.

    Parameters
    ----------
    result : SealResult
    path : pathlib.Path
    """
    return write_text(path, report(result))


def report(result: SealResult) -> str:
    """The report as one HTML page: no script, nothing fetched from anywhere.

    Parameters
    ----------
    result : SealResult
    """
    derived = derive(result.case)
    sizes = profile_sizes(result, derived)
    return _template().render(
        title=result.case.title or "fem-seal",
        case_file=None if result.case.file is None else result.case.file.name,
        version=__version__,
        created=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        picture={picture.name: picture for picture in pictures(result, derived, sizes)},
        sources=sources(result),
        **_words(result, derived, sizes),
    )


def pictures(result: SealResult, derived: Derived, sizes: Mapping[str, Sizes]) -> list[Picture]:
    """All pictures that the result has something to show for.

    Parameters
    ----------
    result : SealResult
    derived : Derived
        Closed forms of the case.
    sizes : mapping
        From `fem_seal.closed_forms.profile_sizes`.
    """
    top = report_text.highest_load(result)
    with style():
        drawn = (
            sketch(result),
            mesh_picture(result, top),
            profile_picture(result, derived),
            size_picture(result, sizes),
            gap_picture(result),
            law_picture(result),
            leak_picture(result),
            separation_picture(result),
            surface_picture(result, top),
            stress_picture(result, max(result.loads, key=lambda load: load.max_von_mises)),
            imprint_picture(result),
        )
    return [picture for picture in drawn if picture is not None]


def _words(result: SealResult, derived: Derived, sizes: Mapping[str, Sizes]) -> dict[str, Any]:
    load = report_text.highest_load(result)
    return {
        "headline": report_text.headline(result),
        "highest": load_name(load, result.loads),
        "strongest": load_name(result.strongest, result.loads),
        "facts": report_text.facts(result),
        "reasons": report_text.reasons(result, derived),
        "warnings": result.warnings,
        "marks": report_tables.marks_in_words(result),
        "validity": report_tables.validity_table(result),
        "seal_groups": report_case.seal_groups(result),
        "surface_groups": report_case.surface_groups(result),
        "loads": report_tables.load_table(result, sizes),
        "valve": report_valve.valve_table(result),
        "comparison_note": report_tables.comparison_note(result),
        "comparison": report_tables.comparison_table(result, sizes),
        "variants": report_tables.variant_table(result),
        "interval": report_uncertainty.interval_table(result),
        "interval_note": report_uncertainty.interval_note(result),
        "theory": report_uncertainty.theory_table(result),
        "theory_note": report_uncertainty.theory_note(result),
        "yielding": report_plastic.yielding_table(result),
        "accuracy": report_case.accuracy(result),
        "far_field": far_field_sentence(result),
        "timings": report_case.times(result),
        "definitions": report_text.DEFINITIONS,
    }


@cache
def _template() -> Template:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    # Titles, names and file names come from the user: everything is escaped.
    environment = Environment(
        loader=PackageLoader("fem_seal"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2")
