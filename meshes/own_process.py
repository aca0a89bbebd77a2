"""Call a function in a subprocess with a time limit; it may hang or crash without harm."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from meshes.errors import MeshesError

P = ParamSpec("P")
T = TypeVar("T")

# The new process gets the search path of this one, and then finds everything else in it. A copy made with fork would
# take over locks of other threads, and multiprocessing would run a user's script once more.
_START = (
    "import pickle, sys; sys.path[:] = pickle.load(sys.stdin.buffer); "
    "from meshes.own_process import answer; answer()"
)
# A process whose parent is gone ends itself so much later [s].
_GRACE = 5.0


class OwnProcessError(MeshesError, RuntimeError):
    """The function crashed or raised what nobody expected; the message says which."""


class TimeLimitError(OwnProcessError):
    """The function took too long."""


def run_in_subprocess(
    time_limit: float, function: Callable[P, T], /, *arguments: P.args, **options: P.kwargs
) -> T:
    """Call a function in a new process that prints nothing.

    Parameters
    ----------
    time_limit : float
        After so long the process is ended [s].
    function : callable
        Of a module; what goes in and out of it can be pickled.
    *arguments, **options
        Handed to it.

    Raises
    ------
    MeshesError
        What the function itself raises.
    TimeLimitError
        If it takes too long.
    OwnProcessError
        If it crashes or raises anything else.
    """
    request = pickle.dumps(sys.path) + pickle.dumps((time_limit, function, arguments, options))
    try:
        process = subprocess.run(
            [sys.executable, "-c", _START],
            input=request,
            capture_output=True,
            timeout=time_limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise TimeLimitError(f"takes longer than {time_limit:g} s") from None
    except OSError as error:
        raise OwnProcessError(f"no process could be started: {error}") from None
    try:
        has_result, reply = pickle.loads(process.stdout)
    except (pickle.UnpicklingError, EOFError):
        raise OwnProcessError(_death(process)) from None
    if not has_result:
        raise reply
    result: T = reply
    return result


def _death(process: subprocess.CompletedProcess[bytes]) -> str:
    if process.returncode < 0:
        return f"crashes ({signal.Signals(-process.returncode).name})"
    errors = process.stderr.decode(errors="replace").strip().splitlines()
    return f"ended with code {process.returncode}{f': {errors[-1]}' if errors else ''}"


def answer() -> None:
    """What the new process does: read the call from standard input, write its outcome to standard output."""
    time_limit, function, arguments, options = pickle.load(sys.stdin.buffer)
    if sys.platform != "win32":
        # a library that hangs does not come back to Python's own handler; the system's ends the process
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, time_limit + _GRACE)
    with os.fdopen(os.dup(1), "wb") as stream:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        try:
            outcome = True, function(*arguments, **options)
        except MeshesError as error:
            outcome = False, error
        except Exception as error:  # damaged files make other people's readers raise anything
            detail = " ".join(str(error).split())[:160]
            outcome = False, OwnProcessError(detail or "damaged")
        pickle.dump(outcome, stream)
