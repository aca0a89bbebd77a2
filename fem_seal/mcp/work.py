"""What the tools of an assistant answer, in a process of its own that may be ended at any time."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import fem_seal
from fem_seal.errors import InputError, SealError, error_text
from fem_seal.files import as_json, parse_json, problem, write_text
from fem_seal.mcp.folder import MOST_BYTES, Folder

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case

# Loads and designs with their numbers in an answer, warnings, files, designs of a study, dots per inch of a picture.
_ROWS, _WARNINGS, _NAMES, _DESIGNS, _DPI = 8, 6, 50, 500, 90
_CHECKED = ("touch_radius_m", "contact_angle_rad", "dimensions", "hardness_Pa", "rms_height_m", "rms_slope")


@dataclass(frozen=True)
class Reply:
    """An answer.

    Parameters
    ----------
    says : dict
        Ready for JSON.
    pictures : tuple of bytes
        PNG.
    refused : bool
    """

    says: dict[str, Any]
    pictures: tuple[bytes, ...] = ()
    refused: bool = False


_progress: Connection | None = None


def begin(root: Path, drafts: str, progress: Connection) -> None:
    """What the process does first: drafts stand within the folder, and nothing is kept in that of the user."""
    global _progress
    _progress = progress
    os.chdir(root)
    os.environ["FEM_SEAL_CACHE"] = ""
    tempfile.tempdir = os.environ["TMPDIR"] = drafts


def answer(tool: str, root: Path, arguments: Mapping[str, Any]) -> Reply:
    """What a tool answers; a refusal says which entry is wrong and what is allowed.

    Parameters
    ----------
    tool : str
        One of `TOOLS`.
    root : Path
        The folder.
    arguments : mapping
    """
    folder = Folder(root)
    try:
        return TOOLS[tool](folder, **arguments)
    except Exception as error:
        return Reply(_refusal(folder, error, arguments), refused=True)


def _refusal(folder: Folder, error: Exception, arguments: Mapping[str, Any]) -> dict[str, Any]:
    problems = error.problems[:_ROWS] if isinstance(error, InputError) else ()
    # what is wrong with the call itself is no key of a case
    keys = [each.key for each in problems if each.key and each.key not in arguments]
    try:
        text = folder.tables("case", arguments.get("case_path", ""), arguments.get("case_toml", ""))[1]
    except (SealError, OSError, ValueError):
        # one that leads out of the folder, or is none, is told as it was given
        text = str(arguments.get("case_toml", ""))[:MOST_BYTES]
    return {
        "refused": error_text(error, getattr(error, "display", None)).replace(f"{folder.root}{os.sep}", ""),
        "problems": [{"key": each.key, "value": each.value, "message": each.message} for each in problems],
        "next": _next(*("explain", f"key: {keys[0]}") if keys else ("search_manual", "words of the refusal")),
        "case_toml": text,
    }


def tell(text: str) -> None:
    """Say how far it is."""
    if _progress is not None:
        _progress.send(text)


def new_case(
    folder: Folder,
    template: str = "",
    answers: dict[str, str] | None = None,
    entries: dict[str, str] | None = None,
    file: str = "",
) -> Reply:
    """Begin a case: a commented case file from a template, or the list of templates and of the folder's files."""
    from fem_seal.case import new_case as cases

    if not template:
        names = {name: cases.about(name) for name in cases.TEMPLATES}
        there = sorted(path.name for path in folder.root.glob("*.toml"))[:_NAMES]
        return Reply(
            {"templates": names, "files": there, "next": _next("new_case", "with one of these templates")}
        )
    answers, entries = answers or {}, entries or {}
    text = cases.template(template)
    # before they are a case, of which the files are read
    given = {f"answers.{name}": value for name, value in answers.items()} | entries
    folder.tables("case", "", cases.with_entries(text, given))
    more = [f"{key}={value}" for key, value in entries.items()]
    text, told = cases.with_options(text, template, answers, more)
    # the first line names a schema for editors, which is not there
    text = text.partition("\n")[2].replace(" FILE", f" {file or 'CASE.toml'}")
    case, _ = folder.case("", text)
    place = folder.new(file, "file")
    says = {
        "says": f"{case.title}: {cases.about(template)}",
        "beside": told,
        "file": place and folder.shown(write_text(place, text)),
        "entries": {
            each.name: f"{path} = {value}: {each.words}" for each, path, value in cases.find_questions(text)
        },
        "next": _next("check_case", "before it is solved"),
    }
    return _reply(says, text)


def check_case(folder: Folder, case_path: str = "", case_toml: str = "", picture: bool = False) -> Reply:
    """Check a case in a second: what is wrong with it, closed-form results, a picture of its section."""
    from fem_seal.output.answers.verdict import requirement_lines
    from fem_seal.output.check import check_of
    from fem_seal.output.pictures.section import section_figure
    from fem_seal.output.pictures.style import style
    from fem_seal.seal.cost import about
    from fem_seal.seal.heating import with_contact_temperatures

    case, text = folder.case(case_path, case_toml)
    case.check_shapes()
    case = with_contact_temperatures(case)
    checked = check_of(case)
    seconds = checked.numbers["run_time_s"]
    says = {
        "says": f"valid: {case.title}",
        "judged": requirement_lines(case),
        "warnings": checked.remarks[:_WARNINGS],
        "time_of_a_run": None if seconds is None else about(seconds),
        "closed_forms_SI": {key: checked.numbers[key] for key in (*_CHECKED, "requirement")},
        "loads_SI": [
            {name: value for name, value in row.items() if value is not None}
            for row in _few(checked.numbers["loads"])
        ],
        "next": _next("run_case", "for leak rate and verdict"),
    }
    with style():
        return _reply(says, text, figures=[section_figure(case)] if picture else ())


def run_case(
    folder: Folder, case_path: str = "", case_toml: str = "", results_folder: str = "", picture: bool = False
) -> Reply:
    """Leak rate of a case with its interval, verdict, what decides it, and validity: seconds to minutes."""
    case, text = folder.case(case_path, case_toml)
    case.check_shapes()
    place = folder.new(results_folder, "results_folder")
    return _result(folder, fem_seal.run(case, tell), text, place, picture)


def leak_of_profile(
    folder: Folder,
    profile_path: str = "",
    profile_csv: str = "",
    case_path: str = "",
    case_toml: str = "",
    results_folder: str = "",
    picture: bool = False,
) -> Reply:
    """Leak rate of a contact pressure that another finite-element program has calculated."""
    from fem_seal.answers.chain import solve_map, solve_profiles
    from fem_seal.answers.map_files import is_map, read_map
    from fem_seal.answers.profile_files import read_profiles

    case, text = folder.case(case_path, case_toml)
    place = folder.new(results_folder, "results_folder")
    file = folder.file("profile", profile_path, profile_csv, Path(tempfile.gettempdir()))
    if is_map(file):
        result = solve_map(case, read_map(file, hardness=case.hardness), tell)
    else:
        profiles = read_profiles(file, case.contact if case.has_shapes else None)
        result = solve_profiles(case, profiles, tell)
    return _result(folder, result, text, place, picture)


def study(
    folder: Folder,
    study_path: str = "",
    study_toml: str = "",
    case_path: str = "",
    case_toml: str = "",
    results_folder: str = "",
) -> Reply:
    """Calculate up to 500 designs of a case, and name the best."""
    from fem_seal.studies.display import DesignDisplay
    from fem_seal.studies.progress import Progress

    class Told(Progress):
        def advance(self, done_count: int, failed_count: int) -> None:
            super().advance(done_count, failed_count)
            tell(f"{self.done_count} of {self.total} designs")

    path, _, tables = folder.tables("study", study_path, study_toml)
    base = tables.pop("base", "")
    if path is None:
        case, text = folder.case(base or case_path, case_toml)
        plan = fem_seal.Study(case, **tables)
    else:
        plan, text = fem_seal.load_study(path), folder.tables("case", str(path.parent / base), "")[1]
    count = plan.optimise.trials if plan.optimise else len(plan.points)
    if count > _DESIGNS:
        raise InputError(problem("mcp_designs", count=count, most=_DESIGNS))
    place = folder.inside(results_folder, "results_folder") if results_folder else None
    if place is not None and place.is_dir():
        # a study goes on, but not in a file that is elsewhere
        for path in place.iterdir():
            folder.inside(str(path), "results_folder")
    result = plan.run(folder=place, workers=0, resume=True, progress=Told())
    designs = result.designs
    # without a goal none is better than another
    best = designs.best(_ROWS) or _few(list(designs.successes.index))
    says = {
        "says": f"{plan.title}: {result.counts['done']} designs done, {result.counts['failed']} failed",
        "failed_because": dict(result.reasons[:_WARNINGS]),
        "designs_shown": {
            "design": [str(number) for number in best],
            **DesignDisplay(designs).describe(best),
        },
        "designs_SI": result.table.loc[best].reset_index().to_dict("records"),
        "outside_theory_left_out": result.left_out,
        "next": _next("run_case", "of the best design, for interval and verdict"),
    }
    return _reply(says, text, [] if place is None else [folder.shown(result.report())])


def calibrate(
    folder: Folder,
    measured_path: str = "",
    measured_csv: str = "",
    case_path: str = "",
    case_toml: str = "",
    results_folder: str = "",
) -> Reply:
    """What measured leak rates say about a seal: narrower predictions, conflicts, the next test."""
    from fem_seal.output import calibration as output

    case, text = folder.case(case_path, case_toml)
    place = folder.new(results_folder, "results_folder")
    file = folder.file("measured", measured_path, measured_csv, Path(tempfile.gettempdir()))
    found = fem_seal.calibrate(case, file, tell)
    rows = [dict(zip(output.PREDICTION_HEADINGS, row, strict=True)) for row in output.prediction_rows(found)]
    lines = list(output.lines(found))
    says = {
        "verdict": found.solution and found.solution.verdict,
        "says": lines[0],
        "decides": lines[1:],
        "predictions_shown": rows[:_ROWS],
        "summary_SI": output.summary(found),
        "next": _next("run_case", "with the calibrated case of results_folder"),
    }
    return _reply(says, text, _written(folder, place, partial(output.write_calibration, found)))


def testplan(folder: Folder, case_path: str = "", case_toml: str = "", results_folder: str = "") -> Reply:
    """Plan a leak test that decides between what is open: its loads, what is expected at each, a protocol."""
    from fem_seal.answers.testplan import plan_leak_test
    from fem_seal.output import testplan as output

    case, text = folder.case(case_path, case_toml)
    place = folder.new(results_folder, "results_folder")
    plan = plan_leak_test(case, tell)
    loads = output.summary(plan)
    says = {
        "says": f"{case.title}: a leak test at {len(loads)} loads",
        "decides": list(output.lines(plan)),
        "loads_SI": loads,
        "next": _next("calibrate", "with what was measured"),
    }
    write = partial(output.write_testplan, plan, case_file=Path(case_path).name or "CASE.toml")
    return _reply(says, text, _written(folder, place, write))


TOOLS: Mapping[str, Callable[..., Reply]] = {
    tool.__name__: tool
    for tool in (new_case, check_case, run_case, leak_of_profile, study, calibrate, testplan)
}


def _result(folder: Folder, result: SealSolution, text: str, place: Path | None, picture: bool) -> Reply:
    """Verdict, interval, what decides it, validity, and what to ask next."""
    from fem_seal.output import files
    from fem_seal.output.answer_output import decisive
    from fem_seal.output.answer_outputs import pages_of
    from fem_seal.output.columns import SHOWN_COLUMNS
    from fem_seal.output.plots import result_figure
    from fem_seal.output.report.brief import given_in_words, lines_in_brief, loads_in_brief, remarks_in_brief
    from fem_seal.output.tables import leak_rows

    first, *others = lines_in_brief(result, pages_of(result))
    load, case = decisive(result), result.case
    shown, left_out = loads_in_brief(case, result.every_load)
    names = {*SHOWN_COLUMNS["brief"], "step", "contact_force_N", "verdict", "validity", "validity_reasons"}
    decides = next(n for n, each in enumerate(result.every_load) if each is load)
    rows = [{name: row[name] for name in row if name in names} for row in _few(leak_rows(result), decides)]
    reasons = load.validity.reasons_in(case.display)
    remarks = [f"{clause}. {rest}".rstrip(". ") for clause, rest in remarks_in_brief(result).items()]
    says = {
        "verdict": result.verdict,
        "says": first,
        "interval_m3_per_s": load.leak_interval,
        "decides": [*others, *given_in_words(result)],
        "validity": {"level": load.validity.level, "reasons": reasons},
        "loads_shown": {"headings": shown.headings, "rows": shown.rows, "left_out": left_out},
        "loads_SI": rows,
        "warnings": remarks[:_WARNINGS],
        "next": _after(case, result, reasons),
    }
    written = _written(folder, place, partial(files.write, result))
    return _reply(says, text, written, [result_figure(result)] if picture else ())


def _after(case: Case, result: SealSolution, reasons: Iterable[str]) -> dict[str, str]:
    """The tool to ask next, and why."""
    if reason := next(iter(reasons), ""):
        return _next("explain", f"validity: {reason}")
    if case.requirement is None:
        return _next("run_case", "with a [requirement], for a verdict")
    if result.verdict == "pass":
        return _next("calibrate", "with readings of a leak test, to narrow the interval")
    return _next("study", "of the entry that decides")


def _few(rows: Sequence[Any], one: int = 0) -> list[Any]:
    """Some of many rows, with both ends and a certain one."""
    from fem_seal.output.pictures.style import few

    return list(rows) if len(rows) <= _ROWS else [rows[n] for n in sorted({*few(len(rows), _ROWS - 1), one})]


def _next(tool: str, why: str) -> dict[str, str]:
    return {"tool": tool, "why": why}


def _written(folder: Folder, place: Path | None, write: Callable[[Path], object]) -> list[str]:
    """Names of the files that are written into a new folder, if one is asked for."""
    if place is None:
        return []
    place.mkdir(parents=True)
    write(place)
    return sorted(folder.shown(path) for path in place.iterdir() if not path.name.startswith("."))


def _reply(
    says: Mapping[str, Any], text: str, files: Sequence[str] = (), figures: Sequence[Figure] = ()
) -> Reply:
    """An answer as JSON has it, with the text of its case, what was written, and pictures."""
    plain: dict[str, Any] = parse_json(
        as_json({**says, "case_toml": text} | ({"files": files} if files else {}))
    )
    return Reply(plain, tuple(map(_png, figures)))


def _png(figure: Figure) -> bytes:
    out = BytesIO()
    figure.savefig(out, format="png", dpi=_DPI)
    return out.getvalue()
