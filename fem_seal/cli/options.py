"""Arguments and options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer


def output_option(default: str | bool, what: str = "Folder for the results.", metavar: str = "DIR") -> Any:
    """Where a command writes to."""
    return typer.Option("--output", "-o", metavar=metavar, show_default=default, help=what)


def json_option(what: str = "the result") -> Any:
    """Whether a command prints JSON instead of words."""
    return typer.Option("--json", help=f"Print {what} as JSON, in SI units.")


CaseFile = Annotated[Path, typer.Argument(metavar="CASE.toml", show_default=False, help="Case file.")]
ResultsFolder = Annotated[
    Path, typer.Argument(metavar="DIR", show_default=False, help="Results folder of `fem-seal run`.")
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print warnings and errors only.")]
Json = Annotated[bool, json_option()]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
