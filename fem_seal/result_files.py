"""The result files of one calculation, in one folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.errors import OutputError
from fem_seal.report import write_report
from fem_seal.summary import write_summary
from fem_seal.tables import write_imprint_csv, write_leak_csv, write_profile_csv
from fem_seal.theory_variants import write_variants_csv
from fem_seal.vtk import write_contact, write_contact_line, write_unloaded

if TYPE_CHECKING:
    from fem_seal.results import SealResult


def write(result: SealResult, folder: Path) -> Path:
    """Write tables, summary, VTK files, mesh and report into a folder.

    Each file is replaced in one step. VTK files, variants.csv and imprint.csv that an earlier run left in the folder
    are removed; everything else in it is left alone.

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
    try:
        folder.mkdir(parents=True, exist_ok=True)
        result.seal_mesh.write(folder / "mesh.msh")
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"{folder}: cannot be written ({reason})") from error
    write_leak_csv(result, folder / "leak.csv")
    write_profile_csv(result, folder / "profile.csv")
    write_contact(result, folder)
    write_contact_line(result, folder)
    write_unloaded(result, folder)
    write_imprint_csv(result, folder / "imprint.csv")
    if result.theory_variants:
        write_variants_csv(result, folder / "variants.csv")
    else:
        (folder / "variants.csv").unlink(missing_ok=True)
    write_report(result, folder / "report.html")
    write_summary(result, folder / "summary.json")
    return folder
