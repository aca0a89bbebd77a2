"""The command `fem-seal calibrate`: what a leak test says about a seal."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from fem_seal.cli import terminal


def calibrate(
    case_file: terminal.CaseFile,
    measured: Annotated[Path, terminal.argument("calibrate", "measured")],
    output: Annotated[Path | None, terminal.output_option("CASE.calibrated")] = None,
    quiet: terminal.Quiet = False,
    json: Annotated[bool, terminal.json_option("the summary")] = False,
    debug: terminal.Debug = False,
) -> None:
    """Learn from measured leak rates: narrower predictions, inputs, conflicts, and the next test."""
    import fem_seal
    from fem_seal.output import calibration as files
    from fem_seal.output.folders import folder_lock, replaced_together

    case = terminal.case_of_command(case_file)
    folder = output or case_file.with_suffix(".calibrated")
    with folder_lock(folder), terminal.progress_of(quiet) as progress:
        calibration = fem_seal.calibrate(case, measured, progress)
        with replaced_together(folder, whole=False) as draft:
            files.write_calibration(calibration, draft)
            if not calibration.is_usable:
                # those of an earlier test
                for name in (files.CASE, files.POSTERIOR):
                    (folder / name).unlink(missing_ok=True)
    if quiet and not calibration.is_usable:
        terminal.warn(list(files.lines(calibration))[-1:])
    if json:
        terminal.say_json({"folder": str(folder), **files.summary(calibration)})
    elif not quiet:
        for line in files.lines(calibration):
            terminal.say(line)
        terminal.show_table(
            "Leak rates of the case's loads", files.PREDICTION_HEADINGS, files.prediction_rows(calibration), 2
        )
        terminal.say(files.files_line(calibration, folder))
