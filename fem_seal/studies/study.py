"""A study: one case turned into many, checked before any of it runs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from fem_seal.case.case import Case, case_of, load_case, with_files
from fem_seal.case.messages import problems
from fem_seal.case.notation import as_difference, said_twice
from fem_seal.case.paths import entry_at, with_open_materials
from fem_seal.case.words import problem
from fem_seal.errors import InputError
from fem_seal.files import read_toml
from fem_seal.output.columns import in_full
from fem_seal.studies import designs, plan
from fem_seal.studies.progress import Progress
from fem_seal.studies.tables import Parameter, StudyTables, read_parameter
from fem_seal.studies.work import contents_of_files

if TYPE_CHECKING:
    from dask.distributed import Client

    from fem_seal.studies.results import StudyResult


class Study(plan.StudyPlan):
    """One case, the entries that vary, the designs, and what is wanted of each.

    Parameters
    ----------
    base : Case, str, path or dict
        The case that the designs are variants of, or a dict of its tables. A dict with an entry ``base`` is a whole
        study, as its file holds it.
    **tables
        The tables of a study file as they stand there: ``changes``, ``parameters``, ``design``, ``responses``,
        ``derived``, ``constraints``, ``outside_theory``, ``run``, ``report``, ``optimise``, and ``title``.

    Raises
    ------
    InputError
        If anything is wrong with the study or with one of its designs.

    Examples
    --------
    >>> study = Study(                                                          # doctest: +SKIP
    ...     "ball_cone.toml",
    ...     changes={"load.fluid_pressure": "10 bar"},
    ...     parameters={"seat.angle": {"start": "30 deg", "stop": "60 deg", "num": 7}},
    ...     responses=["leak_rate_m3_per_s"],
    ... )
    >>> study.run().table                                                       # doctest: +SKIP

    The same as a dict, with the case in it:

    >>> Study({
    ...     "base": {
    ...         "closure": {"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...         "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...         "interface": {"law": "smooth"},
    ...         "load": {"fluid_pressure": "10 bar"},
    ...     },
    ...     "parameters": {"seat.angle": {"start": "30 deg", "stop": "60 deg", "num": 7}},
    ...     "responses": ["peak_pressure_Pa"],
    ... })
    <Study of untitled case: 7 designs over seat.angle; peak_pressure_Pa>
    """

    def __init__(self, base: Case | str | Path | Mapping[str, Any], /, **tables: Any) -> None:
        if isinstance(base, Mapping):
            base, tables = _base_and_tables(base, tables)
        if not isinstance(base, (str, os.PathLike)):
            base = case_of(base)
        self._set_up(base, tables, Path.cwd(), None)

    def __repr__(self) -> str:
        many = "designs to be searched" if self.optimise else f"{len(self.points)} designs"
        return (
            f"<{type(self).__name__} of {self.title or 'untitled case'}: {many} over {', '.join(self.names)}; "
            f"{', '.join(self.output_names)}>"
        )

    def _set_up(
        self, base: Case | str | Path, tables: Mapping[str, Any], folder: Path, file: Path | None
    ) -> None:
        name = (
            base if isinstance(base, str) else str(base.file or "") if isinstance(base, Case) else str(base)
        )
        read = _read_tables({**tables, "base": name})
        self.file = file
        case = base if isinstance(base, Case) else load_case(folder / base)
        changes = with_files(read.changes, lambda named: str(folder / named))
        case = _change_case(case, changes, read.parameters)
        self.written = dict(tables)
        self.title = read.title or (file.stem if file else case.title)
        self.design = read.design
        self.run_settings = read.run
        self.report = read.report
        self.keeps_outside = read.outside_theory == "keep"
        self.optimise = read.optimise
        self._read_points(with_open_materials(case, list(read.parameters)), read, folder)
        self.files = contents_of_files(self.case, self.parameters)
        responses = list(map(in_full, read.responses))
        self.derived = plan.read_formulas(self, read.derived, responses)
        self.constraints = plan.read_constraints(self, read.constraints)
        self.goals = plan.read_goals(self, read)
        self.responses, self.beside = plan.needed_columns(self, responses)
        plan.check_kept(self)
        plan.check_designs(self)

    def _read_points(self, case: Case, read: StudyTables, folder: Path) -> None:
        self.case = case
        design = read.design
        if design.kind == "list":
            if read.parameters or read.optimise:
                key = "parameters" if read.parameters else "optimise"
                raise InputError(problem("study_list_and_parameters", key=key))
            if design.file is None:
                raise InputError(problem("study_list_without_file"))
            self.case, self.parameters, self.points = designs.read_list(folder / design.file, case)
            self.parameters = tuple(_resolve_files(parameter, folder) for parameter in self.parameters)
        else:
            self.parameters = _read_parameters(case, read.parameters, folder)
            plan.check_design(design, self.parameters, read.optimise is not None)
            nothing = np.empty((0, len(self.parameters)))
            self.points = nothing if read.optimise else designs.points(design, self.parameters)
        plan.check_changes(read.changes, self.names)
        plan.check_load(self.case, self.names)

    def run(
        self,
        client: Client | None = None,
        *,
        folder: str | Path | None = None,
        workers: int | None = None,
        resume: bool = False,
        retry_failed: bool = False,
        progress: Progress | None = None,
    ) -> StudyResult:
        """Calculate all designs that are not calculated yet.

        Parameters
        ----------
        client : dask.distributed.Client, optional
            Cluster that calculates; processes of this machine unless given.
        folder : path, optional
            Where the designs are kept; a temporary folder that goes with the result unless given.
        workers : int, optional
            Processes of this machine, one per core unless given; 0 for this process.
        resume : bool
            Whether `folder` may hold designs of this study already, which are then not calculated again.
        retry_failed : bool
            Whether those of them that failed are calculated again.
        progress : Progress, optional
            Told how far it is.

        Returns
        -------
        StudyResult
            With the designs in `.table`.
        """
        from fem_seal.studies.session import run_study

        return run_study(
            self,
            client,
            folder=folder,
            workers=workers,
            resume=resume,
            retry_failed=retry_failed,
            progress=progress,
        )


def load_study(path: str | Path) -> Study:
    """Read and check a study file.

    Parameters
    ----------
    path : path
        TOML file. The base case and other files named in it are looked for beside it.

    Raises
    ------
    InputError
        If the file cannot be read or anything in it, or in one of the designs, is wrong.

    Examples
    --------
    >>> import fem_seal
    >>> study = fem_seal.load_study("examples/studies/angle_and_roughness.toml")     # doctest: +SKIP
    >>> study.run().table                                                             # doctest: +SKIP
    """
    path = Path(path)
    tables = read_toml(path, "study")
    base = tables.pop("base", None)
    try:
        if not isinstance(base, str):
            what = "is missing" if base is None else "must be a text"
            raise InputError(problem("study_base", what=what))
        study = Study.__new__(Study)
        study._set_up(base, tables, path.absolute().parent, path)
    except InputError as error:
        raise error.in_file(error.file or path) from None
    return study


def _base_and_tables(
    given: Mapping[str, Any], tables: Mapping[str, Any]
) -> tuple[Case | str | Path, dict[str, Any]]:
    """The case and the tables of a study that is a dict, or of one whose case is."""
    if "base" not in given:
        return Case(**given), dict(tables)
    if tables:
        raise InputError(problem("study_beside_whole", key=next(iter(tables))))
    base, own = given["base"], {key: value for key, value in given.items() if key != "base"}
    return (Case(**base) if isinstance(base, Mapping) else base), own


def _read_tables(tables: dict[str, Any]) -> StudyTables:
    given = {
        name: _flatten_paths(value, name) if name in ("changes", "parameters") else value
        for name, value in tables.items()
    }
    try:
        return StudyTables(**{name: _as_tuple(value) for name, value in given.items()})
    except ValidationError as error:
        raise InputError(*problems(error, StudyTables)) from None


def _as_tuple(value: Any) -> Any:
    """Lists become tuples where tables are read strictly."""
    if isinstance(value, dict):
        return {key: tuple(entry) if isinstance(entry, list) else entry for key, entry in value.items()}
    return tuple(value) if isinstance(value, list) else value


def _flatten_paths(table: Any, heading: str) -> Any:
    """Paths as one key each: ``seat.angle = ...`` without quotes is a nested table in TOML."""
    if not isinstance(table, dict):
        return table
    flat: dict[str, Any] = {}
    for key, value in table.items():
        nested = {key: value}
        if isinstance(value, dict) and value and not set(value) & {"start", "stop", "num", "distribution"}:
            below = _flatten_paths(value, f"{heading}.{key}")
            nested = {f"{key}.{name}": entry for name, entry in below.items()}
        for path, entry in nested.items():
            if path in flat:
                raise InputError.at(f"{heading}.{path}", "stands there twice; remove one of them")
            flat[path] = entry
    return flat


def _change_case(case: Case, changes: Mapping[str, Any], parameters: Mapping[str, Any]) -> Case:
    """The base case with the changes; if these need it, with values of the parameters, which every design replaces."""
    if not changes:
        return case
    try:
        return with_open_materials(case, list(changes)).replace_written(changes)
    except InputError as error:
        for end in (0, -1):
            varied = {path: _ends(given)[end] for path, given in parameters.items()}
            with suppress(InputError):
                return with_open_materials(case, [*changes, *varied]).replace_written({**changes, **varied})
        raise InputError.at(f"changes.{error.key}", error.message, error.value) from None


def _ends(given: Any) -> tuple[Any, Any]:
    """First and last value of a parameter as it was given."""
    if isinstance(given, Mapping):
        first, last = ("start", "low", "mean", "median"), ("stop", "high", "mean", "median")
        start, stop = (
            next((given[name] for name in names if name in given), None) for names in (first, last)
        )
        return start, stop
    if isinstance(given, (list, tuple)):
        return (given[0], given[-1]) if given else (None, None)
    # no parameter, as `read_parameter` will say
    return given, given


def _read_parameters(case: Case, given: Mapping[str, Any], folder: Path) -> tuple[Parameter, ...]:
    read = []
    again = said_twice(given)
    if again:
        raise InputError(problem("study_varied_twice", key=again[1], other=again[0]))
    for path, value in given.items():
        try:
            entry = entry_at(case, path)
        except InputError as error:
            raise InputError.at(f"parameters.{path}", error.message) from None
        # an absolute pressure is above that at the outlet, which may differ from design to design
        fluid = None if any(path.startswith("fluid.") for path in given) else case.written.get("fluid")
        read.append(_resolve_files(read_parameter(entry, as_difference(entry.path, value, fluid)), folder))
    return tuple(read)


def _resolve_files(parameter: Parameter, folder: Path) -> Parameter:
    """Files that a parameter names are looked for beside the study file."""
    if not parameter.name.endswith(".file"):
        return parameter
    return Parameter(parameter.entry, tuple(str(folder / str(level)) for level in parameter.levels))
