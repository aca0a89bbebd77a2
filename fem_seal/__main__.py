"""Entry point of the command ``fem-seal`` and of ``python -m fem_seal``.

Its start is shortened here: modules that other libraries load and no command uses are imported lazily. Where fem_seal
is a library, all modules are loaded as always.

"""

from __future__ import annotations

import gc
import io
import os
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

from fem_seal.version import __version__


def main() -> int:
    """Run the command line with the arguments of the process; return its exit code."""
    # Asked for by scripts and editors all the time, and answered before the parser of the command line is
    # loaded.
    if sys.argv[1:] == ["--version"]:
        try:
            sys.stdout.write(f"fem-seal {__version__}\n")
            sys.stdout.flush()
        except OSError as error:
            sys.stderr.write(f"error: output: cannot be written ({(error.strerror or str(error)).lower()})\n")
            return 1
        return 0
    _write_every_sign()
    # The matrices are small: threads gain nothing, and on a busy machine their waiting for each other makes a run
    # several times slower. To be set before numpy is loaded; a user's own setting wins.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # No plugin has a say in what a case file may hold; pydantic reads the metadata of every installed package for them.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # Nearly all that a command makes stays to its end: going through it a thousand times takes a fifteenth of a run.
    gc.set_threshold(150_000, 20, 50)
    postpone_unused_imports()
    _tidy_docstrings_once()
    try:
        from fem_seal.cli.app import main as command_line

        return command_line()
    except KeyboardInterrupt:
        return 130
    finally:
        # Skip the final garbage collection, a tenth of a run: the memory goes with the process.
        gc.freeze()


def _write_every_sign() -> None:
    """Let the output hold every sign: on Windows a pipe or file has an encoding that lacks "·" and most others."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and "utf" not in stream.encoding.lower():
            # whoever has chosen an encoding gets it, and a question mark for what it lacks
            is_set = "PYTHONIOENCODING" in os.environ
            stream.reconfigure(errors="replace") if is_set else stream.reconfigure(encoding="utf-8")


def _tidy_docstrings_once() -> None:
    """While matplotlib is loaded, its classes tidy the docstrings that they share, each anew: a twentieth of a run."""
    import inspect
    from functools import cache

    inspect.cleandoc = cache(inspect.cleandoc)


# Modules that scipy and matplotlib load, with a hundred and fifty others, and that no command uses.
LATE_IMPORTS = frozenset(
    {"PIL.ExifTags", "fontTools.agl", "mpl_toolkits.mplot3d.art3d", "numpy.f2py", "numpy.testing"}
)


def postpone_unused_imports() -> None:
    """Load `LATE_IMPORTS` modules on first use; call this before anything is imported."""
    sys.meta_path.insert(0, _LateImporter)


class _LateImporter:
    """Finder of the postponed modules that makes Python load them lazily."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Spec of a postponed module; None for all others, which Python finds itself."""
        spec = PathFinder.find_spec(fullname, path, target) if fullname in LATE_IMPORTS else None
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec


if __name__ == "__main__":
    sys.exit(main())
