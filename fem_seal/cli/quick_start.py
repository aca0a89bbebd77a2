"""Shorten the start of a command: modules that other libraries load and no command uses are imported lazily.

For `fem_seal.__main__` alone. Where fem_seal is a library, all modules are loaded as always.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

# Modules that scipy and matplotlib load, with a hundred and fifty others, and that no command uses.
POSTPONED = frozenset(
    {
        "PIL.ExifTags",
        "fontTools.agl",
        "mpl_toolkits.mplot3d.art3d",
        "numpy.f2py",
        "numpy.testing",
    }
)


def postpone_unused_imports() -> None:
    """Load `POSTPONED` modules on first use; call this before anything is imported."""
    sys.meta_path.insert(0, _Postponing)


class _Postponing:
    """Finder of the postponed modules that makes Python load them lazily."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Spec of a postponed module; None for all others, which Python finds itself."""
        spec = PathFinder.find_spec(fullname, path, target) if fullname in POSTPONED else None
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec
