"""The command line. Each command imports heavy packages itself, so that the others start fast."""

from __future__ import annotations

import errno
import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

import fem_seal
from fem_seal.cli import terminal
from fem_seal.cli.calibrate import calibrate
from fem_seal.cli.library import fluids, materials
from fem_seal.cli.new import ForceTakesNoValue, new
from fem_seal.cli.study import app as study_app
from fem_seal.cli.table import table
from fem_seal.cli.testplan import testplan
from fem_seal.errors import ConvergenceError, InputError, NoLoadLeftError, SealError, defect_text
from fem_seal.files import problem
from fem_seal.output.folders import folder_lock, replaced_together, unfinished
from fem_seal.units import Display
from fem_seal.version import __version__

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case

DONE, OTHER_FAILURE, WRONG_INPUT, NO_RESULT, INTERRUPTED = 0, 1, 2, 3, 130

app = typer.Typer(
    name="fem-seal",
    help="Leakage of metal seals: contact pressure, interfacial gap and leak rate from one case file.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

app.add_typer(study_app, name="study")
app.command(cls=ForceTakesNoValue)(new)
for _command in (materials, fluids, table, calibrate, testplan):
    app.command()(_command)


@app.callback(invoke_without_command=True)
def _version(
    version: Annotated[bool, terminal.option("common", "version")] = False,
    cite: Annotated[bool, terminal.option("common", "cite")] = False,
) -> None:
    if cite:
        from fem_seal.output.sources import citation

        terminal.say(*citation().split("\n"))
        raise typer.Exit(DONE)
    if version:
        terminal.say(f"fem-seal {__version__}")
        raise typer.Exit(DONE)


@app.command()
def report(
    folder: terminal.ResultsFolder,
    output: Annotated[Path | None, terminal.output_option("DIR/report.html", "HTML file.", "FILE")] = None,
    full: terminal.Full = False,
    quiet: terminal.Quiet = False,
    debug: terminal.Debug = False,
) -> None:
    """Draw the report of a results folder again, without calculating."""
    from fem_seal.answers.variants import INTERFACE_VARIANTS
    from fem_seal.output.report.page import write_report
    from fem_seal.output.stored import read_result

    result = read_result(folder)
    file = output or folder / "report.html"
    with folder_lock(folder):
        write_report(result, file, full=full)
    _warn_of_unfinished_designs(folder)
    if not quiet:
        terminal.say(f"report in {file}")
        if full and result.surface is not None and INTERFACE_VARIANTS.name not in result.answers:
            terminal.tell("Only `fem-seal run CASE.toml --full` compares theories and interface laws.")


@app.command()
def pdf(
    folder: terminal.ResultsFolder,
    output: Annotated[Path | None, terminal.output_option("DIR/report.pdf", "PDF file.", "FILE")] = None,
    one_page: Annotated[bool, terminal.option("pdf", "one_page")] = False,
    quiet: terminal.Quiet = False,
    debug: terminal.Debug = False,
) -> None:
    """Print the report of a results folder into a PDF file, with Chromium, Chrome or Edge."""
    from fem_seal.output.pdf import print_pdf

    page = folder / "report.html"
    if not page.is_file():
        raise InputError.at(str(folder), "holds no report.html; `fem-seal run CASE.toml -o DIR` writes one")
    file = output or folder / ("page.pdf" if one_page else "report.pdf")
    print_pdf(page, file, one_page=one_page)
    if not quiet:
        terminal.say(f"PDF in {file}")


@app.command()
def explore(
    case_file: Annotated[Path | None, terminal.argument("explore", "case_file")] = None,
    port: Annotated[int, terminal.option("explore", "port")] = 8050,
    no_browser: Annotated[bool, terminal.option("explore", "no_browser")] = False,
    output: Annotated[
        Path | None,
        terminal.output_option(
            "that of the case file", "Folder for case files and reports that are written from the page."
        ),
    ] = None,
    quiet: terminal.Quiet = False,
    debug: terminal.Debug = False,
) -> None:
    """Open a live page of a case on this machine: sliders, and the leak rate that follows them. Ctrl-C ends it."""
    from fem_seal.case.new_case import TEMPLATES, read_text_case, template

    case = read_text_case(template(TEMPLATES[0])) if case_file is None else fem_seal.load_case(case_file)
    folder = (output or (case_file or Path("case.toml")).parent).absolute()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError.at("--output", f"cannot be created ({error.strerror})", str(folder)) from None
    from fem_seal.explore.server import serve

    def show_address(address: str) -> None:
        if no_browser or not quiet:
            # the page opens only with the token in its address
            terminal.say(f"{case.title}: {address}   (Ctrl-C ends it)")
        if not no_browser:
            import webbrowser

            webbrowser.open(address)

    def record_error(error: BaseException) -> None:
        if debug:
            traceback.print_exception(error)
        terminal.complain(defect_text(error))

    serve(case, folder, port, show_address, record_error)


@app.command()
def run(
    case_file: terminal.CaseFile,
    output: Annotated[Path | None, terminal.output_option("[output] folder of the case, CASE.out")] = None,
    sensitivities: Annotated[bool | None, terminal.option("run", "sensitivities")] = None,
    full: terminal.Full = False,
    report: Annotated[bool, terminal.option("run", "report")] = True,
    details: terminal.Details = False,
    all_columns: terminal.AllColumns = False,
    quiet: terminal.Quiet = False,
    json: terminal.Json = False,
    debug: terminal.Debug = False,
) -> None:
    """Solve all loads of a case and write tables, VTK files, mesh and report to the output folder."""
    case = terminal.case_of_command(case_file)
    folder = _results_folder(output, case)
    from fem_seal import result as seal_result
    from fem_seal.output import files

    with folder_lock(folder), terminal.progress_of(quiet) as progress:
        result = seal_result.run(
            case, progress=progress, sensitivities=sensitivities, full=full or all_columns
        )
        progress("writing results")
        failures = files.write(result, folder, all_columns=all_columns, full=full, with_report=report)
    _show(result, folder, failures, details=details, all_columns=all_columns, quiet=quiet, json=json)


def _show(
    result: SealSolution,
    folder: Path,
    failures: Sequence[str],
    *,
    details: bool,
    all_columns: bool,
    quiet: bool,
    json: bool,
) -> None:
    """Tell a result that was written, and what was understood of given contacts."""
    from fem_seal.output.report.brief import given_in_words, remarks_in_brief
    from fem_seal.output.tables import leak_rows

    if json:
        rows = leak_rows(result, all_columns=all_columns)
        data = {"folder": str(folder), "loads": rows, "warnings": [*result.warnings, *failures]}
        terminal.say_json(data | ({"understood": given_in_words(result)} if result.of_profile else {}))
    elif not quiet:
        terminal.show_result(result, details=details)
        terminal.tell(*given_in_words(result))
    terminal.warn(
        (*(result.warnings if details else remarks_in_brief(result)), *failures),
        "" if details else "report.html" if (folder / "report.html").exists() else "summary.json",
    )
    if not (json or quiet):
        terminal.say_where(folder)


class _PictureNamedOrNot(TyperCommand):
    """Takes `--picture` with or without a file after it; a .toml file is the case, not a picture."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put an empty name where none is given."""
        words = list(args)
        if "--picture" in words:
            at = words.index("--picture") + 1
            if at == len(words) or words[at].startswith("-") or words[at].lower().endswith(".toml"):
                words.insert(at, "")
        return super().parse_args(ctx, words)


@app.command(cls=_PictureNamedOrNot)
def check(
    case_file: terminal.CaseFile,
    picture: Annotated[str | None, terminal.option("check", "picture")] = None,
    details: terminal.Details = False,
    quiet: terminal.Quiet = False,
    json: terminal.Json = False,
    debug: terminal.Debug = False,
) -> None:
    """Check a case file and print the closed-form results, without solving."""
    from fem_seal.output.answers.verdict import requirement_lines
    from fem_seal.output.case_words import crest_rows, finish_rows, temperature_rows
    from fem_seal.output.check import check_of
    from fem_seal.seal.cost import about
    from fem_seal.seal.heating import with_contact_temperatures

    case = with_contact_temperatures(terminal.case_of_command(case_file))
    image = None
    if picture is not None:
        from fem_seal.output.pictures.section import write_section

        image = write_section(case, Path(picture) if picture else Path(case_file.with_suffix(".png").name))
    checked = check_of(case)
    problem, numbers = checked.problem, checked.numbers
    if json:
        terminal.say_json(numbers)
    elif not quiet:
        terminal.tell(f"{case_file} is valid: {case.title}", bold=True)
        terminal.tell(*(f"judged: {line}" for line in requirement_lines(case)))
        crests = crest_rows(case.display, problem.surface, checked.derivation, leaks=problem.leaks)
        for name, text in (*finish_rows(case), *crests, *temperature_rows(case, problem)):
            terminal.tell(f"  {name:30}{text}", indent=32)
        if numbers["run_time_s"] is not None:
            terminal.tell(f"  {'time of a run':30}{about(numbers['run_time_s'])}, in load steps", indent=32)
        terminal.show_derived(case, numbers, details=details)
    terminal.warn(checked.remarks, "" if details or quiet or json else "--details")
    if image is not None and not (json or quiet):
        terminal.say(f"picture in {image}")


@app.command()
def mesh(
    case_file: terminal.CaseFile,
    output: Annotated[Path | None, terminal.output_option("[output] folder of the case, CASE.out")] = None,
    quiet: terminal.Quiet = False,
    json: terminal.Json = False,
    debug: terminal.Debug = False,
) -> None:
    """Mesh a case, write mesh.msh and print the quality of the elements."""
    from dataclasses import asdict

    case = terminal.case_of_command(case_file)
    folder = _results_folder(output, case)
    from fem_seal.seal.problem import SealProblem, build_mesh

    seal_mesh = build_mesh(SealProblem.of(case))
    path = folder / "mesh.msh"
    with folder_lock(folder), replaced_together(folder, whole=False) as draft:
        seal_mesh.write(draft / path.name)
    _warn_of_unfinished_designs(folder)
    quality = asdict(seal_mesh.quality)
    if json:
        terminal.say_json({"file": str(path), **quality})
    elif not quiet:
        terminal.say(f"{quality['elements']} triangles, {quality['vertices']} vertices")
        terminal.say(
            f"shape (1 is equilateral): smallest {quality['smallest']:.3f}, mean {quality['mean']:.3f}"
        )
        terminal.say(f"relative error of the section area {quality['area_error']:.1e}")
        terminal.say(f"Mesh in {path}")


@app.command()
def leak(
    pressure_file: Annotated[Path, terminal.argument("leak", "pressure_file")],
    case_file: terminal.CaseFile,
    output: Annotated[Path | None, terminal.output_option("FILE.leak")] = None,
    as_map: Annotated[bool | None, terminal.option("leak", "as_map")] = None,
    field: Annotated[str | None, terminal.option("leak", "field")] = None,
    gap_field: Annotated[str | None, terminal.option("leak", "gap_field")] = None,
    columns: Annotated[str | None, terminal.option("leak", "columns")] = None,
    pressure_unit: Annotated[str | None, terminal.option("leak", "pressure_unit")] = None,
    length_unit: Annotated[str | None, terminal.option("leak", "length_unit")] = None,
    axis: Annotated[str | None, terminal.option("leak", "axis")] = None,
    details: terminal.Details = False,
    all_columns: terminal.AllColumns = False,
    quiet: terminal.Quiet = False,
    json: terminal.Json = False,
    debug: terminal.Debug = False,
) -> None:
    """Leak rate of a given contact pressure, along a meridian or over a face, from any finite-element code."""
    from fem_seal.answers.chain import solve_map, solve_profiles
    from fem_seal.answers.map_files import MapOptions, is_map, read_map
    from fem_seal.answers.profile_files import read_profiles
    from fem_seal.output import files

    case = terminal.case_of_command(case_file, with_shapes=False)
    solve: Any
    given: Any
    if is_map(pressure_file, columns) if as_map is None else as_map:
        options = MapOptions(field, gap_field, columns, pressure_unit, length_unit, axis)
        solve, given = solve_map, read_map(pressure_file, options, case.hardness)
    else:
        contact = case.contact if case.has_shapes else None
        solve, given = solve_profiles, read_profiles(pressure_file, contact, axis)
    folder = _create_folder(output or pressure_file.with_suffix(".leak"))
    with folder_lock(folder), terminal.progress_of(quiet) as progress:
        result = solve(case, given, progress)
        progress("writing results")
        failures = files.write(result, folder, all_columns=all_columns)
    _show(result, folder, failures, details=details, all_columns=all_columns, quiet=quiet, json=json)


@app.command()
def direct(
    case_file: terminal.CaseFile,
    output: Annotated[Path | None, terminal.output_option("[direct] folder of the case, CASE.direct")] = None,
    jobs: Annotated[int | None, terminal.option("direct", "jobs")] = None,
    seal: Annotated[bool, terminal.option("direct", "seal")] = False,
    quiet: terminal.Quiet = False,
    json: terminal.Json = False,
    debug: terminal.Debug = False,
) -> None:
    """Simulate rough contact and flow of a case's surface directly and compare the theory; interrupted runs go on."""
    from fem_seal import result as seal_result
    from fem_seal.output import direct as samples

    case = terminal.case_of_command(case_file)
    own_folder = None if case.direct is None else case.direct.folder
    folder = _create_folder(output or (Path(own_folder) if own_folder else case_file.with_suffix(".direct")))
    processes = jobs or os.cpu_count() or 1
    with folder_lock(folder), terminal.progress_of(quiet) as progress:
        if seal:
            strips = seal_result.direct_seal(case, folder=folder, jobs=processes, progress=progress)
            progress("drawing")
            samples.write_direct_seal(case.display, strips, folder)
            numbers: dict[str, Any] = {"strips": [samples.seal_numbers(strip) for strip in strips]}
            title, keys = "Simulated seal", 4
            lines, rows_shown = (
                samples.seal_lines(case.display, strips),
                samples.shown_seal_rows(case.display, strips),
            )
        else:
            viscosity = None if case.fluid is None or case.fluid.gas is not None else case.fluid.viscosity
            table = seal_result.direct(case, folder=folder, jobs=processes, progress=progress)
            progress("drawing")
            samples.write_direct(case.display, table, folder, viscosity)
            rows = samples.direct_rows(table, viscosity)
            numbers = {**samples.direct_numbers(table), "pressures": rows}
            title, keys = "Direct simulation", 2
            lines, rows_shown = (
                samples.direct_lines(case.display, table),
                samples.shown_rows(case.display, rows),
            )
    if json:
        terminal.say_json({"folder": str(folder), **numbers})
    elif not quiet:
        terminal.tell(*lines)
        terminal.show_table(f"{title}: {case.title}", *rows_shown, keys=keys)
        terminal.say_where(folder)


@app.command()
def surface(
    files: Annotated[list[Path], terminal.argument("surface", "files")],
    output: Annotated[Path | None, terminal.output_option("FILE.surface")] = None,
    unit: Annotated[str | None, terminal.option("surface", "unit")] = None,
    detrend: Annotated[str, terminal.option("surface", "detrend")] = "tilt",
    window: Annotated[str, terminal.option("surface", "window")] = "hann",
    tip_radius: Annotated[str | None, terminal.option("surface", "tip_radius")] = None,
    shortest_wavelength: Annotated[str | None, terminal.option("surface", "shortest_wavelength")] = None,
    outliers: Annotated[str, terminal.option("surface", "outliers")] = "keep",
    hurst: Annotated[float | None, terminal.option("surface", "hurst")] = None,
    q_low: Annotated[str | None, terminal.option("surface", "q_low")] = None,
    q_high: Annotated[str | None, terminal.option("surface", "q_high")] = None,
    quiet: terminal.Quiet = False,
    json: terminal.Json = False,
    debug: terminal.Debug = False,
) -> None:
    """Evaluate measured scans of a surface: key figures, power spectrum, picture."""
    from fem_seal.case.roughness import scan_case
    from fem_seal.output.surface import surface_lines, surface_numbers, write_surface

    entries = {
        "unit": unit.split(",") if unit and "," in unit else unit,
        "detrend": detrend,
        "window": window,
        "tip_radius": tip_radius,
        "shortest_wavelength": shortest_wavelength,
        "outliers": outliers,
        "extrapolation": "cut" if hurst is None and q_low is None and q_high is None else "self-affine",
        "hurst": hurst,
        "q_low": q_low,
        "q_high": q_high,
    }
    scans = scan_case([str(file) for file in files], entries).read_scans()
    folder = _create_folder(output or files[0].with_suffix(".surface"))
    with folder_lock(folder), replaced_together(folder, whole=False) as draft:
        write_surface(scans, draft)
    terminal.warn(scans.warnings)
    if json:
        terminal.say_json({"folder": str(folder), **surface_numbers(scans)})
    elif not quiet:
        for name, text in surface_lines(Display(), scans):
            terminal.say(f"  {name:24}{text}")
        terminal.say_where(folder)


@app.command()
def view(
    folder: terminal.ResultsFolder,
    png: Annotated[Path | None, terminal.option("view", "png")] = None,
    load: Annotated[int | None, terminal.option("view", "load")] = None,
    quiet: terminal.Quiet = False,
    debug: terminal.Debug = False,
) -> None:
    """Show a results folder in 3D: the seal cut open, contact pressure on the seat, a slider over the loads."""
    from fem_seal.output.pictures import three_d

    _warn_of_unfinished_designs(folder)
    three_d.view(folder, png, load)
    if png is not None and not quiet:
        terminal.say(f"picture in {png}")


@app.command()
def mcp(
    folder: Annotated[Path, terminal.option("mcp", "folder")] = Path(),
    time_limit: Annotated[float, terminal.option("mcp", "time_limit")] = 15.0,
    debug: terminal.Debug = False,
) -> None:
    """Answer an assistant (Model Context Protocol) over standard input and output, with the cases of one folder."""
    try:
        from fem_seal.mcp.server import serve
    except ImportError as error:
        from leak.extras import say_missing

        raise InputError(problem("mcp_missing", missing=say_missing("mcp", error))) from None
    serve(folder, 60.0 * time_limit)


@app.command()
def schema(study: Annotated[bool, terminal.option("schema", "study")] = False) -> None:
    """Print the JSON Schema of the case file, for completion and checks in an editor."""
    if study:
        from fem_seal.studies.tables import study_schema

        terminal.say_json(study_schema())
        return
    from fem_seal.case.schema import case_schema

    terminal.say_json(case_schema())


def _results_folder(output: Path | None, case: Case) -> Path:
    return _create_folder(output or Path(case.output.folder or "fem-seal.out"))


def _create_folder(folder: Path) -> Path:
    """Create a results folder, before the calculation starts."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or "not a folder name").lower()
        raise InputError(problem("output_folder", reason=reason, folder=folder)) from None
    return folder


def _warn_of_unfinished_designs(folder: Path) -> None:
    note = unfinished(folder)
    terminal.warn([f"{folder}: {note}"] if note else [])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; no traceback ever reaches the user.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; those of the process unless given.

    Returns
    -------
    int
        0 done, 2 wrong input, 3 no load or design can be calculated, 130 interrupted, 1 anything else.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        app(args=words, prog_name="fem-seal")
        sys.stdout.flush()
    except SystemExit as leave:
        return leave.code if isinstance(leave.code, int) else DONE
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        if "--debug" in words:
            raise
        code, message = _explain_error(error)
        terminal.complain(message)
        return code
    return DONE


def _explain_error(error: Exception) -> tuple[int, str]:
    """Exit code and message of an error."""
    is_own = type(error).__module__.split(".")[0] in ("fem_seal", "leak", "meshes")
    if isinstance(error, (ConvergenceError, NoLoadLeftError)):
        return NO_RESULT, str(error)
    if is_own and isinstance(error, ValueError):
        return WRONG_INPUT, str(error)
    if is_own or isinstance(error, SealError):
        return OTHER_FAILURE, str(error)
    if isinstance(error, ImportError):
        from leak.extras import extra_with, say_absent, say_missing

        if extra := extra_with(error.name):
            return WRONG_INPUT, f"this {say_missing(extra, error)}"
        if said := say_absent(error.name):
            return WRONG_INPUT, f"this {said}"
    if isinstance(error, OSError):
        return OTHER_FAILURE, _system_message(error)
    return OTHER_FAILURE, defect_text(error)


def _system_message(error: OSError) -> str:
    """File and reason of an error of the system; on a full disc an error without a file name is about the output."""
    reason = (error.strerror or str(error)).lower()
    if error.errno in (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)):
        return f"{error.filename or 'output'}: cannot be written ({reason})"
    return f"{error.filename or 'file'}: {reason}"
