"""Work of a worker: a chunk of designs, those of equal bodies in batches."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.case.case import names_files, with_files
from fem_seal.errors import InputError, write
from fem_seal.files import problem
from fem_seal.seal.evaluate import Batch, Turn, without_time_limit
from fem_seal.studies.cost import design_seconds
from fem_seal.studies.expressions import Expression
from fem_seal.studies.store import Row, stored_number
from fem_seal.studies.tables import Parameter, design_text, entries
from fem_seal.studies.time_limit import Block, Watch, overtime_reason, slow_line
from fem_seal.units import Display
from fem_seal.version import __version__

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.studies.plan import StudyPlan
    from fem_seal.studies.responses import DesignResult

# A chunk is what is lost when a worker dies and what travels at once: about a second of work, by these estimates of
# what new bodies and a new surface cost beside a design [s]; a cone takes less, a land with its edges more.
_BODIES, _SURFACE, _CHUNK = 0.2, 0.004, 1.0
# Its designs take their steps together: more of them than these gain nothing any more.
_MOST_DESIGNS = 128
# Between the last words of a worker and its end [s].
_FAREWELL = 2.0

# Materials enter the bodies by their elastic constants, the surface by their hardness.
_BODY_TABLES = ("closure.", "seat.", "mesh.")
_SURFACE_ENTRIES = ("hardness", "yield_stress", "name")
_SURFACE_TABLES = ("roughness.", "interface.", "leak.")


@dataclass(frozen=True)
class DesignSpec:
    """Everything about a study that a worker has to know.

    Parameters
    ----------
    case : Case
        Base.
    parameters : tuple of Parameter
    columns : tuple of str
        Of leak.csv.
    derived : dict
    interpolate : bool
    fingerprint : str
        Hash of all that the designs have in common.
    time_limit : float
        Of one design [s].
    files : dict
        Contents, as hashes, of the files that the designs are made of.
    """

    case: Case
    parameters: tuple[Parameter, ...]
    columns: tuple[str, ...]
    derived: dict[str, Expression]
    interpolate: bool
    fingerprint: str
    time_limit: float
    files: dict[str, str]

    @classmethod
    def of(cls, study: StudyPlan) -> DesignSpec:
        """What workers have to know about a study.

        Raises
        ------
        InputError
            If one of its files has changed since it was read.
        """
        check_unchanged(study.files)
        interpolate = study.run_settings.interpolate_surfaces
        parameters = tuple(
            # a worker needs the words that numbers stand for, not the levels or distributions of numbers
            Parameter(parameter.entry) if parameter.numeric else parameter
            for parameter in study.parameters
        )
        return cls(
            study.case,
            parameters,
            study.responses,
            study.derived,
            interpolate,
            _fingerprint(study.case, study.responses, study.derived, interpolate),
            study.run_settings.time_limit,
            study.files,
        )

    def inputs(self, point: Sequence[float] | FloatArray) -> tuple[float | str | bool, ...]:
        """Values of the parameters in a design."""
        return tuple(
            parameter.value(number) for parameter, number in zip(self.parameters, point, strict=True)
        )

    def point(self, inputs: Sequence[float | str | bool]) -> list[float]:
        """The design that has these values of the parameters."""
        return [
            float(value) if parameter.numeric else float(parameter.levels.index(value))
            for parameter, value in zip(self.parameters, inputs, strict=True)
        ]

    def key(self, point: Sequence[float] | FloatArray) -> str:
        """Hash of the full input of a design."""
        names = [parameter.name for parameter in self.parameters]
        inputs = [
            [name, _contents(str(value)) if names_files(name) else value]
            for name, value in sorted(zip(names, self.inputs(point), strict=True))
        ]
        text = json.dumps([self.fingerprint, inputs])
        return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()

    def files_of(self, point: Sequence[float] | FloatArray) -> dict[str, str]:
        """Those of the files that a design is made of."""
        values = {
            str(value)
            for parameter, value in zip(self.parameters, self.inputs(point), strict=True)
            if parameter.levels
        }
        return self._files_of_all | {path: self.files[path] for path in values & self.files.keys()}

    @property
    def _files_of_all(self) -> dict[str, str]:
        levels = {str(level) for parameter in self.parameters for level in parameter.levels}
        return {path: contents for path, contents in self.files.items() if path not in levels}


def calculate(spec: DesignSpec, chunk: FloatArray, turn: Turn = without_time_limit) -> list[Row]:
    """Rows of some designs; a design that fails is a row with its reason.

    Parameters
    ----------
    spec : DesignSpec
    chunk : ndarray, shape (designs, parameters)
    turn : callable
        Entered with the number of a design while it is calculated, with None while several are.

    Raises
    ------
    InputError
        If a file that they are made of is no longer what it was when the study was read.
    """
    from fem_seal.studies.responses import evaluate_designs

    points, batch = chunk.tolist(), Batch(turn)

    def case_of(number: int) -> Case:
        return spec.case.replace_written(entries(spec.parameters, points[number]))

    files = [spec.files_of(point) for point in points]
    for files_of_design in files:
        check_unchanged(files_of_design, all_there=False)
    cases = batch.map(range(len(points)), case_of)
    designs = evaluate_designs(batch, cases, spec.columns, interpolate=spec.interpolate)
    rows = batch.map(designs, lambda number: _row(spec, points[number], designs[number]))
    # a design reads its files when it needs them: only now is it sure what it has read
    for files_of_design in files:
        check_unchanged(files_of_design, all_there=False)
    return [
        replace(rows[number], seconds=batch.seconds[number])
        if number in rows
        else failed_row(
            spec, point, _reason_text(batch.failed[number], spec.case.display), batch.seconds[number]
        )
        for number, point in enumerate(points)
    ]


def calculate_watched(
    spec: DesignSpec,
    chunk: FloatArray,
    tell: Callable[[dict[str, Any]], None],
    worker: str = "",
    *,
    replaceable: bool = True,
) -> list[Row]:
    """`calculate` in a worker, which ends itself where a design never ends.

    Parameters
    ----------
    spec : DesignSpec
    chunk : ndarray, shape (designs, parameters)
    tell : callable
        Told of designs that take long, {"slow": a line for people}, and of one that has reached its time limit,
        {"late": the design, "worker": ..., "replaceable": ...}.
    worker : str
        Name of the worker.
    replaceable : bool
        Whether another one takes its place when it has ended itself.
    """
    # the limit is that of designs, not of loading what calculates them
    import fem_seal.studies.responses  # noqa: F401

    def leave() -> None:
        if replaceable:
            os._exit(1)

    def block(point: FloatArray) -> Block:
        def slow(seconds: float) -> None:
            tell({"slow": slow_line(design_text(spec.parameters, point), seconds, spec.time_limit)})

        def stop(end: Event) -> None:
            tell({"late": point.tolist(), "worker": worker, "replaceable": replaceable})
            # nothing less ends a design that is deep in a library; first what was told has to reach the coordinator
            if not end.wait(_FAREWELL):
                leave()

        return Block(slow, stop)

    designs = [block(point) for point in chunk]
    with Watch(spec.time_limit) as watch:

        def turn(number: int | None) -> AbstractContextManager[None]:
            # a worker that dies without a word has its designs tried one by one
            several = Block(lambda seconds: None, lambda end: leave())
            return watch.turn(several if number is None else designs[number])

        return calculate(spec, chunk, turn)


def _row(spec: DesignSpec, point: Sequence[float], design: DesignResult) -> Row:
    """Row of a design that was calculated, without the time that it took."""
    numbers = {
        parameter.name: float(number)
        for parameter, number in zip(spec.parameters, point, strict=True)
        if parameter.numeric
    }
    values: dict[str, float] = {**numbers, **design.values}
    for name, formula in spec.derived.items():
        values[name] = formula(values)
    return Row(
        spec.key(point),
        spec.inputs(point),
        outputs=tuple(stored_number(values[name]) for name in (*spec.columns, *spec.derived)),
        reason=None,
        seconds=0.0,
        validity=str(design.validity.level),
        validity_reasons="; ".join(design.validity.reasons_in(spec.case.display)),
        verdict=None if design.verdict is None else str(design.verdict),
    )


def failed_row(spec: DesignSpec, point: Sequence[float] | FloatArray, why: str, seconds: float = 0.0) -> Row:
    """Row of a design that could not be calculated at all."""
    no_values = (None,) * (len(spec.columns) + len(spec.derived))
    return Row(spec.key(point), spec.inputs(point), no_values, why, seconds)


def overtime_row(spec: DesignSpec, point: Sequence[float] | FloatArray) -> Row:
    """Row of a design that has reached its time limit."""
    return failed_row(spec, point, overtime_reason(spec.time_limit), spec.time_limit)


def _reason_text(error: BaseException, display: Display) -> str:
    text = " ".join(write(error, display).split())[:500]
    is_own = type(error).__module__.split(".")[0] in ("fem_seal", "leak", "meshes")
    return text if is_own and text else f"{type(error).__name__}: {text}"


def chunks(spec: DesignSpec, points: FloatArray) -> Iterator[FloatArray]:
    """All designs, each once, in an order in which equal bodies and then equal surfaces follow each other.

    Each chunk is what a worker calculates in one go.
    """
    if len(points) == 0:
        return
    design = design_seconds(spec.case, spec.columns)
    ranks = np.array([_rank(parameter.name) for parameter in spec.parameters])
    # lexsort takes the most important column last
    rows = points[np.lexsort(points[:, np.argsort(ranks, kind="stable")[::-1]].T)]
    changes = np.vstack([np.ones(rows.shape[1], dtype=bool), rows[1:] != rows[:-1]])
    rows, changes = rows[changes.any(axis=1)], changes[changes.any(axis=1)]
    new_bodies, new_surface = (changes[:, ranks <= rank].any(axis=1) for rank in (0, 1))
    costs = design + _SURFACE * new_surface + _BODIES * new_bodies
    start, cost = 0, 0.0
    for place, step in enumerate(np.asarray(costs).tolist()):
        if place > start and (cost + step > _CHUNK or place - start == _MOST_DESIGNS):
            yield rows[start:place]
            start, cost = place, 0.0
        cost += step
    yield rows[start:]


def _rank(path: str) -> int:
    """0 for what changes the bodies, 1 for what changes the surface, 2 for the rest."""
    if path.startswith(_SURFACE_TABLES) or path.split(".")[-1] in _SURFACE_ENTRIES:
        return 1
    return 0 if path.startswith(_BODY_TABLES) else 2


def _fingerprint(
    case: Case, columns: Sequence[str], derived: Mapping[str, Expression], interpolate: bool
) -> str:
    """Hash of the base case with the contents of its files, of what is calculated, and of the program's version."""
    from fem_seal.case.case import input_tables

    tables = {name: entry for name, entry in input_tables(case).items() if name != "output"}
    about = {
        "version": __version__,
        # places of files do not matter, their contents do
        "case": with_files(tables, _contents),
        "columns": sorted(columns),
        "derived": {name: formula.text for name, formula in derived.items()},
        "interpolate": interpolate,
        # rows of before that have no validity
        "judged": True,
    }
    return hashlib.blake2b(
        json.dumps(about, sort_keys=True, default=str).encode(), digest_size=16
    ).hexdigest()


def contents_of_files(case: Case, parameters: Sequence[Parameter]) -> dict[str, str]:
    """Contents, as hashes, of all files that a case and parameters name."""
    levels = (
        str(level) for parameter in parameters if names_files(parameter.name) for level in parameter.levels
    )
    return {path: _contents(path) for path in (*case.named_files, *levels)}


def check_unchanged(files: Mapping[str, str], *, all_there: bool = True) -> None:
    """InputError if a file has other contents than it had.

    Parameters
    ----------
    files : mapping
        Path and contents, see `contents_of_files`.
    all_there : bool
        Whether a file that is not there any more has changed, too. On another machine it may never have been.
    """
    for path, contents in files.items():
        present = _contents(path)
        if present != contents and (all_there or present != path):
            raise InputError(problem("study_file_changed"), file=path)


def _contents(path: str) -> str:
    """Hash of a file, its path if it is not there."""
    try:
        status = Path(path).stat()
        return _hash_of(path, status.st_mtime_ns, status.st_size)
    except OSError:
        return path


# The keys of all designs ask for the same few files.
@lru_cache(maxsize=1024)
def _hash_of(path: str, time_of_change: int, size: int) -> str:
    return hashlib.blake2b(Path(path).read_bytes(), digest_size=16).hexdigest()
