"""A result as Python shows it: a few lines of text, and in a notebook its table with the pressure profiles."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from fem_seal.analysis.load_names import load_name
from fem_seal.analysis.results import SealSolution

if TYPE_CHECKING:
    import pandas as pd

# Loads that a text names one by one, and rows that a notebook shows.
_NAMED = 5
_ROWS = 20


def result_text(result: SealSolution) -> str:
    """A few lines: the loads with their pressure, width, leak rate and validity, and how many warnings there are.

    Parameters
    ----------
    result : SealSolution
    """
    loads = result.loads
    heading = f"{result.case.title or 'untitled case'}: {_counted(len(loads), 'load')}"
    if result.warnings:
        heading += f", {_counted(len(result.warnings), 'warning')}"
    # of many loads the first ones and the last
    shown = loads if len(loads) <= _NAMED else (*loads[: _NAMED - 1], loads[-1])
    lines = [f"  {load_name(load, loads)}: {load.in_brief}" for load in shown]
    if len(shown) < len(loads):
        lines.insert(-1, f"  ... {_counted(len(loads) - len(shown), 'load')} more")
    return "\n".join([heading, *lines])


def result_html(result: SealSolution, table: pd.DataFrame) -> str:
    """The table of the loads and the picture of their pressure profiles, to stand in a page.

    Parameters
    ----------
    result : SealSolution
    table : pandas.DataFrame
        One row per load.
    """
    from fem_seal.analysis.closed_forms import derive
    from fem_seal.output.pictures.contact import profile_picture
    from fem_seal.output.pictures.style import style

    with style():
        picture = profile_picture(result, derive(result.case))
    return (
        f"<p><b>{escape(result.case.title)}</b></p>{table_html(table)}"
        f'<img src="{picture.address}" alt="{escape(picture.alt)}" style="max-width: 100%">'
    )


def table_html(table: pd.DataFrame) -> str:
    """A table that scrolls, without its empty columns; of a long one the first and last rows.

    Parameters
    ----------
    table : pandas.DataFrame
    """
    filled = table.dropna(axis="columns", how="all")
    inner = filled.to_html(max_rows=_ROWS, float_format="{:.4g}".format, border=0)
    return f'<div style="overflow-x: auto">{inner}</div>'


def _counted(number: int, name: str) -> str:
    return f"{number} {name}" if number == 1 else f"{number} {name}s"
