"""A study that was calculated: its table, also as CSV, Parquet or netCDF, and its page."""

from __future__ import annotations

import shutil
import weakref
from collections.abc import Callable
from contextlib import closing
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from fem_seal.errors import InputError, OutputError
from fem_seal.files import problem, write_bytes
from fem_seal.output.columns import COLUMNS, column_named
from fem_seal.studies.designs_table import Designs
from fem_seal.studies.store import FILE, open_to_read
from leak.extras import say_missing

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class StudyResult:
    """The designs of a study and what came out of them.

    Parameters
    ----------
    folder : path
        Folder of the study.
    temporary : bool
        Whether the folder is deleted with this object.

    Raises
    ------
    InputError
        If the folder holds no study.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> study = fem_seal.Study(
    ...     case, parameters={"seat.angle": ["40 deg", "50 deg"]}, responses=["peak_pressure_Pa"]
    ... )
    >>> result = study.run(workers=0)
    >>> result.counts["done"]
    2
    >>> result.table["peak_pressure_Pa"].round(-6).tolist()
    [176000000.0, 209000000.0]
    """

    def __init__(self, folder: str | Path, *, temporary: bool = False) -> None:
        self.folder: Path = Path(folder)
        open_to_read(self.folder / FILE).close()
        if temporary:
            weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)

    def __repr__(self) -> str:
        counts = ", ".join(f"{number} {status}" for status, number in self.counts.items() if number)
        return f"<{type(self).__name__} in {self.folder}, designs: {counts or 'none'}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the designs, and the first response over the first parameter."""
        from fem_seal.studies.plots import preview

        return preview(self.designs)

    def __getitem__(self, name: str) -> pd.Series[Any]:
        """A column of the table, with or without its unit: ``result["leak_rate"]``; KeyError if there is none."""
        return self.table[column_named(name, self.table.columns)]

    @property
    def designs(self) -> Designs:
        """The designs with the evaluation of the study, as its file has them now."""
        rows: Designs = self._read(Designs.read)
        return rows

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per design, SI: status, validity, parameters, responses, derived columns, constraints.

        ``reason`` says why a design failed. ``validity`` is "valid", "doubtful" or "outside the theory",
        ``validity_reasons`` says why. A constraint's column says whether it is met.
        """
        return self.designs.table

    @cached_property
    def counts(self) -> dict[str, int]:
        """Designs that are "done", "failed" and "open"."""
        return self._read(lambda store: store.counts())

    @property
    def reasons(self) -> list[tuple[str, int]]:
        """Commonest reasons of failure, with how often they occur."""
        return self._read(lambda store: store.reasons())

    @property
    def solve_seconds(self) -> float:
        """Time that the designs took, summed over all workers [s]."""
        return self._read(lambda store: store.solve_seconds())

    def best(self, count: int = 10) -> pd.DataFrame:
        """The best designs by the only goal, or the Pareto front of two by the first.

        They meet all constraints and, unless the study keeps such designs, are not outside the theory.
        """
        designs = self.designs
        return designs.table.loc[designs.best(count)]

    @property
    def left_out(self) -> int:
        """How many designs meet all constraints but are left out of the best ones for being outside the theory."""
        return self.designs.left_out

    def report(self, path: str | Path | None = None) -> Path:
        """Write the page with plots, ``report.html`` in the study's folder unless a path is given."""
        from fem_seal.studies.page import write_page

        return write_page(self.folder, self.folder / "report.html" if path is None else Path(path))

    def export(self, path: str | Path) -> Path:
        """Write the table as CSV, Parquet or netCDF, by the ending of the path: .csv, .parquet or .nc.

        A grid becomes an array over its parameters in netCDF.

        Raises
        ------
        InputError
            If the ending is another one, or what writes the format is not installed.
        """
        path = Path(path)
        write = _WRITERS.get(path.suffix.lower())
        if write is None:
            raise InputError(problem("study_export_ending", known=", ".join(_WRITERS), name=path.name))
        designs = self.designs
        try:
            return write(designs, path)
        except ImportError as error:
            raise InputError.at("export", f"{path.suffix} {say_missing('studies', error)}") from None

    def _read(self, what: Any) -> Any:
        with closing(open_to_read(self.folder / FILE)) as store:
            return what(store)


def _netcdf(designs: Designs, path: Path) -> Path:
    # the netCDF library writes to files only
    with TemporaryDirectory(prefix="fem-seal-") as folder:
        draft = Path(folder) / path.name
        try:
            dataset(designs).to_netcdf(draft, engine="netcdf4")
        except RuntimeError as error:  # a full disc, in the words of the library
            raise OutputError(f"{path}: cannot be written ({error})") from error
        return write_bytes(path, draft.read_bytes())


_WRITERS: dict[str, Callable[[Designs, Path], Path]] = {
    ".csv": lambda designs, path: write_bytes(path, designs.table.to_csv(lineterminator="\n").encode()),
    ".parquet": lambda designs, path: write_bytes(path, designs.table.to_parquet(engine="pyarrow")),
    ".nc": _netcdf,
}


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
    for parameter in designs.about["parameters"]:
        if parameter["unit"] and parameter["name"] in data:
            data[parameter["name"]].attrs["units"] = parameter["unit"]
    for name in designs.about["responses"]:
        # a plain number has the unit 1 in the conventions of netCDF
        data[name].attrs["units"] = COLUMNS[name].unit or "1"
    for name, text in designs.about["derived"].items():
        data[name].attrs["formula"] = text
    return data.assign_attrs(title=designs.about["title"], source=f"fem-seal {designs.about['version']}")
