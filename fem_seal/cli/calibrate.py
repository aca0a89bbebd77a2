"""The command `fem-seal calibrate`: what a leak test says about a seal."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from fem_seal.cli.terminal import (
    CaseFile,
    Debug,
    Quiet,
    argument,
    case_of_command,
    json_option,
    output_option,
    progress_of,
    say,
    say_json,
    show_table,
)


def calibrate(
    case_file: CaseFile,
    measured: Annotated[Path, argument("calibrate", "measured")],
    output: Annotated[Path | None, output_option("CASE.calibrated")] = None,
    quiet: Quiet = False,
    json: Annotated[bool, json_option("the summary")] = False,
    debug: Debug = False,
) -> None:
    """Learn from measured leak rates: narrower predictions, inputs, conflicts, and the next test."""
    import fem_seal
    from fem_seal.output import calibration as files
    from fem_seal.output.folders import folder_lock, replaced_together

    case = case_of_command(case_file)
    folder = output or case_file.with_suffix(".calibrated")
    with folder_lock(folder), progress_of(quiet) as progress:
        found = fem_seal.calibrate(case, measured, progress)
        with replaced_together(folder, whole=False) as draft:
            files.write_calibration(found, draft)
    if json:
        say_json({"folder": str(folder), **files.summary(found)})
    elif not quiet:
        for line in files.lines(found):
            say(line)
        show_table(
            "Leak rates of the case's loads", files.PREDICTION_HEADINGS, files.prediction_rows(found), 2
        )
        say(files.files_line(found, folder))
