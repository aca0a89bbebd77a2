"""One run of a study: missing designs are calculated and stored batch by batch."""

from __future__ import annotations

import json
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.arrays import FloatArray
from fem_seal.errors import InputError
from fem_seal.files import parse_json, problem, read_text, write_text
from fem_seal.output.folders import folder_lock
from fem_seal.studies.cost import design_seconds
from fem_seal.studies.pools import Pool, open_pool
from fem_seal.studies.progress import Progress
from fem_seal.studies.results import StudyResult
from fem_seal.studies.store import FILE, FORMAT_VERSION, TRUTH, Row, Store, create, open_to_read
from fem_seal.studies.time_limit import OvertimeError, end_after, overtime_reason
from fem_seal.studies.work import DesignSpec, check_unchanged, chunks
from fem_seal.studies.worker_pool import RESUME_HINT, Workers
from fem_seal.units import duration
from fem_seal.version import __version__
from fem_seal.wording import say

if TYPE_CHECKING:
    from dask.distributed import Client

    from fem_seal.studies.plan import StudyPlan


# Processor time from which on is said beforehand what designs cost [s]: so long nobody waits without asking.
_WORTH_TELLING = 60.0


def run_study(
    study: StudyPlan,
    client: Client | Workers | None = None,
    *,
    folder: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    retry_failed: bool = False,
    progress: Progress | None = None,
    leave: Callable[[], None] = lambda: None,
) -> StudyResult:
    """Calculate the designs of a study that are not in its file yet.

    Parameters
    ----------
    study : StudyPlan
    client, folder, workers, resume, retry_failed, progress
        See `fem_seal.studies.study.Study.run`; with ``workers=0`` this process calculates.
    scheduler : str, optional
        Address of a running dask scheduler.
    leave : callable
        Called, from another thread, if this process calculates a design that has reached its time limit and does not
        stop; its row is written then, and there is nothing left but to end the process.

    Returns
    -------
    StudyResult

    Raises
    ------
    InputError
        If the folder holds a study already and `resume` was not asked for, or another one; if another process writes
        it; if the failed trials of a search are to be repeated; if a file of the designs changes meanwhile.
    OutputError
        If the folder cannot be written, or is deleted meanwhile.
    """
    if retry_failed and study.optimise is not None:
        raise InputError(problem("study_retry_of_search"))
    temporary = folder is None
    place = Path(tempfile.mkdtemp(prefix="fem-seal-study-")) if folder is None else Path(folder)
    if not resume and (place / FILE).exists():
        raise InputError(problem("study_there_already", place=place))
    progress = progress or Progress()
    start = time.perf_counter()

    def record_stuck(row: Row | None) -> None:
        # from another thread, while this one's connection waits for the design
        if row is not None:
            with closing(create(place / FILE, _column_types(study), study.output_names)) as store:
                store.write([row])
        progress.note(say(study.case.display, "studies", "notes_stuck", kept=RESUME_HINT))
        progress.end()
        leave()

    try:
        # the folder comes last: nothing is left in it, and nothing in it changed, if there is no one to calculate
        with (
            open_pool(
                client, workers, scheduler, study.run_settings.retries, progress.note, record_stuck
            ) as ready,
            folder_lock(place),
        ):
            _move_former_results(study, place / FILE, progress)
            store = create(place / FILE, _column_types(study), study.output_names)
            with closing(store):
                if retry_failed:
                    store.forget_failures()
                _calculate(study, store, ready, progress)
                store.describe(last_run_seconds=time.perf_counter() - start)
                _keep_fields(study, store, place, progress, lambda: record_stuck(None))
    except BaseException as error:
        if temporary:
            shutil.rmtree(place, ignore_errors=True)
        elif isinstance(error, KeyboardInterrupt):
            progress.note(f"interrupted; {RESUME_HINT}")
        raise
    return StudyResult(place, temporary=temporary)


def _move_former_results(study: StudyPlan, path: Path, progress: Progress) -> None:
    """Designs by the paper's theory, which have columns that the corrected one has not, stay in a file of their own."""
    if not path.exists():
        return
    with closing(open_to_read(path)) as store:
        about = store.about
    former = set(about.get("beside", ())) - set(study.companions)
    if not former or set(about.get("responses", ())) - former != set(study.responses):
        return
    new_path = path.with_name(f"{path.stem}_paper{path.suffix}")
    if new_path.exists():
        return  # nothing is written over; that the columns differ is said next
    for end in ("", "-wal", "-shm"):
        if (part := path.with_name(path.name + end)).exists():
            part.replace(new_path.with_name(new_path.name + end))
    progress.note(say(study.case.display, "studies", "notes_set_aside", name=new_path.name))


def _calculate(study: StudyPlan, store: Store, pool: Pool, progress: Progress) -> None:
    spec, about = DesignSpec.of(study), description(study)
    if study.optimise is not None:
        from fem_seal.studies.optimise import optimise

        optimise(study, spec, about, store, pool, progress)
    else:
        rows_before = store.size
        store.set_design((spec.key(point) for point in study.points), **about)
        if rows_before and store.counts()["open"] == len(study.points):
            progress.note(
                say(study.case.display, "studies", "notes_none_known", held=rows_before, version=__version__)
            )
        _fill(spec, store, pool, study, progress)


def _fill(spec: DesignSpec, store: Store, pool: Pool, study: StudyPlan, progress: Progress) -> None:
    counts = store.counts()
    count = len(study.points) - counts["open"]
    seconds = counts["open"] * design_seconds(spec.case, spec.columns)
    if seconds > _WORTH_TELLING:
        each, whole = duration(seconds / counts["open"]), duration(seconds)
        progress.note(say(study.case.display, "studies", "notes_expected", each=each, all=whole))
    progress.begin(len(study.points), count)
    todo = chunks(spec, study.points)
    try:
        for rows in pool.results(spec, _missing_chunks(spec, store, todo) if count else todo):
            check_unchanged(spec.files)
            store.write(rows)
            progress.advance(len(rows), sum(row.reason is not None for row in rows))
    finally:
        progress.end()


def _missing_chunks(spec: DesignSpec, store: Store, all_chunks: Iterable[FloatArray]) -> Iterator[FloatArray]:
    """Chunks without the designs that have a row already."""
    for chunk in all_chunks:
        keys = [spec.key(point) for point in chunk]
        stored_keys = store.stored_keys(keys)
        open_numbers = [n for n, key in enumerate(keys) if key not in stored_keys]
        if open_numbers:
            yield chunk[open_numbers]


def _column_types(study: StudyPlan) -> dict[str, str]:
    return {
        parameter.name: "REAL" if parameter.numeric else TRUTH if parameter.entry.truth else "TEXT"
        for parameter in study.parameters
    }


def description(study: StudyPlan) -> dict[str, Any]:
    """What a reader of the file has to know about the columns; in JSON's types."""
    from fem_seal.answers.leakage_class import nominal_size

    case, requirement = study.case, study.case.requirement
    return {
        "format_version": FORMAT_VERSION,
        "version": __version__,
        "title": study.title,
        "inputs": study.names,
        "parameters": [
            {
                "name": parameter.name,
                "unit": parameter.entry.unit,
                "numeric": parameter.numeric,
                "levels": list(parameter.levels)[:1000],
                "bounds": list(parameter.bounds),
                "distribution": None
                if parameter.distribution is None
                else type(parameter.distribution).__name__,
            }
            for parameter in study.parameters
        ],
        "responses": list(study.responses),
        "beside": list(study.companions),
        "derived": {name: formula.text for name, formula in study.derived.items()},
        "constraints": {name: constraint.text for name, constraint in study.constraints.items()},
        "goals": {name: formula.text for name, formula in study.goals.items()},
        "design": {**study.design.model_dump(), "optimise": study.optimise is not None},
        "outside_theory": "keep" if study.keeps_outside else "leave out",
        "standard": study.report.standard,
        "units": case.report.units,
        "seal": {
            "nominal_size": nominal_size(case).size,
            "gas": getattr(case.fluid, "gas", None) is not None,
            "throughputs": case.display.throughputs,
            "leak_rate_unit": None if (unit := case.display.of_flow) is None else [unit.name, unit.size],
            "fluid": case.fluid.name if case.fluid else None,
            # limits of classes depend on the design
            "limit_m3_per_s": None if requirement is None or requirement.standard else requirement.leak_rate,
        },
    }


def _keep_fields(
    study: StudyPlan, store: Store, folder: Path, progress: Progress, stuck: Callable[[], None]
) -> None:
    """Complete results of chosen designs, unless they are there already."""
    choice = study.run_settings.keep_fields
    if choice == "none":
        return
    from fem_seal.result import run
    from fem_seal.studies.designs_table import Designs

    numbers = Designs.read(store).best(1) if choice == "best" else list(choice)
    for number in numbers:
        key, place = store.key(number), folder / "designs" / f"{number:06d}"
        if key is None:
            progress.note(say(study.case.display, "studies", "notes_not_to_keep", number=number))
            continue
        # written last: says that the folder is complete, and whose results it holds
        mark = place / "design.json"
        if _read_key(mark) == key:
            continue
        inputs = dict(zip(study.names, store.rows([key])[key].inputs, strict=True))
        changes = {
            parameter.name: parameter.entry.write(inputs[parameter.name]) for parameter in study.parameters
        }
        mark.unlink(missing_ok=True)
        limit = study.run_settings.time_limit
        try:
            with end_after(limit, stuck=stuck):
                run(study.case.replace_written(changes)).write(place)
        except OvertimeError:
            progress.note(
                say(
                    study.case.display,
                    "studies",
                    "notes_not_kept",
                    number=number,
                    reason=overtime_reason(limit),
                )
            )
            continue
        write_text(mark, json.dumps({"number": number, "key": key, "inputs": inputs}, indent=2) + "\n")


def _read_key(mark: Path) -> str | None:
    """Key of the design whose complete results lie beside a mark; None if it says nothing."""
    try:
        return str(parse_json(read_text(mark))["key"])
    except (ValueError, TypeError, KeyError):
        return None
