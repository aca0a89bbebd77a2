"""The result files of one calculation, in one folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.report import write_report
from fem_seal.results_folder import replaced_together
from fem_seal.summary import write_summary
from fem_seal.tables import write_imprint_csv, write_leak_csv, write_profile_csv
from fem_seal.theory_variants import write_variants_csv
from fem_seal.vtk import write_contact, write_contact_line, write_unloaded

if TYPE_CHECKING:
    from fem_seal.results import SealResult


def write(result: SealResult, folder: Path) -> Path:
    """Write tables, summary, VTK files, mesh and report into a folder, all of them or none.

    They take the places of those of an earlier run together; everything else in the folder is left alone. The caller
    sees to it that nobody else writes there, see `fem_seal.folder_lock`.

    Parameters
    ----------
    result : SealResult
    folder : pathlib.Path
        Made if it does not exist.

    Returns
    -------
    pathlib.Path
        The folder.

    Raises
    ------
    OutputError
        If a file cannot be written.
    """
    folder = Path(folder)
    with replaced_together(folder) as draft:
        result.seal_mesh.write(draft / "mesh.msh")
        write_leak_csv(result, draft / "leak.csv")
        write_profile_csv(result, draft / "profile.csv")
        write_contact(result, draft)
        write_contact_line(result, draft)
        write_unloaded(result, draft)
        write_imprint_csv(result, draft / "imprint.csv")
        if result.theory_variants:
            write_variants_csv(result, draft / "variants.csv")
        write_report(result, draft / "report.html")
        write_summary(result, draft / "summary.json", folder)
    return folder
