"""The server of the page: on this machine only, until Ctrl-C."""

from __future__ import annotations

import logging
import signal
import socket
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.errors import InputError
from fem_seal.files import problem
from leak.extras import say_missing

if TYPE_CHECKING:
    from fem_seal.case.case import Case


def serve(
    case: Case,
    folder: Path,
    port: int,
    on_start: Callable[[str], None],
    on_failure: Callable[[BaseException], None],
) -> None:
    """Serve the page of a case until it is interrupted.

    Parameters
    ----------
    case : Case
    folder : Path
        Where case files and reports are written.
    port : int
        0 takes one that is free.
    on_start : callable
        Gets the address as soon as the page can be opened; without the token in it the page answers nobody.
    on_failure : callable
        Gets what goes wrong in the page itself.

    Raises
    ------
    InputError
        If the port is in use, or the packages for the page are missing.
    """
    from fem_seal.explore.session import Session
    from fem_seal.explore.worker import Answers

    # a browser that goes away before its answer is there must not end the page
    if hasattr(signal, "pthread_sigmask"):
        # blocked in all threads that follow: gmsh takes back what is only ignored
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    with ExitStack() as stack:
        answers = Answers(Session(case))
        stack.callback(answers.close)
        # before the packages of the page are loaded, which takes as long as the first numbers
        answers.begin()
        try:
            from werkzeug.serving import make_server

            from fem_seal.explore.gate import HOST, guard, new_token
            from fem_seal.explore.page import page_of
        except ImportError as error:
            if (error.name or "").split(".")[0] not in ("dash", "plotly", "flask", "werkzeug"):
                raise
            raise InputError.at("fem-seal explore", say_missing("explore", error)) from None
        _check_free(HOST, port)
        page = page_of(answers, folder, case.title or "case")
        logging.getLogger("werkzeug").setLevel(logging.ERROR)
        server = make_server(HOST, port, page.server, threaded=True)
        stack.callback(server.server_close)
        token = new_token()
        guard(page, server.server_port, token, on_failure)
        on_start(f"http://{HOST}:{server.server_port}/?token={token}")
        with suppress(KeyboardInterrupt):
            server.serve_forever()


def _check_free(host: str, port: int) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        try:
            probe.bind((host, port))
        except (OSError, OverflowError):
            raise InputError(problem("explore_port", port=port)) from None
