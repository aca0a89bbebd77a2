"""The command `fem-seal pdf`: the report of a results folder on paper."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from fem_seal.cli.options import Debug, Quiet, ResultsFolder, output_option
from fem_seal.cli.terminal import say
from fem_seal.errors import InputError


def pdf(
    folder: ResultsFolder,
    output: Annotated[Path | None, output_option("DIR/report.pdf", "PDF file.", "FILE")] = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Print the report of a results folder into a PDF file, with Chromium, Chrome or Edge."""
    from fem_seal.output.pdf import print_pdf

    page = folder / "report.html"
    if not page.is_file():
        raise InputError.at(str(folder), "holds no report.html; `fem-seal run CASE.toml -o DIR` writes one")
    written = print_pdf(page, output or folder / "report.pdf")
    if not quiet:
        say(f"PDF in {written}")
