"""The table of a study in other formats: CSV, Parquet, netCDF."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.case.words import problem
from fem_seal.errors import InputError, OutputError
from fem_seal.files import write_bytes
from fem_seal.output.columns import COLUMNS
from fem_seal.studies.designs_table import Designs
from leak.extras import needed

if TYPE_CHECKING:
    import xarray as xr


def export(folder: Path, path: Path) -> Path:
    """Write the table of a study; the ending of `path` says how: .csv, .parquet, .nc.

    Parameters
    ----------
    folder, path : Path

    Raises
    ------
    InputError
        If the ending is another one, or what writes the format is not installed.
    """
    write = _WRITERS.get(path.suffix.lower())
    if write is None:
        raise InputError(problem("study_export_ending", known=", ".join(_WRITERS), name=path.name))
    designs = Designs.open(folder)
    try:
        return write(designs, path)
    except ImportError as error:
        raise InputError.at("export", f"{path.suffix} {needed('studies', error)}") from None


def _csv(designs: Designs, path: Path) -> Path:
    return write_bytes(path, designs.table.to_csv(lineterminator="\n").encode())


def _parquet(designs: Designs, path: Path) -> Path:
    import io

    buffer = io.BytesIO()
    designs.table.to_parquet(buffer, engine="pyarrow")
    return write_bytes(path, buffer.getvalue())


def _netcdf(designs: Designs, path: Path) -> Path:
    # the netCDF library writes to files only
    draft = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        dataset(designs).to_netcdf(draft, engine="netcdf4")
        os.replace(draft, path)
    except (OSError, RuntimeError) as error:  # a full disc is a RuntimeError of the library
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise OutputError(f"{path}: cannot be written ({reason})") from error
    finally:
        draft.unlink(missing_ok=True)
    return path


_WRITERS: dict[str, Callable[[Designs, Path], Path]] = {".csv": _csv, ".parquet": _parquet, ".nc": _netcdf}


def dataset(designs: Designs) -> xr.Dataset:
    """The table as an xarray dataset: over the parameters for a complete grid, over the number of the design otherwise.

    Parameters
    ----------
    designs : Designs
    """
    import xarray as xr

    parameters = designs.parameters
    table = designs.table.copy()
    texts = [
        name for name in ("status", "reason", "validity", "validity_reasons", "verdict") if name in table
    ]
    for name in texts:
        table[name] = table[name].fillna("").astype(str)
    if designs.kind == "grid" and not table.duplicated(parameters).any() and len(table):
        # the number of a design stays with it
        data = xr.Dataset.from_dataframe(table.reset_index().set_index(parameters))
        for name in texts:
            data[name] = data[name].fillna("").astype(str)
    else:
        data = xr.Dataset.from_dataframe(table)
        data = data.set_coords(parameters)
    for one in designs.about["parameters"]:
        if one["unit"] and one["name"] in data:
            data[one["name"]].attrs["units"] = one["unit"]
    for name in designs.about["responses"]:
        # a plain number has the unit 1 in the conventions of netCDF
        data[name].attrs["units"] = COLUMNS[name].unit or "1"
    for name, text in designs.about["derived"].items():
        data[name].attrs["formula"] = text
    return data.assign_attrs(title=designs.about["title"], source=f"fem-seal {designs.about['version']}")
