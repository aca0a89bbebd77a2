"""A result as Python shows it: a few lines of text, and in a notebook its table with the pressure profiles."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from fem_seal.seal.findings import why_missing
from fem_seal.seal.load_result import MissingLoad, load_name

if TYPE_CHECKING:
    import pandas as pd

    from fem_seal.answers.case_load import AnyLoad
    from fem_seal.answers.solution import SealSolution
    from fem_seal.output.columns import ReadableTable
    from fem_seal.units import Display

# Largest number of loads in a text, and of rows in a notebook.
_NAMED = 5
_ROWS = 20


def result_text(result: SealSolution) -> str:
    """A few lines: the loads with their pressure, width, leak rate and validity, and the number of warnings.

    Parameters
    ----------
    result : SealSolution
    """
    loads = result.every_load
    heading = f"{result.case.title or 'untitled case'}: {_counted(len(loads), 'load')}"
    if result.warnings:
        heading += f", {_counted(len(result.warnings), 'warning')}"
    # of many loads the first ones and the last
    named = loads if len(loads) <= _NAMED else (*loads[: _NAMED - 1], loads[-1])
    lines = [
        f"  {load_name(load, loads, result.display)}: {_in_brief(load, result.display)}" for load in named
    ]
    if len(named) < len(loads):
        lines.insert(-1, f"  ... {_counted(len(loads) - len(named), 'load')} more")
    return "\n".join([heading, *lines])


def _in_brief(load: AnyLoad, display: Display) -> str:
    return (
        f"not calculated, {why_missing(load.problem)}"
        if isinstance(load, MissingLoad)
        else load.in_brief.text(display)
    )


def result_html(result: SealSolution) -> str:
    """The table of the loads as in the report, and the figure, as HTML.

    Parameters
    ----------
    result : SealSolution
    """
    from fem_seal.output.pictures.style import Picture, svg
    from fem_seal.output.plots import result_figure
    from fem_seal.output.report.brief import first_line
    from fem_seal.output.report.page import load_table, marks_in_words

    picture = Picture(
        "result", svg(result_figure(result)), "leak rate over the loads, and pressure profiles", ""
    )
    return (
        f"<p><b>{escape(result.case.title)}</b><br>{escape(first_line(result))}</p>{_readable(load_table(result))}"
        f"<p>{escape(marks_in_words(result).strip())} All columns, in SI: <code>.table</code>.</p>"
        f'<img src="{picture.address}" alt="{picture.alt}" style="max-width: 100%">'
    )


def _readable(table: ReadableTable) -> str:
    """A table in readable units; of a long one the first and last rows."""
    import pandas as pd

    frame = pd.DataFrame(table.rows, columns=list(table.headings))
    with pd.option_context("display.max_colwidth", None):  # otherwise long cells are cut
        return _scrolling(frame.to_html(max_rows=_ROWS, index=False, border=0))


def _scrolling(table: str) -> str:
    return f'<div style="overflow-x: auto">{table}</div>'


def table_html(table: pd.DataFrame) -> str:
    """A table that scrolls, without its empty columns; of a long one the first and last rows.

    Parameters
    ----------
    table : pandas.DataFrame
    """
    filled = table.dropna(axis="columns", how="all")
    return _scrolling(filled.to_html(max_rows=_ROWS, float_format="{:.4g}".format, border=0))


def _counted(number: int, name: str) -> str:
    return f"{number} {name}" if number == 1 else f"{number} {name}s"
