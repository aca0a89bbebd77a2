"""The command line: read, call, show. Everything heavy is imported by the command that needs it."""

from __future__ import annotations

import errno
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fem_seal import __version__
from fem_seal.errors import ConvergenceError, InputError, NoLoadLeftError, Problem, SealError
from fem_seal.studies.command import app as study_app

if TYPE_CHECKING:
    from fem_seal.case import Case

DONE, OTHER_FAILURE, WRONG_INPUT, NO_RESULT, INTERRUPTED = 0, 1, 2, 3, 130

app = typer.Typer(
    name="fem-seal",
    help="Leakage of metal seals: contact pressure, interfacial gap and leak rate from one case file.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

app.add_typer(study_app, name="study")

CaseFile = Annotated[Path, typer.Argument(metavar="CASE.toml", show_default=False, help="Case file.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print warnings and errors only.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON, in SI units.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show where in the program an error comes from.")]


def _folder_option(default: str) -> Any:
    return typer.Option("--output", "-o", metavar="DIR", show_default=default, help="Folder for the results.")


@app.callback(invoke_without_command=True)
def _version(
    version: Annotated[bool, typer.Option("--version", help="Print the version and leave.")] = False,
) -> None:
    if version:
        typer.echo(f"fem-seal {__version__}")
        raise typer.Exit(DONE)


@app.command()
def run(
    case_file: CaseFile,
    output: Annotated[Path | None, _folder_option("[output] folder of the case, CASE.out")] = None,
    variants: Annotated[
        bool, typer.Option("--variants", help="Also the leak rate with every reading of the theory.")
    ] = False,
    quiet: Quiet = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Solve all loads of a case: tables, VTK files, mesh and report into the output folder."""
    from fem_seal import console
    from fem_seal.case import load_case

    case = load_case(case_file)
    if variants:
        case = case.replace({"leak.variants": True})
    folder = _results_folder(output, case)
    from fem_seal import pipeline, result_files
    from fem_seal.folder_lock import alone
    from fem_seal.tables import leak_rows

    _load_meanwhile("matplotlib.backends.backend_svg", "matplotlib.figure", "jinja2")
    with alone(folder), _progress(quiet) as progress:
        result = pipeline.run(case, progress=progress)
        progress("writing results")
        failures = result_files.write(result, folder)
    warnings = (*result.warnings, *failures)
    _warn(warnings)
    rows = leak_rows(result)
    if json:
        typer.echo(console.as_json({"folder": str(folder), "loads": rows, "warnings": warnings}))
    elif not quiet:
        console.show_leak_table(rows, case.title)
        console.show_leakage(case, rows)
        _list_files(folder)


def _load_meanwhile(*modules: str) -> None:
    """Load what the report will need while gmsh and SuperLU, which do not hold Python's lock, do their work."""

    def load() -> None:
        for module in modules:
            # a module that is missing is missed where it is used, with its own message
            with suppress(ImportError):
                import_module(module)

    Thread(target=load, daemon=True).start()


@app.command()
def check(case_file: CaseFile, quiet: Quiet = False, json: Json = False, debug: Debug = False) -> None:
    """Check a case file and print what follows from it in closed form, without solving."""
    from fem_seal import console
    from fem_seal.case import load_case
    from fem_seal.derived import closed_form_limits, derive, nearly_open

    case = load_case(case_file)
    derived = derive(case)
    numbers = console.derived_numbers(case, derived)
    from fem_seal import pipeline

    law = pipeline.interface_law(case, pipeline.rough_contact(case))
    numbers["contact_size_m"] = pipeline.sizing(case, law).contact_size
    _warn([*_remarks(case), *filter(None, [nearly_open(derived), closed_form_limits(case, derived)])])
    if json:
        typer.echo(console.as_json(numbers))
    elif not quiet:
        typer.echo(f"{case_file} is valid: {case.title}")
        console.show_derived(numbers)


@app.command()
def mesh(
    case_file: CaseFile,
    output: Annotated[Path | None, _folder_option("[output] folder of the case, CASE.out")] = None,
    quiet: Quiet = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Mesh a case, write mesh.msh and print how good the elements are."""
    from dataclasses import asdict

    from fem_seal import console
    from fem_seal.case import load_case

    case = load_case(case_file)
    folder = _results_folder(output, case)
    from fem_seal import pipeline
    from fem_seal.folder_lock import alone
    from fem_seal.results_folder import replaced_together

    seal_mesh = pipeline.build_mesh(case)
    path = folder / "mesh.msh"
    with alone(folder), replaced_together(folder, whole=False) as draft:
        seal_mesh.write(draft / path.name)
    _warn_of_mixture(folder)
    quality = asdict(seal_mesh.quality)
    if json:
        typer.echo(console.as_json({"file": str(path), **quality}))
    elif not quiet:
        typer.echo(f"{quality['elements']} triangles, {quality['vertices']} vertices")
        typer.echo(
            f"shape (1 is equilateral): smallest {quality['smallest']:.3f}, mean {quality['mean']:.3f}"
        )
        typer.echo(f"area of the sections within {quality['area_error']:.1e} of the exact one")
        typer.echo(f"mesh in {path}")


@app.command()
def leak(
    profile_file: Annotated[
        Path,
        typer.Argument(metavar="PROFILE.csv", show_default=False, help="Contact pressure over arc length."),
    ],
    case_file: CaseFile,
    output: Annotated[Path | None, _folder_option("PROFILE.leak")] = None,
    quiet: Quiet = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Leak rate of a given pressure profile, such as one exported from another finite-element code."""
    from fem_seal import console
    from fem_seal.case import load_case
    from fem_seal.folder_lock import alone
    from fem_seal.profile_file import read_profiles
    from fem_seal.profile_leak import leak_of_profiles, write_rows
    from fem_seal.results_folder import replaced_together

    case = load_case(case_file)
    profiles = read_profiles(profile_file)
    folder = _made(output or profile_file.with_suffix(".leak"))
    rows = leak_of_profiles(case, profiles)
    with alone(folder), replaced_together(folder, whole=False) as draft:
        write_rows(rows, draft / "leak.csv")
    _warn_of_mixture(folder)
    if json:
        typer.echo(console.as_json({"folder": str(folder), "loads": rows}))
    elif not quiet:
        console.show_leak_table(rows, f"{profile_file.name}: {case.title}")
        console.show_leakage(case, rows)
        _list_files(folder)


@app.command()
def surface(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE...", show_default=False, help="Scans or maps of one surface."),
    ],
    output: Annotated[Path | None, _folder_option("FILE.surface")] = None,
    unit: Annotated[
        str | None,
        typer.Option(metavar="UNIT", help='Where the file states none: "um", or "mm,um" for x and height.'),
    ] = None,
    detrend: Annotated[
        str, typer.Option(metavar="FORM", help='What is taken off: "tilt", "mean" or "curvature".')
    ] = "tilt",
    window: Annotated[str, typer.Option(metavar="WINDOW", help='"hann" or "none".')] = "hann",
    tip_radius: Annotated[
        str | None, typer.Option(metavar="LENGTH", help='Radius of the stylus tip, "2 um".')
    ] = None,
    shortest_wavelength: Annotated[
        str | None, typer.Option(metavar="LENGTH", help='What the instrument resolves, "2.5 um".')
    ] = None,
    outliers: Annotated[
        str, typer.Option(metavar="WHAT", help='Points that stand alone: "keep" or "remove".')
    ] = "keep",
    hurst: Annotated[
        float | None, typer.Option(metavar="H", help="Continue the spectrum to --q-low and --q-high.")
    ] = None,
    q_low: Annotated[str | None, typer.Option(metavar="WAVENUMBER", help='"1e2 1/m".')] = None,
    q_high: Annotated[str | None, typer.Option(metavar="WAVENUMBER", help='"1e8 1/m".')] = None,
    quiet: Quiet = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """What measured scans say about a surface: key figures, power spectrum, picture."""
    from fem_seal import console
    from fem_seal.case_roughness import scan_case
    from fem_seal.folder_lock import alone
    from fem_seal.results_folder import replaced_together
    from fem_seal.surface_files import surface_lines, surface_numbers, write_surface

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
    measured = scan_case([str(file) for file in files], entries).measured()
    folder = _made(output or files[0].with_suffix(".surface"))
    with alone(folder), replaced_together(folder, whole=False) as draft:
        write_surface(measured, draft)
    _warn(measured.warnings)
    if json:
        typer.echo(console.as_json({"folder": str(folder), **surface_numbers(measured)}))
    elif not quiet:
        for name, text in surface_lines(measured):
            typer.echo(f"  {name:24}{text}")
        _list_files(folder)


@app.command()
def schema() -> None:
    """Print the JSON Schema of the case file, for editors that complete and check while one types."""
    from fem_seal import console
    from fem_seal.schema import case_schema

    typer.echo(console.as_json(case_schema()))


def _results_folder(output: Path | None, case: Case) -> Path:
    return _made(output or Path(case.output.folder or "fem-seal.out"))


def _made(folder: Path) -> Path:
    """Make a results folder before the work starts, not after it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or "not a folder name").lower()
        problem = Problem(
            "--output", f"cannot be made ({reason}); give a folder that can be written", str(folder)
        )
        raise InputError(problem) from None
    return folder


def _remarks(case: Case) -> list[str]:
    from fem_seal.left_out import left_out
    from fem_seal.load_limits import refused_loads

    remarks = []
    if case.roughness is None:
        remarks.append("no [roughness]: no leak rate is calculated")
    if case.fluid is None:
        remarks.append("no [fluid]: no leak rate is calculated")
    if case.roughness is not None:
        remarks.extend(case.roughness.remarks())
    remarks.extend(one.text for one in left_out(case.load, refused_loads(case)))
    if case.load.target_leak_rate is not None:
        from fem_seal.inverse_questions import target_remarks

        remarks.extend(target_remarks(case))
    return remarks


def _warn_of_mixture(folder: Path) -> None:
    from fem_seal.results_folder import unfinished

    said = unfinished(folder)
    _warn([f"{folder}: {said}"] if said else [])


def _list_files(folder: Path) -> None:
    names = sorted(path.name for path in folder.iterdir() if path.is_file() and not path.name.startswith("."))
    steps = [name for name in names if name.endswith((".vtu", ".vtp"))]
    others = [name for name in names if name not in steps]
    listed = ", ".join(others) + (f" and {len(steps)} VTK files" if steps else "")
    typer.echo(f"Results in {folder}{'' if str(folder).endswith('/') else '/'}: {listed}")


def _warn(warnings: Sequence[str]) -> None:
    for warning in warnings:
        typer.secho(f"warning: {warning}", err=True, fg=typer.colors.YELLOW)


@contextmanager
def _progress(quiet: bool) -> Iterator[Callable[[str], None]]:
    """Show on stderr what is being done: a changing line on a terminal, lines elsewhere, or nothing."""
    if quiet:
        yield lambda text: None
    elif not sys.stderr.isatty():
        yield lambda text: typer.echo(text, err=True)
    else:
        from rich.console import Console

        with Console(stderr=True, highlight=False).status("starting") as status:
            yield lambda text: status.update(text)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; no traceback ever reaches the user.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; those of the process unless given.

    Returns
    -------
    int
        0 done, 2 wrong input, 3 no load can be calculated, 130 interrupted, 1 anything else.
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
        code, message = _explained(error)
        for line in message.splitlines():
            typer.secho(f"error: {line}", err=True, fg=typer.colors.RED)
        return code
    return DONE


def _explained(error: Exception) -> tuple[int, str]:
    """Exit code and message of an error."""
    own = type(error).__module__.split(".")[0] in ("fem_seal", "leak", "meshes")
    if isinstance(error, (ConvergenceError, NoLoadLeftError)):
        return NO_RESULT, str(error)
    if own and isinstance(error, ValueError):
        return WRONG_INPUT, str(error)
    if own or isinstance(error, SealError):
        return OTHER_FAILURE, str(error)
    if isinstance(error, OSError):
        return OTHER_FAILURE, _said_by_system(error)
    if isinstance(error, MemoryError):
        return OTHER_FAILURE, "not enough memory; try a coarser mesh or fewer loads"
    name = type(error).__name__
    return (
        OTHER_FAILURE,
        f"unexpected {name}: {error}. This is a defect of fem-seal; --debug shows where it comes from",
    )


def _said_by_system(error: OSError) -> str:
    """Where and why the system refused; on a full disc, what has no file name was printed."""
    reason = (error.strerror or str(error)).lower()
    if error.errno in (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)):
        return f"{error.filename or 'output'}: cannot be written ({reason})"
    return f"{error.filename or 'file'}: {reason}"
