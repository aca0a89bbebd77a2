"""The commands `fem-seal study ...`: read, call, show."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from fem_seal.cli.terminal import Debug, Quiet, argument, option, output_option, say, say_json, warn
from fem_seal.errors import NoLoadLeftError, Problem, errors_in

if TYPE_CHECKING:
    from fem_seal.studies.designs_table import Designs
    from fem_seal.studies.results import StudyResult

_BEST = 10


class _DefaultRun(TyperGroup):
    """Takes `fem-seal study STUDY.toml` as `fem-seal study run STUDY.toml`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the command in front of the file."""
        options = ("--help", "-h")
        if args and args[0] not in self.commands and args[0] not in options:
            args = ["run", *args]
        return super().parse_args(ctx, args)


app = typer.Typer(
    cls=_DefaultRun,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Calculate many designs of one case: fem-seal study STUDY.toml, fem-seal study report DIR.",
)

StudyFolder = Annotated[Path, argument("study", "folder")]
Json = Annotated[bool, option("study", "json")]


@app.command()
def run(
    study_file: Annotated[Path, argument("study", "file")],
    output: Annotated[Path | None, output_option("STUDY.study", "Folder for the study.")] = None,
    workers: Annotated[int | None, option("study", "workers")] = None,
    scheduler: Annotated[str | None, option("study", "scheduler")] = None,
    resume: Annotated[bool, option("study", "resume")] = False,
    retry_failed: Annotated[bool, option("study", "retry_failed")] = False,
    quiet: Quiet = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Calculate the designs of a study, store them in study.sqlite and write report.html."""
    # its tables come at the end, and who lacks it is told at once
    import pandas  # noqa: F401

    from fem_seal.studies.progress import shown_progress
    from fem_seal.studies.session import run_study
    from fem_seal.studies.study import load_study

    study = load_study(study_file)
    with errors_in(study.case.display):
        result = run_study(
            study,
            folder=output or study_file.with_suffix(".study"),
            workers=workers,
            scheduler=scheduler,
            resume=resume,
            retry_failed=retry_failed,
            progress=shown_progress(quiet),
            leave=_leave,
        )
    result.report()
    _show(result, quiet, json)
    counts = result.counts
    if counts["failed"] and not counts["done"]:
        raise NoLoadLeftError(Problem("", "none of its designs can be calculated"), file=study_file)


def _leave() -> None:
    """End the process at once, from any thread: a thread that never returns cannot be joined."""
    sys.stdout.flush()
    os._exit(1)


@app.command()
def report(
    folder: StudyFolder,
    output: Annotated[Path | None, output_option("DIR/report.html", "File to write.", "FILE")] = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Rewrite report.html; the study may still be running."""
    from fem_seal.studies.results import StudyResult

    path = StudyResult(folder).report(output)
    if not quiet:
        say(f"Page in {path}")


@app.command()
def export(
    folder: StudyFolder,
    path: Annotated[Path, argument("study", "export")],
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Write the table of a study as CSV, Parquet or netCDF."""
    from fem_seal.studies.results import StudyResult

    file = StudyResult(folder).export(path)
    if not quiet:
        say(f"Table in {file}")


def _show(result: StudyResult, quiet: bool, json: bool) -> None:
    if json:
        designs = result.best().reset_index().to_dict("records")
        say_json(
            {"folder": str(result.folder), **result.counts, "left_out": result.left_out, "best": designs}
        )
        return
    warn(f"{times} failed: {reason}" for reason, times in result.reasons)
    if quiet:
        return
    _show_best(result.designs)
    counts = result.counts
    say(f"{counts['done']} designs done, {counts['failed']} failed, {counts['open']} open")
    _show_remarks(result.designs)
    say(f"Results in {result.folder}: study.sqlite, report.html")


def _show_remarks(designs: Designs) -> None:
    """How many designs pass often enough, and whether a better one may lie outside of the ranges."""
    from fem_seal.studies.display import DesignDisplay
    from fem_seal.studies.page import edge_sentence, passing_words

    display = DesignDisplay(designs)
    for sentence in filter(None, (passing_words(display), edge_sentence(display))):
        say(sentence)


def _show_best(designs: Designs) -> None:
    """Print the best designs side by side, as many as fit; numbers are never cut."""
    from fem_seal.studies.display import DesignDisplay

    display, numbers = DesignDisplay(designs), designs.best(_BEST)
    if designs.about["goals"] and designs.left_out:
        say(f"{display.words.outside_left_out(designs.left_out)}.")
    if not numbers:
        return
    lines = {"design": [str(number) for number in numbers], **display.describe(numbers)}
    labels = max(map(len, lines))
    cells = max(len(text) for line in lines.values() for text in line) + 2
    count = max((shutil.get_terminal_size().columns - labels) // cells, 1)
    say("Best designs", bold=True)
    for first in range(0, len(numbers), count):
        for label, line in lines.items():
            line_text = "".join(text.rjust(cells) for text in line[first : first + count])
            say(label.ljust(labels) + line_text)
        say()
