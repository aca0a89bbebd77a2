"""Processes that have loaded everything: copies of one that loads what is slow to load, once per test process.

A copy is a process of its own: it may crash, hang and print like any other. What is not tested with it is how a process
starts and what it loads.
"""

from __future__ import annotations

import os
import pickle
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from contextlib import suppress
from functools import cache
from pathlib import Path
from subprocess import CompletedProcess, TimeoutExpired
from threading import Lock
from typing import Any

LOADED = ("pyvista.plotting", "gmsh", "ezdxf", "fem_seal.output.pictures.three_d", "meshes.drawings")
HERE = Path(__file__).resolve()
_one_at_a_time = Lock()


@cache
def _server(process: int) -> socket.socket:
    """The process that is copied; it ends with this one, the end of its connection tells it."""
    mine, theirs = socket.socketpair()
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE.parents[2]), *sys.path])}
    command = [sys.executable, str(HERE), str(theirs.fileno())]
    subprocess.Popen(command, pass_fds=[theirs.fileno()], env=environment)
    theirs.close()
    return mine


def run(
    command: list[str], *, input: bytes, capture_output: bool, timeout: float, check: bool
) -> CompletedProcess[bytes]:
    """As `subprocess.run` for ``[sys.executable, "-c", code]``."""
    assert command[:2] == [sys.executable, "-c"] and capture_output and not check
    with (
        _one_at_a_time,
        tempfile.TemporaryFile() as given,
        tempfile.TemporaryFile() as out,
        tempfile.TemporaryFile() as err,
    ):
        given.write(input)
        given.seek(0)
        server = _server(os.getpid())
        request = pickle.dumps((command[2], dict(os.environ), os.getcwd()))
        ends = [file.fileno() for file in (given, out, err)]
        socket.send_fds(server, [len(request).to_bytes(8, "big")], ends)
        server.sendall(request)
        pid = int.from_bytes(_read_exactly(server, 8), "big")
        server.settimeout(timeout)
        try:
            code = int.from_bytes(_read_exactly(server, 8), "big", signed=True)
        except TimeoutError:
            os.kill(pid, signal.SIGKILL)
            server.settimeout(None)
            _read_exactly(server, 8)
            raise TimeoutExpired(command, timeout) from None
        server.settimeout(None)
        for file in (out, err):
            file.seek(0)
        return CompletedProcess(command, code, out.read(), err.read())


def _read_exactly(connection: socket.socket, size: int) -> bytes:
    got = b""
    while len(got) < size:
        part = connection.recv(size - len(got))
        if not part:
            raise EOFError
        got += part
    return got


def _serve(connection: socket.socket) -> None:
    import importlib

    for name in LOADED:
        with suppress(ImportError):
            importlib.import_module(name)
    with suppress(EOFError):
        while True:
            size, ends, _, _ = socket.recv_fds(connection, 8, 3)
            if not size:
                return
            code, environment, folder = pickle.loads(_read_exactly(connection, int.from_bytes(size, "big")))
            pid = os.fork()
            if pid == 0:
                connection.close()
                _become(code, environment, folder, ends)
            for one in ends:
                os.close(one)
            connection.sendall(pid.to_bytes(8, "big"))
            ended = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
            connection.sendall(ended.to_bytes(8, "big", signed=True))


def _become(code: str, environment: dict[str, str], folder: str, ends: list[int]) -> None:
    failed = 1
    try:
        for number, one in enumerate(ends):
            os.dup2(one, number)
        sys.stdin = os.fdopen(0)
        sys.argv = ["-c"]
        os.environ.clear()
        os.environ.update(environment)
        os.chdir(folder)
        everything: dict[str, Any] = {"__name__": "__main__"}
        exec(code, everything)
        failed = 0
    except SystemExit as error:
        failed = error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException:
        traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
        os._exit(failed)


if __name__ == "__main__":
    _serve(socket.socket(fileno=int(sys.argv[1])))
