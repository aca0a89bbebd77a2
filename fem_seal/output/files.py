"""The result files of one calculation, in one folder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.output import shown_answers
from fem_seal.output.folders import replaced_together
from fem_seal.output.report.page import write_report
from fem_seal.output.summary import write_summary
from fem_seal.output.tables import imprint_rows, write_leak_csv, write_profile_csv, write_rows_csv
from fem_seal.output.vtk import write_around, write_contact, write_contact_line, write_unloaded
from fem_seal.seal.optional_steps import OptionalSteps

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution


def write(result: SealSolution, folder: Path) -> tuple[str, ...]:
    """Write tables, summary, VTK files, mesh and report into a folder, all that can be made or none.

    They take the places of those of an earlier run together; everything else in the folder is left alone. The caller
    sees to it that nobody else writes there, see `fem_seal.output.folders`.

    Parameters
    ----------
    result : SealSolution
    folder : pathlib.Path
        Made if it does not exist.

    Returns
    -------
    tuple of str
        A sentence for each file that could not be made; the others are there, and summary.json says so, too.

    Raises
    ------
    OutputError
        If a file cannot be written.
    """
    folder, steps = Path(folder), OptionalSteps()
    with replaced_together(folder) as draft:
        write_leak_csv(result, draft / "leak.csv")
        write_profile_csv(result, draft / "profile.csv")
        # a full disc concerns the other files as well
        for name, write_one in _FILES.items():
            with steps.attempt(name, but=OSError):
                write_one(result, draft)
        tables = {name: table for shown in shown_answers.SHOWN for name, table in shown.tables.items()}
        for name, table in {"imprint.csv": imprint_rows, **tables}.items():
            with steps.attempt(name, but=OSError):
                columns, rows = table(result)
                if rows:
                    write_rows_csv(draft / name, columns, rows)
        with steps.attempt("summary.json", but=OSError):
            told = (*result.warnings, *steps.failures)
            write_summary(replace(result, warnings=told), draft / "summary.json", folder)
    return tuple(steps.failures)


def _vtk(result: SealSolution, folder: Path) -> None:
    write_contact(result, folder)
    write_contact_line(result, folder)
    write_around(result, folder)
    write_unloaded(result, folder)


# Optional files: a failure becomes a warning.
_FILES: dict[str, Callable[[SealSolution, Path], object]] = {
    "mesh.msh": lambda result, folder: result.seal_mesh.write(folder / "mesh.msh"),
    "VTK files": _vtk,
    "report.html": lambda result, folder: write_report(result, folder / "report.html"),
}
