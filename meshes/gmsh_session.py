"""Context manager for gmsh's global state."""

from __future__ import annotations

import signal
import threading
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import files
from types import ModuleType

from meshes.errors import MeshingError

# gmsh keeps one model for the whole process: two threads that mesh at once would share it.
_LOCK = threading.Lock()

_OPTIONS = {
    f"{table}.{option}": value
    for table, options in tomllib.loads(
        files("meshes").joinpath("gmsh_options.toml").read_text(encoding="utf-8")
    ).items()
    for option, value in options.items()
}

SYSTEM_LIBRARIES = (
    "libgl1 libglu1-mesa libxcursor1 libxfixes3 libxft2 libxinerama1 "
    "libxrender1 libxext6 libx11-6 libfontconfig1 libgomp1"
)


def load_gmsh() -> ModuleType:
    """Import gmsh, or say which system library it misses.

    Raises
    ------
    MeshingError
        If gmsh or one of the shared libraries it is linked to is not installed.
    """
    try:
        import gmsh
    except ImportError as error:
        raise MeshingError(f"gmsh is not installed ({error}); install it with: pip install gmsh") from error
    except OSError as error:
        raise MeshingError(
            f"gmsh cannot be loaded: {error}. On a bare Debian or Ubuntu server install the libraries that it "
            f"is linked to: apt-get install {SYSTEM_LIBRARIES}"
        ) from error
    return gmsh


def _ignore_broken_pipes() -> None:
    """Handle SIGPIPE as Python does, behind whose back gmsh takes the default.

    Whoever then writes to a process that has died would be ended by the system, without a word. Python lets the main
    thread alone say so.
    """
    if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGPIPE, signal.getsignal(signal.SIGPIPE))


@contextmanager
def gmsh_session(name: str) -> Iterator[ModuleType]:
    """Give an empty gmsh model with known options, and leave gmsh as it was found.

    Parameters
    ----------
    name : str
        Name of the model.

    Raises
    ------
    MeshingError
        If gmsh cannot be loaded.
    """
    gmsh = load_gmsh()
    with _LOCK:
        starts = not gmsh.isInitialized()
        if starts:
            # interruptible=False: gmsh's own SIGINT handler works in the main thread only.
            gmsh.initialize(argv=["fem-seal"], readConfigFiles=False, run=False, interruptible=False)
            _ignore_broken_pipes()
        former_options = {} if starts else {key: gmsh.option.getNumber(key) for key in _OPTIONS}
        previous = None if starts else gmsh.model.getCurrent()
        try:
            for key, value in _OPTIONS.items():
                gmsh.option.setNumber(key, value)
            gmsh.model.add(name)
            yield gmsh
        finally:
            if starts:
                gmsh.finalize()
            else:
                gmsh.model.remove()
                gmsh.model.setCurrent(previous)
                for key, value in former_options.items():
                    gmsh.option.setNumber(key, value)
