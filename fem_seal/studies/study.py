"""A study: one case turned into many, checked before any of it runs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from fem_seal.case.case import Case, case_of, load_case, with_files
from fem_seal.case.messages import problems
from fem_seal.case.notation import as_difference, said_twice
from fem_seal.case.paths import entry_at, with_open_materials
from fem_seal.errors import InputError
from fem_seal.files import problem, read_toml
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
        settings = _read_tables({**tables, "base": name})
        self.file = file
        case = base if isinstance(base, Case) else load_case(folder / base)
        changes = with_files(settings.changes, lambda name: str(folder / name))
        case = _change_case(case, changes, settings.parameters)
        self.written = dict(tables)
        self.title = settings.title or (file.stem if file else case.title)
        self.design = settings.design
        self.run_settings = settings.run
        self.report = settings.report
        self.keeps_outside = settings.outside_theory == "keep"
        self.optimise = settings.optimise
        self._read_points(with_open_materials(case, list(settings.parameters)), settings, folder)
        self.files = contents_of_files(self.case, self.parameters)
        responses = list(map(in_full, settings.responses))
        self.derived = plan.read_formulas(self, settings.derived, responses)
        self.constraints = plan.read_constraints(self, settings.constraints)
        self.goals = plan.read_goals(self, settings)
        self.responses, self.companions = plan.needed_columns(self, responses)
        plan.check_kept(self)
        plan.check_designs(self)

    def _read_points(self, case: Case, settings: StudyTables, folder: Path) -> None:
        self.case = case
        design = settings.design
        if design.kind == "list":
            if settings.parameters or settings.optimise:
                key = "parameters" if settings.parameters else "optimise"
                raise InputError(problem("study_list_and_parameters", key=key))
            if design.file is None:
                raise InputError(problem("study_list_without_file"))
            self.case, self.parameters, self.points = designs.read_list(folder / design.file, case)
            self.parameters = tuple(_resolve_files(parameter, folder) for parameter in self.parameters)
        else:
            self.parameters = _read_parameters(case, settings.parameters, folder)
            plan.check_design(design, self.parameters, settings.optimise is not None)
            no_points = np.empty((0, len(self.parameters)))
            self.points = no_points if settings.optimise else designs.points(design, self.parameters)
        plan.check_changes(settings.changes, self.names)
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
    source: Mapping[str, Any], tables: Mapping[str, Any]
) -> tuple[Case | str | Path, dict[str, Any]]:
    """The case and the tables of a study that is a dict, or of one whose case is."""
    if "base" not in source:
        return Case(**source), dict(tables)
    if tables:
        raise InputError(problem("study_beside_whole", key=next(iter(tables))))
    base, rest = source["base"], {key: value for key, value in source.items() if key != "base"}
    return (Case(**base) if isinstance(base, Mapping) else base), rest


def _read_tables(tables: dict[str, Any]) -> StudyTables:
    flat_tables = {
        name: _flatten_paths(value, name) if name in ("changes", "parameters") else value
        for name, value in tables.items()
    }
    try:
        return StudyTables(**{name: _as_tuple(value) for name, value in flat_tables.items()})
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
        entries = {key: value}
        if isinstance(value, dict) and value and not set(value) & {"start", "stop", "num", "distribution"}:
            subpaths = _flatten_paths(value, f"{heading}.{key}")
            entries = {f"{key}.{name}": entry for name, entry in subpaths.items()}
        for path, entry in entries.items():
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
            values = {path: _ends(entry)[end] for path, entry in parameters.items()}
            with suppress(InputError):
                return with_open_materials(case, [*changes, *values]).replace_written({**changes, **values})
        raise InputError(replace(error.problems[0], key=f"changes.{error.key}")) from None


def _ends(entry: Any) -> tuple[Any, Any]:
    """First and last value of a parameter as it was given."""
    if isinstance(entry, Mapping):
        starts, stops = ("start", "low", "mean", "median"), ("stop", "high", "mean", "median")
        start, stop = (
            next((entry[name] for name in names if name in entry), None) for names in (starts, stops)
        )
        return start, stop
    if isinstance(entry, (list, tuple)):
        return (entry[0], entry[-1]) if entry else (None, None)
    # no parameter, as `read_parameter` will say
    return entry, entry


def _read_parameters(case: Case, ranges: Mapping[str, Any], folder: Path) -> tuple[Parameter, ...]:
    inputs = []
    duplicates = said_twice(ranges)
    if duplicates:
        raise InputError(problem("study_varied_twice", key=duplicates[1], other=duplicates[0]))
    for path, value in ranges.items():
        try:
            entry = entry_at(case, path)
        except InputError as error:
            raise InputError(replace(error.problems[0], key=f"parameters.{path}", given=None)) from None
        # an absolute pressure is above that at the outlet, which may differ from design to design
        fluid = None if any(path.startswith("fluid.") for path in ranges) else case.written.get("fluid")
        inputs.append(_resolve_files(read_parameter(entry, as_difference(entry.path, value, fluid)), folder))
    return tuple(inputs)


def _resolve_files(parameter: Parameter, folder: Path) -> Parameter:
    """Files that a parameter names are looked for beside the study file."""
    if not parameter.name.endswith(".file"):
        return parameter
    return Parameter(parameter.entry, tuple(str(folder / str(level)) for level in parameter.levels))
