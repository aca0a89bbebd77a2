"""Terminal output: all lines of the commands pass here and are stripped of control characters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from fem_seal.errors import printable
from fem_seal.files import as_json

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rich.console import Console
    from rich.table import Table


def say(*lines: str, bold: bool = False) -> None:
    """Print lines; an empty one without any."""
    for line in lines or ("",):
        typer.secho(printable(line), bold=bold or None)


def say_json(value: object) -> None:
    """Print a value as JSON."""
    say(*as_json(value).split("\n"))


def note(line: str) -> None:
    """Print what is being done, on standard error."""
    typer.secho(printable(line), err=True)


def warn(warnings: Iterable[str]) -> None:
    """Print warnings on standard error."""
    for warning in warnings:
        _call("warning: ", warning, typer.colors.YELLOW)


def complain(message: str, word: str = "error: ") -> None:
    """Print an error on standard error, each of its lines behind a word."""
    _call(word, message, typer.colors.RED)


def _call(word: str, message: str, colour: str) -> None:
    for line in message.split("\n"):
        typer.secho(f"{word}{printable(line)}", err=True, fg=colour)


def cell(text: str) -> str:
    """A cell of a table, or a line of progress, for rich: no markup in it, its own line breaks kept."""
    from rich.markup import escape

    return escape("\n".join(map(printable, text.split("\n"))))


def numbers_table(
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    narrow: bool = False,
    names: bool = False,
    words: bool = False,
) -> Table:
    """A table of numbers, to the right and none of them cut.

    Parameters
    ----------
    headings : sequence of str
    rows : sequence of sequence of str
    narrow : bool
        One blank between the columns.
    names, words : bool
        Whether the first column holds names, the last one words that may be broken.
    """
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0) if narrow else (0, 1))
    last = len(headings) - 1
    for number, heading in enumerate(headings):
        if words and number == last:
            table.add_column(cell(heading), overflow="fold")
        else:
            table.add_column(
                cell(heading), justify="left" if names and number == 0 else "right", no_wrap=True
            )
    for row in rows:
        table.add_row(*map(cell, row))
    return table


def show(table: Table, console: Console | None = None) -> None:
    """Print a table of cells."""
    from rich.console import Console

    (console or Console(highlight=False)).print(table)


def prompt(words: str, default: str) -> str:
    """Ask a question; the answer without blanks around it."""
    answer: Any = typer.prompt(printable(words), default=printable(default))
    return default if answer == printable(default) else str(answer).strip()
