"""The command `fem-seal explore`: read, serve, open."""

from __future__ import annotations

import traceback
from pathlib import Path
from typing import Annotated

from fem_seal.cli.options import CaseFile, Debug, Quiet, option, output_option
from fem_seal.cli.terminal import complain, say
from fem_seal.errors import InputError, unexpected


def explore(
    case_file: CaseFile,
    port: Annotated[int, option("explore", "port")] = 8050,
    no_browser: Annotated[bool, option("explore", "no_browser")] = False,
    output: Annotated[
        Path | None,
        output_option(
            "that of the case file", "Folder for case files and reports that are written from the page."
        ),
    ] = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Open a live page of a case on this machine: sliders, and the leak rate that follows them. Ctrl-C ends it."""
    from fem_seal.case.case import load_case

    case = load_case(case_file)
    folder = (output or case_file.parent).absolute()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError.at("--output", f"cannot be created ({error.strerror})", str(folder)) from None
    from fem_seal.explore.server import serve

    def opened(address: str) -> None:
        if no_browser or not quiet:
            # without the token in it nobody can open the page
            say(f"{case.title}: {address}   (Ctrl-C ends it)")
        if not no_browser:
            import webbrowser

            webbrowser.open(address)

    def failed(error: BaseException) -> None:
        if debug:
            traceback.print_exception(error)
        complain(unexpected(error))

    serve(case, folder, port, opened, failed)
