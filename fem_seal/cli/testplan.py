"""The command `fem-seal testplan`: a leak test that decides between what is open."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from fem_seal.cli import terminal


def testplan(
    case_file: terminal.CaseFile,
    output: Annotated[Path | None, terminal.output_option("CASE.testplan")] = None,
    quiet: terminal.Quiet = False,
    json: Annotated[bool, terminal.json_option("the readings")] = False,
    debug: terminal.Debug = False,
) -> None:
    """Plan a leak test: a protocol to print, and a table of its loads for `fem-seal calibrate`."""
    from fem_seal.answers.testplan import plan_leak_test
    from fem_seal.output import testplan as files
    from fem_seal.output.folders import folder_lock, replaced_together
    from fem_seal.wording import say

    case = terminal.case_of_command(case_file)
    folder = output or case_file.with_suffix(".testplan")
    with folder_lock(folder), terminal.progress_of(quiet) as progress:
        files.check_unfilled(folder)
        plan = plan_leak_test(case, progress)
        with replaced_together(folder, whole=False) as draft:
            files.write_testplan(plan, draft, case_file.name)
    if json:
        terminal.say_json({"folder": str(folder), "readings": files.summary(plan)})
    elif not quiet:
        for line in files.lines(plan):
            terminal.say(line)
        names = [files.PROTOCOL, files.TABLE]
        terminal.say(say(case.display, "testplan", "files", folder=str(folder), names=names))
