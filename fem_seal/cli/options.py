"""Arguments and options of the commands; what is said of them stands in `templates/options.toml`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fem_seal.files import own_tables


def option(command: str, name: str, **words: str) -> Any:
    """An option of a command.

    Parameters
    ----------
    command, name : str
        Its table and key in the file.
    words
        What stands between the braces of its help.
    """
    described = dict(own_tables("options.toml")[command][name])
    described["help"] = described["help"].format(**words)
    return typer.Option(*described.pop("flags", ()), **described)


def argument(command: str, name: str) -> Any:
    """An argument of a command, see `option`."""
    return typer.Argument(**own_tables("options.toml")[command][name])


def output_option(default: str | bool, what: str = "Folder for the results.", metavar: str = "DIR") -> Any:
    """Where a command writes to."""
    return typer.Option("--output", "-o", metavar=metavar, show_default=default, help=what)


def json_option(what: str = "the result") -> Any:
    """Whether a command prints JSON instead of words."""
    return typer.Option("--json", help=f"Print {what} as JSON, in SI units.")


CaseFile = Annotated[Path, argument("common", "case_file")]
ResultsFolder = Annotated[Path, argument("common", "results_folder")]
Quiet = Annotated[bool, option("common", "quiet")]
Json = Annotated[bool, json_option()]
Debug = Annotated[bool, option("common", "debug")]
