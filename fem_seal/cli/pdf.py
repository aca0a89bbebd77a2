"""The command `fem-seal pdf`: the report of a results folder on paper."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fem_seal.cli.terminal import say
from fem_seal.errors import InputError, Problem


def pdf(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", show_default=False, help="Results folder of `fem-seal run`.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", show_default="DIR/report.pdf", help="PDF file."),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print warnings and errors only.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    """Print the report of a results folder into a PDF file, with Chromium, Chrome or Edge."""
    from fem_seal.output.pdf import print_pdf

    page = folder / "report.html"
    if not page.is_file():
        raise InputError(
            Problem(str(folder), "holds no report.html; `fem-seal run CASE.toml -o DIR` writes one")
        )
    written = print_pdf(page, output or folder / "report.pdf")
    if not quiet:
        say(f"PDF in {written}")
